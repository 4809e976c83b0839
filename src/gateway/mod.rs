//! What the control tells the network, on a thread of its own behind the newest-only snapshot: a slow, flooding or dead
//! network is not felt by the tick nor by the screen. Nothing that comes from the network reaches the control.
//! Off by factory: with port 0 nothing listens.
//! Files: `port_server` a port with bounded connections, `shdr` the lines of MTConnect, `shdr_server` the port of its
//! agents, `device_model` the model of the machine, `web` the view for a phone, `picture_thread` who paints its picture.

pub mod device_model;
mod picture_thread;
mod port_server;
pub mod shdr;
mod shdr_server;
mod web;

use std::io::ErrorKind;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use crossbeam_channel::Sender;

use self::picture_thread::PictureThread;
use self::port_server::{PortCounts, PortServer};
use self::shdr_server::ShdrServer;
use self::web::{WebServer, WebView};
use crate::defs::param;
use crate::defs::text::{LocalizedText, Text};
use crate::link::network::{NetworkView, ServiceState, ServiceView};
use crate::link::snapshot::Snapshot;

/// Time between two looks at the snapshot.
const PERIOD: Duration = Duration::from_millis(20);
/// The page is told no more often.
const VIEW_INTERVAL: Duration = Duration::from_secs(1);
/// A port that cannot be opened is tried again after this time.
const RETRY_INTERVAL: Duration = Duration::from_secs(5);
/// A control without a new snapshot for so long stands still: its agents lose the connection and know it.
const LONGEST_STANDSTILL: Duration = Duration::from_secs(2);

pub use self::picture_thread::Painter;

/// Time in UTC by ISO 8601, as the lines and documents of MTConnect have it.
#[must_use]
pub fn timestamp(since_1970: Duration) -> String {
    let seconds = i64::try_from(since_1970.as_secs()).unwrap_or(0);
    let time = chrono::DateTime::from_timestamp(seconds, since_1970.subsec_nanos()).unwrap_or_default();
    time.format("%Y-%m-%dT%H:%M:%S%.6fZ").to_string()
}

/// A server that has a port.
trait HasPort {
    fn port(&mut self) -> &mut PortServer;
}

impl HasPort for ShdrServer {
    fn port(&mut self) -> &mut PortServer {
        &mut self.port
    }
}

impl HasPort for WebServer {
    fn port(&mut self) -> &mut PortServer {
        &mut self.port
    }
}

/// A service whose port is opened, closed and tried again as its parameters say.
struct Service<S> {
    server: Option<S>,
    /// Port and reach that the server has, or was to have.
    asked: (u16, bool),
    failed: Option<LocalizedText>,
    /// When opening the port is tried again.
    retry_at: Duration,
}

impl<S> Default for Service<S> {
    fn default() -> Self {
        Self { server: None, asked: (0, false), failed: None, retry_at: Duration::ZERO }
    }
}

impl<S: HasPort> Service<S> {
    /// The server at a port, if the port is not 0 and can be opened.
    fn follow(
        &mut self,
        now: Duration,
        asked: (u16, bool),
        open: fn(u16, bool) -> std::io::Result<S>,
    ) -> Option<&mut S> {
        if asked != self.asked {
            *self = Self { asked, ..Self::default() };
        }
        if asked.0 > 0 && self.server.is_none() && now >= self.retry_at {
            match open(asked.0, asked.1) {
                Ok(server) => (self.server, self.failed) = (Some(server), None),
                Err(error) => self.failed = Some(why_closed(&error)),
            }
            self.retry_at = now + RETRY_INTERVAL;
        }
        self.server.as_mut()
    }

    /// It is closed, and opened again a while later.
    fn fail(&mut self, now: Duration) {
        let why = LocalizedText::new("内部错误，见日志".to_owned(), "an internal fault, see the log".to_owned());
        *self = Self { asked: self.asked, failed: Some(why), retry_at: now + RETRY_INTERVAL, server: None };
    }

    /// What the page shows.
    fn view(&mut self) -> ServiceView {
        let wanted = if self.asked.0 == 0 { String::new() } else { format!(":{}", self.asked.0) };
        let Some(port) = self.server.as_mut().map(HasPort::port) else {
            let state = self.failed.clone().map_or(ServiceState::Off, ServiceState::Failed);
            return ServiceView { state, address: wanted, ..ServiceView::default() };
        };
        let PortCounts { sent, refused, dropped } = *port.counts();
        let clients = port.clients().map(|client| client.to_string()).collect();
        let address = port.address().map_or(wanted, |address| address.to_string());
        ServiceView { state: ServiceState::Listening, address, clients, sent, refused, dropped }
    }
}

/// Why a port cannot be opened.
fn why_closed(error: &std::io::Error) -> LocalizedText {
    let text = match error.kind() {
        ErrorKind::AddrInUse => Text::new("端口已被别的程序占用", "the port is in use"),
        ErrorKind::PermissionDenied => Text::new("没有权限：用 1024 以上的端口", "no permission: use a port from 1024"),
        _ => return LocalizedText::same(error),
    };
    LocalizedText::from(text)
}

/// The services of the network; they are stepped with the newest snapshot.
#[derive(Default)]
pub struct Gateway {
    mtconnect: Service<ShdrServer>,
    web: Service<WebServer>,
    pictures: Option<PictureThread>,
}

impl Gateway {
    /// Services of a control; `painter` paints its screen.
    #[must_use]
    pub fn new(painter: Option<Painter>) -> Self {
        Self { pictures: painter.and_then(PictureThread::start), ..Self::default() }
    }

    /// Serves everybody. `now` runs on from any begin; `time` is the time of day.
    pub fn step(&mut self, now: Duration, time: Duration, snapshot: &Snapshot) {
        let port = |of| snapshot.params.get(of) as u16;
        let reaches_network = snapshot.params.get(param::NETWORK_REACH) > 0.0;
        let asked = (port(param::MTCONNECT_PORT), reaches_network);
        if let Some(server) = self.mtconnect.follow(now, asked, ShdrServer::open) {
            server.step(now, time, snapshot);
        }
        // Without TLS the view is of this computer alone.
        let asked = (port(param::WEB_PORT), false);
        if let Some(server) = self.web.follow(now, asked, |port, _| WebServer::open(port)) {
            let picture = self.pictures.as_ref().and_then(|pictures| pictures.newest(now));
            server.step(now, &WebView { snapshot, picture, time });
            if let Some(pictures) = &mut self.pictures {
                pictures.step(now, server.take_picture_wanted(), snapshot);
            }
        }
    }

    /// Ends the connections: whoever listens knows that nothing is known any more.
    pub fn close(&mut self) {
        (self.mtconnect, self.web) = Default::default();
    }

    /// A service has failed: all ports are closed, and opened again a while later.
    fn fail(&mut self, now: Duration) {
        self.mtconnect.fail(now);
        self.web.fail(now);
    }

    /// What the page shows.
    #[must_use]
    pub fn view(&mut self) -> NetworkView {
        NetworkView { mtconnect: self.mtconnect.view(), web: self.web.view() }
    }
}

/// The gateway on its thread. Dropping it ends the thread.
pub struct GatewayThread {
    end: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl GatewayThread {
    /// Starts the gateway behind the newest snapshots of a control; `painter` paints its screen, `tell` takes what the page
    /// shows.
    ///
    /// # Errors
    /// The system cannot create a thread.
    pub fn start(
        snapshots: triple_buffer::Output<Snapshot>,
        painter: Option<Painter>,
        tell: Sender<NetworkView>,
    ) -> std::io::Result<Self> {
        let end = Arc::new(AtomicBool::new(false));
        let over = Arc::clone(&end);
        let thread = std::thread::Builder::new().name("kt830-gateway".to_owned()).spawn(move || {
            let mut serving = Serving {
                snapshots,
                gateway: Gateway::new(painter),
                tell,
                started: Instant::now(),
                updated_at: None,
                told: None,
            };
            while !over.load(Ordering::Relaxed) {
                std::thread::sleep(PERIOD);
                serving.step();
            }
        })?;
        Ok(Self { end, thread: Some(thread) })
    }
}

impl Drop for GatewayThread {
    fn drop(&mut self) {
        self.end.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            drop(thread.join());
        }
    }
}

/// What the thread works with.
struct Serving {
    snapshots: triple_buffer::Output<Snapshot>,
    gateway: Gateway,
    tell: Sender<NetworkView>,
    started: Instant,
    /// When the snapshot was new.
    updated_at: Option<Duration>,
    /// What the page was told, and when.
    told: Option<(NetworkView, Duration)>,
}

impl Serving {
    fn step(&mut self) {
        let now = self.started.elapsed();
        if self.snapshots.update() {
            self.updated_at = Some(now);
        }
        let Some(updated_at) = self.updated_at else { return };
        if now.saturating_sub(updated_at) > LONGEST_STANDSTILL {
            self.gateway.close();
        } else {
            let time = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
            let (gateway, snapshot) = (&mut self.gateway, self.snapshots.output_buffer_mut());
            // A fault of the network ends its connections, not the control.
            if catch_unwind(AssertUnwindSafe(|| gateway.step(now, time, snapshot))).is_err() {
                self.gateway.fail(now);
            }
        }
        let view = self.gateway.view();
        let is_due = |told: &(NetworkView, Duration)| now.saturating_sub(told.1) >= VIEW_INTERVAL && told.0 != view;
        if self.told.as_ref().is_none_or(is_due) && self.tell.try_send(view.clone()).is_ok() {
            self.told = Some((view, now));
        }
    }
}
