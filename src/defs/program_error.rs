//! Program alarms: errors in the program text, with remedies.
//! `{}` is replaced by the first detail of a fault, `{2}` by the second. Source: spec B8 (1–65, 67–99; these are all taken: 500–599), B1–B4.

use super::text::{Template, Text};

/// The placeholders of the details.
const DETAILS: &[&str] = &["", "2"];

macro_rules! program_errors {
    ($($(#[$remark:meta])? $name:ident = $number:literal, $id:literal, $zh:literal, $en:literal, $remedy_zh:literal, $remedy_en:literal;)*) => {
        /// An error in a program.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum ProgramError { $(#[doc = $en] $(#[doc = ""] #[$remark])? $name,)* }

        impl ProgramError {
            /// All rows, in table order.
            pub const ALL: &'static [Self] = &[$(Self::$name),*];

            /// The alarm number.
            #[must_use]
            pub const fn number(self) -> u16 {
                match self { $(Self::$name => $number,)* }
            }

            /// Stable name, English, with hyphens.
            #[must_use]
            pub const fn id(self) -> &'static str {
                match self { $(Self::$name => $id,)* }
            }

            /// Description; `{}` and `{2}` are replaced by the details.
            #[must_use]
            pub const fn text(self) -> Text {
                self.template().text
            }

            /// Remedy.
            #[must_use]
            pub const fn remedy(self) -> Text {
                self.remedy_template().text
            }

            /// Description, as a template of the two details.
            #[must_use]
            pub const fn template(self) -> &'static Template {
                match self { $(Self::$name => &Template { text: Text { zh: $zh, en: $en }, names: DETAILS },)* }
            }

            /// Remedy, as a template of the two details.
            #[must_use]
            pub const fn remedy_template(self) -> &'static Template {
                match self {
                    $(Self::$name => &Template { text: Text { zh: $remedy_zh, en: $remedy_en }, names: DETAILS },)*
                }
            }
        }
    };
}

program_errors! {
    /// A word that no function of the block uses.
    UnknownWord = 1, "unknown-word", "无法识别的字 '{}'", "unknown word '{}'",
        "该程序段中没有指令使用此字，请删除或更正", "no code in this block uses it: correct or delete it";
    BadNumber = 2, "bad-number", "数字格式错误 '{}'", "bad number '{}'",
        "数字只能含一个小数点和最多 40 位", "write at most 40 digits with at most one decimal point";
    MissingNumber = 3, "missing-number", "'{}' 后缺少数字", "number missing after '{}'",
        "请在其后写出数值", "write the value";
    NonAsciiCharacter = 4, "foreign-character", "注释以外出现字符 '{}'", "character '{}' outside a comment",
        "请改用半角英文字符 {2}", "type {2} instead";
    UnexpectedCharacter = 5, "unexpected-character", "此处不应出现 '{}'", "unexpected '{}'",
        "请检查程序段的写法", "check how the block is written";
    UnbalancedBracket = 6, "unbalanced-bracket", "方括号不匹配", "square brackets do not match",
        "每个 [ 都要有对应的 ]", "every [ needs a ]";
    UnbalancedComment = 7, "unbalanced-comment", "注释括号不匹配", "comment brackets do not match",
        "在同一行内用 ( 和 ) 括起注释，注释内不能再有括号", "open with ( and close with ) on the same line; the first ) ends the comment: no brackets in it";
    UnknownG = 8, "unknown-g", "没有 {} 指令", "unknown code {}",
        "请查阅 G 代码表", "see the table of G codes";
    NoEncoderG = 9, "g-without-encoder", "{} ({2}) 需要主轴编码器，本机没有", "{} ({2}) needs a spindle encoder, which this machine has not",
        "螺纹在带编码器的车床上加工", "cut threads on a lathe with an encoder";
    WrongKindG = 10, "g-not-on-this-machine", "本机床没有 {} ({2})", "{} ({2}) does not exist on this machine",
        "请查阅本机床的 G 代码表", "see the table of G codes of this machine";
    /// An M code above 99 or not a whole number.
    UnknownM = 11, "unknown-m", "没有 {} 指令", "unknown code {}",
        "请查阅 M 代码表 (M00–M99 的整数)", "see the table of M codes, whole numbers from 0 to 99";
    DoubleWord = 12, "double-word", "同一程序段中 '{}' 重复", "'{}' appears twice in the block",
        "每个地址在一段中只能出现一次", "write an address once in a block";
    DoubleGroup = 13, "double-group", "{} 与 {2} 属于同一组", "{} and {2} cannot be combined in one block",
        "请分成两个程序段", "write them in two blocks";
    AbsoluteAndIncremental = 14, "absolute-and-incremental", "{} 与 {2} 指同一轴", "{} and {2} name the same axis",
        "绝对与增量只能选一个", "use one of the two";
    NoAxis = 15, "no-axis", "本机床没有 {} 轴", "this machine has no axis {}",
        "请删除该字", "delete the word";
    ArcWithoutCentre = 16, "arc-without-centre", "圆弧缺少圆心或半径", "arc without centre or radius",
        "请写半径 {}，或圆心坐标 {2}", "write the radius {}, or the centre {2}";
    ArcEndOffCircle = 17, "arc-end-off", "圆弧终点偏离圆周 {} mm", "the arc end point is {} mm off the circle",
        "请核对终点与圆心", "check end point and centre";
    ArcRadius = 18, "arc-radius", "圆弧半径 {} 无效", "arc radius {} is not valid",
        "半径不能为零，也不能小于弦长的一半；整圆请用圆心编程", "it must not be zero and must be at least half the chord; for a full circle give the centre";
    FeedMissing = 19, "feed-missing", "没有进给速度 F", "no feed F has been given",
        "请在切削段之前或段内输入 F；{} 之后须重新输入", "give F in this block or before; {} requires a new one";
    OutOfRange = 20, "out-of-range", "{} 超出范围 {2}", "{} is out of range {2}",
        "请修改数值", "change the value";
    DivisionByZero = 21, "division-by-zero", "除数为零", "division by zero",
        "请检查除数变量", "check the variable of the divisor";
    FunctionDomain = 22, "domain", "函数 {} 的参数 {2} 无效", "{} of {2} is not defined",
        "请检查表达式中的变量", "check the variables of the expression";
    Overflow = 23, "overflow", "计算结果溢出", "the result is too large",
        "请检查表达式中的变量", "check the variables of the expression";
    BadVariable = 24, "bad-variable", "没有变量 {}", "there is no variable {}",
        "可用 #1–#33 #100–#439 #500–#999 及系统变量", "use #1–#33, #100–#439, #500–#999 or a system variable";
    ReadOnly = 25, "read-only", "变量 {} 不能赋值", "variable {} cannot be set",
        "该变量只读", "it can only be read";
    SwitchVariable = 26, "switch-variable", "变量 {} 只能为 0 或 1", "variable {} must be 0 or 1",
        "请赋值 0 或 1", "set it to 0 or 1";
    MissingTarget = 27, "missing-target", "找不到程序段 {}", "there is no block {}",
        "请检查跳转目标的 N 号", "check the N number of the target";
    MissingProgram = 28, "missing-program", "找不到程序 {}", "there is no program {}",
        "请检查程序号，或拷入该程序", "check its number, or copy the program in";
    TooDeep = 29, "too-deep", "{} 嵌套超过 {2} 层", "{} nested deeper than {2}",
        "请减少嵌套层数", "nest fewer levels";
    LoopMismatch = 30, "loop-mismatch", "{} 没有配对", "{} has no matching statement",
        "WHILE […] DO m 与 END m 必须配对且不交叉", "WHILE […] DO m and END m go in pairs and do not cross";
    DoNumber = 31, "do-number", "循环号 {} 无效", "loop number {} is not valid",
        "循环号只能为 1–3，内层不能重复外层的号", "use 1 to 3, with different numbers for inner and outer loops";
    BadStatement = 32, "bad-statement", "语句写法错误：{}", "statement not understood: {}",
        "请按 IF […] GOTO n、IF […] THEN、WHILE […] DO m、END m、GOTO n、#i=… 书写", "write IF […] GOTO n, IF […] THEN …, WHILE […] DO m, END m, GOTO n, #i=…";
    MissingWord = 33, "missing-word", "{} 缺少 {2}", "{} needs {2}",
        "请补上该字", "add the word";
    NotTogether = 34, "not-together", "{} 与 {2} 不能同段", "{} and {2} cannot be in one block",
        "请分成两个程序段", "write them in two blocks";
    G50WithTools = 35, "preset-with-tools", "使用多把刀时不能用 G50", "G50 in a program with several tools",
        "多把刀请使用刀补方式", "use tool offsets for several tools";
    BlockTooLong = 36, "block-too-long", "程序段太长", "the block is too long",
        "请分成几个程序段", "write it in several blocks";
    TooComplex = 37, "too-complex", "表达式嵌套太深", "the expression is nested too deep",
        "请分步计算", "calculate in several steps";
    AxisUnused = 38, "axis-unused", "{} 不能与坐标字同段", "{} cannot be in one block with axis words",
        "请分成两个程序段", "write them in two blocks";
    NotWhole = 39, "not-whole", "{} 必须为整数", "{} must be a whole number",
        "请输入不带小数的数值", "give a number without a fraction";
    MisplacedO = 40, "misplaced-o", "O 号只能在程序开头", "the O number is allowed only at the start of the program",
        "一个文件只存一个程序；零要写成数字 0，不是字母 O", "keep one program in a file; write zero as the digit 0, not the letter O";
    AxisOutsidePlane = 41, "axis-outside-plane", "{} 不在所选平面内", "{} is outside the plane of the arc",
        "请选择圆弧所在平面，或删除该字", "select the plane of the arc, or delete the word";
    /// An input without an assigned port.
    InputNotAssigned = 42, "no-input", "{} 没有指定输入口", "{} has no input assigned",
        "请输入 L，或在参数中设定输入口", "give L, or set the input by parameter";
    UnknownH = 43, "unknown-h", "G65 没有 {}", "G65 has no {}",
        "可用 H01–H05 H11–H13 H21–H27 H31–H34 H80–H86 H99", "use H01–H05, H11–H13, H21–H27, H31–H34, H80–H86, H99";
    EndlessLoop = 44, "endless", "检查没有把这个循环走到底：它等待检查没有的信号，或不结束，或重复太多", "this loop is not followed to the end: it waits for what a check does not have, does not end, or repeats too often",
        "请确认它会结束；后面的程序已检查，但值可能不同", "make sure that it ends; the program behind it was checked, but with values that may differ";
    NullUsed = 45, "null-used", "空变量 {} 按 0 计算", "empty variable {} is used as 0",
        "请先给变量赋值", "give it a value first";
    IncrementalG91 = 47, "g91-on-lathe", "外圆磨没有 G91 指令", "G91 does not exist on this machine",
        "增量编程请用 U、W", "use U and W for incremental moves";
    BadEncoding = 48, "bad-encoding", "字节 {} 不是 GBK 或 UTF-8 文字", "byte {} is neither GBK nor UTF-8",
        "请把文件另存为 GBK 或 UTF-8 编码的文本", "save the file as plain text in GBK or UTF-8";
    TakesNoNumber = 49, "takes-no-number", "{} 的 {2} 后不带数值", "{} needs {2} without a number",
        "只写轴名，例如 G27 X", "write the letter alone, as in G27 X";
    DwellWithoutSpeed = 60, "dwell-without-speed", "{} 按转数停顿，但没有以 r/min 给出的转速", "{} dwells in revolutions, but no speed in rpm is given",
        "请先用 S 给出转速 (G97)，或改用 G4 F 秒", "program S (G97) before it, or dwell by G4 F in seconds";
    /// A SINUMERIK arc radius written as in other dialects.
    RadiusByCr = 58, "radius-by-cr", "圆弧半径不能写成 {}", "{} cannot be used for the radius of an arc",
        "半径写成 {2}", "write {2}";
    UnknownFunction = 59, "unknown-function", "没有函数 {}", "there is no function {}",
        "可用 {2}", "available are {2}";
    ThreadFraction = 67, "thread-fraction", "每寸牙数 {} 的小数部分无效", "the fraction of {} threads per inch is not valid",
        "小数点后是分数的分母：33.2 是 33½，分母从 2 起", "the digits after the point are the denominator: 33.2 is 33½; it must be 2 or more";
    /// A jump into a counted loop (L4).
    JumpIntoLoop = 68, "into-loop", "跳转进入了循环：没有经过第 {} 行的 G22", "a jump entered the loop: the G22 in line {} was not executed",
        "跳到 G22 段，或循环之外", "jump to the block of G22, or outside the loop";
    TooManyCodes = 69, "too-many-codes", "一段中 {} 超过 {2} 个", "more than {2} {} in one block",
        "请分成几个程序段", "write them in several blocks";
    /// A program without blocks (L1).
    EmptyProgram = 99, "empty-program", "程序没有程序段", "the program has no blocks",
        "请输入程序，最后一段写 {}", "write the blocks, with {} as the last one";
    BadLabel = 61, "bad-label", "标号 {} 无效", "{} cannot be a label",
        "标号前两位必须是字母或下划线，且不能是指令字，例如 AA1:", "a label begins with two letters or underscores, such as AA1:, and must not be a code word";
    MissingJumpLabel = 62, "label-left-out", "{} 后缺少标号", "no label after {}",
        "请写出标号，例如 {} AA1", "write the label, as in {} AA1";
    UnknownJump = 63, "no-such-jump", "没有 {} 指令", "there is no {}",
        "朝程序结束方向跳转用 GOTOF，朝程序开头方向用 GOTOB", "jump forward with GOTOF, backward with GOTOB";
    EqualsMissing = 64, "equals-missing", "{} 后缺少 '='", "'=' is missing after {}",
        "R 参数和表达式用 = 赋值，例如 X=R1", "assign R parameters and expressions with =, as in X=R1";
    BadMessage = 65, "bad-message", "MSG 写法错误", "MSG is not written correctly",
        "请写 MSG(\"文字\")，清除用 MSG()", "write MSG(\"text\"), or MSG() to end it";
    BadRParameter = 90, "bad-r", "没有参数 {}", "there is no parameter {}",
        "可用 R0–R299", "use R0 to R299";
    MissingLabel = 91, "missing-label", "找不到标号 {}", "there is no label {}",
        "请检查标号的写法（AA1:）", "check how the label is written (AA1:)";
    LabelInOtherDirection = 92, "label-elsewhere", "标号 {} 不在跳转方向上", "label {} is not in this direction",
        "GOTOF 只朝程序结束方向找，GOTOB 只朝程序开头方向找；请改用 {2}", "GOTOF searches forward only, GOTOB backward only: use {2}";
    /// A label that is not unique (S1).
    SeveralLabels = 57, "several-labels", "标号 {} 不唯一", "{} is not unique",
        "同一程序中每个标号只能出现一次", "use each label only once in a program";
    UnbalancedQuote = 93, "unbalanced-quote", "引号不匹配", "the quotes do not match",
        "MSG(\"文字\")：同一行内成对使用同一种引号", "MSG(\"text\"): a pair of the same quotes on one line";
    DigitsOnly = 94, "digits-only", "{} 后只能写数字", "{} accepts digits only",
        "N、G、L 不能用 = 赋值", "N, G and L cannot be written with = expression";
    UnknownSystemVariable = 95, "unknown-system-variable", "没有系统变量 {}", "there is no system variable {}",
        "可用 $AA_IW[轴] 和 $AA_IM[轴]", "use $AA_IW[axis] or $AA_IM[axis]";
    UnbalancedRound = 96, "unbalanced-round", "圆括号不匹配", "round brackets do not match",
        "每个 ( 都要有对应的 )", "every ( needs a )";
    BadCondition = 97, "bad-condition", "条件写法错误：{}", "condition not understood: {}",
        "请按 IF a<b GOTOF 标号 书写，比较用 == <> > < >= <=", "write IF a<b GOTOF label; comparisons are == <> > < >= <=";
    ContourEmpty = 85, "contour-empty", "循环的轮廓段没有移动", "the cycle's contour has no moves",
        "P 到 Q 之间至少要有两段移动", "write at least two moves between P and Q";
    ContourCode = 86, "contour-code", "轮廓段中只能用 G00–G03、F、S", "only G00 to G03, F and S are allowed in a contour",
        "把其他指令移到 P–Q 段以外", "move everything else outside P to Q";
    ContourStart = 87, "contour-start", "轮廓首段必须从循环起点向工件进刀", "the contour must begin with a move from the start into the stock",
        "首段只写进刀轴 (G71: X，G72: Z)；有凹槽时写两轴，如 G00 X40 W0", "write the infeed axis alone in its first block (G71 X, G72 Z), or both for pockets: G00 X40 W0";
    ContourAboveStart = 548, "contour-above-start", "第 {} 行的轮廓加余量后高于循环起点", "the contour of line {} with its allowance lies above the start of the cycle",
        "循环从毛坯外开始：改起点或这一行", "start the cycle outside the stock: correct the start, or this line";
    ContourNotMonotone = 88, "contour-not-monotone", "第 {} 行的轮廓沿行程方向折返", "the contour of line {} turns back along the strokes",
        "检查坐标符号；要折返的轮廓用 G73", "check the sign of its coordinates; G73 is for a contour that turns back";
    ContourPocket = 549, "contour-pocket", "第 {} 行的轮廓有凹槽，但首段只有一个轴", "the contour of line {} goes into a pocket, but its first block names one axis",
        "有凹槽时首段写 X 和 Z，如 G00 X40 W0", "for pockets write X and Z in the first block: G00 X40 W0";
    ContourAllowance = 550, "contour-allowance", "精加工余量比轮廓还长", "the finishing allowance is longer than the contour",
        "改小 U 或 W；毫米值带小数点", "write a smaller U or W; a value in mm has a decimal point";
    ContourStrokes = 89, "contour-strokes", "循环行程次数太多", "the cycle has too many strokes",
        "增大每次切深", "increase the depth of cut";
    RectangleSide = 70, "rectangle-side", "矩形循环 {} 方向边长为零", "the side of the rectangle along {} is zero",
        "对角点在 X、Z 两个方向都必须离开起点", "the corner must differ from the start in both X and Z";
    ArcTooSmall = 71, "arc-too-small", "圆弧半径 {} mm 应大于 {2} mm", "the arc radius of {} mm must be greater than {2} mm",
        "加大半径，或改用直线", "increase it, or use a line";
    FullCircleByRadius = 72, "full-circle-by-radius", "整圆不能用 R 编程", "a full circle cannot be written with R",
        "请用 I、K 给出圆心", "give the centre by I and K";
    ThreadWithoutInfeed = 73, "no-infeed", "螺纹前没有 X 向进给段，退尾方向不定", "no X move before the thread: the run-out direction is not known",
        "在螺纹段之前写一段 G00 或 G01 的 X 向进给", "write an X move with G00 or G01 before the thread";
    IncrementalOnly = 74, "incremental-only", "螺纹必须用增量 U、W 编程，不能用 {}", "program a thread with U and W, not with {}",
        "把 {} 改为增量", "write {} as an increment";
    ThreadApproachShort = 75, "approach-short", "螺纹起刀点距工件只有 {} mm，少于 3 倍导程或升速距离 {2} mm", "the thread begins {} mm before the part, less than three leads or the run-up ({2} mm)",
        "起刀点离工件 3–5 倍导程", "begin three to five leads before the part";
    SpindleTooFast = 76, "spindle-too-fast", "主轴转速 {} 超过螺纹允许的 {2} r/min", "spindle speed {} rpm exceeds the {2} rpm allowed for the thread",
        "转速不超过 1200/导程-80", "keep it at 1200/lead - 80 or less";
    SeveralTargets = 77, "several-targets", "程序段 {} 不唯一", "{} is not unique",
        "循环、跳转、调用的目标段号必须唯一", "the target of a loop, jump or call must have a unique number";
    JumpToItself = 78, "jump-to-itself", "{} 跳转到本段", "{} jumps to itself",
        "请指定其他程序段", "name another block";
    G92WithDistances = 79, "preset-by-distance", "{} 不能用 {2}", "{} cannot be used with {2}",
        "用 X、Z 给出坐标", "give the coordinates with X and Z";
    SubBeforeMain = 80, "sub-before-main", "子程序 {} 必须在主程序之后", "subprogram {} must be after the main program",
        "把子程序移到主程序之后", "move it after the main program";
    ReturnWithoutCall = 81, "return-without-call", "M99 没有对应的 M98", "M99 without M98",
        "主程序用 M02 结束", "end the main program with M02";
    LoopUnpaired = 82, "loop-unpaired", "{} 没有配对的 {2}", "{} has no matching {2}",
        "G22 与 G80 必须成对，并写在段号之后", "G22 and G80 go in pairs, each first in its block";
    NoMacros = 83, "no-macros", "本系统没有宏语句", "this language does not support macro statements",
        "只能使用指令字", "write words only";
    BlockNumberNotFirst = 98, "number-first", "段号必须在程序段开头", "the block number must be first in its block",
        "把 N 写在最前面", "write N first";
    /// A block without a block number (L1).
    BlockNumberMissing = 50, "block-number-missing", "程序段缺少段号", "the block has no number",
        "在段首写四位段号，如 N0010", "begin the block with a number of four digits, like N0010";
    /// A block number that does not have four digits (L1).
    BlockNumberDigits = 51, "block-number-digits", "段号 {} 不是四位数字", "block number {} does not have four digits",
        "应写成 {2}", "write {2}";
    /// A block number with three digits, as printed once in the manual.
    BlockNumberShort = 52, "block-number-short", "段号 {} 只有三位", "block number {} has three digits only",
        "应写成 {2}", "write {2}";
    /// A subprogram without M99 at its end (L7).
    SubWithoutReturn = 53, "sub-without-return", "子程序 {} 没有 M99，程序到此结束", "subprogram {} has no M99: the program text ends here",
        "子程序最后一段写 M99", "end the subprogram with M99";
    /// M02 inside a subprogram (L7).
    EndInSub = 54, "end-in-sub", "子程序 {} 内不能用 M02", "M02 is inside subprogram {}",
        "子程序用 M99 返回；M02 写在主程序末尾", "return with M99; M02 ends the main program";
    /// A code that the dialect does not have.
    UnknownCode = 55, "no-such-code", "没有 {} 指令", "unknown code {}",
        "可用 {2}", "available are {2}";
    /// A thread before the program has started the spindle (L5).
    ThreadSpindle = 56, "thread-spindle", "螺纹前程序没有启动主轴", "the program does not start the spindle before the thread",
        "螺纹前写 M03 或 M04，主轴不转时运行报警 212", "write M03 or M04 before it: a stopped spindle raises alarm 212 in the run";
    ThreadTooShort = 84, "thread-too-short", "螺纹长度 {} mm 不足纵向退尾 {2} mm", "the thread length of {} mm is not more than its run-out of {2} mm",
        "加大 W", "increase W";
    BlockAfterSemicolon = 46, "block-after-semicolon", "';' 后的内容按程序段执行", "the text after ';' is read as a block",
        "注释请写在 ( ) 中", "write a comment in ( )";
    /// A cycle of two blocks whose first one is missing.
    FirstBlockMissing = 500, "first-block-missing", "{} 前面没有 {2} 段", "{} has no block {2} before it",
        "在它前面先写 {2}；其它系统的单段格式不能用", "write {2} in a block before it; the one-block form of other controls cannot be used";
    /// A statement of another control's language.
    ForeignStatement = 501, "foreign-statement", "没有 {} 语句", "there is no statement {}",
        "用 IF […] GOTO n、WHILE […] DO m … END m、M98、G65", "use IF […] GOTO n, WHILE […] DO m … END m, M98 and G65";
    /// Two programs with the same number: in doubt neither is called.
    DuplicateProgram = 502, "duplicate-program", "程序 {} 有两个：{2}", "program {} exists twice: {2}",
        "改掉其中一个的程序号，或删除一个", "change the number of one of them, or delete one";
    /// A cycle as another control writes it.
    ForeignCycle = 503, "foreign-cycle", "{} 不用 {2}：这是其它系统的格式", "{} takes no {2}: this is the form of another control",
        "本机为 FANUC 两段格式：G71 U R，G71 P Q U W F；切槽 G75 R，G75 X Z P Q F", "here cycles have FANUC's form of two blocks: G71 U R, then G71 P Q U W F; grooving G75 R, then G75 X Z P Q F";
    /// A contour that the cutter of G41 or G42 does not fit into.
    CutterGouge = 504, "cutter-gouge", "半径 {} mm 的砂轮（修整器）在此段会切入第 {2} 行的轮廓", "a cutter of {} mm radius would cut into the contour of line {2} here",
        "减小半径 R，或修改轮廓、接近和离开的方向", "reduce the radius R, or change the contour or the way to and from it";
    ArcBelowCutter = 505, "arc-below-cutter", "内圆弧半径不大于补偿半径 {} mm", "the radius of this hollow arc is not greater than the compensation radius of {} mm",
        "减小半径 R，或加大圆弧", "reduce the radius R, or enlarge the arc";
    SegmentBelowCutter = 506, "segment-below-cutter", "此段对补偿半径 {} mm 太短：与第 {2} 行之间的内角无法加工", "this segment is too short for the compensation radius of {} mm: the inner corner to line {2} cannot be cut",
        "减小半径 R，或修改轮廓", "reduce the radius R, or change the contour";
    CompensationLead = 507, "compensation-lead", "{} 后的第一个移动必须是直线", "the first move after {} must be a line",
        "用 G00 或 G01 接近、离开轮廓，不能用 G02、G03", "lead to and from the contour with G00 or G01, not with G02 or G03";
    NotInCompensation = 508, "not-in-compensation", "该段不能在半径补偿 {} 中执行", "this block cannot be executed during compensation {}",
        "先用 G40 取消补偿：补偿中只能用 G00–G03、G04、F、S、不停止读入的 M 代码，不能读取机床的值", "end it with G40 first: it takes G00 to G03, G04, F, S and M codes that do not stop reading ahead, and no values of the machine";
    CompensationChange = 509, "compensation-change", "半径补偿 {} 中不能改变补偿侧、半径或平面", "side, radius and plane cannot be changed during compensation {}",
        "先用 G40 取消补偿", "end it with G40 first";
    CompensationWithoutContour = 510, "compensation-without-contour", "{} 后只有接近移动，没有轮廓", "{} is followed by a lead-in only, not by a contour",
        "G41、G42 与 G40 之间至少写一段轮廓，补偿不能在单个 MDI 段中使用", "write at least one segment between G41 or G42 and G40; compensation does not work in a single MDI block";
    CompensationNotEnded = 511, "compensation-not-ended", "程序在半径补偿 {} 中结束", "the program ends during compensation {}",
        "离开轮廓时写 G40", "write G40 with the move away from the contour";
    CutterWithoutRadius = 512, "cutter-without-radius", "刀补 {} 的半径 R 为 0：轮廓不补偿", "the radius R of offset {} is 0: the contour is not compensated",
        "在刀补页面输入半径 R", "enter the radius R on the offset page";
    /// More blocks without a move than can wait.
    CompensationWaits = 513, "compensation-waits", "半径补偿 {} 中太多程序段没有平面内的移动", "too many blocks without a move in the plane during compensation {}",
        "先用 G40 取消补偿，或把循环和赋值移到轮廓之外", "end it with G40 first, or move loops and assignments out of the contour";
    HoldNotInhibited = 514, "hold-not-inhibited", "#3004 不起作用", "#3004 has no effect",
        "进给保持、倍率、准停始终有效，程序不能禁止", "feed hold, override and exact stop always act: a program cannot disable them";
    CornerWithoutMove = 515, "corner-without-move", "{} 后面没有平面内的 G01、G02、G03 移动", "{} is not followed by a move with G01, G02 or G03 in the plane",
        "下一个移动必须是平面内的直线或圆弧；之间最多三段，不能改变坐标、停止预读或读取机床的值", "the next move must be a line or an arc in the plane; at most three blocks stand between, which change no coordinates, do not stop reading ahead and read no value of the machine";
    CornerDoesNotFit = 516, "corner-does-not-fit", "{} 在两段之间放不下", "{} does not fit between its two segments",
        "减小数值，或加长线段、圆弧", "reduce the value, or make line or arc longer";
    ChamferAtArc = 517, "chamfer-at-arc", "{}：倒角只能在两条直线之间", "{}: a chamfer lies between two lines only",
        "圆弧旁用倒圆角", "use a rounding beside an arc";
    AngleWithoutEnd = 518, "angle-without-end", "只有 {} 的直线没有终点", "a line with {} alone has no end",
        "下一段写 G01 X_ Z_ 和角度，求出交点", "give X, Z and an angle in the next block: the control computes where the lines meet";
    AngleWithEnd = 519, "angle-with-end", "X、Z 和角度 {} 同时给出", "X, Z and the angle {} are given together",
        "只写一个坐标和角度；三个都写时前一段必须只有角度", "give one coordinate and the angle; all three only behind a line with an angle alone";
    LinesParallel = 520, "lines-parallel", "{}：两条直线平行，没有交点", "{}: the two lines are parallel and do not meet",
        "检查两段的角度", "check the angles of both blocks";
    NoSpindlePosition = 521, "no-spindle-position", "{}：本机的主轴不能定位", "{}: the spindle of this machine cannot be positioned",
        "删去该段", "remove the block";
    AngleAway = 522, "angle-away", "角度 {} 指向相反方向", "the angle {} points the other way",
        "角度从 Z+ 逆时针，指向走的方向；加或减 180", "it is counted from Z+ counter-clockwise and points where the line goes: add or subtract 180";
    CornerBeforeAngle = 523, "corner-before-angle", "{} 后面的直线只有角度，没有终点", "{} is followed by a line with an angle alone",
        "给下一段写一个坐标，或把倒角、圆角写成单独的段", "give the next line a coordinate, or write the corner as a block of its own";
    PrintTooLong = 524, "print-too-long", "打印的一行超过 {} 个字符", "a printed line has more than {} characters",
        "分成几行", "divide it into lines";
    NoBinaryPrint = 525, "no-binary-print", "没有 BPRNT", "there is no BPRNT",
        "用 DPRNT 打印文字", "print text with DPRNT";
    PointMissing = 526, "point-missing", "{} 没有小数点，按 mm（英寸）读", "{} has no decimal point and is read as mm (inches)",
        "写小数点，或设 P6.1=1：没有小数点的数以最小输入单位计", "write the point, or set P6.1=1: numbers without one count least increments";
    FeedPerRevByG99 = 527, "feed-per-rev-by-g99", "外圆磨没有 G95", "G95 does not exist on this machine",
        "每转进给用 G99，每分进给用 G98", "use G99 for a feed per revolution, G98 for one per minute";
    PresetByG50 = 528, "preset-by-g50", "外圆磨的 G92 是螺纹循环", "G92 is a thread cycle on GC",
        "设定坐标、限制转速用 G50", "set coordinates and limit the speed with G50";
    ToolWithoutOffset = 529, "tool-without-offset", "T{} 是刀具 0、刀补 {2}", "T{} is tool 0 with offset {2}",
        "前两位为刀具，后两位为刀补：写 T{2}{2}", "two digits for the tool, two for its offset: write T{2}{2}";
    ForeignWord = 530, "foreign-word", "本控制没有 {}", "this control has no {}",
        "SINUMERIK 的这个语句本机不用：改写该段；子程序用编号调用，例如 L10", "it does not use this SINUMERIK statement: write the block without it; a subprogram is called by its number, as in L10";
    NoUserVariable = 531, "no-user-variable", "没有变量 {}", "there is no variable {}",
        "本控制用 R0–R299", "this control has R0 to R299";
    NoCallByName = 532, "no-call-by-name", "没有调用 {}(…)", "there is no call {}(…)",
        "子程序用编号调用，例如 L10；数值用 R 参数传递", "call a subprogram by its number, as in L10, and pass values in R parameters";
    NumberNotName = 533, "number-not-name", "{} 后面是名称", "{} takes a number, not a name",
        "写编号，例如 {}1", "write the number, as in {}1";
    NoAddressExtension = 534, "no-address-extension", "{} 不能写编号和 '='", "{}= does not exist",
        "只有一个主轴：写 M3、S500", "this control has one spindle: write M3, S500";
    MessageIsText = 535, "message-is-text", "MSG 中只能有文字", "MSG shows text alone",
        "不写 <<；数值在 R 参数页面", "write it without <<; the R page shows the values";
    NoBlockIf = 536, "no-block-if", "没有 IF … ENDIF 语句", "there is no IF … ENDIF",
        "用 IF … GOTOF 标号 跳过程序段", "skip blocks with IF … GOTOF label";
    DistanceForAxes = 537, "distance-for-axes", "{}(…) 只能用于 X、Z", "{}(…) is for X and Z alone",
        "写数值", "write the value";
    LetterForZero = 538, "letter-for-zero", "{} 后面是字母 O", "the letter O follows {}",
        "零写数字 0", "write zero as the digit 0";
    ThenMissing = 539, "then-missing", "IF […] 后缺少 THEN", "THEN is missing after IF […]",
        "写 IF […] THEN #1=2，或 IF […] GOTO n", "write IF […] THEN #1=2, or IF […] GOTO n";
    PrintFormat = 551, "print-format", "DPRNT 的变量没有格式", "a variable in DPRNT has no format",
        "写 {}：a 位整数，b 位小数，如 #100[43]", "write {}: a digits before and b behind the point, as in #100[43]";
    AssignmentSign = 552, "assignment-sign", "赋值不写 {}", "{} does not assign",
        "变量赋值写 #1=2", "write an assignment as #1=2";
    BlockOfDigits = 553, "block-of-digits", "程序段以数字 {} 开头", "the block begins with the digit {}",
        "前面加地址字母：N 为段号，O (字母) 为程序号", "put a letter before it: N for a block number, the letter O for a program number";
    ThenAlone = 554, "then-alone", "IF […] THEN 后面没有语句", "nothing follows IF […] THEN",
        "同一行写一条语句；要跳过几行用 IF […] GOTO n", "write one statement on the same line; IF […] GOTO n skips several lines";
    CycleInForce = 540, "cycle-in-force", "循环 {} 有效时不能用 {2}", "{2} is not possible while cycle {} is in force",
        "先用 G00 或 G01 结束循环", "end the cycle with G00 or G01 first";
    FaceCycleG94 = 541, "face-cycle-g94", "外圆磨的 G94 是端面循环", "G94 is a facing cycle on GC",
        "每分进给用 G98，每转进给用 G99", "use G98 for a feed per minute, G99 for one per revolution";
    EmptyWord = 542, "empty-word", "{} 的 {2} 是空变量", "{2} of {} is an empty variable",
        "先给变量赋值", "assign the variable first";
    CommaMissing = 544, "comma-missing", "G01 段中没有 {}", "{} does not exist in a block with G01",
        "倒角、圆角、角度带逗号：写 {2}；本机没有 A、C 轴", "chamfer, rounding and angle have a comma: write {2}; there is no axis A or C";
    TurningCycleWord = 545, "turning-cycle-word", "车削循环 {} 缺少 {2}", "the turning cycle {} needs {2}",
        "加上该地址；要绝对坐标或每分进给，不用写 {}（G98 为每分进给）", "add the word; for absolute coordinates or a feed per minute leave {} out (G98 is feed per minute)";
    PlaneUnnamed = 546, "plane-unnamed", "圆弧有 {}，但没有写明平面 (现为 G18，ZX)", "an arc with {} while no plane is named (G18, ZX, is in force)",
        "在前面写 G17 (XY)、G18 (ZX) 或 G19 (YZ)", "write G17 (XY), G18 (ZX) or G19 (YZ) before it";
    LengthByT = 547, "length-by-t", "没有刀长补偿 {}", "there is no tool length compensation {}",
        "刀补用 T 调用，例如 T0101：删去 {} 和 H", "the offset comes with T, as in T0101: delete {} and H";
    CycleByTable = 556, "cycle-by-table", "本机没有循环 {}", "there is no cycle {} here",
        "磨削循环 O9071–O9079 由机床厂用 P420 起的表接到 G 代码", "the machine builder gives it to a grinding cycle O9071 to O9079 by the table from P420 on";
    /// Allowed, but the program ends there.
    AlarmReached = 555, "alarm-reached", "按现有数值，程序在这里以报警 {} 结束：{2}", "with these values the program ends here with alarm {}: {2}",
        "检查调用的参数和变量", "check the arguments of the call and the variables";
    DwellPoint = 558, "dwell-point", "{}：G04 的 P 以毫秒计，不带小数点", "{}: P of G04 counts milliseconds and takes no decimal point",
        "秒写 X{2}，毫秒写整数 P", "write seconds as X{2}, or whole milliseconds as P";
    PortWordMissing = 559, "port-word-missing", "{} 在本机是输入输出口指令，缺少 {2}", "{} is a function of an input or output port here and lacks {2}",
        "写出端口号；别的机床的 {} 请在 M 代码表中另找", "name the port; for the {} of another machine look at the table of M codes";
    MCodeWord = 560, "m-code-word", "{} 不带 {2}", "{} takes no {2}",
        "先看 M 代码表中 {} 在本机的作用，再决定删去 {2} 或改用别的 M 代码", "see the table of M codes for what {} does here before {2} is deleted or another code is taken";
    ArgumentsByG65 = 561, "arguments-by-g65", "M98 不能传递参数 {}", "M98 passes no argument {}",
        "带参数调用用 G65 P_", "call with arguments by G65 P_";
    NumberWithoutLetter = 562, "number-without-letter", "数 {} 前没有地址字母", "the number {} has no address letter",
        "写出字母：G、M、X、Z 等", "write the letter before it: G, M, X, Z and the like";
    PresetEmpty = 563, "preset-empty", "{} 没有坐标或 S", "{} has no coordinate and no S",
        "{} 设定坐标或限制转速；本机没有比例缩放，程序开头的 {} 请删去", "{} sets coordinates or limits the speed; there is no scaling here: delete it from a safety line";
    NoLoopStatement = 564, "no-loop-statement", "没有 {} 循环语句", "there is no loop with {}",
        "用标号和 IF … GOTOB 标号 写循环", "write the loop with a label and IF … GOTOB label";
    NoLogicOperator = 565, "no-logic-operator", "条件中没有 {}", "conditions have no {}",
        "分成两个 IF：两个都要成立，用相反的条件跳过", "use two IF: to need both, jump away by the opposite of each";
    RadiusMode = 566, "radius-mode", "没有 {}", "there is no {}",
        "X 是直径还是半径由参数 P6.0 决定；LinuxCNC 的 G08 程序 X 是半径，不能只删去该字", "parameter P6.0 says whether X is a diameter or a radius; in a LinuxCNC program behind G08 X is a radius: do not just delete the word";
    CycleRepeated = 567, "cycle-repeated", "磨削循环 {} 不能带 {2}", "the grinding cycle {} takes no {2}",
        "重复同一循环会再磨一次：需要时另写一段；FANUC 的 L 是砂轮磨损补偿号，本机没有", "a repetition would grind the same stock again: write the block again if that is meant; L of FANUC names a wheel-wear compensation, which is missing here";
    SkipWithinBlock = 568, "skip-within-block", "'/' 在程序段中间", "'/' within a block",
        "跳段符 / 写在段首；只跳过一部分时分成两段", "block skip stands at the start of a block: divide the block to skip a part of it";
    LookAheadCode = 569, "look-ahead-code", "没有 {}", "there is no {}",
        "连续方式 G64 总是预读，不需要高速高精指令：删去本字", "path mode G64 always reads ahead and needs no code for high speed or accuracy: delete the word";
    ContourReversed = 572, "contour-reversed", "{} 不在 {2} 之后", "{} does not stand behind {2}",
        "P 是轮廓的第一段，Q 是最后一段：对调 P 和 Q，或改段号", "P is the first block, Q the last: exchange them";
    ContourReturn = 575, "contour-return", "从轮廓终点沿 X、沿 Z 都不能不碰工件地退回起点", "neither along X nor along Z does the way from the contour's end back to the start keep clear of the contour",
        "循环从轮廓以外的点开始（与粗加工同一起点），或让轮廓的最后一段离开工件", "begin the cycle outside the contour, as the roughing does, or let its last block lead away from the part";
    ContourApart = 576, "contour-apart", "循环和它的轮廓 {} 之间有别的程序段，循环后从 {2} 之后继续，会跳过它", "this block stands between a cycle and its contour {} and would be skipped: the program goes on behind {2}",
        "轮廓紧接在循环之后写", "write the contour directly behind the cycle";
    ContourTooLong = 577, "contour-too-long", "轮廓读了 {} 段还没有到最后一段 Q", "after {} blocks the contour has not come to its last block Q",
        "减少轮廓的段数；轮廓中不能有不停的循环", "write it with fewer blocks, and without a loop that does not end";
    ContourLeft = 578, "contour-left", "轮廓段中不能调用、返回，也不能跳到 P–Q 之外", "a contour has no calls, and no jump out of P to Q",
        "把 M98、G65、G66、M99 和 GOTO 移到 P–Q 段以外", "move M98, G65, G66, M99 and the jump outside P to Q";
    JumpIntoWhile = 570, "jump-into-while", "跳转进入了循环：{} 之前没有经过第 {2} 行的 WHILE", "a jump entered the loop: {} was reached without the WHILE in line {2}",
        "GOTO 只能跳到循环外，或同一循环内", "GOTO may leave a loop or stay in it: jump to a block before the WHILE";
    ConditionBrackets = 573, "condition-brackets", "{} 的条件写在圆括号里，圆括号是注释", "the condition of {} stands in round brackets, which are a comment",
        "用方括号：{}[#1 EQ 1]", "use square brackets, as in {}[#1 EQ 1]";
    OffsetWithoutAxis = 574, "offset-without-axis", "{} 属于本机没有的轴", "{} belongs to an axis that this machine does not have",
        "删去该段；各轴的编号按已有的轴排列", "delete the block; the numbers count the fitted axes";
    /// Nothing is known to be wrong, and not all could be looked at.
    ContourUnread = 571, "contour-unread", "检查没有走到这里：这里的补偿轮廓、倒角没有检查", "the check does not come here: the compensated contour or corner is not checked",
        "用能走到这里的数值检查，或用 kt830 run 试运行", "check it with values that lead here, or try it with kt830 run";
    /// Nothing is known to be wrong, and not all could be looked at.
    PositionUnknown = 557, "position-unknown", "检查没有走到这里，不知道各轴的位置：这里和其后的圆弧、轮廓没有检查", "the check does not come here and does not know where the axes stand: arcs and contours from here on are not checked",
        "用能走到这里的数值检查，或用 kt830 run 试运行", "check it with values that lead here, or try it with kt830 run";
    /// Allowed, but the feed is very slow.
    FeedUnitUnnamed = 543, "feed-unit-unnamed", "没有写明 {} 的单位：按 mm/min 走", "the unit of {} is not named: it is taken as mm/min",
        "写明 {2}", "write {2}";
}
