//! Which change of the machine asks for a frame: the newest snapshot is compared with the painted one, field by field.
//!
//! A row for each field decides how it is compared; the row of a page says what it shows. Values are compared as the
//! pages write them: a change that no digit shows asks for no frame. A field without a row does not compile.
//! Source: spec H5, H8.

use std::sync::Arc;

use super::app::Hmi;
use super::page::{FieldGroup, shown_fields, start_strip};
use super::page_frame::message_is_fresh;
use super::scene;
use super::{
    blink_phase, clock_time, format_cycle_time, format_feed, format_length, format_strokes, format_volts, format_whole,
};
use crate::defs::grinding_workspace::GrindingWorkspace;
use crate::defs::key::Key;
use crate::defs::page::Page;
use crate::link::cycle::CycleView;
use crate::link::demo_view::DemoView;
use crate::link::program_view::ProgramView;
use crate::link::simulation::SimView;
use crate::link::snapshot::AxisView;
use crate::link::terminals::TerminalView;
use crate::link::{Command, Snapshot};
use crate::units::PerAxis;

macro_rules! compared_fields {
    ($($field:ident: $rule:expr;)*) => {
        /// Names of the fields of a snapshot, in the order of the rows.
        pub const FIELDS: &[&str] = &[$(stringify!($field)),*];

        /// The first field whose change shows on the open page; none if the painted frame still holds.
        #[must_use]
        pub fn changed_field(painted: &Snapshot, newest: &Snapshot) -> Option<&'static str> {
            // Without `..`: a new field of the snapshot needs its row.
            let Snapshot { $($field),* } = newest;
            $(
                if is_changed(&painted.$field, $field, newest.page, $rule) {
                    return Some(stringify!($field));
                }
            )*
            time_step_passed(painted, newest).then_some("now")
        }
    };
}

compared_fields! {
    page: differ;
    kind: differ;
    // The clock, the blink and the end of a message are steps of time: `time_step_passed`.
    now: |_, _, _| false;
    date: differ;
    mode: differ;
    state: differ;
    own_motion: differ;
    coordinates: differ;
    soft_key_row: differ;
    x_as_diameter: differ;
    axes: |old, new, _| axes_differ(old, new);
    program: |old, new, _| program_differs(old, new);
    handwheel: differ;
    overrides: differ;
    feed_mm_min: |old, new, _| format_feed(*old) != format_feed(*new);
    // The wheel page also shows the speed of the rim; on the home page a whole turn is fine enough for it.
    wheel_rpm: |old, new, page| {
        page == Page::Wheel && old.to_bits() != new.to_bits() || format_whole(*old) != format_whole(*new)
    };
    tool_station: differ;
    teach: on(FieldGroup::Teach, differ);
    strokes_per_min: |old, new, _| format_strokes(*old) != format_strokes(*new);
    is_storing: differ;
    parts_counted: differ;
    cycle: |old, new, page| {
        let shown = |cycle: &CycleView| format_cycle_time(cycle.times.seconds);
        shown(old) != shown(new)
            || old.phase != new.phase
            || shown_fields(page).contains(&FieldGroup::PartResult) && old.part != new.part
    };
    inputs: on(FieldGroup::Inputs, differ);
    outputs: on_either(FieldGroup::Diagnosis, FieldGroup::Scene);
    keys: differ;
    start_guide: on(FieldGroup::StartGuide, differ);
    // Compared bit by bit: a value that is not a number is equal to itself.
    variables: |old, new, page| {
        let mut pairs = old.iter().zip(&**new);
        shown_fields(page).contains(&FieldGroup::Variables)
            && pairs.any(|(old, new)| old.map(f64::to_bits) != new.map(f64::to_bits))
    };
    restart: on(FieldGroup::Restart, differ);
    interrupted: differ;
    alarms: differ;
    message: differ;
    waiting_for: differ;
    terminals: on(FieldGroup::Diagnosis, |old, new, _| terminals_differ(old, new));
    internals: on(FieldGroup::Diagnosis, differ);
    alarm_history: |old, new, _| old.version() != new.version();
    production: |old, new, page| shown_fields(page).contains(&FieldGroup::Production) && old.differs(new);
    leadscrews: on(FieldGroup::Leadscrews, differ);
    params: replaced;
    // Without a simulated machine and a bus every page has one row of soft keys less.
    simulated: |old, new, page| {
        old.is_some() != new.is_some()
            || shown_fields(page).contains(&FieldGroup::Simulated) && old != new
            || shown_fields(page).contains(&FieldGroup::Scene) && workspace(old) != workspace(new)
    };
    bus: |old, new, page| {
        old.is_some() != new.is_some() || shown_fields(page).contains(&FieldGroup::Bus) && old != new
    };
    host: |old, new, page| {
        old.demo != new.demo || shown_fields(page).contains(&FieldGroup::Network) && old.network != new.network
    };
    scope: on(FieldGroup::Scope, differ);
    stock: on(FieldGroup::Stock, differ);
    files: replaced;
    access: differ;
    next_kind: differ;
    kept_states: differ;
    edit_answer: differ;
    offsets: on(FieldGroup::Offsets, differ);
    modals: on(FieldGroup::Mdi, differ);
    prepared_mdi: on(FieldGroup::Mdi, differ);
    dressing_point: on(FieldGroup::DressingPoint, differ);
    kind_page: differ;
    grinding_sheet: differ;
    screens: replaced;
    directory: replaced;
}

/// Applies a rule to the painted and to the newest value; here so that the closures of the rows have their types.
fn is_changed<T>(painted: &T, newest: &T, page: Page, rule: impl Fn(&T, &T, Page) -> bool) -> bool {
    rule(painted, newest, page)
}

/// The value is another one.
fn differ<T: PartialEq>(painted: &T, newest: &T, _page: Page) -> bool {
    painted != newest
}

/// The owner has replaced the value. The painted one is kept, so its address is not reused.
fn replaced<T>(painted: &Arc<T>, newest: &Arc<T>, _page: Page) -> bool {
    !Arc::ptr_eq(painted, newest)
}

/// A rule for the pages that show a group of fields.
fn on<T>(group: FieldGroup, rule: impl Fn(&T, &T, Page) -> bool) -> impl Fn(&T, &T, Page) -> bool {
    move |painted, newest, page| shown_fields(page).contains(&group) && rule(painted, newest, page)
}

/// What the scene draws of a simulated machine.
fn workspace(simulated: &Option<Arc<SimView>>) -> Option<&GrindingWorkspace> {
    simulated.as_ref()?.grinding_workspace.as_ref()
}

/// Another value on the pages that show one of two groups.
fn on_either<T: PartialEq>(a: FieldGroup, b: FieldGroup) -> impl Fn(&T, &T, Page) -> bool {
    move |painted, newest, page| shown_fields(page).iter().any(|group| *group == a || *group == b) && painted != newest
}

fn axes_differ(painted: &PerAxis<AxisView>, newest: &PerAxis<AxisView>) -> bool {
    let shown = |axis: &AxisView| {
        let AxisView { present, work, machine, relative, to_go, homed, moving, decimals } = *axis;
        ([present, homed, moving], [work, machine, relative, to_go].map(|mm| format_length(mm, decimals)))
    };
    painted.0.iter().zip(&newest.0).any(|(old, new)| old != new && shown(old) != shown(new))
}

/// The lamp of an analog output is lit above zero.
fn terminals_differ(painted: &TerminalView, newest: &TerminalView) -> bool {
    let volts = |volts: f64| (volts > 0.0, format_volts(volts));
    let shown = |view: &TerminalView| (view.inputs, view.outputs, view.analog_volts.map(volts));
    shown(painted) != shown(newest)
}

/// The text is compared by its memory and its stamp: a million lines are not read 30 times a second.
fn program_differs(painted: &ProgramView, newest: &ProgramView) -> bool {
    // The bounds are part of the text; the screen does not show how the last run ended.
    let ProgramView {
        number,
        text,
        bounds: _,
        stamp,
        has_invalid_bytes,
        block_program,
        subprogram_text,
        line,
        block,
        is_open,
        is_completed: _,
    } = newest;
    let same_subprogram = match (subprogram_text, &painted.subprogram_text) {
        (Some(newest), Some(painted)) => newest.is_instance(painted),
        (newest, painted) => newest.is_none() && painted.is_none(),
    };
    let shown = (*number, *stamp, *has_invalid_bytes, *block_program, *line, *block, *is_open);
    let old = painted;
    shown != (old.number, old.stamp, old.has_invalid_bytes, old.block_program, old.line, old.block, old.is_open)
        || !text.is_instance(&old.text)
        || !same_subprogram
}

/// Whether time alone changes the picture (the clock, what turns in a scene, the blink of a lamp, the end of a message),
/// or the finished size that the magnifier of a scene shows.
fn time_step_passed(painted: &Snapshot, newest: &Snapshot) -> bool {
    let blinks = newest.key(Key::EmergencyStop).lamp
        || newest.keys.iter().any(|key| key.pending)
        || start_strip::blinks(newest)
        || matches!(newest.host.demo, DemoView::Caption(_));
    let shows_scene = shown_fields(newest.page).contains(&FieldGroup::Scene);
    let turns = shows_scene && scene::is_turning(newest);
    clock_time(painted) != clock_time(newest)
        || shows_scene && painted.size_values().nominal() != newest.size_values().nominal()
        || turns && scene::frame_at(painted.now) != scene::frame_at(newest.now)
        || blinks && blink_phase(painted.now) != blink_phase(newest.now)
        || message_is_fresh(painted) != message_is_fresh(newest)
}

/// The screen and the snapshot that it painted last; shared by the window and the watcher of the snapshots.
pub struct LiveScreen {
    /// The user interface.
    pub hmi: Hmi,
    painted: Option<Box<Snapshot>>,
}

impl LiveScreen {
    /// A screen that has painted nothing yet.
    #[must_use]
    pub const fn new(hmi: Hmi) -> Self {
        Self { hmi, painted: None }
    }

    /// Draws one frame; returns the operator's commands.
    pub fn ui(&mut self, ui: &mut egui::Ui, snapshot: &Snapshot) -> Vec<Command> {
        self.painted = Some(Box::new(snapshot.clone()));
        self.hmi.ui(ui, snapshot)
    }

    /// Records a new snapshot; true if it asks for a frame.
    pub fn follow(&mut self, newest: &Snapshot) -> bool {
        self.hmi.record(newest);
        self.painted.as_ref().is_none_or(|painted| changed_field(painted, newest).is_some())
    }
}
