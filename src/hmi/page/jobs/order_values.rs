//! The values that an order of the shop asks for, beside those of the page.

use crate::defs::production_order::{OrderState, OrderValue, ProductionOrder};
use crate::defs::text::{Lang, LocalizedText, Text};
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
    order.values.iter().map(|value| line(view, order, value, view.lang)).collect()
}

fn line(view: &View<'_>, order: &ProductionOrder, value: OrderValue, lang: Lang) -> (String, String) {
    let row = view.snapshot.screens.row(view.snapshot.kind, order.program, value.variable);
    let label = row.map_or("", |row| row.label_in(lang));
    let (now, asked) = (now(view, value), Some(value.number));
    let shown = if now == asked { words(asked) } else { format!("{} → {}", words(now), words(asked)) };
    (format!("{} {label}", view.variable_name(value.variable)), shown)
}

/// What is asked before an order with other values than the page is started; none if it has no others, or cannot be started.
pub fn question(view: &View<'_>, order: &ProductionOrder) -> Option<Question> {
    let others: Vec<OrderValue> = order.values.iter().filter(|value| now(view, *value) != Some(value.number)).collect();
    if others.is_empty() || order.state == OrderState::Proposed {
        return None;
    }
    let changes = |lang: Lang| {
        let words = others.iter().map(|value| line(view, order, *value, lang));
        words.map(|(name, change)| format!("{name}: {change}")).collect::<Vec<_>>().join("\n")
    };
    let number = order.number;
    let body = LocalizedText::new(
        format!("订单 {number}\n{}", changes(Lang::Zh)),
        format!("Order {number}\n{}", changes(Lang::En)),
    );
    let keys = [("question-take", Text::new("采用", "TAKE")), ("question-keep", Text::new("保留现值", "KEEP"))];
    let title = Text::new("采用订单的数值？", "take the values of the order?");
    Some(Question::with_keys(title, body, &keys).with_lines(others.len() + 1))
}
