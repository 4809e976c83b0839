//! Dressing page: positions, dressing point, wear offsets, and the picture B0100.BMP; beside the wear the assistant.
//! Editing on this page does not need P22.0.
//! Source: spec K7.6, K7.7 (D), K4.2.

mod assistant;

use std::sync::Arc;

use egui::Rect;

use super::offset::table::{EntryMode, OffsetTable, OffsetTableSpec, TOOL_OFFSET_ROWS, columns};
use super::position::{self, PositionGroup};
use super::start_strip::{self, StartStrip};
use super::{HandOver, PageContext, PageUi, empty, input_line};
use crate::defs::param;
use crate::defs::text::{Text, phrase};
use crate::hmi::{Area, FieldEditor, KeyboardInput, PageKey, Question, QuestionDialog, View, scene, theme, widget};
use crate::link::edit::OffsetPart;
use crate::link::screens::Picture;
use crate::link::{Command, PageCommand, Snapshot};
use crate::units::Axis;
use assistant::DressingAssistant;

/// Entry modes of this page.
const ENTRY_MODES: [EntryMode; 2] = [EntryMode::Absolute, EntryMode::Increment];
/// Height of the unit above the table.
const UNIT_HEIGHT: f32 = 22.0;
/// Height of the key that clears the dressing points.
const CLEAR_HEIGHT: f32 = 48.0;

widget::page_keys! {
    /// What is shown beside the positions.
    #[derive(Default)]
    DressingTab {
        /// The wear table.
        #[default]
        Wear = "wheel-wear", "砂轮磨耗", "WHEEL WEAR";
        /// The assistant.
        Assistant = "dressing-assistant", "修整", "DRESS";
    }
}

const TABS: [DressingTab; 2] = [DressingTab::Wear, DressingTab::Assistant];

/// What the open question is about.
#[derive(Clone, Copy, Debug)]
enum PointChange {
    Clear,
    Take(Axis, f64),
}

/// State of the page.
#[derive(Debug, Default)]
pub struct DressingPage {
    /// The wear table.
    pub table: OffsetTable,
    shows: DressingTab,
    assistant: DressingAssistant,
    start: StartStrip,
    question: QuestionDialog<PointChange>,
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
        let (rect, view, edits) = (ctx.rect, ctx.view, &ctx.typed.edits);
        let answered = KeyboardInput::default();
        let typed = if self.question.is_open() { &answered } else { ctx.typed };
        let (login, hand_over, out) = (ctx.login, ctx.hand_over, ctx.out);
        self.body(PageContext { typed, login, hand_over, out: &mut *out, ..ctx });
        let command = match self.question.ui(rect, view, edits) {
            Some((PointChange::Clear, Some(_))) => PageCommand::ClearDressPoints,
            Some((PointChange::Take(axis, at), Some(_))) => PageCommand::TakeDressPoint(axis, at),
            Some((_, None)) | None => return,
        };
        out.push(Command::Page(command));
    }

    fn close(&mut self) {
        self.question.close();
    }
}

impl DressingPage {
    fn body(&mut self, mut ctx: PageContext<'_>) {
        let (rect, view, picture) = (ctx.rect, ctx.view, ctx.picture);
        let (page, below) = match self.shows {
            DressingTab::Wear => input_line::split(rect),
            DressingTab::Assistant => rect.split_bottom(start_strip::HEIGHT + theme::GAP),
        };
        let main = page.shrink(theme::GAP);
        let (left, rest) = main.split_left(if main.width() > 900.0 { 210.0 } else { 172.0 });
        let (middle, right) = rest.split_right(theme::PICTURE.x + 2.0);
        positions(left, view, self.shows);
        self.clear_key(right, &ctx);
        let (tabs, body) = middle.trim_sides(theme::GAP).split_top(widget::KEYS_HEIGHT + theme::GAP);
        self.choose_tab(tabs.trim_bottom(theme::GAP), &ctx);
        // The machine at work, once a program tells what stands in it.
        if self.shows == DressingTab::Assistant && view.snapshot.program.number > 0 {
            scene::paint_follow(right.trim_bottom(CLEAR_HEIGHT + theme::GAP), view);
        } else {
            let fault = view.snapshot.screens.dressing.as_ref().and_then(|picture| picture.as_ref().err());
            empty::picture(right, view, picture, "B0100.BMP", fault);
        }
        match self.shows {
            DressingTab::Wear => self.wear(body, below, &mut ctx),
            DressingTab::Assistant => {
                if let Some(axis) = self.assistant.ui(body, &mut ctx) {
                    let at = view.snapshot.axes[axis].machine;
                    self.question.ask(PointChange::Take(axis, at), take_question(axis, &view.length(at)));
                }
                self.start.ui(below.trim_sides(theme::PAD).trim_bottom(theme::GAP), &mut ctx);
            }
        }
    }

    /// The keys above the table; Ctrl+P chooses the other one.
    fn choose_tab(&mut self, rect: Rect, ctx: &PageContext<'_>) {
        let keys: Vec<_> = TABS.iter().map(|of| (of.id(), of.label().get(ctx.view.lang).to_owned())).collect();
        let chosen = TABS.iter().position(|of| *of == self.shows).unwrap_or(0);
        let touched = widget::tabs(ctx.view, rect, &keys, chosen);
        let by_keyboard = ctx.typed.ctrl_keys.contains(&egui::Key::P).then_some(1 - chosen);
        self.shows = TABS[touched.or(by_keyboard).unwrap_or(chosen)];
    }

    fn wear(&mut self, rect: Rect, input: Rect, ctx: &mut PageContext<'_>) {
        let view = ctx.view;
        let columns = columns(view, &[OffsetPart::Wear]);
        let form = OffsetTableSpec {
            id: "dressing",
            columns: &columns,
            rows: TOOL_OFFSET_ROWS,
            in_force: view.snapshot.offsets.active_tool.checked_sub(1),
            modes: &ENTRY_MODES,
            locked: false,
        };
        ctx.out.extend(self.table.handle_typed(view, ctx.typed, &form));
        let (unit, rest) = rect.split_top(UNIT_HEIGHT);
        view.line_right(unit, view.position_unit(), theme::LABEL, view.theme.muted);
        let (hows, list) = rest.split_top(widget::KEYS_HEIGHT);
        self.table.mode_keys(hows, view, &form);
        self.table.ui(list.trim_top(4.0), view, ctx.typed, &form);
        self.table.input_line(input, view, &form);
    }

    /// The key that clears the dressing points, where one is set: below the picture; Ctrl+D.
    fn clear_key(&mut self, column: Rect, ctx: &PageContext<'_>) {
        let (view, typed) = (ctx.view, ctx.typed);
        let key = column.with_min_y(column.max.y - CLEAR_HEIGHT);
        let is_set = view.snapshot.dressing_point.iter().any(|(_, point)| point.is_some());
        let words = view.text("清除修整点", "CLEAR POINT");
        let by_keyboard = typed.ctrl_keys.contains(&egui::Key::D);
        if is_set && (widget::button(view, key, PageKey::new("clear-dress-points", words)) || by_keyboard) {
            self.question.ask(PointChange::Clear, clear_question());
        }
    }
}

/// Left column: axis positions in work and machine coordinates, dressing point in machine coordinates.
fn positions(rect: Rect, view: &View<'_>, tab: DressingTab) {
    let snapshot = view.snapshot;
    let groups: [PositionGroup<'_>; 3] = [
        (view.text("[绝对坐标]", "[absolute]"), &|_, state| Some(state.work)),
        (view.text("[机床坐标]", "[machine]"), &|_, state| Some(state.machine)),
        (view.text("[修整点 机床坐标]", "[dressing point]"), &|axis, _| snapshot.dressing_point[axis]),
    ];
    let rest = position::column(rect, view, &groups);
    let params = &snapshot.params;
    let (words, ink) = if params.bit(param::WHEEL_UNDRESSED) {
        let numbers = snapshot.dressing_programs();
        let words = view.text("换砂轮后未修整：先运行 ", "wheel changed: dress it with ");
        (format!("{words}O{:04}–O{:04}", numbers.start(), numbers.end()), view.theme.hold)
    } else {
        let (zh, en) = match tab {
            DressingTab::Wear => (
                "设置修整点：位置 → 相对，按轴字母键，再按输入",
                "to set the point: POSITION, RELATIVE, an axis letter, then INPUT",
            ),
            DressingTab::Assistant => (
                "设置修整点：回零后用手轮使砂轮刚好接触金刚石，手动方式下按取此处",
                "to set the point: home, touch the diamond with the wheel by handwheel, then TAKE in JOG",
            ),
        };
        (view.text(zh, en).to_owned(), view.theme.muted)
    };
    view.paragraph(rest.trim_top(8.0), &words, theme::LABEL, ink);
}

/// The question says where the point will be.
fn take_question(axis: Axis, at: &str) -> Question {
    let body = phrase!(
        "{axis} 轴修整点设为现在的机床坐标 {at}。修整程序从这里开始：砂轮须刚好接触金刚石。",
        "The dressing point of {axis} becomes the present machine coordinate {at}. Dressing begins there: the wheel must just touch the diamond.",
        axis,
        at
    );
    let key = ("question-take-point", Text::new("设置", "SET"));
    Question::new(Text::new("在此处设置修整点？", "set the dressing point here?"), body, key)
}

/// The question says what the dressing programs use then.
fn clear_question() -> Question {
    let body = phrase!(
        "修整程序改用其页面上的数值；没有数值时报警，不会移动。",
        "The dressing programs use the values of their pages then; without a value they stop with an alarm before they move."
    );
    let key = ("question-clear-points", Text::new("清除", "CLEAR"));
    Question::new(Text::new("清除按键设置的修整点？", "clear the dressing points set by key?"), body, key)
}
