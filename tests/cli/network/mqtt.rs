//! What a broker is told, what is kept for it while it is away, and what a bad one can do.
//! Source: Eclipse Sparkplug 3.0.0, OASIS MQTT 3.1.1.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use kt830::defs::alarm_history::{AlarmEnd, AlarmHistory, PastAlarm};
use kt830::defs::date::DateTime;
use kt830::defs::key::Mode;
use kt830::defs::kind::Kind;
use kt830::defs::part_record::{PartHistory, PartRecord};
use kt830::defs::part_verdict::PartVerdict;
use kt830::defs::text::LocalizedText;
use kt830::defs::{alarm, param};
use kt830::gateway::Gateway;
use kt830::link::Snapshot;
use kt830::link::condition::Condition;
use kt830::link::data_item::{Category, data_items};
use kt830::link::network::{BrokerState, BrokerView};
use kt830::link::snapshot::RunState;
use kt830::units::Axis;
use srad_types::payload::metric::Value;
use srad_types::payload::{Message, Metric, Payload};

use super::test_broker::{Manners, Sent, TestBroker};
use super::{DEADLINE, machine, part, raised, set};

pub const NODE: &str = "kt830-gc-000123";

/// A control and its broker, stepped by the test: 20 ms a step.
pub struct Site {
    pub gateway: Gateway,
    pub broker: TestBroker,
    pub snapshot: Snapshot,
    pub folder: tempfile::TempDir,
    now: Duration,
}

impl Site {
    pub fn new() -> Self {
        Self::with(TestBroker::new(), "")
    }

    /// `more` are further settings.
    pub fn with(broker: TestBroker, more: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let site = Self::without_settings(broker, folder);
        site.write_settings(&format!("(broker: \"localhost:{}\", group: \"hall 2\", {more})", site.broker.port()));
        site
    }

    fn without_settings(broker: TestBroker, folder: tempfile::TempDir) -> Self {
        let gateway = Gateway::default().with_folder(folder.path().to_path_buf());
        let mut snapshot = machine();
        set(&mut snapshot, "P482", 123.0);
        set(&mut snapshot, "P484", 1.0);
        Self { gateway, broker, snapshot, folder, now: Duration::ZERO }
    }

    fn write_settings(&self, text: &str) {
        std::fs::write(self.folder.path().join("mqtt.ron"), text).unwrap();
    }

    pub fn step(&mut self) {
        self.now += Duration::from_millis(20);
        self.gateway.step(self.now, Duration::from_secs(1_795_000_000) + self.now, &self.snapshot);
        self.broker.step();
    }

    pub fn steps(&mut self, count: usize) {
        for _ in 0..count {
            self.step();
            std::thread::yield_now();
        }
    }

    pub fn view(&self) -> BrokerView {
        self.gateway.view().mqtt
    }

    /// Steps until something is true.
    pub fn until(&mut self, what: &str, seen: impl Fn(&Self) -> bool) {
        let begun = Instant::now();
        while !seen(self) {
            assert!(begun.elapsed() < DEADLINE, "{what}: {:?} {:?}", self.view(), self.topics());
            self.step();
            std::thread::yield_now();
        }
    }

    pub fn until_born(&mut self) {
        let births = self.births().len();
        self.until("a birth", |site| site.births().len() > births);
    }

    pub fn topics(&self) -> Vec<&str> {
        self.broker.sent.iter().map(|sent| sent.topic.as_str()).collect()
    }

    fn of(&self, kind: &str) -> Vec<Payload> {
        let topic = format!("spBv1.0/hall 2/{kind}/{NODE}");
        self.broker.sent.iter().filter(|sent| sent.topic == topic).map(Sent::sparkplug).collect()
    }

    fn births(&self) -> Vec<Payload> {
        self.of("NBIRTH")
    }

    /// Metrics of the data since the last birth, with their names.
    fn data(&self) -> Vec<(String, Metric)> {
        let births = self.births();
        let names: BTreeMap<u64, &str> = births
            .last()
            .unwrap()
            .metrics
            .iter()
            .filter_map(|told| Some((told.alias?, told.name.as_deref()?)))
            .collect();
        let begin = self.broker.sent.iter().rposition(|sent| sent.topic.contains("NBIRTH")).unwrap();
        let data = self.broker.sent[begin..].iter().filter(|sent| sent.topic.contains("NDATA"));
        let metrics = data.flat_map(|sent| sent.sparkplug().metrics);
        metrics.map(|told| (names[&told.alias.unwrap()].to_owned(), told)).collect()
    }

    fn results(&self) -> Vec<serde_json::Value> {
        let topic = format!("kt830/hall 2/{NODE}/part");
        let parts = self.broker.sent.iter().filter(|sent| sent.topic == topic);
        parts.map(|sent| serde_json::from_slice(&sent.payload).unwrap()).collect()
    }

    fn finish_part(&mut self, count: u64) {
        let known = &self.snapshot.production.parts;
        let mut parts = PartHistory::new(known.iter().copied(), known.version());
        parts.push(part(count, PartVerdict::Good));
        self.snapshot.production.parts = parts;
    }
}

fn value<'a>(payload: &'a Payload, name: &str) -> &'a Metric {
    payload.metrics.iter().find(|told| told.name.as_deref() == Some(name)).unwrap_or_else(|| panic!("{name}"))
}

fn text(words: &str) -> Option<Value> {
    Some(Value::StringValue(words.to_owned()))
}

fn certificates() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cli/network/certificates")
}

fn failure(site: &Site) -> String {
    match site.view().state {
        BrokerState::Failed(why) => why.en().into_owned(),
        _ => String::new(),
    }
}

#[test]
fn off_by_factory_no_broker_is_looked_for() {
    for kind in Kind::ALL {
        assert!(Snapshot::new(kind).params.get(param::MQTT_ENABLED) < 0.5);
    }
    let mut site = Site::new();
    set(&mut site.snapshot, "P484", 0.0);
    site.steps(200);
    assert!(!site.broker.has_client());
    assert_eq!(site.view(), BrokerView::default());
}

/// A simulation without a data directory has no settings of a broker.
#[test]
fn without_a_data_directory_no_broker_is_looked_for() {
    let mut site = Site::new();
    site.gateway = Gateway::default();
    site.steps(50);
    assert!(!site.broker.has_client() && failure(&site).contains("no data directory"), "{:?}", site.view());
}

/// Machines of the factory's number 0 would be one for the broker.
#[test]
fn a_machine_without_a_number_is_not_told_to_the_broker() {
    let mut site = Site::new();
    set(&mut site.snapshot, "P482", 0.0);
    site.steps(200);
    assert!(!site.broker.has_client() && failure(&site).contains("P482 is 0"), "{:?}", site.view());
    set(&mut site.snapshot, "P482", 123.0);
    site.until_born();
    set(&mut site.snapshot, "P482", 0.0);
    site.until("the end", |site| failure(site).contains("P482 is 0"));
}

/// A broker ends the connection of a client when another one of the same name comes: the page says what it may be.
#[test]
fn a_second_control_of_the_same_number_is_said_on_the_page() {
    let mut site = Site::new();
    site.until_born();
    for _ in 0..3 {
        site.broker.drop_client();
        site.until("the loss", |site| failure(site).contains("another control with the same P482?"));
        site.until_born();
    }
}

#[test]
fn a_birth_has_every_metric_and_data_follow_by_exception() {
    let mut site = Site::new();
    site.until_born();
    let births = site.births();
    let birth = &births[0];
    assert_eq!(birth.seq, Some(0));
    for item in data_items(&site.snapshot) {
        let told = value(birth, &item.id());
        assert_eq!(told.is_null.is_some(), told.value.is_none(), "{told:?}");
        if let Category::Sample(unit) = item.category {
            let property = told.properties.as_ref().unwrap();
            assert!(property.keys == ["engUnit"] && format!("{property:?}").contains(unit), "{property:?}");
        }
    }
    for condition in Condition::of_machine(&site.snapshot) {
        assert_eq!(value(birth, condition.row().0).value, text("NORMAL"));
    }
    assert!(site.broker.has_subscription, "commands are asked for");
    site.steps(100);
    assert_eq!(site.data().len(), 0, "nothing has changed: {:?}", site.data());
    site.snapshot.state = RunState::Running;
    site.snapshot.mode = Mode::Auto;
    site.snapshot.axes[Axis::X].work = 39.964_04;
    site.until("the data", |site| site.data().len() >= 3);
    let told: BTreeMap<String, Option<Value>> =
        site.data().into_iter().map(|(name, told)| (name, told.value)).collect();
    assert_eq!(told["execution"], text("ACTIVE"));
    // Rounded to 0.1 µm.
    assert_eq!(told["x_work"], Some(Value::DoubleValue(39.964)));
    let sequences: Vec<u64> = site.of("NDATA").iter().map(|data| data.seq.unwrap()).collect();
    let expected: Vec<u64> = (1..=sequences.len() as u64).collect();
    assert_eq!(sequences, expected, "no message is missing");
}

#[test]
fn every_metric_of_every_kind_has_a_value_of_its_type() {
    use srad_types::payload::DataType;
    for kind in Kind::ALL {
        let mut site = Site::new();
        site.snapshot = Snapshot::new(kind);
        Axis::ALL.into_iter().for_each(|axis| site.snapshot.axes[axis].present = true);
        site.snapshot.axes.0.iter_mut().for_each(|axis| axis.homed = true);
        set(&mut site.snapshot, "P482", 123.0);
        set(&mut site.snapshot, "P484", 1.0);
        site.snapshot.alarms = vec![raised(alarm::HYDRAULIC_PRESSURE)];
        site.finish_part(1);
        let node = format!("kt830-{}-000123", kind.id());
        let has_birth =
            |site: &Site| site.topics().iter().any(|topic| topic.contains("NBIRTH") && topic.ends_with(&node));
        site.until("a birth", has_birth);
        let birth = site.broker.sent.iter().find(|sent| sent.topic.contains("NBIRTH")).unwrap().sparkplug();
        for told in birth.metrics {
            let Some(value) = &told.value else { continue };
            let is_of_type = match DataType::try_from(told.datatype.unwrap() as i32).unwrap() {
                DataType::Double => matches!(value, Value::DoubleValue(_)),
                DataType::String => matches!(value, Value::StringValue(_)),
                DataType::UInt64 | DataType::Int64 => matches!(value, Value::LongValue(_)),
                DataType::Boolean => matches!(value, Value::BooleanValue(_)),
                other => panic!("{other:?}"),
            };
            assert!(is_of_type, "{told:?}");
        }
    }
}

#[test]
fn an_alarm_is_told_with_its_number_and_its_end() {
    let mut site = Site::new();
    site.until_born();
    site.snapshot.alarms = vec![raised(alarm::HYDRAULIC_PRESSURE)];
    site.until("the alarm", |site| site.data().len() >= 3);
    site.snapshot.alarms.clear();
    site.until("its end", |site| site.data().len() >= 6);
    let told = site.data();
    let of = |name: &str| -> Vec<Option<Value>> {
        told.iter().filter(|(other, _)| other == name).map(|(_, told)| told.value.clone()).collect()
    };
    assert_eq!(of("c_hydraulic"), [text("FAULT"), text("NORMAL")]);
    assert_eq!(of("c_hydraulic_number"), [180, 0].map(|number| Some(Value::LongValue(number))));
    assert_eq!(of("c_hydraulic_text").len(), 2);
}

#[test]
fn a_birth_is_told_again_to_who_asks_and_nothing_else_is_a_command() {
    let mut site = Site::new();
    site.until_born();
    let command = |name: &str, value: Value| {
        let mut metric = Metric::new();
        metric.set_name(name.to_owned()).set_value(value);
        Payload { timestamp: Some(1), metrics: vec![metric], seq: None, uuid: None, body: None }.encode_to_vec()
    };
    let topic = format!("spBv1.0/hall 2/NCMD/{NODE}");
    let others = [
        command("feed_override", Value::DoubleValue(0.0)),
        command("Node Control/Rebirth", Value::BooleanValue(false)),
        vec![0xff; 500],
        Vec::new(),
    ];
    for payload in others {
        site.broker.publish(&topic, payload);
    }
    site.broker.publish("another topic", command("Node Control/Rebirth", Value::BooleanValue(true)));
    site.steps(100);
    assert_eq!((site.births().len(), site.view().state), (1, BrokerState::Connected));
    // However often somebody asks, once a second.
    for _ in 0..50 {
        site.broker.publish(&topic, command("Node Control/Rebirth", Value::BooleanValue(true)));
        site.step();
    }
    site.until("the birth", |site| site.births().len() > 1);
    assert!(site.births().len() <= 3, "{}", site.births().len());
    assert_eq!(site.births()[1].seq, Some(0));
    assert_eq!(value(&site.births()[0], "bdSeq").value, value(&site.births()[1], "bdSeq").value, "the same connection");
}

#[test]
fn what_happens_while_the_broker_is_away_is_told_when_it_is_back() {
    let mut site = Site::new();
    site.until_born();
    // The ping proves that nothing before it is missing.
    site.steps(600);
    site.broker.drop_client();
    site.until("the loss", |site| failure(site).contains("closed by the broker"));
    for state in [RunState::Running, RunState::Held, RunState::Running, RunState::Idle] {
        site.snapshot.state = state;
        site.snapshot.axes[Axis::X].work += 1.0;
        site.step();
    }
    site.until_born();
    site.until("the history", |site| site.data().len() >= 4);
    site.steps(100);
    let history = site.data();
    let told: Vec<_> = history.iter().filter(|(_, told)| told.is_historical == Some(true)).collect();
    let values: Vec<Option<Value>> = told.iter().map(|(_, told)| told.value.clone()).collect();
    assert_eq!(values, ["ACTIVE", "FEED_HOLD", "ACTIVE", "READY"].map(text), "in their order, each once");
    let times: Vec<u64> = told.iter().map(|(_, told)| told.timestamp.unwrap()).collect();
    assert!(times.windows(2).all(|pair| pair[1] == pair[0] + 20), "when it was: {times:?}");
    let sessions: Vec<_> = site.births().iter().map(|birth| value(birth, "bdSeq").value.clone().unwrap()).collect();
    assert_eq!(sessions, [Value::LongValue(0), Value::LongValue(1)]);
    let wills: Vec<_> = site.broker.wills.iter().map(|will| value(&will.sparkplug(), "bdSeq").value.clone()).collect();
    assert_eq!(wills, [Some(Value::LongValue(0)), Some(Value::LongValue(1))]);
    assert!(site.broker.wills.iter().all(|will| will.topic == format!("spBv1.0/hall 2/NDEATH/{NODE}")));
    assert_eq!((site.view().waiting, site.view().connections), (0, 2));
}

#[test]
fn what_the_broker_may_not_have_is_told_again() {
    let mut site = Site::new();
    site.until_born();
    site.steps(600);
    site.snapshot.state = RunState::Running;
    site.until("the change", |site| !site.data().is_empty());
    // No ping since: the broker may have lost it.
    site.broker.drop_client();
    site.until_born();
    site.until("the change again", |site| !site.data().is_empty());
    let (name, told) = site.data().remove(0);
    assert_eq!((name.as_str(), told.value, told.is_historical), ("execution", text("ACTIVE"), Some(true)));
}

#[test]
fn every_result_reaches_the_broker_over_losses_of_connection_and_power() {
    let mut site = Site::new();
    site.finish_part(1);
    site.until("the first", |site| site.results().len() == 1);
    let first = &site.results()[0];
    assert_eq!((&first["part"], &first["verdict"], &first["size_mm"]), (&1.into(), &"ok".into(), &39.9985.into()));
    assert_eq!((&first["machine"], &first["program"], &first["min_mm"]), (&NODE.into(), &1_002.into(), &39.995.into()));
    assert_eq!(
        (&first["wheel_mm"], &first["cycle_s"], &first["alarms"]),
        (&598.4.into(), &27.02.into(), &"103".into())
    );
    assert_eq!((&first["since_dressing"], &first["order"]), (&1.into(), &serde_json::Value::Null));
    site.steps(20);
    // Not acknowledged: sent again with the next connection.
    site.broker.manners = Manners::Forgetful;
    site.finish_part(2);
    site.until("the second", |site| site.results().len() == 2);
    assert_eq!(site.view().waiting, 1);
    site.broker.drop_client();
    site.until("the loss", |site| site.view().state != BrokerState::Connected);
    (3..=40).for_each(|count| site.finish_part(count));
    site.broker.manners = Manners::Good;
    site.until("all others", |site| site.view().state == BrokerState::Connected && site.view().waiting == 0);
    let parts =
        |site: &Site| -> Vec<u64> { site.results().iter().map(|told| told["part"].as_u64().unwrap()).collect() };
    let all: Vec<u64> = [1, 2].into_iter().chain(2..=40).collect();
    assert_eq!(parts(&site), all, "the unacknowledged one twice, the others once, in their order");
    // A size that is typed later is another result of the same part.
    site.snapshot.production.parts.entries_mut().last_mut().unwrap().verdict = PartVerdict::Out { partly: false };
    site.until("the new verdict", |site| parts(site).len() == all.len() + 1);
    assert_eq!((&site.results()[41]["part"], &site.results()[41]["is_bad"]), (&40.into(), &true.into()));
    // Until the file is written.
    site.steps(100);
    site.gateway = Gateway::default().with_folder(site.folder.path().to_path_buf());
    site.broker.sent.clear();
    site.until_born();
    site.steps(100);
    assert_eq!(parts(&site), [0; 0], "after the next power-on nothing is repeated");
    site.finish_part(41);
    site.until("the next", |site| parts(site) == [41]);
    // Data that were set up anew count from 1 again.
    let other = PartRecord { program: 1_003, ..part(1, PartVerdict::Good) };
    site.snapshot.production.parts = PartHistory::new([other], 90);
    site.until("the first of the new data", |site| parts(site) == [41, 1]);
}

#[test]
fn a_bad_broker_is_said_and_left_alone_for_longer_and_longer() {
    for (manners, said) in [
        (Manners::Refusing, "refuses user or password"),
        (Manners::Silent, "does not answer"),
        (Manners::Garbage, "MQTT"),
        (Manners::EarlyPong, "breaks the protocol"),
        (Manners::Twice, "breaks the protocol"),
    ] {
        let mut site = Site::new();
        site.broker.manners = manners;
        site.until(said, |site| failure(site).contains(said));
        let taken = site.broker.taken;
        site.steps(3_000);
        // After 1, 2, 4, 8, 16 and 30 s, and 0.23 s each for the number of the machine.
        let more = site.broker.taken - taken;
        assert!((2..=6).contains(&more), "{said}: {more} tries in a minute");
    }
}

#[test]
fn a_half_open_connection_and_a_broker_that_does_not_read_are_given_up() {
    let mut site = Site::new();
    site.until_born();
    site.broker.manners = Manners::Silent;
    // A ping after 10 s and 10 s for its answer.
    let begun = site.now;
    site.until("no answer", |site| failure(site).contains("does not answer"));
    assert!(site.now - begun <= Duration::from_secs(21), "{:?}", site.now - begun);

    let mut site = Site::new();
    site.until_born();
    site.broker.manners = Manners::Deaf;
    // Sixteen results of the window, and texts of 400 characters: more than the buffers of the system and 1 MB in 10 s.
    let begun = site.now;
    let mut round = 0;
    while failure(&site).is_empty() {
        assert!(site.now - begun < Duration::from_secs(10), "{:?}", site.view());
        round += 1;
        let text = |number: u16| LocalizedText::same(&format!("{round} {number} {}", "x".repeat(390)));
        let numbers = [alarm::HYDRAULIC_PRESSURE, alarm::COOLANT_FLOW, alarm::LUBRICATION_LEVEL, alarm::BUS_LOST];
        site.snapshot.alarms = numbers.map(raised).to_vec();
        site.snapshot.alarms.iter_mut().for_each(|alarm| alarm.text = text(alarm.number));
        // The time of the machine stands nearly still: no ping decides here.
        site.gateway.step(site.now, Duration::from_secs(1_795_000_000), &site.snapshot);
        site.now += Duration::from_micros(100);
    }
    assert!(failure(&site).contains("too slow"), "{}", failure(&site));
}

#[test]
fn no_broker_and_bad_settings_are_said_with_their_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let mut site = Site::without_settings(TestBroker::new(), folder);
    for (settings, said) in [
        (None, "no mqtt.ron in the data directory"),
        (Some("(broker: \"\")"), "broker is a name"),
        (Some("(broker: \"a b\")"), "broker is a name"),
        (Some("(broker: \"broker:99999\")"), "broker is a name"),
        (Some("(broker: \"broker\", group: \"a/b\")"), "group is empty or has"),
        (Some("(broker: \"broker\", password: \"x\")"), "a password without a user"),
        (Some("(broker: \"broker\",\n gruop: \"x\")"), "line 2"),
        (Some("(broker: \"localhost:9\", tls: Some((ca: \"ca.pem\")))"), "ca.pem: "),
        (Some("(broker: \"localhost:9\")"), "no broker there"),
    ] {
        if let Some(settings) = settings {
            site.write_settings(settings);
        }
        site.until(said, |site| failure(site).contains(said));
    }
    assert_eq!(site.view().address, "localhost:9", "where it is not");
    // And once they are right it connects.
    site.write_settings(&format!("(broker: \"127.0.0.1:{}\", group: \"hall 2\")", site.broker.port()));
    site.until_born();
}

#[test]
fn an_encrypted_connection_needs_a_broker_that_proves_itself() {
    let tls = |ca: &str| format!("user: \"grinder\", password: \"secret\", tls: Some((ca: \"{ca}\")),");
    let mut site = Site::with(TestBroker::encrypted(&certificates()), &tls("ca.pem"));
    site.until("a missing file", |site| failure(site).contains("ca.pem"));
    for name in ["ca.pem", "other_ca.pem"] {
        std::fs::copy(certificates().join(name), site.folder.path().join(name)).unwrap();
    }
    site.until_born();
    assert!(site.view().tls.unwrap().valid_until.unwrap() > DateTime(1_795_000_000), "{:?}", site.view());
    assert_eq!(site.broker.user, Some(("grinder".to_owned(), "secret".to_owned())));
    site.steps(600);
    assert_eq!(site.view().state, BrokerState::Connected, "pings go through it");

    let mut site = Site::with(TestBroker::encrypted(&certificates()), &tls("other_ca.pem"));
    std::fs::copy(certificates().join("other_ca.pem"), site.folder.path().join("other_ca.pem")).unwrap();
    site.until("a stranger", |site| failure(site).contains("not accepted"));
    assert_eq!(site.broker.user, None, "the password is not told to it");

    // Without TLS at its port.
    let mut site = Site::with(TestBroker::encrypted(&certificates()), "");
    site.until("no answer", |site| !failure(site).is_empty());
    assert!(!failure(&site).contains("P482"), "{}", failure(&site));
}

/// An authority and a broker's certificate that is valid from the begin of one year to the begin of another.
fn certificates_of(from: i32, until: i32) -> tempfile::TempDir {
    let (folder, [authority_key, key]) =
        (tempfile::tempdir().unwrap(), [(); 2].map(|()| rcgen::KeyPair::generate().unwrap()));
    let mut authority = rcgen::CertificateParams::new(Vec::new()).unwrap();
    authority.is_ca = rcgen::IsCa::Ca(rcgen::BasicConstraints::Unconstrained);
    let mut params = rcgen::CertificateParams::new(vec!["127.0.0.1".to_owned(), "localhost".to_owned()]).unwrap();
    (params.not_before, params.not_after) = (rcgen::date_time_ymd(from, 1, 1), rcgen::date_time_ymd(until, 1, 1));
    let own = authority.self_signed(&authority_key).unwrap();
    let broker = params.signed_by(&key, &rcgen::Issuer::new(authority, authority_key)).unwrap();
    let files = [("ca.pem", own.pem()), ("broker.pem", broker.pem()), ("broker.key", key.serialize_pem())];
    files.iter().for_each(|(name, text)| std::fs::write(folder.path().join(name), text).unwrap());
    folder
}

/// One that has ended, and one that begins later: the clock of the control may have been set back.
#[test]
fn a_certificate_out_of_its_time_is_refused_with_the_reason() {
    for (from, until) in [(2_020, 2_021), (2_090, 2_091), (2_020, 2_091)] {
        let made = certificates_of(from, until);
        let mut site = Site::with(TestBroker::encrypted(made.path()), "tls: Some((ca: \"ca.pem\")),");
        std::fs::copy(made.path().join("ca.pem"), site.folder.path().join("ca.pem")).unwrap();
        if until - from > 1 {
            site.until_born();
        } else {
            site.until("the reason", |site| failure(site).contains("not valid now: check this clock and its dates"));
            assert_eq!(site.births().len(), 0);
        }
    }
}

#[test]
fn a_control_that_stands_still_or_is_switched_off_ends_its_connection() {
    let mut site = Site::new();
    site.until_born();
    site.gateway.close(Duration::from_secs(1_795_000_100));
    assert_ne!(site.view().state, BrokerState::Connected);
    site.until("the end", |site| !site.broker.has_client());
    let deaths = site.of("NDEATH");
    assert_eq!(deaths.len(), 1, "the control tells it itself");
    assert_eq!(value(&deaths[0], "bdSeq").value, value(&site.births()[0], "bdSeq").value);
    site.until_born();
    set(&mut site.snapshot, "P484", 0.0);
    site.step();
    site.steps(5);
    assert!(!site.broker.has_client());
    assert_eq!(site.view(), BrokerView::default());
    // The number of the connection counts on, also over power-offs.
    set(&mut site.snapshot, "P484", 1.0);
    site.until_born();
    site.gateway = Gateway::default().with_folder(site.folder.path().to_path_buf());
    site.until_born();
    let sessions: Vec<_> = site.births().iter().map(|birth| value(birth, "bdSeq").value.clone().unwrap()).collect();
    assert_eq!(sessions, [0, 1, 2, 3].map(Value::LongValue));
}

#[test]
fn a_machine_with_another_number_comes_back_under_its_new_name() {
    let mut site = Site::new();
    site.until_born();
    set(&mut site.snapshot, "P482", 124.0);
    let topic = "spBv1.0/hall 2/NBIRTH/kt830-gc-000124";
    site.until("the new name", |site| site.topics().contains(&topic));
    assert_eq!(site.of("NDEATH").len(), 1);
}

#[test]
fn an_alarm_that_has_come_and_gone_between_two_looks_is_told() {
    let mut site = Site::new();
    site.until_born();
    site.snapshot.alarm_history = AlarmHistory::new(
        [PastAlarm {
            count: 1,
            number: alarm::COOLANT_FLOW,
            text: LocalizedText::new("冷却", "no coolant flow"),
            cause: Default::default(),
            remedy: Default::default(),
            place: None,
            came: Default::default(),
            ended: Some((AlarmEnd::Itself, None)),
        }],
        1,
    );
    site.until("the alarm", |site| site.data().len() >= 6);
    let told: Vec<_> = site.data().into_iter().map(|(name, told)| (name, told.value)).collect();
    let levels: Vec<_> = told.iter().filter(|(name, _)| name == "c_coolant").map(|(_, value)| value.clone()).collect();
    assert_eq!(levels, [text("FAULT"), text("NORMAL")], "{told:?}");
}

#[test]
fn a_result_that_was_changed_while_the_broker_was_away_is_told_before_later_ones() {
    let mut site = Site::new();
    site.until_born();
    site.finish_part(1);
    site.until("the first", |site| site.results().len() == 1 && site.view().waiting == 0);
    site.broker.drop_client();
    site.until("the loss", |site| site.view().state != BrokerState::Connected);
    site.snapshot.production.parts.entries_mut()[0].verdict = PartVerdict::Out { partly: false };
    site.finish_part(2);
    site.until("both", |site| site.results().len() == 3);
    let told: Vec<_> = site.results().iter().map(|told| (told["part"].clone(), told["is_bad"].clone())).collect();
    assert_eq!(told, [(1, false), (1, true), (2, false)].map(|(part, is_bad)| (part.into(), is_bad.into())));
    // A power cut takes back what the disk did not have: the part that is made then is another one of that number.
    site.snapshot.production.parts = PartHistory::new([site.snapshot.production.parts[0]], 20);
    site.steps(10);
    site.snapshot.production.parts.push(PartRecord { program: 1_005, ..part(2, PartVerdict::Good) });
    site.until("the other part", |site| site.results().len() == 4);
    assert_eq!((&site.results()[3]["part"], &site.results()[3]["program"]), (&2.into(), &1_005.into()));
}

#[test]
fn a_long_history_follows_piece_by_piece_and_what_is_dropped_is_counted() {
    let mut site = Site::new();
    site.until_born();
    site.broker.drop_client();
    site.until("the loss", |site| site.view().state != BrokerState::Connected);
    site.broker.manners = Manners::Silent;
    for _ in 0..6_000 {
        for state in [RunState::Running, RunState::Idle] {
            site.snapshot.state = state;
            site.step();
        }
    }
    assert_eq!(site.view().waiting, 10_000);
    assert!(site.view().lost >= 2_000, "{:?}", site.view());
    site.broker.manners = Manners::Good;
    site.broker.drop_client();
    site.until_born();
    let begun = site.broker.sent.len();
    site.until("all", |site| site.view().waiting == 0);
    let told = site.data();
    assert!(site.broker.sent.len() - begun >= 50, "200 in a message");
    assert_eq!(told.len(), 10_000);
    assert!(told.iter().all(|(name, told)| name == "execution" && told.is_historical == Some(true)));
}

/// More parts than the control remembers, while the broker was away: the gap is counted.
#[test]
fn results_that_the_control_has_forgotten_are_counted() {
    let mut site = Site::new();
    site.until_born();
    site.finish_part(1);
    site.until("the result", |site| site.results().len() == 1 && site.view().waiting == 0);
    site.snapshot.production.parts = PartHistory::default();
    for count in [5, 6] {
        site.finish_part(count);
    }
    site.until("the results", |site| site.results().len() == 3);
    site.until("the gap", |site| site.view().lost == 3);
}
