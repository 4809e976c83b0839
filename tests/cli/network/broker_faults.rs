//! What a bad broker can do, and settings or certificates that are wrong.
//! Source: OASIS MQTT 3.1.1, SECURITY.md.

use std::path::{Path, PathBuf};
use std::time::Duration;

use kt830::defs::alarm;
use kt830::defs::date::DateTime;
use kt830::defs::text::LocalizedText;
use kt830::gateway::Gateway;
use kt830::link::network::BrokerState;

use super::site::{Site, failure};
use super::test_broker::{Manners, TestBroker};
use super::{raised, set};

fn certificates() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cli/network/certificates")
}

/// A simulation without a data directory has no settings of a broker.
#[test]
fn without_a_data_directory_no_broker_is_looked_for() {
    let mut site = Site::new();
    site.gateway = Gateway::default();
    site.steps(50);
    assert!(!site.broker.has_client() && failure(&site).contains("no data directory"), "{:?}", site.view());
}

/// Machines of the factory's number 0 would be one for the broker.
#[test]
fn a_machine_without_a_number_is_not_told_to_the_broker() {
    let mut site = Site::new();
    set(&mut site.snapshot, "P482", 0.0);
    site.steps(200);
    assert!(!site.broker.has_client() && failure(&site).contains("P482 is 0"), "{:?}", site.view());
    set(&mut site.snapshot, "P482", 123.0);
    site.until_born();
    set(&mut site.snapshot, "P482", 0.0);
    site.until("the end", |site| failure(site).contains("P482 is 0"));
}

/// A broker ends the connection of a client when another one of the same name comes: the page says what it may be.
#[test]
fn a_second_control_of_the_same_number_is_said_on_the_page() {
    let mut site = Site::new();
    site.until_born();
    for _ in 0..3 {
        site.broker.drop_client();
        site.until("the loss", |site| failure(site).contains("another control with the same P482?"));
        site.until_born();
    }
}

#[test]
fn a_bad_broker_is_said_and_left_alone_for_longer_and_longer() {
    for (manners, said) in [
        (Manners::Refusing, "refuses user or password"),
        (Manners::Silent, "does not answer"),
        (Manners::Garbage, "MQTT"),
        (Manners::EarlyPong, "breaks the protocol"),
        (Manners::Twice, "breaks the protocol"),
    ] {
        let mut site = Site::new();
        site.broker.manners = manners;
        site.until(said, |site| failure(site).contains(said));
        let taken = site.broker.taken;
        site.steps(3_000);
        // After 1, 2, 4, 8, 16 and 30 s, and 0.23 s each for the number of the machine.
        let more = site.broker.taken - taken;
        assert!((2..=6).contains(&more), "{said}: {more} tries in a minute");
    }
}

#[test]
fn a_half_open_connection_and_a_broker_that_does_not_read_are_given_up() {
    let mut site = Site::new();
    site.until_born();
    site.broker.manners = Manners::Silent;
    // A ping after 10 s and 10 s for its answer.
    let begun = site.now;
    site.until("no answer", |site| failure(site).contains("does not answer"));
    assert!(site.now - begun <= Duration::from_secs(21), "{:?}", site.now - begun);

    let mut site = Site::new();
    site.until_born();
    site.broker.manners = Manners::Deaf;
    // Sixteen results of the window, and texts of 400 characters: more than the buffers of the system and 1 MB in 10 s.
    let begun = site.now;
    let mut round = 0;
    while failure(&site).is_empty() {
        assert!(site.now - begun < Duration::from_secs(10), "{:?}", site.view());
        round += 1;
        let text = |number: u16| LocalizedText::same(&format!("{round} {number} {}", "x".repeat(390)));
        let numbers = [alarm::HYDRAULIC_PRESSURE, alarm::COOLANT_FLOW, alarm::LUBRICATION_LEVEL, alarm::BUS_LOST];
        site.snapshot.alarms = numbers.map(raised).to_vec();
        site.snapshot.alarms.iter_mut().for_each(|alarm| alarm.text = text(alarm.number));
        // The time of the machine stands nearly still: no ping decides here.
        site.gateway.step(site.now, Duration::from_secs(1_795_000_000), &site.snapshot);
        site.now += Duration::from_micros(100);
    }
    assert!(failure(&site).contains("too slow"), "{}", failure(&site));
}

#[test]
fn no_broker_and_bad_settings_are_said_with_their_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let mut site = Site::without_settings(TestBroker::new(), folder);
    for (settings, said) in [
        (None, "no mqtt.ron in the data directory"),
        (Some("(broker: \"\")"), "broker is a name"),
        (Some("(broker: \"a b\")"), "broker is a name"),
        (Some("(broker: \"broker:99999\")"), "broker is a name"),
        (Some("(broker: \"broker\", group: \"a/b\")"), "group is empty or has"),
        (Some("(broker: \"broker\", password: \"x\")"), "a password without a user"),
        (Some("(broker: \"broker\",\n gruop: \"x\")"), "line 2"),
        (Some("(broker: \"localhost:9\", tls: Some((ca: \"ca.pem\")))"), "ca.pem: "),
        (Some("(broker: \"localhost:9\")"), "no broker there"),
    ] {
        if let Some(settings) = settings {
            site.write_settings(settings);
        }
        site.until(said, |site| failure(site).contains(said));
    }
    assert_eq!(site.view().address, "localhost:9", "where it is not");
    // And once they are right it connects.
    site.write_settings(&format!("(broker: \"127.0.0.1:{}\", group: \"hall 2\")", site.broker.port()));
    site.until_born();
}

#[test]
fn an_encrypted_connection_needs_a_broker_that_proves_itself() {
    let tls = |ca: &str| format!("user: \"grinder\", password: \"secret\", tls: Some((ca: \"{ca}\")),");
    let mut site = Site::with(TestBroker::encrypted(&certificates()), &tls("ca.pem"));
    site.until("a missing file", |site| failure(site).contains("ca.pem"));
    for name in ["ca.pem", "other_ca.pem"] {
        std::fs::copy(certificates().join(name), site.folder.path().join(name)).unwrap();
    }
    site.until_born();
    assert!(site.view().tls.unwrap().valid_until.unwrap() > DateTime(1_795_000_000), "{:?}", site.view());
    assert_eq!(site.broker.user, Some(("grinder".to_owned(), "secret".to_owned())));
    site.steps(600);
    assert_eq!(site.view().state, BrokerState::Connected, "pings go through it");

    let mut site = Site::with(TestBroker::encrypted(&certificates()), &tls("other_ca.pem"));
    std::fs::copy(certificates().join("other_ca.pem"), site.folder.path().join("other_ca.pem")).unwrap();
    site.until("a stranger", |site| failure(site).contains("not accepted"));
    assert_eq!(site.broker.user, None, "the password is not told to it");

    // Without TLS at its port.
    let mut site = Site::with(TestBroker::encrypted(&certificates()), "");
    site.until("no answer", |site| !failure(site).is_empty());
    assert!(!failure(&site).contains("P482"), "{}", failure(&site));
}

/// An authority and a broker's certificate that is valid from the begin of one year to the begin of another.
fn certificates_of(from: i32, until: i32) -> tempfile::TempDir {
    let (folder, [authority_key, key]) =
        (tempfile::tempdir().unwrap(), [(); 2].map(|()| rcgen::KeyPair::generate().unwrap()));
    let mut authority = rcgen::CertificateParams::new(Vec::new()).unwrap();
    authority.is_ca = rcgen::IsCa::Ca(rcgen::BasicConstraints::Unconstrained);
    let mut params = rcgen::CertificateParams::new(vec!["127.0.0.1".to_owned(), "localhost".to_owned()]).unwrap();
    (params.not_before, params.not_after) = (rcgen::date_time_ymd(from, 1, 1), rcgen::date_time_ymd(until, 1, 1));
    let own = authority.self_signed(&authority_key).unwrap();
    let broker = params.signed_by(&key, &rcgen::Issuer::new(authority, authority_key)).unwrap();
    let files = [("ca.pem", own.pem()), ("broker.pem", broker.pem()), ("broker.key", key.serialize_pem())];
    files.iter().for_each(|(name, text)| std::fs::write(folder.path().join(name), text).unwrap());
    folder
}

/// One that has ended, and one that begins later: the clock of the control may have been set back.
#[test]
fn a_certificate_out_of_its_time_is_refused_with_the_reason() {
    for (from, until) in [(2_020, 2_021), (2_090, 2_091), (2_020, 2_091)] {
        let made = certificates_of(from, until);
        let mut site = Site::with(TestBroker::encrypted(made.path()), "tls: Some((ca: \"ca.pem\")),");
        std::fs::copy(made.path().join("ca.pem"), site.folder.path().join("ca.pem")).unwrap();
        if until - from > 1 {
            site.until_born();
        } else {
            site.until("the reason", |site| failure(site).contains("not valid now: check this clock and its dates"));
            assert_eq!(site.births().len(), 0);
        }
    }
}
