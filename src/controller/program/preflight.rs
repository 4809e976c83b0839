//! The preflight of a program: the whole text is read before anything is executed.

use super::lookahead_state::reference_points;
use crate::controller::plant::Plant;
use crate::nc::{NcSettings, OfflineMachine};

/// The state from which a preflight follows a program.
pub fn preflight_world(plant: &Plant, settings: &NcSettings) -> OfflineMachine {
    OfflineMachine::new(settings)
        .with_references(reference_points(&plant.params))
        .with_work_offsets(plant.work.offsets.clone())
        .with_position(plant.work.offsets.work_from_machine(plant.axes.set_point()))
        .with_block_skip(plant.operator.switches.block_skip)
}
