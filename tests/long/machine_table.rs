//! Every M code on every kind, in a run, by its key in a hold, and in manual (MDI), under every parameter that changes its
//! rule: what is switched, which lamp is lit, which alarm comes. One row a rule.
//! Source: spec K3, K5.3, B4.

use crate::stories::{ready_of, tell};
use kt830::defs::key::Key;
use kt830::defs::kind::Kind;
use kt830::defs::mcode::MCODES;
use kt830::defs::signal::{Input, Output};
use kt830::host::folders::program_from_bytes;
use kt830::host::headless::HeadlessHost;
use kt830::link::command::Command;
use kt830::link::snapshot::{RunState, Tone};

const ALL: &[Kind] = &Kind::ALL;
const GC: &[Kind] = &[Kind::Gc];
const GS: &[Kind] = &[Kind::Gs];
const GA: &[Kind] = &[Kind::Ga];
const GS_GA: &[Kind] = &[Kind::Gs, Kind::Ga];

/// What comes of a code.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Comes {
    /// Done; the program goes on.
    Done,
    /// A message; the program goes on, nothing has changed.
    NoEffect,
    /// A message; the program waits before the block, nothing has changed.
    Waits,
    /// An alarm before the block; nothing has changed.
    Alarm(u16),
}
use Comes::{Alarm, Done, NoEffect, Waits};

struct Row {
    code: &'static str,
    kinds: &'static [Kind],
    /// Story lines before everything, separated by `;`.
    setup: &'static str,
    /// Codes that bring the machine into its state, separated by spaces.
    before: &'static str,
    comes: Comes,
    /// Output and whether it is on afterwards.
    output: Option<(Output, bool)>,
    /// The key that does the same, and its lamp afterwards.
    key: Option<(Key, bool)>,
}

const fn row(code: &'static str, kinds: &'static [Kind], comes: Comes, output: Output, on: bool) -> Row {
    Row { code, kinds, setup: "", before: "", comes, output: Some((output, on)), key: None }
}

impl Row {
    const fn after(mut self, before: &'static str) -> Self {
        self.before = before;
        self
    }
    const fn with(mut self, setup: &'static str) -> Self {
        self.setup = setup;
        self
    }
    const fn key(mut self, key: Key, lamp: bool) -> Self {
        self.key = Some((key, lamp));
        self
    }
}

/// Delays short enough that every code is over soon; the input filter stays.
const QUICK: &str = "param P61 300;param P62 200;param P81 200;param P82 400;param P88 300";

/// A unit is taken away once its output is off: before that the parameter is refused.
const NO_TAILSTOCK: &str = "mdi M11;wait 2 s;param P16.2 0";
const NO_MAGNET: &str = "mdi M95;wait 1 s;param P16.0 0";

#[rustfmt::skip]
fn table() -> Vec<Row> {
    use Output::*;
    vec![
        // K3.1, K3.7, K3.11: the wheel.
        row("M03", ALL, Done, Wheel, true).key(Key::WheelStart, true),
        row("M03", ALL, Alarm(180), Wheel, false).after("M15").key(Key::WheelStart, false),
        row("M03", ALL, Waits, Wheel, false).with("param P270 0").after("M15").key(Key::WheelStart, false),
        row("M03", ALL, Done, Wheel, true).with("param P17.0 1").after("M15").key(Key::WheelStart, true),
        row("M03", GS_GA, Alarm(187), Wheel, false).after("M95").key(Key::WheelStart, false),
        row("M03", GS_GA, Done, Wheel, true).with("param P16.1 0").after("M95").key(Key::WheelStart, true),
        row("M03", GC, Alarm(187), Wheel, false).with("param P16.1 1").key(Key::WheelStart, false),
        // P2: 1100 rpm are 34.6 m/s at 600 mm (GC), 28.8 m/s at 500 mm (GS, GA).
        row("M03", GC, Alarm(186), Wheel, false).with("param P79 34").key(Key::WheelStart, false),
        row("M03", GS_GA, Alarm(186), Wheel, false).with("param P79 28").key(Key::WheelStart, false),
        row("M05", ALL, Done, Wheel, false).after("M03").key(Key::WheelStop, true),
        // K3.2, K3.8, K3.12.
        row("M08", ALL, Done, Coolant, true).key(Key::Coolant, true),
        row("M09", ALL, Done, Coolant, false).after("M08").key(Key::Coolant, false),
        row("M32", ALL, Done, Lubrication, true).key(Key::Lubrication, true),
        row("M33", ALL, Done, Lubrication, false).after("M32").key(Key::Lubrication, false),
        row("M50", ALL, Done, User1, true),
        row("M51", ALL, Done, User1, false).after("M50"),
        row("M52", ALL, Done, User2, true),
        row("M53", ALL, Done, User2, false).after("M52"),
        row("M54", ALL, Done, User3, true),
        row("M55", ALL, Done, User3, false).after("M54"),
        row("M56", ALL, Done, User4, true),
        row("M57", ALL, Done, User4, false).after("M56"),
        row("M58", ALL, Done, User5, true),
        row("M59", ALL, Done, User5, false).after("M58"),
        // K3.3, K5.3: the tailstock.
        row("M10", GC, Done, Tailstock, true).after("M11").key(Key::TailstockAdvance, true),
        row("M11", GC, Done, Tailstock, false).key(Key::TailstockRetract, true),
        row("M10", GC, Alarm(181), Tailstock, true).after("M63").key(Key::TailstockAdvance, true),
        row("M11", GC, Alarm(181), Tailstock, true).after("M64").key(Key::TailstockRetract, false),
        row("M10", GC, NoEffect, Tailstock, false).with(NO_TAILSTOCK).key(Key::TailstockAdvance, false),
        row("M11", GC, NoEffect, Tailstock, false).with(NO_TAILSTOCK).key(Key::TailstockRetract, true),
        row("M10", GS_GA, Alarm(190), Tailstock, false),
        row("M11", GS_GA, Alarm(190), Tailstock, false),
        row("M10", GS_GA, Alarm(190), Tailstock, false).with("param P16.2 1"),
        // K3.5: the pump.
        row("M14", ALL, Done, Hydraulic, true).after("M15").key(Key::Hydraulic, true),
        row("M15", ALL, Done, Hydraulic, false).key(Key::Hydraulic, false),
        row("M14", ALL, NoEffect, Hydraulic, true).after("M03"),
        row("M15", ALL, NoEffect, Hydraulic, true).after("M03").key(Key::Hydraulic, true),
        // B4: the second spindle, gears and ports.
        row("M26", ALL, Done, SecondSpindle, true).key(Key::SecondSpindle, true),
        row("M27", ALL, Done, SecondSpindleCcw, true),
        row("M27", ALL, Done, SecondSpindle, false).after("M26"),
        row("M28", ALL, Done, SecondSpindle, false).after("M26").key(Key::SecondSpindle, false),
        row("M41", ALL, Done, Gear1, true),
        row("M42", ALL, Done, Gear2, true),
        row("M42", ALL, Done, Gear1, false).after("M41"),
        row("M43", ALL, Done, Gear3, true),
        row("M44", ALL, Done, Gear4, true),
        row("M20 P1 L100", ALL, Alarm(195), Wheel, false),
        row("M20 P2 L100", ALL, Done, Coolant, false),
        row("M21 P2", ALL, Done, Coolant, true),
        row("M21 P5", ALL, Alarm(195), Demagnetise, false),
        row("M22 P10", ALL, Alarm(195), Hydraulic, true),
        row("M22 P21", ALL, Done, User1, false).after("M50"),
        // K3.4: the workpiece drive.
        row("M63", GC, Done, HeadstockHigh, true).key(Key::HeadstockHigh, true),
        row("M64", GC, Done, HeadstockLow, true).key(Key::HeadstockLow, true),
        row("M64", GC, Done, HeadstockHigh, false).after("M63").key(Key::HeadstockLow, true),
        row("M65", GC, Done, HeadstockHigh, false).after("M63").key(Key::HeadstockStop, true),
        row("M63", GC, Alarm(184), HeadstockHigh, false).with("param P6.5 1").after("M11").key(Key::HeadstockHigh, false),
        row("M64", GC, Alarm(184), HeadstockLow, false).with("param P6.5 1").after("M11").key(Key::HeadstockLow, false),
        row("M63", GC, Done, HeadstockHigh, true).with("param P6.5 1").key(Key::HeadstockHigh, true),
        row("M63", GC, Done, HeadstockHigh, true).with("param P6.5 1;mdi M11;wait 2 s;param P16.2 0").key(Key::HeadstockHigh, true),
        row("M63", GS, Done, DresserRoll, true).key(Key::DresserRoll, true),
        row("M64", GS, Done, DresserRoll, true),
        row("M65", GS, Done, DresserRoll, false).after("M63").key(Key::DresserRoll, false),
        row("M63", GS, Done, DresserRoll, true).after("M95").key(Key::DresserRoll, true),
        row("M63", GA, Done, TableRotation, true).key(Key::TableRotation, true),
        row("M64", GA, Done, TableRotation, true),
        row("M65", GA, Done, TableRotation, false).after("M63").key(Key::TableRotation, false),
        row("M63", GA, Alarm(187), TableRotation, false).after("M95").key(Key::TableRotation, false),
        row("M64", GA, Alarm(187), TableRotation, false).after("M95"),
        row("M63", GA, Done, TableRotation, true).with(NO_MAGNET).key(Key::TableRotation, true),
        // K3.9, K3.10.
        row("M70", ALL, Done, RadialGauge, true).key(Key::RadialGauge, true),
        row("M75", ALL, Done, RadialGauge, false).after("M70").key(Key::RadialGauge, false),
        row("M78", ALL, Done, AxialGauge, true).key(Key::AxialGauge, true),
        row("M79", ALL, Done, AxialGauge, false).after("M78").key(Key::AxialGauge, false),
        // K3.11, K5.3: the magnet.
        row("M94", GS_GA, Done, Magnetise, true).after("M95").key(Key::Magnetise, true),
        row("M95", GS_GA, Done, Magnetise, false),
        row("M95", GS_GA, Alarm(187), Magnetise, true).after("M03").key(Key::Demagnetise, false),
        row("M95", GA, Alarm(187), Magnetise, true).after("M63").key(Key::Demagnetise, false),
        row("M95", GS, Done, Magnetise, false).after("M63"),
        row("M94", GS_GA, NoEffect, Magnetise, false).with(NO_MAGNET).key(Key::Magnetise, false),
        row("M95", GS_GA, NoEffect, Demagnetise, false).with(NO_MAGNET).key(Key::Demagnetise, false),
        row("M94", GC, Alarm(190), Magnetise, false),
        row("M95", GC, Alarm(190), Demagnetise, false),
        row("M94", GC, Done, Magnetise, true).with("param P16.0 1"),
        row("M95", GC, Done, Demagnetise, false).with("param P16.0 1").after("M94"),
    ]
}

/// Codes whose rows stand in stories of their own (`machine_rules`, `run_control`, `grinding_functions`, the nc tests).
const ELSEWHERE: &[u16] = &[0, 1, 2, 30, 31, 35, 36, 80, 81, 82, 83, 84, 85, 86, 87, 88, 89, 91, 92, 98, 99];

fn begin(row: &Row, kind: Kind) -> HeadlessHost {
    let mut rig = ready_of(kind);
    for line in QUICK.split(';').chain(row.setup.split(';').filter(|line| !line.is_empty())) {
        tell(&mut rig, line);
    }
    rig
}

fn load(rig: &mut HeadlessHost, text: &str) {
    rig.add_program(program_from_bytes(7_000, "O7000.NC", text.as_bytes().to_vec(), rig.kind().dialect()));
    rig.send(Command::LoadProgram(7_000));
    rig.step();
    tell(rig, "mode auto\nkey cycle-start");
}

/// Until the control stands; 20 s are more than any code takes here.
fn settle(rig: &mut HeadlessHost) -> RunState {
    for _ in 0..20_000 {
        rig.step();
        if rig.controller().state() != RunState::Running {
            break;
        }
    }
    for _ in 0..3 {
        rig.step();
    }
    rig.controller().state()
}

fn lines(codes: &str) -> String {
    codes.split(' ').filter(|code| !code.is_empty()).map(|code| format!("{code}\n")).collect()
}

fn judge(row: &Row, rig: &mut HeadlessHost, mode: &str, kind: Kind) {
    let snapshot = rig.snapshot().clone();
    let at = || format!("{} after {:?} with {:?} on {} {mode}", row.code, row.before, row.setup, kind.id());
    let numbers: Vec<_> = snapshot.alarms.iter().map(|alarm| alarm.number).collect();
    match row.comes {
        Alarm(number) => assert!(numbers.contains(&number), "{}: alarms {numbers:?}, not {number}", at()),
        Done | NoEffect | Waits => assert!(numbers.is_empty(), "{}: alarms {numbers:?}", at()),
    }
    if row.comes != Done {
        let said = snapshot.message.tone == Tone::Refused && !snapshot.message.text.zh().is_empty();
        assert!(said, "{}: no reason given", at());
    }
    if let Some((output, on)) = row.output {
        assert_eq!(snapshot.outputs.has(output), on, "{}: output {}", at(), output.id());
        let port = rig.controller().params().output_port(output);
        assert_eq!(rig.controller().outputs().terminals.is_closed(port), on, "{}: port {port}", at());
    }
    if let Some((key, lamp)) = row.key {
        assert_eq!(snapshot.key(key).lamp, lamp, "{}: lamp {}", at(), key.id());
    }
}

fn in_a_run(row: &Row, kind: Kind) {
    let mut rig = begin(row, kind);
    load(&mut rig, &format!("{}{}\nM00\nM30", lines(row.before), row.code));
    let state = settle(&mut rig);
    let expected = match row.comes {
        Done | NoEffect => RunState::Stopped,
        Waits => RunState::Held,
        Alarm(_) => RunState::Alarm,
    };
    assert_eq!(state, expected, "{} after {:?} with {:?} on {}", row.code, row.before, row.setup, kind.id());
    judge(row, &mut rig, "in a run", kind);
}

fn in_mdi(row: &Row, kind: Kind) {
    let mut rig = begin(row, kind);
    for code in row.before.split(' ').filter(|code| !code.is_empty()).chain([row.code]) {
        tell(&mut rig, &format!("mdi {code}"));
        settle(&mut rig);
    }
    judge(row, &mut rig, "in MDI", kind);
}

fn by_key(row: &Row, kind: Kind, held: bool) {
    let Some((key, _)) = row.key else { return };
    let mut rig = begin(row, kind);
    load(&mut rig, &format!("{}M00\nG04 X60\nM30", lines(row.before)));
    settle(&mut rig);
    if held {
        tell(&mut rig, "key cycle-start\nwait 0.1 s\nkey feed-hold\nexpect state held");
    } else {
        // The drive goes with RESET (table after K3): it is started again by its code.
        tell(&mut rig, "key reset\nmode jog");
        for code in row.before.split(' ').filter(|code| matches!(*code, "M63" | "M64")) {
            tell(&mut rig, &format!("mdi {code}"));
            settle(&mut rig);
        }
    }
    tell(&mut rig, &format!("key {}", key.id()));
    // Outputs and lamps answer at once; the pressure that falls after M15 is no matter of this table.
    for _ in 0..50 {
        rig.step();
    }
    judge(row, &mut rig, if held { "by key in a hold" } else { "by key in manual" }, kind);
}

#[test]
fn k3_every_code_has_its_row_on_every_kind() {
    let rows = table();
    for code in MCODES.iter().filter(|code| !ELSEWHERE.contains(&code.code)) {
        for kind in Kind::kt830() {
            let name = format!("M{:02}", code.code);
            let there = |row: &Row| row.code.split(' ').next() == Some(&name) && row.kinds.contains(&kind);
            assert!(rows.iter().any(there), "{name} has no row on {}", kind.id());
        }
    }
}

fn check_kind(kind: Kind) {
    for row in table().iter().filter(|row| row.kinds.contains(&kind)) {
        in_a_run(row, kind);
        in_mdi(row, kind);
        by_key(row, kind, true);
        by_key(row, kind, false);
    }
}

#[test]
fn k3_the_table_holds_on_gc() {
    check_kind(Kind::Gc);
}

#[test]
fn k3_the_table_holds_on_gs() {
    check_kind(Kind::Gs);
}

#[test]
fn k3_the_table_holds_on_ga() {
    check_kind(Kind::Ga);
}

#[test]
fn k3_13_each_of_m80_to_m89_waits_for_its_own_input_on_every_kind() {
    const USERS: [Input; 10] = [
        Input::User1,
        Input::User2,
        Input::User3,
        Input::User4,
        Input::User5,
        Input::User6,
        Input::User7,
        Input::User8,
        Input::User9,
        Input::User10,
    ];
    for kind in Kind::kt830() {
        for (index, input) in USERS.iter().enumerate() {
            let mut rig = ready_of(kind);
            load(&mut rig, &format!("M{}\nM00\nM30", 80 + index));
            assert_eq!(settle(&mut rig), RunState::Waiting, "M{} on {}", 80 + index, kind.id());
            let port = rig.controller().params().input_port(*input).to_string();
            let said = rig.snapshot().waiting_for.clone();
            assert!(said.is_some_and(|said| said.zh().contains(&port)), "the port is named");
            let other = USERS[(index + 1) % USERS.len()];
            tell(&mut rig, &format!("input {} on\nexpect state waiting", other.id()));
            tell(&mut rig, &format!("input {} on\nwait until stopped max 1 s", input.id()));
        }
    }
}
