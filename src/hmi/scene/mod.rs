//! The live scene: part, holders, dresser and wheel of a grinding machine, to scale, as the newest snapshot has them. The
//! simulated machine gives the part as it is ground; on a real one the wheel of P77 and P78 is drawn alone: its part is not known.
//!
//! `camera` is the section of the plane that is shown, `part` and `wheel` paint, `magnifier` shows the contact in micrometres.
//! Coordinates are those of the part: mm, X as radius; where the wheel has its new size they are the work coordinates.
//! Source: spec B6, H8, P2, P5.

mod camera;
mod magnifier;
mod part;
mod wheel;

use std::borrow::Cow;

use egui::{Pos2, Rect};

pub use camera::{Camera, ViewPlane, add_quad, add_shaded_quad};
pub use magnifier::Magnifier;

use super::{Area, View, theme};
use crate::defs::grinding_workspace::{GrindingWorkspace, PartSection};
use crate::defs::kind::WheelPose;
use crate::defs::param::{self, Params};
use crate::defs::signal::Output;
use crate::link::Snapshot;
use crate::link::toolpath::BoundingBox;
use crate::units::{Axis, Micros, PerAxis};

/// Time between two pictures of a wheel that only turns.
const FRAME_TIME: Micros = Micros::from_millis(40);
/// How much of the wheel is in view beyond its front, as a share of the height of the part.
const WHEEL_SHARE: f64 = 0.7;
/// How far beside the part its holders are in view, as a share of its length.
const HOLDERS_SHARE: f64 = 0.9;
/// The scene keeps at least so much of the machine in view, mm.
const LEAST_EXTENT_MM: f64 = 8.0;

/// Height of the note below a scene without a wheel, points.
const NOTE_HEIGHT: f32 = 20.0;
/// Least height of a scene, points.
pub const LEAST_HEIGHT: f32 = 110.0;

/// What turns the part.
const PART_DRIVES: [Output; 3] = [Output::HeadstockHigh, Output::HeadstockLow, Output::TableRotation];

/// Whether something in the scene turns: it is painted again as time goes on.
#[must_use]
pub fn is_turning(snapshot: &Snapshot) -> bool {
    snapshot.outputs.has(Output::Wheel) || PART_DRIVES.iter().any(|output| snapshot.outputs.has(*output))
}

/// The number of the picture at a time.
#[must_use]
pub const fn frame_at(now: Micros) -> u64 {
    now.0 / FRAME_TIME.0
}

/// The scene of a snapshot.
pub struct MachineScene<'a> {
    workspace: Cow<'a, GrindingWorkspace>,
    infeed: Axis,
    across: Axis,
    /// The foremost point of a new wheel on its minus side; along the stroke its centre.
    wheel_mm: PerAxis<f64>,
    /// Every axis is homed. Before that nobody knows where the wheel is.
    wheel_is_known: bool,
}

impl<'a> MachineScene<'a> {
    /// The scene; none on a lathe, whose bar the drawing page shows.
    #[must_use]
    pub fn of(snapshot: &'a Snapshot) -> Option<Self> {
        let WheelPose { body: infeed, spindle: across, position_is_centre } = snapshot.kind.ui().wheel_pose?;
        let slide = |axis: Axis, displayed: f64| match axis {
            Axis::X if snapshot.x_as_diameter => displayed / 2.0,
            Axis::X | Axis::Y | Axis::Z => displayed,
        };
        let wheel_is_known = snapshot.axes.iter().all(|(_, axis)| axis.homed || !axis.present);
        let simulated = snapshot.simulated.as_deref().and_then(|simulated| simulated.grinding_workspace.as_ref());
        if let Some(workspace) = simulated {
            let wheel_mm = PerAxis::from_fn(|axis| slide(axis, snapshot.axes[axis].machine) - workspace.zero_mm[axis]);
            return Some(Self { workspace: Cow::Borrowed(workspace), infeed, across, wheel_mm, wheel_is_known });
        }
        let workspace = workspace_of_params(&snapshot.params);
        let mut wheel_mm = PerAxis::from_fn(|axis| slide(axis, snapshot.axes[axis].work));
        if position_is_centre {
            wheel_mm[infeed] -= workspace.wheel_radius_mm;
        }
        Some(Self { workspace: Cow::Owned(workspace), infeed, across, wheel_mm, wheel_is_known })
    }

    /// The axis that strokes the part under the wheel, where one does.
    fn stroke(&self) -> Option<Axis> {
        let others = |axis: &Axis| *axis != self.infeed && *axis != self.across;
        let stroked = |axis: &Axis| self.workspace.part.iter().any(|part| part.along == *axis || part.height == *axis);
        Axis::ALL.into_iter().filter(others).find(stroked)
    }

    /// Least wear of the rim: its foremost point is so far behind that of a new wheel, mm.
    fn least_wear_mm(&self) -> f64 {
        self.workspace.rim_wear_mm.iter().copied().reduce(f64::min).unwrap_or(0.0)
    }

    /// The foremost point of the wheel along the infeed, mm.
    fn front_mm(&self) -> f64 {
        self.wheel_mm[self.infeed] + self.least_wear_mm()
    }

    /// By how much the rim over the edge of the part is higher than its lowest point, while the wheel is beyond the end of
    /// the stroke, mm; none if it is clear of the part.
    fn overrun_lift_mm(&self) -> Option<f64> {
        let Some(stroke) = self.stroke() else { return Some(0.0) };
        let along = self.workspace.part.iter().filter(|part| part.along == stroke);
        let places = along.flat_map(|part| part.samples.iter().map(|sample| sample[0]));
        let (least, most) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), at| (a.min(at), b.max(at)));
        let beyond = (least - self.wheel_mm[stroke]).max(self.wheel_mm[stroke] - most).max(0.0);
        let radius = self.workspace.wheel_radius_mm;
        (beyond < radius).then(|| radius - (radius * radius - beyond * beyond).sqrt())
    }

    /// The wheel from side to side, mm.
    fn sides_mm(&self) -> (f64, f64) {
        let left = self.wheel_mm[self.across];
        (left, left + self.workspace.wheel_width_mm)
    }

    /// What must be in view in a plane: the part, and the wheel as far as it is near it.
    #[must_use]
    pub fn bounds(&self, (right, up): ViewPlane) -> BoundingBox {
        let mut bounds: PerAxis<Option<(f64, f64)>> = PerAxis([None; 3]);
        let mut take = |axis: Axis, low: f64, high: f64| {
            let (least, most) = bounds[axis].unwrap_or((low, high));
            bounds[axis] = Some((least.min(low).min(high), most.max(high).max(low)));
        };
        for part in self.workspace.part.iter().filter(|part| part.lies_in(right, up)) {
            for [place, low, high] in part.ends() {
                take(part.along, place, place);
                take(part.height, low, high);
                match part.mirrored {
                    Some(axis) if axis == part.along => take(axis, -place, -place),
                    Some(axis) => take(axis, -low, -high),
                    None => {}
                }
            }
        }
        // Chuck and tailstock, if they are not far from what is ground.
        if let Some((least, most)) = bounds[self.across] {
            let near = HOLDERS_SHARE * (most - least).max(LEAST_EXTENT_MM);
            for range in self.workspace.holders.iter().filter_map(|holder| holder.extent[self.across]) {
                let clear = (least - range.1).max(range.0 - most);
                let seen = (range.0.max(least - near), range.1.min(most + near));
                if clear < near && seen.0 < seen.1 {
                    let known = bounds[self.across].unwrap_or(seen);
                    bounds[self.across] = Some((known.0.min(seen.0), known.1.max(seen.1)));
                }
            }
        }
        let height = |range: Option<(f64, f64)>| range.map_or(LEAST_EXTENT_MM, |(low, high)| high - low);
        let tall = height(bounds[self.infeed]).max(LEAST_EXTENT_MM);
        let mut take = |axis: Axis, low: f64, high: f64| {
            let (least, most) = bounds[axis].unwrap_or((low, high));
            bounds[axis] = Some((least.min(low), most.max(high)));
        };
        if self.wheel_is_known || self.workspace.part.is_empty() {
            let (front, (left, to)) = (self.front_mm(), self.sides_mm());
            take(self.infeed, front, front + WHEEL_SHARE * tall);
            take(self.across, left, to);
            if let Some(stroke) = self.stroke() {
                take(stroke, self.wheel_mm[stroke] - tall / 2.0, self.wheel_mm[stroke] + tall / 2.0);
            }
        }
        let end = |pick: fn((f64, f64)) -> f64| Axis::ALL.map(|axis| bounds[axis].map_or(0.0, pick) as f32);
        BoundingBox { low: end(|range| range.0), high: end(|range| range.1) }
    }
}

impl PartSection {
    /// Whether the section lies in a plane.
    fn lies_in(&self, right: Axis, up: Axis) -> bool {
        (self.along, self.height) == (right, up) || (self.along, self.height) == (up, right)
    }

    /// First, last and highest sample.
    fn ends(&self) -> impl Iterator<Item = [f64; 3]> {
        let highest = self.samples.iter().max_by(|a, b| a[2].total_cmp(&b[2]));
        [self.samples.first(), highest, self.samples.last()].into_iter().flatten().copied()
    }
}

/// What is known without a simulated machine: the size of the wheel as it is booked.
fn workspace_of_params(params: &Params) -> GrindingWorkspace {
    GrindingWorkspace {
        wheel_radius_mm: params.get(param::WHEEL_DIAMETER) / 2.0,
        wheel_width_mm: params.get(param::WHEEL_WIDTH),
        ..GrindingWorkspace::default()
    }
}

/// A scene on its canvas.
pub struct SceneCanvas<'a> {
    /// What is painted.
    pub scene: &'a MachineScene<'a>,
    /// The view, clipped to the canvas.
    pub view: &'a View<'a>,
    /// The canvas.
    pub rect: Rect,
    /// The plane.
    pub plane: ViewPlane,
    /// What of the plane.
    pub camera: Camera,
}

impl SceneCanvas<'_> {
    /// Paints everything.
    pub fn paint(&self) {
        self.paint_holders();
        self.paint_part();
        self.paint_soft_limits();
        self.paint_dresser();
        if self.scene.wheel_is_known {
            self.paint_wheel();
            self.paint_coolant();
            self.paint_sparks();
        }
    }

    /// The point on the canvas that has these coordinates along two axes.
    fn at(&self, a: (Axis, f64), b: (Axis, f64)) -> Pos2 {
        let along = |axis: Axis| if a.0 == axis { a.1 } else { b.1 };
        self.camera.to_canvas(self.rect, along(self.plane.0) as f32, along(self.plane.1) as f32)
    }

    /// Whether the plane shows an axis.
    fn shows(&self, axis: Axis) -> bool {
        self.plane.0 == axis || self.plane.1 == axis
    }

    /// The plane shows the wheel from its side, as a disc.
    fn shows_disc(&self) -> bool {
        !self.shows(self.scene.across) && self.shows(self.scene.infeed)
    }

    fn is_on(&self, output: Output) -> bool {
        self.view.snapshot.outputs.has(output)
    }

    /// Turns of something that turns slowly enough to be seen, from zero to one.
    fn turns(&self, per_second: f64) -> f64 {
        (frame_at(self.view.snapshot.now) as f64 * FRAME_TIME.as_secs_f64() * per_second).fract()
    }
}

/// Paints the scene, and below it the contact where the wheel is near the part; nothing on a lathe.
pub fn paint_with_contact(rect: Rect, view: &View<'_>, contact_height: f32) {
    let contact = MachineScene::of(view.snapshot).and_then(|scene| Magnifier::of(&scene, view.snapshot));
    let contact = contact.filter(|_| rect.height() >= contact_height + LEAST_HEIGHT);
    let (above, below) = rect.split_bottom(if contact.is_some() { contact_height } else { 0.0 });
    paint_follow(above, view);
    if let Some(contact) = contact {
        contact.paint(below.trim_top(theme::GAP), view);
    }
}

/// Paints the scene small, with all of part and wheel front in view; nothing on a lathe, and without a part.
pub fn paint_follow(rect: Rect, view: &View<'_>) {
    let scene = MachineScene::of(view.snapshot).filter(|scene| !scene.workspace.part.is_empty());
    let Some(scene) = scene else { return };
    let Some(plane) = view.snapshot.kind.ui().drawing_planes.first().copied() else { return };
    let (rect, note) = rect.split_bottom(if scene.wheel_is_known { 0.0 } else { NOTE_HEIGHT });
    if !scene.wheel_is_known {
        let words = view.text("回零后显示砂轮", "the wheel is shown after homing");
        view.fit_centre(note, words, theme::SMALL, view.theme.muted);
    }
    let camera = Camera::fit(scene.bounds(plane), plane, rect);
    let view = &view.clipped(rect);
    SceneCanvas { scene: &scene, view, rect, plane, camera }.paint();
}
