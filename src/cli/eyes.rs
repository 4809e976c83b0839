//! How a story looks at a page: with the screen's own painting where the build has it.

use crate::defs::text::Lang;
use crate::story::Eyes;

/// Eyes for a language; none in a build without the screen.
#[must_use]
pub fn eyes(_lang: Lang) -> Option<Box<dyn Eyes>> {
    None
}
