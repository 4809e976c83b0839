//! Torture with a fixed budget: random operators, faults and power cuts on every kind of machine; the same seed gives the
//! same course; and every planted bug is noticed. Source: safety stance; spec K2, K3, K5, B3, K4.2.

#![allow(clippy::print_stdout, clippy::unwrap_used, reason = "a test driver: a failure is the message")]

use kt830::defs::kind::Kind;
use kt830::torture::{PlantedBug, TortureCase, replay, torture};
use kt830::units::Micros;

/// Simulated time of a course.
const SPAN: Micros = Micros::from_millis(20 * 60_000);
/// Most courses until a planted bug must be noticed.
const COURSES: u64 = 12;

fn case(kind: Kind, seed: u64, bug: Option<PlantedBug>) -> TortureCase {
    TortureCase { kind, seed, span: SPAN, bug }
}

#[test]
fn k3_random_courses_keep_every_invariant_on_every_kind() {
    for kind in Kind::ALL {
        for seed in [1, 2] {
            let course = torture(case(kind, seed, None)).unwrap();
            assert_eq!(course.violation, None, "{} seed {seed}", kind.id());
            assert!(course.counts.ticks >= 1_200_000 && course.counts.power_cuts > 2, "{:?}", course.counts);
        }
    }
}

#[test]
fn b3_the_same_story_gives_the_same_course_bit_for_bit() {
    for kind in Kind::ALL {
        let course = torture(case(kind, 3, None)).unwrap();
        let again = replay(case(kind, 3, None), &course.lines).unwrap();
        assert_eq!((course.trace, course.violation), (again.trace, again.violation), "{}", kind.id());
    }
}

/// A story that leads to a bug which random courses meet too seldom.
fn story_of(bug: PlantedBug) -> Option<(Kind, &'static str)> {
    Some(match bug {
        PlantedBug::BlindToPressure => {
            (Kind::Gc, "key hydraulic\nwait 4 s\nkey wheel-start\nwait 1 s\nfault pressure-loss\nwait 3 s")
        }
        PlantedBug::BlindToGuard => (
            Kind::Gc,
            "param P332 60\nkey hydraulic\nwait 4 s\ninput guard-closed off\nwait 1 s\nkey wheel-start\nwait 1 s",
        ),
        PlantedBug::DrivesStayOn => (Kind::Gc, "input emergency-stop on\nwait 3 s"),
        PlantedBug::MagnetIgnoresWheel => {
            (Kind::Gs, "key hydraulic\nkey magnetise\nwait 4 s\nkey wheel-start\nwait 1 s\nkey demagnetise\nwait 1 s")
        }
        PlantedBug::HoldEndsByItself => {
            (Kind::Gc, "key hydraulic\nwait 4 s\nhome all\nmdi G01 U-20 F100\nkey feed-hold\nwait 4 s")
        }
        PlantedBug::JogKeySticks => (Kind::Gc, "mode jog\nhold X- 500 ms\nwait 4 s"),
        PlantedBug::DamageIsSilent => {
            (Kind::Gc, "set #500 = 1\nwait 1 s\ndisk flips 4000\npower cut\nwait 1 s\npower on\nwait 2 s")
        }
        _ => return None,
    })
}

#[test]
fn every_planted_bug_is_noticed() {
    let missed: Vec<PlantedBug> = PlantedBug::ALL.into_iter().filter(|bug| !is_noticed(*bug)).collect();
    assert_eq!(missed, []);
}

fn is_noticed(bug: PlantedBug) -> bool {
    let Some((kind, story)) = story_of(bug) else { return is_noticed_in_courses(bug) };
    let lines: Vec<String> = story.lines().map(str::to_owned).collect();
    let without = replay(case(kind, 1, None), &lines).unwrap();
    assert_eq!(without.violation, None, "{bug:?}: the story without the bug");
    let course = replay(case(kind, 1, Some(bug)), &lines).unwrap();
    println!("{bug:?}: {}", course.violation.as_deref().unwrap_or("not noticed"));
    course.violation.is_some()
}

fn is_noticed_in_courses(bug: PlantedBug) -> bool {
    (0..COURSES).any(|seed| {
        let course = torture(case(Kind::Gc, seed, Some(bug))).unwrap();
        let differs = || replay(case(Kind::Gc, seed, Some(bug)), &course.lines).unwrap().trace != course.trace;
        let noticed = course.violation.is_some() || bug == PlantedBug::CourseIsRandom && differs();
        if noticed {
            println!("{bug:?}, course {seed}: {}", course.violation.unwrap_or_default());
        }
        noticed
    })
}
