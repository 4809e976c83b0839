//! The process: live curves of axes, feed, wheel load and gauge; cycle times of the last parts; the wheel through its
//! dressings; everything as a table for a computer.
//! Source: tools.md (page process), K4.3, K4.5, K5.17, H9.

use std::collections::VecDeque;
use std::fmt::Write;

use egui::{Align2, Color32, Painter, Pos2, Rect, Shape, Stroke, Ui, pos2, vec2};

use super::Typed;
use crate::defs::param;
use crate::defs::signal::Input;
use crate::hmi::theme;
use crate::hmi::view::{View, card, fit, length, put};
use crate::hmi::widget::{Look, Walk};
use crate::link::Command;
use crate::link::files::FileRequest;
use crate::link::page_command::PageCommand;
use crate::units::{Axis, Micros};

/// Time between two samples, and how many are kept: ten minutes.
const EVERY: Micros = Micros::from_millis(100);
const SAMPLES: usize = 6_000;
/// Spans of time that can be looked at, seconds.
const SPANS: [f64; 4] = [10.0, 60.0, 180.0, 600.0];
/// Parts whose cycle times are kept.
const PARTS: usize = 50;
/// Height of the keys.
const KEYS: f32 = 46.0;
/// The gauge's inputs.
const GAUGES: [Input; 6] = [Input::Gauge1, Input::Gauge2, Input::Gauge3, Input::Gauge4, Input::Gauge5, Input::Gauge6];

/// What was seen at a moment.
#[derive(Clone, Copy, Debug)]
struct Sample {
    at: Micros,
    axes: [f64; 3],
    feed_mm_min: f64,
    load_percent: f64,
    gauges: u8,
}

/// One curve: its name, its colour, and what it takes of a sample.
struct Curve {
    name: String,
    colour: Color32,
    value: Box<dyn Fn(&Sample) -> f64>,
}

/// What the page keeps.
#[derive(Debug, Default)]
pub struct Process {
    samples: VecDeque<Sample>,
    parts: VecDeque<(u32, f64)>,
    counted: Option<u32>,
    span: usize,
    walk: Walk,
}

impl Process {
    /// Takes a sample; called in every frame, whichever page is open.
    pub fn follow(&mut self, view: &View<'_>) {
        let snapshot = view.snapshot;
        if self.counted.is_some_and(|counted| snapshot.parts > counted) {
            self.parts.push_back((snapshot.parts, snapshot.cycle_seconds));
            if self.parts.len() > PARTS {
                self.parts.pop_front();
            }
        }
        self.counted = Some(snapshot.parts);
        if self.samples.back().is_some_and(|last| snapshot.now < last.at) {
            self.samples.clear();
        }
        if self.samples.back().is_some_and(|last| snapshot.now.since(last.at) < EVERY) {
            return;
        }
        let gauges = GAUGES.iter().enumerate().filter(|(_, gauge)| snapshot.inputs.has(**gauge));
        self.samples.push_back(Sample {
            at: snapshot.now,
            axes: Axis::ALL.map(|axis| snapshot.axes[axis].work),
            feed_mm_min: snapshot.feed_mm_min,
            load_percent: snapshot.simulated.as_ref().map_or(0.0, |sim| sim.wheel_load_percent),
            gauges: gauges.fold(0, |bits, (index, _)| bits | 1 << index),
        });
        if self.samples.len() > SAMPLES {
            self.samples.pop_front();
        }
    }

    /// Draws the page.
    pub fn ui(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, typed: &Typed<'_>) -> Vec<Command> {
        ui.ctx().request_repaint_after(std::time::Duration::from_micros(EVERY.0));
        self.walk.begin(typed.edits);
        let inside = rect.shrink2(vec2(theme::PAD, 6.0));
        let (body, keys) = inside.split_top_bottom_at_y(inside.max.y - KEYS);
        let body = Rect::from_min_max(body.min, body.max - vec2(0.0, theme::GAP));
        let (curves, below) = body.split_top_bottom_at_y(body.max.y - 118.0);
        self.curves(ui, Rect::from_min_max(curves.min, curves.max - vec2(0.0, theme::GAP)), view);
        let (parts, wheel) = below.split_left_right_at_fraction(0.56);
        self.cycles(ui, Rect::from_min_max(parts.min, parts.max - vec2(theme::GAP, 0.0)), view);
        wheel_of(ui, wheel, view);
        self.keys(ui, keys, view)
    }

    fn curves(&self, ui: &Ui, rect: Rect, view: &View<'_>) {
        let span = SPANS[self.span % SPANS.len()];
        let snapshot = view.snapshot;
        let colours = [view.theme.info, view.theme.run, view.theme.macros];
        let mut rows: Vec<Curve> = Vec::new();
        let mut add = |name: String, colour: Color32, value: Box<dyn Fn(&Sample) -> f64>| {
            rows.push(Curve { name, colour, value });
        };
        for axis in Axis::ALL.into_iter().filter(|axis| snapshot.axes[*axis].present) {
            let index = axis as usize;
            add(format!("{} mm", axis.letter()), colours[index], Box::new(move |sample| sample.axes[index]));
        }
        add("F mm/min".to_owned(), view.theme.hold, Box::new(|sample| sample.feed_mm_min));
        if snapshot.simulated.is_some() {
            let name = view.say("砂轮负载 %", "wheel load %");
            add(name.to_owned(), view.theme.alarm_text, Box::new(|sample| sample.load_percent));
        }
        let gauge = 26.0;
        let height = (rect.height() - gauge) / rows.len() as f32;
        for (index, curve) in rows.iter().enumerate() {
            let corner = rect.min + vec2(0.0, index as f32 * height);
            let place = Rect::from_min_size(corner, vec2(rect.width(), height - 4.0));
            self.curve(ui.painter(), place, view, curve, span);
        }
        let strip = Rect::from_min_max(pos2(rect.min.x, rect.max.y - gauge + 2.0), rect.max);
        self.gauges(ui.painter(), strip, view, span);
    }

    fn window(&self, now: Micros, span: f64) -> impl Iterator<Item = &Sample> {
        let from = now.0.saturating_sub((span * 1e6) as u64);
        self.samples.iter().skip(self.samples.partition_point(|sample| sample.at.0 < from))
    }

    fn curve(&self, painter: &Painter, rect: Rect, view: &View<'_>, curve: &Curve, span: f64) {
        let (colour, value) = (curve.colour, curve.value.as_ref());
        card(painter, rect, view.theme.surface, view.theme.line);
        let now = view.snapshot.now;
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for sample in self.window(now, span) {
            (low, high) = (low.min(value(sample)), high.max(value(sample)));
        }
        if low > high {
            (low, high) = (0.0, 0.0);
        }
        let (words, plot) = rect.shrink2(vec2(8.0, 3.0)).split_left_right_at_x(rect.min.x + 150.0);
        let line = words.height() / 3.0;
        let row =
            |index: f32| Rect::from_min_size(words.min + vec2(0.0, index * line), vec2(words.width() - 8.0, line));
        let last = self.samples.back().map_or(0.0, value);
        put(painter, row(0.0), Align2::LEFT_CENTER, &curve.name, theme::SMALL, colour);
        put(painter, row(1.0), Align2::LEFT_CENTER, &length(last), theme::TITLE, view.theme.text);
        let range = format!("{low:.3} … {high:.3}");
        fit(painter, row(2.0), Align2::LEFT_CENTER, &range, theme::SMALL, view.theme.quiet);
        let room = (high - low).max(1e-3);
        let place = |sample: &Sample| {
            let age = (now.0.saturating_sub(sample.at.0)) as f64 / 1e6;
            let x = f64::from(plot.max.x) - age / span * f64::from(plot.width());
            let y = f64::from(plot.max.y) - 2.0 - (value(sample) - low) / room * f64::from(plot.height() - 4.0);
            pos2(x as f32, y as f32)
        };
        // Two points a pixel column are enough: its least and its greatest.
        let mut points: Vec<Pos2> = Vec::new();
        for at in self.window(now, span).map(place) {
            let column = |point: &Pos2| point.x.floor() as i32;
            let same = points.len() >= 3 && points[points.len() - 3..].iter().all(|point| column(point) == column(&at));
            if same {
                points.pop();
            }
            points.push(at);
        }
        painter.with_clip_rect(plot).add(Shape::line(points, Stroke::new(1.6, colour)));
    }

    /// The gauge's signals as bars.
    fn gauges(&self, painter: &Painter, rect: Rect, view: &View<'_>, span: f64) {
        let (words, plot) = rect.shrink2(vec2(8.0, 0.0)).split_left_right_at_x(rect.min.x + 150.0);
        fit(painter, words, Align2::LEFT_CENTER, view.say("量仪 1–6", "gauge 1–6"), theme::SMALL, view.theme.quiet);
        let now = view.snapshot.now;
        let height = plot.height() / GAUGES.len() as f32;
        painter.rect_filled(plot, 0.0, view.theme.surface);
        let samples: Vec<&Sample> = self.window(now, span).collect();
        for pair in samples.windows(2) {
            for bit in (0..GAUGES.len()).filter(|bit| pair[0].gauges >> bit & 1 == 1) {
                let x = |at: Micros| {
                    plot.max.x - (now.0.saturating_sub(at.0) as f64 / 1e6 / span * f64::from(plot.width())) as f32
                };
                let top = plot.min.y + bit as f32 * height;
                let bar = Rect::from_min_max(pos2(x(pair[0].at), top), pos2(x(pair[1].at), top + height - 1.0));
                painter.with_clip_rect(plot).rect_filled(bar, 0.0, view.theme.run);
            }
        }
    }

    /// Cycle times of the last parts as columns.
    fn cycles(&self, ui: &Ui, rect: Rect, view: &View<'_>) {
        card(ui.painter(), rect, view.theme.surface, view.theme.line);
        let inside = rect.shrink2(vec2(10.0, 6.0));
        let (head, plot) = inside.split_top_bottom_at_y(inside.min.y + 22.0);
        fit(
            ui.painter(),
            head,
            Align2::LEFT_CENTER,
            view.say("最近工件节拍 s", "cycle times s"),
            theme::SMALL,
            view.theme.quiet,
        );
        let Some((_, last)) = self.parts.back() else {
            let words = view.say("开机后还没有加工完的工件", "no part finished since power-on");
            fit(ui.painter(), plot, Align2::LEFT_CENTER, words, theme::LABEL, view.theme.quiet);
            return;
        };
        put(ui.painter(), head, Align2::RIGHT_CENTER, &format!("{last:.1}"), theme::LABEL, view.theme.text);
        let most = self.parts.iter().map(|(_, seconds)| *seconds).fold(1e-3, f64::max);
        let width = plot.width() / PARTS as f32;
        for (index, (_, seconds)) in self.parts.iter().enumerate() {
            let height = (seconds / most) as f32 * plot.height();
            let corner = pos2(plot.min.x + index as f32 * width, plot.max.y - height);
            let bar = Rect::from_min_size(corner, vec2(width - 1.5, height));
            ui.painter().rect_filled(bar, 0.0, view.theme.info);
        }
    }

    fn keys(&mut self, ui: &Ui, rect: Rect, view: &View<'_>) -> Vec<Command> {
        let span = SPANS[self.span % SPANS.len()];
        let words = format!("{} {span:.0} s", view.say("时间", "SPAN"));
        let clear = view.say("清除", "CLEAR").to_owned();
        let export = view.say("存为 CSV", "SAVE CSV").to_owned();
        let width = (rect.width() + theme::GAP) / 3.0;
        let mut out = Vec::new();
        let keys = [("process-span", words), ("process-clear", clear), ("process-export", export)];
        for (index, (name, label)) in keys.into_iter().enumerate() {
            let corner = pos2(rect.min.x + index as f32 * width, rect.min.y);
            let place = Rect::from_min_size(corner, vec2(width - theme::GAP, rect.height()));
            if !self.walk.push(ui, view, place, (name, &label), Look::default()) {
                continue;
            }
            match name {
                "process-span" => self.span += 1,
                "process-clear" => {
                    self.samples.clear();
                    self.parts.clear();
                }
                _ => out.push(Command::Page(PageCommand::File(FileRequest::Table(self.table())))),
            }
        }
        out
    }

    /// The samples, a line each.
    fn table(&self) -> String {
        let mut text = String::from("seconds,X,Y,Z,feed_mm_min,wheel_load_percent,gauges\r\n");
        for sample in &self.samples {
            let ([x, y, z], seconds) = (sample.axes, sample.at.as_secs_f64());
            let (feed, load, gauges) = (sample.feed_mm_min, sample.load_percent, sample.gauges);
            // Writing into a string does not fail.
            let _ = write!(text, "{seconds:.3},{x:.4},{y:.4},{z:.4},{feed:.1},{load:.1},{gauges:06b}\r\n");
        }
        text
    }
}

/// The wheel: its diameter and what is known of its dressings.
fn wheel_of(ui: &Ui, rect: Rect, view: &View<'_>) {
    card(ui.painter(), rect, view.theme.surface, view.theme.line);
    let inside = rect.shrink2(vec2(10.0, 6.0));
    let params = &view.snapshot.params;
    let interval = params.get(param::DRESSING_INTERVAL);
    let since = params.get(param::PARTS_SINCE_DRESSING);
    let left = if interval > 0.0 { format!("{:.0}", (interval - since).max(0.0)) } else { "—".to_owned() };
    let rows = [
        (view.say("砂轮直径 mm", "wheel diameter mm"), length(params.get(param::WHEEL_DIAMETER))),
        (view.say("修整次数", "dressings"), format!("{:.0}", params.get(param::DRESSINGS))),
        (view.say("修整后件数", "parts since dressing"), format!("{since:.0}")),
        (view.say("距下次修整 件", "parts to the next"), left),
    ];
    let height = inside.height() / rows.len() as f32;
    for (index, (name, value)) in rows.into_iter().enumerate() {
        let corner = inside.min + vec2(0.0, index as f32 * height);
        let line = Rect::from_min_size(corner, vec2(inside.width(), height));
        let (left, right) = line.split_left_right_at_fraction(0.66);
        fit(ui.painter(), left, Align2::LEFT_CENTER, name, theme::LABEL, view.theme.quiet);
        put(ui.painter(), right, Align2::RIGHT_CENTER, &value, theme::LABEL, view.theme.text);
    }
}
