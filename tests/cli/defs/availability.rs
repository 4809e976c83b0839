//! Tests of `kt830::defs::availability`.

use kt830::defs::availability::m_codes;
use kt830::defs::equipment::Equipment;
use kt830::defs::fitted::Fitted;
use kt830::defs::key::Key;
use kt830::defs::kind::Kind;
use kt830::defs::page::Page;
use kt830::defs::param::{self, Params};
use kt830::defs::param_row;
use kt830::defs::signal::{Input, Output};
use kt830::defs::sim_fault::FAULTS;

#[test]
fn k2_1_kinds_differ_in_clamping_and_workpiece_keys() {
    assert_eq!(Key::from_word("尾座进", Kind::Gc), Some(Key::TailstockAdvance));
    assert_eq!(Key::from_word("尾座进", Kind::Gs), None);
    // P16.0 fits a magnet to a cylindrical grinder; a lathe has none.
    assert_eq!(Key::from_word("充磁", Kind::Gc), Some(Key::Magnetise));
    assert_eq!(Key::from_word("充磁", Kind::Lathe), None);
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

#[test]
fn k3_11_p16_0_fits_a_magnet_to_the_cylindrical_grinder() {
    let mut params = Params::factory(Kind::Gc);
    let magnet = |params: &Params| {
        let fitted = params.fitted();
        let keys = [Key::Magnetise, Key::Demagnetise].map(|key| key.exists_on(fitted));
        (keys, [Output::Magnetise, Output::Demagnetise].map(|output| output.exists_on(fitted)))
    };
    assert_eq!(magnet(&params), ([false; 2], [false; 2]));
    params.write(param::MAGNET_ENABLED.address(), 1.0).expect("a bit");
    assert_eq!(magnet(&params), ([true; 2], [true; 2]));
    // A surface grinder has its magnet anyway: the bit enables it. A lathe has none.
    for (kind, has) in [(Kind::Gs, true), (Kind::Ga, true), (Kind::Lathe, false), (Kind::Vertical, false)] {
        for bit in [0.0, 1.0] {
            let mut params = Params::factory(kind);
            params.write(param::MAGNET_ENABLED.address(), bit).expect("a bit");
            assert_eq!(magnet(&params), ([has; 2], [has; 2]), "{kind:?} P16.0={bit}");
        }
    }
}

#[test]
fn k1_what_belongs_to_an_axis_exists_where_the_axis_is_fitted() {
    let of_y = |fitted: Fitted| {
        let inputs = [Input::HomeY, Input::DriveY, Input::LimitYPlus, Input::LimitYMinus];
        let faults = FAULTS.iter().filter(|fault| fault.name.ends_with("-y") && fault.exists_on(fitted)).count();
        let rows = param_row::rows(fitted).into_iter().filter(|row| row.name.zh().starts_with("Y ")).count();
        (inputs.map(|input| input.exists_on(fitted)), faults, rows > 0)
    };
    for kind in Kind::ALL {
        let mut params = Params::factory(kind);
        let has = params.fitted().has(Equipment::AxisY);
        assert_eq!(has, kind == Kind::Gs, "{kind:?}");
        assert_eq!(of_y(params.fitted()), ([has; 4], if has { 3 } else { 0 }, has), "{kind:?}");
        params.write(param::Y_FITTED.address(), 1.0).expect("a bit");
        assert_eq!(of_y(params.fitted()), ([true; 4], 3, true), "{kind:?} with P6.6=1");
    }
}

#[test]
fn k6_1_parameters_of_a_missing_device_are_not_listed_but_kept() {
    let listed = |kind: Kind, number: u16| param_row::rows(kind).iter().any(|row| row.address.number == number);
    for (number, kinds) in [
        (param::TAILSTOCK_TIMEOUT.number, vec![Kind::Gc]),
        (param::MAGNETISE_TIME.number, vec![Kind::Gs, Kind::Ga]),
        (param::TOOL_1_SHAPE.number, vec![Kind::Lathe]),
        (Input::TailstockAdvanced.port_param(), vec![Kind::Gc]),
        (param::SOFT_MINUS_Y.number, vec![Kind::Gs]),
    ] {
        for kind in Kind::ALL {
            assert_eq!(listed(kind, number), kinds.contains(&kind), "P{number} on {kind:?}");
            // A backup has it all the same.
            assert!(param_row::addresses().any(|at| at.number == number), "P{number}");
        }
    }
    // The switch that fits a device stays.
    assert!(listed(Kind::Gc, param::MAGNET_ENABLED.number) && listed(Kind::Gc, param::Y_FITTED.number));
}
