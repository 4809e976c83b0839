//! The grinding task: sizes of the part from the values of the grinding page, the rest from parameters.

use crate::defs::page_meaning::{PageMeaning, SizeKind};
use crate::defs::page_text::PageText;
use crate::defs::param;
use crate::hmi::View;
use crate::technology::{GrindingMachine, GrindingTask, GroundMaterial, MATERIALS, MountedWheel, PlungePart};

/// Tolerance where neither P376 to P378 nor the page has deviations, mm.
const USUAL_TOLERANCE_MM: f64 = 0.02;

/// The finished diameter.
const FINISHED: PageMeaning = PageMeaning::Nominal(SizeKind::Diameter);

/// Whether the page has the sizes of a part and the feed of a plunge.
pub fn is_plunge(text: &PageText) -> bool {
    let has = |meaning| variable_of(text, meaning).is_some();
    has(PageMeaning::BlankDiameter) && has(FINISHED) && has(PageMeaning::RoughFeed)
}

/// The variable of the page with a meaning.
pub fn variable_of(text: &PageText, meaning: PageMeaning) -> Option<u16> {
    text.variable(|found| found == meaning)
}

/// The value with a meaning; `None`: the page has none, or it is empty.
pub fn value(view: &View<'_>, text: &PageText, meaning: PageMeaning) -> Option<f64> {
    view.snapshot.variables.get(usize::from(variable_of(text, meaning)?)).copied().flatten()
}

/// The material of P470.
pub fn material(view: &View<'_>) -> GroundMaterial {
    let number = view.snapshot.params.get(param::GROUND_MATERIAL) as usize;
    MATERIALS[number.clamp(1, MATERIALS.len()) - 1]
}

/// The task as it stands. A size that is empty is 0: there is no proposal then.
pub fn task(view: &View<'_>, text: &PageText) -> GrindingTask {
    let params = &view.snapshot.params;
    let size = |meaning| value(view, text, meaning);
    let finished = size(FINISHED).unwrap_or(0.0);
    let limits = view.snapshot.size_values().nominal().and_then(|nominal| nominal.limits);
    // 0 is low.
    let is_low = size(PageMeaning::HeadstockSpeed).is_some_and(|speed| speed < 0.5);
    let work_rpm = params.get(if is_low { param::HEADSTOCK_RPM_LOW } else { param::HEADSTOCK_RPM_HIGH });
    GrindingTask {
        part: PlungePart {
            material: material(view),
            diameter_mm: finished,
            width_mm: params.get(param::GROUND_WIDTH),
            stock_mm: size(PageMeaning::BlankDiameter).unwrap_or(0.0) - finished,
            tolerance_mm: limits.map_or(USUAL_TOLERANCE_MM, |(low, high)| high - low),
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
            work_rpm,
        },
    }
}
