//! Any text at all: no panic, no endless call, and numbers that come back as they were written.

use std::sync::Arc;

use kt830::defs::kind::Dialect;
use kt830::defs::text::Lang;
use kt830::nc::{
    Block, CommonVariables, EmptyLibrary, Interpreter, Library, NcSettings, NextStatus, OfflineMachine, Op, Source,
    check,
};
use kt830::units::Axis;
use proptest::prelude::*;

fn start(text: &[u8], settings: NcSettings) -> (Interpreter, OfflineMachine, Block) {
    let (world, block) = (OfflineMachine::new(&settings), Block::new(&settings));
    let source = Arc::new(Source::new(1001, "O1001.NC", text, settings.dialect));
    (Interpreter::new(source, Arc::new(EmptyLibrary), settings, CommonVariables::default()), world, block)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn b1_any_bytes_neither_panic_nor_hang(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        exercise(&bytes);
        let library: Arc<dyn Library + Send + Sync> = Arc::new(EmptyLibrary);
        let source = Arc::new(Source::new(1, "", bytes, Dialect::LatheA));
        let checked = check(&source, &library, &NcSettings::lathe_a());
        prop_assert!(checked.lines <= 200);
    }

    #[test]
    fn b1_any_likely_text_neither_panics_nor_hangs(
        text in proptest::collection::vec(
            proptest::sample::select(vec![
                "G0", "G1", "G2", "G3", "G4", "G90", "G94", "G28", "G31", "G50", "G53", "G54", "G65", "G66", "G67", "H1", "H80",
                "H26", "X", "Z", "U", "W", "R", "I", "K", "P", "Q", "L", "F", "S", "T", "M98", "M99", "M30", "M91", "N", "#", "=",
                "[", "]", "+", "-", "*", "/", "**", "AND", "MOD", "IF", "THEN", "GOTO", "WHILE", "DO", "END", "EQ", "GT", "SIN",
                "ATAN", "1", "2", "3", "10", "0.5", "100", "570", "3000", "\n", "\n", " ", ";", "(", ")", "%", "O", "，", "//",
            ]),
            0..60,
        )
    ) {
        exercise(text.concat().as_bytes());
    }

    #[test]
    fn b1_numbers_printed_and_read_again_are_the_same(micrometres in -99_999_999_i64..=99_999_999) {
        let value = micrometres as f64 / 1000.0;
        let text = format!("G0 Z{value}\n#500={value}");
        let (mut interpreter, mut world, mut block) = start(text.as_bytes(), NcSettings::lathe_a());
        interpreter.next(&mut world, &mut block).unwrap();
        let [Op::Rapid { to, .. }] = block.ops[..] else { panic!("{:?}", block.ops) };
        interpreter.next(&mut world, &mut block).unwrap();
        prop_assert_eq!(&block.ops[0], &Op::SetVariable { variable: 500, value: Some(value) });
        prop_assert_eq!(to[Axis::Z].to_bits(), (value + 0.0).to_bits());
    }
}

fn exercise(bytes: &[u8]) {
    for settings in [NcSettings::lathe_a(), NcSettings::for_dialect(Dialect::Mill)] {
        let (mut interpreter, mut world, mut block) = start(bytes, settings.clone());
        for _ in 0..50 {
            match interpreter.next(&mut world, &mut block) {
                Ok(NextStatus::Block) => block.ops.iter().for_each(|op| world.apply(op)),
                Ok(NextStatus::Busy | NextStatus::Waiting | NextStatus::Drain) => {}
                Ok(NextStatus::End) => break,
                Err(fault) => {
                    assert!(fault.column >= 1 && fault.location.line >= 1);
                    assert!(!fault.text(Lang::Zh).is_empty());
                    break;
                }
            }
        }
    }
}
