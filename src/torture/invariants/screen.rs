//! What a lost screen leaves: as after an emergency stop. Source: spec K3 ("what stops what").

use super::outputs::OFF_IN_AN_EMERGENCY;
use super::{BRAKING, Moment, REACTION, hold, hold_output};
use crate::defs::param;
use crate::link::command::Command;
use crate::link::page_command::PageCommand;
use crate::units::Micros;

/// Whether the disk tells something: that is no word of the screen.
const fn is_of_storage(command: &Command) -> bool {
    matches!(
        command,
        Command::Stored(_)
            | Command::DiskFailed(_)
            | Command::ScreensLoaded(_)
            | Command::WallClock(_)
            | Command::Page(PageCommand::StorageAnswered(_))
    )
}

/// Since when the screen is silent, while nothing else was asked for.
#[derive(Default)]
pub struct ScreenRules {
    heard: Option<Micros>,
}

impl ScreenRules {
    pub(super) fn check(&mut self, moment: &Moment<'_>) -> Result<(), String> {
        if !moment.powered {
            self.heard = None;
            return Ok(());
        }
        if moment.screen_heard {
            self.heard = Some(moment.now);
        } else if !moment.commands.iter().all(is_of_storage) {
            // A screen that hangs asks for nothing.
            self.heard = None;
        }
        let Some(heard) = self.heard else { return Ok(()) };
        let silent = moment.now.since(heard);
        let latest = moment.controller.params().millis(param::HMI_KEEP_ALIVE) + REACTION;
        if silent <= latest {
            return Ok(());
        }
        let on = moment.outputs_on;
        for output in OFF_IN_AN_EMERGENCY {
            hold_output("is on without a screen", output, !on.has(output))?;
        }
        let braked = silent > latest + BRAKING;
        hold("the drives are on without a screen", !(braked && moment.machine.written.drives_on))
    }
}
