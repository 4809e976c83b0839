//! Program, page text, picture and part of each number belong together (K7.3, K7.4, K5.12).

use std::collections::BTreeSet;
use std::path::Path;

use kt830::host::folders::{parse_page_text, parse_picture};

use super::shop::{PROGRAMS, part_of};

fn read(path: &str) -> Vec<u8> {
    std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).unwrap()
}

/// The numbers behind every `#` of a text that lie in a range of page values.
fn numbers(text: &str) -> BTreeSet<u16> {
    let after = text.split('#').skip(1);
    let digits = after.map(|rest| rest.chars().take_while(char::is_ascii_digit).collect::<String>());
    digits.filter_map(|digits| digits.parse().ok()).filter(|number| (500..=999).contains(number)).collect()
}

#[test]
fn k7_3_every_program_has_its_page_text_and_its_picture() {
    for (program, kind) in PROGRAMS {
        let number = program - 1_000;
        let (text, picture) = (format!("C{number:04}.TXT"), format!("B{number:04}.BMP"));
        let page = parse_page_text(&text, &read(&format!("screens/{text}"))).unwrap();
        let picture = parse_picture(&picture, &read(&format!("screens/{picture}"))).unwrap();
        assert!(matches!(picture.0, std::borrow::Cow::Borrowed(_)), "a shipped one takes no memory");
        image::load_from_memory_with_format(&picture.0, image::ImageFormat::Bmp).unwrap();
        assert_eq!(part_of(program).kind, kind);
        let shown: BTreeSet<u16> = page.rows().map(|row| row.variable).collect();
        let preset: BTreeSet<u16> = part_of(program).variables.keys().copied().collect();
        // Results of a run have no value before it.
        let results: BTreeSet<u16> = [657, 676, 715, 716, 717, 735, 736, 737, 876, 895, 914, 915, 916, 930].into();
        let missing: Vec<_> = shown.difference(&preset).filter(|number| !results.contains(*number)).collect();
        assert!(missing.is_empty(), "O{program}: the part has no values for {missing:?}");
        let code = String::from_utf8(read(&format!("programs/O{program}.NC"))).unwrap();
        let subprograms = [9011, 9012, 9013, 9014, 9015, 9016, 9017, 9018]
            .map(|sub| String::from_utf8(read(&format!("programs/O{sub}.NC"))).unwrap());
        let used: BTreeSet<u16> = numbers(&code).union(&numbers(&subprograms.concat())).copied().collect();
        let idle: Vec<_> = shown.difference(&used).collect();
        assert!(idle.is_empty(), "O{program} does not use {idle:?} of its page");
    }
}

#[test]
fn k7_2_no_two_pages_share_a_value_but_for_dressing() {
    let own = |program: u32| {
        let name = format!("C{:04}.TXT", program - 1_000);
        let page = parse_page_text(&name, &read(&format!("screens/{name}"))).unwrap();
        page.rows().map(|row| row.variable).collect::<BTreeSet<u16>>()
    };
    for (a, _) in PROGRAMS {
        for (b, _) in PROGRAMS.into_iter().filter(|(b, _)| *b > a) {
            let shared: Vec<u16> = own(a).intersection(&own(b)).copied().collect();
            assert!(shared.is_empty() || (a, b) == (1011, 1012), "O{a} and O{b}: {shared:?}");
        }
    }
}
