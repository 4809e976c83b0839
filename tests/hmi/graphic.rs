//! The drawing with the real core and its check run behind it.

use crate::live_screen::Bench;
use egui_kittest::kittest::Queryable;
use kt830::defs::key::Key;
use kt830::defs::page::Page;
use kt830::link::Command;
use kt830::link::files::{FileRequest, Requester, Ticket};
use kt830::link::page_command::PageCommand;
use kt830::link::snapshot::RunState;
use kt830::link::toolpath::{CycleTime, MoveKind};
use kt830::units::Axis;

fn bench(text: &str) -> Bench {
    let mut bench = Bench::new(crate::stories::ready_with(text), Page::Graphic);
    bench.touch("重算 graphic-redraw");
    bench
}

#[test]
fn b6_path_time_and_extents_are_there_before_the_first_start() {
    // X is a diameter: 10 mm of slide at 60 mm/min are 10 s, 20 mm along Z 20 s; rapids come on top.
    let mut bench = bench("G00 X40 Z5\nG01 X20 F60\nG01 Z-15\nM30\n");
    bench.turn();
    let drawing = bench.rig.snapshot().files.toolpath.clone().expect("a drawing");
    let (low, high) = drawing.extents.unwrap();
    // From wherever the machine stands to X40 Z5, then the two cuts.
    let at: Vec<[f32; 3]> = drawing.levels[0].points.iter().map(|point| point.at).collect();
    assert_eq!(at[1..], [[20.0, 0.0, 5.0], [10.0, 0.0, 5.0], [10.0, 0.0, -15.0]]);
    assert!(low[Axis::X] <= 10.0 && low[Axis::Z] <= -15.0 && high[Axis::X] >= 20.0 && high[Axis::Z] >= 5.0);
    let seconds = drawing.cycle_time.seconds();
    assert!(drawing.finished && seconds > 30.0 && seconds < 60.0, "{seconds}");
    let ways: Vec<MoveKind> = drawing.levels[0].points.iter().map(|point| point.kind).collect();
    assert_eq!(ways, [MoveKind::Break, MoveKind::Rapid, MoveKind::Feed, MoveKind::Feed]);
    // As a diameter, as everywhere.
    let (least, most) = (format!("{:.3}", low[Axis::X] * 2.0), format!("{:.3}", high[Axis::X] * 2.0));
    assert!(bench.shows(&least) && bench.shows(&most) && bench.shows("检查无错误"));
}

#[test]
fn b6_the_time_is_that_of_a_run_on_the_machine() {
    let mut bench = bench("G64\nM08\nG01 U-10 F60\nW-20\nG04 P500\nM30\n");
    bench.turn();
    let drawing = bench.rig.snapshot().files.toolpath.clone().expect("a drawing");
    let CycleTime::Simulated(seconds) = drawing.cycle_time else { panic!("{:?}", drawing.cycle_time) };
    bench.rig.send(Command::Press(Key::CycleStart));
    let started = bench.rig.now();
    (0..10).for_each(|_| bench.rig.step());
    while bench.rig.controller().state() != RunState::Idle {
        bench.rig.step();
        assert!(bench.rig.now().since(started).as_secs_f64() < 60.0, "{:?}", bench.rig.snapshot().alarms);
    }
    let ran = bench.rig.now().since(started).as_secs_f64();
    // 5 mm of slide and 20 mm at 60 mm/min, and the dwell.
    assert!(ran > 25.5 && (seconds / ran - 1.0).abs() < 0.03 && bench.shows("循环时间"), "{seconds} for {ran}");
}

#[test]
fn b6_a_program_that_needs_an_operator_has_the_time_of_its_feeds() {
    // M81 waits for an input that nobody gives.
    let mut bench = bench("G00 X40 Z5\nG01 X20 F60\nM81\nM30\n");
    bench.turn();
    let drawing = bench.rig.snapshot().files.toolpath.clone().expect("a drawing");
    let CycleTime::AtFeeds(seconds) = drawing.cycle_time else { panic!("{:?}", drawing.cycle_time) };
    assert!((10.0..20.0).contains(&seconds) && bench.shows("进给时间"), "{seconds}");
}

#[test]
fn b6_an_arc_is_drawn_round() {
    // A quarter of 10 mm radius about X(diameter)40 Z0: no chord lies more than 2 µm off it.
    let mut bench = bench("G00 X40 Z10\nG03 X60 Z0 I0 K-10 F100\nM30\n");
    bench.turn();
    let drawing = bench.rig.snapshot().files.toolpath.clone().expect("a drawing");
    assert_eq!(drawing.faults, []);
    let feeds: Vec<[f32; 3]> =
        drawing.levels[0].points.iter().filter(|p| p.kind == MoveKind::Feed).map(|p| p.at).collect();
    assert!(feeds.len() > 10, "{}", feeds.len());
    for pair in feeds.windows(2) {
        let middle = [f32::midpoint(pair[0][0], pair[1][0]), f32::midpoint(pair[0][2], pair[1][2])];
        let radius = (middle[0] - 20.0).hypot(middle[1]);
        assert!((radius - 10.0).abs() < 0.0025, "{radius}");
    }
}

#[test]
fn b6_mistakes_and_changes_are_told() {
    let mut bench = bench("G00 X10\nG999\nM30\n");
    bench.turn();
    assert!(bench.shows("行 2:"), "the line of the mistake");
    // Another text of the same number is drawn anew by itself.
    bench.rig.add_program(kt830::host::folders::program_from_bytes(
        7_000,
        "O7000.NC",
        b"G00 X10\nM30\n".to_vec(),
        bench.rig.kind().dialect(),
    ));
    (0..4).for_each(|_| bench.turn());
    assert!(bench.shows("检查无错误"));
}

#[test]
fn h8_what_does_not_end_is_left_and_a_missing_program_is_refused() {
    let mut bench = bench("N1 G00 X10\nGOTO 1\nM30\n");
    bench.turn();
    assert!(bench.shows("未到程序结束") || bench.shows("检查无错误"));
    bench.rig.send(Command::Page(PageCommand::File(
        Ticket::without_reply(Requester::Graphic),
        FileRequest::ComputeToolpath(4_321),
    )));
    bench.turn();
    assert!(bench.message().contains("O4321"), "{}", bench.message());
}

#[test]
fn h9_keys_and_fingers_zoom_and_fit() {
    let mut bench = bench("G00 X40 Z5\nG01 X20 F60\nG01 Z-15\nM30\n");
    bench.turn();
    let painted = |bench: &Bench| format!("{:?}", bench.screen.output().shapes.len());
    let grid = |bench: &Bench| ["10", "20", "-10", "0", "4"].map(|words| bench.shows(words));
    let before = (painted(&bench), grid(&bench));
    for _ in 0..6 {
        bench.touch("放大 + graphic-in");
    }
    assert_ne!((painted(&bench), grid(&bench)), before);
    bench.touch("适合 graphic-fit");
    assert_eq!((painted(&bench), grid(&bench)), before);
    bench.write("+++++++");
    assert_ne!((painted(&bench), grid(&bench)), before);
    bench.write("F");
    assert_eq!((painted(&bench), grid(&bench)), before);
    assert!(bench.screen.query_by_label("平面 graphic-plane").is_none(), "GC is looked at from above alone");
}
