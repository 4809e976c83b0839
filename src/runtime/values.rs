//! Converts the values of a control to a file, and checks the values of a file for this control.
//! Source: spec K7.8.

use super::office::because;
use crate::controller::files::Holdings;
use crate::defs::kind::Kind;
use crate::defs::param::{ParamAddress, Params};
use crate::defs::param_row;
use crate::defs::text::Said;
use crate::link::files::{Refusal, Restored};
use crate::nc::Memory;
use crate::nc::frames::{OFFSETS, WORK_FRAMES};
use crate::store::Values;
use crate::units::PerAxis;

/// All values of the core.
#[must_use]
pub fn of(holdings: &Holdings) -> Values {
    let mut values = Values { kind: Some(holdings.kind), ..Values::default() };
    for row in param_row::rows(holdings.kind) {
        if let Ok(value) = holdings.params.read(row.at) {
            values.params.insert(row.at.to_string(), value);
        }
    }
    let kept = holdings.memory.iter().filter(|(number, _)| Memory::is_retained(*number));
    values.variables = kept.map(|(number, value)| (number as u16, value)).collect();
    let frames = &holdings.frames;
    for (index, (geometry, wear)) in frames.geometry.iter().zip(&frames.wear).enumerate() {
        values.offsets.insert(index as u8 + 1, (*geometry, *wear));
    }
    values.frames = frames.work.iter().enumerate().map(|(index, origin)| (index as u8, *origin)).collect();
    values
}

/// Checks the values of a file: if one is not allowed, none is taken.
///
/// # Errors
/// The first value that is not allowed.
pub fn check(values: &Values, kind: Kind) -> Result<Restored, Refusal> {
    if let Some(other) = values.kind.filter(|other| *other != kind) {
        let (from, to) = (other.name(), kind.name());
        return Err(Refusal::Because(Said::new(
            format!("文件属于 {}，本机是 {}", from.zh, to.zh),
            format!("the file belongs to {}, this is {}", from.en, to.en),
        )));
    }
    let mut restored = Restored::default();
    let (mut params, mut memory) = (Params::factory(kind), Memory::default());
    for (key, value) in &values.params {
        let unknown = || Refusal::Because(Said::new(format!("{key} 不是参数"), format!("{key} is no parameter")));
        let at = ParamAddress::parse(key).ok_or_else(unknown)?;
        params.write(at, *value).map_err(|error| {
            Refusal::Because(Said::new(format!("{key} = {value}：{}", error.zh()), format!("{key} = {value}: {error}")))
        })?;
        restored.params.push((at, *value));
    }
    for (number, value) in &values.variables {
        memory.set(u32::from(*number), Some(*value)).map_err(|error| because(&error))?;
        restored.variables.push((*number, *value));
    }
    let finite = |place: &PerAxis<f64>| place.0.iter().all(|value| value.is_finite() && value.abs() < 100_000.0);
    for (number, (geometry, wear)) in &values.offsets {
        if !(1..=OFFSETS).contains(&usize::from(*number)) || !finite(geometry) || !finite(wear) {
            return Err(Refusal::Because(Said::new(
                format!("刀补 {number} 的值不对"),
                format!("offset {number} is wrong"),
            )));
        }
        restored.offsets.push((usize::from(*number), *geometry, *wear));
    }
    for (index, origin) in &values.frames {
        if usize::from(*index) >= WORK_FRAMES || !finite(origin) {
            let g = 54 + u32::from(*index);
            return Err(Refusal::Because(Said::new(format!("坐标系 G{g} 的值不对"), format!("frame G{g} is wrong"))));
        }
        restored.frames.push((usize::from(*index), *origin));
    }
    Ok(restored)
}
