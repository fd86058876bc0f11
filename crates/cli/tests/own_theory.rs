//! Tests `etendue compare --theory`, which compares a measurement with predictions of any program.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common::{call, json, loud, stages};
use etendue_field::Complex;
use ndarray::{Array1, Array3, Array4, ArrayD, Axis};
use ndarray_npy::{NpzReader, NpzWriter};
use std::fs::File;
use std::path::Path;
use std::process::Output;

const COMPARE: &str = "compare --measured a b --out out --force";

/// The slices of both planes, as `predict --npz` writes them: [azimuth, ρ ≥ 0, ν].
fn slices(folder: &Path) -> [Array3<Complex>; 2] {
    let output = call(folder, "predict small.ron --npz --out q --force");
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let mut file = NpzReader::new(File::open(folder.join("q/predictions.npz")).unwrap()).unwrap();
    ["light", "receiver"].map(|plane| file.by_name(&format!("{plane}/slices.npy")).unwrap())
}

/// The slices with all ρ: radiance is real, so a slice at −ρ and −ν is its own conjugate.
fn whole(half: &Array3<Complex>) -> Array3<Complex> {
    let mut mirrored = half.slice_axis(Axis(1), (1..).into()).to_owned();
    mirrored.invert_axis(Axis(1));
    mirrored.invert_axis(Axis(2));
    let mirrored = mirrored.mapv(|value| value.conj());
    ndarray::concatenate![Axis(1), mirrored, *half]
}

/// Compares the measurement with arrays, in a file of their names.
fn compared(folder: &Path, arrays: &[(&str, ArrayD<Complex>)]) -> Output {
    let mut file = NpzWriter::new(File::create(folder.join("mine.npz")).unwrap());
    for (name, array) in arrays {
        file.add_array(*name, array).unwrap();
    }
    file.finish().unwrap();
    loud(folder, &format!("{COMPARE} --theory mine.npz"))
}

#[test]
fn own_predictions_are_those_of_another_program() {
    let stages = stages();
    let folder = stages.path();
    slices(folder);
    let reports = ["--predicted p", "--theory q/predictions.npz"].map(|of| {
        let output = call(folder, &format!("{COMPARE} {of}"));
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        json(&folder.join("out/summary.json"))["planes"].clone()
    });
    let number =
        |report: &serde_json::Value, at: &str| report.pointer(at).unwrap().as_f64().unwrap();
    for plane in ["0", "1"] {
        for key in [
            "p_value",
            "chi2_per_dof",
            "parameters/0/measured",
            "parameters/0/error",
        ] {
            let [a, b] = reports
                .each_ref()
                .map(|of| number(of, &format!("/{plane}/{key}")));
            assert!((a - b).abs() <= 1e-9 * a.abs(), "{key}: {a} {b}"); // sums in another order
        }
    }
    assert_eq!(reports[0][1]["parameters"].as_array().unwrap().len(), {
        reports[1][1]["parameters"].as_array().unwrap().len()
    });
}

#[test]
fn theories_that_are_wrong_are_rejected() {
    let stages = stages();
    let folder = stages.path();
    let [light, receiver] = slices(folder);
    let whole = whole(&receiver);
    // A travel of the wrong sign turns the spectrum about the axis of ρ.
    let mut turned = receiver.clone();
    turned.invert_axis(Axis(2));
    let bright = receiver.mapv(|value| value * 1.2);
    let noisy: Array4<Complex> = ndarray::stack![Axis(0), bright, receiver, &receiver * 0.8];
    for (array, code, words) in [
        (receiver.into_dyn(), 0, "pass"),
        (whole.into_dyn(), 0, "pass"),
        (turned.into_dyn(), 1, "the theory is probably at fault"),
        (bright.into_dyn(), 1, "the theory is probably at fault"),
        // Three replicates decide nothing.
        (noisy.into_dyn(), 4, "undecided"),
    ] {
        let name = if array.ndim() == 4 {
            "receiver/replicates"
        } else {
            "receiver/slices"
        };
        let output = compared(
            folder,
            &[("light/slices", light.clone().into_dyn()), (name, array)],
        );
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert_eq!(output.status.code(), Some(code), "{text} {output:?}");
        assert!(text.contains(words), "{words}: {text}");
    }
}

#[test]
fn damaged_theories_are_refused_by_name() {
    let stages = stages();
    let folder = stages.path();
    let [light, receiver] = slices(folder);
    let light = ("light/slices", light.into_dyn());
    let mut one_sided = whole(&receiver);
    one_sided.index_axis_mut(Axis(1), 0).fill(Complex::ZERO);
    let mut infinite = receiver.clone();
    infinite[[0, 0, 0]] = Complex::from(f64::NAN);
    let mut huge = receiver.clone();
    huge[[0, 0, 0]] = Complex::from(1e200);
    let short = receiver.slice_axis(Axis(2), (1..).into()).to_owned();
    let single = receiver.clone().insert_axis(Axis(0));
    let axis = Array1::from(vec![Complex::from(1.0)]);
    for (arrays, message) in [
        (
            vec![("receiver/slices", short.into_dyn())],
            "must be [3, 13, ",
        ),
        (
            vec![("receiver/slices", one_sided.into_dyn())],
            "because radiance is real",
        ),
        (vec![("receiver/slices", infinite.into_dyn())], "not finite"),
        (vec![("receiver/slices", huge.into_dyn())], "above 1e100"),
        (
            vec![("receiver/replicates", single.into_dyn())],
            "must be 3 to 1000",
        ),
        (
            vec![("receiver/slice", receiver.clone().into_dyn())],
            "allowed: PLANE/ARRAY",
        ),
        (vec![], "receiver/slices: is missing"),
        (
            vec![
                ("receiver/slices", receiver.into_dyn()),
                ("receiver/rho", axis.into_dyn()),
            ],
            "its dtype is complex128; must be float64",
        ),
    ] {
        let output = compared(
            folder,
            &[std::slice::from_ref(&light), &arrays[..]].concat(),
        );
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{message}: {text}");
        assert!(
            text.contains(message) && text.contains("mine.npz"),
            "{message}: {text}"
        );
        assert!(!folder.join("out").exists(), "{text}");
    }
}
