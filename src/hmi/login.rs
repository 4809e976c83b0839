//! The password dialog: asks for a password or replaces one. Digits only, for the numeric pad; shown as dots.
//! The text is sent to the core and not kept here.
//! Source: spec B6, H6.

use egui::accesskit::Role;
use egui::{Align2, Id, Rect, Sense, Ui, WidgetInfo, pos2, vec2};

use super::entry::Edit;
use super::theme;
use super::view::{View, card, fit, frame, paragraph, put};
use super::widget::{self, Look};
use crate::defs::text::Text;
use crate::link::Command;
use crate::link::page_command::{Guard, PASSWORD_LENGTH, PageCommand, Secret};

/// What the dialog asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    /// The password that unlocks a level.
    Unlock,
    /// The old password.
    Old,
    /// The new password.
    New,
    /// The new password again.
    Again,
}

/// An open dialog.
#[derive(Debug)]
struct Talk {
    guard: Guard,
    step: Step,
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
    talk: Option<Talk>,
}

impl Login {
    /// Opens the dialog to unlock a level.
    pub fn unlock(&mut self, view: &View<'_>, guard: Guard) {
        self.begin(view, guard, Step::Unlock);
    }

    /// Opens the dialog to replace a password.
    pub fn change(&mut self, view: &View<'_>, guard: Guard) {
        self.begin(view, guard, Step::Old);
    }

    fn begin(&mut self, view: &View<'_>, guard: Guard, step: Step) {
        let answers = view.snapshot.access.answers;
        let (text, old, new) = (String::new(), String::new(), String::new());
        self.talk = Some(Talk { guard, step, text, old, new, answers, sent: false, refused: None });
    }

    /// Whether the dialog is open and takes the input.
    #[must_use]
    pub const fn is_open(&self) -> bool {
        self.talk.is_some()
    }

    /// Closes the dialog and discards its texts.
    pub fn close(&mut self) {
        self.talk = None;
    }

    /// Draws the dialog over a page and handles its input.
    pub fn ui(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, edits: &[Edit], out: &mut Vec<Command>) {
        self.hear(view);
        let Some(talk) = self.talk.as_mut() else { return };
        for edit in edits {
            if talk.edit(*edit, out) {
                self.talk = None;
                return;
            }
        }
        if draw(ui, rect, view, talk) {
            self.talk = None;
        }
    }

    /// Checks the core's answer: closes the dialog, or shows the reason of the refusal.
    fn hear(&mut self, view: &View<'_>) {
        let access = view.snapshot.access;
        let Some(talk) = self.talk.as_mut().filter(|talk| talk.sent && access.answers != talk.answers) else { return };
        match access.refused {
            None => self.talk = None,
            Some(reason) => {
                (talk.sent, talk.answers, talk.refused) = (false, access.answers, Some(reason));
                if talk.step != Step::Unlock {
                    talk.step = Step::Old;
                }
            }
        }
    }
}

impl Talk {
    /// Handles one key; true if the dialog closes.
    fn edit(&mut self, edit: Edit, out: &mut Vec<Command>) -> bool {
        if self.sent {
            return edit == Edit::Cancel;
        }
        self.refused = self.refused.filter(|_| edit == Edit::Enter && self.text.is_empty());
        match edit {
            Edit::Char(sign) if sign.is_ascii_digit() && self.text.len() < *PASSWORD_LENGTH.end() => {
                self.text.push(sign);
            }
            Edit::Back | Edit::Delete => {
                self.text.pop();
            }
            Edit::Cancel => return true,
            Edit::Enter if !self.text.is_empty() => self.enter(out),
            Edit::Enter | Edit::Char(_) | Edit::Sign | Edit::Up | Edit::Down => {}
            Edit::Left | Edit::Right | Edit::LineStart | Edit::LineEnd | Edit::Next | Edit::Previous => {}
        }
        false
    }

    fn enter(&mut self, out: &mut Vec<Command>) {
        let text = std::mem::take(&mut self.text);
        match self.step {
            Step::Unlock => {
                self.sent = true;
                out.push(Command::Page(PageCommand::Unlock(self.guard, Secret::new(text))));
            }
            Step::Old => (self.old, self.step) = (text, Step::New),
            Step::New if !PASSWORD_LENGTH.contains(&text.len()) => {
                self.refused = Some(Text::new("新密码为 4 到 16 位数字", "a new password has 4 to 16 digits"));
            }
            Step::New => (self.new, self.step) = (text, Step::Again),
            Step::Again if text != self.new => {
                self.refused = Some(Text::new("两次输入不一致，请重新输入", "the two differ: type it anew"));
                self.step = Step::New;
            }
            Step::Again => {
                self.sent = true;
                let (old, new) = (Secret::new(std::mem::take(&mut self.old)), Secret::new(text));
                out.push(Command::Page(PageCommand::ChangePassword { of: self.guard, old, new }));
            }
        }
    }

    const fn question(&self) -> Text {
        match self.step {
            Step::Unlock => Text::new("请输入密码", "type the password"),
            Step::Old => Text::new("请输入原密码", "type the old password"),
            Step::New => Text::new("请输入新密码（4 到 16 位数字）", "type the new password (4 to 16 digits)"),
            Step::Again => Text::new("请再次输入新密码", "type the new password once more"),
        }
    }
}

/// Draws the dialog; true if CANCEL (取消) was touched.
fn draw(ui: &Ui, rect: Rect, view: &View<'_>, talk: &Talk) -> bool {
    // The page beneath takes no touches while the dialog is open.
    ui.interact(rect, Id::unique("login-veil"), Sense::CLICK | Sense::DRAG);
    let painter = ui.painter();
    painter.rect_filled(rect, 0.0, view.theme.ground.gamma_multiply(0.86));
    let place = Rect::from_center_size(rect.center(), vec2(440.0_f32.min(rect.width() - 24.0), 236.0));
    card(painter, place, view.theme.surface, view.theme.focus);
    let inside = place.shrink2(vec2(20.0, theme::PAD));
    let row = |top: f32, height: f32| {
        Rect::from_min_size(pos2(inside.min.x, inside.min.y + top), vec2(inside.width(), height))
    };
    let title = format!("{} · {}", talk.guard.name().get(view.lang), view.say("密码", "password"));
    fit(painter, row(0.0, 30.0), Align2::LEFT_CENTER, &title, theme::SECONDARY, view.theme.text);
    fit(painter, row(34.0, 26.0), Align2::LEFT_CENTER, talk.question().get(view.lang), theme::LABEL, view.theme.quiet);
    let field = row(66.0, 52.0);
    card(painter, field, view.theme.raised, view.theme.line);
    frame(painter, field, if talk.refused.is_some() { view.theme.alarm } else { view.theme.focus });
    let response = ui.interact(field, Id::unique("password"), Sense::HOVER);
    response.widget_info(|| WidgetInfo::labeled(Role::PasswordInput, true, "密码 password"));
    let dots =
        if talk.sent { view.say("正在核对…", "checking…").to_owned() } else { "●".repeat(talk.text.len()) };
    let ink = if talk.sent { view.theme.quiet } else { view.theme.text };
    put(painter, field.shrink2(vec2(theme::PAD, 0.0)), Align2::LEFT_CENTER, &dots, theme::SECONDARY, ink);
    if let Some(reason) = talk.refused {
        paragraph(painter, row(126.0, 40.0), reason.get(view.lang), theme::LABEL, view.theme.alarm_text);
    }
    let cancel = Rect::from_min_size(pos2(inside.max.x - 120.0, inside.max.y - 48.0), vec2(120.0, 48.0));
    widget::push(ui, view, cancel, "login-cancel", view.say("取消", "CANCEL"), Look::default())
}
