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
use crate::defs::system_variable::{self, VariableAccess};
use crate::defs::text::arg::Arg;

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
                let value = value.unwrap_or(0.0);
                let Some(number) = whole_number(value).filter(|number| (0..=999).contains(number)) else {
                    return fail2(at, E::OutOfRange, format_args!("#{variable}={value}"), "0–999");
                };
                let number = number as u32;
                block.ops.push(if variable == 3000 {
                    Op::Alarm { number: 3000 + number, text }
                } else {
                    Op::StopWithMessage { number, text }
                });
            }
            3003 | 3004 => {
                let (most, range) = if variable == 3003 { (3, "0–3") } else { (7, "0–7") };
                let wanted = value.unwrap_or(0.0);
                let Some(whole) = whole_number(wanted).filter(|whole| (0..=most).contains(whole)) else {
                    return fail2(at, E::OutOfRange, format_args!("#{variable}={wanted}"), range);
                };
                if let (3004, 1.., Some(notes)) = (variable, whole, &mut self.warnings) {
                    notes.push(ErrorAt { at, error: E::HoldNotInhibited, details: Default::default() });
                }
                block.ops.push(Op::SetSystemVariable { number: variable, value: Some(wanted) });
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
                    block.ops.push(Op::SetSystemVariable { number: variable, value });
                }
                None => return fail1(at, E::BadVariable, name()),
            },
        }
        Ok(())
    }
}
