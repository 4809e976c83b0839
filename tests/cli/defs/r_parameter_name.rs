//! Tests of `kt830::defs::r_parameter_name`.

use kt830::defs::r_parameter_name::*;

#[test]
fn s3_labels_of_the_seeds_table_have_an_english_name() {
    assert_eq!(english_label("R18 X轴精磨尺寸").as_deref(), Some("R18 finished X"));
    assert_eq!(english_label("R18 直径"), None);
    assert_eq!(english_label("R199 直径"), None);
    assert_eq!(english_title("立磨运行值"), Some("run values"));
}
