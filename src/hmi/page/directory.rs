//! Program directory: every program with size, comment and date. A touch selects a program, the key 装入 loads it.
//! Source: spec B6. A swipe scrolls and never loads (H9).

use egui::accesskit::Role;
use egui::{Align2, Id, Rect, Sense, Ui, WidgetInfo, pos2, vec2};

use super::empty;
use super::scroll::Scroll;
use crate::defs::key::Mode;
use crate::defs::page::Page;
use crate::defs::text::{Said, Text};
use crate::hmi::asking::{Asking, Why};
use crate::hmi::entry::Edit;
use crate::hmi::keycap::{self, Face};
use crate::hmi::login::Login;
use crate::hmi::page::Typed;
use crate::hmi::page::input_line::{self, Told};
use crate::hmi::question::{Asked, Question};
use crate::hmi::typing::Typing;
use crate::hmi::view::{self, View, card, fit, frame, put};
use crate::hmi::widget::{Look, Walk, whole_lines};
use crate::hmi::{frame as lines, pictogram, theme};
use crate::link::Command;
use crate::link::files::{Asker, FileRequest, Refusal};
use crate::link::page_command::Guard;
use crate::link::snapshot::{DirectoryRow, RunState};

/// Height of a row.
const ROW: f32 = 50.0;

/// Height of the keys below.
const KEYS: f32 = 46.0;

/// Actions on a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Deed {
    New,
    Copy,
    Rename,
    Delete,
}

/// Request to create, copy, rename or delete a program.
#[derive(Debug)]
struct Change;

impl Why for Change {
    const ASKER: Asker = Asker::Directory;
}

/// State of the page.
#[derive(Debug, Default)]
pub struct Directory {
    scroll: Scroll,
    cursor: usize,
    /// The action whose program number is being typed.
    deed: Option<Deed>,
    /// The number being typed.
    pub typing: Typing,
    question: Asked<()>,
    /// Request that waits for an answer or for the password.
    asked: Option<FileRequest>,
    waiting: bool,
    asking: Asking<Change>,
    walk: Walk,
    on_keys: bool,
    /// The page was just opened: scroll to the selected row.
    reveal: bool,
    /// Width of the name column; named programs need more than O and four digits.
    name_width: f32,
    /// Program whose page is to be designed.
    pub page_of: Option<u32>,
}

impl Directory {
    /// Draws the page.
    pub fn ui(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, typed: &Typed<'_>, login: &mut Login) -> Vec<Command> {
        let mut out = Vec::new();
        self.hear(view, login, &mut out);
        let free = !self.question.is_open() && !login.is_open();
        let edits = if free { typed.edits } else { &[] };
        let (body, below) = rect.split_top_bottom_at_y(rect.max.y - KEYS - theme::GAP);
        let edits = if self.deed.is_some() {
            edits.iter().for_each(|edit| self.edit(*edit, view, &mut out));
            &[]
        } else {
            edits
        };
        out.extend(self.list(ui, body, view, edits, typed.pages));
        if self.keys(ui, below.shrink2(vec2(theme::PAD, 0.0)), view, edits) {
            self.page_of = view.snapshot.directory.get(self.cursor).map(|row| row.number);
            out.push(Command::OpenPage(Page::Designer));
        }
        match self.question.ui(ui, rect, view, typed.edits) {
            Some(((), Some(_))) => self.send(&mut out),
            Some(((), None)) => self.asked = None,
            None => {}
        }
        out
    }

    /// Whether the numeric pad is shown.
    #[must_use]
    pub const fn wants_pad(&self) -> bool {
        self.deed.is_some() && self.typing.pad
    }

    fn send(&mut self, out: &mut Vec<Command>) {
        if let Some(request) = &self.asked {
            out.push(self.asking.ask(Change, request.clone()));
        }
    }

    /// Handles the answer: done, password needed, or refused.
    fn hear(&mut self, view: &View<'_>, login: &mut Login, out: &mut Vec<Command>) {
        if self.waiting && !login.is_open() {
            self.waiting = false;
            if view.snapshot.access.program { self.send(out) } else { self.asked = None }
        }
        let Some((Change, answer)) = self.asking.hear(&view.snapshot.files).filter(|_| self.asked.is_some()) else {
            return;
        };
        match answer {
            Err(Refusal::Password) => {
                self.waiting = true;
                login.unlock(view, Guard::Program);
                return;
            }
            Err(refusal) => {
                // The number stays with the reason, to be corrected.
                self.deed = match self.asked {
                    Some(FileRequest::New(_)) => Some(Deed::New),
                    Some(FileRequest::Copy { .. }) => Some(Deed::Copy),
                    Some(FileRequest::Rename { .. }) => Some(Deed::Rename),
                    _ => Some(Deed::Delete),
                };
                self.typing.refused = Some(refusal.said());
            }
            Ok(_) => (self.deed, self.typing) = (None, Typing::default()),
        }
        self.asked = None;
    }

    fn edit(&mut self, edit: Edit, view: &View<'_>, out: &mut Vec<Command>) {
        match edit {
            Edit::Cancel => (self.deed, self.typing) = (None, Typing::default()),
            Edit::Enter => self.enter(view, out),
            _ => {
                self.typing.next_key(edit);
                self.typing.key(edit);
            }
        }
    }

    /// Sends the request for the typed number.
    fn enter(&mut self, view: &View<'_>, out: &mut Vec<Command>) {
        let Some(deed) = self.deed.filter(|deed| *deed != Deed::Delete) else {
            (self.deed, self.typing) = (None, Typing::default());
            return;
        };
        let from = view.snapshot.directory.get(self.cursor).map_or(0, |row| row.number);
        let to = match self.typing.text.parse::<u32>() {
            Ok(number) if (1..=9_999).contains(&number) => number,
            _ => {
                self.typing.refused = Some(Said::new("程序号应为 1-9999", "program numbers are 1 to 9999"));
                return;
            }
        };
        self.asked = Some(match deed {
            Deed::New | Deed::Delete => FileRequest::New(to),
            Deed::Copy => FileRequest::Copy { from, to },
            Deed::Rename => FileRequest::Rename { from, to },
        });
        self.send(out);
    }

    fn begin(&mut self, deed: Deed, view: &View<'_>) {
        let Some(row) = view.snapshot.directory.get(self.cursor) else {
            self.deed = (deed == Deed::New).then_some(deed);
            self.typing = Typing::default();
            self.typing.pad = true;
            return;
        };
        if deed == Deed::Delete {
            let (number, name, comment) = (row.number, &row.name, &row.comment);
            let body = Said::new(
                format!("{name} {comment}\n删除后不能恢复，除非有备份。"),
                format!("{name} {comment}\nOnly a backup brings it back."),
            );
            self.asked = Some(FileRequest::Delete(number));
            let key = ("question-delete", Text::new("删除", "DELETE"));
            self.question.ask((), Question::new(Text::new("删除程序？", "delete the program?"), body, key));
            return;
        }
        self.deed = Some(deed);
        self.typing = Typing::default();
        self.typing.pad = true;
    }

    /// The keys below, or the input line of the number; true when the page of the program is to be designed.
    fn keys(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, edits: &[Edit]) -> bool {
        if edits.iter().any(|edit| matches!(edit, Edit::Right | Edit::Left)) {
            self.on_keys = true;
        } else if edits.iter().any(|edit| matches!(edit, Edit::Up | Edit::Down | Edit::Cancel)) {
            self.on_keys = false;
        }
        if let Some(deed) = self.deed {
            let what = match deed {
                Deed::New => view.say("新程序号 O", "new program O"),
                Deed::Copy => view.say("复制为 O", "copy to O"),
                Deed::Rename => view.say("改为 O", "rename to O"),
                Deed::Delete => view.say("删除", "delete"),
            };
            let name = view.snapshot.directory.get(self.cursor).map_or_else(String::new, |row| row.name.clone());
            let told = Told { what, name: &name, range: "1 … 9999" };
            input_line::ui(
                ui,
                view,
                Rect::from_min_size(rect.min, vec2(rect.width(), theme::INPUT)),
                &self.typing,
                &told,
            );
            return false;
        }
        self.walk.begin(if self.on_keys { edits } else { &[] });
        let keys = [
            (Deed::New, "program-new", Text::new("新建", "NEW")),
            (Deed::Copy, "program-copy", Text::new("复制", "COPY")),
            (Deed::Rename, "program-rename", Text::new("改号", "RENAME")),
            (Deed::Delete, "program-delete", Text::new("删除", "DELETE")),
        ];
        let has_pages = Page::Designer.is_on(view.snapshot.kind);
        let width = (rect.width() + theme::GAP) / (keys.len() + usize::from(has_pages)) as f32;
        let place_of = |index: usize| {
            let corner = pos2(rect.min.x + index as f32 * width, rect.min.y);
            Rect::from_min_size(corner, vec2(width - theme::GAP, rect.height() - theme::GAP))
        };
        for (index, (deed, name, label)) in keys.iter().copied().enumerate() {
            let place = place_of(index);
            let locked = view.snapshot.mode != Mode::Edit;
            if self.walk.push(ui, view, place, (name, label.get(view.lang)), Look { on: false, locked }) {
                self.begin(deed, view);
            }
        }
        let words = ("design-page", view.say("页面设计", "PAGE"));
        has_pages && self.walk.push(ui, view, place_of(keys.len()), words, Look::default())
    }

    fn list(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, edits: &[Edit], pages: i32) -> Vec<Command> {
        let edits = if self.on_keys { &[] } else { edits };
        let rows = view.snapshot.directory.as_slice();
        if rows.is_empty() {
            let remedy = view.say(
                "把程序 O1001.NC … 拷贝到 programs 目录。",
                "Copy programs (O1001.NC …) into the folder programs.",
            );
            empty::show(ui, view, rect, pictogram::NO_PAGE, view.say("没有程序", "no programs"), remedy);
            return Vec::new();
        }
        let inside = rect.shrink(theme::PAD);
        let (title, list) = inside.split_top_bottom_at_y(inside.min.y + 34.0);
        lines::title(ui, view, title, view.say("程序目录", "programs"));
        put(ui.painter(), title, Align2::RIGHT_CENTER, &rows.len().to_string(), theme::LABEL, view.theme.quiet);
        card(ui.painter(), list, view.theme.surface, view.theme.line);
        let list = whole_lines(list.shrink(4.0), ROW);
        let mut load = false;
        for edit in edits {
            match edit {
                Edit::Up | Edit::Previous => self.cursor = self.cursor.saturating_sub(1),
                Edit::Down | Edit::Next => self.cursor += 1,
                Edit::Enter => load = true,
                Edit::Char(_)
                | Edit::Sign
                | Edit::Back
                | Edit::Delete
                | Edit::LineStart
                | Edit::LineEnd
                | Edit::Cancel
                | Edit::Left
                | Edit::Right => continue,
            }
            self.cursor = self.cursor.min(rows.len() - 1);
            self.scroll.show(self.cursor, list, ROW);
        }
        self.cursor = self.cursor.min(rows.len() - 1);
        if std::mem::take(&mut self.reveal) {
            self.scroll.show(self.cursor, list, ROW);
        }
        if pages != 0 {
            self.scroll.page(pages, list, ROW);
        }
        let (first, last) = self.scroll.follow(ui, "directory", list, ROW, rows.len());
        let named = rows[first..last].iter().any(|row| row.name.len() > 6);
        self.name_width = if named { 150.0 } else { 88.0 };
        for (index, row) in rows.iter().enumerate().take(last).skip(first) {
            let top = list.min.y + ((index as f64 - self.scroll.top) * f64::from(ROW)) as f32;
            let place = Rect::from_min_size(pos2(list.min.x, top), vec2(list.width() - 8.0, ROW - 4.0));
            load |= self.row(ui, list, place, view, (index, row));
        }
        self.scroll.bar(ui, view, list, ROW, rows.len());
        let chosen = rows.get(self.cursor).filter(|_| load);
        chosen.map(|row| Command::LoadProgram(row.number)).into_iter().collect()
    }

    fn row(&mut self, ui: &Ui, list: Rect, place: Rect, view: &View<'_>, row: (usize, &DirectoryRow)) -> bool {
        let (index, row) = row;
        let painter = &ui.painter().with_clip_rect(list);
        let current = row.number == view.snapshot.program.number;
        let chosen = index == self.cursor;
        let response = ui.interact(place.intersect(list), Id::unique(("program", index)), Sense::CLICK);
        response.widget_info(|| WidgetInfo::selected(Role::Button, true, chosen, row.name.clone()));
        if response.clicked() {
            self.cursor = index;
        }
        if chosen {
            painter.rect_filled(place, theme::RADIUS, view.theme.raised);
            frame(painter, place, view.theme.focus);
        }
        let inside = place.shrink2(vec2(theme::PAD, 3.0));
        let (number, rest) = inside.split_left_right_at_x(inside.min.x + self.name_width);
        let ink = if current { view.theme.run } else { view.theme.text };
        fit(painter, number, Align2::LEFT_CENTER, &row.name, theme::SECONDARY, ink);
        let (rest, action) = rest.split_left_right_at_x(rest.max.x - 96.0);
        let (comment, facts) = rest.split_left_right_at_x(rest.max.x - 210.0);
        let comment = Rect::from_min_max(comment.min, comment.max - vec2(theme::PAD, 0.0));
        // A long comment takes two lines of the same size.
        let words = row.comment.replace('\u{FFFD}', "?");
        view::rows(painter, comment, &words, theme::LABEL, view.theme.text, 2);
        let (size, date) = facts.split_left_right_at_fraction(0.34);
        put(painter, size, Align2::RIGHT_CENTER, &size_word(row.size), theme::LABEL, view.theme.quiet);
        let date = Rect::from_min_max(date.min, date.max - vec2(theme::PAD, 0.0));
        fit(painter, date, Align2::RIGHT_CENTER, &row.modified, theme::LABEL, view.theme.quiet);
        if current {
            fit(painter, action, Align2::RIGHT_CENTER, view.say("当前", "CURRENT"), theme::LABEL, view.theme.run);
            return false;
        }
        chosen && load_key(ui, action, view)
    }

    /// Scrolls to the current program when the page opens.
    pub fn open(&mut self, view: &View<'_>) {
        let number = view.snapshot.program.number;
        self.cursor = view.snapshot.directory.iter().position(|row| row.number == number).unwrap_or(0);
        (self.deed, self.asked, self.on_keys, self.reveal) = (None, None, false, true);
        self.question.close();
        self.typing = Typing::default();
    }
}

fn size_word(bytes: u64) -> String {
    match bytes {
        0..1_024 => format!("{bytes} B"),
        1_024..1_048_576 => format!("{:.1} kB", bytes as f64 / 1_024.0),
        _ => format!("{:.1} MB", bytes as f64 / 1_048_576.0),
    }
}

/// 装入: the only key that loads by touch. The core refuses while a program runs.
fn load_key(ui: &Ui, action: Rect, view: &View<'_>) -> bool {
    let place = Rect::from_center_size(action.center() + vec2(2.0, 0.0), vec2(96.0, theme::TARGET));
    let response = ui.interact(place, Id::unique("load"), Sense::CLICK);
    let words = view.say("装入", "LOAD");
    let running = matches!(view.snapshot.state, RunState::Running | RunState::Held | RunState::Waiting);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, !running, format!("{words} load-program")));
    let face = Face { pressed: response.is_pointer_button_down_on(), blocked: running, ..Face::default() };
    keycap::plate(ui.painter(), view.theme, place, face);
    frame(ui.painter(), place, if running { view.theme.line } else { view.theme.focus });
    let ink = if running { view.theme.dim } else { view.theme.text };
    fit(ui.painter(), place, Align2::CENTER_CENTER, words, theme::TITLE, ink);
    response.clicked()
}
