//! Requests and data of the simulator page. On a real machine there is no simulated machine.
//! Source: spec P1–P8; tools.md (faults).

use crate::defs::grinding_workspace::GrindingWorkspace;
use crate::defs::lathe_workspace::LatheWorkspace;
use crate::defs::page_meaning::SizeKind;
use crate::defs::part_defect::PartDefect;
use crate::defs::signal::Input;
use crate::defs::text::LocalizedText;

/// One request to the simulated machine; the core never handles it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SimCommand {
    /// Forces an input, logically on or off; `None` ends the forcing.
    Force(Input, Option<bool>),
    /// Starts or ends a fault by its name.
    Fault(&'static str, bool),
    /// Restores the unmachined workpiece.
    NewPart,
    /// Restores the freshly dressed wheel.
    SharpenWheel,
}

/// A size of the workpiece in the simulated machine.
#[derive(Clone, Debug, PartialEq)]
pub struct PartSize {
    /// What is measured.
    pub kind: SizeKind,
    /// Its name with its place.
    pub name: LocalizedText,
    /// Number of its surface; none on a bar, whose places are turned to different sizes.
    pub surface: Option<usize>,
    /// The size; the coordinate of a face. mm.
    pub mm: f64,
}

/// The simulated machine as the page shows it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SimView {
    /// Inputs that are forced.
    pub forced: Vec<(Input, bool)>,
    /// Active faults.
    pub faults: Vec<&'static str>,
    /// Mean wheel diameter, mm.
    pub wheel_diameter_mm: f64,
    /// Wheel wear: 0 sharp, 1 dull.
    pub wheel_dullness: f64,
    /// Load of the wheel motor, percent.
    pub wheel_load_percent: f64,
    /// Sizes of the workpiece.
    pub sizes: Vec<PartSize>,
    /// Sizes of the part of the last cycle at its end.
    pub finished_sizes: Vec<PartSize>,
    /// What has spoilt that part.
    pub finished_defects: Vec<PartDefect>,
    /// Events of the workpiece, newest last.
    pub events: Vec<LocalizedText>,
    /// The working area of a grinding machine.
    pub grinding_workspace: Option<GrindingWorkspace>,
    /// The working area of a lathe (L10).
    pub lathe_workspace: Option<LatheWorkspace>,
}
