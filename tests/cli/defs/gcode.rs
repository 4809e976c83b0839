//! Tests of `kt830::defs::gcode`.

use kt830::defs::gcode::*;

#[test]
fn b2_every_row_is_found_by_its_number_and_ids_are_unique() {
    for row in G_CODES {
        assert_eq!(GCode::find(u32::from(row.code)).map(|found| found.id), Some(row.id));
        assert_eq!(G_CODES.iter().filter(|other| other.id == row.id).count(), 1);
    }
    assert!(GCode::find(5).is_none() && GCode::find(100).is_none());
}
