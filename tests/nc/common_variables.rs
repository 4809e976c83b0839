//! The common variables: ranges, null, switches.

use kt830::nc::{CommonVariables, VariableError};

#[test]
fn k7_5_switch_variables_take_0_and_1_only() {
    let mut memory = CommonVariables::default();
    assert_eq!(memory.set(570, Some(1.0)), Ok(()));
    assert_eq!(memory.set(570, Some(0.5)), Err(VariableError::Switch(570)));
    assert_eq!(memory.set(579, None), Err(VariableError::Switch(579)));
    assert_eq!(memory.get(570), Ok(Some(1.0)));
    assert_eq!(memory.set(580, Some(0.5)), Ok(()));
}

#[test]
fn b3_commons_are_null_at_first_and_ranges_are_kept() {
    let mut memory = CommonVariables::default();
    assert_eq!(memory.get(100), Ok(None));
    for number in [0, 33, 99, 434, 499, 1000, u32::MAX] {
        assert_eq!(memory.get(number), Err(VariableError::Unknown(number)));
        assert_eq!(memory.set(number, Some(1.0)), Err(VariableError::Unknown(number)));
    }
    assert_eq!(memory.set(200, Some(f64::NAN)), Err(VariableError::NotFinite(200)));
    assert_eq!(memory.iter().count(), 0);
}
