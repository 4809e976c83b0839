//! Reads the texts of a page for a story: paints the page if the build has the screen.

use crate::defs::text::Lang;
use crate::story::Eyes;

/// A page reader for a language; `None` in a build without the screen.
#[must_use]
pub fn eyes(lang: Lang) -> Option<Box<dyn Eyes>> {
    #[cfg(feature = "hmi")]
    return Some(Box::new(Painted(lang)));
    #[cfg(not(feature = "hmi"))]
    {
        let _ = lang;
        None
    }
}

#[cfg(feature = "hmi")]
struct Painted(Lang);

#[cfg(feature = "hmi")]
impl Eyes for Painted {
    fn texts(&mut self, snapshot: &crate::link::Snapshot) -> Vec<String> {
        crate::hmi::page_text(snapshot, self.0)
    }
}
