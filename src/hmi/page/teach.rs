//! Teach-in (录返): records jogged moves as program blocks. Source: spec L9.

use egui::{Rect, pos2, vec2};

use super::{PageContext, PageUi, Scroll, ScrollList};
use crate::defs::param;
use crate::hmi::{Area, KeyboardFocus, Login, PageKey, View, format_whole, page_frame as lines, theme, widget};
use crate::link::Command;
use crate::link::page_command::{PageCommand, PasswordScope};
use crate::link::teach::{TeachCommand, block_text};
use crate::units::Axis;

/// Height of a key.
const KEY_HEIGHT: f32 = 54.0;
/// Height of a block's line.
const LINE_HEIGHT: f32 = 30.0;
/// Jog step of each key, mm; 0: the panel's step keys apply.
const STEP_KEYS: [(&str, f64); 6] =
    [("step-off", 0.0), ("step-0.1", 0.1), ("step-1", 1.0), ("step-5", 5.0), ("step-10", 10.0), ("step-50", 50.0)];

/// State of the page.
#[derive(Debug, Default)]
pub struct TeachPage {
    walk: KeyboardFocus,
    scroll: Scroll,
    /// Number of blocks in the last frame; a new block is scrolled to.
    block_count: usize,
    /// The password is being typed; then the recording is saved.
    awaiting_password: bool,
}

impl PageUi for TeachPage {
    fn ui(&mut self, ctx: PageContext<'_>) {
        let PageContext { rect, view, typed, login, out, .. } = ctx;
        self.walk.begin_frame(if login.is_open() { &[] } else { &typed.edits });
        if self.awaiting_password && !login.is_open() {
            self.awaiting_password = false;
            if !needs_password(view) {
                out.push(Command::Teach(TeachCommand::Save));
            }
        }
        let (title, rest) = rect.shrink2(vec2(theme::PAD, 6.0)).split_top(32.0);
        let teach = &view.snapshot.teach;
        let state = match (teach.recording, teach.saved) {
            (true, _) => view.text("正在记录", "recording"),
            (false, true) => view.text("已保存", "saved as a program"),
            (false, false) => view.text("未记录", "not recording"),
        };
        let blocks = format!("{} {}", teach.blocks.len(), view.text("段", "blocks"));
        lines::title(view, title, &format!("{} · {state} · {blocks}", view.text("录返", "teach-in")));
        let (body, keys) = rest.split_bottom(2.0 * KEY_HEIGHT + theme::GAP);
        let (list, side) = body.split_left_right_at_fraction(0.6);
        self.blocks(list.trim_right(theme::GAP).trim_bottom(theme::GAP), view, typed.scroll_pages);
        tool_status(side.trim_bottom(theme::GAP), view);
        let (steps, actions) = keys.split_top(KEY_HEIGHT + theme::GAP);
        self.steps(steps.band(0.0, KEY_HEIGHT), view, out);
        self.action_keys(actions, view, login, out);
    }
}

impl TeachPage {
    fn blocks(&mut self, rect: Rect, view: &View<'_>, pages: i32) {
        view.card(rect);
        let blocks = &view.snapshot.teach.blocks;
        let inside = rect.shrink2(vec2(10.0, 6.0));
        if blocks.is_empty() {
            let words = view.text(
                "按“开始录返”，然后用手动、单步或手轮移动刀具。\n每段直线、主轴、冷却、换刀都会记成程序段。",
                "Press START, then move the tool by jog keys, steps or handwheel.\nEvery straight move, spindle, coolant and tool change becomes a block.",
            );
            return view.note(inside, words);
        }
        let inside = widget::round_to_lines(inside, LINE_HEIGHT);
        if blocks.len() != self.block_count {
            self.block_count = blocks.len();
            self.scroll.scroll_to(blocks.len(), inside, LINE_HEIGHT);
        }
        let list = ScrollList { id: "teach-blocks", rect: inside, row: LINE_HEIGHT, gap: 0.0, count: blocks.len() };
        let (clipped, rows) = self.scroll.rows(view, &list, pages);
        for (index, line) in rows {
            let newest = index + 1 == blocks.len() && view.snapshot.teach.recording;
            let ink = if newest { view.theme.info } else { view.theme.text };
            clipped.line_left(line.trim_right(6.0), &block_text(index, &blocks[index]), theme::TITLE, ink);
        }
    }

    /// Keys for the jog step (定长进给).
    fn steps(&mut self, rect: Rect, view: &View<'_>, out: &mut Vec<Command>) {
        let (words, keys) = rect.split_left(104.0);
        view.fit_left(words, view.text("定长 mm", "step mm"), theme::LABEL, view.theme.muted);
        let set = view.snapshot.params.get(param::FIXED_STEP_LENGTH);
        let labels = STEP_KEYS.map(|(_, value)| value.to_string());
        let key = |index: usize| {
            let (name, value) = STEP_KEYS[index];
            let label = if value > 0.0 { &labels[index] } else { view.text("倍率键", "KEYS") };
            PageKey::new(name, label).on((set - value).abs() < 1e-9)
        };
        if let Some(index) = self.walk.keys(view, keys, &std::array::from_fn::<_, { STEP_KEYS.len() }, _>(key)) {
            out.push(Command::Page(PageCommand::EditParam(param::FIXED_STEP_LENGTH.address(), STEP_KEYS[index].1)));
        }
    }

    fn action_keys(&mut self, rect: Rect, view: &View<'_>, login: &mut Login, out: &mut Vec<Command>) {
        let teach = &view.snapshot.teach;
        let nothing = teach.blocks.len() < 2;
        let keys = [
            PageKey::new("teach-start", view.text("开始录返", "START")).on(teach.recording),
            PageKey::new("teach-stop", view.text("停止", "STOP")).locked(!teach.recording),
            PageKey::new("teach-undo", view.text("撤销一段", "UNDO")).locked(nothing),
            PageKey::new("teach-keep", view.text("存为程序", "SAVE")).on(teach.saved).locked(nothing),
        ];
        let commands = [TeachCommand::Start, TeachCommand::Stop, TeachCommand::Undo, TeachCommand::Save];
        match self.walk.keys(view, rect.band(0.0, KEY_HEIGHT), &keys).map(|index| commands[index]) {
            Some(TeachCommand::Save) if !nothing && needs_password(view) => {
                login.unlock(view, PasswordScope::Program);
                self.awaiting_password = true;
            }
            Some(command) => out.push(Command::Teach(command)),
            None => {}
        }
    }
}

/// Whether saving a program needs the password first (K6.2).
fn needs_password(view: &View<'_>) -> bool {
    view.snapshot.params.bit(param::PROGRAM_PASSWORD) && !view.snapshot.access.program_unlocked
}

/// Tool position and status values.
fn tool_status(rect: Rect, view: &View<'_>) {
    view.card(rect);
    let inside = rect.shrink2(vec2(theme::PAD, 10.0));
    let snapshot = view.snapshot;
    let mut top = inside.min.y;
    let digits = (inside.width() / 6.5).clamp(theme::SECONDARY, theme::DIGITS);
    for (axis, state) in snapshot.axes.iter().filter(|(axis, state)| state.present && *axis != Axis::Y) {
        let line = Rect::from_min_size(pos2(inside.min.x, top), vec2(inside.width(), digits + 14.0));
        let ink = if state.moving { view.theme.info } else { view.theme.text };
        view.line_left(line, &axis.to_string(), digits, ink);
        view.line_right(line, &view.length(state.work), digits, ink);
        top = line.max.y;
    }
    let fixed = snapshot.params.get(param::FIXED_STEP_LENGTH);
    let step = if fixed > 0.0 { fixed } else { snapshot.handwheel.step_mm };
    let station =
        snapshot.tool_station.filter(|station| *station > 0).map_or_else(|| "–".to_owned(), |at| format!("T{at}"));
    let rows = [
        (view.text("主轴 r/min", "spindle rpm"), format_whole(snapshot.wheel_rpm)),
        (view.text("刀位", "station"), station),
        (view.text("单步 mm", "step mm"), step.to_string()),
        (view.text("进给倍率 %", "feed ovr %"), snapshot.overrides.feed.to_string()),
    ];
    top += 8.0;
    for (name, value) in rows {
        let line = Rect::from_min_size(pos2(inside.min.x, top), vec2(inside.width(), LINE_HEIGHT));
        if line.max.y > inside.max.y {
            return;
        }
        let (left, right) = line.split_left_right_at_fraction(0.6);
        view.fit_left(left, name, theme::LABEL, view.theme.muted);
        view.line_right(right, &value, theme::TITLE, view.theme.text);
        top += LINE_HEIGHT;
    }
}
