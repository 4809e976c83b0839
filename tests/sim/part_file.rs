//! Part files: those built in, and those refused.

use kt830::defs::program_number;
use kt830::io::sim::PartFile;

fn text_of(program: u32) -> String {
    std::fs::read_to_string(format!("{}/assets/parts/O{program}.ron", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

#[test]
fn p4_the_parts_built_in_can_be_read() {
    let numbered = (1_001..=1_020).map(|number| format!("O{number}"));
    for program in numbered.chain(["VGRIND", "VBORE", "PRINTED"].map(str::to_owned)) {
        let part = PartFile::builtin(program_number::from_name(&program)).unwrap().unwrap();
        assert!(!part.surfaces.is_empty(), "{program}");
    }
    assert!(PartFile::builtin_named("SHAFT").unwrap().unwrap().bar.is_some());
    assert_eq!(PartFile::builtin(1021), Ok(None));
}

#[test]
fn p4_a_surface_that_the_kind_of_machine_cannot_grind_is_refused() {
    let part = text_of(1007).replacen("kind: Gs", "kind: Ga", 1);
    let said = PartFile::parse(&part).unwrap_err().to_string();
    assert_eq!(said, "surface 1: the part's kind of machine cannot grind it");
}

#[test]
fn p4_a_plane_has_no_more_cells_than_are_allowed() {
    let part = text_of(1007).replacen("cell: 1.0", "cell: 0.01", 1);
    let said = PartFile::parse(&part).unwrap_err().to_string();
    // 200 · 60 mm at 0.01 mm.
    assert!(said.starts_with("surface 1: cells is 120000000"), "{said}");
}

#[test]
fn p4_a_part_without_length_is_refused_with_its_surface() {
    let part = text_of(1002).replacen("z_to: 48.0", "z_to: 30.0", 1);
    let said = PartFile::parse(&part).unwrap_err().to_string();
    assert!(said.starts_with("surface 1: cells is 0"), "{said}");
}
