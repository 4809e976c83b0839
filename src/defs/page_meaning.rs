//! What the values of a grinding page mean to the control, told by the words of their labels: sizes of the part, the
//! dressing interval, dressing points. The screen shows with them what a program makes and where it dresses.
//! Source: spec K7.2, K7.4, K4.2, K5.17.

use super::page_text::{PageText, PageTextRow};
use crate::units::Axis;

/// What a size is measured on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SizeKind {
    /// A diameter.
    Diameter,
    /// The height of a plane.
    Height,
    /// A length along the part, or the place of a face.
    Length,
}

/// The meaning of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PageMeaning {
    /// 成品直径, 成品高度, 成品长度: the nominal size of the part.
    Nominal(SizeKind),
    /// 上偏差: upper deviation from the nominal size.
    UpperDeviation,
    /// 下偏差: lower deviation.
    LowerDeviation,
    /// 实测尺寸: the size that the program has measured.
    MeasuredSize,
    /// 修整间隔: parts between two dressings.
    DressingInterval,
    /// 修整点 X: the dressing point of an axis by value; for a new wheel on the wheel axis.
    DressingPoint(Axis),
    /// 累计修整量: what was dressed off since the wheel was new.
    DressedAmount,
}

/// The words of a label and what they mean.
const WORDS: [(&str, PageMeaning); 8] = [
    ("成品直径", PageMeaning::Nominal(SizeKind::Diameter)),
    ("成品高度", PageMeaning::Nominal(SizeKind::Height)),
    ("成品长度", PageMeaning::Nominal(SizeKind::Length)),
    ("上偏差", PageMeaning::UpperDeviation),
    ("下偏差", PageMeaning::LowerDeviation),
    ("实测尺寸", PageMeaning::MeasuredSize),
    ("修整间隔", PageMeaning::DressingInterval),
    ("累计修整量", PageMeaning::DressedAmount),
];
/// The word before the letter of an axis.
const DRESSING_POINT: &str = "修整点";

impl PageTextRow {
    /// What the value means; none for one that only the program knows.
    #[must_use]
    pub fn meaning(&self) -> Option<PageMeaning> {
        if let Some(rest) = self.label.strip_prefix(DRESSING_POINT) {
            return rest.trim_start().chars().next().and_then(Axis::from_letter).map(PageMeaning::DressingPoint);
        }
        WORDS.iter().find(|(word, _)| self.label.contains(word)).map(|(_, meaning)| *meaning)
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
        let mut found = self.rows().filter_map(|row| match row.meaning()? {
            PageMeaning::Nominal(kind) => Some((kind, row.variable)),
            _ => None,
        });
        let first = found.next()?;
        found.next().is_none().then_some(first)
    }
}
