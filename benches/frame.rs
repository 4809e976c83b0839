//! Milliseconds per frame for logic, layout and tessellation, as in the window: the grinding page during a run, the
//! drawing of a path of a million blocks while it is dragged and zoomed, and the listing of a million lines.
//! `cargo bench --bench frame`; targets: 2 ms for the grinding page, 16 ms for the others (H8).

// A bench prints its results.
#![allow(clippy::print_stdout)]

#[path = "../tests/common/sample.rs"]
mod sample;

use std::sync::Arc;
use std::time::Instant;

use egui::{Event, Modifiers, PointerButton, Pos2, pos2};
use kt830::defs::page::Page;
use kt830::defs::text::Lang;
use kt830::hmi::Hmi;
use kt830::hmi::offscreen::OffscreenHmi;
use kt830::link::Snapshot;
use kt830::link::files::FilesView;
use kt830::link::toolpath::{CycleTime, MoveKind, PathPoint, Toolpath};
use kt830::units::{Axis, WorkPos};

const FRAMES: u32 = 600;
const BLOCKS: u32 = 1_000_000;

fn main() {
    bench("grinding page", sample::running(Page::Grinding), |_, _| Vec::new());
    let drawn = million_blocks();
    bench("graphic page, a million blocks, moved", drawn.clone(), |_, frame| drag(frame));
    bench("graphic page, a million blocks, zoomed", drawn, |_, frame| {
        let key = if frame % 60 < 30 { "+" } else { "-" };
        if frame % 3 == 0 { vec![Event::Text(key.to_owned())] } else { Vec::new() }
    });
    bench("program page, a million lines", million_lines(), |machine, frame| {
        machine.program.line = 1 + frame * 1_600;
        Vec::new()
    });
}

/// Runs the frames of a page; `before` supplies the events of each frame.
fn bench(name: &str, mut machine: Snapshot, before: impl Fn(&mut Snapshot, u32) -> Vec<Event>) {
    let mut stage = OffscreenHmi::new(Hmi::new(Lang::Zh), (1_920, 1_080));
    for _ in 0..10 {
        stage.frame(&machine);
    }
    let mut times = Vec::with_capacity(FRAMES as usize);
    let mut triangles = 0;
    for frame in 0..FRAMES {
        // The positions change in every frame, as in a run.
        machine.axes[Axis::X].work = 40.0 - f64::from(frame) * 0.013;
        machine.axes[Axis::X].to_go = f64::from(frame) * 0.013 - 52.0;
        stage.events = before(&mut machine, frame);
        let begun = Instant::now();
        stage.frame(&machine);
        triangles = stage.triangles();
        times.push(begun.elapsed().as_secs_f64() * 1_000.0);
    }
    times.sort_by(f64::total_cmp);
    let at = |share: f64| times[((times.len() - 1) as f64 * share) as usize];
    println!("{name} 1920x1080: median {:.2} ms, 99 % {:.2} ms, {triangles} triangles", at(0.5), at(0.99));
}

/// A finger that drags the drawing to and fro.
fn drag(frame: u32) -> Vec<Event> {
    let at = |frame: u32| -> Pos2 { pos2(200.0 + (frame % 100) as f32 * 3.0, 200.0 + (frame % 70) as f32 * 2.0) };
    let button = |pressed| Event::PointerButton {
        pos: at(frame),
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    match frame % 100 {
        0 => vec![Event::PointerMoved(at(frame)), button(true)],
        99 => vec![Event::PointerMoved(at(frame)), button(false)],
        _ => vec![Event::PointerMoved(at(frame))],
    }
}

/// A drawing of a wheel profile with a million short moves.
fn million_blocks() -> Snapshot {
    let mut machine = sample::running(Page::Graphic);
    let points = (0..BLOCKS).map(|block| {
        let along = block as f32 / BLOCKS as f32;
        let way = if block % 1_000 == 0 { MoveKind::Rapid } else { MoveKind::Feed };
        PathPoint {
            at: [20.0 + 15.0 * (along * 900.0).sin(), 0.0, -100.0 * along + (along * 7_000.0).cos()],
            kind: way,
        }
    });
    let mut drawing = Toolpath {
        number: machine.program.number,
        length_mm: 250_000.0,
        cycle_time: CycleTime::AtFeeds(36_000.0),
        lines: BLOCKS as _,
        extents: Some((WorkPos::new([5.0, 0.0, -101.0]), WorkPos::new([35.0, 0.0, 1.0]))),
        finished: true,
        ..Toolpath::default()
    };
    drawing.set_path(points.collect());
    machine.files = Arc::new(FilesView { toolpath: Some(Arc::new(drawing)), ..FilesView::default() });
    machine
}

fn million_lines() -> Snapshot {
    let mut machine = sample::running(Page::Program);
    let text: String = (1..=BLOCKS).map(|line| format!("N{line} G01 X{line} Z-{line}.5 F300\n")).collect();
    machine.program.text = text.into();
    machine
}
