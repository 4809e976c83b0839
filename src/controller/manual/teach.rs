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
use crate::link::teach::{TeachCommand, TeachView};
use crate::units::{Axis, WorkPos};
use std::sync::Arc;

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

/// The content of a recorded block.
#[derive(Clone, Copy, Debug, PartialEq)]
enum TaughtBlock {
    /// G92: start position, work coordinates, radius mm.
    Start(WorkPos),
    /// A straight line: end point (work, radius mm), directions of X and Z, rapid or feed (mm/min).
    Line { to: WorkPos, heading: [i8; 2], rapid: bool, feed: f64 },
    /// G37 or G39: an axis was homed.
    Home(Axis),
    /// An M code.
    M(u8),
    /// A tool post station.
    T(u8),
}

/// A recording.
#[derive(Clone, Debug, Default)]
pub struct TeachRecorder {
    recording: bool,
    blocks: Vec<TaughtBlock>,
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
    view: Arc<TeachView>,
}

impl TeachRecorder {
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
            TeachCommand::Stop if self.recording => {
                self.end_segment();
                self.recording = false;
                plant.show_note(phrase!("录返已停止", "teach-in has stopped"));
            }
            TeachCommand::Undo if self.blocks.len() > 1 => {
                self.blocks.pop();
            }
            TeachCommand::Save if self.blocks.len() > 1 => {
                self.end_segment();
                request = Some(FileRequest::SaveRecording(self.program_text()));
            }
            TeachCommand::Stop | TeachCommand::Undo | TeachCommand::Save => {
                plant.refuse(NOT_ON);
                return None;
            }
        }
        self.publish();
        request
    }

    fn start_teach(&mut self, plant: &mut Plant) {
        let at = teach_position(plant);
        *self = Self {
            recording: true,
            blocks: vec![TaughtBlock::Start(at)],
            segment_start: at,
            previous: at,
            spindle: plant.machine.spindle_direction(),
            coolant: plant.outputs.on.has(Output::Coolant),
            station: plant.turret_station(),
            ..Self::default()
        };
        plant.show_note(phrase!("录返开始：手动移动将被记录", "teach-in: manual moves are recorded"));
    }

    /// One tick of a recording, after the axes have moved.
    pub fn step(&mut self, plant: &mut Plant, run_open: bool) {
        if !self.recording {
            return;
        }
        let before = self.blocks.len();
        if run_open {
            self.end_segment();
            self.recording = false;
            plant.show_note(phrase!("程序启动，录返已停止", "a program was started: teach-in has stopped"));
            return self.publish();
        }
        if !self.record_homing(plant) {
            self.record_motion(plant);
        }
        self.record_switching(plant);
        if self.blocks.len() >= MAX_BLOCKS {
            self.blocks.truncate(MAX_BLOCKS);
            self.recording = false;
            plant.refuse(FULL);
        }
        if self.blocks.len() != before || !self.recording {
            self.publish();
        }
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
                self.blocks.push(TaughtBlock::Home(axis));
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
        let mut switched = Vec::new();
        if spindle != self.spindle {
            switched.push(TaughtBlock::M(match spindle {
                Some(false) => 3,
                Some(true) => 4,
                None => 5,
            }));
        }
        if coolant != self.coolant {
            switched.push(TaughtBlock::M(if coolant { 7 } else { 8 }));
        }
        if let Some(station) = station.filter(|station| self.station != Some(*station)) {
            // Record only the final station, not the stations that the post passes.
            if plant.outputs.on.has(Output::TurretForward) {
                return;
            }
            switched.push(TaughtBlock::T(station));
            self.station = Some(station);
        }
        if !switched.is_empty() {
            self.end_segment();
            (self.spindle, self.coolant) = (spindle, coolant);
            self.blocks.extend(switched);
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
        if let Some(TaughtBlock::Line { to: end, heading: before, rapid: fast, feed: at }) = self.blocks.last_mut()
            && (*before, *fast) == (heading, rapid)
            && heading.contains(&0)
        {
            (*end, *at) = (to, at.max(feed));
            return;
        }
        self.blocks.push(TaughtBlock::Line { to, heading, rapid, feed });
    }

    /// Writes the snapshot field of the recording.
    pub fn write_view(&self, out: &mut Arc<TeachView>) {
        out.clone_from(&self.view);
    }

    /// The recording was saved as a program.
    pub fn mark_saved(&mut self) {
        Arc::make_mut(&mut self.view).saved = true;
    }

    fn publish(&mut self) {
        let blocks = self.numbered_blocks();
        self.view = Arc::new(TeachView { recording: self.recording, blocks, saved: false });
    }

    /// The recorded blocks as text with block numbers.
    fn numbered_blocks(&self) -> Vec<String> {
        let numbered = self.blocks.iter().enumerate();
        numbered.map(|(index, block)| format!("N{:04}{}", (index + 1) * 10, block.text())).collect()
    }

    /// The program text, ending with M02.
    fn program_text(&self) -> String {
        let mut lines = self.numbered_blocks();
        lines.push(format!("N{:04}M02", (lines.len() + 1) * 10));
        lines.push(String::new());
        lines.join("\r\n")
    }
}

/// Set-point of the tool, work coordinates, radius mm.
fn teach_position(plant: &Plant) -> WorkPos {
    plant.work.offsets.work_from_machine(plant.axes.set_point())
}

impl TaughtBlock {
    fn text(&self) -> String {
        match *self {
            Self::Start(at) => format!("G92X{}Z{}", mm(2.0 * at[Axis::X]), mm(at[Axis::Z])),
            Self::Line { to, rapid, feed, heading } => {
                let mut words = if rapid { "G00".to_owned() } else { "G01".to_owned() };
                if heading[0] != 0 {
                    words += &format!("X{}", mm(2.0 * to[Axis::X]));
                }
                if heading[1] != 0 {
                    words += &format!("Z{}", mm(to[Axis::Z]));
                }
                if rapid { words } else { format!("{words}F{feed}") }
            }
            Self::Home(Axis::X) => "G37".to_owned(),
            Self::Home(_) => "G39".to_owned(),
            Self::M(code) => format!("M{code:02}"),
            Self::T(station) => format!("T{station}"),
        }
    }
}

/// A coordinate rounded to 1 µm, without trailing zeros.
fn mm(value: f64) -> String {
    let rounded = (value * 1_000.0).round() / 1_000.0;
    format!("{}", if rounded.abs() < 0.000_5 { 0.0 } else { rounded })
}
