//! Program directory: every program with size, comment and date. A touch selects a program, the key 装入 loads it.
//! Source: spec B6. A swipe scrolls and never loads (H9).

use egui::accesskit::Role;
use egui::{Id, Rect, Sense, WidgetInfo, vec2};

use super::{InputPrompt, PageContext, PageUi, Scroll, ScrollList, empty, input_line};
use crate::defs::key::Mode;
use crate::defs::page::Page;
use crate::defs::text::{Lang, LocalizedText, Text};
use crate::hmi::widget::page_keys;
use crate::hmi::{
    Area, EditKey, FieldEditor, KeyboardFocus, KeycapState, Login, PageKey, PendingRequests, Question, QuestionDialog,
    View, format_size, keycap, page_frame as lines, pictogram, round_to_lines, theme, widget,
};
use crate::link::Command;
use crate::link::files::{FileRequest, Refusal, Requester};
use crate::link::page_command::PasswordScope;
use crate::link::snapshot::{DirectoryRow, RunState};

/// Height of a row.
const ROW_HEIGHT: f32 = 50.0;

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
    scroll: Scroll,
    cursor: usize,
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
    /// The page was just opened: scroll to the selected row.
    reveal_cursor: bool,
    /// Width of the name column; named programs need more than O and four digits.
    name_width: f32,
}

impl PageUi for DirectoryPage {
    /// Selects the current program and scrolls to it.
    fn open(&mut self, view: &View<'_>, _handed_over: Option<u32>) {
        let number = view.snapshot.program.number;
        self.cursor = view.snapshot.directory.iter().position(|row| row.number == number).unwrap_or(0);
        (self.action, self.request, self.keys_focused, self.reveal_cursor) = (None, None, false, true);
        self.question.close();
        self.typing = FieldEditor::default();
    }

    fn typing(&self) -> Option<&FieldEditor> {
        Some(&self.typing)
    }

    fn wants_pad(&self, _view: &View<'_>) -> bool {
        self.action.is_some() && self.typing.pad_open
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        let PageContext { rect, view, typed, login, hand_over, out, .. } = ctx;
        self.handle_answer(view, login, out);
        let free = !self.question.is_open() && !login.is_open();
        let edits: &[EditKey] = if free { &typed.edits } else { &[] };
        let (body, below) = rect.split_bottom(widget::KEYS_HEIGHT + theme::GAP);
        let typing = self.action.is_some();
        edits.iter().filter(|_| typing).for_each(|edit| self.edit(*edit, view, out));
        let edits = if typing { &[] } else { edits };
        out.extend(self.list(body, view, edits, typed.scroll_pages));
        if self.keys(below.trim_sides(theme::PAD), view, edits) {
            *hand_over = view.snapshot.directory.get(self.cursor).map(|row| row.number);
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

    /// Handles the answer: done, password needed, or refused.
    fn handle_answer(&mut self, view: &View<'_>, login: &mut Login, out: &mut Vec<Command>) {
        if self.awaiting_password && !login.is_open() {
            self.awaiting_password = false;
            if view.snapshot.access.program_unlocked { self.send(out) } else { self.request = None }
        }
        let answer = self.asking.poll(Requester::Directory, &view.snapshot.files).filter(|_| self.request.is_some());
        match answer.map(|((), answer)| answer) {
            None => return,
            Some(Err(Refusal::Password)) => {
                self.awaiting_password = true;
                login.unlock(view, PasswordScope::Program);
                return;
            }
            Some(Err(refusal)) => {
                // The number stays with the reason, to be corrected.
                self.action = match self.request {
                    Some(FileRequest::New(_)) => Some(DirectoryAction::New),
                    Some(FileRequest::Copy { .. }) => Some(DirectoryAction::Copy),
                    Some(FileRequest::Rename { .. }) => Some(DirectoryAction::Rename),
                    _ => Some(DirectoryAction::Delete),
                };
                self.typing.refused = Some(refusal.message());
            }
            Some(Ok(_)) => self.close_line(),
        }
        self.request = None;
    }

    fn edit(&mut self, edit: EditKey, view: &View<'_>, out: &mut Vec<Command>) {
        match edit {
            EditKey::Cancel => self.close_line(),
            EditKey::Enter => self.enter(view, out),
            _ => drop(self.typing.handle_key(edit)),
        }
    }

    /// Sends the request for the typed number.
    fn enter(&mut self, view: &View<'_>, out: &mut Vec<Command>) {
        let request: fn(u32, u32) -> FileRequest = match self.action {
            Some(DirectoryAction::New) => |_, to| FileRequest::New(to),
            Some(DirectoryAction::Copy) => |from, to| FileRequest::Copy { from, to },
            Some(DirectoryAction::Rename) => |from, to| FileRequest::Rename { from, to },
            // A refused deletion takes no number: INPUT closes its line.
            Some(DirectoryAction::Delete) | None => return self.close_line(),
        };
        let from = view.snapshot.directory.get(self.cursor).map_or(0, |row| row.number);
        match self.typing.text.parse::<u32>() {
            Ok(to @ 1..=9_999) => {
                self.request = Some(request(from, to));
                self.send(out);
            }
            Ok(_) | Err(_) => {
                self.typing.refused = Some(LocalizedText::new("程序号应为 1-9999", "program numbers are 1 to 9999"));
            }
        }
    }

    /// Closes the line of the program number.
    fn close_line(&mut self) {
        (self.action, self.typing) = (None, FieldEditor::default());
    }

    fn begin_action(&mut self, action: DirectoryAction, view: &View<'_>) {
        let chosen = view.snapshot.directory.get(self.cursor);
        if let (DirectoryAction::Delete, Some(row)) = (action, chosen) {
            let (number, name) = (row.number, &row.name);
            let body = LocalizedText::new(
                format!("{name} {}\n删除后不能恢复，除非有备份。", row.comment),
                format!("{name} {}\nIt can be restored only from a backup.", row.comment_in(Lang::En)),
            );
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
        if edits.iter().any(|edit| matches!(edit, EditKey::Right | EditKey::Left)) {
            self.keys_focused = true;
        } else if edits.iter().any(|edit| matches!(edit, EditKey::Up | EditKey::Down | EditKey::Cancel)) {
            self.keys_focused = false;
        }
        if let Some(action) = self.action {
            let what = match action {
                DirectoryAction::New => view.text("新程序号 O", "new program O"),
                DirectoryAction::Copy => view.text("复制为 O", "copy to O"),
                DirectoryAction::Rename => view.text("改为 O", "rename to O"),
                DirectoryAction::Delete => view.text("删除", "delete"),
            };
            let name = view.snapshot.directory.get(self.cursor).map_or_else(String::new, |row| row.name.clone());
            let told = InputPrompt { label: what, name: &name, range: "1 … 9999" };
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
                self.begin_action(action, view);
            }
        }
        let key = PageKey::new("design-page", view.text("页面设计", "PAGE"));
        has_pages && self.walk.button(view, row.cell(ACTIONS.len(), count), key)
    }

    fn list(&mut self, rect: Rect, view: &View<'_>, edits: &[EditKey], pages: i32) -> Vec<Command> {
        let edits = if self.keys_focused { &[] } else { edits };
        let rows = view.snapshot.directory.as_slice();
        if rows.is_empty() {
            let remedy = view.text(
                "把程序 O1001.NC … 拷贝到 programs 目录。",
                "Copy programs (O1001.NC …) into the programs folder.",
            );
            empty::show(view, rect, pictogram::NO_PAGE, view.text("没有程序", "no programs"), remedy);
            return Vec::new();
        }
        let (title, list) = rect.shrink(theme::PAD).split_top(34.0);
        lines::title(view, title, view.text("程序目录", "programs"));
        view.line_right(title, &rows.len().to_string(), theme::LABEL, view.theme.muted);
        view.card(list);
        let list = round_to_lines(list.shrink(4.0), ROW_HEIGHT);
        let mut load = false;
        for edit in edits {
            match edit {
                EditKey::Up | EditKey::Previous => self.cursor = self.cursor.saturating_sub(1),
                EditKey::Down | EditKey::Next => self.cursor += 1,
                EditKey::Enter => load = true,
                _ => continue,
            }
            self.cursor = self.cursor.min(rows.len() - 1);
            self.scroll.scroll_to(self.cursor, list, ROW_HEIGHT);
        }
        self.cursor = self.cursor.min(rows.len() - 1);
        if std::mem::take(&mut self.reveal_cursor) {
            self.scroll.scroll_to(self.cursor, list, ROW_HEIGHT);
        }
        let spec = ScrollList { id: "directory", rect: list, row: ROW_HEIGHT, gap: 4.0, count: rows.len() };
        let (clipped, places) = self.scroll.rows(view, &spec, pages);
        let named = places.iter().any(|(index, _)| rows[*index].name.len() > 6);
        self.name_width = if named { 150.0 } else { 88.0 };
        for (index, place) in places {
            load |= self.row(place, &clipped, index, &rows[index]);
        }
        let chosen = rows.get(self.cursor).filter(|_| load);
        chosen.map(|row| Command::LoadProgram(row.number)).into_iter().collect()
    }

    fn row(&mut self, place: Rect, view: &View<'_>, index: usize, row: &DirectoryRow) -> bool {
        let current = row.number == view.snapshot.program.number;
        let chosen = index == self.cursor;
        if view.touch_row(place, ("program", index), chosen, row.name.clone()).clicked() {
            self.cursor = index;
        }
        if chosen {
            view.painter.rect_filled(place, theme::RADIUS, view.theme.raised);
            view.frame(place, view.theme.focus);
        }
        let (number, rest) = place.shrink2(vec2(theme::PAD, 3.0)).split_left(self.name_width);
        let ink = if current { view.theme.run } else { view.theme.text };
        view.fit_left(number, &row.name, theme::SECONDARY, ink);
        let (rest, action) = rest.split_right(96.0);
        let (comment, details) = rest.split_right(210.0);
        // A long comment takes two lines of the same size.
        let words = row.comment_in(view.lang).replace('\u{FFFD}', "?");
        view.text_rows(comment.trim_right(theme::PAD), &words, theme::LABEL, view.theme.text, 2);
        let (size, date) = details.split_left_right_at_fraction(0.34);
        view.line_right(size, &format_size(row.size), theme::LABEL, view.theme.muted);
        view.fit_right(date.trim_right(theme::PAD), &row.modified, theme::LABEL, view.theme.muted);
        if current {
            view.fit_right(action, view.text("当前", "CURRENT"), theme::LABEL, view.theme.run);
            return false;
        }
        chosen && load_key(action, view)
    }
}

/// 装入: the only key that loads by touch. The core refuses while a program runs.
fn load_key(action: Rect, view: &View<'_>) -> bool {
    let place = Rect::from_center_size(action.center() + vec2(2.0, 0.0), vec2(96.0, theme::TOUCH_TARGET));
    let response = view.ui.interact(place, Id::unique("load"), Sense::CLICK);
    let words = view.text("装入", "LOAD");
    let running = matches!(view.snapshot.state, RunState::Running | RunState::Held | RunState::Waiting);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, !running, format!("{words} load-program")));
    let face =
        KeycapState { pressed: response.is_pointer_button_down_on(), blocked: running, ..KeycapState::default() };
    keycap::paint_body(view, place, face);
    view.frame(place, if running { view.theme.line } else { view.theme.focus });
    view.fit_centre(place, words, theme::TITLE, if running { view.theme.disabled } else { view.theme.text });
    response.clicked()
}
