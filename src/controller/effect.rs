//! What the core asks the disk to do. It never waits for it: the answer comes back as a command.
//! Source: style "effects to the disk", notes "acknowledge after commit".

use super::files::Job;
use crate::defs::history::PastAlarm;
use crate::defs::param::ParamAddress;
use crate::defs::screw::ScrewTable;
use crate::defs::signal::{Input, Output};
use crate::defs::turning_tool;
use crate::link::page_command::PageWish;
use crate::units::{Axis, PerAxis};

/// One wish.
#[derive(Clone, Debug, PartialEq)]
pub enum Effect {
    /// Keep the value of a retained variable; `None` is null.
    Variable(u32, Option<f64>),
    /// Keep a parameter.
    Param(ParamAddress, f64),
    /// Keep a tool offset (1 to 16): geometry and wear, radius mm.
    Offset {
        /// Number.
        number: usize,
        /// Geometry.
        geometry: PerAxis<f64>,
        /// Wear.
        wear: PerAxis<f64>,
    },
    /// Keep a work frame: index 0 is G54; origin in machine coordinates, radius mm.
    Frame(usize, PerAxis<f64>),
    /// Keep the dressing point of an axis: machine coordinate, radius mm.
    DressPoint(Axis, f64),
    /// Keep the table of an axis' screw.
    Screw(Axis, ScrewTable),
    /// Keep the number of the current program.
    CurrentProgram(u32),
    /// Keep where the running program is, for a power cut: program and line from 1; none when it is over.
    RunningAt(Option<(u32, u32)>),
    /// Keep an alarm of the history, in place of the one in its slot.
    Alarm(Box<PastAlarm>),
    /// Keep what was set at the machine, less what the computer's clock read, seconds.
    ClockOffset(i64),
    /// Keep the count of workpieces.
    Parts(u32),
    /// Work for the thread beside the tick: folders, long calculations. It is answered by commands.
    Job(Box<Job>),
    /// What a page asks of the disk: passwords, settings. It is answered by a command.
    Ask(PageWish),
}

impl Effect {
    /// Whether it assigns a port to a function, or gives a tool of a lathe another shape.
    #[must_use]
    pub fn refits_machine(&self) -> bool {
        let is_port = |number| {
            Input::ALL.iter().any(|input| input.port_param() == number)
                || Output::ALL.iter().any(|output| output.port_param() == number)
                || turning_tool::ROWS.iter().flatten().any(|row| row.number == number)
        };
        matches!(self, Self::Param(at, _) if at.bit.is_none() && is_port(at.number))
    }
}
