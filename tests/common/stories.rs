//! Telling a story to a fresh control on its simulated machine.

#![allow(dead_code, clippy::unwrap_used, clippy::expect_used, reason = "a test driver: a failure is the message")]

use std::path::{Path, PathBuf};

use kt830::controller::PowerOnState;
use kt830::defs::kind::{Dialect, Kind};
use kt830::defs::text::Lang;
use kt830::host::folders::{Folders, program_from_bytes};
use kt830::host::headless::{HeadlessHost, HostSetup};
use kt830::story::{Player, parse, play::state_report};

/// The folders of the repository.
pub fn folders() -> Folders {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    Folders { programs: root.join("programs"), screens: root.join("screens"), by_name: false, dialect: Dialect::LatheA }
}

/// The folders of a kind.
pub fn folders_of(kind: Kind) -> Folders {
    let all = folders();
    let programs = &kind.row().programs;
    let (path, by_name) = (all.programs.join(programs.folder), programs.by_name);
    Folders { programs: path, by_name, dialect: kind.dialect(), ..all }
}

/// A control at power-on with its machine.
pub fn rig() -> HeadlessHost {
    rig_in(folders())
}

/// The same with other folders.
pub fn rig_in(folders: Folders) -> HeadlessHost {
    rig_of(Kind::Gc, folders)
}

/// A control of a kind at power-on.
pub fn rig_of(kind: Kind, folders: Folders) -> HeadlessHost {
    HeadlessHost::new(HostSetup { kind, retained: PowerOnState::factory(kind), store: None, folders, seed: 1 }).unwrap()
}

/// A homed machine with hydraulics on and a wheel that is off, as `kt830 run` begins.
pub fn ready() -> HeadlessHost {
    ready_of(Kind::Gc)
}

/// The same of any kind.
pub fn ready_of(kind: Kind) -> HeadlessHost {
    let mut rig = rig_of(kind, folders_of(kind));
    rig.make_ready();
    rig
}

/// A ready machine with a program of this text as the current one.
pub fn ready_with(text: &str) -> HeadlessHost {
    let mut rig = ready();
    rig.add_program(program_from_bytes(7_000, "O7000.NC", text.as_bytes().to_vec(), rig.kind().dialect()));
    tell(&mut rig, "load O7000");
    rig
}

/// Plays a story; the first line that fails ends the test.
pub fn tell(rig: &mut HeadlessHost, text: &str) {
    let (_, lines) = parse(text, rig.kind()).unwrap_or_else(|error| panic!("{error} in\n{text}"));
    let mut player = Player::new(rig, None, &PathBuf::from("."), true);
    for line in &lines {
        if let Err(why) = player.play(line) {
            panic!("{}: {why}\n{}", line.text, state_report(player.host(), Lang::Zh));
        }
    }
}

/// Plays one line that the control must refuse; gives what it said.
pub fn refused(rig: &mut HeadlessHost, line: &str) -> String {
    let (_, lines) = parse(line, rig.kind()).unwrap_or_else(|error| panic!("{error} in\n{line}"));
    Player::new(rig, None, &PathBuf::from("."), true).play(&lines[0]).expect_err(line)
}

/// A story from a cold start on a machine of a kind.
pub fn story_on(kind: Kind, text: &str) -> HeadlessHost {
    let mut rig = rig_of(kind, folders_of(kind));
    tell(&mut rig, text);
    rig
}

/// A story from a cold start.
pub fn story(text: &str) -> HeadlessHost {
    let mut rig = rig();
    tell(&mut rig, text);
    rig
}
