//! The scope: records up to four signals tick by tick and hands the recording to the screen. It reads the plant and changes
//! nothing.
//!
//! A ring of samples takes what is before the trigger. The screen gets copies, a few times a second while it records and at
//! the end, in memory that it has given back: the tick allocates nothing.
//! Source: issue "a real machine", part 6.

use std::sync::Arc;

use crate::controller::axes::SECONDS_PER_MINUTE;
use crate::controller::plant::Plant;
use crate::defs::scope_signal::{AxisQuantity, ScopeSignal};
use crate::defs::signal::Output;
use crate::defs::text::{Text, phrase};
use crate::link::scope::{
    DIGITAL_LEVEL, MAX_SCOPE_SAMPLES, SCOPE_CHANNELS, SCOPE_SPANS, ScopeCommand, ScopeRecording, ScopeSetup,
    ScopeState, ScopeTrigger, ScopeView,
};
use crate::units::{MachinePos, Micros, PerAxis};

const NO_SIGNAL: Text = Text::new("示波器：先选一个信号", "scope: choose a signal first");
const NO_TRIGGER_SIGNAL: Text =
    Text::new("示波器：触发要用第一个信号，先选它", "scope: the trigger needs the first signal, choose it");
const UM_PER_MM: f64 = 1_000.0;
/// Share of the recording before the trigger: one in so many samples.
const BEFORE_TRIGGER: usize = 5;
/// Time between two copies for the screen while it records.
const COPY_PERIOD: Micros = Micros::from_millis(100);
/// Copies: three in the snapshots on their way to the screen, one as painted, one in the first snapshot of the host, the
/// published one, one to write into. If all are held, the copy is tried again in the next tick.
const COPIES: usize = 7;

/// The recorder.
#[derive(Debug)]
pub struct ScopeRecorder {
    view: ScopeView,
    copies: [Arc<ScopeRecording>; COPIES],
    setup: ScopeSetup,
    /// Number of recordings since power-on.
    number: u32,
    /// Ticks between two samples, their time, and ticks until the next sample.
    every: u64,
    period: Micros,
    wait: u64,
    /// The ring, its oldest sample, and how many samples the recording has at its end.
    ring: Vec<[f64; SCOPE_CHANNELS]>,
    oldest: usize,
    wanted: usize,
    /// Samples before the trigger.
    trigger_index: usize,
    x_as_diameter: bool,
    copied_at: Micros,
    is_copy_due: bool,
    /// Value of the first signal in the tick before.
    before: Option<f64>,
    /// Set-point and position of the tick before.
    last: (MachinePos, MachinePos),
    /// Shift of the machine zero then: homing moves the coordinates, not the axis.
    zero_shift_mm: PerAxis<f64>,
}

impl Default for ScopeRecorder {
    fn default() -> Self {
        let copies = [(); COPIES].map(|()| Arc::new(ScopeRecording::with_capacity()));
        Self {
            view: ScopeView { state: ScopeState::Idle, recording: Arc::clone(&copies[0]) },
            copies,
            setup: ScopeSetup::default(),
            number: 0,
            every: 1,
            period: Micros(0),
            wait: 0,
            ring: Vec::with_capacity(MAX_SCOPE_SAMPLES),
            oldest: 0,
            wanted: 0,
            trigger_index: 0,
            x_as_diameter: false,
            copied_at: Micros(0),
            is_copy_due: false,
            before: None,
            last: (MachinePos::default(), MachinePos::default()),
            zero_shift_mm: PerAxis::default(),
        }
    }
}

impl ScopeRecorder {
    /// What the page shows.
    pub const fn view(&self) -> &ScopeView {
        &self.view
    }

    /// Starts or ends a recording. A span that is not one of [`SCOPE_SPANS`] becomes the nearest.
    /// A signal that the machine lacks is refused.
    pub fn command(&mut self, plant: &mut Plant, command: ScopeCommand) {
        match command {
            ScopeCommand::Start(setup) => {
                let fitted = plant.params.fitted();
                let has = |signal: ScopeSignal| ScopeSignal::of(fitted).any(|known| known == signal);
                match setup.channels.into_iter().flatten().find(|signal| !has(*signal)) {
                    Some(lacking) => {
                        let name = lacking.id();
                        plant.refuse(phrase!("这台机床没有信号 {name}", "this machine has no signal {name}", name));
                    }
                    None if setup.channels.iter().all(Option::is_none) => plant.refuse(NO_SIGNAL),
                    None if setup.trigger != ScopeTrigger::Now && setup.channels[0].is_none() => {
                        plant.refuse(NO_TRIGGER_SIGNAL)
                    }
                    None => self.start(plant, setup),
                }
            }
            ScopeCommand::Stop => self.finish(),
        }
    }

    fn start(&mut self, plant: &Plant, mut setup: ScopeSetup) {
        let distance = |span: &Micros| span.0.abs_diff(setup.span.0);
        setup.span = SCOPE_SPANS.into_iter().min_by_key(distance).unwrap_or(setup.span);
        let ticks = setup.span.0.div_ceil(plant.axes.tick_time().0.max(1));
        self.every = ticks.div_ceil(MAX_SCOPE_SAMPLES as u64).max(1);
        self.period = Micros(self.every * plant.axes.tick_time().0);
        self.wanted = (ticks / self.every) as usize;
        self.setup = setup;
        self.number += 1;
        self.x_as_diameter = plant.is_diameter();
        self.ring.clear();
        (self.oldest, self.wait, self.trigger_index, self.before) = (0, 0, 0, None);
        let is_at_once = setup.trigger == ScopeTrigger::Now;
        self.view.state = if is_at_once { ScopeState::Recording } else { ScopeState::Armed };
        self.is_copy_due = true;
    }

    fn finish(&mut self) {
        if self.view.state != ScopeState::Idle {
            self.view.state = ScopeState::Idle;
            self.is_copy_due = true;
        }
    }

    /// One tick, after the set-points.
    pub fn record(&mut self, plant: &Plant) {
        if self.view.state != ScopeState::Idle {
            self.sample(plant);
        }
        if self.is_copy_due {
            self.copy(plant.now);
        }
        self.last = (plant.axes.set_point(), plant.axes.actual());
        self.zero_shift_mm = plant.axes.zero_shift_mm();
    }

    fn sample(&mut self, plant: &Plant) {
        let value = self.setup.channels[0].map(|signal| self.value(plant, signal));
        if self.view.state == ScopeState::Armed && self.is_triggered(value) {
            self.trigger_index = self.ring.len();
            self.view.state = ScopeState::Recording;
            self.wait = 0;
        }
        self.before = value;
        if self.wait > 0 {
            self.wait -= 1;
            return;
        }
        self.wait = self.every - 1;
        let row = self.setup.channels.map(|signal| signal.map_or(0.0, |signal| self.value(plant, signal)));
        let is_recording = self.view.state == ScopeState::Recording;
        let room = if is_recording { self.wanted } else { self.wanted / BEFORE_TRIGGER };
        if self.ring.len() < room {
            // The ring is full for the first time only behind the trigger; until then its oldest sample is the first.
            self.ring.rotate_left(self.oldest);
            self.oldest = 0;
            self.ring.push(row);
        } else if let Some(oldest) = self.ring.get_mut(self.oldest) {
            *oldest = row;
            self.oldest = (self.oldest + 1) % self.ring.len();
        }
        if is_recording && self.ring.len() >= self.wanted {
            self.finish();
        } else if plant.now.since(self.copied_at) >= COPY_PERIOD {
            self.is_copy_due = true;
        }
    }

    /// Whether the first signal crosses the level in this tick.
    fn is_triggered(&self, value: Option<f64>) -> bool {
        let (Some(before), Some(now)) = (self.before, value) else { return false };
        let is_digital = self.setup.channels[0].is_some_and(ScopeSignal::is_digital);
        let level_of = |level| if is_digital { DIGITAL_LEVEL } else { level };
        match self.setup.trigger {
            ScopeTrigger::Now => true,
            ScopeTrigger::Rising(level) => before <= level_of(level) && now > level_of(level),
            ScopeTrigger::Falling(level) => before >= level_of(level) && now < level_of(level),
        }
    }

    fn value(&self, plant: &Plant, signal: ScopeSignal) -> f64 {
        match signal {
            ScopeSignal::Axis(axis, quantity) => {
                let per_mm = plant.displayed_per_mm(axis);
                let (set, actual) = (plant.axes.set_point()[axis], plant.axes.actual()[axis]);
                let shift = plant.axes.zero_shift_mm()[axis] - self.zero_shift_mm[axis];
                let (last_set, last_actual) = (self.last.0[axis] + shift, self.last.1[axis] + shift);
                let per_minute = SECONDS_PER_MINUTE / plant.axes.tick_time().as_secs_f64();
                match quantity {
                    AxisQuantity::SetPoint => per_mm * set,
                    AxisQuantity::Actual => per_mm * actual,
                    AxisQuantity::FollowingError => per_mm * (last_set - actual) * UM_PER_MM,
                    AxisQuantity::SetSpeed => per_mm * (set - last_set) * per_minute,
                    AxisQuantity::ActualSpeed => per_mm * (actual - last_actual) * per_minute,
                    AxisQuantity::Torque => plant.inputs.image.torque_percent[axis].unwrap_or(0.0),
                }
            }
            ScopeSignal::Feed => plant.path_speed_mm_s() * SECONDS_PER_MINUTE,
            ScopeSignal::Rotation if plant.kind.is_lathe() => plant.spindles.encoder.rpm.abs(),
            ScopeSignal::Rotation if plant.outputs.on.has(Output::Wheel) => plant.output_wheel_rpm(),
            ScopeSignal::Rotation => 0.0,
            ScopeSignal::Input(input) => f64::from(u8::from(plant.inputs.filtered.has(input))),
            ScopeSignal::Output(output) => f64::from(u8::from(plant.outputs.on.has(output))),
        }
    }

    /// Copies the recording into memory that the screen does not hold; otherwise again in the next tick.
    fn copy(&mut self, now: Micros) {
        for shared in &mut self.copies {
            let Some(copy) = Arc::get_mut(shared) else { continue };
            (copy.number, copy.setup, copy.period) = (self.number, self.setup, self.period);
            copy.cycle = Micros(self.period.0 / self.every.max(1));
            copy.x_as_diameter = self.x_as_diameter;
            copy.trigger_index = self.trigger_index;
            copy.samples.clear();
            copy.samples.extend_from_slice(&self.ring[self.oldest..]);
            copy.samples.extend_from_slice(&self.ring[..self.oldest]);
            self.view.recording = Arc::clone(shared);
            self.is_copy_due = false;
            self.copied_at = now;
            return;
        }
    }
}
