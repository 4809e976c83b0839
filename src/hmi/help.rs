//! The help overlay: the keyboard's keys for the panel, from the one table.

use egui::accesskit::Role;
use egui::{Align2, Id, Rect, Sense, Ui, WidgetInfo, pos2, vec2};

use super::keyboard::{SHORTCUTS, Shortcut};
use super::theme;
use super::view::{View, card, fit};

/// Keys that are not panel keys.
const FIXED: [(&str, &str, &str); 8] = [
    ("F1–F5", "软键", "soft keys"),
    ("F6", "软键翻页 ▶", "next row ▶"),
    ("F12", "帮助", "help"),
    ("Enter", "输入", "input"),
    ("Esc", "取消", "cancel"),
    ("Tab", "下一项", "next field"),
    ("X Y Z", "地址键", "address keys"),
    ("Alt+, .", "手轮 - +", "handwheel - +"),
];

/// The written form of a shortcut.
fn written(shortcut: &Shortcut) -> String {
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

/// Draws the overlay over the page; true when it was touched and is to close.
pub fn ui(ui: &Ui, view: &View<'_>, rect: Rect) -> bool {
    let response = ui.interact(rect, Id::unique("help"), Sense::CLICK | Sense::DRAG);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, "关闭帮助 close-help"));
    let painter = ui.painter();
    card(painter, rect, view.theme.surface, view.theme.focus);
    let inside = rect.shrink(theme::PAD);
    let (title, rest) = inside.split_top_bottom_at_y(inside.min.y + 30.0);
    let words = view.say("键盘对照表（按 F12 或触摸关闭）", "keyboard (F12 or touch closes)");
    fit(painter, title, Align2::LEFT_CENTER, words, theme::TITLE, view.theme.text);
    let mut lines: Vec<(String, String)> =
        FIXED.iter().map(|(keys, zh, en)| ((*keys).to_owned(), view.say(zh, en).to_owned())).collect();
    let shown = SHORTCUTS.iter().filter(|shortcut| shortcut.key.is_on(view.snapshot.kind));
    lines.extend(shown.map(|shortcut| (written(shortcut), shortcut.key.label().get(view.lang).to_owned())));
    let columns = if rect.width() > rect.height() * 1.05 { 4 } else { 3 };
    let rows = lines.len().div_ceil(columns);
    let cell = vec2(rest.width() / columns as f32, (rest.height() / rows as f32).min(30.0));
    for (index, (keys, name)) in lines.iter().enumerate() {
        let corner = rest.min + vec2((index / rows) as f32 * cell.x, (index % rows) as f32 * cell.y);
        let place = Rect::from_min_size(corner, cell - vec2(theme::PAD, 0.0));
        let (left, right) = place.split_left_right_at_fraction(0.5);
        fit(painter, left, Align2::LEFT_CENTER, keys, theme::LABEL, view.theme.info);
        let right = Rect::from_min_max(pos2(right.min.x, right.min.y), right.max);
        fit(painter, right, Align2::LEFT_CENTER, name, theme::LABEL, view.theme.text);
    }
    response.clicked()
}
