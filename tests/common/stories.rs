//! Telling a story to a fresh control on its simulated machine.

#![allow(dead_code, clippy::unwrap_used, clippy::expect_used, reason = "a test driver: a failure is the message")]

use std::path::{Path, PathBuf};

use kt830::controller::Retained;
use kt830::defs::kind::Kind;
use kt830::runtime::disk::{Folders, program};
use kt830::runtime::rig::{Rig, Setup};
use kt830::story::{Player, parse, play::around};

/// The folders of the repository.
pub fn folders() -> Folders {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    Folders { programs: root.join("programs"), screens: root.join("screens"), named: false }
}

/// The folders of a kind.
pub fn folders_of(kind: Kind) -> Folders {
    let all = folders();
    Folders { programs: all.programs.join(kind.folder()), ..all }
}

/// A control at power-on with its machine.
pub fn rig() -> Rig {
    rig_in(folders())
}

/// The same with other folders.
pub fn rig_in(folders: Folders) -> Rig {
    rig_of(Kind::Gc, folders)
}

/// A control of a kind at power-on.
pub fn rig_of(kind: Kind, folders: Folders) -> Rig {
    Rig::new(Setup { kind, retained: Retained::factory(kind), keeper: None, folders, seed: 1 }).unwrap()
}

/// A homed machine with hydraulics on and a wheel that is off, as `kt830 run` begins.
pub fn ready() -> Rig {
    ready_of(Kind::Gc)
}

/// The same of any kind.
pub fn ready_of(kind: Kind) -> Rig {
    let mut rig = rig_of(kind, folders_of(kind));
    rig.make_ready();
    rig
}

/// A ready machine with a program of this text as the current one.
pub fn ready_with(text: &str) -> Rig {
    let mut rig = ready();
    rig.add_program(program(7_000, "O7000.NC", text.as_bytes().to_vec()));
    tell(&mut rig, "load O7000");
    rig
}

/// Plays a story; the first line that fails ends the test.
pub fn tell(rig: &mut Rig, text: &str) {
    let (_, lines) = parse(text, rig.kind()).unwrap_or_else(|error| panic!("{error} in\n{text}"));
    let mut player = Player::new(rig, None, &PathBuf::from("."), true);
    for line in &lines {
        if let Err(why) = player.play(line) {
            panic!("{}: {why}\n{}", line.text, around(player.rig()));
        }
    }
}

/// Plays one line that the control must refuse; gives what it said.
pub fn refused(rig: &mut Rig, line: &str) -> String {
    let (_, lines) = parse(line, rig.kind()).unwrap_or_else(|error| panic!("{error} in\n{line}"));
    Player::new(rig, None, &PathBuf::from("."), true).play(&lines[0]).expect_err(line)
}

/// A story from a cold start on a machine of a kind.
pub fn story_on(kind: Kind, text: &str) -> Rig {
    let mut rig = rig_of(kind, folders_of(kind));
    tell(&mut rig, text);
    rig
}

/// A story from a cold start.
pub fn story(text: &str) -> Rig {
    let mut rig = rig();
    tell(&mut rig, text);
    rig
}
