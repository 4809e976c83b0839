//! What a control tells at its adapter port (SHDR), as the OPC UA server takes it: the identity of the machine, the newest
//! value of each data item, and the alarms that are raised.
//! Source: MTConnect Agent (cppagent), "Adapter Agent Protocol".

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use serde::Deserialize;

use crate::link::condition::{Condition, FAULT};

/// Most data items and alarms that are remembered: a stream of nonsense takes no memory.
const MOST_ENTRIES: usize = 1_000;
/// Longest value that is remembered, characters.
const LONGEST_VALUE: usize = 1_000;

/// Who the machine is.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MachineIdentity {
    /// Unique name: `kt830-gc-000123`.
    pub uuid: String,
    /// Maker of the control.
    pub manufacturer: String,
    /// Number of the machine (P482).
    pub serial_number: String,
    /// Kind of the machine.
    pub description: String,
}

/// An alarm that the control has raised.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ToldAlarm {
    /// Its number.
    pub number: String,
    /// Id of the condition that it belongs to.
    pub condition: String,
    /// It stops or blocks something until somebody acts.
    pub is_fault: bool,
    /// What it says, in English.
    pub text: String,
}

/// An order of its list.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct ToldOrder {
    /// Its number.
    pub order: u32,
    /// The name of its program.
    pub name: String,
    /// Good parts wanted.
    pub parts: u32,
    /// Parts that are not bad.
    pub good: u32,
    /// Bad parts.
    pub bad: u32,
    /// `proposed`, `waiting`, `active` or `closed`.
    pub state: String,
    /// What it asks for, by the names of the variables.
    #[serde(default)]
    pub values: BTreeMap<String, f64>,
}

/// What a line changes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AdapterEvent {
    /// A data item has a value: its id.
    Value(String),
    /// The message of the program is another one; empty for none.
    Message(String),
    /// An alarm is raised.
    Raised(ToldAlarm),
    /// An alarm is over.
    Cleared(ToldAlarm),
    /// The list of orders is another one.
    Orders,
    /// What became of the order that was proposed first (JSON).
    OrderAnswer(String),
}

/// All that was told since the connection began.
#[derive(Clone, Debug, Default)]
pub struct AdapterState {
    /// Who the machine is.
    pub identity: MachineIdentity,
    values: BTreeMap<String, String>,
    raised: BTreeMap<(String, String), ToldAlarm>,
    orders: Vec<ToldOrder>,
    time: String,
    /// When it came.
    received: Option<Instant>,
    /// Whether a line has told the level of a condition: it follows the values in a welcome.
    has_conditions: bool,
    program: ProgramCourse,
}

/// What has become of the program since it was loaded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ProgramCourse {
    /// It has not run.
    #[default]
    Loaded,
    /// It runs.
    Runs,
    /// It stands in the middle: held, stopped or waiting.
    Interrupted,
    /// It has run to its end.
    Ended,
    /// It was ended by an alarm or by RESET.
    Aborted,
}

impl ProgramCourse {
    /// After an execution in automatic mode.
    fn after(self, execution: &str) -> Self {
        match (execution, self) {
            ("ACTIVE", _) => Self::Runs,
            ("FEED_HOLD" | "PROGRAM_STOPPED" | "WAIT", _) => Self::Interrupted,
            ("PROGRAM_COMPLETED", _) => Self::Ended,
            ("READY" | "STOPPED", Self::Runs | Self::Interrupted) => Self::Aborted,
            (_, course) => course,
        }
    }
}

impl AdapterState {
    /// The text of a data item; none where nothing is known.
    #[must_use]
    pub fn text(&self, item: &str) -> Option<&str> {
        self.values.get(item).map(String::as_str).filter(|text| *text != "UNAVAILABLE")
    }

    /// The number of a data item.
    #[must_use]
    pub fn number(&self, item: &str) -> Option<f64> {
        self.text(item)?.parse().ok().filter(|value: &f64| value.is_finite())
    }

    /// The ids of the data items that the machine has.
    pub fn items(&self) -> impl Iterator<Item = &str> {
        self.values.keys().map(String::as_str)
    }

    /// The alarms that are raised, by their conditions and numbers.
    pub fn alarms(&self) -> impl Iterator<Item = &ToldAlarm> {
        self.raised.values()
    }

    /// The orders, as told last.
    #[must_use]
    pub fn orders(&self) -> &[ToldOrder] {
        &self.orders
    }

    /// For how long the newest line has been there.
    #[must_use]
    pub fn age(&self) -> Duration {
        self.received.map_or(Duration::ZERO, |at| at.elapsed())
    }

    /// When the newest line was written: UTC by ISO 8601.
    #[must_use]
    pub fn time(&self) -> &str {
        &self.time
    }

    /// What has become of the program; none without one.
    #[must_use]
    pub fn program(&self) -> Option<ProgramCourse> {
        self.text("program").map(|_| self.program)
    }

    /// Whether the machine is known with its items: a welcome has come.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        let told = ["avail", "execution", "message"];
        !self.identity.uuid.is_empty() && self.has_conditions && told.iter().all(|id| self.values.contains_key(*id))
    }

    /// What another connection to the same control has told since: alarms that are over, and those that are new.
    #[must_use]
    pub fn changes_to(&self, newer: &Self) -> Vec<AdapterEvent> {
        let gone = self.alarms().filter(|alarm| !newer.alarms().any(|other| other == *alarm)).cloned();
        let new = newer.alarms().filter(|alarm| !self.alarms().any(|other| other == *alarm)).cloned();
        gone.map(AdapterEvent::Cleared).chain(new.map(AdapterEvent::Raised)).collect()
    }

    /// Takes a line of the stream without its end. One that is not understood changes nothing.
    pub fn take(&mut self, line: &str) -> Vec<AdapterEvent> {
        if let Some(command) = line.strip_prefix("* ") {
            return self.take_command(command);
        }
        let mut fields = line.split('|');
        let time = fields.next().unwrap_or_default();
        let fields: Vec<&str> = fields.collect();
        if time.is_empty() || fields.is_empty() {
            return Vec::new();
        }
        self.time = time.to_owned();
        self.received = Some(Instant::now());
        match fields.as_slice() {
            [condition, level, number, _, _, text] if is_condition(condition) => {
                self.take_condition(condition, level, number, text)
            }
            ["message", _, text] => self.take_message(text),
            // A condition or a message that is not whole.
            [id, ..] if is_condition(id) || *id == "message" => Vec::new(),
            pairs => {
                let events: Vec<_> =
                    pairs.chunks_exact(2).filter_map(|pair| self.take_value(pair[0], pair[1])).collect();
                self.follow_program(&events);
                events
            }
        }
    }

    /// Follows the program, once a line is taken as a whole. Axes that are homed and moved by hand are active, too.
    fn follow_program(&mut self, events: &[AdapterEvent]) {
        let is_told = |id: &str| events.iter().any(|event| matches!(event, AdapterEvent::Value(told) if told == id));
        if is_told("program") {
            self.program = ProgramCourse::Loaded;
        }
        if (is_told("execution") || is_told("program")) && self.text("mode") == Some("AUTOMATIC") {
            self.program = self.text("execution").map_or(self.program, |execution| self.program.after(execution));
        }
    }

    fn take_command(&mut self, command: &str) -> Vec<AdapterEvent> {
        if let Some(list) = command.strip_prefix("orders: ") {
            let Ok(orders) = serde_json::from_str::<Vec<ToldOrder>>(list) else { return Vec::new() };
            if orders == self.orders || orders.len() > MOST_ENTRIES {
                return Vec::new();
            }
            self.orders = orders;
            return vec![AdapterEvent::Orders];
        }
        if let Some(answer) = command.strip_prefix("order: ") {
            return vec![AdapterEvent::OrderAnswer(answer.to_owned())];
        }
        self.take_identity(command);
        Vec::new()
    }

    fn take_identity(&mut self, command: &str) {
        let Some((name, value)) = command.split_once(": ") else { return };
        let place = match name {
            "uuid" => &mut self.identity.uuid,
            "manufacturer" => &mut self.identity.manufacturer,
            "serialNumber" => &mut self.identity.serial_number,
            "description" => &mut self.identity.description,
            _ => return,
        };
        value.clone_into(place);
    }

    fn take_value(&mut self, id: &str, text: &str) -> Option<AdapterEvent> {
        let old = self.values.get(id);
        if old.is_some_and(|old| old == text) || old.is_none() && self.values.len() >= MOST_ENTRIES {
            return None;
        }
        self.values.insert(id.to_owned(), text.chars().take(LONGEST_VALUE).collect());
        Some(AdapterEvent::Value(id.to_owned()))
    }

    fn take_message(&mut self, text: &str) -> Vec<AdapterEvent> {
        let is_new = self.take_value("message", text).is_some();
        if is_new { vec![AdapterEvent::Message(text.to_owned())] } else { Vec::new() }
    }

    /// `NORMAL` with a number ends that alarm, without one all of the condition.
    fn take_condition(&mut self, condition: &str, level: &str, number: &str, text: &str) -> Vec<AdapterEvent> {
        self.has_conditions = true;
        if level == "NORMAL" {
            let is_over =
                |alarm: &ToldAlarm| alarm.condition == condition && (number.is_empty() || alarm.number == number);
            let over: Vec<_> = self.raised.values().filter(|alarm| is_over(alarm)).cloned().collect();
            self.raised.retain(|_, alarm| !is_over(alarm));
            return over.into_iter().map(AdapterEvent::Cleared).collect();
        }
        let alarm = ToldAlarm {
            number: number.to_owned(),
            condition: condition.to_owned(),
            is_fault: level == FAULT,
            text: text.chars().take(LONGEST_VALUE).collect(),
        };
        let key = (alarm.condition.clone(), alarm.number.clone());
        let old = self.raised.get(&key);
        if old == Some(&alarm) || old.is_none() && self.raised.len() >= MOST_ENTRIES {
            return Vec::new();
        }
        self.raised.insert(key, alarm.clone());
        vec![AdapterEvent::Raised(alarm)]
    }
}

fn is_condition(id: &str) -> bool {
    Condition::ALL.iter().any(|condition| condition.row().0 == id)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(lines: &str) -> (AdapterState, Vec<AdapterEvent>) {
        let mut state = AdapterState::default();
        let events = lines.lines().flat_map(|line| state.take(line)).collect();
        (state, events)
    }

    const WELCOME: &str = "* uuid: kt830-gc-000123\n* serialNumber: 000123\n* description: KT-830 cylindrical grinder\n\
        2026-11-30T08:00:00.000000Z|avail|AVAILABLE|execution|READY|x_work|1.25|part_size|UNAVAILABLE\n\
        2026-11-30T08:00:00.000000Z|message||\n2026-11-30T08:00:00.000000Z|c_system|NORMAL||||\n";

    #[test]
    fn a_welcome_tells_who_the_machine_is_and_what_it_has() {
        let (state, _) = told(WELCOME);
        assert!(state.is_complete());
        assert_eq!(
            (state.identity.uuid.as_str(), state.identity.serial_number.as_str()),
            ("kt830-gc-000123", "000123")
        );
        assert_eq!(
            (state.number("x_work"), state.number("part_size"), state.text("nothing")),
            (Some(1.25), None, None)
        );
        assert_eq!(state.time(), "2026-11-30T08:00:00.000000Z");
    }

    #[test]
    fn only_changes_are_events() {
        let (mut state, _) = told(WELCOME);
        let time = "2026-11-30T08:00:01.000000Z";
        assert_eq!(state.take(&format!("{time}|execution|READY|x_work|1.25")), []);
        assert_eq!(state.take(&format!("{time}|x_work|1.5")), [AdapterEvent::Value("x_work".to_owned())]);
        let message = [AdapterEvent::Message("measure the part".to_owned())];
        assert_eq!(state.take(&format!("{time}|message||measure the part")), message);
        assert_eq!(state.take(&format!("{time}|message||measure the part")), []);
    }

    #[test]
    fn an_alarm_is_raised_once_and_cleared_by_its_number_or_with_its_condition() {
        let (mut state, _) = told(WELCOME);
        let raised = state.take("t|c_hydraulic|FAULT|180|||hydraulic pressure: check the pump");
        let [AdapterEvent::Raised(alarm)] = raised.as_slice() else { panic!("{raised:?}") };
        assert_eq!((alarm.number.as_str(), alarm.is_fault), ("180", true));
        assert_eq!(state.take("t|c_hydraulic|FAULT|180|||hydraulic pressure: check the pump"), []);
        state.take("t|c_hydraulic|WARNING|205|||another");
        assert_eq!(state.take("t|c_hydraulic|NORMAL|180|||"), [AdapterEvent::Cleared(alarm.clone())]);
        assert_eq!(state.take("t|c_hydraulic|NORMAL||||").len(), 1);
        assert_eq!(state.alarms().count(), 0);
    }

    #[test]
    fn the_course_of_a_program_follows_its_executions() {
        use ProgramCourse::{Aborted, Ended, Interrupted, Loaded, Runs};
        let cases: [(&str, Option<ProgramCourse>); 11] = [
            ("t|program|UNAVAILABLE|execution|READY", None),
            ("t|execution|READY|program|O1", Some(Loaded)),
            // A server that comes while it runs: its execution stands before its name.
            ("t|execution|ACTIVE|program|O1", Some(Runs)),
            ("t|program|O1\nt|execution|ACTIVE\nt|execution|PROGRAM_COMPLETED", Some(Ended)),
            ("t|program|O1\nt|execution|ACTIVE\nt|execution|PROGRAM_COMPLETED\nt|execution|READY", Some(Ended)),
            ("t|program|O1\nt|execution|ACTIVE\nt|execution|READY", Some(Aborted)),
            ("t|program|O1\nt|execution|ACTIVE\nt|execution|FEED_HOLD", Some(Interrupted)),
            ("t|program|O1\nt|execution|ACTIVE\nt|execution|FEED_HOLD\nt|execution|READY", Some(Aborted)),
            ("t|program|O1\nt|execution|ACTIVE\nt|execution|STOPPED\nt|execution|READY", Some(Aborted)),
            // An alarm without a run; another program after a run.
            ("t|program|O1\nt|execution|STOPPED", Some(Loaded)),
            ("t|program|O1\nt|execution|ACTIVE\nt|execution|READY\nt|program|O2", Some(Loaded)),
        ];
        for (lines, course) in cases {
            let (state, _) = told(&format!("t|mode|AUTOMATIC\n{lines}"));
            assert_eq!(state.program(), course, "{lines}");
        }
        let (homed, _) = told("t|mode|MANUAL|program|O1\nt|execution|ACTIVE\nt|execution|READY");
        assert_eq!(homed.program(), Some(Loaded), "homing is no run");
    }

    #[test]
    fn the_orders_are_told_when_they_change() {
        let (mut state, _) = told(WELCOME);
        let line = "* orders: [{\"order\":701,\"program\":1002,\"name\":\"O1002\",\"parts\":50,\"good\":2,\"bad\":1,\
            \"state\":\"active\",\"values\":{\"#521\":38.02}}]";
        assert_eq!(state.take(line), [AdapterEvent::Orders]);
        let order = &state.orders()[0];
        assert_eq!((order.order, order.good, order.values.get("#521")), (701, 2, Some(&38.02)));
        assert_eq!(state.take(line), [], "the same");
        assert_eq!(state.take("* orders: [{]"), [], "no list");
        assert_eq!(state.orders().len(), 1);
        assert_eq!(state.take("* order: {}"), [AdapterEvent::OrderAnswer("{}".to_owned())]);
    }

    #[test]
    fn another_connection_tells_what_has_come_and_gone_meanwhile() {
        let alarm = |number: &str| format!("t|c_hydraulic|FAULT|{number}|||text {number}");
        let (before, _) = told(&format!("{WELCOME}{}\n{}", alarm("180"), alarm("181")));
        let (after, _) = told(&format!("{WELCOME}{}\n{}", alarm("181"), alarm("182")));
        let changes = before.changes_to(&after);
        let numbers: Vec<_> = changes
            .iter()
            .map(|change| match change {
                AdapterEvent::Cleared(alarm) => (false, alarm.number.as_str()),
                AdapterEvent::Raised(alarm) => (true, alarm.number.as_str()),
                other => panic!("{other:?}"),
            })
            .collect();
        assert_eq!(numbers, [(false, "180"), (true, "182")]);
        assert_eq!(before.changes_to(&before.clone()), []);
    }

    #[test]
    fn a_welcome_that_is_cut_off_is_not_complete() {
        let whole: Vec<&str> = WELCOME.lines().collect();
        for lines in 0..whole.len() {
            assert!(!told(&whole[..lines].join("\n")).0.is_complete(), "{lines} lines");
        }
    }

    #[test]
    fn nonsense_changes_nothing_and_takes_no_memory() {
        let (mut state, _) = told(WELCOME);
        for line in ["", "|", "* ", "* uuid", "* PONG 10000", "t|", "t|x_work", "t|c_system|FAULT", "x"] {
            assert_eq!(state.take(line), [], "{line}");
        }
        assert_eq!(state.identity.uuid, "kt830-gc-000123");
        (0..5_000).for_each(|id| drop(state.take(&format!("t|item{id}|1"))));
        (0..5_000).for_each(|id| drop(state.take(&format!("t|c_system|FAULT|{id}|||text"))));
        assert!(state.items().count() <= MOST_ENTRIES && state.alarms().count() <= MOST_ENTRIES);
    }
}
