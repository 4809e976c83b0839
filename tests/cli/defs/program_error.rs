//! Tests of `kt830::defs::program_error`.

use kt830::defs::program_error::*;

#[test]
fn b8_program_alarms_keep_to_their_range_and_are_unique() {
    for row in ProgramError::ALL {
        assert!(matches!(row.number(), 1..=65 | 67..=99 | 500..=599), "{}", row.id());
        let same = |other: &&ProgramError| other.number() == row.number() || other.id() == row.id();
        assert_eq!(ProgramError::ALL.iter().filter(same).count(), 1, "{}", row.id());
    }
}
