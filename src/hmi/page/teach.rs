//! Teach-in (录返): records jogged moves as program blocks. Source: spec L9.

use egui::{Align2, Rect, Ui, pos2, vec2};

use super::scroll::Scroll;
use super::{PageContext, PageUi};
use crate::defs::param::{self, ParamAddress};
use crate::hmi::login::Login;
use crate::hmi::view::{View, card, fit_text, format_length, format_whole, paragraph, text_line};
use crate::hmi::widget::{self, ButtonState, KeyboardFocus, cell};
use crate::hmi::{page_frame as lines, theme};
use crate::link::Command;
use crate::link::page_command::{PageCommand, PasswordScope};
use crate::link::teach::TeachCommand;
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
        let PageContext { ui, rect, view, typed, login, out, .. } = ctx;
        self.walk.begin_frame(if login.is_open() { &[] } else { typed.edits });
        if self.awaiting_password && !login.is_open() {
            self.awaiting_password = false;
            if !needs_password(view) {
                out.push(Command::Teach(TeachCommand::Save));
            }
        }
        let inside = rect.shrink2(vec2(theme::PAD, 6.0));
        let (title, rest) = inside.split_top_bottom_at_y(inside.min.y + 32.0);
        let teach = &view.snapshot.teach;
        let state = match (teach.recording, teach.saved) {
            (true, _) => view.text("正在记录", "recording"),
            (false, true) => view.text("已保存", "kept as a program"),
            (false, false) => view.text("未记录", "not recording"),
        };
        let words = format!(
            "{} · {state} · {} {}",
            view.text("录返", "teach-in"),
            teach.blocks.len(),
            view.text("段", "blocks")
        );
        lines::title(ui, view, title, &words);
        let (body, keys) = rest.split_top_bottom_at_y(rest.max.y - 2.0 * KEY_HEIGHT - theme::GAP);
        let (list, side) = body.split_left_right_at_fraction(0.6);
        let list = Rect::from_min_max(list.min, list.max - vec2(theme::GAP, theme::GAP));
        self.blocks(ui, list, view, typed.scroll_pages);
        tool_status(ui, Rect::from_min_max(side.min, side.max - vec2(0.0, theme::GAP)), view);
        let (steps, acts) = keys.split_top_bottom_at_y(keys.min.y + KEY_HEIGHT + theme::GAP);
        self.steps(ui, Rect::from_min_size(steps.min, vec2(steps.width(), KEY_HEIGHT)), view, out);
        self.action_keys(ui, acts, view, login, out);
    }
}

impl TeachPage {
    fn blocks(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, pages: i32) {
        card(ui.painter(), rect, view.theme.surface, view.theme.line);
        let blocks = &view.snapshot.teach.blocks;
        let inside = rect.shrink2(vec2(10.0, 6.0));
        if blocks.is_empty() {
            let words = view.text(
                "按“开始录返”，然后用手动、单步或手轮移动刀具。\n每段直线、主轴、冷却、换刀都会记成程序段。",
                "Press START, then move the tool by jog keys, steps or handwheel.\nEvery straight way, spindle, coolant and tool change becomes a block.",
            );
            paragraph(ui.painter(), inside, words, theme::LABEL, view.theme.muted);
            return;
        }
        let inside = widget::round_to_lines(inside, LINE_HEIGHT);
        if blocks.len() != self.block_count {
            self.block_count = blocks.len();
            self.scroll.scroll_to(blocks.len(), inside, LINE_HEIGHT);
        }
        if pages != 0 {
            self.scroll.scroll_pages(pages, inside, LINE_HEIGHT);
        }
        let (first, last) = self.scroll.handle_input(ui, "teach-blocks", inside, LINE_HEIGHT, blocks.len());
        let painter = ui.painter().with_clip_rect(inside);
        for (index, block) in blocks.iter().enumerate().take(last).skip(first) {
            let top = inside.min.y + ((index as f64 - self.scroll.top) * f64::from(LINE_HEIGHT)) as f32;
            let line = Rect::from_min_size(pos2(inside.min.x, top), vec2(inside.width() - 14.0, LINE_HEIGHT));
            let newest = index + 1 == blocks.len() && view.snapshot.teach.recording;
            let ink = if newest { view.theme.info } else { view.theme.text };
            text_line(&painter, line, Align2::LEFT_CENTER, block, theme::TITLE, ink);
        }
        self.scroll.draw_bar(ui, view, inside, LINE_HEIGHT, blocks.len());
    }

    /// Keys for the jog step (定长进给).
    fn steps(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, out: &mut Vec<Command>) {
        let (words, keys) = rect.split_left_right_at_x(rect.min.x + 104.0);
        fit_text(
            ui.painter(),
            words,
            Align2::LEFT_CENTER,
            view.text("定长 mm", "step mm"),
            theme::LABEL,
            view.theme.muted,
        );
        let set = view.snapshot.params.get(param::FIXED_STEP_LENGTH);
        for (index, (name, value)) in STEP_KEYS.into_iter().enumerate() {
            let label = if value > 0.0 { value.to_string() } else { view.text("倍率键", "KEYS").to_owned() };
            let look = ButtonState { on: (set - value).abs() < 1e-9, locked: false };
            if self.walk.button(ui, view, cell(keys, index, STEP_KEYS.len()), (name, &label), look) {
                let at: ParamAddress = param::FIXED_STEP_LENGTH.address();
                out.push(Command::Page(PageCommand::EditParam(at, value)));
            }
        }
    }

    fn action_keys(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, login: &mut Login, out: &mut Vec<Command>) {
        let teach = &view.snapshot.teach;
        let nothing = teach.blocks.len() < 2;
        let keys = [
            ("teach-start", view.text("开始录返", "START"), TeachCommand::Start, teach.recording, false),
            ("teach-stop", view.text("停止", "STOP"), TeachCommand::Stop, false, !teach.recording),
            ("teach-undo", view.text("撤销一段", "UNDO"), TeachCommand::Undo, false, nothing),
            ("teach-keep", view.text("存为程序", "KEEP"), TeachCommand::Save, teach.saved, nothing),
        ];
        let rect = Rect::from_min_size(rect.min, vec2(rect.width(), KEY_HEIGHT));
        for (index, (name, label, command, on, locked)) in keys.into_iter().enumerate() {
            if self.walk.button(ui, view, cell(rect, index, keys.len()), (name, label), ButtonState { on, locked }) {
                if command == TeachCommand::Save && !nothing && needs_password(view) {
                    login.unlock(view, PasswordScope::Program);
                    self.awaiting_password = true;
                } else {
                    out.push(Command::Teach(command));
                }
            }
        }
    }
}

/// Whether saving a program needs the password first (K6.2).
fn needs_password(view: &View<'_>) -> bool {
    view.snapshot.params.bit(param::PROGRAM_PASSWORD) && !view.snapshot.access.program_unlocked
}

/// Tool position and status values.
fn tool_status(ui: &Ui, rect: Rect, view: &View<'_>) {
    card(ui.painter(), rect, view.theme.surface, view.theme.line);
    let inside = rect.shrink2(vec2(theme::PAD, 10.0));
    let snapshot = view.snapshot;
    let mut top = inside.min.y;
    let digits = (inside.width() / 6.5).clamp(theme::SECONDARY, theme::DIGITS);
    for (axis, state) in snapshot.axes.iter().filter(|(axis, state)| state.present && *axis != Axis::Y) {
        let line = Rect::from_min_size(pos2(inside.min.x, top), vec2(inside.width(), digits + 14.0));
        let ink = if state.moving { view.theme.info } else { view.theme.text };
        text_line(ui.painter(), line, Align2::LEFT_CENTER, &axis.to_string(), digits, ink);
        text_line(ui.painter(), line, Align2::RIGHT_CENTER, &format_length(state.work), digits, ink);
        top = line.max.y;
    }
    let step = match snapshot.params.get(param::FIXED_STEP_LENGTH) {
        set if set > 0.0 => set,
        _ => snapshot.handwheel_step_mm,
    };
    let station =
        snapshot.tool_station.filter(|station| *station > 0).map_or_else(|| "–".to_owned(), |at| format!("T{at}"));
    let rows = [
        (view.text("主轴 r/min", "spindle rpm"), format_whole(snapshot.wheel_rpm)),
        (view.text("刀位", "station"), station),
        (view.text("单步 mm", "step mm"), step.to_string()),
        (view.text("进给倍率 %", "feed ovr %"), snapshot.feed_override.to_string()),
    ];
    top += 8.0;
    for (name, value) in rows {
        let line = Rect::from_min_size(pos2(inside.min.x, top), vec2(inside.width(), LINE_HEIGHT));
        if line.max.y > inside.max.y {
            return;
        }
        let (left, right) = line.split_left_right_at_fraction(0.6);
        fit_text(ui.painter(), left, Align2::LEFT_CENTER, name, theme::LABEL, view.theme.muted);
        text_line(ui.painter(), right, Align2::RIGHT_CENTER, &value, theme::TITLE, view.theme.text);
        top += LINE_HEIGHT;
    }
}
