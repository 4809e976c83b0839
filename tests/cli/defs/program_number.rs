//! Tests of `kt830::defs::program_number`.

use kt830::defs::program_number::{L_MAX, from_l, from_name, is_named, is_o_number, name_of, stem};

#[test]
fn s1_names_have_one_number_for_good() {
    assert_eq!((from_name("O1001"), from_name("o1001")), (1001, 1001));
    assert_eq!(
        (from_name("L10"), from_name("l10"), name_of(from_name("L10"))),
        (from_l(10), from_l(10), "L10".to_owned())
    );
    assert!(is_named(from_name("VGRIND")) && from_name("VGRIND") == from_name("vgrind"));
    assert!(from_name("VGRIND") != from_name("PRINTED") && !is_named(from_l(L_MAX)));
    assert_eq!((from_name("O12345678"), name_of(12_345_678)), (12_345_678, "O12345678".to_owned()));
    assert!([from_l(0), from_l(L_MAX)].iter().all(|l| !is_o_number(*l)) && name_of(from_l(L_MAX)) == "L9999999");
    assert_eq!(stem("programs/802d/VGRIND.MPF"), "VGRIND");
}
