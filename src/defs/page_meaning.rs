//! What the values of a grinding page mean to the control, told by the words of their labels: sizes of the part, the
//! dressing interval, dressing points, and the unit of each. The screen shows with them what a program makes and where
//! it dresses. Source: spec K7.2, K7.4, K4.2, K5.17, H6.

use super::page_text::{PageText, PageTextRow};
use super::text::{Lang, Text};
use crate::units::Axis;

/// What a size is measured on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SizeKind {
    /// A diameter, outside or of a bore.
    Diameter,
    /// The height of a plane.
    Height,
    /// A length along the part, or the place of a face.
    Length,
}

/// The meaning of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PageMeaning {
    /// 成品直径, 成品孔径, 成品高度, 成品长度: the nominal size of the part.
    Nominal(SizeKind),
    /// 上偏差: upper deviation from the nominal size.
    UpperDeviation,
    /// 下偏差: lower deviation.
    LowerDeviation,
    /// 实测尺寸: the size that the program has measured.
    MeasuredSize,
    /// 修整间隔: parts between two dressings.
    DressingInterval,
    /// 毛坯直径: diameter of the blank.
    BlankDiameter,
    /// 粗磨余量: where roughing begins, left on the diameter.
    RoughAllowance,
    /// 精磨余量: left on the diameter for finishing.
    FinishAllowance,
    /// 粗磨速度: feed of roughing.
    RoughFeed,
    /// 精磨速度: feed of finishing.
    FinishFeed,
    /// 光磨时间: spark-out.
    SparkOut,
    /// 头架 0低速 1高速: the speed of the headstock.
    HeadstockSpeed,
    /// 修整点 X: the dressing point of an axis by value; for a new wheel on the wheel axis.
    DressingPoint(Axis),
    /// 精修量: depth of the last pass of a dressing.
    DressingDepth,
    /// 精修速度, 修整速度: traverse feed of the last pass of a dressing.
    DressingFeed,
    /// 累计修整量: what was dressed off since the wheel was new.
    DressedAmount,
}

/// The words of a label and what they mean.
const WORDS: [(&str, PageMeaning); 19] = [
    ("成品直径", PageMeaning::Nominal(SizeKind::Diameter)),
    ("成品孔径", PageMeaning::Nominal(SizeKind::Diameter)),
    ("成品高度", PageMeaning::Nominal(SizeKind::Height)),
    ("成品长度", PageMeaning::Nominal(SizeKind::Length)),
    ("上偏差", PageMeaning::UpperDeviation),
    ("下偏差", PageMeaning::LowerDeviation),
    ("实测尺寸", PageMeaning::MeasuredSize),
    ("修整间隔", PageMeaning::DressingInterval),
    ("累计修整量", PageMeaning::DressedAmount),
    ("精修量", PageMeaning::DressingDepth),
    ("精修速度", PageMeaning::DressingFeed),
    ("修整速度", PageMeaning::DressingFeed),
    ("毛坯直径", PageMeaning::BlankDiameter),
    ("粗磨余量", PageMeaning::RoughAllowance),
    ("精磨余量", PageMeaning::FinishAllowance),
    ("粗磨速度", PageMeaning::RoughFeed),
    ("精磨速度", PageMeaning::FinishFeed),
    ("光磨时间", PageMeaning::SparkOut),
    ("头架 0低速 1高速", PageMeaning::HeadstockSpeed),
];
/// A stage between roughing and finishing, which has no meaning of its own.
const SEMI_FINISHING: &str = "半精";
/// A size that was measured, by the program or by the operator who types it.
const MEASURED: &str = "实测";
/// What is to be reached.
const FINISHED: &str = "成品";
/// The word before the letter of an axis.
const DRESSING_POINT: &str = "修整点";

/// What the control or the operator finds out, and what belongs to wheel and dresser.
const STATE_WORDS: [&str; 6] = [MEASURED, "累计", DRESSING_POINT, "金刚", "砂轮直径", "砂轮宽度"];

/// What a label says of a whole number: a count, a mode, a number of an offset.
const WHOLE_NUMBERS: [&str; 8] = ["次数", "方式", "件数", "计数", "刀补号", "间隔", "模式", "编号"];

/// Units as a label may end with them, in Chinese and in English, and as the page shows them behind the value.
const WRITTEN_UNITS: [(&str, &str, Text); 9] = [
    ("mm/min", "mm/min", MM_PER_MINUTE),
    ("mm/r", "mm/r", Text::new("mm/r", "mm/r")),
    ("r/min", "r/min", Text::new("r/min", "r/min")),
    ("m/s", "m/s", Text::new("m/s", "m/s")),
    ("mm", "mm", MILLIMETRES),
    ("ms", "ms", Text::new("ms", "ms")),
    ("秒", "s", SECONDS),
    ("次/分", "1/min", PER_MINUTE),
    ("件", "parts", Text::new("件", "parts")),
];

/// What a label without a written unit says of it, besides its meaning: the first word that it contains counts.
const UNIT_WORDS: [(&[&str], Text); 7] = [
    (&["转速"], Text::new("r/min", "r/min")),
    (&["线速度"], Text::new("m/s", "m/s")),
    (&["磨速度", "修速度", "修整速度", "工作台速度", "横向速度", "进给率"], MM_PER_MINUTE),
    (&["频率"], PER_MINUTE),
    (&["时间"], SECONDS),
    (&["角度"], Text::new("°", "°")),
    (&LENGTH_WORDS, MILLIMETRES),
];

const MILLIMETRES: Text = Text::new("mm", "mm");
const MM_PER_MINUTE: Text = Text::new("mm/min", "mm/min");
const SECONDS: Text = Text::new("s", "s");
const PER_MINUTE: Text = Text::new("1/min", "1/min");

const LENGTH_WORDS: [&str; 36] = [
    "修整点",
    "直径",
    "半径",
    "位置",
    "余量",
    "高度",
    "长度",
    "宽",
    "越程",
    "行程",
    "起点",
    "终点",
    "补偿",
    "偏差",
    "偏置",
    "换向点",
    "极限",
    "磨损",
    "每次",
    "每层",
    "尺寸",
    "坐标",
    "距离",
    "让刀",
    "修整量",
    "精修量",
    "修磨量",
    "磨削量",
    "回退量",
    "毛坯",
    "成品",
    "外边",
    "接触",
    "金刚石",
    "滚轮",
    "端",
];

impl PageMeaning {
    /// The unit of a value with this meaning; none for a count of parts.
    #[must_use]
    pub const fn unit(self) -> Option<Text> {
        match self {
            Self::DressingInterval | Self::HeadstockSpeed => None,
            Self::RoughFeed | Self::FinishFeed | Self::DressingFeed => Some(MM_PER_MINUTE),
            Self::SparkOut => Some(SECONDS),
            Self::Nominal(_)
            | Self::UpperDeviation
            | Self::LowerDeviation
            | Self::MeasuredSize
            | Self::DressingPoint(_)
            | Self::BlankDiameter
            | Self::RoughAllowance
            | Self::FinishAllowance
            | Self::DressingDepth
            | Self::DressedAmount => Some(MILLIMETRES),
        }
    }
}

impl PageTextRow {
    /// What the value means; none for one that only the program knows.
    #[must_use]
    pub fn meaning(&self) -> Option<PageMeaning> {
        if let Some(rest) = self.label.strip_prefix(DRESSING_POINT) {
            return rest.trim_start().chars().next().and_then(Axis::from_letter).map(PageMeaning::DressingPoint);
        }
        // 半精磨速度 is no 精磨速度.
        let found = WORDS.iter().find(|(word, _)| self.label.contains(word) && !self.label.contains(SEMI_FINISHING));
        found.map(|(_, meaning)| *meaning)
    }

    /// Whether the value is found out (measured, counted up, a dressing point) or belongs to the wheel: no order asks for it.
    #[must_use]
    pub fn is_state(&self) -> bool {
        STATE_WORDS.iter().any(|word| self.label.contains(word))
    }

    /// The unit of the value, as its label tells it; none for a count, a switch or a mode, and where it does not tell.
    #[must_use]
    pub fn unit(&self) -> Option<Text> {
        let written = WRITTEN_UNITS.iter().find(|(zh, ..)| ends_with_unit(&self.label, zh));
        // A speed without more (of a wheel, a headstock, a limit) has no unit; it is no length.
        let is_speed = self.label.contains('速');
        let has = |words: &[&str]| words.iter().any(|word| self.label.contains(word));
        let told = || UNIT_WORDS.iter().find(|(words, unit)| has(words) && !(is_speed && *unit == MILLIMETRES));
        match written {
            Some((.., unit)) => Some(*unit),
            None if self.is_whole_number() => None,
            None => self.meaning().map_or_else(|| told().map(|(_, unit)| *unit), PageMeaning::unit),
        }
    }

    /// The label in a language, without the unit that it ends with.
    #[must_use]
    pub fn name_in(&self, lang: Lang) -> &str {
        let label = self.label_in(lang);
        let cut = |unit: &str| label.strip_suffix(unit).filter(|_| ends_with_unit(label, unit));
        WRITTEN_UNITS
            .iter()
            .find_map(|(zh, en, _)| cut(zh).or(cut(en)))
            .map_or(label, |name| name.trim_end_matches([' ', ',']))
    }

    /// Whether the label speaks of a count, a switch (`头架 0低速 1高速`, `1用G27修整点`) or a mode.
    #[must_use]
    pub fn is_whole_number(&self) -> bool {
        let digits = self.label.as_bytes().windows(2).filter(|pair| pair[0].is_ascii_digit() && !pair[1].is_ascii());
        digits.count() > 0 || WHOLE_NUMBERS.iter().any(|word| self.label.contains(word))
    }
}

impl PageText {
    /// The variable with a meaning; none if several have it: a part with several sizes has none that stands for it.
    #[must_use]
    pub fn variable(&self, meaning: impl Fn(PageMeaning) -> bool) -> Option<u16> {
        let mut found = self.rows().filter(|row| row.meaning().is_some_and(&meaning));
        let first = found.next()?;
        found.next().is_none().then_some(first.variable)
    }

    /// What is measured on the part, and the variable of its nominal size.
    #[must_use]
    pub fn nominal(&self) -> Option<(SizeKind, u16)> {
        let wanted = self.rows().filter(|row| !row.label.contains(MEASURED));
        let mut found = wanted.filter_map(|row| match row.meaning()? {
            PageMeaning::Nominal(kind) => Some((kind, row.variable)),
            _ => None,
        });
        let first = found.next()?;
        found.next().is_none().then_some(first)
    }
}

impl PageText {
    /// The variable of a size that the operator measures and types: 实测槽底高度 belongs to 槽底成品高度.
    #[must_use]
    pub fn measured_variable_of(&self, finished: u16) -> Option<u16> {
        let wanted = self.rows().find(|row| row.variable == finished)?;
        let typed = self.rows().filter_map(|row| Some((row, row.label.strip_prefix(MEASURED)?)));
        typed.filter(|(_, name)| bare_name(name).eq(bare_name(&wanted.label))).map(|(row, _)| row.variable).next()
    }
}

/// The letters of a label without what measured and finished sizes do not share.
fn bare_name(label: &str) -> impl Iterator<Item = char> {
    let mut rest = label;
    std::iter::from_fn(move || {
        while let Some(cut) = rest.strip_prefix(FINISHED) {
            rest = cut;
        }
        let letter = rest.chars().next()?;
        rest = &rest[letter.len_utf8()..];
        Some(letter)
    })
    .filter(|letter| !letter.is_whitespace())
}

/// Whether a label ends with a unit behind a blank.
fn ends_with_unit(label: &str, unit: &str) -> bool {
    label.strip_suffix(unit).is_some_and(|name| name.ends_with(' '))
}
