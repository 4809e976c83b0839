//! What the wheel meets: the part's surfaces, chuck and tailstock, the diamond (P4–P6, P8 crash).
//!
//! A crash is an overlap that no feed could have given (`crash_mm`), a standing wheel pressed onto the part, or any
//! touch of chuck, tailstock or fixture. It is told once a contact; until the wheel has come free nothing more is
//! removed there. A burn is told once a contact, too.
//! DECISION: a part that stands where it should turn gets a flat (event `flat`) and keeps its size; a crash trips the
//! drives of all axes, and switching the drives off ends that once the axes stand.

use super::machine_file::{CuttingFile, DresserFile, MachineFile};
use super::part_file::{Body, BodyFile, PartFile, Place};
use super::report::{Event, EventKind, EventLog, PartReport};
use super::spindle::Spindle;
use super::surface::{Pass, Surface, Touch};
use super::wheel::Wheel;
use crate::io::random::SplitMix64;
use crate::units::{Axis, PerAxis};

/// Where the wheel and what else moves stand in this tick, machine coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scene {
    pub seconds: f64,
    pub dt_s: f64,
    pub x_mm: f64,
    pub z_mm: f64,
    pub vx_mm_s: f64,
    pub vz_mm_s: f64,
    pub wheel: Spindle,
    pub part_rpm: f64,
    pub tailstock_back_mm: f64,
}

/// A cylinder in the way, part coordinates, radius.
#[derive(Clone, Copy, Debug)]
struct Obstacle {
    name: &'static str,
    z_from: f64,
    z_to: f64,
    radius: f64,
    touched: bool,
    /// It moves with the tailstock.
    on_tailstock: bool,
}

/// Part, obstacles and diamond.
#[derive(Clone, Debug)]
pub(super) struct Grinding {
    cutting: CuttingFile,
    dresser: Option<DresserFile>,
    broke_dresser: bool,
    zero: Place,
    surfaces: Vec<Surface>,
    obstacles: Vec<Obstacle>,
    /// Nothing of the part or around it stands higher, radius.
    highest_mm: f64,
    idle_percent: f64,
    power_w: f64,
    load_percent: f64,
}

impl Grinding {
    /// A machine without a part.
    pub(super) fn new(machine: &MachineFile) -> Self {
        Self {
            cutting: machine.cutting.clone(),
            dresser: machine.dresser.clone(),
            broke_dresser: false,
            zero: Place::default(),
            surfaces: Vec::new(),
            obstacles: Vec::new(),
            highest_mm: f64::NEG_INFINITY,
            idle_percent: machine.wheel.idle_load_percent,
            power_w: machine.wheel.power_w,
            load_percent: 0.0,
        }
    }

    /// Puts a part in, fresh from its file, or takes it out.
    pub(super) fn set_part(&mut self, part: Option<&PartFile>, chance: &mut SplitMix64) {
        self.surfaces.clear();
        self.obstacles.clear();
        self.highest_mm = f64::NEG_INFINITY;
        let Some(part) = part else { return };
        self.zero = part.g54_mm;
        self.surfaces.extend(part.surfaces.iter().map(|file| Surface::new(file, chance)));
        self.obstacles.extend(part.bodies.iter().map(Obstacle::of_body));
        if let Some(tailstock) = part.tailstock {
            self.obstacles.push(Obstacle {
                name: "tailstock",
                z_from: tailstock.z,
                z_to: tailstock.z + tailstock.length,
                radius: tailstock.diameter / 2.0,
                touched: false,
                on_tailstock: true,
            });
        }
        let surfaces = self.surfaces.iter().map(Surface::reach_mm);
        let obstacles = self.obstacles.iter().map(|obstacle| obstacle.radius);
        self.highest_mm = surfaces.chain(obstacles).fold(f64::NEG_INFINITY, f64::max);
    }

    /// Load of the wheel's motor, percent.
    pub(super) const fn load_percent(&self) -> f64 {
        self.load_percent
    }

    /// The surfaces, to be measured.
    pub(super) fn surfaces(&self) -> &[Surface] {
        &self.surfaces
    }

    /// Reference point of the wheel in part coordinates, X as a diameter, for slides in machine coordinates.
    pub(super) fn part_place(&self, slide_mm: PerAxis<f64>) -> (f64, f64) {
        (2.0 * (slide_mm[Axis::X] - self.zero.x), slide_mm[Axis::Z] - self.zero.z)
    }

    /// The measured part.
    pub(super) fn report(&self) -> PartReport {
        let mut report = PartReport::default();
        for surface in &self.surfaces {
            surface.report(&mut report.diameters, &mut report.faces);
        }
        report
    }

    /// One tick of contact. True: something crashed.
    pub(super) fn step(&mut self, scene: &Scene, wheel: &mut Wheel, log: &mut EventLog) -> bool {
        self.load_percent = if scene.wheel.rpm() > 0.0 { self.idle_percent } else { 0.0 };
        let mut crashed = self.dress(scene, wheel, log);
        let pass = Pass {
            front_mm: scene.x_mm - self.zero.x,
            left_mm: scene.z_mm - self.zero.z,
            vx_mm_s: scene.vx_mm_s.abs(),
            vz_mm_s: scene.vz_mm_s.abs(),
            dt_s: scene.dt_s,
            traverse_mm: (self.cutting.traverse_cylinder_mm, self.cutting.traverse_face_mm),
        };
        if pass.front_mm >= self.highest_mm {
            self.come_free();
            return crashed;
        }
        let mut volume = 0.0;
        for surface in &mut self.surfaces {
            let met = meet(surface, &pass, wheel, &self.cutting, scene);
            volume += met.volume_mm3;
            if let Some((kind, place)) = met.told {
                crashed |= kind == EventKind::Crash;
                log.push(event(kind, place, &pass, scene));
            }
        }
        for obstacle in &mut self.obstacles {
            if obstacle.newly_hit(&pass, wheel.width_mm(), scene.tailstock_back_mm) {
                crashed = true;
                log.push(event(EventKind::Crash, obstacle.name, &pass, scene));
            }
        }
        if volume > 0.0 {
            // J/mm³ · mm³/s = W.
            let watts = self.cutting.energy_j_mm3 * volume / scene.dt_s;
            self.load_percent += 100.0 * watts / self.power_w;
        }
        crashed
    }

    fn come_free(&mut self) {
        for surface in &mut self.surfaces {
            surface.touch = Touch::default();
        }
        for obstacle in &mut self.obstacles {
            obstacle.touched = false;
        }
    }

    /// The diamond cuts back the slice of the rim that stands over it.
    fn dress(&mut self, scene: &Scene, wheel: &mut Wheel, log: &mut EventLog) -> bool {
        let Some(dresser) = &self.dresser else { return false };
        if scene.x_mm >= dresser.x_mm {
            self.broke_dresser = false;
            return false;
        }
        let Some(slice) = wheel.slice_at(dresser.z_mm - scene.z_mm) else {
            self.broke_dresser = false;
            return false;
        };
        let depth = dresser.x_mm - scene.x_mm - wheel.rim_mm(slice);
        if depth <= 0.0 || self.broke_dresser {
            return false;
        }
        let standing = !scene.wheel.cuts() && depth > self.cutting.crash_standing_mm;
        if depth > dresser.crash_mm || standing {
            self.broke_dresser = true;
            let at = Pass {
                front_mm: scene.x_mm - self.zero.x,
                left_mm: scene.z_mm - self.zero.z,
                vx_mm_s: 0.0,
                vz_mm_s: 0.0,
                dt_s: scene.dt_s,
                traverse_mm: (0.0, 0.0),
            };
            log.push(event(EventKind::Crash, "dresser", &at, scene));
            return true;
        }
        if scene.wheel.cuts() {
            wheel.dress(slice, depth, depth >= dresser.sharpens_mm);
        }
        false
    }
}

/// What one surface gave in a tick.
#[derive(Default)]
struct Met {
    volume_mm3: f64,
    told: Option<(EventKind, &'static str)>,
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
    let tell = |kind, place| Met { volume_mm3: 0.0, told: Some((kind, place)) };
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
    if surface.turns() && scene.part_rpm < cutting.part_stands_rpm {
        if overlap > cutting.flat_mm && !surface.touch.flat {
            surface.touch.flat = true;
            return tell(EventKind::Flat, "part, workhead standing");
        }
        return Met::default();
    }
    let cut = surface.grind(pass, wheel);
    let burns = cut.specific_mm2 > cutting.burn_mm2_s * pass.dt_s && !surface.touch.burnt;
    surface.touch.burnt |= burns;
    Met { volume_mm3: cut.volume_mm3, told: burns.then_some((EventKind::Burn, "part")) }
}

fn event(kind: EventKind, place: &'static str, pass: &Pass, scene: &Scene) -> Event {
    Event {
        kind,
        seconds: scene.seconds,
        place,
        x: 2.0 * pass.front_mm,
        z: pass.left_mm,
        speed: scene.vx_mm_s.hypot(scene.vz_mm_s) * 60.0,
    }
}

impl Obstacle {
    fn of_body(body: &BodyFile) -> Self {
        let name = match body.what {
            Body::Chuck => "chuck",
            Body::Fixture => "fixture",
        };
        Self {
            name,
            z_from: body.z_from,
            z_to: body.z_to,
            radius: body.diameter / 2.0,
            touched: false,
            on_tailstock: false,
        }
    }

    /// Whether the wheel has come into it in this tick.
    fn newly_hit(&mut self, pass: &Pass, width_mm: f64, tailstock_back_mm: f64) -> bool {
        let back = if self.on_tailstock { tailstock_back_mm } else { 0.0 };
        let inside = pass.front_mm < self.radius
            && pass.left_mm < self.z_to + back
            && pass.left_mm + width_mm > self.z_from + back;
        let newly = inside && !self.touched;
        self.touched = inside;
        newly
    }
}
