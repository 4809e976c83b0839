//! The check of a program as the user calls it: loops that do not end, what the run does not reach, verdict and exit
//! status (rows T4, L1, L4, L7, S1).

use std::process::Output;
use std::sync::Arc;

use kt830::defs::kind::Dialect;
use kt830::defs::language_row::LanguageState;
use kt830::nc::{self, EmptyLibrary, NcSettings, SharedLibrary, Source, refused_words};
use serde_json::Value;

use crate::command::{kt830, kt830_in};

/// Checks a text as a file of that name.
fn check(kind: &str, name: &str, text: &str, words: &[&str]) -> Output {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    kt830_in(folder.path(), folder.path(), &[&["check", "--kind", kind, name], words].concat())
}

fn said(out: &Output) -> String {
    String::from_utf8_lossy(&out.stdout).into_owned()
}

fn warned(out: &Output) -> String {
    String::from_utf8_lossy(&out.stderr).into_owned()
}

fn json(kind: &str, name: &str, text: &str) -> Value {
    serde_json::from_slice(&check(kind, name, text, &["--format", "json"]).stdout).unwrap()
}

/// Exports of other controls have the name of a text. A `.TXT` that begins with a row of a page is a page text, any other
/// one a program.
#[test]
fn t4_a_text_file_that_begins_as_a_program_is_checked_as_one() {
    for text in [
        "%\nO0001\nG98 G01 X5 F100\nM30\n%\n",
        "\r\nO0001 (PART)\r\nG98 G01 X5 F100\r\nM30\r\n",
        ":0001\nM30\n",
        "\u{feff}%\nO0001\nM30\n",
        "N10 G98 G01 X5 F100\nM30\n",
        "(PART)\nM30\n",
        "G98 G01 X5 F100;\nM30;\n",
        "#500=1;\nM30\n",
        "/M08\nM30\n",
    ] {
        let out = check("gc", "EXPORT.TXT", text, &[]);
        assert_eq!(out.status.code(), Some(0), "{text}: {}{}", said(&out), warned(&out));
    }
    let wrong = check("gc", "export.txt", "%\nO0001\nG199 X5\nM30\n", &["--lang", "en"]);
    assert!(said(&wrong).contains("export.txt:3:1: unknown code G199"), "{}", said(&wrong));
    // The name of a page, and what is no program, stay page texts.
    for (name, text) in [("C0001.TXT", "%\nO0001\nM30\n"), ("page.txt", "\n\n")] {
        let out = check("gc", name, text, &["--lang", "en"]);
        assert!(out.status.code() == Some(2) && said(&out).contains("title"), "{name}: {}", said(&out));
    }
    for (text, place) in [("X axis;\nstart #500\n", "2:1: the ;"), ("外圆磨；\n起点 #500;\n%\n", "1:4: full-width")]
    {
        let out = check("gc", "page.txt", text, &["--lang", "en"]);
        let place = format!("page.txt:{place}");
        assert!(out.status.code() == Some(2) && said(&out).contains(&place), "{}", said(&out));
    }
}

/// Every mistake of a page text, each with its place.
#[test]
fn t4_every_mistake_of_a_page_text_is_told() {
    let out = check("gc", "C0005.TXT", "标题;\na #500;\nb #abc;\nc #5001;\n%\n", &["--lang", "en"]);
    let told: Vec<_> = said(&out).lines().map(|line| line.rsplit_once("C0005.TXT").unwrap().1.to_owned()).collect();
    assert_eq!(out.status.code(), Some(2));
    assert!(told[0].starts_with(":3:4: 'abc'") && told[1].starts_with(":4:4: #5001") && told.len() == 2, "{told:?}");
}

/// A subprogram of the 802D that is checked alone: its caller sets the parameters that its words need.
#[test]
fn t4_values_of_a_subprogram_that_its_caller_sets_are_warnings() {
    let out = check("vertical", "L77.SPF", "G1 X10 F=R51\nX=10/R52\nRET\n", &["--lang", "en"]);
    assert_eq!(out.status.code(), Some(0), "{}", said(&out));
    assert!(warned(&out).contains("warning: F0 is out of range") && warned(&out).contains("division by zero"));
    let out = check("vertical", "L77.SPF", "G1 X10 F0\nRET\n", &["--lang", "en"]);
    assert_eq!(out.status.code(), Some(2), "a literal is a mistake");
    let out = check("vertical", "MAIN.MPF", "G1 X10 F=R51\nM2\n", &["--lang", "en"]);
    assert_eq!(out.status.code(), Some(2), "nobody calls a main program");
}

#[test]
fn l7_targets_of_blocks_that_the_run_does_not_reach_are_looked_for() {
    let text = "N0010M97L0100\nN0020M97L0990\nN0030M98L0990\nN0040M97L0040\nN0050M97L0060\nN0060G04F1\nN0060G04F1\n\
                N0070M98\nN0080G22L2\nN0100M02\n";
    let out = check("lathe", "A.NC", text, &["--lang", "en"]);
    assert_eq!(out.status.code(), Some(2));
    for line in [
        "A.NC:2:9: there is no block N0990",
        "A.NC:3:9: there is no block N0990",
        "A.NC:4:9: N0040 jumps to itself",
        "A.NC:5:9: N0060 is not unique",
        "A.NC:8:6: M98 needs L",
        "A.NC:9:6: G22 has no matching G80",
    ] {
        assert!(said(&out).contains(line), "{line}: {}", said(&out));
    }
    assert_eq!(said(&out).lines().count(), 7, "{}", said(&out));
}

/// 2000 · 2000 passes are more than the check follows: what stands behind them is checked, and the verdict does not
/// say that all is well.
#[test]
fn l4_a_loop_with_too_many_passes_is_left_and_the_verdict_says_so() {
    let text =
        "N0010G22L2000\nN0020G22L2000\nN0030G01U-1W1F300\nN0040U1W-1\nN0050G80\nN0060G80\nN0070G01W-5F300\nN0080M02\n";
    let out = check("lathe", "LONG.NC", text, &["--lang", "en"]);
    assert!(!said(&out).contains(": ok"), "{}", said(&out));
    assert!(
        said(&out).starts_with("LONG.NC: no error found, but the check did not reach the program end\n"),
        "{}",
        said(&out)
    );
    assert!(warned(&out).contains("LONG.NC:5:1: warning: this loop is not followed to the end"), "{}", warned(&out));
    let zh = check("lathe", "LONG.NC", text, &["--lang", "zh"]);
    assert!(said(&zh).starts_with("LONG.NC: 未发现错误，但没有检查到结束\n"), "{}", said(&zh));
    assert!(warned(&zh).contains("LONG.NC:5:1: 警告：检查没有把这个循环走到底"), "{}", warned(&zh));
    let told = json("lathe", "LONG.NC", text);
    assert_eq!(told["finished"], false);
    // One pass of 1 mm of diameter and 1 mm to and fro, then 5 mm.
    assert_eq!(told["extents"]["X"], serde_json::json!([-1.0, 0.0]));
    assert_eq!(told["extents"]["Z"], serde_json::json!([-5.0, 1.0]));
    // An error behind the loop is found.
    let out = check("lathe", "LONG.NC", &text.replace("W-5F300", "W-5F3"), &["--lang", "en"]);
    assert!(said(&out).contains("LONG.NC:7:12: F3 is out of range 6–2000 mm/min"), "{}", said(&out));
}

#[test]
fn l7_an_endless_program_is_measured_and_listed_once() {
    let text = "N0010G01U-2F600\nN0020W-5\nN0030M97L0010\nN0040M02\n";
    let told = json("lathe", "A.NC", text);
    assert_eq!((&told["finished"], &told["errors"]), (&false.into(), &serde_json::json!([])));
    assert_eq!(told["extents"], serde_json::json!({"X": [-2.0, 0.0], "Z": [-5.0, 0.0]}));
    // 1 mm of slide at half of 600 mm/min, 5 mm at 600.
    assert!((told["length"].as_f64().unwrap() - 6.0).abs() < 1e-9, "{told}");
    assert!((told["seconds"].as_f64().unwrap() - 0.7).abs() < 1e-9, "{told}");
    let out = check("lathe", "A.NC", text, &["--ops", "--lang", "en"]);
    assert_eq!(said(&out).lines().filter(|line| line.starts_with("feed ")).count(), 2, "{}", said(&out));
}

#[test]
fn t4_the_time_of_a_check_is_that_of_the_run() {
    // A contour in points, where acceleration decides; a plunge with waits for units; a gauge that ends the stages.
    let wave: String = (0..=1_500_u32)
        .map(|at| f64::from(at) * 0.02)
        .map(|z| format!("X{:.4} Z{:.4}\n", -80.0 + 4.0 * (z * 1.5).sin(), -150.0 - z))
        .collect();
    let dense = format!("G64\nG01 F4000\n{wave}M30\n");
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("O0500.NC"), dense).unwrap();
    let shipped = |name: &str| format!("{}/programs/{name}", env!("CARGO_MANIFEST_DIR"));
    for program in ["O0500.NC".to_owned(), shipped("O1002.NC"), shipped("O1004.NC")] {
        let told = |what: &str| -> serde_json::Value {
            let out = kt830_in(folder.path(), folder.path(), &[what, &program, "--format", "json"]);
            serde_json::from_str(&said(&out)).unwrap()
        };
        let (checked, ran) = (told("check"), told("run"));
        assert_eq!((&checked["timing"], &ran["end"]), (&"simulated".into(), &"finished".into()), "{checked} {ran}");
        let (check_s, run_s) = (checked["seconds"].as_f64().unwrap(), ran["seconds"].as_f64().unwrap());
        assert!((check_s / run_s - 1.0).abs() < 0.03, "{program}: {check_s} for {run_s}");
    }
    // Without an end that a headless run reaches: the time at the programmed feeds, and it says so.
    std::fs::write(folder.path().join("O0501.NC"), "G01 U-10 F60\nM81\nM30\n").unwrap();
    let out = kt830_in(folder.path(), folder.path(), &["check", "O0501.NC", "--lang", "en"]);
    assert!(said(&out).contains("5.0 s (at the programmed feeds)"), "{}", said(&out));
    // K5.17: with P6.7 a new wheel is not dressed yet, and cycle start is refused: nothing has run.
    std::fs::write(folder.path().join("O0502.NC"), "G01 U-10 F60\nM30\n").unwrap();
    let told = |words: &[&str]| said(&kt830_in(folder.path(), folder.path(), &[words, &["--lang", "en"]].concat()));
    let refused = told(&["check", "O0502.NC", "--param", "P6.7=1"]);
    assert!(refused.contains("5.0 s (at the programmed feeds)"), "{refused}");
    let refused = told(&["run", "O0502.NC", "--param", "P6.7=1"]);
    assert!(refused.starts_with("stopped") && refused.contains("0 blocks"), "{refused}");
    // P390 repeats the program: the time is that of one pass.
    let (once, five) = (told(&["check", "O0502.NC"]), told(&["check", "O0502.NC", "--param", "P390=5"]));
    assert!(once == five && !once.contains("at the programmed feeds"), "{once} {five}");
    // So does M99 in the main program.
    std::fs::write(folder.path().join("O0503.NC"), "G01 U-10 F60\nM99\n").unwrap();
    let checked: serde_json::Value = serde_json::from_str(&told(&["check", "O0503.NC", "--format", "json"])).unwrap();
    assert_eq!(checked["timing"], "simulated");
    // 5 mm of radius at 60 mm/min.
    assert!((checked["seconds"].as_f64().unwrap() - 5.0).abs() < 0.3, "{checked}");
}

/// The operator's copy of O1002 beside the machine's programs: the file is checked, and the file is run for its time.
#[test]
fn t4_the_time_is_that_of_the_file_and_not_of_a_program_with_its_number() {
    let (data, here) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let programs = data.path().join("programs");
    std::fs::create_dir(&programs).unwrap();
    std::fs::write(programs.join("O1002.NC"), "G04 X50\nM30\n").unwrap();
    std::fs::write(here.path().join("O1002.NC"), "G04 X2\nM30\n").unwrap();
    let folder = programs.display().to_string();
    for words in [&["check", "O1002.NC"][..], &["check", "O1002.NC", "--simulate"]] {
        let words = [words, &["--format", "json", "--programs", &folder]].concat();
        let out = said(&kt830_in(here.path(), data.path(), &words));
        let told: serde_json::Value = serde_json::from_str(out.lines().next().unwrap()).unwrap();
        let seconds = told["seconds"].as_f64().unwrap();
        assert!(told["timing"] == "simulated" && (2.0..2.5).contains(&seconds), "{words:?} {told}");
    }
}

#[test]
fn s1_a_value_that_grows_in_an_endless_loop_is_no_error_of_its_line() {
    let text = "N10 G90 G94 F600\nN20 R1=0\nAA1:R1=R1+10\nN40 G1 X=R1\nN50 GOTOB AA1\nN60 M2\n";
    let told = json("vertical", "A.MPF", text);
    assert_eq!((&told["finished"], &told["errors"]), (&false.into(), &serde_json::json!([])), "{told}");
    assert_eq!(told["extents"]["X"], serde_json::json!([0.0, 10.0]));
    let out = check("vertical", "A.MPF", text, &["--ops", "--lang", "en"]);
    assert_eq!(said(&out).lines().filter(|line| line.starts_with("feed ")).count(), 1, "{}", said(&out));
    // The same value as it is written is one.
    let told = json("vertical", "A.MPF", &text.replace("R1=R1+10", "R1=100000"));
    assert_eq!(told["errors"][0]["line"], 4, "{told}");
}

/// The tool goes along Z into the chuck: the alarm names Z, the verdict is not "ok", the status is 1.
#[test]
fn t4_l9_a_crash_of_the_simulated_run_is_the_verdict() {
    let text = "N0010G92X60Z20\nN0020M03\nN0030G01Z-125F2000\nN0040M02\n";
    for (lang, alarm) in [("en", "CRASH.NC:3:1: drive fault: Z"), ("zh", "CRASH.NC:3:1: 驱动报警：Z")] {
        let out = check("lathe", "CRASH.NC", text, &["--simulate", "--lang", lang, "--param", "P384=45"]);
        assert_eq!(out.status.code(), Some(1), "{out:?}");
        assert_eq!(said(&out).lines().next(), Some(alarm), "{out:?}");
        assert!(!said(&out).contains(": ok"), "{out:?}");
    }
    let words = ["--simulate", "--format", "json", "--param", "P384=45"];
    let out = check("lathe", "CRASH.NC", text, &words);
    let told: Vec<Value> = said(&out).lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!((&told[0]["simulated"], &told[0]["errors"][0]["line"]), (&"alarm".into(), &3.into()), "{out:?}");
    // Short of the chuck all is well, and the bar is cut.
    let fine = check("lathe", "CRASH.NC", &text.replace("-125", "1"), &["--simulate", "--param", "P384=45"]);
    assert_eq!(fine.status.code(), Some(0), "{fine:?}");
    assert!(said(&fine).starts_with("CRASH.NC: ok\n"), "{fine:?}");
}

/// Where the part says where the work zero lies, a move beyond a soft limit is an error of its block, as it is in the run.
#[test]
fn t4_b5_a_move_beyond_a_soft_limit_is_told_where_the_zero_is_known() {
    // The bar's face is at machine Z −450; P43 is the least Z there.
    let text = "N0010G92X60Z20\nN0020G00Z15\nN0030G00Z-5000\nN0040M02\n";
    let out = check("lathe", "FAR.NC", text, &["--lang", "en", "--param", "P384=45"]);
    assert_eq!(out.status.code(), Some(2), "{out:?}");
    assert!(said(&out).starts_with("FAR.NC:3:1: Z goes to -5450.000, beyond the soft limit -"), "{}", said(&out));
    // Without a bar nobody knows where the program will begin.
    let out = check("lathe", "FAR.NC", text, &["--lang", "en"]);
    assert_eq!(out.status.code(), Some(0), "{out:?}");
    // VGRIND's part puts X0 at machine −450, radius: X −1000 is −950.
    let part = "assets/parts/VGRIND.ron";
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("FAR.MPF");
    std::fs::write(&path, "G90 G0 X690\nG0 Z-2000\nM2\n").unwrap();
    let words = ["check", "--kind", "vertical", "--lang", "en", "--part", part, path.to_str().unwrap()];
    let out = kt830(&words);
    assert_eq!(out.status.code(), Some(2), "{out:?}");
    assert!(said(&out).contains("FAR.MPF:2:1: Z goes to -2500.000, beyond the soft limit -"), "{}", said(&out));
}

/// A program that ends in its own error is not "ok", and no size of 200 has come out.
#[test]
fn s4_a_program_that_refuses_itself_is_no_success() {
    let words =
        ["check", "--kind", "vertical", "--simulate", "--lang", "en", "--set", "R28=0", "programs/802d/VGRIND.MPF"];
    let out = kt830(&words);
    assert_eq!(out.status.code(), Some(1), "{out:?}");
    assert!(
        said(&out).starts_with("programs/802d/VGRIND.MPF:32:6: error 10: roughing parameters wrong\n"),
        "{}",
        said(&out)
    );
}

/// A program without a number runs under another one: its line is told all the same.
#[test]
fn t4_an_alarm_of_the_simulated_run_has_its_line() {
    let text = "N10 G91 G94 F6000\nAA1:G1 X-10\nGOTOB AA1\nM2\n";
    let out = check("vertical", "V.MPF", text, &["--simulate", "--lang", "en"]);
    assert_eq!(out.status.code(), Some(1), "{out:?}");
    assert!(said(&out).starts_with("V.MPF:2:1: soft limit: "), "{}", said(&out));
}

/// VBORE has values of its own: from a fresh control it grinds its bore, and what the call sets counts.
#[test]
fn s6_the_bore_begins_with_values_of_its_own() {
    let words = ["check", "--kind", "vertical", "--simulate", "--lang", "en", "programs/802d/VBORE.MPF"];
    let out = kt830(&words);
    assert_eq!(out.status.code(), Some(0), "{out:?}");
    let told = said(&out);
    assert!(told.starts_with("programs/802d/VBORE.MPF: ok\n") && told.contains("finished"), "{told}");
    // 500 at Z105, 1 degree narrower downwards: at Z102 500 − 2 · 3 · tan 1° = 499.895.
    let at = told.lines().find_map(|line| line.strip_prefix("part diameter at Z102.000  ")).unwrap();
    assert!((at.parse::<f64>().unwrap() - 499.895).abs() < 0.004, "{told}");
    // VGRIND's sizes: the wheel does not fit in, and the program says so itself.
    let set = ["--set", "R20=200.5", "--set", "R18=200"];
    let out = kt830(&[&words[..], &set[..]].concat());
    assert_eq!(out.status.code(), Some(1), "{out:?}");
    assert!(
        said(&out).starts_with("programs/802d/VBORE.MPF:88:10: error 06: wheel does not fit into the bore\n"),
        "{}",
        said(&out)
    );
}

/// RBORE and RGRIND set the values of the two programs and move nothing.
#[test]
fn s6_the_values_of_each_program_are_set_by_a_program() {
    let run = |name: &str, set: &str| {
        let file = format!("programs/802d/{name}.MPF");
        let out = kt830(&["run", &file, "--kind", "vertical", "--format", "json", "--set", set]);
        let told: Value = serde_json::from_slice(&out.stdout).unwrap();
        assert_eq!((out.status.code(), &told["end"]), (Some(0), &"finished".into()), "{out:?}");
        told["variables"].clone()
    };
    let bore = run("RBORE", "R18=200");
    assert_eq!([&bore["R18"], &bore["R20"], &bore["R14"], &bore["R28"]], [500.0, 499.5, -1.0, 0.01]);
    let grind = run("RGRIND", "R18=500");
    // All others are as delivered, and nothing has been measured.
    assert_eq!(grind, serde_json::json!({"R18": 200.0, "R65": 0.0, "R66": 0.0, "R69": 0.0}));
}

#[test]
fn k3_the_check_reads_the_interlock_table() {
    // Kind, program, line, and the alarm that the run would end in.
    for (kind, text, line, alarm) in [
        ("gs", "M10\nM30", 1, 190),
        ("gc", "G04 P1\nM94\nM30", 2, 190),
        ("gc", "M21 P1\nM30", 1, 195),
        ("gc", "#1100=1\nM30", 1, 195),
        ("gc", "G35 Z-200 Q10\nG01 Z-160 F100\nM30", 2, 198),
        ("gc", "G35 Z-200 Q10\nG78 Z-160 F600 J60 P4 L3\nM30", 2, 198),
        ("gc", "#2001=1000\nM30", 1, 204),
        ("gc", "#5801=-5\nM30", 1, 203),
        ("gc", "S2000 M03\nM30", 1, 186),
        ("gc", "M10\nM63\nM11\nM30", 3, 181),
        ("ga", "M94\nM63\nM95\nM30", 3, 187),
        ("gc", "M15\nM03\nM30", 2, 180),
    ] {
        let errors = json(kind, "O0500.NC", text)["errors"].clone();
        assert_eq!(errors.as_array().map(Vec::len), Some(1), "{text:?} {errors}");
        assert_eq!(errors[0]["line"], line, "{text:?} {errors}");
        let message = errors[0]["message"].as_str().unwrap();
        assert!(message.contains(&format!("报警 {alarm})")), "{text:?} {message}");
    }
    let unfit = check("gc", "O0500.NC", "M80\nM30", &["--param", "P279=0", "--lang", "en"]);
    assert_eq!(unfit.status.code(), Some(2));
    assert!(said(&unfit).contains("M80") && said(&unfit).contains("alarm 202"), "{}", said(&unfit));
}

#[test]
fn k3_what_the_machine_allows_is_no_error() {
    for (kind, text) in [
        ("gc", "M11\nM10\nM63\nM65\nM11\nM10\nM03 S1000\nM70\nM75\nM05\nM30"),
        ("gc", "G35 Z-200 Q10\nG00 X-10\nG36\nG01 Z-160 F100\nM80\nM21 P40\n#1139=0\nM30"),
        ("gs", "M94\nM03 S1000\nM63\nM65\nM05\nM95\nM30"),
        ("ga", "M63\nM65\nM95\nM94\nM63\nM30"),
        // K3.7: M15 with the wheel off is no alarm; the wheel may start once the pump is on again.
        ("gc", "M05\nM15\nG04 X2\nM31\nM30"),
        ("gc", "M15\nG04 X2\nM14\nG04 X4\nM03 S1000\nM30"),
    ] {
        let out = check(kind, "O0500.NC", text, &[]);
        assert_eq!(out.status.code(), Some(0), "{kind} {text:?} {}", said(&out));
    }
}

/// A feed per revolution without a turning workpiece is an alarm of the run, unless the operator has started it by key.
#[test]
fn b2_a_feed_per_revolution_before_the_workpiece_turns_is_a_warning() {
    let warned = |text: &str| {
        let told = json("gc", "O0500.NC", text);
        assert_eq!(told["errors"], serde_json::json!([]), "{told}");
        told["warnings"].as_array().unwrap().iter().map(|row| row["line"].as_u64().unwrap()).collect::<Vec<_>>()
    };
    assert_eq!(warned("G99 G01 U-1. F0.1\nU-1.\nM30"), [1]);
    assert_eq!(warned("M63\nG99 G01 U-1. F0.1\nM65\nU-1.\nM30"), [4]);
    assert_eq!(warned("G98 G01 U-1. F100\nG99\nM63\nG01 U-1. F0.1\nM30"), [0; 0]);
}

/// The wheel is held at its rating, 35 m/s of 600 mm: 1114 r/min, and at P64, 1260 r/min: the program says otherwise.
#[test]
fn k3_a_speed_that_the_wheel_does_not_reach_is_a_warning() {
    let warnings = |text: &str| {
        let told = json("gc", "O0500.NC", text);
        assert_eq!(told["errors"], serde_json::json!([]), "{told}");
        let of = |row: &Value| (row["line"].as_u64().unwrap(), row["message"].as_str().unwrap().to_owned());
        told["warnings"].as_array().unwrap().iter().map(of).collect::<Vec<_>>()
    };
    assert_eq!(warnings("M03 S1100\nS1114\nM05\nS1200\nM30"), []);
    let found = warnings("M03 S1100\nS1200\nM05\nS1300\nM30");
    assert_eq!(found.iter().map(|(line, _)| *line).collect::<Vec<_>>(), [2, 4], "{found:?}");
    assert!(found[0].1.contains("1200 r/min") && found[0].1.contains("1114 r/min"), "{found:?}");
    assert!(found[1].1.contains("1300 r/min") && found[1].1.contains("1260 r/min"), "{found:?}");
}

/// A loop that does not end inside a subprogram: what came before it counts.
#[test]
fn s1_an_endless_loop_of_a_subprogram_keeps_what_came_before() {
    let folder = tempfile::tempdir().unwrap();
    let main = folder.path().join("MAIN.MPF");
    std::fs::write(&main, "G90 G94 F600\nG1 X100\nL7\nM2\n").unwrap();
    std::fs::write(folder.path().join("L7.SPF"), "AA1:G91 G1 X-2\nGOTOB AA1\nRET\n").unwrap();
    let out = kt830(&["check", "--kind", "vertical", "--format", "json", main.to_str().unwrap()]);
    let told: Value = serde_json::from_slice(&out.stdout).unwrap();
    assert_eq!((&told["finished"], &told["extents"]["X"]), (&false.into(), &serde_json::json!([0.0, 100.0])), "{told}");
    // 50 mm of slide, and the first pass of the loop with 1 mm, as in a loop of the main program.
    assert!((told["length"].as_f64().unwrap() - 51.0).abs() < 1e-9, "{told}");
}

/// The part built in for O1001 belongs to GC: on GS its work zero would be the place of another machine.
#[test]
fn t4_the_built_in_part_of_another_kind_does_not_count() {
    let zero = |kind: &str| {
        let text = "O1001\nG54\nG00 X1\nM30\n";
        let out = said(&check(kind, "O1001.NC", text, &["--ops", "--format", "json"]));
        let frame: Value = serde_json::from_str(out.lines().next().unwrap()).unwrap();
        assert_eq!(frame["op"], "frame", "{out}");
        frame["z"].as_f64().unwrap()
    };
    assert!((zero("gc") + 400.0).abs() < 1e-9);
    assert!(zero("gs").abs() < 1e-9);
}

/// A loop that waits, or that has too many passes, is left with a warning at the line that jumps back; what stands behind
/// it is executed, mistakes that need the position included.
#[test]
fn t4_a_check_goes_on_behind_a_loop_that_it_does_not_follow_to_the_end() {
    for (text, back, behind) in [
        ("N10 IF[#1000EQ0]GOTO10\nG00 X-10 X-20\nM30\n", 1, 2),
        ("WHILE[#1000EQ0]DO1\n#1=1\nEND1\nG00 X-10 X-20\nM30\n", 3, 4),
        ("N10 #1=1\nGOTO10\nG00 X-10 X-20\nM30\n", 2, 3),
        // An input within a loop that goes on, and a wait within a wait.
        ("#1=0\nWHILE[#1LT5]DO1\n#1=#1+1\nN10 IF[#1000EQ0]GOTO10\nEND1\nG00 X-10 X-20\nM30\n", 4, 6),
        ("N5 #1=0\nN10 IF[#1000EQ0]GOTO10\nIF[#1001EQ0]GOTO5\nG00 X-10 X-20\nM30\n", 2, 4),
        // Three million passes.
        ("#1=0\nN10 #1=#1+1\nIF[#1LT3000000]GOTO10\nG00 X-10 X-20\nM30\n", 3, 4),
        ("#1=0\nWHILE[#1LT3000000]DO1\n#1=#1+1\nEND1\nG00 X-10 X-20\nM30\n", 4, 5),
    ] {
        let out = check("gc", "O0500.NC", text, &["--lang", "en"]);
        let (warning, error) =
            (format!("O0500.NC:{back}:1: warning: this loop is not followed to the end"), "'X' appears twice");
        assert!(warned(&out).contains(&warning), "{text}: {}", warned(&out));
        assert!(said(&out).starts_with(&format!("O0500.NC:{behind}:10: {error}")), "{text}: {}", said(&out));
        // Without the mistake the verdict does not say that all is well.
        let fine = check("gc", "O0500.NC", &text.replace(" X-20", ""), &["--lang", "en"]);
        assert!(said(&fine).starts_with("O0500.NC: no error found, but"), "{text}: {}", said(&fine));
    }
    // What the loop leads to is executed with the positions of the run: this arc ends off its circle.
    let text = "G00 X-10 Z0\nN10 IF[#1000EQ0]GOTO10\nG02 X-20 Z-7 R1 F5\nM30\n";
    let out = check("gc", "O0500.NC", text, &["--lang", "en"]);
    assert!(said(&out).starts_with("O0500.NC:3:"), "{}", said(&out));
}

/// A wait in a called program: the check goes on there, and behind the call.
#[test]
fn t4_a_wait_in_a_called_program_is_left_there() {
    let text = "O0500\nM98 P501\nG00 X-10 X-20\nM30\nO0501\nN10 IF[#1000EQ0]GOTO10\nG00 Z1 Z2\nM99\n";
    let out = check("gc", "O0500.NC", text, &["--lang", "en"]);
    let told = said(&out);
    let lines: Vec<_> = told.lines().filter(|line| line.contains("appears twice")).collect();
    assert!(
        lines.len() == 2 && lines[0].starts_with("O0500.NC:3:10:") && lines[1].starts_with("O0500.NC:7:8: O0501"),
        "{told}"
    );
    assert!(
        warned(&out).contains("O0500.NC:6:1: warning: O0501: this loop is not followed to the end"),
        "{}",
        warned(&out)
    );
}

/// A wait for the oscillation ends in a check, too: #438 toggles.
#[test]
fn t4_a_wait_for_a_reversal_point_is_followed() {
    let text = "G35 Z-5 Q20\nN10 IF[#438EQ0]GOTO10\nN20 IF[#438EQ1]GOTO20\nG36\nM30\n";
    let out = check("gc", "O0500.NC", text, &["--lang", "en"]);
    assert!(said(&out).starts_with("O0500.NC: ok\n"), "{}", said(&out));
}

/// A run counts no blocks: a million assignments and more come to their end. A loop in which nothing changes is found at
/// once.
#[test]
fn t3_a_run_ends_an_endless_loop_by_proof_and_not_by_a_count() {
    let run = |text: &str| {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("O0500.NC"), text).unwrap();
        let out = kt830_in(folder.path(), folder.path(), &["run", "O0500.NC", "--lang", "en"]);
        (out.status.code(), said(&out))
    };
    let (status, told) = run("#100=0\nWHILE[#100LT1010000]DO1\n#100=#100+1\nEND1\nM30\n");
    assert_eq!((status, told.contains("#100 = 1010000")), (Some(0), true), "{told}");
    for text in
        ["G04 P100\nN10 #1=1\nGOTO10\n", "N10 IF[#500EQ#0]GOTO10\nM30\n", "WHILE[1EQ1]DO1\nEND1\nM30\n", "DO1\nEND1\n"]
    {
        let (status, told) = run(text);
        assert_eq!((status, told.contains("repeats and nothing changes")), (Some(1), true), "{text}: {told}");
        let seconds: f64 = told.split_whitespace().nth(1).unwrap().parse().unwrap();
        assert!(seconds < 1.0, "{text}: {told}");
    }
}

/// The table of the language tells what the control does: a code that it calls refused is refused by name, every other is
/// known.
#[test]
fn b2_the_table_of_codes_is_what_a_check_says() {
    for kind in ["gc", "gs"] {
        let out = kt830(&["codes", "--kind", kind, "--format", "json"]);
        assert!(out.status.success());
        let rows: Vec<Value> =
            String::from_utf8(out.stdout).unwrap().lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        let of = |class: &str| rows.iter().filter(|row| row["class"] == class).count();
        assert!(of("G") > 50 && of("M") > 30 && of("function") > 10 && of("variable") > 10, "{kind}");
        let folder = tempfile::tempdir().unwrap();
        // Those with a number alone; the others have examples.
        let is_plain = |row: &&Value| row["word"].as_str().is_some_and(|word| word[1..].parse::<u16>().is_ok());
        let g: Vec<_> = rows.iter().filter(|row| row["class"] == "G").filter(is_plain).collect();
        let text: String = g.iter().map(|row| format!("{}\n", row["word"].as_str().unwrap())).collect();
        let file = folder.path().join("O0500.NC");
        std::fs::write(&file, format!("{text}M30\n")).unwrap();
        let out = kt830(&["check", "--kind", kind, "--lang", "en", file.to_str().unwrap()]);
        let told = String::from_utf8(out.stdout).unwrap();
        for (line, row) in (1..).zip(g) {
            let unknown =
                ["unknown code", "needs a spindle encoder", "does not exist on this machine", "there is no cycle G"];
            let says = |words: &&str| told.lines().any(|of| of.contains(&format!(".NC:{line}:")) && of.contains(words));
            assert_eq!(row["state"] == "refused", unknown.iter().any(says), "{kind} {row}\n{told}");
        }
    }
    for (kind, word) in [("vertical", "ATAN2"), ("lathe", "G22")] {
        let out = kt830(&["codes", "--kind", kind]);
        let text = String::from_utf8(out.stdout).unwrap();
        assert!(text.contains("G0") && text.contains(word), "{text}");
    }
}

/// Every row of statements, operators and words is proved by its example, every word of larger controls by itself.
#[test]
fn b2_what_the_table_says_of_a_word_is_what_a_check_says() {
    let library: SharedLibrary = Arc::new(EmptyLibrary);
    for dialect in [Dialect::LatheA, Dialect::Mill, Dialect::Sinumerik, Dialect::SuperMan] {
        let settings = NcSettings::for_dialect(dialect);
        let mistakes = |blocks: &str| {
            // Every block of the lathe has a number of four digits.
            let lines = blocks.lines().chain(["M02"]).zip(1..);
            let number = |(line, n): (&str, u32)| match dialect {
                Dialect::SuperMan => format!("N{:04} {line}\n", 10 * n),
                Dialect::LatheA | Dialect::Mill | Dialect::Sinumerik => format!("{line}\n"),
            };
            let source = Arc::new(Source::new(1001, "O1001", lines.map(number).collect::<String>(), dialect));
            let faults = nc::check(&source, &library, &settings).faults;
            faults.iter().map(|fault| (fault.location.line, fault.error.id(), fault.to_string())).collect::<Vec<_>>()
        };
        assert!(dialect.language_rows().count() >= 5);
        for row in dialect.language_rows() {
            let found = mistakes(row.example);
            match row.state {
                LanguageState::Refused => {
                    assert_eq!(found.first().map(|(line, ..)| *line), Some(1), "{dialect:?} {}", row.word);
                }
                LanguageState::Supported | LanguageState::NoEffect => assert_eq!(found, [], "{dialect:?} {}", row.word),
            }
        }
        for word in refused_words(dialect) {
            let found = mistakes(&format!("{word}=5"));
            let named = |(line, id, told): &(u32, &str, String)| match *id {
                "foreign-word" | "no-loop-statement" => *line == 1 && told.contains(word),
                // ELSE and ENDIF belong to the IF that is missing.
                id => *line == 1 && id == "no-block-if" && ["ELSE", "ENDIF"].contains(word),
            };
            assert!(found.first().is_some_and(named), "{word}: {found:?}");
        }
    }
}

#[test]
fn k7_3_the_numbers_of_a_picture_are_checked() {
    let out = kt830(&["check", "screens/D0002.RON"]);
    assert!(out.status.success(), "{out:?}");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("D0002.RON");
    std::fs::write(&path, "[\n    (variable: \"#520\", area: (0, 0, 400, 20)),\n]").unwrap();
    let out = kt830(&["check", path.to_str().unwrap()]);
    let told = String::from_utf8_lossy(&out.stdout).into_owned() + &String::from_utf8_lossy(&out.stderr);
    assert!(!out.status.success() && told.contains("200×400"), "{told}");
}

/// Behind an end nothing is known of the position: arcs and contours there are not silently right, once for each program.
#[test]
fn t4_arcs_that_the_check_does_not_come_to_are_named_as_not_checked() {
    let text = "O0001\nG98 G01 X1 F100\nM30\nG02 X2 Z-5 R0.1\nG02 X4 Z-9 R0.1\n";
    let out = check("gc", "O0001.NC", text, &["--lang", "en"]);
    assert_eq!(out.status.code(), Some(0), "{}", said(&out));
    let warning = "O0001.NC:4:12: warning: the check does not come here and does not know where the axes stand";
    assert!(warned(&out).contains(warning), "{}", warned(&out));
    // It says where the next one begins.
    assert!(warned(&out).contains("O0001.NC:5:12: warning: arc radius"), "{}", warned(&out));
    let text = "O0001\nM30\nG02 X2 Z-5 R0.1 F100\nGOTO 8\nG02 X4 Z-9 R0.1 F100\nN8 M99\n";
    let out = check("gc", "O0001.NC", text, &["--lang", "en"]);
    assert_eq!(warned(&out).matches("warning").count(), 1, "once: {}", warned(&out));
    // Lines above that say where the axes stand: the arc itself is named. Without arcs nothing is.
    let text = "O0001\nM30\nG98 G00 X1 Z0\nG02 X2 Z-5 R0.1 F100\n";
    let warning = "O0001.NC:4:12: warning: arc radius";
    let out = check("gc", "O0001.NC", text, &["--lang", "en"]);
    assert!(warned(&out).contains(warning) && !warned(&out).contains("does not come"), "{}", warned(&out));
    let out = check("gc", "O0001.NC", "O0001\nM30\nG98 G01 X1 Z0 F100\n", &["--lang", "en"]);
    assert_eq!(warned(&out), "");
}

/// A feed that no line gives is missed, also where the check does not come.
#[test]
fn t4_a_feed_that_is_missing_behind_a_jump_is_warned_of() {
    let out = check("gc", "O0001.NC", "O0001\nG98\nGOTO 9\nG01 X5\nN9 M30\n", &["--lang", "en"]);
    assert_eq!(out.status.code(), Some(0), "{}", said(&out));
    assert!(warned(&out).contains("O0001.NC:4:") && warned(&out).contains("F"), "{}", warned(&out));
    let out = check("gc", "O0001.NC", "O0001\nG98\nG01 X4 F100\nGOTO 9\nG01 X5\nN9 M30\n", &[]);
    assert_eq!(warned(&out), "");
    // The caller of a subprogram may have it.
    let out = check("gc", "O0001.NC", "O0001\nG98 F100\nGOTO 9\nM98 P2\nN9 M30\nO0002\nG01 X5\nM99\n", &[]);
    assert_eq!((out.status.code(), warned(&out)), (Some(0), String::new()), "{}", said(&out));
}

/// A jump that the inputs or a condition do not ask for needs its target all the same, in a check as in a run.
#[test]
fn t4_b4_the_target_of_a_jump_that_is_not_taken_must_be_there() {
    for (block, n) in [("M91 P3 L77", 77), ("M92 P3 L78", 78), ("G65 H81 P79 Q1 R2", 79)] {
        let out = check("gc", "O0001.NC", &format!("O0001\n{block}\nM30\n"), &["--lang", "en"]);
        assert!(said(&out).contains(&format!("there is no block N{n}")), "{block}: {}", said(&out));
    }
}

/// What a value that only a run has cannot mend is an error; what it decides is a warning.
#[test]
fn t4_an_unknown_value_hides_only_what_it_decides() {
    let certain = "O0001\nG98\nG00 X[-80-#500]\nG01 Z-100\nM30\n";
    assert!(said(&check("gc", "O0001.NC", certain, &["--lang", "en"])).contains("O0001.NC:4:"));
    for open in ["F#500\nG01 Z-100", "IF[#500EQ1]THEN F100\nG01 Z-100", "GOTO#500\nN5 M30", "GOTO[#500]\nN5 M30"] {
        let out = check("gc", "O0001.NC", &format!("O0001\nG98\n{open}\nM30\n"), &["--lang", "en"]);
        assert_eq!(out.status.code(), Some(0), "{open}: {}", said(&out));
        assert!(!warned(&out).is_empty(), "{open}");
    }
}

/// A contour that no G40 ends, with an end of the program behind it or none.
#[test]
fn t4_a_program_that_ends_during_compensation_is_warned_of() {
    let text = "O0001\nG98 G00 X-80 Z-100\n#2903=2\nT0303\nG42 G01 X-90 F500\nZ-110\n";
    for (end, count) in [("", 1), ("M30\n", 1), ("G40 X-80\nM30\n", 0)] {
        let out = check("gc", "O0001.NC", &format!("{text}{end}"), &["--lang", "en"]);
        assert_eq!(warned(&out).matches("ends during compensation G42").count(), count, "{end}: {}", warned(&out));
    }
}

/// Behind an unknown feed other mistakes of the block are found.
#[test]
fn t4_a_called_program_without_its_feed_is_checked_for_all_else() {
    let text = "O0001\nIF[#500EQ1]GOTO 5\nM30\nN5 M98 P2\nM30\nO0002\nG02 X-90 Z-105\nM99\n";
    let out = check("gc", "O0001.NC", text, &["--lang", "en"]);
    let all = format!("{}{}", said(&out), warned(&out));
    assert!(all.contains("O0001.NC:7:") && all.contains("centre"), "{all}");
}

/// What a program writes into offsets and origins is checked as the run takes it.
#[test]
fn t4_k4_4_offsets_and_origins_that_a_run_would_refuse_are_named() {
    for (write, place) in [
        ("#2001=-1000", "#2001 = -1000 (±999.999)"),
        ("#5221=999999", "#5221 = 999999 (±9999.999)"),
        ("#5203=10000", "#5203"),
        ("#7001=-10000", "#7001 = -10000 (±9999.999)"),
        ("#2901=1000", "#2901 = 1000"),
        ("#2901=-0.1", "#2901 = -0.1"),
        ("#2301=10", "#2301 = 10"),
    ] {
        let out = check("gc", "O0001.NC", &format!("O0001\n{write}\nM30\n"), &["--lang", "en"]);
        assert_eq!(out.status.code(), Some(2), "{write}: {}", said(&out));
        assert!(said(&out).contains(place), "{write}: {}", said(&out));
    }
    for write in ["#5221=9999", "#2901=2", "#2301=9", "#2001=-0.1"] {
        let out = check("gc", "O0001.NC", &format!("O0001\n{write}\nM30\n"), &[]);
        assert_eq!(out.status.code(), Some(0), "{write}: {}", said(&out));
    }
}

/// What M30 switches off stays on without it: told for the first of them; nothing is told where nothing is on.
#[test]
fn b2_a_text_that_ends_without_m30_leaves_on_what_it_has_switched_on() {
    let words = &["--lang", "en"];
    let told = |text: &str| warned(&check("gc", "O0002.NC", text, words));
    let told_of = |text: &str| told(text).contains("the program has no end code (M30, M02): coolant stays on");
    assert!(told_of("G54 G00 X10\nM08\nX20\n"));
    // An endless program and a subprogram have their M99.
    for quiet in ["G54 G00 X10\nM08\nX20\nM30\n", "G54 G00 X10\nM08\nM09\n", "G54 G00 X10\n", "G54 G00 X10\nM08\nM99\n"]
    {
        assert_eq!(told(quiet), "", "{quiet}");
    }
}

/// 802D: G96 and G97 alone switch F to mm/rev, too.
#[test]
fn s1_a_feed_per_revolution_without_the_workpiece_turning_is_warned_of() {
    let words = &["--lang", "en"];
    for text in ["G95\nG1 X-210 F0.1\nM30\n", "G97\nG1 X-210 F0.1\nM30\n"] {
        let out = check("vertical", "VTEST.MPF", text, words);
        assert!(warned(&out).contains("turns of the"), "{text}: {} {}", warned(&out), said(&out));
    }
}

/// The list of mistakes ends with a word that it does.
#[test]
fn b1_a_list_of_mistakes_that_is_cut_says_so() {
    let text = |lines: usize| "G999\n".repeat(lines);
    let out = check("gc", "O0003.NC", &text(1_100), &["--lang", "en"]);
    assert!(said(&out).contains("the others are not listed"));
    assert!(!said(&check("gc", "O0003.NC", &text(900), &["--lang", "en"])).contains("not listed"));
    assert_eq!(json("gc", "O0003.NC", &text(1_100))["truncated"], serde_json::json!(true));
}

/// What the run refuses with alarm 204 whatever the offset holds.
#[test]
fn k4_1_g10_adds_no_more_than_an_offset_may_hold() {
    let words = &["--lang", "en"];
    assert_eq!(check("gc", "O0004.NC", "G10 D1 U999.999 W-1\nM30\n", words).status.code(), Some(0));
    for text in ["G10 D1 U9999\nM30\n", "G10 D1 U0.1 W-1000\nM30\n"] {
        let out = check("gc", "O0004.NC", text, words);
        assert_eq!(out.status.code(), Some(2), "{}", said(&out));
        assert!(said(&out).contains("alarm 204"), "{}", said(&out));
    }
}
