//! The soft keys F1–F5 and ▶: one table of five rows. The screen and the core use the same table, so a key in a story
//! does the same as a touch.
//! Source: spec K7.1, K7.2.

use super::kind::Kind;
use super::page::Page;
use super::text::Text;

/// The coordinates shown on the position page. Dressing points are set on the relative view, which is not the default,
/// to avoid operating errors (K4.2).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CoordinateView {
    /// F1 相对
    Relative,
    /// F2 综合
    #[default]
    All,
    /// F3 机床
    Machine,
}

impl CoordinateView {
    /// The title of the view.
    #[must_use]
    pub const fn title(self) -> Text {
        match self {
            Self::Relative => Text::new("相对坐标", "relative"),
            Self::All => Text::new("综合坐标", "all coordinates"),
            Self::Machine => Text::new("机床坐标", "machine"),
        }
    }
}

/// The action of a soft key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SoftKeyAction {
    /// Opens a page.
    Open(Page),
    /// Opens the position page with these coordinates.
    Position(CoordinateView),
    /// Saves a picture of the screen.
    Print,
}

impl SoftKeyAction {
    /// Help text of the key; for a page, the purpose of the page.
    #[must_use]
    pub const fn help(self) -> Text {
        match self {
            Self::Open(page) => page.help(),
            Self::Position(CoordinateView::Relative) => Text::new(
                "位置页的相对坐标：可清零；在这里设修整点。",
                "The position page with relative coordinates: they can be set to zero; dressing points are set here.",
            ),
            Self::Position(CoordinateView::All) => Text::new(
                "位置页的综合坐标：绝对、相对、机床和余移动量。",
                "The position page with all coordinates: absolute, relative, machine and distance to go.",
            ),
            Self::Position(CoordinateView::Machine) => Text::new(
                "位置页的机床坐标：从机械零点量起。",
                "The position page with machine coordinates, from the machine zero.",
            ),
            Self::Print => Text::new(
                "把当前画面存成图片；位置在信息行说明。",
                "Saves a picture of the screen; the message line shows where.",
            ),
        }
    }
}

/// One soft key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SoftKey {
    /// Label.
    pub label: Text,
    /// Action.
    pub action: SoftKeyAction,
}

const fn key(zh: &'static str, en: &'static str, action: SoftKeyAction) -> SoftKey {
    SoftKey { label: Text::new(zh, en), action }
}

/// The rows that ▶ switches through; the simulator row is the last. A kind has at most five keys per row.
pub const ROWS: [&[SoftKey]; 5] = [
    &[
        key("相对", "RELATIVE", SoftKeyAction::Position(CoordinateView::Relative)),
        key("综合", "ALL", SoftKeyAction::Position(CoordinateView::All)),
        key("机床", "MACHINE", SoftKeyAction::Position(CoordinateView::Machine)),
        key("磨削", "GRINDING", SoftKeyAction::Open(Page::Grinding)),
        key("砂轮修整", "DRESSING", SoftKeyAction::Open(Page::Dressing)),
        key("录返", "TEACH-IN", SoftKeyAction::Open(Page::Teach)),
        key("刀具棒料", "TOOLS, BAR", SoftKeyAction::Open(Page::Tools)),
    ],
    &[
        key("参数", "PARAMS", SoftKeyAction::Open(Page::Params)),
        key("诊断", "DIAGNOSIS", SoftKeyAction::Open(Page::Diagnosis)),
        key("图形", "GRAPHIC", SoftKeyAction::Open(Page::Graphic)),
        key("U盘/通信", "USB/COMM", SoftKeyAction::Open(Page::Transfer)),
        key("屏幕打印", "PRINT", SoftKeyAction::Print),
    ],
    &[
        key("程序", "PROGRAM", SoftKeyAction::Open(Page::Program)),
        key("录入", "MDI", SoftKeyAction::Open(Page::Mdi)),
        key("目录", "DIRECTORY", SoftKeyAction::Open(Page::Directory)),
        key("刀补", "OFFSETS", SoftKeyAction::Open(Page::Offset)),
        key("宏变量", "MACRO", SoftKeyAction::Open(Page::Macro)),
    ],
    &[
        key("过程", "PROCESS", SoftKeyAction::Open(Page::Process)),
        key("报警", "ALARMS", SoftKeyAction::Open(Page::Alarm)),
        key("换砂轮", "WHEEL", SoftKeyAction::Open(Page::Wheel)),
        key("设置", "SETTINGS", SoftKeyAction::Open(Page::Settings)),
        key("帮助", "HELP", SoftKeyAction::Open(Page::Help)),
    ],
    &[key("模拟", "SIMULATOR", SoftKeyAction::Open(Page::Simulator))],
];

/// The keys of a row on a kind.
pub fn row(kind: Kind, row: usize) -> impl Iterator<Item = &'static SoftKey> {
    let has = move |soft: &&SoftKey| !matches!(soft.action, SoftKeyAction::Open(page) if !page.exists_on(kind));
    ROWS.get(row % ROWS.len()).into_iter().flat_map(|row| row.iter()).filter(has)
}

impl SoftKey {
    /// The label on a kind.
    #[must_use]
    pub fn label_on(&self, kind: Kind) -> Text {
        match self.action {
            SoftKeyAction::Open(page) if page.title_on(kind) != page.title() => page.title_on(kind),
            _ => self.label,
        }
    }
}

/// The number of rows: without a simulated machine the last row is omitted (P1).
#[must_use]
pub const fn row_count(simulated: bool) -> usize {
    if simulated { ROWS.len() } else { ROWS.len() - 1 }
}

/// The row shown when a page opens.
#[must_use]
pub const fn row_of_page(page: Page) -> usize {
    match page {
        Page::Position | Page::Panel | Page::Dressing | Page::Teach | Page::Tools => 0,
        Page::Grinding | Page::Params | Page::Diagnosis | Page::Graphic | Page::Transfer => 1,
        Page::Program | Page::Designer | Page::Mdi | Page::Directory | Page::Offset | Page::Macro => 2,
        Page::Process | Page::Alarm | Page::Wheel | Page::Settings | Page::Help => 3,
        Page::Simulator => 4,
    }
}
