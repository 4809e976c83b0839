//! `kt830 play`: plays a story without a display and prints one result line per statement.
//! Source: spec tools.md T5.

use std::path::{Path, PathBuf};

use serde_json::{Map, Value, json};

use super::args::{OutputFormat, PlayArgs, SharedArgs};
use super::trace_file::TraceFile;
use super::{CallError, FAILED, SUCCESS, print_line, setup};
use crate::defs::kind::Kind;
use crate::defs::sim_fault::{FAULTS, FaultRow};
use crate::defs::text::Lang;
use crate::host::headless::HeadlessHost;
use crate::host::simulated::HostedSimulation;
use crate::host::storage::DirectStorage;
use crate::io::trace;
use crate::link::snapshot::Tone;
#[cfg(feature = "hmi")]
use crate::story::PageReader;
use crate::story::{Player, Stage, Statement, StoryLine, parse, play::state_report};
use crate::units::Micros;

/// A parsed story file.
pub struct StoryFile {
    /// Its kind of machine.
    pub kind: Kind,
    /// Its lines.
    pub lines: Vec<StoryLine>,
    /// The folder of the files that it names.
    pub folder: PathBuf,
}

impl StoryFile {
    /// A player that reads pages in a language, if the build has the screen. `part_given` as in [`Player::new`].
    pub fn player<'a, G: Stage>(&self, stage: &'a mut G, lang: Lang, part_given: bool) -> Player<'a, G> {
        #[cfg(feature = "hmi")]
        let reader: Option<PageReader> = Some(Box::new(move |snapshot| crate::hmi::page_text(snapshot, lang)));
        #[cfg(not(feature = "hmi"))]
        let (reader, _) = (None, lang);
        Player::new(stage, reader, &self.folder, part_given)
    }

    /// What a demonstration plays unseen and at once, and what it shows.
    pub fn acts(&self) -> (&[StoryLine], &[StoryLine]) {
        let prepared = self.lines.iter().position(|line| line.statement == Statement::Prepared);
        self.lines.split_at(prepared.map_or(0, |at| at + 1))
    }
}

/// Reads a story file.
///
/// # Errors
/// The file cannot be read, or a line is invalid.
pub fn read_story(path: &Path, kind: Kind) -> Result<StoryFile, CallError> {
    let text = setup::read_text("story", path)?;
    let (kind, lines) = parse(&text, kind).map_err(|error| CallError::new(format!("{} {error}", path.display())))?;
    Ok(StoryFile { kind, lines, folder: path.parent().unwrap_or(Path::new(".")).to_owned() })
}

/// The story that shows a kind of machine, from a cold start to a part; of the first kind where another has none.
///
/// # Errors
/// Never with the stories of the program.
pub fn demo_story(shared: &SharedArgs) -> Result<StoryFile, CallError> {
    let of_kind = shared.requested_kind.and_then(|kind| kind.row().demo_story);
    let story = of_kind.or(Kind::default().row().demo_story).unwrap_or_default();
    let (kind, lines) = parse(story, shared.kind).map_err(CallError::new)?;
    Ok(StoryFile { kind, lines, folder: ".".into() })
}

/// The stories for spectators, with captions, each on a machine of its own: of the kind that is asked for, otherwise of all
/// kinds. With data of a machine there is one story; where a kind has none, [`demo_story`].
///
/// # Errors
/// Never with the stories of the program.
pub fn film_stories(shared: &SharedArgs) -> Result<Vec<StoryFile>, CallError> {
    let keeps_data = shared.data.is_some();
    let kinds = match shared.requested_kind.or(keeps_data.then_some(shared.kind)) {
        Some(kind) => vec![kind],
        None => Kind::ALL.to_vec(),
    };
    let read = |story: &&str| {
        let (kind, lines) = parse(story, shared.kind).map_err(CallError::new)?;
        Ok(StoryFile { kind, lines, folder: ".".into() })
    };
    let stories = kinds.iter().flat_map(|kind| kind.row().film_stories);
    let mut film = stories.map(read).collect::<Result<Vec<_>, CallError>>()?;
    if film.is_empty() {
        film.push(demo_story(shared)?);
    }
    film.truncate(if keeps_data { 1 } else { film.len() });
    Ok(film)
}

/// The stage of `kt830 play`: a headless host that stops at a time and writes a trace.
struct TracedStage {
    host: HeadlessHost,
    until: Option<Micros>,
    trace: Option<TraceFile>,
}

impl Stage for TracedStage {
    type Machine = HostedSimulation;
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

    fn power_cut(&mut self) {
        self.host.power_cut();
    }

    fn power_on(&mut self) {
        self.host.power_on();
    }

    fn is_interrupted(&self) -> bool {
        self.until.is_some_and(|until| self.host.now() >= until)
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
    for line in &story.lines {
        if let Statement::Part(file) = &line.statement {
            setup::read_part_file(&story.folder.join(file))?;
        }
    }
    let trace = call.trace.as_deref().map(|path| TraceFile::create(path, trace::HEADER)).transpose()?;
    let mut stage = TracedStage { host, until: call.until, trace };
    let mut player = story.player(&mut stage, shared.lang, shared.part.is_some());
    let status = play_lines(&shared, &story.lines, &mut player);
    drop(player);
    if status == SUCCESS && call.until.is_some() {
        while !stage.is_interrupted() {
            stage.step();
        }
        match shared.format {
            OutputFormat::Text => print_line(state_report(&mut stage.host, shared.lang)),
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
        print_outcome(shared.format, line, &done, refused.as_deref(), seconds);
        if line.statement == Statement::FaultList && shared.format == OutputFormat::Text {
            for row in FAULTS {
                print_line(format!("{:14}{:20} {} {}", "", row.usage(), row.text.zh, row.text.en));
            }
        }
        if done.is_err() {
            warn_line!("{}", state_report(player.host(), shared.lang));
            return FAILED;
        }
    }
    SUCCESS
}

/// The state at the end of `--until` for programs.
fn state_json(host: &mut HeadlessHost, lang: Lang) -> Value {
    let seconds = host.now().as_secs_f64();
    let snapshot = host.snapshot();
    let present = snapshot.axes.iter().filter(|(_, view)| view.present);
    let axes: Map<String, Value> = present
        .map(|(axis, at)| (axis.to_string(), json!({"work": at.work, "machine": at.machine, "to_go": at.to_go})))
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

/// Prints the result of a line; `refused` is what the control said to it.
fn print_outcome(form: OutputFormat, line: &StoryLine, done: &Result<(), String>, refused: Option<&str>, seconds: f64) {
    let text = &line.text;
    match (form, done) {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::args::Args;
    use clap::Parser;

    fn film(words: &[&str]) -> Vec<Kind> {
        let call = Args::try_parse_from(["kt830"].iter().chain(words).chain(&["demo"])).unwrap();
        film_stories(&call.shared).unwrap().iter().map(|story| story.kind).collect()
    }

    #[test]
    fn t2_the_film_shows_three_grinders_and_each_kind_its_own() {
        assert_eq!(film(&[]), [Kind::Gc, Kind::Gc, Kind::Gs, Kind::Ga]);
        assert_eq!(film(&["--kind", "gs"]), [Kind::Gs]);
        assert_eq!(film(&["--kind", "vertical"]), [Kind::Vertical]);
        // The data are those of one machine.
        assert_eq!(film(&["--data", "data"]), [Kind::Gc]);
    }
}
