//! A control on the rig's bus, on its own thread and at its own pace, played by a scenario.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::sync::mpsc::channel;
use std::time::Duration;

use kt830::controller::PowerOnState;
use kt830::defs::kind::Kind;
use kt830::defs::param::{self, ParamAddress};
use kt830::defs::text::Lang;
use kt830::host::Host;
use kt830::host::field_machine::HostedFieldBus;
use kt830::host::folders::Folders;
use kt830::host::headless::{HeadlessHost, HostSetup};
use kt830::host::job_runner::JobRunner;
use kt830::host::modbus::ModbusLink;
use kt830::host::storage::{RetainedWorker, StorageWorker, ThreadedStorage};
use kt830::host::thread::{HostThread, start};
use kt830::io::ethercat::EtherCat;
use kt830::io::fieldbus::FieldBusMachine;
use kt830::io::fieldbus::description::MachineDescription;
use kt830::io::fieldbus::station::StationLink;
use kt830::io::trace::TraceRow;
use kt830::link::snapshot::Snapshot;
use kt830::story::Stage;
use kt830::story::parse::parse;
use kt830::story::play::{Player, state_report};
use kt830::units::Percentiles;

use crate::course::{Course, Observed};
use crate::plant::PlantLink;

type Thread = HostThread<HostedFieldBus<EtherCat>, ThreadedStorage>;

/// Longest scenario.
const DEADLINE: Duration = Duration::from_secs(900);

/// What a scenario plays with.
pub struct Session<'a> {
    thread: &'a mut Thread,
    /// The mechanics.
    pub plant: PlantLink,
}

/// A scenario.
pub struct Scenario {
    /// Its name.
    pub name: &'static str,
    /// What is changed in the description of the machine.
    pub describe: fn(&mut MachineDescription),
    /// The machine has an axis Y (P6.6).
    pub has_y: bool,
    /// What is played.
    pub play: fn(&mut Session<'_>),
    /// What is looked at after the control has failed by a panic; `None` if it goes on to its end.
    pub after_panic: Option<fn(&mut PlantLink)>,
}

/// The description of the rig's machine, with the interface that the rig names.
fn description() -> MachineDescription {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/rig/machine.ron");
    let text = std::fs::read_to_string(file).expect("machine.ron");
    let mut description = MachineDescription::parse(&text).expect("machine.ron");
    description.ethercat.interface = std::env::var("KT_ETHERCAT_IF").expect("KT_ETHERCAT_IF: run this on the rig");
    description
}

/// Factory values, homing at half the speed, for the rig has 3 mm from its home switches to its limit switches, and no contact
/// monitor, for it has none.
fn retained() -> PowerOnState {
    let mut retained = PowerOnState::factory(Kind::Gc);
    retained.params.write(param::HOME_FAST.address(), 1_500.0).expect("P48");
    let monitor = ParamAddress::parse("P358").expect("a parameter");
    retained.params.write(monitor, 0.0).expect("P358");
    retained
}

fn folders() -> Folders {
    let at = |name: &str| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(name);
    Folders { programs: at("programs"), screens: at("screens"), by_name: false, dialect: Kind::Gc.dialect() }
}

/// The same control on the simulated machine.
pub fn simulated() -> HeadlessHost {
    let setup = HostSetup { kind: Kind::Gc, retained: retained(), store: None, folders: folders(), seed: 1 };
    HeadlessHost::new(setup).expect("simulated machine")
}

/// Opens the bus, starts the control and plays a scenario. A panic of the scenario is its failure.
pub fn run(scenario: &'static Scenario) -> Result<(), String> {
    let mut description = description();
    (scenario.describe)(&mut description);
    let bus = EtherCat::new(&description.ethercat).ok_or("a second bus in this process")?;
    let links = description.stations.iter().map(|station| {
        let link = ModbusLink::start(station.clone()).expect("thread of a station");
        Box::new(link) as Box<dyn StationLink>
    });
    let links = links.collect();
    let machine = HostedFieldBus::new(FieldBusMachine::new(description, bus, links));
    let worker = StorageWorker::new(JobRunner::new(folders()));
    let storage = ThreadedStorage::start(RetainedWorker::new(None), worker).map_err(|error| error.to_string())?;
    let mut retained = retained();
    let fitted = ParamAddress::parse("P6.6").expect("a parameter");
    retained.params.write(fitted, f64::from(u8::from(scenario.has_y))).expect("P6.6");
    let host = Host::connect(Kind::Gc, retained, machine, storage);
    let (told, answer) = channel();
    let mut link = start(host, move |thread| {
        let played = catch_unwind(AssertUnwindSafe(|| {
            let mut session = Session { thread, plant: PlantLink::connect() };
            session.turns(20); // programs and pages arrive
            (scenario.play)(&mut session);
        }));
        drop(told.send(played.map_err(|panic| words(&*panic))));
        if scenario.after_panic.is_some() {
            resume_unwind(Box::new("planted"));
        }
    })
    .map_err(|error| error.to_string())?;
    let played = answer.recv_timeout(DEADLINE).map_err(|_| "the scenario does not end".to_owned())?;
    if let Some(look) = scenario.after_panic {
        let mut plant = PlantLink::connect();
        std::thread::sleep(Duration::from_secs(2));
        catch_unwind(AssertUnwindSafe(|| look(&mut plant))).map_err(|panic| words(&*panic))?;
    }
    let health = link.health();
    let (ticks, late) = (health.ticks.load(Ordering::Relaxed), health.late.load(Ordering::Relaxed));
    println!("  {ticks} ticks, {late} late");
    if let Some(bus) = link.newest().bus.as_deref().filter(|bus| bus.cycles > 0) {
        let us = |times: Percentiles| format!("{}/{}/{}", times.median.0, times.p99.0, times.max.0);
        let (trip, wake) = (us(bus.round_trip.percentiles), us(bus.wake_up.percentiles));
        println!("  rights of the thread: {:?}", bus.rights);
        println!(
            "  median/99 %/max: round trip {trip} µs, wake-up {wake} µs; {} of {} frames lost",
            bus.lost, bus.cycles
        );
    }
    if let Some(clock) = link.newest().bus.as_deref().and_then(|bus| bus.clock) {
        let Percentiles { median, p99, max } = clock.distance.percentiles;
        println!("  off the clock {}/{}/{} µs, drift {:.1} ppm", median.0, p99.0, max.0, clock.drift_ppm);
    }
    drop(link);
    played
}

fn words(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().cloned();
    text.or_else(|| panic.downcast_ref::<&str>().map(|text| (*text).to_owned())).unwrap_or_default()
}

/// Plays the lines of a story; the first one that fails ends the scenario.
pub fn tell<G: Stage>(stage: &mut G, text: &str) {
    let (_, lines) = parse(text, Kind::Gc).unwrap_or_else(|error| panic!("{error} in\n{text}"));
    let mut player = Player::new(stage, None, Path::new(env!("CARGO_MANIFEST_DIR")), true);
    for line in &lines {
        if let Err(why) = player.play(line) {
            panic!("{}: {why}\n{}", line.text, state_report(player.host(), Lang::En));
        }
    }
}

/// A part of a story that both machines are told.
pub enum StoryPart {
    /// Lines for the operator.
    Tell(&'static str),
    /// The emergency stop of the machine is pressed, or released.
    EmergencyStop(bool),
}

/// Plays acts on a stage whose emergency stop is pressed and released by `stop`; returns what an operator has seen.
pub fn observe<G: Stage>(stage: &mut G, acts: &[StoryPart], mut stop: impl FnMut(&mut G, bool)) -> Course {
    let mut observed = Observed { stage, course: Course::default() };
    for act in acts {
        match act {
            StoryPart::Tell(text) => tell(&mut observed, text),
            StoryPart::EmergencyStop(pressed) => {
                stop(observed.stage, *pressed);
                tell(&mut observed, "wait 0.5 s");
            }
        }
        observed.end_part();
    }
    observed.course
}

impl Session<'_> {
    /// Plays the lines of a story.
    pub fn story(&mut self, text: &str) {
        tell(self.thread, text);
    }

    /// Plays the acts of a story; returns what an operator has seen.
    pub fn observe(&mut self, acts: &[StoryPart]) -> Course {
        let Self { thread, plant } = self;
        observe(&mut **thread, acts, |_, pressed| {
            plant.send(if pressed { "estop press" } else { "estop release" });
        })
    }

    /// Lets a number of ticks pass.
    pub fn turns(&mut self, ticks: u32) {
        (0..ticks).for_each(|_| self.thread.turn());
    }

    /// One tick; its inputs and outputs.
    pub fn turn(&mut self) -> TraceRow {
        self.thread.turn();
        self.thread.host().trace_row()
    }

    /// Ticks until something is seen in the inputs and outputs; the scenario fails after `most` ticks.
    pub fn ticks_until(&mut self, what: &str, most: u32, seen: impl Fn(&TraceRow) -> bool) -> u32 {
        for ticks in 1..=most {
            if seen(&self.turn()) {
                return ticks;
            }
        }
        panic!("{what}: not within {most} ticks\n{}", state_report(self.thread.host(), Lang::En));
    }

    /// Ticks until an alarm is active; its number must be this one and its text contain these words.
    pub fn alarm(&mut self, number: u16, words: &str) -> u32 {
        for ticks in 1..=2_000 {
            self.thread.turn();
            if let Some(first) = self.snapshot().alarms.first().map(|alarm| alarm.number) {
                assert_eq!(first, number, "{:?}", self.alarms());
                // A code that is read by mailbox comes when the drives are off.
                for _ in 0..1_000 {
                    if self.alarms().iter().any(|text| text.contains(words)) {
                        println!("  {} after {ticks} ticks", self.alarms().join("; "));
                        return ticks;
                    }
                    self.thread.turn();
                }
                panic!("{words}: {:?}", self.alarms());
            }
        }
        panic!("alarm {number} does not come\n{}", state_report(self.thread.host(), Lang::En));
    }

    /// What the screen would show.
    pub fn snapshot(&mut self) -> &Snapshot {
        self.thread.host().snapshot()
    }

    /// The texts of the active alarms, in English.
    pub fn alarms(&mut self) -> Vec<String> {
        self.snapshot().alarms.iter().map(|alarm| format!("{} {}", alarm.number, alarm.text.en())).collect()
    }
}
