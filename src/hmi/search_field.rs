//! The search field of pages with a search: text, and a cross that clears it.
//! Source: spec B6 (search), H6.

use egui::accesskit::Role;
use egui::{Align2, Id, Rect, Sense, Ui, WidgetInfo, vec2};

use super::keycap::{self, KeycapState};
use super::theme;
use super::view::{View, fit_text, focus_frame};
use super::widget::{self, ButtonState};

/// Between the field and its cross.
const SPACE: f32 = 4.0;

/// What was touched in the search field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SearchTouch {
    /// The field.
    Field,
    /// The cross that clears it.
    Clear,
}

/// What the field shows.
#[derive(Clone, Copy, Debug)]
pub struct SearchField<'a> {
    /// Shown while the field is empty.
    pub hint: &'a str,
    /// The typed text.
    pub text: &'a str,
    /// It takes the typed text now.
    pub open: bool,
}

/// Draws the field.
pub fn field(ui: &Ui, view: &View<'_>, rect: Rect, shown: SearchField<'_>) -> Option<SearchTouch> {
    let SearchField { hint, text: search, open } = shown;
    let (rect, cross) = if search.is_empty() {
        (rect, None)
    } else {
        let (field, cross) = rect.split_left_right_at_x(rect.max.x - theme::TOUCH_TARGET - SPACE);
        (field, Some(Rect::from_min_max(cross.min + vec2(SPACE, 0.0), cross.max)))
    };
    if let Some(cross) = cross
        && widget::button(ui, view, cross, "search-clear", "×", ButtonState::default())
    {
        return Some(SearchTouch::Clear);
    }
    let response = ui.interact(rect, Id::unique("search"), Sense::CLICK);
    response
        .widget_info(|| WidgetInfo::labeled(Role::SearchInput, true, format!("{} search", view.text("查找", "find"))));
    let painter = ui.painter();
    let face = KeycapState { pressed: response.is_pointer_button_down_on(), ..KeycapState::default() };
    keycap::paint_body(painter, view.theme, rect, face);
    if open {
        focus_frame(painter, rect, view.theme.focus);
    }
    let inside = rect.shrink2(vec2(theme::PAD, 0.0));
    match (search, open) {
        ("", false) => {
            fit_text(painter, inside, Align2::LEFT_CENTER, hint, theme::LABEL, view.theme.muted);
        }
        (search, open) => {
            let words = if open { format!("{search}_") } else { search.to_owned() };
            fit_text(painter, inside, Align2::LEFT_CENTER, &words, theme::TITLE, view.theme.info);
        }
    }
    response.clicked().then_some(SearchTouch::Field)
}
