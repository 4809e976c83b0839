//! Leadscrew compensation table: backlash and pitch error over position, measured by laser or dial gauge, and its text
//! format. Source: spec B7, S6.

use std::sync::Arc;

use super::text::LocalizedText;

/// Maximum number of points in a table.
pub const MAX_POINTS: usize = 100;
/// Maximum backlash, mm.
const MAX_BACKLASH_MM: f64 = 2.0;
/// Maximum pitch error in either direction, mm.
const MAX_PITCH_ERROR_MM: f64 = 2.0;
/// Maximum position in either direction, mm.
const MAX_POSITION_MM: f64 = 9_999.0;
/// Maximum slope between two points, mm per mm: the compensation must stay much slower than the axis.
const MAX_SLOPE: f64 = 0.02;

/// One measured point: machine coordinate and slide travel (radius on X), all in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeadscrewPoint {
    /// Position, mm.
    pub position_mm: f64,
    /// Backlash that the screw takes up before it moves the slide in the minus direction, mm.
    pub backlash_mm: f64,
    /// Pitch error: deviation of the slide in the plus direction, mm.
    pub pitch_error_mm: f64,
}

/// A compensation table. A table without points compensates nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LeadscrewCompensation {
    points: Arc<[LeadscrewPoint]>,
}

/// An error in the text of a table.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {}", .message.en())]
pub struct LeadscrewTableError {
    /// Line, from 1.
    pub line: u32,
    /// Error message.
    pub message: LocalizedText,
}

impl LeadscrewCompensation {
    /// Parses a table: one point per line, `position, backlash[, pitch error]` in mm, positions increasing. `#` starts
    /// a comment. A first row without digits is a heading.
    ///
    /// # Errors
    /// The first invalid line.
    pub fn parse(text: &str) -> Result<Self, LeadscrewTableError> {
        let (mut points, mut rows): (Vec<LeadscrewPoint>, u32) = (Vec::new(), 0);
        for (index, whole) in text.trim_start_matches('\u{feff}').lines().enumerate() {
            let line = index as u32 + 1;
            let wrong = |zh: String, en: String| Err(LeadscrewTableError { line, message: LocalizedText::new(zh, en) });
            let row = whole.split('#').next().unwrap_or_default().trim();
            rows += u32::from(!row.is_empty());
            if row.is_empty() || rows == 1 && !row.contains(|sign: char| sign.is_ascii_digit()) {
                continue;
            }
            let point = match point(row) {
                Ok(point) => point,
                Err((zh, en)) => return wrong(zh, en),
            };
            if let Some(last) = points.last() {
                if point.position_mm <= last.position_mm {
                    return wrong("位置必须逐行增大".into(), "positions must rise from line to line".into());
                }
                let steep = |a: f64, b: f64| (a - b).abs() > MAX_SLOPE * (point.position_mm - last.position_mm);
                if steep(point.backlash_mm, last.backlash_mm) || steep(point.pitch_error_mm, last.pitch_error_mm) {
                    let zh = format!("与上一行相差太大，每毫米不超过 {MAX_SLOPE} mm");
                    return wrong(
                        zh,
                        format!("too large a change from the line before: at most {MAX_SLOPE} mm per mm"),
                    );
                }
            }
            if points.len() == MAX_POINTS {
                return wrong(format!("多于 {MAX_POINTS} 点"), format!("more than {MAX_POINTS} points"));
            }
            points.push(point);
        }
        Ok(Self { points: points.into() })
    }

    /// A table from points.
    ///
    /// # Errors
    /// The error of the first invalid point.
    pub fn from_points(points: &[LeadscrewPoint]) -> Result<Self, LocalizedText> {
        let text = Self { points: points.into() }.to_text();
        Self::parse(&text).map_err(|fault| {
            LocalizedText::new(
                format!("第 {} 点：{}", fault.line, fault.message.zh()),
                format!("point {}: {}", fault.line, fault.message.en()),
            )
        })
    }

    /// The text of the table.
    #[must_use]
    pub fn to_text(&self) -> String {
        let row = |LeadscrewPoint { position_mm, backlash_mm, pitch_error_mm }: &LeadscrewPoint| {
            [*position_mm, *backlash_mm, *pitch_error_mm].map(to_nanometres)
        };
        let line = |[at, backlash, pitch]: [f64; 3]| format!("{at},{backlash},{pitch}\n");
        self.points.iter().map(row).map(line).collect()
    }

    /// The points, by position.
    #[must_use]
    pub fn points(&self) -> &[LeadscrewPoint] {
        &self.points
    }

    /// The backlash at a position, mm.
    #[must_use]
    pub fn backlash_mm(&self, at_mm: f64) -> f64 {
        self.interpolate(at_mm, |point| point.backlash_mm)
    }

    /// The pitch error at a position, mm.
    #[must_use]
    pub fn pitch_error_mm(&self, at_mm: f64) -> f64 {
        self.interpolate(at_mm, |point| point.pitch_error_mm)
    }

    /// Interpolates linearly between points; constant beyond the first and the last.
    fn interpolate(&self, at_mm: f64, value: fn(&LeadscrewPoint) -> f64) -> f64 {
        let after = self.points.partition_point(|point| point.position_mm < at_mm);
        match (after.checked_sub(1).and_then(|before| self.points.get(before)), self.points.get(after)) {
            (None, None) => 0.0,
            (Some(only), None) | (None, Some(only)) => value(only),
            (Some(a), Some(b)) => {
                let share = (at_mm - a.position_mm) / (b.position_mm - a.position_mm);
                value(a) + (value(b) - value(a)) * share
            }
        }
    }
}

/// Values are kept in whole nanometres, far below the measuring accuracy: so the table in force is the stored one, and a
/// hundred points stay below the size limit of the store.
fn to_nanometres(mm: f64) -> f64 {
    // No minus zero: its text is read as zero.
    (mm * 1e6).round() / 1e6 + 0.0
}

fn point(row: &str) -> Result<LeadscrewPoint, (String, String)> {
    let columns: Vec<&str> = row.split([',', ';', '\t']).map(str::trim).collect();
    if !(2..=3).contains(&columns.len()) {
        let zh = "每行应为：位置,反向间隙[,螺距误差]".to_owned();
        return Err((zh, "write a line as: position, backlash[, pitch error]".to_owned()));
    }
    let number = |text: &str, low: f64, high: f64| match text.parse::<f64>() {
        Ok(value) if (low..=high).contains(&value) => Ok(to_nanometres(value)),
        Ok(value) => {
            Err((format!("{value} 超出范围 {low}…{high} mm"), format!("{value} is out of range {low}…{high} mm")))
        }
        Err(_) => Err((format!("“{text}” 不是数字"), format!("'{text}' is not a number"))),
    };
    Ok(LeadscrewPoint {
        position_mm: number(columns[0], -MAX_POSITION_MM, MAX_POSITION_MM)?,
        backlash_mm: number(columns[1], 0.0, MAX_BACKLASH_MM)?,
        pitch_error_mm: columns.get(2).map_or(Ok(0.0), |text| number(text, -MAX_PITCH_ERROR_MM, MAX_PITCH_ERROR_MM))?,
    })
}
