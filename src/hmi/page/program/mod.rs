//! Program page: listing with the running block marked, and the editor in mode EDIT. A text of a million lines stays
//! responsive: it is shared with the core, only visible lines are laid out, and whole-text work is done in slices.
//! Source: spec B6 (程序), K6.2, H6, H8.

pub mod actions;
pub mod document;
pub mod listing;
mod text_task;

use std::ops::Range;

use egui::{Rect, Ui, pos2, vec2};

use super::{HandOver, PageContext, PageUi, ScrollList, VisibleRows, empty};
use crate::defs::key::Mode;
use crate::defs::text::{Lang, LocalizedText};
use crate::hmi::{
    Area, EditKey, KeyboardFocus, KeyboardInput, LetterKey, Login, PageMessage, PendingRequests, QuestionDialog,
    RequestEvent, TypedInput, View, file_command, letter_pad, page_frame as lines, requests, round_to_lines, theme,
    widget,
};
use crate::link::Command;
use crate::link::files::{FileRequest, MAX_CHECKED_CHARS, MAX_CHECKED_LINES, Refusal, Requester};
use crate::link::snapshot::RunState;
use actions::{EditorAction, UNSAVED};
use document::{Document, content_len};

use listing::{LINE_HEIGHT, LineMarks};
use ropey::Rope;
use text_task::TextTask;

/// Height of the message line.
const MESSAGE_HEIGHT: f32 = 28.0;
/// Seconds without typing before the visible lines are checked.
const CHECK_DELAY_SECONDS: f64 = 0.3;
/// Maximum length of prompt input, characters.
const MAX_PROMPT_CHARS: usize = 60;

/// Prompt that is open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Prompt {
    Find,
    ReplaceOld,
    ReplaceNew,
    GoTo,
    Renumber,
}

/// Request whose answer is awaited.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum EditorRequest {
    /// May the text be edited?
    Edit,
    /// May the text of a new program be edited?
    EditNew,
    /// Save the text of this version.
    Save(u64),
}

/// Subject of a question.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum EditorQuestion {
    Conflict,
    Discard,
}

/// State of the page.
#[derive(Debug, Default)]
pub struct ProgramPage {
    document: Document,
    position: listing::ListingPosition,
    clipboard: Option<Rope>,
    editing: bool,
    keyboard_open: bool,
    prompt: Option<Prompt>,
    prompt_text: String,
    pattern: String,
    /// Replacing one by one: the next key decides about this match.
    replacing: bool,
    task: Option<TextTask>,
    asking: PendingRequests<EditorRequest>,
    question: QuestionDialog<EditorQuestion>,
    message: PageMessage,
    last_check: (u64, usize, f64),
    walk: KeyboardFocus,
    /// The keyboard moves over the keys instead of the text.
    keys_focused: bool,
    /// Editing has just begun: the cursor moves to the visible lines.
    editing_began: bool,
    /// Search or keys outside edit mode have moved the cursor: the listing scrolls to it once.
    cursor_moved: bool,
    /// Lines by which the arrow keys of this frame move the cursor outside edit mode.
    cursor_lines: isize,
    /// The lines that were fully visible in the last frame.
    sight: Range<usize>,
    /// A new program that is edited as soon as it is the current one.
    edit_when_current: Option<u32>,
}

impl PageUi for ProgramPage {
    /// A program that was handed over is new: it is edited at once.
    fn open(&mut self, _view: &View<'_>, handed_over: Option<HandOver>) {
        self.edit_when_current = handed_over.and_then(HandOver::program);
    }

    /// Typed text stays; editing must be requested again.
    fn close(&mut self) {
        self.stop_editing();
    }

    fn refusal(&self, lang: Lang) -> Option<(String, String)> {
        self.message.refusal(lang).map(|why| (self.document.rope.to_string(), why))
    }

    fn message(&self, lang: Lang) -> Option<String> {
        self.message.text(lang)
    }

    fn accepts_text(&self) -> bool {
        self.editing || self.prompt.is_some()
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        let PageContext { rect, view, typed, login, out, .. } = ctx;
        self.handle_answers(view, login, out);
        self.sync_with_core(view);
        if self.edit_when_current.take_if(|number| *number == self.document.number).is_some() {
            self.begin_new_program(out);
        }
        if self.document.number == 0 {
            return empty::no_program(view, rect);
        }
        if !self.question.is_open() && !login.is_open() {
            self.handle_typed(view, typed, login, out);
        }
        let (title, rest) = rect.shrink2(vec2(theme::PAD, 6.0)).split_top(32.0);
        let board = if self.keyboard_open { letter_pad::HEIGHT } else { 0.0 };
        let rows = if self.editing && !self.keyboard_open && self.prompt.is_none() { 2.0 } else { 1.0 };
        let (rest, pad) = rest.split_bottom(board);
        let (list, below) = rest.split_bottom(rows * widget::KEYS_HEIGHT + MESSAGE_HEIGHT);
        let list = listing::restart_note(list, view);
        self.title(title, view);
        self.listing(list, view, typed.scroll_pages);
        let (told, keys) = below.split_top(MESSAGE_HEIGHT);
        self.message_line(told, view);
        if let Some(action) = actions::ui(view, keys, self) {
            self.perform(action, view, login, out);
        }
        if self.keyboard_open
            && let Some(letter) = letter_pad::ui(view, pad, &letter_pad::block_layout(view.snapshot.kind))
        {
            self.letter(&letter, out);
        }
        self.run_task(view.ui);
        self.request_check(view.ui, list, out);
        if let Some((about, Some(key))) = self.question.ui(rect, view, &typed.edits) {
            self.answer(about, key, view, out);
        }
    }
}

impl ProgramPage {
    /// The text with its unsaved changes.
    pub const fn text(&self) -> &Rope {
        &self.document.rope
    }

    /// Handles the answers of the core.
    fn handle_answers(&mut self, view: &View<'_>, login: &mut Login, out: &mut Vec<Command>) {
        while let Some(heard) = self.asking.poll_protected(Requester::Editor, view, login) {
            match heard {
                RequestEvent::Unlocked => self.request_edit(EditorRequest::Edit, out),
                RequestEvent::Answer(request @ (EditorRequest::Edit | EditorRequest::EditNew), Ok(_)) => {
                    (self.editing, self.editing_began) = (true, true);
                    self.keyboard_open |= request == EditorRequest::EditNew;
                    self.message.clear();
                    self.position.scroll.user_scrolled = true;
                }
                RequestEvent::Answer(EditorRequest::Save(version), Ok(completion)) => {
                    self.document.mark_saved(version, &completion);
                    self.message.tell(completion.message);
                }
                RequestEvent::Answer(EditorRequest::Save(_), Err(Refusal::Conflict)) => {
                    self.question.ask(EditorQuestion::Conflict, requests::conflict_question());
                }
                RequestEvent::Answer(_, Err(refusal)) => self.message.refuse(refusal.message()),
            }
        }
    }

    /// Shows the core's text until it is edited here; keeps an unsaved text whatever program becomes current.
    fn sync_with_core(&mut self, view: &View<'_>) {
        let program = &view.snapshot.program;
        let idle = matches!(view.snapshot.state, RunState::Idle | RunState::Alarm);
        if self.editing && (view.snapshot.mode != Mode::Edit || !idle) {
            self.stop_editing();
        }
        let same = (program.number, program.stamp) == (self.document.number, self.document.base);
        if same && program.text.is_instance(&self.document.rope) || self.document.changed {
            return;
        }
        if same && self.document.version > 0 {
            // The saved text comes back from the disk unchanged; keep the undo history.
            return;
        }
        let (line, other) = (self.document.cursor_position().0, program.number != self.document.number);
        self.document = Document::open(program.number, program.stamp, &program.text);
        self.document.move_to(if other { 0 } else { line }, 0);
        self.task = None;
        if other {
            self.stop_editing();
            self.position = listing::ListingPosition::default();
        }
    }

    fn stop_editing(&mut self) {
        (self.editing, self.keyboard_open, self.replacing, self.keys_focused) = (false, false, false, false);
        (self.prompt, self.task, self.document.block_anchor) = (None, None, None);
        self.position.first_column = 0;
    }

    /// Opens a new program for editing: the cursor in its empty line, the letter pad open.
    fn begin_new_program(&mut self, out: &mut Vec<Command>) {
        let lines = self.document.lines();
        let empty = (0..lines).find(|line| content_len(self.document.rope.line(*line)) == 0);
        self.document.move_to(empty.unwrap_or(0), 0);
        self.request_edit(EditorRequest::EditNew, out);
    }

    fn request_edit(&mut self, why: EditorRequest, out: &mut Vec<Command>) {
        let request = FileRequest::CheckEditable(self.document.number);
        out.push(self.asking.send(Requester::Editor, why, request));
    }

    fn save(&mut self, force: bool, out: &mut Vec<Command>) {
        let (number, text, base) = (self.document.number, self.document.rope.clone(), self.document.base);
        let request = FileRequest::Save { number, text, base_stamp: base, overwrite: force };
        out.push(self.asking.send(Requester::Editor, EditorRequest::Save(self.document.version), request));
    }

    /// Handles a key of a question other than 取消, by its index.
    fn answer(&mut self, about: EditorQuestion, key: usize, view: &View<'_>, out: &mut Vec<Command>) {
        let program = &view.snapshot.program;
        match (about, key) {
            (EditorQuestion::Conflict, requests::OVERWRITE_KEY) => self.save(true, out),
            (EditorQuestion::Conflict, _) => {
                self.document = Document::open(program.number, program.stamp, &program.text);
                self.message.tell(requests::READ_FROM_DISK);
            }
            (EditorQuestion::Discard, _) => {
                self.document = Document::open(program.number, program.stamp, &program.text);
                self.stop_editing();
            }
        }
    }

    /// Handles keyboard input.
    fn handle_typed(&mut self, view: &View<'_>, typed: &KeyboardInput, login: &mut Login, out: &mut Vec<Command>) {
        for control in &typed.ctrl_keys {
            if let Some(action) = actions::from_shortcut(*control) {
                self.perform(action, view, login, out);
            }
        }
        if self.keys_focused {
            self.walk.begin_frame(&typed.edits);
        } else if !self.editing && self.prompt.is_none() {
            // Up and down move the cursor in the text, the other keys walk over the keys below it.
            let of_keys = |edit: &EditKey| !matches!(edit, EditKey::Up | EditKey::Down);
            self.walk.begin_frame(&typed.edits.iter().copied().filter(of_keys).collect::<Vec<_>>());
        } else {
            self.walk.begin_frame(&[]);
        }
        let text = self.prompt.is_some() || (self.editing && !self.keys_focused);
        if !text && typed.text.contains('/') {
            self.perform(EditorAction::Find, view, login, out);
        } else if !text && !self.editing && typed.text.contains(|sign: char| !sign.is_control() && sign != ' ') {
            self.message.refuse(actions::EDIT_FIRST);
        }
        for typed in &typed.in_order {
            match *typed {
                TypedInput::Char(sign) if text => self.type_char(sign),
                TypedInput::Char(_) => {}
                TypedInput::Key(EditKey::Next | EditKey::Previous) if self.editing && self.prompt.is_none() => {
                    self.keys_focused = !self.keys_focused;
                    self.walk.select(0, 1);
                }
                TypedInput::Key(EditKey::Cancel) if self.keys_focused => self.keys_focused = false,
                TypedInput::Key(edit) if text => self.edit(edit, out),
                TypedInput::Key(EditKey::Cancel) => self.message.clear(),
                TypedInput::Key(EditKey::Up) if !self.editing => self.cursor_lines -= 1,
                TypedInput::Key(EditKey::Down) if !self.editing => self.cursor_lines += 1,
                TypedInput::Key(_) => {}
            }
        }
    }

    fn type_char(&mut self, sign: char) {
        self.message.clear();
        if self.prompt.is_some() {
            if self.prompt_text.chars().count() < MAX_PROMPT_CHARS {
                self.prompt_text.extend(sign.to_uppercase());
            }
        } else if self.editing && self.task.is_none() {
            self.document.insert_char(sign);
            self.follow_cursor();
        }
    }

    fn letter(&mut self, letter: &LetterKey, out: &mut Vec<Command>) {
        // The letter pad always types into the text, even while Tab has moved to the keys.
        self.keys_focused = false;
        match letter {
            LetterKey::Char(sign) => self.type_char(*sign),
            LetterKey::Word(word) => word.chars().for_each(|sign| self.type_char(sign)),
            LetterKey::Backspace => self.edit(EditKey::Backspace, out),
            LetterKey::Done => self.edit(EditKey::Enter, out),
        }
    }

    /// Applies an edit to the text or to the prompt.
    fn edit(&mut self, edit: EditKey, out: &mut Vec<Command>) {
        if self.prompt.is_some() {
            match edit {
                EditKey::Backspace | EditKey::Delete => drop(self.prompt_text.pop()),
                EditKey::Enter => self.accept_prompt(),
                EditKey::Cancel => (self.prompt, self.keyboard_open) = (None, self.keyboard_open && self.editing),
                _ => {}
            }
            return;
        }
        self.message.clear();
        if self.task.is_some() {
            if edit == EditKey::Cancel {
                self.task = None;
                out.push(file_command(Requester::Editor, FileRequest::Cancel));
            }
            return;
        }
        match edit {
            EditKey::Cancel => (self.document.block_anchor, self.replacing) = (None, false),
            edit if self.document.edit(edit) => {}
            _ => return,
        }
        self.follow_cursor();
    }

    /// Scrolls to the cursor; outside edit mode it stays there until the running block changes.
    const fn reveal_cursor(&mut self) {
        (self.position.scroll.user_scrolled, self.cursor_moved) = (false, !self.editing);
    }

    const fn follow_cursor(&mut self) {
        self.position.scroll.user_scrolled = false;
    }

    fn title(&self, rect: Rect, view: &View<'_>) {
        let program = &view.snapshot.program;
        let document = &self.document;
        let (line, column) = document.cursor_position();
        let at_cursor = self.editing || self.shows_cursor_line(view);
        let line = if at_cursor { line + 1 } else { program.line as usize };
        let place = if self.editing {
            format!("{} {line}:{} / {}", view.text("行", "line"), column + 1, document.lines())
        } else {
            format!("{} {line} / {}", view.text("行", "line"), document.lines())
        };
        let right = view.line_right(rect, &place, theme::LABEL, view.theme.muted);
        let name = lines::title(view, rect.with_max_x(rect.min.x + 240.0), &view.snapshot.title(document.number));
        let mut left = (rect.min.x + 92.0).max(name.max.x + theme::PAD);
        let state = if document.changed {
            Some((view.text("未保存", "not saved"), view.theme.hold))
        } else if self.editing {
            Some((view.text("编辑", "editing"), view.theme.info))
        } else {
            None
        };
        if let Some((words, ink)) = state {
            left = view.line_left(rect.with_min_x(left), words, theme::LABEL, ink).max.x + theme::PAD;
        }
        if program.in_subprogram() {
            let name = view.snapshot.title(program.block_program);
            let words = format!("{} {name}", view.text("正在执行子程序", "running subprogram"));
            let place = Rect::from_min_max(pos2(left, rect.min.y), pos2(right.min.x - theme::PAD, rect.max.y));
            view.fit_left(place, &words, theme::LABEL, view.theme.info);
        }
    }

    fn listing(&mut self, rect: Rect, view: &View<'_>, pages: i32) {
        view.card(rect);
        if self.editing {
            view.outline(rect, view.theme.focus);
        }
        let program = &view.snapshot.program;
        let list = round_to_lines(rect.shrink2(vec2(3.0, 4.0)), LINE_HEIGHT);
        let count = self.document.lines();
        let current = program.number == self.document.number && program.is_own_line();
        if !self.editing && program.line != self.position.followed_line && current {
            self.position.followed_line = program.line;
            self.position.scroll.user_scrolled = program.line == 0;
        }
        let followed = (program.line as usize).checked_sub(1).filter(|_| current);
        self.move_by_keys(view, list, pages, followed);
        if std::mem::take(&mut self.editing_began) {
            self.move_cursor_into_view(self.position.scroll.visible_lines(list, LINE_HEIGHT), followed);
        }
        if !self.position.scroll.user_scrolled {
            self.scroll_to_followed(view.ui, list, followed);
        }
        let rope = self.document.rope.clone();
        let spec = ScrollList { id: "listing", rect: list, row: LINE_HEIGHT, gap: 0.0, count };
        let (clipped, rows, tapped) = self.position.handle_input(view, &spec, &rope, listing::NUMBER_WIDTH);
        if let Some((line, column)) = tapped {
            self.document.move_to(line, column);
            self.keys_focused = false;
            self.message.clear();
        }
        self.sight = self.position.scroll.visible_lines(list, LINE_HEIGHT);
        self.paint_lines(&clipped, rows, current);
    }

    /// Paints the visible lines; `current`: the running line belongs to this text.
    fn paint_lines(&self, view: &View<'_>, rows: VisibleRows, current: bool) {
        let (line, column) = self.document.cursor_position();
        let (block, rope) = (self.document.block(), &self.document.rope);
        let running = current && !self.document.changed;
        let restart = view.snapshot.restart.as_ref().filter(|restart| restart.program == self.document.number);
        for (row, place) in rows {
            let mark = LineMarks {
                running: running && row + 1 == view.snapshot.program.line as usize,
                block: block.is_some_and(|(from, to)| (from..to).contains(&row)),
                faulty: self.fault_in_line(view, row).is_some(),
                cursor: (self.editing && row == line).then_some(column),
                chosen: self.shows_cursor_line(view) && row == line,
                restart: restart.is_some_and(|restart| row + 1 == restart.line as usize),
            };
            self.position.paint_line(view, place, rope, row, mark);
        }
    }

    /// Whether the cursor's line is framed: outside edit mode, unless a run moves through the text.
    const fn shows_cursor_line(&self, view: &View<'_>) -> bool {
        let still =
            matches!(view.snapshot.state, RunState::Idle | RunState::Alarm | RunState::Held | RunState::Stopped);
        still && !self.editing
    }

    /// Moves the cursor by the arrow keys and by pages; while a run moves through the text, pages scroll it.
    fn move_by_keys(&mut self, view: &View<'_>, list: Rect, pages: i32, running: Option<usize>) {
        let page = (list.height() / LINE_HEIGHT) as isize - 1;
        let by = pages as isize * page + std::mem::take(&mut self.cursor_lines);
        if by == 0 {
            return;
        }
        if self.editing {
            self.document.move_lines(by);
            self.follow_cursor();
        } else if self.shows_cursor_line(view) {
            let sight = self.position.scroll.visible_lines(list, LINE_HEIGHT);
            if sight.contains(&self.document.cursor_position().0) {
                self.document.move_lines(by);
            } else {
                self.move_cursor_into_view(sight, running);
            }
            self.message.clear();
            self.reveal_cursor();
        } else if pages != 0 {
            self.position.scroll.scroll_pages(pages, list, LINE_HEIGHT);
        }
    }

    /// Scrolls to the cursor while the text is edited or after a search, else to the running line.
    fn scroll_to_followed(&mut self, ui: &Ui, list: Rect, running: Option<usize>) {
        let (line, column) = self.document.cursor_position();
        let searched = std::mem::take(&mut self.cursor_moved);
        let followed = running.filter(|_| !searched && !self.editing).unwrap_or(line);
        self.position.scroll.user_scrolled = searched;
        self.position.scroll.scroll_to(followed, list, LINE_HEIGHT);
        let room = list.width() - listing::NUMBER_WIDTH;
        self.position.follow_cursor(ui.painter(), &self.document.rope, (line, column), room);
    }

    /// Moves a hidden cursor to the running line, else to the first visible one.
    fn move_cursor_into_view(&mut self, sight: Range<usize>, running: Option<usize>) {
        if !sight.contains(&self.document.cursor_position().0) {
            self.document.move_to(running.filter(|line| sight.contains(line)).unwrap_or(sight.start), 0);
        }
    }

    /// The error in a line of the present text.
    fn fault_in_line<'v>(&self, view: &View<'v>, row: usize) -> Option<&'v LocalizedText> {
        let looked = &view.snapshot.files.line_check;
        let ours = self.editing && looked.token == self.text_token() || !self.editing && !self.document.changed;
        let fault = looked.faults.iter().find(|fault| fault.line as usize == row + 1);
        fault.filter(|_| ours && looked.token >> 32 == u64::from(self.document.number)).map(|fault| &fault.message)
    }

    /// Identifies this text in the answers to check requests.
    fn text_token(&self) -> u64 {
        u64::from(self.document.number) << 32 | (self.document.version & 0xFFFF_FFFF)
    }

    /// Message line: prompt, message or progress, error in the cursor's line, encoding, unsaved program.
    fn message_line(&self, rect: Rect, view: &View<'_>) {
        let row = rect.trim_sides(4.0);
        let line = self.document.cursor_position().0;
        let (words, ink) = if let Some(ask) = self.prompt {
            let what = match ask {
                Prompt::Find => view.text("查找：", "find:"),
                Prompt::ReplaceOld => view.text("替换，原文：", "replace, old:"),
                Prompt::ReplaceNew => view.text("替换，新文：", "replace, new:"),
                Prompt::GoTo => view.text("定位到行号或 N：", "go to line or N:"),
                Prompt::Renumber => view.text("重排段号，起始 步长：", "renumber, first and step:"),
            };
            (format!("{what} {}_", self.prompt_text), view.theme.info)
        } else if let Some(shown) = self.message.shown(view, view.theme.text) {
            shown
        } else if let Some(message) = self.fault_in_line(view, line) {
            (message.get(view.lang).into_owned(), view.theme.alarm_text)
        } else if view.snapshot.program.has_invalid_bytes && !self.document.changed {
            let words = view.text(
                "文件含有不是 GBK 或 UTF-8 的字节：只能查看，请在电脑上另存",
                "bytes that are neither GBK nor UTF-8: view only, save it again on a computer",
            );
            (words.to_owned(), view.theme.hold)
        } else if self.document.changed && self.document.number != view.snapshot.program.number {
            let words = view.text("这是未保存的程序，不是当前程序", "this is the unsaved program, not the current one");
            (words.to_owned(), view.theme.hold)
        } else if self.document.changed && !self.editing {
            (UNSAVED.get(view.lang).to_owned(), view.theme.hold)
        } else if let Some(words) = self.start_hint(view) {
            (words, view.theme.muted)
        } else {
            return;
        };
        view.fit_left(row, &words, theme::LABEL, ink);
    }

    /// Requests a syntax check of the visible lines after a pause in typing.
    fn request_check(&mut self, ui: &Ui, list: Rect, out: &mut Vec<Command>) {
        if !self.editing || self.task.is_some() {
            return;
        }
        let first = self.position.scroll.top as usize;
        let now = ui.input(|input| input.time);
        let (version, at, since) = self.last_check;
        if (version, at) != (self.document.version, first) {
            self.last_check = (self.document.version, first, now);
            ui.ctx().request_repaint_after(std::time::Duration::from_secs_f64(CHECK_DELAY_SECONDS + 0.01));
            return;
        }
        if since < 0.0 || now - since < CHECK_DELAY_SECONDS {
            return;
        }
        self.last_check.2 = -1.0;
        let count = ((list.height() / LINE_HEIGHT) as usize + 2).min(MAX_CHECKED_LINES);
        let end = (first + count).min(self.document.lines());
        let mut text = String::new();
        for line in first..end {
            let slice = self.document.rope.line(line);
            text.extend(slice.slice(..content_len(slice).min(MAX_CHECKED_CHARS)).chars());
            text.push('\n');
        }
        let (number, token) = (self.document.number, self.text_token());
        let request = FileRequest::CheckLines { number, first_line: first as u32 + 1, text, token };
        out.push(file_command(Requester::Editor, request));
    }

    /// Whether a key is on, and whether it is locked.
    fn look_of(&self, action: EditorAction) -> (bool, bool) {
        let (undo, redo) = self.document.can_undo_redo();
        let on = (action == EditorAction::Keyboard && self.keyboard_open)
            || (action == EditorAction::Save && self.document.changed);
        let locked = match action {
            EditorAction::Undo => !undo,
            EditorAction::Redo => !redo,
            EditorAction::Paste => self.clipboard.is_none(),
            _ => false,
        };
        (on, locked)
    }
}
