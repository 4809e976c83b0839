//! What a panel key does, over the foot of the page: the answer to a long touch, which does not press the key.
//! Source: spec H9.

use egui::{Event, Id, Rect, Sense};

use super::{Area, View, theme};
use crate::defs::key::Key;

/// How long it stays, s.
const SECONDS: f64 = 8.0;
/// Height of the card, and of its title, points.
const HEIGHT: f32 = 116.0;
const TITLE_HEIGHT: f32 = 30.0;

/// The key that is explained, and since when, s of the screen.
#[derive(Debug, Default)]
pub struct Explanation {
    shown: Option<(Key, f64)>,
}

impl Explanation {
    /// Explains a key.
    pub fn show(&mut self, view: &View<'_>, key: Key) {
        self.shown = Some((key, view.ui.input(|input| input.time)));
        view.ui.ctx().request_repaint_after(std::time::Duration::from_secs_f64(SECONDS + 0.05));
    }

    /// Draws the card, until its time is over or the next touch or key.
    pub fn ui(&mut self, view: &View<'_>, page: Rect) {
        let (now, touched) = view.ui.input(|input| {
            let key = input.events.iter().any(|event| matches!(event, Event::Key { pressed: true, .. }));
            (input.time, key || input.pointer.any_pressed())
        });
        self.shown.take_if(|(_, since)| now - *since >= SECONDS || touched && now > *since);
        let Some((key, _)) = self.shown else { return };
        let card = page.split_bottom(HEIGHT).1.shrink(theme::GAP);
        view.ui.interact(card, Id::unique("explanation"), Sense::CLICK | Sense::DRAG);
        view.filled_card(card, view.theme.surface, view.theme.hold);
        let (title, body) = card.shrink(theme::PAD).split_top(TITLE_HEIGHT);
        let label = key.label_on(view.snapshot.kind).get(view.lang);
        let words = format!("{label} · {}", view.text("没有按下：短按才执行", "not pressed: a short touch does it"));
        view.fit_left(title, &words, theme::TITLE, view.theme.hold);
        view.paragraph(body, key.row().help.get(view.lang), theme::LABEL, view.theme.text);
    }
}
