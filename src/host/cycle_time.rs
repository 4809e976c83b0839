//! How long the program on the screen takes: it runs once on a simulated machine with the values of the control.
//! Source: spec B6 (图形).

use std::sync::Arc;

use super::Host;
use super::headless_run::{RunEnd, RunLimits};
use super::part::PartQuery;
use super::simulated::HostedSimulation;
use super::storage::{Arrival, Storage};
use crate::controller::files::{BackgroundJob, DrawingStart};
use crate::controller::{PowerOnState, StorageRequest, StoredProgram};
use crate::defs::key::Key;
use crate::io::sim::{MachineFile, SimulatedMachine};
use crate::link::command::Command;
use crate::units::Micros;

/// The longest simulated time: about a second of computing, for which the operator waits.
const LONGEST: Micros = Micros::from_millis(600_000);

/// Storage of a machine that keeps nothing.
struct NoStorage;

impl Storage for NoStorage {
    fn submit(&mut self, requests: &mut Vec<StorageRequest>) {
        requests.clear();
    }

    fn find_part(&mut self, _query: PartQuery) -> bool {
        false
    }

    fn poll(&mut self, _arrivals: &mut Vec<Arrival>) {}

    fn close(&mut self) {}
}

/// Runs a program on a simulated machine that is homed and ready, with the program's part; returns the seconds to its end.
/// `None` if it takes longer than ten minutes, needs an operator or ends in an alarm, or when `stopped` says so.
#[must_use]
pub fn simulate(
    program: &StoredProgram,
    job: &BackgroundJob,
    start: &DrawingStart,
    stopped: &dyn Fn() -> bool,
) -> Option<f64> {
    let retained = PowerOnState {
        params: start.params.clone(),
        variables: start.memory.clone(),
        work_offsets: start.work_offsets.clone(),
        dress_points: start.dress_points,
        ..PowerOnState::factory(start.kind)
    };
    let machine = SimulatedMachine::new(MachineFile::builtin(start.kind).ok()?, None, &start.params, 0);
    let mut host = Host::connect(start.kind, retained, HostedSimulation::new(machine, Micros::ZERO), NoStorage);
    host.set_programs(Arc::clone(&job.programs), Arc::default());
    let (source, number) = (Some(Arc::clone(&program.source)), program.number);
    let part = PartQuery { kind: start.kind, params: start.params.clone(), number, source }.find();
    let prepare = |host: &mut Host<_, _>| {
        part.iter().for_each(|part| host.mount_part(part));
        host.send(Command::LoadProgram(number));
        host.step();
    };
    prepare(&mut host); // the control takes part, program and work offsets
    host.make_ready();
    if start.block_skip {
        host.send(Command::Press(Key::BlockSkip));
    }
    prepare(&mut host);
    let started = host.now();
    let limits = RunLimits { through_stops: true, longest: LONGEST, once: true };
    let end = host.run_program(&limits, &mut |_| !stopped());
    (end == RunEnd::Finished).then(|| host.now().since(started).as_secs_f64())
}
