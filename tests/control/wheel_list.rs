//! The wheels of the shop: kept, mounted, balanced, crashed, removed. Source: spec K5.17; issue "the face", part 6.

use kt830::defs::page::Page;
use kt830::defs::param;
use kt830::defs::wheel_record::{MAX_WHEELS, WheelRecord};
use kt830::host::headless::HeadlessHost;
use kt830::link::Command;
use kt830::link::wheels::WheelCommand;

use crate::stories::{ready, tell};

/// A machine at rest on the page of the wheel.
fn bench() -> HeadlessHost {
    let mut rig = ready();
    tell(&mut rig, "param P77 600\nparam P78 20\nparam P79 35\nparam P374 480");
    rig.send(Command::OpenPage(Page::Wheel));
    rig.step();
    rig
}

/// Sends a command; why it was refused, empty if it was not.
fn send(rig: &mut HeadlessHost, command: WheelCommand) -> String {
    rig.send(Command::Wheel(command));
    rig.step();
    rig.step();
    rig.snapshot().edit_answer.refused.as_ref().map_or_else(String::new, |why| why.zh().into_owned())
}

fn done(rig: &mut HeadlessHost, command: WheelCommand) {
    assert_eq!(send(rig, command), "", "{command:?}");
}

fn wheel(rig: &mut HeadlessHost, number: u16) -> WheelRecord {
    rig.snapshot().production.wheels.iter().find(|wheel| wheel.number == number).copied().unwrap()
}

fn change(rig: &mut HeadlessHost, diameter_mm: f64) {
    rig.send(Command::ChangeWheel { diameter_mm, width_mm: 25.0, rated_m_s: 45.0 });
    rig.step();
    rig.step();
    assert_eq!(rig.snapshot().edit_answer.refused, None);
}

#[test]
fn k5_17_a_wheel_comes_back_with_its_diameter_and_its_dressings() {
    let mut rig = bench();
    done(&mut rig, WheelCommand::Keep(3));
    // It is dressed down to 590 mm in five dressings; then a new one comes onto the machine.
    tell(&mut rig, "param P77 590\nparam P97 5");
    change(&mut rig, 610.0);
    let kept = wheel(&mut rig, 3);
    let sizes = [kept.diameter_mm, kept.width_mm, kept.rated_m_s, kept.smallest_mm].map(f64::to_bits);
    assert_eq!((sizes, kept.dressings), ([590.0, 20.0, 35.0, 480.0].map(f64::to_bits), 5));
    let value = |rig: &mut HeadlessHost, row| (rig.snapshot().params.get(row) * 1_000.0).round() as i64;
    assert!(!kept.is_mounted, "the new one is not in the list");
    done(&mut rig, WheelCommand::Keep(4));
    done(&mut rig, WheelCommand::Mount(3));
    let rows = [param::WHEEL_DIAMETER, param::WHEEL_WIDTH, param::WHEEL_RATED_SPEED, param::WHEEL_MIN_DIAMETER];
    assert_eq!(rows.map(|row| value(&mut rig, row)), [590_000, 20_000, 35_000, 480_000]);
    // Programs take no dressings (#5805) as the sign of another wheel; the list knows those of earlier mountings.
    assert_eq!(value(&mut rig, param::DRESSING_COUNT), 0);
    assert_eq!((wheel(&mut rig, 3).is_mounted, wheel(&mut rig, 3).dressings), (true, 5));
    assert!(rig.snapshot().params.bit(param::WHEEL_UNDRESSED), "no cycle start before it is dressed");
    assert!((wheel(&mut rig, 4).diameter_mm - 610.0).abs() < 1e-9);
    // Nothing is lost at a power cut.
    rig.power_cut();
    rig.power_on();
    rig.step();
    assert_eq!(rig.snapshot().production.wheels.len(), 2);
    assert!(wheel(&mut rig, 3).is_mounted);
    // Taken off once more, after two dressings: seven in all.
    tell(&mut rig, "param P97 2\npage wheel");
    done(&mut rig, WheelCommand::Balanced);
    change(&mut rig, 610.0);
    assert_eq!(wheel(&mut rig, 3).dressings, 7);
    // A smallest diameter that the new wheel does not have was that of the old one.
    assert_eq!(value(&mut rig, param::WHEEL_MIN_DIAMETER), 480_000);
    change(&mut rig, 400.0);
    assert_eq!(value(&mut rig, param::WHEEL_MIN_DIAMETER), 0);
}

/// The smallest diameter of the wheel before is not that of one that has none.
#[test]
fn k5_17_a_wheel_without_a_smallest_diameter_has_none_when_it_is_mounted() {
    let mut rig = bench();
    tell(&mut rig, "param P374 0\npage wheel");
    done(&mut rig, WheelCommand::Keep(3));
    change(&mut rig, 610.0);
    tell(&mut rig, "param P374 480\npage wheel");
    done(&mut rig, WheelCommand::Keep(4));
    for (number, smallest) in [(3, 0), (4, 480), (3, 0)] {
        done(&mut rig, WheelCommand::Mount(number));
        assert_eq!(rig.snapshot().params.get(param::WHEEL_MIN_DIAMETER).round() as i64, smallest, "wheel {number}");
    }
}

/// A parameter that is imported from elsewhere does not say which wheel is on the machine.
#[test]
fn k5_17_every_wheel_keeps_its_own_data() {
    let mut rig = bench();
    done(&mut rig, WheelCommand::Keep(3));
    change(&mut rig, 610.0);
    done(&mut rig, WheelCommand::Keep(4));
    change(&mut rig, 620.0);
    done(&mut rig, WheelCommand::Mount(3));
    let diameters = [3, 4].map(|number| wheel(&mut rig, number).diameter_mm.to_bits());
    assert_eq!(diameters, [600.0, 610.0].map(f64::to_bits));
    assert_eq!(rig.snapshot().production.wheels.iter().filter(|wheel| wheel.is_mounted).count(), 1);
}

#[test]
fn k5_17_a_wheel_is_not_mounted_where_it_must_not_be() {
    let mut rig = bench();
    done(&mut rig, WheelCommand::Keep(3));
    change(&mut rig, 610.0);
    assert_eq!(send(&mut rig, WheelCommand::Mount(8)), "砂轮库中没有这个编号");
    tell(&mut rig, "mode manual\nkey wheel-start\nwait 1 s\nexpect output wheel on");
    assert_eq!(send(&mut rig, WheelCommand::Mount(3)), "砂轮还在转，先停砂轮");
    assert!((rig.snapshot().params.get(param::WHEEL_DIAMETER) - 610.0).abs() < 1e-9);
    tell(&mut rig, "key wheel-stop\nwait 1 s\npage position");
    assert_eq!(send(&mut rig, WheelCommand::Mount(3)), "请在换砂轮页面操作");
    tell(&mut rig, "page wheel");
    done(&mut rig, WheelCommand::Mount(3));
    assert_eq!(send(&mut rig, WheelCommand::Mount(3)), "这片砂轮装在机床上");
    assert_eq!(send(&mut rig, WheelCommand::Remove(3)), "这片砂轮装在机床上");
    // Worn down: 480 mm is its smallest diameter.
    tell(&mut rig, "param P77 480");
    change(&mut rig, 610.0);
    assert!(send(&mut rig, WheelCommand::Mount(3)).contains("已到最小直径 480"));
    done(&mut rig, WheelCommand::Remove(3));
    assert!(rig.snapshot().production.wheels.is_empty());
}

#[test]
fn k5_17_numbers_are_those_of_one_wheel_each() {
    let mut rig = bench();
    for number in [0, 100] {
        assert!(send(&mut rig, WheelCommand::Keep(number)).contains("1 到 99"));
    }
    assert!(send(&mut rig, WheelCommand::Balanced).contains("先给机床上的砂轮编号"));
    done(&mut rig, WheelCommand::Keep(3));
    // Renumbered, with what is known of it.
    done(&mut rig, WheelCommand::Balanced);
    done(&mut rig, WheelCommand::Keep(5));
    assert_eq!(rig.snapshot().production.wheels.len(), 1);
    assert!(wheel(&mut rig, 5).balanced.is_some());
    change(&mut rig, 610.0);
    assert_eq!(send(&mut rig, WheelCommand::Keep(5)), "5 号是另一片砂轮");
    for number in 10..10 + MAX_WHEELS as u16 - 1 {
        done(&mut rig, WheelCommand::Keep(number));
        change(&mut rig, 610.0);
    }
    assert_eq!(send(&mut rig, WheelCommand::Keep(99)), "砂轮库已满：先删除不用的");
}

#[test]
fn k5_17_a_crashed_wheel_is_suspect_until_it_is_balanced() {
    let mut rig = bench();
    done(&mut rig, WheelCommand::Keep(3));
    done(&mut rig, WheelCommand::Crashed);
    assert!((wheel(&mut rig, 3).is_suspect, wheel(&mut rig, 3).crashes) == (true, 1));
    done(&mut rig, WheelCommand::Balanced);
    assert!(!wheel(&mut rig, 3).is_suspect);
    done(&mut rig, WheelCommand::Crashed);
    assert!((wheel(&mut rig, 3).is_suspect, wheel(&mut rig, 3).crashes) == (true, 2));
}
