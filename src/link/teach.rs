//! Teach-in (录返): requests and data of the teach-in page. Source: spec L9, seed 001 (录返).

use crate::units::{Axis, WorkPos};

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

/// The content of a recorded block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TaughtBlock {
    /// G92: start position, work coordinates, radius mm.
    Start(WorkPos),
    /// A straight line: end point (work, radius mm), feed in mm/min.
    Line {
        /// End point.
        to: WorkPos,
        /// Directions of X and Z.
        heading: [i8; 2],
        /// G00 in place of G01.
        rapid: bool,
        /// Feed, mm/min.
        feed: f64,
    },
    /// G37 or G39: an axis was homed.
    Home(Axis),
    /// An M code.
    M(u8),
    /// A turret station.
    T(u8),
}

/// A recording as the page shows it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TeachView {
    /// Manual moves are being recorded.
    pub recording: bool,
    /// The blocks.
    pub blocks: Vec<TaughtBlock>,
    /// The blocks are saved as a program.
    pub saved: bool,
}

/// The text of the block with this index, with its N number.
#[must_use]
pub fn block_text(index: usize, block: &TaughtBlock) -> String {
    format!("N{:04}{}", (index + 1) * 10, block.text())
}

/// The program of a recording, ending with M02.
#[must_use]
pub fn program_text(blocks: &[TaughtBlock]) -> String {
    let lines = blocks.iter().enumerate().map(|(index, block)| block_text(index, block) + "\r\n");
    lines.collect::<String>() + &format!("N{:04}M02\r\n", (blocks.len() + 1) * 10)
}

impl TaughtBlock {
    fn text(&self) -> String {
        match *self {
            Self::Start(at) => format!("G92X{}Z{}", mm(2.0 * at[Axis::X]), mm(at[Axis::Z])),
            Self::Line { to, rapid, feed, heading } => {
                let mut words = if rapid { "G00".to_owned() } else { "G01".to_owned() };
                if heading[0] != 0 {
                    words += &format!("X{}", mm(2.0 * to[Axis::X]));
                }
                if heading[1] != 0 {
                    words += &format!("Z{}", mm(to[Axis::Z]));
                }
                if rapid { words } else { format!("{words}F{feed}") }
            }
            Self::Home(Axis::X) => "G37".to_owned(),
            Self::Home(_) => "G39".to_owned(),
            Self::M(code) => format!("M{code:02}"),
            Self::T(station) => format!("T{station}"),
        }
    }
}

/// A coordinate rounded to 1 µm, without trailing zeros.
fn mm(value: f64) -> String {
    let rounded = (value * 1_000.0).round() / 1_000.0;
    format!("{}", if rounded.abs() < 0.000_5 { 0.0 } else { rounded })
}
