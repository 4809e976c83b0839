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
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
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
