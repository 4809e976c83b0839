//! What the keys do to the text of a program: typing, deleting, blocks, search, replacing, renumbering. Its colours.

use egui::{Color32, Event, Key, Modifiers, Shape};
use kt830::defs::page::Page;
use kt830::defs::text::Lang;
use kt830::hmi::Hmi;
use kt830::hmi::offscreen::OffscreenHmi;
use kt830::hmi::theme::{DARK, Theme};

use crate::editor::Shop;

/// A program of this text, being edited.
fn open(text: &str) -> Shop {
    let mut shop = Shop::new(text.as_bytes());
    shop.tell("param P22.5 0\nmode edit");
    shop.bench.touch("编辑 edit-begin");
    shop
}

fn press(shop: &mut Shop, key: Key, times: usize) {
    (0..times).for_each(|_| shop.bench.press(key));
}

fn ctrl(shop: &mut Shop, key: Key) {
    shop.key(key, Modifiers::CTRL);
}

fn clipboard(shop: &mut Shop, event: Event) {
    shop.bench.screen.event(event);
    shop.bench.turn();
}

/// Whether the cursor is in this line and column, from 1, of a text of so many lines.
fn is_at(shop: &Shop, line: usize, column: usize, lines: usize) -> bool {
    shop.bench.shows(&format!("行 {line}:{column} / {lines}"))
}

/// Types into a prompt in place of what stands there.
fn answer(shop: &mut Shop, text: &str) {
    press(shop, Key::Backspace, 8);
    shop.bench.write(text);
    shop.bench.press(Key::Enter);
}

fn find(shop: &mut Shop, what: &str) {
    ctrl(shop, Key::F);
    answer(shop, what);
}

#[test]
fn b6_typing_is_one_step_back() {
    let mut shop = open("G00\r\nM30\r\n");
    shop.bench.press(Key::End);
    shop.bench.write(" X10");
    shop.bench.press(Key::Enter);
    assert_eq!(shop.text(), "G00 X10\r\n\r\nM30\r\n", "a new line ends as the others do");
    ctrl(&mut shop, Key::Z);
    ctrl(&mut shop, Key::Z);
    assert_eq!(shop.text(), "G00\r\nM30\r\n");
    ctrl(&mut shop, Key::Z);
    assert_eq!(shop.text(), "G00\r\nM30\r\n", "there is nothing more to undo");
    ctrl(&mut shop, Key::Y);
    assert_eq!(shop.text(), "G00 X10\r\nM30\r\n");
}

#[test]
fn b6_deleting_by_either_key_is_one_step_back() {
    for key in [Key::Delete, Key::Backspace] {
        let mut shop = open("G00 X10\r\nM30\r\n");
        press(&mut shop, Key::ArrowRight, if key == Key::Delete { 0 } else { 4 });
        press(&mut shop, key, 4);
        assert_eq!(shop.text(), "X10\r\nM30\r\n");
        ctrl(&mut shop, Key::Z);
        assert_eq!(shop.text(), "G00 X10\r\nM30\r\n", "{key:?}");
    }
    // A line end goes whole; the end of the text stays.
    let mut shop = open("A\r\nB\r\n");
    press(&mut shop, Key::ArrowRight, 1);
    press(&mut shop, Key::Delete, 1);
    assert!(shop.text() == "AB\r\n" && is_at(&shop, 1, 2, 1), "{}", shop.text());
    press(&mut shop, Key::ArrowRight, 1);
    press(&mut shop, Key::Delete, 1);
    assert_eq!(shop.text(), "AB\r\n");
}

#[test]
fn b6_back_takes_a_line_end_whole_and_stops_at_the_beginning() {
    let mut shop = open("A\r\nB");
    press(&mut shop, Key::ArrowDown, 1);
    press(&mut shop, Key::Backspace, 1);
    assert!(shop.text() == "AB" && is_at(&shop, 1, 2, 1), "{}", shop.text());
    press(&mut shop, Key::Backspace, 2);
    assert_eq!(shop.text(), "B");
}

#[test]
fn b6_a_block_is_copied_and_moved_by_lines() {
    let mut shop = open("1\n2\n3\n4");
    press(&mut shop, Key::ArrowDown, 1);
    ctrl(&mut shop, Key::M);
    press(&mut shop, Key::ArrowDown, 1);
    clipboard(&mut shop, Event::Cut);
    assert_eq!(shop.text(), "1\n4");
    press(&mut shop, Key::ArrowUp, 1);
    clipboard(&mut shop, Event::Paste(String::new()));
    assert!(shop.text() == "2\n3\n1\n4" && is_at(&shop, 3, 1, 4), "{}", shop.text());
    // The last line has no line end; a copied block gets one.
    press(&mut shop, Key::ArrowDown, 1);
    ctrl(&mut shop, Key::M);
    clipboard(&mut shop, Event::Copy);
    clipboard(&mut shop, Event::Paste(String::new()));
    assert_eq!(shop.text(), "2\n3\n1\n4\n4");
}

#[test]
fn b6_the_cursor_keeps_inside_the_text() {
    let mut shop = open("AB\nC\n");
    press(&mut shop, Key::ArrowLeft, 1);
    press(&mut shop, Key::PageUp, 1);
    assert!(is_at(&shop, 1, 1, 2));
    press(&mut shop, Key::PageDown, 2);
    press(&mut shop, Key::End, 1);
    assert!(is_at(&shop, 2, 2, 2));
    press(&mut shop, Key::ArrowRight, 2);
    assert!(is_at(&shop, 2, 2, 2));
    let mut none = open("");
    for key in [Key::Backspace, Key::ArrowRight, Key::ArrowLeft] {
        press(&mut none, key, 1);
    }
    ctrl(&mut none, Key::M);
    none.bench.touch("删除 edit-delete");
    assert!(none.text().is_empty() && is_at(&none, 1, 1, 1));
}

#[test]
fn b6_a_word_is_found_once_around_in_any_case() {
    let mut shop = open("N10 G00 X1\nN20 g01 X2 (磨)\nN30 M30\n");
    find(&mut shop, "G01");
    assert!(is_at(&shop, 2, 8, 3));
    find(&mut shop, "g01");
    assert!(shop.refusal().is_empty() && is_at(&shop, 2, 8, 3), "around the end");
    find(&mut shop, "磨");
    assert!(is_at(&shop, 2, 14, 3));
    find(&mut shop, "");
    assert!(shop.refusal().is_empty() && is_at(&shop, 2, 14, 3), "nothing is no word");
    find(&mut shop, "G02");
    assert_eq!(shop.refusal(), "没有找到 G02");
}

#[test]
fn b6_a_block_is_found_by_its_number_not_by_what_begins_alike() {
    let mut shop = open("(N20)\nN200 G00\nGOTO 20\n/N0020 X1\n");
    ctrl(&mut shop, Key::G);
    answer(&mut shop, "N20");
    assert!(is_at(&shop, 4, 1, 4), "the fourth line");
    ctrl(&mut shop, Key::G);
    answer(&mut shop, "N2");
    assert_eq!(shop.refusal(), "没有找到 N2");
}

#[test]
fn b6_replace_all_counts() {
    let mut shop = open("x1 X1.\nY\nX10");
    ctrl(&mut shop, Key::H);
    answer(&mut shop, "x1");
    answer(&mut shop, "X20");
    shop.bench.touch("全部 replace-all");
    assert_eq!(shop.text(), "X20 X20.\nY\nX200");
    assert!(shop.bench.shows("改了 3 处"));
    ctrl(&mut shop, Key::H);
    answer(&mut shop, "Q");
    answer(&mut shop, "R");
    assert_eq!(shop.refusal(), "没有找到 Q");
}

fn renumbered(text: &str, how: &str) -> Shop {
    let mut shop = open(text);
    ctrl(&mut shop, Key::R);
    answer(&mut shop, how);
    shop
}

#[test]
fn b6_renumbering_takes_the_jumps_along() {
    let text = "O1001\nN5 G00 X1\n/N7 IF[#1 EQ 0] GOTO 5\nG01 X2\nN9 GOTO N7\nM30\n%";
    assert_eq!(
        renumbered(text, "10 10").text(),
        "O1001\nN0010 G00 X1\n/N0020 IF[#1 EQ 0] GOTO 10\nG01 X2\nN0030 GOTO N20\nM30\n%"
    );
    // A label of the 802D is no block number.
    let jumps = "N5 G0\nGOTOB N5\nIF R1>2 GOTOF N7\nGOTOF NN5\nN7 M2";
    assert_eq!(renumbered(jumps, "10 10").text(), "N0010 G0\nGOTOB N10\nIF R1>2 GOTOF N20\nGOTOF NN5\nN0020 M2");
    // If no block has a number, all get one.
    assert_eq!(renumbered("O1\nG00\n(a)\nM30\n%", "1 1").text(), "O1\nN0001 G00\n(a)\nN0002 M30\n%");
}

#[test]
fn b6_renumbering_refuses_what_it_cannot_follow() {
    for text in ["N1 GOTO #1", "N1 M99 P1", "N1 G65 H80 P1", "N1 G0\nN1 G1", "N1 M01 L5"] {
        let shop = renumbered(text, "10 10");
        assert!(shop.refusal().contains("手工改段号") || shop.refusal().contains("出现两次"), "{text}");
        assert_eq!(shop.text(), text);
    }
}

#[test]
fn b6_a_line_that_is_cut_says_so() {
    let dots = |line: &str| {
        let mut machine = crate::sample::snapshot(Page::Program);
        machine.program.text = line.into();
        let mut stage = OffscreenHmi::new(Hmi::new(Lang::Zh), (768, 1_024));
        stage.frame(&machine);
        let cut = |clipped: &&egui::epaint::ClippedShape| match &clipped.shape {
            Shape::Text(text) => text.galley.job.text == line && text.galley.elided,
            _ => false,
        };
        stage.shapes().iter().filter(cut).count()
    };
    let comment = format!("({})", "X".repeat(120));
    assert_eq!((dots(&comment), dots("N10 G01 X40.2 F0.3")), (1, 0));
}

/// The lines of a program as they are painted: the whole text and its tokens with their colours.
fn painted(lines: &[&str]) -> Vec<(String, Vec<(String, Color32)>)> {
    let mut machine = crate::sample::snapshot(Page::Program);
    machine.program.text = lines.join("\n").as_str().into();
    let mut stage = OffscreenHmi::new(Hmi::new(Lang::Zh), (768, 1_024));
    stage.frame(&machine);
    let texts = stage.shapes().iter().filter_map(|clipped| match &clipped.shape {
        Shape::Text(text) => Some(&text.galley.job),
        _ => None,
    });
    let tokens = |job: &egui::text::LayoutJob| {
        job.sections
            .iter()
            .map(|part| (job.text[part.byte_range.start.0..part.byte_range.end.0].to_owned(), part.format.color))
            .collect()
    };
    texts.map(|job| (job.text.clone(), tokens(job))).collect()
}

type Colour = fn(&Theme) -> Color32;

/// Each line is painted whole, and begins with this text in one colour: a token, or neighbours of the same colour.
fn begins_with(lines: &[(&str, &str, Colour)]) {
    let all = painted(&lines.iter().map(|(line, ..)| *line).collect::<Vec<_>>());
    for (line, token, colour) in lines {
        let (_, tokens) = all.iter().find(|(text, _)| text == line).expect(line);
        assert_eq!(tokens[0], ((*token).to_owned(), colour(&DARK)), "{line}");
    }
}

#[test]
fn b6_every_byte_of_a_line_is_painted_once() {
    let lines =
        ["N10 G01 X-1.5 (到位) M03", "WHILE[#1 LT 5]DO1", "#100=#101+2*[3]", "// 注", "；全角", "", "X1//y", "/G00"];
    let all = painted(&lines);
    for line in lines.into_iter().filter(|line| !line.is_empty()) {
        assert!(all.iter().any(|(text, _)| text == line), "{line}");
    }
    begins_with(&[
        ("G01X1", "G01", |theme| theme.info),
        ("(a)b", "(a)", |theme| theme.muted),
        ("#100=1", "#100=", |theme| theme.macros),
        ("#100X1", "#100", |theme| theme.macros),
        ("EQ5", "EQ", |theme| theme.macros),
        ("X1Y2", "X1Y2", |theme| theme.text),
        ("X1G01", "X1", |theme| theme.text),
    ]);
}

#[test]
fn s1_labels_and_jumps_to_them_are_of_one_colour() {
    begins_with(&[
        ("AA1:IF R60<R18 GOTOF BB2", "AA1:IF", |theme| theme.macros),
        ("AA1:G01", "AA1:", |theme| theme.macros),
        ("_A1: G0", "_A1:", |theme| theme.macros),
        ("BB2", "BB2", |theme| theme.macros),
        ("GOTOF BB2", "GOTOF", |theme| theme.macros),
    ]);
    let lines = ["N210 AA1:IF R60<R18+R25 GOTOF AA2", "LSA1: L3 P=R32", "_9:", "标签:"];
    let all = painted(&lines);
    for line in lines {
        assert!(all.iter().any(|(text, _)| text == line), "{line}");
    }
}

/// What is typed between two frames comes in one frame, in its order: `Z390⏎G01` is never `Z390G⏎01`.
#[test]
fn b6_what_is_typed_in_one_slow_frame_stays_in_order() {
    let in_one_frame = |shop: &mut Shop, words: &[&str]| {
        for word in words {
            let (key, pressed, repeat) = (Key::Enter, true, false);
            let (physical_key, modifiers) = (None, Modifiers::NONE);
            let event = match *word {
                "\n" => Event::Key { key, physical_key, pressed, repeat, modifiers },
                text => Event::Text(text.to_owned()),
            };
            shop.bench.screen.input_mut().events.push(event);
        }
        shop.bench.turn();
    };
    let mut shop = open("M30\r\n");
    in_one_frame(&mut shop, &["Z", "390", "\n", "G", "01", "\n"]);
    assert_eq!(shop.text(), "Z390\r\nG01\r\nM30\r\n");
    let mut shop = Shop::new(b"M30\r\n");
    shop.tell("mode mdi\npage mdi");
    in_one_frame(&mut shop, &["G04", " X1", "\n", "G", "00"]);
    assert_eq!(&*shop.bench.rig.snapshot().prepared_mdi, "G04 X1");
    assert!(shop.bench.shows("G00"), "the rest is the next line");
}
