//! One rule of capitals for all English texts of the tables.

use kt830::defs::alarm::ALARMS;
use kt830::defs::gcode::G_CODES;
use kt830::defs::mcode::MCODES;
use kt830::defs::page::Page;
use kt830::defs::param::{BITS, NUMBERS};
use kt830::defs::program_error::ProgramError;
use kt830::defs::signal::{Input, Output};
use kt830::defs::system_variable::SYSTEM_VARIABLES;
use kt830::link::internal_signal::InternalSignal;

/// Whether a text begins with a small letter, a sign, or a name: RESET, X, P270, XON/XOFF, C00nn.TXT, MSG("text").
fn begins_small(text: &str) -> bool {
    let word = text.split([' ', ':', ',', '/', '(', '0']).next().unwrap_or_default();
    let capital = word.starts_with(|sign: char| sign.is_ascii_uppercase());
    !capital || word == "SuperMan" || !word.contains(|sign: char| sign.is_ascii_lowercase())
}

#[test]
fn h9_labels_and_messages_are_in_small_letters() {
    let mut texts: Vec<&str> = Vec::new();
    for row in ALARMS {
        texts.extend([row.text.en, row.cause.en, row.remedy.en, row.reaction.name().en, row.reset.name().en]);
    }
    texts.extend(ProgramError::ALL.iter().flat_map(|error| [error.text().en, error.remedy().en]));
    texts.extend(BITS.iter().map(|row| row.name.en).chain(NUMBERS.iter().map(|row| row.name.en)));
    texts.extend(G_CODES.iter().map(|row| row.text.en).chain(MCODES.iter().map(|row| row.name.en)));
    texts.extend(Input::ALL.iter().map(|row| row.name().en).chain(Output::ALL.iter().map(|row| row.name().en)));
    texts.extend(InternalSignal::ALL.iter().map(|row| row.name().en));
    texts.extend(SYSTEM_VARIABLES.iter().map(|row| row.name.en));
    texts.extend(Page::ALL.iter().map(|page| page.title().en));
    assert!(texts.len() > 500);
    let wrong: Vec<_> = texts.into_iter().filter(|text| !begins_small(text)).collect();
    assert_eq!(wrong, [""; 0]);
}
