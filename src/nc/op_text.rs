//! The printed forms of operations: one JSON object, and one line of text. Source: spec T4.

use std::fmt;
use std::ops::Index;

use serde_json::{Map, Value, json};

use super::op::{AxisSet, Feed, Op, PathMode, SpeedMode};
use super::op_effect::{CoordinateChange, OpEffect, OpMotion, OscillationChange, ProgramMessage};
use super::work_offsets::EXTRA_G;
use crate::units::{Axis, PerAxis};

impl Op {
    /// The operation as one JSON object, with the machine's axes only. A feed per revolution adds `"per":"rev"`.
    #[must_use]
    pub fn json(&self, axes: PerAxis<bool>) -> Value {
        let mut object = Map::new();
        object.insert("op".into(), self.name().into());
        self.fields(axes, &mut |key, value| {
            object.insert(key.into(), value);
        });
        Value::Object(object)
    }

    /// Passes key and value of every field to `put`, positions first.
    fn fields(&self, axes: PerAxis<bool>, put: &mut dyn FnMut(&str, Value)) {
        match self.effect() {
            OpEffect::Motion(motion) => motion.fields(axes, put),
            OpEffect::Coordinates(change) => change.fields(axes, put),
            OpEffect::IndexTurret { station, by } => {
                put("tool", json!(station));
                put("offset", json!(if by.is_some() { station } else { 0 }));
                by.iter().for_each(|by| put_points(put, "d", axes, *by));
            }
            OpEffect::Oscillation(OscillationChange::Axis { axis, to, ramp_ms, strokes_min }) => {
                put(axis_key(axis), json!(to));
                put_some(put, [("ramp", ramp_ms), ("strokes", strokes_min)]);
            }
            OpEffect::Oscillation(OscillationChange::Cylinder { ramp_ms, strokes_min }) => {
                put_some(put, [("ramp", ramp_ms), ("strokes", strokes_min)]);
            }
            OpEffect::Oscillation(OscillationChange::Off) => {}
            OpEffect::PathMode(PathMode::ExactStop) => put("mode", json!("exact-stop")),
            OpEffect::PathMode(PathMode::Continuous { tolerance_mm }) => {
                put_both(put, ("mode", json!("continuous")), ("tolerance", json!(tolerance_mm)));
            }
            OpEffect::Dwell(seconds) => put("s", json!(seconds)),
            OpEffect::Speed(value, mode) => put_both(put, ("value", json!(value)), ("unit", json!(mode.unit()))),
            OpEffect::SpeedLimit(rpm) => put("rpm", json!(rpm)),
            OpEffect::MCode(words) => {
                put("code", json!(words.code));
                put_some(put, [("s", words.s), ("p", words.p), ("l", words.l)]);
            }
            OpEffect::Variable(number, value) | OpEffect::SystemVariable(number, value) => {
                put_both(put, ("variable", json!(number)), ("value", json!(value)));
            }
            OpEffect::Message(ProgramMessage::Show(text) | ProgramMessage::Print(text)) => {
                put("text", json!(text.as_name()))
            }
            OpEffect::Message(ProgramMessage::Alarm(number, text) | ProgramMessage::Stop(number, text)) => {
                put_both(put, ("number", json!(number)), ("text", json!(text.as_name())));
            }
        }
    }

    /// The axes of a block with coordinate words, and those of them with an incremental word.
    fn programmed_axes(&self) -> Option<(AxisSet, AxisSet)> {
        let OpEffect::Motion(motion) = self.effect() else { return None };
        match motion {
            OpMotion::Work(by) => Some((by.words, by.incremental)),
            OpMotion::Reference { words, incremental, .. } => Some((words, incremental)),
            OpMotion::Machine { .. } | OpMotion::DressPoint { .. } | OpMotion::Gauge(_) => None,
            OpMotion::Thread(_) | OpMotion::HomeSwitch(_) => None,
        }
    }

    const fn name(&self) -> &'static str {
        match self {
            Self::Rapid { .. } => "rapid",
            Self::Feed { .. } => "feed",
            Self::Arc { .. } => "arc",
            Self::Dwell { .. } => "dwell",
            Self::SetPathMode(_) => "path",
            Self::SelectWorkOffset { .. } => "frame",
            Self::SetLocalZero { .. } => "local",
            Self::SetCoordinateSystem { .. } => "preset",
            Self::SpeedLimit { .. } => "speed-limit",
            Self::MachineMove { .. } => "machine",
            Self::ReturnToReference { .. } => "reference",
            Self::Skip { .. } => "skip",
            Self::AddWear { .. } => "add-wear",
            Self::DressReturn { .. } => "dress-return",
            Self::OscillationOn { .. } => "oscillation-on",
            Self::OscillationOff => "oscillation-off",
            Self::Gauge(_) => "gauge",
            Self::Thread(_) => "thread",
            Self::HomeSwitch { .. } => "home",
            Self::IndexTurret { .. } => "t",
            Self::M { .. } => "m",
            Self::S { .. } => "s",
            Self::T { .. } => "t",
            Self::SetVariable { .. } => "set",
            Self::SetSystemVariable { .. } => "set-system",
            Self::Alarm { .. } => "alarm",
            Self::StopWithMessage { .. } => "message",
            Self::DisplayMessage { .. } => "note",
            Self::Print { .. } => "print",
        }
    }
}

impl OpMotion<'_> {
    fn fields(&self, axes: PerAxis<bool>, put: &mut dyn FnMut(&str, Value)) {
        match *self {
            Self::Work(by) => {
                put_points(put, "", axes, by.to);
                if let Some(arc) = by.arc {
                    put_points(put, "c", PerAxis::from_fn(|axis| axis != arc.plane.normal_axis()), arc.center);
                    put("turn", json!(arc.turn));
                }
                by.feed.iter().for_each(|feed| put_feed(put, *feed));
                by.skip_signal.iter().for_each(|signal| put("signal", json!(signal)));
            }
            Self::Machine { to, feed } => {
                put_some_points(put, "", to);
                feed.iter().for_each(|feed| put_feed(put, *feed));
            }
            Self::Reference { number, via, words, .. } => {
                put_points(put, "", PerAxis::from_fn(|axis| words.contains(axis)), via);
                if number > 1 {
                    put("p", json!(number));
                }
            }
            Self::DressPoint { axes, feed } => {
                put("axes", json!(axis_keys(axes)));
                put_some(put, [("f", feed)]);
            }
            Self::Gauge(gauging) => {
                put(axis_key(gauging.axis), json!(gauging.to));
                put("f", json!(gauging.fast_mm_min));
                put("j", json!(gauging.fine_mm_min));
                put("p", json!(gauging.first_input));
                gauging.second_input.iter().for_each(|second| put("q", json!(second)));
                put("l", json!(gauging.retract_mm));
            }
            Self::Thread(threading) => {
                put_points(put, "", axes, threading.to);
                put_points(put, "out", axes, threading.run_out_start);
                put("lead", json!(threading.lead_mm));
            }
            Self::HomeSwitch(axes) => put("axes", json!(axis_keys(axes))),
        }
    }
}

impl CoordinateChange {
    fn fields(&self, axes: PerAxis<bool>, put: &mut dyn FnMut(&str, Value)) {
        match *self {
            Self::Select(g) => match g.checked_sub(EXTRA_G) {
                None => put("g", json!(g)),
                Some(0) => put("g", json!(500)),
                Some(extra) => put_both(put, ("g", json!(54.1)), ("p", json!(extra))),
            },
            Self::Local(values) => put_some_points(put, "", values),
            Self::Set(values) => put_some_points(put, "", values),
            Self::Tool { tool, offset } => put_both(put, ("tool", json!(tool)), ("offset", json!(offset))),
            Self::AddWear { number, by } => {
                put("offset", json!(number));
                put_points(put, "", axes, by);
            }
        }
    }
}

impl SpeedMode {
    const fn unit(self) -> &'static str {
        match self {
            Self::Rpm => "rpm",
            Self::MetresPerSecond => "m/s",
            Self::SurfaceSpeed => "m/min",
        }
    }
}

/// The key of an axis: its letter in lower case.
const fn axis_key(axis: Axis) -> &'static str {
    match axis {
        Axis::X => "x",
        Axis::Y => "y",
        Axis::Z => "z",
    }
}

fn axis_keys(axes: AxisSet) -> String {
    axes.iter().map(axis_key).collect()
}

fn put_some<const N: usize>(put: &mut dyn FnMut(&str, Value), fields: [(&str, Option<f64>); N]) {
    for (key, value) in fields {
        if let Some(value) = value {
            put(key, json!(value));
        }
    }
}

fn put_points(put: &mut dyn FnMut(&str, Value), prefix: &str, axes: PerAxis<bool>, to: impl Index<Axis, Output = f64>) {
    put_some_points(put, prefix, PerAxis::from_fn(|axis| axes[axis].then_some(to[axis])));
}

fn put_some_points(put: &mut dyn FnMut(&str, Value), prefix: &str, to: PerAxis<Option<f64>>) {
    for (axis, value) in to.iter() {
        if let Some(value) = value {
            put(&format!("{prefix}{}", axis_key(axis)), json!(value));
        }
    }
}

fn put_both(put: &mut dyn FnMut(&str, Value), first: (&str, Value), second: (&str, Value)) {
    put(first.0, first.1);
    put(second.0, second.1);
}

fn put_feed(put: &mut dyn FnMut(&str, Value), feed: Feed) {
    match feed {
        Feed::PerMinute(value) => put("f", json!(value)),
        Feed::PerRev(value) => {
            put("f", json!(value));
            put("per", json!("rev"));
        }
    }
}

impl fmt::Display for Op {
    /// One line: the name, then key and value of every field, as in the JSON form.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())?;
        let mut written = Ok(());
        self.fields(PerAxis([true; 3]), &mut |key, value| {
            written = written.and_then(|()| match value.as_f64() {
                Some(number) => write!(f, " {key}={}", Rounded(number)),
                None => write!(f, " {key}={value}"),
            });
        });
        written?;
        let Some((words, incremental)) = self.programmed_axes() else { return Ok(()) };
        f.write_str(" [")?;
        for axis in words.iter() {
            write!(f, "{axis}{}", if incremental.contains(axis) { "+" } else { "" })?;
        }
        f.write_str("]")
    }
}

/// A number with at most six decimals and no trailing zeros.
struct Rounded(f64);

impl fmt::Display for Rounded {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = format!("{:.6}", self.0);
        let text = text.trim_end_matches('0').trim_end_matches('.');
        f.write_str(if text == "-0" { "0" } else { text })
    }
}
