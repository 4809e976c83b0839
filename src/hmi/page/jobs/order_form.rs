//! The form of an order, and below it what was made of it.

use std::ops::RangeInclusive;

use egui::{Rect, vec2};

use super::{figures, order_values, parts_of};
use crate::defs::production_order::{ORDER_NUMBERS, ORDER_TARGETS, ProductionOrder};
use crate::defs::text::{LocalizedText, Template, Text, phrase};
use crate::hmi::{Area, FieldEditor, ValueField, View, keycap, theme};
use crate::link::Snapshot;
use crate::link::production::{OrderCommand, OrderProposal};

/// A field of the form.
pub struct OrderField {
    /// Its name.
    pub name: Text,
    /// What may be typed.
    pub range: RangeInclusive<u32>,
}

/// The fields: number, program, parts.
pub const FIELDS: [OrderField; 3] = [
    OrderField { name: Text::new("订单号", "order"), range: ORDER_NUMBERS },
    OrderField { name: Text::new("程序", "program"), range: 1..=99_999_999 },
    OrderField { name: Text::new("件数", "parts"), range: ORDER_TARGETS },
];
/// A figure of the form is missing.
const TYPE_FIRST: &Template = &Template::new("先键入{name}", "type {name} first", &["name"]);
const NUMBER: usize = 0;
const PROGRAM: usize = 1;
const TARGET: usize = 2;
/// Height of a field, and of a line below.
const FIELD_HEIGHT: f32 = 50.0;
const LINE_HEIGHT: f32 = 26.0;

/// What the form holds: typed figures over those of the chosen order.
#[derive(Clone, Copy, Debug, Default)]
pub struct OrderEntry {
    chosen: Option<ProductionOrder>,
    typed: [Option<u32>; FIELDS.len()],
}

impl OrderEntry {
    /// Takes an order of the list.
    pub fn choose(&mut self, order: Option<&ProductionOrder>) {
        *self = Self { chosen: order.copied(), typed: [None; FIELDS.len()] };
    }

    /// The number of the order that keys act on.
    pub fn chosen(&self) -> Option<u32> {
        self.typed[NUMBER].or(self.chosen.map(|order| order.number))
    }

    /// Program or parts are typed and not entered.
    pub const fn is_changed(&self) -> bool {
        self.typed[PROGRAM].is_some() || self.typed[TARGET].is_some()
    }

    /// The typed figures are in the list now.
    pub fn forget_typed(&mut self) {
        self.typed = [self.chosen(), None, None];
    }

    /// Takes a typed figure. The number of a known order chooses it.
    ///
    /// # Errors
    /// It is out of range.
    pub fn take(&mut self, field: usize, text: &str, snapshot: &Snapshot) -> Result<(), LocalizedText> {
        let range = &FIELDS[field].range;
        let value = text.parse::<u32>().ok().filter(|value| range.contains(value)).ok_or_else(|| {
            let (least, most) = (*range.start(), *range.end());
            phrase!("应为 {least}–{most}", "must be {least} to {most}", least, most)
        })?;
        if field == NUMBER {
            self.choose(snapshot.production.order(value));
        }
        self.typed[field] = Some(value);
        Ok(())
    }

    /// The figure of a field: typed, of the order in the list, else the current program unless it dresses.
    fn value(&self, field: usize, snapshot: &Snapshot) -> Option<u32> {
        let order = self.chosen().and_then(|number| snapshot.production.order(number));
        let dresses = |number: &u32| snapshot.dressing_programs().contains(number);
        let current = Some(snapshot.program.number).filter(|number| *number > 0 && !dresses(number));
        self.typed[field].or(match field {
            NUMBER => self.chosen(),
            PROGRAM => order.map(|order| order.program).or(current),
            _ => order.map(|order| order.target),
        })
    }

    /// What enters the form into the list.
    ///
    /// # Errors
    /// A figure is missing.
    pub fn command(&self, snapshot: &Snapshot) -> Result<OrderCommand, LocalizedText> {
        let [number, program, target] = [NUMBER, PROGRAM, TARGET].map(|field| {
            self.value(field, snapshot).ok_or_else(|| {
                let name = FIELDS[field].name;
                LocalizedText::phrase_of(TYPE_FIRST, [], [name.into()])
            })
        });
        let (number, program, target) = (number?, program?, target?);
        let values = snapshot.production.order(number).map(|order| order.values).unwrap_or_default();
        Ok(OrderCommand::Enter(OrderProposal { number, program, target, values }))
    }
}

/// Draws form and figures; returns the field that is touched.
pub fn ui(rect: Rect, view: &View<'_>, entry: &OrderEntry, typing: (usize, &FieldEditor)) -> Option<usize> {
    view.card(rect);
    let inside = rect.shrink(theme::PAD);
    let mut touched = None;
    for index in 0..FIELDS.len() {
        let place = inside.band(index as f32 * FIELD_HEIGHT, FIELD_HEIGHT - theme::GAP);
        if field(place, view, entry, (index, typing)) {
            touched = Some(index);
        }
    }
    made(inside.trim_top(FIELDS.len() as f32 * FIELD_HEIGHT + theme::GAP), view, entry);
    touched
}

/// One field; true if it was touched.
fn field(
    rect: Rect,
    view: &View<'_>,
    entry: &OrderEntry,
    (index, (cursor, typing)): (usize, (usize, &FieldEditor)),
) -> bool {
    let name = FIELDS[index].name;
    let response = keycap::plain(view, rect, ("job-field", index), format!("job field {}", index + 1));
    let (label, value) = rect.shrink2(vec2(theme::PAD, 0.0)).split_left_right_at_fraction(0.42);
    view.fit_left(label, name.get(view.lang), theme::LABEL, view.theme.muted);
    let words = entry.value(index, view.snapshot).map_or_else(
        || "–".to_owned(),
        // A program may have a name.
        |value| if index == PROGRAM { view.snapshot.title(value) } else { value.to_string() },
    );
    let shown = ValueField { plate: rect, value, size: theme::TITLE, words, ink: view.theme.text };
    FieldEditor::paint((cursor == index).then_some(typing), view, shown);
    response.clicked()
}

/// What was made of the chosen order.
fn made(rect: Rect, view: &View<'_>, entry: &OrderEntry) {
    let order = entry.chosen().and_then(|number| view.snapshot.production.order(number));
    let Some(order) = order else { return };
    let parts: Vec<_> = parts_of(view.snapshot, order).collect();
    let values = order_values::lines(view, order).into_iter();
    let figures = figures::figures(view.lang, order, &parts).into_iter().map(|(name, value)| (name.to_owned(), value));
    let all: Vec<_> = values.chain(figures).collect();
    let room = (rect.height() / LINE_HEIGHT) as usize;
    for (index, (name, value)) in all.iter().enumerate() {
        let line = rect.band(index as f32 * LINE_HEIGHT, LINE_HEIGHT);
        if all.len() > room && index + 1 >= room {
            view.line_right(line, &format!("… +{}", all.len() - index), theme::LABEL, view.theme.muted);
            break;
        }
        let shown = view.line_right(line, value, theme::LABEL, view.theme.text);
        view.fit_left(line.with_max_x(shown.min.x - theme::GAP), name, theme::LABEL, view.theme.muted);
    }
}
