//! Page designer: the text of a grinding page on the left. On the right a preview, the variables that its program uses,
//! the available pictures, or the errors by line.
//! Source: spec K5.12, K6.2, K7.2–K7.4.

mod acts;
mod paint;

use std::sync::Arc;

use egui::{Rect, TextureId, Ui, pos2, vec2};
use ropey::Rope;

use super::program::document::Document;
use super::program::listing;
use super::scroll::Scroll;
use super::{Typed, empty};
use crate::defs::key::Mode;
use crate::defs::screen::{self, Reading};
use crate::defs::text::{Said, Text};
use crate::hmi::asking::{self, Guarded, Heard, Why};
use crate::hmi::entry::Edit;
use crate::hmi::letters::{self, Letter};
use crate::hmi::login::Login;
use crate::hmi::question::Asked;
use crate::hmi::view::View;
use crate::hmi::widget::{self, Look, Walk};
use crate::hmi::{pictogram, theme};
use crate::link::files::{Asker, FileRequest, Refusal, Ticket};
use crate::link::page_command::PageCommand;
use crate::link::page_file::{PageFile, PictureFrom};
use crate::link::snapshot::{PAGED_PROGRAMS, RunState};
use crate::link::{Command, Snapshot};

/// Height of a row of keys.
const KEYS: f32 = 46.0;
/// Height of the message line.
const TOLD: f32 = 28.0;

/// Tabs of the right half.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Tab {
    /// The page as it will look.
    #[default]
    Preview,
    /// Variables of program and page.
    Variables,
    /// Available pictures.
    Pictures,
    /// Errors by line.
    Faults,
}

const TABS: [Tab; 4] = [Tab::Preview, Tab::Variables, Tab::Pictures, Tab::Faults];

/// Request whose answer is awaited.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Awaited {
    /// May the text be edited?
    Edit,
    /// Save the text of this version.
    Save(u64),
    /// Replace the picture.
    Picture,
}

impl Why for Awaited {
    const ASKER: Asker = Asker::Designer;
}

/// Subject of a question.
#[derive(Clone, Debug, PartialEq, Eq)]
enum About {
    Conflict,
    Discard,
    Picture(PictureFrom, String),
}

/// Seconds before a page file is requested again, and maximum number of tries: a request can be lost, a file faulty.
const ASK_AGAIN: f64 = 0.5;
const TRIES: u8 = 3;

/// State of the page.
#[derive(Debug, Default)]
pub struct Designer {
    /// Page selected in the directory; none: the page of the current program.
    wanted: Option<u32>,
    document: Document,
    file: Option<Arc<PageFile>>,
    reading: Reading,
    /// Page, file stamp and version of the text that was parsed last.
    read: Option<(u32, u64, u64)>,
    place: listing::Place,
    list: Scroll,
    /// Selected row of the list on the right.
    row: usize,
    tab: Tab,
    editing: bool,
    board: bool,
    /// The file must be requested.
    stale: bool,
    /// Page of the last file request, its time in s, and the number of tries.
    asked: (u32, f64, u8),
    asking: Guarded<Awaited>,
    question: Asked<About>,
    told: Option<(Said, bool)>,
    walk: Walk,
    /// The keyboard moves over the keys instead of the text.
    on_keys: bool,
}

impl Designer {
    /// The page was opened; `program` was selected in the directory.
    pub fn open(&mut self, view: &View<'_>, program: Option<u32>) {
        if view.snapshot.page == crate::defs::page::Page::Designer {
            self.wanted = program;
            self.stale = true;
        }
        (self.editing, self.board, self.on_keys) = (false, false, false);
        self.question.close();
    }

    /// Number of the page: 1000 plus the number of its files. A number outside `PAGED_PROGRAMS` has no page.
    #[must_use]
    pub fn number(&self, snapshot: &Snapshot) -> u32 {
        match self.wanted {
            Some(program) if snapshot.own_page.is_none() => program,
            _ => snapshot.grinding_page().unwrap_or(snapshot.program.number),
        }
    }

    /// Why the last request was refused.
    #[must_use]
    pub fn refusal(&self) -> Option<&Said> {
        self.told.as_ref().filter(|(_, refused)| *refused).map(|(said, _)| said)
    }

    /// The text with its unsaved changes.
    #[must_use]
    pub const fn text(&self) -> &Rope {
        &self.document.rope
    }

    /// Draws the page.
    pub fn ui(
        &mut self,
        ui: &Ui,
        rect: Rect,
        view: &View<'_>,
        typed: &Typed<'_>,
        (login, picture): (&mut Login, Option<TextureId>),
    ) -> Vec<Command> {
        let mut out = Vec::new();
        let number = self.number(view.snapshot);
        let has_page = PAGED_PROGRAMS.contains(&number) || view.snapshot.own_page.is_some();
        if !has_page {
            paint::no_page(ui, rect, view, number, &mut out);
            return out;
        }
        self.hear(view, login, &mut out);
        self.follow(view, (number, ui.input(|input| input.time)), &mut out);
        if self.file.is_none() && !self.document.changed {
            let remedy = view.say(
                "原因见下面的提示行；检查 screens 目录中的文件。",
                "See the line below; check the file in the folder screens.",
            );
            empty::show(
                ui,
                view,
                rect,
                pictogram::NO_PAGE,
                view.say("页面文件还没有读出", "the page file is not read"),
                remedy,
            );
            return out;
        }
        if !self.question.is_open() && !login.is_open() {
            self.take_typed(view, typed, &mut out);
        }
        self.read_text();
        let inside = rect.shrink2(vec2(theme::PAD, 6.0));
        let (title, rest) = inside.split_top_bottom_at_y(inside.min.y + 32.0);
        let board = if self.board { letters::PAGE.height() } else { 0.0 };
        let (rest, pad) = rest.split_top_bottom_at_y(rest.max.y - board);
        let (body, below) = rest.split_top_bottom_at_y(rest.max.y - KEYS - TOLD);
        let (told, keys) = below.split_top_bottom_at_y(below.min.y + TOLD);
        // The preview needs 200 points for its picture and as much for each column.
        let share = if body.width() > 900.0 { 0.40 } else { 0.34 };
        let (text, right) = body.split_left_right_at_fraction(share);
        self.title(ui, title, view);
        self.listing(ui, Rect::from_min_max(text.min, text.max - vec2(theme::GAP, 0.0)), view, typed.pages);
        self.right(ui, right, view, picture);
        self.told(ui, told, view);
        if let Some(act) = acts::ui(ui, view, keys, self) {
            self.act(act, view, &mut out);
        }
        if self.board
            && let Some(letter) = letters::ui(ui, view, pad, &letters::PAGE)
        {
            self.letter(&letter);
        }
        if let Some((about, Some(key))) = self.question.ui(ui, rect, view, typed.edits) {
            self.answer(about, key, &mut out);
        }
        out
    }

    /// Handles the answers of the core.
    fn hear(&mut self, view: &View<'_>, login: &mut Login, out: &mut Vec<Command>) {
        while let Some(heard) = self.asking.hear(view, login) {
            match heard {
                Heard::Open => self.wish_edit(view, out),
                Heard::Answer(Awaited::Edit, Ok(_)) => (self.editing, self.told) = (true, None),
                Heard::Answer(Awaited::Save(version), Ok(deed)) => {
                    self.document.hear_saved(version, &deed);
                    (self.told, self.stale) = (Some((deed.said, false)), true);
                }
                Heard::Answer(Awaited::Picture, Ok(deed)) => {
                    (self.told, self.stale) = (Some((deed.said, false)), true);
                }
                Heard::Answer(Awaited::Save(_), Err(Refusal::Conflict)) => {
                    self.question.ask(About::Conflict, asking::conflict());
                }
                Heard::Answer(_, Err(refusal)) => self.refuse(refusal.said()),
            }
        }
    }

    /// Requests the file when the page opens or shows another file; keeps an unsaved text.
    fn follow(&mut self, view: &View<'_>, (number, now): (u32, f64), out: &mut Vec<Command>) {
        let idle = matches!(view.snapshot.state, RunState::Idle | RunState::Alarm);
        if self.editing && (view.snapshot.mode != Mode::Edit || !idle) {
            (self.editing, self.board) = (false, false);
        }
        let other = self.document.number != number && !self.document.changed;
        let (asked, since, tries) = self.asked;
        let again = asked != number || (self.file.is_none() && now - since > ASK_AGAIN && tries < TRIES);
        if self.stale || (other && again) {
            self.asked = (number, now, if asked == number && !self.stale { tries + 1 } else { 1 });
            self.stale = false;
            let page = if self.document.changed { self.document.number } else { number };
            let program = if PAGED_PROGRAMS.contains(&page) { page } else { view.snapshot.program.number };
            let ticket = Ticket::unheard(Asker::Designer);
            out.push(Command::Page(PageCommand::File(ticket, FileRequest::ReadPage { page, program })));
            if other {
                (self.file, self.document) = (None, Document::default());
            }
        }
        let Some(file) = &view.snapshot.files.page else { return };
        if self.file.as_ref().is_some_and(|known| Arc::ptr_eq(known, file)) || file.number != number {
            return;
        }
        let same = (file.number, file.stamp) == (self.document.number, self.document.base);
        if !self.document.changed && !same {
            let line = if file.number == self.document.number { self.document.place().0 } else { 0 };
            self.document = Document::open(file.number, file.stamp, &file.text);
            self.document.go(line, 0);
        }
        self.file = Some(Arc::clone(file));
    }

    /// Parses the text after a change.
    fn read_text(&mut self) {
        let now = (self.document.number, self.document.base, self.document.version);
        if self.read != Some(now) {
            self.read = Some(now);
            self.reading = screen::read(&self.document.rope.to_string());
        }
    }

    fn refuse(&mut self, why: impl Into<Said>) {
        self.told = Some((why.into(), true));
    }

    fn wish_edit(&mut self, view: &View<'_>, out: &mut Vec<Command>) {
        if self.file.as_ref().is_some_and(|file| file.mistaken) {
            return self.refuse(Said::new("文件编码不对，不能编辑", "not of a known encoding: not to be edited"));
        }
        let number = self.number(view.snapshot);
        out.push(self.asking.ask(Awaited::Edit, FileRequest::MayEdit(number)));
    }

    fn save(&mut self, force: bool, out: &mut Vec<Command>) {
        let (page, text, base) = (self.document.number, self.document.rope.clone(), self.document.base);
        let request = FileRequest::SavePage { page, text, base, force };
        out.push(self.asking.ask(Awaited::Save(self.document.version), request));
    }

    /// Handles a key of a question other than 取消, by its index.
    fn answer(&mut self, about: About, key: usize, out: &mut Vec<Command>) {
        match about {
            About::Conflict if key == asking::OVERWRITE => self.save(true, out),
            // The requested file replaces a text without changes.
            About::Conflict => {
                (self.document.changed, self.stale) = (false, true);
                self.told = Some((Text::new("已读磁盘上的文件", "read from the disk").into(), false));
            }
            About::Discard => {
                if let Some(file) = &self.file {
                    self.document = Document::open(file.number, file.stamp, &file.text);
                }
                (self.editing, self.board, self.stale) = (false, false, true);
            }
            About::Picture(from, name) => {
                let page = self.document.number;
                out.push(self.asking.ask(Awaited::Picture, FileRequest::TakePicture { page, from, name }));
            }
        }
    }

    /// Handles keyboard input.
    fn take_typed(&mut self, view: &View<'_>, typed: &Typed<'_>, out: &mut Vec<Command>) {
        for control in typed.controls {
            if let Some(act) = acts::of_control(*control) {
                self.act(act, view, out);
            }
        }
        // Typed characters always go to the text, even while Tab has moved to the keys.
        self.on_keys &= !typed.text.contains(|sign: char| !sign.is_control() && sign != ' ');
        let text = self.editing && !self.on_keys;
        self.walk.begin(if text { &[] } else { typed.edits });
        if text {
            typed.text.chars().filter(|sign| !sign.is_control()).for_each(|sign| self.sign(sign));
        }
        for edit in typed.edits {
            match edit {
                Edit::Next | Edit::Previous if self.editing => {
                    self.on_keys = !self.on_keys;
                    self.walk.choose(0, 1);
                }
                Edit::Cancel if self.on_keys => self.on_keys = false,
                _ if text => self.edit(*edit),
                Edit::Cancel => self.told = None,
                _ => {}
            }
        }
    }

    fn sign(&mut self, sign: char) {
        self.told = None;
        self.document.type_sign(sign);
        self.place.scroll.by_hand = false;
    }

    fn letter(&mut self, letter: &Letter) {
        self.on_keys = false;
        match letter {
            Letter::Sign(sign) => self.sign(*sign),
            Letter::Word(word) => word.chars().for_each(|sign| self.sign(sign)),
            Letter::Back => self.edit(Edit::Back),
            Letter::Done => self.edit(Edit::Enter),
        }
    }

    fn edit(&mut self, edit: Edit) {
        self.told = None;
        if self.document.edit(edit) {
            self.place.scroll.by_hand = false;
        }
    }

    /// A key of the page; the keyboard moves over it unless it edits the text.
    fn key(&mut self, ui: &Ui, view: &View<'_>, rect: Rect, words: (&str, &str), look: Look) -> bool {
        if self.on_keys || !self.editing {
            self.walk.push(ui, view, rect, words, look)
        } else {
            widget::push(ui, view, rect, words.0, words.1, look)
        }
    }

    /// The tabs and the content of the selected one.
    fn right(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, picture: Option<TextureId>) {
        let (bar, rest) = rect.split_top_bottom_at_y(rect.min.y + widget::TABS - 2.0);
        let count = |words: &str, count: usize| {
            if count > 0 { format!("{words} {count}") } else { words.trim_end_matches(['缺', ' ']).to_owned() }
        };
        let missing = self.variables(view).iter().filter(|row| row.missing).count();
        let keys = [
            ("page-preview", view.say("预览", "PREVIEW").to_owned()),
            ("page-variables", count(view.say("变量 缺", "VARS"), missing)),
            ("page-pictures", view.say("图片", "PICTURES").to_owned()),
            ("page-faults", count(view.say("错误", "ERRORS"), self.reading.faults.len())),
        ];
        let width = (bar.width() + theme::GAP) / keys.len() as f32;
        for (index, (tab, (name, label))) in TABS.into_iter().zip(&keys).enumerate() {
            let corner = pos2(bar.min.x + index as f32 * width, bar.min.y);
            let place = Rect::from_min_size(corner, vec2(width - theme::GAP, bar.height()));
            if self.key(ui, view, place, (name, label), Look { on: tab == self.tab, locked: false }) {
                (self.tab, self.row, self.list) = (tab, 0, Scroll::default());
                // A USB drive may have been plugged in since.
                self.stale |= tab == Tab::Pictures;
            }
        }
        let rest = Rect::from_min_max(rest.min + vec2(0.0, theme::GAP), rest.max);
        match self.tab {
            // The letter pad leaves no room for the preview, so the errors are shown.
            Tab::Preview if self.board => self.faults(ui, rest, view),
            Tab::Preview => self.preview(ui, rest, view, picture),
            Tab::Variables => self.variable_list(ui, rest, view),
            Tab::Pictures => self.picture_list(ui, rest, view),
            Tab::Faults => self.faults(ui, rest, view),
        }
    }

    /// Height of a line of the text.
    const fn line() -> f32 {
        listing::LINE
    }
}
