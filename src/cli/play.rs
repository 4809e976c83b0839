//! `kt830 play`: plays a story without a display and prints one result line per statement.
//! Source: spec tools.md T5.

use std::path::Path;

use serde_json::json;

use super::args::{Format, Play, Shared};
use super::{CallError, FAILED, FINE, bench, out};
use crate::defs::fault::{FAULTS, FaultRow};
use crate::defs::kind::Kind;
use crate::link::snapshot::Tone;
use crate::story::{Line, Player, parse, parse::Statement, play::around};

/// A parsed story file.
pub struct Story {
    /// Its kind of machine.
    pub kind: Kind,
    /// Its lines.
    pub lines: Vec<Line>,
}

/// Reads a story file.
///
/// # Errors
/// The file cannot be read, or a line is invalid.
pub fn story(path: &Path, kind: Kind) -> Result<Story, CallError> {
    let text = std::fs::read_to_string(path)
        .map_err(|error| CallError::new(format!("story {}: {error}; check the path", path.display())))?;
    let (kind, lines) = parse(&text, kind).map_err(|error| CallError::new(format!("{} {error}", path.display())))?;
    Ok(Story { kind, lines })
}

/// Plays the story and prints the result of each line.
///
/// # Errors
/// The call or a file is wrong.
pub fn play(shared: &Shared, call: &Play) -> Result<u8, CallError> {
    let story = story(&call.story, shared.kind)?;
    let shared = Shared { kind: story.kind, ..shared.clone() };
    let mut rig = bench::rig(&shared)?;
    if let Some(path) = &shared.part {
        rig.mount(&bench::part_file(path)?);
    }
    let folder = call.story.parent().unwrap_or(Path::new("."));
    let eyes = super::eyes::eyes(shared.lang);
    for line in &story.lines {
        if let Statement::Part(file) = &line.statement {
            bench::part_file(&folder.join(file))?;
        }
    }
    let mut player = Player::new(&mut rig, eyes, folder, shared.part.is_some());
    for line in &story.lines {
        let before = player.rig().now();
        let done = player.play(line);
        let rig = player.rig();
        let seconds = rig.now().as_secs_f64();
        let message = &rig.snapshot().message;
        let refused = (message.tone == Tone::Refused && message.since > before).then(|| message.text.get(shared.lang));
        tell(shared.format, line, (&done, refused), seconds);
        if line.statement == Statement::FaultList && shared.format == Format::Text {
            for row in FAULTS {
                out(format!("{:14}{:20} {} {}", "", row.usage(), row.text.zh, row.text.en));
            }
        }
        if done.is_err() {
            eprintln!("{}", around(player.rig()));
            return Ok(FAILED);
        }
    }
    Ok(FINE)
}

fn tell(format: Format, line: &Line, (done, refused): (&Result<(), String>, Option<&str>), seconds: f64) {
    let text = &line.text;
    match (format, done) {
        (Format::Json, done) => {
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
            out(told);
        }
        (Format::Text, Ok(())) => {
            let refused = refused.map_or_else(String::new, |why| format!("   [{why}]"));
            out(format!("{seconds:10.3}  ok    {text}{refused}"));
        }
        (Format::Text, Err(why)) => out(format!("{seconds:10.3}  FAIL  {text}: {why} (line {})", line.number)),
    }
}
