//! `kt830 play`: plays a story without a display and prints one result line per statement.
//! Source: spec tools.md T5.

use std::path::Path;

use serde_json::json;

use super::args::{OutputFormat, PlayArgs, SharedArgs};
use super::{CallError, FAILED, SUCCESS, print_line, setup};
use crate::defs::kind::Kind;
use crate::defs::sim_fault::{FAULTS, FaultRow};
use crate::link::snapshot::Tone;
use crate::story::{Player, StoryLine, parse, parse::Statement, play::state_report};

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

/// Plays the story and prints the result of each line.
///
/// # Errors
/// The call or a file is wrong.
pub fn play(shared: &SharedArgs, call: &PlayArgs) -> Result<u8, CallError> {
    let story = read_story(&call.story, shared.kind)?;
    let shared = SharedArgs { kind: story.kind, ..shared.clone() };
    let mut rig = setup::headless_host(&shared)?;
    if let Some(path) = &shared.part {
        rig.mount_part(&setup::read_part_file(path)?);
    }
    let folder = call.story.parent().unwrap_or(Path::new("."));
    let eyes = super::page_reader::page_reader(shared.lang);
    for line in &story.lines {
        if let Statement::Part(file) = &line.statement {
            setup::read_part_file(&folder.join(file))?;
        }
    }
    let mut player = Player::new(&mut rig, eyes, folder, shared.part.is_some());
    for line in &story.lines {
        let before = player.host().now();
        let done = player.play(line);
        let rig = player.host();
        let seconds = rig.now().as_secs_f64();
        let message = &rig.snapshot().message;
        let refused = (message.tone == Tone::Refused && message.since > before).then(|| message.text.get(shared.lang));
        print_outcome(shared.format, line, (&done, refused), seconds);
        if line.statement == Statement::FaultList && shared.format == OutputFormat::Text {
            for row in FAULTS {
                print_line(format!("{:14}{:20} {} {}", "", row.usage(), row.text.zh, row.text.en));
            }
        }
        if done.is_err() {
            eprintln!("{}", state_report(player.host()));
            return Ok(FAILED);
        }
    }
    Ok(SUCCESS)
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
