//! Settings: clock, language, colours and brightness, switches, kind of machine, access level, passwords.
//! Source: spec B6, K1 (the kind is retained), K6.2.

mod appearance;
mod clock;
mod switches;

use egui::{Align2, Pos2, Rect, Ui, pos2, vec2};

use super::{PageContext, PageUi, input_line};
use crate::defs::kind::Kind;
use crate::defs::param::AccessLevel;
use crate::hmi::field_editor::FieldEditor;
use crate::hmi::login::Login;
use crate::hmi::theme;
use crate::hmi::view::{View, card, fit_text};
use crate::hmi::widget::{ButtonState, KeyboardFocus, cell};
use crate::link::Command;
use crate::link::page_command::{PageCommand, PasswordScope};
use clock::ClockGroup;
use switches::SwitchGroup;

/// Least and greatest height of a key of this page; heights of a group's title, its edge and its note.
const KEY_HEIGHTS: (f32, f32) = (46.0, 56.0);
const TITLE_HEIGHT: f32 = 30.0;
const GROUP_EDGE: f32 = 10.0;
const NOTE_HEIGHT: f32 = 24.0;
/// Groups of each column: rows of keys, and whether a note is below.
const LEFT_GROUPS: [(f32, bool); 3] = [(1.0, false), (2.0, false), (2.0, false)];
const RIGHT_GROUPS: [(f32, bool); 3] = [(2.0, true), (2.0, true), (1.0, false)];

/// State of the page.
#[derive(Debug, Default)]
pub struct SettingsPage {
    /// Selected kind that waits for the machine builder's password.
    pending_kind: Option<Kind>,
    switches: SwitchGroup,
    /// The clock group.
    clock: ClockGroup,
    walk: KeyboardFocus,
}

impl PageUi for SettingsPage {
    fn open(&mut self, _view: &View<'_>, _handed_over: Option<u32>) {
        *self = Self::default();
    }

    fn typing(&self) -> Option<&FieldEditor> {
        Some(&self.clock.typing)
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        let PageContext { ui, rect, view, typed, login, out, .. } = ctx;
        let edits = if login.is_open() { &[] } else { typed.edits };
        let rest = self.clock.handle_edits(view, edits, out);
        self.walk.begin_frame(&rest);
        if let Some(kind) = self.pending_kind {
            if view.snapshot.access.level >= AccessLevel::Builder {
                out.push(Command::Page(PageCommand::SetNextKind(kind)));
                self.pending_kind = None;
            } else if !login.is_open() {
                self.pending_kind = None;
            }
        }
        self.switches.send_pending(view, login, out);
        let (page, input) = input_line::split(rect);
        let inside = page.shrink(theme::PAD);
        let half = (inside.width() - theme::PAD) / 2.0;
        // The right column is the higher one; the left column gets the same height.
        let rows: f32 = RIGHT_GROUPS.iter().map(|(rows, _)| rows).sum();
        let key = ((inside.height() - column_height(RIGHT_GROUPS, 0.0)) / rows).clamp(KEY_HEIGHTS.0, KEY_HEIGHTS.1);
        let height = column_height(RIGHT_GROUPS, key);
        let [clock, look, switches] = column(inside.min, (half, height), LEFT_GROUPS, key);
        let right = pos2(inside.min.x + half + theme::PAD, inside.min.y);
        let [kind, level, passwords] = column(right, (half, height), RIGHT_GROUPS, key);
        self.clock.ui(ui, clock, view, (key, &mut self.walk));
        appearance::ui(ui, look, view, (key, &mut self.walk), out);
        self.switches.ui(ui, switches, view, (key, &mut self.walk, login), out);
        self.kind_group(ui, kind, view, (key, login), out);
        access_group(ui, level, view, (key, &mut self.walk, login), out);
        password_group(ui, passwords, view, (key, &mut self.walk, login));
        self.clock.input_line(ui, input, view);
    }
}

impl SettingsPage {
    fn kind_group(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, keys: (f32, &mut Login), out: &mut Vec<Command>) {
        let (key, login) = keys;
        let (body, free) = group(ui, view, rect, view.text("机床类型", "kind of machine"));
        title_note(ui, view, free, view.snapshot.kind.name().get(view.lang));
        let next = view.snapshot.next_kind;
        let (first, rest) = (Kind::KT830.len(), Kind::ALL.len() - Kind::KT830.len());
        for (index, kind) in Kind::ALL.into_iter().enumerate() {
            let look = ButtonState { on: kind == next, locked: view.snapshot.access.level < AccessLevel::Builder };
            // The KT-830 grinders in the first row, the other kinds below.
            let place = match index < first {
                true => cell(key_row(body, key, 0), index, first),
                false => cell(key_row(body, key, 1), index - first, rest),
            };
            if !self.walk.button(ui, view, place, (kind.id(), kind.short_name()), look) {
                continue;
            }
            if view.snapshot.access.level >= AccessLevel::Builder {
                out.push(Command::Page(PageCommand::SetNextKind(kind)));
            } else {
                self.pending_kind = Some(kind);
                login.unlock(view, PasswordScope::Builder);
            }
        }
        let words = if next == view.snapshot.kind {
            view.text("需要机床厂密码，下次启动生效", "builder's password; from the next start").to_owned()
        } else {
            format!("{} {}", view.text("下次启动：", "from the next start:"), next.name().get(view.lang))
        };
        note(ui, view, body, key_row(body, key, 1), &words);
    }
}

/// Height of a group for a key height.
fn group_height((rows, words): (f32, bool), key: f32) -> f32 {
    2.0 * GROUP_EDGE + TITLE_HEIGHT + rows * key + (rows - 1.0) * theme::GAP + if words { NOTE_HEIGHT } else { 0.0 }
}

/// Height of a column for a key height.
fn column_height(groups: [(f32, bool); 3], key: f32) -> f32 {
    groups.iter().map(|group| group_height(*group, key)).sum::<f32>() + 2.0 * theme::PAD
}

/// The groups of a column, from the top; spare height is shared equally.
fn column(corner: Pos2, (width, height): (f32, f32), groups: [(f32, bool); 3], key: f32) -> [Rect; 3] {
    let more = (height - column_height(groups, key)) / 3.0;
    let mut top = corner.y;
    groups.map(|group| {
        let place = Rect::from_min_size(pos2(corner.x, top), vec2(width, group_height(group, key) + more));
        top = place.max.y + theme::PAD;
        place
    })
}

/// A row of keys of a group.
fn key_row(body: Rect, key: f32, row: usize) -> Rect {
    let top = body.min.y + row as f32 * (key + theme::GAP);
    Rect::from_min_size(pos2(body.min.x, top), vec2(body.width(), key))
}

/// The note below the rows of keys.
fn note(ui: &Ui, view: &View<'_>, body: Rect, below: Rect, words: &str) {
    let place = Rect::from_min_max(pos2(body.min.x, below.max.y + 4.0), pos2(body.max.x, below.max.y + NOTE_HEIGHT));
    fit_text(ui.painter(), place, Align2::LEFT_CENTER, words, theme::LABEL, view.theme.muted);
}

/// A card with a title; returns its inside, and the free rectangle beside the title.
fn group(ui: &Ui, view: &View<'_>, rect: Rect, title: &str) -> (Rect, Rect) {
    card(ui.painter(), rect, view.theme.surface, view.theme.line);
    let inside = rect.shrink2(vec2(theme::PAD, GROUP_EDGE));
    let (head, body) = inside.split_top_bottom_at_y(inside.min.y + TITLE_HEIGHT);
    let taken = fit_text(ui.painter(), head, Align2::LEFT_TOP, title, theme::TITLE, view.theme.text);
    (body, Rect::from_min_max(pos2(taken.max.x + theme::PAD, head.min.y), pos2(head.max.x, head.min.y + 24.0)))
}

/// Right-aligned text beside a title.
fn title_note(ui: &Ui, view: &View<'_>, place: Rect, words: &str) {
    fit_text(ui.painter(), place, Align2::RIGHT_CENTER, words, theme::LABEL, view.theme.muted);
}

/// Access levels: unlock by password, lock.
fn access_group(
    ui: &Ui,
    rect: Rect,
    view: &View<'_>,
    (key, walk, login): (f32, &mut KeyboardFocus, &mut Login),
    out: &mut Vec<Command>,
) {
    let (body, free) = group(ui, view, rect, view.text("程序、参数开关", "access"));
    let access = view.snapshot.access;
    let words = format!("{} {}", view.text("参数级别：", "parameters:"), access.level.name().get(view.lang));
    title_note(ui, view, free, &words);
    let levels = [
        (PasswordScope::Program, "unlock-program", view.text("程序编辑", "PROGRAMS"), access.program_unlocked),
        (PasswordScope::User, "unlock-user", view.text("用户", "USER"), access.level >= AccessLevel::User),
        (
            PasswordScope::Builder,
            "unlock-builder",
            view.text("机床厂", "BUILDER"),
            access.level >= AccessLevel::Builder,
        ),
    ];
    for (index, (guard, id, name, open)) in levels.into_iter().enumerate() {
        let look = ButtonState { on: open, locked: !open };
        let place = cell(key_row(body, key, index / 2), index % 2, 2);
        if walk.button(ui, view, place, (id, name), look) && !open {
            login.unlock(view, guard);
        }
    }
    if walk.button(
        ui,
        view,
        cell(key_row(body, key, 1), 1, 2),
        ("lock", view.text("锁定", "LOCK")),
        ButtonState::default(),
    ) {
        out.push(Command::Page(PageCommand::Lock));
    }
    let words = view.text("输入一次密码，锁定或关机前有效", "one password opens it until LOCK or power-off");
    note(ui, view, body, key_row(body, key, 1), words);
}

fn password_group(ui: &Ui, rect: Rect, view: &View<'_>, (key, walk, login): (f32, &mut KeyboardFocus, &mut Login)) {
    let (body, free) = group(ui, view, rect, view.text("修改密码", "change a password"));
    title_note(ui, view, free, view.text("4 到 16 位数字", "4 to 16 digits"));
    let keys = [
        (PasswordScope::Program, "change-program", view.text("程序编辑", "PROGRAMS")),
        (PasswordScope::User, "change-user", view.text("用户参数", "USER")),
        (PasswordScope::Builder, "change-builder", view.text("机床厂", "BUILDER")),
    ];
    for (index, (guard, id, name)) in keys.into_iter().enumerate() {
        if walk.button(ui, view, cell(key_row(body, key, 0), index, 3), (id, name), ButtonState::default()) {
            login.change(view, guard);
        }
    }
}
