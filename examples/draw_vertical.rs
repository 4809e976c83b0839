//! Draws the pictures of the vertical grinder's R pages, B0801.BMP to B0803.BMP: table, part, wheel and diamond, with each R
//! parameter at its place. 200 × 400, 24 bit, uncompressed, in the style of the other page pictures (K5.12, H10, S3).
//!
//! `cargo run --example draw_vertical [FOLDER]`, by default `screens`.

use std::path::PathBuf;
use std::process::ExitCode;

use egui::epaint::PathShape;
use egui::{Align2, Context, Painter, Pos2, RawInput, Rect, Shape, Stroke, pos2, vec2};
use image::RgbaImage;
use kt830::hmi::raster::Raster;
use kt830::hmi::theme::{self, DARK};

const SIZE: (u32, u32) = (200, 400);
/// 54 of header, three a pixel.
const BYTES: usize = 54 + 3 * 200 * 400;

/// Puts one picture on its sheet.
type Drawing = fn(&Sheet);

fn main() -> ExitCode {
    let folder = std::env::args_os().nth(1).map_or_else(|| PathBuf::from("screens"), PathBuf::from);
    let pictures: [(&str, Drawing); 3] = [("B0801.BMP", dressing), ("B0802.BMP", sizes), ("B0803.BMP", course)];
    for (name, drawing) in pictures {
        if let Err(cause) = std::fs::write(folder.join(name), bitmap(&draw(drawing))) {
            eprintln!("{name}: {cause}");
            return ExitCode::from(2);
        }
    }
    ExitCode::SUCCESS
}

fn draw(drawing: Drawing) -> RgbaImage {
    let ctx = Context::default();
    theme::install(&ctx, &DARK);
    let area = Rect::from_min_size(Pos2::ZERO, vec2(SIZE.0 as f32, SIZE.1 as f32));
    let input = RawInput { screen_rect: Some(area), ..RawInput::default() };
    let mut output = ctx.run_ui(input, |ui| drawing(&Sheet(ui.painter().clone())));
    let mut raster = Raster::default();
    let mut delta = std::mem::take(&mut output.textures_delta);
    raster.update(&delta);
    delta.clear();
    let shapes = std::mem::take(&mut output.shapes);
    output.drop_without_applying_deltas();
    raster.paint(&ctx.tessellate(shapes, 1.0), 1.0, SIZE, DARK.paper)
}

/// BITMAPINFOHEADER, 24 bit, no compression, bottom row first.
fn bitmap(picture: &RgbaImage) -> Vec<u8> {
    let (width, height) = picture.dimensions();
    let mut bytes = b"BM".to_vec();
    bytes.extend((BYTES as u32).to_le_bytes());
    bytes.extend([0; 4]);
    [54, 40, width, height].into_iter().for_each(|word: u32| bytes.extend(word.to_le_bytes()));
    bytes.extend([1, 0, 24, 0]);
    [0, width * height * 3, 2_835, 2_835, 0, 0].into_iter().for_each(|word: u32| bytes.extend(word.to_le_bytes()));
    for row in picture.rows().rev() {
        bytes.extend(row.flat_map(|pixel| [pixel[2], pixel[1], pixel[0]]));
    }
    assert_eq!(bytes.len(), BYTES, "a page picture has {BYTES} bytes");
    bytes
}

/// The drawing style: outlines, centre lines, dimensions and names.
struct Sheet(Painter);

type At = (f32, f32);

impl Sheet {
    fn body(&self, from: At, to: At) {
        let area = Rect::from_min_max(pos2(from.0, from.1), pos2(to.0, to.1));
        let corners = [area.left_top(), area.right_top(), area.right_bottom(), area.left_bottom()];
        let stroke = Stroke::new(1.8, DARK.paper_ink);
        self.0.add(PathShape { points: corners.to_vec(), closed: true, fill: DARK.paper, stroke: stroke.into() });
    }

    fn line(&self, points: &[At], stroke: Stroke) {
        self.0.add(Shape::line(points.iter().map(|(x, y)| pos2(*x, *y)).collect(), stroke));
    }

    fn centre(&self, x: f32, from: f32, to: f32) {
        let stroke = Stroke::new(1.0, DARK.paper_quiet);
        self.0.extend(Shape::dashed_line(&[pos2(x, from), pos2(x, to)], stroke, 7.0, 3.0));
    }

    fn tip(&self, at: At, (dx, dy): At) {
        let side = |along: f32, across: f32| pos2(at.0 + dx * along - dy * across, at.1 + dy * along + dx * across);
        let points = vec![side(0.0, 0.0), side(-7.0, 2.8), side(-7.0, -2.8)];
        self.0.add(PathShape::convex_polygon(points, DARK.paper_accent, Stroke::NONE));
    }

    /// A dimension with an arrow at either end and its name on it.
    fn measure(&self, from: At, to: At, name: &str) {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let length = dx.hypot(dy).max(1.0);
        let (dx, dy) = (dx / length, dy / length);
        self.line(&[from, to], Stroke::new(1.0, DARK.paper_accent));
        self.tip(to, (dx, dy));
        self.tip(from, (-dx, -dy));
        self.name(((from.0 + to.0) / 2.0, (from.1 + to.1) / 2.0), name);
    }

    /// A name at the end of a leader that ends in a dot.
    fn leader(&self, label: At, to: At, name: &str) {
        self.line(&[label, to], Stroke::new(1.0, DARK.paper_accent));
        self.0.circle_filled(pos2(to.0, to.1), 2.2, DARK.paper_accent);
        self.name(label, name);
    }

    /// A name, with the paper under it free of lines.
    fn name(&self, at: At, name: &str) {
        let galley = self.0.layout_no_wrap(name.into(), theme::font(theme::SMALL), DARK.paper_accent);
        let place = Align2::CENTER_CENTER.anchor_size(pos2(at.0, at.1), galley.size());
        self.0.rect_filled(place.expand2(vec2(2.0, -3.0)), 0.0, DARK.paper);
        self.0.galley(place.min, galley, DARK.paper_accent);
    }

    /// Table with its axis, and the part on it.
    fn table(&self) {
        self.body((8.0, 330.0), (112.0, 352.0));
        self.body((40.0, 352.0), (80.0, 384.0));
        self.body((24.0, 316.0), (96.0, 330.0));
        self.body((24.0, 236.0), (96.0, 316.0));
        self.centre(60.0, 214.0, 394.0);
    }

    /// The wheel's disc, its lower edge at a height, and its spindle.
    fn wheel(&self, left: f32, bottom: f32) {
        self.body((left, bottom - 34.0), (left + 72.0, bottom));
        self.body((left + 28.0, bottom - 92.0), (left + 44.0, bottom - 34.0));
        self.centre(left + 36.0, bottom - 104.0, bottom + 12.0);
    }
}

fn dressing(sheet: &Sheet) {
    sheet.table();
    sheet.wheel(94.0, 150.0);
    // The diamond beyond the wheel.
    let ink = Stroke::new(1.8, DARK.paper_ink);
    sheet.line(&[(196.0, 140.0), (178.0, 140.0), (167.0, 150.0), (178.0, 160.0), (196.0, 160.0)], ink);
    sheet.measure((60.0, 200.0), (167.0, 200.0), "R11");
    sheet.line(&[(167.0, 154.0), (167.0, 206.0)], Stroke::new(1.0, DARK.paper_accent));
    sheet.measure((94.0, 104.0), (166.0, 104.0), "R3");
    sheet.measure((84.0, 116.0), (84.0, 150.0), "R4");
    sheet.measure((186.0, 166.0), (186.0, 330.0), "R12");
    sheet.leader((150.0, 228.0), (167.0, 150.0), "R10");
    sheet.leader((120.0, 36.0), (130.0, 64.0), "R7 R8");
    sheet.leader((34.0, 176.0), (96.0, 148.0), "R9");
    sheet.leader((150.0, 262.0), (172.0, 156.0), "R36 R37");
    sheet.leader((36.0, 60.0), (50.0, 90.0), "R46 R47");
    sheet.0.circle_stroke(pos2(50.0, 90.0), 4.0, Stroke::new(1.2, DARK.paper_accent));
}

fn sizes(sheet: &Sheet) {
    sheet.table();
    sheet.wheel(100.0, 262.0);
    sheet.measure((24.0, 290.0), (96.0, 290.0), "R18");
    sheet.measure((22.0, 206.0), (98.0, 206.0), "R20");
    sheet.line(&[(22.0, 200.0), (22.0, 236.0)], Stroke::new(1.0, DARK.paper_accent));
    sheet.line(&[(98.0, 200.0), (98.0, 236.0)], Stroke::new(1.0, DARK.paper_accent));
    sheet.measure((182.0, 262.0), (182.0, 330.0), "R21");
    sheet.measure((150.0, 296.0), (150.0, 330.0), "R19");
    sheet.measure((122.0, 316.0), (122.0, 330.0), "R13");
    sheet.leader((150.0, 130.0), (100.0, 250.0), "R28 R22");
    sheet.leader((40.0, 130.0), (96.0, 244.0), "R25");
    sheet.leader((40.0, 166.0), (96.0, 268.0), "R14");
    sheet.leader((60.0, 90.0), (136.0, 170.0), "R29 R23 R33");
}

fn course(sheet: &Sheet) {
    sheet.table();
    sheet.wheel(108.0, 262.0);
    sheet.measure((24.0, 290.0), (96.0, 290.0), "R60");
    sheet.measure((96.0, 222.0), (108.0, 222.0), "");
    sheet.name((102.0, 206.0), "R50");
    sheet.leader((40.0, 130.0), (100.0, 244.0), "R52 R53 R54");
    sheet.leader((60.0, 90.0), (110.0, 228.0), "R58 R59");
    sheet.leader((150.0, 130.0), (144.0, 158.0), "R51");
    sheet.leader((150.0, 60.0), (176.0, 92.0), "R56 R57 R80");
    sheet.0.circle_stroke(pos2(176.0, 92.0), 4.0, Stroke::new(1.2, DARK.paper_accent));
}
