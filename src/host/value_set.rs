//! Converts the values of a control to a file, and checks the values of a file for this control.
//! Source: spec K7.8.

use super::job_answer::{error_refusal, refusal};
use crate::controller::files::TransferValues;
use crate::defs::kind::Kind;
use crate::defs::param::{ParamAddress, Params};
use crate::defs::param_row;
use crate::link::files::{Refusal, RestoredValues};
use crate::link::media::TransferSet;
use crate::nc::work_offsets::TOOL_OFFSET_COUNT;
use crate::nc::{CommonVariables, CutterShape, OriginPlace};
use crate::store::Values;
use crate::units::PerAxis;

/// All values of the core.
#[must_use]
pub fn from_holdings(holdings: &TransferValues) -> Values {
    let mut values = Values { kind: Some(holdings.kind), ..Values::default() };
    for address in param_row::addresses() {
        if let Ok(value) = holdings.params.read(address) {
            values.params.insert(address.to_string(), value);
        }
    }
    let kept = holdings.memory.iter().filter(|(number, _)| CommonVariables::is_retained(*number));
    values.variables = kept.map(|(number, value)| (number as u16, value)).collect();
    let offsets = &holdings.work_offsets;
    for (index, (geometry, wear)) in offsets.geometry.iter().zip(&offsets.wear).enumerate() {
        values.offsets.insert(index as u8 + 1, (*geometry, *wear));
    }
    values.cutters =
        (1_u8..).zip(&offsets.cutter).map(|(number, cutter)| (number, (cutter.radius_mm, cutter.tip))).collect();
    let origins = (0..OriginPlace::COUNT).filter_map(OriginPlace::of_stored_index);
    values.work_offsets = origins.map(|place| (place.stored_index() as u8, offsets.origin(place))).collect();
    values
}

/// What a file of a set has that the set does not read: it would be ignored.
pub fn foreign_section(all: &Values, set: TransferSet) -> Option<(&'static str, &'static str)> {
    let params = set == TransferSet::Params;
    let sections = [
        (!all.params.is_empty() && !params, ("参数", "parameters")),
        (!all.variables.is_empty() && params, ("宏变量", "macro variables")),
        (!all.offsets.is_empty() || !all.cutters.is_empty(), ("刀补", "tool offsets")),
        (!all.work_offsets.is_empty(), ("工件坐标系", "work offsets")),
    ];
    sections.into_iter().find_map(|(found, name)| found.then_some(name))
}

/// Checks the values of a file: if one is not allowed, none is taken.
///
/// # Errors
/// The first value that is not allowed.
pub fn check_values(values: &Values, kind: Kind) -> Result<RestoredValues, Refusal> {
    if let Some(other) = values.kind.filter(|other| *other != kind) {
        let (from, to) = (other.name(), kind.name());
        return Err(refusal(
            format!("文件属于 {}，本机是 {}", from.zh, to.zh),
            format!("the file belongs to {}, this is {}", from.en, to.en),
        ));
    }
    let mut restored = RestoredValues::default();
    let (mut params, mut memory) = (Params::factory(kind), CommonVariables::default());
    for (key, value) in &values.params {
        let unknown = || refusal(format!("{key} 不是参数"), format!("{key} is not a parameter"));
        let at = ParamAddress::parse(key).ok_or_else(unknown)?;
        params.write(at, *value).map_err(|error| {
            refusal(format!("{key} = {value}：{}", error.text().zh()), format!("{key} = {value}: {error}"))
        })?;
        restored.params.push((at, *value));
    }
    for (number, value) in &values.variables {
        memory.set(u32::from(*number), Some(*value)).map_err(error_refusal)?;
        restored.variables.push((*number, *value));
    }
    let finite = |place: &PerAxis<f64>| place.0.iter().all(|value| value.is_finite() && value.abs() < 100_000.0);
    for (number, (geometry, wear)) in &values.offsets {
        if !(1..=TOOL_OFFSET_COUNT).contains(&usize::from(*number)) || !finite(geometry) || !finite(wear) {
            return Err(refusal(format!("刀补 {number} 的值不对"), format!("offset {number} has an invalid value")));
        }
        restored.offsets.push((usize::from(*number), *geometry, *wear));
    }
    for (number, &(radius_mm, tip)) in &values.cutters {
        let mut cutter = CutterShape::default();
        let set = cutter.set_radius(radius_mm).and_then(|()| cutter.set_tip(f64::from(tip)));
        if !(1..=TOOL_OFFSET_COUNT).contains(&usize::from(*number)) || set.is_err() {
            return Err(refusal(
                format!("刀补 {number} 的 R、T 不对"),
                format!("R or T of offset {number} is invalid"),
            ));
        }
        restored.cutters.push((usize::from(*number), radius_mm, tip));
    }
    for (index, origin) in &values.work_offsets {
        match OriginPlace::of_stored_index(usize::from(*index)) {
            Some(place) if finite(origin) => restored.work_offsets.push((place.stored_index(), *origin)),
            Some(_) | None => {
                let (zh, en) =
                    (format!("坐标系 {index} 的值不对"), format!("work offset {index} has an invalid value"));
                return Err(refusal(zh, en));
            }
        }
    }
    Ok(restored)
}
