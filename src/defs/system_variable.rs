//! The table of system variables that a program can read or write.
//! Numbers follow FANUC; #434–#439 are defined by the customer, #5801–#5828 by this control.
//! Source: spec B3, K4.3, K4.5; docs/decisions.md "Grinding functions".

use super::text::Text;

/// A range of system variables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SystemVariableRange {
    /// The first number.
    pub first: u32,
    /// Number of variables.
    pub count: u32,
    /// Access rights of a program.
    pub access: VariableAccess,
    /// Meaning.
    pub name: Text,
}

/// Access rights of a program to a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VariableAccess {
    /// Read only.
    Read,
    /// Read and write.
    ReadWrite,
    /// Write only; the assignment is a command.
    Write,
}

impl SystemVariableRange {
    /// Index of a variable number in the range, from 0.
    #[must_use]
    pub const fn index(&self, number: u32) -> Option<usize> {
        if number >= self.first && number - self.first < self.count {
            return Some((number - self.first) as usize);
        }
        None
    }
}

macro_rules! ranges {
    ($($name:ident = $first:literal, $count:literal, $access:ident, $zh:literal, $en:literal;)*) => {
        $(#[doc = $en] pub const $name: SystemVariableRange = SystemVariableRange {
            first: $first, count: $count, access: VariableAccess::$access, name: Text::new($zh, $en),
        };)*
        /// Every range, by number.
        pub const SYSTEM_VARIABLES: &[SystemVariableRange] = &[$($name,)*];
    };
}

ranges! {
    GAUGE_POSITIONS = 434, 4, Read, "G78：X、快速 Z、慢速 Z、两者之差", "G78: X, fast Z, fine Z, their difference";
    OSCILLATION = 438, 2, Read, "振荡：前进到位、后退到位", "oscillation: forward end, backward end";
    INPUTS = 1_000, 64, Read, "输入口 1-64，有效为 1", "inputs by port, 1 = active";
    OUTPUTS = 1_100, 64, ReadWrite, "输出口 1-64；赋值同 M21/M22", "outputs by port; writing acts as M21, M22";
    WEAR_X = 2_001, 16, ReadWrite, "X 磨耗 1-16", "wear of X, 1 to 16";
    WEAR_Z = 2_101, 16, ReadWrite, "Z 磨耗 1-16", "wear of Z, 1 to 16";
    CUTTER_TIP = 2_301, 16, ReadWrite, "刀尖方向 T 1-16 (0-9)", "place of the programmed point T, 1 to 16 (0 to 9)";
    WEAR_Y = 2_401, 16, ReadWrite, "Y 磨耗 1-16", "wear of Y, 1 to 16";
    GEOMETRY_Y = 2_451, 16, ReadWrite, "Y 几何 1-16", "geometry of Y, 1 to 16";
    GEOMETRY_X = 2_701, 16, ReadWrite, "X 几何 1-16", "geometry of X, 1 to 16";
    GEOMETRY_Z = 2_801, 16, ReadWrite, "Z 几何 1-16", "geometry of Z, 1 to 16";
    CUTTER_RADIUS = 2_901, 16, ReadWrite, "半径 R 1-16", "radius R, 1 to 16";
    ALARM = 3_000, 1, Write, "报警 3000+数值 (注释为文字)", "alarm 3000 + value, text in the comment";
    MILLISECONDS = 3_001, 1, ReadWrite, "计时 ms，通电为 0", "timer, ms, 0 at power-on";
    HOURS = 3_002, 1, ReadWrite, "计时 h，通电为 0", "timer, hours, 0 at power-on";
    SINGLE_BLOCK_CONTROL = 3_003, 1, ReadWrite, "单段控制，程序结束后为 0：1 单段不停 (M 代码总是等待完成)", "single block control, 0 after the program: 1 does not stop in single block; M codes are always waited for";
    HOLD_CONTROL = 3_004, 1, ReadWrite, "进给保持控制 0-7：只读写，进给保持、倍率、准停始终有效", "feed hold control, 0 to 7: stored only; feed hold, override and exact stop always act";
    MESSAGE = 3_006, 1, Write, "信息并停止 (注释为文字)", "stop with a message, text in the comment";
    DATE = 3_011, 1, Read, "日期 YYYYMMDD", "date, YYYYMMDD";
    TIME_OF_DAY = 3_012, 1, Read, "时间 HHMMSS", "time of day, HHMMSS";
    CONSTANTS = 3_100, 3, Read, "常数：#3100 空，#3101 π，#3102 e", "constants: #3100 null, #3101 π, #3102 e";
    PARTS_DONE = 3_901, 1, ReadWrite, "已加工件数", "parts done";
    PARTS_REQUIRED = 3_902, 1, ReadWrite, "需加工件数", "parts required";
    MODALS = 4_001, 130, Read, "模态：#4001-#4007 #4010（GS GA #4009）#4012 #4014-#4016 G 代码组，#4109 F #4113 M #4114 N #4115 O #4119 S #4120 T", "modal: #4001-#4007 #4010 (GS, GA #4009) #4012 #4014-#4016 G groups, #4109 F, #4113 M, #4114 N, #4115 O, #4119 S, #4120 T";
    BLOCK_END = 5_001, 3, Read, "段终点 (工件坐标)", "end point of the block, work coordinates";
    MACHINE_POSITION = 5_021, 3, Read, "机床坐标", "machine position";
    WORK_POSITION = 5_041, 3, Read, "工件坐标", "work position";
    SKIP_POSITION = 5_061, 3, Read, "G31 锁存位置", "position latched by G31";
    EXTERNAL_ORIGIN = 5_201, 3, ReadWrite, "外部工件原点偏移", "external work offset";
    ORIGINS = 5_221, 103, ReadWrite, "工件原点 G54–G59：#5221 #5241 … #5321 起各轴", "work offsets G54 to G59: the axes from #5221, #5241 … #5321";
    WHEEL_DIAMETER = 5_801, 1, ReadWrite, "砂轮直径 mm (P77)；赋值表示已修整", "wheel diameter (P77); writing it reports a dressing";
    WHEEL_WIDTH = 5_802, 1, Read, "砂轮宽度 mm (P78)", "wheel width (P78)";
    PARTS_SINCE_DRESSING = 5_803, 1, Read, "修整后件数 (P96)", "parts since the last dressing (P96)";
    DRESSING_INTERVAL = 5_804, 1, Read, "修整间隔件数 (P95)", "dressing interval in parts (P95)";
    DRESSING_COUNT = 5_805, 1, Read, "换砂轮后修整次数 (P97)", "dressings since the wheel was changed (P97)";
    DRESSER_SIDE = 5_806, 1, Read, "修整器位置 (P98)：-1 工件侧，0 修整点不变，1 对侧", "dresser (P98): -1 part side, 0 point fixed, 1 opposite side";
    X_SCALE = 5_807, 1, Read, "X 每毫米的数值：2 直径编程，1 半径编程 (P6.0)", "X values of a millimetre: 2 diameters, 1 radii (P6.0)";
    DRESSING_POINT = 5_811, 3, Read, "修整点 X Y Z (机床坐标)，没有设置为空", "dressing point X, Y, Z, machine position; null where none is set";
    GAUGE_SIGNALS = 5_821, 6, Read, "量仪信号 1-6 (P323–P328)，有效为 1", "gauge signals 1 to 6 (P323 to P328), 1 = active";
    CONTACT_SEEN = 5_827, 1, ReadWrite, "砂轮接触 (P358)：写 0 以后碰到过为 1；没有输入口为空", "wheel contact (P358): 1 if it has touched since 0 was written; null without a port";
    PHASE = 5_828, 1, Write, "磨削阶段，只显示和计时：0 无 1 修整 2 测量 3 快进 4 空磨 5 粗磨 6 精磨 7 光磨 8 退刀", "phase of the cycle, shown and timed only: 0 none, 1 dressing, 2 measuring, 3 approach, 4 air, 5 roughing, 6 finishing, 7 spark-out, 8 retract";
    EXTRA_ORIGINS = 7_001, 943, ReadWrite, "附加工件原点 G54.1 P1–P48：#7001 #7021 … #7941 起各轴", "work offsets G54.1 P1 to P48: the axes from #7001, #7021 … #7941";
}

/// Distance of the numbers of consecutive work offsets.
pub const ORIGIN_STEP: u32 = 20;

/// Whether a variable is an origin of the work coordinates; after G20 it reads and is written in inches, as positions are.
#[must_use]
pub fn is_origin(number: u32) -> bool {
    [EXTERNAL_ORIGIN, ORIGINS, EXTRA_ORIGINS].iter().any(|range| range.index(number).is_some())
}

/// Whether a variable is a position or a distance; programs read it in the active unit (mm or inch).
#[must_use]
pub fn is_position(number: u32) -> bool {
    [GAUGE_POSITIONS, BLOCK_END, MACHINE_POSITION, WORK_POSITION, SKIP_POSITION, DRESSING_POINT]
        .iter()
        .any(|range| range.index(number).is_some())
}

/// Whether writing a variable only changes the display: moves and reading ahead go on.
#[must_use]
pub fn is_display_only(number: u32) -> bool {
    number == PHASE.first
}

/// The range of a variable number.
#[must_use]
pub fn find(number: u32) -> Option<&'static SystemVariableRange> {
    SYSTEM_VARIABLES.iter().find(|range| range.index(number).is_some())
}
