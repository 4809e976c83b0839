//! The checklist of commissioning on the diagnosis page: seen off and on, then confirmed.
//! Source: spec B6 (diagnosis); docs/manual/first_start.md.

use egui_kittest::kittest::Queryable;
use kt830::defs::page::Page;
use kt830::link::Command;
use kt830::link::files::FileRequest;
use kt830::link::page_command::PageCommand;

use crate::live_screen::Bench;
use crate::sample::snapshot;
use crate::screen::open;
use crate::stories::{ready, tell};

fn checking() -> Bench {
    let mut bench = Bench::new(ready(), Page::Diagnosis);
    bench.touch("核对 tab-check");
    assert!(bench.shows("动作每个开关"));
    bench.touch("开始 check-start");
    bench
}

/// The row of a signal is confirmed only after both levels were seen.
#[test]
fn b6_a_signal_is_confirmed_after_it_was_seen_off_and_on() {
    let mut bench = checking();
    let confirmed =
        |bench: &Bench| bench.painted().into_iter().find(|words| words.contains("已确认 ")).expect("a count");
    let before = confirmed(&bench);
    assert!(before.contains("已见断和通 0/") && before.contains("已确认 0/"), "{before}");
    bench.touch("输入 量仪信号 1 check-gauge-1");
    assert_eq!(confirmed(&bench), before);
    for level in ["on", "off"] {
        tell(&mut bench.rig, &format!("input gauge-1 {level}\nwait 0.2 s"));
        bench.turn();
    }
    assert!(confirmed(&bench).contains("已见断和通 1/") && confirmed(&bench).contains("已确认 0/"));
    bench.touch("输入 量仪信号 1 check-gauge-1");
    assert!(confirmed(&bench).contains("已确认 1/"), "{}", confirmed(&bench));
    // A second touch takes it back.
    bench.touch("输入 量仪信号 1 check-gauge-1");
    assert!(confirmed(&bench).contains("已确认 0/"));
}

/// An output that its key switches is seen, also while another page is open; a new start asks first.
#[test]
fn b6_outputs_are_seen_on_any_page_and_a_new_start_asks() {
    let mut bench = checking();
    bench.rig.send(Command::OpenPage(Page::Position));
    for _ in 0..2 {
        tell(&mut bench.rig, "key coolant\nwait 0.5 s");
        bench.turn();
    }
    bench.rig.send(Command::OpenPage(Page::Diagnosis));
    bench.turn();
    bench.turn();
    bench.touch("核对 tab-check");
    let both =
        |bench: &Bench| bench.painted().into_iter().find(|words| words.contains("已见断和通 ")).expect("a count");
    assert!(!both(&bench).contains("已见断和通 0/"), "{}", both(&bench));
    bench.touch("重新开始 check-start");
    assert!(bench.shows("重新核对？"));
    bench.touch("重新开始 question-check");
    assert!(both(&bench).contains("已见断和通 0/"));
}

/// Only what is connected is in the list and in the table.
#[test]
fn b6_the_checklist_is_saved_as_a_table() {
    let mut screen = open(snapshot(Page::Diagnosis));
    for label in ["核对 tab-check", "开始 check-start", "存为 CSV check-save"] {
        screen.get_by_label(label).click();
        screen.run();
    }
    let saved = screen.state_mut().sent.iter().find_map(|command| match command {
        Command::Page(PageCommand::File(_, FileRequest::SaveTable(text))) => Some(text.clone()),
        _ => None,
    });
    let text = saved.expect("a table");
    assert!(text.starts_with("signal,id,port,seen_off,seen_on,confirmed\r\ninput,"), "{text}");
    assert!(text.contains("\r\noutput,wheel,") && !text.contains(",0,"), "{text}");
    let ports = text.lines().skip(1).map(|line| line.split(',').nth(2).expect("a port"));
    assert!(ports.clone().count() > 40 && ports.into_iter().all(|port| port.parse::<u8>().is_ok_and(|port| port > 0)));
}
