//! Bugs that are planted at the borders of the control, to show that the invariants notice them.

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
    /// The same story gives another course.
    CourseIsRandom,
}

impl PlantedBug {
    /// All of them.
    pub const ALL: [Self; 40] = [
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
        Self::CourseIsRandom,
    ];
}
