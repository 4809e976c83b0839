//! `kt830 play`: plays a story without a display and prints one result line per statement.
//! Source: spec tools.md T5.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use serde_json::{Map, Value, json};

use super::args::{OutputFormat, PlayArgs, SharedArgs};
use super::{CallError, FAILED, SUCCESS, print_line, setup};
use crate::defs::kind::Kind;
use crate::defs::sim_fault::{FAULTS, FaultRow};
use crate::defs::text::Lang;
use crate::host::headless::HeadlessHost;
use crate::host::storage::DirectStorage;
use crate::io::trace;
use crate::link::snapshot::Tone;
use crate::story::{Player, Stage, Statement, StoryLine, parse, play::state_report};
use crate::units::Micros;

/// A parsed story file.
pub struct StoryFile {
    /// Its kind of machine.
    pub kind: Kind,
    /// Its lines.
    pub lines: Vec<StoryLine>,
}

/// Reads a story file.
///
/// # Errors
/// The file cannot be read, or a line is invalid.
pub fn read_story(path: &Path, kind: Kind) -> Result<StoryFile, CallError> {
    let text = std::fs::read_to_string(path)
        .map_err(|error| CallError::new(format!("story {}: {error}; check the path", path.display())))?;
    let (kind, lines) = parse(&text, kind).map_err(|error| CallError::new(format!("{} {error}", path.display())))?;
    Ok(StoryFile { kind, lines })
}

/// The stage of `kt830 play`: a headless host that stops at a time and writes a trace.
struct TracedStage {
    host: HeadlessHost,
    until: Option<Micros>,
    trace: Option<TickTraceFile>,
}

impl Stage for TracedStage {
    type Storage = DirectStorage;

    fn host(&mut self) -> &mut HeadlessHost {
        &mut self.host
    }

    fn step(&mut self) {
        if self.is_interrupted() {
            return;
        }
        self.host.step();
        if let Some(trace) = &mut self.trace {
            trace.write(self.host.trace_row());
        }
    }

    fn is_interrupted(&self) -> bool {
        self.until.is_some_and(|until| self.host.now() >= until)
    }
}

/// The file of `--trace`: one row a tick.
struct TickTraceFile {
    file: BufWriter<File>,
    path: String,
    /// The first error; nothing is written after it.
    error: Option<std::io::Error>,
}

impl TickTraceFile {
    fn create(path: &Path) -> Result<Self, CallError> {
        let path_text = path.display().to_string();
        let file = File::create(path).map_err(|error| CallError::new(format!("--trace {path_text}: {error}")))?;
        let mut trace = Self { file: BufWriter::new(file), path: path_text, error: None };
        trace.write(trace::HEADER);
        Ok(trace)
    }

    fn write(&mut self, row: impl std::fmt::Display) {
        if self.error.is_none() {
            self.error = writeln!(self.file, "{row}").err();
        }
    }

    fn finish(mut self) -> Result<(), CallError> {
        let written = self.error.take().map_or(Ok(()), Err).and_then(|()| self.file.flush());
        written.map_err(|error| CallError::new(format!("--trace {}: {error}", self.path)))
    }
}

/// Plays the story and prints the result of each line; with `--until` to that time, then the state.
///
/// # Errors
/// The call or a file is wrong.
pub fn play(shared: &SharedArgs, call: &PlayArgs) -> Result<u8, CallError> {
    let story = read_story(&call.story, shared.kind)?;
    let shared = SharedArgs { kind: story.kind, ..shared.clone() };
    let mut host = setup::headless_host(&shared)?;
    if let Some(path) = &shared.part {
        host.mount_part(&setup::read_part_file(path)?);
    }
    let folder = call.story.parent().unwrap_or(Path::new("."));
    for line in &story.lines {
        if let Statement::Part(file) = &line.statement {
            setup::read_part_file(&folder.join(file))?;
        }
    }
    let trace = call.trace.as_deref().map(TickTraceFile::create).transpose()?;
    let mut stage = TracedStage { host, until: call.until, trace };
    let mut player =
        Player::new(&mut stage, super::page_reader::page_reader(shared.lang), folder, shared.part.is_some());
    let status = play_lines(&shared, &story.lines, &mut player);
    drop(player);
    if status == SUCCESS && call.until.is_some() {
        while !stage.is_interrupted() {
            stage.step();
        }
        match shared.format {
            OutputFormat::Text => print_line(state_report(&mut stage.host)),
            OutputFormat::Json => print_line(state_json(&mut stage.host, shared.lang)),
        }
    }
    stage.trace.map_or(Ok(status), |trace| trace.finish().map(|()| status))
}

/// Plays the lines up to the first that fails, or to the end of the time.
fn play_lines(shared: &SharedArgs, lines: &[StoryLine], player: &mut Player<'_, TracedStage>) -> u8 {
    for line in lines {
        if player.stage().is_interrupted() {
            return SUCCESS;
        }
        let before = player.host().now();
        let done = player.play(line);
        // The time was over while the statement waited: it has neither passed nor failed.
        if player.stage().is_interrupted() && !matches!(line.statement, Statement::Expect(_)) && done.is_err() {
            return SUCCESS;
        }
        let host = player.host();
        let seconds = host.now().as_secs_f64();
        let message = &host.snapshot().message;
        let refused = (message.tone == Tone::Refused && message.since > before).then(|| message.text.get(shared.lang));
        print_outcome(shared.format, line, (&done, refused.as_deref()), seconds);
        if line.statement == Statement::FaultList && shared.format == OutputFormat::Text {
            for row in FAULTS {
                print_line(format!("{:14}{:20} {} {}", "", row.usage(), row.text.zh, row.text.en));
            }
        }
        if done.is_err() {
            eprintln!("{}", state_report(player.host()));
            return FAILED;
        }
    }
    SUCCESS
}

/// The state at the end of `--until` for programs.
fn state_json(host: &mut HeadlessHost, lang: Lang) -> Value {
    let seconds = host.now().as_secs_f64();
    let snapshot = host.snapshot();
    let axes: Map<String, Value> = snapshot
        .axes
        .iter()
        .filter(|(_, view)| view.present)
        .map(|(axis, view)| {
            (axis.to_string(), json!({"work": view.work, "machine": view.machine, "to_go": view.to_go}))
        })
        .collect();
    let alarms = snapshot.alarms.iter().map(|alarm| json!({"number": alarm.number, "text": alarm.text.get(lang)}));
    json!({
        "seconds": seconds,
        "state": snapshot.state.id(),
        "mode": snapshot.mode.name().en,
        "page": snapshot.page.id(),
        "program": snapshot.title(snapshot.program.number),
        "line": snapshot.program.line,
        "axes": axes,
        "outputs": snapshot.outputs.iter().map(|output| output.id()).collect::<Vec<_>>(),
        "alarms": alarms.collect::<Vec<_>>(),
        "message": snapshot.message.text.get(lang),
    })
}

fn print_outcome(
    format: OutputFormat,
    line: &StoryLine,
    (done, refused): (&Result<(), String>, Option<&str>),
    seconds: f64,
) {
    let text = &line.text;
    match (format, done) {
        (OutputFormat::Json, done) => {
            let mut told = json!({"line": line.number, "statement": text, "ok": done.is_ok(), "seconds": seconds});
            if let Err(why) = done {
                told["why"] = json!(why);
            }
            if line.statement == Statement::FaultList {
                let row = |row: FaultRow| json!({"fault": row.usage(), "zh": row.text.zh, "en": row.text.en});
                told["faults"] = FAULTS.map(row).into();
            }
            if let Some(refused) = refused {
                told["refused"] = json!(refused);
            }
            print_line(told);
        }
        (OutputFormat::Text, Ok(())) => {
            let refused = refused.map_or_else(String::new, |why| format!("   [{why}]"));
            print_line(format!("{seconds:10.3}  ok    {text}{refused}"));
        }
        (OutputFormat::Text, Err(why)) => {
            print_line(format!("{seconds:10.3}  FAIL  {text}: {why} (line {})", line.number))
        }
    }
}
