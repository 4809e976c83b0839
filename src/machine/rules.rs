//! The rows of the interlock table. Rules are evaluated from the top; the first that applies decides.
//! Source: spec K3, K5, "what stops what".

use super::interlock::{Outcome, Rule};
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
const fn turning(request: Request) -> bool {
    matches!(request, Request::SpindleStart(_) | Request::SpindleStop | Request::Post(_))
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
    matches!(request, Request::DriveHigh | Request::DriveLow)
}
const fn hydraulic(request: Request) -> bool {
    matches!(request, Request::HydraulicOn | Request::HydraulicOff)
}
const fn magnet(request: Request) -> bool {
    matches!(request, Request::Magnetise | Request::Demagnetise | Request::MagnetOff)
}
const fn release(request: Request) -> bool {
    matches!(request, Request::Demagnetise | Request::MagnetOff)
}
const fn motion(request: Request) -> bool {
    cycle_start(request) || matches!(request, Request::HomeAxes | Request::MoveByHand)
}
const fn starts_or_flows(request: Request) -> bool {
    drive_start(request)
        || spindle_start(request)
        || main_spindle_start(request)
        || matches!(request, Request::Switch(Output::Coolant, true) | Request::CylinderOn | Request::Post(_))
}
const fn needs_guard(request: Request) -> bool {
    drive_start(request) || spindle_start(request) || main_spindle_start(request) || cycle_start(request)
}
const fn by_number(request: Request) -> bool {
    matches!(request, Request::Port(..) | Request::Pulse(..))
}
/// Requests that switch an output on. Switching off is never refused because of a wrong port.
const fn switches_on(request: Request) -> bool {
    starts_or_flows(request)
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
        forbids: turning,
        when: |facts| !facts.turns_part,
        outcome: Outcome::Alarm(alarm::OTHER_KIND),
        reason: Text::new("本机型没有车床主轴和刀架", "this kind of machine has no turning spindle and no tool post"),
    },
    Rule {
        row: "L8",
        forbids: main_spindle_start,
        when: |facts| facts.post_moving,
        outcome: Outcome::Deny,
        reason: Text::new("刀架转位中，主轴不能启动", "the tool post turns: the spindle is not started"),
    },
    Rule {
        row: "K3.1",
        forbids: starts_or_flows,
        when: |facts| facts.e_stop,
        outcome: Outcome::Deny,
        reason: Text::new("急停中，不能启动", "emergency stop: nothing is started"),
    },
    Rule {
        row: "B8",
        forbids: starts_or_flows,
        when: |facts| facts.around.drives_off,
        outcome: Outcome::Deny,
        reason: Text::new(
            "停机报警未复位，不能启动",
            "an alarm that stopped everything waits for RESET: nothing is started",
        ),
    },
    Rule {
        row: "B5",
        forbids: motion,
        when: |facts| facts.e_stop,
        outcome: Outcome::Deny,
        reason: Text::new("急停中，松开急停并复位", "emergency stop: release it and press RESET"),
    },
    Rule {
        row: "B5",
        forbids: motion,
        when: |facts| facts.around.drives_off,
        outcome: Outcome::Deny,
        reason: Text::new("驱动已断开，排除报警后按复位", "the drives are off: clear the alarm and press RESET"),
    },
    Rule {
        row: "B5",
        forbids: |request| matches!(request, Request::HomeAxes),
        when: |facts| facts.around.machine_lock,
        outcome: Outcome::Deny,
        reason: Text::new("机床锁中不能回零", "machine lock: no homing"),
    },
    Rule {
        row: "K4.3",
        forbids: |request| matches!(request, Request::HomeAxes),
        when: |facts| facts.around.oscillating,
        outcome: Outcome::Deny,
        reason: Text::new("振荡中不能回零", "an axis oscillates: no homing"),
    },
    Rule {
        row: "K6.1",
        forbids: switches_on,
        when: |facts| facts.port_conflict,
        outcome: Outcome::Deny,
        reason: Text::new("两个功能用了同一个输出口，见诊断页", "two functions share one output port: see diagnosis"),
    },
    Rule {
        row: "K2.4",
        forbids: needs_its_port,
        when: |facts| facts.port_missing,
        outcome: Outcome::Deny,
        reason: Text::new("该功能没有分配输出口", "the function has no output port"),
    },
    Rule {
        row: "K2.4",
        forbids: switches_on,
        when: |facts| facts.port_missing,
        outcome: Outcome::NoEffect,
        reason: Text::new("该功能没有分配输出口，无效", "the function has no output port: no effect"),
    },
    Rule {
        row: "B4",
        forbids: by_number,
        when: |facts| facts.port_owned,
        outcome: Outcome::Alarm(alarm::PORT_OWNED),
        reason: Text::new("该输出口属于有联锁的功能", "the port belongs to an interlocked function"),
    },
    Rule {
        row: "K5.13",
        forbids: needs_guard,
        when: |facts| facts.guard_open,
        outcome: Outcome::Deny,
        reason: Text::new("防护门打开，先关门", "the guard is open: close it first"),
    },
    Rule {
        row: "B5",
        forbids: wheel_start,
        when: |facts| facts.around.dry_run && facts.around.run_open,
        outcome: Outcome::NoEffect,
        reason: Text::new("空运行中砂轮不启动", "dry run: the wheel stays off"),
    },
    Rule {
        row: "P2",
        forbids: wheel_start,
        when: |facts| facts.wheel_too_fast,
        outcome: Outcome::Alarm(alarm::WHEEL_OVERSPEED),
        reason: Text::new(
            "砂轮直径与转速超过额定线速度 (P77 P79)",
            "diameter and speed exceed the wheel's rating (P77, P79)",
        ),
    },
    Rule {
        row: "K3.7",
        forbids: wheel_start,
        when: |facts| facts.hydraulic_latched,
        outcome: Outcome::Deny,
        reason: Text::new("液压报警 180 未复位，砂轮不能启动", "alarm 180 waits for RESET: the wheel may not start"),
    },
    Rule {
        row: "K3.7",
        forbids: wheel_start,
        when: |facts| facts.hydraulic_checked && !(facts.hydraulic_settled && facts.pressure),
        outcome: Outcome::Alarm(alarm::HYDRAULIC),
        reason: Text::new(
            "液压未打开、延时未到或没有压力，砂轮不能启动",
            "hydraulics off, too short on, or without pressure: the wheel may not start",
        ),
    },
    Rule {
        row: "K3.7",
        forbids: wheel_start,
        when: |facts| facts.hydraulic_needed && !facts.hydraulic_on,
        outcome: Outcome::Deny,
        reason: Text::new("液压未打开，砂轮不能启动", "hydraulics are off: the wheel may not start"),
    },
    Rule {
        row: "K3.11",
        forbids: wheel_start,
        when: |facts| facts.magnet_needed && !facts.magnetised,
        outcome: Outcome::Alarm(alarm::MAGNET),
        reason: Text::new("工件未充磁，砂轮不能启动 (P16.1)", "the part is not magnetised: the wheel may not start"),
    },
    Rule {
        row: "K5.3",
        forbids: magnet,
        when: |facts| !facts.magnet_on_kind,
        outcome: Outcome::Alarm(alarm::OTHER_KIND),
        reason: Text::new("本机型没有充磁/退磁", "this kind of machine has no magnet"),
    },
    Rule {
        row: "K3.11",
        forbids: magnet,
        when: |facts| !facts.magnet_enabled,
        outcome: Outcome::NoEffect,
        reason: Text::new("充磁/退磁无效 (P16.0=0)", "the magnet is disabled (P16.0=0)"),
    },
    Rule {
        row: "K3.11",
        forbids: release,
        when: |facts| facts.drive_on && facts.drive_carries_part,
        outcome: Outcome::Alarm(alarm::MAGNET),
        reason: Text::new("台面转动中，不能退磁", "the table turns: no demagnetising"),
    },
    Rule {
        row: "K3.11",
        forbids: release,
        when: |facts| facts.wheel_on,
        outcome: Outcome::Alarm(alarm::MAGNET),
        reason: Text::new("砂轮转动中，不能退磁", "the wheel runs: no demagnetising"),
    },
    Rule {
        row: "K3.11",
        forbids: drive_start,
        when: |facts| facts.drive_carries_part && facts.magnet_enabled && !facts.magnetised,
        outcome: Outcome::Alarm(alarm::MAGNET),
        reason: Text::new("工件未充磁，台面不能旋转", "the part is not magnetised: the table may not turn"),
    },
    Rule {
        row: "K5.3",
        forbids: tailstock,
        when: |facts| !facts.tailstock_on_kind,
        outcome: Outcome::Alarm(alarm::OTHER_KIND),
        reason: Text::new("本机型没有尾座", "this kind of machine has no tailstock"),
    },
    Rule {
        row: "K3.3",
        forbids: tailstock,
        when: |facts| !facts.tailstock_enabled,
        outcome: Outcome::NoEffect,
        reason: Text::new("尾座无效 (P16.2=0)", "the tailstock is disabled (P16.2=0)"),
    },
    Rule {
        row: "K3.3",
        forbids: tailstock,
        when: |facts| facts.drive_on,
        outcome: Outcome::Alarm(alarm::TAILSTOCK),
        reason: Text::new("头架转动中，尾座不能动作", "the headstock turns: the tailstock may not move"),
    },
    Rule {
        row: "K3.4",
        forbids: drive_start,
        when: |facts| facts.tailstock_moving,
        outcome: Outcome::Alarm(alarm::TAILSTOCK),
        reason: Text::new("尾座动作中，头架不能启动", "the tailstock moves: the headstock may not start"),
    },
    Rule {
        row: "K3.4",
        forbids: drive_start,
        when: |facts| facts.tailstock_lost,
        outcome: Outcome::Alarm(alarm::DRIVE_BLOCKED),
        reason: Text::new(
            "尾座到位信号丢失，头架不能启动",
            "the tailstock has lost its end switch: the headstock may not start",
        ),
    },
    Rule {
        row: "K3.4",
        forbids: drive_start,
        when: |facts| facts.tailstock_enabled && facts.tailstock_needed && !facts.tailstock_advanced,
        outcome: Outcome::Alarm(alarm::DRIVE_BLOCKED),
        reason: Text::new("尾座未顶紧，头架不能启动", "the tailstock is not advanced: the headstock may not start"),
    },
    Rule {
        row: "K3.5",
        forbids: hydraulic,
        when: |facts| facts.wheel_on,
        outcome: Outcome::NoEffect,
        reason: Text::new("砂轮启动中，液压操作无效", "the wheel runs: hydraulics are not switched"),
    },
    Rule {
        row: "K5.8",
        // An MDI line may end the oscillation.
        forbids: |request| matches!(request, Request::CycleStart),
        when: |facts| facts.around.oscillating || facts.cylinder_on && !facts.around.run_open,
        outcome: Outcome::Alarm(alarm::OSCILLATING),
        reason: Text::new("振荡中，不能启动程序", "an axis oscillates: no cycle start"),
    },
    Rule {
        row: "B8",
        forbids: cycle_start,
        when: |facts| facts.around.alarm_blocks,
        outcome: Outcome::Deny,
        reason: Text::new("有报警，先排除并复位", "an alarm is present: clear it first"),
    },
    Rule {
        row: "B5",
        forbids: cycle_start,
        when: |facts| facts.external_hold,
        outcome: Outcome::Deny,
        reason: Text::new("外接暂停有效，不能启动", "the external hold is active: no cycle start"),
    },
    Rule {
        row: "K5.13",
        forbids: cycle_start,
        when: |facts| facts.drive_stopped_by_guard,
        outcome: Outcome::Deny,
        reason: Text::new(
            "防护门停了头架/滚轮/台面，先启动再循环启动",
            "the guard stopped headstock, roll or table: start it first",
        ),
    },
    Rule {
        row: "K5.17",
        forbids: cycle_start,
        when: |facts| facts.wheel_undressed && !facts.around.dressing,
        outcome: Outcome::Deny,
        reason: Text::new(
            "换砂轮后先修整 (P91–P92 程序)",
            "the wheel was changed: dress it first (programs P91 to P92)",
        ),
    },
    Rule {
        row: "B5",
        forbids: cycle_start,
        when: |facts| facts.around.dry_run && facts.wheel_on,
        outcome: Outcome::Deny,
        reason: Text::new("空运行前先停砂轮", "stop the wheel before a dry run"),
    },
    Rule {
        row: "B5",
        // An MDI line may switch units; its moves check homing themselves.
        forbids: |request| matches!(request, Request::CycleStart),
        when: |facts| !facts.around.homed,
        outcome: Outcome::Alarm(alarm::NOT_HOMED),
        reason: Text::new("先回零再循环启动", "home the axes before cycle start"),
    },
];
