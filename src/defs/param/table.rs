//! The table of parameters: bits, numbers and the factory ports.
//! Source: the customer's numbers (P4.4 … P349) and spec K3, K4, B7; numbers 30 to 99 are defined by this project.

use super::row::{AccessLevel, BitParam, FactoryBit, NumberParam};
use crate::defs::equipment::{Equipment, needs};
use crate::defs::signal::{Input, Output};
use crate::defs::text::Text;

macro_rules! bits {
    ($($name:ident = $number:literal bit $bit:literal, $factory:expr, $level:ident, $zh:literal, $en:literal $(, $needs:ident)?;)*) => {
        $(#[doc = $en] pub const $name: BitParam = BitParam {
            number: $number, bit: $bit, name: Text::new($zh, $en), factory: $factory, level: AccessLevel::$level,
            needs: needs!($($needs)?),
        };)*
        /// Every bit, by number and bit.
        pub const BITS: &[BitParam] = &[$($name,)*];
    };
}

macro_rules! numbers {
    ($($name:ident = $number:literal, $min:expr => $max:expr, $factory:expr, $unit:literal, $level:ident, $zh:literal, $en:literal $(, $needs:ident)?;)*) => {
        $(#[doc = $en] pub const $name: NumberParam = NumberParam {
            number: $number, name: Text::new($zh, $en), unit: $unit,
            min: $min as f64, max: $max as f64, factory: $factory as f64, level: AccessLevel::$level,
            needs: needs!($($needs)?),
        };)*
        /// Every number parameter except the ports, in table order.
        pub const NUMBERS: &[NumberParam] = &[$($name,)*];
    };
}

use FactoryBit::{Off, On, With, Without};

bits! {
    WHEEL_RETRACT = 4 bit 4, Off, User, "一键回退有效", "one-key wheel retract enabled";
    HOME_MINUS_X = 5 bit 0, Off, Builder, "X 回零方向为负", "X homes in the minus direction";
    HOME_MINUS_Y = 5 bit 1, Off, Builder, "Y 回零方向为负", "Y homes in the minus direction", AxisY;
    HOME_MINUS_Z = 5 bit 2, Off, Builder, "Z 回零方向为负", "Z homes in the minus direction";
    S_IS_SURFACE_SPEED = 5 bit 3, Off, Builder, "S 为砂轮线速度 m/s", "S is the surface speed of the wheel, m/s";
    ISO_ARC_DIRECTION = 5 bit 4, On, Builder, "超人：G02/G03 方向按说明书图（ISO），0 为反向", "SuperMan: G02/G03 as the manual draws them (ISO); 0 reverses them";
    RADIUS_PROGRAMMING = 6 bit 0, Off, Builder, "半径编程", "radius programming";
    INTEGERS_AS_LEAST_INCREMENTS = 6 bit 1, Off, Builder, "无小数点数值为最小单位", "numbers without a decimal point are in least increments";
    IN_POSITION_CHECK = 6 bit 2, Off, Builder, "准停时检测到位", "in-position check at every exact stop";
    EDIT_VALUES_IN_RUN = 6 bit 3, Off, User, "运行中允许修改磨削数据", "grinding values may be edited in a run";
    COUNT_ON_M30 = 6 bit 4, Off, User, "M30 工件计数", "M30 counts a workpiece";
    TAILSTOCK_BEFORE_HEADSTOCK = 6 bit 5, Off, User, "头架启动要求尾座顶紧", "headstock start needs the tailstock advanced", Tailstock;
    Y_FITTED = 6 bit 6, Off, Builder, "装有 Y 轴", "axis Y is fitted";
    WHEEL_UNDRESSED = 6 bit 7, Off, User, "换砂轮后未修整", "wheel changed and not dressed yet";
    MAGNET_ENABLED = 16 bit 0, With(Equipment::MagneticChuck), Builder, "充磁/退磁有效", "magnet codes and keys enabled";
    WHEEL_NEEDS_MAGNET = 16 bit 1, With(Equipment::MagneticChuck), Builder, "砂轮启动检测充磁", "wheel start needs the part magnetised";
    TAILSTOCK_ENABLED = 16 bit 2, With(Equipment::Tailstock), Builder, "尾座有效", "tailstock code and key enabled";
    NO_HYDRAULIC_CHECK = 17 bit 0, Without(Equipment::Hydraulics), Builder, "不检测液压", "no hydraulic supervision";
    OSCILLATION_BY_CYLINDER = 17 bit 1, Off, Builder, "振荡为气缸控制", "oscillation by cylinder";
    WHEEL_RUNS_AFTER_M30 = 17 bit 2, Off, User, "M30 后砂轮不停", "wheel keeps running after M30";
    SWAP_OSCILLATION_FLAGS = 17 bit 3, Off, Builder, "#438/#439 互换", "#438 and #439 swapped";
    EDIT_OFFSETS = 22 bit 0, Off, User, "刀补界面允许修改", "offset page may be edited";
    PRINT_AS_BMP = 22 bit 1, Off, User, "屏幕打印存为 BMP", "screen prints are saved as BMP";
    FINE_DISPLAY = 22 bit 2, Off, User, "显示到 0.0001 mm", "display resolution 0.0001 mm";
    PROGRAM_PASSWORD = 22 bit 5, On, User, "编辑程序需要密码", "program editing needs the password";
    CLOSE_PASSWORD = 23 bit 6, Off, User, "关闭系统需要密码", "closing the control needs the password";
    SUBPROGRAM_PASSWORD = 23 bit 5, On, User, "编辑 O9000-O9999 需要密码", "editing O9000-O9999 needs the password";
}

numbers! {
    RAPID_X = 30, 1 => 60_000, 6_000, "mm/min", Builder, "X 快速", "rapid X";
    RAPID_Y = 31, 1 => 60_000, 6_000, "mm/min", Builder, "Y 快速", "rapid Y", AxisY;
    RAPID_Z = 32, 1 => 60_000, 10_000, "mm/min", Builder, "Z 快速", "rapid Z";
    ACCELERATION_X = 33, 1 => 20_000, 800, "mm/s²", Builder, "X 加速度", "acceleration X";
    ACCELERATION_Y = 34, 1 => 20_000, 800, "mm/s²", Builder, "Y 加速度", "acceleration Y", AxisY;
    ACCELERATION_Z = 35, 1 => 20_000, 800, "mm/s²", Builder, "Z 加速度", "acceleration Z";
    JERK_X = 36, 100 => 500_000, 20_000, "mm/s³", Builder, "X 加加速度", "jerk X";
    JERK_Y = 37, 100 => 500_000, 20_000, "mm/s³", Builder, "Y 加加速度", "jerk Y", AxisY;
    JERK_Z = 38, 100 => 500_000, 20_000, "mm/s³", Builder, "Z 加加速度", "jerk Z";
    SOFT_PLUS_X = 39, -9_999 => 9_999, 1, "mm", Builder, "X 正软限位", "soft limit X+";
    SOFT_PLUS_Y = 40, -9_999 => 9_999, 1, "mm", Builder, "Y 正软限位", "soft limit Y+", AxisY;
    SOFT_PLUS_Z = 41, -9_999 => 9_999, 1, "mm", Builder, "Z 正软限位", "soft limit Z+";
    SOFT_MINUS_X = 42, -9_999 => 9_999, -300, "mm", Builder, "X 负软限位", "soft limit X-";
    SOFT_MINUS_Y = 43, -9_999 => 9_999, -300, "mm", Builder, "Y 负软限位", "soft limit Y-", AxisY;
    SOFT_MINUS_Z = 44, -9_999 => 9_999, -900, "mm", Builder, "Z 负软限位", "soft limit Z-";
    HOME_X = 45, -9_999 => 9_999, 0, "mm", Builder, "X 零点坐标", "home coordinate X";
    HOME_Y = 46, -9_999 => 9_999, 0, "mm", Builder, "Y 零点坐标", "home coordinate Y", AxisY;
    HOME_Z = 47, -9_999 => 9_999, 0, "mm", Builder, "Z 零点坐标", "home coordinate Z";
    HOME_FAST = 48, 1 => 20_000, 3_000, "mm/min", Builder, "回零快速", "homing fast speed";
    HOME_SLOW = 49, 1 => 2_000, 30, "mm/min", Builder, "回零慢速", "homing slow speed";
    BACKLASH_X = 50, 0 => 2, 0, "mm", Builder, "X 反向间隙", "backlash X";
    BACKLASH_Y = 51, 0 => 2, 0, "mm", Builder, "Y 反向间隙", "backlash Y", AxisY;
    BACKLASH_Z = 52, 0 => 2, 0, "mm", Builder, "Z 反向间隙", "backlash Z";
    FOLLOWING_LIMIT = 53, 0.01 => 100, 8, "mm", Builder, "跟随误差极限", "following error limit";
    IN_POSITION = 54, 0.0001 => 1, 0.0006, "mm", Builder, "到位宽度", "in-position width";
    PATH_TOLERANCE = 55, 0.0001 => 1, 0.01, "mm", User, "G64 轮廓公差", "G64 path tolerance";
    JOG_SPEED = 56, 1 => 20_000, 1_000, "mm/min", User, "手动速度", "jog speed";
    FEED_MAX = 57, 1 => 60_000, 6_000, "mm/min", Builder, "最大进给速度", "maximum feed";
    TICK_TIME = 58, 500 => 4_000, 1_000, "us", Builder, "控制周期", "control cycle time";
    INPUT_FILTER = 59, 0 => 100, 10, "ms", Builder, "输入滤波", "input filter";
    HOMING_TRAVEL = 60, 1 => 9_999, 1_500, "mm", Builder, "回零最大行程", "maximum homing travel";
    WHEEL_RUN_UP = 61, 0 => 60_000, 9_000, "ms", Builder, "砂轮启动延时", "wheel run-up delay";
    HEADSTOCK_RUN_UP = 62, 0 => 60_000, 2_000, "ms", Builder, "头架启动延时", "headstock run-up delay";
    TAILSTOCK_TIMEOUT = 63, 0 => 60_000, 3_000, "ms", Builder, "尾座动作超时", "tailstock time-out", Tailstock;
    WHEEL_RPM_MAX = 64, 1 => 20_000, 1_260, "rpm", Builder, "砂轮最高转速 (10V)", "wheel speed at 10 V";
    ANALOG_2_RPM_MAX = 65, 1 => 20_000, 300, "rpm", Builder, "第二模拟量最高转速 (10V)", "second analog speed at 10 V";
    JOG_KEEP_ALIVE = 66, 20 => 1_000, 200, "ms", Builder, "手动键保持时间", "jog keep-alive";
    HANDWHEEL_SPEED = 67, 1 => 20_000, 3_000, "mm/min", Builder, "手轮最高速度", "maximum handwheel speed";
    IN_POSITION_TIMEOUT = 68, 10 => 60_000, 5_000, "ms", Builder, "到位等待超时", "in-position time-out";
    SKIP_SPEED_MAX = 69, 1 => 20_000, 1_500, "mm/min", Builder, "G31 最大速度", "maximum G31 speed";
    RAPID_F0 = 72, 1 => 5_000, 400, "mm/min", Builder, "快速 F0 速度", "rapid speed at F0";
    WHEEL_RPM = 73, 0 => 20_000, 1_100, "rpm", User, "砂轮默认转速", "wheel speed without S";
    HEADSTOCK_RPM_HIGH = 74, 1 => 2_000, 200, "rpm", Builder, "头架高速转速", "headstock high speed";
    HEADSTOCK_RPM_LOW = 75, 1 => 2_000, 60, "rpm", Builder, "头架低速转速", "headstock low speed";
    HMI_KEEP_ALIVE = 76, 200 => 10_000, 2_000, "ms", Builder, "界面保持时间", "HMI keep-alive";
    WHEEL_DIAMETER = 77, 10 => 2_000, 600, "mm", User, "砂轮直径", "wheel diameter";
    WHEEL_WIDTH = 78, 1 => 1_000, 20, "mm", User, "砂轮宽度", "wheel width";
    WHEEL_RATED_SPEED = 79, 1 => 200, 35, "m/s", User, "砂轮额定线速度", "rated surface speed of the wheel";
    GAUGE_ARM_TIMEOUT = 80, 0 => 60_000, 3_000, "ms", Builder, "量仪动作超时", "gauge arm time-out";
    MAGNETISE_TIME = 81, 0 => 60_000, 1_000, "ms", Builder, "充磁时间", "magnetising time", MagneticChuck;
    DEMAGNETISE_TIME = 82, 0 => 60_000, 6_000, "ms", Builder, "退磁时间", "demagnetising time", MagneticChuck;
    COOLANT_FLOW_DELAY = 83, 0 => 60_000, 3_000, "ms", Builder, "冷却液流量检测延时", "coolant flow check delay";
    LUBRICATION_LEVEL_DELAY = 84, 0 => 60_000, 5_000, "ms", Builder, "润滑油位检测延时", "lubrication level check delay";
    LUBRICATION_INTERVAL = 85, 0 => 1_440, 0, "min", Builder, "润滑间隔 (0 为手动)", "lubrication interval, 0: manual";
    LUBRICATION_TIME = 86, 1 => 600, 10, "s", Builder, "润滑时间", "lubrication time";
    SECOND_SPINDLE_PAUSE = 87, 0 => 60_000, 1_000, "ms", Builder, "第二主轴换向停顿", "pause before the second spindle reverses";
    GEAR_CHANGE_TIMEOUT = 88, 0 => 60_000, 2_000, "ms", Builder, "换档超时", "gear change time-out";
    DRY_RUN_FEED = 89, 1 => 20_000, 3_000, "mm/min", User, "空运行速度", "dry-run feed";
    HOLD_RETRACT_DISTANCE = 90, 0 => 50, 0, "mm", User, "进给保持退砂轮距离", "wheel retract at feed hold, 0 none";
    DRESSING_PROGRAM_FIRST = 91, 0 => 9_999, 1_011, "", User, "修整程序起始号", "first dressing program";
    DRESSING_PROGRAM_LAST = 92, 0 => 9_999, 1_012, "", User, "修整程序末号", "last dressing program";
    JUMP_INPUT = 93, 0 => 64, 0, "", Builder, "M91/M92 默认输入口", "input port of M91/M92 without L, 0 none";
    CYLINDER_TIMEOUT = 94, 0 => 60_000, 3_000, "ms", Builder, "振荡气缸超时", "oscillation cylinder time-out";
    DRESSING_INTERVAL = 95, 0 => 9_999, 0, "", User, "修整间隔件数 (0 无)", "dressing interval in parts, 0 none";
    PARTS_SINCE_DRESSING = 96, 0 => 999_999, 0, "", User, "修整后件数", "parts since the last dressing";
    DRESSING_COUNT = 97, 0 => 999_999, 0, "", User, "换砂轮后修整次数", "dressings since the wheel was changed";
    DRESSING_POINT_SIDE = 98, -1 => 1, -1, "", Builder, "修整器位置 -1:工件侧 0:修整点不变 1:对侧", "dresser: -1 part side, 0 point fixed, 1 opposite side";
    REFERENCE_2_X = 161, -9_999 => 9_999, 0, "mm", Builder, "第 2 参考点 X", "reference point 2 X";
    REFERENCE_2_Y = 162, -9_999 => 9_999, 0, "mm", Builder, "第 2 参考点 Y", "reference point 2 Y", AxisY;
    REFERENCE_2_Z = 163, -9_999 => 9_999, 0, "mm", Builder, "第 2 参考点 Z", "reference point 2 Z";
    REFERENCE_3_X = 164, -9_999 => 9_999, 0, "mm", Builder, "第 3 参考点 X", "reference point 3 X";
    REFERENCE_3_Y = 165, -9_999 => 9_999, 0, "mm", Builder, "第 3 参考点 Y", "reference point 3 Y", AxisY;
    REFERENCE_3_Z = 166, -9_999 => 9_999, 0, "mm", Builder, "第 3 参考点 Z", "reference point 3 Z";
    REFERENCE_4_X = 167, -9_999 => 9_999, 0, "mm", Builder, "第 4 参考点 X", "reference point 4 X";
    REFERENCE_4_Y = 168, -9_999 => 9_999, 0, "mm", Builder, "第 4 参考点 Y", "reference point 4 Y", AxisY;
    REFERENCE_4_Z = 169, -9_999 => 9_999, 0, "mm", Builder, "第 4 参考点 Z", "reference point 4 Z";
    COMPENSATION_SPEED = 99, 6 => 6_000, 600, "mm/min", Builder, "螺距/间隙补偿最大速度", "maximum speed of screw compensation";
    SPINDLE_PULSE_TIME = 386, 10 => 5_000, 400, "ms", Builder, "主轴 M03 M04 M05 脉冲时间", "spindle pulse time", MainSpindle;
    SPINDLE_RUN_UP = 387, 0 => 60_000, 2_000, "ms", Builder, "主轴启动延时", "spindle run-up delay", MainSpindle;
    TOOL_TURRET_TIMEOUT = 388, 0 => 60_000, 5_000, "ms", Builder, "刀架转位超时", "tool post time-out", ToolTurret;
    TOOL_TURRET_CLAMP_TIME = 389, 0 => 10_000, 500, "ms", Builder, "刀架反转锁紧时间", "tool post clamping time", ToolTurret;
    SERVO_LAG = 391, 0 => 200, 20, "ms", Builder, "螺纹：驱动滞后时间", "threading: lag time of the drives", MainSpindle;
    DEFAULT_LINE_FEED = 380, 6 => 2_000, 300, "mm/min", User, "G01 默认速度", "feed of G01 without F";
    DEFAULT_ARC_FEED = 381, 6 => 600, 300, "mm/min", User, "G02/G03 默认速度", "feed of G02 and G03 without F";
    RAPID_Z_PER_X = 382, 0.1 => 10, 2, "mm/mm", Builder, "G00 联动时 Z 与 X 位移比", "Z to X travel ratio of G00";
    LEAST_INPUT_INCREMENT = 383, 0.0001 => 0.1, 0.01, "mm", Builder, "编程最小增量", "least programming increment";
    BAR_DIAMETER = 384, 0 => 1_000, 0, "mm", Operator, "棒料直径 (0 按程序)", "bar diameter, 0: from the program", MainSpindle;
    BAR_LENGTH = 385, 1 => 2_000, 120, "mm", Operator, "棒料伸出长度", "protruding length of the bar", MainSpindle;
    FIXED_STEP_LENGTH = 395, 0 => 500, 0, "mm", Operator, "单步方式定长进给 (0 按倍率键)", "fixed step length in STEP, 0: step keys";
    TOOL_1_SHAPE = 400, 1 => 4, 1, "", Operator, "1 号刀形状 1:外圆 2:尖刀 3:切槽 4:螺纹", "tool 1: 1 turning, 2 neutral, 3 grooving, 4 threading", ToolTurret;
    TOOL_1_WIDTH = 401, 0.5 => 50, 8, "mm", Operator, "1 号刀刀刃宽度", "tool 1: edge width", ToolTurret;
    TOOL_1_EDGE = 402, 1 => 100, 8, "mm", Operator, "1 号刀刀刃高度", "tool 1: edge length", ToolTurret;
    TOOL_1_SHANK = 403, 5 => 200, 25, "mm", Operator, "1 号刀刀杆宽度", "tool 1: shank width", ToolTurret;
    TOOL_2_SHAPE = 404, 1 => 4, 2, "", Operator, "2 号刀形状 1:外圆 2:尖刀 3:切槽 4:螺纹", "tool 2: 1 turning, 2 neutral, 3 grooving, 4 threading", ToolTurret;
    TOOL_2_WIDTH = 405, 0.5 => 50, 8, "mm", Operator, "2 号刀刀刃宽度", "tool 2: edge width", ToolTurret;
    TOOL_2_EDGE = 406, 1 => 100, 8, "mm", Operator, "2 号刀刀刃高度", "tool 2: edge length", ToolTurret;
    TOOL_2_SHANK = 407, 5 => 200, 25, "mm", Operator, "2 号刀刀杆宽度", "tool 2: shank width", ToolTurret;
    TOOL_3_SHAPE = 408, 1 => 4, 3, "", Operator, "3 号刀形状 1:外圆 2:尖刀 3:切槽 4:螺纹", "tool 3: 1 turning, 2 neutral, 3 grooving, 4 threading", ToolTurret;
    TOOL_3_WIDTH = 409, 0.5 => 50, 3, "mm", Operator, "3 号刀刀刃宽度", "tool 3: edge width", ToolTurret;
    TOOL_3_EDGE = 410, 1 => 100, 8, "mm", Operator, "3 号刀刀刃高度", "tool 3: edge length", ToolTurret;
    TOOL_3_SHANK = 411, 5 => 200, 25, "mm", Operator, "3 号刀刀杆宽度", "tool 3: shank width", ToolTurret;
    TOOL_4_SHAPE = 412, 1 => 4, 4, "", Operator, "4 号刀形状 1:外圆 2:尖刀 3:切槽 4:螺纹", "tool 4: 1 turning, 2 neutral, 3 grooving, 4 threading", ToolTurret;
    TOOL_4_WIDTH = 413, 0.5 => 50, 2, "mm", Operator, "4 号刀刀刃宽度", "tool 4: edge width", ToolTurret;
    TOOL_4_EDGE = 414, 1 => 100, 8, "mm", Operator, "4 号刀刀刃高度", "tool 4: edge length", ToolTurret;
    TOOL_4_SHANK = 415, 5 => 200, 25, "mm", Operator, "4 号刀刀杆宽度", "tool 4: shank width", ToolTurret;
    CUTTER_SOURCE = 416, 0 => 2, 0, "", User, "G41/G42 半径 0:刀补 R 1:修整器 (P417) 2:整个砂轮", "radius of G41 and G42: 0 R of the active offset, 1 dresser (P417), 2 whole wheel";
    DRESSER_OFFSET = 417, 1 => 16, 16, "", User, "修整器的刀补号", "tool offset of the dresser";
    PROGRAM_DIGITS = 418, 4 => 8, 4, "", Builder, "程序号位数 4–8", "digits of program numbers in calls, 4 to 8", Wheel;
    G_MACRO_0_CODE = 420, 0 => 999, 0, "", Builder, "调用宏程序 0 的 G 代码 (0 无)", "G code that calls macro 0, 0 none", Wheel;
    G_MACRO_0_PROGRAM = 421, 1 => 9_999, 9_030, "", Builder, "G 代码 0 的宏程序号", "program of G macro 0", Wheel;
    G_MACRO_1_CODE = 422, 0 => 999, 0, "", Builder, "调用宏程序 1 的 G 代码 (0 无)", "G code that calls macro 1, 0 none", Wheel;
    G_MACRO_1_PROGRAM = 423, 1 => 9_999, 9_031, "", Builder, "G 代码 1 的宏程序号", "program of G macro 1", Wheel;
    G_MACRO_2_CODE = 424, 0 => 999, 0, "", Builder, "调用宏程序 2 的 G 代码 (0 无)", "G code that calls macro 2, 0 none", Wheel;
    G_MACRO_2_PROGRAM = 425, 1 => 9_999, 9_032, "", Builder, "G 代码 2 的宏程序号", "program of G macro 2", Wheel;
    G_MACRO_3_CODE = 426, 0 => 999, 0, "", Builder, "调用宏程序 3 的 G 代码 (0 无)", "G code that calls macro 3, 0 none", Wheel;
    G_MACRO_3_PROGRAM = 427, 1 => 9_999, 9_033, "", Builder, "G 代码 3 的宏程序号", "program of G macro 3", Wheel;
    G_MACRO_4_CODE = 428, 0 => 999, 0, "", Builder, "调用宏程序 4 的 G 代码 (0 无)", "G code that calls macro 4, 0 none", Wheel;
    G_MACRO_4_PROGRAM = 429, 1 => 9_999, 9_034, "", Builder, "G 代码 4 的宏程序号", "program of G macro 4", Wheel;
    G_MACRO_5_CODE = 430, 0 => 999, 0, "", Builder, "调用宏程序 5 的 G 代码 (0 无)", "G code that calls macro 5, 0 none", Wheel;
    G_MACRO_5_PROGRAM = 431, 1 => 9_999, 9_035, "", Builder, "G 代码 5 的宏程序号", "program of G macro 5", Wheel;
    G_MACRO_6_CODE = 432, 0 => 999, 0, "", Builder, "调用宏程序 6 的 G 代码 (0 无)", "G code that calls macro 6, 0 none", Wheel;
    G_MACRO_6_PROGRAM = 433, 1 => 9_999, 9_036, "", Builder, "G 代码 6 的宏程序号", "program of G macro 6", Wheel;
    G_MACRO_7_CODE = 434, 0 => 999, 0, "", Builder, "调用宏程序 7 的 G 代码 (0 无)", "G code that calls macro 7, 0 none", Wheel;
    G_MACRO_7_PROGRAM = 435, 1 => 9_999, 9_037, "", Builder, "G 代码 7 的宏程序号", "program of G macro 7", Wheel;
    G_MACRO_8_CODE = 436, 0 => 999, 0, "", Builder, "调用宏程序 8 的 G 代码 (0 无)", "G code that calls macro 8, 0 none", Wheel;
    G_MACRO_8_PROGRAM = 437, 1 => 9_999, 9_038, "", Builder, "G 代码 8 的宏程序号", "program of G macro 8", Wheel;
    G_MACRO_9_CODE = 438, 0 => 999, 0, "", Builder, "调用宏程序 9 的 G 代码 (0 无)", "G code that calls macro 9, 0 none", Wheel;
    G_MACRO_9_PROGRAM = 439, 1 => 9_999, 9_039, "", Builder, "G 代码 9 的宏程序号", "program of G macro 9", Wheel;
    M_MACRO_0_CODE = 440, 0 => 99, 0, "", Builder, "调用宏程序 0 的 M 代码 (0 无)", "M code that calls macro 0, 0 none", Wheel;
    M_MACRO_0_PROGRAM = 441, 1 => 9_999, 9_040, "", Builder, "M 代码 0 的宏程序号", "program of M macro 0", Wheel;
    M_MACRO_1_CODE = 442, 0 => 99, 0, "", Builder, "调用宏程序 1 的 M 代码 (0 无)", "M code that calls macro 1, 0 none", Wheel;
    M_MACRO_1_PROGRAM = 443, 1 => 9_999, 9_041, "", Builder, "M 代码 1 的宏程序号", "program of M macro 1", Wheel;
    M_MACRO_2_CODE = 444, 0 => 99, 0, "", Builder, "调用宏程序 2 的 M 代码 (0 无)", "M code that calls macro 2, 0 none", Wheel;
    M_MACRO_2_PROGRAM = 445, 1 => 9_999, 9_042, "", Builder, "M 代码 2 的宏程序号", "program of M macro 2", Wheel;
    M_MACRO_3_CODE = 446, 0 => 99, 0, "", Builder, "调用宏程序 3 的 M 代码 (0 无)", "M code that calls macro 3, 0 none", Wheel;
    M_MACRO_3_PROGRAM = 447, 1 => 9_999, 9_043, "", Builder, "M 代码 3 的宏程序号", "program of M macro 3", Wheel;
    M_MACRO_4_CODE = 448, 0 => 99, 0, "", Builder, "调用宏程序 4 的 M 代码 (0 无)", "M code that calls macro 4, 0 none", Wheel;
    M_MACRO_4_PROGRAM = 449, 1 => 9_999, 9_044, "", Builder, "M 代码 4 的宏程序号", "program of M macro 4", Wheel;
    M_MACRO_5_CODE = 450, 0 => 99, 0, "", Builder, "调用宏程序 5 的 M 代码 (0 无)", "M code that calls macro 5, 0 none", Wheel;
    M_MACRO_5_PROGRAM = 451, 1 => 9_999, 9_045, "", Builder, "M 代码 5 的宏程序号", "program of M macro 5", Wheel;
    M_MACRO_6_CODE = 452, 0 => 99, 0, "", Builder, "调用宏程序 6 的 M 代码 (0 无)", "M code that calls macro 6, 0 none", Wheel;
    M_MACRO_6_PROGRAM = 453, 1 => 9_999, 9_046, "", Builder, "M 代码 6 的宏程序号", "program of M macro 6", Wheel;
    M_MACRO_7_CODE = 454, 0 => 99, 0, "", Builder, "调用宏程序 7 的 M 代码 (0 无)", "M code that calls macro 7, 0 none", Wheel;
    M_MACRO_7_PROGRAM = 455, 1 => 9_999, 9_047, "", Builder, "M 代码 7 的宏程序号", "program of M macro 7", Wheel;
    M_MACRO_8_CODE = 456, 0 => 99, 0, "", Builder, "调用宏程序 8 的 M 代码 (0 无)", "M code that calls macro 8, 0 none", Wheel;
    M_MACRO_8_PROGRAM = 457, 1 => 9_999, 9_048, "", Builder, "M 代码 8 的宏程序号", "program of M macro 8", Wheel;
    M_MACRO_9_CODE = 458, 0 => 99, 0, "", Builder, "调用宏程序 9 的 M 代码 (0 无)", "M code that calls macro 9, 0 none", Wheel;
    M_MACRO_9_PROGRAM = 459, 1 => 9_999, 9_049, "", Builder, "M 代码 9 的宏程序号", "program of M macro 9", Wheel;
    GROUND_MATERIAL = 470, 1 => 5, 1, "", Operator, "工艺：材料 1 淬硬钢 2 软钢 3 不锈钢 4 高速钢 5 铸铁", "technology: material 1 hardened 2 soft 3 stainless 4 high-speed steel 5 cast iron", Headstock;
    GROUND_WIDTH = 471, 0.1 => 1_000, 18, "mm", Operator, "工艺：磨削宽度", "technology: ground width", Headstock;
    GROUND_ROUGHNESS = 472, 0.05 => 3.2, 0.4, "µm", Operator, "工艺：粗糙度 Ra", "technology: roughness Ra", Headstock;
    WHEEL_MOTOR_POWER = 473, 0.1 => 200, 7.5, "kW", Builder, "工艺：砂轮电机功率", "technology: power of the wheel motor", Headstock;
    CONTACT_TIME_CONSTANT = 474, 0.05 => 10, 0.8, "s", User, "工艺：磨削时间常数 (让刀)", "technology: time constant of the contact (deflection)", Headstock;
    PROGRAM_REPEATS = 390, 1 => 9_999, 1, "", User, "程序循环执行次数", "program repetitions per cycle start";
    SERIAL_BAUD = 370, 300 => 115_200, 9_600, "", User, "RS232 波特率 bit/s", "RS232 baud rate, bit/s";
    SERIAL_PAUSE_TIMEOUT = 371, 1 => 600, 10, "s", User, "RS232 传输中断等待时间", "RS232: pause that ends a transmission";
    SERIAL_START_TIMEOUT = 372, 1 => 3_600, 120, "s", User, "RS232 等待对方开始时间", "RS232: waiting time for the start";
    SERIAL_LEADER_LENGTH = 373, 0 => 500, 32, "", User, "RS232 引导空字符数", "RS232: NUL before and after programs";
    WHEEL_MIN_DIAMETER = 374, 0 => 2_000, 0, "mm", User, "砂轮最小直径 (0 不计还可修整次数)", "minimum wheel diameter, 0: remaining dressings not shown";
    TREND_SIZE_VARIABLE = 375, 0 => 999, 0, "", User, "趋势：存实测尺寸的变量 (0 仿真尺寸)", "trend: variable of the measured size, 0 simulated size";
    TREND_NOMINAL_VARIABLE = 376, 0 => 999, 0, "", User, "趋势：公称尺寸的变量 (0 无)", "trend: variable of the nominal size, 0 none";
    TREND_UPPER = 377, -10 => 10, 0, "mm", User, "趋势：上偏差", "trend: upper deviation";
    TREND_LOWER = 378, -10 => 10, 0, "mm", User, "趋势：下偏差", "trend: lower deviation";
    FIRST_SHIFT = 476, 0 => 23, 6, "h", User, "第一班开始的小时", "hour at which the first shift begins";
    SHIFTS = 477, 1 => 4, 3, "", User, "每天班数", "shifts of a day";
    MTCONNECT_PORT = 480, 0 => 65_535, 0, "", Builder, "网络：MTConnect 适配器端口 (0 关，通常 7878)", "network: port of the MTConnect adapter, 0 off, usually 7878";
    NETWORK_REACH = 481, 0 => 1, 0, "", Builder, "网络：MTConnect 范围 0 只限本机 1 全部网卡", "network: reach of MTConnect, 0 this computer, 1 all its networks";
    MACHINE_NUMBER = 482, 0 => 999_999, 0, "", Builder, "网络：机床编号", "network: number of the machine";
    WEB_PORT = 483, 0 => 65_535, 0, "", Builder, "网络：浏览器视图端口 (0 关，通常 8083)", "network: port of the view for browsers, 0 off, usually 8083";
    MQTT_ENABLED = 484, 0 => 1, 0, "", Builder, "网络：MQTT 0 关 1 连接 mqtt.ron 中的服务器", "network: MQTT, 0 off, 1 to the broker of mqtt.ron";
    SHOP_ORDERS = 485, 0 => 1, 0, "", Builder, "网络：车间订单 0 不接收 1 待操作者接受", "network: orders of the shop, 0 ignored, 1 proposed to the operator";
    SOUND = 487, 0 => 2, 0, "", User, "声音 0 关 1 报警、拒绝、工件完成 2 按键也响", "sounds: 0 off, 1 alarms, refusals, finished parts, 2 keys, too";
    WEB_REACH = 486, 0 => 1, 0, "", Builder, "网络：浏览器视图范围 0 只限本机 1 全部网卡 (TLS，密码)", "network: reach of the view for browsers, 0 this computer, 1 all (TLS, password)";
    MAX_STALL = 475, 100 => 10_000, 1_000, "ms", Builder, "控制停顿报警时间 (404)", "stall of the control that holds a program (404)";
    POWER_FAIL_RETRACT = 379, 0 => 50, 0, "mm", Builder, "供电中断时砂轮退回距离 (0 不退)", "wheel retract when the supply fails, 0 none", Wheel;
    PARTS_DONE = 70, 0 => 999_999, 0, "", Operator, "已加工件数", "parts done";
    PARTS_REQUIRED = 71, 0 => 999_999, 0, "", Operator, "需加工件数", "parts required";
    OSCILLATION_DWELL_FORWARD = 235, 0 => 10_000, 0, "x4ms", User, "振荡前进到位延时", "oscillation dwell forward";
    OSCILLATION_DWELL_BACKWARD = 236, 0 => 10_000, 0, "x4ms", User, "振荡后退到位延时", "oscillation dwell backward";
    OSCILLATION_SPEED = 237, 1 => 20_000, 3_000, "mm/min", User, "振荡最大速度", "maximum oscillation speed";
    OSCILLATION_AXIS = 238, 0 => 1, 0, "", User, "手动振荡轴 0:X 1:Z", "manual oscillation axis, 0 X, 1 Z";
    OSCILLATION_POSITION = 239, -9_999 => 9_999, 0, "mm", User, "手动振荡位置", "manual oscillation position";
    OSCILLATION_TIME_CONSTANT = 240, 1 => 5_000, 400, "ms", User, "振荡加减速时间常数", "oscillation time constant";
    OSCILLATION_FREQUENCY = 241, 1 => 1_000, 5, "1/min", User, "振荡频率", "oscillation frequency";
    WHEEL_ON_INFEED_SPEED = 242, 1 => 20_000, 500, "mm/min", User, "砂轮启动后负向限速", "speed limit in minus direction with the wheel on";
    DRESS_RETURN_SPEED = 243, 1 => 20_000, 1_000, "mm/min", User, "回修整点速度", "dressing-point return speed";
    HYDRAULIC_DELAY = 270, 0 => 60_000, 3_000, "ms", Builder, "液压检测延时", "hydraulic check delay";
    INPUTS_INVERTED_1 = 354, 0 => 65_535, 8, "", Builder, "输入口 1-16 反相", "inputs 1-16 inverted";
    INPUTS_INVERTED_2 = 355, 0 => 65_535, 49_152, "", Builder, "输入口 17-32 反相", "inputs 17-32 inverted";
    INPUTS_INVERTED_3 = 356, 0 => 65_535, 127, "", Builder, "输入口 33-48 反相", "inputs 33-48 inverted";
    INPUTS_INVERTED_4 = 357, 0 => 65_535, 0, "", Builder, "输入口 49-64 反相", "inputs 49-64 inverted";
}

/// G codes that call a macro, each with its program.
pub const G_MACROS: [(NumberParam, NumberParam); 10] = [
    (G_MACRO_0_CODE, G_MACRO_0_PROGRAM),
    (G_MACRO_1_CODE, G_MACRO_1_PROGRAM),
    (G_MACRO_2_CODE, G_MACRO_2_PROGRAM),
    (G_MACRO_3_CODE, G_MACRO_3_PROGRAM),
    (G_MACRO_4_CODE, G_MACRO_4_PROGRAM),
    (G_MACRO_5_CODE, G_MACRO_5_PROGRAM),
    (G_MACRO_6_CODE, G_MACRO_6_PROGRAM),
    (G_MACRO_7_CODE, G_MACRO_7_PROGRAM),
    (G_MACRO_8_CODE, G_MACRO_8_PROGRAM),
    (G_MACRO_9_CODE, G_MACRO_9_PROGRAM),
];

/// M codes that call a macro, each with its program.
pub const M_MACROS: [(NumberParam, NumberParam); 10] = [
    (M_MACRO_0_CODE, M_MACRO_0_PROGRAM),
    (M_MACRO_1_CODE, M_MACRO_1_PROGRAM),
    (M_MACRO_2_CODE, M_MACRO_2_PROGRAM),
    (M_MACRO_3_CODE, M_MACRO_3_PROGRAM),
    (M_MACRO_4_CODE, M_MACRO_4_PROGRAM),
    (M_MACRO_5_CODE, M_MACRO_5_PROGRAM),
    (M_MACRO_6_CODE, M_MACRO_6_PROGRAM),
    (M_MACRO_7_CODE, M_MACRO_7_PROGRAM),
    (M_MACRO_8_CODE, M_MACRO_8_PROGRAM),
    (M_MACRO_9_CODE, M_MACRO_9_PROGRAM),
];

/// Factory port of an input (spec K3).
pub(super) const fn factory_input_port(input: Input) -> u8 {
    let number = input.port_param();
    match number {
        228 => 1,
        229 => 2,
        269 => 3,
        279..=288 => (number - 279) as u8 + 13,
        320..=328 => (number - 320) as u8 + 4,
        329..=331 => (number - 329) as u8 + 23,
        341..=349 => (number - 341) as u8 + 31,
        358 => 40,
        365..=368 => (number - 365) as u8 + 26,
        _ => 0,
    }
}

/// Factory port of an output (spec K3).
pub(super) const fn factory_output_port(output: Output) -> u8 {
    match output.port_param() {
        number @ 300..=307 => (number - 300) as u8 + 1,
        226 => 11,
        227 => 12,
        273 => 10,
        271 => 13,
        272 => 14,
        154 => 15,
        153 => 16,
        number @ 308..=311 => (number - 308) as u8 + 17,
        number @ 274..=278 => (number - 274) as u8 + 21,
        number @ 312..=314 => (number - 312) as u8 + 26,
        number @ 360..=364 => (number - 360) as u8 + 29,
        _ => 0,
    }
}
