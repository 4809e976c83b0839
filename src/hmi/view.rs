//! The context that a page draws from, and the drawing functions for text and lines.

use std::sync::Arc;

use egui::text::LayoutJob;
use egui::{Align2, Color32, CornerRadius, Galley, Painter, Pos2, Rect, Stroke, StrokeKind};

use super::theme::{self, Theme};
use crate::defs::date::DateTime;
use crate::defs::text::{Lang, Text};
use crate::link::Snapshot;
use crate::units::Micros;

/// How far the font draws its glyphs below the middle of the line, as a share of the line height.
const FONT_SAG: f32 = 0.045;

/// Everything that a page can read. A page changes only its own cursor and edit text.
#[derive(Clone, Copy)]
pub struct View<'a> {
    /// The newest state of the machine.
    pub snapshot: &'a Snapshot,
    /// Language.
    pub lang: Lang,
    /// Colours.
    pub theme: &'a Theme,
    /// The light theme is active.
    pub light: bool,
    /// Brightness of the picture, percent.
    pub brightness: u8,
    /// Time of day as shown.
    pub clock: &'a str,
    /// The lit half of the 1 Hz blink.
    pub blink: bool,
}

impl View<'_> {
    /// A text in the language of the screen.
    #[must_use]
    pub const fn text(&self, zh: &'static str, en: &'static str) -> &'static str {
        Text::new(zh, en).get(self.lang)
    }
}

impl View<'_> {
    /// Value of a macro variable as executed; a null variable is a dash.
    #[must_use]
    pub fn variable(&self, variable: u16) -> String {
        let value = self.snapshot.variables.get(usize::from(variable)).copied().flatten();
        value.map_or_else(|| "—".to_owned(), format_length)
    }

    /// Time of day at a controller time, with the date if it is not today; without a clock, the time since power-on.
    #[must_use]
    pub fn time(&self, at: Micros) -> String {
        let seconds = |time: Micros| (time.0 / 1_000_000) as i64;
        let since = seconds(self.snapshot.now) - seconds(at);
        let Some(today) = self.snapshot.date else { return DateTime(seconds(at)).time() };
        let then = DateTime(today.0 - since);
        if then.parts()[..3] == today.parts()[..3] { then.time() } else { then.to_string()["2026-".len()..].to_owned() }
    }
}

/// The clock in the header: time of day, or the time since power-on if it is unknown.
#[must_use]
pub fn clock_time(snapshot: &Snapshot) -> String {
    snapshot.date.unwrap_or(DateTime((snapshot.now.0 / 1_000_000) as i64)).time()
}

/// The lit half of the 1 Hz blink. It follows controller time, so the same snapshot gives the same picture.
#[must_use]
pub const fn blink_phase(now: Micros) -> bool {
    (now.0 / 500_000).is_multiple_of(2)
}

/// Date and time of a history entry; without a clock, the time since power-on.
#[must_use]
pub fn format_date_time(date: DateTime) -> String {
    if date.parts()[0] > 1_970 { date.to_string() } else { format!("+{}", date.time()) }
}

/// Lays out one line of text, truncated with … at a width.
#[must_use]
pub fn layout_line(painter: &Painter, text: &str, size: f32, colour: Color32, width: f32) -> Arc<Galley> {
    let mut job = LayoutJob::simple_singleline(text.to_owned(), theme::font(size), colour);
    job.wrap.max_width = width.max(1.0);
    job.wrap.max_rows = 1;
    job.wrap.break_anywhere = true;
    painter.layout_job(job)
}

/// Paints one line of text in a rectangle, truncated with … if it is too long.
pub fn text_line(painter: &Painter, rect: Rect, align: Align2, text: &str, size: f32, colour: Color32) -> Rect {
    let galley = layout_line(painter, text, size, colour, rect.width());
    paint_galley(painter, rect, align, galley, colour)
}

/// Paints one line of text in a rectangle; shrinks the font to 13 points before truncating.
pub fn fit_text(painter: &Painter, rect: Rect, align: Align2, text: &str, size: f32, colour: Color32) -> Rect {
    let mut size = size;
    let mut galley = layout_line(painter, text, size, colour, rect.width());
    while galley.elided && size > theme::SMALL {
        size = (size - 1.0).max(theme::SMALL);
        galley = layout_line(painter, text, size, colour, rect.width());
    }
    paint_galley(painter, rect, align, galley, colour)
}

/// Paints wrapped text from the top left corner of a rectangle; returns the area it covers.
pub fn paragraph(painter: &Painter, rect: Rect, text: &str, size: f32, colour: Color32) -> Rect {
    let mut job = LayoutJob::simple(text.to_owned(), theme::font(size), colour, rect.width());
    job.wrap.max_rows = (rect.height() / (size * 1.4)).floor().max(1.0) as usize;
    let galley = painter.layout_job(job);
    paint_galley(painter, rect, Align2::LEFT_TOP, galley, colour)
}

/// Paints wrapped text of at most `most` lines, vertically centred in a rectangle.
pub fn text_rows(painter: &Painter, rect: Rect, text: &str, size: f32, colour: Color32, most: usize) -> Rect {
    let mut job = LayoutJob::simple(text.to_owned(), theme::font(size), colour, rect.width());
    job.wrap.max_rows = most;
    paint_galley(painter, rect, Align2::LEFT_CENTER, painter.layout_job(job), colour)
}

/// Paints wrapped text from the top of a rectangle, each line horizontally centred.
pub fn centred_text(painter: &Painter, rect: Rect, text: &str, size: f32, colour: Color32) {
    let mut job = LayoutJob::simple(text.to_owned(), theme::font(size), colour, rect.width());
    job.halign = egui::Align::Center;
    painter.galley(Pos2::new(rect.center().x.round(), rect.min.y.round()), painter.layout_job(job), colour);
}

fn paint_galley(painter: &Painter, rect: Rect, align: Align2, galley: Arc<Galley>, colour: Color32) -> Rect {
    let at = align.align_size_within_rect(galley.size(), rect);
    // Rounded to whole points: nothing shifts by a pixel when a digit changes (H5).
    // The font has more space below its glyphs than above: centred text is moved up by the difference.
    let up = if align.y() == egui::Align::Center { galley.size().y * FONT_SAG } else { 0.0 };
    let corner = Pos2::new(at.min.x.round(), (at.min.y - up).round());
    let taken = Rect::from_min_size(corner, galley.size());
    painter.galley(corner, galley, colour);
    taken
}

/// Paints a filled area with a hairline around it.
pub fn card(painter: &Painter, rect: Rect, fill: Color32, line: Color32) {
    let radius = CornerRadius::same(theme::RADIUS as u8);
    painter.rect(rect, radius, fill, Stroke::new(theme::HAIRLINE, line), StrokeKind::Inside);
}

/// Paints a frame around a selected field.
pub fn focus_frame(painter: &Painter, rect: Rect, colour: Color32) {
    let radius = CornerRadius::same(theme::RADIUS as u8);
    painter.rect_stroke(rect, radius, Stroke::new(theme::FRAME, colour), StrokeKind::Inside);
}

/// Paints a chip: a small filled label as wide as its text; `right` is its right edge.
pub fn chip(painter: &Painter, right: f32, row: Rect, text: &str, fill: Color32, ink: Color32) -> Rect {
    let galley = layout_line(painter, text, theme::LABEL, ink, row.width());
    let width = galley.size().x + 2.0 * theme::PAD - 4.0;
    let rect = Rect::from_min_max(Pos2::new((right - width).round(), row.min.y), Pos2::new(right, row.max.y));
    painter.rect_filled(rect, CornerRadius::same(theme::RADIUS as u8), fill);
    paint_galley(painter, rect, Align2::CENTER_CENTER, galley, ink);
    rect
}

/// A rectangle from its top left corner and its size.
#[must_use]
pub fn rect_at(x: f32, y: f32, width: f32, height: f32) -> Rect {
    Rect::from_min_size(Pos2::new(x, y), egui::vec2(width, height))
}

/// Formats the size of a file.
#[must_use]
pub fn format_size(bytes: u64) -> String {
    match bytes {
        0..1_024 => format!("{bytes} B"),
        1_024..1_048_576 => format!("{:.1} kB", bytes as f64 / 1_024.0),
        1_048_576..1_073_741_824 => format!("{:.1} MB", bytes as f64 / 1_048_576.0),
        _ => format!("{:.1} GB", bytes as f64 / 1_073_741_824.0),
    }
}

/// Formats a feed or a speed as a whole number.
#[must_use]
pub fn format_whole(value: f64) -> String {
    format!("{value:.0}")
}

/// Formats strokes per minute; a dash without a measurement.
#[must_use]
pub fn format_strokes(strokes_per_min: Option<f64>) -> String {
    strokes_per_min.map_or_else(|| "–".to_owned(), |strokes| format!("{strokes:.1}"))
}

/// Formats a cycle time, s, as minutes and seconds.
#[must_use]
pub fn format_cycle_time(seconds: f64) -> String {
    let minutes = (seconds / 60.0).floor();
    format!("{minutes:02.0}:{:02.0}", (seconds - minutes * 60.0).floor())
}

/// Formats a voltage.
#[must_use]
pub fn format_volts(volts: f64) -> String {
    format!("{volts:.2} V")
}

/// Formats a length with three decimals; NaN and infinity become a dash.
#[must_use]
pub fn format_length(value: f64) -> String {
    if !value.is_finite() {
        return "—".to_owned();
    }
    // -0.0004 is shown as 0.000, never as -0.000.
    let text = format!("{value:.3}");
    if text == "-0.000" { "0.000".to_owned() } else { text }
}
