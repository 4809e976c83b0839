//! The curves of the scope, and which part of a recording they show.

use egui::{Color32, Rect, Shape, Stroke, pos2};

use super::MIN_SAMPLES_SHOWN;
use crate::defs::scope_signal::{AxisQuantity, ScopeSignal};
use crate::hmi::page::process::with_extremes;
use crate::hmi::{View, theme};
use crate::link::scope::ScopeRecording;

/// Least height of the range of a curve, in its unit: a value that stands is a line in the middle.
const LEAST_RANGE: f64 = 1e-6;

/// The shown part of a recording as shares of it.
#[derive(Clone, Copy, Debug)]
pub struct CurveWindow {
    from: f64,
    share: f64,
}

impl Default for CurveWindow {
    fn default() -> Self {
        Self { from: 0.0, share: 1.0 }
    }
}

impl CurveWindow {
    /// The first shown sample, and the one after the last.
    pub fn range(self, count: usize) -> (usize, usize) {
        let whole = count as f64;
        let from = (self.from * whole) as usize;
        let to = ((self.from + self.share) * whole).ceil() as usize;
        (from.min(count), to.min(count).max(from.min(count)))
    }

    /// Whether all of it is shown.
    pub fn is_whole(self) -> bool {
        self.share >= 1.0
    }

    /// The sample at a share of the width.
    pub fn sample_at(self, count: usize, share: f64) -> usize {
        let at = (self.from + self.share * share.clamp(0.0, 1.0)) * count as f64;
        (at as usize).min(count.saturating_sub(1))
    }

    /// Shows less around the middle for a factor above 1.
    pub fn zoom(&mut self, count: usize, factor: f64) {
        self.zoom_at(count, factor, None);
    }

    /// Shows less around a sample, else around the middle, for a factor above 1.
    pub fn zoom_at(&mut self, count: usize, factor: f64, sample: Option<usize>) {
        let least = (MIN_SAMPLES_SHOWN / count as f64).min(1.0);
        let share = (self.share / factor).clamp(least, 1.0);
        let place = sample.map_or(0.5, |at| ((at as f64 / count as f64 - self.from) / self.share).clamp(0.0, 1.0));
        self.from += (self.share - share) * place;
        self.share = share;
        self.keep_inside();
    }

    /// Moves by a share of the width.
    pub fn move_by(&mut self, by: f64) {
        self.from += by * self.share;
        self.keep_inside();
    }

    fn keep_inside(&mut self) {
        self.from = self.from.max(0.0).min(1.0 - self.share);
    }
}

/// A curve: what is shown, its channel, its signal, and the level of the trigger.
pub struct Lane {
    pub window: CurveWindow,
    pub cursor: Option<usize>,
    pub channel: usize,
    pub signal: ScopeSignal,
    pub level: Option<f64>,
}

/// Colour of a channel; it has its name in the same colour.
pub const fn colour(view: &View<'_>, channel: usize) -> Color32 {
    match channel {
        0 => view.theme.info,
        1 => view.theme.run,
        2 => view.theme.macros,
        _ => view.theme.hold,
    }
}

/// A value with the decimals of its signal.
pub fn number(signal: ScopeSignal, value: f64) -> String {
    let digits = match signal {
        ScopeSignal::Axis(_, AxisQuantity::SetPoint | AxisQuantity::Actual) => 4,
        ScopeSignal::Axis(..) | ScopeSignal::Feed => 1,
        ScopeSignal::Rotation | ScopeSignal::Input(_) | ScopeSignal::Output(_) => 0,
    };
    let text = format!("{value:.digits$}");
    let is_zero = !text.contains(|sign: char| ('1'..='9').contains(&sign));
    if is_zero { text.trim_start_matches('-').to_owned() } else { text }
}

/// Draws a curve over its whole range, with zero, the trigger and the cursor.
pub fn paint(plot: Rect, view: &View<'_>, recording: &ScopeRecording, lane: &Lane) {
    let (from, to) = lane.window.range(recording.samples.len());
    let Some((low, high)) = recording.extremes(lane.channel, from..to) else { return };
    let (low, high) = match lane.level {
        _ if lane.signal.is_digital() => (0.0, 1.0),
        Some(level) => (low.min(level), high.max(level)),
        None => (low, high),
    };
    let spare = if lane.signal.is_digital() { 1.6 } else { 1.12 };
    let room = (high - low).max(LEAST_RANGE) * spare;
    let middle = f64::midpoint(low, high);
    let y = |value: f64| plot.center().y - ((value - middle) / room * f64::from(plot.height())) as f32;
    let step = f64::from(plot.width()) / (to - from).max(1) as f64;
    let x = |sample: usize| plot.min.x + ((sample as f64 - from as f64) * step) as f32;
    let painter = view.painter.with_clip_rect(plot);
    if low < 0.0 && high > 0.0 {
        painter.hline(plot.x_range(), y(0.0), Stroke::new(theme::HAIRLINE, view.theme.line));
    }
    if let Some(level) = lane.level {
        painter.hline(plot.x_range(), y(level), Stroke::new(theme::HAIRLINE, view.theme.hold));
    }
    if recording.trigger_index > from {
        painter.vline(x(recording.trigger_index), plot.y_range(), Stroke::new(theme::HAIRLINE, view.theme.hold));
    }
    let values = recording.samples[from..to].iter().map(|row| row[lane.channel]);
    let points = with_extremes(values.enumerate().map(|(index, value)| pos2(x(from + index), y(value))));
    painter.add(Shape::line(points, Stroke::new(1.6, colour(view, lane.channel))));
    if let Some(at) = lane.cursor.filter(|at| (from..to).contains(at)) {
        painter.vline(x(at), plot.y_range(), Stroke::new(theme::HAIRLINE, view.theme.text));
        painter.circle_filled(pos2(x(at), y(recording.samples[at][lane.channel])), 3.5, view.theme.text);
    }
}
