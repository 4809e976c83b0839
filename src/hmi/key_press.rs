//! Touches and physical keys on panel keys: when a press counts, when it ends, and the repeated hold of a jog key.
//! Source: spec H9, K2; link::Command (Press once, Hold every 50 ms at least, Release).

use egui::{Modifiers, Rect, Response, Ui};

use super::pointer_finger::second_touches;
use crate::defs::key::{Key, KeyGroup};
use crate::link::Command;

/// How long a finger rests on a key until the screen explains the key instead of pressing it, s. The slow touch of a gloved
/// hand is shorter.
const LONG_PRESS_S: f64 = 1.5;
/// How long touches of the emergency stop are one slap, s.
const SLAP_S: f64 = 0.8;
/// Time between two `Command::StillHeld`, s.
const HOLD_REPEAT_S: f64 = 0.03;

/// When a press of a key takes effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeyTrigger {
    /// While the finger stays on the key.
    WhileHeld,
    /// In the frame of the press: a stop key must not wait.
    OnPress,
    /// When the finger is lifted inside the key: a swipe does nothing.
    OnRelease,
}

/// When a press of a key takes effect.
pub const fn trigger_of(key: Key) -> KeyTrigger {
    match key {
        Key::EmergencyStop | Key::FeedHold | Key::Reset => KeyTrigger::OnPress,
        _ if key.jog_direction().is_some() => KeyTrigger::WhileHeld,
        _ => KeyTrigger::OnRelease,
    }
}

/// Whether a long touch explains a key: only one that starts or selects something, and not one that is on. Who rests on a
/// key that stops, retracts or slows wants it to act.
pub fn is_explained(key: Key, is_on: bool) -> bool {
    let stops = matches!(key, Key::WheelStop | Key::HeadstockStop | Key::SpindleStop | Key::WheelRetract);
    let is_override = key.row().group == KeyGroup::Override;
    !is_on && !stops && !is_override && trigger_of(key) == KeyTrigger::OnRelease
}

/// State of a key that is held down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PressState {
    /// Takes effect when the finger is lifted.
    Armed,
    /// `Press` has been sent and `Release` has not.
    Sent,
    /// Released, or explained, although the finger is still down; ignored until the next touch.
    Cancelled,
}

/// A key that is held down.
#[derive(Clone, Copy, Debug)]
struct HeldKey {
    key: Key,
    state: PressState,
    since: f64,
    last: f64,
    /// A finger presses it, no mouse and no key.
    by_finger: bool,
    /// Drawn in this frame: a key that disappears from the screen is released.
    drawn: bool,
}

/// All keys that are held down.
#[derive(Debug, Default)]
pub struct KeyPresses {
    finger: Option<HeldKey>,
    physical: Vec<(egui::Key, Modifiers, HeldKey)>,
    /// A key that is to be explained.
    explained: Option<Key>,
    /// When the emergency stop was touched last, s.
    stopped_at: Option<f64>,
}

impl KeyPresses {
    /// Follows the finger on one key; true while the key is drawn pressed.
    pub fn track_touch(&mut self, ui: &Ui, response: &Response, rect: Rect, key: Key, out: &mut Vec<Command>) -> bool {
        let (now, inside, lifted, lost) = ui.input(|input| {
            let place = release_position(input).or(input.pointer.interact_pos());
            let inside = place.is_some_and(|place| rect.contains(place));
            (input.time, inside, input.pointer.any_released(), focus_lost(input))
        });
        let (touched, fingers) = ui.input(|input| (input.any_touches(), input.multi_touch().is_some()));
        let held = response.is_pointer_button_down_on();
        let lifted_unseen = self.finger.is_some_and(|down| down.key == key && down.by_finger && !touched);
        let on_it = held && inside && !lost && !lifted_unseen;
        // A stop key must not wait until another finger has been lifted.
        if trigger_of(key) == KeyTrigger::OnPress
            && ui.input(|input| second_touches(input).any(|place| rect.contains(place)))
        {
            out.extend([self.press_command(key, now, true), Command::Release(key)]);
        }
        match self.finger.filter(|down| down.key == key) {
            None if on_it && self.finger.is_none() => {
                let at_once = trigger_of(key) != KeyTrigger::OnRelease;
                let stage = if at_once { PressState::Sent } else { PressState::Armed };
                if at_once {
                    out.push(self.press_command(key, now, false));
                }
                let (since, last, by_finger) = (now, now, touched);
                self.finger = Some(HeldKey { key, state: stage, since, last, by_finger, drawn: true });
            }
            None if response.clicked() && !lost => out.extend([Command::Press(key), Command::Release(key)]),
            None => {}
            Some(down) if on_it => {
                // Two fingers press no key.
                let pinched = fingers && down.state == PressState::Armed;
                let state = if pinched { PressState::Cancelled } else { down.state };
                self.finger = Some(repeat_hold(HeldKey { state, ..down }, now, out));
            }
            Some(down) => {
                let counts = response.clicked() || (lifted && inside);
                match down.state {
                    PressState::Armed if counts && !lost => out.extend([Command::Press(key), Command::Release(key)]),
                    PressState::Sent => out.push(Command::Release(key)),
                    PressState::Armed | PressState::Cancelled => {}
                }
                let stage =
                    if down.state == PressState::Armed && !lost { PressState::Armed } else { PressState::Cancelled };
                self.finger = held.then_some(HeldKey { state: stage, drawn: true, ..down });
            }
        }
        if self.finger.is_some() {
            ui.ctx().request_repaint_after(std::time::Duration::from_millis(20));
        }
        on_it && self.finger.is_some_and(|down| down.key == key && down.state != PressState::Cancelled)
    }

    /// The command of a press. The emergency stop is turned out by a touch of its own alone: a hand that slaps it touches it
    /// with several fingers, one soon after the other.
    fn press_command(&mut self, key: Key, now: f64, is_second: bool) -> Command {
        if key != Key::EmergencyStop {
            return Command::Press(key);
        }
        let slaps = self.stopped_at.replace(now).is_some_and(|before| now - before < SLAP_S);
        if slaps || is_second { Command::EmergencyStop(true) } else { Command::Press(key) }
    }

    /// A finger that rests on a key asks what the key does: from then on it does not press it.
    pub fn explain_long(&mut self, now: f64, key: Key) {
        let rests = |down: &&mut HeldKey| {
            down.key == key && down.state == PressState::Armed && now - down.since >= LONG_PRESS_S
        };
        if let Some(down) = self.finger.as_mut().filter(rests) {
            down.state = PressState::Cancelled;
            self.explained = Some(key);
        }
    }

    /// The key that a long touch asks about; it is not pressed.
    pub const fn take_explained(&mut self) -> Option<Key> {
        self.explained.take()
    }

    /// A physical key presses a panel key.
    pub fn key_down(&mut self, by: egui::Key, modifiers: Modifiers, key: Key, now: f64, out: &mut Vec<Command>) {
        if self.physical.iter().any(|(other, ..)| *other == by) {
            return;
        }
        out.push(Command::Press(key));
        let held = HeldKey { key, state: PressState::Sent, since: now, last: now, by_finger: false, drawn: true };
        self.physical.push((by, modifiers, held));
    }

    /// Releases physical keys that are up, repeats `Hold` for those that are down.
    pub fn track_keyboard(&mut self, ui: &Ui, out: &mut Vec<Command>) {
        let (now, lost, held, modifiers) =
            ui.input(|input| (input.time, focus_lost(input), input.keys_down.clone(), input.modifiers));
        self.physical.retain_mut(|(by, with, down)| {
            if !lost && held.contains(by) && modifiers.contains(*with) {
                *down = repeat_hold(*down, now, out);
                return true;
            }
            out.push(Command::Release(down.key));
            false
        });
        if !self.physical.is_empty() {
            ui.ctx().request_repaint_after(std::time::Duration::from_millis(20));
        }
    }

    /// Releases a key that was not drawn in this frame.
    pub fn end_frame(&mut self, ui: &Ui, out: &mut Vec<Command>) {
        let down = ui.input(|input| input.pointer.any_down());
        let Some(finger) = self.finger.as_mut() else { return };
        if finger.drawn && down {
            finger.drawn = false;
            return;
        }
        if finger.state == PressState::Sent {
            out.push(Command::Release(finger.key));
        }
        self.finger = None;
    }

    /// Whether a physical key holds this panel key down.
    pub fn is_down(&self, key: Key) -> bool {
        self.physical.iter().any(|(_, _, down)| down.key == key)
    }
}

fn repeat_hold(down: HeldKey, now: f64, out: &mut Vec<Command>) -> HeldKey {
    let due = now - down.last >= HOLD_REPEAT_S;
    if down.state == PressState::Sent && trigger_of(down.key) == KeyTrigger::WhileHeld && due {
        out.push(Command::StillHeld(down.key));
    }
    HeldKey { drawn: true, last: if due { now } else { down.last }, ..down }
}

/// Where the finger was lifted in this frame; after a touch egui has no pointer position.
pub fn release_position(input: &egui::InputState) -> Option<egui::Pos2> {
    input.events.iter().rev().find_map(|event| match event {
        egui::Event::PointerButton { pos, pressed: false, .. } => Some(*pos),
        _ => None,
    })
}

/// The window loses the focus in this frame. Only the loss counts: without a window manager it never has the focus.
fn focus_lost(input: &egui::InputState) -> bool {
    input.events.iter().any(|event| matches!(event, egui::Event::WindowFocused(false)))
}
