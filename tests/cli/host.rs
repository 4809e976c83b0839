//! The host on its thread, duty by duty: a machine that notes what it is told, storage on threads, a screen that waits
//! for what it must see. Nothing sleeps for a fixed time: each test waits for a condition, with a deadline.

use std::fs;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use kt830::controller::files::BackgroundJob;
use kt830::controller::{PowerOnState, nc_settings};
use kt830::defs::alarm;
use kt830::defs::date::DateTime;
use kt830::defs::kind::Kind;
use kt830::defs::page::Page;
use kt830::defs::param::{self, ParamAddress, Params};
use kt830::defs::signal::Input;
use kt830::defs::text::LocalizedText;
use kt830::host::Host;
use kt830::host::folders::Folders;
use kt830::host::hosted_machine::HostedMachine;
use kt830::host::job_runner::JobRunner;
use kt830::host::link::HostLink;
use kt830::host::pace::{Pace, ThreadTimes};
use kt830::host::part::PartRule;
use kt830::host::retained_store::RetainedStore;
use kt830::host::simulated::HostedSimulation;
use kt830::host::storage::{DirectStorage, RetainedWorker, StorageWorker, ThreadedStorage};
use kt830::host::thread::{HostThread, run_until_stopped, start};
use kt830::io::fieldbus::ClockReading;
use kt830::io::sim::{MachineFile, PartFile, SimulatedMachine};
use kt830::io::{Backend, InputImage, OutputImage};
use kt830::link::bus::BusView;
use kt830::link::files::{FileAnswer, FileRequest, Refusal, Requester, Ticket};
use kt830::link::media::{Direction, TransferRequest, TransferSet};
use kt830::link::page_command::{PageCommand, PasswordScope, Secret};
use kt830::link::simulation::{SimCommand, SimView};
use kt830::link::{Command, Snapshot};
use kt830::story::{Player, Stage, parse};
use kt830::units::Micros;
use tempfile::TempDir;

/// How long a test waits for what must come.
const DEADLINE: Duration = Duration::from_secs(30);

/// What a machine was told.
#[derive(Default)]
struct Notes {
    reads: Vec<Micros>,
    writes: Vec<Micros>,
    last_outputs: OutputImage,
    drives_were_on: bool,
    rewired: u32,
    powered_on: u32,
    parts: Vec<String>,
    simulated: Vec<SimCommand>,
}

/// What a machine does next.
#[derive(Default)]
struct Orders {
    panic_in_read: AtomicBool,
    panic_in_write: AtomicBool,
    slow: AtomicBool,
}

/// The simulated machine behind a backend that notes every duty.
struct NotedPlant {
    plant: HostedSimulation,
    notes: Arc<Mutex<Notes>>,
    orders: Arc<Orders>,
    pace: Pace,
}

impl NotedPlant {
    fn new(pace: Pace, params: &Params) -> Self {
        let machine = SimulatedMachine::new(MachineFile::builtin(Kind::Gc).unwrap(), None, params, 1);
        let plant = HostedSimulation::new(machine, Micros::from_millis(100));
        Self { plant, notes: Arc::default(), orders: Arc::default(), pace }
    }
}

impl Backend for NotedPlant {
    fn read(&mut self, now: Micros) -> InputImage {
        assert!(!self.orders.panic_in_read.swap(false, Ordering::AcqRel), "the bus driver has a bug");
        if self.orders.slow.load(Ordering::Acquire) {
            std::thread::sleep(Duration::from_millis(5)); // a bus that takes longer than a tick
        }
        self.notes.lock().unwrap().reads.push(now);
        self.plant.read(now)
    }

    fn write(&mut self, now: Micros, outputs: &OutputImage) {
        assert!(!self.orders.panic_in_write.swap(false, Ordering::AcqRel), "the bus driver has a bug");
        let mut notes = self.notes.lock().unwrap();
        notes.writes.push(now);
        notes.last_outputs = *outputs;
        notes.drives_were_on |= outputs.drives_on;
        self.plant.write(now, outputs);
    }

    fn rewire(&mut self, params: &Params) {
        self.notes.lock().unwrap().rewired += 1;
        self.plant.rewire(params);
    }
}

impl HostedMachine for NotedPlant {
    fn pace(&self) -> Pace {
        self.pace
    }

    fn begin(&mut self) {
        self.plant.begin();
    }

    fn power_on(&mut self, params: &Params) {
        self.notes.lock().unwrap().powered_on += 1;
        self.plant.power_on(params);
    }

    fn mount_part(&mut self, part: &PartFile) {
        self.notes.lock().unwrap().parts.push(part.name.clone());
        self.plant.mount_part(part);
    }

    fn measure_finished_part(&mut self) {
        self.plant.measure_finished_part();
    }

    fn simulate(&mut self, command: SimCommand) {
        self.notes.lock().unwrap().simulated.push(command);
        self.plant.simulate(command);
    }

    fn view(&mut self, now: Micros) -> Option<Arc<SimView>> {
        self.plant.view(now)
    }

    fn simulation(&mut self) -> Option<&mut SimulatedMachine> {
        self.plant.simulation()
    }

    fn clear_counters(&mut self) {
        self.plant.clear_counters();
    }

    fn bus_clock(&mut self) -> Option<ClockReading> {
        self.plant.bus_clock()
    }

    fn bus_view(&mut self, now: Micros, times: &ThreadTimes) -> Option<Arc<BusView>> {
        self.plant.bus_view(now, times)
    }

    fn settling_time(&self) -> Micros {
        self.plant.settling_time()
    }

    fn take_bus_fault(&mut self) -> Option<(u16, LocalizedText)> {
        self.plant.take_bus_fault()
    }
}

type NotedHost = Host<NotedPlant, ThreadedStorage>;

/// A control on its thread, its machine and its files.
struct Bench {
    link: HostLink,
    notes: Arc<Mutex<Notes>>,
    orders: Arc<Orders>,
    files: TempDir,
}

/// A data directory with its own programs and page files.
fn files() -> TempDir {
    let files = tempfile::tempdir().unwrap();
    let shipped = crate::stories::folders();
    for (name, from) in [("programs", &shipped.programs), ("screens", &shipped.screens)] {
        let to = files.path().join(name);
        fs::create_dir(&to).unwrap();
        for entry in fs::read_dir(from).unwrap().map(Result::unwrap).filter(|entry| entry.path().is_file()) {
            fs::copy(entry.path(), to.join(entry.file_name())).unwrap();
        }
    }
    fs::create_dir(files.path().join("data")).unwrap();
    files
}

fn folders(files: &TempDir) -> Folders {
    let dialect = Kind::Gc.dialect();
    Folders { programs: files.path().join("programs"), screens: files.path().join("screens"), by_name: false, dialect }
}

impl Bench {
    fn new() -> Self {
        Self::with(Pace::Simulated, |jobs| jobs, run_until_stopped)
    }

    fn with(
        pace: Pace,
        jobs: impl FnOnce(JobRunner) -> JobRunner,
        script: impl FnOnce(&mut HostThread<NotedPlant, ThreadedStorage>) + Send + 'static,
    ) -> Self {
        let files = files();
        let (store, found) = RetainedStore::open(&files.path().join("data"), Kind::Gc).unwrap();
        let worker = StorageWorker::new(jobs(JobRunner::new(folders(&files))));
        let storage = ThreadedStorage::start(RetainedWorker::new(Some(store)), worker).unwrap();
        let plant = NotedPlant::new(pace, &found.retained.params);
        let (notes, orders) = (Arc::clone(&plant.notes), Arc::clone(&plant.orders));
        let mut host = NotedHost::connect(Kind::Gc, found.retained, plant, storage);
        host.set_part_rule(PartRule::FollowProgram);
        let link = start(host, script).unwrap();
        Self { link, notes, orders, files }
    }

    fn send(&self, command: Command) {
        assert!(self.link.send(command));
    }

    /// Waits until a snapshot shows something.
    fn until(&mut self, what: &str, seen: impl Fn(&Snapshot) -> bool) {
        let begun = Instant::now();
        while !seen(self.link.newest()) {
            assert!(begun.elapsed() < DEADLINE, "{what}");
            assert!(!self.link.health().failed.load(Ordering::Acquire), "the control has failed: {what}");
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    /// Waits until the machine has noted something.
    fn until_noted(&self, what: &str, noted: impl Fn(&Notes) -> bool) {
        wait(what, || noted(&self.notes.lock().unwrap()));
    }

    /// Closes the screen; the control thread has ended when this returns.
    fn close(self) -> (Arc<Mutex<Notes>>, TempDir) {
        drop(self.link);
        (self.notes, self.files)
    }

    fn ticks(&self) -> u64 {
        self.link.health().ticks.load(Ordering::Acquire)
    }
}

fn wait(what: &str, mut done: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !done() {
        assert!(begun.elapsed() < DEADLINE, "{what}");
        std::thread::sleep(Duration::from_millis(1));
    }
}

fn program_names(snapshot: &Snapshot) -> Vec<u32> {
    snapshot.directory.iter().map(|row| row.number).collect()
}

#[test]
fn every_tick_reads_then_writes_at_the_time_of_the_tick() {
    let bench = Bench::new();
    bench.until_noted("ticks", |notes| notes.writes.len() > 100);
    let (notes, _files) = bench.close();
    let notes = notes.lock().unwrap();
    // The first read is that of the power-on, the last write that of the safe image.
    assert_eq!(notes.reads.len(), notes.writes.len());
    assert_eq!(notes.reads[1..], notes.writes[..notes.writes.len() - 1]);
    let tick = notes.reads[1];
    assert!(notes.reads.windows(2).all(|pair| pair[1].since(pair[0]) == tick), "one tick after the other");
}

#[test]
fn a_changed_port_reaches_the_machine() {
    let mut bench = Bench::new();
    let (input, port) =
        (Input::TailstockRetracted, ParamAddress { number: Input::TailstockRetracted.port_param(), bit: None });
    bench.until("the tailstock is back", |snapshot| snapshot.inputs.has(input));
    bench.send(Command::SetParam(port, 60.0));
    bench.until("the port", |snapshot| snapshot.params.read(port).is_ok_and(|port| port > 59.0));
    bench.until_noted("rewire", |notes| notes.rewired > 0);
    bench.until("the machine drives the new port", |snapshot| snapshot.terminals.inputs.is_closed(60));
    bench.until("the tailstock is still back", |snapshot| snapshot.inputs.has(input));
    assert_eq!(bench.notes.lock().unwrap().rewired, 1, "once a change");
}

/// Nothing is being stored: the data are missed all the same.
#[test]
fn b6_a_data_folder_that_is_removed_while_the_control_rests_raises_the_alarm() {
    let mut bench = Bench::new();
    bench.until("the control runs", |snapshot| snapshot.program.number > 0 || !snapshot.directory.is_empty());
    let failed = |snapshot: &Snapshot| snapshot.alarms.iter().any(|alarm| alarm.number == alarm::STORE_FAILED);
    assert!(!failed(bench.link.newest()));
    let data = bench.files.path().join("data");
    fs::rename(&data, data.with_extension("aside")).unwrap();
    bench.until("alarm 301", failed);
}

#[test]
fn the_part_follows_the_accepted_program() {
    let mut bench = Bench::new();
    bench.send(Command::LoadProgram(1_999)); // there is none
    bench.send(Command::LoadProgram(1_002));
    bench.until("the program", |snapshot| snapshot.program.number == 1_002);
    bench.until_noted("its part", |notes| !notes.parts.is_empty());
    bench.until("its outline in the drawing", |snapshot| !snapshot.stock.is_empty());
    assert_eq!(bench.notes.lock().unwrap().parts, [PartFile::builtin(1_002).unwrap().unwrap().name]);
}

#[test]
fn commands_of_the_simulator_page_reach_the_machine_and_its_view_comes_back() {
    let mut bench = Bench::new();
    let force = SimCommand::Force(Input::User1, Some(true));
    bench.send(Command::Simulate(force));
    let forced = |snapshot: &Snapshot| {
        snapshot.simulated.as_ref().is_some_and(|view| view.forced.contains(&(Input::User1, true)))
    };
    bench.until("the view", forced);
    bench.until("the input", |snapshot| snapshot.inputs.has(Input::User1));
    assert_eq!(bench.notes.lock().unwrap().simulated, [force]);
}

#[test]
fn programs_and_page_files_are_there_at_the_first_tick_and_copied_files_are_seen() {
    let mut bench = Bench::new();
    assert!(program_names(bench.link.newest()).contains(&1_001), "before the first tick");
    bench.until("page files", |snapshot| !snapshot.screens.pages.is_empty());
    let folder = bench.files.path().join("programs");
    fs::write(folder.join("O7123.NC"), "O7123\nM30\n").unwrap();
    bench.until("the new program", |snapshot| program_names(snapshot).contains(&7_123));
    let before = Arc::clone(&bench.link.newest().screens);
    fs::remove_file(bench.files.path().join("screens/C0001.TXT")).unwrap();
    bench.until("page files again", |snapshot| !Arc::ptr_eq(&snapshot.screens, &before));
}

#[test]
fn values_are_stored_and_a_change_is_there_after_a_restart() {
    let mut bench = Bench::new();
    bench.send(Command::SetVariable(500, Some(1.25)));
    bench.until("the variable", |snapshot| snapshot.variables[500] == Some(1.25));
    let (_, files) = bench.close();
    let (_, found) = RetainedStore::open(&files.path().join("data"), Kind::Gc).unwrap();
    assert_eq!(found.retained.variables.get(500).unwrap(), Some(1.25));
}

#[test]
fn a_password_is_checked_on_the_storage_thread() {
    let mut bench = Bench::new();
    let level = bench.link.newest().access.level;
    bench.send(Command::Page(PageCommand::Unlock(PasswordScope::User, Secret::new("123456".into()))));
    bench.until("access", |snapshot| snapshot.access.level != level);
}

#[test]
fn the_time_of_day_comes_and_comes_again_after_a_power_cut() {
    let mut bench = Bench::new();
    bench.until("the date", |snapshot| snapshot.date.is_some());
    // A headless control: the time that was sent goes on.
    let mut rig = crate::stories::rig();
    rig.send(Command::WallClock(DateTime(1_000)));
    crate::stories::tell(&mut rig, "power on\nwait 5 s\npower cut\nwait 5 s\npower on\nwait 0.1 s");
    assert_eq!(rig.snapshot().date, Some(DateTime(1_010)));
}

#[test]
fn the_answer_of_a_job_comes_with_the_programs_it_changed() {
    let mut bench = Bench::new();
    bench.send(Command::Page(PageCommand::Unlock(PasswordScope::Program, Secret::new("187350".into()))));
    bench.until("access", |snapshot| !snapshot.access.password_pending && snapshot.access.answer_count > 0);
    bench.send(Command::Press(kt830::defs::key::Mode::Edit.key()));
    bench.until("edit mode", |snapshot| snapshot.mode == kt830::defs::key::Mode::Edit);
    bench.send(Command::Page(PageCommand::File(Ticket::without_reply(Requester::Transfer), FileRequest::New(7_200))));
    bench.until("the answer", |snapshot| !snapshot.files.answers.is_empty());
    let newest = bench.link.newest();
    assert!(newest.files.answers.iter().all(|answer| answer.result.is_ok()), "{:?}", newest.files.answers);
    assert!(program_names(newest).contains(&7_200), "the first snapshot with the answer has the program");
}

/// A fault of the software in a job: the operator is told, and the next job is carried out.
#[test]
fn a_panic_in_a_job_ends_the_job_and_not_its_thread() {
    let jobs = |jobs: JobRunner| jobs.with_cycle_timer(|_, _, _, _| panic!("planted"));
    let mut bench = Bench::with(Pace::Simulated, jobs, run_until_stopped);
    bench.until("programs", |snapshot| !snapshot.directory.is_empty());
    for asked in 1..=2 {
        let ticket = Ticket { requester: Requester::Graphic, number: asked };
        bench.send(Command::Page(PageCommand::File(ticket, FileRequest::ComputeToolpath(1_001))));
        bench.until("the answer", |snapshot| snapshot.files.answers.iter().any(|answer| answer.ticket == ticket));
        let files = &bench.link.newest().files;
        let last = files.answers.last().unwrap().result.clone();
        assert!(matches!(&last, Err(Refusal::Other(said)) if said.zh().contains("内部错误")), "{last:?}");
        assert_eq!(files.busy, None);
    }
}

#[cfg(unix)]
#[test]
fn a_serial_transfer_that_waits_is_cancelled_and_delays_no_value() {
    use serialport::{SerialPort, TTYPort};
    let (_other, own) = TTYPort::pair().unwrap();
    let port = own.name().unwrap();
    let _kept = fs::File::open(&port).unwrap();
    let mut bench = Bench::with(Pace::Simulated, |jobs| jobs.with_serial(Some(port), None), run_until_stopped);
    bench.send(Command::Page(PageCommand::Unlock(PasswordScope::Program, Secret::new("187350".into()))));
    bench.until("access", |snapshot| !snapshot.access.password_pending && snapshot.access.answer_count > 0);
    let file = |request| Command::Page(PageCommand::File(Ticket::without_reply(Requester::Transfer), request));
    let ask = TransferRequest {
        set: TransferSet::Serial,
        direction: Direction::Import,
        names: Vec::new(),
        overwrite: None,
        convert: None,
        split: None,
    };
    bench.send(file(FileRequest::Transfer(ask)));
    bench.until("the line waits", |snapshot| snapshot.files.bytes_received.is_some());
    bench.send(Command::LoadProgram(1_002));
    bench.until_noted("the part, while the line waits", |notes| !notes.parts.is_empty());
    bench.send(file(FileRequest::Cancel));
    bench.until("the end", |snapshot| !snapshot.files.answers.is_empty() && snapshot.files.busy.is_none());
    let last = bench.link.newest().files.answers.last().unwrap().result.clone();
    assert!(matches!(&last, Err(Refusal::Other(said)) if said.zh().contains("已取消")), "{last:?}");
}

/// The control closes down between taking a job from its queue and beginning it: a cancel that the job resets when it
/// begins would be lost, and the end would wait for the whole calculation.
#[test]
fn what_only_calculates_is_not_begun_after_the_end_and_what_writes_is_completed() {
    let files = files();
    let runner = JobRunner::new(folders(&files));
    runner.end();
    let settings = nc_settings(Kind::Gc, &PowerOnState::factory(Kind::Gc).params);
    let mut answers = Vec::new();
    for request in [FileRequest::ComputeToolpath(1_001), FileRequest::New(4_711)] {
        let job = BackgroundJob {
            ticket: Ticket::without_reply(Requester::Transfer),
            request,
            settings: settings.clone(),
            programs: Arc::default(),
            subprograms_locked: false,
            transfer_values: None,
            start: None,
            date: None,
        };
        runner.run(&job, &mut |answer| answers.push(answer));
    }
    let [FileAnswer::Refused(Refusal::Other(said)), FileAnswer::Done(_)] = answers.as_slice() else {
        panic!("{answers:?}");
    };
    assert_eq!(said.zh(), "已取消");
    assert!(files.path().join("programs/O4711.NC").is_file());
}

#[test]
fn after_a_power_cut_the_screen_is_dark_and_everything_comes_again() {
    let (cut, on) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicBool::new(false)));
    let (do_cut, do_on) = (Arc::clone(&cut), Arc::clone(&on));
    let script = move |thread: &mut HostThread<NotedPlant, ThreadedStorage>| {
        while !thread.is_stopped() {
            if do_cut.swap(false, Ordering::AcqRel) {
                thread.host().power_cut();
            }
            if do_on.swap(false, Ordering::AcqRel) {
                thread.host().power_on();
            }
            thread.turn();
        }
    };
    let mut bench = Bench::with(Pace::Simulated, |jobs| jobs, script);
    bench.until("the date", |snapshot| snapshot.date.is_some() && !snapshot.screens.pages.is_empty());
    bench.send(Command::SetParam(param::TICK_TIME.address(), 2_000.0));
    bench.send(Command::LoadProgram(1_002));
    bench.until("the outline", |snapshot| !snapshot.stock.is_empty());
    cut.store(true, Ordering::Release);
    bench.until("dark", |snapshot| snapshot.outputs.iter().next().is_none() && snapshot.alarms.is_empty());
    bench.until_noted("outputs off", |notes| !notes.last_outputs.drives_on && notes.last_outputs.terminals.0 == 0);
    on.store(true, Ordering::Release);
    bench.until_noted("power on", |notes| notes.powered_on == 1);
    let reads = bench.notes.lock().unwrap().reads.len();
    bench.until("programs", |snapshot| program_names(snapshot).contains(&1_001));
    bench.until("page files and date", |snapshot| !snapshot.screens.pages.is_empty() && snapshot.date.is_some());
    bench.until("program and outline", |snapshot| snapshot.program.number == 1_002 && !snapshot.stock.is_empty());
    // The snapshots before the power-on show the same: the new control reads once, then in its ticks.
    bench.until_noted("ticks", |notes| notes.reads.len() > reads + 2);
    let (notes, _files) = bench.close();
    let reads = &notes.lock().unwrap().reads;
    let last = reads[reads.len() - 1].since(reads[reads.len() - 2]);
    assert_eq!(last, Micros(2_000), "the new tick time holds from the power-on");
}

#[test]
fn a_stop_leaves_the_outputs_safe() {
    let bench = Bench::new();
    bench.until_noted("drives", |notes| notes.drives_were_on);
    let (notes, _files) = bench.close();
    assert_safe(&notes.lock().unwrap());
}

fn assert_safe(notes: &Notes) {
    let last = notes.last_outputs;
    assert!(!last.drives_on && last.wheel_volts.abs() < 1e-9 && last.analog_2_volts.abs() < 1e-9, "{last:?}");
    assert!(notes.writes.last() >= notes.reads.last(), "at the time of the control, not at its start");
}

#[test]
fn a_panic_leaves_the_outputs_safe_and_is_told() {
    let orders: [fn(&Orders) -> &AtomicBool; 2] = [|orders| &orders.panic_in_read, |orders| &orders.panic_in_write];
    for order in orders {
        let mut bench = Bench::new();
        bench.until_noted("drives", |notes| notes.drives_were_on);
        order(&bench.orders).store(true, Ordering::Release);
        wait("the fault is told", || bench.link.health().failed.load(Ordering::Acquire));
        bench.until_noted("safe image", |notes| !notes.last_outputs.drives_on);
        let ticks = bench.ticks();
        bench.link.newest();
        wait("the snapshot gets old", || bench.link.snapshot_age() > Duration::from_millis(50));
        assert_eq!(bench.ticks(), ticks, "no tick after a panic");
        let (notes, _files) = bench.close();
        assert_safe(&notes.lock().unwrap());
    }
}

#[test]
fn ticks_that_are_late_again_and_again_stop_a_real_machine() {
    let mut bench = Bench::with(Pace::Real, |jobs| jobs, run_until_stopped);
    bench.until_noted("drives", |notes| notes.drives_were_on);
    bench.orders.slow.store(true, Ordering::Release);
    let late = |snapshot: &Snapshot| snapshot.alarms.iter().any(|alarm| alarm.number == alarm::LATE_TICKS);
    bench.until("the alarm", late);
    bench.until_noted("drives off", |notes| !notes.last_outputs.drives_on);
    assert!(bench.link.health().late.load(Ordering::Acquire) >= 10);
}

#[test]
fn the_screen_gets_the_newest_snapshot_only() {
    let mut bench = Bench::new();
    let first = bench.link.newest().now;
    // The screen looks away for many snapshots; the control goes on.
    wait("ticks", || bench.ticks() > 400);
    let ticks = bench.ticks();
    let tick = Params::factory(Kind::Gc).get(param::TICK_TIME) as u64;
    let now = bench.link.newest().now;
    assert!(now.0 + 40_000 >= ticks * tick && now > first, "{now:?} after {ticks} ticks, no snapshot from before");
}

#[test]
fn a_program_refused_in_a_hold_leaves_the_part_in_the_machine() {
    let mut rig = crate::stories::ready_with("G98 G01 W-20 F600\nM30");
    crate::stories::tell(
        &mut rig,
        "mode auto\nkey cycle-start\nwait 0.5 s\nkey feed-hold\nwait 0.5 s\nexpect state held",
    );
    rig.set_part_rule(PartRule::FollowProgram);
    rig.send(Command::LoadProgram(1_002));
    (0..4).for_each(|_| rig.step());
    assert_eq!((rig.part_changes(), rig.awaits_part()), (0, false));
    crate::stories::tell(&mut rig, "key reset\nwait 0.5 s");
    rig.set_part_rule(PartRule::FollowProgram);
    rig.send(Command::LoadProgram(1_002));
    (0..4).for_each(|_| rig.step());
    assert_eq!(rig.part_changes(), 1, "accepted when nothing runs");
}

#[test]
fn p5_a_program_mounts_its_part_in_a_simulated_machine_alone() {
    for (pace, mounted) in [(Pace::Simulated, 1), (Pace::Real, 0)] {
        let (files, retained) = (files(), PowerOnState::factory(Kind::Gc));
        let storage = DirectStorage::new(RetainedWorker::new(None), JobRunner::new(folders(&files))).unwrap();
        let plant = NotedPlant::new(pace, &retained.params);
        let notes = Arc::clone(&plant.notes);
        let mut host = Host::connect(Kind::Gc, retained, plant, storage);
        host.set_part_rule(PartRule::FollowProgram);
        host.send(Command::LoadProgram(1_002));
        (0..4).for_each(|_| host.step());
        assert_eq!(host.retained().current_program, 1_002);
        assert_eq!((host.part_changes(), host.awaits_part()), (mounted, false), "{pace:?}");
        assert_eq!(notes.lock().unwrap().parts.len(), mounted as usize, "{pace:?}");
        // A part that is laid in at the start has an outline for the drawing; what lies in a real machine is not known.
        host.place_part(&PartFile::builtin(1_002).unwrap().unwrap());
        host.step();
        assert_eq!(host.snapshot().stock.is_empty(), mounted == 0, "{pace:?}");
        // Work offset and geometry are the part's now: the operator is told.
        (0..4).for_each(|_| host.step());
        let message = host.snapshot().message.text.zh().into_owned();
        assert_eq!(message.contains("已装其工件"), mounted == 1, "{pace:?}: {message}");
    }
}

#[test]
fn b7_the_stepped_host_takes_the_new_tick_time_at_power_on() {
    let mut rig = crate::stories::rig();
    crate::stories::tell(&mut rig, "param P58 4000");
    assert_eq!(rig.tick_time(), Micros(PowerOnState::factory(Kind::Gc).params.get(param::TICK_TIME) as u64));
    crate::stories::tell(&mut rig, "power cut\npower on");
    let before = rig.now();
    rig.step();
    assert_eq!((rig.tick_time(), rig.now().since(before)), (Micros(4_000), Micros(4_000)));
}

/// Another simulated machine comes on the same thread; the screen sees it and commands it.
#[test]
fn t2_another_machine_takes_the_place_of_the_first() {
    let (go, gone) = std::sync::mpsc::channel::<()>();
    let script = move |thread: &mut HostThread<HostedSimulation, DirectStorage>| {
        while gone.try_recv().is_err() {
            thread.turn();
        }
        thread.exchange(crate::stories::ready_of(Kind::Gs));
        run_until_stopped(thread);
    };
    let mut link = start(crate::stories::rig(), script).unwrap();
    wait("the first machine", || link.newest().kind == Kind::Gc && link.newest().now > Micros::ZERO);
    go.send(()).unwrap();
    wait("the second machine", || link.newest().kind == Kind::Gs && link.newest().now > Micros::ZERO);
    assert!(!link.health().failed.load(Ordering::Acquire));
    assert!(link.send(Command::OpenPage(Page::Home)));
    wait("a command", || link.newest().page == Page::Home);
}

#[test]
fn a_story_plays_on_the_thread_until_somebody_touches_the_screen() {
    let (ended, told) = std::sync::mpsc::channel();
    let script = move |thread: &mut HostThread<HostedSimulation, DirectStorage>| {
        let (_, lines) = parse("power on\nload O1002\nwait 600 s\nwait 600 s", Kind::Gc).unwrap();
        let mut player = Player::new(thread, None, std::path::Path::new("."), false);
        for line in &lines {
            if player.stage().is_interrupted() {
                break;
            }
            player.play(line).unwrap();
        }
        let host = player.host();
        ended.send((host.part_changes(), host.now())).unwrap();
    };
    let mut link = start(crate::stories::rig(), script).unwrap();
    wait("the program", || link.newest().program.number == 1_002);
    assert!(link.send(Command::KeepAlive), "no touch");
    let reading = PageCommand::File(Ticket::without_reply(Requester::Editor), FileRequest::ListMedia);
    assert!(link.send(Command::Page(reading)), "a page reads by itself");
    wait("both commands", || link.newest().now > Micros::from_millis(500));
    assert!(told.try_recv().is_err());
    assert!(link.send(Command::Press(kt830::defs::key::Key::Hydraulic)));
    let (parts, now) = told.recv_timeout(DEADLINE).unwrap();
    assert!(parts == 1 && now < Micros::from_millis(60_000), "{parts} parts at {now:?}");
}
