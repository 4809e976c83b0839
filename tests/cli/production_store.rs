//! Parts, hours and orders on the disk, as the next start of the control finds them. Source: spec B6.

use kt830::controller::StorageRequest;
use kt830::defs::date::DateTime;
use kt830::defs::hour_record::HourRecord;
use kt830::defs::part_record::PartRecord;
use kt830::defs::part_verdict::PartVerdict;
use kt830::defs::production_order::{OrderState, OrderValues, ProductionOrder};
use kt830::defs::wheel_record::WheelRecord;
use kt830::store::{RetainedChange, RetainedDatabase};

use crate::data_loss::open;

fn order(number: u32, good: u32) -> ProductionOrder {
    ProductionOrder {
        number,
        program: 1_002,
        target: 50,
        good,
        bad: 1,
        state: OrderState::Active,
        after: 7,
        values: OrderValues::default(),
    }
}

fn wheel(number: u16, diameter_mm: f64) -> WheelRecord {
    WheelRecord { number, diameter_mm, balanced: Some(DateTime(1_795_273_316)), crashes: 2, ..WheelRecord::default() }
}

#[test]
fn b6_the_next_start_finds_parts_hours_orders_and_wheels() {
    let folder = tempfile::tempdir().unwrap();
    let part = PartRecord {
        count: 1_003,
        number: 3,
        program: 1_002,
        order: 501,
        ended: DateTime(1_795_273_316),
        cycle_seconds: 27.1 / 3.0,
        // A size with all its digits comes back to the last bit.
        size: Some(40.0 + 1.0 / 3_000.0),
        limits: Some([40.0, 39.99, 40.01]),
        verdict: PartVerdict::Out { partly: true },
        since_dressing: 2,
        wheel_mm: Some(598.4),
        alarms: [103, 0, 0, 0],
    };
    let hour = HourRecord {
        hour: 498_686,
        seconds: [1_800, 600, 60, 1_140],
        explained: [0, 0, 0, 0, 600, 0],
        good: 37,
        bad: 1,
    };
    let (mut store, _) = open(folder.path());
    store
        .commit(&[
            StorageRequest::Part(part),
            StorageRequest::Hour(hour),
            StorageRequest::Order(700, Some(order(700, 0))),
            StorageRequest::Order(501, Some(order(501, 3))),
            StorageRequest::Order(600, Some(order(600, 0))),
            StorageRequest::Wheel(7, Some(wheel(7, 598.4))),
            StorageRequest::Wheel(3, Some(wheel(3, 500.0))),
        ])
        .unwrap();
    // Later changes of the same ones, in one batch.
    store
        .commit(&[
            StorageRequest::Order(600, None),
            StorageRequest::Order(501, Some(order(501, 4))),
            StorageRequest::Order(501, Some(order(501, 5))),
            StorageRequest::Wheel(3, None),
            StorageRequest::Wheel(5, Some(wheel(5, 400.0 / 3.0))),
        ])
        .unwrap();
    drop(store);
    let (store, found) = open(folder.path());
    assert!(found.loss.is_none(), "{:?}", found.loss);
    assert_eq!(found.retained.orders, [order(501, 5), order(700, 0)]);
    assert_eq!((found.retained.parts, found.retained.hours), (vec![part], vec![hour]));
    assert_eq!(found.retained.wheels, [wheel(5, 400.0 / 3.0), wheel(7, 598.4)]);
    drop(store);
    // An order or a wheel that cannot be read is told and leaves the others alone.
    let broken =
        ["order-650", "wheel-8"].map(|key| RetainedChange::Text { key: key.to_owned(), value: Some("{".to_owned()) });
    RetainedDatabase::open(folder.path()).unwrap().database.commit(&broken).unwrap();
    let (_, found) = open(folder.path());
    assert_eq!(found.retained.orders, [order(501, 5), order(700, 0)]);
    assert_eq!(found.retained.wheels.len(), 2);
    for key in ["order-650", "wheel-8"] {
        assert!(found.dropped.iter().any(|dropped| dropped.contains(key)), "{:?}", found.dropped);
    }
}
