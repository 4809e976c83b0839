//! The preflight of a program: the whole text is read before anything is executed.

use std::sync::Arc;

use super::lookahead_state::reference_points;
use crate::controller::plant::Plant;
use crate::nc::{self, OfflineMachine, Source};

/// A preflight of a program from the present state, if its dialect supports it.
pub fn new_preflight(plant: &Plant, source: &Arc<Source>, settings: &nc::NcSettings) -> Option<nc::ProgramPreflight> {
    let library: Arc<dyn nc::Library + Send + Sync> = Arc::clone(&plant.work.programs) as _;
    let world = OfflineMachine::new(settings)
        .with_references(reference_points(&plant.params))
        .with_work_offsets(plant.work.offsets.clone())
        .with_position(plant.work.offsets.work_from_machine(plant.axes.set_point()))
        .with_block_skip(plant.operator.switches.block_skip);
    nc::ProgramPreflight::new(source, &library, settings, world)
}
