//! Production orders: how many parts of which program are to be made. Retained data. Source: spec B6.

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use super::part_record::PartRecord;
use super::text::Text;

/// Most orders in the list.
pub const MAX_ORDERS: usize = 20;
/// Most orders in it that the shop has sent and nobody has accepted.
pub const MAX_PROPOSALS: usize = 8;
/// Places in it that the shop does not take.
pub const PLACES_OF_OPERATOR: usize = 4;
/// Numbers of orders.
pub const ORDER_NUMBERS: RangeInclusive<u32> = 1..=99_999_999;
/// Parts of an order.
pub const ORDER_TARGETS: RangeInclusive<u32> = 1..=999_999;

/// Most values of an order.
pub const MAX_ORDER_VALUES: usize = 8;

/// Values of its program's page that an order asks for: sizes, tolerances, infeeds. They are in force once the operator has
/// started it with them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OrderValues([Option<OrderValue>; MAX_ORDER_VALUES]);

/// A value that an order asks for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct OrderValue {
    /// The variable.
    pub variable: u16,
    /// As the page shows it.
    pub number: f64,
}

impl OrderValues {
    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.iter().next().is_none()
    }

    /// The values.
    pub fn iter(&self) -> impl Iterator<Item = OrderValue> + '_ {
        self.0.iter().flatten().copied()
    }

    /// With one more; none if there are too many, or if it has that variable.
    #[must_use]
    pub fn with(mut self, value: OrderValue) -> Option<Self> {
        let is_new = self.iter().all(|known| known.variable != value.variable);
        let place = self.0.iter_mut().find(|place| place.is_none()).filter(|_| is_new)?;
        *place = Some(value);
        Some(self)
    }
}

/// State of an order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum OrderState {
    /// Not begun, or set aside.
    #[default]
    Waiting,
    /// Finished parts of its program count for it. At most one order is active.
    Active,
    /// Complete, or closed by the operator.
    Closed,
    /// Sent by the shop; the operator has not accepted it.
    Proposed,
}

impl OrderState {
    /// The name shown.
    #[must_use]
    pub const fn name(self) -> Text {
        match self {
            Self::Waiting => Text::new("等待", "WAITING"),
            Self::Active => Text::new("进行", "ACTIVE"),
            Self::Closed => Text::new("结束", "CLOSED"),
            Self::Proposed => Text::new("待接受", "PROPOSED"),
        }
    }
}

/// A production order.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProductionOrder {
    /// Its number, as the shop gives it.
    pub number: u32,
    /// The program of its parts.
    pub program: u32,
    /// Good parts wanted.
    pub target: u32,
    /// Parts that are not bad. Parts that nobody has measured count as such.
    pub good: u32,
    /// Bad parts.
    pub bad: u32,
    /// Its state.
    pub state: OrderState,
    /// Serial number of the last part before it was entered: an older part of the same number is that of another order.
    pub after: u64,
    /// What the shop asks for with it.
    #[serde(default, skip_serializing_if = "OrderValues::is_empty")]
    pub values: OrderValues,
}

impl ProductionOrder {
    /// Whether a part was made for it.
    #[must_use]
    pub const fn has(&self, part: &PartRecord) -> bool {
        part.order == self.number && part.count > self.after
    }

    /// Whether all parts that are wanted are made.
    #[must_use]
    pub const fn is_complete(&self) -> bool {
        self.good >= self.target
    }

    /// Good parts left to make.
    #[must_use]
    pub const fn left(&self) -> u32 {
        self.target.saturating_sub(self.good)
    }

    /// Finished parts.
    #[must_use]
    pub const fn made(&self) -> u32 {
        self.good + self.bad
    }
}
