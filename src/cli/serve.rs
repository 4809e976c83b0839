//! `kt830 serve`: a simulated control without a screen, at the pace of the clock, with its network services: for those who
//! connect a system of their own. `kt830 device-model`: the model of the machine for an agent of MTConnect. `kt830
//! web-access`: the password of viewers on other computers.
//! Source: docs/manual, chapter "network".

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use super::args::{ServeArgs, SharedArgs, WebAccessArgs};
use super::painter::painter;
use super::play::read_story;
use super::story_loop::{self, Film};
use super::{CallError, SUCCESS, password_line, print_line, setup};
use crate::defs::param;
use crate::gateway::device_model::device_model;
use crate::gateway::{Gateway, GatewayThread, set_viewer_password, timestamp};
use crate::host::link::{HostLink, ObserverEnds};
use crate::host::simulated::HostedSimulation;
use crate::host::storage::ThreadedStorage;
use crate::host::thread::{HostThread, run_until_stopped, start};
use crate::link::Snapshot;
use crate::units::{Axis, Histogram};

/// Time between two looks whether the control has ended.
const WATCH_PERIOD: Duration = Duration::from_millis(100);

/// Serves until the time of the call is over, or for ever.
///
/// # Errors
/// The call or a file is wrong.
pub fn serve(shared: &SharedArgs, call: &ServeArgs) -> Result<u8, CallError> {
    let told = call.story.as_deref().map(|path| read_story(path, shared.kind)).transpose()?;
    let kind = told.as_ref().map_or(shared.kind, |story| story.kind);
    let shared = SharedArgs { kind, ..shared.clone() };
    let film = told.map(|story| Film { shared: shared.clone(), stories: vec![story] });
    let host = setup::threaded_host(&shared, false, setup::simulated_for_display)?;
    let script = move |thread: &mut HostThread<HostedSimulation, ThreadedStorage>| {
        match film {
            Some(film) => story_loop::repeat(thread, &film),
            None => run_until_stopped(thread),
        }
        print_line(tick_times(&thread.host().times().executions));
    };
    let mut link = start(host, script).map_err(CallError::new)?;
    let _network = start_network(&mut link, &shared)?;
    #[cfg(feature = "hmi")]
    super::process_end::guard_process(link.control_end()).map_err(CallError::at("end of the process"))?;
    let begun = Instant::now();
    let is_over = || call.seconds.is_some_and(|seconds| begun.elapsed().as_secs() >= seconds);
    while !link.control_end().is_requested() && !is_over() {
        if link.health().failed.load(Ordering::Acquire) {
            return Err(CallError::new("the control has failed"));
        }
        std::thread::sleep(WATCH_PERIOD);
    }
    Ok(SUCCESS)
}

/// Starts the network services of a simulated control, with the settings of the data directory that the call names: those of
/// a machine in the platform's directory are not its own. They end when this is dropped.
///
/// # Errors
/// The system cannot create a thread.
pub fn start_network(link: &mut HostLink, shared: &SharedArgs) -> Result<Option<GatewayThread>, CallError> {
    start_network_in(link, shared, shared.data.clone())
}

/// Starts the network services of a control with the settings in a data directory.
///
/// # Errors
/// The system cannot create a thread.
pub fn start_network_in(
    link: &mut HostLink,
    shared: &SharedArgs,
    folder: Option<PathBuf>,
) -> Result<Option<GatewayThread>, CallError> {
    let gateway = Gateway::new(painter(shared));
    let gateway = match folder {
        Some(folder) => gateway.with_folder(folder),
        None => gateway,
    };
    let started = link.take_observer().map(|ends| {
        let ObserverEnds { snapshots, tell, proposals } = ends;
        GatewayThread::start(snapshots, gateway.with_orders(proposals), tell)
    });
    started.transpose().map_err(CallError::at("network"))
}

/// What a tick needs, in words.
fn tick_times(executions: &Histogram) -> String {
    let at = |share| executions.percentile(share).0;
    let (p50, p99, p999) = (at(0.5), at(0.99), at(0.999));
    format!("ticks: 50 % {p50} µs, 99 % {p99} µs, 99.9 % {p999} µs, longest {} µs", at(1.0))
}

/// Sets the password of viewers on other computers.
///
/// # Errors
/// The password makes no sense, or a file cannot be written.
pub fn set_web_access(shared: &SharedArgs, call: &WebAccessArgs) -> Result<u8, CallError> {
    let folder = setup::data_dir(shared)?.root().to_path_buf();
    let done = set_viewer_password(&folder, &password_line()?, call.hosts.clone()).map_err(CallError::new)?;
    print_line(format!("{done} in {}", folder.display()));
    Ok(SUCCESS)
}

/// Prints the model of the machine whose data these are. Nothing is written.
///
/// # Errors
/// The call is wrong, or the data cannot be read.
pub fn print_device_model(shared: &SharedArgs) -> Result<u8, CallError> {
    let mut params = setup::kept_params(shared)?;
    for (address, value) in &shared.params {
        params.write(*address, *value).map_err(CallError::new)?;
    }
    if params.get(param::MACHINE_NUMBER) < 1.0 {
        warn_line!("kt830: P482 is 0: each machine needs a number of its own (--param P482=123)");
    }
    let mut snapshot = Snapshot::new(shared.kind);
    let fitted = params.fitted().axes();
    Axis::ALL.into_iter().for_each(|axis| snapshot.axes[axis].present = fitted[axis]);
    snapshot.params = Arc::new(params);
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    print_line(device_model(&snapshot, &timestamp(now)).trim_end());
    Ok(SUCCESS)
}
