//! What the simulated machine tells afterwards: events and the measured part (P5, P8, tools.md run report).

use serde::Serialize;

use crate::units::{Axis, PerAxis};

/// Most events kept; the rest is only counted.
const EVENT_LIMIT: usize = 256;
/// A crash is left once a slide stands farther off than it can tremble, mm.
const LEFT_MM: f64 = 0.05;

/// What happened.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum EventKind {
    /// Something hit something at speed; the machine has stopped.
    Crash,
    /// Too much removed at once: the part is burnt there.
    Burn,
    /// The wheel cut into a part that did not turn: there is a flat on it.
    Flat,
    /// The wheel turned faster than it is made for.
    Overspeed,
}

impl EventKind {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Crash, Self::Burn, Self::Flat, Self::Overspeed];

    /// The kind of a word.
    #[must_use]
    pub fn from_id(id: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.id() == id)
    }

    /// The word of stories.
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

/// One thing that happened.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Event {
    /// What.
    pub kind: EventKind,
    /// When, seconds of simulated time.
    pub seconds: f64,
    /// On what.
    pub place: &'static str,
    /// Wheel's reference point at that moment, part coordinates; a diameter where X is the infeed.
    pub x: f64,
    /// The same, Y, where the wheel's place depends on it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub y: Option<f64>,
    /// The same, Z.
    pub z: f64,
    /// Speed of the axes together, mm/min.
    pub speed: f64,
    /// Peripheral speed of the wheel, m/s.
    pub wheel_m_s: f64,
}

/// The course of events, of bounded length.
#[derive(Clone, Debug)]
pub(super) struct EventLog {
    events: Vec<Event>,
    lost: u64,
    /// Where the slides stand.
    slide_mm: PerAxis<f64>,
    /// What has crashed and has not been left since.
    crashed: Vec<Crashed>,
}

/// A crash that lasts.
#[derive(Clone, Copy, Debug)]
struct Crashed {
    place: &'static str,
    /// Where the slides stood when it was met last.
    slide_mm: PerAxis<f64>,
    /// It was met in the step before.
    met: bool,
}

impl EventLog {
    /// An empty log with its room.
    pub(super) fn new() -> Self {
        Self { events: Vec::with_capacity(EVENT_LIMIT), lost: 0, slide_mm: PerAxis::default(), crashed: Vec::new() }
    }

    /// The slides stand here now; a crash that they have left by more than a tremble is over.
    pub(super) fn stand(&mut self, slide_mm: PerAxis<f64>) {
        self.slide_mm = slide_mm;
        self.crashed.retain_mut(|crashed| {
            let near = Axis::ALL.into_iter().all(|axis| (crashed.slide_mm[axis] - slide_mm[axis]).abs() < LEFT_MM);
            std::mem::replace(&mut crashed.met, false) || near
        });
    }

    /// Another part: what it meets is new.
    pub(super) fn begin_part(&mut self) {
        self.crashed.clear();
    }

    /// Notes an event; beyond the limit it is only counted. False: the same crash still, told already.
    pub(super) fn push(&mut self, event: Event) -> bool {
        if event.kind == EventKind::Crash {
            let slide_mm = self.slide_mm;
            if let Some(crashed) = self.crashed.iter_mut().find(|crashed| crashed.place == event.place) {
                (crashed.slide_mm, crashed.met) = (slide_mm, true);
                return false;
            }
            self.crashed.push(Crashed { place: event.place, slide_mm, met: true });
        }
        self.note(event);
        true
    }

    fn note(&mut self, event: Event) {
        if self.events.len() < EVENT_LIMIT {
            self.events.push(event);
        } else {
            self.lost += 1;
        }
    }

    pub(super) fn all(&self) -> &[Event] {
        &self.events
    }

    pub(super) const fn lost(&self) -> u64 {
        self.lost
    }
}

/// A measured diameter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DiameterAt {
    /// Where, Z.
    pub z: f64,
    /// Diameter.
    pub d: f64,
}

/// A measured face.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FaceAt {
    /// Where: a diameter on GC, on GA the radius, on GS (the wall of a slot) the place along X.
    pub x: f64,
    /// Z of the face; on GA that is the part's height.
    pub z: f64,
}

/// A measured height of a plane (GS).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HeightAt {
    /// Where, X.
    pub x: f64,
    /// Where, Z.
    pub z: f64,
    /// Height.
    pub y: f64,
}

/// The measured workpiece, part coordinates, mm.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct PartReport {
    /// Diameters, five to a surface.
    pub diameters: Vec<DiameterAt>,
    /// Faces, three places to a face, one to a wall.
    pub faces: Vec<FaceAt>,
    /// Heights of planes, fifteen to a plane; none on GC and GA.
    pub heights: Vec<HeightAt>,
}
