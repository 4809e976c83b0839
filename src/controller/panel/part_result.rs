//! The part that a cycle has finished: taken at the end of the program with the values as they are then.
//! Source: spec K4.5, K7.2.

use super::{Edited, Panel, Parts, PartsView, offsets};
use crate::controller::plant::{FinishedCycle, Plant};
use crate::defs::param;
use crate::defs::text::{LocalizedText, Text, phrase};
use crate::link::cycle::CycleView;
use crate::link::cycle_times::CycleTimes;
use crate::link::part_result::{
    MAX_CORRECTION, NominalSize, OffsetInForce, PartCommand, PartResult, SizeValues, TYPED_SIZE_RANGE,
};
use crate::units::Micros;

const NO_PART: Text = Text::new("没有这一件的结果", "there is no result of this part");
const NO_NOMINAL: Text = Text::new("这一件没有公称尺寸", "the part has no nominal size");
const CORRECTED: Text = Text::new("这一件已经修正过", "this part has been corrected already");
const IN_RUN: Text = Text::new("程序运行中不能修正", "no correction while a program runs");
const NOMINAL_CHANGED: Text =
    Text::new("这一件以后改过公称尺寸或公差", "nominal size or limits were changed after this part");
const WORN: Text = Text::new("可能是砂轮磨损：修整后再修正", "it may be wear of the wheel: dress, then correct");
const NO_OFFSET: Text = Text::new("这一件的尺寸不由刀补决定", "no offset decides the size of this part");

impl Panel {
    /// Takes the result at the end of a cycle; a cycle start by the operator clears it. A part is made where a program counts
    /// it, also in the middle of a run; the end of that run says more of the last one.
    pub fn follow_cycle(&mut self, plant: &mut Plant, started: Option<Micros>) {
        let cycle = plant.execution.finished_cycle;
        let known = self.part_result.map(|part| part.ended_at);
        let ended = cycle.filter(|cycle| Some(cycle.ended_at) != known);
        // M31 and M30 may be of one tick, and the next pass (P390) may have begun in it: the end tells what the ended run has
        // counted.
        let of_ended = ended.map_or(0, |cycle| cycle.counted.saturating_sub(self.parts_counted));
        let begun_anew = ended.is_some() || plant.execution.parts_counted < self.parts_counted;
        let before = if begun_anew { 0 } else { self.parts_counted };
        self.parts_counted = plant.execution.parts_counted;
        for _ in 0..of_ended {
            let part = self.counted_part(plant, started);
            self.production.add_part(plant, &part);
        }
        if cycle.map(|cycle| cycle.ended_at) != known {
            self.part_result = cycle.map(|cycle| self.result_of(plant, cycle));
            let finished = self.part_result.map(|part| (part.program, part.times));
            self.cycle_before = finished.or(self.cycle_before);
        }
        if let Some((cycle, part)) = ended.zip(self.part_result) {
            self.production.end_cycle(plant, &part, cycle.counted);
        }
        for _ in before..self.parts_counted {
            let part = self.counted_part(plant, started);
            self.production.add_part(plant, &part);
        }
        self.production.follow_run(started.is_some());
        self.production.announce(plant);
        // The part says nothing of an offset or a work zero that was changed since.
        if let Some(part) = self.part_result.as_mut().filter(|part| part.corrected.is_none()) {
            let is_same = |offset: &OffsetInForce| {
                let work_zero = plant.work.offsets.machine_minus_work(offset.axis);
                let displayed_per_mm = plant.displayed_per_mm(offset.axis);
                *offset == OffsetInForce { work_zero, displayed_per_mm, ..*offset }
            };
            part.offset = part.offset.filter(is_same);
        }
    }

    /// The wheel was changed: the part says nothing of the new one.
    pub const fn forget_offset_of_part(&mut self) {
        if let Some(part) = &mut self.part_result {
            part.offset = None;
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

    /// Nominal and measured size of a program's part, with the values as they are now.
    fn sizes_of(&self, plant: &Plant, program: u32) -> (Option<NominalSize>, Option<f64>) {
        let values = self.size_values(plant, program);
        (values.nominal(), values.measured())
    }

    /// The values that sizes of a program's part are taken from, as they are now.
    fn size_values<'a>(
        &'a self,
        plant: &'a Plant,
        program: u32,
    ) -> SizeValues<'a, impl Fn(u16) -> Option<f64> + use<'a>> {
        let page = self.screens.find(program).and_then(|files| files.text.as_ref().ok());
        let variable = |variable: u16| plant.work.variables.get(u32::from(variable)).ok().flatten();
        SizeValues { params: &plant.params, page: page.map(AsRef::as_ref), variable }
    }

    /// The part that a run has just counted.
    fn counted_part(&self, plant: &Plant, started: Option<Micros>) -> PartResult {
        let since = started.max(self.production.last_counted());
        let seconds = since.map_or(0.0, |since| plant.now.since(since).as_secs_f64());
        let (number, program) = (plant.work.part_count, plant.execution.current_program);
        let times = CycleTimes { seconds, ..CycleTimes::default() };
        let gauged = plant.execution.gauged;
        self.result_of(
            plant,
            FinishedCycle { number, program, ended_at: plant.now, times, gauged, offset: None, counted: 0 },
        )
    }

    fn result_of(&self, plant: &Plant, cycle: FinishedCycle) -> PartResult {
        let FinishedCycle { number, program, ended_at, times, gauged, offset, .. } = cycle;
        let (nominal, measured) = self.sizes_of(plant, program);
        let is_wheel_fresh = plant.params.get(param::PARTS_SINCE_DRESSING) <= 1.0;
        let (typed, corrected) = (None, None);
        PartResult {
            number,
            program,
            ended_at,
            times,
            nominal,
            measured,
            typed,
            gauged,
            is_wheel_fresh,
            offset,
            corrected,
        }
    }

    /// Whether a variable is the cell of the last part's page into which its measured size is typed.
    fn takes_size_of_part(&self, plant: &Plant, program: u32, variable: u16) -> bool {
        self.size_values(plant, program).typed_variable() == Some(variable)
    }

    /// A size typed on the page corrects by its program: not after a correction by the card.
    pub fn check_typed_size(&self, plant: &Plant, variable: u16) -> Result<(), LocalizedText> {
        let corrected = self.part_result.filter(|part| part.corrected.is_some());
        match corrected.filter(|part| self.takes_size_of_part(plant, part.program, variable)) {
            Some(_) => Err(CORRECTED.into()),
            None => Ok(()),
        }
    }

    /// The operator has typed a value on the page of the last part's program: if it is the measured size, the part is judged by
    /// it, unless nominal size or limits were changed since. What is far off is a typing error, which the program refuses.
    pub fn judge_by_page(&mut self, plant: &mut Plant, variable: u16, mm: f64) {
        let Some(part) = self.part_result else { return };
        let is_near = part.nominal.is_some_and(|nominal| (mm - nominal.mm).abs() <= TYPED_SIZE_RANGE);
        if !is_near
            || !self.takes_size_of_part(plant, part.program, variable)
            || self.sizes_of(plant, part.program).0 != part.nominal
        {
            return;
        }
        // The size that was told last counts.
        let judged = PartResult { measured: Some(mm), typed: None, ..part };
        self.part_result = Some(judged);
        self.production.judge_part(plant, part.ended_at, (Some(mm), judged.verdict(None)));
    }

    /// What the operator does with the part of the last cycle.
    pub fn handle_part_command(&mut self, parts: &mut Parts<'_>, command: PartCommand) -> Edited {
        let (PartCommand::TypeSize { ended_at, .. } | PartCommand::Correct { ended_at, .. }) = command;
        let Some(part) = self.part_result.filter(|part| part.ended_at == ended_at) else { return Err(NO_PART.into()) };
        let (changed, told) = match command {
            PartCommand::TypeSize { mm, .. } => {
                check_size(part, mm)?;
                let typed = PartResult { typed: Some(mm), ..part };
                self.production.judge_part(parts.plant, ended_at, (Some(mm), typed.verdict(None)));
                (typed, phrase!("工件实测 {mm:.4}", "part measured {mm:.4}", mm))
            }
            PartCommand::Correct { increment, .. } => {
                if self.sizes_of(parts.plant, part.program).0 != part.nominal {
                    return Err(NOMINAL_CHANGED.into());
                }
                let offset = check_correction(part, increment)?;
                if parts.program.is_open() {
                    return Err(IN_RUN.into());
                }
                let told = offsets::add_wear(parts, offset.number, offset.axis, increment)?;
                (PartResult { corrected: Some(increment), ..part }, told)
            }
        };
        self.part_result = Some(changed);
        Ok(told)
    }
}

/// A typed size must be near the nominal one.
fn check_size(part: PartResult, mm: f64) -> Result<(), LocalizedText> {
    let wanted = part.nominal.ok_or(NO_NOMINAL)?.mm;
    if (mm - wanted).abs() <= TYPED_SIZE_RANGE {
        return Ok(());
    }
    Err(phrase!(
        "实测 {mm:.3} 与公称 {wanted:.3} 相差 1 mm 以上：检查数值",
        "measured {mm:.3} is more than 1 mm from the nominal {wanted:.3}: check the value",
        mm,
        wanted
    ))
}

/// The offset that may be corrected by a part. The core refuses what the card does not propose.
fn check_correction(part: PartResult, increment: f64) -> Result<OffsetInForce, LocalizedText> {
    if part.corrected.is_some() {
        return Err(CORRECTED.into());
    }
    let by_offset = !part.gauged && part.measured.is_none();
    let offset = part.offset.filter(|_| by_offset).ok_or(NO_OFFSET)?;
    if !part.is_wheel_fresh {
        return Err(WORN.into());
    }
    if increment.abs() > MAX_CORRECTION + 1e-9 {
        return Err(phrase!(
            "一次修正最大 ±{MAX_CORRECTION:.3}",
            "one correction is at most ±{MAX_CORRECTION:.3}",
            MAX_CORRECTION
        ));
    }
    Ok(offset)
}
