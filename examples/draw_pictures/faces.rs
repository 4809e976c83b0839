//! Pictures of faces and cones on the cylindrical grinder: X up, Z to the right.

use egui::{Align2, Color32, Rect, Stroke, pos2};

use crate::sheet::Sheet;

/// O1005: the gauge finds the reference, the wheel's side grinds the face #640 to its left; #641 allowance, #646 and
/// #647 X, #650 and #651 start of gauging, #656 distance of the tip to the left of the wheel.
pub fn shoulder(sheet: &Sheet) {
    sheet.axes((12.0, 40.0));
    let axis = 372.0;
    // The upper half of the shaft: flange, neck, reference shoulder, end.
    let part = [
        (24.0, axis),
        (24.0, 330.0),
        (44.0, 330.0),
        (44.0, 246.0),
        (76.0, 246.0),
        (76.0, 316.0),
        (124.0, 316.0),
        (124.0, 346.0),
        (160.0, 346.0),
        (160.0, axis),
    ];
    sheet.hatch(Rect::from_min_max(pos2(44.0, 246.0), pos2(76.0, axis)), 9.0);
    sheet.hatch(Rect::from_min_max(pos2(76.0, 316.0), pos2(124.0, axis)), 9.0);
    sheet.shape(&part, Color32::TRANSPARENT);
    sheet.dashed((12.0, axis), (172.0, axis), Stroke::new(1.0, sheet.theme.paper_ink));
    sheet.dashed((86.0, 246.0), (86.0, 316.0), sheet.thin());
    // The wheel at the face; dashed its gauging position, with the arm in front.
    sheet.wheel((88.0, 196.0), (116.0, 306.0));
    sheet.arrow((86.0, 282.0), (64.0, 282.0));
    sheet.dashed_block((152.0, 92.0), (180.0, 190.0));
    let ink = sheet.ink();
    sheet.line(&[(152.0, 178.0), (134.0, 178.0), (134.0, 336.0)], ink);
    sheet.line(&[(134.0, 336.0), (128.0, 336.0)], ink);
    sheet.painter.circle_filled(pos2(127.0, 336.0), 3.2, sheet.theme.paper_accent);
    sheet.double_arrow((166.0, 214.0), (144.0, 214.0));
    // The tip beside the wheel; the start of gauging.
    sheet.dashed((152.0, 92.0), (152.0, 52.0), sheet.accent());
    sheet.variable_label((152.0, 43.0), Align2::CENTER_CENTER, 651);
    sheet.dimension((134.0, 70.0), (152.0, 70.0));
    sheet.line(&[(134.0, 64.0), (134.0, 178.0)], sheet.thin());
    sheet.variable_label((130.0, 69.0), Align2::RIGHT_CENTER, 656);
    sheet.line(&[(110.0, 190.0), (152.0, 190.0)], sheet.thin());
    sheet.leader((64.0, 136.0), Align2::CENTER_CENTER, 650, &[(82.0, 136.0), (126.0, 136.0), (126.0, 190.0)]);
    // X of grinding and safe X.
    sheet.line(&[(30.0, 306.0), (88.0, 306.0)], sheet.thin());
    sheet.variable_label((2.0, 305.0), Align2::LEFT_CENTER, 646);
    sheet.line(&[(36.0, 196.0), (88.0, 196.0)], sheet.thin());
    sheet.variable_label((2.0, 195.0), Align2::LEFT_CENTER, 647);
    // Length from the reference, allowance.
    sheet.line(&[(76.0, 316.0), (76.0, 396.0)], sheet.thin());
    sheet.line(&[(124.0, 346.0), (124.0, 396.0)], sheet.thin());
    sheet.dimension((76.0, 391.0), (124.0, 391.0));
    sheet.variable_label((130.0, 389.0), Align2::LEFT_CENTER, 640);
    sheet.leader((2.0, 226.0), Align2::LEFT_CENTER, 641, &[(37.0, 227.0), (81.0, 227.0), (81.0, 254.0)]);
}

/// O1006: a cone. #660 and #661 its diameters at #662 and #663, #664 safe X, #665 allowance, #672 overrun at the ends.
pub fn cone(sheet: &Sheet) {
    sheet.axes((12.0, 40.0));
    let axis = 312.0;
    sheet.block((36.0, axis - 18.0), (58.0, axis + 18.0), sheet.theme.paper);
    let points = |grow: f32| {
        [
            (58.0, axis - 26.0 - grow),
            (142.0, axis - 48.0 - grow),
            (142.0, axis + 48.0 + grow),
            (58.0, axis + 26.0 + grow),
        ]
    };
    sheet.hatch(Rect::from_min_max(pos2(58.0, axis - 26.0), pos2(142.0, axis + 26.0)), 9.0);
    sheet.shape(&points(0.0), Color32::TRANSPARENT);
    let stock = points(14.0);
    sheet.dashed(stock[0], stock[1], sheet.thin());
    sheet.dashed(stock[2], stock[3], sheet.thin());
    sheet.block((142.0, axis - 18.0), (164.0, axis + 18.0), sheet.theme.paper);
    sheet.dashed((24.0, axis), (176.0, axis), Stroke::new(1.0, sheet.theme.paper_ink));
    // The wheel, its rim dressed to the cone, and its move along the cone.
    let wheel = [(46.0, 96.0), (84.0, 96.0), (84.0, 186.0), (46.0, 196.0)];
    sheet.shape(&wheel, sheet.theme.paper);
    let hub = Rect::from_min_max(pos2(46.0, 114.0), pos2(84.0, 134.0));
    sheet.painter.rect_filled(hub, 0.0, sheet.theme.paper_muted);
    sheet.dashed((34.0, 124.0), (96.0, 124.0), sheet.thin());
    for (from, to) in
        [((112.0, 80.0), (150.0, 80.0)), ((150.0, 80.0), (150.0, 168.0)), ((150.0, 168.0), (112.0, 178.0))]
    {
        sheet.dashed(from, to, sheet.thin());
    }
    sheet.dashed((112.0, 178.0), (112.0, 80.0), sheet.thin());
    sheet.double_arrow((66.0, 226.0), (130.0, 209.0));
    // Ends.
    sheet.line(&[(58.0, axis - 26.0), (58.0, 60.0)], sheet.thin());
    sheet.line(&[(142.0, axis - 62.0), (142.0, 60.0)], sheet.thin());
    sheet.variable_label((62.0, 51.0), Align2::CENTER_CENTER, 662);
    sheet.variable_label((142.0, 51.0), Align2::CENTER_CENTER, 663);
    sheet.dimension((46.0, 84.0), (58.0, 84.0));
    sheet.variable_label((42.0, 83.0), Align2::RIGHT_CENTER, 672);
    // Safe X, stock, diameters.
    sheet.line(&[(36.0, 196.0), (46.0, 196.0)], sheet.accent());
    sheet.variable_label((2.0, 195.0), Align2::LEFT_CENTER, 664);
    sheet.leader((198.0, 214.0), Align2::RIGHT_CENTER, 665, &[(180.0, 224.0), (180.0, 250.0), (136.0, 255.0)]);
    sheet.line(&[(14.0, axis - 26.0), (58.0, axis - 26.0)], sheet.thin());
    sheet.line(&[(14.0, axis + 26.0), (58.0, axis + 26.0)], sheet.thin());
    sheet.dimension((18.0, axis - 26.0), (18.0, axis + 26.0));
    sheet.variable_label((2.0, axis + 40.0), Align2::LEFT_CENTER, 660);
    sheet.line(&[(142.0, axis - 48.0), (192.0, axis - 48.0)], sheet.thin());
    sheet.line(&[(142.0, axis + 48.0), (192.0, axis + 48.0)], sheet.thin());
    sheet.dimension((188.0, axis - 48.0), (188.0, axis + 48.0));
    sheet.variable_label((198.0, axis + 26.0), Align2::RIGHT_CENTER, 661);
}
