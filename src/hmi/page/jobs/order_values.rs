//! The values that an order of the shop asks for, beside those of the page.

use crate::defs::production_order::{OrderState, OrderValue, ProductionOrder};
use crate::defs::text::{LocalizedText, Text};
use crate::hmi::{Question, View};

/// The value of the page now.
fn now(view: &View<'_>, value: OrderValue) -> Option<f64> {
    view.snapshot.variables.get(usize::from(value.variable)).copied().flatten()
}

fn words(number: Option<f64>) -> String {
    number.map_or_else(|| "–".to_owned(), |number| format!("{number:.3}"))
}

/// A line for each value: its label, what it is now and what the order asks for.
pub fn lines(view: &View<'_>, order: &ProductionOrder) -> Vec<(String, String)> {
    let screens = &view.snapshot.screens;
    let line = |value: OrderValue| {
        let row = screens.row(view.snapshot.kind, order.program, value.variable);
        let name = view.variable_name(value.variable);
        let label = row.map_or("", |row| row.label_in(view.lang));
        let (now, asked) = (now(view, value), Some(value.number));
        let shown = if now == asked { words(asked) } else { format!("{} → {}", words(now), words(asked)) };
        (format!("{name} {label}"), shown)
    };
    order.values.iter().map(line).collect()
}

/// What is asked before an order with other values than the page is started; none if it has no others, or cannot be started.
pub fn question(view: &View<'_>, order: &ProductionOrder) -> Option<Question> {
    let others: Vec<OrderValue> = order.values.iter().filter(|value| now(view, *value) != Some(value.number)).collect();
    if others.is_empty() || order.state == OrderState::Proposed {
        return None;
    }
    let change = |value: &OrderValue| {
        let name = view.variable_name(value.variable);
        format!("{name}: {} → {}", words(now(view, *value)), words(Some(value.number)))
    };
    let (number, changes) = (order.number, others.iter().map(change).collect::<Vec<_>>().join("   "));
    let body = LocalizedText::new(format!("订单 {number}：{changes}"), format!("Order {number}: {changes}"));
    let keys = [("question-take", Text::new("采用", "TAKE")), ("question-keep", Text::new("保留现值", "KEEP"))];
    Some(Question::with_keys(Text::new("采用订单的数值？", "take the values of the order?"), body, &keys))
}
