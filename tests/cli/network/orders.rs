//! Orders of the shop: by the broker, and from programs of the same computer at the adapter port.

use std::io::Write;
use std::sync::Arc;

use kt830::defs::page_text;
use kt830::defs::production_order::{OrderState, OrderValue, OrderValues, ProductionOrder};
use kt830::gateway::Gateway;
use kt830::link::Snapshot;
use kt830::link::production::OrderProposal;
use kt830::link::screens::{Picture, ScreenFiles, Screens};
use kt830::link::snapshot::DirectoryRow;

use super::site::{NODE, Site};
use super::test_broker::{Manners, TestBroker};
use super::{Shop, set};

/// O1002 with a size and its deviations on its page.
fn give_program(snapshot: &mut Snapshot) {
    let row = DirectoryRow { number: 1_002, name: "O1002".to_owned(), ..DirectoryRow::default() };
    snapshot.directory = Arc::new(vec![row]);
    let bytes = std::fs::read("screens/C0002.TXT").unwrap();
    let (page, ..) = encoding_rs::GBK.decode(&bytes);
    let text = page_text::parse(&page.replace("下偏差 #533", "实测尺寸 #533")).unwrap();
    let files = ScreenFiles {
        text: Ok(Arc::new(text)),
        english_fault: None,
        picture: Ok(Arc::new(Picture(Vec::new().into()))),
        labels: Vec::new(),
        labels_fault: None,
    };
    snapshot.screens = Arc::new(Screens { pages: vec![(1_002, files)], dressing: None });
}

#[test]
fn an_order_of_the_shop_is_proposed_once_and_the_list_is_told() {
    let mut site = Site::new();
    let (proposals, proposed) = crossbeam_channel::bounded(2);
    site.gateway = Gateway::default().with_folder(site.folder.path().to_path_buf()).with_orders(proposals);
    give_program(&mut site.snapshot);
    site.until_born();
    let topic = format!("kt830/hall 2/{NODE}/order");
    let of = |site: &Site, topic: &str| -> Vec<serde_json::Value> {
        let sent = site.broker.sent.iter().filter(|sent| sent.topic == topic);
        sent.map(|sent| serde_json::from_slice(&sent.payload).unwrap()).collect()
    };
    let answers = format!("{topic}/answer");
    let ask = |site: &mut Site, text: &str| -> serde_json::Value {
        let count = of(site, &answers).len();
        site.broker.publish(&topic, text.as_bytes().to_vec());
        site.until("an answer", |site| of(site, &answers).len() > count);
        of(site, &answers).pop().unwrap()
    };
    let good = "{\"order\": 701, \"program\": 1002, \"parts\": 50}";
    // Not asked for before P485 says so; a broker that sends it all the same is told why not.
    let refused = ask(&mut site, good);
    assert!(refused["proposed"] == false && refused["why"].as_str().unwrap().contains("P485"), "{refused}");
    site.broker.has_subscription = false;
    set(&mut site.snapshot, "P485", 1.0);
    site.until("a subscription", |site| site.broker.has_subscription);
    assert_eq!(ask(&mut site, good), serde_json::json!({"order": 701, "proposed": true, "why": null}));
    assert_eq!(
        proposed.try_recv(),
        Ok(OrderProposal { number: 701, program: 1_002, target: 50, values: OrderValues::default() })
    );
    let with_values =
        "{\"order\": 701, \"program\": \"O1002\", \"parts\": 5, \"values\": {\"#521\": 38.02, \"#532\": 0.01}}";
    site.steps(60);
    assert_eq!(ask(&mut site, with_values)["proposed"], true);
    let values: Vec<_> =
        proposed.try_recv().unwrap().values.iter().map(|value| (value.variable, value.number)).collect();
    assert_eq!(values, [(521, 38.02), (532, 0.01)]);
    site.steps(60);
    let order_with =
        |values: &str| format!("{{\"order\": 701, \"program\": 1002, \"parts\": 5, \"values\": {{{values}}}}}");
    for (bad, why) in [
        ("\"#899\": 1", "does not show #899"),
        ("\"#533\": 38", "measured"),
        ("\"521\": 38", "is not a variable"),
        ("\"#521\": 38, \"#521\": 39", "each once"),
        ("\"#521\": 38.0004", "three decimals"),
        ("\"#521\": 1e9", "must be"),
        ("\"#521\": \"38\"", "invalid type"),
        ("\"#1\":0,\"#2\":0,\"#3\":0,\"#4\":0,\"#5\":0,\"#6\":0,\"#7\":0,\"#8\":0,\"#9\":0", "at most 8"),
    ] {
        let answer = ask(&mut site, &order_with(bad));
        assert!(answer["proposed"] == false && answer["why"].as_str().unwrap().contains(why), "{bad}: {answer}");
    }
    for (bad, why) in [
        ("{\"order\": 0, \"program\": 1002, \"parts\": 50}", "from 1 to"),
        ("{\"order\": 701, \"program\": 1999, \"parts\": 50}", "no such program"),
        ("{\"order\": 701, \"program\": 1002, \"parts\": 0}", "1 to 999999"),
        ("{\"order\": 701, \"program\": 1002, \"parts\": 50, \"start\": true}", "unknown field"),
        ("{\"order\": -1}", "invalid value"),
        ("M03 S1000", "expected value"),
        (" ", "EOF"),
    ] {
        let answer = ask(&mut site, bad);
        assert!(answer["proposed"] == false && answer["why"].as_str().unwrap().contains(why), "{bad}: {answer}");
    }
    assert!(proposed.is_empty(), "nothing else reaches the control");
    // An empty message takes back what a broker was to keep: it is no order, and is not answered.
    let answers = |site: &Site| site.topics().iter().filter(|topic| topic.ends_with("order/answer")).count();
    let before = answers(&site);
    site.broker.publish(&format!("kt830/hall 2/{NODE}/order"), Vec::new());
    site.steps(100);
    assert_eq!(answers(&site), before);
    // One a second; and the control does not take them: no more than the channel has room for.
    let answered: Vec<bool> = (0..4).map(|_| ask(&mut site, good)["proposed"] == true).collect();
    assert_eq!(answered, [true, false, false, false]);
    proposed.try_recv().unwrap();
    let later = |site: &mut Site| {
        site.steps(60);
        ask(site, good)["proposed"] == true
    };
    let answered: Vec<bool> = (0..4).map(|_| later(&mut site)).collect();
    assert_eq!(answered, [true, true, false, false]);
    let long = format!("{{\"order\": 701, \"{}\": 1}}", "x".repeat(2_000));
    assert!(ask(&mut site, &long)["why"].as_str().unwrap().contains("not so long"));
    let odd = format!("{{\"{}\": 1}}", "x".repeat(900));
    assert_eq!(ask(&mut site, &odd)["why"].as_str().unwrap().len(), 200);
    let list = format!("kt830/hall 2/{NODE}/orders");
    // The broker keeps no list while orders are not taken.
    let told = |site: &Site| -> Vec<String> {
        let sent = site.broker.sent.iter().filter(|sent| sent.topic == list);
        sent.map(|sent| String::from_utf8(sent.payload.to_vec()).unwrap()).collect()
    };
    assert_eq!(told(&site), ["[]"]);
    let entered = ProductionOrder {
        number: 701,
        program: 1_002,
        target: 50,
        good: 2,
        bad: 1,
        state: OrderState::Active,
        after: 0,
        values: OrderValues::default().with(OrderValue { variable: 521, number: 38.02 }).unwrap(),
    };
    site.snapshot.production.orders.push(entered);
    site.until("the list", |site| told(site).len() == 2);
    let line = serde_json::json!({
        "order": 701, "program": 1_002, "name": "O1002", "parts": 50, "good": 2, "bad": 1, "state": "active",
        "values": {"#521": 38.02}
    });
    assert_eq!(serde_json::from_str::<serde_json::Value>(&told(&site)[1]).unwrap(), serde_json::json!([line]));
    assert!(ask(&mut site, good)["why"].as_str().unwrap().contains("in the list already"));
    set(&mut site.snapshot, "P485", 0.0);
    site.until("no list", |site| told(site).last().is_some_and(String::is_empty));
    let count = told(&site).len();
    site.broker.drop_client();
    site.until("another connection", |site| site.view().connections == 2);
    site.steps(20);
    assert_eq!(told(&site).len(), count + 1, "the message that clears the list may have been lost with its connection");
    assert_eq!(told(&site)[count], "");
}

#[test]
fn another_number_leaves_no_list_behind_under_the_old_one() {
    let mut site = Site::new();
    set(&mut site.snapshot, "P485", 1.0);
    let list = format!("kt830/hall 2/{NODE}/orders");
    let told = |site: &Site| -> Vec<bool> {
        site.broker.sent.iter().filter(|sent| sent.topic == list).map(|sent| sent.payload.is_empty()).collect()
    };
    site.until("the list", |site| told(site) == [false]);
    set(&mut site.snapshot, "P482", 124.0);
    site.until_born_as("kt830-gc-000124");
    site.until("no list under the old one", |site| told(site) == [false, true]);
    // Given up while the broker was away, and only once: another machine may have that number by then.
    let other = "kt830/hall 2/kt830-gc-000124/orders";
    let of_other = |site: &Site| site.broker.sent.iter().filter(|sent| sent.topic == other).count();
    site.until("the list under the new one", |site| of_other(site) == 1);
    site.broker.drop_client();
    set(&mut site.snapshot, "P482", 125.0);
    site.until_born_as("kt830-gc-000125");
    site.until("no list under that one", |site| of_other(site) == 2);
    site.broker.drop_client();
    site.until("another connection", |site| site.view().connections == 4);
    site.steps(40);
    assert_eq!((of_other(&site), told(&site)), (2, vec![false, true]));
}

#[test]
fn a_broker_that_refuses_a_topic_is_said() {
    let mut broker = TestBroker::new();
    broker.manners = Manners::Unsubscribed;
    let mut site = Site::with(broker, "");
    site.until_born();
    site.until("the refusal", |site| site.view().refuses_topic);
}

/// Orders from programs of the same computer: the OPC UA server hands on those of its clients.
#[test]
fn an_order_at_the_adapter_port_is_proposed_and_answered() {
    let mut shop = Shop::new();
    let (proposals, proposed) = crossbeam_channel::bounded(2);
    shop.gateway = Gateway::default().with_orders(proposals);
    give_program(&mut shop.snapshot);
    shop.step();
    let mut agent = shop.connect();
    agent
        .write_all(b"* PING\n* ORDERS\n* ORDERS\n* ORDER {\"order\": 701, \"program\": 1002, \"parts\": 50}\n")
        .unwrap();
    let told = shop.until(&mut agent, "P485 is 0");
    assert_eq!(told.matches("* orders: []\n").count(), 1, "one list a step: {told}");
    set(&mut shop.snapshot, "P485", 1.0);
    agent.write_all(b"* ORDER {\"order\": 701, \"program\": \"O1002\", \"parts\": 50}\n").unwrap();
    shop.until(&mut agent, "* order: {\"order\":701,\"proposed\":true,\"why\":null}\n");
    let expected = OrderProposal { number: 701, program: 1_002, target: 50, values: OrderValues::default() };
    assert_eq!(proposed.try_recv(), Ok(expected));
    agent.write_all(b"* ORDER M03 S1000\n").unwrap();
    shop.until(&mut agent, "\"proposed\":false");
    assert!(proposed.is_empty(), "nothing else reaches the control");
}

/// A page in a browser of this computer could send lines, too: an agent begins with a ping.
#[test]
fn who_does_not_begin_with_a_ping_proposes_nothing() {
    let mut shop = Shop::new();
    let (proposals, proposed) = crossbeam_channel::bounded(2);
    shop.gateway = Gateway::default().with_orders(proposals);
    give_program(&mut shop.snapshot);
    set(&mut shop.snapshot, "P485", 1.0);
    shop.step();
    let order = "* ORDER {\"order\": 701, \"program\": 1002, \"parts\": 50}\n";
    let (mut browser, mut mute) = (shop.connect(), shop.connect());
    browser.write_all(format!("POST / HTTP/1.1\r\nHost: localhost\r\n\r\n* PING\n{order}").as_bytes()).unwrap();
    mute.write_all(order.as_bytes()).unwrap();
    shop.until_view("the browser is gone", |shop| shop.gateway.view().mtconnect.clients.len() == 1);
    mute.write_all(format!("* PING\n{order}").as_bytes()).unwrap();
    shop.until(&mut mute, "\"proposed\":true");
    assert_eq!(proposed.len(), 1, "the one after the ping");
}
