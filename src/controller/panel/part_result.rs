//! The part that a cycle has finished: taken at the end of the program with the values as they are then.
//! Source: spec K4.5, K7.2.

use super::{Panel, PartsView};
use crate::controller::plant::{FinishedCycle, Plant};
use crate::link::cycle::CycleView;
use crate::link::part_result::{PartResult, SizeValues};

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
        PartResult { number, program, ended_at, times, nominal, measured }
    }
}
