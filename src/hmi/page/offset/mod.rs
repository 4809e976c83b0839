//! The offset page: geometry, wear and circle of the 16 tool offsets, and the work offsets; typed as values, increments
//! or measurements. A work offset is also taught: the place where the axis stands becomes its zero.
//! Source: spec B2, B6, K4.1, K5.10, K7.7.

pub mod table;

use egui::Rect;

use super::{HandOver, PageContext, PageUi, input_line};
use crate::defs::equipment::Equipment;
use crate::defs::param;
use crate::defs::text::Text;
use crate::hmi::widget::{PageKey, page_keys};
use crate::hmi::{Area, FieldEditor, View, theme, widget};
use crate::link::Command;
use crate::link::edit::{ORIGIN_COUNT, OffsetCommand, OffsetPart, OriginChange, origin_name};
use table::{EntryMode, OffsetColumn, OffsetTable, OffsetTableSpec, TOOL_OFFSET_ROWS};

/// Entry modes of this page.
const ENTRY_MODES: [EntryMode; 3] = [EntryMode::Absolute, EntryMode::Increment, EntryMode::Measured];

page_keys! {
    /// The table that is shown.
    #[derive(Default)]
    OffsetTab {
        /// Tool offsets.
        #[default]
        Tools = "tool-offsets", "刀补", "TOOL OFFSETS";
        /// Work offsets.
        Work = "work-offsets", "坐标系", "WORK OFFSETS";
    }
}

const TABS: [OffsetTab; 2] = [OffsetTab::Tools, OffsetTab::Work];

/// State of the page.
#[derive(Debug, Default)]
pub struct OffsetPage {
    /// The table and the value being typed.
    pub table: OffsetTable,
    shows: OffsetTab,
}

impl OffsetPage {
    fn line_in_force(&self, view: &View<'_>) -> Option<usize> {
        match self.shows {
            OffsetTab::Tools => view.snapshot.offsets.active_tool.checked_sub(1),
            OffsetTab::Work => view.snapshot.offsets.active_origin,
        }
    }

    fn columns(&self, view: &View<'_>) -> Vec<OffsetColumn> {
        if self.shows == OffsetTab::Work {
            return view.axes().map(OffsetColumn::Origin).collect();
        }
        let mut columns = table::columns(view, &[OffsetPart::Geometry, OffsetPart::Wear]);
        // The tools of a lathe have no radius (L8).
        if view.snapshot.params.fitted().has(Equipment::Wheel) {
            columns.extend([OffsetColumn::Radius, OffsetColumn::Tip]);
        }
        columns
    }
}

impl PageUi for OffsetPage {
    fn open(&mut self, view: &View<'_>, _handed_over: Option<HandOver>) {
        self.table.open(self.line_in_force(view).unwrap_or(0));
    }

    fn typing(&self) -> Option<&FieldEditor> {
        Some(&self.table.typing)
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        let PageContext { rect, view, typed, out, .. } = ctx;
        let locked = !view.snapshot.params.bit(param::EDIT_OFFSETS);
        let (page, input) = input_line::split(rect);
        let (top, list) = page.shrink(theme::PAD).split_top(widget::KEYS_HEIGHT);
        let (tables, hows) = top.split_left_right_at_fraction(0.4);
        if self.choose_table(tables, view) {
            self.table.open(self.line_in_force(view).unwrap_or(0));
        }
        let columns = self.columns(view);
        let (id, rows) = match self.shows {
            OffsetTab::Tools => ("offset", TOOL_OFFSET_ROWS),
            OffsetTab::Work => ("work-offset", (ORIGIN_COUNT, origin_name as fn(usize) -> String)),
        };
        let in_force = self.line_in_force(view);
        let form = OffsetTableSpec { id, columns: &columns, rows, in_force, modes: &ENTRY_MODES, locked };
        out.extend(self.table.handle_typed(view, typed, &form));
        self.table.mode_keys(hows, view, &form);
        let (line, list) = list.split_top(HEAD_HEIGHT);
        out.extend(self.head(line, view, &form));
        self.table.ui(list.trim_top(theme::GAP), view, typed, &form);
        self.table.input_line(input, view, &form);
    }
}

/// Height of the line under the keys.
const HEAD_HEIGHT: f32 = 44.0;
/// Width of the unit.
const UNIT_WIDTH: f32 = 60.0;
/// Width of the key that teaches a work offset.
const TEACH_WIDTH: f32 = 190.0;

impl OffsetPage {
    /// The keys of the tables; true if another one was chosen.
    fn choose_table(&mut self, rect: Rect, view: &View<'_>) -> bool {
        let keys: Vec<_> = TABS.iter().map(|of| (of.id(), of.label().get(view.lang).to_owned())).collect();
        let chosen = TABS.iter().position(|of| *of == self.shows).unwrap_or(0);
        match widget::tabs(view, rect.trim_right(2.0 * theme::PAD), &keys, chosen) {
            Some(index) if index != chosen => {
                self.shows = TABS[index];
                true
            }
            Some(_) | None => false,
        }
    }

    /// What is locked, the unit, and the key that teaches a work offset.
    fn head(&self, rect: Rect, view: &View<'_>, form: &OffsetTableSpec<'_>) -> Option<Command> {
        let words = match (form.locked, self.shows) {
            (true, OffsetTab::Tools) => {
                view.text("P22.0=0：磨耗、增量、测量已锁", "P22.0=0: wear, increments, measuring locked")
            }
            (true, OffsetTab::Work) => view.text("P22.0=0：增量、测量已锁", "P22.0=0: increments, measuring locked"),
            (false, _) => view.text("键盘：U V W 增量，M 测量", "keyboard: U V W increment, M measure"),
        };
        let ink = if form.locked { view.theme.hold } else { view.theme.muted };
        let (line, key) = match self.shows {
            OffsetTab::Tools => (rect, None),
            OffsetTab::Work => {
                let (line, key) = rect.split_right(TEACH_WIDTH);
                (line, Some(key))
            }
        };
        view.fit_left(line.trim_right(UNIT_WIDTH), words, theme::LABEL, ink);
        view.line_right(line.trim_right(theme::PAD), view.position_unit(), theme::LABEL, view.theme.muted);
        let (row, axis) = self.table.selected_origin(form)?;
        let label = format!("{} {axis}=0", view.text("此处为零", "ZERO HERE"));
        let pressed =
            widget::button(view, key?.trim_top(theme::GAP), PageKey::new("teach-origin", &label).locked(form.locked));
        pressed.then_some(Command::Offset(OffsetCommand::Origin { row, axis, change: OriginChange::Measure(0.0) }))
    }
}
