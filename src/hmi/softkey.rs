//! The soft keys F1–F5 and ▶: five rows, one table.
//! Source: spec K7.1, K7.2.

use egui::accesskit::Role;
use egui::{Align2, Id, Rect, Sense, Ui, WidgetInfo, pos2, vec2};

use super::keycap::{self, Face};
use super::page::position::Shown;
use super::theme;
use super::view::{View, fit, put};
use crate::defs::kind::Kind;
use crate::defs::page::Page;
use crate::defs::text::Text;
use crate::link::Snapshot;

/// What a soft key does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SoftAct {
    /// Opens a page.
    Open(Page),
    /// Opens the position page with these coordinates.
    Position(Shown),
    /// Keeps a picture of the screen.
    Print,
}

impl SoftAct {
    /// What the key does: of a page, what the page is for.
    #[must_use]
    pub const fn help(self) -> Text {
        match self {
            Self::Open(page) => page.help(),
            Self::Position(Shown::Relative) => Text::new(
                "位置页的相对坐标：可清零；在这里设修整点。",
                "The position page with relative coordinates: to be set to zero; dressing points are set here.",
            ),
            Self::Position(Shown::All) => Text::new(
                "位置页的综合坐标：绝对、相对、机床和余移动量。",
                "The position page with all coordinates: absolute, relative, machine and what is left to go.",
            ),
            Self::Position(Shown::Machine) => Text::new(
                "位置页的机床坐标：从机械零点量起。",
                "The position page with machine coordinates, from the machine zero.",
            ),
            Self::Print => Text::new(
                "把当前画面存成图片；位置在信息行说明。",
                "Keeps a picture of the screen; the message line says where.",
            ),
        }
    }
}

/// One soft key.
#[derive(Clone, Copy, Debug)]
pub struct SoftKey {
    /// Label.
    pub label: Text,
    /// What it does.
    pub act: SoftAct,
}

const fn key(zh: &'static str, en: &'static str, act: SoftAct) -> SoftKey {
    SoftKey { label: Text::new(zh, en), act }
}

/// The rows that ▶ turns through; the simulator's is the last. A kind has at most five keys of each.
pub const ROWS: [&[SoftKey]; 5] = [
    &[
        key("相对", "RELATIVE", SoftAct::Position(Shown::Relative)),
        key("综合", "ALL", SoftAct::Position(Shown::All)),
        key("机床", "MACHINE", SoftAct::Position(Shown::Machine)),
        key("磨削", "GRINDING", SoftAct::Open(Page::Grinding)),
        key("砂轮修整", "DRESSING", SoftAct::Open(Page::Dressing)),
        key("录返", "TEACH-IN", SoftAct::Open(Page::Teach)),
        key("刀具棒料", "TOOLS, BAR", SoftAct::Open(Page::Tools)),
    ],
    &[
        key("参数", "PARAMS", SoftAct::Open(Page::Params)),
        key("诊断", "DIAGNOSIS", SoftAct::Open(Page::Diagnosis)),
        key("图形", "GRAPHIC", SoftAct::Open(Page::Graphic)),
        key("U盘/通信", "USB/COMM", SoftAct::Open(Page::Transfer)),
        key("屏幕打印", "PRINT", SoftAct::Print),
    ],
    &[
        key("程序", "PROGRAM", SoftAct::Open(Page::Program)),
        key("录入", "MDI", SoftAct::Open(Page::Mdi)),
        key("目录", "DIRECTORY", SoftAct::Open(Page::Directory)),
        key("刀补", "OFFSETS", SoftAct::Open(Page::Offset)),
        key("宏变量", "MACRO", SoftAct::Open(Page::Macro)),
    ],
    &[
        key("过程", "PROCESS", SoftAct::Open(Page::Process)),
        key("报警", "ALARMS", SoftAct::Open(Page::Alarm)),
        key("换砂轮", "WHEEL", SoftAct::Open(Page::Wheel)),
        key("设置", "SETTINGS", SoftAct::Open(Page::Settings)),
        key("帮助", "HELP", SoftAct::Open(Page::Help)),
    ],
    &[key("模拟", "SIMULATOR", SoftAct::Open(Page::Simulator))],
];

/// The keys of a row on a kind.
pub fn row(kind: Kind, row: usize) -> impl Iterator<Item = &'static SoftKey> {
    let has = move |soft: &&SoftKey| !matches!(soft.act, SoftAct::Open(page) if !page.is_on(kind));
    ROWS.get(row % ROWS.len()).into_iter().flat_map(|row| row.iter()).filter(has)
}

impl SoftKey {
    /// Its label on a kind.
    #[must_use]
    pub fn label_on(&self, kind: Kind) -> Text {
        match self.act {
            SoftAct::Open(page @ (Page::Mdi | Page::Grinding)) if page.title_on(kind) != page.title() => {
                page.title_on(kind)
            }
            _ => self.label,
        }
    }

    fn words(&self, view: &View<'_>) -> &'static str {
        self.label_on(view.snapshot.kind).get(view.lang)
    }
}

/// The number of rows of a machine: where none is simulated, the last one is not there.
#[must_use]
pub const fn rows(snapshot: &Snapshot) -> usize {
    if snapshot.simulated.is_some() { ROWS.len() } else { ROWS.len() - 1 }
}

/// The row that is turned to when a page opens.
#[must_use]
pub const fn row_of(page: Page) -> usize {
    match page {
        Page::Position | Page::Panel | Page::Dressing | Page::Teach | Page::Tools => 0,
        Page::Grinding | Page::Params | Page::Diagnosis | Page::Graphic | Page::Transfer => 1,
        Page::Program | Page::Designer | Page::Mdi | Page::Directory | Page::Offset | Page::Macro => 2,
        Page::Process | Page::Alarm | Page::Wheel | Page::Settings | Page::Help => 3,
        Page::Simulator => 4,
    }
}

/// Which soft key was pressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pressed {
    /// One of F1–F5.
    Act(SoftAct),
    /// ▶
    Next,
}

/// Draws a row; `chosen` says whether a key's page is the open one.
pub fn ui(ui: &Ui, view: &View<'_>, rect: Rect, row: usize, chosen: impl Fn(SoftAct) -> bool) -> Option<Pressed> {
    let mut pressed = None;
    let inner = rect.shrink2(vec2(theme::GAP, 3.0));
    let next_width = 52.0;
    let width = (inner.width() - next_width - 5.0 * theme::GAP) / 5.0;
    let rows = rows(view.snapshot);
    let row = row % rows;
    for (index, soft) in self::row(view.snapshot.kind, row).enumerate() {
        let left = inner.min.x + index as f32 * (width + theme::GAP);
        let place = Rect::from_min_size(pos2(left, inner.min.y), vec2(width, inner.height()));
        if one(ui, view, place, index, soft, chosen(soft.act)) {
            pressed = Some(Pressed::Act(soft.act));
        }
    }
    let place = Rect::from_min_max(pos2(inner.max.x - next_width, inner.min.y), inner.max);
    let response = ui.interact(place, Id::unique("soft-next"), Sense::CLICK);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, "▶ next-row"));
    let face = Face { pressed: response.is_pointer_button_down_on(), ..Face::default() };
    keycap::plate(ui.painter(), view.theme, place, face);
    let (sign, count) = place.split_top_bottom_at_fraction(0.6);
    put(ui.painter(), sign, Align2::CENTER_CENTER, "▶", theme::TITLE, view.theme.text);
    let which = format!("{}/{}", row + 1, rows);
    put(ui.painter(), count, Align2::CENTER_CENTER, &which, theme::SMALL, view.theme.quiet);
    if response.clicked() { Some(Pressed::Next) } else { pressed }
}

fn one(ui: &Ui, view: &View<'_>, place: Rect, index: usize, soft: &SoftKey, chosen: bool) -> bool {
    let response = ui.interact(place, Id::unique(("soft", index)), Sense::CLICK);
    let name = format!("{} f{}", soft.words(view), index + 1);
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, chosen, &name));
    let face = Face { pressed: response.is_pointer_button_down_on(), ..Face::default() };
    let painter = ui.painter();
    keycap::plate(painter, view.theme, place, face);
    let ink = if chosen { view.theme.info } else { view.theme.text };
    let tag = Rect::from_min_size(place.min + vec2(7.0, 3.0), vec2(30.0, 16.0));
    put(painter, tag, Align2::LEFT_CENTER, &format!("F{}", index + 1), theme::SMALL, view.theme.quiet);
    let words = Rect::from_min_max(pos2(place.min.x + 4.0, place.min.y + 16.0), place.max - vec2(4.0, 2.0));
    fit(painter, words, Align2::CENTER_CENTER, soft.words(view), theme::TITLE, ink);
    if chosen {
        let bar = Rect::from_min_size(pos2(place.min.x + 6.0, place.max.y - 4.0), vec2(place.width() - 12.0, 3.0));
        painter.rect_filled(bar, 1.0, view.theme.info);
    }
    response.clicked()
}
