//! The M codes: what each one does and where it is written.
//! Source: spec K3, B4.

use super::kind::System;
use super::signal::{Input, Output};
use super::text::Text;

/// What the machine does on an M code. How and whether is the business of `machine`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Wait for cycle start.
    Pause,
    /// Wait for cycle start if the optional-stop switch is on.
    OptionalStop,
    /// End of program (K3.14).
    End,
    /// Count one workpiece.
    Count,
    /// Ask the machine for a change of one of its units.
    Ask(Request),
    /// Switch the port of the P word on or off (M21, M22).
    Port(bool),
    /// Switch the port of the P word on for the milliseconds of the L word (M20).
    Pulse,
    /// Wait until a user input is active.
    AwaitInput(Input),
    /// The reader of the program has dealt with it: jumps and calls.
    Flow,
}

/// A change of the machine that a code, a key or a rule can ask for; the interlock table decides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Request {
    /// Start the wheel.
    WheelStart,
    /// Stop the wheel.
    WheelStop,
    /// Tailstock out.
    TailstockAdvance,
    /// Tailstock back.
    TailstockRetract,
    /// Headstock, dresser roll or table at high speed (M63).
    DriveHigh,
    /// Headstock at low speed; the single speed of roll and table (M64).
    DriveLow,
    /// Headstock, roll or table off (M65).
    DriveStop,
    /// Hydraulic pump on.
    HydraulicOn,
    /// Hydraulic pump off.
    HydraulicOff,
    /// Clamp the part by the magnet.
    Magnetise,
    /// Let the part go by decaying reversals.
    Demagnetise,
    /// Both outputs of the magnet off.
    MagnetOff,
    /// Second spindle on; true is counter-clockwise (M27).
    SecondSpindleStart(bool),
    /// Second spindle off.
    SecondSpindleStop,
    /// A gauge arm out (true) or in.
    Gauge(Gauge, bool),
    /// Change to gear 1 to 4, counted from 0.
    Gear(u8),
    /// Switch an output that has no rule of its own.
    Switch(Output, bool),
    /// Switch a port by its number (M21, M22).
    Port(u8, bool),
    /// Switch a port on for so many milliseconds (M20).
    Pulse(u8, u32),
    /// The oscillation cylinder begins its cycle (P17.1=1).
    CylinderOn,
    /// Both valves of the cylinder off.
    CylinderOff,
    /// The main spindle of a lathe on; true is counter-clockwise (M04).
    SpindleStart(bool),
    /// The main spindle of a lathe off.
    SpindleStop,
    /// The tool post to a station, 1 to 4; 0 is the next one.
    Post(u8),
    /// Start or resume a program.
    CycleStart,
    /// Execute an MDI line.
    MdiStart,
    /// Home axes.
    HomeAxes,
    /// Jog, step or handwheel.
    MoveByHand,
}

/// Every kind of request by an example, and its name: for tables and searches.
pub const REQUESTS: &[(Request, Text)] = &[
    (Request::WheelStart, Text::new("砂轮启动", "wheel start")),
    (Request::WheelStop, Text::new("砂轮停止", "wheel stop")),
    (Request::TailstockAdvance, Text::new("尾座进", "tailstock advance")),
    (Request::TailstockRetract, Text::new("尾座退", "tailstock retract")),
    (Request::DriveHigh, Text::new("头架高速/滚轮/台面", "headstock high, roll, table")),
    (Request::DriveLow, Text::new("头架低速", "headstock low")),
    (Request::DriveStop, Text::new("头架/滚轮/台面停止", "headstock, roll, table stop")),
    (Request::HydraulicOn, Text::new("液压开", "hydraulics on")),
    (Request::HydraulicOff, Text::new("液压关", "hydraulics off")),
    (Request::Magnetise, Text::new("充磁", "magnetise")),
    (Request::Demagnetise, Text::new("退磁", "demagnetise")),
    (Request::MagnetOff, Text::new("断磁", "magnet off")),
    (Request::SecondSpindleStart(false), Text::new("第二主轴启动", "second spindle start")),
    (Request::SecondSpindleStop, Text::new("第二主轴停止", "second spindle stop")),
    (Request::Gauge(Gauge::Radial, true), Text::new("量仪伸出", "gauge out")),
    (Request::Gauge(Gauge::Radial, false), Text::new("量仪缩回", "gauge in")),
    (Request::Gear(0), Text::new("换档", "gear change")),
    (Request::Switch(Output::Coolant, true), Text::new("冷却开", "coolant on")),
    (Request::Switch(Output::Coolant, false), Text::new("冷却关", "coolant off")),
    (Request::Switch(Output::Lubrication, true), Text::new("润滑开", "lubrication on")),
    (Request::Switch(Output::User1, true), Text::new("用户输出开", "user output on")),
    (Request::Port(1, true), Text::new("输出口开/关 (M21 M22)", "port on or off (M21, M22)")),
    (Request::Pulse(1, 1), Text::new("输出口脉冲 (M20)", "port pulse (M20)")),
    (Request::CylinderOn, Text::new("振荡气缸启动", "oscillation cylinder on")),
    (Request::SpindleStart(false), Text::new("主轴启动", "main spindle start")),
    (Request::SpindleStop, Text::new("主轴停止", "main spindle stop")),
    (Request::Post(1), Text::new("换刀", "tool post")),
    (Request::CycleStart, Text::new("循环启动", "cycle start")),
    (Request::MdiStart, Text::new("录入执行", "MDI line")),
    (Request::HomeAxes, Text::new("回零", "homing")),
    (Request::MoveByHand, Text::new("手动移动", "moving by hand")),
];

/// The two gauge arms.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Gauge {
    /// 径向, on GS and GA 厚度.
    Radial,
    /// 轴向, on GS and GA 平面.
    Axial,
}

/// One M code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MCode {
    /// The number after M.
    pub code: u16,
    /// What it does.
    pub action: Action,
    /// Whether the next block waits until it is done.
    pub waits: bool,
    /// Name shown.
    pub name: Text,
    /// Row of the specification.
    pub row: &'static str,
}

macro_rules! mcodes {
    ($table:ident: $($code:literal, $row:literal, $waits:literal, $action:expr, $zh:literal, $en:literal;)*) => {
        /// Every M code of these machines, by number.
        pub const $table: &[MCode] = &[$(MCode {
            code: $code, action: $action, waits: $waits, name: Text::new($zh, $en), row: $row,
        },)*];
    };
}

mcodes! {
    MCODES:
    0, "K3.14", true, Action::Pause, "程序暂停", "program stop";
    1, "B4", true, Action::OptionalStop, "选择停/跳转", "optional stop, jump";
    2, "K3.14", true, Action::End, "程序结束", "program end";
    3, "K3.1", true, Action::Ask(Request::WheelStart), "砂轮启动", "wheel start";
    5, "K3.1", false, Action::Ask(Request::WheelStop), "砂轮停止", "wheel stop";
    8, "K3.2", false, Action::Ask(Request::Switch(Output::Coolant, true)), "冷却开", "coolant on";
    9, "K3.2", false, Action::Ask(Request::Switch(Output::Coolant, false)), "冷却关", "coolant off";
    10, "K3.3", true, Action::Ask(Request::TailstockAdvance), "尾座进", "tailstock advance";
    11, "K3.3", true, Action::Ask(Request::TailstockRetract), "尾座退", "tailstock retract";
    14, "K3.5", false, Action::Ask(Request::HydraulicOn), "液压开", "hydraulic on";
    15, "K3.5", false, Action::Ask(Request::HydraulicOff), "液压关", "hydraulic off";
    20, "B4", true, Action::Pulse, "输出口脉冲", "pulse a port";
    21, "B4", false, Action::Port(true), "输出口开", "port on";
    22, "B4", false, Action::Port(false), "输出口关", "port off";
    26, "B4", true, Action::Ask(Request::SecondSpindleStart(false)), "第二主轴正转", "second spindle clockwise";
    27, "B4", true, Action::Ask(Request::SecondSpindleStart(true)), "第二主轴反转", "second spindle counter-clockwise";
    28, "B4", false, Action::Ask(Request::SecondSpindleStop), "第二主轴停止", "second spindle stop";
    30, "K3.14", true, Action::End, "程序结束", "program end";
    31, "K3.14", false, Action::Count, "工件计数", "count a workpiece";
    32, "K3.8", false, Action::Ask(Request::Switch(Output::Lubrication, true)), "润滑开", "lubrication on";
    33, "K3.8", false, Action::Ask(Request::Switch(Output::Lubrication, false)), "润滑关", "lubrication off";
    35, "K4.3", true, Action::Flow, "振荡开启 (G35)", "oscillation on (G35)";
    36, "K4.3", true, Action::Flow, "振荡关闭 (G36)", "oscillation off (G36)";
    41, "B4", true, Action::Ask(Request::Gear(0)), "1 档", "gear 1";
    42, "B4", true, Action::Ask(Request::Gear(1)), "2 档", "gear 2";
    43, "B4", true, Action::Ask(Request::Gear(2)), "3 档", "gear 3";
    44, "B4", true, Action::Ask(Request::Gear(3)), "4 档", "gear 4";
    50, "K3.12", false, Action::Ask(Request::Switch(Output::User1, true)), "输出 1 开", "user output 1 on";
    51, "K3.12", false, Action::Ask(Request::Switch(Output::User1, false)), "输出 1 关", "user output 1 off";
    52, "K3.12", false, Action::Ask(Request::Switch(Output::User2, true)), "输出 2 开", "user output 2 on";
    53, "K3.12", false, Action::Ask(Request::Switch(Output::User2, false)), "输出 2 关", "user output 2 off";
    54, "K3.12", false, Action::Ask(Request::Switch(Output::User3, true)), "输出 3 开", "user output 3 on";
    55, "K3.12", false, Action::Ask(Request::Switch(Output::User3, false)), "输出 3 关", "user output 3 off";
    56, "K3.12", false, Action::Ask(Request::Switch(Output::User4, true)), "输出 4 开", "user output 4 on";
    57, "K3.12", false, Action::Ask(Request::Switch(Output::User4, false)), "输出 4 关", "user output 4 off";
    58, "K3.12", false, Action::Ask(Request::Switch(Output::User5, true)), "输出 5 开", "user output 5 on";
    59, "K3.12", false, Action::Ask(Request::Switch(Output::User5, false)), "输出 5 关", "user output 5 off";
    63, "K3.4", true, Action::Ask(Request::DriveHigh), "头架高速", "headstock high";
    64, "K3.4", true, Action::Ask(Request::DriveLow), "头架低速", "headstock low";
    65, "K3.4", false, Action::Ask(Request::DriveStop), "头架停止", "headstock stop";
    70, "K3.9", true, Action::Ask(Request::Gauge(Gauge::Radial, true)), "径向量仪伸出", "radial gauge out";
    75, "K3.9", true, Action::Ask(Request::Gauge(Gauge::Radial, false)), "径向量仪缩回", "radial gauge in";
    78, "K3.10", true, Action::Ask(Request::Gauge(Gauge::Axial, true)), "轴向量仪伸出", "axial gauge out";
    79, "K3.10", true, Action::Ask(Request::Gauge(Gauge::Axial, false)), "轴向量仪缩回", "axial gauge in";
    80, "K3.13", true, Action::AwaitInput(Input::User1), "等待输入 1", "wait for user input 1";
    81, "K3.13", true, Action::AwaitInput(Input::User2), "等待输入 2", "wait for user input 2";
    82, "K3.13", true, Action::AwaitInput(Input::User3), "等待输入 3", "wait for user input 3";
    83, "K3.13", true, Action::AwaitInput(Input::User4), "等待输入 4", "wait for user input 4";
    84, "K3.13", true, Action::AwaitInput(Input::User5), "等待输入 5", "wait for user input 5";
    85, "K3.13", true, Action::AwaitInput(Input::User6), "等待输入 6", "wait for user input 6";
    86, "K3.13", true, Action::AwaitInput(Input::User7), "等待输入 7", "wait for user input 7";
    87, "K3.13", true, Action::AwaitInput(Input::User8), "等待输入 8", "wait for user input 8";
    88, "K3.13", true, Action::AwaitInput(Input::User9), "等待输入 9", "wait for user input 9";
    89, "K3.13", true, Action::AwaitInput(Input::User10), "等待输入 10", "wait for user input 10";
    91, "K3.15", false, Action::Flow, "输入有效跳转", "jump if input active";
    92, "K3.15", false, Action::Flow, "输入无效跳转", "jump if input not active";
    94, "K3.11", true, Action::Ask(Request::Magnetise), "充磁", "magnetise";
    95, "K3.11", true, Action::Ask(Request::Demagnetise), "退磁", "demagnetise";
    98, "K3.15", false, Action::Flow, "调用子程序", "call a subprogram";
    99, "K3.15", false, Action::Flow, "子程序返回", "return from a subprogram";
}

mcodes! {
    LATHE_MCODES:
    0, "L7", true, Action::Pause, "程序暂停", "program stop";
    2, "L7", true, Action::End, "程序结束", "program end";
    3, "L7", true, Action::Ask(Request::SpindleStart(false)), "主轴正转", "spindle forward";
    4, "L7", true, Action::Ask(Request::SpindleStart(true)), "主轴反转", "spindle reverse";
    5, "L7", true, Action::Ask(Request::SpindleStop), "主轴停止", "spindle stop";
    7, "L7", false, Action::Ask(Request::Switch(Output::Coolant, true)), "冷却开", "coolant on";
    8, "L7", false, Action::Ask(Request::Switch(Output::Coolant, false)), "冷却关", "coolant off";
    97, "L7", false, Action::Flow, "程序跳转", "jump";
    98, "L7", false, Action::Flow, "子程序调用", "call a subprogram";
    99, "L7", false, Action::Flow, "子程序返回", "return from a subprogram";
}

/// What the SINUMERIK has beside the family's codes.
const MORE_802D: &[MCode] = &[
    // The grinding head turns one way; M4 starts it as M3 does.
    MCode {
        code: 4,
        action: Action::Ask(Request::WheelStart),
        waits: true,
        name: Text::new("砂轮启动", "wheel start"),
        row: "S1",
    },
];

/// The M codes of a language.
#[must_use]
pub const fn table(system: System) -> &'static [MCode] {
    match system {
        System::LatheA | System::Mill | System::Sinumerik => MCODES,
        System::SuperMan => LATHE_MCODES,
    }
}

/// The row of a code in a language.
#[must_use]
pub fn find_in(system: System, code: u16) -> Option<&'static MCode> {
    let more = if matches!(system, System::Sinumerik) { MORE_802D } else { &[] };
    table(system).iter().chain(more).find(|row| row.code == code)
}

/// Codes of the control that this version reads but does not drive: a run stops before their block.
pub const NOT_YET: &[u16] = &[];

/// Whether the control has the code at all.
#[must_use]
pub fn is_known(code: u32) -> bool {
    u16::try_from(code).is_ok_and(|code| find(code).is_some() || NOT_YET.contains(&code))
}

/// The row of a code.
#[must_use]
pub fn find(code: u16) -> Option<&'static MCode> {
    MCODES.iter().find(|row| row.code == code)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn k3_the_codes_stand_once_and_in_order() {
        assert!(MCODES.windows(2).all(|pair| pair[0].code < pair[1].code));
        assert!(find(4).is_none() && !is_known(4) && !is_known(100));
        assert!(NOT_YET.iter().all(|code| find(*code).is_none() && is_known(u32::from(*code))));
    }
}
