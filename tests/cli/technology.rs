//! The proposals of the technology page, proved on the simulated machine: parts of three materials, whose burn limits and
//! energies stand in machine files, are ground with them without burn and to size.
//!
//! High-speed steel is none of them: O1002 seeks the part at 60 mm/min, and its first touch already burns it.

use std::path::Path;

use kt830::defs::page_meaning::PageMeaning;
use kt830::technology::{GrindingMachine, GrindingTask, GroundMaterial, MATERIALS, MountedWheel, PlungePart, propose};
use serde_json::Value;

use crate::command::kt830;

/// The part and the machine of O1002.
fn task(material: GroundMaterial) -> GrindingTask {
    GrindingTask {
        part: PlungePart {
            material,
            diameter_mm: 40.0,
            width_mm: 18.0,
            stock_mm: 0.3,
            tolerance_mm: 0.02,
            roughness_um: 0.4,
        },
        wheel: MountedWheel { diameter_mm: 600.0, width_mm: 20.0, rated_m_s: 35.0, rpm: 1_100.0 },
        machine: GrindingMachine { wheel_kw: 7.5, time_constant_s: 0.8, work_rpm: 200.0 },
    }
}

/// The removal rate at which the material burns at the workhead's 200 rpm: v_w = π·40·200/60 = 418.9 mm/s, d_e = 37.5 mm;
/// a = (7.2·37.5^(1/4)/(√418.9·(u − 6.2)))^(4/3), Q'w = a·v_w.
fn burn_mm2_s(energy_j_mm3: f64) -> f64 {
    let depth = (7.2 * 37.5_f64.powf(0.25) / (418.9_f64.sqrt() * (energy_j_mm3 - 6.2))).powf(4.0 / 3.0);
    depth * 418.9
}

/// Runs O1002 on a machine whose part is of the material.
fn run(material: GroundMaterial, values: &[(u16, f64)]) -> Value {
    let folder = tempfile::tempdir().unwrap();
    let machine =
        std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/machines/gc.ron")).unwrap();
    let machine = machine
        .replace("energy_j_mm3: 40.0", &format!("energy_j_mm3: {:.1}", material.energy_j_mm3))
        .replace("burn_mm2_s: 8.0", &format!("burn_mm2_s: {:.3}", burn_mm2_s(material.energy_j_mm3)));
    assert!(!machine.contains("burn_mm2_s: 8.0"));
    let path = folder.path().join("gc.ron");
    std::fs::write(&path, machine).unwrap();
    let path = path.to_string_lossy().into_owned();
    let sets: Vec<String> = values.iter().map(|(number, value)| format!("#{number}={value}")).collect();
    let mut words = vec!["run", "O1002", "--kind", "gc", "--machine", &path, "--format", "json"];
    sets.iter().for_each(|set| words.extend(["--set", set]));
    let out = kt830(&words);
    serde_json::from_slice(&out.stdout).unwrap_or_else(|error| panic!("{error}: {out:?}"))
}

fn burns(report: &Value) -> bool {
    report["events"].as_array().unwrap().iter().any(|event| event["kind"] == "burn")
}

#[test]
fn p5_the_proposals_grind_three_materials_to_size_without_burn() {
    let mut by_hand = Vec::new();
    for material in &MATERIALS[..3] {
        let found = propose(&task(*material)).unwrap();
        let meanings = [
            (524, PageMeaning::RoughAllowance),
            (525, PageMeaning::FinishAllowance),
            (526, PageMeaning::RoughFeed),
            (527, PageMeaning::FinishFeed),
            (528, PageMeaning::SparkOut),
        ];
        let values: Vec<_> = meanings.map(|(number, meaning)| (number, found.value_of(meaning).unwrap())).to_vec();
        let report = run(*material, &values);
        let name = material.name.en;
        assert_eq!(report["end"], "finished", "{name}: {report}");
        assert!(!burns(&report), "{name}: {values:?} {report}");
        for at in report["part"]["diameters"].as_array().unwrap() {
            // A fifth of the tolerance of 20 µm.
            assert!((at["d"].as_f64().unwrap() - 40.0).abs() < 0.004, "{name}: {at}");
        }
        // The wheel is dressed as proposed: the new one is, for Ra 0.4.
        let ra = report["part"]["roughness"][0]["ra_um"].as_f64().unwrap();
        assert!((0.15..=0.4).contains(&ra), "{name}: Ra {ra}");
        let shipped = run(*material, &[]);
        by_hand.push(burns(&shipped));
    }
    // The values that the program is shipped with burn all but the soft steel.
    assert_eq!(by_hand, [true, false, true]);
}
