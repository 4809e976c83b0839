//! Tests of `kt830::defs::availability`.

use kt830::defs::availability::m_codes;
use kt830::defs::key::Key;
use kt830::defs::kind::Kind;
use kt830::defs::page::Page;
use kt830::defs::param::{self, Params};
use kt830::defs::signal::{Input, Output};

#[test]
fn k2_1_kinds_differ_in_clamping_and_workpiece_keys() {
    assert_eq!(Key::from_word("尾座进", Kind::Gc), Some(Key::TailstockAdvance));
    assert_eq!(Key::from_word("尾座进", Kind::Gs), None);
    assert_eq!(Key::from_word("充磁", Kind::Gc), None);
    assert_eq!(Key::from_word("demagnetise", Kind::Ga), Some(Key::Demagnetise));
    // Short labels work where they are unambiguous.
    for (word, kind, key) in [
        ("厚度量仪", Kind::Gs, Key::RadialGauge),
        ("平面", Kind::Ga, Key::AxialGauge),
        ("径向", Kind::Gc, Key::RadialGauge),
        ("高速", Kind::Gc, Key::HeadstockHigh),
        ("25%", Kind::Gc, Key::Rapid25),
        ("X", Kind::Gc, Key::AddressX),
    ] {
        assert_eq!(Key::from_word(word, kind), Some(key), "{word}");
    }
    assert_eq!(Key::from_word("停止", Kind::Gc), None);
}

#[test]
fn l9_a_lathe_has_teach_in_and_tools_instead_of_the_grinding_pages() {
    assert!(Page::Teach.exists_on(Kind::Lathe) && Page::Tools.exists_on(Kind::Lathe));
    assert!(!Page::Grinding.exists_on(Kind::Lathe) && !Page::Wheel.exists_on(Kind::Lathe));
    for kind in [Kind::Gc, Kind::Gs, Kind::Ga, Kind::Vertical] {
        assert!(Page::Grinding.exists_on(kind) && Page::Wheel.exists_on(kind) && !Page::Teach.exists_on(kind));
    }
    assert!(Page::ALL.iter().all(|page| Kind::ALL.iter().any(|kind| page.exists_on(*kind))));
}

#[test]
fn k6_1_a_machine_without_tailstock_has_none_of_its_signals_keys_and_codes() {
    for kind in Kind::ALL {
        let fitted = Params::factory(kind).bit(param::TAILSTOCK_ENABLED);
        let codes = m_codes(kind).filter(|row| row.spec_row == "K3.3").count();
        let keys = [Key::TailstockAdvance, Key::TailstockRetract].map(|key| key.exists_on(kind));
        let inputs = [Input::TailstockAdvanced, Input::TailstockRetracted].map(|input| input.exists_on(kind));
        assert_eq!(Output::Tailstock.exists_on(kind), fitted, "{kind:?}");
        assert_eq!((codes, keys, inputs), (2 * usize::from(fitted), [fitted; 2], [fitted; 2]), "{kind:?}");
    }
}
