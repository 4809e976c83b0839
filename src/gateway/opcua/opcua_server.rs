//! The server: waits for a control, shows it to clients, and begins anew when it is another machine or when nobody is
//! connected any more.

use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::net::{Ipv4Addr, SocketAddr};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use crossbeam_channel::Receiver;
use opcua::crypto::SecurityPolicy;
use opcua::nodes::Event;
use opcua::server::node_manager::ServerContext;
use opcua::server::node_manager::memory::InMemoryNodeManagerBuilder;
use opcua::server::{Limits, ServerBuilder, ServerEndpoint, ServerHandle, SubscriptionLimits};
use opcua::types::{BuildInfo, DataValue, DateTime, MessageSecurityMode, NodeId, StatusCode, VariableId, Variant};
use tokio::net::TcpListener;
use tokio::runtime::Runtime;
use tokio::sync::oneshot;
use tokio::task::JoinHandle;

use super::accounts::{Accounts, Admitted};
use super::adapter_client::AdapterClient;
use super::adapter_state::{AdapterEvent, AdapterState, ToldOrder};
use super::alert_event::AlertEvent;
use super::certificates::{self, OWN_CERTIFICATE, PRIVATE_KEY};
use super::gatekeeper;
use super::log::log_line;
use super::machine_tool::MachineNodes;
use super::node_manager::{EventFields, MachineBuilder, MachineNodeManager};
use super::order_desk::{MOST_WAITING, OrderCall, OrderDesk};
use super::source_clock::SourceClock;
use crate::gateway::opcua_report::OpcUaReport;

/// Time between two trials to reach the control.
const RETRY_INTERVAL: Duration = Duration::from_secs(1);
/// A server that nobody has used for so long begins anew if somebody had.
const LONGEST_IDLE: Duration = Duration::from_secs(60);
/// A server that is to end has so long.
const END_TIMEOUT: Duration = Duration::from_secs(5);
/// Subscriptions after which a server begins anew even if somebody is connected.
const MOST_SUBSCRIPTIONS: u32 = 100;
/// Time between two reports to the control.
const REPORT_INTERVAL: Duration = Duration::from_secs(2);
/// Time between two looks whether somebody is connected.
const LOOK_INTERVAL: Duration = Duration::from_secs(5);
/// A control that has not said in this time who it is, is none, or an older one.
const WELCOME_TIME: Duration = Duration::from_secs(10);
/// After the last part of a welcome its alarms have come, too.
const SETTLING_TIME: Duration = Duration::from_millis(500);

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

impl OpcUaSettings {
    /// Where clients reach it.
    fn address(&self) -> String {
        format!("opc.tcp://{}:{}/", self.host, self.listen.port())
    }
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
        certificates::ensure_own(&settings.folder, &application_uri(&settings.host), &settings.host)?;
        let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(1).enable_all().build();
        Ok(Self { settings, runtime: runtime.map_err(|error| error.to_string())? })
    }

    /// Serves until it is over.
    ///
    /// # Errors
    /// The port cannot be opened.
    pub fn serve(&self, is_over: &dyn Fn() -> bool, tell: TellState) -> Result<(), String> {
        let mut state = AdapterState::default();
        let listening = self.runtime.block_on(TcpListener::bind(self.settings.listen));
        let listener = Arc::new(listening.map_err(|error| format!("{}: {error}", self.settings.listen))?);
        while !is_over() {
            let Some(client) = self.first_contact(&mut state, is_over, tell) else { return Ok(()) };
            let running = self.runtime.block_on(Running::start(&self.settings, Arc::clone(&listener), &state))?;
            tell(&format!("{} at {}", state.identity.uuid, self.settings.address()));
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
            match self.welcome(is_over) {
                Ok((client, welcome)) => {
                    *state = welcome;
                    return Some(client);
                }
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

    /// Connects to the control and takes its welcome, with the alarms that stand.
    fn welcome(&self, is_over: &dyn Fn() -> bool) -> std::io::Result<(AdapterClient, AdapterState)> {
        let mut client = AdapterClient::connect(&self.settings.control)?;
        let (mut state, begun) = (AdapterState::default(), Instant::now());
        let mut complete_at = None;
        while !is_over() && begun.elapsed() < WELCOME_TIME {
            client.lines()?.iter().for_each(|line| drop(state.take(line)));
            if state.is_complete() && complete_at.get_or_insert_with(Instant::now).elapsed() >= SETTLING_TIME {
                return Ok((client, state));
            }
        }
        Err(std::io::Error::other("it does not say which machine it is: another service, or an older control?"))
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
        let (mut client, mut idle) = (Some(client), IdleWatch::default());
        let known_items: Vec<String> = state.items().map(str::to_owned).collect();
        running.show(Some(state));
        running.show_plan(Some(state));
        while !is_over() {
            let lines = client.as_mut().map(|client| {
                running.report(client, &self.settings)?;
                running.propose(client)?;
                client.lines()
            });
            match lines {
                Some(Ok(lines)) => {
                    let identity = state.identity.clone();
                    running.take(&lines, state);
                    if state.identity != identity {
                        return Ended::Renew;
                    }
                }
                Some(Err(_)) => {
                    client = None;
                    tell("the control is silent");
                    running.show_silence();
                }
                None => {
                    std::thread::sleep(RETRY_INTERVAL);
                    running.refuse_orders();
                    if let Ok((connected, welcome)) = self.welcome(is_over) {
                        if welcome.identity != state.identity {
                            return Ended::Renew;
                        }
                        running.change_to(welcome, state);
                        client = Some(connected);
                    }
                }
            }
            // An axis, a gauge or a port that the machine has got, or lost, since.
            let has_other_items = !state.items().eq(known_items.iter().map(String::as_str));
            if has_other_items || running.clock.is_wrong() || idle.is_over(running) {
                return Ended::Renew;
            }
        }
        Ended::Over
    }
}

/// Name of the application, as its certificate has it.
fn application_uri(host: &str) -> String {
    format!("urn:{host}:kt830:opcua")
}

/// Watches whether a server that was used is used no more, or was used too much: the library keeps what clients have
/// subscribed to.
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
        certificates::limit_rejected(&running.folder);
        if running.has_revoked() {
            log_line("a user or a certificate was taken away or changed: all clients are disconnected");
            return true;
        }
        if running.subscriptions() >= MOST_SUBSCRIPTIONS {
            return true;
        }
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
    /// Lets clients through to it.
    gate: JoinHandle<()>,
    manager: Arc<MachineNodeManager>,
    nodes: Arc<MachineNodes>,
    clock: SourceClock,
    /// When the control was told how the server does.
    reported_at: Cell<Option<Instant>>,
    folder: PathBuf,
    /// Who might come in at the last look.
    admitted: RefCell<Admitted>,
    /// Orders that clients hand in.
    calls: Receiver<OrderCall>,
    /// Who waits for the answers of the control, in their order.
    waiting: RefCell<VecDeque<oneshot::Sender<String>>>,
    /// The orders that have jobs in the plan.
    jobs: RefCell<Vec<ToldOrder>>,
}

impl Running {
    /// Begins to serve those who come to the port.
    async fn start(settings: &OpcUaSettings, listener: Arc<TcpListener>, state: &AdapterState) -> Result<Self, String> {
        let inner = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).await.map_err(|error| error.to_string())?;
        let address = inner.local_addr().map_err(|error| error.to_string())?;
        let (desk, calls) = OrderDesk::open();
        let builder = builder(settings)
            .with_node_manager(InMemoryNodeManagerBuilder::new(MachineBuilder { state: state.clone(), desk }))
            .with_node_manager(|_: ServerContext| EventFields);
        let (server, handle) = builder.build()?;
        let manager = handle.node_managers().get_of_type::<MachineNodeManager>();
        let manager = manager.ok_or("the address space is missing")?;
        if let Some(fault) = &manager.inner().fault {
            return Err(fault.clone());
        }
        let nodes = Arc::clone(&manager.inner().nodes);
        let task = tokio::spawn(server.run_with(inner));
        let gate = tokio::spawn(gatekeeper::keep(listener, address, settings.folder.clone()));
        let folder = settings.folder.clone();
        let admitted = RefCell::new(Admitted::read(&folder));
        Ok(Self {
            handle,
            task,
            gate,
            manager,
            nodes,
            clock: SourceClock::new(),
            reported_at: Cell::default(),
            folder,
            admitted,
            calls,
            waiting: RefCell::default(),
            jobs: RefCell::default(),
        })
    }

    /// Ends the connections.
    async fn end(self) {
        self.gate.abort();
        self.handle.cancel();
        let mut task = self.task;
        if tokio::time::timeout(END_TIMEOUT, &mut task).await.is_err() {
            task.abort();
        }
    }

    /// Another connection has told this: values, alarms that have come and gone meanwhile.
    fn change_to(&self, welcome: AdapterState, state: &mut AdapterState) {
        let changes = state.changes_to(&welcome);
        let time = self.clock.not_ahead(time_of(&welcome));
        let events: Vec<_> = changes.into_iter().filter_map(|change| self.event_of(change, time)).collect();
        *state = welcome;
        self.show(Some(state));
        self.show_plan(Some(state));
        self.tell(&events);
    }

    fn event_of(&self, change: AdapterEvent, time: DateTime) -> Option<AlertEvent> {
        Some(match change {
            AdapterEvent::Value(_) | AdapterEvent::Orders | AdapterEvent::OrderAnswer(_) => return None,
            AdapterEvent::Message(text) if text.is_empty() => return None,
            AdapterEvent::Message(text) => AlertEvent::of_message(&self.nodes, &text, time),
            AdapterEvent::Raised(alarm) => AlertEvent::of_alarm(&self.nodes, &alarm, true, time),
            AdapterEvent::Cleared(alarm) => AlertEvent::of_alarm(&self.nodes, &alarm, false, time),
        })
    }

    fn tell(&self, events: &[AlertEvent]) {
        let told = events.iter().map(|event| (event as &dyn Event, &self.nodes.messages));
        self.handle.subscriptions().notify_events(told);
    }

    /// Takes lines of the control: values that have changed, and events.
    fn take(&self, lines: &[String], state: &mut AdapterState) {
        let (mut is_changed, mut has_new_orders, mut events) = (false, false, Vec::new());
        for line in lines {
            for event in state.take(line) {
                match event {
                    AdapterEvent::Orders => has_new_orders = true,
                    AdapterEvent::OrderAnswer(answer) => self.answer(answer),
                    event => {
                        is_changed = true;
                        events.extend(self.event_of(event, self.clock.not_ahead(time_of(state))));
                    }
                }
            }
        }
        if is_changed {
            self.show(Some(state));
        }
        if has_new_orders {
            self.show_plan(Some(state));
        }
        self.tell(&events);
    }

    /// Tells the control now and then how the server does.
    fn report(&self, client: &mut AdapterClient, settings: &OpcUaSettings) -> std::io::Result<()> {
        if self.reported_at.get().is_some_and(|at| at.elapsed() < REPORT_INTERVAL) {
            return Ok(());
        }
        self.reported_at.set(Some(Instant::now()));
        let report = OpcUaReport {
            address: settings.address(),
            clients: self.sessions(),
            untrusted: u32::try_from(certificates::rejected_count(&self.folder)).unwrap_or(u32::MAX),
            until: certificates::own_end(&self.folder),
        };
        client.report(&report.line())
    }

    /// Hands the orders of clients on to the control.
    fn propose(&self, client: &mut AdapterClient) -> std::io::Result<()> {
        let mut waiting = self.waiting.borrow_mut();
        // One that has waited too long was answered so: it must not be proposed any more.
        for OrderCall { text, answer } in self.calls.try_iter().filter(|call| !call.answer.is_closed()) {
            // A control that does not answer takes no more of them.
            if waiting.len() < MOST_WAITING {
                client.propose(&text)?;
                waiting.push_back(answer);
            }
        }
        Ok(())
    }

    /// The control has answered the order that was handed on first.
    fn answer(&self, answer: String) {
        if let Some(waiting) = self.waiting.borrow_mut().pop_front() {
            // Who waited too long is gone.
            drop(waiting.send(answer));
        }
    }

    /// Without a control nobody's order is taken: who waits is told so.
    fn refuse_orders(&self) {
        self.waiting.borrow_mut().clear();
        self.calls.try_iter().for_each(drop);
    }

    /// Nothing is known of the control any more.
    fn show_silence(&self) {
        self.refuse_orders();
        self.show(None);
        self.show_plan(None);
    }

    /// Shows the orders, or that there is no control.
    fn show_plan(&self, state: Option<&AdapterState>) {
        let mut jobs = self.jobs.borrow_mut();
        if let Some(state) = state {
            self.nodes.plan.change(&mut self.manager.address_space().write(), &jobs, state.orders());
            state.orders().clone_into(&mut jobs);
        }
        let values = self.nodes.plan.values(&jobs);
        let source = self.clock.of_no_tick();
        self.set(source, values.iter().map(|(id, value)| (id, state.map(|_| Some(value.clone())))));
    }

    /// Shows the values of a control, or that there is none.
    fn show(&self, state: Option<&AdapterState>) {
        let variables = self.nodes.variables.iter();
        let source = match state {
            Some(state) => self.clock.of_tick(time_of(state), state.age()),
            None => self.clock.of_no_tick(),
        };
        self.set(source, variables.map(|variable| (&variable.id, state.map(|state| (variable.read)(state)))));
    }

    /// Sets variables: none without a control, and none in that where nothing is known.
    fn set<'a>(&self, source: DateTime, variables: impl Iterator<Item = (&'a NodeId, Option<Option<Variant>>)>) {
        let now = self.clock.now();
        let values = variables.map(|(id, told)| {
            let status = match &told {
                None => StatusCode::BadNoCommunication,
                Some(None) => StatusCode::BadNoData,
                Some(Some(_)) => StatusCode::Good,
            };
            let value = DataValue {
                // Without a value the library would show the status as good.
                value: Some(told.flatten().unwrap_or(Variant::Empty)),
                status: Some(status),
                source_timestamp: Some(source),
                server_timestamp: Some(now),
                ..DataValue::default()
            };
            (id, None, value)
        });
        if let Err(status) = self.manager.set_values(self.handle.subscriptions(), values) {
            log_line(&format!("values: {status}"));
        }
    }

    /// Whether somebody who might be connected since the last look may not be any more.
    fn has_revoked(&self) -> bool {
        let newer = Admitted::read(&self.folder);
        let is_revoked = self.admitted.borrow().is_revoked_by(&newer);
        self.admitted.replace(newer);
        is_revoked
    }

    /// How many clients are connected.
    fn sessions(&self) -> u32 {
        self.count(VariableId::Server_ServerDiagnostics_ServerDiagnosticsSummary_CurrentSessionCount)
    }

    /// How many subscriptions there have been.
    fn subscriptions(&self) -> u32 {
        self.count(VariableId::Server_ServerDiagnostics_ServerDiagnosticsSummary_CumulatedSubscriptionCount)
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
        .discovery_urls(vec![settings.address()])
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
        max_sessions: 100,
        receive_buffer_size: gatekeeper::LONGEST_MESSAGE,
        subscriptions: SubscriptionLimits {
            max_subscriptions_per_session: 10,
            min_sampling_interval_ms: 50.0,
            min_publishing_interval_ms: 50.0,
            max_keep_alive_count: 1_000,
            max_lifetime_count: 3_000,
            max_monitored_items_per_sub: 500,
            max_monitored_item_queue_size: 1_000,
            max_notifications_per_publish: 1_000,
            ..SubscriptionLimits::default()
        },
        ..Limits::default()
    }
}
