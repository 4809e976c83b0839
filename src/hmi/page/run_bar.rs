//! The bar of a run, in the place of the start guide: the phases that the program names by `#5828`, the time of the cycle,
//! and what is left by the cycle before.
//! Source: spec K7.2, H8.

use egui::{Rect, Stroke, StrokeKind, vec2};

use crate::defs::grinding_phase::GrindingPhase;
use crate::hmi::{Area, View, format_cycle_time, pictogram, theme};
use crate::link::cycle::CycleView;

/// Width of the time of the cycle.
const TIME_WIDTH: f32 = 84.0;
/// Width of what is left.
const LEFT_WIDTH: f32 = 150.0;
/// Height of the bar of a phase.
const BAR: f32 = 10.0;
/// Least width of a phase: tick and time.
const NAME_MIN: f32 = 48.0;
/// Space beside the name of a phase.
const NAME_PAD: f32 = 16.0;

/// Draws the bar while a run is open.
pub fn ui(rect: Rect, view: &View<'_>) {
    let cycle = &view.snapshot.cycle;
    if !view.snapshot.program.is_open {
        return;
    }
    view.card(rect);
    let (time, rest) = rect.shrink2(vec2(theme::PAD, theme::GAP)).split_left(TIME_WIDTH);
    view.fit_left(time, &format_cycle_time(cycle.times.seconds), theme::FIGURE, view.theme.text);
    let shown: Vec<_> = GrindingPhase::ALL.into_iter().filter(|phase| cycle.has_phase(*phase)).collect();
    if shown.is_empty() {
        whole(rest, view);
        return;
    }
    let (bars, left) = rest.split_right(LEFT_WIDTH);
    phases(bars.trim_right(theme::PAD), view, &shown);
    let (above, below) = left.split_bottom(left.height() / 2.0);
    say_left(above, below, view);
}

/// The bar of a program that names no phase.
fn whole(rect: Rect, view: &View<'_>) {
    let (words, line) = rect.split_bottom(BAR + theme::GAP);
    let (left, before) = words.split_right(words.width() / 2.0);
    say_left(left, before, view);
    if let Some(before) = view.snapshot.cycle.before {
        progress(line.split_top(BAR).0, view, view.snapshot.cycle.times.seconds, before.seconds);
    }
}

/// What is left, and how long the cycle before took.
fn say_left(left: Rect, before: Rect, view: &View<'_>) {
    let cycle = &view.snapshot.cycle;
    let Some((seconds, last)) = cycle.seconds_left().zip(cycle.before) else {
        let words = view.text("还没有可比的循环时间", "no cycle time to compare with yet");
        view.text_rows(left.union(before), words, theme::SMALL, view.theme.muted, 2);
        return;
    };
    let late = cycle.times.seconds - last.seconds;
    let (words, ink) = if seconds > 0.0 || late <= 0.0 {
        let time = format_cycle_time(seconds);
        (format!("{} {time}{}", view.text("还有约", "about"), view.text("", " left")), view.theme.text)
    } else {
        (format!("{} {}", view.text("比上一件长", "longer by"), format_cycle_time(late)), view.theme.hold)
    };
    view.fit_left(left, &words, theme::TITLE, ink);
    let words = format!("{} {}", view.text("上一件", "part before"), format_cycle_time(last.seconds));
    view.fit_left(before, &words, theme::LABEL, view.theme.muted);
}

/// The phases side by side: each has room for its name, the rest is shared by how long they last.
fn phases(rect: Rect, view: &View<'_>, shown: &[GrindingPhase]) {
    let cycle = &view.snapshot.cycle;
    let lasts = |phase: GrindingPhase| expected(cycle, phase).max(cycle.times.phase(phase)) as f32;
    let name = |phase: GrindingPhase| {
        let name = phase.name().get(view.lang);
        (view.layout_line(name, theme::LABEL, view.theme.text, rect.width()).size().x + NAME_PAD).max(NAME_MIN)
    };
    let total = shown.iter().map(|phase| lasts(*phase)).sum::<f32>().max(f32::MIN_POSITIVE);
    let width = rect.width() - theme::GAP * (shown.len() - 1) as f32;
    let names: f32 = shown.iter().map(|phase| name(*phase)).sum();
    let (scale, spare) = ((width / names).min(1.0), (width - names).max(0.0));
    let mut rest = rect;
    for phase in shown {
        let (place, others) = rest.split_left(name(*phase) * scale + lasts(*phase) / total * spare);
        phase_ui(place, view, *phase);
        rest = others.trim_left(theme::GAP);
    }
}

fn expected(cycle: &CycleView, phase: GrindingPhase) -> f64 {
    cycle.before.map_or(0.0, |before| before.phase(phase))
}

/// One phase: its name, its time, and how far it is. The present one has a frame, a past one a tick.
fn phase_ui(place: Rect, view: &View<'_>, phase: GrindingPhase) {
    let (cycle, theme) = (&view.snapshot.cycle, view.theme);
    let (spent, is_now) = (cycle.times.phase(phase), cycle.phase == Some(phase));
    if is_now {
        let frame = Stroke::new(theme::FRAME, theme.run);
        view.painter.rect(place.expand(2.0), theme::RADIUS, theme.raised, frame, StrokeKind::Inside);
    }
    let (words, line) = place.trim_sides(theme::GAP).split_bottom(BAR + 2.0);
    let is_past = !is_now && spent > 0.0;
    let ink = if is_now { theme.text } else { theme.muted };
    let time = if spent > 0.0 { format!("{spent:.0}") } else { String::new() };
    let (name, second) = words.split_top(words.height() * 0.55);
    view.fit_left(name, phase.name().get(view.lang), theme::LABEL, ink);
    let at = if is_past {
        let mark = Rect::from_center_size(second.left_center() + vec2(7.0, 0.0), vec2(12.0, 12.0));
        pictogram::draw(&view.painter, mark, pictogram::CHECK, theme.run);
        second.trim_left(16.0)
    } else {
        second
    };
    if !time.is_empty() {
        view.fit_left(at, &format!("{time} s"), theme::SMALL, ink);
    }
    let ahead = expected(cycle, phase);
    match (is_past, is_now) {
        // Without a cycle before nobody knows how long it lasts.
        (false, true) if ahead <= 0.0 => progress(line.split_top(BAR).0, view, 1.0, 2.0),
        (true, false) => progress(line.split_top(BAR).0, view, 1.0, 1.0),
        _ => progress(line.split_top(BAR).0, view, spent, ahead),
    }
}

/// A bar filled by what is spent; full and in another colour beyond the whole.
fn progress(bar: Rect, view: &View<'_>, spent: f64, whole: f64) {
    let theme = view.theme;
    view.filled_card(bar, theme.background, theme.line);
    let part = if whole > 0.0 { (spent / whole).min(1.0) } else { 0.0 };
    if part > 0.0 {
        let done = bar.with_max_x(bar.min.x + bar.width() * part as f32);
        let is_late = spent > whole + 1.0;
        view.painter.rect_filled(done, theme::RADIUS, if is_late { theme.hold } else { theme.run });
    }
}
