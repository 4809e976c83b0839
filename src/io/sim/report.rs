//! Results of the simulated machine: events and the measured part (P5, P8, tools.md run report).

use serde::Serialize;

use super::roughness::SurfaceRoughness;
use crate::defs::part_defect::PartDefect;
use crate::units::{Axis, MachinePos};

/// Greatest number of stored events; further ones are only counted.
const EVENT_LIMIT: usize = 256;
/// A crash ends once a slide is this far away, mm: more than its position noise.
const SEPARATION_MM: f64 = 0.05;

/// Kind of an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum EventKind {
    /// Collision; the drives have tripped.
    Crash,
    /// The specific removal rate was too high: the part is burnt.
    Burn,
    /// The wheel cut a flat into a part that did not rotate.
    Flat,
    /// The wheel exceeded its rated speed.
    Overspeed,
}

impl EventKind {
    /// All kinds.
    pub const ALL: [Self; 4] = [Self::Crash, Self::Burn, Self::Flat, Self::Overspeed];

    /// What it does to the part.
    #[must_use]
    pub const fn part_defect(self) -> Option<PartDefect> {
        match self {
            Self::Crash => Some(PartDefect::Crash),
            Self::Burn => Some(PartDefect::Burn),
            Self::Flat => Some(PartDefect::Flat),
            Self::Overspeed => None,
        }
    }

    /// The kind with an id.
    #[must_use]
    pub fn from_id(id: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.id() == id)
    }

    /// The id used in stories.
    #[must_use]
    pub const fn id(self) -> &'static str {
        match self {
            Self::Crash => "crash",
            Self::Burn => "burn",
            Self::Flat => "flat",
            Self::Overspeed => "overspeed",
        }
    }
}

/// One event.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SimEvent {
    /// Kind.
    pub kind: EventKind,
    /// Simulated time, s.
    pub seconds: f64,
    /// What was hit or affected.
    pub place: &'static str,
    /// X of the wheel's reference point, part coordinates, mm; a diameter where X is the infeed.
    pub x: f64,
    /// Y of it, mm, where Y is infeed or stroke.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub y: Option<f64>,
    /// Z of it, mm.
    pub z: f64,
    /// Resulting speed of all axes, mm/min.
    pub speed: f64,
    /// Peripheral speed of the wheel, m/s.
    pub wheel_m_s: f64,
}

/// The event log, of limited length.
#[derive(Clone, Debug)]
pub(super) struct EventLog {
    pub(super) events: Vec<SimEvent>,
    /// Present positions of the slides.
    slide_mm: MachinePos,
    /// Crashes whose contact has not ended.
    active_crashes: Vec<ActiveCrash>,
    /// What has happened to the present part.
    happened_to_part: [bool; EventKind::ALL.len()],
}

/// A crash still in contact.
#[derive(Clone, Copy, Debug)]
struct ActiveCrash {
    place: &'static str,
    /// Positions of the slides at the last contact.
    slide_mm: MachinePos,
    /// There was contact in the last step.
    touched: bool,
}

impl EventLog {
    /// An empty log with its memory allocated.
    pub(super) fn new() -> Self {
        Self {
            events: Vec::with_capacity(EVENT_LIMIT),
            slide_mm: MachinePos::default(),
            active_crashes: Vec::new(),
            happened_to_part: [false; EventKind::ALL.len()],
        }
    }

    /// Takes over the slide positions and ends the crashes that the slides have left.
    pub(super) fn set_slides(&mut self, slide_mm: MachinePos) {
        self.slide_mm = slide_mm;
        self.active_crashes.retain_mut(|crashed| {
            let near =
                Axis::ALL.into_iter().all(|axis| (crashed.slide_mm[axis] - slide_mm[axis]).abs() < SEPARATION_MM);
            std::mem::replace(&mut crashed.touched, false) || near
        });
    }

    /// Ends all crashes for a new part, which has no defect.
    pub(super) fn begin_part(&mut self) {
        self.active_crashes.clear();
        self.happened_to_part = [false; EventKind::ALL.len()];
    }

    /// What has spoilt the present part.
    pub(super) fn part_defects(&self) -> Vec<PartDefect> {
        let happened = EventKind::ALL.into_iter().filter(|kind| self.happened_to_part[*kind as usize]);
        happened.filter_map(EventKind::part_defect).collect()
    }

    /// Logs an event; beyond the limit it is not kept. False if it is the same crash, already logged.
    pub(super) fn push(&mut self, event: SimEvent) -> bool {
        if event.kind == EventKind::Crash {
            let slide_mm = self.slide_mm;
            if let Some(crashed) = self.active_crashes.iter_mut().find(|crashed| crashed.place == event.place) {
                (crashed.slide_mm, crashed.touched) = (slide_mm, true);
                return false;
            }
            self.active_crashes.push(ActiveCrash { place: event.place, slide_mm, touched: true });
        }
        self.happened_to_part[event.kind as usize] = true;
        if self.events.len() < EVENT_LIMIT {
            self.events.push(event);
        }
        true
    }
}

/// A measured diameter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DiameterAt {
    /// Z of the measurement.
    pub z: f64,
    /// Diameter.
    pub d: f64,
}

/// A measured face.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FaceAt {
    /// X of the measurement: a diameter on GC, the radius on GA, the position along X on GS (the wall of a slot).
    pub x: f64,
    /// Z of the face; on GA the height of the part.
    pub z: f64,
}

/// A measured height of a plane (GS).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HeightAt {
    /// X of the measurement.
    pub x: f64,
    /// Z of the measurement.
    pub z: f64,
    /// Height.
    pub y: f64,
}

/// The measurements of the workpiece, part coordinates, mm.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct PartReport {
    /// Diameters: five per surface, on a bar one every 5 mm.
    pub diameters: Vec<DiameterAt>,
    /// Faces: three positions per face or disc, one per wall.
    pub faces: Vec<FaceAt>,
    /// Heights of planes: fifteen per plane; none on GC and GA.
    pub heights: Vec<HeightAt>,
    /// Roughness of the surfaces that are ground; none of a bar.
    pub roughness: Vec<SurfaceRoughness>,
}
