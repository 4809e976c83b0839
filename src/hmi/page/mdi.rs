//! MDI: a line is typed with the keyboard or the letter pad, loaded with 输入 and executed with cycle start.
//! Source: spec B5, B6, H6.

use egui::accesskit::Role;
use egui::{Id, Rect, Sense, WidgetInfo, vec2};

use super::{HandOver, PageContext, PageUi, Scroll, ScrollList};
use crate::defs::key::Mode;
use crate::hmi::{
    Area, CoreAnswer, EditKey, FieldEditor, KeycapState, LetterKey, TypedInput, View, keycap, letter_pad,
    page_frame as lines, theme, widget,
};
use crate::link::Command;
use crate::link::snapshot::RunState;

/// Maximum number of lines in the history.
const MAX_HISTORY: usize = 20;
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
    fn open(&mut self, _view: &View<'_>, _handed_over: Option<HandOver>) {
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
        let PageContext { rect, view, typed, out, .. } = ctx;
        if let CoreAnswer::Accepted(_, line) = self.typing.poll_answer(&view.snapshot.edit_answer)
            && !line.is_empty()
        {
            self.history.retain(|old| *old != line);
            self.history.insert(0, line);
            self.history.truncate(MAX_HISTORY);
            (self.recalled, self.scroll) = (None, Scroll::default());
        }
        for typed in &typed.in_order {
            match *typed {
                TypedInput::Char(sign) => self.push_char(sign),
                TypedInput::Key(edit) => self.edit(edit, view, out),
            }
        }
        let pad = letter_pad::block_layout(view.snapshot.kind);
        let (main, board) = rect.split_bottom(letter_pad::HEIGHT);
        if let Some(letter) = letter_pad::ui(view, board.trim_sides(theme::GAP), &pad) {
            self.letter(&letter, view, out);
        }
        let inside = Rect::from_min_max(main.min + vec2(theme::PAD, 6.0), main.max - vec2(theme::PAD, 6.0));
        let (top, input) = inside.split_bottom(INPUT_HEIGHT);
        let (title, body) = top.split_top(30.0);
        self.title(title, view);
        let (left, right) = body.split_left(196.0);
        modals(left.trim_right(theme::GAP).trim_bottom(theme::GAP), view);
        self.history_list(right.trim_bottom(theme::GAP), view, typed.scroll_pages);
        self.input(input, view);
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
                (self.typing.refused, self.recalled) = (None, None);
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
            _ => {}
        }
    }

    fn recall(&mut self, index: usize) {
        if let Some(line) = self.history.get(index) {
            self.typing.clear();
            self.typing.text.clone_from(line);
            (self.recalled, self.scroll.user_scrolled) = (Some(index), false);
        }
    }

    /// The title, and the line that waits for cycle start.
    fn title(&self, rect: Rect, view: &View<'_>) {
        let (name, told) = rect.split_left(196.0);
        lines::title(view, name, view.text("录入 MDI", "MDI"));
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
        view.fit_left(told, &words, theme::TITLE, ink);
    }

    /// The history; a touch recalls a line.
    fn history_list(&mut self, rect: Rect, view: &View<'_>, pages: i32) {
        view.card(rect);
        let list = rect.shrink(4.0);
        if self.history.is_empty() {
            let words = view
                .text("执行过的行列在这里，触摸可再用", "executed lines are listed here; touch one to use it again");
            return view.note(list.shrink2(vec2(theme::PAD, 4.0)), words);
        }
        let rect = widget::round_to_lines(list, widget::ROW_HEIGHT);
        if let (Some(index), false) = (self.recalled, self.scroll.user_scrolled) {
            self.scroll.reveal(index, rect, widget::ROW_HEIGHT);
        }
        let list = ScrollList { id: "mdi-history", rect, row: widget::ROW_HEIGHT, gap: 2.0, count: self.history.len() };
        let ((view, rows), mut touched) = (self.scroll.rows(view, &list, pages), None);
        for (index, place) in rows {
            let response = keycap::plain(&view, place, ("mdi-line", index), format!("mdi-line-{index}"));
            view.fit_left(place.trim_sides(theme::PAD), &self.history[index], theme::TITLE, view.theme.text);
            if self.recalled == Some(index) {
                view.frame(place, view.theme.focus);
            }
            if response.clicked() {
                touched = Some(index);
            }
        }
        if let Some(index) = touched {
            self.recall(index);
        }
    }

    /// The input field, and why the line was refused.
    fn input(&self, rect: Rect, view: &View<'_>) {
        let (field, told) = rect.split_top(50.0);
        let refused = self.typing.refusal(view.lang);
        keycap::paint_body(view, field, KeycapState::default());
        view.frame(field, if refused.is_some() { view.theme.alarm } else { view.theme.focus });
        let response = view.ui.interact(field, Id::unique("mdi-input"), Sense::HOVER);
        response.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, "录入行 mdi-input"));
        let ink = if refused.is_some() { view.theme.alarm_text } else { view.theme.text };
        view.fit_left(field.trim_sides(theme::PAD), &format!("{}_", self.typing.text), theme::SECONDARY, ink);
        if let Some(reason) = refused {
            view.fit_left(told, &reason, theme::LABEL, view.theme.alarm_text);
        }
    }
}

/// Modal codes in force.
fn modals(rect: Rect, view: &View<'_>) {
    view.card(rect);
    let inside = rect.shrink2(vec2(10.0, 6.0));
    let modals = &view.snapshot.modals;
    let number = |value: Option<f64>| value.map_or_else(|| "—".to_owned(), |value| value.to_string());
    // The lathe dialect has one group only.
    let groups = if view.snapshot.kind.ui().has_macros { modals.g.len() } else { 1 };
    let mut words: Vec<String> = modals.g_names().take(groups).collect();
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
        view.line_left(Rect::from_min_size(corner, vec2(width - 4.0, height)), word, theme::LABEL, view.theme.text);
    }
}
