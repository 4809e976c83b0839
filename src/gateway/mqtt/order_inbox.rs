//! Orders from the shop: each is a proposal that the operator accepts or deletes on the production page. Nothing of it is in
//! force before that.
//! Source: docs/manual, chapter "network".

use std::time::Duration;

use crossbeam_channel::Sender;
use serde::{Deserialize, Serialize};

use crate::defs::param;
use crate::defs::production_order::{OrderState, ProductionOrder};
use crate::link::production::OrderProposal;
use crate::link::snapshot::{DirectoryRow, Snapshot};

/// Least time between two orders: the list has the one before then.
const ORDER_INTERVAL: Duration = Duration::from_secs(1);
/// Longest order, bytes, and longest reason that is told, characters.
const LONGEST_ORDER: usize = 1_024;
const LONGEST_REASON: usize = 200;

/// An order as the shop sends it (JSON).
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct OrderMessage {
    order: u32,
    program: u32,
    parts: u32,
}

/// What became of it (JSON).
#[derive(Serialize)]
struct OrderAnswer {
    /// None if it cannot be read.
    order: Option<u32>,
    proposed: bool,
    /// Why it is not.
    why: Option<String>,
}

/// An order of the list, for the shop (JSON).
#[derive(Serialize)]
struct OrderLine {
    order: u32,
    program: u32,
    parts: u32,
    good: u32,
    bad: u32,
    state: &'static str,
}

/// Where proposals go, and the list that the broker has.
#[derive(Default)]
pub struct OrderInbox {
    proposals: Option<Sender<OrderProposal>>,
    told: Option<Vec<ProductionOrder>>,
    /// Whether the broker sends orders in this connection.
    is_subscribed: bool,
    /// When the next order may come.
    next_at: Duration,
}

impl OrderInbox {
    /// An inbox of a control.
    #[must_use]
    pub const fn new(proposals: Sender<OrderProposal>) -> Self {
        Self { proposals: Some(proposals), told: None, is_subscribed: false, next_at: Duration::ZERO }
    }

    /// Whether orders are to be asked for now, once in a connection.
    pub fn begins(&mut self, snapshot: &Snapshot) -> bool {
        let is_wanted = snapshot.params.get(param::MQTT_ORDERS) > 0.0;
        is_wanted && !std::mem::replace(&mut self.is_subscribed, is_wanted)
    }

    /// Takes an order; the answer to it. One that the broker has kept may be old, and comes again with each connection.
    #[must_use]
    pub fn take(&mut self, now: Duration, (payload, is_retained): (&[u8], bool), snapshot: &Snapshot) -> String {
        let read = match payload.len() {
            0..=LONGEST_ORDER => serde_json::from_slice::<OrderMessage>(payload).map_err(|error| error.to_string()),
            _ => Err("an order is not so long".to_owned()),
        };
        let (order, taken) = match read {
            Ok(message) if is_retained => (Some(message.order), Err("an order must not be retained".to_owned())),
            Ok(OrderMessage { order, program, parts }) => {
                let proposal = OrderProposal { number: order, program, target: parts };
                (Some(order), self.propose(now, proposal, snapshot))
            }
            Err(error) => (None, Err(error)),
        };
        let why = taken.as_ref().err().map(|why| why.chars().take(LONGEST_REASON).collect());
        let answer = OrderAnswer { order, proposed: taken.is_ok(), why };
        // Numbers and texts: nothing in it can fail.
        serde_json::to_string(&answer).unwrap_or_default()
    }

    /// The list of orders as JSON, if the broker has another one.
    #[must_use]
    pub fn changed_list(&mut self, snapshot: &Snapshot) -> Option<String> {
        let orders = &snapshot.production.orders;
        if snapshot.params.get(param::MQTT_ORDERS) < 1.0 || self.told.as_ref() == Some(orders) {
            return None;
        }
        self.told = Some(orders.clone());
        let line = |order: &ProductionOrder| OrderLine {
            order: order.number,
            program: order.program,
            parts: order.target,
            good: order.good,
            bad: order.bad,
            state: state_id(order.state),
        };
        let lines: Vec<OrderLine> = orders.iter().map(line).collect();
        Some(serde_json::to_string(&lines).unwrap_or_default())
    }

    /// The connection is over: the next one is told the list.
    pub fn connection_lost(&mut self) {
        (self.told, self.is_subscribed) = (None, false);
    }

    fn propose(&mut self, now: Duration, proposal: OrderProposal, snapshot: &Snapshot) -> Result<(), String> {
        let proposals = self.proposals.as_ref().filter(|_| snapshot.params.get(param::MQTT_ORDERS) > 0.0);
        let proposals = proposals.ok_or("orders are not taken: P485 is 0")?;
        let is_there = |row: &DirectoryRow| row.number == proposal.program && row.is_for(snapshot.kind);
        let has_program = snapshot.directory.iter().any(is_there);
        if let Some(why) = proposal.refusal(&snapshot.production.orders, has_program) {
            return Err(why.en.to_owned());
        }
        if now < self.next_at || proposals.try_send(proposal).is_err() {
            return Err("too many at once: send it again a second later".to_owned());
        }
        self.next_at = now + ORDER_INTERVAL;
        Ok(())
    }
}

const fn state_id(state: OrderState) -> &'static str {
    match state {
        OrderState::Proposed => "proposed",
        OrderState::Waiting => "waiting",
        OrderState::Active => "active",
        OrderState::Closed => "closed",
    }
}
