//! The bus page.

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
    ] {
        assert!(texts.contains(said), "{said}: {texts}");
    }
}

#[test]
fn p1_the_bus_page_shows_what_is_missing() {
    let texts = page_text(&crate::sample::troubled(Page::Bus), Lang::Zh).join("\n");
    for said in
        ["设备 9 没有应答", "Z  故障 8611h 跟随误差过大", "没有应答", "1420 ms 前", "192.168.1.20:502  没有应答"]
    {
        assert!(texts.contains(said), "{said}: {texts}");
    }
}

#[test]
fn p1_a_simulated_machine_has_no_bus() {
    let texts = page_text(&crate::sample::running(Page::Bus), Lang::Zh);
    assert!(texts.iter().any(|text| text.contains("没有总线")), "{texts:?}");
}
