//! The bus page.

use crate::live_screen::Bench;
use egui_kittest::kittest::Queryable;
use kt830::defs::page::Page;
use kt830::defs::text::Lang;
use kt830::hmi::page_text;
use kt830::link::Command;

#[test]
fn p1_the_bus_page_shows_devices_drives_and_times() {
    let texts = page_text(&crate::sample::busy(Page::Bus), Lang::En).join("\n");
    for said in [
        "enp2s0  in operation  real time  CPU 3",
        "drive X",
        "X  enabled  -37.5 %",
        "OP",
        "86400000 / 1234",
        "70 / 110 / 1850 µs",
        "wheel inverter",
        "12 ms ago",
        "192.168.1.20:502  1.1 / 2.9 / 14.2 ms",
        "-12.4 ppm",
        "10 / 80 / 410 µs",
        "1479 r/min",
        "15 / 15",
    ] {
        assert!(texts.contains(said), "{said}: {texts}");
    }
}

/// The page with a bus in operation behind it.
fn busy_page() -> Bench {
    let mut bench = Bench::new(crate::stories::rig(), Page::Bus);
    bench.screen.state_mut().snapshot = crate::sample::busy(Page::Bus);
    bench.screen.step();
    bench.screen.step();
    bench
}

fn click(bench: &mut Bench, label: &str) {
    bench.screen.get_by_label(label).click();
    bench.screen.step();
    bench.screen.step();
}

#[test]
fn p1_the_bus_page_draws_how_often_which_time_came() {
    let mut bench = busy_page();
    click(&mut bench, "时间 bus-times");
    for said in
        ["唤醒延迟", "执行时间", "报文往返", "偏离总线时钟", "50% 20  99% 90  最大 12340 µs", "41M", "9.9k", "500"]
    {
        assert!(bench.shows(said), "{said}: {:?}", bench.painted());
    }
    assert!(!bench.shows("coupler"));
}

#[test]
fn p1_the_counters_of_the_bus_are_cleared_by_touch_and_not_on_the_description() {
    let mut bench = busy_page();
    bench.screen.state_mut().sent.clear();
    click(&mut bench, "计数清零 bus-clear");
    let sent = &bench.screen.state().sent;
    assert_eq!(sent.iter().filter(|sent| matches!(sent, Command::ClearBusCounters)).count(), 1, "{sent:?}");
    click(&mut bench, "机床描述 bus-description");
    assert!(!bench.shows("计数清零"));
}

#[test]
fn p1_the_bus_page_shows_what_is_missing() {
    let texts = page_text(&crate::sample::troubled(Page::Bus), Lang::Zh).join("\n");
    for said in [
        "设备 9 没有应答",
        "Z  故障 8611h 跟随误差过大",
        "没有应答",
        "1420 ms 前",
        "192.168.1.20:502  没有应答",
        "17 输出过流",
        "端口 1: 坏帧 12, 断线 1",
    ] {
        assert!(texts.contains(said), "{said}: {texts}");
    }
}

#[test]
fn p1_the_bus_page_shows_the_description_of_the_machine() {
    let mut bench = busy_page();
    // The arrow keys change the tab as well, from the last one to the first.
    for act in [
        |bench: &mut Bench| bench.screen.get_by_label("机床描述 bus-description").click(),
        |bench: &mut Bench| {
            bench.screen.key_press(egui::Key::ArrowRight);
            bench.screen.step();
            bench.screen.step();
            assert!(bench.shows("coupler"));
            bench.screen.key_press(egui::Key::ArrowLeft);
        },
    ] {
        act(&mut bench);
        bench.screen.step();
        bench.screen.step();
        for said in
            ["1  drive X", "厂商 / 产品 / 版本", "1DDh / 10305070h / –", "6040h 16  607Ah 32  6060h 8  – 8  (8 B)"]
        {
            assert!(bench.shows(said), "{said}");
        }
        assert!(!bench.shows("coupler"));
    }
}

#[test]
fn p1_a_simulated_machine_has_no_bus() {
    let texts = page_text(&crate::sample::running(Page::Bus), Lang::Zh);
    assert!(texts.iter().any(|text| text.contains("没有总线")), "{texts:?}");
}
