//! The block at which cycle start would begin, with its modal state, or the run that a power cut ended.
//! Source: spec B5.

use egui::{Rect, vec2};

use crate::defs::text::LocalizedText;
use crate::hmi::{Area, View, theme};
use crate::link::Snapshot;

/// Height of the two lines of text.
const HEIGHT: f32 = 52.0;

/// Shows the restart below the listing; returns the rectangle left for the listing.
pub fn ui(rect: Rect, view: &View<'_>) -> Rect {
    let Some(told) = text(view.snapshot) else { return rect };
    let (list, below) = rect.split_bottom(HEIGHT + theme::GAP);
    let place = below.trim_top(theme::GAP);
    view.filled_card(place, view.theme.surface, view.theme.hold);
    view.text_rows(place.shrink2(vec2(theme::PAD, 3.0)), &told.get(view.lang), theme::LABEL, view.theme.hold, 2);
    list
}

/// A chosen block comes before an interrupted run: cycle start begins there.
fn text(snapshot: &Snapshot) -> Option<LocalizedText> {
    if let Some(restart) = &snapshot.restart {
        return Some(restart.summary());
    }
    let (program, line) = snapshot.interrupted?;
    let name = snapshot.title(program);
    Some(LocalizedText::new(
        format!("{name} 在第 {line} 行断电中断：回零后按“断电续”，从该段继续"),
        format!("{name} was interrupted at line {line}: home the axes, then RESUME continues from that block"),
    ))
}
