//! Draws one frame of the screen: layout, page frame, page, panel, input. It keeps only UI state (cursor, edit text,
//! scroll positions) and reads the machine state only from the snapshot.

use std::cell::{Cell, RefCell};
use std::sync::{Arc, Mutex, PoisonError};

use egui::{Color32, ColorImage, Rect, Ui};

use super::closing::Closing;
use super::explanation::Explanation;
use super::key_press::KeyPresses;
use super::layout::Regions;
use super::numeric_pad::NumericPad;
use super::page_frame::{self, FrameTouch, SoftKeyPress};
use super::page_map::PageMap;
use super::page_picture::PagePicture;
use super::panel::OperatorPanel;
use super::screen_zoom::{self, ScreenZoom, ZoomedPage, ZoomedScreen};
use super::swipe::{Swipe, SwipeTurn};
use super::theme::{self, Theme};
use super::variable_entry::VariableEntry;
use super::{
    EditKey, FieldEditor, KeyboardInput, View, aside, blink_phase, clock_time, demo_band, file_command, keyboard,
};
use crate::defs::favourite::Favourite;
use crate::defs::key::Key;
use crate::defs::kind::Kind;
use crate::defs::page::Page;
use crate::defs::param;
use crate::defs::soft_key::{self, SoftKeyAction};
use crate::defs::text::{Lang, Text, Translation};
use crate::hmi::page::grinding::GrindingPage;
use crate::hmi::page::help::{Help, HelpTouch};
use crate::hmi::page::program::ProgramPage;
use crate::hmi::page::{PageSet, PageUi};
use crate::link::files::{FileRequest, Requester};
use crate::link::media::Screenshot;
use crate::link::page_command::{BRIGHTNESS, PageCommand, ZOOMS};
use crate::link::{Command, Snapshot};

/// How long a local refusal stays in the message line, s.
const HINT_SECONDS: f64 = 5.0;
/// How long a page fades in, s.
const FADE_SECONDS: f64 = 0.1;

/// The user interface of the control. One value lives as long as the window.
pub struct Hmi {
    lang: Lang,
    light: bool,
    theme: Theme,
    /// Percent.
    brightness: u8,
    zoom: ScreenZoom,
    page: Option<Page>,
    pages: PageSet,
    /// Kind and number of the control of the newest snapshot.
    recorded: Option<(Kind, u32)>,
    panel: OperatorPanel,
    presses: KeyPresses,
    /// The help over a page.
    help: Help,
    help_open: bool,
    page_map: PageMap,
    favourites: Arc<[Favourite]>,
    languages: Arc<[Lang]>,
    has_language_faults: bool,
    hint: Option<(Text, f64)>,
    explanation: Explanation,
    swipe: Swipe,
    /// When the page was opened that is fading in, s of the screen; only where pages fade.
    faded_since: Option<f64>,
    /// Pages fade in when they open.
    fades: bool,
    closing: Closing,
    /// The window was asked to close since the last frame.
    close_asked: bool,
    pad: NumericPad,
    picture: PagePicture,
    /// Screenshots that wait to be sent to the disk thread.
    screenshots: Arc<Mutex<Vec<Arc<ColorImage>>>>,
}

/// Where a frame draws.
struct FramePlaces<'a> {
    view: &'a View<'a>,
    /// The display; a zoomed screen is clipped to its part.
    outer: &'a View<'a>,
    regions: &'a Regions,
    zoomed: Option<&'a ZoomedScreen>,
    /// The page.
    content: Rect,
}

/// What lives for one frame.
struct FrameScratch {
    theme: Theme,
    clock: String,
    favourites: Arc<[Favourite]>,
    languages: Arc<[Lang]>,
    entry: Cell<Option<Rect>>,
    prompt: RefCell<String>,
}

impl Hmi {
    /// A user interface in a language, with the dark theme.
    #[must_use]
    pub fn new(lang: Lang) -> Self {
        Self {
            lang,
            light: false,
            theme: theme::DARK,
            brightness: *BRIGHTNESS.end(),
            zoom: ScreenZoom::default(),
            page: None,
            pages: PageSet::default(),
            recorded: None,
            panel: OperatorPanel::default(),
            presses: KeyPresses::default(),
            help: Help::default(),
            help_open: false,
            page_map: PageMap::default(),
            favourites: Arc::default(),
            languages: Arc::new([Lang::Zh, Lang::En]),
            has_language_faults: false,
            hint: None,
            explanation: Explanation::default(),
            swipe: Swipe::default(),
            faded_since: None,
            fades: false,
            closing: Closing::default(),
            close_asked: false,
            pad: NumericPad::default(),
            picture: PagePicture::default(),
            screenshots: Arc::default(),
        }
    }

    /// Installs font and style in an egui context. Call it once, before the first frame.
    pub fn install(&self, ctx: &egui::Context) {
        theme::install(ctx, &self.theme);
    }

    /// The light theme for bright halls, or the dark one (H4).
    pub const fn set_light(&mut self, light: bool) {
        self.light = light;
        self.theme = if light { theme::LIGHT } else { theme::DARK };
    }

    /// What the home page keeps.
    pub fn set_favourites(&mut self, favourites: Vec<Favourite>) {
        self.favourites = favourites.into();
    }

    /// The languages that the settings page offers beside Chinese and English, and whether something is wrong with their
    /// files.
    pub fn add_languages(&mut self, added: &[&'static Translation], has_faults: bool) {
        self.has_language_faults = has_faults;
        let added = added.iter().map(|translation| Lang::Added(translation));
        self.languages = [Lang::Zh, Lang::En].into_iter().chain(added).collect();
    }

    /// Pages fade in when they open: on a display, not on pictures.
    pub const fn set_fades(&mut self, fades: bool) {
        self.fades = fades;
    }

    /// The colour that the window is cleared with; a frame does not paint it again.
    #[must_use]
    pub const fn background(&self) -> Color32 {
        self.theme.background
    }

    /// The colours.
    #[must_use]
    pub const fn theme(&self) -> &Theme {
        &self.theme
    }

    /// Sets the picture brightness, percent; below 100 a dark overlay covers the picture (B6).
    pub fn set_brightness(&mut self, percent: u8) {
        self.brightness = percent.clamp(*BRIGHTNESS.start(), *BRIGHTNESS.end());
    }

    /// Sets the size of the screen, percent: one of those of [`crate::link::page_command::ZOOMS`].
    pub fn set_zoom(&mut self, percent: u16) {
        self.zoom.set_percent(percent);
    }

    /// How much larger everything is than the size of the display asks for.
    #[must_use]
    pub fn zoom(&self) -> f32 {
        f32::from(self.zoom.percent()) / 100.0
    }

    /// The value being typed, for tests and stories.
    #[must_use]
    pub fn variable_entry(&self) -> Option<&VariableEntry> {
        self.pages.state(Page::Grinding).map(|page: &GrindingPage| &page.entry)
    }

    /// The text typed on the open page that the page or the core refused, and the reason; for tests.
    #[must_use]
    pub fn refusal(&self, lang: Lang) -> Option<(String, String)> {
        self.pages.page(self.page?).refusal(lang)
    }

    /// The text on the program page with unsaved changes; for tests.
    #[must_use]
    pub fn program_text(&self) -> Option<&ropey::Rope> {
        self.pages.state(Page::Program).map(ProgramPage::text)
    }

    /// The window manager, or a key of it, asks to close the window: the next frame refuses it or asks the operator.
    pub const fn ask_to_close(&mut self) {
        self.close_asked = true;
    }

    /// Whether the operator has confirmed that the window closes.
    #[must_use]
    pub const fn may_close(&self) -> bool {
        self.closing.is_confirmed()
    }

    /// Every page records what it needs of a snapshot; called for each new one, painted or not. On another control all pages
    /// begin anew.
    pub fn record(&mut self, snapshot: &Snapshot) {
        let now = (snapshot.kind, snapshot.host.control);
        if self.recorded.is_some_and(|before| before != now) {
            (self.page, self.pages, self.picture) = (None, PageSet::default(), PagePicture::default());
        }
        self.recorded = Some(now);
        self.pages.record(snapshot);
    }

    /// Draws one frame over the whole `ui` and returns the operator's commands.
    /// egui may run several passes per frame: collect the commands of all passes and send them once.
    pub fn ui(&mut self, ui: &mut Ui, snapshot: &Snapshot) -> Vec<Command> {
        let mut out = Vec::new();
        self.record(snapshot);
        let zoomed = self.zoom.place(ui.max_rect());
        let screen = screen_zoom::screen_of(ui, zoomed.as_ref());
        let (display, ui) = (&*ui, &screen);
        let frame = self.scratch(snapshot);
        let view = self.view(ui, snapshot, &frame);
        let outer = View { ui: display, painter: display.painter().clone(), ..view.clone() };
        self.follow_snapshot(&view);
        let (regions, panel) = screen_zoom::layout(&screen, zoomed.as_ref(), snapshot.fitted());
        let words =
            if self.help_open { self.help.accepts_text() } else { self.pages.page(snapshot.page).accepts_text() };
        let words = words && !snapshot.state.is_active() && !self.page_map.is_open();
        let mut asked = keyboard::read(ui, snapshot.fitted(), words);
        out.extend(self.screenshot_commands(snapshot.params.bit(param::PRINT_AS_BMP)));
        self.handle_physical_keys(&view, &asked, &mut out);
        if let Some(reason) = self.panel.ui(&panel, &view, &mut self.presses, &mut out) {
            self.show_hint(ui, reason);
        }
        if let Some(key) = self.presses.take_explained() {
            self.explanation.show(&view, key);
        }
        asked.edits.splice(..0, self.pad.take_touched());
        let to_closing = self.edits_for_closing(&view, &mut asked);
        let (content, band) = demo_band::split(regions.content, &snapshot.host.demo);
        let (content, strip) = aside::split(content, snapshot.page);
        if let Some(strip) = strip {
            aside::ui(&view, strip);
            frame.entry.set(None);
        }
        self.draw_content(content, &view, &asked, &mut out);
        demo_band::title(&view, content);
        if let Some(band) = band {
            demo_band::ui(&view, band);
        }
        out.extend(demo_band::takes_over(&view).then_some(Command::TakeOver));
        self.closing.ui(content, &view, &to_closing, &mut out);
        let typing = !self.is_page_covered() && self.pages.wants_pad(&view) || self.closing.wants_pad();
        let places = FramePlaces { view: &view, outer: &outer, regions: &regions, zoomed: zoomed.as_ref(), content };
        self.draw_frame(&places, &asked, typing, &mut out);
        self.draw_pad(&places, &asked, typing, &mut out);
        if out.iter().any(|command| matches!(command, Command::OpenPage(_) | Command::ShowCoordinates(_))) {
            self.page_map.close();
        }
        if self.brightness < *BRIGHTNESS.end() {
            display.painter().rect_filled(display.max_rect(), 0.0, theme::dimming_overlay(self.brightness));
        }
        self.presses.end_frame(ui, &mut out);
        for command in &mut out {
            if let Command::Press(key) = *command {
                *command = snapshot.press_command(key);
            }
        }
        out
    }

    fn scratch(&self, snapshot: &Snapshot) -> FrameScratch {
        let (favourites, languages) = (Arc::clone(&self.favourites), Arc::clone(&self.languages));
        let (theme, clock) = (self.theme, clock_time(snapshot));
        FrameScratch { theme, clock, favourites, languages, entry: Cell::new(None), prompt: RefCell::default() }
    }

    /// What the pages draw from in this frame.
    fn view<'a>(&self, ui: &'a Ui, snapshot: &'a Snapshot, frame: &'a FrameScratch) -> View<'a> {
        let FrameScratch { theme, clock, favourites, languages, entry, prompt } = frame;
        let (painter, blink) = (ui.painter().clone(), blink_phase(snapshot.now));
        let Self { lang, has_language_faults, light, brightness, .. } = *self;
        let zoom = self.zoom.percent();
        View {
            ui,
            painter,
            snapshot,
            lang,
            languages,
            has_language_faults,
            theme,
            light,
            brightness,
            zoom,
            favourites,
            clock,
            blink,
            entry,
            prompt,
        }
    }

    /// Reacts to a new page, program or picture in the snapshot.
    fn follow_snapshot(&mut self, view: &View<'_>) {
        let (ui, snapshot) = (view.ui, view.snapshot);
        if self.page != Some(snapshot.page) {
            self.faded_since = self.page.filter(|_| self.fades).map(|_| ui.input(|input| input.time));
            self.page = Some(snapshot.page);
            self.help_open = false;
            self.page_map.close();
            self.swipe.forget();
            self.pages.open(view);
        }
        self.picture.follow(ui.ctx(), self.pages.page(snapshot.page).picture(snapshot), self.light);
        let now = ui.input(|input| input.time);
        self.hint.take_if(|(_, since)| now - *since >= HINT_SECONDS);
    }

    /// Answers a request to close the window; gives the keys for its question, which the page does not get.
    fn edits_for_closing(&mut self, view: &View<'_>, asked: &mut KeyboardInput) -> Vec<EditKey> {
        if std::mem::take(&mut self.close_asked)
            && let Some(reason) = self.closing.ask(view)
        {
            self.show_hint(view.ui, reason);
        }
        if self.closing.is_open() { std::mem::take(&mut asked.edits) } else { Vec::new() }
    }

    /// A swipe over the page opens the next page of its row, or the one before.
    fn follow_swipe(&mut self, view: &View<'_>, content: Rect, out: &mut Vec<Command>) {
        if self.is_page_covered() {
            return self.swipe.forget();
        }
        let Some(turn) = self.swipe.follow(view.ui, content) else { return };
        let open = soft_key::key_of_page(view.snapshot.page, view.snapshot.coordinates);
        let Some((row, _)) = soft_key::place(view.snapshot.kind, open) else { return };
        let pages: Vec<_> = soft_key::row(view.snapshot.kind, row).map(|soft| soft.action).collect();
        let pages: Vec<_> = pages.into_iter().filter(|action| action.opens_page()).collect();
        let Some(at) = pages.iter().position(|action| *action == open) else { return };
        let wanted = match turn {
            SwipeTurn::Next => at.checked_add(1),
            SwipeTurn::Previous => at.checked_sub(1),
        };
        if let Some(action) = wanted.and_then(|index| pages.get(index)) {
            self.run_soft_key(view.ui, *action, out);
        }
    }

    /// Lets a page that was opened appear: it is there at once, under a veil that is gone after a moment.
    fn fade(&mut self, view: &View<'_>, content: Rect) {
        let Some(since) = self.faded_since else { return };
        let gone = (view.ui.input(|input| input.time) - since) / FADE_SECONDS;
        if gone >= 1.0 {
            self.faded_since = None;
            return;
        }
        view.painter.rect_filled(content, 0.0, view.theme.background.gamma_multiply(0.6 * (1.0 - gone as f32)));
        view.ui.ctx().request_repaint();
    }

    fn show_hint(&mut self, ui: &Ui, reason: Text) {
        self.hint = Some((reason, ui.input(|input| input.time)));
        ui.ctx().request_repaint_after(std::time::Duration::from_secs_f64(HINT_SECONDS + 0.05));
    }

    /// The page, or what lies over it.
    fn draw_content(&mut self, content: Rect, view: &View<'_>, asked: &KeyboardInput, out: &mut Vec<Command>) {
        if self.help_open {
            let touch = self.help.overlay(view, content.shrink(theme::GAP), asked);
            self.handle_help(view, touch, out);
        } else if self.page_map.is_open() {
            if let Some(action) = self.page_map.ui(view, content, &asked.edits) {
                self.run_soft_key(view.ui, action, out);
            }
        } else {
            self.draw_page(content, view, asked, out);
        }
        let part = view.ui.clip_rect();
        self.follow_swipe(view, content.intersect(part), out);
        self.fade(view, content.intersect(part));
        self.explanation.ui(view, if view.zoom == ZOOMS[0] { content } else { part });
    }

    fn draw_page(&mut self, rect: Rect, view: &View<'_>, typed: &KeyboardInput, out: &mut Vec<Command>) {
        if !typed.edits.is_empty() {
            self.hint = None;
        }
        let commands = self.pages.ui(rect, view, typed, self.picture.texture());
        self.follow_settings(&commands);
        out.extend(commands);
    }

    /// The touch of the help overlay: it stays open while favourites are chosen.
    fn handle_help(&mut self, view: &View<'_>, touch: Option<HelpTouch>, out: &mut Vec<Command>) {
        self.help_open = matches!(touch, None | Some(HelpTouch::Keep(_)));
        match touch {
            Some(HelpTouch::Open((page, what))) => {
                self.pages.hand_over(what);
                match page == view.snapshot.page {
                    true => self.pages.open(view),
                    false => out.push(Command::OpenPage(page)),
                }
            }
            Some(HelpTouch::Keep(favourites)) => {
                let commands = [Command::Page(PageCommand::SetFavourites(favourites))];
                self.follow_settings(&commands);
                out.extend(commands);
            }
            Some(HelpTouch::Close) | None => {}
        }
    }

    /// The screen follows what is set on it at once.
    fn follow_settings(&mut self, commands: &[Command]) {
        for command in commands {
            match command {
                Command::Page(PageCommand::SetLang(lang)) => self.lang = *lang,
                Command::Page(PageCommand::SetLightTheme(light)) => self.set_light(*light),
                Command::Page(PageCommand::SetBrightness(percent)) => self.set_brightness(*percent),
                Command::Page(PageCommand::SetZoom(percent)) => self.set_zoom(*percent),
                Command::Page(PageCommand::SetFavourites(favourites)) => self.set_favourites(favourites.clone()),
                _ => {}
            }
        }
    }

    /// The numeric pad, and what is beside a zoomed part.
    fn draw_pad(&mut self, places: &FramePlaces<'_>, asked: &KeyboardInput, typing: bool, out: &mut Vec<Command>) {
        let FramePlaces { view, outer, regions, zoomed, content } = *places;
        let (area, pad_room) = match zoomed {
            Some(place) => (place.part, place.part.shrink(theme::GAP)),
            None => (regions.header.union(regions.soft), self.pages.pad_room(view, content)),
        };
        if let Some(place) = zoomed {
            if let Some(reason) = self.zoom.strip(outer, place, &mut self.presses, out) {
                self.show_hint(view.ui, reason);
            }
            self.zoom.step(place, asked.zoom_steps);
            let (is_covered, has_keys) = (self.is_page_covered(), !asked.edits.is_empty() || !asked.text.is_empty());
            self.zoom.follow(outer, place, ZoomedPage { is_covered, is_typing: typing, has_keys });
        }
        self.zoom.cover(outer, area, false);
        self.pad.ui(view, pad_room, typing);
        self.zoom.cover(outer, area, true);
    }

    fn draw_frame(&mut self, places: &FramePlaces<'_>, asked: &KeyboardInput, typing: bool, out: &mut Vec<Command>) {
        let FramePlaces { view, outer, regions, .. } = *places;
        let has_typed = |typing: &FieldEditor| !typing.text.is_empty() || typing.refused.is_some();
        if !typing && !self.pages.page(view.snapshot.page).typing().is_some_and(has_typed) {
            view.prompt.take();
        }
        let header = page_frame::header(view, regions.header);
        let hint = self.hint.map(|(text, _)| text.get(view.lang));
        let of_page = self.pages.page(view.snapshot.page).message(view.lang).filter(|_| !self.is_page_covered());
        let message = page_frame::message_line(outer, regions.message, hint, of_page.as_deref());
        let status = page_frame::status_line(view, regions.status);
        match header.or(message).or(status) {
            Some(FrameTouch::Help) => self.toggle_help(view),
            Some(FrameTouch::Search) => self.open_search(view),
            Some(FrameTouch::Home) => out.push(Command::OpenPage(Page::Home)),
            Some(FrameTouch::Alarm) => out.push(Command::OpenPage(Page::Alarm)),
            Some(FrameTouch::InterruptedRun) => out.push(Command::OpenPage(Page::Program)),
            None => {}
        }
        let rows = page_frame::soft_key_row_count(view);
        let row = view.snapshot.soft_key_row % rows;
        let touched = page_frame::soft_keys(view, regions.soft, row);
        // The label shown counts, even if the core has changed the row since.
        let by_key = asked.soft_key.and_then(|index| page_frame::soft_key_row(view, row).nth(index));
        match touched.or(by_key.map(|soft| SoftKeyPress::Act(soft.action))) {
            Some(SoftKeyPress::Act(action)) => self.run_soft_key(view.ui, action, out),
            Some(SoftKeyPress::Map) => self.toggle_map(view),
            Some(SoftKeyPress::Row(row)) => out.push(Command::ShowSoftKeyRow(row)),
            None if asked.page_map => self.toggle_map(view),
            None if asked.next_soft_row => out.push(Command::ShowSoftKeyRow((row + 1) % rows)),
            None if asked.previous_soft_row => out.push(Command::ShowSoftKeyRow((row + rows - 1) % rows)),
            None => {}
        }
    }

    /// Opens the help overlay at the open page, or closes it.
    fn toggle_help(&mut self, view: &View<'_>) {
        self.page_map.close();
        self.help_open = !self.help_open && view.snapshot.page != Page::Help;
        if self.help_open {
            let page = view.snapshot.page;
            self.help.open_at(view, page, self.pages.page(page).help_alarm(view));
        }
    }

    /// Whether the help or the map of the pages lies over the page.
    const fn is_page_covered(&self) -> bool {
        self.help_open || self.page_map.is_open()
    }

    /// Opens the map of the pages, or closes it.
    fn toggle_map(&mut self, view: &View<'_>) {
        self.help_open = false;
        self.page_map.toggle(view);
    }

    /// Opens the help overlay with its search.
    fn open_search(&mut self, view: &View<'_>) {
        self.page_map.close();
        self.help_open = true;
        self.help.open_search(view, view.snapshot.page);
    }

    fn run_soft_key(&mut self, ui: &Ui, action: SoftKeyAction, out: &mut Vec<Command>) {
        match action {
            SoftKeyAction::Open(page) => out.push(Command::OpenPage(page)),
            SoftKeyAction::Position(coordinates) => out.push(Command::ShowCoordinates(coordinates)),
            SoftKeyAction::Print => self.request_screenshot(ui),
            SoftKeyAction::Continue => out.push(Command::Press(Key::F1)),
        }
    }

    /// Requests a screenshot; it arrives after the frame is painted.
    fn request_screenshot(&self, ui: &Ui) {
        let (prints, ctx) = (Arc::clone(&self.screenshots), ui.ctx().clone());
        ui.ctx().request_screenshot(move |image| {
            prints.lock().unwrap_or_else(PoisonError::into_inner).push(image);
            ctx.request_repaint();
        });
    }

    /// The screenshots that have arrived.
    #[must_use]
    pub const fn screenshots(&self) -> &Arc<Mutex<Vec<Arc<ColorImage>>>> {
        &self.screenshots
    }

    /// Commands that send the screenshots that arrived since the last frame to the disk thread.
    fn screenshot_commands(&self, bmp: bool) -> Vec<Command> {
        let pictures = std::mem::take(&mut *self.screenshots.lock().unwrap_or_else(PoisonError::into_inner));
        let print = |image: Arc<ColorImage>| {
            let rgb: Vec<u8> = image.pixels.iter().flat_map(|pixel| [pixel.r(), pixel.g(), pixel.b()]).collect();
            let (width, height) = (image.width() as u32, image.height() as u32);
            let print = Screenshot { width, height, rgb: rgb.into(), as_bmp: bmp };
            file_command(Requester::Screen, FileRequest::SaveScreenshot(print))
        };
        pictures.into_iter().map(print).collect()
    }

    fn handle_physical_keys(&mut self, view: &View<'_>, asked: &KeyboardInput, out: &mut Vec<Command>) {
        let now = view.ui.input(|input| input.time);
        self.presses.track_keyboard(view.ui, out);
        for shortcut in &asked.keys {
            if let Some(reason) = super::panel::key_state(view, shortcut.key).blocked {
                self.show_hint(view.ui, reason);
            }
            self.presses.key_down(shortcut.physical, shortcut.modifiers, shortcut.key, now, out);
        }
        // Sent in every view of the page: if no dressing point can be set, the core reports the reason.
        let position = view.snapshot.page == Page::Position;
        for key in asked.address_keys.iter().filter(|_| position && !self.is_page_covered()) {
            out.extend([Command::Press(*key), Command::Release(*key)]);
        }
        if asked.handwheel_detents != 0 {
            out.push(Command::Handwheel(asked.handwheel_detents));
        }
        if asked.alarm_page {
            out.push(Command::OpenPage(Page::Alarm));
        }
        if asked.help {
            self.toggle_help(view);
        }
    }
}
