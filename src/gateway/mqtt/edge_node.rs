//! The control as an edge node of Sparkplug B: its birth, its data by exception, and what is kept for the broker while it is
//! away. Names of metrics are those of the data items; a condition has its level, number and text.
//! Nothing here knows of connections: payloads go out, commands come in.
//! Source: Eclipse Sparkplug 3.0.0, chapters 5 and 6.

use std::collections::VecDeque;
use std::time::Duration;

use srad_types::payload::metric::Value;
use srad_types::payload::{DataType, Message, Metric, Payload, PropertySet, PropertyValue, property_value};
use srad_types::topic::{NodeMessage, node_topic};

use crate::defs::text::LocalizedText;
use crate::gateway::device_model::device_uuid;
use crate::link::condition::{Condition, level};
use crate::link::data_item::{Category, DataItem, ItemValue, data_items, rounded};
use crate::link::snapshot::Snapshot;

/// Most changes kept while the broker is away; the oldest is dropped for a new one.
const STORED_LIMIT: usize = 10_000;
/// Most kept changes in a message.
const BATCH: usize = 200;
/// Names of the metrics that Sparkplug itself has.
const SESSION: &str = "bdSeq";
const REBIRTH: &str = "Node Control/Rebirth";
/// Longest text of a value, characters; the rest is cut.
const LONGEST_TEXT: usize = 400;

/// A message to the broker.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Publication {
    /// Its topic.
    pub topic: String,
    /// Its payload.
    pub payload: Vec<u8>,
}

/// Where the value of a metric comes from.
#[derive(Clone, Copy, Debug)]
enum MetricSource {
    Item(DataItem),
    Condition(Condition, ConditionPart),
}

/// What is told of a condition: its worst alarm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ConditionPart {
    Level,
    Number,
    Text,
}

/// A metric with its value now.
#[derive(Clone, Debug)]
struct NodeMetric {
    source: MetricSource,
    value: ItemValue,
}

/// A change of a metric.
#[derive(Clone, Debug)]
struct MetricChange {
    metric: NodeMetric,
    /// Time since 1970, ms.
    at_ms: u64,
}

/// The node.
pub struct EdgeNode {
    group: String,
    id: String,
    /// Number of the connection, in will and birth.
    session: u8,
    /// Number of the next message in the session.
    sequence: u8,
    metrics: Vec<NodeMetric>,
    /// Whether the broker has a birth with these metrics.
    is_born: bool,
    /// Changes that the broker may have: sent before the last ping, and after it.
    unproven: [VecDeque<MetricChange>; 2],
    /// Changes that the broker does not have.
    stored: VecDeque<MetricChange>,
    /// Changes that were dropped for newer ones.
    lost: u64,
    /// Serial number of the newest alarm that has been looked at; none before the first look.
    newest_alarm: Option<u64>,
    /// The alarms of the last look.
    raised: Vec<u16>,
}

impl EdgeNode {
    /// A node that nobody knows yet. `group` and the number of the machine say who it is.
    #[must_use]
    pub fn new(group: &str, snapshot: &Snapshot) -> Self {
        Self {
            group: group.to_owned(),
            id: device_uuid(snapshot),
            session: 0,
            sequence: 0,
            metrics: Vec::new(),
            is_born: false,
            unproven: [const { VecDeque::new() }; 2],
            stored: VecDeque::new(),
            lost: 0,
            newest_alarm: None,
            raised: Vec::new(),
        }
    }

    /// Whether it stands for this machine in this group.
    #[must_use]
    pub fn stands_for(&self, group: &str, snapshot: &Snapshot) -> bool {
        self.group == group && self.is_of(snapshot)
    }

    /// Whether it stands for this machine.
    #[must_use]
    pub fn is_of(&self, snapshot: &Snapshot) -> bool {
        self.id == device_uuid(snapshot)
    }

    /// Its id, that of the client as well.
    #[must_use]
    pub fn id(&self) -> &str {
        &self.id
    }

    /// Topic of its commands.
    #[must_use]
    pub fn command_topic(&self) -> String {
        self.topic(NodeMessage::NCmd)
    }

    /// A topic beside Sparkplug: its data are not acknowledged, and its commands are single values.
    #[must_use]
    pub fn own_topic(&self, of: &str) -> String {
        format!("kt830/{}/{}/{of}", self.group, self.id)
    }

    /// Changes that wait for the broker.
    #[must_use]
    pub fn stored_count(&self) -> usize {
        self.stored.len()
    }

    /// Changes that were dropped for newer ones.
    #[must_use]
    pub const fn lost_count(&self) -> u64 {
        self.lost
    }

    /// The connection with this number begins.
    pub const fn begin_session(&mut self, session: u8) {
        self.session = session;
    }

    /// What the others are told when the connection is over, by the control or, if it is lost, by the broker.
    #[must_use]
    pub fn death(&self, time: Duration) -> Publication {
        let death = payload(time, None, vec![self.session_metric(time)]);
        Publication { topic: self.topic(NodeMessage::NDeath), payload: death }
    }

    /// Nothing more is told before the next birth.
    pub const fn forget_birth(&mut self) {
        self.is_born = false;
    }

    /// All metrics with their values. What was kept follows with the next data.
    fn birth(&mut self, time: Duration) -> Publication {
        self.sequence = 0;
        let mut rebirth = metric(Some(Value::BooleanValue(false)), milliseconds(time));
        rebirth.set_name(REBIRTH.to_owned()).set_datatype(DataType::Boolean);
        let mut metrics = vec![self.session_metric(time), rebirth];
        for (alias, known) in self.metrics.iter().enumerate() {
            let mut told = metric(known.told(), milliseconds(time));
            told.set_name(known.source.name()).set_alias(alias as u64).set_datatype(known.source.data_type());
            told.properties = known.source.unit().map(unit_property);
            metrics.push(told);
        }
        self.is_born = true;
        let sequence = self.next_sequence();
        Publication { topic: self.topic(NodeMessage::NBirth), payload: payload(time, Some(sequence), metrics) }
    }

    /// Looks at the machine while the broker is there: a birth where it has none of these metrics, otherwise the changes.
    /// Measured values are looked at with `with_samples`; kept changes follow, a message in a step, with `has_room`.
    pub fn tell(
        &mut self,
        time: Duration,
        snapshot: &Snapshot,
        with_samples: bool,
        has_room: bool,
    ) -> Vec<Publication> {
        let changes = self.look(time, snapshot, with_samples);
        if !self.is_born {
            return vec![self.birth(time)];
        }
        let mut told = Vec::new();
        if has_room && !self.stored.is_empty() {
            let batch: Vec<MetricChange> = self.stored.drain(..self.stored.len().min(BATCH)).collect();
            let metrics = batch.iter().filter_map(|change| self.changed(change));
            let metrics: Vec<Metric> = metrics.map(|told| Metric { is_historical: Some(true), ..told }).collect();
            told.extend((!metrics.is_empty()).then(|| self.data(time, metrics)));
            self.hold(batch);
        }
        if !changes.is_empty() {
            let metrics = changes.iter().filter_map(|change| self.changed(change)).collect();
            told.push(self.data(time, metrics));
            self.hold(changes.into_iter().filter(|change| !change.metric.source.is_sample()).collect());
        }
        told
    }

    /// Looks at the machine while the broker is away: states and alarms are kept, measured values are not.
    pub fn keep(&mut self, time: Duration, snapshot: &Snapshot) {
        self.look(time, snapshot, false);
    }

    /// A ping follows all that was sent.
    pub fn ping_sent(&mut self) {
        let [before, after] = &mut self.unproven;
        before.append(after);
        self.lost += limit(before);
    }

    /// The broker has all that was sent before the ping.
    pub fn ping_answered(&mut self) {
        self.unproven[0].clear();
    }

    /// The connection is over: what the broker may not have is told once more.
    pub fn connection_lost(&mut self) {
        self.is_born = false;
        let [mut before, mut after] = std::mem::take(&mut self.unproven);
        before.append(&mut after);
        before.append(&mut self.stored);
        self.stored = before;
        self.lost += limit(&mut self.stored);
    }

    /// Whether a command asks for a birth. Nothing else can be commanded.
    #[must_use]
    pub fn asks_for_birth(&self, topic: &str, payload: &[u8]) -> bool {
        let is_rebirth = |metric: &Metric| {
            metric.name.as_deref() == Some(REBIRTH) && metric.value == Some(Value::BooleanValue(true))
        };
        topic == self.command_topic()
            && Payload::decode(payload).is_ok_and(|command| command.metrics.iter().any(is_rebirth))
    }

    /// What has changed since the last look. With metrics that the birth does not have, or before it, nothing is told and
    /// the changes are kept: the birth has the last values alone.
    fn look(&mut self, time: Duration, snapshot: &Snapshot, with_samples: bool) -> Vec<MetricChange> {
        let at_ms = milliseconds(time);
        let mut now = metrics_of(snapshot);
        let known = std::mem::take(&mut self.metrics);
        let is_same = known.len() == now.len() && known.iter().zip(&now).all(|(old, new)| old.source.is(&new.source));
        let mut changes = self.passed_alarms(snapshot, &now, at_ms);
        for (new, old) in now.iter_mut().zip(known).filter(|_| is_same) {
            if new.source.is_sample() && !with_samples {
                new.value = old.value;
            } else if new.value != old.value {
                changes.push(MetricChange { metric: new.clone(), at_ms });
            }
        }
        self.metrics = now;
        self.is_born &= is_same;
        if self.is_born {
            return changes;
        }
        self.stored.extend(changes.into_iter().filter(|change| !change.metric.source.is_sample()));
        self.lost += limit(&mut self.stored);
        Vec::new()
    }

    /// Alarms that have come and gone since the last look: what they were, then how their conditions are now.
    fn passed_alarms(&mut self, snapshot: &Snapshot, now: &[NodeMetric], at_ms: u64) -> Vec<MetricChange> {
        let newest = snapshot.alarm_history.last().map_or(0, |alarm| alarm.count);
        let seen = self.newest_alarm.replace(newest).unwrap_or(newest);
        let raised = snapshot.alarms.iter().map(|alarm| alarm.number).collect();
        let was_raised = std::mem::replace(&mut self.raised, raised);
        let mut changes = Vec::new();
        for past in snapshot.alarm_history.iter().rev().take_while(|past| past.count > seen) {
            if past.ended.is_none() || self.raised.iter().chain(&was_raised).any(|number| *number == past.number) {
                continue;
            }
            let condition = Condition::of_alarm(past.number);
            let was = of_condition(condition, Some((past.number, &past.text)));
            let is = now.iter().filter(|now| matches!(now.source, MetricSource::Condition(of, _) if of == condition));
            changes.extend(was.into_iter().chain(is.cloned()).map(|metric| MetricChange { metric, at_ms }));
        }
        changes
    }

    /// Remembers what was sent until the broker has proved that it has it.
    fn hold(&mut self, sent: Vec<MetricChange>) {
        self.unproven[1].extend(sent);
        self.lost += limit(&mut self.unproven[1]);
    }

    fn data(&mut self, time: Duration, metrics: Vec<Metric>) -> Publication {
        let sequence = self.next_sequence();
        Publication { topic: self.topic(NodeMessage::NData), payload: payload(time, Some(sequence), metrics) }
    }

    /// A change as it is told; none of a metric that the birth does not have.
    fn changed(&self, MetricChange { metric: changed, at_ms }: &MetricChange) -> Option<Metric> {
        let alias = self.metrics.iter().position(|known| known.source.is(&changed.source))?;
        let mut told = metric(changed.told(), *at_ms);
        told.set_alias(alias as u64);
        Some(told)
    }

    fn session_metric(&self, time: Duration) -> Metric {
        let mut session = metric(Some(Value::LongValue(self.session.into())), milliseconds(time));
        session.set_name(SESSION.to_owned()).set_datatype(DataType::Int64);
        session
    }

    fn next_sequence(&mut self) -> u64 {
        let now = self.sequence;
        self.sequence = now.wrapping_add(1);
        now.into()
    }

    fn topic(&self, message: NodeMessage) -> String {
        node_topic(&self.group, &message, &self.id)
    }
}

impl MetricSource {
    fn is(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Item(item), Self::Item(other)) => item.is(other),
            (Self::Condition(condition, part), Self::Condition(other, of)) => (condition, part) == (other, of),
            (Self::Item(_), Self::Condition(..)) | (Self::Condition(..), Self::Item(_)) => false,
        }
    }

    fn name(&self) -> String {
        match self {
            Self::Item(item) => item.id(),
            Self::Condition(condition, ConditionPart::Level) => condition.row().0.to_owned(),
            Self::Condition(condition, ConditionPart::Number) => format!("{}_number", condition.row().0),
            Self::Condition(condition, ConditionPart::Text) => format!("{}_text", condition.row().0),
        }
    }

    fn data_type(&self) -> DataType {
        match self {
            Self::Item(item) => match (item.category, item.kind) {
                (Category::Sample(_) | Category::EventWithUnits(_), _) => DataType::Double,
                (Category::Event, _) if item.is_count() => DataType::UInt64,
                (Category::Event, _) => DataType::String,
            },
            Self::Condition(_, ConditionPart::Number) => DataType::UInt64,
            Self::Condition(_, ConditionPart::Level | ConditionPart::Text) => DataType::String,
        }
    }

    const fn unit(&self) -> Option<&'static str> {
        match self {
            Self::Item(DataItem { category: Category::Sample(unit) | Category::EventWithUnits(unit), .. }) => {
                Some(unit)
            }
            Self::Item(_) | Self::Condition(..) => None,
        }
    }

    /// A measured value: looked at less often, and not kept while the broker is away.
    fn is_sample(&self) -> bool {
        matches!(self, Self::Item(item) if item.is_sampled())
    }
}

impl NodeMetric {
    /// Its value as it is told; none while it is not known.
    fn told(&self) -> Option<Value> {
        match (self.source.data_type(), &self.value) {
            (_, ItemValue::Unavailable) => None,
            (DataType::Double, ItemValue::Number(number)) => Some(Value::DoubleValue(*number)),
            (DataType::Double, ItemValue::Count(count)) => Some(Value::DoubleValue(*count as f64)),
            (DataType::UInt64, ItemValue::Count(count)) => Some(Value::LongValue(*count)),
            (_, value) => Some(Value::StringValue(value.to_string())),
        }
    }
}

/// All metrics of a machine.
fn metrics_of(snapshot: &Snapshot) -> Vec<NodeMetric> {
    let of_item = |item: DataItem| {
        let value = match item.value(snapshot) {
            ItemValue::Number(number) if number.is_finite() => ItemValue::Number(rounded(number)),
            ItemValue::Number(_) => ItemValue::Unavailable,
            ItemValue::Text(words) => ItemValue::Text(cut(&words)),
            value => value,
        };
        NodeMetric { source: MetricSource::Item(item), value }
    };
    let conditions = Condition::of_machine(snapshot).flat_map(|condition| {
        let worst = condition.worst(snapshot);
        of_condition(condition, worst.map(|alarm| (alarm.number, &alarm.text)))
    });
    data_items(snapshot).map(of_item).chain(conditions).collect()
}

/// The metrics of a condition with its worst alarm.
fn of_condition(condition: Condition, worst: Option<(u16, &LocalizedText)>) -> [NodeMetric; 3] {
    let values = [
        (ConditionPart::Level, ItemValue::Word(worst.map_or("NORMAL", |(number, _)| level(number)))),
        (ConditionPart::Number, ItemValue::Count(worst.map_or(0, |(number, _)| number.into()))),
        (ConditionPart::Text, ItemValue::Text(worst.map(|(_, text)| cut(&text.en())).unwrap_or_default())),
    ];
    values.map(|(part, value)| NodeMetric { source: MetricSource::Condition(condition, part), value })
}

/// Drops the oldest changes above the limit; their count.
fn limit(changes: &mut VecDeque<MetricChange>) -> u64 {
    let above = changes.len().saturating_sub(STORED_LIMIT);
    changes.drain(..above).count() as u64
}

fn cut(words: &str) -> String {
    words.chars().take(LONGEST_TEXT).collect()
}

fn metric(value: Option<Value>, at_ms: u64) -> Metric {
    let mut metric = Metric::new();
    metric.set_timestamp(at_ms);
    match value {
        Some(value) => metric.set_value(value),
        None => metric.set_null(),
    };
    metric
}

fn unit_property(unit: &str) -> PropertySet {
    let value = PropertyValue {
        r#type: Some(DataType::String as u32),
        is_null: None,
        value: Some(property_value::Value::StringValue(unit.to_owned())),
    };
    PropertySet { keys: vec!["engUnit".to_owned()], values: vec![value] }
}

fn payload(time: Duration, sequence: Option<u64>, metrics: Vec<Metric>) -> Vec<u8> {
    let payload = Payload { timestamp: Some(milliseconds(time)), metrics, seq: sequence, uuid: None, body: None };
    payload.encode_to_vec()
}

fn milliseconds(time: Duration) -> u64 {
    u64::try_from(time.as_millis()).unwrap_or(u64::MAX)
}
