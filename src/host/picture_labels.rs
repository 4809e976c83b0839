//! D00nn.RON, the optional file beside the picture of a grinding page: where the picture shows the variables.
//! Source: spec K7.3, K7.4.

use serde::Deserialize;

use crate::defs::kind::Dialect;
use crate::defs::text::LocalizedText;
use crate::defs::variable_name;
use crate::link::screens::{FileFault, PictureLabel};

/// Size of a page picture, pixels.
pub const PICTURE_SIZE: (u32, u32) = (200, 400);

/// A row of D00nn.RON.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LabelRow {
    /// `#520`, `R18`.
    variable: String,
    /// Left, top, right, bottom, pixels.
    area: (u16, u16, u16, u16),
}

/// The text of D00nn.RON with these places, a row each.
#[must_use]
pub fn picture_labels_text(labels: &[PictureLabel], dialect: Dialect) -> String {
    let row = |label: &PictureLabel| {
        let variable = variable_name::variable_name(u32::from(label.variable), dialect);
        format!("    (variable: \"{variable}\", area: {:?}),\n", label.area)
    };
    format!("[\n{}]\n", labels.iter().map(row).collect::<String>())
}

/// Parses the places of the variables in a picture: `[(variable: "#520", area: (left, top, right, bottom)), …]`, pixels.
///
/// # Errors
/// The place in the file and what is wrong: no RON, no variable, an area without extent or outside the picture.
pub fn parse_picture_labels(name: &str, bytes: &[u8]) -> Result<Vec<PictureLabel>, FileFault> {
    let fault = |position: Option<(u32, u32)>, zh: String, en: String| FileFault {
        file: name.to_owned(),
        position,
        message: LocalizedText::new(zh, en),
    };
    let rows: Vec<LabelRow> = ron::de::from_bytes(bytes).map_err(|wrong| {
        let at = wrong.span.start;
        let (zh, en) = (format!("格式错误：{}", wrong.code), format!("wrong format: {}", wrong.code));
        fault(Some((at.line as u32, at.col as u32)), zh, en)
    })?;
    let (width, height) = PICTURE_SIZE;
    let label = |LabelRow { variable: name, area }| {
        let (left, top, right, bottom) = area;
        if left >= right || top >= bottom || u32::from(right) > width || u32::from(bottom) > height {
            let zh = format!("{name} 的区域应为 (左, 上, 右, 下)，在 {width}×{height} 点之内");
            let en = format!("the area of {name} must be (left, top, right, bottom) within {width}×{height} pixels");
            return Err(fault(None, zh, en));
        }
        let no_variable = || {
            let (zh, en) =
                (format!("{name} 不是变量，应如 #520、R18"), format!("{name} is no variable like #520 or R18"));
            fault(None, zh, en)
        };
        variable_name::parse(&name).map(|variable| PictureLabel { variable, area }).ok_or_else(no_variable)
    };
    rows.into_iter().map(label).collect()
}
