//! The list of the parameters: what a search finds, and where the arrows lead.

use std::collections::BTreeSet;

use egui::{Color32, Event, Key, Modifiers, Pos2, Shape};
use kt830::defs::page::Page;
use kt830::defs::param_row::rows;
use kt830::defs::text::Lang;
use kt830::hmi::Hmi;
use kt830::hmi::offscreen::OffscreenHmi;
use kt830::hmi::theme::DARK;
use kt830::link::Snapshot;

use crate::sample::snapshot;
use crate::screen::{Screen, open, painted};
use egui_kittest::kittest::Queryable;

/// The page after a search on a tab.
fn search(tab: &str, words: &str) -> Screen {
    let mut screen = open(snapshot(Page::Params));
    screen.get_by_label(tab).click();
    screen.step();
    screen.step();
    screen.event(Event::Text(format!("/{words}")));
    screen.step();
    screen.key_press(Key::Enter);
    screen.step();
    screen.step();
    screen
}

/// Every painted text with the middle of its place and its colour.
fn texts(screen: &Screen) -> Vec<(&str, Pos2, Color32)> {
    let texts = screen.output().shapes.iter().filter_map(|clipped| match &clipped.shape {
        Shape::Text(text) => Some(text),
        _ => None,
    });
    let place = |text: &egui::epaint::TextShape| text.pos + text.galley.size() / 2.0;
    texts
        .filter_map(|text| {
            let job = &text.galley.job;
            Some((job.text.as_str(), place(text), job.sections.first()?.format.color))
        })
        .collect()
}

/// The parameters that a search finds, from the painted rows: the bits beside those found are quiet.
fn found(tab: &str, words: &str) -> Vec<String> {
    let screen = search(tab, words);
    let texts = texts(&screen);
    let mut found = Vec::new();
    let is_number = |text: &str| text.strip_prefix('P').is_some_and(|digits| digits.parse::<u16>().is_ok());
    for (number, at, _) in texts.iter().filter(|(text, _, ink)| is_number(text) && *ink == DARK.text) {
        let of_row = |place: &Pos2| (place.y - at.y).abs() < 25.0;
        let bits = texts
            .iter()
            .filter(|(text, place, _)| text.strip_prefix("BIT").is_some_and(|bit| bit.len() == 1) && of_row(place));
        let mut has_bits = false;
        for (bit, label, _) in bits {
            has_bits = true;
            let below = |place: &Pos2| (place.x - label.x).abs() < 4.0 && place.y > label.y && of_row(place);
            let value = texts.iter().find(|(text, place, _)| matches!(*text, "0" | "1") && below(place));
            if value.is_some_and(|(.., ink)| *ink == DARK.text) {
                found.push(format!("{number}.{}", &bit[3..]));
            }
        }
        if !has_bits {
            found.push((*number).to_owned());
        }
    }
    found.sort();
    found
}

#[test]
fn b6_search_finds_numbers_and_words_of_both_languages() {
    const ALL: &str = "全部 params-all";
    assert_eq!(found(ALL, "P270"), ["P270"]);
    assert_eq!(found(ALL, "270"), ["P270"]);
    assert_eq!(found(ALL, "16."), ["P16.0", "P16.1", "P16.2"]);
    assert_eq!(found(ALL, "液压检测"), ["P270"]);
    assert_eq!(found(ALL, "hydraulic CHECK"), ["P270"]);
    assert_eq!(found("端口 params-ports", "hydraulic-pressure"), ["P269"]);
    assert!(found("位 params-bits", "液压").contains(&"P17.0".to_owned()));
    let nothing = search(ALL, "nothing of the kind");
    assert!(painted(&nothing).iter().any(|text| text == "没有找到参数"));
}

fn press(stage: &mut OffscreenHmi, machine: &Snapshot, key: Key) {
    for pressed in [true, false] {
        let event = Event::Key { key, physical_key: None, pressed, repeat: false, modifiers: Modifiers::NONE };
        stage.events.push(event);
    }
    stage.frame(machine);
}

/// The selected parameter, from the line of its details: `P270  name`.
fn selected(stage: &OffscreenHmi) -> String {
    let details = |text: &str| text.split_once("  ").map(|(address, _)| address.to_owned());
    let all = stage.texts();
    let address = all.iter().filter(|(text, ..)| text.starts_with('P')).find_map(|(text, ..)| details(text));
    address.expect("a selected parameter")
}

#[test]
fn b6_arrows_reach_every_parameter() {
    let machine = snapshot(Page::Params);
    let rows = rows(machine.kind);
    let mut stage = OffscreenHmi::new(Hmi::new(Lang::Zh), (1_024, 768));
    stage.frame(&machine);
    let first = selected(&stage);
    let mut seen = BTreeSet::new();
    for _ in 0..rows.len() {
        press(&mut stage, &machine, Key::ArrowRight);
        seen.insert(selected(&stage));
    }
    assert_eq!((selected(&stage), seen.len()), (first, rows.len()));
    let number = |stage: &OffscreenHmi| selected(stage)[1..].split('.').next().map(str::to_owned);
    let begun = number(&stage);
    let next = rows.iter().map(|row| Some(row.address.number.to_string())).find(|other| *other != begun);
    press(&mut stage, &machine, Key::ArrowDown);
    assert_eq!(Some(number(&stage)), next, "a line below");
    press(&mut stage, &machine, Key::ArrowUp);
    assert_eq!(number(&stage), begun);
}
