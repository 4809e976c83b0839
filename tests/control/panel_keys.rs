//! No key of any panel is silent: with the real core and the simulated machine behind it, every key of every kind either
//! changes something that the operator sees or says why it does not. The keys come from the key table, the modes from the
//! mode table; a new one is looked at as well. Source: spec K2.1, K2.2, K2.4.

use kt830::defs::equipment::Equipment;
use kt830::defs::key::{Key, KeyGroup, Mode};
use kt830::defs::kind::{Dialect, Kind};
use kt830::defs::page::Page;
use kt830::defs::soft_key::CoordinateView;
use kt830::host::folders::{Folders, program_from_bytes};
use kt830::host::headless::HeadlessHost;
use kt830::link::{Command, Snapshot};
use kt830::units::Axis;

/// A place that a machine is in when a key is pressed: the words that lead there from a cold start or a ready machine.
struct Place {
    name: String,
    ready: bool,
    story: String,
}

fn place(name: &str, ready: bool, story: &str) -> Place {
    Place { name: name.to_owned(), ready, story: story.to_owned() }
}

const MODE_WORDS: [&str; 7] = ["edit", "auto", "mdi", "home", "handwheel", "step", "jog"];

/// Where the wheel runs: what has to be on before.
fn wheel_on(kind: Kind) -> &'static str {
    if kind.is_lathe() {
        "mode jog\nkey spindle-forward\nwait 0.2 s"
    } else if kind.row().has(Equipment::MagneticChuck) {
        "mode jog\nkey magnetise\nwait 2 s\nkey wheel-start\nwait 0.2 s"
    } else {
        "mode jog\nkey wheel-start\nwait 0.2 s"
    }
}

/// A program that is under way for a minute and stops by itself in between.
const fn long_program(kind: Kind) -> (&'static str, &'static str) {
    match kind.dialect() {
        Dialect::Sinumerik => ("O7000.MPF", "G4 F60\nM0\nM30\n"),
        Dialect::SuperMan => ("O7000.NC", "N0010G04F60\nN0020M00\nN0030M02\n"),
        Dialect::LatheA | Dialect::Mill => ("O7000.NC", "G04 P60000\nM00\nM30\n"),
    }
}

fn places(kind: Kind) -> Vec<Place> {
    assert_eq!(MODE_WORDS.map(|word| Mode::from_id(word).unwrap()), Mode::ALL);
    let mut places = Vec::new();
    for mode in MODE_WORDS {
        places.push(place(&format!("cold, mode {mode}"), false, &format!("mode {mode}")));
        places.push(place(&format!("ready, mode {mode}"), true, &format!("mode {mode}")));
    }
    let first = if kind.row().wheel_axis == Axis::Y { "y-plus" } else { "x-plus" };
    let run = "mode auto\nload O7000\nkey cycle-start\nwait 0.1 s\nexpect state running\n";
    places.extend([
        place("wheel on", true, wheel_on(kind)),
        place("running", true, run),
        place("held", true, &format!("{run}key feed-hold\nwait 0.1 s\nexpect state held")),
        place("held, handwheel", true, &format!("{run}key feed-hold\nwait 0.1 s\nmode handwheel\nexpect state held")),
        place("emergency stop", true, "key emergency-stop\nwait 0.1 s\nexpect alarm 0"),
        place("homing", false, &format!("mode home\nkey {first}\nwait 0.1 s\nexpect state homing")),
        place("locked", true, "mode jog\nkey machine-lock"),
        place("overrides at their most", true, &"key feed-override-up\nkey spindle-override-up\n".repeat(10)),
        place(
            "overrides at their least",
            true,
            &"mode jog\nkey feed-override-down\nkey spindle-override-down\n".repeat(16),
        ),
    ]);
    if !kind.is_lathe() {
        let start = "mode auto\nload O7000\nkey cycle-start\nwait 0.1 s\nexpect alarm 100";
        places.push(place("not homed: alarm 100", false, start));
        places.push(place("dressing point lit", true, "mode jog\nkey dress-return"));
        places.push(place("hydraulic on", false, "key hydraulic\nwait 0.1 s"));
    }
    places
}

fn rig_at(kind: Kind, folders: &Folders, place: &Place) -> HeadlessHost {
    let mut rig = crate::stories::rig_of(kind, folders.clone());
    if place.ready {
        rig.make_ready();
    }
    let (name, text) = long_program(kind);
    rig.add_program(program_from_bytes(7_000, name, text.as_bytes().to_vec(), rig.kind().dialect()));
    crate::stories::tell(&mut rig, &place.story);
    (0..5).for_each(|_| rig.step());
    rig
}

/// What the operator sees change besides the axes: everything that has a lamp, a place in the frame or a page.
fn seen(snapshot: &Snapshot) -> String {
    let lamps: Vec<(bool, bool)> = snapshot.keys.iter().map(|key| (key.lamp, key.pending)).collect();
    let alarms: Vec<u16> = snapshot.alarms.iter().map(|alarm| alarm.number).collect();
    let overrides = (snapshot.overrides.feed, snapshot.overrides.rapid, snapshot.overrides.spindle);
    let rows = (snapshot.coordinates, snapshot.soft_key_row);
    let switches = (snapshot.key(Key::SingleBlock).lamp, snapshot.handwheel.axis, snapshot.handwheel.step_mm.to_bits());
    format!(
        "{:?}",
        (snapshot.page, rows, snapshot.mode, snapshot.state, overrides, switches, snapshot.outputs, lamps, alarms)
    )
}

fn stands(snapshot: &Snapshot) -> [u64; 3] {
    Axis::ALL.map(|axis| (snapshot.axes[axis].machine * 1e4).round().to_bits())
}

/// Presses a key for 80 ms, holding it as a finger does; gives why that was silent, if it was.
fn silent(rig: &mut HeadlessHost, key: Key) -> Option<String> {
    let before = rig.snapshot().clone();
    rig.send(Command::Press(key));
    for tick in 0..120 {
        rig.step();
        match tick {
            80 => rig.send(Command::Release(key)),
            0..80 if tick % 40 == 39 && key.jog_direction().is_some() => rig.send(Command::StillHeld(key)),
            _ => {}
        }
    }
    let after = rig.snapshot();
    let told = after.message != before.message && !after.message.text.zh().is_empty();
    let moved = key.jog_direction().is_some() && stands(after) != stands(&before);
    let changed = seen(after) != seen(&before);
    match before.key(key).blocked {
        Some(reason) if !told => Some(format!("is shown blocked ({}) and says nothing", reason.en)),
        Some(_) | None => (!told && !moved && !changed).then(|| "is silent".to_owned()),
    }
}

fn check(kinds: &[Kind]) {
    let folder = tempfile::tempdir().unwrap();
    let folders = Folders {
        programs: folder.path().to_owned(),
        screens: folder.path().to_owned(),
        by_name: false,
        dialect: Dialect::LatheA,
    };
    let mut wrong = Vec::new();
    for kind in kinds {
        for place in places(*kind) {
            let mut still = rig_at(*kind, &folders, &place);
            let before = seen(still.snapshot());
            (0..120).for_each(|_| still.step());
            assert_eq!(seen(still.snapshot()), before, "{kind:?} {}: something changes by itself", place.name);
            for key in Key::ALL.iter().copied().filter(|key| key.exists_on(*kind)) {
                let mut rig = rig_at(*kind, &folders, &place);
                if let Some(why) = silent(&mut rig, key) {
                    wrong.push(format!("{kind:?} · {} · {} {why}", place.name, key.id()));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{} silent keys:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn k2_4_no_key_of_the_cylindrical_grinder_is_silent() {
    check(&[Kind::Gc]);
}

#[test]
fn k2_4_no_key_of_the_surface_grinder_is_silent() {
    check(&[Kind::Gs]);
}

#[test]
fn k2_4_no_key_of_the_rotary_table_grinder_is_silent() {
    check(&[Kind::Ga]);
}

#[test]
fn k2_4_no_key_of_the_lathes_is_silent() {
    check(&[Kind::Vertical, Kind::Lathe]);
}

/// Every key has one place: on the panel, or on the screen beside it.
#[test]
fn k2_1_every_key_of_a_kind_is_a_key_of_the_panel_or_of_the_screen() {
    for kind in Kind::ALL {
        let keys: Vec<Key> = Key::ALL.iter().copied().filter(|key| key.exists_on(kind)).collect();
        let panel = keys.iter().filter(|key| key.row().group != KeyGroup::Screen).count();
        assert!(panel >= 44 && keys.len() > panel, "{kind:?}: {panel} of {}", keys.len());
    }
}

/// K7.1: F1 相对, F2 综合, F3 机床, F4 磨削, F5 砂轮修整; ▶ turns to the second row, whose keys then act.
#[test]
fn k7_1_the_soft_keys_of_a_story_are_those_of_the_screen() {
    let mut rig = crate::stories::rig();
    let is = |rig: &mut HeadlessHost| (rig.snapshot().page, rig.snapshot().coordinates, rig.snapshot().soft_key_row);
    crate::stories::tell(&mut rig, "page position");
    assert_eq!(is(&mut rig), (Page::Position, CoordinateView::All, 0));
    for (key, coordinates) in [
        ("f1", CoordinateView::Relative),
        ("f3", CoordinateView::Machine),
        ("f2", CoordinateView::All),
        ("f1", CoordinateView::Relative),
    ] {
        crate::stories::tell(&mut rig, &format!("key {key}"));
        assert_eq!(is(&mut rig), (Page::Position, coordinates, 0), "{key}");
    }
    crate::stories::tell(&mut rig, "key f1\nexpect message \"已是“相对”\"");
    for (row, keys, page) in [
        (0, "key f4", Page::Grinding),
        (0, "key f5", Page::Dressing),
        (1, "key next-row\nkey f1", Page::Params),
        (1, "key next-row\nkey f2", Page::Diagnosis),
        (1, "key next-row\nkey f3", Page::Graphic),
        (1, "key next-row\nkey f4", Page::Transfer),
        (2, "key next-row\nkey next-row\nkey f1", Page::Program),
    ] {
        crate::stories::tell(&mut rig, &format!("page position\n{keys}"));
        assert_eq!(rig.snapshot().page, page, "row {row}: {keys}");
    }
    crate::stories::tell(&mut rig, "page position\nkey next-row\nkey f5\nexpect message \"屏幕打印\"");
    // From the second row: the fifth begins with simulator and bus, then comes the first.
    crate::stories::tell(&mut rig, "key next-row\nkey next-row\nkey next-row\nkey f5");
    assert_eq!(rig.snapshot().page, Page::Scope);
    crate::stories::tell(&mut rig, "page position\nkey f3");
    assert_eq!(is(&mut rig), (Page::Position, CoordinateView::Machine, 0));
    // The surface grinder has no technology page: its fifth row ends with F4.
    let mut rig =
        crate::stories::story_on(Kind::Gs, "page position\nkey previous-row\nkey f5\nexpect message \"没有 F5\"");
    assert_eq!(is(&mut rig).0, Page::Position);
}
