//! The offset page: geometry and wear of the 16 tool offsets, typed as values, increments or measurements.
//! Source: spec B6, K4.1, K5.10, K7.7.

pub mod table;

use egui::Rect;

use super::{PageContext, PageUi, input_line};
use crate::defs::equipment::Equipment;
use crate::defs::param;
use crate::hmi::{Area, FieldEditor, View, page_frame as lines, theme, widget};
use crate::link::edit::OffsetPart;
use table::{EntryMode, OffsetColumn, OffsetTable, OffsetTableSpec};

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
        let PageContext { rect, view, typed, out, .. } = ctx;
        let locked = !view.snapshot.params.bit(param::EDIT_OFFSETS);
        let mut columns = table::columns(view, &[OffsetPart::Geometry, OffsetPart::Wear]);
        // The tools of a lathe have no radius (L8).
        if view.snapshot.params.fitted().has(Equipment::Wheel) {
            columns.extend([OffsetColumn::Radius, OffsetColumn::Tip]);
        }
        let form = OffsetTableSpec { id: "offset", columns: &columns, modes: &ENTRY_MODES, locked };
        out.extend(self.table.handle_typed(view, typed, &form));
        let (page, input) = input_line::split(rect);
        let (top, list) = page.shrink(theme::PAD).split_top(widget::KEYS_HEIGHT);
        let (title, hows) = top.split_left_right_at_fraction(0.46);
        head(title, view, locked);
        self.table.mode_keys(hows, view, &form);
        self.table.ui(list.trim_top(theme::GAP), view, typed, &form);
        self.table.input_line(input, view, &form);
    }
}

/// Title, unit, and what is locked.
fn head(rect: Rect, view: &View<'_>, locked: bool) {
    let (top, below) = rect.split_top(26.0);
    lines::title(view, top, view.text("刀补", "tool offsets"));
    view.line_right(top.trim_right(theme::PAD), view.position_unit(), theme::LABEL, view.theme.muted);
    let words = if locked {
        view.text("P22.0=0：磨耗、增量、测量已锁", "P22.0=0: wear, increments, measuring locked")
    } else {
        view.text("键盘：U V W 增量，M 测量", "keyboard: U V W increment, M measure")
    };
    let ink = if locked { view.theme.hold } else { view.theme.muted };
    view.fit_left(below.trim_right(theme::PAD), words, theme::LABEL, ink);
}
