//! The grinding task: sizes of the part from the values of the grinding page, the rest from parameters.

use crate::defs::param;
use crate::defs::value_role::ValueRole;
use crate::hmi::View;
use crate::link::command::ScreenFiles;
use crate::technology::{GrindingMachine, GrindingTask, GroundMaterial, MATERIALS, MountedWheel, PlungePart};

/// Tolerance of a page without deviations, mm.
const USUAL_TOLERANCE_MM: f64 = 0.02;

/// Whether the page has the sizes of a part.
pub fn has_sizes(files: &ScreenFiles) -> bool {
    [ValueRole::BlankDiameter, ValueRole::FinishedDiameter].iter().all(|role| files.variable_of(*role).is_some())
}

/// The value of a role; `None`: the page has none, or it is empty.
pub fn value(view: &View<'_>, files: &ScreenFiles, role: ValueRole) -> Option<f64> {
    view.snapshot.variables.get(usize::from(files.variable_of(role)?)).copied().flatten()
}

/// The material of P470.
pub fn material(view: &View<'_>) -> GroundMaterial {
    let number = view.snapshot.params.get(param::GROUND_MATERIAL) as usize;
    MATERIALS[number.clamp(1, MATERIALS.len()) - 1]
}

/// The task as it stands. A size that is empty is 0: there is no proposal then.
pub fn task(view: &View<'_>, files: &ScreenFiles) -> GrindingTask {
    let params = &view.snapshot.params;
    let size = |role| value(view, files, role);
    let finished = size(ValueRole::FinishedDiameter).unwrap_or(0.0);
    let deviations = size(ValueRole::UpperDeviation).zip(size(ValueRole::LowerDeviation));
    GrindingTask {
        part: PlungePart {
            material: material(view),
            diameter_mm: finished,
            width_mm: params.get(param::GROUND_WIDTH),
            stock_mm: size(ValueRole::BlankDiameter).unwrap_or(0.0) - finished,
            tolerance_mm: deviations.map_or(USUAL_TOLERANCE_MM, |(upper, lower)| upper - lower),
            roughness_um: params.get(param::GROUND_ROUGHNESS),
        },
        wheel: MountedWheel {
            diameter_mm: params.get(param::WHEEL_DIAMETER),
            width_mm: params.get(param::WHEEL_WIDTH),
            rated_m_s: params.get(param::WHEEL_RATED_SPEED),
            rpm: params.get(param::WHEEL_RPM),
        },
        machine: GrindingMachine {
            wheel_kw: params.get(param::WHEEL_MOTOR_POWER),
            time_constant_s: params.get(param::CONTACT_TIME_CONSTANT),
        },
    }
}
