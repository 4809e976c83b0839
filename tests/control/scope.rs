//! The scope: signals are recorded tick by tick, at once or from a trigger on, and nothing moves for it.
//! Source: spec B6 (diagnosis); issue "a real machine", part 6.

use kt830::defs::scope_signal::{AxisQuantity, ScopeSignal};
use kt830::host::headless::HeadlessHost;
use kt830::link::Command;
use kt830::link::page_command::PageCommand;
use kt830::link::scope::{SCOPE_SPANS, ScopeCommand, ScopeRecording, ScopeSetup, ScopeState, ScopeTrigger};
use kt830::units::Axis;

use crate::stories::{ready_with, story, tell};

/// X goes 10 mm of the diameter, 5 of the slide, at 300 mm/min of the slide; then Z 20 mm at 1200.
const PROGRAM: &str = "G98 G01 U-10 F300\nG04 P200\nW-20 F1200\nM30";

fn recording(rig: &mut HeadlessHost) -> ScopeRecording {
    (*rig.snapshot().scope.recording).clone()
}

#[test]
fn b6_the_scope_records_every_tick_of_a_move() {
    let mut rig = ready_with(PROGRAM);
    tell(
        &mut rig,
        "mode auto\nscope X-set X-set-speed X-error Z-actual span 4 s\nkey cycle-start\nexpect no alarm\nexpect state running\nwait 5 s\nexpect no alarm",
    );
    let scope = rig.snapshot().scope.clone();
    assert_eq!(scope.state, ScopeState::Idle);
    let seen = scope.recording;
    // 4 s of 1 ms.
    assert_eq!((seen.samples.len(), seen.period.0, seen.trigger_index), (4_000, 1_000, 0));
    // The set-point of X moves by 10 mm of the diameter, in steps that the speed of the same sample tells.
    let (first, last) = (seen.samples[0][0], seen.samples[3_999][0]);
    assert!((first - last - 10.0).abs() < 1e-6, "{first} to {last}");
    for pair in seen.samples.windows(2) {
        let step = (pair[1][0] - pair[0][0]) * 60_000.0;
        assert!((pair[1][1] - step).abs() < 1e-6 * step.abs().max(1.0), "{step} beside {}", pair[1][1]);
    }
    // F300 of the slide is 600 of the diameter; a drive follows by its time constant, so the error is proportional to the
    // speed: at rest none, in the middle of the move the same for all samples.
    let (low, _) = seen.extremes(1, 0..4_000).expect("samples");
    assert!((low + 600.0).abs() < 3.0, "{low} mm/min");
    let at_speed: Vec<f64> =
        seen.samples.iter().filter(|row| (row[1] + 600.0).abs() < 1e-6).map(|row| row[2]).collect();
    assert!(at_speed.len() > 500, "{}", at_speed.len());
    let late = &at_speed[at_speed.len() / 2..];
    let (least, most) = late.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, m), x| (l.min(*x), m.max(*x)));
    assert!(most < -1.0 && most - least < 0.5, "{least} … {most} µm");
    assert!(seen.samples[3_999][2].abs() < 0.1);
}

/// The order of the samples across the trigger: a jog that goes on throughout is a straight line.
#[test]
fn b6_a_trigger_keeps_a_fifth_of_the_time_before_it() {
    for (span, period_us) in [("4 s", 1_000), ("20 s", 5_000)] {
        let mut rig = ready_with("G98 G01 W-100 F120\nM30");
        // The trigger comes 10 s behind the start, so the ring has been filled more than once.
        tell(
            &mut rig,
            &format!("mode auto\nscope Z-set Z-set-speed span {span} falling -170\nkey cycle-start\nwait 5 s"),
        );
        assert_eq!(rig.snapshot().scope.state, ScopeState::Armed);
        tell(&mut rig, "wait 25 s");
        let seen = recording(&mut rig);
        assert_eq!((rig.snapshot().scope.state, seen.period.0), (ScopeState::Idle, period_us));
        assert_eq!((seen.samples.len(), seen.trigger_index), (4_000, 800));
        // The sample of the trigger is the first below the level.
        assert!(seen.samples[seen.trigger_index][0] < -170.0 && seen.samples[seen.trigger_index - 1][0] >= -170.0);
        assert!((seen.seconds(0) + 0.8 * f64::from(period_us as u32) / 1_000.0).abs() < 1e-9);
        // F120: 2 µm a tick. At the trigger a sample may come early.
        let step_mm = -2e-6 * f64::from(period_us as u32);
        for (index, pair) in seen.samples.windows(2).enumerate() {
            let step = pair[1][0] - pair[0][0];
            let is_at_trigger = index + 1 == seen.trigger_index;
            assert!((step - step_mm).abs() < 1e-9 || is_at_trigger && step < 0.0, "{index}: {step}");
        }
    }
}

/// From rest: the speed stands at exactly zero and rises.
#[test]
fn b6_a_start_from_rest_rises_through_zero() {
    let mut rig = ready_with(PROGRAM);
    tell(&mut rig, "mode jog\nscope Z-set-speed span 0.5 s rising 0\nwait 1 s");
    assert_eq!(rig.snapshot().scope.state, ScopeState::Armed);
    tell(&mut rig, "hold Z+ 1 s");
    assert_eq!(rig.snapshot().scope.state, ScopeState::Idle);
}

/// Homing moves the coordinates, not the axis: neither speed nor following error jump.
#[test]
fn b6_homing_is_no_motion_of_the_scope() {
    let mut rig = story("key 液压\nwait 4 s");
    tell(&mut rig, "scope X-set-speed X-actual-speed X-error X-set span 60 s\nhome all\nscope stop\nwait 0.3 s");
    let seen = recording(&mut rig);
    let jump = seen.samples.windows(2).map(|pair| (pair[1][3] - pair[0][3]).abs()).fold(0.0, f64::max);
    assert!(jump > 1.0, "the zero was set: {jump} mm");
    // P48, the speed of homing, is far below 20 m/min of the diameter.
    for channel in [0, 1] {
        let (low, high) = seen.extremes(channel, 0..seen.samples.len()).expect("samples");
        assert!(low > -20_000.0 && high < 20_000.0, "{low} … {high} mm/min");
    }
    let (low, high) = seen.extremes(2, 0..seen.samples.len()).expect("samples");
    assert!(low > -10_000.0 && high < 10_000.0, "{low} … {high} µm");
}

/// Other tick times, an end while it waits, a new start while one goes on.
#[test]
fn b6_a_recording_has_its_time_at_any_tick() {
    for (tick_us, samples, period_us) in [(500, 4_000, 1_000), (2_000, 2_000, 2_000)] {
        let mut rig = story(&format!("param P58 {tick_us}\npower cut\npower on\nwait 1 s"));
        tell(&mut rig, "scope Z-actual span 4 s rising 1\nwait 0.5 s\nscope stop\nwait 0.2 s");
        assert_eq!(rig.snapshot().scope.state, ScopeState::Idle);
        tell(&mut rig, "scope X-actual span 20 s\nwait 1 s\nscope Z-actual span 4 s\nwait 4.2 s");
        let seen = recording(&mut rig);
        assert_eq!((seen.samples.len(), seen.period.0, seen.number), (samples, period_us, 3));
        assert_eq!(rig.snapshot().scope.state, ScopeState::Idle);
    }
}

#[test]
fn b6_a_trigger_without_its_signal_is_refused() {
    let mut rig = ready_with(PROGRAM);
    let channels = [None, ScopeSignal::from_id("feed"), None, None];
    let setup = ScopeSetup { channels, span: SCOPE_SPANS[0], trigger: ScopeTrigger::Rising(0.0) };
    rig.send(Command::Page(PageCommand::Scope(ScopeCommand::Start(setup))));
    rig.step();
    assert_eq!(rig.snapshot().scope.state, ScopeState::Idle);
    assert!(rig.snapshot().message.text.zh().contains("触发要用第一个信号"));
}

/// Level, edge and channel: only an edge through the level of the first signal starts it.
#[test]
fn b6_a_level_that_stands_is_no_trigger() {
    let mut rig = ready_with(PROGRAM);
    // The output is on already: it does not rise.
    tell(&mut rig, "scope output:hydraulic span 0.5 s rising 0.5\nwait 2 s\nexpect output hydraulic on");
    assert_eq!(rig.snapshot().scope.state, ScopeState::Armed);
    tell(&mut rig, "scope stop\nwait 0.2 s");
    assert_eq!(rig.snapshot().scope.state, ScopeState::Idle);
}

/// Longer than the memory holds tick by tick: every fifth tick.
#[test]
fn b6_a_long_recording_takes_fewer_samples() {
    let mut rig = ready_with(PROGRAM);
    tell(&mut rig, "scope Z-actual span 20 s\nwait 21 s");
    let seen = recording(&mut rig);
    assert_eq!((seen.samples.len(), seen.period.0), (4_000, 5_000));
}

#[test]
fn b6_the_screen_sees_a_recording_while_it_goes_on() {
    let mut rig = ready_with(PROGRAM);
    tell(&mut rig, "scope Z-actual span 20 s\nwait 5 s");
    let seen = recording(&mut rig);
    // Copied ten times a second, every fifth tick a sample.
    assert!((970..=1_001).contains(&seen.samples.len()), "{}", seen.samples.len());
    assert_eq!(rig.snapshot().scope.state, ScopeState::Recording);
}

#[test]
fn b6_a_signal_that_the_machine_lacks_is_refused() {
    let mut rig = ready_with(PROGRAM);
    tell(&mut rig, "scope Y-error\nexpect message \"Y-error\"");
    assert_eq!(rig.snapshot().scope.state, ScopeState::Idle);
}

#[test]
fn b6_every_signal_has_a_word_of_its_own() {
    let fitted = ready_with(PROGRAM).controller().params().fitted();
    let signals: Vec<ScopeSignal> = ScopeSignal::of(fitted).collect();
    for signal in &signals {
        assert_eq!(ScopeSignal::from_id(&signal.id()), Some(*signal));
    }
    assert!(signals.contains(&ScopeSignal::Axis(Axis::X, AxisQuantity::FollowingError)));
    for wrong in ["", "X", "X-", "Q-error", "X-power", "input:", "input:nothing", "XX-error", "-error"] {
        assert_eq!(ScopeSignal::from_id(wrong), None, "{wrong}");
    }
}

/// A recorded run and the same run without the scope give the same set-points, tick by tick.
#[test]
fn b6_the_scope_changes_no_set_point() {
    let run = |before: &str| {
        let mut rig = ready_with(PROGRAM);
        tell(&mut rig, &format!("mode auto\n{before}\nkey cycle-start"));
        (0..4_000)
            .map(|_| {
                rig.step();
                let row = rig.trace_row();
                (row.outputs.set_point_mm, row.outputs.terminals)
            })
            .collect::<Vec<_>>()
    };
    assert_eq!(run("scope X-set X-error input:guard-closed feed span 4 s"), run("seed 1"));
}
