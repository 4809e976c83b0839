//! The command line. Results go to standard output, messages to standard error.
//! Source: spec tools.md T1–T6.

/// Writes a line to standard error, as `eprintln!` does; one that cannot be written, on a full disk, is ignored.
macro_rules! warn_line {
    ($($text:tt)*) => { $crate::cli::print_warning_line(format_args!($($text)*)) };
}

mod args;
#[cfg(target_os = "linux")]
mod bus;
mod check;
mod checked_file;
mod codes;
mod cycle_time;
mod demo;
#[cfg(feature = "hmi")]
mod film;
mod finished_size_check;
mod fleet;
mod languages;
mod leadscrew;
#[cfg(feature = "opcua")]
mod opcua;
mod page_text_check;
mod painter;
mod play;
#[cfg(feature = "hmi")]
mod plot_path;
#[cfg(feature = "hmi")]
mod process_end;
mod program_places;
mod qualify;
mod run;
mod serve;
mod setup;
#[cfg(feature = "hmi")]
mod shot;
mod soft_limit_check;
mod story_loop;
mod texts;
mod torture;
mod trace_file;
#[cfg(feature = "hmi")]
mod window;

use std::fmt::Display;
use std::io::IsTerminal;
use std::process::ExitCode;

use clap::Parser;
use clap::error::ErrorKind;

use args::{Args, CliCommand};

/// Exit status: success.
const SUCCESS: u8 = 0;
/// Exit status: an alarm or a failed expectation.
const FAILED: u8 = 1;
/// Exit status: the call or a file is invalid.
const USAGE_ERROR: u8 = 2;

/// Runs the command line of this process.
#[must_use]
pub fn main() -> ExitCode {
    crate::store::silence_database_check();
    // The program itself, also where an update has removed its file.
    let program = if cfg!(target_os = "linux") { Ok("/proc/self/exe".into()) } else { std::env::current_exe() };
    if let Ok(program) = program {
        crate::store::set_check_program(program, ["check-database"]);
    }
    let args = match Args::try_parse() {
        Ok(args) => args,
        Err(error) => {
            let fine = matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion);
            drop(error.print());
            return ExitCode::from(if fine { SUCCESS } else { USAGE_ERROR });
        }
    };
    ExitCode::from(execute(args).unwrap_or_else(|error| {
        warn_line!("kt830: {error}");
        USAGE_ERROR
    }))
}

/// Executes the command; returns the exit status.
fn execute(args: Args) -> Result<u8, CallError> {
    // The model is that of the machine of the data directory, too.
    let opens_control = matches!(args.verb, None | Some(CliCommand::DeviceModel));
    let shared = setup::resolve_settings(args.shared, opens_control)?;
    match &args.verb {
        Some(CliCommand::Run(call)) => run::run(&shared, call),
        Some(CliCommand::Check(call)) => check::check(&shared, call),
        Some(CliCommand::Screw(call)) => leadscrew::screw(&shared, call),
        Some(CliCommand::Qualify(call)) => qualify::qualify(&shared, call),
        Some(CliCommand::Torture(call)) => torture::torture(&shared, call),
        Some(CliCommand::Texts(call)) => texts::texts(&shared, call),
        Some(CliCommand::Codes) => codes::codes(&shared),
        Some(CliCommand::Serve(call)) => serve::serve(&shared, call),
        Some(CliCommand::Fleet(call)) => fleet::fleet(&shared, call),
        #[cfg(feature = "opcua")]
        Some(CliCommand::OpcUa(call)) => opcua::opcua(&shared, call),
        #[cfg(not(feature = "opcua"))]
        Some(CliCommand::OpcUa(_)) => {
            Err(CallError::new("this build has no OPC UA server: build it with `--features opcua`"))
        }
        Some(CliCommand::WebAccess(call)) => serve::set_web_access(&shared, call),
        Some(CliCommand::DeviceModel) => serve::print_device_model(&shared),
        Some(CliCommand::CheckDatabase) => {
            crate::store::run_database_check().map_err(CallError::at("standard input")).map(|()| SUCCESS)
        }
        #[cfg(target_os = "linux")]
        Some(CliCommand::Bus(call)) => bus::bus(&shared, call),
        #[cfg(not(target_os = "linux"))]
        Some(CliCommand::Bus(_)) => Err(CallError::new("a field bus needs Linux")),
        Some(CliCommand::Play(call)) => play::play(&shared, call),
        Some(CliCommand::Demo(call)) => demo::demo(&shared, call),
        #[cfg(feature = "hmi")]
        Some(CliCommand::Shot(call)) => shot::shot(&shared, call),
        #[cfg(feature = "hmi")]
        Some(CliCommand::PlotPath(call)) => plot_path::plot_path(&shared, call),
        #[cfg(feature = "hmi")]
        None => window::open(&shared, !args.windowed),
        #[cfg(not(feature = "hmi"))]
        Some(CliCommand::Shot(_) | CliCommand::PlotPath(_)) | None => Err(CallError::new(
            "this build has no screen: use `demo`, `run`, `play` or `check`, or build with the feature hmi",
        )),
    }
}

/// The call or a file is invalid: cause and remedy.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct CallError(String);

impl CallError {
    fn new(text: impl Display) -> Self {
        Self(text.to_string())
    }

    /// For `map_err`: the error at a file or an argument.
    fn at<E: Display>(place: impl Display) -> impl FnOnce(E) -> Self {
        move |error| Self(format!("{place}: {error}"))
    }
}

fn print_warning_line(text: std::fmt::Arguments<'_>) {
    use std::io::Write;
    drop(writeln!(std::io::stderr().lock(), "{text}"));
}

/// The first line of standard input: a password, which no list of processes shows.
fn password_line() -> Result<String, CallError> {
    let stdin = std::io::stdin();
    if stdin.is_terminal() {
        warn_line!("kt830: type the password (it is shown), then Enter");
    }
    let line = std::io::stdin().lines().next().transpose().map_err(CallError::at("password"))?;
    line.ok_or_else(|| CallError::new("write the password to standard input"))
}

/// Writes a line to standard output; a closed pipe is ignored.
fn print_line(text: impl Display) {
    use std::io::Write;
    drop(writeln!(std::io::stdout().lock(), "{text}"));
}
