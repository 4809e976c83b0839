//! Dressing page: positions, dressing point, wear offsets, and the picture B0100.BMP.
//! Editing on this page does not need P22.0.
//! Source: spec K7.6, K7.7 (D), K4.2.

use std::sync::Arc;

use egui::{Align2, Rect, Ui, vec2};

use super::offset::table::{EntryMode, OffsetTable, OffsetTableSpec, columns};
use super::position::{self, PositionGroup};
use super::{PageContext, PageUi, empty, input_line};
use crate::defs::param;
use crate::hmi::field_editor::FieldEditor;
use crate::hmi::view::{View, paragraph, text_line};
use crate::hmi::{page_frame as lines, theme, widget};
use crate::link::Snapshot;
use crate::link::command::Picture;
use crate::link::edit::OffsetPart;

/// Entry modes of this page.
const ENTRY_MODES: [EntryMode; 2] = [EntryMode::Absolute, EntryMode::Increment];

/// State of the page.
#[derive(Debug, Default)]
pub struct DressingPage {
    /// The wear table.
    pub table: OffsetTable,
}

impl PageUi for DressingPage {
    fn open(&mut self, view: &View<'_>, _handed_over: Option<u32>) {
        self.table.open(view.snapshot.active_offset);
    }

    fn typing(&self) -> Option<&FieldEditor> {
        Some(&self.table.typing)
    }

    fn picture<'a>(&self, snapshot: &'a Snapshot) -> Option<&'a Arc<Picture>> {
        snapshot.screens.dressing.as_ref()?.as_ref().ok()
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        let PageContext { ui, rect, view, typed, picture, out, .. } = ctx;
        let columns = columns(view, &[OffsetPart::Wear]);
        let form = OffsetTableSpec { id: "dressing", columns: &columns, modes: &ENTRY_MODES, locked: false };
        out.extend(self.table.handle_typed(view, typed, &form));
        let (page, input) = input_line::split(rect);
        let main = page.shrink(theme::GAP);
        let left_width = if main.width() > 900.0 { 210.0 } else { 172.0 };
        let (left, rest) = main.split_left_right_at_x(main.min.x + left_width);
        let (middle, right) = rest.split_left_right_at_x(rest.max.x - theme::PICTURE.x - 2.0);
        let middle = Rect::from_min_max(middle.min + vec2(theme::GAP, 0.0), middle.max - vec2(theme::GAP, 0.0));
        positions(ui, left, view);
        let fault = view.snapshot.screens.dressing.as_ref().and_then(|picture| picture.as_ref().err());
        empty::picture(ui, right, view, picture, ("B0100.BMP", fault));
        let (title, rest) = middle.split_top_bottom_at_y(middle.min.y + 30.0);
        lines::title(ui, view, title, view.text("砂轮磨耗", "wheel wear"));
        let unit = if view.snapshot.x_as_diameter { view.text("mm · X 直径", "mm · X diameter") } else { "mm" };
        text_line(ui.painter(), title, Align2::RIGHT_CENTER, unit, theme::LABEL, view.theme.muted);
        let (hows, list) = rest.split_top_bottom_at_y(rest.min.y + widget::TABS_HEIGHT);
        self.table.mode_keys(ui, hows, view, &form);
        let list = Rect::from_min_max(list.min + vec2(0.0, 4.0), list.max);
        self.table.ui(ui, list, view, typed, &form);
        self.table.input_line(ui, input, view, &form);
    }
}

/// Left column: axis positions in work and machine coordinates, dressing point in machine coordinates.
fn positions(ui: &Ui, rect: Rect, view: &View<'_>) {
    let snapshot = view.snapshot;
    let groups: [PositionGroup<'_>; 3] = [
        (view.text("[绝对坐标]", "[absolute]"), &|_, state| Some(state.work)),
        (view.text("[机床坐标]", "[machine]"), &|_, state| Some(state.machine)),
        (view.text("[修整点 机床坐标]", "[dressing point]"), &|axis, _| snapshot.dressing_point[axis]),
    ];
    let rest = position::column(ui, rect, view, &groups);
    let rest = Rect::from_min_max(rest.min + vec2(0.0, 8.0), rest.max);
    let params = &snapshot.params;
    let (words, ink) = if params.bit(param::WHEEL_UNDRESSED) {
        let programs = format!(
            "O{:04.0}–O{:04.0}",
            params.get(param::DRESSING_PROGRAM_FIRST),
            params.get(param::DRESSING_PROGRAM_LAST)
        );
        let words = view.text("换砂轮后未修整：先运行 ", "wheel changed: dress it with ");
        (format!("{words}{programs}"), view.theme.hold)
    } else {
        let words =
            view.text("修整点在 位置 → 相对 中按轴字母键设置", "set the point at POSITION, RELATIVE by an axis letter");
        (words.to_owned(), view.theme.muted)
    };
    paragraph(ui.painter(), rest, &words, theme::LABEL, ink);
}
