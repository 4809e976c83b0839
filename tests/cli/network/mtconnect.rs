//! What an agent of MTConnect is told, and what it can do.

use std::collections::BTreeSet;
use std::io::Write;
use std::net::TcpStream;
use std::time::{Duration, Instant};

use kt830::defs::alarm;
use kt830::defs::alarm_history::{AlarmEnd, AlarmHistory, PastAlarm};
use kt830::defs::key::{Key, Mode};
use kt830::defs::kind::Kind;
use kt830::defs::part_record::PartHistory;
use kt830::defs::part_verdict::PartVerdict;
use kt830::defs::signal::{Input, Output};
use kt830::defs::text::LocalizedText;
use kt830::gateway::device_model::device_model;
use kt830::gateway::shdr::ShdrLines;
use kt830::gateway::timestamp;
use kt830::host::retained_store::RetainedStore;
use kt830::link::Snapshot;
use kt830::link::condition::Condition;
use kt830::link::data_item::{Component, data_items};
use kt830::link::snapshot::RunState;
use kt830::units::Axis;
use proptest::prelude::*;

use super::{DEADLINE, Shop, TIME, machine, part, raised, receive, set};

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

/// An axis that is taken away: its values are not the last ones for ever.
#[test]
fn what_the_machine_has_no_longer_is_told_so() {
    let mut shop = Shop::new();
    let mut agent = shop.connect();
    shop.until(&mut agent, "|c_motion|NORMAL");
    shop.snapshot.axes[Axis::Z].present = false;
    let told = shop.until(&mut agent, "|z_machine|UNAVAILABLE\n");
    assert!(told.contains("|z_work|UNAVAILABLE\n") && !told.contains("|x_work|"), "{told}");
}

#[test]
fn a_program_that_has_ended_is_told_from_one_that_was_reset() {
    let mut rig = crate::stories::ready_with("G04 P300\nM30");
    let mut after = |lines: &str| {
        crate::stories::tell(&mut rig, lines);
        value(rig.snapshot(), "execution")
    };
    assert_eq!(after("mode auto\nkey cycle-start\nwait until idle max 5 s"), "PROGRAM_COMPLETED");
    assert_eq!(after("key cycle-start\nwait 0.1 s"), "ACTIVE");
    assert_eq!(after("key reset\nwait 0.5 s"), "READY");
    assert_eq!(after("key cycle-start\nwait until idle max 5 s"), "PROGRAM_COMPLETED");
    assert_eq!(after("load O1002"), "READY");
}

/// The model is that of the machine whose data are in the data directory.
#[test]
fn the_device_model_is_of_the_kind_of_the_data() {
    let home = tempfile::tempdir().unwrap();
    std::fs::create_dir(home.path().join("kt830")).unwrap();
    drop(RetainedStore::open(&home.path().join("kt830"), Kind::Gs).unwrap());
    let printed = crate::command::kt830_in(home.path(), home.path(), &["device-model"]);
    let model = String::from_utf8(printed.stdout).unwrap();
    assert!(model.contains("kt830-gs-000000"), "{model}");
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
    assert!(has(&grinder, "gauge_signals") && !has(&lathe, "gauge_signals"));
    let gauges = |snapshot: &Snapshot| ["gauge_radial", "gauge_axial", "gauge_signals"].map(|id| value(snapshot, id));
    assert_eq!(gauges(&grinder), ["INACTIVE", "INACTIVE", "NONE"]);
    grinder.outputs.set(Output::RadialGauge, true);
    grinder.inputs.set(Input::Gauge1, true);
    grinder.inputs.set(Input::Gauge3, true);
    assert_eq!(gauges(&grinder), ["ACTIVE", "INACTIVE", "P1 P3"]);
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
    (snapshot.state, snapshot.program.is_completed) = (RunState::Idle, true);
    assert_eq!(value(&snapshot, "execution"), "PROGRAM_COMPLETED");
    snapshot.wheel_rpm = f64::NAN;
    for id in ["spindle_commanded", "spindle_speed", "part_size"] {
        assert_eq!(value(&snapshot, id), "UNAVAILABLE", "{id}");
    }
    assert_eq!(value(&snapshot, "estop"), "ARMED");
    snapshot.keys[Key::EmergencyStop as usize].lamp = true;
    assert_eq!(value(&snapshot, "estop"), "TRIGGERED");
    for (verdict, word) in [
        (PartVerdict::Good, "PASS"),
        (PartVerdict::Out { partly: true }, "FAIL"),
        (PartVerdict::NotMeasured, "UNAVAILABLE"),
    ] {
        snapshot.production.parts = PartHistory::new([part(7, PartVerdict::Good), part(8, verdict)], 1);
        assert_eq!(value(&snapshot, "part_status"), word);
        assert_eq!((value(&snapshot, "part_id"), value(&snapshot, "part_size")), ("8".into(), "39.9985".into()));
        let limits = ["part_nominal", "part_lower_limit", "part_upper_limit"].map(|id| value(&snapshot, id));
        assert_eq!(limits, ["40", "39.995", "40"]);
        let others = ["part_time", "part_wheel", "part_alarms", "part_order"].map(|id| value(&snapshot, id));
        assert_eq!(others, ["27.02", "598.4", "103", "UNAVAILABLE"]);
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

/// The OPC UA server says how it does; the page shows it as long as it is connected, and nobody else's words.
#[test]
fn the_opc_ua_server_reports_itself_while_it_is_connected() {
    let mut shop = Shop::new();
    let (mut server, mut other) = (shop.connect(), shop.connect());
    let report = |address: &str| {
        format!("* OPCUA {{\"address\":\"{address}\",\"clients\":2,\"untrusted\":1,\"until\":2400000000}}\n")
    };
    other.write_all(report("opc.tcp://before-a-ping/").as_bytes()).unwrap();
    server.write_all(format!("* PING\n{}* OPCUA nonsense\n", report("opc.tcp://grinder:4840/")).as_bytes()).unwrap();
    shop.until_view("a report", |shop| !shop.gateway.view().opcua.address.is_empty());
    let view = shop.gateway.view().opcua;
    assert_eq!((view.address.as_str(), view.clients, view.untrusted), ("opc.tcp://grinder:4840/", 2, 1));
    drop(server);
    shop.until_view("its end", |shop| shop.gateway.view().opcua.address.is_empty());
    drop(other);
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
        let (identity, lines): (Vec<&str>, Vec<&str>) = everything.lines().partition(|line| line.starts_with("* "));
        let uuid = format!("* uuid: kt830-{}-000123", kind.id());
        assert_eq!(identity[..3], [uuid.as_str(), "* manufacturer: KT-830", "* serialNumber: 000123"]);
        let told: BTreeSet<String> = lines.into_iter().flat_map(of_line).collect();
        let items = model.split("<DataItem ").skip(1).map(|item| item.split(" name=\"").nth(1).unwrap());
        let named: BTreeSet<String> = items.map(|item| item.split('"').next().unwrap().to_owned()).collect();
        assert_eq!(told, named, "{kind:?}");
        let unique: BTreeSet<&String> = ids.iter().collect();
        assert_eq!(unique.len(), ids.len());
        let has_y = data_items(&snapshot).any(|item| item.component == Component::Axis(Axis::Y));
        assert_eq!(has_y, kind == Kind::Gs);
    }
}
