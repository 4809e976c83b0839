//! Tests of `kt830::defs::key`.

use kt830::defs::key::*;

#[test]
fn k2_1_every_key_has_its_own_id() {
    for (i, key) in Key::ALL.iter().enumerate() {
        assert!(Key::ALL[..i].iter().all(|other| other.id() != key.id()), "{} twice", key.id());
    }
}

#[test]
fn k2_2_in_a_run_only_fluids_and_run_keys_act() {
    let dead = [Key::WheelStart, Key::Hydraulic, Key::HeadstockHigh, Key::ModeManual, Key::XPlus, Key::DryRun];
    let alive = [Key::Coolant, Key::Lubrication, Key::CycleStart, Key::Reset, Key::SingleBlock, Key::BlockSkip];
    assert!(dead.iter().all(|key| !key.row().active_in_run));
    assert!(alive.iter().all(|key| key.row().active_in_run));
}
