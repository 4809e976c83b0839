//! `kt830 check`: checks programs, page texts and pictures without running them; every error has its position.
//! Source: spec tools.md T4.

use std::path::Path;
use std::sync::Arc;

use serde_json::{Value, json};

use super::args::{Check, Format, Run, Shared};
use super::limits::Limits;
use super::rehearse::{Passed, Rehearsal};
use super::run::{End, Ran};
use super::{CallError, FAILED, FINE, WRONG_CALL, bench, out};
use crate::controller::foresight::Foresight;
use crate::controller::{PARAM_VARIABLES, Programs, Retained, nc_settings, references};
use crate::defs::text::{Said, Text};
use crate::defs::{param, r_parameter};
use crate::io::sim::PartFile;
use crate::nc::{CheckWorld, Checked, Fault, Frames, Library, Memory, Op, Place, Settings, Source, World, check_with};
use crate::runtime::bar;
use crate::runtime::disk::{beside, parse_page_text, parse_picture, program};
use crate::units::{Axis, PerAxis};

/// Prefix of a warning.
const WARNING: Text = Text::new("警告：", "warning: ");

/// The verdict without errors.
const OK: Text = Text::new("ok", "ok");

/// The type of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Class {
    Program,
    PageText,
    Picture,
}

/// An error of a file.
#[derive(Clone, Debug)]
struct Wrong {
    line: u32,
    column: u32,
    message: String,
}

/// Checks every file of the call.
///
/// # Errors
/// A file cannot be read.
pub fn check(shared: &Shared, call: &Check) -> Result<u8, CallError> {
    let mut status = FINE;
    for path in &call.files {
        let bytes = std::fs::read(path).map_err(|error| {
            CallError::new(format!("{}: {error}; check the path, or whether the file may be read", path.display()))
        })?;
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let found = match class(&name) {
            Class::Program => check_program(shared, call, path, bytes)?,
            Class::PageText => {
                let done = parse_page_text(&name, &bytes);
                tell_file(shared, path, done.map(drop).map_err(|fault| vec![wrong_file(shared, &fault)]))
            }
            Class::Picture => {
                let done = parse_picture(&name, &bytes);
                tell_file(shared, path, done.map(drop).map_err(|fault| vec![wrong_file(shared, &fault)]))
            }
        };
        status = status.max(found);
    }
    Ok(status)
}

/// `C0001.TXT`, `C0001.NC` are page texts, `.BMP` pictures, everything else programs.
fn class(name: &str) -> Class {
    let upper = name.to_ascii_uppercase();
    let page = upper
        .strip_prefix('C')
        .is_some_and(|rest| rest.len() > 4 && rest.as_bytes()[..4].iter().all(u8::is_ascii_digit));
    match upper.rsplit_once('.').map(|(_, extension)| extension) {
        Some("BMP") => Class::Picture,
        Some("TXT") => Class::PageText,
        _ if page => Class::PageText,
        _ => Class::Program,
    }
}

fn wrong_file(shared: &Shared, fault: &crate::link::command::FileFault) -> Wrong {
    let (line, column) = fault.place.unwrap_or((0, 0));
    Wrong { line, column, message: fault.said.get(shared.lang).to_owned() }
}

fn wrong_program(shared: &Shared, number: u32, fault: &Fault) -> Wrong {
    // An error in a subprogram is reported with its program.
    let sub = if fault.place.program == number { String::new() } else { format!("{}: ", fault.program()) };
    let message = format!("{sub}{} – {}", fault.cause(shared.lang), fault.remedy(shared.lang));
    Wrong { line: fault.place.line, column: fault.column, message }
}

/// Prints the result for a page text or picture; returns the exit status.
fn tell_file(shared: &Shared, path: &Path, done: Result<(), Vec<Wrong>>) -> u8 {
    let wrong = done.err().unwrap_or_default();
    let file = path.display().to_string();
    match shared.format {
        Format::Json => out(json!({"file": file, "errors": errors(&wrong)})),
        Format::Text => tell_errors(shared, &file, &wrong, &OK.into()),
    }
    if wrong.is_empty() { FINE } else { WRONG_CALL }
}

fn errors(wrong: &[Wrong]) -> Value {
    wrong.iter().map(|at| json!({"line": at.line, "column": at.column, "message": at.message})).collect()
}

/// Prints every error, or the verdict if there is none.
fn tell_errors(shared: &Shared, file: &str, wrong: &[Wrong], verdict: &Said) {
    for at in wrong {
        out(match at.line {
            0 => format!("{file}: {}", at.message),
            line => format!("{file}:{line}:{}: {}", at.column, at.message),
        });
    }
    if wrong.is_empty() {
        out(format!("{file}: {}", verdict.get(shared.lang)));
    }
}

/// Result of the check of a program.
struct Found {
    checked: Checked,
    /// Errors that are not in the text: beyond the finished size or a soft limit, or refused by an interlock.
    moves: Vec<Wrong>,
    source: Arc<Source>,
    settings: Settings,
}

fn check_program(shared: &Shared, call: &Check, path: &Path, bytes: Vec<u8>) -> Result<u8, CallError> {
    let found = look_at_program(shared, call, path, bytes)?;
    let wrong = !found.checked.faults.is_empty() || !found.moves.is_empty();
    let ran = match call.simulate && !wrong {
        true => {
            let run = Run { program: path.display().to_string(), through_stops: true, parts: 1, trace: None };
            Some(super::run::job(shared, &run)?)
        }
        false => None,
    };
    let met = ran.as_ref().map(|ran| met(shared, &found.source, ran)).unwrap_or_default();
    tell_program(shared, call, path, &found, ran.as_ref().map(|ran| (ran, met.as_slice())));
    let status = match &ran {
        _ if wrong => WRONG_CALL,
        Some(ran) if ran.end != End::Finished || !met.is_empty() => FAILED,
        Some(_) | None => FINE,
    };
    if let Some(ran) = ran {
        out(ran.report);
    }
    Ok(status)
}

/// Errors of the simulated run: its alarms, or the error that the program itself reported.
fn met(shared: &Shared, source: &Source, ran: &Ran) -> Vec<Wrong> {
    let mut met: Vec<_> = ran
        .alarms
        .iter()
        .map(|(place, said)| {
            let line = place.filter(|(program, _)| *program == ran.program).map_or(0, |(_, line)| line);
            Wrong { line, column: 1, message: said.get(shared.lang).to_owned() }
        })
        .collect();
    if let (true, Some(told)) = (ran.refused_itself, &ran.told) {
        let tells = |line: &u32| source.line(*line).is_some_and(|text| text.contains(&told.zh));
        let line = (1..=source.line_count() as u32).find(tells).unwrap_or(0);
        let column = source.line(line).and_then(|text| text.find("MSG").map(|at| text[..at].chars().count()));
        met.push(Wrong {
            line,
            column: column.map_or(1, |at| at as u32 + 1),
            message: told.get(shared.lang).to_owned(),
        });
    } else if ran.refused_itself {
        let said = Said::new("程序以自己的错误结束 (R62)", "the program has ended in an error of its own (R62)");
        met.push(Wrong { line: 0, column: 1, message: said.get(shared.lang).to_owned() });
    }
    met
}

fn look_at_program(shared: &Shared, call: &Check, path: &Path, bytes: Vec<u8>) -> Result<Found, CallError> {
    let number = number_of(path);
    let retained = bench::retained(shared)?;
    let settings = nc_settings(shared.kind, &retained.params);
    let axes = settings.axes;
    let folders = bench::folders(shared)?;
    let (mut programs, _) = folders.read_programs().unwrap_or_else(|_| (Programs::default(), Vec::new()));
    programs.put(beside(path));
    let library: Arc<dyn Library + Send + Sync> = Arc::new(programs);
    let mut memory = retained.variables.clone();
    let mut world =
        CheckWorld::new(&settings).with_references(references(&retained.params)).with_frames(retained.frames.clone());
    for (variable, row) in PARAM_VARIABLES {
        world.set_system(variable.first, Some(retained.params.get(row)));
    }
    let source = program(number, &path.display().to_string(), bytes).source;
    let part = bench::part(shared, number)?;
    let mut limits = in_machine(shared, &world, &retained, (&source, part.as_ref()), &settings)?;
    if let Some(part) = part.as_ref().filter(|_| !settings.zero_at_start) {
        world = start(world, retained.frames.clone(), part);
        preset(&mut memory, part, &shared.sets);
    }
    let mut show = |op: &Op| match shared.format {
        Format::Json => out(with_frame(op, op.json(axes), part.as_ref(), axes)),
        Format::Text => out(op),
    };
    let finished = part.as_ref().and_then(|part| part.finished).filter(|_| call.simulate);
    let mut rehearsal = finished.map(|finished| {
        let width_mm = retained.params.get(param::WHEEL_WIDTH);
        Rehearsal::new(finished, width_mm, settings.system, (world.position(), memory.clone()))
    });
    let mut foresight = Foresight::new(shared.kind, &retained.params);
    // An endless loop is shown once, up to its repetition. A first run without output finds that position.
    let repeated = match call.ops {
        true => check_with(&source, &library, &settings, memory.clone(), &mut world.clone(), &mut |_| {}).repeated,
        false => Vec::new(),
    };
    let mut shown = 0;
    let checked = check_with(&source, &library, &settings, memory, &mut world, &mut |block| {
        if let Some(rehearsal) = &mut rehearsal {
            rehearsal.see(block, &|at| text_of(&source, &library, at).1);
        }
        if let Some(limits) = &mut limits {
            limits.see(block);
        }
        foresight.see(block);
        if call.ops && !repeated.iter().any(|repeated| repeated.contains(&shown)) {
            block.ops.iter().for_each(&mut show);
        }
        shown += 1;
    });
    let passed = rehearsal.and_then(Rehearsal::passed).map(|passed| wrong_move(shared, &source, &library, &passed));
    // An endless loop runs into the limits; only the endless loop is reported.
    let beyond = limits.filter(|_| checked.repeated.is_empty()).map(Limits::found).unwrap_or_default();
    let foreseen = foresight.found().into_iter().chain(beyond).map(|foreseen| {
        let own = foreseen.at.program == source.number();
        let sub = if own { String::new() } else { program_title(foreseen.at.program) };
        Wrong { line: foreseen.at.line, column: 1, message: format!("{sub}{}", foreseen.said.get(shared.lang)) }
    });
    let mut moves: Vec<_> = passed.into_iter().chain(foreseen).collect();
    moves.sort_by_key(|wrong| wrong.line);
    Ok(Found { checked, moves, source, settings })
}

/// Prefix of an error in a subprogram.
fn program_title(number: u32) -> String {
    format!("{}: ", crate::defs::program::title(number))
}

/// The soft limit check, if the part (or a lathe's bar) gives the start position in the machine.
fn in_machine<'a>(
    shared: &Shared,
    world: &CheckWorld,
    retained: &'a Retained,
    (source, part): (&Arc<Source>, Option<&PartFile>),
    settings: &Settings,
) -> Result<Option<Limits<'a>>, CallError> {
    let shown = PerAxis::from_fn(|axis| if axis == Axis::X && settings.diameter { 2.0 } else { 1.0 });
    let frames = retained.frames.clone();
    if !settings.zero_at_start {
        return Ok(part.map(|part| Limits::new(start(world.clone(), frames, part), &retained.params, shown)));
    }
    // L3: the program starts at its own zero.
    let bar = if shared.part.is_some() { None } else { bar::of_program(shared.kind, &retained.params, source) };
    let Some(part) = bar.as_ref().or(part) else { return Ok(None) };
    let mut frames = frames;
    let machine = PerAxis([part.start_mm.x, part.start_mm.y, part.start_mm.z]);
    frames.preset(machine, &PerAxis([Some(0.0), None, Some(0.0)]));
    let world = world.clone().at(frames.work_from_machine(machine)).with_frames(frames);
    Ok(Some(Limits::new(world, &retained.params, shown)))
}

/// The text of a block, and its subprogram.
fn text_of(source: &Source, library: &Arc<dyn Library + Send + Sync>, at: Place) -> (Option<Arc<Source>>, String) {
    let sub = (at.program != source.number()).then(|| library.find(at.program)).flatten();
    let line = sub.as_deref().unwrap_or(source).line(at.line).unwrap_or_default();
    (sub, line)
}

/// The error of a move that the rehearsal found, at the block that caused it.
fn wrong_move(shared: &Shared, source: &Source, library: &Arc<dyn Library + Send + Sync>, passed: &Passed) -> Wrong {
    let (sub, line) = text_of(source, library, passed.at);
    let name = passed.variable.map(|number| r_parameter::name_on(number, shared.kind)).unwrap_or_default();
    let column = line.find(&name).map_or(1, |at| line[..at].chars().count() as u32 + 1);
    let program = sub.map_or_else(String::new, |sub| format!("{}: ", sub.title()));
    let block = passed.at.n.map_or_else(String::new, |n| format!("N{n} "));
    Wrong { line: passed.at.line, column, message: format!("{program}{block}{}", passed.said.get(shared.lang)) }
}

/// Adds the origin to a change of the work offset: G54 as set up for the part, the others zero.
fn with_frame(op: &Op, mut json: Value, part: Option<&PartFile>, axes: PerAxis<bool>) -> Value {
    if let (Op::Frame { g }, Some(object)) = (op, json.as_object_mut()) {
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
fn number_of(path: &Path) -> u32 {
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    crate::story::parse::program(&stem).unwrap_or(0)
}

/// The state at the start of a run: the part's zero as G54, its tool geometry and start position.
fn start(world: CheckWorld, mut frames: Frames, part: &PartFile) -> CheckWorld {
    frames.work[0] = PerAxis([part.g54_mm.x, part.g54_mm.y, part.g54_mm.z]);
    for offset in &part.offsets {
        if let Some(place) = usize::from(offset.number).checked_sub(1).and_then(|index| frames.geometry.get_mut(index))
        {
            *place = PerAxis([offset.x / 2.0, 0.0, offset.z]);
        }
    }
    let at = frames.work_from_machine(PerAxis([part.start_mm.x, part.start_mm.y, part.start_mm.z]));
    world.at(at).with_frames(frames)
}

/// Sets the part's variables that the call does not set.
fn preset(memory: &mut Memory, part: &PartFile, sets: &[(u16, f64)]) {
    for (number, value) in bench::own_values(part, sets) {
        let _ = memory.set(u32::from(number), Some(value)); // a part presets valid variables only
    }
}

/// The verdict without errors: of the check, and of the run after it.
fn verdict(checked: &Checked, ran: Option<&Ran>) -> Said {
    match ran {
        Some(ran) if ran.end != End::Finished => {
            let why = ran.told.clone().unwrap_or_default();
            let by = |text: &str| if text.is_empty() { String::new() } else { format!(": {text}") };
            Said::new(
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

fn tell_program(shared: &Shared, call: &Check, path: &Path, found: &Found, ran: Option<(&Ran, &[Wrong])>) {
    let Found { checked, moves, settings, .. } = found;
    let number = number_of(path);
    let file = path.display().to_string();
    let faults = checked.faults.iter().map(|fault| wrong_program(shared, number, fault));
    let met = ran.map_or(&[][..], |(_, met)| met);
    let wrong: Vec<_> = faults.chain(moves.iter().chain(met).cloned()).collect();
    let warnings: Vec<_> = checked.warnings.iter().map(|fault| wrong_program(shared, number, fault)).collect();
    let shown = |axis: Axis, value: f64| if axis == Axis::X && settings.diameter { value * 2.0 } else { value };
    let extents: Vec<(Axis, f64, f64)> = checked.extents.map_or_else(Vec::new, |(low, high)| {
        let present = Axis::ALL.into_iter().filter(|axis| settings.axes[*axis]);
        present.map(|axis| (axis, shown(axis, low[axis]), shown(axis, high[axis]))).collect()
    });
    match shared.format {
        Format::Json if call.ops && wrong.is_empty() => {}
        Format::Json => {
            let extents: serde_json::Map<String, Value> =
                extents.iter().map(|(axis, low, high)| (axis.to_string(), json!([low, high]))).collect();
            let mut told = json!({"file": file, "errors": errors(&wrong), "warnings": errors(&warnings),
                       "finished": checked.finished, "seconds": checked.seconds, "length": checked.length_mm,
                       "extents": extents});
            if let Some((ran, _)) = ran {
                told["simulated"] = json!(ran.end.word());
            }
            out(told);
        }
        Format::Text => {
            for at in &warnings {
                let warning = WARNING.get(shared.lang);
                eprintln!("{file}:{}:{}: {warning}{}", at.line, at.column, at.message);
            }
            tell_errors(shared, &file, &wrong, &verdict(checked, ran.map(|(ran, _)| ran)));
            let ranges: Vec<_> = extents.iter().map(|(axis, low, high)| format!("{axis} {low:.3}…{high:.3}")).collect();
            out(format!("{}  {}", summary(checked).get(shared.lang), ranges.join("  ")));
        }
    }
}

/// Lines, path length and time; if the check did not reach the end, only up to that point.
fn summary(checked: &Checked) -> Said {
    let (lines, mm, s) = (checked.lines, checked.length_mm, checked.seconds);
    if checked.finished {
        return Said::new(format!("{lines} 行  {mm:.3} mm  {s:.1} s"), format!("{lines} lines  {mm:.3} mm  {s:.1} s"));
    }
    Said::new(
        format!("{lines} 行  检查没有走到程序结束；到该循环开始重复为止 {mm:.3} mm  {s:.1} s"),
        format!(
            "{lines} lines  the check did not come to the program's end; until that loop repeats {mm:.3} mm  {s:.1} s"
        ),
    )
}
