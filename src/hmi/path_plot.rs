//! The picture of `kt830 plot-path`: a programmed contour, the set-points along it, and what they ask of the axes.
//! Source: docs/motion.md.

use egui::{Rangef, Rect, Ui, UiBuilder, Vec2b, Visuals, pos2, vec2};
use egui_plot::{HLine, Legend, Line, LineStyle, Plot, PlotPoints, Points};
use image::RgbaImage;

use super::offscreen::OffscreenContext;
use super::theme;
use crate::defs::text::{Lang, Text};
use crate::units::{Axis, PerAxis, WorkPos};

/// Most points of a curve over time: about two a pixel. More are drawn as the least and greatest of each pixel.
const MAX_SAMPLES: usize = 4_000;
/// Up to this many set-points each has a dot on the path.
const MAX_DOTS: usize = 300;
/// Width of the numbers beside a plot, points: "-20000".
const AXIS_WIDTH: f32 = 64.0;
/// From where a grid line is drawn, and where it is at its strongest, points.
const GRID_SPACING: Rangef = Rangef { min: 8.0, max: 120.0 };
/// What an axis may do.
#[derive(Clone, Copy, Debug, Default)]
pub struct PlottedLimits {
    /// Acceleration, mm/s².
    pub acceleration: f64,
    /// Jerk, mm/s³.
    pub jerk: f64,
}

/// A run to be drawn. Lengths in mm, X as a radius, work coordinates as they are at its start.
#[derive(Clone, Debug)]
pub struct RecordedMotion {
    /// Its heading.
    pub title: String,
    /// The axes across and up.
    pub plane: (Axis, Axis),
    /// The fitted axes.
    pub axes: Vec<Axis>,
    /// The programmed contour, arcs as chords; in pieces where it is interrupted.
    pub contour: Vec<Vec<WorkPos>>,
    /// The set-point of each tick.
    pub set_points: Vec<WorkPos>,
    /// Distance of each set-point from the contour, mm.
    pub deviation: Vec<f64>,
    /// The tolerance of the contour, mm.
    pub tolerance: f64,
    /// Limits of the axes.
    pub limits: PerAxis<PlottedLimits>,
    /// Length of a tick, s.
    pub tick_s: f64,
}

impl RecordedMotion {
    /// The `order`-th differences of an axis by time.
    fn derivative(&self, axis: Axis, order: u32) -> Vec<f64> {
        let mut values: Vec<f64> = self.set_points.iter().map(|at| at[axis]).collect();
        for _ in 0..order {
            values = values.windows(2).map(|pair| (pair[1] - pair[0]) / self.tick_s).collect();
        }
        values
    }

    /// The speed along the path, mm/s.
    fn path_speed(&self) -> Vec<f64> {
        let moved = |pair: &[WorkPos]| Axis::ALL.map(|axis| pair[1][axis] - pair[0][axis]).map(|way| way * way);
        self.set_points.windows(2).map(|pair| moved(pair).iter().sum::<f64>().sqrt() / self.tick_s).collect()
    }

    /// A curve over time as points of a plot.
    fn over_time(&self, values: &[f64]) -> Vec<[f64; 2]> {
        let point = |index: usize| [index as f64 * self.tick_s, values[index]];
        if values.len() <= MAX_SAMPLES {
            return (0..values.len()).map(point).collect();
        }
        let size = values.len().div_ceil(MAX_SAMPLES / 2);
        let buckets = (0..values.len()).step_by(size).map(|from| from..(from + size).min(values.len()));
        buckets
            .flat_map(|bucket| {
                let least = bucket.clone().min_by(|a, b| values[*a].total_cmp(&values[*b])).unwrap_or(bucket.start);
                let most = bucket.clone().max_by(|a, b| values[*a].total_cmp(&values[*b])).unwrap_or(bucket.start);
                [point(least.min(most)), point(least.max(most))]
            })
            .collect()
    }
}

/// Draws a run. The same run gives the same bytes.
#[must_use]
pub fn draw(motion: &RecordedMotion, lang: Lang, size: (u32, u32)) -> RgbaImage {
    let mut screen = OffscreenContext::new(size);
    theme::install(screen.ctx(), &theme::LIGHT);
    screen.ctx().set_visuals(Visuals { extreme_bg_color: theme::PLOT.paper, ..Visuals::light() });
    // The plots find their bounds in the first frame.
    for _ in 0..3 {
        screen.frame(Vec::new(), |ui| sheet(ui, motion, lang));
    }
    screen.picture(theme::LIGHT.background)
}

/// The path on the left, the curves over time on the right.
fn sheet(ui: &mut Ui, motion: &RecordedMotion, lang: Lang) {
    let whole = ui.ctx().content_rect().shrink(theme::PAD);
    let heading = Rect::from_min_size(whole.min, vec2(whole.width(), 28.0));
    ui.put(heading, egui::Label::new(egui::RichText::new(&motion.title).strong().color(theme::LIGHT.text)));
    let body = whole.with_min_y(heading.max.y + theme::GAP);
    let middle = body.min.x + body.width() * 0.5;
    let left = Rect::from_min_max(body.min, pos2(middle - theme::GAP, body.max.y));
    let right = Rect::from_min_max(pos2(middle + theme::GAP, body.min.y), body.max);
    path(&mut child(ui, left), motion, lang);
    let rows = [deviation, path_speed, acceleration, jerk];
    let height = right.height() / rows.len() as f32;
    for (row, draw) in rows.into_iter().enumerate() {
        let top = right.min.y + height * row as f32;
        let place = Rect::from_min_size(pos2(right.min.x, top), vec2(right.width(), height - theme::GAP));
        draw(&mut child(ui, place), motion, lang);
    }
}

fn child(ui: &mut Ui, place: Rect) -> Ui {
    ui.new_child(UiBuilder::new().max_rect(place))
}

fn plot<'a>(name: &'a str, label: &str) -> Plot<'a> {
    Plot::new(name)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .show_crosshair(false)
        .y_axis_label(label)
        .legend(Legend::default())
        .y_axis_min_width(AXIS_WIDTH)
        .grid_spacing(GRID_SPACING)
        .grid_color(theme::PLOT.grid)
}

/// Contour and set-points to scale.
fn path(ui: &mut Ui, motion: &RecordedMotion, lang: Lang) {
    let (across, up) = motion.plane;
    let flat = |at: &WorkPos| [at[across], at[up]];
    let words = |zh, en| Text::new(zh, en).get(lang);
    let label = |axis: Axis| format!("{} mm", axis.letter());
    // A line without a length has no direction to be drawn in.
    let mut set_points: Vec<_> = motion.set_points.iter().map(flat).collect();
    set_points.dedup_by_key(|at| at.map(f64::to_bits));
    plot("path", &label(up)).x_axis_label(label(across)).data_aspect(1.0).show(ui, |plot| {
        for piece in &motion.contour {
            let points: Vec<_> = piece.iter().map(flat).collect();
            let line = Line::new(words("编程轮廓", "programmed contour"), PlotPoints::from(points));
            plot.line(line.color(theme::PLOT.contour).width(5.0));
        }
        let name = words("设定值", "set-points");
        plot.line(Line::new(name, PlotPoints::from(set_points.clone())).color(theme::PLOT.path).width(1.5));
        if set_points.len() <= MAX_DOTS {
            plot.points(Points::new(name, PlotPoints::from(set_points)).color(theme::PLOT.path).radius(1.5));
        }
    });
}

fn limit_lines(plot: &mut egui_plot::PlotUi<'_>, name: &str, limits: &[f64]) {
    for limit in limits {
        let line = HLine::new(name, *limit).color(theme::PLOT.limit).style(LineStyle::dashed_loose()).width(1.0);
        plot.hline(line);
    }
}

/// The distance from the contour in µm, and the tolerance.
fn deviation(ui: &mut Ui, motion: &RecordedMotion, lang: Lang) {
    let words = |zh, en| Text::new(zh, en).get(lang);
    let um: Vec<_> = motion.deviation.iter().map(|mm| mm * 1_000.0).collect();
    let points = motion.over_time(&um);
    plot("deviation", words("偏差 µm", "deviation µm")).show(ui, |plot| {
        plot.line(Line::new(words("偏差", "deviation"), PlotPoints::from(points)).color(theme::PLOT.path));
        limit_lines(plot, words("公差", "tolerance"), &[motion.tolerance * 1_000.0]);
    });
}

fn path_speed(ui: &mut Ui, motion: &RecordedMotion, lang: Lang) {
    let words = |zh, en| Text::new(zh, en).get(lang);
    let points = motion.over_time(&motion.path_speed());
    plot("speed", words("速度 mm/s", "speed mm/s")).show(ui, |plot| {
        plot.line(Line::new(words("轨迹速度", "path speed"), PlotPoints::from(points)).color(theme::PLOT.path));
    });
}

fn acceleration(ui: &mut Ui, motion: &RecordedMotion, lang: Lang) {
    let label = Text::new("加速度 mm/s²", "acceleration mm/s²").get(lang);
    axis_curves(ui, motion, (label, 2), lang);
}

fn jerk(ui: &mut Ui, motion: &RecordedMotion, lang: Lang) {
    let label = Text::new("加加速度 mm/s³", "jerk mm/s³").get(lang);
    axis_curves(ui, motion, (label, 3), lang);
}

/// A derivative of each axis that moves, and its limits.
fn axis_curves(ui: &mut Ui, motion: &RecordedMotion, (label, order): (&str, u32), lang: Lang) {
    let moves =
        |axis: &Axis| motion.set_points.windows(2).any(|pair| pair[0][*axis].to_bits() != pair[1][*axis].to_bits());
    let moving: Vec<Axis> = motion.axes.iter().copied().filter(moves).collect();
    let limit = |axis: Axis| if order == 2 { motion.limits[axis].acceleration } else { motion.limits[axis].jerk };
    let mut limits: Vec<f64> = moving.iter().flat_map(|axis| [limit(*axis), -limit(*axis)]).collect();
    limits.sort_by(f64::total_cmp);
    limits.dedup();
    let curves: Vec<_> =
        moving.iter().map(|axis| (*axis, motion.over_time(&motion.derivative(*axis, order)))).collect();
    let name = Text::new("极限", "limit").get(lang);
    let seconds = Text::new("时间 s", "time s").get(lang);
    let chart = plot(label, label).auto_bounds(Vec2b::TRUE);
    let chart = if order == 3 { chart.x_axis_label(seconds) } else { chart };
    chart.show(ui, |plot| {
        for (axis, points) in curves {
            let colour = theme::PLOT.axes[axis];
            plot.line(Line::new(axis.letter().to_string(), PlotPoints::from(points)).color(colour));
        }
        limit_lines(plot, name, &limits);
    });
}
