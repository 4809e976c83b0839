//! The part that the last cycle has finished: its nominal size, its limits and its measured size.
//! Source: spec K4.5, K7.2, H8.

use super::cycle_times::CycleTimes;
use super::simulation::{PartSize, SimView};
use crate::defs::page_meaning::{PageMeaning, SizeKind};
use crate::defs::page_text::PageText;
use crate::defs::param::{self, NumberParam, Params};
use crate::defs::part_verdict::PartVerdict;
use crate::units::{Axis, Micros};

/// The nominal size of a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NominalSize {
    /// What is measured; `None` if only a parameter names the size, and the page does not say what it is.
    pub kind: Option<SizeKind>,
    /// Nominal size, mm.
    pub mm: f64,
    /// Least and greatest size, mm; `None` without a tolerance.
    pub limits: Option<(f64, f64)>,
}

/// The part that the last cycle has finished.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartResult {
    /// Its number in the part count.
    pub number: u32,
    /// The program.
    pub program: u32,
    /// When the cycle ended.
    pub ended_at: Micros,
    /// How long the cycle and its phases took.
    pub times: CycleTimes,
    /// Nominal size and limits, as in force at the end.
    pub nominal: Option<NominalSize>,
    /// The size that the program has measured, or that the operator has typed on its page, mm.
    pub measured: Option<f64>,
    /// The size that the operator has measured and typed, mm.
    pub typed: Option<f64>,
    /// A gauge has ended an infeed of the cycle by its signal: the size is that of its setting.
    pub gauged: bool,
    /// The first part since the last dressing: what is off is no wear that a dressing takes back.
    pub is_wheel_fresh: bool,
    /// The tool offset in force at the end of the cycle; none once it has been changed otherwise.
    pub offset: Option<OffsetInForce>,
    /// What the operator has added to the wear of that offset because of this part, mm as displayed.
    pub corrected: Option<f64>,
}

/// The tool offset that decides the size of a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OffsetInForce {
    /// 1 to 16.
    pub number: usize,
    /// The axis that feeds the wheel into the part.
    pub axis: Axis,
    /// Displayed value of a millimetre of that axis: 2 for diameters.
    pub displayed_per_mm: f64,
    /// Machine coordinate of the work zero of that axis, mm, with the offset: a correction is for this one alone.
    pub work_zero: f64,
}

/// What the operator does with the part of the last cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PartCommand {
    /// Types the size that was measured.
    TypeSize {
        /// The end of the cycle of the part that was measured.
        ended_at: Micros,
        /// mm.
        mm: f64,
    },
    /// Takes over a correction.
    Correct {
        /// The end of the cycle of the part that the correction is for.
        ended_at: Micros,
        /// mm as displayed, added to the wear of the offset in force.
        increment: f64,
    },
}

/// Greatest distance of a typed size from the nominal size, mm: a missing digit is noticed.
pub const TYPED_SIZE_RANGE: f64 = 1.0;
/// Greatest correction of the wear by a part, mm as displayed: what is farther off has another cause.
pub const MAX_CORRECTION: f64 = 0.2;
/// A size this close to the middle of its limits needs no correction; part of the tolerance.
const DEAD_BAND: f64 = 0.1;
/// Resolution of a correction, mm as displayed: what the screen shows is what is added.
const RESOLUTION: f64 = 0.001;

/// What the size of a part says of the wheel's offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CorrectionAdvice {
    /// Nothing: no size, no nominal size, a length, a part that no offset mends, or no offset in force.
    Unknown,
    /// The size is near the middle of its limits.
    Centred,
    /// A gauge or the program has measured it: its setting decides the size, and the program corrects the offset.
    ByGauge,
    /// The wheel has worn since its dressing: an offset that is corrected for wear is wrong after the next dressing.
    MayBeWear,
    /// Farther off than an offset explains, mm as displayed.
    TooFar(f64),
    /// To add to the wear of the offset in force, mm as displayed.
    Add(OffsetInForce, f64),
    /// Has been added, mm as displayed.
    Done(f64),
}

/// The values that sizes are taken from.
pub struct SizeValues<'a, V> {
    /// The parameters.
    pub params: &'a Params,
    /// The page text of the program.
    pub page: Option<&'a PageText>,
    /// The value of a macro variable.
    pub variable: V,
}

impl<V: Fn(u16) -> Option<f64>> SizeValues<'_, V> {
    /// The variable that a parameter names; `None` if it names none.
    fn of_param(&self, row: NumberParam) -> Option<u16> {
        Some(self.params.get(row) as u16).filter(|variable| *variable > 0)
    }

    fn of_page(&self, meaning: PageMeaning) -> Option<u16> {
        self.page?.variable(|found| found == meaning)
    }

    /// Nominal size and limits: P376 to P378, else what the page names.
    #[must_use]
    pub fn nominal(&self) -> Option<NominalSize> {
        let kind_on_page = |variable: u16| {
            self.page?.rows().filter(|row| row.variable == variable).find_map(|row| match row.meaning() {
                Some(PageMeaning::Nominal(kind)) => Some(kind),
                _ => None,
            })
        };
        let variable = self.nominal_variable()?;
        let kind = kind_on_page(variable);
        let mm = (self.variable)(variable)?;
        let of_params = (self.params.get(param::TREND_LOWER), self.params.get(param::TREND_UPPER));
        let deviation = |meaning| self.of_page(meaning).and_then(&self.variable);
        let of_page = deviation(PageMeaning::LowerDeviation).zip(deviation(PageMeaning::UpperDeviation));
        let limits = Some(of_params).filter(|(lower, upper)| upper > lower).or(of_page);
        let limits = limits.filter(|(lower, upper)| upper >= lower);
        Some(NominalSize { kind, mm, limits: limits.map(|(lower, upper)| (mm + lower, mm + upper)) })
    }

    /// The variable of the nominal size: P376, else that of the page.
    fn nominal_variable(&self) -> Option<u16> {
        self.of_param(param::TREND_NOMINAL_VARIABLE).or_else(|| Some(self.page?.nominal()?.1))
    }

    /// The variable into which the operator types the measured size: that of the page, else P375.
    #[must_use]
    pub fn typed_variable(&self) -> Option<u16> {
        let of_page = self.nominal_variable().and_then(|finished| self.page?.measured_variable_of(finished));
        of_page.or_else(|| self.of_param(param::TREND_SIZE_VARIABLE))
    }

    fn measured_variable(&self) -> Option<u16> {
        self.of_param(param::TREND_SIZE_VARIABLE).or_else(|| self.of_page(PageMeaning::MeasuredSize))
    }

    /// Whether the program measures the part.
    #[must_use]
    pub fn is_measured(&self) -> bool {
        self.measured_variable().is_some()
    }

    /// The measured size: the variable of P375, else that of the page.
    #[must_use]
    pub fn measured(&self) -> Option<f64> {
        // An R parameter cannot be empty: 0 is not measured.
        (self.variable)(self.measured_variable()?).filter(|mm| mm.abs() > f64::EPSILON)
    }

    /// Parts between two dressings: P95, or what the page says; the smaller one if both do.
    #[must_use]
    pub fn dressing_interval(&self) -> Option<f64> {
        let of_page = self.of_page(PageMeaning::DressingInterval).and_then(&self.variable);
        let all = [Some(self.params.get(param::DRESSING_INTERVAL)), of_page];
        all.into_iter().flatten().filter(|parts| *parts > 0.0).min_by(f64::total_cmp)
    }
}

impl NominalSize {
    /// Whether a size is within the limits; `None` without limits. Rounding errors up to 1e-6 mm are tolerated.
    #[must_use]
    pub fn keeps(&self, size: f64) -> Option<bool> {
        self.limits.map(|(low, high)| size >= low - 1e-6 && size <= high + 1e-6)
    }

    /// The place of the simulated part that this size is compared with: on the surface nearest to it, the place farthest
    /// beyond the limits, or nearest to one; without limits the place farthest from it. A bar is turned to many sizes, and the place of a face is no length: they have none.
    #[must_use]
    pub fn compare<'a>(&self, sizes: &'a [PartSize]) -> Option<ComparedSize<'a>> {
        let is_same_kind = |size: &&PartSize| match self.kind {
            None => size.kind != SizeKind::Length,
            Some(SizeKind::Length) => false,
            Some(kind) => kind == size.kind,
        };
        let deviation = |size: &PartSize| (size.mm - self.mm).abs();
        let same = || sizes.iter().filter(|size| size.surface.is_some()).filter(is_same_kind);
        let nearest = same().min_by(|a, b| deviation(a).total_cmp(&deviation(b)))?;
        let on_surface = || same().filter(|size| size.surface == nearest.surface);
        let excess = |size: &PartSize| match self.limits {
            Some((low, high)) => (low - size.mm).max(size.mm - high),
            None => deviation(size),
        };
        let worst = on_surface().max_by(|a, b| excess(a).total_cmp(&excess(b)))?;
        let keeps_elsewhere = on_surface().any(|size| self.keeps(size.mm) == Some(true));
        let least_of = |(low, high): (f64, f64), size: &PartSize| (low.min(size.mm), high.max(size.mm));
        let spread = on_surface().fold((f64::INFINITY, f64::NEG_INFINITY), least_of);
        Some(ComparedSize { worst, keeps_elsewhere, spread })
    }
}

/// The worst place of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComparedSize<'a> {
    /// The place farthest beyond the limits, or nearest to one.
    pub worst: &'a PartSize,
    /// Some place of the surface is within the limits.
    pub keeps_elsewhere: bool,
    /// Least and greatest size of the surface, mm.
    pub spread: (f64, f64),
}

/// The size by which a part is judged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JudgedSize<'a> {
    /// The operator has measured it, mm.
    Typed(f64),
    /// The program has measured it, mm.
    Measured(f64),
    /// The simulated machine knows it.
    Simulated(ComparedSize<'a>),
}

impl JudgedSize<'_> {
    /// The middle of the sizes, mm; none if they differ by more than the tolerance: no offset mends that.
    fn middle(self, limits: Option<(f64, f64)>) -> Option<f64> {
        match self {
            Self::Typed(mm) | Self::Measured(mm) => Some(mm),
            Self::Simulated(ComparedSize { spread: (least, greatest), .. }) => {
                let fits = limits.is_none_or(|(low, high)| greatest - least <= high - low);
                fits.then(|| f64::midpoint(least, greatest))
            }
        }
    }

    /// The size, mm.
    #[must_use]
    pub const fn mm(self) -> f64 {
        match self {
            Self::Typed(mm) | Self::Measured(mm) => mm,
            Self::Simulated(compared) => compared.worst.mm,
        }
    }
}

impl PartResult {
    /// What its size says of the offset: the size is brought to the middle of its limits.
    #[must_use]
    pub fn advice(&self, simulated: Option<&SimView>) -> CorrectionAdvice {
        if let Some(done) = self.corrected {
            return CorrectionAdvice::Done(done);
        }
        // No offset mends a part that is spoilt, or out of its limits in some places only.
        let is_spoilt = matches!(self.verdict(simulated), PartVerdict::Spoilt(_) | PartVerdict::Out { partly: true });
        let Some((nominal, size)) = self.nominal.zip(self.judged_size(simulated)).filter(|_| !is_spoilt) else {
            return CorrectionAdvice::Unknown;
        };
        // A diameter changes by twice the way of the wheel.
        let sides = match nominal.kind {
            Some(SizeKind::Diameter) => 2.0,
            Some(SizeKind::Height) => 1.0,
            Some(SizeKind::Length) | None => return CorrectionAdvice::Unknown,
        };
        let Some(offset) = self.offset else { return CorrectionAdvice::Unknown };
        if self.gauged || self.measured.is_some() {
            return CorrectionAdvice::ByGauge;
        }
        let target = nominal.limits.map_or(nominal.mm, |(low, high)| f64::midpoint(low, high));
        let Some(middle) = size.middle(nominal.limits) else { return CorrectionAdvice::Unknown };
        let off = (target - middle) / sides * offset.displayed_per_mm;
        // To follow every micrometre of scatter makes it larger.
        let span = nominal.limits.map_or(0.0, |(low, high)| high - low);
        let least = (span * DEAD_BAND / sides * offset.displayed_per_mm).max(RESOLUTION / 2.0);
        let increment = (off / RESOLUTION).round() * RESOLUTION;
        match off.abs() {
            off if off < least - 1e-9 => CorrectionAdvice::Centred,
            off if off > MAX_CORRECTION + 1e-9 => CorrectionAdvice::TooFar(increment),
            _ if !self.is_wheel_fresh => CorrectionAdvice::MayBeWear,
            _ => CorrectionAdvice::Add(offset, increment),
        }
    }

    /// The size by which the part is judged: the one that the operator has typed, the measured one, else that of the
    /// simulated part at the end of its cycle.
    #[must_use]
    pub fn judged_size<'a>(&self, simulated: Option<&'a SimView>) -> Option<JudgedSize<'a>> {
        let known = || self.nominal?.compare(&simulated?.finished_sizes);
        let measured = self.typed.map(JudgedSize::Typed).or(self.measured.map(JudgedSize::Measured));
        measured.or_else(|| known().map(JudgedSize::Simulated))
    }

    /// Whether the part is good.
    #[must_use]
    pub fn verdict(&self, simulated: Option<&SimView>) -> PartVerdict {
        if let Some(defect) = simulated.and_then(|view| view.finished_defects.first()) {
            return PartVerdict::Spoilt(*defect);
        }
        let Some(size) = self.judged_size(simulated) else { return PartVerdict::NotMeasured };
        match self.nominal.and_then(|nominal| nominal.keeps(size.mm())) {
            Some(true) => PartVerdict::Good,
            Some(false) => {
                let partly = matches!(size, JudgedSize::Simulated(compared) if compared.keeps_elsewhere);
                PartVerdict::Out { partly }
            }
            None => PartVerdict::NoTolerance,
        }
    }
}
