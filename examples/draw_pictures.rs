//! Draws the page pictures B0001.BMP, B0002.BMP and B0100.BMP: wheel, part or diamond, and each macro variable at the
//! place that the page text names. 200 × 400, 24 bit, uncompressed: 240 054 bytes (K5.12). One drawing style for all (H10).
//!
//! `cargo run --example draw_pictures [FOLDER]`, by default `screens`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use egui::epaint::PathShape;
use egui::{Align2, Color32, Context, Painter, Pos2, RawInput, Rect, Shape, Stroke, pos2, vec2};
use image::RgbaImage;
use kt830::hmi::raster::Raster;
use kt830::hmi::theme::{self, DARK, Theme};

const SIZE: (u32, u32) = (200, 400);
const BYTES: usize = 240_054;

/// Puts one picture on its sheet.
type Drawing = fn(&Sheet);

fn main() -> ExitCode {
    let folder = std::env::args_os().nth(1).map_or_else(|| PathBuf::from("screens"), PathBuf::from);
    let pictures: [(&str, Drawing); 3] = [("B0001.BMP", snap_gauge), ("B0002.BMP", plunge), ("B0100.BMP", dressing)];
    for (name, drawing) in pictures {
        if let Err(cause) = std::fs::create_dir_all(&folder).and_then(|()| save(&folder.join(name), drawing)) {
            eprintln!("{name}: {cause}");
            return ExitCode::from(2);
        }
    }
    ExitCode::SUCCESS
}

/// Runs the painter once and writes what it drew.
fn save(path: &Path, drawing: Drawing) -> std::io::Result<()> {
    let bytes = bitmap(&draw(drawing));
    assert_eq!(bytes.len(), BYTES, "a page picture has {BYTES} bytes");
    std::fs::write(path, bytes)
}

fn draw(drawing: Drawing) -> RgbaImage {
    let ctx = Context::default();
    theme::install(&ctx, &DARK);
    let area = Rect::from_min_size(Pos2::ZERO, vec2(SIZE.0 as f32, SIZE.1 as f32));
    let input = RawInput { screen_rect: Some(area), ..RawInput::default() };
    let mut output = ctx.run_ui(input, |ui| drawing(&Sheet { painter: ui.painter().clone(), theme: DARK }));
    let mut raster = Raster::default();
    let mut delta = std::mem::take(&mut output.textures_delta);
    raster.update(&delta);
    delta.clear();
    let shapes = std::mem::take(&mut output.shapes);
    output.drop_without_applying_deltas();
    raster.paint(&ctx.tessellate(shapes, 1.0), 1.0, SIZE, DARK.paper)
}

/// The one form that the control reads: BITMAPINFOHEADER, 24 bit, no compression, bottom row first.
fn bitmap(picture: &RgbaImage) -> Vec<u8> {
    let (width, height) = picture.dimensions();
    let mut bytes = Vec::with_capacity(BYTES);
    bytes.extend(b"BM");
    bytes.extend((BYTES as u32).to_le_bytes());
    bytes.extend([0; 4]);
    for word in [54, 40, width, height] {
        bytes.extend(word.to_le_bytes());
    }
    bytes.extend([1, 0, 24, 0]);
    for word in [0, width * height * 3, 2_835, 2_835, 0, 0] {
        bytes.extend(word.to_le_bytes());
    }
    for row in picture.rows().rev() {
        bytes.extend(row.flat_map(|pixel| [pixel[2], pixel[1], pixel[0]]));
    }
    bytes
}

/// The drawing style: outlines, centre lines, dimensions and numbers.
struct Sheet {
    painter: Painter,
    theme: Theme,
}

impl Sheet {
    fn outline(&self) -> Stroke {
        Stroke::new(1.8, self.theme.paper_ink)
    }

    fn thin(&self) -> Stroke {
        Stroke::new(1.0, self.theme.paper_quiet)
    }

    fn accent(&self) -> Stroke {
        Stroke::new(1.0, self.theme.paper_accent)
    }

    fn shape(&self, points: &[(f32, f32)], fill: Color32) {
        let points: Vec<Pos2> = points.iter().map(|(x, y)| pos2(*x, *y)).collect();
        self.painter.add(PathShape { points, closed: true, fill, stroke: self.outline().into() });
    }

    fn line(&self, points: &[(f32, f32)], stroke: Stroke) {
        self.painter.add(Shape::line(points.iter().map(|(x, y)| pos2(*x, *y)).collect(), stroke));
    }

    fn dashed(&self, from: (f32, f32), to: (f32, f32), stroke: Stroke) {
        self.painter.extend(Shape::dashed_line(&[pos2(from.0, from.1), pos2(to.0, to.1)], stroke, 5.0, 3.0));
    }

    /// An arrow head with its tip here; `(dx, dy)` is its direction.
    fn tip(&self, at: (f32, f32), direction: (f32, f32), colour: Color32) {
        let (dx, dy) = direction;
        let side =
            |forward: f32, across: f32| pos2(at.0 + dx * forward - dy * across, at.1 + dy * forward + dx * across);
        let points = vec![side(0.0, 0.0), side(-7.0, 2.8), side(-7.0, -2.8)];
        self.painter.add(PathShape::convex_polygon(points, colour, Stroke::NONE));
    }

    /// A dimension line with an arrow at either end.
    fn measure(&self, from: (f32, f32), to: (f32, f32)) {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let length = dx.hypot(dy).max(1.0);
        let direction = (dx / length, dy / length);
        self.line(&[from, to], self.accent());
        self.tip(to, direction, self.theme.paper_accent);
        self.tip(from, (-direction.0, -direction.1), self.theme.paper_accent);
    }

    /// A number, with the paper under it free of lines.
    fn number(&self, at: (f32, f32), align: Align2, variable: u16) {
        let galley =
            self.painter.layout_no_wrap(format!("#{variable}"), theme::font(theme::SMALL), self.theme.paper_accent);
        let place = align.anchor_size(pos2(at.0, at.1), galley.size());
        self.painter.rect_filled(place.shrink2(vec2(-1.0, 3.0)), 0.0, self.theme.paper);
        self.painter.galley(place.min, galley, self.theme.paper_accent);
    }

    /// An axis letter, with the paper under it free of lines.
    fn letter(&self, at: (f32, f32), word: &str) {
        let galley = self.painter.layout_no_wrap(word.into(), theme::font(theme::LABEL), self.theme.paper_accent);
        let place = Align2::CENTER_CENTER.anchor_size(pos2(at.0, at.1), galley.size());
        self.painter.rect_filled(place.shrink2(vec2(-2.0, 3.0)), 0.0, self.theme.paper);
        self.painter.galley(place.min, galley, self.theme.paper_accent);
    }

    /// A number at the end of a leader that ends in a dot.
    fn leader(&self, label: (f32, f32), align: Align2, variable: u16, way: &[(f32, f32)]) {
        self.line(way, self.accent());
        if let Some((x, y)) = way.last() {
            self.painter.circle_filled(pos2(*x, *y), 2.2, self.theme.paper_accent);
        }
        self.number(label, align, variable);
    }

    fn hatch(&self, area: Rect, step: f32) {
        let clipped = self.painter.with_clip_rect(area);
        let mut x = area.min.x - area.height();
        while x < area.max.x {
            let ends = [pos2(x, area.max.y), pos2(x + area.height(), area.min.y)];
            clipped.line_segment(ends, self.thin());
            x += step;
        }
    }

    /// The coordinate cross: X up, Z to the right.
    fn axes(&self, at: (f32, f32)) {
        let (x, y) = at;
        let ink = self.theme.paper_ink;
        self.line(&[(x, y - 22.0), (x, y), (x + 22.0, y)], Stroke::new(1.2, ink));
        self.tip((x, y - 26.0), (0.0, -1.0), ink);
        self.tip((x + 26.0, y), (1.0, 0.0), ink);
        let letter =
            |at: Pos2, word: &str| self.painter.text(at, Align2::CENTER_CENTER, word, theme::font(theme::SMALL), ink);
        letter(pos2(x + 10.0, y - 23.0), "X");
        letter(pos2(x + 24.0, y - 10.0), "Z");
    }
}

/// O1001: the jaws of a snap gauge, the wheel between them.
/// Strokes in X from #500 to #501; left face from Z #502 by #506 and #505, right face from Z #514 by #515 and #516.
fn snap_gauge(sheet: &Sheet) {
    sheet.axes((12.0, 40.0));
    // The gauge: a U, its inner faces hatched where stock is taken off.
    let body = [
        (40.0, 176.0),
        (56.0, 176.0),
        (56.0, 330.0),
        (144.0, 330.0),
        (144.0, 176.0),
        (160.0, 176.0),
        (160.0, 382.0),
        (40.0, 382.0),
    ];
    sheet.hatch(Rect::from_min_max(pos2(40.0, 331.0), pos2(160.0, 382.0)), 9.0);
    sheet.hatch(Rect::from_min_max(pos2(40.0, 176.0), pos2(56.0, 331.0)), 9.0);
    sheet.hatch(Rect::from_min_max(pos2(144.0, 176.0), pos2(160.0, 331.0)), 9.0);
    sheet.shape(&body, Color32::TRANSPARENT);
    for x in [65.0, 76.0, 124.0, 135.0] {
        sheet.dashed((x, 176.0), (x, 330.0), sheet.thin());
    }
    // The wheel, seen on its rim, with its axis; below it the place at the end of the stroke.
    let wheel = Rect::from_min_max(pos2(88.0, 92.0), pos2(112.0, 232.0));
    sheet.painter.rect(wheel, 4.0, sheet.theme.paper, sheet.outline(), egui::StrokeKind::Middle);
    sheet.dashed((72.0, 162.0), (128.0, 162.0), sheet.thin());
    sheet.painter.rect_filled(Rect::from_center_size(wheel.center(), vec2(24.0, 34.0)), 0.0, sheet.theme.paper_quiet);
    sheet.dashed((88.0, 232.0), (88.0, 304.0), sheet.thin());
    sheet.dashed((112.0, 232.0), (112.0, 304.0), sheet.thin());
    sheet.dashed((88.0, 304.0), (112.0, 304.0), sheet.thin());
    sheet.measure((100.0, 244.0), (100.0, 296.0));
    // Strokes in X.
    sheet.line(&[(36.0, 232.0), (88.0, 232.0)], sheet.accent());
    sheet.line(&[(36.0, 304.0), (88.0, 304.0)], sheet.accent());
    sheet.measure((20.0, 242.0), (20.0, 294.0));
    sheet.number((2.0, 231.0), Align2::LEFT_CENTER, 500);
    sheet.number((2.0, 303.0), Align2::LEFT_CENTER, 501);
    // Safe X and the end in Z.
    sheet.dashed((100.0, 92.0), (100.0, 58.0), sheet.accent());
    sheet.dashed((80.0, 58.0), (152.0, 58.0), sheet.accent());
    sheet.tip((152.0, 58.0), (1.0, 0.0), sheet.theme.paper_accent);
    sheet.painter.circle_filled(pos2(155.0, 58.0), 2.4, sheet.theme.paper_accent);
    sheet.dashed((155.0, 58.0), (155.0, 28.0), sheet.thin());
    sheet.number((78.0, 57.0), Align2::RIGHT_CENTER, 503);
    sheet.number((155.0, 18.0), Align2::CENTER_CENTER, 504);
    // Left face, then right face.
    sheet.leader((2.0, 88.0), Align2::LEFT_CENTER, 502, &[(37.0, 89.0), (76.0, 89.0), (76.0, 184.0)]);
    sheet.leader((2.0, 116.0), Align2::LEFT_CENTER, 506, &[(37.0, 117.0), (70.5, 117.0), (70.5, 192.0)]);
    sheet.leader((2.0, 144.0), Align2::LEFT_CENTER, 505, &[(37.0, 145.0), (60.5, 145.0), (60.5, 192.0)]);
    sheet.leader((198.0, 88.0), Align2::RIGHT_CENTER, 514, &[(163.0, 89.0), (124.0, 89.0), (124.0, 184.0)]);
    sheet.leader((198.0, 116.0), Align2::RIGHT_CENTER, 515, &[(163.0, 117.0), (129.5, 117.0), (129.5, 192.0)]);
    sheet.leader((198.0, 144.0), Align2::RIGHT_CENTER, 516, &[(163.0, 145.0), (139.5, 145.0), (139.5, 192.0)]);
}

/// O1002: external plunge. #520 stock, #521 finished, #522 safe X, #523 Z place, #524 and #525 allowances.
fn plunge(sheet: &Sheet) {
    sheet.axes((12.0, 40.0));
    // The shaft, its stock dashed at the place of the plunge, on its centre line.
    let axis = 300.0;
    let shaft =
        |half: f32, left: f32, right: f32| Rect::from_min_max(pos2(left, axis - half), pos2(right, axis + half));
    sheet.painter.rect(shaft(28.0, 42.0, 66.0), 0.0, sheet.theme.paper, sheet.outline(), egui::StrokeKind::Middle);
    sheet.painter.rect(shaft(28.0, 134.0, 158.0), 0.0, sheet.theme.paper, sheet.outline(), egui::StrokeKind::Middle);
    let finished = shaft(42.0, 66.0, 134.0);
    sheet.hatch(finished, 10.0);
    sheet.painter.rect_stroke(finished, 0.0, sheet.outline(), egui::StrokeKind::Middle);
    for half in [56.0, 70.0] {
        for side in [-1.0, 1.0] {
            sheet.dashed((66.0, axis + half * side), (134.0, axis + half * side), sheet.thin());
        }
    }
    sheet.dashed((66.0, axis - 70.0), (66.0, axis + 70.0), sheet.thin());
    sheet.dashed((134.0, axis - 70.0), (134.0, axis + 70.0), sheet.thin());
    sheet.dashed((36.0, axis), (170.0, axis), Stroke::new(1.0, sheet.theme.paper_ink));
    // The wheel over it, at the safe place, and its way down.
    let wheel = [(72.0, 58.0), (128.0, 58.0), (128.0, 178.0), (72.0, 178.0)];
    sheet.shape(&wheel, sheet.theme.paper);
    sheet.painter.rect_filled(
        Rect::from_center_size(pos2(100.0, 92.0), vec2(56.0, 26.0)),
        0.0,
        sheet.theme.paper_quiet,
    );
    sheet.dashed((56.0, 92.0), (144.0, 92.0), sheet.thin());
    sheet.line(&[(100.0, 134.0), (100.0, 212.0)], Stroke::new(1.6, sheet.theme.paper_ink));
    sheet.tip((100.0, 220.0), (0.0, 1.0), sheet.theme.paper_ink);
    // Safe X, Z place.
    sheet.line(&[(36.0, 178.0), (72.0, 178.0)], sheet.accent());
    sheet.number((2.0, 177.0), Align2::LEFT_CENTER, 522);
    sheet.dashed((72.0, 58.0), (72.0, 34.0), sheet.accent());
    sheet.number((72.0, 24.0), Align2::CENTER_CENTER, 523);
    // Diameters.
    sheet.line(&[(134.0, axis - 70.0), (190.0, axis - 70.0)], sheet.thin());
    sheet.line(&[(134.0, axis + 70.0), (190.0, axis + 70.0)], sheet.thin());
    sheet.measure((186.0, axis - 70.0), (186.0, axis + 70.0));
    sheet.number((198.0, axis + 48.0), Align2::RIGHT_CENTER, 520);
    sheet.line(&[(10.0, axis - 42.0), (66.0, axis - 42.0)], sheet.thin());
    sheet.line(&[(10.0, axis + 42.0), (66.0, axis + 42.0)], sheet.thin());
    sheet.measure((14.0, axis - 42.0), (14.0, axis + 42.0));
    sheet.number((2.0, axis + 16.0), Align2::LEFT_CENTER, 521);
    // What is left before each stage.
    sheet.leader((198.0, 190.0), Align2::RIGHT_CENTER, 524, &[(163.0, 191.0), (126.0, 191.0), (126.0, axis - 63.0)]);
    sheet.leader((2.0, 212.0), Align2::LEFT_CENTER, 525, &[(37.0, 213.0), (74.0, 213.0), (74.0, axis - 49.0)]);
}

/// The dressing page: the wheel over the diamond, and the dressing point with its machine coordinates X and Z.
fn dressing(sheet: &Sheet) {
    sheet.axes((12.0, 40.0));
    // The wheel on its rim, with its flanges and axis.
    let wheel = [(82.0, 58.0), (142.0, 58.0), (142.0, 206.0), (82.0, 206.0)];
    sheet.shape(&wheel, sheet.theme.paper);
    sheet.painter.rect_filled(
        Rect::from_center_size(pos2(112.0, 104.0), vec2(60.0, 28.0)),
        0.0,
        sheet.theme.paper_quiet,
    );
    sheet.dashed((62.0, 104.0), (162.0, 104.0), sheet.thin());
    // What dressing takes off the rim.
    sheet.hatch(Rect::from_min_max(pos2(83.0, 194.0), pos2(141.0, 205.0)), 6.0);
    sheet.dashed((82.0, 194.0), (142.0, 194.0), sheet.thin());
    // The diamond in its holder, the holder on its foot.
    let tip = (82.0, 226.0);
    sheet.shape(&[tip, (90.0, 242.0), (74.0, 242.0)], sheet.theme.paper_accent);
    sheet.shape(&[(70.0, 242.0), (94.0, 242.0), (94.0, 318.0), (70.0, 318.0)], sheet.theme.paper);
    let foot = Rect::from_min_max(pos2(46.0, 318.0), pos2(118.0, 348.0));
    sheet.hatch(foot, 9.0);
    sheet.painter.rect_stroke(foot, 0.0, sheet.outline(), egui::StrokeKind::Middle);
    sheet.dashed((82.0, 232.0), (82.0, 348.0), sheet.thin());
    // The wheel's corner goes down onto the diamond, then the diamond passes along the rim.
    let ink = sheet.theme.paper_ink;
    sheet.line(&[(160.0, 216.0), (104.0, 216.0)], Stroke::new(1.6, ink));
    sheet.tip((98.0, 216.0), (-1.0, 0.0), ink);
    sheet.tip((168.0, 216.0), (1.0, 0.0), ink);
    sheet.line(&[(112.0, 126.0), (112.0, 168.0)], Stroke::new(1.6, ink));
    sheet.tip((112.0, 178.0), (0.0, 1.0), ink);
    // The dressing point: a target on the diamond, and its two coordinates.
    sheet.painter.circle_stroke(pos2(tip.0, tip.1), 9.0, sheet.accent());
    sheet.line(&[(20.0, tip.1), (tip.0 - 4.0, tip.1)], sheet.accent());
    sheet.line(&[(tip.0, tip.1 + 6.0), (tip.0, 374.0)], sheet.accent());
    sheet.measure((30.0, 72.0), (30.0, tip.1));
    sheet.measure((14.0, 368.0), (tip.0, 368.0));
    sheet.line(&[(24.0, 72.0), (36.0, 72.0)], sheet.accent());
    sheet.line(&[(14.0, 362.0), (14.0, 374.0)], sheet.accent());
    sheet.letter((30.0, 150.0), "X");
    sheet.letter((46.0, 384.0), "Z");
}
