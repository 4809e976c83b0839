//! Ends of the process. However it ends – window closed, signal, lost display, `exit` in a library – the control first
//! brakes, makes the outputs safe and stores everything. Source: safety stance; spec B6 (data kept).

use std::sync::OnceLock;

use crate::host::control_end::ControlEnd;

/// The control of this process.
static CONTROL: OnceLock<ControlEnd> = OnceLock::new();

/// From now on, every end of this process ends the control first: SIGINT, SIGTERM, SIGHUP (Windows: Ctrl+C, log-off,
/// shutdown), and a library that calls `exit` – Xlib does when the display is lost.
///
/// # Errors
/// The system takes no handler; a signal would end the process at once.
pub fn guard_process(control: ControlEnd) -> std::io::Result<()> {
    if CONTROL.set(control).is_err() {
        return Ok(());
    }
    if !shutdown_hooks::add_shutdown_hook(end_at_exit) {
        return Err(std::io::Error::other("the system takes no exit handler"));
    }
    ctrlc::set_handler(|| std::process::exit(0)).map_err(std::io::Error::other)
}

extern "C" fn end_at_exit() {
    if let Some(control) = CONTROL.get() {
        control.end();
    }
}
