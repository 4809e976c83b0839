//! Network page: the services of the control, who is connected, and what they are told.
//! Source: docs/manual, chapter "network".

use egui::{Color32, Rect, vec2};

use super::{HandOver, PageContext, PageUi, Scroll, ScrollList, empty};
use crate::defs::date::DateTime;
use crate::hmi::{Area, View, pictogram, round_to_lines, theme, widget};
use crate::link::condition::{Condition, level};
use crate::link::data_item::{Category, DataItem, data_items};
use crate::link::network::{BrokerState, BrokerView, OpcUaView, ServiceState, ServiceView, TlsView};

/// Height of a line of a service, and of its card with the gap below it.
const LINE_HEIGHT: f32 = 27.0;
const SERVICE_HEIGHT: f32 = 2.0 * LINE_HEIGHT + 3.0 * theme::GAP;
/// Width of the name of a service; share of a line for name and address.
const SERVICE_WIDTH: f32 = 112.0;
const NAME_SHARE: f32 = 0.46;
/// Width of a lamp.
const LAMP_WIDTH: f32 = 40.0;
/// A certificate that ends so soon is marked: thirty days, s.
const SOON: i64 = 30 * 86_400;
/// Height of a row of the list.
const ROW_HEIGHT: f32 = 30.0;
/// Shares of the columns of the list: what it is, value, name and unit for the network.
const COLUMNS: [f32; 3] = [1.0, 0.8, 1.2];

/// A row of the list: what the network is told.
enum TellRow {
    /// A data item.
    Item(DataItem),
    /// Alarms.
    Condition(Condition),
}

/// State of the page.
#[derive(Debug, Default)]
pub struct NetworkPage {
    scroll: Scroll,
}

impl PageUi for NetworkPage {
    fn open(&mut self, _view: &View<'_>, _handed_over: Option<HandOver>) {
        *self = Self::default();
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        let PageContext { rect, view, typed, .. } = ctx;
        let Some(network) = view.snapshot.host.network.as_deref() else {
            let remedy = view.text("此控制没有网络服务。", "This control runs without network services.");
            return empty::show(view, rect, pictogram::NO_PAGE, view.text("没有网络", "no network"), remedy);
        };
        let body = rect.shrink(theme::PAD);
        let (services, list) = body.split_top(4.0 * SERVICE_HEIGHT);
        let lines = [
            service_lines(view, "MTConnect", &network.mtconnect),
            service_lines(view, view.text("浏览器", "browser"), &network.web),
            broker_lines(view, &network.mqtt),
            opcua_lines(view, &network.opcua),
        ];
        for (index, lines) in lines.iter().enumerate() {
            let place = services.band(index as f32 * SERVICE_HEIGHT, SERVICE_HEIGHT - theme::GAP);
            show_service(place, view, lines);
        }
        let (head, rows) = list.split_top(ROW_HEIGHT);
        let heading =
            [("内容", "content"), ("当前值", "value now"), ("网络上的名称和单位", "name and unit for the network")];
        for (place, (zh, en)) in head.trim_sides(8.0).columns(COLUMNS).into_iter().zip(heading) {
            view.fit_left(place.trim_right(6.0), view.text(zh, en), theme::SMALL, view.theme.muted);
        }
        let conditions = Condition::of_machine(view.snapshot).map(TellRow::Condition);
        let items: Vec<TellRow> = data_items(view.snapshot).map(TellRow::Item).chain(conditions).collect();
        let list = ScrollList {
            id: "network",
            rect: round_to_lines(rows, ROW_HEIGHT),
            row: ROW_HEIGHT,
            gap: 0.0,
            count: items.len(),
        };
        let (clipped, places) = self.scroll.rows(view, &list, typed.scroll_pages);
        for (index, place) in places {
            show_item(place.trim_sides(8.0), &clipped, &items[index]);
        }
    }
}

/// What a card says of a service.
struct ServiceLines<'a> {
    name: &'a str,
    is_up: bool,
    address: String,
    state: (String, Color32),
    /// What the counts are, and the counts.
    counts: (&'a str, String),
    /// How its connections are encrypted.
    tls: Option<(String, Color32)>,
}

/// Who is connected to a service, and its counts.
fn service_lines<'a>(view: &View<'a>, name: &'a str, service: &ServiceView) -> ServiceLines<'a> {
    let muted = |zh, en| (view.text(zh, en).to_owned(), view.theme.muted);
    let state = match (&service.state, &service.clients[..]) {
        (ServiceState::Off, _) => muted("关", "off"),
        (ServiceState::Failed(why), _) => (why.get(view.lang).into_owned(), view.theme.alarm_text),
        (ServiceState::Listening, []) => muted("没有连接", "nobody is connected"),
        (ServiceState::Listening, [client]) => (client.clone(), view.theme.text),
        (ServiceState::Listening, [client, others @ ..]) => (format!("{client}  +{}", others.len()), view.theme.text),
    };
    let counts = format!("{} / {} / {}", service.sent, service.refused, service.dropped);
    ServiceLines {
        name,
        is_up: service.state == ServiceState::Listening,
        address: service.address.clone(),
        state,
        counts: (view.text("发送 / 拒绝 / 断开", "sent / refused / dropped"), counts),
        tls: service.tls.map(|tls| tls_line(view, tls)),
    }
}

/// The connection to the broker, and its counts.
fn broker_lines<'a>(view: &View<'a>, broker: &BrokerView) -> ServiceLines<'a> {
    let muted = |zh, en| (view.text(zh, en).to_owned(), view.theme.muted);
    let state = match &broker.state {
        BrokerState::Off => muted("关", "off"),
        BrokerState::Connecting => muted("正在连接", "connecting"),
        BrokerState::Connected if broker.refuses_topic => (
            view.text("已连接，但不许接收订单等主题", "connected, but a topic (orders) is refused").to_owned(),
            view.theme.hold,
        ),
        BrokerState::Connected => (view.text("已连接", "connected").to_owned(), view.theme.text),
        BrokerState::Failed(why) => (why.get(view.lang).into_owned(), view.theme.alarm_text),
    };
    let counts = format!("{} / {} / {} / {}", broker.sent, broker.waiting, broker.lost, broker.connections);
    ServiceLines {
        name: "MQTT",
        is_up: broker.state == BrokerState::Connected,
        address: broker.address.clone(),
        state,
        counts: (view.text("发送 / 待发 / 丢失 / 连接次数", "sent / waiting / lost / connections"), counts),
        tls: match broker.tls {
            Some(tls) => Some(tls_line(view, tls)),
            None => (broker.state == BrokerState::Connected)
                .then(|| (view.text("未加密", "not encrypted").to_owned(), view.theme.hold)),
        },
    }
}

/// The OPC UA server, a process of its own, and who waits for its trust.
fn opcua_lines<'a>(view: &View<'a>, server: &OpcUaView) -> ServiceLines<'a> {
    let muted = |zh, en| (view.text(zh, en).to_owned(), view.theme.muted);
    let is_up = !server.address.is_empty();
    let state = match server.clients {
        _ if !is_up => muted("没有服务器", "no server"),
        0 => muted("没有连接", "nobody is connected"),
        1 => (view.text("1 个客户端", "1 client").to_owned(), view.theme.text),
        more => (format!("{more} {}", view.text("个客户端", "clients")), view.theme.text),
    };
    ServiceLines {
        name: "OPC UA",
        is_up,
        // Its scheme is known; the place is small.
        address: server.address.trim_start_matches("opc.tcp://").trim_end_matches('/').to_owned(),
        state,
        counts: (view.text("未信任的证书", "untrusted certificates"), server.untrusted.to_string()),
        tls: server.certificate_until.map(|end| until_line(view, view.text("证书至", "certificate until"), end)),
    }
}

/// Until when the certificates of encrypted connections are valid; what ends soon is marked.
fn tls_line(view: &View<'_>, tls: TlsView) -> (String, Color32) {
    match tls.valid_until {
        Some(end) => until_line(view, view.text("TLS 证书至", "TLS until"), end),
        None => ("TLS".to_owned(), view.theme.text),
    }
}

/// The end of a certificate behind some words.
fn until_line(view: &View<'_>, words: &str, end: DateTime) -> (String, Color32) {
    let [year, month, day, ..] = end.parts();
    let left = view.snapshot.date.map(|now| end.0 - now.0);
    let ink = match left {
        Some(..=0) => view.theme.alarm_text,
        Some(..=SOON) => view.theme.hold,
        _ => view.theme.text,
    };
    (format!("{words} {year}-{month:02}-{day:02}"), ink)
}

/// State and address of a service, who is connected, and its counts.
fn show_service(rect: Rect, view: &View<'_>, lines: &ServiceLines<'_>) {
    view.card(rect);
    let inside = rect.shrink2(vec2(theme::PAD, theme::GAP));
    let (lamp, rest) = inside.band(0.0, LINE_HEIGHT).split_left(LAMP_WIDTH);
    widget::lamp(view, lamp, lines.is_up);
    let (left, right) = rest.split_left_right_at_fraction(NAME_SHARE);
    let (title, address) = left.split_left(SERVICE_WIDTH);
    view.fit_left(title, lines.name, theme::TITLE, view.theme.text);
    view.fit_left(address.trim_right(theme::GAP), &lines.address, theme::LABEL, view.theme.text);
    view.fit_left(right, &lines.state.0, theme::LABEL, lines.state.1);
    let (left, right) =
        inside.band(LINE_HEIGHT, LINE_HEIGHT).with_min_x(rest.min.x).split_left_right_at_fraction(NAME_SHARE);
    view.fit_left(left, lines.counts.0, theme::LABEL, view.theme.muted);
    let counts = match &lines.tls {
        Some((words, ink)) => {
            let shown = view.line_right(right, words, theme::LABEL, *ink);
            right.with_max_x(shown.min.x - theme::GAP)
        }
        None => right,
    };
    view.fit_left(counts, &lines.counts.1, theme::LABEL, view.theme.text);
}

/// What it is, its value, and how the network knows it.
fn show_item(rect: Rect, view: &View<'_>, row: &TellRow) {
    view.hairline(rect, rect.max.y);
    let [name, value, id] = rect.columns(COLUMNS);
    let (text, shown, known_as) = match row {
        TellRow::Item(item) => {
            let units = match item.category {
                Category::Sample(units) | Category::EventWithUnits(units) => units,
                Category::Event => "",
            };
            let axis = item.axis().map_or_else(String::new, |axis| format!("{axis} "));
            let text = format!("{axis}{}", item.text.get(view.lang));
            (text, item.value(view.snapshot).to_string(), format!("{}  {units}", item.id()))
        }
        TellRow::Condition(condition) => {
            let worst = condition.worst(view.snapshot).map(|alarm| alarm.number);
            let shown = worst.map_or_else(|| "NORMAL".to_owned(), |number| format!("{} {number}", level(number)));
            (condition.name().get(view.lang).to_owned(), shown, condition.row().0.to_owned())
        }
    };
    view.fit_left(name.trim_right(6.0), &text, theme::LABEL, view.theme.text);
    view.fit_left(value.trim_right(6.0), &shown, theme::LABEL, view.theme.text);
    view.fit_left(id, known_as.trim_end(), theme::SMALL, view.theme.muted);
}
