//! Each stage of the shipped programs runs at its programmed feed. Source: spec B2 (F, G64), K4.3.

use std::collections::{BTreeMap, BTreeSet};

use kt830::link::snapshot::RunState;
use kt830::units::Axis;

use super::shop::{PROGRAMS, Shop, shop};
use crate::stories::folders;

/// Ticks at both ends of a stage in which the axes accelerate and brake: from 100 mm/s at 800 mm/s² and 20 000 mm/s³ it
/// takes 100/800 + 800/20 000 = 0.165 s.
const RAMP_TICKS: usize = 180;
/// The axes reach 100 mm/s (P30 to P32), mm/min; at it their limits decide, not F.
const AXIS_LIMIT: f64 = 6_000.0;
/// Shortest stage that is measured, ticks.
const LEAST_TICKS: usize = 2 * RAMP_TICKS + 200;

/// The word F of a cutting block: a number, or a variable.
#[derive(Clone, Copy, Debug)]
enum FeedWord {
    Number(f64),
    Variable(u16),
}

/// The word F of a line with G01 or G31.
fn feed_word(line: &str) -> Option<FeedWord> {
    let code = line.split('(').next()?;
    let (_, rest) = code.split_once(" G01 ").or_else(|| code.split_once(" G31 "))?;
    let (_, word) = rest.rsplit_once('F')?;
    let word = word.split([' ', 'P']).next()?;
    match word.strip_prefix('#') {
        Some(number) => number.parse().ok().map(FeedWord::Variable),
        None => word.parse().ok().map(FeedWord::Number),
    }
}

/// A line of a shipped program.
fn program_line(number: u32, line: u32) -> String {
    let file = folders().programs.join(format!("O{number:04}.NC"));
    let text = std::fs::read_to_string(file).unwrap_or_default();
    (line as usize).checked_sub(1).and_then(|line| text.lines().nth(line)).unwrap_or_default().to_owned()
}

/// What the local variables of O9010 and O9020 stand for in the program that calls them.
fn named(caller: u32, local: u16) -> u16 {
    match (caller, local) {
        (1_004, 1..=3) => 625 + local,
        (1_004, 8) => 629,
        (1_007, 9) => 690,
        (1_008, 9) => 710,
        (1_009, 9) => 730,
        (1_015 | 1_016, 2) => 118,
        (1_015, 1) => 843,
        (1_015, 3) => 844,
        (1_015, 8) => 847,
        (1_016, 1) => 865,
        (1_016, 3) => 866,
        (1_016, 8) => 872,
        _ => local,
    }
}

/// Path speeds of each stage, mm/min: `(program, line, F)`; stages of the same block one after another.
type Stages = BTreeMap<(u32, u32), Vec<Vec<f64>>>;

/// Runs the program; `values` collects what each variable has been.
fn measure(shop: &mut Shop, program: u32, values: &mut BTreeMap<u16, BTreeSet<u64>>) -> Stages {
    let mut stages = Stages::new();
    let (mut running, mut last, mut before) = (None, shop.rig.controller().set_point(), [0.0; 3]);
    let (mut peak, mut slowed) = (0.0, false);
    shop.rig.send(kt830::link::Command::Press(kt830::defs::key::Key::CycleStart));
    for tick in 0..4_000_000_u32 {
        shop.rig.step();
        let block = shop.rig.controller().current_block();
        let now = shop.rig.controller().set_point();
        // The oscillating axis of O1004 is no part of the path.
        let is_path = |axis: Axis| program != 1_004 || axis == Axis::X;
        let step = Axis::ALL.map(|axis| if is_path(axis) { now[axis] - last[axis] } else { 0.0 });
        let way = step.iter().map(|mm| mm * mm).sum::<f64>().sqrt();
        // A block that runs again at once, as in a loop, begins where the axes turn back, or start again after a stop.
        let turns_back = step.iter().zip(before).map(|(now, before)| now * before).sum::<f64>() < 0.0;
        let restarts = slowed && way > before.iter().map(|mm| mm * mm).sum::<f64>().sqrt();
        (last, before) = (now, step);
        let key = (block.program, block.line);
        if running != Some(key) || turns_back || restarts {
            peak = 0.0_f64;
            stages.entry(key).or_default().push(Vec::new());
            for (number, value) in shop.rig.snapshot().variables.iter().enumerate() {
                values.entry(number as u16).or_default().extend(value.map(f64::to_bits));
            }
        }
        running = Some(key);
        peak = peak.max(way);
        slowed = way < 0.05 * peak;
        if let Some(stage) = stages.get_mut(&key).and_then(|all| all.last_mut()) {
            stage.push(way * 60_000.0);
        }
        if tick > 10 && shop.rig.controller().state() != RunState::Running {
            assert_eq!(shop.rig.controller().state(), RunState::Idle, "O{program}");
            return stages;
        }
    }
    panic!("O{program} does not end");
}

#[test]
fn b2_every_stage_of_the_shipped_programs_runs_at_its_feed() {
    let mut measured = 0;
    for (program, _) in PROGRAMS {
        let (mut shop, mut values) = (shop(program), BTreeMap::new());
        let stages = measure(&mut shop, program, &mut values);
        for ((number, line), runs) in stages {
            let Some(word) = feed_word(&program_line(number, line)) else { continue };
            let feeds: Vec<f64> = match word {
                FeedWord::Number(feed) => vec![feed],
                FeedWord::Variable(variable) => {
                    let variable = named(program, variable);
                    values.get(&variable).into_iter().flatten().map(|bits| f64::from_bits(*bits)).collect()
                }
            };
            for run in runs.iter().filter(|run| run.len() >= LEAST_TICKS) {
                let middle = &run[RAMP_TICKS..run.len() - RAMP_TICKS];
                let mean = middle.iter().sum::<f64>() / middle.len() as f64;
                let feed = feeds.iter().copied().min_by(|a, b| (a - mean).abs().total_cmp(&(b - mean).abs()));
                let feed = feed.unwrap_or_else(|| panic!("O{number} line {line}: no value for {word:?}"));
                if feed >= AXIS_LIMIT {
                    continue;
                }
                println!("O{program} O{number} line {line}: F{feed} {mean:.5} mm/min, {} ticks", run.len());
                for speed in middle {
                    assert!((speed / feed - 1.0).abs() < 0.005, "O{number} line {line} F{feed}: {speed} mm/min");
                }
                measured += 1;
            }
        }
    }
    assert!(measured > 100, "{measured} stages");
}
