//! `kt830 check`: checks programs, page texts and pictures; every error has its position. A program without errors runs
//! once on the simulated machine for its time.
//! Source: spec tools.md T4.

use std::path::Path;
use std::sync::Arc;

use serde_json::{Value, json};

use super::args::{CheckArgs, OutputFormat, RunArgs, SharedArgs, USUAL_HOURS};
use super::checked_file::{CheckedFileKind, file_kind};
use super::cycle_time::cycle_time;
use super::finished_size_check::{FinishedSizeCheck, Overshoot};
use super::page_text_check::english_warnings;
use super::program_places::{FileLine, ProgramPlaces};
use super::run::RunResult;
use super::setup::ProgramToRun;
use super::soft_limit_check::SoftLimitCheck;
use super::{CallError, FAILED, SUCCESS, USAGE_ERROR, print_line, setup};
use crate::controller::interlock_check::{InterlockCheck, PredictedRefusal};
use crate::controller::{PowerOnState, Programs, nc_settings, reference_points, stored_system_variables};
use crate::defs::program_error::ProgramError;
use crate::defs::text::{LocalizedText, Text};
use crate::defs::{param, program_number, variable_name};
use crate::host::bar;
use crate::host::folders::{ProgramUse, named_programs_beside, page_text_faults, parse_picture, programs_from_file};
use crate::host::headless_run::RunEnd;
use crate::host::picture_labels::parse_picture_labels;
use crate::io::sim::PartFile;
use crate::link::screens::FileFault;
use crate::link::toolpath::CycleTime;
use crate::nc::program_uses::text_row_faults;
use crate::nc::{
    BlockLocation, CheckReport, CutterShape, Library, MAX_FAULTS, NcSettings, OfflineMachine, Op, OriginPlace,
    ProgramCheck, ProgramFault, SharedLibrary, Source, WorkOffsets,
};
use crate::store::PROGRAM_LIMIT;
use crate::units::{Axis, PerAxis};

/// Prefix of a warning.
const WARNING: Text = Text::new("警告：", "warning: ");

/// The verdict without errors.
const OK: Text = Text::new("ok", "ok");

/// An error of a file.
#[derive(Clone, Debug, Default)]
struct CheckError {
    /// The file, if it is not the checked one.
    file: Option<String>,
    /// The name of the program, if it is not the checked one.
    program: Option<String>,
    line: u32,
    column: u32,
    message: String,
    /// The calls that led there, the last one first.
    calls: Vec<FileLine>,
}

impl CheckError {
    /// Place, program, message and calls.
    fn text(&self, file: &str) -> String {
        let file = self.file.as_deref().unwrap_or(file);
        let place = match self.line {
            0 => file.to_owned(),
            line => format!("{file}:{line}:{}", self.column),
        };
        let program = self.program.as_ref().map_or_else(String::new, |program| format!("{program}: "));
        let calls: Vec<_> = self.calls.iter().map(|call| format!(" ← {}:{}", call.file, call.line)).collect();
        format!("{place}: {program}{}{}", self.message, calls.concat())
    }

    fn json(&self) -> Value {
        let mut told = json!({"line": self.line, "column": self.column, "message": self.message});
        if let (Some(file), Some(program)) = (&self.file, &self.program) {
            (told["file"], told["program"]) = (json!(file), json!(program));
        }
        if !self.calls.is_empty() {
            told["calls"] = self.calls.iter().map(|call| json!({"file": call.file, "line": call.line})).collect();
        }
        told
    }
}

/// Checks every file of the call.
///
/// # Errors
/// A file cannot be read.
pub fn check(shared: &SharedArgs, call: &CheckArgs) -> Result<u8, CallError> {
    if shared.machine.is_some() && !call.simulate {
        return Err(CallError::new("--machine: a check runs on a machine only with --simulate"));
    }
    let mut status = SUCCESS;
    for path in &call.files {
        let bytes = setup::read_bounded(path, PROGRAM_LIMIT).map_err(|error| {
            CallError::new(format!("{}: {error}; check the path and the permission to read the file", path.display()))
        })?;
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let found = match file_kind(&name, &bytes) {
            CheckedFileKind::Program => FileCheck::new(shared, call, path, bytes)?.execute()?,
            CheckedFileKind::PageText => {
                print_file(shared, path, &page_text_faults(&name, &bytes), &english_warnings(path, &name, &bytes))
            }
            CheckedFileKind::Picture => print_file(shared, path, parse_picture(&name, &bytes).err().as_slice(), &[]),
            CheckedFileKind::PictureLabels => {
                print_file(shared, path, parse_picture_labels(&name, &bytes).err().as_slice(), &[])
            }
        };
        status = status.max(found);
    }
    Ok(status)
}

/// An error with a message in both languages; line and column are 0 if there is no position.
fn shared_error(shared: &SharedArgs, position: Option<(u32, u32)>, message: &LocalizedText) -> CheckError {
    let (line, column) = position.unwrap_or_default();
    CheckError { line, column, message: message.get(shared.lang).into_owned(), ..CheckError::default() }
}

/// Prints the result for a page text or picture; returns the exit status.
fn print_file(shared: &SharedArgs, path: &Path, faults: &[FileFault], warnings: &[FileFault]) -> u8 {
    let error = |fault: &FileFault| shared_error(shared, fault.position, &fault.message);
    let wrong: Vec<_> = faults.iter().map(error).collect();
    let file = path.display().to_string();
    match shared.format {
        OutputFormat::Json => {
            let warnings: Vec<_> = warnings.iter().map(error).collect();
            print_line(json!({"file": file, "errors": errors_json(&wrong), "warnings": errors_json(&warnings)}));
        }
        OutputFormat::Text => {
            for warning in warnings {
                let (place, at) = (path.with_file_name(&warning.file), error(warning));
                print_warning(shared, &place.display().to_string(), &at);
            }
            print_errors(shared, &file, &wrong, &OK.into());
        }
    }
    if wrong.is_empty() { SUCCESS } else { USAGE_ERROR }
}

fn print_warning(shared: &SharedArgs, file: &str, at: &CheckError) {
    let program = at.program.as_ref().map_or_else(String::new, |program| format!("{program}: "));
    let message = format!("{}{program}{}", WARNING.get(shared.lang), at.message);
    warn_line!("{}", CheckError { message, program: None, ..at.clone() }.text(file));
}

fn errors_json(wrong: &[CheckError]) -> Value {
    wrong.iter().map(CheckError::json).collect()
}

/// Prints every error, or the verdict if there is none.
fn print_errors(shared: &SharedArgs, file: &str, wrong: &[CheckError], verdict: &LocalizedText) {
    wrong.iter().for_each(|at| print_line(at.text(file)));
    if wrong.is_empty() {
        print_line(format!("{file}: {}", verdict.get(shared.lang)));
    }
    if wrong.len() >= MAX_FAULTS {
        let more = Text::new("错误太多，其余没有列出", "too many mistakes: the others are not listed");
        print_line(format!("{file}: {}", more.get(shared.lang)));
    }
}

/// A program under check, with what it is checked against.
struct FileCheck<'a> {
    shared: &'a SharedArgs,
    call: &'a CheckArgs,
    path: &'a Path,
    source: Arc<Source>,
    /// The other programs of its file.
    others: Vec<Arc<Source>>,
    /// The programs that it may call: those of the folder, of its file, and the named ones beside its file.
    programs: Arc<Programs>,
    places: ProgramPlaces,
    retained: PowerOnState,
    settings: NcSettings,
    part: Option<PartFile>,
}

/// Result of the check of a program.
struct CheckOutcome {
    checked: CheckReport,
    /// Errors that are not in the text: beyond the finished size or a soft limit, or refused by an interlock.
    move_errors: Vec<CheckError>,
    /// Blocks that the machine carries out otherwise than they are written.
    machine_warnings: Vec<CheckError>,
    time: CycleTime,
}

/// Adds what the check of another program has found.
fn merge_report(checked: &mut CheckReport, number: u32, found: &CheckReport) {
    checked.called.push(number);
    checked.called.extend(&found.called);
    checked.lines += found.lines;
    // A program that both call was checked with the first one.
    let CheckReport { faults, warnings, .. } = &*checked;
    let is_new = |fault: &&ProgramFault| {
        !faults.iter().chain(warnings).any(|old| old.location == fault.location && old.error == fault.error)
    };
    let faults: Vec<_> = found.faults.iter().filter(is_new).cloned().collect();
    let warnings: Vec<_> = found.warnings.iter().filter(is_new).cloned().collect();
    checked.faults.extend(faults);
    checked.warnings.extend(warnings);
}

impl<'a> FileCheck<'a> {
    fn new(shared: &'a SharedArgs, call: &'a CheckArgs, path: &'a Path, bytes: Vec<u8>) -> Result<Self, CallError> {
        let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
        let number = crate::story::parse::program(&stem).unwrap_or_else(|| program_number::from_name(&stem));
        let retained = setup::check_retained(shared)?;
        let settings = nc_settings(shared.kind, &retained.params);
        let folders = setup::folders(shared)?;
        let (mut programs, _) = folders.read_programs().unwrap_or_else(|_| (Programs::default(), Vec::new()));
        programs.replace(named_programs_beside(path, settings.dialect, ProgramUse::Execution));
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let own = programs_from_file(number, &name, bytes, settings.dialect, ProgramUse::Execution);
        let mut sources = own.iter().map(|program| Arc::clone(&program.source));
        let source = sources.next().ok_or_else(|| CallError::new(format!("{}: no program", path.display())))?;
        let number = source.number();
        let others = sources.collect();
        // The folder may hold the file itself: then it knows its programs, and which others have their numbers.
        let is_known = own.iter().all(|program| programs.holds(program));
        if !is_known {
            programs.replace(own);
        }
        let programs = Arc::new(programs);
        let places = ProgramPlaces::new((number, path), &folders.programs, Arc::clone(&programs));
        let part = match &shared.part {
            Some(path) => Some(setup::read_part_file(path)?),
            // The part built in for the program's number, if it is for this kind of machine.
            None => PartFile::builtin(number).map_err(CallError::new)?.filter(|part| part.kind == shared.kind),
        };
        Ok(Self { shared, call, path, source, others, programs, places, retained, settings, part })
    }

    /// Checks the program, runs it if the call asks for it, and prints the result; returns the exit status.
    fn execute(&self) -> Result<u8, CallError> {
        let mut found = self.analyse();
        let wrong = !found.checked.faults.is_empty()
            || !found.move_errors.is_empty()
            || self.duplicate_errors().next().is_some();
        let program = ProgramToRun::Checked(self.source.number(), &self.programs);
        let run = RunArgs {
            program: self.path.display().to_string(),
            through_stops: true,
            parts: 1,
            trace: None,
            hours: USUAL_HOURS,
        };
        let ran =
            (self.call.simulate && !wrong).then(|| super::run::run_program(self.shared, &run, program)).transpose()?;
        match &ran {
            Some(ran) if ran.end == RunEnd::Finished => found.time = CycleTime::Simulated(ran.seconds),
            None if !wrong && !self.call.ops => {
                found.time = cycle_time(self.shared, &self.retained, program, &found.checked)?;
            }
            Some(_) | None => {}
        }
        let met = ran.as_ref().map(|ran| self.run_errors(ran)).unwrap_or_default();
        self.print(&found, ran.as_ref().map(|ran| (ran, met.as_slice())));
        let status = match &ran {
            _ if wrong => USAGE_ERROR,
            Some(ran) if ran.end != RunEnd::Finished || !met.is_empty() => FAILED,
            Some(_) | None => SUCCESS,
        };
        if let Some(ran) = ran {
            print_line(ran.report);
        }
        Ok(status)
    }

    fn error(&self, line: u32, column: u32, message: &LocalizedText) -> CheckError {
        shared_error(self.shared, Some((line, column)), message)
    }

    /// An error at a line of a program; one in another program is reported with its file and name.
    fn error_in(&self, (program, line): (u32, u32), column: u32, message: String) -> CheckError {
        let place = self.places.find(program, line);
        let (title, calls) = (self.places.title(program), Vec::new());
        let file = title.as_ref().map(|_| place.file);
        CheckError { file, program: title, line: place.line, column, message, calls }
    }

    /// A fault of the text, with the calls that led to it.
    fn fault_error(&self, fault: &ProgramFault) -> CheckError {
        let lang = self.shared.lang;
        let message = format!("{} – {}", fault.cause(lang), fault.remedy(lang));
        let place = (fault.location.program, fault.location.line);
        CheckError { calls: self.places.calls(fault), ..self.error_in(place, fault.column, message) }
    }

    /// A block that the machine would refuse.
    fn refusal_error(&self, foreseen: &PredictedRefusal) -> CheckError {
        let message = foreseen.text.get(self.shared.lang).into_owned();
        self.error_in((foreseen.at.program, foreseen.at.line), 1, message)
    }

    /// The numbers that a program of the file shares with another program, at its last place in the file.
    fn duplicate_errors(&self) -> impl Iterator<Item = CheckError> + '_ {
        let name = self.path.file_name().unwrap_or_default().to_string_lossy();
        self.programs.duplicates().iter().filter_map(move |twice| {
            let (_, line) = twice.places.iter().rfind(|(file, _)| *file == name)?;
            let name = self.programs.get(twice.number).map(|program| program.source.title());
            let name = name.unwrap_or_else(|| program_number::name_of(twice.number));
            let details = [name.as_str().into(), twice.text.as_str().into()];
            let cause = LocalizedText::phrase(ProgramError::DuplicateProgram.template(), details.clone());
            let remedy = LocalizedText::phrase(ProgramError::DuplicateProgram.remedy_template(), details);
            let lang = self.shared.lang;
            let message = format!("{} – {}", cause.get(lang), remedy.get(lang));
            Some(CheckError { line: *line, column: 1, message, ..CheckError::default() })
        })
    }

    /// A move beyond the finished size, at the block that caused it.
    fn overshoot_error(&self, passed: &Overshoot) -> CheckError {
        let line = self.block_text(passed.at);
        let name = passed.variable.map(|number| variable_name::variable_name_on(number, self.shared.kind));
        let column = line.find(&name.unwrap_or_default()).map_or(1, |at| line[..at].chars().count() as u32 + 1);
        let block = passed.at.n.map_or_else(String::new, |n| format!("N{n} "));
        let message = format!("{block}{}", passed.message.get(self.shared.lang));
        self.error_in((passed.at.program, passed.at.line), column, message)
    }

    /// Errors of the simulated run: its alarms, or the error that the program itself reported.
    fn run_errors(&self, ran: &RunResult) -> Vec<CheckError> {
        let alarms = ran.alarms.iter().map(|(place, message)| {
            let message = message.get(self.shared.lang).into_owned();
            match place {
                Some((program, line)) if *program != ran.program => self.error_in((*program, *line), 1, message),
                place => {
                    CheckError { line: place.map_or(0, |(_, line)| line), column: 1, message, ..CheckError::default() }
                }
            }
        });
        let mut met: Vec<_> = alarms.collect();
        if let (true, Some(told)) = (ran.has_own_error, &ran.message) {
            let tells = |line: &u32| self.source.line(*line).is_some_and(|text| text.contains(&*told.zh()));
            let line = (1..=self.source.line_count() as u32).find(tells).unwrap_or(0);
            let text = self.source.line(line);
            let column = text.and_then(|text| text.find("MSG").map(|at| text[..at].chars().count()));
            met.push(self.error(line, column.map_or(1, |at| at as u32 + 1), told));
        } else if ran.has_own_error {
            let en = "the program ended with an error of its own (R62)";
            met.push(self.error(0, 1, &LocalizedText::new("程序以自己的错误结束 (R62)", en)));
        }
        met
    }

    fn analyse(&self) -> CheckOutcome {
        let Self { source, settings, retained, .. } = self;
        let library = &(Arc::clone(&self.programs) as Arc<dyn Library + Send + Sync>);
        let mut memory = retained.variables.clone();
        let mut world = self.machine_at_zero();
        let mut limits = self.soft_limit_check(&world);
        if let Some(part) = self.part.as_ref().filter(|_| !settings.start_is_work_zero) {
            world = world_at_start(world, retained.work_offsets.clone(), part);
            for (number, value) in setup::part_variables(part, &self.shared.sets) {
                let _ = memory.set(u32::from(number), Some(value)); // a part presets valid variables only
            }
        }
        let finished = self.part.as_ref().and_then(|part| part.finished).filter(|_| self.call.simulate);
        let mut rehearsal = finished.map(|finished| {
            let width_mm = retained.params.get(param::WHEEL_WIDTH);
            FinishedSizeCheck::new(finished, width_mm, settings.dialect, world.clone(), memory.clone())
        });
        let mut interlocks = InterlockCheck::new(self.shared.kind, &retained.params);
        // An endless loop is shown once, up to its repetition. A first run without output finds that position.
        let checking = || ProgramCheck::new(source, library, settings, memory.clone());
        let repeated = match self.call.ops {
            true => checking().run(&mut world.clone(), &mut |_| {}).repeated_blocks,
            false => Vec::new(),
        };
        let mut shown = 0;
        let mut origins = WorkOffsets::default();
        origins.work[0] = self.part.as_ref().map_or_else(PerAxis::default, |part| part.g54_mm.displacement());
        let checked = checking().run(&mut world, &mut |block| {
            if let Some(rehearsal) = &mut rehearsal {
                rehearsal.check_block(block, &|at| self.block_text(at));
            }
            if let Some(limits) = &mut limits {
                limits.check_block(block);
            }
            interlocks.check_block(block);
            if self.call.ops && !repeated.iter().any(|repeated| repeated.contains(&shown)) {
                block.ops.iter().for_each(|op| self.print_op(op, &mut origins));
            }
            shown += 1;
        });
        let passed = rehearsal.and_then(FinishedSizeCheck::into_overshoot).map(|passed| self.overshoot_error(&passed));
        // An endless loop runs into the limits; only the endless loop is reported.
        let limits = limits.filter(|_| checked.repeated_blocks.is_empty());
        let beyond = limits.map(SoftLimitCheck::into_violations).unwrap_or_default();
        let [refused, limited] = interlocks.into_findings(checked.finished && !checked.begins_anew);
        let foreseen = refused.into_iter().chain(beyond).map(|foreseen| self.refusal_error(&foreseen));
        let mut move_errors: Vec<_> = passed.into_iter().chain(foreseen).collect();
        move_errors.sort_by_key(|wrong| wrong.line);
        let checked = self.check_others(checked, library);
        let machine_warnings = limited.iter().map(|limited| self.refusal_error(limited)).collect();
        CheckOutcome { time: CycleTime::AtFeeds(checked.seconds), checked, move_errors, machine_warnings }
    }

    /// Checks the programs of the file that the first one does not call, each by itself. One that another of them calls was
    /// checked with that one; one whose number stands before it in the file has its error already, and no place of its own.
    fn check_others(&self, mut checked: CheckReport, library: &SharedLibrary) -> CheckReport {
        let is_left = |source: &&Arc<Source>, checked: &CheckReport| !checked.called.contains(&source.number());
        let all: Vec<u32> = [&self.source].into_iter().chain(&self.others).map(|source| source.number()).collect();
        let is_first = |index: usize, number: u32| !all[..=index].contains(&number);
        let others = self.others.iter().enumerate().filter(|(index, source)| is_first(*index, source.number()));
        let left = others.map(|(_, source)| source).filter(|source| is_left(source, &checked));
        let found: Vec<_> = left
            .map(|source| {
                let check = ProgramCheck::new(source, library, &self.settings, self.retained.variables.clone());
                (source, check.run(&mut self.machine_at_zero(), &mut |_| {}))
            })
            .collect();
        let is_called = |number: u32| {
            found.iter().any(|(source, report)| source.number() != number && report.called.contains(&number))
        };
        let (called, callers): (Vec<_>, Vec<_>) = found.iter().partition(|(source, _)| is_called(source.number()));
        // Those that call each other in a circle come last.
        for (source, report) in callers.into_iter().chain(called) {
            if is_left(source, &checked) {
                merge_report(&mut checked, source.number(), report);
            }
        }
        checked
    }

    /// A machine with the retained data, at its zero.
    fn machine_at_zero(&self) -> OfflineMachine {
        let mut world = OfflineMachine::new(&self.settings)
            .with_references(reference_points(&self.retained.params))
            .with_work_offsets(self.retained.work_offsets.clone());
        for (number, value) in stored_system_variables(&self.retained.params, self.retained.dress_points) {
            world.set_system(number, value);
        }
        world
    }

    /// The soft limit check, if the part (or a lathe's bar) gives the start position in the machine.
    fn soft_limit_check(&self, world: &OfflineMachine) -> Option<SoftLimitCheck<'_>> {
        let (params, world) = (&self.retained.params, world.clone());
        let shown = PerAxis::from_fn(|axis| if axis == Axis::X && self.settings.diameter { 2.0 } else { 1.0 });
        let mut offsets = self.retained.work_offsets.clone();
        if !self.settings.start_is_work_zero {
            let part = self.part.as_ref()?;
            return Some(SoftLimitCheck::new(world_at_start(world, offsets, part), params, shown));
        }
        // L3: the program starts at its own zero.
        let given = self.shared.part.is_some();
        let bar = if given { None } else { bar::bar_of_program(self.shared.kind, params, &self.source) };
        let machine = bar.as_ref().or(self.part.as_ref())?.start_mm.machine();
        offsets.set_coordinates(machine, &PerAxis([Some(0.0), None, Some(0.0)]));
        let world = world.with_position(offsets.work_from_machine(machine)).with_work_offsets(offsets);
        Some(SoftLimitCheck::new(world, params, shown))
    }

    /// The text of a block.
    fn block_text(&self, at: BlockLocation) -> String {
        let sub = (at.program != self.source.number()).then(|| self.programs.find(at.program)).flatten();
        sub.as_ref().unwrap_or(&self.source).line(at.line).unwrap_or_default()
    }

    /// Prints a canonical operation. A change of the work offset gets its origin: G54 as set up for the part, the
    /// others zero, until the program sets them.
    fn print_op(&self, op: &Op, origins: &mut WorkOffsets) {
        if self.shared.format == OutputFormat::Text {
            return print_line(op);
        }
        let axes = self.settings.axes;
        let mut json = op.json(axes);
        if let Op::SetSystemVariable { number, value } = op
            && let Some((place, index)) = OriginPlace::of_variable(*number)
            && let Some((axis, _)) = axes.iter().filter(|(_, present)| **present).nth(index)
        {
            let mut origin = origins.origin(place);
            let per_mm = if self.settings.diameter && axis == Axis::X { 2.0 } else { 1.0 };
            origin[axis] = value.unwrap_or(0.0) / per_mm;
            origins.set_origin(place, origin);
        }
        if let (Op::SelectWorkOffset { g }, Some(object)) = (op, json.as_object_mut()) {
            origins.activate(*g);
            let zero = PerAxis::from_fn(|axis| origins.machine_minus_work(axis));
            for (axis, _) in axes.iter().filter(|(_, present)| **present) {
                object.insert(axis.letter().to_ascii_lowercase().to_string(), json!(zero[axis]));
            }
        }
        print_line(json);
    }

    fn print(&self, found: &CheckOutcome, ran: Option<(&RunResult, &[CheckError])>) {
        let (shared, checked) = (self.shared, &found.checked);
        let file = self.path.display().to_string();
        let faults = checked.faults.iter().map(|fault| self.fault_error(fault));
        let met = ran.map_or(&[][..], |(_, met)| met);
        let wrong: Vec<_> =
            self.duplicate_errors().chain(faults).chain(found.move_errors.iter().chain(met).cloned()).collect();
        let rows = text_row_faults(&self.source).into_iter();
        let rows = rows.map(|fault| self.error(fault.line, 1, &fault.message));
        let warnings = checked.warnings.iter().map(|fault| self.fault_error(fault)).chain(rows);
        let warnings: Vec<_> = warnings.chain(found.machine_warnings.iter().cloned()).collect();
        let diameter = self.settings.diameter;
        let shown = |axis: Axis, value: f64| if axis == Axis::X && diameter { value * 2.0 } else { value };
        let extents: Vec<(Axis, f64, f64)> = checked.extents.map_or_else(Vec::new, |(low, high)| {
            let present = Axis::ALL.into_iter().filter(|axis| self.settings.axes[*axis]);
            present.map(|axis| (axis, shown(axis, low[axis]), shown(axis, high[axis]))).collect()
        });
        match shared.format {
            OutputFormat::Json if self.call.ops && wrong.is_empty() => {}
            OutputFormat::Json => {
                let extents: serde_json::Map<String, Value> =
                    extents.iter().map(|(axis, low, high)| (axis.to_string(), json!([low, high]))).collect();
                let mut told = json!({"file": file, "errors": errors_json(&wrong), "warnings": errors_json(&warnings),
                           "finished": checked.finished, "seconds": found.time.seconds(),
                           "timing": timing_word(found.time), "length": checked.length_mm,
                           "extents": extents});
                if wrong.len() >= MAX_FAULTS {
                    told["truncated"] = json!(true);
                }
                if let Some((ran, _)) = ran {
                    told["simulated"] = json!(ran.end.report_word());
                }
                print_line(told);
            }
            OutputFormat::Text => {
                warnings.iter().for_each(|at| print_warning(shared, &file, at));
                print_errors(shared, &file, &wrong, &verdict(checked, ran.map(|(ran, _)| ran)));
                let ranges = extents.iter().map(|(axis, low, high)| format!("{axis} {low:.3}…{high:.3}"));
                print_line(format!(
                    "{}  {}",
                    summary(checked, found.time).get(shared.lang),
                    ranges.collect::<Vec<_>>().join("  ")
                ));
            }
        }
    }
}

/// The state at the start of a run: the part's zero as G54, its tool geometry and start position.
fn world_at_start(world: OfflineMachine, mut offsets: WorkOffsets, part: &PartFile) -> OfflineMachine {
    offsets.work[0] = part.g54_mm.displacement();
    for offset in &part.offsets {
        let index = usize::from(offset.number).checked_sub(1);
        if let Some(place) = index.and_then(|index| offsets.geometry.get_mut(index)) {
            *place = PerAxis([offset.x / 2.0, 0.0, offset.z]);
        }
        if let Some(cutter) = index.and_then(|index| offsets.cutter.get_mut(index)) {
            *cutter = CutterShape { radius_mm: offset.r, tip: offset.t };
        }
    }
    world.with_position(offsets.work_from_machine(part.start_mm.machine())).with_work_offsets(offsets)
}

/// The verdict without errors: of the check, and of the run after it.
fn verdict(checked: &CheckReport, ran: Option<&RunResult>) -> LocalizedText {
    match ran {
        Some(ran) if ran.end != RunEnd::Finished => {
            let why = ran.message.clone().unwrap_or_default();
            let by = |text: &str| if text.is_empty() { String::new() } else { format!(": {text}") };
            LocalizedText::new(
                format!("未发现错误，但模拟运行没有到程序结束{}", by(&why.zh())),
                format!("no error found, but the simulated run did not reach the program end{}", by(&why.en())),
            )
        }
        // The run reached the end even if the check did not.
        Some(_) => OK.into(),
        None if checked.finished => OK.into(),
        None => {
            Text::new("未发现错误，但没有检查到结束", "no error found, but the check did not reach the program end")
                .into()
        }
    }
}

/// How the time was found, in the report.
const fn timing_word(time: CycleTime) -> &'static str {
    match time {
        CycleTime::Simulated(_) => "simulated",
        CycleTime::AtFeeds(_) => "feeds",
    }
}

/// Lines, path length and time; a loop that is not followed to the end counts up to its repetition.
fn summary(checked: &CheckReport, time: CycleTime) -> LocalizedText {
    let (lines, seconds) = (checked.lines, time.seconds());
    let (zh, en) =
        ("没有走到底的循环只算到开始重复为止：", "loops that are not followed to the end count until they repeat: ");
    let (zh, en) = if checked.finished { ("", "") } else { (zh, en) };
    let path = format!("{:.3} mm  {seconds:.1} s", checked.length_mm);
    let (by_zh, by_en) = match time {
        CycleTime::Simulated(_) => ("", ""),
        CycleTime::AtFeeds(_) => (" (按编程速度)", " (at the programmed feeds)"),
    };
    LocalizedText::new(format!("{lines} 行  {zh}{path}{by_zh}"), format!("{lines} lines  {en}{path}{by_en}"))
}
