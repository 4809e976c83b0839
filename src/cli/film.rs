//! `kt830 demo --record DIR`: the demonstration as pictures of a film, painted without a display.
//! Source: issue "the face", part 9.

use std::path::{Path, PathBuf};

use super::play::StoryFile;
use super::story_loop::{self, Film};
use super::{CallError, FAILED, SUCCESS, print_line, setup};
use crate::hmi::offscreen::OffscreenHmi;
use crate::host::headless::HeadlessHost;
use crate::host::simulated::HostedSimulation;
use crate::host::storage::DirectStorage;
use crate::link::Snapshot;
use crate::link::command::Command;
use crate::story::Stage;
use crate::units::Micros;

/// Size of the pictures, pixels.
const SIZE: (u32, u32) = (1_024, 768);

/// The pictures of a film.
struct Recording {
    hmi: OffscreenHmi,
    folder: PathBuf,
    /// Time between two pictures.
    interval: Micros,
    count: u32,
    /// How long the stories before were.
    passed: Micros,
    /// Why a picture could not be written.
    fault: Option<String>,
}

impl Recording {
    /// Shows the screen what has changed, as a window does, and writes a picture; what the screen commands.
    fn film(&mut self, snapshot: &Snapshot) -> Vec<Command> {
        let commands = self.hmi.frame(snapshot);
        self.count += 1;
        let path = self.folder.join(format!("frame-{:05}.png", self.count));
        self.fault = self.hmi.picture().save(&path).err().map(|error| format!("{}: {error}", path.display()));
        commands
    }
}

/// A host that is filmed while a story is played on it.
struct FilmedHost<'a> {
    host: HeadlessHost,
    recording: &'a mut Recording,
    /// When the next picture is due.
    next: Micros,
}

impl Stage for FilmedHost<'_> {
    type Machine = HostedSimulation;
    type Storage = DirectStorage;

    fn host(&mut self) -> &mut HeadlessHost {
        &mut self.host
    }

    fn step(&mut self) {
        self.host.step();
        if self.host.now() >= self.next && self.recording.fault.is_none() {
            self.next = self.next + self.recording.interval;
            let commands = self.recording.film(self.host.snapshot());
            commands.into_iter().for_each(|command| self.host.send(command));
        }
    }

    fn power_cut(&mut self) {
        self.host.power_cut();
    }

    fn power_on(&mut self) {
        self.host.power_on();
    }

    fn is_interrupted(&self) -> bool {
        self.recording.fault.is_some()
    }
}

/// Plays the film and writes the pictures, `per_second` for each second of the machine.
///
/// # Errors
/// The folder or a picture cannot be written.
pub fn record(film: &Film, folder: &Path, per_second: u32) -> Result<u8, CallError> {
    std::fs::create_dir_all(folder).map_err(CallError::at(format!("--record {}", folder.display())))?;
    let mut recording = Recording {
        hmi: OffscreenHmi::new(setup::screen(&film.shared), SIZE),
        folder: folder.to_owned(),
        interval: Micros::from_secs_f64(1.0 / f64::from(per_second)),
        count: 0,
        passed: Micros::ZERO,
        fault: None,
    };
    let mut status = SUCCESS;
    for (number, story) in film.stories.iter().enumerate() {
        let mut host = setup::headless_host(&film.call_for(story))?;
        host.number_control(number as u32);
        story_loop::prepare(&mut host, &film.shared, story);
        status = status.max(record_story(film, story, host, &mut recording));
    }
    if let Some(fault) = recording.fault {
        return Err(CallError::new(fault));
    }
    let seconds = recording.passed.as_secs_f64();
    print_line(format!("{} pictures of {seconds:.0} s in {}", recording.count, folder.display()));
    Ok(status)
}

/// Films a story on its prepared machine; the status of the call.
fn record_story(film: &Film, story: &StoryFile, host: HeadlessHost, recording: &mut Recording) -> u8 {
    let begun = host.now();
    let mut stage = FilmedHost { host, recording, next: begun };
    let mut player = story.player(&mut stage, film.shared.lang, false);
    let mut status = SUCCESS;
    for line in story.acts().1 {
        if player.stage().is_interrupted() {
            break;
        }
        if let Err(why) = player.play(line) {
            print_line(format!("FAIL  line {}, {}: {why}", line.number, line.text));
            status = FAILED;
        }
    }
    drop(player);
    let FilmedHost { host, recording, .. } = stage;
    recording.passed = recording.passed + host.now().since(begun);
    status
}
