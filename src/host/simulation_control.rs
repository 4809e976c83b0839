//! Executes the commands of the simulator page on the simulated machine and builds its view.
//! Source: spec P1–P8.

use crate::defs::signal::Input;
use crate::defs::text::LocalizedText;
use crate::io::sim::{LatheScene, PartFile, SimulatedMachine};
use crate::link::simulation::{LatheWorkspaceView, SimCommand, SimView};

/// Maximum number of events shown.
const MAX_EVENTS: usize = 6;
/// Maximum number of sizes shown.
const MAX_SIZES: usize = 12;

/// What the simulator page has changed so far.
#[derive(Clone, Debug, Default)]
pub struct SimulationControl {
    /// The part as it was mounted.
    pub part: Option<PartFile>,
    forced: Vec<(Input, bool)>,
    faults: Vec<&'static str>,
}

impl SimulationControl {
    /// Executes a command of the page.
    pub fn execute(&mut self, machine: &mut SimulatedMachine, command: SimCommand) {
        match command {
            SimCommand::Force(input, on) => {
                // Cannot fail: the id comes from the input table.
                if machine.force_input(input.id(), on).is_ok() {
                    self.forced.retain(|(other, _)| *other != input);
                    self.forced.extend(on.map(|on| (input, on)));
                }
            }
            SimCommand::Fault(name, present) => {
                let done = if present { machine.inject_fault(name) } else { machine.clear_fault(name) };
                if done.is_ok() {
                    self.faults.retain(|other| *other != name);
                    self.faults.extend(present.then_some(name));
                }
            }
            SimCommand::NewPart => machine.set_part(self.part.as_ref()),
            SimCommand::SharpenWheel => machine.set_wheel_dullness(0.0),
        }
    }

    /// The view for the page.
    #[must_use]
    pub fn view(&self, machine: &SimulatedMachine) -> SimView {
        let wheel = machine.wheel();
        let report = machine.measure();
        let diameters = report
            .diameters
            .iter()
            .map(|at| (LocalizedText::new(format!("直径 Z{:.1}", at.z), format!("diameter Z{:.1}", at.z)), at.d));
        let faces = report
            .faces
            .iter()
            .map(|at| (LocalizedText::new(format!("端面 X{:.1}", at.x), format!("face X{:.1}", at.x)), at.z));
        let heights = report.heights.iter().map(|at| {
            let (x, z) = (at.x, at.z);
            (LocalizedText::new(format!("高度 X{x:.0} Z{z:.0}"), format!("height X{x:.0} Z{z:.0}")), at.y)
        });
        let events = machine.events().iter().rev().take(MAX_EVENTS).rev();
        let events = events.map(|event| {
            let words = format!("{:.1} s {}", event.seconds, event.kind.id());
            LocalizedText::new(words.clone(), words)
        });
        SimView {
            forced: self.forced.clone(),
            faults: self.faults.clone(),
            wheel_diameter_mm: wheel.diameter_mm,
            wheel_dullness: wheel.dullness,
            wheel_load_percent: wheel.load_percent,
            sizes: diameters.chain(faces).chain(heights).take(MAX_SIZES).collect(),
            events: events.collect(),
            lathe_workspace: machine.lathe_scene().map(lathe_workspace),
        }
    }
}

/// The workspace of a lathe for the drawing.
fn lathe_workspace(scene: LatheScene<'_>) -> LatheWorkspaceView {
    let pair = |(a, b): (f64, f64)| (a as f32, b as f32);
    LatheWorkspaceView {
        zero_mm: pair(scene.zero_mm),
        chuck_face_z_mm: scene.z_from_mm as f32,
        cell_mm: scene.cell_mm as f32,
        radius_mm: scene.radius_mm.iter().map(|radius| *radius as f32).collect(),
        stock_radius_mm: scene.stock_mm as f32,
        bodies: scene.bodies.iter().map(|(from, to, radius)| (*from as f32, *to as f32, *radius as f32)).collect(),
        tip_mm: pair(scene.tip_mm),
        outline_mm: scene.outline_mm.into_iter().map(pair).collect(),
    }
}
