//! The proposal for a plunge: one roughing feed, one finishing feed, spark-out.
//!
//! The feed of the slide is v_f = Q'w/(π·d_w), with the removal rate Q'w below the burn limit (`burn`) and the other
//! limits; the size lags behind the feed by v_f·τ.

use std::f64::consts::PI;

use super::burn::burn_limit_mm2_s;
use super::dressing::effective_width_mm;
use super::material::GroundMaterial;
use crate::defs::page_meaning::PageMeaning;

/// Share of a limit that is used: the rest is for runout, a dulling wheel and the operator's coolant.
const SAFE_SHARE: f64 = 0.8;
/// Removal rate of finishing for a roughness Ra of 0.4 µm, mm³/(mm·s); it grows with Ra.
const FINISH_MM2_S: f64 = 0.5;
const FINISH_ROUGHNESS_UM: f64 = 0.4;
/// Range of the removal rate of finishing, mm³/(mm·s).
const FINISH_RANGE_MM2_S: (f64, f64) = (0.1, 1.0);
/// Time constants of finishing, in which the lag of roughing decays to that of finishing: e^-3 is 5 %.
const SETTLING: f64 = 3.0;
/// Part of the tolerance, on the diameter, that may be left behind the spark-out.
const LEFT_OF_TOLERANCE: f64 = 0.1;
/// Turns of the part in a spark-out at least: it evens out the lobes of the last turn of feed.
const SPARK_OUT_TURNS: f64 = 5.0;
/// Safety clearance in front of the stock, on the diameter, mm.
const CLEARANCE_MM: f64 = 0.1;
/// What a value may be beside a step of its rounding, in steps.
const ROUNDING: f64 = 1e-6;

/// The part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlungePart {
    /// Material.
    pub material: GroundMaterial,
    /// Finished diameter, mm.
    pub diameter_mm: f64,
    /// Ground width, mm.
    pub width_mm: f64,
    /// Stock on the diameter, mm.
    pub stock_mm: f64,
    /// Tolerance of the diameter, from limit to limit, mm.
    pub tolerance_mm: f64,
    /// Roughness Ra, µm.
    pub roughness_um: f64,
}

/// The wheel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MountedWheel {
    /// Diameter, mm.
    pub diameter_mm: f64,
    /// Width, mm.
    pub width_mm: f64,
    /// Rated surface speed, m/s.
    pub rated_m_s: f64,
    /// Speed that is set (P73), rpm.
    pub rpm: f64,
}

/// The machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GrindingMachine {
    /// Power of the wheel motor, kW.
    pub wheel_kw: f64,
    /// Time constant of the contact, s: by deflection the size lags behind the feed by v_f·τ.
    pub time_constant_s: f64,
    /// Speed of the part, rpm: the headstock has two.
    pub work_rpm: f64,
}

/// What is to be ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GrindingTask {
    /// The part.
    pub part: PlungePart,
    /// The wheel.
    pub wheel: MountedWheel,
    /// The machine.
    pub machine: GrindingMachine,
}

impl GrindingTask {
    /// Speed of the part's surface, mm/s.
    fn work_mm_s(&self) -> f64 {
        PI * self.part.diameter_mm * self.machine.work_rpm / 60.0
    }

    /// Removal rate per width at which the specific energy of the material reaches that of the burn limit, mm³/(mm·s). None
    /// for a material that does not burn, and where a size or a speed is missing.
    #[must_use]
    pub fn burn_limit_mm2_s(&self) -> Option<f64> {
        let Self { part, wheel, .. } = self;
        let equivalent_mm = wheel.diameter_mm * part.diameter_mm / (wheel.diameter_mm + part.diameter_mm);
        let limit = burn_limit_mm2_s(part.material.energy_j_mm3, equivalent_mm, self.work_mm_s());
        Some(limit).filter(|limit| part.material.burns && limit.is_finite() && *limit > 0.0)
    }
}

/// By what a value is set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProposalLimit {
    /// The rated speed of the wheel.
    WheelRating,
    /// The speed of the wheel that is set (P73).
    WheelSpeed,
    /// Burn of the part.
    Burn,
    /// Power of the wheel motor.
    Power,
    /// Economical wear of the wheel.
    WheelWear,
    /// The roughness asked for.
    Roughness,
    /// Lag of the size behind the feed: deflection and contact.
    Lag,
    /// The tolerance asked for.
    Tolerance,
    /// Roundness: turns of the part.
    Roundness,
    /// The stock of the part.
    Stock,
}

/// Roughing or finishing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlungeStage {
    /// Removal rate per millimetre of width, mm³/(mm·s).
    pub removal_mm2_s: f64,
    /// Feed of the slide, mm/min.
    pub feed_mm_min: f64,
    /// Power of the wheel motor that it takes, kW.
    pub power_kw: f64,
    /// What sets it.
    pub limit: ProposalLimit,
}

/// Dressing with a single-point diamond.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dressing {
    /// Depth of a pass, mm.
    pub depth_mm: f64,
    /// Overlap ratio: effective width of the diamond over the lead.
    pub overlap: f64,
    /// Lead, mm per turn of the wheel.
    pub lead_mm: f64,
    /// Traverse feed, mm/min.
    pub feed_mm_min: f64,
    /// Parts between two dressings.
    pub every_parts: f64,
}

/// What is proposed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlungeProposal {
    /// Surface speed of the wheel, m/s, and what sets it.
    pub wheel_m_s: (f64, ProposalLimit),
    /// Speed of the wheel, rpm.
    pub wheel_rpm: f64,
    /// Speed of the part, m/min.
    pub work_m_min: f64,
    /// The speed of the part by the speed ratio of the material, rpm: the headstock is set to the nearer one.
    pub advised_work_rpm: f64,
    /// Roughing.
    pub rough: PlungeStage,
    /// Finishing.
    pub finish: PlungeStage,
    /// Where roughing begins: left on the diameter, mm.
    pub rough_from_mm: f64,
    /// Left on the diameter for finishing, mm, and what sets it.
    pub finish_allowance_mm: (f64, ProposalLimit),
    /// Spark-out, s, and what sets it.
    pub spark_out_s: (f64, ProposalLimit),
    /// Dressing.
    pub dressing: Dressing,
    /// From the clearance to the end of the spark-out, s.
    pub time_s: f64,
}

impl PlungeProposal {
    /// The value of a grinding page with a meaning, rounded to the careful side; `None`: it is not proposed.
    #[must_use]
    pub fn value_of(&self, meaning: PageMeaning) -> Option<f64> {
        let up = |value: f64, steps: f64| (value * steps - ROUNDING).ceil() / steps;
        let down = |value: f64| {
            let steps = if value < 0.1 { 1_000.0 } else { 100.0 };
            (value * steps + ROUNDING).floor().max(1.0) / steps
        };
        match meaning {
            PageMeaning::RoughAllowance => Some(up(self.rough_from_mm, 100.0)),
            PageMeaning::FinishAllowance => Some(up(self.finish_allowance_mm.0, 200.0)),
            PageMeaning::RoughFeed => Some(down(self.rough.feed_mm_min)),
            PageMeaning::FinishFeed => Some(down(self.finish.feed_mm_min)),
            PageMeaning::SparkOut => Some(up(self.spark_out_s.0, 2.0)),
            PageMeaning::DressingInterval => Some(self.dressing.every_parts),
            _ => None,
        }
    }
}

/// A task for which there is no proposal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TaskError {
    /// A size of the part that must be above zero is not.
    #[error("a diameter, width, stock, tolerance or roughness of the part is not above zero")]
    PartSize,
    /// A size or speed of the wheel or the machine that must be above zero is not.
    #[error("a size, speed, power or time of wheel and machine is not above zero")]
    WheelOrMachine,
    /// The wheel is narrower than the ground width.
    #[error("the wheel is narrower than the ground width: the part is not a plunge")]
    WheelTooNarrow,
}

/// The proposal for a task.
///
/// # Errors
/// See [`TaskError`].
pub fn propose(task: &GrindingTask) -> Result<PlungeProposal, TaskError> {
    check(task)?;
    let GrindingTask { part, wheel, machine } = task;
    let (wheel_m_s, wheel_rpm) = wheel_speed(wheel);
    let girth_m = PI * part.diameter_mm / 1_000.0;
    let (work_m_min, advised_m_min) = (girth_m * machine.work_rpm, wheel_m_s.0 * 60.0 / part.material.speed_ratio);
    let advised_work_rpm = advised_m_min / girth_m;
    let rough = roughing(task);
    let finish = finishing(task, &rough);
    let (rough_mm_s, finish_mm_s) = (rough.feed_mm_min / 60.0, finish.feed_mm_min / 60.0);
    let tau = machine.time_constant_s;
    let finish_allowance_mm = finish_allowance(part, SETTLING * tau * finish_mm_s);
    // What is left of the lag of roughing, and the lag of finishing.
    let settled = (-finish_allowance_mm.0 / 2.0 / finish_mm_s / tau).exp();
    let lag_mm = tau * (finish_mm_s + (rough_mm_s - finish_mm_s) * settled);
    let spark_out_s = spark_out(part, lag_mm, machine);
    let rough_from_mm = part.stock_mm + CLEARANCE_MM;
    let time_s = (rough_from_mm - finish_allowance_mm.0).max(0.0) / 2.0 / rough_mm_s
        + finish_allowance_mm.0 / 2.0 / finish_mm_s
        + spark_out_s.0;
    let dressing = dressing(part, wheel_rpm);
    Ok(PlungeProposal {
        wheel_m_s,
        wheel_rpm,
        work_m_min,
        advised_work_rpm,
        rough,
        finish,
        rough_from_mm,
        finish_allowance_mm,
        spark_out_s,
        dressing,
        time_s,
    })
}

fn check(task: &GrindingTask) -> Result<(), TaskError> {
    let GrindingTask { part, wheel, machine } = task;
    let is_wrong = |values: &[f64]| values.iter().any(|value| !value.is_finite() || *value <= 0.0);
    if is_wrong(&[part.diameter_mm, part.width_mm, part.stock_mm, part.tolerance_mm, part.roughness_um]) {
        return Err(TaskError::PartSize);
    }
    let of_wheel = [wheel.diameter_mm, wheel.width_mm, wheel.rated_m_s, wheel.rpm];
    if is_wrong(&of_wheel) || is_wrong(&[machine.wheel_kw, machine.time_constant_s, machine.work_rpm]) {
        return Err(TaskError::WheelOrMachine);
    }
    if wheel.width_mm < part.width_mm {
        return Err(TaskError::WheelTooNarrow);
    }
    Ok(())
}

/// Surface speed and rpm: as set, at most as rated.
fn wheel_speed(wheel: &MountedWheel) -> ((f64, ProposalLimit), f64) {
    let girth_m = PI * wheel.diameter_mm / 1_000.0;
    let as_set = girth_m * wheel.rpm / 60.0;
    match as_set > wheel.rated_m_s {
        true => ((wheel.rated_m_s, ProposalLimit::WheelRating), wheel.rated_m_s * 60.0 / girth_m),
        false => ((as_set, ProposalLimit::WheelSpeed), wheel.rpm),
    }
}

fn roughing(task: &GrindingTask) -> PlungeStage {
    let GrindingTask { part, machine, .. } = task;
    let material = &part.material;
    let power = SAFE_SHARE * machine.wheel_kw * 1_000.0 / (material.energy_j_mm3 * part.width_mm);
    let burn = task.burn_limit_mm2_s().map_or(f64::INFINITY, |limit| SAFE_SHARE * limit);
    let limits = [
        (power, ProposalLimit::Power),
        (burn, ProposalLimit::Burn),
        (material.economical_mm2_s, ProposalLimit::WheelWear),
    ];
    let least = limits.into_iter().reduce(|least, other| if other.0 < least.0 { other } else { least });
    let (removal_mm2_s, limit) = least.unwrap_or((power, ProposalLimit::Power));
    stage(part, removal_mm2_s, limit)
}

fn finishing(task: &GrindingTask, rough: &PlungeStage) -> PlungeStage {
    let part = &task.part;
    let wanted = FINISH_MM2_S * part.roughness_um / FINISH_ROUGHNESS_UM;
    let wanted = wanted.clamp(FINISH_RANGE_MM2_S.0, FINISH_RANGE_MM2_S.1);
    match wanted < rough.removal_mm2_s {
        true => stage(part, wanted, ProposalLimit::Roughness),
        false => *rough,
    }
}

fn stage(part: &PlungePart, removal_mm2_s: f64, limit: ProposalLimit) -> PlungeStage {
    PlungeStage {
        removal_mm2_s,
        feed_mm_min: removal_mm2_s * 60.0 / (PI * part.diameter_mm),
        power_kw: removal_mm2_s * part.width_mm * part.material.energy_j_mm3 / 1_000.0,
        limit,
    }
}

/// The lag of roughing must decay within the finishing allowance; `way_mm` is on the radius.
fn finish_allowance(part: &PlungePart, way_mm: f64) -> (f64, ProposalLimit) {
    let wanted = 2.0 * way_mm;
    match wanted < part.stock_mm / 2.0 {
        true => (wanted, ProposalLimit::Lag),
        false => (part.stock_mm / 2.0, ProposalLimit::Stock),
    }
}

/// Until a tenth of the tolerance is left of the lag, and some turns of the part.
fn spark_out(part: &PlungePart, lag_mm: f64, machine: &GrindingMachine) -> (f64, ProposalLimit) {
    let left = LEFT_OF_TOLERANCE * part.tolerance_mm / 2.0;
    let for_size = machine.time_constant_s * (lag_mm / left).max(1.0).ln();
    let for_turns = SPARK_OUT_TURNS * 60.0 / machine.work_rpm;
    if for_size > for_turns { (for_size, ProposalLimit::Tolerance) } else { (for_turns, ProposalLimit::Roundness) }
}

/// The finer the surface, the finer the wheel is dressed.
fn dressing(part: &PlungePart, wheel_rpm: f64) -> Dressing {
    let (overlap, depth_mm) = match part.roughness_um {
        ra if ra >= 0.8 => (3.0, 0.02),
        ra if ra >= 0.4 => (4.0, 0.02),
        ra if ra >= 0.2 => (6.0, 0.01),
        _ => (8.0, 0.01),
    };
    let lead_mm = effective_width_mm(depth_mm) / overlap;
    let of_a_part_mm2 = PI * part.diameter_mm * part.stock_mm / 2.0;
    let every_parts = (part.material.dressed_after_mm2 / of_a_part_mm2).floor().max(1.0);
    Dressing { depth_mm, overlap, lead_mm, feed_mm_min: lead_mm * wheel_rpm, every_parts }
}

#[cfg(test)]
mod tests {
    use super::super::MATERIALS;
    use super::*;

    /// The land of O1002 as shipped: Ø40.3 to Ø40, 18 mm, wheel Ø600 at 1100 rpm.
    fn task(material: GroundMaterial) -> GrindingTask {
        GrindingTask {
            part: PlungePart {
                material,
                diameter_mm: 40.0,
                width_mm: 18.0,
                stock_mm: 0.3,
                tolerance_mm: 0.02,
                roughness_um: 0.4,
            },
            wheel: MountedWheel { diameter_mm: 600.0, width_mm: 20.0, rated_m_s: 35.0, rpm: 1_100.0 },
            machine: GrindingMachine { wheel_kw: 7.5, time_constant_s: 0.8, work_rpm: 200.0 },
        }
    }

    fn close(found: f64, wanted: f64, within: f64) -> bool {
        (found - wanted).abs() <= within
    }

    /// By hand: v_s = π·0.6·1100/60 = 34.558 m/s, by q = 80 25.918 m/min, 206.25 rpm at Ø40. The headstock turns at 200:
    /// v_w = 25.133 m/min = 418.88 mm/s; d_e = 37.5 mm, d_e^(1/4) = 2.47461.
    /// a = (7.2·2.47461/(20.4665·38.8))^(4/3) = 0.0224369^(4/3) = 0.0063282 mm; Q'w = 0.0063282·418.88 = 2.6508; 0.8 of it
    /// is 2.1206; v_f = 2.1206·60/(π·40) = 1.0125 mm/min.
    #[test]
    fn hardened_steel_is_roughed_below_its_burn_limit() {
        let found = propose(&task(MATERIALS[0])).unwrap();
        assert!(close(found.wheel_m_s.0, 34.558, 0.001) && found.wheel_m_s.1 == ProposalLimit::WheelSpeed);
        assert!(close(found.work_m_min, 25.133, 0.001) && close(found.advised_work_rpm, 206.25, 0.01));
        assert_eq!(found.rough.limit, ProposalLimit::Burn);
        assert!(close(found.rough.removal_mm2_s, 2.1206, 0.003), "{:?}", found.rough);
        assert!(close(found.rough.feed_mm_min, 1.0125, 0.002), "{:?}", found.rough);
        // 2.1206·18·45 = 1.718 kW.
        assert!(close(found.rough.power_kw, 1.718, 0.003));
        // Finishing at 0.5: 0.5·60/125.664 = 0.23873 mm/min.
        assert!(close(found.finish.feed_mm_min, 0.23873, 1e-4) && found.finish.limit == ProposalLimit::Roughness);
        // 2·3·0.8·0.23873/60 = 0.019099.
        assert!(close(found.finish_allowance_mm.0, 0.019_099, 1e-5));
        assert_eq!(found.finish_allowance_mm.1, ProposalLimit::Lag);
        // Lag 0.8·(0.0039789 + (0.016875 − 0.0039789)·e^-3) = 3.697 µm over 1 µm: 0.8·ln 3.697 = 1.046 s; five turns at
        // 200 rpm are 1.5 s.
        assert!(close(found.spark_out_s.0, 1.5, 1e-9) && found.spark_out_s.1 == ProposalLimit::Roundness);
    }

    /// A part that turns slower burns earlier, by (60/200)^(1/3), and needs longer for its five turns.
    #[test]
    fn the_speed_of_the_headstock_sets_burn_limit_and_spark_out() {
        let mut slow = task(MATERIALS[0]);
        slow.machine.work_rpm = 60.0;
        let (slow, fast) = (propose(&slow).unwrap(), propose(&task(MATERIALS[0])).unwrap());
        let ratio = slow.rough.removal_mm2_s / fast.rough.removal_mm2_s;
        assert!(close(ratio, 0.3_f64.cbrt(), 1e-9), "{ratio}");
        assert!(close(slow.spark_out_s.0, 5.0, 1e-9) && slow.spark_out_s.1 == ProposalLimit::Roundness);
    }

    /// With half the stock for finishing the lag of roughing has not decayed: it is sparked out. τ = 10 s, Ra 0.4:
    /// allowance 0.15 of the 0.2387 that three τ need; t = 0.075/0.0039789 = 18.85 s, e^-1.885 = 0.1518; lag
    /// 10·(0.0039789 + 0.0128966·0.1518) = 59.37 µm over 1 µm: 10·ln 59.37 = 40.84 s.
    #[test]
    fn what_finishing_leaves_of_the_lag_is_sparked_out() {
        let mut soft = task(MATERIALS[0]);
        soft.machine.time_constant_s = 10.0;
        let found = propose(&soft).unwrap();
        assert!(close(found.finish_allowance_mm.0, 0.15, 1e-9) && found.finish_allowance_mm.1 == ProposalLimit::Stock);
        assert!(close(found.spark_out_s.0, 40.84, 0.02), "{:?}", found.spark_out_s);
    }

    /// Feeds are rounded down, allowances and times up.
    #[test]
    fn values_are_rounded_to_the_careful_side() {
        let found = propose(&task(MATERIALS[0])).unwrap();
        let rows = [
            (PageMeaning::RoughAllowance, 0.4),
            (PageMeaning::FinishAllowance, 0.02),
            (PageMeaning::RoughFeed, 1.01),
            (PageMeaning::FinishFeed, 0.23),
            (PageMeaning::SparkOut, 1.5),
            (PageMeaning::DressingInterval, 26.0),
        ];
        for (meaning, wanted) in rows {
            assert!(
                close(found.value_of(meaning).unwrap(), wanted, 1e-9),
                "{meaning:?}: {:?}",
                found.value_of(meaning)
            );
        }
        assert_eq!(found.value_of(PageMeaning::BlankDiameter), None);
    }

    /// The other limits, each where it is the least.
    #[test]
    fn each_limit_sets_the_feed_where_it_is_the_least() {
        let rough = |change: &dyn Fn(&mut GrindingTask)| {
            let mut task = task(MATERIALS[4]);
            change(&mut task);
            propose(&task).unwrap()
        };
        let wear = rough(&|_| {});
        assert_eq!(
            (wear.rough.limit, wear.rough.removal_mm2_s.to_bits()),
            (ProposalLimit::WheelWear, 4.0_f64.to_bits())
        );
        // 0.8·0.5 kW/(25·18) = 0.889.
        let power = rough(&|task| task.machine.wheel_kw = 0.5);
        assert!(power.rough.limit == ProposalLimit::Power && close(power.rough.removal_mm2_s, 0.8889, 1e-3));
        assert!(power.rough.power_kw <= 0.4 + 1e-9);
        let rated = rough(&|task| task.wheel.rated_m_s = 30.0);
        assert!(rated.wheel_m_s == (30.0, ProposalLimit::WheelRating) && close(rated.wheel_rpm, 954.93, 0.01));
        let tight = rough(&|task| (task.part.tolerance_mm, task.machine.time_constant_s) = (0.002, 10.0));
        assert_eq!(
            (tight.spark_out_s.1, tight.finish_allowance_mm.1),
            (ProposalLimit::Tolerance, ProposalLimit::Stock)
        );
    }

    /// More roughness, power, width of tolerance never make the proposal slower; every stage keeps its limits.
    #[test]
    fn a_wider_task_is_never_slower() {
        for material in MATERIALS {
            let mut last: Option<PlungeProposal> = None;
            for step in 0..8 {
                let mut task = task(material);
                task.part.roughness_um = 0.1 + 0.1 * f64::from(step);
                task.part.tolerance_mm = 0.004 + 0.002 * f64::from(step);
                let found = propose(&task).unwrap();
                assert!(found.finish.removal_mm2_s <= found.rough.removal_mm2_s + 1e-12);
                assert!(found.rough.power_kw <= 0.8 * task.machine.wheel_kw + 1e-9);
                assert!(found.finish_allowance_mm.0 <= task.part.stock_mm / 2.0 + 1e-12);
                assert!(last.is_none_or(|last| found.finish.feed_mm_min >= last.finish.feed_mm_min - 1e-12));
                last = Some(found);
            }
        }
    }

    /// Ra 0.2: overlap 6 at 0.01 mm: √(8·0.5·0.01) = 0.2 mm, lead 0.0333 mm, 36.67 mm/min at 1100 rpm. A part takes
    /// π·40·0.15 = 18.85 mm² of width: 500 are 26 parts.
    #[test]
    fn a_finer_surface_is_dressed_finer() {
        let mut task = task(MATERIALS[0]);
        task.part.roughness_um = 0.2;
        let found = propose(&task).unwrap().dressing;
        assert!(close(found.lead_mm, 0.033_333, 1e-5) && close(found.feed_mm_min, 36.667, 0.01));
        assert!(close(found.every_parts, 26.0, 1e-9));
        assert!(propose(&super::tests::task(MATERIALS[0])).unwrap().dressing.lead_mm > found.lead_mm);
    }

    #[test]
    fn a_task_without_a_size_has_no_proposal() {
        let mut no_stock = task(MATERIALS[0]);
        no_stock.part.stock_mm = 0.0;
        assert_eq!(propose(&no_stock), Err(TaskError::PartSize));
        let mut wide = task(MATERIALS[0]);
        wide.part.width_mm = 21.0;
        assert_eq!(propose(&wide), Err(TaskError::WheelTooNarrow));
        let mut odd = task(MATERIALS[0]);
        odd.wheel.rpm = f64::NAN;
        assert_eq!(propose(&odd), Err(TaskError::WheelOrMachine));
    }
}
