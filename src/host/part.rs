//! The part of a program: which one it is, and the commands that set it up in the control.
//! Source: spec P5, T3, L9.

use std::sync::Arc;

use super::bar;
use crate::controller::StorageRequest;
use crate::defs::kind::Kind;
use crate::defs::param::{self, Params};
use crate::io::sim::{FaceDirection, PartFile, SurfaceFile};
use crate::link::command::Command;
use crate::link::toolpath::StockBox;
use crate::nc::Source;
use crate::units::{PerAxis, WorkPos};

/// Which part a host mounts when the current program changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PartRule {
    /// The mounted part stays, whatever the program.
    Keep,
    /// The part of the new program, if it has one; otherwise the mounted part stays.
    FollowProgram,
}

/// A program whose part is wanted.
#[derive(Clone, Debug)]
pub struct PartQuery {
    /// Kind of machine.
    pub kind: Kind,
    /// Parameters: the bar of a lathe.
    pub params: Params,
    /// Number of the program.
    pub number: u32,
    /// Its text, if it is known.
    pub source: Option<Arc<Source>>,
}

impl PartQuery {
    /// The part of the program: on a lathe its bar, otherwise the built-in part for this kind of machine.
    /// A bar takes a check run of the whole program.
    #[must_use]
    pub fn find(&self) -> Option<PartFile> {
        let bar = self.source.as_ref().and_then(|source| bar::bar_of_program(self.kind, &self.params, source));
        let builtin = || PartFile::builtin(self.number).ok().flatten().filter(|part| part.kind == self.kind);
        bar.or_else(builtin)
    }
}

/// Whether a storage request changes the part that belongs to the current program: another program, or another bar.
#[must_use]
pub fn changes_part(request: &StorageRequest) -> bool {
    match request {
        StorageRequest::CurrentProgram(number) => *number != 0,
        StorageRequest::Param(at, _) => {
            at.bit.is_none() && [param::BAR_DIAMETER, param::BAR_LENGTH].iter().any(|row| row.number == at.number)
        }
        _ => false,
    }
}

/// The command that gives the control the outline of a part, for the drawing.
#[must_use]
pub fn stock_command(part: &PartFile) -> Command {
    Command::SetStock(stock_boxes(part).into())
}

/// The commands that set a part up in the control: work offset G54, tool geometry, stock, and values for the variables
/// that have none. `present` reads a variable.
pub fn part_setup_commands(part: &PartFile, present: impl Fn(u16) -> Option<f64>) -> Vec<Command> {
    let mut commands = vec![Command::SetWorkOffset(0, part.g54_mm.displacement())];
    for offset in &part.offsets {
        let geometry = PerAxis([offset.x / 2.0, 0.0, offset.z]);
        commands.push(Command::SetGeometry(usize::from(offset.number), geometry));
        commands.push(Command::SetCutter(usize::from(offset.number), offset.r, offset.t));
    }
    commands.push(stock_command(part));
    let missing = part.variables.iter().filter(|(number, _)| present(**number).is_none());
    commands.extend(missing.map(|(number, value)| Command::SetVariable(*number, Some(*value))));
    commands
}

/// Bounding boxes of the part and its holders for the drawing, mm.
fn stock_boxes(part: &PartFile) -> Vec<StockBox> {
    let turned = |radius: f64, z: (f64, f64)| (WorkPos::new([-radius, 0.0, z.0]), WorkPos::new([radius, 0.0, z.1]));
    let behind = |looks: FaceDirection, at: f64, thick: f64| match looks {
        FaceDirection::PlusZ => (at - thick, at),
        FaceDirection::MinusZ => (at, at + thick),
    };
    let surface = |surface: &SurfaceFile| match *surface {
        SurfaceFile::Diameter { z_from, z_to, stock, .. } => turned(stock / 2.0, (z_from, z_to)),
        SurfaceFile::Cone { z_from, z_to, stock_from, stock_to, .. } => {
            turned(stock_from.max(stock_to) / 2.0, (z_from, z_to))
        }
        SurfaceFile::Bore { z_from, z_to, stock_from, stock_to, thickness, .. } => {
            turned(stock_from.max(stock_to) / 2.0 + thickness, (z_from, z_to))
        }
        SurfaceFile::Face { looks, x_from, x_to, stock, thickness, turns, .. } => {
            let z = behind(looks, stock, thickness);
            let low = if turns { -x_to / 2.0 } else { x_from / 2.0 };
            (WorkPos::new([low, 0.0, z.0]), WorkPos::new([x_to / 2.0, 0.0, z.1]))
        }
        SurfaceFile::Plane { x_from, x_to, z_from, z_to, stock, .. } => {
            (WorkPos::new([x_from, 0.0, z_from]), WorkPos::new([x_to, stock, z_to]))
        }
        SurfaceFile::Wall { looks, x_from, x_to, y_from, y_to, stock, thickness, .. } => {
            let z = behind(looks, stock, thickness);
            (WorkPos::new([x_from, y_from, z.0]), WorkPos::new([x_to, y_to, z.1]))
        }
        SurfaceFile::Disc { x_from, x_to, stock, .. } => {
            (WorkPos::new([x_from, 0.0, 0.0]), WorkPos::new([x_to, 0.0, stock]))
        }
    };
    let holders = part.bodies.iter().map(|body| turned(body.diameter / 2.0, (body.z_from, body.z_to)));
    let holders = holders.map(|(low, high)| StockBox { low, high, is_workpiece: false });
    let surfaces = part.surfaces.iter().map(surface).map(|(low, high)| StockBox { low, high, is_workpiece: true });
    holders.chain(surfaces).collect()
}
