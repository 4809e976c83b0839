//! Pictures of the table machines. Surface grinder: Y up, Z to the right, and below it the stroke along X. Rotary
//! table: Z up, X to the right.

use egui::{Align2, Color32, Rect, Stroke, pos2};

use crate::sheet::Sheet;

/// The magnetic chuck under the part.
fn magnet(sheet: &Sheet, from: f32, to: f32, top: f32) {
    sheet.block((from, top), (to, top + 14.0), sheet.theme.paper_muted);
}

/// The stroke along X, at the bottom: side view of the wheel over the part, from end to end.
fn stroke(sheet: &Sheet, ends: (u16, u16)) {
    sheet.cross((12.0, 392.0), "Y", "X");
    magnet(sheet, 66.0, 150.0, 372.0);
    sheet.section((78.0, 352.0), (138.0, 372.0));
    sheet.circle((54.0, 318.0), 28.0, sheet.theme.paper);
    sheet.painter.circle_filled(pos2(54.0, 318.0), 7.0, sheet.theme.paper_muted);
    sheet.painter.circle_stroke(pos2(162.0, 318.0), 28.0, sheet.thin());
    sheet.double_arrow((63.0, 318.0), (154.0, 318.0));
    sheet.dashed((54.0, 310.0), (54.0, 282.0), sheet.accent());
    sheet.dashed((162.0, 310.0), (162.0, 282.0), sheet.accent());
    sheet.variable_label((54.0, 274.0), Align2::CENTER_CENTER, ends.0);
    sheet.variable_label((162.0, 274.0), Align2::CENTER_CENTER, ends.1);
}

/// O1007: heights #680 and #681, safe #682, stroke #683 to #684, cross feed #685 to #686 in steps #691, finishing
/// allowance #687.
pub fn plane(sheet: &Sheet) {
    sheet.cross((12.0, 40.0), "Y", "Z");
    stroke(sheet, (683, 684));
    magnet(sheet, 44.0, 162.0, 242.0);
    sheet.section((56.0, 208.0), (150.0, 242.0));
    sheet.dashed_block((56.0, 188.0), (150.0, 208.0));
    sheet.dashed((56.0, 198.0), (150.0, 198.0), sheet.thin());
    sheet.wheel((36.0, 70.0), (72.0, 164.0));
    sheet.dashed_block((134.0, 70.0), (170.0, 164.0));
    sheet.double_arrow((78.0, 140.0), (128.0, 140.0));
    sheet.arrow((54.0, 166.0), (54.0, 184.0));
    sheet.dashed((36.0, 70.0), (36.0, 56.0), sheet.accent());
    sheet.dashed((134.0, 70.0), (134.0, 56.0), sheet.accent());
    sheet.variable_label((56.0, 47.0), Align2::CENTER_CENTER, 685);
    sheet.variable_label((134.0, 47.0), Align2::CENTER_CENTER, 686);
    sheet.dimension((86.0, 118.0), (112.0, 118.0));
    sheet.variable_label((99.0, 105.0), Align2::CENTER_CENTER, 691);
    sheet.line(&[(28.0, 164.0), (36.0, 164.0)], sheet.accent());
    sheet.variable_label((2.0, 172.0), Align2::LEFT_CENTER, 682);
    sheet.line(&[(150.0, 188.0), (194.0, 188.0)], sheet.thin());
    sheet.line(&[(162.0, 242.0), (194.0, 242.0)], sheet.thin());
    sheet.dimension((190.0, 188.0), (190.0, 242.0));
    sheet.variable_label((198.0, 176.0), Align2::RIGHT_CENTER, 680);
    sheet.line(&[(18.0, 208.0), (56.0, 208.0)], sheet.thin());
    sheet.line(&[(18.0, 242.0), (44.0, 242.0)], sheet.thin());
    sheet.dimension((22.0, 208.0), (22.0, 242.0));
    sheet.variable_label((2.0, 258.0), Align2::LEFT_CENTER, 681);
    sheet.leader((108.0, 170.0), Align2::CENTER_CENTER, 687, &[(108.0, 180.0), (108.0, 203.0)]);
}

/// O1008: a slot. Floor #700 and #701, safe #702, stroke #703 to #704, walls #705, #706 and #707, #708.
pub fn slot(sheet: &Sheet) {
    sheet.cross((12.0, 40.0), "Y", "Z");
    stroke(sheet, (703, 704));
    magnet(sheet, 30.0, 170.0, 242.0);
    let part = [
        (36.0, 150.0),
        (62.0, 150.0),
        (62.0, 214.0),
        (138.0, 214.0),
        (138.0, 150.0),
        (164.0, 150.0),
        (164.0, 242.0),
        (36.0, 242.0),
    ];
    for (from, to) in
        [((36.0, 150.0), (62.0, 242.0)), ((138.0, 150.0), (164.0, 242.0)), ((62.0, 214.0), (138.0, 242.0))]
    {
        sheet.hatch(Rect::from_min_max(pos2(from.0, from.1), pos2(to.0, to.1)), 9.0);
    }
    sheet.shape(&part, Color32::TRANSPARENT);
    sheet.dashed((70.0, 150.0), (70.0, 204.0), sheet.thin());
    sheet.dashed((130.0, 150.0), (130.0, 204.0), sheet.thin());
    sheet.dashed((70.0, 204.0), (130.0, 204.0), sheet.thin());
    sheet.wheel((82.0, 76.0), (118.0, 176.0));
    sheet.arrow((100.0, 178.0), (100.0, 198.0));
    sheet.arrow((80.0, 164.0), (72.0, 164.0));
    sheet.arrow((120.0, 164.0), (128.0, 164.0));
    sheet.leader((2.0, 92.0), Align2::LEFT_CENTER, 706, &[(36.0, 93.0), (62.0, 93.0), (62.0, 158.0)]);
    sheet.leader((2.0, 68.0), Align2::LEFT_CENTER, 705, &[(36.0, 69.0), (70.0, 69.0), (70.0, 158.0)]);
    sheet.leader((198.0, 92.0), Align2::RIGHT_CENTER, 708, &[(164.0, 93.0), (138.0, 93.0), (138.0, 158.0)]);
    sheet.leader((198.0, 68.0), Align2::RIGHT_CENTER, 707, &[(164.0, 69.0), (130.0, 69.0), (130.0, 158.0)]);
    sheet.line(&[(82.0, 76.0), (82.0, 40.0)], sheet.thin());
    sheet.variable_label((100.0, 32.0), Align2::CENTER_CENTER, 702);
    sheet.line(&[(100.0, 42.0), (100.0, 74.0)], sheet.accent());
    sheet.painter.circle_filled(pos2(100.0, 76.0), 2.2, sheet.theme.paper_accent);
    sheet.line(&[(70.0, 204.0), (14.0, 204.0)], sheet.thin());
    sheet.line(&[(30.0, 242.0), (14.0, 242.0)], sheet.thin());
    sheet.dimension((18.0, 204.0), (18.0, 242.0));
    sheet.variable_label((2.0, 190.0), Align2::LEFT_CENTER, 700);
    sheet.line(&[(138.0, 214.0), (188.0, 214.0)], sheet.thin());
    sheet.line(&[(170.0, 242.0), (188.0, 242.0)], sheet.thin());
    sheet.dimension((184.0, 214.0), (184.0, 242.0));
    sheet.variable_label((198.0, 202.0), Align2::RIGHT_CENTER, 701);
}

/// O1009: a step. Lower plane #720, #721 from #733, upper plane #725, #726 to #734, shoulder #727, #728, safe #722,
/// stroke #723 to #724.
pub fn step(sheet: &Sheet) {
    sheet.cross((12.0, 40.0), "Y", "Z");
    stroke(sheet, (723, 724));
    magnet(sheet, 42.0, 154.0, 242.0);
    let part = [(36.0, 218.0), (104.0, 218.0), (104.0, 166.0), (160.0, 166.0), (160.0, 242.0), (36.0, 242.0)];
    sheet.hatch(Rect::from_min_max(pos2(36.0, 218.0), pos2(104.0, 242.0)), 9.0);
    sheet.hatch(Rect::from_min_max(pos2(104.0, 166.0), pos2(160.0, 242.0)), 9.0);
    sheet.shape(&part, Color32::TRANSPARENT);
    sheet.dashed((36.0, 208.0), (94.0, 208.0), sheet.thin());
    sheet.dashed((94.0, 208.0), (94.0, 156.0), sheet.thin());
    sheet.dashed((94.0, 156.0), (160.0, 156.0), sheet.thin());
    sheet.wheel((52.0, 84.0), (84.0, 184.0));
    sheet.arrow((68.0, 186.0), (68.0, 204.0));
    sheet.arrow((86.0, 176.0), (93.0, 176.0));
    sheet.leader((118.0, 38.0), Align2::CENTER_CENTER, 727, &[(110.0, 48.0), (94.0, 70.0), (94.0, 164.0)]);
    sheet.leader((150.0, 70.0), Align2::CENTER_CENTER, 728, &[(132.0, 71.0), (104.0, 71.0), (104.0, 172.0)]);
    sheet.variable_label((68.0, 46.0), Align2::CENTER_CENTER, 722);
    sheet.line(&[(68.0, 56.0), (68.0, 82.0)], sheet.accent());
    sheet.painter.circle_filled(pos2(68.0, 84.0), 2.2, sheet.theme.paper_accent);
    // Outer edges.
    sheet.leader((2.0, 150.0), Align2::LEFT_CENTER, 733, &[(36.0, 151.0), (36.0, 216.0)]);
    sheet.leader((198.0, 118.0), Align2::RIGHT_CENTER, 734, &[(172.0, 128.0), (160.0, 138.0), (160.0, 164.0)]);
    // Heights.
    sheet.line(&[(8.0, 208.0), (36.0, 208.0)], sheet.thin());
    sheet.line(&[(8.0, 242.0), (42.0, 242.0)], sheet.thin());
    sheet.dimension((12.0, 208.0), (12.0, 242.0));
    sheet.variable_label((2.0, 196.0), Align2::LEFT_CENTER, 720);
    sheet.line(&[(24.0, 218.0), (36.0, 218.0)], sheet.thin());
    sheet.dimension((28.0, 218.0), (28.0, 242.0));
    sheet.variable_label((2.0, 258.0), Align2::LEFT_CENTER, 721);
    sheet.line(&[(160.0, 156.0), (196.0, 156.0)], sheet.thin());
    sheet.line(&[(160.0, 166.0), (182.0, 166.0)], sheet.thin());
    sheet.line(&[(154.0, 242.0), (196.0, 242.0)], sheet.thin());
    sheet.dimension((192.0, 156.0), (192.0, 242.0));
    sheet.dimension((178.0, 166.0), (178.0, 242.0));
    sheet.variable_label((198.0, 146.0), Align2::RIGHT_CENTER, 725);
    sheet.variable_label((198.0, 258.0), Align2::RIGHT_CENTER, 726);
}

/// O1010: a ring on the rotary table. Heights #740 and #741, safe #742, cross feed #743 to #744, finishing allowance
/// #745, table speed #750.
pub fn ring(sheet: &Sheet) {
    sheet.cross((12.0, 40.0), "Z", "X");
    let axis = 34.0;
    sheet.dashed((axis, 84.0), (axis, 392.0), Stroke::new(1.0, sheet.theme.paper_ink));
    sheet.block((14.0, 306.0), (184.0, 328.0), sheet.theme.paper_muted);
    sheet.section((66.0, 248.0), (164.0, 306.0));
    sheet.dashed_block((66.0, 228.0), (164.0, 248.0));
    sheet.dashed((66.0, 238.0), (164.0, 238.0), sheet.thin());
    // The wheel at the inner end, and dashed at the outer end.
    sheet.wheel((46.0, 100.0), (84.0, 196.0));
    sheet.dashed_block((146.0, 100.0), (184.0, 196.0));
    sheet.double_arrow((90.0, 172.0), (140.0, 172.0));
    sheet.arrow((65.0, 198.0), (65.0, 224.0));
    sheet.line(&[(46.0, 100.0), (46.0, 64.0)], sheet.thin());
    sheet.line(&[(146.0, 100.0), (146.0, 64.0)], sheet.thin());
    sheet.dimension((axis, 88.0), (46.0, 88.0));
    sheet.variable_label((66.0, 71.0), Align2::CENTER_CENTER, 743);
    sheet.dimension((axis, 76.0 - 18.0), (146.0, 76.0 - 18.0));
    sheet.line(&[(146.0, 64.0), (146.0, 52.0)], sheet.thin());
    sheet.line(&[(axis, 84.0), (axis, 52.0)], sheet.thin());
    sheet.variable_label((118.0, 45.0), Align2::CENTER_CENTER, 744);
    // Table.
    let turn: Vec<(f32, f32)> = (0..=20)
        .map(|step| {
            let angle = 0.1 + step as f32 * 0.14;
            (axis + 27.0 * angle.cos(), 346.0 + 11.0 * angle.sin())
        })
        .collect();
    sheet.line(&turn, sheet.ink());
    if let [.., before, last] = turn[..] {
        let (dx, dy) = (last.0 - before.0, last.1 - before.1);
        let length = dx.hypot(dy).max(0.1);
        sheet.arrow_head(last, (dx / length, dy / length), sheet.theme.paper_ink);
    }
    sheet.variable_label((70.0, 352.0), Align2::LEFT_CENTER, 750);
    // Heights.
    sheet.line(&[(164.0, 228.0), (196.0, 228.0)], sheet.thin());
    sheet.line(&[(184.0, 306.0), (196.0, 306.0)], sheet.thin());
    sheet.dimension((192.0, 228.0), (192.0, 306.0));
    sheet.variable_label((198.0, 216.0), Align2::RIGHT_CENTER, 740);
    sheet.line(&[(164.0, 248.0), (182.0, 248.0)], sheet.thin());
    sheet.dimension((176.0, 248.0), (176.0, 306.0));
    sheet.variable_label((198.0, 272.0), Align2::RIGHT_CENTER, 741);
    sheet.line(&[(40.0, 196.0), (46.0, 196.0)], sheet.accent());
    sheet.variable_label((2.0, 196.0), Align2::LEFT_CENTER, 742);
    sheet.leader((112.0, 208.0), Align2::CENTER_CENTER, 745, &[(112.0, 218.0), (112.0, 243.0)]);
}
