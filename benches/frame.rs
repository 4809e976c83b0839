//! Milliseconds per frame of the grinding page: logic, layout and painting to triangles, as the window does it.
//! `cargo bench --bench frame`; aim: under 2 ms.

// The figure is what a bench is for.
#![allow(clippy::print_stdout)]

#[path = "../tests/hmi_sample/mod.rs"]
mod hmi_sample;

use std::time::Instant;

use kt830::defs::page::Page;
use kt830::defs::text::Lang;
use kt830::hmi::Hmi;
use kt830::hmi::shot::Stage;
use kt830::units::Axis;

const FRAMES: u32 = 600;

fn main() {
    let mut machine = hmi_sample::running(Page::Grinding);
    let mut stage = Stage::new(Hmi::new(Lang::Zh), (1_920, 1_080));
    for _ in 0..10 {
        stage.frame(&machine);
    }
    let mut times = Vec::with_capacity(FRAMES as usize);
    let mut triangles = 0;
    for frame in 0..FRAMES {
        // The positions change in every frame, as they do in a run.
        machine.axes[Axis::X].work = 40.0 - f64::from(frame) * 0.013;
        machine.axes[Axis::X].to_go = f64::from(frame) * 0.013 - 52.0;
        let begun = Instant::now();
        stage.frame(&machine);
        triangles = stage.triangles();
        times.push(begun.elapsed().as_secs_f64() * 1_000.0);
    }
    times.sort_by(f64::total_cmp);
    let at = |share: f64| times[((times.len() - 1) as f64 * share) as usize];
    println!("grinding page 1920x1080: median {:.2} ms, 99 % {:.2} ms, {triangles} triangles", at(0.5), at(0.99));
}
