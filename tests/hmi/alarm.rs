//! The alarm page: a row that is touched tells cause, remedy and how it goes away, and help opens at it.
//! Source: spec B6 (报警), B8, H7.

use crate::live_screen::Bench;
use egui_kittest::kittest::Queryable;
use kt830::controller::PowerOnState;
use kt830::defs::alarm::{self, ALARMS, Alarm};
use kt830::defs::alarm_history::AlarmHistory;
use kt830::defs::page::Page;
use kt830::defs::program_error::ProgramError;
use kt830::defs::text::LocalizedText;
use kt830::link::page_command::KeptState;
use kt830::link::snapshot::AlarmView;
use kt830::link::{Command, Snapshot};

fn row(number: u16) -> &'static Alarm {
    ALARMS.iter().find(|row| row.number == number).unwrap()
}

/// A bench that shows a snapshot that nothing changes.
fn still(snapshot: Snapshot) -> Bench {
    let mut bench = Bench::new(crate::stories::rig(), Page::Alarm);
    bench.screen.state_mut().snapshot = snapshot;
    bench.screen.step();
    bench.screen.step();
    bench
}

fn touch(bench: &mut Bench, label: &str) {
    use egui_kittest::kittest::Queryable;
    bench.screen.get_by_label(label).click();
    bench.screen.step();
    bench.screen.step();
}

fn press(bench: &mut Bench, key: egui::Key) {
    bench.screen.key_press(key);
    bench.screen.step();
    bench.screen.step();
}

fn tells(bench: &Bench, alarm: &Alarm) -> bool {
    [alarm.cause, alarm.remedy, alarm.reset.name()].iter().all(|text| bench.shows(text.zh))
}

#[test]
fn b6_a_touched_row_of_the_history_tells_cause_remedy_and_reset_rule() {
    let mut bench = Bench::new(crate::stories::ready(), Page::Alarm);
    crate::stories::tell(
        &mut bench.rig,
        "key emergency-stop\nwait 0.1 s\nexpect alarm 0\nkey emergency-stop\nwait 0.1 s",
    );
    crate::stories::tell(&mut bench.rig, "key reset\nwait 0.1 s\nexpect no alarm");
    bench.turn();
    bench.touch("历史 1 alarm-history");
    assert!(!bench.shows(row(0).cause.zh), "nothing is chosen yet");
    bench.touch("000 急停 past-1");
    assert!(tells(&bench, row(0)));
    bench.touch("? help");
    assert!(bench.shows(row(0).reaction.name().zh), "help opens at the alarm that is chosen");
    bench.touch("关闭帮助 close-help");
    assert!(tells(&bench, row(0)), "the choice stays while help lies over it");
    bench.press(egui::Key::Escape);
    assert!(!bench.shows(row(0).cause.zh), "取消 closes it");
}

#[test]
fn b6_the_history_is_chosen_from_by_keyboard_too() {
    let mut bench = still(crate::sample::troubled(Page::Alarm));
    press(&mut bench, egui::Key::ArrowRight);
    press(&mut bench, egui::Key::Enter);
    assert!(tells(&bench, row(180)), "Enter: the latest, which stands on top");
    press(&mut bench, egui::Key::ArrowDown);
    assert!(tells(&bench, row(184)) && !bench.shows(row(180).cause.zh));
    (0..60).for_each(|_| press(&mut bench, egui::Key::ArrowDown));
    assert!(tells(&bench, row(102)), "the eldest, brought into sight");
    bench.screen.state_mut().snapshot.alarm_history = AlarmHistory::default();
    press(&mut bench, egui::Key::ArrowDown);
    assert!(bench.shows("没有报警记录"));
}

#[test]
fn b6_help_opens_at_the_chosen_one_of_the_present_alarms() {
    let mut bench = still(crate::sample::alarm(Page::Alarm));
    assert!(bench.shows(row(180).reset.name().zh), "the reset rule stands with every present alarm");
    touch(&mut bench, "066 页面文件不全或格式错误 alarm-66");
    touch(&mut bench, "? help");
    assert!(bench.shows(row(66).reaction.name().zh) && !bench.shows(row(180).reaction.name().zh));
    // Of those of a program, by their number; those of #3000 share one.
    let mut snapshot = crate::sample::alarm(Page::Alarm);
    snapshot.alarms[1].number = 3_007;
    snapshot.alarms[1].text = LocalizedText::new("尺寸", "size");
    let mut bench = still(snapshot);
    press(&mut bench, egui::Key::ArrowDown);
    press(&mut bench, egui::Key::ArrowDown);
    press(&mut bench, egui::Key::F12);
    assert!(bench.shows("3000–3999"), "the user's alarms");
}

#[test]
fn b8_a_program_alarm_of_the_history_has_its_remedy() {
    let error = ProgramError::UnexpectedCharacter;
    let mut snapshot = crate::sample::troubled(Page::Alarm);
    let last = snapshot.alarm_history.entries_mut().last_mut().unwrap();
    (last.number, last.text) = (error.number(), LocalizedText::new("此处不应出现 '?'", "unexpected '?'"));
    let mut bench = still(snapshot);
    press(&mut bench, egui::Key::ArrowRight);
    press(&mut bench, egui::Key::Enter);
    assert!(bench.shows(error.remedy().zh));
}

/// Texts of the screen with their colours.
fn coloured(bench: &Bench) -> Vec<(String, egui::Color32)> {
    let texts = bench.screen.output().shapes.iter().filter_map(|clipped| match &clipped.shape {
        egui::Shape::Text(text) => Some(text),
        _ => None,
    });
    let colour = |text: &egui::epaint::TextShape| Some(text.galley.job.sections.first()?.format.color);
    texts.filter_map(|text| Some((text.galley.job.text.clone(), colour(text)?))).collect()
}

#[test]
fn h7_an_alarm_has_one_severity_in_chip_line_and_page() {
    use kt830::hmi::theme::DARK;
    let mut bench = Bench::new(crate::stories::story("wait 3.1 s\nexpect alarm 180"), Page::Alarm);
    let texts = coloured(&bench);
    let of = |words: &str| -> Vec<egui::Color32> {
        texts.iter().filter(|(text, _)| text.contains(words)).map(|(_, ink)| *ink).collect()
    };
    // Raised a moment ago: the message line is red at once, with the remedy, not amber as a refusal.
    assert_eq!(of("180 没有液压压力 → 打开液压"), [DARK.alarm_text], "{texts:?}");
    assert_eq!(of("⚠ 180"), [DARK.on_accent]);
    // A refusal is still amber, then the alarm comes back.
    crate::stories::tell(&mut bench.rig, "key wheel-start");
    bench.turn();
    let texts = coloured(&bench);
    assert!(texts.iter().any(|(text, ink)| text.contains("砂轮不能启动") && *ink == DARK.hold), "{texts:?}");
}

/// Alarm 300 stands until the builder accepts the data.
#[test]
fn b6_lost_data_are_accepted_on_the_alarm_page_with_the_password_of_the_builder() {
    let mut bench = Bench::new(crate::stories::rig(), Page::Alarm);
    let is_offered = |bench: &Bench| bench.screen.query_by_label_contains("accept-data").is_some();
    assert!(!is_offered(&bench));
    bench.rig.report_standing(alarm::RETAINED_DATA_DAMAGED, &LocalizedText::same(&"用出厂值"));
    bench.turn();
    assert!(is_offered(&bench) && bench.shows("保存数据损坏或丢失"));
    bench.touch("接受数据 accept-data");
    bench.press(egui::Key::Escape);
    assert!(!bench.shows("用哪份数据") && !bench.asks_password(), "cancelled");
    bench.touch("接受数据 accept-data");
    bench.touch("现在的数据 data-present");
    bench.press(egui::Key::Escape);
    assert!(is_offered(&bench) && !bench.asks_password(), "cancelled");
    bench.touch("接受数据 accept-data");
    bench.touch("现在的数据 data-present");
    bench.touch("接受 accept-yes");
    assert!(bench.asks_password());
    bench.write("123456");
    bench.press(egui::Key::Enter);
    assert!(bench.asks_password() && is_offered(&bench), "the user's password accepts nothing");
    bench.press(egui::Key::Escape);
    bench.touch("接受数据 accept-data");
    bench.touch("现在的数据 data-present");
    bench.touch("接受 accept-yes");
    bench.write("830830");
    bench.press(egui::Key::Enter);
    assert!(!is_offered(&bench) && !bench.shows("保存数据损坏或丢失"));
    crate::stories::tell(&mut bench.rig, "power cut\npower on\nwait 0.1 s");
    assert!(bench.rig.snapshot().alarms.iter().all(|alarm| alarm.number != alarm::RETAINED_DATA_DAMAGED));
}

/// In place of the data in force an earlier state, or factory values, can be chosen; they come with the next start.
#[test]
fn b6_after_a_loss_an_earlier_state_is_chosen_on_the_alarm_page() {
    let mut bench = Bench::new(crate::stories::rig(), Page::Alarm);
    let states = [(7, "2026-11-25 18:02"), (5, "2026-11-24 18:00")]
        .map(|(number, time)| KeptState { number, time: time.into() });
    let retained = PowerOnState { kept_states: states.to_vec().into(), ..bench.rig.retained().clone() };
    let what = LocalizedText::same(&"用出厂值");
    bench.rig.power_on_with(retained, vec![(alarm::RETAINED_DATA_DAMAGED, what)]);
    bench.rig.send(Command::OpenPage(Page::Alarm));
    bench.turn();
    for (choice, told) in
        [("2026-11-24 18:00 data-kept-5", "2026-11-24 18:00 的数据"), ("出厂值 data-factory", "下次启动用出厂值")]
    {
        bench.touch("接受数据 accept-data");
        bench.touch(choice);
        bench.touch("更换 accept-yes");
        if bench.asks_password() {
            bench.write("830830");
            bench.press(egui::Key::Enter);
        }
        assert!(bench.shows(told), "{choice}");
        let stands = |bench: &mut Bench| {
            bench.rig.snapshot().alarms.iter().any(|alarm| alarm.number == alarm::RETAINED_DATA_DAMAGED)
        };
        assert!(stands(&mut bench), "nothing runs before the next start");
        crate::stories::tell(&mut bench.rig, "key reset\nwait 0.1 s");
        assert!(stands(&mut bench));
    }
    // The data in force can still be accepted.
    bench.touch("接受数据 accept-data");
    bench.touch("现在的数据 data-present");
    bench.touch("接受 accept-yes");
    assert!(!bench.shows("保存数据损坏或丢失"));
}

#[test]
fn b8_lost_data_are_told_before_a_missing_pressure_and_after_what_stops_everything() {
    let mut snapshot = Snapshot::new(kt830::defs::kind::Kind::Gc);
    for number in [180, 300] {
        let row = row(number);
        let (text, cause, remedy) = (row.text.into(), row.cause.into(), row.remedy.into());
        let since = kt830::units::Micros::ZERO;
        snapshot.alarms.push(AlarmView { number, text, cause, remedy, variable: None, since, place: None });
    }
    let bench = still(snapshot);
    assert!(bench.shows("⚠ 300 ×2"), "the chip");
    assert!(bench.painted().iter().any(|text| text.starts_with("300 ") && text.contains(" → ")), "the message line");
    let shown = |numbers: &[u16]| alarm::leading(numbers, |number| *number).copied();
    assert_eq!(shown(&[]), None);
    assert_eq!(shown(&[180, 300]), Some(300));
    assert_eq!(shown(&[180, 300, 102]), Some(102));
    assert_eq!(shown(&[180, 192]), Some(180));
}
