//! The list of active alarms and their history.

use kt830::controller::{AlarmList, AlarmWords};
use kt830::defs::alarm;
use kt830::defs::alarm_history::{AlarmEnd, MAX_ALARM_HISTORY, PastAlarm};
use kt830::defs::date::DateTime;
use kt830::defs::history::HistoryEntry;
use kt830::defs::text::LocalizedText;
use kt830::host::folders::program_from_bytes;
use kt830::host::headless::HeadlessHost;
use kt830::units::{Axis, Micros};

/// The entries that the disk has to be told.
fn changed_of(alarms: &mut AlarmList) -> Vec<PastAlarm> {
    let mut changed = Vec::new();
    alarms.take_changed(|past| changed.push(past.clone()));
    changed
}

#[test]
fn b8_reset_leaves_alarms_whose_cause_is_still_there() {
    let mut alarms = AlarmList::new(Vec::new(), Micros::ZERO);
    alarms.raise(alarm::EMERGENCY_STOP, AlarmWords::OfTable, None);
    alarms.raise(alarm::TAILSTOCK_INTERLOCK, AlarmWords::OfTable, None);
    alarms.raise(alarm::TAILSTOCK_INTERLOCK, AlarmWords::OfTable, None);
    assert_eq!(alarms.present().len(), 2);
    alarms.reset(|number| number == alarm::EMERGENCY_STOP);
    assert!(alarms.has(alarm::EMERGENCY_STOP) && !alarms.has(alarm::TAILSTOCK_INTERLOCK) && alarms.blocks_start());
}

#[test]
fn b6_the_history_keeps_when_each_alarm_came_and_went_and_how() {
    let mut alarms = AlarmList::new(Vec::new(), Micros::ZERO);
    alarms.set_time(Micros(5), DateTime(105));
    alarms.raise(alarm::TAILSTOCK_INTERLOCK, AlarmWords::OfTable, Some((1_001, 7)));
    let shown = alarms.history().version();
    alarms.set_time(Micros(9), DateTime(109));
    alarms.clear(alarm::HYDRAULIC_PRESSURE);
    assert_eq!(alarms.history().version(), shown, "nothing went: the list is as before");
    alarms.reset(|_| false);
    alarms.set_time(Micros(12), DateTime(112));
    alarms.raise(alarm::TAILSTOCK_INTERLOCK, AlarmWords::OfTable, None);
    alarms.clear(alarm::TAILSTOCK_INTERLOCK);
    alarms.raise(alarm::TAILSTOCK_INTERLOCK, AlarmWords::OfTable, None);
    let times: Vec<_> = alarms.history().iter().map(|past| (past.came, past.ended)).collect();
    assert_eq!(times, [(DateTime(105), Some((AlarmEnd::Reset, Some(DateTime(109))))), (DateTime(112), None)]);
    assert_eq!(alarms.history()[0].place, Some((1_001, 7)));
    alarms.set_time(Micros(13), DateTime(113));
    alarms.clear(alarm::TAILSTOCK_INTERLOCK);
    assert_eq!(alarms.history()[1].ended, Some((AlarmEnd::Itself, Some(DateTime(113)))));
    let changed: Vec<_> = changed_of(&mut alarms).iter().map(|past| past.count).collect();
    assert_eq!(changed, [1, 2]);
    assert!(changed_of(&mut alarms).is_empty(), "the disk is told once");
}

#[test]
fn b6_what_came_before_the_clock_was_known_has_its_date() {
    let mut alarms = AlarmList::new(Vec::new(), Micros::ZERO);
    alarms.set_time(Micros(2_000_000), DateTime(2));
    alarms.raise(alarm::TAILSTOCK_INTERLOCK, AlarmWords::OfTable, None);
    alarms.clear(alarm::TAILSTOCK_INTERLOCK);
    let mut alarms = AlarmList::new(changed_of(&mut alarms), Micros::ZERO);
    alarms.set_time(Micros(3_000_000), DateTime(3));
    alarms.raise(alarm::HYDRAULIC_PRESSURE, AlarmWords::OfTable, None);
    alarms.set_power_on_date(DateTime(1_000));
    alarms.clear(alarm::HYDRAULIC_PRESSURE);
    let times: Vec<_> = alarms.history().iter().map(|past| (past.came.0, past.ended)).collect();
    // The alarm of the previous power cycle keeps its stamp: its date is unknown.
    assert_eq!(times[0], (2, Some((AlarmEnd::Itself, Some(DateTime(2))))));
    assert_eq!(times[1], (1_003, Some((AlarmEnd::Itself, Some(DateTime(1_003))))));
}

#[test]
fn b6_the_history_outlives_the_power_and_keeps_a_thousand() {
    let mut alarms = AlarmList::new(Vec::new(), Micros::ZERO);
    for round in 0..1_200 {
        alarms.set_time(Micros(20 + round), DateTime(round as i64));
        alarms.clear(alarm::HYDRAULIC_PRESSURE);
        alarms.raise(alarm::HYDRAULIC_PRESSURE, AlarmWords::OfTable, None);
        alarms.clear(alarm::HYDRAULIC_PRESSURE);
        alarms.set_time(Micros(20 + round) + Micros(1), DateTime(round as i64));
    }
    alarms.raise(alarm::TAILSTOCK_INTERLOCK, AlarmWords::OfTable, None);
    assert_eq!(alarms.history().len(), MAX_ALARM_HISTORY);
    let slots: std::collections::BTreeSet<_> = alarms.history().iter().map(|past| past.slot()).collect();
    assert_eq!(slots.len(), MAX_ALARM_HISTORY, "each has a place of its own in the store");
    let kept: Vec<_> = alarms.history().iter().cloned().collect();
    let mut alarms = AlarmList::new(kept, Micros::ZERO);
    let last = alarms.history()[MAX_ALARM_HISTORY - 1].clone();
    assert_eq!((last.number, last.ended), (alarm::TAILSTOCK_INTERLOCK, Some((AlarmEnd::PowerOff, None))));
    alarms.raise(alarm::TAILSTOCK_INTERLOCK, AlarmWords::OfTable, None);
    assert_eq!(alarms.history().last().map(|past| past.count), Some(last.count + 1));
}

#[test]
fn k3_7_alarm_180_is_not_reset_by_the_list() {
    let mut alarms = AlarmList::new(Vec::new(), Micros::ZERO);
    alarms.raise(alarm::HYDRAULIC_PRESSURE, AlarmWords::OfTable, None);
    alarms.reset(|_| false);
    assert!(alarms.has(alarm::HYDRAULIC_PRESSURE) && !alarms.blocks_start(), "180 bars the wheel only");
    alarms.clear(alarm::HYDRAULIC_PRESSURE);
    assert!(!alarms.blocks_start());
}

#[test]
fn k7_3_page_files_never_block_a_run() {
    let mut alarms = AlarmList::new(Vec::new(), Micros::ZERO);
    alarms.raise(alarm::PAGE_FILES_INVALID, Some(LocalizedText::new("B0002.BMP", "B0002.BMP")), None);
    assert!(!alarms.blocks_start());
    assert!(alarms.present()[0].text.zh().ends_with("B0002.BMP"));
}

#[test]
fn b6_two_alarms_cleared_and_raised_again_in_one_tick_stay_two_entries() {
    let mut alarms = AlarmList::new(Vec::new(), Micros::ZERO);
    alarms.set_time(Micros(1), DateTime(1));
    alarms.raise(alarm::TAILSTOCK_INTERLOCK, AlarmWords::OfTable, None);
    alarms.set_time(Micros(2), DateTime(2));
    alarms.raise(alarm::HYDRAULIC_PRESSURE, AlarmWords::OfTable, None);
    alarms.set_time(Micros(3), DateTime(3));
    alarms.reset(|_| false);
    alarms.raise(alarm::TAILSTOCK_INTERLOCK, AlarmWords::OfTable, None);
    alarms.raise(alarm::HYDRAULIC_PRESSURE, AlarmWords::OfTable, None);
    assert_eq!(alarms.history().iter().map(|past| past.ended).collect::<Vec<_>>(), [None, None]);
}

#[test]
fn b6_an_alarm_that_went_long_ago_is_not_opened_again_by_another_that_goes_now() {
    let mut alarms = AlarmList::new(Vec::new(), Micros::ZERO);
    alarms.set_time(Micros(1), DateTime(1));
    alarms.raise(alarm::HYDRAULIC_PRESSURE, AlarmWords::OfTable, None);
    alarms.raise(alarm::TAILSTOCK_INTERLOCK, AlarmWords::OfTable, None);
    alarms.clear(alarm::TAILSTOCK_INTERLOCK);
    alarms.set_time(Micros(9), DateTime(9));
    alarms.clear(alarm::HYDRAULIC_PRESSURE);
    alarms.raise(alarm::TAILSTOCK_INTERLOCK, AlarmWords::OfTable, None);
    let came: Vec<_> = alarms.history().iter().map(|past| (past.number, past.came.0, past.ended.is_some())).collect();
    let (pressure, tailstock) = (alarm::HYDRAULIC_PRESSURE, alarm::TAILSTOCK_INTERLOCK);
    assert_eq!(came, [(pressure, 1, true), (tailstock, 1, true), (tailstock, 9, false)]);
}

#[test]
fn b6_the_history_on_the_screen_follows_a_power_cut_even_if_nobody_looked_meanwhile() {
    let mut host = crate::stories::ready();
    crate::stories::tell(&mut host, "key emergency-stop\nwait 0.1 s\nexpect alarm 0");
    let before = host.snapshot().alarm_history.version();
    host.power_cut();
    host.power_on();
    (0..50).for_each(|_| host.step());
    let history = &host.snapshot().alarm_history;
    assert!(history.version() > before, "no version comes twice");
    assert_eq!(history[0].ended.map(|(how, _)| how), Some(AlarmEnd::PowerOff));
}

/// The text names place and mistake; what to do and who called it have their own lines (B8).
#[test]
fn b8_a_mistake_in_a_called_program_has_its_remedy_and_its_calls() {
    let mut rig = crate::stories::ready();
    for (number, text) in [(7_000, "G04X1\nM98P7001\nM30"), (7_001, "M98P7002\nM99"), (7_002, "#1=1/#2\nM99")] {
        let name = format!("O{number}.NC");
        rig.add_program(program_from_bytes(number, &name, text.into(), rig.kind().dialect()));
    }
    crate::stories::tell(&mut rig, "load O7000\nmode auto\nkey cycle-start\nwait until alarm max 5 s");
    let alarm = &rig.snapshot().alarms[0];
    assert_eq!(alarm.text.en(), "O7002 line 1, column 5: division by zero");
    assert_eq!(alarm.remedy.en(), "check the variable of the divisor");
    assert_eq!(alarm.cause.en(), "called by O7001 line 1 ← O7000 line 2");
    assert_eq!(alarm.cause.zh(), "由 O7001 第1行调用 ← O7000 第2行");
    // In the started program itself nobody has called it.
    crate::stories::tell(&mut rig, "key reset\nload O7002\nkey cycle-start\nwait until alarm max 5 s");
    let alarm = &rig.snapshot().alarms[0];
    assert!(alarm.cause.is_blank() && !alarm.remedy.is_blank(), "{alarm:?}");
}

/// An emergency stop takes the power from the drives, so that their ready contacts open.
#[test]
fn b8_drives_that_an_emergency_stop_leaves_without_power_are_no_fault() {
    let mut rig = crate::stories::ready();
    let numbers =
        |rig: &mut HeadlessHost| -> Vec<u16> { rig.snapshot().alarms.iter().map(|alarm| alarm.number).collect() };
    let stop = "input emergency-stop on\nwait 0.2 s\nfault drive-x\nwait 0.5 s";
    crate::stories::tell(&mut rig, stop);
    assert_eq!(numbers(&mut rig), [alarm::EMERGENCY_STOP]);
    // They come back a second after RESET.
    crate::stories::tell(
        &mut rig,
        "input emergency-stop off\nwait 0.2 s\nkey reset\nwait 1 s\nexpect no alarm\nfault drive-x off\nwait 0.5 s",
    );
    assert!(rig.trace_row().outputs.drives_on);
    assert!(numbers(&mut rig).is_empty() && rig.snapshot().axes[Axis::X].homed);
    // A drive that stays away is a fault once the stop is over.
    crate::stories::tell(&mut rig, stop);
    crate::stories::tell(&mut rig, "input emergency-stop off\nwait 0.2 s\nkey reset\nwait 2.5 s");
    assert_eq!(numbers(&mut rig), [alarm::DRIVE_FAULT]);
    assert!(!rig.trace_row().outputs.drives_on && !rig.snapshot().axes[Axis::X].homed);
}
