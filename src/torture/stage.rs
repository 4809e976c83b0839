//! The stage of a tortured control: every tick is checked, and a power cut takes what was not flushed.

use std::cell::RefCell;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use super::invariants::{Invariants, Moment, outputs_on};
use super::ledger::{Ledger, first_difference, rows};
use super::machine::WatchedMachine;
use super::planted::{PlantedBug, Reported};
use super::simulated_disk::{DiskFaults, Files, SimulatedDisk};
use super::storage::{DataPlace, DelayedStorage};
use super::{TortureError, TraceHash};
use crate::controller::PowerOnState;
use crate::defs::alarm;
use crate::defs::key::Key;
use crate::defs::kind::Kind;
use crate::defs::text::LocalizedText;
use crate::host::Host;
use crate::host::cycle_time;
use crate::host::folders::Folders;
use crate::host::job_runner::JobRunner;
use crate::host::part::PartRule;
use crate::host::retained_store::RetainedStore;
use crate::host::simulated::HostedSimulation;
use crate::host::storage::{DirectStorage, RetainedWorker};
use crate::io::random::SplitMix64;
use crate::io::sim::{MachineFile, SimulatedMachine};
use crate::link::command::Command;
use crate::link::page_command::{DataChoice, PageCommand};
use crate::link::snapshot::{RunState, Snapshot};
use crate::nc::CommonVariables;
use crate::store::disk::{ObservationGuard, observe};
use crate::store::{DATABASE_FILE, DataDir, RetainedDatabase, is_temporary};
use crate::story::Stage;
use crate::story::statement::DiskCondition;
use crate::units::{Axis, Micros};

/// How often pages are looked at.
const LOOK_INTERVAL: Micros = Micros::from_millis(500);
/// How often values shown, in force and stored are compared.
const COMPARE_INTERVAL: Micros = Micros::from_millis(60_000);
/// The control has gathered and stored what was written so long ago.
const SETTLING: Micros = Micros::from_millis(2_000);
/// A power cut that is to come while the disk writes waits for it so long.
const MOST_TICKS_TO_A_WRITE: u32 = 2_000;
/// How often the screen sends its keep-alive.
const KEEP_ALIVE_INTERVAL: Micros = Micros::from_millis(100);

/// What was done to a control.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counts {
    /// Ticks.
    pub ticks: u64,
    /// Commands of the operator.
    pub commands: u64,
    /// Runs that have begun: programs and lines of the operator.
    pub runs: u64,
    /// Ticks in which something moved along a path.
    pub running_ticks: u64,
    /// Power cuts.
    pub power_cuts: u64,
    /// Power cuts after which the data were damaged.
    pub damages: u64,
    /// Changes of the disk.
    pub disk_changes: u64,
}

/// A tortured control with its machine and its storage.
pub type TortureHost = Host<WatchedMachine, DelayedStorage>;

/// A control, its machine, its disk, and what is watched.
pub struct TortureStage {
    kind: Kind,
    host: TortureHost,
    disk: Rc<RefCell<SimulatedDisk>>,
    _observed: ObservationGuard,
    data: DataDir,
    chance: SplitMix64,
    bug: Option<PlantedBug>,
    invariants: Invariants,
    /// What does not hold, once.
    violation: Option<String>,
    trace: TraceHash,
    counts: Counts,
    looked_at: Micros,
    compared_at: Micros,
    /// The files before the tick in which the power went, and after the part of it that was still made.
    cut_files: [Files; 2],
    /// Bits that flip in the next power cut.
    flips: u32,
    /// The data were damaged at the last start: alarm 300 must stand.
    damaged: bool,
    /// A person has been asked to accept the damaged data since.
    is_accepted: bool,
    /// When state or values have changed last.
    busy_at: Micros,
    was_running: bool,
    held_since: Option<Micros>,
    stuck_key: Option<Key>,
    /// The screen has sent its keep-alive, and hangs until then.
    screen_heard_at: Micros,
    screen_hangs_until: Micros,
}

impl TortureStage {
    /// A control at its first start, in a data directory that is empty.
    ///
    /// # Errors
    /// The directory cannot be used.
    pub fn new(folder: &Path, kind: Kind, seed: u64, bug: Option<PlantedBug>) -> Result<Self, TortureError> {
        let data = DataDir::resolve(Some(folder)).map_err(TortureError::new)?;
        Folders::of_data(&data, kind).map_err(TortureError::new)?;
        let faults = DiskFaults {
            flushes_no_file: bug == Some(PlantedBug::DiskIgnoresFileFlushes),
            flushes_no_folder: bug == Some(PlantedBug::DiskIgnoresFolderFlushes),
        };
        let disk = SimulatedDisk::of_folder(data.root(), faults).map_err(TortureError::new)?;
        let disk = Rc::new(RefCell::new(disk));
        let observed = observe(disk.clone());
        let OpenedStorage { storage, retained, standing } = open_storage(&data, kind)?;
        let storage = DelayedStorage::new(storage, Ledger::new(retained.clone()), (seed, bug), data_place(&data));
        let file = MachineFile::builtin(kind).map_err(TortureError::new)?;
        let machine = SimulatedMachine::new(file, None, &retained.params, seed);
        let machine = HostedSimulation::new(machine, Micros::from_millis(10_000));
        let machine = WatchedMachine::new(machine, retained.params.clone(), seed, bug);
        let mut host = Host::connect(kind, retained, machine, storage);
        host.set_part_rule(PartRule::FollowProgram);
        standing.iter().for_each(|(number, what)| host.report_standing(*number, what));
        disk.borrow_mut().end_tick();
        Ok(Self {
            kind,
            host,
            disk,
            _observed: observed,
            data,
            chance: SplitMix64::new(seed),
            bug,
            invariants: Invariants::default(),
            violation: None,
            trace: TraceHash::default(),
            counts: Counts::default(),
            looked_at: Micros::ZERO,
            compared_at: Micros::ZERO,
            cut_files: Default::default(),
            flips: 0,
            damaged: false,
            is_accepted: false,
            busy_at: Micros::ZERO,
            was_running: false,
            held_since: None,
            stuck_key: None,
            screen_heard_at: Micros::ZERO,
            screen_hangs_until: Micros::ZERO,
        })
    }

    /// What does not hold, if something does not.
    #[must_use]
    pub fn violation(&self) -> Option<&str> {
        self.violation.as_deref()
    }

    /// Fingerprint of every input and output so far.
    #[must_use]
    pub const fn trace(&self) -> TraceHash {
        self.trace
    }

    /// Fingerprint of what was written to the disk.
    #[must_use]
    pub fn written(&self) -> TraceHash {
        self.disk.borrow().written
    }

    /// What was done.
    #[must_use]
    pub fn counts(&self) -> Counts {
        Counts { disk_changes: self.disk.borrow().changes, ..self.counts }
    }

    fn count_runs(&mut self) {
        let runs = self.host.controller().state() == RunState::Running;
        self.counts.running_ticks += u64::from(runs);
        self.counts.runs += u64::from(runs && !std::mem::replace(&mut self.was_running, runs));
        self.was_running = runs;
    }

    fn fail(&mut self, what: Result<(), String>) {
        if let (Err(what), None) = (what, &self.violation) {
            self.violation = Some(what);
        }
    }

    /// Commands of a bug that the invariants do not hear.
    fn hidden_commands(&mut self) -> Vec<Command> {
        let state = self.host.controller().state();
        let now = self.host.now();
        self.held_since = if state == RunState::Held { self.held_since.or(Some(now)) } else { None };
        let held = self.held_since.is_some_and(|since| now.since(since) > Micros::from_millis(1_000));
        match self.bug {
            Some(PlantedBug::HoldEndsByItself) if held => vec![Command::Press(Key::CycleStart)],
            Some(PlantedBug::ResumesAfterPowerOn) if self.counts.power_cuts > 0 && state == RunState::Idle => {
                vec![Command::Press(Key::CycleStart)]
            }
            Some(PlantedBug::JogKeySticks) => {
                for command in self.host.queued_commands() {
                    match command {
                        Command::Press(key) if key.jog_direction().is_some() => self.stuck_key = Some(*key),
                        Command::Press(_) => self.stuck_key = None,
                        _ => {}
                    }
                }
                let pressed = |key| [Command::Press(key), Command::StillHeld(key)];
                self.stuck_key.into_iter().flat_map(pressed).collect()
            }
            _ => Vec::new(),
        }
    }

    /// Sends the keep-alive of the screen if it is due; true if the screen has sent it.
    fn keep_alive(&mut self) -> bool {
        let now = self.host.now();
        let is_due = self.host.is_powered() && now.since(self.screen_heard_at) >= KEEP_ALIVE_INTERVAL;
        let is_heard = is_due && now >= self.screen_hangs_until;
        if is_due && (is_heard || self.bug == Some(PlantedBug::BlindToScreen)) {
            self.screen_heard_at = now;
            self.host.send(Command::KeepAlive);
        }
        is_heard
    }

    /// What the pages show.
    fn shown(&mut self) -> Snapshot {
        let mut shown = self.host.snapshot().clone();
        self.bug.into_iter().for_each(|bug| bug.tamper_shown(&mut shown));
        shown
    }

    /// What the control says of itself.
    fn reported(&self, waiting_requests: usize) -> Reported {
        let controller = self.host.controller();
        let mut reported = Reported {
            state: controller.state(),
            mode: controller.mode(),
            oscillates_by_key: controller.oscillates_by_key(),
            work: controller.work_of_last_tick(),
            waiting_requests,
        };
        self.bug
            .into_iter()
            .for_each(|bug| bug.tamper_reported((self.counts.ticks, self.counts.runs > 0), &mut reported));
        reported
    }

    fn check_tick(&mut self, commands: &[Command], screen_heard: bool) {
        if self.violation.is_some() {
            return;
        }
        let (powered, waiting, now) = (self.host.is_powered(), self.host.waiting_requests(), self.host.now());
        let looks = powered && now.since(self.looked_at) >= LOOK_INTERVAL;
        let shown = looks.then(|| self.shown());
        let reported = self.reported(waiting);
        let controller = self.host.controller();
        let machine = self.host.machine_side_ref();
        let outputs_on = outputs_on(machine, controller);
        let moment = Moment { now, commands, screen_heard, machine, outputs_on, controller, reported, powered };
        let mut holds = self.invariants.check(&moment);
        if let Some(shown) = &shown {
            holds = holds.and_then(|()| self.invariants.check_shown(shown, &moment));
        }
        if !commands.is_empty() || moment.controller.state() != RunState::Idle {
            self.busy_at = now;
        }
        self.fail(holds);
        if let Some(shown) = shown {
            self.looked_at = now;
            let stands = shown.alarms.iter().any(|alarm| alarm.number == alarm::RETAINED_DATA_DAMAGED);
            if self.damaged && !self.is_accepted && !stands {
                self.fail(Err("damaged data were replaced without an alarm".to_owned()));
            }
        }
        if powered && now.since(self.compared_at) >= COMPARE_INTERVAL && now.since(self.busy_at) >= SETTLING {
            self.compared_at = now;
            let compared = self.compare_values();
            self.fail(compared);
        }
    }

    /// What is in force is what was handed over, and what is stored once everything is acknowledged.
    fn compare_values(&mut self) -> Result<(), String> {
        let kept = rows(self.host.retained());
        let mut in_force = self.host.retained().clone();
        let controller = self.host.controller();
        in_force.params = controller.params().clone();
        in_force.work_offsets = controller.work_offsets().clone();
        in_force.dress_points = *controller.dress_points();
        if self.bug == Some(PlantedBug::ValueIsNotHandedOver) {
            in_force.dress_points[Axis::X] = Some(-1.0);
        }
        for number in (0..1_000).filter(|number| CommonVariables::is_retained(*number)) {
            // Cannot fail: the number is retained, and the control holds only valid values.
            let _ = in_force.variables.set(number, controller.variable(number));
        }
        if let Some(what) = first_difference(&kept, &rows(&in_force)) {
            return Err(format!("in force is not what was stored: {what}"));
        }
        if !self.host.storage().is_quiet() {
            return Ok(());
        }
        let root = self.data.root();
        if self.bug == Some(PlantedBug::DatabaseIsTorn) {
            drop(std::fs::write(root.join(DATABASE_FILE), "torn"));
        }
        if self.bug == Some(PlantedBug::CopyIsTorn) {
            drop(std::fs::write(root.join("retained.journal"), "torn"));
        }
        let (Some(whole), Some(stored)) = (RetainedDatabase::peek(root), RetainedStore::read_only(root, self.kind))
        else {
            return Err("the database is not whole".to_owned());
        };
        let copy = RetainedDatabase::newest_copy(root).map(|copy| copy.data);
        match first_difference(&kept, &rows(&stored)) {
            Some(what) => Err(format!("stored is not what is in force: {what}")),
            None if copy.as_ref() != Some(&whole) => Err("the copy is not what is stored".to_owned()),
            None => Ok(()),
        }
    }

    /// Flips bits of the database, as a failing disk does. True if there was something to flip.
    fn flip_bits(&mut self) -> bool {
        let path = self.data.root().join(DATABASE_FILE);
        let Ok(mut bytes) = std::fs::read(&path) else { return false };
        for _ in 0..self.flips {
            let at = (self.chance.next_unit() * bytes.len() as f64) as usize;
            let bit = (self.chance.next_unit() * 8.0) as u32;
            if let Some(byte) = bytes.get_mut(at) {
                *byte ^= 1 << bit;
            }
        }
        self.flips = 0;
        std::fs::write(path, bytes).is_ok()
    }

    /// Goes on until the disk is writing, so that the power goes in between.
    fn wait_for_the_disk(&mut self) {
        for _ in 0..MOST_TICKS_TO_A_WRITE {
            if self.disk.borrow().is_busy() || self.violation.is_some() {
                return;
            }
            self.step();
        }
    }

    /// Files other than the database and its journal are after a power cut what they were: before the tick in which it
    /// came, or after the changes that were made in it.
    fn check_files(&self) -> Result<(), String> {
        let [before, after] = &self.cut_files;
        let paths = before.keys().chain(after.keys()).filter(|path| is_kept(path));
        for path in paths {
            let found = std::fs::read(path).ok();
            if found.as_ref() != before.get(path) && found.as_ref() != after.get(path) {
                let name = path.file_name().unwrap_or_default().to_string_lossy();
                return Err(format!("{name} is lost or altered after the power cut"));
            }
        }
        Ok(())
    }

    fn restart(&mut self) -> Result<(), String> {
        self.disk.borrow_mut().power_on(&mut self.chance).map_err(|error| format!("simulated disk: {error}"))?;
        if self.bug == Some(PlantedBug::SavedProgramIsLost) {
            drop(std::fs::remove_file(self.data.programs().join("O2001.NC")));
        }
        self.check_files()?;
        if self.bug == Some(PlantedBug::CopyLagsBehind) {
            drop(std::fs::write(self.data.root().join("retained.journal"), ""));
        }
        let flipped = self.flips > 0 && self.flip_bits();
        let lock = self.data.root().join("retained.lock");
        let held = (self.bug == Some(PlantedBug::LockOutlivesThePower))
            .then(|| File::options().create(true).truncate(false).write(true).open(lock));
        held.iter().flatten().for_each(|file| drop(file.lock()));
        if self.bug == Some(PlantedBug::PowerCutDamages) {
            drop(std::fs::write(self.data.root().join(DATABASE_FILE), "damaged"));
        }
        let OpenedStorage { storage, retained, standing } = open_storage(&self.data, self.kind)
            .map_err(|error| format!("the control does not start again: {error}"))?;
        let was_damaged = self.damaged;
        self.is_accepted = false;
        self.damaged = standing.iter().any(|(number, _)| *number == alarm::RETAINED_DATA_DAMAGED);
        self.counts.damages += u64::from(self.damaged && flipped);
        // Damage is an alarm and costs nothing that was acknowledged, or it has hit nothing that is in use.
        let ledger = &self.host.storage().ledger;
        if self.damaged && flipped {
            ledger.check_after_loss(&retained)?
        } else {
            ledger.check(&retained)?
        }
        if self.damaged && !flipped && !was_damaged {
            return Err("a power cut has damaged the data".to_owned());
        }
        let silent = self.bug == Some(PlantedBug::DamageIsSilent);
        let standing = if silent { Vec::new() } else { standing };
        self.host.storage().power_on(storage, Ledger::new(retained.clone()));
        self.host.power_on_with(retained, standing);
        self.disk.borrow_mut().end_tick();
        self.host.machine_side().set_powered(true);
        self.busy_at = self.host.now();
        Ok(())
    }
}

/// What a control finds at its start.
struct OpenedStorage {
    storage: DirectStorage,
    retained: PowerOnState,
    /// Alarms of its data that stand.
    standing: Vec<(u16, LocalizedText)>,
}

/// Whether a file is stored as a whole: a program, a page file, settings, passwords.
fn is_kept(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let is_state = path.parent().is_some_and(|folder| folder.ends_with("generations"));
    !is_state && !name.starts_with("retained.") && !is_temporary(&name)
}

fn data_place(data: &DataDir) -> DataPlace {
    DataPlace(data.root().to_path_buf())
}

/// Folder that stands for the USB stick, beside the data: it is no part of the simulated disk.
fn usb_drive(data: &DataDir) -> PathBuf {
    data.root().with_file_name("usb")
}

/// Opens the storage of a data directory as the control does at its start.
fn open_storage(data: &DataDir, kind: Kind) -> Result<OpenedStorage, TortureError> {
    let (store, report) = RetainedStore::open(data.root(), kind).map_err(TortureError::new)?;
    let folders = Folders::of_data(data, kind).map_err(TortureError::new)?;
    let usb = usb_drive(data);
    std::fs::create_dir_all(&usb).map_err(TortureError::new)?;
    let jobs = JobRunner::new(folders).with_drives(None, Some(usb)).with_cycle_timer(cycle_time::simulate);
    let storage = DirectStorage::new(RetainedWorker::new(Some(store)), jobs).map_err(TortureError::new)?;
    let place = data_place(data);
    let standing = report.standing().into_iter().map(|(number, what)| (number, place.hide_in(&what))).collect();
    Ok(OpenedStorage { storage, retained: report.retained, standing })
}

impl Stage for TortureStage {
    type Machine = WatchedMachine;
    type Storage = DelayedStorage;

    fn host(&mut self) -> &mut TortureHost {
        &mut self.host
    }

    fn step(&mut self) {
        let commands = self.host.queued_commands().to_vec();
        self.counts.commands += commands.len() as u64;
        self.counts.ticks += 1;
        if self.bug.is_some() {
            for hidden in self.hidden_commands() {
                self.host.send(hidden);
            }
            self.host.machine_side().hear(&commands);
        }
        // The person has decided about the damaged data.
        if commands.iter().any(|command| matches!(command, Command::Page(PageCommand::AcceptData(DataChoice::Present))))
        {
            self.is_accepted = true;
        }
        let screen_heard = self.keep_alive();
        // The changes of the last tick are made: no power cut has come between them.
        self.disk.borrow_mut().end_tick();
        self.host.storage().ledger.end_tick();
        self.host.step();
        self.count_runs();
        let machine = self.host.machine_side_ref();
        self.trace.add(&machine.read, &machine.written);
        self.check_tick(&commands, screen_heard);
    }

    fn power_cut(&mut self) {
        if !self.host.is_powered() {
            return;
        }
        if self.chance.next_unit() < 0.5 {
            self.wait_for_the_disk();
        }
        self.counts.power_cuts += 1;
        let before = self.disk.borrow().files();
        let is_whole = self.disk.borrow_mut().power_cut(&mut self.chance);
        self.cut_files = [before, self.disk.borrow().files()];
        match is_whole {
            true => self.host.storage().ledger.end_tick(),
            false => self.host.storage().ledger.forget_told(),
        }
        self.host.machine_side().set_powered(false);
        self.host.power_cut();
        self.host.storage().power_cut();
    }

    fn power_on(&mut self) {
        if self.host.is_powered() {
            self.power_cut();
            // The invariants see that the power is gone.
            self.step();
        }
        let restarted = self.restart();
        self.fail(restarted);
    }

    fn set_disk(&mut self, condition: DiskCondition) -> Result<(), String> {
        let ticks = |seconds: f64| (seconds / self.host.tick_time().as_secs_f64()) as u64;
        match condition {
            DiskCondition::Good => {
                self.disk.borrow_mut().is_full = false;
                self.host.storage().set_slowness(0);
            }
            DiskCondition::Slow(seconds) => {
                let ticks = ticks(seconds);
                self.host.storage().set_slowness(ticks);
            }
            DiskCondition::Hangs(seconds) => {
                let ticks = ticks(seconds);
                self.host.storage().hang(ticks);
            }
            DiskCondition::Full => self.disk.borrow_mut().is_full = true,
            DiskCondition::Flips(bits) => self.flips = bits,
        }
        Ok(())
    }

    fn hang_screen(&mut self, seconds: f64) -> Result<(), String> {
        self.screen_hangs_until = self.host.now() + Micros::from_millis_f64(seconds * 1_000.0);
        Ok(())
    }

    fn is_interrupted(&self) -> bool {
        self.violation.is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::story::{Player, parse};

    fn tell(stage: &mut TortureStage, text: &str) {
        let (_, lines) = parse::parse(text, Kind::Gc).unwrap();
        let mut player = Player::new(stage, None, Path::new("."), false);
        for line in &lines {
            assert_eq!(player.play(line), Ok(()), "{}", line.text);
        }
        drop(player);
        assert_eq!(stage.violation(), None);
    }

    #[test]
    fn b6_a_disk_that_hangs_for_20_s_is_an_alarm_after_one_and_nothing_shown_as_stored_is_lost() {
        let folder = tempfile::tempdir().unwrap();
        let mut stage = TortureStage::new(&folder.path().join("data"), Kind::Gc, 1, None).unwrap();
        tell(&mut stage, "set #500 = 7\nwait 2 s\nexpect no alarm");
        assert!(!stage.host.snapshot().is_storing);
        // In force at once, marked as pending, an alarm after a second; the machine works.
        tell(&mut stage, "disk hangs 20 s\nset #500 = 8\nwait 0.9 s\nexpect #500 8\nexpect no alarm");
        assert!(stage.host.snapshot().is_storing);
        tell(&mut stage, "wait 0.3 s\nexpect alarm 306\nkey hydraulic\nwait 4 s\nhome all\nexpect alarm 306");
        // The disk goes on: stored, and the alarm goes by itself.
        tell(&mut stage, "wait 15 s\nexpect no alarm\npower cut\nwait 1 s\npower on\nwait 1 s\nexpect #500 8");
        // The power goes while it hangs: what was never shown as stored is the value before.
        tell(&mut stage, "disk hangs 20 s\nset #500 = 9\nwait 5 s\nexpect alarm 306\npower cut\nwait 1 s\npower on");
        tell(&mut stage, "wait 1 s\nexpect #500 8\nexpect no alarm");
    }
}
