//! Orders that clients propose: handed to the thread that speaks with the control, answered once the control has.

use std::time::Duration;

use crossbeam_channel::{Receiver, Sender, bounded};
use opcua::types::{StatusCode, Variant, VariantScalarTypeId};
use serde::{Deserialize, Serialize, Serializer};
use tokio::sync::oneshot;

use crate::gateway::order_inbox::LONGEST_ORDER;

/// Most orders that wait for the control.
pub const MOST_WAITING: usize = 8;
/// Longest time until the control has answered.
const ANSWER_TIMEOUT: Duration = Duration::from_secs(5);

/// An order on its way to the control.
pub struct OrderCall {
    /// As JSON in one line.
    pub text: String,
    /// Takes the answer as JSON. Dropped: the control is gone.
    pub answer: oneshot::Sender<String>,
}

/// What became of an order.
#[derive(Debug, Deserialize)]
pub struct ProposalAnswer {
    /// The operator sees it.
    pub proposed: bool,
    /// Why not.
    pub why: Option<String>,
}

/// Where clients hand their orders in.
#[derive(Clone)]
pub struct OrderDesk(Sender<OrderCall>);

impl OrderDesk {
    /// A desk, and what comes from it.
    #[must_use]
    pub fn open() -> (Self, Receiver<OrderCall>) {
        let (calls, receiver) = bounded(MOST_WAITING);
        (Self(calls), receiver)
    }

    /// Hands an order in and waits for the answer.
    ///
    /// # Errors
    /// The order is too long, too many wait, or the control does not answer.
    pub async fn propose(&self, text: String) -> Result<ProposalAnswer, StatusCode> {
        if text.len() > LONGEST_ORDER {
            return Err(StatusCode::BadInvalidArgument);
        }
        let (answer, answered) = oneshot::channel();
        self.0.try_send(OrderCall { text, answer }).map_err(|_| StatusCode::BadTooManyOperations)?;
        let answered = tokio::time::timeout(ANSWER_TIMEOUT, answered).await.map_err(|_| StatusCode::BadTimeout)?;
        let answer = answered.map_err(|_| StatusCode::BadNoCommunication)?;
        serde_json::from_str(&answer).map_err(|_| StatusCode::BadUnexpectedError)
    }
}

/// The order of the arguments of a call as JSON: number, program, parts, variables and their values.
///
/// # Errors
/// The arguments are of other types, or there is not a value for each variable.
pub fn order_text(arguments: &[Variant]) -> Result<String, StatusCode> {
    let [Variant::UInt32(order), Variant::String(program), Variant::UInt32(parts), variables, values] = arguments
    else {
        return Err(StatusCode::BadInvalidArgument);
    };
    let variables = elements(variables, VariantScalarTypeId::String)?;
    let values = elements(values, VariantScalarTypeId::Double)?;
    if variables.len() != values.len() {
        return Err(StatusCode::BadInvalidArgument);
    }
    let mut pairs = Vec::new();
    for (name, value) in variables.iter().zip(values) {
        let (Variant::String(name), Variant::Double(value)) = (name, value) else {
            return Err(StatusCode::BadInvalidArgument);
        };
        pairs.push((name.as_ref(), *value));
    }
    let order = OrderText { order: *order, program: program.as_ref(), parts: *parts, values: pairs };
    serde_json::to_string(&order).map_err(|_| StatusCode::BadInvalidArgument)
}

/// An order as the control takes it. A variable that comes twice stands there twice: the control refuses it.
#[derive(Serialize)]
struct OrderText<'a> {
    order: u32,
    program: &'a str,
    parts: u32,
    #[serde(serialize_with = "as_map")]
    values: Vec<(&'a str, f64)>,
}

fn as_map<S: Serializer>(pairs: &[(&str, f64)], into: S) -> Result<S::Ok, S::Error> {
    into.collect_map(pairs.iter().copied())
}

/// The elements of an array; an empty one may come without a type.
fn elements(array: &Variant, of: VariantScalarTypeId) -> Result<&[Variant], StatusCode> {
    match array {
        Variant::Empty => Ok(&[]),
        Variant::Array(array) if array.value_type == of || array.values.is_empty() => Ok(&array.values),
        _ => Err(StatusCode::BadInvalidArgument),
    }
}
