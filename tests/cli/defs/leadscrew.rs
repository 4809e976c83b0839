//! Tests of `kt830::defs::leadscrew`.

use kt830::defs::leadscrew::{LeadscrewCompensation, LeadscrewPoint, MAX_POINTS};

#[test]
fn b7_a_table_is_read_between_its_points_and_level_beyond_them() {
    let table =
        LeadscrewCompensation::parse("# X\n位置,间隙,螺距\n-100, 0.03, -0.01\n0;0.01\n# 注释\n100\t0.02\t0.004\n")
            .unwrap();
    assert_eq!(table.points().len(), 3);
    let close = |a: f64, b: f64| (a - b).abs() < 1e-12;
    assert!(close(table.backlash_mm(-50.0), 0.02) && close(table.pitch_error_mm(-50.0), -0.005));
    assert!(close(table.backlash_mm(-500.0), 0.03) && close(table.backlash_mm(500.0), 0.02));
    assert!(close(table.backlash_mm(0.0), 0.01) && close(table.pitch_error_mm(50.0), 0.002));
    assert!(close(LeadscrewCompensation::default().backlash_mm(5.0), 0.0));
    assert_eq!(LeadscrewCompensation::parse(&table.to_text()), Ok(table));
}

#[test]
fn b7_the_text_of_the_longest_table_stays_below_what_the_store_takes() {
    // Thirds have the maximum number of digits; 4096 bytes is the longest text of the store.
    let row = |at: usize| format!("{},{},{}\n", at as f64 * 10.0 / 3.0 - 1500.0, 0.01 / 3.0, -0.01 / 3.0);
    let text: String = (0..MAX_POINTS).map(row).collect();
    assert!(text.len() > 4096);
    let table = LeadscrewCompensation::parse(&text).unwrap();
    assert_eq!(table.points().len(), MAX_POINTS);
    assert!(table.to_text().len() <= 4096, "{}", table.to_text().len());
    let kept = LeadscrewCompensation::parse(&table.to_text()).unwrap();
    assert_eq!(kept, table);
}

#[test]
fn b7_points_that_are_stored_as_one_are_refused_when_they_are_entered() {
    // A nanometre is stored. A table with two points in the same nanometre could not be read at the next start.
    let error = LeadscrewCompensation::parse("1.0000001,0.01\n1.0000002,0.01").unwrap_err();
    assert_eq!(error.line, 2);
    let point = |position_mm| LeadscrewPoint { position_mm, backlash_mm: 0.01, pitch_error_mm: 0.0 };
    assert!(LeadscrewCompensation::from_points(&[point(1.000_000_1), point(1.000_000_2)]).is_err());
    assert!(LeadscrewCompensation::from_points(&[point(1.000_001), point(1.000_002)]).is_ok());
}

#[test]
fn b7_a_wrong_table_is_refused_with_its_line() {
    for (text, line, said) in [
        ("0,0.01\n5", 2, "write a line as: position, backlash[, pitch error]"),
        ("0,x", 1, "'x' is not a number"),
        ("0,0.01\n\n0,0.02", 3, "positions must rise from line to line"),
        ("0,-0.01", 1, "-0.01 is out of range 0…2 mm"),
        ("0,0\n1,0.03", 2, "too large a change from the line before: at most 0.02 mm per mm"),
        ("0,0,inf", 1, "inf is out of range -2…2 mm"),
    ] {
        let fault = LeadscrewCompensation::parse(text).unwrap_err();
        assert_eq!((fault.line, &*fault.message.en()), (line, said), "{text}");
    }
    let long: String = (0..=MAX_POINTS).map(|at| format!("{at},0.01\n")).collect();
    assert_eq!(LeadscrewCompensation::parse(&long).unwrap_err().line, 101);
}
