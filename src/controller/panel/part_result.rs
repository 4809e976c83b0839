//! The part that a cycle has finished: taken at the end of the program with the values as they are then.
//! Source: spec K4.5, K7.2.

use super::edit_protection::check_not_running;
use super::{Edited, Panel, Parts, PartsView, offsets};
use crate::controller::plant::{FinishedCycle, Plant};
use crate::defs::text::{Text, phrase};
use crate::link::cycle::CycleView;
use crate::link::part_result::{MAX_CORRECTION, OffsetInForce, PartCommand, PartResult, SizeValues, TYPED_SIZE_RANGE};
use crate::units::Axis;

const NO_PART: Text = Text::new("没有这一件的结果", "there is no result of this part");
const NO_NOMINAL: Text = Text::new("这一件没有公称尺寸", "the part has no nominal size");
const CORRECTED: Text = Text::new("这一件已经修正过", "this part has been corrected already");
const NO_OFFSET: Text = Text::new("这一件的尺寸不由刀补决定", "no offset decides the size of this part");

/// Geometry and wear of an axis in a tool offset, mm; none for offset 0.
fn offset_mm(plant: &Plant, number: usize, axis: Axis) -> Option<f64> {
    let (index, offsets) = (number.checked_sub(1)?, &plant.work.offsets);
    Some(offsets.geometry.get(index)?[axis] + offsets.wear.get(index)?[axis])
}

impl Panel {
    /// Takes the result at the end of a cycle; a cycle start by the operator clears it.
    pub fn follow_cycle(&mut self, plant: &Plant) {
        let cycle = plant.execution.finished_cycle;
        let known = self.part_result.map(|part| part.ended_at);
        if cycle.map(|cycle| cycle.ended_at) != known {
            self.part_result = cycle.map(|cycle| self.result_of(plant, cycle));
            let finished = self.part_result.map(|part| (part.program, part.times));
            self.cycle_before = finished.or(self.cycle_before);
        }
        // The part says nothing of an offset that was changed since: typed, set by another wheel.
        if let Some(part) = self.part_result.as_mut().filter(|part| part.corrected.is_none()) {
            let is_same = |offset: &OffsetInForce| {
                offset_mm(plant, offset.number, offset.axis)
                    .is_some_and(|now| now.to_bits() == offset.offset_mm.to_bits())
            };
            part.offset = part.offset.filter(is_same);
        }
    }

    /// The running or last cycle.
    pub fn cycle_view(&self, parts: PartsView<'_>) -> CycleView {
        let started = parts.program.started_at();
        let execution = &parts.plant.execution;
        let times = started
            .map_or(execution.last_times, |at| execution.phases.times(parts.plant.now.since(at), parts.plant.now));
        let of_program = started.is_none() || parts.program.runs_program();
        let before = self.cycle_before.filter(|(program, _)| *program == execution.current_program);
        let before = before.filter(|_| of_program).map(|(_, times)| times);
        CycleView { times, phase: execution.phases.phase(), part: self.part_result, before }
    }

    fn result_of(&self, plant: &Plant, cycle: FinishedCycle) -> PartResult {
        let FinishedCycle { number, program, ended_at, times } = cycle;
        let page = self.screens.find(program).and_then(|files| files.text.as_ref().ok());
        let variable = |variable: u16| plant.work.variables.get(u32::from(variable)).ok().flatten();
        let values = SizeValues { params: &plant.params, page: page.map(AsRef::as_ref), variable };
        let (nominal, measured) = (values.nominal(), values.measured());
        let (number_in_force, axis) = (plant.work.offsets.tool_offset, plant.kind.row().wheel_axis);
        let offset = offset_mm(plant, number_in_force, axis).map(|offset_mm| {
            let displayed_per_mm = plant.displayed_per_mm(axis);
            OffsetInForce { number: number_in_force, axis, displayed_per_mm, offset_mm }
        });
        let gauged = plant.execution.gauged;
        let (typed, corrected) = (None, None);
        PartResult { number, program, ended_at, times, nominal, measured, typed, gauged, offset, corrected }
    }

    /// What the operator does with the part of the last cycle.
    pub fn handle_part_command(&mut self, parts: &mut Parts<'_>, command: PartCommand) -> Edited {
        let Some(part) = &mut self.part_result else { return Err(NO_PART.into()) };
        match command {
            PartCommand::TypeSize(mm) => {
                let Some(nominal) = part.nominal else { return Err(NO_NOMINAL.into()) };
                let wanted = nominal.mm;
                if (mm - wanted).abs() > TYPED_SIZE_RANGE {
                    return Err(phrase!(
                        "实测 {mm:.3} 与公称 {wanted:.3} 相差 1 mm 以上：检查数值",
                        "measured {mm:.3} is more than 1 mm from the nominal {wanted:.3}: check the value",
                        mm,
                        wanted
                    ));
                }
                part.typed = Some(mm);
                Ok(phrase!("工件实测 {mm:.4}", "part measured {mm:.4}", mm))
            }
            PartCommand::Correct { ended_at, increment } => {
                if part.ended_at != ended_at {
                    return Err(NO_PART.into());
                }
                if part.corrected.is_some() {
                    return Err(CORRECTED.into());
                }
                let Some(offset) = part.offset.filter(|_| !part.gauged) else { return Err(NO_OFFSET.into()) };
                check_not_running(parts.view())?;
                if increment.abs() > MAX_CORRECTION + 1e-9 {
                    return Err(phrase!(
                        "一次修正最大 ±{MAX_CORRECTION:.3}",
                        "one correction is at most ±{MAX_CORRECTION:.3}",
                        MAX_CORRECTION
                    ));
                }
                let told = offsets::add_wear(parts, offset.number, offset.axis, increment)?;
                part.corrected = Some(increment);
                Ok(told)
            }
        }
    }
}
