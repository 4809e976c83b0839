//! The network page.

use std::sync::Arc;

use kt830::defs::date::DateTime;
use kt830::defs::page::Page;
use kt830::defs::text::{Lang, LocalizedText};
use kt830::hmi::page_text;
use kt830::link::Snapshot;
use kt830::link::network::{BrokerState, BrokerView, NetworkView, OpcUaView, ServiceState, ServiceView, TlsView};

fn with(mtconnect: ServiceView) -> Snapshot {
    let mut snapshot = crate::sample::busy(Page::Network);
    snapshot.host.network = Some(Arc::new(NetworkView { mtconnect, ..NetworkView::default() }));
    snapshot
}

#[test]
fn b6_the_network_page_shows_services_clients_and_every_value() {
    let snapshot = with(ServiceView {
        state: ServiceState::Listening,
        address: "127.0.0.1:7878".to_owned(),
        clients: vec!["127.0.0.1:40112".to_owned()],
        sent: 12_345,
        refused: 1,
        dropped: 2,
        tls: None,
    });
    let texts = page_text(&snapshot, Lang::En).join("\n");
    for said in [
        "MTConnect",
        "127.0.0.1:7878",
        "127.0.0.1:40112",
        "12345 / 1 / 2",
        "browser",
        "off",
        "execution",
        "ACTIVE",
        "estop",
    ] {
        assert!(texts.contains(said), "{said}: {texts}");
    }
}

#[test]
fn b6_the_network_page_says_why_a_port_cannot_be_opened() {
    let why = LocalizedText::new("端口已被别的程序占用", "the port is in use");
    let state = ServiceState::Failed(why);
    let texts =
        page_text(&with(ServiceView { state, address: ":7878".to_owned(), ..ServiceView::default() }), Lang::Zh);
    let texts = texts.join("\n");
    for said in [":7878", "端口已被别的程序占用"] {
        assert!(texts.contains(said), "{said}: {texts}");
    }
}

#[test]
fn b6_the_network_page_shows_the_broker_and_what_it_does_not_have_yet() {
    let mut snapshot = with(ServiceView::default());
    let broker = BrokerView {
        state: BrokerState::Connected,
        address: "broker.shop:8883".to_owned(),
        tls: Some(TlsView { valid_until: DateTime::from_parts([2029, 2, 27, 12, 0, 0]) }),
        refuses_topic: false,
        sent: 4_711,
        waiting: 3,
        lost: 0,
        connections: 2,
    };
    let mut said = |mqtt: BrokerView| {
        snapshot.host.network = Some(Arc::new(NetworkView { mqtt, ..NetworkView::default() }));
        page_text(&snapshot, Lang::En).join("\n")
    };
    let texts = said(broker.clone());
    for expected in [
        "MQTT",
        "broker.shop:8883",
        "connected",
        "TLS until 2029-02-27",
        "sent / waiting / lost / connections",
        "4711 / 3 / 0 / 2",
    ] {
        assert!(texts.contains(expected), "{expected}: {texts}");
    }
    let why = LocalizedText::new("服务器没有应答", "the broker does not answer");
    assert!(
        said(BrokerView { state: BrokerState::Failed(why), ..broker.clone() }).contains("the broker does not answer")
    );
    assert!(said(BrokerView { tls: None, ..broker.clone() }).contains("not encrypted"));
    let refused = said(BrokerView { refuses_topic: true, tls: None, ..broker });
    assert!(refused.contains("a topic (orders) is refused") && refused.contains("not encrypted"), "{refused}");
}

#[test]
fn b6_the_network_page_shows_the_opc_ua_server_and_the_conditions() {
    let mut snapshot = with(ServiceView::default());
    let texts = page_text(&snapshot, Lang::En).join("\n");
    assert!(texts.contains("OPC UA") && texts.contains("no server"), "{texts}");
    let opcua = OpcUaView {
        address: "opc.tcp://grinder12:4840/".to_owned(),
        clients: 2,
        untrusted: 7,
        certificate_until: DateTime::from_parts([2046, 2, 27, 12, 0, 0]),
    };
    snapshot.host.network = Some(Arc::new(NetworkView { opcua, ..NetworkView::default() }));
    let texts = page_text(&snapshot, Lang::En).join("\n");
    for said in ["grinder12:4840", "2 clients", "untrusted certificates", "certificate until 2046-02-27"] {
        assert!(texts.contains(said), "{said}: {texts}");
    }
}

#[test]
fn b6_a_control_without_a_gateway_says_that_there_is_no_network() {
    let mut snapshot = crate::sample::busy(Page::Network);
    snapshot.host.network = None;
    let texts = page_text(&snapshot, Lang::Zh);
    assert!(texts.iter().any(|text| text.contains("没有网络")), "{texts:?}");
}
