//! The bar of a simulated lathe. Its position follows from the program: the program starts where the operator has
//! placed the tool, and its first G92 gives that position. Source: spec L3, L9, L10.

use std::sync::Arc;

use crate::controller::nc_settings;
use crate::defs::kind::Kind;
use crate::defs::param::{self, Params};
use crate::io::sim::{BarFile, BodyFile, BodyKind, PartFile, SlidePosition};
use crate::nc::{
    CommonVariables, CoordinateChange, EmptyLibrary, Library, OfflineMachine, OpEffect, ProgramCheck, Source,
};
use crate::units::Axis;

/// Machine coordinates of the centre of the bar's face, radius mm.
const FACE_MM: SlidePosition = SlidePosition { x: -200.0, y: 0.0, z: -450.0 };
/// Length and diameter of the chuck, mm.
const CHUCK_LENGTH_MM: f64 = 80.0;
const CHUCK_DIAMETER_MM: f64 = 125.0;
/// Cell size of the bar, mm.
const CELL_MM: f64 = 0.1;

/// The bar of a program. P384 > 0: a bar of that diameter, its face at X0 Z0, the tool at the position of the first
/// G92. Otherwise: the built-in part of that program name. `None` on other kinds, for a program without G92 before its
/// first move, and for a start outside the soft limits.
#[must_use]
pub fn bar_of_program(kind: Kind, params: &Params, source: &Arc<Source>) -> Option<PartFile> {
    if !kind.is_lathe() {
        return None;
    }
    let diameter = params.get(param::BAR_DIAMETER);
    if diameter <= 0.0 {
        let file = source.name().rsplit(['/', '\\']).next().unwrap_or_default();
        let stem = file.rsplit_once('.').map_or(file, |(stem, _)| stem);
        return PartFile::builtin_named(stem).ok().flatten();
    }
    let settings = nc_settings(kind, params);
    let library: Arc<dyn Library + Send + Sync> = Arc::new(EmptyLibrary);
    let (mut start, mut moved) = (None, false);
    let mut world = OfflineMachine::new(&settings);
    ProgramCheck::new(source, &library, &settings, CommonVariables::default()).run(&mut world, &mut |block| {
        for op in &block.ops {
            let effect = op.effect();
            if let (OpEffect::Coordinates(CoordinateChange::Set(values)), false, None) = (effect, moved, start) {
                start = values[Axis::X].zip(values[Axis::Z]);
            }
            moved |= effect.is_motion();
        }
    });
    let (x, z) = start?;
    let start_mm = SlidePosition { x: FACE_MM.x + x, y: 0.0, z: FACE_MM.z + z };
    let reached = |axis: Axis, at: f64| {
        (params.get_axis(param::SOFT_MINUS_X, axis)..=params.get_axis(param::SOFT_PLUS_X, axis)).contains(&at)
    };
    if !reached(Axis::X, start_mm.x) || !reached(Axis::Z, start_mm.z) {
        return None;
    }
    let length = params.get(param::BAR_LENGTH);
    let (z_from, z_to) = (-length - CHUCK_LENGTH_MM, -length);
    let chuck = BodyFile { what: BodyKind::Chuck, z_from, z_to, diameter: CHUCK_DIAMETER_MM };
    let bar = BarFile { diameter, z_from: -length, z_to: 0.0, cell: CELL_MM };
    let name = "棒料".to_owned();
    let parts = PartFile { name, kind, g54_mm: FACE_MM, start_mm, ..PartFile::default() };
    Some(PartFile { bodies: vec![chuck], bar: Some(bar), ..parts })
}
