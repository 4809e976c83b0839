//! What the control tells the network, on a thread of its own behind the newest-only snapshot: a slow, flooding or dead
//! network is not felt by the tick nor by the screen. Nothing that comes from the network reaches the control
//! but orders that the operator has to accept.
//! Off by factory: with port 0 nothing listens, and no broker is looked for.
//! Files: `port_server` a port with bounded connections, `shdr` the lines of MTConnect, `shdr_server` the port of its
//! agents, `mqtt` what a broker is told, `order_inbox` orders of the shop, `opcua_report` what the OPC UA server says of itself, `device_model` the model of the machine, `web`
//! the view for a phone, `metrics` the same for Prometheus, `web_access` who may look at it from other computers,
//! `picture_thread` who paints its picture, `wire` a stream with or without TLS, `certificate_end` until when a certificate
//! is valid.

mod certificate_end;
pub mod device_model;
mod metrics;
mod mqtt;
pub mod opcua;
pub mod opcua_report;
pub mod order_inbox;
mod picture_thread;
mod port_server;
pub mod shdr;
mod shdr_server;
mod web;
mod web_access;
mod wire;

use std::io::ErrorKind;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use crossbeam_channel::Sender;

use self::mqtt::MqttClient;
use self::order_inbox::{OrderInbox, SharedInbox};
pub use self::picture_thread::Painter;
use self::picture_thread::PictureThread;
use self::port_server::{PortCounts, PortServer};
use self::shdr_server::ShdrServer;
use self::web::{WebServer, WebView};
use self::web_access::WebAccess;
pub use self::web_access::set_viewer_password;
use crate::defs::param;
use crate::defs::text::{LocalizedText, Text};
use crate::link::host_view::HostView;
use crate::link::network::{BrokerState, BrokerView, NetworkView, ServiceState, ServiceView, TlsView};
use crate::link::observed::ObservedSnapshot;
use crate::link::production::OrderProposal;
use crate::link::snapshot::Snapshot;

/// Time between two looks at the snapshot.
const PERIOD: Duration = Duration::from_millis(20);
/// The page is told no more often.
const VIEW_INTERVAL: Duration = Duration::from_secs(1);
/// A port that cannot be opened is tried again after this time.
const RETRY_INTERVAL: Duration = Duration::from_secs(5);
/// Time between two looks whether `web.ron` was written: viewers have got another password or certificate.
const ACCESS_INTERVAL: Duration = Duration::from_secs(2);
/// A control without a new snapshot for so long stands still: its agents lose the connection and know it.
const LONGEST_STANDSTILL: Duration = Duration::from_secs(2);

/// Time in UTC by ISO 8601, as the lines and documents of MTConnect have it.
#[must_use]
pub fn timestamp(since_1970: Duration) -> String {
    let seconds = i64::try_from(since_1970.as_secs()).unwrap_or(0);
    let time = chrono::DateTime::from_timestamp(seconds, since_1970.subsec_nanos()).unwrap_or_default();
    time.format("%Y-%m-%dT%H:%M:%S%.6fZ").to_string()
}

/// A server that has a port.
trait HasPort {
    fn port(&self) -> &PortServer;

    /// How its connections are encrypted.
    fn tls(&self) -> Option<TlsView> {
        None
    }
}

impl HasPort for ShdrServer {
    fn port(&self) -> &PortServer {
        &self.port
    }
}

impl HasPort for WebServer {
    fn port(&self) -> &PortServer {
        &self.port
    }

    fn tls(&self) -> Option<TlsView> {
        self.tls()
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
    /// Opens and closes the port as it is asked for, and lets the server act. A server that fails ends its connections, and
    /// nothing else.
    fn serve(
        &mut self,
        now: Duration,
        asked: (u16, bool),
        open: impl FnOnce(u16, bool) -> Result<S, LocalizedText>,
        act: impl FnOnce(&mut S),
    ) {
        if asked != self.asked {
            *self = Self { asked, ..Self::default() };
        }
        if asked.0 > 0 && self.server.is_none() && now >= self.retry_at {
            match open(asked.0, asked.1) {
                Ok(server) => (self.server, self.failed) = (Some(server), None),
                Err(why) => self.failed = Some(why),
            }
            self.retry_at = now + RETRY_INTERVAL;
        }
        if let Some(server) = &mut self.server
            && catch_unwind(AssertUnwindSafe(|| act(server))).is_err()
        {
            self.fail(now);
        }
    }

    /// It is closed, and opened again a while later.
    fn fail(&mut self, now: Duration) {
        *self =
            Self { asked: self.asked, failed: Some(internal_fault()), retry_at: now + RETRY_INTERVAL, server: None };
    }

    /// What the page shows.
    fn view(&self) -> ServiceView {
        let wanted = if self.asked.0 == 0 { String::new() } else { format!(":{}", self.asked.0) };
        let Some((port, tls)) = self.server.as_ref().map(|server| (server.port(), server.tls())) else {
            let state = self.failed.clone().map_or(ServiceState::Off, ServiceState::Failed);
            return ServiceView { state, address: wanted, ..ServiceView::default() };
        };
        let PortCounts { sent, refused, dropped } = port.counts();
        let clients = port.clients().map(|client| client.to_string()).collect();
        let address = port.address().map_or(wanted, |address| address.to_string());
        ServiceView { state: ServiceState::Listening, address, clients, sent, refused, dropped, tls }
    }
}

fn no_folder() -> LocalizedText {
    Text::new("没有数据目录", "there is no data directory").into()
}

fn internal_fault() -> LocalizedText {
    Text::new("内部错误，见日志", "an internal fault, see the log").into()
}

/// A fault as the system or a library tells it.
fn in_words(fault: impl std::fmt::Display) -> LocalizedText {
    LocalizedText::same(&fault)
}

/// Opens the view: for other computers in TLS and with a password.
fn open_view(port: u16, folder: Option<&Path>, reaches_network: bool) -> Result<WebServer, LocalizedText> {
    let access = match (reaches_network, folder) {
        (false, _) => None,
        (true, Some(folder)) => Some(WebAccess::read(folder)?),
        (true, None) => return Err(no_folder()),
    };
    WebServer::open(port, access).map_err(|error| why_closed(&error))
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
    /// None without a data directory, which has its settings.
    mqtt: Option<MqttClient>,
    /// A broker is asked for.
    wants_broker: bool,
    pictures: Option<PictureThread>,
    /// The data directory.
    folder: Option<PathBuf>,
    /// Where orders go.
    inbox: SharedInbox,
    /// When the access of viewers was changed, and when it is looked at again.
    access_changed_at: Option<SystemTime>,
    access_look_at: Duration,
}

impl Gateway {
    /// Services of a control; `painter` paints its screen.
    #[must_use]
    pub fn new(painter: Option<Painter>) -> Self {
        Self { pictures: painter.and_then(PictureThread::start), ..Self::default() }
    }

    /// With a broker, and with viewers on other computers, as the files in this data directory say.
    #[must_use]
    pub fn with_folder(self, folder: PathBuf) -> Self {
        Self { mqtt: Some(MqttClient::new(folder.clone())), folder: Some(folder), ..self }
    }

    /// With orders of the shop, which go to a control as proposals.
    #[must_use]
    pub fn with_orders(self, proposals: Sender<OrderProposal>) -> Self {
        let inbox = Arc::new(Mutex::new(OrderInbox::new(proposals)));
        let mqtt = self.mqtt.map(|mqtt| mqtt.with_orders(Arc::clone(&inbox)));
        Self { mqtt, inbox, ..self }
    }

    /// Serves everybody. `now` runs on from any begin; `time` is when the snapshot was taken, since 1970, UTC.
    pub fn step(&mut self, now: Duration, time: Duration, snapshot: &Snapshot) {
        let port = |of| snapshot.params.get(of) as u16;
        let reaches_network = snapshot.params.get(param::NETWORK_REACH) > 0.0;
        let asked = (port(param::MTCONNECT_PORT), reaches_network);
        let inbox = Arc::clone(&self.inbox);
        let open = |port, reach| ShdrServer::open(port, reach, inbox).map_err(|error| why_closed(&error));
        self.mtconnect.serve(now, asked, open, |server| server.step(now, time, snapshot));
        self.follow_access(now);
        let picture = self.pictures.as_ref().and_then(|pictures| pictures.newest(now));
        let view = WebView { snapshot, picture, time };
        let mut wants_picture = false;
        let asked = (port(param::WEB_PORT), snapshot.params.get(param::WEB_REACH) > 0.0);
        let open = |port, reach| open_view(port, if reach { self.folder.as_deref() } else { None }, reach);
        self.web.serve(now, asked, open, |server| {
            server.step(now, &view);
            wants_picture = server.take_picture_wanted();
        });
        self.step_broker(now, time, snapshot);
        let network = wants_picture.then(|| Arc::new(self.view()));
        if let Some(pictures) = &mut self.pictures {
            pictures.step();
            if wants_picture && pictures.is_due(now) {
                let host = HostView { network, ..snapshot.host.clone() };
                pictures.ask(now, Snapshot { host, ..snapshot.clone() });
            }
        }
    }

    /// Another password or certificate of viewers that `kt830 web-access` has made holds soon: their port is opened anew.
    fn follow_access(&mut self, now: Duration) {
        if now < self.access_look_at {
            return;
        }
        self.access_look_at = now + ACCESS_INTERVAL;
        let changed_at = self.folder.as_deref().and_then(web_access::changed_at);
        if std::mem::replace(&mut self.access_changed_at, changed_at) != changed_at {
            self.web = Service::default();
        }
    }

    /// A client that fails ends its connection, and nothing else.
    fn step_broker(&mut self, now: Duration, time: Duration, snapshot: &Snapshot) {
        self.wants_broker = snapshot.params.get(param::MQTT_ENABLED) > 0.0;
        let Some(mqtt) = &mut self.mqtt else { return };
        if catch_unwind(AssertUnwindSafe(|| mqtt.step(now, time, snapshot))).is_err() {
            mqtt.fail(now, internal_fault(), snapshot);
        }
    }

    /// Ends the connections: whoever listens knows that nothing is known any more. `time` is the time of day.
    pub fn close(&mut self, time: Duration) {
        (self.mtconnect, self.web) = Default::default();
        if let Some(mqtt) = &mut self.mqtt {
            mqtt.close(time);
        }
    }

    /// What the page shows.
    #[must_use]
    pub fn view(&self) -> NetworkView {
        let mqtt = match &self.mqtt {
            Some(mqtt) => mqtt.view().clone(),
            None if self.wants_broker => {
                BrokerView { state: BrokerState::Failed(no_folder()), ..BrokerView::default() }
            }
            None => BrokerView::default(),
        };
        let opcua = self.mtconnect.server.as_ref().and_then(ShdrServer::opcua).cloned().unwrap_or_default();
        NetworkView { mtconnect: self.mtconnect.view(), web: self.web.view(), mqtt, opcua }
    }
}

/// The gateway on its thread. Dropping it ends the thread.
pub struct GatewayThread {
    end: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl GatewayThread {
    /// Starts a gateway behind the newest snapshots of a control; `tell` takes what the page shows.
    ///
    /// # Errors
    /// The system cannot create a thread.
    pub fn start(
        snapshots: triple_buffer::Output<ObservedSnapshot>,
        gateway: Gateway,
        tell: triple_buffer::Input<Option<NetworkView>>,
    ) -> std::io::Result<Self> {
        let end = Arc::new(AtomicBool::new(false));
        let over = Arc::clone(&end);
        let thread = std::thread::Builder::new().name("kt830-gateway".to_owned()).spawn(move || {
            let mut serving =
                Serving { snapshots, gateway, tell, started: Instant::now(), updated_at: None, told_at: None };
            while !over.load(Ordering::Relaxed) {
                std::thread::sleep(PERIOD);
                serving.step();
            }
            serving.gateway.close(time_of_day());
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

fn time_of_day() -> Duration {
    SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default()
}

/// What the thread works with.
struct Serving {
    snapshots: triple_buffer::Output<ObservedSnapshot>,
    gateway: Gateway,
    tell: triple_buffer::Input<Option<NetworkView>>,
    started: Instant,
    /// When the snapshot was new.
    updated_at: Option<Duration>,
    /// When the page was told.
    told_at: Option<Duration>,
}

impl Serving {
    fn step(&mut self) {
        let now = self.started.elapsed();
        if self.snapshots.update() {
            self.updated_at = Some(now);
        }
        let Some(updated_at) = self.updated_at else { return };
        if now.saturating_sub(updated_at) > LONGEST_STANDSTILL {
            self.gateway.close(time_of_day());
        } else {
            let ObservedSnapshot { snapshot, taken } = self.snapshots.output_buffer_mut();
            self.gateway.step(now, Duration::from_micros(taken.0), snapshot);
        }
        if self.told_at.is_some_and(|at| now.saturating_sub(at) < VIEW_INTERVAL) {
            return;
        }
        self.told_at = Some(now);
        *self.tell.input_buffer_mut() = Some(self.gateway.view());
        self.tell.publish();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A server that fails in its first act.
    struct Failing(PortServer);

    impl HasPort for Failing {
        fn port(&self) -> &PortServer {
            &self.0
        }
    }

    fn open(port: u16, reaches_network: bool) -> Result<Failing, LocalizedText> {
        let patience = Duration::from_secs(1);
        let limits = port_server::PortLimits { connections: 1, pending: 1, received: 1, patience };
        PortServer::open(port, reaches_network, limits).map(Failing).map_err(|error| why_closed(&error))
    }

    #[test]
    fn a_service_that_fails_is_closed_and_opened_again_a_while_later() {
        let mut service = Service::default();
        let free = std::net::TcpListener::bind("127.0.0.1:0").and_then(|listener| listener.local_addr());
        let asked = (free.map_or(0, |address| address.port()), false);
        let second = Duration::from_secs(1);
        service.serve(second, asked, open, |_| panic!("a fault of the server"));
        assert!(matches!(service.view().state, ServiceState::Failed(_)));
        service.serve(5 * second, asked, open, |_| panic!("it is not open"));
        assert!(matches!(service.view().state, ServiceState::Failed(_)));
        service.serve(6 * second, asked, open, |_| {});
        assert_eq!(service.view().state, ServiceState::Listening);
        service.serve(7 * second, (0, false), open, |_| panic!("it is off"));
        assert_eq!(service.view().state, ServiceState::Off);
    }
}
