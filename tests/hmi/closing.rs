//! Closing the window: refused while something moves, else a question with its consequences, and a password by P23.6.

use egui_kittest::kittest::Queryable;
use kt830::defs::page::Page;
use kt830::defs::param::{self, AccessLevel};
use kt830::defs::text::Text;
use kt830::link::Command;

use crate::live_screen::Bench;
use crate::stories::{ready_with, tell};

fn bench(text: &str) -> Bench {
    Bench::new(ready_with(text), Page::Position)
}

/// The window manager asks to close.
fn ask(bench: &mut Bench) {
    bench.screen.state_mut().hmi.ask_to_close();
    bench.turn();
}

fn is_asked(bench: &Bench) -> bool {
    bench.screen.query_by_label_contains("question-close").is_some()
}

fn may_close(bench: &Bench) -> bool {
    bench.screen.state().hmi.may_close()
}

#[test]
fn h8_closing_in_a_run_is_refused_and_says_what_to_do() {
    let mut bench = bench("G98 G01 Z-170 F60\nM30");
    tell(&mut bench.rig, "mode auto\nkey cycle-start\nwait 1 s\nexpect state running");
    bench.turn();
    ask(&mut bench);
    assert!(!is_asked(&bench) && !may_close(&bench));
    assert!(bench.shows("先按复位"), "{:?}", bench.painted());
    // A question that is open when something begins to move is closed.
    tell(&mut bench.rig, "key feed-hold\nwait 0.5 s");
    bench.turn();
    ask(&mut bench);
    assert!(is_asked(&bench));
    tell(&mut bench.rig, "key cycle-start\nwait 0.2 s");
    bench.turn();
    assert!(!is_asked(&bench) && !may_close(&bench));
}

#[test]
fn h8_closing_asks_and_only_its_key_confirms() {
    let mut bench = bench("M30");
    ask(&mut bench);
    assert!(is_asked(&bench) && bench.shows("砂轮、冷却和驱动断开"));
    // 取消 is preselected: the Enter key alone does not close.
    bench.press(egui::Key::Enter);
    assert!(!is_asked(&bench) && !may_close(&bench));
    ask(&mut bench);
    bench.press(egui::Key::Escape);
    assert!(!is_asked(&bench) && !may_close(&bench));
    ask(&mut bench);
    bench.touch("关闭 question-close");
    assert!(may_close(&bench));
}

#[test]
fn h8_a_held_program_keeps_its_place_says_the_question() {
    let mut bench = bench("G98 G01 Z-170 F60\nM30");
    tell(&mut bench.rig, "mode auto\nkey cycle-start\nwait 1 s\nkey feed-hold\nwait 0.5 s\nexpect state held");
    bench.turn();
    ask(&mut bench);
    assert!(is_asked(&bench) && bench.shows("断点已保存"));
}

/// It does not promise what the disk has not done.
#[test]
fn b6_the_question_says_that_values_are_not_stored() {
    let mut bench = bench("M30");
    bench.rig.send(Command::DiskFailed(Text::new("磁盘满", "disk full").into()));
    tell(&mut bench.rig, "wait 0.1 s\nexpect alarm 301");
    bench.turn();
    ask(&mut bench);
    assert!(bench.shows("还没有保存") && !bench.shows("数据全部保存"), "{:?}", bench.painted());
}

#[test]
fn k6_1_closing_may_need_the_user_password() {
    let mut bench = bench("M30");
    bench.rig.send(Command::SetParam(param::CLOSE_PASSWORD.address(), 1.0));
    bench.turn();
    for (password, closes) in [(None, false), (Some("1"), false), (Some("123456"), true)] {
        ask(&mut bench);
        bench.touch("关闭 question-close");
        assert!(bench.asks_password() && !may_close(&bench));
        if let Some(password) = password {
            bench.write(password);
            bench.press(egui::Key::Enter);
        }
        if !closes {
            bench.press(egui::Key::Escape);
        }
        assert_eq!(may_close(&bench), closes, "{password:?}");
    }
    assert_eq!(bench.rig.snapshot().access.level, AccessLevel::User);
}
