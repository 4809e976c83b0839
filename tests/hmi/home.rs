//! Home page: tiles that open the pages behind them (rows H5, H7).

use kt830::defs::page::Page;

use crate::live_screen::Bench;
use crate::stories::{ready, ready_of, tell};
use kt830::defs::kind::Kind;

/// Each tile opens its page; the title of any page comes back.
#[test]
fn h7_a_tile_opens_its_page_and_the_title_comes_back() {
    let mut bench = Bench::new(ready(), Page::Home);
    for (label, page) in [
        ("位置 绝对 home-position", Page::Position),
        ("程序 home-program", Page::Program),
        ("工件 home-grinding", Page::Grinding),
        ("砂轮 home-process", Page::Process),
        ("距下次修整 件 home-dressing", Page::Dressing),
        ("报警 home-alarm", Page::Alarm),
    ] {
        bench.touch(label);
        assert_eq!(bench.rig.snapshot().page, page, "{label}");
        bench.touch("总览 header-home");
        assert_eq!(bench.rig.snapshot().page, Page::Home, "{label}");
    }
}

/// The size of the last part in the colour of its verdict, and what runs.
#[test]
fn h5_the_tiles_show_the_last_part_and_what_runs() {
    let mut rig = ready();
    tell(&mut rig, "load O1002\npart assets/parts/O1002.ron\nmode auto\nkey cycle-start\nwait 24 s");
    let mut bench = Bench::new(rig, Page::Home);
    assert!(bench.shows("34.6 m/s") && bench.shows("1100 r/min") && bench.shows("粗"));
    tell(&mut bench.rig, "wait until idle max 200 s");
    bench.turn();
    assert!(bench.shows("上一件尺寸 mm") && bench.shows("40.00"), "{:?}", bench.painted());
    // O1002 is dressed after ten parts; one is made.
    assert!(bench.shows("距下次修整 件") && bench.painted().iter().any(|words| words == "9"));
}

/// The tile shows the alarm that the header shows: what has stopped everything, not the latest.
#[test]
fn h7_the_alarm_of_the_tile_is_the_one_of_the_header() {
    let mut rig = ready();
    tell(&mut rig, "key emergency-stop\nwait 0.5 s\ninput hydraulic-pressure off\nwait 5 s");
    let bench = Bench::new(rig, Page::Home);
    let leading = bench.screen.state().snapshot.alarms.clone();
    let number = kt830::defs::alarm::leading(&leading, |alarm| alarm.number).unwrap().number.to_string();
    assert!(bench.painted().contains(&number), "{number}: {:?}", bench.painted());
}

#[test]
fn l9_the_lathe_has_its_own_tiles() {
    let mut bench = Bench::new(ready_of(Kind::Lathe), Page::Home);
    assert!(!bench.shows("砂轮") && bench.shows("主轴"));
    bench.touch("主轴 home-tools");
    assert_eq!(bench.rig.snapshot().page, Page::Tools);
}
