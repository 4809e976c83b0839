//! The open page, and alarm 66 for the files of the grinding and the dressing page.
//! Source: spec K7.3, K7.6.

use super::Controller;
use crate::defs::alarm;
use crate::defs::page::Page;
use crate::defs::text::Said;
use crate::link::command::FileFault;

/// Programs with a grinding page.
const PAGED_PROGRAMS: std::ops::RangeInclusive<u32> = 1_001..=1_020;

impl Controller {
    pub(super) fn open_page(&mut self, page: Page) {
        self.page = page;
        self.check_page_files();
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
        if self.page != Page::Grinding || !PAGED_PROGRAMS.contains(&self.current) {
            return;
        }
        let nn = self.current - 1_000;
        let missing = |file: String| FileFault {
            file,
            place: None,
            said: Said::new("文件不存在，请拷入 screens 目录", "missing: copy it into the screens folder"),
        };
        let faults: Vec<Said> = match self.screens.find(self.current) {
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
