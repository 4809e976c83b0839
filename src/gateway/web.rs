//! The read-only view for a phone: one page, the state of the machine as JSON, the picture of its screen. It answers GET;
//! nothing that is asked for changes anything.
//! Source: docs/manual, chapter "network".

use std::sync::Arc;
use std::time::Duration;

use serde_json::{Value, json};

use super::device_model::{device_model, device_uuid};
use super::metrics::metrics;
use super::port_server::{Connection, ConnectionState, PortLimits, PortServer};
use super::timestamp;
use super::web_access::WebAccess;
use crate::link::condition::level;
use crate::link::data_item::{DataItem, ItemValue, data_items, rounded};
use crate::link::network::TlsView;
use crate::link::snapshot::{AlarmView, Snapshot};

/// Most clients, what each may leave unread, its longest request, and how long it may take for both.
const LIMITS: PortLimits =
    PortLimits { connections: 16, pending: 4 * 1_024 * 1_024, received: 8 * 1_024, patience: Duration::from_secs(10) };
/// Header lines of a request.
const MAX_HEADERS: usize = 64;
/// Sizes shown in the trend.
const MAX_SIZES: usize = 50;
/// A browser asks for the password then.
const UNAUTHORIZED: &str = "401 Unauthorized\r\nWWW-Authenticate: Basic realm=\"KT-830\", charset=\"UTF-8\"";
/// The text format of Prometheus.
const METRICS_TYPE: &str = "text/plain; version=0.0.4; charset=utf-8";
/// The page.
const PAGE: &str = include_str!("../../assets/web/index.html");
/// Nothing but this server is asked by the page, and no other page may frame it.
const PROTECTION: &str = "Content-Security-Policy: default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; \
                          img-src 'self'; connect-src 'self'; frame-ancestors 'none'\r\n\
                          Cross-Origin-Resource-Policy: same-origin\r\nX-Content-Type-Options: nosniff\r\n\
                          Referrer-Policy: no-referrer\r\nCache-Control: no-store\r\n";

/// What there is to see.
pub struct WebView<'a> {
    /// The machine.
    pub snapshot: &'a Snapshot,
    /// Its screen as PNG, if it is painted.
    pub picture: Option<&'a [u8]>,
    /// When it was so, since 1970, UTC.
    pub time: Duration,
}

/// The port of the view. It is of this computer alone, or of others in TLS and with a password.
pub struct WebServer {
    /// The port.
    pub port: PortServer,
    /// Who may look from other computers; none where the port is of this one.
    access: Option<WebAccess>,
    /// Somebody has asked for the picture since [`Self::take_picture_wanted`].
    picture_wanted: bool,
}

impl WebServer {
    /// Listens at a port: of this computer alone, or with an access for others of all its networks.
    ///
    /// # Errors
    /// The port is in use or not allowed.
    pub fn open(port: u16, access: Option<WebAccess>) -> std::io::Result<Self> {
        let port = PortServer::open(port, access.is_some(), LIMITS)?;
        let port = match &access {
            Some(access) => port.with_tls(Arc::clone(&access.config)),
            None => port,
        };
        Ok(Self { port, access, picture_wanted: false })
    }

    /// How its connections are encrypted.
    pub fn tls(&self) -> Option<TlsView> {
        self.access.as_ref().map(|access| TlsView { valid_until: access.valid_until })
    }

    /// Answers what has been asked.
    pub fn step(&mut self, now: Duration, view: &WebView<'_>) {
        let (mut answers, mut wanted) = (0, false);
        let access = &mut self.access;
        self.port.step(now, Vec::new, |client| {
            let admits = |request: &httparse::Request<'_, '_>| admits(access.as_mut(), request, now);
            if let Some(answer) = answer(client, view, admits, &mut wanted) {
                answers += 1;
                client.pending = answer;
                client.state = ConnectionState::Closing;
            }
        });
        self.port.count_sent(answers);
        self.picture_wanted |= wanted;
    }

    /// Whether somebody has asked for the picture; clears it.
    pub const fn take_picture_wanted(&mut self) -> bool {
        std::mem::replace(&mut self.picture_wanted, false)
    }
}

/// Why a request is refused; `Ok` if it may look, none until its password has been tried.
fn admits(
    access: Option<&mut WebAccess>,
    request: &httparse::Request<'_, '_>,
    now: Duration,
) -> Option<Result<(), (&'static str, &'static [u8])>> {
    let header = |name: &str| request.headers.iter().find(|header| header.name.eq_ignore_ascii_case(name));
    let Some(access) = access else {
        // A page of another site that has its name lead here has no business here.
        let is_own = header("host").is_some_and(|host| is_own_name(host.value));
        return Some(if is_own { Ok(()) } else { Err(("403 Forbidden", b"ask for localhost\n")) });
    };
    let admitted = access.admits(header("authorization").map(|header| header.value), now)?;
    Some(if admitted { Ok(()) } else { Err((UNAUTHORIZED, b"the password of the viewers, please\n")) })
}

/// The answer to what a client has sent; none until its request is whole and admitted or not.
fn answer(
    client: &Connection,
    view: &WebView<'_>,
    admits: impl FnOnce(&httparse::Request<'_, '_>) -> Option<Result<(), (&'static str, &'static [u8])>>,
    wanted: &mut bool,
) -> Option<Vec<u8>> {
    let mut headers = [httparse::EMPTY_HEADER; MAX_HEADERS];
    let mut request = httparse::Request::new(&mut headers);
    match request.parse(&client.received) {
        Ok(httparse::Status::Complete(_)) => {}
        Ok(httparse::Status::Partial) => return None,
        Err(_) => return Some(response("400 Bad Request", "text/plain", b"not a request\n")),
    }
    if let Err((status, why)) = admits(&request)? {
        return Some(response(status, "text/plain", why));
    }
    let path = request.path.unwrap_or_default().split('?').next().unwrap_or_default();
    Some(match (request.method.unwrap_or_default(), path) {
        ("GET", "/") => response("200 OK", "text/html; charset=utf-8", PAGE.as_bytes()),
        ("GET", "/state.json") => response("200 OK", "application/json", state(view).to_string().as_bytes()),
        ("GET", "/screen.png") => {
            *wanted = true;
            match view.picture {
                Some(png) => response("200 OK", "image/png", png),
                None => response("503 Service Unavailable", "text/plain", b"no picture yet\n"),
            }
        }
        ("GET", "/metrics") => response("200 OK", METRICS_TYPE, metrics(view.snapshot).as_bytes()),
        ("GET", "/Devices.xml") => {
            response("200 OK", "application/xml", device_model(view.snapshot, &timestamp(view.time)).as_bytes())
        }
        ("GET", _) => response("404 Not Found", "text/plain", b"no such page\n"),
        (_, _) => response("405 Method Not Allowed\r\nAllow: GET", "text/plain", b"this is a view: GET alone\n"),
    })
}

/// Whether a host is a name of this computer for itself.
fn is_own_name(host: &[u8]) -> bool {
    let name = std::str::from_utf8(host).unwrap_or_default();
    let name = name.rsplit_once(':').map_or(name, |(name, _)| name);
    ["localhost", "127.0.0.1"].contains(&name)
}

fn response(status: &str, kind: &str, body: &[u8]) -> Vec<u8> {
    let head = format!(
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\n{PROTECTION}Connection: close\r\n\r\n",
        body.len()
    );
    [head.as_bytes(), body].concat()
}

/// The state of the machine and when it was so: every data item, the alarms, the sizes of the last parts.
fn state(WebView { snapshot, time, .. }: &WebView<'_>) -> Value {
    let items = data_items(snapshot).map(|item| (item.id(), item_value(&item, snapshot)));
    let alarm = |alarm: &AlarmView| {
        let text = |text: &crate::defs::text::LocalizedText| json!({"zh": text.zh(), "en": text.en()});
        json!({
            "number": alarm.number,
            "level": level(alarm.number),
            "text": text(&alarm.text),
            "cause": text(&alarm.cause),
            "remedy": text(&alarm.remedy),
        })
    };
    let parts = &snapshot.production.parts;
    let sizes = parts.iter().skip(parts.len().saturating_sub(MAX_SIZES)).filter_map(|part| {
        Some(json!({"part": part.count, "size": rounded(part.size?), "limits": part.limits.map(|limits| limits.map(rounded)), "bad": part.verdict.is_bad()}))
    });
    let state = snapshot.state_name();
    json!({
        "machine": device_uuid(snapshot),
        "time": timestamp(*time),
        "state": {"zh": state.zh, "en": state.en},
        "items": items.collect::<serde_json::Map<String, Value>>(),
        "alarms": snapshot.alarms.iter().map(alarm).collect::<Vec<_>>(),
        "sizes": sizes.collect::<Vec<_>>(),
    })
}

fn item_value(item: &DataItem, snapshot: &Snapshot) -> Value {
    match item.value(snapshot) {
        ItemValue::Unavailable => Value::Null,
        ItemValue::Number(number) => json!(rounded(number)),
        ItemValue::Count(count) => json!(count),
        ItemValue::Word(word) => json!(word),
        ItemValue::Text(text) => json!(text),
    }
}
