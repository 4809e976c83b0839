//! The cycle of a part against its time: what the wheel has still to go to the finished size, with the limits, the load of the
//! wheel and the removal rate with the rate at which the part burns; behind them the part before.
//! Source: tools.md (page process), K4.5, H8.

use std::f64::consts::PI;

use egui::{Color32, Pos2, Rect, Shape, Stroke, pos2, vec2};

use super::{NAME_WIDTH, SAMPLE_PERIOD, with_extremes};
use crate::defs::grinding_phase::GrindingPhase;
use crate::defs::key::Mode;
use crate::defs::page_meaning::{PageMeaning, SizeKind};
use crate::hmi::page::technology::task;
use crate::hmi::{Area, View, theme};
use crate::link::Snapshot;
use crate::link::snapshot::RunState;
use crate::units::{Axis, Micros};

/// Samples kept of a cycle: an hour.
const MAX_SAMPLES: usize = 36_000;
/// Number of samples over which the feed is averaged.
const FEED_SAMPLES: usize = 5;
/// Shortest time that the curves show, s.
const LEAST_SPAN_S: f64 = 10.0;
/// Steps between the labels of the time, s, and their greatest number.
const TIME_STEPS_S: [f64; 10] = [2.0, 5.0, 10.0, 20.0, 30.0, 60.0, 120.0, 300.0, 600.0, 1_200.0];
const MOST_TIMES: f64 = 8.0;
/// Width of the scale beside a curve.
const SCALE_WIDTH: f32 = 58.0;
/// Lines of the scale of the size, mm above the finished size; the scale is that of the square root.
const SIZE_LINES_MM: [f64; 6] = [0.005, 0.02, 0.05, 0.1, 0.2, 0.5];
/// How far below the finished size the scale reaches at least, and above it where the blank is not known, mm.
const BELOW_MM: f64 = 0.005;
const ABOVE_MM: f64 = 0.5;
/// Strength of a line across.
const LINE_STRENGTH: f32 = 0.45;
/// Greatest and least width of the name of a phase, and height of a plot that has room for it.
const PHASE_WIDTH: f32 = 66.0;
const LEAST_PHASE_WIDTH: f32 = 44.0;
const PHASE_HEIGHT: f32 = 110.0;
/// Least height of the scale of the removal rate, mm³/(mm·s).
const LEAST_RATE: f64 = 0.5;

/// Values at a moment of a cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
struct CycleSample {
    seconds: f64,
    phase: Option<GrindingPhase>,
    /// Position of the infeed axis as a size, mm.
    size_mm: f64,
    load_percent: Option<f64>,
}

/// What the page names of the part: the finished size with its limits, and the blank.
#[derive(Clone, Copy, Debug)]
struct SizeTarget {
    finished_mm: f64,
    limits_mm: Option<(f64, f64)>,
    blank_mm: Option<f64>,
    /// The rate of removal of a plunge on an outside diameter can be told.
    is_plunge: bool,
}

impl SizeTarget {
    /// None on a page without a size to which the infeed axis goes: a length, a bore.
    fn of(snapshot: &Snapshot) -> Option<Self> {
        let values = snapshot.size_values();
        let nominal = values.nominal()?;
        let pose = snapshot.kind.ui().wheel_pose.filter(|pose| !pose.position_is_centre)?;
        if pose.body == Axis::X && !snapshot.x_as_diameter {
            return None;
        }
        let blank = values.page.and_then(|page| page.variable(|found| found == PageMeaning::BlankDiameter));
        let blank_mm = blank.and_then(&values.variable).filter(|blank| *blank > nominal.mm);
        let is_diameter = match nominal.kind {
            Some(SizeKind::Diameter) if blank_mm.is_some() => true,
            Some(SizeKind::Height) => false,
            Some(SizeKind::Diameter | SizeKind::Length) | None => return None,
        };
        let is_plunge = is_diameter && values.page.is_some_and(task::is_plunge);
        Some(Self { finished_mm: nominal.mm, limits_mm: nominal.limits, blank_mm, is_plunge })
    }

    /// From the finished size down to the end of the scale, mm: the lower limit is on it.
    fn below_mm(&self) -> f64 {
        let limit = self.limits_mm.map_or(0.0, |(low, _)| self.finished_mm - low);
        (1.3 * limit).max(BELOW_MM)
    }

    /// From the finished size up to the end of the scale, mm.
    fn above_mm(&self) -> f64 {
        self.blank_mm.map_or(ABOVE_MM, |blank| 1.2 * (blank - self.finished_mm))
    }
}

/// The samples of the running or last cycle, and those of the finished one before.
#[derive(Debug, Default)]
pub(super) struct CycleCurves {
    program: u32,
    running: Vec<CycleSample>,
    before: Vec<CycleSample>,
    /// End of the last counted part, and whether the running cycle has counted it.
    last_part: Option<Micros>,
    has_part: bool,
}

/// A curve of the cycle.
struct Curve<'a> {
    name: &'a str,
    colour: Color32,
    /// What stands under the value.
    below: String,
    /// Height of a value within 0 to 1.
    height: &'a dyn Fn(f64) -> f64,
    /// The values of a cycle.
    values: &'a dyn Fn(&[CycleSample]) -> Vec<Option<f64>>,
    /// Lines across: value, name, colour.
    lines: Vec<(f64, String, Color32)>,
    /// The value as a text.
    text: &'a dyn Fn(f64) -> String,
}

impl CycleCurves {
    /// Takes up the state of the machine.
    pub(super) fn record(&mut self, snapshot: &Snapshot) {
        let program = snapshot.program.number;
        let is_part = snapshot.mode != Mode::Mdi && !snapshot.dressing_programs().contains(&program);
        let Some(pose) = snapshot.kind.ui().wheel_pose.filter(|_| is_part) else { return };
        let seconds = snapshot.cycle.times.seconds;
        let part = snapshot.cycle.part.filter(|part| part.program == program).map(|part| part.ended_at);
        if program != self.program {
            *self = Self { program, last_part: part, ..Self::default() };
        }
        let last = self.running.last().map_or(f64::NEG_INFINITY, |sample| sample.seconds);
        if seconds < last {
            let ended = std::mem::take(&mut self.running);
            if std::mem::take(&mut self.has_part) {
                self.before = ended;
            }
        }
        if part.is_some() && part != self.last_part {
            (self.last_part, self.has_part) = (part, true);
        }
        if seconds >= last && (seconds < last + SAMPLE_PERIOD.as_secs_f64() || self.running.len() >= MAX_SAMPLES) {
            return;
        }
        self.running.push(CycleSample {
            seconds,
            phase: snapshot.cycle.phase,
            size_mm: snapshot.axes[pose.body].work,
            load_percent: snapshot.wheel_load_percent(),
        });
    }

    /// Whether the curves grow.
    pub(super) fn grows(&self, snapshot: &Snapshot) -> bool {
        snapshot.state == RunState::Running
    }

    /// The curves.
    pub(super) fn ui(&self, rect: Rect, view: &View<'_>) {
        let target = SizeTarget::of(view.snapshot);
        let has_load = view.snapshot.wheel_load_percent().is_some();
        let plunge = target.filter(|target| target.is_plunge);
        let count = 1 + usize::from(has_load) + usize::from(plunge.is_some());
        // The size has the height of two.
        let unit = rect.height() / (count as f32 + 1.0);
        self.size(rect.band(0.0, 2.0 * unit - 4.0), view, target);
        let mut top = 2.0 * unit;
        if let Some(target) = plunge {
            self.removal(rect.band(top, unit - 4.0), view, target);
            top += unit;
        }
        if has_load {
            self.load(rect.band(top, unit - 4.0), view);
        }
    }

    fn size(&self, rect: Rect, view: &View<'_>, target: Option<SizeTarget>) {
        let Some(target) = target else {
            let values =
                |samples: &[CycleSample]| samples.iter().map(|sample| Some(sample.size_mm)).collect::<Vec<_>>();
            let all = [&self.running, &self.before].into_iter().flat_map(|samples| values(samples)).flatten();
            let (low, high) =
                all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), mm| (low.min(mm), high.max(mm)));
            let height = |mm: f64| (mm - low) / (high - low).max(1e-3);
            let name = view.text("进给轴位置 mm", "infeed axis mm");
            let text = |mm: f64| view.length(mm);
            let (colour, below) = (view.theme.info, String::new());
            return self.paint(
                rect,
                view,
                &Curve { name, colour, below, height: &height, values: &values, lines: vec![], text: &text },
            );
        };
        let (above, finished) = (target.above_mm(), target.finished_mm);
        let root = |mm: f64| mm.signum() * mm.abs().sqrt();
        let (low, high) = (root(-target.below_mm()), root(above));
        let height = |mm: f64| (root(mm) - low) / (high - low);
        let values =
            |samples: &[CycleSample]| samples.iter().map(|sample| Some(sample.size_mm - finished)).collect::<Vec<_>>();
        let muted = view.theme.muted;
        let mut lines: Vec<_> =
            SIZE_LINES_MM.into_iter().filter(|mm| *mm < above).map(|mm| (mm, format!("+{mm}"), muted)).collect();
        lines.push((0.0, view.text("成品", "target").to_owned(), view.theme.run));
        for limit in target.limits_mm.map_or([None; 2], |(low, high)| [Some(low), Some(high)]).into_iter().flatten() {
            lines.push((limit - finished, String::new(), view.theme.hold));
        }
        let sign = |mm: f64| if mm > 0.0 { "+" } else { "" };
        let text = |mm: f64| match mm <= above {
            true => format!("{}{}", sign(mm), view.length(mm)),
            false => "—".to_owned(),
        };
        let below = format!("{} {}", view.text("成品", "target"), view.length(finished));
        let name = view.text("砂轮位置 – 成品 mm", "wheel – target mm");
        self.paint(
            rect,
            view,
            &Curve { name, colour: view.theme.info, below, height: &height, values: &values, lines, text: &text },
        );
    }

    fn removal(&self, rect: Rect, view: &View<'_>, target: SizeTarget) {
        let burn = burn_limit(view);
        let values = |samples: &[CycleSample]| removal_rates(samples, target);
        let most = [&self.running, &self.before].into_iter().flat_map(|samples| values(samples)).flatten();
        let most = most.fold(LEAST_RATE, f64::max);
        // A limit far above what is ground would press the curve to its foot.
        let high = 1.15 * burn.filter(|burn| *burn < 4.0 * most).map_or(most, |burn| burn.max(most));
        let height = |rate: f64| rate / high;
        let label = |burn: f64| format!("{} {burn:.1}", view.text("烧伤", "burn"));
        let lines: Vec<_> = burn.iter().map(|burn| (*burn, label(*burn), view.theme.alarm_text)).collect();
        let below = burn.map_or_else(String::new, |_| task::material(view).name.get(view.lang).to_owned());
        let text = |rate: f64| format!("{rate:.2}");
        let (name, colour) = ("Q'w mm³/(mm·s)", view.theme.macros);
        self.paint(rect, view, &Curve { name, colour, below, height: &height, values: &values, lines, text: &text });
    }

    fn load(&self, rect: Rect, view: &View<'_>) {
        let values = |samples: &[CycleSample]| samples.iter().map(|sample| sample.load_percent).collect::<Vec<_>>();
        let most = [&self.running, &self.before].into_iter().flat_map(|samples| values(samples)).flatten();
        let high = most.fold(10.0, f64::max) * 1.1;
        let height = |percent: f64| percent / high;
        let text = |percent: f64| format!("{percent:.1}");
        let (name, colour) = (view.text("砂轮负载 %", "wheel load %"), view.theme.run);
        let below = String::new();
        self.paint(
            rect,
            view,
            &Curve { name, colour, below, height: &height, values: &values, lines: vec![], text: &text },
        );
    }

    /// The whole time of the curves, s.
    pub(super) fn span_s(&self) -> f64 {
        let end = |samples: &[CycleSample]| samples.last().map_or(0.0, |sample| sample.seconds);
        end(&self.running).max(end(&self.before)).max(LEAST_SPAN_S)
    }

    fn paint(&self, rect: Rect, view: &View<'_>, curve: &Curve<'_>) {
        view.card(rect);
        let (words, plot) = rect.shrink2(vec2(8.0, 3.0)).split_left_right_at_x(rect.min.x + NAME_WIDTH);
        let (plot, scale) = plot.split_right(SCALE_WIDTH);
        let line = (words.height() / 3.0).min(28.0);
        let row = |index: f32| words.trim_right(8.0).band(index * line, line);
        let running = (curve.values)(&self.running);
        view.fit_left(row(0.0), curve.name, theme::SMALL, curve.colour);
        let last = running.last().copied().flatten().map_or_else(|| "—".to_owned(), curve.text);
        view.line_left(row(1.0), &last, theme::TITLE, view.theme.text);
        view.fit_left(row(2.0), &curve.below, theme::SMALL, view.theme.muted);
        let y = |height: f64| plot.max.y - 2.0 - height as f32 * (plot.height() - 4.0);
        for (value, name, colour) in &curve.lines {
            let at = y((curve.height)(*value));
            if !(plot.min.y..=plot.max.y).contains(&at) {
                continue;
            }
            view.painter.hline(plot.x_range(), at, Stroke::new(1.0, colour.gamma_multiply(LINE_STRENGTH)));
            let label = Rect::from_center_size(pos2(scale.center().x, at), vec2(scale.width(), theme::SMALL + 2.0));
            view.fit_right(label, name, theme::SMALL, *colour);
        }
        self.frame(plot, view);
        let span = self.span_s();
        let points = |samples: &[CycleSample], values: Vec<Option<f64>>| -> Vec<Pos2> {
            let x = |seconds: f64| plot.min.x + (seconds / span) as f32 * plot.width();
            let shown = samples.iter().zip(values).filter_map(|(sample, value)| {
                // A wheel that is far away lies at the edge.
                let height = (curve.height)(value?).clamp(-0.05, 1.05);
                Some(pos2(x(sample.seconds), y(height)))
            });
            with_extremes(shown)
        };
        let painter = view.painter.with_clip_rect(plot);
        let before = points(&self.before, (curve.values)(&self.before));
        painter.add(Shape::line(before, Stroke::new(1.4, view.theme.muted.gamma_multiply(0.7))));
        painter.add(Shape::line(points(&self.running, running), Stroke::new(2.0, curve.colour)));
    }

    /// Where the phases of the running cycle begin, and the seconds below; a low plot has only their lines.
    fn frame(&self, plot: Rect, view: &View<'_>) {
        let span = self.span_s();
        let place = |seconds: f64| plot.min.x + (seconds / span) as f32 * plot.width();
        let begins = |pair: &[CycleSample]| pair[1].phase != pair[0].phase;
        let first = self.running.first().into_iter();
        let changes = first.chain(self.running.windows(2).filter(|pair| begins(pair)).map(|pair| &pair[1]));
        let changes: Vec<_> = changes.filter_map(|sample| Some((place(sample.seconds), sample.phase?))).collect();
        let is_high = plot.height() > PHASE_HEIGHT;
        for (index, (x, phase)) in changes.iter().enumerate() {
            view.painter.vline(*x, plot.y_range(), Stroke::new(1.0, view.theme.line));
            let next = changes.get(index + 1).map_or(plot.max.x, |(next, _)| *next);
            let width = (next - x - 6.0).min(PHASE_WIDTH);
            if is_high && width >= LEAST_PHASE_WIDTH {
                let label = Rect::from_min_size(pos2(x + 3.0, plot.min.y), vec2(width, theme::SMALL + 2.0));
                view.fit_left(label, phase.name().get(view.lang), theme::SMALL, view.theme.muted);
            }
        }
        let step = TIME_STEPS_S.into_iter().find(|step| span / step <= MOST_TIMES).unwrap_or(span);
        for index in 1..=if is_high { (span / step) as u32 } else { 0 } {
            let (x, bottom) = (place(f64::from(index) * step), plot.max.y);
            view.painter.vline(x, bottom - 4.0..=bottom, Stroke::new(1.0, view.theme.muted));
            let label = Rect::from_min_max(pos2(x - 44.0, bottom - theme::SMALL - 2.0), pos2(x - 3.0, bottom));
            let words = format!("{:.0} s", f64::from(index) * step);
            view.fit_right(label.intersect(plot), &words, theme::SMALL, view.theme.muted);
        }
    }
}

/// The removal rate per width at which the part of the technology page's material burns, mm³/(mm·s).
fn burn_limit(view: &View<'_>) -> Option<f64> {
    let page = view.snapshot.size_values().page?;
    task::task(view, page).burn_limit_mm2_s()
}

/// Q'w = π·d·v_f of each sample, mm³/(mm·s): 0 where the wheel is above the blank.
fn removal_rates(samples: &[CycleSample], target: SizeTarget) -> Vec<Option<f64>> {
    let blank = target.blank_mm.unwrap_or(f64::INFINITY);
    let rate = |index: usize| {
        let (now, then) = (samples[index], samples[index.checked_sub(FEED_SAMPLES)?]);
        let feed_mm_s = (then.size_mm - now.size_mm).max(0.0) / 2.0 / (now.seconds - then.seconds);
        Some(PI * now.size_mm * feed_mm_s).filter(|_| then.size_mm <= blank && now.size_mm <= blank)
    };
    (0..samples.len()).map(|index| Some(rate(index).unwrap_or(0.0))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ø40 at 1.2 mm/min of the slide, 0.04 mm of diameter a second: π·40·0.02 = 2.513 mm³/(mm·s).
    #[test]
    fn k4_5_the_removal_rate_is_that_of_the_feed_below_the_blank() {
        let target = SizeTarget { finished_mm: 40.0, limits_mm: None, blank_mm: Some(40.1), is_plunge: true };
        let at = |from_mm: f64, per_s: f64| -> Vec<CycleSample> {
            let sample = |index: u32| {
                let seconds = 0.1 * f64::from(index);
                CycleSample { seconds, phase: None, size_mm: from_mm - per_s * seconds, load_percent: None }
            };
            (0..11).map(sample).collect()
        };
        let last = |samples: &[CycleSample]| removal_rates(samples, target)[10].unwrap();
        assert!((last(&at(40.04, 0.04)) - 2.513).abs() < 0.001);
        assert!(last(&at(41.0, 0.04)).abs() < 1e-12, "above the blank it removes nothing");
        assert!(last(&at(40.0, -0.04)).abs() < 1e-12, "on its way back, too");
        assert_eq!(removal_rates(&at(40.0, 0.04)[..3], target), [Some(0.0); 3], "a feed takes some samples");
    }
}
