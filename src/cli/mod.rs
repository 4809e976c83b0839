//! The command line. Results go to standard output, messages to standard error.
//! Source: spec tools.md T1–T6.

mod args;
mod bench;
mod check;
mod demo;
mod eyes;
mod limits;
mod play;
mod rehearse;
mod run;
mod screw;
#[cfg(feature = "hmi")]
mod shot;
#[cfg(feature = "hmi")]
mod window;

use std::process::ExitCode;

use clap::Parser;
use clap::error::ErrorKind;

use args::{Args, Verb};

/// Exit status: success.
const FINE: u8 = 0;
/// Exit status: an alarm or a failed expectation.
const FAILED: u8 = 1;
/// Exit status: the call or a file is invalid.
const WRONG_CALL: u8 = 2;

/// Runs the command line of this process.
#[must_use]
pub fn main() -> ExitCode {
    let args = match Args::try_parse() {
        Ok(args) => args,
        Err(error) => {
            let fine = matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion);
            drop(error.print());
            return ExitCode::from(if fine { FINE } else { WRONG_CALL });
        }
    };
    let shared = match bench::settle(args.shared, args.verb.is_none()) {
        Ok(shared) => shared,
        Err(error) => {
            eprintln!("kt830: {error}");
            return ExitCode::from(WRONG_CALL);
        }
    };
    let done = match &args.verb {
        Some(Verb::Run(call)) => run::run(&shared, call),
        Some(Verb::Check(call)) => check::check(&shared, call),
        Some(Verb::Screw(call)) => screw::screw(&shared, call),
        Some(Verb::Play(call)) => play::play(&shared, call),
        Some(Verb::Demo(call)) => demo::demo(&shared, call),
        #[cfg(feature = "hmi")]
        Some(Verb::Shot(call)) => shot::shot(&shared, call),
        #[cfg(feature = "hmi")]
        None => window::open(&shared, !args.windowed),
        #[cfg(not(feature = "hmi"))]
        Some(Verb::Shot(_)) | None => Err(CallError::new(
            "this build has no screen: use `demo`, `run`, `play` or `check`, or build with the feature hmi",
        )),
    };
    match done {
        Ok(status) => ExitCode::from(status),
        Err(error) => {
            eprintln!("kt830: {error}");
            ExitCode::from(WRONG_CALL)
        }
    }
}

/// The call or a file is invalid: cause and remedy.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct CallError(String);

impl CallError {
    fn new(text: impl std::fmt::Display) -> Self {
        Self(text.to_string())
    }
}

/// Writes a line to standard output; a closed pipe is ignored.
fn out(text: impl std::fmt::Display) {
    use std::io::Write;
    drop(writeln!(std::io::stdout().lock(), "{text}"));
}
