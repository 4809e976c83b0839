//! Orders from the shop: each is a proposal that the operator accepts or deletes on the production page. Nothing of it is in
//! force before that.
//! Source: docs/manual, chapter "network".

use crossbeam_channel::Sender;
use serde::{Deserialize, Serialize};

use crate::defs::param;
use crate::defs::production_order::{OrderState, ProductionOrder};
use crate::link::production::OrderProposal;
use crate::link::snapshot::Snapshot;

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
}

impl OrderInbox {
    /// An inbox of a control.
    #[must_use]
    pub const fn new(proposals: Sender<OrderProposal>) -> Self {
        Self { proposals: Some(proposals), told: None }
    }

    /// Takes an order; the answer to it.
    #[must_use]
    pub fn take(&self, payload: &[u8], snapshot: &Snapshot) -> String {
        let (order, taken) = match serde_json::from_slice::<OrderMessage>(payload) {
            Ok(OrderMessage { order, program, parts }) => {
                (Some(order), self.propose(OrderProposal { number: order, program, target: parts }, snapshot))
            }
            Err(error) => (None, Err(error.to_string())),
        };
        let answer = OrderAnswer { order, proposed: taken.is_ok(), why: taken.err() };
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
        self.told = None;
    }

    fn propose(&self, proposal: OrderProposal, snapshot: &Snapshot) -> Result<(), String> {
        let proposals = self.proposals.as_ref().filter(|_| snapshot.params.get(param::MQTT_ORDERS) > 0.0);
        let proposals = proposals.ok_or("orders are not taken: P485 is 0")?;
        let is_there = |row: &crate::link::snapshot::DirectoryRow| row.number == proposal.program;
        let has_program = snapshot.directory.iter().any(is_there);
        if let Some(why) = proposal.refusal(&snapshot.production.orders, has_program) {
            return Err(why.en.to_owned());
        }
        proposals.try_send(proposal).map_err(|_| "too many at once: send it again".to_owned())
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
