//! Grinding technology: what a plunge on an outside diameter should be ground with, and by which limit each value is set;
//! what the sizes of a series say of the process (`capability`).
//!
//! Everything is calculated from the task (part, wheel, machine); nothing here moves an axis. The constants are starting
//! values of practice for vitrified corundum wheels with emulsion; the machine and the first parts decide.
//!
//! | value | from |
//! |---|---|
//! | advised work speed | the speed ratio q = v_s/v_w of the material; the headstock has two speeds |
//! | roughing | the least of three removal rates: burn limit, motor power, economical wear of the wheel |
//! | finishing | the removal rate of the roughness asked for |
//! | finishing allowance, spark-out | the lag of the size behind the feed, v_f·τ, which decays with the time constant τ |
//! | dressing | the overlap ratio of the roughness, the effective width of the diamond |
//!
//! Sources: S. Malkin, C. Guo, Grinding Technology, 2nd ed. 2008 (specific energy, burn limit, time constant, spark-out);
//! S. Malkin, R. B. Lenz, CIRP Annals 27 (1978) 233 (burn limit of steels); F. Klocke, Manufacturing Processes 2, 2009
//! (speed ratio, removal rates, overlap ratio). Spec: issue "a good part, always", part D.

mod burn;
mod capability;
mod dressing;
mod material;
mod plunge;
mod roughness;

pub use burn::burn_limit_mm2_s;
pub use capability::{Capability, EwmaPoint, MIN_PARTS, capability, ewma};
pub use dressing::{DressedWheel, effective_width_mm};
pub use material::{GroundMaterial, MATERIALS};
pub use plunge::{
    Dressing, GrindingMachine, GrindingTask, MountedWheel, PlungePart, PlungeProposal, PlungeStage, ProposalLimit,
    TaskError, propose,
};
pub use roughness::{DressingPass, roughness_um};
