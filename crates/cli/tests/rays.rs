//! Tests `etendue rays` and `--save mcpl,tm25`.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common::{SCENE, call, loud, told};
use etendue_rayfile::{Format, PowerUnit, RayFile, RaySet, Wavelengths, convert};
use std::f64::consts::PI;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// A folder with two rays as `two.tm25ray`, and half of that file as `half.tm25ray`.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let set = RaySet {
        positions: vec![[0.0, 0.25, -1.0], [1e-3, 0.0, 2.0]],
        directions: vec![[0.0, 0.6, 0.8], [-1.0, 0.0, 0.0]],
        powers: vec![0.5, 0.25],
        unit: PowerUnit::Watt,
        wavelengths: Wavelengths::One(500e-9),
    };
    let bytes = convert(&RayFile::Npy(set), Format::Tm25).unwrap().bytes;
    fs::write(folder.path().join("two.tm25ray"), &bytes).unwrap();
    fs::write(
        folder.path().join("half.tm25ray"),
        &bytes[..bytes.len() - 9],
    )
    .unwrap();
    folder
}

fn read(path: &Path) -> RaySet {
    RayFile::read(&fs::read(path).unwrap()).unwrap().rays()
}

#[test]
fn a_file_is_described_and_converted() {
    let folder = folder();
    let text = told(folder.path(), "rays two.tm25ray", 0);
    for part in [
        "IES TM-25, version 2013",
        "0.75 W",
        "x 0 to 0.001",
        "500 nm",
    ] {
        assert!(text.contains(part), "{part} not in: {text}");
    }
    for other in ["two.mcpl", "two.mcpl.gz", "two.npy", "again.tm25ray"] {
        told(folder.path(), format!("rays two.tm25ray --out {other}"), 0);
        let set = read(&folder.path().join(other));
        assert_eq!(set.powers, [0.5, 0.25], "{other}");
    }
    let same =
        ["two.tm25ray", "again.tm25ray"].map(|name| fs::read(folder.path().join(name)).unwrap());
    assert!(same[0] == same[1]);
    let text = told(folder.path(), "rays two.npy --out two.tm25ray --force", 0);
    assert!(
        text.contains("note: weights, whose unit is not stated"),
        "{text}"
    );
}

#[test]
fn files_that_are_none_are_refused() {
    let folder = folder();
    let cut = "cannot read half.tm25ray: byte 36288: 2 rays of 28 bytes";
    for (arguments, code, part) in [
        ("half.tm25ray", 2, cut),
        ("missing.mcpl", 2, "cannot read missing.mcpl"),
        (
            "two.tm25ray --out two.txt",
            2,
            ".tm25ray, .mcpl, .mcpl.gz, .npy",
        ),
        ("two.tm25ray --out half.tm25ray", 3, "--force replaces it"),
        (
            "two.tm25ray --out two.tm25ray --force",
            2,
            "read by this command",
        ),
        ("half.tm25ray --out new.mcpl", 2, "byte 36288"),
    ] {
        let output = loud(folder.path(), &format!("rays {arguments}"));
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{arguments}: {message}");
        assert!(message.contains(part), "{arguments}: {message}");
    }
    assert!(!folder.path().join("new.mcpl").exists());
}

/// A light of radiance 1 emits a flux of π times its area. The received flux is the emitted flux
/// times the form factor. The test computes the form factor without the flux in the NPY file.
#[test]
fn saved_rays_have_the_flux_of_their_plane() {
    let folder = tempfile::tempdir().unwrap();
    let plain = SCENE.replace("run: (", "run: (emission: Plain, ");
    fs::write(folder.path().join("small.ron"), plain).unwrap();
    let output = call(
        folder.path(),
        "run small.ron --save mcpl,tm25,photons --out out",
    );
    assert!(
        [Some(0), Some(4)].contains(&output.status.code()),
        "{output:?}"
    );
    let out = folder.path().join("out");
    let mcpl = read(&out.join("light/photons.mcpl"));
    let flux = PI * 0.2 * 0.173_205_080_756_887_73;
    assert_eq!((mcpl.len(), mcpl.unit), (20_000, PowerUnit::Watt));
    // The tolerance is the rounding error of a sum of 20,000 numbers.
    assert!(
        (mcpl.total_power() / flux - 1.0).abs() < 1e-11,
        "{}",
        mcpl.total_power()
    );
    for plane in ["light", "receiver"] {
        let of = |name: &str| out.join(plane).join(name);
        let [mcpl, tm25] = ["photons.mcpl", "photons.tm25ray"].map(|name| read(&of(name)));
        let file = fs::File::open(of("photons.npy")).unwrap();
        let npy: ndarray::Array2<f64> = ndarray_npy::ReadNpyExt::read_npy(file).unwrap();
        assert_eq!([mcpl.len(), tm25.len()], [npy.nrows(); 2]);
        let each = npy.rows().into_iter().map(|row| {
            let secant_squared = 1.0 + row[2] * row[2] + row[3] * row[3];
            row[4] / (secant_squared * secant_squared * 20_000.0)
        });
        let total: f64 = each.sum();
        assert!((mcpl.total_power() / total - 1.0).abs() < 1e-11, "{plane}"); // roundings
        assert!((tm25.total_power() / total - 1.0).abs() < 1e-7, "{plane}"); // f32
        let RayFile::Tm25(file) = RayFile::read(&fs::read(of("photons.tm25ray")).unwrap()).unwrap()
        else {
            panic!("no TM-25 file");
        };
        assert!(file.notes().is_empty(), "{:?}", file.notes());
    }
    // Positions are in world coordinates: the floor is at z = 2.236…, measured from the light at
    // 0.3.
    let floor = read(&out.join("receiver/photons.mcpl"));
    assert!(
        floor
            .positions
            .iter()
            .all(|p| (p[2] - 2.236_067_977_499_79).abs() < 1e-12)
    );
    for (p, d) in floor.positions.iter().zip(&floor.directions) {
        let back = (p[2] - 0.3) / d[2];
        let from = [p[0] - back * d[0], p[1] - back * d[1]];
        // The X axis of the scene is oblique, so positions are bounded by the circle around the
        // square light.
        assert!(
            (from[0] - 0.1).hypot(from[1] - 0.2) < 0.1323 + 1e-9,
            "{from:?}"
        ); // half its diagonal
    }
    // A second run on another number of threads gives the same bytes.
    let first = fs::read(out.join("receiver/photons.mcpl")).unwrap();
    call(
        folder.path(),
        "run small.ron --save mcpl --out again --threads 1",
    );
    assert!(fs::read(folder.path().join("again/receiver/photons.mcpl")).unwrap() == first);
}
