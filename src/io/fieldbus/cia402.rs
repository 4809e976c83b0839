//! The power state machine of a servo drive: what the statusword says, and the controlword that leads on.
//! Source: CiA 402-2 (IEC 61800-7-201), objects 6040h and 6041h.

/// Cyclic synchronous position mode, object 6060h.
pub const CYCLIC_SYNCHRONOUS_POSITION: u8 = 8;

/// Controlword: disable voltage.
const DISABLE_VOLTAGE: u16 = 0x00;
/// Controlword: quick stop; a drive that stops by itself goes on with it.
pub const QUICK_STOP: u16 = 0x02;
/// Controlword: shutdown, towards ready to switch on.
const SHUTDOWN: u16 = 0x06;
/// Controlword: switch on; from operation enabled, disable operation.
const SWITCH_ON: u16 = 0x07;
/// Controlword: enable operation.
const ENABLE_OPERATION: u16 = 0x0f;
/// Controlword: fault reset, at its rising edge.
const FAULT_RESET: u16 = 0x80;

/// State of the power stage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PowerState {
    /// The drive starts up.
    #[default]
    NotReadyToSwitchOn,
    /// No power is allowed.
    SwitchOnDisabled,
    /// Power may be switched on.
    ReadyToSwitchOn,
    /// Power is on, without torque.
    SwitchedOn,
    /// The drive follows its set-points.
    OperationEnabled,
    /// The drive has stopped, or stops, by its quick stop.
    QuickStopActive,
    /// A fault: the drive stops.
    FaultReactionActive,
    /// A fault: no torque.
    Fault,
}

impl PowerState {
    /// The state of a statusword (bits 0 to 3, 5 and 6).
    #[must_use]
    pub const fn from_statusword(word: u16) -> Self {
        match (word & 0x4f, word & 0x6f) {
            (0x40, _) => Self::SwitchOnDisabled,
            (0x0f, _) => Self::FaultReactionActive,
            (0x08, _) => Self::Fault,
            (_, 0x21) => Self::ReadyToSwitchOn,
            (_, 0x23) => Self::SwitchedOn,
            (_, 0x27) => Self::OperationEnabled,
            (_, 0x07) => Self::QuickStopActive,
            _ => Self::NotReadyToSwitchOn,
        }
    }

    /// Whether it is a fault.
    #[must_use]
    pub const fn is_fault(self) -> bool {
        matches!(self, Self::FaultReactionActive | Self::Fault)
    }

    /// The controlword of the next step towards operation enabled.
    #[must_use]
    pub const fn controlword_on(self) -> u16 {
        match self {
            Self::SwitchOnDisabled => SHUTDOWN,
            Self::ReadyToSwitchOn => SWITCH_ON,
            Self::SwitchedOn | Self::OperationEnabled => ENABLE_OPERATION,
            Self::NotReadyToSwitchOn | Self::QuickStopActive | Self::FaultReactionActive | Self::Fault => {
                DISABLE_VOLTAGE
            }
        }
    }

    /// The controlword of the next step towards a drive without torque.
    #[must_use]
    pub const fn controlword_off(self) -> u16 {
        match self {
            Self::OperationEnabled => SWITCH_ON,
            Self::SwitchedOn | Self::ReadyToSwitchOn => SHUTDOWN,
            Self::SwitchOnDisabled
            | Self::NotReadyToSwitchOn
            | Self::QuickStopActive
            | Self::FaultReactionActive
            | Self::Fault => DISABLE_VOLTAGE,
        }
    }

    /// The controlword that resets a fault: it needs a rising edge behind the last one.
    #[must_use]
    pub const fn controlword_reset(last: u16) -> u16 {
        if last & FAULT_RESET == 0 { FAULT_RESET } else { DISABLE_VOLTAGE }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// CiA 402-2, table of the statusword; the bits that say nothing of the state are set and cleared.
    #[test]
    fn every_state_is_read_whatever_the_other_bits_say() {
        let states = [
            (0x00, PowerState::NotReadyToSwitchOn),
            (0x40, PowerState::SwitchOnDisabled),
            (0x21, PowerState::ReadyToSwitchOn),
            (0x23, PowerState::SwitchedOn),
            (0x27, PowerState::OperationEnabled),
            (0x07, PowerState::QuickStopActive),
            (0x0f, PowerState::FaultReactionActive),
            (0x08, PowerState::Fault),
        ];
        for (word, state) in states {
            for other in [0, 0xff90] {
                assert_eq!(PowerState::from_statusword(word | other), state, "{word:#x} {other:#x}");
            }
        }
        // Quick stop (bit 5) does not count outside the states that have it.
        assert_eq!(PowerState::from_statusword(0x60), PowerState::SwitchOnDisabled);
        assert_eq!(PowerState::from_statusword(0x28), PowerState::Fault);
        assert_eq!(PowerState::from_statusword(0x2f), PowerState::FaultReactionActive);
    }

    /// The transitions of the standard: 2, 3, 4 up and 5, 6, 7 down; a fault is left by an edge alone.
    #[test]
    fn the_controlword_leads_up_down_and_out_of_a_fault() {
        use PowerState::*;
        assert_eq!([SwitchOnDisabled, ReadyToSwitchOn, SwitchedOn].map(PowerState::controlword_on), [0x06, 0x07, 0x0f]);
        assert_eq!([OperationEnabled, SwitchedOn].map(PowerState::controlword_off), [0x07, 0x06]);
        assert_eq!([Fault, QuickStopActive].map(PowerState::controlword_on), [0, 0], "RESET alone resets");
        let first = PowerState::controlword_reset(0x06);
        assert_eq!((first, PowerState::controlword_reset(first)), (0x80, 0));
    }
}
