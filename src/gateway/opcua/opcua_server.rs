//! The server: waits for a control, shows it to clients, and begins anew when it is another machine or when nobody is
//! connected any more.

use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use opcua::crypto::SecurityPolicy;
use opcua::nodes::Event;
use opcua::server::node_manager::ServerContext;
use opcua::server::node_manager::memory::InMemoryNodeManagerBuilder;
use opcua::server::{Limits, ServerBuilder, ServerEndpoint, ServerHandle, SubscriptionLimits};
use opcua::types::{BuildInfo, DataValue, DateTime, MessageSecurityMode, StatusCode, VariableId, Variant};
use tokio::net::TcpListener;
use tokio::runtime::Runtime;
use tokio::task::JoinHandle;

use super::accounts::Accounts;
use super::adapter_client::AdapterClient;
use super::adapter_state::{AdapterEvent, AdapterState};
use super::alert_event::AlertEvent;
use super::certificates::{self, OWN_CERTIFICATE, PRIVATE_KEY};
use super::machine_tool::MachineNodes;
use super::node_manager::{EventFields, MachineBuilder, MachineNodeManager};

/// Time between two trials to reach the control.
const RETRY_INTERVAL: Duration = Duration::from_secs(1);
/// A server that nobody has used for so long begins anew if somebody had: the library keeps what clients subscribed to.
const LONGEST_IDLE: Duration = Duration::from_secs(60);
/// A server that is to end has so long.
const END_TIMEOUT: Duration = Duration::from_secs(5);
/// Time between two looks whether somebody is connected.
const LOOK_INTERVAL: Duration = Duration::from_secs(5);

/// How a server is to be.
#[derive(Clone, Debug)]
pub struct OpcUaSettings {
    /// The adapter port of the control, HOST:PORT.
    pub control: String,
    /// Where it listens.
    pub listen: SocketAddr,
    /// The name under which clients reach it.
    pub host: String,
    /// Folder of its users and certificates.
    pub folder: PathBuf,
}

/// What somebody is told of the state of the server.
type TellState<'a> = &'a mut dyn FnMut(&str);

/// The OPC UA server of a control.
pub struct OpcUaServer {
    settings: OpcUaSettings,
    runtime: Runtime,
}

/// What ends a server.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Ended {
    /// It is to begin anew.
    Renew,
    /// It was told to.
    Over,
}

impl OpcUaServer {
    /// A server with its own certificate.
    ///
    /// # Errors
    /// The certificate or the threads cannot be made.
    pub fn new(settings: OpcUaSettings) -> Result<Self, String> {
        let hosts = vec![settings.host.clone()];
        certificates::ensure_own(&settings.folder, &application_uri(&settings.host), hosts)?;
        let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(1).enable_all().build();
        Ok(Self { settings, runtime: runtime.map_err(|error| error.to_string())? })
    }

    /// Serves until it is over.
    ///
    /// # Errors
    /// The port cannot be opened.
    pub fn serve(&self, is_over: &dyn Fn() -> bool, tell: TellState) -> Result<(), String> {
        let mut state = AdapterState::default();
        while !is_over() {
            let Some(client) = self.first_contact(&mut state, is_over, tell) else { return Ok(()) };
            let running = self.runtime.block_on(Running::start(&self.settings, &state))?;
            let at = self.settings.listen.port();
            tell(&format!("{} at opc.tcp://{}:{at}/", state.identity.uuid, self.settings.host));
            let ended = self.follow(&running, client, &mut state, is_over, tell);
            self.runtime.block_on(running.end());
            if ended == Ended::Over {
                break;
            }
        }
        Ok(())
    }

    /// Connects to the control until it has told who it is; none when it is over.
    fn first_contact(
        &self,
        state: &mut AdapterState,
        is_over: &dyn Fn() -> bool,
        tell: TellState,
    ) -> Option<AdapterClient> {
        let mut told = String::new();
        while !is_over() {
            *state = AdapterState::default();
            let tried = AdapterClient::connect(&self.settings.control).and_then(|mut client| {
                while !state.is_complete() && !is_over() {
                    client.lines()?.iter().for_each(|line| drop(state.take(line)));
                }
                Ok(client)
            });
            match tried {
                Ok(client) if state.is_complete() => return Some(client),
                Ok(_) => {}
                Err(error) => {
                    let text = format!("no control at {}: {error}", self.settings.control);
                    if told != text {
                        tell(&text);
                        told = text;
                    }
                }
            }
            std::thread::sleep(RETRY_INTERVAL);
        }
        None
    }

    /// Shows what the control tells until the server is to end.
    fn follow(
        &self,
        running: &Running,
        client: AdapterClient,
        state: &mut AdapterState,
        is_over: &dyn Fn() -> bool,
        tell: TellState,
    ) -> Ended {
        let mut client = Some(client);
        let identity = state.identity.clone();
        let mut idle = IdleWatch::default();
        running.show(Some(state));
        while !is_over() {
            let lines = match &mut client {
                Some(connected) => connected.lines().ok(),
                None => {
                    std::thread::sleep(RETRY_INTERVAL);
                    client = AdapterClient::connect(&self.settings.control).ok();
                    if client.is_some() {
                        running.forget(state);
                    }
                    client.as_ref().map(|_| Vec::new())
                }
            };
            match lines {
                Some(lines) => running.take(&lines, state),
                None if client.take().is_some() => {
                    tell("the control is silent");
                    running.show(None);
                }
                None => {}
            }
            let is_other = state.is_complete() && state.identity != identity;
            if is_other || idle.is_over(running) {
                return Ended::Renew;
            }
            certificates::limit_rejected(&self.settings.folder);
        }
        Ended::Over
    }
}

/// Name of the application, as its certificate has it.
fn application_uri(host: &str) -> String {
    format!("urn:{host}:kt830:opcua")
}

/// Watches whether a server that was used is used no more.
#[derive(Default)]
struct IdleWatch {
    looked_at: Option<Instant>,
    idle_since: Option<Instant>,
}

impl IdleWatch {
    fn is_over(&mut self, running: &Running) -> bool {
        if self.looked_at.is_some_and(|at| at.elapsed() < LOOK_INTERVAL) {
            return false;
        }
        self.looked_at = Some(Instant::now());
        if running.sessions() > 0 || !running.was_used() {
            self.idle_since = None;
            return false;
        }
        self.idle_since.get_or_insert_with(Instant::now).elapsed() >= LONGEST_IDLE
    }
}

/// A server that runs.
struct Running {
    handle: ServerHandle,
    task: JoinHandle<Result<(), String>>,
    manager: Arc<MachineNodeManager>,
    nodes: Arc<MachineNodes>,
}

impl Running {
    /// Opens the port.
    async fn start(settings: &OpcUaSettings, state: &AdapterState) -> Result<Self, String> {
        let listener =
            TcpListener::bind(settings.listen).await.map_err(|error| format!("{}: {error}", settings.listen))?;
        let builder = builder(settings)
            .with_node_manager(InMemoryNodeManagerBuilder::new(MachineBuilder { state: state.clone() }))
            .with_node_manager(|_: ServerContext| EventFields);
        let (server, handle) = builder.build()?;
        let manager = handle.node_managers().get_of_type::<MachineNodeManager>();
        let manager = manager.ok_or("the address space is missing")?;
        let nodes = Arc::clone(&manager.inner().nodes);
        let task = tokio::spawn(server.run_with(listener));
        Ok(Self { handle, task, manager, nodes })
    }

    /// Ends the connections and closes the port.
    async fn end(self) {
        self.handle.cancel();
        let mut task = self.task;
        if tokio::time::timeout(END_TIMEOUT, &mut task).await.is_err() {
            task.abort();
        }
    }

    /// A connection begins: what was raised is over, and comes again if it is not.
    fn forget(&self, state: &mut AdapterState) {
        let over = state.restart();
        let events: Vec<_> =
            over.iter().map(|alarm| AlertEvent::of_alarm(&self.nodes, alarm, false, DateTime::now())).collect();
        self.tell(&events);
    }

    fn tell(&self, events: &[AlertEvent]) {
        let told = events.iter().map(|event| (event as &dyn Event, &self.nodes.messages));
        self.handle.subscriptions().notify_events(told);
    }

    /// Takes lines of the control: values that have changed, and events.
    fn take(&self, lines: &[String], state: &mut AdapterState) {
        let (mut is_changed, mut events) = (false, Vec::new());
        for line in lines {
            for event in state.take(line) {
                is_changed = true;
                let time = time_of(state);
                match event {
                    AdapterEvent::Value(_) => {}
                    AdapterEvent::Message(text) if text.is_empty() => {}
                    AdapterEvent::Message(text) => events.push(AlertEvent::of_message(&self.nodes, &text, time)),
                    AdapterEvent::Raised(alarm) => events.push(AlertEvent::of_alarm(&self.nodes, &alarm, true, time)),
                    AdapterEvent::Cleared(alarm) => events.push(AlertEvent::of_alarm(&self.nodes, &alarm, false, time)),
                }
            }
        }
        if is_changed {
            self.show(Some(state));
        }
        self.tell(&events);
    }

    /// Shows the values of a control, or that there is none.
    fn show(&self, state: Option<&AdapterState>) {
        let time = state.map_or_else(DateTime::now, time_of);
        let values = self.nodes.variables.iter().map(|variable| {
            let value = state.and_then(|state| (variable.read)(state));
            let status = match (state, &value) {
                (None, _) => StatusCode::BadNoCommunication,
                (_, None) => StatusCode::BadWaitingForInitialData,
                _ => StatusCode::Good,
            };
            let value = DataValue {
                // Without a value the library would show the status as good.
                value: Some(value.unwrap_or(Variant::Empty)),
                status: Some(status),
                source_timestamp: Some(time),
                server_timestamp: Some(DateTime::now()),
                ..DataValue::default()
            };
            (&variable.id, None, value)
        });
        // Every variable is in the address space.
        let shown = self.manager.set_values(self.handle.subscriptions(), values);
        debug_assert!(shown.is_ok(), "{shown:?}");
    }

    /// How many clients are connected.
    fn sessions(&self) -> u32 {
        self.count(VariableId::Server_ServerDiagnostics_ServerDiagnosticsSummary_CurrentSessionCount)
    }

    /// Whether a client has ever been connected.
    fn was_used(&self) -> bool {
        self.count(VariableId::Server_ServerDiagnostics_ServerDiagnosticsSummary_CumulatedSessionCount) > 0
    }

    fn count(&self, of: VariableId) -> u32 {
        match self.handle.info().summary().get(of).and_then(|value| value.value) {
            Some(Variant::UInt32(count)) => count,
            _ => 0,
        }
    }
}

/// When the newest line was written.
fn time_of(state: &AdapterState) -> DateTime {
    chrono::DateTime::parse_from_rfc3339(state.time())
        .map_or_else(|_| DateTime::now(), |time| DateTime::from(time.with_timezone(&chrono::Utc)))
}

/// The server without its nodes: encrypted and signed connections of users alone.
fn builder(settings: &OpcUaSettings) -> ServerBuilder {
    let OpcUaSettings { listen, host, folder, .. } = settings;
    let secure = |policy| ServerEndpoint::new("/", policy, MessageSecurityMode::SignAndEncrypt, &[]);
    let version = env!("CARGO_PKG_VERSION");
    ServerBuilder::new()
        .application_name("KT-830")
        .application_uri(application_uri(host))
        .product_uri("urn:kt830")
        .host(host.as_str())
        .port(listen.port())
        .discovery_urls(vec![format!("opc.tcp://{host}:{}/", listen.port())])
        .add_endpoint("basic256sha256", secure(SecurityPolicy::Basic256Sha256))
        .add_endpoint("aes256sha256rsapss", secure(SecurityPolicy::Aes256Sha256RsaPss))
        .default_endpoint("aes256sha256rsapss")
        .pki_dir(folder)
        .certificate_path(OWN_CERTIFICATE)
        .private_key_path(PRIVATE_KEY)
        .create_sample_keypair(false)
        .trust_client_certs(false)
        .check_cert_time(true)
        .with_authenticator(Arc::new(Accounts::new(folder.clone())))
        .max_session_timeout_ms(60_000)
        .max_timeout_ms(30_000)
        .subscription_poll_interval_ms(50)
        // Counted for the server itself; no user may read it.
        .diagnostics_enabled(true)
        .limits(limits())
        .build_info(BuildInfo {
            product_uri: "urn:kt830".into(),
            manufacturer_name: "KT-830".into(),
            product_name: "KT-830".into(),
            software_version: version.into(),
            build_number: version.into(),
            build_date: DateTime::null(),
        })
}

/// What one client and all together may take.
fn limits() -> Limits {
    Limits {
        max_message_size: 4 * 1_024 * 1_024,
        max_chunk_count: 64,
        max_array_length: 10_000,
        max_string_length: 65_535,
        max_byte_string_length: 1_024 * 1_024,
        max_sessions: 50,
        subscriptions: SubscriptionLimits {
            max_subscriptions_per_session: 10,
            min_sampling_interval_ms: 50.0,
            min_publishing_interval_ms: 50.0,
            max_keep_alive_count: 1_000,
            max_lifetime_count: 3_000,
            max_monitored_items_per_sub: 1_000,
            max_monitored_item_queue_size: 1_000,
            max_notifications_per_publish: 1_000,
            ..SubscriptionLimits::default()
        },
        ..Limits::default()
    }
}
