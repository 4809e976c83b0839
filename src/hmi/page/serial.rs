//! RS232 half of the transfer page: port, baud rate and data format, and the number under which a received program is
//! stored if it has none. Source: spec L9.

use egui::accesskit::Role;
use egui::{Color32, Rect};

use crate::defs::kind::Kind;
use crate::defs::param;
use crate::defs::program_number::{O_MAX_DIGITS, is_o_number};
use crate::defs::text::{LocalizedText, phrase};
use crate::hmi::{Area, EditKey, KeyboardFocus, Login, PageKey, View, theme};
use crate::link::Command;
use crate::link::media::MediaView;
use crate::link::page_command::{PageCommand, PasswordScope};

/// Maximum number of digits of a program number.
const MAX_DIGITS: usize = O_MAX_DIGITS as usize;
/// Height of the field and of the key.
const FIELD_HEIGHT: f32 = 48.0;

/// State of this half.
#[derive(Debug, Default)]
pub struct SerialPane {
    /// Typed number; empty: the number in the program applies.
    number: String,
    /// Whether the numeric pad is open.
    pub pad: bool,
    /// Why the number is refused, until the next key.
    refused: Option<LocalizedText>,
}

impl SerialPane {
    /// Handles edits of the field; returns the rest for the keys of the page.
    pub fn handle_edits(&mut self, edits: &[EditKey]) -> Vec<EditKey> {
        let mut rest = Vec::new();
        for edit in edits {
            match edit {
                EditKey::Char(sign) if sign.is_ascii_digit() => {
                    if self.refused.take().is_some() || self.number.len() >= MAX_DIGITS {
                        self.number.clear();
                    }
                    self.number.push(*sign);
                }
                EditKey::Char(_) | EditKey::Sign => {
                    self.refused = Some(phrase!("只能输入 1 到 8 位数字", "1 to 8 digits only"))
                }
                EditKey::Backspace | EditKey::Delete => {
                    self.refused = None;
                    self.number.pop();
                }
                EditKey::Cancel if !self.number.is_empty() => {
                    self.refused = None;
                    self.number.clear();
                }
                EditKey::Cancel | EditKey::Enter if self.pad => self.pad = false,
                other => rest.push(*other),
            }
        }
        rest
    }

    /// File name for the typed number; none: the number in the program applies.
    ///
    /// # Errors
    /// The number is not 1 to 99 999 999.
    pub fn file_name(&mut self, kind: Kind) -> Result<Option<String>, LocalizedText> {
        if self.number.is_empty() {
            return Ok(None);
        }
        if kind.is_lathe() {
            return Ok(Some(format!("{}.NC", self.number)));
        }
        match self.number.parse::<u32>() {
            Ok(number) if is_o_number(number) => Ok(Some(format!("O{number:04}.NC"))),
            Ok(_) | Err(_) => {
                let message = phrase!("程序号为 1 到 8 位数字", "a program number has 1 to 8 digits");
                self.refused = Some(message.clone());
                Err(message)
            }
        }
    }

    /// Draws the RS232 half; true if its key 换端口 was pressed.
    pub fn ui(&mut self, rect: Rect, view: &View<'_>, media: &MediaView, walk: &mut KeyboardFocus) -> bool {
        let (name, key) = rect.band(0.0, FIELD_HEIGHT).split_right(108.0);
        let ink = if media.port.is_some() { view.theme.text } else { view.theme.hold };
        let shown = media.port.as_deref().unwrap_or_else(|| view.text("未选择", "none chosen"));
        fact(view, name, view.text("端口", "port"), shown, ink);
        let change = PageKey::new("serial-port", view.text("换端口", "CHANGE")).locked(is_port_locked(view));
        let pressed = walk.button(view, key, change);
        let baud = view.snapshot.params.get(param::SERIAL_BAUD);
        let settings = [
            (view.text("波特率", "baud rate"), format!("{baud} bit/s  (P370)")),
            (view.text("格式", "format"), format!("8N1 · XON/XOFF · {}", view.text("% O号 … %", "% O number … %"))),
        ];
        for (index, (word, value)) in settings.iter().enumerate() {
            fact(view, rect.band(FIELD_HEIGHT + theme::GAP + index as f32 * 26.0, 26.0), word, value, view.theme.text);
        }
        let top = FIELD_HEIGHT + theme::GAP + 52.0 + theme::GAP;
        self.field(rect.band(top, FIELD_HEIGHT), view);
        let below = rect.trim_top(top + FIELD_HEIGHT + theme::GAP);
        let (words, ink) = match (&self.refused, media.ports.is_empty()) {
            (Some(message), _) => (message.get(view.lang), view.theme.alarm_text),
            (None, true) => (view.text("本机没有串口，请插入 USB 转串口。", "This computer has no serial port: plug an adapter in.").into(), view.theme.hold),
            (None, false) => (
                view.text(
                    "发送：在左边选择程序，先启动对方接收。\n接收：先按 RS232 → 本机，再启动对方发送。",
                    "To send: choose programs on the left, start receiving there first.\nTo receive: touch FROM RS232, then start sending there.",
                ).into(),
                view.theme.muted,
            ),
        };
        view.paragraph(below, &words, theme::LABEL, ink);
        pressed
    }

    /// The field 存为.
    fn field(&mut self, line: Rect, view: &View<'_>) {
        let (word, field) = line.split_left(76.0);
        view.fit_left(word, view.text("存为", "store as"), theme::LABEL, view.theme.muted);
        if view.touch_as(Role::TextInput, field, "serial-name", "存为 serial-name").clicked() {
            self.pad = !self.pad;
        }
        view.filled_card(field, view.theme.raised, view.theme.line);
        if self.refused.is_some() {
            view.frame(field, view.theme.alarm);
        } else if self.pad {
            view.frame(field, view.theme.focus);
        }
        let inside = field.trim_sides(theme::PAD);
        if self.number.is_empty() {
            view.fit_left(inside, view.text("程序自带的号", "its own number"), theme::LABEL, view.theme.muted);
        } else {
            let letter = if view.snapshot.kind.is_lathe() { "" } else { "O" };
            view.line_left(inside, &format!("{letter}{}", self.number), theme::SECONDARY, view.theme.text);
        }
    }
}

/// A word and its value.
fn fact(view: &View<'_>, line: Rect, word: &str, value: &str, ink: Color32) {
    let (left, right) = line.split_left(76.0);
    view.fit_left(left, word, theme::LABEL, view.theme.muted);
    view.fit_left(right.trim_sides(4.0), value, theme::LABEL, ink);
}

fn is_port_locked(view: &View<'_>) -> bool {
    view.snapshot.access.level < param::AccessLevel::Builder
}

/// Changes to the next port, or asks for the password.
pub fn change_port(view: &View<'_>, media: &MediaView, login: &mut Login, out: &mut Vec<Command>) {
    if is_port_locked(view) {
        login.unlock(view, PasswordScope::Builder);
    } else if let Some(port) = next_port(media) {
        out.push(Command::Page(PageCommand::SetSerialPort(port)));
    }
}

/// The port after the selected one.
fn next_port(media: &MediaView) -> Option<String> {
    let at = media.port.as_ref().and_then(|port| media.ports.iter().position(|other| other == port));
    let next = at.map_or(0, |at| at + 1) % media.ports.len().max(1);
    media.ports.get(next).cloned()
}
