//! The pictograms of the keys: original line drawings in the style of ISO 7000, on a 24 × 24 grid.
//! Source: spec H3. A wheel is a circle with a hub, | means on, O means off.

use egui::epaint::PathShape;
use egui::{Color32, Painter, Pos2, Rect, Shape, Stroke, vec2};

use crate::defs::key::Key;

/// One shape of a pictogram.
#[derive(Clone, Copy, Debug)]
pub enum PictogramShape {
    /// A polyline.
    Line(&'static [(f32, f32)]),
    /// A filled convex polygon.
    Fill(&'static [(f32, f32)]),
    /// A circle: centre and radius.
    Ring(f32, f32, f32),
    /// A filled circle.
    Dot(f32, f32, f32),
    /// An arc: centre, radius, from and to in degrees, clockwise from three o'clock.
    Arc(f32, f32, f32, f32, f32),
    /// A box: left, top, width, height.
    Box(f32, f32, f32, f32),
    /// An arrow head: tip and direction in degrees.
    ArrowHead(f32, f32, f32),
}

use PictogramShape::{Arc, ArrowHead, Box, Dot, Fill, Line, Ring};

/// Draws a pictogram into a square.
pub fn draw(painter: &Painter, rect: Rect, marks: &[PictogramShape], colour: Color32) {
    let unit = rect.width().min(rect.height()) / 24.0;
    let corner = rect.center() - vec2(12.0, 12.0) * unit;
    let at = |(x, y): (f32, f32)| corner + vec2(x, y) * unit;
    let stroke = Stroke::new((1.9 * unit).max(1.3), colour);
    marks.iter().for_each(|mark| mark.paint(painter, &at, unit, stroke));
}

impl PictogramShape {
    fn paint(self, painter: &Painter, at: &dyn Fn((f32, f32)) -> Pos2, unit: f32, stroke: Stroke) {
        let filled = |points| Shape::from(PathShape::convex_polygon(points, stroke.color, Stroke::NONE));
        painter.add(match self {
            Line(points) => Shape::line(points.iter().copied().map(at).collect(), stroke),
            Fill(points) => filled(points.iter().copied().map(at).collect()),
            Ring(x, y, radius) => Shape::circle_stroke(at((x, y)), radius * unit, stroke),
            Dot(x, y, radius) => Shape::circle_filled(at((x, y)), radius * unit, stroke.color),
            Arc(x, y, radius, from, to) => {
                let points = (0..=14).map(|step| {
                    let angle = (from + (to - from) * step as f32 / 14.0).to_radians();
                    at((x + radius * angle.cos(), y + radius * angle.sin()))
                });
                Shape::line(points.collect(), stroke)
            }
            Box(x, y, width, height) => {
                let points = [(x, y), (x + width, y), (x + width, y + height), (x, y + height)].map(at);
                Shape::closed_line(points.to_vec(), stroke)
            }
            ArrowHead(x, y, degrees) => {
                let turn = |forward: f32, side: f32| {
                    let (sin, cos) = degrees.to_radians().sin_cos();
                    at((x + forward * cos - side * sin, y + forward * sin + side * cos))
                };
                filled(vec![turn(0.0, 0.0), turn(-5.5, 3.4), turn(-5.5, -3.4)])
            }
        });
    }
}

/// Padlock: the key is blocked.
pub const LOCK: &[PictogramShape] =
    &[Fill(&[(4.0, 11.0), (20.0, 11.0), (20.0, 22.0), (4.0, 22.0)]), Arc(12.0, 11.0, 5.5, 180.0, 360.0)];
/// House: the axis is homed (H5).
pub const HOUSE: &[PictogramShape] =
    &[Line(&[(2.0, 12.0), (12.0, 3.0), (22.0, 12.0)]), Line(&[(5.0, 11.0), (5.0, 21.0), (19.0, 21.0), (19.0, 11.0)])];
/// Check mark: a condition is met.
pub const CHECK: &[PictogramShape] = &[Line(&[(5.0, 12.5), (10.0, 18.0), (19.0, 6.5)])];
/// Missing picture.
pub const NO_PICTURE: &[PictogramShape] = &[
    Box(3.0, 4.0, 18.0, 16.0),
    Line(&[(3.0, 18.0), (9.0, 11.0), (13.0, 16.0), (16.0, 13.0), (21.0, 18.0)]),
    Line(&[(1.0, 23.0), (23.0, 1.0)]),
];
/// Sheet with a cross: no page.
pub const NO_PAGE: &[PictogramShape] = &[
    Line(&[(14.0, 2.0), (4.0, 2.0), (4.0, 22.0), (20.0, 22.0), (20.0, 8.0), (14.0, 2.0), (14.0, 8.0), (20.0, 8.0)]),
    Line(&[(9.0, 12.5), (15.0, 18.5)]),
    Line(&[(15.0, 12.5), (9.0, 18.5)]),
];

const WHEEL: PictogramShape = Ring(9.0, 12.0, 7.5);
const HUB: PictogramShape = Dot(9.0, 12.0, 2.0);
const ON: PictogramShape = Line(&[(21.0, 6.0), (21.0, 18.0)]);
const OFF: PictogramShape = Ring(20.0, 18.0, 3.0);
const CHUCK: PictogramShape = Box(2.5, 4.0, 6.0, 16.0);
const SHAFT: PictogramShape = Line(&[(8.5, 8.5), (15.0, 8.5), (15.0, 15.5), (8.5, 15.5)]);
const CONE: PictogramShape = Line(&[(11.0, 12.0), (15.0, 8.0), (22.0, 8.0), (22.0, 16.0), (15.0, 16.0), (11.0, 12.0)]);
const MAGNET: PictogramShape = Arc(12.0, 12.0, 7.0, 180.0, 360.0);
const POLES: PictogramShape = Line(&[(5.0, 12.0), (5.0, 19.0)]);
const POLES_2: PictogramShape = Line(&[(19.0, 12.0), (19.0, 19.0)]);
const PART: PictogramShape = Ring(12.0, 15.0, 5.0);
const LOCK_BODY: PictogramShape = Box(6.0, 11.0, 12.0, 9.0);
const LOCK_BOW: PictogramShape = Arc(12.0, 11.0, 4.0, 180.0, 360.0);

macro_rules! key_shapes {
    ($($($key:ident)|+ => $($shape:expr),+;)*) => {
        /// The pictogram of a key; keys labelled with a number or letter have none.
        #[must_use]
        pub const fn for_key(key: Key) -> &'static [PictogramShape] {
            match key {
                $($(Key::$key)|+ => &[$($shape),+],)*
                _ => &[],
            }
        }
    };
}

key_shapes! {
    BlockSkip => Line(&[(2.0, 19.0), (7.0, 19.0)]), Box(9.0, 15.0, 6.0, 6.0), Line(&[(17.0, 19.0), (22.0, 19.0)]),
        Arc(12.0, 14.0, 8.0, 190.0, 335.0), ArrowHead(20.5, 14.5, 65.0);
    OptionalStop => Line(&[(8.0, 3.0), (16.0, 3.0), (21.0, 8.0), (21.0, 16.0), (16.0, 21.0), (8.0, 21.0),
        (3.0, 16.0), (3.0, 8.0), (8.0, 3.0)]), Line(&[(9.0, 8.5), (9.0, 15.5)]), Line(&[(15.0, 8.5), (15.0, 15.5)]);
    MachineLock => LOCK_BODY, LOCK_BOW, Line(&[(1.0, 22.5), (23.0, 22.5)]), Dot(12.0, 15.5, 1.6);
    AuxFunctionLock => Box(3.0, 12.0, 11.0, 8.5), Arc(8.5, 12.0, 3.6, 180.0, 360.0), Ring(19.0, 8.0, 3.2),
        Line(&[(19.0, 2.0), (19.0, 14.0)]), Line(&[(13.8, 5.0), (24.0, 11.0)]);
    DryRun => Line(&[(2.0, 18.0), (8.0, 8.0), (12.0, 14.0), (19.0, 5.0)]), ArrowHead(21.0, 2.5, -52.0),
        Line(&[(2.0, 22.0), (5.0, 22.0)]), Line(&[(8.0, 22.0), (11.0, 22.0)]), Line(&[(14.0, 22.0), (17.0, 22.0)]);
    CycleStart => Fill(&[(6.0, 3.0), (20.0, 12.0), (6.0, 21.0)]);
    FeedHold => Fill(&[(5.0, 4.0), (9.5, 4.0), (9.5, 20.0), (5.0, 20.0)]), Fill(&[(14.5, 4.0), (19.0, 4.0),
        (19.0, 20.0), (14.5, 20.0)]);
    Reset => Line(&[(5.0, 20.0), (15.0, 4.0)]), Line(&[(10.0, 20.0), (17.5, 8.0)]), ArrowHead(20.0, 4.0, -58.0);
    FeedOverrideUp | SpindleOverrideUp => Line(&[(4.0, 12.0), (20.0, 12.0)]), Line(&[(12.0, 4.0), (12.0, 20.0)]);
    FeedOverrideDown | SpindleOverrideDown => Line(&[(4.0, 12.0), (20.0, 12.0)]);
    Rapid | RapidF0 | Rapid25 | Rapid50 | Rapid100 => Line(&[(2.0, 17.0), (8.0, 7.0), (13.0, 17.0), (19.0, 7.0)]),
        ArrowHead(21.5, 3.0, -60.0);
    ModeEdit => Line(&[(4.0, 20.0), (5.0, 15.0), (16.0, 4.0), (20.0, 8.0), (9.0, 19.0), (4.0, 20.0)]),
        Line(&[(13.0, 7.0), (17.0, 11.0)]);
    ModeAuto => Arc(12.0, 12.0, 8.0, -40.0, 250.0), ArrowHead(13.0, 4.0, 10.0), Fill(&[(10.0, 8.5), (16.0, 12.0),
        (10.0, 15.5)]);
    ModeMdi => Box(2.5, 5.0, 19.0, 14.0), Line(&[(6.0, 9.0), (9.5, 12.0), (6.0, 15.0)]), Line(&[(12.0, 15.0),
        (17.0, 15.0)]);
    ModeHome => Ring(12.0, 12.0, 7.0), Line(&[(12.0, 1.5), (12.0, 22.5)]), Line(&[(1.5, 12.0), (22.5, 12.0)]),
        Fill(&[(12.0, 12.0), (12.0, 5.0), (16.9, 7.1), (19.0, 12.0)]), Fill(&[(12.0, 12.0), (12.0, 19.0), (7.1, 16.9),
        (5.0, 12.0)]);
    ModeHandwheel => Ring(12.0, 12.0, 9.0), Ring(12.0, 12.0, 2.0), Dot(16.5, 7.5, 2.4);
    ModeStep => Line(&[(2.0, 20.0), (7.0, 20.0), (7.0, 14.0), (12.5, 14.0), (12.5, 8.0), (18.0, 8.0)]),
        ArrowHead(22.5, 8.0, 0.0);
    ModeManual => Line(&[(12.0, 5.0), (12.0, 19.0)]), Line(&[(5.0, 12.0), (19.0, 12.0)]),
        ArrowHead(12.0, 1.0, -90.0), ArrowHead(12.0, 23.0, 90.0), ArrowHead(1.0, 12.0, 180.0),
        ArrowHead(23.0, 12.0, 0.0);
    SingleBlock => Box(2.5, 7.0, 8.0, 10.0), Line(&[(12.0, 12.0), (16.0, 12.0)]), ArrowHead(20.0, 12.0, 0.0),
        Line(&[(21.5, 5.0), (21.5, 19.0)]);
    WheelStart => WHEEL, HUB, ON;
    WheelStop => WHEEL, HUB, OFF;
    SecondSpindle => Box(2.5, 6.0, 11.0, 12.0), Line(&[(13.5, 9.5), (17.0, 9.5), (17.0, 14.5), (13.5, 14.5)]),
        Ring(20.0, 12.0, 2.5);
    SpindleForward => CHUCK, SHAFT, Arc(16.0, 12.0, 6.0, -70.0, 60.0), ArrowHead(17.5, 18.5, 150.0);
    SpindleReverse => CHUCK, SHAFT, Arc(16.0, 12.0, 6.0, -60.0, 70.0), ArrowHead(17.5, 5.5, 210.0);
    SpindleStop => CHUCK, SHAFT, OFF;
    ToolTurret => Box(7.0, 7.0, 10.0, 10.0), Line(&[(12.0, 7.0), (12.0, 2.5)]), Line(&[(17.0, 12.0), (21.5, 12.0)]),
        Line(&[(12.0, 17.0), (12.0, 21.5)]), Line(&[(7.0, 12.0), (2.5, 12.0)]), Dot(12.0, 12.0, 1.6);
    HeadstockHigh => CHUCK, SHAFT, Arc(16.0, 12.0, 6.0, -70.0, 60.0), ArrowHead(17.5, 18.5, 150.0),
        Arc(13.0, 12.0, 10.0, -45.0, 45.0);
    HeadstockLow => CHUCK, SHAFT, Arc(15.0, 12.0, 6.0, -70.0, 60.0), ArrowHead(16.5, 18.5, 150.0);
    HeadstockStop => CHUCK, SHAFT, OFF;
    DresserRoll => Ring(8.0, 9.0, 6.0), Ring(17.5, 17.0, 3.8), Dot(8.0, 9.0, 1.6),
        Arc(17.5, 17.0, 6.0, -60.0, 40.0);
    TableRotation => Line(&[(2.0, 14.0), (22.0, 14.0), (22.0, 17.5), (2.0, 17.5), (2.0, 14.0)]),
        Line(&[(12.0, 17.5), (12.0, 22.0)]), Arc(12.0, 9.0, 7.0, 150.0, 340.0), ArrowHead(19.5, 9.5, 80.0);
    TailstockAdvance => CONE, Line(&[(9.0, 20.5), (4.0, 20.5)]), ArrowHead(1.0, 20.5, 180.0), Line(&[(2.0, 4.0),
        (2.0, 16.0), (6.0, 16.0), (6.0, 4.0)]);
    TailstockRetract => CONE, Line(&[(11.0, 20.5), (18.0, 20.5)]), ArrowHead(22.0, 20.5, 0.0), Line(&[(2.0, 4.0),
        (2.0, 16.0), (6.0, 16.0), (6.0, 4.0)]);
    Magnetise => MAGNET, POLES, POLES_2, Line(&[(2.5, 19.5), (7.5, 19.5)]), Line(&[(16.5, 19.5), (21.5, 19.5)]),
        Line(&[(12.0, 14.0), (12.0, 21.0)]);
    Demagnetise => MAGNET, POLES, POLES_2, Line(&[(3.0, 21.0), (21.0, 3.0)]);
    Coolant => Line(&[(2.0, 6.0), (12.0, 6.0), (16.0, 10.0), (16.0, 12.0)]), Line(&[(2.0, 10.5), (10.0, 10.5),
        (11.5, 12.0)]), Dot(14.0, 16.0, 1.7), Dot(10.5, 20.5, 1.7), Dot(17.5, 20.5, 1.7);
    Lubrication => Line(&[(3.0, 19.0), (3.0, 11.0), (11.0, 11.0), (13.0, 14.0), (21.0, 7.0)]), Line(&[(3.0, 19.0),
        (13.0, 19.0), (13.0, 14.0)]), Line(&[(5.0, 11.0), (5.0, 7.5), (9.0, 7.5), (9.0, 11.0)]), Dot(21.5, 12.5, 1.8);
    Hydraulic => Ring(12.0, 12.0, 8.0), Fill(&[(12.0, 4.0), (16.5, 11.0), (7.5, 11.0)]), Line(&[(12.0, 1.0),
        (12.0, 5.0)]), Line(&[(12.0, 20.0), (12.0, 23.0)]);
    RadialGauge => PART, Line(&[(7.0, 22.0), (4.0, 15.0), (7.0, 8.0), (7.0, 2.0), (17.0, 2.0), (17.0, 8.0),
        (20.0, 15.0), (17.0, 22.0)]);
    AxialGauge => Box(2.5, 8.0, 9.0, 12.0), Line(&[(22.0, 3.0), (22.0, 14.0), (16.0, 14.0)]),
        ArrowHead(12.5, 14.0, 180.0), Line(&[(17.0, 3.0), (23.5, 3.0)]);
    Oscillation => Line(&[(3.0, 5.0), (3.0, 19.0)]), Line(&[(21.0, 5.0), (21.0, 19.0)]), Line(&[(8.0, 12.0),
        (16.0, 12.0)]), ArrowHead(5.0, 12.0, 180.0), ArrowHead(19.0, 12.0, 0.0);
    DressReturn => Ring(8.0, 9.0, 6.0), Dot(8.0, 9.0, 1.6), Fill(&[(15.0, 18.0), (18.0, 15.0), (21.0, 18.0),
        (18.0, 21.0)]), Line(&[(13.0, 13.5), (15.5, 15.8)]), Line(&[(18.0, 15.0), (18.0, 8.0), (21.0, 8.0)]);
    WheelRetract => Ring(9.0, 9.0, 6.0), Dot(9.0, 9.0, 1.6), Line(&[(1.0, 21.0), (17.0, 21.0)]),
        Line(&[(20.0, 20.0), (20.0, 8.0)]), ArrowHead(20.0, 3.5, -90.0);
}
