//! Tests when a file that a scene names is read. The file must be regular. It must lie below the
//! scene's folder after all links are followed.
#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use etendue_scene::{ReadError, Scene, SceneError, SceneFile, read_below, read_file, resolve};
use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// A folder that contains the folder `scene`, which holds a mesh, and the folder `secret`.
fn folders() -> tempfile::TempDir {
    let top = tempfile::tempdir().unwrap();
    let at = |name: &str| top.path().join(name);
    for folder in ["scene/meshes", "secret"] {
        fs::create_dir_all(at(folder)).unwrap();
    }
    fs::write(at("scene/meshes/tri.obj"), TRIANGLE).unwrap();
    fs::write(at("secret/s.obj"), TRIANGLE).unwrap();
    fs::write(at("secret/words.obj"), "root:x:0:0:a secret\n").unwrap();
    top
}

fn resolved(mesh: &str, folder: &Path) -> Result<Scene, SceneError> {
    let text = format!(
        r#"(
            light: Rectangle(center: (0, 0, 0), size: (0.2, 0.2)),
            blockers: [Mesh(name: "blocker", center: (0, 0, 1), mesh: File("{mesh}"), scale: 0.1)],
            surfaces: [Rectangle(name: "floor", center: (0, 0, 2), size: (4, 4))],
            path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["floor"]),
            planes: [(name: "arrival", at: Before("floor"))],
            window: (x: Hann(0.5), u: Hann(0.5)),
            frequencies: (rho: (max: 8), nu: (max: 16)),
        )"#
    );
    resolve("test", SceneFile::parse(&text)?, folder, u64::MAX)
}

#[test]
fn links_do_not_lead_out_of_the_scene_s_folder() {
    let top = folders();
    let scene = top.path().join("scene");
    symlink("../secret/s.obj", scene.join("link.obj")).unwrap();
    symlink("../secret", scene.join("dirlink")).unwrap();
    symlink("../secret/words.obj", scene.join("words.obj")).unwrap();
    symlink("/proc/self/environ", scene.join("environ.obj")).unwrap();
    for mesh in ["link.obj", "dirlink/s.obj", "words.obj", "environ.obj"] {
        let told = resolved(mesh, &scene).unwrap_err().to_string();
        assert!(
            told.contains("outside of the required folder"),
            "{mesh}: {told}"
        );
        assert!(!told.contains("secret") && !told.contains('='), "{told}");
    }
    // If a link stays below the folder, or if the folder is itself a link, the file is accepted.
    symlink("meshes/tri.obj", scene.join("inside.obj")).unwrap();
    symlink("scene", top.path().join("other")).unwrap();
    for (mesh, folder) in [("inside.obj", "scene"), ("meshes/tri.obj", "other")] {
        resolved(mesh, &top.path().join(folder)).unwrap();
    }
}

#[test]
fn only_regular_files_of_a_bounded_length_are_read() {
    let top = folders();
    let scene = top.path().join("scene");
    symlink("/dev/zero", scene.join("zero.obj")).unwrap();
    fs::create_dir(scene.join("folder.obj")).unwrap();
    let pipe = scene.join("pipe.obj");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status();
    assert!(made.unwrap().success());
    for name in ["folder.obj", "pipe.obj"] {
        let error = read_below(&scene, name, 1000).unwrap_err();
        assert!(matches!(error, ReadError::NotRegular), "{name}: {error}");
    }
    let error = read_below(&scene, "zero.obj", 1000).unwrap_err();
    assert!(matches!(error, ReadError::Outside), "{error}");
    let error = read_file(Path::new("/dev/zero"), 1000).unwrap_err();
    assert!(matches!(error, ReadError::NotRegular), "{error}");
    let length = TRIANGLE.len() as u64;
    assert!(read_below(&scene, "meshes/tri.obj", length).is_ok());
    let error = read_below(&scene, "meshes/tri.obj", length - 1).unwrap_err();
    assert!(matches!(error, ReadError::TooLong { .. }), "{error}");
}

#[test]
fn the_hash_of_a_scene_takes_in_what_it_names() {
    let top = folders();
    let scene = top.path().join("scene");
    let before = resolved("meshes/tri.obj", &scene).unwrap();
    let again = resolved("meshes/tri.obj", &scene).unwrap();
    assert_eq!(before.hash(), again.hash());
    let moved = TRIANGLE.replace("v 0 1 0", "v 0 1.5 0");
    fs::write(scene.join("meshes/tri.obj"), moved).unwrap();
    let after = resolved("meshes/tri.obj", &scene).unwrap();
    assert_ne!(before.hash(), after.hash());
}
