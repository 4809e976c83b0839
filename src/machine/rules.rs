//! The rows of the interlock table. Rules are evaluated from the top; the first that applies decides.
//! Source: spec K3, K5, "what stops what".

use super::interlock::{Rule, RuleOutcome};
use crate::defs::alarm;
use crate::defs::mcode::Request;
use crate::defs::signal::Output;
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

/// The table.
pub const RULES: &[Rule] = &[
    Rule {
        row: "L7",
        forbids: uses_lathe_unit,
        applies: |facts| !facts.has_main_spindle,
        outcome: RuleOutcome::Alarm(alarm::M_CODE_OF_OTHER_KIND),
        reason: Text::new("本机型没有车床主轴和刀架", "this kind of machine has no turning spindle and no tool post"),
    },
    Rule {
        row: "L8",
        forbids: main_spindle_start,
        applies: |facts| facts.turret_moving,
        outcome: RuleOutcome::Deny,
        reason: Text::new("刀架转位中，主轴不能启动", "the tool post turns: the spindle is not started"),
    },
    Rule {
        row: "K3.1",
        forbids: starts_spindle_or_fluid,
        applies: |facts| facts.e_stop,
        outcome: RuleOutcome::Deny,
        reason: Text::new("急停中，不能启动", "emergency stop: nothing is started"),
    },
    Rule {
        row: "B8",
        forbids: starts_spindle_or_fluid,
        applies: |facts| facts.control_state.drives_off,
        outcome: RuleOutcome::Deny,
        reason: Text::new(
            "停机报警未复位，不能启动",
            "an alarm that stopped everything waits for RESET: nothing is started",
        ),
    },
    Rule {
        row: "B5",
        forbids: motion,
        applies: |facts| facts.e_stop,
        outcome: RuleOutcome::Deny,
        reason: Text::new("急停中，松开急停并复位", "emergency stop: release it and press RESET"),
    },
    Rule {
        row: "B5",
        forbids: motion,
        applies: |facts| facts.control_state.drives_off,
        outcome: RuleOutcome::Deny,
        reason: Text::new("驱动已断开，排除报警后按复位", "the drives are off: clear the alarm and press RESET"),
    },
    Rule {
        row: "B5",
        forbids: |request| matches!(request, Request::HomeAxes),
        applies: |facts| facts.control_state.machine_lock,
        outcome: RuleOutcome::Deny,
        reason: Text::new("机床锁中不能回零", "machine lock: no homing"),
    },
    Rule {
        row: "K4.3",
        forbids: |request| matches!(request, Request::HomeAxes),
        applies: |facts| facts.control_state.oscillating,
        outcome: RuleOutcome::Deny,
        reason: Text::new("振荡中不能回零", "an axis oscillates: no homing"),
    },
    Rule {
        row: "K6.1",
        forbids: switches_on,
        applies: |facts| facts.port_conflict,
        outcome: RuleOutcome::Deny,
        reason: Text::new("两个功能用了同一个输出口，见诊断页", "two functions share one output port: see diagnosis"),
    },
    Rule {
        row: "K2.4",
        forbids: needs_its_port,
        applies: |facts| facts.port_missing,
        outcome: RuleOutcome::Deny,
        reason: Text::new("该功能没有分配输出口", "the function has no output port"),
    },
    Rule {
        row: "K2.4",
        forbids: switches_on,
        applies: |facts| facts.port_missing,
        outcome: RuleOutcome::NoEffect,
        reason: Text::new("该功能没有分配输出口，无效", "the function has no output port: no effect"),
    },
    Rule {
        row: "B4",
        forbids: port_by_number,
        applies: |facts| facts.port_owned,
        outcome: RuleOutcome::Alarm(alarm::PORT_IN_USE),
        reason: Text::new("该输出口属于有联锁的功能", "the port belongs to an interlocked function"),
    },
    Rule {
        row: "K5.13",
        forbids: needs_guard,
        applies: |facts| facts.guard_open,
        outcome: RuleOutcome::Deny,
        reason: Text::new("防护门打开，先关门", "the guard is open: close it first"),
    },
    Rule {
        row: "B5",
        forbids: wheel_start,
        applies: |facts| facts.control_state.dry_run && facts.control_state.run_open,
        outcome: RuleOutcome::NoEffect,
        reason: Text::new("空运行中砂轮不启动", "dry run: the wheel stays off"),
    },
    Rule {
        row: "P2",
        forbids: wheel_start,
        applies: |facts| facts.wheel_too_fast,
        outcome: RuleOutcome::Alarm(alarm::WHEEL_OVERSPEED),
        reason: Text::new(
            "砂轮直径与转速超过额定线速度 (P77 P79)",
            "diameter and speed exceed the wheel's rating (P77, P79)",
        ),
    },
    Rule {
        row: "K3.7",
        forbids: wheel_start,
        applies: |facts| facts.hydraulic_latched,
        outcome: RuleOutcome::Deny,
        reason: Text::new("液压报警 180 未复位，砂轮不能启动", "alarm 180 waits for RESET: the wheel may not start"),
    },
    Rule {
        row: "K3.7",
        forbids: wheel_start,
        applies: |facts| facts.hydraulic_checked && !(facts.hydraulic_settled && facts.pressure),
        outcome: RuleOutcome::Alarm(alarm::HYDRAULIC_PRESSURE),
        reason: Text::new(
            "液压未打开、延时未到或没有压力，砂轮不能启动",
            "hydraulics off, too short on, or without pressure: the wheel may not start",
        ),
    },
    Rule {
        row: "K3.7",
        forbids: wheel_start,
        applies: |facts| facts.hydraulic_needed && !facts.hydraulic_on,
        outcome: RuleOutcome::Deny,
        reason: Text::new("液压未打开，砂轮不能启动", "hydraulics are off: the wheel may not start"),
    },
    Rule {
        row: "K3.11",
        forbids: wheel_start,
        applies: |facts| facts.magnet_needed && !facts.magnetised,
        outcome: RuleOutcome::Alarm(alarm::MAGNET_INTERLOCK),
        reason: Text::new("工件未充磁，砂轮不能启动 (P16.1)", "the part is not magnetised: the wheel may not start"),
    },
    Rule {
        row: "K5.3",
        forbids: magnet,
        applies: |facts| !facts.magnet_on_kind,
        outcome: RuleOutcome::Alarm(alarm::M_CODE_OF_OTHER_KIND),
        reason: Text::new("本机型没有充磁/退磁", "this kind of machine has no magnet"),
    },
    Rule {
        row: "K3.11",
        forbids: magnet,
        applies: |facts| !facts.magnet_enabled,
        outcome: RuleOutcome::NoEffect,
        reason: Text::new("充磁/退磁无效 (P16.0=0)", "the magnet is disabled (P16.0=0)"),
    },
    Rule {
        row: "K3.11",
        forbids: releases_part,
        applies: |facts| facts.drive_on && facts.drive_carries_part,
        outcome: RuleOutcome::Alarm(alarm::MAGNET_INTERLOCK),
        reason: Text::new("台面转动中，不能退磁", "the table turns: no demagnetising"),
    },
    Rule {
        row: "K3.11",
        forbids: releases_part,
        applies: |facts| facts.wheel_on,
        outcome: RuleOutcome::Alarm(alarm::MAGNET_INTERLOCK),
        reason: Text::new("砂轮转动中，不能退磁", "the wheel runs: no demagnetising"),
    },
    Rule {
        row: "K3.11",
        forbids: drive_start,
        applies: |facts| facts.drive_carries_part && facts.magnet_enabled && !facts.magnetised,
        outcome: RuleOutcome::Alarm(alarm::MAGNET_INTERLOCK),
        reason: Text::new("工件未充磁，台面不能旋转", "the part is not magnetised: the table may not turn"),
    },
    Rule {
        row: "K5.3",
        forbids: tailstock,
        applies: |facts| !facts.tailstock_on_kind,
        outcome: RuleOutcome::Alarm(alarm::M_CODE_OF_OTHER_KIND),
        reason: Text::new("本机型没有尾座", "this kind of machine has no tailstock"),
    },
    Rule {
        row: "K3.3",
        forbids: tailstock,
        applies: |facts| !facts.tailstock_enabled,
        outcome: RuleOutcome::NoEffect,
        reason: Text::new("尾座无效 (P16.2=0)", "the tailstock is disabled (P16.2=0)"),
    },
    Rule {
        row: "K3.3",
        forbids: tailstock,
        applies: |facts| facts.drive_on,
        outcome: RuleOutcome::Alarm(alarm::TAILSTOCK_INTERLOCK),
        reason: Text::new("头架转动中，尾座不能动作", "the headstock turns: the tailstock may not move"),
    },
    Rule {
        row: "K3.4",
        forbids: drive_start,
        applies: |facts| facts.tailstock_moving,
        outcome: RuleOutcome::Alarm(alarm::TAILSTOCK_INTERLOCK),
        reason: Text::new("尾座动作中，头架不能启动", "the tailstock moves: the headstock may not start"),
    },
    Rule {
        row: "K3.4",
        forbids: drive_start,
        applies: |facts| facts.tailstock_lost,
        outcome: RuleOutcome::Alarm(alarm::WORK_DRIVE_BLOCKED),
        reason: Text::new(
            "尾座到位信号丢失，头架不能启动",
            "the tailstock has lost its end switch: the headstock may not start",
        ),
    },
    Rule {
        row: "K3.4",
        forbids: drive_start,
        applies: |facts| facts.tailstock_enabled && facts.tailstock_needed && !facts.tailstock_advanced,
        outcome: RuleOutcome::Alarm(alarm::WORK_DRIVE_BLOCKED),
        reason: Text::new("尾座未顶紧，头架不能启动", "the tailstock is not advanced: the headstock may not start"),
    },
    Rule {
        row: "K3.5",
        forbids: hydraulic,
        applies: |facts| facts.wheel_on,
        outcome: RuleOutcome::NoEffect,
        reason: Text::new("砂轮启动中，液压操作无效", "the wheel runs: hydraulics are not switched"),
    },
    Rule {
        row: "K5.8",
        // An MDI line may end the oscillation.
        forbids: |request| matches!(request, Request::CycleStart),
        applies: |facts| facts.control_state.oscillating || facts.cylinder_on && !facts.control_state.run_open,
        outcome: RuleOutcome::Alarm(alarm::OSCILLATING_AT_START),
        reason: Text::new("振荡中，不能启动程序", "an axis oscillates: no cycle start"),
    },
    Rule {
        row: "B8",
        forbids: cycle_start,
        applies: |facts| facts.control_state.alarm_blocks,
        outcome: RuleOutcome::Deny,
        reason: Text::new("有报警，先排除并复位", "an alarm is present: clear it first"),
    },
    Rule {
        row: "B5",
        forbids: cycle_start,
        applies: |facts| facts.external_hold,
        outcome: RuleOutcome::Deny,
        reason: Text::new("外接暂停有效，不能启动", "the external hold is active: no cycle start"),
    },
    Rule {
        row: "K5.13",
        forbids: cycle_start,
        applies: |facts| facts.drive_stopped_by_guard,
        outcome: RuleOutcome::Deny,
        reason: Text::new(
            "防护门停了头架/滚轮/台面，先启动再循环启动",
            "the guard stopped headstock, roll or table: start it first",
        ),
    },
    Rule {
        row: "K5.17",
        forbids: cycle_start,
        applies: |facts| facts.wheel_undressed && !facts.control_state.dressing_program,
        outcome: RuleOutcome::Deny,
        reason: Text::new(
            "换砂轮后先修整 (P91–P92 程序)",
            "the wheel was changed: dress it first (programs P91 to P92)",
        ),
    },
    Rule {
        row: "B5",
        forbids: cycle_start,
        applies: |facts| facts.control_state.dry_run && facts.wheel_on,
        outcome: RuleOutcome::Deny,
        reason: Text::new("空运行前先停砂轮", "stop the wheel before a dry run"),
    },
    Rule {
        row: "B5",
        // An MDI line may switch units; its moves check homing themselves.
        forbids: |request| matches!(request, Request::CycleStart),
        applies: |facts| !facts.control_state.homed,
        outcome: RuleOutcome::Alarm(alarm::NOT_HOMED),
        reason: Text::new("先回零再循环启动", "home the axes before cycle start"),
    },
];
