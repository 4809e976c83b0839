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
    let table = LeadscrewCompensation::parse(&text.text)
        .map_err(|fault| CallError::new(format!("{}:{}: {}", path.display(), fault.line, fault.message.get(lang))))?;
    if table.points().is_empty() {
        return Err(CallError::new(format!("{}: contains no points; --clear removes a table", path.display())));
    }
    Ok(table)
}

/// Shows, imports or clears the table.
///
/// # Errors
/// The data cannot be opened or written, are those of a real machine, or the file is invalid; then nothing is changed.
pub fn screw(shared: &SharedArgs, call: &LeadscrewArgs) -> Result<u8, CallError> {
    let read = call.file.as_ref().map(|path| read_table(path, shared.lang)).transpose()?;
    let table = read.or_else(|| call.clear.then(LeadscrewCompensation::default));
    let data = setup::data_dir(shared)?;
    let shown = match table {
        Some(table) => {
            setup::refuse_real_data(&data, "its table is imported on its parameter page, with the password")?;
            let (mut store, _) = RetainedStore::open(data.root(), shared.kind).map_err(CallError::new)?;
            store.commit(&[StorageRequest::LeadscrewTable(call.axis, table.clone())]).map_err(CallError::new)?;
            table
        }
        None => {
            let found = RetainedStore::read_only(data.root(), shared.kind);
            found.map_or_else(LeadscrewCompensation::default, |found| found.leadscrew_tables[call.axis].clone())
        }
    };
    print_line(format!("# {} 位置,反向间隙,螺距误差 position,backlash,pitch error mm", call.axis));
    print_line(shown.to_text().trim_end());
    Ok(SUCCESS)
}
