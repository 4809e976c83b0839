//! Typing on the grinding page, by touch and by keyboard, and the refusal. Soft keys and the directory.

use crate::sample::{C0001, snapshot};
use crate::screen::{Screen, open};
use egui::Event;
use egui_kittest::kittest::Queryable;
use kt830::defs::kind::Kind;
use kt830::defs::page::Page;
use kt830::defs::page_text;
use kt830::defs::soft_key::{CoordinateView, ROWS as SOFT_ROWS, SoftKeyAction, row as soft_row};
use kt830::defs::text::{Lang, LocalizedText};
use kt830::hmi::field_editor::{CoreAnswer, FieldEditor};
use kt830::hmi::variable_entry::{VariableEntry, parse_value};
use kt830::link::Snapshot;
use kt830::link::edit::EditAnswer;
use kt830::link::screens::{ScreenFiles, Screens};
use std::sync::Arc;

fn touch(screen: &mut Screen, label: &str) {
    screen.get_by_label(label).click();
    for _ in 0..4 {
        screen.step();
    }
}

fn press(screen: &mut Screen, key: egui::Key) {
    screen.key_press(key);
    screen.step();
    screen.step();
}

fn write(screen: &mut Screen, text: &str) {
    screen.event(Event::Text(text.to_owned()));
    screen.step();
}

/// The grinding page of this text.
fn open_page(text: &str) -> Screen {
    let mut machine = snapshot(Page::Grinding);
    let text = page_text::parse(text).map(Arc::new).expect("the sample is right");
    let picture = crate::sample::picture("B0001.BMP");
    let files = ScreenFiles {
        text: Ok(text),
        english_fault: None,
        picture: Ok(picture),
        labels: Vec::new(),
        labels_fault: None,
    };
    machine.screens = Arc::new(Screens { pages: vec![(1_001, files)], dressing: None });
    open(machine)
}

fn entry(screen: &Screen) -> &VariableEntry {
    screen.state().hmi.variable_entry().unwrap()
}

fn sent(screen: &mut Screen) -> Vec<String> {
    std::mem::take(&mut screen.state_mut().sent).iter().map(|command| format!("{command:?}")).collect()
}

#[test]
fn h6_by_touch_a_value_is_typed_stored_and_the_next_field_chosen() {
    let mut screen = open(snapshot(Page::Grinding));
    touch(&mut screen, "左卡磨耗余量 #505");
    for key in ["pad-0", "pad-point", "pad-0", "pad-3", "pad-5", "pad-back", "pad-sign"] {
        touch(&mut screen, key);
    }
    assert_eq!(entry(&screen).editor.text, "-0.03");
    assert!(sent(&mut screen).is_empty(), "nothing is stored before 输入");
    touch(&mut screen, "输入 input");
    assert_eq!(sent(&mut screen), ["EnterVariable(505, Some(-0.03))"]);
    assert_eq!(entry(&screen).cursor, 5, "the next field is chosen");
}

#[test]
fn h6_cancel_restores_then_closes_the_pad() {
    let mut screen = open(snapshot(Page::Grinding));
    touch(&mut screen, "卡尺X轴始磨位置 #500");
    touch(&mut screen, "pad-9");
    touch(&mut screen, "取消 cancel");
    assert!(entry(&screen).editor.text.is_empty());
    touch(&mut screen, "取消 cancel");
    assert!(screen.query_by_label("pad-9").is_none());
    assert!(sent(&mut screen).is_empty());
}

#[test]
fn h6_physical_keys_do_the_same() {
    let mut screen = open(snapshot(Page::Grinding));
    press(&mut screen, egui::Key::ArrowDown);
    write(&mut screen, "-12.75");
    press(&mut screen, egui::Key::Enter);
    press(&mut screen, egui::Key::Tab);
    write(&mut screen, "7");
    press(&mut screen, egui::Key::Backspace);
    write(&mut screen, "8");
    press(&mut screen, egui::Key::Enter);
    write(&mut screen, "1");
    press(&mut screen, egui::Key::Escape);
    press(&mut screen, egui::Key::ArrowRight);
    assert_eq!(sent(&mut screen), ["EnterVariable(501, Some(-12.75))", "EnterVariable(504, Some(8.0))"]);
    assert_eq!(entry(&screen).cursor, 12, "the arrow goes to the field beside it");
}

#[test]
fn k7_5_a_refused_value_stays_with_its_reason_until_the_next_key() {
    let mut screen = open_page(&C0001.replace("#508", "#570"));
    touch(&mut screen, "精磨进给方式 #570");
    write(&mut screen, "2");
    press(&mut screen, egui::Key::Enter);
    assert!(sent(&mut screen).is_empty());
    assert_eq!(entry(&screen).editor.refusal(Lang::Zh).as_deref(), Some("只能输入 0 或 1"));
    assert_eq!(entry(&screen).editor.text, "2");
    write(&mut screen, "1");
    assert_eq!(entry(&screen).editor.refusal(Lang::Zh), None);
    press(&mut screen, egui::Key::Enter);
    assert_eq!(sent(&mut screen), ["EnterVariable(570, Some(1.0))"]);
    write(&mut screen, "100000");
    press(&mut screen, egui::Key::Enter);
    assert_eq!(entry(&screen).editor.refusal(Lang::En).as_deref(), Some("out of range ±99999.999"));
    assert!(sent(&mut screen).is_empty());
}

#[test]
fn h6_a_digit_with_alt_is_a_panel_key_and_types_nothing() {
    let mut screen = open(snapshot(Page::Grinding));
    let key = |pressed| Event::Key {
        key: egui::Key::Num5,
        physical_key: None,
        pressed,
        repeat: false,
        modifiers: egui::Modifiers::ALT,
    };
    screen.input_mut().events.extend([key(true), Event::Text("5".to_owned()), key(false)]);
    screen.step();
    screen.step();
    assert_eq!(sent(&mut screen), ["Press(Step001)", "Release(Step001)"]);
    assert_eq!(entry(&screen).editor.text, "");
}

#[test]
fn h6_the_space_bar_types_where_words_are_typed_and_holds_everywhere_else() {
    let held = ["Press(FeedHold)", "Release(FeedHold)"];
    let struck = |machine: Snapshot| {
        let mut screen = open(machine);
        press(&mut screen, egui::Key::Space);
        sent(&mut screen)
    };
    assert!(struck(snapshot(Page::Mdi)).is_empty());
    assert_eq!(struck(crate::sample::running(Page::Mdi)), held, "while something runs it stops that");
    assert_eq!(struck(snapshot(Page::Position)), held);
    assert_eq!(struck(snapshot(Page::Program)), held, "the listing alone takes no words");
}

#[test]
fn k7_1_soft_keys_open_their_pages_by_touch_and_by_f_key() {
    let keys = [egui::Key::F1, egui::Key::F2, egui::Key::F3, egui::Key::F4, egui::Key::F5];
    let mut machine = snapshot(Page::Position);
    machine.simulated = crate::sample::busy(Page::Position).simulated;
    let mut screen = open(machine);
    for row in 0..SOFT_ROWS {
        for (index, soft) in soft_row(Kind::Gc, row).enumerate() {
            let wanted = match soft.action {
                SoftKeyAction::Open(page) => Some(format!("OpenPage({page:?})")),
                SoftKeyAction::Position(coordinates) => Some(format!("ShowCoordinates({coordinates:?})")),
                SoftKeyAction::Print | SoftKeyAction::Continue => None,
            };
            touch(&mut screen, &format!("{} f{}", soft.label.zh, index + 1));
            assert_eq!(sent(&mut screen), Vec::from_iter(wanted.clone()), "{}", soft.label.en);
            press(&mut screen, keys[index]);
            assert_eq!(sent(&mut screen), Vec::from_iter(wanted), "{}", soft.label.en);
        }
        touch(&mut screen, "▶ next-row");
        let next = (row + 1) % SOFT_ROWS;
        assert_eq!(sent(&mut screen), [format!("ShowSoftKeyRow({next})")]);
        screen.state_mut().snapshot.soft_key_row = next;
        screen.step();
    }
}

#[test]
fn b6_the_directory_loads_by_its_own_key_only() {
    let mut screen = open(snapshot(Page::Directory));
    touch(&mut screen, "O1002");
    assert!(sent(&mut screen).is_empty(), "choosing does not load");
    touch(&mut screen, "装入 load-program");
    assert_eq!(sent(&mut screen), ["LoadProgram(1002)", "OpenPage(Grinding)"], "its page opens");
    press(&mut screen, egui::Key::ArrowDown);
    press(&mut screen, egui::Key::Enter);
    assert_eq!(sent(&mut screen), ["LoadProgram(1003)", "OpenPage(Grinding)"]);
}

#[test]
fn k4_2_on_the_relative_page_letters_and_answers_are_keys() {
    let mut machine = snapshot(Page::Position);
    machine.coordinates = CoordinateView::Relative;
    let mut screen = open(machine);
    for (label, key) in [("X address-x", "AddressX"), ("输入 input", "Input"), ("取消 cancel", "Cancel")] {
        touch(&mut screen, label);
        assert_eq!(sent(&mut screen), [format!("Press({key})"), format!("Release({key})")]);
    }
    touch(&mut screen, "清零 Z");
    assert_eq!(sent(&mut screen), ["ClearRelative(Z)"]);
}

#[test]
fn k2_4_in_the_other_views_the_address_key_is_asked_why_not() {
    let mut screen = open(snapshot(Page::Position));
    assert!(screen.query_by_label("X address-x").is_none(), "the letter is no key in the view 综合");
    press(&mut screen, egui::Key::X);
    assert_eq!(sent(&mut screen), ["Press(AddressX)", "Release(AddressX)"], "the core says why");
    let mut screen = open(snapshot(Page::Alarm));
    press(&mut screen, egui::Key::X);
    assert!(sent(&mut screen).is_empty());
}

#[test]
fn h8_a_program_without_page_leads_to_the_directory() {
    let mut machine = snapshot(Page::Grinding);
    machine.program.number = 2_000;
    let mut screen = open(machine);
    touch(&mut screen, "打开目录");
    assert_eq!(sent(&mut screen), ["OpenPage(Directory)"]);
}

#[test]
fn h7_chip_and_message_line_open_the_alarm_page() {
    let mut screen = open(crate::sample::alarm(Page::Grinding));
    touch(&mut screen, "报警 alarm-list");
    assert_eq!(sent(&mut screen), ["OpenPage(Alarm)"]);
    touch(&mut screen, "报警 alarm-chip");
    assert_eq!(sent(&mut screen), ["OpenPage(Alarm)"]);
    press(&mut screen, egui::Key::F7);
    assert_eq!(sent(&mut screen), ["OpenPage(Alarm)"]);
}

#[test]
fn k2_1_the_help_key_lays_the_keyboards_map_over_the_page() {
    let mut screen = open(snapshot(Page::Grinding));
    touch(&mut screen, "? help");
    assert!(screen.query_by_label("关闭帮助 close-help").is_some());
    touch(&mut screen, "关闭帮助 close-help");
    assert!(screen.query_by_label("关闭帮助 close-help").is_none());
    for closes in [egui::Key::F12, egui::Key::Escape] {
        press(&mut screen, egui::Key::F12);
        assert!(screen.query_by_label("关闭帮助 close-help").is_some());
        press(&mut screen, closes);
        assert!(screen.query_by_label("关闭帮助 close-help").is_none());
    }
    assert!(sent(&mut screen).is_empty());
}

#[test]
fn h6_range_and_form_are_checked() {
    assert!(parse_value(500, "99999.999").is_ok() && parse_value(500, "-99999.999").is_ok());
    for bad in ["100000", "1e9", "nan", "inf", "", "-", ".", "1.2.3"] {
        assert!(parse_value(500, bad).is_err(), "{bad:?}");
    }
    for bad in ["2", "0.5", "-1", "1.0000001"] {
        assert!(parse_value(575, bad).is_err(), "{bad:?}");
    }
    assert!(parse_value(575, "0").is_ok() && parse_value(579, "1").is_ok());
}

/// Three fields on the left, one on the right.
const FOUR_FIELDS: &str = "试;\n甲 #500;\n乙 #570;\n丙 #502;\n;\n;\n;\n;\n;\n;\n;\n丁 #510;\n%\n";

#[test]
fn h6_enter_stores_and_moves_on() {
    let mut screen = open_page(FOUR_FIELDS);
    write(&mut screen, "-40.25");
    press(&mut screen, egui::Key::Enter);
    assert_eq!(sent(&mut screen), ["EnterVariable(500, Some(-40.25))"]);
    assert_eq!((entry(&screen).cursor, entry(&screen).editor.text.as_str()), (1, ""));
}

#[test]
fn k7_5_switches_take_zero_or_one_and_the_refused_text_stays() {
    let mut screen = open_page(FOUR_FIELDS);
    press(&mut screen, egui::Key::ArrowDown);
    write(&mut screen, "2");
    press(&mut screen, egui::Key::Enter);
    assert!(sent(&mut screen).is_empty());
    let editor = &entry(&screen).editor;
    assert_eq!((editor.text.as_str(), editor.refusal(Lang::En).as_deref()), ("2", Some("only 0 or 1")));
    write(&mut screen, "1");
    let editor = &entry(&screen).editor;
    assert_eq!((editor.text.as_str(), editor.refused.is_none()), ("1", true));
    press(&mut screen, egui::Key::Enter);
    assert_eq!(sent(&mut screen), ["EnterVariable(570, Some(1.0))"]);
}

#[test]
fn h6_arrows_reach_every_field() {
    use egui::Key::{ArrowDown, ArrowLeft, ArrowRight, ArrowUp};
    let mut screen = open_page(FOUR_FIELDS);
    for (key, field) in [(ArrowRight, 3), (ArrowLeft, 0), (ArrowUp, 3), (ArrowDown, 0)] {
        press(&mut screen, key);
        assert_eq!(entry(&screen).cursor, field, "{key:?}");
    }
}

#[test]
fn h6_what_the_core_refuses_comes_back_with_its_reason() {
    let mut typing = FieldEditor::default();
    typing.text.push_str("1.5");
    typing.send(7);
    assert!(typing.text.is_empty());
    let no = EditAnswer { count: 1, refused: Some(LocalizedText::new("不行", "no")) };
    assert_eq!(typing.poll_answer(&no), CoreAnswer::Refused(7));
    assert_eq!((typing.text.as_str(), typing.refusal(Lang::En).as_deref()), ("1.5", Some("no")));
    assert_eq!(typing.poll_answer(&no), CoreAnswer::Nothing, "an answer counts once");
}

#[test]
fn h6_a_refusal_does_not_disturb_what_is_being_typed() {
    let mut typing = FieldEditor::default();
    typing.text.push('1');
    typing.send(0);
    typing.text.push('9');
    let no = EditAnswer { count: 1, refused: Some(LocalizedText::new("不行", "no")) };
    assert_eq!(typing.poll_answer(&no), CoreAnswer::Nothing);
    assert_eq!((typing.text.as_str(), typing.refused), ("9", None));
}
