//! Settings: clock, language, colours and brightness, switches, kind of machine, access level, passwords.
//! Source: spec B6, K1 (the kind is retained), K6.2.

mod clock;
mod look;
mod switches;

use egui::{Align2, Pos2, Rect, Ui, pos2, vec2};

use super::input_line;
use crate::defs::kind::Kind;
use crate::defs::param::Level;
use crate::hmi::entry::Edit;
use crate::hmi::login::Login;
use crate::hmi::theme;
use crate::hmi::view::{View, card, fit};
use crate::hmi::widget::{Look, Walk};
use crate::link::Command;
use crate::link::page_command::{Guard, PageCommand};
use clock::Clock;
use switches::Switches;

/// Least and greatest height of a key of this page; heights of a group's title, its edge and its note.
const KEY: (f32, f32) = (46.0, 56.0);
const TITLE: f32 = 30.0;
const EDGE: f32 = 10.0;
const WORDS: f32 = 24.0;
/// Groups of each column: rows of keys, and whether a note is below.
const LEFT: [(f32, bool); 3] = [(1.0, false), (2.0, false), (2.0, false)];
const RIGHT: [(f32, bool); 3] = [(2.0, true), (2.0, true), (1.0, false)];

/// State of the page.
#[derive(Debug, Default)]
pub struct Settings {
    /// Selected kind that waits for the machine builder's password.
    waiting: Option<Kind>,
    switches: Switches,
    /// The clock group.
    pub clock: Clock,
    walk: Walk,
}

impl Settings {
    /// Draws the page.
    pub fn ui(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, edits: &[Edit], login: &mut Login) -> Vec<Command> {
        let mut out = Vec::new();
        let edits = if login.is_open() { &[] } else { edits };
        let rest = self.clock.take(view, edits, &mut out);
        self.walk.begin(&rest);
        if let Some(kind) = self.waiting {
            if view.snapshot.access.level >= Level::Builder {
                out.push(Command::Page(PageCommand::KeepKind(kind)));
                self.waiting = None;
            } else if !login.is_open() {
                self.waiting = None;
            }
        }
        self.switches.send_waiting(view, login, &mut out);
        let (page, input) = input_line::split(rect);
        let inside = page.shrink(theme::PAD);
        let half = (inside.width() - theme::PAD) / 2.0;
        // The right column is the higher one; the left column gets the same height.
        let rows: f32 = RIGHT.iter().map(|(rows, _)| rows).sum();
        let key = ((inside.height() - needed(RIGHT, 0.0)) / rows).clamp(KEY.0, KEY.1);
        let height = needed(RIGHT, key);
        let [clock, look, switches] = column(inside.min, (half, height), LEFT, key);
        let right = pos2(inside.min.x + half + theme::PAD, inside.min.y);
        let [kind, level, passwords] = column(right, (half, height), RIGHT, key);
        self.clock.ui(ui, clock, view, (key, &mut self.walk));
        look::ui(ui, look, view, (key, &mut self.walk), &mut out);
        self.switches.ui(ui, switches, view, (key, &mut self.walk, login), &mut out);
        self.kind(ui, kind, view, (key, login), &mut out);
        access(ui, level, view, (key, &mut self.walk, login), &mut out);
        change(ui, passwords, view, (key, &mut self.walk, login));
        self.clock.line(ui, input, view);
        out
    }

    fn kind(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, keys: (f32, &mut Login), out: &mut Vec<Command>) {
        let (key, login) = keys;
        let (body, free) = group(ui, view, rect, view.say("机床类型", "kind of machine"));
        beside(ui, view, free, view.snapshot.kind.name().get(view.lang));
        let next = view.snapshot.next_kind;
        let (first, rest) = (Kind::KT830.len(), Kind::ALL.len() - Kind::KT830.len());
        for (index, kind) in Kind::ALL.into_iter().enumerate() {
            let look = Look { on: kind == next, locked: view.snapshot.access.level < Level::Builder };
            // The KT-830 grinders in the first row, the other kinds below.
            let place = match index < first {
                true => cell(row_of(body, key, 0), index, first),
                false => cell(row_of(body, key, 1), index - first, rest),
            };
            if !self.walk.push(ui, view, place, (kind.id(), kind.short()), look) {
                continue;
            }
            if view.snapshot.access.level >= Level::Builder {
                out.push(Command::Page(PageCommand::KeepKind(kind)));
            } else {
                self.waiting = Some(kind);
                login.unlock(view, Guard::Builder);
            }
        }
        let words = if next == view.snapshot.kind {
            view.say("需要机床厂密码，下次启动生效", "builder's password; from the next start").to_owned()
        } else {
            format!("{} {}", view.say("下次启动：", "from the next start:"), next.name().get(view.lang))
        };
        note(ui, view, body, row_of(body, key, 1), &words);
    }
}

/// Height of a group for a key height.
fn height_of((rows, words): (f32, bool), key: f32) -> f32 {
    2.0 * EDGE + TITLE + rows * key + (rows - 1.0) * theme::GAP + if words { WORDS } else { 0.0 }
}

/// Height of a column for a key height.
fn needed(groups: [(f32, bool); 3], key: f32) -> f32 {
    groups.iter().map(|group| height_of(*group, key)).sum::<f32>() + 2.0 * theme::PAD
}

/// The groups of a column, from the top; spare height is shared equally.
fn column(corner: Pos2, (width, height): (f32, f32), groups: [(f32, bool); 3], key: f32) -> [Rect; 3] {
    let more = (height - needed(groups, key)) / 3.0;
    let mut top = corner.y;
    groups.map(|group| {
        let place = Rect::from_min_size(pos2(corner.x, top), vec2(width, height_of(group, key) + more));
        top = place.max.y + theme::PAD;
        place
    })
}

/// A row of keys of a group.
fn row_of(body: Rect, key: f32, row: usize) -> Rect {
    let top = body.min.y + row as f32 * (key + theme::GAP);
    Rect::from_min_size(pos2(body.min.x, top), vec2(body.width(), key))
}

/// The note below the rows of keys.
fn note(ui: &Ui, view: &View<'_>, body: Rect, below: Rect, words: &str) {
    let place = Rect::from_min_max(pos2(body.min.x, below.max.y + 4.0), pos2(body.max.x, below.max.y + WORDS));
    fit(ui.painter(), place, Align2::LEFT_CENTER, words, theme::LABEL, view.theme.quiet);
}

/// Cell of a row of `count` equal keys.
fn cell(row: Rect, index: usize, count: usize) -> Rect {
    let width = (row.width() - (count as f32 - 1.0) * theme::GAP) / count as f32;
    Rect::from_min_size(row.min + vec2(index as f32 * (width + theme::GAP), 0.0), vec2(width, row.height()))
}

/// A card with a title; returns its inside, and the free rectangle beside the title.
fn group(ui: &Ui, view: &View<'_>, rect: Rect, title: &str) -> (Rect, Rect) {
    card(ui.painter(), rect, view.theme.surface, view.theme.line);
    let inside = rect.shrink2(vec2(theme::PAD, EDGE));
    let (head, body) = inside.split_top_bottom_at_y(inside.min.y + TITLE);
    let taken = fit(ui.painter(), head, Align2::LEFT_TOP, title, theme::TITLE, view.theme.text);
    (body, Rect::from_min_max(pos2(taken.max.x + theme::PAD, head.min.y), pos2(head.max.x, head.min.y + 24.0)))
}

/// Right-aligned text beside a title.
fn beside(ui: &Ui, view: &View<'_>, place: Rect, words: &str) {
    fit(ui.painter(), place, Align2::RIGHT_CENTER, words, theme::LABEL, view.theme.quiet);
}

/// Access levels: unlock by password, lock.
fn access(
    ui: &Ui,
    rect: Rect,
    view: &View<'_>,
    (key, walk, login): (f32, &mut Walk, &mut Login),
    out: &mut Vec<Command>,
) {
    let (body, free) = group(ui, view, rect, view.say("程序、参数开关", "access"));
    let access = view.snapshot.access;
    let words = format!("{} {}", view.say("参数级别：", "parameters:"), access.level.name().get(view.lang));
    beside(ui, view, free, &words);
    let levels = [
        (Guard::Program, "unlock-program", view.say("程序编辑", "PROGRAMS"), access.program),
        (Guard::User, "unlock-user", view.say("用户", "USER"), access.level >= Level::User),
        (Guard::Builder, "unlock-builder", view.say("机床厂", "BUILDER"), access.level >= Level::Builder),
    ];
    for (index, (guard, id, name, open)) in levels.into_iter().enumerate() {
        let look = Look { on: open, locked: !open };
        let place = cell(row_of(body, key, index / 2), index % 2, 2);
        if walk.push(ui, view, place, (id, name), look) && !open {
            login.unlock(view, guard);
        }
    }
    if walk.push(ui, view, cell(row_of(body, key, 1), 1, 2), ("lock", view.say("锁定", "LOCK")), Look::default()) {
        out.push(Command::Page(PageCommand::Lock));
    }
    let words = view.say("输入一次密码，锁定或关机前有效", "one password opens it until LOCK or power-off");
    note(ui, view, body, row_of(body, key, 1), words);
}

fn change(ui: &Ui, rect: Rect, view: &View<'_>, (key, walk, login): (f32, &mut Walk, &mut Login)) {
    let (body, free) = group(ui, view, rect, view.say("修改密码", "change a password"));
    beside(ui, view, free, view.say("4 到 16 位数字", "4 to 16 digits"));
    let keys = [
        (Guard::Program, "change-program", view.say("程序编辑", "PROGRAMS")),
        (Guard::User, "change-user", view.say("用户参数", "USER")),
        (Guard::Builder, "change-builder", view.say("机床厂", "BUILDER")),
    ];
    for (index, (guard, id, name)) in keys.into_iter().enumerate() {
        if walk.push(ui, view, cell(row_of(body, key, 0), index, 3), (id, name), Look::default()) {
            login.change(view, guard);
        }
    }
}
