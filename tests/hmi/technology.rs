//! Technology page: proposals for a plunge beside the values in force, taken over by touch (row K7.5).

use kt830::defs::page::Page;
use kt830::host::headless::HeadlessHost;

use crate::live_screen::Bench;
use crate::stories::{ready, tell};

fn bench(mut rig: HeadlessHost, story: &str) -> Bench {
    tell(&mut rig, story);
    Bench::new(rig, Page::Technology)
}

fn variable(bench: &mut Bench, number: usize) -> Option<f64> {
    bench.rig.snapshot().variables[number]
}

/// The values of O1002's part: hand-computed in `technology::plunge`.
#[test]
fn k7_5_the_proposals_are_taken_over_together_or_one_by_one() {
    let mut bench = bench(ready(), "load O1002\npart assets/parts/O1002.ron");
    assert!(bench.shows("烧伤") && bench.shows("1.01") && bench.shows("粗糙度"));
    let before = [524, 525, 526, 527, 528, 531].map(|number| variable(&mut bench, number));
    assert_eq!(before, [0.4, 0.05, 1.2, 0.3, 6.0, 10.0].map(Some));
    bench.touch("take #526");
    bench.turn();
    let one = [526, 527].map(|number| variable(&mut bench, number));
    assert_eq!(one, [Some(1.01), Some(0.3)], "that row only");
    bench.touch("采用 (4) technology-take");
    bench.turn();
    let all = [524, 525, 526, 527, 528, 531].map(|number| variable(&mut bench, number));
    assert_eq!(all, [0.4, 0.02, 1.01, 0.23, 1.5, 26.0].map(Some));
    assert!(bench.shows("已采用"));
}

#[test]
fn k7_5_the_task_is_typed_and_a_material_is_touched_on() {
    let mut bench = bench(ready(), "load O1002\npart assets/parts/O1002.ron");
    assert!(bench.shows("淬硬钢"));
    for name in ["调质钢、软钢", "不锈钢", "高速钢", "铸铁", "淬硬钢"] {
        bench.touch("field P470");
        assert!(bench.shows(name), "{name}");
    }
    bench.touch("field P471");
    bench.write("21");
    bench.press(egui::Key::Enter);
    assert!(bench.shows("磨削宽度大于砂轮宽度"), "a part wider than the wheel is no plunge");
    bench.touch("field P471");
    bench.write("0");
    bench.press(egui::Key::Enter);
    assert!(bench.shows("应为 0.1 … 1000 mm") && (bench.param("P471") - 21.0).abs() < 1e-9);
}

/// 头架 0低速: 60 rpm, at which a part burns earlier; the limits of P377 and P378 come before those of the page.
#[test]
fn k7_5_the_task_is_that_of_headstock_and_tolerance_in_force() {
    let mut bench = bench(ready(), "load O1002\npart assets/parts/O1002.ron\nset #529 = 0");
    // 0.3^(1/3) of 1.0125 is 0.678; five turns at 60 rpm are 5 s.
    assert!(bench.shows("0.67") && bench.shows("5"), "{:?}", bench.painted());
    assert!(bench.shows("0.020"));
    tell(&mut bench.rig, "param P377 0.003\nparam P378 -0.002");
    bench.turn();
    assert!(bench.shows("0.005"), "{:?}", bench.painted());
}

/// O1004 is ended by its gauge: roughing, finishing and the interval of dressing; 半精磨速度 is no finishing.
#[test]
fn k7_5_a_page_is_proposed_what_it_has() {
    let mut bench = bench(ready(), "load O1004\npart assets/parts/O1004.ron");
    bench.turn();
    let painted = bench.painted();
    let has = |name: &str| painted.iter().any(|words| words.starts_with(name));
    assert!(has("#626") && has("#628") && has("#631") && !has("#627"), "{painted:?}");
}

#[test]
fn k7_5_without_sizes_nothing_is_proposed() {
    let mut empty = bench(ready(), "load O1002\nset #521 = 0");
    assert!(empty.shows("先在磨削页面输入毛坯和成品直径"));
    empty.turn();
    let mut traverse = bench(ready(), "load O1003");
    assert!(traverse.shows("这个程序没有可建议的数值"));
    traverse.turn();
}

/// In a run the values are locked (K7.7): nothing is set.
#[test]
fn k7_7_nothing_is_taken_over_in_a_run() {
    let mut bench = bench(ready(), "load O1002\npart assets/parts/O1002.ron\nmode auto\nkey cycle-start\nwait 5 s");
    let before = variable(&mut bench, 526);
    bench.touch("take #526");
    bench.turn();
    bench.touch("采用 (5) technology-take");
    bench.turn();
    assert_eq!((before, variable(&mut bench, 526)), (Some(1.2), Some(1.2)));
}
