//! Painting of program lines in syntax colours; only visible lines are laid out. Where a restart would begin.
//! Source: spec B5, B6, H4, K7.

use egui::accesskit::Role;
use egui::text::{LayoutJob, TextFormat};
use egui::{Color32, Id, Painter, Rect, Response, Ui, pos2, vec2};
use ropey::Rope;

use super::document::content_len;
use crate::defs::text::{LocalizedText, phrase};
use crate::hmi::page::{Scroll, ScrollList, VisibleRows};
use crate::hmi::theme::{self, Theme};
use crate::hmi::{Area, View, swipe, widget};
use crate::link::Snapshot;

/// Height of a line.
pub const LINE_HEIGHT: f32 = 28.0;
/// Width of the line number.
pub const NUMBER_WIDTH: f32 = 76.0;
/// Width kept free right of the cursor.
const CURSOR_MARGIN: f32 = 40.0;
/// Approximate width of a column.
const COLUMN_WIDTH: f32 = 11.0;
/// Maximum number of characters laid out per line.
const MAX_SHOWN_CHARS: usize = 200;

/// Marks of a line.
#[derive(Clone, Copy, Debug, Default)]
pub struct LineMarks {
    /// It is being executed.
    pub running: bool,
    /// It belongs to the marked block.
    pub block: bool,
    /// It has an error.
    pub faulty: bool,
    /// Column of the cursor.
    pub cursor: Option<usize>,
    /// The cursor outside edit mode, moved by touch, arrow keys or search: 从此段 acts on it (B5).
    pub chosen: bool,
    /// Cycle start begins here (B5).
    pub restart: bool,
}

/// The visible part of a line, from column `left` on.
pub fn visible_text(rope: &Rope, line: usize, left: usize) -> String {
    let slice = rope.line(line);
    let length = content_len(slice);
    let from = left.min(length);
    let text: String = slice.slice(from..length.min(from + MAX_SHOWN_CHARS)).into();
    // The font has no glyph for an invalid character.
    text.replace('\t', " ").replace('\u{FFFD}', "?")
}

/// The running block and its neighbours, as many lines as fit.
pub fn running_lines(rect: Rect, view: &View<'_>) {
    let program = &view.snapshot.program;
    let count = ((rect.height() - 8.0) / LINE_HEIGHT).floor().max(0.0) as usize;
    let Some(text) = program.running_text().filter(|_| count >= 2) else { return };
    view.card(rect);
    let head = usize::from(program.in_subprogram());
    if program.in_subprogram() {
        let place = rect.shrink2(vec2(8.0, 4.0)).band(0.0, LINE_HEIGHT);
        view.fit_left(place, &subprogram_name(view), theme::LABEL, view.theme.info);
    }
    let first = (program.line as usize).saturating_sub(1 + count / 3);
    for (index, line) in (first..text.len_lines().min(first + count - head)).enumerate() {
        let corner = pos2(rect.min.x + 2.0, rect.min.y + 4.0 + (index + head) as f32 * LINE_HEIGHT);
        let place = Rect::from_min_size(corner, vec2(rect.width() - 4.0, LINE_HEIGHT));
        let mark = LineMarks { running: line + 1 == program.line as usize, ..LineMarks::default() };
        ListingPosition::default().paint_line(&view.clipped(rect), place, text, line, mark);
    }
}

/// The running subprogram.
pub fn subprogram_name(view: &View<'_>) -> String {
    let name = view.snapshot.title(view.snapshot.program.block_program);
    format!("{} {name}", view.text("子程序", "subprogram"))
}

/// Scroll position of the listing.
#[derive(Clone, Copy, Debug, Default)]
pub struct ListingPosition {
    /// Vertical position, in lines.
    pub scroll: Scroll,
    /// The running line that was followed last, from 1.
    pub followed_line: u32,
    /// Columns left of the first visible one.
    pub first_column: usize,
    /// Sideways drag that is less than a column, points.
    drag_remainder: f32,
}

impl ListingPosition {
    /// Paints a line.
    pub fn paint_line(&self, view: &View<'_>, place: Rect, rope: &Rope, line: usize, mark: LineMarks) {
        if mark.running || mark.block || mark.cursor.is_some() {
            let fill = if mark.block { view.theme.focus.gamma_multiply(0.35) } else { view.theme.raised };
            view.painter.rect_filled(place, theme::RADIUS, fill);
        }
        if mark.chosen {
            view.frame(place, view.theme.focus);
        }
        let bar = [(mark.faulty, view.theme.alarm), (mark.restart, view.theme.hold), (mark.running, view.theme.run)];
        if let Some((_, colour)) = bar.into_iter().find(|(shown, _)| *shown) {
            view.edge_bar(place, colour);
        }
        let (number, words) = place.split_left(NUMBER_WIDTH);
        let ink = if mark.faulty { view.theme.alarm_text } else { view.theme.muted };
        view.fit_right(number.trim_left(6.0).trim_right(theme::PAD), &(line + 1).to_string(), theme::SMALL, ink);
        let text = visible_text(rope, line, self.first_column);
        let mut job = layout_line(&text, theme::TITLE - 1.0, view.theme);
        // A line that is cut ends in …; the one with the cursor scrolls sideways.
        if mark.cursor.is_none() {
            (job.wrap.max_width, job.wrap.max_rows, job.wrap.break_anywhere) = (words.width(), 1, true);
        }
        let galley = view.painter.layout_job(job);
        let top = (words.center().y - galley.size().y / 2.0).round();
        if let Some(column) = mark.cursor {
            let column = column.saturating_sub(self.first_column).min(text.chars().count());
            let at = galley.pos_from_cursor(egui::text::CCursor::new(column)).min.x + words.min.x;
            let caret = Rect::from_min_size(pos2(at - 1.0, place.min.y + 3.0), vec2(2.0, place.height() - 6.0));
            view.painter.rect_filled(caret, 0.0, view.theme.focus);
            view.entry.set(Some(caret));
        }
        let painter = view.painter.with_clip_rect(words.intersect(view.painter.clip_rect()));
        painter.galley(pos2(words.min.x, top), galley, view.theme.text);
    }

    /// Scrolls by finger and mouse wheel; returns the view clipped to the list, the visible lines, and the line and
    /// column that was tapped.
    pub fn handle_input<'v>(
        &mut self,
        view: &View<'v>,
        list: &ScrollList<'_>,
        rope: &Rope,
        number_width: f32,
    ) -> (View<'v>, VisibleRows, Option<(usize, usize)>) {
        let (clipped, rows) = self.scroll.rows(view, list, 0);
        // Above the area that scrolls: a drag area takes the taps of everything below it.
        let tap = clipped.touch_as(Role::TextInput, list.rect, (list.id, "tap"), list.id);
        let first = rows.first().map_or(0, |(first, _)| *first);
        self.drag_sideways(view.ui, list.id, rope, first..first + rows.len());
        let tapped = tap.interact_pointer_pos().filter(|_| tap.clicked()).and_then(|at| {
            let line = (f64::from((at.y - list.rect.min.y) / LINE_HEIGHT) + self.scroll.top).floor().max(0.0) as usize;
            let x = at.x - list.rect.min.x - number_width;
            (line < list.count).then(|| (line, self.column_at(view, rope, line, x)))
        });
        (clipped, rows, tapped)
    }

    /// The column at a horizontal position in a line.
    fn column_at(&self, view: &View<'_>, rope: &Rope, line: usize, x: f32) -> usize {
        let text = visible_text(rope, line, self.first_column);
        let galley = view.painter.layout_job(layout_line(&text, theme::TITLE - 1.0, view.theme));
        self.first_column + galley.cursor_from_pos(vec2(x, galley.size().y / 2.0)).index.0
    }

    /// Scrolls sideways to keep the cursor in `room` points; a hidden cursor comes to the middle.
    pub fn follow_cursor(&mut self, painter: &Painter, rope: &Rope, (line, column): (usize, usize), room: f32) {
        let slice = rope.line(line);
        let column = column.min(content_len(slice));
        let width = |from: usize| match column.saturating_sub(from) {
            0..=MAX_SHOWN_CHARS => {
                let text: String = slice.slice(from.min(column)..column).into();
                painter.layout_no_wrap(text, theme::font(theme::TITLE - 1.0), Color32::PLACEHOLDER).size().x
            }
            _ => f32::INFINITY,
        };
        if width(0) <= room - CURSOR_MARGIN {
            self.first_column = 0;
        } else if column < self.first_column || width(self.first_column) > room - CURSOR_MARGIN {
            let fits = |from: &usize| width(*from) <= room / 2.0;
            self.first_column = (0..column).rev().take_while(fits).last().unwrap_or(column);
        }
    }

    /// Scrolls sideways while a finger drags the list `id`, up to the longest visible line.
    fn drag_sideways(&mut self, ui: &Ui, id: &str, rope: &Rope, lines: std::ops::Range<usize>) {
        let Some(response) = ui.ctx().read_response(Id::unique(id)).filter(Response::dragged) else {
            self.drag_remainder = 0.0;
            return;
        };
        swipe::refuse_over(ui.ctx());
        self.drag_remainder -= widget::drag_delta(&response).x;
        let longest = lines.map(|line| content_len(rope.line(line))).max().unwrap_or(0);
        let columns = (self.drag_remainder / COLUMN_WIDTH).trunc();
        self.drag_remainder -= columns * COLUMN_WIDTH;
        self.first_column = self.first_column.saturating_add_signed(columns as isize).min(longest.saturating_sub(1));
    }
}

/// Height of the two lines that tell of a restart.
const RESTART_HEIGHT: f32 = 52.0;

/// Shows below the listing the block at which cycle start would begin, with its modal state, or the run that a power
/// cut ended (B5); returns the rectangle left for the listing.
pub fn restart_note(rect: Rect, view: &View<'_>) -> Rect {
    let Some(told) = restart_text(view.snapshot) else { return rect };
    let (list, below) = rect.split_bottom(RESTART_HEIGHT + theme::GAP);
    let place = below.trim_top(theme::GAP);
    view.filled_card(place, view.theme.surface, view.theme.hold);
    view.text_rows(place.shrink2(vec2(theme::PAD, 3.0)), &told.get(view.lang), theme::LABEL, view.theme.hold, 2);
    list
}

/// A chosen block comes before an interrupted run: cycle start begins there.
fn restart_text(snapshot: &Snapshot) -> Option<LocalizedText> {
    if let Some(restart) = &snapshot.restart {
        return Some(restart.summary());
    }
    let (program, line) = snapshot.interrupted?;
    let name = snapshot.title(program);
    Some(phrase!(
        "{name} 在第 {line} 行断电中断：回零后按“断电续”，从该段继续",
        "{name} was interrupted at line {line}: home the axes, then RESUME continues from that block",
        name,
        line
    ))
}

/// Kind of a token.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum TokenKind {
    /// Block number, comment, `%`.
    Quiet,
    /// G and M words.
    Code,
    /// Variables, brackets, WHILE and similar words.
    Macro,
    /// Coordinates and all other words.
    Plain,
}

/// Layout of a line, token by token (H4).
fn layout_line(text: &str, size: f32, theme: &Theme) -> LayoutJob {
    let mut job = LayoutJob::default();
    let mut rest = text;
    while !rest.is_empty() {
        let (piece, length) = first_token(rest, job.text.trim_start().is_empty());
        let (head, tail) = rest.split_at(length);
        job.append(head, 0.0, TextFormat::simple(theme::font(size), colour(piece, theme)));
        rest = tail;
    }
    job.wrap.max_rows = 1;
    job
}

const fn colour(piece: TokenKind, theme: &Theme) -> Color32 {
    match piece {
        TokenKind::Quiet => theme.muted,
        TokenKind::Code => theme.info,
        TokenKind::Macro => theme.macros,
        TokenKind::Plain => theme.text,
    }
}

/// Operators that a number may follow without a space.
const OPERATORS: [&str; 10] = ["EQ", "NE", "GT", "GE", "LT", "LE", "AND", "OR", "XOR", "MOD"];

/// Kind of the first token of a text, and its length in bytes.
fn first_token(text: &str, first: bool) -> (TokenKind, usize) {
    let Some(sign) = text.chars().next() else { return (TokenKind::Plain, 0) };
    if text.starts_with("//") || matches!(sign, ';' | '%') {
        return (TokenKind::Quiet, text.len());
    }
    if sign == '(' {
        return (TokenKind::Quiet, text.find(')').map_or(text.len(), |close| close + 1));
    }
    if matches!(sign, '#' | '[' | ']' | '=' | '+' | '*') {
        let digits = text[1..].bytes().take_while(|byte| sign == '#' && byte.is_ascii_digit()).count();
        return (TokenKind::Macro, 1 + digits);
    }
    if !sign.is_ascii_alphabetic() && sign != '_' {
        let letter = |sign: char| sign.is_ascii_alphabetic() || ";%(#[]=+*_".contains(sign);
        let length = text.char_indices().skip(1).find(|(_, sign)| letter(*sign)).map_or(text.len(), |(at, _)| at);
        // A `//` that starts a comment ends the token, too.
        let comment = text[sign.len_utf8()..].find("//").map_or(text.len(), |at| at + sign.len_utf8());
        return (TokenKind::Plain, length.min(comment));
    }
    let word = text.bytes().take_while(|byte| byte.is_ascii_alphanumeric() || *byte == b'_').count();
    if text[word..].starts_with(':') {
        return (TokenKind::Macro, word + 1);
    }
    let letters = text.bytes().take_while(u8::is_ascii_alphabetic).count();
    if letters > 1 {
        // A label is a word with its digits; an operator ends before its number.
        let operator = OPERATORS.iter().any(|known| known.eq_ignore_ascii_case(&text[..letters]));
        return (TokenKind::Macro, if operator { letters } else { word });
    }
    let number = text[1..].bytes().take_while(|byte| byte.is_ascii_digit() || *byte == b'.').count();
    let kind = match sign.to_ascii_uppercase() {
        'G' | 'M' => TokenKind::Code,
        'N' | 'O' if first => TokenKind::Quiet,
        _ => TokenKind::Plain,
    };
    (kind, 1 + number)
}
