//! The rows of the interlock table. Rules are evaluated from the top; the first that applies decides.
//! Source: spec K3, K5, "what stops what".

use super::interlock::Rule;
use super::interlock::RuleOutcome::{Alarm, Deny, NoEffect};
use crate::defs::alarm;
use crate::defs::mcode::Request;
use crate::defs::signal::Output;
use crate::defs::start_step::StartStep;
use crate::defs::text::Text;

const fn wheel_start(request: Request) -> bool {
    matches!(request, Request::WheelStart)
}
const fn spindle_start(request: Request) -> bool {
    matches!(request, Request::WheelStart | Request::SecondSpindleStart(_))
}
const fn uses_lathe_unit(request: Request) -> bool {
    matches!(request, Request::SpindleStart(_) | Request::SpindleStop | Request::ToolTurret(_))
}
const fn main_spindle_start(request: Request) -> bool {
    matches!(request, Request::SpindleStart(_))
}
const fn cycle_start(request: Request) -> bool {
    matches!(request, Request::CycleStart | Request::MdiStart)
}
const fn tailstock(request: Request) -> bool {
    matches!(request, Request::TailstockAdvance | Request::TailstockRetract)
}
const fn drive_start(request: Request) -> bool {
    matches!(request, Request::WorkDriveHigh | Request::WorkDriveLow)
}
const fn hydraulic(request: Request) -> bool {
    matches!(request, Request::HydraulicOn | Request::HydraulicOff)
}
const fn magnet(request: Request) -> bool {
    matches!(request, Request::Magnetise | Request::Demagnetise | Request::MagnetOff)
}
const fn releases_part(request: Request) -> bool {
    matches!(request, Request::Demagnetise | Request::MagnetOff)
}
const fn motion(request: Request) -> bool {
    cycle_start(request) || matches!(request, Request::HomeAxes | Request::Jog)
}
const fn starts_spindle_or_fluid(request: Request) -> bool {
    drive_start(request)
        || spindle_start(request)
        || main_spindle_start(request)
        || matches!(request, Request::Switch(Output::Coolant, true) | Request::CylinderOn | Request::ToolTurret(_))
}
const fn needs_guard(request: Request) -> bool {
    drive_start(request) || spindle_start(request) || main_spindle_start(request) || cycle_start(request)
}
const fn port_by_number(request: Request) -> bool {
    matches!(request, Request::Port(..) | Request::Pulse(..))
}
/// Requests that switch an output on. Switching off is never refused because of a wrong port.
const fn switches_on(request: Request) -> bool {
    starts_spindle_or_fluid(request)
        || matches!(
            request,
            Request::TailstockAdvance
                | Request::HydraulicOn
                | Request::Magnetise
                | Request::Demagnetise
                | Request::Gauge(_, true)
                | Request::Gear(_)
                | Request::Switch(_, true)
        )
}

/// Requests that a program relies on: without their output it must not continue.
const fn needs_its_port(request: Request) -> bool {
    drive_start(request)
        || spindle_start(request)
        || matches!(request, Request::TailstockAdvance | Request::HydraulicOn | Request::Magnetise)
}

/// The condition of a cycle start behind the name of a row, if any.
macro_rules! step {
    () => {
        None
    };
    ($step:ident) => {
        Some(StartStep::$step)
    };
}

/// One row of the table in two or three lines: specification, requests, condition; outcome and reason.
macro_rules! rules {
    ($(row: $row:literal $(($step:ident))?, $forbids:expr, $applies:expr => $outcome:expr, $zh:literal, $en:literal;)*) => {
        /// The table.
        pub const RULES: &[Rule] = &[$(Rule {
            row: $row,
            step: step!($($step)?),
            forbids: $forbids,
            applies: $applies,
            outcome: $outcome,
            reason: Text::new($zh, $en),
        },)*];
    };
}

rules! {
    row: "L7", uses_lathe_unit, |inputs| !inputs.has_main_spindle
        => Alarm(alarm::M_CODE_OF_OTHER_KIND), "本机型没有车床主轴和刀架",
            "this kind of machine has no turning spindle and no tool post";
    row: "L8", main_spindle_start, |inputs| inputs.turret_moving
        => Deny, "刀架转位中，主轴不能启动", "the tool post is turning: the spindle cannot start";
    row: "K3.1" (Machine), starts_spindle_or_fluid, |inputs| inputs.e_stop
        => Deny, "急停中，不能启动", "emergency stop: nothing can start";
    row: "B8" (Machine), starts_spindle_or_fluid, |inputs| inputs.control_state.drives_off
        => Deny, "停机报警未复位，不能启动", "an alarm that stopped the machine waits for RESET: nothing can start";
    row: "B5" (Machine), motion, |inputs| inputs.e_stop
        => Deny, "急停中，松开急停并复位", "emergency stop: release it and press RESET";
    row: "B5" (Machine), motion, |inputs| inputs.control_state.drives_off
        => Deny, "驱动已断开，排除报警后按复位", "the drives are off: clear the alarm and press RESET";
    row: "B5" (Machine), motion, |inputs| inputs.control_state.drives_switching
        => Deny, "驱动正在接通，请稍候", "the drives are switching on: wait";
    row: "B5", |request| matches!(request, Request::HomeAxes), |inputs| inputs.control_state.machine_lock
        => Deny, "机床锁中不能回零", "machine lock: no homing";
    row: "K4.3", |request| matches!(request, Request::HomeAxes), |inputs| inputs.control_state.oscillating
        => Deny, "振荡中不能回零", "an axis is oscillating: no homing";
    row: "K6.1", switches_on, |inputs| inputs.port_conflict
        => Deny, "两个功能用了同一个输出口，见诊断页", "two functions share one output port: see diagnosis";
    row: "K2.4", needs_its_port, |inputs| inputs.port_missing
        => Deny, "该功能没有分配输出口", "the function has no output port";
    row: "K2.4", switches_on, |inputs| inputs.port_missing
        => NoEffect, "该功能没有分配输出口，无效", "the function has no output port: no effect";
    row: "B4", port_by_number, |inputs| inputs.port_owned
        => Alarm(alarm::PORT_IN_USE), "该输出口属于有联锁的功能", "the port belongs to an interlocked function";
    row: "K5.13" (Guard), needs_guard, |inputs| inputs.guard_open
        => Deny, "防护门打开，先关门", "the guard is open: close it first";
    row: "B5", wheel_start, |inputs| inputs.control_state.dry_run && inputs.control_state.run_open
        => NoEffect, "空运行中砂轮不启动", "dry run: the wheel stays off";
    row: "P2", wheel_start, |inputs| inputs.wheel_too_fast
        => Alarm(alarm::WHEEL_OVERSPEED), "砂轮直径与转速超过额定线速度 (P77 P79)",
            "diameter and speed exceed the wheel's rating (P77, P79)";
    row: "K3.7" (Hydraulics), wheel_start, |inputs| inputs.hydraulic_latched
        => Deny, "液压报警 180 未复位，砂轮不能启动", "alarm 180 waits for RESET: the wheel cannot start";
    row: "K3.7" (Hydraulics), wheel_start, |inputs| inputs.hydraulic_checked && !(inputs.hydraulic_settled && inputs.pressure)
        => Alarm(alarm::HYDRAULIC_PRESSURE), "液压未打开、延时未到或没有压力，砂轮不能启动",
            "hydraulics off, delay not elapsed, or no pressure: the wheel cannot start";
    row: "K3.7" (Hydraulics), wheel_start, |inputs| inputs.hydraulic_needed && !inputs.hydraulic_on
        => Deny, "液压未打开，砂轮不能启动", "hydraulics are off: the wheel cannot start";
    row: "K3.11" (Magnet), wheel_start, |inputs| inputs.magnet_needed && !inputs.magnetised
        => Alarm(alarm::MAGNET_INTERLOCK), "工件未充磁，砂轮不能启动 (P16.1)",
            "the part is not magnetised: the wheel cannot start";
    row: "K5.3", magnet, |inputs| !inputs.magnet_on_kind
        => Alarm(alarm::M_CODE_OF_OTHER_KIND), "本机型没有充磁/退磁", "this kind of machine has no magnet";
    row: "K3.11", magnet, |inputs| !inputs.magnet_enabled
        => NoEffect, "充磁/退磁无效 (P16.0=0)", "the magnet is disabled (P16.0=0)";
    row: "K3.11", releases_part, |inputs| inputs.drive_on && inputs.drive_carries_part
        => Alarm(alarm::MAGNET_INTERLOCK), "台面转动中，不能退磁", "the table is turning: no demagnetising";
    row: "K3.11", releases_part, |inputs| inputs.wheel_on
        => Alarm(alarm::MAGNET_INTERLOCK), "砂轮转动中，不能退磁", "the wheel is running: no demagnetising";
    row: "K3.11" (Magnet), drive_start, |inputs| inputs.drive_carries_part && inputs.magnet_enabled && !inputs.magnetised
        => Alarm(alarm::MAGNET_INTERLOCK), "工件未充磁，台面不能旋转", "the part is not magnetised: the table cannot start";
    row: "K5.3", tailstock, |inputs| !inputs.tailstock_on_kind
        => Alarm(alarm::M_CODE_OF_OTHER_KIND), "本机型没有尾座", "this kind of machine has no tailstock";
    row: "K3.3", tailstock, |inputs| !inputs.tailstock_enabled
        => NoEffect, "尾座无效 (P16.2=0)", "the tailstock is disabled (P16.2=0)";
    row: "K3.3", tailstock, |inputs| inputs.drive_on
        => Alarm(alarm::TAILSTOCK_INTERLOCK), "头架转动中，尾座不能动作", "the headstock is turning: the tailstock cannot move";
    row: "K3.4" (Tailstock), drive_start, |inputs| inputs.tailstock_moving
        => Alarm(alarm::TAILSTOCK_INTERLOCK), "尾座动作中，头架不能启动", "the tailstock is moving: the headstock cannot start";
    row: "K3.4" (Tailstock), drive_start, |inputs| inputs.tailstock_lost
        => Alarm(alarm::WORK_DRIVE_BLOCKED), "尾座到位信号丢失，头架不能启动",
            "the tailstock end switch is lost: the headstock cannot start";
    row: "K3.4" (Tailstock), drive_start, |inputs| inputs.tailstock_enabled && inputs.tailstock_needed && !inputs.tailstock_advanced
        => Alarm(alarm::WORK_DRIVE_BLOCKED), "尾座未顶紧，头架不能启动",
            "the tailstock is not advanced: the headstock cannot start";
    row: "K3.5", hydraulic, |inputs| inputs.wheel_on
        => NoEffect, "砂轮启动中，液压操作无效", "the wheel is running: hydraulics cannot be switched";
    // An MDI line may end the oscillation.
    row: "K5.8" (Mode), |request| matches!(request, Request::CycleStart),
        |inputs| inputs.control_state.oscillating || inputs.cylinder_on && !inputs.control_state.run_open
        => Alarm(alarm::OSCILLATING_AT_START), "振荡中，不能启动程序", "an axis is oscillating: no cycle start";
    row: "B8" (Machine), cycle_start, |inputs| inputs.control_state.alarm_blocks
        => Deny, "有报警，先排除并复位", "an alarm is present: clear it first";
    row: "K3.7" (Hydraulics), |request| matches!(request, Request::CycleStart),
        |inputs| inputs.hydraulic_alarm && inputs.control_state.starts_wheel
        => Deny, "报警 180：没有液压压力，启动砂轮的程序不能运行",
            "alarm 180: no hydraulic pressure, a program that starts the wheel cannot run";
    row: "B5" (Machine), cycle_start, |inputs| inputs.external_hold
        => Deny, "外接暂停有效，不能启动", "the external hold is active: no cycle start";
    row: "K5.13" (Guard), cycle_start, |inputs| inputs.drive_stopped_by_guard
        => Deny, "防护门停了头架/滚轮/台面，先启动再循环启动", "the guard stopped headstock, roll or table: start it first";
    row: "K5.17" (Wheel), cycle_start, |inputs| inputs.wheel_undressed && !inputs.control_state.dressing_program
        => Deny, "换砂轮后先修整 (P91–P92 程序)", "the wheel was changed: dress it first (programs P91 to P92)";
    row: "B5" (Mode), cycle_start, |inputs| inputs.control_state.dry_run && inputs.wheel_on
        => Deny, "空运行前先停砂轮", "stop the wheel before a dry run";
    // An MDI line may switch units; its moves check homing themselves.
    row: "B5" (Homing), |request| matches!(request, Request::CycleStart), |inputs| !inputs.control_state.homed
        => Alarm(alarm::NOT_HOMED), "先回零再循环启动", "home the axes before cycle start";
}
