//! The network: what MTConnect agents, browsers and brokers are told, and that nothing which they do reaches the control.
//! Source: docs/manual, chapter "network"; ANSI/MTC1.4.

mod broker_faults;
mod mqtt;
mod mtconnect;
mod orders;
mod results;
mod site;
mod test_broker;
mod web_view;

use std::io::{ErrorKind, Read};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::time::{Duration, Instant};

use kt830::defs::kind::Kind;
use kt830::defs::param::ParamAddress;
use kt830::defs::part_record::PartRecord;
use kt830::defs::part_verdict::PartVerdict;
use kt830::defs::text::LocalizedText;
use kt830::defs::{alarm, param};
use kt830::gateway::{Gateway, GatewayThread, Painter};
use kt830::link::Snapshot;
use kt830::link::network::{NetworkView, ServiceState};
use kt830::link::observed::ObservedSnapshot;
use kt830::link::snapshot::AlarmView;
use kt830::units::{Axis, Micros};
use triple_buffer::{Input, Output, TripleBuffer};

/// Longest wait for the network of this computer.
const DEADLINE: Duration = Duration::from_secs(20);
const TIME: &str = "2026-11-29T01:02:03.000000Z";
/// When the snapshots of a [`Shop`] were taken.
const STEPPED_AT: Duration = Duration::from_secs(1_795_000_000);
const TIME_OF_STEPS: &str = "2026-11-18T11:06:40.000000Z";
/// A tick: 1 795 914 123 s after 1970 are [`TIME`].
const TAKEN: Micros = Micros(1_795_914_123_000_000);

/// A cylindrical grinder with the axes X and Z.
fn machine() -> Snapshot {
    let mut snapshot = Snapshot::new(Kind::Gc);
    for axis in [Axis::X, Axis::Z] {
        (snapshot.axes[axis].present, snapshot.axes[axis].homed) = (true, true);
    }
    snapshot
}

fn set(snapshot: &mut Snapshot, param: &str, value: f64) {
    let address = ParamAddress::parse(param).unwrap();
    std::sync::Arc::make_mut(&mut snapshot.params).write(address, value).unwrap();
}

/// A port that nobody uses now.
fn free_port() -> u16 {
    TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap().local_addr().unwrap().port()
}

fn raised(number: u16) -> AlarmView {
    let row = alarm::find(number);
    let text = row.map_or(LocalizedText::new("程序报警", "program alarm"), |row| LocalizedText::from(row.text));
    let cause = row.map_or_else(LocalizedText::default, |row| LocalizedText::from(row.cause));
    let none = LocalizedText::default();
    AlarmView { number, text, cause, remedy: none, variable: None, since: Micros::ZERO, place: None }
}

/// A finished part of 39.9985 mm.
fn part(count: u64, verdict: PartVerdict) -> PartRecord {
    PartRecord {
        count,
        number: 3,
        program: 1_002,
        order: 0,
        ended: Default::default(),
        cycle_seconds: 27.02,
        size: Some(39.9985),
        limits: Some([40.0, 39.995, 40.0]),
        verdict,
        since_dressing: 1,
        wheel_mm: Some(598.4),
        alarms: [103, 0, 0, 0],
    }
}

/// A gateway with its agents, stepped by the test: 20 ms a step.
struct Shop {
    gateway: Gateway,
    snapshot: Snapshot,
    port: u16,
    now: Duration,
}

impl Shop {
    fn new() -> Self {
        Self::with("P480", None)
    }

    /// A service with the port of a parameter.
    fn with(param: &str, painter: Option<Painter>) -> Self {
        let mut shop = Self { gateway: Gateway::new(painter), snapshot: machine(), port: 0, now: Duration::ZERO };
        for _ in 0..20 {
            shop.port = free_port();
            set(&mut shop.snapshot, param, shop.port.into());
            shop.step();
            let NetworkView { mtconnect, web, .. } = shop.gateway.view();
            if [mtconnect.state, web.state].contains(&ServiceState::Listening) {
                return shop;
            }
        }
        panic!("no port is free");
    }

    fn step(&mut self) {
        self.now += Duration::from_millis(20);
        self.gateway.step(self.now, STEPPED_AT, &self.snapshot);
    }

    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect((Ipv4Addr::LOCALHOST, self.port)).unwrap();
        stream.set_nonblocking(true).unwrap();
        stream
    }

    /// Steps until the agent has received something that ends with these words.
    fn until(&mut self, agent: &mut TcpStream, words: &str) -> String {
        let (begun, mut told) = (Instant::now(), String::new());
        while !told.contains(words) {
            assert!(begun.elapsed() < DEADLINE, "{words} is missing: {told}");
            self.step();
            std::thread::sleep(Duration::from_millis(1));
            receive(agent, &mut told);
        }
        told
    }

    /// Steps until something is true of the view.
    fn until_view(&mut self, what: &str, seen: impl Fn(&Self) -> bool) {
        let begun = Instant::now();
        while !seen(self) {
            assert!(begun.elapsed() < DEADLINE, "{what}: {:?}", self.gateway.view());
            self.step();
            std::thread::yield_now();
        }
    }
}

/// What has come; the lines of these tests are ASCII.
fn receive(agent: &mut TcpStream, into: &mut String) {
    let mut bytes = [0; 65_536];
    match agent.read(&mut bytes) {
        Ok(count) => into.extend(bytes[..count].iter().map(|byte| char::from(*byte))),
        Err(error) => assert_eq!(error.kind(), ErrorKind::WouldBlock),
    }
}

#[test]
fn off_by_factory_nothing_listens() {
    for kind in Kind::ALL {
        let params = &Snapshot::new(kind).params;
        assert!([param::MTCONNECT_PORT, param::WEB_PORT].iter().all(|port| params.get(*port).abs() < 0.5));
    }
    let mut gateway = Gateway::default();
    gateway.step(Duration::ZERO, Duration::ZERO, &machine());
    let view = gateway.view();
    for service in [view.mtconnect, view.web] {
        assert_eq!((service.state, service.address), (ServiceState::Off, String::new()));
    }
}

#[test]
fn a_port_is_of_this_computer_alone_unless_it_is_opened_to_the_network() {
    let mut shop = Shop::new();
    assert_eq!(shop.gateway.view().mtconnect.address, format!("127.0.0.1:{}", shop.port));
    set(&mut shop.snapshot, "P481", 1.0);
    shop.step();
    assert_eq!(shop.gateway.view().mtconnect.address, format!("0.0.0.0:{}", shop.port));
    set(&mut shop.snapshot, "P480", 0.0);
    shop.step();
    assert_eq!(shop.gateway.view().mtconnect.state, ServiceState::Off);
    assert!(TcpStream::connect((Ipv4Addr::LOCALHOST, shop.port)).is_err(), "still open");
}

#[test]
fn a_port_in_use_is_said_and_tried_again() {
    let taken = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    let (mut snapshot, port) = (machine(), taken.local_addr().unwrap().port());
    set(&mut snapshot, "P480", port.into());
    let mut gateway = Gateway::default();
    let second = Duration::from_secs(1);
    gateway.step(second, Duration::ZERO, &snapshot);
    let view = gateway.view().mtconnect;
    assert!(matches!(&view.state, ServiceState::Failed(why) if why.en().contains("in use")), "{view:?}");
    assert_eq!(view.address, format!(":{port}"));
    drop(taken);
    gateway.step(5 * second, Duration::ZERO, &snapshot);
    assert!(matches!(gateway.view().mtconnect.state, ServiceState::Failed(_)), "not in every step");
    gateway.step(6 * second, Duration::ZERO, &snapshot);
    assert_eq!(gateway.view().mtconnect.state, ServiceState::Listening);
}

/// A gateway on its thread, where its snapshots go in, and where it tells its page.
fn on_thread(snapshot: &Snapshot) -> (GatewayThread, Input<ObservedSnapshot>, Output<Option<NetworkView>>) {
    let first = ObservedSnapshot { snapshot: snapshot.clone(), taken: TAKEN };
    let (input, output) = TripleBuffer::new(&first).split();
    let (tell, told) = TripleBuffer::default().split();
    (GatewayThread::start(output, Gateway::default(), tell).unwrap(), input, told)
}

/// A control whose snapshots stop loses its agents, so that they do not take old values for new ones; the page is told who
/// is connected, once a second at most.
#[test]
fn a_control_that_stands_still_loses_its_agents() {
    let (mut snapshot, port) = (machine(), free_port());
    set(&mut snapshot, "P480", port.into());
    let (_gateway, mut input, mut told) = on_thread(&snapshot);
    let begun = Instant::now();
    let mut publish = |snapshot: &Snapshot| {
        input.input_buffer_mut().snapshot.clone_from(snapshot);
        input.publish();
    };
    let mut agent = loop {
        assert!(begun.elapsed() < DEADLINE, "never listens");
        publish(&snapshot);
        if let Ok(agent) = TcpStream::connect((Ipv4Addr::LOCALHOST, port)) {
            break agent;
        }
        std::thread::sleep(Duration::from_millis(1));
    };
    agent.set_read_timeout(Some(DEADLINE)).unwrap();
    // Nothing is published from here on: everything is told, then the connection ends.
    let mut everything = String::new();
    agent.read_to_string(&mut everything).unwrap();
    assert!(everything.contains("|avail|AVAILABLE"), "{everything}");
    let is_of_tick = |line: &&str| line.starts_with("* ") || line.starts_with(&format!("{TIME}|"));
    assert!(everything.lines().all(|line| is_of_tick(&line)), "as old as the tick: {everything}");
    assert!(told.update() && told.output_buffer_mut().is_some(), "the page is told");
}

/// What the page is told first.
fn first(told: &mut Output<Option<NetworkView>>) -> NetworkView {
    let begun = Instant::now();
    while !told.update() {
        assert!(begun.elapsed() < DEADLINE, "the page is told nothing");
        std::thread::sleep(Duration::from_millis(1));
    }
    told.output_buffer_mut().take().unwrap()
}

/// With both ports off the page is told so: it must not say that there is no network.
#[test]
fn a_gateway_that_is_off_says_so() {
    let (gateway, mut input, mut told) = on_thread(&machine());
    input.publish();
    assert_eq!(first(&mut told), NetworkView::default());
    drop(gateway);
}

/// Connections by the thousand, while the gateway ends: it does not wait for the flood.
#[test]
fn a_flood_of_connections_does_not_hold_the_end_up() {
    let (mut snapshot, port) = (machine(), free_port());
    set(&mut snapshot, "P480", port.into());
    let (gateway, mut input, mut told) = on_thread(&snapshot);
    input.input_buffer_mut().snapshot.clone_from(&snapshot);
    input.publish();
    let first = first(&mut told);
    assert_eq!(first.mtconnect.state, ServiceState::Listening, "{first:?}");
    let over = std::sync::atomic::AtomicBool::new(false);
    std::thread::scope(|scope| {
        let flood = scope.spawn(|| {
            let mut count = 0_u32;
            while !over.load(std::sync::atomic::Ordering::Relaxed) {
                count += u32::from(TcpStream::connect((Ipv4Addr::LOCALHOST, port)).is_ok());
            }
            count
        });
        std::thread::sleep(Duration::from_millis(300));
        drop(gateway);
        over.store(true, std::sync::atomic::Ordering::Relaxed);
        assert!(flood.join().unwrap() > 100, "no flood");
    });
}
