//! Tests of `kt830::defs::param_row`.

use kt830::defs::kind::Kind;
use kt830::defs::param;
use kt830::defs::param::{ParamAddress, Params};
use kt830::defs::param_row::{ParamType, access_level, rows};

#[test]
fn l2_the_range_shown_is_the_range_that_a_write_keeps() {
    for kind in Kind::ALL {
        let mut params = Params::factory(kind);
        for row in rows(kind).iter().filter(|row| row.param_type == ParamType::Number) {
            assert_eq!(params.write(row.address, row.min), Ok(()), "{} on {kind:?}", row.address);
            assert_eq!(params.write(row.address, row.max), Ok(()), "{} on {kind:?}", row.address);
            assert!(params.write(row.address, row.max + 1.0).is_err(), "{} on {kind:?}", row.address);
        }
    }
    let rapid = rows(Kind::Lathe).into_iter().find(|row| row.address == param::RAPID_X.address());
    assert_eq!(rapid.map(|row| row.range().en().into_owned()), Some("1000 … 3000 mm/min".to_owned()));
}

#[test]
fn b6_every_parameter_stands_once_with_its_level_and_factory_value_in_range() {
    for kind in Kind::ALL {
        let rows = rows(kind);
        for (index, row) in rows.iter().enumerate() {
            assert!(
                rows[..index].iter().all(|other| other.address != row.address),
                "{} twice on {kind:?}",
                row.address
            );
            assert_eq!(access_level(row.address), Some(row.level), "{}", row.address);
            assert!((row.min..=row.max).contains(&row.factory), "{} {}", row.address, row.factory);
        }
    }
    assert_eq!(access_level(ParamAddress { number: 499, bit: None }), None);
}
