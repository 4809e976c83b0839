//! The bus page.

use crate::live_screen::Bench;
use egui_kittest::kittest::Queryable;
use kt830::defs::page::Page;
use kt830::defs::text::Lang;
use kt830::hmi::page_text;

#[test]
fn p1_the_bus_page_shows_devices_drives_and_times() {
    let texts = page_text(&crate::sample::busy(Page::Bus), Lang::En).join("\n");
    for said in [
        "enp2s0  in operation  real time  CPU 3",
        "drive X",
        "X  enabled  -37.5 %",
        "OP",
        "86400000",
        "1234",
        "70 / 110 / 1850 µs",
        "wheel inverter",
        "12 ms ago",
        "192.168.1.20:502  1.1 / 2.9 / 14.2 ms",
        "-12.4 ppm",
        "10 / 80 / 410 µs",
        "1479 r/min",
    ] {
        assert!(texts.contains(said), "{said}: {texts}");
    }
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
    let mut bench = Bench::new(crate::stories::rig(), Page::Bus);
    bench.screen.state_mut().snapshot = crate::sample::busy(Page::Bus);
    bench.screen.step();
    bench.screen.step();
    // The arrow keys change the tab as well.
    for act in [
        |bench: &mut Bench| bench.screen.get_by_label("机床描述 bus-description").click(),
        |bench: &mut Bench| {
            bench.screen.key_press(egui::Key::ArrowLeft);
            bench.screen.step();
            bench.screen.step();
            assert!(bench.shows("coupler"));
            bench.screen.key_press(egui::Key::ArrowRight);
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
