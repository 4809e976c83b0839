//! The start guide: what is missing for the next cycle start, and that it says neither too much nor too little.
//! Source: spec K2.2, K3.3, K3.7, K3.11, K5.13, K5.17, B3, B5, B8.

use kt830::defs::key::Key;
use kt830::defs::kind::Kind;
use kt830::defs::page::Page;
use kt830::defs::start_step::StartStep;
use kt830::host::headless::HeadlessHost;
use kt830::io::random::SplitMix64;
use kt830::io::sim::PartFile;
use kt830::link::snapshot::RunState;
use kt830::link::start_guide::{StepAction, StepState};
use kt830::link::{Command, Snapshot};

use crate::stories::{ready, ready_with, rig_of, tell};

fn state(rig: &mut HeadlessHost, step: StartStep) -> StepState {
    rig.snapshot().start_guide.step(step).state
}

/// The words of a condition that is not met.
fn reason(rig: &mut HeadlessHost, step: StartStep) -> String {
    rig.snapshot().start_guide.step(step).reason.zh().into_owned()
}

fn press(rig: &mut HeadlessHost, key: Key) {
    let command = rig.snapshot().press_command(key);
    rig.send(command);
    rig.step();
    rig.send(Command::Release(key));
    rig.step();
}

fn wait(rig: &mut HeadlessHost, seconds: f64) {
    (0..(seconds * 1_000.0) as u32).for_each(|_| rig.step());
}

/// A cold machine with a part and its program.
fn cold(kind: Kind, program: u32) -> HeadlessHost {
    let mut rig = rig_of(kind, crate::stories::folders_of(kind));
    tell(&mut rig, "power on\nwait 1 s");
    if let Some(part) = PartFile::builtin(program).unwrap() {
        rig.mount_part(&part);
    }
    rig
}

/// Presses the key that the guide names until nothing is missing; the program is chosen where it says so.
fn follow(rig: &mut HeadlessHost, program: &str) -> u32 {
    let mut presses = 0;
    for _ in 0..600 {
        wait(rig, 0.3);
        let snapshot: &Snapshot = rig.snapshot();
        let guide = &snapshot.start_guide;
        if guide.is_ready() {
            return presses;
        }
        let Some((step, view)) = guide.next() else { continue };
        if view.state == StepState::Pending {
            continue;
        }
        presses += 1;
        match view.action {
            Some(StepAction::Press(key) | StepAction::PressOnPanel(key)) => press(rig, key),
            Some(StepAction::Open(Page::Directory, None)) => tell(rig, &format!("load {program}")),
            other => panic!("{step:?}: {:?}, {other:?}", view.reason.zh()),
        }
    }
    panic!("the guide does not end: {:?}", rig.snapshot().start_guide);
}

#[test]
fn b5_the_guide_leads_every_kind_from_power_on_to_a_finished_part() {
    for (kind, program, name) in [
        (Kind::Gc, 1_002, "O1002"),
        (Kind::Gs, 1_007, "O1007"),
        (Kind::Ga, 1_010, "O1010"),
        (Kind::Vertical, 0, "VBORE"),
    ] {
        let mut rig = cold(kind, program);
        let presses = follow(&mut rig, name);
        // Hydraulics, HOME, an axis key each, clamping, program, AUTO.
        assert!((4..=9).contains(&presses), "{kind:?}: {presses} presses");
        assert_eq!(rig.snapshot().start_guide.next_key(), Some(Key::CycleStart));
        press(&mut rig, Key::CycleStart);
        assert!(rig.snapshot().state.is_active(), "{kind:?}: {:?}", rig.snapshot().message.text.zh());
        // A run has no guide; none of its blocks waits for a unit that the guide has left out.
        assert_eq!(rig.snapshot().start_guide.present().count(), 0);
        wait(&mut rig, 20.0);
        let snapshot = rig.snapshot();
        assert!(snapshot.alarms.is_empty(), "{kind:?}: {:?}", snapshot.alarms);
    }
}

#[test]
fn l6_a_lathe_needs_a_program_and_auto() {
    let mut rig = cold(Kind::Lathe, 0);
    let guide = &rig.snapshot().start_guide;
    let present: Vec<StartStep> = guide.present().map(|(step, _)| step).collect();
    assert_eq!(present, [StartStep::Machine, StartStep::Program, StartStep::Mode]);
    assert_eq!(state(&mut rig, StartStep::Program), StepState::Missing);
}

#[test]
fn b8_a_value_that_the_program_refuses_is_missing_before_the_start() {
    let mut rig = ready();
    rig.mount_part(&PartFile::builtin(1_002).unwrap().unwrap());
    tell(&mut rig, "load O1002\nmode auto\nwait 0.5 s");
    assert_eq!(state(&mut rig, StartStep::Values), StepState::Met);
    assert!(rig.snapshot().start_guide.is_ready());
    tell(&mut rig, "set #521 = 50\nwait 0.5 s");
    assert_eq!(state(&mut rig, StartStep::Values), StepState::Missing);
    assert!(reason(&mut rig, StartStep::Values).contains("成品直径 #521 不小于毛坯直径 #520"));
    assert_eq!(rig.snapshot().start_guide.refused_variable(), Some(521));
    let action = rig.snapshot().start_guide.step(StartStep::Values).action;
    assert_eq!(action, Some(StepAction::Open(Page::Grinding, Some(521))));
    // The check has changed nothing, and cycle start says the same.
    assert!(rig.snapshot().alarms.is_empty());
    tell(&mut rig, "key cycle-start\nwait 0.5 s\nexpect alarm 3001");
    tell(&mut rig, "key reset\nset #521 = 40\nwait 0.5 s");
    assert_eq!(state(&mut rig, StartStep::Values), StepState::Met);
}

#[test]
fn b3_the_check_changes_no_variable_and_writes_none_to_the_disk() {
    // O1002 sets #530 and others at its head.
    let mut rig = ready();
    tell(&mut rig, "load O1002\nmode auto\nset #530 =\nset #101 = 7\nwait 1 s");
    assert_eq!((rig.controller().variable(530), rig.controller().variable(101)), (None, Some(7.0)));
}

#[test]
fn b3_a_mistake_before_the_first_action_is_told() {
    let mut rig = ready_with("#1=[1+\nM30");
    tell(&mut rig, "mode auto\nwait 0.5 s");
    assert_eq!(state(&mut rig, StartStep::Program), StepState::Missing);
    assert!(!reason(&mut rig, StartStep::Program).is_empty());
    // Behind the first motion the machine decides: what it would measure is not known.
    let mut rig = ready_with("G00 X-90\n#1=[1+\nM30");
    tell(&mut rig, "mode auto\nwait 0.5 s");
    assert_eq!(state(&mut rig, StartStep::Program), StepState::Met);
}

#[test]
fn b3_a_loop_that_waits_or_never_ends_is_no_refusal() {
    for text in ["N10 IF[#1000 EQ 0]GOTO 10\nM30", "#1=0\nWHILE[1 EQ 1]DO1\n#1=#1+1\nEND1\nM30"] {
        let mut rig = ready_with(text);
        tell(&mut rig, "mode auto\nwait 3 s");
        assert_eq!(state(&mut rig, StartStep::Values), StepState::Met, "{text}");
        assert_eq!(state(&mut rig, StartStep::Program), StepState::Met, "{text}");
    }
}

#[test]
fn b3_a_first_move_beyond_the_soft_limit_is_told() {
    // X- ends at -300 mm of slide, 600 of diameter.
    let mut rig = ready_with("G00 X-700\nM30");
    tell(&mut rig, "mode auto\nwait 0.5 s");
    assert!(reason(&mut rig, StartStep::Program).contains("软限位"), "{}", reason(&mut rig, StartStep::Program));
}

#[test]
fn k3_7_hydraulics_are_needed_by_a_program_that_starts_the_wheel_alone() {
    let mut rig = ready_with("M03\nG00 X-90\nM30");
    tell(&mut rig, "key hydraulic\nmode auto\nwait 0.5 s");
    assert_eq!(state(&mut rig, StartStep::Hydraulics), StepState::Missing);
    let action = rig.snapshot().start_guide.step(StartStep::Hydraulics).action;
    assert_eq!(action, Some(StepAction::Press(Key::Hydraulic)));
    press(&mut rig, Key::Hydraulic);
    wait(&mut rig, 0.2);
    assert_eq!(state(&mut rig, StartStep::Hydraulics), StepState::Pending);
    wait(&mut rig, 5.0);
    assert_eq!(state(&mut rig, StartStep::Hydraulics), StepState::Met);
    let mut rig = ready_with("G00 X-90\nM30");
    tell(&mut rig, "key hydraulic\nmode auto\nwait 0.5 s");
    assert_eq!(state(&mut rig, StartStep::Hydraulics), StepState::NotNeeded);
    assert!(rig.snapshot().start_guide.is_ready());
}

#[test]
fn b5_a_local_zero_and_the_mst_lock_count_as_at_the_start() {
    // G52 of an MDI line does not reach the program: X-90 is within the soft limits.
    let mut rig = ready_with("G00 X-90\nM03\nM30");
    tell(&mut rig, "mdi G52 X-590\nmode auto\nwait 0.5 s");
    assert_eq!(state(&mut rig, StartStep::Program), StepState::Met, "{}", reason(&mut rig, StartStep::Program));
    // With M, S, T locked no wheel starts.
    tell(&mut rig, "key hydraulic\nkey mst-lock\nwait 0.5 s");
    assert_eq!(state(&mut rig, StartStep::Hydraulics), StepState::NotNeeded);
}

#[test]
fn b5_while_a_start_from_a_block_is_prepared_the_guide_is_silent() {
    let mut rig = ready_with("M03\nG00 X-90\nX-95\nM30");
    tell(&mut rig, "mode auto\nwait 0.5 s");
    assert!(rig.snapshot().start_guide.is_ready());
    rig.send(Command::RestartAt(3));
    wait(&mut rig, 0.5);
    let guide = &rig.snapshot().start_guide;
    assert!(!guide.is_ready() && guide.present().count() == 0);
}

#[test]
fn k3_4_the_tailstock_is_needed_where_p6_5_says_so_and_the_headstock_turns() {
    let clamped = |text: &str, p6_5: &str| {
        let mut rig = ready_with(text);
        tell(&mut rig, &format!("param P6.5 {p6_5}\nkey tailstock-retract\nwait 5 s\nmode auto\nwait 0.5 s"));
        state(&mut rig, StartStep::Tailstock)
    };
    assert_eq!(clamped("M63\nM30", "1"), StepState::Missing);
    assert_eq!(clamped("M63\nM30", "0"), StepState::NotNeeded);
    assert_eq!(clamped("G00 X-90\nM30", "1"), StepState::NotNeeded);
}

#[test]
fn k5_17_a_changed_wheel_is_dressed_first() {
    let mut rig = ready_with("G00 X-90\nM30");
    tell(&mut rig, "param P6.7 1\nmode auto\nwait 0.5 s");
    assert_eq!(state(&mut rig, StartStep::Wheel), StepState::Missing);
    let action = rig.snapshot().start_guide.step(StartStep::Wheel).action;
    assert_eq!(action, Some(StepAction::Open(Page::Dressing, None)));
}

#[test]
fn b8_emergency_stop_comes_first_and_reset_after_it() {
    let mut rig = ready_with("G00 X-90\nM30");
    tell(&mut rig, "mode auto\nkey emergency-stop\nwait 0.5 s");
    let next = |rig: &mut HeadlessHost| rig.snapshot().start_guide.next().map(|(step, view)| (step, view.action));
    let machine = |key: StepAction| Some((StartStep::Machine, Some(key)));
    assert_eq!(next(&mut rig), machine(StepAction::PressOnPanel(Key::EmergencyStop)));
    press(&mut rig, Key::EmergencyStop);
    wait(&mut rig, 0.5);
    assert_eq!(next(&mut rig), machine(StepAction::Press(Key::Reset)));
    press(&mut rig, Key::Reset);
    wait(&mut rig, 2.0);
    assert_ne!(next(&mut rig).map(|(step, _)| step), Some(StartStep::Machine));
}

fn pick<T: Copy>(random: &mut SplitMix64, from: &[T]) -> T {
    from[(random.next_unit() * from.len() as f64) as usize]
}

/// Keys and waits by chance, then cycle start: it starts if and only if the guide says so.
#[test]
fn b5_ready_means_that_cycle_start_starts() {
    const KEYS: [Key; 18] = [
        Key::ModeAuto,
        Key::ModeAuto,
        Key::ModeManual,
        Key::ModeMdi,
        Key::ModeHome,
        Key::Hydraulic,
        Key::TailstockAdvance,
        Key::TailstockRetract,
        Key::Oscillation,
        Key::DryRun,
        Key::WheelStart,
        Key::WheelStop,
        Key::EmergencyStop,
        Key::Reset,
        Key::XPlus,
        Key::ZPlus,
        Key::Magnetise,
        Key::WheelRetract,
    ];
    let (mut ready, mut unready) = (0, 0);
    for seed in 0..60_u64 {
        let mut random = SplitMix64::new(seed);
        let kind = pick(&mut random, &[Kind::Gc, Kind::Gs, Kind::Ga]);
        let mut rig = rig_of(kind, crate::stories::folders_of(kind));
        tell(&mut rig, "power on\nwait 1 s\nhome all");
        let program = match kind {
            Kind::Gc => pick(&mut random, &[1_002, 1_001, 1_011]),
            Kind::Gs => 1_007,
            _ => 1_010,
        };
        rig.mount_part(&PartFile::builtin(program).unwrap().unwrap());
        tell(&mut rig, &format!("load O{program}"));
        if random.next_unit() < 0.6 {
            tell(&mut rig, "key hydraulic\nwait 5 s");
        }
        if random.next_unit() < 0.6 && kind != Kind::Gc {
            tell(&mut rig, "key magnetise\nwait 5 s");
        }
        for _ in 0..=(random.next_unit() * 5.0) as u32 {
            press(&mut rig, pick(&mut random, &KEYS));
            wait(&mut rig, random.next_unit() * 8.0);
        }
        if random.next_unit() < 0.6 {
            press(&mut rig, Key::ModeAuto);
        }
        // The guide is read again and again: the newest reading is at most a fifth of a second old.
        wait(&mut rig, 0.5);
        let snapshot = rig.snapshot().clone();
        if snapshot.program.is_open || snapshot.state.is_active() || snapshot.mode == kt830::defs::key::Mode::Mdi {
            continue;
        }
        let (guide, course) = (&snapshot.start_guide, format!("seed {seed} {kind:?} {program}"));
        press(&mut rig, Key::CycleStart);
        let started = rig.snapshot().state.is_active();
        let told = rig.snapshot().message.text.zh().into_owned();
        if guide.is_ready() {
            ready += 1;
            assert!(started, "{course}: ready, but {told}");
            wait(&mut rig, 1.0);
            let after = rig.snapshot();
            assert_ne!(after.state, RunState::Alarm, "{course}: {:?}", after.alarms);
        } else {
            unready += 1;
            // What a later block needs does not stop the start itself.
            let at_start =
                [StartStep::Machine, StartStep::Guard, StartStep::Homing, StartStep::Mode, StartStep::Program];
            let stops = at_start.into_iter().any(|step| guide.step(step).state == StepState::Missing);
            assert!(!(stops && started), "{course}: started without {:?}", guide.next());
        }
    }
    assert!(ready >= 10 && unready >= 10, "{ready} ready, {unready} not");
}
