//! Program page: listing with the running block marked, and the editor in mode EDIT. A text of a million lines stays
//! responsive: it is shared with the core, only visible lines are laid out, and whole-text work is done in slices.
//! Source: spec B6 (程序), K6.2, H6, H8.

mod acts;
pub mod document;
mod ink;
mod keys;
pub mod listing;
mod work;

use egui::{Align2, Id, Rect, Sense, Ui, pos2, vec2};

use super::{Typed, empty};
use crate::defs::key::Mode;
use crate::defs::text::{Said, Text};
use crate::hmi::asking::{self, Guarded, Heard, Why};
use crate::hmi::entry::Edit;
use crate::hmi::letters::{self, Letter};
use crate::hmi::login::Login;
use crate::hmi::question::Asked;
use crate::hmi::view::{View, card, fit, frame, put};
use crate::hmi::widget::{Look, Walk, whole_lines};
use crate::hmi::{frame as lines, pictogram, theme};
use crate::link::Command;
use crate::link::files::{Asker, FileRequest, LOOKED_CHARS, LOOKED_LINES, Refusal, Ticket};
use crate::link::page_command::PageCommand;
use crate::link::snapshot::RunState;
use document::{Document, trimmed};
use keys::Act;
use listing::{LINE, Mark};
use ropey::Rope;
use work::Work;

/// Height of a row of keys.
const KEYS: f32 = 46.0;
/// Height of the message line.
const TOLD: f32 = 28.0;
/// Seconds without typing before the visible lines are checked.
const PAUSE: f64 = 0.3;
/// Maximum length of prompt input, characters.
const ASKED: usize = 60;

/// Prompt that is open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Ask {
    Find,
    ReplaceWhat,
    ReplaceWith,
    Go,
    Renumber,
}

/// Request whose answer is awaited.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Awaited {
    /// May the text be edited?
    Edit,
    /// Save the text of this version.
    Save(u64),
}

impl Why for Awaited {
    const ASKER: Asker = Asker::Editor;
}

/// Subject of a question.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum About {
    Conflict,
    Discard,
}

/// State of the page.
#[derive(Debug, Default)]
pub struct Program {
    document: Document,
    place: listing::Place,
    clip: Option<Rope>,
    editing: bool,
    board: bool,
    ask: Option<Ask>,
    text: String,
    what: String,
    /// Replacing one by one: the next key decides about this match.
    replacing: bool,
    work: Option<Work>,
    asking: Guarded<Awaited>,
    question: Asked<About>,
    told: Option<(Said, bool)>,
    looked: (u64, usize, f64),
    walk: Walk,
    /// The keyboard moves over the keys instead of the text.
    on_keys: bool,
    /// Editing has just begun: the cursor moves to the visible lines.
    entered: bool,
}

impl Program {
    /// Why the last request was refused.
    #[must_use]
    pub fn refusal(&self) -> Option<&Said> {
        self.told.as_ref().filter(|(_, refused)| *refused).map(|(said, _)| said)
    }

    /// Whether text is accepted: for the program or for a prompt.
    #[must_use]
    pub const fn takes_words(&self) -> bool {
        self.editing || self.ask.is_some()
    }

    /// The text with its unsaved changes.
    #[must_use]
    pub const fn text(&self) -> &Rope {
        &self.document.rope
    }

    /// The page was opened again: typed text stays, editing must be requested again.
    pub fn open(&mut self) {
        self.stop_editing();
    }

    /// Draws the page.
    pub fn ui(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, typed: &Typed<'_>, login: &mut Login) -> Vec<Command> {
        let mut out = Vec::new();
        self.hear(view, login, &mut out);
        self.follow(view);
        if self.document.number == 0 {
            let remedy = view.say("按“目录”选择一个程序并装入。", "Choose a program in the directory and load it.");
            empty::show(ui, view, rect, pictogram::NO_PAGE, view.say("没有装入程序", "no program is loaded"), remedy);
            return out;
        }
        let free = !self.question.is_open() && !login.is_open();
        if free {
            self.take_typed(view, typed, login, &mut out);
        }
        let inside = rect.shrink2(vec2(theme::PAD, 6.0));
        let (title, rest) = inside.split_top_bottom_at_y(inside.min.y + 32.0);
        let board = if self.board { letters::block(view.snapshot.kind).height() } else { 0.0 };
        let rows = if self.editing && !self.board && self.ask.is_none() { 2.0 } else { 1.0 };
        let (rest, pad) = rest.split_top_bottom_at_y(rest.max.y - board);
        let (list, below) = rest.split_top_bottom_at_y(rest.max.y - rows * KEYS - TOLD);
        self.title(ui, title, view);
        self.list(ui, list, view, typed.pages);
        let (told, keys) = below.split_top_bottom_at_y(below.min.y + TOLD);
        self.told(ui, told, view);
        if let Some(act) = keys::ui(ui, view, keys, self) {
            self.act(act, view, login, &mut out);
        }
        if self.board
            && let Some(letter) = letters::ui(ui, view, pad, &letters::block(view.snapshot.kind))
        {
            self.letter(&letter, &mut out);
        }
        self.go_on(ui);
        self.look(ui, list, &mut out);
        if let Some((about, Some(key))) = self.question.ui(ui, rect, view, typed.edits) {
            self.answer(about, key, view, &mut out);
        }
        out
    }

    /// Handles the answers of the core.
    fn hear(&mut self, view: &View<'_>, login: &mut Login, out: &mut Vec<Command>) {
        while let Some(heard) = self.asking.hear(view, login) {
            match heard {
                Heard::Open => self.wish_edit(out),
                Heard::Answer(Awaited::Edit, Ok(_)) => {
                    (self.editing, self.told, self.entered) = (true, None, true);
                    self.place.scroll.by_hand = true;
                }
                Heard::Answer(Awaited::Save(version), Ok(deed)) => {
                    self.document.hear_saved(version, &deed);
                    self.told = Some((deed.said, false));
                }
                Heard::Answer(Awaited::Save(_), Err(Refusal::Conflict)) => {
                    self.question.ask(About::Conflict, asking::conflict());
                }
                Heard::Answer(Awaited::Edit | Awaited::Save(_), Err(refusal)) => self.refuse(refusal.said()),
            }
        }
    }

    /// Shows the core's text until it is edited here; keeps an unsaved text whatever program becomes current.
    fn follow(&mut self, view: &View<'_>) {
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
        let (line, other) = (self.document.place().0, program.number != self.document.number);
        self.document = Document::open(program.number, program.stamp, &program.text);
        self.document.go(if other { 0 } else { line }, 0);
        self.work = None;
        if other {
            self.stop_editing();
            self.place = listing::Place::default();
        }
    }

    fn stop_editing(&mut self) {
        (self.editing, self.board, self.replacing, self.on_keys) = (false, false, false, false);
        (self.ask, self.work, self.document.mark) = (None, None, None);
        self.place.left = 0;
    }

    fn refuse(&mut self, why: impl Into<Said>) {
        self.told = Some((why.into(), true));
    }

    fn wish_edit(&mut self, out: &mut Vec<Command>) {
        out.push(self.asking.ask(Awaited::Edit, FileRequest::MayEdit(self.document.number)));
    }

    fn save(&mut self, force: bool, out: &mut Vec<Command>) {
        let (number, text, base) = (self.document.number, self.document.rope.clone(), self.document.base);
        let request = FileRequest::Save { number, text, base, force };
        out.push(self.asking.ask(Awaited::Save(self.document.version), request));
    }

    /// Handles a key of a question other than 取消, by its index.
    fn answer(&mut self, about: About, key: usize, view: &View<'_>, out: &mut Vec<Command>) {
        let program = &view.snapshot.program;
        match (about, key) {
            (About::Conflict, asking::OVERWRITE) => self.save(true, out),
            (About::Conflict, _) => {
                self.document = Document::open(program.number, program.stamp, &program.text);
                self.told = Some((Text::new("已读磁盘上的文件", "read from the disk").into(), false));
            }
            (About::Discard, _) => {
                self.document = Document::open(program.number, program.stamp, &program.text);
                self.stop_editing();
            }
        }
    }

    /// Handles keyboard input.
    fn take_typed(&mut self, view: &View<'_>, typed: &Typed<'_>, login: &mut Login, out: &mut Vec<Command>) {
        for control in typed.controls {
            if let Some(act) = keys::of_control(*control) {
                self.act(act, view, login, out);
            }
        }
        if self.on_keys || (!self.editing && self.ask.is_none()) {
            self.walk.begin(typed.edits);
        } else {
            self.walk.begin(&[]);
        }
        let text = self.ask.is_some() || (self.editing && !self.on_keys);
        if text {
            typed.text.chars().filter(|sign| !sign.is_control()).for_each(|sign| self.sign(sign));
        } else if typed.text.contains('/') {
            self.act(Act::Find, view, login, out);
        } else if !self.editing && typed.text.contains(|sign: char| !sign.is_control() && sign != ' ') {
            self.refuse(keys::EDIT_FIRST);
        }
        for edit in typed.edits {
            match edit {
                Edit::Next | Edit::Previous if self.editing && self.ask.is_none() => {
                    self.on_keys = !self.on_keys;
                    self.walk.choose(0, 1);
                }
                Edit::Cancel if self.on_keys => self.on_keys = false,
                _ if text => self.edit(*edit, out),
                Edit::Cancel => self.told = None,
                _ => {}
            }
        }
    }

    fn sign(&mut self, sign: char) {
        self.told = None;
        if self.ask.is_some() {
            if self.text.chars().count() < ASKED {
                self.text.extend(sign.to_uppercase());
            }
        } else if self.editing && self.work.is_none() {
            self.document.type_sign(sign);
            self.keep_in_sight();
        }
    }

    fn letter(&mut self, letter: &Letter, out: &mut Vec<Command>) {
        // The letter pad always types into the text, even while Tab has moved to the keys.
        self.on_keys = false;
        match letter {
            Letter::Sign(sign) => self.sign(*sign),
            Letter::Word(word) => word.chars().for_each(|sign| self.sign(sign)),
            Letter::Back => self.edit(Edit::Back, out),
            Letter::Done => self.edit(Edit::Enter, out),
        }
    }

    /// Applies an edit to the text or to the prompt.
    fn edit(&mut self, edit: Edit, out: &mut Vec<Command>) {
        if self.ask.is_some() {
            match edit {
                Edit::Back | Edit::Delete => drop(self.text.pop()),
                Edit::Enter => self.enter(),
                Edit::Cancel => (self.ask, self.board) = (None, self.board && self.editing),
                _ => {}
            }
            return;
        }
        self.told = None;
        if self.work.is_some() {
            if edit == Edit::Cancel {
                self.work = None;
                out.push(Command::Page(PageCommand::File(Ticket::unheard(Asker::Editor), FileRequest::Cancel)));
            }
            return;
        }
        match edit {
            Edit::Cancel => (self.document.mark, self.replacing) = (None, false),
            edit if self.document.edit(edit) => {}
            _ => return,
        }
        self.keep_in_sight();
    }

    const fn keep_in_sight(&mut self) {
        self.place.scroll.by_hand = false;
    }

    fn title(&self, ui: &Ui, rect: Rect, view: &View<'_>) {
        let program = &view.snapshot.program;
        let document = &self.document;
        let (line, column) = document.place();
        let line = if self.editing { line + 1 } else { program.line as usize };
        let place = if self.editing {
            format!("{} {line}:{} / {}", view.say("行", "line"), column + 1, document.lines())
        } else {
            format!("{} {line} / {}", view.say("行", "line"), document.lines())
        };
        let right = put(ui.painter(), rect, Align2::RIGHT_CENTER, &place, theme::LABEL, view.theme.quiet);
        let room = Rect::from_min_max(rect.min, pos2(rect.min.x + 240.0, rect.max.y));
        let name = lines::title(ui, view, room, &view.snapshot.title(document.number));
        let mut left = (rect.min.x + 92.0).max(name.max.x + theme::PAD);
        let state = if document.changed {
            Some((view.say("未保存", "not saved"), view.theme.hold))
        } else if self.editing {
            Some((view.say("编辑", "editing"), view.theme.info))
        } else {
            None
        };
        if let Some((words, ink)) = state {
            let place = Rect::from_min_max(pos2(left, rect.min.y), rect.max);
            left = put(ui.painter(), place, Align2::LEFT_CENTER, words, theme::LABEL, ink).max.x + theme::PAD;
        }
        if listing::in_subprogram(program) {
            let words = format!(
                "{} {}",
                view.say("正在执行子程序", "running subprogram"),
                view.snapshot.title(program.block_program)
            );
            let place = Rect::from_min_max(pos2(left, rect.min.y), pos2(right.min.x - theme::PAD, rect.max.y));
            fit(ui.painter(), place, Align2::LEFT_CENTER, &words, theme::LABEL, view.theme.info);
        }
    }

    fn list(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, pages: i32) {
        card(ui.painter(), rect, view.theme.surface, view.theme.line);
        if self.editing {
            frame(ui.painter(), rect, view.theme.focus);
        }
        let program = &view.snapshot.program;
        let list = whole_lines(rect.shrink2(vec2(3.0, 4.0)), LINE);
        let count = self.document.lines();
        let current = program.number == self.document.number && !listing::in_subprogram(program);
        if !self.editing && program.line != self.place.line && current {
            self.place.line = program.line;
            self.place.scroll.by_hand = program.line == 0;
        }
        if pages != 0 {
            if self.editing {
                let by = pages as isize * ((list.height() / LINE) as isize - 1);
                self.document.step_lines(by);
                self.keep_in_sight();
            } else {
                self.place.scroll.page(pages, list, LINE);
            }
        }
        if std::mem::take(&mut self.entered) {
            let running = (program.line as usize).checked_sub(1).filter(|_| current);
            self.come_into_sight(self.place.scroll.lines(list, LINE), running);
        }
        let (line, column) = self.document.place();
        if !self.place.scroll.by_hand {
            let followed = if self.editing || !current || program.line == 0 { line } else { program.line as usize - 1 };
            self.place.scroll.show(followed, list, LINE);
            let room = list.width() - listing::NUMBER;
            self.place.follow_cursor(ui.painter(), &self.document.rope, (line, column), room);
        }
        let tap = ui.interact(list, Id::unique("listing-tap"), Sense::CLICK);
        let (first, last) = self.place.scroll.follow(ui, "listing", list, LINE, count);
        self.place.drag(ui, "listing", &self.document.rope, first..last.min(count));
        if tap.clicked()
            && let Some(at) = tap.interact_pointer_pos()
        {
            self.touch(ui, view, list, at);
        }
        let block = self.document.block();
        let idle = matches!(view.snapshot.state, RunState::Idle | RunState::Alarm);
        let running = current && !self.document.changed;
        let painter = &ui.painter().with_clip_rect(list);
        for row in first..last.min(count) {
            let top = list.min.y + ((row as f64 - self.place.scroll.top) * f64::from(LINE)) as f32;
            let place = Rect::from_min_size(pos2(list.min.x, top), vec2(list.width() - 8.0, LINE));
            let mark = Mark {
                running: running && row + 1 == program.line as usize,
                block: block.is_some_and(|(from, to)| (from..to).contains(&row)),
                wrong: self.fault(view, row).is_some(),
                cursor: (self.editing && row == line).then_some(column),
                chosen: idle && !self.editing && row == line,
            };
            listing::row(painter, place, view, &self.document.rope, (row, self.place.left), mark);
        }
        self.place.scroll.bar(ui, view, list, LINE, count);
    }

    /// Moves a hidden cursor to the running line, else to the first visible one.
    fn come_into_sight(&mut self, sight: std::ops::Range<usize>, running: Option<usize>) {
        if !sight.contains(&self.document.place().0) {
            self.document.go(running.filter(|line| sight.contains(line)).unwrap_or(sight.start), 0);
        }
    }

    fn touch(&mut self, ui: &Ui, view: &View<'_>, list: Rect, at: egui::Pos2) {
        let row = (f64::from((at.y - list.min.y) / LINE) + self.place.scroll.top).floor().max(0.0) as usize;
        if row >= self.document.lines() {
            return;
        }
        let x = at.x - list.min.x - listing::NUMBER;
        let column = listing::column_at(ui.painter(), view, &self.document.rope, (row, self.place.left), x);
        self.document.go(row, column);
        self.on_keys = false;
    }

    /// The error in a line of the present text.
    fn fault<'v>(&self, view: &View<'v>, row: usize) -> Option<&'v Said> {
        let looked = &view.snapshot.files.looked;
        let ours = self.editing && looked.token == self.token() || !self.editing && !self.document.changed;
        let fault = looked.faults.iter().find(|fault| fault.line as usize == row + 1);
        fault.filter(|_| ours && looked.token >> 32 == u64::from(self.document.number)).map(|fault| &fault.said)
    }

    /// Identifies this text in the answers to check requests.
    fn token(&self) -> u64 {
        u64::from(self.document.number) << 32 | (self.document.version & 0xFFFF_FFFF)
    }

    /// Message line: prompt, message or progress, error in the cursor's line, encoding, unsaved program.
    fn told(&self, ui: &Ui, rect: Rect, view: &View<'_>) {
        let row = rect.shrink2(vec2(4.0, 0.0));
        let line = self.document.place().0;
        let (words, ink) = if let Some(ask) = self.ask {
            let what = match ask {
                Ask::Find => view.say("查找：", "find:"),
                Ask::ReplaceWhat => view.say("替换，原文：", "replace, old:"),
                Ask::ReplaceWith => view.say("替换，新文：", "replace, new:"),
                Ask::Go => view.say("定位到行号或 N：", "go to line or N:"),
                Ask::Renumber => view.say("重排段号，起始 步长：", "renumber, first and step:"),
            };
            (format!("{what} {}_", self.text), view.theme.info)
        } else if let Some((said, refused)) = &self.told {
            (said.get(view.lang).to_owned(), if *refused { view.theme.alarm_text } else { view.theme.text })
        } else if let Some(said) = self.fault(view, line) {
            (said.get(view.lang).to_owned(), view.theme.alarm_text)
        } else if view.snapshot.program.mistaken && !self.document.changed {
            let words = view.say(
                "文件含有不是 GBK 或 UTF-8 的字节：只能查看，请在电脑上另存",
                "bytes that are neither GBK nor UTF-8: shown only, save it again on a computer",
            );
            (words.to_owned(), view.theme.hold)
        } else if self.document.changed && self.document.number != view.snapshot.program.number {
            let words = view.say("这是未保存的程序，不是当前程序", "this is the unsaved program, not the current one");
            (words.to_owned(), view.theme.hold)
        } else {
            return;
        };
        fit(ui.painter(), row, Align2::LEFT_CENTER, &words, theme::LABEL, ink);
    }

    /// Requests a syntax check of the visible lines after a pause in typing.
    fn look(&mut self, ui: &Ui, list: Rect, out: &mut Vec<Command>) {
        if !self.editing || self.work.is_some() {
            return;
        }
        let first = self.place.scroll.top as usize;
        let now = ui.input(|input| input.time);
        let (version, at, since) = self.looked;
        if (version, at) != (self.document.version, first) {
            self.looked = (self.document.version, first, now);
            ui.ctx().request_repaint_after(std::time::Duration::from_secs_f64(PAUSE + 0.01));
            return;
        }
        let asked = since < 0.0;
        if asked || now - since < PAUSE {
            return;
        }
        self.looked.2 = -1.0;
        let count = ((list.height() / LINE) as usize + 2).min(LOOKED_LINES);
        let end = (first + count).min(self.document.lines());
        let mut text = String::new();
        for line in first..end {
            let slice = self.document.rope.line(line);
            text.extend(slice.slice(..trimmed(slice).min(LOOKED_CHARS)).chars());
            text.push('\n');
        }
        let (number, token) = (self.document.number, self.token());
        let request = FileRequest::Look { number, first: first as u32 + 1, text, token };
        out.push(Command::Page(PageCommand::File(Ticket::unheard(Asker::Editor), request)));
    }

    /// The rows of keys below the listing.
    fn rows(&self) -> [&'static [Act]; 2] {
        if self.ask.is_some() {
            return keys::ASK;
        }
        keys::rows(self.editing, self.board, self.document.mark.is_some(), self.replacing, self.work.is_some())
    }

    fn look_of(&self, act: Act) -> Look {
        let (undo, redo) = self.document.can();
        let on = (act == Act::Board && self.board) || (act == Act::Save && self.document.changed);
        let locked = match act {
            Act::Undo => !undo,
            Act::Redo => !redo,
            Act::Paste => self.clip.is_none(),
            _ => false,
        };
        Look { on, locked }
    }
}
