//! Orders from the shop: each is a proposal that the operator accepts or deletes on the production page. Nothing of it is in
//! force before that.
//! Source: docs/manual, chapter "network".

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use crossbeam_channel::Sender;
use serde::de::{Deserializer, MapAccess, Visitor};
use serde::{Deserialize, Serialize};

use crate::defs::param;
use crate::defs::production_order::{MAX_ORDER_VALUES, OrderState, OrderValue, OrderValues, ProductionOrder};
use crate::defs::{program_number, variable_name};
use crate::link::production::{OrderPage, OrderProposal, ProposalCheck};
use crate::link::snapshot::{DirectoryRow, Snapshot};

/// Least time between two orders: the list has the one before then.
const ORDER_INTERVAL: Duration = Duration::from_secs(1);
/// Longest order, bytes.
pub const LONGEST_ORDER: usize = 1_024;
/// Longest reason that is told, characters.
const LONGEST_REASON: usize = 200;

/// An order as the shop sends it (JSON).
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct OrderMessage {
    order: u32,
    program: ProgramName,
    parts: u32,
    /// Values of the page by their variables: `"#501": 30.02`, `"R10": 0.01`.
    #[serde(default)]
    values: ValueList,
}

/// Values as they are written: one that comes twice is seen.
#[derive(Default)]
struct ValueList(Vec<(String, f64)>);

impl<'de> Deserialize<'de> for ValueList {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Pairs;
        impl<'de> Visitor<'de> for Pairs {
            type Value = ValueList;

            fn expecting(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                out.write_str("values by their variables")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<ValueList, A::Error> {
                let mut pairs = Vec::new();
                while let Some(pair) = map.next_entry()? {
                    pairs.push(pair);
                }
                Ok(ValueList(pairs))
            }
        }
        from.deserialize_map(Pairs)
    }
}

/// A program by its number, or by its name as the list of programs shows it.
#[derive(Deserialize)]
#[serde(untagged, expecting = "program is the number or the name of a program")]
enum ProgramName {
    Number(u32),
    Name(String),
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
    name: String,
    parts: u32,
    good: u32,
    bad: u32,
    state: &'static str,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    values: BTreeMap<String, f64>,
}

/// The inbox of a control, which all ways share: an order a second, so that the list has the one before.
pub type SharedInbox = Arc<Mutex<OrderInbox>>;

/// Where proposals go.
#[derive(Default)]
pub struct OrderInbox {
    proposals: Option<Sender<OrderProposal>>,
    /// When the next order may come.
    next_at: Duration,
}

impl OrderInbox {
    /// An inbox of a control.
    #[must_use]
    pub const fn new(proposals: Sender<OrderProposal>) -> Self {
        Self { proposals: Some(proposals), next_at: Duration::ZERO }
    }

    /// Takes an order; the answer to it.
    #[must_use]
    pub fn take(&mut self, now: Duration, payload: &[u8], snapshot: &Snapshot) -> String {
        let read = match payload.len() {
            0..=LONGEST_ORDER => serde_json::from_slice::<OrderMessage>(payload).map_err(|error| error.to_string()),
            _ => Err("an order is not so long".to_owned()),
        };
        match read {
            Ok(message) => {
                let number = message.order;
                let proposal = proposal_of(message);
                answer(Some(number), proposal.and_then(|proposal| self.propose(now, proposal, snapshot)))
            }
            Err(error) => answer(None, Err(error)),
        }
    }

    fn propose(&mut self, now: Duration, proposal: OrderProposal, snapshot: &Snapshot) -> Result<(), String> {
        let proposals = self.proposals.as_ref().filter(|_| takes_orders(snapshot));
        let proposals = proposals.ok_or("orders are not taken: P485 is 0")?;
        let is_there = |row: &DirectoryRow| row.number == proposal.program && row.is_for(snapshot.kind);
        let has_program = snapshot.directory.iter().any(is_there);
        let orders = snapshot.production.orders.as_slice();
        let page = OrderPage { kind: snapshot.kind, screens: &snapshot.screens, params: &snapshot.params };
        let check = ProposalCheck { orders, has_program, page };
        if let Some(why) = proposal.refusal(check) {
            return Err(why.en().into_owned());
        }
        if now < self.next_at || proposals.try_send(proposal).is_err() {
            return Err("too many at once: send it again a second later".to_owned());
        }
        self.next_at = now + ORDER_INTERVAL;
        Ok(())
    }
}

/// Whether orders of the shop are taken (P485).
#[must_use]
pub fn takes_orders(snapshot: &Snapshot) -> bool {
    snapshot.params.get(param::SHOP_ORDERS) > 0.0
}

/// The answer to an order of a number.
#[must_use]
pub fn answer(order: Option<u32>, taken: Result<(), String>) -> String {
    let why = taken.as_ref().err().map(|why| why.chars().take(LONGEST_REASON).collect());
    let answer = OrderAnswer { order, proposed: taken.is_ok(), why };
    // Numbers and texts: nothing in it can fail.
    serde_json::to_string(&answer).unwrap_or_default()
}

/// The list of orders as JSON; an empty one while orders of the shop are not taken.
#[must_use]
pub fn list(snapshot: &Snapshot) -> String {
    let named =
        |value: OrderValue| (variable_name::variable_name_on(u32::from(value.variable), snapshot.kind), value.number);
    let line = |order: &ProductionOrder| OrderLine {
        order: order.number,
        program: order.program,
        name: snapshot.title(order.program),
        parts: order.target,
        good: order.good,
        bad: order.bad,
        state: state_id(order.state),
        values: order.values.iter().map(named).collect(),
    };
    let orders = snapshot.production.orders.iter().filter(|_| takes_orders(snapshot));
    let lines: Vec<OrderLine> = orders.map(line).collect();
    serde_json::to_string(&lines).unwrap_or_default()
}

fn proposal_of(message: OrderMessage) -> Result<OrderProposal, String> {
    let program = match message.program {
        ProgramName::Number(number) => number,
        ProgramName::Name(name) => program_number::from_name(&name),
    };
    let mut values = OrderValues::default();
    for (name, number) in message.values.0 {
        let variable = variable_name::parse(&name);
        let variable = variable.ok_or_else(|| format!("{name:?} is not a variable: write \"#501\" or \"R10\""))?;
        values = values
            .with(OrderValue { variable, number })
            .ok_or_else(|| format!("{name:?}: an order has at most {MAX_ORDER_VALUES} values, each once"))?;
    }
    Ok(OrderProposal { number: message.order, program, target: message.parts, values })
}

const fn state_id(state: OrderState) -> &'static str {
    match state {
        OrderState::Proposed => "proposed",
        OrderState::Waiting => "waiting",
        OrderState::Active => "active",
        OrderState::Closed => "closed",
    }
}
