//! The keyboard map: the keyboard shortcuts of the panel by group, from the shortcut table.
//! Source: spec K2.1 (same keys reachable from a keyboard).

use egui::{Rect, pos2, vec2};

use crate::defs::key::KeyGroup;
use crate::defs::text::Text;
use crate::hmi::keyboard::{SHORTCUTS, Shortcut};
use crate::hmi::{Area, View, theme};

/// Keys of the screen that are not panel keys.
const SCREEN: [(&str, Text); 14] = [
    ("F1–F5", Text::new("软键", "soft keys")),
    ("F6", Text::new("软键下一行 ▶", "next row ▶")),
    ("Shift+F6", Text::new("软键上一行 ◀", "previous row ◀")),
    ("Ctrl+F6", Text::new("全部页面", "all pages")),
    ("F7", Text::new("报警", "alarms")),
    ("F12", Text::new("帮助 ?", "help ?")),
    ("Enter", Text::new("输入", "input")),
    ("Esc", Text::new("取消", "cancel")),
    ("Tab ↑↓", Text::new("下一项", "next field")),
    ("PgUp PgDn", Text::new("翻页", "scroll")),
    ("X Y Z", Text::new("地址键", "address keys")),
    ("/", Text::new("查找", "search")),
    ("Alt+↑↓←→", Text::new("放大时移动", "move when zoomed")),
    ("Alt+, .", Text::new("手轮 - +", "handwheel - +")),
];

/// The key groups in the order of the panel.
const GROUPS: [(KeyGroup, Text); 12] = [
    (KeyGroup::Mode, Text::new("方式", "MODES")),
    (KeyGroup::Switch, Text::new("开关", "SWITCHES")),
    (KeyGroup::Run, Text::new("运行", "RUN")),
    (KeyGroup::Override, Text::new("倍率", "OVERRIDES")),
    (KeyGroup::Jog, Text::new("方向", "DIRECTIONS")),
    (KeyGroup::Handwheel, Text::new("手轮", "HANDWHEEL")),
    (KeyGroup::Wheel, Text::new("砂轮", "WHEEL")),
    (KeyGroup::Workpiece, Text::new("工件", "WORKPIECE")),
    (KeyGroup::Clamping, Text::new("装夹", "CLAMPING")),
    (KeyGroup::Fluids, Text::new("液体", "FLUIDS")),
    (KeyGroup::Gauges, Text::new("量仪", "GAUGES")),
    (KeyGroup::Dressing, Text::new("修整", "DRESSING")),
];

/// One line of the map.
enum MapLine {
    Caption(Text),
    Entry(String, Text),
}

/// The written form of a shortcut.
pub fn shortcut_label(shortcut: &Shortcut) -> String {
    let prefix = match (shortcut.modifiers.ctrl, shortcut.modifiers.alt) {
        (true, _) => "Ctrl+",
        (false, true) => "Alt+",
        (false, false) => "",
    };
    let name = match shortcut.physical {
        egui::Key::PageUp => "PgUp",
        egui::Key::PageDown => "PgDn",
        other => other.name(),
    };
    format!("{prefix}{name}")
}

/// All keys of the kind, by group; two physical keys of one panel key share a line.
fn groups(view: &View<'_>) -> Vec<Vec<MapLine>> {
    let screen = SCREEN.iter().map(|(keys, name)| MapLine::Entry((*keys).to_owned(), *name));
    let mut all = vec![vec![MapLine::Caption(Text::new("屏幕", "SCREEN"))]];
    all[0].extend(screen);
    for (group, caption) in GROUPS {
        let mut lines = vec![MapLine::Caption(caption)];
        let mut last = None;
        let fitted = view.snapshot.fitted();
        let shown =
            SHORTCUTS.iter().filter(|shortcut| shortcut.key.row().group == group && shortcut.key.exists_on(fitted));
        for shortcut in shown {
            match lines.last_mut() {
                Some(MapLine::Entry(keys, _)) if last == Some(shortcut.key) => {
                    keys.push(' ');
                    keys.push_str(&shortcut_label(shortcut));
                }
                _ => lines.push(MapLine::Entry(shortcut_label(shortcut), shortcut.key.label_on(view.snapshot.kind))),
            }
            last = Some(shortcut.key);
        }
        all.push(lines);
    }
    all
}

/// Draws the map.
pub fn ui(view: &View<'_>, rect: Rect) {
    let rest = rect.shrink2(vec2(0.0, theme::GAP));
    let groups = groups(view);
    let columns = if rect.width() > 640.0 { 4 } else { 3 };
    let (rows, places) = flow_columns(&groups, columns);
    let cell = vec2(rest.width() / columns as f32, (rest.height() / rows as f32).min(30.0));
    for (group, (column, top)) in groups.iter().zip(places) {
        for (index, line) in group.iter().enumerate() {
            let corner = rest.min + vec2(column as f32 * cell.x, (top + index) as f32 * cell.y);
            let place = Rect::from_min_size(corner, cell - vec2(theme::PAD, 0.0));
            match line {
                MapLine::Caption(text) => {
                    let under = pos2(place.min.x, place.max.y - 2.0);
                    let stroke = egui::Stroke::new(theme::HAIRLINE, view.theme.line);
                    view.painter.hline(under.x..=place.max.x, under.y, stroke);
                    view.fit_left(place, text.get(view.lang), theme::SMALL, view.theme.muted);
                }
                MapLine::Entry(keys, name) => {
                    let (left, right) = place.split_left_right_at_fraction(0.48);
                    view.fit_left(left.trim_right(4.0), keys, theme::LABEL, view.theme.info);
                    view.fit_left(right, name.get(view.lang), theme::LABEL, view.theme.text);
                }
            }
        }
    }
}

/// Distributes whole groups over columns: returns the lines per column, and column and line where each group starts.
fn flow_columns(groups: &[Vec<MapLine>], columns: usize) -> (usize, Vec<(usize, usize)>) {
    let all: usize = groups.iter().map(Vec::len).sum();
    let longest = groups.iter().map(Vec::len).max().unwrap_or(1);
    let mut rows = all.div_ceil(columns).max(longest);
    loop {
        let (mut column, mut top) = (0, 0);
        let mut places = Vec::with_capacity(groups.len());
        for group in groups {
            if top > 0 && top + group.len() > rows {
                (column, top) = (column + 1, 0);
            }
            places.push((column, top));
            top += group.len();
        }
        if column < columns {
            return (rows, places);
        }
        rows += 1;
    }
}
