//! Pictures of the cylindrical grinder: X up, Z to the right.

use egui::{Align2, Color32, Rect, Stroke, StrokeKind, pos2, vec2};

use crate::sheet::Sheet;

/// O1001: the jaws of a snap gauge, the wheel between them.
/// Strokes in X from #500 to #501; left face from Z #502 by #506 and #505, right face from Z #514 by #515 and #516.
pub fn snap_gauge(sheet: &Sheet) {
    sheet.axes((12.0, 40.0));
    // The snap gauge: a U-shaped body; dashed the stock on its inner faces.
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
    // The wheel seen from the rim, with its axis; below it its position at the end of the stroke.
    let wheel = Rect::from_min_max(pos2(88.0, 92.0), pos2(112.0, 232.0));
    sheet.painter.rect(wheel, 4.0, sheet.theme.paper, sheet.outline(), StrokeKind::Middle);
    sheet.dashed((72.0, 162.0), (128.0, 162.0), sheet.thin());
    sheet.painter.rect_filled(Rect::from_center_size(wheel.center(), vec2(24.0, 34.0)), 0.0, sheet.theme.paper_muted);
    sheet.dashed((88.0, 232.0), (88.0, 304.0), sheet.thin());
    sheet.dashed((112.0, 232.0), (112.0, 304.0), sheet.thin());
    sheet.dashed((88.0, 304.0), (112.0, 304.0), sheet.thin());
    sheet.dimension((100.0, 244.0), (100.0, 296.0));
    // Strokes in X.
    sheet.line(&[(36.0, 232.0), (88.0, 232.0)], sheet.accent());
    sheet.line(&[(36.0, 304.0), (88.0, 304.0)], sheet.accent());
    sheet.dimension((20.0, 242.0), (20.0, 294.0));
    sheet.variable_label((2.0, 231.0), Align2::LEFT_CENTER, 500);
    sheet.variable_label((2.0, 303.0), Align2::LEFT_CENTER, 501);
    // Safe X and the end position in Z.
    sheet.dashed((100.0, 92.0), (100.0, 58.0), sheet.accent());
    sheet.dashed((80.0, 58.0), (152.0, 58.0), sheet.accent());
    sheet.arrow_head((152.0, 58.0), (1.0, 0.0), sheet.theme.paper_accent);
    sheet.painter.circle_filled(pos2(155.0, 58.0), 2.4, sheet.theme.paper_accent);
    sheet.dashed((155.0, 58.0), (155.0, 28.0), sheet.thin());
    sheet.variable_label((78.0, 57.0), Align2::RIGHT_CENTER, 503);
    sheet.variable_label((155.0, 18.0), Align2::CENTER_CENTER, 504);
    // Left face, then right face.
    sheet.leader((2.0, 88.0), Align2::LEFT_CENTER, 502, &[(37.0, 89.0), (76.0, 89.0), (76.0, 184.0)]);
    sheet.leader((2.0, 116.0), Align2::LEFT_CENTER, 506, &[(37.0, 117.0), (70.5, 117.0), (70.5, 192.0)]);
    sheet.leader((2.0, 144.0), Align2::LEFT_CENTER, 505, &[(37.0, 145.0), (60.5, 145.0), (60.5, 192.0)]);
    sheet.leader((198.0, 88.0), Align2::RIGHT_CENTER, 514, &[(163.0, 89.0), (124.0, 89.0), (124.0, 184.0)]);
    sheet.leader((198.0, 116.0), Align2::RIGHT_CENTER, 515, &[(163.0, 117.0), (129.5, 117.0), (129.5, 192.0)]);
    sheet.leader((198.0, 144.0), Align2::RIGHT_CENTER, 516, &[(163.0, 145.0), (139.5, 145.0), (139.5, 192.0)]);
}

/// O1002: external plunge. #520 stock, #521 finished, #522 safe X, #523 Z position, #524 and #525 allowances.
pub fn plunge(sheet: &Sheet) {
    sheet.axes((12.0, 40.0));
    // The shaft on its centre line; dashed the stock at the plunge.
    let axis = 300.0;
    let shaft =
        |half: f32, left: f32, right: f32| Rect::from_min_max(pos2(left, axis - half), pos2(right, axis + half));
    sheet.painter.rect(shaft(28.0, 42.0, 66.0), 0.0, sheet.theme.paper, sheet.outline(), StrokeKind::Middle);
    sheet.painter.rect(shaft(28.0, 134.0, 158.0), 0.0, sheet.theme.paper, sheet.outline(), StrokeKind::Middle);
    let finished = shaft(42.0, 66.0, 134.0);
    sheet.hatch(finished, 10.0);
    sheet.painter.rect_stroke(finished, 0.0, sheet.outline(), StrokeKind::Middle);
    for half in [56.0, 70.0] {
        for side in [-1.0, 1.0] {
            sheet.dashed((66.0, axis + half * side), (134.0, axis + half * side), sheet.thin());
        }
    }
    sheet.dashed((66.0, axis - 70.0), (66.0, axis + 70.0), sheet.thin());
    sheet.dashed((134.0, axis - 70.0), (134.0, axis + 70.0), sheet.thin());
    sheet.dashed((36.0, axis), (170.0, axis), Stroke::new(1.0, sheet.theme.paper_ink));
    // The wheel above it at the safe position, and its move down.
    let wheel = [(72.0, 58.0), (128.0, 58.0), (128.0, 178.0), (72.0, 178.0)];
    sheet.shape(&wheel, sheet.theme.paper);
    sheet.painter.rect_filled(
        Rect::from_center_size(pos2(100.0, 92.0), vec2(56.0, 26.0)),
        0.0,
        sheet.theme.paper_muted,
    );
    sheet.dashed((56.0, 92.0), (144.0, 92.0), sheet.thin());
    sheet.line(&[(100.0, 134.0), (100.0, 212.0)], Stroke::new(1.6, sheet.theme.paper_ink));
    sheet.arrow_head((100.0, 220.0), (0.0, 1.0), sheet.theme.paper_ink);
    // Safe X, Z position.
    sheet.line(&[(36.0, 178.0), (72.0, 178.0)], sheet.accent());
    sheet.variable_label((2.0, 177.0), Align2::LEFT_CENTER, 522);
    sheet.dashed((72.0, 58.0), (72.0, 34.0), sheet.accent());
    sheet.variable_label((72.0, 24.0), Align2::CENTER_CENTER, 523);
    // Diameters.
    sheet.line(&[(134.0, axis - 70.0), (190.0, axis - 70.0)], sheet.thin());
    sheet.line(&[(134.0, axis + 70.0), (190.0, axis + 70.0)], sheet.thin());
    sheet.dimension((186.0, axis - 70.0), (186.0, axis + 70.0));
    sheet.variable_label((198.0, axis + 48.0), Align2::RIGHT_CENTER, 520);
    sheet.line(&[(10.0, axis - 42.0), (66.0, axis - 42.0)], sheet.thin());
    sheet.line(&[(10.0, axis + 42.0), (66.0, axis + 42.0)], sheet.thin());
    sheet.dimension((14.0, axis - 42.0), (14.0, axis + 42.0));
    sheet.variable_label((2.0, axis + 16.0), Align2::LEFT_CENTER, 521);
    // Remaining allowance before each stage.
    sheet.leader((198.0, 190.0), Align2::RIGHT_CENTER, 524, &[(163.0, 191.0), (126.0, 191.0), (126.0, axis - 63.0)]);
    sheet.leader((2.0, 212.0), Align2::LEFT_CENTER, 525, &[(37.0, 213.0), (74.0, 213.0), (74.0, axis - 49.0)]);
}

/// O1003: traverse. #600 stock, #601 finished, #602 safe X, reversal points #603 and #604, finishing allowance #605,
/// infeed #606 and #607 at the reversal points.
pub fn traverse(sheet: &Sheet) {
    sheet.axes((12.0, 40.0));
    let axis = 306.0;
    sheet.block((34.0, axis - 24.0), (52.0, axis + 24.0), sheet.theme.paper);
    sheet.block((150.0, axis - 24.0), (168.0, axis + 24.0), sheet.theme.paper);
    sheet.section((52.0, axis - 40.0), (150.0, axis + 40.0));
    for half in [50.0, 64.0] {
        for side in [-1.0, 1.0] {
            sheet.dashed((52.0, axis + half * side), (150.0, axis + half * side), sheet.thin());
        }
    }
    sheet.dashed((22.0, axis), (178.0, axis), Stroke::new(1.0, sheet.theme.paper_ink));
    // The wheel at the left reversal point, and dashed at the right one.
    sheet.dashed_block((128.0, 92.0), (160.0, 192.0));
    sheet.wheel((46.0, 92.0), (78.0, 192.0));
    sheet.double_arrow((84.0, 152.0), (122.0, 152.0));
    for x in [62.0, 144.0] {
        sheet.arrow((x, 198.0), (x, 224.0));
    }
    // Reversal points.
    sheet.dashed((46.0, 92.0), (46.0, 66.0), sheet.accent());
    sheet.dashed((128.0, 92.0), (128.0, 66.0), sheet.accent());
    sheet.variable_label((52.0, 57.0), Align2::CENTER_CENTER, 603);
    sheet.variable_label((128.0, 57.0), Align2::CENTER_CENTER, 604);
    // Safe X.
    sheet.line(&[(36.0, 192.0), (46.0, 192.0)], sheet.accent());
    sheet.variable_label((2.0, 191.0), Align2::LEFT_CENTER, 602);
    // Infeed at the reversal points.
    sheet.leader((198.0, 128.0), Align2::RIGHT_CENTER, 606, &[(180.0, 138.0), (180.0, 210.0), (146.0, 210.0)]);
    sheet.leader((2.0, 222.0), Align2::LEFT_CENTER, 607, &[(37.0, 222.0), (60.0, 214.0)]);
    // Diameters.
    sheet.line(&[(150.0, axis - 64.0), (192.0, axis - 64.0)], sheet.thin());
    sheet.line(&[(150.0, axis + 64.0), (192.0, axis + 64.0)], sheet.thin());
    sheet.dimension((188.0, axis - 64.0), (188.0, axis + 64.0));
    sheet.variable_label((198.0, axis + 44.0), Align2::RIGHT_CENTER, 600);
    sheet.line(&[(10.0, axis - 40.0), (52.0, axis - 40.0)], sheet.thin());
    sheet.line(&[(10.0, axis + 40.0), (52.0, axis + 40.0)], sheet.thin());
    sheet.dimension((14.0, axis - 40.0), (14.0, axis + 40.0));
    sheet.variable_label((2.0, axis + 16.0), Align2::LEFT_CENTER, 601);
    // Finishing allowance.
    sheet.leader((100.0, 389.0), Align2::CENTER_CENTER, 605, &[(100.0, 380.0), (100.0, axis + 45.0)]);
}

/// O1004: plunge to the gauge. #620 stock, #621 finished, #622 safe X, #623 Z position, #624 oscillation, feeds #626 to
/// #629 from one gauge signal to the next.
pub fn plunge_to_gauge(sheet: &Sheet) {
    sheet.axes((12.0, 40.0));
    let axis = 300.0;
    sheet.block((42.0, axis - 24.0), (62.0, axis + 24.0), sheet.theme.paper);
    sheet.block((122.0, axis - 24.0), (150.0, axis + 24.0), sheet.theme.paper);
    sheet.section((62.0, axis - 40.0), (122.0, axis + 40.0));
    for side in [-1.0, 1.0] {
        sheet.dashed((62.0, axis + 66.0 * side), (122.0, axis + 66.0 * side), sheet.thin());
    }
    sheet.dashed((30.0, axis), (160.0, axis), Stroke::new(1.0, sheet.theme.paper_ink));
    // The wheel, its short strokes and its move down.
    sheet.wheel((64.0, 76.0), (116.0, 178.0));
    sheet.double_arrow((76.0, 148.0), (104.0, 148.0));
    sheet.arrow((90.0, 182.0), (90.0, 214.0));
    sheet.dashed((64.0, 76.0), (64.0, 58.0), sheet.accent());
    sheet.variable_label((64.0, 49.0), Align2::CENTER_CENTER, 623);
    sheet.leader((150.0, 49.0), Align2::CENTER_CENTER, 624, &[(150.0, 60.0), (150.0, 148.0), (106.0, 148.0)]);
    sheet.line(&[(36.0, 178.0), (64.0, 178.0)], sheet.accent());
    sheet.variable_label((2.0, 177.0), Align2::LEFT_CENTER, 622);
    // The gauge: two tips on the part, its body below.
    let ink = sheet.ink();
    sheet.line(&[(92.0, axis + 40.0), (92.0, axis + 50.0), (130.0, axis + 50.0), (130.0, 386.0)], ink);
    sheet.line(&[(130.0, axis + 50.0), (130.0, axis - 52.0), (110.0, axis - 52.0), (110.0, axis - 40.0)], ink);
    sheet.block((118.0, 366.0), (142.0, 392.0), sheet.theme.paper_muted);
    for (x, y, up) in [(92.0, axis + 40.0, -1.0), (110.0, axis - 40.0, 1.0)] {
        sheet.arrow_head((x, y), (0.0, up), sheet.theme.paper_ink);
    }
    // The four feeds, each up to its gauge signal.
    let stages = [(206.0, 626), (234.0, 627), (256.0, 628), (274.0, 629)];
    let mut from = 180.0;
    for (to, variable) in stages {
        sheet.line(&[(156.0, to), (168.0, to)], sheet.accent());
        sheet.dimension((162.0, from), (162.0, to));
        sheet.variable_label((198.0, (from + to) / 2.0), Align2::RIGHT_CENTER, variable);
        from = to;
    }
    // Diameters.
    sheet.line(&[(20.0, axis - 66.0), (62.0, axis - 66.0)], sheet.thin());
    sheet.line(&[(20.0, axis + 66.0), (62.0, axis + 66.0)], sheet.thin());
    sheet.dimension((24.0, axis - 66.0), (24.0, axis + 66.0));
    sheet.variable_label((2.0, axis - 48.0), Align2::LEFT_CENTER, 620);
    sheet.line(&[(34.0, axis - 40.0), (62.0, axis - 40.0)], sheet.thin());
    sheet.line(&[(34.0, axis + 40.0), (62.0, axis + 40.0)], sheet.thin());
    sheet.dimension((38.0, axis - 40.0), (38.0, axis + 40.0));
    sheet.variable_label((28.0, axis + 18.0), Align2::LEFT_CENTER, 621);
}
