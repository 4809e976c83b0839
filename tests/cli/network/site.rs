//! A control and its broker.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use kt830::defs::part_record::PartHistory;
use kt830::defs::part_verdict::PartVerdict;
use kt830::gateway::Gateway;
use kt830::link::Snapshot;
use kt830::link::network::{BrokerState, BrokerView};
use srad_types::payload::{Metric, Payload};

use super::test_broker::{Sent, TestBroker};
use super::{DEADLINE, machine, part, set};

pub const NODE: &str = "kt830-gc-000123";

/// A control and its broker, stepped by the test: 20 ms a step.
pub struct Site {
    pub gateway: Gateway,
    pub broker: TestBroker,
    pub snapshot: Snapshot,
    pub folder: tempfile::TempDir,
    pub now: Duration,
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

    pub fn without_settings(broker: TestBroker, folder: tempfile::TempDir) -> Self {
        let gateway = Gateway::default().with_folder(folder.path().to_path_buf());
        let mut snapshot = machine();
        set(&mut snapshot, "P482", 123.0);
        set(&mut snapshot, "P484", 1.0);
        Self { gateway, broker, snapshot, folder, now: Duration::ZERO }
    }

    pub fn write_settings(&self, text: &str) {
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

    /// Steps until it is there under a name.
    pub fn until_born_as(&mut self, node: &str) {
        let topic = format!("spBv1.0/hall 2/NBIRTH/{node}");
        self.until("its name", |site| site.topics().contains(&topic.as_str()));
    }

    pub fn topics(&self) -> Vec<&str> {
        self.broker.sent.iter().map(|sent| sent.topic.as_str()).collect()
    }

    pub fn of(&self, kind: &str) -> Vec<Payload> {
        let topic = format!("spBv1.0/hall 2/{kind}/{NODE}");
        self.broker.sent.iter().filter(|sent| sent.topic == topic).map(Sent::sparkplug).collect()
    }

    pub fn births(&self) -> Vec<Payload> {
        self.of("NBIRTH")
    }

    /// Metrics of the data since the last birth, with their names.
    pub fn data(&self) -> Vec<(String, Metric)> {
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

    pub fn results(&self) -> Vec<serde_json::Value> {
        let topic = format!("kt830/hall 2/{NODE}/part");
        let parts = self.broker.sent.iter().filter(|sent| sent.topic == topic);
        parts.map(|sent| serde_json::from_slice(&sent.payload).unwrap()).collect()
    }

    pub fn finish_part(&mut self, count: u64) {
        let known = &self.snapshot.production.parts;
        let mut parts = PartHistory::new(known.iter().copied(), known.version());
        parts.push(part(count, PartVerdict::Good));
        self.snapshot.production.parts = parts;
    }
}

pub fn value<'a>(payload: &'a Payload, name: &str) -> &'a Metric {
    payload.metrics.iter().find(|told| told.name.as_deref() == Some(name)).unwrap_or_else(|| panic!("{name}"))
}

pub fn failure(site: &Site) -> String {
    match site.view().state {
        BrokerState::Failed(why) => why.en().into_owned(),
        _ => String::new(),
    }
}
