//! Words of several letters without a value, and the programmable frame. Source: spec S1; SINUMERIK 802D programming.

use super::motion;
use crate::nc::dialect::rules::BlockContext;
use crate::nc::expression::Scope;
use crate::nc::fault::{E, ReadResult, fail1, fail2};
use crate::nc::lexer::Cursor;
use crate::nc::modal::DiameterProgramming;
use crate::nc::op::Op;
use crate::nc::words::{BlockWords, Code};
use crate::units::PerAxis;

use super::expression::accept_keyword;

/// A word of several letters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Keyword {
    /// NORM, KONT: the way to the contour. DECISION: it is always square to the contour.
    Approach,
    /// DIAMON: X words are diameters.
    DiameterOn,
    /// DIAMOF: X words are radii.
    DiameterOff,
    /// DIAM90: absolute X words are diameters, incremental ones radii.
    DiameterAbsolute,
    /// TRANS: sets the programmable zero offset; alone it ends it.
    Translate,
    /// ATRANS: adds to it.
    TranslateAdditive,
    /// `X1=…`: an axis of the machine, in G74 and G75.
    MachineAxis,
}

const KEYWORDS: [(&str, Keyword); 7] = [
    ("NORM", Keyword::Approach),
    ("KONT", Keyword::Approach),
    ("DIAMON", Keyword::DiameterOn),
    ("DIAMOF", Keyword::DiameterOff),
    ("DIAM90", Keyword::DiameterAbsolute),
    ("TRANS", Keyword::Translate),
    ("ATRANS", Keyword::TranslateAdditive),
];

/// Reads a keyword; `false` if none is next.
pub(super) fn read_keyword(cursor: &mut Cursor<'_>, words: &mut BlockWords) -> ReadResult<bool> {
    let at = cursor.at;
    match KEYWORDS.into_iter().find(|(name, _)| accept_keyword(cursor, name)) {
        Some((_, keyword)) => words.push_keyword(Code { number: keyword as u32, at: at as u32 }).map(|()| true),
        None => Ok(false),
    }
}

/// The byte of a keyword of the block.
pub(super) fn find(words: &BlockWords, keyword: Keyword) -> Option<usize> {
    words.keywords.iter().find(|code| code.number == keyword as u32).map(|code| code.at as usize)
}

/// Applies the keywords that are modal.
pub(super) fn apply_modes(running: &mut BlockContext<'_, '_>) {
    for (keyword, mode) in [
        (Keyword::DiameterOn, DiameterProgramming::On),
        (Keyword::DiameterOff, DiameterProgramming::Off),
        (Keyword::DiameterAbsolute, DiameterProgramming::Absolute),
    ] {
        if find(running.words, keyword).is_some() {
            running.modals.diameter = mode;
        }
    }
}

/// TRANS and ATRANS, each in a block of its own: the axis words are the offset. True: the block has one.
pub(super) fn translate(running: &mut BlockContext<'_, '_>) -> ReadResult<bool> {
    let words = running.words;
    let replaces = find(words, Keyword::Translate);
    let Some(at) = replaces.or(find(words, Keyword::TranslateAdditive)) else { return Ok(false) };
    let name = if replaces.is_some() { "TRANS" } else { "ATRANS" };
    let (g, m) = (words.g.first().map(|code| code.name('G', 0)), words.m.first().map(|code| code.name('M', 0)));
    if let Some(other) = g.or(m) {
        return fail2(at, E::NotTogether, name, other);
    }
    let by = motion::axis_lengths(running)?;
    let before = if replaces.is_some() { PerAxis::default() } else { running.modals.local };
    let local = PerAxis::from_fn(|axis| before[axis] + by[axis].unwrap_or(0.0));
    running.modals.local = local;
    running.ops.push(Op::SetLocalZero { values: PerAxis::from_fn(|axis| Some(local[axis])) });
    Ok(true)
}

/// How an axis goes to its end, for X and Z.
const DISTANCES: [&str; 2] = ["IC", "AC"];
/// The same of a rotary axis, and `M=QU(…)`.
const FOREIGN_DISTANCES: [&str; 4] = ["DC", "ACP", "ACN", "QU"];

/// Refuses `C=IC(…)`, `I=AC(…)`, `M=QU(…)`, of which the word at the cursor is the first.
pub(super) fn refuse_distance<T>(cursor: &Cursor<'_>, at: usize, letter: u8) -> ReadResult<Option<T>> {
    let mut ahead = *cursor;
    let found = DISTANCES.into_iter().chain(FOREIGN_DISTANCES).find(|name| accept_keyword(&mut ahead, name));
    match found {
        Some(_) if matches!(letter, b'A' | b'B' | b'C' | b'U' | b'V' | b'W' | b'Q') => {
            fail1(at, E::NoAxis, char::from(letter))
        }
        Some(name) if DISTANCES.contains(&name) => fail1(cursor.at, E::DistanceForAxes, name),
        Some(name) => fail1(cursor.at, E::ForeignWord, name),
        None => Ok(None),
    }
}

/// `IC(…)` and `AC(…)` behind an axis letter: the word is incremental, or absolute. `None`: neither is next.
pub(super) fn read_distance<S: Scope>(
    cursor: &mut Cursor<'_>,
    scope: &mut S,
    words: &mut BlockWords,
    (letter, at): (u8, usize),
) -> ReadResult<Option<f64>> {
    let is_axis = matches!(letter, b'X' | b'Y' | b'Z');
    let is_incremental = is_axis && accept_keyword(cursor, "IC");
    if !(is_incremental || is_axis && accept_keyword(cursor, "AC")) {
        return refuse_distance(cursor, at, letter);
    }
    words.set_distance(letter, is_incremental);
    let assignments = &words.assignments;
    super::expression::bracketed(cursor, scope, assignments).map(Some)
}
