//! The soft keys F1–F5 in six rows, and ◀ ▶ that turn the rows. A page shows the row of its key when it opens; the
//! grinding page shows the row of the customer's picture. The screen and the core use the same keys, so a key in a story
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
    /// Continues the stopped program.
    Continue,
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
            Self::Continue => Text::new(
                "程序停止（M00）后继续，同循环启动。",
                "Continues after a program stop (M00), as cycle start does.",
            ),
        }
    }

    /// Whether it opens a page, or a view of one.
    #[must_use]
    pub const fn opens_page(self) -> bool {
        matches!(self, Self::Open(_) | Self::Position(_))
    }

    /// The label of its key on a kind.
    #[must_use]
    pub fn label_on(self, kind: Kind) -> Text {
        match self {
            Self::Open(page) if page.title_on(kind) != page.title() => page.title_on(kind),
            Self::Open(page) => page.soft_key().map_or(page.title(), |(_, label)| label),
            Self::Position(CoordinateView::Relative) => Text::new("相对", "RELATIVE"),
            Self::Position(CoordinateView::All) => Text::new("综合", "ALL"),
            Self::Position(CoordinateView::Machine) => Text::new("机床", "MACHINE"),
            Self::Print => Text::new("屏幕打印", "PRINT"),
            Self::Continue => Text::new("继续", "CONTINUE"),
        }
    }
}

/// One soft key on a kind of machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SoftKey {
    /// Label.
    pub label: Text,
    /// Action.
    pub action: SoftKeyAction,
}

/// Number of rows that ▶ switches through; those of simulator, bus and production are the last.
pub const ROWS: usize = 6;
/// Of them those that a machine has that is simulated or on a bus.
const LAST_ROWS: usize = 2;

/// The keys that do not stand in the row of a page: row and place, as there.
const OTHER_KEYS: [((usize, usize), SoftKeyAction); 4] = [
    ((0, 1), SoftKeyAction::Position(CoordinateView::Relative)),
    ((0, 2), SoftKeyAction::Position(CoordinateView::All)),
    ((0, 3), SoftKeyAction::Position(CoordinateView::Machine)),
    ((1, 5), SoftKeyAction::Print),
];

/// The keys of a row on a kind, F1 to F5.
pub fn row(kind: Kind, row: usize) -> impl Iterator<Item = SoftKey> {
    let pages = Page::ALL.iter().filter(move |page| page.exists_on(kind));
    let of_pages = pages.filter_map(|page| Some((page.soft_key()?.0, SoftKeyAction::Open(*page))));
    let keys = OTHER_KEYS.into_iter().chain(of_pages);
    (1..=5).flat_map(move |place| {
        let here = keys.clone().filter(move |(at, _)| *at == (row % ROWS, place));
        here.map(move |(_, action)| SoftKey { label: action.label_on(kind), action })
    })
}

/// Whether F1 continues a stopped program on a kind (L7).
#[must_use]
pub fn f1_continues(kind: Kind) -> bool {
    kind.is_lathe()
}

/// The keys of a row as they act now: F1 may continue a stopped program.
pub fn row_now(kind: Kind, number: usize, stopped: bool) -> impl Iterator<Item = SoftKey> {
    let continues = stopped && f1_continues(kind);
    let key = SoftKey { label: SoftKeyAction::Continue.label_on(kind), action: SoftKeyAction::Continue };
    row(kind, number).enumerate().map(move |(index, soft)| if continues && index == 0 { key } else { soft })
}

/// Row and index of the key of an action on a kind, from 0; `None` if the kind has no such key.
#[must_use]
pub fn place(kind: Kind, action: SoftKeyAction) -> Option<(usize, usize)> {
    (0..ROWS).find_map(|number| Some((number, row(kind, number).position(|soft| soft.action == action)?)))
}

/// The key that is lit while a page is open. The page designer opens from the program, the panel stands beside the
/// positions: they have no key of their own.
#[must_use]
pub const fn key_of_page(page: Page, coordinates: CoordinateView) -> SoftKeyAction {
    match page {
        Page::Position | Page::Panel => SoftKeyAction::Position(coordinates),
        Page::Designer => SoftKeyAction::Open(Page::Program),
        other => SoftKeyAction::Open(other),
    }
}

/// The number of rows: the last ones are for a simulated machine (P1) or a field bus, and omitted without them.
#[must_use]
pub const fn row_count(has_last: bool) -> usize {
    if has_last { ROWS } else { ROWS - LAST_ROWS }
}
