//! Tests of `kt830::defs::page_text`.

use kt830::defs::page_text::*;
use kt830::defs::text::Lang;

/// The customer's own sample (seed 000), remarks of the document left out.
const SAMPLE: &str = "外卡磨削;\n\n卡尺 X 轴始磨位置 #500;\n卡尺 X 轴终点位置 #501;\n卡尺 X 轴安全位置 #503;\n\
    卡尺 Z 轴终点位置 #504;\n左卡磨耗余量 #505;\n左卡粗磨余量 #506;\n粗磨进给方式 #507;\n精磨进给方式 #508;\n\n\
    ;\n;\n\n左卡 Z 轴始磨位置 #502;\n右尺 Z 轴始磨位置 #514;\n右卡粗磨余量 #515;\n右卡精磨余量 #516;\n\
    粗磨速度 #512;\n精磨速度 #513;\n光磨次数 #511;\n\n;\n;\n%\n\n";

#[test]
fn k7_4_the_customers_sample_is_read() {
    let page = parse(SAMPLE).unwrap();
    assert_eq!(page.title, "外卡磨削");
    assert_eq!(page.left[0], Some(PageTextRow { label: "卡尺 X 轴始磨位置".into(), english: None, variable: 500 }));
    assert_eq!(page.left[7].as_ref().unwrap().variable, 508);
    assert_eq!((&page.left[8], &page.left[9]), (&None, &None));
    assert_eq!(page.right[0].as_ref().unwrap().variable, 502);
    // Seven rows and two empty rows before %: fewer than ten right entries are allowed.
    assert_eq!(page.right[6].as_ref().unwrap().variable, 511);
    assert_eq!(page.right[9], None);
    assert_eq!(page.rows().count(), 15);
}

#[test]
fn k7_4_full_width_punctuation_is_named_with_its_place() {
    let fault = parse(&SAMPLE.replacen("位置 #501;", "位置 #501；", 1)).unwrap_err();
    // "卡尺 X 轴终点位置 #501；": 2+1+1+1+5+1+4 = 15 characters before it.
    assert_eq!((fault.line, fault.column), (4, 16));
    assert!(fault.message.zh().contains("全角") && fault.message.en().contains("full-width"));
    assert_eq!(parse(&SAMPLE.replacen('#', "＃", 1)).unwrap_err().line, 3);
    assert!(parse(&SAMPLE.replace('%', "％")).unwrap_err().message.zh().contains("全角"));
}

#[test]
fn k7_4_every_mistake_of_a_text_is_told_with_its_line() {
    let text = SAMPLE.replacen("#501;", "#501；", 1).replacen("#503;", "#1;", 1).replacen("#505;", "#505", 1);
    let reading = parse_all(&text);
    assert_eq!(reading.faults.iter().map(|fault| fault.line).collect::<Vec<_>>(), [4, 5, 7]);
    // Valid rows keep their positions.
    assert_eq!(reading.page.left[0].as_ref().unwrap().variable, 500);
    assert_eq!((&reading.page.left[1], &reading.page.left[2], &reading.page.left[4]), (&None, &None, &None));
    assert_eq!(reading.page.right[6].as_ref().unwrap().variable, 511);
    let right = parse_all(SAMPLE);
    assert_eq!((right.faults.len(), right.entry_positions.len(), right.entry_positions[8]), (0, 19, (12, 1)));
}

#[test]
fn k7_4_what_is_not_of_the_format_is_refused() {
    for (text, line) in [
        ("", 1),
        (";\n", 1),
        ("标题;\n;\n%", 3),
        ("标题;\nA #500\n%", 2),
        ("标题;\nA 500;\n%", 2),
        ("标题;\nA #1;\n%", 2),
        ("标题;\nA #4x;\n%", 2),
        ("标题;\n#500;\n%", 2),
    ] {
        assert_eq!(parse(text).unwrap_err().line, line, "{text:?}");
    }
    let long = format!("标题;{}%", "\n;".repeat(21));
    assert_eq!(parse(&long).unwrap_err().line, 22);
    assert_eq!(parse(&long.replacen("\n;", "", 1)).unwrap().rows().count(), 0);
    assert_eq!(parse("标题;\n;;;;;;;;;;").unwrap_err().message.en(), "the % at the end of the file is missing");
}

#[test]
fn k7_2_a_label_tells_the_unit_of_its_value() {
    let told = |label: &str| {
        let row = PageTextRow { label: label.to_owned(), english: None, variable: 500 };
        (row.name_in(Lang::Zh).to_owned(), row.unit().map(|unit| unit.zh))
    };
    let unit = |label: &str| told(label).1;
    // Written behind the label: it is shown behind the value.
    assert_eq!(told("粗磨速度 mm/min"), ("粗磨速度".to_owned(), Some("mm/min")));
    assert_eq!(told("光磨时间 秒"), ("光磨时间".to_owned(), Some("s")));
    assert_eq!(told("修整间隔 件"), ("修整间隔".to_owned(), Some("件")));
    assert_eq!(told("往复频率 次/分"), ("往复频率".to_owned(), Some("1/min")));
    // Told by its words.
    assert_eq!(
        [unit("卡尺X轴始磨位置"), unit("粗磨速度 到P1"), unit("R15 停顿时间")],
        [Some("mm"), Some("mm/min"), Some("s")]
    );
    assert_eq!([unit("R14 磨架角度"), unit("R8 砂轮转速"), unit("R7 线速度")], [Some("°"), Some("r/min"), Some("m/s")]);
    // Counts, switches and modes have none, nor has a speed that does not say of what.
    assert_eq!([unit("光磨次数"), unit("头架 0低速 1高速"), unit("粗磨进给方式"), unit("1用G27修整点")], [None; 4]);
    assert_eq!([unit("R5 速度下限"), unit("R62 错误标志"), unit("端面速度"), unit("滚轮速度")], [None; 4]);
}

#[test]
fn k7_2_the_english_label_loses_the_unit_that_it_ends_with() {
    let row =
        |english: &str| PageTextRow { label: "修整间隔 件".into(), english: Some(english.into()), variable: 531 };
    assert_eq!(row("dressing interval, parts").name_in(Lang::En), "dressing interval");
    assert_eq!(row("oscillations per minute").name_in(Lang::En), "oscillations per minute");
    assert_eq!(row("roughing feed mm/min").name_in(Lang::En), "roughing feed");
}
