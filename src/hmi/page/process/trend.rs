//! Finished parts: sizes with their limits and their control chart, cycle times; the wheel and its dressings.
//! Source: tools.md (page process), K5.17, K4.5.

use egui::{Pos2, Rect, Shape, Stroke, pos2, vec2};

use super::{MAX_PARTS, ProcessPage};
use crate::defs::param;
use crate::defs::part_record::PartRecord;
use crate::hmi::{Area, View, theme};
use crate::link::Snapshot;
use crate::link::production::like_sizes;
use crate::technology::{EwmaPoint, capability, ewma};

/// Height of the line of statistics.
const STATISTICS_HEIGHT: f32 = 18.0;
/// Length and gap of the dashes of a control limit, points.
const DASH: (f32, f32) = (4.0, 3.0);

/// Sizes of the last parts as points between their limits, with their weighted mean (EWMA) between its control limits; a
/// part that is not good is a square.
pub(super) fn sizes(rect: Rect, view: &View<'_>, parts: &[&PartRecord]) {
    view.card(rect);
    let (head, plot) = rect.shrink2(vec2(10.0, 6.0)).split_top(22.0);
    let sized: Vec<&PartRecord> = parts.iter().copied().filter(|part| part.size.is_some()).collect();
    let Some(last) = sized.last() else {
        view.fit_left(head, view.text("尺寸 mm", "sizes mm"), theme::SMALL, view.theme.muted);
        let words = view.text(
            "还没有实测尺寸：量仪测出，或在磨削页输入实测尺寸后显示",
            "no size yet: a gauge measures it, or it is typed on the grinding page",
        );
        view.paragraph(plot, words, theme::SMALL, view.theme.muted);
        return;
    };
    // Statistics are those of like parts: the last ones with the same limits.
    let (like, limits) = like_sizes(&sized);
    let chart = ewma(&like);
    let drifts = chart.last().is_some_and(EwmaPoint::is_out);
    let taken = view.line_left(head, view.text("尺寸 mm", "sizes mm"), theme::SMALL, view.theme.muted);
    let found = capability(&like, limits.map(|[_, low, high]| (low, high)));
    let (below, plot) = plot.split_top(if found.is_some() { STATISTICS_HEIGHT } else { 0.0 });
    if let Some(found) = found {
        let cpk = found.indices.map_or_else(String::new, |(_, cpk)| format!(" · Cpk {cpk:.2}"));
        let words = format!("n {} · {} {:.4}{cpk}", found.count, view.text("平均", "mean"), found.mean);
        let shown = view.line_left(below, &words, theme::SMALL, view.theme.muted);
        if drifts {
            let rest = below.with_min_x(shown.max.x + theme::PAD);
            view.line_left(rest, view.text("漂移", "DRIFT"), theme::SMALL, view.theme.hold);
        }
    }
    let out = sized.iter().filter(|part| part.verdict.is_bad()).count();
    let ink = if last.verdict.is_bad() { view.theme.alarm_text } else { view.theme.text };
    let mut words = view.length(last.size.unwrap_or(f64::NAN));
    if let Some([nominal, low, high]) = last.limits {
        words = format!("{words} / {nominal:.3} {:+.3} {:+.3}", high - nominal, low - nominal);
    }
    if out > 0 {
        words = format!("{words} · {} {out}", view.text("不良", "NOK"));
    }
    view.fit_right(head.with_min_x(taken.max.x + theme::GAP), &words, theme::LABEL, ink);
    paint_sizes(view, plot, &sized, &chart);
}

/// Cycle times of the last parts as bars.
pub(super) fn cycle_times(rect: Rect, view: &View<'_>, parts: &[&PartRecord]) {
    view.card(rect);
    let (head, plot) = rect.shrink2(vec2(10.0, 6.0)).split_top(22.0);
    view.fit_left(head, view.text("最近工件节拍 s", "cycle times s"), theme::SMALL, view.theme.muted);
    let Some(last) = parts.last() else {
        let words = view.text("还没有加工完的工件", "no part finished yet");
        view.paragraph(plot, words, theme::SMALL, view.theme.muted);
        return;
    };
    view.line_right(head, &format!("{:.1}", last.cycle_seconds), theme::LABEL, view.theme.text);
    let most = parts.iter().map(|part| part.cycle_seconds).fold(1e-3, f64::max);
    let width = plot.width() / MAX_PARTS as f32;
    for (index, part) in parts.iter().enumerate() {
        let height = (part.cycle_seconds / most) as f32 * plot.height();
        let corner = pos2(plot.min.x + index as f32 * width, plot.max.y - height);
        view.painter.rect_filled(Rect::from_min_size(corner, vec2(width - 1.5, height)), 0.0, view.theme.info);
    }
}

impl ProcessPage {
    /// The wheel: diameter, number of dressings, dressings left.
    pub(super) fn wheel(&self, rect: Rect, view: &View<'_>) {
        view.card(rect);
        let inside = rect.shrink2(vec2(10.0, 6.0));
        let params = &view.snapshot.params;
        let since = params.get(param::PARTS_SINCE_DRESSING);
        let next = view.snapshot.dressing_interval().map(|interval| format!("{:.0}", (interval - since).max(0.0)));
        let next = next.unwrap_or_else(|| "—".to_owned());
        let left = self.dressings_left(view.snapshot).map_or_else(|| "—".to_owned(), |left| left.to_string());
        let rows = [
            (view.text("砂轮直径 mm", "wheel diameter mm"), view.length(params.get(param::WHEEL_DIAMETER))),
            (view.text("修整次数", "dressings"), format!("{:.0}", params.get(param::DRESSING_COUNT))),
            (view.text("还可修整次数", "remaining dressings"), left),
            (view.text("修整后件数", "parts since dressing"), format!("{since:.0}")),
            (view.text("距下次修整 件", "parts to dressing"), next),
        ];
        let height = inside.height() / rows.len() as f32;
        for (index, (name, value)) in rows.into_iter().enumerate() {
            let (left, right) = inside.band(index as f32 * height, height).split_left_right_at_fraction(0.66);
            view.fit_left(left, name, theme::LABEL, view.theme.muted);
            view.line_right(right, &value, theme::LABEL, view.theme.text);
        }
    }

    /// Dressings left down to the smallest diameter (P374), each taking as much as the last one. None before the first
    /// dressing since power-on, or without P374.
    fn dressings_left(&self, snapshot: &Snapshot) -> Option<u32> {
        let (smallest, now) =
            (snapshot.params.get(param::WHEEL_MIN_DIAMETER), snapshot.params.get(param::WHEEL_DIAMETER));
        let taken = self.dressing_removed_mm.filter(|taken| *taken > 0.0 && smallest > 0.0)?;
        Some(((now - smallest).max(0.0) / taken + 1e-6).floor() as u32)
    }
}

/// The EWMA of the last parts between its control limits.
fn paint_chart(view: &View<'_>, plot: Rect, chart: &[EwmaPoint], place: impl Fn(usize, f64) -> Pos2) {
    let painter = view.painter.with_clip_rect(plot);
    let line = |value: fn(&EwmaPoint) -> f64| -> Vec<Pos2> {
        chart.iter().enumerate().map(|(at, point)| place(at, value(point))).collect()
    };
    for limit in [line(|point| point.limits.0), line(|point| point.limits.1)] {
        painter.extend(Shape::dashed_line(&limit, Stroke::new(theme::HAIRLINE, view.theme.info), DASH.0, DASH.1));
    }
    painter.add(Shape::line(line(|point| point.mean), Stroke::new(1.6, view.theme.info)));
}

/// The sizes over the lines of their limits; the chart belongs to the last of them.
fn paint_sizes(view: &View<'_>, plot: Rect, sized: &[&PartRecord], chart: &[EwmaPoint]) {
    let sizes = sized.iter().filter_map(|part| part.size);
    let bounds = sized.iter().filter_map(|part| part.limits).flat_map(|limits| limits.into_iter());
    let (low, high) = sizes
        .chain(bounds)
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
    let room = (high - low).max(1e-3) * 1.16;
    let middle = f64::midpoint(low, high);
    let y = |value: f64| plot.center().y - ((value - middle) / room * f64::from(plot.height())) as f32;
    let step = plot.width() / MAX_PARTS as f32;
    let x = |index: usize| plot.min.x + (index as f32 + 0.5) * step;
    let first = sized.len() - chart.len();
    paint_chart(view, plot, chart, |at, value| pos2(x(first + at), y(value)));
    // A dashed line where the wheel was dressed.
    let was_dressed = |before: &PartRecord, part: &PartRecord| {
        u64::from(part.since_dressing) < u64::from(before.since_dressing) + (part.count - before.count)
    };
    for index in (1..sized.len()).filter(|index| was_dressed(sized[index - 1], sized[*index])) {
        let at = x(index) - step / 2.0;
        let line = [pos2(at, plot.min.y), pos2(at, plot.max.y)];
        view.painter.extend(Shape::dashed_line(&line, Stroke::new(theme::HAIRLINE, view.theme.muted), DASH.0, DASH.1));
    }
    for (index, part) in sized.iter().enumerate() {
        let across = x(index) - step / 2.0..=x(index) + step / 2.0;
        if let Some([nominal, low, high]) = part.limits {
            view.painter.hline(across.clone(), y(nominal), Stroke::new(theme::HAIRLINE, view.theme.line));
            view.painter.hline(across.clone(), y(low), Stroke::new(theme::FRAME, view.theme.hold));
            view.painter.hline(across, y(high), Stroke::new(theme::FRAME, view.theme.hold));
        }
        let Some(size) = part.size else { continue };
        let at = pos2(x(index), y(size));
        if part.verdict.is_bad() {
            view.painter.rect_filled(Rect::from_center_size(at, vec2(9.0, 9.0)), 0.0, view.theme.alarm_text);
        } else {
            view.painter.circle_filled(at, 3.0, view.theme.run);
        }
    }
}
