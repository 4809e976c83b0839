//! Variable access while a block is read: local, common, modal and system variables. Source: spec B3.

use std::sync::Arc;

use super::common_variables::CommonVariables;
use super::expression::{CoordinateFrame, Locals, Scope, Value};
use super::external_state::{ExternalState, LiveValue};
use super::fault::{E, ErrorAt, ReadResult, ReadStop, fail1};
use super::modal::{DiameterProgramming, ModalState};
use super::settings::NcSettings;
use super::source::Source;
use crate::defs::text::arg::Arg;
use crate::defs::{program_number, system_variable};
use crate::units::{Axis, MM_PER_INCH, WorkPos};

/// First system variables of the axis positions, machine and work coordinates; they count the machine's axes only.
const FIRST_MACHINE_POSITION: u32 = 5_021;
const FIRST_WORK_POSITION: u32 = 5_041;

/// A use of null as 0: text, byte and variable.
pub(crate) type NullUse = (Arc<Source>, usize, u32);

/// Variable access while a block is read.
pub(crate) struct LiveScope<'w> {
    pub locals: &'w Locals,
    pub common_variables: &'w CommonVariables,
    pub modals: &'w ModalState,
    pub settings: &'w NcSettings,
    pub block_number: Option<u32>,
    /// Collects the variables that are read; only for a check.
    pub used_variables: Option<&'w mut Vec<u32>>,
    pub null_uses: &'w mut Option<Vec<NullUse>>,
    pub last_null: u32,
    pub warnings: &'w mut Option<Vec<ErrorAt>>,
    pub source: &'w Arc<Source>,
    /// Every IF is read as if its condition held.
    pub conditions_hold: bool,
    pub world: &'w mut dyn ExternalState,
}

impl LiveScope<'_> {
    /// The position at the start of the block.
    #[inline]
    pub fn position(&self) -> WorkPos {
        self.world.position()
    }

    /// Adds a warning: allowed but rarely intended.
    pub fn warn(&mut self, at: usize, error: E, details: [Arg; 2]) {
        if let Some(notes) = self.warnings {
            notes.push(ErrorAt { at, error, details });
        }
    }
}

impl Scope for LiveScope<'_> {
    const HAS_VALUES: bool = true;

    fn read(&mut self, number: u32, at: usize) -> ReadResult<Value> {
        let value = self.look_up(number, at)?;
        if let Some(used) = &mut self.used_variables {
            used.push(number);
        }
        if value.is_none() {
            self.last_null = number;
        }
        Ok(value)
    }

    fn axis_position(&mut self, axis: Axis, frame: CoordinateFrame, at: usize) -> ReadResult<Value> {
        let present = |axis: &Axis| self.settings.axes[*axis];
        if !present(&axis) {
            return fail1(at, E::NoAxis, axis.letter());
        }
        let index = Axis::ALL.into_iter().filter(present).take_while(|other| *other != axis).count() as u32;
        let first = match frame {
            CoordinateFrame::Machine => FIRST_MACHINE_POSITION,
            CoordinateFrame::Work => FIRST_WORK_POSITION,
        };
        let position = self.look_up(first + index, at)?;
        // As X words are read: `X=$AA_IW[X]` is no move.
        let is_radius = axis == Axis::X && self.settings.diameter && self.modals.diameter == DiameterProgramming::Off;
        Ok(if is_radius { position.map(|diameter| diameter / 2.0) } else { position })
    }

    fn assumes_conditions(&self) -> bool {
        self.conditions_hold
    }

    fn null_used(&mut self, at: usize) {
        if let Some(nulls) = self.null_uses {
            nulls.push((Arc::clone(self.source), at, self.last_null));
        }
    }
}

impl LiveScope<'_> {
    fn look_up(&mut self, number: u32, at: usize) -> ReadResult<Value> {
        match number {
            0 => Ok(None),
            1..=33 => Ok(self.locals[number as usize - 1]),
            3100 => Ok(None),
            3101 => Ok(Some(std::f64::consts::PI)),
            3102 => Ok(Some(std::f64::consts::E)),
            4114 => Ok(self.block_number.map(f64::from)),
            // DECISION: a program with a name and no number is 0.
            4115 => Ok(Some(
                Some(self.source.number()).filter(|number| !program_number::is_named(*number)).map_or(0.0, f64::from),
            )),
            4000..=4200 => self
                .modals
                .variable(number, self.settings.is_mill())
                .map_or_else(|| fail1(at, E::BadVariable, format_args!("#{number}")), Ok),
            434..=439 | 1000.. => match self.world.system_variable(number) {
                LiveValue::Value(Some(length))
                    if self.modals.inch
                        && (system_variable::is_position(number) || system_variable::is_origin(number)) =>
                {
                    Ok(Some(length / MM_PER_INCH))
                }
                LiveValue::Value(value) => Ok(value),
                LiveValue::Drain => Err(ReadStop::Drain),
                LiveValue::Unknown => fail1(at, E::BadVariable, format_args!("#{number}")),
            },
            _ => self.common_variables.get(number).or_else(|_| fail1(at, E::BadVariable, format_args!("#{number}"))),
        }
    }
}
