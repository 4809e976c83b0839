//! Process page: live curves of axes, feed, wheel load and gauge signals, or the cycle of a part by its time; sizes and cycle times of the last parts; the
//! wheel and its dressings; CSV export of all data.
//! Source: tools.md (page process), K4.3, K4.5, K5.17, H9.

mod cycle;
mod trend;

use std::collections::VecDeque;
use std::fmt::Write;

use egui::accesskit::Role;
use egui::{Color32, Id, Pos2, Rect, Sense, Shape, Stroke, WidgetInfo, pos2, vec2};

use self::cycle::CycleCurves;
use super::{PageContext, PageUi};
use crate::defs::param;
use crate::defs::part_record::PartRecord;
use crate::defs::signal::Input;
use crate::defs::text::{Text, phrase};
use crate::hmi::{Area, KeyboardFocus, PageKey, Question, QuestionDialog, View, file_command, theme, widget};
use crate::link::files::{FileRequest, Requester};
use crate::link::{Command, Snapshot};
use crate::units::{Axis, Micros};

/// Time between two samples, and how many are kept: ten minutes.
const SAMPLE_PERIOD: Micros = Micros::from_millis(100);
const MAX_SAMPLES: usize = 6_000;
/// Time spans that the key steps through, s, and least span by pinching, s; the greatest is the last of `SPANS_SECONDS`.
const SPANS_SECONDS: [f64; 4] = [10.0, 60.0, 180.0, 600.0];
const MIN_SPAN_SECONDS: f64 = 1.0;
/// Height of sizes, cycle times and wheel.
const BELOW_HEIGHT: f32 = 132.0;
/// Width of name and value in front of a curve.
const NAME_WIDTH: f32 = 150.0;
/// Number of parts shown.
const MAX_PARTS: usize = 50;
/// Inputs of the gauge.
const GAUGES: [Input; 6] = [Input::Gauge1, Input::Gauge2, Input::Gauge3, Input::Gauge4, Input::Gauge5, Input::Gauge6];

/// Values at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sample {
    at: Micros,
    axes: [f64; 3],
    feed_mm_min: f64,
    /// None if the machine has no such signal.
    load_percent: Option<f64>,
    gauge_bits: u8,
}

/// One curve: name, colour, and its value in a sample.
struct ProcessCurve {
    name: String,
    colour: Color32,
    value: Box<dyn Fn(&Sample) -> f64>,
}

/// State of the page.
#[derive(Debug, Default)]
pub struct ProcessPage {
    samples: VecDeque<Sample>,
    cycle: CycleCurves,
    /// The curves are those of the cycle.
    shows_cycle: bool,
    /// Serial number of the last part that was cleared away.
    cleared: u64,
    /// Dressing count and wheel diameter, mm, as last seen; what the last dressing took off the diameter, mm.
    last_dressing: Option<(f64, f64)>,
    dressing_removed_mm: Option<f64>,
    /// Displayed time span, s; none: the shortest of `SPANS_SECONDS`. Its end; none: now.
    span_seconds: Option<f64>,
    window_end: Option<Micros>,
    /// Question whether to clear the data.
    question: QuestionDialog<()>,
    walk: KeyboardFocus,
}

impl PageUi for ProcessPage {
    fn record(&mut self, snapshot: &Snapshot) {
        self.track_dressing(snapshot);
        self.cycle.record(snapshot);
        if self.samples.back().is_some_and(|last| snapshot.now < last.at) {
            self.samples.clear();
            self.window_end = None;
        }
        // One sample in each period of the clock, however many snapshots or frames it has.
        let period = |at: Micros| at.0 / SAMPLE_PERIOD.0;
        if self.samples.back().is_some_and(|last| period(last.at) == period(snapshot.now)) {
            return;
        }
        let gauges = GAUGES.iter().enumerate().filter(|(_, gauge)| snapshot.inputs.has(**gauge));
        self.samples.push_back(Sample {
            at: snapshot.now,
            axes: Axis::ALL.map(|axis| snapshot.axes[axis].work),
            feed_mm_min: snapshot.feed_mm_min,
            load_percent: snapshot.wheel_load_percent(),
            gauge_bits: gauges.fold(0, |bits, (index, _)| bits | 1 << index),
        });
        if self.samples.len() > MAX_SAMPLES {
            self.samples.pop_front();
        }
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        let PageContext { rect, view, typed, out, .. } = ctx;
        let moves = if self.shows_cycle {
            self.cycle.grows(view.snapshot)
        } else {
            self.window_end.is_none() && self.curves_move(view.snapshot.now)
        };
        if moves {
            view.ui.ctx().request_repaint_after(std::time::Duration::from_micros(SAMPLE_PERIOD.0));
        }
        self.walk.begin_frame(if self.question.is_open() { &[] } else { &typed.edits });
        let (body, keys) = rect.shrink2(vec2(theme::PAD, 6.0)).split_bottom(widget::KEYS_HEIGHT);
        let (curves, below) = body.trim_bottom(theme::GAP).split_bottom(BELOW_HEIGHT);
        let curves = curves.trim_bottom(theme::GAP);
        if self.shows_cycle {
            self.cycle.ui(curves, view);
        } else {
            self.drag(curves, view);
            self.curves(curves, view);
        }
        let (trend, rest) = below.split_left_right_at_fraction(0.46);
        let (parts, wheel) = rest.split_left_right_at_fraction(0.42);
        let cut = |rect: Rect| rect.trim_right(theme::GAP);
        let shown: Vec<&PartRecord> = self.parts(view.snapshot).collect();
        let shown = &shown[shown.len().saturating_sub(MAX_PARTS)..];
        trend::sizes(cut(trend), view, shown);
        trend::cycle_times(cut(parts), view, shown);
        self.wheel(wheel, view);
        out.extend(self.keys(keys, view));
        if let Some(((), Some(_))) = self.question.ui(rect, view, &typed.edits) {
            self.samples.clear();
            self.cycle = CycleCurves::default();
            self.cleared = view.snapshot.production.parts.last().map_or(0, |part| part.count);
            self.window_end = None;
        }
    }
}

impl ProcessPage {
    /// The finished parts of the current program since they were cleared, oldest first; while a dressing program is loaded
    /// those of the program that made the last part.
    fn parts<'a>(&self, snapshot: &'a Snapshot) -> impl Iterator<Item = &'a PartRecord> + use<'a> {
        let (loaded, cleared) = (snapshot.program.number, self.cleared);
        let is_part = |part: &&PartRecord| !snapshot.dressing_programs().contains(&part.program);
        let last = snapshot.production.parts.iter().rev().find(is_part).map(|part| part.program);
        let dresses = snapshot.dressing_programs().contains(&loaded);
        let program = last.filter(|_| dresses).unwrap_or(loaded);
        snapshot.production.parts.iter().filter(move |part| part.program == program && part.count > cleared)
    }

    /// Tracks what a dressing takes off the wheel; a new wheel starts again.
    fn track_dressing(&mut self, snapshot: &Snapshot) {
        let now = (snapshot.params.get(param::DRESSING_COUNT), snapshot.params.get(param::WHEEL_DIAMETER));
        match self.last_dressing {
            Some((count, diameter)) if now.0 > count => {
                self.dressing_removed_mm = Some(diameter - now.1);
                self.last_dressing = Some(now);
            }
            Some((count, _)) if now.0 < count => (self.dressing_removed_mm, self.last_dressing) = (None, Some(now)),
            // Same count: the wheel was changed or measured again. P97 may be 0 before and after.
            Some(_) | None => self.last_dressing = Some(now),
        }
    }

    /// The displayed time span, s.
    fn span(&self) -> f64 {
        self.span_seconds.unwrap_or(SPANS_SECONDS[0])
    }

    /// End of the displayed time span.
    fn window_end(&self, view: &View<'_>) -> Micros {
        self.window_end.map_or(view.snapshot.now, |end| Micros(end.0.min(view.snapshot.now.0)))
    }

    /// A finger drags the time axis, two fingers zoom it (H9). A span dragged to the present follows it again.
    fn drag(&mut self, rect: Rect, view: &View<'_>) {
        let response = view.ui.interact(rect, Id::unique("process-curves"), Sense::DRAG | Sense::HOVER);
        response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, "曲线 process-curves"));
        let width = f64::from((rect.width() - NAME_WIDTH).max(1.0));
        let (mut end, mut span) = (self.window_end(view).as_secs_f64(), self.span());
        if response.hovered() || response.dragged() {
            let longest = SPANS_SECONDS[SPANS_SECONDS.len() - 1];
            span = (span / f64::from(view.zoom_factor())).clamp(MIN_SPAN_SECONDS, longest);
        }
        let drawn = (span - self.span()).abs() > 1e-9;
        if drawn && self.window_end.is_some() {
            // Zooms around the middle of the displayed span.
            end += (span - self.span()) / 2.0;
        }
        let moved = f64::from(widget::drag_delta(&response).x);
        end -= moved / width * span;
        self.span_seconds = Some(span);
        if moved.abs() < f64::EPSILON && !(drawn && self.window_end.is_some()) {
            return;
        }
        let (now, first) = (view.snapshot.now, self.samples.front().map_or(0.0, |sample| sample.at.as_secs_f64()));
        let wanted = Micros((end.max(first + span) * 1e6) as u64);
        self.window_end = (wanted.0 < now.0).then_some(wanted);
    }

    fn curves(&self, rect: Rect, view: &View<'_>) {
        let snapshot = view.snapshot;
        let colours = [view.theme.info, view.theme.run, view.theme.macros];
        let mut rows: Vec<ProcessCurve> = Vec::new();
        let mut add = |name: String, colour: Color32, value: Box<dyn Fn(&Sample) -> f64>| {
            rows.push(ProcessCurve { name, colour, value });
        };
        for axis in view.axes() {
            let index = axis as usize;
            add(format!("{} mm", axis.letter()), colours[index], Box::new(move |sample| sample.axes[index]));
        }
        add("F mm/min".to_owned(), view.theme.hold, Box::new(|sample| sample.feed_mm_min));
        if snapshot.wheel_load_percent().is_some() {
            let name = view.text("砂轮负载 %", "wheel load %");
            add(name.to_owned(), view.theme.alarm_text, Box::new(|sample| sample.load_percent.unwrap_or(0.0)));
        }
        let gauge = 26.0;
        let height = (rect.height() - gauge) / rows.len() as f32;
        for (index, curve) in rows.iter().enumerate() {
            self.curve(rect.band(index as f32 * height, height - 4.0), view, curve);
        }
        self.gauges(rect.with_min_y(rect.max.y - gauge + 2.0), view);
    }

    /// Whether the live curves look different in a moment although nothing changes: they move to the left while they
    /// are not level over the whole span.
    fn curves_move(&self, now: Micros) -> bool {
        let mut visible = self.visible_samples(now);
        let Some(first) = visible.next() else { return true };
        let filled = now.since(first.at).as_secs_f64() + 2.0 * SAMPLE_PERIOD.as_secs_f64() > self.span();
        !filled || visible.any(|sample| Sample { at: first.at, ..*sample } != *first)
    }

    fn visible_samples(&self, end: Micros) -> impl Iterator<Item = &Sample> {
        let from = end.0.saturating_sub((self.span() * 1e6) as u64);
        let first = self.samples.partition_point(|sample| sample.at.0 < from);
        self.samples.iter().skip(first).take_while(move |sample| sample.at.0 <= end.0)
    }

    fn curve(&self, rect: Rect, view: &View<'_>, curve: &ProcessCurve) {
        let span = self.span();
        let (colour, value) = (curve.colour, curve.value.as_ref());
        view.card(rect);
        let now = self.window_end(view);
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for sample in self.visible_samples(now) {
            (low, high) = (low.min(value(sample)), high.max(value(sample)));
        }
        if low > high {
            (low, high) = (0.0, 0.0);
        }
        let (words, plot) = rect.shrink2(vec2(8.0, 3.0)).split_left_right_at_x(rect.min.x + NAME_WIDTH);
        let line = words.height() / 3.0;
        let row = |index: f32| words.trim_right(8.0).band(index * line, line);
        let last = self.visible_samples(now).last().or(self.samples.back()).map_or(0.0, value);
        view.line_left(row(0.0), &curve.name, theme::SMALL, colour);
        view.line_left(row(1.0), &view.length(last), theme::TITLE, view.theme.text);
        // The column has room for six digits of each.
        let decimals = if low.abs().max(high.abs()) < 1_000.0 { 3 } else { 1 };
        let range = format!("{low:.decimals$} … {high:.decimals$}");
        view.fit_left(row(2.0), &range, theme::SMALL, view.theme.muted);
        let room = (high - low).max(1e-3);
        let place = |sample: &Sample| {
            let age = (now.0.saturating_sub(sample.at.0)) as f64 / 1e6;
            let x = f64::from(plot.max.x) - age / span * f64::from(plot.width());
            let y = f64::from(plot.max.y) - 2.0 - (value(sample) - low) / room * f64::from(plot.height() - 4.0);
            pos2(x as f32, y as f32)
        };
        let points = with_extremes(self.visible_samples(now).map(place));
        view.painter.with_clip_rect(plot).add(Shape::line(points, Stroke::new(1.6, colour)));
    }

    /// The gauge signals as bars.
    fn gauges(&self, rect: Rect, view: &View<'_>) {
        let (words, plot) = rect.trim_sides(8.0).split_left_right_at_x(rect.min.x + NAME_WIDTH);
        let span = self.span();
        view.fit_left(words, view.text("量仪 1–6", "gauge 1–6"), theme::SMALL, view.theme.muted);
        let now = self.window_end(view);
        let height = plot.height() / GAUGES.len() as f32;
        view.painter.rect_filled(plot, 0.0, view.theme.surface);
        let samples: Vec<&Sample> = self.visible_samples(now).collect();
        for pair in samples.windows(2) {
            for bit in (0..GAUGES.len()).filter(|bit| pair[0].gauge_bits >> bit & 1 == 1) {
                let x = |at: Micros| {
                    plot.max.x - (now.0.saturating_sub(at.0) as f64 / 1e6 / span * f64::from(plot.width())) as f32
                };
                let top = plot.min.y + bit as f32 * height;
                let bar = Rect::from_min_max(pos2(x(pair[0].at), top), pos2(x(pair[1].at), top + height - 1.0));
                view.painter.with_clip_rect(plot).rect_filled(bar, 0.0, view.theme.run);
            }
        }
    }

    fn keys(&mut self, rect: Rect, view: &View<'_>) -> Option<Command> {
        let span = if self.shows_cycle { self.cycle.span_s() } else { self.span() };
        let words = format!("{} {span:.0} s", view.text("时间", "SPAN"));
        let back = |end| format!("{} {}", view.text("回到实时", "TO LIVE"), view.time(end));
        let live = self.window_end.map_or_else(|| view.text("实时", "LIVE").to_owned(), back);
        let is_lathe = view.snapshot.kind.ui().wheel_pose.is_none();
        let keys = [
            PageKey::new("process-span", &words).locked(self.shows_cycle),
            PageKey::new("process-live", &live).on(self.window_end.is_none() && !self.shows_cycle),
            PageKey::new("process-cycle", view.text("本件", "PART")).on(self.shows_cycle).locked(is_lathe),
            PageKey::new("process-clear", view.text("清除", "CLEAR")),
            PageKey::new("process-export", view.text("存为 CSV", "SAVE CSV")),
        ];
        match self.walk.keys(view, rect, &keys) {
            Some(0) => {
                let longer = SPANS_SECONDS.into_iter().find(|span| *span > self.span() + 0.5);
                self.span_seconds = longer;
            }
            Some(1) => (self.window_end, self.shows_cycle) = (None, false),
            Some(2) => self.shows_cycle = !self.shows_cycle,
            Some(3) => self.question.ask((), self.clear_question(view.snapshot)),
            Some(_) => {
                return Some(file_command(Requester::Screen, FileRequest::SaveTable(self.csv(view.snapshot))));
            }
            None => {}
        }
        None
    }

    /// The question names how much data will be lost.
    fn clear_question(&self, snapshot: &Snapshot) -> Question {
        let ends = self.samples.front().zip(self.samples.back());
        let seconds = ends.map_or(0.0, |(first, last)| last.at.since(first.at).as_secs_f64());
        let parts = self.parts(snapshot).count();
        let body = phrase!(
            "{seconds:.0} 秒的曲线将丢失；需要时先存为 CSV。{parts} 个工件的尺寸在下次开机前不再显示在这里。",
            "{seconds:.0} s of curves will be lost; SAVE CSV first if needed. The sizes of {parts} parts leave this page until the next power-on.",
            seconds,
            parts
        );
        let key = ("question-clear", Text::new("清除", "CLEAR"));
        Question::new(Text::new("清除过程数据？", "clear the recorded data?"), body, key)
    }

    /// CSV: one line per sample, then the parts. Only axes of the machine have a column; a missing signal leaves its
    /// field empty.
    fn csv(&self, snapshot: &Snapshot) -> String {
        let axes: Vec<Axis> = Axis::ALL.into_iter().filter(|axis| snapshot.axes[*axis].present).collect();
        let letters: String = axes.iter().map(|axis| format!("{},", axis.letter())).collect();
        let mut text = format!("seconds,{letters}feed_mm_min,wheel_load_percent,gauges\r\n");
        for sample in &self.samples {
            let (seconds, feed, gauges) = (sample.at.as_secs_f64(), sample.feed_mm_min, sample.gauge_bits);
            let places: String = axes.iter().map(|axis| format!("{:.4},", sample.axes[*axis as usize])).collect();
            let load = sample.load_percent.map_or_else(String::new, |load| format!("{load:.1}"));
            // Writing to a string does not fail.
            let _ = write!(text, "{seconds:.3},{places}{feed:.1},{load},{gauges:06b}\r\n");
        }
        text.push_str("\r\n");
        text.push_str(&part_table(snapshot, self.parts(snapshot)));
        text
    }
}

/// CSV of finished parts: one line each, a missing value leaves its field empty.
pub(super) fn part_table<'a>(snapshot: &Snapshot, parts: impl Iterator<Item = &'a PartRecord>) -> String {
    let mut text =
        String::from("part,cycle_seconds,size,nominal,lower,upper,verdict,program,order,ended,since_dressing\r\n");
    let number = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.4}"));
    for part in parts {
        let [nominal, low, high] = [0, 1, 2].map(|at| number(part.limits.map(|limits| limits[at])));
        let PartRecord { number: count, program, order, ended, cycle_seconds, since_dressing, .. } = part;
        let (size, verdict, program) = (number(part.size), part.verdict.id(), snapshot.title(*program));
        // Writing to a string does not fail.
        let _ = write!(
            text,
            "{count},{cycle_seconds:.1},{size},{nominal},{low},{high},{verdict},{program},{order},{ended},{since_dressing}\r\n"
        );
    }
    text
}

/// Reduces a curve to at most four points per pixel column: the first, the lowest and the highest, the last.
pub(super) fn with_extremes(curve: impl Iterator<Item = Pos2>) -> Vec<Pos2> {
    let mut points: Vec<Pos2> = Vec::new();
    // Index of the first point of the column.
    let mut first = 0;
    for at in curve {
        if points.get(first).is_some_and(|point| point.x.floor() < at.x.floor()) {
            first = points.len();
        }
        points.push(at);
        if points.len() - first > 4 {
            // One of the three between the first and the last goes: it is neither the lowest nor the highest.
            let mut middle = [first + 1, first + 2, first + 3];
            middle.sort_by(|a, b| points[*a].y.total_cmp(&points[*b].y));
            points.remove(middle[1]);
        }
    }
    points
}
