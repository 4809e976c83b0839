//! What a broker is told, and what is kept for it while it is away.
//! Source: Eclipse Sparkplug 3.0.0, OASIS MQTT 3.1.1.

use std::collections::BTreeMap;
use std::time::Duration;

use kt830::defs::alarm_history::{AlarmEnd, AlarmHistory, PastAlarm};
use kt830::defs::key::Mode;
use kt830::defs::kind::Kind;
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

use super::site::{NODE, Site, failure, value};
use super::test_broker::Manners;
use super::{raised, set};

fn text(words: &str) -> Option<Value> {
    Some(Value::StringValue(words.to_owned()))
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
    site.until_born_as("kt830-gc-000124");
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
