//! What spectators are told beside the screen, while a story plays by itself.
//! Source: spec T2; issue "the face", part 9.

use crate::defs::text::LocalizedText;

/// The demonstration as the screen shows it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum DemoView {
    /// None runs, or it says nothing.
    #[default]
    Silent,
    /// What follows, in large letters over the page.
    Title(LocalizedText),
    /// The story says this, and whoever touches the screen takes over.
    Caption(LocalizedText),
    /// Somebody has touched the screen: without another touch the story begins again.
    TakenOver {
        /// Seconds until then.
        seconds_left: u32,
        /// Seconds after a touch.
        of: u32,
    },
}
