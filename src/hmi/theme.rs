//! Colours, sizes and the font: the only place where a page's look is decided.
//! Source: spec H1, H4.

use std::sync::Arc;

use egui::{Color32, FontData, FontDefinitions, FontFamily, FontId, Vec2};

/// The bundled font: Noto Sans SC, every GBK character, tabular figures.
static FONT: &[u8] = include_bytes!("../../assets/font/NotoSansSC-GBK.otf");
const FONT_NAME: &str = "NotoSansSC-GBK";

/// Height of the header: its chips and the help key can be touched.
pub const HEADER: f32 = 46.0;
/// Height of the message line.
pub const MESSAGE: f32 = 32.0;
/// Height of the input line of pages that take numbers.
pub const INPUT: f32 = 36.0;
/// Height of the status line.
pub const STATUS: f32 = 28.0;
/// Height of the soft keys.
pub const SOFT: f32 = 52.0;
/// Panel width on a small landscape display, and on a wide one.
pub const PANEL: (f32, f32) = (264.0, 320.0);
/// Logical display width from which the panel is the wide one.
pub const WIDE: f32 = 1_200.0;
/// Panel height on a portrait display.
pub const PANEL_PORTRAIT: f32 = 330.0;
/// Smallest side of anything to be touched.
pub const TARGET: f32 = 44.0;
/// Small gap.
pub const GAP: f32 = 6.0;
/// Large gap.
pub const PAD: f32 = 12.0;
/// Corner radius.
pub const RADIUS: f32 = 4.0;
/// A hairline.
pub const HAIR: f32 = 1.0;
/// The frame of the chosen field.
pub const FRAME: f32 = 2.0;
/// Text sizes: position digits, their smaller companions, titles, labels, the smallest.
pub const DIGITS: f32 = 40.0;
/// Secondary digits and values.
pub const SECONDARY: f32 = 20.0;
/// Titles.
pub const TITLE: f32 = 18.0;
/// Labels.
pub const LABEL: f32 = 15.0;
/// Nothing is written smaller.
pub const SMALL: f32 = 13.0;
/// Pictures are shown in their own colours.
pub const UNTINTED: Color32 = Color32::WHITE;
/// Size of a page picture (K5.12), in logical points at scale 1.
pub const PICTURE: Vec2 = Vec2::new(200.0, 400.0);

/// The colour tokens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Theme {
    /// Behind everything.
    pub ground: Color32,
    /// Areas that hold something.
    pub surface: Color32,
    /// Keys and fields that can be touched.
    pub raised: Color32,
    /// Hairlines.
    pub line: Color32,
    /// Text.
    pub text: Color32,
    /// Text of lesser weight.
    pub quiet: Color32,
    /// Labels of blocked keys (with a lock beside them).
    pub dim: Color32,
    /// The chosen field.
    pub focus: Color32,
    /// Runs; lamp on.
    pub run: Color32,
    /// Held; refused.
    pub hold: Color32,
    /// Alarm, as a fill.
    pub alarm: Color32,
    /// Alarm, as text.
    pub alarm_text: Color32,
    /// Chosen mode or switch.
    pub info: Color32,
    /// Variables and conditions in the text of a program.
    pub macros: Color32,
    /// Text and pictograms on a fill of an accent colour.
    pub ink: Color32,
    /// The ground of the emergency stop.
    pub stop_ground: Color32,
    /// What is written on it.
    pub stop_ink: Color32,
    /// Paper and lines of the page pictures.
    pub paper: Color32,
    /// Lines on the paper.
    pub paper_ink: Color32,
    /// Lesser lines on the paper: dimensions, hatching.
    pub paper_quiet: Color32,
    /// What the dimension numbers are written in on the paper.
    pub paper_accent: Color32,
}

const fn rgb(hex: u32) -> Color32 {
    Color32::from_rgb((hex >> 16) as u8, (hex >> 8) as u8, hex as u8)
}

/// The dark theme of H4.
pub const DARK: Theme = Theme {
    ground: rgb(0x0E1216),
    surface: rgb(0x161C22),
    raised: rgb(0x202932),
    line: rgb(0x2E3A45),
    text: rgb(0xE9EEF2),
    quiet: rgb(0x9AA8B4),
    dim: rgb(0x7E8994),
    focus: rgb(0x3B8EEA),
    run: rgb(0x2EBD74),
    hold: rgb(0xF2B134),
    alarm: rgb(0xE5484D),
    alarm_text: rgb(0xFF8589),
    info: rgb(0x53C3F3),
    macros: rgb(0xC8A6F0),
    ink: rgb(0x0E1216),
    stop_ground: rgb(0xF5C518),
    stop_ink: rgb(0x0E1216),
    paper: rgb(0x161C22),
    paper_ink: rgb(0xE9EEF2),
    paper_quiet: rgb(0x6F7F8D),
    paper_accent: rgb(0x53C3F3),
};

/// The light theme of H4, for bright halls.
pub const LIGHT: Theme = Theme {
    ground: rgb(0xEDF0F3),
    surface: rgb(0xFFFFFF),
    raised: rgb(0xE1E6EB),
    line: rgb(0xA9B4BE),
    text: rgb(0x10161B),
    quiet: rgb(0x44515C),
    dim: rgb(0x56626D),
    focus: rgb(0x0B5CC0),
    run: rgb(0x0A6237),
    hold: rgb(0x7A4700),
    alarm: rgb(0xB3261E),
    alarm_text: rgb(0xA31B14),
    info: rgb(0x00567A),
    macros: rgb(0x6233A0),
    ink: rgb(0xFFFFFF),
    stop_ground: rgb(0xF5C518),
    stop_ink: rgb(0x0E1216),
    paper: rgb(0x161C22),
    paper_ink: rgb(0xE9EEF2),
    paper_quiet: rgb(0x6F7F8D),
    paper_accent: rgb(0x53C3F3),
};

impl Theme {
    /// The text tokens with the grounds they are written on; each pair has a contrast of 4.5 : 1 or more.
    #[must_use]
    pub fn text_pairs(&self) -> Vec<(&'static str, Color32, Color32)> {
        let grounds = [self.ground, self.surface, self.raised];
        let on_grounds = |name, ink: Color32| grounds.into_iter().map(move |ground| (name, ink, ground));
        let mut pairs: Vec<_> = on_grounds("text", self.text).chain(on_grounds("quiet", self.quiet)).collect();
        pairs.extend(on_grounds("hold", self.hold).chain(on_grounds("info", self.info)));
        pairs.extend(on_grounds("run", self.run).chain(on_grounds("alarm text", self.alarm_text)));
        pairs.extend(on_grounds("macros", self.macros));
        let fills = [self.run, self.hold, self.alarm, self.info, self.focus];
        pairs.extend(fills.into_iter().map(|fill| ("ink", self.ink, fill)));
        pairs.push(("emergency stop", self.stop_ink, self.stop_ground));
        // Blocked keys lie flat on the surface; what they are called must still be read.
        pairs.extend([self.ground, self.surface].into_iter().map(|ground| ("dim", self.dim, ground)));
        pairs.extend([self.paper_ink, self.paper_accent].into_iter().map(|ink| ("paper", ink, self.paper)));
        pairs
    }
}

/// What lies over the picture to leave so many percent of its brightness: all contrasts become smaller alike.
#[must_use]
pub fn veil(percent: u8) -> Color32 {
    Color32::from_black_alpha((255.0 * (1.0 - f32::from(percent.min(100)) / 100.0)).round() as u8)
}

/// Contrast of two colours, 1 to 21.
/// Source: WCAG 2.1, relative luminance.
#[must_use]
pub fn contrast(a: Color32, b: Color32) -> f64 {
    let luminance = |colour: Color32| {
        let linear = |channel: u8| {
            let value = f64::from(channel) / 255.0;
            if value <= 0.040_45 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * linear(colour.r()) + 0.7152 * linear(colour.g()) + 0.0722 * linear(colour.b())
    };
    let (a, b) = (luminance(a), luminance(b));
    (a.max(b) + 0.05) / (a.min(b) + 0.05)
}

/// How much larger than at 1024 × 768 everything is drawn on a display of so many pixels: in tenths, 1.4 at 1920 × 1080.
#[must_use]
pub fn scale(pixels: Vec2) -> f32 {
    let base = if pixels.x >= pixels.y { Vec2::new(1_024.0, 768.0) } else { Vec2::new(768.0, 1_024.0) };
    let fit = (pixels.x / base.x).min(pixels.y / base.y);
    if fit.is_finite() { ((fit * 10.0 + 0.001).floor() / 10.0).clamp(0.5, 4.0) } else { 1.0 }
}

/// A font of a size.
#[must_use]
pub fn font(size: f32) -> FontId {
    FontId::new(size, FontFamily::Proportional)
}

/// Gives a context the font and takes away what a machine's screen must not do: zoom by keyboard, tips, animation.
pub fn install(ctx: &egui::Context, theme: &Theme) {
    let mut fonts = FontDefinitions::empty();
    fonts.font_data.insert(FONT_NAME.to_owned(), Arc::new(FontData::from_static(FONT)));
    for family in [FontFamily::Proportional, FontFamily::Monospace] {
        fonts.families.insert(family, vec![FONT_NAME.to_owned()]);
    }
    ctx.set_fonts(fonts);
    ctx.set_theme(egui::Theme::Dark);
    ctx.options_mut(|options| {
        options.zoom_with_keyboard = false;
        // A slow finger, or one in a glove that rolls a little, presses a key all the same.
        options.input_options.max_click_duration = f64::INFINITY;
        options.input_options.max_click_dist = 10.0;
    });
    ctx.all_styles_mut(|style| {
        style.animation_time = 0.0;
        style.visuals.panel_fill = theme.ground;
        style.visuals.window_fill = theme.surface;
        style.interaction.selectable_labels = false;
    });
}
