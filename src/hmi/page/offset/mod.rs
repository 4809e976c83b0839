//! The offset page: geometry and wear of the 16 tool offsets, typed as values, increments or measurements.
//! Source: spec B6, K4.1, K5.10, K7.7.

pub mod table;

use egui::{Align2, Rect, Ui, vec2};

use super::Typed;
use super::input_line;
use crate::defs::param;
use crate::hmi::view::{View, fit, put};
use crate::hmi::{frame as lines, theme, widget};
use crate::link::Command;
use crate::link::edit::Part;
use table::{Form, How, Table};

/// Entry modes of this page.
const HOWS: [How; 3] = [How::Absolute, How::Increment, How::Measured];

/// State of the page.
#[derive(Debug, Default)]
pub struct Offset {
    /// The table and the value being typed.
    pub table: Table,
}

impl Offset {
    /// Draws the page.
    pub fn ui(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, typed: &Typed<'_>) -> Vec<Command> {
        let locked = !view.snapshot.params.bit(param::EDIT_OFFSETS);
        let columns = table::columns(view, &[Part::Geometry, Part::Wear]);
        let form = Form { id: "offset", columns: &columns, hows: &HOWS, locked };
        let out = self.table.take(view, typed, &form);
        let (page, input) = input_line::split(rect);
        let inside = page.shrink(theme::PAD);
        let (top, list) = inside.split_top_bottom_at_y(inside.min.y + widget::TABS);
        let (title, hows) = top.split_left_right_at_fraction(0.46);
        self.head(ui, title, view, locked);
        self.table.hows(ui, hows, view, &form);
        let list = Rect::from_min_max(list.min + vec2(0.0, theme::GAP), list.max);
        self.table.ui(ui, list, view, typed, &form);
        self.table.input_line(ui, input, view, &form);
        out
    }

    fn head(&self, ui: &Ui, rect: Rect, view: &View<'_>, locked: bool) {
        let (top, below) = rect.split_top_bottom_at_y(rect.min.y + 26.0);
        lines::title(ui, view, top, view.say("刀补", "tool offsets"));
        let unit = if view.snapshot.diameter { view.say("mm · X 直径", "mm · X diameter") } else { "mm" };
        let unit_place = Rect::from_min_max(top.min, top.max - vec2(theme::PAD, 0.0));
        put(ui.painter(), unit_place, Align2::RIGHT_CENTER, unit, theme::LABEL, view.theme.quiet);
        let words = if locked {
            view.say("P22.0=0：磨耗、增量、测量已锁", "P22.0 is 0: wear, increments, measuring locked")
        } else {
            view.say("键盘：U V W 增量，M 测量", "keyboard: U V W increment, M measure")
        };
        let ink = if locked { view.theme.hold } else { view.theme.quiet };
        let below = Rect::from_min_max(below.min, below.max - vec2(theme::PAD, 0.0));
        fit(ui.painter(), below, Align2::LEFT_CENTER, words, theme::LABEL, ink);
    }
}
