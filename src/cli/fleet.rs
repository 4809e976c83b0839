//! `kt830 fleet`: many simulated controls at the pace of the clock, each with its own network client, against one broker: to
//! see whether a shop's broker and its applications cope with them, and that no result is lost. The ports of the machines (MTConnect,
//! browsers) stay closed: a hundred of them in a process would not be those of a hundred computers.
//! Source: docs/manual, chapter "network".

use std::path::Path;
use std::thread;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use crossbeam_channel::{Receiver, bounded};

use super::args::{FleetArgs, SharedArgs};
use super::play::{StoryFile, demo_story, read_story};
use super::{CallError, FAILED, SUCCESS, print_line, setup};
use crate::defs::param::{self, ParamAddress};
use crate::gateway::Gateway;
use crate::host::headless::HeadlessHost;
use crate::host::simulated::HostedSimulation;
use crate::host::storage::DirectStorage;
use crate::link::network::{BrokerState, BrokerView};
use crate::link::production::OrderProposal;
use crate::link::{Command, Snapshot};
use crate::story::{Player, Stage, Statement};

/// Ticks between two looks of the network client.
const TICKS_PER_LOOK: u64 = 20;
/// A machine begins so much after the one before it.
const STAGGER: Duration = Duration::from_millis(50);
/// How long the broker may take at the end to take what still waits.
const LAST_WORDS: Duration = Duration::from_secs(60);

/// What became of a machine.
struct MachineResult {
    parts: u64,
    ticks: u64,
    /// Statements of the story that failed.
    failed: u64,
    broker: BrokerView,
}

/// Runs the machines for the time of the call; ends well if the broker has all that they have told.
///
/// # Errors
/// The call, the story or a folder is wrong.
pub fn fleet(shared: &SharedArgs, call: &FleetArgs) -> Result<u8, CallError> {
    let story = match &call.story {
        Some(path) => read_story(path, shared.kind)?,
        None => demo_story(shared)?,
    };
    let shared = SharedArgs { kind: story.kind, ..shared.clone() };
    let folder = tempfile::tempdir().map_err(CallError::at("temporary folder"))?;
    let mut fleet = Vec::new();
    for number in 1..=call.machines {
        let data = folder.path().join(number.to_string());
        fleet.push((number, prepare(&shared, call, &data, number)?));
    }
    let begun = Instant::now();
    let ends = begun + Duration::from_secs(call.seconds);
    let results: Vec<MachineResult> = thread::scope(|scope| {
        let machines = fleet.into_iter().map(|(number, (mut host, gateway))| {
            let (proposals, orders) = bounded(1);
            let machine = RealTimeMachine {
                snapshot: host.snapshot().clone(),
                gateway: gateway.with_orders(proposals),
                orders,
                host,
                begins: begun + STAGGER * number,
                ends,
                ticks: 0,
            };
            let story = &story;
            scope.spawn(move || machine.work(story))
        });
        let machines: Vec<_> = machines.collect();
        machines.into_iter().filter_map(|machine| machine.join().ok()).collect()
    });
    Ok(report(&results, call))
}

/// Prints the sums; whether every machine has worked and told everything.
fn report(results: &[MachineResult], call: &FleetArgs) -> u8 {
    let sum = |of: fn(&MachineResult) -> u64| results.iter().map(of).sum::<u64>();
    let (waiting, lost) = (sum(|machine| machine.broker.waiting), sum(|machine| machine.broker.lost));
    print_line(format!("machines: {}, {} s", results.len(), call.seconds));
    print_line(format!("ticks: {}", sum(|machine| machine.ticks)));
    print_line(format!("parts: {}", sum(|machine| machine.parts)));
    print_line(format!("messages: {}", sum(|machine| machine.broker.sent)));
    print_line(format!("connections: {}", sum(|machine| machine.broker.connections)));
    print_line(format!("waiting for the broker: {waiting}"));
    print_line(format!("lost: {lost}"));
    let failed = sum(|machine| machine.failed);
    print_line(format!("statements of the story that failed: {failed}"));
    for machine in results.iter().filter(|machine| machine.broker.connections == 0).take(1) {
        let why = match &machine.broker.state {
            BrokerState::Failed(why) => why.en(),
            BrokerState::Off | BrokerState::Connecting | BrokerState::Connected => "no connection".into(),
        };
        warn_line!("kt830: {}: {why}", call.broker);
    }
    let is_complete = results.len() == call.machines as usize
        && results.iter().all(|machine| machine.broker.connections > 0)
        && waiting + lost + failed == 0;
    if is_complete { SUCCESS } else { FAILED }
}

/// A control of this number, and its network client with a data directory of its own.
fn prepare(
    shared: &SharedArgs,
    call: &FleetArgs,
    data: &Path,
    number: u32,
) -> Result<(HeadlessHost, Gateway), CallError> {
    std::fs::create_dir_all(data).map_err(CallError::at(data.display()))?;
    let settings = format!("(broker: {:?}, group: {:?})\n", call.broker, call.group);
    std::fs::write(data.join("mqtt.ron"), settings).map_err(CallError::at(data.display()))?;
    let mut shared = shared.clone();
    for (of, value) in [(param::MACHINE_NUMBER, f64::from(number)), (param::MQTT_ENABLED, 1.0)] {
        shared.params.push((ParamAddress { number: of.number, bit: None }, value));
    }
    shared.seed = shared.seed.wrapping_add(number.into());
    let host = setup::headless_host(&shared)?;
    Ok((host, Gateway::default().with_folder(data.to_path_buf())))
}

/// A control that keeps pace with the clock, and its network client.
struct RealTimeMachine {
    host: HeadlessHost,
    gateway: Gateway,
    /// Orders of the shop.
    orders: Receiver<OrderProposal>,
    snapshot: Snapshot,
    begins: Instant,
    ends: Instant,
    ticks: u64,
}

impl RealTimeMachine {
    /// Plays the story again and again, then waits until the broker has everything.
    fn work(mut self, story: &StoryFile) -> MachineResult {
        let mut failed = 0;
        sleep_until(self.begins);
        while !self.is_interrupted() {
            self.host.power_on();
            let mut player = Player::new(&mut self, None, &story.folder, false);
            // It works; what the story expects may hold for the first round alone.
            for line in story.lines.iter().filter(|line| !matches!(line.statement, Statement::Expect(_))) {
                if player.stage().is_interrupted() {
                    break;
                }
                if let Err(why) = player.play(line)
                    && !player.stage().is_interrupted()
                {
                    failed += 1;
                    warn_line!("FAIL  line {}, {}: {why}", line.number, line.text);
                }
            }
        }
        let last = self.ends + LAST_WORDS;
        while self.gateway.view().mqtt.waiting > 0 && Instant::now() < last {
            self.tick();
        }
        let parts = self.snapshot.production.parts.last().map_or(0, |part| part.count);
        let broker = self.gateway.view().mqtt;
        self.gateway.close(time_of_day());
        MachineResult { parts, ticks: self.ticks, failed, broker }
    }

    fn tick(&mut self) {
        self.host.step();
        self.ticks += 1;
        if self.ticks.is_multiple_of(TICKS_PER_LOOK) {
            sleep_until(self.begins + Duration::from_micros(self.host.tick_time().0 * self.ticks));
            self.host.snapshot_into(&mut self.snapshot);
            self.gateway.step(self.begins.elapsed(), time_of_day(), &self.snapshot);
            if let Ok(proposal) = self.orders.try_recv() {
                self.host.send(Command::ProposeOrder(proposal));
            }
        }
    }
}

impl Stage for RealTimeMachine {
    type Machine = HostedSimulation;
    type Storage = DirectStorage;

    fn host(&mut self) -> &mut HeadlessHost {
        &mut self.host
    }

    fn step(&mut self) {
        if !self.is_interrupted() {
            self.tick();
        }
    }

    fn power_cut(&mut self) {
        self.host.power_cut();
    }

    fn power_on(&mut self) {
        self.host.power_on();
    }

    fn is_interrupted(&self) -> bool {
        Instant::now() >= self.ends
    }
}

fn time_of_day() -> Duration {
    SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default()
}

fn sleep_until(due: Instant) {
    thread::sleep(due.saturating_duration_since(Instant::now()));
}
