//! The command line as a user calls it: results, exit statuses and messages (tools.md T1–T6).

use std::path::Path;
use std::process::{Command, Output};

use crate::command::kt830;
use serde_json::Value;

fn json(words: &[&str]) -> Value {
    let out = kt830(words);
    serde_json::from_slice(&out.stdout).unwrap_or_else(|error| panic!("{error}: {out:?}"))
}

fn status(out: &Output) -> i32 {
    out.status.code().unwrap()
}

fn errors(out: &Output) -> String {
    String::from_utf8_lossy(&out.stderr).into_owned()
}

/// A file of its own for one test.
fn file(name: &str, bytes: &[u8]) -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    let path = path.to_string_lossy().into_owned();
    (folder, path)
}

fn diameter(report: &Value) -> f64 {
    let all: Vec<f64> =
        report["part"]["diameters"].as_array().unwrap().iter().map(|at| at["d"].as_f64().unwrap()).collect();
    all.iter().sum::<f64>() / all.len() as f64
}

#[test]
fn k1_the_kind_set_on_the_machine_holds_where_none_is_asked_for() {
    let data = tempfile::tempdir().unwrap();
    std::fs::write(data.path().join("settings.ron"), "(kind: Some(Gs))").unwrap();
    let folder = data.path().to_string_lossy().into_owned();
    let (_story, path) = file("magnet.story", b"power on\nkey magnetise\nwait 0.5 s\nexpect output magnetise on\n");
    let stored = kt830(&["play", &path, "--data", &folder]);
    assert_eq!(status(&stored), 0, "{stored:?}");
    let asked = kt830(&["play", &path, "--data", &folder, "--kind", "gc"]);
    assert!(status(&asked) == 2 && errors(&asked).contains("those of kind gs"), "{}", errors(&asked));
    std::fs::write(data.path().join("settings.ron"), "(kind: Some(Gx))").unwrap();
    let wrong = kt830(&["play", &path, "--data", &folder]);
    assert!(status(&wrong) == 0 && errors(&wrong).contains("settings.ron line 1"), "{}", errors(&wrong));
}

#[test]
fn t3_o1002_grinds_to_the_asked_diameter_within_2_um() {
    for asked in [40.0, 39.9, 40.1] {
        let set = format!("#521={asked}");
        let report = json(&["run", "O1002", "--kind", "gc", "--set", &set, "--format", "json"]);
        assert_eq!(report["end"], "finished");
        assert!((diameter(&report) - asked).abs() < 0.002, "asked {asked}, ground {}", diameter(&report));
        assert_eq!(report["events"].as_array().unwrap().len(), 0);
        assert_eq!(report["parts"], 1);
    }
}

/// The plunge cycle of the code table grinds to the size signal, without a look at the diameter it was given.
#[test]
fn k4_5_the_plunge_cycle_ends_at_the_size_signal() {
    let text = "O2001\nG98 G97 G64\nT0101\nG00 X60\nZ[#623]\nM03\nM64\nM08\nM70\nG04 X1.2\nG00 X40.5\n\
                G176 X39.95 A0.1 F0.6 E0.1 U0 P4\nG00 X60\nM75\nM31\nM30\n";
    let (_folder, path) = file("O2001.NC", text.as_bytes());
    let table = ["--param", "P428=176", "--param", "P429=9076"];
    let mut words = vec!["run", &path, "--kind", "gc", "--part", "assets/parts/O1004.ron", "--format", "json"];
    words.extend(table);
    let report = json(&words);
    assert_eq!(report["end"], "finished");
    assert!((diameter(&report) - 40.0).abs() < 0.002, "{}", diameter(&report));
}

#[test]
fn t3_a_batch_runs_the_program_for_every_part() {
    let report = json(&["run", "O1002", "--parts", "3", "--format", "json"]);
    assert_eq!((&report["end"], &report["parts"]), (&"finished".into(), &3.into()));
    let batch = report["batch"].as_array().unwrap();
    assert_eq!(batch.len(), 3);
    for part in batch {
        assert_eq!(part["diameters"].as_array().unwrap().len(), 5);
        assert!((diameter(&serde_json::json!({"part": part})) - 40.0).abs() < 0.002);
    }
    // An alarm ends the batch with the part that it came with.
    let out = kt830(&["run", "O1002", "--parts", "3", "--set", "#521=40.5", "--format", "json"]);
    assert_eq!(status(&out), 1);
    assert!(serde_json::from_slice::<Value>(&out.stdout).unwrap()["batch"].is_null());
    assert_eq!(status(&kt830(&["run", "O1002", "--parts", "0"])), 2);
}

#[test]
fn p5_without_spark_out_the_part_stays_larger() {
    let report = json(&["run", "O1002", "--set", "#528=0", "--format", "json"]);
    // Fine feed 0.3 mm/min = 5 µm/s; τ = 0.8 s leaves about 4 µm of radius, 8 µm of diameter.
    assert!(diameter(&report) > 40.004, "{}", diameter(&report));
}

#[test]
fn k7_9_o1001_grinds_both_jaw_faces_to_the_typed_allowances() {
    let cases: [(&[&str], f64, f64); 3] = [
        (&[], 10.0 - 0.25, 50.0 + 0.25),
        (&["--set", "#505=0.03", "--set", "#516=0.04"], 10.0 - 0.23, 50.0 + 0.24),
        (&["--set", "#506=0.3", "--set", "#507=1", "--set", "#502=10.01"], 10.01 - 0.35, 50.0 + 0.25),
    ];
    for (sets, left, right) in cases {
        let mut words = vec!["run", "O1001", "--format", "json"];
        words.extend_from_slice(sets);
        let report = json(&words);
        assert_eq!(report["end"], "finished");
        for face in report["part"]["faces"].as_array().unwrap() {
            let z = face["z"].as_f64().unwrap();
            let wanted = if z < 30.0 { left } else { right };
            assert!((z - wanted).abs() < 0.003, "{sets:?}: face at {z}, wanted {wanted}");
        }
    }
}

#[test]
fn t1_without_a_display_it_says_what_to_use_instead() {
    if cfg!(feature = "hmi") {
        let out = kt830(&[]);
        assert_eq!(status(&out), 2);
        for word in ["display", "demo", "run", "shot"] {
            assert!(errors(&out).contains(word), "{}", errors(&out));
        }
    }
}

#[test]
fn t2_the_demo_grinds_a_part_without_a_display() {
    let out = kt830(&["demo"]);
    assert_eq!(status(&out), 0, "{}", errors(&out));
    assert!(String::from_utf8_lossy(&out.stdout).contains("part diameter"));
}

#[test]
fn t2_a_film_has_a_picture_for_each_moment_and_says_what_cannot_be() {
    let folder = tempfile::tempdir().unwrap();
    let (story, film) = (folder.path().join("short.story"), folder.path().join("film"));
    std::fs::write(&story, "kind gc\npower on\npage home\ncaption \"一\" \"one\"\nwait 2 s\n").unwrap();
    let (story, film) = (story.to_str().unwrap(), film.to_str().unwrap());
    let out = kt830(&["demo", story, "--record", film, "--fps", "4"]);
    assert_eq!(status(&out), 0, "{}", errors(&out));
    // Two seconds, a few ticks of answers, and the picture at the begin.
    let names: Vec<_> = (1..=9).map(|number| format!("frame-{number:05}.png")).collect();
    assert!(names.iter().all(|name| Path::new(film).join(name).exists()));
    assert!(!Path::new(film).join("frame-00010.png").exists());
    // The pace is kept where a tick does not divide it.
    let fast = folder.path().join("fast");
    let out = kt830(&["demo", story, "--record", fast.to_str().unwrap(), "--fps", "30"]);
    assert_eq!(status(&out), 0, "{}", errors(&out));
    let count = std::fs::read_dir(&fast).unwrap().count();
    assert!((60..=62).contains(&count), "{count} pictures");
    // What comes before `prepared` is played, but not seen.
    std::fs::write(
        story,
        "kind gs\npower on\nkey 液压\nwait 30 s\nprepared\nexpect input hydraulic-pressure on\nwait 1 s\n",
    )
    .unwrap();
    let short = folder.path().join("prepared");
    let out = kt830(&["demo", story, "--record", short.to_str().unwrap(), "--fps", "4"]);
    assert_eq!(status(&out), 0, "{}{}", String::from_utf8_lossy(&out.stdout), errors(&out));
    assert_eq!(std::fs::read_dir(&short).unwrap().count(), 5);
    // A story that fails is filmed to its end, and told.
    std::fs::write(story, "kind gc\npower on\nexpect state running\nwait 1 s\n").unwrap();
    let out = kt830(&["demo", story, "--record", film, "--fps", "1"]);
    assert_eq!(status(&out), 1);
    assert!(String::from_utf8_lossy(&out.stdout).contains("FAIL  line 3"), "{out:?}");
    for (words, said) in [
        (&["demo", "--fps", "5"][..], "--record"),
        (&["demo", "--record", film, "--fps", "0"], "--fps"),
        (&["demo", "--record", film, "--out", film], "--out"),
        (&["demo", story, "--record", &format!("{story}/x")], "--record"),
    ] {
        let out = kt830(words);
        assert_eq!(status(&out), 2, "{words:?}");
        assert!(errors(&out).contains(said), "{}", errors(&out));
    }
}

#[test]
fn t4_what_comes_along_has_no_mistake() {
    let gc = [
        "1001", "1002", "1003", "1004", "1005", "1006", "1011", "1012", "1015", "1016", "1017", "1018", "1019", "1020",
        "9000", "9001", "9010", "9011", "9012", "9013", "9014", "9015", "9016", "9071", "9073", "9076",
    ];
    let kinds: [(&str, &[&str]); 3] = [
        ("gc", &gc),
        ("gs", &["1007", "1008", "1009", "1013", "9000", "9001", "9017", "9020", "9075", "9077", "9078", "9079"]),
        ("ga", &["1010", "1014", "9000", "9001", "9018"]),
    ];
    let mut seen = std::collections::BTreeSet::new();
    for (kind, numbers) in kinds {
        let files: Vec<String> = numbers.iter().map(|number| format!("programs/O{number}.NC")).collect();
        let mut words = vec!["check", "--kind", kind];
        words.extend(files.iter().map(String::as_str));
        let out = kt830(&words);
        assert_eq!(status(&out), 0, "{}", String::from_utf8_lossy(&out.stdout));
        // A subprogram by itself has no arguments; a program with its page's values gives no warning.
        let warned = errors(&out).lines().filter(|line| line.starts_with("programs/O1")).count();
        assert_eq!(warned, 0, "{}", errors(&out));
        seen.extend(numbers.iter().map(|number| format!("O{number}.NC")));
    }
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    for entry in std::fs::read_dir(here.join("programs")).unwrap() {
        let name = entry.unwrap().file_name().to_string_lossy().into_owned();
        // Other dialects stand in folders of their own.
        assert!(seen.contains(&name) || !name.ends_with(".NC"), "{name} is checked on no kind");
    }
    let mut pages: Vec<String> = std::fs::read_dir(here.join("screens"))
        .unwrap()
        .map(|entry| format!("screens/{}", entry.unwrap().file_name().to_string_lossy()))
        .collect();
    pages.insert(0, "check".to_owned());
    let words: Vec<&str> = pages.iter().map(String::as_str).collect();
    assert_eq!(status(&kt830(&words)), 0);
}

#[test]
fn k7_3_a_control_that_is_set_up_anew_has_every_program_and_page() {
    let (data, elsewhere) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let out = Command::new(env!("CARGO_BIN_EXE_kt830"))
        .args(["run", "O1011", "--format", "json", "--data"])
        .arg(data.path())
        .current_dir(elsewhere.path())
        .output()
        .unwrap();
    // O1011 calls O9011.
    assert_eq!(serde_json::from_slice::<Value>(&out.stdout).unwrap()["end"], "finished", "{out:?}");
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    for folder in ["programs", "screens"] {
        for entry in std::fs::read_dir(here.join(folder)).unwrap() {
            let entry = entry.unwrap();
            let there = data.path().join(folder).join(entry.file_name());
            let whole = entry.path().is_dir() || std::fs::read(&there).unwrap() == std::fs::read(entry.path()).unwrap();
            assert!(whole, "{}", there.display());
        }
    }
}

#[test]
fn t4_every_error_of_a_file_is_told_with_line_and_column() {
    let (_folder, path) = file("O2001.NC", b"G00 X1\nG01 X1..5 F10\nG777\n#1=[1+\nM30\n");
    let report = json(&["check", &path, "--format", "json"]);
    let lines: Vec<_> = report["errors"].as_array().unwrap().iter().map(|at| at["line"].as_u64().unwrap()).collect();
    assert_eq!(lines, [2, 3, 4]);
    assert_eq!(status(&kt830(&["check", &path])), 2);
    assert_eq!(status(&kt830(&["check", "programs/O1002.NC", "screens/C0001.TXT", "screens/B0001.BMP"])), 0);
}

#[test]
fn k7_4_k5_12_page_files_name_what_is_wrong() {
    let (_folder, path) = file("C0009.TXT", "标题；\n%".as_bytes());
    let out = kt830(&["check", &path]);
    assert!(status(&out) == 2 && String::from_utf8_lossy(&out.stdout).contains("全角"));
    let mut picture = std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("screens/B0001.BMP")).unwrap();
    picture[28] = 8;
    let (_folder, path) = file("B0009.BMP", &picture);
    assert!(String::from_utf8_lossy(&kt830(&["check", &path]).stdout).contains("24"));
    picture[28] = 24;
    picture[18] = 100;
    let (_folder, path) = file("B0009.BMP", &picture);
    assert!(String::from_utf8_lossy(&kt830(&["check", &path]).stdout).contains("200×400"));
}

/// K5.12: PhotoShop adds two bytes of padding, and counts them in bfSize and biSizeImage.
#[test]
fn k5_12_a_picture_with_padding_opens_and_one_cut_short_is_named() {
    let picture = std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("screens/B0001.BMP")).unwrap();
    let mut padded = [&picture[..], &[0, 0]].concat();
    assert_eq!(padded.len(), 240_056);
    for (at, value) in [(2, 240_056_u32), (34, 240_002)] {
        let (_folder, path) = file("B0009.BMP", &padded);
        assert_eq!(status(&kt830(&["check", &path])), 0, "before the size at byte {at} is changed");
        padded[at..at + 4].copy_from_slice(&value.to_le_bytes());
    }
    let (_folder, path) = file("B0009.BMP", &padded);
    assert_eq!(status(&kt830(&["check", &path])), 0);
    let (_folder, path) = file("B0009.BMP", &picture[..240_053]);
    let out = kt830(&["check", &path]);
    assert!(status(&out) == 2 && String::from_utf8_lossy(&out.stdout).contains("240053"));
}

#[test]
fn t3_a_loop_that_moves_nothing_ends_the_run_by_itself() {
    let (_folder, path) = file("O2004.NC", b"N10 #100=1\nGOTO 10\nM30\n");
    let out = kt830(&["run", &path, "--format", "json", "--lang", "en"]);
    let report: Value = serde_json::from_slice(&out.stdout).unwrap();
    assert_eq!((status(&out), &report["end"]), (1, &"stopped".into()), "{report}");
    assert!(report["message"].as_str().unwrap().contains("does not end"), "{report}");
    // M99 of the main program is such a jump, too.
    let (_alone, m99) = file("O2005.NC", b"M99\n");
    assert!(errors(&kt830(&["run", &m99, "--lang", "en"])).contains("does not end"));
    let out = kt830(&["run", &path, "--lang", "en"]);
    assert_eq!(status(&out), 1);
    assert!(errors(&out).contains("does not end"));
    assert!(String::from_utf8_lossy(&out.stdout).contains("does not end"));
}

#[test]
fn t3_a_wait_that_nobody_answers_fails_and_a_pause_does_not() {
    let (_folder, path) = file("O2005.NC", b"M80\nM30\n");
    let out = kt830(&["run", &path, "--format", "json", "--lang", "en"]);
    let report: Value = serde_json::from_slice(&out.stdout).unwrap();
    assert_eq!((status(&out), &report["end"]), (1, &"stopped".into()), "{report}");
    assert!(report["message"].as_str().unwrap().contains("M80"), "{report}");
    assert!(errors(&out).contains("stopped"));
    let (_folder, path) = file("O2006.NC", b"M00\nM30\n");
    let out = kt830(&["run", &path, "--format", "json"]);
    let report: Value = serde_json::from_slice(&out.stdout).unwrap();
    assert_eq!((status(&out), &report["end"]), (0, &"stopped".into()), "M00 ends a run as it is asked to");
}

#[test]
fn t3_a_run_that_ends_in_an_alarm_ends_with_1_and_names_its_place() {
    let (_folder, path) = file("O2002.NC", b"#100=1\nG00 X-90\nG01 X[1/0] F10\nM30\n");
    let out = kt830(&["run", &path, "--format", "json"]);
    assert_eq!(status(&out), 1);
    let report: Value = serde_json::from_slice(&out.stdout).unwrap();
    assert_eq!(
        (&report["end"], &report["alarms"][0]["program"], &report["alarms"][0]["line"]),
        (&"alarm".into(), &2002.into(), &3.into())
    );
}

#[test]
fn a_wrong_call_ends_with_2_and_says_what_to_do() {
    for words in [
        &["run", "O4711"][..],
        &["run", "O1002", "--set", "500=1"],
        &["run", "O1002", "--set", "#570=2"],
        &["run", "O1002", "--param", "P499=1"],
        &["run", "O1002", "--part", "no-such.ron"],
        &["play", "no-such.story"],
        &["run", "O1002", "--kind", "xx"],
        &["frobnicate"],
    ] {
        let out = kt830(words);
        assert_eq!(status(&out), 2, "{words:?}");
        assert!(!errors(&out).is_empty(), "{words:?}");
    }
}

#[test]
fn t5_a_story_that_cannot_be_read_is_a_wrong_call_and_one_that_fails_is_1() {
    let (_folder, path) = file("a.story", "kind gc\npower on\njump\n".as_bytes());
    let out = kt830(&["play", &path]);
    assert!(status(&out) == 2 && errors(&out).contains("line 3, column 1"), "{}", errors(&out));
    let (_folder, path) = file("b.story", "expect output wheel on\n".as_bytes());
    assert_eq!(status(&kt830(&["play", &path])), 1);
}

#[test]
fn t5_the_stories_that_come_along_play_to_their_end() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/stories");
    let mut played = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let story = entry.unwrap().path();
        let out = kt830(&["play", &story.to_string_lossy()]);
        assert_eq!(status(&out), 0, "{}: {}{}", story.display(), String::from_utf8_lossy(&out.stdout), errors(&out));
        played += 1;
    }
    assert!(played >= 6, "{played} stories");
}

#[test]
fn t5_a_part_file_that_is_not_there_is_a_wrong_call() {
    let (_folder, path) = file("a.story", b"kind gc\npower on\npart nowhere.ron\n");
    let out = kt830(&["play", &path]);
    assert!(status(&out) == 2 && errors(&out).contains("nowhere.ron"), "{}", errors(&out));
}

#[test]
fn t5_a_setting_that_the_control_refuses_fails_with_its_reason() {
    for (line, why) in [
        ("param P270 99999", "60000"),
        ("param P270 -1", "60000"),
        ("param P999 1", "P999"),
        ("set #1 = 2", "#1"),
        ("set #570 = 2", "#570"),
        ("load O1999", "O1999"),
        ("load foo", "foo"),
    ] {
        let (_folder, path) = file("a.story", format!("kind gc\npower on\n{line}\nwait 1 s\n").as_bytes());
        let out = kt830(&["play", &path]);
        let told = String::from_utf8_lossy(&out.stdout).into_owned();
        assert_eq!(status(&out), 1, "{told}");
        let last = told.lines().last().unwrap();
        assert!(last.contains("FAIL") && last.contains(line) && last.contains(why), "{told}");
        assert!(!last.contains("MPF"), "{told}");
    }
}

#[test]
fn t5_a_key_that_is_refused_is_no_failure() {
    let story =
        "kind gc\npower on\nmode jog\nkey wheel-start\nexpect output wheel off\ntype #570 2\nmode auto\nmdi M03\n";
    let (_folder, path) = file("a.story", story.as_bytes());
    let out = kt830(&["play", &path]);
    assert_eq!(status(&out), 0, "{}", String::from_utf8_lossy(&out.stdout));
}

#[test]
fn k7_1_a_story_turns_the_views_of_the_position_page_and_sees_them() {
    if !cfg!(feature = "hmi") {
        return; // without the screen there is nothing to see
    }
    let story = "kind gc\npower on\npage position\nexpect page position shows \"综合坐标\"\nkey f1\n\
        expect page position shows \"相对坐标\"\nkey f3\nexpect page position shows \"机床坐标\"\nkey f2\n\
        expect page position shows \"综合坐标\"\nkey f4\npage position\nkey next-row\nkey f2\n\
        expect page diagnosis shows \"诊断\"\n";
    let (_folder, path) = file("a.story", story.as_bytes());
    let out = kt830(&["play", &path]);
    assert_eq!(status(&out), 0, "{}", String::from_utf8_lossy(&out.stdout));
    // A picture after a story shows the view that the story has turned to; nothing else differs.
    let shot = |name: &str, story: &str| {
        let (folder, path) = file("b.story", story.as_bytes());
        let picture = folder.path().join(name);
        let out = kt830(&["shot", "position", "--out", &picture.to_string_lossy(), "--story", &path]);
        assert_eq!(status(&out), 0, "{}", errors(&out));
        std::fs::read(picture).unwrap()
    };
    let all = shot("all.png", "kind gc\npower on\nmode jog\nkey f1\nkey f2\n");
    let machine = shot("machine.png", "kind gc\npower on\nmode jog\nkey f1\nkey f3\n");
    assert!(all != machine);
}

#[test]
fn t5_the_faults_are_told_by_a_story() {
    let (_folder, path) = file("a.story", b"kind gc\npower on\nfault list\nwait 1 s\nexpect no alarm\n");
    let out = kt830(&["play", &path]);
    let told = String::from_utf8_lossy(&out.stdout).into_owned();
    assert_eq!(status(&out), 0, "{told}");
    for words in ["stuck-on NAME", "drive-x", "bus-silent N", "X 驱动故障", "hydraulic pressure lost"] {
        assert!(told.contains(words), "{told}");
    }
    let out = kt830(&["play", &path, "--format", "json"]);
    let line = String::from_utf8_lossy(&out.stdout).lines().nth(2).map(str::to_owned).unwrap();
    let told: Value = serde_json::from_str(&line).unwrap();
    assert_eq!((told["faults"].as_array().unwrap().len(), &told["ok"]), (19, &true.into()));
}

#[test]
fn damaged_data_are_kept_and_told() {
    let data = tempfile::tempdir().unwrap();
    std::fs::write(data.path().join("retained.redb"), b"this is no database").unwrap();
    let folder = data.path().to_string_lossy().into_owned();
    let out = kt830(&["run", "O1002", "--data", &folder, "--format", "json"]);
    assert!(errors(&out).contains("damaged"), "{}", errors(&out));
    let kept = std::fs::read_dir(data.path())
        .unwrap()
        .any(|entry| entry.unwrap().file_name().to_string_lossy().contains("damaged"));
    assert!(kept, "the damaged file is kept");
}

#[test]
#[cfg(feature = "hmi")]
fn t6_a_picture_of_a_page_has_a_clock_and_is_the_same_every_time() {
    let folder = tempfile::tempdir().unwrap();
    let shot = |name: &str, clock: &[&str]| {
        let out = folder.path().join(name);
        let done = kt830(&[&["shot", "settings", "--out", &out.to_string_lossy()], clock].concat());
        assert_eq!(status(&done), 0, "{done:?}");
        std::fs::read(out).unwrap()
    };
    let first = shot("a.png", &[]);
    assert_eq!(first, shot("b.png", &["--clock", "2026-11-21 15:01:56"]), "the clock of a picture is fixed");
    assert_ne!(first, shot("c.png", &["--clock", "2026-12-24 08:00:00"]));
    let wrong = kt830(&["shot", "settings", "--out", "d.png", "--clock", "noon"]);
    assert!(status(&wrong) == 2 && errors(&wrong).contains("2026-11-21 15:01:56"), "{}", errors(&wrong));
}

#[test]
fn t5_a_story_is_played_to_a_time_and_every_tick_is_traced() {
    let story = "kind gc\npower on\nkey hydraulic\nwait 2 s\nmode home\npage position\nwait 60 s\nexpect alarm 999\n";
    let (folder, path) = file("a.story", story.as_bytes());
    let trace = folder.path().join("trace.csv").to_string_lossy().into_owned();
    let out = kt830(&["play", &path, "--until", "3.5 s", "--trace", &trace]);
    assert_eq!(status(&out), 0, "{}", errors(&out));
    let told = String::from_utf8_lossy(&out.stdout).into_owned();
    assert!(told.contains("at 3.500 s: state idle") && told.contains("outputs: "), "{told}");
    assert!(told.contains("page position") && !told.contains("FAIL") && !told.contains("alarm 999"), "{told}");
    let rows = std::fs::read_to_string(&trace).unwrap();
    let mut lines = rows.lines();
    assert!(lines.next().unwrap().starts_with("now_us,inputs,"));
    let times: Vec<u64> = lines.map(|line| line.split(',').next().unwrap().parse().unwrap()).collect();
    assert_eq!((times[0], *times.last().unwrap()), (times[1] - times[0], 3_500_000), "every tick to the time");
    assert!(times.windows(2).all(|pair| pair[1] - pair[0] == times[0]));
}

#[test]
fn t5_after_the_end_of_the_story_the_machine_runs_on_to_the_time() {
    let (_folder, path) = file("a.story", b"kind gc\npower on\n");
    let out = kt830(&["play", &path, "--until", "250 ms", "--format", "json"]);
    let last: Value = serde_json::from_str(String::from_utf8_lossy(&out.stdout).lines().last().unwrap()).unwrap();
    assert_eq!(last["seconds"].as_f64(), Some(0.25));
    assert!(last["axes"]["X"]["machine"].is_number() && last["alarms"].is_array(), "{last}");
}

#[test]
fn t5_a_wrong_time_and_a_trace_that_cannot_be_written_are_told() {
    let (_folder, path) = file("a.story", b"kind gc\npower on\n");
    for (words, why) in [
        (["--until", "12 parsecs"], "unit of time"),
        (["--until", "12"], "a unit: ms, s, min is missing"),
        (["--trace", "/no/such/folder/a.csv"], "--trace /no/such/folder/a.csv"),
    ] {
        let out = kt830(&["play", &path, words[0], words[1]]);
        assert!(status(&out) == 2 && errors(&out).contains(why), "{words:?}: {}", errors(&out));
    }
}

/// H9: the English text beside a page text is checked with it, and by itself.
#[test]
fn h9_the_check_names_where_an_english_text_does_not_fit() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let (own, english) = (path("C0009.TXT"), path("C0009.EN.TXT"));
    std::fs::write(&own, "磨削;\n毛坯 #520;\n成品 #521;\n;;;;;;;;%").unwrap();
    let out = kt830(&["check", &own, "--lang", "en"]);
    assert!(status(&out) == 0 && errors(&out).is_empty(), "a page text needs no English: {out:?}");
    std::fs::write(&english, "grinding;\nblank #520;\nfinish #522;\n;;;;;;;;%").unwrap();
    for file in [&own, &english] {
        let out = kt830(&["check", file, "--lang", "en"]);
        assert_eq!(status(&out), 0, "{out:?}");
        let told = errors(&out);
        assert!(told.contains("C0009.EN.TXT:3:1: warning: the page text has no #522"), "{told}");
        assert!(told.contains("C0009.EN.TXT:4:9: warning: '成品 #521' has no English"), "{told}");
        assert_eq!(json(&["check", file, "--format", "json"])["warnings"].as_array().unwrap().len(), 2);
    }
    std::fs::write(&english, "grinding;\nblank 520;\n%").unwrap();
    let out = kt830(&["check", &own, "--lang", "en"]);
    assert!(status(&out) == 0 && errors(&out).contains("C0009.EN.TXT:2:1: warning"), "{out:?}");
    let out = kt830(&["check", &english, "--lang", "en"]);
    assert!(status(&out) == 2 && String::from_utf8_lossy(&out.stdout).contains("C0009.EN.TXT:2:1"), "{out:?}");
}

/// B8: a row of texts that belongs to nothing is a warning.
#[test]
fn b8_the_check_names_text_rows_that_do_not_fit() {
    let (_folder, path) = file("O2001.NC", "O2001\nM30\n(#3000=1 原因: 尺寸)\n(#3000=1 原因)\n".as_bytes());
    let out = kt830(&["check", &path, "--lang", "en"]);
    assert_eq!(status(&out), 0, "{out:?}");
    let told = errors(&out);
    assert!(told.contains(":3:1: warning: the program has no #3000=1"), "{told}");
    assert!(told.contains(":4:1: warning: text row not understood"), "{told}");
}

/// A burnt part is scrap: the report says so, and the status is not that of success.
#[test]
fn t3_a_bad_part_is_told_and_is_no_success() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path.to_string_lossy().into_owned()
    };
    // O1002 roughs at 0.6 mm/min of radius on diameter 40: π·40·0.01 = 1.26 mm³/(mm·s), more than 0.1.
    let burns = write("burns.ron", "(burn_mm2_s: Some(0.1))");
    let good = kt830(&["run", "O1002", "--format", "json"]);
    let burnt = kt830(&["run", "O1002", "--machine", &burns, "--format", "json"]);
    let told = |out: &std::process::Output| -> serde_json::Value { serde_json::from_slice(&out.stdout).unwrap() };
    assert_eq!((status(&good), &told(&good)["verdict"]), (0, &"ok".into()));
    assert_eq!((status(&burnt), &told(&burnt)["verdict"]), (1, &"burn".into()));
    // Out of the limits of its page.
    let out = kt830(&["run", "O1002", "--set", "#532=-0.005", "--format", "json"]);
    assert_eq!((status(&out), &told(&out)["verdict"]), (1, &"out-of-tolerance".into()));
    // A wrong machine file names its place; a real machine is not for runs.
    let wrong = kt830(&["run", "O1002", "--machine", &write("wrong.ron", "(contact_s: Some(-1.0))")]);
    assert!(status(&wrong) == 2 && errors(&wrong).contains("sharp_s is -1"), "{}", errors(&wrong));
    let real = format!("{}/assets/machines/gc_ethercat.ron", env!("CARGO_MANIFEST_DIR"));
    let real = kt830(&["run", "O1002", "--machine", &real]);
    assert!(status(&real) == 2 && errors(&real).contains("kt830 bus FILE"), "{}", errors(&real));
}

/// Values of a real machine are changed on its pages, with their passwords: never by the call.
#[test]
fn b6_options_that_change_values_are_refused_on_a_real_machine() {
    let data = tempfile::tempdir().unwrap();
    let machine = format!("{}/assets/machines/gc_ethercat.ron", env!("CARGO_MANIFEST_DIR"));
    std::fs::copy(&machine, data.path().join("machine.ron")).unwrap();
    let folder = data.path().to_string_lossy().into_owned();
    // The description is gone; the data are still those of a real machine.
    let marked = tempfile::tempdir().unwrap();
    std::fs::write(marked.path().join("real-machine.txt"), "").unwrap();
    let left = marked.path().to_string_lossy().into_owned();
    for option in [["--param", "P71=1"], ["--set", "#520=1"]] {
        // Named in the call, or installed in the data folder.
        for place in [vec!["--machine", &machine], vec!["--data", &folder], vec!["--data", &left]] {
            let out = kt830(&[&place[..], &option[..]].concat());
            assert!(status(&out) == 2 && errors(&out).contains("with their passwords"), "{option:?}: {}", errors(&out));
        }
    }
    assert!(!data.path().join("retained.redb").exists(), "nothing was opened");
}

/// Nor do a simulation, a story or an import change the data of a real machine: nobody asked for a password there.
#[test]
fn b6_what_simulates_is_refused_on_the_data_of_a_real_machine() {
    let data = tempfile::tempdir().unwrap();
    let folder = data.path().to_string_lossy().into_owned();
    let table = data.path().join("x.csv").to_string_lossy().into_owned();
    std::fs::write(&table, "0, 0\n100, 0.01\n").unwrap();
    let story = data.path().join("p.story").to_string_lossy().into_owned();
    std::fs::write(&story, "param P71 55\nset #861 = 9\n").unwrap();
    // As the fitter has left it: data, and the description of the machine.
    assert_eq!(status(&kt830(&["screw", "X", &table, "--data", &folder])), 0);
    std::fs::copy(
        format!("{}/assets/machines/gc_ethercat.ron", env!("CARGO_MANIFEST_DIR")),
        data.path().join("machine.ron"),
    )
    .unwrap();
    let stored = || std::fs::read(data.path().join("retained.redb")).unwrap();
    let before = stored();
    let simulated = format!("{}/assets/machines/gc.ron", env!("CARGO_MANIFEST_DIR"));
    for words in [
        &["play", &story][..],
        &["run", "O1002"],
        &["run", "O1002", "--param", "P71=55"],
        &["run", "O1002", "--machine", &simulated],
        &["demo"],
        &["shot", "position", "--out", "/nonexistent.png"],
        &["screw", "X", &table],
        &["screw", "X", "--clear"],
        // The control itself, on a simulated machine.
        &["--machine", &simulated],
    ] {
        let out = kt830(&[words, &["--data", &folder]].concat());
        assert!(
            status(&out) == 2 && errors(&out).contains("the data of a real machine"),
            "{words:?}: {}",
            errors(&out)
        );
    }
    assert!(stored() == before, "the data are as they were");
    // To look is free.
    let shown = kt830(&["screw", "X", "--data", &folder]);
    assert!(status(&shown) == 0 && String::from_utf8_lossy(&shown.stdout).contains("100"), "{}", errors(&shown));
    let program = format!("{}/programs/O1002.NC", env!("CARGO_MANIFEST_DIR"));
    assert_eq!(status(&kt830(&["check", &program, "--data", &folder])), 0);
    assert!(stored() == before, "the data are as they were");
}

/// A program that takes long is no endless one: the time of a run is the call's.
#[test]
fn b1_a_long_program_runs_to_its_end() {
    let folder = tempfile::tempdir().unwrap();
    let program = |text: &str| {
        let path = folder.path().join("O5001.NC");
        std::fs::write(&path, text).unwrap();
        path.to_string_lossy().into_owned()
    };
    // Two dwells of 84 minutes: nothing moves for longer than the longest dwell.
    let dwells = program("G04 X5010.\nG04 X5010.\nM30\n");
    let out = kt830(&["run", &dwells, "--lang", "en"]);
    assert_eq!(status(&out), 0, "{}", errors(&out));
    let out = kt830(&["run", &dwells, "--hours", "1", "--lang", "en"]);
    assert!(status(&out) != 0 && errors(&out).contains("`run --hours N` gives it more"), "{}", errors(&out));
    let endless = program("WHILE[1EQ1]DO1\nEND1\nM30\n");
    let out = kt830(&["run", &endless, "--lang", "en"]);
    assert!(status(&out) != 0 && errors(&out).contains("a loop at its beginning"), "{}", errors(&out));
}

/// A program of more than 128 MiB is refused with its limit, before it is read.
#[test]
fn b1_a_program_that_is_too_large_is_refused_with_the_limit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("O1002.NC");
    std::fs::File::create(&path).unwrap().set_len(128 * 1024 * 1024 + 1).unwrap();
    let named = path.to_string_lossy().into_owned();
    for words in [["check", &named], ["run", &named]] {
        let out = kt830(&words);
        assert!(status(&out) != 0 && errors(&out).contains("134217728"), "{words:?}: {}", errors(&out));
    }
}

/// The operator types what he measures: a soft wheel is followed, and a slender part that was too large is told once.
#[test]
fn t3_a_program_that_is_told_the_sizes_is_qualified_with_them() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("slender.ron"), "(contact_s: Some(3.0))").unwrap();
    std::fs::write(folder.path().join("soft.ron"), "(grinding_ratio: Some(10.0))").unwrap();
    let machines = folder.path().to_string_lossy().into_owned();
    let out = kt830(&["qualify", "O1019", "--machines", &machines, "--parts", "12"]);
    let table = String::from_utf8_lossy(&out.stdout).into_owned();
    assert_eq!(status(&out), 0, "{table}");
    assert!(table.contains("36 parts: 36 good"), "{table}");
}

#[test]
fn t3_programs_are_qualified_on_other_machines() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("burns.ron"), "(burn_mm2_s: Some(0.1))").unwrap();
    let machines = folder.path().to_string_lossy().into_owned();
    let words = ["qualify", "--programs", "O1002", "--machines", &machines, "--parts", "2", "--format", "json"];
    let out = kt830(&words);
    let told: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
    let row = |at: usize, what: &str| told["rows"][at][what].clone();
    assert_eq!((row(0, "machine"), row(0, "good"), row(0, "spoilt")), ("standard".into(), 2.into(), 0.into()));
    assert_eq!((row(1, "machine"), row(1, "good"), row(1, "spoilt")), ("burns".into(), 0.into(), 1.into()));
    // The part of the set-up is burnt, and no batch follows.
    assert_eq!((status(&out), &told["silent_or_spoilt"]), (1, &1.into()));
    let out = kt830(&["qualify", "VGRIND", "--machines", &machines, "--parts", "1", "--format", "json"]);
    let told: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
    assert_eq!((&told["rows"][0]["program"], &told["rows"][0]["good"]), (&"VGRIND".into(), &1.into()), "{told}");
    assert_eq!(status(&kt830(&["qualify", "O1011"])), 2, "it makes no part");
    // Of all programs those of the folder; one that is named and not there is told before anything is ground.
    let (programs, standard) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    for entry in std::fs::read_dir("programs").unwrap().map(|entry| entry.unwrap().path()) {
        let name = entry.file_name().unwrap().to_string_lossy().into_owned();
        if name == "O1002.NC" || name.starts_with("O9") {
            std::fs::copy(&entry, programs.path().join(name)).unwrap();
        }
    }
    let (programs, standard) = (programs.path().to_string_lossy(), standard.path().to_string_lossy());
    let out = kt830(&["qualify", "--programs", &programs, "--machines", &standard, "--parts", "1"]);
    let table = String::from_utf8_lossy(&out.stdout).into_owned();
    assert_eq!(table.lines().count(), 3, "headings, O1002, sums: {table}{}", errors(&out));
    let missing = kt830(&["qualify", "O1002", "PRINTED", "--machines", &standard, "--parts", "1"]);
    assert!(status(&missing) == 2 && missing.stdout.is_empty(), "{}", errors(&missing));
    let wrap = kt830(&["qualify", "O1002", "--seed", "18446744073709551615"]);
    assert!(status(&wrap) == 2 && errors(&wrap).contains("--seed"), "{}", errors(&wrap));
    // A wrong machine is told before anything is ground, a whole machine of another kind is left out.
    std::fs::write(folder.path().join("ga.ron"), include_str!("../../assets/machines/ga.ron")).unwrap();
    let out = kt830(&["qualify", "O1002", "--machines", &machines, "--parts", "1", "--format", "json"]);
    let told: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
    assert_eq!(told["rows"].as_array().map(Vec::len), Some(2), "{told}");
    std::fs::write(folder.path().join("wrong.ron"), "(burn: Some(1.0))").unwrap();
    let wrong = kt830(&["qualify", "O1002", "--machines", &machines]);
    assert!(status(&wrong) == 2 && errors(&wrong).contains("wrong: "), "{}", errors(&wrong));
    // What would be left out without a word is refused.
    let burns = format!("{machines}/burns.ron");
    for words in [
        &["qualify", "O1002", "--machine", &burns][..],
        &["qualify", "O1002", "--data", &machines],
        &["qualify", "O1002", "--kind", "gs"],
        &["torture", "--param", "P59=10"],
        &["codes", "--machine", &burns],
        &["check", "O1002", "--machine", &burns],
    ] {
        let refused = kt830(words);
        assert!(status(&refused) == 2 && errors(&refused).contains(words[words.len() - 2]), "{}", errors(&refused));
    }
}
