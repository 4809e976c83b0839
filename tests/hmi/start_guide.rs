//! The strip of the start guide by touch: from a cold machine to a ground part, and what a touch may do.
//! Source: spec K2.2, B5, B8, H7; safety stance: a touch of the strip moves no axis and starts no program.

use crate::operators::{Hand, Operator};
use crate::stories::{folders_of, rig_of, tell};
use kt830::defs::key::Key;
use kt830::defs::kind::Kind;
use kt830::defs::page::Page;
use kt830::defs::start_step::StartStep;
use kt830::io::sim::PartFile;
use kt830::link::snapshot::RunState;
use kt830::link::start_guide::{StepAction, StepState};
use kt830::units::Axis;

/// A cold machine with the part of a program.
fn cold(kind: Kind, program: u32) -> Operator {
    let mut rig = rig_of(kind, folders_of(kind));
    if let Some(part) = PartFile::builtin(program).unwrap() {
        rig.mount_part(&part);
    }
    Operator::new(Hand::Fingers, rig)
}

fn label(step: StartStep) -> String {
    format!("{} guide-{}", step.name().zh, step.id())
}

/// Does what the strip says until nothing is missing; returns the touches.
fn follow(operator: &mut Operator, program: u32) -> u32 {
    let mut touches = 0;
    for _ in 0..300 {
        operator.wait(0.3);
        let guide = operator.snapshot().start_guide.clone();
        if guide.is_ready() {
            return touches;
        }
        let Some((step, view)) = guide.next() else { continue };
        match (view.state, view.action) {
            (StepState::Pending, _) => {}
            (_, Some(StepAction::Press(_))) => {
                touches += 1;
                operator.tap(&label(step));
            }
            (_, Some(StepAction::PressOnPanel(key))) => {
                touches += 1;
                operator.key(key);
            }
            (_, Some(StepAction::Open(Page::Directory, None))) => {
                operator.tap(&label(step));
                assert_eq!(operator.snapshot().page, Page::Directory);
                operator.load(program);
                operator.page(Page::Grinding);
                // The strip, the program, load, the page.
                touches += 4;
            }
            other => panic!("{step:?} {other:?}"),
        }
    }
    panic!("{:?}", operator.snapshot().start_guide.next());
}

#[test]
fn b5_from_power_on_to_a_ground_part_by_what_the_screen_says() {
    for (kind, program) in [(Kind::Gc, 1_002), (Kind::Gs, 1_007), (Kind::Ga, 1_010)] {
        let mut operator = cold(kind, program);
        let touches = follow(&mut operator, program) + 1;
        assert!(operator.paints_part("可以启动"), "{kind:?}");
        operator.key(Key::CycleStart);
        assert_eq!(operator.snapshot().state, RunState::Running, "{kind:?}");
        // Issue "face": twelve touches from cold to the start of the part.
        assert!(touches <= 12, "{kind:?}: {touches} touches");
        if kind == Kind::Gc {
            operator.until("the part", 120.0, |snapshot| snapshot.state == RunState::Idle);
            let part = operator.snapshot().cycle.part.expect("a part");
            assert!(operator.paints_part("合格"), "{part:?}");
        }
    }
}

#[test]
fn k7_2_a_run_shows_how_far_it_is_by_the_part_before() {
    let mut operator = cold(Kind::Gc, 1_002);
    follow(&mut operator, 1_002);
    operator.key(Key::CycleStart);
    operator.wait(10.0);
    assert!(operator.paints_part("还没有可比的循环时间"));
    operator.until("the part", 120.0, |snapshot| snapshot.state == RunState::Idle);
    let took = operator.snapshot().cycle.part.expect("a part").times.seconds;
    operator.rig.mount_part(&PartFile::builtin(1_002).unwrap().unwrap());
    operator.wait(0.5);
    operator.key(Key::CycleStart);
    operator.wait(10.0);
    assert_eq!(operator.snapshot().cycle.before.map(|before| before.seconds), Some(took));
    let left = took - operator.snapshot().cycle.times.seconds;
    let words = format!("还有约 {:02}:{:02}", left as u32 / 60, left as u32 % 60);
    assert!(operator.paints(&words), "{words}");
    // Held, the bar stays; another program has no part before.
    operator.key(Key::FeedHold);
    operator.wait(1.0);
    assert!(operator.paints_part("还有约"));
    operator.key(Key::Reset);
    operator.wait(1.0);
    assert!(!operator.paints_part("还有约"));
    operator.load(1_001);
    assert_eq!(operator.snapshot().cycle.before, None);
}

#[test]
fn b5_a_touch_of_the_strip_moves_no_axis_and_starts_nothing() {
    let mut operator = cold(Kind::Gc, 1_002);
    tell(&mut operator.rig, "load O1002");
    operator.page(Page::Grinding);
    let place = |operator: &Operator| Axis::ALL.map(|axis| operator.snapshot().axes[axis].machine.to_bits());
    let before = place(&operator);
    for _ in 0..3 {
        for step in StartStep::ALL {
            if operator.sees(&label(step)) {
                operator.tap(&label(step));
                operator.wait(2.0);
            }
        }
    }
    // Hydraulics are on and the mode has changed; homing waits for the axis key.
    assert_eq!(place(&operator), before);
    assert!(!operator.snapshot().program.is_open);
    assert_eq!(operator.snapshot().start_guide.step(StartStep::Hydraulics).state, StepState::Met);
    assert_eq!(operator.snapshot().start_guide.step(StartStep::Homing).state, StepState::Missing);
}

#[test]
fn b8_the_strip_leads_to_the_value_that_the_program_refuses() {
    let mut operator = cold(Kind::Gc, 1_002);
    tell(&mut operator.rig, "load O1002\nset #521 = 50");
    operator.page(Page::Grinding);
    operator.wait(0.5);
    operator.tap(&label(StartStep::Values));
    assert!(operator.paints_part("成品直径 #521 不小于毛坯直径 #520"));
    assert!(operator.paints_part("数据输入: #521="));
    // From another page it opens the grinding page at the value.
    operator.page(Page::Position);
    operator.tap(&label(StartStep::Values));
    operator.look();
    assert_eq!(operator.snapshot().page, Page::Grinding);
    assert!(operator.paints_part("数据输入: #521="));
    operator.value(521, "40");
    operator.wait(0.5);
    assert_eq!(operator.snapshot().start_guide.step(StartStep::Values).state, StepState::Met);
}

#[test]
fn k2_4_a_touched_condition_says_that_it_is_met() {
    let mut operator = cold(Kind::Gc, 1_002);
    operator.wait(0.5);
    operator.tap(&label(StartStep::Machine));
    assert!(operator.paints_part("机床：已就绪"));
    operator.wait(7.0);
    assert!(!operator.paints_part("机床：已就绪"));
}
