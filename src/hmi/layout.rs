//! The regions of the screen: geometry only. Source: spec H1, H2.

use egui::Rect;

use super::{Area, theme};

/// The regions of one display.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Regions {
    /// Kind, page, program, chips, clock.
    pub header: Rect,
    /// The page.
    pub content: Rect,
    /// Alarm, refusal or note.
    pub message: Rect,
    /// Mode, state, feed, speed, count.
    pub status: Rect,
    /// F1 … F5 ▶.
    pub soft: Rect,
    /// The operator panel.
    pub panel: Rect,
    /// Portrait display: the panel is below the page.
    pub portrait: bool,
}

impl Regions {
    /// The regions of a display of this logical size.
    #[must_use]
    pub fn new(display: Rect) -> Self {
        let portrait = display.height() > display.width();
        let panel_width = if display.width() >= theme::WIDE_FROM { theme::PANEL.1 } else { theme::PANEL.0 };
        let (screen, panel) = if portrait {
            let cut = display.max.y - theme::PANEL_PORTRAIT;
            display.split_top_bottom_at_y(cut)
        } else {
            display.split_right(panel_width)
        };
        let (header, rest) = screen.split_top(theme::HEADER);
        let (rest, soft) = rest.split_bottom(theme::SOFT_KEYS);
        let (rest, status) = rest.split_bottom(theme::STATUS);
        let (content, message) = rest.split_bottom(theme::MESSAGE);
        Self { header, content, message, status, soft, panel, portrait }
    }
}
