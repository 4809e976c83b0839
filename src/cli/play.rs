//! `kt830 play`: a story without a display, one line of outcome for each line of the story.
//! Source: spec tools.md T5.

use std::path::Path;

use serde_json::json;

use super::args::{Format, Play, Shared};
use super::{CallError, FAILED, FINE, bench, out};
use crate::defs::kind::Kind;
use crate::story::{Line, Player, parse, play::around};

/// A story file, read.
pub struct Story {
    /// The kind it is for.
    pub kind: Kind,
    /// Its lines.
    pub lines: Vec<Line>,
}

/// Reads a story file.
///
/// # Errors
/// The file cannot be read, or a line is not of the language.
pub fn story(path: &Path, kind: Kind) -> Result<Story, CallError> {
    let text = std::fs::read_to_string(path)
        .map_err(|error| CallError::new(format!("story {}: {error}; check the path", path.display())))?;
    let (kind, lines) = parse(&text, kind).map_err(|error| CallError::new(format!("{} {error}", path.display())))?;
    Ok(Story { kind, lines })
}

/// Plays the story and prints what came of each line.
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
    let mut player = Player::new(&mut rig, eyes, folder, shared.part.is_some());
    for line in &story.lines {
        let done = player.play(line);
        let seconds = player.rig().now().as_secs_f64();
        tell(shared.format, line, &done, seconds);
        if done.is_err() {
            eprintln!("{}", around(player.rig()));
            return Ok(FAILED);
        }
    }
    Ok(FINE)
}

fn tell(format: Format, line: &Line, done: &Result<(), String>, seconds: f64) {
    match (format, done) {
        (Format::Json, Ok(())) => {
            out(json!({"line": line.number, "statement": line.text, "ok": true, "seconds": seconds}))
        }
        (Format::Json, Err(why)) => {
            out(json!({"line": line.number, "statement": line.text, "ok": false, "seconds": seconds, "why": why}));
        }
        (Format::Text, Ok(())) => out(format!("{seconds:10.3}  ok    {}", line.text)),
        (Format::Text, Err(why)) => out(format!("{seconds:10.3}  FAIL  {}: {why} (line {})", line.text, line.number)),
    }
}
