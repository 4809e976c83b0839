//! A lathe: main spindle with encoder, tool turret with station switches, and the bar that a tool cuts (L7, L8, L10).
//!
//! The bar is a radius per cell along Z. Inside the bar the edge of the tool's outline cuts and its shank crashes.
//! DECISION: a thread leaves the envelope of its root; chips, cutting force and deflection are not modelled.

use super::grinding::MachineState;
use super::machine_sections::{MainSpindleFile, TablePoint, ToolFile, ToolTurretFile};
use super::part_file::{BarFile, BodyFile, PartFile, SlidePosition};
use super::report::{DiameterAt, PartReport};
use crate::defs::lathe_workspace::LatheWorkspace;
use crate::defs::param::Params;
use crate::defs::signal::{Output, OutputSet};
use crate::defs::turning_tool::TurningTool;
use crate::units::Axis;

/// Below this an analog output commands no speed, V. The smallest S is 1 rpm: 0.002 V where 10 V are 5000 rpm.
const MIN_SPEED_VOLTS: f64 = 0.000_5;
const FULL_VOLTS: f64 = 10.0;
/// Distance from its station within which a switch is on, in stations.
const SWITCH_WIDTH: f64 = 0.08;
/// Below this the spindle counts as stopped, rpm: less than any S that can be programmed.
const STANDSTILL_RPM: f64 = 0.5;
/// Above these an axis is in rapid traverse, mm/s: faster than any feed (2000 mm/min along Z, half of it along X).
const RAPID_X_MM_S: f64 = 20.0;
const RAPID_Z_MM_S: f64 = 35.0;
/// Spacing of the measurements in a report, mm.
const REPORT_SPACING_MM: f64 = 5.0;
/// Greatest number of measurements in a report.
const MAX_REPORT_PLACES: usize = 100;
/// A tip that moved farther than this along Z in one step was placed, not driven, mm.
const MAX_STEP_MM: f64 = 5.0;
const STATIONS: f64 = 4.0;

/// Present shape of the bar, part coordinates.
#[derive(Clone, Debug)]
struct Bar {
    z_from: f64,
    cell: f64,
    /// Radius of each cell, mm.
    radius: Vec<f64>,
    stock: f64,
}

/// Main spindle, tool turret and bar.
#[derive(Clone, Debug)]
pub(super) struct SimLathe {
    spindle: MainSpindleFile,
    turret: ToolTurretFile,
    /// Latched direction of the spindle: +1 forward, −1 reverse, 0 off.
    direction: f64,
    /// Speed of the spindle, rpm, forward positive.
    pub(super) rpm: f64,
    turns: f64,
    /// Station in cutting position, from 0; the fraction is the progress to the next one.
    station: f64,
    work_zero: SlidePosition,
    material: Material,
    /// X and Z of the tip one step ago, part coordinates.
    previous_tip: Option<(f64, f64)>,
}

/// How the tip of a tool moves in one step.
pub(super) struct TipMotion {
    /// X (radius) and Z before and after the step, part coordinates.
    pub from: (f64, f64),
    pub to: (f64, f64),
    pub rapid: bool,
    /// Whether the spindle stands.
    pub stands: bool,
}

/// What a tool meets: the bar and the chuck.
#[derive(Clone, Debug, Default)]
pub(super) struct Material {
    bar: Option<Bar>,
    bodies: Vec<BodyFile>,
    /// Crash in progress, already reported.
    active_crash: Option<&'static str>,
}

impl SimLathe {
    /// Everything at rest, station 1 in cutting position, no bar.
    pub(super) const fn new(spindle: MainSpindleFile, turret: ToolTurretFile) -> Self {
        Self {
            spindle,
            turret,
            direction: 0.0,
            rpm: 0.0,
            turns: 0.0,
            station: 0.0,
            work_zero: SlidePosition { x: 0.0, y: 0.0, z: 0.0 },
            material: Material { bar: None, bodies: Vec::new(), active_crash: None },
            previous_tip: None,
        }
    }

    /// Sets the tool shapes that the parameters define.
    pub(super) fn apply_tool_shapes(&mut self, params: &Params) {
        self.turret = turret_with_tools(&self.turret, params);
    }

    /// Loads a bar, or removes it.
    pub(super) fn set_part(&mut self, part: Option<&PartFile>) {
        self.material = part.map(Material::of_part).unwrap_or_default();
        self.work_zero = part.map_or_else(SlidePosition::default, |part| part.g54_mm);
        self.previous_tip = None;
    }

    /// One step of spindle and tool turret.
    pub(super) fn step(&mut self, on: OutputSet, volts: f64, dt_s: f64) {
        if on.has(Output::SpindleStop) {
            self.direction = 0.0;
        } else if on.has(Output::SpindleForward) {
            self.direction = 1.0;
        } else if on.has(Output::SpindleReverse) {
            self.direction = -1.0;
        }
        let file = &self.spindle;
        let speed = if volts > MIN_SPEED_VOLTS {
            file.rpm_at_10_v * volts.min(FULL_VOLTS) / FULL_VOLTS
        } else {
            file.mains_rpm
        };
        let most = file.mains_rpm.max(speed) / file.run_up_s * dt_s;
        self.rpm += (self.direction * speed - self.rpm).clamp(-most, most);
        let sway = 1.0 + file.unevenness * (std::f64::consts::TAU * self.turns).sin();
        self.turns += self.rpm * sway / 60.0 * dt_s;
        if on.has(Output::TurretForward) {
            self.station = (self.station + dt_s / self.turret.step_s).rem_euclid(STATIONS);
        } else if on.has(Output::TurretReverse) {
            self.station = self.station.round().rem_euclid(STATIONS);
        }
    }

    /// Encoder reading: revolutions since power-on, in encoder steps.
    pub(super) fn encoder_turns(&self) -> f64 {
        (self.turns * self.spindle.encoder_steps).floor() / self.spindle.encoder_steps
    }

    /// Whether the switch of a station (from 0) is on.
    pub(super) fn at_station(&self, station: usize) -> bool {
        let off = (self.station - station as f64).rem_euclid(STATIONS);
        off.min(STATIONS - off) <= SWITCH_WIDTH
    }

    /// The tool in cutting position.
    fn tool(&self) -> &ToolFile {
        &self.turret.tools[self.station.round() as usize % self.turret.tools.len()]
    }

    /// Cuts for one tick; returns a newly started crash.
    pub(super) fn cut(&mut self, scene: &MachineState) -> Option<&'static str> {
        let tool = self.tool().clone();
        let x = scene.slide_mm[Axis::X] + tool.tip_mm.0 - self.work_zero.x;
        let z = scene.slide_mm[Axis::Z] + tool.tip_mm.1 - self.work_zero.z;
        // Only inward X speed counts: a tool that retracts from the bar, as at the end of a thread, does not crash.
        let inwards = -scene.speed_mm_s[Axis::X];
        let rapid = inwards > RAPID_X_MM_S || scene.speed_mm_s[Axis::Z].abs() > RAPID_Z_MM_S;
        let stands = self.rpm.abs() < STANDSTILL_RPM;
        let from = self.previous_tip.filter(|before| (before.1 - z).abs() < MAX_STEP_MM).unwrap_or((x, z));
        self.previous_tip = Some((x, z));
        self.material.cut(&tool, &TipMotion { from, to: (x, z), rapid, stands }, self.turret.crash_mm)
    }

    /// Diameter of the bar at Z, mm; `None` outside the bar.
    pub(super) fn diameter_at(&self, z: f64) -> Option<f64> {
        self.material.bar.as_ref()?.diameter_at(z)
    }

    /// Bar, chuck and tool for the drawing; `None` without a bar.
    pub(super) fn workspace(&self) -> Option<LatheWorkspace> {
        let bar = self.material.bar.as_ref()?;
        let tool = self.tool();
        let pair = |a: f64, b: f64| (a as f32, b as f32);
        let body = |body: &BodyFile| (body.z_from as f32, body.z_to as f32, (body.diameter / 2.0) as f32);
        Some(LatheWorkspace {
            zero_mm: pair(self.work_zero.x, self.work_zero.z),
            chuck_face_z_mm: bar.z_from as f32,
            cell_mm: bar.cell as f32,
            radius_mm: bar.radius.iter().map(|radius| *radius as f32).collect(),
            stock_radius_mm: bar.stock as f32,
            bodies: self.material.bodies.iter().map(body).collect(),
            tip_mm: pair(tool.tip_mm.0, tool.tip_mm.1),
            outline_mm: tool.outline_mm.iter().map(|point| pair(point.0, point.1)).collect(),
        })
    }

    /// Adds the diameters of the bar to the report.
    pub(super) fn report(&self, report: &mut PartReport) {
        let Some(bar) = &self.material.bar else { return };
        let length = bar.radius.len() as f64 * bar.cell;
        let places = ((length / REPORT_SPACING_MM) as usize).min(MAX_REPORT_PLACES);
        for place in 0..places {
            let z = bar.z_from + length - REPORT_SPACING_MM * (place as f64 + 0.5);
            if let Some(d) = bar.diameter_at(z) {
                report.diameters.push(DiameterAt { z, d });
            }
        }
    }
}

/// The tool turret with the tools that the parameters define.
pub(super) fn turret_with_tools(turret: &ToolTurretFile, params: &Params) -> ToolTurretFile {
    let mut turret = turret.clone();
    for (station, tool) in turret.tools.iter_mut().enumerate() {
        let defined = TurningTool::of_station(params, station);
        tool.edge_mm = defined.edge_mm;
        tool.outline_mm = defined.outline_mm().into_iter().map(|(z, height)| TablePoint(z, height)).collect();
    }
    turret
}

impl Material {
    /// The bar and the chuck of a part.
    pub(super) fn of_part(part: &PartFile) -> Self {
        Self { bar: part.bar.as_ref().map(Bar::new), bodies: part.bodies.clone(), active_crash: None }
    }

    /// Cuts along a path of the tip; returns a newly started crash.
    pub(super) fn cut(&mut self, tool: &ToolFile, motion: &TipMotion, crash_mm: f64) -> Option<&'static str> {
        let (x, z) = motion.to;
        let chuck = self.bodies.iter().any(|body| tool.touches(x, z, body)).then_some("chuck");
        let bar = self.bar.as_mut().and_then(|bar| bar.cut(tool, motion, crash_mm));
        let before = std::mem::replace(&mut self.active_crash, chuck.or(bar));
        self.active_crash.filter(|_| before.is_none())
    }
}

impl ToolFile {
    /// Height of the outline at a Z distance from the tip, mm; `None` beside the tool.
    fn height(&self, dz: f64) -> Option<f64> {
        let after = self.outline_mm.partition_point(|point| point.0 < dz);
        let b = self.outline_mm.get(after)?;
        if b.0 <= dz {
            return Some(b.1);
        }
        let a = self.outline_mm.get(after.checked_sub(1)?)?;
        Some(a.1 + (b.1 - a.1) * (dz - a.0) / (b.0 - a.0))
    }

    fn span(&self) -> (f64, f64) {
        (self.outline_mm.first().map_or(0.0, |point| point.0), self.outline_mm.last().map_or(0.0, |point| point.0))
    }

    /// Whether any point of the outline is inside a body.
    fn touches(&self, x: f64, z: f64, body: &BodyFile) -> bool {
        let (from, to) = self.span();
        let (low, high) = ((body.z_from - z).max(from), (body.z_to - z).min(to));
        let inside = |dz: f64| self.height(dz).is_some_and(|height| x + height < body.diameter / 2.0);
        let corners = self.outline_mm.iter().map(|point| point.0).filter(|dz| (low..=high).contains(dz));
        low <= high && (inside(low) || inside(high) || corners.into_iter().any(inside))
    }
}

impl Bar {
    fn new(file: &BarFile) -> Self {
        let cells = ((file.z_to - file.z_from) / file.cell).round().max(1.0) as usize;
        let stock = file.diameter / 2.0;
        Self { z_from: file.z_from, cell: file.cell, radius: vec![stock; cells], stock }
    }

    fn diameter_at(&self, z: f64) -> Option<f64> {
        let index = (z - self.z_from) / self.cell;
        if index < 0.0 { None } else { self.radius.get(index as usize).map(|radius| 2.0 * radius) }
    }

    /// Cuts with the edge; returns the first crash.
    fn cut(&mut self, tool: &ToolFile, motion: &TipMotion, crash_mm: f64) -> Option<&'static str> {
        let TipMotion { from, to: (x, z), rapid, stands } = *motion;
        if x.min(from.0) >= self.stock {
            return None;
        }
        let (low, high) = tool.span();
        let (back, ahead) = (z.min(from.1), z.max(from.1));
        let first = ((back + low - self.z_from) / self.cell).floor().max(0.0) as usize;
        let end = ((ahead + high - self.z_from) / self.cell).ceil().clamp(0.0, self.radius.len() as f64) as usize;
        let mut met = None;
        for index in first..end {
            let middle = self.z_from + (index as f64 + 0.5) * self.cell;
            // The tip itself cuts the cells that it has passed since the last step.
            let passed = (back..=ahead).contains(&middle) && ahead > back;
            let (height, edge) = if passed {
                (0.0, x + (from.0 - x) * (middle - z) / (from.1 - z))
            } else {
                let Some(height) = tool.height(middle - z) else { continue };
                (height, x + height)
            };
            let edge = edge.max(0.0);
            let depth = self.radius[index] - edge;
            if depth <= 0.0 {
                continue;
            }
            // Deeper than the edge the shank is in contact.
            let place = if depth > tool.edge_mm || height > tool.edge_mm && depth > crash_mm {
                Some("part, tool shank")
            } else if stands && depth > crash_mm {
                Some("part, spindle stopped")
            } else if rapid && depth > crash_mm {
                Some("part, rapid traverse")
            } else {
                None
            };
            met = met.or(place);
            // In rapid traverse or with a stopped spindle nothing is removed, so the overlap grows from tick to tick.
            if !stands && !rapid && place.is_none() {
                self.radius[index] = edge;
            }
        }
        met
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn l10_a_tool_that_goes_along_leaves_its_diameter() {
        let outline_mm = vec![TablePoint(0.0, 0.0), TablePoint(8.0, 1.5), TablePoint(8.1, 8.1), TablePoint(25.0, 8.1)];
        let tool = ToolFile { tip_mm: (0.0, 0.0), edge_mm: 8.0, outline_mm };
        let mut bar = Bar::new(&BarFile { diameter: 45.0, z_from: -100.0, z_to: 0.0, cell: 0.1 });
        // Radius 20 from the face to Z −30 in steps of 0.1 mm.
        for step in 0..=320 {
            let z = 2.0 - 0.1 * f64::from(step);
            let motion = TipMotion { from: (20.0, z + 0.1), to: (20.0, z), rapid: false, stands: false };
            assert_eq!(bar.cut(&tool, &motion, 0.05), None);
        }
        assert_eq!(bar.diameter_at(-20.0), Some(40.0));
        assert_eq!(bar.diameter_at(-40.0), Some(45.0));
        assert_eq!(bar.diameter_at(1.0), None);
    }
}
