//! The finger that moves the pointer: from its touch until it is lifted, and never longer. A finger that is lifted while
//! another window lies over it, or whose window loses the focus, has let go: no key stays pressed without a finger.
//! Source: spec H9, K2; safety stance.
//!
//! egui-winit makes a pointer of the first finger, too, but loses its release where the pointer has left the window before.
//! What it makes of touches is replaced here.

use std::iter::Peekable;
use std::vec::IntoIter;

use egui::{Event, InputState, Modifiers, PointerButton, Pos2, TouchDeviceId, TouchId, TouchPhase, pos2};

/// A place beside the screen: a finger that lets go there presses nothing.
const BESIDE: Pos2 = pos2(-10_000.0, -10_000.0);
/// How near two positions of one touch are, points.
const SAME_PLACE: f32 = 0.5;

/// The finger that moves the pointer, while it is down.
#[derive(Debug, Default)]
pub struct PointerFinger {
    finger: Option<(TouchDeviceId, TouchId)>,
}

impl PointerFinger {
    /// Replaces the pointer events that belong to touches.
    pub fn translate(&mut self, events: &mut Vec<Event>) {
        let mut rest = std::mem::take(events).into_iter().peekable();
        while let Some(event) = rest.next() {
            let touch = match &event {
                Event::Touch { device_id, id, phase, pos, .. } => Some(((*device_id, *id), *phase, *pos)),
                _ => None,
            };
            let lets_go = matches!(event, Event::WindowFocused(false) | Event::PointerGone);
            events.push(event);
            if let Some((finger, phase, pos)) = touch {
                skip_emulated(&mut rest, phase, pos);
                self.follow(finger, phase, pos, events);
            } else if lets_go {
                self.let_go(events);
            }
        }
    }

    fn follow(&mut self, finger: (TouchDeviceId, TouchId), phase: TouchPhase, pos: Pos2, events: &mut Vec<Event>) {
        match phase {
            TouchPhase::Start if self.finger.is_none() => {
                self.finger = Some(finger);
                events.extend([Event::PointerMoved(pos), button(pos, true)]);
            }
            _ if self.finger != Some(finger) => {}
            TouchPhase::Start => {}
            TouchPhase::Move => events.push(Event::PointerMoved(pos)),
            TouchPhase::End => {
                self.finger = None;
                events.extend([button(pos, false), Event::PointerGone]);
            }
            TouchPhase::Cancel => self.let_go(events),
        }
    }

    /// The pointer lets go, wherever the finger is; it counts again with its next touch.
    fn let_go(&mut self, events: &mut Vec<Event>) {
        if self.finger.take().is_some() {
            events.extend([Event::PointerMoved(BESIDE), button(BESIDE, false), Event::PointerGone]);
        }
    }
}

const fn button(pos: Pos2, pressed: bool) -> Event {
    Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers: Modifiers::NONE }
}

/// Leaves out what egui-winit makes of a touch: it follows the touch at once.
fn skip_emulated(rest: &mut Peekable<IntoIter<Event>>, phase: TouchPhase, at: Pos2) {
    let is_here = |pos: Pos2| pos.distance(at) < SAME_PLACE;
    let is_emulated = |event: &Event| match (phase, event) {
        (TouchPhase::Start | TouchPhase::Move, Event::PointerMoved(pos)) => is_here(*pos),
        (TouchPhase::Start, Event::PointerButton { pos, pressed: true, .. }) => is_here(*pos),
        (TouchPhase::End, Event::PointerButton { pressed: false, .. } | Event::PointerGone)
        | (TouchPhase::Cancel, Event::PointerGone) => true,
        _ => false,
    };
    while rest.next_if(is_emulated).is_some() {}
}

/// Where fingers have touched in this frame that do not move the pointer, because another one does.
pub fn second_touches(input: &InputState) -> impl Iterator<Item = Pos2> {
    input.events.iter().enumerate().filter_map(|(index, event)| match event {
        Event::Touch { phase: TouchPhase::Start, pos, .. } => {
            let moves_pointer = matches!(input.events.get(index + 2), Some(Event::PointerButton { pressed: true, .. }));
            (!moves_pointer).then_some(*pos)
        }
        _ => None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn touch(id: u64, phase: TouchPhase, pos: Pos2) -> Event {
        Event::Touch { device_id: TouchDeviceId(1), id: TouchId(id), phase, pos, force: None }
    }

    const HERE: Pos2 = pos2(10.0, 20.0);
    const THERE: Pos2 = pos2(30.0, 40.0);

    fn translated(finger: &mut PointerFinger, events: &[Event]) -> Vec<Event> {
        let mut events = events.to_vec();
        finger.translate(&mut events);
        events.retain(|event| !matches!(event, Event::Touch { .. }));
        events
    }

    #[test]
    fn h9_a_finger_is_the_pointer_with_and_without_the_events_of_the_window_system() {
        use TouchPhase::{End, Move, Start};
        let bare = [touch(1, Start, HERE), touch(1, Move, THERE), touch(1, End, THERE)];
        let doubled = [
            touch(1, Start, HERE),
            Event::PointerMoved(HERE),
            button(HERE, true),
            touch(1, Move, THERE),
            Event::PointerMoved(THERE),
            touch(1, End, THERE),
            button(THERE, false),
            Event::PointerGone,
        ];
        let wanted = [
            Event::PointerMoved(HERE),
            button(HERE, true),
            Event::PointerMoved(THERE),
            button(THERE, false),
            Event::PointerGone,
        ];
        for events in [&bare[..], &doubled] {
            assert_eq!(translated(&mut PointerFinger::default(), events), wanted);
        }
    }

    #[test]
    fn h9_a_finger_that_is_lost_lets_go_and_the_next_one_counts() {
        use TouchPhase::{Cancel, End, Move, Start};
        let beside = [Event::PointerMoved(BESIDE), button(BESIDE, false), Event::PointerGone];
        // The window has lost the focus, the pointer has left it, the touch is cancelled.
        for (lost, kept) in [(Event::WindowFocused(false), 1), (Event::PointerGone, 1), (touch(1, Cancel, HERE), 0)] {
            let mut finger = PointerFinger::default();
            translated(&mut finger, &[touch(1, Start, HERE)]);
            assert_eq!(translated(&mut finger, &[lost])[kept..], beside);
            // What is left of this finger presses and releases nothing; the next one does.
            assert_eq!(translated(&mut finger, &[touch(1, Move, THERE), touch(1, End, THERE)]), []);
            let next = translated(&mut finger, &[touch(2, Start, THERE)]);
            assert_eq!(next, [Event::PointerMoved(THERE), button(THERE, true)]);
        }
    }

    #[test]
    fn h9_a_second_finger_is_no_pointer() {
        use TouchPhase::{End, Move, Start};
        let mut finger = PointerFinger::default();
        translated(&mut finger, &[touch(1, Start, HERE)]);
        let second = [touch(2, Start, THERE), touch(2, Move, HERE), touch(2, End, HERE)];
        assert_eq!(translated(&mut finger, &second), []);
        // A mouse beside it is not touched.
        assert_eq!(translated(&mut finger, &[Event::PointerMoved(THERE)]), [Event::PointerMoved(THERE)]);
        assert_eq!(translated(&mut finger, &[touch(1, End, HERE)]), [button(HERE, false), Event::PointerGone]);
    }
}
