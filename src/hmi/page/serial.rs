//! RS232 half of the transfer page: port, baud rate and data format, and the number under which a received program is
//! stored if it has none. Source: spec L9.

use egui::accesskit::Role;
use egui::{Align2, Id, Rect, Sense, Ui, WidgetInfo, pos2, vec2};

use crate::defs::kind::Kind;
use crate::defs::param;
use crate::defs::text::LocalizedText;
use crate::hmi::edit_key::EditKey;
use crate::hmi::login::Login;
use crate::hmi::theme;
use crate::hmi::view::{View, card, fit_text, focus_frame, paragraph, text_line};
use crate::hmi::widget::{ButtonState, KeyboardFocus};
use crate::link::Command;
use crate::link::media::MediaView;
use crate::link::page_command::{PageCommand, PasswordScope};

/// Maximum number of digits of a program number.
const MAX_DIGITS: usize = 4;
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
                    self.refused = Some(LocalizedText::new("只能输入 1 到 4 位数字", "1 to 4 digits only"))
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
    /// The number is not 1 to 9999.
    pub fn file_name(&mut self, kind: Kind) -> Result<Option<String>, LocalizedText> {
        if self.number.is_empty() {
            return Ok(None);
        }
        if kind.is_lathe() {
            return Ok(Some(format!("{}.NC", self.number)));
        }
        match self.number.parse::<u16>() {
            Ok(number @ 1..=9_999) => Ok(Some(format!("O{number:04}.NC"))),
            Ok(_) | Err(_) => {
                let said = LocalizedText::new("程序号应为 1 到 9999", "a program number is 1 to 9999");
                self.refused = Some(said.clone());
                Err(said)
            }
        }
    }

    /// Draws the RS232 half.
    pub fn ui(
        &mut self,
        ui: &Ui,
        rect: Rect,
        view: &View<'_>,
        media: &MediaView,
        keys: (&mut KeyboardFocus, &mut Login, &mut Vec<Command>),
    ) {
        let (walk, login, out) = keys;
        let painter = ui.painter();
        let row =
            |top: f32, height: f32| Rect::from_min_size(pos2(rect.min.x, rect.min.y + top), vec2(rect.width(), height));
        let (name, key) = row(0.0, FIELD_HEIGHT).split_left_right_at_x(rect.max.x - 108.0);
        let shown = media.port.as_deref().unwrap_or_else(|| view.text("未选择", "none chosen"));
        let ink = if media.port.is_some() { view.theme.text } else { view.theme.hold };
        let (word, value) = name.split_left_right_at_x(name.min.x + 76.0);
        fit_text(painter, word, Align2::LEFT_CENTER, view.text("端口", "port"), theme::LABEL, view.theme.muted);
        fit_text(painter, value.shrink2(vec2(4.0, 0.0)), Align2::LEFT_CENTER, shown, theme::LABEL, ink);
        let level = view.snapshot.access.level;
        let locked = level < crate::defs::param::AccessLevel::Builder;
        let look = ButtonState { on: false, locked };
        if walk.button(ui, view, key, ("serial-port", view.text("换端口", "CHANGE")), look) {
            if locked {
                login.unlock(view, PasswordScope::Builder);
            } else if let Some(port) = next_port(media) {
                out.push(Command::Page(PageCommand::SetSerialPort(port)));
            }
        }
        let baud = view.snapshot.params.get(param::SERIAL_BAUD);
        let facts = [
            (view.text("波特率", "baud rate"), format!("{baud} bit/s  (P370)")),
            (view.text("格式", "form"), format!("8N1 · XON/XOFF · {}", view.text("% O号 … %", "% O number … %"))),
        ];
        for (index, (word, value)) in facts.iter().enumerate() {
            let line = row(FIELD_HEIGHT + theme::GAP + index as f32 * 26.0, 26.0);
            let (left, right) = line.split_left_right_at_x(line.min.x + 76.0);
            fit_text(painter, left, Align2::LEFT_CENTER, word, theme::LABEL, view.theme.muted);
            fit_text(painter, right.shrink2(vec2(4.0, 0.0)), Align2::LEFT_CENTER, value, theme::LABEL, view.theme.text);
        }
        let top = FIELD_HEIGHT + theme::GAP + 52.0 + theme::GAP;
        self.field(ui, row(top, FIELD_HEIGHT), view);
        let below = Rect::from_min_max(row(top + FIELD_HEIGHT + theme::GAP, 0.0).min, rect.max);
        let (words, ink) = match (&self.refused, media.ports.is_empty()) {
            (Some(said), _) => (said.get(view.lang), view.theme.alarm_text),
            (None, true) => (view.text("本机没有串口，请插入 USB 转串口。", "This computer has no serial port: plug an adapter in."), view.theme.hold),
            (None, false) => (
                view.text(
                    "发送：在左边选择程序，先启动对方接收。\n接收：先按 RS232 → 本机，再启动对方发送。",
                    "To send: choose programs on the left, start receiving there first.\nTo receive: touch FROM RS232, then start sending there.",
                ),
                view.theme.muted,
            ),
        };
        paragraph(painter, below, words, theme::LABEL, ink);
    }

    /// The field 存为.
    fn field(&mut self, ui: &Ui, line: Rect, view: &View<'_>) {
        let painter = ui.painter();
        let (word, field) = line.split_left_right_at_x(line.min.x + 76.0);
        fit_text(painter, word, Align2::LEFT_CENTER, view.text("存为", "store as"), theme::LABEL, view.theme.muted);
        let response = ui.interact(field, Id::unique("serial-name"), Sense::CLICK);
        response.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, "存为 serial-name"));
        if response.clicked() {
            self.pad = !self.pad;
        }
        card(painter, field, view.theme.raised, view.theme.line);
        if self.refused.is_some() {
            focus_frame(painter, field, view.theme.alarm);
        } else if self.pad {
            focus_frame(painter, field, view.theme.focus);
        }
        let inside = field.shrink2(vec2(theme::PAD, 0.0));
        if self.number.is_empty() {
            let words = view.text("程序自带的号", "its own number");
            fit_text(painter, inside, Align2::LEFT_CENTER, words, theme::LABEL, view.theme.muted);
        } else {
            let letter = if view.snapshot.kind.is_lathe() { "" } else { "O" };
            text_line(
                painter,
                inside,
                Align2::LEFT_CENTER,
                &format!("{letter}{}", self.number),
                theme::SECONDARY,
                view.theme.text,
            );
        }
    }
}

/// The port after the selected one.
fn next_port(media: &MediaView) -> Option<String> {
    let at = media.port.as_ref().and_then(|port| media.ports.iter().position(|other| other == port));
    let next = at.map_or(0, |at| at + 1) % media.ports.len().max(1);
    media.ports.get(next).cloned()
}
