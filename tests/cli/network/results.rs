//! Results of parts by MQTT: none is lost, none comes twice.
//! Source: docs/manual, chapter "network".

use kt830::defs::part_record::{PartHistory, PartRecord};
use kt830::defs::part_verdict::PartVerdict;
use kt830::gateway::Gateway;
use kt830::link::network::BrokerState;

use super::site::{NODE, Site};
use super::test_broker::Manners;
use super::{part, set};

#[test]
fn every_result_reaches_the_broker_over_losses_of_connection_and_power() {
    let mut site = Site::new();
    site.finish_part(1);
    site.until("the first", |site| site.results().len() == 1);
    let first = &site.results()[0];
    assert_eq!((&first["part"], &first["verdict"], &first["size_mm"]), (&1.into(), &"ok".into(), &39.9985.into()));
    assert_eq!((&first["machine"], &first["program"], &first["min_mm"]), (&NODE.into(), &1_002.into(), &39.995.into()));
    assert_eq!(
        (&first["wheel_mm"], &first["cycle_s"], &first["alarms"]),
        (&598.4.into(), &27.02.into(), &"103".into())
    );
    assert_eq!((&first["since_dressing"], &first["order"]), (&1.into(), &serde_json::Value::Null));
    site.steps(20);
    // Not acknowledged: sent again with the next connection.
    site.broker.manners = Manners::Forgetful;
    site.finish_part(2);
    site.until("the second", |site| site.results().len() == 2);
    assert_eq!(site.view().waiting, 1);
    site.broker.drop_client();
    site.until("the loss", |site| site.view().state != BrokerState::Connected);
    (3..=40).for_each(|count| site.finish_part(count));
    site.broker.manners = Manners::Good;
    site.until("all others", |site| site.view().state == BrokerState::Connected && site.view().waiting == 0);
    let parts =
        |site: &Site| -> Vec<u64> { site.results().iter().map(|told| told["part"].as_u64().unwrap()).collect() };
    let all: Vec<u64> = [1, 2].into_iter().chain(2..=40).collect();
    assert_eq!(parts(&site), all, "the unacknowledged one twice, the others once, in their order");
    // A size that is typed later is another result of the same part.
    site.snapshot.production.parts.entries_mut().last_mut().unwrap().verdict = PartVerdict::Out { partly: false };
    site.until("the new verdict", |site| parts(site).len() == all.len() + 1);
    assert_eq!((&site.results()[41]["part"], &site.results()[41]["is_bad"]), (&40.into(), &true.into()));
    // Until the file is written.
    site.steps(100);
    site.gateway = Gateway::default().with_folder(site.folder.path().to_path_buf());
    site.broker.sent.clear();
    site.until_born();
    site.steps(100);
    assert_eq!(parts(&site), [0; 0], "after the next power-on nothing is repeated");
    site.finish_part(41);
    site.until("the next", |site| parts(site) == [41]);
    // Data that were set up anew count from 1 again.
    let other = PartRecord { program: 1_003, ..part(1, PartVerdict::Good) };
    site.snapshot.production.parts = PartHistory::new([other], 90);
    site.until("the first of the new data", |site| parts(site) == [41, 1]);
}

#[test]
fn a_result_that_was_changed_while_the_broker_was_away_is_told_before_later_ones() {
    let mut site = Site::new();
    site.until_born();
    site.finish_part(1);
    site.until("the first", |site| site.results().len() == 1 && site.view().waiting == 0);
    site.broker.drop_client();
    site.until("the loss", |site| site.view().state != BrokerState::Connected);
    site.snapshot.production.parts.entries_mut()[0].verdict = PartVerdict::Out { partly: false };
    site.finish_part(2);
    site.until("both", |site| site.results().len() == 3);
    let told: Vec<_> = site.results().iter().map(|told| (told["part"].clone(), told["is_bad"].clone())).collect();
    assert_eq!(told, [(1, false), (1, true), (2, false)].map(|(part, is_bad)| (part.into(), is_bad.into())));
    // A power cut takes back what the disk did not have: the part that is made then is another one of that number.
    site.snapshot.production.parts = PartHistory::new([site.snapshot.production.parts[0]], 20);
    site.steps(10);
    site.snapshot.production.parts.push(PartRecord { program: 1_005, ..part(2, PartVerdict::Good) });
    site.until("the other part", |site| site.results().len() == 4);
    assert_eq!((&site.results()[3]["part"], &site.results()[3]["program"]), (&2.into(), &1_005.into()));
}

/// More parts than the control remembers, while the broker was away: the gap is counted.
#[test]
fn results_that_the_control_has_forgotten_are_counted() {
    let mut site = Site::new();
    site.until_born();
    site.finish_part(1);
    site.until("the result", |site| site.results().len() == 1 && site.view().waiting == 0);
    site.snapshot.production.parts = PartHistory::default();
    for count in [5, 6] {
        site.finish_part(count);
    }
    site.until("the results", |site| site.results().len() == 3);
    site.until("the gap", |site| site.view().lost == 3);
}

/// Results that were told under the old number are not told again under the new one; a size that is typed then is.
#[test]
fn another_number_of_the_machine_repeats_no_result() {
    let mut site = Site::new();
    (1..=3).for_each(|count| site.finish_part(count));
    site.until("the results", |site| site.results().len() == 3 && site.view().waiting == 0);
    set(&mut site.snapshot, "P482", 124.0);
    let under_new_name = |site: &Site| -> Vec<String> {
        let parts = site.broker.sent.iter().filter(|sent| sent.topic == "kt830/hall 2/kt830-gc-000124/part");
        parts.map(|sent| String::from_utf8(sent.payload.to_vec()).unwrap()).collect()
    };
    site.until_born_as("kt830-gc-000124");
    site.steps(200);
    assert_eq!(under_new_name(&site), [""; 0]);
    site.snapshot.production.parts.entries_mut()[1].verdict = PartVerdict::Out { partly: false };
    site.until("the changed one", |site| !under_new_name(site).is_empty());
    site.steps(200);
    assert!(under_new_name(&site).len() == 1 && under_new_name(&site)[0].contains("\"part\":2,"));
}
