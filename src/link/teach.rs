//! Teach-in (录返): requests and data of the teach-in page. Source: spec L9, seed 001 (录返).

/// One request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TeachCommand {
    /// Starts a new recording at the current position and discards the previous one.
    Start,
    /// Stops recording; the blocks stay until they are saved or a new recording starts.
    Stop,
    /// Removes the last block; the machine does not move.
    Undo,
    /// Saves the blocks as a program of the folder, `TEACH01` to `TEACH99`.
    Save,
}

impl TeachCommand {
    /// The command for a word of a story.
    #[must_use]
    pub fn from_id(id: &str) -> Option<Self> {
        match id {
            "start" => Some(Self::Start),
            "stop" => Some(Self::Stop),
            "undo" => Some(Self::Undo),
            "keep" => Some(Self::Save),
            _ => None,
        }
    }
}

/// A recording as the page shows it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TeachView {
    /// Manual moves are being recorded.
    pub recording: bool,
    /// The blocks, with N numbers.
    pub blocks: Vec<String>,
    /// The blocks are saved as a program.
    pub saved: bool,
}
