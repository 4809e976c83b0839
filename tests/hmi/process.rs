//! The process page: sizes of the parts between their limits, curves under fingers, dressings left, the table.
//! Source: tools.md (page process), H9, K4.5, K5.17.

use std::sync::Arc;

use crate::sample::running;
use crate::screen::{Screen, open, painted};
use egui::{Event, Modifiers, PointerButton, pos2};
use egui_kittest::kittest::Queryable;
use kt830::defs::date::DateTime;
use kt830::defs::page::Page;
use kt830::defs::param::{self, NumberParam};
use kt830::defs::part_defect::PartDefect;
use kt830::defs::part_record::PartRecord;
use kt830::link::Command;
use kt830::link::files::FileRequest;
use kt830::link::page_command::PageCommand;
use kt830::link::part_result::PartResult;
use kt830::link::simulation::SimView;
use kt830::units::{Axis, Micros};

/// A machine that measures into #540, nominal #541 = 40, +0.010 −0.005.
fn measuring() -> Screen {
    let mut machine = running(Page::Process);
    set(&mut machine, param::TREND_SIZE_VARIABLE, 540.0);
    set(&mut machine, param::TREND_NOMINAL_VARIABLE, 541.0);
    set(&mut machine, param::TREND_UPPER, 0.010);
    set(&mut machine, param::TREND_LOWER, -0.005);
    machine.variables[541] = Some(40.0);
    open(machine)
}

fn set(machine: &mut kt830::link::Snapshot, at: NumberParam, value: f64) {
    Arc::make_mut(&mut machine.params).write(at.address(), value).unwrap();
}

fn finish(screen: &mut Screen, size: f64) {
    screen.state_mut().snapshot.variables[540] = Some(size);
    end_cycle(screen);
}

/// A cycle ends, with the values as they are.
fn end_cycle(screen: &mut Screen) {
    let machine = &mut screen.state_mut().snapshot;
    machine.parts_counted += 1;
    machine.now = Micros(machine.now.0 + 1_000_000);
    let (nominal, measured) = {
        let values = machine.size_values();
        (values.nominal(), values.measured())
    };
    let part = PartResult {
        typed: None,
        gauged: false,
        is_wheel_fresh: true,
        offset: None,
        corrected: None,
        number: machine.parts_counted,
        program: machine.program.number,
        ended_at: machine.now,
        times: machine.cycle.times,
        nominal,
        measured,
    };
    machine.cycle.part = Some(part);
    let simulated = machine.simulated.as_deref();
    let record = PartRecord {
        count: u64::from(part.number),
        number: part.number,
        program: part.program,
        order: 0,
        ended: DateTime::default(),
        cycle_seconds: part.times.seconds,
        size: part.judged_size(simulated).map(|size| size.mm()),
        limits: part.nominal.and_then(|nominal| nominal.limits.map(|(low, high)| [nominal.mm, low, high])),
        verdict: part.verdict(simulated),
        since_dressing: 1,
        wheel_mm: None,
        alarms: [0; 4],
    };
    machine.production.parts.push(record);
    screen.step();
}

fn shows(screen: &Screen, words: &str) -> bool {
    painted(screen).iter().any(|text| text.contains(words))
}

fn table(screen: &mut Screen) -> String {
    screen.get_by_label("存为 CSV process-export").click();
    screen.step();
    screen.step();
    let sent = std::mem::take(&mut screen.state_mut().sent);
    let text = sent.into_iter().find_map(|command| match command {
        Command::Page(PageCommand::File(_, FileRequest::SaveTable(text))) => Some(text),
        _ => None,
    });
    text.unwrap()
}

/// Ten seconds pass, ten samples a second.
fn pass(screen: &mut Screen, seconds: u64) {
    for _ in 0..seconds * 10 {
        let machine = &mut screen.state_mut().snapshot;
        machine.now = Micros(machine.now.0 + 100_000);
        screen.step();
    }
}

#[test]
fn process_sizes_are_shown_between_their_limits() {
    let mut screen = measuring();
    assert!(shows(&screen, "还没有实测尺寸"), "what to do is said while nothing was measured");
    finish(&mut screen, 40.004);
    assert!(shows(&screen, "40.004 / 40.000 +0.010 -0.005") && !shows(&screen, "不良"));
    // On its limit it is in, a micrometre beyond out.
    finish(&mut screen, 40.010);
    finish(&mut screen, 39.995);
    assert!(!shows(&screen, "不良"));
    finish(&mut screen, 40.011);
    finish(&mut screen, 39.994);
    assert!(shows(&screen, "不良 2"));
    // Limits of another part do not touch those that were made.
    screen.state_mut().snapshot.variables[541] = Some(50.0);
    finish(&mut screen, 50.001);
    assert!(shows(&screen, "50.001 / 50.000 +0.010 -0.005 · 不良 2"));
    let table = table(&mut screen);
    let rows: Vec<&str> = table.split("\r\n").skip_while(|line| !line.starts_with("part,")).collect();
    assert_eq!(rows[0], "part,cycle_seconds,size,nominal,lower,upper,verdict,program,order,ended,since_dressing");
    assert!(rows[1].contains(",40.0040,40.0000,39.9950,40.0100,ok,"), "{}", rows[1]);
    assert!(rows[4].contains(",40.0110,40.0000,39.9950,40.0100,out-of-tolerance,"), "{}", rows[4]);
}

#[test]
fn process_without_limits_nothing_is_out() {
    let mut screen = measuring();
    let machine = &mut screen.state_mut().snapshot;
    set(machine, param::TREND_NOMINAL_VARIABLE, 0.0);
    finish(&mut screen, 12.0);
    assert!(shows(&screen, "12.000") && !shows(&screen, "不良") && !shows(&screen, "12.000 /"));
    // A variable without a value is no size.
    let mut screen = measuring();
    end_cycle(&mut screen);
    assert!(shows(&screen, "还没有实测尺寸"));
}

#[test]
fn process_a_burnt_part_is_bad_whatever_its_size() {
    let mut screen = measuring();
    finish(&mut screen, 40.001);
    assert!(!shows(&screen, "不良"));
    let burnt = SimView { finished_defects: vec![PartDefect::Burn], ..SimView::default() };
    screen.state_mut().snapshot.simulated = Some(Arc::new(burnt));
    finish(&mut screen, 40.001);
    assert!(shows(&screen, "不良 1"), "{:?}", painted(&screen));
    let table = table(&mut screen);
    assert!(table.lines().last().unwrap().contains(",40.0010,40.0000,39.9950,40.0100,burn,"), "{table}");
}

/// Five parts scatter by ±1 µm; then each is 2 µm larger: the mean leaves its control limits before a part is bad.
#[test]
fn k4_5_a_drift_is_told_before_a_part_is_bad() {
    let mut screen = measuring();
    for size in [40.001, 39.999, 40.000, 40.001, 39.999, 40.000, 40.001, 39.999] {
        finish(&mut screen, size);
    }
    // Mean 40, s = √(6/7) = 0.926 µm; the lower limit is 5 µm away: 5 / 2.777 = 1.80.
    assert!(shows(&screen, "Cpk 1.80") && !shows(&screen, "漂移"), "{:?}", painted(&screen));
    for part in 1..=4 {
        finish(&mut screen, 40.0 + 0.002 * f64::from(part));
    }
    assert!(shows(&screen, "漂移") && !shows(&screen, "不良"), "{:?}", painted(&screen));
}

#[test]
fn h9_fingers_drag_and_draw_the_curves() {
    let mut screen = measuring();
    pass(&mut screen, 30);
    assert!(shows(&screen, "时间 10 s") && screen.query_by_label("实时 process-live").is_some());
    let canvas = screen.get_by_label("曲线 process-curves").rect();
    let (from, to) = (canvas.center(), canvas.center() + egui::vec2(120.0, 0.0));
    let button = |pos, pressed| Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    screen.event(Event::PointerMoved(from));
    screen.event(button(from, true));
    screen.step();
    screen.event(Event::PointerMoved(pos2(f32::midpoint(from.x, to.x), from.y)));
    screen.step();
    screen.event(Event::PointerMoved(to));
    screen.step();
    screen.event(button(to, false));
    screen.step();
    screen.step();
    assert!(shows(&screen, "回到实时"), "dragged to the right the past is seen");
    // Two fingers draw the time out: twice as large is half the span.
    screen.event(Event::Zoom(2.0));
    screen.step();
    assert!(shows(&screen, "时间 5 s"));
    // What stands is not moved by what comes.
    let end = |screen: &Screen| painted(screen).into_iter().find(|text| text.starts_with("回到实时"));
    let before = end(&screen);
    pass(&mut screen, 3);
    assert_eq!(end(&screen), before);
    let key = screen.query_all_by_label_contains("process-live").next().unwrap();
    key.click();
    screen.step();
    screen.step();
    assert!(screen.query_by_label("实时 process-live").is_some());
    assert!(screen.state().sent.is_empty(), "a swipe asks nothing of the machine");
}

#[test]
fn k5_17_the_dressings_that_are_left_are_told() {
    let mut screen = measuring();
    let left = |screen: &Screen, value: &str| shows(screen, "还可修整次数") && shows(screen, value);
    let machine = &mut screen.state_mut().snapshot;
    set(machine, param::WHEEL_MIN_DIAMETER, 400.0);
    set(machine, param::WHEEL_DIAMETER, 500.0);
    set(machine, param::DRESSING_COUNT, 3.0);
    screen.step();
    // A dressing takes 0.04: 99.96 / 0.04 = 2499 more.
    let machine = &mut screen.state_mut().snapshot;
    set(machine, param::WHEEL_DIAMETER, 499.96);
    set(machine, param::DRESSING_COUNT, 4.0);
    screen.step();
    screen.step();
    assert!(left(&screen, "2499"));
    // A new wheel is not known yet.
    let machine = &mut screen.state_mut().snapshot;
    set(machine, param::WHEEL_DIAMETER, 600.0);
    set(machine, param::DRESSING_COUNT, 0.0);
    screen.step();
    screen.step();
    assert!(!shows(&screen, "2499"));
    // A smaller one, none of the two ever dressed; then a dressing takes 0.08: 49.92 / 0.08 = 624 more.
    for (diameter, dressings) in [(450.0, 0.0), (449.92, 1.0)] {
        let machine = &mut screen.state_mut().snapshot;
        set(machine, param::WHEEL_DIAMETER, diameter);
        set(machine, param::DRESSING_COUNT, dressings);
        screen.step();
        screen.step();
    }
    assert!(left(&screen, "624"));
}

#[test]
fn process_the_table_has_columns_for_what_the_machine_has() {
    let mut screen = measuring();
    pass(&mut screen, 1);
    let both = table(&mut screen);
    assert!(both.starts_with("seconds,X,Z,feed_mm_min,wheel_load_percent,gauges\r\n"), "{both}");
    let columns = both.split("\r\n").next().unwrap().split(',').count();
    assert!(both.split("\r\n").take(5).all(|line| line.split(',').count() == columns), "{both}");
    // A machine that has a Y, and no signal of the load: its column stays empty.
    let machine = &mut screen.state_mut().snapshot;
    machine.axes[Axis::Y] = machine.axes[Axis::X];
    machine.simulated = None;
    pass(&mut screen, 1);
    let three = table(&mut screen);
    assert!(three.starts_with("seconds,X,Y,Z,feed_mm_min,wheel_load_percent,gauges\r\n"), "{three}");
    let last = three.split("\r\n\r\n").next().unwrap().lines().last().unwrap();
    let cells: Vec<&str> = last.split(',').collect();
    assert_eq!((cells.len(), cells[5]), (7, ""), "{last}");
}

#[test]
fn b6_what_was_recorded_is_cleared_only_when_asked() {
    let mut screen = measuring();
    finish(&mut screen, 40.0);
    pass(&mut screen, 2);
    let touch = |screen: &mut Screen, label: &str| {
        screen.get_by_label(label).click();
        screen.step();
        screen.step();
    };
    touch(&mut screen, "清除 process-clear");
    assert!(shows(&screen, "清除过程数据？") && shows(&screen, "1 个工件"));
    touch(&mut screen, "取消 question-no");
    let kept = table(&mut screen).lines().count();
    assert!(kept > 20, "{kept}");
    touch(&mut screen, "清除 process-clear");
    touch(&mut screen, "清除 question-clear");
    let left = table(&mut screen).lines().count();
    assert!(left < 10, "{left} lines");
}

/// Ten minutes lie on a few hundred pixel columns: a peak of one sample is seen wherever it falls in its column.
#[test]
fn h9_a_short_peak_is_seen_on_a_long_span() {
    let mut screen = measuring();
    let mut machine = screen.state().snapshot.clone();
    let peaks: Vec<usize> = (0..20).map(|peak| 300 + peak * 261).collect();
    for sample in 0..6_000 {
        machine.now = Micros(machine.now.0 + 100_000);
        machine.axes[Axis::X].work = if peaks.contains(&sample) { 10.0 } else { 0.0 };
        screen.state_mut().hmi.record(&machine);
    }
    screen.state_mut().snapshot = machine;
    screen.step();
    for _ in 0..3 {
        let key = screen.query_all_by_label_contains("process-span").next().unwrap();
        key.click();
        screen.step();
        screen.step();
    }
    assert!(shows(&screen, "时间 600 s"));
    let longest = screen.output().shapes.iter().filter_map(|clipped| match &clipped.shape {
        egui::Shape::Path(path) if path.points.len() > 300 => Some(path.points.clone()),
        _ => None,
    });
    let seen = |points: &Vec<egui::Pos2>| {
        let top = points.iter().map(|point| point.y).fold(f32::INFINITY, f32::min);
        points.iter().filter(|point| point.y < top + 0.5).count()
    };
    let curves: Vec<(usize, usize)> = longest.map(|points| (points.len(), seen(&points))).collect();
    assert!(curves.iter().any(|(_, seen)| *seen == peaks.len()), "{curves:?}");
    assert!(curves.iter().all(|(points, _)| *points < 4 * 1_024), "{curves:?}");
}
