//! Statements, operators and words of the languages, beside their codes: what the control does with each. Every row has a
//! program of a few lines that proves it. Source: spec B1, B3, L2, S1; FANUC B-64304 (custom macro).

use super::text::Text;

/// What the control does with a code or word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LanguageState {
    /// It acts.
    Supported,
    /// It may be written and has no effect.
    NoEffect,
    /// A message names it.
    Refused,
}

impl LanguageState {
    /// Its name in the table.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Supported => "supported",
            Self::NoEffect => "no effect",
            Self::Refused => "refused",
        }
    }
}

/// One row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LanguageRow {
    /// What kind of word it is: `statement`, `operator`, `function`, `word`, `G`.
    pub class: &'static str,
    /// As it is written.
    pub word: &'static str,
    /// What the control does with it.
    pub state: LanguageState,
    /// Its meaning, or why it is refused.
    pub text: Text,
    /// Blocks that use it; a program with them is right, or is refused in the first of them.
    pub example: &'static str,
}

macro_rules! language {
    ($table:ident: $($class:literal, $word:literal, $state:ident, $zh:literal, $en:literal, $example:literal;)*) => {
        pub(super) const $table: &[LanguageRow] = &[$(LanguageRow {
            class: $class, word: $word, state: LanguageState::$state, text: Text::new($zh, $en), example: $example,
        },)*];
    };
}

language! {
    GRINDER:
    "statement", "#i=…", Supported, "给变量赋值", "assignment", "#1=2";
    "statement", "IF […] GOTO n", Supported, "条件跳转", "conditional jump", "IF[#500EQ1]GOTO 10\nN10";
    "statement", "IF […] THEN …", Supported, "条件语句，同一行", "conditional statement on the same line", "IF[#500EQ1]THEN #501=2";
    "statement", "GOTO n", Supported, "跳转", "jump", "GOTO 10\nN10";
    "statement", "WHILE […] DO m", Supported, "循环，m 为 1–3，最多三层", "loop, m is 1 to 3, three levels", "WHILE[#500LT-1]DO1\nEND1";
    "statement", "DO m", Supported, "循环，用 GOTO 离开", "loop that a GOTO leaves", "DO1\nGOTO 10\nEND1\nN10";
    "statement", "END m", Supported, "循环结束", "end of a loop", "WHILE[#500LT-1]DO2\nEND2";
    "statement", "POPEN", NoEffect, "打印开始：总是开着", "opens the printer: it is open", "POPEN";
    "statement", "PCLOS", NoEffect, "打印结束", "closes the printer", "PCLOS";
    "statement", "BPRNT", Refused, "二进制打印：用 DPRNT", "binary print: use DPRNT", "BPRNT[X#100[3]]";
    "statement", "ELSE", Refused, "其它语言的语句：用 IF […] GOTO n", "of other languages: use IF […] GOTO n", "ELSE";
    "statement", "ENDIF", Refused, "其它语言的语句：用 IF […] GOTO n", "of other languages: use IF […] GOTO n", "ENDIF";
    "statement", "o<…> sub", Refused, "LinuxCNC 的 O 语句：用 M98、G65、WHILE", "O words of LinuxCNC: use M98, G65, WHILE", "O100 SUB";
    "operator", "+ - * /", Supported, "加减乘除", "arithmetic", "#1=1+2*3/4-5";
    "operator", "MOD", Supported, "余数", "remainder", "#1=7MOD3";
    "operator", "AND OR XOR", Supported, "条件或按位", "of conditions, or of bits", "IF[[#500EQ1]AND[#501EQ2]]THEN #502=7OR8\n#503=5XOR1";
    "operator", "EQ NE GT GE LT LE", Supported, "比较", "comparison", "IF[1NE2]THEN #1=1\nIF[1LE2]THEN #1=1";
    "operator", "[ ]", Supported, "括号，五层", "brackets, five levels", "#1=[1+[2*[3+4]]]";
    "function", "POW[a,b]", Supported, "乘方", "power", "#1=POW[2,3]";
    "function", "ATAN[a]/[b]", Supported, "四象限反正切；也可写 ATAN[a,b]", "arc tangent in four quadrants; ATAN[a,b], too", "#1=ATAN[1]/[2]\n#1=ATAN[1,2]";
    "G", "G54.1", Supported, "附加工件坐标系 P1–P48", "additional work offsets P1 to P48", "G54.1 P2";
    "G", "G65 H", Supported, "宏 A 计算", "calculations of macro A", "G65 H01 P#100 Q5";
    "G", "G43 G44", Refused, "刀长补偿：用 T 的刀补", "tool length: T has the offset", "G43 H1";
    "G", "G81–G89", Refused, "钻孔和其它系统的磨削循环：用 P420 起的表", "drilling cycles, and grinding cycles of other controls: the table from P420 on", "G81 X1. Z1. F1.";
    "word", "X Z", Supported, "坐标", "coordinates", "G00 X1. Z1.";
    "word", "U W", Supported, "增量坐标", "incremental coordinates", "G00 U1. W1.";
    "word", "R", Supported, "圆弧半径；循环的退刀", "radius of an arc; retract of a cycle", "G00 X10. Z0.\nG02 U10. W-5. R20. F10";
    "word", "F", Supported, "进给", "feed", "G98 G01 X1. F10.";
    "word", "S", Supported, "转速", "speed", "S100";
    "word", "T", Supported, "刀具和刀补 T0101", "tool and offset T0101", "T0101";
    "word", "M", Supported, "辅助功能", "auxiliary function", "M08";
    "word", "P", Supported, "程序号、段号、暂停 ms", "program, block, dwell in ms", "G04 P100";
    "word", "N", Supported, "段号", "block number", "N10 G04 P1";
    "word", "L", Supported, "次数；G10 的坐标系种类", "number of times; kind of offset of G10", "G10 L2 P1 X1.";
    "word", "Q", Supported, "循环最后一段的段号；G70–G76 的数值", "last block of a cycle; values of G70 to G76", "G65 H01 P#100 Q5";
    "word", "H", Supported, "G65 的计算种类，宏的参数", "calculation of G65, argument of a macro", "G65 H01 P#100 Q5";
    "word", "D E", Refused, "只作宏的参数（G65、G66）", "arguments of a macro alone (G65, G66)", "G00 X1. D5.";
    "word", "A C", Refused, "没有 A、C 轴；,A 是直线角度，,C 是倒角", "there is no axis A or C; ,A is an angle, ,C a chamfer", "G00 A90.";
    "word", "O", Supported, "程序号，1–8 位", "program number of 1 to 8 digits", "O2001";
    "word", ":n", Supported, "程序号，同 O", "program number as O", ":2001";
    "word", "/ /1–/9", Supported, "跳段，一个开关", "block skip, one switch for all", "/G04 P1\n/2G04 P1";
    "word", "%", Supported, "程序文件开头和结尾", "begin and end of a file", "%";
    "word", "(…)", Supported, "注释", "comment", "(TEXT)";
    "word", ";", Supported, "段尾：后面是注释，或另一段", "end of a block: a comment or another block follows", "G04 P1 ; TEXT";
    "word", "B", Refused, "没有 B 轴", "there is no axis B", "G00 B90.";
}

language! {
    LATHE_A:
    "word", "I K", Supported, "圆心，从起点量", "centre of an arc from its start", "G00 X10. Z0.\nG02 X20. Z-5. K-5. F10";
    "word", "Y V", Refused, "外圆磨没有 Y 轴", "GC has no axis Y", "G00 Y1.";
}

language! {
    MILL:
    "word", "Y V", Supported, "坐标，增量坐标", "coordinate, incremental coordinate", "G00 Y1.\nG00 V1.";
    "word", "I J K", Supported, "圆心，从起点量", "centre of an arc from its start", "G17 G00 X10. Y0.\nG02 X20. Y-10. J-10. F10";
}

language! {
    SINUMERIK:
    "G", "G153", Supported, "本段机床坐标", "machine coordinates in this block", "G153 G0 X-1";
    "G", "G505 …", Supported, "附加工件坐标系 P1、P2 …", "additional work offsets P1, P2 …", "G505";
    "G", "G602", NoEffect, "准停窗口：只有一种", "exact stop window: there is one", "G602";
    "G", "G17 G19", Refused, "没有 Y 轴", "there is no axis Y", "G17";
    "word", "ATRANS", Supported, "增加零点偏移", "adds to the zero offset", "ATRANS X1";
    "word", "DIAMOF", Supported, "半径编程", "radius programming", "DIAMOF";
    "word", "DIAM90", Supported, "绝对为直径，增量为半径", "absolute a diameter, incremental a radius", "DIAM90";
    "word", "AC", Supported, "本字绝对", "this word is absolute", "G0 X=AC(5)";
    "word", "NORM KONT", NoEffect, "接近方式：总是垂直于轮廓", "approach: it is always square", "NORM\nKONT";
    "word", "CR", Supported, "圆弧半径", "radius of an arc", "G0 X10 Z0\nG2 X20 Z-5 CR=5 F10";
    "word", "X Z", Supported, "坐标", "coordinates", "G0 X1 Z1";
    "word", "I K", Supported, "圆心，从起点量", "centre of an arc from its start", "G0 X10 Z0\nG2 X20 Z-5 I0 K-5 F10";
    "word", "F S M N", Supported, "进给、转速、辅助功能、段号", "feed, speed, auxiliary function, block number", "N10 G94 G1 X1 F10 S100 M8";
    "word", "D", Supported, "刀补号", "number of the tool offset", "T1 D1";
    "word", "/", Supported, "跳段", "block skip", "/G4 F1";
    "word", ";", Supported, "注释", "comment", "G4 F1 ; TEXT";
    "word", "AA1:", Supported, "标号", "label", "GOTOF AA1\nAA1:";
    "operator", "+ - * / DIV MOD", Supported, "运算", "arithmetic", "R1=7 DIV 2+7 MOD 2*3/1-1";
    "operator", "== <> > < >= <=", Supported, "比较", "comparison", "IF R1<>0 GOTOF AA1\nAA1:";
    "operator", "AND OR NOT", Refused, "条件不能组合：用两个 IF", "conditions do not combine: use two IF", "IF R1==1 AND R2==1 GOTOF AA1\nAA1:";
    "word", "CYCLE…", Refused, "西门子循环", "cycles of Siemens", "CYCLE83(1,2)";
    "word", "M1= S1=", Refused, "只有一个主轴", "there is one spindle", "M1=3";
    "word", "NAME(…)", Refused, "按名字调用：用 L10", "calls by name: use L10", "WELLE(1)";
    "word", "NAME=…", Refused, "用户变量：用 R 参数", "user variables: use R parameters", "LAENGE=5";
}

language! {
    SUPERMAN:
    "word", "X Z", Supported, "坐标，X 为直径", "coordinates, X is a diameter", "G01 X10 Z1 F100";
    "word", "U W", Supported, "增量坐标", "incremental coordinates", "G01 U-1 W-1 F100";
    "word", "I K R", Supported, "圆心、半径", "centre, radius of an arc", "G01 X10 Z0 F100\nG02 U10 W-5 R5 F100";
    "word", "F S M T N", Supported, "进给、转速、辅助功能、刀号、段号", "feed, speed, auxiliary function, tool, block number", "G01 X9 F100";
    "word", "L", Supported, "次数", "number of times", "G22 L2\nG04 F1\nG80";
}
