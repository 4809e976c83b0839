//! `kt830 qualify`: grinds batches with every program on machines that it was not made on, and tells which parts are good.
//! A part is judged by the drawing in its part file. Before a batch the wheel is dressed and, where no gauge measures, a first
//! part is measured and the offsets are corrected, as an operator does it. Source: P4–P8, T3.

use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use serde::Serialize;
use serde_json::json;

use super::args::{OutputFormat, QualifyArgs, SharedArgs};
use super::setup::ProgramToRun;
use super::{CallError, FAILED, SUCCESS, print_line, setup};
use crate::defs::kind::Kind;
use crate::defs::page::Page;
use crate::defs::param;
use crate::host::headless::HeadlessHost;
use crate::host::headless_run::{RunEnd, RunLimits};
use crate::io::sim::{MachineFile, PartFile, VARIATIONS};
use crate::link::command::Command;
use crate::story::parse;
use crate::units::Micros;

/// A cycle ends at a stop, and within a working day.
const LIMITS: RunLimits = RunLimits { through_stops: false, longest: Micros::from_millis(8 * 3_600_000) };
/// Ticks after the end until the axes are at rest: ten servo lags of 20 ms.
const SETTLE_TICKS: u32 = 200;
/// Deviations that make a process capable: Cpk is the distance from mean to limit in three standard deviations.
const SIGMAS: f64 = 3.0;

/// A program and the part it grinds.
struct Subject {
    number: u32,
    part: PartFile,
}

/// A machine of every kind: its name and its file.
struct MachineCandidate {
    name: String,
    text: String,
}

/// A batch on a machine.
struct QualifiedBatch<'a> {
    subject: &'a Subject,
    machine: &'a MachineCandidate,
    seed: u64,
}

/// What has become of a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
enum PartEnd {
    /// Within its drawing.
    Good,
    /// Not within its drawing, and the control says so.
    Rejected,
    /// Not within its drawing, and the control does not know it.
    Silent,
    /// Burnt, crashed or with a flat.
    Spoilt,
    /// An alarm or a hold has ended the cycle: no part.
    Stopped,
}

/// A part of a batch.
#[derive(Clone, Debug, Serialize)]
struct GroundPart {
    end: PartEnd,
    /// Greatest deviation from the drawing, µm.
    worst_um: Option<f64>,
    seconds: f64,
    /// What has stopped or spoilt it.
    why: Option<String>,
}

/// The parts of a batch, or why it cannot be ground.
type GroundBatch = Result<Vec<GroundPart>, CallError>;

/// Grinds all batches, prints the table, and fails if a part is bad without a word.
///
/// # Errors
/// A program, a machine file or a folder cannot be used.
pub fn qualify(shared: &SharedArgs, call: &QualifyArgs) -> Result<u8, CallError> {
    if shared.machine.is_some() {
        return Err(CallError::new(
            "--machine: give a folder of machines, --machines DIR, or run one program: `kt830 run`",
        ));
    }
    let mut shared = shared.clone();
    // `--programs` is the folder of every command; here it may name the programs, too.
    let mut names = call.names.clone();
    if let Some(word) = shared.programs.take_if(|folder| !folder.is_dir()) {
        let word = word.to_string_lossy();
        names.extend(word.split(',').filter(|name| *name != "all").map(str::to_owned));
    }
    let (subjects, machines) = (subjects(&names)?, candidates(call.machines.as_deref())?);
    let seeds = shared.seed..shared.seed + call.seeds;
    let of_seed = |subject, machine| move |seed| QualifiedBatch { subject, machine, seed };
    let of_machine = |subject| {
        let seeds = seeds.clone();
        machines.iter().flat_map(move |machine| seeds.clone().map(of_seed(subject, machine)))
    };
    let batches: Vec<QualifiedBatch<'_>> = subjects.iter().flat_map(of_machine).collect();
    let ground = grind_all(&shared, &batches, call.parts)?;
    // The batches of a program on a machine follow each other.
    let of_row = batches.chunks(call.seeds as usize).zip(ground.chunks(call.seeds as usize));
    let rows: Vec<QualificationRow> = of_row
        .map(|(batches, parts)| QualificationRow::of(batches[0].subject, &batches[0].machine.name, &parts.concat()))
        .collect();
    let unnoticed = rows.iter().map(|row| row.silent + row.spoilt).sum::<usize>();
    print_line(match shared.format {
        OutputFormat::Json => json!({"rows": rows, "bad_parts_unnoticed": unnoticed}).to_string(),
        OutputFormat::Text => table(&rows),
    });
    Ok(if unnoticed == 0 { SUCCESS } else { FAILED })
}

/// The programs that have a drawing, of those named.
fn subjects(names: &[String]) -> Result<Vec<Subject>, CallError> {
    let subject = |number: u32| {
        let part = PartFile::builtin(number).map_err(CallError::new)?;
        Ok(part.filter(|part| !part.drawing.is_empty()).map(|part| Subject { number, part }))
    };
    if names.is_empty() {
        return (1_001..=1_020).filter_map(|number| subject(number).transpose()).collect();
    }
    let named = |name: &String| {
        let number = parse::program(name).ok_or_else(|| CallError::new(format!("{name}: no program number")))?;
        let missing = || CallError::new(format!("{name}: no part with a drawing belongs to this program"));
        subject(number)?.ok_or_else(missing)
    };
    names.iter().map(named).collect()
}

/// The machines of a folder, else those that come with the control; each beside the machine of the kind itself.
fn candidates(folder: Option<&Path>) -> Result<Vec<MachineCandidate>, CallError> {
    let mut found = vec![MachineCandidate { name: "standard".to_owned(), text: "()".to_owned() }];
    let Some(folder) = folder else {
        found.extend(
            VARIATIONS.iter().map(|(name, text)| MachineCandidate { name: (*name).into(), text: (*text).into() }),
        );
        return Ok(found);
    };
    let entries = std::fs::read_dir(folder).map_err(CallError::at(folder.display()))?;
    let mut files: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    files.retain(|file| file.extension().is_some_and(|extension| extension == "ron"));
    files.sort();
    for file in files {
        let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        found.push(MachineCandidate { name, text: setup::read_text("machine", &file)? });
    }
    Ok(found)
}

/// Grinds the batches, as many at once as there are processors.
fn grind_all(
    shared: &SharedArgs,
    batches: &[QualifiedBatch<'_>],
    parts: u32,
) -> Result<Vec<Vec<GroundPart>>, CallError> {
    let next = AtomicUsize::new(0);
    let done: Vec<Mutex<Option<GroundBatch>>> = batches.iter().map(|_| Mutex::new(None)).collect();
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(|| {
                while let Some(at) = Some(next.fetch_add(1, Ordering::Relaxed)).filter(|at| *at < batches.len()) {
                    let ground = grind(shared, &batches[at], parts);
                    *done[at].lock().unwrap_or_else(std::sync::PoisonError::into_inner) = Some(ground);
                }
            });
        }
    });
    let ground = |one: Mutex<Option<_>>| one.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    done.into_iter().filter_map(ground).collect()
}

/// Grinds a batch; it ends with the first part that is not finished.
fn grind(shared: &SharedArgs, batch: &QualifiedBatch<'_>, parts: u32) -> Result<Vec<GroundPart>, CallError> {
    let QualifiedBatch { subject, machine, seed } = *batch;
    let kind = subject.part.kind;
    let mut shared = SharedArgs { kind, seed, machine: None, part: None, ..shared.clone() };
    // The operator may correct offsets.
    shared.params.push((param::EDIT_OFFSETS.address(), 1.0));
    let mut host = setup::headless_host(&shared)?;
    host.swap_machine(machine_of(machine, kind)?, seed);
    setup::prepare_run(&mut host, &shared, ProgramToRun::Word(&format!("O{}", subject.number)))?;
    if let Some(stopped) = set_up(&mut host, subject)? {
        return Ok(vec![stopped]);
    }
    let mut ground: Vec<GroundPart> = Vec::new();
    while ground.len() < parts as usize {
        host.machine_mut().set_part(Some(&subject.part));
        let part = grind_part(&mut host, subject);
        let ends = part.end == PartEnd::Stopped;
        ground.push(part);
        if ends {
            break;
        }
    }
    host.close();
    Ok(ground)
}

/// What an operator does before a batch: the wheel is dressed; where no gauge measures, the first part is measured, and the
/// offsets are corrected. That part belongs to no batch. Returns what has stopped it, if something has.
fn set_up(host: &mut HeadlessHost, subject: &Subject) -> Result<Option<GroundPart>, CallError> {
    host.machine_mut().set_part(Some(&subject.part));
    if let Some(dressing) = subject.part.kind.row().dressing_program {
        let values = PartFile::builtin(dressing).map_err(CallError::new)?.unwrap_or_default().variables;
        let missing = values.into_iter().filter(|(number, _)| host.controller().variable(u32::from(*number)).is_none());
        let commands: Vec<Command> = missing.map(|(number, value)| Command::SetVariable(number, Some(value))).collect();
        commands.into_iter().for_each(|command| host.send(command));
        host.send(Command::LoadProgram(dressing));
        host.step();
        let dressed = grind_part(host, subject);
        if !host.snapshot().alarms.is_empty() {
            let why = dressed.why.map(|why| format!("O{dressing}: {why}"));
            return Ok(Some(GroundPart { end: PartEnd::Stopped, why, ..dressed }));
        }
        host.send(Command::LoadProgram(subject.number));
        host.step();
    }
    if subject.part.drawing.iter().any(|size| size.offset.is_some()) {
        let first = grind_part(host, subject);
        if first.end == PartEnd::Stopped {
            return Ok(Some(first));
        }
        host.send(Command::OpenPage(Page::Offset));
        for (number, axis, increment) in host.machine().measure().corrections(&subject.part.drawing) {
            host.send(Command::AddWear { number: usize::from(number), axis, increment });
        }
        host.step();
        if let Some(refusal) = host.controller().refusal() {
            return Err(CallError::new(format!("O{}: the offset: {}", subject.number, refusal.en())));
        }
    }
    Ok(None)
}

fn machine_of(machine: &MachineCandidate, kind: Kind) -> Result<MachineFile, CallError> {
    MachineFile::of_text(&machine.text, kind).map_err(CallError::at(&machine.name))
}

/// Grinds a part and judges it.
fn grind_part(host: &mut HeadlessHost, subject: &Subject) -> GroundPart {
    let begun = host.now();
    let end = host.run_program(&LIMITS, &mut |_| true);
    let seconds = host.now().since(begun).as_secs_f64();
    (0..SETTLE_TICKS).for_each(|_| host.step());
    let deviation = host.machine().measure().deviation(&subject.part.drawing);
    let defects = host.machine().part_defects();
    let snapshot = host.snapshot();
    let alarm = snapshot.alarms.first().map(|alarm| format!("{:03} {}", alarm.number, alarm.text.en()));
    let measured = snapshot.cycle.part.filter(|part| part.measured.is_some());
    let rejects = measured.is_some_and(|part| part.verdict(None).is_bad());
    let end = match (end, deviation) {
        _ if !defects.is_empty() => PartEnd::Spoilt,
        (RunEnd::Finished, Some(deviation)) if alarm.is_none() => match deviation.keeps {
            true => PartEnd::Good,
            false if rejects => PartEnd::Rejected,
            false => PartEnd::Silent,
        },
        _ => PartEnd::Stopped,
    };
    let why = defects.first().map(|defect| defect.id().to_owned()).or(alarm);
    GroundPart { end, worst_um: deviation.map(|deviation| deviation.worst_um), seconds, why }
}

/// What a program does on a machine.
#[derive(Debug, Serialize)]
struct QualificationRow {
    program: u32,
    machine: String,
    parts: usize,
    good: usize,
    rejected: usize,
    silent: usize,
    spoilt: usize,
    stopped: usize,
    /// Greatest deviation of a finished part, µm.
    worst_um: f64,
    /// Cpk of the finished parts; none for fewer than two.
    cpk: Option<f64>,
    first_s: f64,
    last_s: f64,
    /// What has stopped or spoilt parts, each once.
    why: Vec<String>,
}

impl QualificationRow {
    fn of(subject: &Subject, machine: &str, parts: &[GroundPart]) -> Self {
        let count = |end: PartEnd| parts.iter().filter(|part| part.end == end).count();
        let finished: Vec<&GroundPart> = parts.iter().filter(|part| part.end != PartEnd::Stopped).collect();
        let deviations: Vec<f64> = finished.iter().filter_map(|part| part.worst_um).collect();
        let mut why: Vec<String> = parts.iter().filter_map(|part| part.why.clone()).collect();
        why.sort();
        why.dedup();
        // The sizes of a drawing have one tolerance.
        let limit_um = subject.part.drawing.first().map(|size| size.tolerance * 1_000.0);
        Self {
            program: subject.number,
            machine: machine.to_owned(),
            parts: parts.len(),
            good: count(PartEnd::Good),
            rejected: count(PartEnd::Rejected),
            silent: count(PartEnd::Silent),
            spoilt: count(PartEnd::Spoilt),
            stopped: count(PartEnd::Stopped),
            worst_um: deviations.iter().copied().max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(f64::NAN),
            cpk: limit_um.and_then(|limit_um| capability(&deviations, limit_um)),
            first_s: finished.first().map_or(f64::NAN, |part| part.seconds),
            last_s: finished.last().map_or(f64::NAN, |part| part.seconds),
            why,
        }
    }
}

/// Cpk of deviations within ± a limit.
fn capability(deviations: &[f64], limit: f64) -> Option<f64> {
    let count = deviations.len() as f64;
    if count < 2.0 {
        return None;
    }
    let mean = deviations.iter().sum::<f64>() / count;
    let variance = deviations.iter().map(|one| (one - mean).powi(2)).sum::<f64>() / (count - 1.0);
    Some((limit - mean.abs()) / (SIGMAS * variance.sqrt()))
}

fn table(rows: &[QualificationRow]) -> String {
    let mut lines = vec![format!(
        "{:<7}{:<12}{:>6}{:>6}{:>9}{:>8}{:>8}{:>9}{:>10}{:>7}{:>9}{:>9}",
        "program",
        " machine",
        "parts",
        "good",
        "rejected",
        "silent",
        "spoilt",
        "stopped",
        "worst µm",
        "Cpk",
        "first s",
        "last s"
    )];
    for row in rows {
        let cpk = row.cpk.map_or_else(|| "-".to_owned(), |cpk| format!("{cpk:.2}"));
        let why = row.why.join("; ");
        lines.push(
            format!(
                "O{:<6} {:<11}{:>6}{:>6}{:>9}{:>8}{:>8}{:>9}{:>10.2}{:>7}{:>9.1}{:>9.1}  {why}",
                row.program,
                row.machine,
                row.parts,
                row.good,
                row.rejected,
                row.silent,
                row.spoilt,
                row.stopped,
                row.worst_um,
                cpk,
                row.first_s,
                row.last_s
            )
            .trim_end()
            .to_owned(),
        );
    }
    let sum = |of: fn(&QualificationRow) -> usize| rows.iter().map(of).sum::<usize>();
    lines.push(format!(
        "{} parts: {} good, {} rejected, {} bad without a word, {} spoilt, {} stopped",
        sum(|row| row.parts),
        sum(|row| row.good),
        sum(|row| row.rejected),
        sum(|row| row.silent),
        sum(|row| row.spoilt),
        sum(|row| row.stopped)
    ));
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn p8_capability_is_the_distance_to_the_nearer_limit_in_three_deviations() {
        // Mean 0.5, standard deviation 1: (2 − 0.5)/3.
        let cpk = capability(&[-0.5, 0.5, 1.5], 2.0).unwrap();
        assert!((cpk - 0.5).abs() < 1e-12, "{cpk}");
        assert_eq!(capability(&[0.0], 2.0), None);
    }
}
