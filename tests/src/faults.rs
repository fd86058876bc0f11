//! Faults planted in the prediction or in the photons, which a comparison must reject.

mod holes;
mod power;
mod smallest;

use crate::report::Bound::{AtLeast, Below};
use crate::report::{Check, ReportSection, Row, number, word};
use crate::scenes::{fig9b, named, tampered, traced};
use etendue_compare::{Residuals, TESTS, Verdict, radial, sidak};
use etendue_field::{Complex, Crossing, HalfPlane, Mask, Rectangle, Shape, Slices, VirtualPlane};
use etendue_predict::chain;
use etendue_scene::Scene;
use etendue_spectrum::Measurement;
use etendue_theory::{Chain, Model, Operator, Parameter};
pub(crate) use power::power;
pub(crate) use smallest::smallest;

/// The section on all faults planted in the main scene; its first row is the comparison
/// without a fault.
pub(crate) fn planted(photons: u64, seed: u64) -> ReportSection {
    let scene = fig9b(photons, seed);
    let sound = traced(&scene);
    let mut rows = vec![row(&scene, &sound, NONE, &unchanged)];
    for (name, predict) in predictions() {
        rows.push(row(&scene, &sound, name, predict.as_ref()));
    }
    for (name, photons) in [
        (
            "photons without (1 + u² + v²)²",
            tampered(&scene, without_jacobian),
        ),
        (
            "1 % of photons lost",
            tampered(&scene, losing_one_in_a_hundred),
        ),
    ] {
        rows.push(row(&scene, &photons, name, &unchanged));
    }
    ReportSection::new(
        format!("Planted faults at {:.0e} photons", photons as f64),
        "Each fault is planted in the prediction or in the photons, and every plane is compared \
         again. The second column has the p-values of the planes in order, and the third column \
         those of their radial spectra. A dash stands for a plane that the fault does not change, \
         and the smallest possible p is 0.00005. Required: the run is rejected with every fault, \
         and accepted without a fault.",
        "fault | p of each plane | p of its power | run is",
        rows,
    )
}

/// The section on faults that the main scene cannot reveal, each planted in a scene that
/// reveals it.
pub(crate) fn planted_elsewhere(photons: u64, seed: u64) -> ReportSection {
    let mut rows = Vec::new();
    let mut checks = Vec::new();
    for (name, faults) in elsewhere() {
        let scene = named(name, Some(photons), Some(seed));
        let sound = traced(&scene);
        let mut found = vec![row(&scene, &sound, NONE, &unchanged)];
        for (fault, predict) in faults {
            found.push(row(&scene, &sound, fault, predict.as_ref()));
        }
        if name == "fig4_point" {
            let flat = tampered(&scene, |_, mut crossing| {
                crossing.weight /= crossing.ray.secant_squared().sqrt();
                Some(crossing)
            });
            let fault = "point light without √(1 + u² + v²)";
            found.push(row(&scene, &flat, fault, &unchanged));
        }
        let faults = (found.len() - 1) as f64;
        let reason = "a scene without faults would show nothing";
        checks.push(Check::new("faults", faults, AtLeast(1.0)).because(reason));
        rows.extend(of_scene(name, found));
    }
    rows.extend(of_scene(
        holes::SCENE,
        holes::rows(&named(holes::SCENE, Some(photons), Some(seed))),
    ));
    ReportSection::new(
        format!(
            "Faults planted in other scenes at {:.0e} photons",
            photons as f64
        ),
        "Each of these faults is planted in a scene that can reveal it. The third column has the \
         p-values of the planes in order, and a dash stands for a plane that the fault does not \
         change. Required: the run is rejected with every fault, and accepted without a fault.",
        "scene | fault | p of each plane | p of its power | run is",
        rows,
    )
    .with_checks(checks)
}

/// Puts the name of a scene before its rows.
fn of_scene(name: &'static str, rows: Vec<Row>) -> impl Iterator<Item = Row> {
    rows.into_iter().map(move |mut row| {
        row.cells.insert(0, name.to_owned());
        row
    })
}

/// The name of a fault, and the prediction with this fault.
type PredictionFault = (&'static str, Box<Predict>);

/// A function that predicts slices by a modified chain. The function returns `None` if the
/// modification has no effect.
fn chained(change: impl Fn(&mut Chain) + 'static) -> Box<Predict> {
    Box::new(move |scene, plane| {
        let mut tampered = chain(scene, plane);
        change(&mut tampered);
        (tampered != chain(scene, plane)).then(|| slices(&tampered, plane))
    })
}

/// A fault of the chain.
fn fault(name: &'static str, change: impl Fn(&mut Chain) + 'static) -> PredictionFault {
    (name, chained(change))
}

/// A fault of a parameter, which is multiplied by a factor.
fn scaled(name: &'static str, which: fn(&Parameter) -> bool, factor: f64) -> PredictionFault {
    fault(name, move |c| {
        if let Some(p) = c.parameters().into_iter().find(which) {
            scale(c, p, factor);
        }
    })
}

fn elsewhere() -> Vec<(&'static str, Vec<PredictionFault>)> {
    let is_frequency = |p: &Parameter| matches!(p, Parameter::GratingFrequency(_));
    let is_exponent = |p: &Parameter| matches!(p, Parameter::SpotExponent);
    let layers = vec![
        fault("first layer 1 % too far away", |c| move_layer(c, 0, 0.006)),
        fault("second layer 1 % too far away", |c| move_layer(c, 1, 0.014)),
    ];
    let grating = vec![
        fault("phase of the grating + 0.05", |c| {
            let phase = |p: &Parameter| matches!(p, Parameter::GratingPhase(_));
            if let Some(p) = c.parameters().into_iter().find(phase) {
                let value = c.value(p).expect("its own");
                *c = c.with(p, value + 0.05).expect("its own");
            }
        }),
        scaled("frequency of the grating + 1 %", is_frequency, 1.01),
    ];
    let half_plane = fault("missing half-plane", |c| {
        each_layer(c, |_, half_planes| half_planes.clear());
    });
    let diffuse = vec![
        fault("missing G", |c| {
            c.operators
                .retain(|o| !matches!(o, Operator::Cosine { .. }));
        }),
        fault("missing 1/π in the reflection", |c| {
            for operator in &mut c.operators {
                if let Operator::Diffuse { albedo, .. } = operator {
                    *albedo *= std::f64::consts::PI;
                }
            }
        }),
    ];
    let spot = scaled("exponent of the spot + 5 %", is_exponent, 1.05);
    vec![
        ("two_layers", layers),
        ("grating", grating),
        ("fig7_one", vec![half_plane]),
        ("diffuse", diffuse),
        ("fig4_point", Vec::new()),
        ("fig4_spot", vec![spot]),
    ]
}

/// Moves the layer with index `nth`, and no other layer, away from the light by `by` metres.
fn move_layer(chain: &mut Chain, nth: usize, by: f64) {
    let is_layer = |o: &Operator| matches!(o, Operator::Visibility { .. });
    let places: Vec<usize> = (0..chain.operators.len())
        .filter(|i| is_layer(&chain.operators[*i]))
        .collect();
    let Some(&at) = places.get(nth) else {
        return;
    };
    for (i, by) in [(at.wrapping_sub(1), by), (at + 1, -by)] {
        if let Some(Operator::Travel { distance, .. }) = chain.operators.get_mut(i) {
            *distance += by;
        }
    }
}

/// The name of the table row without a planted fault.
const NONE: &str = "none";

/// A function that predicts the slices of a plane, or `None` if its fault has no effect.
type Predict = dyn Fn(&Scene, &VirtualPlane) -> Option<Slices>;

fn row(scene: &Scene, measurement: &Measurement, name: &'static str, predict: &Predict) -> Row {
    let p_values = |(i, plane): (usize, &VirtualPlane)| {
        let prediction = predict(scene, plane);
        prediction.map_or([None; 2], |prediction| {
            p_values(scene, measurement, (i, &prediction, &[]))
        })
    };
    let all: Vec<[Option<f64>; 2]> = scene.planes.iter().enumerate().map(p_values).collect();
    judged(scene, name, &all)
}

/// The p-value of the slices of a plane, and that of its radial spectrum.
fn p_values(
    scene: &Scene,
    measurement: &Measurement,
    (index, prediction, replicates): (usize, &Slices, &[Slices]),
) -> [Option<f64>; 2] {
    let residuals = Residuals::between(measurement, index, prediction, replicates);
    let seed = scene.run.seed;
    let power = radial(measurement, index, prediction, replicates, seed);
    [residuals.p_value(seed), power.p_value]
}

/// The row of a fault that has the given p-values at each plane: of the slices, and of the
/// radial spectrum.
fn judged(scene: &Scene, name: &'static str, p_values: &[[Option<f64>; 2]]) -> Row {
    let level = sidak(scene.run.alpha, TESTS * scene.planes.len());
    let least = p_values
        .as_flattened()
        .iter()
        .flatten()
        .copied()
        .fold(f64::INFINITY, f64::min);
    let check = match name {
        NONE => Check::p("accepted", Some(least), level),
        _ => Check::new("rejected", least, Below(level)).because("a fault is planted"),
    };
    let joined = |kind: usize| {
        let shown: Vec<String> = p_values.iter().map(|p| number(p[kind])).collect();
        shown.join(", ")
    };
    let [slices, power] = [0, 1].map(joined);
    let outcome = word(if least < level {
        Verdict::Fail
    } else {
        Verdict::Pass
    });
    let cells = vec![name.to_owned(), slices, power, outcome.to_owned()];
    Row::new(cells, vec![check])
}

fn unchanged(scene: &Scene, plane: &VirtualPlane) -> Option<Slices> {
    Some(slices(&chain(scene, plane), plane))
}

fn slices(chain: &Chain, plane: &VirtualPlane) -> Slices {
    etendue_theory::slices(chain, &plane.window, &plane.grid)
}

/// Faults that are planted in the prediction.
fn predictions() -> Vec<PredictionFault> {
    vec![
        fault("first travel + 1 %", |c| scale_travel(c, 0, 1.01)),
        fault("first travel − 1 %", |c| scale_travel(c, 0, 0.99)),
        fault("second travel + 1 %", |c| scale_travel(c, 1, 1.01)),
        fault("second travel − 1 %", |c| scale_travel(c, 1, 0.99)),
        fault("wrong sign of the shear", |c| {
            (0..2).for_each(|n| scale_travel(c, n, -1.0));
        }),
        fault("second travel missing", |c| scale_travel(c, 1, 1e-9)),
        fault("x and y of the blockers swapped", |c| {
            each_rectangle(c, |r| r.center.swap(0, 1));
        }),
        (
            "wrong sign of the Fourier transform",
            Box::new(|scene, plane| {
                let mut slices = unchanged(scene, plane)?;
                slices.half.mapv_inplace(|s| s.conj());
                Some(slices)
            }),
        ),
        fault("all blockers missing", |c| {
            each_layer(c, |shapes, _| shapes.clear());
        }),
        fault("central blocker missing", |c| {
            let radius = |s: &Shape| {
                let [x, y] = s.bounds().center;
                x.hypot(y)
            };
            let mut nearest = f64::INFINITY;
            each_layer(c, |shapes, _| {
                nearest = shapes.iter().map(radius).fold(nearest, f64::min);
            });
            each_layer(c, |shapes, _| shapes.retain(|s| radius(s) > nearest));
        }),
        ("shift of half a bin of 64 along x", moved(1.0 / 64.0)),
        ("window 1 % too wide in x and y", widened(0.01, 0.0)),
        ("window 1 % too wide in u and v", widened(0.0, 0.01)),
    ]
}

/// A function that predicts slices of the field shifted along x by a share of the window's
/// half-width.
fn moved(share: f64) -> Box<Predict> {
    Box::new(move |scene, plane| {
        let shift = plane.window.x.half_width() * share;
        Some(shifted(unchanged(scene, plane)?, shift))
    })
}

/// A function that predicts slices with windows that are wider than the windows of the
/// scene by the given fractions.
fn widened(space: f64, slope: f64) -> Box<Predict> {
    Box::new(move |scene, plane| {
        let mut wide = plane.clone();
        for profile in [&mut wide.window.x, &mut wide.window.y] {
            *profile = profile.scaled(1.0 + space);
        }
        for profile in [&mut wide.window.u, &mut wide.window.v] {
            *profile = profile.scaled(1.0 + slope);
        }
        unchanged(scene, &wide)
    })
}

/// Multiplies a parameter of a chain by a factor.
fn scale(chain: &mut Chain, parameter: Parameter, factor: f64) {
    let value = chain.value(parameter).expect("a parameter of the chain");
    *chain = chain.with(parameter, factor * value).expect("the same");
}

/// Multiplies the distance of the travel step with index `nth`, if the chain has such a step.
fn scale_travel(chain: &mut Chain, nth: usize, factor: f64) {
    let is_travel = |p: &Parameter| matches!(p, Parameter::Travel(_));
    if let Some(travel) = chain.parameters().into_iter().filter(is_travel).nth(nth) {
        scale(chain, travel, factor);
    }
}

/// Changes the shapes and half-planes of each opaque mask.
fn each_layer(chain: &mut Chain, mut change: impl FnMut(&mut Vec<Shape>, &mut Vec<HalfPlane>)) {
    for operator in &mut chain.operators {
        if let Operator::Visibility {
            mask: Mask::Opaque {
                shapes,
                half_planes,
            },
            ..
        } = operator
        {
            change(shapes, half_planes);
        }
    }
}

fn each_rectangle(chain: &mut Chain, change: impl Fn(&mut Rectangle)) {
    each_layer(chain, |shapes, _| {
        for shape in shapes {
            if let Shape::Rectangle(rectangle) = shape {
                change(rectangle);
            }
        }
    });
}

/// The slices of the field shifted by `shift` along x.
fn shifted(mut slices: Slices, shift: f64) -> Slices {
    let grid = slices.grid;
    for ((k, m, _), value) in slices.half.indexed_iter_mut() {
        let [omega_x, ..] = grid.frequency(k, m as f64 * grid.rho.spacing, 0.0);
        *value *= Complex::cis(-std::f64::consts::TAU * omega_x * shift);
    }
    slices
}

fn without_jacobian(_: usize, mut crossing: Crossing) -> Option<Crossing> {
    crossing.weight /= crossing.ray.secant_squared().powi(2);
    Some(crossing)
}

fn losing_one_in_a_hundred(number: usize, crossing: Crossing) -> Option<Crossing> {
    (!number.is_multiple_of(100)).then_some(crossing)
}
