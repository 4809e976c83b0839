//! Page designer: the text of a grinding page, or its English text, on the left. On the right a preview, the variables
//! that its program uses, the available pictures, or the errors by line.
//! Source: spec K5.12, K6.2, K7.2–K7.4, H9.

mod actions;
mod arrange;
mod paint;

use std::sync::Arc;

use egui::{Rect, TextureId, vec2};

use super::program::actions::{SAVE_FIRST, UNKNOWN_ENCODING};
use super::program::document::Document;
use super::program::listing;
use super::{HandOver, PageContext, PageUi, Scroll, empty};
use crate::defs::key::Mode;
use crate::defs::page_text::{self, ParsedPageText};
use crate::defs::text::Lang;
use crate::hmi::{
    Area, EditKey, KeyboardFocus, KeyboardInput, LetterKey, Login, PageKey, PageMessage, PendingRequests,
    QuestionDialog, RequestEvent, TypedInput, View, file_command, letter_pad, pictogram, requests, theme, widget,
};
use crate::link::files::{FileRequest, Refusal, Requester};
use crate::link::page_file::{PageFile, PageTextId, PictureLocation};
use crate::link::screens::PROGRAMS_WITH_PAGE;
use crate::link::screens::Picture;
use crate::link::snapshot::RunState;
use crate::link::{Command, Snapshot};

/// Height of the message line.
const MESSAGE_HEIGHT: f32 = 28.0;

/// Tabs of the right half.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum DesignerTab {
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

const TABS: [DesignerTab; 4] =
    [DesignerTab::Preview, DesignerTab::Variables, DesignerTab::Pictures, DesignerTab::Faults];

/// Request whose answer is awaited.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum DesignerRequest {
    /// May the text be edited?
    Edit,
    /// Save the text of this version.
    Save(u64),
    /// Replace the picture.
    Picture,
    /// Replace the places of the variables in it.
    Labels,
}

/// Subject of a question.
#[derive(Clone, Debug, PartialEq, Eq)]
enum DesignerQuestion {
    Conflict,
    Discard,
    Picture(PictureLocation, String),
}

/// Seconds before a page file is requested again, and maximum number of tries: a request can be lost, a file faulty.
const RETRY_SECONDS: f64 = 0.5;
const MAX_TRIES: u8 = 3;

/// State of the page.
#[derive(Debug, Default)]
pub struct DesignerPage {
    /// Page selected in the directory; none: the page of the current program.
    requested_program: Option<u32>,
    /// Chinese: the page text; English: the English text beside it.
    lang: Lang,
    document: Document,
    /// The text that the document holds.
    document_lang: Lang,
    file: Option<Arc<PageFile>>,
    reading: ParsedPageText,
    /// Page, file stamp and version of the text that was parsed last.
    read_version: Option<(u32, u64, u64)>,
    position: listing::ListingPosition,
    list: Scroll,
    /// Selected row of the list on the right.
    selected_row: usize,
    tab: DesignerTab,
    /// What is dragged over the preview.
    preview_drag: Option<arrange::PreviewDrag>,
    /// A place that the text does not reach yet was chosen, with the cursor then.
    empty_place: Option<(usize, usize)>,
    editing: bool,
    keyboard_open: bool,
    /// The file must be requested.
    stale: bool,
    /// Page of the last file request, its time in s, and the number of tries.
    last_request: (u32, f64, u8),
    asking: PendingRequests<DesignerRequest>,
    question: QuestionDialog<DesignerQuestion>,
    message: PageMessage,
    walk: KeyboardFocus,
    /// The keyboard moves over the keys instead of the text.
    keys_focused: bool,
}

impl PageUi for DesignerPage {
    /// `handed_over` was selected in the directory.
    fn open(&mut self, _view: &View<'_>, handed_over: Option<HandOver>) {
        (self.requested_program, self.stale) = (handed_over.and_then(HandOver::program), true);
    }

    fn close(&mut self) {
        (self.editing, self.keyboard_open, self.keys_focused) = (false, false, false);
        self.question.close();
    }

    fn refusal(&self, lang: Lang) -> Option<(String, String)> {
        self.message.refusal(lang).map(|why| (self.document.rope.to_string(), why))
    }

    fn message(&self, lang: Lang) -> Option<String> {
        self.message.text(lang)
    }

    fn picture<'a>(&self, snapshot: &'a Snapshot) -> Option<&'a Arc<Picture>> {
        // An unsaved text stays when another program becomes current.
        let number = if self.document.changed { self.document.number } else { self.number(snapshot) };
        snapshot.screens.find(number)?.picture.as_ref().ok()
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        let PageContext { rect, view, typed, picture, login, out, .. } = ctx;
        let number = self.number(view.snapshot);
        let has_page = PROGRAMS_WITH_PAGE.contains(&number) || view.snapshot.kind_page.is_some();
        if !has_page {
            return paint::no_page(rect, view, number, out);
        }
        self.handle_answers(view, login, out);
        self.sync_file(view, number, out);
        if self.file.is_none() && !self.document.changed {
            let what = view.text("页面文件还没有读出", "the page file is not read yet");
            let remedy = view.text(
                "原因见下面的提示行；检查 screens 目录中的文件。",
                "See the line below; check the file in the screens folder.",
            );
            return empty::show(view, rect, pictogram::NO_PAGE, what, remedy);
        }
        if !self.question.is_open() && !login.is_open() {
            self.handle_typed(view, typed, out);
        }
        self.read_text(view);
        let (title, rest) = rect.shrink2(vec2(theme::PAD, 6.0)).split_top(32.0);
        let board = if self.keyboard_open { letter_pad::HEIGHT } else { 0.0 };
        let (rest, pad) = rest.split_bottom(board);
        let (body, below) = rest.split_bottom(widget::KEYS_HEIGHT + MESSAGE_HEIGHT);
        let (told, keys) = below.split_top(MESSAGE_HEIGHT);
        // The preview needs 200 points for its picture and as much for each column.
        let (text, right) = body.split_left_right_at_fraction(if body.width() > 900.0 { 0.40 } else { 0.34 });
        self.title(title, view);
        self.listing(text.trim_right(theme::GAP), view, typed.scroll_pages);
        self.right(right, view, picture, out);
        self.message_line(told, view);
        if let Some(action) = actions::ui(view, keys, self) {
            self.perform(action, view, out);
        }
        if self.keyboard_open
            && let Some(letter) = letter_pad::ui(view, pad, &letter_pad::PAGE_TEXT_LAYOUT)
        {
            self.letter(&letter);
        }
        if let Some((about, Some(key))) = self.question.ui(rect, view, &typed.edits) {
            self.answer(about, key, out);
        }
    }
}

impl DesignerPage {
    /// Number of the page: 1000 plus the number of its files. A number outside `PROGRAMS_WITH_PAGE` has no page.
    fn number(&self, snapshot: &Snapshot) -> u32 {
        let own = || snapshot.grinding_page_number().unwrap_or(snapshot.program.number);
        self.requested_program.filter(|_| snapshot.kind_page.is_none()).unwrap_or_else(own)
    }

    /// Handles the answers of the core.
    fn handle_answers(&mut self, view: &View<'_>, login: &mut Login, out: &mut Vec<Command>) {
        while let Some(heard) = self.asking.poll_protected(Requester::Designer, view, login) {
            match heard {
                RequestEvent::Unlocked => self.request_edit(view, out),
                RequestEvent::Answer(DesignerRequest::Edit, Ok(_)) => {
                    self.editing = true;
                    self.message.clear();
                }
                RequestEvent::Answer(why, Ok(completion)) => {
                    if let DesignerRequest::Save(version) = why {
                        self.document.mark_saved(version, &completion);
                    }
                    self.message.tell(completion.message);
                    self.stale = true;
                }
                RequestEvent::Answer(DesignerRequest::Save(_), Err(Refusal::Conflict)) => {
                    self.question.ask(DesignerQuestion::Conflict, requests::conflict_question());
                }
                RequestEvent::Answer(_, Err(refusal)) => self.message.refuse(refusal.message()),
            }
        }
    }

    /// Requests the file when the page opens or shows another file; keeps an unsaved text.
    fn sync_file(&mut self, view: &View<'_>, number: u32, out: &mut Vec<Command>) {
        let now = view.ui.input(|input| input.time);
        let idle = matches!(view.snapshot.state, RunState::Idle | RunState::Alarm);
        if self.editing && (view.snapshot.mode != Mode::Edit || !idle) {
            (self.editing, self.keyboard_open) = (false, false);
        }
        let id = PageTextId { page: number, lang: self.lang };
        let shown = PageTextId { page: self.document.number, lang: self.document_lang };
        let other = shown != id && !self.document.changed;
        let (asked, since, tries) = self.last_request;
        let again = asked != number || (self.file.is_none() && now - since > RETRY_SECONDS && tries < MAX_TRIES);
        if self.stale || (other && again) {
            self.last_request = (number, now, if asked == number && !self.stale { tries + 1 } else { 1 });
            self.stale = false;
            let id = if self.document.changed { shown } else { id };
            let program = if PROGRAMS_WITH_PAGE.contains(&id.page) { id.page } else { view.snapshot.program.number };
            out.push(file_command(Requester::Designer, FileRequest::ReadPage { id, program }));
            if other {
                (self.file, self.document) = (None, Document::default());
            }
        }
        let Some(file) = &view.snapshot.files.page else { return };
        if self.file.as_ref().is_some_and(|known| Arc::ptr_eq(known, file)) || file.id != id {
            return;
        }
        let same = (file.id, file.stamp) == (shown, self.document.base);
        if !self.document.changed && !same {
            let line = if file.id.page == self.document.number { self.document.cursor_position().0 } else { 0 };
            self.open_document(&Arc::clone(file));
            self.document.move_to(line, 0);
        }
        self.file = Some(Arc::clone(file));
    }

    /// Opens the text of a file.
    fn open_document(&mut self, file: &PageFile) {
        self.document = Document::open(file.id.page, file.stamp, &file.text);
        (self.document_lang, self.read_version) = (file.id.lang, None);
    }

    /// Parses the text after a change. An English text is compared with its page text.
    fn read_text(&mut self, view: &View<'_>) {
        let now = (self.document.number, self.document.base, self.document.version);
        if self.read_version != Some(now) {
            self.read_version = Some(now);
            self.reparse();
            let own = view.snapshot.screens.find(self.document.number).and_then(|files| files.text.as_ref().ok());
            if let Some(own) = own.filter(|_| self.document_lang == Lang::En && self.reading.faults.is_empty()) {
                self.reading.faults = page_text::english_faults(own, &self.reading);
            }
        }
    }

    fn reparse(&mut self) {
        self.reading = page_text::parse_all(&self.document.rope.to_string());
    }

    /// Shows the English text instead of the page text, or back.
    fn switch_text(&mut self) {
        if self.document.changed {
            return self.message.refuse(SAVE_FIRST);
        }
        self.lang = match self.lang {
            Lang::Zh => Lang::En,
            Lang::En | Lang::Added(_) => Lang::Zh,
        };
        self.stale = true;
    }

    fn request_edit(&mut self, view: &View<'_>, out: &mut Vec<Command>) {
        if self.file.as_ref().is_some_and(|file| file.has_invalid_bytes) {
            return self.message.refuse(UNKNOWN_ENCODING);
        }
        let request = FileRequest::CheckEditable(self.number(view.snapshot));
        out.push(self.asking.send(Requester::Designer, DesignerRequest::Edit, request));
    }

    fn save(&mut self, force: bool, out: &mut Vec<Command>) {
        let id = PageTextId { page: self.document.number, lang: self.document_lang };
        let (text, base) = (self.document.rope.clone(), self.document.base);
        let request = FileRequest::SavePage { id, text, base_stamp: base, overwrite: force };
        out.push(self.asking.send(Requester::Designer, DesignerRequest::Save(self.document.version), request));
    }

    /// Handles a key of a question other than 取消, by its index.
    fn answer(&mut self, about: DesignerQuestion, key: usize, out: &mut Vec<Command>) {
        match about {
            DesignerQuestion::Conflict if key == requests::OVERWRITE_KEY => self.save(true, out),
            // The requested file replaces a text without changes.
            DesignerQuestion::Conflict => {
                (self.document.changed, self.stale) = (false, true);
                self.message.tell(requests::READ_FROM_DISK);
            }
            DesignerQuestion::Discard => {
                if let Some(file) = self.file.clone() {
                    self.open_document(&file);
                }
                (self.editing, self.keyboard_open, self.stale) = (false, false, true);
            }
            DesignerQuestion::Picture(from, name) => {
                let request = FileRequest::ImportPicture { page: self.document.number, from, name };
                out.push(self.asking.send(Requester::Designer, DesignerRequest::Picture, request));
            }
        }
    }

    /// Handles keyboard input.
    fn handle_typed(&mut self, view: &View<'_>, typed: &KeyboardInput, out: &mut Vec<Command>) {
        for control in &typed.ctrl_keys {
            if let Some(action) = actions::from_shortcut(*control) {
                self.perform(action, view, out);
            }
        }
        // Typed characters always go to the text, even while Tab has moved to the keys.
        self.keys_focused &= !typed.text.contains(|sign: char| !sign.is_control() && sign != ' ');
        let text = self.editing && !self.keys_focused;
        self.walk.begin_frame(if text { &[] } else { &typed.edits });
        for typed in &typed.in_order {
            match *typed {
                TypedInput::Char(sign) if text => self.type_char(sign),
                TypedInput::Char(_) => {}
                TypedInput::Key(EditKey::Next | EditKey::Previous) if self.editing => {
                    self.keys_focused = !self.keys_focused;
                    self.walk.select(0, 1);
                }
                TypedInput::Key(EditKey::Cancel) if self.keys_focused => self.keys_focused = false,
                TypedInput::Key(edit) if text => self.edit(edit),
                TypedInput::Key(EditKey::Cancel) => self.message.clear(),
                TypedInput::Key(_) => {}
            }
        }
    }

    fn type_char(&mut self, sign: char) {
        self.message.clear();
        self.document.insert_char(sign);
        self.position.scroll.user_scrolled = false;
    }

    fn letter(&mut self, letter: &LetterKey) {
        self.keys_focused = false;
        match letter {
            LetterKey::Char(sign) => self.type_char(*sign),
            LetterKey::Word(word) => word.chars().for_each(|sign| self.type_char(sign)),
            LetterKey::Backspace => self.edit(EditKey::Backspace),
            LetterKey::Done => self.edit(EditKey::Enter),
        }
    }

    fn edit(&mut self, edit: EditKey) {
        self.message.clear();
        if self.document.edit(edit) {
            self.position.scroll.user_scrolled = false;
        }
    }

    /// A key of the page; the keyboard moves over it unless it edits the text.
    fn key(&mut self, view: &View<'_>, rect: Rect, key: PageKey<'_>) -> bool {
        if self.keys_focused || !self.editing {
            self.walk.button(view, rect, key)
        } else {
            widget::button(view, rect, key)
        }
    }

    /// The tabs and the content of the selected one.
    fn right(&mut self, rect: Rect, view: &View<'_>, picture: Option<TextureId>, out: &mut Vec<Command>) {
        let (bar, rest) = rect.split_top(widget::KEYS_HEIGHT - 2.0);
        let count = |words: &str, count: usize| {
            if count > 0 { format!("{words} {count}") } else { words.trim_end_matches(['缺', ' ']).to_owned() }
        };
        let missing = self.variables(view).iter().filter(|row| row.missing).count();
        let keys = [
            ("page-preview", view.text("预览", "PREVIEW").to_owned()),
            ("page-variables", count(view.text("变量 缺", "VARS"), missing)),
            ("page-pictures", view.text("图片", "PICTURES").to_owned()),
            ("page-faults", count(view.text("错误", "ERRORS"), self.reading.faults.len())),
        ];
        for (index, (tab, (name, label))) in TABS.into_iter().zip(&keys).enumerate() {
            if self.key(view, bar.cell(index, keys.len()), PageKey::new(name, label).on(tab == self.tab)) {
                (self.tab, self.selected_row, self.list) = (tab, 0, Scroll::default());
                // A USB drive may have been plugged in since.
                self.stale |= tab == DesignerTab::Pictures;
            }
        }
        let rest = rest.trim_top(theme::GAP);
        match self.tab {
            // The letter pad leaves no room for the preview, so the errors are shown.
            DesignerTab::Preview if self.keyboard_open => self.faults(rest, view),
            DesignerTab::Preview => self.preview(rest, view, picture, out),
            DesignerTab::Variables => self.variable_list(rest, view),
            DesignerTab::Pictures => self.picture_list(rest, view),
            DesignerTab::Faults => self.faults(rest, view),
        }
    }
}
