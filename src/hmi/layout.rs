//! The regions of the screen, and the cutting and dividing of rectangles that the pages share: geometry only.
//! Source: spec H1, H2.

use egui::{Rect, pos2, vec2};

use super::theme;

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
    /// The open page, F1 … F5, ◀ ▶.
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

/// Parts of a rectangle; lengths in points.
pub(crate) trait Area: Copy {
    /// The rectangle itself.
    fn rect(self) -> Rect;

    /// The part above and the part below a cut, `height` below the upper edge.
    fn split_top(self, height: f32) -> (Rect, Rect) {
        self.rect().split_top_bottom_at_y(self.rect().min.y + height)
    }

    /// The part above and the part below a cut, `height` above the lower edge.
    fn split_bottom(self, height: f32) -> (Rect, Rect) {
        self.rect().split_top_bottom_at_y(self.rect().max.y - height)
    }

    /// The parts left and right of a cut, `width` from the left edge.
    fn split_left(self, width: f32) -> (Rect, Rect) {
        self.rect().split_left_right_at_x(self.rect().min.x + width)
    }

    /// The parts left and right of a cut, `width` from the right edge.
    fn split_right(self, width: f32) -> (Rect, Rect) {
        self.rect().split_left_right_at_x(self.rect().max.x - width)
    }

    /// Without a strip at the upper edge.
    fn trim_top(self, by: f32) -> Rect {
        self.rect().with_min_y(self.rect().min.y + by)
    }

    /// Without a strip at the lower edge.
    fn trim_bottom(self, by: f32) -> Rect {
        self.rect().with_max_y(self.rect().max.y - by)
    }

    /// Without a strip at the left edge.
    fn trim_left(self, by: f32) -> Rect {
        self.rect().with_min_x(self.rect().min.x + by)
    }

    /// Without a strip at the right edge.
    fn trim_right(self, by: f32) -> Rect {
        self.rect().with_max_x(self.rect().max.x - by)
    }

    /// Narrower by a margin on the left and on the right.
    fn trim_sides(self, by: f32) -> Rect {
        self.rect().shrink2(vec2(by, 0.0))
    }

    /// A band over the whole width, `top` below the upper edge.
    fn band(self, top: f32, height: f32) -> Rect {
        Rect::from_min_size(self.rect().min + vec2(0.0, top), vec2(self.rect().width(), height))
    }

    /// One of `count` equal cells side by side, with small gaps between them.
    fn cell(self, index: usize, count: usize) -> Rect {
        let width = (self.rect().width() - (count as f32 - 1.0) * theme::GAP) / count as f32;
        let corner = self.rect().min + vec2(index as f32 * (width + theme::GAP), 0.0);
        Rect::from_min_size(corner, vec2(width, self.rect().height()))
    }

    /// The columns of a line, by their shares of the width.
    fn columns<const N: usize>(self, shares: [f32; N]) -> [Rect; N] {
        let (line, whole) = (self.rect(), shares.iter().sum::<f32>());
        let mut left = line.min.x;
        shares.map(|share| {
            let width = line.width() * share / whole;
            let column = Rect::from_min_size(pos2(left, line.min.y), vec2(width - theme::GAP, line.height()));
            left += width;
            column
        })
    }
}

impl Area for Rect {
    fn rect(self) -> Rect {
        self
    }
}
