//! The bar of a run, in the place of the start guide: time of the cycle, and how far it is by the time of the part before.
//! Source: spec K7.2, H8.

use egui::{Rect, vec2};

use crate::hmi::{Area, View, format_cycle_time, theme};

/// Width of the time of the cycle.
const TIME_WIDTH: f32 = 84.0;
/// Height of the bar.
const BAR: f32 = 10.0;

/// Draws the bar while a run is open.
pub fn ui(rect: Rect, view: &View<'_>) {
    let snapshot = view.snapshot;
    if !snapshot.program.is_open {
        return;
    }
    view.card(rect);
    let (time, rest) = rect.shrink2(vec2(theme::PAD, theme::GAP)).split_left(TIME_WIDTH);
    let spent = snapshot.cycle.seconds;
    view.fit_left(time, &format_cycle_time(spent), theme::FIGURE, view.theme.text);
    let Some(seconds) = snapshot.cycle.seconds_before.filter(|seconds| *seconds > 0.0) else {
        let words = view.text("还没有可比的循环时间", "no cycle time to compare with yet");
        view.fit_left(rest, words, theme::LABEL, view.theme.muted);
        return;
    };
    let (words, line) = rest.split_bottom(BAR + theme::GAP);
    let left = (seconds - spent).max(0.0);
    let before = format!("{} {}", view.text("上一件", "part before"), format_cycle_time(seconds));
    let to_go = match left > 0.0 {
        true => format!("{} {}", view.text("还有约", "about"), format_cycle_time(left)) + view.text("", " left"),
        false => format!("{} {}", view.text("比上一件长", "longer by"), format_cycle_time(spent - seconds)),
    };
    let ink = if left > 0.0 { view.theme.text } else { view.theme.hold };
    let taken = view.fit_right(words, &before, theme::LABEL, view.theme.muted);
    view.fit_left(words.with_max_x(taken.min.x - theme::PAD), &to_go, theme::TITLE, ink);
    let bar = line.split_top(BAR).0;
    view.filled_card(bar, view.theme.background, view.theme.line);
    let done = bar.with_max_x(bar.min.x + bar.width() * (spent / seconds).min(1.0) as f32);
    view.painter.rect_filled(done, theme::RADIUS, if left > 0.0 { view.theme.run } else { view.theme.hold });
}
