//! Opens the control in a window (T1), and shows a control on a thread.

use std::path::Path;
use std::sync::atomic::Ordering;
use std::time::Duration;

use super::args::SharedArgs;
use super::process_end::{guard_exit, guard_process};
use super::serve::start_network_in;
use super::{CallError, SUCCESS, setup};
use crate::defs::alarm;
use crate::defs::param::Params;
use crate::defs::text::{LocalizedText, phrase};
use crate::hmi::core_fault::CoreHealth;
use crate::hmi::sound::{Beep, Speaker};
use crate::hmi::window::{CoreConnection, WindowError, run};
#[cfg(target_os = "linux")]
use crate::host::absent_machine::AbsentMachine;
use crate::host::buzzer::{Buzzer, Note};
#[cfg(target_os = "linux")]
use crate::host::field_machine::HostedFieldBus;
use crate::host::hosted_machine::HostedMachine;
use crate::host::link::HostLink;
use crate::host::part::PartRule;
use crate::host::thread::{run_until_stopped, start};
#[cfg(target_os = "linux")]
use crate::io::fieldbus::description::MachineDescription;
use crate::link::{Command, Snapshot};

/// Opens the control (T1); returns when the window is closed. The machine is chosen here: that of a description, never
/// another one in its place; without a description the simulated one.
///
/// # Errors
/// There is no display, data and folders cannot be opened, or the description of the machine is wrong.
pub fn open(shared: &SharedArgs, fullscreen: bool) -> Result<u8, CallError> {
    match setup::real_machine(shared)? {
        Some(file) => open_real(shared, &file, fullscreen),
        None => open_with(setup::simulated_for_display, None, shared, fullscreen),
    }
}

/// Opens the control on a real machine. A description that cannot be used is an alarm that stands: the pages work, the bus is
/// not started.
#[cfg(target_os = "linux")]
fn open_real(shared: &SharedArgs, file: &Path, fullscreen: bool) -> Result<u8, CallError> {
    if !shared.params.is_empty() || !shared.sets.is_empty() {
        return Err(CallError::new(
            "--param and --set: the values of a real machine are changed on its pages, with their passwords",
        ));
    }
    let mark = || setup::mark_real_machine(shared, file);
    match usable_description(shared, file) {
        Ok(description) => {
            let opened = move |_: &SharedArgs, params: &Params| {
                mark()?;
                description.check_against(params).map_err(CallError::at(file.display()))?;
                setup::open_bus(description).map(HostedFieldBus::new)
            };
            open_with(opened, None, shared, fullscreen)
        }
        Err(why) => {
            warn_line!("kt830: {why}");
            let opened = |_: &SharedArgs, _: &Params| mark().map(|()| AbsentMachine);
            open_with(opened, Some(&unusable_text(file, &why)), shared, fullscreen)
        }
    }
}

/// What the alarm page says of a description that cannot be used; the name of the file comes first.
#[cfg(target_os = "linux")]
fn unusable_text(file: &Path, why: &CallError) -> LocalizedText {
    if file.exists() {
        return LocalizedText::same(why);
    }
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let folder = file.parent().unwrap_or(file).display().to_string();
    phrase!("{name} 不存在（{folder}）", "{name} is missing ({folder})", name, folder)
}

/// The description of the real machine, if it fits the data.
#[cfg(target_os = "linux")]
fn usable_description(shared: &SharedArgs, file: &Path) -> Result<MachineDescription, CallError> {
    let description = setup::read_description(file)?;
    if description.kind != shared.kind {
        return Err(CallError::new(format!(
            "{}: a machine of kind {}; the control is set to {}",
            file.display(),
            description.kind.id(),
            shared.kind.id(),
        )));
    }
    description.check_against(&setup::kept_params(shared)?).map_err(CallError::at(file.display()))?;
    Ok(description)
}

#[cfg(not(target_os = "linux"))]
fn open_real(_shared: &SharedArgs, file: &Path, _fullscreen: bool) -> Result<u8, CallError> {
    Err(CallError::new(format!("{}: a field bus needs Linux", file.display())))
}

/// Opens the control on a machine.
fn open_with<P: HostedMachine + Send + 'static>(
    machine: impl FnOnce(&SharedArgs, &Params) -> Result<P, CallError>,
    unusable: Option<&LocalizedText>,
    shared: &SharedArgs,
    fullscreen: bool,
) -> Result<u8, CallError> {
    let mut host = setup::threaded_host(shared, true, machine)?;
    unusable.into_iter().for_each(|why| host.report_standing(alarm::MACHINE_UNUSABLE, why));
    // The retained work offset and tool geometry hold; they may be the operator's own.
    if let Some(part) = setup::part(&host, shared, host.retained().current_program)? {
        host.place_part(&part);
    }
    host.set_part_rule(if shared.part.is_some() { PartRule::Keep } else { PartRule::FollowProgram });
    let mut link = start(host, run_until_stopped).map_err(CallError::new)?;
    let folder = setup::data_dir(shared)?.root().to_path_buf();
    let _network = start_network_in(&mut link, shared, Some(folder))?;
    show(link, shared, fullscreen)
}

/// Shows a control in a window; returns when it is closed and the control has stopped.
///
/// # Errors
/// There is no display.
pub fn show(link: HostLink, shared: &SharedArgs, fullscreen: bool) -> Result<u8, CallError> {
    guard_process(link.control_end()).map_err(CallError::at("end of the process"))?;
    let mut hmi = setup::screen(shared);
    // A picture is not dimmed.
    hmi.set_brightness(shared.brightness);
    let speaker = Buzzer::open().map(|buzzer| Box::new(buzzer) as Box<dyn Speaker>);
    match run(Box::new(link), hmi, fullscreen, speaker) {
        Ok(()) => Ok(SUCCESS),
        Err(error @ WindowError::NoDisplay(_)) => Err(CallError::new(format!(
            "{error}. Without a display use `kt830 demo` (a story to its end), `kt830 run PROGRAM` or `kt830 shot PAGE --out FILE.png`"
        ))),
        Err(error @ WindowError::Graphics(_)) => Err(CallError::new(error)),
    }
}

/// Whether there is a display.
#[must_use]
pub fn has_display() -> bool {
    let named = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    cfg!(any(not(unix), target_os = "macos")) || named("DISPLAY")
}

impl Speaker for Buzzer {
    fn play(&mut self, beep: Beep) {
        const fn note(hertz: u32, millis: u64) -> Note {
            (hertz, Duration::from_millis(millis))
        }
        const KEY: &[Note] = &[note(1_500, 15)];
        const REFUSED: &[Note] = &[note(400, 150)];
        const FINISHED: &[Note] = &[note(880, 120), note(1_320, 200)];
        const ALARM: &[Note] = &[note(2_000, 150), note(0, 100), note(2_000, 150), note(0, 100), note(2_000, 150)];
        Self::play(
            self,
            match beep {
                Beep::Key => KEY,
                Beep::Refused => REFUSED,
                Beep::PartFinished => FINISHED,
                Beep::Alarm => ALARM,
            },
        );
    }
}

impl CoreConnection for HostLink {
    fn newest(&mut self) -> &Snapshot {
        Self::newest(self)
    }

    fn health(&self) -> CoreHealth {
        CoreHealth { snapshot_age: self.snapshot_age(), failed: self.health().failed.load(Ordering::Acquire) }
    }

    fn is_ended(&self) -> bool {
        self.control_end().is_requested()
    }

    fn window_opened(&self) {
        // The handler of `guard_process` still acts if this one is not taken.
        drop(guard_exit());
    }

    fn send(&mut self, command: Command) {
        // The queue is full only while the control does not tick; the watchdog shows that.
        let _ = Self::send(self, command);
    }
}
