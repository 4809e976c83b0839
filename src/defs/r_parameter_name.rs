//! The R parameters of the grinding program (seed 002's table): names, and titles of their three sheets. The sheet files
//! are Chinese; this table gives their English texts. The factory values stand with the kind. Source: spec S3, H9.

use super::text::Text;

macro_rules! names {
    ($($number:literal, $zh:literal, $en:literal;)*) => {
        /// The named parameters, by number.
        pub const R_NAMES: &[(u16, Text)] = &[$(($number, Text::new($zh, $en)),)*];
    };
}

names! {
    1, "砂轮最小直径", "min. wheel dia.";
    2, "砂轮最大直径", "max. wheel dia.";
    3, "砂轮直径", "wheel diameter";
    4, "砂轮宽度", "wheel width";
    5, "速度下限", "min. rpm";
    6, "线速度上限", "max. rpm";
    7, "线速度", "surface speed";
    8, "砂轮转速", "wheel rpm";
    9, "砂轮圆弧半径", "wheel edge radius";
    10, "金刚笔半径", "diamond radius";
    11, "金刚笔与花盘圆心距离", "diamond to axis";
    12, "金刚笔高度", "diamond height";
    13, "垫块高度", "block height";
    14, "磨架角度", "head angle";
    15, "停顿时间", "dwell at ends";
    16, "砂轮允许线速度", "rated speed m/s";
    18, "X轴精磨尺寸", "finished X";
    19, "Z轴精磨尺寸", "finished Z";
    20, "X轴起始尺寸", "start X";
    21, "Z轴起始尺寸", "start Z";
    22, "精磨每次进刀量", "fine infeed";
    23, "精磨进给率", "fine feed";
    24, "精磨砂轮修整计数器", "fine strokes";
    25, "精磨余量", "fine allowance";
    28, "粗磨每次进刀量", "rough infeed";
    29, "粗磨进给率", "rough feed";
    30, "粗磨砂轮修整计数器", "rough strokes";
    32, "光磨次数", "spark-outs";
    33, "光磨进给率", "spark-out feed";
    36, "砂轮修整量", "dressing amount";
    37, "砂轮修整每次进给量", "dressing infeed";
    38, "砂轮修整进给率", "dressing feed";
    39, "砂轮修整用安全让刀", "dressing clearance";
    42, "安全让刀量", "clearance";
    43, "安全让刀每次进给量", "clearance infeed";
    44, "安全让刀进给率", "clearance feed";
    46, "中间点X轴坐标", "middle point X";
    47, "中间点Z轴坐标", "middle point Z";
    50, "单次磨削量", "present infeed";
    51, "进给率", "present feed";
    52, "起始点", "start";
    53, "终点", "end";
    54, "当前位置", "present size";
    56, "砂轮修磨量", "left to dress";
    57, "砂轮每次修磨量", "dressing step";
    58, "返回位置", "return to";
    59, "修整后返回位置", "return (dressed)";
    60, "当前砂轮位置", "wheel position";
    61, "修砂轮用计数器", "strokes left";
    62, "错误标志", "error flag";
    80, "修整起点", "dressing start X";
}

/// The titles of the sheets C0801 to C0803.
pub const SHEET_TITLES: [Text; 3] = [
    Text::new("立磨砂轮与修整", "wheel and dressing"),
    Text::new("立磨尺寸与进给", "sizes and feeds"),
    Text::new("立磨运行值", "run values"),
];

/// The English text of a sheet label such as `R18 X轴精磨尺寸`; `None` for a text that is not in the table.
#[must_use]
pub fn english_label(label: &str) -> Option<String> {
    let (number, words) = label.strip_prefix('R')?.split_once(' ')?;
    let number: u16 = number.parse().ok()?;
    let (_, name) = R_NAMES.iter().find(|(found, name)| *found == number && name.zh == words)?;
    Some(format!("R{number} {}", name.en))
}

/// The English text of a sheet title.
#[must_use]
pub fn english_title(title: &str) -> Option<&'static str> {
    SHEET_TITLES.iter().find(|sheet| sheet.zh == title).map(|sheet| sheet.en)
}
