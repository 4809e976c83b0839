//! What the operator has selected on the panel: mode, page, switches, overrides, handwheel.
//! Source: spec K2, K2.1.

use super::Plant;
use crate::defs::key::{Key, Mode};
use crate::defs::page::Page;
use crate::defs::param;
use crate::defs::text::Text;
use crate::link::snapshot::Overrides;
use crate::machine::panel_key;
use crate::motion::Override;
use crate::units::{Axis, Micros};

/// The panel switches that change how a program runs. Machine lock is a state of the axes.
#[derive(Clone, Copy, Debug, Default)]
pub struct PanelSwitches {
    /// 单段: the run stops after each block.
    pub single_block: bool,
    /// 跳段: blocks with / are skipped.
    pub block_skip: bool,
    /// 选择停: M01 stops.
    pub optional_stop: bool,
    /// M, S and T codes are read but not executed.
    pub aux_function_lock: bool,
    /// Feed moves run at P89.
    pub dry_run: bool,
}

/// Selections of the panel.
#[derive(Clone, Copy, Debug)]
pub struct OperatorState {
    /// The mode.
    pub mode: Mode,
    /// The open page.
    pub page: Page,
    /// The switches.
    pub switches: PanelSwitches,
    /// The overrides.
    pub overrides: Overrides,
    /// Rapid jog (快速) is on.
    pub rapid_jog: bool,
    /// Axis of the handwheel.
    pub handwheel_axis: Axis,
    /// Step per detent, mm as displayed.
    pub step_mm: f64,
    /// The oscillation cylinder was switched on by its key, not by a program.
    pub cylinder_by_key: bool,
    /// When the screen was last heard; `None` while it is not supervised.
    pub screen_alive_at: Option<Micros>,
}

impl Default for OperatorState {
    fn default() -> Self {
        Self {
            mode: Mode::Manual,
            page: Page::Position,
            switches: PanelSwitches::default(),
            overrides: Overrides::default(),
            rapid_jog: false,
            handwheel_axis: Axis::X,
            step_mm: 0.01,
            cylinder_by_key: false,
            screen_alive_at: None,
        }
    }
}

impl Plant {
    /// The overrides as factors for this tick.
    pub fn override_factors(&self) -> Override {
        let rapid = match self.operator.overrides.rapid {
            0 => self.params.get(param::RAPID_F0) / self.params.get(param::RAPID_X),
            percent => f64::from(percent) / 100.0,
        };
        Override { feed: f64::from(self.operator.overrides.feed) / 100.0, rapid: rapid.min(1.0) }
    }

    /// Whether nothing is really ground: machine lock, auxiliary function lock or dry run.
    pub fn is_dry_or_locked(&self) -> bool {
        let PanelSwitches { aux_function_lock, dry_run, .. } = self.operator.switches;
        self.axes.is_locked() || aux_function_lock || dry_run
    }

    /// Why a key is inactive regardless of interlocks, if it is.
    pub fn inactive_reason(&self, key: Key) -> Option<Text> {
        let phase = self.execution.phase.without_homing();
        panel_key::inactive_reason(key, self.params.fitted(), self.axes.fitted(), phase)
    }

    /// Length of a manual step, mm as displayed: P395 on a lathe if set (L9 定长进给), else the selected step.
    pub fn step_length_mm(&self) -> f64 {
        let set = self.params.get(param::FIXED_STEP_LENGTH);
        if self.kind.is_lathe() && set > 0.0 { set } else { self.operator.step_mm }
    }
}
