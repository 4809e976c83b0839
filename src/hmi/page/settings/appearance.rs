//! Language, colours and brightness of the screen. Source: spec B6, H4.

use egui::{Align2, Rect, Ui};

use super::{group, key_row};
use crate::defs::text::Lang;
use crate::hmi::theme;
use crate::hmi::view::{View, fit_text};
use crate::hmi::widget::{ButtonState, KeyboardFocus, cell};
use crate::link::Command;
use crate::link::page_command::{BRIGHTNESS, BRIGHTNESS_STEP, PageCommand};

/// Draws the group.
pub fn ui(ui: &Ui, rect: Rect, view: &View<'_>, (key, walk): (f32, &mut KeyboardFocus), out: &mut Vec<Command>) {
    let (body, _) = group(ui, view, rect, view.text("语言、颜色、亮度 Language", "Language 语言, colours, brightness"));
    let row = key_row(body, key, 0);
    for (index, (lang, id, name)) in
        [(Lang::Zh, "lang-zh", "中文"), (Lang::En, "lang-en", "English")].into_iter().enumerate()
    {
        let look = ButtonState { on: lang == view.lang, locked: false };
        if walk.button(ui, view, cell(row, index, 4), (id, name), look) {
            out.push(Command::Page(PageCommand::SetLang(lang)));
        }
    }
    let themes = [(false, "theme-dark", view.text("深色", "DARK")), (true, "theme-light", view.text("浅色", "LIGHT"))];
    for (index, (wanted, id, name)) in themes.into_iter().enumerate() {
        let look = ButtonState { on: view.light == wanted, locked: false };
        if walk.button(ui, view, cell(row, index + 2, 4), (id, name), look) {
            out.push(Command::Page(PageCommand::SetLightTheme(wanted)));
        }
    }
    let row = key_row(body, key, 1);
    let figure = Rect::from_min_max(cell(row, 1, 4).min, cell(row, 2, 4).max);
    let words = format!("{} {} %", view.text("亮度", "brightness"), view.brightness);
    fit_text(ui.painter(), figure, Align2::CENTER_CENTER, &words, theme::LABEL, view.theme.text);
    let (least, most) = (*BRIGHTNESS.start(), *BRIGHTNESS.end());
    let darker = view.brightness.saturating_sub(BRIGHTNESS_STEP).max(least);
    let brighter = view.brightness.saturating_add(BRIGHTNESS_STEP).min(most);
    for (index, id, name, wanted) in [(0, "brightness-down", "-", darker), (3, "brightness-up", "+", brighter)] {
        if walk.button(ui, view, cell(row, index, 4), (id, name), ButtonState::default()) && wanted != view.brightness {
            out.push(Command::Page(PageCommand::SetBrightness(wanted)));
        }
    }
}
