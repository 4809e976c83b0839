//! The alarms: number, text, cause, remedy, reaction and reset rule.
//! Program alarms (1–65, 67–99, 500–599) carry their position in the program; their texts are in `program_error`.
//! Source: spec B8, K3.

use super::text::Text;

/// What the machine does when an alarm is raised.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Reaction {
    /// The alarm is shown; nothing stops (for example an invalid page file).
    Show,
    /// Blocks the wheel and the programs that start it. It ends a running program if it has stopped a unit.
    BlockWheel,
    /// Blocks cycle start. The code that raises the alarm decides whether a running program ends.
    BlockStart,
    /// Holds the program like a feed hold and blocks cycle start. Nothing else stops.
    HoldProgram,
    /// Ends the program: the axes brake along the path. Wheel and fluids stay on.
    StopProgram,
    /// Ends the program and stops wheel and workpiece drive.
    StopProgramAndWheel,
    /// All axes brake at full deceleration; outputs go to their safe state.
    StopAll,
}

impl Reaction {
    /// The reaction as shown on the screen.
    #[must_use]
    pub const fn name(self) -> Text {
        match self {
            Self::Show => Text::new("只显示，不停机", "display only, nothing stops"),
            Self::BlockWheel => {
                Text::new("禁止启动砂轮和启动砂轮的程序", "the wheel and programs that start it are blocked")
            }
            Self::BlockStart => Text::new("禁止循环启动", "cycle start is blocked"),
            Self::HoldProgram => Text::new("程序暂停，禁止循环启动", "program held, cycle start is blocked"),
            Self::StopProgram => Text::new(
                "程序结束，轴减速停止；砂轮和液体不变",
                "program ends, axes decelerate to a stop; wheel and fluids stay on",
            ),
            Self::StopProgramAndWheel => {
                Text::new("程序结束，砂轮和头架/台面停止", "program ends, wheel and workpiece drive stop")
            }
            Self::StopAll => {
                Text::new("各轴急停，输出进入安全状态", "all axes stop at once, outputs go to the safe state")
            }
        }
    }
}

/// How an alarm is cleared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResetRule {
    /// By RESET, once its cause is gone.
    Reset,
    /// Clears itself when its cause is gone.
    SelfClearing,
    /// Clears itself, unless it has stopped a wheel or a program; then by RESET once its cause is gone.
    SelfClearingUnlessStopped,
}

impl ResetRule {
    /// The rule as shown on the screen.
    #[must_use]
    pub const fn name(self) -> Text {
        match self {
            Self::Reset => Text::new("排除原因后按复位", "by RESET, once the cause is gone"),
            Self::SelfClearing => Text::new("原因排除后自动消失", "automatically, once the cause is gone"),
            Self::SelfClearingUnlessStopped => Text::new(
                "原因排除后自动消失；若已停砂轮或程序，再按复位",
                "automatically, once the cause is gone; by RESET if it stopped a wheel or a program",
            ),
        }
    }
}

/// One row of the alarm table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alarm {
    /// Alarm number.
    pub number: u16,
    /// Short description.
    pub text: Text,
    /// Cause.
    pub cause: Text,
    /// Remedy.
    pub remedy: Text,
    /// Reaction of the machine.
    pub reaction: Reaction,
    /// How it is cleared.
    pub reset: ResetRule,
}

macro_rules! alarms {
    ($($name:ident = $number:literal, $reaction:ident, $reset:ident, $zh:literal, $en:literal,
        $cause_zh:literal, $cause_en:literal, $remedy_zh:literal, $remedy_en:literal;)*) => {
        $(#[doc = $en] pub const $name: u16 = $number;)*
        /// Every alarm that is not a program alarm, by number.
        pub const ALARMS: &[Alarm] = &[$(Alarm {
            number: $number, text: Text::new($zh, $en), cause: Text::new($cause_zh, $cause_en),
            remedy: Text::new($remedy_zh, $remedy_en), reaction: Reaction::$reaction, reset: ResetRule::$reset,
        },)*];
    };
}

alarms! {
    EMERGENCY_STOP = 0, StopAll, Reset, "急停", "emergency stop",
        "急停按钮按下或急停回路断开", "the emergency stop is pressed or its circuit is open",
        "排除危险，松开急停后按复位", "remove the danger, release the button, press RESET";
    PAGE_FILES_INVALID = 66, Show, SelfClearing, "页面文件不全或格式错误", "page files missing or in wrong format",
        "C00nn.TXT 或 B00nn.BMP 缺少，或格式不符", "C00nn.TXT or B00nn.BMP is missing or in the wrong format",
        "按文件名和行号在页面设计中修改，或改好后重新拷贝", "correct the named line in the page designer, or copy the file again";
    NOT_HOMED = 100, BlockStart, Reset, "未回机械零点", "axes not homed",
        "开机后未回零即启动程序", "cycle start before homing",
        "按机械零点方式，各轴回零", "choose mode HOME and home every axis";
    SOFT_LIMIT = 101, StopProgram, Reset, "软限位", "soft limit",
        "程序或移动目标超出软限位", "the target is beyond a soft limit",
        "检查坐标系和程序尺寸；手动向反方向移开", "check work offset and program; jog the other way";
    HARD_LIMIT = 102, StopAll, Reset, "硬限位", "limit switch",
        "轴压到限位开关", "an axis has reached its limit switch",
        "复位后向反方向移开，重新回零", "RESET, jog the other way, home again";
    FOLLOWING_ERROR = 103, StopAll, Reset, "跟随误差过大", "following error too large",
        "轴没有跟上指令：机械卡住或驱动故障", "an axis did not follow: jammed or drive fault",
        "检查驱动和机械，复位后重新回零", "check drive and mechanics, RESET, home again";
    DRIVE_FAULT = 104, StopAll, Reset, "驱动报警", "drive fault",
        "伺服驱动器报警", "the servo drive reports a fault",
        "查看驱动器报警号，排除后复位；没有绝对编码器的轴回零", "read the drive's alarm code, correct the fault, RESET; home the axes without absolute encoders";
    HOMING_FAILED = 105, StopProgram, Reset, "回零失败", "homing failed",
        "最大行程内没有遇到或离开零点开关", "the home switch was not reached or not left within the maximum travel",
        "检查零点开关和接线", "check the home switch and its wiring";
    IN_POSITION_TIMEOUT = 106, StopProgram, Reset, "到位超时", "in-position time-out",
        "运动结束后轴没有进入到位宽度", "an axis did not settle in position after its move",
        "检查驱动增益和机械", "check drive gain and mechanics";
    POWER_FAIL = 107, StopAll, Reset, "供电中断", "supply fails",
        "供电监视 P369 报告电源中断", "the supply monitor at P369 reports that the power goes",
        "电源恢复后按复位；断点已保存，需要时重新回零", "RESET once the power is back; the place of the program is kept, home again if needed";
    HYDRAULIC_PRESSURE = 180, BlockWheel, SelfClearingUnlessStopped, "砂轮启动时液压异常", "hydraulic pressure missing",
        "液压未打开，或延时 P270 后没有压力信号 P269", "hydraulics off, or no pressure signal P269 after the delay P270",
        "打开液压，检查油泵、油位和压力开关；停机后压力恢复按复位", "switch hydraulics on, check pump, oil, pressure switch; RESET once pressure is back";
    TAILSTOCK_INTERLOCK = 181, StopProgram, Reset, "头架与尾座互锁", "headstock and tailstock interlock",
        "头架转动时尾座不能动作，尾座动作时头架不能启动", "tailstock moved while the headstock turns, or headstock started while it moves",
        "停止头架，或等待尾座到位后再操作", "stop the headstock, or wait for the tailstock";
    OSCILLATING_AT_START = 182, BlockStart, SelfClearing, "振荡中不能启动程序", "oscillating at cycle start",
        "振荡没有关闭就按了循环启动；暂停中只指按键启动的振荡", "cycle start while an axis is oscillating; in a hold, by the key",
        "关闭振荡后再启动", "stop the oscillation first";
    GAUGE_SIGNAL_MISSING = 183, StopProgram, Reset, "G78 未收到量仪信号", "G78 without a gauge signal",
        "走到 Z 指定位置仍没有信号", "the end position was reached without a signal",
        "检查量仪、端面位置和 Z 值", "check gauge, face and Z";
    WORK_DRIVE_BLOCKED = 184, StopProgram, Reset, "头架/台面不能启动", "workpiece drive cannot start",
        "启动条件不满足", "a start condition is not met", "按提示满足条件", "meet the condition shown";
    TAILSTOCK_TIMEOUT = 185, StopProgram, Reset, "尾座动作超时", "tailstock time-out",
        "尾座没有在 P63 时间内到位", "the tailstock did not reach its end within P63",
        "检查液压压力和到位开关", "check pressure and end switches";
    WHEEL_OVERSPEED = 186, StopProgram, Reset, "砂轮线速度超限", "wheel peripheral speed above its rating",
        "砂轮直径与转速的组合超过额定线速度", "diameter and speed together exceed the rated m/s",
        "降低 S 或更换砂轮", "lower S or change the wheel";
    MAGNET_INTERLOCK = 187, StopProgram, Reset, "充磁/退磁互锁", "magnet interlock",
        "工件未充磁，或台面/砂轮转动中退磁", "not magnetised, or demagnetising while table or wheel is turning",
        "先充磁；停止转动后再退磁", "magnetise first; stop before demagnetising";
    M_CODE_NOT_AVAILABLE = 188, StopProgram, Reset, "M 代码不可用", "M code not available",
        "本版本没有这个 M 代码", "this version does not support the M code",
        "修改程序；M 代码见手册", "correct the program; the manual lists the M codes";
    GAUGE_ARM_TIMEOUT = 189, StopProgram, Reset, "量仪动作超时", "gauge arm time-out",
        "量仪没有在 P80 时间内伸出或缩回到位", "the gauge arm did not reach its end within P80",
        "检查量仪、气压和到位开关", "check the arm, its air and its switches";
    M_CODE_OF_OTHER_KIND = 190, StopProgram, Reset, "本机型没有此 M 代码", "M code of another kind of machine",
        "程序使用了其他机型的 M 代码", "the program uses an M code that this kind does not have",
        "修改程序；各机型 M 代码见手册", "correct the program; the manual lists the codes of each kind";
    GUARD_OPEN = 191, HoldProgram, SelfClearing, "防护门打开", "guard open",
        "运行中防护门被打开", "the guard was opened while a program ran",
        "关好防护门，重新启动头架，再按循环启动", "close the guard, start the headstock again, press cycle start";
    COOLANT_FLOW = 192, HoldProgram, SelfClearing, "冷却液无流量", "no coolant flow",
        "冷却打开后 P83 时间内没有流量信号", "coolant is on and its flow switch has been off longer than P83",
        "检查水箱、水泵和流量开关", "check tank, pump and flow switch";
    LUBRICATION_LEVEL = 193, HoldProgram, SelfClearing, "润滑油位低", "lubrication level low",
        "润滑油位信号断开超过 P84", "the level switch has been off longer than P84",
        "加润滑油", "refill lubrication oil";
    GEAR_CHANGE_TIMEOUT = 194, StopProgram, Reset, "换档超时", "gear change time-out",
        "档位到位信号没有在 P88 时间内到来", "the gear switch did not come on within P88",
        "检查换档机构和到位开关", "check the gear change and its switch";
    PORT_IN_USE = 195, StopProgram, Reset, "输出口被功能占用", "output port used by a function",
        "M20–M22 指定的输出口属于有联锁的功能", "the port of M20–M22 belongs to an interlocked function",
        "改用未分配的输出口，或用该功能的 M 代码", "use a free port, or the function's own M code";
    NO_DRESSING_POINT = 196, StopProgram, Reset, "没有设置修整点", "no dressing point",
        "该轴没有设置砂轮修整点", "the dressing point of the axis has not been set",
        "手动方式移到修整处，软键 相对（第 1 行 F1），按轴名键，再按输入", "in JOG, move to the dressing position; RELATIVE (row 1 F1), axis letter, then INPUT";
    OSCILLATION_REFUSED = 197, StopProgram, Reset, "振荡不能开始", "oscillation cannot start",
        "换向点与当前位置相同、超出软限位或轴未回零", "the reversal point is the current position or beyond a soft limit, or the axis is not homed",
        "检查 G35 的坐标和 P238 P239", "check the coordinate of G35, or P238 and P239";
    AXIS_OSCILLATES = 198, StopProgram, Reset, "轴在振荡中", "the axis is oscillating",
        "程序对正在振荡的轴编写了移动", "the program moves an axis that is oscillating",
        "先用 G36 关闭振荡", "stop it with G36 first";
    CYLINDER_SWITCHES = 199, StopProgram, Reset, "振荡气缸到位信号异常", "oscillation cylinder switches",
        "两个到位信号同时有效，或 P94 时间内没有到位", "both end switches on at once, or none within P94",
        "检查气压和到位开关 P228 P229", "check the air and the switches P228, P229";
    GAUGE_SIGNAL_TOO_EARLY = 200, StopProgram, Reset, "G78 开始时量仪信号已有效", "gauge signal before G78",
        "启动时量仪信号已经接通，或者回退后 0.2 秒还没有断开", "the signal was on before the axis moved, or still 0.2 s after the retract",
        "检查量仪位置和信号；回退量 L 太小时加大", "check gauge position and signal; a larger retract L";
    TAILSTOCK_SIGNAL_LOST = 201, StopProgram, Reset, "尾座到位信号丢失", "tailstock end switch lost",
        "夹紧后尾座到位信号断开，工件可能松动", "the end switch went off while the part was clamped: the part may be loose",
        "检查工件、液压和到位开关，再按尾座进", "check part, pressure and switch, then advance the tailstock again";
    INPUT_NOT_ASSIGNED = 202, StopProgram, Reset, "没有分配输入口", "input has no port",
        "M80–M89 等待的输入没有分配输入口", "the input that M80 to M89 waits for has no port",
        "在参数中分配输入口", "assign its port in the parameters";
    WHEEL_DIAMETER_REFUSED = 203, StopProgram, Reset, "砂轮直径不能接受", "wheel diameter not accepted",
        "程序写入的砂轮直径 #5801 大于现直径、小于最小直径，或没有刀补生效", "the diameter written to #5801 is larger than the current one or too small, or no tool offset is active",
        "新砂轮在换砂轮页面输入；修整程序先调用刀补 (T0101)", "enter a new wheel on the wheel change page; call the tool offset first (T0101)";
    OFFSET_RANGE = 204, StopProgram, Reset, "刀补超出范围", "offset out of range",
        "G10 或 #2001… 使磨耗超过 ±999.999，几何超过 ±9999.999，或 R 不在 0–999.999、T 不在 0–9", "G10 or #2001… would make a wear exceed ±999.999, a geometry ±9999.999, R leave 0 to 999.999 or T 0 to 9",
        "检查数值，可能缺小数点", "check the value: a decimal point may be missing";
    GAUGE_SECOND_TOO_EARLY = 205, StopProgram, Reset, "G78 第二信号过早", "second gauge signal of G78 too early",
        "速度降到 J 以前第二信号 Q 已有效，没有测量", "signal Q came on before the axis ran at speed J: nothing was measured",
        "减小 F，或拉开量仪两级信号的距离", "lower F, or set the two stages of the gauge further apart";
    TOOL_TURRET_TIMEOUT = 210, StopProgram, Reset, "刀架转位超时", "tool post time-out",
        "P388 时间内没有检测到所选刀位的信号", "the station switch did not come on within P388",
        "检查刀架电机、刀位信号 P365–P368", "check the tool post motor and switches P365 to P368";
    THREAD_SPEED = 211, StopProgram, Reset, "螺纹加工主轴转速过高", "spindle too fast for the thread",
        "主轴转速超过 1200/导程-80", "the spindle turns faster than 1200/lead - 80",
        "降低主轴转速或减小导程", "lower the speed or the lead";
    SPINDLE_NOT_TURNING = 212, StopProgram, Reset, "主轴未转动", "the spindle is not turning",
        "螺纹加工时主轴没有转动", "threading was started with the spindle stopped",
        "先用 M03 或 M04 启动主轴", "start it with M03 or M04 first";
    RETAINED_DATA_DAMAGED = 300, BlockStart, SelfClearing, "保存数据损坏或丢失", "retained data damaged or gone",
        "保存数据不能读出或被删除，已用最近的完好数据或所选的数据，没有时用出厂值", "stored data unreadable or gone: the newest whole state or the chosen one is used, else factory values",
        "核对各值或恢复备份，再在报警页用机床厂密码接受，或在那里选以前的数据", "check values, restore a backup, or take earlier data: ACCEPT DATA (builder)";
    STORE_FAILED = 301, BlockStart, Reset, "数据保存失败", "data could not be stored",
        "磁盘满或损坏", "the disk is full or damaged",
        "清理磁盘后复位", "free disk space, then RESET";
    PROGRAM_MISSING = 302, StopProgram, Reset, "程序不存在", "program not found",
        "程序目录中没有该程序", "the program is not in the programs folder",
        "检查程序号，或拷入程序", "check the number or copy the program in";
    SETTINGS_INVALID = 304, BlockStart, SelfClearing, "设置文件损坏或机型不符", "settings damaged or of another kind",
        "settings.ron 不能读出，或机型与保存数据不同；机型按保存数据", "settings.ron cannot be read, or its kind is not that of the retained data; the kind is that of the data",
        "在设置页用机床厂密码重新选择机床类型", "choose the kind of machine again on the settings page (builder's password)";
    VALUES_DROPPED = 305, BlockStart, SelfClearing, "有保存数据不再有效", "stored values are no longer allowed",
        "参数或变量的保存值超出范围，已用出厂值", "stored values of parameters or variables are out of range: factory values are used",
        "核对所列的值，再在报警页用机床厂密码接受", "check the named values, then ACCEPT on the alarm page (builder)";
    STORE_SLOW = 306, Show, SelfClearing, "数据还没有保存", "values are not stored yet",
        "磁盘超过 1 秒没有保存完改动的数据；现在断电会丢失", "the disk has not stored changed values for more than a second: a power cut would lose them",
        "不要关机；经常出现时更换磁盘", "do not switch off; replace the disk if it happens often";
    SERIAL_PORT_NOT_OPEN = 310, Show, Reset, "RS232 端口打不开", "RS232 port cannot be opened",
        "没有选择端口、端口不存在、被占用、没有权限，或不支持波特率 P370", "no port selected, port missing, in use or not permitted, or the baud rate P370 is not supported",
        "在 U盘/通信 的 RS232 页选择端口；检查 P370 和接线", "select the port on the RS232 tab of USB/COMM; check P370 and the cable";
    SERIAL_RECEIVE_TIMEOUT = 311, Show, Reset, "RS232 没有收到数据", "RS232: no data received",
        "P372 时间内没有程序开始，或中途停顿超过 P371", "no program started within P372, or it paused for more than P371",
        "检查电缆和对方的发送、波特率，再接收一次；没有保存任何内容", "check cable, sender and baud rate, then receive again; nothing was stored";
    SERIAL_SEND_TIMEOUT = 312, Show, Reset, "RS232 对方不接收", "RS232: the other side does not accept data",
        "对方发了 XOFF 后 P371 时间内没有 XON，或没有接收", "no XON within P371 after XOFF, or no receiver",
        "先在对方启动接收，检查电缆和流控 XON/XOFF，再发送一次", "start receiving there first, check cable and XON/XOFF, send again";
    SERIAL_GARBLED = 313, Show, Reset, "RS232 数据乱码", "RS232: garbled data",
        "波特率不一致（帧错误），或电缆有干扰；没有保存任何内容", "baud rates differ (framing errors), or the cable picks up noise; nothing was stored",
        "两边波特率相同 (P370)，8 位、无校验、1 停止位；检查屏蔽和接地", "set both sides to P370, 8 bits, no parity, 1 stop bit; check shield and ground";
    SERIAL_PARITY = 314, Show, Reset, "RS232 对方带奇偶校验", "RS232: the other side sends parity",
        "对方设置为 7 位加校验", "it is set to 7 bits with parity",
        "对方改为 8 位、无校验、1 停止位，再接收一次", "set it to 8 bits, no parity, 1 stop bit and receive again";
    SERIAL_BAD_FORMAT = 315, Show, Reset, "RS232 程序格式不对", "RS232: wrong program format",
        "开头没有 %，行中有 %，或没有程序号；没有保存任何内容", "no % at the beginning, a % within a line, or no program number; nothing was stored",
        "程序以 % 单独一行开头和结尾，第一行 O 号或 <名称>", "begin and end the program with a % line, O number or <NAME> in its first line";
    SERIAL_TOO_LONG = 316, Show, Reset, "RS232 程序太长", "RS232: program too long",
        "超过一次传输的长度", "the program is longer than one transmission allows",
        "分段传输，或用 U 盘拷贝；没有保存任何内容", "split it or copy it by USB; nothing was stored";
    SERIAL_DISCONNECTED = 317, Show, Reset, "RS232 端口断开", "RS232 port disconnected",
        "传输中 USB 转串口被拔出，或端口故障", "the adapter was unplugged during the transfer, or the port failed",
        "插好后再传输一次", "plug it in and repeat the transfer";
    SERIAL_FILE_ERROR = 318, Show, Reset, "传输的程序不能读写", "transferred program cannot be read or stored",
        "磁盘已满、写保护，或文件被占用", "the disk is full or write-protected, or the file is not a regular file",
        "清理磁盘后再传输一次", "free disk space and repeat the transfer";
    SERIAL_NOT_SENDABLE = 319, Show, Reset, "程序不能发送", "program cannot be sent",
        "程序中有 %、控制字符，或不是 GBK/UTF-8 文字", "it contains a % or a control character, or is not GBK or UTF-8 text",
        "修改报警中的行后再发送", "correct the line named and send it again";
    HMI_LOST = 400, StopAll, Reset, "操作界面失去响应", "HMI not responding",
        "界面线程停止", "the HMI thread stopped", "重新启动系统", "restart the control";
    LATE_TICKS = 401, StopAll, Reset, "控制周期超时", "control cycle late",
        "连续多个控制周期迟到", "several control cycles in a row were late", "关闭其他程序，检查系统", "close other programs, check the computer";
    BUS_LOST = 402, StopAll, Reset, "输入输出总线中断", "I/O bus not responding",
        "总线没有应答", "the bus does not answer", "检查总线接线和电源", "check bus wiring and supply";
    CONTROL_ENDED = 403, StopAll, Reset, "系统在运行中关闭", "control closed in a run",
        "关机、断开显示或系统结束时程序或轴在运动", "a program ran or an axis moved when the control was ended, by a signal or a lost display",
        "检查工件和砂轮位置，回零；断点在程序页", "check part and wheel, home the axes; the program page has the place";
    CONTROL_STALLED = 404, HoldProgram, Reset, "控制停顿", "control stood still",
        "程序或轴运动中系统停顿超过 P475：休眠、调试或计算机过载", "the system stood still for longer than P475 while a program ran or an axis moved: sleep, a debugger, an overloaded computer",
        "检查机床位置和计算机，复位；程序再循环启动继续，回零重新做", "check machine and computer, RESET; cycle start goes on with a program, homing begins anew";
    STATION_SILENT = 405, StopAll, Reset, "远程站没有应答", "remote station not responding",
        "Modbus TCP 站没有应答、拒绝请求或断开", "a Modbus TCP station does not answer, refuses requests, or is cut off",
        "检查该站的电源、网线、地址和寄存器", "check its supply, network cable, address and registers";
    MACHINE_UNUSABLE = 406, StopAll, SelfClearing, "机床描述不能用", "machine description cannot be used",
        "machine.ron 丢失、损坏，或与数据、参数不符：总线没有启动", "machine.ron is gone or damaged, or contradicts data or parameters: the bus was not started",
        "恢复或改正该文件，或改正参数，再重新启动", "restore or correct the file, or correct the parameter, then restart";
    INVERTER_FAULT = 407, StopAll, Reset, "砂轮变频器故障", "inverter of the wheel in a fault",
        "变频器报告故障，砂轮停转", "the inverter reports a fault, the wheel runs out",
        "按变频器手册处理后复位", "see the manual of the inverter for its code, then RESET";
}

/// The alarms of the RS232 line.
pub const SERIAL_ALARMS: std::ops::RangeInclusive<u16> = SERIAL_PORT_NOT_OPEN..=SERIAL_NOT_SENDABLE;

/// The alarms of lost or changed data.
pub const DATA_ALARMS: std::ops::RangeInclusive<u16> = RETAINED_DATA_DAMAGED..=VALUES_DROPPED;

/// The one of several active alarms, oldest first, that is shown where there is room for one: what has stopped everything,
/// then lost data, then what came first.
#[must_use]
pub fn leading<T>(active: &[T], number: impl Fn(&T) -> u16) -> Option<&T> {
    let first = |wanted: fn(u16) -> bool| active.iter().find(|alarm| wanted(number(alarm)));
    let stops_all = first(|number| reaction(number) == Reaction::StopAll);
    stops_all.or_else(|| first(|number| DATA_ALARMS.contains(&number))).or(active.first())
}

/// First number of the alarms that a program raises with `#3000`.
pub const USER_ALARM_FIRST: u16 = 3_000;
/// Description and remedy of such an alarm.
pub const USER_ALARM_TEXTS: (Text, Text) = (
    Text::new(
        "程序用 #3000 发出的报警，文字、原因和处理由程序给出",
        "an alarm raised by the program with #3000; the program gives text, cause and remedy",
    ),
    Text::new("按文字处理后复位", "follow its text, then RESET"),
);

/// The row of an alarm that is not a program alarm.
#[must_use]
pub fn find(number: u16) -> Option<&'static Alarm> {
    ALARMS.iter().find(|row| row.number == number)
}

/// The reaction to any alarm number; program alarms end the program.
#[must_use]
pub fn reaction(number: u16) -> Reaction {
    find(number).map_or(Reaction::StopProgram, |row| row.reaction)
}

/// The reset rule of any alarm number.
#[must_use]
pub fn reset_rule(number: u16) -> ResetRule {
    find(number).map_or(ResetRule::Reset, |row| row.reset)
}
