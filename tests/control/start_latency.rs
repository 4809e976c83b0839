//! How soon the axes answer: ticks from a command, or from a queued move, to the first changed set-point. Source: spec B5, T5.

use crate::stories::{ready_with, tell};
use kt830::defs::key::Key;
use kt830::host::headless::HeadlessHost;
use kt830::link::command::Command;
use kt830::units::Axis;

/// Most ticks to the first changed set-point, the tick of the command included.
const MOST_TICKS: usize = 5;

/// Sends commands in one tick; gives the number of ticks until a set-point of an axis has changed.
fn ticks_to_motion(rig: &mut HeadlessHost, commands: &[Command]) -> usize {
    let setpoints = |rig: &HeadlessHost| Axis::ALL.map(|axis| rig.controller().outputs().set_point_mm[axis].to_bits());
    let before = setpoints(rig);
    commands.iter().for_each(|command| rig.send(command.clone()));
    for tick in 1..=1_000 {
        rig.step();
        if setpoints(rig) != before {
            return tick;
        }
    }
    panic!("no axis moves: {:?}", rig.snapshot().message);
}

#[test]
fn b5_mdi_and_jog_answer_within_five_ticks() {
    for line in
        ["G00 Z-10", "G98 G01 W-1 F300", "G64 G98 G01 W-0.01 F300", "G98 G01 W-0.001 F1", "G64 G01 U0.002 F6000"]
    {
        let mut rig = ready_with("M30");
        tell(&mut rig, "mode mdi");
        let ticks = ticks_to_motion(&mut rig, &[Command::Mdi(line.into())]);
        assert!(ticks <= MOST_TICKS, "{line}: {ticks} ticks");
    }
    for key in [Key::XPlus, Key::XMinus, Key::ZPlus, Key::ZMinus] {
        let mut rig = ready_with("M30");
        tell(&mut rig, "mode jog");
        let ticks = ticks_to_motion(&mut rig, &[Command::Press(key)]);
        assert!(ticks <= MOST_TICKS, "{key:?}: {ticks} ticks");
    }
}

/// A run of several blocks is planned as a whole before it starts, within the work of some ticks.
#[test]
fn b5_a_program_starts_within_a_few_ticks() {
    let run = "G64 G98 G01 W-5 F3000\nU-5\nW5\nM30";
    for (text, most) in [("G98 G01 W-5 F300\nM30", 5), ("G64 G98 G01 W-5 F3000\nM30", 5), (run, 25)] {
        let mut rig = ready_with(text);
        tell(&mut rig, "mode auto");
        let ticks = ticks_to_motion(&mut rig, &[Command::Press(Key::CycleStart)]);
        assert!(ticks <= most, "{text}: {ticks} ticks");
    }
}
