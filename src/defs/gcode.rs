//! The table of G functions: group of each code, and on which G-code system it exists.
//! Source: spec B2, K1, K4.

use super::text::Text;

/// Codes of one group exclude each other in a block. All groups but `Once` and `Call` are modal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GCodeGroup {
    /// 00: non-modal, active in its own block only.
    NonModal,
    /// 01: motion and cycles.
    Motion,
    /// 02 (lathe): constant surface speed or constant spindle speed.
    SpindleSpeedMode,
    /// 03 (mill): absolute or incremental.
    DistanceMode,
    /// 05: feed per minute or per revolution.
    FeedMode,
    /// 06: inch or millimetre.
    Units,
    /// 07: wheel radius compensation.
    Compensation,
    /// 09 (lathe: 10): drilling cycles. The control has none, so only their end.
    DrillingCycle,
    /// 08: tool length compensation. The control has none, so only its end.
    LengthCompensation,
    /// 16 (lathe: 04, 20): rotation of coordinates. The control has none, so only its end.
    Rotation,
    /// 12: modal macro call.
    ModalCall,
    /// 14: work offset.
    WorkOffset,
    /// When an exact stop counts as reached (SINUMERIK G601, G602): one way here.
    ExactStopWindow,
    /// 15: exact stop or continuous path.
    PathMode,
    /// 16: arc plane.
    Plane,
}

/// Whether a G-code system has a code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Availability {
    /// Available.
    Yes,
    /// It needs an encoder of the spindle, which the headstock has not: refused by name, never ignored.
    NoEncoder,
    /// Does not exist on this kind of machine.
    No,
}

/// One row of the G code table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GCode {
    /// The number after G.
    pub code: u8,
    /// Stable name, English, with hyphens.
    pub id: &'static str,
    /// Its group in lathe system A.
    pub group: GCodeGroup,
    /// Availability in lathe system A (GC).
    pub lathe: Availability,
    /// Availability in the milling system (GS, GA).
    pub mill: Availability,
    /// What it does.
    pub text: Text,
    /// Syntax, effect and alarms.
    pub help: Text,
}

macro_rules! g_codes {
    ($($code:literal $id:literal $group:ident $lathe:ident $mill:ident $zh:literal $en:literal
        $help_zh:literal $help_en:literal;)*) => {
        /// Every G code of the control, by number.
        pub const G_CODES: &[GCode] = &[$(GCode {
            code: $code,
            id: $id,
            group: GCodeGroup::$group,
            lathe: Availability::$lathe,
            mill: Availability::$mill,
            text: Text { zh: $zh, en: $en },
            help: Text { zh: $help_zh, en: $help_en },
        }),*];
    };
}

g_codes! {
    0 "rapid" Motion Yes Yes "快速定位" "rapid traverse"
        "G00 X_ Z_：各轴以快速到位，不切削；快速倍率有效，终点准停。" "G00 X_ Z_: the named axes move at rapid speed, without cutting; the rapid override acts, with exact stop at the end.";
    1 "feed" Motion Yes Yes "直线插补" "linear interpolation"
        "G01 X_ Z_ F_：按进给速度 F 走直线；F 保持到下一个 F，进给倍率有效。" "G01 X_ Z_ F_: a straight line at feed F; F stays in force, the feed override acts.";
    2 "arc-clockwise" Motion Yes Yes "顺时针圆弧" "arc clockwise"
        "G02 X_ Z_ R_（或 I_ K_）F_：顺时针圆弧（Z 向右、X 向上看）。I 为半径值；R 为负走大圆弧，整圆用 I K。" "G02 X_ Z_ R_ (or I_ K_) F_: arc clockwise, seen with Z to the right and X up. I is a radius; R negative is the major arc; a full circle needs I, K.";
    3 "arc-counter-clockwise" Motion Yes Yes "逆时针圆弧" "arc counter-clockwise"
        "G03 X_ Z_ R_（或 I_ K_）F_：逆时针圆弧，写法同 G02。" "G03 X_ Z_ R_ (or I_ K_) F_: arc counter-clockwise, same format as G02.";
    4 "dwell" NonModal Yes Yes "暂停" "dwell"
        "G04 P_（毫秒）或 G04 X_（秒）：暂停；进给保持时剩余时间停住。" "G04 P_ (milliseconds) or G04 X_ (seconds): dwell; a feed hold stops the remaining time.";
    9 "exact-stop-block" NonModal Yes Yes "本段准停" "exact stop in this block"
        "G09 G01 X_ Z_ F_：本段终点准停；以后的段按 G61/G64。" "G09 G01 X_ Z_ F_: exact stop at the end of this block; the following blocks go by G61 or G64.";
    10 "wear-add" NonModal Yes Yes "修改刀补、工件坐标系" "set offsets"
        "G10 D_ U_ W_：把 U、W（平磨 V）加到刀补 D（1–16）的磨耗上，立即生效；D 不在 1–16 报警。G10 L2 P0–P6 X_ Z_：外部偏移、G54–G59；G10 L20 P1–P48：G54.1；G10 P1–P16：刀补磨耗，P10001–P10016：几何，R 半径 Q 刀尖方向；U V W 为增加。" "G10 D_ U_ W_: adds U, W (GS: V) to the wear of offset D (1 to 16), effective at once; another D is an alarm. G10 L2 P0 to P6 X_ Z_: external offset, G54 to G59; G10 L20 P1 to P48: G54.1; G10 P1 to P16: wear, P10001 to P10016: geometry of a tool offset, R radius, Q tip; U V W add.";
    17 "plane-xy" Plane No Yes "XY 平面" "XY plane"
        "G17：圆弧在 XY 平面。" "G17: arcs are in the XY plane.";
    18 "plane-zx" Plane Yes Yes "ZX 平面" "ZX plane"
        "G18：圆弧在 ZX 平面。" "G18: arcs are in the ZX plane.";
    19 "plane-yz" Plane No Yes "YZ 平面" "YZ plane"
        "G19：圆弧在 YZ 平面。" "G19: arcs are in the YZ plane.";
    20 "inch" Units Yes Yes "英制" "inch"
        "G20：以后的尺寸和速度按英寸读。" "G20: the following lengths and feeds are in inches.";
    21 "millimetre" Units Yes Yes "公制" "millimetre"
        "G21：以后的尺寸和速度按毫米读。" "G21: the following lengths and feeds are in millimetres.";
    27 "dressing-point" NonModal Yes Yes "回砂轮修整点" "return to the dressing point"
        "G27 X Z F_：写出的轴（不带数值）回修整点，不写轴为 X；F 缺省为 P243。没有设修整点时报警 196，轴未回零时报警 100。" "G27 X Z F_: the axes named (without numbers) move to their dressing points, X if none is named; without F, P243. Alarm 196 without a dressing point, 100 if an axis is not homed.";
    28 "reference" NonModal Yes Yes "回机械零点" "return to the machine zero"
        "G28 X_ Z_：经过给定的中间点快速回机械零点（P45–P47）。" "G28 X_ Z_: through the given point to the machine zero (P45 to P47) at rapid speed.";
    30 "other-reference" NonModal Yes Yes "回第 2–4 参考点" "return to reference point 2, 3 or 4"
        "G30 P2–P4 X_ Z_：经过中间点回第 2–4 参考点（P161–P169）。" "G30 P2 to P4 X_ Z_: through the given point to reference point 2, 3 or 4 (P161 to P169).";
    31 "skip" NonModal Yes Yes "跳转插补" "skip: feed until a signal"
        "G31 Z_ P_ F_：按 F 走到信号 P（量仪 1–6，砂轮接触 9）为止，位置存入 #5061…；没有信号时停在终点。" "G31 Z_ P_ F_: at feed F until signal P (gauge 1 to 6, wheel contact 9); the position is stored in #5061 …; without a signal it stops at the end point.";
    32 "thread" Motion NoEncoder No "螺纹切削" "thread"
        "螺纹切削，需要主轴编码器，本机没有：程序在该段前停止并说明。" "Thread cutting: it needs a spindle encoder, which this machine has not; the program stops before the block with a message.";
    33 "tapping" Motion NoEncoder No "攻丝" "tapping with Z"
        "攻丝，需要主轴编码器，本机没有：程序在该段前停止并说明。" "Tapping: it needs a spindle encoder, which this machine has not; the program stops before the block with a message.";
    34 "variable-thread" Motion NoEncoder No "变螺距螺纹" "thread of variable lead"
        "变螺距螺纹，需要主轴编码器，本机没有：程序在该段前停止并说明。" "A thread of variable lead: it needs a spindle encoder, which this machine has not; the program stops before the block with a message.";
    35 "oscillation-on" NonModal Yes Yes "振荡开启" "oscillation on"
        "G35 X_ 或 Z_ D_ Q_：该轴在当前位置与给定位置之间振荡，程序继续；Q 每分钟往复次数，D 加速时间常数 ms。缺省为 P241、P240。用 G36、振荡键、复位或急停结束。" "G35 X_ or Z_ D_ Q_: the axis oscillates between the current and the given position while the program continues; Q strokes per minute, D time constant in ms (default P241, P240). G36, the key, RESET or the emergency stop ends it.";
    36 "oscillation-off" NonModal Yes Yes "振荡关闭" "oscillation off"
        "G36：振荡回到起始端停止，然后执行下一段。" "G36: the oscillation stops at the position where it started, then the next block runs.";
    40 "compensation-off" Compensation Yes Yes "取消半径补偿" "wheel radius compensation off"
        "G40：取消半径补偿；其后第一个 G00/G01 从轮廓退到编程点。" "G40: radius compensation off; the first G00 or G01 after it leads from the contour to the programmed point.";
    41 "compensation-left" Compensation Yes Yes "左侧半径补偿" "wheel radius compensation left"
        "G41 G01 X_ Z_（D_）：砂轮（修整器）在轮廓左侧（沿运动方向看），中心与轮廓保持半径 R；第一段 G00/G01 接近，G40 离开。R、刀尖方向取自刀补（D 或 P416）；切不进的轮廓报警 504–506，轮廓开始前预读 100 段。" "G41 G01 X_ Z_ (D_): the wheel or dresser runs on the left of the contour, seen in the direction of travel, its centre at the distance R. The first G00 or G01 leads to the contour, G40 leads away. R and tip are those of the offset (D, or P416). A contour that it does not fit into is alarm 504 to 506; 100 segments are read ahead.";
    42 "compensation-right" Compensation Yes Yes "右侧半径补偿" "wheel radius compensation right"
        "G42 G01 X_ Z_（D_）：同 G41，在轮廓右侧。" "G42 G01 X_ Z_ (D_): as G41, on the right of the contour.";
    49 "length-compensation-off" LengthCompensation Yes Yes "取消刀具长度补偿" "tool length compensation off"
        "G49：取消刀具长度补偿。本机没有，可以写，无作用（程序开头的 G40 G49 G80）。" "G49: ends tool length compensation. There is none here; accepted without effect, as in the safety line G40 G49 G80 at the start of programs.";
    50 "preset" NonModal Yes Yes "设定坐标系" "set work coordinates"
        "G50 X_ Z_：把当前位置称为 X Z，不移动；清除当前刀补的磨耗。程序中用了几把刀时报警。" "G50 X_ Z_: sets the coordinates of the current position to X Z without moving; clears the wear of the active tool offset. An alarm if the program uses several tools.";
    52 "local-zero" NonModal Yes Yes "局部坐标系" "local zero"
        "G52 X_ Z_：在当前工件坐标系中设定局部零点，对所有工件坐标系有效；G52 X0 Z0 取消，程序开始时没有。" "G52 X_ Z_: sets a local zero in the active work offset, in force in all of them; G52 X0 Z0 ends it, a program starts without.";
    53 "machine-move" NonModal Yes Yes "机床坐标定位" "machine coordinates"
        "G53 X_ Z_：本段坐标为机床坐标。" "G53 X_ Z_: the coordinates of this block are machine coordinates.";
    54 "frame-1" WorkOffset Yes Yes "工件坐标系 1" "work offset 1"
        "G54：工件坐标系 1，从本段起有效；程序开始时为 G54。G54.1 P1–P48（或 G54 P_）：附加工件坐标系。" "G54: work offset 1, from this block on; a program starts with G54. G54.1 P1 to P48 (or G54 P_): additional work offsets.";
    55 "frame-2" WorkOffset Yes Yes "工件坐标系 2" "work offset 2"
        "G55：工件坐标系 2，从本段起有效；程序开始时为 G54。" "G55: work offset 2, from this block on; a program starts with G54.";
    56 "frame-3" WorkOffset Yes Yes "工件坐标系 3" "work offset 3"
        "G56：工件坐标系 3，从本段起有效；程序开始时为 G54。" "G56: work offset 3, from this block on; a program starts with G54.";
    57 "frame-4" WorkOffset Yes Yes "工件坐标系 4" "work offset 4"
        "G57：工件坐标系 4，从本段起有效；程序开始时为 G54。" "G57: work offset 4, from this block on; a program starts with G54.";
    58 "frame-5" WorkOffset Yes Yes "工件坐标系 5" "work offset 5"
        "G58：工件坐标系 5，从本段起有效；程序开始时为 G54。" "G58: work offset 5, from this block on; a program starts with G54.";
    59 "frame-6" WorkOffset Yes Yes "工件坐标系 6" "work offset 6"
        "G59：工件坐标系 6，从本段起有效；程序开始时为 G54。" "G59: work offset 6, from this block on; a program starts with G54.";
    61 "exact-stop" PathMode Yes Yes "准停方式" "exact stop"
        "G61：每段终点准停。" "G61: exact stop at the end of every block.";
    64 "continuous" PathMode Yes Yes "连续方式" "continuous path"
        "G64：连续方式，拐角在公差内圆滑过渡；开机状态。" "G64: continuous path, corners are rounded within the tolerance; active at power-on.";
    65 "macro-call" NonModal Yes Yes "宏程序调用" "macro call"
        "G65 P_ L_ 参数…：调用宏程序 P，字母参数成为局部变量；G65 Hm 为运算和跳转。" "G65 P_ L_ arguments …: calls macro P, the argument letters become local variables; G65 Hm calculates and jumps.";
    66 "modal-call" ModalCall Yes Yes "宏程序模态调用" "modal macro call"
        "G66 P_ …：以后每个移动段之后调用宏程序 P，直到 G67。" "G66 P_ …: calls macro P after every following move, until G67.";
    67 "modal-call-off" ModalCall Yes Yes "取消模态调用" "modal macro call off"
        "G67：取消 G66。" "G67: ends G66.";
    69 "rotation-off" Rotation Yes Yes "取消坐标旋转" "rotation of coordinates off"
        "G69：取消坐标旋转。本机没有，可以写，无作用。" "G69: ends a rotation of coordinates. There is none here; accepted without effect.";
    70 "finishing" NonModal Yes No "精加工循环" "finishing cycle"
        "G70 P_ Q_：按程序段 P 到 Q 的轮廓精加工。" "G70 P_ Q_: finishing pass along the contour of blocks P to Q.";
    71 "rough-turning" NonModal Yes No "轴向粗车循环" "roughing along Z"
        "G71 U_ R_，G71 P_ Q_ U_ W_ F_：按轮廓沿 Z 分层切削，留余量 U W；轮廓首段写 X 和 Z（如 X40 W0）时可以有凹槽。" "G71 U_ R_, then G71 P_ Q_ U_ W_ F_: cuts the contour in layers along Z, leaving U and W for finishing; it may have pockets if its first block names X and Z (X40 W0).";
    72 "rough-facing" NonModal Yes No "径向粗车循环" "roughing along X"
        "G72 W_ R_，G72 P_ Q_ U_ W_ F_：按轮廓沿 X 分层切削，留余量 U W；轮廓首段写 X 和 Z 时可以有凹槽。" "G72 W_ R_, then G72 P_ Q_ U_ W_ F_: cuts the contour in layers along X, leaving U and W for finishing; it may have pockets if its first block names X and Z.";
    73 "rough-contour" NonModal Yes No "封闭切削循环" "roughing along the contour"
        "G73 U_ W_ R_，G73 P_ Q_ U_ W_ F_：平行于轮廓分 R 次切削。" "G73 U_ W_ R_, then G73 P_ Q_ U_ W_ F_: R strokes parallel to the contour.";
    74 "face-grooving" NonModal Yes No "轴向切槽循环" "grooving along Z"
        "G74 R_，G74 X_ Z_ P_ Q_ F_：沿 Z 断续进给，每次 Q，退 R。" "G74 R_, then G74 X_ Z_ P_ Q_ F_: feeds along Z in steps of Q, with retract R after each.";
    75 "grooving" NonModal Yes No "径向切槽循环" "grooving along X"
        "G75 R_，G75 X_ Z_ P_ Q_ F_：沿 X 断续进给，每次 P，退 R。" "G75 R_, then G75 X_ Z_ P_ Q_ F_: feeds along X in steps of P, with retract R after each.";
    76 "threading-cycle" NonModal NoEncoder No "复合螺纹循环" "threading cycle"
        "复合螺纹循环，需要主轴编码器，本机没有。" "Threading cycle: it needs a spindle encoder, which this machine has not.";
    78 "gauge-positioning" NonModal Yes Yes "量仪对刀" "gauge positioning"
        "G78 Z_ F_ J_ P_ Q_ L_：以 F 接近到信号 P，退 L，再以 J 接近并记录；#434 = X，#435 快速、#436 精确 Z，#437 为差。写 Q 时以 J 走到第二信号，速度降到 J 以前 Q 有效报警 205。到终点无信号报警 183。" "G78 Z_ F_ J_ P_ Q_ L_: approaches at F until signal P, retracts by L, approaches again at J and stores the positions: #434 X, #435 fast Z, #436 fine Z, #437 their difference. With Q it continues at J to the second signal; Q before speed J: alarm 205. No signal: alarm 183.";
    80 "drilling-cycle-off" DrillingCycle Yes Yes "取消钻孔循环" "drilling cycle off"
        "G80：取消钻孔循环。本机没有钻孔循环，可以写，无作用（程序开头的 G40 G80）。" "G80: ends a drilling cycle. There are none here; accepted without effect, as in the safety line G40 G80 at the start of programs.";
    90 "longitudinal-cycle" Motion Yes Yes "轴向切削循环（平磨、圆台磨：绝对编程）" "longitudinal cycle (GS, GA: absolute)"
        "外圆磨：G90 X_ Z_ F_ 轴向切削循环；与 G00–G03 同段时为绝对编程。平磨、圆台磨：以后的坐标为绝对值。" "GC: G90 X_ Z_ F_ is one longitudinal cycle; in a block with G00 to G03 it means absolute. GS, GA: the following coordinates are absolute.";
    91 "incremental" DistanceMode No Yes "增量编程" "incremental"
        "G91：以后的坐标为增量值。外圆磨用 U V W。" "G91: the following coordinates are incremental. On GC use U, V, W.";
    92 "thread-cycle" Motion NoEncoder Yes "螺纹切削循环（平磨、圆台磨：设定坐标系）" "thread cycle (GS, GA: set work coordinates)"
        "外圆磨：螺纹切削循环，需要主轴编码器，本机没有。平磨、圆台磨：与 G50 相同，把当前位置称为 X Y Z。" "GC: thread cycle: it needs a spindle encoder, which this machine has not. GS, GA: as G50, sets the coordinates of the current position to X Y Z.";
    94 "face-cycle" Motion Yes Yes "径向切削循环（平磨、圆台磨：每分进给）" "face cycle (GS, GA: feed per minute)"
        "外圆磨：G94 X_ Z_ F_ 径向切削循环。平磨、圆台磨：F 为每分钟毫米。" "GC: G94 X_ Z_ F_ is one facing cycle. GS, GA: F is in mm/min.";
    95 "feed-per-revolution-mill" FeedMode No Yes "每转进给" "feed per revolution"
        "G95：F 为每转毫米；必须重新给 F。" "G95: F is in mm/rev; a new F is required.";
    96 "surface-speed" SpindleSpeedMode Yes Yes "恒线速" "constant surface speed"
        "G96 S_：恒线速，S 为砂轮圆周 m/min，随砂轮直径变化。" "G96 S_: constant surface speed, S is the surface speed of the wheel in m/min and follows its diameter.";
    97 "rotation-speed" SpindleSpeedMode Yes Yes "恒转速" "constant spindle speed"
        "G97 S_：恒转速，S 为转/分（P5.3=1 为 m/s）。" "G97 S_: constant spindle speed, S in rpm (m/s with P5.3=1).";
    98 "feed-per-minute" FeedMode Yes Yes "每分进给" "feed per minute"
        "G98：F 为每分钟毫米。" "G98: F is in mm/min.";
    99 "feed-per-revolution" FeedMode Yes Yes "每转进给" "feed per revolution"
        "G99：F 为每转毫米；必须重新给 F。" "G99: F is in mm/rev; a new F is required.";
}

const NONE: u8 = u8::MAX;

const ROW: [u8; 100] = {
    let mut rows = [NONE; 100];
    let mut row = 0;
    while row < G_CODES.len() {
        rows[G_CODES[row].code as usize] = row as u8;
        row += 1;
    }
    rows
};

impl GCode {
    /// The row of a code number; `None` if the control does not have it.
    #[must_use]
    #[inline]
    pub fn find(code: u32) -> Option<&'static Self> {
        let row = *ROW.get(code as usize)?;
        G_CODES.get(usize::from(row))
    }

    /// The group in one G-code system: on GS and GA `G90` selects absolute and `G94` feed per minute.
    #[must_use]
    #[inline]
    pub const fn group_on(&self, mill: bool) -> GCodeGroup {
        match (self.code, mill) {
            (90, true) => GCodeGroup::DistanceMode,
            (92, true) => GCodeGroup::NonModal,
            (94, true) => GCodeGroup::FeedMode,
            _ => self.group,
        }
    }

    /// Availability in one G-code system.
    #[must_use]
    #[inline]
    pub const fn availability_on(&self, mill: bool) -> Availability {
        if mill { self.mill } else { self.lathe }
    }
}
