//! Teach-in (录返): what the page asks and sees of a recording. Source: spec L9, seed 001 (录返).

/// One request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TeachCommand {
    /// A new recording begins where the tool stands; the one before is forgotten.
    Start,
    /// No more is recorded; the blocks stay until they are kept or a new recording begins.
    Stop,
    /// The last block is taken back; the machine does not move.
    Undo,
    /// The blocks become a program of the folder, `TEACH01` to `TEACH99`.
    Keep,
}

impl TeachCommand {
    /// The command of a word of a story.
    #[must_use]
    pub fn from_id(id: &str) -> Option<Self> {
        match id {
            "start" => Some(Self::Start),
            "stop" => Some(Self::Stop),
            "undo" => Some(Self::Undo),
            "keep" => Some(Self::Keep),
            _ => None,
        }
    }
}

/// A recording as the page shows it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TeachView {
    /// What is moved by hand is recorded now.
    pub recording: bool,
    /// The blocks, with their numbers.
    pub blocks: Vec<String>,
    /// They are kept as a program.
    pub kept: bool,
}
