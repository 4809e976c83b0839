//! Requests of the core to the disk thread. The core never waits: the answer comes back as a command.
//! Source: style "effects to the disk", notes "acknowledge after commit".

use std::sync::Arc;

use super::program::library::Programs;
use crate::defs::alarm_history::PastAlarm;
use crate::defs::date::DateTime;
use crate::defs::hour_record::HourRecord;
use crate::defs::kind::Kind;
use crate::defs::leadscrew::LeadscrewCompensation;
use crate::defs::param::{ParamAddress, Params};
use crate::defs::part_record::PartRecord;
use crate::defs::production_order::ProductionOrder;
use crate::defs::signal::{Input, Output};
use crate::defs::text::arg::Arg;
use crate::defs::turning_tool;
use crate::defs::wheel_record::WheelRecord;
use crate::link::files::{FileRequest, Ticket};
use crate::link::page_command::SettingsRequest;
use crate::nc::{CommonVariables, NcSettings, OriginPlace, REFERENCE_POINTS, WorkOffsets};
use crate::units::{Axis, MachinePos, PerAxis, WorkPos};

/// One request.
#[derive(Clone, Debug, PartialEq)]
pub enum StorageRequest {
    /// Store the value of a retained variable; `None` is null.
    Variable(u32, Option<f64>),
    /// Store a parameter.
    Param(ParamAddress, f64),
    /// Store a tool offset (1 to 16): geometry and wear, radius mm.
    Offset {
        /// Number.
        number: usize,
        /// Geometry.
        geometry: PerAxis<f64>,
        /// Wear.
        wear: PerAxis<f64>,
    },
    /// Store the radius of a tool offset (1 to 16), mm.
    CutterRadius(usize, f64),
    /// Store the place of the programmed point of a tool offset (1 to 16).
    CutterTip(usize, u8),
    /// Store a work offset or the external one: origin in machine coordinates, radius mm.
    WorkOffset(OriginPlace, PerAxis<f64>),
    /// Store the dressing point of an axis: machine coordinate, radius mm; `None` removes it.
    DressPoint(Axis, Option<f64>),
    /// Store the leadscrew compensation table of an axis.
    LeadscrewTable(Axis, LeadscrewCompensation),
    /// Store the number of the current program.
    CurrentProgram(u32),
    /// Store the position of the running program for a power failure: program, line from 1; `None` when it is over.
    RunningAt(Option<(u32, u32)>),
    /// Store an alarm of the history in its slot.
    Alarm(PastAlarm),
    /// Store a finished part in its slot.
    Part(PartRecord),
    /// Store an hour of the machine in its slot.
    Hour(HourRecord),
    /// Store the order of a number; `None` removes it.
    Order(u32, Option<ProductionOrder>),
    /// Store the wheel of a number; `None` removes it.
    Wheel(u16, Option<WheelRecord>),
    /// Store the date set at the machine minus the system clock, s.
    ClockOffset(i64),
    /// Store the number of wrong passwords in a row; 0 after a right one.
    WrongPasswords(u32),
    /// Store the workpiece count.
    PartCount(u32),
    /// Add a line that a program prints (DPRNT) to the file of the day.
    PrintLine(DateTime, Arg),
    /// A job for the background thread: folders, long calculations. It is answered by commands.
    Job(Box<BackgroundJob>),
    /// A request of a page: passwords, settings. It is answered by a command.
    Page(SettingsRequest),
    /// The end of a batch of values: the disk thread acknowledges it once everything before it is stored.
    Mark(u64),
}

impl StorageRequest {
    /// Whether it changes retained data.
    #[must_use]
    pub const fn is_retained(&self) -> bool {
        !matches!(self, Self::PrintLine(..) | Self::Page(_) | Self::Job(_) | Self::Mark(_))
    }

    /// Whether it assigns a port to a function or changes the shape of a lathe tool.
    #[must_use]
    pub fn changes_machine_setup(&self) -> bool {
        let is_port = |number| {
            Input::ALL.iter().any(|input| input.port_param() == number)
                || Output::ALL.iter().any(|output| output.port_param() == number)
                || turning_tool::TOOL_PARAMS.iter().flatten().any(|row| row.number == number)
        };
        matches!(self, Self::Param(at, _) if at.bit.is_none() && is_port(at.number))
    }
}

/// One job for the background thread, with the values of the core that it needs.
#[derive(Clone, Debug)]
pub struct BackgroundJob {
    /// Returned with every answer.
    pub ticket: Ticket,
    /// The request.
    pub request: FileRequest,
    /// Interpreter settings.
    pub settings: NcSettings,
    /// The programs.
    pub programs: Arc<Programs>,
    /// The password for O9000 to O9999 was not entered: a text that brings one in is refused (P23.5).
    pub subprograms_locked: bool,
    /// Values of the core; only for a transfer.
    pub transfer_values: Option<Box<TransferValues>>,
    /// Initial state of a check run; only for a drawing.
    pub start: Option<Box<DrawingStart>>,
    /// Date and time at the machine, for file names; `None` while unknown.
    pub date: Option<DateTime>,
}

/// The values that the core holds.
#[derive(Clone, Debug)]
pub struct TransferValues {
    /// The kind of machine.
    pub kind: Kind,
    /// Parameters.
    pub params: Params,
    /// Variables.
    pub memory: CommonVariables,
    /// Work offsets and tool offsets.
    pub work_offsets: WorkOffsets,
}

/// Initial state of a check run.
#[derive(Clone, Debug)]
pub struct DrawingStart {
    /// The kind of machine.
    pub kind: Kind,
    /// Parameters: tools and bar of a lathe.
    pub params: Params,
    /// Variables.
    pub memory: CommonVariables,
    /// Work offsets and tool offsets.
    pub work_offsets: WorkOffsets,
    /// Work position, radius mm.
    pub position: WorkPos,
    /// The reference points, machine coordinates.
    pub reference_points: [MachinePos; REFERENCE_POINTS],
    /// Dressing points, machine coordinates, radius mm; `None` where not set.
    pub dress_points: PerAxis<Option<f64>>,
    /// Block skip (跳段) is on.
    pub block_skip: bool,
}

impl PartialEq for BackgroundJob {
    fn eq(&self, other: &Self) -> bool {
        (self.ticket, &self.request) == (other.ticket, &other.request)
    }
}
