//! Pictures of the dressing programs and of the dressing page.

use egui::{Align2, Rect, Stroke, StrokeKind, pos2, vec2};

use crate::sheet::Sheet;

/// The dressing page: the wheel over the diamond, and the dressing point with its machine coordinates X and Z.
pub fn dressing(sheet: &Sheet) {
    sheet.axes((12.0, 40.0));
    // The wheel seen from the rim, with its flanges and axis.
    let wheel = [(82.0, 58.0), (142.0, 58.0), (142.0, 206.0), (82.0, 206.0)];
    sheet.shape(&wheel, sheet.theme.paper);
    sheet.painter.rect_filled(
        Rect::from_center_size(pos2(112.0, 104.0), vec2(60.0, 28.0)),
        0.0,
        sheet.theme.paper_muted,
    );
    sheet.dashed((62.0, 104.0), (162.0, 104.0), sheet.thin());
    // The layer that dressing removes from the rim.
    sheet.hatch(Rect::from_min_max(pos2(83.0, 194.0), pos2(141.0, 205.0)), 6.0);
    sheet.dashed((82.0, 194.0), (142.0, 194.0), sheet.thin());
    // The diamond in its holder with foot.
    let tip = (82.0, 226.0);
    sheet.shape(&[tip, (90.0, 242.0), (74.0, 242.0)], sheet.theme.paper_accent);
    sheet.shape(&[(70.0, 242.0), (94.0, 242.0), (94.0, 318.0), (70.0, 318.0)], sheet.theme.paper);
    let foot = Rect::from_min_max(pos2(46.0, 318.0), pos2(118.0, 348.0));
    sheet.hatch(foot, 9.0);
    sheet.painter.rect_stroke(foot, 0.0, sheet.outline(), StrokeKind::Middle);
    sheet.dashed((82.0, 232.0), (82.0, 348.0), sheet.thin());
    // The wheel's corner moves down onto the diamond, then the diamond passes along the rim.
    let ink = sheet.theme.paper_ink;
    sheet.line(&[(160.0, 216.0), (104.0, 216.0)], Stroke::new(1.6, ink));
    sheet.arrow_head((98.0, 216.0), (-1.0, 0.0), ink);
    sheet.arrow_head((168.0, 216.0), (1.0, 0.0), ink);
    sheet.line(&[(112.0, 126.0), (112.0, 168.0)], Stroke::new(1.6, ink));
    sheet.arrow_head((112.0, 178.0), (0.0, 1.0), ink);
    // The dressing point: a target mark on the diamond, and its two coordinates.
    sheet.painter.circle_stroke(pos2(tip.0, tip.1), 9.0, sheet.accent());
    sheet.line(&[(20.0, tip.1), (tip.0 - 4.0, tip.1)], sheet.accent());
    sheet.line(&[(tip.0, tip.1 + 6.0), (tip.0, 374.0)], sheet.accent());
    sheet.dimension((30.0, 72.0), (30.0, tip.1));
    sheet.dimension((14.0, 368.0), (tip.0, 368.0));
    sheet.line(&[(24.0, 72.0), (36.0, 72.0)], sheet.accent());
    sheet.line(&[(14.0, 362.0), (14.0, 374.0)], sheet.accent());
    sheet.letter((30.0, 150.0), "X");
    sheet.letter((46.0, 384.0), "Z");
}

/// A diamond in its holder, with its tip at `tip`.
fn diamond(sheet: &Sheet, tip: (f32, f32)) {
    let (x, y) = tip;
    sheet.shape(&[tip, (x + 8.0, y + 16.0), (x - 8.0, y + 16.0)], sheet.theme.paper_accent);
    sheet.shape(
        &[(x - 12.0, y + 16.0), (x + 12.0, y + 16.0), (x + 12.0, y + 76.0), (x - 12.0, y + 76.0)],
        sheet.theme.paper,
    );
    let foot = Rect::from_min_max(pos2(x - 36.0, y + 76.0), pos2(x + 36.0, y + 100.0));
    sheet.hatch(foot, 9.0);
    sheet.painter.rect_stroke(foot, 0.0, sheet.outline(), StrokeKind::Middle);
}

/// Straight dressing: rough and fine depth on the rim, and the overrun beyond the wheel.
fn rim_depths(sheet: &Sheet, numbers: (u16, u16, u16)) {
    let (rough, fine, beyond) = numbers;
    sheet.wheel((84.0, 70.0), (144.0, 210.0));
    sheet.hatch(Rect::from_min_max(pos2(85.0, 190.0), pos2(143.0, 209.0)), 6.0);
    sheet.dashed((84.0, 190.0), (144.0, 190.0), sheet.thin());
    sheet.dashed((84.0, 196.0), (144.0, 196.0), sheet.thin());
    sheet.double_arrow((74.0, 226.0), (156.0, 226.0));
    sheet.arrow((114.0, 132.0), (114.0, 178.0));
    sheet.leader((198.0, 150.0), Align2::RIGHT_CENTER, rough, &[(176.0, 160.0), (160.0, 203.0), (138.0, 203.0)]);
    sheet.leader((2.0, 160.0), Align2::LEFT_CENTER, fine, &[(37.0, 161.0), (92.0, 193.0)]);
    sheet.line(&[(144.0, 210.0), (144.0, 256.0)], sheet.thin());
    sheet.line(&[(162.0, 218.0), (162.0, 256.0)], sheet.thin());
    sheet.dimension((144.0, 250.0), (162.0, 250.0));
    sheet.variable_label((166.0, 249.0), Align2::LEFT_CENTER, beyond);
}

/// The position of the diamond in machine coordinates: a target mark and its two variables.
fn dressing_point(sheet: &Sheet, tip: (f32, f32), numbers: (u16, u16)) {
    sheet.painter.circle_stroke(pos2(tip.0, tip.1), 9.0, sheet.accent());
    sheet.line(&[(14.0, tip.1), (tip.0 - 4.0, tip.1)], sheet.accent());
    sheet.line(&[(tip.0, tip.1 + 6.0), (tip.0, 384.0)], sheet.accent());
    sheet.variable_label((2.0, tip.1 - 14.0), Align2::LEFT_CENTER, numbers.0);
    sheet.variable_label((tip.0 + 6.0, 386.0), Align2::LEFT_CENTER, numbers.1);
}

/// O1011: straight. Diamond #760 and #761, depths #763 and #765, overrun #769.
pub fn straight(sheet: &Sheet) {
    sheet.axes((12.0, 40.0));
    diamond(sheet, (66.0, 240.0));
    rim_depths(sheet, (763, 765, 769));
    dressing_point(sheet, (66.0, 240.0), (760, 761));
}

/// O1014: the same on the rotary table, Z up and X to the right.
pub fn rotary(sheet: &Sheet) {
    sheet.cross((12.0, 40.0), "Z", "X");
    diamond(sheet, (66.0, 240.0));
    rim_depths(sheet, (822, 824, 827));
    dressing_point(sheet, (66.0, 240.0), (821, 820));
}

/// O1012: a profile. Left corner radius #780, right corner chamfer #781 with the angle #782, taper #783, layers #784
/// and #785 from the highest point.
pub fn profile(sheet: &Sheet) {
    sheet.axes((12.0, 40.0));
    diamond(sheet, (52.0, 262.0));
    let mut wheel = vec![(64.0, 64.0), (148.0, 64.0), (148.0, 190.0), (122.0, 214.0), (94.0, 214.0)];
    wheel.extend((1..=8).map(|step| {
        let angle = step as f32 / 8.0 * std::f32::consts::FRAC_PI_2;
        (94.0 - 30.0 * angle.sin(), 184.0 + 30.0 * angle.cos())
    }));
    sheet.shape(&wheel, sheet.theme.paper);
    let hub = Rect::from_min_max(pos2(64.0, 86.0), pos2(148.0, 108.0));
    sheet.painter.rect_filled(hub, 0.0, sheet.theme.paper_muted);
    sheet.dashed((50.0, 97.0), (162.0, 97.0), sheet.thin());
    // The profile before dressing.
    sheet.dashed((64.0, 184.0), (64.0, 222.0), sheet.thin());
    sheet.dashed((64.0, 222.0), (148.0, 222.0), sheet.thin());
    sheet.dashed((148.0, 222.0), (148.0, 190.0), sheet.thin());
    // The path of the diamond along the profile.
    let mut way = vec![(48.0, 196.0), (54.0, 196.0)];
    way.extend((1..=8).map(|step| {
        let angle = std::f32::consts::FRAC_PI_2 * (1.0 - step as f32 / 8.0);
        (94.0 - 40.0 * angle.sin(), 196.0 + 40.0 * angle.cos())
    }));
    way.extend([(126.0, 236.0), (164.0, 202.0)]);
    sheet.line(&way, sheet.ink());
    sheet.arrow_head((168.0, 198.0), (0.74, -0.67), sheet.theme.paper_ink);
    // Radius, chamfer, angle, taper.
    sheet.leader((2.0, 150.0), Align2::LEFT_CENTER, 780, &[(37.0, 151.0), (94.0, 184.0), (73.0, 205.0)]);
    sheet.line(&[(122.0, 214.0), (122.0, 134.0)], sheet.thin());
    sheet.line(&[(148.0, 190.0), (148.0, 134.0)], sheet.thin());
    sheet.dimension((122.0, 142.0), (148.0, 142.0));
    sheet.variable_label((154.0, 141.0), Align2::LEFT_CENTER, 781);
    sheet.leader((198.0, 166.0), Align2::RIGHT_CENTER, 782, &[(180.0, 176.0), (180.0, 204.0), (140.0, 204.0)]);
    sheet.variable_label((106.0, 166.0), Align2::CENTER_CENTER, 783);
    sheet.line(&[(106.0, 176.0), (106.0, 212.0)], sheet.accent());
    sheet.painter.circle_filled(pos2(106.0, 213.0), 2.2, sheet.theme.paper_accent);
    sheet.leader((150.0, 268.0), Align2::LEFT_CENTER, 785, &[(148.0, 268.0), (116.0, 268.0), (116.0, 218.0)]);
    sheet.leader((150.0, 292.0), Align2::LEFT_CENTER, 784, &[(148.0, 292.0), (78.0, 292.0), (70.0, 216.0)]);
    dressing_point(sheet, (52.0, 262.0), (760, 761));
}

/// O1013: the roll of the surface grinder. Roll position #800 and #801, contact #802, depth #803 at the speed #804.
pub fn roll(sheet: &Sheet) {
    sheet.cross((12.0, 40.0), "Y", "X");
    let (wheel, roll) = ((100.0, 132.0), (100.0, 272.0));
    sheet.circle(wheel, 78.0, sheet.theme.paper);
    sheet.painter.circle_stroke(pos2(wheel.0, wheel.1), 70.0, sheet.thin());
    sheet.painter.circle_filled(pos2(wheel.0, wheel.1), 12.0, sheet.theme.paper_muted);
    sheet.circle(roll, 54.0, sheet.theme.paper);
    sheet.painter.circle_filled(pos2(roll.0, roll.1), 8.0, sheet.theme.paper_accent);
    sheet.block((70.0, 330.0), (130.0, 352.0), sheet.theme.paper_muted);
    sheet.arrow((100.0, 150.0), (100.0, 192.0));
    sheet.leader((198.0, 172.0), Align2::RIGHT_CENTER, 804, &[(163.0, 173.0), (104.0, 173.0)]);
    sheet.line(&[(12.0, 210.0), (100.0, 210.0)], sheet.accent());
    sheet.variable_label((2.0, 226.0), Align2::LEFT_CENTER, 802);
    sheet.leader((198.0, 232.0), Align2::RIGHT_CENTER, 803, &[(163.0, 232.0), (112.0, 206.0)]);
    sheet.line(&[(100.0, 282.0), (100.0, 384.0)], sheet.accent());
    sheet.variable_label((106.0, 374.0), Align2::LEFT_CENTER, 800);
    sheet.leader((198.0, 300.0), Align2::RIGHT_CENTER, 801, &[(163.0, 300.0), (138.0, 290.0)]);
}
