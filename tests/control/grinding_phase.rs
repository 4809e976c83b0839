//! The phases that a program names by `#5828`: what is shown and timed, what is refused, and that nothing else changes.
//! Source: spec K7.2, B3, H8.

use crate::stories::{ready_of, ready_with, tell};
use kt830::defs::grinding_phase::GrindingPhase;
use kt830::defs::kind::Kind;
use kt830::host::headless::HeadlessHost;
use kt830::io::sim::PartFile;
use kt830::link::cycle::CycleView;
use kt830::link::cycle_times::CycleTimes;
use kt830::link::snapshot::RunState;
use kt830::units::MachinePos;

/// Steps until the run is over; the phases in the order in which they came.
fn course(rig: &mut HeadlessHost) -> Vec<Option<GrindingPhase>> {
    let mut seen = vec![rig.snapshot().cycle.phase];
    // A snapshot costs more than a tick; no phase is shorter than a few of them.
    for _ in 0..360_000 {
        (0..10).for_each(|_| rig.step());
        let snapshot = rig.snapshot();
        if seen.last() != Some(&snapshot.cycle.phase) {
            seen.push(snapshot.cycle.phase);
        }
        if snapshot.state == RunState::Idle {
            return seen;
        }
    }
    panic!("{:?}: {seen:?}", rig.snapshot().state);
}

fn ready_for_part(program: u32) -> HeadlessHost {
    ready_of_part(Kind::Gc, program)
}

fn ready_of_part(kind: Kind, program: u32) -> HeadlessHost {
    let mut rig = ready_of(kind);
    rig.mount_part(&PartFile::builtin(program).unwrap().expect("a part file"));
    tell(&mut rig, &format!("param P4.4 1\nload O{program}\nmode auto\nkey cycle-start\nwait 0.1 s"));
    rig
}

#[test]
fn k7_2_a_cycle_passes_through_its_phases_and_each_is_timed() {
    use GrindingPhase::{AirGrinding, Approach, Finishing, Retract, Roughing, SparkOut};
    let mut rig = ready_for_part(1_002);
    let seen = course(&mut rig);
    let expected = [Approach, AirGrinding, Roughing, Finishing, SparkOut, Retract].map(Some);
    let named: Vec<_> = seen.into_iter().filter(Option::is_some).collect();
    assert_eq!(named, expected);
    let cycle = rig.snapshot().cycle;
    assert_eq!(cycle.phase, None, "no phase after the cycle");
    let times = cycle.part.expect("a part").times;
    assert_eq!(times, cycle.times);
    // #528 is 6 s of spark-out; the lines before and after it take less than 0.1 s.
    assert!((6.0..6.1).contains(&times.phase(SparkOut)), "{times:?}");
    // The finishing stock of 0.05 mm in diameter is 0.025 mm of the slide: 5 s at 0.3 mm/min.
    assert!((5.0..5.1).contains(&times.phase(Finishing)), "{times:?}");
    assert!(times.outside_phases() < 0.2, "{times:?}");
    // The next cycle of the program is compared with it.
    rig.mount_part(&PartFile::builtin(1_002).unwrap().expect("a part file"));
    tell(&mut rig, "key cycle-start\nwait 1 s");
    assert_eq!(rig.snapshot().cycle.before, Some(times));
    assert!(rig.snapshot().cycle.has_phase(SparkOut));
    assert!(!rig.snapshot().cycle.has_phase(GrindingPhase::Dressing));
}

#[test]
fn k7_2_every_grinding_program_names_its_phases() {
    use GrindingPhase::{AirGrinding, Approach, Dressing, Finishing, Measuring, Retract, Roughing, SparkOut};
    let faces = [Approach, Roughing, Finishing, SparkOut, Retract];
    let plunge = [Approach, AirGrinding, Roughing, Finishing, SparkOut, Retract];
    // With a gauge what the spark-out leaves is removed after it, to the gauge's signal.
    let gauged = [Approach, AirGrinding, Roughing, Finishing, SparkOut, Finishing, Retract];
    let expected: [(Kind, u32, Vec<GrindingPhase>); 7] = [
        // Left and right jaw.
        (Kind::Gc, 1_001, faces.into_iter().chain(faces).collect()),
        (Kind::Gc, 1_003, gauged.to_vec()),
        (Kind::Gc, 1_004, plunge.to_vec()),
        (Kind::Gc, 1_005, [&[Approach, Measuring], plunge.as_slice()].concat()),
        (Kind::Gc, 1_006, [&[Dressing], gauged.as_slice()].concat()),
        // The spark-out in small cross steps reaches the size itself.
        (Kind::Gs, 1_007, plunge.to_vec()),
        (Kind::Gc, 1_011, vec![Dressing]),
    ];
    for (kind, program, phases) in expected {
        let mut rig = ready_of_part(kind, program);
        let seen: Vec<_> = course(&mut rig).into_iter().flatten().collect();
        assert_eq!(seen, phases, "O{program}: {:?}", rig.snapshot().alarms);
        let times = rig.snapshot().cycle.times;
        assert!(times.outside_phases() < 0.2 * times.seconds, "O{program}: {times:?}");
    }
}

#[test]
fn b3_a_phase_is_a_whole_number_from_0_to_8_and_cannot_be_read() {
    for (block, says) in [("#5828=9", "0–8"), ("#5828=-1", "0–8"), ("#5828=1.5", "0–8"), ("#1=#5828", "#5828")] {
        let mut rig = ready_with(&format!("%\nO7000\n{block}\nM30\n%\n"));
        tell(&mut rig, "mode auto\nkey cycle-start\nwait 0.2 s");
        let snapshot = rig.snapshot();
        let told = snapshot.alarms.first().map(|alarm| alarm.text.en().into_owned()).unwrap_or_default();
        assert!(told.contains(says), "{block}: {told}");
        assert_eq!(snapshot.cycle.phase, None);
    }
}

/// Set points of every tick of a contour under G64, with a line after each move.
fn contour(between: &str) -> Vec<MachinePos> {
    let moves: String = (0..40).map(|point| format!("G01 U-{}.5 W-1 F2000\n{between}\n", point % 7)).collect();
    let mut rig = ready_with(&format!("%\nO7000\nG64 G98\n{moves}M30\n%\n"));
    tell(&mut rig, "mode auto\nkey cycle-start");
    let mut points = Vec::new();
    for _ in 0..100_000 {
        rig.step();
        points.push(rig.controller().set_point());
        if rig.snapshot().state == RunState::Idle {
            return points;
        }
    }
    panic!("{:?}", rig.snapshot().alarms);
}

#[test]
fn b3_naming_a_phase_between_moves_changes_no_move() {
    let phase = contour("#5828=5");
    // A common variable is set on the way, too; an output is switched at rest.
    assert_eq!(phase, contour("#100=5"));
    assert!(contour("#1140=0").len() > phase.len());
}

#[test]
fn k7_2_a_retract_and_a_hold_keep_the_phase_and_reset_ends_it() {
    let mut rig = ready_for_part(1_002);
    tell(&mut rig, "wait 30 s");
    let phase = rig.snapshot().cycle.phase.expect("a phase");
    tell(&mut rig, "key feed-hold\nwait 1 s");
    let held = rig.snapshot().cycle;
    assert_eq!(held.phase, Some(phase));
    tell(&mut rig, "wait 2 s");
    let later = rig.snapshot().cycle.times.phase(phase) - held.times.phase(phase);
    assert!((later - 2.0).abs() < 0.05, "{later}");
    tell(&mut rig, "key wheel-retract\nwait 5 s\nexpect lamp wheel-retract on");
    assert_eq!(rig.snapshot().cycle.phase, Some(phase));
    tell(&mut rig, "key reset\nwait 5 s");
    assert_eq!(rig.snapshot().cycle.phase, None);
}

#[test]
fn h8_what_is_left_follows_the_phases_of_the_cycle_before() {
    let times = |seconds: f64, spent: &[(GrindingPhase, f64)]| {
        let mut times = CycleTimes { seconds, ..CycleTimes::default() };
        spent.iter().for_each(|(phase, seconds)| times.phases[phase.index()] = *seconds);
        times
    };
    use GrindingPhase::{Dressing, Finishing, Roughing, SparkOut};
    let before = times(60.0, &[(Dressing, 20.0), (Roughing, 20.0), (Finishing, 10.0), (SparkOut, 6.0)]);
    // Nothing is known without a cycle before.
    assert_eq!(CycleView::default().seconds_left(), None);
    // Roughing took 5 s less than before: 10 s of finishing, 6 s of spark-out and the 4 s between phases are left.
    let view = |times, phase| CycleView { times, phase, part: None, before: Some(before) };
    assert_eq!(view(times(15.0, &[(Roughing, 15.0)]), Some(Roughing)).seconds_left(), Some(5.0 + 10.0 + 6.0 + 4.0));
    // A phase that lasts longer than before takes nothing from the others.
    let late = times(30.0, &[(Roughing, 30.0)]);
    assert_eq!(view(late, Some(Roughing)).seconds_left(), Some(10.0 + 6.0 + 4.0));
    // The dressing of the cycle before counts while this one dresses.
    let dressing = times(5.0, &[(Dressing, 5.0)]);
    assert_eq!(view(dressing, Some(Dressing)).seconds_left(), Some(15.0 + 20.0 + 10.0 + 6.0 + 4.0));
}

#[test]
fn h8_a_block_without_n_shows_the_n_before_it() {
    let mut rig = ready_with("%\nO7000\nG04 P100\nN10 G04 P100\nG04 P300\nN20 G04 P100\nM30\n%\n");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 0.05 s");
    assert_eq!(rig.snapshot().program.block, None);
    tell(&mut rig, "wait 0.25 s");
    assert_eq!((rig.snapshot().program.block, rig.snapshot().program.line), (Some(10), 5));
    tell(&mut rig, "wait 0.25 s");
    assert_eq!(rig.snapshot().program.block, Some(20));
}

/// The part of the first pass is judged while the second one runs: what that one does is not the first one's.
#[test]
fn k4_1_a_part_is_gauged_if_a_gauge_has_ended_an_infeed_of_its_own_cycle() {
    for (program, gauged) in [(1_004, true), (1_002, false)] {
        let mut rig = ready_of(Kind::Gc);
        rig.mount_part(&PartFile::builtin(program).unwrap().expect("a part file"));
        let story = format!("param P390 2\nload O{program}\nmode auto\nkey cycle-start\nwait 0.1 s");
        tell(&mut rig, &story);
        for _ in 0..3_600_000 {
            rig.step();
            if rig.snapshot().cycle.part.is_some() {
                break;
            }
        }
        let part = rig.snapshot().cycle.part.expect("the part of the first pass");
        assert_eq!(part.gauged, gauged, "O{program}");
    }
}
