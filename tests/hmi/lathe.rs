//! The lathe's own pages with the real core behind them: measuring in the drawing, teach-in, tools and bar.

use crate::live_screen::Bench;
use crate::stories::{rig_of, tell};
use kt830::defs::kind::{Dialect, Kind};
use kt830::defs::page::Page;
use kt830::host::folders::{Folders, program_from_bytes};
use kt830::host::headless::HeadlessHost;
use kt830::link::snapshot::RunState;

/// A ready lathe with SHAFT and its bar of 45 mm.
fn lathe() -> HeadlessHost {
    let all = crate::stories::folders();
    let folders = Folders {
        programs: all.programs.join("lathe"),
        screens: all.screens,
        by_name: true,
        dialect: Dialect::SuperMan,
    };
    let mut rig = rig_of(Kind::Lathe, folders);
    let bar = rig.bar_of_program(rig.find_program("SHAFT").unwrap()).unwrap();
    rig.mount_part(&bar);
    rig.step();
    rig.make_ready();
    rig.mount_part(&bar);
    rig.step();
    tell(&mut rig, "load SHAFT\nmode auto");
    rig
}

#[test]
fn l10_a_touched_place_of_the_bar_is_measured() {
    let mut bench = Bench::new(lathe(), Page::Graphic);
    bench.touch("重算 graphic-redraw");
    bench.turn();
    assert!(bench.shows("检查无错误") && bench.shows("触摸工件"));
    assert!(!bench.shows("Ø"));
    // The middle of the picture lies on the bar: it is not cut yet.
    bench.touch("图形 graphic-canvas");
    assert!(bench.shows("Ø45.000"));
    // The same place once more: two places, no length between them.
    bench.touch("图形 graphic-canvas");
    assert!(bench.shows("L 0.000"));
    bench.touch("清轨迹 graphic-clear");
    assert!(!bench.shows("Ø"));
}

#[test]
fn l9_a_recording_is_made_and_taken_back_on_its_page() {
    let mut rig = lathe();
    tell(&mut rig, "mode step");
    let mut bench = Bench::new(rig, Page::Teach);
    assert!(bench.shows("未记录"));
    bench.touch("10 step-10");
    bench.touch("开始录返 teach-start");
    assert!(bench.shows("正在记录") && bench.shows("N0010G92X100Z50"));
    tell(&mut bench.rig, "key z-minus\nwait 1 s\nkey x-minus\nwait 1 s");
    bench.turn();
    assert!(bench.shows("N0020G01Z40") && bench.shows("N0030G01X90"));
    bench.touch("撤销一段 teach-undo");
    assert!(!bench.shows("N0030G01X90"));
    bench.touch("停止 teach-stop");
    assert!(bench.shows("未记录"));
    // P22.5: the password for programs is asked for before anything is kept.
    bench.touch("存为程序 teach-keep");
    assert!(bench.shows("密码"));
}

#[test]
fn l9_a_tool_and_the_bar_are_defined_on_their_page() {
    let mut bench = Bench::new(lathe(), Page::Tools);
    assert!(bench.shows("外圆刀") && bench.shows("螺纹刀"));
    // A touch turns a shape on: turning, then neutral.
    bench.touch("field P400");
    assert!(!bench.shows("外圆刀"));
    bench.touch("field P384");
    bench.write("60");
    bench.press(egui::Key::Enter);
    assert!((bench.param("P384") - 60.0).abs() < 1e-9);
    // Out of range: it stays in sight with the reason.
    bench.touch("field P402");
    bench.write("999");
    bench.press(egui::Key::Enter);
    assert!(bench.shows("应为 1 … 100 mm"));
    assert!((bench.param("P402") - 8.0).abs() < 1e-9);
}

#[test]
fn l9_f4_and_f5_are_the_lathes_own_pages_and_no_page_speaks_of_a_wheel() {
    let mut rig = lathe();
    tell(&mut rig, "key f4");
    assert_eq!(rig.snapshot().page, Page::Teach);
    tell(&mut rig, "key f5");
    assert_eq!(rig.snapshot().page, Page::Tools);
    tell(&mut rig, "page dressing\nexpect message \"本机床没有\"");
    for page in Page::ALL.iter().copied().filter(|page| page.exists_on(Kind::Lathe)) {
        // Parameters, alarms and help stand in tables that all kinds share.
        if matches!(page, Page::Params | Page::Help | Page::Alarm) {
            continue;
        }
        let bench = Bench::new(lathe(), page);
        for word in ["砂轮", "振荡", "修整", "尾座", "量仪", "头架"] {
            assert!(!bench.shows(word), "{word} on {}", page.id());
        }
    }
}

/// L7: what F1 does stands on the key.
#[test]
fn l7_after_m00_the_key_f1_reads_continue() {
    let mut rig = lathe();
    rig.add_program(program_from_bytes(7_000, "O7000.NC", b"N0010M00\nN0020M02".to_vec(), Dialect::SuperMan));
    tell(&mut rig, "load O7000\nkey cycle-start\nwait until stopped max 5 s");
    let mut bench = Bench::new(rig, Page::Position);
    assert!(bench.shows("继续"));
    bench.press(egui::Key::F1);
    (0..50).for_each(|_| bench.turn());
    assert_eq!(bench.rig.snapshot().state, RunState::Idle, "it went on to its end");
    assert!(!bench.shows("继续"));
    tell(&mut bench.rig, "key cycle-start\nwait until stopped max 5 s");
    bench.turn();
    bench.touch("继续 f1");
    (0..50).for_each(|_| bench.turn());
    assert_eq!(bench.rig.snapshot().state, RunState::Idle);
}
