//! The contact law that removes stock (P4, P5).
//!
//! A cell of the surface has the height h along its normal; the wheel's surface over it is at p.
//! The overlap o = h − p is the infeed not yet removed: o = infeed − d, with d the depth removed. P5 gives
//! ḋ = (infeed − d)/τ, so ȯ = ḟ − o/τ with the feed ḟ, and over a tick of dt
//!
//!   o ← o · exp(−dt · (1/τ + |v|/λ)),   h ← p + o.
//!
//! The first term is the plunge: at the feed rate f the size lags by f·τ, and spark-out decays with τ. The second is
//! the traverse: the wheel moves along the surface at the speed v, and a cell passed over for the length n·λ keeps
//! exp(−n) of its overlap, at any speed.
//! λ is `traverse_face_mm` across a face (the wheel corner cuts, so a stroke with a few millimetres of overrun
//! leaves little), `traverse_cylinder_mm` along the wheel's axis, `traverse_plane_mm` along the stroke over a plane.
//! λ grows with τ as the wheel gets dull.
//! The removed volume wears the wheel (`wheel.rs`), loads its motor and, per width of contact, may burn the part.

use super::bending::Bending;

/// Position and motion of the wheel in this tick, part coordinates, radius.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct WheelMotion {
    /// Front of a new wheel along the infeed.
    pub front_mm: f64,
    /// Left side of a new wheel, along its axis.
    pub left_mm: f64,
    /// Centre of the wheel along the stroke, now and one tick ago.
    pub stroke_mm: f64,
    pub previous_stroke_mm: f64,
    /// Unsigned speeds along the infeed, the wheel's axis and the stroke.
    pub infeed_mm_s: f64,
    pub across_mm_s: f64,
    pub stroke_mm_s: f64,
    pub dt_s: f64,
    /// Tangent of the head's swivel angle: offset of the rim towards the infeed's minus side per millimetre along the
    /// wheel's axis.
    pub swivel_tan: f64,
    pub traverse: TraverseLengths,
    /// Speed of the part, turns per second.
    pub part_turns_s: f64,
    /// What bends under the wheel; nothing where part and spindle are stiff.
    pub bending: Option<Bending>,
}

impl WheelMotion {
    /// Interval covered along the stroke in this tick, mm: least, greatest.
    pub(super) fn sweep_mm(&self) -> (f64, f64) {
        (self.stroke_mm.min(self.previous_stroke_mm), self.stroke_mm.max(self.previous_stroke_mm))
    }
}

/// Lengths λ of a sharp wheel, mm.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TraverseLengths {
    /// Along the wheel's axis.
    pub across_mm: f64,
    /// Across a face.
    pub face_mm: f64,
    /// Along the stroke of a plane.
    pub plane_mm: f64,
    /// Contact length of the rim on a plane.
    pub contact_mm: f64,
}

/// Material removed in one tick.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Cut {
    pub volume_mm3: f64,
    /// Volume per width of contact, mm².
    pub specific_mm2: f64,
    /// By how much the contact is slower than with a sharp wheel: 1 sharp.
    pub dullness_factor: f64,
    /// Speed of the part under the wheel, mm/s; none where the wheel's side grinds a face that stands.
    pub work_mm_s: Option<f64>,
    /// Share of the surface that has passed under the wheel.
    pub passed_share: f64,
}

/// Share of the overlap removed in a tick: 1 − exp(−dt·(1/τ + v/λ)).
pub(super) fn removed_share(dt_s: f64, tau_s: f64, passes_per_s: f64) -> f64 {
    -(-dt_s * (tau_s.recip() + passes_per_s)).exp_m1()
}

/// The same where τ and λ are longer by a factor.
pub(super) fn removed_share_of_lag(removed_share: f64, lag_factor: f64) -> f64 {
    -((-removed_share).ln_1p() / lag_factor).exp_m1()
}
