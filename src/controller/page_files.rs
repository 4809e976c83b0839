//! The open page, and alarm 66 for the files of the grinding and the dressing page.
//! Source: spec K7.3, K7.6.

use super::Controller;
use crate::defs::alarm;
use crate::defs::page::Page;
use crate::defs::text::Said;
use crate::link::command::FileFault;
use crate::link::snapshot::PAGED_PROGRAMS;

/// What the number of a page's files is counted from.
const PAGE_FILES: u32 = 1_000;

impl Controller {
    pub(super) fn open_page(&mut self, page: Page) {
        if !page.is_on(self.kind) {
            let title = page.title();
            return self.refuse(Said::new(
                format!("本机床没有“{}”页面", title.zh),
                format!("this machine has no page {}", title.en),
            ));
        }
        self.page = page;
        self.check_page_files();
    }

    /// Another sheet of the grinding page; beyond the last comes the first.
    pub(super) fn turn_sheet(&mut self, sheet: usize) {
        self.pages.sheet = sheet % self.row.page_files.len().max(1);
        self.check_page_files();
    }

    /// Which page files the grinding page shows: the kind's own, or those of the program (K7.2).
    pub(super) fn grinding_page(&self) -> Option<u32> {
        self.own_page().or_else(|| PAGED_PROGRAMS.contains(&self.current).then_some(self.current))
    }

    /// The sheet of the kind's own grinding page.
    pub(super) fn own_page(&self) -> Option<u32> {
        self.row.page_files.get(self.pages.sheet).map(|number| PAGE_FILES + number)
    }

    /// Which of how many.
    pub(super) fn grinding_pages(&self) -> (usize, usize) {
        (self.pages.sheet, self.row.page_files.len().max(1))
    }

    /// Whether one of the pages that the grinding page shows has a field for a variable.
    pub(super) fn page_shows(&self, variable: u16) -> bool {
        let own = self.row.page_files.iter().map(|number| PAGE_FILES + number);
        let mut shown = own.chain(self.grinding_page());
        shown.any(|number| {
            let files = self.screens.find(number);
            let text = files.and_then(|files| files.text.as_ref().ok());
            text.is_some_and(|page| page.rows().any(|row| row.variable == variable))
        })
    }

    /// K7.3: alarm 66 when the page opens; it goes when the files are right or the page is left.
    pub(super) fn check_page_files(&mut self) {
        self.alarms.clear(alarm::PAGE_FILES);
        if self.page == Page::Dressing {
            // K7.6: its picture alone.
            if let Some(Err(fault)) = self.screens.dressing.clone() {
                self.raise(alarm::PAGE_FILES, Some(fault.said()));
            }
            return;
        }
        let Some(shown) = self.grinding_page().filter(|_| self.page == Page::Grinding) else { return };
        let nn = shown - PAGE_FILES;
        let missing = |file: String| FileFault {
            file,
            place: None,
            said: Said::new("文件不存在，请拷入 screens 目录", "missing: copy it into the screens folder"),
        };
        let faults: Vec<Said> = match self.screens.find(shown) {
            Some(files) => [files.text.as_ref().err(), files.picture.as_ref().err()]
                .into_iter()
                .flatten()
                .map(FileFault::said)
                .collect(),
            None => vec![missing(format!("C{nn:04}.TXT")).said(), missing(format!("B{nn:04}.BMP")).said()],
        };
        if let Some(first) = faults.first() {
            let rest = &faults[1..];
            let detail = rest.iter().fold(first.clone(), |all, fault| {
                Said::new(format!("{}；{}", all.zh, fault.zh), format!("{}; {}", all.en, fault.en))
            });
            self.raise(alarm::PAGE_FILES, Some(detail));
        }
    }
}
