//! The strip beside the page on a wide display, below it on a tall one: what an operator keeps an eye on whatever page
//! is open: positions, process values, the running blocks. Source: spec H1 (the extra width goes to the screen).

use egui::{Rect, vec2};

use super::page::position::{self, PositionGroup};
use super::page::program::listing;
use super::{Area, View, scene, theme};
use crate::defs::page::Page;

/// Size of the page from which there is room for the strip, and size of the strip; points.
const WIDE: f32 = 1_000.0;
const WIDTH: f32 = 264.0;
const TALL: f32 = 720.0;
const HEIGHT: f32 = 224.0;
/// Height of a program line, width of its number.
const LINE: f32 = 26.0;
const NUMBER: f32 = 42.0;
/// Height of the positions in the strip beside the page: two groups of three axes, and seven process values.
const POSITIONS: f32 = 520.0;

/// Height of the live scene above the running blocks, as a share.
const SCENE_SHARE: f32 = 0.5;

/// Divides the room of the screen into the page and the strip. Pages that use all room themselves have none.
#[must_use]
pub fn split(content: Rect, page: Page) -> (Rect, Option<Rect>) {
    let uses_all = matches!(page, Page::Position | Page::Panel | Page::Graphic | Page::Designer | Page::Simulator);
    if !uses_all && content.width() >= WIDE {
        let (page, strip) = content.split_right(WIDTH);
        return (page, Some(strip.trim_right(theme::GAP).shrink2(vec2(0.0, theme::GAP))));
    }
    if !uses_all && content.height() >= TALL {
        let (page, strip) = content.split_bottom(HEIGHT);
        return (page, Some(strip.trim_sides(theme::GAP).trim_bottom(theme::GAP)));
    }
    (content, None)
}

/// Draws the strip. What the page shows itself is left out.
pub fn ui(view: &View<'_>, rect: Rect) {
    let page = view.snapshot.page;
    if matches!(page, Page::Grinding | Page::Dressing) {
        let shows_scene = view.snapshot.kind.ui().wheel_pose.is_some() && rect.height() > rect.width();
        let (above, lines) = rect.split_top(if shows_scene { SCENE_SHARE * rect.height() } else { 0.0 });
        if shows_scene {
            view.card(above);
            scene::paint_follow(above.shrink(theme::FRAME), view);
        }
        return running_lines(if shows_scene { lines.trim_top(theme::GAP) } else { lines }, view);
    }
    let has_lines = matches!(page, Page::Program | Page::Mdi);
    let (positions, lines) = match rect.height() > rect.width() {
        true if has_lines => (rect, Rect::NOTHING),
        true => {
            let (positions, lines) = rect.split_top(POSITIONS.min(0.7 * rect.height()));
            (positions, lines.trim_top(theme::GAP))
        }
        false => {
            let (positions, lines) = rect.split_left(WIDTH);
            (positions, lines.trim_left(theme::GAP))
        }
    };
    let groups: [PositionGroup<'_>; 2] = [
        (view.text("[绝对坐标]", "[absolute]"), &|_, state| Some(state.work)),
        (view.text("[移动余量]", "[to go]"), &|_, state| Some(state.to_go)),
    ];
    let shown = if rect.height() > rect.width() { groups.len() } else { 1 };
    let rest = position::column(positions, view, &groups[..shown]);
    position::process_values(rest.trim_top(theme::GAP), view);
    if !has_lines {
        running_lines(lines, view);
    }
}

/// The running block and its neighbours, as many as fit; each one cut to the width. In a subprogram its name stands above.
fn running_lines(rect: Rect, view: &View<'_>) {
    let program = &view.snapshot.program;
    let Some(text) = program.running_text() else { return };
    view.card(rect);
    let mut inside = rect.shrink(theme::GAP);
    if program.in_subprogram() {
        let head;
        (head, inside) = inside.split_top(LINE);
        view.fit_left(head, &listing::subprogram_name(view), theme::LABEL, view.theme.info);
    }
    let count = (inside.height() / LINE).floor().max(0.0) as usize;
    let first = (program.line as usize).saturating_sub(1 + count / 3);
    for (index, line) in (first..text.len_lines().min(first + count)).enumerate() {
        let place = inside.band(index as f32 * LINE, LINE);
        let running = line + 1 == program.line as usize;
        if running {
            view.painter.rect_filled(place, theme::RADIUS, view.theme.raised);
            view.edge_bar(place, view.theme.run);
        }
        let (number, words) = place.split_left(NUMBER);
        view.fit_right(number.trim_right(theme::GAP), &(line + 1).to_string(), theme::SMALL, view.theme.muted);
        let ink = if running { view.theme.text } else { view.theme.muted };
        view.line_left(words, &listing::visible_text(text, line, 0), theme::LABEL, ink);
    }
}
