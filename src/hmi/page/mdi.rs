//! MDI: a line is typed with the keyboard or the letter pad, loaded with 输入 and executed with cycle start.
//! Source: spec B5, B6, H6.

use egui::accesskit::Role;
use egui::{Align2, Id, Rect, Sense, Ui, WidgetInfo, pos2, vec2};

use super::scroll::Scroll;
use super::{PageContext, PageUi};
use crate::defs::key::Mode;
use crate::hmi::edit_key::EditKey;
use crate::hmi::field_editor::{CoreAnswer, FieldEditor};
use crate::hmi::keycap::{self, KeycapState};
use crate::hmi::letter_pad::{self, LetterKey};
use crate::hmi::view::{View, card, fit_text, focus_frame, text_line};
use crate::hmi::{page_frame as lines, theme, widget};
use crate::link::Command;
use crate::link::snapshot::RunState;

/// Maximum number of lines in the history.
const MAX_HISTORY: usize = 20;
/// Height of a line of the history.
const LINE_HEIGHT: f32 = 46.0;
/// Height of the input field and of the message below it.
const INPUT_HEIGHT: f32 = 78.0;
/// Maximum length of a line, characters.
const MAX_CHARS: usize = 120;

/// State of the page.
#[derive(Debug, Default)]
pub struct MdiPage {
    /// The line being typed.
    typing: FieldEditor,
    /// Lines that were loaded, latest first.
    history: Vec<String>,
    /// History line recalled with the arrow keys.
    recalled: Option<usize>,
    scroll: Scroll,
}

impl PageUi for MdiPage {
    /// History and typed text stay.
    fn open(&mut self, _view: &View<'_>, _handed_over: Option<u32>) {
        self.recalled = None;
        self.scroll = Scroll::default();
    }

    fn typing(&self) -> Option<&FieldEditor> {
        Some(&self.typing)
    }

    fn accepts_text(&self) -> bool {
        true
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        let PageContext { ui, rect, view, typed, out, .. } = ctx;
        if let CoreAnswer::Accepted(_, line) = self.typing.poll_answer(&view.snapshot.edit_answer)
            && !line.is_empty()
        {
            self.history.retain(|old| *old != line);
            self.history.insert(0, line);
            self.history.truncate(MAX_HISTORY);
            self.scroll = Scroll::default();
        }
        for sign in typed.text.chars().filter(|sign| !sign.is_control()) {
            self.push_char(sign);
        }
        for edit in typed.edits {
            self.edit(*edit, view, out);
        }
        let pad = letter_pad::block_layout(view.snapshot.kind);
        let (main, board) = rect.split_top_bottom_at_y(rect.max.y - pad.height());
        if let Some(letter) = letter_pad::ui(ui, view, board.shrink2(vec2(theme::GAP, 0.0)), &pad) {
            self.letter(&letter, view, out);
        }
        let inside = Rect::from_min_max(main.min + vec2(theme::PAD, 6.0), main.max - vec2(theme::PAD, 6.0));
        let (top, input) = inside.split_top_bottom_at_y(inside.max.y - INPUT_HEIGHT);
        let (title, body) = top.split_top_bottom_at_y(top.min.y + 30.0);
        self.title(ui, title, view);
        let (left, right) = body.split_left_right_at_x(body.min.x + 196.0);
        modals(ui, Rect::from_min_max(left.min, left.max - vec2(theme::GAP, theme::GAP)), view);
        self.history_list(
            ui,
            Rect::from_min_max(right.min, right.max - vec2(0.0, theme::GAP)),
            view,
            typed.scroll_pages,
        );
        self.input(ui, input, view);
    }
}

impl MdiPage {
    fn push_char(&mut self, sign: char) {
        self.typing.refused = None;
        if self.typing.text.chars().count() < MAX_CHARS {
            self.typing.text.extend(sign.to_uppercase());
        }
        self.recalled = None;
    }

    fn letter(&mut self, letter: &LetterKey, view: &View<'_>, out: &mut Vec<Command>) {
        match letter {
            LetterKey::Char(sign) => self.push_char(*sign),
            LetterKey::Word(word) => {
                if !self.typing.text.is_empty() && !self.typing.text.ends_with(' ') {
                    self.push_char(' ');
                }
                word.chars().for_each(|sign| self.push_char(sign));
                self.push_char(' ');
            }
            LetterKey::Backspace => self.edit(EditKey::Backspace, view, out),
            LetterKey::Done => self.edit(EditKey::Enter, view, out),
        }
    }

    fn edit(&mut self, edit: EditKey, view: &View<'_>, out: &mut Vec<Command>) {
        match edit {
            // A refused line is corrected, not typed again.
            EditKey::Backspace | EditKey::Delete => {
                self.typing.refused = None;
                self.typing.text.pop();
            }
            EditKey::Enter if self.typing.text.trim().is_empty() => {}
            EditKey::Enter => {
                self.typing.refused = None;
                let line = self.typing.text.trim().to_owned();
                self.typing.text.clone_from(&line);
                self.typing.send(0);
                out.push(Command::PrepareMdi(line));
            }
            EditKey::Cancel if !self.typing.text.is_empty() => self.typing.clear(),
            EditKey::Cancel if !view.snapshot.prepared_mdi.is_empty() => out.push(Command::PrepareMdi(String::new())),
            EditKey::Up | EditKey::Previous => {
                let next = self.recalled.map_or(0, |at| at + 1).min(self.history.len().saturating_sub(1));
                self.recall(next);
            }
            EditKey::Down | EditKey::Next => match self.recalled {
                Some(at) if at > 0 => self.recall(at - 1),
                Some(_) | None => {}
            },
            // Digits and signs arrive as text.
            EditKey::Char(_)
            | EditKey::Sign
            | EditKey::Cancel
            | EditKey::Left
            | EditKey::Right
            | EditKey::LineStart
            | EditKey::LineEnd => {}
        }
    }

    fn recall(&mut self, index: usize) {
        if let Some(line) = self.history.get(index) {
            self.typing.clear();
            self.typing.text.clone_from(line);
            self.recalled = Some(index);
        }
    }

    /// The title, and the line that waits for cycle start.
    fn title(&self, ui: &Ui, rect: Rect, view: &View<'_>) {
        let (name, told) = rect.split_left_right_at_x(rect.min.x + 196.0);
        lines::title(ui, view, name, view.text("录入 MDI", "MDI"));
        let ready = &view.snapshot.prepared_mdi;
        let (words, ink) = if view.snapshot.mode != Mode::Mdi {
            (view.text("先按面板上的 录入 键", "press MDI on the panel first").to_owned(), view.theme.hold)
        } else if !ready.is_empty() {
            (format!("{} {ready}", view.text("按循环启动执行：", "cycle start executes:")), view.theme.run)
        } else if view.snapshot.state == RunState::Running {
            (view.text("正在执行", "executing").to_owned(), view.theme.run)
        } else {
            (view.text("输入一行，再按循环启动", "type a line, INPUT, cycle start").to_owned(), view.theme.muted)
        };
        fit_text(ui.painter(), told, Align2::LEFT_CENTER, &words, theme::TITLE, ink);
    }

    /// The history; a touch recalls a line.
    fn history_list(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, pages: i32) {
        let painter = ui.painter();
        card(painter, rect, view.theme.surface, view.theme.line);
        let list = rect.shrink(4.0);
        if self.history.is_empty() {
            let words = view
                .text("执行过的行列在这里，触摸可再用", "lines that were used stand here; touch one to use it again");
            let place = list.shrink2(vec2(theme::PAD, 4.0));
            crate::hmi::view::paragraph(painter, place, words, theme::LABEL, view.theme.muted);
            return;
        }
        let list = widget::round_to_lines(list, LINE_HEIGHT);
        if pages != 0 {
            self.scroll.scroll_pages(pages, list, LINE_HEIGHT);
        }
        let (first, last) = self.scroll.handle_input(ui, "mdi-history", list, LINE_HEIGHT, self.history.len());
        let mut touched = None;
        for index in first..last {
            let painter = &ui.painter().with_clip_rect(list);
            let top = list.min.y + ((index as f64 - self.scroll.top) * f64::from(LINE_HEIGHT)) as f32;
            let place = Rect::from_min_size(pos2(list.min.x, top), vec2(list.width() - 8.0, LINE_HEIGHT - 2.0));
            let touch = place.intersect(list);
            let response = ui.interact(touch, Id::unique(("mdi-line", index)), Sense::CLICK);
            response.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("mdi-line-{index}")));
            let face = KeycapState { pressed: response.is_pointer_button_down_on(), ..KeycapState::default() };
            keycap::paint_body(painter, view.theme, place, face);
            let words = place.shrink2(vec2(theme::PAD, 0.0));
            fit_text(painter, words, Align2::LEFT_CENTER, &self.history[index], theme::TITLE, view.theme.text);
            if self.recalled == Some(index) {
                focus_frame(painter, place, view.theme.focus);
            }
            if response.clicked() {
                touched = Some(index);
            }
        }
        self.scroll.draw_bar(ui, view, list, LINE_HEIGHT, self.history.len());
        if let Some(index) = touched {
            self.recall(index);
        }
    }

    /// The input field, and why the line was refused.
    fn input(&self, ui: &Ui, rect: Rect, view: &View<'_>) {
        let painter = ui.painter();
        let (field, told) = rect.split_top_bottom_at_y(rect.min.y + 50.0);
        let refused = self.typing.refusal(view.lang);
        let face = KeycapState::default();
        keycap::paint_body(painter, view.theme, field, face);
        let edge = if refused.is_some() { view.theme.alarm } else { view.theme.focus };
        focus_frame(painter, field, edge);
        let response = ui.interact(field, Id::unique("mdi-input"), Sense::HOVER);
        response.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, "录入行 mdi-input"));
        let ink = if refused.is_some() { view.theme.alarm_text } else { view.theme.text };
        let words = format!("{}_", self.typing.text);
        fit_text(painter, field.shrink2(vec2(theme::PAD, 0.0)), Align2::LEFT_CENTER, &words, theme::SECONDARY, ink);
        if let Some(reason) = refused {
            fit_text(painter, told, Align2::LEFT_CENTER, reason, theme::LABEL, view.theme.alarm_text);
        }
    }
}

/// Modal codes in force.
fn modals(ui: &Ui, rect: Rect, view: &View<'_>) {
    let painter = ui.painter();
    card(painter, rect, view.theme.surface, view.theme.line);
    let inside = rect.shrink2(vec2(10.0, 6.0));
    let modals = &view.snapshot.modals;
    let number = |value: Option<f64>| value.map_or_else(|| "—".to_owned(), |value| value.to_string());
    // The lathe dialect has one group only.
    let groups = if view.snapshot.kind.ui().has_macros { modals.g.len() } else { 1 };
    let mut words: Vec<String> = modals.g.iter().take(groups).map(|code| format!("G{code:02}")).collect();
    words.push(format!("T{:02}{:02}", modals.tool.0, modals.tool.1));
    words.push(modals.m.map_or_else(|| "M—".to_owned(), |code| format!("M{code:02}")));
    words.push(format!("F {}", number(modals.feed)));
    words.push(format!("S {}", number(modals.speed)));
    // Three columns if the card is low.
    let columns = if inside.height() < 6.0 * 24.0 { 3 } else { 2 };
    let lines = words.len().div_ceil(columns);
    let height = (inside.height() / lines as f32).min(34.0);
    let width = inside.width() / columns as f32;
    for (index, word) in words.iter().enumerate() {
        let corner = inside.min + vec2((index % columns) as f32 * width, (index / columns) as f32 * height);
        let place = Rect::from_min_size(corner, vec2(width - 4.0, height));
        text_line(painter, place, Align2::LEFT_CENTER, word, theme::LABEL, view.theme.text);
    }
}
