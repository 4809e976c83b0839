//! Charts of the times of a tick: how often which time came.
//! Source: docs/manual, chapter "first start on a machine".

use egui::{Rect, Vec2, pos2, vec2};

use crate::defs::param;
use crate::hmi::{Area, View, theme};
use crate::link::bus::BusView;
use crate::units::{CHART_CLASSES, Micros, Percentiles, TimeDistribution};

/// Height of the names of the classes, and of the counts above the bars.
const WORDS_HEIGHT: f32 = 18.0;
/// How far a count may reach beyond its class.
const OVERHANG: Vec2 = vec2(4.0, 0.0);
/// Share of its class that a bar fills.
const BAR_SHARE: f32 = 0.8;

/// Draws a chart for each kind of time, two beside each other.
pub fn ui(rect: Rect, view: &View<'_>, bus: &BusView) {
    let charts = [
        Some((view.text("唤醒延迟", "wake-up latency"), bus.wake_up)),
        Some((view.text("执行时间", "execution time"), bus.execution)),
        Some((view.text("报文往返", "round trip"), bus.round_trip)),
        bus.clock.map(|clock| (view.text("偏离总线时钟", "off the bus clock"), clock.distance)),
    ];
    for (index, (name, times)) in charts.into_iter().flatten().enumerate() {
        let height = rect.height() / 2.0;
        let row = rect.band((index / 2) as f32 * height, height);
        chart(row.cell(index % 2, 2).shrink(theme::GAP / 2.0), view, name, times);
    }
}

/// A bar for each class. Its height is the logarithm of the count: one late tick of a million is seen. Classes beyond the
/// time of a tick have the colour of an alarm.
fn chart(rect: Rect, view: &View<'_>, name: &str, times: TimeDistribution) {
    view.card(rect);
    let inside = rect.shrink2(vec2(theme::PAD, theme::GAP));
    let (head, rest) = inside.split_top(24.0);
    let name = view.line_left(head, name, theme::LABEL, view.theme.text);
    let Percentiles { median, p99, max } = times.percentiles;
    let figures = format!("50% {}  99% {}  {} {} µs", median.0, p99.0, view.text("最大", "max"), max.0);
    view.fit_right(head.with_min_x(name.max.x + theme::PAD), &figures, theme::SMALL, view.theme.muted);
    let (plot, axis) = rest.split_bottom(WORDS_HEIGHT);
    let (_, bars) = plot.split_top(WORDS_HEIGHT);
    view.hairline(bars, bars.max.y);
    let tick_us = view.snapshot.params.get(param::TICK_TIME) as u64;
    let most = log_count(times.counts.into_iter().max().unwrap_or(0)).max(1.0);
    for (index, (begin, count)) in CHART_CLASSES.into_iter().zip(times.counts).enumerate() {
        let place = bars.cell(index, CHART_CLASSES.len());
        let is_late = begin >= tick_us;
        let label = axis.cell(index, CHART_CLASSES.len());
        view.fit_centre(label, &short(begin), theme::SMALL, view.theme.muted);
        if count == 0 {
            continue;
        }
        let top = place.max.y - place.height() * log_count(count) / most;
        let margin = place.width() * (1.0 - BAR_SHARE) / 2.0;
        let bar = Rect::from_min_max(pos2(place.min.x + margin, top), pos2(place.max.x - margin, place.max.y));
        view.painter.rect_filled(bar, 0.0, if is_late { view.theme.alarm } else { view.theme.run });
        let above = Rect::from_min_max(pos2(place.min.x, top - WORDS_HEIGHT), pos2(place.max.x, top)).expand2(OVERHANG);
        let ink = if is_late { view.theme.alarm_text } else { view.theme.text };
        view.fit_centre(above, &short(count), theme::SMALL, ink);
    }
}

/// Median, 99th percentile and maximum: `20 / 90 / 12340 µs`.
pub fn words(times: Percentiles) -> String {
    let Percentiles { median: Micros(median), p99: Micros(p99), max: Micros(max) } = times;
    format!("{median} / {p99} / {max} µs")
}

/// Height of a count: 1 is seen, and each decade is as high as the one before.
fn log_count(count: u64) -> f32 {
    if count == 0 { 0.0 } else { 1.0 + (count as f32).log10() }
}

/// A count or a time in at most four places: `873`, `1.2k`, `86M`.
fn short(number: u64) -> String {
    let decimals = |number: u64, unit: u64, sign: char| match number / unit {
        whole @ 0..10 if number % unit >= unit / 10 => format!("{whole}.{}{sign}", number % unit / (unit / 10)),
        whole => format!("{whole}{sign}"),
    };
    match number {
        0..1_000 => number.to_string(),
        1_000..1_000_000 => decimals(number, 1_000, 'k'),
        1_000_000..1_000_000_000 => decimals(number, 1_000_000, 'M'),
        1_000_000_000.. => decimals(number, 1_000_000_000, 'G'),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stay_short_and_every_count_is_seen() {
        let shown = [0, 999, 1_000, 1_099, 9_999, 10_000, 999_999, 1_200_000, 41_000_000, 5_000_000_000].map(short);
        assert_eq!(shown, ["0", "999", "1k", "1k", "9.9k", "10k", "999k", "1.2M", "41M", "5G"]);
        let heights = [0, 1, 10, 1_000_000].map(log_count);
        assert!(heights.iter().zip([0.0_f32, 1.0, 2.0, 7.0]).all(|(is, due)| (is - due).abs() < 1e-6), "{heights:?}");
    }
}
