//! What the wheel meets: the part's surfaces, chuck and tailstock or magnet, the dresser (P4–P6, P8 crash).
//!
//! A crash is an overlap that no feed could have given (`crash_mm`), a standing wheel pressed onto the part, any touch
//! of chuck, tailstock, magnet or fixture, or a part that is ground or turned without being held. It is told once a
//! contact; until the wheel has come free nothing more is removed there. A burn is told once a contact, too.
//! DECISION: a part that stands where it should turn gets a flat (event `flat`) and keeps its size; a part that was not
//! held is gone and has no size any more; a crash trips the drives of all axes, and switching the drives off ends that
//! once the axes stand.

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

/// Time in which the dresser's cuts count as one: fed at speed into the rim it breaks, however short the tick, s.
const BITE_S: f64 = 0.1;
/// A slide that is found farther off than this was put there, not driven, mm.
const SWEEP_LIMIT_MM: f64 = 20.0;

/// Where the wheel and what else moves stand in this tick, machine coordinates.
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
    /// The magnet holds, or the part needs none.
    pub held: bool,
    /// The arm of the axial (plane) gauge is out.
    pub probe_out: bool,
}

/// Part, obstacles, dresser and the tip of the plane gauge.
#[derive(Clone, Debug)]
pub(super) struct Grinding {
    machine: Fixed,
    zero: Place,
    surfaces: Vec<Surface>,
    obstacles: Vec<Obstacle>,
    gauge: Option<GaugeFile>,
    /// Nothing of the part or around it stands higher, along the infeed.
    highest_mm: f64,
    /// The tangent of the swivelled head.
    lean: f64,
    broke_dresser: bool,
    /// What the dresser has cut off within `BITE_S`, mm.
    bite_mm: f64,
    broke_probe: bool,
    /// Where the diamond cuts, by chance.
    diamond: Option<DiamondScatter>,
    /// The part was not held and flew away.
    gone: bool,
    /// Where the stroke axis stood a tick ago.
    stroke_before_mm: f64,
    load_percent: f64,
}

/// What the machine file says.
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
    /// Where the reference point of a new wheel is over the part's zero.
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

    /// The diamond cuts where chance has it from now on.
    pub(super) fn scatter(&mut self, diamond: DiamondScatter) {
        self.diamond = Some(diamond);
    }

    /// Puts a part in, fresh from its file, or takes it out.
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

    /// Load of the wheel's motor, percent.
    pub(super) const fn load_percent(&self) -> f64 {
        self.load_percent
    }

    /// The surfaces, to be measured; none once the part has flown away.
    pub(super) fn surfaces(&self) -> &[Surface] {
        if self.gone { &[] } else { &self.surfaces }
    }

    /// The measured part.
    pub(super) fn report(&self) -> PartReport {
        let mut report = PartReport::default();
        self.surfaces().iter().for_each(|surface| surface.report(&mut report));
        report
    }

    /// How much larger the part is than the gauge's set size, µm; `None` where the gauge finds nothing.
    pub(super) fn over_um(&self) -> Option<f64> {
        let gauge = self.gauge?;
        let size = |s: &Surface| s.diameter_at(gauge.z).or_else(|| s.height_at(gauge.x, gauge.z));
        let found = self.surfaces().iter().find_map(size)?;
        Some((found - gauge.set) * 1_000.0)
    }

    /// An event here and now.
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

    /// Where the wheel is and how it moves, part coordinates.
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

    /// One tick of contact. True: something crashed.
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

    /// A part that is not held flies off a table that turns.
    fn flies(&mut self, scene: &Scene, log: &mut EventLog) -> bool {
        let turned = scene.part_rpm >= self.machine.cutting.part_stands_rpm;
        if scene.held || self.gone || !turned || self.surfaces.is_empty() {
            return false;
        }
        self.gone = true;
        log.push(self.event(EventKind::Crash, "part, not held on the table", scene))
    }

    /// How far the tip of the plane gauge is pressed in, mm; `None` in the air or with the arm in.
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

    /// The tip of the plane gauge gives way only so far.
    fn probe_breaks(&mut self, scene: &Scene, log: &mut EventLog) -> bool {
        let broken = self.pressed_mm(scene).is_some_and(|mm| mm > self.machine.probe.travel_mm);
        let newly = broken && !self.broke_probe;
        self.broke_probe = broken;
        newly && log.push(self.event(EventKind::Crash, "gauge", scene))
    }

    /// The dresser cuts back the slices of the rim that stand over it.
    fn dress(&mut self, scene: &Scene, wheel: &mut Wheel, log: &mut EventLog) -> bool {
        let Some(dresser) = &self.machine.dresser else { return false };
        let at = self.machine.layout.place(scene.slide_mm);
        let (width_mm, roll_mm) =
            dresser.roll.as_ref().map_or((0.0, 0.0), |roll| (roll.width_mm, roll.diameter_mm / 2.0));
        // Two circles over each other: off by d along the stroke the one stands lower.
        let (both, off) = (wheel.radius_mm() + roll_mm, at.stroke_mm - dresser.stroke_mm);
        let lift = both - (both * both - off * off).max(0.0).sqrt();
        let towards = if dresser.behind { -1.0 } else { 1.0 };
        let deeper = self.diamond.as_ref().map_or(0.0, DiamondScatter::deeper_mm);
        // A swivelled rim stands back by its lean where the dresser is.
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
                // A diamond comes over a slice at its full depth, a roll is fed into it bit by bit.
                let sharpened = if is_roll { depth / sharpens_mm } else { f64::from(u8::from(depth >= sharpens_mm)) };
                if depth > 0.0 {
                    wheel.dress(slice, depth, sharpened.min(1.0));
                }
            }
        }
        false
    }
}

/// What one surface gave in a tick.
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
    /// A place of the slides as the wheel sees it, standing.
    fn place(self, at_mm: PerAxis<f64>) -> Pass {
        let stroke_mm = self.stroke.map_or(0.0, |axis| at_mm[axis]);
        let (front_mm, left_mm) = (at_mm[self.infeed], at_mm[self.across]);
        Pass { front_mm, left_mm, stroke_mm, stroke_before_mm: stroke_mm, ..Pass::default() }
    }
}
