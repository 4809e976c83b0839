//! Settings: the kind of machine, the language of the screen, who is at the panel, passwords.
//! Source: spec B6, K1 (the kind is kept), K6.2.

use egui::{Align2, Rect, Ui, pos2, vec2};

use crate::defs::kind::Kind;
use crate::defs::param::Level;
use crate::defs::text::Lang;
use crate::hmi::entry::Edit;
use crate::hmi::login::Login;
use crate::hmi::theme;
use crate::hmi::view::{View, card, fit, paragraph};
use crate::hmi::widget::{Look, Walk};
use crate::link::Command;
use crate::link::page_command::{Guard, PageCommand};

/// Height of a key of this page.
const KEY: f32 = 52.0;

/// What the page keeps.
#[derive(Debug, Default)]
pub struct Settings {
    /// The kind that waits for the builder's password.
    waiting: Option<Kind>,
    walk: Walk,
}

impl Settings {
    /// Draws the page.
    pub fn ui(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, edits: &[Edit], login: &mut Login) -> Vec<Command> {
        let mut out = Vec::new();
        self.walk.begin(if login.is_open() { &[] } else { edits });
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
        language(ui, place(1.0, 0.0), view, &mut self.walk, &mut out);
        level(ui, place(0.0, 1.0), view, (&mut self.walk, login), &mut out);
        passwords(ui, place(1.0, 1.0), view, &mut self.walk, login);
        out
    }

    fn kind(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, login: &mut Login, out: &mut Vec<Command>) {
        let body = group(ui, view, rect, view.say("机床类型", "kind of machine"));
        let next = view.snapshot.next_kind;
        let row = Rect::from_min_size(body.min, vec2(body.width(), KEY));
        let second = row.translate(vec2(0.0, KEY + theme::GAP));
        for (index, kind) in Kind::ALL.into_iter().enumerate() {
            let look = Look { on: kind == next, locked: view.snapshot.access.level < Level::Builder };
            // The grinders of the KT-830 in the first row, the other kinds below them.
            let (first, rest) = (Kind::KT830.len(), Kind::ALL.len() - Kind::KT830.len());
            let place = if index < first { cell(row, index, first) } else { cell(second, index - first, rest) };
            if !self.walk.push(ui, view, place, (kind.id(), &kind.id().to_uppercase()), look) {
                continue;
            }
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
        let below = Rect::from_min_max(pos2(body.min.x, second.max.y + 10.0), body.max);
        let taken = paragraph(ui.painter(), below, &words, theme::LABEL, view.theme.text);
        // The line of the next start says the rest.
        if next == view.snapshot.kind {
            let note = view.say("需要机床厂密码，下次启动生效", "builder's password; takes effect at the next start");
            let below = Rect::from_min_max(pos2(body.min.x, taken.max.y + 4.0), body.max);
            paragraph(ui.painter(), below, note, theme::LABEL, view.theme.quiet);
        }
    }
}

/// One of so many keys side by side.
fn cell(row: Rect, index: usize, count: usize) -> Rect {
    let width = (row.width() - (count as f32 - 1.0) * theme::GAP) / count as f32;
    Rect::from_min_size(row.min + vec2(index as f32 * (width + theme::GAP), 0.0), vec2(width, row.height()))
}

/// A card with a title; gives its inside.
fn group(ui: &Ui, view: &View<'_>, rect: Rect, title: &str) -> Rect {
    card(ui.painter(), rect, view.theme.surface, view.theme.line);
    let inside = rect.shrink2(vec2(theme::PAD + 2.0, theme::PAD));
    let (head, body) = inside.split_top_bottom_at_y(inside.min.y + 36.0);
    fit(ui.painter(), head, Align2::LEFT_TOP, title, theme::TITLE, view.theme.text);
    body
}

fn language(ui: &Ui, rect: Rect, view: &View<'_>, walk: &mut Walk, out: &mut Vec<Command>) {
    let body = group(ui, view, rect, view.say("语言、颜色 Language", "Language 语言, colours"));
    let row = Rect::from_min_size(body.min, vec2(body.width(), KEY));
    for (index, (lang, id, name)) in
        [(Lang::Zh, "lang-zh", "中文"), (Lang::En, "lang-en", "English")].into_iter().enumerate()
    {
        let look = Look { on: lang == view.lang, locked: false };
        if walk.push(ui, view, cell(row, index, 2), (id, name), look) {
            out.push(Command::Page(PageCommand::KeepLang(lang)));
        }
    }
    // Which theme is in force is known by its ground.
    let light = *view.theme == theme::LIGHT;
    let row = row.translate(vec2(0.0, KEY + theme::GAP));
    let themes = [(false, "theme-dark", view.say("深色", "DARK")), (true, "theme-light", view.say("浅色", "LIGHT"))];
    for (index, (wanted, id, name)) in themes.into_iter().enumerate() {
        let look = Look { on: light == wanted, locked: false };
        if walk.push(ui, view, cell(row, index, 2), (id, name), look) {
            out.push(Command::Page(PageCommand::KeepLight(wanted)));
        }
    }
    let note = view.say("立即生效并保存", "at once, and kept");
    let below = Rect::from_min_max(pos2(body.min.x, row.max.y + 10.0), body.max);
    paragraph(ui.painter(), below, note, theme::LABEL, view.theme.quiet);
}

/// Which parameters may be changed now.
fn level(ui: &Ui, rect: Rect, view: &View<'_>, keys: (&mut Walk, &mut Login), out: &mut Vec<Command>) {
    let (walk, login) = keys;
    let body = group(ui, view, rect, view.say("参数权限", "access to parameters"));
    let open = view.snapshot.access.level;
    let words = format!("{} {}", view.say("当前级别：", "open now:"), open.name().get(view.lang));
    let line = Rect::from_min_size(body.min, vec2(body.width(), 26.0));
    fit(ui.painter(), line, Align2::LEFT_CENTER, &words, theme::LABEL, view.theme.text);
    let row = Rect::from_min_size(body.min + vec2(0.0, 36.0), vec2(body.width(), KEY));
    let user = Look { on: open == Level::User, locked: open < Level::User };
    if walk.push(ui, view, cell(row, 0, 3), ("unlock-user", view.say("用户", "USER")), user) {
        login.unlock(view, Guard::User);
    }
    let builder = Look { on: open == Level::Builder, locked: open < Level::Builder };
    if walk.push(ui, view, cell(row, 1, 3), ("unlock-builder", view.say("机床厂", "BUILDER")), builder) {
        login.unlock(view, Guard::Builder);
    }
    if walk.push(ui, view, cell(row, 2, 3), ("lock", view.say("锁定", "LOCK")), Look::default()) {
        out.push(Command::Page(PageCommand::Lock));
    }
    let note = view.say("输入一次密码，锁定或关机前有效", "one password opens it until LOCK or power-off");
    let below = Rect::from_min_max(pos2(body.min.x, row.max.y + 10.0), body.max);
    paragraph(ui.painter(), below, note, theme::LABEL, view.theme.quiet);
}

fn passwords(ui: &Ui, rect: Rect, view: &View<'_>, walk: &mut Walk, login: &mut Login) {
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
        if walk.push(ui, view, key, (id, view.say("修改", "CHANGE")), Look::default()) {
            login.change(view, guard);
        }
    }
}
