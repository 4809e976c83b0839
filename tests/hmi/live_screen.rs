//! The screen with the real core and its simulated machine behind it: fingers and keys go in, the snapshot comes back.

#![allow(dead_code, clippy::unwrap_used, clippy::expect_used, reason = "a test driver: a failure is the message")]

use egui::Event;
use egui_kittest::kittest::Queryable;
use kt830::defs::page::Page;
use kt830::defs::param::ParamAddress;
use kt830::defs::text::Lang;
use kt830::hmi::page_text;
use kt830::host::headless::HeadlessHost;
use kt830::link::Command;

use crate::screen::{Screen, open};

/// The screen and the machine behind it.
pub struct Bench {
    pub rig: HeadlessHost,
    pub screen: Screen,
}

impl Bench {
    pub fn new(mut rig: HeadlessHost, page: Page) -> Self {
        rig.send(Command::OpenPage(page));
        rig.step();
        rig.step();
        let screen = open(rig.snapshot().clone());
        let mut bench = Self { rig, screen };
        bench.turn();
        bench
    }

    /// Commands go down, ticks pass, the snapshot comes back, as between window and core.
    pub fn turn(&mut self) {
        for _ in 0..3 {
            self.screen.step();
            for command in std::mem::take(&mut self.screen.state_mut().sent) {
                self.rig.send(command);
            }
            for _ in 0..3 {
                self.rig.step();
            }
            self.screen.state_mut().snapshot = self.rig.snapshot().clone();
        }
        self.screen.step();
    }

    pub fn touch(&mut self, label: &str) {
        self.screen.get_by_label(label).click();
        self.turn();
    }

    /// A finger taps a place.
    pub fn tap(&mut self, pos: egui::Pos2) {
        for pressed in [true, false] {
            let (button, modifiers) = (egui::PointerButton::Primary, egui::Modifiers::NONE);
            let events = &mut self.screen.input_mut().events;
            events.extend([Event::PointerMoved(pos), Event::PointerButton { pos, button, pressed, modifiers }]);
            self.turn();
        }
    }

    pub fn press(&mut self, key: egui::Key) {
        self.screen.key_press(key);
        self.turn();
    }

    pub fn write(&mut self, text: &str) {
        self.screen.event(Event::Text(text.to_owned()));
        self.turn();
    }

    /// Finds a parameter by its number, types a value and presses 输入.
    pub fn set(&mut self, param: &str, value: &str) {
        self.write(param);
        self.press(egui::Key::Enter);
        self.write(value);
        self.press(egui::Key::Enter);
    }

    pub fn param(&self, word: &str) -> f64 {
        self.rig.retained().params.read(ParamAddress::parse(word).unwrap()).unwrap()
    }

    pub fn asks_password(&self) -> bool {
        self.screen.query_by_label("密码 password").is_some()
    }

    pub fn says(&mut self, words: &str) -> bool {
        self.turn();
        page_text(self.rig.snapshot(), Lang::Zh).iter().any(|text| text.contains(words))
    }

    /// Whether the screen itself paints the words now, with all that was touched and typed on it.
    pub fn shows(&self, words: &str) -> bool {
        self.painted().iter().any(|text| text.contains(words))
    }

    /// The texts that the screen paints, in order.
    pub fn painted(&self) -> Vec<String> {
        fn collect(shape: &egui::Shape, found: &mut Vec<String>) {
            match shape {
                egui::Shape::Vec(shapes) => shapes.iter().for_each(|shape| collect(shape, found)),
                egui::Shape::Text(text) => found.push(text.galley.job.text.clone()),
                _ => {}
            }
        }
        let mut found = Vec::new();
        self.screen.output().shapes.iter().for_each(|clipped| collect(&clipped.shape, &mut found));
        found
    }

    pub fn message(&mut self) -> String {
        self.rig.snapshot().message.text.zh().into_owned()
    }
}
