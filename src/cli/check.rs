//! `kt830 check`: programs, page texts and pictures, without running them; every error with its place.
//! Source: spec tools.md T4.

use std::path::Path;
use std::sync::Arc;

use serde_json::{Value, json};

use super::args::{Check, Format, Run, Shared};
use super::rehearse::{Passed, Rehearsal};
use super::{CallError, FINE, WRONG_CALL, bench, out};
use crate::controller::{PARAM_VARIABLES, Programs, Retained, nc_settings, references};
use crate::defs::text::Said;
use crate::defs::{param, r_parameter};
use crate::io::sim::PartFile;
use crate::nc::{CheckWorld, Checked, Fault, Frames, Library, Memory, Op, Place, Settings, Source, World, check_with};
use crate::runtime::disk::{beside, parse_page_text, parse_picture, program};
use crate::units::{Axis, PerAxis};

/// What a file is.
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
        let wrong = match class(&name) {
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
        if wrong {
            status = WRONG_CALL;
        }
        if call.simulate && class(&name) == Class::Program && !wrong {
            let run = Run { program: path.display().to_string(), through_stops: true, parts: 1, trace: None };
            status = status.max(super::run::run(shared, &run)?);
        }
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
    // A mistake in a subprogram is told with its program.
    let sub = if fault.place.program == number { String::new() } else { format!("{}: ", fault.program()) };
    let message = format!("{sub}{} – {}", fault.cause(shared.lang), fault.remedy(shared.lang));
    Wrong { line: fault.place.line, column: fault.column, message }
}

/// Tells what came of a page text or picture; true if something is wrong.
fn tell_file(shared: &Shared, path: &Path, done: Result<(), Vec<Wrong>>) -> bool {
    let wrong = done.err().unwrap_or_default();
    let file = path.display().to_string();
    match shared.format {
        Format::Json => out(json!({"file": file, "errors": errors(&wrong)})),
        Format::Text => tell_errors(&file, &wrong),
    }
    !wrong.is_empty()
}

fn errors(wrong: &[Wrong]) -> Value {
    wrong.iter().map(|at| json!({"line": at.line, "column": at.column, "message": at.message})).collect()
}

fn tell_errors(file: &str, wrong: &[Wrong]) {
    for at in wrong {
        out(match at.line {
            0 => format!("{file}: {}", at.message),
            line => format!("{file}:{line}:{}: {}", at.column, at.message),
        });
    }
    if wrong.is_empty() {
        out(format!("{file}: ok"));
    }
}

fn check_program(shared: &Shared, call: &Check, path: &Path, bytes: Vec<u8>) -> Result<bool, CallError> {
    let number = number_of(path);
    let retained = bench::begin(shared, Retained::factory(shared.kind))?;
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
    let part = bench::part(shared, number)?;
    if let Some(part) = part.as_ref().filter(|_| !settings.zero_at_start) {
        world = start(world, retained.frames.clone(), part);
        preset(&mut memory, part);
    }
    let source = program(number, &path.display().to_string(), bytes).source;
    let mut show = |op: &Op| match shared.format {
        Format::Json => out(with_frame(op, op.json(axes), part.as_ref(), axes)),
        Format::Text => out(op),
    };
    let finished = part.as_ref().and_then(|part| part.finished).filter(|_| call.simulate);
    let mut rehearsal = finished.map(|finished| {
        let width_mm = retained.params.get(param::WHEEL_WIDTH);
        Rehearsal::new(finished, width_mm, settings.system, (world.position(), memory.clone()))
    });
    let checked = check_with(&source, &library, &settings, memory, &mut world, &mut |block| {
        if let Some(rehearsal) = &mut rehearsal {
            rehearsal.see(block, &|at| text_of(&source, &library, at).1);
        }
        if call.ops {
            block.ops.iter().for_each(&mut show);
        }
    });
    let passed = rehearsal.and_then(Rehearsal::passed).map(|passed| wrong_move(shared, &source, &library, &passed));
    tell_program(shared, call, path, (&checked, passed.as_ref()), &settings);
    Ok(!checked.faults.is_empty() || passed.is_some())
}

/// The text of a block, and the subprogram that it stands in.
fn text_of(source: &Source, library: &Arc<dyn Library + Send + Sync>, at: Place) -> (Option<Arc<Source>>, String) {
    let sub = (at.program != source.number()).then(|| library.find(at.program)).flatten();
    let line = sub.as_deref().unwrap_or(source).line(at.line).unwrap_or_default();
    (sub, line)
}

/// A move that the rehearsal found, at the block that leads to it.
fn wrong_move(shared: &Shared, source: &Source, library: &Arc<dyn Library + Send + Sync>, passed: &Passed) -> Wrong {
    let (sub, line) = text_of(source, library, passed.at);
    let name = passed.variable.map(|number| r_parameter::name_on(number, shared.kind)).unwrap_or_default();
    let column = line.find(&name).map_or(1, |at| line[..at].chars().count() as u32 + 1);
    let program = sub.map_or_else(String::new, |sub| format!("{}: ", sub.title()));
    let block = passed.at.n.map_or_else(String::new, |n| format!("N{n} "));
    Wrong { line: passed.at.line, column, message: format!("{program}{block}{}", passed.said.get(shared.lang)) }
}

/// A change of the work frame tells where the frame lies: G54 where the part's set-up puts it, the others at zero.
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

/// The O number of a file's name; 0 for a name without one.
fn number_of(path: &Path) -> u32 {
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    crate::story::parse::program(&stem).unwrap_or(0)
}

/// Where a run of the part would begin: its zero as G54, its tool geometry.
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

/// The part's values for variables that have none.
fn preset(memory: &mut Memory, part: &PartFile) {
    for (number, value) in &part.variables {
        let number = u32::from(*number);
        if matches!(memory.get(number), Ok(None)) {
            let _ = memory.set(number, Some(*value)); // a part presets only what a page may show
        }
    }
}

fn tell_program(
    shared: &Shared,
    call: &Check,
    path: &Path,
    (checked, passed): (&Checked, Option<&Wrong>),
    settings: &Settings,
) {
    let number = number_of(path);
    let file = path.display().to_string();
    let faults = checked.faults.iter().map(|fault| wrong_program(shared, number, fault));
    let wrong: Vec<_> = faults.chain(passed.cloned()).collect();
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
            out(json!({"file": file, "errors": errors(&wrong), "warnings": errors(&warnings),
                       "finished": checked.finished, "seconds": checked.seconds, "length": checked.length_mm,
                       "extents": extents}));
        }
        Format::Text => {
            for at in &warnings {
                eprintln!("{file}:{}:{}: warning: {}", at.line, at.column, at.message);
            }
            tell_errors(&file, &wrong);
            let ranges: Vec<_> = extents.iter().map(|(axis, low, high)| format!("{axis} {low:.3}…{high:.3}")).collect();
            out(format!("{}  {}", summary(checked).get(shared.lang), ranges.join("  ")));
        }
    }
}

/// Lines, way and time; where the check gave the program up, only up to there.
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
