//! Painting of the scene: grid, part, tool path, actual path, wheel. The tool path is one mesh. It is rebuilt only when
//! drawing, plane, camera or canvas change. Pieces outside the canvas are left out.
//! Source: spec B6, H8 (16 ms a frame), H9.

use std::sync::Arc;

use egui::epaint::Mesh;
use egui::{Color32, Pos2, Rect, Shape, Stroke, pos2, vec2};

use super::scene::GraphicScene;
use super::{index, lathe, machine_position};
use crate::hmi::scene::{Camera, MachineScene, SceneCanvas, ViewPlane, add_quad};
use crate::hmi::{View, theme};
use crate::link::toolpath::{BoundingBox, CHUNK_POINTS, MoveKind, Toolpath};
use crate::units::Axis;

/// Maximum number of path lines per frame; above that a coarser level of detail is used.
const MAX_LINES: usize = 24_000;
/// Maximum error of the simplified path, pixels.
const MAX_ERROR_PX: f32 = 0.6;
/// Minimum distance of two grid lines, pixels.
const MIN_GRID_PX: f32 = 70.0;

/// Mesh of the tool path as last painted.
#[derive(Debug, Default)]
pub struct Canvas {
    of: Option<(Arc<Toolpath>, ViewPlane, Camera, Rect)>,
    mesh: Arc<Mesh>,
}

/// Bounding box of tool path, part and bar; without a drawing also of the actual path.
pub fn scene_bounds(
    view: &View<'_>,
    drawing: Option<&Arc<Toolpath>>,
    trail: &[[f32; 3]],
    plane: ViewPlane,
) -> BoundingBox {
    let mut all: Option<BoundingBox> = drawing.and_then(|drawing| drawing.bounding_box());
    let mut take = |low: [f32; 3], high: [f32; 3]| {
        let around = all.get_or_insert(BoundingBox { low, high });
        for axis in 0..3 {
            around.low[axis] = around.low[axis].min(low[axis]);
            around.high[axis] = around.high[axis].max(high[axis]);
        }
    };
    for stock in view.snapshot.stock.iter().filter(|stock| stock.is_workpiece) {
        take(stock.low.coordinates().map(|at| at as f32), stock.high.coordinates().map(|at| at as f32));
    }
    if let Some(scene) = MachineScene::of(view.snapshot) {
        let around = scene.bounds(plane);
        take(around.low, around.high);
    }
    if let Some(bar) = lathe::bar_bounds(view) {
        take(bar.low, bar.high);
    }
    if drawing.is_none() {
        trail.iter().for_each(|at| take(*at, *at));
    }
    // Without anything to show: a box of ±50 mm around the machine position.
    let here = machine_position(view.snapshot);
    all.unwrap_or(BoundingBox { low: here.map(|at| at - 50.0), high: here.map(|at| at + 50.0) })
}

impl Canvas {
    /// Paints everything into a clipped painter.
    pub fn paint(&mut self, rect: Rect, view: &View<'_>, scene: &GraphicScene<'_>) {
        grid_lines(rect, view, scene.camera);
        match MachineScene::of(view.snapshot) {
            Some(machine) => {
                let GraphicScene { plane, camera, .. } = *scene;
                SceneCanvas { scene: &machine, view, rect, plane, camera }.paint();
            }
            None => lathe::paint(rect, view, scene),
        }
        if let Some(drawing) = scene.drawing {
            let wanted = (Arc::clone(drawing), scene.plane, scene.camera, rect);
            let same = self.of.as_ref().is_some_and(|(drawn, plane, camera, place)| {
                Arc::ptr_eq(drawn, drawing) && (*plane, *camera, *place) == (scene.plane, scene.camera, rect)
            });
            if !same {
                self.mesh = Arc::new(path_mesh(drawing, scene, rect, view));
                self.of = Some(wanted);
            }
            view.painter.add(Shape::Mesh(Arc::clone(&self.mesh)));
        }
        paint_actual_path(rect, view, scene);
        if view.snapshot.kind.is_lathe() {
            paint_turning_tool(rect, view, scene);
        }
        grid_labels(rect, view, scene);
        paint_collisions(rect, view, scene);
        lathe::paint_measurements(rect, view, scene.camera, scene.measured_at);
    }
}

/// Smallest of 1, 2, 5 × 10ⁿ mm that is not below a length.
fn round_up(length: f32) -> f32 {
    let power = 10.0_f32.powf(length.max(1e-6).log10().floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|step| step * power).find(|step| *step >= length).unwrap_or(10.0 * power)
}

/// One line of the grid.
struct GridLine {
    vertical: bool,
    at: Pos2,
    value: f32,
}

/// The distance of the grid lines, mm, and the visible lines.
fn grid(rect: Rect, camera: Camera) -> (f32, Vec<GridLine>) {
    let step = round_up(MIN_GRID_PX / camera.scale);
    let [left, right, low, high] = camera.visible_mm(rect);
    let values = |from: f32, to: f32| {
        ((from / step).ceil() as i64..=(to / step).floor() as i64).map(move |number| number as f32 * step)
    };
    let upright =
        values(left, right).map(|value| GridLine { vertical: true, at: camera.to_canvas(rect, value, 0.0), value });
    let level =
        values(low, high).map(|value| GridLine { vertical: false, at: camera.to_canvas(rect, 0.0, value), value });
    (step, upright.chain(level).collect())
}

fn grid_lines(rect: Rect, view: &View<'_>, camera: Camera) {
    let (step, lines) = grid(rect, camera);
    for line in lines {
        let zero = line.value.abs() < step * 0.01;
        let stroke = Stroke::new(theme::HAIRLINE, if zero { view.theme.muted } else { view.theme.line });
        if line.vertical {
            view.painter.vline(line.at.x, rect.y_range(), stroke);
        } else {
            view.painter.hline(rect.x_range(), line.at.y, stroke);
        }
    }
}

/// Coordinates of the grid lines, above part and wheel.
fn grid_labels(rect: Rect, view: &View<'_>, scene: &GraphicScene<'_>) {
    let (step, lines) = grid(rect, scene.camera);
    let digits = if step >= 1.0 { 0 } else { (-step.log10()).ceil() as usize };
    let size = vec2(MIN_GRID_PX - 8.0, 16.0);
    for line in lines {
        let (axis, place) = if line.vertical {
            (scene.plane.0, Rect::from_min_size(pos2(line.at.x + 3.0, rect.max.y - 18.0), size))
        } else {
            (scene.plane.1, Rect::from_min_size(pos2(rect.min.x + 4.0, line.at.y - 17.0), size))
        };
        let room = if line.vertical {
            place.max.x < rect.max.x
        } else {
            place.min.y > rect.min.y && place.max.y < rect.max.y - 20.0
        };
        if room {
            let diameter = if axis == Axis::X && view.snapshot.x_as_diameter { 2.0 } else { 1.0 };
            view.line_left(place, &format!("{:.*}", digits, line.value * diameter), theme::SMALL, view.theme.muted);
        }
    }
}

/// The path as one mesh: the coarsest level of detail without a visible error, or a coarser one with few enough lines.
fn path_mesh(drawing: &Toolpath, scene: &GraphicScene<'_>, rect: Rect, view: &View<'_>) -> Mesh {
    let (right, up) = (index(scene.plane.0), index(scene.plane.1));
    let sight = scene.camera.visible_mm(rect);
    let seen = |piece: &BoundingBox| {
        piece.high[right] >= sight[0]
            && piece.low[right] <= sight[1]
            && piece.high[up] >= sight[2]
            && piece.low[up] <= sight[3]
    };
    let fine =
        drawing.levels.iter().rposition(|level| level.tolerance_mm * scene.camera.scale <= MAX_ERROR_PX).unwrap_or(0);
    let count =
        |level: usize| drawing.levels[level].chunk_boxes.iter().filter(|piece| seen(piece)).count() * CHUNK_POINTS;
    let chosen = (fine..drawing.levels.len()).find(|level| count(*level) <= MAX_LINES);
    let Some(level) = drawing.levels.get(chosen.unwrap_or(drawing.levels.len().saturating_sub(1))) else {
        return Mesh::default();
    };
    let mut mesh = Mesh::default();
    let colours = [view.theme.muted, view.theme.info];
    // A path too dense for every level of detail: pieces are skipped to keep the frame short.
    let visible: Vec<usize> = (0..level.chunk_boxes.len()).filter(|piece| seen(&level.chunk_boxes[*piece])).collect();
    let every = (visible.len() * CHUNK_POINTS / (2 * MAX_LINES)).max(1);
    for piece in visible.into_iter().step_by(every) {
        let first = piece * CHUNK_POINTS;
        for at in first..(first + CHUNK_POINTS).min(level.points.len()) {
            let point = level.points[at];
            let colour = match point.kind {
                MoveKind::Break => continue,
                MoveKind::Rapid => colours[0],
                MoveKind::Feed => colours[1],
            };
            let Some(before) = at.checked_sub(1).map(|before| level.points[before].at) else { continue };
            let (from, to) = (scene.place(rect, before), scene.place(rect, point.at));
            let width = if point.kind == MoveKind::Feed { 1.6 } else { 1.0 };
            if let Some((from, to)) = clipped(from, to, rect) {
                segment(&mut mesh, from, to, width, colour);
            }
        }
    }
    mesh
}

/// The part of a line inside a rectangle. A corner far outside would lose precision.
fn clipped(from: Pos2, to: Pos2, rect: Rect) -> Option<(Pos2, Pos2)> {
    let (way, mut begin, mut end) = (to - from, 0.0_f32, 1.0_f32);
    let sides = [
        (-way.x, from.x - rect.min.x),
        (way.x, rect.max.x - from.x),
        (-way.y, from.y - rect.min.y),
        (way.y, rect.max.y - from.y),
    ];
    for (slope, room) in sides {
        if slope.abs() < 1e-9 {
            if room < 0.0 {
                return None;
            }
        } else if slope < 0.0 {
            begin = begin.max(room / slope);
        } else {
            end = end.min(room / slope);
        }
    }
    (begin <= end).then(|| (from + way * begin, from + way * end))
}

/// A line as two triangles.
fn segment(mesh: &mut Mesh, from: Pos2, to: Pos2, width: f32, colour: Color32) {
    let way = to - from;
    let along = if way.length() < 0.01 { vec2(1.0, 0.0) } else { way.normalized() };
    let side = along.rot90() * (width / 2.0);
    let (from, to) = (from - along * 0.3, to + along * 0.3);
    add_quad(mesh, [from + side, to + side, to - side, from - side], colour);
}

/// Paints the actual path of the machine.
fn paint_actual_path(rect: Rect, view: &View<'_>, scene: &GraphicScene<'_>) {
    let mut mesh = Mesh::default();
    for pair in scene.actual_path.windows(2) {
        if let Some((from, to)) = clipped(scene.place(rect, pair[0]), scene.place(rect, pair[1]), rect) {
            segment(&mut mesh, from, to, 2.0, view.theme.run);
        }
    }
    view.painter.add(Shape::mesh(mesh));
}

/// Marks each collision of the check run with a cross (L9).
fn paint_collisions(rect: Rect, view: &View<'_>, scene: &GraphicScene<'_>) {
    let Some(drawing) = scene.drawing else { return };
    let stroke = Stroke::new(theme::FRAME, view.theme.alarm);
    for at in &drawing.crashes {
        let here = scene.place(rect, *at);
        if rect.contains(here) {
            view.painter.circle_stroke(here, 9.0, stroke);
            view.painter.line_segment([here - vec2(6.0, 6.0), here + vec2(6.0, 6.0)], stroke);
            view.painter.line_segment([here - vec2(6.0, -6.0), here + vec2(6.0, -6.0)], stroke);
        }
    }
}

/// Paints what moves in front of the path: the tool of a lathe. Without a bar it is its tip.
fn paint_turning_tool(rect: Rect, view: &View<'_>, scene: &GraphicScene<'_>) {
    let at = machine_position(view.snapshot);
    match lathe::work_area(view) {
        Some(_) => lathe::paint_tool(rect, view, scene.camera, at),
        None => drop(view.painter.circle_filled(scene.place(rect, at), 3.5, view.theme.hold)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn b6_lines_are_cut_at_the_canvas() {
        let rect = Rect::from_min_size(Pos2::ZERO, vec2(10.0, 10.0));
        assert_eq!(clipped(pos2(-5.0, 5.0), pos2(15.0, 5.0), rect), Some((pos2(0.0, 5.0), pos2(10.0, 5.0))));
        assert_eq!(clipped(pos2(-5.0, -5.0), pos2(15.0, -5.0), rect), None);
        assert_eq!(clipped(pos2(2.0, 2.0), pos2(3.0, 3.0), rect), Some((pos2(2.0, 2.0), pos2(3.0, 3.0))));
    }

    #[test]
    fn b6_the_grid_has_round_steps() {
        for (length, step) in [(0.7, 1.0), (1.2, 2.0), (3.0, 5.0), (60.0, 100.0), (0.013, 0.02)] {
            assert!((round_up(length) - step).abs() < step * 1e-4, "{length}: {}", round_up(length));
        }
    }
}
