//! Finished parts and production orders: what is counted, what is refused, what outlives a power cut.
//! Source: spec B6, K4.5, K7.2.

use kt830::defs::date::DateTime;
use kt830::defs::downtime_reason::DowntimeReason;
use kt830::defs::history::HistoryEntry;
use kt830::defs::hour_record::{HourRecord, MachineUse};
use kt830::defs::kind::Kind;
use kt830::defs::part_record::{MAX_PART_RECORDS, PartHistory, PartRecord};
use kt830::defs::part_verdict::PartVerdict;
use kt830::defs::production_order::{MAX_ORDERS, MAX_PROPOSALS, OrderState, OrderValues, ProductionOrder};
use kt830::host::folders::program_from_bytes;
use kt830::host::headless::HeadlessHost;
use kt830::link::Command;
use kt830::link::page_command::PageCommand;
use kt830::link::part_result::{CorrectionAdvice, PartCommand};
use kt830::link::production::{OrderCommand, OrderProposal};

use crate::stories::{ready, ready_of, tell};

/// O1002 and O1004 end a part at once. The part of O1002 is Ø40.3, +0.01 −0.01.
fn shop() -> HeadlessHost {
    let mut rig = ready();
    for number in [1_002, 1_004] {
        let name = format!("O{number}.NC");
        rig.add_program(program_from_bytes(number, &name, b"G04 P100\nM31\nM30".to_vec(), rig.kind().dialect()));
    }
    tell(&mut rig, "load O1002\npart assets/parts/O1002.ron\nset #521 = 40.3\nset #532 = 0.01\nset #533 = -0.01");
    rig
}

fn make(rig: &mut HeadlessHost) {
    tell(rig, "mode auto\nkey cycle-start\nwait until idle max 20 s\nexpect no alarm\nwait 0.1 s");
}

fn order(rig: &mut HeadlessHost, number: u32) -> ProductionOrder {
    *rig.snapshot().production.orders.iter().find(|order| order.number == number).expect("the order")
}

fn enter(number: u32, program: u32, target: u32) -> OrderCommand {
    OrderCommand::Enter(OrderProposal { number, program, target, values: OrderValues::default() })
}

fn start(number: u32) -> OrderCommand {
    OrderCommand::Start { number, takes_values: true }
}

fn last(rig: &mut HeadlessHost) -> PartRecord {
    *rig.snapshot().production.parts.last().expect("a part")
}

#[test]
fn b6_parts_count_for_the_active_order_of_their_program_alone() {
    let mut rig = shop();
    make(&mut rig);
    assert_eq!((last(&mut rig).order, last(&mut rig).count), (0, 1), "no order is active");
    tell(&mut rig, "order 501 O1002 2\norder 502 O1004 5\norder start 501");
    make(&mut rig);
    let part = last(&mut rig);
    assert_eq!((part.order, part.program, part.count, part.verdict), (501, 1_002, 2, PartVerdict::Good));
    assert!((part.size.expect("measured by the simulated machine") - 40.3).abs() < 0.01);
    assert_eq!(part.limits.map(|limits| limits.map(|mm| (mm * 1e3_f64).round())), Some([40_300.0, 40_290.0, 40_310.0]));
    assert_eq!((order(&mut rig, 501).good, order(&mut rig, 501).bad), (1, 0));
    // A part of another program is none of it.
    tell(&mut rig, "load O1004");
    make(&mut rig);
    assert_eq!((last(&mut rig).order, order(&mut rig, 501).good), (0, 1));
    // Out of tolerance it is a bad part, and the order wants another one.
    tell(&mut rig, "load O1002\nset #521 = 40.2");
    make(&mut rig);
    assert!(last(&mut rig).verdict.is_bad());
    assert_eq!((order(&mut rig, 501).good, order(&mut rig, 501).bad), (1, 1));
    tell(&mut rig, "set #521 = 40.3");
    make(&mut rig);
    tell(&mut rig, "expect message \"501 完成：2 件\"");
    assert!(order(&mut rig, 501).is_complete() && order(&mut rig, 501).state == OrderState::Active);
}

#[test]
fn b6_sizes_typed_on_the_page_judge_the_last_part() {
    let mut rig = ready_of(Kind::Gs);
    rig.add_program(program_from_bytes(1_008, "O1008.NC", b"T0101\nG04 P100\nM31\nM30".to_vec(), rig.kind().dialect()));
    // Floor 15, +0.003 −0.003; the deviations are not those of the walls.
    tell(&mut rig, "load O1008\nset #701 = 15\nset #706 = 5\nset #708 = 55\nset #713 = 0.003\nset #714 = -0.003");
    tell(&mut rig, "order 501 O1008 2\norder start 501");
    make(&mut rig);
    let course = [
        ("type #709 0.01", PartVerdict::NotMeasured), // an infeed is no size
        ("type #716 5.004", PartVerdict::NotMeasured),
        ("type #715 15.002", PartVerdict::Good),
        ("type #715 15.004", PartVerdict::Out { partly: false }),
        ("type #715 17", PartVerdict::Out { partly: false }), // a typing error: the program refuses it
        ("type #715 15.001", PartVerdict::Good),
        ("set #701 = 15.01\ntype #715 15.02", PartVerdict::Good), // that is of the next part
        ("set #701 = 15\ntype #715 15.002", PartVerdict::Good),
    ];
    tell(&mut rig, "page grinding");
    for (typed, verdict) in course {
        tell(&mut rig, &format!("{typed}\nwait 0.1 s"));
        assert_eq!(last(&mut rig).verdict, verdict, "{typed}");
        let bad = u32::from(verdict.is_bad());
        assert_eq!((order(&mut rig, 501).good, order(&mut rig, 501).bad), (1 - bad, bad), "{typed}");
    }
    assert_eq!(last(&mut rig).size, Some(15.002));
    // The program corrects by it: the card proposes no second correction.
    let part = rig.snapshot().cycle.part.expect("a part");
    assert_eq!(part.advice(None), CorrectionAdvice::ByGauge);
    // The next part is another one, and nothing is known of it.
    make(&mut rig);
    assert_eq!((last(&mut rig).count, last(&mut rig).verdict), (2, PartVerdict::NotMeasured));
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 0.05 s\ntype #715 15.02\nwait 1 s");
    assert_eq!(last(&mut rig).verdict, PartVerdict::NotMeasured, "not in a run");
}

/// 实测孔径 belongs to 成品孔径.
#[test]
fn b6_a_bore_that_is_typed_on_the_page_judges_its_part() {
    let mut rig = ready();
    rig.add_program(program_from_bytes(1_017, "O1017.NC", b"T0202\nG04 P100\nM31\nM30".to_vec(), rig.kind().dialect()));
    tell(&mut rig, "load O1017\nset #880 = 40\nparam P377 0.003\nparam P378 -0.003\npage grinding");
    make(&mut rig);
    for (typed, verdict) in [("39.998", PartVerdict::Good), ("39.996", PartVerdict::Out { partly: false })] {
        tell(&mut rig, &format!("type #895 {typed}\nwait 0.1 s"));
        assert_eq!(last(&mut rig).verdict, verdict, "{typed}");
    }
}

/// The program of the page would correct the same error again.
#[test]
fn b6_the_page_takes_no_size_of_a_part_that_the_card_has_corrected() {
    let mut rig = ready_of(Kind::Gs);
    rig.add_program(program_from_bytes(1_008, "O1008.NC", b"T0101\nG04 P100\nM31\nM30".to_vec(), rig.kind().dialect()));
    tell(&mut rig, "load O1008\nset #701 = 15\nset #713 = 0.003\nset #714 = -0.003\nparam P22.0 1");
    make(&mut rig);
    let ended_at = rig.snapshot().cycle.part.expect("a part").ended_at;
    rig.send(Command::Part(PartCommand::TypeSize { ended_at, mm: 15.01 }));
    rig.send(Command::Part(PartCommand::Correct { ended_at, increment: -0.01 }));
    tell(&mut rig, "wait 0.1 s");
    assert_eq!(rig.snapshot().cycle.part.expect("a part").corrected, Some(-0.01));
    tell(&mut rig, "page grinding\ntype #715 15.01\nwait 0.1 s\nexpect message \"已经修正过\"");
    assert_eq!(rig.controller().variable(715), None);
    tell(&mut rig, "type #709 0.01\nwait 0.1 s\nexpect #709 0.01");
}

#[test]
fn b6_a_size_that_the_operator_types_changes_the_counts() {
    let mut rig = shop();
    tell(&mut rig, "order 501 O1002 9\norder start 501");
    make(&mut rig);
    let ended_at = rig.snapshot().cycle.part.expect("a part").ended_at;
    for (mm, counts) in [(40.325, (0, 1)), (40.302, (1, 0))] {
        rig.send(Command::Part(PartCommand::TypeSize { ended_at, mm }));
        rig.step();
        assert_eq!((order(&mut rig, 501).good, order(&mut rig, 501).bad), counts, "{mm}");
        assert_eq!((last(&mut rig).size, rig.snapshot().production.parts.len()), (Some(mm), 1));
    }
}

fn add(rig: &mut HeadlessHost, number: u32, text: &str) {
    let (name, bytes) = (format!("O{number}.NC"), text.as_bytes().to_vec());
    rig.add_program(program_from_bytes(number, &name, bytes, rig.kind().dialect()));
}

fn made(rig: &mut HeadlessHost) -> Vec<(u32, u32, f64)> {
    let parts = rig.snapshot().production.parts.iter();
    parts.map(|part| (part.number, part.order, (part.cycle_seconds * 10.0).round() / 10.0)).collect()
}

/// A program that M99 repeats counts its parts by M31 and never ends; one may count two parts; one that counts none makes
/// none.
#[test]
fn b6_a_part_is_made_where_its_program_counts_it() {
    let mut rig = shop();
    add(&mut rig, 1_002, "G04 P2000\nM31\nM99");
    tell(&mut rig, "order 501 O1002 50\norder start 501\nmode auto\nkey cycle-start\nwait 6.5 s\nkey reset\nwait 1 s");
    assert_eq!(made(&mut rig), [(1, 501, 2.0), (2, 501, 2.0), (3, 501, 2.0)]);
    assert_eq!(order(&mut rig, 501).good, 3);
    add(&mut rig, 1_002, "G04 P1000\nM31\nG04 P2000\nM31\nG04 P500\nM30");
    make(&mut rig);
    assert_eq!(made(&mut rig)[3..], [(4, 501, 1.0), (5, 501, 2.0)]);
    add(&mut rig, 2_001, "G04 P100\nM30");
    tell(&mut rig, "order 502 O2001 5\norder start 502");
    make(&mut rig);
    assert_eq!((rig.snapshot().production.parts.len(), order(&mut rig, 502).made()), (5, 0));
}

/// P390 repeats a program whose M31 and M30 are apart: every pass makes one part, good or bad.
#[test]
fn b6_every_pass_of_a_repeated_program_makes_one_part() {
    for (nominal, counts) in [(40.3, (3, 0)), (40.2, (0, 3))] {
        let mut rig = shop();
        add(&mut rig, 1_002, "G04 P300\nM31\nG04 P200\nM30");
        tell(&mut rig, &format!("param P390 3\nset #521 = {nominal}\norder 501 O1002 9\norder start 501"));
        tell(&mut rig, "mode auto\nkey cycle-start\nwait 6 s\nexpect state idle");
        assert_eq!((order(&mut rig, 501).good, order(&mut rig, 501).bad), counts);
        assert_eq!(made(&mut rig), [(1, 501, 0.5), (2, 501, 0.5), (3, 501, 0.5)], "{nominal}");
    }
}

/// Air cuts are no parts, nor is a line of MDI; on the lathe, whose programs count none, the end of the program of the order
/// makes its part.
#[test]
fn b6_what_makes_no_part_and_what_does_on_a_lathe() {
    let mut rig = shop();
    tell(&mut rig, "order 501 O1002 9\norder start 501\nkey dry-run");
    make(&mut rig);
    tell(&mut rig, "key dry-run\nkey machine-lock");
    make(&mut rig);
    tell(&mut rig, "key machine-lock\nhome all\nmode mdi\nmdi M31\nwait 1 s");
    assert_eq!((made(&mut rig).len(), order(&mut rig, 501).made()), (0, 0));
    let mut rig = crate::stories::ready_of(Kind::Lathe);
    let text = b"N0010G04F0.5\nN0020M02".to_vec();
    rig.add_program(program_from_bytes(7_000, "PART.NC", text, rig.kind().dialect()));
    tell(&mut rig, "load PART");
    make(&mut rig);
    assert!(made(&mut rig).is_empty());
    let program = rig.snapshot().program.number;
    rig.send(Command::Order(enter(501, program, 9)));
    tell(&mut rig, "order start 501");
    make(&mut rig);
    assert_eq!((made(&mut rig).len(), order(&mut rig, 501).good), (1, 1));
}

/// A number may be used again: the parts of the order before are none of the new one.
#[test]
fn b6_an_order_of_a_number_that_was_used_before_begins_anew() {
    let mut rig = shop();
    tell(&mut rig, "order 501 O1002 2\norder start 501");
    make(&mut rig);
    let ended_at = rig.snapshot().cycle.part.expect("a part").ended_at;
    tell(&mut rig, "order close 501\norder delete 501\norder 501 O1002 9\norder start 501");
    let fresh = order(&mut rig, 501);
    assert!(!rig.snapshot().production.parts.iter().any(|part| fresh.has(part)));
    rig.send(Command::Part(PartCommand::TypeSize { ended_at, mm: 40.325 }));
    rig.step();
    assert_eq!((order(&mut rig, 501).good, order(&mut rig, 501).bad), (0, 0));
}

/// It is told once, when the part is measured; and when the target comes down to what is made.
#[test]
fn b6_a_complete_order_is_told_once() {
    let mut rig = shop();
    // The part is measured at the end, a while after it is counted.
    add(&mut rig, 1_002, "G04 P100\nM31\nG04 P500\nM30");
    tell(&mut rig, "order 501 O1002 1\norder start 501\nset #521 = 40.2");
    make(&mut rig);
    let told = |rig: &mut HeadlessHost| rig.snapshot().message.text.en().contains("is complete");
    assert!(!told(&mut rig), "the only part is bad");
    tell(&mut rig, "set #521 = 40.3");
    make(&mut rig);
    assert!(told(&mut rig));
    tell(&mut rig, "order 501 O1002 9\nwait 0.1 s");
    assert!(!told(&mut rig));
    tell(&mut rig, "order 501 O1002 1\nwait 0.1 s");
    assert!(told(&mut rig));
}

#[test]
fn b6_an_order_that_makes_no_sense_is_refused_and_changes_nothing() {
    let mut rig = shop();
    tell(&mut rig, "order 501 O1002 50");
    let before = rig.snapshot().production.orders.clone();
    let refuse = |rig: &mut HeadlessHost, command: OrderCommand, says: &str| {
        rig.send(Command::Order(command));
        rig.step();
        let message = rig.snapshot().message.text.en().into_owned();
        assert!(message.contains(says), "{command:?}: {message}");
    };
    refuse(&mut rig, enter(0, 1_002, 5), "a number from 1 to 99999999");
    refuse(&mut rig, enter(100_000_000, 1_002, 5), "a number from 1 to");
    refuse(&mut rig, enter(7, 1_002, 0), "1 to 999999");
    refuse(&mut rig, enter(7, 4_711, 5), "no such program");
    for command in [start(9), OrderCommand::Close(9), OrderCommand::Delete(9)] {
        refuse(&mut rig, command, "no such order");
    }
    assert_eq!(rig.snapshot().production.orders, before);
    // While it is active it stays, with its program; nor does it change that once it has parts.
    tell(&mut rig, "order start 501");
    refuse(&mut rig, OrderCommand::Delete(501), "close it or start another");
    refuse(&mut rig, enter(501, 1_004, 50), "the order is active");
    make(&mut rig);
    tell(&mut rig, "order close 501");
    refuse(&mut rig, enter(501, 1_004, 50), "has parts already");
    // With all parts made it does not start; with a higher target it goes on.
    tell(&mut rig, "order 501 O1002 1");
    refuse(&mut rig, start(501), "raise the target");
    tell(&mut rig, "order 501 O1002 2\norder start 501");
    assert_eq!((order(&mut rig, 501).state, order(&mut rig, 501).good), (OrderState::Active, 1));
    for number in 1..MAX_ORDERS as u32 {
        tell(&mut rig, &format!("order {number} O1002 5"));
    }
    refuse(&mut rig, enter(600, 1_002, 5), "the list is full");
}

#[test]
fn b6_an_order_starts_with_its_program_and_not_while_another_one_runs() {
    let mut rig = shop();
    tell(&mut rig, "order 501 O1004 5\norder 502 O1002 5\norder start 501");
    assert_eq!(rig.snapshot().program.number, 1_004);
    tell(&mut rig, "order start 502");
    assert_eq!(rig.snapshot().program.number, 1_002);
    let states = [501, 502].map(|number| order(&mut rig, number).state);
    assert_eq!(states, [OrderState::Waiting, OrderState::Active], "one order at a time");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 0.02 s\nexpect state running");
    rig.send(Command::Order(start(501)));
    rig.step();
    assert_eq!((order(&mut rig, 501).state, rig.snapshot().program.number), (OrderState::Waiting, 1_002));
}

#[test]
fn b6_parts_and_orders_outlive_a_power_cut() {
    let mut rig = shop();
    tell(&mut rig, "order 501 O1002 5\norder 502 O1004 6\norder 503 O1002 7\norder start 501");
    make(&mut rig);
    tell(&mut rig, "order delete 502");
    let (orders, parts) = (rig.snapshot().production.orders.to_vec(), rig.snapshot().production.parts.to_vec());
    assert_eq!(orders.iter().map(|order| order.number).collect::<Vec<_>>(), [501, 503]);
    assert_eq!(rig.retained().orders, orders);
    assert_eq!(rig.retained().parts, parts);
    tell(&mut rig, "power cut\nwait 1 s\npower on\nwait 1 s");
    assert_eq!(
        (rig.snapshot().production.orders.to_vec(), rig.snapshot().production.parts.to_vec()),
        (orders, parts.clone())
    );
    // The next part has the next number.
    tell(&mut rig, "home all\nkey hydraulic\nwait 4 s\nload O1002\nkey tailstock-advance\nwait 2 s");
    make(&mut rig);
    assert_eq!((last(&mut rig).count, last(&mut rig).order), (parts[0].count + 1, 501));
}

#[test]
fn b6_the_history_of_parts_keeps_the_newest_thousand_in_their_slots() {
    let part = |count| PartRecord {
        count,
        number: 1,
        program: 1_002,
        order: 0,
        ended: Default::default(),
        cycle_seconds: 1.0,
        size: None,
        limits: None,
        verdict: PartVerdict::NotMeasured,
        since_dressing: 1,
        wheel_mm: None,
        alarms: [0; 4],
    };
    let mut history = PartHistory::new([], 1);
    (1..=1_500).for_each(|count| history.push(part(count)));
    assert_eq!((history.len(), history[0].count, history[999].count), (MAX_PART_RECORDS, 501, 1_500));
    let slots: std::collections::BTreeSet<_> = history.iter().map(HistoryEntry::slot).collect();
    assert_eq!(slots.len(), MAX_PART_RECORDS);
}

/// Ten seconds before eight: idle; then a program of 20 s, held for 15 s, and an alarm for 15 s.
#[test]
fn b6_the_hours_count_what_the_machine_does() {
    let mut rig = shop();
    let text = b"G04 P20000\nM31\nM30".to_vec();
    rig.add_program(program_from_bytes(1_002, "O1002.NC", text, rig.kind().dialect()));
    assert!(rig.snapshot().production.hours.is_empty(), "no date, no hour");
    let eight = DateTime::parse("2026-11-28 08:00:00").expect("a date");
    rig.send(Command::WallClock(DateTime(eight.0 - 10)));
    tell(&mut rig, "wait 20 s\nmode auto\nkey cycle-start\nwait 8 s\nkey feed-hold\nwait 15 s\nexpect state held");
    tell(&mut rig, "key cycle-start\nwait until idle max 30 s\nfault drive-X\nwait 15 s\nexpect state alarm");
    tell(&mut rig, "fault drive-X off\nkey reset\nwait 12 s\nexpect state idle");
    let hours = rig.snapshot().production.hours.to_vec();
    let hour = HourRecord::hour_of(eight).expect("an hour");
    assert_eq!(hours.iter().map(|record| record.hour).collect::<Vec<_>>(), [hour - 1, hour]);
    let near = |found: u32, wanted: u32| found.abs_diff(wanted) <= 1;
    assert!(near(hours[0].seconds[MachineUse::Idle as usize], 10), "{hours:?}");
    assert_eq!((hours[0].seconds_on(), hours[0].good), (hours[0].seconds[MachineUse::Idle as usize], 0));
    // 10 s idle, then 20 s of the dwell; what is not folded yet is less than 10 s.
    for (used, wanted) in [(MachineUse::Running, 20), (MachineUse::Waiting, 15), (MachineUse::Alarm, 15)] {
        assert!(near(hours[1].seconds[used as usize], wanted), "{used:?}: {hours:?}");
    }
    assert!((10..=23).contains(&hours[1].seconds[MachineUse::Idle as usize]), "{hours:?}");
    assert_eq!((hours[1].good, hours[1].bad), (1, 0));
    // The first hour is stored since it ended, the other one with its part; a power cut leaves both.
    assert_eq!(rig.retained().hours.len(), 2);
    // A clock that is set back finds its hour again.
    let before = hours[0];
    rig.send(Command::WallClock(DateTime(eight.0 - 600)));
    tell(&mut rig, "wait 21 s");
    let hours = rig.snapshot().production.hours.to_vec();
    assert_eq!(hours.len(), 2);
    assert!(hours[0].seconds_on() >= before.seconds_on() + 10, "{hours:?}");
}

/// Ten minutes before eight the machine stands; at five past eight the operator says why, and it stands for five more.
#[test]
fn b6_a_stop_has_the_reason_that_the_operator_gives() {
    let mut rig = shop();
    let eight = DateTime::parse("2026-11-28 08:00:00").expect("a date");
    let explain = |reason| Command::Page(PageCommand::SetDowntimeReason(reason));
    let explained = |rig: &mut HeadlessHost, reason: DowntimeReason| -> Vec<u32> {
        rig.snapshot().production.hours.iter().map(|record| record.explained[reason as usize]).collect()
    };
    let near = |found: Vec<u32>, wanted: [u32; 2]| {
        found.len() == 2 && found.iter().zip(wanted).all(|(found, wanted)| found.abs_diff(wanted) <= 1)
    };
    rig.send(Command::WallClock(DateTime(eight.0 - 600)));
    tell(&mut rig, "wait 900 s");
    rig.send(explain(Some(DowntimeReason::Repair)));
    tell(&mut rig, "wait 0.1 s");
    assert_eq!(rig.snapshot().production.downtime_reason, Some(DowntimeReason::Repair));
    let found = explained(&mut rig, DowntimeReason::Repair);
    assert!(near(found.clone(), [600, 300]), "{found:?}");
    // It holds from now on; another one holds from then on and leaves what was said before.
    tell(&mut rig, "wait 300 s");
    rig.send(explain(Some(DowntimeReason::SetUp)));
    tell(&mut rig, "wait 100 s");
    rig.send(explain(None));
    tell(&mut rig, "wait 50 s");
    let (repair, set_up) = (explained(&mut rig, DowntimeReason::Repair), explained(&mut rig, DowntimeReason::SetUp));
    assert!(near(repair.clone(), [600, 600]) && near(set_up.clone(), [0, 100]), "{repair:?} {set_up:?}");
    // What stood without a reason gets the next one, and no hour has more reasons than it stood.
    rig.send(explain(Some(DowntimeReason::Break)));
    tell(&mut rig, "wait 11 s");
    for record in rig.snapshot().production.hours.iter() {
        let stood = record.seconds_on() - record.seconds[MachineUse::Running as usize];
        assert!(record.explained.iter().sum::<u32>() <= stood, "{record:?}");
    }
    let found = explained(&mut rig, DowntimeReason::Break);
    assert!(found[1].abs_diff(61) <= 11, "{found:?}");
    // The next run ends it; while it runs no reason is taken.
    let text = b"G04 P20000\nM31\nM30".to_vec();
    rig.add_program(program_from_bytes(1_002, "O1002.NC", text, rig.kind().dialect()));
    tell(&mut rig, "load O1002\nmode auto\nkey cycle-start\nwait 5 s");
    assert_eq!(rig.snapshot().production.downtime_reason, None);
    rig.send(explain(Some(DowntimeReason::NoParts)));
    tell(&mut rig, "wait 0.1 s");
    assert_eq!(rig.snapshot().production.downtime_reason, None);
    assert!(rig.snapshot().message.text.zh().contains("机床在运行"), "{}", rig.snapshot().message.text.zh());
    tell(&mut rig, "wait until idle max 60 s\nwait 20 s");
    assert_eq!(explained(&mut rig, DowntimeReason::NoParts), [0, 0]);
    // It is stored: a power cut keeps what was said.
    let kept: Vec<_> = rig.retained().hours.iter().map(|record| record.explained).collect();
    assert!(kept.iter().any(|explained| explained[DowntimeReason::Repair as usize] >= 599), "{kept:?}");
}

/// Idle, then an alarm, then a held program, over the full hour, with a short move of the set-up in between: the reason
/// holds on, and no hour has more reasons than it stood. A clock that is set back gives nothing to other stops.
#[test]
fn b6_a_reason_outlives_moves_of_the_set_up_and_never_exceeds_the_stop() {
    let mut rig = shop();
    let reason = |reason| Command::Page(PageCommand::SetDowntimeReason(reason));
    // Without a date nothing is recorded, and that is said.
    rig.send(reason(Some(DowntimeReason::SetUp)));
    tell(&mut rig, "wait 0.1 s");
    assert!(rig.snapshot().message.text.zh().contains("没有日期"), "{}", rig.snapshot().message.text.zh());
    let eight = DateTime::parse("2026-11-28 08:00:00").expect("a date");
    rig.send(Command::WallClock(DateTime(eight.0 - 100)));
    tell(&mut rig, "wait 50.3 s\nfault drive-X\nwait 20.7 s");
    rig.send(reason(Some(DowntimeReason::SetUp)));
    tell(&mut rig, "wait 0.4 s\nfault drive-X off\nkey reset\nwait 40.6 s\nhome all\nmode mdi\nmdi G04 P3000");
    assert_eq!(rig.snapshot().production.downtime_reason, Some(DowntimeReason::SetUp), "MDI is set-up");
    tell(&mut rig, "wait until idle max 20 s\nwait 30.9 s");
    for record in rig.snapshot().production.hours.iter() {
        let stood = record.seconds_on() - record.seconds[MachineUse::Running as usize];
        assert!(record.explained.iter().sum::<u32>() <= stood, "{record:?}");
        assert!(record.explained[DowntimeReason::SetUp as usize] + 12 >= stood, "{record:?}");
    }
    // The clock goes back by three hours; the stop has begun after that hour.
    let before = rig.snapshot().production.hours.to_vec();
    rig.send(Command::WallClock(DateTime(eight.0 - 10_800)));
    rig.send(reason(None));
    tell(&mut rig, "wait 60 s");
    rig.send(reason(Some(DowntimeReason::Break)));
    tell(&mut rig, "wait 1 s");
    for record in before {
        let now = rig.snapshot().production.hours.iter().find(|hour| hour.hour == record.hour).copied();
        let now = now.expect("kept");
        assert_eq!(now.explained[DowntimeReason::Break as usize], 0, "{now:?}");
    }
}

/// A month later an hour takes the slot of the one before.
#[test]
fn b6_the_hours_of_a_month_are_kept() {
    let mut rig = shop();
    let first = DateTime::parse("2026-11-28 08:00:00").expect("a date");
    for day in [0, 1, 31, 62] {
        rig.send(Command::WallClock(DateTime(first.0 + day * 86_400)));
        tell(&mut rig, "wait 11 s");
    }
    let days = |rig: &mut HeadlessHost| -> Vec<i64> {
        rig.snapshot().production.hours.iter().map(|record| (record.began().0 - first.0) / 86_400).collect()
    };
    assert_eq!(days(&mut rig), [1, 62]);
}

/// B6: a part tells the wheel that has ground it, and what was wrong since the part before it.
#[test]
fn b6_a_part_keeps_its_wheel_and_the_alarms_since_the_part_before() {
    let mut rig = shop();
    make(&mut rig);
    assert_eq!((last(&mut rig).wheel_mm, last(&mut rig).alarms), (Some(600.0), [0; 4]));
    tell(&mut rig, "input emergency-stop on\nwait 0.1 s\ninput emergency-stop off\nwait 0.1 s\nkey reset\nwait 0.1 s");
    tell(&mut rig, "fault drive-x\nwait 0.1 s\nfault drive-x off\nkey reset\nwait 0.1 s\nmode home\nhome all");
    tell(&mut rig, "power cut\npower on\nwait 0.2 s\nkey hydraulic\nwait 4 s\nhome all\nload O1002");
    make(&mut rig);
    assert_eq!(last(&mut rig).alarms, [0; 4], "those before a power-off are in the history alone");
    tell(&mut rig, "fault drive-x\nwait 0.1 s\nfault drive-x off\nkey reset\nwait 0.1 s\nhome all");
    make(&mut rig);
    assert_eq!(last(&mut rig).alarms, [104, 0, 0, 0]);
    make(&mut rig);
    assert_eq!(last(&mut rig).alarms, [0; 4]);
}

/// B6: an order of the shop stands in the list until the operator has decided; nothing of it is in force before that.
#[test]
fn b6_an_order_of_the_shop_waits_for_the_operator() {
    let mut rig = shop();
    let current = rig.snapshot().program.number;
    tell(&mut rig, "propose-order 701 O1004 5\nexpect message \"701\"\nexpect message \"接受\"");
    assert_eq!((order(&mut rig, 701).state, rig.snapshot().program.number), (OrderState::Proposed, current));
    // The shop may change it, and the operator's line is not filled anew.
    tell(&mut rig, "propose-order 701 O1004 6");
    assert_eq!(order(&mut rig, 701).target, 6);
    tell(&mut rig, "order start 701\nexpect message \"先接受\"\norder close 701\nexpect message \"先接受\"");
    assert_eq!(order(&mut rig, 701).state, OrderState::Proposed);
    make(&mut rig);
    assert_eq!((last(&mut rig).order, order(&mut rig, 701).made()), (0, 0), "no part counts for it");
    tell(
        &mut rig,
        "order accept 701 O1004 5\nexpect message \"再看一次\"\norder accept 701 O1004 6\nexpect message \"701 已接受\"",
    );
    assert_eq!(order(&mut rig, 701).state, OrderState::Waiting);
    // Accepted it is the operator's.
    tell(
        &mut rig,
        "propose-order 701 O1002 9\norder accept 701 O1004 6\nexpect message \"订单已接受\"\norder start 701",
    );
    let accepted = order(&mut rig, 701);
    assert_eq!((accepted.state, accepted.program, accepted.target), (OrderState::Active, 1_004, 6));
    // Entered by the operator with other figures it is accepted, too; or it is deleted.
    tell(&mut rig, "propose-order 702 O1002 5\norder 702 O1002 4\npropose-order 703 O1002 5\norder delete 703");
    assert_eq!((order(&mut rig, 702).state, order(&mut rig, 702).target), (OrderState::Waiting, 4));
    assert!(rig.snapshot().production.order(703).is_none());
    tell(&mut rig, "propose-order 704 O1002 3\nwait 1 s\npower cut\npower on\nwait 0.2 s");
    assert_eq!(order(&mut rig, 704).state, OrderState::Proposed, "over a power-off");
}

/// B6: values of an order of the shop are those of the page once the operator has started it with them, and not before.
#[test]
fn b6_values_of_an_order_are_in_force_when_the_operator_starts_it() {
    let mut rig = shop();
    let size = |rig: &mut HeadlessHost| rig.snapshot().variables[521];
    tell(&mut rig, "propose-order 701 O1002 5 #521=38.02 #532=0.005");
    assert_eq!(order(&mut rig, 701).values.iter().count(), 2);
    // Accepted are the values that were shown.
    tell(&mut rig, "order accept 701 O1002 5 #521=38.02\nexpect message \"再看一次\"");
    tell(&mut rig, "order accept 701 O1002 5 #521=38.02 #532=0.005\nexpect message \"701 已接受\"");
    assert_eq!(size(&mut rig), Some(40.3), "an accepted order changes nothing");
    tell(&mut rig, "order start 701 keep-values\nexpect message \"开始\"");
    assert_eq!((order(&mut rig, 701).state, size(&mut rig)), (OrderState::Active, Some(40.3)));
    // In a run nothing is changed.
    let long = program_from_bytes(1_002, "O1002.NC", b"G04 X5\nM30".to_vec(), rig.kind().dialect());
    rig.add_program(long);
    tell(&mut rig, "load O1002\nmode auto\nkey cycle-start\nwait 0.2 s\norder start 701");
    assert!(rig.snapshot().message.text.zh().contains("程序运行中"), "{:?}", rig.snapshot().message);
    assert_eq!(size(&mut rig), Some(40.3));
    tell(&mut rig, "wait until idle max 20 s\norder start 701\nexpect message \"采用 2 个数值\"");
    assert_eq!((size(&mut rig), rig.snapshot().variables[532]), (Some(38.02), Some(0.005)));
    tell(&mut rig, "power cut\npower on\nwait 0.2 s");
    assert_eq!((size(&mut rig), order(&mut rig, 701).values.iter().count()), (Some(38.02), 2), "over a power-off");
    // Values are those of a page: another program has another one.
    tell(
        &mut rig,
        "propose-order 702 O1002 5 #521=38\norder 702 O1002 4\nexpect message \"再看一次\"\n\
         order 702 O1002 4 #521=38\npropose-order 703 O1002 5 #521=38\norder 703 O1004 4 #521=38",
    );
    assert_eq!([702, 703].map(|number| order(&mut rig, number).values.iter().count()), [1, 0]);
}

/// B6: an order that asks for what is no value of its page is left aside.
#[test]
fn b6_values_that_its_page_has_not_are_no_order() {
    let mut rig = shop();
    // Not on the page, out of range, more decimals than are shown, no number.
    for values in ["#899=1", "#521=1e9", "#5021=1", "#100=1", "#521=38.0004", "#521=nan"] {
        tell(&mut rig, &format!("propose-order 701 O1002 5 {values}"));
        assert!(rig.snapshot().production.orders.is_empty(), "{values}");
    }
    // The page is gone when it is started: nothing is started then.
    tell(&mut rig, "propose-order 701 O1002 5 #521=38\norder accept 701 O1002 5 #521=38");
    rig.send(Command::ScreensLoaded(std::sync::Arc::default()));
    tell(&mut rig, "wait 0.1 s\norder start 701\nexpect message \"没有页面\"");
    assert_eq!(order(&mut rig, 701).state, OrderState::Waiting);
    assert_eq!(rig.snapshot().variables[521], Some(40.3));
}

/// B6: a restart that is prepared has the values of before: it does not bring them back.
#[test]
fn b6_values_of_an_order_outlive_a_prepared_restart() {
    let mut rig = shop();
    let text = b"G04 P100\nG04 P100\nM31\nM30".to_vec();
    rig.add_program(program_from_bytes(1_002, "O1002.NC", text, rig.kind().dialect()));
    tell(&mut rig, "load O1002\npropose-order 701 O1002 5 #521=38\norder accept 701 O1002 5 #521=38\nmode auto");
    rig.send(Command::RestartAt(2));
    tell(&mut rig, "wait 0.2 s\norder start 701\nkey cycle-start\nwait 2 s\nkey cycle-start\nwait until idle max 20 s");
    assert_eq!(rig.snapshot().variables[521], Some(38.0));
}

/// B6: what is measured, counted or of the wheel is no order's, on any page; nor is a value of a machine without pages.
#[test]
fn b6_no_order_sets_what_is_measured_counted_or_of_the_wheel() {
    let propose = |rig: &mut HeadlessHost, program: &str, values: &str| {
        tell(rig, &format!("propose-order 701 {program} 5 {values}\nwait 0.1 s"));
        let is_there = !rig.snapshot().production.orders.is_empty();
        tell(rig, "order delete 701");
        is_there
    };
    let mut rig = ready();
    for number in [1_004, 1_017, 1_019] {
        let name = format!("O{number}.NC");
        rig.add_program(program_from_bytes(number, &name, b"M30".to_vec(), rig.kind().dialect()));
    }
    // 实测孔径, 修整点 X 机床, 上一件实测直径, 累计修正尺寸.
    for (program, variable) in [("O1017", 895), ("O1017", 896), ("O1019", 930), ("O1019", 939)] {
        assert!(!propose(&mut rig, program, &format!("#{variable}=1")), "#{variable}");
    }
    // 成品直径 of O1019 is.
    assert!(propose(&mut rig, "O1019", "#920=30"), "{:?}", rig.snapshot().message);
    let mut vertical = ready_of(Kind::Vertical);
    vertical.add_program(program_from_bytes(1, "O0001.NC", b"M30".to_vec(), vertical.kind().dialect()));
    // R18 finished size; R3 wheel diameter, R62 error flag, R65 measured size.
    let orders = [18, 3, 62, 65].map(|r| propose(&mut vertical, "O1", &format!("R{r}=1")));
    assert_eq!(orders, [true, false, false, false]);
    let mut lathe = ready_of(Kind::Lathe);
    lathe.add_program(program_from_bytes(1_002, "O1002.NC", b"M30".to_vec(), lathe.kind().dialect()));
    assert!(!propose(&mut lathe, "O1002", "#521=38"));
}

/// B6: what cannot be an order is left aside, and the operator's own orders find a place.
#[test]
fn b6_orders_of_the_shop_are_limited() {
    let mut rig = shop();
    tell(
        &mut rig,
        "propose-order 0 O1002 5\npropose-order 1 O1999 5\npropose-order 2 O1002 0\npropose-order 3 O1002 1000000",
    );
    assert!(rig.snapshot().production.orders.is_empty());
    let proposals: Vec<String> = (1..=30).map(|number| format!("propose-order {number} O1002 5")).collect();
    tell(&mut rig, &proposals.join("\n"));
    assert_eq!(rig.snapshot().production.orders.len(), MAX_PROPOSALS);
    let own: Vec<String> = (101..=130).map(|number| format!("order {number} O1002 5")).collect();
    tell(&mut rig, &own.join("\n"));
    assert_eq!(rig.snapshot().production.orders.len(), MAX_ORDERS);
}
