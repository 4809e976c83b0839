//! Settings: the kind of machine, the language of the screen, who is at the panel, passwords.
//! Source: spec B6, K1 (the kind is kept), K6.2.

use egui::{Align2, Rect, Ui, pos2, vec2};

use crate::defs::kind::Kind;
use crate::defs::param::Level;
use crate::defs::text::Lang;
use crate::hmi::login::Login;
use crate::hmi::theme;
use crate::hmi::view::{View, card, fit, paragraph};
use crate::hmi::widget::{self, Look};
use crate::link::Command;
use crate::link::page_command::{Guard, PageCommand};

/// Height of a key of this page.
const KEY: f32 = 52.0;

/// What the page keeps.
#[derive(Debug, Default)]
pub struct Settings {
    /// The kind that waits for the builder's password.
    waiting: Option<Kind>,
}

impl Settings {
    /// Draws the page.
    pub fn ui(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, login: &mut Login) -> Vec<Command> {
        let mut out = Vec::new();
        if let Some(kind) = self.waiting {
            if view.snapshot.access.level >= Level::Builder {
                out.push(Command::Page(PageCommand::KeepKind(kind)));
                self.waiting = None;
            } else if !login.is_open() {
                self.waiting = None;
            }
        }
        let inside = rect.shrink(theme::PAD);
        let half = (inside.width() - theme::PAD) / 2.0;
        let height = 260.0_f32.min((inside.height() - theme::PAD) / 2.0);
        let place = |column: f32, row: f32| {
            let corner = inside.min + vec2(column * (half + theme::PAD), row * (height + theme::PAD));
            Rect::from_min_size(corner, vec2(half, height))
        };
        self.kind(ui, place(0.0, 0.0), view, login, &mut out);
        language(ui, place(1.0, 0.0), view, &mut out);
        level(ui, place(0.0, 1.0), view, login, &mut out);
        passwords(ui, place(1.0, 1.0), view, login);
        out
    }

    fn kind(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, login: &mut Login, out: &mut Vec<Command>) {
        let body = group(ui, view, rect, view.say("机床类型", "kind of machine"));
        let keys: Vec<(&str, String)> = Kind::ALL.iter().map(|kind| (kind.id(), kind.id().to_uppercase())).collect();
        let next = view.snapshot.next_kind;
        let chosen = Kind::ALL.iter().position(|kind| *kind == next).unwrap_or(0);
        let row = Rect::from_min_size(body.min, vec2(body.width(), KEY));
        if let Some(index) = widget::tabs(ui, view, row, &keys, chosen) {
            let kind = Kind::ALL[index];
            if view.snapshot.access.level >= Level::Builder {
                out.push(Command::Page(PageCommand::KeepKind(kind)));
            } else {
                self.waiting = Some(kind);
                login.unlock(view, Guard::Builder);
            }
        }
        let (now, then) = (view.snapshot.kind.name().get(view.lang), next.name().get(view.lang));
        let words = if next == view.snapshot.kind {
            format!("{} {now}", view.say("当前：", "now:"))
        } else {
            format!("{} {now}\n{} {then}", view.say("当前：", "now:"), view.say("下次启动：", "from the next start:"))
        };
        let below = Rect::from_min_max(pos2(body.min.x, row.max.y + 10.0), body.max);
        let taken = paragraph(ui.painter(), below, &words, theme::LABEL, view.theme.text);
        let note = view.say("需要机床厂密码，下次启动生效", "builder's password; takes effect at the next start");
        let below = Rect::from_min_max(pos2(body.min.x, taken.max.y + 4.0), body.max);
        paragraph(ui.painter(), below, note, theme::LABEL, view.theme.quiet);
    }
}

/// A card with a title; gives its inside.
fn group(ui: &Ui, view: &View<'_>, rect: Rect, title: &str) -> Rect {
    card(ui.painter(), rect, view.theme.surface, view.theme.line);
    let inside = rect.shrink2(vec2(theme::PAD + 2.0, theme::PAD));
    let (head, body) = inside.split_top_bottom_at_y(inside.min.y + 36.0);
    fit(ui.painter(), head, Align2::LEFT_TOP, title, theme::TITLE, view.theme.text);
    body
}

fn language(ui: &Ui, rect: Rect, view: &View<'_>, out: &mut Vec<Command>) {
    let body = group(ui, view, rect, view.say("语言 Language", "Language 语言"));
    let row = Rect::from_min_size(body.min, vec2(body.width(), KEY));
    let keys = [("lang-zh", "中文".to_owned()), ("lang-en", "English".to_owned())];
    if let Some(index) = widget::tabs(ui, view, row, &keys, usize::from(view.lang == Lang::En)) {
        out.push(Command::Page(PageCommand::KeepLang(if index == 0 { Lang::Zh } else { Lang::En })));
    }
    let note = view.say("立即生效并保存", "at once, and kept");
    let below = Rect::from_min_max(pos2(body.min.x, row.max.y + 10.0), body.max);
    paragraph(ui.painter(), below, note, theme::LABEL, view.theme.quiet);
}

/// Which parameters may be changed now.
fn level(ui: &Ui, rect: Rect, view: &View<'_>, login: &mut Login, out: &mut Vec<Command>) {
    let body = group(ui, view, rect, view.say("参数权限", "access to parameters"));
    let open = view.snapshot.access.level;
    let words = format!("{} {}", view.say("当前级别：", "open now:"), open.name().get(view.lang));
    let line = Rect::from_min_size(body.min, vec2(body.width(), 26.0));
    fit(ui.painter(), line, Align2::LEFT_CENTER, &words, theme::LABEL, view.theme.text);
    let width = (body.width() - 2.0 * theme::GAP) / 3.0;
    let place = |index: f32| Rect::from_min_size(body.min + vec2(index * (width + theme::GAP), 36.0), vec2(width, KEY));
    let user = Look { on: open == Level::User, locked: open < Level::User };
    if widget::push(ui, view, place(0.0), "unlock-user", view.say("用户", "USER"), user) {
        login.unlock(view, Guard::User);
    }
    let builder = Look { on: open == Level::Builder, locked: open < Level::Builder };
    if widget::push(ui, view, place(1.0), "unlock-builder", view.say("机床厂", "BUILDER"), builder) {
        login.unlock(view, Guard::Builder);
    }
    if widget::push(ui, view, place(2.0), "lock", view.say("锁定", "LOCK"), Look::default()) {
        out.push(Command::Page(PageCommand::Lock));
    }
    let note = view.say("输入一次密码，锁定或关机前有效", "one password opens it until LOCK or power-off");
    let below = Rect::from_min_max(pos2(body.min.x, place(0.0).max.y + 10.0), body.max);
    paragraph(ui.painter(), below, note, theme::LABEL, view.theme.quiet);
}

fn passwords(ui: &Ui, rect: Rect, view: &View<'_>, login: &mut Login) {
    let body = group(ui, view, rect, view.say("修改密码", "change a password"));
    let pitch = ((body.height() + theme::GAP) / 3.0).min(KEY + theme::GAP);
    for (index, guard) in Guard::ALL.into_iter().enumerate() {
        let row =
            Rect::from_min_size(body.min + vec2(0.0, index as f32 * pitch), vec2(body.width(), pitch - theme::GAP));
        let (name, key) = row.split_left_right_at_x(row.max.x - 120.0);
        fit(ui.painter(), name, Align2::LEFT_CENTER, guard.name().get(view.lang), theme::LABEL, view.theme.text);
        let id = match guard {
            Guard::Program => "change-program",
            Guard::User => "change-user",
            Guard::Builder => "change-builder",
        };
        if widget::push(ui, view, key, id, view.say("修改", "CHANGE"), Look::default()) {
            login.change(view, guard);
        }
    }
}
