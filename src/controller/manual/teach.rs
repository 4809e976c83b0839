//! Teach-in (录返): records manual operation as a program. A straight segment moved by jog keys, steps or handwheel is
//! one block; spindle, coolant and tool post are recorded when they are switched.
//!
//! A segment ends where all axes stop, one reverses, or another one starts or stops. Consecutive segments of one axis
//! in one direction are one block, so that handwheel detents are merged. Source: spec L9, seed 001.

use crate::controller::axes::SECONDS_PER_MINUTE;
use crate::controller::plant::{ControlPhase, Plant};
use crate::defs::key::Mode;
use crate::defs::signal::Output;
use crate::defs::text::{Text, phrase};
use crate::link::files::FileRequest;
use crate::link::teach::{TaughtBlock, TeachCommand, TeachView};
use crate::units::{Axis, WorkPos};

/// Maximum blocks: numbers go in steps of ten and have four digits (L1).
const MAX_BLOCKS: usize = 998;
/// A set-point that changes by less than this per tick, mm, is standing.
const STANDSTILL_MM: f64 = 1e-7;
/// Range of F of a line, mm/min on Z (L2).
const FEEDS: (f64, f64) = (6.0, 2_000.0);

const IN_RUN: Text = Text::new("程序运行中不能录返", "no teach-in while a program runs");
const NOT_ON: Text = Text::new("没有录返记录", "nothing has been recorded");
const FULL: Text = Text::new("录返已满，已停止记录", "the recording is full and has stopped");
const NOT_HERE: Text = Text::new("本机床没有录返功能", "this machine has no teach-in");

/// A recording.
#[derive(Clone, Debug)]
pub struct TeachRecorder {
    view: TeachView,
    /// End of the last block, and tool position one tick ago; work coordinates, radius mm.
    segment_start: WorkPos,
    previous: WorkPos,
    /// The present segment: directions of X and Z, greatest path speed, mm/s.
    heading: [i8; 2],
    speed_mm_s: f64,
    rapid: bool,
    homing: Option<Axis>,
    spindle: Option<bool>,
    coolant: bool,
    station: Option<u8>,
}

impl Default for TeachRecorder {
    fn default() -> Self {
        // A tick may add a few blocks before a full recording is cut to `MAX_BLOCKS`.
        Self::with_memory(Vec::with_capacity(MAX_BLOCKS + 8))
    }
}

impl TeachRecorder {
    /// An empty recording in this memory.
    fn with_memory(mut blocks: Vec<TaughtBlock>) -> Self {
        blocks.clear();
        Self {
            view: TeachView { blocks, ..TeachView::default() },
            segment_start: WorkPos::default(),
            previous: WorkPos::default(),
            heading: [0, 0],
            speed_mm_s: 0.0,
            rapid: false,
            homing: None,
            spindle: None,
            coolant: false,
            station: None,
        }
    }

    /// Executes a command of the teach-in page.
    ///
    /// Save asks for the program file of the recording.
    pub fn command(&mut self, plant: &mut Plant, run_open: bool, command: TeachCommand) -> Option<FileRequest> {
        if !plant.kind.is_lathe() {
            plant.refuse(NOT_HERE);
            return None;
        }
        let mut request = None;
        match command {
            TeachCommand::Start if run_open => {
                plant.refuse(IN_RUN);
                return None;
            }
            TeachCommand::Start => self.start_teach(plant),
            TeachCommand::Stop if self.view.recording => {
                self.end_segment();
                self.view.recording = false;
                plant.show_note(phrase!("录返已停止", "teach-in has stopped"));
            }
            TeachCommand::Undo if self.view.blocks.len() > 1 => {
                self.view.blocks.pop();
            }
            TeachCommand::Save if self.view.blocks.len() > 1 => {
                self.end_segment();
                request = Some(FileRequest::SaveRecording(self.view.blocks.clone()));
            }
            TeachCommand::Stop | TeachCommand::Undo | TeachCommand::Save => {
                plant.refuse(NOT_ON);
                return None;
            }
        }
        self.view.saved = false;
        request
    }

    fn start_teach(&mut self, plant: &mut Plant) {
        let at = teach_position(plant);
        *self = Self {
            segment_start: at,
            previous: at,
            spindle: plant.machine.spindle_direction(),
            coolant: plant.outputs.on.has(Output::Coolant),
            station: plant.turret_station(),
            ..Self::with_memory(std::mem::take(&mut self.view.blocks))
        };
        self.view.recording = true;
        self.view.blocks.push(TaughtBlock::Start(at));
        plant.show_note(phrase!("录返开始：手动移动将被记录", "teach-in: manual moves are recorded"));
    }

    /// One tick of a recording, after the axes have moved.
    pub fn step(&mut self, plant: &mut Plant, run_open: bool) {
        if !self.view.recording {
            return;
        }
        let before = (self.view.blocks.len(), self.view.blocks.last().copied());
        if run_open {
            self.end_segment();
            self.view.recording = false;
            plant.show_note(phrase!("程序启动，录返已停止", "a program was started: teach-in has stopped"));
        } else {
            if !self.record_homing(plant) {
                self.record_motion(plant);
            }
            self.record_switching(plant);
        }
        if self.view.blocks.len() >= MAX_BLOCKS {
            self.view.blocks.truncate(MAX_BLOCKS);
            self.view.recording = false;
            plant.refuse(FULL);
        }
        // What changed after it was saved is not saved.
        self.view.saved &= (self.view.blocks.len(), self.view.blocks.last().copied()) == before;
    }

    /// Records manual homing as G37 or G39. True while homing is in progress.
    fn record_homing(&mut self, plant: &Plant) -> bool {
        let now = match &plant.execution.phase {
            ControlPhase::Homing(homing) => Some(homing.current.axis),
            _ => None,
        };
        let at = teach_position(plant);
        let changed = self.homing != now;
        if changed {
            self.end_segment();
            if let Some(axis) = self.homing.filter(|axis| plant.axes.is_homed(*axis)) {
                self.view.blocks.push(TaughtBlock::Home(axis));
            }
            self.homing = now;
        }
        if changed || now.is_some() {
            (self.segment_start, self.previous) = (at, at);
        }
        now.is_some()
    }

    fn record_motion(&mut self, plant: &Plant) {
        let at = teach_position(plant);
        let by = [at[Axis::X] - self.previous[Axis::X], at[Axis::Z] - self.previous[Axis::Z]];
        let sign = |by: f64| if by.abs() < STANDSTILL_MM { 0 } else { by.signum() as i8 };
        let heading = by.map(sign);
        if heading != self.heading {
            self.end_segment();
            self.heading = heading;
        }
        if heading != [0, 0] {
            let speed = by[0].hypot(by[1]) / plant.axes.tick_time().as_secs_f64();
            self.speed_mm_s = self.speed_mm_s.max(speed);
            self.rapid = plant.operator.rapid_jog && plant.operator.mode == Mode::Manual;
        }
        self.previous = at;
    }

    fn record_switching(&mut self, plant: &Plant) {
        let (spindle, coolant, station) =
            (plant.machine.spindle_direction(), plant.outputs.on.has(Output::Coolant), plant.turret_station());
        let turned = (spindle != self.spindle).then_some(TaughtBlock::M(match spindle {
            Some(false) => 3,
            Some(true) => 4,
            None => 5,
        }));
        let flows = (coolant != self.coolant).then_some(TaughtBlock::M(if coolant { 7 } else { 8 }));
        let mut indexed = None;
        if let Some(station) = station.filter(|station| self.station != Some(*station)) {
            // Record only the final station, not the stations that the turret passes.
            if plant.outputs.on.has(Output::TurretForward) {
                return;
            }
            indexed = Some(TaughtBlock::T(station));
            self.station = Some(station);
        }
        let switched = [turned, flows, indexed];
        if switched != [None; 3] {
            self.end_segment();
            (self.spindle, self.coolant) = (spindle, coolant);
            self.view.blocks.extend(switched.into_iter().flatten());
        }
    }

    /// Ends the present segment: it becomes a block or extends the last one.
    fn end_segment(&mut self) {
        let (from, to) = (self.segment_start, self.previous);
        let (x, z) = ((to[Axis::X] - from[Axis::X]).abs(), (to[Axis::Z] - from[Axis::Z]).abs());
        let length = x.hypot(z);
        let (speed, heading, rapid) = (self.speed_mm_s * SECONDS_PER_MINUTE, self.heading, self.rapid);
        self.speed_mm_s = 0.0;
        if length < STANDSTILL_MM || heading == [0, 0] {
            return;
        }
        self.segment_start = to;
        // L2: F is the speed along Z; X moves at up to half of it.
        let feed = (speed * (2.0 * x / length).max(1.0)).round().clamp(FEEDS.0, FEEDS.1);
        if let Some(TaughtBlock::Line { to: end, heading: before, rapid: fast, feed: at }) = self.view.blocks.last_mut()
            && (*before, *fast) == (heading, rapid)
            && heading.contains(&0)
        {
            (*end, *at) = (to, at.max(feed));
            return;
        }
        self.view.blocks.push(TaughtBlock::Line { to, heading, rapid, feed });
    }

    /// Writes the snapshot field of the recording.
    pub fn write_view(&self, out: &mut TeachView) {
        if *out != self.view {
            let blocks = std::mem::take(&mut out.blocks);
            *out = TeachView { blocks, ..self.view };
            out.blocks.clone_from(&self.view.blocks);
        }
    }

    /// The recording was saved as a program.
    pub fn mark_saved(&mut self) {
        self.view.saved = true;
    }
}

/// Set-point of the tool, work coordinates, radius mm.
fn teach_position(plant: &Plant) -> WorkPos {
    plant.work.offsets.work_from_machine(plant.axes.set_point())
}
