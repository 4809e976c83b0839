//! The pages. Each page draws from the view and keeps only its cursor and its edit text.

pub mod alarm;
pub mod designer;
pub mod diagnosis;
pub mod directory;
pub mod dressing;
pub mod empty;
pub mod graphic;
pub mod grinding;
pub mod input_line;
pub mod mdi;
pub mod offset;
pub mod params;
pub mod position;
pub mod process;
pub mod program;
pub mod scroll;
pub mod serial;
pub mod settings;
pub mod simulator;
mod teach;
mod tools;
pub mod transfer;
pub mod variables;
pub mod wheel;

use egui::{Rect, TextureId, Ui};

use super::help::Help;
use super::login::Login;
use super::page_frame;
use super::variable_entry::{EditKey, VariableEntry};
use super::view::View;
use crate::defs::key::Key;
use crate::defs::page::Page;
use crate::defs::text::Lang;
use crate::link::Command;

/// Keyboard input of this frame.
#[derive(Clone, Copy, Debug, Default)]
pub struct TypedInput<'a> {
    /// Digits, cursor moves, Enter and Cancel.
    pub edits: &'a [EditKey],
    /// All typed characters, for pages that accept text.
    pub text: &'a str,
    /// Keys pressed with Ctrl.
    pub ctrl_keys: &'a [egui::Key],
    /// Number of pages to scroll.
    pub scroll_pages: i32,
}

/// State of all pages.
#[derive(Debug, Default)]
pub struct PageSet {
    /// Value being typed on the grinding page.
    pub entry: VariableEntry,
    /// Help on pages, keys, alarms and codes.
    pub help: Help,
    /// Page designer.
    pub designer: designer::DesignerPage,
    program: program::ProgramPage,
    graphic: graphic::GraphicPage,
    transfer: transfer::TransferPage,
    process: process::ProcessPage,
    simulator: simulator::SimulatorPage,
    simulator_tab_index: usize,
    directory: directory::DirectoryPage,
    diagnosis: diagnosis::DiagnosisPage,
    alarms: alarm::AlarmPage,
    params: params::ParamPage,
    settings: settings::SettingsPage,
    offset: offset::OffsetPage,
    dressing: dressing::DressingPage,
    variables: variables::VariablesPage,
    mdi: mdi::MdiPage,
    wheel: wheel::WheelPage,
    teach: teach::TeachPage,
    tools: tools::ToolsPage,
    login: Login,
}

impl PageSet {
    /// Resets the pages after another page was opened.
    pub fn open(&mut self, view: &View<'_>) {
        self.entry.restart();
        self.login.close();
        self.directory.open(view);
        self.program.open();
        self.designer.open(view, self.directory.designer_program.take());
        self.transfer.open();
        self.alarms.open();
        self.diagnosis = diagnosis::DiagnosisPage::default();
        self.settings = settings::SettingsPage::default();
        self.simulator = simulator::SimulatorPage::default();
        self.params.open();
        self.offset.table.open(view.snapshot.active_offset);
        self.dressing.table.open(view.snapshot.active_offset);
        self.variables.open();
        self.mdi.open();
        self.wheel = wheel::WheelPage::default();
        self.tools = tools::ToolsPage::default();
        self.help.open(view, Page::Help, None);
    }

    /// Opens the help for the open page; on the alarm page for the selected alarm.
    pub fn open_help(&mut self, view: &View<'_>) {
        let page = view.snapshot.page;
        let alarm = self.alarms.selected_number(view).filter(|_| page == Page::Alarm);
        self.help.open(view, page, alarm);
    }

    /// Records path and process data; called in every frame, whichever page is open.
    pub fn update_background(&mut self, view: &View<'_>) {
        self.graphic.record_position(view);
        self.process.record_sample(view);
    }

    /// Drops the typed value; called when another program becomes current.
    pub fn restart_entry(&mut self) {
        self.entry.restart();
    }

    /// Why the value typed on the parameter page was refused.
    #[must_use]
    pub fn param_refusal(&self, lang: Lang) -> Option<String> {
        self.params.typing.refusal(lang).map(str::to_owned)
    }

    /// What was typed on the open page, and why it was refused.
    #[must_use]
    pub fn refusal(&self, page: Page, lang: Lang) -> Option<(String, String)> {
        let typing = match page {
            Page::Offset => &self.offset.table.typing,
            Page::Dressing => &self.dressing.table.typing,
            Page::Macro => &self.variables.typing,
            Page::Mdi => &self.mdi.typing,
            Page::Wheel => &self.wheel.typing,
            Page::Tools => &self.tools.typing,
            Page::Settings => &self.settings.clock.typing,
            Page::Directory => &self.directory.typing,
            Page::Params => self.params.typing(),
            Page::Transfer => return Some((String::new(), self.transfer.refusal()?.get(lang).to_owned())),
            Page::Designer => {
                return Some((self.designer.text().to_string(), self.designer.refusal()?.get(lang).to_owned()));
            }
            Page::Program => {
                let (text, why) = (self.program.text().to_string(), self.program.refusal()?);
                return Some((text, why.get(lang).to_owned()));
            }
            _ => &self.entry.editor,
        };
        Some((typing.text.clone(), typing.refusal(lang)?.to_owned()))
    }

    /// Text on the program page, with unsaved changes.
    #[must_use]
    pub const fn program_text(&self) -> &ropey::Rope {
        self.program.text()
    }

    /// Whether the open page accepts text now.
    #[must_use]
    pub fn accepts_text(&self, page: Page) -> bool {
        match page {
            Page::Mdi => true,
            Page::Program => self.program.accepts_text(),
            Page::Params => self.params.is_searching(),
            Page::Help => self.help.searches(),
            _ => false,
        }
    }

    /// Whether the numeric pad is shown.
    #[must_use]
    pub fn wants_pad(&self, view: &View<'_>) -> bool {
        if self.login.is_open() {
            return true;
        }
        match view.snapshot.page {
            Page::Params => self.params.wants_pad(),
            Page::Directory => self.directory.wants_pad(),
            Page::Offset => self.offset.table.typing.pad_open,
            Page::Dressing => self.dressing.table.typing.pad_open,
            Page::Macro => self.variables.typing.pad_open,
            Page::Wheel => self.wheel.wants_pad(),
            Page::Tools => self.tools.typing.pad_open,
            Page::Transfer => self.transfer.wants_pad(),
            Page::Settings => self.settings.clock.typing.pad_open,
            page => {
                let has_fields = view.snapshot.page_files().is_some_and(|files| files.text.is_ok());
                self.entry.editor.pad_open && page_frame::has_number_fields(page) && has_fields
            }
        }
    }

    /// Draws the open page; returns its commands.
    pub fn ui(
        &mut self,
        ui: &Ui,
        rect: Rect,
        view: &View<'_>,
        typed: &TypedInput<'_>,
        picture: Option<TextureId>,
    ) -> Vec<Command> {
        self.update_background(view);
        let mut out = match view.snapshot.page {
            Page::Position | Page::Panel => {
                let mut out = panel_key_commands(typed.edits);
                out.extend(position::ui(ui, rect, view));
                out
            }
            Page::Grinding => grinding::ui(ui, rect, view, &mut self.entry, typed.edits, picture),
            Page::Program => self.program.ui(ui, rect, view, typed, &mut self.login),
            Page::Designer => self.designer.ui(ui, rect, view, typed, (&mut self.login, picture)),
            Page::Process => self.process.ui(ui, rect, view, typed),
            Page::Simulator => self.simulator.ui(ui, rect, view, typed, &mut self.simulator_tab_index),
            Page::Graphic => self.graphic.ui(ui, rect, view, typed),
            Page::Transfer => self.transfer.ui(ui, rect, view, typed, &mut self.login),
            Page::Directory => self.directory.ui(ui, rect, view, typed, &mut self.login),
            Page::Dressing => self.dressing.ui(ui, rect, view, typed, picture),
            Page::Offset => self.offset.ui(ui, rect, view, typed),
            Page::Macro => self.variables.ui(ui, rect, view, typed),
            Page::Mdi => self.mdi.ui(ui, rect, view, typed),
            Page::Wheel => self.wheel.ui(ui, rect, view, typed.edits),
            Page::Teach => self.teach.ui(ui, rect, view, typed, &mut self.login),
            Page::Tools => self.tools.ui(ui, rect, view, typed.edits),
            Page::Params => self.params.ui(ui, rect, view, typed, &mut self.login),
            Page::Settings => self.settings.ui(ui, rect, view, typed.edits, &mut self.login),
            Page::Diagnosis => {
                self.diagnosis.ui(ui, rect, view, typed);
                Vec::new()
            }
            Page::Alarm => self.alarms.ui(ui, rect, view, typed, &self.help),
            Page::Help => {
                self.help.ui(ui, view, rect, typed);
                Vec::new()
            }
        };
        self.login.ui(ui, rect, view, typed.edits, &mut out);
        out
    }
}

/// On a page without fields Enter and Esc act as the panel keys 输入 and 取消.
fn panel_key_commands(edits: &[EditKey]) -> Vec<Command> {
    let press = |key| [Command::Press(key), Command::Release(key)];
    let mut out = Vec::new();
    for edit in edits {
        match edit {
            EditKey::Enter => out.extend(press(Key::Input)),
            EditKey::Cancel => out.extend(press(Key::Cancel)),
            EditKey::Char(_) | EditKey::Sign | EditKey::Backspace | EditKey::Delete | EditKey::Up | EditKey::Down => {}
            EditKey::Left
            | EditKey::Right
            | EditKey::LineStart
            | EditKey::LineEnd
            | EditKey::Next
            | EditKey::Previous => {}
        }
    }
    out
}
