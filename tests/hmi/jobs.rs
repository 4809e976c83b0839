//! The production page: orders are entered, started, closed, deleted; what was made, and its report.
//! Source: spec B6, H8, H9.

use std::fs;

use egui_kittest::kittest::Queryable;
use kt830::defs::alarm_history::{AlarmEnd, AlarmHistory, PastAlarm};
use kt830::defs::date::DateTime;
use kt830::defs::downtime_reason::DowntimeReason;
use kt830::defs::page::Page;
use kt830::defs::production_order::OrderState;
use kt830::defs::text::LocalizedText;
use kt830::host::folders::program_from_bytes;
use kt830::link::Command;
use kt830::link::files::FileRequest;
use kt830::link::page_command::PageCommand;

use crate::live_screen::Bench;
use crate::sample::busy;
use crate::screen::{Screen, open, painted};
use crate::stories::{ready, tell};

/// O1002 ends a part at once: Ø40.3, +0.01 −0.01.
fn bench() -> Bench {
    let mut rig = ready();
    let text = b"G04 P100\nM31\nM30".to_vec();
    rig.add_program(program_from_bytes(1_002, "O1002.NC", text, rig.kind().dialect()));
    tell(&mut rig, "load O1002\npart assets/parts/O1002.ron\nset #521 = 40.3\nset #532 = 0.01\nset #533 = -0.01");
    Bench::new(rig, Page::Jobs)
}

fn make(bench: &mut Bench, parts: u32) {
    for _ in 0..parts {
        tell(&mut bench.rig, "mode auto\nkey cycle-start\nwait until idle max 20 s\nexpect no alarm\nwait 0.1 s");
    }
    bench.turn();
}

/// Number, program and parts one after the other, each with INPUT; then the key ENTER.
fn enter(bench: &mut Bench, number: &str, parts: &str) {
    bench.screen.query_all_by_label("job field 1").next().expect("the field").click();
    bench.turn();
    for word in [number, "1002", parts] {
        bench.write(word);
        bench.press(egui::Key::Enter);
    }
    bench.touch("存入 job-enter");
}

#[test]
fn b6_an_order_is_typed_started_made_and_closed() {
    let mut bench = bench();
    assert!(bench.shows("还没有订单"));
    enter(&mut bench, "501", "2");
    assert!(bench.shows("501") && bench.shows("0 / 2") && bench.shows("等待"), "{:?}", bench.painted());
    bench.touch("开始 job-start");
    assert!(bench.shows("进行"), "{:?}", bench.painted());
    make(&mut bench, 2);
    assert!(bench.shows("2 / 2") && bench.message().contains("完成"), "{:?}", bench.painted());
    bench.touch("结束 job-close");
    assert_eq!(bench.rig.snapshot().production.orders[0].state, OrderState::Closed);
    assert!(bench.shows("结束"));
}

#[test]
fn b6_an_order_of_the_shop_is_accepted_then_started() {
    let mut bench = bench();
    tell(&mut bench.rig, "propose-order 701 O1002 5");
    bench.turn();
    assert!(bench.shows("701") && bench.shows("待接受"), "{:?}", bench.painted());
    bench.screen.query_all_by_label("order 701").next().expect("the order").click();
    bench.turn();
    bench.touch("开始 job-start");
    assert!(bench.message().contains("先接受"), "{}", bench.message());
    bench.touch("接受 job-accept");
    assert!(bench.shows("等待") && bench.message().contains("已接受"), "{:?}", bench.painted());
    bench.touch("开始 job-start");
    assert!(bench.shows("进行"), "{:?}", bench.painted());
}

/// B6: what the order asks for stands beside what the page has; nothing of it is taken without being asked.
#[test]
fn b6_values_of_an_order_are_shown_and_taken_when_it_is_started() {
    let mut bench = bench();
    tell(&mut bench.rig, "propose-order 701 O1002 5 #521=38.02 #532=0.01");
    bench.turn();
    bench.screen.query_all_by_label("order 701").next().expect("the order").click();
    bench.turn();
    assert!(bench.shows("40.300 → 38.020") && bench.shows("成品直径"), "{:?}", bench.painted());
    bench.touch("开始 job-start");
    assert!(bench.message().contains("先接受"), "{}", bench.message());
    bench.touch("接受 job-accept");
    bench.touch("开始 job-start");
    assert!(bench.shows("采用订单的数值"), "{:?}", bench.painted());
    // What the page has already is not asked for.
    assert!(bench.shows("#521 成品直径: 40.300 → 38.020") && !bench.shows("上偏差: "), "{:?}", bench.painted());
    bench.touch("取消 question-no");
    assert_eq!(bench.rig.snapshot().production.orders[0].state, OrderState::Waiting);
    bench.touch("开始 job-start");
    bench.touch("保留现值 question-keep");
    let state = |bench: &mut Bench| bench.rig.snapshot().production.orders[0].state;
    assert_eq!((state(&mut bench), bench.rig.snapshot().variables[521]), (OrderState::Active, Some(40.3)));
    bench.touch("开始 job-start");
    bench.touch("采用 question-take");
    assert_eq!(bench.rig.snapshot().variables[521], Some(38.02));
    bench.touch("开始 job-start");
    assert!(!bench.shows("采用订单的数值"), "the page has them");
}

/// Who has just dressed the wheel wants no order of dressings.
#[test]
fn b6_the_form_proposes_the_loaded_program_unless_it_dresses() {
    let mut bench = bench();
    assert!(bench.shows("O1002"), "{:?}", bench.painted());
    bench.rig.add_program(program_from_bytes(1_011, "O1011.NC", b"M30".to_vec(), bench.rig.kind().dialect()));
    tell(&mut bench.rig, "load O1011\npage jobs");
    bench.turn();
    let form = bench.painted().into_iter().filter(|text| text == "O1002" || text == "O1011").count();
    assert_eq!(form, 0, "{:?}", bench.painted());
    bench.screen.query_all_by_label("job field 1").next().expect("the field").click();
    bench.turn();
    bench.write("501");
    bench.press(egui::Key::Enter);
    bench.touch("存入 job-enter");
    assert!(bench.shows("先键入程序"), "{:?}", bench.painted());
}

#[test]
fn b6_a_missing_figure_and_a_wrong_one_are_told_and_nothing_is_entered() {
    let mut bench = bench();
    bench.touch("存入 job-enter");
    assert!(bench.shows("先键入订单号"), "{:?}", bench.painted());
    bench.touch("开始 job-start");
    assert!(bench.shows("先选一个订单"), "{:?}", bench.painted());
    bench.screen.query_all_by_label("job field 3").next().expect("the field").click();
    bench.turn();
    bench.write("0");
    bench.press(egui::Key::Enter);
    assert!(bench.shows("应为 1–999999"), "{:?}", bench.painted());
    assert!(bench.rig.snapshot().production.orders.is_empty());
    // What the core refuses is told, too.
    tell(&mut bench.rig, "order 501 O1002 2");
    bench.turn();
    bench.screen.get_by_label("order 501").click();
    bench.turn();
    bench.screen.query_all_by_label("job field 2").next().expect("the field").click();
    bench.turn();
    bench.write("4711");
    bench.press(egui::Key::Enter);
    bench.touch("存入 job-enter");
    assert!(bench.message().contains("没有这个程序"), "{}", bench.message());
    assert_eq!(bench.rig.snapshot().production.orders[0].program, 1_002);
}

/// The last figure needs no INPUT before ENTER is touched; one that is out of range enters nothing.
#[test]
fn b6_a_figure_that_is_being_typed_counts_when_enter_is_touched() {
    let mut bench = bench();
    for word in ["501", "1002"] {
        bench.write(word);
        bench.press(egui::Key::Enter);
    }
    bench.write("0");
    bench.touch("存入 job-enter");
    assert!(bench.shows("应为 1–999999") && bench.rig.snapshot().production.orders.is_empty(), "{:?}", bench.painted());
    bench.press(egui::Key::Escape);
    bench.write("7");
    bench.touch("存入 job-enter");
    assert_eq!(bench.rig.snapshot().production.orders[0].target, 7);
}

#[test]
fn h8_an_order_is_deleted_only_when_asked() {
    let mut bench = bench();
    tell(&mut bench.rig, "order 501 O1002 2\norder 502 O1002 3");
    bench.turn();
    bench.touch("order 502");
    bench.touch("删除 job-delete");
    assert!(bench.shows("删除订单？"));
    bench.touch("取消 question-no");
    assert_eq!(bench.rig.snapshot().production.orders.len(), 2);
    bench.touch("删除 job-delete");
    bench.touch("删除 question-delete");
    assert_eq!(bench.rig.snapshot().production.orders.iter().map(|order| order.number).collect::<Vec<_>>(), [501]);
}

#[test]
fn b6_the_keyboard_alone_enters_and_starts_an_order() {
    let mut bench = bench();
    for word in ["77", "1002", "9"] {
        bench.write(word);
        bench.press(egui::Key::Enter);
    }
    // The cursor is on ENTER now; START is the next key.
    bench.press(egui::Key::Enter);
    bench.press(egui::Key::ArrowRight);
    bench.press(egui::Key::Enter);
    let order = bench.rig.snapshot().production.orders[0];
    assert_eq!((order.number, order.program, order.target, order.state), (77, 1_002, 9, OrderState::Active));
}

/// What is typed is not what would be started.
#[test]
fn b6_typed_figures_are_entered_before_an_order_starts() {
    let mut bench = bench();
    tell(&mut bench.rig, "order 501 O1002 2");
    bench.turn();
    bench.touch("order 501");
    bench.screen.query_all_by_label("job field 3").next().expect("the field").click();
    bench.turn();
    bench.write("7");
    bench.touch("开始 job-start");
    assert!(bench.shows("键入的数值还没有存入"), "{:?}", bench.painted());
    assert_eq!(bench.rig.snapshot().production.orders[0].state, OrderState::Waiting);
    bench.touch("存入 job-enter");
    bench.touch("开始 job-start");
    let order = bench.rig.snapshot().production.orders[0];
    assert_eq!((order.state, order.target), (OrderState::Active, 7));
}

#[test]
fn h9_the_report_has_the_figures_the_chart_and_every_part() {
    let folder = tempfile::tempdir().unwrap();
    let mut bench = bench();
    bench.rig.set_drives(Some(folder.path().to_owned()), None);
    tell(&mut bench.rig, "order 501 O1002 9\norder start 501");
    make(&mut bench, 6);
    bench.touch("order 501");
    assert!(bench.shows("6 / 9") && bench.shows("40.300 +0.010 -0.010"), "{:?}", bench.painted());
    let mean = |bench: &Bench| {
        let texts = bench.painted();
        texts[texts.iter().position(|text| text == "平均尺寸 mm").expect("the line") - 1].clone()
    };
    assert!(mean(&bench).starts_with("40.3"), "{:?}", bench.painted());
    // A part of another nominal size is no part of the same statistics.
    tell(&mut bench.rig, "set #521 = 40.2");
    make(&mut bench, 1);
    assert_eq!(mean(&bench), "–", "{:?}", bench.painted());
    bench.touch("报告 job-report");
    assert!(bench.message().contains("已保存"), "{}", bench.message());
    let file = fs::read_dir(folder.path()).unwrap().next().expect("a file").unwrap().path();
    assert_eq!(file.extension().unwrap(), "HTML");
    let text = fs::read_to_string(file).unwrap();
    assert_eq!(text.matches("<circle").count(), 6, "a point for each good part");
    assert_eq!((text.matches("<rect").count(), text.matches("class=\"bad\"").count()), (1, 1));
    // Head of the summary and of the parts, twelve and seven cells.
    assert_eq!(text.matches("<th>").count(), 12 + 7);
    for words in ["订单 501", "6 / 9", "超差", "O1002", "</html>"] {
        assert!(text.contains(words), "{words}: {text}");
    }
}

/// The sample is on from 5 to 15 o'clock. From 6 to 13 o'clock: six hours of 3000 s running and 240 s waiting, one of 1900 s
/// and 1200 s of alarm, one of 600 s and 2400 s waiting: 20 500 s of 28 800 s running.
#[test]
fn b6_the_day_of_the_machine_is_summed_by_shift() {
    let mut screen = open(busy(Page::Jobs));
    let touch = |screen: &mut Screen, label: &str| {
        screen.get_by_label(label).click();
        screen.step();
        screen.step();
    };
    touch(&mut screen, "班次 jobs-shifts");
    let texts = painted(&screen);
    for words in ["1  06–14", "2  14–22", "3  22–06", "8.0", "5.7", "1.1", "0.3", "71.2 %", "99.6 %", "280 / 1", "全天"]
    {
        assert!(texts.iter().any(|text| text == words), "{words}: {texts:?}");
    }
    touch(&mut screen, "存为 CSV day-save");
    let sent = std::mem::take(&mut screen.state_mut().sent);
    let table = sent.into_iter().find_map(|command| match command {
        Command::Page(PageCommand::File(_, FileRequest::SaveTable(text))) => Some(text),
        _ => None,
    });
    let table = table.expect("a table");
    assert_eq!(table.lines().count(), 1 + 11, "{table}");
    assert!(table.contains(" 09:00:00,1900,0,1200,500,35,1,0,0,0,0,0,0\r\n"), "{table}");
    assert!(table.contains(" 12:00:00,600,2400,0,600,35,0,1800,0,0,0,300,0\r\n"), "{table}");
    // The day before has nothing.
    touch(&mut screen, "前一天 day-before");
    assert!(!painted(&screen).iter().any(|text| text == "280 / 1"));
    touch(&mut screen, "后一天 day-after");
    touch(&mut screen, "后一天 day-after");
    assert!(painted(&screen).iter().any(|text| text == "280 / 1"), "there is no day after today");
}

/// From 12 to 13 o'clock the machine stood for 3 000 s: no parts for 1 800 s, repair for 300 s. Standing in the day,
/// from 6 o'clock on: 1 700 s, 3 000 s and eight times 600 s, 9 500 s; 2 100 s have a reason, 7 400 s have none.
#[test]
fn b6_the_operator_says_why_the_machine_stands() {
    let mut screen = open(busy(Page::Jobs));
    let touch = |screen: &mut Screen, label: &str| {
        screen.get_by_label(label).click();
        (0..2).for_each(|_| screen.step());
    };
    touch(&mut screen, "班次 jobs-shifts");
    assert!(painted(&screen).iter().any(|text| text == "停机原因 min · 未说明 123"), "{:?}", painted(&screen));
    let given = |screen: &mut Screen| {
        let sent = std::mem::take(&mut screen.state_mut().sent);
        sent.into_iter().find_map(|command| match command {
            Command::Page(PageCommand::SetDowntimeReason(reason)) => Some(reason),
            _ => None,
        })
    };
    touch(&mut screen, "缺料 30 downtime-no-parts");
    assert_eq!(given(&mut screen), Some(Some(DowntimeReason::NoParts)));
    // The reason that holds is lit; a touch of it takes it back.
    screen.state_mut().snapshot.production.downtime_reason = Some(DowntimeReason::Repair);
    screen.step();
    touch(&mut screen, "维修 5 downtime-repair");
    assert_eq!(given(&mut screen), Some(None));
    touch(&mut screen, "休息 downtime-break");
    assert_eq!(given(&mut screen), Some(Some(DowntimeReason::Break)));
    // A reason is given for now: the keys of the day before only show.
    touch(&mut screen, "前一天 day-before");
    assert!(!painted(&screen).iter().any(|text| text == "缺料 30"), "{:?}", painted(&screen));
    touch(&mut screen, "缺料 downtime-no-parts");
    assert_eq!(given(&mut screen), None);
}

/// An alarm that stood from 9:00 to 9:20, twice another one for a minute each, one of the day before.
#[test]
fn b6_the_alarms_that_stood_longest_come_first() {
    let mut machine = busy(Page::Jobs);
    let midnight = machine.production.hours[0].hour as i64 / 24 * 86_400;
    let alarm = |count: u64, number: u16, from: i64, to: i64| PastAlarm {
        count,
        number,
        text: LocalizedText::new(format!("报警 {number}"), format!("alarm {number}")),
        cause: Default::default(),
        remedy: Default::default(),
        place: None,
        came: DateTime(midnight + from),
        ended: Some((AlarmEnd::Reset, Some(DateTime(midnight + to)))),
    };
    let all = [
        alarm(1, 104, -7_200, -3_600),
        alarm(2, 180, 28_800, 28_860),
        alarm(3, 103, 32_400, 33_600),
        alarm(4, 180, 36_000, 36_060),
    ];
    machine.alarm_history = AlarmHistory::new(all, 9);
    let mut screen = open(machine);
    screen.get_by_label("班次 jobs-shifts").click();
    screen.step();
    screen.step();
    let texts = painted(&screen);
    let place = |words: &str| texts.iter().position(|text| text == words);
    assert!(place("报警 103") < place("报警 180") && place("报警 104").is_none(), "{texts:?}");
    assert!(place("1×  20 min").is_some() && place("2×  2 min").is_some(), "{texts:?}");
}
