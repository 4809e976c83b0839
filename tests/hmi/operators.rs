//! Two operators at the screen with the real core and its simulated machine behind it: one has fingers alone, the other
//! the keyboard alone. Both read the screen; what the machine's outputs did is kept. A frame is 16 ticks of the control.

#![allow(dead_code, clippy::unwrap_used, clippy::expect_used, reason = "a test driver: a failure is the message")]

use egui::{Event, Modifiers, PointerButton, Pos2, TouchPhase, pos2};
use egui_kittest::kittest::Queryable;
use kt830::defs::key::Key;
use kt830::defs::page::Page;
use kt830::defs::signal::{Output, Terminals};
use kt830::defs::soft_key::{ROWS as SOFT_ROWS, SoftKeyAction, row as soft_row};
use kt830::hmi::SHORTCUTS;
use kt830::host::headless::HeadlessHost;
use kt830::link::Snapshot;
use kt830::units::Micros;

use crate::screen::{Screen, finger_event, open};

/// Ticks between two frames: sixty frames a second.
const FRAME_TICKS: u32 = 16;
/// Every act begins at a multiple of this machine time, so that both operators act at nearly the same moment.
const PACE: Micros = Micros(4_000_000);

/// What an operator works with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hand {
    Fingers,
    Keyboard,
}

/// Somebody at the screen.
pub struct Operator {
    pub hand: Hand,
    pub rig: HeadlessHost,
    pub screen: Screen,
    ports: Terminals,
    /// What the outputs did, in order, without the tower light.
    pub trace: Vec<String>,
}

impl Operator {
    /// In front of a machine.
    pub fn new(hand: Hand, mut rig: HeadlessHost) -> Self {
        rig.step();
        rig.step();
        let screen = open(rig.snapshot().clone());
        let mut operator = Self { hand, rig, screen, ports: Terminals::default(), trace: Vec::new() };
        operator.look();
        operator
    }

    fn tick(&mut self) {
        self.rig.step();
        let ports = self.rig.controller().outputs().terminals;
        if ports == self.ports {
            return;
        }
        let params = &self.rig.retained().params;
        let tower = [Output::TowerRed, Output::TowerYellow, Output::TowerGreen];
        for output in Output::ALL.iter().filter(|output| !tower.contains(output)) {
            let port = params.output_port(*output);
            if ports.is_closed(port) != self.ports.is_closed(port) {
                self.trace.push(format!("{} {}", output.id(), if ports.is_closed(port) { "on" } else { "off" }));
            }
        }
        self.ports = ports;
    }

    /// One frame with what came in from outside; commands go down, ticks pass, the snapshot comes back.
    fn frame(&mut self, events: Vec<Event>, modifiers: Modifiers) {
        let input = self.screen.input_mut();
        input.events.push(Event::ModifiersChanged(modifiers));
        input.events.extend(events);
        self.screen.step();
        for command in std::mem::take(&mut self.screen.state_mut().sent) {
            self.rig.send(command);
        }
        (0..FRAME_TICKS).for_each(|_| self.tick());
        self.screen.state_mut().snapshot = self.rig.snapshot().clone();
    }

    /// A frame in which nothing is touched.
    pub fn look(&mut self) {
        self.frame(Vec::new(), Modifiers::NONE);
    }

    /// Machine time passes without a look at the screen.
    pub fn wait(&mut self, seconds: f64) {
        let until = self.rig.now() + Micros::from_secs_f64(seconds);
        while self.rig.now() < until {
            self.tick();
        }
        self.look_at_it();
    }

    /// Until the machine is where the operator wants it.
    pub fn until(&mut self, what: &str, longest_s: f64, mut done: impl FnMut(&Snapshot) -> bool) {
        let end = self.rig.now() + Micros::from_secs_f64(longest_s);
        while !done(self.rig.snapshot()) {
            let snapshot = self.rig.snapshot();
            let now = format!("{:?} {:?} {:?}", snapshot.state, snapshot.alarms, snapshot.message.text.zh());
            assert!(self.rig.now() < end, "{:?} waits for {what}: {now}", self.hand);
            (0..50).for_each(|_| self.tick());
        }
        self.look_at_it();
    }

    fn look_at_it(&mut self) {
        self.screen.state_mut().snapshot = self.rig.snapshot().clone();
        self.look();
    }

    /// Waits for the next beat.
    pub fn pace(&mut self) {
        while !self.rig.now().0.is_multiple_of(PACE.0) {
            self.tick();
        }
        self.look_at_it();
    }

    pub fn snapshot(&self) -> &Snapshot {
        &self.screen.state().snapshot
    }

    pub fn says(&self, words: &str) -> bool {
        self.snapshot().message.text.zh().contains(words)
    }

    /// Whether the screen paints this text.
    pub fn paints(&self, text: &str) -> bool {
        crate::screen::painted(&self.screen).iter().any(|painted| painted == text)
    }

    /// Whether the screen paints a text with these words.
    pub fn paints_part(&self, words: &str) -> bool {
        crate::screen::painted(&self.screen).iter().any(|painted| painted.contains(words))
    }

    /// Whether what bears this label is on the screen, with room for a finger.
    pub fn sees(&self, label: &str) -> bool {
        self.screen.query_by_label(label).is_some_and(|found| found.rect().height() > 20.0)
    }

    // Fingers.

    fn finger(&mut self, at: Pos2, phase: TouchPhase) {
        let touch = finger_event(1, phase, at);
        let button = |pressed| Event::PointerButton {
            pos: at,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        };
        let events = match phase {
            TouchPhase::Start => vec![touch, Event::PointerMoved(at), button(true)],
            TouchPhase::Move => vec![touch, Event::PointerMoved(at)],
            TouchPhase::End | TouchPhase::Cancel => vec![touch, button(false), Event::PointerGone],
        };
        self.frame(events, Modifiers::NONE);
    }

    /// A finger taps what bears this label.
    pub fn tap(&mut self, label: &str) {
        self.tap_at(self.place(label));
    }

    /// A finger taps a place.
    pub fn tap_at(&mut self, at: Pos2) {
        self.finger(at, TouchPhase::Start);
        self.finger(at, TouchPhase::End);
        self.look();
    }

    fn place(&self, label: &str) -> Pos2 {
        let found = self.screen.query_by_label(label);
        found.unwrap_or_else(|| panic!("{:?} does not find {label:?}", self.hand)).rect().center()
    }

    /// A finger draws a list up, or down.
    pub fn swipe(&mut self, up: bool) {
        let at = |y: f32| pos2(300.0, if up { y } else { 700.0 - y });
        self.finger(at(480.0), TouchPhase::Start);
        for y in [420.0, 330.0, 220.0] {
            self.finger(at(y), TouchPhase::Move);
        }
        self.finger(at(220.0), TouchPhase::End);
    }

    // Keyboard.

    fn key_event(key: egui::Key, pressed: bool, modifiers: Modifiers) -> Event {
        Event::Key { key, physical_key: None, pressed, repeat: false, modifiers }
    }

    /// A physical key goes down and up.
    pub fn strike(&mut self, key: egui::Key, modifiers: Modifiers) {
        self.frame(vec![Self::key_event(key, true, modifiers)], modifiers);
        self.frame(vec![Self::key_event(key, false, modifiers)], modifiers);
    }

    fn plain(&mut self, key: egui::Key) {
        self.strike(key, Modifiers::NONE);
    }

    /// Signs are typed, as the system hands them on: the key, then its text.
    fn write(&mut self, text: &str) {
        for sign in text.chars() {
            let key = egui::Key::from_name(&sign.to_string()).or((sign == ' ').then_some(egui::Key::Space));
            let down = key.map(|key| Self::key_event(key, true, Modifiers::NONE));
            let events = down.into_iter().chain([Event::Text(sign.to_string())]).collect();
            self.frame(events, Modifiers::NONE);
            let up = key.map(|key| Self::key_event(key, false, Modifiers::NONE));
            self.frame(up.into_iter().collect(), Modifiers::NONE);
        }
    }

    // What both do, each in his way.

    /// A key of the panel.
    pub fn key(&mut self, key: Key) {
        match self.hand {
            Hand::Fingers => self.tap(&format!("{} {}", key.label().zh, key.id())),
            Hand::Keyboard => {
                let kind = self.rig.kind();
                assert!(key.exists_on(kind), "{}", key.id());
                let shortcut = SHORTCUTS.iter().find(|shortcut| shortcut.key == key).expect("every key has one");
                self.strike(shortcut.physical, shortcut.modifiers);
            }
        }
        self.look();
    }

    /// A page by its soft key, from whichever row is shown.
    pub fn page(&mut self, page: Page) {
        if page == Page::Designer {
            return self.designer();
        }
        let opens = |act: SoftKeyAction| match act {
            SoftKeyAction::Open(other) => other == page,
            SoftKeyAction::Position(_) => page == Page::Position,
            SoftKeyAction::Print | SoftKeyAction::Continue => false,
        };
        let kind = self.rig.kind();
        let soft = |row: usize| soft_row(kind, row).position(|soft| opens(soft.action));
        let row = (0..SOFT_ROWS).find(|row| soft(*row).is_some()).unwrap_or_else(|| panic!("{page:?}"));
        let index = soft(row).unwrap();
        let soft = soft_row(kind, row).nth(index).unwrap();
        let label = format!("{} f{}", soft.label.zh, index + 1);
        for _ in 0..SOFT_ROWS {
            if self.sees(&label) {
                break;
            }
            match self.hand {
                Hand::Fingers => self.tap("▶ next-row"),
                Hand::Keyboard => self.plain(egui::Key::F6),
            }
            self.look();
        }
        match self.hand {
            Hand::Fingers => self.tap(&label),
            Hand::Keyboard => {
                assert!(self.sees(&label), "{page:?}");
                const F: [egui::Key; 5] = [egui::Key::F1, egui::Key::F2, egui::Key::F3, egui::Key::F4, egui::Key::F5];
                self.plain(F[index]);
            }
        }
        self.look();
        assert_eq!(self.snapshot().page, page, "{:?}", self.hand);
    }

    /// The page designer has no soft key: the pages whose text it changes lead to it.
    fn designer(&mut self) {
        match self.hand {
            Hand::Fingers => {
                self.page(Page::Directory);
                self.tap("页面设计 design-page");
            }
            Hand::Keyboard => {
                let first = self.snapshot().directory[0].number;
                self.load(first);
                self.page(Page::Program);
                // The last key of the row.
                self.plain(egui::Key::ArrowLeft);
                self.plain(egui::Key::Enter);
            }
        }
        self.look();
        assert_eq!(self.snapshot().page, Page::Designer, "{:?}", self.hand);
    }

    /// A program is chosen in the directory and loaded.
    pub fn load(&mut self, number: u32) {
        self.page(Page::Directory);
        let name = format!("O{number:04}");
        let rows = &self.snapshot().directory;
        let row_of = |number| rows.iter().position(|row| row.number == number);
        let (to, from) = (row_of(number).expect("the program is there"), row_of(self.snapshot().program.number));
        match self.hand {
            Hand::Fingers => {
                for _ in 0..6 {
                    if self.sees(&name) {
                        break;
                    }
                    self.swipe(from.is_none_or(|from| to > from));
                }
                self.tap(&name);
                self.tap("装入 load-program");
            }
            Hand::Keyboard => {
                let from = from.unwrap_or(0);
                let step = if to > from { egui::Key::ArrowDown } else { egui::Key::ArrowUp };
                (0..to.abs_diff(from)).for_each(|_| self.plain(step));
                self.plain(egui::Key::Enter);
            }
        }
        self.look();
        assert_eq!(self.snapshot().program.number, number, "{:?}: {}", self.hand, self.snapshot().message.text.zh());
    }

    /// A value on the grinding page.
    pub fn value(&mut self, variable: u16, text: &str) {
        match self.hand {
            Hand::Fingers => {
                let label = self.rows().into_iter().find(|(number, _)| *number == variable).expect("on the page").1;
                self.tap(&format!("{label} #{variable}"));
                self.pad(text);
            }
            Hand::Keyboard => {
                let wanted = self.rows().iter().position(|(number, _)| *number == variable).expect("on the page");
                for _ in 0..20 {
                    if self.screen.state().hmi.variable_entry().unwrap().cursor == wanted {
                        break;
                    }
                    self.plain(egui::Key::ArrowDown);
                }
                self.write(text);
                self.plain(egui::Key::Enter);
            }
        }
        self.look();
        let now = self.snapshot().variables[usize::from(variable)];
        assert_eq!(now.map(f64::to_bits), text.parse().ok().map(f64::to_bits), "{:?} #{variable}", self.hand);
    }

    /// Variables of the grinding page and their labels, in the order of the cursor.
    fn rows(&self) -> Vec<(u16, String)> {
        let text = self.snapshot().page_files().unwrap().text.as_ref().expect("a page text");
        let rows = text.left.iter().chain(&text.right).flatten();
        rows.map(|row| (row.variable, row.label.clone())).collect()
    }

    /// Digits on the numeric pad, or on the keyboard, and 输入.
    pub fn number(&mut self, text: &str) {
        match self.hand {
            Hand::Fingers => self.pad(text),
            Hand::Keyboard => {
                self.write(text);
                self.plain(egui::Key::Enter);
            }
        }
        self.look();
    }

    fn pad(&mut self, text: &str) {
        for sign in text.chars() {
            match sign {
                '.' => self.tap("pad-point"),
                '-' => self.tap("pad-sign"),
                digit => self.tap(&format!("pad-{digit}")),
            }
        }
        self.tap("输入 input");
    }

    /// Words on the letter board, or on the keyboard, and 输入.
    pub fn words(&mut self, text: &str) {
        match self.hand {
            Hand::Fingers => {
                for sign in text.chars() {
                    let label = if sign == ' ' { "空格".to_owned() } else { sign.to_string() };
                    self.tap(&format!("{label} letter-{sign}"));
                }
                self.tap("输入 letter-done");
            }
            Hand::Keyboard => {
                self.write(text);
                self.plain(egui::Key::Enter);
            }
        }
        self.look();
    }

    /// A key of a page: by its label, or by what the keyboard has for it.
    pub fn page_key(&mut self, label: &str, keys: &[(egui::Key, Modifiers)]) {
        match self.hand {
            Hand::Fingers => self.tap(label),
            Hand::Keyboard => keys.iter().for_each(|(key, modifiers)| self.strike(*key, *modifiers)),
        }
        self.look();
    }
}
