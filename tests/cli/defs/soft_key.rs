//! Tests of `kt830::defs::soft_key`.

use kt830::defs::alarm::ALARMS;
use kt830::defs::kind::Kind;
use kt830::defs::page::Page;
use kt830::defs::soft_key::{CoordinateView, ROWS, SoftKeyAction, key_of_page, place, row};

#[test]
fn k7_1_the_first_row_is_that_of_the_position_page_and_none_has_more_than_five() {
    let first = |kind| row(kind, 0).map(|soft| soft.label.zh).collect::<Vec<_>>();
    assert_eq!(first(Kind::Gc), ["相对", "综合", "机床", "磨削", "砂轮修整"]);
    assert_eq!(first(Kind::Lathe), ["相对", "综合", "机床", "录返", "刀具棒料"]);
    assert_eq!(first(Kind::Vertical), ["相对", "综合", "机床", "R 参数"]);
    let fourth = |kind| row(kind, 3).map(|soft| soft.label.en).collect::<Vec<_>>();
    assert_eq!(fourth(Kind::Gc), ["PROCESS", "ALARMS", "WHEEL", "SETTINGS", "HELP"]);
    assert_eq!(fourth(Kind::Lathe), ["ALARMS", "SETTINGS", "HELP"], "a row closes up over keys that a kind lacks");
    for kind in Kind::ALL.iter().copied() {
        assert!((0..ROWS).all(|index| (1..=5).contains(&row(kind, index).count())), "{kind:?}");
    }
}

#[test]
fn k7_1_every_page_with_a_soft_key_has_it_once_on_each_of_its_kinds() {
    // The views of the position page have keys; the designer opens from the program, the panel stands beside the page.
    let without = [Page::Position, Page::Designer, Page::Panel];
    for kind in Kind::ALL {
        let keys: Vec<_> = (0..ROWS).flat_map(|index| row(kind, index)).map(|soft| soft.action).collect();
        for page in Page::ALL.iter().copied().filter(|page| page.exists_on(kind)) {
            let found = keys.iter().filter(|action| **action == SoftKeyAction::Open(page)).count();
            assert_eq!(found, usize::from(!without.contains(&page)), "{page:?} on {kind:?}");
        }
    }
}

#[test]
fn k7_1_every_page_has_a_key_to_be_lit_and_its_row_is_shown_when_it_opens() {
    for kind in Kind::ALL {
        for page in Page::ALL.iter().copied().filter(|page| page.exists_on(kind)) {
            let lit = key_of_page(page, CoordinateView::All);
            let (at, index) = place(kind, lit).unwrap_or_else(|| panic!("{page:?} on {kind:?}"));
            assert_eq!(row(kind, at).nth(index).map(|soft| soft.action), Some(lit));
            // K7.2: the grinding page has the row of the customer's picture.
            let expected = if page == Page::Grinding { 1 } else { at };
            assert_eq!(page.soft_row(), expected, "{page:?} on {kind:?}");
        }
    }
}

/// The end of a text, for the message of a test.
fn last_chars(text: &str) -> String {
    let from = text.chars().count().saturating_sub(20);
    text.chars().skip(from).collect()
}

/// `F4` alone is another key in every row: a text says label, row and place, as in 磨削（第 1 行 F4） or GRINDING (row 1 F4).
/// Returns the labels that it names.
fn named_keys(text: &str, kind: Kind, from: &str) -> Vec<String> {
    let mut named = Vec::new();
    let plain = text.replace('*', "");
    for (at, _) in plain.match_indices('F') {
        let (before, rest) = (&plain[..at], &plain[at + 1..]);
        let digits: String = rest.chars().take_while(|sign| sign.is_ascii_digit() || *sign == '.').collect();
        let Ok(key @ 1..=5) = digits.parse::<usize>() else { continue };
        let (word_before, after) = (before.chars().next_back(), &rest[digits.len()..]);
        let is_word = word_before.is_some_and(|sign| sign.is_ascii_alphanumeric() || matches!(sign, '#' | '-' | '_'));
        // F1–F5 are the five keys; F1 继续 is the same in every row (L7); F2.5 and `F1000` are feeds.
        let any_row =
            ["–F", " 继续", " CONTINUE"].iter().any(|words| after.starts_with(words)) || before.ends_with('–');
        if is_word || any_row || digits.contains('.') {
            continue;
        }
        let place = before.trim_end();
        let (label, number) = match (place.rfind("（第 "), place.rfind("(row ")) {
            (Some(open), _) if place.ends_with('行') => {
                (&place[..open], place[open + "（第 ".len()..].trim_end_matches('行').trim())
            }
            (_, Some(open)) => (&place[..open], &place[open + "(row ".len()..]),
            _ => panic!("{from}: F{key} without its label and row: {}", last_chars(place)),
        };
        let number: usize = number.parse().unwrap_or_else(|_| panic!("{from}: no row before F{key}: {number}"));
        let soft = row(kind, number - 1).nth(key - 1).unwrap_or_else(|| panic!("{from}: row {number} F{key}"));
        let label = label.trim_end();
        let fits = label.ends_with(soft.label.zh) || label.ends_with(soft.label.en);
        let end = last_chars(label);
        assert!(fits, "{from}: row {number} F{key} is {} {}, not {end}", soft.label.zh, soft.label.en);
        named.push(soft.label.zh.to_owned());
    }
    named
}

#[test]
fn k7_1_the_documents_name_soft_keys_at_their_places() {
    let documents = [
        ("README.md", Kind::Gc, &["目录", "磨削"][..]),
        ("README.zh.md", Kind::Gc, &["目录", "磨削"]),
        ("docs/manual/operator.md", Kind::Gc, &["目录", "磨削", "砂轮修整", "参数", "诊断", "程序", "刀补", "换砂轮"]),
        ("docs/manual/lathe.md", Kind::Lathe, &["目录", "录返", "刀具棒料"]),
        ("docs/manual/vertical.md", Kind::Vertical, &["目录", "R 参数"]),
    ];
    for (name, kind, expected) in documents {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(name);
        let text = std::fs::read_to_string(path).unwrap();
        let named = named_keys(&text, kind, name);
        assert!(expected.iter().all(|label| named.iter().any(|found| found == label)), "{name} names {named:?}");
        // ▶ only turns the rows: a page is not found by it alone.
        let labels = || (0..ROWS).flat_map(|index| row(kind, index)).flat_map(|soft| [soft.label.zh, soft.label.en]);
        let plain = text.replace('*', "");
        for (at, _) in plain.match_indices('▶') {
            let behind = plain[at + '▶'.len_utf8()..].trim_start();
            let found = labels().find(|label| behind.starts_with(label));
            assert_eq!(found, None, "{name}: behind ▶");
        }
    }
}

#[test]
fn k7_1_help_and_alarms_name_soft_keys_at_their_places() {
    for kind in Kind::ALL {
        for page in Page::ALL.iter().copied().filter(|page| page.exists_on(kind)) {
            for text in [page.help(), page.usage()] {
                named_keys(text.zh, kind, page.id());
                named_keys(text.en, kind, page.id());
            }
        }
    }
    for alarm in ALARMS {
        for text in [alarm.text, alarm.cause, alarm.remedy] {
            named_keys(text.zh, Kind::Gc, "an alarm");
            named_keys(text.en, Kind::Gc, "an alarm");
        }
    }
}
