//! Keyboard shortcuts of the panel keys: one table for key handling, help and manual. The keys that edit a value or a
//! text, from the keyboard or the numeric pad.
//! Source: spec K2.1 (same keys reachable from a keyboard), H6.

use egui::{Event, Modifiers, Ui};

use crate::defs::key::Key;

/// A physical key for a panel key.
#[derive(Clone, Copy, Debug)]
pub struct Shortcut {
    /// Modifiers held with it.
    pub modifiers: Modifiers,
    /// The physical key.
    pub physical: egui::Key,
    /// The panel key.
    pub key: Key,
}

const fn plain(physical: egui::Key, key: Key) -> Shortcut {
    Shortcut { modifiers: Modifiers::NONE, physical, key }
}

const fn alt(physical: egui::Key, key: Key) -> Shortcut {
    Shortcut { modifiers: Modifiers::ALT, physical, key }
}

const fn ctrl(physical: egui::Key, key: Key) -> Shortcut {
    Shortcut { modifiers: Modifiers::CTRL, physical, key }
}

/// Every panel key with its physical key. Panel keys that share a physical key exist on different kinds.
/// Jog shortcuts name axes, not screen directions: on GC the left and right keys of the screen are Z.
pub const SHORTCUTS: &[Shortcut] = &[
    plain(egui::Key::F8, Key::EmergencyStop),
    plain(egui::Key::F9, Key::CycleStart),
    plain(egui::Key::F10, Key::FeedHold),
    plain(egui::Key::Space, Key::FeedHold),
    plain(egui::Key::F11, Key::Reset),
    ctrl(egui::Key::Num1, Key::ModeEdit),
    ctrl(egui::Key::Num2, Key::ModeAuto),
    ctrl(egui::Key::Num3, Key::ModeMdi),
    ctrl(egui::Key::Num4, Key::ModeHome),
    ctrl(egui::Key::Num5, Key::ModeHandwheel),
    ctrl(egui::Key::Num6, Key::ModeStep),
    ctrl(egui::Key::Num7, Key::ModeManual),
    ctrl(egui::Key::B, Key::SingleBlock),
    ctrl(egui::Key::K, Key::BlockSkip),
    ctrl(egui::Key::O, Key::OptionalStop),
    ctrl(egui::Key::L, Key::MachineLock),
    ctrl(egui::Key::T, Key::AuxFunctionLock),
    ctrl(egui::Key::D, Key::DryRun),
    ctrl(egui::Key::PageUp, Key::FeedOverrideUp),
    ctrl(egui::Key::PageDown, Key::FeedOverrideDown),
    ctrl(egui::Key::Home, Key::SpindleOverrideUp),
    ctrl(egui::Key::End, Key::SpindleOverrideDown),
    alt(egui::Key::Num0, Key::RapidF0),
    alt(egui::Key::Num1, Key::Rapid25),
    alt(egui::Key::Num2, Key::Rapid50),
    alt(egui::Key::Num3, Key::Rapid100),
    alt(egui::Key::Num4, Key::Step0001),
    alt(egui::Key::Num5, Key::Step001),
    alt(egui::Key::Num6, Key::Step01),
    alt(egui::Key::X, Key::HandwheelX),
    alt(egui::Key::Y, Key::HandwheelY),
    alt(egui::Key::Z, Key::HandwheelZ),
    alt(egui::Key::U, Key::XPlus),
    alt(egui::Key::J, Key::XMinus),
    alt(egui::Key::I, Key::YPlus),
    alt(egui::Key::K, Key::YMinus),
    alt(egui::Key::O, Key::ZPlus),
    alt(egui::Key::L, Key::ZMinus),
    alt(egui::Key::T, Key::Rapid),
    alt(egui::Key::W, Key::WheelStart),
    alt(egui::Key::Q, Key::WheelStop),
    alt(egui::Key::E, Key::SecondSpindle),
    alt(egui::Key::W, Key::SpindleForward),
    alt(egui::Key::E, Key::SpindleReverse),
    alt(egui::Key::Q, Key::SpindleStop),
    alt(egui::Key::N, Key::ToolTurret),
    alt(egui::Key::H, Key::HeadstockHigh),
    alt(egui::Key::G, Key::HeadstockLow),
    alt(egui::Key::F, Key::HeadstockStop),
    alt(egui::Key::H, Key::DresserRoll),
    alt(egui::Key::H, Key::TableRotation),
    alt(egui::Key::N, Key::TailstockAdvance),
    alt(egui::Key::M, Key::TailstockRetract),
    alt(egui::Key::N, Key::Magnetise),
    alt(egui::Key::M, Key::Demagnetise),
    alt(egui::Key::C, Key::Coolant),
    alt(egui::Key::V, Key::Lubrication),
    alt(egui::Key::P, Key::Hydraulic),
    alt(egui::Key::R, Key::RadialGauge),
    alt(egui::Key::A, Key::AxialGauge),
    alt(egui::Key::S, Key::Oscillation),
    alt(egui::Key::D, Key::DressReturn),
    alt(egui::Key::B, Key::WheelRetract),
];

/// One key of the numeric pad or of the keyboard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EditKey {
    /// 0–9 or the decimal point.
    Char(char),
    /// Changes the sign.
    Sign,
    /// Deletes the last character.
    Backspace,
    /// Deletes the character behind the cursor; without a text cursor, the last one.
    Delete,
    /// Moves to the start of the line.
    LineStart,
    /// Moves to the end of the line.
    LineEnd,
    /// INPUT (输入): accepts the value.
    Enter,
    /// CANCEL (取消): discards the value.
    Cancel,
    /// Moves to the field above.
    Up,
    /// Moves to the field below.
    Down,
    /// Moves to the other column.
    Left,
    /// Moves to the other column.
    Right,
    /// Moves to the next field.
    Next,
    /// Moves to the previous field.
    Previous,
}

impl EditKey {
    /// The field that a cursor key selects from `here`, of `count` fields in rows of `columns`, around the ends; none
    /// for a key that does not move the cursor.
    pub const fn step(self, here: usize, count: usize, columns: usize) -> Option<usize> {
        let forward = match self {
            Self::Up => count.saturating_sub(columns),
            Self::Down => columns,
            Self::Left | Self::Previous => count - 1,
            Self::Right | Self::Next => 1,
            Self::Char(_) | Self::Sign | Self::Backspace | Self::Delete => return None,
            Self::LineStart | Self::LineEnd | Self::Enter | Self::Cancel => return None,
        };
        Some((here + forward) % count)
    }
}

/// What was typed into a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TypedInput {
    /// A character; no control character.
    Char(char),
    /// An edit or cursor key.
    Key(EditKey),
}

/// The keyboard input of one frame.
#[derive(Debug, Default)]
pub struct KeyboardInput {
    /// Panel keys pressed in this frame, with the physical key and its modifiers.
    pub keys: Vec<Shortcut>,
    /// Edit and cursor keys.
    pub edits: Vec<EditKey>,
    /// All typed characters.
    pub text: String,
    /// Characters and edit keys as they were typed, one after the other; for texts. A frame may hold several lines.
    pub in_order: Vec<TypedInput>,
    /// Address keys X Y Z.
    pub address_keys: Vec<Key>,
    /// Keys with Ctrl that are not panel keys, for the pages.
    pub ctrl_keys: Vec<egui::Key>,
    /// A soft key, 0–4.
    pub soft_key: Option<usize>,
    /// F6: next row of soft keys.
    pub next_soft_row: bool,
    /// Shift+F6: previous row of soft keys.
    pub previous_soft_row: bool,
    /// Ctrl+F6: the map of the pages.
    pub page_map: bool,
    /// F12: help overlay.
    pub help: bool,
    /// F7: alarm page.
    pub alarm_page: bool,
    /// Pages to scroll: page up is −1, page down is 1.
    pub scroll_pages: i32,
    /// Detents of the handwheel.
    pub handwheel_detents: i32,
    /// Steps by which the zoomed part moves: right and down are positive.
    pub zoom_steps: egui::Vec2,
}

/// Reads the keyboard of this frame. `words`: a page takes text and nothing runs, so the space bar types a space.
pub fn read(ui: &Ui, machine: crate::defs::fitted::Fitted, words: bool) -> KeyboardInput {
    let mut asked = KeyboardInput::default();
    let events = ui.input(|input| input.events.clone());
    // Alt with a digit is a panel key, not a digit; egui sends the text event right after the key event.
    let mut alt = false;
    for event in &events {
        match event {
            Event::Key { key, pressed: true, repeat, modifiers, .. } => {
                alt = modifiers.alt;
                let modified = modifiers.alt || modifiers.ctrl || modifiers.command;
                let is_it = |shortcut: &&Shortcut| {
                    shortcut.physical == *key
                        && modifiers.matches_exact(shortcut.modifiers)
                        && shortcut.key.exists_on(machine)
                };
                let found = SHORTCUTS.iter().find(is_it).filter(|_| !(words && !modified && *key == egui::Key::Space));
                match found {
                    Some(shortcut) if !repeat => asked.keys.push(*shortcut),
                    Some(_) => {}
                    None if modifiers.ctrl && *key == egui::Key::F6 => asked.page_map = true,
                    None if modifiers.ctrl && !modifiers.alt => asked.ctrl_keys.push(*key),
                    None if modifiers.alt => {
                        asked.handwheel_detents += detent_of(*key);
                        asked.zoom_steps += step_of(*key);
                    }
                    None if !modified => asked.add_unmodified(*key, modifiers.shift),
                    None => {}
                }
            }
            // egui turns Ctrl+C, Ctrl+X and Ctrl+V into these events.
            Event::Copy => asked.ctrl_keys.push(egui::Key::C),
            Event::Cut => asked.ctrl_keys.push(egui::Key::X),
            Event::Paste(_) => asked.ctrl_keys.push(egui::Key::V),
            Event::Text(text) if !alt => {
                asked.edits.extend(text.chars().filter_map(edit_key_of));
                asked.text.push_str(text);
                asked.in_order.extend(text.chars().filter(|sign| !sign.is_control()).map(TypedInput::Char));
            }
            _ => {}
        }
    }
    asked
}

/// Alt with comma or period turns the handwheel by one detent.
const fn detent_of(key: egui::Key) -> i32 {
    match key {
        egui::Key::Comma => -1,
        egui::Key::Period => 1,
        _ => 0,
    }
}

/// Alt with a cursor key moves the zoomed part by a step.
const fn step_of(key: egui::Key) -> egui::Vec2 {
    match key {
        egui::Key::ArrowLeft => egui::vec2(-1.0, 0.0),
        egui::Key::ArrowRight => egui::vec2(1.0, 0.0),
        egui::Key::ArrowUp => egui::vec2(0.0, -1.0),
        egui::Key::ArrowDown => egui::vec2(0.0, 1.0),
        _ => egui::Vec2::ZERO,
    }
}

const fn edit_key_of(sign: char) -> Option<EditKey> {
    match sign {
        '0'..='9' | '.' => Some(EditKey::Char(sign)),
        '-' => Some(EditKey::Sign),
        _ => None,
    }
}

impl KeyboardInput {
    fn add_edit(&mut self, edit: EditKey) {
        self.edits.push(edit);
        self.in_order.push(TypedInput::Key(edit));
    }

    fn add_unmodified(&mut self, key: egui::Key, shift: bool) {
        match key {
            egui::Key::F1 => self.soft_key = Some(0),
            egui::Key::F2 => self.soft_key = Some(1),
            egui::Key::F3 => self.soft_key = Some(2),
            egui::Key::F4 => self.soft_key = Some(3),
            egui::Key::F5 => self.soft_key = Some(4),
            egui::Key::F6 if shift => self.previous_soft_row = true,
            egui::Key::F6 => self.next_soft_row = true,
            egui::Key::F7 => self.alarm_page = true,
            egui::Key::F12 => self.help = true,
            egui::Key::X => self.address_keys.push(Key::AddressX),
            egui::Key::Y => self.address_keys.push(Key::AddressY),
            egui::Key::Z => self.address_keys.push(Key::AddressZ),
            egui::Key::PageUp => self.scroll_pages -= 1,
            egui::Key::PageDown => self.scroll_pages += 1,
            egui::Key::Enter => self.add_edit(EditKey::Enter),
            egui::Key::Escape => self.add_edit(EditKey::Cancel),
            egui::Key::Backspace => self.add_edit(EditKey::Backspace),
            egui::Key::Delete => self.add_edit(EditKey::Delete),
            egui::Key::Home => self.add_edit(EditKey::LineStart),
            egui::Key::End => self.add_edit(EditKey::LineEnd),
            egui::Key::ArrowUp => self.add_edit(EditKey::Up),
            egui::Key::ArrowDown => self.add_edit(EditKey::Down),
            egui::Key::ArrowLeft => self.add_edit(EditKey::Left),
            egui::Key::ArrowRight => self.add_edit(EditKey::Right),
            egui::Key::Tab if shift => self.add_edit(EditKey::Previous),
            egui::Key::Tab => self.add_edit(EditKey::Next),
            _ => {}
        }
    }
}
