//! The offset page: geometry and wear of the 16 tool offsets, typed as values, increments or measurements.
//! Source: spec B6, K4.1, K5.10, K7.7.

pub mod table;

use egui::{Align2, Rect, Ui, vec2};

use super::{PageContext, PageUi, input_line};
use crate::defs::param;
use crate::hmi::field_editor::FieldEditor;
use crate::hmi::view::{View, fit_text, text_line};
use crate::hmi::{page_frame as lines, theme, widget};
use crate::link::edit::OffsetPart;
use table::{EntryMode, OffsetTable, OffsetTableSpec};

/// Entry modes of this page.
const ENTRY_MODES: [EntryMode; 3] = [EntryMode::Absolute, EntryMode::Increment, EntryMode::Measured];

/// State of the page.
#[derive(Debug, Default)]
pub struct OffsetPage {
    /// The table and the value being typed.
    pub table: OffsetTable,
}

impl PageUi for OffsetPage {
    fn open(&mut self, view: &View<'_>, _handed_over: Option<u32>) {
        self.table.open(view.snapshot.active_offset);
    }

    fn typing(&self) -> Option<&FieldEditor> {
        Some(&self.table.typing)
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        let PageContext { ui, rect, view, typed, out, .. } = ctx;
        let locked = !view.snapshot.params.bit(param::EDIT_OFFSETS);
        let columns = table::columns(view, &[OffsetPart::Geometry, OffsetPart::Wear]);
        let form = OffsetTableSpec { id: "offset", columns: &columns, modes: &ENTRY_MODES, locked };
        out.extend(self.table.handle_typed(view, typed, &form));
        let (page, input) = input_line::split(rect);
        let inside = page.shrink(theme::PAD);
        let (top, list) = inside.split_top_bottom_at_y(inside.min.y + widget::TABS_HEIGHT);
        let (title, hows) = top.split_left_right_at_fraction(0.46);
        head(ui, title, view, locked);
        self.table.mode_keys(ui, hows, view, &form);
        let list = Rect::from_min_max(list.min + vec2(0.0, theme::GAP), list.max);
        self.table.ui(ui, list, view, typed, &form);
        self.table.input_line(ui, input, view, &form);
    }
}

/// Title, unit, and what is locked.
fn head(ui: &Ui, rect: Rect, view: &View<'_>, locked: bool) {
    let (top, below) = rect.split_top_bottom_at_y(rect.min.y + 26.0);
    lines::title(ui, view, top, view.text("刀补", "tool offsets"));
    let unit = if view.snapshot.x_as_diameter { view.text("mm · X 直径", "mm · X diameter") } else { "mm" };
    let unit_place = Rect::from_min_max(top.min, top.max - vec2(theme::PAD, 0.0));
    text_line(ui.painter(), unit_place, Align2::RIGHT_CENTER, unit, theme::LABEL, view.theme.muted);
    let words = if locked {
        view.text("P22.0=0：磨耗、增量、测量已锁", "P22.0 is 0: wear, increments, measuring locked")
    } else {
        view.text("键盘：U V W 增量，M 测量", "keyboard: U V W increment, M measure")
    };
    let ink = if locked { view.theme.hold } else { view.theme.muted };
    let below = Rect::from_min_max(below.min, below.max - vec2(theme::PAD, 0.0));
    fit_text(ui.painter(), below, Align2::LEFT_CENTER, words, theme::LABEL, ink);
}
