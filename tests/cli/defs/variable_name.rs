//! Tests of `kt830::defs::variable_name`.

use kt830::defs::kind::Dialect;
use kt830::defs::variable_name::{parse, variable_name};

#[test]
fn s1_r_parameters_have_names_of_their_own() {
    assert_eq!(
        (parse("R18"), parse("r0"), parse("R299"), parse("R300"), parse("#618")),
        (Some(618), Some(600), Some(899), None, Some(618))
    );
    assert_eq!(
        (variable_name(618, Dialect::Sinumerik), variable_name(618, Dialect::Mill)),
        ("R18".to_owned(), "#618".to_owned())
    );
    assert_eq!(variable_name(500, Dialect::Sinumerik), "#500");
    assert!(parse("R").is_none() && parse("R-1").is_none() && parse("18").is_none());
}
