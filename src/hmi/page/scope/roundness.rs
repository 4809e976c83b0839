//! Roundness of a recorded circle: the positions of two axes, the circle through them, and the deviations from it, enlarged.
//! Source: ISO 230-4 (circular tests).

use egui::{Pos2, Rect, Shape, Stroke, pos2, vec2};

use super::curves::CurveWindow;
use super::figures::{self, um, way_of_slide};
use crate::defs::scope_signal::{AxisQuantity, ScopeSignal};
use crate::geometry::{FittedCircle, PlanePoint};
use crate::hmi::{Area, View, theme};
use crate::link::scope::{SCOPE_CHANNELS, ScopeRecording};
use crate::units::Axis;

/// Radius of the drawn circle as a share of the room, and of the greatest deviation as a share of that radius.
const RADIUS_SHARE: f32 = 0.36;
const DEVIATION_SHARE: f64 = 0.25;
/// Deviations below this are drawn as if they were so great, mm: the circle of a perfect machine is a circle.
const LEAST_DEVIATION_MM: f64 = 1e-4;
/// Corners of the drawn circle.
const CORNERS: u32 = 180;

/// Two axes, each with its channel.
type AxisPair = [(Axis, usize); 2];

/// The two axes whose quantity is recorded, and their channels.
fn pair(recording: &ScopeRecording, quantity: AxisQuantity) -> Option<AxisPair> {
    let of = |(channel, signal): (usize, &Option<ScopeSignal>)| match signal {
        Some(ScopeSignal::Axis(axis, found)) if *found == quantity => Some((*axis, channel)),
        _ => None,
    };
    let mut axes = recording.setup.channels.iter().enumerate().filter_map(of);
    Some([axes.next()?, axes.next()?])
}

/// The shown positions in mm of the slides: a diameter is halved.
fn points(recording: &ScopeRecording, window: CurveWindow, of: AxisPair) -> Vec<PlanePoint> {
    let (from, to) = window.range(recording.samples.len());
    let way = |row: &[f64; SCOPE_CHANNELS]| of.map(|(axis, channel)| row[channel] * way_of_slide(recording, axis));
    recording.samples[from..to].iter().map(way).collect()
}

/// Draws the circle, or why there is none.
pub fn ui(rect: Rect, view: &View<'_>, recording: Option<&ScopeRecording>, window: CurveWindow) {
    view.card(rect);
    let found = recording.and_then(|recording| Some((recording, pair(recording, AxisQuantity::Actual)?)));
    let Some((recording, axes)) = found else {
        let words = view.text(
            "圆度：选两根轴的实际值，走一个圆并记录",
            "Roundness: choose the actual values of two axes, run a circle and record it.",
        );
        return view.note(rect, words);
    };
    let measured = points(recording, window, axes);
    let Some(circle) = FittedCircle::through(&measured) else {
        return view.note(rect, view.text("显示的部分不是圆", "what is shown is no circle"));
    };
    let (figures, plot) = rect.shrink(theme::PAD).split_left(figures::WIDTH);
    show_figures(figures, view, &circle, programmed_radius(recording, window, axes));
    paint(plot, view, &circle, &measured);
    let ends = [pos2(plot.max.x - 18.0, plot.center().y), pos2(plot.center().x, plot.min.y + 12.0)];
    for ((axis, _), end) in axes.iter().zip(ends) {
        let place = Rect::from_center_size(end, vec2(36.0, 24.0));
        view.fit_centre(place, &format!("{}+", axis.letter()), theme::LABEL, view.theme.muted);
    }
}

/// The radius of the set-points, if they are recorded, too.
fn programmed_radius(recording: &ScopeRecording, window: CurveWindow, of: AxisPair) -> Option<f64> {
    let axes = pair(recording, AxisQuantity::SetPoint)?;
    let is_same = axes.map(|(axis, _)| axis) == of.map(|(axis, _)| axis);
    let circle = is_same.then(|| FittedCircle::through(&points(recording, window, axes))).flatten();
    circle.map(|circle| circle.radius)
}

fn show_figures(rect: Rect, view: &View<'_>, circle: &FittedCircle, programmed: Option<f64>) {
    let (inward, outward) = circle.deviation;
    let mut lines = vec![
        (view.text("圆度", "roundness"), um(circle.roundness())),
        (view.text("半径", "radius"), format!("{:.4} mm", circle.radius)),
        (view.text("最内", "innermost"), um(inward)),
        (view.text("最外", "outermost"), um(outward)),
    ];
    if let Some(programmed) = programmed {
        lines.push((view.text("半径偏差", "radius error"), um(circle.radius - programmed)));
    }
    figures::show(rect, view, &lines);
}

/// The ideal circle and the measured one, with deviations enlarged until the greatest is a quarter of the radius.
fn paint(plot: Rect, view: &View<'_>, circle: &FittedCircle, measured: &[PlanePoint]) {
    let radius = plot.width().min(plot.height()) * RADIUS_SHARE;
    let greatest = circle.deviation.0.abs().max(circle.deviation.1.abs()).max(LEAST_DEVIATION_MM);
    let enlarged = DEVIATION_SHARE / greatest;
    let at = |angle: f64, away: f64| -> Pos2 {
        let length = f64::from(radius) * (1.0 + away * enlarged);
        plot.center() + vec2((length * angle.cos()) as f32, -(length * angle.sin()) as f32)
    };
    let ideal = (0..=CORNERS).map(|k| at(std::f64::consts::TAU * f64::from(k) / f64::from(CORNERS), 0.0)).collect();
    view.painter.add(Shape::line(ideal, Stroke::new(theme::HAIRLINE, view.theme.muted)));
    let curve = measured.iter().map(|point| {
        let (u, v) = (point[0] - circle.center[0], point[1] - circle.center[1]);
        at(v.atan2(u), u.hypot(v) - circle.radius)
    });
    view.painter.add(Shape::line(curve.collect(), Stroke::new(1.6, view.theme.info)));
    let scale = format!("{} {:.1} µm", view.text("最大偏差", "greatest deviation"), greatest * 1_000.0);
    let line = plot.with_min_y(plot.max.y - 24.0);
    view.fit_right(line, &scale, theme::SMALL, view.theme.muted);
}
