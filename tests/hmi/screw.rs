//! The tables of the screws on the parameter page, with the real core behind it.
//! Source: spec B7.

use std::fs;

use crate::live_screen::Bench;
use kt830::defs::leadscrew::LeadscrewCompensation;
use kt830::defs::page::Page;
use kt830::defs::text::Lang;
use kt830::link::Command;
use kt830::link::page_command::{PageCommand, PasswordScope, Secret};
use kt830::units::Axis;

fn sheet() -> Bench {
    let mut bench = Bench::new(crate::stories::ready(), Page::Params);
    bench.touch("丝杠 params-screws");
    bench
}

fn table(bench: &mut Bench, axis: Axis) -> String {
    bench.rig.snapshot().leadscrews[axis].to_text()
}

fn builder(bench: &mut Bench) {
    bench.rig.send(Command::Page(PageCommand::Unlock(PasswordScope::Builder, Secret::new("830830".into()))));
    bench.turn();
}

#[test]
fn b7_a_table_is_typed_point_by_point_with_the_builders_password() {
    let mut bench = sheet();
    bench.touch("加点 screw-add");
    assert!(bench.asks_password() && table(&mut bench, Axis::X).is_empty());
    bench.write("830830");
    bench.press(egui::Key::Enter);
    assert_eq!(table(&mut bench, Axis::X), "0,0,0\n");
    bench.touch("加点 screw-add");
    // The second point, 10 mm on: its place, its backlash, its pitch error, one 输入 after the other.
    for value in ["100", "0.03", "-0.005"] {
        bench.write(value);
        bench.press(egui::Key::Enter);
    }
    assert_eq!(table(&mut bench, Axis::X), "0,0,0\n100,0.03,-0.005\n");
    assert_eq!(bench.rig.retained().leadscrew_tables[Axis::X].points().len(), 2, "it is kept");
    // Between two points a new one changes nothing.
    bench.touch("位置 1 screw-0-0");
    bench.touch("加点 screw-add");
    assert_eq!(table(&mut bench, Axis::X), "0,0,0\n50,0.015,-0.0025\n100,0.03,-0.005\n");
    bench.touch("删点 screw-remove");
    assert_eq!(table(&mut bench, Axis::X), "0,0,0\n100,0.03,-0.005\n");
    bench.touch("清空 screw-clear");
    assert!(bench.shows("清空补偿表？"));
    bench.touch("清空 question-clear");
    assert!(table(&mut bench, Axis::X).is_empty() && table(&mut bench, Axis::Z).is_empty());
}

#[test]
fn b7_a_value_that_cannot_stand_there_is_refused_and_the_old_one_stays() {
    let mut bench = sheet();
    let before = "-100,0.03,0\n0,0.01,0\n100,0.02,0.001\n";
    bench.rig.send(Command::SetLeadscrew(Axis::Z, LeadscrewCompensation::parse(before).unwrap()));
    builder(&mut bench);
    bench.touch("Z 轴 · 点 3 screw-z");
    for (field, value, why) in [
        ("位置 2 screw-1-0", "-100", "第 2 点：位置必须逐行增大"),
        ("位置 2 screw-1-0", "100", "第 3 点：位置必须逐行增大"),
        ("位置 1 screw-0-0", "-10000", "第 1 点：-10000 超出范围 -9999…9999 mm"),
        ("反向间隙 1 screw-0-1", "-0.01", "第 1 点：-0.01 超出范围 0…2 mm"),
        ("反向间隙 1 screw-0-1", "2.1", "第 1 点：2.1 超出范围 0…2 mm"),
        ("螺距误差 3 screw-2-2", "-2.5", "第 3 点：-2.5 超出范围 -2…2 mm"),
        // 0.02 mm a mm: 1.99 over 100 mm is allowed, over 50 mm it is not.
        ("位置 2 screw-1-0", "99.5", "第 3 点：与上一行相差太大，每毫米不超过 0.02 mm"),
    ] {
        if value == "99.5" {
            bench.touch("反向间隙 2 screw-1-1");
            bench.write("0.1");
            bench.press(egui::Key::Enter);
        }
        let stands = table(&mut bench, Axis::Z);
        bench.touch(field);
        bench.write(value);
        bench.press(egui::Key::Enter);
        assert_eq!(bench.screen.state().hmi.refusal(Lang::Zh), Some((value.into(), why.into())));
        assert_eq!(table(&mut bench, Axis::Z), stands);
        bench.press(egui::Key::Escape);
    }
}

#[test]
fn b7_a_table_comes_from_the_medium_whole_or_not_at_all() {
    let usb = tempfile::tempdir().unwrap();
    let mut bench = sheet();
    bench.rig.set_drives(None, Some(usb.path().to_path_buf()));
    builder(&mut bench);
    bench.touch("导入 CSV screw-import");
    assert!(bench.shows("U 盘上没有 KT830-SCREW-X.CSV"));
    let file = usb.path().join("kt830-screw-x.csv");
    // GBK, as a spreadsheet on the measuring computer writes it.
    let heading = encoding_rs::GBK.encode("位置,反向间隙,螺距误差\r\n").0.into_owned();
    fs::write(&file, [heading.as_slice(), b"-100,0.03,0.002\r\n0,0.01,0\r\n"].concat()).unwrap();
    bench.touch("导入 CSV screw-import");
    assert_eq!(table(&mut bench, Axis::X), "-100,0.03,0.002\n0,0.01,0\n");
    assert!(bench.shows("读入 2 点"));
    for (text, why) in [
        ("0,0.01\n-5,0.02\n", "第 2 行：位置必须逐行增大"),
        ("0,0.01\n5,x\n", "第 2 行：“x” 不是数字"),
        ("# 空\n", "中没有点"),
    ] {
        fs::write(&file, text).unwrap();
        bench.touch("导入 CSV screw-import");
        assert!(bench.shows(why), "{why}");
        assert_eq!(table(&mut bench, Axis::X), "-100,0.03,0.002\n0,0.01,0\n");
    }
    // Out, and in again: the plain name goes before those with a date.
    fs::remove_file(&file).unwrap();
    bench.touch("导出 CSV screw-export");
    bench.rig.send(Command::SetLeadscrew(Axis::X, LeadscrewCompensation::default()));
    bench.turn();
    bench.touch("导入 CSV screw-import");
    assert_eq!(table(&mut bench, Axis::X), "-100,0.03,0.002\n0,0.01,0\n");
}

#[test]
fn b7_no_table_is_changed_in_a_run_or_without_the_password() {
    let mut rig = crate::stories::ready_with("G04 P9000\nM30");
    let command = PageCommand::EditLeadscrew(Axis::X, LeadscrewCompensation::parse("0,0.01").unwrap());
    rig.send(Command::Page(command.clone()));
    (0..3).for_each(|_| rig.step());
    assert!(rig.snapshot().leadscrews[Axis::X].points().is_empty());
    assert_eq!(
        rig.snapshot().edit_answer.refused.as_ref().map(|said| said.zh()).as_deref(),
        Some("需要机床厂参数密码")
    );
    rig.send(Command::Page(PageCommand::Unlock(PasswordScope::Builder, Secret::new("830830".into()))));
    crate::stories::tell(&mut rig, "mode auto\nkey cycle-start\nwait 0.1 s\nexpect state running");
    rig.send(Command::Page(command));
    (0..3).for_each(|_| rig.step());
    assert!(rig.snapshot().leadscrews[Axis::X].points().is_empty() && rig.snapshot().edit_answer.refused.is_some());
}

#[test]
fn b7_the_sheet_is_worked_by_keyboard() {
    let mut bench = Bench::new(crate::stories::ready(), Page::Params);
    builder(&mut bench);
    // From all the parameters over bits, values and ports to the screws.
    for _ in 0..4 {
        bench.screen.key_press_modifiers(egui::Modifiers::CTRL, egui::Key::P);
        bench.turn();
    }
    bench.write("z");
    bench.press(egui::Key::ArrowDown);
    bench.press(egui::Key::Enter);
    assert_eq!(table(&mut bench, Axis::Z), "0,0,0\n", "the first key below the table adds a point");
    bench.press(egui::Key::ArrowUp);
    bench.press(egui::Key::ArrowRight);
    bench.write("0.02");
    bench.press(egui::Key::Enter);
    assert_eq!(table(&mut bench, Axis::Z), "0,0.02,0\n");
}

/// The value waits for the password. If the core then refuses it, it comes back in red to the field it was typed in.
#[test]
fn h6_a_value_refused_after_the_password_returns_to_its_field() {
    let mut rig = crate::stories::ready_with("G04 P9000\nM30");
    rig.send(Command::SetLeadscrew(Axis::X, LeadscrewCompensation::parse("0,0.01,0\n100,0.02,0\n").unwrap()));
    crate::stories::tell(&mut rig, "mode auto\nkey cycle-start\nwait 0.1 s\nexpect state running");
    let mut bench = Bench::new(rig, Page::Params);
    bench.touch("丝杠 params-screws");
    bench.touch("反向间隙 1 screw-0-1");
    bench.write("0.03");
    bench.press(egui::Key::Enter);
    assert!(bench.asks_password());
    bench.write("830830");
    bench.press(egui::Key::Enter);
    assert!(!bench.asks_password());
    let (text, why) = bench.screen.state().hmi.refusal(Lang::Zh).expect("refused in a run");
    assert_eq!(text, "0.03", "{why}");
    assert!(bench.shows("X 1 反向间隙=0.03"), "in the field it was typed in");
}
