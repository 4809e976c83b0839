//! The inputs of the fuzz targets: kept seeds, what was found once, and the repository's own files go through every
//! target again. Source: safety stance; CONTRIBUTING "Fuzzing".

#[path = "../../fuzz/targets.rs"]
mod targets;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use targets::TARGETS;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The files of a folder, without those below it; none if there is no folder.
fn files(folder: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir(root().join(folder)).into_iter().flatten();
    let mut files: Vec<_> = entries.map(|entry| entry.unwrap().path()).filter(|path| path.is_file()).collect();
    files.sort();
    files
}

#[test]
fn b1_every_kept_input_is_read_by_its_target() {
    let mut inputs = 0;
    for (name, target) in TARGETS {
        for file in files(&format!("fuzz/seeds/{name}")).into_iter().chain(files(&format!("fuzz/findings/{name}"))) {
            println!("{}", file.display());
            target(&fs::read(&file).unwrap());
            inputs += 1;
        }
    }
    assert!(inputs > 10, "{inputs} inputs");
}

#[test]
fn b1_every_target_reads_the_files_of_the_repository_and_their_beginnings() {
    let folders = ["screens", "programs", "programs/802d", "assets/parts", "assets/machines", "assets/stories"];
    for file in folders.into_iter().flat_map(files) {
        let bytes = fs::read(&file).unwrap();
        for (name, target) in TARGETS {
            println!("{name} {}", file.display());
            target(&bytes);
            target(&bytes[..bytes.len() / 2]);
        }
    }
}

#[test]
fn every_target_has_its_program() {
    let named: BTreeSet<String> = TARGETS.iter().map(|(name, _)| (*name).to_owned()).collect();
    let programs: BTreeSet<String> = files("fuzz/fuzz_targets")
        .iter()
        .map(|file| file.file_stem().unwrap().to_string_lossy().into_owned())
        .collect();
    assert_eq!(named, programs);
    let manifest = fs::read_to_string(root().join("fuzz/Cargo.toml")).unwrap();
    for name in named {
        assert!(manifest.contains(&format!("name = \"{name}\"")), "{name} is not in fuzz/Cargo.toml");
    }
}
