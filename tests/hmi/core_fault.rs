//! The full-screen fault in place of a frozen picture.

use std::time::Duration;

use egui::vec2;
use egui_kittest::Harness;
use kt830::defs::text::Lang;
use kt830::hmi::Hmi;
use kt830::hmi::core_fault::{CoreFault, CoreHealth, paint_core_fault};

/// Every text that the fault paints on a display of a size, with what was cut off.
fn texts(fault: CoreFault, size: (f32, f32), light: bool) -> Vec<(String, bool)> {
    fn collect(shape: &egui::Shape, found: &mut Vec<(String, bool)>) {
        match shape {
            egui::Shape::Vec(shapes) => shapes.iter().for_each(|shape| collect(shape, found)),
            egui::Shape::Text(text) => found.push((text.galley.job.text.clone(), text.galley.elided)),
            _ => {}
        }
    }
    let mut hmi = Hmi::new(Lang::Zh);
    hmi.set_light(light);
    let mut screen = Harness::builder()
        .with_size(vec2(size.0, size.1))
        .with_context_setup(|ctx| Hmi::new(Lang::Zh).install(ctx))
        .build_ui(move |ui| paint_core_fault(ui, hmi.theme(), fault));
    screen.step();
    let mut found = Vec::new();
    screen.output().shapes.iter().for_each(|clipped| collect(&clipped.shape, &mut found));
    found
}

#[test]
fn a_failed_control_is_told_in_both_languages_with_its_outputs_and_what_to_do() {
    let fault = CoreHealth { snapshot_age: Duration::ZERO, failed: true }.fault().unwrap();
    let all = texts(fault, (1_024.0, 768.0), false);
    let at = |words: &str| all.iter().position(|(text, _)| text.contains(words)).unwrap_or_else(|| panic!("{words}"));
    for words in ["控制系统故障", "control failed", "输出已置为安全状态", "The outputs are in the safe state"]
    {
        at(words);
    }
    assert!(at("急停") < at("EMERGENCY STOP"), "Chinese first");
}

#[test]
fn a_silent_control_promises_nothing_of_its_outputs() {
    let fault = CoreHealth { snapshot_age: Duration::from_secs(1), failed: false }.fault().unwrap();
    let all = texts(fault, (1_024.0, 768.0), true);
    let has = |words: &str| all.iter().any(|(text, _)| text.contains(words));
    assert!(has("控制没有应答") && has("输出状态未知") && has("EMERGENCY STOP") && !has("安全状态"));
}

#[test]
fn no_text_of_a_fault_is_cut_off() {
    for fault in [CoreFault::Failed, CoreFault::Silent] {
        for size in [(1_024.0, 768.0), (1_366.0, 768.0), (768.0, 1_024.0)] {
            let cut: Vec<_> = texts(fault, size, false).into_iter().filter(|(_, elided)| *elided).collect();
            assert!(cut.is_empty(), "{fault:?} on {size:?}: {cut:?}");
        }
    }
}

fn health(milliseconds: u64, failed: bool) -> CoreHealth {
    CoreHealth { snapshot_age: Duration::from_millis(milliseconds), failed }
}

#[test]
fn a_fresh_snapshot_of_a_sound_control_is_shown() {
    assert_eq!(health(0, false).fault(), None);
    assert_eq!(health(500, false).fault(), None);
}

#[test]
fn an_old_snapshot_and_a_failed_control_are_faults() {
    assert_eq!(health(501, false).fault(), Some(CoreFault::Silent));
    assert_eq!(health(0, true).fault(), Some(CoreFault::Failed));
    assert_eq!(health(9_000, true).fault(), Some(CoreFault::Failed), "the cause is told, not the silence");
}
