//! Torture with a fixed budget: random operators, faults and power cuts on every kind of machine; the same seed gives the
//! same course; and every planted bug is noticed. Source: safety stance; spec K2, K3, K5, B3, K4.2.

#![allow(clippy::print_stdout, clippy::unwrap_used, reason = "a test driver: a failure is the message")]

use kt830::defs::key::Key;
use kt830::defs::kind::Kind;
use kt830::defs::signal::Output;
use kt830::torture::{PlantedBug, TortureCase, TortureCourse, replay, torture};
use kt830::units::Micros;

/// Simulated time of a course.
const SPAN: Micros = Micros::from_millis(20 * 60_000);
/// Most courses until a planted bug must be noticed.
const COURSES: u64 = 12;

/// Simulated time of a course that is run twice.
const SHORT_SPAN: Micros = Micros::from_millis(5 * 60_000);

fn case(kind: Kind, seed: u64, bug: Option<PlantedBug>) -> TortureCase {
    TortureCase { kind, seed, span: SPAN, bug }
}

#[test]
fn k3_random_courses_keep_every_invariant_on_every_kind() {
    for kind in Kind::ALL {
        let course = torture(case(kind, 1, None)).unwrap();
        assert_eq!(course.violation, None, "{}", kind.id());
        let counts = course.counts;
        assert!(counts.ticks >= 1_200_000 && counts.power_cuts > 2 && counts.runs > 2, "{counts:?}");
    }
}

#[test]
fn b3_the_same_story_gives_the_same_course_bit_for_bit() {
    for kind in Kind::ALL {
        let short = TortureCase { span: SHORT_SPAN, ..case(kind, 3, None) };
        let course = torture(short).unwrap();
        let again = replay(short, &course.lines).unwrap();
        let told = |course: TortureCourse| (course.trace, course.written, course.violation);
        assert_eq!(told(course), told(again), "{}", kind.id());
    }
}

/// Further rules that a planted bug breaks, each with a story.
fn more_cases() -> Vec<(PlantedBug, &'static str, Kind, &'static str)> {
    use PlantedBug as Bug;
    vec![
        (Bug::BlindToScreen, "the drives are on without a screen", Kind::Gc, "wait 1 s\nscreen hangs 9 s\nwait 8 s"),
        (
            Bug::BlindToGuard,
            "turns in a run with the guard open",
            Kind::Gc,
            "param P332 60\nunlock program 187350\nmode edit\nwait 1 s\nwrite O2001 \"M63\\nG04 X20\\nM30\"\nwait 1 s\nload O2001\n\
             home all\nmode auto\nkey cycle-start\nwait 4 s\ninput guard-closed off\nwait 2 s",
        ),
        (
            Bug::KeyForces(Key::WheelStart, &[(Output::Wheel, true)]),
            "the wheel starts unmagnetised",
            Kind::Gs,
            "key hydraulic\nwait 4 s\nkey wheel-start\nwait 1 s",
        ),
    ]
}

/// What a planted bug is noticed by; and a short story that leads to it, where random courses meet it too seldom or break
/// another rule before.
fn expected(bug: PlantedBug) -> (&'static str, Kind, &'static str) {
    use PlantedBug as Bug;
    let in_courses = |rule| (rule, Kind::Gc, "");
    match bug {
        Bug::BlindToEmergencyStop => {
            ("the drives stay on in an emergency stop", Kind::Gc, "input emergency-stop on\nwait 3 s")
        }
        Bug::BlindToPressure => (
            "the wheel runs on without pressure",
            Kind::Gc,
            "key hydraulic\nwait 4 s\nkey wheel-start\nwait 1 s\nfault pressure-loss\nwait 3 s",
        ),
        Bug::BlindToScreen => (
            "wheel is on without a screen",
            Kind::Gc,
            "key hydraulic\nwait 4 s\nkey wheel-start\nwait 1 s\nscreen hangs 5 s\nwait 4 s",
        ),
        Bug::BlindToGuard => (
            "the wheel starts with the guard open",
            Kind::Gc,
            "param P332 60\nkey hydraulic\nwait 4 s\ninput guard-closed off\nwait 1 s\nkey wheel-start\nwait 1 s",
        ),
        Bug::WheelStaysOn => (
            "wheel is on in an emergency stop",
            Kind::Gc,
            "key hydraulic\nwait 4 s\nkey wheel-start\nwait 1 s\ninput emergency-stop on\nwait 1 s",
        ),
        Bug::CoolantStaysOn => {
            ("coolant is on in an emergency stop", Kind::Gc, "key coolant\nwait 1 s\ninput emergency-stop on\nwait 1 s")
        }
        Bug::EmergencyStopUnclamps => (
            "tailstock changes by the emergency stop",
            Kind::Gc,
            "key hydraulic\nwait 4 s\nkey tailstock-advance\nwait 4 s\ninput emergency-stop on\nwait 1 s",
        ),
        Bug::DrivesStayOn => ("the drives stay on in an emergency stop", Kind::Gc, "input emergency-stop on\nwait 3 s"),
        Bug::WheelStartsByItself => ("wheel starts by itself", Kind::Gc, "key hydraulic\nwait 61 s"),
        Bug::WheelIgnoresHydraulics => {
            ("the wheel starts without hydraulics", Kind::Gc, "wait 1 s\nkey wheel-start\nwait 1 s")
        }
        Bug::BothHeadstockSpeeds => in_courses("headstock-high is on together with its opposite"),
        Bug::HydraulicsIgnoreWheel => (
            "the pump switches while the wheel runs",
            Kind::Gc,
            "key hydraulic\nwait 4 s\nkey wheel-start\nwait 1 s\nkey hydraulic\nwait 1 s",
        ),
        Bug::MagnetIgnoresWheel => (
            "magnetise is on together with its opposite",
            Kind::Gs,
            "key hydraulic\nkey magnetise\nwait 4 s\nkey wheel-start\nwait 1 s\nkey demagnetise\nwait 1 s",
        ),
        Bug::AxisCreeps | Bug::AxisRunsOn => ("without a cause", Kind::Gc, "mode jog\nhold X- 500 ms\nwait 4 s"),
        Bug::AxisIsFast => {
            ("above its rapid speed", Kind::Gc, "home all\nwait 10 s\nmode jog\nkey rapid-100\nkey rapid\nhold X- 3 s")
        }
        Bug::AxisJumps => in_courses("X accelerates by"),
        Bug::SoftLimitIsLate => {
            ("beyond its soft limit", Kind::Gc, "param P42 -10\nhome all\nwait 10 s\nmode jog\nhold X- 60 s")
        }
        Bug::HoldEndsByItself => (
            "without the operator",
            Kind::Gc,
            "key hydraulic\nwait 4 s\nhome all\nmdi G01 U-20 F100\nkey feed-hold\nwait 4 s",
        ),
        Bug::ResumesAfterPowerOn => (
            "without the operator",
            Kind::Gc,
            "unlock program 187350\nmode edit\nwait 1 s\nwrite O2001 \"G04 X20\\nM30\"\nwait 1 s\nload O2001\nhome all\nmode auto\nkey cycle-start\nwait 1 s\npower cut\nwait 1 s\npower on\nhome all\n\
             mode auto\nwait 2 s",
        ),
        Bug::TailstockIgnoresHeadstock => (
            "the tailstock moves while the headstock turns",
            Kind::Gc,
            "key hydraulic\nwait 4 s\nkey tailstock-advance\nwait 4 s\nkey headstock-high\nwait 1 s\n\
             key tailstock-retract\nwait 1 s",
        ),
        Bug::AxisStopsDead => ("X accelerates by", Kind::Gc, "mode jog\nhold X- 500 ms\nwait 4 s"),
        Bug::JogKeySticks => ("without a cause", Kind::Gc, "mode jog\nhold X- 500 ms\nwait 4 s"),
        Bug::SlowJogIsFast => (
            "X is jogged minus at",
            Kind::Gc,
            "param P332 0\nkey hydraulic\nwait 4 s\nkey wheel-start\nwait 2 s\nmode jog\nhold X- 3 s",
        ),
        Bug::OutputsOutliveThePower => ("on without power", Kind::Gc, "key coolant\nwait 1 s\npower cut\nwait 1 s"),
        Bug::StorageDropsARequest | Bug::StorageRoundsValues => in_courses("stored is not what is in force"),
        // What is looked at first, a minute after a change or at a power cut, is chance.
        Bug::StorageSwapsBatches => in_courses("stored is not what is in force | after the power cut"),
        Bug::StorageAcknowledgesEarly | Bug::DiskIgnoresFolderFlushes => in_courses("after the power cut"),
        // Bytes that were never flushed: a file is lost, or the database is torn.
        Bug::DiskIgnoresFileFlushes => in_courses("after the power cut | a power cut has damaged the data"),
        Bug::DamageIsSilent => (
            "without an alarm",
            Kind::Gc,
            "set #500 = 1\nwait 1 s\ndisk flips 4000\npower cut\nwait 1 s\npower on\nwait 2 s",
        ),
        Bug::CopyLagsBehind => (
            "after the power cut #501 is",
            Kind::Gc,
            "set #501 = 1\nwait 1 s\ndisk flips 4000\npower cut\nwait 1 s\npower on\nwait 2 s",
        ),
        Bug::HeadstockOutlivesReset => (
            "headstock-high is on after RESET",
            Kind::Gc,
            "param P332 0\nkey headstock-high\nwait 1 s\nkey reset\nwait 1 s",
        ),
        Bug::CoolantOutlivesTheProgram => (
            "coolant stays on after M30",
            Kind::Gc,
            "unlock program 187350\nmode edit\nwait 1 s\nwrite O2001 \"M08\\nG04 X2\\nM30\"\nwait 1 s\nload O2001\n\
             home all\nmode auto\nkey cycle-start\nwait 4 s",
        ),
        Bug::WheelOutlivesTheProgram => (
            "wheel stays on after M30",
            Kind::Gc,
            "unlock program 187350\nmode edit\nwait 1 s\nwrite O2001 \"M03\\nG04 X2\\nM30\"\nwait 1 s\nload O2001\n\
             key hydraulic\nwait 4 s\nhome all\nmode auto\nkey cycle-start\nwait 12 s",
        ),
        Bug::ResetStopsCoolant => ("coolant changes by RESET", Kind::Gc, "key coolant\nwait 1 s\nkey reset\nwait 1 s"),
        Bug::HeadstockIgnoresGuard => (
            "headstock-high starts with the guard open",
            Kind::Gc,
            "param P332 60\ninput guard-closed off\nwait 1 s\nkey headstock-high\nwait 1 s",
        ),
        Bug::TableIgnoresMagnet => {
            ("the table starts unmagnetised", Kind::Ga, "wait 1 s\nkey table-rotation\nwait 1 s")
        }
        Bug::OutputsOutliveTheBus => (
            "wheel is on without the bus",
            Kind::Gc,
            "key hydraulic\nwait 4 s\nkey wheel-start\nwait 1 s\nfault bus-silent 200\nwait 1 s",
        ),
        Bug::KeyForces(Key::WheelStart, _) => (
            "the wheel starts without pressure",
            Kind::Gc,
            "key hydraulic\nwait 4 s\nfault pressure-loss\nwait 1 s\nkey wheel-start\nwait 1 s",
        ),
        Bug::KeyForces(Key::HeadstockHigh, _) => (
            "the headstock starts while the tailstock moves",
            Kind::Gc,
            "key hydraulic\nwait 4 s\nkey tailstock-advance\nwait 4 s\nkey tailstock-retract\nwait 100 ms\nkey headstock-high\nwait 1 s",
        ),
        Bug::KeyForces(Key::Demagnetise, [_]) => (
            "the part is released while the wheel runs",
            Kind::Gs,
            "key hydraulic\nkey magnetise\nwait 4 s\nkey wheel-start\nwait 1 s\nkey demagnetise\nwait 1 s",
        ),
        Bug::KeyForces(Key::Demagnetise, _) => (
            "the part is released while the table turns",
            Kind::Ga,
            "key hydraulic\nkey magnetise\nwait 4 s\nkey table-rotation\nwait 1 s\nkey demagnetise\nwait 1 s",
        ),
        Bug::KeyForces(..) => (
            "coolant starts before RESET",
            Kind::Gc,
            "wait 1 s\ninput emergency-stop on\nwait 1 s\ninput emergency-stop off\nwait 1 s\nkey coolant\nwait 1 s",
        ),
        Bug::PumpStartsByPowerOn => ("an output comes on by power-on alone", Kind::Gc, "wait 2 s"),
        Bug::DrivesGoOnElsewhere => (
            "X jumps when the drives go on",
            Kind::Gc,
            "wait 1 s\ninput emergency-stop on\nwait 2 s\ninput emergency-stop off\nwait 1 s\nkey reset\nwait 2 s",
        ),
        Bug::ModeChangesInRun => (
            "the mode changes in a run",
            Kind::Gc,
            "unlock program 187350\nmode edit\nwait 1 s\nwrite O2001 \"G04 X3\\nM30\"\nwait 1 s\nload O2001\nhome all\nmode auto\n\
             key cycle-start\nwait 2 s",
        ),
        Bug::StartIgnoresOscillation => (
            "a run starts while an axis oscillates by the key",
            Kind::Gc,
            "unlock program 187350\nmode edit\nwait 1 s\nwrite O2001 \"G04 X3\\nM30\"\nwait 1 s\nload O2001\nhome all\nmode auto\n\
             key cycle-start\nwait 2 s",
        ),
        Bug::RunOutlivesReset => (
            "a run goes on after RESET",
            Kind::Gc,
            "unlock program 187350\nmode edit\nwait 1 s\nwrite O2001 \"G04 X9\\nM30\"\nwait 1 s\nload O2001\nhome all\nmode auto\n\
             key cycle-start\nwait 2 s\nkey reset\nwait 2 s",
        ),
        Bug::TickDoesTooMuch => ("a tick has cost", Kind::Gc, "home all\nmode mdi\nmdi G01 X-5 F100\nwait 2 s"),
        Bug::RequestsPileUp => ("requests wait for storage", Kind::Gc, "wait 1 s"),
        Bug::LampLies => ("K2.4: the lamp of", Kind::Gc, "wait 5 s"),
        Bug::PositionIsNoNumber => ("a position is no number", Kind::Gc, "wait 5 s"),
        Bug::AlarmHasNoText => {
            ("alarms, or one without a text", Kind::Gc, "wait 1 s\ninput emergency-stop on\nwait 5 s")
        }
        Bug::ValueIsNotHandedOver => {
            ("in force is not what was stored", Kind::Gc, "key hydraulic\nwait 4 s\nkey reset\nwait 90 s")
        }
        Bug::DatabaseIsTorn => {
            ("the database is not whole", Kind::Gc, "key hydraulic\nwait 4 s\nkey reset\nset #500 = 1\nwait 90 s")
        }
        Bug::CopyIsTorn => {
            ("the copy is not what is stored", Kind::Gc, "key hydraulic\nwait 4 s\nkey reset\nset #500 = 1\nwait 90 s")
        }
        Bug::SavedProgramIsLost => (
            "is lost or altered after the power cut",
            Kind::Gc,
            "unlock program 187350\nmode edit\nwait 1 s\nwrite O2001 \"M08\\nM30\"\nwait 1 s\npower cut\nwait 1 s\npower on\nwait 1 s",
        ),
        Bug::LockOutlivesThePower => {
            ("the control does not start again", Kind::Gc, "wait 1 s\npower cut\nwait 1 s\npower on\nwait 1 s")
        }
        Bug::PowerCutDamages => {
            ("a power cut has damaged the data", Kind::Gc, "wait 1 s\npower cut\nwait 1 s\npower on\nwait 1 s")
        }
        Bug::CourseIsRandom => in_courses("another course"),
    }
}

#[test]
fn every_planted_bug_is_noticed_by_the_rule_that_it_breaks() {
    let cases = PlantedBug::ALL.into_iter().map(|bug| {
        let (rule, kind, story) = expected(bug);
        (bug, rule, kind, story)
    });
    let missed: Vec<String> = cases.chain(more_cases()).filter_map(|case| missed(case).err()).collect();
    assert!(missed.is_empty(), "{missed:#?}");
}

/// Every rule is noticed once at least: a rule that nothing breaks may be one that cannot be broken.
#[test]
fn every_rule_is_broken_by_a_planted_bug() {
    let shown: Vec<&str> = PlantedBug::ALL
        .map(|bug| expected(bug).0)
        .into_iter()
        .chain(more_cases().into_iter().map(|case| case.1))
        .collect();
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/src/torture/invariants");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let stage = concat!(env!("CARGO_MANIFEST_DIR"), "/src/torture/stage.rs").into();
    let mut rules = 0;
    for file in files.chain([stage]) {
        let text = std::fs::read_to_string(&file).unwrap();
        for call in ["hold(\"", "hold_output(\"", "Err(\"", "format!(\""] {
            for behind in text.split(call).skip(1) {
                let rule = behind.split('"').next().unwrap();
                // A part without a value is enough.
                let mut parts = rule.split(['{', '}']).map(str::trim).filter(|part| part.len() > 7).peekable();
                if parts.peek().is_none() || NO_RULES.iter().any(|none| rule.contains(none)) {
                    continue;
                }
                rules += 1;
                let is_shown = |part: &str| shown.iter().any(|shown| shown.contains(part) || part.contains(shown));
                assert!(parts.any(is_shown), "{rule:?}");
            }
        }
    }
    assert!(rules >= 45, "{rules} rules");
}

/// Texts that tell of no rule of their own.
const NO_RULES: [&str; 1] = ["simulated disk:"];

fn missed((bug, rule, kind, story): (PlantedBug, &'static str, Kind, &'static str)) -> Result<(), String> {
    if story.is_empty() {
        return missed_in_courses(bug, rule);
    }
    let lines: Vec<String> = story.lines().map(str::to_owned).collect();
    let without = replay(case(kind, 1, None), &lines).unwrap();
    assert_eq!(without.violation, None, "{bug:?}: the story without the bug");
    let found = replay(case(kind, 1, Some(bug)), &lines).unwrap().violation.unwrap_or_default();
    println!("{bug:?}: {found}");
    if found.contains(rule) { Ok(()) } else { Err(format!("{bug:?}: {found}")) }
}

/// The first course that breaks a rule breaks this one.
fn missed_in_courses(bug: PlantedBug, rule: &str) -> Result<(), String> {
    for seed in 1..=COURSES {
        // Two courses differ from their first minute on.
        let span = if bug == PlantedBug::CourseIsRandom { SHORT_SPAN } else { SPAN };
        let case = TortureCase { span, ..case(Kind::Gc, seed, Some(bug)) };
        let course = torture(case).unwrap();
        let mut found = course.violation.unwrap_or_default();
        if bug == PlantedBug::CourseIsRandom && replay(case, &course.lines).unwrap().trace != course.trace {
            found = "another course".to_owned();
        }
        println!("{bug:?}, course {seed}: {found}");
        match found.as_str() {
            "" => continue,
            found if rule.split(" | ").any(|rule| found.contains(rule)) => return Ok(()),
            found => return Err(format!("{bug:?}, course {seed}: {found}")),
        }
    }
    Err(format!("{bug:?}: not in {COURSES} courses"))
}
