//! The password dialog: asks for a password or replaces one. Digits only, for the numeric pad; shown as dots.
//! The text is sent to the core and not kept here.
//! Source: spec B6, H6.

use egui::accesskit::Role;
use egui::{Id, Rect, Sense, WidgetInfo, pos2, vec2};

use super::{Area, EditKey, PageKey, View, theme, widget};
use crate::defs::text::Text;
use crate::link::Command;
use crate::link::page_command::{PASSWORD_LENGTH, PageCommand, PasswordScope, Secret};

/// What the dialog asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PasswordStep {
    /// The password that unlocks a level.
    Unlock,
    /// The old password.
    Old,
    /// The new password.
    New,
    /// The new password again.
    Repeat,
}

/// An open dialog.
#[derive(Debug)]
struct PasswordDialog {
    scope: PasswordScope,
    step: PasswordStep,
    text: String,
    old: String,
    new: String,
    /// Number of answers of the core before the request; any other number is the answer.
    answers: u32,
    sent: bool,
    refused: Option<Text>,
}

/// The dialog; `None` while closed.
#[derive(Debug, Default)]
pub struct Login {
    dialog: Option<PasswordDialog>,
}

impl Login {
    /// Opens the dialog to unlock a level.
    pub fn unlock(&mut self, view: &View<'_>, guard: PasswordScope) {
        self.start(view, guard, PasswordStep::Unlock);
    }

    /// Opens the dialog to replace a password.
    pub fn change(&mut self, view: &View<'_>, guard: PasswordScope) {
        self.start(view, guard, PasswordStep::Old);
    }

    fn start(&mut self, view: &View<'_>, guard: PasswordScope, step: PasswordStep) {
        let answers = view.snapshot.access.answer_count;
        let (text, old, new) = (String::new(), String::new(), String::new());
        self.dialog = Some(PasswordDialog { scope: guard, step, text, old, new, answers, sent: false, refused: None });
    }

    /// Whether the dialog is open and takes the input.
    pub const fn is_open(&self) -> bool {
        self.dialog.is_some()
    }

    /// Closes the dialog and discards its texts.
    pub fn close(&mut self) {
        self.dialog = None;
    }

    /// Draws the dialog over a page and handles its input.
    pub fn ui(&mut self, rect: Rect, view: &View<'_>, edits: &[EditKey], out: &mut Vec<Command>) {
        self.check_answer(view);
        let Some(talk) = self.dialog.as_mut() else { return };
        for edit in edits {
            if talk.handle_key(*edit, out) {
                self.dialog = None;
                return;
            }
        }
        if draw(rect, view, talk).is_some_and(|touched| talk.handle_key(touched, out)) {
            self.dialog = None;
        }
    }

    /// Checks the core's answer: closes the dialog, or shows the reason of the refusal.
    fn check_answer(&mut self, view: &View<'_>) {
        let access = view.snapshot.access;
        let Some(talk) = self.dialog.as_mut().filter(|talk| talk.sent && access.answer_count != talk.answers) else {
            return;
        };
        match access.refused {
            None => self.dialog = None,
            Some(reason) => {
                (talk.sent, talk.answers, talk.refused) = (false, access.answer_count, Some(reason));
                if talk.step != PasswordStep::Unlock {
                    talk.step = PasswordStep::Old;
                }
            }
        }
    }
}

impl PasswordDialog {
    /// Handles one key; true if the dialog closes.
    fn handle_key(&mut self, edit: EditKey, out: &mut Vec<Command>) -> bool {
        if self.sent {
            return edit == EditKey::Cancel;
        }
        self.refused = self.refused.filter(|_| edit == EditKey::Enter && self.text.is_empty());
        match edit {
            EditKey::Char(sign) if sign.is_ascii_digit() && self.text.len() < *PASSWORD_LENGTH.end() => {
                self.text.push(sign);
            }
            EditKey::Backspace | EditKey::Delete => drop(self.text.pop()),
            EditKey::Cancel => return true,
            EditKey::Enter if !self.text.is_empty() => self.enter(out),
            _ => {}
        }
        false
    }

    fn enter(&mut self, out: &mut Vec<Command>) {
        let text = std::mem::take(&mut self.text);
        match self.step {
            PasswordStep::Unlock => {
                self.sent = true;
                out.push(Command::Page(PageCommand::Unlock(self.scope, Secret::new(text))));
            }
            PasswordStep::Old => (self.old, self.step) = (text, PasswordStep::New),
            PasswordStep::New if !PASSWORD_LENGTH.contains(&text.len()) => {
                self.refused = Some(Text::new("新密码为 4 到 16 位数字", "a new password has 4 to 16 digits"));
            }
            PasswordStep::New => (self.new, self.step) = (text, PasswordStep::Repeat),
            PasswordStep::Repeat if text != self.new => {
                self.refused = Some(Text::new("两次输入不一致，请重新输入", "the two differ: type it again"));
                self.step = PasswordStep::New;
            }
            PasswordStep::Repeat => {
                self.sent = true;
                let (old, new) = (Secret::new(std::mem::take(&mut self.old)), Secret::new(text));
                out.push(Command::Page(PageCommand::ChangePassword { scope: self.scope, old, new }));
            }
        }
    }

    const fn prompt(&self) -> Text {
        match self.step {
            PasswordStep::Unlock => Text::new("请输入密码", "type the password"),
            PasswordStep::Old => Text::new("请输入原密码", "type the old password"),
            PasswordStep::New => Text::new("请输入新密码（4 到 16 位数字）", "type the new password (4 to 16 digits)"),
            PasswordStep::Repeat => Text::new("请再次输入新密码", "type the new password once more"),
        }
    }
}

/// Draws the dialog. Returns the key that was touched: 取消 or 确认.
fn draw(rect: Rect, view: &View<'_>, talk: &PasswordDialog) -> Option<EditKey> {
    view.veil(rect, "login-veil");
    let rect = rect.intersect(view.ui.clip_rect());
    *view.prompt.borrow_mut() = talk.refused.unwrap_or(talk.prompt()).get(view.lang).to_owned();
    // In the upper part of the page: the numeric pad needs the lower one.
    let middle = rect.center_top() + vec2(0.0, 3.0 * theme::PAD + 118.0);
    let place = Rect::from_center_size(middle, vec2(440.0_f32.min(rect.width() - 24.0), 236.0));
    view.filled_card(place, view.theme.surface, view.theme.focus);
    let inside = place.shrink2(vec2(20.0, theme::PAD));
    let row = |top: f32, height: f32| inside.band(top, height);
    let title = format!("{} · {}", talk.scope.name().get(view.lang), view.text("密码", "password"));
    view.fit_left(row(0.0, 30.0), &title, theme::SECONDARY, view.theme.text);
    view.fit_left(row(34.0, 26.0), talk.prompt().get(view.lang), theme::LABEL, view.theme.muted);
    let field = row(66.0, 52.0);
    view.filled_card(field, view.theme.raised, view.theme.line);
    view.frame(field, if talk.refused.is_some() { view.theme.alarm } else { view.theme.focus });
    view.entry.set(Some(place));
    let response = view.ui.interact(field, Id::unique("password"), Sense::HOVER);
    response.widget_info(|| WidgetInfo::labeled(Role::PasswordInput, true, "密码 password"));
    let dots =
        if talk.sent { view.text("正在核对…", "checking…").to_owned() } else { "●".repeat(talk.text.len()) };
    let ink = if talk.sent { view.theme.muted } else { view.theme.text };
    view.line_left(field.trim_sides(theme::PAD), &dots, theme::SECONDARY, ink);
    if let Some(reason) = talk.refused {
        view.paragraph(row(126.0, 40.0), reason.get(view.lang), theme::LABEL, view.theme.alarm_text);
    }
    let enter = Rect::from_min_size(pos2(inside.max.x - 120.0, inside.max.y - 48.0), vec2(120.0, 48.0));
    let cancel = enter.translate(vec2(-128.0, 0.0));
    let ready = !talk.text.is_empty() && !talk.sent;
    let cancelled = widget::button(view, cancel, PageKey::new("login-cancel", view.text("取消", "CANCEL")));
    let entered = widget::button(view, enter, PageKey::new("login-enter", view.text("确认", "OK")).locked(!ready));
    cancelled.then_some(EditKey::Cancel).or((entered && ready).then_some(EditKey::Enter))
}
