//! Measures the lines per second of the check and of `Interpreter::next` on long programs. Targets of the check on a
//! million lines of `N10 G1 X… Z… F…`: 2 M, then 5 M lines/s.
#![allow(clippy::print_stdout, clippy::unwrap_used, missing_docs)]

use std::sync::Arc;
use std::time::Instant;

use kt830::nc::{
    Block, CommonVariables, EmptyLibrary, Interpreter, Library, NcSettings, NextStatus, OfflineMachine, Source, check,
};

const LINES: usize = 1_000_000;
const ROUNDS: usize = 3;
const TARGET_LINES_S: f64 = 5e6;

fn moves() -> String {
    let mut text = String::from("O1001\nG98 G0 X50 Z10\n");
    for line in 0..LINES {
        let (x, z) = (line * 7919 % 100_000, line * 104_729 % 1_000_000);
        text += &format!(
            "N{} G1 X{}.{:03} Z-{}.{:03} F{}\n",
            line % 10_000,
            x / 1000,
            x % 1000,
            z / 1000,
            z % 1000,
            100 + line % 900
        );
    }
    text + "M30\n"
}

fn arithmetic() -> String {
    let mut text = String::from("O1001\n#100=1\n#101=2.5\n");
    for line in 0..LINES / 2 {
        text += &format!("#1=[#100+{}.25]*#101-SIN[30]/2\n#102=#1-#101*0.5\n", line % 1000);
    }
    text + "M30\n"
}

fn while_loop() -> String {
    format!("O1001\n#1=0\nWHILE[#1 LT {}]DO1\n#1=#1+1\nIF[#1 EQ 0]GOTO 10\nEND1\nN10 M30\n", LINES / 4)
}

/// Runs `act` `ROUNDS` times and prints the speed of the fastest run; `lines` counts each line as often as it is read.
/// What `prepare` makes for a run is not timed.
fn report<T>(name: &str, lines: usize, bytes: usize, prepare: impl Fn() -> T, act: impl Fn(T)) {
    let seconds = (0..ROUNDS)
        .map(|_| {
            let prepared = prepare();
            let start = Instant::now();
            act(prepared);
            start.elapsed().as_secs_f64()
        })
        .fold(f64::INFINITY, f64::min);
    let speed = lines as f64 / seconds;
    println!(
        "{name:<28} {:>7.2} M lines/s {:>7.1} MB/s  {:>6.1} ns/line  {:>5.2} of the aim",
        speed / 1e6,
        bytes as f64 / seconds / 1e6,
        1e9 / speed,
        speed / TARGET_LINES_S
    );
}

fn run(source: &Arc<Source>) -> usize {
    let settings = NcSettings::lathe_a();
    let mut world = OfflineMachine::new(&settings);
    let mut block = Block::new(&settings);
    let mut interpreter =
        Interpreter::new(Arc::clone(source), Arc::new(EmptyLibrary), settings, CommonVariables::default());
    let mut count = 0;
    loop {
        match interpreter.next(&mut world, &mut block).unwrap() {
            NextStatus::Block => {
                count += block.ops.len();
                block.ops.iter().for_each(|op| world.apply(op));
            }
            NextStatus::Busy | NextStatus::Waiting | NextStatus::Drain => {}
            NextStatus::End => return count,
        }
    }
}

fn main() {
    let wanted = std::env::args().skip(1).find(|word| !word.starts_with('-')).unwrap_or_default();
    let settings = NcSettings::lathe_a();
    let library: Arc<dyn Library + Send + Sync> = Arc::new(EmptyLibrary);
    for (name, text, lines) in
        [("moves", moves(), LINES), ("arithmetic", arithmetic(), LINES), ("while loop", while_loop(), LINES)]
    {
        if !name.contains(&wanted) {
            continue;
        }
        let bytes = text.len();
        println!("{name}: {:.1} MB", bytes as f64 / 1e6);
        let load = |text: Vec<u8>| Source::new(1001, "", text, settings.dialect);
        let source = Arc::new(load(text.clone().into_bytes()));
        if name != "while loop" {
            let file = || text.clone().into_bytes();
            report("  load (line index)", lines, bytes, file, |file| assert!(load(file).line_count() > 2));
        }
        report(
            "  check",
            lines,
            bytes,
            || (),
            |()| {
                let checked = check(&source, &library, &settings);
                assert!(checked.faults.is_empty(), "{:?}", checked.faults.first());
                assert!(checked.finished);
            },
        );
        report("  next", lines, bytes, || (), |()| assert!(run(&source) > 0));
    }
}
