//! Plays a story again and again on a control on its thread; a touch of the screen stops it for a while.

use super::play::StoryFile;
use crate::host::simulated::HostedSimulation;
use crate::host::storage::ThreadedStorage;
use crate::host::thread::HostThread;
use crate::link::demo_view::DemoView;
use crate::link::snapshot::RunState;
use crate::story::{Player, Stage};
use crate::units::Micros;

/// Without input for this time the story starts again.
const IDLE: Micros = Micros::from_millis(60_000);
/// Pause between two runs of the story.
const PAUSE: Micros = Micros::from_millis(5_000);

/// Plays until the thread is stopped.
pub fn repeat(thread: &mut HostThread<HostedSimulation, ThreadedStorage>, told: &StoryFile) {
    while !thread.is_stopped() {
        play_once(thread, told);
    }
}

/// The time that is left until the story goes on, in seconds that are begun.
fn taken_over(left: Micros) -> DemoView {
    let seconds = |time: Micros| time.as_secs_f64().ceil() as u32;
    DemoView::TakenOver { seconds_left: seconds(left), of: seconds(IDLE) }
}

/// Plays the story once. A touch stops it; then this waits until there is no input.
fn play_once(thread: &mut HostThread<HostedSimulation, ThreadedStorage>, told: &StoryFile) {
    thread.host().power_on();
    thread.take_touched();
    let mut player = Player::new(thread, None, &told.folder, false);
    for line in &told.lines {
        if player.stage().is_interrupted() {
            break;
        }
        // A demo goes on: what fails is told to whoever wrote the story.
        if let Err(why) = player.play(line)
            && !player.stage().is_interrupted()
        {
            warn_line!("FAIL  line {}, {}: {why}", line.number, line.text);
        }
    }
    drop(player);
    let mut is_taken_over = thread.is_touched();
    let mut quiet_since = thread.host().now();
    while !thread.is_stopped() {
        thread.turn();
        let now = thread.host().now();
        let is_touched = thread.take_touched();
        is_taken_over |= is_touched;
        if is_touched || thread.host().controller().state() == RunState::Running {
            quiet_since = now;
        }
        let quiet = if is_taken_over { IDLE } else { PAUSE };
        if is_taken_over {
            thread.host().show_demo(taken_over(quiet.since(now.since(quiet_since))));
        }
        if now.since(quiet_since) > quiet {
            thread.host().show_demo(DemoView::Silent);
            return;
        }
    }
}
