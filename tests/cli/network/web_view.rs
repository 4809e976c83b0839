//! What a browser sees, and that it can only look.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{ErrorKind, Read, Write};
use std::net::TcpStream;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use kt830::defs::alarm;
use kt830::defs::part_record::PartHistory;
use kt830::defs::part_verdict::PartVerdict;
use kt830::gateway::{Gateway, Painter, set_viewer_password};
use kt830::link::network::ServiceState;
use kt830::link::snapshot::RunState;
use kt830::units::Axis;
use rustls::pki_types::CertificateDer;
use rustls::pki_types::pem::PemObject;
use rustls::{ClientConfig, ClientConnection, RootCertStore, StreamOwned};

use super::{DEADLINE, Shop, free_port, machine, part, raised, set};

impl Shop {
    /// A browser asks; the whole answer, with its head.
    fn ask(&mut self, request: &[u8]) -> Vec<u8> {
        let mut browser = self.connect();
        browser.write_all(request).unwrap();
        let (begun, mut answer) = (Instant::now(), Vec::new());
        loop {
            assert!(begun.elapsed() < DEADLINE, "no answer to {}", String::from_utf8_lossy(request));
            self.step();
            match browser.read_to_end(&mut answer) {
                Ok(_) => return answer,
                Err(error) if error.kind() == ErrorKind::WouldBlock => {
                    std::thread::sleep(Duration::from_millis(1));
                }
                Err(error) => panic!("{error}"),
            }
        }
    }

    fn get(&mut self, path: &str) -> (String, Vec<u8>) {
        let answer = self.ask(format!("GET {path} HTTP/1.1\r\nHost: localhost:{}\r\n\r\n", self.port).as_bytes());
        let end = answer.windows(4).position(|four| four == b"\r\n\r\n").expect("a head");
        (String::from_utf8(answer[..end].to_vec()).unwrap(), answer[end + 4..].to_vec())
    }
}

#[test]
fn a_browser_sees_the_state_the_alarms_and_the_trend() {
    let mut shop = Shop::with("P483", None);
    shop.snapshot.state = RunState::Alarm;
    shop.snapshot.alarms.push(raised(alarm::HYDRAULIC_PRESSURE));
    shop.snapshot.feed_mm_min = f64::NAN;
    shop.snapshot.production.parts = PartHistory::new([part(41, PartVerdict::Good)], 1);
    let (head, body) = shop.get("/state.json");
    assert!(head.starts_with("HTTP/1.1 200 OK\r\n") && head.contains("no-store"), "{head}");
    assert!(head.contains(&format!("Content-Length: {}", body.len())), "{head}");
    let state: serde_json::Value = serde_json::from_slice(&body).unwrap();
    assert_eq!(state["items"]["execution"], "STOPPED");
    assert_eq!(state["time"], super::TIME_OF_STEPS);
    assert_eq!(state["items"]["feed"], serde_json::Value::Null);
    assert_eq!(state["alarms"][0]["number"], 180);
    assert_eq!(state["alarms"][0]["text"]["zh"], "砂轮启动时液压异常");
    assert_eq!(state["sizes"][0]["size"], 39.9985);
    let (head, body) = shop.get("/?from=phone");
    assert!(head.contains("text/html; charset=utf-8") && head.contains("default-src 'none'"), "{head}");
    assert!(body.starts_with(b"<!doctype html>"));
}

#[test]
fn a_browser_gets_the_picture_once_it_is_painted_at_most_one_a_second() {
    let (painted, count) = crossbeam_channel::unbounded();
    let painter: Painter = Box::new(move |snapshot| {
        painted.send(snapshot.parts_counted).unwrap();
        assert!(snapshot.host.network.as_ref().is_some_and(|network| network.web.state == ServiceState::Listening));
        Some(format!("picture {}", snapshot.parts_counted).into_bytes())
    });
    let mut shop = Shop::with("P483", Some(painter));
    (0..100).for_each(|_| shop.step());
    shop.snapshot.parts_counted = 7;
    let (head, _) = shop.get("/screen.png");
    assert!(head.starts_with("HTTP/1.1 503 "), "{head}");
    let begun = Instant::now();
    let body = loop {
        assert!(begun.elapsed() < DEADLINE, "no picture");
        let (head, body) = shop.get("/screen.png");
        if head.contains("image/png") {
            break body;
        }
    };
    // What was painted before anybody had asked would come first.
    assert_eq!((body.as_slice(), count.try_recv()), (b"picture 7".as_slice(), Ok(7)));
    let from = shop.now;
    while count.is_empty() {
        assert!(begun.elapsed() < DEADLINE, "no second picture");
        shop.get("/screen.png");
    }
    while shop.now - from < Duration::from_secs(5) {
        shop.get("/screen.png");
    }
    let pictures = count.try_iter().count() as u64;
    assert!(pictures <= shop.now.as_secs() + 1, "{pictures} in {:?}", shop.now);
    // Nobody looks for a while: the next one who does is not shown an old picture.
    shop.now += Duration::from_secs(60);
    let (head, _) = shop.get("/screen.png");
    assert!(head.starts_with("HTTP/1.1 503 "), "{head}");
}

#[test]
fn a_browser_can_only_look() {
    let mut shop = Shop::with("P483", None);
    let host = "Host: 127.0.0.1\r\n\r\n";
    for (request, status) in [
        (format!("POST /state.json HTTP/1.1\r\n{host}"), "405"),
        (format!("PUT / HTTP/1.1\r\n{host}"), "405"),
        (format!("GET /../retained.redb HTTP/1.1\r\n{host}"), "404"),
        (format!("GET /state.json/ HTTP/1.0\r\n{host}"), "404"),
        ("GET / HTTP/1.1\r\nHost: machine.example\r\n\r\n".to_owned(), "403"),
        ("GET / HTTP/1.1\r\n\r\n".to_owned(), "403"),
        ("* PING\n\r\n\r\n".to_owned(), "400"),
        ("\u{0}\u{1}\r\n\r\n".to_owned(), "400"),
    ] {
        let answer = shop.ask(request.as_bytes());
        assert!(
            answer.starts_with(format!("HTTP/1.1 {status} ").as_bytes()),
            "{request}: {}",
            String::from_utf8_lossy(&answer)
        );
    }
    // However far it is opened, the view stays on this computer.
    set(&mut shop.snapshot, "P481", 1.0);
    shop.step();
    assert_eq!(shop.gateway.view().web.address, format!("127.0.0.1:{}", shop.port));
}

/// A client that sends no more still gets its answer; one that keeps an answered connection open loses it after a second,
/// and is no fault.
#[test]
fn a_half_closed_client_gets_its_answer_and_an_open_one_loses_its_place() {
    let mut shop = Shop::with("P483", None);
    let mut half = shop.connect();
    half.write_all(b"GET /state.json HTTP/1.1\r\nHost: localhost\r\n\r\n").unwrap();
    half.shutdown(std::net::Shutdown::Write).unwrap();
    let (begun, mut answer) = (Instant::now(), Vec::new());
    while half.read_to_end(&mut answer).is_err() {
        assert!(begun.elapsed() < DEADLINE, "no answer");
        shop.step();
    }
    assert!(answer.starts_with(b"HTTP/1.1 200") && answer.ends_with(b"}"));
    let mut open = shop.connect();
    open.write_all(b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n").unwrap();
    shop.until_view("it is taken", |shop| !shop.gateway.view().web.clients.is_empty());
    let from = shop.now;
    shop.until_view("it has gone", |shop| shop.gateway.view().web.clients.is_empty());
    assert!(shop.now - from < Duration::from_secs(2), "{:?}", shop.now - from);
    assert_eq!(shop.gateway.view().web.dropped, 0);
}

#[test]
fn slow_and_endless_requests_are_given_up() {
    let mut shop = Shop::with("P483", None);
    let mut slow = shop.connect();
    slow.write_all(b"GET / HTTP/1.1\r\nHost: local").unwrap();
    let mut endless = shop.connect();
    endless.write_all(&[b"GET /".as_slice(), &[b'a'; 16_384]].concat()).unwrap();
    shop.until_view("the endless one is given up", |shop| shop.gateway.view().web.dropped >= 1);
    let ten = Duration::from_secs(10);
    while shop.gateway.view().web.dropped < 2 {
        shop.step();
        assert!(shop.now < 2 * ten, "still waiting");
    }
    assert!(shop.now > ten, "too early: {:?}", shop.now);
    let dropped = shop.gateway.view().web.dropped;
    let idle: Vec<TcpStream> = (0..40).map(|_| shop.connect()).collect();
    shop.until_view("sixteen have places", |shop| shop.gateway.view().web.dropped == dropped + 24);
    assert!(shop.get("/").0.starts_with("HTTP/1.1 200"), "idle connections keep nobody out");
    drop(idle);
    shop.until_view("all have gone", |shop| shop.gateway.view().web.clients.is_empty());
    assert!(shop.get("/").0.starts_with("HTTP/1.1 200"));
}

/// The metrics of a machine, by their names with labels.
fn metrics(shop: &mut Shop) -> BTreeMap<String, f64> {
    let (head, body) = shop.get("/metrics");
    assert!(head.contains("Content-Type: text/plain; version=0.0.4"), "{head}");
    let text = String::from_utf8(body).unwrap();
    let samples = text.lines().filter(|line| !line.starts_with('#'));
    let read = samples.map(|line| line.rsplit_once(' ').map(|(name, value)| (name.to_owned(), value.parse().unwrap())));
    read.collect::<Option<_>>().expect("a name and a value in each line")
}

#[test]
fn prometheus_reads_the_state_the_values_and_the_alarms() {
    let mut shop = Shop::with("P483", None);
    set(&mut shop.snapshot, "P482", 123.0);
    shop.snapshot.state = RunState::Running;
    shop.snapshot.feed_mm_min = 120.0;
    shop.snapshot.axes[Axis::X].homed = false;
    shop.snapshot.alarms.push(raised(alarm::HYDRAULIC_PRESSURE));
    let spoilt = PartVerdict::Spoilt(kt830::defs::part_defect::PartDefect::Burn);
    shop.snapshot.production.parts = PartHistory::new([part(41, spoilt)], 1);
    let told = metrics(&mut shop);
    let machine = "machine=\"kt830-gc-000123\"";
    let value = |name: &str, labels: &str| told.get(&format!("{name}{{{machine}{labels}}}")).copied();
    assert_eq!(value("kt830_execution", ",state=\"ACTIVE\""), Some(1.0));
    assert_eq!(value("kt830_execution", ",state=\"READY\""), Some(0.0));
    // 120 mm/min are 2 mm/s; what is not known is not told.
    assert_eq!(value("kt830_value", ",item=\"feed\",units=\"MILLIMETER/SECOND\""), Some(2.0));
    assert_eq!(value("kt830_value", ",item=\"x_work\",units=\"MILLIMETER\""), None);
    assert_eq!(value("kt830_alarm", ",number=\"180\",level=\"FAULT\""), Some(1.0));
    assert_eq!((value("kt830_parts_total", ""), value("kt830_last_part_bad", "")), (Some(41.0), Some(1.0)));
    for state in [
        RunState::Idle,
        RunState::Running,
        RunState::Held,
        RunState::Stopped,
        RunState::Waiting,
        RunState::Homing,
        RunState::Alarm,
    ] {
        shop.snapshot.state = state;
        let told = metrics(&mut shop);
        let ones = told.iter().filter(|(name, value)| name.starts_with("kt830_execution") && **value > 0.5);
        assert_eq!(ones.count(), 1, "{state:?}");
    }
}

/// The examples in `docs/shop` ask for what the control tells.
#[test]
fn the_dashboards_ask_for_metrics_and_items_that_there_are() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/shop/grafana/dashboards/kt830.json");
    let dashboard = std::fs::read_to_string(folder).unwrap();
    let read: serde_json::Value = serde_json::from_str(&dashboard).unwrap();
    assert!(read["panels"].as_array().is_some_and(|panels| panels.len() >= 5), "panels");
    let mut shop = Shop::with("P483", None);
    shop.snapshot.alarms.push(raised(alarm::HYDRAULIC_PRESSURE));
    shop.snapshot.production.parts = PartHistory::new([part(41, PartVerdict::Good)], 1);
    let told = metrics(&mut shop);
    let names: BTreeSet<&str> = told.keys().map(|name| name.split('{').next().unwrap()).collect();
    let is_word = |sign: char| sign.is_ascii_alphanumeric() || sign == '_';
    let asked: BTreeSet<&str> =
        dashboard.split(|sign| !is_word(sign)).filter(|word| word.starts_with("kt830_")).collect();
    assert_eq!(asked, names, "every metric is shown");
    let items: BTreeSet<String> = kt830::link::data_item::all_data_items().map(|item| item.id()).collect();
    for asked in dashboard.split("item=\\\"").skip(1) {
        let item = asked.split('\\').next().unwrap();
        assert!(items.contains(item), "there is no item {item}");
    }
}

/// A view for other computers.
struct GuardedView {
    shop: Shop,
    folder: tempfile::TempDir,
}

impl GuardedView {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        set_viewer_password(folder.path(), "correct horse", vec!["localhost".to_owned()]).unwrap();
        let gateway = Gateway::default().with_folder(folder.path().to_path_buf());
        let mut shop = Shop { gateway, snapshot: machine(), port: 0, now: Duration::ZERO };
        set(&mut shop.snapshot, "P486", 1.0);
        for _ in 0..20 {
            shop.port = free_port();
            set(&mut shop.snapshot, "P483", shop.port.into());
            shop.step();
            if shop.gateway.view().web.state == ServiceState::Listening {
                return Self { shop, folder };
            }
        }
        panic!("{:?}", shop.gateway.view().web);
    }

    /// A browser that trusts the certificate of the control asks for the state with a password.
    fn ask(&mut self, password: Option<&str>) -> String {
        let request = match password {
            Some(password) => {
                let credentials = BASE64_STANDARD.encode(format!("viewer:{password}"));
                format!("GET /state.json HTTP/1.1\r\nHost: grinder\r\nAuthorization: Basic {credentials}\r\n\r\n")
            }
            None => "GET /state.json HTTP/1.1\r\nHost: grinder\r\n\r\n".to_owned(),
        };
        let mut roots = RootCertStore::empty();
        roots.add(CertificateDer::from_pem_file(self.folder.path().join("web.pem")).unwrap()).unwrap();
        let provider = Arc::new(rustls::crypto::ring::default_provider());
        let config = ClientConfig::builder_with_provider(provider)
            .with_safe_default_protocol_versions()
            .unwrap()
            .with_root_certificates(roots)
            .with_no_client_auth();
        let session = ClientConnection::new(Arc::new(config), "localhost".try_into().unwrap()).unwrap();
        let mut browser = StreamOwned::new(session, self.shop.connect());
        let (begun, mut sent, mut answer) = (Instant::now(), 0, Vec::new());
        let mut bytes = [0; 65_536];
        loop {
            assert!(begun.elapsed() < DEADLINE, "no answer");
            self.shop.step();
            std::thread::sleep(Duration::from_millis(1));
            if sent < request.len() {
                sent += browser.write(&request.as_bytes()[sent..]).unwrap_or(0);
            }
            match browser.read(&mut bytes) {
                // It ends with a word of TLS: nothing was cut off.
                Ok(0) => return String::from_utf8(answer).unwrap(),
                Ok(count) => answer.extend_from_slice(&bytes[..count]),
                Err(error) => assert_eq!(error.kind(), ErrorKind::WouldBlock, "{error}"),
            }
        }
    }
}

#[test]
fn other_computers_look_in_tls_and_with_the_password_alone() {
    let mut guarded = GuardedView::new();
    assert_eq!(guarded.shop.gateway.view().web.address, format!("0.0.0.0:{}", guarded.shop.port));
    let refused = guarded.ask(None);
    assert!(refused.starts_with("HTTP/1.1 401 ") && refused.contains("WWW-Authenticate: Basic"), "{refused}");
    for wrong in ["wrong", "", "correct horse "] {
        assert!(guarded.ask(Some(wrong)).starts_with("HTTP/1.1 401 "), "{wrong}");
    }
    let answer = guarded.ask(Some("correct horse"));
    assert!(answer.starts_with("HTTP/1.1 200 ") && answer.ends_with('}'), "{answer}");
    // It is let in again while another password is tried, and after it.
    assert!(guarded.ask(Some("wrong")).starts_with("HTTP/1.1 401 "));
    assert!(guarded.ask(Some("correct horse")).starts_with("HTTP/1.1 200 "));
}

/// Another password holds at once, a removed one closes the port: no earlier version of the file is read.
#[test]
fn another_password_of_the_viewers_holds_at_once() {
    let mut guarded = GuardedView::new();
    assert!(guarded.ask(Some("correct horse")).starts_with("HTTP/1.1 200 "));
    set_viewer_password(guarded.folder.path(), "battery staple", Vec::new()).unwrap();
    // Looked at every 2 s.
    (0..110).for_each(|_| guarded.shop.step());
    assert!(guarded.ask(Some("correct horse")).starts_with("HTTP/1.1 401 "));
    assert!(guarded.ask(Some("battery staple")).starts_with("HTTP/1.1 200 "));
    let file = guarded.folder.path().join("web.ron");
    std::fs::remove_file(&file).unwrap();
    assert!(file.with_extension("ron.bak").exists(), "the earlier version is still there");
    (0..110).for_each(|_| guarded.shop.step());
    let view = guarded.shop.gateway.view().web;
    assert!(matches!(&view.state, ServiceState::Failed(why) if why.en().contains("no password")), "{view:?}");
}

#[test]
fn a_view_for_other_computers_answers_nobody_without_tls() {
    let mut guarded = GuardedView::new();
    let mut browser = guarded.shop.connect();
    browser.write_all(b"GET /state.json HTTP/1.1\r\nHost: localhost\r\n\r\n").unwrap();
    let (begun, mut answer) = (Instant::now(), Vec::new());
    loop {
        assert!(begun.elapsed() < DEADLINE, "still open");
        guarded.shop.step();
        match browser.read_to_end(&mut answer) {
            Ok(_) => break,
            Err(error) if error.kind() == ErrorKind::WouldBlock => std::thread::sleep(Duration::from_millis(1)),
            Err(_) => break,
        }
    }
    // An alert of TLS at most.
    assert!(answer.len() < 32 && !answer.starts_with(b"HTTP"), "{answer:?}");
}

#[test]
fn without_a_password_nothing_is_opened_to_other_computers() {
    let folder = tempfile::tempdir().unwrap();
    let mut gateway = Gateway::default().with_folder(folder.path().to_path_buf());
    let mut snapshot = machine();
    set(&mut snapshot, "P483", free_port().into());
    set(&mut snapshot, "P486", 1.0);
    gateway.step(Duration::from_secs(1), Duration::ZERO, &snapshot);
    let view = gateway.view().web;
    assert!(matches!(&view.state, ServiceState::Failed(why) if why.en().contains("kt830 web-access")), "{view:?}");
    // Set while it waits: it is looked for again.
    set_viewer_password(folder.path(), "correct horse", vec!["localhost".to_owned()]).unwrap();
    gateway.step(Duration::from_secs(7), Duration::ZERO, &snapshot);
    assert_eq!(gateway.view().web.state, ServiceState::Listening);
    assert!(set_viewer_password(folder.path(), "", Vec::new()).is_err());
    #[cfg(unix)]
    for file in ["web.ron", "web.key"] {
        use std::os::unix::fs::PermissionsExt;
        let mode = std::fs::metadata(folder.path().join(file)).unwrap().permissions().mode();
        assert_eq!(mode & 0o077, 0, "{file} is readable by others");
    }
}

#[test]
fn the_certificate_is_made_anew_with_names_and_one_of_somebody_else_never() {
    let folder = tempfile::tempdir().unwrap();
    let certificate = || std::fs::read(folder.path().join("web.pem")).unwrap();
    let set = |names: &[&str]| {
        set_viewer_password(folder.path(), "correct horse", names.iter().map(|name| (*name).to_owned()).collect())
    };
    set(&["grinder12.example", "192.168.1.30"]).unwrap();
    let first = certificate();
    set(&[]).unwrap();
    assert_eq!(certificate(), first, "the password alone");
    set(&["grinder13.example"]).unwrap();
    assert_ne!(certificate(), first);
    let settings = folder.path().join("web.ron");
    let text = std::fs::read_to_string(&settings).unwrap().replace("web.pem", "shop.pem");
    std::fs::write(&settings, text).unwrap();
    let refused = set(&["grinder14.example"]).unwrap_err();
    assert!(refused.contains("of your own"), "{refused}");
    set(&[]).unwrap();
    assert!(std::fs::read_to_string(&settings).unwrap().contains("shop.pem"));
    // Without its file nobody knows whose it is.
    std::fs::remove_file(&settings).unwrap();
    drop(std::fs::remove_file(settings.with_extension("ron.bak")));
    assert!(set(&["grinder12.example"]).unwrap_err().contains("web.pem"));
}

/// Records of TLS without content, without end: the step of the gateway ends all the same.
#[test]
fn a_client_that_sends_without_end_keeps_nobody_up() {
    let mut guarded = GuardedView::new();
    let mut roots = RootCertStore::empty();
    roots.add(CertificateDer::from_pem_file(guarded.folder.path().join("web.pem")).unwrap()).unwrap();
    let config = ClientConfig::builder_with_provider(Arc::new(rustls::crypto::ring::default_provider()))
        .with_safe_default_protocol_versions()
        .unwrap()
        .with_root_certificates(roots)
        .with_no_client_auth();
    let mut session = ClientConnection::new(Arc::new(config), "localhost".try_into().unwrap()).unwrap();
    let mut stream = guarded.shop.connect();
    let begun = Instant::now();
    while session.is_handshaking() {
        assert!(begun.elapsed() < DEADLINE, "no handshake");
        while session.wants_write() && session.write_tls(&mut stream).is_ok() {}
        guarded.shop.step();
        if session.read_tls(&mut stream).is_ok() {
            session.process_new_packets().unwrap();
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    // Updates of the key, without content and without end, while somebody else asks.
    let over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let flood = scope.spawn(|| {
            let mut count = 0_u32;
            while !over.load(Ordering::Relaxed) && session.refresh_traffic_keys().is_ok() {
                while session.wants_write() && !over.load(Ordering::Relaxed) {
                    match session.write_tls(&mut stream) {
                        Err(error) if error.kind() != ErrorKind::WouldBlock => return count,
                        _ => {}
                    }
                }
                count += 1;
            }
            count
        });
        let answer = guarded.ask(Some("correct horse"));
        assert!(answer.starts_with("HTTP/1.1 200 "), "{answer}");
        over.store(true, Ordering::Relaxed);
        assert!(flood.join().unwrap() > 10, "no flood");
    });
}
