//! What is heard, and that it is silent by factory. Source: spec H8; issue "the face", part 10.

use std::sync::Arc;

use kt830::defs::key::Key;
use kt830::defs::page::Page;
use kt830::defs::param::{self, Params};
use kt830::hmi::sound::{Beep, SoundWatcher, of_commands};
use kt830::link::{Command, Snapshot};

use crate::stories::{ready_with, tell};

fn set(machine: &mut Snapshot, level: f64) {
    let mut params: Params = (*machine.params).clone();
    params.write(param::SOUND.address(), level).unwrap();
    machine.params = Arc::new(params);
}

/// What is heard of a story, one beep at most after each line.
fn heard(level: u32, story: &str) -> Vec<Beep> {
    let mut rig = ready_with("G04 P100\nM30");
    tell(&mut rig, &format!("param P487 {level}"));
    let mut watcher = SoundWatcher::default();
    assert_eq!(watcher.follow(rig.snapshot()), None, "nothing of the first one");
    let beeps = story.lines().filter_map(|line| {
        tell(&mut rig, line);
        let beep = watcher.follow(rig.snapshot());
        assert_eq!(watcher.follow(rig.snapshot()), None, "each is heard once: {line}");
        beep
    });
    beeps.collect()
}

#[test]
fn h8_alarms_refusals_and_finished_parts_are_heard_once() {
    // A second cycle start is refused; a drive fails after the part.
    let story = "key cycle-start\nkey cycle-start\nwait until idle\nfault drive-X\nwait 1 s";
    assert_eq!(heard(1, story), [Beep::Refused, Beep::PartFinished, Beep::Alarm]);
    assert_eq!(heard(0, story), []);
}

#[test]
fn h8_keys_are_heard_only_if_wanted() {
    let mut machine = crate::sample::snapshot(Page::Home);
    let press = [Command::Press(Key::Coolant)];
    for (level, beep) in [(0.0, None), (1.0, None), (2.0, Some(Beep::Key))] {
        set(&mut machine, level);
        assert_eq!(of_commands(&press, &machine), beep);
        assert_eq!(of_commands(&[Command::KeepAlive], &machine), None);
    }
}
