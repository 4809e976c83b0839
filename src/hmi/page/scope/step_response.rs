//! Step test: how an axis follows a positioning move. Velocity gain, following error, overshoot, settling.
//! The velocity gain K_V is the speed over the following error.

use egui::{Pos2, Rect, Shape, Stroke, pos2};

use super::curves::CurveWindow;
use super::figures::{self, um, way_of_slide};
use crate::defs::param;
use crate::defs::scope_signal::{AxisQuantity, ScopeSignal};
use crate::hmi::{Area, View, theme};
use crate::link::scope::ScopeRecording;
use crate::units::Axis;

/// Shortest move that is a step, mm.
const LEAST_TRAVEL_MM: f64 = 0.001;
/// The set-point runs at constant speed while it has at least this share of its greatest speed.
const CONSTANT_SPEED_SHARE: f64 = 0.98;
/// Smallest lag of which a velocity gain is told, mm; and how many times of the lag the constant speed must last.
const LEAST_LAG_MM: f64 = 1e-4;
const LAG_TIMES: f64 = 6.0;

/// Set-point and actual position of a move, mm of the slide, sample by sample.
struct AxisMove {
    axis: Axis,
    set: Vec<f64>,
    actual: Vec<f64>,
    /// Time of a sample and of a cycle of the control, s.
    period_s: f64,
    cycle_s: f64,
}

impl AxisMove {
    /// Following error at a sample, mm: the set-point of the cycle before less the position.
    fn following_mm(&self, at: usize) -> f64 {
        let before = self.set[at.saturating_sub(1)];
        let step = (self.set[at] - before) * self.cycle_s / self.period_s;
        self.set[at] - step - self.actual[at]
    }
}

/// What the move says of its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
struct StepResponse {
    /// Travel of the set-point, mm, with its sign.
    travel_mm: f64,
    /// Greatest speed of the set-point, mm/s.
    speed_mm_s: f64,
    /// Greatest following error, mm.
    following_mm: f64,
    /// Velocity gain at constant speed, 1/s; none where the axis does not lag.
    gain_per_s: Option<f64>,
    /// How far the axis goes beyond the end, mm.
    overshoot_mm: f64,
    /// From the end of the set-point until the axis stays in position, s; none if it does not.
    settling_s: Option<f64>,
}

impl StepResponse {
    /// The response of an axis to a set-point that moves once from rest to rest; `None` if it does not move.
    ///
    /// The actual position of a sample was read before its set-point was sent: the set-point of the cycle before counts, as
    /// in the signal of the scope. In position is within `window_mm`.
    fn of(axis_move: &AxisMove, window_mm: f64) -> Option<Self> {
        let AxisMove { set, actual, period_s, .. } = axis_move;
        let period_s = *period_s;
        let (first, end) = (*set.first()?, *set.last()?);
        let travel_mm = end - first;
        if travel_mm.abs() < LEAST_TRAVEL_MM || actual.len() != set.len() {
            return None;
        }
        let speeds: Vec<f64> = set.windows(2).map(|pair| (pair[1] - pair[0]).abs() / period_s).collect();
        let speed_mm_s = speeds.iter().copied().fold(0.0, f64::max);
        let lag = |at: usize| axis_move.following_mm(at) * travel_mm.signum();
        let following_mm = (0..set.len()).map(|at| lag(at).abs()).fold(0.0, f64::max);
        // The lag belongs to the speed once that has been constant for some times of the lag: its second half.
        let is_constant = |at: &usize| speeds[*at] >= CONSTANT_SPEED_SHARE * speed_mm_s;
        let constant: Vec<usize> = (0..speeds.len()).filter(is_constant).collect();
        let late = &constant[constant.len() / 2..];
        let mean_lag = late.iter().map(|at| lag(at + 1)).sum::<f64>() / late.len().max(1) as f64;
        let constant_s = constant.len() as f64 * period_s;
        let is_developed = mean_lag > LEAST_LAG_MM && constant_s * speed_mm_s >= LAG_TIMES * mean_lag;
        let gain_per_s = is_developed.then_some(speed_mm_s / mean_lag);
        let beyond = |at: &f64| (at - end) * travel_mm.signum();
        let overshoot_mm = actual.iter().map(beyond).fold(0.0, f64::max);
        let arrived = set.iter().rposition(|at| (at - end).abs() > 1e-7).map_or(0, |at| at + 1);
        let outside = actual.iter().rposition(|at| (at - end).abs() > window_mm).map_or(0, |at| at + 1);
        let settles = outside < actual.len();
        let settling_s = settles.then(|| outside.saturating_sub(arrived) as f64 * period_s);
        Some(Self { travel_mm, speed_mm_s, following_mm, gain_per_s, overshoot_mm, settling_s })
    }
}

/// The first axis whose set-point and actual position are both recorded, as far as they are shown.
fn shown_move(recording: &ScopeRecording, window: CurveWindow) -> Option<AxisMove> {
    let channel = |axis: Axis, of: AxisQuantity| {
        recording.setup.channels.iter().position(|signal| *signal == Some(ScopeSignal::Axis(axis, of)))
    };
    let both = |axis: Axis| Some((axis, channel(axis, AxisQuantity::SetPoint)?, channel(axis, AxisQuantity::Actual)?));
    let (axis, set, actual) = Axis::ALL.into_iter().find_map(both)?;
    let factor = way_of_slide(recording, axis);
    let (from, to) = window.range(recording.samples.len());
    let of = |channel: usize| recording.samples[from..to].iter().map(|row| row[channel] * factor).collect();
    let (period_s, cycle_s) = (recording.period.as_secs_f64(), recording.cycle.as_secs_f64());
    Some(AxisMove { axis, set: of(set), actual: of(actual), period_s, cycle_s })
}

/// Shows the figures beside the curves, or why there are none.
pub fn ui(rect: Rect, view: &View<'_>, recording: Option<&ScopeRecording>, window: CurveWindow) {
    view.card(rect);
    let Some(found) = recording.and_then(|recording| shown_move(recording, window)) else {
        let words = view.text(
            "阶跃：选一根轴的设定值和实际值，走一段定位并记录",
            "Step test: choose set-point and actual value of an axis, position it and record the move.",
        );
        return view.note(rect, words);
    };
    let in_position = view.snapshot.params.get(param::IN_POSITION);
    let Some(response) = StepResponse::of(&found, in_position) else {
        let words = view.text(
            "显示的部分轴没有移动，或回到起点：缩放到一段",
            "the axis does not move in what is shown, or comes back: zoom to one move",
        );
        return view.note(rect, words);
    };
    let (figures, plot) = rect.shrink(theme::PAD).split_left(figures::WIDTH);
    show_figures(figures, view, found.axis, &response);
    let (positions, errors) = plot.split_top(plot.height() * 0.6);
    paint(positions.trim_bottom(theme::GAP), view, &[&found.set, &found.actual]);
    let lag: Vec<f64> = (0..found.set.len()).map(|at| found.following_mm(at)).collect();
    paint(errors, view, &[&lag]);
    let place = |rect: Rect, words: &str| {
        view.fit_right(rect.band(0.0, 22.0), words, theme::SMALL, view.theme.muted);
    };
    place(positions, view.text("设定值和实际值", "set-point and actual value"));
    place(errors, view.text("跟随误差", "following error"));
}

fn show_figures(rect: Rect, view: &View<'_>, axis: Axis, response: &StepResponse) {
    let gain = response.gain_per_s.map_or_else(|| "–".to_owned(), |gain| format!("{gain:.1} 1/s"));
    let settling = response.settling_s.map_or_else(|| "–".to_owned(), |time| format!("{:.0} ms", time * 1_000.0));
    let lines = [
        (view.text("轴", "axis"), axis.letter().to_string()),
        (view.text("行程", "travel"), format!("{:.3} mm", response.travel_mm)),
        (view.text("最高速度", "top speed"), format!("{:.1} mm/s", response.speed_mm_s)),
        (view.text("速度增益 Kv", "velocity gain Kv"), gain),
        (view.text("最大跟随误差", "greatest error"), um(response.following_mm)),
        (view.text("超调", "overshoot"), um(response.overshoot_mm)),
        (view.text("到位时间", "settling time"), settling),
    ];
    figures::show(rect, view, &lines);
}

/// Curves of the same quantity over the time, each in its colour.
fn paint(rect: Rect, view: &View<'_>, curves: &[&Vec<f64>]) {
    let all = || curves.iter().flat_map(|curve| curve.iter().copied());
    let (low, high) = (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
    let span = (high - low).max(1e-9);
    let room = rect.shrink2(egui::vec2(2.0, 12.0));
    for (curve, colour) in curves.iter().zip([view.theme.muted, view.theme.info]) {
        let colour = if curves.len() == 1 { view.theme.info } else { colour };
        let last = curve.len().saturating_sub(1).max(1);
        let at = |(index, value): (usize, &f64)| -> Pos2 {
            let x = room.min.x + room.width() * index as f32 / last as f32;
            pos2(x, room.max.y - room.height() * ((value - low) / span) as f32)
        };
        view.painter.add(Shape::line(curve.iter().enumerate().map(at).collect(), Stroke::new(1.6, colour)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An axis that follows with a time constant of 10 ms.
    fn behind(set: &[f64], period_s: f64) -> Vec<f64> {
        let mut at = 0.0;
        let follow = |to: &f64| {
            at += (to - at) * period_s / 0.01;
            at
        };
        set.iter().map(follow).collect()
    }

    /// An axis that lags by T = 10 ms behind a set-point at constant speed, and one that overshoots.
    #[test]
    fn the_step_response_is_that_of_the_axis() {
        let period = 0.001;
        let set: Vec<f64> = (0..2_000).map(|tick| f64::from(tick).min(1_000.0) * 0.02).collect();
        let lagging = behind(&set, period);
        let of = |set: &[f64], actual: &[f64]| {
            let (set, actual) = (set.to_vec(), actual.to_vec());
            StepResponse::of(&AxisMove { axis: Axis::X, set, actual, period_s: period, cycle_s: period }, 0.001)
        };
        let found = of(&set, &lagging).unwrap();
        // 20 mm/s · 10 ms, less the cycle before and the step that the axis has gone in this one: 0.16 mm; the gain is 1/8 ms.
        assert!((found.following_mm - 0.16).abs() < 0.003, "{found:?}");
        assert!((found.gain_per_s.unwrap() - 125.0).abs() < 1.0, "{found:?}");
        assert!(found.overshoot_mm < 1e-9, "{found:?}");
        // 0.18 · 0.9^n < 0.001 after 50 ticks.
        assert!((found.settling_s.unwrap() - 0.050).abs() < 0.003, "{found:?}");
        let springing: Vec<f64> =
            set.iter().enumerate().map(|(tick, to)| if tick == 1_010 { 20.005 } else { *to }).collect();
        let found = of(&set, &springing).unwrap();
        assert!((found.overshoot_mm - 0.005).abs() < 1e-9 && found.gain_per_s.is_none(), "{found:?}");
        assert!((found.settling_s.unwrap() - 0.011).abs() < 0.001, "{found:?}");
        // 20 ms at constant speed are two times of the lag: no gain can be told.
        let short: Vec<f64> = (0..200).map(|tick| f64::from(tick).min(20.0) * 0.02).collect();
        assert_eq!(of(&short, &behind(&short, period)).unwrap().gain_per_s, None);
        let stuck = vec![0.0; 2_000];
        assert_eq!(of(&set, &stuck).unwrap().settling_s, None);
        assert_eq!(of(&stuck, &stuck), None);
        assert_eq!(of(&[], &[]), None);
    }
}
