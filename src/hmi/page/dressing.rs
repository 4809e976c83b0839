//! The dressing page: positions and dressing point, the wear of the offsets, the picture B0100.BMP.
//! It is made for editing and does not ask for P22.0.
//! Source: spec K7.6, K7.7 (D), K4.2.

use egui::{Align2, Rect, TextureId, Ui, pos2, vec2};

use super::offset::table::{Form, How, Table, columns};
use super::{Typed, empty, input_line};
use crate::defs::param;
use crate::hmi::view::{View, card, fit, length, paragraph, put};
use crate::hmi::{frame as lines, pictogram, theme, widget};
use crate::link::Command;
use crate::link::edit::Part;

/// What the page takes.
const HOWS: [How; 2] = [How::Absolute, How::Increment];

/// What the page keeps.
#[derive(Debug, Default)]
pub struct Dressing {
    /// The wear table.
    pub table: Table,
}

impl Dressing {
    /// Draws the page.
    pub fn ui(
        &mut self,
        ui: &Ui,
        rect: Rect,
        view: &View<'_>,
        typed: &Typed<'_>,
        picture: Option<TextureId>,
    ) -> Vec<Command> {
        let columns = columns(view, &[Part::Wear]);
        let form = Form { id: "dressing", columns: &columns, hows: &HOWS, locked: false };
        let out = self.table.take(view, typed, &form);
        let (page, input) = input_line::split(rect);
        let main = page.shrink(theme::GAP);
        let left_width = if main.width() > 900.0 { 210.0 } else { 172.0 };
        let (left, rest) = main.split_left_right_at_x(main.min.x + left_width);
        let (middle, right) = rest.split_left_right_at_x(rest.max.x - theme::PICTURE.x - 2.0);
        let middle = Rect::from_min_max(middle.min + vec2(theme::GAP, 0.0), middle.max - vec2(theme::GAP, 0.0));
        positions(ui, left, view);
        show_picture(ui, right, view, picture);
        let (title, rest) = middle.split_top_bottom_at_y(middle.min.y + 30.0);
        lines::title(ui, view, title, view.say("砂轮磨耗", "wheel wear"));
        let unit = if view.snapshot.diameter { view.say("mm · X 直径", "mm · X diameter") } else { "mm" };
        put(ui.painter(), title, Align2::RIGHT_CENTER, unit, theme::LABEL, view.theme.quiet);
        let (hows, list) = rest.split_top_bottom_at_y(rest.min.y + widget::TABS);
        self.table.hows(ui, hows, view, &form);
        let list = Rect::from_min_max(list.min + vec2(0.0, 4.0), list.max);
        self.table.ui(ui, list, view, typed, &form);
        self.table.input_line(ui, input, view, &form);
        out
    }
}

/// Left: where the axes are, and where the dressing point is, both in machine coordinates.
fn positions(ui: &Ui, rect: Rect, view: &View<'_>) {
    let painter = ui.painter();
    card(painter, rect, view.theme.surface, view.theme.line);
    let inside = rect.shrink2(vec2(10.0, 8.0));
    let mut at = inside.min.y;
    let mut row = |height: f32| {
        let place = Rect::from_min_size(pos2(inside.min.x, at), vec2(inside.width(), height));
        at += height;
        place
    };
    put(painter, row(28.0), Align2::LEFT_CENTER, view.say("位置", "POSITION"), theme::TITLE, view.theme.text);
    let present = || view.snapshot.axes.iter().filter(|(_, state)| state.present);
    for (name, which) in [
        (view.say("[绝对坐标]", "[absolute]"), 0),
        (view.say("[机床坐标]", "[machine]"), 1),
        (view.say("[修整点 机床坐标]", "[dressing point]"), 2),
    ] {
        row(6.0);
        fit(painter, row(24.0), Align2::LEFT_CENTER, name, theme::LABEL, view.theme.quiet);
        for (axis, state) in present() {
            let place = row(30.0);
            let ink = if state.moving { view.theme.info } else { view.theme.text };
            put(painter, place, Align2::LEFT_CENTER, &axis.to_string(), theme::SECONDARY, ink);
            let words = match which {
                0 => length(state.work),
                1 => length(state.machine),
                _ => {
                    view.snapshot.dressing_point[axis].map_or_else(|| view.say("未设置", "not set").to_owned(), length)
                }
            };
            let none = which == 2 && view.snapshot.dressing_point[axis].is_none();
            let (size, ink) = if none { (theme::LABEL, view.theme.quiet) } else { (theme::SECONDARY, view.theme.text) };
            let place = Rect::from_min_max(place.min + vec2(22.0, 0.0), place.max);
            fit(painter, place, Align2::RIGHT_CENTER, &words, size, ink);
        }
    }
    row(8.0);
    let rest = Rect::from_min_max(row(0.0).min, inside.max);
    if view.snapshot.params.bit(param::WHEEL_UNDRESSED) {
        let params = &view.snapshot.params;
        let programs =
            format!("O{:04.0}–O{:04.0}", params.get(param::DRESSING_FIRST), params.get(param::DRESSING_LAST));
        let words = format!("{}{programs}", view.say("换砂轮后未修整：先运行 ", "wheel changed: dress it with "));
        paragraph(painter, rest, &words, theme::LABEL, view.theme.hold);
    } else {
        let words =
            view.say("修整点在 位置 → 相对 中按轴字母键设置", "set the point at POSITION, RELATIVE by an axis letter");
        paragraph(painter, rest, words, theme::LABEL, view.theme.quiet);
    }
}

fn show_picture(ui: &Ui, rect: Rect, view: &View<'_>, texture: Option<TextureId>) {
    let painter = ui.painter();
    let place = Rect::from_min_size(rect.min, theme::PICTURE + vec2(2.0, 2.0));
    card(painter, place, view.theme.surface, view.theme.line);
    if let Some(texture) = texture {
        let full = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        painter.image(texture, place.shrink(1.0), full, theme::UNTINTED);
        return;
    }
    let words = match &view.snapshot.screens.dressing {
        Some(Err(fault)) => fault.said().get(view.lang).to_owned(),
        Some(Ok(_)) | None => format!("B0100.BMP：{}", view.say("应为 200×400、24 位", "200×400, 24 bit")),
    };
    empty::show(ui, view, place.shrink(4.0), pictogram::NO_PICTURE, view.say("没有图片", "no picture"), &words);
}
