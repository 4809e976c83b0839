//! Production: what the operator does with the orders, what was made. Source: spec B6, K4.5.

use crate::defs::hour_record::HourHistory;
use crate::defs::part_record::{PartHistory, PartRecord};
use crate::defs::part_verdict::PartVerdict;
use crate::defs::production_order::{
    MAX_ORDERS, MAX_PROPOSALS, ORDER_NUMBERS, ORDER_TARGETS, OrderState, PLACES_OF_OPERATOR, ProductionOrder,
};
use crate::defs::text::Text;
use crate::units::Micros;

/// An order that the shop sends: the operator accepts it, or not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OrderProposal {
    /// Its number.
    pub number: u32,
    /// The program of its parts.
    pub program: u32,
    /// Good parts wanted.
    pub target: u32,
}

impl OrderProposal {
    /// Why it cannot be proposed to the operator of these orders; none if it can.
    #[must_use]
    pub fn refusal(&self, orders: &[ProductionOrder], has_program: bool) -> Option<Text> {
        let is_proposed = |order: &&ProductionOrder| order.state == OrderState::Proposed;
        let known = orders.iter().find(|order| order.number == self.number);
        let is_full = orders.len() >= MAX_ORDERS - PLACES_OF_OPERATOR
            || orders.iter().filter(is_proposed).count() >= MAX_PROPOSALS;
        Some(match known {
            _ if !ORDER_NUMBERS.contains(&self.number) => {
                Text::new("订单号应为 1–99999999", "an order has a number from 1 to 99999999")
            }
            _ if !ORDER_TARGETS.contains(&self.target) => {
                Text::new("件数应为 1–999999", "the parts of an order are 1 to 999999")
            }
            _ if !has_program => Text::new("没有这个程序", "there is no such program"),
            Some(order) if order.state != OrderState::Proposed => {
                Text::new("订单已在表中", "the order is in the list already")
            }
            None if is_full => Text::new("订单已满", "the list is full"),
            Some(_) | None => return None,
        })
    }
}

/// A request of the page of orders.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OrderCommand {
    /// Adds an order, or changes program and target of the one with this number.
    Enter {
        /// Its number.
        number: u32,
        /// The program of its parts.
        program: u32,
        /// Good parts wanted.
        target: u32,
    },
    /// The operator accepts a proposed order as it was shown: the shop may have changed it meanwhile.
    Accept(OrderProposal),
    /// Finished parts count for this order; its program becomes the current one.
    Start(u32),
    /// The order is over, complete or not.
    Close(u32),
    /// The order leaves the list.
    Delete(u32),
}

/// What was found out of the part of the last cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartInspection {
    /// The end of its cycle.
    pub ended_at: Micros,
    /// Its size, mm.
    pub size: Option<f64>,
    /// Whether it is good.
    pub verdict: PartVerdict,
}

/// What the machine has made.
#[derive(Clone, Debug, Default)]
pub struct ProductionView {
    /// Finished parts, also before the last power-off, newest last.
    pub parts: PartHistory,
    /// What the machine did, hour by hour.
    pub hours: HourHistory,
    /// Orders by their numbers.
    pub orders: Vec<ProductionOrder>,
}

impl ProductionView {
    /// Whether another one shows something else.
    #[must_use]
    pub fn differs(&self, other: &Self) -> bool {
        (self.parts.version(), self.hours.version()) != (other.parts.version(), other.hours.version())
            || self.orders != other.orders
    }

    /// The order of a number.
    #[must_use]
    pub fn order(&self, number: u32) -> Option<&ProductionOrder> {
        self.orders.iter().find(|order| order.number == number)
    }

    /// The order for which parts are made now.
    #[must_use]
    pub fn active(&self) -> Option<&ProductionOrder> {
        self.orders.iter().find(|order| order.state == OrderState::Active)
    }
}

/// The sizes of the last parts with the same limits, and these; sizes of other limits say nothing of the same process.
#[must_use]
pub fn like_sizes(parts: &[&PartRecord]) -> (Vec<f64>, Option<[f64; 3]>) {
    let sized = || parts.iter().rev().filter_map(|part| Some((part.size?, part.limits)));
    let limits = sized().next().and_then(|(_, limits)| limits);
    let mut sizes: Vec<f64> = sized().take_while(|(_, other)| *other == limits).map(|(size, _)| size).collect();
    sizes.reverse();
    (sizes, limits)
}
