//! The scope page: signals are chosen by touch, recorded by the core, read at a cursor, saved as CSV; a circle is measured.
//! Source: spec B6 (diagnosis), H9.

use kt830::defs::page::Page;
use kt830::link::files::FileRequest;
use kt830::link::scope::{ScopeState, ScopeTrigger};

use crate::live_screen::Bench;
use crate::sample::snapshot;
use crate::screen::open;
use crate::stories::{ready, ready_with, tell};
use egui_kittest::kittest::Queryable;
use kt830::link::Command;
use kt830::link::page_command::PageCommand;

#[test]
fn b6_signals_are_chosen_and_recorded_by_touch() {
    let mut bench = Bench::new(ready(), Page::Scope);
    assert!(bench.shows("X 跟随误差") && bench.shows("按 记录 记录这些信号"));
    bench.touch("X 实际速度 scope-channel-1");
    assert!(bench.shows("选一个信号"));
    bench.touch("Z 设定值 Z-set");
    assert!(bench.shows("Z 设定值") && !bench.shows("选一个信号"));
    bench.touch("记录 scope-start");
    assert_eq!(bench.rig.snapshot().scope.state, ScopeState::Recording);
    tell(&mut bench.rig, "wait 5 s");
    bench.turn();
    let scope = bench.rig.snapshot().scope.clone();
    assert_eq!((scope.state, scope.recording.samples.len()), (ScopeState::Idle, 4_000));
    assert_eq!(scope.recording.setup.channels[0].map(|signal| signal.id()).as_deref(), Some("Z-set"));
    // The value where the axis stands, in the name of its channel: −150 mm.
    assert!(bench.shows("-150.0000 mm"), "{:?}", bench.painted());
}

#[test]
fn b6_a_recording_stops_by_touch_and_spans_and_triggers_step_on() {
    let mut bench = Bench::new(ready(), Page::Scope);
    for span in ["20 s", "1 min", "5 min", "0.5 s", "4 s"] {
        let shown = bench.painted().into_iter().find(|words| words.starts_with("时长")).expect("the span");
        bench.touch(&format!("{shown} scope-span"));
        assert!(bench.shows(&format!("时长 {span}")), "{span}: {:?}", bench.painted());
    }
    bench.touch("触发 – scope-trigger");
    bench.touch("触发 ↑ scope-trigger");
    assert!(bench.shows("触发 ↓ 0.0 mm/min Ø"), "{:?}", bench.painted());
    bench.touch("记录 scope-start");
    assert_eq!(bench.rig.snapshot().scope.state, ScopeState::Armed);
    bench.turn();
    assert!(bench.shows("等待触发"));
    bench.touch("结束 scope-start");
    let scope = bench.rig.snapshot().scope.clone();
    assert_eq!((scope.state, scope.recording.setup.trigger), (ScopeState::Idle, ScopeTrigger::Falling(0.0)));
}

/// A recording that something else began is shown with its own signals; a touch on the curves puts the cursor there, and
/// its value becomes the level.
#[test]
fn b6_the_cursor_reads_values_and_gives_the_level() {
    let mut screen = open(snapshot(Page::Scope));
    let plot = screen.get_by_label("曲线 scope-curves").rect();
    let touch = |screen: &mut crate::screen::Screen, at: egui::Pos2| {
        for pressed in [true, false] {
            let (button, modifiers) = (egui::PointerButton::Primary, egui::Modifiers::NONE);
            let events = &mut screen.input_mut().events;
            events.extend([
                egui::Event::PointerMoved(at),
                egui::Event::PointerButton { pos: at, button, pressed, modifiers },
            ]);
            screen.run();
        }
    };
    // A quarter of 4 000 samples is sample 1 000, 0.2 s behind the trigger at sample 800.
    touch(&mut screen, plot.left_center() + egui::vec2(plot.width() * 0.25, 3.0));
    let words = crate::screen::painted(&screen);
    assert!(words.iter().any(|words| words.contains("游标 0.2")), "{words:?}");
    // −6000 · sin(1000/400) = −3590.8.
    assert!(words.iter().any(|words| words.starts_with("-359") && words.ends_with("mm/min Ø")), "{words:?}");
    screen.get_by_label("触发值 scope-level").click();
    screen.run();
    assert!(crate::screen::painted(&screen).iter().any(|words| words.starts_with("触发 ↑ -359")));
    // With the arrows it goes on by a sample.
    screen.key_press(egui::Key::ArrowRight);
    screen.run();
    let words = crate::screen::painted(&screen);
    assert!(words.iter().any(|words| words.contains("游标 0.201")), "{words:?}");
}

#[test]
fn b6_the_recording_is_saved_as_a_table() {
    let mut screen = open(snapshot(Page::Scope));
    screen.get_by_label("存为 CSV scope-export").click();
    screen.run();
    let saved = screen.state_mut().sent.iter().find_map(|command| match command {
        Command::Page(PageCommand::File(_, FileRequest::SaveTable(text))) => Some(text.clone()),
        _ => None,
    });
    let text = saved.expect("a table");
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("seconds,X-actual-speed mm/min Ø,X-error µm Ø,input:guard-closed,X-actual mm Ø"));
    assert_eq!(lines.next(), Some("-0.8000,0.0,0.0,0,-812.4550"));
    assert_eq!(text.lines().count(), 4_001);
}

/// A key that cannot act says why.
#[test]
fn b6_without_a_recording_nothing_is_saved_and_no_level_is_taken() {
    let mut bench = Bench::new(ready(), Page::Scope);
    bench.touch("存为 CSV scope-export");
    assert!(bench.shows("还没有记录"));
    bench.touch("触发值 scope-level");
    assert!(bench.shows("先点曲线放游标") && !bench.shows("还没有记录"));
}

/// Whatever the cursor reads, an input rises through the half.
#[test]
fn b6_a_digital_trigger_has_its_own_level() {
    let mut rig = ready();
    tell(&mut rig, "scope input:gauge-1 span 0.5 s rising 1\ninput gauge-1 off\nwait 1 s\ninput gauge-1 on\nwait 1 s");
    assert_eq!(rig.snapshot().scope.state, ScopeState::Idle);
    assert_eq!(rig.snapshot().scope.recording.samples.len(), 500);
}

/// A refused start leaves the page as it is; a recording of the same signals that a story begins starts anew.
#[test]
fn b6_a_refused_start_keeps_what_was_chosen() {
    let mut bench = Bench::new(ready(), Page::Scope);
    bench.touch("记录 scope-start");
    tell(&mut bench.rig, "wait 5 s");
    bench.turn();
    for channel in 1..=4 {
        let label = ["X 实际速度", "X 跟随误差", "Z 实际速度", "Z 跟随误差"][channel - 1];
        bench.touch(&format!("{label} scope-channel-{channel}"));
        bench.touch("无信号 scope-no-signal");
    }
    bench.touch("记录 scope-start");
    assert!(bench.message().contains("先选一个信号"));
    bench.turn();
    assert_eq!(bench.painted().iter().filter(|words| *words == "无信号").count(), 4, "{:?}", bench.painted());
}

/// Power that goes and comes back leaves no recording, and the page its signals.
#[test]
fn b6_a_power_cut_leaves_the_signals_of_the_page() {
    let mut bench = Bench::new(ready(), Page::Scope);
    bench.touch("记录 scope-start");
    tell(&mut bench.rig, "wait 5 s");
    bench.turn();
    tell(&mut bench.rig, "power cut\npower on\nwait 1 s\npage scope");
    bench.turn();
    assert!(bench.shows("X 实际速度") && bench.shows("时长 4 s") && bench.shows("按 记录 记录这些信号"));
}

/// A circle of 10 mm at 600 mm/min in the plane XZ: the set-point turns with ω = 10/10 = 1 rad/s. A drive that lags by T follows
/// a circle with the radius R/√(1 + ω²T²); the simulated ones lag by 20 ms, which makes it 2 µm smaller. The encoders read
/// whole micrometres, so radius and roundness are uncertain by about one.
#[test]
fn b6_a_recorded_circle_has_a_roundness() {
    let mut rig = ready_with("G98 G01 U0 F600\nG02 U0 W0 I-10 K0\nM30");
    let record = "mode auto\nscope X-actual Z-actual X-set Z-set span 20 s\nkey cycle-start\nwait until idle max 10 s";
    tell(&mut rig, &format!("{record}\nscope stop\nwait 0.3 s"));
    // 2π seconds, every fifth tick, and its ends.
    let seen = rig.snapshot().scope.recording.clone();
    assert!((1_200..1_400).contains(&seen.samples.len()), "{}", seen.samples.len());
    let (low, high) = seen.extremes(0, 0..seen.samples.len()).expect("samples");
    assert!((high - low - 40.0).abs() < 0.02, "{low} … {high}: a diameter of 40");
    let mut bench = Bench::new(rig, Page::Scope);
    bench.touch("圆度 scope-round");
    let um = |after: &str| -> f64 {
        let words = bench.painted();
        let at = words.iter().position(|word| word == after).expect("the name");
        words[at + 1].trim_end_matches(" µm").parse().expect("a number")
    };
    assert!((0.5..3.0).contains(&um("圆度")), "{:?}", bench.painted());
    assert!((-3.0..-0.5).contains(&um("半径偏差")), "{:?}", bench.painted());
}

/// A positioning of 40 mm at 3000 mm/min. The simulated drives lag by 20 ms behind a set-point that they hold for a cycle:
/// 19.5 ms behind the one that was sent last, which at 50 mm/s is 0.975 mm, a velocity gain of 51.3/s.
#[test]
fn b6_a_recorded_move_has_a_step_response() {
    let mut rig = ready_with("G98 G01 W-40 F3000\nM30");
    let record = "mode auto\nscope Z-actual Z-set span 4 s\nkey cycle-start\nwait until idle max 10 s";
    tell(&mut rig, &format!("{record}\nwait 1 s\nscope stop\nwait 0.3 s"));
    let mut bench = Bench::new(rig, Page::Scope);
    bench.touch("阶跃 scope-step");
    let value = |after: &str| -> f64 {
        let words = bench.painted();
        let at = words.iter().position(|word| word == after).unwrap_or_else(|| panic!("no {after} in {words:?}"));
        words[at + 1].split(' ').next().unwrap().parse().expect("a number")
    };
    assert!((value("行程") + 40.0).abs() < 0.001);
    assert!((value("最高速度") - 50.0).abs() < 0.2);
    assert!((value("速度增益 Kv") - 51.3).abs() < 0.4, "{}", value("速度增益 Kv"));
    assert!((value("最大跟随误差") - 975.0).abs() < 8.0, "{}", value("最大跟随误差"));
    assert!(value("超调") < 1.5, "{}", value("超调"));
    // From 1 mm to 0.6 µm a lag of 20 ms takes more than 20 ms · ln(1000/0.6) less what the braking has taken.
    assert!((20.0..400.0).contains(&value("到位时间")), "{}", value("到位时间"));
}

/// The level may be typed: digits on the page, INPUT takes them.
#[test]
fn b6_the_level_of_the_trigger_is_typed() {
    let mut bench = Bench::new(ready(), Page::Scope);
    bench.write("125");
    assert!(bench.painted().iter().any(|words| words.contains("触发值 125_")), "{:?}", bench.painted());
    bench.press(egui::Key::Enter);
    assert!(bench.painted().iter().any(|words| words.starts_with("触发 ↑ 125")), "{:?}", bench.painted());
}

#[test]
fn b6_the_arrows_zoom_around_the_cursor() {
    let mut rig = ready();
    tell(&mut rig, "scope X-actual span 0.5 s\nwait 1 s");
    let mut bench = Bench::new(rig, Page::Scope);
    let shown = |bench: &Bench| bench.painted().iter().find(|words| words.contains('…')).cloned().unwrap();
    let whole = shown(&bench);
    bench.touch("曲线 scope-curves");
    for _ in 0..100 {
        bench.press(egui::Key::ArrowLeft);
    }
    let cursor = |bench: &Bench| shown(bench).split("·").next().unwrap().trim().to_owned();
    let before = cursor(&bench);
    for _ in 0..3 {
        bench.press(egui::Key::ArrowUp);
    }
    assert_ne!(shown(&bench), whole);
    assert_eq!(cursor(&bench), before, "it stays where it is");
    let limits = shown(&bench);
    let numbers: Vec<f64> = limits.split([' ', '…', '·']).filter_map(|word| word.parse().ok()).collect();
    assert!(numbers[1] <= numbers[0] && numbers[0] <= numbers[2], "and in sight: {limits}");
    bench.press(egui::Key::ArrowDown);
    bench.press(egui::Key::ArrowDown);
    bench.press(egui::Key::ArrowDown);
    assert_eq!(shown(&bench).split("·").last().unwrap().trim(), whole.trim());
}
