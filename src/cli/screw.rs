//! `kt830 screw`: imports, shows or clears a leadscrew compensation table in the retained data.
//! Source: spec B7.

use super::args::{Screw, Shared};
use super::{CallError, FINE, out};
use crate::controller::Effect;
use crate::defs::screw::ScrewTable;
use crate::defs::text::Lang;
use crate::runtime::keeper::Keeper;
use crate::store::DataDir;

/// Reads a compensation table.
///
/// # Errors
/// The file cannot be read, or a line is invalid.
pub fn read(path: &std::path::Path, lang: Lang) -> Result<ScrewTable, CallError> {
    let bytes =
        std::fs::read(path).map_err(|error| CallError::new(format!("{}: {error}; check the path", path.display())))?;
    let text = crate::store::decode(&bytes).map_err(|error| CallError::new(format!("{}: {error}", path.display())))?;
    ScrewTable::parse(&text.text)
        .map_err(|fault| CallError::new(format!("{}:{}: {}", path.display(), fault.line, fault.said.get(lang))))
}

/// Shows, imports or clears the table.
///
/// # Errors
/// The data cannot be opened or written, or the file is invalid; then nothing is changed.
pub fn screw(shared: &Shared, call: &Screw) -> Result<u8, CallError> {
    let table = match &call.file {
        Some(path) => Some(read(path, shared.lang)?),
        None => call.clear.then(ScrewTable::default),
    };
    let data = DataDir::resolve(shared.data.as_deref()).map_err(CallError::new)?;
    let (mut keeper, found) = Keeper::open(data.root(), shared.kind).map_err(CallError::new)?;
    let shown = match table {
        Some(table) => {
            keeper.commit(&[Effect::Screw(call.axis, table.clone())]).map_err(CallError::new)?;
            table
        }
        None => found.retained.screws[call.axis].clone(),
    };
    out(format!("# {} 位置,反向间隙,螺距误差 position,backlash,pitch error mm", call.axis));
    out(shown.text().trim_end());
    Ok(FINE)
}
