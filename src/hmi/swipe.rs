//! A swipe to the side over the page: the next page of its row of soft keys, or the one before. Source: spec H9.
//!
//! It is no press: what lies beneath is not touched. Where a drag moves something sideways (curves, drawings, the text of
//! an editor, dialogs) there is no swipe.

use egui::{Context, Id, Pos2, Rect, Ui};

/// Shortest way to the side, as a share of the width of the page.
const SHORTEST: f32 = 0.2;
/// Steepest swipe: way up or down over the way to the side.
const STEEPEST: f32 = 0.4;
/// Way after which egui knows what is dragged, points.
const LEAST_MOVE: f32 = 20.0;
/// Longest time, s: what takes longer is a finger that rests or scrolls.
const LONGEST_S: f64 = 0.6;

/// Where a swipe leads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SwipeTurn {
    /// To the left: the next page.
    Next,
    /// To the right: the page before.
    Previous,
}

/// The finger that may become a swipe.
#[derive(Debug, Default)]
pub struct Swipe {
    /// Where and when it came down on the page.
    begun: Option<(Pos2, f64)>,
    /// It has moved while nothing beneath it moved along.
    moved: bool,
}

impl Swipe {
    /// Forgets the finger: another page has come under it.
    pub const fn forget(&mut self) {
        self.begun = None;
    }

    /// Follows the finger over the page; where a swipe that has ended in this frame leads.
    pub fn follow(&mut self, ui: &Ui, page: Rect) -> Option<SwipeTurn> {
        let (time, down, up, at, fingers) = ui.input(|input| {
            let pointer = &input.pointer;
            let at = super::key_press::release_position(input).or(pointer.interact_pos());
            (input.time, pointer.primary_pressed(), pointer.primary_released(), at, input.multi_touch().is_some())
        });
        if down {
            self.begun = at.filter(|at| page.contains(*at)).map(|at| (at, time));
            self.moved = false;
        }
        if fingers || !is_free(ui.ctx()) {
            self.begun = None;
        }
        if !up {
            // What is dragged is known a frame after the finger has moved: a flick within one frame is no swipe.
            let far = |(from, _): (Pos2, f64)| at.is_some_and(|at| (at - from).x.abs() > LEAST_MOVE);
            self.moved |= !down && self.begun.is_some_and(far);
            return None;
        }
        let (from, since) = self.begun.take().filter(|_| self.moved)?;
        let way = at? - from;
        let counts = way.x.abs() >= SHORTEST * page.width()
            && way.y.abs() <= STEEPEST * way.x.abs()
            && time - since <= LONGEST_S;
        counts.then_some(if way.x < 0.0 { SwipeTurn::Next } else { SwipeTurn::Previous })
    }
}

fn list_id() -> Id {
    Id::unique("list under the finger")
}

/// A list that a drag moves up and down: a swipe over it counts.
pub fn allow_over(ctx: &Context, list: Id) {
    ctx.data_mut(|data| data.insert_temp(list_id(), list));
}

/// A list whose drag moves its text sideways.
pub fn refuse_over(ctx: &Context) {
    ctx.data_mut(|data| data.insert_temp(list_id(), Id::NULL));
}

/// Whether the finger moves nothing sideways.
fn is_free(ctx: &Context) -> bool {
    let list = ctx.data(|data| data.get_temp::<Id>(list_id()));
    ctx.dragged_id().is_none_or(|dragged| Some(dragged) == list)
}
