//! Program directory: every program with size, comment and date, and a search. A touch selects a program, the key 装入
//! loads it; the keys below act on the selected one. A new program is loaded and opened for editing.
//! Source: spec B6. A swipe scrolls and never loads (H9).

mod list;

use egui::Rect;

use super::{HandOver, InputPrompt, PageContext, PageUi, input_line};
use crate::defs::key::Mode;
use crate::defs::page::Page;
use crate::defs::text::{Lang, LocalizedText, Template, Text, phrase};
use crate::defs::{param, program_number};
use crate::hmi::widget::page_keys;
use crate::hmi::{
    Area, EditKey, FieldEditor, KeyboardFocus, KeyboardInput, LetterKey, Login, PageKey, PageMessage, PendingRequests,
    Question, QuestionDialog, Search, View, letter_pad, theme, widget,
};
use crate::link::Command;
use crate::link::files::{FileRequest, Refusal, Requester};
use crate::link::page_command::PasswordScope;
use crate::link::screens::PROGRAMS_WITH_PAGE;
use crate::link::snapshot::RunState;
use list::ProgramList;

/// Why a program cannot be made, copied, renamed or deleted now.
/// What is asked before a program is deleted: its name, and its title.
const DELETED: &Template = &Template::new(
    "{name} {title}\n删除后不能恢复，除非有备份。",
    "{name} {title}\nIt can be restored only from a backup.",
    &["name", "title"],
);
const EDIT_MODE: Text = Text::new("先按面板上的 编辑 键", "press EDIT on the panel first");
/// Maximum length of a search, characters.
const MAX_SEARCH_CHARS: usize = 20;

page_keys! {
    /// Actions on a program.
    DirectoryAction {
        New = "program-new", "新建", "NEW";
        Copy = "program-copy", "复制", "COPY";
        Rename = "program-rename", "改号", "RENAME";
        Delete = "program-delete", "删除", "DELETE";
    }
}
const ACTIONS: [DirectoryAction; 4] =
    [DirectoryAction::New, DirectoryAction::Copy, DirectoryAction::Rename, DirectoryAction::Delete];

/// State of the page.
#[derive(Debug, Default)]
pub struct DirectoryPage {
    list: ProgramList,
    /// The action whose program number is being typed.
    action: Option<DirectoryAction>,
    /// The number being typed.
    typing: FieldEditor,
    question: QuestionDialog<()>,
    /// Request that waits for an answer or for the password.
    request: Option<FileRequest>,
    awaiting_password: bool,
    asking: PendingRequests<()>,
    walk: KeyboardFocus,
    keys_focused: bool,
    message: PageMessage,
}

impl PageUi for DirectoryPage {
    /// Selects the program that was handed over, else the current one, and scrolls to it; every program is shown.
    fn open(&mut self, view: &View<'_>, handed_over: Option<HandOver>) {
        self.list.select(handed_over.and_then(HandOver::program).unwrap_or(view.snapshot.program.number));
        self.list.search = Search::default();
        (self.request, self.keys_focused) = (None, false);
        self.message.clear();
        self.question.close();
        self.close_line();
    }

    fn typing(&self) -> Option<&FieldEditor> {
        Some(&self.typing)
    }

    fn wants_pad(&self, _view: &View<'_>) -> bool {
        self.action.is_some() && self.typing.pad_open
    }

    fn refusal(&self, lang: Lang) -> Option<(String, String)> {
        let typed = self.typing.refusal(lang).map(|why| (self.typing.text.clone(), why.into_owned()));
        typed.or_else(|| Some((String::new(), self.message.refusal(lang)?)))
    }

    fn accepts_text(&self) -> bool {
        self.list.search.open
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        let PageContext { rect, view, typed, login, hand_over, out, .. } = ctx;
        if let Some(number) = self.handle_answer(view, login, out) {
            *hand_over = Some(HandOver::Program(number));
            out.extend([Command::LoadProgram(number), Command::OpenPage(Page::Program)]);
        }
        self.list.update(&view.snapshot.directory);
        let free = !self.question.is_open() && !login.is_open();
        let edits = if free { self.handle_typed(typed, out) } else { Vec::new() };
        let pad = letter_pad::PROGRAM_SEARCH_LAYOUT;
        let below = if self.list.search.open { letter_pad::HEIGHT } else { widget::KEYS_HEIGHT };
        let (body, below) = rect.split_bottom(below + theme::GAP);
        let (header, list) = body.shrink(theme::PAD).split_top(list::HEADER_HEIGHT);
        let pressed = view.ui.input(|input| input.pointer.any_pressed());
        if pressed || view.snapshot.mode == Mode::Edit || !typed.edits.is_empty() {
            self.message.clear();
        }
        if self.list.header(header, view, &self.message) {
            self.close_line();
        }
        let pages = if free { typed.scroll_pages } else { 0 };
        let load = self.list.ui(list, view, pages) || edits.contains(&EditKey::Enter) && !self.keys_focused;
        if let Some(row) = self.list.selected().filter(|_| load) {
            out.push(Command::LoadProgram(row.number));
            // The page where its values are entered comes next.
            if PROGRAMS_WITH_PAGE.contains(&row.number)
                && matches!(view.snapshot.state, RunState::Idle | RunState::Alarm)
            {
                out.push(Command::OpenPage(Page::Grinding));
            }
        }
        if self.list.search.open {
            if let Some(letter) = letter_pad::ui(view, below.trim_sides(theme::GAP).trim_bottom(theme::GAP), &pad) {
                self.list.search.handle_letter(&letter, MAX_SEARCH_CHARS);
            }
        } else if self.keys(below.trim_sides(theme::PAD), view, &edits) {
            *hand_over = self.list.selected().map(|row| HandOver::Program(row.number));
            out.push(Command::OpenPage(Page::Designer));
        }
        match self.question.ui(rect, view, &typed.edits) {
            Some(((), Some(_))) => self.send(out),
            Some(((), None)) => self.request = None,
            None => {}
        }
    }
}

impl DirectoryPage {
    fn send(&mut self, out: &mut Vec<Command>) {
        if let Some(request) = &self.request {
            out.push(self.asking.send(Requester::Directory, (), request.clone()));
        }
    }

    /// Handles the answer: done, password needed, or refused. Returns the number of a new program, which is loaded and
    /// opened.
    fn handle_answer(&mut self, view: &View<'_>, login: &mut Login, out: &mut Vec<Command>) -> Option<u32> {
        if self.awaiting_password && !login.is_open() {
            self.awaiting_password = false;
            if view.snapshot.access.program_unlocked { self.send(out) } else { self.request = None }
        }
        let answer = self.asking.poll(Requester::Directory, &view.snapshot.files).filter(|_| self.request.is_some());
        match answer?.1 {
            Err(Refusal::Password) => {
                self.awaiting_password = true;
                login.unlock(view, PasswordScope::Program);
                None
            }
            Err(refusal) => {
                // The number stays with the reason, to be corrected.
                self.action = match self.request.take() {
                    Some(FileRequest::New(_)) => Some(DirectoryAction::New),
                    Some(FileRequest::Copy { .. }) => Some(DirectoryAction::Copy),
                    Some(FileRequest::Rename { .. }) => Some(DirectoryAction::Rename),
                    _ => Some(DirectoryAction::Delete),
                };
                self.typing.refused = Some(refusal.message());
                None
            }
            Ok(_) => {
                self.close_line();
                let request = self.request.take()?;
                if let FileRequest::New(to) | FileRequest::Copy { to, .. } | FileRequest::Rename { to, .. } = request {
                    self.list.expect(to);
                }
                if let FileRequest::New(number) = request { Some(number) } else { None }
            }
        }
    }

    /// Handles the keyboard for the number being typed and for the search; returns the keys that are left for the list
    /// and for the keys below it.
    fn handle_typed(&mut self, typed: &KeyboardInput, out: &mut Vec<Command>) -> Vec<EditKey> {
        if self.action.is_some() {
            typed.edits.iter().for_each(|edit| self.edit(*edit, out));
            return Vec::new();
        }
        let search = &mut self.list.search;
        if !search.open && typed.text.starts_with(|sign: char| sign == '/' || sign.is_alphanumeric()) {
            search.open = true;
            search.text.clear();
        }
        let mut left = Vec::new();
        if !search.open {
            left.clone_from(&typed.edits);
        } else {
            for sign in typed.text.chars().filter(|sign| *sign != '/' && !sign.is_control()) {
                search.handle_letter(&LetterKey::Char(sign), MAX_SEARCH_CHARS);
            }
            for edit in &typed.edits {
                match edit {
                    EditKey::Char(_) | EditKey::Sign => {}
                    EditKey::Backspace | EditKey::Delete => drop(search.text.pop()),
                    EditKey::Enter => search.open = false,
                    EditKey::Cancel => *search = Search::default(),
                    _ => left.push(*edit),
                }
            }
        }
        if left.iter().any(|edit| matches!(edit, EditKey::Right | EditKey::Left)) {
            self.keys_focused = true;
        } else if left.iter().any(|edit| matches!(edit, EditKey::Up | EditKey::Down | EditKey::Cancel)) {
            self.keys_focused = false;
        }
        if !self.keys_focused {
            self.list.handle_keys(&left);
        }
        left
    }

    fn edit(&mut self, edit: EditKey, out: &mut Vec<Command>) {
        match edit {
            EditKey::Cancel => self.close_line(),
            EditKey::Enter => self.enter(out),
            _ => drop(self.typing.handle_key(edit)),
        }
    }

    /// Sends the request for the typed number.
    fn enter(&mut self, out: &mut Vec<Command>) {
        let request: fn(u32, u32) -> FileRequest = match self.action {
            Some(DirectoryAction::New) => |_, to| FileRequest::New(to),
            Some(DirectoryAction::Copy) => |from, to| FileRequest::Copy { from, to },
            Some(DirectoryAction::Rename) => |from, to| FileRequest::Rename { from, to },
            // A refused deletion takes no number: INPUT closes its line.
            Some(DirectoryAction::Delete) | None => return self.close_line(),
        };
        let from = self.list.selected().map_or(0, |row| row.number);
        match self.typing.text.parse::<u32>() {
            Ok(to) if program_number::is_o_number(to) => {
                self.request = Some(request(from, to));
                self.send(out);
            }
            Ok(_) | Err(_) => {
                let message = phrase!("程序号为 1 到 8 位数字", "a program number has 1 to 8 digits");
                self.typing.refused = Some(message);
            }
        }
    }

    /// Closes the line of the program number.
    fn close_line(&mut self) {
        (self.action, self.typing) = (None, FieldEditor::default());
    }

    fn begin_action(&mut self, action: DirectoryAction) {
        self.list.reveal();
        let chosen = self.list.selected();
        if let (DirectoryAction::Delete, Some(row)) = (action, chosen) {
            let (number, name) = (row.number, &row.name);
            let comment = LocalizedText::new(&*row.comment, row.comment_in(Lang::En));
            let body = LocalizedText::phrase_of(DELETED, [name.into()], [comment]);
            self.request = Some(FileRequest::Delete(number));
            let key = ("question-delete", Text::new("删除", "DELETE"));
            self.question.ask((), Question::new(Text::new("删除程序？", "delete the program?"), body, key));
            return;
        }
        self.action = Some(action).filter(|_| chosen.is_some() || action == DirectoryAction::New);
        self.typing = FieldEditor::default();
        self.typing.pad_open = true;
    }

    /// The keys below, or the input line of the number; true when the page of the program is to be designed.
    fn keys(&mut self, rect: Rect, view: &View<'_>, edits: &[EditKey]) -> bool {
        if let Some(action) = self.action {
            let what = match action {
                DirectoryAction::New => view.text("新程序号 O", "new program O"),
                DirectoryAction::Copy => view.text("复制为 O", "copy to O"),
                DirectoryAction::Rename => view.text("改为 O", "rename to O"),
                DirectoryAction::Delete => view.text("删除", "delete"),
            };
            // A new program has nothing to do with the selected one.
            let from = self.list.selected().filter(|_| action != DirectoryAction::New);
            let name = from.map_or_else(String::new, |row| row.name.clone());
            let most = program_number::o_limit(view.snapshot.params.get(param::PROGRAM_DIGITS) as u32);
            let told = InputPrompt { label: what, name: &name, range: &format!("1 … {most}") };
            input_line::ui(view, rect.band(0.0, theme::INPUT), &self.typing, &told);
            return false;
        }
        self.walk.begin_frame(if self.keys_focused { edits } else { &[] });
        let has_pages = Page::Designer.exists_on(view.snapshot.kind);
        let (row, count) = (rect.trim_bottom(theme::GAP), ACTIONS.len() + usize::from(has_pages));
        let locked = view.snapshot.mode != Mode::Edit;
        for (index, action) in ACTIONS.into_iter().enumerate() {
            let key = PageKey::new(action.id(), action.label().get(view.lang)).locked(locked);
            if self.walk.button(view, row.cell(index, count), key) {
                if locked {
                    self.message.refuse(EDIT_MODE);
                } else {
                    self.begin_action(action);
                }
            }
        }
        let key = PageKey::new("design-page", view.text("页面设计", "PAGE"));
        has_pages && self.walk.button(view, row.cell(ACTIONS.len(), count), key)
    }
}
