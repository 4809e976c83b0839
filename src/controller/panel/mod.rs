//! The panel: keys, commands, pages, edits, files, and the snapshot for the screen.
//! Source: spec B6, K2, K7.

mod access;
mod calendar;
mod commands;
mod edit_protection;
mod edits;
pub mod files;
mod hours;
mod keys;
mod lamps;
mod offsets;
mod page_files;
mod pages;
mod part_result;
mod production;
mod scope;
mod snapshot;
mod start_guide;
mod switches;
mod wheel_change;
mod wheel_list;

pub use commands::voids_starts;
pub use snapshot::run_state;

use std::sync::Arc;

use super::manual::Manual;
use super::plant::Plant;
use super::power_on::PowerOnState;
use super::program::Program;
use crate::defs::kind::Kind;
use crate::defs::text::LocalizedText;
use crate::link::cycle_times::CycleTimes;
use crate::link::edit::EditAnswer;
use crate::link::part_result::PartResult;
use crate::link::screens::Screens;
use crate::link::snapshot::DirectoryRow;
use crate::units::{MachinePos, Micros};

/// The parts on which a key or a command acts.
pub struct Parts<'a> {
    /// The plant.
    pub plant: &'a mut Plant,
    /// The program.
    pub program: &'a mut Program,
    /// Manual operation.
    pub manual: &'a mut Manual,
}

/// The parts as the screen sees them.
#[derive(Clone, Copy)]
pub struct PartsView<'a> {
    /// The plant.
    pub plant: &'a Plant,
    /// The program.
    pub program: &'a Program,
    /// Manual operation.
    pub manual: &'a Manual,
}

impl Parts<'_> {
    /// The parts for reading.
    #[must_use]
    pub const fn view(&self) -> PartsView<'_> {
        PartsView { plant: self.plant, program: self.program, manual: self.manual }
    }
}

/// The answer to an edit: what was changed, or why it was refused.
pub type Edited = Result<LocalizedText, LocalizedText>;

/// The state of the panel that no other part shares.
#[derive(Default)]
pub struct Panel {
    pages: pages::PageState,
    access: access::Access,
    /// Answer to the last edit.
    edit_answer: EditAnswer,
    files: files::FileRequests,
    screens: Arc<Screens>,
    /// The directory of the programs folder.
    pub directory: Arc<Vec<DirectoryRow>>,
    /// Date and time of day.
    pub calendar: calendar::Calendar,
    relative_zero: MachinePos,
    /// The scope.
    pub scope: scope::ScopeRecorder,
    /// The part that the last cycle has finished; cleared by the next cycle.
    pub part_result: Option<PartResult>,
    /// Finished parts and production orders.
    production: production::Production,
    wheels: wheel_list::WheelList,
    /// Parts that the open run had counted as of the last tick.
    parts_counted: u32,
    /// Program and durations of the last finished cycle.
    cycle_before: Option<(u32, CycleTimes)>,
}

impl Panel {
    /// The panel at power-on.
    #[must_use]
    pub fn new(kind: Kind, retained: &PowerOnState, now: Micros) -> Self {
        Self {
            pages: pages::PageState::new(kind, &retained.kept_states),
            calendar: calendar::Calendar::new(retained.clock_offset_s),
            access: access::Access::at_power_on(retained.wrong_passwords, now),
            production: production::Production::at_power_on(retained, now),
            wheels: wheel_list::WheelList::at_power_on(&retained.wheels),
            ..Self::default()
        }
    }
}
