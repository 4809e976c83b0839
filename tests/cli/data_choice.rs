//! What a person chooses in place of lost data: the data in force, an earlier state or factory values, each accepted in its
//! turn before the machine works. Source: safety stance; spec B6.

use std::fs;

use kt830::controller::StorageRequest;
use kt830::defs::alarm_history::PastAlarm;
use kt830::defs::date::DateTime;
use kt830::defs::kind::Kind;
use kt830::defs::leadscrew::LeadscrewCompensation;
use kt830::defs::param::ParamAddress;
use kt830::defs::text::LocalizedText;
use kt830::host::data_loss::LossChoice;
use kt830::host::retained_store::{RetainedStore, StoreReport};
use kt830::link::page_command::{DataChoice, KeptState, PasswordScope, Secret, SettingsRequest, StorageAnswer};
use kt830::nc::OriginPlace;
use kt830::store::{KIND_FILE, PASSWORD_FILE};
use kt830::units::{Axis, PerAxis};
use tempfile::TempDir;

use crate::data_loss::{DATABASE, answer, choose, has_values, matches, open, session, value};

/// A value that only the second session sets: `P71`.
fn second_param(found: &StoreReport) -> f64 {
    found.retained.params.read(ParamAddress::parse("P71").unwrap()).unwrap()
}

/// The data are lost, and nobody has chosen others.
fn is_as_lost(found: &StoreReport) -> bool {
    found.loss.as_ref().is_some_and(|loss| loss.choice == LossChoice::None)
}

fn change_password(store: &mut RetainedStore, old: &str, new: &str) {
    let [old, new] = [old, new].map(|word| Secret::new(word.into()));
    let request = SettingsRequest::ChangePassword { scope: PasswordScope::Builder, old, new };
    assert_eq!(answer(store, &request), StorageAnswer::PasswordChanged(PasswordScope::Builder, true));
}

/// Data of two sessions that are gone now. The second one has set a value of every sort. Returns the states that can be
/// chosen, the newest first.
fn two_lost_sessions() -> (TempDir, Vec<KeptState>) {
    let folder = session();
    let (mut store, _) = open(folder.path());
    let past = PastAlarm {
        count: 1,
        number: 180,
        text: LocalizedText::same(&"pressure"),
        cause: Default::default(),
        remedy: Default::default(),
        place: None,
        came: DateTime(0),
        ended: None,
    };
    let changes = [
        StorageRequest::Variable(860, Some(99.0)),
        StorageRequest::Variable(950, Some(1.0)),
        StorageRequest::Param(ParamAddress::parse("P71").unwrap(), 42.0),
        StorageRequest::LeadscrewTable(Axis::X, LeadscrewCompensation::parse("0, 0\n100, 0.01\n").unwrap()),
        StorageRequest::DressPoint(Axis::X, Some(12.5)),
        StorageRequest::Offset { number: 3, geometry: PerAxis::from_fn(|_| 4.0), wear: PerAxis::default() },
        StorageRequest::WorkOffset(OriginPlace::of_stored_index(1).unwrap(), PerAxis::from_fn(|_| 5.0)),
        StorageRequest::RunningAt(Some((1_002, 7))),
        StorageRequest::Alarm(past),
    ];
    store.commit(&changes).unwrap();
    drop(store);
    fs::remove_file(folder.path().join(DATABASE)).unwrap();
    let (_, found) = open(folder.path());
    assert!(found.loss.is_some() && value(&found, 860) == Some(99.0) && second_param(&found) > 41.0);
    assert_eq!(found.retained.interrupted, None, "the place is that of the state");
    assert_ne!(found.retained.leadscrew_tables[Axis::X], LeadscrewCompensation::default());
    let states = found.retained.kept_states.to_vec();
    // The third one is the first start, before a value was set.
    assert_eq!(states.len(), 3, "{states:?}");
    (folder, states)
}

/// What the second session has set is gone again; the loss stands until the choice is accepted in its turn.
fn assert_chosen(found: &StoreReport) {
    let loss = found.loss.as_ref().unwrap();
    assert!(loss.choice == LossChoice::Made && loss.message().en().contains("chosen: "), "{loss:?}");
    let retained = &found.retained;
    assert_eq!((value(found, 950), retained.dress_points[Axis::X], retained.interrupted), (None, None, None));
    assert!(second_param(found) < 41.0);
    assert_eq!(retained.leadscrew_tables[Axis::X], LeadscrewCompensation::default());
    assert_eq!(retained.work_offsets.geometry[2], PerAxis::default());
    assert_eq!(retained.work_offsets.origin(OriginPlace::of_stored_index(1).unwrap()), PerAxis::default());
    assert_eq!(retained.alarm_history.len(), 1, "the alarm history goes on");
}

/// A start after which the copies beside the database are gone: password and kind are those of the database itself.
fn assert_password_and_kind(folder: &TempDir, password: &str) {
    fs::remove_file(folder.path().join(PASSWORD_FILE)).unwrap();
    fs::remove_file(folder.path().join(KIND_FILE)).unwrap();
    assert_eq!(RetainedStore::kind_of(folder.path()), Some(Kind::Gc));
    let (mut store, _) = open(folder.path());
    assert!(matches(&mut store, password) && !matches(&mut store, "4711") && !matches(&mut store, "830830"));
}

#[test]
fn b6_an_earlier_state_is_chosen_after_a_loss_and_is_accepted_after_the_next_start() {
    let (folder, states) = two_lost_sessions();
    let (mut store, _) = open(folder.path());
    choose(&mut store, DataChoice::Kept(states[1].clone()));
    store.commit(&[StorageRequest::Variable(861, Some(-1.0))]).unwrap();
    // The state has the password of before; the one since the loss counts.
    change_password(&mut store, "4711", "4713");
    drop(store);
    for start in 1..=2 {
        let (_, found) = open(folder.path());
        assert!(has_values(&found), "start {start}: those of the first session");
        assert_chosen(&found);
    }
    assert_password_and_kind(&folder, "4713");
    let (mut store, _) = open(folder.path());
    let kept = || fs::read_dir(folder.path().join("generations")).unwrap().count();
    let before = kept();
    choose(&mut store, DataChoice::Present);
    assert_eq!(kept(), before + 1, "it is kept at once");
    drop(store);
    // It is the state from then on.
    fs::remove_file(folder.path().join(DATABASE)).unwrap();
    let (_, found) = open(folder.path());
    assert!(is_as_lost(&found) && has_values(&found) && value(&found, 950).is_none());
}

#[test]
fn b6_factory_values_are_chosen_after_a_loss_and_stand_under_the_alarm_until_they_are_accepted() {
    let (folder, _) = two_lost_sessions();
    let (mut store, _) = open(folder.path());
    choose(&mut store, DataChoice::Factory);
    change_password(&mut store, "4711", "4713");
    drop(store);
    let (_, found) = open(folder.path());
    assert_eq!((value(&found, 860), value(&found, 861)), (None, None));
    assert_chosen(&found);
    assert_password_and_kind(&folder, "4713");
    let (mut store, _) = open(folder.path());
    choose(&mut store, DataChoice::Present);
    drop(store);
    assert_eq!(open(folder.path()).1.loss, None);
}

#[test]
fn b6_a_choice_that_cannot_be_carried_out_changes_nothing_then_or_later() {
    let (folder, states) = two_lost_sessions();
    let (mut store, _) = open(folder.path());
    // The last choice counts.
    choose(&mut store, DataChoice::Factory);
    choose(&mut store, DataChoice::Kept(states[1].clone()));
    drop(store);
    let kept = folder.path().join(format!("generations/retained-{:010}.ron", states[1].number));
    let whole = fs::read(&kept).unwrap();
    fs::write(&kept, &whole[..whole.len() / 2]).unwrap();
    let (mut store, found) = open(folder.path());
    let told = found.loss.as_ref().map(|loss| (loss.choice, loss.message().en().contains("could not be used")));
    assert_eq!(told, Some((LossChoice::Missed, true)), "the loss stands, and says so");
    assert_eq!((value(&found, 860), value(&found, 950)), (Some(99.0), Some(1.0)), "the newest state");
    assert_eq!(found.retained.kept_states.len(), 2, "the damaged one cannot be chosen any more");
    // Nor is it asked for in vain.
    let request = SettingsRequest::AcceptData(DataChoice::Kept(states[1].clone()));
    assert!(matches!(answer(&mut store, &request), StorageAnswer::Failed(_)));
    drop(store);
    // Whole again: the choice of then does not come over what was set since.
    fs::write(&kept, &whole).unwrap();
    let (mut store, found) = open(folder.path());
    assert_eq!((found.loss.is_some(), value(&found, 860)), (true, Some(99.0)));
    choose(&mut store, DataChoice::Present);
    drop(store);
    let (_, found) = open(folder.path());
    assert_eq!((&found.loss, value(&found, 860)), (&None, Some(99.0)), "the present data, for good");
}

#[test]
fn b6_accepted_data_are_not_replaced_any_more() {
    let (folder, states) = two_lost_sessions();
    let (mut store, _) = open(folder.path());
    choose(&mut store, DataChoice::Factory);
    choose(&mut store, DataChoice::Present);
    for late in [DataChoice::Factory, DataChoice::Kept(states[1].clone())] {
        let request = SettingsRequest::AcceptData(late);
        assert!(matches!(answer(&mut store, &request), StorageAnswer::Failed(_)));
    }
    drop(store);
    let (_, found) = open(folder.path());
    assert_eq!((&found.loss, value(&found, 860)), (&None, Some(99.0)));
    // Nor at a later loss.
    fs::remove_file(folder.path().join(DATABASE)).unwrap();
    let (_, found) = open(folder.path());
    assert!(is_as_lost(&found) && value(&found, 860) == Some(99.0));
}
