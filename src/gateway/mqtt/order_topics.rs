//! Orders of the shop by MQTT: a topic that is asked for with P485 alone, and the list that the broker keeps.

use std::sync::PoisonError;
use std::time::Duration;

use crate::gateway::order_inbox::{self, SharedInbox};
use crate::link::snapshot::Snapshot;

/// Orders that come, and the list that the broker has.
#[derive(Default)]
pub struct OrderTopics {
    inbox: SharedInbox,
    /// Empty if the broker has none; `None` if nobody knows what it has.
    told: Option<String>,
    /// Whether the broker sends orders in this connection.
    is_subscribed: bool,
}

impl OrderTopics {
    /// Orders to a control.
    #[must_use]
    pub fn new(inbox: SharedInbox) -> Self {
        Self { inbox, told: None, is_subscribed: false }
    }

    /// Whether orders are to be asked for now, once in a connection.
    pub fn begins(&mut self, snapshot: &Snapshot) -> bool {
        let is_wanted = order_inbox::takes_orders(snapshot);
        is_wanted && !std::mem::replace(&mut self.is_subscribed, is_wanted)
    }

    /// Takes an order; the answer to it. One that the broker has kept may be old, and comes again with each connection.
    #[must_use]
    pub fn take(&mut self, now: Duration, (payload, is_retained): (&[u8], bool), snapshot: &Snapshot) -> String {
        if is_retained {
            return order_inbox::answer(None, Err("an order must not be retained".to_owned()));
        }
        self.inbox.lock().unwrap_or_else(PoisonError::into_inner).take(now, payload, snapshot)
    }

    /// The list of orders as JSON, if the broker has another one. Without P485 it is to keep none: an empty text.
    #[must_use]
    pub fn changed_list(&mut self, snapshot: &Snapshot) -> Option<String> {
        let list = if order_inbox::takes_orders(snapshot) { order_inbox::list(snapshot) } else { String::new() };
        if self.told.as_ref() == Some(&list) {
            return None;
        }
        self.told = Some(list.clone());
        Some(list)
    }

    /// The connection is over: the next one is told the list.
    pub fn connection_lost(&mut self) {
        (self.told, self.is_subscribed) = (None, false);
    }
}
