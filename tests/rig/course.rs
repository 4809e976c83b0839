//! What an operator sees of a story: the values of state, alarms, messages and outputs, one after the other, without the
//! times; and where the axes stand after each part of it.

use std::collections::BTreeMap;

use kt830::defs::signal::Output;
use kt830::host::Host;
use kt830::link::snapshot::Snapshot;
use kt830::story::Stage;
use kt830::units::Axis;

/// The values of each quantity, each once until it changes.
#[derive(Debug, Default, PartialEq)]
pub struct Course {
    /// By the name of the quantity.
    pub values: BTreeMap<String, Vec<String>>,
    /// X and Z of the machine, mm, after each part of the story.
    pub positions: Vec<[f64; 2]>,
}

/// Most distance of the axes on two machines, mm: an emergency stop meets them in a move.
const SAME_PLACE_MM: f64 = 0.5;
/// The same at the end, where they are homed.
const SAME_END_MM: f64 = 0.01;

impl Course {
    fn see(&mut self, quantity: &str, value: String) {
        match self.values.get_mut(quantity) {
            Some(values) if values.last() == Some(&value) => {}
            Some(values) => values.push(value),
            None => drop(self.values.insert(quantity.to_owned(), vec![value])),
        }
    }

    fn look(&mut self, snapshot: &Snapshot) {
        self.see("state", format!("{:?}", snapshot.state));
        self.see("mode", format!("{:?}", snapshot.mode));
        self.see("page", format!("{:?}", snapshot.page));
        self.see("parts", snapshot.parts_counted.to_string());
        self.see("message", snapshot.message.text.en().to_string());
        for axis in [Axis::X, Axis::Z] {
            self.see(&format!("{axis} homed"), snapshot.axes[axis].homed.to_string());
        }
        let alarms = snapshot.alarms.iter().map(|alarm| format!("{} {}", alarm.number, alarm.text.en()));
        self.see("alarms", alarms.collect::<Vec<_>>().join(", "));
        for output in [Output::Wheel, Output::Coolant, Output::Hydraulic, Output::HeadstockLow, Output::HeadstockHigh] {
            self.see(&format!("output {output:?}"), snapshot.outputs.has(output).to_string());
        }
    }

    /// Where two courses differ: a line for each quantity.
    pub fn differences(&self, other: &Self) -> Vec<String> {
        let differs = |(quantity, values): (&String, &Vec<String>)| {
            let others = other.values.get(quantity)?;
            (others != values).then(|| format!("{quantity}: {values:?}\n    other: {others:?}"))
        };
        let mut found: Vec<String> = self.values.iter().filter_map(differs).collect();
        let last = self.positions.len().saturating_sub(1);
        for (part, (here, there)) in self.positions.iter().zip(&other.positions).enumerate() {
            let off = here.iter().zip(there).map(|(here, there)| (here - there).abs()).fold(0.0, f64::max);
            if off > if part == last { SAME_END_MM } else { SAME_PLACE_MM } {
                found.push(format!("positions after part {part}: {here:?}, other: {there:?}"));
            }
        }
        found
    }
}

/// A stage whose course is noted, tick by tick.
pub struct Observed<'a, G: Stage> {
    /// The stage.
    pub stage: &'a mut G,
    /// What was seen.
    pub course: Course,
}

impl<G: Stage> Observed<'_, G> {
    /// Notes where the axes stand.
    pub fn end_part(&mut self) {
        let axes = &self.stage.host().snapshot().axes;
        self.course.positions.push([axes[Axis::X].machine, axes[Axis::Z].machine]);
    }

    /// Notes what is seen now.
    pub fn look(&mut self) {
        self.course.look(self.stage.host().snapshot());
    }
}

impl<G: Stage> Stage for Observed<'_, G> {
    type Machine = G::Machine;
    type Storage = G::Storage;

    fn host(&mut self) -> &mut Host<G::Machine, G::Storage> {
        self.stage.host()
    }

    fn step(&mut self) {
        self.stage.step();
        self.look();
    }

    fn power_cut(&mut self) {
        self.stage.power_cut();
    }

    fn power_on(&mut self) {
        self.stage.power_on();
    }

    fn is_interrupted(&self) -> bool {
        self.stage.is_interrupted()
    }
}
