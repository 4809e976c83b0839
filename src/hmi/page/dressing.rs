//! Dressing page: positions, dressing point, wear offsets, and the picture B0100.BMP.
//! Editing on this page does not need P22.0.
//! Source: spec K7.6, K7.7 (D), K4.2.

use std::sync::Arc;

use egui::Rect;

use super::offset::table::{EntryMode, OffsetTable, OffsetTableSpec, TOOL_OFFSET_ROWS, columns};
use super::position::{self, PositionGroup};
use super::{HandOver, PageContext, PageUi, empty, input_line};
use crate::defs::param;
use crate::defs::text::{LocalizedText, Text};
use crate::hmi::{
    Area, FieldEditor, KeyboardInput, PageKey, Question, QuestionDialog, View, page_frame as lines, theme, widget,
};
use crate::link::command::Picture;
use crate::link::edit::OffsetPart;
use crate::link::{Command, PageCommand, Snapshot};

/// Entry modes of this page.
const ENTRY_MODES: [EntryMode; 2] = [EntryMode::Absolute, EntryMode::Increment];

/// State of the page.
#[derive(Debug, Default)]
pub struct DressingPage {
    /// The wear table.
    pub table: OffsetTable,
    /// Question whether to clear the dressing points.
    question: QuestionDialog<()>,
}

impl PageUi for DressingPage {
    fn open(&mut self, view: &View<'_>, _handed_over: Option<HandOver>) {
        self.table.open(view.snapshot.offsets.active_tool);
    }

    fn typing(&self) -> Option<&FieldEditor> {
        Some(&self.table.typing)
    }

    fn picture<'a>(&self, snapshot: &'a Snapshot) -> Option<&'a Arc<Picture>> {
        snapshot.screens.dressing.as_ref()?.as_ref().ok()
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        let PageContext { rect, view, typed, picture, out, .. } = ctx;
        let (edits, answered) = (&typed.edits, KeyboardInput::default());
        let typed = if self.question.is_open() { &answered } else { typed };
        let columns = columns(view, &[OffsetPart::Wear]);
        let form = OffsetTableSpec {
            id: "dressing",
            columns: &columns,
            rows: TOOL_OFFSET_ROWS,
            in_force: view.snapshot.offsets.active_tool.checked_sub(1),
            modes: &ENTRY_MODES,
            locked: false,
        };
        out.extend(self.table.handle_typed(view, typed, &form));
        let (page, input) = input_line::split(rect);
        let main = page.shrink(theme::GAP);
        let (left, rest) = main.split_left(if main.width() > 900.0 { 210.0 } else { 172.0 });
        let (middle, right) = rest.split_right(theme::PICTURE.x + 2.0);
        positions(left, view);
        let fault = view.snapshot.screens.dressing.as_ref().and_then(|picture| picture.as_ref().err());
        empty::picture(right, view, picture, "B0100.BMP", fault);
        self.clear_key(right, view, typed);
        let (title, rest) = middle.trim_sides(theme::GAP).split_top(30.0);
        lines::title(view, title, view.text("砂轮磨耗", "wheel wear"));
        view.line_right(title, view.position_unit(), theme::LABEL, view.theme.muted);
        let (hows, list) = rest.split_top(widget::KEYS_HEIGHT);
        self.table.mode_keys(hows, view, &form);
        self.table.ui(list.trim_top(4.0), view, typed, &form);
        self.table.input_line(input, view, &form);
        if let Some(((), Some(_))) = self.question.ui(rect, view, edits) {
            out.push(Command::Page(PageCommand::ClearDressPoints));
        }
    }

    fn close(&mut self) {
        self.question.close();
    }
}

impl DressingPage {
    /// The key that clears the dressing points, where one is set: below the picture; Ctrl+D.
    fn clear_key(&mut self, column: Rect, view: &View<'_>, typed: &KeyboardInput) {
        let key = column.with_min_y(column.max.y - 48.0);
        let is_set = view.snapshot.dressing_point.iter().any(|(_, point)| point.is_some());
        let words = view.text("清除修整点", "CLEAR POINT");
        let by_keyboard = typed.ctrl_keys.contains(&egui::Key::D);
        if is_set && (widget::button(view, key, PageKey::new("clear-dress-points", words)) || by_keyboard) {
            self.question.ask((), clear_question());
        }
    }
}

/// Left column: axis positions in work and machine coordinates, dressing point in machine coordinates.
fn positions(rect: Rect, view: &View<'_>) {
    let snapshot = view.snapshot;
    let groups: [PositionGroup<'_>; 3] = [
        (view.text("[绝对坐标]", "[absolute]"), &|_, state| Some(state.work)),
        (view.text("[机床坐标]", "[machine]"), &|_, state| Some(state.machine)),
        (view.text("[修整点 机床坐标]", "[dressing point]"), &|axis, _| snapshot.dressing_point[axis]),
    ];
    let rest = position::column(rect, view, &groups);
    let params = &snapshot.params;
    let (words, ink) = if params.bit(param::WHEEL_UNDRESSED) {
        let (first, last) = (params.get(param::DRESSING_PROGRAM_FIRST), params.get(param::DRESSING_PROGRAM_LAST));
        let words = view.text("换砂轮后未修整：先运行 ", "wheel changed: dress it with ");
        (format!("{words}O{first:04.0}–O{last:04.0}"), view.theme.hold)
    } else {
        let (zh, en) = (
            "设置修整点：位置 → 相对，按轴字母键，再按输入",
            "to set the point: POSITION, RELATIVE, an axis letter, then INPUT",
        );
        (view.text(zh, en).to_owned(), view.theme.muted)
    };
    view.paragraph(rest.trim_top(8.0), &words, theme::LABEL, ink);
}

/// The question says what the dressing programs use then.
fn clear_question() -> Question {
    let body = LocalizedText::new(
        "修整程序改用其页面上的数值；没有数值时报警，不会移动。",
        "The dressing programs use the values of their pages then; without a value they stop with an alarm before they move.",
    );
    let key = ("question-clear-points", Text::new("清除", "CLEAR"));
    Question::new(Text::new("清除按键设置的修整点？", "clear the dressing points set by key?"), body, key)
}
