//! Settings: clock, language, colours and brightness, switches, kind of machine, access level, passwords.
//! Source: spec B6, H4, K1 (the kind is retained), K6.2.

mod clock;

use egui::{Align2, Rect, pos2, vec2};

use super::{HandOver, PageContext, PageUi, input_line};
use crate::defs::kind::Kind;
use crate::defs::param::{self, AccessLevel, BitParam};
use crate::defs::text::Text;
use crate::hmi::{Area, EditKey, FieldEditor, KeyboardFocus, Login, PageKey, View, theme};
use crate::link::Command;
use crate::link::page_command::{BRIGHTNESS, BRIGHTNESS_STEP, PageCommand, PasswordScope, ZOOMS};
use clock::ClockGroup;

/// Least and greatest height of a key of this page; heights of a group's title, its edge and its note.
const KEY_HEIGHTS: (f32, f32) = (46.0, 56.0);
const TITLE_HEIGHT: f32 = 30.0;
const GROUP_EDGE: f32 = 10.0;
const NOTE_HEIGHT: f32 = 24.0;
/// Groups of each column: rows of keys, and whether a note is below.
const LEFT_GROUPS: [(f32, bool); 3] = [(1.0, false), (3.0, false), (2.0, false)];
const RIGHT_GROUPS: [(f32, bool); 3] = [(2.0, true), (2.0, true), (1.0, false)];
/// Cells of the row of colours and brightness.
const LOOKS: usize = 5;
/// Frequently used bits of the parameter table, each with the id and the label of its key.
const SWITCHES: [(BitParam, &str, Text); 4] = [
    (param::COUNT_ON_M30, "switch-count", Text::new("M30 计件", "M30 COUNTS")),
    (param::EDIT_OFFSETS, "switch-offsets", Text::new("刀补允许修改", "EDIT OFFSETS")),
    (param::EDIT_VALUES_IN_RUN, "switch-values", Text::new("运行中可改数据", "EDIT IN A RUN")),
    (param::WHEEL_RETRACT, "switch-retract", Text::new("一键回退", "RETRACT KEY")),
];

/// A setting that waits for a password.
#[derive(Clone, Copy, Debug)]
enum PendingSetting {
    /// The kind of machine after the next start.
    Kind(Kind),
    /// A switch by its index.
    Switch(usize),
}

impl PendingSetting {
    const fn level(self) -> AccessLevel {
        match self {
            Self::Kind(_) => AccessLevel::Builder,
            Self::Switch(index) => SWITCHES[index].0.level,
        }
    }

    fn command(self, view: &View<'_>) -> Command {
        Command::Page(match self {
            Self::Kind(kind) => PageCommand::SetNextKind(kind),
            Self::Switch(index) => {
                let bit = SWITCHES[index].0;
                PageCommand::EditParam(bit.address(), if view.snapshot.params.bit(bit) { 0.0 } else { 1.0 })
            }
        })
    }
}

/// State of the page.
#[derive(Debug, Default)]
pub struct SettingsPage {
    pending: Option<PendingSetting>,
    /// The clock group.
    clock: ClockGroup,
    walk: KeyboardFocus,
}

/// A group of keys as it is drawn: a card with a title.
struct SettingsGroup<'a> {
    view: &'a View<'a>,
    /// Rectangle of the keys and the note.
    body: Rect,
    /// Free rectangle beside the title.
    free: Rect,
    /// Height of a key.
    key: f32,
}

impl<'a> SettingsGroup<'a> {
    fn new(view: &'a View<'a>, rect: Rect, key: f32, title: &str) -> Self {
        view.card(rect);
        let (head, body) = rect.shrink2(vec2(theme::PAD, GROUP_EDGE)).split_top(TITLE_HEIGHT);
        let taken = view.fit(head, Align2::LEFT_TOP, title, theme::TITLE, view.theme.text);
        let free = head.band(0.0, 24.0).with_min_x(taken.max.x + theme::PAD);
        Self { view, body, free, key }
    }

    /// A row of keys.
    fn row(&self, row: usize) -> Rect {
        self.body.band(row as f32 * (self.key + theme::GAP), self.key)
    }

    /// Writes beside the title.
    fn title_note(&self, words: &str) {
        self.view.fit_right(self.free, words, theme::LABEL, self.view.theme.muted);
    }

    /// Writes below the two rows of keys.
    fn note(&self, words: &str) {
        let top = self.row(1).max.y;
        let place = self.body.with_min_y(top + 4.0).with_max_y(top + NOTE_HEIGHT);
        self.view.fit_left(place, words, theme::LABEL, self.view.theme.muted);
    }
}

impl PageUi for SettingsPage {
    fn open(&mut self, _view: &View<'_>, _handed_over: Option<HandOver>) {
        *self = Self::default();
    }

    fn typing(&self) -> Option<&FieldEditor> {
        Some(&self.clock.typing)
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        let PageContext { rect, view, typed, login, out, .. } = ctx;
        let edits: &[EditKey] = if login.is_open() { &[] } else { &typed.edits };
        self.walk.begin_frame(&self.clock.handle_edits(view, edits, out));
        // A waiting setting is sent once its level is unlocked, and dropped if the password is not given.
        if let Some(setting) = self.pending {
            let open = view.snapshot.access.level >= setting.level();
            out.extend(open.then(|| setting.command(view)));
            self.pending = Some(setting).filter(|_| !open && login.is_open());
        }
        let (page, input) = input_line::split(rect);
        let inside = page.shrink(theme::PAD);
        let half = (inside.width() - theme::PAD) / 2.0;
        // The left column is the higher one; the right column gets the same height.
        let rows: f32 = LEFT_GROUPS.iter().map(|(rows, _)| rows).sum();
        let key = ((inside.height() - column_height(LEFT_GROUPS, 0.0)) / rows).clamp(KEY_HEIGHTS.0, KEY_HEIGHTS.1);
        let area = inside.band(0.0, column_height(LEFT_GROUPS, key));
        let [clock, look, switches] = column(area.split_left(half).0, LEFT_GROUPS, key);
        let [kind, level, passwords] = column(area.trim_left(half + theme::PAD), RIGHT_GROUPS, key);
        self.clock.ui(&SettingsGroup::new(view, clock, key, view.text("日期、时间", "date and time")), &mut self.walk);
        let title = view.text("语言、颜色、亮度 Language", "Language 语言, colours, brightness");
        self.appearance(&SettingsGroup::new(view, look, key, title), out);
        self.switches(&SettingsGroup::new(view, switches, key, view.text("开关", "switches")), login, out);
        self.kinds(&SettingsGroup::new(view, kind, key, view.text("机床类型", "kind of machine")), login, out);
        self.access(&SettingsGroup::new(view, level, key, view.text("程序、参数开关", "access")), login, out);
        self.passwords(&SettingsGroup::new(view, passwords, key, view.text("修改密码", "change a password")), login);
        self.clock.input_line(input, view);
    }
}

impl SettingsPage {
    /// Sends a setting, or asks for the password of its level first.
    fn set(&mut self, setting: PendingSetting, view: &View<'_>, login: &mut Login, out: &mut Vec<Command>) {
        match PasswordScope::for_level(setting.level()).filter(|_| view.snapshot.access.level < setting.level()) {
            Some(guard) => {
                self.pending = Some(setting);
                login.unlock(view, guard);
            }
            None => out.push(setting.command(view)),
        }
    }

    /// Language, colours and brightness of the screen.
    fn appearance(&mut self, group: &SettingsGroup<'_>, out: &mut Vec<Command>) {
        let view = group.view;
        if view.has_language_faults {
            group.title_note(view.text("语言文件有错：kt830 texts", "a language file is wrong: kt830 texts"));
        }
        let ids: Vec<_> = view.languages.iter().map(|lang| format!("lang-{}", lang.code())).collect();
        let named = view.languages.iter().zip(&ids);
        let languages: Vec<_> =
            named.map(|(lang, id)| PageKey::new(id, lang.own_name()).on(view.lang == *lang)).collect();
        let chosen = self.walk.keys(view, group.row(0), &languages);
        out.extend(chosen.map(|index| Command::Page(PageCommand::SetLang(view.languages[index]))));
        let row = group.row(1);
        let looks =
            [("theme-dark", view.text("深色", "DARK"), false), ("theme-light", view.text("浅色", "LIGHT"), true)];
        for (column, (id, label, light)) in looks.into_iter().enumerate() {
            if self.walk.button(view, row.cell(column, LOOKS), PageKey::new(id, label).on(view.light == light)) {
                out.push(Command::Page(PageCommand::SetLightTheme(light)));
            }
        }
        let words = format!("{} %", view.brightness);
        view.fit_centre(row.cell(3, LOOKS), &words, theme::LABEL, view.theme.text);
        let darker = view.brightness.saturating_sub(BRIGHTNESS_STEP).max(*BRIGHTNESS.start());
        let brighter = view.brightness.saturating_add(BRIGHTNESS_STEP).min(*BRIGHTNESS.end());
        let steps = [(2, "brightness-down", "-", darker), (4, "brightness-up", "+", brighter)];
        for (column, id, label, wanted) in steps {
            if self.walk.button(view, row.cell(column, LOOKS), PageKey::new(id, label)) && wanted != view.brightness {
                out.push(Command::Page(PageCommand::SetBrightness(wanted)));
            }
        }
        let sizes = ZOOMS.map(|percent| (percent, format!("size-{percent}"), format!("{percent} %")));
        let place = group.row(2);
        let label = place.cell(0, sizes.len() + 1);
        view.fit_left(label, view.text("画面大小", "screen size"), theme::LABEL, view.theme.text);
        for (column, (percent, id, label)) in sizes.iter().enumerate() {
            let key = PageKey::new(id, label).on(view.zoom == *percent);
            if self.walk.button(view, place.cell(column + 1, sizes.len() + 1), key) {
                out.push(Command::Page(PageCommand::SetZoom(*percent)));
            }
        }
    }

    /// Frequently used switches with their password level.
    fn switches(&mut self, group: &SettingsGroup<'_>, login: &mut Login, out: &mut Vec<Command>) {
        let view = group.view;
        group.title_note(view.text("亮条为开", "lit bar = on"));
        for (index, (bit, id, label)) in SWITCHES.iter().enumerate() {
            let key = PageKey::new(id, label.get(view.lang)).on(view.snapshot.params.bit(*bit));
            let key = key.locked(view.snapshot.access.level < bit.level);
            if self.walk.button(view, group.row(index / 2).cell(index % 2, 2), key) {
                self.set(PendingSetting::Switch(index), view, login, out);
            }
        }
    }

    fn kinds(&mut self, group: &SettingsGroup<'_>, login: &mut Login, out: &mut Vec<Command>) {
        let view = group.view;
        group.title_note(view.snapshot.kind.name().get(view.lang));
        let next = view.snapshot.next_kind;
        let (first, rest) = (Kind::kt830().count(), Kind::ALL.len() - Kind::kt830().count());
        for (index, kind) in Kind::ALL.into_iter().enumerate() {
            // The KT-830 grinders in the first row, the other kinds below.
            let place =
                if index < first { group.row(0).cell(index, first) } else { group.row(1).cell(index - first, rest) };
            let key = PageKey::new(kind.id(), kind.short_name()).on(kind == next);
            if self.walk.button(view, place, key.locked(view.snapshot.access.level < AccessLevel::Builder)) {
                self.set(PendingSetting::Kind(kind), view, login, out);
            }
        }
        let words = if next == view.snapshot.kind {
            view.text("需要机床厂密码，下次启动生效", "builder's password; from the next start").to_owned()
        } else {
            format!("{} {}", view.text("下次启动：", "from the next start:"), next.name().get(view.lang))
        };
        group.note(&words);
    }

    /// Access levels: unlock by password, lock.
    fn access(&mut self, group: &SettingsGroup<'_>, login: &mut Login, out: &mut Vec<Command>) {
        let (view, access) = (group.view, group.view.snapshot.access);
        let level = access.level.name().get(view.lang);
        group.title_note(&format!("{} {level}", view.text("参数级别：", "parameters:")));
        let (user, builder) = (access.level >= AccessLevel::User, access.level >= AccessLevel::Builder);
        let levels = [
            (PasswordScope::Program, "unlock-program", view.text("程序编辑", "PROGRAMS"), access.program_unlocked),
            (PasswordScope::User, "unlock-user", view.text("用户", "USER"), user),
            (PasswordScope::Builder, "unlock-builder", view.text("机床厂", "BUILDER"), builder),
        ];
        for (index, (guard, id, name, open)) in levels.into_iter().enumerate() {
            let key = PageKey::new(id, name).on(open).locked(!open);
            if self.walk.button(view, group.row(index / 2).cell(index % 2, 2), key) && !open {
                login.unlock(view, guard);
            }
        }
        if self.walk.button(view, group.row(1).cell(1, 2), PageKey::new("lock", view.text("锁定", "LOCK"))) {
            out.push(Command::Page(PageCommand::Lock));
        }
        group.note(view.text("输入一次密码，锁定或关机前有效", "one password unlocks it until LOCK or power-off"));
    }

    fn passwords(&mut self, group: &SettingsGroup<'_>, login: &mut Login) {
        let view = group.view;
        group.title_note(view.text("4 到 16 位数字", "4 to 16 digits"));
        let keys = [
            PageKey::new("change-program", view.text("程序编辑", "PROGRAMS")),
            PageKey::new("change-user", view.text("用户参数", "USER")),
            PageKey::new("change-builder", view.text("机床厂", "BUILDER")),
        ];
        if let Some(index) = self.walk.keys(view, group.row(0), &keys) {
            login.change(view, [PasswordScope::Program, PasswordScope::User, PasswordScope::Builder][index]);
        }
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
fn column(area: Rect, groups: [(f32, bool); 3], key: f32) -> [Rect; 3] {
    let more = (area.height() - column_height(groups, key)) / 3.0;
    let mut top = area.min.y;
    groups.map(|group| {
        let place = Rect::from_min_size(pos2(area.min.x, top), vec2(area.width(), group_height(group, key) + more));
        top = place.max.y + theme::PAD;
        place
    })
}
