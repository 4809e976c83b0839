//! Draws the page pictures, and writes where each names its variables (D0001.RON …): B0001.BMP to B0014.BMP, B0100.BMP and B0801.BMP to B0803.BMP: wheel, part or diamond, with
//! each macro variable of the page text. 200 × 400, 24 bit, uncompressed: 240 054 bytes (K5.12). Drawing style: H10.
//!
//! `cargo run --example draw_pictures [FOLDER]`, by default `screens`.

mod cylindrical;
mod dressing;
mod faces;
mod sheet;
mod table;
mod vertical;

use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use egui::{Context, Pos2, RawInput, Rect, vec2};
use image::RgbaImage;
use kt830::hmi::rasterizer::Rasterizer;
use kt830::hmi::theme::{self, DARK};

use sheet::{NamedPlace, Sheet};

const SIZE: (u32, u32) = (200, 400);
const BYTES: usize = 240_054;

/// Draws one picture on a sheet.
type Drawing = fn(&Sheet);

fn main() -> ExitCode {
    let folder = std::env::args_os().nth(1).map_or_else(|| PathBuf::from("screens"), PathBuf::from);
    let pictures: [(&str, Drawing); 18] = [
        ("B0001.BMP", cylindrical::snap_gauge),
        ("B0002.BMP", cylindrical::plunge),
        ("B0003.BMP", cylindrical::traverse),
        ("B0004.BMP", cylindrical::plunge_to_gauge),
        ("B0005.BMP", faces::shoulder),
        ("B0006.BMP", faces::cone),
        ("B0007.BMP", table::plane),
        ("B0008.BMP", table::slot),
        ("B0009.BMP", table::step),
        ("B0010.BMP", table::ring),
        ("B0011.BMP", dressing::straight),
        ("B0012.BMP", dressing::profile),
        ("B0013.BMP", dressing::roll),
        ("B0014.BMP", dressing::rotary),
        ("B0100.BMP", dressing::dressing),
        ("B0801.BMP", vertical::dressing),
        ("B0802.BMP", vertical::sizes),
        ("B0803.BMP", vertical::process_values),
    ];
    for (name, drawing) in pictures {
        if let Err(cause) = std::fs::create_dir_all(&folder).and_then(|()| save(&folder.join(name), drawing)) {
            eprintln!("{name}: {cause}");
            return ExitCode::from(2);
        }
    }
    ExitCode::SUCCESS
}

/// Draws a picture and writes it to a file.
fn save(path: &Path, drawing: Drawing) -> std::io::Result<()> {
    let (picture, labels) = draw(drawing);
    let bytes = bitmap(&picture);
    assert_eq!(bytes.len(), BYTES, "a page picture has {BYTES} bytes");
    std::fs::write(path, bytes)?;
    // The picture of the dressing page belongs to no program.
    let name = path.file_name().and_then(|name| name.to_str()).and_then(|name| name.strip_prefix('B'));
    let Some(number) = name.and_then(|name| name.strip_suffix(".BMP")).filter(|_| !labels.is_empty()) else {
        return Ok(());
    };
    let lines: String = labels.iter().map(line).collect();
    std::fs::write(path.with_file_name(format!("D{number}.RON")), format!("[\n{lines}]\n"))
}

fn line((name, area): &NamedPlace) -> String {
    format!("    (variable: {name:?}, area: {area:?}),\n")
}

fn draw(drawing: Drawing) -> (RgbaImage, Vec<NamedPlace>) {
    let ctx = Context::default();
    theme::install(&ctx, &DARK);
    let area = Rect::from_min_size(Pos2::ZERO, vec2(SIZE.0 as f32, SIZE.1 as f32));
    let input = RawInput { screen_rect: Some(area), ..RawInput::default() };
    let mut labels = Vec::new();
    let mut output = ctx.run_ui(input, |ui| {
        let sheet = Sheet { painter: ui.painter().clone(), theme: DARK, labels: RefCell::default() };
        drawing(&sheet);
        labels = sheet.labels.into_inner();
    });
    let mut raster = Rasterizer::default();
    let mut delta = std::mem::take(&mut output.textures_delta);
    raster.update(&delta);
    delta.clear();
    let shapes = std::mem::take(&mut output.shapes);
    output.drop_without_applying_deltas();
    (raster.paint(&ctx.tessellate(shapes, 1.0), 1.0, SIZE, DARK.paper), labels)
}

/// The only BMP format that the control reads: BITMAPINFOHEADER, 24 bit, no compression, bottom row first.
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
