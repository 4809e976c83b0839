//! The simulated process in `--trace` of `kt830 run`: row T3.

use std::f64::consts::PI;

use crate::command::kt830;

/// Power and diameter of the wheel and load without contact of the cylindrical grinder (`assets/machines/gc.ron`), W, mm, %.
const POWER_W: f64 = 7_500.0;
const DIAMETER_MM: f64 = 600.0;
const IDLE_PERCENT: f64 = 8.0;

/// A line with its process columns.
struct Row {
    rpm: f64,
    load_percent: f64,
    tangential_n: f64,
    normal_n: f64,
    dullness: f64,
}

/// The power that the motor gives beyond idling is force times peripheral speed; the normal force is the greater one (0.4 as
/// delivered); without contact there is no force; dullness grows while the wheel cuts.
#[test]
fn t3_a_trace_of_a_run_has_forces_power_and_dullness() {
    let folder = tempfile::tempdir().unwrap();
    let trace = folder.path().join("trace.csv").to_string_lossy().into_owned();
    let out = kt830(&["run", "O1002", "--trace", &trace]);
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let text = std::fs::read_to_string(&trace).unwrap();
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |name: &str| names.iter().position(|at| *at == name).unwrap_or_else(|| panic!("{name} of {names:?}"));
    let columns = ["wheel_rpm", "load_percent", "tangential_n", "normal_n", "dullness"].map(column);
    let rows: Vec<Row> = lines
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            assert_eq!(cells.len(), names.len(), "{line}");
            let [rpm, load_percent, tangential_n, normal_n, dullness] =
                columns.map(|column| cells[column].parse::<f64>().unwrap());
            Row { rpm, load_percent, tangential_n, normal_n, dullness }
        })
        .collect();
    let cutting: Vec<&Row> = rows.iter().filter(|row| row.tangential_n > 1.0).collect();
    assert!(cutting.len() > 1_000, "{} ticks", cutting.len());
    for row in &cutting {
        let speed_m_s = PI * DIAMETER_MM / 1_000.0 * row.rpm / 60.0;
        let watts = (row.load_percent - IDLE_PERCENT) / 100.0 * POWER_W;
        // Rounded columns: 0.005 % of load are 0.4 W, 0.05 rpm less than 0.01 %; so much of the diameter may be worn, too.
        assert!(
            (watts - row.tangential_n * speed_m_s).abs() < 0.001 * watts + 0.5,
            "{watts} W, {} N",
            row.tangential_n
        );
        assert!((row.tangential_n / row.normal_n - 0.4).abs() < 0.001, "{} of {} N", row.tangential_n, row.normal_n);
    }
    // The wheel runs at its speed and touches nothing: the motor idles.
    let free: Vec<&Row> = rows.iter().filter(|row| row.normal_n <= 0.0 && row.rpm > 1_000.0).collect();
    assert!(free.len() > 1_000, "{} ticks", free.len());
    assert!(free.iter().all(|row| (row.load_percent - IDLE_PERCENT).abs() < 0.01 && row.tangential_n <= 0.0));
    let (first, last) = (&rows[0], &rows[rows.len() - 1]);
    assert!(names.ends_with(&[
        "chip_w",
        "ploughing_w",
        "sliding_w",
        "vibration_um",
        "part_kelvin",
        "head_growth_um",
        "diamond_wear_um",
        "gauge_um"
    ]));
    assert!(last.dullness > first.dullness, "{} to {}", first.dullness, last.dullness);
}

/// A fine wheel on a shaking, warming machine: the parts of the power are what the motor gives beyond idling, and what grows slowly
/// is there as well. Its gauge is not used: the column is empty.
#[test]
fn t3_a_trace_has_the_parts_of_the_power_and_what_changes_slowly() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let (trace, machine) = (file("trace.csv"), file("machine.ron"));
    let text = "(chip_j_mm3: Some(13.8), ploughing_n_mm: Some(1.0),
        vibration: Some((eccentricity_um: 160.0, stiffness_n_um: 50.0, chatter_um: 0.1, chatter_growth: 1.0, natural_hz: 100.0)),
        thermal: Some((growth_um: 10.0, time_constant_s: 600.0)),
        part_heat: Some((heat_share: 0.3, cooling_w_m2_k: 5000.0)))";
    std::fs::write(&machine, text).unwrap();
    let out = kt830(&["run", "O1002", "--machine", &machine, "--trace", &trace]);
    let told = String::from_utf8_lossy(&out.stdout).into_owned();
    assert!(told.contains("waviness"), "{told}");
    let text = std::fs::read_to_string(&trace).unwrap();
    let names: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    let column = |name: &str| names.iter().position(|at| *at == name).unwrap_or_else(|| panic!("{name} of {names:?}"));
    let rows: Vec<Vec<&str>> = text.lines().skip(1).map(|line| line.split(',').collect()).collect();
    let value = |row: &[&str], name: &str| row[column(name)].parse::<f64>().unwrap();
    let mut cuts = 0;
    for row in &rows {
        let of = |name: &str| value(row, name);
        let parts = of("chip_w") + of("ploughing_w") + of("sliding_w");
        let motor = (of("load_percent") - IDLE_PERCENT) / 100.0 * POWER_W;
        if parts > 1.0 {
            cuts += 1;
            // Rounded: 0.005 % of load are 0.4 W, three parts 0.15 W.
            assert!((parts - motor).abs() < 0.6, "{parts} {motor}");
        }
    }
    assert!(cuts > 1_000, "{cuts}");
    let most = |name: &str| rows.iter().map(|row| value(row, name)).fold(0.0, f64::max);
    // P73, 1100 rpm: 0.547 µm (see `io/sim/vibration.rs`), and at least 0.1 µm of chatter while it cuts.
    assert!((0.6..1.0).contains(&most("vibration_um")), "{}", most("vibration_um"));
    assert!(most("part_kelvin") > 1.0 && most("part_kelvin") < 60.0, "{}", most("part_kelvin"));
    let seconds = value(&rows[rows.len() - 1], "seconds");
    let growth = value(&rows[rows.len() - 1], "head_growth_um");
    assert!((growth - 10.0 * (1.0 - (-seconds / 600.0).exp())).abs() < 0.05, "{growth} after {seconds} s");
    assert!(rows.iter().all(|row| row[column("gauge_um")].is_empty()));
}
