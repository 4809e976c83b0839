//! How a story looks at a page: with the screen's own painting where the build has it.

use crate::defs::text::Lang;
use crate::story::Eyes;

/// Eyes for a language; none in a build without the screen.
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
