//! What an assignment to a variable does: variables of the program, messages and alarms, values of the machine.
//! Source: spec B3.

use std::ops::Range;

use super::block::Block;
use super::common_variables::{CommonVariables, VariableError};
use super::expression::Value;
use super::fault::{E, ErrorAt, ReadResult, fail, fail1, fail2};
use super::functions::whole_number;
use super::interpreter::Interpreter;
use super::op::Op;
use super::work_offsets::{OriginPlace, ToolOffsetPlace};
use crate::defs::grinding_phase::GrindingPhase;
use crate::defs::system_variable::{self, VariableAccess};
use crate::defs::text::arg::Arg;
use crate::units::{Axis, MM_PER_INCH};

impl Interpreter {
    /// Sets a variable. `comment` is the text of #3000 and #3006.
    pub(super) fn assign(
        &mut self,
        variable: u32,
        value: Value,
        at: usize,
        comment: Option<Range<usize>>,
        block: &mut Block,
    ) -> ReadResult<()> {
        let name = || format!("#{variable}");
        match variable {
            1..=33 => {
                self.passes.changed |= self.flow.set_local(variable, value);
            }
            3000 | 3006 => {
                let text = comment.map_or(Arg::None, |range| self.flow.source.message_text(range));
                let number = whole_up_to(999, variable, value, at)?;
                block.ops.push(if variable == 3000 {
                    Op::Alarm { number: 3000 + number, text }
                } else {
                    Op::StopWithMessage { number, text }
                });
            }
            3003 | 3004 => {
                let whole = whole_up_to(if variable == 3003 { 3 } else { 7 }, variable, value, at)?;
                if let (3004, 1.., Some(notes)) = (variable, whole, &mut self.warnings) {
                    notes.push(ErrorAt { at, error: E::HoldNotInhibited, details: Default::default() });
                }
                block.ops.push(Op::SetSystemVariable { number: variable, value: Some(f64::from(whole)) });
            }
            _ if variable == system_variable::PHASE.first => {
                let phase = whole_up_to(GrindingPhase::ALL.len() as u32, variable, value, at)?;
                block.ops.push(Op::SetSystemVariable { number: variable, value: Some(f64::from(phase)) });
            }
            _ if CommonVariables::contains(variable) => match self.change_common(variable, value) {
                Ok(()) => block.ops.push(Op::SetVariable { variable, value }),
                Err(VariableError::Switch(_)) => return fail1(at, E::SwitchVariable, name()),
                Err(VariableError::Unknown(_)) => return fail1(at, E::BadVariable, name()),
                Err(VariableError::NotFinite(_)) => return fail(at, E::Overflow),
            },
            0 => return fail1(at, E::ReadOnly, name()),
            _ => match system_variable::find(variable).map(|range| range.access) {
                Some(VariableAccess::Read) => return fail1(at, E::ReadOnly, name()),
                Some(VariableAccess::ReadWrite | VariableAccess::Write) => {
                    self.check_offset_axis(variable, at)?;
                    let is_in_inches = self.modals.inch && system_variable::is_origin(variable);
                    let value = if is_in_inches { value.map(|inches| inches * MM_PER_INCH) } else { value };
                    block.ops.push(Op::SetSystemVariable { number: variable, value });
                }
                None => return fail1(at, E::BadVariable, name()),
            },
        }
        Ok(())
    }

    /// An origin or a tool offset has an axis, which must be fitted.
    fn check_offset_axis(&self, variable: u32, at: usize) -> ReadResult<()> {
        let axes = self.settings.axes;
        let is_fitted = if let Some(place) = ToolOffsetPlace::of_variable(variable) {
            axes[place.axis]
        } else if let Some((_, index)) = OriginPlace::of_variable(variable) {
            index < Axis::ALL.into_iter().filter(|axis| axes[*axis]).count()
        } else if system_variable::is_origin(variable) {
            return fail1(at, E::BadVariable, format_args!("#{variable}"));
        } else {
            true
        };
        if is_fitted { Ok(()) } else { fail1(at, E::OffsetWithoutAxis, format_args!("#{variable}")) }
    }
}

/// The value of a variable that takes whole numbers from 0 to `most`; null is 0.
fn whole_up_to(most: u32, variable: u32, value: Value, at: usize) -> ReadResult<u32> {
    let value = value.unwrap_or(0.0);
    match whole_number(value).filter(|whole| (0..=i64::from(most)).contains(whole)) {
        Some(whole) => Ok(whole as u32),
        None => fail2(at, E::OutOfRange, format_args!("#{variable}={value}"), format_args!("0–{most}")),
    }
}
