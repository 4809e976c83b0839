//! Lathe scene in the drawing: bar as it is cut, chuck, active tool, and diameters and lengths measured by touch.
//! Source: spec L9 (live while cutting), L10 (a finished part can be measured).

use egui::epaint::Mesh;
use egui::{Pos2, Rect, Shape, Stroke, StrokeKind, pos2, vec2};

use super::scene::GraphicScene;
use crate::defs::lathe_workspace::LatheWorkspace;
use crate::hmi::scene::{Camera, add_quad};
use crate::hmi::{View, theme};
use crate::link::toolpath::BoundingBox;
use crate::units::Axis;

/// Length of the shank drawn above the tip, mm.
const SHANK_MM: f32 = 40.0;
/// Cells whose radii differ by less are one step of the outline, mm.
const SAME_MM: f32 = 0.000_5;

/// Working area of the simulated lathe.
pub fn work_area<'a>(view: &'a View<'_>) -> Option<&'a LatheWorkspace> {
    view.snapshot.simulated.as_deref()?.lathe_workspace.as_ref()
}

/// Offset from part to work coordinates, X and Z, mm.
fn work_from_part(view: &View<'_>, room: &LatheWorkspace) -> (f32, f32) {
    let minus = |axis: Axis| {
        let factor = if axis == Axis::X && view.snapshot.x_as_diameter { 2.0 } else { 1.0 };
        let state = &view.snapshot.axes[axis];
        ((state.machine - state.work) / factor) as f32
    };
    (room.zero_mm.0 - minus(Axis::X), room.zero_mm.1 - minus(Axis::Z))
}

/// Bounding box of the bar, mm, work coordinates.
pub fn bar_bounds(view: &View<'_>) -> Option<BoundingBox> {
    let room = work_area(view)?;
    let (x, z) = work_from_part(view, room);
    let end = room.chuck_face_z_mm + room.cell_mm * room.radius_mm.len() as f32;
    let (radius, chuck) = (room.stock_radius_mm, z + room.chuck_face_z_mm);
    Some(BoundingBox { low: [x - radius, 0.0, chuck - 10.0], high: [x + radius, 0.0, z + end] })
}

/// Paints bar and chuck.
pub fn paint(rect: Rect, view: &View<'_>, scene: &GraphicScene<'_>) {
    let Some(room) = work_area(view) else { return };
    let (x, z) = work_from_part(view, room);
    let at = |along: f32, up: f32| scene.camera.to_canvas(rect, z + along, x + up);
    let both = |from: f32, to: f32, radius: f32| Rect::from_two_pos(at(from, -radius), at(to, radius));
    for (from, to, radius) in &room.bodies {
        let place = both(*from, *to, *radius);
        view.painter.rect_filled(place, 0.0, view.theme.raised);
        view.painter.rect_stroke(place, 0.0, Stroke::new(theme::FRAME, view.theme.muted), StrokeKind::Inside);
    }
    let end = room.chuck_face_z_mm + room.cell_mm * room.radius_mm.len() as f32;
    // Outline of the original bar, as a hairline.
    let stock = both(room.chuck_face_z_mm, end, room.stock_radius_mm);
    view.painter.rect_stroke(stock, 0.0, Stroke::new(theme::HAIRLINE, view.theme.line), StrokeKind::Inside);
    let fill = view.theme.muted.gamma_multiply(0.45);
    let mut mesh = Mesh::default();
    let (mut upper, mut lower): (Vec<Pos2>, Vec<Pos2>) = (Vec::new(), Vec::new());
    let mut first = 0;
    while first < room.radius_mm.len() {
        let radius = room.radius_mm[first];
        let same = room.radius_mm[first..].iter().take_while(|other| (**other - radius).abs() < SAME_MM).count();
        let place = |cell: usize| room.chuck_face_z_mm + room.cell_mm * cell as f32;
        let (from, to) = (place(first), place(first + same));
        let cell = both(from, to, radius);
        let corners = [cell.left_top(), cell.right_top(), cell.right_bottom(), cell.left_bottom()];
        add_quad(&mut mesh, corners, fill);
        upper.extend([at(from, radius), at(to, radius)]);
        lower.extend([at(from, -radius), at(to, -radius)]);
        first += same;
    }
    lower.reverse();
    upper.extend(lower);
    view.painter.add(Shape::mesh(mesh));
    view.painter.add(Shape::closed_line(upper, Stroke::new(theme::FRAME, view.theme.text)));
    let axis = Stroke::new(theme::HAIRLINE, view.theme.info);
    view.painter.line_segment([at(room.chuck_face_z_mm, 0.0), at(end + 5.0, 0.0)], axis);
}

/// Paints the active tool; `slides` is the position of the slides.
pub fn paint_tool(rect: Rect, view: &View<'_>, camera: Camera, slides: [f32; 3]) {
    let Some(room) = work_area(view) else { return };
    let (x, z) = (slides[Axis::X as usize] + room.tip_mm.0, slides[Axis::Z as usize] + room.tip_mm.1);
    let at = |along: f32, over: f32| camera.to_canvas(rect, z + along, x + over);
    let ink = view.theme.hold;
    for pair in room.outline_mm.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        let corners = vec![at(a.0, a.1), at(b.0, b.1), at(b.0, SHANK_MM), at(a.0, SHANK_MM)];
        view.painter.add(Shape::convex_polygon(corners, ink.gamma_multiply(0.25), Stroke::NONE));
    }
    let mut outline: Vec<Pos2> = room.outline_mm.iter().map(|point| at(point.0, point.1)).collect();
    if let (Some(first), Some(last)) = (room.outline_mm.first(), room.outline_mm.last()) {
        outline.insert(0, at(first.0, SHANK_MM));
        outline.push(at(last.0, SHANK_MM));
    }
    view.painter.add(Shape::line(outline, Stroke::new(theme::FRAME, ink)));
    view.painter.circle_filled(at(0.0, 0.0), 3.0, ink);
}

/// Diameter of the bar at a Z position, mm, work coordinates; none beside the bar.
pub fn diameter_at(view: &View<'_>, along: f32) -> Option<f32> {
    let room = work_area(view)?;
    let cell = (along - work_from_part(view, room).1 - room.chuck_face_z_mm) / room.cell_mm;
    (cell >= 0.0).then(|| room.radius_mm.get(cell as usize).map(|radius| 2.0 * radius)).flatten()
}

/// Paints the measured positions: the diameter at each, and their distance.
pub fn paint_measurements(rect: Rect, view: &View<'_>, camera: Camera, places: &[f32]) {
    let Some(room) = work_area(view) else { return };
    let x = work_from_part(view, room).0;
    let ink = view.theme.focus;
    let label = |corner: Pos2, words: &str| {
        let wide = 12.0 + words.chars().count() as f32 * 9.0;
        let corner = pos2(corner.x.min(rect.max.x - wide - 2.0).max(rect.min.x + 2.0), corner.y);
        let place = Rect::from_min_size(corner, vec2(wide, 24.0));
        view.painter.rect_filled(place, theme::RADIUS, view.theme.background);
        view.painter.rect_stroke(place, theme::RADIUS, Stroke::new(theme::HAIRLINE, ink), StrokeKind::Inside);
        view.line_centre(place, words, theme::LABEL, view.theme.text);
    };
    for (index, along) in places.iter().enumerate() {
        let diameter = diameter_at(view, *along);
        let radius = diameter.unwrap_or(2.0 * room.stock_radius_mm) / 2.0;
        let (top, foot) = (camera.to_canvas(rect, *along, x + radius), camera.to_canvas(rect, *along, x - radius));
        view.painter.line_segment([top - vec2(0.0, 14.0), foot + vec2(0.0, 14.0)], Stroke::new(theme::FRAME, ink));
        let z = view.length(f64::from(*along));
        let words = diameter.map_or_else(|| format!("Z{z}"), |d| format!("Ø{} Z{z}", view.length(f64::from(d))));
        let above = top.y - 42.0 - 28.0 * index as f32;
        label(pos2(top.x + 4.0, above.max(rect.min.y + 2.0)), &words);
    }
    if let [a, b] = places {
        let below = camera.to_canvas(rect, *a, x - room.stock_radius_mm).y + 26.0;
        let (from, to) = (camera.to_canvas(rect, *a, 0.0).x, camera.to_canvas(rect, *b, 0.0).x);
        view.painter.hline(from.min(to)..=from.max(to), below, Stroke::new(theme::FRAME, ink));
        let length = view.length(f64::from((b - a).abs()));
        label(pos2(f32::midpoint(from, to) - 40.0, below + 4.0), &format!("L {length}"));
    }
}
