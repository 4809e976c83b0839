//! The network: what MTConnect agents are told, and that nothing which they do reaches the control.
//! Source: docs/manual, chapter "network"; ANSI/MTC1.4.

use std::collections::BTreeSet;
use std::io::{ErrorKind, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::time::{Duration, Instant};

use kt830::defs::alarm;
use kt830::defs::alarm_history::{AlarmEnd, AlarmHistory, PastAlarm};
use kt830::defs::key::{Key, Mode};
use kt830::defs::kind::Kind;
use kt830::defs::param::{self, ParamAddress};
use kt830::defs::part_record::{PartHistory, PartRecord};
use kt830::defs::part_verdict::PartVerdict;
use kt830::defs::text::LocalizedText;
use kt830::gateway::device_model::device_model;
use kt830::gateway::shdr::ShdrLines;
use kt830::gateway::{Gateway, GatewayThread, Painter, timestamp};
use kt830::link::Snapshot;
use kt830::link::condition::Condition;
use kt830::link::data_item::{Component, data_items};
use kt830::link::network::{NetworkView, ServiceState};
use kt830::link::snapshot::{AlarmView, RunState};
use kt830::units::{Axis, Micros};
use proptest::prelude::*;

/// Longest wait for the network of this computer.
const DEADLINE: Duration = Duration::from_secs(20);
const TIME: &str = "2026-11-29T01:02:03.000000Z";

/// A cylindrical grinder with the axes X and Z.
fn machine() -> Snapshot {
    let mut snapshot = Snapshot::new(Kind::Gc);
    for axis in [Axis::X, Axis::Z] {
        (snapshot.axes[axis].present, snapshot.axes[axis].homed) = (true, true);
    }
    snapshot
}

fn set(snapshot: &mut Snapshot, param: &str, value: f64) {
    let address = ParamAddress::parse(param).unwrap();
    std::sync::Arc::make_mut(&mut snapshot.params).write(address, value).unwrap();
}

/// A port that nobody uses now.
fn free_port() -> u16 {
    TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap().local_addr().unwrap().port()
}

fn raised(number: u16) -> AlarmView {
    let row = alarm::find(number);
    let text = row.map_or(LocalizedText::new("程序报警", "program alarm"), |row| LocalizedText::from(row.text));
    let cause = row.map_or_else(LocalizedText::default, |row| LocalizedText::from(row.cause));
    let none = LocalizedText::default();
    AlarmView { number, text, cause, remedy: none, variable: None, since: Micros::ZERO, place: None }
}

/// A gateway with its agents, stepped by the test: 20 ms a step.
struct Shop {
    gateway: Gateway,
    snapshot: Snapshot,
    port: u16,
    now: Duration,
}

impl Shop {
    fn new() -> Self {
        Self::with("P480", None)
    }

    /// A service with the port of a parameter.
    fn with(param: &str, painter: Option<Painter>) -> Self {
        let mut shop = Self { gateway: Gateway::new(painter), snapshot: machine(), port: 0, now: Duration::ZERO };
        for _ in 0..20 {
            shop.port = free_port();
            set(&mut shop.snapshot, param, shop.port.into());
            shop.step();
            let NetworkView { mtconnect, web } = shop.gateway.view();
            if [mtconnect.state, web.state].contains(&ServiceState::Listening) {
                return shop;
            }
        }
        panic!("no port is free");
    }

    fn step(&mut self) {
        self.now += Duration::from_millis(20);
        self.gateway.step(self.now, Duration::from_secs(1_795_000_000), &self.snapshot);
    }

    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect((Ipv4Addr::LOCALHOST, self.port)).unwrap();
        stream.set_nonblocking(true).unwrap();
        stream
    }

    /// Steps until the agent has received something that ends with these words.
    fn until(&mut self, agent: &mut TcpStream, words: &str) -> String {
        let (begun, mut told) = (Instant::now(), String::new());
        while !told.contains(words) {
            assert!(begun.elapsed() < DEADLINE, "{words} is missing: {told}");
            self.step();
            receive(agent, &mut told);
        }
        told
    }

    /// Steps until something is true of the view.
    fn until_view(&mut self, what: &str, seen: impl Fn(&Self) -> bool) {
        let begun = Instant::now();
        while !seen(self) {
            assert!(begun.elapsed() < DEADLINE, "{what}: {:?}", self.gateway.view());
            self.step();
            std::thread::yield_now();
        }
    }
}

/// What has come; the lines of these tests are ASCII.
fn receive(agent: &mut TcpStream, into: &mut String) {
    let mut bytes = [0; 65_536];
    match agent.read(&mut bytes) {
        Ok(count) => into.extend(bytes[..count].iter().map(|byte| char::from(*byte))),
        Err(error) => assert_eq!(error.kind(), ErrorKind::WouldBlock),
    }
}

#[test]
fn off_by_factory_nothing_listens() {
    for kind in Kind::ALL {
        let params = &Snapshot::new(kind).params;
        assert!([param::MTCONNECT_PORT, param::WEB_PORT].iter().all(|port| params.get(*port).abs() < 0.5));
    }
    let mut gateway = Gateway::default();
    gateway.step(Duration::ZERO, Duration::ZERO, &machine());
    let view = gateway.view();
    for service in [view.mtconnect, view.web] {
        assert_eq!((service.state, service.address), (ServiceState::Off, String::new()));
    }
}

#[test]
fn a_port_is_of_this_computer_alone_unless_it_is_opened_to_the_network() {
    let mut shop = Shop::new();
    assert_eq!(shop.gateway.view().mtconnect.address, format!("127.0.0.1:{}", shop.port));
    set(&mut shop.snapshot, "P481", 1.0);
    shop.step();
    assert_eq!(shop.gateway.view().mtconnect.address, format!("0.0.0.0:{}", shop.port));
    set(&mut shop.snapshot, "P480", 0.0);
    shop.step();
    assert_eq!(shop.gateway.view().mtconnect.state, ServiceState::Off);
    assert!(TcpStream::connect((Ipv4Addr::LOCALHOST, shop.port)).is_err(), "still open");
}

#[test]
fn an_agent_is_told_everything_then_what_changes() {
    let mut shop = Shop::new();
    shop.snapshot.mode = Mode::Auto;
    shop.snapshot.axes[Axis::X].work = 39.964;
    shop.snapshot.feed_mm_min = 120.0;
    // Measured values are looked at every 100 ms.
    (0..6).for_each(|_| shop.step());
    let mut agent = shop.connect();
    let told = shop.until(&mut agent, "c_lubrication|NORMAL||||\n");
    for item in data_items(&shop.snapshot) {
        assert!(told.contains(&format!("|{}|", item.id())), "{} is missing: {told}", item.id());
    }
    // 120 mm/min are 2 mm/s.
    for said in ["|mode|AUTOMATIC|", "|x_work|39.964|", "|feed|2|", "|avail|AVAILABLE|", "|execution|READY|"] {
        assert!(told.contains(said), "{said}: {told}");
    }
    shop.snapshot.state = RunState::Held;
    shop.snapshot.axes[Axis::Z].machine = -0.000_04;
    let told = shop.until(&mut agent, "\n");
    assert_eq!(told, format!("{}|execution|FEED_HOLD\n", timestamp(Duration::from_secs(1_795_000_000))));
}

fn value(snapshot: &Snapshot, id: &str) -> String {
    let item = data_items(snapshot).find(|item| item.id() == id).unwrap_or_else(|| panic!("no item {id}"));
    item.value(snapshot).to_string()
}

/// 100 mm of the slide are shown as 200: a machine coordinate is that of the slide, a work coordinate the one displayed.
#[test]
fn a_machine_coordinate_is_no_diameter() {
    let mut snapshot = machine();
    for (is_diameter, shown) in [(true, "100"), (false, "200")] {
        snapshot.x_as_diameter = is_diameter;
        for axis in [Axis::X, Axis::Z] {
            (snapshot.axes[axis].machine, snapshot.axes[axis].work) = (200.0, 200.0);
        }
        let told = ["x_machine", "x_work", "z_machine"].map(|id| value(&snapshot, id));
        assert_eq!(told, [shown, "200", "200"], "{is_diameter}");
    }
    snapshot.axes[Axis::X].homed = false;
    let told = ["x_machine", "x_work", "z_machine"].map(|id| value(&snapshot, id));
    assert_eq!(told, ["UNAVAILABLE", "UNAVAILABLE", "200"], "nobody knows where X stands");
}

/// The guard is told where it has a switch, hydraulics where the machine has them, and no speed as measured that is not.
#[test]
fn what_a_machine_has_not_is_not_told() {
    let has = |snapshot: &Snapshot, id: &str| data_items(snapshot).any(|item| item.id() == id);
    let (mut grinder, lathe) = (machine(), Snapshot { wheel_rpm: 800.0, ..Snapshot::new(Kind::Lathe) });
    grinder.wheel_rpm = 1_500.0;
    assert!(has(&grinder, "hydraulic") && !has(&grinder, "guard") && !has(&lathe, "hydraulic"));
    set(&mut grinder, "P332", 12.0);
    assert_eq!(value(&grinder, "guard"), "OPEN");
    let speeds = |snapshot: &Snapshot| ["spindle_commanded", "spindle_speed"].map(|id| value(snapshot, id));
    assert!(has(&grinder, "spindle_load") && value(&lathe, "spindle_load") == "UNAVAILABLE");
    assert_eq!(speeds(&grinder), ["1500", "UNAVAILABLE"]);
    assert_eq!(speeds(&lathe), ["UNAVAILABLE", "800"]);
}

#[test]
fn words_and_numbers_are_those_of_the_standard() {
    let mut snapshot = machine();
    let states = [
        (RunState::Idle, "READY"),
        (RunState::Running, "ACTIVE"),
        (RunState::Held, "FEED_HOLD"),
        (RunState::Stopped, "PROGRAM_STOPPED"),
        (RunState::Waiting, "WAIT"),
        (RunState::Homing, "ACTIVE"),
        (RunState::Alarm, "STOPPED"),
    ];
    for (state, word) in states {
        snapshot.state = state;
        assert_eq!(value(&snapshot, "execution"), word, "{state:?}");
    }
    snapshot.wheel_rpm = f64::NAN;
    for id in ["spindle_commanded", "spindle_speed", "part_size"] {
        assert_eq!(value(&snapshot, id), "UNAVAILABLE", "{id}");
    }
    assert_eq!(value(&snapshot, "estop"), "ARMED");
    snapshot.keys[Key::EmergencyStop as usize].lamp = true;
    assert_eq!(value(&snapshot, "estop"), "TRIGGERED");
    let part = |count, verdict| PartRecord {
        count,
        number: 3,
        program: 1_002,
        order: 0,
        ended: Default::default(),
        cycle_seconds: 27.02,
        size: Some(39.9985),
        limits: None,
        verdict,
        since_dressing: 1,
    };
    for (verdict, word) in [
        (PartVerdict::Good, "PASS"),
        (PartVerdict::Out { partly: true }, "FAIL"),
        (PartVerdict::NotMeasured, "UNAVAILABLE"),
    ] {
        snapshot.production.parts = PartHistory::new([part(7, PartVerdict::Good), part(8, verdict)], 1);
        assert_eq!(value(&snapshot, "part_status"), word);
        assert_eq!((value(&snapshot, "part_id"), value(&snapshot, "part_size")), ("8".into(), "39.9985".into()));
    }
}

/// Every alarm of the table and a program's own are raised and cleared as a condition; a second one of the same condition
/// stays when the first is over.
#[test]
fn every_alarm_is_a_condition_that_is_raised_and_cleared() {
    let numbers = alarm::ALARMS.iter().map(|row| row.number).chain([1, 65, 67, 500, 599]);
    for number in numbers {
        let (mut lines, mut snapshot) = (ShdrLines::default(), machine());
        let (id, ..) = Condition::of_alarm(number).row();
        let first = lines.changes(TIME, &snapshot, true);
        assert!(first.contains(&format!("{TIME}|{id}|NORMAL||||\n")), "{first}");
        snapshot.alarms.push(raised(number));
        let told = lines.changes(TIME, &snapshot, true);
        let level = if alarm::reaction(number) == alarm::Reaction::Show { "WARNING" } else { "FAULT" };
        assert!(told.contains(&format!("{TIME}|{id}|{level}|{number}|||")), "{number}: {told}");
        assert_eq!(lines.changes(TIME, &snapshot, true), "", "told once");
        let another = if number == 12 { 13 } else { 12 };
        snapshot.alarms.push(raised(another));
        lines.changes(TIME, &snapshot, true);
        snapshot.alarms.retain(|alarm| alarm.number == another);
        let told = lines.changes(TIME, &snapshot, true);
        assert!(told.contains(&format!("{TIME}|{id}|NORMAL|{number}|||\n")), "{number}: {told}");
        let (other, ..) = Condition::of_alarm(another).row();
        let everything = lines.everything(TIME);
        assert!(everything.contains(&format!("|{other}|FAULT|{another}|||")), "{everything}");
        assert!(!everything.contains(&format!("|{number}|||")), "{number}: {everything}");
    }
}

/// An alarm that has come and gone between two looks is raised and cleared, once; old ones of the history are not.
#[test]
fn a_short_alarm_is_told() {
    let (mut lines, mut snapshot) = (ShdrLines::default(), machine());
    let past = |count, number| PastAlarm {
        count,
        number,
        text: LocalizedText::same("short"),
        cause: Default::default(),
        remedy: Default::default(),
        place: None,
        came: Default::default(),
        ended: Some((AlarmEnd::Itself, None)),
    };
    snapshot.alarm_history = AlarmHistory::new([past(1, 180), past(2, 191)], 1);
    assert!(!lines.changes(TIME, &snapshot, true).contains("short"));
    snapshot.alarm_history = AlarmHistory::new([past(1, 180), past(2, 191), past(3, 192)], 2);
    let told = lines.changes(TIME, &snapshot, true);
    assert_eq!(told, format!("{TIME}|c_coolant|FAULT|192|||short\n{TIME}|c_coolant|NORMAL|192|||\n"));
    assert_eq!(lines.changes(TIME, &snapshot, true), "");
}

/// Measured values are looked at ten times a second, states in every look.
#[test]
fn measured_values_do_not_flood_an_agent() {
    let mut shop = Shop::new();
    let mut agent = shop.connect();
    shop.until(&mut agent, "c_lubrication|NORMAL");
    let mut told = String::new();
    for step in 0..50 {
        shop.snapshot.axes[Axis::X].work = f64::from(step % 2) / 10_000.0;
        shop.snapshot.program.line = step + 1;
        shop.step();
    }
    let begun = Instant::now();
    while !told.contains("|line|50\n") {
        assert!(begun.elapsed() < DEADLINE, "{told}");
        shop.step();
        receive(&mut agent, &mut told);
    }
    // 50 steps of 20 ms are a second.
    assert_eq!(told.matches("|line|").count(), 50);
    assert!((1..=11).contains(&told.matches("|x_work|").count()), "{told}");
}

proptest! {
    /// Texts of programs and alarms may be anything.
    #[test]
    fn no_text_breaks_a_line(words in any::<String>(), cause in "[|\r\n\u{0}\"\u{ffff}a-c中-]{0,600}") {
        let (mut lines, mut snapshot) = (ShdrLines::default(), machine());
        let mut bad = raised(500);
        (bad.text, bad.cause) = (LocalizedText::same(&words), LocalizedText::same(&cause));
        snapshot.alarms.push(bad);
        snapshot.waiting_for = Some(LocalizedText::same(&words));
        let told = lines.changes(TIME, &snapshot, true);
        for line in told.lines() {
            prop_assert!(line.starts_with(&format!("{TIME}|")) && line.len() < 8_000, "{line}");
            prop_assert!(!line.contains('"') && !line.contains("--"), "{line}");
            let fields = line.split('|').count();
            let id = line.split('|').nth(1).unwrap_or_default();
            match id {
                "message" => prop_assert_eq!(fields, 4),
                id if id.starts_with("c_") => prop_assert_eq!(fields, 7),
                _ => prop_assert_eq!(fields % 2, 1),
            }
        }
    }
}

#[test]
fn a_ping_is_answered_and_nothing_else_has_an_effect() {
    let mut shop = Shop::new();
    let mut agent = shop.connect();
    shop.until(&mut agent, "c_lubrication|NORMAL");
    agent.write_all(b"* PING\r\n* calibration: x|1\nG00 X0\nPRESS cycle-start\n\xff\xfe\n* PING\n").unwrap();
    let told = shop.until(&mut agent, "* PONG 10000\n* PONG 10000\n");
    assert_eq!(told, "* PONG 10000\n* PONG 10000\n");
    assert_eq!(shop.gateway.view().mtconnect.clients.len(), 1);
    // A line without an end is none of the protocol.
    agent.write_all(&[b'a'; 4_096]).unwrap();
    shop.until_view("the agent is given up", |shop| shop.gateway.view().mtconnect.dropped == 1);
    // So is one that never pings, after a minute.
    let mute = shop.connect();
    shop.until_view("it is taken", |shop| !shop.gateway.view().mtconnect.clients.is_empty());
    let at = shop.now;
    shop.until_view("the mute one is given up", |shop| shop.gateway.view().mtconnect.dropped == 2);
    let waited = shop.now - at;
    assert!((Duration::from_secs(60)..Duration::from_millis(60_100)).contains(&waited), "{waited:?}");
    drop(mute);
}

#[test]
fn an_agent_that_stops_to_ping_is_given_up_after_three_heartbeats() {
    let mut shop = Shop::new();
    let (mut pinging, mut mute) = (shop.connect(), shop.connect());
    pinging.write_all(b"* PING\n").unwrap();
    shop.until(&mut pinging, "PONG");
    shop.until(&mut mute, "c_lubrication|NORMAL");
    let at = shop.now;
    while shop.gateway.view().mtconnect.clients.len() == 2 {
        shop.step();
        assert!(shop.now - at < Duration::from_millis(30_100), "still connected");
    }
    assert!(shop.now - at >= Duration::from_secs(30), "too early: {:?}", shop.now - at);
    // One that has never pinged has a minute.
    let view = shop.gateway.view().mtconnect;
    assert_eq!(view.clients, [mute.local_addr().unwrap().to_string()]);
}

#[test]
fn an_agent_that_does_not_read_is_given_up_and_the_others_go_on() {
    let mut shop = Shop::new();
    let (mut reads, _does_not) = (shop.connect(), shop.connect());
    shop.until(&mut reads, "c_lubrication|NORMAL");
    // Some 4 kB a step: the buffers of the system and of the agent fill.
    let (mut told, mut steps) = (String::new(), 0);
    while shop.gateway.view().mtconnect.dropped == 0 {
        steps += 1;
        shop.snapshot.axes[Axis::X].work = f64::from(steps);
        shop.snapshot.alarms = (500..510).map(raised).collect();
        for alarm in &mut shop.snapshot.alarms {
            alarm.text = LocalizedText::same(&format!("{steps} {}", "x".repeat(390)));
        }
        shop.step();
        told.clear();
        receive(&mut reads, &mut told);
        assert!(steps < 20_000, "never given up");
    }
    shop.snapshot.alarms.clear();
    shop.until(&mut reads, "c_motion|NORMAL|509");
    assert_eq!(shop.gateway.view().mtconnect.clients, [reads.local_addr().unwrap().to_string()]);
}

#[test]
fn a_ninth_agent_is_refused_and_idle_connections_lose_their_places() {
    let mut shop = Shop::new();
    // Connections that say nothing keep nobody out.
    let idle: Vec<TcpStream> = (0..20).map(|_| shop.connect()).collect();
    shop.until_view("twelve have lost their places", |shop| shop.gateway.view().mtconnect.dropped == 12);
    let mut agents: Vec<TcpStream> = (0..8).map(|_| shop.connect()).collect();
    for agent in &mut agents {
        agent.write_all(b"* PING\n").unwrap();
        shop.until(agent, "PONG");
    }
    // Agents that ping keep theirs.
    let late = shop.connect();
    shop.until_view("it is refused", |shop| shop.gateway.view().mtconnect.refused == 1);
    assert_eq!(shop.gateway.view().mtconnect.clients.len(), 8);
    drop((idle, agents, late));
    shop.until_view("all have gone", |shop| shop.gateway.view().mtconnect.clients.is_empty());
    let mut late = shop.connect();
    shop.until(&mut late, "avail|AVAILABLE");
}

#[test]
fn a_port_in_use_is_said_and_tried_again() {
    let taken = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    let (mut snapshot, port) = (machine(), taken.local_addr().unwrap().port());
    set(&mut snapshot, "P480", port.into());
    let mut gateway = Gateway::default();
    let second = Duration::from_secs(1);
    gateway.step(second, Duration::ZERO, &snapshot);
    let view = gateway.view().mtconnect;
    assert!(matches!(&view.state, ServiceState::Failed(why) if why.en().contains("in use")), "{view:?}");
    assert_eq!(view.address, format!(":{port}"));
    drop(taken);
    gateway.step(5 * second, Duration::ZERO, &snapshot);
    assert!(matches!(gateway.view().mtconnect.state, ServiceState::Failed(_)), "not in every step");
    gateway.step(6 * second, Duration::ZERO, &snapshot);
    assert_eq!(gateway.view().mtconnect.state, ServiceState::Listening);
}

/// Elements are closed in the order in which they were opened; every item and condition is there once, under its component.
#[test]
fn the_model_of_each_machine_has_every_item_once() {
    for kind in Kind::ALL {
        let mut snapshot = Snapshot::new(kind);
        snapshot.axes[Axis::X].present = true;
        snapshot.axes[Axis::Y].present = kind == Kind::Gs;
        set(&mut snapshot, "P482", 123.0);
        let model = device_model(&snapshot, TIME);
        assert!(model.contains(&format!("uuid=\"kt830-{}-000123\"", kind.id())), "{model}");
        let mut open = Vec::new();
        for tag in model.split('<').skip(1).filter(|tag| !tag.starts_with('?')) {
            let (tag, _) = tag.split_once('>').unwrap();
            let name = tag.split([' ', '/']).find(|word| !word.is_empty()).unwrap();
            match (tag.starts_with('/'), tag.ends_with('/')) {
                (true, _) => assert_eq!(open.pop(), Some(name), "{tag}"),
                (false, false) => open.push(name),
                (false, true) => {}
            }
        }
        assert!(open.is_empty(), "{open:?}");
        let ids: Vec<String> = data_items(&snapshot).map(|item| item.id()).collect();
        for id in &ids {
            let entry = format!(" id=\"{}000123_{id}\" name=\"{id}\"", kind.id());
            assert_eq!(model.matches(&entry).count(), 1, "{id}");
        }
        // What an agent is told and what its model has are the same.
        let mut lines = ShdrLines::default();
        lines.changes(TIME, &snapshot, true);
        let everything = lines.everything(TIME);
        let of_line = |line: &str| {
            let fields: Vec<String> = line.split('|').skip(1).map(str::to_owned).collect();
            let is_alone = fields[0].starts_with("c_") || fields[0] == "message";
            if is_alone { vec![fields[0].clone()] } else { fields.into_iter().step_by(2).collect() }
        };
        let told: BTreeSet<String> = everything.lines().flat_map(of_line).collect();
        let items = model.split("<DataItem ").skip(1).map(|item| item.split(" name=\"").nth(1).unwrap());
        let named: BTreeSet<String> = items.map(|item| item.split('"').next().unwrap().to_owned()).collect();
        assert_eq!(told, named, "{kind:?}");
        let unique: BTreeSet<&String> = ids.iter().collect();
        assert_eq!(unique.len(), ids.len());
        let has_y = data_items(&snapshot).any(|item| item.component == Component::Axis(Axis::Y));
        assert_eq!(has_y, kind == Kind::Gs);
    }
}

/// A control whose snapshots stop loses its agents, so that they do not take old values for new ones; the page is told who
/// is connected, once a second at most.
#[test]
fn a_control_that_stands_still_loses_its_agents() {
    let (mut snapshot, port) = (machine(), free_port());
    set(&mut snapshot, "P480", port.into());
    let (mut input, output) = triple_buffer::TripleBuffer::new(&snapshot).split();
    let (tell, mut told) = triple_buffer::TripleBuffer::<Option<NetworkView>>::default().split();
    let _gateway = GatewayThread::start(output, None, tell).unwrap();
    let begun = Instant::now();
    let mut publish = |snapshot: &Snapshot| {
        input.input_buffer_mut().clone_from(snapshot);
        input.publish();
    };
    let mut agent = loop {
        assert!(begun.elapsed() < DEADLINE, "never listens");
        publish(&snapshot);
        if let Ok(agent) = TcpStream::connect((Ipv4Addr::LOCALHOST, port)) {
            break agent;
        }
        std::thread::yield_now();
    };
    agent.set_read_timeout(Some(DEADLINE)).unwrap();
    // Nothing is published from here on: everything is told, then the connection ends.
    let mut everything = String::new();
    agent.read_to_string(&mut everything).unwrap();
    assert!(everything.contains("|avail|AVAILABLE"), "{everything}");
    assert!(told.update() && told.output_buffer_mut().is_some(), "the page is told");
}

impl Shop {
    /// A browser asks; the whole answer, with its head.
    fn ask(&mut self, request: &[u8]) -> Vec<u8> {
        let mut browser = self.connect();
        browser.write_all(request).unwrap();
        let (begun, mut answer) = (Instant::now(), Vec::new());
        loop {
            assert!(begun.elapsed() < DEADLINE, "no answer to {}", String::from_utf8_lossy(request));
            self.step();
            match browser.read_to_end(&mut answer) {
                Ok(_) => return answer,
                Err(error) if error.kind() == ErrorKind::WouldBlock => {}
                Err(error) => panic!("{error}"),
            }
        }
    }

    fn get(&mut self, path: &str) -> (String, Vec<u8>) {
        let answer = self.ask(format!("GET {path} HTTP/1.1\r\nHost: localhost:{}\r\n\r\n", self.port).as_bytes());
        let end = answer.windows(4).position(|four| four == b"\r\n\r\n").expect("a head");
        (String::from_utf8(answer[..end].to_vec()).unwrap(), answer[end + 4..].to_vec())
    }
}

#[test]
fn a_browser_sees_the_state_the_alarms_and_the_trend() {
    let mut shop = Shop::with("P483", None);
    shop.snapshot.state = RunState::Alarm;
    shop.snapshot.alarms.push(raised(alarm::HYDRAULIC_PRESSURE));
    shop.snapshot.feed_mm_min = f64::NAN;
    let part = PartRecord {
        count: 41,
        number: 3,
        program: 1_002,
        order: 0,
        ended: Default::default(),
        cycle_seconds: 27.0,
        size: Some(39.9985),
        limits: Some([40.0, 39.995, 40.0]),
        verdict: PartVerdict::Good,
        since_dressing: 1,
    };
    shop.snapshot.production.parts = PartHistory::new([part], 1);
    let (head, body) = shop.get("/state.json");
    assert!(head.starts_with("HTTP/1.1 200 OK\r\n") && head.contains("no-store"), "{head}");
    assert!(head.contains(&format!("Content-Length: {}", body.len())), "{head}");
    let state: serde_json::Value = serde_json::from_slice(&body).unwrap();
    assert_eq!(state["items"]["execution"], "STOPPED");
    assert_eq!(state["items"]["feed"], serde_json::Value::Null);
    assert_eq!(state["alarms"][0]["number"], 180);
    assert_eq!(state["alarms"][0]["text"]["zh"], "砂轮启动时液压异常");
    assert_eq!(state["sizes"][0]["size"], 39.9985);
    let (head, body) = shop.get("/?from=phone");
    assert!(head.contains("text/html; charset=utf-8") && head.contains("default-src 'none'"), "{head}");
    assert!(body.starts_with(b"<!doctype html>"));
}

#[test]
fn a_browser_gets_the_picture_once_it_is_painted_at_most_one_a_second() {
    let (painted, count) = crossbeam_channel::unbounded();
    let painter: Painter = Box::new(move |snapshot| {
        painted.send(snapshot.parts_counted).unwrap();
        assert!(snapshot.network.as_ref().is_some_and(|network| network.web.state == ServiceState::Listening));
        Some(format!("picture {}", snapshot.parts_counted).into_bytes())
    });
    let mut shop = Shop::with("P483", Some(painter));
    (0..100).for_each(|_| shop.step());
    shop.snapshot.parts_counted = 7;
    let (head, _) = shop.get("/screen.png");
    assert!(head.starts_with("HTTP/1.1 503 "), "{head}");
    let begun = Instant::now();
    let body = loop {
        assert!(begun.elapsed() < DEADLINE, "no picture");
        let (head, body) = shop.get("/screen.png");
        if head.contains("image/png") {
            break body;
        }
    };
    // What was painted before anybody had asked would come first.
    assert_eq!((body.as_slice(), count.try_recv()), (b"picture 7".as_slice(), Ok(7)));
    let from = shop.now;
    while count.is_empty() {
        assert!(begun.elapsed() < DEADLINE, "no second picture");
        shop.get("/screen.png");
    }
    while shop.now - from < Duration::from_secs(5) {
        shop.get("/screen.png");
    }
    let pictures = count.try_iter().count() as u64;
    assert!(pictures <= shop.now.as_secs() + 1, "{pictures} in {:?}", shop.now);
    // Nobody looks for a while: the next one who does is not shown an old picture.
    shop.now += Duration::from_secs(60);
    let (head, _) = shop.get("/screen.png");
    assert!(head.starts_with("HTTP/1.1 503 "), "{head}");
}

#[test]
fn a_browser_can_only_look() {
    let mut shop = Shop::with("P483", None);
    let host = "Host: 127.0.0.1\r\n\r\n";
    for (request, status) in [
        (format!("POST /state.json HTTP/1.1\r\n{host}"), "405"),
        (format!("PUT / HTTP/1.1\r\n{host}"), "405"),
        (format!("GET /../retained.redb HTTP/1.1\r\n{host}"), "404"),
        (format!("GET /state.json/ HTTP/1.0\r\n{host}"), "404"),
        ("GET / HTTP/1.1\r\nHost: machine.example\r\n\r\n".to_owned(), "403"),
        ("GET / HTTP/1.1\r\n\r\n".to_owned(), "403"),
        ("* PING\n\r\n\r\n".to_owned(), "400"),
        ("\u{0}\u{1}\r\n\r\n".to_owned(), "400"),
    ] {
        let answer = shop.ask(request.as_bytes());
        assert!(
            answer.starts_with(format!("HTTP/1.1 {status} ").as_bytes()),
            "{request}: {}",
            String::from_utf8_lossy(&answer)
        );
    }
    // However far it is opened, the view stays on this computer.
    set(&mut shop.snapshot, "P481", 1.0);
    shop.step();
    assert_eq!(shop.gateway.view().web.address, format!("127.0.0.1:{}", shop.port));
}

/// A client that sends no more still gets its answer; one that keeps an answered connection open loses it after a second,
/// and is no fault.
#[test]
fn a_half_closed_client_gets_its_answer_and_an_open_one_loses_its_place() {
    let mut shop = Shop::with("P483", None);
    let mut half = shop.connect();
    half.write_all(b"GET /state.json HTTP/1.1\r\nHost: localhost\r\n\r\n").unwrap();
    half.shutdown(std::net::Shutdown::Write).unwrap();
    let (begun, mut answer) = (Instant::now(), Vec::new());
    while half.read_to_end(&mut answer).is_err() {
        assert!(begun.elapsed() < DEADLINE, "no answer");
        shop.step();
    }
    assert!(answer.starts_with(b"HTTP/1.1 200") && answer.ends_with(b"}"));
    let mut open = shop.connect();
    open.write_all(b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n").unwrap();
    shop.until_view("it is taken", |shop| !shop.gateway.view().web.clients.is_empty());
    let from = shop.now;
    shop.until_view("it has gone", |shop| shop.gateway.view().web.clients.is_empty());
    assert!(shop.now - from < Duration::from_secs(2), "{:?}", shop.now - from);
    assert_eq!(shop.gateway.view().web.dropped, 0);
}

#[test]
fn slow_and_endless_requests_are_given_up() {
    let mut shop = Shop::with("P483", None);
    let mut slow = shop.connect();
    slow.write_all(b"GET / HTTP/1.1\r\nHost: local").unwrap();
    let mut endless = shop.connect();
    endless.write_all(&[b"GET /".as_slice(), &[b'a'; 16_384]].concat()).unwrap();
    shop.until_view("the endless one is given up", |shop| shop.gateway.view().web.dropped >= 1);
    let ten = Duration::from_secs(10);
    while shop.gateway.view().web.dropped < 2 {
        shop.step();
        assert!(shop.now < 2 * ten, "still waiting");
    }
    assert!(shop.now > ten, "too early: {:?}", shop.now);
    let dropped = shop.gateway.view().web.dropped;
    let idle: Vec<TcpStream> = (0..40).map(|_| shop.connect()).collect();
    shop.until_view("sixteen have places", |shop| shop.gateway.view().web.dropped == dropped + 24);
    assert!(shop.get("/").0.starts_with("HTTP/1.1 200"), "idle connections keep nobody out");
    drop(idle);
    shop.until_view("all have gone", |shop| shop.gateway.view().web.clients.is_empty());
    assert!(shop.get("/").0.starts_with("HTTP/1.1 200"));
}

/// What the page is told first.
fn first(told: &mut triple_buffer::Output<Option<NetworkView>>) -> NetworkView {
    let begun = Instant::now();
    while !told.update() {
        assert!(begun.elapsed() < DEADLINE, "the page is told nothing");
        std::thread::yield_now();
    }
    told.output_buffer_mut().take().unwrap()
}

/// With both ports off the page is told so: it must not say that there is no network.
#[test]
fn a_gateway_that_is_off_says_so() {
    let (mut input, output) = triple_buffer::TripleBuffer::new(&machine()).split();
    let (tell, mut told) = triple_buffer::TripleBuffer::<Option<NetworkView>>::default().split();
    let gateway = GatewayThread::start(output, None, tell).unwrap();
    input.publish();
    assert_eq!(first(&mut told), NetworkView::default());
    drop(gateway);
}

/// Connections by the thousand, while the gateway ends: it does not wait for the flood.
#[test]
fn a_flood_of_connections_does_not_hold_the_end_up() {
    let (mut snapshot, port) = (machine(), free_port());
    set(&mut snapshot, "P480", port.into());
    let (mut input, output) = triple_buffer::TripleBuffer::new(&snapshot).split();
    let (tell, mut told) = triple_buffer::TripleBuffer::<Option<NetworkView>>::default().split();
    let gateway = GatewayThread::start(output, None, tell).unwrap();
    input.input_buffer_mut().clone_from(&snapshot);
    input.publish();
    let first = first(&mut told);
    assert_eq!(first.mtconnect.state, ServiceState::Listening, "{first:?}");
    let over = std::sync::atomic::AtomicBool::new(false);
    std::thread::scope(|scope| {
        let flood = scope.spawn(|| {
            let mut count = 0_u32;
            while !over.load(std::sync::atomic::Ordering::Relaxed) {
                count += u32::from(TcpStream::connect((Ipv4Addr::LOCALHOST, port)).is_ok());
            }
            count
        });
        let begun = Instant::now();
        while begun.elapsed() < Duration::from_millis(300) {
            std::thread::yield_now();
        }
        drop(gateway);
        over.store(true, std::sync::atomic::Ordering::Relaxed);
        assert!(flood.join().unwrap() > 100, "no flood");
    });
}
