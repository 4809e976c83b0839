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

#[test]
fn every_planted_bug_is_noticed() {
    let missed: Vec<PlantedBug> = PlantedBug::ALL.into_iter().filter(|bug| !is_noticed(*bug)).collect();
    assert_eq!(missed, []);
}

fn is_noticed(bug: PlantedBug) -> bool {
    (0..COURSES).any(|seed| {
        let kind = if bug == PlantedBug::MagnetIgnoresWheel { Kind::Gs } else { Kind::Gc };
        let course = torture(case(kind, seed, Some(bug))).unwrap();
        let differs = || replay(case(kind, seed, Some(bug)), &course.lines).unwrap().trace != course.trace;
        // What the control does without the bug is the first test's business: these courses hold.
        let noticed = course.violation.is_some() || bug == PlantedBug::CourseIsRandom && differs();
        if noticed {
            println!("{bug:?}, course {seed}: {}", course.violation.unwrap_or_default());
        }
        noticed
    })
}
