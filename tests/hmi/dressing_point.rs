//! The dressing point: where one is set by key the dressing programs use it, else the value of their page; the page says
//! which, and with none nothing moves. Source: spec K4.2, K5.17, K7.6.

use kt830::defs::key::Mode;
use kt830::defs::kind::Kind;
use kt830::defs::page::Page;
use kt830::link::snapshot::RunState;
use kt830::link::{Command, PageCommand};
use kt830::units::Axis;

use crate::live_screen::Bench;
use crate::stories::{ready, ready_of, tell};

/// O1011 with its values: the diamond at −320, −60.
fn bench(page: Page) -> Bench {
    let mut rig = ready();
    tell(&mut rig, "load O1011\npart assets/parts/O1011.ron");
    Bench::new(rig, page)
}

/// The operator leads the wheel's corner to the diamond and sets both points there.
const SET_AT_DIAMOND: &str = "mode mdi\nmdi G53 G00 X0\nwait until idle\nmdi G53 G00 Z-60\nwait until idle
mdi G53 G00 X-318\nwait until idle\nmdi G53 G01 X-320 F200\nwait until idle\nwait 0.5 s
mode jog\npage position\nkey f1\nkey address-x\nkey input\nexpect message \"成功\"\nkey address-z\nkey input\npage grinding";

#[test]
fn k4_2_the_page_shows_which_point_is_used_and_where_it_comes_from() {
    let mut bench = bench(Page::Grinding);
    assert!(bench.shows("修整点 X -320.000 数值 · Z -60.000 数值"), "{:?}", bench.painted());
    // On the wheel axis the value is that of a new wheel.
    tell(&mut bench.rig, "param P97 1\nset #772 = 0.05");
    bench.turn();
    assert!(bench.shows("X -320.050 数值 (-0.050)"), "{:?}", bench.painted());
    bench.touch("修整点 X (机床) #760");
    assert!(bench.shows("新砂轮的值，已修整 0.050 → X -320.050"), "{:?}", bench.painted());
    tell(&mut bench.rig, "mode jog\npage position\nkey f1\nkey address-x\nkey input\npage grinding");
    bench.turn();
    let at = bench.rig.snapshot().axes[Axis::X].machine;
    assert!(bench.shows(&format!("修整点 X {at:.3} 按键 · Z -60.000 数值")), "{:?}", bench.painted());
    assert!(
        bench.shows(&format!("按键设置的点有效 X {at:.3} · #760 -320.000 未用")),
        "the value that does not count says so: {:?}",
        bench.painted()
    );
    bench.write("-55.5");
    bench.press(egui::Key::Enter);
    assert_eq!(bench.message(), "#760 = -55.500，未用：按键设置的修整点有效");
    tell(&mut bench.rig, "set #760 = -320");
    bench.turn();
    // The field shows the point that acts, as the line above it does.
    let words = format!("{at:.3}");
    assert!(bench.painted().contains(&words) && !bench.painted().iter().any(|text| text == "-320.000"));
    tell(&mut bench.rig, "load O1012");
    bench.turn();
    assert!(bench.shows(&format!("修整点 X {at:.3} 按键")));
}

#[test]
fn k4_2_a_point_that_was_set_by_key_is_where_the_wheel_is_dressed() {
    let mut bench = bench(Page::Grinding);
    // The values of the page are somewhere else, off the diamond.
    tell(&mut bench.rig, "set #760 = -300\nset #761 = -30");
    tell(&mut bench.rig, SET_AT_DIAMOND);
    bench.turn();
    assert!(bench.shows("修整点 X -320.000 按键 · Z -60.000 按键"));
    tell(&mut bench.rig, "mode auto\nkey cycle-start\nwait until idle max 200 s\nexpect no alarm");
    for (slice, mm) in bench.rig.machine().rim_wear_mm().iter().enumerate() {
        assert!((mm - 0.025).abs() < 0.001, "slice {slice} is {mm} mm back");
    }
    bench.turn();
    assert!(bench.shows("X -320.050 按键"), "it follows the wheel");
}

#[test]
fn k4_2_without_any_point_it_says_so_and_nothing_moves() {
    let mut bench = bench(Page::Grinding);
    for (axis, variable, alarm) in [("X", 760, 3037), ("Z", 761, 3039)] {
        tell(&mut bench.rig, &format!("set #{variable} ="));
        bench.turn();
        assert!(bench.shows(&format!("{axis} 未设置")), "{:?}", bench.painted());
        let before = bench.rig.machine().slide_mm();
        tell(&mut bench.rig, "mode auto\nkey cycle-start\nwait until alarm max 5 s");
        tell(
            &mut bench.rig,
            &format!("expect alarm {alarm}\nexpect alarm \"没有 {axis} 修整点\"\nexpect output wheel off"),
        );
        assert_eq!(bench.rig.machine().slide_mm(), before, "{axis}");
        tell(&mut bench.rig, &format!("key reset\nset #{variable} = -60\nset #760 = -320"));
    }
}

/// With P98 other than −1 the point set by key does not follow the wheel: the dressing after this one would cut air.
#[test]
fn k4_2_a_point_set_by_key_that_does_not_follow_the_wheel_is_refused() {
    for side in [0, 1] {
        let mut bench = bench(Page::Grinding);
        tell(&mut bench.rig, SET_AT_DIAMOND);
        tell(&mut bench.rig, &format!("param P98 {side}"));
        for program in [1_011, 1_012] {
            let before = bench.rig.machine().slide_mm();
            tell(
                &mut bench.rig,
                &format!("load O{program}\nset #787 = 2\nset #784 = 0.02\nset #785 = 0.02\nset #786 = 100"),
            );
            tell(&mut bench.rig, "mode auto\nkey cycle-start\nwait until alarm max 5 s\nexpect alarm 3026");
            tell(&mut bench.rig, "expect alarm \"P98\"\nexpect output wheel off\nkey reset");
            assert_eq!(bench.rig.machine().slide_mm(), before, "O{program}");
            bench.turn();
            assert!(bench.shows("X -320.000 按键，不能用 (P98)"), "{:?}", bench.painted());
        }
        // The value of the page is that of a new wheel less what was dressed: it does not depend on P98.
        tell(&mut bench.rig, "page dressing");
        bench.turn();
        bench.touch("清除修整点 clear-dress-points");
        bench.touch("清除 question-clear-points");
        tell(&mut bench.rig, "load O1011\nmode auto\nkey cycle-start\nwait until idle max 200 s\nexpect no alarm");
    }
}

/// The same on the wheel axis of the other kinds; a point at machine zero is nowhere near a dresser.
#[test]
fn k4_2_the_wheel_axis_of_each_kind_is_checked() {
    for (kind, program, letter) in [(Kind::Gc, 1_011, "x"), (Kind::Gs, 1_013, "y"), (Kind::Ga, 1_014, "z")] {
        let mut rig = ready_of(kind);
        tell(&mut rig, &format!("load O{program}\npart assets/parts/O{program}.ron\nmode mdi\nmdi G53 G00 {letter}0"));
        tell(&mut rig, "wait until idle\nmode jog\npage position\nkey f1");
        tell(&mut rig, &format!("key address-{letter}\nkey input\nexpect message \"成功\""));
        for (side, alarm) in [(-1, 3_027), (1, 3_026)] {
            tell(&mut rig, &format!("param P98 {side}\nmode auto\nkey cycle-start\nwait until alarm max 5 s"));
            tell(&mut rig, &format!("expect alarm {alarm}\nexpect output wheel off\nkey reset"));
        }
    }
}

#[test]
fn k4_2_points_set_by_key_are_cleared_on_the_dressing_page_only_when_asked() {
    let mut bench = bench(Page::Dressing);
    assert!(!bench.shows("清除修整点"), "there is none");
    tell(&mut bench.rig, "mode jog\npage position\nkey f1\nkey address-x\nkey input\npage dressing");
    bench.turn();
    bench.screen.key_press_modifiers(egui::Modifiers::CTRL, egui::Key::D);
    bench.turn();
    bench.press(egui::Key::Escape);
    assert!(bench.rig.snapshot().dressing_point[Axis::X].is_some());
    bench.touch("清除修整点 clear-dress-points");
    bench.touch("清除 question-clear-points");
    assert!(bench.rig.snapshot().dressing_point[Axis::X].is_none());
    assert!(bench.rig.retained().dress_points[Axis::X].is_none(), "and stays cleared after a power-off");
    tell(&mut bench.rig, "page grinding");
    bench.turn();
    assert!(bench.shows("修整点 X -320.000 数值"));
}

/// The assistant takes the place of an axis in JOG alone, and after a question.
#[test]
fn k4_2_the_assistant_takes_the_place_of_an_axis_when_asked() {
    let mut bench = bench(Page::Dressing);
    bench.screen.key_press_modifiers(egui::Modifiers::CTRL, egui::Key::P);
    bench.turn();
    assert!(bench.shows("X -320.000 数值") && bench.shows("Z -60.000 数值"), "{:?}", bench.painted());
    // Not in AUTO.
    tell(&mut bench.rig, "mode auto");
    bench.touch("取此处 X take-point-X");
    bench.touch("设置 question-take-point");
    assert_eq!(bench.message(), "修整点在手动方式下设置");
    assert!(bench.rig.snapshot().dressing_point[Axis::X].is_none());
    tell(&mut bench.rig, "mode jog");
    bench.touch("取此处 X take-point-X");
    bench.touch("取消 question-no");
    assert!(bench.rig.snapshot().dressing_point[Axis::X].is_none(), "not without the answer");
    bench.touch("取此处 X take-point-X");
    bench.touch("设置 question-take-point");
    let at = bench.rig.snapshot().axes[Axis::X].machine;
    assert_eq!(bench.rig.snapshot().dressing_point[Axis::X].map(f64::to_bits), Some(at.to_bits()));
    assert!(bench.rig.retained().dress_points[Axis::X].is_some(), "and it is kept");
    bench.turn();
    assert!(bench.shows(&format!("X {at:.3} 按键")), "{:?}", bench.painted());
}

#[test]
fn k4_2_an_axis_without_a_place_or_in_a_run_is_not_taken() {
    let mut bench = bench(Page::Dressing);
    let take = |bench: &mut Bench| {
        let at = bench.rig.snapshot().axes[Axis::X].machine;
        Command::Page(PageCommand::TakeDressPoint(Axis::X, at))
    };
    tell(&mut bench.rig, "mode mdi\nmdi G01 X200 F10\nwait 1 s\nkey feed-hold\nwait 1 s");
    let asked = take(&mut bench);
    bench.rig.send(asked);
    bench.turn();
    assert!(bench.rig.snapshot().dressing_point[Axis::X].is_none(), "a run is open");
    // The axis is somewhere else than the question said, by the least step.
    tell(&mut bench.rig, "key reset\nmode jog");
    let asked = take(&mut bench);
    tell(&mut bench.rig, "handwheel X 1 x0.001\nwait 1 s\nmode jog");
    bench.rig.send(asked);
    bench.turn();
    assert_eq!(bench.message(), "X 轴已移动：再按一次取此处");
    assert!(bench.rig.snapshot().dressing_point[Axis::X].is_none());
    tell(&mut bench.rig, "key reset\npower cut\nwait 1 s\npower on\nwait 1 s\nmode jog");
    let asked = take(&mut bench);
    bench.rig.send(asked);
    bench.turn();
    assert_eq!(bench.message(), "X 轴未回零，不能设置修整点");
    assert!(bench.rig.snapshot().dressing_point[Axis::X].is_none());
}

/// DRESS NOW makes the dressing the next cycle start and moves nothing; behind it the part comes back.
#[test]
fn k5_17_the_assistant_leads_to_the_dressing_and_back_to_the_part() {
    let mut rig = ready();
    tell(&mut rig, "load O1002\npart assets/parts/O1002.ron");
    let mut bench = Bench::new(rig, Page::Dressing);
    bench.screen.key_press_modifiers(egui::Modifiers::CTRL, egui::Key::P);
    bench.turn();
    // Depth 0.005, √(8·0.5·0.005) = 0.1414 mm; 60 mm/min at 1100 rpm is 0.0545 mm: 2.6.
    assert!(bench.shows("导程 0.055 mm · 1100 r/min") && bench.shows("重叠 2.6 · 开放，粗磨"), "{:?}", bench.painted());
    tell(&mut bench.rig, "set #768 = 150");
    bench.turn();
    assert!(bench.shows("导程 0.136 mm") && bench.shows("重叠 1.0 · 太快：工件有纹"), "{:?}", bench.painted());
    bench.touch("O1012 dressing-program-1012");
    assert_eq!(bench.rig.snapshot().program.number, 1_002, "only its values are shown");
    bench.touch("O1011 dressing-program-1011");
    bench.touch("现在修整 dress-now");
    let snapshot = bench.rig.snapshot();
    assert_eq!((snapshot.program.number, snapshot.mode), (1_011, Mode::Auto));
    assert_eq!(snapshot.state, RunState::Idle, "cycle start starts it, nothing else");
    bench.touch("返回 O1002 back-to-part");
    assert_eq!(bench.rig.snapshot().program.number, 1_002);
    bench.turn();
    assert!(!bench.shows("返回 O1002"), "{:?}", bench.painted());
}

/// A held part: the dressing is not loaded, and the mode stays, so that cycle start goes on with nothing but the part.
#[test]
fn k5_17_the_assistant_loads_nothing_in_an_open_run() {
    let mut rig = ready();
    tell(
        &mut rig,
        "load O1002\npart assets/parts/O1002.ron\nmode auto\nkey cycle-start\nwait 6 s\nkey feed-hold\nwait 1 s\nexpect state held",
    );
    let mut bench = Bench::new(rig, Page::Dressing);
    bench.screen.key_press_modifiers(egui::Modifiers::CTRL, egui::Key::P);
    bench.turn();
    tell(&mut bench.rig, "mode handwheel");
    bench.touch("现在修整 dress-now");
    let snapshot = bench.rig.snapshot();
    assert_eq!((snapshot.program.number, snapshot.mode), (1_002, Mode::Handwheel));
    assert!(snapshot.program.is_open, "the part can go on");
}

#[test]
fn k5_17_a_new_wheel_has_no_dressing_point_on_its_axis() {
    let mut bench = bench(Page::Wheel);
    tell(
        &mut bench.rig,
        "set #800 = -70\nset #820 = -80\nmode jog\npage position\nkey f1\nkey address-x\nkey input\nkey address-z\nkey input\npage wheel",
    );
    bench.turn();
    for value in ["500", "25", "35"] {
        bench.write(value);
        bench.press(egui::Key::Enter);
    }
    bench.touch("已换砂轮 wheel-changed");
    bench.touch("确认 wheel-confirm");
    let points = bench.rig.snapshot().dressing_point;
    assert!(points[Axis::X].is_none() && points[Axis::Z].is_some(), "the diamond is where it was along the axis");
    // The value of the page was that of the old wheel. Pages of other kinds keep theirs.
    let variable = |bench: &mut Bench, number: usize| bench.rig.snapshot().variables[number];
    assert_eq!((variable(&mut bench, 760), variable(&mut bench, 761)), (None, Some(-60.0)));
    assert_eq!((variable(&mut bench, 800), variable(&mut bench, 820)), (Some(-70.0), Some(-80.0)));
    assert_eq!(bench.rig.retained().variables.get(760), Ok(None), "also after a power-off");
    assert!(bench.message().contains("#760 = -320"), "{}", bench.message());
    tell(&mut bench.rig, "page grinding\nmode auto\nkey cycle-start\nwait until alarm max 5 s\nexpect alarm 3037");
    tell(&mut bench.rig, "expect output wheel off");
}
