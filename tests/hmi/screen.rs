//! The screen on a harness: what it shows is given, what it sends is collected.

#![allow(dead_code, reason = "each test file uses what it needs")]

use egui::{Event, Pos2, TouchDeviceId, TouchId, TouchPhase, vec2};
use egui_kittest::Harness;
use kt830::defs::text::Lang;
use kt830::hmi::Hmi;
use kt830::link::{Command, Snapshot};

/// The screen, what it is shown and what it has sent.
pub struct Desk {
    pub hmi: Hmi,
    pub snapshot: Snapshot,
    pub sent: Vec<Command>,
}

pub type Screen = Harness<'static, Desk>;

/// A screen of 1024×768 after its first frame; what that sent is forgotten.
pub fn open(snapshot: Snapshot) -> Screen {
    open_sized(snapshot, vec2(1_024.0, 768.0))
}

/// A screen of another size, points.
pub fn open_sized(snapshot: Snapshot, size: egui::Vec2) -> Screen {
    let desk = Desk { hmi: Hmi::new(Lang::Zh), snapshot, sent: Vec::new() };
    let mut screen =
        Harness::builder().with_size(size).with_context_setup(|ctx| Hmi::new(Lang::Zh).install(ctx)).build_ui_state(
            |ui, desk: &mut Desk| {
                let commands = desk.hmi.ui(ui, &desk.snapshot);
                desk.sent.extend(commands);
            },
            desk,
        );
    screen.step();
    screen.state_mut().sent.clear();
    screen
}

/// An event of a finger on the touch screen, by its number.
pub fn finger_event(id: u64, phase: TouchPhase, pos: Pos2) -> Event {
    Event::Touch { device_id: TouchDeviceId(1), id: TouchId(id), phase, pos, force: None }
}

/// Every text of the last frame as it was painted.
pub fn painted(screen: &Screen) -> Vec<String> {
    fn collect(shape: &egui::Shape, found: &mut Vec<String>) {
        match shape {
            egui::Shape::Vec(shapes) => shapes.iter().for_each(|shape| collect(shape, found)),
            egui::Shape::Text(text) => found.push(text.galley.job.text.clone()),
            _ => {}
        }
    }
    let mut found = Vec::new();
    screen.output().shapes.iter().for_each(|clipped| collect(&clipped.shape, &mut found));
    found
}
