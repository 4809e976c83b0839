//! Bugs that are planted at the borders of the control, to show that the invariants notice them.

use crate::defs::key::{Key, Mode};
use crate::defs::signal::Output;
use crate::link::snapshot::{RunState, Snapshot};

/// What a control says of itself in a tick; some bugs act here.
#[derive(Clone, Copy, Debug)]
pub struct Reported {
    /// The state of the run.
    pub state: RunState,
    /// The mode.
    pub mode: Mode,
    /// An axis oscillates that the key has started.
    pub oscillates_by_key: bool,
    /// Units of work of the last tick.
    pub work: usize,
    /// Requests that storage has not taken.
    pub waiting_requests: usize,
}

/// A bug. Each is a mistake that control, machine logic, storage or disk could have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlantedBug {
    /// The control does not see the emergency stop.
    BlindToEmergencyStop,
    /// The control does not see that the hydraulic pressure goes.
    BlindToPressure,
    /// The control does not see that the guard opens.
    BlindToGuard,
    /// The control does not notice that the screen hangs.
    BlindToScreen,
    /// The wheel's output stays on in an emergency stop.
    WheelStaysOn,
    /// The coolant's output stays on in an emergency stop.
    CoolantStaysOn,
    /// The emergency stop releases the part.
    EmergencyStopUnclamps,
    /// The drives stay on in an emergency stop.
    DrivesStayOn,
    /// The wheel starts by itself now and then.
    WheelStartsByItself,
    /// The wheel starts without hydraulics.
    WheelIgnoresHydraulics,
    /// Both speeds of the headstock are on at once.
    BothHeadstockSpeeds,
    /// The hydraulic pump switches while the wheel runs.
    HydraulicsIgnoreWheel,
    /// The part is released while the wheel runs.
    MagnetIgnoresWheel,
    /// An axis creeps.
    AxisCreeps,
    /// An axis jumps now and then.
    AxisJumps,
    /// An axis gets faster and faster.
    AxisIsFast,
    /// An axis goes on for a while after everything has stopped.
    AxisRunsOn,
    /// An axis runs 1 mm beyond its soft limit.
    SoftLimitIsLate,
    /// A held program goes on by itself.
    HoldEndsByItself,
    /// After a power cut the program starts by itself.
    ResumesAfterPowerOn,
    /// The tailstock lets the part go while the headstock turns.
    TailstockIgnoresHeadstock,
    /// An axis stops dead.
    AxisStopsDead,
    /// A jog key that is released acts on.
    JogKeySticks,
    /// With the wheel on, the jog of the wheel axis is faster than it may be.
    SlowJogIsFast,
    /// The outputs stay on when the power goes.
    OutputsOutliveThePower,
    /// Values are acknowledged before they are stored.
    StorageAcknowledgesEarly,
    /// Some values are never stored.
    StorageDropsARequest,
    /// Later values are stored before earlier ones.
    StorageSwapsBatches,
    /// Values are stored with fewer digits.
    StorageRoundsValues,
    /// The disk ignores flushes of files.
    DiskIgnoresFileFlushes,
    /// The disk ignores flushes of folders.
    DiskIgnoresFolderFlushes,
    /// Damaged data are replaced by factory values without a word.
    DamageIsSilent,
    /// The copy of the data beside the database does not follow the commits.
    CopyLagsBehind,
    /// RESET does not stop the headstock.
    HeadstockOutlivesReset,
    /// The end of a program does not switch the coolant off.
    CoolantOutlivesTheProgram,
    /// The end of a program does not switch the wheel off.
    WheelOutlivesTheProgram,
    /// RESET switches the coolant off.
    ResetStopsCoolant,
    /// The headstock starts with the guard open.
    HeadstockIgnoresGuard,
    /// The table starts with a part that is not magnetised.
    TableIgnoresMagnet,
    /// The outputs stay on when the bus is lost.
    OutputsOutliveTheBus,
    /// A key acts on outputs at once: no interlock is asked.
    KeyForces(Key, &'static [(Output, bool)]),
    /// The hydraulic pump starts by itself after power-on.
    PumpStartsByPowerOn,
    /// The set-points are not where the axes are when the drives go on.
    DrivesGoOnElsewhere,
    /// The mode changes in a run.
    ModeChangesInRun,
    /// Cycle start does not ask whether an axis oscillates.
    StartIgnoresOscillation,
    /// RESET does not end the run.
    RunOutlivesReset,
    /// A tick does all the work at once.
    TickDoesTooMuch,
    /// Requests for storage pile up.
    RequestsPileUp,
    /// A lamp does not follow its output.
    LampLies,
    /// A position is no number.
    PositionIsNoNumber,
    /// An alarm has no text.
    AlarmHasNoText,
    /// A value that is in force was never handed over to storage.
    ValueIsNotHandedOver,
    /// The database is damaged in operation.
    DatabaseIsTorn,
    /// The copy of the data is damaged in operation.
    CopyIsTorn,
    /// A program that was saved is gone after a power cut.
    SavedProgramIsLost,
    /// The lock of the data outlives a power cut.
    LockOutlivesThePower,
    /// A power cut damages the data.
    PowerCutDamages,
    /// The same story gives another course.
    CourseIsRandom,
}

/// The release of the part while the wheel runs: the chuck is switched off.
const RELEASE: PlantedBug = PlantedBug::KeyForces(Key::Demagnetise, &[(Output::Magnetise, false)]);
/// The same by a current in the other direction.
const DEMAGNETISE: PlantedBug =
    PlantedBug::KeyForces(Key::Demagnetise, &[(Output::Magnetise, false), (Output::Demagnetise, true)]);
/// The wheel starts by its key alone.
const WHEEL: PlantedBug = PlantedBug::KeyForces(Key::WheelStart, &[(Output::Wheel, true)]);
/// The headstock starts by its key alone.
const HEADSTOCK: PlantedBug = PlantedBug::KeyForces(Key::HeadstockHigh, &[(Output::HeadstockHigh, true)]);
/// The coolant starts by its key alone.
const COOLANT: PlantedBug = PlantedBug::KeyForces(Key::Coolant, &[(Output::Coolant, true)]);

impl PlantedBug {
    /// All of them.
    pub const ALL: [Self; 62] = [
        Self::BlindToEmergencyStop,
        Self::BlindToPressure,
        Self::BlindToGuard,
        Self::BlindToScreen,
        Self::WheelStaysOn,
        Self::CoolantStaysOn,
        Self::EmergencyStopUnclamps,
        Self::DrivesStayOn,
        Self::WheelStartsByItself,
        Self::WheelIgnoresHydraulics,
        Self::BothHeadstockSpeeds,
        Self::HydraulicsIgnoreWheel,
        Self::MagnetIgnoresWheel,
        Self::AxisCreeps,
        Self::AxisJumps,
        Self::AxisIsFast,
        Self::AxisRunsOn,
        Self::SoftLimitIsLate,
        Self::HoldEndsByItself,
        Self::ResumesAfterPowerOn,
        Self::TailstockIgnoresHeadstock,
        Self::AxisStopsDead,
        Self::JogKeySticks,
        Self::SlowJogIsFast,
        Self::OutputsOutliveThePower,
        Self::StorageAcknowledgesEarly,
        Self::StorageDropsARequest,
        Self::StorageSwapsBatches,
        Self::StorageRoundsValues,
        Self::DiskIgnoresFileFlushes,
        Self::DiskIgnoresFolderFlushes,
        Self::DamageIsSilent,
        Self::CopyLagsBehind,
        Self::HeadstockOutlivesReset,
        Self::CoolantOutlivesTheProgram,
        Self::WheelOutlivesTheProgram,
        Self::ResetStopsCoolant,
        Self::HeadstockIgnoresGuard,
        Self::TableIgnoresMagnet,
        Self::OutputsOutliveTheBus,
        RELEASE,
        DEMAGNETISE,
        WHEEL,
        HEADSTOCK,
        COOLANT,
        Self::PumpStartsByPowerOn,
        Self::DrivesGoOnElsewhere,
        Self::ModeChangesInRun,
        Self::StartIgnoresOscillation,
        Self::RunOutlivesReset,
        Self::TickDoesTooMuch,
        Self::RequestsPileUp,
        Self::LampLies,
        Self::PositionIsNoNumber,
        Self::AlarmHasNoText,
        Self::ValueIsNotHandedOver,
        Self::DatabaseIsTorn,
        Self::CopyIsTorn,
        Self::SavedProgramIsLost,
        Self::LockOutlivesThePower,
        Self::PowerCutDamages,
        Self::CourseIsRandom,
    ];

    /// Changes what the control says of itself: in which tick, and whether a run was seen before.
    pub(super) const fn tamper_reported(self, (tick, was_running): (u64, bool), reported: &mut Reported) {
        match self {
            Self::ModeChangesInRun if matches!(reported.state, RunState::Running) => {
                reported.mode = if tick.is_multiple_of(2) { Mode::Manual } else { Mode::Auto };
            }
            Self::StartIgnoresOscillation => reported.oscillates_by_key = true,
            Self::RunOutlivesReset if was_running => reported.state = RunState::Running,
            Self::TickDoesTooMuch => reported.work *= 1_000_000,
            Self::RequestsPileUp => reported.waiting_requests += 10_000,
            _ => {}
        }
    }

    /// Changes what the pages show.
    pub(super) fn tamper_shown(self, shown: &mut Snapshot) {
        match self {
            Self::LampLies => shown.keys.iter_mut().for_each(|key| key.lamp = true),
            Self::PositionIsNoNumber => shown.axes.0.iter_mut().for_each(|axis| axis.work = f64::NAN),
            Self::AlarmHasNoText => shown.alarms.iter_mut().for_each(|alarm| alarm.text = Default::default()),
            _ => {}
        }
    }
}
