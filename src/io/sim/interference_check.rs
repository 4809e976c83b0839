//! Interference check of a lathe program before anything moves: finds what its tools would crash into (L9). It uses the
//! same bar, tools and rules as cutting, without time and acceleration.

use super::lathe::{Material, TipMotion, turret_with_tools};
use super::machine_sections::{ToolFile, ToolTurretFile};
use super::part_file::PartFile;
use crate::defs::param::Params;
use crate::units::{Axis, PerAxis, WorkPos};

/// Step along a move, mm: one cell of the bar.
const STEP_MM: f64 = 0.1;
/// Greatest number of steps: 400 m of path.
const MAX_STEPS: u64 = 4_000_000;

/// Tools and bar at the present point of the program.
#[derive(Clone, Debug)]
pub struct InterferenceCheck {
    material: Material,
    tools: Vec<ToolFile>,
    crash_mm: f64,
    station: usize,
    /// Offset X, Z from work coordinates of the program to the tip in part coordinates; `None` until it is known.
    part_from_work: Option<(f64, f64)>,
    spindle_on: bool,
    steps: u64,
}

impl InterferenceCheck {
    /// A new bar, the tools that the parameters define, station 1 in cutting position. `None` without a bar.
    #[must_use]
    pub fn new(part: &PartFile, turret: &ToolTurretFile, params: &Params) -> Option<Self> {
        part.bar?;
        Some(Self {
            material: Material::of_part(part),
            tools: turret_with_tools(turret, params).tools.to_vec(),
            crash_mm: turret.crash_mm,
            station: 0,
            part_from_work: None,
            spindle_on: false,
            steps: 0,
        })
    }

    /// Switches the spindle on or off.
    pub const fn set_spindle(&mut self, on: bool) {
        self.spindle_on = on;
    }

    /// Changes to another station (from 0); with compensation the slides move by `by`, mm.
    pub fn change_tool(&mut self, station: usize, by: Option<PerAxis<f64>>) {
        let tip = |station: usize| self.tools.get(station).map_or((0.0, 0.0), |tool| tool.tip_mm);
        let (old, new) = (tip(self.station), tip(station));
        if let Some((x, z)) = &mut self.part_from_work {
            let by = by.unwrap_or_default();
            *x += new.0 - old.0 + by[Axis::X];
            *z += new.1 - old.1 + by[Axis::Z];
        }
        self.station = station;
    }

    /// Gives the present point new work coordinates. The first call makes them the coordinates of the bar.
    pub fn set_coordinate_system(&mut self, from: WorkPos, to: WorkPos) {
        let (x, z) = self
            .part_from_work
            .map_or((0.0, 0.0), |(x, z)| (x + from[Axis::X] - to[Axis::X], z + from[Axis::Z] - to[Axis::Z]));
        self.part_from_work = Some((x, z));
    }

    /// Checks a straight move in work coordinates; returns the first crash, once per contact.
    pub fn check_move(&mut self, from: WorkPos, to: WorkPos, rapid: bool) -> Option<&'static str> {
        let (shift, tool) = (self.part_from_work?, self.tools.get(self.station)?.clone());
        let length = (to[Axis::X] - from[Axis::X]).hypot(to[Axis::Z] - from[Axis::Z]);
        let pieces = (length / STEP_MM).ceil().max(1.0) as u64;
        if self.steps + pieces > MAX_STEPS {
            return None;
        }
        self.steps += pieces;
        let at = |share: f64| {
            let on = |axis: Axis| from[axis] + (to[axis] - from[axis]) * share;
            (on(Axis::X) + shift.0, on(Axis::Z) + shift.1)
        };
        let (mut before, mut newly) = (at(0.0), None);
        for piece in 1..=pieces {
            let here = at(piece as f64 / pieces as f64);
            let motion = TipMotion { from: before, to: here, rapid, stands: !self.spindle_on };
            let met = self.material.cut(&tool, &motion, self.crash_mm);
            newly = newly.or(met);
            before = here;
        }
        newly
    }
}
