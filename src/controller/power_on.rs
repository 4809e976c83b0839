//! State of the control at power-on.

use std::sync::Arc;

use crate::defs::alarm_history::PastAlarm;
use crate::defs::hour_record::HourRecord;
use crate::defs::kind::Kind;
use crate::defs::leadscrew::LeadscrewCompensation;
use crate::defs::param::Params;
use crate::defs::part_record::PartRecord;
use crate::defs::production_order::ProductionOrder;
use crate::defs::variable_name;
use crate::defs::wheel_record::WheelRecord;
use crate::link::page_command::KeptState;
use crate::nc::{CommonVariables, WorkOffsets};
use crate::units::PerAxis;

/// State of the control at power-on, from the retained store.
#[derive(Clone, Debug)]
pub struct PowerOnState {
    /// Parameters.
    pub params: Params,
    /// Macro variables.
    pub variables: CommonVariables,
    /// Work offsets and tool offsets.
    pub work_offsets: WorkOffsets,
    /// Dressing points, machine coordinates, radius mm (K4.2); `None` where not set.
    pub dress_points: PerAxis<Option<f64>>,
    /// Leadscrew compensation tables of the axes (B7).
    pub leadscrew_tables: PerAxis<LeadscrewCompensation>,
    /// Number of the current program; 0 for none.
    pub current_program: u32,
    /// Workpiece count.
    pub part_count: u32,
    /// Program and line (from 1) of a run that a power failure interrupted.
    pub interrupted: Option<(u32, u32)>,
    /// Alarm history.
    pub alarm_history: Vec<PastAlarm>,
    /// Finished parts.
    pub parts: Vec<PartRecord>,
    /// Hours of the machine.
    pub hours: Vec<HourRecord>,
    /// Production orders by their numbers.
    pub orders: Vec<ProductionOrder>,
    /// The wheels of the shop by their numbers.
    pub wheels: Vec<WheelRecord>,
    /// Date set at the machine minus the system clock, s.
    pub clock_offset_s: i64,
    /// Number of wrong passwords in a row before the power went.
    pub wrong_passwords: u32,
    /// Earlier states that may take the place of lost data, the newest first; none unless data were lost.
    pub kept_states: Arc<[KeptState]>,
}

impl PowerOnState {
    /// Factory state of a kind of machine.
    #[must_use]
    pub fn factory(kind: Kind) -> Self {
        let mut variables = CommonVariables::default();
        for (number, value) in kind.row().factory.r_parameters {
            if let Some(variable) = variable_name::variable_of_r(u32::from(*number)) {
                let _ = variables.set(variable, Some(*value)); // an R parameter is a common variable
            }
        }
        Self {
            params: Params::factory(kind),
            variables,
            work_offsets: WorkOffsets::default(),
            dress_points: PerAxis::default(),
            leadscrew_tables: PerAxis::default(),
            current_program: 0,
            part_count: 0,
            interrupted: None,
            alarm_history: Vec::new(),
            parts: Vec::new(),
            hours: Vec::new(),
            orders: Vec::new(),
            wheels: Vec::new(),
            clock_offset_s: 0,
            kept_states: Arc::from([]),
            wrong_passwords: 0,
        }
    }
}
