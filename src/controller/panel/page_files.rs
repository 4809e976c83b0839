//! The open page and its soft keys; alarm 66 for missing files of the grinding and the dressing page.
//! Source: spec K7.1, K7.3, K7.6.

use super::{Panel, Parts, PartsView};
use crate::controller::plant::ControlPhase;
use crate::defs::alarm;
use crate::defs::page::Page;
use crate::defs::page_meaning::PageMeaning;
use crate::defs::page_text::PageTextRow;
use crate::defs::soft_key::{self, CoordinateView, SoftKeyAction};
use crate::defs::text::arg::Arg;
use crate::defs::text::{LocalizedText, Template, Text, phrase};
use crate::link::screens::PROGRAMS_WITH_PAGE;
use crate::link::screens::{FileFault, PAGE_FILES};

const BOTH_FILES: &Template = &Template::new("{first}；{next}", "{first}; {next}", &["first", "next"]);
/// Screen printing happens in the HMI, not in the core.
const PRINT: Text = Text::new("屏幕打印：在屏幕上点此软键", "screen print: touch the soft key on the screen");

impl Panel {
    /// Opens a page and shows its row of soft keys, also if the page is open and the row was turned (K7.1).
    pub fn open_page(&mut self, parts: &mut Parts<'_>, page: Page) {
        if !page.exists_on(parts.plant.kind) {
            return parts.plant.refuse(phrase!("本机床没有“{page}”页面", "this machine has no page {page}", page));
        }
        if parts.plant.operator.page != page {
            parts.plant.operator.page = page;
            parts.manual.dressing.withdraw_question();
        }
        self.pages.soft_row = page.soft_row();
        self.check_page_files(parts);
    }

    /// Selects a view of the position page and opens the page.
    pub fn show_coordinates(&mut self, parts: &mut Parts<'_>, coordinates: CoordinateView) {
        if self.pages.coordinates != coordinates {
            self.pages.coordinates = coordinates;
            parts.manual.dressing.withdraw_question();
        }
        self.open_page(parts, Page::Position);
    }

    /// Selects a row of soft keys; after the last row comes the first.
    pub fn show_soft_row(&mut self, row: usize) {
        self.pages.soft_row = row % soft_key::ROWS;
    }

    /// A soft key pressed on the panel: acts like a touch on the screen.
    pub fn press_soft_key(&mut self, parts: &mut Parts<'_>, index: usize) {
        let row = self.pages.soft_row;
        let stopped = matches!(parts.plant.execution.phase, ControlPhase::Stopped);
        let Some(soft) = soft_key::row_now(parts.plant.kind, row, stopped).nth(index) else {
            let (row, key) = (row + 1, index + 1);
            return parts.plant.refuse(phrase!(
                "第 {row} 行软键没有 F{key}，按 ◀ ▶ 换行",
                "soft key row {row} has no F{key}: ◀ ▶ turn the rows",
                row,
                key
            ));
        };
        let before = (parts.plant.operator.page, self.pages.coordinates);
        match soft.action {
            SoftKeyAction::Open(page) => self.open_page(parts, page),
            SoftKeyAction::Position(coordinates) => self.show_coordinates(parts, coordinates),
            SoftKeyAction::Print => return parts.plant.refuse(PRINT),
            SoftKeyAction::Continue => return parts.program.cycle_start(parts.plant),
        }
        if before == (parts.plant.operator.page, self.pages.coordinates) {
            let name = Arg::SoftKey(soft.action, parts.plant.kind);
            parts.plant.show_note(phrase!("已是“{name}”", "{name} is open", name));
        }
    }

    /// Selects a sheet of the grinding page; after the last sheet comes the first.
    pub fn show_sheet(&mut self, parts: &mut Parts<'_>, sheet: usize) {
        self.pages.sheet = sheet % parts.plant.kind.row().page_files.len().max(1);
        self.check_page_files(parts);
    }

    /// The page number that the grinding page shows: the kind's own, or that of the program (K7.2).
    pub fn grinding_page(&self, parts: PartsView<'_>) -> Option<u32> {
        self.kind_page(parts).or_else(|| {
            let current = parts.plant.execution.current_program;
            PROGRAMS_WITH_PAGE.contains(&current).then_some(current)
        })
    }

    /// The page number of the selected sheet, if the kind has its own grinding pages.
    pub fn kind_page(&self, parts: PartsView<'_>) -> Option<u32> {
        parts.plant.kind.row().page_files.get(self.pages.sheet).map(|number| PAGE_FILES + number)
    }

    /// Index of the selected sheet and number of sheets.
    pub fn grinding_pages(&self, parts: PartsView<'_>) -> (usize, usize) {
        (self.pages.sheet, parts.plant.kind.row().page_files.len().max(1))
    }

    /// Whether a sheet of the grinding page has a field for a variable.
    pub fn page_shows(&self, parts: PartsView<'_>, variable: u16) -> bool {
        self.page_row(parts, variable).is_some()
    }

    /// Whether a dressing point set by key counts instead of the value of a variable (K4.2).
    pub fn point_by_key_counts(&self, parts: PartsView<'_>, variable: u16) -> bool {
        let meaning = self.page_row(parts, variable).and_then(PageTextRow::meaning);
        matches!(meaning, Some(PageMeaning::DressingPoint(axis)) if parts.plant.work.dress_points[axis].is_some())
    }

    /// The row of a variable on the grinding page.
    fn page_row(&self, parts: PartsView<'_>, variable: u16) -> Option<&PageTextRow> {
        self.screens.row(parts.plant.kind, parts.plant.execution.current_program, variable)
    }

    /// K7.3: raises alarm 66 when the page opens; clears it when the files are correct or the page is left.
    pub fn check_page_files(&self, parts: &mut Parts<'_>) {
        parts.plant.alarms.clear(alarm::PAGE_FILES_INVALID);
        if parts.plant.operator.page == Page::Dressing {
            // K7.6: the dressing page has only a picture.
            if let Some(Err(fault)) = self.screens.dressing.clone() {
                parts.plant.raise(alarm::PAGE_FILES_INVALID, Some(fault.full_message()));
            }
            return;
        }
        let Some(shown) = self.grinding_page(parts.view()).filter(|_| parts.plant.operator.page == Page::Grinding)
        else {
            return;
        };
        let number = shown - PAGE_FILES;
        let detail = match self.screens.find(shown) {
            Some(files) => [files.text.as_ref().err(), files.english_fault.as_ref(), files.picture.as_ref().err()]
                .into_iter()
                .chain([files.labels_fault.as_ref()])
                .flatten()
                .map(FileFault::full_message)
                .reduce(|first, next| LocalizedText::phrase_of(BOTH_FILES, [], [first, next])),
            None => Some(phrase!(
                "C{number:04}.TXT：文件不存在，请拷入 screens 目录；B{number:04}.BMP：文件不存在，请拷入 screens 目录",
                "C{number:04}.TXT: missing: copy it into the screens folder; \
                 B{number:04}.BMP: missing: copy it into the screens folder",
                number
            )),
        };
        if let Some(detail) = detail {
            parts.plant.raise(alarm::PAGE_FILES_INVALID, Some(detail));
        }
    }
}
