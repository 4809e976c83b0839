//! The simulated machine under a host: it mounts parts, executes the commands of the simulator page and builds its view.
//! Source: spec P1–P8.

use std::sync::Arc;

use super::hosted_machine::HostedMachine;
use super::pace::{Pace, ThreadTimes};
use crate::defs::kind::GrindingForm;
use crate::defs::page_meaning::SizeKind;
use crate::defs::param::Params;
use crate::defs::part_defect::PartDefect;
use crate::defs::signal::Input;
use crate::defs::text::LocalizedText;
use crate::io::fieldbus::ClockReading;
use crate::io::sim::{PartFile, PartReport, SimulatedMachine};
use crate::io::{Backend, InputImage, OutputImage};
use crate::link::bus::BusView;
use crate::link::simulation::{PartSize, SimCommand, SimView};
use crate::units::Micros;

/// Maximum number of events shown.
const MAX_EVENTS: usize = 6;

/// The simulated machine, the part in it, and what the simulator page has changed so far.
pub struct HostedSimulation {
    machine: SimulatedMachine,
    /// The part as it was mounted.
    part: Option<PartFile>,
    forced: Vec<(Input, bool)>,
    faults: Vec<&'static str>,
    /// Sizes of the part at the end of the last cycle.
    finished_sizes: Vec<PartSize>,
    /// What has spoilt that part.
    finished_defects: Vec<PartDefect>,
    /// The view as last built, and when.
    view: Arc<SimView>,
    viewed_at: Option<Micros>,
    view_interval: Micros,
    pace: Pace,
}

impl HostedSimulation {
    /// A machine without a part. The view of the simulator page is built anew at most every `view_interval`.
    #[must_use]
    pub fn new(machine: SimulatedMachine, view_interval: Micros) -> Self {
        Self {
            machine,
            part: None,
            forced: Vec::new(),
            faults: Vec::new(),
            finished_sizes: Vec::new(),
            finished_defects: Vec::new(),
            view: Arc::default(),
            viewed_at: None,
            view_interval,
            pace: Pace::Simulated,
        }
    }

    /// The same machine, on a thread as fast as its ticks are computed.
    #[must_use]
    pub fn unpaced(self) -> Self {
        Self { pace: Pace::Unpaced, ..self }
    }

    /// The machine.
    #[must_use]
    pub const fn machine(&self) -> &SimulatedMachine {
        &self.machine
    }

    /// The machine, for forcing inputs and faults.
    pub const fn machine_mut(&mut self) -> &mut SimulatedMachine {
        &mut self.machine
    }

    /// The sizes of the part as it is now.
    fn part_sizes(&self) -> Vec<PartSize> {
        let surfaces = self.machine.measure_surfaces().into_iter().enumerate();
        let surfaces = surfaces.flat_map(|(index, report)| self.named_sizes(&report, Some(index)));
        surfaces.chain(self.named_sizes(&self.machine.measure_bar(), None)).collect()
    }

    /// The sizes of a report.
    fn named_sizes(&self, report: &PartReport, surface: Option<usize>) -> Vec<PartSize> {
        let size = |kind: SizeKind, place: String, mm: f64| {
            let (zh, en) = match kind {
                SizeKind::Diameter => ("直径", "diameter"),
                SizeKind::Length => ("端面", "face"),
                SizeKind::Height => ("高度", "height"),
            };
            let name = LocalizedText::new(format!("{zh} {place}"), format!("{en} {place}"));
            PartSize { kind, name, surface, mm }
        };
        // The face of a disc is the top of the part on its table.
        let forms = self.part.as_ref().map_or(&[][..], |part| part.kind.ui().grinding_forms);
        let on_table = forms.contains(&GrindingForm::RotaryFlat);
        let face = if on_table { SizeKind::Height } else { SizeKind::Length };
        let diameters = report.diameters.iter().map(|at| size(SizeKind::Diameter, format!("Z{:.1}", at.z), at.d));
        let faces = report.faces.iter().map(|at| size(face, format!("X{:.1}", at.x), at.z));
        let heights =
            report.heights.iter().map(|at| size(SizeKind::Height, format!("X{:.0} Z{:.0}", at.x, at.z), at.y));
        diameters.chain(faces).chain(heights).collect()
    }

    fn build_view(&self) -> SimView {
        let machine = &self.machine;
        let wheel = machine.wheel();
        let events = machine.events().iter().rev().take(MAX_EVENTS).rev();
        let events = events.map(|event| LocalizedText::same(&format!("{:.1} s {}", event.seconds, event.kind.id())));
        SimView {
            forced: self.forced.clone(),
            faults: self.faults.clone(),
            wheel_diameter_mm: wheel.diameter_mm,
            wheel_dullness: wheel.dullness,
            wheel_load_percent: wheel.load_percent,
            sizes: self.part_sizes(),
            finished_sizes: self.finished_sizes.clone(),
            finished_defects: self.finished_defects.clone(),
            events: events.collect(),
            grinding_workspace: machine.grinding_workspace(),
            lathe_workspace: machine.lathe_workspace(),
        }
    }
}

impl Backend for HostedSimulation {
    fn read(&mut self, now: Micros) -> InputImage {
        self.machine.read(now)
    }

    fn write(&mut self, now: Micros, outputs: &OutputImage) {
        self.machine.write(now, outputs);
    }

    fn rewire(&mut self, params: &Params) {
        self.machine.rewire(params);
    }
}

impl HostedMachine for HostedSimulation {
    fn pace(&self) -> Pace {
        self.pace
    }

    fn begin(&mut self) {}

    fn power_on(&mut self, params: &Params) {
        self.machine.power_on(params);
    }

    fn mount_part(&mut self, part: &PartFile) {
        self.machine.set_part(Some(part));
        self.part = Some(part.clone());
        self.viewed_at = None;
    }

    fn measure_finished_part(&mut self) {
        self.finished_sizes = self.part_sizes();
        self.finished_defects = self.machine.part_defects();
        self.viewed_at = None; // the view has them from now on
    }

    fn simulate(&mut self, command: SimCommand) {
        self.viewed_at = None;
        match command {
            SimCommand::Force(input, on) => {
                // Cannot fail: the id comes from the input table.
                if self.machine.force_input(input.id(), on).is_ok() {
                    self.forced.retain(|(other, _)| *other != input);
                    self.forced.extend(on.map(|on| (input, on)));
                }
            }
            SimCommand::Fault(name, present) => {
                let machine = &mut self.machine;
                let done = if present { machine.inject_fault(name) } else { machine.clear_fault(name) };
                if done.is_ok() {
                    self.faults.retain(|other| *other != name);
                    self.faults.extend(present.then_some(name));
                }
            }
            SimCommand::NewPart => self.machine.set_part(self.part.as_ref()),
            SimCommand::SharpenWheel => self.machine.set_wheel_dullness(0.0),
        }
    }

    fn view(&mut self, now: Micros) -> Option<Arc<SimView>> {
        if self.viewed_at.is_none_or(|at| now.since(at) >= self.view_interval) {
            self.viewed_at = Some(now);
            let view = self.build_view();
            // The page is painted again when the view is another one.
            if *self.view != view {
                self.view = Arc::new(view);
            }
        }
        Some(Arc::clone(&self.view))
    }

    fn simulation(&mut self) -> Option<&mut SimulatedMachine> {
        Some(&mut self.machine)
    }

    fn clear_counters(&mut self) {}

    fn bus_clock(&mut self) -> Option<ClockReading> {
        None
    }

    fn bus_view(&mut self, _now: Micros, _times: &ThreadTimes) -> Option<Arc<BusView>> {
        None
    }

    fn settling_time(&self) -> Micros {
        Micros::ZERO
    }

    fn take_bus_fault(&mut self) -> Option<(u16, LocalizedText)> {
        None
    }
}
