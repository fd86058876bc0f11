//! Writes a scene for Mitsuba 3: `cargo run --release -p etendue-export --example mitsuba -- SCENE.ron FOLDER`.

use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [scene, folder] = arguments.as_slice() else {
        return Err("usage: mitsuba SCENE.ron FOLDER".into());
    };
    let path = Path::new(scene);
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let file = etendue_scene::SceneFile::parse(&std::fs::read_to_string(path)?)?;
    let beside = path.parent().unwrap_or(Path::new("."));
    let scene = etendue_scene::resolve(&name, file, beside, u64::MAX)?;
    std::fs::create_dir_all(folder)?;
    for (name, bytes) in etendue_export::mitsuba(&scene)?.files {
        std::fs::write(Path::new(folder).join(name), bytes)?;
    }
    Ok(())
}
