//! The window paints only when something shown has changed: every field of a snapshot counts on the pages that show it.
//! Source: spec H5, H8.

use std::sync::{Arc, Mutex};

use crate::sample::{busy, snapshot};
use egui::{Context, RawInput};
use kt830::defs::alarm_history::AlarmHistory;
use kt830::defs::date::DateTime;
use kt830::defs::key::{Key, Mode};
use kt830::defs::kind::Kind;
use kt830::defs::leadscrew::{LeadscrewCompensation, LeadscrewPoint};
use kt830::defs::page::Page;
use kt830::defs::param::AccessLevel;
use kt830::defs::param::Params;
use kt830::defs::part_record::PartHistory;
use kt830::defs::signal::{Input, Output};
use kt830::defs::soft_key::CoordinateView;
use kt830::defs::start_step::StartStep;
use kt830::defs::text::{Lang, LocalizedText};
use kt830::hmi::Hmi;
use kt830::hmi::offscreen::OffscreenHmi;
use kt830::hmi::repaint::{FIELDS, LiveScreen, changed_field};
use kt830::link::demo_view::DemoView;
use kt830::link::files::FileRequest;
use kt830::link::internal_signal::InternalSignal;
use kt830::link::page_command::{KeptState, PageCommand};
use kt830::link::restart_view::RestartView;
use kt830::link::scope::ScopeState;
use kt830::link::simulation::SimView;
use kt830::link::snapshot::{OwnMotion, RunState};
use kt830::link::start_guide::StepState;
use kt830::link::{Command, Snapshot};
use kt830::units::{Axis, Micros, PerAxis};

type Change = (&'static str, Page, fn(&mut Snapshot));

/// Either side of the terminals is shown on the diagnosis page, and nowhere else.
#[test]
fn h8_terminals_of_either_side_are_painted() {
    for change in [
        |machine: &mut Snapshot| machine.terminals.inputs.set(3, true),
        |machine: &mut Snapshot| {
            machine.terminals.outputs.set(3, true);
        },
    ] {
        for (page, shown) in [(Page::Diagnosis, Some("terminals")), (Page::Mdi, None)] {
            let painted = snapshot(page);
            let mut newest = painted.clone();
            change(&mut newest);
            assert_eq!(changed_field(&painted, &newest), shown);
        }
    }
}

/// For every field: a page that shows it, and a change of it. Lengths change by the last digit shown.
const CHANGES: &[Change] = &[
    ("page", Page::Mdi, |machine| machine.page = Page::Offset),
    ("kind", Page::Mdi, |machine| machine.kind = Kind::Ga),
    ("now", Page::Mdi, |machine| machine.now.0 += 1_000_000),
    ("date", Page::Mdi, |machine| machine.date = Some(DateTime(1_795_273_316))),
    ("mode", Page::Mdi, |machine| machine.mode = Mode::Home),
    ("state", Page::Mdi, |machine| machine.state = RunState::Held),
    ("own_motion", Page::Position, |machine| machine.own_motion = Some(OwnMotion::DressReturn)),
    ("coordinates", Page::Position, |machine| machine.coordinates = CoordinateView::Relative),
    ("soft_key_row", Page::Mdi, |machine| machine.soft_key_row += 1),
    ("x_as_diameter", Page::Offset, |machine| machine.x_as_diameter = false),
    ("axes", Page::Position, |machine| machine.axes[Axis::Z].to_go += 0.001),
    ("program", Page::Program, |machine| machine.program.line += 1),
    ("handwheel", Page::Teach, |machine| machine.handwheel.step_mm = 0.1),
    ("overrides", Page::Mdi, |machine| machine.overrides.feed += 10),
    ("feed_mm_min", Page::Mdi, |machine| machine.feed_mm_min += 1.0),
    ("wheel_rpm", Page::Mdi, |machine| machine.wheel_rpm += 1.0),
    ("tool_station", Page::Position, |machine| machine.tool_station = Some(2)),
    ("teach", Page::Teach, |machine| machine.teach.recording = true),
    ("strokes_per_min", Page::Position, |machine| machine.strokes_per_min = Some(12.5)),
    ("is_storing", Page::Mdi, |machine| machine.is_storing = true),
    ("parts_counted", Page::Mdi, |machine| machine.parts_counted += 1),
    ("cycle", Page::Grinding, |machine| machine.cycle.part = Some(crate::sample::part_result())),
    ("inputs", Page::Diagnosis, |machine| machine.inputs.set(Input::Gauge1, true)),
    ("outputs", Page::Diagnosis, |machine| machine.outputs.set(Output::Coolant, true)),
    ("keys", Page::Mdi, |machine| machine.keys[Key::Coolant as usize].lamp ^= true),
    ("start_guide", Page::Grinding, |machine| {
        machine.start_guide.steps[StartStep::Homing as usize].state = StepState::Met;
    }),
    ("variables", Page::Macro, |machine| machine.variables[100] = Some(7.0)),
    ("restart", Page::Program, |machine| machine.restart = Some(Box::new(restart()))),
    ("interrupted", Page::Position, |machine| machine.interrupted = Some((1_001, 13))),
    ("alarms", Page::Mdi, |machine| machine.alarms = crate::sample::alarm(machine.page).alarms),
    ("message", Page::Mdi, |machine| machine.message = crate::sample::refused(machine.page).message),
    ("waiting_for", Page::Mdi, |machine| machine.waiting_for = Some(LocalizedText::new("等待", "waits"))),
    ("terminals", Page::Diagnosis, |machine| machine.terminals.analog_volts[1] += 0.01),
    ("internals", Page::Diagnosis, |machine| machine.internals = machine.internals.with(InternalSignal::Held, true)),
    ("alarm_history", Page::Alarm, |machine| machine.alarm_history = AlarmHistory::new([], 7)),
    ("production", Page::Jobs, |machine| machine.production.parts = PartHistory::new([], 7)),
    ("leadscrews", Page::Params, |machine| machine.leadscrews[Axis::Z] = leadscrew()),
    ("params", Page::Mdi, |machine| machine.params = Arc::new((*machine.params).clone())),
    ("simulated", Page::Simulator, |machine| load(machine, 64.0)),
    ("bus", Page::Bus, |machine| machine.bus = Some(Arc::default())),
    ("host", Page::Network, |machine| machine.host.network = Some(Arc::default())),
    ("scope", Page::Scope, |machine| machine.scope.state = ScopeState::Armed),
    ("stock", Page::Graphic, |machine| machine.stock = busy(machine.page).stock),
    ("files", Page::Transfer, |machine| machine.files = busy(machine.page).files),
    ("access", Page::Settings, |machine| machine.access.level = AccessLevel::User),
    ("next_kind", Page::Settings, |machine| machine.next_kind = Kind::Ga),
    ("kept_states", Page::Alarm, |machine| {
        machine.kept_states = Arc::from([KeptState { number: 7, time: "2026-11-26 08:00".into() }]);
    }),
    ("edit_answer", Page::Offset, |machine| machine.edit_answer.count += 1),
    ("offsets", Page::Offset, |machine| machine.offsets.tools[15].wear[Axis::Z] += 0.001),
    ("modals", Page::Mdi, |machine| machine.modals.g[0] = 0),
    ("prepared_mdi", Page::Mdi, |machine| machine.prepared_mdi = "M30".into()),
    ("dressing_point", Page::Dressing, |machine| machine.dressing_point[Axis::Z] = Some(1.0)),
    ("kind_page", Page::Grinding, |machine| machine.kind_page = Some(1_002)),
    ("grinding_sheet", Page::Grinding, |machine| machine.grinding_sheet = (1, 3)),
    ("screens", Page::Grinding, |machine| machine.screens = Arc::default()),
    ("directory", Page::Directory, |machine| machine.directory = Arc::default()),
];

fn restart() -> RestartView {
    RestartView {
        program: 1_001,
        line: 13,
        modals: snapshot(Page::Program).modals,
        start: PerAxis([Some(40.2), None, Some(-12.5)]),
        wheel_turns: true,
        workpiece_turns: true,
        coolant_on: false,
    }
}

fn leadscrew() -> LeadscrewCompensation {
    let point = |position_mm| LeadscrewPoint { position_mm, backlash_mm: 0.001, pitch_error_mm: 0.0 };
    LeadscrewCompensation::from_points(&[point(0.0), point(10.0)]).unwrap()
}

fn load(machine: &mut Snapshot, percent: f64) {
    let simulated = machine.simulated.as_deref().cloned().unwrap_or_default();
    machine.simulated = Some(Arc::new(SimView { wheel_load_percent: percent, ..simulated }));
}

/// A simulated machine at rest on a page; no lamp blinks.
fn at_rest(page: Page) -> Snapshot {
    let mut machine = snapshot(page);
    machine.keys.iter_mut().for_each(|key| key.pending = false);
    load(&mut machine, 63.0);
    machine
}

#[test]
fn h8_whatever_changes_on_a_page_is_painted() {
    let names: Vec<&str> = CHANGES.iter().map(|(name, ..)| *name).collect();
    assert_eq!(names, FIELDS, "every field has its change here");
    for (name, page, change) in CHANGES {
        let before = at_rest(*page);
        let mut machine = before.clone();
        change(&mut machine);
        assert_eq!(changed_field(&before, &machine), Some(*name), "{name} on {page:?}");
    }
    // On every page.
    let before = at_rest(Page::Alarm);
    let mut machine = before.clone();
    machine.host.demo = DemoView::TakenOver { seconds_left: 1, of: 2 };
    assert_eq!(changed_field(&before, &machine), Some("host"));
}

/// The other way round: whatever a row leaves out on a page must not be seen there.
#[test]
fn h8_a_change_that_asks_for_no_frame_is_not_seen() {
    let mut left_out = 0;
    for page in Page::ALL {
        let before = at_rest(*page);
        let mut stage = OffscreenHmi::new(Hmi::new(Lang::Zh), (1_024, 768));
        let mut seen = |machine: &Snapshot| {
            stage.frame(machine);
            stage.frame(machine);
            stage.shapes().to_vec()
        };
        let first = seen(&before);
        for (name, _, change) in CHANGES {
            let mut machine = before.clone();
            change(&mut machine);
            if changed_field(&before, &machine).is_none() {
                left_out += 1;
                assert!(seen(&machine) == first, "{name} is seen on {page:?}");
                assert!(seen(&before) == first, "{page:?} is not as before after {name}");
            }
        }
    }
    assert!(left_out > 100, "{left_out}: pages skip what they do not show");
}

#[test]
fn h8_a_machine_at_rest_asks_for_no_frame() {
    for page in Page::ALL {
        let before = at_rest(*page);
        let mut machine = before.clone();
        // Every snapshot has its own view of the simulated machine, with the same values.
        machine.now.0 += 33_000;
        load(&mut machine, 63.0);
        // Less than a digit that is shown.
        machine.axes[Axis::X].work += 0.000_01;
        (machine.feed_mm_min, machine.cycle.times.seconds) =
            (before.feed_mm_min + 0.000_01, before.cycle.times.seconds + 0.4);
        if *page != Page::Wheel {
            machine.wheel_rpm += 0.1;
        }
        assert_eq!(changed_field(&before, &machine), None, "{page:?}");
    }
}

#[test]
fn h5_lamps_blink_and_messages_end_by_time_alone() {
    let later = |machine: &Snapshot, millis: u64| {
        let mut later = machine.clone();
        later.now = Micros(later.now.0 + millis * 1_000);
        later.date = Some(DateTime(1_795_273_316));
        later
    };
    let mut machine = at_rest(Page::Mdi);
    machine.date = Some(DateTime(1_795_273_316));
    assert_eq!(changed_field(&machine, &later(&machine, 500)), None);
    let mut blinking = machine.clone();
    blinking.keys[Key::Coolant as usize].pending = true;
    assert_eq!(changed_field(&blinking, &later(&blinking, 500)), Some("now"));
    let mut told = machine.clone();
    told.message = crate::sample::refused(Page::Mdi).message;
    assert_eq!(changed_field(&told, &later(&told, 4_900)), None);
    assert_eq!(changed_field(&told, &later(&told, 5_000)), Some("now"));
}

/// A freed value must not be mistaken for the next one at its address: the painted snapshot is kept.
#[test]
fn h8_a_value_at_the_address_of_a_freed_one_is_another_value() {
    let mut screen = Stage::new();
    let mut machine = at_rest(Page::Alarm);
    for _ in 0..100 {
        machine.params = Arc::new(Params::factory(Kind::Gc));
        assert!(screen.live.lock().unwrap().follow(&machine), "new parameters");
        screen.paint(&machine);
        assert!(!screen.live.lock().unwrap().follow(&machine));
    }
}

/// A live screen whose frames are painted at will.
struct Stage {
    live: Arc<Mutex<LiveScreen>>,
    ctx: Context,
    sent: Vec<Command>,
    events: Vec<egui::Event>,
}

impl Stage {
    fn new() -> Self {
        let (ctx, hmi) = (Context::default(), Hmi::new(Lang::Zh));
        hmi.install(&ctx);
        Self { live: Arc::new(Mutex::new(LiveScreen::new(hmi))), ctx, sent: Vec::new(), events: Vec::new() }
    }

    fn paint(&mut self, machine: &Snapshot) {
        let rect = egui::Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(1_024.0, 768.0));
        let input =
            RawInput { screen_rect: Some(rect), events: std::mem::take(&mut self.events), ..RawInput::default() };
        let machine = Arc::new(machine.clone());
        let (live, sent) = (&self.live, &mut self.sent);
        let output = self.ctx.run_ui(input, |ui| sent.extend(live.lock().unwrap().ui(ui, &machine)));
        output.drop_without_applying_deltas();
    }

    /// The exported table of the process page: focuses its last key and presses it.
    fn table(&mut self, machine: &Snapshot) -> String {
        for key in [egui::Key::ArrowUp, egui::Key::Enter] {
            self.events = vec![egui::Event::Key {
                key,
                physical_key: Some(key),
                pressed: true,
                repeat: false,
                modifiers: egui::Modifiers::NONE,
            }];
            self.paint(machine);
        }
        let table = self.sent.drain(..).find_map(|command| match command {
            Command::Page(PageCommand::File(_, FileRequest::SaveTable(text))) => Some(text),
            _ => None,
        });
        table.expect("a table")
    }
}

/// Curves have ten samples a second, whether the window paints each snapshot or none.
#[test]
fn h9_the_curves_are_recorded_at_a_fixed_density() {
    let record = |painted: bool| {
        let mut screen = Stage::new();
        let mut machine = at_rest(Page::Process);
        screen.paint(&machine);
        for _ in 0..300 {
            machine.now.0 += 33_000;
            if painted {
                screen.paint(&machine);
            }
            screen.live.lock().unwrap().follow(&machine);
        }
        let table = screen.table(&machine);
        table.lines().skip(1).take_while(|line| !line.is_empty()).count()
    };
    let (painted, unpainted) = (record(true), record(false));
    assert_eq!(painted, unpainted);
    assert!((99..=101).contains(&unpainted), "{unpainted} samples in 9.9 s");
}
