//! Contacts of the wheel: the part's surfaces, chuck, tailstock or magnet, the dresser (P4–P6, P8 crash).
//!
//! A crash is an overlap deeper than any feed produces (`crash_mm`), a stopped wheel pressed onto the part, any contact
//! with chuck, tailstock, magnet or fixture, or a part that is ground or rotated without being held. It is logged once
//! per contact; nothing is removed there until the wheel is clear. A burn is also logged once per contact.
//! DECISION: a part that is stopped where it should rotate gets a flat (event `flat`) and keeps its size; a part that
//! was not held is lost and has no size; a crash trips the drives of all axes until the drives are switched off and the
//! axes are at rest.

use super::machine_file::MachineFile;
use super::machine_rows::{CuttingFile, DresserFile, LayoutFile, PlateFile, ProbeFile};
use super::obstacle::Obstacle;
use super::part_file::{GaugeFile, PartFile, Place};
use super::report::{Event, EventKind, EventLog, PartReport};
use super::scatter::DiamondScatter;
use super::spindle::Spindle;
use super::surface::{Pass, Surface, Touch, Traverse};
use super::wheel::Wheel;
use crate::io::random::SplitMix64;
use crate::units::{Axis, PerAxis};

/// Time over which dressing cuts are summed, s: a dresser fed too fast into the rim breaks, however short the tick.
const BITE_S: f64 = 0.1;
/// A slide that moved farther than this in one tick was placed, not driven, mm.
const SWEEP_LIMIT_MM: f64 = 20.0;

/// Positions and speeds in this tick, machine coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scene {
    pub seconds: f64,
    pub dt_s: f64,
    pub slide_mm: PerAxis<f64>,
    pub speed_mm_s: PerAxis<f64>,
    pub wheel: Spindle,
    pub wheel_m_s: f64,
    pub part_rpm: f64,
    pub roll_rpm: f64,
    pub tailstock_back_mm: f64,
    /// The magnet holds the part, or the machine has no magnet.
    pub held: bool,
    /// The arm of the axial (plane) gauge is out.
    pub probe_out: bool,
}

/// Part, obstacles, dresser and the tip of the axial (plane) gauge.
#[derive(Clone, Debug)]
pub(super) struct Grinding {
    machine: Fixed,
    zero: Place,
    surfaces: Vec<Surface>,
    obstacles: Vec<Obstacle>,
    gauge: Option<GaugeFile>,
    /// Highest point of part and obstacles along the infeed, mm.
    highest_mm: f64,
    /// Tangent of the swivel angle of the wheel head.
    lean: f64,
    broke_dresser: bool,
    /// Depth that the dresser has cut within `BITE_S`, mm.
    bite_mm: f64,
    broke_probe: bool,
    /// Random depth of the diamond, stroke by stroke.
    diamond: Option<DiamondScatter>,
    /// The part was not held and was thrown out.
    gone: bool,
    /// Position of the stroke axis one tick ago, mm.
    stroke_before_mm: f64,
    load_percent: f64,
}

/// Values from the machine file.
#[derive(Clone, Debug)]
struct Fixed {
    layout: LayoutFile,
    cutting: CuttingFile,
    dresser: Option<DresserFile>,
    plate: Option<PlateFile>,
    probe: ProbeFile,
    traverse: Traverse,
    idle_percent: f64,
    power_w: f64,
    wheel_radius_mm: f64,
}

impl Fixed {
    /// Position of the slides with the reference point of a new wheel at the work zero.
    const fn zero_of(&self, mut work: Place) -> Place {
        let radius_mm = if self.layout.centre { self.wheel_radius_mm } else { 0.0 };
        match self.layout.infeed {
            Axis::X => work.x += radius_mm,
            Axis::Y => work.y += radius_mm,
            Axis::Z => work.z += radius_mm,
        }
        work
    }
}

impl Grinding {
    /// A machine without a part.
    pub(super) fn new(file: &MachineFile) -> Self {
        let traverse = Traverse {
            across_mm: file.cutting.traverse_cylinder_mm,
            face_mm: file.cutting.traverse_face_mm,
            plane_mm: file.cutting.traverse_plane_mm,
            contact_mm: file.cutting.contact_mm,
        };
        let machine = Fixed {
            layout: file.layout,
            cutting: file.cutting.clone(),
            dresser: file.dresser.clone(),
            plate: file.magnet.as_ref().map(|magnet| magnet.plate.clone()),
            probe: file.gauges.probe.clone(),
            traverse,
            idle_percent: file.wheel.idle_load_percent,
            power_w: file.wheel.power_w,
            wheel_radius_mm: file.wheel.diameter_mm / 2.0,
        };
        Self {
            machine,
            zero: Place::default(),
            surfaces: Vec::new(),
            obstacles: Vec::new(),
            gauge: None,
            highest_mm: f64::NEG_INFINITY,
            lean: 0.0,
            broke_dresser: false,
            bite_mm: 0.0,
            broke_probe: false,
            diamond: None,
            gone: false,
            stroke_before_mm: f64::INFINITY,
            load_percent: 0.0,
        }
    }

    /// Sets the random depth of the diamond.
    pub(super) fn scatter(&mut self, diamond: DiamondScatter) {
        self.diamond = Some(diamond);
    }

    /// Loads a new part from its file, or removes the part.
    pub(super) fn set_part(&mut self, part: Option<&PartFile>, chance: &mut SplitMix64) {
        self.surfaces.clear();
        self.obstacles.clear();
        self.gauge = None;
        self.gone = false;
        if let Some(part) = part {
            self.zero = self.machine.zero_of(part.g54_mm);
            self.lean = part.head_deg.to_radians().tan();
            self.gauge = part.gauge;
            self.surfaces.extend(part.surfaces.iter().filter_map(|file| Surface::new(file, chance)));
            self.obstacles.extend(part.bodies.iter().map(Obstacle::of_body));
            self.obstacles.extend(part.blocks.iter().flat_map(Obstacle::of_block));
            self.obstacles.extend(part.tailstock.as_ref().map(Obstacle::of_tailstock));
        }
        let zero = self.machine.layout.place(PerAxis([self.zero.x, self.zero.y, self.zero.z]));
        self.obstacles.extend(self.machine.plate.as_ref().map(|plate| Obstacle::of_plate(plate, &zero)));
        let surfaces = self.surfaces.iter().map(Surface::reach_mm);
        let obstacles = self.obstacles.iter().map(Obstacle::top_mm);
        self.highest_mm = surfaces.chain(obstacles).fold(f64::NEG_INFINITY, f64::max);
    }

    /// Load of the wheel motor, percent.
    pub(super) const fn load_percent(&self) -> f64 {
        self.load_percent
    }

    /// The surfaces to be measured; empty once the part is lost.
    pub(super) fn surfaces(&self) -> &[Surface] {
        if self.gone { &[] } else { &self.surfaces }
    }

    /// Measures the part.
    pub(super) fn report(&self) -> PartReport {
        let mut report = PartReport::default();
        self.surfaces().iter().for_each(|surface| surface.report(&mut report));
        report
    }

    /// Size of the part above the set size of the gauge, µm; `None` if there is nothing to measure.
    pub(super) fn over_um(&self) -> Option<f64> {
        let gauge = self.gauge?;
        let size = |s: &Surface| s.diameter_at(gauge.z).or_else(|| s.height_at(gauge.x, gauge.z));
        let found = self.surfaces().iter().find_map(size)?;
        Some((found - gauge.set) * 1_000.0)
    }

    /// An event at the current time and position.
    pub(super) fn event(&self, kind: EventKind, place: &'static str, scene: &Scene) -> Event {
        let at = PerAxis::from_fn(|axis| scene.slide_mm[axis] - self.zero_of(axis));
        let layout = self.machine.layout;
        let whole = scene.speed_mm_s.0.iter().map(|v| v * v).sum::<f64>().sqrt();
        Event {
            kind,
            seconds: scene.seconds,
            place,
            x: if layout.infeed == Axis::X { 2.0 * at[Axis::X] } else { at[Axis::X] },
            y: [Some(layout.infeed), layout.stroke].contains(&Some(Axis::Y)).then_some(at[Axis::Y]),
            z: at[Axis::Z],
            speed: whole * 60.0,
            wheel_m_s: scene.wheel_m_s,
        }
    }

    const fn zero_of(&self, axis: Axis) -> f64 {
        match axis {
            Axis::X => self.zero.x,
            Axis::Y => self.zero.y,
            Axis::Z => self.zero.z,
        }
    }

    /// Position and motion of the wheel, part coordinates.
    fn pass(&mut self, scene: &Scene) -> Pass {
        let layout = self.machine.layout;
        let mut pass = layout.place(PerAxis::from_fn(|axis| scene.slide_mm[axis] - self.zero_of(axis)));
        let far = (pass.stroke_mm - self.stroke_before_mm).abs() > SWEEP_LIMIT_MM;
        pass.stroke_before_mm = if far { pass.stroke_mm } else { self.stroke_before_mm };
        self.stroke_before_mm = pass.stroke_mm;
        pass.infeed_mm_s = scene.speed_mm_s[layout.infeed].abs();
        pass.across_mm_s = scene.speed_mm_s[layout.across].abs();
        pass.stroke_mm_s = layout.stroke.map_or(0.0, |axis| scene.speed_mm_s[axis].abs());
        pass.dt_s = scene.dt_s;
        pass.lean = self.lean;
        pass.traverse = self.machine.traverse;
        pass
    }

    /// Processes the contacts of one tick; true if something crashed.
    pub(super) fn step(&mut self, scene: &Scene, wheel: &mut Wheel, log: &mut EventLog) -> bool {
        self.load_percent = if scene.wheel.rpm() > 0.0 { self.machine.idle_percent } else { 0.0 };
        let pass = self.pass(scene);
        let mut crashed = self.dress(scene, wheel, log);
        crashed |= self.flies(scene, log);
        crashed |= self.probe_breaks(scene, log);
        if pass.front_mm - self.lean.abs() * wheel.width_mm() >= self.highest_mm {
            self.come_free();
            return crashed;
        }
        let (mut volume, mut lost) = (0.0, false);
        for index in 0..if self.gone { 0 } else { self.surfaces.len() } {
            let met = meet(&mut self.surfaces[index], &pass, wheel, &self.machine.cutting, scene);
            volume += met.volume_mm3;
            lost |= met.lost;
            if let Some((kind, place)) = met.told {
                crashed |= log.push(self.event(kind, place, scene)) && kind == EventKind::Crash;
            }
        }
        self.gone |= lost;
        for index in 0..self.obstacles.len() {
            if self.obstacles[index].newly_hit(&pass, wheel, scene.tailstock_back_mm) {
                crashed |= log.push(self.event(EventKind::Crash, self.obstacles[index].name, scene));
            }
        }
        if volume > 0.0 {
            // J/mm³ · mm³/s = W.
            let watts = self.machine.cutting.energy_j_mm3 * volume / scene.dt_s;
            self.load_percent += 100.0 * watts / self.machine.power_w;
        }
        crashed
    }

    fn come_free(&mut self) {
        for surface in &mut self.surfaces {
            surface.touch = Touch::default();
        }
        self.obstacles.iter_mut().for_each(Obstacle::come_free);
    }

    /// Throws the part off a rotating table if it is not held.
    fn flies(&mut self, scene: &Scene, log: &mut EventLog) -> bool {
        let turned = scene.part_rpm >= self.machine.cutting.part_stands_rpm;
        if scene.held || self.gone || !turned || self.surfaces.is_empty() {
            return false;
        }
        self.gone = true;
        log.push(self.event(EventKind::Crash, "part, not held on the table", scene))
    }

    /// Deflection of the plane gauge's tip, mm; `None` without contact or with the arm retracted.
    pub(super) fn pressed_mm(&self, scene: &Scene) -> Option<f64> {
        if !scene.probe_out {
            return None;
        }
        let tip =
            self.tip(self.machine.layout.place(PerAxis::from_fn(|axis| scene.slide_mm[axis] - self.zero_of(axis))));
        let inside = self.surfaces().iter().filter_map(|surface| surface.inside_mm(&tip));
        inside.filter(|mm| *mm >= 0.0).max_by(f64::total_cmp)
    }

    fn tip(&self, mut at: Pass) -> Pass {
        at.front_mm += self.machine.probe.infeed_mm;
        at.left_mm += self.machine.probe.across_mm;
        at.stroke_mm += self.machine.probe.stroke_mm;
        at
    }

    /// Breaks the plane gauge if its tip is deflected beyond its travel.
    fn probe_breaks(&mut self, scene: &Scene, log: &mut EventLog) -> bool {
        let broken = self.pressed_mm(scene).is_some_and(|mm| mm > self.machine.probe.travel_mm);
        let newly = broken && !self.broke_probe;
        self.broke_probe = broken;
        newly && log.push(self.event(EventKind::Crash, "gauge", scene))
    }

    /// Dresses the slices of the rim that are over the dresser; true if it crashed.
    fn dress(&mut self, scene: &Scene, wheel: &mut Wheel, log: &mut EventLog) -> bool {
        let Some(dresser) = &self.machine.dresser else { return false };
        let at = self.machine.layout.place(scene.slide_mm);
        let (width_mm, roll_mm) =
            dresser.roll.as_ref().map_or((0.0, 0.0), |roll| (roll.width_mm, roll.diameter_mm / 2.0));
        // Two circles: offset along the stroke, the wheel reaches less deep.
        let (both, off) = (wheel.radius_mm() + roll_mm, at.stroke_mm - dresser.stroke_mm);
        let lift = both - (both * both - off * off).max(0.0).sqrt();
        let towards = if dresser.behind { -1.0 } else { 1.0 };
        let deeper = self.diamond.as_ref().map_or(0.0, DiamondScatter::deeper_mm);
        // The rim of a swivelled wheel is set back at the dresser's position along it.
        let back = self.lean * (dresser.across_mm - at.left_mm);
        let reach = towards * (dresser.infeed_mm - at.front_mm + back) - lift + deeper;
        let slices = wheel.slices_over(dresser.across_mm - at.left_mm, width_mm);
        if reach <= 0.0 || off.abs() >= both || slices.is_empty() {
            if self.bite_mm > 0.0
                && let Some(diamond) = &mut self.diamond
            {
                diamond.next_stroke();
            }
            self.broke_dresser = false;
            self.bite_mm = 0.0;
            return false;
        }
        self.bite_mm *= 1.0 - (scene.dt_s / BITE_S).min(1.0);
        let depth = slices.clone().map(|slice| reach - wheel.rim_mm(slice)).fold(0.0, f64::max);
        if depth <= 0.0 || self.broke_dresser {
            return false;
        }
        let (crash_mm, sharpens_mm, is_roll) = (dresser.crash_mm, dresser.sharpens_mm, dresser.roll.is_some());
        let roll_stands = is_roll && scene.roll_rpm < self.machine.cutting.part_stands_rpm;
        let standing = !scene.wheel.cuts() || roll_stands;
        self.bite_mm += if standing { 0.0 } else { depth };
        let too_deep = depth.max(self.bite_mm) > crash_mm;
        if too_deep || (standing && depth > self.machine.cutting.crash_standing_mm) {
            self.broke_dresser = true;
            let place = if !too_deep && roll_stands { "dresser, roll standing" } else { "dresser" };
            return log.push(self.event(EventKind::Crash, place, scene));
        }
        if !standing {
            for slice in slices {
                let depth = reach - wheel.rim_mm(slice);
                // A diamond cuts a slice at full depth in one pass; a roll is fed in gradually.
                let sharpened = if is_roll { depth / sharpens_mm } else { f64::from(u8::from(depth >= sharpens_mm)) };
                if depth > 0.0 {
                    wheel.dress(slice, depth, sharpened.min(1.0));
                }
            }
        }
        false
    }
}

/// Result of the contact with one surface in one tick.
#[derive(Default)]
struct Met {
    volume_mm3: f64,
    told: Option<(EventKind, &'static str)>,
    /// The part was not held.
    lost: bool,
}

fn meet(surface: &mut Surface, pass: &Pass, wheel: &mut Wheel, cutting: &CuttingFile, scene: &Scene) -> Met {
    let overlap = surface.overlap_mm(pass, wheel);
    if overlap <= 0.0 {
        surface.touch = Touch::default();
        return Met::default();
    }
    if surface.touch.crashed {
        return Met::default();
    }
    let tell = |kind, place| Met { told: Some((kind, place)), ..Met::default() };
    if overlap > cutting.crash_mm {
        surface.touch.crashed = true;
        return tell(EventKind::Crash, "part");
    }
    if !scene.wheel.cuts() {
        if overlap > cutting.crash_standing_mm {
            surface.touch.crashed = true;
            return tell(EventKind::Crash, "part, wheel standing");
        }
        return Met::default();
    }
    if !scene.held {
        surface.touch.crashed = true;
        return Met { lost: true, ..tell(EventKind::Crash, "part, not held") };
    }
    if surface.turns() && scene.part_rpm < cutting.part_stands_rpm {
        if overlap > cutting.flat_mm && !surface.touch.flat {
            surface.touch.flat = true;
            return tell(EventKind::Flat, surface.stands());
        }
        return Met::default();
    }
    let cut = surface.grind(pass, wheel);
    let burns = cut.specific_mm2 > cutting.burn_mm2_s * pass.dt_s && !surface.touch.burnt;
    surface.touch.burnt |= burns;
    Met { volume_mm3: cut.volume_mm3, told: burns.then_some((EventKind::Burn, "part")), lost: false }
}

impl LayoutFile {
    /// Slide positions in wheel directions, at rest.
    fn place(self, at_mm: PerAxis<f64>) -> Pass {
        let stroke_mm = self.stroke.map_or(0.0, |axis| at_mm[axis]);
        let (front_mm, left_mm) = (at_mm[self.infeed], at_mm[self.across]);
        Pass { front_mm, left_mm, stroke_mm, stroke_before_mm: stroke_mm, ..Pass::default() }
    }
}
