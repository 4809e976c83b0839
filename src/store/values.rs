//! Parameters, macro variables, tool offsets and work offsets as a readable file.
//! Source: spec K7.8.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::ron_file::{self, ChecksumPolicy, RonError};
use crate::defs::kind::Kind;
use crate::units::PerAxis;

/// Values of a control. Values missing in a file stay unchanged.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Values {
    /// The kind of machine of the parameters.
    pub kind: Option<Kind>,
    /// Parameters by address, such as `P16.0`.
    pub params: BTreeMap<String, f64>,
    /// Macro variables by number.
    pub variables: BTreeMap<u16, f64>,
    /// Geometry and wear of the tool offsets 1 to 16, radius mm.
    pub offsets: BTreeMap<u8, (PerAxis<f64>, PerAxis<f64>)>,
    /// Radius (mm) and tip of the circles of the tool offsets 1 to 16.
    pub cutters: BTreeMap<u8, (f64, u8)>,
    /// Work offsets: 0 is G54, 6 to 53 G54.1 P1 to P48, 54 the external one; machine coordinates, radius mm.
    #[serde(rename = "frames")]
    pub work_offsets: BTreeMap<u8, PerAxis<f64>>,
}

impl Values {
    /// Reads a file.
    ///
    /// # Errors
    /// The file is missing or invalid; the error names line and column.
    pub fn read(path: &Path) -> Result<Self, RonError> {
        Ok(ron_file::read(path, ChecksumPolicy::Lenient)?.value)
    }

    /// Writes a file.
    ///
    /// # Errors
    /// A disk error; an old file stays.
    pub fn write(&self, path: &Path) -> Result<(), RonError> {
        ron_file::write_shared(path, ChecksumPolicy::Lenient, self)
    }

    /// The RON text for an archive.
    ///
    /// # Errors
    /// A value that RON cannot express.
    pub fn to_text(&self) -> Result<String, ron::Error> {
        ron::ser::to_string_pretty(self, ron::ser::PrettyConfig::new().new_line("\n"))
    }

    /// Reads the RON text of an archive.
    ///
    /// # Errors
    /// The fault with line and column.
    pub fn from_text(text: &str) -> Result<Self, ron::error::SpannedError> {
        ron::from_str(text)
    }
}
