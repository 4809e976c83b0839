//! The context that a page draws from, and the drawing functions for text and lines.

use std::cell::{Cell, RefCell};
use std::fmt::Debug;
use std::hash::Hash;
use std::sync::Arc;

use egui::accesskit::Role;
use egui::text::LayoutJob;
use egui::{
    Align2, Color32, Galley, Id, Painter, Pos2, Rect, Response, Sense, Stroke, StrokeKind, Ui, Vec2, WidgetInfo, vec2,
};

use super::Area;
use super::key_press::release_position;
use super::theme::{self, Theme};
use crate::defs::date::DateTime;
use crate::defs::favourite::Favourite;
use crate::defs::page_text::PageTextRow;
use crate::defs::text::{Lang, LocalizedText, Text, phrase};
use crate::defs::variable_name;
use crate::link::Snapshot;
use crate::units::{Axis, Micros};

/// How far the font draws its glyphs below the middle of the line, as a share of the line height.
const FONT_SAG: f32 = 0.045;

/// Everything that a page can read, and where it draws. A page changes only its own cursor and edit text.
#[derive(Clone)]
pub struct View<'a> {
    /// Input and layout of the frame.
    pub ui: &'a Ui,
    /// Painter of the frame, clipped to the part that is drawn.
    pub painter: Painter,
    /// The newest state of the machine.
    pub snapshot: &'a Snapshot,
    /// Language.
    pub lang: Lang,
    /// The languages to choose from.
    pub languages: &'a [Lang],
    /// Something is wrong with a language file.
    pub has_language_faults: bool,
    /// Colours.
    pub theme: &'a Theme,
    /// The light theme is active.
    pub light: bool,
    /// Brightness of the picture, percent.
    pub brightness: u8,
    /// Size of the screen, percent.
    pub zoom: u16,
    /// What the home page keeps.
    pub favourites: &'a [Favourite],
    /// Time of day as shown.
    pub clock: &'a str,
    /// The lit half of the 1 Hz blink.
    pub blink: bool,
    /// The framed field, as far as the frame is drawn: the numeric pad stays beside it, a zoomed screen shows it.
    pub entry: &'a Cell<Option<Rect>>,
    /// What is typed and for what, with its range or why it was refused: where the input line is out of view, the message
    /// line shows it.
    pub prompt: &'a RefCell<String>,
}

impl View<'_> {
    /// A text in the language of the screen.
    #[must_use]
    pub fn text(&self, zh: &'static str, en: &'static str) -> &'static str {
        Text::new(zh, en).get(self.lang)
    }

    /// A phrase in the language of the screen.
    #[must_use]
    pub fn phrase(&self, phrase: &LocalizedText) -> String {
        phrase.get(self.lang).into_owned()
    }

    /// The axes of the machine.
    pub fn axes(&self) -> impl Iterator<Item = Axis> + use<'_> {
        Axis::ALL.into_iter().filter(|axis| self.snapshot.axes[*axis].present)
    }

    /// Value of a macro variable as executed; a null variable is a dash.
    #[must_use]
    pub fn variable(&self, variable: u16) -> String {
        let value = self.snapshot.variables.get(usize::from(variable)).copied().flatten();
        let decimals =
            if variable_name::is_switch(u32::from(variable)) { 0 } else { self.snapshot.params.length_decimals() };
        value.map_or_else(|| "—".to_owned(), |value| format_value(value, decimals))
    }

    /// Value of a row of a page text: without decimals if its label says that it is a count, a switch or a mode.
    #[must_use]
    pub fn page_value(&self, row: &PageTextRow) -> String {
        let whole = self.snapshot.variables.get(usize::from(row.variable)).copied().flatten();
        match whole.filter(|value| row.is_whole_number() && value.fract() == 0.0) {
            Some(value) => format_whole(value),
            None => self.variable(row.variable),
        }
    }

    /// A length in the display resolution (P22.2).
    #[must_use]
    pub fn length(&self, value: f64) -> String {
        format_length(value, self.snapshot.params.length_decimals())
    }

    /// Name of a macro variable on this kind of machine.
    #[must_use]
    pub fn variable_name(&self, variable: u16) -> String {
        variable_name::variable_name_on(u32::from(variable), self.snapshot.kind)
    }

    /// The range of a value and its old value, for the input line.
    #[must_use]
    pub fn range_and_old(&self, range: &str, old: &str) -> String {
        format!("{} {range} · {} {old}", self.text("范围", "range"), self.text("原值", "was"))
    }

    /// Unit of the positions; X may be a diameter.
    #[must_use]
    pub fn position_unit(&self) -> &'static str {
        if self.snapshot.x_as_diameter { self.text("mm · X 直径", "mm · X diameter") } else { "mm" }
    }

    /// Program and line in the language of the screen: `O1001 第7行`.
    #[must_use]
    pub fn program_line(&self, place: Option<(u32, u32)>) -> Option<String> {
        let (program, line) = place.map(|(program, line)| (self.snapshot.title(program), line))?;
        Some(self.phrase(&phrase!("{program} 第{line}行", "{program} line {line}", program, line)))
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

impl View<'_> {
    /// The same view with its painting and its touches clipped to a rectangle, for the rows of a list.
    #[must_use]
    pub fn clipped(&self, rect: Rect) -> Self {
        Self { painter: self.painter.with_clip_rect(rect), ..self.clone() }
    }

    /// A place that is touched, as a key: only the part inside the clip rectangle counts. `name` is its accessible name.
    pub fn touch(&self, rect: Rect, id: impl Hash + Debug, name: impl ToString) -> Response {
        self.touch_as(Role::Button, rect, id, name)
    }

    /// A place that is touched, in a role for screen readers.
    pub fn touch_as(&self, role: Role, rect: Rect, id: impl Hash + Debug, name: impl ToString) -> Response {
        let response = self.ui.interact(rect.intersect(self.painter.clip_rect()), Id::unique(id), Sense::CLICK);
        response.widget_info(|| WidgetInfo::labeled(role, true, name.to_string()));
        response
    }

    /// A row of a list that is touched, and whether it is the selected one.
    pub fn touch_row(&self, rect: Rect, id: impl Hash + Debug, chosen: bool, name: impl ToString) -> Response {
        let response = self.ui.interact(rect.intersect(self.painter.clip_rect()), Id::unique(id), Sense::CLICK);
        response.widget_info(|| WidgetInfo::selected(Role::Button, true, chosen, name.to_string()));
        response
    }

    /// Where the finger is, or where it was lifted in this frame; none of a finger that was lost.
    #[must_use]
    pub fn finger(&self) -> Option<Pos2> {
        let place = self.ui.input(|input| release_position(input).or(input.pointer.interact_pos()));
        place.filter(|place| self.ui.clip_rect().contains(*place))
    }

    /// The factor of a zoom in this frame: two fingers, or the mouse wheel.
    #[must_use]
    pub fn zoom_factor(&self) -> f32 {
        self.ui.input(|input| {
            let pinch = input.multi_touch().map_or_else(|| input.zoom_delta(), |touch| touch.zoom_delta);
            pinch * (input.smooth_scroll_delta().y / 240.0).exp()
        })
    }

    /// Lays out one line of text, truncated with … at a width.
    #[must_use]
    pub fn layout_line(&self, text: &str, size: f32, colour: Color32, width: f32) -> Arc<Galley> {
        let mut job = LayoutJob::simple_singleline(text.to_owned(), theme::font(size), colour);
        job.wrap.max_width = width.max(1.0);
        job.wrap.max_rows = 1;
        job.wrap.break_anywhere = true;
        self.painter.layout_job(job)
    }

    /// Paints one line of text in a rectangle, truncated with … if it is too long.
    pub fn line(&self, rect: Rect, align: Align2, text: &str, size: f32, colour: Color32) -> Rect {
        paint_galley(&self.painter, rect, align, self.layout_line(text, size, colour, rect.width()), colour)
    }

    /// Paints one line of text at the left of a rectangle, truncated with … if it is too long.
    pub fn line_left(&self, rect: Rect, text: &str, size: f32, colour: Color32) -> Rect {
        self.line(rect, Align2::LEFT_CENTER, text, size, colour)
    }

    /// Paints one line of text at the right of a rectangle, truncated with … if it is too long.
    pub fn line_right(&self, rect: Rect, text: &str, size: f32, colour: Color32) -> Rect {
        self.line(rect, Align2::RIGHT_CENTER, text, size, colour)
    }

    /// Paints one line of text in the middle of a rectangle, truncated with … if it is too long.
    pub fn line_centre(&self, rect: Rect, text: &str, size: f32, colour: Color32) -> Rect {
        self.line(rect, Align2::CENTER_CENTER, text, size, colour)
    }

    /// Paints one line of text in a rectangle; shrinks the font to 13 points before truncating.
    pub fn fit(&self, rect: Rect, align: Align2, text: &str, size: f32, colour: Color32) -> Rect {
        let mut size = size;
        let mut galley = self.layout_line(text, size, colour, rect.width());
        while galley.elided && size > theme::SMALL {
            size = (size - 1.0).max(theme::SMALL);
            galley = self.layout_line(text, size, colour, rect.width());
        }
        paint_galley(&self.painter, rect, align, galley, colour)
    }

    /// Paints one line of text at the left of a rectangle; shrinks the font before truncating.
    pub fn fit_left(&self, rect: Rect, text: &str, size: f32, colour: Color32) -> Rect {
        self.fit(rect, Align2::LEFT_CENTER, text, size, colour)
    }

    /// Paints one line of text at the right of a rectangle; shrinks the font before truncating.
    pub fn fit_right(&self, rect: Rect, text: &str, size: f32, colour: Color32) -> Rect {
        self.fit(rect, Align2::RIGHT_CENTER, text, size, colour)
    }

    /// Paints one line of text in the middle of a rectangle; shrinks the font before truncating.
    pub fn fit_centre(&self, rect: Rect, text: &str, size: f32, colour: Color32) -> Rect {
        self.fit(rect, Align2::CENTER_CENTER, text, size, colour)
    }

    /// Paints wrapped text from the top left corner of a rectangle; returns the area it covers.
    pub fn paragraph(&self, rect: Rect, text: &str, size: f32, colour: Color32) -> Rect {
        paragraph(&self.painter, rect, text, size, colour)
    }

    /// Paints a quiet paragraph: a hint, or what a list is empty of.
    pub fn note(&self, rect: Rect, text: &str) {
        self.paragraph(rect, text, theme::LABEL, self.theme.muted);
    }

    /// Paints wrapped text of at most `most` lines, vertically centred in a rectangle.
    pub fn text_rows(&self, rect: Rect, text: &str, size: f32, colour: Color32, most: usize) -> Rect {
        let mut job = LayoutJob::simple(text.to_owned(), theme::font(size), colour, rect.width());
        job.wrap.max_rows = most;
        paint_galley(&self.painter, rect, Align2::LEFT_CENTER, self.painter.layout_job(job), colour)
    }

    /// Paints wrapped text from the top of a rectangle, each line horizontally centred.
    pub fn centred_text(&self, rect: Rect, text: &str, size: f32, colour: Color32) {
        let mut job = LayoutJob::simple(text.to_owned(), theme::font(size), colour, rect.width());
        job.halign = egui::Align::Center;
        let corner = Pos2::new(rect.center().x.round(), rect.min.y.round());
        self.painter.galley(corner, self.painter.layout_job(job), colour);
    }

    /// Paints a chip: a small filled label as wide as its text; `right` is its right edge.
    pub fn chip(&self, right: f32, row: Rect, text: &str, fill: Color32, ink: Color32) -> Rect {
        let galley = self.layout_line(text, theme::LABEL, ink, row.width());
        let width = galley.size().x + 2.0 * theme::PAD - 4.0;
        let rect = Rect::from_min_max(Pos2::new((right - width).round(), row.min.y), Pos2::new(right, row.max.y));
        self.painter.rect_filled(rect, theme::RADIUS, fill);
        paint_galley(&self.painter, rect, Align2::CENTER_CENTER, galley, ink);
        rect
    }

    /// Paints a card of the page: surface with a hairline around it.
    pub fn card(&self, rect: Rect) {
        self.filled_card(rect, self.theme.surface, self.theme.line);
    }

    /// Paints the card of a row of a list, framed if it is the selected one.
    pub fn row_card(&self, rect: Rect, chosen: bool) {
        self.filled_card(rect, if chosen { self.theme.raised } else { self.theme.surface }, self.theme.line);
        if chosen {
            self.frame(rect, self.theme.focus);
        }
    }

    /// Paints a filled area with a hairline around it.
    pub fn filled_card(&self, rect: Rect, fill: Color32, line: Color32) {
        self.painter.rect(rect, theme::RADIUS, fill, Stroke::new(theme::HAIRLINE, line), StrokeKind::Inside);
    }

    /// Darkens a page under a dialog. It takes no touches while the dialog is open.
    pub fn veil(&self, page: Rect, name: &str) {
        self.ui.interact(page, Id::unique(name), Sense::CLICK | Sense::DRAG);
        self.painter.rect_filled(page, 0.0, self.theme.background.gamma_multiply(0.86));
    }

    /// Draws the card of a dialog over a page. The page beneath takes no touches while the dialog is open.
    pub fn dialog(&self, page: Rect, name: &str, size: Vec2, line: Color32) -> Rect {
        self.veil(page, name);
        let room = page.intersect(self.ui.clip_rect());
        let most = room.size() - vec2(24.0, 12.0);
        // A narrower card is higher: its text has the same room.
        let narrower = (size.x / most.x).max(1.0);
        let card = Rect::from_center_size(room.center(), vec2(size.x, size.y * narrower).min(most));
        self.filled_card(card, self.theme.surface, line);
        card
    }

    /// Paints a frame around a selected field.
    pub fn frame(&self, rect: Rect, colour: Color32) {
        self.entry.set(Some(rect));
        self.outline(rect, colour);
    }

    /// Paints the same frame around something that is not the chosen field.
    pub fn outline(&self, rect: Rect, colour: Color32) {
        self.painter.rect_stroke(rect, theme::RADIUS, Stroke::new(theme::FRAME, colour), StrokeKind::Inside);
    }

    /// Paints a hairline over the width of a rectangle.
    pub fn hairline(&self, rect: Rect, y: f32) {
        self.painter.hline(rect.x_range(), y, Stroke::new(theme::HAIRLINE, self.theme.line));
    }

    /// Paints the bar along the left edge of a row that stands out.
    pub fn edge_bar(&self, rect: Rect, colour: Color32) {
        self.painter.rect_filled(rect.split_left(4.0).0, 0.0, colour);
    }
}

/// Paints wrapped text from the top left corner of a rectangle; returns the area it covers.
pub fn paragraph(painter: &Painter, rect: Rect, text: &str, size: f32, colour: Color32) -> Rect {
    let mut job = LayoutJob::simple(text.to_owned(), theme::font(size), colour, rect.width());
    job.wrap.max_rows = (rect.height() / (size * 1.4)).floor().max(1.0) as usize;
    paint_galley(painter, rect, Align2::LEFT_TOP, painter.layout_job(job), colour)
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

/// Formats a speed as a whole number.
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

/// Formats a length with these decimals; NaN and infinity become a dash.
#[must_use]
pub fn format_length(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return "—".to_owned();
    }
    // -0.0004 is shown as 0.000, never as -0.000.
    let text = format!("{value:.decimals$}");
    if text.bytes().all(|sign| matches!(sign, b'-' | b'0' | b'.')) { text.replace('-', "") } else { text }
}

/// Formats a value with at least these decimals, and up to six if it needs them: 40.200, 0.0005.
#[must_use]
pub fn format_value(value: f64, decimals: usize) -> String {
    let text = format_length(value, 6);
    let needed = text.trim_end_matches('0').trim_end_matches('.');
    let shown = needed.split_once('.').map_or(0, |(_, behind)| behind.len());
    if shown > decimals { needed.to_owned() } else { format_length(value, decimals) }
}

/// Formats a feed, mm/min, to three significant digits below 100: 1500, 29.9, 0.3, 0.0215.
#[must_use]
pub fn format_feed(mm_min: f64) -> String {
    let decimals = match mm_min.abs() {
        100.0.. => 0,
        10.0.. => 1,
        1.0.. => 2,
        _ => 4,
    };
    format_value(format!("{mm_min:.decimals$}").parse().unwrap_or(mm_min), 0)
}
