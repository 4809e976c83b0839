//! Recorded ticks: [`Tracer`] wraps any [`Backend`] and records the last ticks, [`Replay`] supplies the recorded inputs
//! and notes the first tick in which the outputs differ.

use std::collections::VecDeque;

use kt830::defs::param::Params;
use kt830::defs::signal::Terminals;
use kt830::io::drive::DriveState;
use kt830::io::trace::{HEADER, TraceRow};
use kt830::io::{Backend, InputImage, OutputImage, ProbeLatch};
use kt830::units::{EncoderPos, Micros, PerAxis};

/// Number of columns of a row.
const COLUMNS: usize = 29;

/// Why a trace cannot be parsed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TraceError {
    /// A row has too few or too many columns.
    #[error("line {line}: {found} columns instead of {COLUMNS}")]
    ColumnCount {
        /// Line, from 1.
        line: usize,
        /// Columns found.
        found: usize,
    },
    /// A column cannot be parsed as its type.
    #[error("line {line}, column {column}: '{text}' is not a number")]
    Number {
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// The text found there.
        text: String,
    },
}

/// Parses the columns of one line in order.
struct ColumnReader<'a> {
    line: usize,
    column: usize,
    rest: std::str::Split<'a, char>,
}

impl ColumnReader<'_> {
    fn next<T>(&mut self, read: impl Fn(&str) -> Option<T>) -> Result<T, TraceError> {
        self.column += 1;
        let text = self.rest.next().unwrap_or_default();
        read(text).ok_or_else(|| TraceError::Number { line: self.line, column: self.column, text: text.to_owned() })
    }

    fn float(&mut self) -> Result<f64, TraceError> {
        self.next(|text| text.parse().ok())
    }

    fn flag(&mut self) -> Result<bool, TraceError> {
        self.next(|text| match text {
            "0" => Some(false),
            "1" => Some(true),
            _ => None,
        })
    }

    fn drive(&mut self) -> Result<DriveState, TraceError> {
        self.next(|text| DriveState::from_trace_number(text.parse().ok()?))
    }

    fn axes(&mut self) -> Result<PerAxis<bool>, TraceError> {
        let bits: u8 = self.next(|text| text.parse().ok().filter(|bits| *bits < 8))?;
        Ok(PerAxis::from_fn(|axis| bits >> axis as u8 & 1 == 1))
    }

    fn percent(&mut self) -> Result<Option<f64>, TraceError> {
        self.next(|text| if text.is_empty() { Some(None) } else { text.parse().ok().map(Some) })
    }

    fn latch(&mut self) -> Result<Option<ProbeLatch>, TraceError> {
        self.next(|text| match text.split_once(':') {
            None => text.is_empty().then_some(None),
            Some((signal, mm)) => Some(Some(ProbeLatch { signal: signal.parse().ok()?, encoder_mm: mm.parse().ok()? })),
        })
    }

    fn terminals(&mut self) -> Result<Terminals, TraceError> {
        self.next(|text| u64::from_str_radix(text, 16).ok()).map(Terminals)
    }
}

/// Parses one line; `line` is its number for the error.
fn parse_row(text: &str, line: usize) -> Result<TraceRow, TraceError> {
    let found = text.split(',').count();
    if found != COLUMNS {
        return Err(TraceError::ColumnCount { line, found });
    }
    let mut c = ColumnReader { line, column: 0, rest: text.split(',') };
    Ok(TraceRow {
        now: Micros(c.next(|text| text.parse().ok())?),
        inputs: InputImage {
            terminals: c.terminals()?,
            encoder_mm: EncoderPos::new([c.float()?, c.float()?, c.float()?]),
            absolute: c.axes()?,
            latches: PerAxis([c.latch()?, c.latch()?, c.latch()?]),
            torque_percent: PerAxis([c.percent()?, c.percent()?, c.percent()?]),
            spindle_turns: c.float()?,
            handwheel_detents: c.next(|text| text.parse().ok())?,
            drives: PerAxis([c.drive()?, c.drive()?, c.drive()?]),
            bus_alive: c.flag()?,
            station_silent: c.flag()?,
            inverter_tripped: c.flag()?,
        },
        outputs: OutputImage {
            terminals: c.terminals()?,
            set_point_mm: EncoderPos::new([c.float()?, c.float()?, c.float()?]),
            drives_on: c.flag()?,
            fault_reset: c.flag()?,
            awaited_signal: c.next(|text| text.parse().ok())?,
            wheel_volts: c.float()?,
            analog_2_volts: c.float()?,
        },
    })
}

/// Wraps a backend and records its inputs and outputs.
#[derive(Clone, Debug)]
pub struct Tracer<B> {
    inner: B,
    rows: VecDeque<TraceRow>,
    capacity: usize,
    last_inputs: InputImage,
}

impl<B: Backend> Tracer<B> {
    /// Records the last `most` ticks of a backend; their memory is allocated here.
    pub fn new(inner: B, most: usize) -> Self {
        Self { inner, rows: VecDeque::with_capacity(most), capacity: most, last_inputs: InputImage::default() }
    }

    /// The recorded ticks, oldest first.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = &TraceRow> {
        self.rows.iter()
    }

    /// The newest tick.
    pub fn newest(&self) -> Option<&TraceRow> {
        self.rows.back()
    }
}

impl<B: Backend> Backend for Tracer<B> {
    fn read(&mut self, now: Micros) -> InputImage {
        self.last_inputs = self.inner.read(now);
        self.last_inputs
    }

    fn rewire(&mut self, params: &Params) {
        self.inner.rewire(params);
    }

    fn write(&mut self, now: Micros, outputs: &OutputImage) {
        if self.rows.len() == self.capacity {
            self.rows.pop_front();
        }
        if self.capacity > 0 {
            self.rows.push_back(TraceRow { now, inputs: self.last_inputs, outputs: *outputs });
        }
        self.inner.write(now, outputs);
    }
}

/// Replays the inputs of a trace, whatever the control outputs.
#[derive(Clone, Debug)]
pub struct Replay {
    rows: Vec<TraceRow>,
    next: usize,
    first_difference: Option<usize>,
}

impl Replay {
    /// Parses a trace: the header, then one row per line.
    ///
    /// # Errors
    /// The first line and column that cannot be parsed.
    pub fn parse(text: &str) -> Result<Self, TraceError> {
        let lines = text.lines().enumerate().filter(|(_, line)| !line.is_empty() && *line != HEADER);
        let rows = lines.map(|(i, line)| parse_row(line, i + 1)).collect::<Result<_, _>>()?;
        Ok(Self { rows, next: 0, first_difference: None })
    }

    /// Whether all ticks have been replayed.
    #[must_use]
    pub const fn is_done(&self) -> bool {
        self.next >= self.rows.len()
    }

    /// Index from 0 of the first tick whose outputs differ from the recorded ones.
    #[must_use]
    pub const fn first_difference(&self) -> Option<usize> {
        self.first_difference
    }
}

impl Backend for Replay {
    /// The inputs of the next tick; after the last tick a silent bus with the last image.
    fn read(&mut self, _now: Micros) -> InputImage {
        match self.rows.get(self.next) {
            Some(row) => row.inputs,
            None => InputImage { bus_alive: false, ..self.rows.last().map(|row| row.inputs).unwrap_or_default() },
        }
    }

    fn write(&mut self, _now: Micros, outputs: &OutputImage) {
        if let Some(row) = self.rows.get(self.next) {
            if row.outputs != *outputs && self.first_difference.is_none() {
                self.first_difference = Some(self.next);
            }
            self.next += 1;
        }
    }

    /// A recording has no wires.
    fn rewire(&mut self, _params: &Params) {}
}

struct Ramp(f64);

impl Backend for Ramp {
    fn read(&mut self, _now: Micros) -> InputImage {
        self.0 += 0.1;
        let latches = PerAxis([None, None, Some(ProbeLatch { signal: 4, encoder_mm: self.0 / 7.0 })]);
        let encoder_mm = EncoderPos::new([self.0, 0.0, -1e-7]);
        let torque_percent = PerAxis([Some(-self.0), None, Some(0.0)]);
        InputImage { encoder_mm, latches, torque_percent, bus_alive: true, ..InputImage::default() }
    }
    fn write(&mut self, _now: Micros, _outputs: &OutputImage) {}
    fn rewire(&mut self, _params: &Params) {}
}

/// Outputs computed from the inputs.
fn answer(inputs: InputImage) -> OutputImage {
    let set_point_mm = EncoderPos::from_fn(|axis| inputs.encoder_mm[axis] / 3.0);
    OutputImage {
        set_point_mm,
        terminals: Terminals(0x8000_0000_0000_0001),
        awaited_signal: 4,
        ..OutputImage::default()
    }
}

fn traced(ticks: u64, most: usize) -> Tracer<Ramp> {
    let mut tracer = Tracer::new(Ramp(0.0), most);
    for tick in 1..=ticks {
        let now = Micros::from_millis(tick);
        let inputs = tracer.read(now);
        tracer.write(now, &answer(inputs));
    }
    tracer
}

#[test]
fn p8_a_trace_is_text_and_plays_again_bit_for_bit() {
    let tracer = traced(50, 100);
    let lines = tracer.rows().map(|row| format!("{row}\n")).collect::<String>();
    let mut replay = Replay::parse(&format!("{HEADER}\n{lines}")).unwrap();
    while !replay.is_done() {
        let inputs = replay.read(Micros::ZERO);
        replay.write(Micros::ZERO, &answer(inputs));
    }
    assert_eq!(replay.first_difference(), None);
    assert_eq!(replay.rows, tracer.rows().copied().collect::<Vec<_>>());
    assert!(!replay.read(Micros::ZERO).bus_alive, "the end is a silent bus");
}

#[test]
fn p8_another_answer_is_found_at_its_tick() {
    let lines = traced(5, 5).rows().map(|row| format!("{row}\n")).collect::<String>();
    let mut replay = Replay::parse(&lines).unwrap();
    for tick in 0..5 {
        let mut outputs = answer(replay.read(Micros::ZERO));
        outputs.drives_on = tick >= 3;
        replay.write(Micros::ZERO, &outputs);
    }
    assert_eq!(replay.first_difference(), Some(3));
}

#[test]
fn p8_only_the_last_ticks_are_kept() {
    let tracer = traced(50, 10);
    assert_eq!(tracer.rows().len(), 10);
    assert_eq!(tracer.newest().unwrap().now, Micros::from_millis(50));
}

#[test]
fn p8_a_broken_trace_is_refused_with_its_place() {
    let said = |text: &str| Replay::parse(text).unwrap_err().to_string();
    assert_eq!(said("1,2"), "line 1: 2 columns instead of 29");
    assert_eq!(
        said("1,0,0,0,0,0,,4:1.5,,,-7.5,,0,0,3,0,0,1,0,0,0,0,0,0,0,0,0,0,0"),
        "line 1, column 15: '3' is not a number"
    );
}
