//! `kt830 run`: runs a program to its end on a simulated machine that is homed and ready.
//! Source: spec tools.md T3.

use serde_json::{Map, Value, json};

use super::args::{OutputFormat, RunArgs, SharedArgs};
use super::setup::ProgramToRun;
use super::trace_file::TraceFile;
use super::{CallError, FAILED, SUCCESS, print_line, setup};
use crate::defs::alarm;
use crate::defs::kind::Kind;
use crate::defs::part_verdict::PartVerdict;
use crate::defs::text::{Lang, LocalizedText, phrase};
use crate::defs::variable_name;
use crate::host::headless::HeadlessHost;
use crate::host::headless_run::{RunEnd, RunLimits};
use crate::io::sim::{PartReport, ProcessState, WheelState};
use crate::link::snapshot::{AlarmView, AxisView, Snapshot, VARIABLE_COUNT};
use crate::link::thread_cut::ThreadCut;
use crate::units::{MachinePos, Micros};

/// So many hours.
fn hours(count: u32) -> Micros {
    Micros::from_millis(u64::from(count) * 3_600_000)
}

/// Ticks after the end until the axes are in position within a micrometre: ten servo lags of 20 ms.
const SETTLE_TICKS: u32 = 200;

/// Result of a run.
pub struct RunResult {
    /// The end of the run.
    pub end: RunEnd,
    /// The number of the program.
    pub program: u32,
    /// Simulated time of all its parts, s.
    pub seconds: f64,
    /// The printed report.
    pub report: String,
    /// Its alarms: program and line, if known, and the text.
    pub alarms: Vec<(Option<(u32, u32)>, LocalizedText)>,
    /// What it waits for at its end, or its last message.
    pub message: Option<LocalizedText>,
    /// The program has set its own error number (R62).
    pub has_own_error: bool,
    /// A part is burnt, crashed or out of its limits.
    pub has_bad_part: bool,
}

/// Runs the program and prints the report. A run that ends in an alarm, a hold, a wait or an endless loop fails, and
/// one with a part that is burnt, crashed or out of its limits.
///
/// # Errors
/// The call or a file is wrong.
pub fn run(shared: &SharedArgs, call: &RunArgs) -> Result<u8, CallError> {
    let ran = run_program(shared, call, ProgramToRun::Word(&call.program))?;
    print_line(ran.report);
    let has_ended = matches!(ran.end, RunEnd::Finished | RunEnd::Pause);
    Ok(if has_ended && !ran.has_own_error && !ran.has_bad_part { SUCCESS } else { FAILED })
}

/// Runs a program; `call` tells how, and which one if `program` is its word.
///
/// # Errors
/// The call or a file is wrong.
pub fn run_program(shared: &SharedArgs, call: &RunArgs, program: ProgramToRun<'_>) -> Result<RunResult, CallError> {
    let mut host = setup::headless_host(shared)?;
    let number = setup::prepare_run(&mut host, shared, program)?;
    let mut trace = call.trace.as_deref().map(|path| TraceFile::create(path, trace_header(&host))).transpose()?;
    let variables_before = host.snapshot().variables.clone();
    let started = host.now();
    let mut batch = Vec::new();
    let (end, seconds) = loop {
        let limits = RunLimits { through_stops: call.through_stops, longest: hours(call.hours), once: false };
        let end = host.run_program(&limits, &mut |host| {
            if let Some(trace) = &mut trace {
                trace.write(trace_line(host));
            }
            true
        });
        let seconds = host.now().since(started).as_secs_f64();
        (0..SETTLE_TICKS).for_each(|_| host.step());
        batch.push(PartOfBatch::of(&mut host, end));
        if end != RunEnd::Finished || batch.len() >= call.parts as usize {
            break (end, seconds);
        }
        // The next part is mounted like the first one; the machine keeps its state, including wheel wear.
        if let Some(part) = setup::part(&host, shared, number)? {
            host.next_part(&part);
        }
    };
    if let Some(trace) = trace {
        trace.finish()?;
    }
    host.close();
    let why = stop_reason(&mut host, end, hours(call.hours));
    if let Some(why) = &why {
        warn_line!("kt830: stopped: {}", why.get(shared.lang));
    }
    let flag = variable_name::error_variable(host.kind());
    let refused_itself = flag.and_then(|flag| host.controller().variable(flag)).is_some_and(|flag| flag.abs() > 0.0);
    let snapshot = host.snapshot();
    let alarms: Vec<_> = snapshot.alarms.iter().map(|alarm| (alarm.place, alarm.text.clone())).collect();
    let told = why.clone().or_else(|| snapshot.waiting_for.clone());
    // The program can reach its end in spite of an alarm.
    let end = if end == RunEnd::Finished && !alarms.is_empty() { RunEnd::Alarm } else { end };
    let blocks = host.controller().block_count();
    let printed = host.take_printed();
    let has_bad_part = batch.iter().any(PartOfBatch::is_bad);
    let report = RunReport { end, stop_reason: why, seconds, blocks, variables_before, batch, printed };
    let report = match shared.format {
        OutputFormat::Json => report.json(&mut host, shared.lang).to_string(),
        OutputFormat::Text => report.text(&mut host, shared.lang),
    };
    Ok(RunResult {
        end,
        program: number,
        seconds,
        report,
        alarms,
        message: told,
        has_own_error: refused_itself,
        has_bad_part,
    })
}

/// Why a run stopped; at M00 the text of its MSG.
pub fn stop_reason(host: &mut HeadlessHost, end: RunEnd, longest: Micros) -> Option<LocalizedText> {
    let snapshot = host.snapshot();
    let told = snapshot.waiting_for.clone();
    match end {
        RunEnd::Finished | RunEnd::Alarm => None,
        RunEnd::Pause => told,
        RunEnd::Held | RunEnd::Refused => Some(snapshot.message.text.clone()),
        RunEnd::Waiting => {
            Some(told.unwrap_or_else(|| phrase!("等待的信号没有来", "the awaited signal does not come")))
        }
        RunEnd::TimedOut => {
            let seconds = longest.as_secs_f64();
            Some(phrase!(
                "模拟时间 {seconds} s 后停止：程序没有结束；`run --hours N` 可以更长",
                "stopped after {seconds} s of simulated time: the program has not ended; `run --hours N` gives it more",
                seconds
            ))
        }
        RunEnd::Stalled => Some(phrase!(
            "长时间没有任何移动：程序不会结束",
            "nothing has moved for a long time: the program does not end"
        )),
        RunEnd::Endless => {
            // No block has been executed before a loop at the head of the program.
            let line = Some(host.controller().current_block().line).filter(|line| *line > 0);
            let zh = line.map_or_else(|| "程序开头的循环".to_owned(), |line| format!("第 {line} 行之后的循环"));
            let en =
                line.map_or_else(|| "a loop at its beginning".to_owned(), |line| format!("a loop behind line {line}"));
            Some(LocalizedText::new(
                format!("{zh}一直重复，什么都不变：程序不会结束"),
                format!("{en} repeats and nothing changes: the program does not end"),
            ))
        }
    }
}

/// A part of a batch.
struct PartOfBatch {
    measured: PartReport,
    /// Its size by which it is judged, mm.
    size_mm: Option<f64>,
    /// None if its cycle has neither finished nor spoilt it.
    verdict: Option<PartVerdict>,
}

impl PartOfBatch {
    fn of(host: &mut HeadlessHost, end: RunEnd) -> Self {
        let measured = host.machine().measure();
        // Also of a part that its cycle has not finished.
        let spoilt = host.machine().part_defects().first().map(|defect| PartVerdict::Spoilt(*defect));
        let snapshot = host.snapshot();
        let part = snapshot.cycle.part.filter(|_| end == RunEnd::Finished);
        let simulated = snapshot.simulated.as_deref();
        let size_mm = part.and_then(|part| part.judged_size(simulated).map(|size| size.mm()));
        Self { measured, size_mm, verdict: spoilt.or_else(|| part.map(|part| part.verdict(simulated))) }
    }

    fn is_bad(&self) -> bool {
        self.verdict.is_some_and(PartVerdict::is_bad)
    }

    /// `ok`, `burn`, `out-of-tolerance`, …
    fn word(&self) -> &'static str {
        self.verdict.map_or("unfinished", PartVerdict::id)
    }
}

/// The report at the end.
struct RunReport {
    end: RunEnd,
    /// Why the run stopped.
    stop_reason: Option<LocalizedText>,
    seconds: f64,
    blocks: u64,
    variables_before: Box<[Option<f64>; VARIABLE_COUNT]>,
    /// Every part, including the last one.
    batch: Vec<PartOfBatch>,
    /// The lines that the program has printed (DPRNT).
    printed: Vec<String>,
}

impl RunReport {
    fn json(&self, host: &mut HeadlessHost, lang: Lang) -> Value {
        let snapshot = host.snapshot().clone();
        let alarms = snapshot.alarms.iter().map(|alarm| {
            let (program, line) = alarm.place.unwrap_or_default();
            let (file, file_line) = file_place(host, (program, line)).unzip();
            json!({
                "number": alarm.number,
                "text": alarm.text.get(lang),
                "cause": alarm.cause.get(lang),
                "remedy": alarm.remedy.get(lang),
                "program": program_json(host, program),
                "line": line,
                "file": file,
                "file_line": file_line,
            })
        });
        let variables: Map<String, Value> =
            self.changed(&snapshot, host.kind()).map(|(name, value)| (name, json!(value))).collect();
        let thread = |cut: &ThreadCut| json!({"line": cut.line, "lead": cut.lead_mm, "length": cut.length_mm, "error": cut.error_mm});
        let mut told = json!({
            "end": self.end.report_word(),
            "alarms": alarms.collect::<Vec<_>>(),
            "seconds": self.seconds,
            "blocks": self.blocks,
            "work": positions_json(&snapshot, |axis| axis.work),
            "machine": positions_json(&snapshot, |axis| axis.machine),
            "message": self.stop_reason.as_ref().or(snapshot.waiting_for.as_ref()).map(|told| told.get(lang)),
            "parts": snapshot.parts_counted,
            "variables": variables,
            "printed": self.printed,
            "part": host.machine().measure(),
            "verdict": self.batch.last().map(PartOfBatch::word),
            "threads": host.controller().threads().iter().map(thread).collect::<Vec<_>>(),
            "events": host.machine().events(),
        });
        // L8: a lathe has an active tool, not a wheel.
        if turns_part(host) {
            told["tool"] = json!(snapshot.tool_station);
        } else {
            told["wheel"] = json!({"diameter": host.machine().wheel().diameter_mm});
        }
        if self.batch.len() > 1 {
            told["batch"] = json!(self.batch.iter().map(|part| &part.measured).collect::<Vec<_>>());
            let verdict = |part: &PartOfBatch| json!({"verdict": part.word(), "size": part.size_mm});
            told["verdicts"] = json!(self.batch.iter().map(verdict).collect::<Vec<_>>());
        }
        told
    }

    /// Names and values of the variables changed by the run, by number.
    fn changed(&self, snapshot: &Snapshot, kind: Kind) -> impl Iterator<Item = (String, Option<f64>)> {
        let pairs = self.variables_before.iter().zip(snapshot.variables.iter()).enumerate();
        let changed = pairs.filter(|(_, (before, after))| before != after);
        changed.map(move |(number, (_, after))| (variable_name::variable_name_on(number as u32, kind), *after))
    }

    fn text(&self, host: &mut HeadlessHost, lang: Lang) -> String {
        let snapshot = host.snapshot().clone();
        let (end, seconds, blocks, parts) = (self.end.report_word(), self.seconds, self.blocks, snapshot.parts_counted);
        let mut lines = vec![format!("{end}  {seconds:.3} s  {blocks} blocks  {parts} parts")];
        for alarm in &snapshot.alarms {
            lines.push(alarm_line(host, alarm, lang));
        }
        let told = self.stop_reason.as_ref().or(snapshot.waiting_for.as_ref());
        let message = &snapshot.message.text;
        if self.end != RunEnd::Finished && !message.get(lang).is_empty() && told != Some(message) {
            lines.push(message.get(lang).into_owned());
        }
        lines.extend(told.map(|told| told.get(lang).into_owned()));
        for (axis, view) in snapshot.axes.iter().filter(|(_, view)| view.present) {
            lines.push(format!("{axis}  work {:10.3}  machine {:10.3}", view.work, view.machine));
        }
        for (name, value) in self.changed(&snapshot, host.kind()) {
            lines.push(format!("{name} = {}", value.map_or_else(String::new, |value| value.to_string())));
        }
        lines.extend(self.printed.iter().map(|line| format!("print {line}")));
        if self.batch.len() > 1 {
            lines.extend(self.batch.iter().enumerate().map(|(at, part)| part_line(at + 1, part)));
        } else if let Some(part) = self.batch.first().filter(|part| part.is_bad() || part.size_mm.is_some()) {
            lines.push(format!("part {}{}", part.word(), size_word(part)));
        }
        let part = host.machine().measure();
        lines.extend(size_lines(&part));
        lines.extend(part.heights.iter().map(|at| format!("part height at X{:.3} Z{:.3}  {:.4}", at.x, at.z, at.y)));
        lines.extend(host.controller().threads().iter().map(|cut| {
            let (line, lead, length, error) = (cut.line, cut.lead_mm, cut.length_mm, cut.error_mm * 1_000.0);
            format!("thread line {line} lead {lead:.4} over {length:.3} mm: lead error {error:.1} µm")
        }));
        lines.extend(host.machine().events().iter().map(|event| {
            let (kind, seconds, place) = (event.kind.id(), event.seconds, event.place);
            format!("event {kind} at {seconds:.3} s: {place} X{:.3} Z{:.3}", event.x, event.z)
        }));
        lines.push(match turns_part(host) {
            true => format!("tool {}", snapshot.tool_station.unwrap_or_default()),
            false => format!("wheel diameter {:.4}", host.machine().wheel().diameter_mm),
        });
        lines.join("\n")
    }
}

/// The measured diameters, faces and roughness of a part, one line each.
pub fn size_lines(part: &PartReport) -> impl Iterator<Item = String> {
    let diameters = part.diameters.iter().map(|at| format!("part diameter at Z{:.3}  {:.4}", at.z, at.d));
    let faces = part.faces.iter().map(|at| format!("part face at X{:.3}  Z {:.4}", at.x, at.z));
    let roughness = part.roughness.iter();
    let roughness = roughness.map(|of| {
        let wave = if of.waviness_um > 0.0 { format!("  waviness {:.2} µm", of.waviness_um) } else { String::new() };
        format!("part surface {}  Ra {:.2} µm{wave}", of.surface + 1, of.ra_um)
    });
    diameters.chain(faces).chain(roughness)
}

/// Whether the part turns in a main spindle and tools cut it (L7, L8).
fn turns_part(host: &HeadlessHost) -> bool {
    host.kind().is_lathe()
}

/// An alarm with its remedy; of a program that is not the first one of its file the line of the file, and who called it.
fn alarm_line(host: &HeadlessHost, alarm: &AlarmView, lang: Lang) -> String {
    let mut line = format!("alarm {:03}  {}", alarm.number, alarm.text.get(lang));
    let remedy = alarm.remedy.get(lang);
    if !remedy.is_empty() {
        line = format!("{line} – {remedy}");
    }
    let is_part = |number: u32| host.programs().get(number).is_some_and(|program| program.part.is_some());
    if let Some(place) = alarm.place.filter(|(number, _)| is_part(*number))
        && let Some((file, at)) = file_place(host, place)
    {
        line = format!("{line}  {file}:{at}");
    }
    // The cause of a mistake of the program: who called it.
    let calls = alarm.cause.get(lang);
    if alarm::find(alarm.number).is_none() && !calls.is_empty() { format!("{line}  {calls}") } else { line }
}

/// File and line of a line of a program.
fn file_place(host: &HeadlessHost, (number, line): (u32, u32)) -> Option<(String, u32)> {
    let (file, first) = host.programs().get(number)?.place();
    Some((file, first + line.checked_sub(1)?))
}

/// A program in a report: its number, or its name if it has one (L53 of the 802D, too).
fn program_json(host: &HeadlessHost, number: u32) -> Value {
    let by_name = crate::defs::program_number::is_named(number) || crate::defs::program_number::is_l_number(number);
    host.program_source(number).filter(|_| by_name).map_or_else(|| json!(number), |source| json!(source.title()))
}

/// One line for a part of a batch: the range of each measurement.
fn part_line(number: usize, of_batch: &PartOfBatch) -> String {
    let part = &of_batch.measured;
    let range = |(name, values): (&str, Vec<f64>)| {
        let least = values.iter().copied().min_by(f64::total_cmp)?;
        let greatest = values.iter().copied().max_by(f64::total_cmp)?;
        Some(format!("  {name} {least:.4} … {greatest:.4}"))
    };
    let diameters = ("diameter", part.diameters.iter().map(|at| at.d).collect());
    let faces = ("face", part.faces.iter().map(|at| at.z).collect());
    let heights = ("height", part.heights.iter().map(|at| at.y).collect());
    let told = [diameters, faces, heights].into_iter().filter_map(range).collect::<String>();
    format!("part {number}{told}  {}{}", of_batch.word(), size_word(of_batch))
}

/// The size by which a part is judged.
fn size_word(part: &PartOfBatch) -> String {
    part.size_mm.map_or_else(String::new, |mm| format!(" {mm:.4}"))
}

fn positions_json(snapshot: &Snapshot, of: impl Fn(&AxisView) -> f64) -> Value {
    let present = snapshot.axes.iter().filter(|(_, view)| view.present);
    present.map(|(axis, view)| (axis.to_string(), json!(of(view)))).collect()
}

/// The header of `--trace`.
fn trace_header(host: &HeadlessHost) -> String {
    let columns = |what: &str| {
        host.controller().axes_present().map(|axis| format!("{what}_{axis}")).collect::<Vec<_>>().join(",")
    };
    let (set, actual) = (columns("set"), columns("actual"));
    let wheel = "wheel_rpm,load_percent,tangential_n,normal_n,dullness";
    let process = "chip_w,ploughing_w,sliding_w,vibration_um,part_kelvin,head_growth_um,diamond_wear_um,gauge_um";
    format!("seconds,{set},{actual},outputs,program,line,{wheel},{process}")
}

/// The line of `--trace` for the last tick.
fn trace_line(host: &HeadlessHost) -> String {
    let control = host.controller();
    let list =
        |of: MachinePos| control.axes_present().map(|axis| format!("{:.6}", of[axis])).collect::<Vec<_>>().join(",");
    let (set, actual, place) = (list(control.set_point()), list(control.actual()), control.current_block());
    let outputs: Vec<_> = control.output_set().iter().map(|output| output.id()).collect();
    let (seconds, outputs) = (host.now().as_secs_f64(), outputs.join(" "));
    let WheelState { rpm, load_percent, tangential_n, normal_n, dullness, .. } = host.machine().wheel();
    let wheel = format!("{rpm:.1},{load_percent:.2},{tangential_n:.3},{normal_n:.3},{dullness:.4}");
    let process = process_columns(&host.machine().process());
    format!("{seconds:.3},{set},{actual},{outputs},{},{},{wheel},{process}", place.program, place.line)
}

/// The columns of `--trace` of the process beside the wheel; a gauge that is not at the part leaves its own empty.
fn process_columns(process: &ProcessState) -> String {
    let ProcessState { chip_w, ploughing_w, sliding_w, vibration_um, part_kelvin, head_growth_um, .. } = *process;
    let gauge = process.gauge_um.map_or_else(String::new, |um| format!("{um:.2}"));
    let slow = format!("{part_kelvin:.3},{head_growth_um:.3},{:.3},{gauge}", process.diamond_wear_um);
    format!("{chip_w:.1},{ploughing_w:.1},{sliding_w:.1},{vibration_um:.3},{slow}")
}
