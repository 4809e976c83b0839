//! The pages of the simulator and the process with the simulated machine behind them.

use std::fs;

use crate::live_screen::Bench;
use kt830::defs::page::Page;
use kt830::defs::signal::Input;
use kt830::defs::text::Lang;
use kt830::hmi::page_text;
use kt830::link::Command;

#[test]
fn p3_inputs_are_forced_and_faults_come_and_go_by_touch() {
    let mut bench = Bench::new(crate::stories::ready(), Page::Simulator);
    let on = |bench: &mut Bench| {
        crate::stories::tell(&mut bench.rig, "wait 0.1 s");
        bench.rig.snapshot().inputs.has(Input::HydraulicPressure)
    };
    assert!(on(&mut bench));
    bench.touch("自由 hydraulic-pressure");
    assert!(!on(&mut bench), "forced off");
    bench.turn();
    bench.touch("强制 0 hydraulic-pressure");
    assert!(on(&mut bench), "free again");
    bench.touch("故障 sim-faults");
    bench.touch("X 驱动故障 drive-x");
    crate::stories::tell(&mut bench.rig, "wait 0.2 s\nexpect alarm any");
    bench.turn();
    bench.touch("X 驱动故障 drive-x");
    crate::stories::tell(&mut bench.rig, "wait 0.2 s\nkey reset\nwait 0.2 s\nexpect no alarm");
}

#[test]
fn p1_a_real_machine_has_no_simulator() {
    let texts = page_text(&crate::sample::snapshot(Page::Simulator), Lang::Zh);
    assert!(texts.iter().any(|text| text.contains("没有模拟机床")), "{texts:?}");
}

#[test]
fn h9_the_process_is_kept_as_a_table() {
    let folder = tempfile::tempdir().unwrap();
    let mut rig = crate::stories::ready();
    rig.set_drives(Some(folder.path().to_owned()), None);
    let mut bench = Bench::new(rig, Page::Process);
    for _ in 0..20 {
        crate::stories::tell(&mut bench.rig, "wait 0.1 s");
        bench.turn();
    }
    bench.touch("存为 CSV process-export");
    assert!(bench.message().contains("已保存"), "{}", bench.message());
    let file = fs::read_dir(folder.path()).unwrap().next().expect("a file").unwrap().path();
    let text = fs::read_to_string(file).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    // GC has no Y unless one is fitted.
    assert!(lines[0].starts_with("seconds,X,Z,") && lines.len() > 15, "{text}");
    // An empty line stands between the samples and the parts.
    let (samples, parts) = lines.split_at(lines.iter().position(|line| line.is_empty()).unwrap());
    let columns = |of: &[&str], count: usize| of.iter().all(|line| line.split(',').count() == count);
    assert!(columns(samples, 6) && columns(&parts[1..], 11), "{text}");
    bench.touch("清除 process-clear");
    bench.rig.send(Command::OpenPage(Page::Position));
    bench.turn();
}

/// Curves of some tens of samples.
fn curves(bench: &Bench) -> usize {
    let is_long = |shape: &egui::Shape| matches!(shape, egui::Shape::Path(path) if path.points.len() > 40);
    bench.screen.output().shapes.iter().filter(|clipped| is_long(&clipped.shape)).count()
}

fn run(bench: &mut Bench, story: &str, seconds: u32) {
    crate::stories::tell(&mut bench.rig, story);
    for _ in 0..10 * seconds {
        crate::stories::tell(&mut bench.rig, "wait 0.1 s");
        bench.turn();
    }
}

const NEW_PART: &str = "part assets/parts/O1002.ron\nmode auto\nkey cycle-start\nwait 0.2 s\nexpect state running";

/// Parts of O1002, Ø40.3 to Ø40: the wheel's way to the finished size, the removal rate with the rate at which hardened steel burns
/// (2.65 mm³/(mm·s), `technology::burn`), the load. Behind them the last counted part: not a cycle that was broken off, not an MDI line.
#[test]
fn k4_5_the_cycle_of_a_part_is_seen_against_the_one_before() {
    let mut bench = Bench::new(crate::stories::ready(), Page::Process);
    bench.touch("本件 process-cycle");
    run(&mut bench, &format!("load O1002\n{NEW_PART}"), 60);
    for words in ["砂轮位置 – 成品", "成品 40.000", "粗磨", "精磨", "光磨", "淬硬钢", "烧伤 2.7", "10 s"]
    {
        assert!(bench.shows(words), "{words}: {:?}", bench.painted());
    }
    assert_eq!(curves(&bench), 3, "size, removal rate, load");
    run(&mut bench, NEW_PART, 20);
    assert_eq!(curves(&bench), 6, "those of the part before as well");
    run(&mut bench, "key reset\nwait 2 s\nmode mdi\nmdi G04 X1\nwait 2 s", 1);
    run(&mut bench, NEW_PART, 20);
    assert_eq!(curves(&bench), 6, "still those of the part that was finished");
    bench.touch("本件 process-cycle");
    assert!(!bench.shows("砂轮位置 – 成品"), "the same key goes back to the curves of the clock");
}

/// A traverse grinds by its strokes, not by the feed of X.
#[test]
fn k4_5_a_traverse_has_no_removal_rate_of_a_plunge() {
    let mut bench = Bench::new(crate::stories::ready(), Page::Process);
    bench.touch("本件 process-cycle");
    run(&mut bench, "load O1003\npart assets/parts/O1003.ron\nmode auto\nkey cycle-start", 30);
    assert!(bench.shows("砂轮位置 – 成品") && !bench.shows("Q'w"), "{:?}", bench.painted());
}
