//! Checks a program against the finished size of its part: no move may bring the wheel inside the finished diameter (of
//! a bore: outside it), as given by its variables. Uses the moves of the check; nothing runs. Source: spec S5.

use std::collections::BTreeMap;

use crate::defs::kind::Dialect;
use crate::defs::text::LocalizedText;
use crate::defs::variable_name;
use crate::io::sim::FinishedSizeFile;
use crate::nc::{Block, BlockLocation, CommonVariables, OfflineMachine, OpEffect};
use crate::units::{Axis, WorkPos};

/// Rounding tolerance of a size, mm of diameter.
const SLACK_MM: f64 = 0.000_5;

/// A move beyond the finished size.
#[derive(Clone, Debug)]
pub struct Overshoot {
    /// The block that set the variable which causes it, otherwise the move itself.
    pub at: BlockLocation,
    /// The variable that this block set.
    pub variable: Option<u32>,
    /// The message.
    pub message: LocalizedText,
}

/// Executes the blocks of a check.
pub struct FinishedSizeCheck {
    finished: FinishedSizeFile,
    wheel_width_mm: f64,
    dialect: Dialect,
    world: OfflineMachine,
    values: CommonVariables,
    /// The last assignment of each variable: its sequence number and its block.
    set_at: BTreeMap<u32, (u64, BlockLocation)>,
    assignments: u64,
    overshoot: Option<Overshoot>,
}

impl FinishedSizeCheck {
    /// Starts with the state of the check: the machine and the variables' values.
    #[must_use]
    pub fn new(
        finished: FinishedSizeFile,
        wheel_width_mm: f64,
        dialect: Dialect,
        world: OfflineMachine,
        values: CommonVariables,
    ) -> Self {
        let set_at = BTreeMap::new();
        Self { finished, wheel_width_mm, dialect, world, values, set_at, assignments: 0, overshoot: None }
    }

    /// Checks a block. `line` returns the text of a block; the variables in its axis words are read from it.
    pub fn check_block(&mut self, block: &Block, line: &dyn Fn(BlockLocation) -> String) {
        let mut path = Vec::new();
        for op in &block.ops {
            path.clear();
            self.world.apply_traced(op, |from, segment| path.push((from, segment.to)));
            if self.overshoot.is_none() {
                self.overshoot = path.iter().find_map(|path| self.overshoot_of(*path, block, line));
            }
            match op.effect() {
                OpEffect::Variable(variable, value) => {
                    let _ = self.values.set(variable, value); // the check has accepted it
                    self.assignments += 1;
                    self.set_at.insert(variable, (self.assignments, block.location));
                }
                // The check world follows position and work coordinates.
                OpEffect::Motion(_) | OpEffect::Coordinates(_) | OpEffect::IndexTurret { .. } => {}
                OpEffect::Oscillation(_) | OpEffect::PathMode(_) | OpEffect::Dwell(_) | OpEffect::MCode(_) => {}
                OpEffect::Speed(..) | OpEffect::SpeedLimit(_) => {}
                OpEffect::SystemVariable(..) | OpEffect::Message(_) => {}
            }
        }
    }

    /// The overshoot found, if any.
    #[must_use]
    pub fn into_overshoot(self) -> Option<Overshoot> {
        self.overshoot
    }

    fn value(&self, number: u16) -> Option<f64> {
        self.values.get(u32::from(number)).ok().flatten()
    }

    fn overshoot_of(
        &self,
        path: (WorkPos, WorkPos),
        block: &Block,
        line: &dyn Fn(BlockLocation) -> String,
    ) -> Option<Overshoot> {
        let (size, wheel) = (self.value(self.finished.size)?, self.value(self.finished.wheel)?);
        let inside = self.finished.inside;
        // Distance of the wheel beyond the finished diameter, and the diameter it reaches.
        let beyond = |(x, z): (f64, f64)| {
            let size = size + self.cone_mm(z);
            if inside { (2.0 * x + wheel - size, 2.0 * x + wheel) } else { (size - 2.0 * x + wheel, 2.0 * x - wheel) }
        };
        let worst = self.path_over_part(path)?.map(beyond).into_iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
        if worst.0 <= SLACK_MM {
            return None;
        }
        let (reached, size) = (worst.1, if inside { worst.1 - worst.0 } else { worst.1 + worst.0 });
        let (than_zh, than_en) = if inside { ("大于", "above") } else { ("小于", "below") };
        // Only variables in axis words count, not in feed words.
        let led = axis_word_parameters(&line(block.location));
        let set = block.used_variables.iter().filter(|used| led.contains(used));
        let latest = set.filter_map(|used| self.set_at.get(used).map(|at| (at, *used))).max_by_key(|at| at.0.0);
        let at = latest.map_or(block.location, |((_, at), _)| *at);
        let name = variable_name::variable_name(u32::from(self.finished.size), self.dialect);
        let by = latest.map(|(_, used)| {
            let value = self.values.get(used).ok().flatten().unwrap_or_default();
            format!("{}={value:.3} ", variable_name::variable_name(used, self.dialect))
        });
        let by = by.unwrap_or_default();
        let message = LocalizedText::new(
            format!("进刀越过 {name}：{by}使直径到 {reached:.3}，{than_zh} {name}={size:.3}；没有运行"),
            format!(
                "infeed goes past {name}: {by}gives diameter {reached:.3}, {than_en} {name}={size:.3}; not executed"
            ),
        );
        Some(Overshoot { at, variable: latest.map(|(_, used)| used), message })
    }

    /// Diameter of a cone at Z minus its size, mm.
    fn cone_mm(&self, z: f64) -> f64 {
        let value = |number| self.value(number).unwrap_or_default();
        let rise = |(angle, from): (u16, u16)| 2.0 * (value(from) - z) * value(angle).to_radians().tan();
        self.finished.cone.map_or(0.0, rise)
    }

    /// Start and end of a straight path over the part (X radius, Z); `None` if it is beside the part.
    fn path_over_part(&self, (from, to): (WorkPos, WorkPos)) -> Option<[(f64, f64); 2]> {
        let (low, high) = (self.finished.z_from - self.wheel_width_mm, self.finished.z_to);
        let (a, b) = (from[Axis::Z], to[Axis::Z]);
        let over = |z: f64| z > low && z < high;
        let share = |z: f64| if (b - a).abs() > 0.0 { ((z - a) / (b - a)).clamp(0.0, 1.0) } else { 0.0 };
        if !over(a) && !over(b) && (a <= low) == (b <= low) {
            return None;
        }
        let place = |share: f64| {
            let along = |axis: Axis| from[axis] + (to[axis] - from[axis]) * share;
            (along(Axis::X), along(Axis::Z))
        };
        let ends = if (b - a).abs() > 0.0 { [share(low), share(high)] } else { [0.0, 1.0] };
        Some(ends.map(place))
    }
}

/// The R parameters (as variables) in the position words of a block: X, Y, Z, I, J, K and CR.
fn axis_word_parameters(line: &str) -> Vec<u32> {
    let code = line.split(';').next().unwrap_or_default().to_ascii_uppercase();
    let (bytes, mut found, mut leads, mut at) = (code.as_bytes(), Vec::new(), false, 0);
    let count =
        |from: usize, is: fn(&u8) -> bool| bytes.get(from..).unwrap_or_default().iter().take_while(|b| is(b)).count();
    while at < bytes.len() {
        let letters = count(at, u8::is_ascii_alphabetic);
        if letters == 0 {
            at += 1;
            continue;
        }
        let (word, digits) = (&code[at..at + letters], count(at + letters, u8::is_ascii_digit));
        at += letters + digits;
        let rest = code[at..].trim_start();
        let assigns = rest.starts_with('=') && !rest.starts_with("==");
        if word == "R" && digits > 0 && !assigns {
            if let Some(variable) = variable_name::parse(&code[at - digits - 1..at]).filter(|_| leads) {
                found.push(u32::from(variable));
            }
        } else if assigns || digits > 0 {
            leads = matches!(word, "X" | "Y" | "Z" | "I" | "J" | "K" | "CR");
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nc::{AxisSet, Feed, NcSettings, Op};
    use crate::units::PerAxis;

    /// The size check of a bore-free part of 100 mm from Z0 to Z50 with a wheel of 0 mm, from X60 Z100.
    fn overshoot_after(ops: Vec<Op>) -> Option<Overshoot> {
        let settings = NcSettings::for_dialect(Dialect::Sinumerik);
        let finished = FinishedSizeFile { size: 620, wheel: 621, z_from: 0.0, z_to: 50.0, inside: false, cone: None };
        let world = OfflineMachine::new(&settings).with_position(WorkPos::new([60.0, 0.0, 100.0]));
        let mut values = CommonVariables::default();
        values.set(620, Some(100.0)).unwrap();
        values.set(621, Some(0.0)).unwrap();
        let mut check = FinishedSizeCheck::new(finished, 0.0, settings.dialect, world, values);
        let block = Block { ops, ..Block::new(&settings) };
        check.check_block(&block, &|_| String::new());
        check.into_overshoot()
    }

    fn feed_to(x: f64, z: f64) -> Op {
        let to = WorkPos::new([x, 0.0, z]);
        Op::Feed { to, feed: Feed::PerMinute(100.0), words: AxisSet::XZ, incremental: AxisSet::NONE }
    }

    /// Beside the part X may be smaller than its radius; the move back over it starts where the last one ended.
    #[test]
    fn s5_a_move_starts_where_a_machine_move_or_a_new_coordinate_system_has_left_the_axes() {
        let machine = Op::MachineMove { to: PerAxis([Some(30.0), None, None]), feed: None };
        assert!(overshoot_after(vec![feed_to(60.0, 5.0)]).is_none());
        assert!(overshoot_after(vec![machine, feed_to(60.0, 5.0)]).is_some(), "from X30 beside the part");
        let reference = Op::ReturnToReference {
            number: 1,
            via: WorkPos::new([30.0, 0.0, 100.0]),
            words: AxisSet::of(Axis::X),
            incremental: AxisSet::NONE,
        };
        assert!(overshoot_after(vec![reference, feed_to(60.0, 5.0)]).is_some(), "from X0 beside the part");
        let renamed = Op::SetCoordinateSystem { values: PerAxis([Some(30.0), None, None]) };
        assert!(overshoot_after(vec![renamed, feed_to(60.0, 5.0)]).is_some(), "the same place is X30 now");
        assert!(overshoot_after(vec![Op::SelectWorkOffset { g: 54 }, feed_to(60.0, 5.0)]).is_none());
    }

    #[test]
    fn s5_a_feed_is_no_place() {
        let of = |line: &str| axis_word_parameters(line).into_iter().map(|number| number - 600).collect::<Vec<_>>();
        assert_eq!(of("N10 G91 G1 X=-R50 F=R51 ;R1"), [50]);
        assert_eq!(of("G1 F=R51 X=2*(R21-R19)*TAN(R14) Z = R19 - R21 R7=R8"), [21, 19, 14, 19, 21]);
        assert_eq!(of("G2 X10 CR=R3 F=R4 S=R5"), [3]);
    }
}
