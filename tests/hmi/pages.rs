//! The pages as they are painted: what they say, whether it fits, and one picture byte for byte.

use std::path::Path;
use std::sync::Arc;

use crate::sample::{alarm, busy, long, refused, running, snapshot, troubled};
use egui::{Color32, Rect, Shape};
use kt830::defs::alarm::ALARMS;
use kt830::defs::kind::Kind;
use kt830::defs::page::Page;
use kt830::defs::param;
use kt830::defs::text::{Lang, LocalizedText};
use kt830::hmi::offscreen::OffscreenHmi;
use kt830::hmi::theme::{DARK, LIGHT, Theme, font, scale};
use kt830::hmi::{Hmi, page_text, screenshot};
use kt830::link::Snapshot;
use kt830::link::program_view::ProgramView;
use kt830::link::screens::{FileFault, Screens};
use kt830::link::snapshot::AxisView;
use kt830::link::start_guide::StartGuide;
use kt830::store::AddedLanguages;
use kt830::units::Axis;

const SIZES: [(u32, u32); 5] = [(800, 600), (1_024, 768), (1_280, 800), (1_920, 1_080), (768, 1_024)];

fn says(snapshot: &Snapshot, words: &str) -> bool {
    page_text(snapshot, Lang::Zh).iter().any(|text| text.contains(words))
}

#[test]
fn k7_2_the_grinding_page_shows_what_the_customer_drew() {
    let machine = snapshot(Page::Grinding);
    let texts = page_text(&machine, Lang::Zh);
    for words in [
        "位置",
        "[绝对坐标]",
        "[移动余量]",
        "-743.080",
        "O1001 N0040",
        "外卡磨削参数设置",
        "卡尺X轴始磨位置",
        "右卡精磨余量",
        "40.200",
        "数据输入: #500=",
        "手动方式",
        "连续",
        "停止",
        "参数",
        "诊断",
        "图形",
        "U盘/通信",
        "屏幕打印",
        "▶",
    ] {
        assert!(texts.iter().any(|text| text == words), "{words} is missing in {texts:?}");
    }
}

#[test]
fn h8_what_is_missing_is_said_with_the_remedy() {
    let mut machine = snapshot(Page::Grinding);
    machine.program.number = 2_000;
    assert!(says(&machine, "O2000 没有磨削页面"));
    machine.program.number = 1_002;
    assert!(says(&machine, "C0002.TXT") && says(&machine, "screens"));
    let mut machine = snapshot(Page::Grinding);
    let fault = |file: &str, place| FileFault {
        file: file.into(),
        position: place,
        message: LocalizedText::new("全角符号“；”", "full-width"),
    };
    let mut screens = Screens::clone(&machine.screens);
    screens.pages[0].1.text = Err(fault("C0001.TXT", Some((4, 16))));
    screens.pages[0].1.picture = Err(fault("B0001.BMP", None));
    machine.screens = Arc::new(screens);
    assert!(says(&machine, "C0001.TXT 第4行 第16列") && says(&machine, "B0001.BMP"));
    machine.page = Page::Directory;
    machine.directory = Arc::default();
    assert!(says(&machine, "programs"));
    machine.page = Page::Program;
    machine.program.number = 0;
    assert!(says(&machine, "没有装入程序"));
}

#[test]
fn h7_alarm_and_refusal_are_in_the_message_line() {
    let machine = alarm(Page::Position);
    assert!(says(&machine, "⚠ 180 ×2") && says(&machine, "180 砂轮启动时液压异常 → 检查油泵"));
    let mut machine = refused(Page::Position);
    assert!(says(&machine, "头架旋转时尾座不能动作"));
    machine.now.0 += 6_000_000;
    assert!(!says(&machine, "头架旋转时尾座不能动作"), "a refusal fades after 5 s");
}

#[test]
fn k7_1_the_position_page_has_its_coordinates() {
    let machine = snapshot(Page::Position);
    for words in ["综合坐标", "12.340", "-812.455", "-391.006", "砂轮修整"] {
        assert!(says(&machine, words), "{words}");
    }
}

#[test]
fn b6_the_program_page_marks_the_block_and_stays_fluid() {
    let mut machine = running(Page::Program);
    assert!(says(&machine, "N0090 G01 X#501 F1200"));
    let long: String = (1..=1_000_000).map(|line| format!("N{line} G01 X{line}\n")).collect();
    machine.program.text = long.into();
    machine.program.line = 999_999;
    let mut stage = OffscreenHmi::new(Hmi::new(Lang::Zh), (1_024, 768));
    stage.frame(&machine);
    // Only the lines in sight are laid out.
    assert!(stage.texts().len() < 400, "{}", stage.texts().len());
    assert!(stage.texts().iter().any(|(text, ..)| text == "N999999 G01 X999999"));
}

#[test]
fn b6_a_wide_screen_shows_the_running_lines_of_a_subprogram() {
    let mut rig = crate::stories::ready_with("M98 P9050\nM30");
    let text = b"(GRIND IN)\nG04 X1\nG04 X5\nM99".to_vec();
    rig.add_program(kt830::host::folders::program_from_bytes(9_050, "O9050.NC", text, rig.kind().dialect()));
    crate::stories::tell(&mut rig, "mode auto\nkey cycle-start\nwait 2 s\nexpect state running");
    let mut machine = rig.snapshot().clone();
    let mut stage = OffscreenHmi::new(Hmi::new(Lang::Zh), (1_920, 1_080));
    for page in [Page::Grinding, Page::Offset, Page::Position] {
        machine.page = page;
        stage.frame(&machine);
        for words in ["子程序 O9050", "O9050 N0000", "G04 X5", "M99"] {
            assert!(stage.texts().iter().any(|(text, ..)| text.contains(words)), "{words} on {page:?}");
        }
    }
    // RESET: the program itself is the current one again.
    crate::stories::tell(&mut rig, "key reset\nwait 0.5 s\nexpect state idle");
    let idle = rig.snapshot().clone();
    for page in [Page::Grinding, Page::Position] {
        stage.frame(&Snapshot { page, ..idle.clone() });
        assert!(!stage.texts().iter().any(|(text, ..)| text.contains("9050 N") || text.contains("子程序")), "{page:?}");
    }
    // A line of MDI is none of the program's.
    let mdi = ProgramView { number: 1_001, line: 1, ..ProgramView::default() };
    assert!(mdi.running_text().is_none() && !mdi.in_subprogram() && !mdi.is_own_line());
    // Of a program that is not in the folder no line is shown, and none of the caller is marked as running.
    machine.program.subprogram_text = None;
    stage.frame(&machine);
    assert!(!stage.texts().iter().any(|(text, ..)| text.contains("M98 P9050")));
}

/// Every text of a page keeps inside its clip and the screen, is not cut, and lies on no other text; else what is wrong.
fn misfits(stage: &mut OffscreenHmi, machine: &Snapshot, what: &str) -> Vec<String> {
    // A sign that the font lacks ends the test.
    stage.ctx().set_missing_glyph_policy(egui::MissingGlyphPolicy::Panic);
    stage.frame(machine);
    let texts = stage.texts();
    let mut wrong = Vec::new();
    for (index, (text, ink, clip, cut)) in texts.iter().enumerate() {
        let what = format!("{text:?} on {:?} {what}", machine.page);
        // The last line of a list may end at its edge.
        let list = matches!(machine.page, Page::Program | Page::Directory);
        // A comment is as long as its author liked.
        let comment = machine.page == Page::Directory && machine.directory.iter().any(|row| row.comment == *text);
        // So is a block of the program, in the strip beside the page.
        let block = machine.program.text.lines().any(|line| line.to_string().trim_end() == text);
        if *cut && !comment && !block {
            wrong.push(format!("{what} is cut"));
        }
        if !list && !clip.expand(0.5).contains_rect(*ink) {
            wrong.push(format!("{what} is clipped: {ink} in {clip}"));
        }
        for (other, place, ..) in &texts[..index] {
            let common: Rect = place.intersect(*ink).shrink(0.75);
            if common.is_positive() {
                wrong.push(format!("{what} {ink} lies on {other:?} {place}"));
            }
        }
    }
    wrong
}

/// The same machine as another kind.
fn of_kind(mut machine: Snapshot, kind: Kind) -> Snapshot {
    machine.kind = kind;
    let three = matches!(kind, Kind::Gs | Kind::Ga);
    machine.axes[Axis::Y] = if three { machine.axes[Axis::X] } else { AxisView::default() };
    machine
}

/// Every row of the alarm table fits into the message line and into its card, whatever comes to stand in it.
#[test]
fn h7_every_alarm_can_be_read_whole() {
    let mut wrong = Vec::new();
    for lang in [Lang::Zh, Lang::En] {
        for size in [(1_024, 768), (768, 1_024)] {
            let mut stage = OffscreenHmi::new(Hmi::new(lang), size);
            for row in ALARMS {
                let mut machine = alarm(Page::Alarm);
                machine.alarms.truncate(1);
                let one = &mut machine.alarms[0];
                (one.number, one.text, one.remedy) = (row.number, row.text.into(), row.remedy.into());
                wrong.extend(misfits(&mut stage, &machine, &format!("alarm {} {lang:?} {size:?}", row.number)));
            }
        }
    }
    assert!(wrong.is_empty(), "{} misfits:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn h9_nothing_is_cut_or_overlaps() {
    let mut wrong = Vec::new();
    for lang in [Lang::Zh, Lang::En] {
        for size in SIZES {
            let mut stage = OffscreenHmi::new(Hmi::new(lang), size);
            for page in Page::ALL {
                let what = |more: &str| format!("{more} {lang:?} {size:?}");
                let page = *page;
                let all = [snapshot(page), running(page), alarm(page), refused(page), troubled(page), busy(page)];
                stage.frame(&all[0]);
                for machine in all {
                    wrong.extend(misfits(&mut stage, &machine, &what("gc")));
                }
                for kind in Kind::ALL {
                    wrong.extend(misfits(&mut stage, &of_kind(long(page), kind), &what(kind.id())));
                    if kind != Kind::Gc && matches!(size, (1_024, 768) | (768, 1_024)) {
                        wrong.extend(misfits(&mut stage, &of_kind(troubled(page), kind), &what(kind.id())));
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{} misfits:\n{}", wrong.len(), wrong.join("\n"));
}

/// The keys that lead to what a page shows only when it is used.
const USES: [(Page, &[&str]); 33] = [
    (Page::Designer, &["→", "→", "⏎"]),
    (Page::Designer, &["→", "→", "→", "⏎"]),
    (Page::Designer, &["→", "→", "→", "→", "⏎"]),
    (Page::Diagnosis, &["→"]),
    (Page::Diagnosis, &["→", "→"]),
    (Page::Diagnosis, &["→", "→", "→"]),
    (Page::Diagnosis, &["→", "→", "→", "→"]),
    (Page::Diagnosis, &["→", "→", "→", "→", "⏎"]),
    (Page::Alarm, &["→"]),
    (Page::Alarm, &["→", "⏎"]),
    (Page::Params, &["/", "p27"]),
    (Page::Params, &["/", "nothing of the kind"]),
    (Page::Params, &["p300", "⏎", "65", "⏎"]),
    (Page::Params, &["p300", "⏎", "11", "⏎", "123", "⏎"]),
    (Page::Offset, &["u", "-0.125"]),
    (Page::Offset, &["→", "→", "1000.25", "⏎"]),
    (Page::Offset, &["m", "-9000.125"]),
    (Page::Dressing, &["w", "12.5", "⏎"]),
    (Page::Macro, &["#", "600", "⏎"]),
    (Page::Macro, &["#", "440", "⏎"]),
    (Page::Wheel, &["5", "⏎"]),
    (Page::Program, &["/", "G01"]),
    (Page::Graphic, &["+", "+"]),
    (Page::Transfer, &["→", "→", "→", "⏎"]),
    (Page::Transfer, &["→", "→", "→", "→", "→", "⏎"]),
    (Page::Transfer, &["→", "→", "→", "→", "→", "→", "⏎"]),
    (Page::Settings, &["→", "⏎", "2019", "⏎"]),
    (Page::Directory, &["→", "→", "⏎", "12345", "⏎"]),
    (Page::Simulator, &["→", "→", "⏎"]),
    (Page::Bus, &["→"]),
    (Page::Process, &["→", "⏎"]),
    (Page::Program, &["/", "NOTHING OF THE KIND", "⏎"]),
    (Page::Wheel, &["550", "⏎", "⏎", "50", "⏎", "⏎"]),
];

fn use_page(stage: &mut OffscreenHmi, machine: &Snapshot, keys: &[&str]) {
    for key in keys {
        let physical = match *key {
            "→" => Some(egui::Key::ArrowRight),
            "⏎" => Some(egui::Key::Enter),
            _ => None,
        };
        let event = match physical {
            Some(key) => egui::Event::Key {
                key,
                physical_key: None,
                pressed: true,
                repeat: false,
                modifiers: egui::Modifiers::NONE,
            },
            None => egui::Event::Text((*key).to_owned()),
        };
        stage.events.push(event);
        stage.frame(machine);
    }
}

#[test]
fn h9_what_is_shown_in_use_fits_as_well() {
    let mut wrong = Vec::new();
    for lang in [Lang::Zh, Lang::En] {
        for size in [(1_024, 768), (1_920, 1_080), (768, 1_024)] {
            let mut stage = OffscreenHmi::new(Hmi::new(lang), size);
            for (page, keys) in USES {
                for machine in [troubled(page), of_kind(running(page), Kind::Gs), busy(page)] {
                    // A page that is opened anew has forgotten what was typed on it.
                    stage.frame(&snapshot(Page::Help));
                    stage.frame(&machine);
                    use_page(&mut stage, &machine, keys);
                    let found = misfits(&mut stage, &machine, &format!("{keys:?} {lang:?} {size:?}"));
                    // The dialog and the pad lie over what stands beneath them.
                    let sheet = ["123", "12345", "2019"].iter().any(|typed| keys.contains(typed));
                    wrong.extend(found.into_iter().filter(|what| !sheet || !what.contains(" lies on ")));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{} misfits:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn h3_every_kind_has_a_panel_that_fits() {
    let mut wrong = Vec::new();
    for lang in [Lang::Zh, Lang::En] {
        for size in SIZES {
            let mut stage = OffscreenHmi::new(Hmi::new(lang), size);
            for kind in Kind::ALL {
                let mut machine = snapshot(Page::Panel);
                machine.kind = kind;
                wrong.extend(misfits(&mut stage, &machine, &format!("{kind:?} {lang:?} {size:?}")));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn k1_the_gauge_keys_are_named_by_the_kind() {
    let mut machine = snapshot(Page::Position);
    assert!(says(&machine, "径向") && !says(&machine, "厚度"));
    machine.kind = Kind::Gs;
    machine.start_guide = StartGuide::default();
    assert!(says(&machine, "厚度") && says(&machine, "平面") && says(&machine, "充磁") && !says(&machine, "尾座"));
}

/// The text of a source file that stands in quotes, without its comments.
fn quoted(text: &str) -> String {
    let lines = text.lines().filter(|line| !line.trim_start().starts_with("//"));
    lines.flat_map(|line| line.split('"').skip(1).step_by(2)).collect()
}

#[test]
fn h9_every_sign_of_every_text_is_in_the_font() {
    let mut stage = OffscreenHmi::new(Hmi::new(Lang::Zh), (1_024, 768));
    stage.frame(&snapshot(Page::Position));
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("src")];
    let mut missing = Vec::new();
    while let Some(folder) = folders.pop() {
        for path in std::fs::read_dir(folder).expect("src").filter_map(Result::ok).map(|entry| entry.path()) {
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let words = quoted(&std::fs::read_to_string(&path).expect("a source file"));
            let signs = words.chars().filter(|sign| !sign.is_ascii() && !sign.is_control());
            let lacks = |sign: &char| !stage.ctx().fonts_mut(|fonts| fonts.has_glyph(&font(15.0), *sign));
            missing.extend(signs.filter(lacks).map(|sign| format!("{sign:?} in {}", path.display())));
        }
    }
    assert!(missing.is_empty(), "{missing:?}");
}

/// Every text colour with its backgrounds: each pair has 4.5 : 1 or more.
fn text_pairs(theme: &Theme) -> Vec<(&'static str, Color32, Color32)> {
    let grounds = [theme.background, theme.surface, theme.raised];
    let on_grounds = |name, ink: Color32| grounds.into_iter().map(move |ground| (name, ink, ground));
    let mut pairs: Vec<_> = on_grounds("text", theme.text).chain(on_grounds("quiet", theme.muted)).collect();
    pairs.extend(on_grounds("hold", theme.hold).chain(on_grounds("info", theme.info)));
    pairs.extend(on_grounds("run", theme.run).chain(on_grounds("alarm text", theme.alarm_text)));
    pairs.extend(on_grounds("macros", theme.macros));
    let fills = [theme.run, theme.hold, theme.alarm, theme.info, theme.focus];
    pairs.extend(fills.into_iter().map(|fill| ("ink", theme.on_accent, fill)));
    pairs.push(("emergency stop", theme.stop_text, theme.stop_background));
    // Blocked keys are flat on the surface; their labels must stay readable.
    pairs.extend([theme.background, theme.surface].into_iter().map(|ground| ("dim", theme.disabled, ground)));
    pairs.extend([theme.paper_ink, theme.paper_accent].into_iter().map(|ink| ("paper", ink, theme.paper)));
    pairs
}

/// Contrast of two colours, 1 to 21.
/// Source: WCAG 2.1, relative luminance.
fn contrast(a: Color32, b: Color32) -> f64 {
    let luminance = |colour: Color32| {
        let linear = |channel: u8| {
            let value = f64::from(channel) / 255.0;
            if value <= 0.040_45 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * linear(colour.r()) + 0.7152 * linear(colour.g()) + 0.0722 * linear(colour.b())
    };
    let (a, b) = (luminance(a), luminance(b));
    (a.max(b) + 0.05) / (a.min(b) + 0.05)
}

#[test]
fn h4_text_has_contrast() {
    for (name, ink, ground) in text_pairs(&DARK).into_iter().chain(text_pairs(&LIGHT)) {
        let ratio = contrast(ink, ground);
        assert!(ratio >= 4.5, "{name} {ink:?} on {ground:?}: {ratio:.2}");
    }
}

/// The text of the last frame that is too faint on what lies beneath it.
fn faint(stage: &OffscreenHmi, ground: Color32, what: &str) -> Vec<String> {
    let mut grounds: Vec<(Rect, Color32)> = vec![(Rect::EVERYTHING, ground)];
    let mut wrong = Vec::new();
    for clipped in stage.shapes() {
        look(&clipped.shape, clipped.clip_rect, &mut grounds, &mut |text, ink, ground| {
            let ratio = contrast(ink, ground);
            if ratio < 4.5 {
                wrong.push(format!("{text:?} {ink:?} on {ground:?}: {ratio:.2} {what}"));
            }
        });
    }
    wrong
}

/// Goes through what was painted: fills lie one on the other, a text is told with its ink and the ground in its middle.
fn look(shape: &Shape, clip: Rect, grounds: &mut Vec<(Rect, Color32)>, told: &mut impl FnMut(&str, Color32, Color32)) {
    let fill = |grounds: &mut Vec<(Rect, Color32)>, rect: Rect, fill: Color32| {
        if fill.a() > 0 && rect.intersects(clip) {
            grounds.push((rect.intersect(clip), fill));
        }
    };
    match shape {
        Shape::Vec(shapes) => shapes.iter().for_each(|shape| look(shape, clip, grounds, told)),
        Shape::Rect(rect) => fill(grounds, rect.rect, rect.fill),
        Shape::Circle(circle) => {
            fill(grounds, Rect::from_center_size(circle.center, egui::Vec2::splat(circle.radius)), circle.fill);
        }
        Shape::Text(text) => {
            let ink = text.galley.mesh_bounds.translate(text.pos.to_vec2());
            let beneath = grounds.iter().filter(|(rect, _)| rect.contains(ink.center()));
            let ground = beneath.fold(Color32::BLACK, |under, (_, over)| under.blend(*over));
            for section in text.galley.job.sections.iter().filter(|_| clip.intersects(ink)) {
                let colour = text.override_text_color.unwrap_or(section.format.color);
                let colour = if colour == Color32::PLACEHOLDER { text.fallback_color } else { colour };
                told(&text.galley.job.text, colour, ground);
            }
        }
        _ => {}
    }
}

#[test]
fn h4_what_is_painted_has_contrast() {
    let mut wrong = Vec::new();
    for light in [false, true] {
        let mut hmi = Hmi::new(Lang::Zh);
        hmi.set_light(light);
        let mut stage = OffscreenHmi::new(hmi, (1_024, 768));
        for page in Page::ALL {
            for kind in [Kind::Gc, Kind::Ga] {
                for machine in [running(*page), refused(*page), troubled(*page), busy(*page)] {
                    stage.frame(&of_kind(machine, kind));
                    let (theme, name) = if light { (&LIGHT, "light") } else { (&DARK, "dark") };
                    wrong.extend(faint(&stage, theme.background, &format!("{page:?} {kind:?} {name}")));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{} faint texts:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn h1_the_scale_follows_the_display() {
    let scale = |x: f32, y: f32| (scale(egui::vec2(x, y)) * 10.0).round() as i32;
    assert_eq!((scale(1_024.0, 768.0), scale(1_280.0, 800.0), scale(1_920.0, 1_080.0)), (10, 10, 14));
    assert_eq!((scale(768.0, 1_024.0), scale(3_840.0, 2_160.0), scale(800.0, 600.0)), (10, 28, 7));
}

#[test]
fn k5_12_page_pictures_are_of_the_form() {
    for name in ["B0001.BMP", "B0002.BMP", "B0100.BMP"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("screens").join(name);
        let bytes = std::fs::read(&path).expect(name);
        assert_eq!(bytes.len(), 240_054, "{name}");
        assert_eq!((&bytes[..2], bytes[28], bytes[30]), (&b"BM"[..], 24, 0), "{name}: 24 bit, uncompressed");
        let picture = image::open(&path).expect(name);
        assert_eq!((picture.width(), picture.height()), (200, 400), "{name}");
    }
}

/// The committed picture; after a wanted change take the new one from the place that the message names.
#[test]
fn h1_the_grinding_page_looks_as_committed() {
    let machine = snapshot(Page::Grinding);
    let picture = screenshot(&machine, Lang::Zh, (1_024, 768));
    assert!(picture == screenshot(&machine, Lang::Zh, (1_024, 768)), "two shots differ");
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/hmi/grinding.png");
    let committed = image::open(&path).map(|read| read.to_rgba8());
    if committed.is_ok_and(|committed| committed == picture) {
        return;
    }
    let new = std::env::temp_dir().join("kt830_grinding.png");
    picture.save(&new).expect("the temporary folder can be written");
    panic!("the grinding page differs from {}; the new one is {}", path.display(), new.display());
}

#[test]
fn b7_lengths_show_three_or_four_decimals_by_parameter() {
    let mut machine = snapshot(Page::Position);
    machine.axes[Axis::X] = AxisView { work: 40.123_46, ..machine.axes[Axis::X] };
    assert!(says(&machine, "40.123") && !says(&machine, "40.1235"));
    let mut params = (*machine.params).clone();
    params.write(param::FINE_DISPLAY.address(), 1.0).unwrap();
    (machine.axes[Axis::X].decimals, machine.params) = (params.length_decimals(), Arc::new(params));
    assert!(says(&machine, "40.1235"));
}

/// Values of the grinding page: 0.0005 is 0.0005, a count has no decimals, a switch neither.
#[test]
fn k7_2_values_show_as_many_decimals_as_they_need() {
    let mut machine = snapshot(Page::Grinding);
    let text = machine.screens.find(1_001).unwrap().text.as_ref().unwrap().clone();
    let row = |of: &dyn Fn(&str) -> bool| {
        text.left.iter().chain(&text.right).flatten().find(|row| of(&row.label)).unwrap().variable
    };
    let (stock, count) = (row(&|label| label.contains("精磨余量")), row(&|label| label.contains("次数")));
    machine.variables[usize::from(stock)] = Some(0.000_5);
    machine.variables[usize::from(count)] = Some(7.0);
    let texts = page_text(&machine, Lang::Zh);
    assert!(texts.iter().any(|text| text == "0.0005") && texts.iter().any(|text| text == "7"), "{texts:?}");
    assert!(!texts.iter().any(|text| text == "0.001" || text == "7.000"), "{texts:?}");
}

#[test]
fn h7_grinding_feeds_show_the_digits_that_they_have() {
    for (feed, shown) in
        [(0.3, "0.3"), (1.2, "1.2"), (0.021_5, "0.0215"), (29.94, "29.9"), (1_500.4, "1500"), (0.0, "0")]
    {
        let mut machine = snapshot(Page::Position);
        machine.feed_mm_min = feed;
        let texts = page_text(&machine, Lang::Zh);
        let status = format!("{shown} mm/min");
        assert!(texts.contains(&status), "{feed}: {texts:?}");
    }
}

/// The languages that come with the control are cut nowhere, either; the base display is the narrowest.
#[test]
fn h9_nothing_is_cut_in_the_shipped_languages() {
    let mut wrong = Vec::new();
    for language in AddedLanguages::read(Path::new("no folder")).languages {
        let lang = Lang::Added(language.keep());
        let mut stage = OffscreenHmi::new(Hmi::new(lang), (1_024, 768));
        for page in Page::ALL {
            for machine in [snapshot(*page), running(*page), busy(*page)] {
                wrong.extend(misfits(&mut stage, &machine, lang.code()));
            }
            for kind in Kind::ALL {
                wrong.extend(misfits(&mut stage, &of_kind(snapshot(*page), kind), kind.id()));
            }
        }
    }
    let mut lines: Vec<_> = wrong.into_iter().collect();
    lines.sort();
    lines.dedup();
    assert!(lines.is_empty(), "{} misfits:\n{}", lines.len(), lines.join("\n"));
}
