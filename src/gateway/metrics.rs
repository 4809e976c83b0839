//! The state of the machine as Prometheus reads it: `GET /metrics` of the view for browsers.
//! Source: Prometheus text exposition format 0.0.4; docs/shop.

use std::fmt::Write;

use super::device_model::device_uuid;
use crate::link::condition::level;
use crate::link::data_item::{Category, ItemValue, data_items};
use crate::link::snapshot::Snapshot;

/// The executions of MTConnect that the control tells.
const EXECUTIONS: [&str; 7] =
    ["READY", "ACTIVE", "FEED_HOLD", "PROGRAM_STOPPED", "PROGRAM_COMPLETED", "WAIT", "STOPPED"];

/// A metric and what it is.
struct Metric {
    name: &'static str,
    kind: &'static str,
    help: &'static str,
}

const EXECUTION: Metric = Metric { name: "kt830_execution", kind: "gauge", help: "1 for the state of the run" };
const VALUE: Metric = Metric { name: "kt830_value", kind: "gauge", help: "a measured or commanded value in its unit" };
const ALARM: Metric = Metric { name: "kt830_alarm", kind: "gauge", help: "1 for each alarm that stands" };
const PARTS: Metric = Metric { name: "kt830_parts_total", kind: "counter", help: "finished parts" };
const BAD_PARTS: Metric = Metric {
    name: "kt830_last_part_bad",
    kind: "gauge",
    help: "1 if the last finished part is outside its tolerance or spoilt",
};

/// All metrics of a machine.
#[must_use]
pub fn metrics(snapshot: &Snapshot) -> String {
    let machine = format!("machine=\"{}\"", device_uuid(snapshot));
    let items: Vec<_> = data_items(snapshot).collect();
    let execution = items.iter().find(|item| item.id() == "execution").map(|item| item.value(snapshot).to_string());
    let executions = EXECUTIONS.iter().map(|state| {
        let holds = execution.as_deref() == Some(*state);
        (format!("{machine},state=\"{state}\""), if holds { 1.0 } else { 0.0 })
    });
    let values = items.iter().filter_map(|item| {
        let (Category::Sample(units) | Category::EventWithUnits(units)) = item.category else { return None };
        let value = match item.value(snapshot) {
            ItemValue::Number(value) if value.is_finite() => value,
            ItemValue::Count(count) => count as f64,
            _ => return None,
        };
        Some((format!("{machine},item=\"{}\",units=\"{units}\"", item.id()), value))
    });
    let alarms = snapshot
        .alarms
        .iter()
        .map(|alarm| (format!("{machine},number=\"{}\",level=\"{}\"", alarm.number, level(alarm.number)), 1.0));
    let last = snapshot.production.parts.last();
    let parts = [(machine.clone(), last.map_or(0.0, |part| part.count as f64))];
    let bad = last.map(|part| (machine.clone(), if part.verdict.is_bad() { 1.0 } else { 0.0 }));
    [
        told(&EXECUTION, executions),
        told(&VALUE, values),
        told(&ALARM, alarms),
        told(&PARTS, parts.into_iter()),
        told(&BAD_PARTS, bad.into_iter()),
    ]
    .concat()
}

fn told(metric: &Metric, samples: impl Iterator<Item = (String, f64)>) -> String {
    let Metric { name, kind, help } = metric;
    let mut text = format!("# HELP {name} {help}\n# TYPE {name} {kind}\n");
    for (labels, value) in samples {
        // Writing to a string does not fail.
        let _ = writeln!(text, "{name}{{{labels}}} {value}");
    }
    text
}
