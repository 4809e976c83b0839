//! Torture: the real control on a simulated machine and a simulated disk, under an operator who does everything at any
//! moment, with faults, power cuts and a slow, full or damaged disk. In every tick the invariants are checked. The
//! operator's course is a story, so that a failure is replayed, shortened and played by hand.
//! Source: safety stance; notes "reliability"; method: deterministic simulation testing (FoundationDB, TigerBeetle).

mod invariants;
mod ledger;
mod machine;
mod operator;
mod planted;
mod shorten;
mod simulated_disk;
mod stage;
mod storage;

use std::fmt::{self, Display, Formatter};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use crate::defs::kind::Kind;
use crate::io::{InputImage, OutputImage};
use crate::story::{Player, Stage, parse};
use crate::units::Micros;
use operator::RandomOperator;
pub use planted::PlantedBug;
pub use stage::Counts;
use stage::{TortureHost, TortureStage};

/// Most work to shorten a story, in courses of its length.
const SHORTENING_COURSES: u64 = 20;

/// Why a torture could not be carried out.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct TortureError(String);

impl TortureError {
    fn new(cause: impl Display) -> Self {
        Self(cause.to_string())
    }
}

/// Fingerprint of a course: FNV-1a over the words of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TraceHash(u64);

impl Default for TraceHash {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Display for TraceHash {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{:016x}", self.0)
    }
}

impl TraceHash {
    fn add_word(&mut self, bits: u64) {
        self.0 = (self.0 ^ bits).wrapping_mul(0x0100_0000_01b3);
    }

    fn add_bytes(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|byte| self.add_word(u64::from(*byte)));
    }

    fn add(&mut self, read: &InputImage, written: &OutputImage) {
        let mut word = |bits: u64| self.add_word(bits);
        word(read.terminals.0);
        word(written.terminals.0);
        word(u64::from(written.drives_on) << 1 | u64::from(written.fault_reset));
        read.encoder_mm.coordinates().into_iter().for_each(|mm| word(mm.to_bits()));
        written.set_point_mm.coordinates().into_iter().for_each(|mm| word(mm.to_bits()));
        word(written.wheel_volts.to_bits());
    }
}

/// What is tortured, how and how long.
#[derive(Clone, Copy, Debug)]
pub struct TortureCase {
    /// Kind of machine.
    pub kind: Kind,
    /// Seed of operator, machine and disk.
    pub seed: u64,
    /// Simulated time.
    pub span: Micros,
    /// A bug that is planted.
    pub bug: Option<PlantedBug>,
}

/// The course of a torture.
#[derive(Clone, Debug)]
pub struct TortureCourse {
    /// The lines of its story.
    pub lines: Vec<String>,
    /// What does not hold, if something does not.
    pub violation: Option<String>,
    /// What was done.
    pub counts: Counts,
    /// Fingerprint of its trace.
    pub trace: TraceHash,
    /// Fingerprint of what was written to the disk.
    pub written: TraceHash,
}

/// Tortures a control, until the time is over or an invariant is broken.
///
/// # Errors
/// The folder for its data cannot be used.
pub fn torture(case: TortureCase) -> Result<TortureCourse, TortureError> {
    let mut operator = RandomOperator::new(case.kind, case.seed);
    let mut waiting = Vec::new();
    play(case, |host| {
        if waiting.is_empty() && host.now() < case.span {
            waiting = operator.next_lines(host.snapshot());
            waiting.reverse();
        }
        waiting.pop()
    })
}

/// Plays the lines of a story in the same way.
///
/// # Errors
/// As [`torture`], and a line that is no statement.
pub fn replay(case: TortureCase, lines: &[String]) -> Result<TortureCourse, TortureError> {
    let mut lines = lines.iter().cloned();
    play(case, |_| lines.next())
}

/// The shortest story that breaks the same invariant.
///
/// # Errors
/// As [`replay`].
pub fn shortest(case: TortureCase, course: &TortureCourse) -> Result<Vec<String>, TortureError> {
    let subject = |course: &TortureCourse| course.violation.as_deref().map(subject_of);
    let wanted = subject(course);
    let trial = |lines: &[String]| match replay(case, lines) {
        Ok(found) => (subject(&found) == wanted, found.counts.ticks),
        Err(_) => (false, course.counts.ticks),
    };
    Ok(shorten::shorten(&course.lines, SHORTENING_COURSES * course.counts.ticks, trial))
}

/// The words of a violation without its numbers.
fn subject_of(violation: &str) -> String {
    violation.split_whitespace().filter(|word| !word.contains(|sign: char| sign.is_ascii_digit())).collect()
}

/// Plays lines until there are no more, or an invariant is broken. A refused statement is none of the operator's errors.
fn play(
    case: TortureCase,
    next: impl FnMut(&mut TortureHost) -> Option<String>,
) -> Result<TortureCourse, TortureError> {
    let folder = tempfile::tempdir().map_err(TortureError::new)?;
    let data = folder.path().join("data");
    let mut stage = TortureStage::new(&data, case.kind, case.seed, case.bug)?;
    let (mut lines, mut refused) = (Vec::new(), None);
    let played = catch_unwind(AssertUnwindSafe(|| {
        refused = play_lines(&mut stage, case.kind, folder.path(), &mut lines, next).err();
    }));
    if let Some(error) = refused {
        return Err(error);
    }
    let violation = match played {
        Ok(()) => stage.violation().map(str::to_owned),
        Err(panic) => Some(format!("panic: {}", panic_text(panic.as_ref()))),
    };
    Ok(TortureCourse { lines, violation, counts: stage.counts(), trace: stage.trace(), written: stage.written() })
}

fn play_lines(
    stage: &mut TortureStage,
    kind: Kind,
    folder: &Path,
    lines: &mut Vec<String>,
    mut next: impl FnMut(&mut TortureHost) -> Option<String>,
) -> Result<(), TortureError> {
    let mut player = Player::new(stage, None, folder, false);
    while let Some(line) = next(player.host()) {
        let wrong = |error| TortureError::new(format!("{line}: {error}"));
        let (_, statements) = parse::parse(&line, kind).map_err(wrong)?;
        lines.push(line);
        for statement in &statements {
            drop(player.play(statement));
        }
        if player.stage().is_interrupted() {
            break;
        }
    }
    Ok(())
}

fn panic_text(panic: &(dyn std::any::Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("without a text")
}
