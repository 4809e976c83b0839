//! The end of a cycle shows the part on the grinding page: size, tolerance, verdict and time, until the next cycle start
//! or a touch. Source: spec K7.2, K4.5, H8.

use egui_kittest::kittest::Queryable;
use kt830::defs::page::Page;
use kt830::defs::page_meaning::SizeKind;
use kt830::defs::text::{Lang, LocalizedText};
use kt830::hmi::page_text;
use kt830::host::folders::program_from_bytes;
use kt830::link::Command;
use kt830::link::part_result::{CorrectionAdvice, NominalSize, OffsetInForce, PartCommand, PartResult};
use kt830::link::simulation::{PartSize, SimCommand};
use kt830::units::{Axis, Micros};

use crate::live_screen::Bench;
use crate::sample::{part_result, snapshot};
use crate::stories::{ready, tell};

/// A ready machine with the part of O1002, Ø40.3, and a program of that number.
fn bench(text: &str) -> Bench {
    let mut rig = ready();
    let program = format!("{text}\nM31\nM30");
    rig.add_program(program_from_bytes(1_002, "O1002.NC", program.into_bytes(), rig.kind().dialect()));
    tell(&mut rig, "load O1002\npart assets/parts/O1002.ron\nset #532 = 0.01\nset #533 = -0.01");
    Bench::new(rig, Page::Grinding)
}

fn run(bench: &mut Bench) {
    tell(&mut bench.rig, "mode auto\nkey cycle-start\nwait until idle max 20 s\nexpect no alarm");
    bench.turn();
}

#[test]
fn k7_2_the_end_of_a_cycle_shows_the_simulated_part_with_its_verdict() {
    let mut bench = bench("G04 P1500");
    tell(&mut bench.rig, "set #521 = 40.3");
    assert!(!bench.shows("工件 1"), "nothing is finished yet");
    run(&mut bench);
    for words in ["工件 1", "40.300", "合格", "40.300 +0.010 -0.010", "仿真 直径 Z", "00:01"] {
        assert!(bench.shows(words), "{words}: {:?}", bench.painted());
    }
    // The next cycle start takes it away; the same part against another nominal size is out.
    tell(&mut bench.rig, "set #521 = 40.28\nkey cycle-start\nwait 0.2 s\nexpect state running");
    bench.turn();
    assert!(!bench.shows("工件 1") && !bench.shows("合格"));
    tell(&mut bench.rig, "wait until idle max 20 s");
    bench.turn();
    assert!(bench.shows("工件 2") && bench.shows("超差"));
    // It stays as it was measured: values that are typed and a new blank do not change it.
    tell(&mut bench.rig, "set #521 = 40.3");
    bench.rig.send(Command::Simulate(SimCommand::NewPart));
    bench.turn();
    assert!(bench.shows("超差") && bench.shows("40.280 +0.010 -0.010"));
}

/// The wheel is 20 mm wide and the seat reaches from 30 to 48: from Z20 it covers 20 to 40, from Z27 all but the last
/// millimetre.
#[test]
fn k7_2_a_seat_that_is_ground_in_part_is_out_of_tolerance() {
    for place in [20, 27] {
        let mut rig = ready();
        tell(&mut rig, &format!("load O1002\npart assets/parts/O1002.ron\nset #523 = {place}"));
        let mut bench = Bench::new(rig, Page::Grinding);
        tell(&mut bench.rig, "mode auto\nkey cycle-start\nwait until idle max 200 s\nexpect no alarm");
        bench.turn();
        assert!(bench.shows("局部超差") && bench.shows("仿真 直径 Z"), "{:?}", bench.painted());
        assert!(!bench.shows("合格"));
        // The worst place is shown: the stock of 40.3 and its waviness.
        let sizes = &bench.rig.snapshot().simulated.as_ref().unwrap().finished_sizes;
        let (least, greatest) =
            sizes.iter().fold((f64::MAX, f64::MIN), |(low, high), at| (low.min(at.mm), high.max(at.mm)));
        assert!((least - 40.0).abs() < 0.004 && (greatest - 40.3).abs() < 0.02, "{least} {greatest}");
        assert!(bench.shows(&format!("{greatest:.3}")));
    }
}

/// O1010 grinds the top of a ring on the rotary table: its face is the height that the page names.
#[test]
fn k7_2_a_part_on_the_rotary_table_has_a_height() {
    let mut rig = crate::stories::ready_of(kt830::defs::kind::Kind::Ga);
    let program = program_from_bytes(1_010, "O1010.NC", b"G04 P100\nM31\nM30".to_vec(), rig.kind().dialect());
    rig.add_program(program);
    tell(&mut rig, "load O1010\npart assets/parts/O1010.ron\nset #752 = 0.01\nset #753 = -0.01");
    let mut bench = Bench::new(rig, Page::Grinding);
    run(&mut bench);
    let painted = bench.painted();
    assert!(painted.iter().any(|text| text == "超差") && bench.shows("仿真 高度 X"), "{painted:?}");
}

/// A part has several surfaces; the one nearest to the nominal size counts, with its worst place.
#[test]
fn k4_5_the_verdict_is_that_of_the_worst_place_of_one_surface() {
    let size = |kind, surface, mm| PartSize { kind, name: LocalizedText::same(""), surface, mm };
    let diameter = |surface: usize, mm| size(SizeKind::Diameter, Some(surface), mm);
    let nominal = |kind| NominalSize { kind, mm: 40.0, limits: Some((39.99, 40.01)) };
    let of_kind = |kind, sizes: &[PartSize]| {
        nominal(kind).compare(sizes).map(|compared| (compared.worst.mm, compared.keeps_elsewhere))
    };
    let compared = |sizes: &[PartSize]| of_kind(Some(SizeKind::Diameter), sizes);
    assert_eq!(compared(&[diameter(0, 40.002), diameter(0, 39.993), diameter(1, 60.0)]), Some((39.993, true)));
    assert_eq!(compared(&[diameter(0, 40.3), diameter(0, 40.0), diameter(0, 40.05)]), Some((40.3, true)));
    assert_eq!(compared(&[diameter(0, 40.3), diameter(0, 40.05)]), Some((40.3, false)));
    // Beyond a limit counts before far from the nominal size: 40 +0.005 −0.015 with 39.987 and 40.008.
    let uneven = NominalSize { kind: None, mm: 40.0, limits: Some((39.985, 40.005)) };
    let pair = [diameter(0, 39.987), diameter(0, 40.008)];
    assert_eq!(uneven.compare(&pair).map(|compared| compared.worst.mm), Some(40.008));
    // The place of a face is no length, and a bar is turned to many sizes.
    assert_eq!(compared(&[size(SizeKind::Length, Some(0), 40.0), size(SizeKind::Height, Some(1), 40.0)]), None);
    assert_eq!(of_kind(Some(SizeKind::Length), &[size(SizeKind::Length, Some(0), 40.0)]), None);
    assert_eq!(compared(&[size(SizeKind::Diameter, None, 40.0)]), None);
    // A size that only a parameter names is compared with any surface.
    assert_eq!(of_kind(None, &[size(SizeKind::Height, Some(0), 40.1)]), Some((40.1, false)));
    assert_eq!(of_kind(None, &[size(SizeKind::Length, Some(0), 40.0), diameter(1, 40.3)]), Some((40.3, false)));
}

/// A typed value leaves the number pad open on the next one; it must not lie on the part.
#[test]
fn k7_2_the_number_pad_makes_way_when_a_run_begins() {
    let mut bench = bench("G04 P1500");
    bench.write("40.3");
    bench.press(egui::Key::Enter);
    bench.touch("毛坯直径 #520");
    assert!(bench.screen.query_by_label("pad-0").is_some());
    tell(&mut bench.rig, "mode auto\nkey cycle-start\nwait 0.2 s\nexpect state running");
    bench.turn();
    assert!(bench.screen.query_by_label("pad-0").is_none());
    tell(&mut bench.rig, "wait until idle max 20 s");
    bench.turn();
    assert!(bench.shows("工件 1"));
}

/// With P6.3=1 a value may be typed in the run: the pad that is left open must not lie on the part either.
#[test]
fn k7_2_the_number_pad_makes_way_for_the_part() {
    let mut bench = bench("G04 P1500");
    tell(&mut bench.rig, "param P6.3 1\nmode auto\nkey cycle-start\nwait 0.2 s\nexpect state running");
    bench.turn();
    bench.touch("毛坯直径 #520");
    assert!(bench.screen.query_by_label("pad-0").is_some());
    tell(&mut bench.rig, "wait until idle max 20 s");
    bench.turn();
    assert!(bench.screen.query_by_label("pad-0").is_none() && bench.shows("工件 1"), "{:?}", bench.painted());
}

#[test]
fn k7_2_a_touch_or_cancel_dismisses_the_part() {
    let mut bench = bench("G04 P100");
    run(&mut bench);
    bench.touch("超差 part-result");
    assert!(!bench.shows("工件 1") && bench.screen.query_by_label("超差 part-result").is_none());
    run(&mut bench);
    assert!(bench.shows("工件 2"), "the next one is shown again");
    bench.press(egui::Key::Escape);
    assert!(!bench.shows("工件 2"));
}

#[test]
fn k4_5_a_size_that_the_program_has_measured_is_that_of_the_part() {
    let mut bench = bench("G04 P100\n#540=40.004");
    tell(&mut bench.rig, "param P375 540\nset #521 = 40");
    run(&mut bench);
    assert!(bench.shows("40.004") && bench.shows("实测") && bench.shows("合格") && !bench.shows("仿真"));
}

#[test]
fn k7_2_without_a_gauge_a_real_machine_says_not_measured() {
    let mut machine = snapshot(Page::Grinding);
    assert!(machine.simulated.is_none());
    machine.cycle.part = Some(part_result());
    let texts = page_text(&machine, Lang::Zh);
    let says = |words: &str| texts.iter().any(|text| text == words);
    assert!(says("未测量") && says("40.000 +0.005 -0.015") && says("工件 12") && says("01:24"), "{texts:?}");
    assert!(!says("合格") && !says("超差") && texts.iter().all(|text| !text.contains("仿真")));
}

#[test]
fn k7_2_what_ends_without_a_part_shows_none() {
    // RESET, and a dressing program.
    let mut bench = bench("G04 P5000");
    tell(&mut bench.rig, "mode auto\nkey cycle-start\nwait 0.5 s\nkey reset\nwait 0.5 s\nexpect state idle");
    bench.turn();
    assert!(!bench.shows("工件 0") && bench.rig.snapshot().cycle.part.is_none());
    tell(&mut bench.rig, "param P91 1002\nparam P92 1002");
    run(&mut bench);
    assert!(bench.rig.snapshot().cycle.part.is_none());
    // Machine lock and dry run grind nothing.
    tell(&mut bench.rig, "param P91 1011\nparam P92 1012\nkey dry-run");
    run(&mut bench);
    assert!(bench.rig.snapshot().cycle.part.is_none());
}

#[test]
fn k5_17_the_interval_of_the_page_counts_down_on_the_process_page() {
    let mut bench = bench("G04 P100");
    tell(&mut bench.rig, "set #531 = 10");
    bench.rig.send(Command::OpenPage(Page::Process));
    bench.turn();
    let left = |bench: &Bench| {
        let painted = bench.painted();
        let at = painted.iter().position(|text| text == "距下次修整 件").expect("the row");
        painted[at + 1].clone()
    };
    assert_eq!(left(&bench), "10");
    run(&mut bench);
    assert_eq!(left(&bench), "9");
    // P95 alone counts as well, and the smaller one of both; without any there is nothing to count.
    tell(&mut bench.rig, "param P95 4");
    bench.turn();
    assert_eq!(left(&bench), "3");
    tell(&mut bench.rig, "set #531 = 0\nparam P95 0");
    bench.turn();
    assert_eq!(left(&bench), "—");
}

/// The wear of offset 1, X as displayed.
fn wear(bench: &mut Bench) -> f64 {
    bench.rig.snapshot().offsets.tools[0].wear[Axis::X]
}

#[test]
fn k4_1_a_touch_takes_the_proposed_correction_once() {
    let mut bench = bench("T0101\nG04 P100");
    let before = wear(&mut bench);
    // The part is 40.300. The middle of 40.28 +0.010 -0.010 is 0.02 below it.
    tell(&mut bench.rig, "set #521 = 40.28");
    run(&mut bench);
    assert!(bench.shows("建议修正刀补 1"), "{:?}", bench.painted());
    // The blank is wavy by some micrometres; its worst place counts.
    let label = bench.painted().into_iter().find(|text| text.starts_with("采用 X ")).expect("a correction");
    let shown: f64 = label.trim_start_matches("采用 X ").parse().unwrap();
    assert!((shown + 0.02).abs() < 0.01, "{label}");
    // That of another part is refused.
    bench.rig.send(Command::Part(PartCommand::Correct { ended_at: Micros(1), increment: shown }));
    bench.turn();
    assert!(bench.shows("没有这一件的结果") && wear(&mut bench).to_bits() == before.to_bits());
    bench.touch(&format!("{label} take-correction"));
    assert!((wear(&mut bench) - before - shown).abs() < 1e-9, "{} {label}", wear(&mut bench));
    assert!(bench.shows(&format!("已修正 {shown:+.3}")) && !bench.shows("采用"));
    // The same command again changes nothing.
    let part = bench.rig.snapshot().cycle.part.expect("a part");
    let after = wear(&mut bench);
    bench.rig.send(Command::Part(PartCommand::Correct { ended_at: part.ended_at, increment: -0.02 }));
    bench.turn();
    assert_eq!(wear(&mut bench).to_bits(), after.to_bits());
}

#[test]
fn k4_1_a_size_that_the_operator_types_is_judged_and_corrects() {
    let mut bench = bench("T0101\nG04 P100");
    tell(&mut bench.rig, "set #521 = 40.3\nset #532 = 0.02\nset #533 = 0");
    run(&mut bench);
    let before = wear(&mut bench);
    bench.touch("输入实测尺寸 type-size");
    assert!(bench.screen.query_by_label("pad-0").is_some());
    // A size that cannot be that of the part is refused and stays.
    bench.write("4.03");
    bench.press(egui::Key::Enter);
    assert!(bench.shows("相差 1 mm 以上"), "{:?}", bench.painted());
    bench.write("40.325");
    bench.press(egui::Key::Enter);
    assert!(bench.shows("操作者实测") && bench.shows("40.325") && bench.shows("超差"), "{:?}", bench.painted());
    assert!(bench.screen.query_by_label("pad-0").is_none());
    // To the middle, 40.310, it is 0.015 too large.
    bench.touch("采用 X -0.015 take-correction");
    assert!((wear(&mut bench) - before + 0.015).abs() < 1e-9);
    // The trend of the process page has the size.
    bench.rig.send(Command::OpenPage(Page::Process));
    bench.turn();
    assert!(bench.shows("40.325"), "{:?}", bench.painted());
}

#[test]
fn k4_1_no_correction_is_proposed_where_the_offset_does_not_decide_the_size() {
    let part = || PartResult { typed: Some(40.02), ..part_result() };
    let advice = |part: PartResult| part.advice(None);
    let offset = part().offset.unwrap();
    // 39.985 to 40.005: the middle is 39.995. In diameters 40.02 is 0.025 above it; in radii half of that.
    let by = |advice| match advice {
        CorrectionAdvice::Add(_, by) => by,
        other => panic!("{other:?}"),
    };
    assert!((by(advice(part())) + 0.025).abs() < 1e-9);
    let radii = Some(OffsetInForce { displayed_per_mm: 1.0, ..offset });
    let odd = PartResult { offset: radii, typed: Some(40.021), ..part() };
    assert!((by(advice(odd)) + 0.013).abs() < 1e-9);
    // A height is one side.
    let nominal = part().nominal.map(|nominal| NominalSize { kind: Some(SizeKind::Height), ..nominal });
    let vertical = Some(OffsetInForce { axis: Axis::Y, displayed_per_mm: 1.0, ..offset });
    assert!((by(advice(PartResult { nominal, offset: vertical, ..part() })) + 0.025).abs() < 1e-9);
    let length = part().nominal.map(|nominal| NominalSize { kind: Some(SizeKind::Length), ..nominal });
    let unknown = part().nominal.map(|nominal| NominalSize { kind: None, ..nominal });
    for (part, expected) in [
        (PartResult { gauged: true, ..part() }, CorrectionAdvice::ByGauge),
        (PartResult { measured: Some(40.02), ..part() }, CorrectionAdvice::ByGauge),
        (PartResult { offset: None, ..part() }, CorrectionAdvice::Unknown),
        (PartResult { nominal: None, ..part() }, CorrectionAdvice::Unknown),
        (PartResult { nominal: length, ..part() }, CorrectionAdvice::Unknown),
        (PartResult { typed: None, ..part() }, CorrectionAdvice::Unknown),
        // A tenth of the tolerance of 0.02 is 0.002.
        (PartResult { typed: Some(39.995_4), ..part() }, CorrectionAdvice::Centred),
        (PartResult { typed: Some(39.996_4), ..part() }, CorrectionAdvice::Centred),
        (PartResult { typed: Some(39.998), ..part() }, CorrectionAdvice::Add(offset, -0.003)),
        (PartResult { corrected: Some(-0.025), ..part() }, CorrectionAdvice::Done(-0.025)),
        (PartResult { is_wheel_fresh: false, ..part() }, CorrectionAdvice::MayBeWear),
        (PartResult { nominal: unknown, ..part() }, CorrectionAdvice::Unknown),
    ] {
        assert_eq!(advice(part), expected, "{part:?}");
    }
    assert!(matches!(advice(PartResult { typed: Some(40.3), ..part() }), CorrectionAdvice::TooFar(_)));
}

#[test]
fn k4_1_the_corrected_wheel_grinds_the_next_part_into_the_middle() {
    let mut rig = ready();
    tell(&mut rig, "load O1002\npart assets/parts/O1002.ron\nset #530 = 0");
    // The offset is 0.05 off: the operator touched off badly.
    rig.send(Command::OpenPage(Page::Dressing));
    rig.send(Command::AddWear { number: 1, axis: Axis::X, increment: 0.05 });
    let mut bench = Bench::new(rig, Page::Grinding);
    tell(&mut bench.rig, "mode auto\nkey cycle-start\nwait until idle max 200 s\nexpect no alarm");
    bench.turn();
    assert!(bench.shows("超差"), "{:?}", bench.painted());
    let label = bench.painted().into_iter().find(|text| text.starts_with("采用 X -0.0")).expect("a correction");
    bench.touch(&format!("{label} take-correction"));
    tell(&mut bench.rig, "part assets/parts/O1002.ron\nkey cycle-start\nwait until idle max 200 s\nexpect no alarm");
    bench.turn();
    let snapshot = bench.rig.snapshot();
    let part = snapshot.cycle.part.expect("a part");
    let size = part.judged_size(snapshot.simulated.as_deref()).expect("a size").mm();
    assert!((size - 40.0).abs() < 0.003 && bench.shows("合格"), "{size}");
}

#[test]
fn k4_1_an_offset_that_was_changed_since_is_not_corrected_by_the_part() {
    let mut bench = bench("T0101\nG04 P100");
    tell(&mut bench.rig, "set #521 = 40.28");
    run(&mut bench);
    assert!(bench.shows("采用 X"));
    // The operator has corrected it by hand on the dressing page.
    bench.rig.send(Command::OpenPage(Page::Dressing));
    bench.rig.send(Command::AddWear { number: 1, axis: Axis::X, increment: -0.02 });
    bench.turn();
    bench.rig.send(Command::OpenPage(Page::Grinding));
    bench.turn();
    assert!(!bench.shows("采用 X") && bench.shows("工件 1"), "{:?}", bench.painted());
    let (part, before) = (bench.rig.snapshot().cycle.part.expect("a part"), wear(&mut bench));
    bench.rig.send(Command::Part(PartCommand::Correct { ended_at: part.ended_at, increment: -0.02 }));
    bench.turn();
    assert_eq!(wear(&mut bench).to_bits(), before.to_bits());
    assert!(bench.shows("不由刀补决定"), "{:?}", bench.painted());
}

#[test]
fn k4_1_in_a_run_and_beyond_its_range_no_correction_is_taken() {
    let mut bench = bench("T0101\nG04 P1500");
    tell(
        &mut bench.rig,
        "set #521 = 40.28\nparam P390 2\nmode auto\nkey cycle-start\nwait 2.5 s\nexpect state running",
    );
    let part = bench.rig.snapshot().cycle.part.expect("the part of the first pass");
    let before = wear(&mut bench);
    let correct = |increment| Command::Part(PartCommand::Correct { ended_at: part.ended_at, increment });
    bench.rig.send(correct(-0.02));
    bench.turn();
    assert_eq!(wear(&mut bench).to_bits(), before.to_bits());
    assert!(bench.shows("程序运行中不能修正"), "{:?}", bench.painted());
    assert!(!bench.shows("采用 X"));
    tell(&mut bench.rig, "wait until idle max 20 s\nparam P390 1\nparam P96 0");
    run(&mut bench);
    assert!(bench.shows("采用 X"));
    let ended_at = bench.rig.snapshot().cycle.part.expect("a part").ended_at;
    bench.rig.send(Command::Part(PartCommand::Correct { ended_at, increment: -0.201 }));
    bench.turn();
    assert_eq!(wear(&mut bench).to_bits(), before.to_bits());
    assert!(bench.shows("一次修正最大"));
}

#[test]
fn h6_a_touched_value_ends_the_typing_of_a_size() {
    let mut bench = bench("T0101\nG04 P100");
    tell(&mut bench.rig, "set #521 = 40.3");
    run(&mut bench);
    bench.touch("输入实测尺寸 type-size");
    assert!(bench.shows("实测 工件 1 ="));
    bench.touch("毛坯直径 #520");
    assert!(bench.shows("数据输入: #520=") && !bench.shows("实测 工件 1 ="), "{:?}", bench.painted());
    bench.write("40.4");
    bench.press(egui::Key::Enter);
    assert_eq!(bench.rig.snapshot().variables[520], Some(40.4));
    assert!(bench.rig.snapshot().cycle.part.expect("a part").typed.is_none());
    // And the other way round, once the pad is closed that lies on the card.
    bench.press(egui::Key::Escape);
    bench.touch("输入实测尺寸 type-size");
    bench.write("40.29");
    bench.press(egui::Key::Enter);
    assert_eq!(bench.rig.snapshot().cycle.part.expect("a part").typed, Some(40.29));
    assert_eq!(bench.rig.snapshot().variables[520], Some(40.4));
}

#[test]
fn k4_1_a_worn_wheel_is_dressed_before_the_offset_is_corrected() {
    let mut bench = bench("T0101\nG04 P100");
    tell(&mut bench.rig, "set #521 = 40.28\nparam P96 1");
    run(&mut bench);
    assert!(bench.shows("可能是砂轮磨损") && !bench.shows("采用 X"), "{:?}", bench.painted());
    let (ended_at, before) = (bench.rig.snapshot().cycle.part.expect("a part").ended_at, wear(&mut bench));
    bench.rig.send(Command::Part(PartCommand::Correct { ended_at, increment: -0.02 }));
    bench.turn();
    assert_eq!(wear(&mut bench).to_bits(), before.to_bits());
    // The first part after a dressing.
    tell(&mut bench.rig, "param P96 0");
    run(&mut bench);
    assert!(bench.shows("采用 X"), "{:?}", bench.painted());
    // Another nominal size since: the deviation is taken into account already.
    tell(&mut bench.rig, "set #521 = 40.26");
    let ended_at = bench.rig.snapshot().cycle.part.expect("a part").ended_at;
    bench.rig.send(Command::Part(PartCommand::Correct { ended_at, increment: -0.02 }));
    bench.turn();
    assert!(bench.shows("改过公称尺寸") && wear(&mut bench).to_bits() == before.to_bits());
}

#[test]
fn k4_5_a_size_that_a_parameter_names_is_what_the_page_says_of_it() {
    let mut rig = ready();
    rig.add_program(program_from_bytes(1_005, "O1005.NC", b"T0101\nG04 P100\nM31\nM30".to_vec(), rig.kind().dialect()));
    tell(&mut rig, "load O1005\nset #640 = 30\nparam P376 640");
    let mut bench = Bench::new(rig, Page::Grinding);
    run(&mut bench);
    let nominal = bench.rig.snapshot().cycle.part.expect("a part").nominal.expect("a size");
    // 成品长度: the wheel's axis does not decide it.
    assert_eq!(nominal.kind, Some(SizeKind::Length));
    assert!(!bench.shows("采用") && !bench.shows("输入实测尺寸"), "{:?}", bench.painted());
}

#[test]
fn k7_2_a_typed_size_is_that_of_its_part() {
    let mut bench = bench("T0101\nG04 P1500");
    tell(&mut bench.rig, "set #521 = 40.3\nparam P390 2\nmode auto\nkey cycle-start\nwait 2.5 s\nexpect state running");
    bench.turn();
    let first = bench.rig.snapshot().cycle.part.expect("the part of the first pass").ended_at;
    bench.touch("输入实测尺寸 type-size");
    bench.write("40.31");
    tell(&mut bench.rig, "wait until idle max 20 s");
    bench.turn();
    bench.press(egui::Key::Enter);
    bench.rig.send(Command::Part(PartCommand::TypeSize { ended_at: first, mm: 40.31 }));
    bench.turn();
    let part = bench.rig.snapshot().cycle.part.expect("the second part");
    assert!(part.ended_at > first && part.typed.is_none(), "{part:?}");
}

/// Of 40 ±0.01 with 39.995 and 40.008 the middle is 40.0015: a correction by the worst place would push the other one out.
#[test]
fn k4_1_of_several_places_the_middle_is_corrected() {
    let size = |mm| PartSize { kind: SizeKind::Diameter, name: LocalizedText::same(""), surface: Some(0), mm };
    let nominal = NominalSize { kind: Some(SizeKind::Diameter), mm: 40.0, limits: Some((39.99, 40.01)) };
    let mut simulated = crate::sample::busy(Page::Grinding).simulated.unwrap().as_ref().clone();
    simulated.finished_defects.clear();
    let part = PartResult { nominal: Some(nominal), ..part_result() };
    for (sizes, expected) in
        [([39.995, 40.008], Some(None)), ([40.003, 40.009], Some(Some(-0.006))), ([39.988, 40.009], None)]
    {
        simulated.finished_sizes = sizes.map(size).to_vec();
        let advice = part.advice(Some(&simulated));
        let told = match advice {
            CorrectionAdvice::Centred => Some(None),
            CorrectionAdvice::Add(_, by) => Some(Some((by * 1_000.0).round() / 1_000.0)),
            _ => None,
        };
        assert_eq!(told, expected, "{sizes:?}: {advice:?}");
    }
}

#[test]
fn k4_1_no_correction_after_a_change_of_the_wheel_or_of_the_programming() {
    for change in ["wheel", "radius", "offset"] {
        let mut bench = bench(if change == "offset" { "T0101\nG04 P100\nT0202" } else { "T0101\nG04 P100" });
        tell(&mut bench.rig, "set #521 = 40.28");
        run(&mut bench);
        match change {
            "wheel" => {
                assert!(bench.shows("采用 X"));
                let size = (390.0, 20.0, 35.0);
                let (diameter_mm, width_mm, rated_m_s) = size;
                bench.rig.send(Command::OpenPage(Page::Wheel));
                bench.rig.send(Command::ChangeWheel { diameter_mm, width_mm, rated_m_s });
            }
            "radius" => tell(&mut bench.rig, "param P6.0 1"),
            // The cycle has called two offsets.
            _ => {}
        }
        bench.turn();
        bench.rig.send(Command::OpenPage(Page::Grinding));
        bench.turn();
        assert!(bench.rig.snapshot().cycle.part.is_some(), "{change}");
        assert!(!bench.shows("采用 X"), "{change}: {:?}", bench.painted());
        assert!(bench.rig.snapshot().cycle.part.expect("a part").offset.is_none(), "{change}");
    }
}
