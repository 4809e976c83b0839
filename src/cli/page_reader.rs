//! Reads the texts of a page for a story: paints the page if the build has the screen.

use crate::defs::text::Lang;
use crate::story::PageReader;

/// A page reader for a language; `None` in a build without the screen.
#[must_use]
pub fn page_reader(lang: Lang) -> Option<Box<dyn PageReader>> {
    #[cfg(feature = "hmi")]
    return Some(Box::new(PaintedPageReader(lang)));
    #[cfg(not(feature = "hmi"))]
    {
        let _ = lang;
        None
    }
}

#[cfg(feature = "hmi")]
struct PaintedPageReader(Lang);

#[cfg(feature = "hmi")]
impl PageReader for PaintedPageReader {
    fn texts(&mut self, snapshot: &crate::link::Snapshot) -> Vec<String> {
        crate::hmi::page_text(snapshot, self.0)
    }
}
