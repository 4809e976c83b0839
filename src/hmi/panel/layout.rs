//! The layout of the panel keys: geometry only. Source: spec H2, K1 (direction keys of each kind).

use egui::{Pos2, Rect, pos2, vec2};

use crate::defs::fitted::Fitted;
use crate::defs::key::Key;
use crate::defs::kind::{Kind, MachineUnit};
use crate::defs::text::Text;
use crate::hmi::{Area, theme};

/// A group of keys: frame and optional caption.
#[derive(Clone, Debug, PartialEq)]
pub struct PanelGroup {
    /// Rectangle around the keys.
    pub frame: Rect,
    /// Caption at the top of the frame.
    pub caption: Option<(Rect, Text)>,
}

/// The layout of the panel.
#[derive(Clone, Debug)]
pub struct PanelLayout {
    /// All keys of the machine.
    pub keys: Vec<(Key, Rect)>,
    /// Groups.
    pub groups: Vec<PanelGroup>,
    /// The handwheel.
    pub handwheel: Rect,
    /// Feed override value, between its two keys.
    pub feed_value: Rect,
    /// Spindle override value, between its two keys.
    pub spindle_value: Rect,
}

/// Gap between keys of a group, gap between groups, height of a caption, margin of the panel; points.
const KEY_GAP: f32 = 3.0;
const GROUP_GAP: f32 = 6.0;
const CAPTION_HEIGHT: f32 = 16.0;
const MARGIN: f32 = 5.0;
/// Height of the machine units, in rows of keys.
const UNIT_ROWS: f32 = 3.0;

/// Computes the layout of the panel.
#[must_use]
pub fn panel_layout(machine: impl Into<Fitted>, rect: Rect, portrait: bool) -> PanelLayout {
    let empty = Rect::from_min_size(rect.min, vec2(0.0, 0.0));
    let mut layout = PanelLayout {
        keys: Vec::with_capacity(64),
        groups: Vec::with_capacity(16),
        handwheel: empty,
        feed_value: empty,
        spindle_value: empty,
    };
    let inside = rect.shrink(MARGIN);
    // On a portrait display three columns of six rows of keys, else one column: fifteen rows of keys, fourteen on the
    // wide panel, plus captions and gaps within and between groups.
    let wide = !portrait && rect.width() >= theme::PANEL.1;
    let (width, key_height) = if portrait {
        ((inside.width() - 2.0 * GROUP_GAP) / 3.0, (inside.height() - 3.0 * KEY_GAP - 2.0 * GROUP_GAP) / 6.0)
    } else {
        let (rows, gaps) = if wide { (14.0, 6.0) } else { (15.0, 7.0) };
        let fixed = 2.0 * CAPTION_HEIGHT + 7.0 * KEY_GAP + gaps * GROUP_GAP;
        (inside.width(), ((inside.height() - fixed) / rows).min(64.0))
    };
    let machine = machine.into();
    let mut build = PanelBuilder { layout: &mut layout, machine, key_height, cursor: inside.min, width, wide };
    build.modes();
    if portrait {
        let column = |index: f32| pos2(inside.min.x + index * (width + GROUP_GAP), inside.min.y);
        build.overrides();
        build.cursor = column(1.0);
        build.machine_units();
        build.cursor = column(2.0);
        build.jog();
        build.run_row();
    } else {
        build.machine_units();
        build.overrides();
        build.jog();
        build.run_row();
    }
    layout
}

/// Column and row of the jog keys of a kind in a 3 × 3 cross: rapid in the middle, the third axis on the diagonal.
#[must_use]
pub const fn jog_positions(kind: Kind) -> [(Key, u8, u8); 7] {
    let [[left, right], [up, down], [away, near]] = kind.ui().jog_cross;
    [(left, 0, 1), (right, 2, 1), (up, 1, 0), (down, 1, 2), (away, 2, 0), (near, 0, 2), (Key::Rapid, 1, 1)]
}

/// The modes and, beside them on the wide panel, two switches of the program.
const MODES: [Key; 10] = [
    Key::ModeEdit,
    Key::ModeAuto,
    Key::ModeMdi,
    Key::ModeHome,
    Key::ModeHandwheel,
    Key::ModeStep,
    Key::ModeManual,
    Key::SingleBlock,
    Key::BlockSkip,
    Key::OptionalStop,
];
/// The switches of the narrow panel; on the wide one the trial-run switches have their own column.
const SWITCHES: [Key; 5] = [Key::BlockSkip, Key::OptionalStop, Key::MachineLock, Key::AuxFunctionLock, Key::DryRun];
const RAPIDS: [Key; 4] = [Key::RapidF0, Key::Rapid25, Key::Rapid50, Key::Rapid100];
const HANDWHEEL: [[Key; 2]; 3] =
    [[Key::HandwheelX, Key::Step0001], [Key::HandwheelY, Key::Step001], [Key::HandwheelZ, Key::Step01]];

/// Places the groups from top to bottom.
struct PanelBuilder<'a> {
    layout: &'a mut PanelLayout,
    machine: Fitted,
    key_height: f32,
    cursor: Pos2,
    width: f32,
    wide: bool,
}

impl PanelBuilder<'_> {
    /// A cell of a grid with `columns` columns, from the current corner.
    fn cell(&self, columns: f32, column: usize, row: usize) -> Rect {
        let width = (self.width - (columns - 1.0) * KEY_GAP) / columns;
        let corner = self.cursor + vec2(column as f32 * (width + KEY_GAP), row as f32 * (self.key_height + KEY_GAP));
        Rect::from_min_size(corner, vec2(width, self.key_height))
    }

    fn advance(&mut self, rows: f32, gap: f32) {
        self.cursor.y += rows * self.key_height + (rows - 1.0).max(0.0) * KEY_GAP + gap;
    }

    fn group(&mut self, around: Rect, caption: Option<Text>) {
        let caption = caption.map(|text| {
            let bar =
                Rect::from_min_max(pos2(around.min.x, around.min.y - CAPTION_HEIGHT), pos2(around.max.x, around.min.y));
            (bar, text)
        });
        let frame = caption.as_ref().map_or(around, |(bar, _)| around.union(*bar)).expand(2.0);
        self.layout.groups.push(PanelGroup { frame, caption });
    }

    fn rows(&mut self, columns: f32, keys: &[Key], caption: Option<Text>) {
        let mut around = Rect::NOTHING;
        for (index, key) in keys.iter().enumerate() {
            let cell = self.cell(columns, index % columns as usize, index / columns as usize);
            around = around.union(cell);
            self.layout.keys.push((*key, cell));
        }
        self.group(around, caption);
    }

    fn modes(&mut self) {
        if self.wide {
            self.rows(5.0, &MODES, None);
            self.advance(2.0, GROUP_GAP);
            return;
        }
        self.rows(4.0, &MODES[..8], None);
        self.advance(2.0, GROUP_GAP);
        self.rows(5.0, &SWITCHES, None);
        self.advance(1.0, GROUP_GAP);
    }

    /// The units of the machine side by side, then the row of units below them.
    fn machine_units(&mut self) {
        let (machine, ui) = (self.machine, self.machine.kind.ui());
        let panel = if self.wide { ui.wide_panel } else { ui.panel };
        for (units, beside) in [(panel.beside, true), (panel.below, false)] {
            self.cursor.y += CAPTION_HEIGHT;
            let fitted = units.iter().filter(|unit| unit.keys.iter().any(|key| key.exists_on(machine)));
            let columns = fitted.clone().map(|unit| unit.columns).sum();
            let mut column = 0;
            for unit in fitted {
                self.unit((column, columns), unit, beside);
                column += unit.columns;
            }
            self.advance(if beside { UNIT_ROWS } else { 1.0 }, GROUP_GAP);
        }
    }

    /// Keys in a column, two keys sharing the height of three; else side by side, sharing the columns of the unit. The
    /// unit begins at a column of so many.
    fn unit(&mut self, (column, count): (usize, usize), unit: &MachineUnit, upright: bool) {
        let &MachineUnit { caption, keys, columns } = unit;
        let top = self.cell(count as f32, column, 0).union(self.cell(count as f32, column + columns - 1, 0));
        let height = UNIT_ROWS * self.key_height + (UNIT_ROWS - 1.0) * KEY_GAP;
        let whole = if upright { height } else { top.width() };
        let each = (whole - (keys.len() as f32 - 1.0) * KEY_GAP) / keys.len() as f32;
        for (index, key) in keys.iter().enumerate() {
            let by = index as f32 * (each + KEY_GAP);
            let (by, size) = match upright {
                true => (vec2(0.0, by), vec2(top.width(), each)),
                false => (vec2(by, 0.0), vec2(each, self.key_height)),
            };
            self.layout.keys.push((*key, Rect::from_min_size(top.min + by, size)));
        }
        self.group(if upright { top.band(0.0, height) } else { top }, Some(caption));
    }

    /// Feed and spindle override with their values between the keys, then the rapid override keys.
    fn overrides(&mut self) {
        let half = (self.width - GROUP_GAP) / 2.0;
        let side = theme::TOUCH_TARGET + 1.0;
        let pairs = [(Key::FeedOverrideDown, Key::FeedOverrideUp), (Key::SpindleOverrideDown, Key::SpindleOverrideUp)];
        for (index, (less, more)) in pairs.into_iter().enumerate() {
            let left = self.cursor + vec2(index as f32 * (half + GROUP_GAP), 0.0);
            let (first, rest) = Rect::from_min_size(left, vec2(half, self.key_height)).split_left(side);
            let (value, last) = rest.split_right(side);
            self.layout.keys.push((less, first));
            self.layout.keys.push((more, last));
            if index == 0 { self.layout.feed_value = value } else { self.layout.spindle_value = value }
        }
        let top = self.cursor;
        self.cursor.y += self.key_height + KEY_GAP;
        for (index, key) in RAPIDS.into_iter().enumerate() {
            self.layout.keys.push((key, self.cell(4.0, index, 0)));
        }
        self.group(Rect::from_min_size(top, vec2(self.width, 2.0 * self.key_height + KEY_GAP)), None);
        self.advance(1.0, GROUP_GAP);
    }

    /// The jog cross of the kind, with the handwheel axis and step keys beside it.
    fn jog(&mut self) {
        // The last column, the steps, is wider: ×0.001 has six characters.
        let unit = ((self.width - 3.0 * KEY_GAP - GROUP_GAP) / 5.0 - 2.0).max(theme::TOUCH_TARGET);
        let place = |at: Pos2, left: f32, column: u8, row: u8, key: f32| {
            let corner = at + vec2(left + f32::from(column) * (unit + KEY_GAP), f32::from(row) * (key + KEY_GAP));
            Rect::from_min_size(corner, vec2(unit, key))
        };
        for (key, column, row) in jog_positions(self.machine.kind) {
            self.layout.keys.push((key, place(self.cursor, 0.0, column, row, self.key_height)));
        }
        let left = 3.0 * unit + 2.0 * KEY_GAP + GROUP_GAP;
        for (row, keys) in HANDWHEEL.into_iter().enumerate() {
            for (column, key) in keys.into_iter().enumerate() {
                let mut cell = place(self.cursor, left, column as u8, row as u8, self.key_height);
                if column == 1 {
                    cell.max.x = self.cursor.x + self.width;
                }
                self.layout.keys.push((key, cell));
            }
        }
        let height = 3.0 * self.key_height + 2.0 * KEY_GAP;
        self.group(Rect::from_min_size(self.cursor, vec2(3.0 * unit + 2.0 * KEY_GAP, height)), None);
        self.group(Rect::from_min_size(self.cursor + vec2(left, 0.0), vec2(self.width - left, height)), None);
        self.advance(3.0, GROUP_GAP);
    }

    /// Handwheel and reset, then cycle start, feed hold and emergency stop, large and well apart.
    fn run_row(&mut self) {
        let stop = (self.width * 0.32).round();
        let reset =
            Rect::from_min_size(pos2(self.cursor.x + self.width - stop, self.cursor.y), vec2(stop, self.key_height));
        self.layout.keys.push((Key::Reset, reset));
        self.layout.handwheel =
            Rect::from_min_max(self.cursor, pos2(reset.min.x - GROUP_GAP, self.cursor.y + self.key_height));
        self.advance(1.0, GROUP_GAP);
        let height = 2.0 * self.key_height + KEY_GAP;
        let apart = theme::PAD - 2.0;
        let width = (self.width - stop - 2.0 * apart) / 2.0;
        for (index, key) in [Key::CycleStart, Key::FeedHold].into_iter().enumerate() {
            let corner = self.cursor + vec2(index as f32 * (width + apart), 0.0);
            self.layout.keys.push((key, Rect::from_min_size(corner, vec2(width, height))));
        }
        let corner = pos2(self.cursor.x + self.width - stop, self.cursor.y);
        self.layout.keys.push((Key::EmergencyStop, Rect::from_min_size(corner, vec2(stop, height))));
        self.advance(2.0, 0.0);
    }
}
