//! Panel keys on the machine side: whether a key is active, and which request it makes.
//! Source: spec K2.1–K2.4.

use super::phase::RunPhase;
use crate::defs::fitted::Fitted;
use crate::defs::key::{Key, Mode};
use crate::defs::mcode::{Gauge, Request};
use crate::defs::signal::{Output, OutputSet};
use crate::defs::text::Text;
use crate::units::PerAxis;

/// K2.2.
pub const NOT_IN_RUN: Text = Text::new("程序运行中，按键无效", "not active while a program runs");
/// K2.1.
pub const NOT_FITTED: Text = Text::new("本机床没有此功能", "not available on this machine");

/// Why a key is inactive regardless of interlocks: its device or axis is not fitted, or a program runs. `axes` are those
/// that the machine was switched on with.
#[must_use]
pub fn inactive_reason(key: Key, fitted: Fitted, axes: PerAxis<bool>, phase: RunPhase) -> Option<Text> {
    if !key.exists_on(fitted) || key.axis().is_some_and(|axis| !axes[axis]) {
        return Some(NOT_FITTED);
    }
    (phase.is_automatic() && !key.row().active_in_run).then_some(NOT_IN_RUN)
}

/// The machine request of a key, with these outputs on. Toggle keys switch on and off (K2.3).
#[must_use]
pub fn machine_request(key: Key, mode: Mode, on: OutputSet) -> Option<Request> {
    let toggle = |output: Output| Request::Switch(output, !on.has(output));
    let either = |output: Output, stop: Request, start: Request| if on.has(output) { stop } else { start };
    Some(match key {
        Key::CycleStart if mode == Mode::Mdi => Request::MdiStart,
        Key::CycleStart => Request::CycleStart,
        Key::WheelStart => Request::WheelStart,
        Key::WheelStop => Request::WheelStop,
        Key::SecondSpindle if on.has(Output::SecondSpindle) => Request::SecondSpindleStop,
        Key::SecondSpindle if on.has(Output::SecondSpindleCcw) => Request::SecondSpindleStop,
        Key::SecondSpindle => Request::SecondSpindleStart(false),
        Key::SpindleForward => Request::SpindleStart(false),
        Key::SpindleReverse => Request::SpindleStart(true),
        Key::SpindleStop => Request::SpindleStop,
        Key::ToolTurret => Request::ToolTurret(0),
        Key::HeadstockHigh => Request::WorkDriveHigh,
        Key::HeadstockLow => Request::WorkDriveLow,
        Key::HeadstockStop => Request::WorkDriveStop,
        Key::DresserRoll => either(Output::DresserRoll, Request::WorkDriveStop, Request::WorkDriveHigh),
        Key::TableRotation => either(Output::TableRotation, Request::WorkDriveStop, Request::WorkDriveHigh),
        Key::TailstockAdvance => Request::TailstockAdvance,
        Key::TailstockRetract => Request::TailstockRetract,
        Key::Magnetise => either(Output::Magnetise, Request::MagnetOff, Request::Magnetise),
        Key::Demagnetise => either(Output::Demagnetise, Request::MagnetOff, Request::Demagnetise),
        Key::Hydraulic => either(Output::Hydraulic, Request::HydraulicOff, Request::HydraulicOn),
        Key::Coolant => toggle(Output::Coolant),
        Key::Lubrication => toggle(Output::Lubrication),
        Key::RadialGauge => Request::Gauge(Gauge::Radial, !on.has(Output::RadialGauge)),
        Key::AxialGauge => Request::Gauge(Gauge::Axial, !on.has(Output::AxialGauge)),
        Key::XPlus | Key::XMinus | Key::YPlus | Key::YMinus | Key::ZPlus | Key::ZMinus => match mode {
            Mode::Home => Request::HomeAxes,
            Mode::Edit | Mode::Auto | Mode::Mdi | Mode::Handwheel | Mode::Step | Mode::Manual => Request::Jog,
        },
        // Modes, switches, overrides and screen keys make no machine request.
        _ => return None,
    })
}
