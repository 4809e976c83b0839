//! Production: what the operator does with the orders, what was made. Source: spec B6, K4.5.

use super::screens::Screens;
use crate::defs::downtime_reason::DowntimeReason;
use crate::defs::hour_record::HourHistory;
use crate::defs::kind::Kind;
use crate::defs::param::{self, Params};
use crate::defs::part_record::{PartHistory, PartRecord};
use crate::defs::part_verdict::PartVerdict;
use crate::defs::production_order::{
    MAX_ORDERS, MAX_PROPOSALS, ORDER_NUMBERS, ORDER_TARGETS, OrderState, OrderValues, PLACES_OF_OPERATOR,
    ProductionOrder,
};
use crate::defs::text::arg::Arg;
use crate::defs::text::{LocalizedText, Text, phrase};
use crate::defs::value_bound::TYPED_VALUE_LIMIT;
use crate::defs::variable_name;
use crate::defs::wheel_record::WheelRecord;
use crate::units::Micros;

/// An order that the shop sends: the operator accepts it, or not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrderProposal {
    /// Its number.
    pub number: u32,
    /// The program of its parts.
    pub program: u32,
    /// Good parts wanted.
    pub target: u32,
    /// Values of its page.
    pub values: OrderValues,
}

impl From<&ProductionOrder> for OrderProposal {
    fn from(order: &ProductionOrder) -> Self {
        let &ProductionOrder { number, program, target, values, .. } = order;
        Self { number, program, target, values }
    }
}

/// What a proposal is checked against.
#[derive(Clone, Copy, Debug)]
pub struct ProposalCheck<'a> {
    /// The orders of the list.
    pub orders: &'a [ProductionOrder],
    /// Whether its program is there.
    pub has_program: bool,
    /// Where its values stand.
    pub page: OrderPage<'a>,
}

/// What tells which values an order may ask for.
#[derive(Clone, Copy, Debug)]
pub struct OrderPage<'a> {
    /// The kind of the machine.
    pub kind: Kind,
    /// The page texts.
    pub screens: &'a Screens,
    /// The parameters.
    pub params: &'a Params,
}

const NO_PAGE: Text = Text::new(
    "程序没有页面，或页面文件有错，不能带数值",
    "the program has no page, or its page text is faulty: no values",
);

impl OrderProposal {
    /// Why it cannot be proposed to the operator; none if it can.
    #[must_use]
    pub fn refusal(&self, check: ProposalCheck<'_>) -> Option<LocalizedText> {
        self.refusal_of_figures(check).map(LocalizedText::from).or_else(|| self.refusal_of_values(check.page))
    }

    fn refusal_of_figures(&self, check: ProposalCheck<'_>) -> Option<Text> {
        let ProposalCheck { orders, has_program, .. } = check;
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

    /// Why a value cannot be that of its page; none if all can.
    #[must_use]
    pub fn refusal_of_values(&self, page: OrderPage<'_>) -> Option<LocalizedText> {
        let OrderPage { kind, screens, params } = page;
        self.values.iter().find_map(|value| {
            let name = Arg::Variable(u32::from(value.variable), kind.dialect());
            let mut rows = screens.part_rows(kind, self.program).peekable();
            if rows.peek().is_none() {
                return Some(NO_PAGE.into());
            }
            let Some(row) = rows.find(|row| row.variable == value.variable) else {
                return Some(phrase!("程序的页面没有 {name}", "the page of the program does not show {name}", name));
            };
            if row.is_state() || value.variable == params.get(param::TREND_SIZE_VARIABLE) as u16 {
                return Some(phrase!(
                    "{name} 是测量、累计或砂轮的值，订单不能给出",
                    "{name} is measured, counted or of the wheel: no order sets it",
                    name
                ));
            }
            if variable_name::is_switch(u32::from(value.variable)) && !matches!(value.number, 0.0 | 1.0) {
                return Some(phrase!("{name} 应为 0 或 1", "{name} must be 0 or 1", name));
            }
            (!fits_display(value.number)).then(|| {
                phrase!(
                    "{name} 应在 ±{TYPED_VALUE_LIMIT} 内，最多 3 位小数",
                    "{name} must be within ±{TYPED_VALUE_LIMIT}, with three decimals at most",
                    name,
                    TYPED_VALUE_LIMIT
                )
            })
        })
    }
}

/// Whether a value is shown as it is: three decimals, within the limits of typed values.
fn fits_display(number: f64) -> bool {
    number.abs() <= TYPED_VALUE_LIMIT && format!("{number:.3}").parse() == Ok(number)
}

/// A request of the page of orders.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OrderCommand {
    /// Adds an order, or changes program and target of the one with this number.
    /// The values are those of the order as it was shown.
    Enter(OrderProposal),
    /// The operator accepts a proposed order as it was shown: the shop may have changed it meanwhile.
    Accept(OrderProposal),
    /// Finished parts count for this order; its program becomes the current one.
    Start {
        /// Its number.
        number: u32,
        /// Its values become those of the page; without it those of the page stay.
        takes_values: bool,
    },
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
    /// Why the machine stands, as the operator has said; none while it runs.
    pub downtime_reason: Option<DowntimeReason>,
    /// Orders by their numbers.
    pub orders: Vec<ProductionOrder>,
    /// The wheels of the shop by their numbers.
    pub wheels: Vec<WheelRecord>,
}

impl ProductionView {
    /// Whether another one shows something else.
    #[must_use]
    pub fn differs(&self, other: &Self) -> bool {
        (self.parts.version(), self.hours.version()) != (other.parts.version(), other.hours.version())
            || (self.downtime_reason, &self.orders, &self.wheels)
                != (other.downtime_reason, &other.orders, &other.wheels)
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
