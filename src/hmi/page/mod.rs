//! The pages: a page is one file behind [`PageUi`] and one row of the table below. A page draws from the view and keeps
//! only its cursor and its edit text; no page knows another page's state.

pub mod accept_data;
mod alarm;
mod bus;
pub mod designer;
pub mod diagnosis;
pub mod directory;
pub mod dressing;
pub mod empty;
pub mod favourites;
pub mod graphic;
pub mod grinding;
pub mod help;
pub mod home;
pub mod input_line;
mod jobs;
pub mod mdi;
mod network;
pub mod offset;
pub mod params;
pub mod position;
pub mod process;
pub mod program;
pub mod run_bar;
pub mod scope;
pub mod scroll;
pub mod serial;
pub mod settings;
pub mod simulator;
pub mod start_strip;
pub mod teach;
pub mod technology;
pub mod tools;
pub mod transfer;
pub mod variables;
pub mod wheel;

use std::any::Any;
use std::fmt;
use std::sync::Arc;

use egui::{Rect, TextureId};

use crate::defs::page::Page;
use crate::defs::param::ParamAddress;
use crate::defs::text::Lang;
use crate::hmi::{FieldEditor, KeyboardInput, Login, View};
use crate::link::screens::Picture;
use crate::link::{Command, Snapshot};
pub use input_line::InputPrompt;
pub use scroll::{Scroll, ScrollList, VisibleRows};

/// What a page draws from in one frame, and where its commands go.
pub struct PageContext<'a> {
    /// Area of the page, points.
    pub rect: Rect,
    /// State of the machine, language and colours.
    pub view: &'a View<'a>,
    /// Keyboard input.
    pub typed: &'a KeyboardInput,
    /// The picture that the page asked for with [`PageUi::picture`].
    pub picture: Option<TextureId>,
    /// The password dialog; it is drawn over the page.
    pub login: &'a mut Login,
    /// What this page hands to the page that it opens.
    pub hand_over: &'a mut Option<HandOver>,
    /// The operator's commands.
    pub out: &'a mut Vec<Command>,
}

/// What a page hands to the page that it opens: that page shows it first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HandOver {
    /// A program.
    Program(u32),
    /// A variable.
    Variable(u16),
    /// A parameter.
    Param(ParamAddress),
}

impl HandOver {
    /// The program.
    pub const fn program(self) -> Option<u32> {
        if let Self::Program(number) = self { Some(number) } else { None }
    }

    /// The variable.
    pub const fn variable(self) -> Option<u16> {
        if let Self::Variable(number) = self { Some(number) } else { None }
    }

    /// The parameter.
    pub const fn param(self) -> Option<ParamAddress> {
        if let Self::Param(address) = self { Some(address) } else { None }
    }
}

/// A page of the control screen.
pub trait PageUi: Any + fmt::Debug + Send {
    /// Draws the page and handles its input.
    fn ui(&mut self, ctx: PageContext<'_>);

    /// The page was opened; the page before may have handed something over.
    fn open(&mut self, _view: &View<'_>, _handed_over: Option<HandOver>) {}

    /// Another page was opened in its place.
    fn close(&mut self) {}

    /// A new snapshot arrived; called for each one, also while the page is closed.
    fn record(&mut self, _snapshot: &Snapshot) {}

    /// The value being typed; none on a page that takes no value.
    fn typing(&self) -> Option<&FieldEditor> {
        None
    }

    /// The text that the page or the core refused, and the reason.
    fn refusal(&self, lang: Lang) -> Option<(String, String)> {
        let typing = self.typing()?;
        Some((typing.text.clone(), typing.refusal(lang)?.into_owned()))
    }

    /// The message that the page shows itself; the message line does not repeat it.
    fn message(&self, _lang: Lang) -> Option<String> {
        None
    }

    /// Whether the numeric pad is shown.
    fn wants_pad(&self, _view: &View<'_>) -> bool {
        self.typing().is_some_and(|typing| typing.pad_open)
    }

    /// Where the numeric pad lies in the area of the page: beside the field, above the input line. A page that has a
    /// column without values names it, so that the pad stays where it is from field to field.
    fn pad_room(&self, rect: Rect) -> Rect {
        input_line::pad_room(rect)
    }

    /// Whether typed letters are text now; otherwise they are keys of the panel.
    fn accepts_text(&self) -> bool {
        false
    }

    /// The picture that the page shows.
    fn picture<'a>(&self, _snapshot: &'a Snapshot) -> Option<&'a Arc<Picture>> {
        None
    }

    /// Number of the alarm at which the help opens; none: at the page.
    fn help_alarm(&self, _view: &View<'_>) -> Option<u16> {
        None
    }
}

/// Fields of a snapshot that only some pages show: a change of them is painted on those pages alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldGroup {
    /// The part of the last cycle.
    PartResult,
    /// Values of macro variables.
    Variables,
    /// Inputs.
    Inputs,
    /// Outputs, terminals, analog outputs, internal signals.
    Diagnosis,
    /// The field bus.
    Bus,
    /// The network services.
    Network,
    /// The scope.
    Scope,
    /// The simulated machine.
    Simulated,
    /// The stock of the drawing.
    Stock,
    /// The live scene of the machine.
    Scene,
    /// Tool offsets and work offsets.
    Offsets,
    /// The dressing point.
    DressingPoint,
    /// Tables of the ball screws.
    Leadscrews,
    /// Restart and interrupted program.
    Restart,
    /// Codes in force and the prepared MDI line.
    Mdi,
    /// Teach-in.
    Teach,
    /// The conditions of the next cycle start.
    StartGuide,
    /// Finished parts and orders.
    Production,
}

macro_rules! page_rows {
    ($($page:ident => $state:ty $(, shows $($group:ident)+)?;)*) => {
        fn new_page(page: Page) -> Box<dyn PageUi> {
            match page { $(Page::$page => Box::<$state>::default(),)* }
        }

        /// What a page shows beside the fields that all pages show.
        pub(super) const fn shown_fields(page: Page) -> &'static [FieldGroup] {
            match page { $(Page::$page => &[$($(FieldGroup::$group),+)?],)* }
        }
    };
}

// One row per page; a page without a row does not compile.
page_rows! {
    Position => position::PositionPage, shows Scene StartGuide;
    Panel => position::PositionPage, shows Scene StartGuide;
    Grinding => grinding::GrindingPage, shows Variables PartResult DressingPoint Scene StartGuide;
    Dressing => dressing::DressingPage, shows Offsets Variables DressingPoint Scene StartGuide;
    Program => program::ProgramPage, shows Restart;
    Designer => designer::DesignerPage, shows Variables;
    Mdi => mdi::MdiPage, shows Mdi;
    Directory => directory::DirectoryPage;
    Offset => offset::OffsetPage, shows Offsets;
    Macro => variables::VariablesPage, shows Variables;
    Teach => teach::TeachPage, shows Teach;
    Tools => tools::ToolsPage;
    Wheel => wheel::WheelPage, shows Production;
    Params => params::ParamPage, shows Leadscrews;
    Diagnosis => diagnosis::DiagnosisPage, shows Inputs Diagnosis;
    Graphic => graphic::GraphicPage, shows Simulated Stock Scene;
    Transfer => transfer::TransferPage;
    Process => process::ProcessPage, shows Inputs Simulated PartResult Production;
    Alarm => alarm::AlarmPage;
    Settings => settings::SettingsPage;
    Bus => bus::BusPage, shows Bus;
    Simulator => simulator::SimulatorPage, shows Inputs Simulated Scene;
    Technology => technology::TechnologyPage, shows Variables;
    Scope => scope::ScopePage, shows Scope;
    Home => home::HomePage, shows Production PartResult Simulated Scene StartGuide Variables;
    Jobs => jobs::JobsPage, shows Production;
    Network => network::NetworkPage, shows Network;
    Help => help::Help;
}

/// State of all pages.
#[derive(Debug)]
pub struct PageSet {
    /// By `Page as usize`.
    pages: Vec<Box<dyn PageUi>>,
    /// The open page.
    open: Option<Page>,
    /// Handed over to the next page.
    hand_over: Option<HandOver>,
    login: Login,
}

impl Default for PageSet {
    fn default() -> Self {
        let pages = Page::ALL.iter().copied().map(new_page).collect();
        Self { pages, open: None, hand_over: None, login: Login::default() }
    }
}

impl PageSet {
    /// A page, open or closed.
    pub fn page(&self, page: Page) -> &dyn PageUi {
        self.pages[page as usize].as_ref()
    }

    /// State of a page as its own type; none if the page is of another type.
    pub fn state<T: PageUi>(&self, page: Page) -> Option<&T> {
        let state: &dyn Any = self.page(page);
        state.downcast_ref()
    }

    /// Closes the page before and opens the page of the view.
    pub fn open(&mut self, view: &View<'_>) {
        let page = view.snapshot.page;
        if let Some(before) = self.open.replace(page) {
            self.pages[before as usize].close();
        }
        self.login.close();
        self.pages[page as usize].open(view, self.hand_over.take());
    }

    /// Hands something over to the page that is opened next.
    pub const fn hand_over(&mut self, what: Option<HandOver>) {
        self.hand_over = what;
    }

    /// Every page records what it needs of a snapshot, open or closed.
    pub fn record(&mut self, snapshot: &Snapshot) {
        self.pages.iter_mut().for_each(|page| page.record(snapshot));
    }

    /// Whether the numeric pad is shown.
    pub fn wants_pad(&self, view: &View<'_>) -> bool {
        self.login.is_open() || self.page(view.snapshot.page).wants_pad(view)
    }

    /// Where the numeric pad lies in the area of the page.
    pub fn pad_room(&self, view: &View<'_>, rect: Rect) -> Rect {
        if self.login.is_open() { input_line::pad_room(rect) } else { self.page(view.snapshot.page).pad_room(rect) }
    }

    /// Draws the open page; returns its commands.
    pub fn ui(&mut self, rect: Rect, view: &View<'_>, typed: &KeyboardInput, image: Option<TextureId>) -> Vec<Command> {
        let mut out = Vec::new();
        let (login, hand_over) = (&mut self.login, &mut self.hand_over);
        let ctx = PageContext { rect, view, typed, picture: image, login, hand_over, out: &mut out };
        self.pages[view.snapshot.page as usize].ui(ctx);
        self.login.ui(rect, view, &typed.edits, &mut out);
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn k7_1_every_page_has_its_own_row_at_its_own_place() {
        let rows = PageSet::default();
        assert_eq!(rows.pages.len(), Page::ALL.len());
        for (index, page) in Page::ALL.iter().copied().enumerate() {
            assert_eq!(page as usize, index);
            let own = |page: Page| -> std::any::TypeId { rows.page(page).type_id() };
            let same: Vec<Page> = Page::ALL.iter().copied().filter(|other| own(*other) == own(page)).collect();
            // The panel stands beside every page: its page shows the positions.
            let expected = matches!(page, Page::Position | Page::Panel);
            assert_eq!(same.len(), if expected { 2 } else { 1 }, "{page:?} shares its state with {same:?}");
        }
    }
}
