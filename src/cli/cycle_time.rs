//! How long a checked program takes: it runs once on the simulated machine with its part, as `kt830 run` does.
//! Source: spec tools.md T4.

use super::args::SharedArgs;
use super::setup::ProgramToRun;
use super::{CallError, setup};
use crate::controller::PowerOnState;
use crate::host::headless_run::{RunEnd, RunLimits};
use crate::link::toolpath::CycleTime;
use crate::nc::CheckReport;
use crate::units::Micros;

/// Programs with more blocks are not run for their time: a million take ten seconds and more.
const MAX_BLOCKS: u64 = 200_000;
/// The longest simulated time: some seconds of computing.
const LONGEST: Micros = Micros::from_millis(3_600_000);

/// Runs a program that has no mistake. One that is too long, or that does not come to its end without an operator, has the
/// time of its path at the programmed feeds.
///
/// # Errors
/// The machine or a file cannot be opened.
pub fn cycle_time(
    shared: &SharedArgs,
    retained: &PowerOnState,
    program: ProgramToRun<'_>,
    checked: &CheckReport,
) -> Result<CycleTime, CallError> {
    let at_feeds = CycleTime::AtFeeds(checked.seconds);
    if !checked.finished || checked.blocks > MAX_BLOCKS {
        return Ok(at_feeds);
    }
    // A folder that cannot be read is no mistake of the program.
    let Ok(mut host) = setup::unstored_host(shared, retained.clone()) else { return Ok(at_feeds) };
    setup::prepare_run(&mut host, shared, program)?;
    let started = host.now();
    let end = host.run_program(&RunLimits { through_stops: true, longest: LONGEST, once: true }, &mut |_| true);
    let seconds = host.now().since(started).as_secs_f64();
    Ok(if end == RunEnd::Finished { CycleTime::Simulated(seconds) } else { at_feeds })
}
