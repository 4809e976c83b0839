//! The grinding cycles that are shipped as macros, called by codes of the table (rows B2, B3): hand-computed points.
//!
//! The operations of a GC have radius millimetres: X40.4 is 20.2.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use kt830::defs::kind::Dialect;
use kt830::nc::ExternalState;
use kt830::nc::{
    Block, CommonVariables, Interpreter, Library, LiveValue, NcSettings, NextStatus, OfflineMachine, Op, OpEffect,
    OpMotion, ProgramFault, ProgramMessage, Source,
};
use kt830::units::{Axis, PerAxis, WorkPos};

#[derive(Debug)]
struct Shelf(BTreeMap<u32, Arc<Source>>);

impl Library for Shelf {
    fn find(&self, number: u32) -> Option<Arc<Source>> {
        self.0.get(&number).cloned()
    }
}

/// A machine whose gauge gives its signal in a G31 that reaches a place: along which axis, where, radius mm.
struct Gauge {
    machine: OfflineMachine,
    signal: Option<(Axis, f64)>,
}

impl Gauge {
    fn apply(&mut self, op: &Op) {
        let Op::Skip { to, feed, words, incremental, .. } = op else { return self.machine.apply(op) };
        let from = self.machine.work_position();
        let mut end = *to;
        if let Some((axis, at)) = self.signal
            && (from[axis] - at) * (to[axis] - at) <= 0.0
        {
            // It stops where the signal came.
            let part =
                if (to[axis] - from[axis]).abs() < 1e-9 { 0.0 } else { (at - from[axis]) / (to[axis] - from[axis]) };
            end = WorkPos::from_fn(|axis| from[axis] + part * (to[axis] - from[axis]));
        }
        self.machine.apply(&Op::Feed { to: end, feed: *feed, words: *words, incremental: *incremental });
    }
}

impl ExternalState for Gauge {
    fn position(&self) -> WorkPos {
        self.machine.position()
    }

    fn system_variable(&mut self, number: u32) -> LiveValue {
        // #5821 on: the signals are on from their place towards minus.
        if (5_821..=5_826).contains(&number) {
            let is_on = self.signal.is_some_and(|(axis, at)| self.machine.work_position()[axis] <= at);
            return LiveValue::Value(Some(f64::from(u8::from(is_on))));
        }
        self.machine.system_variable(number)
    }

    fn block_skip(&self) -> bool {
        false
    }
}

fn settings(dialect: Dialect) -> NcSettings {
    let mut settings = NcSettings::for_dialect(dialect);
    let codes: [(u16, u16); 9] = match dialect {
        Dialect::Mill => [(75, 9075), (77, 9077), (78, 9078), (79, 9079), (0, 0), (0, 0), (0, 0), (0, 0), (0, 0)],
        _ => [(71, 9071), (72, 9071), (73, 9073), (74, 9073), (176, 9076), (0, 0), (0, 0), (0, 0), (0, 0)],
    };
    settings.g_macros[..codes.len()].copy_from_slice(&codes);
    settings
}

/// What a text does behind its first line: `X Z F`, `skip X Z F`, `dwell s`, `alarm n`; lengths as programmed there.
fn steps(text: &str, dialect: Dialect, signal: Option<(Axis, f64)>) -> Result<Vec<String>, ProgramFault> {
    steps_with(&settings(dialect), text, signal)
}

fn steps_with(settings: &NcSettings, text: &str, signal: Option<(Axis, f64)>) -> Result<Vec<String>, ProgramFault> {
    steps_of_program(settings, format!("G98 F77\n{text}\nM30\n"), signal)
}

fn steps_of_program(
    settings: &NcSettings,
    text: String,
    signal: Option<(Axis, f64)>,
) -> Result<Vec<String>, ProgramFault> {
    let dialect = settings.dialect;
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("programs");
    let of_file = |number: u32| {
        let text = if number == 9099 {
            b"G53 G00 X0\nM99\n".to_vec()
        } else {
            std::fs::read(folder.join(format!("O{number}.NC"))).unwrap()
        };
        (number, Arc::new(Source::new(number, format!("O{number}.NC"), text, dialect)))
    };
    let shelf = Shelf([9071, 9073, 9075, 9076, 9077, 9078, 9079, 9099].into_iter().map(of_file).collect());
    let start = WorkPos::new(match dialect {
        Dialect::Mill => [0.0, 50.0, 0.0],
        _ => [20.2, 0.0, 0.0],
    });
    let mut world = Gauge { machine: OfflineMachine::new(settings).with_position(start), signal };
    let source = Arc::new(Source::new(1001, "O1001.NC", text, dialect));
    let mut block = Block::new(settings);
    let mut interpreter = Interpreter::new(source, Arc::new(shelf), settings.clone(), CommonVariables::default());
    let mut steps = Vec::new();
    loop {
        match interpreter.next(&mut world, &mut block)? {
            NextStatus::Block => {
                for op in &block.ops {
                    steps.extend(step(op, dialect));
                    world.apply(op);
                    if let OpEffect::Message(ProgramMessage::Alarm(..)) = op.effect() {
                        return Ok(steps);
                    }
                }
            }
            NextStatus::Drain | NextStatus::Busy | NextStatus::Waiting => {}
            NextStatus::End => break,
        }
    }
    let modals = interpreter.modals();
    steps.push(format!("G{:02} F{:?}", modals.motion.g(), modals.feed));
    Ok(steps)
}

fn step(op: &Op, dialect: Dialect) -> Option<String> {
    let mill = dialect == Dialect::Mill;
    let per_axis = PerAxis([if mill { 1.0 } else { 2.0 }, 1.0, 1.0]);
    let axes = if mill { vec![Axis::X, Axis::Y, Axis::Z] } else { vec![Axis::X, Axis::Z] };
    let place = |to: WorkPos| {
        axes.iter()
            .map(|axis| format!("{axis}{}", (to[*axis] * per_axis[*axis] * 1e6).round() / 1e6))
            .collect::<Vec<_>>()
            .join(" ")
    };
    match op.effect() {
        OpEffect::Motion(OpMotion::Work(by)) => {
            let feed = by.feed.map_or(String::new(), |feed| format!(" {feed:?}").replace("PerMinute", "F"));
            Some(format!("{}{}{feed}", if by.skip_signal.is_some() { "skip " } else { "" }, place(by.to)))
        }
        OpEffect::Motion(OpMotion::Machine { .. }) => Some("dress".into()),
        OpEffect::Dwell(s) => Some(format!("dwell {s}")),
        OpEffect::Message(ProgramMessage::Alarm(number, _)) => Some(format!("alarm {number}")),
        _ => None,
    }
}

fn expect(text: &str, dialect: Dialect, signal: Option<(Axis, f64)>, wanted: &[&str]) {
    let found = steps(text, dialect, signal).unwrap_or_else(|fault| panic!("{text}: {fault}"));
    assert_eq!(found, wanted, "{text}");
}

/// The mode and the feed of the program are in force again behind every cycle.
const AFTER: &str = "G00 FSome(77.0)";

#[test]
fn b2_g71_traverses_with_infeed_at_both_ends() {
    // From Ø40.4: 0.1 per side in front of the way there, 0.05 in front of the way back, twice; then a spark-out stroke.
    expect(
        "G71 A-0.1 B-0.05 W-60. U1.5 I600. K300. H2 S1",
        Dialect::LatheA,
        None,
        &[
            "X40.2 Z0 F(600.0)",
            "dwell 1.5",
            "X40.2 Z-60 F(300.0)",
            "X40.1 Z-60 F(600.0)",
            "dwell 1.5",
            "X40.1 Z0 F(300.0)",
            "X39.9 Z0 F(600.0)",
            "dwell 1.5",
            "X39.9 Z-60 F(300.0)",
            "X39.8 Z-60 F(600.0)",
            "dwell 1.5",
            "X39.8 Z0 F(300.0)",
            "X39.8 Z-60 F(300.0)",
            "X39.8 Z0 F(300.0)",
            AFTER,
        ],
    );
    // B0: one end only. A bore: the infeed is positive.
    expect(
        "G71 A0.02 B0 W30. I50. K400.",
        Dialect::LatheA,
        None,
        &["X40.44 Z0 F(50.0)", "dwell 0", "X40.44 Z30 F(400.0)", "dwell 0", "X40.44 Z0 F(400.0)", AFTER],
    );
}

/// P6.1: lengths and times without a decimal point are thousandths, in the arguments of a cycle too; feeds and numbers
/// are as written.
#[test]
fn b2_least_increments_hold_in_the_arguments_of_a_cycle() {
    for (dialect, with_points, in_thousandths) in [
        (
            Dialect::LatheA,
            "G71 A-0.1 B-0.05 W-60. U1.5 I600. K300. H2 S1",
            "G71 A-100 B-50 W-60000 U1500 I600 K300 H2 S1",
        ),
        (Dialect::LatheA, "G73 A-0.05 B-0.025 W-60. U2. K300.", "G73 A-50 B-25 W-60000 U2000 K300"),
        (Dialect::LatheA, "G176 X40. A0.1 F0.6 E0.2 U3.", "G176 X40000 A100 F0.6 E0.2 U3000"),
        (Dialect::Mill, "G75 I-0.02 J0 K-0.04 X30. R100. F9000. P500", "G75 I-20 J0 K-40 X30000 R100 F9000 P500"),
        (Dialect::Mill, "G77 P1 I-0.02 K-0.04 Z-30. R100. F9000. U1.5", "G77 P1 I-20 K-40 Z-30000 R100 F9000 U1500"),
        (Dialect::Mill, "G78 I-2. K-5. X80. F9000.", "G78 I-2000 K-5000 X80000 F9000"),
        (Dialect::Mill, "G79 I-2. K-5. X80. R3000. F9000.", "G79 I-2000 K-5000 X80000 R3000 F9000"),
    ] {
        let least = NcSettings { least_increment_mm: Some(0.001), ..settings(dialect) };
        let wanted = steps(with_points, dialect, None).unwrap_or_else(|fault| panic!("{with_points}: {fault}"));
        let found =
            steps_with(&least, in_thousandths, None).unwrap_or_else(|fault| panic!("{in_thousandths}: {fault}"));
        assert_eq!(found, wanted, "{in_thousandths}");
        assert_eq!(steps_with(&least, with_points, None).unwrap(), wanted, "{with_points}");
    }
}

/// The feeds of a cycle end with it: a program without an F has none behind it.
#[test]
fn b2_a_cycle_leaves_no_feed_where_there_was_none() {
    for (dialect, cycle) in [
        (Dialect::LatheA, "G71 A-0.1 B-0.05 W-60. U1.5 I600. K300. H2 S1"),
        (Dialect::LatheA, "G65 P9071 A-0.1 B-0.05 W-60. U1.5 I600. K300. H2 S1"),
        (Dialect::LatheA, "G176 X40. A0.1 F0.6 E0.2 U3."),
        (Dialect::LatheA, "G73 A-0.05 B-0.025 W-60. K300. U2"),
        (Dialect::Mill, "G75 I-0.02 J0 K-0.04 X30. R100. F9000."),
        (Dialect::Mill, "G79 I-2. K-5. X80. R3000. F9000."),
    ] {
        let run = |text: &str| steps_of_program(&settings(dialect), text.to_owned(), None);
        let done = run(&format!("G98\n{cycle}\nM30\n")).unwrap_or_else(|fault| panic!("{cycle}: {fault}"));
        assert_eq!(done.last().unwrap(), "G00 FNone", "{cycle}: {done:?}");
        let after = run(&format!("G98\n{cycle}\nG01 X1\nM30\n")).unwrap_err();
        assert_eq!((after.location.line, after.error.id()), (3, "feed-missing"), "{cycle}");
    }
}

#[test]
fn b2_g72_ends_at_the_size_signal() {
    // The signal at Ø39.85 comes in the second infeed of the way there, Ø40 to Ø39.8: back to the Z start.
    expect(
        "G72 P1 A-0.1 W-60. I600. K300. H9",
        Dialect::LatheA,
        Some((Axis::X, 39.85 / 2.0)),
        &[
            "skip X40.2 Z0 F(600.0)",
            "dwell 0",
            "skip X40.2 Z-60 F(300.0)",
            "skip X40 Z-60 F(600.0)",
            "dwell 0",
            "skip X40 Z0 F(300.0)",
            "skip X39.8 Z0 F(600.0)",
            "X39.85 Z0 F(300.0)",
            AFTER,
        ],
    );
    // It comes on the way there: that stroke is ended, then back.
    expect(
        "G72 P1 A-0.1 W-60. I600. K300. H9",
        Dialect::LatheA,
        Some((Axis::Z, -45.0)),
        &[
            "skip X40.2 Z0 F(600.0)",
            "dwell 0",
            "skip X40.2 Z-60 F(300.0)",
            "X40.2 Z-60 F(300.0)",
            "X40.2 Z0 F(300.0)",
            AFTER,
        ],
    );
    // It does not come at all: alarm 3076 instead of a part that is too large.
    let found = steps("G72 P1 A-0.1 W-60. I600. K300. H1", Dialect::LatheA, None).unwrap();
    assert_eq!(found.last().map(String::as_str), Some("alarm 3076"));
}

/// The signal is there before the wheel has touched the part: nothing is ground, and nothing counts as finished.
#[test]
fn p7_a_signal_that_is_there_before_is_an_alarm_in_every_cycle_with_direct_sizing() {
    let (gc, gs) = (Some((Axis::X, 20.3)), Some((Axis::Y, 50.1)));
    for (text, dialect, signal) in [
        ("G72 P1 A-0.1 W-60. I600. K300. H9", Dialect::LatheA, gc),
        ("G74 P4 A-0.1 W-60. K300. H9", Dialect::LatheA, gc),
        ("G176 X40. A0.1 F0.6 E0.2 P4", Dialect::LatheA, gc),
        ("G77 P4 I-0.02 K-0.05 X80. R100. F9000.", Dialect::Mill, gs),
    ] {
        assert_eq!(steps(text, dialect, signal).unwrap(), ["alarm 3089"], "{text}");
    }
}

#[test]
fn b2_g71_dresses_between_its_infeeds() {
    // After two infeeds the dressing program; then Z first, X to 1 mm in front (diameter), then on. Not behind the last one.
    expect(
        "G71 A-0.1 W-60. I600. K300. H2 D9099 Q2",
        Dialect::LatheA,
        None,
        &[
            "X40.2 Z0 F(600.0)",
            "dwell 0",
            "X40.2 Z-60 F(300.0)",
            "X40 Z-60 F(600.0)",
            "dwell 0",
            "X40 Z0 F(300.0)",
            "dress",
            "X0 Z0",
            "X41 Z0",
            "X40 Z0 F(600.0)",
            "X39.8 Z0 F(600.0)",
            "dwell 0",
            "X39.8 Z-60 F(300.0)",
            "X39.6 Z-60 F(600.0)",
            "dwell 0",
            "X39.6 Z0 F(300.0)",
            AFTER,
        ],
    );
}

#[test]
fn b2_g73_feeds_in_while_it_traverses() {
    expect(
        "G73 A-0.05 B-0.025 W-60. K300. U2",
        Dialect::LatheA,
        None,
        &["X40.3 Z-60 F(300.0)", "dwell 2", "X40.25 Z0 F(300.0)", "dwell 2", AFTER],
    );
    // G74 with the signal half way there at Z-30, Ø40.35: the stroke is ended at that diameter.
    expect(
        "G74 P2 A-0.05 W-60. K300. H5",
        Dialect::LatheA,
        Some((Axis::Z, -30.0)),
        &["skip X40.3 Z-60 F(300.0)", "X40.35 Z-60 F(300.0)", "X40.35 Z0 F(300.0)", AFTER],
    );
}

#[test]
fn b2_a_plunge_cycle_to_a_size_or_to_the_signal() {
    expect(
        "G176 X40. A0.1 F0.6 E0.2 U3.",
        Dialect::LatheA,
        None,
        &["X40.1 Z0 F(0.6)", "X40 Z0 F(0.2)", "dwell 3", "X40.4 Z0", AFTER],
    );
    expect(
        "G176 X39.9 A0.2 F0.6 E0.2 U3. P1",
        Dialect::LatheA,
        Some((Axis::X, 20.0)),
        &["skip X40.1 Z0 F(0.6)", "skip X39.9 Z0 F(0.2)", "dwell 3", "X40.4 Z0", AFTER],
    );
    // In roughing it is no good part: back, then the alarm.
    expect(
        "G176 X39.9 A0.2 F0.6 E0.2 U3. P1",
        Dialect::LatheA,
        Some((Axis::X, 20.15)),
        &["skip X40.1 Z0 F(0.6)", "X40.4 Z0", "alarm 3077"],
    );
    // Without a signal the wheel is taken back first.
    expect(
        "G176 X39.9 A0.2 F0.6 E0.2 P1",
        Dialect::LatheA,
        None,
        &["skip X40.1 Z0 F(0.6)", "skip X39.9 Z0 F(0.2)", "X40.4 Z0", "alarm 3076"],
    );
}

#[test]
fn b2_g75_reciprocates_with_infeed_at_one_or_both_ends() {
    // 0.05 in all by 0.02: 0.02, 0.02, 0.01; the last one stands at the first end and is ground there and back.
    expect(
        "G91 G75 I-0.02 K-0.05 X80. R100. F9000. P500 S1".replace("G91 ", "G91\n").as_str(),
        Dialect::Mill,
        None,
        &[
            "X0 Y49.98 Z0 F(100.0)",
            "dwell 0.5",
            "X80 Y49.98 Z0 F(9000.0)",
            "X80 Y49.96 Z0 F(100.0)",
            "dwell 0.5",
            "X0 Y49.96 Z0 F(9000.0)",
            "X0 Y49.95 Z0 F(100.0)",
            "dwell 0.5",
            "X80 Y49.95 Z0 F(9000.0)",
            "dwell 0.5",
            "X0 Y49.95 Z0 F(9000.0)",
            "X80 Y49.95 Z0 F(9000.0)",
            "X0 Y49.95 Z0 F(9000.0)",
            AFTER,
        ],
    );
    expect(
        "G75 I-0.02 J0 K-0.04 Z-30. R100. F9000.",
        Dialect::Mill,
        None,
        &[
            "X0 Y49.98 Z0 F(100.0)",
            "dwell 0",
            "X0 Y49.98 Z-30 F(9000.0)",
            "dwell 0",
            "X0 Y49.98 Z0 F(9000.0)",
            "X0 Y49.96 Z0 F(100.0)",
            "dwell 0",
            "X0 Y49.96 Z-30 F(9000.0)",
            "dwell 0",
            "X0 Y49.96 Z0 F(9000.0)",
            AFTER,
        ],
    );
    // G77 to the signal at Y49.97, in the infeed at the far end: back at that height.
    expect(
        "G77 P4 I-0.02 K-0.5 X80. R100. F9000. U0.5",
        Dialect::Mill,
        Some((Axis::Y, 49.97)),
        &[
            "skip X0 Y49.98 Z0 F(100.0)",
            "dwell 0.5",
            "X80 Y49.98 Z0 F(9000.0)",
            "skip X80 Y49.96 Z0 F(100.0)",
            "X0 Y49.97 Z0 F(9000.0)",
            AFTER,
        ],
    );
    // At the near end: there and back.
    expect(
        "G77 P4 I-0.05 K-0.5 X80. R100. F9000.",
        Dialect::Mill,
        Some((Axis::Y, 49.97)),
        &["skip X0 Y49.95 Z0 F(100.0)", "X80 Y49.97 Z0 F(9000.0)", "X0 Y49.97 Z0 F(9000.0)", AFTER],
    );
}

#[test]
fn b2_g78_and_g79_feed_across_the_strokes() {
    expect(
        "G79 I-2. K-5. X80. R3000. F9000.",
        Dialect::Mill,
        None,
        &[
            "X0 Y50 Z-2 F(3000.0)",
            "dwell 0",
            "X80 Y50 Z-2 F(9000.0)",
            "X80 Y50 Z-4 F(3000.0)",
            "dwell 0",
            "X0 Y50 Z-4 F(9000.0)",
            "X0 Y50 Z-5 F(3000.0)",
            "dwell 0",
            "X80 Y50 Z-5 F(9000.0)",
            "X80 Y50 Z-5 F(3000.0)",
            "dwell 0",
            "X0 Y50 Z-5 F(9000.0)",
            AFTER,
        ],
    );
    expect(
        "G78 I-2. K-3. X80. F9000. P100",
        Dialect::Mill,
        None,
        &["dwell 0.1", "X80 Y50 Z-2 F(9000.0)", "dwell 0.1", "X0 Y50 Z-3 F(9000.0)", AFTER],
    );
}

#[test]
fn b2_a_cycle_without_its_words_moves_nothing_and_says_which() {
    for (text, dialect, alarm) in [
        ("G71 W-60. I600. K300.", Dialect::LatheA, "alarm 3071"),
        ("G71 A-0.1 I600. K300.", Dialect::LatheA, "alarm 3072"),
        ("G71 A-0.1 W-60. K300.", Dialect::LatheA, "alarm 3073"),
        ("G71 A-0.1 W-60. I600. K300. H0", Dialect::LatheA, "alarm 3074"),
        ("G71 A-0.1 W-60. I600. K300. D9099", Dialect::LatheA, "alarm 3075"),
        ("G73 A-0.1 W-60.", Dialect::LatheA, "alarm 3073"),
        ("G176 X40. F0.6 E0.2", Dialect::LatheA, "alarm 3071"),
        ("G176 X40.4 A0.1 F0.6 E0.2", Dialect::LatheA, "alarm 3071"),
        ("G176 A0.1 F0.6 E0.2", Dialect::LatheA, "alarm 3072"),
        ("G75 K-0.1 X80. R100. F9000.", Dialect::Mill, "alarm 3071"),
        ("G75 I-0.1 X80. R100. F9000.", Dialect::Mill, "alarm 3078"),
        ("G75 I-0.1 K-0.2 R100. F9000.", Dialect::Mill, "alarm 3072"),
        ("G75 I-0.1 K0.2 X80. R100. F9000.", Dialect::Mill, "alarm 3077"),
        ("G75 I-0.1 J0.1 K-0.2 X80. R100. F9000.", Dialect::Mill, "alarm 3077"),
        ("G75 I-0.1 K-0.2 X80. F9000.", Dialect::Mill, "alarm 3073"),
        ("G77 I-0.1 K-0.2 X80. R100. F9000.", Dialect::Mill, "alarm 3079"),
        ("G79 I-0.1 X80. R100. F9000.", Dialect::Mill, "alarm 3078"),
        ("G79 I-0.1 K-1. X80. R100. F9000. D9099 Q1", Dialect::Mill, "alarm 3075"),
        // The wrong word is found before the wheel has moved.
        ("G71 A-0.1 B0.05 W-60. I600. K300.", Dialect::LatheA, "alarm 3077"),
        ("G71 A-0.1 W-60. I600. K300. H2.5", Dialect::LatheA, "alarm 3074"),
        ("G71 A-0.1 W-60. I600. K300. U-1", Dialect::LatheA, "alarm 3070"),
        ("G72 A-0.1 W-60. I600. K300. P9", Dialect::LatheA, "alarm 3079"),
        ("G73 A-0.1 W-60. K300. P1.5", Dialect::LatheA, "alarm 3079"),
        ("G176 X40. A0.1 F0.6 E0.2 P7", Dialect::LatheA, "alarm 3079"),
        ("G176 X40. A0.1 F0.6 E0.2 U-1", Dialect::LatheA, "alarm 3070"),
        ("G77 P9 I-0.1 K-0.2 X80. R100. F9000.", Dialect::Mill, "alarm 3079"),
        ("G75 I-0.1 K-0.2 X80. R100. F9000. P-1", Dialect::Mill, "alarm 3070"),
    ] {
        let found = steps(text, dialect, None).unwrap();
        assert_eq!(found, [alarm], "{text}");
    }
}

/// The feeds of a cycle are mm/min whatever the program uses, and its depths are radius values in radius programming too.
#[test]
fn b2_a_cycle_has_its_own_units_and_gives_back_those_of_the_program() {
    expect(
        "G99 F0.2\nG71 A-0.1 W-60. I600. K300.",
        Dialect::LatheA,
        None,
        &[
            "X40.2 Z0 F(600.0)",
            "dwell 0",
            "X40.2 Z-60 F(300.0)",
            "X40 Z-60 F(600.0)",
            "dwell 0",
            "X40 Z0 F(300.0)",
            "G00 FSome(0.2)",
        ],
    );
    let radius = NcSettings { diameter: false, ..settings(Dialect::LatheA) };
    let found = steps_with(&radius, "G71 A-0.1 B0 W-60. I600. K300.", None).unwrap();
    // The steps are shown as diameters: 0.1 mm off the radius of 20.2 mm.
    assert_eq!(found[..3], ["X40.2 Z0 F(600.0)", "dwell 0", "X40.2 Z-60 F(300.0)"]);
}
