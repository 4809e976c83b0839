//! Plays stories again and again on a control on its thread; a touch of the screen stops them for a while.
//! Source: spec T2; issue "the face", part 9.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::thread::Scope;

use crossbeam_channel::{Receiver, Sender, TryRecvError, bounded};

use super::args::SharedArgs;
use super::play::StoryFile;
use super::{CallError, setup};
use crate::host::Host;
use crate::host::simulated::HostedSimulation;
use crate::host::storage::{Storage, ThreadedStorage};
use crate::host::thread::HostThread;
use crate::link::demo_view::DemoView;
use crate::link::snapshot::RunState;
use crate::story::{Stage, StoryLine};
use crate::units::Micros;

/// Without input for this time the film starts again.
const IDLE: Micros = Micros::from_millis(60_000);
/// Pause between two runs of a single story.
const PAUSE: Micros = Micros::from_millis(5_000);

/// A simulated control on a thread.
type DemoThread = HostThread<HostedSimulation, ThreadedStorage>;
type DemoHost = Host<HostedSimulation, ThreadedStorage>;

/// What is played: one story, again and again on the same control, or several, each on a machine of its own.
pub struct Film {
    /// The call; the kind is that of the story.
    pub shared: SharedArgs,
    /// The stories, at least one.
    pub stories: Vec<StoryFile>,
}

impl Film {
    /// The call for the machine of a story.
    pub fn call_for(&self, story: &StoryFile) -> SharedArgs {
        SharedArgs { kind: story.kind, ..self.shared.clone() }
    }

    /// A new machine for a story, prepared as the story wants it.
    fn prepared_host(&self, story: &StoryFile) -> Result<DemoHost, CallError> {
        let mut host = setup::threaded_host(&self.call_for(story), false, setup::simulated_for_display)?;
        prepare(&mut host, &self.shared, story);
        Ok(host)
    }
}

/// Prepares machines on a thread that lives as long as the film: the memory that a preparation needs for a moment stays
/// with the thread, and the next one takes it again.
struct Preparer {
    asked: Sender<usize>,
    prepared: Receiver<Result<DemoHost, CallError>>,
}

impl Preparer {
    fn spawn<'scope>(scope: &'scope Scope<'scope, '_>, film: &'scope Film) -> Self {
        let (asked, orders) = bounded::<usize>(1);
        let (finished, prepared) = bounded(1);
        scope.spawn(move || {
            let stories = orders.iter().filter_map(|index| film.stories.get(index));
            let prepare = |story| catch_unwind(AssertUnwindSafe(|| film.prepared_host(story)));
            let told = |_| Err(CallError::new("the machine of the next story could not be prepared"));
            for story in stories {
                if finished.send(prepare(story).unwrap_or_else(told)).is_err() {
                    return;
                }
            }
        });
        Self { asked, prepared }
    }
}

/// Plays until the thread is stopped. The thread begins with a machine of the first story.
pub fn repeat(thread: &mut DemoThread, film: &Film) {
    std::thread::scope(|scope| play_all(thread, film, &Preparer::spawn(scope, film)));
}

fn play_all(thread: &mut DemoThread, film: &Film, preparer: &Preparer) {
    let (mut next, mut has_played) = (0, false);
    while !thread.is_stopped() {
        let Some(story) = film.stories.get(next) else { return };
        thread.take_touched();
        let is_ready = if has_played && film.stories.len() > 1 {
            change_machine(thread, next, preparer)
        } else {
            thread.host().power_on();
            prepare(thread.host(), &film.shared, story);
            true
        };
        if is_ready {
            play(thread, film, story);
        }
        has_played = true;
        next = (next + 1) % film.stories.len();
        if film.stories.len() == 1 {
            pause(thread);
        }
        if thread.is_touched() {
            wait_until_left_alone(thread);
            next = 0;
        }
    }
}

/// Puts a machine prepared for the next story in the place of this one, which goes on meanwhile. Whoever touches it
/// keeps it. Whether it is there.
fn change_machine(thread: &mut DemoThread, story: usize, preparer: &Preparer) -> bool {
    let mut prepared = Err(TryRecvError::Disconnected);
    if preparer.asked.send(story).is_ok() {
        prepared = preparer.prepared.try_recv();
        while matches!(prepared, Err(TryRecvError::Empty)) && !thread.is_stopped() {
            thread.turn();
            prepared = preparer.prepared.try_recv();
        }
    }
    match prepared {
        _ if thread.is_touched() => return false,
        Ok(Ok(host)) => {
            thread.exchange(host);
            return true;
        }
        Ok(Err(why)) => warn_line!("kt830: {why}"),
        // The film ends.
        Err(_) => {}
    }
    // The one that is there stays in sight for a moment.
    pause(thread);
    false
}

/// Plays what spectators see of a story; a touch ends it.
fn play(thread: &mut DemoThread, film: &Film, story: &StoryFile) {
    let mut player = story.player(thread, film.shared.lang, false);
    for line in story.acts().1 {
        if player.stage().is_interrupted() {
            return;
        }
        let done = player.play(line);
        if !player.stage().is_interrupted() {
            tell_failure(line, done);
        }
    }
}

/// Shows the end of a story for a moment.
fn pause(thread: &mut DemoThread) {
    let since = thread.host().now();
    while !thread.is_stopped() && !thread.is_touched() && thread.host().now().since(since) <= PAUSE {
        thread.turn();
    }
}

/// Somebody has the machine: waits until there was no input for a while and no program runs.
fn wait_until_left_alone(thread: &mut DemoThread) {
    let mut quiet_since = thread.host().now();
    while !thread.is_stopped() {
        thread.turn();
        let now = thread.host().now();
        if thread.take_touched() || thread.host().controller().state() == RunState::Running {
            quiet_since = now;
        }
        let quiet = now.since(quiet_since);
        if quiet > IDLE {
            break;
        }
        let seconds = |time: Micros| time.as_secs_f64().ceil() as u32;
        let view = DemoView::TakenOver { seconds_left: seconds(IDLE.since(quiet)), of: seconds(IDLE) };
        thread.host().show_demo(view);
    }
    thread.host().show_demo(DemoView::Silent);
}

/// Plays what comes before the demonstration: unseen, and as fast as the computer can.
pub fn prepare<S: Storage>(host: &mut Host<HostedSimulation, S>, shared: &SharedArgs, story: &StoryFile) {
    let mut stage = Preparation(host);
    let mut player = story.player(&mut stage, shared.lang, false);
    story.acts().0.iter().for_each(|line| tell_failure(line, player.play(line)));
}

/// A demonstration goes on: what fails is told to whoever wrote the story.
fn tell_failure(line: &StoryLine, done: Result<(), String>) {
    if let Err(why) = done {
        warn_line!("FAIL  line {}, {}: {why}", line.number, line.text);
    }
}

/// A machine that is prepared: without a clock, but for what its storage reads.
struct Preparation<'a, S>(&'a mut Host<HostedSimulation, S>);

impl<S: Storage> Stage for Preparation<'_, S> {
    type Machine = HostedSimulation;
    type Storage = S;

    fn host(&mut self) -> &mut Host<HostedSimulation, S> {
        self.0
    }

    fn step(&mut self) {
        if self.0.awaits_part() {
            std::thread::sleep(std::time::Duration::from_micros(self.0.tick_time().0));
        }
        self.0.step();
    }

    fn power_cut(&mut self) {
        self.0.power_cut();
    }

    fn power_on(&mut self) {
        self.0.power_on();
    }

    fn is_interrupted(&self) -> bool {
        false
    }
}
