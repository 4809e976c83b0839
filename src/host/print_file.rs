//! The lines that programs print (DPRNT): one file a day, beside the screenshots. Source: spec B3.

use std::fs::OpenOptions;
use std::io::{self, Write};
use std::path::Path;

use crate::controller::StorageRequest;
use crate::defs::date::{DateTime, YEARS};
use crate::defs::text::arg::Arg;

/// The lines among storage requests, each with its date.
pub fn printed_lines(requests: &[StorageRequest]) -> impl Iterator<Item = (DateTime, &Arg)> {
    requests.iter().filter_map(|request| match request {
        StorageRequest::PrintLine(date, text) => Some((*date, text)),
        _ => None,
    })
}

/// Appends lines to the file of their day, `DPRNT-20261124.TXT`; to `DPRNT.TXT` while the date is unknown.
///
/// # Errors
/// The folder or file cannot be written.
pub fn append<'a>(folder: &Path, lines: impl Iterator<Item = (DateTime, &'a Arg)>) -> io::Result<()> {
    for (date, text) in lines {
        std::fs::create_dir_all(folder)?;
        let [year, month, day, ..] = date.parts();
        let name = match YEARS.contains(&year) {
            true => format!("DPRNT-{year:04}{month:02}{day:02}.TXT"),
            false => "DPRNT.TXT".to_owned(),
        };
        let path = folder.join(name);
        let mut file = OpenOptions::new().append(true).create(true).open(path)?;
        file.write_all(format!("{}\r\n", text.as_name()).as_bytes())?;
    }
    Ok(())
}
