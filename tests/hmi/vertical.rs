//! The pages of the vertical grinder: the R page in both languages and all sizes, variables as executed, keys of its own.

use crate::stories::{ready_of, tell};
use kt830::defs::kind::Kind;
use kt830::defs::page::Page;
use kt830::defs::program_number;
use kt830::defs::text::Lang;
use kt830::hmi::offscreen::OffscreenHmi;
use kt830::hmi::{Hmi, page_text};
use kt830::host::folders;
use kt830::host::headless::HeadlessHost;
use kt830::io::sim::PartFile;
use kt830::link::Command;
use kt830::link::snapshot::RunState;
use kt830::units::Axis;

/// How many blocks go round: all of them are read before the second is over.
const LOOP: usize = 30;
/// Way of a block along the slide, mm.
const STEP_MM: f64 = 0.1;

/// A ready vertical grinder with the part of VGRIND in it, so that G54 is where programs want it.
fn vertical() -> HeadlessHost {
    let mut rig = ready_of(Kind::Vertical);
    rig.mount_part(&PartFile::builtin(program_number::from_name("VGRIND")).unwrap().unwrap());
    rig.step();
    rig.make_ready();
    rig
}

/// What stands behind a label on a page.
fn value(texts: &[String], label: &str) -> Option<f64> {
    let pairs = texts.windows(2).filter(|pair| pair[0].starts_with(label));
    pairs.filter_map(|pair| pair[1].parse().ok()).next()
}

/// Runs a loop that counts a variable up by 1 for every step of X− and looks at the page in every tick: k is shown when
/// k − 1 steps are done, and not before.
fn counts_as_executed(rig: &mut HeadlessHost, label: &str) {
    let mut stage = OffscreenHmi::new(Hmi::new(Lang::Zh), (1_024, 768));
    let from = rig.controller().set_point()[Axis::X];
    rig.send(Command::Press(kt830::defs::key::Key::CycleStart));
    rig.step();
    rig.step();
    let (mut shown, mut ticks) = (Vec::new(), 0);
    while rig.controller().state() == RunState::Running {
        rig.step();
        stage.frame(rig.snapshot());
        let texts: Vec<String> = stage.texts().into_iter().map(|(text, ..)| text).collect();
        let now = value(&texts, label).unwrap_or_default();
        let done = (from - rig.controller().set_point()[Axis::X]) / STEP_MM;
        assert!(now - 1.0 <= done + 0.05, "{label} shows {now} after {done} steps");
        // Nor late: a tick of 10 mm/s is a tenth of a step.
        assert!(now + 0.15 >= done, "{label} still shows {now} after {done} steps");
        if shown.last().is_none_or(|last: &f64| last.total_cmp(&now).is_ne()) {
            shown.push(now);
        }
        ticks += 1;
        assert!(ticks < 20_000, "the loop does not end");
    }
    // The nought before the loop may last less than the two ticks of the start.
    shown.retain(|value| *value > 0.0);
    let expected: Vec<f64> = (1..=LOOP).map(|k| k as f64).collect();
    assert_eq!(shown, expected, "every value was on the page, in order");
}

#[test]
fn s2_the_r_page_shows_r_parameters_as_executed_in_every_tick() {
    let mut rig = vertical();
    let text = format!("R61=0\nG90 G94 F600\nAA1:R61=R61+1\nG1 G91 X-{}\nIF R61<{LOOP} GOTOB AA1\nM2", 2.0 * STEP_MM);
    rig.add_program(folders::program_from_bytes(
        program_number::from_name("LOOP"),
        "LOOP.MPF",
        text.into_bytes(),
        rig.kind().dialect(),
    ));
    tell(&mut rig, "mode mdi\nmdi G90 G0 X690\nwait 2 s\nset R61 = 0\nload LOOP\nmode auto\npage grinding\nsheet 3");
    counts_as_executed(&mut rig, "R61 ");
}

#[test]
fn b3_the_macro_page_shows_variables_as_executed_in_every_tick() {
    let mut rig = ready_of(Kind::Gc);
    let text =
        format!("G61\n#100=0\nWHILE[#100 LT {LOOP}]DO1\n#100=#100+1\nG98 G01 U-{} F600\nEND1\nM30", 2.0 * STEP_MM);
    rig.add_program(folders::program_from_bytes(7_000, "O7000.NC", text.into_bytes(), rig.kind().dialect()));
    tell(&mut rig, "set #100 = 0\nload O7000\nmode auto\npage macro");
    counts_as_executed(&mut rig, "#100");
}

/// The loop's look-ahead is real: without waiting for the machine the reader comes to an error 25 blocks ahead at
/// once, which only the values make (a mistake of the text would be told before the start).
#[test]
fn s2_the_reader_of_that_loop_is_far_ahead() {
    let mut rig = vertical();
    let text =
        format!("R61=0\nG90 G94 F600\nAA1:R61=R61+1\nG1 G91 X-{}\nIF R61<25 GOTOB AA1\nR62=1/R99\nM2", 2.0 * STEP_MM);
    rig.add_program(folders::program_from_bytes(
        program_number::from_name("AHEAD"),
        "AHEAD.MPF",
        text.into_bytes(),
        rig.kind().dialect(),
    ));
    tell(&mut rig, "mode mdi\nmdi G90 G0 X690\nwait 2 s\nload AHEAD\nmode auto\nkey cycle-start\nwait 0.3 s");
    // 0.3 s are a few of the 25 steps, and what is shown is what is done.
    let shown = rig.snapshot().variables[661].unwrap_or_default();
    assert!((1.0..10.0).contains(&shown), "{shown}");
    tell(&mut rig, "wait until alarm max 10 s\nexpect R61 25");
}

fn r_page(kind_story: &str) -> HeadlessHost {
    let mut rig = vertical();
    tell(&mut rig, &format!("load VGRIND\nmode auto\npage grinding\n{kind_story}"));
    rig
}

/// Every label of the shipped sheets is the seed's name and has an English one; in English no Chinese sign stands on
/// the page.
#[test]
fn s3_the_r_page_is_complete_in_english() {
    for sheet in 1..=3 {
        let mut rig = r_page(&format!("sheet {sheet}"));
        let number = rig.snapshot().grinding_page_number().unwrap();
        let screens = rig.snapshot().screens.clone();
        let text = screens.find(number).unwrap().text.clone().unwrap();
        assert!(text.english_title.is_some(), "{}", text.title);
        for row in text.rows() {
            let number = row.label.split(' ').next().unwrap();
            assert!(row.english.as_ref().is_some_and(|label| label.starts_with(number)), "{}", row.label);
        }
        let chinese = |text: &String| text.chars().any(|sign| ('\u{4e00}'..='\u{9fff}').contains(&sign));
        let left: Vec<String> = page_text(rig.snapshot(), Lang::En).into_iter().filter(chinese).collect();
        assert_eq!(left, [""; 0], "sheet {sheet}");
    }
}

/// Labels and values of the R page never touch each other, at every size and in both languages.
#[test]
fn s3_nothing_on_the_r_page_collides_at_any_size() {
    for (lang, size) in [Lang::Zh, Lang::En]
        .into_iter()
        .flat_map(|lang| [(800, 600), (1_024, 768), (1_920, 1_080), (768, 1_024)].map(|size| (lang, size)))
    {
        for sheet in 1..=3 {
            let mut rig = r_page(&format!("sheet {sheet}\nset R60 = 199.995"));
            let mut stage = OffscreenHmi::new(Hmi::new(lang), size);
            stage.frame(rig.snapshot());
            stage.frame(rig.snapshot());
            let texts = stage.texts();
            let fields: Vec<_> = texts.iter().filter(|(text, ..)| text.starts_with('R')).collect();
            assert!(fields.len() >= 13, "{size:?}: {}", fields.len());
            for (index, (text, rect, ..)) in texts.iter().enumerate() {
                assert!(!text.ends_with('…') || !text.starts_with('R'), "{lang:?} {size:?}: {text} is cut");
                let Some((value, other, ..)) = texts.get(index + 1) else { continue };
                if text.starts_with('R') && value.parse::<f64>().is_ok() {
                    // Signs stand in the middle 60 % of their line.
                    let ink = |rect: &egui::Rect| rect.shrink2(egui::vec2(0.0, rect.height() * 0.2));
                    assert!(!ink(rect).intersects(ink(other)), "{lang:?} {size:?}: {text} and {value}");
                }
            }
        }
    }
}

#[test]
fn s3_the_vertical_grinder_has_keys_of_its_own_only() {
    let mut rig = r_page("");
    for lang in [Lang::Zh, Lang::En] {
        let texts = page_text(rig.snapshot(), lang);
        let has = |words: &str| texts.iter().any(|text| text == words);
        for other in ["Y+", "Y-", "Y", "尾座", "头架", "磁力", "修整器", "刀架", "TAILSTOCK", "HEAD", "MAGNET", "POST"]
        {
            assert!(!has(other), "{other}");
        }
        assert!(has("X+") && has("Z-") && has("X") && has("Z"));
    }
    tell(&mut rig, "page position");
    let texts = page_text(rig.snapshot(), Lang::Zh);
    assert!(texts.iter().any(|text| text == "R 参数") && !texts.iter().any(|text| text == "砂轮修整"));
    // Fitted, the axis has its keys.
    tell(&mut rig, "param P6.6 1\npower cut\nwait 1 s\npower on");
    assert!(rig.snapshot().axes[Axis::Y].present);
    let texts = page_text(rig.snapshot(), Lang::Zh);
    assert!(["Y+", "Y-", "Y"].into_iter().all(|key| texts.iter().any(|text| text == key)));
    tell(&mut rig, "page grinding");
    assert_eq!(rig.snapshot().page, Page::Grinding);
}

/// Field problem 3 on the page: 0.005 and 0.001 of a diameter stand there as such, in the position and in the distance to go.
#[test]
fn b7_small_steps_of_a_diameter_stand_on_the_page_as_they_are() {
    let mut rig = vertical();
    let text = "G90 G94 F30\nG0 X700\nG91 G1 X-0.005\nG1 X-0.001\nM2";
    rig.add_program(folders::program_from_bytes(
        program_number::from_name("FINE"),
        "FINE.MPF",
        text.as_bytes().to_vec(),
        rig.kind().dialect(),
    ));
    tell(&mut rig, "load FINE\nmode auto\npage grinding\nkey single-block\nkey cycle-start\nwait until stopped");
    let mut stage = OffscreenHmi::new(Hmi::new(Lang::Zh), (1_024, 768));
    let mut shown = |rig: &mut HeadlessHost| -> Vec<String> {
        stage.frame(rig.snapshot());
        stage.texts().into_iter().map(|(text, ..)| text).collect()
    };
    for (to_go, then) in [("0.005", "699.995"), ("0.001", "699.994")] {
        rig.send(Command::Press(kt830::defs::key::Key::CycleStart));
        let mut seen = Vec::new();
        for _ in 0..1_000 {
            rig.step();
            seen.extend(shown(&mut rig).into_iter().filter(|text| text.ends_with(to_go)));
            if rig.controller().state() == RunState::Stopped && !seen.is_empty() {
                break;
            }
        }
        assert!(seen.iter().any(|text| text.trim_start_matches('-') == to_go), "{to_go}: {seen:?}");
        tell(&mut rig, "wait 0.5 s");
        assert!(shown(&mut rig).iter().any(|text| text == then), "{then}");
    }
}
