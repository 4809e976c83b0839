//! `kt830 demo --record DIR`: the demonstration as pictures of a film, painted without a display.
//! Source: issue "the face", part 9.

use std::path::{Path, PathBuf};

use super::args::SharedArgs;
use super::play::StoryFile;
use super::{CallError, FAILED, SUCCESS, print_line, setup};
use crate::hmi::offscreen::OffscreenHmi;
use crate::host::headless::HeadlessHost;
use crate::host::simulated::HostedSimulation;
use crate::host::storage::DirectStorage;
use crate::story::Stage;
use crate::units::Micros;

/// Size of the pictures, pixels.
const SIZE: (u32, u32) = (1_024, 768);

/// A host that is filmed while a story is played on it.
struct FilmedHost {
    host: HeadlessHost,
    hmi: OffscreenHmi,
    folder: PathBuf,
    /// Time between two pictures, and when the next one is due.
    interval: Micros,
    next: Micros,
    count: u32,
    /// Why a picture could not be written.
    fault: Option<String>,
}

impl FilmedHost {
    /// Shows the screen what has changed, as a window does, and writes a picture.
    fn film(&mut self) {
        let commands = self.hmi.frame(self.host.snapshot());
        commands.into_iter().for_each(|command| self.host.send(command));
        self.count += 1;
        let path = self.folder.join(format!("frame-{:05}.png", self.count));
        self.fault = self.hmi.picture().save(&path).err().map(|error| format!("{}: {error}", path.display()));
    }
}

impl Stage for FilmedHost {
    type Machine = HostedSimulation;
    type Storage = DirectStorage;

    fn host(&mut self) -> &mut HeadlessHost {
        &mut self.host
    }

    fn step(&mut self) {
        self.host.step();
        if self.host.now() >= self.next && self.fault.is_none() {
            self.next = self.next + self.interval;
            self.film();
        }
    }

    fn power_cut(&mut self) {
        self.host.power_cut();
    }

    fn power_on(&mut self) {
        self.host.power_on();
    }

    fn is_interrupted(&self) -> bool {
        self.fault.is_some()
    }
}

/// Plays the story and writes the pictures, `per_second` for each second of the machine.
///
/// # Errors
/// The folder or a picture cannot be written.
pub fn record(shared: &SharedArgs, told: &StoryFile, folder: &Path, per_second: u32) -> Result<u8, CallError> {
    std::fs::create_dir_all(folder).map_err(CallError::at(format!("--record {}", folder.display())))?;
    let mut stage = FilmedHost {
        host: setup::headless_host(shared)?,
        hmi: OffscreenHmi::new(setup::screen(shared), SIZE),
        folder: folder.to_owned(),
        interval: Micros::from_secs_f64(1.0 / f64::from(per_second)),
        next: Micros::ZERO,
        count: 0,
        fault: None,
    };
    let mut player = told.player(&mut stage, shared.lang, false);
    let mut status = SUCCESS;
    for line in &told.lines {
        if player.stage().is_interrupted() {
            break;
        }
        if let Err(why) = player.play(line) {
            print_line(format!("FAIL  line {}, {}: {why}", line.number, line.text));
            status = FAILED;
        }
    }
    drop(player);
    if let Some(fault) = stage.fault {
        return Err(CallError::new(fault));
    }
    let seconds = stage.host.now().as_secs_f64();
    print_line(format!("{} pictures of {seconds:.0} s in {}", stage.count, folder.display()));
    Ok(status)
}
