//! Colours, sizes and font: the only place that defines the look of the pages.
//! Source: spec H1, H4.

use std::collections::BTreeSet;
use std::sync::Arc;

use egui::{Color32, FontData, FontDefinitions, FontFamily, FontId, Vec2};

use crate::units::PerAxis;

/// The bundled font: Noto Sans SC with every GBK character and tabular figures.
static FONT: &[u8] = include_bytes!("../../assets/font/NotoSansSC-GBK.otf");
const FONT_NAME: &str = "NotoSansSC-GBK";

/// Height of the header, points; its chips and help key are touch targets.
pub const HEADER: f32 = 46.0;
/// Height of the message line.
pub const MESSAGE: f32 = 32.0;
/// Its height below a zoomed part, which is too narrow for one line.
pub const MESSAGE_OF_TWO_LINES: f32 = 48.0;
/// Height of the input line of pages that take numbers.
pub const INPUT: f32 = 36.0;
/// Height of the status line.
pub const STATUS: f32 = 28.0;
/// Height of the soft keys.
pub const SOFT_KEYS: f32 = 52.0;
/// Panel width on a small landscape display, and on a wide one.
pub const PANEL: (f32, f32) = (264.0, 320.0);
/// Logical display width from which the wide panel is used.
pub const WIDE_FROM: f32 = 1_200.0;
/// Panel height on a portrait display.
pub const PANEL_PORTRAIT: f32 = 330.0;
/// Minimum side of a touch target.
pub const TOUCH_TARGET: f32 = 44.0;
/// Small gap.
pub const GAP: f32 = 6.0;
/// Large gap.
pub const PAD: f32 = 12.0;
/// Corner radius.
pub const RADIUS: f32 = 4.0;
/// A hairline.
pub const HAIRLINE: f32 = 1.0;
/// Line width of the frame of the selected field.
pub const FRAME: f32 = 2.0;
/// Text size of the position digits.
pub const DIGITS: f32 = 40.0;
/// Secondary digits and values.
pub const SECONDARY: f32 = 20.0;
/// Text size of the size of a finished part.
pub const FIGURE: f32 = 26.0;
/// Titles.
pub const TITLE: f32 = 18.0;
/// Labels.
pub const LABEL: f32 = 15.0;
/// Minimum text size.
pub const SMALL: f32 = 13.0;
/// Tint of pictures: their own colours.
pub const UNTINTED: Color32 = Color32::WHITE;
/// Size of a page picture (K5.12), in logical points at scale 1.
pub const PICTURE: Vec2 = Vec2::new(200.0, 400.0);

/// The colours of a theme.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Theme {
    /// Background of the screen.
    pub background: Color32,
    /// Cards and areas.
    pub surface: Color32,
    /// Keys and input fields.
    pub raised: Color32,
    /// Hairlines.
    pub line: Color32,
    /// Text.
    pub text: Color32,
    /// Secondary text.
    pub muted: Color32,
    /// Labels of blocked keys (with a lock symbol).
    pub disabled: Color32,
    /// Frame of the selected field.
    pub focus: Color32,
    /// Fill of the chosen place of a picture; the picture shines through.
    pub glow: Color32,
    /// Running; lamp on.
    pub run: Color32,
    /// Feed hold; refusal.
    pub hold: Color32,
    /// Alarm, as a fill.
    pub alarm: Color32,
    /// Alarm, as text.
    pub alarm_text: Color32,
    /// Selected mode or switch.
    pub info: Color32,
    /// Variables and conditions in the text of a program.
    pub macros: Color32,
    /// Text and pictograms on a fill of an accent colour.
    pub on_accent: Color32,
    /// Background of the emergency stop key.
    pub stop_background: Color32,
    /// Text on it.
    pub stop_text: Color32,
    /// Background of the page pictures.
    pub paper: Color32,
    /// Lines of the page pictures.
    pub paper_ink: Color32,
    /// Secondary lines of the page pictures: dimensions, hatching.
    pub paper_muted: Color32,
    /// Dimension numbers of the page pictures.
    pub paper_accent: Color32,
    /// Metal of parts, holders and spindles in a live scene: lit and in the shade.
    pub metal: (Color32, Color32),
    /// The wheel in a live scene: rim and body.
    pub abrasive: (Color32, Color32),
    /// Coolant.
    pub coolant: Color32,
    /// Sparks.
    pub spark: Color32,
}

const fn rgb(hex: u32) -> Color32 {
    Color32::from_rgb((hex >> 16) as u8, (hex >> 8) as u8, hex as u8)
}

/// The dark theme of H4.
pub const DARK: Theme = Theme {
    background: rgb(0x0E1216),
    surface: rgb(0x161C22),
    raised: rgb(0x202932),
    line: rgb(0x2E3A45),
    text: rgb(0xE9EEF2),
    muted: rgb(0x9AA8B4),
    disabled: rgb(0x7E8994),
    focus: rgb(0x3B8EEA),
    // Focus at 28 %.
    glow: Color32::from_rgba_premultiplied(16, 40, 66, 71),
    run: rgb(0x2EBD74),
    hold: rgb(0xF2B134),
    alarm: rgb(0xE5484D),
    alarm_text: rgb(0xFF8589),
    info: rgb(0x53C3F3),
    macros: rgb(0xC8A6F0),
    on_accent: rgb(0x0E1216),
    stop_background: rgb(0xF5C518),
    stop_text: rgb(0x0E1216),
    paper: rgb(0x161C22),
    paper_ink: rgb(0xE9EEF2),
    paper_muted: rgb(0x6F7F8D),
    paper_accent: rgb(0x53C3F3),
    metal: (rgb(0xAEB9C3), rgb(0x4A555F)),
    abrasive: (rgb(0xC9A37A), rgb(0x5B4A3A)),
    coolant: rgb(0x63B7E6),
    spark: rgb(0xFFC45C),
};

/// The light theme of H4, for bright halls.
pub const LIGHT: Theme = Theme {
    background: rgb(0xDDE3E9),
    surface: rgb(0xF2F5F7),
    raised: rgb(0xFFFFFF),
    line: rgb(0xA9B4BE),
    text: rgb(0x10161B),
    muted: rgb(0x44515C),
    disabled: rgb(0x56626D),
    focus: rgb(0x0B5CC0),
    // Focus at 22 %.
    glow: Color32::from_rgba_premultiplied(2, 20, 42, 56),
    run: rgb(0x0A6237),
    hold: rgb(0x7A4700),
    alarm: rgb(0xB3261E),
    alarm_text: rgb(0xA31B14),
    info: rgb(0x00567A),
    macros: rgb(0x6233A0),
    on_accent: rgb(0xFFFFFF),
    metal: (rgb(0xDCE3E9), rgb(0x8996A2)),
    abrasive: (rgb(0xB98D5E), rgb(0xD9C3A6)),
    coolant: rgb(0x2D86BD),
    spark: rgb(0xD96A00),
    // The emergency stop looks the same in both themes. The page pictures are drawn dark; see `for_light_theme`.
    ..DARK
};

/// The dark overlay that reduces the picture to `percent` of its brightness; all contrasts shrink equally.
#[must_use]
pub fn dimming_overlay(percent: u8) -> Color32 {
    Color32::from_black_alpha((255.0 * (1.0 - f32::from(percent.min(100)) / 100.0)).round() as u8)
}

/// Makes a dark drawing light: every colour keeps its hue, its lightness is inverted. A drawing is a picture whose edge
/// has one dark colour all around; a photograph or a light drawing stays as it is.
pub fn for_light_theme(picture: &mut image::RgbImage) {
    let (width, height) = picture.dimensions();
    let paper = *picture.get_pixel(0, 0);
    let at_edge = |x: u32, y: u32| x == 0 || y == 0 || x + 1 == width || y + 1 == height;
    let dark = paper.0.into_iter().all(|channel| channel < 64);
    if !dark || picture.enumerate_pixels().any(|(x, y, pixel)| at_edge(x, y) && *pixel != paper) {
        return;
    }
    for pixel in picture.pixels_mut() {
        let [most, least] =
            [pixel.0.into_iter().max(), pixel.0.into_iter().min()].map(|edge| i16::from(edge.unwrap_or(0)));
        pixel.0 = pixel.0.map(|channel| (i16::from(channel) + 255 - most - least) as u8);
    }
}

/// Display scale relative to 1024 × 768 px, in steps of 0.1: 1.4 at 1920 × 1080 px.
#[must_use]
pub fn scale(pixels: Vec2) -> f32 {
    let base = if pixels.x >= pixels.y { Vec2::new(1_024.0, 768.0) } else { Vec2::new(768.0, 1_024.0) };
    let fit = (pixels.x / base.x).min(pixels.y / base.y);
    if fit.is_finite() { ((fit * 10.0 + 0.001).floor() / 10.0).clamp(0.5, 4.0) } else { 1.0 }
}

/// The font in a size.
#[must_use]
pub fn font(size: f32) -> FontId {
    FontId::new(size, FontFamily::Proportional)
}

/// Colours of a printed diagram.
pub struct PlotColours {
    /// The ground.
    pub paper: Color32,
    /// Grid lines.
    pub grid: Color32,
    /// A programmed contour.
    pub contour: Color32,
    /// What the axes do along it.
    pub path: Color32,
    /// Limits and tolerances.
    pub limit: Color32,
    /// Curves of the axes.
    pub axes: PerAxis<Color32>,
}

/// Blue, vermilion and green differ for every eye (Okabe and Ito).
pub const PLOT: PlotColours = PlotColours {
    paper: Color32::WHITE,
    grid: Color32::from_rgb(215, 220, 226),
    contour: Color32::from_rgb(190, 190, 190),
    path: Color32::from_rgb(0, 114, 178),
    limit: Color32::from_rgb(180, 30, 30),
    axes: PerAxis([Color32::from_rgb(213, 94, 0), Color32::from_rgb(0, 158, 115), Color32::from_rgb(0, 114, 178)]),
};

/// The characters that the font of the screen lacks.
#[must_use]
pub fn lacking_glyphs(mut wanted: BTreeSet<char>) -> BTreeSet<char> {
    let ctx = egui::Context::default();
    install(&ctx, &DARK);
    ctx.begin_pass(egui::RawInput::default());
    ctx.fonts_mut(|fonts| wanted.retain(|sign| !fonts.has_glyph(&FontId::proportional(LABEL), *sign)));
    // Nothing is drawn: the font's texture is not needed.
    ctx.end_pass().textures_delta.clear();
    wanted
}

/// Installs the font and disables what a machine screen must not do: keyboard zoom, text selection, animation.
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
        // No key of the toolkit acts that is not in the keyboard table: Ctrl+Q ended the control.
        options.quit_shortcuts.clear();
        // A slow touch, or one that moves a little in a glove, still counts as a click.
        options.input_options.max_click_duration = f64::INFINITY;
        options.input_options.max_click_dist = 10.0;
    });
    ctx.all_styles_mut(|style| {
        style.animation_time = 0.0;
        style.visuals.panel_fill = theme.background;
        style.visuals.window_fill = theme.surface;
        style.interaction.selectable_labels = false;
    });
}
