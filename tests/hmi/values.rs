//! The pages of offsets, dressing, macro variables, MDI and wheel change with the real core behind them: accepted,
//! refused, locked.

use crate::live_screen::Bench;
use egui::Key::{ArrowDown, ArrowRight, Enter, Escape};
use egui_kittest::kittest::Queryable;
use kt830::defs::key::Key;
use kt830::defs::kind::Kind;
use kt830::defs::page::Page;
use kt830::defs::text::Lang;
use kt830::hmi::page_text;
use kt830::host::folders::{Folders, program_from_bytes};
use kt830::host::headless::{HeadlessHost, HostSetup};
use kt830::host::retained_store::RetainedStore;
use kt830::link::Command;
use kt830::link::edit::{OffsetCommand, OffsetPart};
use kt830::link::snapshot::RunState;
use kt830::units::Axis;

/// A ready machine of a kind on a page, told something first.
fn bench_of(kind: Kind, page: Page, story: &str) -> Bench {
    let mut rig = crate::stories::ready_of(kind);
    crate::stories::tell(&mut rig, story);
    Bench::new(rig, page)
}

fn bench(page: Page, story: &str) -> Bench {
    bench_of(Kind::Gc, page, story)
}

/// A program that stands in a dwell.
fn running(page: Page, story: &str) -> Bench {
    let mut rig = crate::stories::ready_with("G04 P60000\nM30");
    crate::stories::tell(&mut rig, story);
    crate::stories::tell(&mut rig, "mode auto\nkey cycle-start\nwait 0.1 s\nexpect state running");
    Bench::new(rig, page)
}

fn type_in(bench: &mut Bench, text: &str) {
    bench.write(text);
    bench.press(Enter);
}

fn wear(bench: &Bench, number: usize, axis: Axis) -> f64 {
    bench.screen.state().snapshot.offsets.tools[number - 1].wear[axis]
}

fn origin(bench: &Bench, row: usize, axis: Axis) -> f64 {
    bench.screen.state().snapshot.offsets.origins[row][axis]
}

fn geometry(bench: &Bench, number: usize, axis: Axis) -> f64 {
    bench.screen.state().snapshot.offsets.tools[number - 1].geometry[axis]
}

/// Text and reason of what stands in red.
fn red(bench: &Bench) -> Option<(String, String)> {
    bench.screen.state().hmi.refusal(Lang::Zh)
}

/// Equal to the display's resolution.
fn is(value: f64, wanted: f64) -> bool {
    (value - wanted).abs() < 1e-9
}

#[test]
fn b6_an_offset_takes_values_as_displayed() {
    let mut bench = bench(Page::Offset, "param P22.0 1");
    bench.touch("geometry-04-X");
    for key in ["pad-1", "pad-2", "pad-point", "pad-5", "pad-sign", "输入 input"] {
        bench.touch(key);
    }
    assert!(is(geometry(&bench, 4, Axis::X), -12.5), "the diameter that was typed");
    assert!(is(bench.rig.retained().work_offsets.geometry[3][Axis::X], -6.25), "radius inside");
    // The next field is Z of the same offset, then the wear.
    type_in(&mut bench, "3");
    type_in(&mut bench, "0.02");
    assert!(is(geometry(&bench, 4, Axis::Z), 3.0) && is(wear(&bench, 4, Axis::X), 0.02));
}

#[test]
fn k4_1_u_and_w_add_to_the_wear() {
    let mut bench = bench(Page::Offset, "param P22.0 1");
    bench.touch("geometry-02-X");
    for (letter, by) in [("u", "0.1"), ("u", "-0.03"), ("w", "-0.1")] {
        bench.write(letter);
        type_in(&mut bench, by);
    }
    assert!(is(wear(&bench, 2, Axis::X), 0.07) && is(wear(&bench, 2, Axis::Z), -0.1));
    assert!(is(geometry(&bench, 2, Axis::X), 0.0));
    // By touch, and once: the value after it is absolute.
    bench.touch("wear-02-X");
    bench.touch("增量 U/W how-increment");
    type_in(&mut bench, "0.01");
    assert!(is(wear(&bench, 2, Axis::X), 0.08));
    type_in(&mut bench, "0.01");
    assert!(is(wear(&bench, 2, Axis::X), 0.01));
}

#[test]
fn k4_1_an_increment_without_its_point_is_refused() {
    let mut bench = bench(Page::Offset, "param P22.0 1");
    bench.write("u");
    type_in(&mut bench, "15");
    let (text, reason) = red(&bench).unwrap();
    assert_eq!((text.as_str(), reason.as_str()), ("15", "超出范围 ±9.999"));
    bench.rig.send(Command::AddWear { number: 1, axis: Axis::X, increment: 15.0 });
    bench.turn();
    assert!(is(wear(&bench, 1, Axis::X), 0.0), "nor past the page");
    bench.rig.send(Command::AddWear { number: 17, axis: Axis::X, increment: 0.1 });
    bench.turn();
    assert_eq!(bench.message(), "刀补号应为 1-16");
}

#[test]
fn k4_1_g10_and_the_page_add_to_the_same_wear() {
    let mut bench = bench(Page::Offset, "param P22.0 1\nmdi G10 D4 U0.1 W-0.1\nwait until idle");
    bench.touch("wear-04-X");
    bench.write("u");
    type_in(&mut bench, "0.05");
    assert!(is(wear(&bench, 4, Axis::X), 0.15) && is(wear(&bench, 4, Axis::Z), -0.1));
}

#[test]
fn k5_10_a_measurement_sets_the_geometry_and_clears_the_wear() {
    let mut bench = bench(Page::Offset, "param P22.0 1\nmdi T0104");
    bench.touch("wear-04-X");
    type_in(&mut bench, "0.05");
    bench.touch("wear-04-Z");
    type_in(&mut bench, "0.07");
    bench.touch("geometry-04-X");
    bench.touch("测量值 how-measured");
    type_in(&mut bench, "40.012");
    let work = bench.rig.snapshot().axes[Axis::X].work;
    assert!((work - 40.012).abs() < 1e-6, "the axis stands at what was measured, not at {work}");
    assert!(is(wear(&bench, 4, Axis::X), 0.0), "its wear is cleared");
    assert!(is(wear(&bench, 4, Axis::Z), 0.07), "the other axis keeps its own");
    assert_eq!(bench.rig.snapshot().offsets.active_tool, 4);
}

#[test]
fn k5_10_an_axis_without_zero_cannot_be_measured() {
    let mut rig = crate::stories::rig();
    crate::stories::tell(&mut rig, "param P22.0 1");
    let mut bench = Bench::new(rig, Page::Offset);
    bench.write("m");
    type_in(&mut bench, "40");
    assert_eq!(red(&bench), Some(("40".into(), "X 未回零，不能测量".into())));
}

#[test]
fn k7_7_without_p22_0_wear_is_locked_and_the_typed_text_stays_in_red() {
    let mut bench = bench(Page::Offset, "");
    assert!(bench.says("P22.0=0"));
    bench.touch("wear-03-Z");
    type_in(&mut bench, "0.5");
    assert_eq!(red(&bench), Some(("0.5".into(), "P22.0=0：不允许修改".into())));
    assert!(is(wear(&bench, 3, Axis::Z), 0.0));
    bench.write("w");
    type_in(&mut bench, "0.5");
    assert_eq!(red(&bench).unwrap().1, "P22.0=0：不允许修改");
    bench.press(Escape);
    bench.touch("geometry-03-X");
    bench.touch("测量值 how-measured");
    type_in(&mut bench, "10");
    assert_eq!(red(&bench).unwrap().1, "P22.0=0：不允许修改");
    assert!(is(geometry(&bench, 3, Axis::X), 0.0));
    // The geometry as a value is not under the parameter.
    bench.touch("geometry-05-Z");
    type_in(&mut bench, "7");
    assert!(is(geometry(&bench, 5, Axis::Z), 7.0));
}

#[test]
fn k7_7_no_edit_while_a_program_runs_except_by_p6_3() {
    let mut locked = running(Page::Offset, "param P22.0 1");
    locked.write("u");
    type_in(&mut locked, "0.1");
    assert_eq!(red(&locked), Some(("0.1".into(), "程序运行中不能修改 (P6.3)".into())));
    locked.touch("geometry-01-X");
    type_in(&mut locked, "9");
    assert!(red(&locked).is_some() && is(geometry(&locked, 1, Axis::X), 0.0));
    let mut open = running(Page::Offset, "param P22.0 1\nparam P6.3 1");
    open.write("u");
    type_in(&mut open, "0.1");
    assert!(red(&open).is_none() && is(wear(&open, 1, Axis::X), 0.1));
    open.write("m");
    type_in(&mut open, "1");
    assert_eq!(red(&open).unwrap().1, "程序未结束，不能测量");
}

/// Whoever touches a value in a run is told at once, not after it has been typed.
#[test]
fn k7_7_values_that_a_run_locks_are_marked_and_open_no_pad() {
    for (page, field) in [(Page::Grinding, "毛坯直径 #520"), (Page::Offset, "geometry-01-X"), (Page::Macro, "#100")]
    {
        let mut rig = crate::stories::ready();
        let program = b"G04 P6000\nM30".to_vec();
        rig.add_program(program_from_bytes(1_002, "O1002.NC", program, rig.kind().dialect()));
        crate::stories::tell(&mut rig, "load O1002\nparam P22.0 1\nmode auto");
        let mut bench = Bench::new(rig, page);
        bench.touch(field);
        assert!(bench.screen.query_by_label("pad-1").is_some() && !bench.shows("(P6.3)"), "{page:?}: idle");
        bench.write("7");
        crate::stories::tell(&mut bench.rig, "key cycle-start\nwait 0.2 s\nexpect state running");
        bench.turn();
        assert!(bench.screen.query_by_label("pad-1").is_none(), "{page:?}");
        assert!(bench.painted().contains(&"7_".to_owned()), "{page:?}: the text is kept: {:?}", bench.painted());
        bench.press(Escape);
        bench.touch(field);
        assert!(bench.screen.query_by_label("pad-1").is_none(), "{page:?}");
        assert!(bench.shows("程序运行中不能修改 (P6.3)"), "{page:?}: {:?}", bench.painted());
        assert!(page != Page::Grinding || bench.shows("运行中锁定"));
        // What is typed all the same is refused, and the refusal ends with the run.
        type_in(&mut bench, "9");
        assert!(red(&bench).is_some(), "{page:?}");
        crate::stories::tell(&mut bench.rig, "wait until idle max 10 s");
        bench.turn();
        assert!(red(&bench).is_none() && !bench.shows("(P6.3)"), "{page:?}: {:?}", bench.painted());
    }
}

#[test]
fn k7_7_a_value_taken_in_a_run_says_from_when_on_it_acts() {
    let mut rig = crate::stories::ready();
    let program = b"G04 P60000\nM30".to_vec();
    rig.add_program(program_from_bytes(1_002, "O1002.NC", program, rig.kind().dialect()));
    crate::stories::tell(&mut rig, "load O1002\nparam P6.3 1\nmode auto\nkey cycle-start\nwait 0.2 s");
    let mut bench = Bench::new(rig, Page::Grinding);
    bench.touch("毛坯直径 #520");
    assert!(bench.shows("从下一个读入的段起有效 · 范围"), "{:?}", bench.painted());
    type_in(&mut bench, "40.5");
    assert_eq!(bench.message(), "#520 = 40.500，从下一个读入的段起有效，已预读的段不变");
    assert_eq!(bench.rig.snapshot().variables[520], Some(40.5));
}

/// The offset of a program acts until the next T word.
#[test]
fn b6_the_offset_that_acts_after_a_program_stands_on_the_mdi_page() {
    let mut rig = crate::stories::ready_with("T0103\nM30");
    crate::stories::tell(&mut rig, "mode auto\nkey cycle-start\nwait until idle");
    let mut bench = Bench::new(rig, Page::Mdi);
    assert!(bench.shows("T0103") && bench.rig.snapshot().modals.tool == (1, 3), "{:?}", bench.painted());
    crate::stories::tell(&mut bench.rig, "mode mdi\nmdi T0100\nwait until idle");
    bench.turn();
    assert!(!bench.shows("T0103") && bench.rig.snapshot().modals.tool == (1, 0), "{:?}", bench.painted());
}

#[test]
fn k7_7_an_edit_in_a_run_outlives_the_frames_that_were_read_ahead() {
    let mut rig = crate::stories::ready_with("G04 P3000\nT0102\nG04 P3000\nM30");
    crate::stories::tell(&mut rig, "param P22.0 1\nparam P6.3 1\nmode auto\nkey cycle-start\nwait 0.1 s");
    let mut bench = Bench::new(rig, Page::Offset);
    bench.touch("wear-02-Z");
    type_in(&mut bench, "0.25");
    crate::stories::tell(&mut bench.rig, "wait until idle");
    assert!(is(wear(&bench, 2, Axis::Z), 0.25));
}

#[test]
fn b6_offsets_outlive_the_power() {
    let folder = tempfile::tempdir().unwrap();
    let start = || {
        let (store, found) = RetainedStore::open(folder.path(), Kind::Gc).unwrap();
        let setup = HostSetup {
            kind: Kind::Gc,
            retained: found.retained,
            store: Some(store),
            folders: crate::stories::folders(),
            seed: 1,
        };
        Bench::new(HeadlessHost::new(setup).unwrap(), Page::Offset)
    };
    {
        let mut bench = start();
        crate::stories::tell(&mut bench.rig, "param P22.0 1");
        bench.touch("geometry-06-Z");
        type_in(&mut bench, "-21.5");
        bench.write("u");
        type_in(&mut bench, "0.04");
        assert!(is(wear(&bench, 6, Axis::X), 0.04));
    }
    let bench = start();
    assert!(is(geometry(&bench, 6, Axis::Z), -21.5) && is(wear(&bench, 6, Axis::X), 0.04));
}

#[test]
fn b6_each_kind_has_the_offsets_of_its_axes() {
    for kind in Kind::ALL.iter().copied().filter(|kind| Page::Offset.exists_on(*kind)) {
        let bench = bench_of(kind, Page::Offset, "");
        for axis in Axis::ALL {
            let present = bench.screen.state().snapshot.axes[axis].present;
            assert_eq!(bench.screen.query_by_label(&format!("wear-01-{axis}")).is_some(), present, "{kind:?} {axis}");
        }
    }
    let mut bench = bench_of(Kind::Gs, Page::Offset, "param P22.0 1");
    bench.write("v");
    type_in(&mut bench, "-0.02");
    assert!(is(wear(&bench, 1, Axis::Y), -0.02), "radius mm on the surface grinder");
}

#[test]
fn k7_6_the_dressing_page_edits_the_same_wear_without_p22_0() {
    let mut bench = bench(Page::Dressing, "");
    assert!(bench.says("砂轮磨耗") && bench.says("[修整点 机床坐标]"));
    bench.touch("wear-03-X");
    type_in(&mut bench, "0.12");
    bench.write("u");
    // The cursor has gone on to Z of the same offset; U is X.
    type_in(&mut bench, "0.01");
    assert!(is(wear(&bench, 3, Axis::X), 0.13));
    let geometry_there = OffsetCommand::Set { number: 3, part: OffsetPart::Geometry, axis: Axis::X, value: 1.0 };
    bench.rig.send(Command::Offset(geometry_there));
    bench.turn();
    assert!(is(geometry(&bench, 3, Axis::X), 0.0), "the geometry is not this page's");
    bench.rig.send(Command::OpenPage(Page::Offset));
    bench.turn();
    assert!(bench.says("0.130"), "the offset page shows the same");
    let mut busy = running(Page::Dressing, "");
    type_in(&mut busy, "0.5");
    assert_eq!(red(&busy), Some(("0.5".into(), "程序运行中不能修改 (P6.3)".into())));
}

#[test]
fn k7_6_the_dressing_page_shows_the_point_that_was_set() {
    let mut bench = bench(Page::Dressing, "mode manual");
    assert!(bench.says("未设置"));
    bench.touch("相对 f1");
    bench.touch("X address-x");
    bench.touch("输入 input");
    bench.touch("砂轮修整 f5");
    let machine = bench.rig.snapshot().axes[Axis::X].machine;
    assert_eq!(bench.rig.snapshot().dressing_point[Axis::X].map(f64::to_bits), Some(machine.to_bits()));
    bench.turn();
    let texts = page_text(bench.rig.snapshot(), Lang::Zh);
    assert_eq!(texts.iter().filter(|text| *text == "未设置").count(), 1, "Z is still without");
}

#[test]
fn k7_6_a_missing_picture_is_alarm_66_and_named() {
    let folder = tempfile::tempdir().unwrap();
    let folders = Folders { screens: folder.path().to_owned(), ..crate::stories::folders() };
    let mut bench = Bench::new(crate::stories::rig_in(folders), Page::Position);
    assert!(bench.rig.snapshot().alarms.iter().all(|alarm| alarm.number != 66));
    bench.touch("砂轮修整 f5");
    let alarm = bench.rig.snapshot().alarms.iter().find(|alarm| alarm.number == 66).cloned().expect("alarm 66");
    assert!(alarm.text.zh().contains("B0100.BMP"), "{}", alarm.text.zh());
    assert!(bench.says("没有图片"));
    bench.touch("综合 f2");
    assert!(bench.rig.snapshot().alarms.iter().all(|alarm| alarm.number != 66), "it goes with the page");
}

#[test]
fn k7_6_with_its_picture_there_is_no_alarm() {
    let mut bench = bench(Page::Dressing, "");
    assert!(bench.rig.snapshot().alarms.iter().all(|alarm| alarm.number != 66));
    assert!(!bench.says("没有图片"));
}

#[test]
fn b6_macro_variables_are_found_by_number_with_their_labels() {
    let mut bench = bench(Page::Macro, "load O1001\nparam P22.0 1");
    bench.write("#");
    type_in(&mut bench, "505");
    assert!(bench.shows("#505=") && bench.shows("左卡磨耗余量"));
    type_in(&mut bench, "0.04");
    assert_eq!(bench.rig.snapshot().variables[505], Some(0.04));
    bench.touch("本页面 range-page");
    assert!(bench.shows("#511") && !bench.shows("#101"), "only what the page text names");
    bench.touch("查找 # find-variable");
    for key in ["pad-4", "pad-4", "pad-0", "输入 input"] {
        bench.touch(key);
    }
    assert_eq!(red(&bench).unwrap().1, "没有此变量：#100–#439、#500–#999");
    // A number of four digits is not the variable of its first three.
    bench.touch("查找 # find-variable");
    type_in(&mut bench, "5001");
    assert_eq!(red(&bench).unwrap(), ("5001".into(), "没有此变量：#100–#439、#500–#999".into()));
    bench.touch("#200 range-200");
    type_in(&mut bench, "-1.5");
    assert_eq!(bench.rig.snapshot().variables[200], Some(-1.5));
}

#[test]
fn k7_7_macro_variables_are_locked_without_p22_0() {
    let mut bench = bench(Page::Macro, "load O1001");
    assert!(bench.says("P22.0=0：只能查看"));
    bench.touch("#500 range-500");
    type_in(&mut bench, "1.25");
    assert_eq!(red(&bench), Some(("1.25".into(), "P22.0=0：不允许修改".into())));
    assert_ne!(bench.rig.snapshot().variables[500], Some(1.25));
    let mut busy = running(Page::Macro, "param P22.0 1");
    type_in(&mut busy, "7");
    assert_eq!(red(&busy), Some(("7".into(), "程序运行中不能修改 (P6.3)".into())));
}

#[test]
fn k7_5_switch_variables_take_0_and_1_at_the_macro_page() {
    let mut bench = bench(Page::Macro, "param P22.0 1");
    bench.write("#");
    type_in(&mut bench, "570");
    type_in(&mut bench, "2");
    assert_eq!(red(&bench).unwrap().1, "只能输入 0 或 1");
    type_in(&mut bench, "1");
    assert_eq!(bench.rig.snapshot().variables[570], Some(1.0));
}

#[test]
fn b6_the_controls_own_variables_are_read_only() {
    let mut bench = bench(Page::Macro, "param P22.0 1");
    bench.touch("#434 range-434");
    type_in(&mut bench, "1");
    assert_eq!(red(&bench), Some(("1".into(), "#434 是只读变量".into())));
}

#[test]
fn b6_an_mdi_line_is_put_ready_by_input_and_executed_by_cycle_start() {
    let mut bench = bench(Page::Mdi, "mode mdi");
    let before = bench.rig.snapshot().axes[Axis::Z].work;
    for key in ["G01 word-G01", "W letter-W", "- letter-", "2 letter-2", "空格 letter- ", "F letter-F"] {
        let label = if key == "- letter-" { "- letter--" } else { key };
        bench.touch(label);
    }
    bench.write("600");
    bench.touch("输入 letter-done");
    assert_eq!(&*bench.rig.snapshot().prepared_mdi, "G01 W-2 F600");
    assert!(bench.says("按循环启动执行： G01 W-2 F600"));
    assert!(is(bench.rig.snapshot().axes[Axis::Z].work, before), "the page moves nothing");
    bench.rig.send(Command::Press(Key::CycleStart));
    bench.turn();
    crate::stories::tell(&mut bench.rig, "wait until idle");
    assert!((bench.rig.snapshot().axes[Axis::Z].work - before + 2.0).abs() < 1e-3);
    bench.turn();
    assert!(bench.says("F 600") && bench.says("G01"), "the codes in force");
    // The line stands in the history, and comes back by a touch.
    bench.touch("mdi-line-0");
    bench.press(Enter);
    assert_eq!(&*bench.rig.snapshot().prepared_mdi, "G01 W-2 F600");
    bench.press(Escape);
    assert!(bench.rig.snapshot().prepared_mdi.is_empty(), "取消 takes it back");
}

#[test]
fn b6_a_wrong_mdi_line_stays_in_red_with_its_reason() {
    let mut bench = bench(Page::Mdi, "mode mdi");
    type_in(&mut bench, "g01 u-1 q");
    let (text, reason) = red(&bench).unwrap();
    assert_eq!(text, "G01 U-1 Q");
    assert!(!reason.is_empty() && bench.rig.snapshot().prepared_mdi.is_empty());
    bench.press(egui::Key::Backspace);
    bench.press(egui::Key::Backspace);
    bench.write(" f100");
    bench.press(Enter);
    assert_eq!(&*bench.rig.snapshot().prepared_mdi, "G01 U-1 F100", "mended, not typed anew");
    // Beyond a soft limit: the line before is not ready any more.
    type_in(&mut bench, "G00 Z99999");
    assert!(red(&bench).unwrap().1.contains("软限位"));
    assert!(bench.rig.snapshot().prepared_mdi.is_empty());
}

#[test]
fn b6_mdi_needs_its_mode_and_a_line() {
    let mut bench = bench(Page::Mdi, "mode auto");
    assert!(bench.says("先按面板上的 录入 键"));
    type_in(&mut bench, "G00 U-1");
    assert_eq!(red(&bench), Some(("G00 U-1".into(), "录入方式下才能执行：先按 录入 键".into())));
    bench.rig.send(Command::Press(Key::ModeMdi));
    bench.turn();
    bench.rig.send(Command::Press(Key::CycleStart));
    bench.turn();
    assert_eq!(bench.message(), "先输入一行，再按循环启动");
    assert_eq!(bench.rig.snapshot().state, RunState::Idle);
    bench.press(Enter);
    assert_eq!(&*bench.rig.snapshot().prepared_mdi, "G00 U-1", "the text was kept");
}

#[test]
fn b6_a_ready_mdi_line_outlives_a_refused_cycle_start() {
    let mut rig = crate::stories::rig();
    crate::stories::tell(&mut rig, "mode mdi\nfault drive-X\nwait 1 s\nexpect alarm 104");
    let mut bench = Bench::new(rig, Page::Mdi);
    type_in(&mut bench, "M08");
    assert_eq!(&*bench.rig.snapshot().prepared_mdi, "M08");
    bench.rig.send(Command::Press(Key::CycleStart));
    bench.turn();
    assert_eq!(&*bench.rig.snapshot().prepared_mdi, "M08", "alarm 104 blocks: it waits on");
    assert!(bench.rig.snapshot().state != RunState::Running);
}

#[test]
fn b6_a_ready_mdi_line_goes_with_the_mode_and_with_reset() {
    let mut bench = bench(Page::Mdi, "mode mdi");
    for story in ["mode auto\nmode mdi", "key reset"] {
        type_in(&mut bench, "G00 U-1");
        assert!(!bench.rig.snapshot().prepared_mdi.is_empty());
        crate::stories::tell(&mut bench.rig, story);
        assert!(bench.rig.snapshot().prepared_mdi.is_empty(), "{story}");
    }
}

/// Types the three values of a new wheel and confirms.
fn change_wheel(bench: &mut Bench, values: [&str; 3]) {
    for value in values {
        type_in(bench, value);
    }
    bench.touch("已换砂轮 wheel-changed");
    bench.touch("确认 wheel-confirm");
}

#[test]
fn k5_17_a_new_wheel_blocks_cycle_start_until_it_is_dressed() {
    let mut bench = bench(Page::Wheel, "param P77 600\nparam P79 45");
    assert!(bench.says("砂轮已修整") && bench.says("1432"), "45 m/s on 600 mm");
    change_wheel(&mut bench, ["500", "25", "35"]);
    assert!(is(bench.param("P77"), 500.0) && is(bench.param("P78"), 25.0) && is(bench.param("P79"), 35.0));
    assert!(is(bench.param("P6.7"), 1.0));
    assert!(bench.says("已换砂轮，尚未修整") && bench.says("O1011–O1012") && bench.says("1336"));
    crate::stories::tell(
        &mut bench.rig,
        "load O1002\nmode auto\nkey cycle-start\nwait 0.1 s\nexpect message \"先修整\"",
    );
    assert_eq!(bench.rig.snapshot().state, RunState::Idle);
    // The dressing program may run, and takes the flag away at its M30.
    let dressing = kt830::host::folders::program_from_bytes(
        1_011,
        "O1011.NC",
        b"G04 P100\nM30".to_vec(),
        bench.rig.kind().dialect(),
    );
    bench.rig.add_program(dressing);
    crate::stories::tell(&mut bench.rig, "load O1011\nkey cycle-start\nwait until idle");
    assert!(is(bench.param("P6.7"), 0.0));
    assert!(bench.says("砂轮已修整"));
}

#[test]
fn k5_17_values_left_out_stay_and_nothing_changes_before_the_confirmation() {
    let mut bench = bench(Page::Wheel, "");
    bench.press(ArrowDown);
    type_in(&mut bench, "32");
    assert!(is(bench.param("P78"), 20.0));
    bench.touch("已换砂轮 wheel-changed");
    bench.touch("取消 wheel-cancel");
    assert!(is(bench.param("P78"), 20.0) && is(bench.param("P6.7"), 0.0));
    // By keyboard: on to the key, which asks, and once more.
    bench.press(ArrowRight);
    while bench.screen.query_by_label("确认 wheel-confirm").is_none() {
        bench.press(Enter);
    }
    bench.press(Enter);
    assert!(is(bench.param("P77"), 600.0) && is(bench.param("P78"), 32.0) && is(bench.param("P6.7"), 1.0));
}

/// The list of wheels by finger and keyboard: kept under a number, taken off, mounted again.
#[test]
fn k5_17_the_wheels_of_the_shop_are_kept_and_mounted_from_the_list() {
    let mut bench = bench(Page::Wheel, "param P77 600\nparam P79 45");
    bench.touch("砂轮库 0 wheel-list");
    assert!(bench.shows("还没有砂轮"));
    bench.touch("装上 wheel-mount");
    assert!(bench.shows("先选一片砂轮"));
    // The next free number is offered; another one is typed. The pad goes with INPUT and CANCEL.
    bench.touch("wheel-number");
    assert!(bench.screen.query_by_label_contains("pad-7").is_some());
    bench.press(egui::Key::Escape);
    bench.touch("wheel-number");
    bench.press(Enter);
    assert!(bench.screen.query_by_label_contains("pad-7").is_none());
    assert!(bench.shows("1"));
    bench.write("12");
    bench.touch("存入 wheel-keep");
    assert!(bench.shows("在机床上") && bench.shows("12  Ø600 × 20 mm · 45 m/s"), "{:?}", bench.painted());
    bench.touch("返回 wheel-back");
    change_wheel(&mut bench, ["500", "25", "35"]);
    assert!(is(bench.param("P77"), 500.0));
    bench.touch("砂轮库 1 wheel-list");
    bench.touch("wheel 12");
    // Nothing is mounted before the question is answered.
    bench.touch("装上 wheel-mount");
    bench.touch("取消 question-no");
    assert!(is(bench.param("P77"), 500.0));
    bench.touch("装上 wheel-mount");
    bench.touch("已装上 question-mount");
    assert!(is(bench.param("P77"), 600.0) && bench.shows("在机床上"));
    bench.touch("碰撞 wheel-crashed");
    bench.touch("记入 question-crash");
    assert!(bench.shows("碰撞后未平衡") && bench.shows("碰撞 1"));
    bench.touch("已平衡 wheel-balanced");
    assert!(!bench.shows("碰撞后未平衡"));
    bench.touch("返回 wheel-back");
    assert!(bench.screen.query_by_label("已换砂轮 wheel-changed").is_some());
}

#[test]
fn k5_17_no_change_while_the_wheel_turns_or_a_program_is_open() {
    let mut turning = bench(Page::Wheel, "mode manual\nkey wheel-start\nwait 1 s\nexpect output wheel on");
    change_wheel(&mut turning, ["500", "25", "35"]);
    assert!(turning.shows("砂轮还在转，先停砂轮"));
    assert!(is(turning.param("P77"), 600.0) && is(turning.param("P6.7"), 0.0));
    assert!(turning.shows("500"), "what was typed stays");
    let mut open = running(Page::Wheel, "");
    change_wheel(&mut open, ["500", "25", "35"]);
    assert!(open.shows("程序未结束，先复位") && is(open.param("P77"), 600.0));
}

#[test]
fn k5_17_a_size_out_of_range_is_refused_as_a_whole() {
    let mut bench = bench(Page::Wheel, "");
    type_in(&mut bench, "5");
    assert_eq!(red(&bench), Some(("5".into(), "应为 10 … 2000 mm".into())));
    bench.rig.send(Command::ChangeWheel { diameter_mm: 500.0, width_mm: 0.0, rated_m_s: 35.0 });
    bench.turn();
    assert!(bench.message().contains("P78"));
    assert!(is(bench.param("P77"), 600.0) && is(bench.param("P6.7"), 0.0), "nothing of it");
    bench.rig.send(Command::OpenPage(Page::Position));
    bench.rig.send(Command::ChangeWheel { diameter_mm: 500.0, width_mm: 25.0, rated_m_s: 35.0 });
    bench.turn();
    assert!(is(bench.param("P77"), 600.0), "from its own page only");
}

#[test]
fn h6_what_the_core_refuses_on_the_grinding_page_stays_in_red() {
    let mut rig = crate::stories::ready_with("G04 P60000\nM30");
    crate::stories::tell(&mut rig, "load O1001\nmode auto");
    let mut bench = Bench::new(rig, Page::Grinding);
    crate::stories::tell(&mut bench.rig, "load O1001\nkey single-block\nkey cycle-start\nwait 0.2 s");
    let before = bench.rig.snapshot().variables[501];
    bench.press(ArrowDown);
    type_in(&mut bench, "12.5");
    let said = Some(("12.5".into(), "程序运行中不能修改 (P6.3)".into()));
    assert_eq!(red(&bench), said);
    assert_eq!(
        (bench.screen.state().hmi.variable_entry().unwrap().cursor, bench.rig.snapshot().variables[501]),
        (1, before)
    );
    // It outlasts the message line's five seconds, and goes with the next key.
    crate::stories::tell(&mut bench.rig, "wait 6 s");
    bench.turn();
    assert_eq!(red(&bench), said);
    bench.write("3");
    assert_eq!((red(&bench), bench.screen.state().hmi.variable_entry().unwrap().editor.text.as_str()), (None, "3"));
}

/// Touches a cell that the pad may cover: 取消 closes it, and for a while the place that it has left takes no touch.
fn select(bench: &mut Bench, cell: &str) {
    bench.press(Escape);
    (0..60).for_each(|_| bench.turn());
    bench.touch(cell);
}

/// A ready machine stands at X−80 (diameter), Z−150.
#[test]
fn b6_work_offsets_are_typed_measured_and_taught() {
    let mut bench = bench(Page::Offset, "param P22.0 1");
    bench.touch("坐标系 work-offsets");
    select(&mut bench, "origin-G55-X");
    type_in(&mut bench, "-60");
    assert!(is(origin(&bench, 2, Axis::X), -60.0));
    assert!(is(bench.rig.retained().work_offsets.work[1][Axis::X], -30.0), "radius inside");
    // The cursor has gone on to Z: the place where the axis stands is called 10.
    type_in(&mut bench, "m10");
    assert!(is(origin(&bench, 2, Axis::Z), -160.0), "−150 − 10");
    select(&mut bench, "origin-P1-Z");
    bench.touch("此处为零 Z=0 teach-origin");
    assert!(is(origin(&bench, 7, Axis::Z), -150.0), "the place is zero");
    // The external offset counts for all.
    select(&mut bench, "origin-EXT-Z");
    type_in(&mut bench, "2");
    select(&mut bench, "origin-G54-Z");
    bench.touch("此处为零 Z=0 teach-origin");
    assert!(is(origin(&bench, 1, Axis::Z), -152.0));
    assert!(is(bench.screen.state().snapshot.axes[Axis::Z].work, 0.0));
    type_in(&mut bench, "10000");
    assert!(red(&bench).is_some(), "out of range");
    assert!(is(origin(&bench, 1, Axis::Z), -152.0), "nothing is changed");
}

#[test]
fn k7_7_measuring_and_teaching_a_work_offset_are_locked_by_p22_0() {
    let mut bench = bench(Page::Offset, "param P22.0 0");
    bench.touch("坐标系 work-offsets");
    select(&mut bench, "origin-G54-Z");
    bench.touch("此处为零 Z=0 teach-origin");
    assert!(is(origin(&bench, 1, Axis::Z), 0.0), "nothing is changed");
    select(&mut bench, "origin-G54-Z");
    type_in(&mut bench, "-5");
    assert!(is(origin(&bench, 1, Axis::Z), -5.0), "a value is not locked, as with the geometry");
}

#[test]
fn b2_radius_and_tip_are_typed_on_the_offset_page() {
    let mut bench = bench(Page::Offset, "param P22.0 0");
    select(&mut bench, "radius-05");
    type_in(&mut bench, "0.4");
    type_in(&mut bench, "3");
    let row = bench.screen.state().snapshot.offsets.tools[4];
    assert!(is(row.radius_mm, 0.4) && row.tip == 3);
    select(&mut bench, "tip-05");
    type_in(&mut bench, "3.5");
    assert!(red(&bench).is_some());
    select(&mut bench, "radius-06");
    type_in(&mut bench, "-1");
    assert!(red(&bench).is_some());
    assert_eq!(bench.screen.state().snapshot.offsets.tools[4].tip, 3);
}
