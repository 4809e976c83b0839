//! Contacts of the wheel: the part's surfaces, chuck, tailstock or magnet, the dresser (P4–P6, P8 crash).
//!
//! A crash is an overlap deeper than any feed produces (`crash_mm`), a stopped wheel pressed onto the part, any contact
//! with chuck, tailstock, magnet or fixture, or a part that is ground or rotated without being held. It is logged once
//! per contact; nothing is removed there until the wheel is clear. A burn is also logged once per contact.
//! DECISION: a part that is stopped where it should rotate gets a flat (event `flat`) and keeps its size; a part that
//! was not held is lost and has no size; a crash trips the drives of all axes until the drives are switched off and the
//! axes are at rest.

use std::ops::Range;

use super::bending::{Beam, Bending, LOWEST_FORCE_SPEED_M_S};
use super::contact_law::{Cut, TraverseLengths, WheelMotion};
use super::heat::{ContactPower, burns};
use super::machine_file::MachineFile;
use super::machine_sections::{DresserFile, LayoutFile};
use super::obstacle::Obstacle;
use super::part_file::{GaugeSetupFile, PartFile};
use super::part_heat::PartHeat;
use super::report::{EventKind, EventLog, SimEvent};
use super::scatter::DiamondScatter;
use super::spindle::Spindle;
use super::surface::{ContactFlags, Surface};
use super::vibration::{TurningWheel, Vibration};
use super::wheel::{GrindingWheel, Side};
use crate::defs::grinding_workspace::{DresserShape, GrindingWorkspace};
use crate::io::random::SplitMix64;
use crate::technology::{DressingPass, roughness_um};
use crate::units::{Axis, MachinePos, PerAxis, Position, WorkPos};

/// Time over which dressing cuts are summed, s: a dresser fed too fast into the rim breaks, however short the tick.
const CUT_WINDOW_S: f64 = 0.1;
/// Length of the holder of a diamond behind the wheel, mm.
const HOLDER_MM: f64 = 60.0;
/// Depth from which a stroke of the diamond is a pass of its own; a shallower one only touches what is left, mm.
const LEAST_PASS_MM: f64 = 0.001;
/// Time after the last contact in which the wheel head chatters, s. DECISION: some tens of its waves.
const CHATTER_S: f64 = 0.2;
/// A slide that moved farther than this in one tick was placed, not driven, mm.
const SWEEP_LIMIT_MM: f64 = 20.0;

/// Positions and speeds in this tick, machine coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) struct MachineState {
    pub seconds: f64,
    pub dt_s: f64,
    pub slide_mm: MachinePos,
    pub speed_mm_s: PerAxis<f64>,
    pub wheel: Spindle,
    pub wheel_m_s: f64,
    pub part_rpm: f64,
    /// The part turns on a table, not in a workhead.
    pub on_table: bool,
    pub coolant_flows: bool,
    pub roll_rpm: f64,
    pub tailstock_retracted_mm: f64,
    /// The magnet holds the part, or the machine has no magnet.
    pub part_held: bool,
    /// The arm of the axial (plane) gauge is out.
    pub probe_out: bool,
}

/// Part, obstacles, dresser and the tip of the axial (plane) gauge.
#[derive(Clone, Debug)]
pub(super) struct Grinding {
    machine: MachineFile,
    traverse: TraverseLengths,
    /// Work zero with the reference point of a new wheel, machine coordinates, mm.
    work_zero_mm: PerAxis<f64>,
    surfaces: Vec<Surface>,
    obstacles: Vec<Obstacle>,
    gauge: Option<GaugeSetupFile>,
    /// Radius of the fitted diamond's tip, mm.
    diamond_radius_mm: f64,
    /// The gauge settings of the seats, each in force where the wheel covers it.
    seat_gauges: Vec<GaugeSetupFile>,
    /// Highest point of part and obstacles along the infeed, mm.
    highest_mm: f64,
    /// Tangent of the swivel angle of the wheel head.
    swivel_tan: f64,
    /// What bends: the part, or the quill of an internal grinding spindle.
    beam: Option<Beam>,
    /// The dresser of the spindle that is swung in, and its index in `diamond_wear_mm`.
    dresser: Option<DresserFile>,
    diamond_in_use: usize,
    dresser_broken: bool,
    /// Depth that the dresser has cut within `CUT_WINDOW_S`, mm.
    recent_cut_mm: f64,
    probe_broken: bool,
    /// Random depth of the diamond, stroke by stroke.
    pub(super) diamond: Option<DiamondScatter>,
    /// Wear of the diamonds of the wheel head and of the internal spindle, mm.
    diamond_wear_mm: [f64; 2],
    /// The part was not held and was thrown out.
    part_lost: bool,
    heat: PartHeat,
    /// Position of the stroke axis one tick ago, mm.
    previous_stroke_mm: f64,
    /// When chatter dies away, s: some waves leave the part before they cut it again.
    chatters_until_s: f64,
    /// Vibration of the wheel in this tick.
    pub(super) vibration: Vibration,
    /// What the contacts take from the wheel motor.
    pub(super) power: ContactPower,
    /// Load of the wheel motor, percent.
    pub(super) load_percent: f64,
    /// Tangential force on the part, N.
    pub(super) tangential_n: f64,
    /// The wheel has removed something in this tick: of the part, or it was dressed.
    pub(super) removes: bool,
    /// It has removed something of the part.
    grinds: bool,
    /// Width and radius of the dressing roll, mm; zero for a diamond. Copied from the machine file: read from there, the
    /// compiler calculates with the bytes of a roll that is not there, which may be denormal and slow.
    roll_width_mm: f64,
    roll_radius_mm: f64,
}

impl Grinding {
    /// A machine without a part.
    pub(super) fn new(file: &MachineFile) -> Self {
        let traverse = TraverseLengths {
            across_mm: file.cutting.traverse_cylinder_mm,
            face_mm: file.cutting.traverse_face_mm,
            plane_mm: file.cutting.traverse_plane_mm,
            contact_mm: file.cutting.contact_mm,
        };
        let roll = file.dresser.as_ref().and_then(|dresser| dresser.roll.as_ref());
        Self {
            machine: file.clone(),
            roll_width_mm: roll.map_or(0.0, |roll| roll.width_mm),
            roll_radius_mm: roll.map_or(0.0, |roll| roll.diameter_mm / 2.0),
            traverse,
            work_zero_mm: PerAxis::default(),
            surfaces: Vec::new(),
            obstacles: Vec::new(),
            gauge: None,
            diamond_radius_mm: 0.0,
            seat_gauges: Vec::new(),
            highest_mm: f64::NEG_INFINITY,
            swivel_tan: 0.0,
            beam: None,
            dresser: file.dresser.clone(),
            diamond_in_use: 0,
            dresser_broken: false,
            recent_cut_mm: 0.0,
            probe_broken: false,
            diamond: None,
            diamond_wear_mm: [0.0; 2],
            part_lost: false,
            heat: PartHeat::new(file.part_heat),
            previous_stroke_mm: f64::INFINITY,
            chatters_until_s: 0.0,
            vibration: Vibration::default(),
            power: ContactPower::default(),
            load_percent: 0.0,
            tangential_n: 0.0,
            removes: false,
            grinds: false,
        }
    }

    /// Loads a new part from its file, or removes the part.
    pub(super) fn set_part(&mut self, part: Option<&PartFile>, chance: &mut SplitMix64) {
        self.surfaces.clear();
        self.obstacles.clear();
        self.gauge = None;
        self.seat_gauges.clear();
        self.part_lost = false;
        self.set_spindle(part);
        self.heat.set_part(part);
        if let Some(part) = part {
            // Position of the slides with the reference point of a new wheel at the work zero.
            self.work_zero_mm = part.g54_mm.displacement();
            if self.machine.layout.centre {
                self.work_zero_mm[self.machine.layout.infeed] += self.machine.wheel.diameter_mm / 2.0;
            }
            self.swivel_tan = part.head_deg.to_radians().tan();
            self.gauge = part.gauge;
            self.seat_gauges.clone_from(&part.seat_gauges);
            self.diamond_radius_mm = part.diamond_radius_mm;
            self.surfaces.extend(part.surfaces.iter().filter_map(|file| Surface::new(file, chance)));
            self.obstacles.extend(part.bodies.iter().map(Obstacle::of_body));
            self.obstacles.extend(part.blocks.iter().flat_map(Obstacle::of_block));
            self.obstacles.extend(part.tailstock.as_ref().map(Obstacle::of_tailstock));
        }
        let zero = self.machine.layout.wheel_at(MachinePos::new(self.work_zero_mm.0));
        self.obstacles.extend(self.machine.magnet.iter().map(|magnet| Obstacle::of_plate(&magnet.plate, &zero)));
        let surfaces = self.surfaces.iter().map(Surface::reach_mm);
        let obstacles = self.obstacles.iter().map(|obstacle| obstacle.top_mm);
        self.highest_mm = surfaces.chain(obstacles).fold(f64::NEG_INFINITY, f64::max);
    }

    /// The spindle that the part is ground with, its dresser, and what bends.
    fn set_spindle(&mut self, part: Option<&PartFile>) {
        let outer = self.machine.dresser.as_ref();
        let internal = part.and_then(|part| part.internal_spindle.as_ref());
        self.diamond_in_use = usize::from(internal.is_some());
        self.dresser = internal.map_or_else(|| outer.cloned(), |file| outer.map(|outer| file.dresser(outer)));
        let shaft = part.and_then(|part| part.shaft.as_ref());
        self.beam = internal.map(Beam::of_quill).or_else(|| shaft.map(Beam::of_shaft));
    }

    /// Another internal spindle comes with a diamond of its own.
    pub(super) const fn fit_inner_diamond(&mut self) {
        self.diamond_wear_mm[1] = 0.0;
    }

    /// Wear of the diamond in use, mm.
    pub(super) fn diamond_wear_mm(&self) -> f64 {
        self.diamond_wear_mm[self.diamond_in_use]
    }

    /// How far the part is warmer than the coolant, K.
    pub(super) const fn part_kelvin(&self) -> f64 {
        self.heat.kelvin
    }

    /// The surfaces to be measured; empty once the part is lost.
    pub(super) fn surfaces(&self) -> &[Surface] {
        if self.part_lost { &[] } else { &self.surfaces }
    }

    /// The working area for the drawing.
    pub(super) fn workspace(&self, scene: &MachineState, wheel: &GrindingWheel) -> GrindingWorkspace {
        let layout = self.machine.layout;
        let at = layout.wheel_at(self.work_pos(scene));
        let sections = self.surfaces().iter().flat_map(|surface| surface.sections(layout, &at, wheel));
        let holders = self.obstacles.iter().map(|obstacle| obstacle.holder(layout, scene.tailstock_retracted_mm));
        let dresser = self.dresser.as_ref().map(|dresser| {
            let mut at_mm = PerAxis::from_fn(|axis| -self.work_zero_mm[axis]);
            at_mm[layout.infeed] += dresser.infeed_mm + if dresser.behind { 2.0 * wheel.radius_mm } else { 0.0 };
            at_mm[layout.across] += dresser.across_mm;
            if let Some(stroke) = layout.stroke {
                at_mm[stroke] += dresser.stroke_mm;
            }
            let roll_mm = dresser.roll.as_ref().map(|roll| (roll.diameter_mm, roll.width_mm));
            DresserShape { at_mm, behind: dresser.behind, roll_mm }
        });
        GrindingWorkspace {
            zero_mm: self.work_zero_mm,
            part: sections.collect(),
            holders: holders.collect(),
            wheel_radius_mm: wheel.radius_mm,
            wheel_width_mm: wheel.width_mm,
            rim_wear_mm: wheel.rim_wear_mm.to_vec(),
            side_wear_mm: [Side::Left, Side::Right].map(|side| wheel.side_wear_mm(side)),
            swivel_tan: self.swivel_tan,
            dresser,
            grinds: self.grinds,
        }
    }

    /// Size of the part above the set size of the gauge, µm; `None` if there is nothing to measure.
    pub(super) fn oversize_um(&self, scene: &MachineState, wheel_width_mm: f64) -> Option<f64> {
        let left = self.work_pos(scene)[self.machine.layout.across];
        let covered = left..=left + wheel_width_mm;
        let gauge = self.seat_gauges.iter().find(|seat| covered.contains(&seat.z)).copied().or(self.gauge)?;
        let size = |s: &Surface| s.diameter_at(gauge.z).or_else(|| s.height_at(gauge.x, gauge.z));
        let found = self.surfaces().iter().find_map(size)?;
        Some((found * self.heat.expansion() - gauge.set) * 1_000.0)
    }

    /// Position of the slides, part coordinates.
    fn work_pos(&self, scene: &MachineState) -> WorkPos {
        WorkPos::from_fn(|axis| scene.slide_mm[axis] - self.work_zero_mm[axis])
    }

    /// An event at the current time and position.
    pub(super) fn event(&self, kind: EventKind, place: &'static str, scene: &MachineState) -> SimEvent {
        let at = self.work_pos(scene);
        let layout = self.machine.layout;
        let whole = scene.speed_mm_s.0.iter().map(|v| v * v).sum::<f64>().sqrt();
        SimEvent {
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

    /// The vibration of the wheel in this tick; it chatters while it cuts.
    fn vibrate(&mut self, scene: &MachineState, wheel: &GrindingWheel) {
        let (turns_s, mass_kg, dullness) = (wheel.turns_s(scene.wheel_m_s), wheel.mass_kg(), wheel.rim_dullness);
        let turning = TurningWheel { turns_s, mass_kg, dullness };
        if let Some(file) = &self.machine.vibration {
            self.vibration.step(file, turning, scene.seconds < self.chatters_until_s, scene.dt_s);
        }
    }

    /// Position and motion of the wheel, part coordinates.
    fn wheel_motion(&mut self, scene: &MachineState) -> WheelMotion {
        let layout = self.machine.layout;
        let mut pass = layout.wheel_at(self.work_pos(scene));
        pass.front_mm -= self.vibration.towards_mm;
        // Surfaces are those of the cold part.
        pass.front_mm /= self.heat.expansion();
        let far = (pass.stroke_mm - self.previous_stroke_mm).abs() > SWEEP_LIMIT_MM;
        pass.previous_stroke_mm = if far { pass.stroke_mm } else { self.previous_stroke_mm };
        self.previous_stroke_mm = pass.stroke_mm;
        pass.infeed_mm_s = scene.speed_mm_s[layout.infeed].abs();
        pass.across_mm_s = scene.speed_mm_s[layout.across].abs();
        pass.stroke_mm_s = layout.stroke.map_or(0.0, |axis| scene.speed_mm_s[axis].abs());
        pass.dt_s = scene.dt_s;
        pass.swivel_tan = self.swivel_tan;
        pass.traverse = self.traverse;
        pass.part_turns_s = scene.part_rpm / 60.0;
        pass.bending = self.beam.map(|beam| Bending::new(beam, &self.machine.cutting, scene.wheel_m_s));
        pass
    }

    /// Processes the contacts of one tick; true if something crashed.
    pub(super) fn step(&mut self, scene: &MachineState, wheel: &mut GrindingWheel, log: &mut EventLog) -> bool {
        self.load_percent = if scene.wheel.rpm > 0.0 { self.machine.wheel.idle_load_percent } else { 0.0 };
        self.vibrate(scene, wheel);
        (self.removes, self.grinds, self.tangential_n) = (false, false, 0.0);
        self.power = ContactPower::default();
        let pass = self.wheel_motion(scene);
        let mut crashed = self.dress(scene, wheel, log);
        crashed |= self.check_part_held(scene, log);
        crashed |= self.check_probe(scene, log);
        if pass.front_mm - self.swivel_tan.abs() * wheel.width_mm >= self.highest_mm {
            self.surfaces.iter_mut().for_each(|surface| surface.contact = ContactFlags::default());
            self.obstacles.iter_mut().for_each(|obstacle| obstacle.touched = false);
            self.heat.step(0.0, scene.coolant_flows, scene.dt_s);
            return crashed;
        }
        let mut lost = false;
        for index in 0..if self.part_lost { 0 } else { self.surfaces.len() } {
            let met = self.contact_surface(index, &pass, wheel, scene);
            self.grinds |= met.cut.volume_mm3 > 0.0;
            self.power += met.power;
            lost |= met.part_lost;
            if let Some((kind, place)) = met.event {
                crashed |= log.push(self.event(kind, place, scene)) && kind == EventKind::Crash;
            }
        }
        self.part_lost |= lost;
        let watts = self.power.whole_w();
        self.heat.step(watts, scene.coolant_flows, scene.dt_s);
        for index in 0..self.obstacles.len() {
            if self.obstacles[index].newly_touched(&pass, wheel, scene.tailstock_retracted_mm) {
                crashed |= log.push(self.event(EventKind::Crash, self.obstacles[index].name(), scene));
            }
        }
        self.removes |= self.grinds;
        if self.grinds {
            self.chatters_until_s = scene.seconds + CHATTER_S;
            self.load_percent += 100.0 * watts / self.machine.wheel.power_w;
            self.tangential_n = watts / scene.wheel_m_s.max(LOWEST_FORCE_SPEED_M_S);
        }
        crashed
    }

    /// Throws the part off a rotating table if it is not held.
    fn check_part_held(&mut self, scene: &MachineState, log: &mut EventLog) -> bool {
        let turned = scene.part_rpm >= self.machine.cutting.part_stands_rpm;
        if scene.part_held || self.part_lost || !turned || self.surfaces.is_empty() {
            return false;
        }
        self.part_lost = true;
        log.push(self.event(EventKind::Crash, "part, not held on the table", scene))
    }

    /// Deflection of the plane gauge's tip, mm; `None` without contact or with the arm retracted.
    pub(super) fn probe_deflection_mm(&self, scene: &MachineState) -> Option<f64> {
        if !scene.probe_out {
            return None;
        }
        let (mut tip, probe) = (self.machine.layout.wheel_at(self.work_pos(scene)), &self.machine.gauges.probe);
        tip.front_mm += probe.infeed_mm;
        tip.left_mm += probe.across_mm;
        tip.stroke_mm += probe.stroke_mm;
        let inside = self.surfaces().iter().filter_map(|surface| surface.penetration_mm(&tip));
        inside.filter(|mm| *mm >= 0.0).max_by(f64::total_cmp)
    }

    /// Breaks the plane gauge if its tip is deflected beyond its travel.
    fn check_probe(&mut self, scene: &MachineState, log: &mut EventLog) -> bool {
        let broken = self.probe_deflection_mm(scene).is_some_and(|mm| mm > self.machine.gauges.probe.travel_mm);
        let newly = broken && !self.probe_broken;
        self.probe_broken = broken;
        newly && log.push(self.event(EventKind::Crash, "gauge", scene))
    }

    /// Dresses the slices of the rim that are over the dresser; true if it crashed.
    fn dress(&mut self, scene: &MachineState, wheel: &mut GrindingWheel, log: &mut EventLog) -> bool {
        let Some(dresser) = &self.dresser else { return false };
        let at = self.machine.layout.wheel_at(scene.slide_mm);
        // Two circles: offset along the stroke, the wheel reaches less deep.
        let (both, off) = (wheel.radius_mm + self.roll_radius_mm, at.stroke_mm - dresser.stroke_mm);
        let lift = both - (both * both - off * off).max(0.0).sqrt();
        let towards = if dresser.behind { -1.0 } else { 1.0 };
        let deeper = self.diamond.as_ref().map_or(0.0, |diamond| diamond.extra_depth_mm) - self.diamond_wear_mm();
        // The rim of a swivelled wheel is set back at the dresser's position along it.
        let back = self.swivel_tan * (dresser.across_mm - at.left_mm);
        let reach = towards * (dresser.infeed_mm - at.front_mm + back) - lift + deeper;
        let (tip_mm, radius_mm) = (dresser.across_mm - at.left_mm, self.diamond_radius_mm);
        let slices = wheel.slices_over(tip_mm - radius_mm, self.roll_width_mm + 2.0 * radius_mm);
        // A round tip reaches less deep beside its middle: r − √(r² − d²) at the distance d.
        let reach_at = |wheel: &GrindingWheel, slice: usize| {
            let beside = wheel.distance_to_slice_mm(slice, tip_mm);
            reach - (radius_mm - (radius_mm * radius_mm - beside * beside).max(0.0).sqrt())
        };
        // Behind its holder there is room for the wheel.
        let beyond = dresser.behind && reach > 2.0 * wheel.radius_mm + HOLDER_MM;
        if reach <= 0.0 || beyond || off.abs() >= both || slices.is_empty() {
            if self.recent_cut_mm > 0.0
                && let Some(diamond) = &mut self.diamond
            {
                diamond.next_stroke();
            }
            self.dresser_broken = false;
            self.recent_cut_mm = 0.0;
            return false;
        }
        self.recent_cut_mm *= 1.0 - (scene.dt_s / CUT_WINDOW_S).min(1.0);
        let depths = slices.clone().map(|slice| reach_at(wheel, slice) - wheel.rim_wear_mm[slice]);
        let depth = depths.fold(0.0, f64::max);
        if depth <= 0.0 || self.dresser_broken {
            return false;
        }
        let (crash_mm, is_roll) = (dresser.crash_mm, dresser.roll.is_some());
        let roll_stands = is_roll && scene.roll_rpm < self.machine.cutting.part_stands_rpm;
        let standing = !scene.wheel.can_cut() || roll_stands;
        self.recent_cut_mm += if standing { 0.0 } else { depth };
        let too_deep = depth.max(self.recent_cut_mm) > crash_mm;
        if too_deep || (standing && depth > self.machine.cutting.crash_standing_mm) {
            self.dresser_broken = true;
            let place = if !too_deep && roll_stands { "dresser, roll stopped" } else { "dresser" };
            return log.push(self.event(EventKind::Crash, place, scene));
        }
        if !standing {
            self.cut_slices(scene, wheel, slices, reach_at);
        }
        false
    }

    /// Cuts these slices of the rim, each as deep as the dresser reaches there.
    fn cut_slices(
        &mut self,
        scene: &MachineState,
        wheel: &mut GrindingWheel,
        slices: Range<usize>,
        reach_at: impl Fn(&GrindingWheel, usize) -> f64,
    ) {
        let Some(dresser) = &self.dresser else { return };
        let (sharpens_mm, wear_um_cm3, is_roll) = (dresser.sharpens_mm, dresser.wear_um_cm3, dresser.roll.is_some());
        self.removes = true;
        for slice in slices {
            let depth = reach_at(wheel, slice) - wheel.rim_wear_mm[slice];
            // A diamond cuts a slice at full depth in one pass; a roll is fed in gradually.
            let sharpened = if is_roll { depth / sharpens_mm } else { f64::from(u8::from(depth >= sharpens_mm)) };
            if depth > 0.0 {
                wheel.dress(slice, depth, sharpened.min(1.0));
                // µm/cm³ = 10⁻⁶ mm/mm³.
                self.diamond_wear_mm[self.diamond_in_use] += 1e-6 * wear_um_cm3 * wheel.slice_volume_mm3(depth);
                self.keep_pass(scene, wheel, depth);
            }
        }
    }

    /// Keeps how the diamond has gone over the rim, which decides the roughness of the part.
    fn keep_pass(&self, scene: &MachineState, wheel: &mut GrindingWheel, depth_mm: f64) {
        let is_point = self.roll_width_mm <= 0.0 && self.diamond_radius_mm <= 0.0;
        let along_mm_s = scene.speed_mm_s[self.machine.layout.across].abs();
        if is_point && depth_mm >= LEAST_PASS_MM && scene.wheel_m_s > 0.0 && along_mm_s > 0.0 {
            let lead_mm = along_mm_s / wheel.turns_s(scene.wheel_m_s);
            wheel.dressed_by = DressingPass { lead_mm, depth_mm };
        }
    }

    /// Contact with one surface in one tick.
    fn contact_surface(
        &mut self,
        index: usize,
        pass: &WheelMotion,
        wheel: &mut GrindingWheel,
        scene: &MachineState,
    ) -> ContactResult {
        let (surface, cutting) = (&mut self.surfaces[index], &self.machine.cutting);
        let overlap = surface.overlap_mm(pass, wheel);
        if overlap <= 0.0 {
            surface.contact = ContactFlags::default();
            return ContactResult::default();
        }
        if surface.contact.crashed {
            return ContactResult::default();
        }
        let tell = |kind, place| ContactResult { event: Some((kind, place)), ..ContactResult::default() };
        if overlap > cutting.crash_mm {
            surface.contact.crashed = true;
            return tell(EventKind::Crash, "part");
        }
        if !scene.wheel.can_cut() {
            if overlap > cutting.crash_standing_mm {
                surface.contact.crashed = true;
                return tell(EventKind::Crash, "part, wheel stopped");
            }
            return ContactResult::default();
        }
        if !scene.part_held {
            surface.contact.crashed = true;
            return ContactResult { part_lost: true, ..tell(EventKind::Crash, "part, not held") };
        }
        if surface.needs_rotation() && scene.part_rpm < cutting.part_stands_rpm {
            if overlap > cutting.flat_mm && !surface.contact.flat {
                surface.contact.flat = true;
                return tell(EventKind::Flat, surface.place_when_stopped(scene.on_table));
            }
            return ContactResult::default();
        }
        let cut = surface.grind(pass, wheel);
        let power = ContactPower::of_cut(cutting, &cut, scene.wheel_m_s, scene.dt_s);
        let burnt = !surface.contact.burnt && burns(cutting, &cut, power, scene.dt_s, scene.coolant_flows);
        surface.contact.burnt |= burnt;
        if cut.specific_mm2 > 0.0 {
            let ra_um = roughness_um(wheel.dressed_by, cut.specific_mm2 / pass.dt_s, scene.wheel_m_s);
            let waves = if surface.is_ground_by_rim() { 2.0 * self.vibration.amplitude_um } else { 0.0 };
            surface.finish.grind(cut.passed_share, ra_um, waves);
        }
        ContactResult { cut, power, event: burnt.then_some((EventKind::Burn, "part")), part_lost: false }
    }
}

/// Result of the contact with one surface in one tick.
#[derive(Default)]
struct ContactResult {
    cut: Cut,
    power: ContactPower,
    event: Option<(EventKind, &'static str)>,
    /// The part was not held.
    part_lost: bool,
}

impl LayoutFile {
    /// Slide positions in wheel directions, at rest.
    fn wheel_at<Frame>(self, at_mm: Position<Frame>) -> WheelMotion {
        let stroke_mm = self.stroke.map_or(0.0, |axis| at_mm[axis]);
        let (front_mm, left_mm) = (at_mm[self.infeed], at_mm[self.across]);
        WheelMotion { front_mm, left_mm, stroke_mm, previous_stroke_mm: stroke_mm, ..WheelMotion::default() }
    }
}
