//! `kt830 qualify`: grinds batches with every program on machines that it was not made on, and tells which parts are good.
//! A part is judged by the drawing in its part file. As an operator does it, before a batch the wheel is dressed and, where no
//! gauge measures, a first part is measured and the offsets are corrected; every part is measured and its size is typed.
//! Source: P4–P8, T3.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use serde::Serialize;
use serde_json::json;

use super::args::{OutputFormat, QualifyArgs, SharedArgs};
use super::setup::ProgramToRun;
use super::{CallError, FAILED, SUCCESS, print_line, setup};
use crate::defs::key::Key;
use crate::defs::page::Page;
use crate::defs::{param, program_number};
use crate::host::headless::HeadlessHost;
use crate::host::headless_run::{RunEnd, RunLimits};
use crate::io::sim::{DrawingSize, MachineFile, PartFile, VARIATIONS};
use crate::link::command::Command;
use crate::link::part_result::{CorrectionAdvice, NominalSize, PartCommand, PartResult};
use crate::story::parse;
use crate::units::Micros;

/// A cycle ends at a stop, and within a working day.
const LIMITS: RunLimits = RunLimits { through_stops: false, longest: Micros::from_millis(8 * 3_600_000), once: false };
/// Ticks after the end until the axes are at rest: ten servo lags of 20 ms.
const SETTLE_TICKS: u32 = 200;
/// Deviations that make a process capable: Cpk is the distance from mean to limit in three standard deviations.
const SIGMAS: f64 = 3.0;

/// Parts by whose mean a gauge is set.
const GAUGE_PARTS: u8 = 3;
/// R66 of the vertical lathe-grinder.
const SIZE_GROUND_LAST: u16 = 666;

/// A program and the part it grinds.
struct Subject {
    name: &'static str,
    number: u32,
    part: PartFile,
}

/// A machine: its name and its file.
struct MachineCandidate {
    name: String,
    text: String,
}

/// The batches of a program on a machine, one for each seed.
struct QualifiedRow<'a> {
    subject: &'a Subject,
    name: &'a str,
    machine: MachineFile,
}

/// A batch on a machine.
struct QualifiedBatch<'a> {
    row: &'a QualifiedRow<'a>,
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
    /// Not within its drawing; the control knows it only by the size that the operator has measured and typed.
    Found,
    /// Not within its drawing, and the control does not know it.
    Silent,
    /// Burnt, crashed or with a flat, whether an alarm has followed or not.
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
    /// Deviation of each measured place from the drawing, and its tolerance, µm.
    places_um: Vec<(f64, f64)>,
    seconds: f64,
    /// What has stopped or spoilt it.
    why: Option<String>,
}

/// The parts of a batch, or why it cannot be ground.
type GroundBatch = Result<Vec<GroundPart>, CallError>;

/// Grinds all batches, prints the table, and fails if a part is bad without a word, or spoilt.
///
/// # Errors
/// A word of the call, a program, a machine file or a folder cannot be used.
pub fn qualify(shared: &SharedArgs, call: &QualifyArgs) -> Result<u8, CallError> {
    refuse_words(shared)?;
    let mut shared = shared.clone();
    // `--programs` is the folder of every command; here it may name the programs, too.
    let mut names = call.names.clone();
    if let Some(word) = shared.programs.take_if(|folder| !folder.is_dir()) {
        names.extend(word.to_string_lossy().split(',').map(str::to_owned));
    }
    let (subjects, machines) = (subjects(&shared, &names)?, candidates(call.machines.as_deref())?);
    let last = shared.seed.checked_add(call.seeds);
    let last =
        last.ok_or_else(|| CallError::new(format!("--seed {}: too great for {} seeds", shared.seed, call.seeds)))?;
    let planned = plan(&subjects, &machines)?;
    let seeds = shared.seed..last;
    let batches: Vec<QualifiedBatch<'_>> =
        planned.iter().flat_map(|row| seeds.clone().map(move |seed| QualifiedBatch { row, seed })).collect();
    let as_text = shared.format == OutputFormat::Text;
    if as_text {
        print_line(headings());
    }
    let mut rows = Vec::with_capacity(planned.len());
    // The batches of a program on a machine follow each other. A row is told as soon as it is known.
    let mut of_row = Vec::with_capacity(call.seeds as usize);
    grind_all(&shared, &batches, call.parts, &mut |ground| {
        of_row.push(ground);
        if of_row.len() == call.seeds as usize {
            let row = QualificationRow::of(&planned[rows.len()], &std::mem::take(&mut of_row));
            if as_text {
                print_line(row.line());
            }
            rows.push(row);
        }
    })?;
    let failed = rows.iter().map(|row| row.silent + row.spoilt).sum::<usize>();
    print_line(match shared.format {
        OutputFormat::Json => json!({"rows": rows, "silent_or_spoilt": failed}).to_string(),
        OutputFormat::Text => sums(&rows),
    });
    Ok(if failed == 0 { SUCCESS } else { FAILED })
}

/// What a qualification decides itself.
fn refuse_words(shared: &SharedArgs) -> Result<(), CallError> {
    if shared.machine.is_some() {
        return Err(CallError::new(
            "--machine: give a folder of machines, --machines DIR, or run one program: `kt830 run`",
        ));
    }
    let given = [
        ("--data", shared.data.is_some()),
        ("--part", shared.part.is_some()),
        ("--kind", shared.requested_kind.is_some()),
    ];
    let Some((word, _)) = given.into_iter().find(|(_, given)| *given) else { return Ok(()) };
    Err(CallError::new(format!("{word}: a qualification begins with factory data, kind and part of each program")))
}

/// The programs that have a drawing, of those named; of all, those in the folder. Missing folders and files are installed
/// here, before many batches want them.
fn subjects(shared: &SharedArgs, names: &[String]) -> Result<Vec<Subject>, CallError> {
    let subject = |name: &'static str| {
        let number = program_number::from_name(name);
        let part = PartFile::builtin(number).map_err(CallError::new)?;
        Ok(part.filter(|part| !part.drawing.is_empty()).map(|part| Subject { name, number, part }))
    };
    let mut all: Vec<Subject> =
        PartFile::builtin_names().filter_map(|name| subject(name).transpose()).collect::<Result<_, CallError>>()?;
    let takes_all = names.is_empty() || names.iter().any(|name| name.eq_ignore_ascii_case("all"));
    let wanted: Vec<&String> = names.iter().filter(|name| !name.eq_ignore_ascii_case("all")).collect();
    let number = |name: &str| parse::program(name).unwrap_or_else(|| program_number::from_name(name));
    let missing = |name: &&&String| all.iter().all(|subject| subject.number != number(name));
    if let Some(name) = wanted.iter().find(missing) {
        return Err(CallError::new(format!("{name}: no part with a drawing belongs to this program")));
    }
    let is_wanted = |subject: &Subject| wanted.iter().any(|name| subject.number == number(name));
    all.retain(|subject| takes_all || is_wanted(subject));
    let mut found = Vec::with_capacity(all.len());
    for subject in all {
        let mut host = setup::headless_host(&SharedArgs { kind: subject.part.kind, ..shared.clone() })?;
        let program = setup::find_program(&mut host, subject.name);
        host.close();
        match program {
            Ok(_) => found.push(subject),
            Err(missing) if is_wanted(&subject) => return Err(missing),
            Err(_) => {}
        }
    }
    Ok(found)
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

/// Every program on every machine of its kind; a whole machine of another kind is left out.
fn plan<'a>(subjects: &'a [Subject], machines: &'a [MachineCandidate]) -> Result<Vec<QualifiedRow<'a>>, CallError> {
    let mut rows = Vec::new();
    for subject in subjects {
        let kind = subject.part.kind;
        for MachineCandidate { name, text } in machines {
            if MachineFile::parse(text).is_ok_and(|machine| machine.kind != kind) {
                continue;
            }
            let machine = MachineFile::of_text(text, kind).map_err(CallError::at(name))?;
            rows.push(QualifiedRow { subject, name, machine });
        }
    }
    Ok(rows)
}

/// Grinds the batches, as many at once as there are processors, and gives each to `then`, in their order.
///
/// # Errors
/// The first batch that cannot be ground; those behind it are not begun.
fn grind_all(
    shared: &SharedArgs,
    batches: &[QualifiedBatch<'_>],
    parts: u32,
    then: &mut dyn FnMut(Vec<GroundPart>),
) -> Result<(), CallError> {
    let next = &AtomicUsize::new(0);
    let (sender, done) = crossbeam_channel::unbounded();
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            let sender = sender.clone();
            scope.spawn(move || {
                while let Some(at) = Some(next.fetch_add(1, Ordering::Relaxed)).filter(|at| *at < batches.len()) {
                    let ground = grind(shared, &batches[at], parts);
                    if ground.is_err() {
                        next.store(batches.len(), Ordering::Relaxed);
                    }
                    // Behind an error nobody receives it.
                    let _ = sender.send((at, ground));
                }
            });
        }
        drop(sender);
        let mut early: BTreeMap<usize, GroundBatch> = BTreeMap::new();
        let mut told = 0;
        for (at, ground) in done {
            early.insert(at, ground);
            while let Some(ground) = early.remove(&told) {
                then(ground?);
                told += 1;
            }
        }
        Ok(())
    })
}

/// Grinds a batch; it ends with the first part that is not finished.
fn grind(shared: &SharedArgs, batch: &QualifiedBatch<'_>, parts: u32) -> Result<Vec<GroundPart>, CallError> {
    let QualifiedBatch { row: QualifiedRow { subject, machine, .. }, seed } = *batch;
    let kind = subject.part.kind;
    let mut shared = SharedArgs { kind, seed, ..shared.clone() };
    // The operator may correct offsets.
    shared.params.push((param::EDIT_OFFSETS.address(), 1.0));
    judge_typed_sizes(&mut shared, &subject.part);
    let mut host = setup::headless_host(&shared)?;
    host.swap_machine(machine.clone(), seed);
    setup::prepare_run(&mut host, &shared, ProgramToRun::Word(subject.name))?;
    let mut part_file = subject.part.clone();
    if let Some(failed) = set_up(&mut host, subject, &mut part_file)? {
        return Ok(vec![failed]);
    }
    let mut ground: Vec<GroundPart> = Vec::new();
    while ground.len() < parts as usize {
        host.machine_mut().set_part(Some(&part_file));
        let mut part = grind_part(&mut host, subject);
        let ends = part.end == PartEnd::Stopped;
        if !ends {
            measure(&mut host, subject.name, &part_file)?;
        }
        if part.end == PartEnd::Silent && host.snapshot().cycle.part.is_some_and(|part| part.verdict(None).is_bad()) {
            part.end = PartEnd::Found;
        }
        ground.push(part);
        if ends || !host.snapshot().alarms.is_empty() {
            break;
        }
    }
    host.close();
    Ok(ground)
}

/// The operator has entered the tolerance of the drawing, by which the size that is typed is judged. R parameters have no page
/// that names measured and finished size: parameters do.
fn judge_typed_sizes(shared: &mut SharedArgs, part: &PartFile) {
    let Some(size) = part.drawing.first() else { return };
    let limits = [(param::TREND_LOWER, -size.tolerance), (param::TREND_UPPER, size.tolerance)];
    shared.params.extend(limits.map(|(row, mm)| (row.address(), mm)));
    let Some(typed) = size.typed.filter(|_| part.finished.is_some()) else { return };
    let variables = [(param::TREND_SIZE_VARIABLE, typed), (param::TREND_NOMINAL_VARIABLE, SIZE_GROUND_LAST)];
    shared.params.extend(variables.map(|(row, variable)| (row.address(), f64::from(variable))));
}

/// What an operator does before a batch: the wheel is dressed; where no gauge measures, the first part is measured, and the
/// offsets are corrected; a gauge is set by its first parts. These parts belong to no batch. Returns what has stopped or spoilt
/// one, if something has.
fn set_up(
    host: &mut HeadlessHost,
    subject: &Subject,
    part_file: &mut PartFile,
) -> Result<Option<GroundPart>, CallError> {
    host.machine_mut().set_part(Some(&subject.part));
    // The internal grinding spindle has a dresser of its own, which its program uses.
    let dressing = subject.part.kind.row().dressing_program.filter(|_| subject.part.internal_spindle.is_none());
    if let Some(dressing) = dressing {
        let values = PartFile::builtin(dressing).map_err(CallError::new)?.unwrap_or_default().variables;
        let missing = values.into_iter().filter(|(number, _)| host.controller().variable(u32::from(*number)).is_none());
        let commands: Vec<Command> = missing.map(|(number, value)| Command::SetVariable(number, Some(value))).collect();
        commands.into_iter().for_each(|command| host.send(command));
        host.send(Command::LoadProgram(dressing));
        host.step();
        let dressed = grind_part(host, subject);
        if matches!(dressed.end, PartEnd::Stopped | PartEnd::Spoilt) {
            let why = dressed.why.unwrap_or_else(|| "it did not end".to_owned());
            return Ok(Some(GroundPart { why: Some(format!("O{dressing}: {why}")), ..dressed }));
        }
        host.send(Command::LoadProgram(subject.number));
        host.step();
    }
    if subject.part.has_typed_size() || subject.part.drawing.iter().any(|size| size.offset.is_some()) {
        let first = grind_part(host, subject);
        if matches!(first.end, PartEnd::Stopped | PartEnd::Spoilt) {
            return Ok(Some(first));
        }
        if subject.part.has_typed_size() {
            type_first_sizes(host, subject);
        } else {
            correct_offsets(host, subject.name, &subject.part, |_| true)?;
        }
    }
    Ok(set_gauges(host, subject, part_file))
}

/// Types the sizes of the first part, and grinds another one with them.
fn type_first_sizes(host: &mut HeadlessHost, subject: &Subject) {
    host.type_measured_size(&subject.part);
    // A program that corrects itself may stop for a first part that is out of tolerance.
    host.machine_mut().set_part(Some(&subject.part));
    if grind_part(host, subject).end == PartEnd::Stopped {
        host.send(Command::Press(Key::Reset));
        host.step();
    } else {
        host.type_measured_size(&subject.part);
    }
}

/// Sets each gauge by the mean of the first parts, as its zero screw is turned.
fn set_gauges(host: &mut HeadlessHost, subject: &Subject, part_file: &mut PartFile) -> Option<GroundPart> {
    let drawing = &subject.part.drawing;
    if !drawing.iter().any(|size| part_file.gauge_of_mut(size).is_some()) {
        return None;
    }
    for _ in 0..GAUGE_PARTS {
        host.machine_mut().set_part(Some(&subject.part));
        let part = grind_part(host, subject);
        if matches!(part.end, PartEnd::Stopped | PartEnd::Spoilt) {
            return Some(part);
        }
        let report = host.machine().measure();
        for size in drawing {
            let off = report.mean_deviation_mm(drawing, size);
            if let Some((gauge, off)) = part_file.gauge_of_mut(size).zip(off) {
                gauge.set -= off / f64::from(GAUGE_PARTS);
            }
        }
        host.type_measured_size(&subject.part);
    }
    None
}

/// The operator measures the part. What he finds he types on its page, else on the card of the last part; other sizes he
/// corrects by their offset.
fn measure(host: &mut HeadlessHost, name: &str, part: &PartFile) -> Result<(), CallError> {
    host.type_measured_size(part);
    match host.snapshot().cycle.part.and_then(|result| Some((result, result.nominal?))) {
        Some((result, nominal)) => type_on_card(host, part, result, nominal),
        None if part.has_typed_size() => {}
        None => correct_offsets(host, name, part, |used| used > 0.5)?,
    }
    Ok(())
}

/// Corrects the offsets of sizes that have used up a share of their tolerance for which it is due.
fn correct_offsets(
    host: &mut HeadlessHost,
    name: &str,
    part: &PartFile,
    due: fn(f64) -> bool,
) -> Result<(), CallError> {
    let report = host.machine().measure();
    let is_off = |size: &DrawingSize| {
        let off = report.mean_deviation_mm(&part.drawing, size);
        off.is_some_and(|off| due(off.abs() / size.tolerance))
    };
    host.send(Command::OpenPage(Page::Offset));
    for (number, axis, increment) in report.corrections(&part.drawing) {
        if part.drawing.iter().any(|size| size.offset == Some((number, axis)) && is_off(size)) {
            host.send(Command::AddWear { number: usize::from(number), axis, increment });
        }
    }
    host.step();
    match host.controller().refusal() {
        Some(refusal) => Err(CallError::new(format!("{name}: the offset: {}", refusal.en()))),
        None => Ok(()),
    }
}

/// Types the size of the place that is farthest off, and takes the correction that the card proposes.
fn type_on_card(host: &mut HeadlessHost, part: &PartFile, result: PartResult, nominal: NominalSize) {
    let sizes = part.drawing.iter().zip(host.machine().measure().size_deviations_um(&part.drawing));
    let is_main = |size: &DrawingSize| size.typed.is_none() && (size.size - nominal.mm).abs() < 1e-9;
    let mut measured = sizes.filter(|(size, _)| is_main(size)).filter_map(|(_, um)| um);
    let Some(um) = measured.next() else { return };
    let ended_at = result.ended_at;
    host.send(Command::Part(PartCommand::TypeSize { ended_at, mm: nominal.mm + um / 1_000.0 }));
    host.step();
    let proposed = host.snapshot().cycle.part.map(|part| part.advice(None));
    if let Some(CorrectionAdvice::Add(_, increment)) = proposed {
        host.send(Command::Part(PartCommand::Correct { ended_at, increment }));
        host.step();
    }
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
    let places_um = host.machine().measure().place_deviations_um(&subject.part.drawing);
    GroundPart { end, worst_um: deviation.map(|deviation| deviation.worst_um), places_um, seconds, why }
}

/// What a program does on a machine.
#[derive(Debug, Serialize)]
struct QualificationRow {
    program: &'static str,
    machine: String,
    parts: usize,
    good: usize,
    rejected: usize,
    found: usize,
    silent: usize,
    spoilt: usize,
    stopped: usize,
    /// Greatest deviation of a finished part, µm.
    worst_um: f64,
    /// Least Cpk of the measured places in the batches; none for fewer than two parts.
    cpk: Option<f64>,
    first_s: f64,
    last_s: f64,
    /// What has stopped or spoilt parts, each once.
    why: Vec<String>,
    /// Greatest deviation of each part in the order of grinding, µm, one list for each seed; none where nothing was measured.
    deviations_um: Vec<Vec<Option<f64>>>,
}

impl QualificationRow {
    fn of(row: &QualifiedRow<'_>, batches: &[Vec<GroundPart>]) -> Self {
        let parts = batches.concat();
        let count = |end: PartEnd| parts.iter().filter(|part| part.end == end).count();
        let finished: Vec<&GroundPart> = parts.iter().filter(|part| part.end != PartEnd::Stopped).collect();
        let deviations: Vec<f64> = finished.iter().filter_map(|part| part.worst_um).collect();
        let mut why: Vec<String> = parts.iter().filter_map(|part| part.why.clone()).collect();
        why.sort();
        why.dedup();
        let of_place = |batch: &[GroundPart], index: usize| {
            let found: Vec<(f64, f64)> = batch.iter().filter_map(|part| part.places_um.get(index).copied()).collect();
            let deviations: Vec<f64> = found.iter().map(|(um, _)| *um).collect();
            capability(&deviations, found.first()?.1)
        };
        let places = |batch: &[GroundPart]| batch.iter().map(|part| part.places_um.len()).max().unwrap_or_default();
        let capabilities =
            batches.iter().flat_map(|batch| (0..places(batch)).filter_map(|index| of_place(batch, index)));
        Self {
            program: row.subject.name,
            machine: row.name.to_owned(),
            parts: parts.len(),
            good: count(PartEnd::Good),
            rejected: count(PartEnd::Rejected),
            found: count(PartEnd::Found),
            silent: count(PartEnd::Silent),
            spoilt: count(PartEnd::Spoilt),
            stopped: count(PartEnd::Stopped),
            worst_um: deviations.iter().copied().max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(f64::NAN),
            cpk: capabilities.min_by(f64::total_cmp),
            first_s: finished.first().map_or(f64::NAN, |part| part.seconds),
            last_s: finished.last().map_or(f64::NAN, |part| part.seconds),
            why,
            deviations_um: batches.iter().map(|batch| batch.iter().map(|part| part.worst_um).collect()).collect(),
        }
    }

    /// Its line of the table.
    fn line(&self) -> String {
        let cpk = self.cpk.map_or_else(|| "-".to_owned(), |cpk| format!("{cpk:.2}"));
        let line = format!(
            "{:<7} {:<11}{:>6}{:>6}{:>9}{:>7}{:>8}{:>8}{:>9}{:>10.2}{:>7}{:>9.1}{:>9.1}  {}",
            self.program,
            self.machine,
            self.parts,
            self.good,
            self.rejected,
            self.found,
            self.silent,
            self.spoilt,
            self.stopped,
            self.worst_um,
            cpk,
            self.first_s,
            self.last_s,
            self.why.join("; ")
        );
        line.trim_end().to_owned()
    }
}

/// Cpk of deviations within ± a limit; none for fewer than two, or if all are equal.
fn capability(deviations: &[f64], limit: f64) -> Option<f64> {
    let count = deviations.len() as f64;
    if count < 2.0 {
        return None;
    }
    let mean = deviations.iter().sum::<f64>() / count;
    let variance = deviations.iter().map(|one| (one - mean).powi(2)).sum::<f64>() / (count - 1.0);
    Some((limit - mean.abs()) / (SIGMAS * variance.sqrt())).filter(|cpk| cpk.is_finite())
}

/// The headings of the table.
fn headings() -> String {
    format!(
        "{:<7}{:<12}{:>6}{:>6}{:>9}{:>7}{:>8}{:>8}{:>9}{:>10}{:>7}{:>9}{:>9}",
        "program",
        " machine",
        "parts",
        "good",
        "rejected",
        "found",
        "silent",
        "spoilt",
        "stopped",
        "worst µm",
        "Cpk",
        "first s",
        "last s"
    )
}

/// The last line of the table.
fn sums(rows: &[QualificationRow]) -> String {
    let sum = |of: fn(&QualificationRow) -> usize| rows.iter().map(of).sum::<usize>();
    format!(
        "{} parts: {} good, {} rejected, {} found by measuring, {} bad without a word, {} spoilt, {} stopped",
        sum(|row| row.parts),
        sum(|row| row.good),
        sum(|row| row.rejected),
        sum(|row| row.found),
        sum(|row| row.silent),
        sum(|row| row.spoilt),
        sum(|row| row.stopped)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn p8_capability_is_the_distance_to_the_nearer_limit_in_three_deviations() {
        // Mean 0.5, standard deviation 1: (2 − 0.5)/3.
        let cpk = capability(&[-0.5, 0.5, 1.5], 2.0).unwrap();
        assert!((cpk - 0.5).abs() < 1e-12, "{cpk}");
        assert_eq!((capability(&[0.0], 2.0), capability(&[0.5, 0.5], 2.0)), (None, None));
    }
}
