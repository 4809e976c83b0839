//! Ends of the process. However it ends – window closed, signal, lost display, `exit` in a library – the control first
//! brakes, makes the outputs safe and stores everything. Source: safety stance; spec B6 (data kept).

use std::sync::OnceLock;
use std::time::Duration;

use crate::host::control_end::ControlEnd;

/// The control of this process.
static CONTROL: OnceLock<ControlEnd> = OnceLock::new();

/// How long the window may take to close after a signal, before the process ends without it.
const MAX_CLOSING: Duration = Duration::from_secs(3);

/// From now on, every end of this process ends the control first: SIGINT, SIGTERM, SIGHUP, SIGQUIT and the like (Windows:
/// Ctrl+C, log-off, shutdown), and a library that calls `exit` – Xlib does when the display is lost.
///
/// # Errors
/// The system takes no handler; a signal would end the process at once.
pub fn guard_process(control: ControlEnd) -> std::io::Result<()> {
    if CONTROL.set(control).is_err() {
        return Ok(());
    }
    guard_exit()?;
    #[cfg(unix)]
    guard_other_signals()?;
    ctrlc::set_handler(end_by_signal).map_err(std::io::Error::other)
}

/// SIGPWR and SIGSTKFLT, which only Linux has, and the first of the real-time signals for programs.
#[cfg(target_os = "linux")]
const LINUX_SIGNALS: [i32; 3] = [30, 16, 34];

/// The other signals that end a process by themselves, sent by hand or by a timer, end the control first, too.
///
/// # Errors
/// The system takes no handler.
#[cfg(unix)]
fn guard_other_signals() -> std::io::Result<()> {
    use signal_hook::consts::{SIGALRM, SIGIO, SIGPROF, SIGQUIT, SIGUSR1, SIGUSR2, SIGVTALRM, SIGXCPU, SIGXFSZ};
    let ending = [SIGQUIT, SIGUSR1, SIGUSR2, SIGALRM, SIGVTALRM, SIGPROF, SIGXCPU, SIGIO];
    let mut signals = signal_hook::iterator::Signals::new(ending)?;
    #[cfg(target_os = "linux")]
    LINUX_SIGNALS.into_iter().try_for_each(|signal| signals.add_signal(signal))?;
    // A file beyond its limit is a disk that takes nothing, with its alarm.
    signals.add_signal(SIGXFSZ)?;
    let end = move || {
        if signals.forever().any(|signal| signal != SIGXFSZ) {
            end_by_signal();
        }
    };
    std::thread::Builder::new().name("kt830-signals".to_owned()).spawn(end).map(drop)
}

/// Exit handlers run in reverse order: those that a library has registered since would come before ours, and may fail.
///
/// # Errors
/// The system takes no handler.
pub fn guard_exit() -> std::io::Result<()> {
    match shutdown_hooks::add_shutdown_hook(end_at_exit) {
        true => Ok(()),
        false => Err(std::io::Error::other("the system takes no exit handler")),
    }
}

/// Ends the control; then the window closes by itself. Another thread must not call `exit` while the window draws: the
/// graphics libraries would be torn down under it.
fn end_by_signal() {
    end_at_exit();
    std::thread::sleep(MAX_CLOSING);
    std::process::exit(0);
}

extern "C" fn end_at_exit() {
    if let Some(control) = CONTROL.get() {
        control.end();
    }
}
