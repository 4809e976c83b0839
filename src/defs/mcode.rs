//! The M codes: action, name, help and specification row of each.
//! Source: spec K3, B4.

use super::equipment::{Equipment, Needs};
use super::signal::{Input, Output};
use super::text::Text;

/// The action of an M code. `machine` decides whether and how it is executed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MCodeAction {
    /// Wait for cycle start.
    ProgramStop,
    /// Wait for cycle start if optional stop is on.
    OptionalStop,
    /// End of program (K3.14).
    ProgramEnd,
    /// Count one workpiece.
    CountWorkpiece,
    /// Request a change of a machine unit.
    Request(Request),
    /// Switch the port of the P word on or off (M21, M22).
    Port(bool),
    /// Switch the port of the P word on for the milliseconds of the L word (M20).
    Pulse,
    /// Wait until a user input is active.
    AwaitInput(Input),
    /// Handled by the interpreter: jumps and calls.
    ProgramFlow,
}

/// A change of the machine state requested by an M code, a key or a rule. The interlock table accepts or refuses it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Request {
    /// Start the wheel.
    WheelStart,
    /// Stop the wheel.
    WheelStop,
    /// Tailstock forward.
    TailstockAdvance,
    /// Tailstock back.
    TailstockRetract,
    /// Headstock, dresser roll or table at high speed (M63).
    WorkDriveHigh,
    /// Headstock at low speed; same as high for roll and table, which have one speed (M64).
    WorkDriveLow,
    /// Headstock, roll or table off (M65).
    WorkDriveStop,
    /// Hydraulic pump on.
    HydraulicOn,
    /// Hydraulic pump off.
    HydraulicOff,
    /// Clamp the part by the magnet.
    Magnetise,
    /// Release the part by decaying field reversals.
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
    /// Switch an output without an interlock.
    Switch(Output, bool),
    /// Switch a port by its number (M21, M22).
    Port(u8, bool),
    /// Pulse a port: port number, duration in milliseconds (M20).
    Pulse(u8, u32),
    /// Start the cycle of the oscillation cylinder (P17.1=1).
    CylinderOn,
    /// Both cylinder valves off.
    CylinderOff,
    /// The main spindle of a lathe on; true is counter-clockwise (M04).
    SpindleStart(bool),
    /// The main spindle of a lathe off.
    SpindleStop,
    /// Index the tool turret to station 1 to 4; 0 is the next one.
    ToolTurret(u8),
    /// Start or resume a program.
    CycleStart,
    /// Execute an MDI line.
    MdiStart,
    /// Home axes.
    HomeAxes,
    /// Jog, step or handwheel.
    Jog,
}

impl MCodeAction {
    /// The device that the action needs to exist. K5.3: tailstock codes exist only with a tailstock; the codes of the
    /// other devices exist everywhere and are refused by the interlock table.
    #[must_use]
    pub const fn needs(self) -> Needs {
        match self {
            Self::Request(Request::TailstockAdvance | Request::TailstockRetract) => Some(Equipment::Tailstock),
            Self::Request(_)
            | Self::ProgramStop
            | Self::OptionalStop
            | Self::ProgramEnd
            | Self::CountWorkpiece
            | Self::Port(_)
            | Self::Pulse
            | Self::AwaitInput(_)
            | Self::ProgramFlow => None,
        }
    }
}

/// A unit that a request switches on or off. It must run again before a program continues inside its text (B5).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SwitchedUnit {
    /// The grinding wheel.
    Wheel,
    /// What turns the workpiece: headstock, table, dresser roll, or the main spindle of a lathe.
    WorkDrive,
    /// The coolant.
    Coolant,
}

impl MCodeAction {
    /// The unit that the action switches, and whether on. The end of the program is not among them: nothing follows it.
    #[must_use]
    pub const fn switched_unit(self) -> Option<(SwitchedUnit, bool)> {
        match self {
            Self::Request(request) => request.switched_unit(),
            Self::ProgramStop | Self::OptionalStop | Self::ProgramEnd | Self::CountWorkpiece => None,
            Self::Port(_) | Self::Pulse | Self::AwaitInput(_) | Self::ProgramFlow => None,
        }
    }
}

impl Request {
    /// The unit that the request switches, and whether on.
    #[must_use]
    pub const fn switched_unit(self) -> Option<(SwitchedUnit, bool)> {
        match self {
            Self::WheelStart => Some((SwitchedUnit::Wheel, true)),
            Self::WheelStop => Some((SwitchedUnit::Wheel, false)),
            Self::WorkDriveHigh | Self::WorkDriveLow | Self::SpindleStart(_) => Some((SwitchedUnit::WorkDrive, true)),
            Self::WorkDriveStop | Self::SpindleStop => Some((SwitchedUnit::WorkDrive, false)),
            Self::Switch(Output::Coolant, on) => Some((SwitchedUnit::Coolant, on)),
            Self::Switch(..) | Self::Port(..) | Self::Pulse(..) => None,
            Self::TailstockAdvance | Self::TailstockRetract | Self::HydraulicOn | Self::HydraulicOff => None,
            Self::Magnetise | Self::Demagnetise | Self::MagnetOff => None,
            Self::SecondSpindleStart(_) | Self::SecondSpindleStop | Self::Gauge(..) | Self::Gear(_) => None,
            Self::CylinderOn | Self::CylinderOff | Self::ToolTurret(_) => None,
            Self::CycleStart | Self::MdiStart | Self::HomeAxes | Self::Jog => None,
        }
    }
}

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
    pub action: MCodeAction,
    /// Whether the next block waits until the action is done.
    pub waits: bool,
    /// Name shown.
    pub name: Text,
    /// Syntax, waiting conditions and alarms.
    pub help: Text,
    /// Specification row.
    pub spec_row: &'static str,
}

macro_rules! mcodes {
    ($table:ident: $($code:literal, $row:literal, $waits:literal, $action:expr, $zh:literal, $en:literal,
        $help_zh:literal, $help_en:literal;)*) => {
        /// Every M code of this table, by number.
        pub const $table: &[MCode] = &[$(MCode {
            code: $code, action: $action, waits: $waits, name: Text::new($zh, $en),
            help: Text::new($help_zh, $help_en), spec_row: $row,
        },)*];
    };
}

mcodes! {
    MCODES:
    0, "K3.14", true, MCodeAction::ProgramStop, "程序暂停", "program stop",
        "程序停在本段，按循环启动继续；砂轮、头架照旧。暂停中所有键有效。", "The program stops here, cycle start continues; wheel and workpiece drive stay on. All keys work during the stop.";
    1, "B4", true, MCodeAction::OptionalStop, "选择停/跳转", "optional stop, jump",
        "选择停键灯亮时同 M00；M01 Ln 跳到 N n。", "Stops as M00 while OPT STOP is lit; M01 Ln jumps to block N n.";
    2, "K3.14", true, MCodeAction::ProgramEnd, "程序结束", "program end",
        "同 M30。", "Same as M30.";
    3, "K3.1", true, MCodeAction::Request(Request::WheelStart), "砂轮启动", "wheel start",
        "液压、压力和充磁条件满足才启动；等 P61 后执行下一段。S 为转速。条件不满足：程序在该段前等待，或报警 180、186、187。", "Starts only if hydraulics, pressure and magnet conditions are met; the next block waits P61. S is the speed. If a condition is not met, the program waits before the block, or alarm 180, 186, 187.";
    5, "K3.1", false, MCodeAction::Request(Request::WheelStop), "砂轮停止", "wheel stop",
        "砂轮断开，惯性停转。", "Wheel off; it coasts to a stop.";
    8, "K3.2", false, MCodeAction::Request(Request::Switch(Output::Coolant, true)), "冷却开", "coolant on",
        "冷却液打开；装了流量开关（P333）时 P83 后检查，报警 192。", "Coolant on; a flow switch (P333) is checked after P83, alarm 192.";
    9, "K3.2", false, MCodeAction::Request(Request::Switch(Output::Coolant, false)), "冷却关", "coolant off",
        "冷却液关闭。", "Coolant off.";
    10, "K3.3", true, MCodeAction::Request(Request::TailstockAdvance), "尾座进", "tailstock advance",
        "只在 P16.2=1 的外圆磨上有效，否则无效；头架转动时报警 181。装了到位开关时等待到位，P63 内不到报警 185。", "Only with P16.2=1 on GC, otherwise no effect; alarm 181 while the headstock turns. With end switches it waits, alarm 185 after P63.";
    11, "K3.3", true, MCodeAction::Request(Request::TailstockRetract), "尾座退", "tailstock retract",
        "同 M10 的条件；头架转动时报警 181。", "Conditions as M10; alarm 181 while the headstock turns.";
    14, "K3.5", false, MCodeAction::Request(Request::HydraulicOn), "液压开", "hydraulic on",
        "液压泵开；砂轮转动时无效。", "Hydraulic pump on; no effect while the wheel runs.";
    15, "K3.5", false, MCodeAction::Request(Request::HydraulicOff), "液压关", "hydraulic off",
        "液压泵关；砂轮转动时无效。", "Hydraulic pump off; no effect while the wheel runs.";
    20, "B4", true, MCodeAction::Pulse, "输出口脉冲", "pulse a port",
        "M20 P_ L_：输出口 P 接通 L 毫秒，等脉冲结束。属于联锁功能的口报警 195。", "M20 P_ L_: port P on for L ms, the block waits. A port of an interlocked function: alarm 195.";
    21, "B4", false, MCodeAction::Port(true), "输出口开", "port on",
        "M21 P_：输出口 P 接通。属于联锁功能的口报警 195。", "M21 P_: port P on. A port of an interlocked function: alarm 195.";
    22, "B4", false, MCodeAction::Port(false), "输出口关", "port off",
        "M22 P_：输出口 P 断开。属于联锁功能的口报警 195。", "M22 P_: port P off. A port of an interlocked function: alarm 195.";
    26, "B4", true, MCodeAction::Request(Request::SecondSpindleStart(false)), "第二主轴正转", "second spindle clockwise",
        "第二主轴正转。", "Second spindle clockwise.";
    27, "B4", true, MCodeAction::Request(Request::SecondSpindleStart(true)), "第二主轴反转", "second spindle counter-clockwise",
        "第二主轴反转；转向改变前停 P87。", "Second spindle counter-clockwise; pauses P87 before reversing.";
    28, "B4", false, MCodeAction::Request(Request::SecondSpindleStop), "第二主轴停止", "second spindle stop",
        "第二主轴停止。", "Second spindle off.";
    30, "K3.14", true, MCodeAction::ProgramEnd, "程序结束", "program end",
        "程序结束：冷却、头架/台面/滚轮、砂轮关闭（P17.2=1 砂轮不停），回到开头；P6.4=1 时计一个工件。", "Program end: coolant, workpiece drive and wheel off (P17.2=1: wheel stays on), back to the first block; counts a part with P6.4=1.";
    31, "K3.14", false, MCodeAction::CountWorkpiece, "工件计数", "count a workpiece",
        "工件计数加 1。", "Counts one workpiece.";
    32, "K3.8", false, MCodeAction::Request(Request::Switch(Output::Lubrication, true)), "润滑开", "lubrication on",
        "润滑开。", "Lubrication on.";
    33, "K3.8", false, MCodeAction::Request(Request::Switch(Output::Lubrication, false)), "润滑关", "lubrication off",
        "润滑关。", "Lubrication off.";
    35, "K4.3", true, MCodeAction::ProgramFlow, "振荡开启 (G35)", "oscillation on (G35)",
        "单独写：按 P238–P241 振荡，同振荡键；带 X/Z D Q 同 G35。", "Alone: oscillates by P238 to P241 as the key does; with X/Z D Q the same as G35.";
    36, "K4.3", true, MCodeAction::ProgramFlow, "振荡关闭 (G36)", "oscillation off (G36)",
        "同 G36。", "Same as G36.";
    41, "B4", true, MCodeAction::Request(Request::Gear(0)), "1 档", "gear 1",
        "换到 1 档；装了到位开关时等待到位，P88 内不到报警 194。", "Changes to gear 1; with a gear switch it waits, alarm 194 after P88.";
    42, "B4", true, MCodeAction::Request(Request::Gear(1)), "2 档", "gear 2",
        "换到 2 档；装了到位开关时等待到位，P88 内不到报警 194。", "Changes to gear 2; with a gear switch it waits, alarm 194 after P88.";
    43, "B4", true, MCodeAction::Request(Request::Gear(2)), "3 档", "gear 3",
        "换到 3 档；装了到位开关时等待到位，P88 内不到报警 194。", "Changes to gear 3; with a gear switch it waits, alarm 194 after P88.";
    44, "B4", true, MCodeAction::Request(Request::Gear(3)), "4 档", "gear 4",
        "换到 4 档；装了到位开关时等待到位，P88 内不到报警 194。", "Changes to gear 4; with a gear switch it waits, alarm 194 after P88.";
    50, "K3.12", false, MCodeAction::Request(Request::Switch(Output::User1, true)), "输出 1 开", "user output 1 on",
        "用户输出 1 接通，输出口 P274。", "User output 1 on, port P274.";
    51, "K3.12", false, MCodeAction::Request(Request::Switch(Output::User1, false)), "输出 1 关", "user output 1 off",
        "用户输出 1 断开。", "User output 1 off.";
    52, "K3.12", false, MCodeAction::Request(Request::Switch(Output::User2, true)), "输出 2 开", "user output 2 on",
        "用户输出 2 接通，输出口 P275。", "User output 2 on, port P275.";
    53, "K3.12", false, MCodeAction::Request(Request::Switch(Output::User2, false)), "输出 2 关", "user output 2 off",
        "用户输出 2 断开。", "User output 2 off.";
    54, "K3.12", false, MCodeAction::Request(Request::Switch(Output::User3, true)), "输出 3 开", "user output 3 on",
        "用户输出 3 接通，输出口 P276。", "User output 3 on, port P276.";
    55, "K3.12", false, MCodeAction::Request(Request::Switch(Output::User3, false)), "输出 3 关", "user output 3 off",
        "用户输出 3 断开。", "User output 3 off.";
    56, "K3.12", false, MCodeAction::Request(Request::Switch(Output::User4, true)), "输出 4 开", "user output 4 on",
        "用户输出 4 接通，输出口 P277。", "User output 4 on, port P277.";
    57, "K3.12", false, MCodeAction::Request(Request::Switch(Output::User4, false)), "输出 4 关", "user output 4 off",
        "用户输出 4 断开。", "User output 4 off.";
    58, "K3.12", false, MCodeAction::Request(Request::Switch(Output::User5, true)), "输出 5 开", "user output 5 on",
        "用户输出 5 接通，输出口 P278。", "User output 5 on, port P278.";
    59, "K3.12", false, MCodeAction::Request(Request::Switch(Output::User5, false)), "输出 5 关", "user output 5 off",
        "用户输出 5 断开。", "User output 5 off.";
    63, "K3.4", true, MCodeAction::Request(Request::WorkDriveHigh), "头架高速", "headstock high",
        "外圆磨头架高速，平磨滚轮、圆台磨台面旋转；等 P62。S 为第二模拟输出。尾座动作中报警 181，圆台未充磁报警 187。", "GC: headstock at high speed; GS: dresser roll; GA: table. Waits P62; S drives the second analog output. Alarm 181 while the tailstock moves, 187 if GA is not magnetised.";
    64, "K3.4", true, MCodeAction::Request(Request::WorkDriveLow), "头架低速", "headstock low",
        "头架低速；滚轮和台面只有一个速度，同 M63。", "Headstock at low speed; roll and table have only one speed, as M63.";
    65, "K3.4", false, MCodeAction::Request(Request::WorkDriveStop), "头架停止", "headstock stop",
        "头架、滚轮或台面停止。", "Headstock, roll or table off.";
    70, "K3.9", true, MCodeAction::Request(Request::Gauge(Gauge::Radial, true)), "径向量仪伸出", "radial gauge out",
        "量仪伸出；装了到位开关时等待到位，P80 内不到报警 189。", "Gauge out; with end switches it waits, alarm 189 after P80.";
    75, "K3.9", true, MCodeAction::Request(Request::Gauge(Gauge::Radial, false)), "径向量仪缩回", "radial gauge in",
        "量仪缩回；装了到位开关时等待到位。", "Gauge in; with end switches it waits.";
    78, "K3.10", true, MCodeAction::Request(Request::Gauge(Gauge::Axial, true)), "轴向量仪伸出", "axial gauge out",
        "量仪伸出；装了到位开关时等待到位，P80 内不到报警 189。", "Gauge out; with end switches it waits, alarm 189 after P80.";
    79, "K3.10", true, MCodeAction::Request(Request::Gauge(Gauge::Axial, false)), "轴向量仪缩回", "axial gauge in",
        "量仪缩回；装了到位开关时等待到位。", "Gauge in; with end switches it waits.";
    80, "K3.13", true, MCodeAction::AwaitInput(Input::User1), "等待输入 1", "wait for user input 1",
        "等待用户输入 1 有效（低电平），输入口 P279；状态为等待，复位结束等待。", "Waits until user input 1 is active (low), port P279; RESET ends the wait.";
    81, "K3.13", true, MCodeAction::AwaitInput(Input::User2), "等待输入 2", "wait for user input 2",
        "等待用户输入 2 有效（低电平），输入口 P280；状态为等待，复位结束等待。", "Waits until user input 2 is active (low), port P280; RESET ends the wait.";
    82, "K3.13", true, MCodeAction::AwaitInput(Input::User3), "等待输入 3", "wait for user input 3",
        "等待用户输入 3 有效（低电平），输入口 P281；状态为等待，复位结束等待。", "Waits until user input 3 is active (low), port P281; RESET ends the wait.";
    83, "K3.13", true, MCodeAction::AwaitInput(Input::User4), "等待输入 4", "wait for user input 4",
        "等待用户输入 4 有效（低电平），输入口 P282；状态为等待，复位结束等待。", "Waits until user input 4 is active (low), port P282; RESET ends the wait.";
    84, "K3.13", true, MCodeAction::AwaitInput(Input::User5), "等待输入 5", "wait for user input 5",
        "等待用户输入 5 有效（低电平），输入口 P283；状态为等待，复位结束等待。", "Waits until user input 5 is active (low), port P283; RESET ends the wait.";
    85, "K3.13", true, MCodeAction::AwaitInput(Input::User6), "等待输入 6", "wait for user input 6",
        "等待用户输入 6 有效（低电平），输入口 P284；状态为等待，复位结束等待。", "Waits until user input 6 is active (low), port P284; RESET ends the wait.";
    86, "K3.13", true, MCodeAction::AwaitInput(Input::User7), "等待输入 7", "wait for user input 7",
        "等待用户输入 7 有效（低电平），输入口 P285；状态为等待，复位结束等待。", "Waits until user input 7 is active (low), port P285; RESET ends the wait.";
    87, "K3.13", true, MCodeAction::AwaitInput(Input::User8), "等待输入 8", "wait for user input 8",
        "等待用户输入 8 有效（低电平），输入口 P286；状态为等待，复位结束等待。", "Waits until user input 8 is active (low), port P286; RESET ends the wait.";
    88, "K3.13", true, MCodeAction::AwaitInput(Input::User9), "等待输入 9", "wait for user input 9",
        "等待用户输入 9 有效（低电平），输入口 P287；状态为等待，复位结束等待。", "Waits until user input 9 is active (low), port P287; RESET ends the wait.";
    89, "K3.13", true, MCodeAction::AwaitInput(Input::User10), "等待输入 10", "wait for user input 10",
        "等待用户输入 10 有效（低电平），输入口 P288；状态为等待，复位结束等待。", "Waits until user input 10 is active (low), port P288; RESET ends the wait.";
    91, "K3.15", false, MCodeAction::ProgramFlow, "输入有效跳转", "jump if input active",
        "M91 P_ L_：输入口 P 有效（低电平）时跳到 N L；不写 L 时 P 为程序段。", "M91 P_ L_: jumps to block L if input P is active (low); without L, P is the block.";
    92, "K3.15", false, MCodeAction::ProgramFlow, "输入无效跳转", "jump if input not active",
        "M92 P_ L_：输入口 P 无效时跳到 N L。", "M92 P_ L_: jumps to block L if input P is not active.";
    94, "K3.11", true, MCodeAction::Request(Request::Magnetise), "充磁", "magnetise",
        "P16.0=1 时有效：接通 P81 后为已充磁。", "With P16.0=1: the part counts as magnetised after P81.";
    95, "K3.11", true, MCodeAction::Request(Request::Demagnetise), "退磁", "demagnetise",
        "P16.0=1 时有效：P82 内退磁后两路输出断开；台面或砂轮转动时报警 187。", "With P16.0=1: demagnetises for P82, then both outputs are off; alarm 187 while table or wheel turns.";
    98, "K3.15", false, MCodeAction::ProgramFlow, "调用子程序", "call a subprogram",
        "M98 P_ L_：调用子程序 O P，L 次；最多 4 层。", "M98 P_ L_: calls subprogram O P, L times; at most four levels.";
    99, "K3.15", false, MCodeAction::ProgramFlow, "子程序返回", "return from a subprogram",
        "子程序返回；M99 Pn 回到 N n；在主程序中为重复执行。", "Returns from a subprogram; M99 Pn returns to block n; in a main program it restarts from the beginning.";
}

mcodes! {
    LATHE_MCODES:
    0, "L7", true, MCodeAction::ProgramStop, "程序暂停", "program stop",
        "程序停在本段，按循环启动继续。", "The program stops here; cycle start continues.";
    2, "L7", true, MCodeAction::ProgramEnd, "程序结束", "program end",
        "程序结束，主轴和冷却关闭。", "Program end: spindle and coolant off.";
    3, "L7", true, MCodeAction::Request(Request::SpindleStart(false)), "主轴正转", "spindle forward",
        "主轴正转，输出脉冲 P386（0.4 s）；S 为转速，不写按 P73。", "Spindle forward, a pulse of P386 (0.4 s); S is the speed, P73 without S.";
    4, "L7", true, MCodeAction::Request(Request::SpindleStart(true)), "主轴反转", "spindle reverse",
        "主轴反转，输出脉冲 P386。", "Spindle in reverse, a pulse of P386.";
    5, "L7", true, MCodeAction::Request(Request::SpindleStop), "主轴停止", "spindle stop",
        "主轴停止，输出脉冲 P386。", "Spindle off, a pulse of P386.";
    7, "L7", false, MCodeAction::Request(Request::Switch(Output::Coolant, true)), "冷却开", "coolant on",
        "冷却液打开。", "Coolant on.";
    8, "L7", false, MCodeAction::Request(Request::Switch(Output::Coolant, false)), "冷却关", "coolant off",
        "冷却液关闭：与其他机型相反。", "Coolant off: opposite to the other kinds.";
    97, "L7", false, MCodeAction::ProgramFlow, "程序跳转", "jump",
        "M97 L####：跳到段号 L。", "M97 L####: jumps to block L.";
    98, "L7", false, MCodeAction::ProgramFlow, "子程序调用", "call a subprogram",
        "M98 L####：调用主程序之后的子程序，入口段号 L。", "M98 L####: calls the subprogram at block L, after the main program.";
    99, "L7", false, MCodeAction::ProgramFlow, "子程序返回", "return from a subprogram",
        "子程序返回。", "Returns from the subprogram.";
}

// M codes that only the SINUMERIK dialect has.
mcodes! {
    EXTRA_802D:
    // The grinding head has one direction; M4 is the same as M3.
    4, "S1", true, MCodeAction::Request(Request::WheelStart), "砂轮启动", "wheel start",
        "磨头只有一个转向：同 M3。", "The grinding head has one direction only: same as M3.";
}

/// M codes that the SINUMERIK dialect does not have: ports, oscillation, jumps and calls.
pub(super) const EXCLUDED_802D: &[u16] = &[20, 21, 22, 35, 36, 91, 92, 98, 99];

/// Codes that this version reads but does not execute: the program stops before their block. None at present.
pub const NOT_IMPLEMENTED: &[u16] = &[];

/// Whether the KT-830 table has the code.
#[must_use]
pub fn is_known(code: u32) -> bool {
    u16::try_from(code).is_ok_and(|code| find(code).is_some() || NOT_IMPLEMENTED.contains(&code))
}

/// The row of a code in the KT-830 table.
#[must_use]
pub fn find(code: u16) -> Option<&'static MCode> {
    MCODES.iter().find(|row| row.code == code)
}
