//! `kt830 screw`: imports, shows or clears a leadscrew compensation table in the retained data.
//! Source: spec B7.

use std::path::Path;

use super::args::{LeadscrewArgs, SharedArgs};
use super::{CallError, SUCCESS, print_line, setup};
use crate::controller::StorageRequest;
use crate::defs::leadscrew::LeadscrewCompensation;
use crate::defs::text::Lang;
use crate::host::retained_store::RetainedStore;
use crate::store::TEXT_LIMIT;

fn read_table(path: &Path, lang: Lang) -> Result<LeadscrewCompensation, CallError> {
    let name = path.display();
    let read = setup::read_bounded(path, TEXT_LIMIT);
    let bytes = read.map_err(|error| CallError::new(format!("{name}: {error}; check the path")))?;
    let text = crate::store::decode(&bytes).map_err(CallError::at(name))?;
    LeadscrewCompensation::parse(&text.text)
        .map_err(|fault| CallError::new(format!("{}:{}: {}", path.display(), fault.line, fault.message.get(lang))))
}

/// Shows, imports or clears the table.
///
/// # Errors
/// The data cannot be opened or written, or the file is invalid; then nothing is changed.
pub fn screw(shared: &SharedArgs, call: &LeadscrewArgs) -> Result<u8, CallError> {
    let read = call.file.as_ref().map(|path| read_table(path, shared.lang)).transpose()?;
    let table = read.or_else(|| call.clear.then(LeadscrewCompensation::default));
    let data = setup::data_dir(shared)?;
    let (mut store, found) = RetainedStore::open(data.root(), shared.kind).map_err(CallError::new)?;
    let shown = match table {
        Some(table) => {
            store.commit(&[StorageRequest::LeadscrewTable(call.axis, table.clone())]).map_err(CallError::new)?;
            table
        }
        None => found.retained.leadscrew_tables[call.axis].clone(),
    };
    print_line(format!("# {} 位置,反向间隙,螺距误差 position,backlash,pitch error mm", call.axis));
    print_line(shown.to_text().trim_end());
    Ok(SUCCESS)
}
