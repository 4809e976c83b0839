//! Pictures of the vertical grinder's R pages: table, part, wheel and diamond with the R parameters (S3).

use egui::{Align2, pos2};

use crate::sheet::Sheet;

type At = (f32, f32);

/// A label centred at a point.
fn label(sheet: &Sheet, at: At, words: &str) {
    sheet.label(at, Align2::CENTER_CENTER, words);
}

/// A leader that ends in a dot, with a label.
fn leader(sheet: &Sheet, from: At, to: At, at: At, words: &str) {
    sheet.line(&[from, to], sheet.accent());
    sheet.painter.circle_filled(pos2(to.0, to.1), 2.2, sheet.theme.paper_accent);
    label(sheet, at, words);
}

/// A dimension with a label.
fn dimension(sheet: &Sheet, from: At, to: At, at: At, words: &str) {
    sheet.dimension(from, to);
    label(sheet, at, words);
}

/// An arrow.
fn arrow(sheet: &Sheet, from: At, to: At) {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let length = dx.hypot(dy).max(1.0);
    sheet.line(&[from, to], sheet.accent());
    sheet.arrow_head(to, (dx / length, dy / length), sheet.theme.paper_accent);
}

/// A target position of the wheel's centre.
fn target(sheet: &Sheet, at: At) {
    sheet.painter.circle_stroke(pos2(at.0, at.1), 4.0, sheet.accent());
}

/// The table with its axis, the blocks, and the part on them.
fn table(sheet: &Sheet, axis_from: f32) {
    let paper = sheet.theme.paper;
    sheet.block((8.0, 330.0), (112.0, 352.0), paper);
    sheet.block((40.0, 352.0), (80.0, 384.0), paper);
    sheet.block((24.0, 316.0), (96.0, 330.0), paper);
    sheet.block((24.0, 236.0), (96.0, 316.0), paper);
    sheet.dashed((60.0, axis_from), (60.0, 394.0), sheet.thin());
}

/// The wheel with its lower edge at `bottom`, and its spindle.
fn wheel(sheet: &Sheet, left: f32, bottom: f32) {
    let paper = sheet.theme.paper;
    sheet.block((left, bottom - 34.0), (left + 72.0, bottom), paper);
    sheet.block((left + 28.0, bottom - 92.0), (left + 44.0, bottom - 34.0), paper);
    sheet.dashed((left + 36.0, bottom - 104.0), (left + 36.0, bottom + 12.0), sheet.thin());
}

/// Wheel and diamond (C0801).
pub fn dressing(sheet: &Sheet) {
    table(sheet, 196.0);
    wheel(sheet, 94.0, 150.0);
    // The diamond beyond the wheel; R12 is measured to its lower edge.
    sheet.shape(&[(167.0, 150.0), (176.0, 134.0), (196.0, 134.0), (196.0, 150.0)], sheet.theme.paper);
    sheet.line(&[(94.0, 98.0), (94.0, 116.0)], sheet.accent());
    sheet.line(&[(166.0, 98.0), (166.0, 116.0)], sheet.accent());
    dimension(sheet, (94.0, 104.0), (166.0, 104.0), (108.0, 104.0), "R3");
    dimension(sheet, (82.0, 116.0), (82.0, 150.0), (66.0, 133.0), "R4");
    leader(sheet, (184.0, 86.0), (168.0, 147.0), (184.0, 78.0), "R10");
    leader(sheet, (138.0, 172.0), (165.0, 151.0), (122.0, 178.0), "R36 R37");
    leader(sheet, (46.0, 172.0), (95.0, 149.0), (36.0, 178.0), "R9");
    sheet.line(&[(167.0, 154.0), (167.0, 212.0)], sheet.accent());
    dimension(sheet, (60.0, 206.0), (167.0, 206.0), (114.0, 206.0), "R11");
    sheet.line(&[(112.0, 330.0), (192.0, 330.0)], sheet.accent());
    dimension(sheet, (186.0, 151.0), (186.0, 330.0), (184.0, 250.0), "R12");
    leader(sheet, (104.0, 36.0), (128.0, 64.0), (92.0, 28.0), "R7 R8");
    leader(sheet, (40.0, 66.0), (40.0, 92.0), (40.0, 58.0), "R46 R47");
    target(sheet, (40.0, 92.0));
}

/// Sizes and feeds (C0802).
pub fn sizes(sheet: &Sheet) {
    table(sheet, 208.0);
    wheel(sheet, 100.0, 262.0);
    sheet.line(&[(22.0, 188.0), (22.0, 236.0)], sheet.accent());
    sheet.line(&[(98.0, 188.0), (98.0, 236.0)], sheet.accent());
    dimension(sheet, (22.0, 194.0), (98.0, 194.0), (60.0, 194.0), "R20");
    dimension(sheet, (24.0, 292.0), (96.0, 292.0), (44.0, 292.0), "R18");
    leader(sheet, (50.0, 222.0), (97.0, 244.0), (38.0, 220.0), "R25");
    arrow(sheet, (118.0, 245.0), (102.0, 245.0));
    label(sheet, (144.0, 245.0), "R28 R22");
    // The stroke, up and down, and the feeds along it.
    sheet.dimension((184.0, 176.0), (184.0, 252.0));
    label(sheet, (156.0, 156.0), "R29 R23 R33");
    leader(sheet, (118.0, 280.0), (98.0, 262.0), (124.0, 288.0), "R14");
    sheet.line(&[(96.0, 316.0), (126.0, 316.0)], sheet.accent());
    sheet.line(&[(112.0, 330.0), (192.0, 330.0)], sheet.accent());
    sheet.line(&[(172.0, 262.0), (192.0, 262.0)], sheet.accent());
    sheet.line(&[(98.0, 302.0), (158.0, 302.0)], sheet.accent());
    sheet.dimension((122.0, 316.0), (122.0, 330.0));
    label(sheet, (136.0, 318.0), "R13");
    dimension(sheet, (153.0, 302.0), (153.0, 330.0), (153.0, 290.0), "R19");
    dimension(sheet, (186.0, 262.0), (186.0, 330.0), (184.0, 284.0), "R21");
}

/// Process values (C0803).
pub fn process_values(sheet: &Sheet) {
    table(sheet, 208.0);
    wheel(sheet, 108.0, 262.0);
    dimension(sheet, (24.0, 292.0), (96.0, 292.0), (44.0, 292.0), "R60");
    // The step is too narrow for arrows inside: they point at it from both sides.
    sheet.line(&[(96.0, 214.0), (96.0, 236.0)], sheet.accent());
    sheet.line(&[(108.0, 214.0), (108.0, 228.0)], sheet.accent());
    arrow(sheet, (80.0, 220.0), (96.0, 220.0));
    arrow(sheet, (124.0, 220.0), (108.0, 220.0));
    label(sheet, (40.0, 220.0), "R50");
    sheet.line(&[(54.0, 220.0), (82.0, 220.0)], sheet.accent());
    leader(sheet, (62.0, 158.0), (107.0, 230.0), (48.0, 150.0), "R58 R59");
    leader(sheet, (128.0, 282.0), (97.0, 250.0), (148.0, 290.0), "R52 R53 R54");
    leader(sheet, (172.0, 152.0), (150.0, 178.0), (178.0, 144.0), "R51");
    leader(sheet, (150.0, 62.0), (170.0, 92.0), (142.0, 54.0), "R56 R57 R80");
    target(sheet, (170.0, 92.0));
}
