//! The pages of diagnosis, alarms, parameters and settings with the real core and its simulated machine behind them.

use std::path::Path;
use std::sync::Arc;

use crate::live_screen::Bench;
use egui_kittest::kittest::Queryable;
use kt830::controller::PowerOnState;
use kt830::defs::alarm_history::AlarmEnd;
use kt830::defs::date::DateTime;
use kt830::defs::key::{Key, KeyGroup};
use kt830::defs::kind::Kind;
use kt830::defs::page::Page;
use kt830::defs::param::{AccessLevel, ParamAddress, Params};
use kt830::defs::text::Lang;
use kt830::hmi::page_text;
use kt830::host::headless::{HeadlessHost, HostSetup};
use kt830::host::retained_store::RetainedStore;
use kt830::link::Command;
use kt830::link::page_command::{PageCommand, PasswordScope, Secret};
use kt830::store::{StoredLang, StoredSettings};

/// A rig whose data stay in a folder.
pub fn kept(folder: &Path, kind: Kind) -> HeadlessHost {
    let (store, found) = RetainedStore::open(folder, kind).unwrap();
    let setup =
        HostSetup { kind, retained: found.retained, store: Some(store), folders: crate::stories::folders(), seed: 1 };
    HeadlessHost::new(setup).unwrap()
}

fn of_kind(kind: Kind) -> HeadlessHost {
    let setup = HostSetup {
        kind,
        retained: PowerOnState::factory(kind),
        store: None,
        folders: crate::stories::folders(),
        seed: 1,
    };
    HeadlessHost::new(setup).unwrap()
}

#[test]
fn b6_a_builder_parameter_asks_for_its_password_once() {
    let mut bench = Bench::new(crate::stories::rig(), Page::Params);
    bench.set("P270", "2500");
    assert!(bench.asks_password() && bench.param("P270").to_bits() == 3_000.0_f64.to_bits());
    bench.write("111111");
    bench.press(egui::Key::Enter);
    assert!(bench.asks_password(), "a wrong password changes nothing");
    assert_eq!(bench.message(), "密码错误");
    bench.write("830830");
    bench.press(egui::Key::Enter);
    assert!(!bench.asks_password());
    assert_eq!(bench.param("P270").to_bits(), 2_500.0_f64.to_bits());
    bench.set("P48", "2000");
    assert!(!bench.asks_password() && bench.param("P48").to_bits() == 2_000.0_f64.to_bits());
    // Locked again by its key, and by the power.
    bench.touch("机床厂 锁定 param-level");
    bench.set("P48", "1000");
    assert!(bench.asks_password());
    bench.press(egui::Key::Escape);
    assert_eq!(bench.param("P48").to_bits(), 2_000.0_f64.to_bits());
    bench.rig.send(Command::Page(PageCommand::Unlock(PasswordScope::Builder, Secret::new("830830".into()))));
    bench.turn();
    assert_eq!(bench.rig.snapshot().access.level, AccessLevel::Builder);
    bench.rig.power_cut();
    bench.rig.power_on();
    assert_eq!(bench.rig.snapshot().access.level, AccessLevel::Operator);
}

#[test]
fn b6_an_operators_parameter_asks_for_none_and_a_user_cannot_change_the_builders() {
    let mut bench = Bench::new(crate::stories::rig(), Page::Params);
    bench.set("P71", "50");
    assert!(!bench.asks_password() && bench.param("P71").to_bits() == 50.0_f64.to_bits());
    bench.set("P56", "900");
    bench.write("123456");
    bench.press(egui::Key::Enter);
    assert_eq!(bench.param("P56").to_bits(), 900.0_f64.to_bits());
    bench.set("P30", "100");
    assert!(bench.asks_password(), "the user's password does not open the builder's parameters");
    // The core says no by itself, whatever a page asks.
    bench.rig.send(Command::Page(PageCommand::EditParam(ParamAddress::parse("P30").unwrap(), 100.0)));
    bench.turn();
    assert_eq!(bench.param("P30").to_bits(), 6_000.0_f64.to_bits());
    assert_eq!(bench.message(), "需要机床厂参数密码");
}

#[test]
fn h6_a_value_out_of_range_stays_in_red_and_the_old_one_in_force() {
    let mut bench = Bench::new(crate::stories::rig(), Page::Params);
    bench.set("P71", "1000000");
    assert_eq!(bench.param("P71").to_bits(), 0.0_f64.to_bits());
    let reason = |bench: &Bench| bench.screen.state().hmi.refusal(Lang::Zh).map(|(_, why)| why);
    assert_eq!(reason(&bench).as_deref(), Some("超出范围 0 … 999999"));
    bench.write("7");
    assert_eq!(reason(&bench), None, "until the next key");
    bench.press(egui::Key::Enter);
    assert_eq!(bench.param("P71").to_bits(), 7.0_f64.to_bits());
    bench.set("P16.2", "2");
    assert_eq!(reason(&bench).as_deref(), Some("只能输入 0 或 1"));
    bench.set("P300", "1.5");
    assert_eq!(reason(&bench).as_deref(), Some("只能输入整数"));
}

#[test]
fn b6_by_touch_a_parameter_is_found_and_typed() {
    let mut bench = Bench::new(crate::stories::rig(), Page::Params);
    bench.touch("数值 params-numbers");
    bench.touch("查找 search");
    for sign in ["7", "1"] {
        bench.touch(&format!("{sign} letter-{sign}"));
    }
    bench.touch("完成 letter-done");
    bench.touch("P71");
    for pad in ["pad-4", "pad-2", "输入 input"] {
        bench.touch(pad);
    }
    assert_eq!(bench.param("P71").to_bits(), 42.0_f64.to_bits());
    assert!(bench.screen.query_by_label("P70").is_none(), "only what was searched is listed");
    bench.touch("× search-clear");
    assert!(bench.screen.query_by_label("P70").is_some());
}

#[test]
fn b6_parameters_are_not_changed_in_a_run() {
    let mut rig = crate::stories::ready_with("G04 P5000\nM30");
    crate::stories::tell(&mut rig, "mode auto\nkey cycle-start\nwait 0.1 s\nexpect state running");
    let mut bench = Bench::new(rig, Page::Params);
    bench.set("P71", "9");
    assert_eq!(bench.param("P71").to_bits(), 0.0_f64.to_bits());
    assert!(bench.message().contains("运行中"), "{}", bench.message());
    // H6: what the core refuses stays in red.
    let (text, reason) = bench.screen.state().hmi.refusal(Lang::Zh).unwrap();
    assert!(text == "9" && reason.contains("运行中"), "{text}: {reason}");
}

/// Asks with the user's password: the level that is open then, and the message.
fn ask_user_password(rig: &mut HeadlessHost, text: &str) -> (AccessLevel, String) {
    rig.send(Command::Page(PageCommand::Unlock(PasswordScope::User, Secret::new(text.into()))));
    (0..3).for_each(|_| rig.step());
    (rig.snapshot().access.level, rig.snapshot().message.text.zh().into_owned())
}

#[test]
fn b6_three_wrong_passwords_bring_a_pause() {
    let mut rig = crate::stories::rig();
    for _ in 0..3 {
        assert_eq!(ask_user_password(&mut rig, "000000"), (AccessLevel::Operator, "密码错误".into()));
    }
    let paused = (AccessLevel::Operator, "密码错误次数过多，30 秒后再试".to_owned());
    assert_eq!(ask_user_password(&mut rig, "123456"), paused);
    crate::stories::tell(&mut rig, "wait 31 s");
    assert_eq!(ask_user_password(&mut rig, "123456").0, AccessLevel::User);
}

#[test]
fn b6_a_restart_saves_no_pause_after_wrong_passwords() {
    let folder = tempfile::tempdir().unwrap();
    let paused = (AccessLevel::Operator, "密码错误次数过多，30 秒后再试".to_owned());
    {
        let mut rig = kept(folder.path(), Kind::Gc);
        assert_eq!(ask_user_password(&mut rig, "000000").1, "密码错误");
        assert_eq!(ask_user_password(&mut rig, "123456").0, AccessLevel::User, "a right one begins anew");
        for _ in 0..3 {
            ask_user_password(&mut rig, "000000");
        }
    }
    let mut rig = kept(folder.path(), Kind::Gc);
    assert_eq!(ask_user_password(&mut rig, "123456"), paused);
    crate::stories::tell(&mut rig, "wait 31 s");
    assert_eq!(ask_user_password(&mut rig, "123456").0, AccessLevel::User);
    drop(rig);
    let mut rig = kept(folder.path(), Kind::Gc);
    assert_eq!(ask_user_password(&mut rig, "123456").0, AccessLevel::User, "the right one ended it");
}

#[test]
fn b6_a_password_is_changed_at_the_panel_and_kept_hashed() {
    let folder = tempfile::tempdir().unwrap();
    {
        let mut bench = Bench::new(kept(folder.path(), Kind::Gc), Page::Settings);
        bench.touch("用户参数 change-user");
        for text in ["123456", "77665544", "77665544"] {
            bench.write(text);
            bench.press(egui::Key::Enter);
        }
        assert!(!bench.asks_password());
        assert_eq!(bench.message(), "用户参数密码已修改");
    }
    let bytes = std::fs::read(folder.path().join("retained.redb")).unwrap();
    let holds = |word: &[u8]| bytes.windows(word.len()).any(|window| window == word);
    assert!(holds(b"$argon2id$") && !holds(b"77665544"));
    let mut bench = Bench::new(kept(folder.path(), Kind::Gc), Page::Settings);
    for (text, level) in [("123456", AccessLevel::Operator), ("77665544", AccessLevel::User)] {
        bench.rig.send(Command::Page(PageCommand::Unlock(PasswordScope::User, Secret::new(text.into()))));
        bench.turn();
        assert_eq!(bench.rig.snapshot().access.level, level, "{text}");
    }
}

#[test]
fn b6_a_new_password_is_typed_twice_alike_and_the_old_one_must_fit() {
    let mut bench = Bench::new(crate::stories::rig(), Page::Settings);
    bench.touch("机床厂 change-builder");
    for text in ["830830", "123", "4711471", "4711472", "4711471", "4711471"] {
        bench.write(text);
        bench.press(egui::Key::Enter);
    }
    assert!(!bench.asks_password(), "too short, unlike, then taken");
    assert_eq!(bench.message(), "机床厂参数密码已修改");
    bench.touch("机床厂 change-builder");
    for text in ["830830", "5555", "5555"] {
        bench.write(text);
        bench.press(egui::Key::Enter);
    }
    assert!(bench.asks_password(), "the old password no longer fits");
    assert_eq!(bench.message(), "密码错误");
}

#[test]
fn b6_the_settings_are_reached_by_keyboard() {
    let mut bench = Bench::new(crate::stories::rig(), Page::Settings);
    // Six fields of the clock, languages, colours, brightness, sizes, switches, kinds, levels: the second behind the clock is
    // English.
    for _ in 0..6 + 2 {
        bench.press(egui::Key::ArrowDown);
    }
    bench.press(egui::Key::Enter);
    assert!(bench.screen.query_by_label("USER change-user").is_some());
    // Dark, light, darker, brighter, three sizes, four switches, the kinds, the programs' key, then the user's level.
    for _ in 0..2 + 2 + 3 + 4 + Kind::ALL.len() + 2 {
        bench.press(egui::Key::ArrowDown);
    }
    bench.press(egui::Key::Enter);
    assert!(bench.asks_password(), "it is the user's level");
    bench.write("123456");
    bench.press(egui::Key::Enter);
    assert_eq!(bench.rig.snapshot().access.level, AccessLevel::User);
}

#[test]
fn b6_a_secret_is_never_printed() {
    let command = Command::Page(PageCommand::Unlock(PasswordScope::User, Secret::new("123456".into())));
    assert!(!format!("{command:?}").contains("123456"));
}

#[test]
fn k1_the_kind_is_chosen_with_the_builders_password_and_kept_for_the_next_start() {
    let folder = tempfile::tempdir().unwrap();
    let mut bench = Bench::new(kept(folder.path(), Kind::Gc), Page::Settings);
    bench.touch("GA ga");
    assert!(bench.asks_password());
    bench.write("830830");
    bench.press(egui::Key::Enter);
    assert_eq!(StoredSettings::read(folder.path()).unwrap().kind, Some(Kind::Ga));
    assert_eq!((bench.rig.snapshot().kind, bench.rig.snapshot().next_kind), (Kind::Gc, Kind::Ga));
    assert!(bench.says("下次启动"));
    bench.touch("English lang-en");
    assert_eq!(StoredSettings::read(folder.path()).unwrap().lang, Some(StoredLang::En));
    assert!(bench.screen.query_by_label("USER change-user").is_some(), "the screen turns at once");
}

#[test]
fn b6_diagnosis_shows_a_forced_input_with_its_port_level_and_contact() {
    let mut rig = crate::stories::rig();
    let line = |rig: &mut HeadlessHost, name: &str| {
        rig.send(Command::OpenPage(Page::Diagnosis));
        (0..20).for_each(|_| rig.step());
        let texts = page_text(rig.snapshot(), Lang::Zh);
        let at = texts.iter().position(|text| text == name).expect(name);
        // Figure, name, id, port, level, contact, parameter.
        texts[at - 1..at + 6].to_vec()
    };
    // Inputs switch to 0 V: an open contact is at +24 V (high), a closed one at 0 V (low).
    assert_eq!(line(&mut rig, "gauge-6")[1..], ["gauge-6", "12", "高", "常开 NO", "P328", "0"]);
    crate::stories::tell(&mut rig, "input gauge-6 on");
    assert_eq!(line(&mut rig, "量仪信号 6")[..5], ["1", "量仪信号 6", "gauge-6", "12", "低"]);
    assert_eq!(line(&mut rig, "emergency-stop")[..5], ["急停", "emergency-stop", "4", "低", "常闭 NC"]);
    crate::stories::tell(&mut rig, "input 4 on");
    assert_eq!(line(&mut rig, "emergency-stop")[0..4], ["急停", "emergency-stop", "4", "高"]);
}

/// M80 waits until its input is active, and the page calls that low; the same for M91.
#[test]
fn k3_13_an_active_user_input_is_low_on_the_page() {
    let mut rig = crate::stories::ready_with("M80\n#100=1\nM91 P13 L50\nM30\nN50 #101=1\nM30");
    crate::stories::tell(&mut rig, "mode auto\nkey cycle-start\nwait until waiting max 5 s\npage diagnosis");
    let level = |rig: &mut HeadlessHost| {
        (0..20).for_each(|_| rig.step());
        let texts = page_text(rig.snapshot(), Lang::Zh);
        let at = texts.iter().position(|text| text == "user-1").unwrap();
        texts[at + 2].clone()
    };
    assert_eq!(level(&mut rig), "高");
    crate::stories::tell(&mut rig, "input user-1 on");
    assert_eq!(level(&mut rig), "低");
    crate::stories::tell(&mut rig, "wait until idle max 5 s\nexpect #100 1\nexpect #101 1");
}

/// An output that is on draws its load to 0 V.
#[test]
fn k3_13_an_output_that_is_on_is_low_on_the_page() {
    let mut rig = crate::stories::rig();
    crate::stories::tell(&mut rig, "page diagnosis");
    let mut bench = Bench::new(rig, Page::Diagnosis);
    bench.touch("输出 tab-outputs");
    let level = |bench: &Bench| {
        let texts = bench.painted();
        let at = texts.iter().position(|text| text == "lubrication").unwrap();
        texts[at + 2].clone()
    };
    assert_eq!(level(&bench), "高");
    bench.rig.send(Command::Press(Key::Lubrication));
    bench.turn();
    assert_eq!(level(&bench), "低");
}

#[test]
fn k6_1_two_functions_on_a_port_are_shown_as_a_conflict() {
    let mut bench = Bench::new(crate::stories::rig(), Page::Diagnosis);
    assert!(!bench.says("端口冲突"));
    crate::stories::tell(&mut bench.rig, "param P301 10");
    assert!(bench.says("端口冲突 输出口 10：冷却 P301、液压 P273"));
    crate::stories::tell(&mut bench.rig, "param P301 0\nparam P332 3");
    assert!(bench.says("端口冲突 输入口 3：液压压力 P269、防护门关 P332"));
    bench.rig.send(Command::OpenPage(Page::Params));
    bench.turn();
    bench.write("P332");
    bench.press(egui::Key::Enter);
    assert!(bench.screen.query_by_label("P332").is_some());
    crate::stories::tell(&mut bench.rig, "param P332 0");
    bench.rig.send(Command::OpenPage(Page::Diagnosis));
    assert!(!bench.says("端口冲突"), "port 0 is not connected");
}

#[test]
fn k6_1_functions_of_other_kinds_share_p153_without_a_conflict() {
    for kind in Kind::ALL {
        let mut bench = Bench::new(of_kind(kind), Page::Diagnosis);
        assert!(!bench.says("端口冲突"), "{kind:?}");
    }
}

#[test]
fn k2_4_diagnosis_lists_every_dead_key_with_its_reason() {
    let mut rig = crate::stories::ready_with("G04 P5000\nM30");
    crate::stories::tell(&mut rig, "mode auto\nkey cycle-start\nwait 0.1 s\nexpect state running");
    let mut bench = Bench::new(rig, Page::Diagnosis);
    let dead = Key::ALL
        .iter()
        .filter(|key| key.exists_on(Kind::Gc) && key.row().group != KeyGroup::Screen)
        .filter(|key| bench.screen.state().snapshot.key(**key).blocked.is_some());
    let count = dead.count();
    assert!(count > 20);
    bench.touch(&format!("按键 {count} tab-keys"));
    bench.turn();
    assert!(bench.screen.query_by_label(&format!("按键 {count} tab-keys")).is_some());
}

#[test]
fn k2_4_every_key_of_every_kind_acts_or_says_why_not() {
    for kind in Kind::ALL {
        let mut bench = Bench::new(of_kind(kind), Page::Panel);
        let on_panel = |key: &&Key| key.exists_on(kind) && key.row().group != KeyGroup::Screen;
        for key in Key::ALL.iter().filter(on_panel) {
            let blocked = bench.rig.snapshot().key(*key).blocked;
            let before = bench.rig.snapshot().clone();
            bench.rig.send(Command::Press(*key));
            bench.rig.step();
            let after = bench.rig.snapshot().clone();
            bench.rig.send(Command::Release(*key));
            bench.turn();
            let refused = after.message != before.message && !after.message.text.zh().is_empty();
            assert!(blocked.is_none() || refused, "{} of {kind:?} is blocked and said nothing", key.id());
        }
    }
}

#[test]
fn b6_the_password_is_confirmed_by_touch_as_well() {
    let mut bench = Bench::new(crate::stories::rig(), Page::Params);
    bench.set("P270", "2500");
    assert!(bench.asks_password());
    bench.write("1");
    bench.touch("确认 login-enter");
    bench.turn();
    assert!(bench.asks_password() && bench.shows("密码错误"), "a wrong one");
    bench.touch("取消 login-cancel");
    assert!(!bench.asks_password());
}

#[test]
fn b6_the_history_tells_when_an_alarm_came_and_went() {
    let mut bench = Bench::new(crate::stories::ready(), Page::Alarm);
    assert!(bench.says("没有报警"));
    crate::stories::tell(&mut bench.rig, "key emergency-stop\nwait 2 s\nexpect alarm 0");
    assert!(bench.says("松开急停后按复位") && bench.says("急停按钮按下"));
    crate::stories::tell(&mut bench.rig, "key emergency-stop\nwait 0.1 s\nkey reset\nwait 0.1 s\nexpect no alarm");
    let history = bench.rig.snapshot().alarm_history.clone();
    assert_eq!(history.len(), 1);
    let (how, gone) = history[0].ended.expect("it went");
    let seconds = gone.expect("when").0 - history[0].came.0;
    assert!(how == AlarmEnd::Reset && (2..=3).contains(&seconds), "{how:?} after {seconds} s");
    bench.turn();
    bench.touch("历史 1 alarm-history");
    let shown = bench.screen.state().snapshot.alarm_history.version();
    assert_eq!(shown, bench.rig.snapshot().alarm_history.version());
}

#[test]
fn h7_an_alarm_of_a_run_tells_its_program_and_line() {
    let mut rig = crate::stories::ready_with("#100=1\nG98 G01 X5000 F100\nM30");
    crate::stories::tell(&mut rig, "mode auto\nkey cycle-start\nwait 1 s\nexpect alarm any");
    let mut bench = Bench::new(rig, Page::Alarm);
    assert!(bench.says("O7000 第"), "{:?}", page_text(bench.rig.snapshot(), Lang::Zh));
}

#[test]
fn b6_what_does_not_change_is_shared_from_snapshot_to_snapshot() {
    let mut rig = crate::stories::rig();
    let shared = |rig: &mut HeadlessHost| {
        rig.step();
        let shown = rig.snapshot();
        (Arc::clone(&shown.params), shown.alarm_history.version())
    };
    let first = shared(&mut rig);
    let second = shared(&mut rig);
    assert!(Arc::ptr_eq(&first.0, &second.0) && first.1 == second.1);
    assert!(*first.0 == Params::factory(Kind::Gc));
    crate::stories::tell(&mut rig, "param P71 3");
    let third = shared(&mut rig);
    assert!(!Arc::ptr_eq(&first.0, &third.0) && first.1 == third.1);
}

#[test]
fn b6_the_history_outlives_the_power_and_is_exported() {
    let (folder, usb) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    // 2026-11-21 15:01:56
    let date = DateTime(1_795_273_316);
    {
        let mut rig = kept(folder.path(), Kind::Gc);
        rig.send(Command::WallClock(date));
        crate::stories::tell(
            &mut rig,
            "wait 1 s\nkey emergency-stop\nwait 0.1 s\nexpect alarm 0\nkey emergency-stop\nwait 0.1 s",
        );
        crate::stories::tell(
            &mut rig,
            "key reset\nwait 0.1 s\nexpect no alarm\nkey emergency-stop\nwait 0.1 s\nexpect alarm 0",
        );
        // The power goes with the button in.
    }
    let mut bench = Bench::new(kept(folder.path(), Kind::Gc), Page::Alarm);
    bench.rig.set_drives(None, Some(usb.path().to_path_buf()));
    bench.rig.send(Command::WallClock(DateTime(date.0 + 86_400)));
    bench.turn();
    let history = bench.rig.snapshot().alarm_history.clone();
    let numbers: Vec<_> =
        history.iter().map(|past| (past.count, past.number, past.ended.map(|(how, _)| how))).collect();
    assert_eq!(numbers, [(1, 0, Some(AlarmEnd::Reset)), (2, 0, Some(AlarmEnd::PowerOff))]);
    assert!((date.0..date.0 + 10).contains(&history[0].came.0), "{}", history[0].came);
    bench.touch("历史 2 alarm-history");
    assert!(bench.shows("2026-11-21 15:01:5") && bench.shows("复位") && bench.shows("断电"));
    bench.touch("导出 CSV alarm-export");
    let file = std::fs::read_dir(usb.path()).unwrap().next().expect("on the medium").unwrap().path();
    assert!(file.to_string_lossy().contains("KT830-20261122-1501"), "named by the clock: {}", file.display());
    let text = std::fs::read_to_string(file).unwrap();
    let lines: Vec<_> = text.lines().collect();
    assert!(lines[0].ends_with("序号,报警号,出现,消除,方式,程序,行,内容"), "{}", lines[0]);
    assert!(lines[1].starts_with("1,0,2026-11-21 15:01:5") && lines[1].ends_with(",复位,,,\"急停\""), "{}", lines[1]);
    assert!(lines.len() == 3 && lines[2].contains(",,断电,"), "{text}");
}

#[test]
fn b6_the_clock_is_set_part_by_part_and_kept_as_an_offset() {
    let folder = tempfile::tempdir().unwrap();
    let computer = DateTime(1_795_273_316);
    {
        let mut bench = Bench::new(kept(folder.path(), Kind::Gc), Page::Settings);
        bench.touch("日 clock-day");
        bench.write("5");
        bench.press(egui::Key::Enter);
        assert_eq!(bench.screen.state().hmi.refusal(Lang::Zh).unwrap().1, "没有系统时钟");
        bench.press(egui::Key::Escape);
        bench.press(egui::Key::Escape);
        bench.rig.send(Command::WallClock(computer));
        bench.turn();
        for (field, value, why) in [
            ("月 clock-month", "13", "超出范围 1 … 12"),
            ("日 clock-day", "31", "超出范围 1 … 30"),
            ("时 clock-hour", "24", "超出范围 0 … 23"),
            ("年 clock-year", "2019", "超出范围 2020 … 2099"),
            ("分 clock-minute", "1.5", "只能输入整数"),
        ] {
            bench.touch(field);
            bench.write(value);
            bench.press(egui::Key::Enter);
            assert_eq!(bench.screen.state().hmi.refusal(Lang::Zh), Some((value.into(), why.into())));
            assert_eq!(bench.rig.snapshot().date.unwrap().parts()[..5], [2_026, 11, 21, 15, 1]);
            bench.press(egui::Key::Escape);
            bench.press(egui::Key::Escape);
        }
        // Year, month, day one after the other: each 输入 goes on to the next field.
        bench.touch("年 clock-year");
        for part in ["2027", "2", "28"] {
            bench.write(part);
            bench.press(egui::Key::Enter);
        }
        assert_eq!(bench.rig.snapshot().date.unwrap().parts()[..4], [2_027, 2, 28, 15]);
        // The 31st of a month that has 30 days.
        bench.rig.send(Command::Page(PageCommand::SetDate(DateTime::from_parts([2_027, 1, 31, 8, 0, 0]).unwrap())));
        bench.turn();
        bench.touch("月 clock-month");
        bench.write("4");
        bench.press(egui::Key::Enter);
        assert_eq!(bench.screen.state().hmi.refusal(Lang::Zh).unwrap().1, "该月没有 31 日，请先改日");
    }
    let mut rig = kept(folder.path(), Kind::Gc);
    rig.send(Command::WallClock(DateTime(computer.0 + 3_600)));
    (0..3).for_each(|_| rig.step());
    assert_eq!(rig.snapshot().date.unwrap().parts()[..4], [2_027, 1, 31, 9], "an hour later");
}

#[test]
fn b6_brightness_and_switches_are_kept_and_switches_ask_for_the_users_password() {
    let folder = tempfile::tempdir().unwrap();
    let mut bench = Bench::new(kept(folder.path(), Kind::Gc), Page::Settings);
    for _ in 0..9 {
        bench.touch("- brightness-down");
    }
    assert!(bench.shows("70 %"), "no darker than can be read");
    bench.touch("+ brightness-up");
    assert_eq!(StoredSettings::read(folder.path()).unwrap().brightness, Some(80));
    bench.touch("M30 计件 switch-count");
    assert!(bench.asks_password() && bench.param("P6.4").to_bits() == 0.0_f64.to_bits());
    bench.write("123456");
    bench.press(egui::Key::Enter);
    assert_eq!(bench.param("P6.4").to_bits(), 1.0_f64.to_bits());
    bench.touch("M30 计件 switch-count");
    assert_eq!(bench.param("P6.4").to_bits(), 0.0_f64.to_bits());
}
