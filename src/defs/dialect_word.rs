//! The words of the two dialects with their own G codes and statements, for help and manual.
//! Source: spec superman-lathe.md L2–L8, sinumerik-802d.md S1.

use super::text::Text;

/// One word of a dialect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DialectWord {
    /// As it is written: `G22`, `GOTOF`.
    pub word: &'static str,
    /// What it does.
    pub text: Text,
    /// Syntax, limits and alarms.
    pub help: Text,
}

macro_rules! words {
    ($table:ident: $($word:literal, $zh:literal, $en:literal, $help_zh:literal, $help_en:literal;)*) => {
        pub(super) const $table: &[DialectWord] = &[$(DialectWord {
            word: $word, text: Text::new($zh, $en), help: Text::new($help_zh, $help_en),
        },)*];
    };
}

words! {
    GRINDER:
    ",C", "倒角", "chamfer",
        "G01 X_ ,C2：与下一段直线之间倒角，离交点各 2 mm；后面三段之内要有平面内的移动。", "G01 X_ ,C2: a chamfer to the next line, 2 mm from the corner on both; a move in the plane must follow within three blocks.";
    ",R", "倒圆角", "rounding",
        "G01 X_ ,R2：与下一段直线或圆弧之间倒圆角，半径 2 mm，按本段的 F。", "G01 X_ ,R2: an arc of 2 mm tangent to the next line or arc, at the feed of its block.";
    ",A", "直线角度", "angle of a line",
        "G01 X_ ,A135：只写一个坐标，另一个由角度算出（从 Z+ 逆时针）；G01 ,A45 单独写时下一段给 X_ Z_ ,A_，算出交点。", "G01 X_ ,A135: one coordinate, the angle from Z+ counter-clockwise gives the other one; G01 ,A45 alone: the next block has X_ Z_ ,A_ and the lines meet.";
    "DPRNT", "打印一行", "prints a line",
        "DPRNT[SIZE*#510[33]]：一行文字加到 prints/DPRNT-日期.TXT；* 为空格，[33] 为小数点前后位数。POPEN、PCLOS 可写。BPRNT 没有。", "DPRNT[SIZE*#510[33]]: adds a line to prints/DPRNT-date.TXT; * is a blank, [33] are the places before and behind the point. POPEN and PCLOS may stand. There is no BPRNT.";
}

words! {
    SUPERMAN:
    "G00", "快速定位", "rapid traverse",
        "G00 X_ Z_：两轴先联动，再走余下的一轴。F 2000–6000 只在本段有效，不写按 P30、P32。", "G00 X_ Z_: both axes move together, then one axis the rest. F 2000 to 6000 for this block only; without F, P30 and P32.";
    "G01", "直线插补", "linear interpolation",
        "G01 X_ Z_ F_：X Z 绝对、U W 增量，可混用；F 6–2000，X 向最多为一半；不写 F 按 P380。", "G01 X_ Z_ F_: X, Z absolute, U, W incremental; F 6 to 2000, X at most half of it; P380 without F.";
    "G02", "顺圆弧（X 向上看）", "arc, clockwise with X up",
        "G02 X_ Z_ I_ K_ 或 R_：I 为直径，从起点量；R 为负取优弧，整圆只能用 I K；F 6–600。P5.4=0 反向。", "G02 X_ Z_ I_ K_ or R_: I is a diameter, from the start point; R negative is the major arc, a full circle needs I, K; F 6 to 600. P5.4=0 reverses the direction.";
    "G03", "逆圆弧（X 向上看）", "arc, counter-clockwise with X up",
        "写法同 G02，方向相反。", "Same format as G02, other direction.";
    "G04", "延时", "dwell",
        "G04 F_：秒，0.01–9999.99。", "G04 F_: seconds, 0.01 to 9999.99.";
    "G22", "循环开始", "loop",
        "G22 L####：以下到 G80 执行 L 次，可嵌套 255 层；L0000 跳过。写在段首。", "G22 L####: repeats the blocks up to G80 L times, 255 levels at most; L0000 skips them. Must be first in its block.";
    "G23", "矩形循环", "rectangle cycle",
        "G23 X_ Z_ F_：A→B X 快速，B→C Z，C→D X 按 F，D→A 快速；后续段只写对角点。边长为零报错。", "G23 X_ Z_ F_: X rapid, Z and X at F, return rapid; later blocks give only the corner. A side of zero is an error.";
    "G26", "回换刀点 X、Z", "return to tool-change point, X then Z",
        "以快速回换刀点（程序起点），先 X 后 Z。", "Rapid to the point where the program started, X before Z.";
    "G27", "X 回换刀点", "return X to tool-change point",
        "只有 X 轴快速回换刀点。", "Only X moves to the tool-change point.";
    "G29", "Z 回换刀点", "return Z to tool-change point",
        "只有 Z 轴快速回换刀点。", "Only Z moves to the tool-change point.";
    "G32", "英制螺纹", "inch thread",
        "G32 U_ W_ F_：F 为每英寸牙数，3–33.2，小数为分母：33.2 = 33 1/2。之前要有 X 向进给；主轴 ≤ 1200/导程-80。", "G32 U_ W_ F_: F is threads per inch, 3 to 33.2 (33.2 means 33 1/2). An X move must come before it; spindle at most 1200/lead - 80.";
    "G33", "公制螺纹", "metric thread",
        "G33 U_ W_ F_：F 为导程 0.25–12 mm；退尾 X 2·导程+2 mm 在 Z 最后 1.2 mm 内。主轴过快报警 211，不转报警 212。", "G33 U_ W_ F_: F is the lead, 0.25 to 12 mm; run-out 2·lead + 2 mm in X within the last 1.2 mm of Z. Spindle too fast: alarm 211, stopped: 212.";
    "G36", "回机械原点 X、Z", "machine origin, X then Z",
        "快速到开关，慢速通过，退开再慢速找到开关；坐标由参数设定。先 X 后 Z。", "Fast to the switch, slowly over it and back onto it; the coordinate is set by parameters. X before Z.";
    "G37", "X 回机械原点", "machine origin of X",
        "只有 X 轴，过程同 G36。", "X only, as G36.";
    "G39", "Z 回机械原点", "machine origin of Z",
        "只有 Z 轴，过程同 G36。", "Z only, as G36.";
    "G80", "循环结束", "end of a loop",
        "结束最近的 G22；写在段首，没有配对报错。", "Ends the last G22; must be first in its block; an error without G22.";
    "G92", "设定坐标", "set coordinates",
        "G92 X_ Z_：当前点的坐标，不移动；X、Z 都要写，不能写 U W。", "G92 X_ Z_: sets the coordinates of the current point without moving; both X and Z, not U, W.";
    "T", "换刀", "tool",
        "T2 换到 2 号刀位；T20 换刀并补偿，坐标不变。刀位信号 P388 内不到报警 210。", "T2 indexes to station 2; T20 with offset, the coordinates stay. No station switch within P388: alarm 210.";
}

words! {
    SINUMERIK:
    "R", "R 参数", "R parameters",
        "R0–R299，断电保持。R60=R60-R28，一段可写几个，从左到右。", "R0 to R299, retained at power-off. R60=R60-R28, several in a block, from left to right.";
    "=", "表达式", "expressions",
        "X=R20、F=R51、P=R32：除 N、G、L 外的地址都可以。+ - * / DIV MOD ( ) SIN COS TAN ASIN ACOS ATAN2 SQRT POT ABS TRUNC ROUND LN，角度为度。", "X=R20, F=R51, P=R32: any address except N, G, L. + - * / DIV MOD ( ) SIN COS TAN ASIN ACOS ATAN2 SQRT POT ABS TRUNC ROUND LN, angles in degrees.";
    "IF", "条件跳转", "conditional jump",
        "IF R60<R18 GOTOF AA1；比较 == <> > < >= <=。", "IF R60<R18 GOTOF AA1; comparisons: == <> > < >= <=.";
    "GOTOF", "向后跳转", "jump forward",
        "GOTOF AA1：跳到后面的标号 AA1:；GOTOF N100 跳到程序段 N100；没有则报错。",
            "GOTOF AA1: to the label AA1: further down, GOTOF N100: to block N100; one that is missing is an error.";
    "GOTOB", "向前跳转", "jump backward",
        "GOTOB AA1：跳到前面的标号 AA1:；GOTOB N100 跳到程序段 N100；没有则报错。",
            "GOTOB AA1: to the label AA1: further up, GOTOB N100: to block N100; one that is missing is an error.";
    "MSG", "信息", "message",
        "MSG(\"文字\") 显示到 MSG() 为止；引号也可用 “ ”，不成对报错。", "MSG(\"text\") is shown until MSG(); quotes “ ” are allowed too, unmatched ones are an error.";
    "L", "子程序", "subprogram",
        "L10 P3 或 L10 P=R32：执行 L10.SPF P 次，P=0 不执行。", "L10 P3 or L10 P=R32: runs L10.SPF P times, not at all with P=0.";
    "RET", "返回", "return",
        "RET、M17 或 M2 结束子程序。", "RET, M17 or M2 end a subprogram.";
    "M17", "子程序结束", "end of a subprogram",
        "同 RET。", "Same as RET.";
    "STOPRE", "停止预读", "stop reading ahead",
        "等运动结束后再读下一段。R 参数总是按已执行的显示。", "Waits for the motion before the next block is read. R parameters are always shown as executed.";
    "$AA_IW", "实际位置", "actual position",
        "R1=$AA_IW[X]：工件坐标；$AA_IM[X]：机床坐标；DIAMOF 时为半径。先等运动结束。", "R1=$AA_IW[X]: work coordinate; $AA_IM[X]: machine coordinate; a radius under DIAMOF. Waits for the motion to end.";
    "G0", "快速定位", "rapid traverse",
        "G0 X_ Z_：各轴以快速到位。", "G0 X_ Z_: the named axes move at rapid speed.";
    "G1", "直线插补", "linear interpolation",
        "G1 X_ Z_ F_：按进给速度走直线。", "G1 X_ Z_ F_: a straight line at feed F.";
    "CHR", "倒角（边长）", "chamfer by its legs",
        "G1 X_ CHR=2：与下一段直线之间倒角，离交点各 2 mm。", "G1 X_ CHR=2: a chamfer to the next line, 2 mm from the corner on both.";
    "CHF", "倒角（长度）", "chamfer by its length",
        "G1 X_ CHF=2：倒角本身长 2 mm。", "G1 X_ CHF=2: the chamfer itself is 2 mm long.";
    "RND", "倒圆角", "rounding",
        "G1 X_ RND=2：与下一段直线或圆弧之间倒圆角；RND=0 本段没有。", "G1 X_ RND=2: an arc of 2 mm tangent to the next line or arc; RND=0: none in this block.";
    "RNDM", "模态倒圆角", "modal rounding",
        "RNDM=1：以后每个拐角倒圆角，放不下的地方没有；RNDM=0 取消。", "RNDM=1: every following corner is rounded where it fits, until RNDM=0.";
    "ANG", "直线角度", "angle of a line",
        "G1 X_ ANG=135：另一个坐标由角度算出；ANG 单独写时下一段给 X_ Z_ ANG=_。", "G1 X_ ANG=135: the angle gives the other coordinate; with ANG alone the next block has X_ Z_ ANG=_.";
    "G2", "顺时针圆弧", "arc clockwise",
        "G2 X_ Z_ CR=_ 或 I_ K_：I 为半径；CR 小于 0 为大圆弧。", "G2 X_ Z_ CR=_ or I_ K_: I is a radius; CR negative is the major arc.";
    "G3", "逆时针圆弧", "arc counter-clockwise",
        "写法同 G2。", "Same format as G2.";
    "G4", "暂停", "dwell",
        "G4 F_：秒；G4 S_：砂轮转数。", "G4 F_: seconds; G4 S_: revolutions of the wheel.";
    "G9", "本段准停", "exact stop in this block", "本段终点准停。", "Exact stop at the end of this block.";
    "G18", "ZX 平面", "ZX plane",
        "圆弧在 ZX 平面。", "Arcs are in the ZX plane.";
    "G40", "取消半径补偿", "radius compensation off", "其后第一个 G0/G1 从轮廓退到编程点。", "The first G0 or G1 after it leads from the contour to the programmed point.";
    "G41", "左侧半径补偿", "radius compensation left", "圆心在轮廓左侧保持半径 R（刀补 D）；NORM、KONT 可写，接近总是垂直于轮廓。", "The centre runs on the left of the contour at the radius R of offset D; NORM and KONT are accepted, the approach is always square to the contour.";
    "G42", "右侧半径补偿", "radius compensation right", "同 G41，在右侧。", "As G41, on the right.";
    "G53", "机床坐标", "machine coordinates", "G53、G153 X_ Z_：本段为机床坐标。", "G53 or G153 X_ Z_: machine coordinates in this block.";
    "G54", "工件坐标系 1", "work offset 1", "从本段起有效；程序开始时为 G54。", "From this block on; a program starts with G54.";
    "G55", "工件坐标系 2", "work offset 2", "从本段起有效。", "From this block on.";
    "G56", "工件坐标系 3", "work offset 3", "从本段起有效。", "From this block on.";
    "G57", "工件坐标系 4", "work offset 4", "从本段起有效。", "From this block on.";
    "G58", "工件坐标系 5", "work offset 5", "从本段起有效。", "From this block on.";
    "G59", "工件坐标系 6", "work offset 6", "从本段起有效。", "From this block on.";
    "G500", "取消工件坐标系", "no work offset", "G500：不用 G54–G59；G505、G506 … 为附加工件坐标系 P1、P2 …", "G500: none of G54 to G59; G505, G506 … are the additional work offsets P1, P2 …";
    "TRANS", "可编程零点偏移", "programmable zero offset", "TRANS X_ Z_ 替换，ATRANS 增加，TRANS 单独为取消；各占一段。", "TRANS X_ Z_ replaces it, ATRANS adds to it, TRANS alone ends it; each in a block of its own.";
    "T", "刀具和刀补", "tool and offset", "T1 D2：D 为刀补号；只写 T 为 D1，D0 取消。", "T1 D2: D is the number of the tool offset; T alone has D1, D0 cancels it.";
    "DIAMON", "直径编程", "diameter programming", "DIAMON：X 为直径；DIAMOF：半径；DIAM90：绝对为直径，增量为半径。", "DIAMON: X is a diameter; DIAMOF: a radius; DIAM90: absolute a diameter, incremental a radius.";
    "IC", "单字增量", "incremental word", "X=IC(-2)：该字为增量；X=AC(…) 为绝对。", "X=IC(-2): this word is incremental; X=AC(…) absolute.";
    "G74", "回机械零点", "to the machine zero", "G74 X1=0 Z1=0：写出的轴快速回机械零点（P45–P47）。", "G74 X1=0 Z1=0: the named axes move to the machine zero (P45 to P47) at rapid speed.";
    "G75", "回固定点", "to the fixed point", "G75 X1=0 Z1=0：写出的轴快速到第 2 参考点（P161–P163）。", "G75 X1=0 Z1=0: the named axes move to reference point 2 (P161 to P163) at rapid speed.";
    "LIMS", "恒线速最高转速", "speed limit", "LIMS=1200：G96 时的最高转速。", "LIMS=1200: highest speed under G96, rpm.";
    "G60", "准停方式", "exact stop", "每段终点准停；开机状态。", "Exact stop at the end of every block; active at power-on.";
    "G601", "准停窗口", "exact stop window", "G601、G602 可写：准停只有一种，到位宽度 P54。", "G601 and G602 are accepted: there is one exact stop, in-position width P54.";
    "G64", "连续方式", "continuous path", "拐角在公差内圆滑过渡。", "Corners are rounded within the tolerance.";
    "G70", "英制尺寸", "lengths in inches", "以后的尺寸按英寸读，F 不变。", "The following lengths are in inches, F is not.";
    "G71", "公制尺寸", "lengths in millimetres", "以后的尺寸按毫米读；开机状态。", "The following lengths are in millimetres; active at power-on.";
    "G700", "英制尺寸和进给", "lengths and feeds in inches", "以后的尺寸和 F 按英寸读。", "The following lengths and feeds are in inches.";
    "G710", "公制尺寸和进给", "lengths and feeds in millimetres", "以后的尺寸和 F 按毫米读。", "The following lengths and feeds are in millimetres.";
    "G90", "绝对编程", "absolute", "以后的坐标为绝对值。", "The following coordinates are absolute.";
    "G91", "增量编程", "incremental", "以后的坐标为增量值。", "The following coordinates are incremental.";
    "G94", "每分进给", "feed per minute", "F 为每分钟毫米。", "F is in mm/min.";
    "G95", "每转进给", "feed per revolution", "F 为每转毫米；必须重新给 F。", "F is in mm/rev; a new F is required.";
    "G96", "恒线速", "constant surface speed", "S 为砂轮圆周 m/min，F 为 mm/r。", "S is the surface speed of the wheel in m/min, F is mm/rev.";
    "G97", "恒转速", "constant spindle speed", "S 为转/分，F 为 mm/r。", "S is in rpm, F is mm/rev.";
}
