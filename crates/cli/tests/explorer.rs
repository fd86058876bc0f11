//! Tests that the numbers of the explorer equal the numbers of the command.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common::passes;
use etendue_explorer::{CELLS, PathPlace, SettingKey, Setup, scene};
use etendue_field::{Complex, Projection, Slices};
use ndarray::{Array2, Array3};
use ndarray_npy::NpzReader;
use std::fs::{self, File};
use std::path::Path;

/// The prediction of `etendue predict` at a plane.
fn predicted(folder: &Path, plane: PathPlace) -> (Array3<Complex>, Array2<f64>) {
    let path = folder.join(plane.name()).join("prediction.npz");
    let mut file = NpzReader::new(File::open(path).unwrap()).unwrap();
    (
        file.by_name("slices").unwrap(),
        file.by_name("projection").unwrap(),
    )
}

/// The largest difference between the slices at azimuth 0, and the largest difference
/// between the pictures. Each is divided by the largest value.
fn apart(
    (slices, field): &(Slices, Projection),
    (command, picture): &(Array3<Complex>, Array2<f64>),
) -> f64 {
    let most = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
    let [ours, theirs] =
        [&slices.half, command].map(|half| half.index_axis(ndarray::Axis(0), 0).to_owned());
    let spectrum = most(&mut (&ours - &theirs).iter().map(|s| s.norm()))
        / most(&mut theirs.iter().map(|s| s.norm()));
    let cells = most(&mut (&field.values - picture).iter().map(|x| x.abs()))
        / most(&mut picture.iter().map(|x| x.abs()));
    spectrum.max(cells)
}

#[test]
fn numbers_are_those_of_the_saved_scene() {
    let folder = tempfile::tempdir().unwrap();
    for (i, text) in [
        "position=0.083&pitch=0.071&fill=0.37&at=0.31&count=20",
        "squares=1&jitter=0.3&fill=0.6&pitch=0.2&count=9&travel=1.6",
        "glossy=1&curvature=-0.7&exponent=900&at=0.8",
    ]
    .into_iter()
    .enumerate()
    {
        let setup = Setup::of_fragment(text);
        let name = format!("scene{i}");
        fs::write(folder.path().join(format!("{name}.ron")), scene(&setup)).unwrap();
        passes(folder.path(), format!("predict {name}.ron --out {name}"));
        for plane in PathPlace::all(&setup) {
            let command = predicted(&folder.path().join(&name), plane);
            let closed = (plane.spectrum(&setup), plane.field(&setup, CELLS));
            let followed = plane.followed(&setup);
            let off = apart(followed.as_ref().unwrap_or(&closed), &command);
            // The explorer and the command compute the same sums. Their frames differ by rounding
            // errors, so their results also differ only by rounding errors.
            assert!(off < 1e-12, "{text}, {}: {off:e}", plane.name());
            if plane == PathPlace::Arrived {
                let mut moved = setup.clone();
                moved.set(SettingKey::Travel, setup.get(SettingKey::Travel) + 1e-9);
                let off = apart(
                    &(plane.spectrum(&moved), plane.field(&moved, CELLS)),
                    &command,
                );
                assert!(off > 1e-12, "a nanometre is seen: {off:e}");
            }
        }
    }
}
