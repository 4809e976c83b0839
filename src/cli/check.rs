//! `kt830 check`: checks programs, page texts and pictures without running them; every error has its position.
//! Source: spec tools.md T4.

use std::path::Path;
use std::sync::Arc;

use serde_json::{Value, json};

use super::args::{CheckArgs, OutputFormat, RunArgs, SharedArgs};
use super::finished_size_check::{FinishedSizeCheck, Overshoot};
use super::run::{RunEnd, RunResult};
use super::soft_limit_check::SoftLimitCheck;
use super::{CallError, FAILED, SUCCESS, USAGE_ERROR, print_line, setup};
use crate::controller::interlock_check::{InterlockCheck, PredictedRefusal};
use crate::controller::{PARAM_VARIABLES, PowerOnState, Programs, nc_settings, reference_points};
use crate::defs::kind::Dialect;
use crate::defs::text::{LocalizedText, Text};
use crate::defs::{param, variable_name};
use crate::host::bar;
use crate::host::folders::{named_programs_beside, parse_page_text, parse_picture, program_from_bytes};
use crate::io::sim::PartFile;
use crate::nc::{
    BlockLocation, CheckReport, CommonVariables, Library, NcSettings, OfflineMachine, Op, ProgramCheck, ProgramFault,
    Source, WorkOffsets,
};
use crate::units::{Axis, PerAxis};

/// Prefix of a warning.
const WARNING: Text = Text::new("警告：", "warning: ");

/// The verdict without errors.
const OK: Text = Text::new("ok", "ok");

/// The type of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum CheckedFileKind {
    Program,
    PageText,
    Picture,
}

/// An error of a file.
#[derive(Clone, Debug)]
struct CheckError {
    line: u32,
    column: u32,
    message: String,
}

/// Checks every file of the call.
///
/// # Errors
/// A file cannot be read.
pub fn check(shared: &SharedArgs, call: &CheckArgs) -> Result<u8, CallError> {
    let mut status = SUCCESS;
    for path in &call.files {
        let bytes = std::fs::read(path).map_err(|error| {
            CallError::new(format!("{}: {error}; check the path, or whether the file may be read", path.display()))
        })?;
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let found = match file_kind(&name) {
            CheckedFileKind::Program => check_program(shared, call, path, bytes)?,
            CheckedFileKind::PageText => {
                let done = parse_page_text(&name, &bytes);
                print_file(shared, path, done.map(drop).map_err(|fault| vec![file_error(shared, &fault)]))
            }
            CheckedFileKind::Picture => {
                let done = parse_picture(&name, &bytes);
                print_file(shared, path, done.map(drop).map_err(|fault| vec![file_error(shared, &fault)]))
            }
        };
        status = status.max(found);
    }
    Ok(status)
}

/// `C0001.TXT`, `C0001.NC` are page texts, `.BMP` pictures, everything else programs.
fn file_kind(name: &str) -> CheckedFileKind {
    let upper = name.to_ascii_uppercase();
    let page = upper
        .strip_prefix('C')
        .is_some_and(|rest| rest.len() > 4 && rest.as_bytes()[..4].iter().all(u8::is_ascii_digit));
    match upper.rsplit_once('.').map(|(_, extension)| extension) {
        Some("BMP") => CheckedFileKind::Picture,
        Some("TXT") => CheckedFileKind::PageText,
        _ if page => CheckedFileKind::PageText,
        _ => CheckedFileKind::Program,
    }
}

fn file_error(shared: &SharedArgs, fault: &crate::link::command::FileFault) -> CheckError {
    let (line, column) = fault.position.unwrap_or((0, 0));
    CheckError { line, column, message: fault.message.get(shared.lang).to_owned() }
}

fn program_error(shared: &SharedArgs, number: u32, fault: &ProgramFault) -> CheckError {
    // An error in a subprogram is reported with its program.
    let sub = if fault.location.program == number { String::new() } else { format!("{}: ", fault.program_title()) };
    let message = format!("{sub}{} – {}", fault.cause(shared.lang), fault.remedy(shared.lang));
    CheckError { line: fault.location.line, column: fault.column, message }
}

/// Prints the result for a page text or picture; returns the exit status.
fn print_file(shared: &SharedArgs, path: &Path, done: Result<(), Vec<CheckError>>) -> u8 {
    let wrong = done.err().unwrap_or_default();
    let file = path.display().to_string();
    match shared.format {
        OutputFormat::Json => print_line(json!({"file": file, "errors": errors_json(&wrong)})),
        OutputFormat::Text => print_errors(shared, &file, &wrong, &OK.into()),
    }
    if wrong.is_empty() { SUCCESS } else { USAGE_ERROR }
}

fn errors_json(wrong: &[CheckError]) -> Value {
    wrong.iter().map(|at| json!({"line": at.line, "column": at.column, "message": at.message})).collect()
}

/// Prints every error, or the verdict if there is none.
fn print_errors(shared: &SharedArgs, file: &str, wrong: &[CheckError], verdict: &LocalizedText) {
    for at in wrong {
        print_line(match at.line {
            0 => format!("{file}: {}", at.message),
            line => format!("{file}:{line}:{}: {}", at.column, at.message),
        });
    }
    if wrong.is_empty() {
        print_line(format!("{file}: {}", verdict.get(shared.lang)));
    }
}

/// Result of the check of a program.
struct CheckOutcome {
    checked: CheckReport,
    /// Errors that are not in the text: beyond the finished size or a soft limit, or refused by an interlock.
    move_errors: Vec<CheckError>,
    source: Arc<Source>,
    settings: NcSettings,
}

fn check_program(shared: &SharedArgs, call: &CheckArgs, path: &Path, bytes: Vec<u8>) -> Result<u8, CallError> {
    let found = analyse_program(shared, call, path, bytes)?;
    let wrong = !found.checked.faults.is_empty() || !found.move_errors.is_empty();
    let ran = match call.simulate && !wrong {
        true => {
            let run = RunArgs { program: path.display().to_string(), through_stops: true, parts: 1, trace: None };
            Some(super::run::run_program(shared, &run)?)
        }
        false => None,
    };
    let met = ran.as_ref().map(|ran| run_errors(shared, &found.source, ran)).unwrap_or_default();
    print_program(shared, call, path, &found, ran.as_ref().map(|ran| (ran, met.as_slice())));
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

/// Errors of the simulated run: its alarms, or the error that the program itself reported.
fn run_errors(shared: &SharedArgs, source: &Source, ran: &RunResult) -> Vec<CheckError> {
    let mut met: Vec<_> = ran
        .alarms
        .iter()
        .map(|(place, said)| {
            let line = place.filter(|(program, _)| *program == ran.program).map_or(0, |(_, line)| line);
            CheckError { line, column: 1, message: said.get(shared.lang).to_owned() }
        })
        .collect();
    if let (true, Some(told)) = (ran.has_own_error, &ran.message) {
        let tells = |line: &u32| source.line(*line).is_some_and(|text| text.contains(&told.zh));
        let line = (1..=source.line_count() as u32).find(tells).unwrap_or(0);
        let column = source.line(line).and_then(|text| text.find("MSG").map(|at| text[..at].chars().count()));
        met.push(CheckError {
            line,
            column: column.map_or(1, |at| at as u32 + 1),
            message: told.get(shared.lang).to_owned(),
        });
    } else if ran.has_own_error {
        let said =
            LocalizedText::new("程序以自己的错误结束 (R62)", "the program has ended in an error of its own (R62)");
        met.push(CheckError { line: 0, column: 1, message: said.get(shared.lang).to_owned() });
    }
    met
}

fn analyse_program(
    shared: &SharedArgs,
    call: &CheckArgs,
    path: &Path,
    bytes: Vec<u8>,
) -> Result<CheckOutcome, CallError> {
    let number = program_number(path);
    let retained = setup::check_retained(shared)?;
    let settings = nc_settings(shared.kind, &retained.params);
    let axes = settings.axes;
    let library = program_library(shared, path, settings.dialect)?;
    let mut memory = retained.variables.clone();
    let mut world = offline_machine(&retained, &settings);
    let source = program_from_bytes(number, &path.display().to_string(), bytes, settings.dialect).source;
    let part = checked_part(shared, number)?;
    let mut limits = soft_limit_check(shared, &world, &retained, (&source, part.as_ref()), &settings)?;
    if let Some(part) = part.as_ref().filter(|_| !settings.start_is_work_zero) {
        world = world_at_start(world, retained.work_offsets.clone(), part);
        preset_variables(&mut memory, part, &shared.sets);
    }
    let finished = part.as_ref().and_then(|part| part.finished).filter(|_| call.simulate);
    let mut rehearsal = finished.map(|finished| {
        let width_mm = retained.params.get(param::WHEEL_WIDTH);
        FinishedSizeCheck::new(finished, width_mm, settings.dialect, (world.clone(), memory.clone()))
    });
    let mut foresight = InterlockCheck::new(shared.kind, &retained.params);
    let checking = || ProgramCheck::new(&source, &library, &settings, memory.clone());
    // An endless loop is shown once, up to its repetition. A first run without output finds that position.
    let repeated = match call.ops {
        true => checking().run(&mut world.clone(), &mut |_| {}).repeated_blocks,
        false => Vec::new(),
    };
    let mut shown = 0;
    let checked = checking().run(&mut world, &mut |block| {
        if let Some(rehearsal) = &mut rehearsal {
            rehearsal.check_block(block, &|at| block_text(&source, &library, at).1);
        }
        if let Some(limits) = &mut limits {
            limits.check_block(block);
        }
        foresight.check_block(block);
        if call.ops && !repeated.iter().any(|repeated| repeated.contains(&shown)) {
            block.ops.iter().for_each(|op| print_op(shared, op, part.as_ref(), axes));
        }
        shown += 1;
    });
    let passed = rehearsal
        .and_then(FinishedSizeCheck::into_overshoot)
        .map(|passed| move_error(shared, &source, &library, &passed));
    // An endless loop runs into the limits; only the endless loop is reported.
    let beyond =
        limits.filter(|_| checked.repeated_blocks.is_empty()).map(SoftLimitCheck::into_violations).unwrap_or_default();
    let foreseen = foresight.refusals().into_iter().chain(beyond);
    let foreseen = foreseen.map(|foreseen| refusal_error(shared, source.number(), &foreseen));
    let mut moves: Vec<_> = passed.into_iter().chain(foreseen).collect();
    moves.sort_by_key(|wrong| wrong.line);
    Ok(CheckOutcome { checked, move_errors: moves, source, settings })
}

/// The programs that a checked program may call: those of the folder and the named ones beside its file.
fn program_library(
    shared: &SharedArgs,
    path: &Path,
    dialect: Dialect,
) -> Result<Arc<dyn Library + Send + Sync>, CallError> {
    let folders = setup::folders(shared)?;
    let (mut programs, _) = folders.read_programs().unwrap_or_else(|_| (Programs::default(), Vec::new()));
    programs.replace(named_programs_beside(path, dialect));
    Ok(Arc::new(programs))
}

/// A machine with the retained data, at its zero.
fn offline_machine(retained: &PowerOnState, settings: &NcSettings) -> OfflineMachine {
    let mut world = OfflineMachine::new(settings)
        .with_references(reference_points(&retained.params))
        .with_work_offsets(retained.work_offsets.clone());
    for (variable, row) in PARAM_VARIABLES {
        world.set_system(variable.first, Some(retained.params.get(row)));
    }
    world
}

/// Prints a canonical operation.
fn print_op(shared: &SharedArgs, op: &Op, part: Option<&PartFile>, axes: PerAxis<bool>) {
    match shared.format {
        OutputFormat::Json => print_line(with_work_offset(op, op.json(axes), part, axes)),
        OutputFormat::Text => print_line(op),
    }
}

/// The part that a program is checked for: `--part`, otherwise the built-in part of its number.
fn checked_part(shared: &SharedArgs, number: u32) -> Result<Option<PartFile>, CallError> {
    match &shared.part {
        Some(path) => setup::read_part_file(path).map(Some),
        None => PartFile::builtin(number).map_err(CallError::new),
    }
}

/// The error of a block that the machine would refuse; one in a subprogram is reported with its program.
fn refusal_error(shared: &SharedArgs, number: u32, foreseen: &PredictedRefusal) -> CheckError {
    let program = foreseen.at.program;
    let sub =
        if program == number { String::new() } else { format!("{}: ", crate::defs::program_number::name_of(program)) };
    CheckError { line: foreseen.at.line, column: 1, message: format!("{sub}{}", foreseen.text.get(shared.lang)) }
}

/// The soft limit check, if the part (or a lathe's bar) gives the start position in the machine.
fn soft_limit_check<'a>(
    shared: &SharedArgs,
    world: &OfflineMachine,
    retained: &'a PowerOnState,
    (source, part): (&Arc<Source>, Option<&PartFile>),
    settings: &NcSettings,
) -> Result<Option<SoftLimitCheck<'a>>, CallError> {
    let shown = PerAxis::from_fn(|axis| if axis == Axis::X && settings.diameter { 2.0 } else { 1.0 });
    let frames = retained.work_offsets.clone();
    if !settings.start_is_work_zero {
        return Ok(
            part.map(|part| SoftLimitCheck::new(world_at_start(world.clone(), frames, part), &retained.params, shown))
        );
    }
    // L3: the program starts at its own zero.
    let bar = if shared.part.is_some() { None } else { bar::bar_of_program(shared.kind, &retained.params, source) };
    let Some(part) = bar.as_ref().or(part) else { return Ok(None) };
    let mut frames = frames;
    let machine = PerAxis([part.start_mm.x, part.start_mm.y, part.start_mm.z]);
    frames.set_coordinates(machine, &PerAxis([Some(0.0), None, Some(0.0)]));
    let world = world.clone().with_position(frames.work_from_machine(machine)).with_work_offsets(frames);
    Ok(Some(SoftLimitCheck::new(world, &retained.params, shown)))
}

/// The text of a block, and its subprogram.
fn block_text(
    source: &Source,
    library: &Arc<dyn Library + Send + Sync>,
    at: BlockLocation,
) -> (Option<Arc<Source>>, String) {
    let sub = (at.program != source.number()).then(|| library.find(at.program)).flatten();
    let line = sub.as_deref().unwrap_or(source).line(at.line).unwrap_or_default();
    (sub, line)
}

/// The error of a move that the rehearsal found, at the block that caused it.
fn move_error(
    shared: &SharedArgs,
    source: &Source,
    library: &Arc<dyn Library + Send + Sync>,
    passed: &Overshoot,
) -> CheckError {
    let (sub, line) = block_text(source, library, passed.at);
    let name = passed.variable.map(|number| variable_name::variable_name_on(number, shared.kind)).unwrap_or_default();
    let column = line.find(&name).map_or(1, |at| line[..at].chars().count() as u32 + 1);
    let program = sub.map_or_else(String::new, |sub| format!("{}: ", sub.title()));
    let block = passed.at.n.map_or_else(String::new, |n| format!("N{n} "));
    CheckError { line: passed.at.line, column, message: format!("{program}{block}{}", passed.message.get(shared.lang)) }
}

/// Adds the origin to a change of the work offset: G54 as set up for the part, the others zero.
fn with_work_offset(op: &Op, mut json: Value, part: Option<&PartFile>, axes: PerAxis<bool>) -> Value {
    if let (Op::SelectWorkOffset { g }, Some(object)) = (op, json.as_object_mut()) {
        let zero = part
            .filter(|_| *g == 54)
            .map_or_else(PerAxis::default, |part| PerAxis([part.g54_mm.x, part.g54_mm.y, part.g54_mm.z]));
        for (axis, _) in axes.iter().filter(|(_, present)| **present) {
            object.insert(axis.letter().to_ascii_lowercase().to_string(), json!(zero[axis]));
        }
    }
    json
}

/// The program number of a file name; 0 for a name without one.
fn program_number(path: &Path) -> u32 {
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    crate::story::parse::program(&stem).unwrap_or(0)
}

/// The state at the start of a run: the part's zero as G54, its tool geometry and start position.
fn world_at_start(world: OfflineMachine, mut frames: WorkOffsets, part: &PartFile) -> OfflineMachine {
    frames.work[0] = PerAxis([part.g54_mm.x, part.g54_mm.y, part.g54_mm.z]);
    for offset in &part.offsets {
        if let Some(place) = usize::from(offset.number).checked_sub(1).and_then(|index| frames.geometry.get_mut(index))
        {
            *place = PerAxis([offset.x / 2.0, 0.0, offset.z]);
        }
    }
    let at = frames.work_from_machine(PerAxis([part.start_mm.x, part.start_mm.y, part.start_mm.z]));
    world.with_position(at).with_work_offsets(frames)
}

/// Sets the part's variables that the call does not set.
fn preset_variables(memory: &mut CommonVariables, part: &PartFile, sets: &[(u16, f64)]) {
    for (number, value) in setup::part_variables(part, sets) {
        let _ = memory.set(u32::from(number), Some(value)); // a part presets valid variables only
    }
}

/// The verdict without errors: of the check, and of the run after it.
fn verdict(checked: &CheckReport, ran: Option<&RunResult>) -> LocalizedText {
    match ran {
        Some(ran) if ran.end != RunEnd::Finished => {
            let why = ran.message.clone().unwrap_or_default();
            let by = |text: &str| if text.is_empty() { String::new() } else { format!(": {text}") };
            LocalizedText::new(
                format!("未发现错误，但模拟运行没有到程序结束{}", by(&why.zh)),
                format!("no error found, but the simulated run did not come to its end{}", by(&why.en)),
            )
        }
        // The run reached the end even if the check did not.
        Some(_) => OK.into(),
        None if checked.finished => OK.into(),
        None => Text::new("未发现错误，但没有检查到结束", "no error found, but not checked to its end").into(),
    }
}

fn print_program(
    shared: &SharedArgs,
    call: &CheckArgs,
    path: &Path,
    found: &CheckOutcome,
    ran: Option<(&RunResult, &[CheckError])>,
) {
    let CheckOutcome { checked, move_errors: moves, settings, .. } = found;
    let number = program_number(path);
    let file = path.display().to_string();
    let faults = checked.faults.iter().map(|fault| program_error(shared, number, fault));
    let met = ran.map_or(&[][..], |(_, met)| met);
    let wrong: Vec<_> = faults.chain(moves.iter().chain(met).cloned()).collect();
    let warnings: Vec<_> = checked.warnings.iter().map(|fault| program_error(shared, number, fault)).collect();
    let shown = |axis: Axis, value: f64| if axis == Axis::X && settings.diameter { value * 2.0 } else { value };
    let extents: Vec<(Axis, f64, f64)> = checked.extents.map_or_else(Vec::new, |(low, high)| {
        let present = Axis::ALL.into_iter().filter(|axis| settings.axes[*axis]);
        present.map(|axis| (axis, shown(axis, low[axis]), shown(axis, high[axis]))).collect()
    });
    match shared.format {
        OutputFormat::Json if call.ops && wrong.is_empty() => {}
        OutputFormat::Json => {
            let extents: serde_json::Map<String, Value> =
                extents.iter().map(|(axis, low, high)| (axis.to_string(), json!([low, high]))).collect();
            let mut told = json!({"file": file, "errors": errors_json(&wrong), "warnings": errors_json(&warnings),
                       "finished": checked.finished, "seconds": checked.seconds, "length": checked.length_mm,
                       "extents": extents});
            if let Some((ran, _)) = ran {
                told["simulated"] = json!(ran.end.report_word());
            }
            print_line(told);
        }
        OutputFormat::Text => {
            for at in &warnings {
                let warning = WARNING.get(shared.lang);
                eprintln!("{file}:{}:{}: {warning}{}", at.line, at.column, at.message);
            }
            print_errors(shared, &file, &wrong, &verdict(checked, ran.map(|(ran, _)| ran)));
            let ranges: Vec<_> = extents.iter().map(|(axis, low, high)| format!("{axis} {low:.3}…{high:.3}")).collect();
            print_line(format!("{}  {}", summary(checked).get(shared.lang), ranges.join("  ")));
        }
    }
}

/// Lines, path length and time; if the check did not reach the end, only up to that point.
fn summary(checked: &CheckReport) -> LocalizedText {
    let (lines, mm, s) = (checked.lines, checked.length_mm, checked.seconds);
    if checked.finished {
        return LocalizedText::new(
            format!("{lines} 行  {mm:.3} mm  {s:.1} s"),
            format!("{lines} lines  {mm:.3} mm  {s:.1} s"),
        );
    }
    LocalizedText::new(
        format!("{lines} 行  检查没有走到程序结束；到该循环开始重复为止 {mm:.3} mm  {s:.1} s"),
        format!(
            "{lines} lines  the check did not come to the program's end; until that loop repeats {mm:.3} mm  {s:.1} s"
        ),
    )
}
