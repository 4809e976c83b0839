//! Plane geometry of contours: lines and arcs, their corners, and the path of a cutter beside them.
//!
//! Pure functions in millimetres and radians; knows nothing of programs, axes and motion. The first axis of the plane is
//! u, the second v; counter-clockwise is from u+ to v+, and left is counter-clockwise of the direction of travel.

mod circle_fit;
mod corner;
mod cutter_compensation;
mod plane_segment;

pub use circle_fit::FittedCircle;
pub use corner::{Corner, CornerMistake};
pub use cutter_compensation::{
    CompensatedSegment, CompensationSide, CutterPath, Gouge, GougeCause, OuterCorner, compensate,
};
pub use plane_segment::{MAX_CENTER_SHIFT_MM, PlanePoint, PlaneSegment};
