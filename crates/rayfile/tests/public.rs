//! Tests with public files, which are not part of this repository. The files are from
//! mctools/mcpl (`*.mcpl`, `*.mcpl.gz`) and JuliusMuschaweck/TM25RaySetTools (`*.tm25ray`). The
//! variable `ETENDUE_RAY_FILES` names a folder with these files; docs/rays.md explains how to get
//! the files.
//!
//! Each file is read and written again, and must then have the same bytes. The unpacked bytes of
//! packed files are compared. Files that their makers mark as bad are refused.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use etendue_rayfile::{Format, RayFile, convert, gz};
use std::fs;
use std::path::PathBuf;

fn is_bad(name: &str) -> bool {
    ["_bad", "crash", "truncated"]
        .iter()
        .any(|part| name.contains(part))
}

#[test]
#[ignore = "needs files of other projects, in the folder ETENDUE_RAY_FILES"]
fn public_files_have_the_same_bytes() {
    let folder = std::env::var("ETENDUE_RAY_FILES").expect("ETENDUE_RAY_FILES names a folder");
    let mut files: Vec<PathBuf> = fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().path())
        .collect();
    files.sort();
    let mut read = 0;
    for path in files {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let Some(format) = Format::of_name(&name) else {
            continue;
        };
        let bytes = fs::read(&path).unwrap();
        match RayFile::read(&bytes) {
            Ok(file) => {
                assert!(!is_bad(&name), "{name} is bad, and was read");
                let written = convert(&file, format).unwrap();
                let expected = gz::unpack(&bytes).unwrap();
                assert!(*gz::unpack(&written.bytes).unwrap() == *expected, "{name}");
                assert_eq!(file.rays().len(), file.rays().powers.len());
                read += 1;
            }
            Err(fault) => assert!(is_bad(&name), "{name}: {fault}"),
        }
    }
    assert!(read > 0, "no file");
}
