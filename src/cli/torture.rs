//! `kt830 torture`: random courses on a simulated control, and what they have shown.

use std::fs;
use std::path::Path;
use std::time::Instant;

use serde_json::json;

use super::args::{OutputFormat, SharedArgs, TortureArgs};
use super::{CallError, FAILED, SUCCESS, print_line, setup};
use crate::defs::kind::Kind;
use crate::torture::{TortureCase, TortureCourse, replay, shortest, torture as torture_case};
use crate::units::Micros;

/// Tortures, and reports each course.
///
/// # Errors
/// The call or a file is wrong, or the folder for temporary data cannot be used.
pub fn torture(shared: &SharedArgs, call: &TortureArgs) -> Result<u8, CallError> {
    let given = [
        ("--machine", shared.machine.is_some()),
        ("--data", shared.data.is_some()),
        ("--part", shared.part.is_some()),
        ("--param", !shared.params.is_empty()),
        ("--set", !shared.sets.is_empty()),
    ];
    if let Some((word, _)) = given.into_iter().find(|(_, given)| *given) {
        return Err(CallError::new(format!("{word}: a torture begins with factory data on the machine of its kind")));
    }
    let span = Micros::from_secs_f64(call.hours * 3_600.0);
    for number in 0..call.courses {
        let in_turn = Kind::ALL[(number % Kind::ALL.len() as u64) as usize];
        let kind = shared.requested_kind.unwrap_or(in_turn);
        let case = TortureCase { kind, seed: shared.seed + number, span, bug: None };
        let began = Instant::now();
        let course = match &call.replay {
            Some(story) => replay(case, &story_lines(story)?),
            None => torture_case(case),
        };
        let course = course.map_err(CallError::new)?;
        report(shared.format, case, &course, began.elapsed().as_secs_f64());
        if course.violation.is_some() {
            keep_story(call.out.as_deref(), case, &course)?;
            return Ok(FAILED);
        }
    }
    Ok(SUCCESS)
}

fn story_lines(path: &Path) -> Result<Vec<String>, CallError> {
    let text = setup::read_text("story", path)?;
    Ok(text.lines().filter(|line| !line.trim_start().starts_with("#!")).map(str::to_owned).collect())
}

fn report(format: OutputFormat, case: TortureCase, course: &TortureCourse, seconds: f64) {
    let counts = course.counts;
    match format {
        OutputFormat::Json => print_line(json!({
            "kind": case.kind.id(),
            "seed": case.seed,
            "ticks": counts.ticks,
            "statements": course.lines.len(),
            "commands": counts.commands,
            "runs": counts.runs,
            "running_ticks": counts.running_ticks,
            "power_cuts": counts.power_cuts,
            "damages": counts.damages,
            "disk_changes": counts.disk_changes,
            "trace": course.trace.to_string(),
            "written": course.written.to_string(),
            "violation": course.violation,
            "seconds": seconds,
        })),
        OutputFormat::Text => print_line(format!(
            "{} seed {}: {} ticks, {} statements, {} commands, {} runs in {} ticks, {} power cuts, {} damages, {} disk changes, {seconds:.1} s: {}",
            case.kind.id(),
            case.seed,
            counts.ticks,
            course.lines.len(),
            counts.commands,
            counts.runs,
            counts.running_ticks,
            counts.power_cuts,
            counts.damages,
            counts.disk_changes,
            course.violation.as_deref().unwrap_or("everything holds"),
        )),
    }
}

/// Shortens the story of a broken rule and writes it, or prints it.
fn keep_story(out: Option<&Path>, case: TortureCase, course: &TortureCourse) -> Result<(), CallError> {
    let lines = shortest(case, course).map_err(CallError::new)?;
    let broken = course.violation.as_deref().unwrap_or_default();
    let call = format!("kt830 torture --kind {} --seed {} --replay FILE", case.kind.id(), case.seed);
    let text = format!("#! {broken}\n#! {call}\n{}\n", lines.join("\n"));
    match out {
        Some(path) => fs::write(path, text).map_err(CallError::at(path.display())),
        None => {
            print_line(text);
            Ok(())
        }
    }
}
