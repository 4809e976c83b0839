//! Position page: relative, all, machine. There is no 绝对 page (K7.1); the grinding page shows work coordinates.
//! Source: spec K7.1, K4.2 (setting a dressing point), H5.

use egui::{Rect, pos2, vec2};

use super::program::listing;
use super::start_strip::{self, StartStrip};
use super::{PageContext, PageUi};
use crate::defs::key::Key;
use crate::defs::soft_key::CoordinateView;
use crate::hmi::{
    Area, EditKey, View, format_cycle_time, format_feed, format_strokes, format_whole, keycap, page_frame as lines,
    pictogram, scene, theme,
};
use crate::link::Command;
use crate::link::snapshot::AxisView;
use crate::units::Axis;

/// The state of the page; also of the page 面板, because the panel is always shown beside the page.
#[derive(Debug, Default)]
pub struct PositionPage {
    start: StartStrip,
}

impl PageUi for PositionPage {
    fn ui(&mut self, mut ctx: PageContext<'_>) {
        ctx.out.extend(panel_key_commands(&ctx.typed.edits));
        let (rect, strip) = ctx.rect.split_bottom(start_strip::HEIGHT + theme::GAP);
        coordinates(rect, ctx.view, ctx.out);
        self.start.ui(strip.trim_sides(theme::PAD).trim_bottom(theme::GAP), &mut ctx);
    }
}

/// Enter and Esc act as the panel keys 输入 and 取消, because the page has no fields.
fn panel_key_commands(edits: &[EditKey]) -> Vec<Command> {
    let key = |edit: &EditKey| match edit {
        EditKey::Enter => Some(Key::Input),
        EditKey::Cancel => Some(Key::Cancel),
        _ => None,
    };
    edits.iter().filter_map(key).flat_map(|key| [Command::Press(key), Command::Release(key)]).collect()
}

fn coordinates(rect: Rect, view: &View<'_>, out: &mut Vec<Command>) {
    let shown = view.snapshot.coordinates;
    let inside = rect.shrink(theme::PAD);
    let (main, right) = inside.split_right(if inside.width() > 900.0 { 250.0 } else { 190.0 });
    let (title, axes) = main.trim_right(theme::PAD).split_top(34.0);
    lines::title(view, title, shown.title().get(view.lang));
    view.line_right(title, view.position_unit(), theme::LABEL, view.theme.muted);
    let present: Vec<Axis> = view.axes().collect();
    let keys = shown == CoordinateView::Relative;
    let room = axes.height() - if keys { 60.0 } else { 0.0 };
    let height = ((room - theme::GAP * 2.0) / present.len().max(2) as f32 - theme::GAP).clamp(90.0, 160.0);
    let used = present.len() as f32 * (height + theme::GAP);
    for (index, axis) in present.into_iter().enumerate() {
        axis_card(axes.band(index as f32 * (height + theme::GAP), height), view, axis, shown, out);
    }
    listing::running_lines(axes.band(used, room - used), view);
    if keys {
        confirm_keys(axes, view, out);
    }
    // Program, feed, wheel speed, cycle time, part count.
    view.card(right);
    let inside = right.shrink2(vec2(theme::PAD, 10.0));
    lines::paint_program_label(view, inside.band(0.0, 30.0), theme::TITLE);
    let below = process_values(inside.trim_top(38.0), view);
    let live = inside.with_min_y(below.min.y + theme::GAP);
    if live.height() >= scene::LEAST_HEIGHT {
        scene::paint_with_contact(live, view, MAGNIFIER_HEIGHT);
    }
}

/// Height of the magnifier below the scene.
const MAGNIFIER_HEIGHT: f32 = 122.0;

/// One axis: letter, homed mark, large value, and smaller values below. The decimal points are aligned.
fn axis_card(rect: Rect, view: &View<'_>, axis: Axis, shown: CoordinateView, out: &mut Vec<Command>) {
    let state = &view.snapshot.axes[axis];
    view.filled_card(rect, view.theme.surface, if state.moving { view.theme.info } else { view.theme.line });
    let (top, bottom) = rect.shrink2(vec2(theme::PAD, 8.0)).split_bottom(30.0);
    let letter = Rect::from_min_size(top.min, vec2(56.0, top.height().min(64.0)));
    let letter = Rect::from_center_size(pos2(letter.center().x, top.center().y), letter.size());
    axis_letter(letter, view, axis, shown, out);
    // Homed mark: the axis was homed since power-on; before that its machine coordinate is not valid.
    let mark = Rect::from_center_size(pos2(letter.max.x + 18.0, letter.center().y), vec2(20.0, 20.0));
    let ink = if state.homed { view.theme.run } else { view.theme.line };
    pictogram::draw(&view.painter, mark, pictogram::HOUSE, ink);
    let (name, large, others) = figures(view, state, shown);
    let mut digits = top.with_min_x(letter.max.x + 40.0);
    let tag = Rect::from_min_size(pos2(digits.min.x, letter.center().y - 11.0), vec2(80.0, 22.0));
    view.line_left(tag, name, theme::LABEL, view.theme.muted);
    digits.min.x += 40.0;
    if shown == CoordinateView::Relative {
        let (rest, key) = digits.split_right(76.0);
        digits = rest;
        clear_key(Rect::from_center_size(key.center() + vec2(6.0, 0.0), vec2(64.0, 48.0)), view, axis, out);
        digits.max.x -= theme::PAD;
    }
    let size = if rect.height() > 120.0 { theme::DIGITS * 1.4 } else { theme::DIGITS };
    view.fit_right(digits, &view.length(large), size, view.theme.text);
    let width = bottom.width() / others.len() as f32;
    for (index, (name, value)) in others.iter().enumerate() {
        let gap = if index + 1 == others.len() { 0.0 } else { theme::PAD };
        let place = bottom.trim_left(index as f32 * width).split_left(width - gap).0;
        view.line_left(place, name, theme::LABEL, view.theme.muted);
        view.line_right(place, &view.length(*value), theme::SECONDARY, view.theme.text);
    }
}

/// The large value and the smaller ones.
fn figures<'a>(view: &View<'a>, axis: &AxisView, shown: CoordinateView) -> (&'a str, f64, Vec<(&'a str, f64)>) {
    let relative = (view.text("相对", "REL"), axis.relative);
    let machine = (view.text("机床", "MACHINE"), axis.machine);
    let to_go = (view.text("余量", "TO GO"), axis.to_go);
    match shown {
        CoordinateView::Relative => (relative.0, axis.relative, vec![machine, to_go]),
        CoordinateView::All => (view.text("绝对", "ABS"), axis.work, vec![relative, machine, to_go]),
        CoordinateView::Machine => (machine.0, axis.machine, vec![relative, to_go]),
    }
}

/// On the relative page the letter is the address key (K4.2).
fn axis_letter(rect: Rect, view: &View<'_>, axis: Axis, shown: CoordinateView, out: &mut Vec<Command>) {
    let ink = if view.snapshot.axes[axis].moving { view.theme.info } else { view.theme.text };
    if shown == CoordinateView::Relative {
        let key = match axis {
            Axis::X => Key::AddressX,
            Axis::Y => Key::AddressY,
            Axis::Z => Key::AddressZ,
        };
        screen_key(rect, view, key, out);
    }
    view.line_centre(rect, &axis.to_string(), theme::DIGITS, ink);
}

/// A screen key: one touch presses and releases it.
fn screen_key(rect: Rect, view: &View<'_>, key: Key, out: &mut Vec<Command>) {
    let name = keycap::accessible_name(key, view.lang);
    if keycap::plain(view, rect, ("screen-key", key as u8), &name).clicked() {
        out.extend([Command::Press(key), Command::Release(key)]);
    }
}

/// Height to keep free below the position column.
const MIN_HEIGHT_BELOW: f32 = 84.0;

/// A group of the position column: its caption and the value of each axis.
pub type PositionGroup<'a> = (&'a str, &'a dyn Fn(Axis, &AxisView) -> Option<f64>);

/// Position column beside the fields of a page: groups of all axes, one below the other. A missing value reads
/// “not set”. Returns the rectangle below.
pub fn column(rect: Rect, view: &View<'_>, groups: &[PositionGroup<'_>]) -> Rect {
    view.card(rect);
    let inside = rect.shrink2(vec2(10.0, 8.0));
    let axes = view.snapshot.axes.iter().filter(|(_, state)| state.present).count();
    let height = |gap: f32, line: f32| 28.0 + groups.len() as f32 * (gap + 24.0 + axes as f32 * line);
    // Smaller spacing if three axes would leave too little height below.
    let (gap, line) = if height(8.0, 32.0) + MIN_HEIGHT_BELOW > inside.height() { (4.0, 28.0) } else { (8.0, 32.0) };
    let mut at = inside.min.y;
    let mut row = |height: f32| {
        let place = Rect::from_min_size(pos2(inside.min.x, at), vec2(inside.width(), height));
        at += height;
        place
    };
    view.line_left(row(28.0), view.text("位置", "POSITION"), theme::TITLE, view.theme.text);
    for (name, value) in groups {
        row(gap);
        view.fit_left(row(24.0), name, theme::LABEL, view.theme.muted);
        for (axis, state) in view.snapshot.axes.iter().filter(|(_, state)| state.present) {
            let place = row(line);
            let ink = if state.moving { view.theme.info } else { view.theme.text };
            view.line_left(place, &axis.to_string(), theme::SECONDARY, ink);
            let (words, size, ink) = match value(axis, state) {
                Some(value) => (view.length(value), theme::SECONDARY, view.theme.text),
                None => (view.text("未设置", "not set").to_owned(), theme::LABEL, view.theme.muted),
            };
            view.fit_right(place.trim_left(22.0), &words, size, ink);
        }
    }
    Rect::from_min_max(row(0.0).min, inside.max)
}

/// 输入 and 取消: the answers to “是否设置 X 轴修整点”.
fn confirm_keys(axes: Rect, view: &View<'_>, out: &mut Vec<Command>) {
    let (_, row) = axes.split_bottom(50.0);
    let words = view.text("设置修整点：按轴字母键，再按输入", "dressing point: an axis letter, then INPUT");
    view.fit_left(row.trim_right(216.0), words, theme::LABEL, view.theme.muted);
    for (index, key) in [Key::Cancel, Key::Input].into_iter().enumerate() {
        let place = row.split_right(206.0).1.cell(index, 2);
        screen_key(place, view, key, out);
        view.fit_centre(place, key.label().get(view.lang), theme::TITLE, view.theme.text);
    }
}

fn clear_key(rect: Rect, view: &View<'_>, axis: Axis, out: &mut Vec<Command>) {
    let words = view.text("清零", "ZERO");
    let response = keycap::plain(view, rect, ("clear", axis as u8), format!("{words} {axis}"));
    view.fit_centre(rect, words, theme::LABEL, view.theme.text);
    if response.clicked() {
        out.push(Command::ClearRelative(axis));
    }
}

/// Process values, one below the other; as many as fit. Returns what is free below them.
pub fn process_values(rect: Rect, view: &View<'_>) -> Rect {
    let snapshot = view.snapshot;
    let (rapid, of) = match snapshot.overrides.rapid {
        0 => ("F0".to_owned(), ""),
        percent => (percent.to_string(), "%"),
    };
    let face = snapshot.kind.ui();
    let (last, of_last) = match snapshot.tool_station {
        Some(0) => ("–".to_owned(), ""),
        Some(station) => (format!("T{station}"), ""),
        None => (format_strokes(snapshot.strokes_per_min), "1/min"),
    };
    let rows = [
        (view.text("进给", "feed"), format_feed(snapshot.feed_mm_min), "mm/min"),
        (view.text("进给倍率", "feed ovr"), format!("{}", snapshot.overrides.feed), "%"),
        (view.text("快速倍率", "rapid ovr"), rapid, of),
        (face.spindle_name.get(view.lang), format_whole(snapshot.wheel_rpm), "r/min"),
        (view.text("循环时间", "cycle"), format_cycle_time(snapshot.cycle.times.seconds), ""),
        (view.text("件数", "parts"), snapshot.parts_counted.to_string(), ""),
        (face.last_process_item.get(view.lang), last, of_last),
    ];
    // Name, value and unit in one line; the value below the name where there is no room for both.
    let (stacked, narrow) = (rect.width() < 148.0, rect.width() < 190.0);
    let height = if stacked {
        46.0
    } else if narrow {
        30.0
    } else {
        34.0
    };
    let below = rect.with_min_y((rect.min.y + rows.len() as f32 * height).min(rect.max.y));
    for (index, (name, value, unit)) in rows.into_iter().enumerate() {
        let place = Rect::from_min_size(rect.min + vec2(0.0, index as f32 * height), vec2(rect.width(), height));
        if place.max.y > rect.max.y + 0.5 {
            return below;
        }
        if stacked {
            let (label, figure) = place.split_top_bottom_at_fraction(0.46);
            view.line_left(label, name, theme::LABEL, view.theme.muted);
            view.line_right(label, unit, theme::SMALL, view.theme.muted);
            view.line_right(figure, &value, theme::SECONDARY, view.theme.text);
        } else if narrow {
            let (label, figure) = place.split_left_right_at_fraction(0.36);
            // Numbers stand in one column; a long one without a unit takes the room of the unit.
            let (beside, tail) = figure.split_right(56.0);
            let beside = beside.trim_left(if unit.is_empty() { theme::GAP } else { 0.0 });
            let is_long = || view.layout_line(&value, theme::SMALL, view.theme.text, beside.width()).elided;
            let figure = if unit.is_empty() && is_long() { figure } else { beside };
            view.fit_left(label, name, theme::LABEL, view.theme.muted);
            view.fit_right(figure, &value, theme::TITLE, view.theme.text);
            view.line_left(tail.trim_left(4.0), unit, theme::SMALL, view.theme.muted);
        } else {
            let (figure, tail) = place.split_right(62.0);
            view.line_left(figure, name, theme::LABEL, view.theme.muted);
            view.line_right(figure, &value, theme::SECONDARY, view.theme.text);
            view.line_left(tail.with_min_x(tail.min.x + 8.0), unit, theme::SMALL, view.theme.muted);
        }
    }
    below
}
