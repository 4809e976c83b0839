//! Position page: relative, all, machine. There is no 绝对 page (K7.1); the grinding page shows work coordinates.
//! Source: spec K7.1, K4.2 (setting a dressing point), H5.

use egui::accesskit::Role;
use egui::{Align2, Id, Rect, Sense, Ui, WidgetInfo, pos2, vec2};

use super::program::listing;
use super::{PageContext, PageUi};
use crate::defs::key::Key;
use crate::defs::soft_key::CoordinateView;
use crate::hmi::edit_key::EditKey;
use crate::hmi::keycap::{self, KeycapState};
use crate::hmi::view::{
    View, card, fit_text, format_cycle_time, format_length, format_strokes, format_whole, text_line,
};
use crate::hmi::{page_frame as lines, pictogram, theme};
use crate::link::Command;
use crate::link::snapshot::AxisView;
use crate::units::Axis;

/// The page has no state; also the page 面板, because the panel is always shown beside the page.
#[derive(Debug, Default)]
pub struct PositionPage;

impl PageUi for PositionPage {
    fn ui(&mut self, ctx: PageContext<'_>) {
        ctx.out.extend(panel_key_commands(ctx.typed.edits));
        coordinates(ctx.ui, ctx.rect, ctx.view, ctx.out);
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

fn coordinates(ui: &Ui, rect: Rect, view: &View<'_>, out: &mut Vec<Command>) {
    let shown = view.snapshot.coordinates;
    let inside = rect.shrink(theme::PAD);
    let side = if inside.width() > 900.0 { 250.0 } else { 190.0 };
    let (main, right) = inside.split_left_right_at_x(inside.max.x - side);
    let main = Rect::from_min_max(main.min, main.max - vec2(theme::PAD, 0.0));
    let (title, axes) = main.split_top_bottom_at_y(main.min.y + 34.0);
    lines::title(ui, view, title, shown.title().get(view.lang));
    let unit = if view.snapshot.x_as_diameter { view.text("mm · X 直径", "mm · X diameter") } else { "mm" };
    text_line(ui.painter(), title, Align2::RIGHT_CENTER, unit, theme::LABEL, view.theme.muted);
    let present: Vec<Axis> = Axis::ALL.into_iter().filter(|axis| view.snapshot.axes[*axis].present).collect();
    let keys = shown == CoordinateView::Relative;
    let room = axes.height() - if keys { 60.0 } else { 0.0 };
    let height = ((room - theme::GAP * 2.0) / present.len().max(2) as f32 - theme::GAP).clamp(90.0, 190.0);
    let used = present.len() as f32 * (height + theme::GAP);
    for (index, axis) in present.into_iter().enumerate() {
        let corner = axes.min + vec2(0.0, index as f32 * (height + theme::GAP));
        let card = Rect::from_min_size(corner, vec2(axes.width(), height));
        axis_card(ui, card, view, axis, shown, out);
    }
    let rest = Rect::from_min_size(axes.min + vec2(0.0, used), vec2(axes.width(), room - used));
    listing::running_lines(ui, rest, view);
    if keys {
        confirm_keys(ui, axes, view, out);
    }
    side_column(ui, right, view);
}

/// One axis: letter, homed mark, large value, and smaller values below. The decimal points are aligned.
fn axis_card(ui: &Ui, rect: Rect, view: &View<'_>, axis: Axis, shown: CoordinateView, out: &mut Vec<Command>) {
    let painter = ui.painter();
    let state = &view.snapshot.axes[axis];
    let edge = if state.moving { view.theme.info } else { view.theme.line };
    card(painter, rect, view.theme.surface, edge);
    let inside = rect.shrink2(vec2(theme::PAD, 8.0));
    let (top, bottom) = inside.split_top_bottom_at_y(inside.max.y - 30.0);
    let letter = Rect::from_min_size(top.min, vec2(56.0, top.height().min(64.0)));
    let letter = Rect::from_center_size(pos2(letter.center().x, top.center().y), letter.size());
    axis_letter(ui, letter, view, axis, shown, out);
    homed_mark(ui, view, letter, state);
    let (name, large, others) = figures(view, state, shown);
    let mut digits = Rect::from_min_max(pos2(letter.max.x + 40.0, top.min.y), top.max);
    let tag = Rect::from_min_size(pos2(digits.min.x, letter.center().y - 11.0), vec2(80.0, 22.0));
    text_line(painter, tag, Align2::LEFT_CENTER, name, theme::LABEL, view.theme.muted);
    digits.min.x += 40.0;
    if shown == CoordinateView::Relative {
        let (rest, key) = digits.split_left_right_at_x(digits.max.x - 76.0);
        digits = rest;
        clear_key(ui, Rect::from_center_size(key.center() + vec2(6.0, 0.0), vec2(64.0, 48.0)), view, axis, out);
        digits.max.x -= theme::PAD;
    }
    let size = if rect.height() > 120.0 { theme::DIGITS * 1.4 } else { theme::DIGITS };
    fit_text(painter, digits, Align2::RIGHT_CENTER, &format_length(large), size, view.theme.text);
    let width = bottom.width() / others.len() as f32;
    for (index, (name, value)) in others.iter().enumerate() {
        let place = Rect::from_min_size(
            bottom.min + vec2(index as f32 * width, 0.0),
            vec2(width - theme::PAD, bottom.height()),
        );
        let place = if index + 1 == others.len() { Rect::from_min_max(place.min, bottom.max) } else { place };
        text_line(painter, place, Align2::LEFT_CENTER, name, theme::LABEL, view.theme.muted);
        text_line(painter, place, Align2::RIGHT_CENTER, &format_length(*value), theme::SECONDARY, view.theme.text);
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
fn axis_letter(ui: &Ui, rect: Rect, view: &View<'_>, axis: Axis, shown: CoordinateView, out: &mut Vec<Command>) {
    let ink = if view.snapshot.axes[axis].moving { view.theme.info } else { view.theme.text };
    if shown == CoordinateView::Relative {
        let key = match axis {
            Axis::X => Key::AddressX,
            Axis::Y => Key::AddressY,
            Axis::Z => Key::AddressZ,
        };
        screen_key(ui, rect, view, key, out);
    }
    text_line(ui.painter(), rect, Align2::CENTER_CENTER, &axis.to_string(), theme::DIGITS, ink);
}

/// A screen key: one touch presses and releases it.
fn screen_key(ui: &Ui, rect: Rect, view: &View<'_>, key: Key, out: &mut Vec<Command>) {
    let response = ui.interact(rect, Id::unique(("screen-key", key as u8)), Sense::CLICK);
    let name = keycap::accessible_name(key, view.lang);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
    let pressed = response.is_pointer_button_down_on();
    keycap::paint_body(ui.painter(), view.theme, rect, KeycapState { pressed, ..KeycapState::default() });
    if response.clicked() {
        out.extend([Command::Press(key), Command::Release(key)]);
    }
}

/// Height to keep free below the position column.
const MIN_HEIGHT_BELOW: f32 = 84.0;

/// A group of the position column: its caption and the value of each axis.
pub type PositionGroup<'a> = (&'a str, &'a dyn Fn(Axis, &AxisView) -> Option<f64>);

/// Position column beside the fields of a page: groups of all axes, one below the other. A missing value reads
/// “not set”. Returns the rectangle below.
pub fn column(ui: &Ui, rect: Rect, view: &View<'_>, groups: &[PositionGroup<'_>]) -> Rect {
    let painter = ui.painter();
    card(painter, rect, view.theme.surface, view.theme.line);
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
    text_line(painter, row(28.0), Align2::LEFT_CENTER, view.text("位置", "POSITION"), theme::TITLE, view.theme.text);
    for (name, value) in groups {
        row(gap);
        fit_text(painter, row(24.0), Align2::LEFT_CENTER, name, theme::LABEL, view.theme.muted);
        for (axis, state) in view.snapshot.axes.iter().filter(|(_, state)| state.present) {
            let place = row(line);
            let ink = if state.moving { view.theme.info } else { view.theme.text };
            text_line(painter, place, Align2::LEFT_CENTER, &axis.to_string(), theme::SECONDARY, ink);
            let place = Rect::from_min_max(place.min + vec2(22.0, 0.0), place.max);
            let (words, size, ink) = match value(axis, state) {
                Some(value) => (format_length(value), theme::SECONDARY, view.theme.text),
                None => (view.text("未设置", "not set").to_owned(), theme::LABEL, view.theme.muted),
            };
            fit_text(painter, place, Align2::RIGHT_CENTER, &words, size, ink);
        }
    }
    Rect::from_min_max(row(0.0).min, inside.max)
}

/// 输入 and 取消: the answers to “是否设置 X 轴修整点”.
fn confirm_keys(ui: &Ui, axes: Rect, view: &View<'_>, out: &mut Vec<Command>) {
    let row = Rect::from_min_max(pos2(axes.min.x, axes.max.y - 50.0), axes.max);
    let words = view.text("按轴字母键设置修整点", "press an axis letter to set the dressing point");
    let text = Rect::from_min_max(row.min, pos2(row.max.x - 216.0, row.max.y));
    fit_text(ui.painter(), text, Align2::LEFT_CENTER, words, theme::LABEL, view.theme.muted);
    for (index, key) in [Key::Cancel, Key::Input].into_iter().enumerate() {
        let left = row.max.x - 206.0 + index as f32 * 106.0;
        let place = Rect::from_min_size(pos2(left, row.min.y), vec2(100.0, 50.0));
        screen_key(ui, place, view, key, out);
        fit_text(ui.painter(), place, Align2::CENTER_CENTER, key.label().get(view.lang), theme::TITLE, view.theme.text);
    }
}

fn clear_key(ui: &Ui, rect: Rect, view: &View<'_>, axis: Axis, out: &mut Vec<Command>) {
    let response = ui.interact(rect, Id::unique(("clear", axis as u8)), Sense::CLICK);
    let words = view.text("清零", "ZERO");
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("{words} {axis}")));
    let pressed = response.is_pointer_button_down_on();
    keycap::paint_body(ui.painter(), view.theme, rect, KeycapState { pressed, ..KeycapState::default() });
    fit_text(ui.painter(), rect, Align2::CENTER_CENTER, words, theme::LABEL, view.theme.text);
    if response.clicked() {
        out.push(Command::ClearRelative(axis));
    }
}

/// Homed mark: the axis was homed since power-on; before that its machine coordinate is not valid.
fn homed_mark(ui: &Ui, view: &View<'_>, letter: Rect, state: &AxisView) {
    let place = Rect::from_center_size(pos2(letter.max.x + 18.0, letter.center().y), vec2(20.0, 20.0));
    let ink = if state.homed { view.theme.run } else { view.theme.line };
    pictogram::draw(ui.painter(), place, pictogram::HOUSE, ink);
}

/// Program, feed, wheel speed, cycle time, part count.
fn side_column(ui: &Ui, rect: Rect, view: &View<'_>) {
    card(ui.painter(), rect, view.theme.surface, view.theme.line);
    let inside = rect.shrink2(vec2(theme::PAD, 10.0));
    let (top, rest) = inside.split_top_bottom_at_y(inside.min.y + 30.0);
    lines::paint_program_label(ui.painter(), view, top, theme::TITLE);
    process_values(ui, Rect::from_min_max(rest.min + vec2(0.0, 8.0), rest.max), view);
}

/// Process values, one below the other; as many as fit.
pub fn process_values(ui: &Ui, rect: Rect, view: &View<'_>) {
    let snapshot = view.snapshot;
    let (rapid, of) = match snapshot.rapid_override {
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
        (view.text("进给", "feed"), format_whole(snapshot.feed_mm_min), "mm/min"),
        (view.text("进给倍率", "feed ovr"), format!("{}", snapshot.feed_override), "%"),
        (view.text("快速倍率", "rapid ovr"), rapid, of),
        (face.spindle_name.get(view.lang), format_whole(snapshot.wheel_rpm), "r/min"),
        (view.text("循环时间", "cycle"), format_cycle_time(snapshot.cycle_seconds), ""),
        (view.text("件数", "parts"), snapshot.parts_counted.to_string(), ""),
        (face.last_process_item.get(view.lang), last, of_last),
    ];
    let narrow = rect.width() < 190.0;
    let height = if narrow { 46.0 } else { 34.0 };
    for (index, (name, value, unit)) in rows.into_iter().enumerate() {
        let place = Rect::from_min_size(rect.min + vec2(0.0, index as f32 * height), vec2(rect.width(), height));
        if place.max.y > rect.max.y + 0.5 {
            return;
        }
        if narrow {
            let (label, figure) = place.split_top_bottom_at_fraction(0.46);
            text_line(ui.painter(), label, Align2::LEFT_CENTER, name, theme::LABEL, view.theme.muted);
            text_line(ui.painter(), label, Align2::RIGHT_CENTER, unit, theme::SMALL, view.theme.muted);
            text_line(ui.painter(), figure, Align2::RIGHT_CENTER, &value, theme::SECONDARY, view.theme.text);
        } else {
            let (figure, tail) = place.split_left_right_at_x(place.max.x - 62.0);
            text_line(ui.painter(), figure, Align2::LEFT_CENTER, name, theme::LABEL, view.theme.muted);
            text_line(ui.painter(), figure, Align2::RIGHT_CENTER, &value, theme::SECONDARY, view.theme.text);
            let tail = Rect::from_min_max(pos2(tail.min.x + 8.0, tail.min.y), tail.max);
            text_line(ui.painter(), tail, Align2::LEFT_CENTER, unit, theme::SMALL, view.theme.muted);
        }
    }
}
