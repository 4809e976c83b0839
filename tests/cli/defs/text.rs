//! Texts in both languages: phrases and their arguments.

use std::borrow::Cow;
use std::panic::catch_unwind;

use kt830::defs::alarm;
use kt830::defs::text::arg::Arg;
use kt830::defs::text::{Lang, LocalizedText, Template, Text};
use kt830::units::Axis;

/// A phrase: the Chinese and the English template, then the arguments.
macro_rules! phrase {
    ($zh:expr, $en:expr $(, $name:ident = $value:expr)* $(,)?) => {
        LocalizedText::phrase(const { &Template::new($zh, $en, &[$(stringify!($name)),*]) }, [$(Arg::from($value)),*])
    };
}

#[test]
fn a_phrase_is_worded_in_both_languages() {
    let said = phrase!(
        "{axis} 目标 {to:.3} ({to:+.1})，M{code:02}",
        "M{code:02}: {axis} target {to:.3} ({to:+.1})",
        axis = Axis::Z,
        to = -12.345_6,
        code = 7_u8
    );
    assert_eq!(said.zh(), "Z 目标 -12.346 (-12.3)，M07");
    assert_eq!(said.get(Lang::En), "M07: Z target -12.346 (-12.3)");
    assert_eq!(phrase!("S{rpm}", "S{rpm}", rpm = 1_500.0).en(), "S1500");
    assert!(matches!(phrase!("先回零", "home the axes first").zh(), Cow::Borrowed("先回零")));
}

#[test]
fn a_phrase_takes_another_text_as_its_last_argument() {
    const PLACE: &Template = &Template::new("第{line}行 {cause}", "line {line}: {cause}", &["line", "cause"]);
    let at = |inner: LocalizedText| LocalizedText::phrase_of(PLACE, [Arg::from(7_u32)], [inner]);
    let inner = phrase!("{axis} 轴 {off:+.3}", "{axis} is {off:+.3} off", axis = Axis::X, off = 0.25);
    assert_eq!(
        (at(inner.clone()).zh(), at(inner).en()),
        ("第7行 X 轴 +0.250".into(), "line 7: X is +0.250 off".into())
    );
    assert_eq!(at(LocalizedText::new("磁盘满", "the disk is full")).en(), "line 7: the disk is full");
    assert_eq!(at(Text::new("先回零", "home first").into()).zh(), "第7行 先回零");
    let many = phrase!("{a}{b}{c}{d}{e}", "{a}{b}{c}{d}{e}", a = 1, b = 2, c = 3, d = 4, e = 5);
    assert_eq!(at(many).en(), "line 7: 12345", "what does not fit is put into words");
}

#[test]
fn an_alarm_comes_before_its_detail_and_a_text_is_cut_by_characters() {
    let row = alarm::find(alarm::NOT_HOMED).unwrap();
    let said = phrase!("{axis} 轴", "axis {axis}", axis = Axis::Y).after_alarm(alarm::NOT_HOMED);
    assert_eq!(said.zh(), format!("{}：Y 轴", row.text.zh));
    assert_eq!(said.en(), format!("{}: axis Y", row.text.en));
    assert_eq!(said.cut(2).zh(), row.text.zh.chars().take(2).collect::<String>());
}

#[test]
fn both_languages_take_the_same_arguments() {
    let fits = |zh: &'static str, en: &'static str, names: &'static [&'static str]| {
        catch_unwind(|| Template::new(zh, en, names)).is_ok()
    };
    let both = "{axis}：{to:.3}";
    assert!(fits(both, both, &["axis", "to"]));
    for (wrong, names) in [("{axis}", &["axis", "to"][..]), ("{axis} {too}", &["axis", "to"]), ("{", &["to"])] {
        assert!(!fits(wrong, wrong, names), "{wrong}: one is not said, or unknown");
    }
    assert!(!fits(both, "{axis}", &["axis", "to"]) && !fits("{axis}", both, &["axis", "to"]));
    assert!(fits("", "", &[]));
}

#[test]
fn the_stored_form_is_the_words_in_both_languages() {
    let said = phrase!("第 {row} 行", "row {row}", row = 3_usize);
    let stored = serde_json::to_string(&said).unwrap();
    assert_eq!(stored, r#"{"zh":"第 3 行","en":"row 3"}"#);
    let read: LocalizedText = serde_json::from_str(&stored).unwrap();
    assert_eq!((read.zh(), read.en()), (said.zh(), said.en()));
    assert!(LocalizedText::default().is_blank() && !said.is_blank());
}

#[test]
fn a_number_is_written_as_format_writes_it() {
    macro_rules! written {
        ($value:expr, $form:literal) => {
            phrase!(concat!("{n", $form, "}"), concat!("{n", $form, "}"), n = $value).en().into_owned()
        };
    }
    assert_eq!(written!(0.5, ""), format!("{}", 0.5));
    assert_eq!(written!(-0.0, ":.3"), format!("{:.3}", -0.0));
    assert_eq!(written!(2.5, ":.0"), format!("{:.0}", 2.5));
    assert_eq!(written!(0.1, ":+.3"), format!("{:+.3}", 0.1));
    assert_eq!(written!(1e21, ""), format!("{}", 1e21));
    assert_eq!(written!(7_u8, ":04"), format!("{:04}", 7));
    assert_eq!(written!(12_345_u32, ":04"), format!("{:04}", 12_345));
}

#[test]
fn a_name_of_any_length_stays_itself() {
    for name in ["", "O1001", "一键回退", "thirty_bytes_is_the_limit_here", "thirty_one_bytes_are_beyond_that"] {
        assert_eq!(Arg::from(name).as_name(), name);
        assert_eq!(Arg::from(format_args!("{name}{}", 1)).as_name(), format!("{name}1"));
        assert_eq!(matches!(Arg::from(name), Arg::ShortName(..)), name.len() <= 30);
    }
    assert!(Arg::from("").is_empty() && !Arg::from("N").is_empty());
}
