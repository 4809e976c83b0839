//! Parts finished since power-on: sizes with their limits, cycle times; the wheel and its dressings.
//! Source: tools.md (page process), K5.17, K4.5.

use egui::{Rect, Stroke, pos2, vec2};

use super::{MAX_PARTS, ProcessPage};
use crate::defs::param;
use crate::hmi::{Area, View, theme};
use crate::link::Snapshot;
use crate::link::part_result::{PartResult, PartVerdict};

/// A finished part.
#[derive(Clone, Copy, Debug)]
pub struct FinishedPart {
    /// Its number in the part count.
    pub number: u32,
    /// Cycle time, s.
    pub cycle_seconds: f64,
    /// Measured size, mm; none: not measured.
    pub size: Option<f64>,
    /// Nominal, least and greatest size, mm, as in force when the part was finished.
    pub limits: Option<[f64; 3]>,
    /// Whether it is good.
    pub verdict: PartVerdict,
}

impl FinishedPart {
    /// The part of the last cycle.
    pub fn of(part: &PartResult, snapshot: &Snapshot) -> Self {
        let simulated = snapshot.simulated.as_deref();
        let size = part.judged_size(simulated).map(|size| size.mm());
        // Without a nominal size: any size of the part shows how it changes.
        let any = || simulated?.finished_sizes.first().map(|size| size.mm);
        Self {
            number: part.number,
            cycle_seconds: part.times.seconds,
            size: size.or_else(|| part.nominal.is_none().then(any).flatten()),
            limits: part.nominal.and_then(|nominal| nominal.limits.map(|(low, high)| [nominal.mm, low, high])),
            verdict: part.verdict(simulated),
        }
    }
}

impl ProcessPage {
    /// Sizes of the last parts as points between their limits; a part that is not good is a square.
    pub(super) fn trend(&self, rect: Rect, view: &View<'_>) {
        view.card(rect);
        let (head, plot) = rect.shrink2(vec2(10.0, 6.0)).split_top(22.0);
        let taken = view.line_left(head, view.text("尺寸 mm", "sizes mm"), theme::SMALL, view.theme.muted);
        let sized: Vec<&FinishedPart> = self.parts.iter().filter(|part| part.size.is_some()).collect();
        let Some(last) = sized.last() else {
            let words = view.text(
                "还没有实测尺寸：P375 为存实测尺寸的变量，公称尺寸和偏差取自页面或 P376–P378",
                "no size yet: P375 is the variable of the size; nominal size and deviations are those of the page or P376 to P378",
            );
            view.paragraph(plot, words, theme::SMALL, view.theme.muted);
            return;
        };
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
        paint_sizes(view, plot, &sized);
    }

    /// Cycle times of the last parts as bars.
    pub(super) fn cycle_times(&self, rect: Rect, view: &View<'_>) {
        view.card(rect);
        let (head, plot) = rect.shrink2(vec2(10.0, 6.0)).split_top(22.0);
        view.fit_left(head, view.text("最近工件节拍 s", "cycle times s"), theme::SMALL, view.theme.muted);
        let Some(last) = self.parts.back() else {
            let words = view.text("开机后还没有加工完的工件", "no part finished since power-on");
            view.paragraph(plot, words, theme::SMALL, view.theme.muted);
            return;
        };
        view.line_right(head, &format!("{:.1}", last.cycle_seconds), theme::LABEL, view.theme.text);
        let most = self.parts.iter().map(|part| part.cycle_seconds).fold(1e-3, f64::max);
        let width = plot.width() / MAX_PARTS as f32;
        for (index, part) in self.parts.iter().enumerate() {
            let height = (part.cycle_seconds / most) as f32 * plot.height();
            let corner = pos2(plot.min.x + index as f32 * width, plot.max.y - height);
            view.painter.rect_filled(Rect::from_min_size(corner, vec2(width - 1.5, height)), 0.0, view.theme.info);
        }
    }

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

/// The sizes over the lines of their limits.
fn paint_sizes(view: &View<'_>, plot: Rect, sized: &[&FinishedPart]) {
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
