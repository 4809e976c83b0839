//! Painting of program lines; only visible lines are laid out.
//! Source: spec B6, K7.

use egui::{Align2, Color32, Id, Painter, Rect, Ui, pos2, vec2};
use ropey::Rope;

use super::document::trimmed;
use super::ink;
use crate::hmi::page::scroll::Scroll;
use crate::hmi::theme;
use crate::hmi::view::{View, card, fit, frame};
use crate::link::snapshot::ProgramView;

/// Height of a line.
pub const LINE: f32 = 28.0;
/// Width of the line number.
pub const NUMBER: f32 = 76.0;
/// Width kept free right of the cursor.
const AHEAD: f32 = 40.0;
/// Approximate width of a column.
const COLUMN: f32 = 11.0;
/// Maximum number of characters laid out per line.
const WIDEST: usize = 200;

/// Marks of a line.
#[derive(Clone, Copy, Debug, Default)]
pub struct Mark {
    /// It is being executed.
    pub running: bool,
    /// It belongs to the marked block.
    pub block: bool,
    /// It has an error.
    pub wrong: bool,
    /// Column of the cursor.
    pub cursor: Option<usize>,
    /// It was selected by touch or search: a restart begins here (B5).
    pub chosen: bool,
}

/// The visible part of a line, from column `left` on.
#[must_use]
pub fn shown(rope: &Rope, line: usize, left: usize) -> String {
    let slice = rope.line(line);
    let length = trimmed(slice);
    let from = left.min(length);
    let text: String = slice.slice(from..length.min(from + WIDEST)).into();
    // The font has no glyph for an invalid character.
    text.replace('\t', " ").replace('\u{FFFD}', "?")
}

/// Paints a line.
pub fn row(painter: &Painter, place: Rect, view: &View<'_>, rope: &Rope, (line, left): (usize, usize), mark: Mark) {
    if mark.running || mark.block || mark.cursor.is_some() {
        let fill = if mark.block { view.theme.focus.gamma_multiply(0.35) } else { view.theme.raised };
        painter.rect_filled(place, theme::RADIUS, fill);
    }
    if mark.chosen {
        frame(painter, place, view.theme.line);
    }
    let bar = Rect::from_min_size(place.min, vec2(4.0, place.height()));
    if mark.wrong {
        painter.rect_filled(bar, 0.0, view.theme.alarm);
    } else if mark.running {
        painter.rect_filled(bar, 0.0, view.theme.run);
    }
    let (number, words) = place.split_left_right_at_x(place.min.x + NUMBER);
    let number = Rect::from_min_max(number.min + vec2(6.0, 0.0), number.max - vec2(theme::PAD, 0.0));
    let ink = if mark.wrong { view.theme.alarm_text } else { view.theme.quiet };
    fit(painter, number, Align2::RIGHT_CENTER, &(line + 1).to_string(), theme::SMALL, ink);
    let text = shown(rope, line, left);
    let galley = painter.layout_job(ink::job(&text, theme::TITLE - 1.0, view.theme));
    let top = (words.center().y - galley.size().y / 2.0).round();
    if let Some(column) = mark.cursor {
        let column = column.saturating_sub(left).min(text.chars().count());
        let at = galley.pos_from_cursor(egui::text::CCursor::new(column)).min.x + words.min.x;
        let caret = Rect::from_min_size(pos2(at - 1.0, place.min.y + 3.0), vec2(2.0, place.height() - 6.0));
        painter.rect_filled(caret, 0.0, view.theme.focus);
    }
    painter.with_clip_rect(words.intersect(painter.clip_rect())).galley(
        pos2(words.min.x, top),
        galley,
        view.theme.text,
    );
}

/// The column at a horizontal position in a line.
#[must_use]
pub fn column_at(painter: &Painter, view: &View<'_>, rope: &Rope, (line, left): (usize, usize), x: f32) -> usize {
    let galley = painter.layout_job(ink::job(&shown(rope, line, left), theme::TITLE - 1.0, view.theme));
    left + galley.cursor_from_pos(vec2(x, galley.size().y / 2.0)).index.0
}

/// The running block and its neighbours, as many lines as fit.
pub fn strip(ui: &Ui, rect: Rect, view: &View<'_>) {
    let program = &view.snapshot.program;
    let count = ((rect.height() - 8.0) / LINE).floor().max(0.0) as usize;
    if count < 2 || program.number == 0 || in_subprogram(program) {
        return;
    }
    card(ui.painter(), rect, view.theme.surface, view.theme.line);
    let first = (program.line as usize).saturating_sub(1 + count / 3);
    for (index, line) in (first..program.text.len_lines().min(first + count)).enumerate() {
        let corner = pos2(rect.min.x + 2.0, rect.min.y + 4.0 + index as f32 * LINE);
        let place = Rect::from_min_size(corner, vec2(rect.width() - 4.0, LINE));
        let mark = Mark { running: line + 1 == program.line as usize, ..Mark::default() };
        row(&ui.painter().with_clip_rect(rect), place, view, &program.text, (line, 0), mark);
    }
}

/// Whether a subprogram is being executed; its lines are not shown.
#[must_use]
pub const fn in_subprogram(program: &ProgramView) -> bool {
    program.block_program != 0 && program.block_program != program.number
}

/// Scroll position of the listing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Place {
    /// Vertical position, in lines.
    pub scroll: Scroll,
    /// The running line that was followed last, from 1.
    pub line: u32,
    /// Columns left of the first visible one.
    pub left: usize,
    /// Sideways drag that is less than a column, points.
    rest: f32,
}

impl Place {
    /// Scrolls sideways to keep the cursor in `room` points; a hidden cursor comes to the middle.
    pub fn follow_cursor(&mut self, painter: &Painter, rope: &Rope, (line, column): (usize, usize), room: f32) {
        let slice = rope.line(line);
        let column = column.min(trimmed(slice));
        let width = |from: usize| match column.saturating_sub(from) {
            0..=WIDEST => {
                let text: String = slice.slice(from.min(column)..column).into();
                painter.layout_no_wrap(text, theme::font(theme::TITLE - 1.0), Color32::PLACEHOLDER).size().x
            }
            _ => f32::INFINITY,
        };
        if width(0) <= room - AHEAD {
            self.left = 0;
        } else if column < self.left || width(self.left) > room - AHEAD {
            let fits = |from: &usize| width(*from) <= room / 2.0;
            self.left = (0..column).rev().take_while(fits).last().unwrap_or(column);
        }
    }

    /// Scrolls sideways while a finger drags the list `id`, up to the longest visible line.
    pub fn drag(&mut self, ui: &Ui, id: &str, rope: &Rope, lines: std::ops::Range<usize>) {
        if !ui.ctx().is_being_dragged(Id::unique(id)) {
            self.rest = 0.0;
            return;
        }
        self.rest -= ui.input(|input| input.pointer.delta().x);
        let longest = lines.map(|line| trimmed(rope.line(line))).max().unwrap_or(0);
        let columns = (self.rest / COLUMN).trunc();
        self.rest -= columns * COLUMN;
        self.left = self.left.saturating_add_signed(columns as isize).min(longest.saturating_sub(1));
    }
}
