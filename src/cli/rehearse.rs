//! The rehearsal of a program against its part: no move may bring the wheel's rim inside the finished diameter (beyond that of a bore), as the
//! program's own variables name it. The moves are those of the check; nothing runs. Source: spec S5.

use std::collections::BTreeMap;

use crate::defs::kind::System;
use crate::defs::r_parameter;
use crate::defs::text::Said;
use crate::io::sim::FinishedFile;
use crate::nc::{Block, Memory, Op, Place};
use crate::units::{Axis, PerAxis};

/// Rounding of the text: a size is reached, not passed, within this, mm of diameter.
const SLACK_MM: f64 = 0.000_5;

/// Where the program would pass the finished size.
#[derive(Clone, Debug)]
pub struct Passed {
    /// The block that set the value which leads there; the move itself if no variable does.
    pub at: Place,
    /// The variable that it set.
    pub variable: Option<u32>,
    /// What is wrong.
    pub said: Said,
}

/// Follows the blocks of a check.
pub struct Rehearsal {
    finished: FinishedFile,
    wheel_width_mm: f64,
    system: System,
    from: PerAxis<f64>,
    values: Memory,
    /// Where each variable was last set, and the how-manieth setting that was.
    set_at: BTreeMap<u32, (u64, Place)>,
    settings: u64,
    passed: Option<Passed>,
}

impl Rehearsal {
    /// Begins where the check begins: work coordinates, radius mm, and the variables' values.
    #[must_use]
    pub fn new(
        finished: FinishedFile,
        wheel_width_mm: f64,
        system: System,
        (from, values): (PerAxis<f64>, Memory),
    ) -> Self {
        Self { finished, wheel_width_mm, system, from, values, set_at: BTreeMap::new(), settings: 0, passed: None }
    }

    /// Looks at a block; `used` are the variables that its words were calculated with.
    pub fn see(&mut self, block: &Block) {
        for op in &block.ops {
            match op {
                Op::Set { variable, value } => {
                    let _ = self.values.set(*variable, *value); // the check has accepted it
                    self.settings += 1;
                    self.set_at.insert(*variable, (self.settings, block.at));
                }
                Op::Rapid { to, .. } | Op::Feed { to, .. } | Op::Arc { to, .. } | Op::Skip { to, .. } => {
                    if self.passed.is_none() {
                        self.passed = self.passes(*to, block);
                    }
                    self.from = *to;
                }
                _ => {}
            }
        }
    }

    /// What was found.
    #[must_use]
    pub fn passed(self) -> Option<Passed> {
        self.passed
    }

    fn value(&self, number: u16) -> Option<f64> {
        self.values.get(u32::from(number)).ok().flatten()
    }

    fn passes(&self, to: PerAxis<f64>, block: &Block) -> Option<Passed> {
        let (size, wheel) = (self.value(self.finished.size)?, self.value(self.finished.wheel)?);
        let inside = self.finished.inside;
        // How far the rim is beyond the finished diameter, and where it would stand.
        let beyond = |(x, z): (f64, f64)| {
            let size = size + self.cone_mm(z);
            if inside { (2.0 * x + wheel - size, 2.0 * x + wheel) } else { (size - 2.0 * x + wheel, 2.0 * x - wheel) }
        };
        let worst = self.ends_on_the_part(to)?.map(beyond).into_iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
        if worst.0 <= SLACK_MM {
            return None;
        }
        let (reached, size) = (worst.1, if inside { worst.1 - worst.0 } else { worst.1 + worst.0 });
        let (than_zh, than_en) = if inside { ("大于", "above") } else { ("小于", "below") };
        let latest =
            block.used.iter().filter_map(|used| self.set_at.get(used).map(|at| (at, *used))).max_by_key(|at| at.0.0);
        let at = latest.map_or(block.at, |((_, at), _)| *at);
        let name = r_parameter::name(u32::from(self.finished.size), self.system);
        let by = latest.map(|(_, used)| {
            let value = self.values.get(used).ok().flatten().unwrap_or_default();
            format!("{}={value:.3} ", r_parameter::name(used, self.system))
        });
        let by = by.unwrap_or_default();
        let said = Said::new(
            format!("进刀越过 {name}：{by}使直径到 {reached:.3}，{than_zh} {name}={size:.3}；没有运行"),
            format!(
                "infeed passes {name}: {by}leads to the diameter {reached:.3}, {than_en} {name}={size:.3}; it was not run"
            ),
        );
        Some(Passed { at, variable: latest.map(|(_, used)| used), said })
    }

    /// How much larger than its size a cone is at Z, mm of diameter.
    fn cone_mm(&self, z: f64) -> f64 {
        let value = |number| self.value(number).unwrap_or_default();
        let rise = |(angle, from): (u16, u16)| 2.0 * (value(from) - z) * value(angle).to_radians().tan();
        self.finished.cone.map_or(0.0, rise)
    }

    /// Where a straight way begins and ends over the part, X as a radius and Z; none beside it.
    fn ends_on_the_part(&self, to: PerAxis<f64>) -> Option<[(f64, f64); 2]> {
        let (low, high) = (self.finished.z_from - self.wheel_width_mm, self.finished.z_to);
        let (a, b) = (self.from[Axis::Z], to[Axis::Z]);
        let over = |z: f64| z > low && z < high;
        let share = |z: f64| if (b - a).abs() > 0.0 { ((z - a) / (b - a)).clamp(0.0, 1.0) } else { 0.0 };
        if !over(a) && !over(b) && (a <= low) == (b <= low) {
            return None;
        }
        let place = |share: f64| {
            let along = |axis: Axis| self.from[axis] + (to[axis] - self.from[axis]) * share;
            (along(Axis::X), along(Axis::Z))
        };
        let ends = if (b - a).abs() > 0.0 { [share(low), share(high)] } else { [0.0, 1.0] };
        Some(ends.map(place))
    }
}
