//! Tests colours: a run of all channels, and options that select one.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common::{array, etendue, fails, json, passes, refused, scene};
use ndarray::Array2;
use std::fs;

/// Options of a run of a second, whose noise is below the resolution.
const SHORT_RUN: &str = "--photons 2^16 --set run.resolution=0.5";

#[test]
fn channels_share_their_photons() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let colors = scene("colors.ron");
    let colors = colors.display();
    passes(
        path,
        format!("run {colors} {SHORT_RUN} --rgb --save photons --out out"),
    );
    for command in ["report out --out page.html", "diff out out/red"] {
        let words = command.split_whitespace();
        let output = etendue().current_dir(path).args(words).output().unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains("allowed: one of out/red, "), "{message}");
    }
    // Albedos of red and blue squares in each channel, times the radiance of the light.
    for (channel, radiance, albedos) in [
        ("red", 1.0, [0.8, 0.15]),
        ("green", 0.8, [0.25, 0.3]),
        ("blue", 0.6, [0.1, 0.7]),
    ] {
        let of = |channel: &str| -> Array2<f64> {
            let file = path.join(format!("out/{channel}/leaving/photons.npy"));
            ndarray_npy::read_npy(file).unwrap()
        };
        let (first, photons) = (of("red"), of(channel));
        assert_eq!(first.dim(), photons.dim());
        let ratios = [0, 1].map(|i| radiance * albedos[i] / [0.8, 0.15][i]);
        for (one, other) in first.outer_iter().zip(photons.outer_iter()) {
            assert!((0..4).all(|i| one[i].to_bits() == other[i].to_bits()));
            let ratio = other[4] / one[4];
            // The tolerance is the rounding error of a few products.
            let is_known = ratios
                .iter()
                .any(|known| (ratio / known - 1.0).abs() < 1e-12);
            assert!(is_known, "{channel}: {ratio} is none of {ratios:?}");
        }
        let summary = json(&path.join(format!("out/{channel}/summary.json")));
        let color = summary["scene_file"]["run"]["color"].as_str().unwrap();
        assert_eq!(color.to_lowercase(), channel);
    }
    // A run of one channel is the same run.
    let line = format!("run {colors} {SHORT_RUN} --color green --save photons --out one");
    passes(path, &line);
    let slices = |of: &str| -> ndarray::Array3<f64> {
        array(&path.join(of).join("leaving/slices.npz"), "sigma")
    };
    assert_eq!(slices("one"), slices("out/green"));
    assert_ne!(slices("one"), slices("out/red"));
}

/// A page of another program is refused before the runs.
#[test]
fn a_foreign_page_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::create_dir(path.join("out")).unwrap();
    fs::write(path.join("out/report.html"), "mine").unwrap();
    let line = format!("run {} --rgb --out out", scene("colors.ron").display());
    fails(path, &line, 3);
    let files: Vec<_> = fs::read_dir(path.join("out")).unwrap().collect();
    assert_eq!(files.len(), 1, "{files:?}");
    assert_eq!(
        fs::read_to_string(path.join("out/report.html")).unwrap(),
        "mine"
    );
}

#[test]
fn colours_of_the_wrong_form_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let text = fs::read_to_string(scene("colors.ron")).unwrap();
    for (from, to, parts) in [
        (
            "radiance: (1.0, 0.8, 0.6)",
            "radiance: (1.0, 0.8)",
            &[
                "line 6",
                "light.radiance is (1.0, 0.8)",
                "three for red, green and blue",
            ] as &[&str],
        ),
        (
            "radiance: (1.0, 0.8, 0.6)",
            "radiance: (1.0, red, 0.6)",
            &["line 6", "light.radiance[1] is red"],
        ),
        (
            "albedo: (0.8, 0.25, 0.1)",
            "albedo: (0.8, -0.25, 0.1)",
            &["line 16", "albedo[1] is -0.25; allowed: 0 to 1"],
        ),
        (
            "albedo: (0.8, 0.25, 0.1)",
            "albedo: (0.8, NaN, 0.1)",
            &["line 16", "albedo[1] is NaN; allowed: 0 to 1"],
        ),
        (
            "seed: 1",
            "seed: 1, color: Pink",
            &["run.color is Pink", "Luminance, Red, Green, Blue"],
        ),
    ] {
        let bad = text.replace(from, to);
        assert_ne!(bad, text);
        fs::write(path.join("bad.ron"), bad).unwrap();
        refused(path, "run bad.ron --rgb --out out", parts);
    }
}
