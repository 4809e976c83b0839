//! Drawing: tool path from a check run, part, wheel and actual path, with zoom by fingers, wheel or keys. Extents and
//! time are shown before the first cycle start.
//! Source: spec B6 (图形), H8, H9.

mod lathe;
mod paint;
mod scene;

use std::sync::Arc;

use egui::{Id, Rect, Sense, Vec2, pos2, vec2};

use super::{PageContext, PageUi, empty};
use crate::defs::text::Text;
use crate::hmi::scene::{Camera, MachineScene, Magnifier, ViewPlane};
use crate::hmi::{
    Area, EditKey, KeyboardFocus, KeyboardInput, PageKey, PendingRequests, View, file_command, page_frame as lines,
    theme, widget,
};
use crate::link::files::{FileRequest, Requester};
use crate::link::snapshot::RunState;
use crate::link::toolpath::{CycleTime, Toolpath};
use crate::link::{Command, Snapshot};
use crate::units::{Axis, Micros};
use paint::Canvas;
use scene::GraphicScene;

/// Width of the figures beside the drawing.
const FIGURES_WIDTH: f32 = 196.0;
/// Height of the magnifier below the figures.
const MAGNIFIER_HEIGHT: f32 = 190.0;
/// Maximum number of points of the actual path; when full, every second point is removed.
const MAX_PATH_POINTS: usize = 8_000;
/// Time between two points of the actual path.
const PATH_PERIOD: Micros = Micros::from_millis(30);
/// Seconds after which an unanswered request is repeated.
const RETRY_SECONDS: f64 = 1.0;
/// Zoom factor of a key press.
const ZOOM_STEP: f32 = 1.5;
/// Pan distance of a key press, as a share of the canvas.
const PAN_STEP: f32 = 0.15;

/// State of the page.
#[derive(Debug, Default)]
pub struct GraphicPage {
    camera: Option<Camera>,
    plane: usize,
    canvas: Canvas,
    /// Program and text stamp of the last request, and its time in s.
    last_request: Option<((u32, u64), f64)>,
    asking: PendingRequests<()>,
    /// Actual path X Y Z, mm, work coordinates, X as radius.
    actual_path: Vec<[f32; 3]>,
    /// Period of the clock in which the machine position was looked at last.
    last_period: u64,
    /// Touched Z positions to measure, mm, two at most (L10).
    measured_at: Vec<f32>,
    walk: KeyboardFocus,
}

const fn index(axis: Axis) -> usize {
    axis as usize
}

impl PageUi for GraphicPage {
    fn record(&mut self, snapshot: &Snapshot) {
        // One point in each period of the clock, however many snapshots or frames it has.
        let period = snapshot.now.0 / PATH_PERIOD.0;
        if std::mem::replace(&mut self.last_period, period) == period {
            return;
        }
        let at = machine_position(snapshot);
        let running = snapshot.state == RunState::Running;
        let moved = self.actual_path.last().is_none_or(|last| (0..3).any(|axis| (last[axis] - at[axis]).abs() > 5e-4));
        if !running || !moved {
            return;
        }
        if self.actual_path.len() >= MAX_PATH_POINTS {
            let mut keep = false;
            self.actual_path.retain(|_| {
                keep = !keep;
                keep
            });
        }
        self.actual_path.push(at);
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        let PageContext { rect, view, typed, out, .. } = ctx;
        let program = &view.snapshot.program;
        if program.number == 0 {
            return empty::no_program(view, rect);
        }
        let drawing = view.snapshot.files.toolpath.as_ref().filter(|drawing| drawing.number == program.number);
        let fresh = drawing.is_some_and(|drawing| drawing.stamp == program.stamp);
        let wanted = (program.number, program.stamp);
        let now = view.ui.input(|input| input.time);
        while self.asking.poll(Requester::Graphic, &view.snapshot.files).is_some() {}
        // An unanswered request is repeated; a refused or cancelled one is not.
        let due = self
            .last_request
            .is_none_or(|(of, when)| of != wanted || self.asking.is_waiting() && now - when > RETRY_SECONDS);
        if !fresh && due && view.snapshot.files.busy.is_none() {
            self.request_drawing(wanted, now, out);
        }
        let (title, rest) = rect.shrink2(vec2(theme::PAD, 6.0)).split_top(32.0);
        let (body, keys) = rest.split_bottom(widget::KEYS_HEIGHT);
        let (canvas, figures) = body.trim_bottom(theme::GAP).split_right(FIGURES_WIDTH);
        let canvas = canvas.trim_right(theme::GAP);
        let planes = view.snapshot.kind.ui().drawing_planes;
        let plane = planes[self.plane % planes.len()];
        let words = format!("{} · {}{}", view.snapshot.title(program.number), plane.0.letter(), plane.1.letter());
        lines::title(view, title, &words);
        self.canvas(canvas, view, drawing, plane, typed);
        let magnifier = MachineScene::of(view.snapshot).and_then(|scene| Magnifier::of(&scene, view.snapshot));
        let (figures, contact) = figures.split_bottom(if magnifier.is_some() { MAGNIFIER_HEIGHT } else { 0.0 });
        if let Some(magnifier) = magnifier {
            magnifier.paint(contact.trim_top(theme::GAP), view);
        }
        path_figures(figures, view, drawing, fresh);
        self.keys(keys, view, &typed.edits, out);
        if let Some((what, share)) = view.snapshot.files.busy {
            progress(canvas, view, what, share);
        }
    }
}

impl GraphicPage {
    fn request_drawing(&mut self, wanted: (u32, u64), now: f64, out: &mut Vec<Command>) {
        self.last_request = Some((wanted, now));
        out.push(self.asking.send(Requester::Graphic, (), FileRequest::ComputeToolpath(wanted.0)));
    }

    fn canvas(
        &mut self,
        rect: Rect,
        view: &View<'_>,
        drawing: Option<&Arc<Toolpath>>,
        plane: ViewPlane,
        typed: &KeyboardInput,
    ) {
        view.card(rect);
        let inside = rect.shrink(2.0);
        let whole = paint::scene_bounds(view, drawing, &self.actual_path, plane);
        let camera = *self.camera.get_or_insert_with(|| Camera::fit(whole, plane, inside));
        let mut camera = if camera.fitted { Camera::fit(whole, plane, inside) } else { camera };
        let response =
            view.ui.interact(inside, Id::unique("graphic-canvas"), Sense::CLICK | Sense::DRAG | Sense::HOVER);
        response.widget_info(|| egui::WidgetInfo::labeled(egui::accesskit::Role::Canvas, true, "图形 graphic-canvas"));
        let at = view.ui.input(|input| input.pointer.hover_pos()).filter(|at| inside.contains(*at));
        let drag = widget::drag_delta(&response);
        if drag != Vec2::ZERO {
            camera.pan(drag);
        }
        if let Some(at) = at {
            camera.zoom(view.zoom_factor(), at - inside.center());
        }
        if let Some(at) =
            response.interact_pointer_pos().filter(|_| response.clicked() && lathe::work_area(view).is_some())
        {
            if self.measured_at.len() == 2 {
                self.measured_at.clear();
            }
            self.measured_at.push(camera.right_at(inside, at));
        }
        move_camera(&mut camera, inside, typed);
        if typed.text.contains(['f', 'F']) {
            camera = Camera::fit(whole, plane, inside);
        }
        self.camera = Some(camera);
        let view = &view.clipped(inside);
        let scene =
            GraphicScene { drawing, plane, camera, actual_path: &self.actual_path, measured_at: &self.measured_at };
        self.canvas.paint(inside, view, &scene);
    }

    fn keys(&mut self, rect: Rect, view: &View<'_>, edits: &[EditKey], out: &mut Vec<Command>) {
        // The arrow keys pan the drawing, so Tab moves over the keys.
        let walks = |edit: &EditKey| matches!(edit, EditKey::Next | EditKey::Previous | EditKey::Enter);
        self.walk.begin_frame(&edits.iter().copied().filter(walks).collect::<Vec<_>>());
        let several = view.snapshot.kind.ui().drawing_planes.len() > 1;
        let busy = view.snapshot.files.busy.is_some();
        let keys = [
            ("graphic-fit", view.text("适合", "FIT"), true),
            ("graphic-in", view.text("放大 +", "ZOOM +"), true),
            ("graphic-out", view.text("缩小 -", "ZOOM -"), true),
            ("graphic-plane", view.text("平面", "PLANE"), several),
            ("graphic-clear", view.text("清轨迹", "CLEAR"), true),
            ("graphic-redraw", view.text("重算", "REDRAW"), !busy),
            ("graphic-stop", view.text("取消", "CANCEL"), busy),
        ];
        let shown: Vec<_> = keys.into_iter().filter(|(.., shown)| *shown).collect();
        let drawn: Vec<_> = shown.iter().map(|(name, label, _)| PageKey::new(name, label)).collect();
        let Some(touched) = self.walk.keys(view, rect, &drawn) else { return };
        match shown[touched].0 {
            "graphic-fit" => self.camera = None,
            "graphic-in" => self.camera.iter_mut().for_each(|camera| camera.zoom(ZOOM_STEP, Vec2::ZERO)),
            "graphic-out" => self.camera.iter_mut().for_each(|camera| camera.zoom(1.0 / ZOOM_STEP, Vec2::ZERO)),
            "graphic-plane" => (self.plane, self.camera) = (self.plane + 1, None),
            "graphic-clear" => {
                self.actual_path.clear();
                self.measured_at.clear();
            }
            "graphic-redraw" => {
                let wanted = (view.snapshot.program.number, view.snapshot.program.stamp);
                self.request_drawing(wanted, view.ui.input(|input| input.time), out);
            }
            _ => out.push(file_command(Requester::Graphic, FileRequest::Cancel)),
        }
        view.ui.ctx().request_repaint();
    }
}

/// Pans with the arrow keys, zooms with + and - and by pages.
fn move_camera(camera: &mut Camera, canvas: Rect, typed: &KeyboardInput) {
    for edit in &typed.edits {
        match edit {
            EditKey::Left => camera.pan(vec2(PAN_STEP * canvas.width(), 0.0)),
            EditKey::Right => camera.pan(vec2(-PAN_STEP * canvas.width(), 0.0)),
            EditKey::Up => camera.pan(vec2(0.0, PAN_STEP * canvas.height())),
            EditKey::Down => camera.pan(vec2(0.0, -PAN_STEP * canvas.height())),
            EditKey::Sign => camera.zoom(1.0 / ZOOM_STEP, Vec2::ZERO),
            _ => {}
        }
    }
    for _ in typed.text.matches(['+', '=']) {
        camera.zoom(ZOOM_STEP, Vec2::ZERO);
    }
    camera.zoom(ZOOM_STEP.powi(-typed.scroll_pages), Vec2::ZERO);
}

/// Position of the wheel's reference point: X Y Z, mm, X as radius, work coordinates.
fn machine_position(snapshot: &Snapshot) -> [f32; 3] {
    Axis::ALL.map(|axis| {
        let halved = if axis == Axis::X && snapshot.x_as_diameter { 2.0 } else { 1.0 };
        (snapshot.axes[axis].work / halved) as f32
    })
}

/// Hours, minutes and seconds.
fn duration(seconds: f64) -> String {
    let whole = seconds.round().max(0.0) as u64;
    format!("{:02}:{:02}:{:02}", whole / 3_600, whole / 60 % 60, whole % 60)
}

/// What the time is.
const fn time_label(time: CycleTime) -> Text {
    match time {
        CycleTime::Simulated(_) => Text::new("循环时间", "cycle time"),
        CycleTime::AtFeeds(_) => Text::new("进给时间", "feed time"),
    }
}

/// Time, distance, extents, errors.
fn path_figures(rect: Rect, view: &View<'_>, drawing: Option<&Arc<Toolpath>>, fresh: bool) {
    view.card(rect);
    let inside = rect.shrink2(vec2(10.0, 8.0));
    let Some(drawing) = drawing else {
        return view.note(inside, view.text("还没有轨迹", "no path yet"));
    };
    let mut rows = vec![
        (time_label(drawing.cycle_time).get(view.lang).to_owned(), duration(drawing.cycle_time.seconds())),
        (view.text("行程 m", "length m").to_owned(), format!("{:.2}", drawing.length_mm / 1_000.0)),
        (view.text("行数", "lines").to_owned(), drawing.lines.to_string()),
    ];
    if let Some((low, high)) = drawing.extents {
        for axis in view.axes() {
            let factor = if axis == Axis::X && view.snapshot.x_as_diameter { 2.0 } else { 1.0 };
            rows.push((format!("{} {}", axis.letter(), view.text("最小", "min")), view.length(low[axis] * factor)));
            rows.push((format!("{} {}", axis.letter(), view.text("最大", "max")), view.length(high[axis] * factor)));
        }
    }
    let mut top = inside.min.y;
    for (name, value) in rows {
        let line = Rect::from_min_size(pos2(inside.min.x, top), vec2(inside.width(), 25.0));
        let (left, right) = line.split_left_right_at_fraction(0.42);
        view.fit_left(left, &name, theme::LABEL, view.theme.muted);
        view.fit_right(right, &value, theme::LABEL, view.theme.text);
        top += 25.0;
    }
    if lathe::work_area(view).is_some() {
        let words = view.text("触摸工件：量直径和长度", "touch the part: diameter, length");
        top = view.paragraph(inside.with_min_y(top + 4.0), words, theme::SMALL, view.theme.muted).max.y;
    }
    let below = inside.with_min_y(top + 6.0);
    let (words, ink) = if let Some(fault) = drawing.faults.first() {
        let more = drawing.faults.len() - 1;
        let more = if more > 0 { format!(" (+{more})") } else { String::new() };
        let line = view.text("行", "line");
        (format!("{line} {}: {}{more}", fault.line, fault.message.get(view.lang)), view.theme.alarm_text)
    } else if !fresh {
        (view.text("程序已改动，请重算", "the program was changed: redraw").to_owned(), view.theme.hold)
    } else if !drawing.finished {
        let words = view.text("未到程序结束：太长或循环等待", "program end not reached: too long, or a waiting loop");
        (words.to_owned(), view.theme.hold)
    } else {
        (view.text("检查无错误", "checked: no errors").to_owned(), view.theme.run)
    };
    view.paragraph(below, &words, theme::LABEL, ink);
}

/// Progress bar over the drawing while a path is computed.
fn progress(rect: Rect, view: &View<'_>, what: Text, share: u16) {
    let place = Rect::from_center_size(rect.center(), vec2(340.0_f32.min(rect.width() - 24.0), 74.0));
    view.filled_card(place, view.theme.raised, view.theme.focus);
    let inside = place.shrink(theme::PAD);
    let words = format!("{} {} %", what.get(view.lang), share / 10);
    let (line, bar) = inside.split_top(28.0);
    view.fit_left(line, &words, theme::LABEL, view.theme.text);
    widget::progress_bar(view, bar.split_bottom(12.0).1, share);
}
