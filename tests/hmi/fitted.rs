//! Pages and panel offer what the machine is fitted with: the devices and axes of its kind and those that P6.6 and P16.0
//! add. Source: spec K1, K2.1, K3.11, K5.3.

use egui_kittest::kittest::Queryable;
use kt830::defs::kind::Kind;
use kt830::defs::page::Page;

use crate::live_screen::Bench;
use crate::stories::{ready_of, tell};

#[test]
fn k3_11_the_cylindrical_grinder_has_its_magnet_keys_with_p16_0() {
    let mut bench = Bench::new(ready_of(Kind::Gc), Page::Position);
    assert!(bench.screen.query_by_label("充磁 magnetise").is_none());
    assert!(!bench.says("磁力"));
    // Without the magnet the key says so and its output does not exist.
    tell(&mut bench.rig, "key magnetise\nexpect message \"本机床没有此功能\"\nexpect output magnetise off");
    tell(&mut bench.rig, "param P16.0 1");
    bench.turn();
    bench.touch("充磁 magnetise");
    tell(&mut bench.rig, "wait 1.5 s\nexpect output magnetise on\nexpect lamp magnetise on");
    bench.turn();
    bench.touch("退磁 demagnetise");
    tell(&mut bench.rig, "expect output demagnetise on\nwait 7 s\nexpect output demagnetise off");
    // Every other key keeps its place on the panel.
    for label in ["砂轮启动 wheel-start", "头架高速 headstock-high", "尾座进 tailstock-advance", "冷却 coolant"]
    {
        assert!(bench.screen.query_by_label(label).is_some(), "{label}");
    }
    tell(&mut bench.rig, "param P16.0 0");
    bench.turn();
    assert!(bench.screen.query_by_label("充磁 magnetise").is_none());
}

#[test]
fn k3_11_m94_and_the_key_follow_the_same_bit() {
    let mut rig = ready_of(Kind::Gc);
    tell(&mut rig, "mdi M94\nexpect alarm 190\nexpect output magnetise off\nkey reset");
    tell(&mut rig, "param P16.0 1\nmdi M94\nexpect no alarm\nexpect output magnetise on");
}

#[test]
fn k1_the_diagnosis_page_lists_what_is_fitted() {
    let says = |kind: Kind, story: &str, words: &str| {
        let mut rig = ready_of(kind);
        tell(&mut rig, story);
        let mut bench = Bench::new(rig, Page::Diagnosis);
        let lists = |bench: &mut Bench| {
            (0..6).any(|_| {
                let found = bench.painted().iter().any(|text| text == words);
                bench.press(egui::Key::PageDown);
                found
            })
        };
        lists(&mut bench)
    };
    assert!(says(Kind::Gc, "", "tailstock-advanced") && !says(Kind::Gs, "", "tailstock-advanced"));
    assert!(says(Kind::Gs, "", "drive-y") && !says(Kind::Gc, "", "drive-y"));
    assert!(says(Kind::Gc, "param P6.6 1", "drive-y"));
}

#[test]
fn k1_the_simulator_offers_the_faults_of_what_is_fitted() {
    let faults = |kind: Kind| {
        let mut bench = Bench::new(ready_of(kind), Page::Simulator);
        bench.touch("故障 sim-faults");
        bench.painted()
    };
    let has = |texts: &[String], words: &str| texts.iter().any(|text| text == words);
    let (gc, gs, lathe) = (faults(Kind::Gc), faults(Kind::Gs), faults(Kind::Lathe));
    assert!(has(&gc, "X 驱动故障") && !has(&gc, "Y 驱动故障") && has(&gs, "Y 驱动故障"));
    assert!(has(&gc, "液压压力丢失") && !has(&lathe, "液压压力丢失"));
}

#[test]
fn b6_the_parameter_page_lists_the_axes_that_are_fitted() {
    let mut bench = Bench::new(ready_of(Kind::Gc), Page::Params);
    bench.write("P31");
    bench.press(egui::Key::Enter);
    assert!(!bench.painted().iter().any(|text| text == "Y 快速"));
    tell(&mut bench.rig, "param P6.6 1");
    bench.turn();
    assert!(bench.painted().iter().any(|text| text.contains("Y 快速")), "{:?}", bench.painted());
}
