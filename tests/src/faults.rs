//! Faults planted in the prediction or in the photons, which a comparison must reject.

mod holes;
mod power;
mod smallest;

use crate::report::Bound::{AtLeast, Below};
use crate::report::{Check, ReportSection, Row};
use crate::scenes::{fig9b, measured, named, traced};
use etendue_compare::{Residuals, TESTS, radial, sidak};
use etendue_field::{
    Complex, Crossing, Ledger, Mask, PhotonSource, Rectangle, Shape, Slices, VirtualPlane,
};
use etendue_predict::chain;
use etendue_scene::Scene;
use etendue_spectrum::Measurement;
use etendue_theory::{Chain, Model, Operator, Parameter};
use etendue_trace::Tracer;
pub(crate) use power::power;
pub(crate) use smallest::smallest;

/// Returns the section on all faults planted in the main scene; its first row is the comparison
/// without a fault.
pub(crate) fn planted(photons: u64, seed: u64) -> ReportSection {
    let scene = fig9b(photons, seed);
    let tracer = Tracer::new(&scene);
    let sound = measured(&scene, &tracer);
    let no_jacobian = measured(
        &scene,
        &TamperedBlock {
            tracer: &tracer,
            crossing: without_jacobian,
        },
    );
    let losing = measured(
        &scene,
        &TamperedBlock {
            tracer: &tracer,
            crossing: losing_one_in_a_hundred,
        },
    );

    let mut rows = vec![row(&scene, &sound, NONE, &unchanged)];
    for (name, predict) in predictions() {
        rows.push(row(&scene, &sound, name, predict.as_ref()));
    }
    rows.push(row(
        &scene,
        &no_jacobian,
        "photons without (1 + u² + v²)²",
        &unchanged,
    ));
    rows.push(row(&scene, &losing, "1 % of photons lost", &unchanged));

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

/// Returns the section on faults that the main scene cannot reveal, each planted in a scene that
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
            let tracer = Tracer::new(&scene);
            let crossing = |_: usize, mut crossing: Crossing| {
                crossing.weight /= crossing.ray.secant_squared().sqrt();
                Some(crossing)
            };
            let flat = measured(
                &scene,
                &TamperedBlock {
                    tracer: &tracer,
                    crossing,
                },
            );
            found.push(row(
                &scene,
                &flat,
                "point light without √(1 + u² + v²)",
                &unchanged,
            ));
        }
        let faults = (found.len() - 1) as f64;
        let reason = "a scene without faults would show nothing";
        checks.push(Check::new("faults", faults, AtLeast(1.0), reason));
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

type PlantedFaults = Vec<(&'static str, Box<Predict>)>;

/// Returns a function that predicts slices by a modified chain. The function returns `None` if the
/// modification has no effect.
fn chained(change: impl Fn(&mut Chain) + 'static) -> Box<Predict> {
    Box::new(move |scene, plane| {
        let mut tampered = chain(scene, plane);
        change(&mut tampered);
        (tampered != chain(scene, plane)).then(|| slices(&tampered, plane))
    })
}

fn elsewhere() -> Vec<(&'static str, PlantedFaults)> {
    let scaled = |which: fn(&Parameter) -> bool, factor: f64| {
        chained(move |c: &mut Chain| {
            if let Some(p) = c.parameters().into_iter().find(which) {
                scale(c, p, factor);
            }
        })
    };
    let without_cosine = || {
        chained(|c: &mut Chain| {
            c.operators
                .retain(|o| !matches!(o, Operator::Cosine { .. }));
        })
    };
    vec![
        (
            "two_layers",
            vec![
                (
                    "first layer 1 % too far away",
                    chained(|c| move_layer(c, 0, 0.006)),
                ),
                (
                    "second layer 1 % too far away",
                    chained(|c| move_layer(c, 1, 0.014)),
                ),
            ],
        ),
        (
            "grating",
            vec![
                (
                    "phase of the grating + 0.05",
                    chained(|c| {
                        let phase = |p: &Parameter| matches!(p, Parameter::GratingPhase(_));
                        if let Some(p) = c.parameters().into_iter().find(phase) {
                            let value = c.value(p).expect("its own");
                            *c = c.with(p, value + 0.05).expect("its own");
                        }
                    }),
                ),
                (
                    "frequency of the grating + 1 %",
                    scaled(|p| matches!(p, Parameter::GratingFrequency(_)), 1.01),
                ),
            ],
        ),
        (
            "fig7_one",
            vec![(
                "missing half-plane",
                chained(|c| {
                    for operator in &mut c.operators {
                        if let Operator::Visibility {
                            mask: Mask::Opaque { half_planes, .. },
                            ..
                        } = operator
                        {
                            half_planes.clear();
                        }
                    }
                }),
            )],
        ),
        (
            "diffuse",
            vec![
                ("missing G", without_cosine()),
                (
                    "missing 1/π in the reflection",
                    chained(|c| {
                        for operator in &mut c.operators {
                            if let Operator::Diffuse { albedo, .. } = operator {
                                *albedo *= std::f64::consts::PI;
                            }
                        }
                    }),
                ),
            ],
        ),
        ("fig4_point", Vec::new()),
        (
            "fig4_spot",
            vec![(
                "exponent of the spot + 5 %",
                scaled(|p| matches!(p, Parameter::SpotExponent), 1.05),
            )],
        ),
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

/// Returns the p-value of the slices of a plane, and that of its radial spectrum.
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

/// Returns the row of a fault that has the given p-values at each plane: of the slices, and of the
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
        _ => Check::new("rejected", least, Below(level), "a fault is planted"),
    };
    let shown = [0, 1].map(|kind| joined(p_values.iter().map(|p| p[kind])));
    let outcome = if least < level {
        "rejected"
    } else {
        "accepted"
    };
    let [slices, power] = shown;
    let cells = vec![name.to_owned(), slices, power, outcome.to_owned()];
    Row::new(cells, vec![check])
}

fn joined(p_values: impl Iterator<Item = Option<f64>>) -> String {
    let show = |p: Option<f64>| p.map_or("–".to_owned(), |p| format!("{p:.5}"));
    p_values.map(show).collect::<Vec<_>>().join(", ")
}

fn unchanged(scene: &Scene, plane: &VirtualPlane) -> Option<Slices> {
    Some(slices(&chain(scene, plane), plane))
}

fn slices(chain: &Chain, plane: &VirtualPlane) -> Slices {
    etendue_theory::slices(chain, &plane.window, &plane.grid)
}

/// Faults that are planted in the prediction.
fn predictions() -> Vec<(&'static str, Box<Predict>)> {
    vec![
        ("first travel + 1 %", chained(|c| scale_travel(c, 0, 1.01))),
        ("first travel − 1 %", chained(|c| scale_travel(c, 0, 0.99))),
        ("second travel + 1 %", chained(|c| scale_travel(c, 1, 1.01))),
        ("second travel − 1 %", chained(|c| scale_travel(c, 1, 0.99))),
        (
            "wrong sign of the shear",
            chained(|c| (0..2).for_each(|n| scale_travel(c, n, -1.0))),
        ),
        (
            "second travel missing",
            chained(|c| scale_travel(c, 1, 1e-9)),
        ),
        (
            "x and y of the blockers swapped",
            chained(|c| {
                each_rectangle(c, |r| r.center.swap(0, 1));
            }),
        ),
        (
            "wrong sign of the Fourier transform",
            Box::new(|scene, plane| {
                let mut slices = unchanged(scene, plane)?;
                slices.half.mapv_inplace(|s| s.conj());
                Some(slices)
            }),
        ),
        (
            "all blockers missing",
            chained(|c| each_layer(c, |shapes| shapes.clear())),
        ),
        (
            "central blocker missing",
            chained(|c| {
                let radius = |s: &Shape| {
                    let [x, y] = s.bounds().center;
                    x.hypot(y)
                };
                let mut nearest = f64::INFINITY;
                each_layer(c, |shapes| {
                    nearest = shapes.iter().map(radius).fold(nearest, f64::min);
                });
                each_layer(c, |shapes| shapes.retain(|s| radius(s) > nearest));
            }),
        ),
        (
            "shift of half a bin of 64 along x",
            Box::new(|scene, plane| {
                let shift = plane.window.x.half_width() / 64.0;
                Some(shifted(unchanged(scene, plane)?, shift))
            }),
        ),
        (
            "window 1 % too wide in x and y",
            Box::new(|scene, plane| {
                let mut wide = plane.clone();
                wide.window.x = wide.window.x.scaled(1.01);
                wide.window.y = wide.window.y.scaled(1.01);
                unchanged(scene, &wide)
            }),
        ),
        (
            "window 1 % too wide in u and v",
            Box::new(|scene, plane| {
                let mut wide = plane.clone();
                wide.window.u = wide.window.u.scaled(1.01);
                wide.window.v = wide.window.v.scaled(1.01);
                unchanged(scene, &wide)
            }),
        ),
    ]
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

fn each_layer(chain: &mut Chain, mut change: impl FnMut(&mut Vec<Shape>)) {
    for operator in &mut chain.operators {
        if let Operator::Visibility {
            mask: Mask::Opaque { shapes, .. },
            ..
        } = operator
        {
            change(shapes);
        }
    }
}

fn each_rectangle(chain: &mut Chain, change: impl Fn(&mut Rectangle)) {
    each_layer(chain, |shapes| {
        for shape in shapes {
            if let Shape::Rectangle(rectangle) = shape {
                change(rectangle);
            }
        }
    });
}

/// Returns the slices of the field shifted by `shift` along x.
fn shifted(mut slices: Slices, shift: f64) -> Slices {
    let grid = slices.grid;
    for ((k, m, _), value) in slices.half.indexed_iter_mut() {
        let [omega_x, ..] = grid.frequency(k, m as f64 * grid.rho.spacing, 0.0);
        *value *= Complex::cis(-std::f64::consts::TAU * omega_x * shift);
    }
    slices
}

/// A tracer that modifies crossings before they are recorded. The function that modifies a crossing
/// also receives the index of this crossing in its block.
struct TamperedBlock<'a, F> {
    tracer: &'a Tracer,
    crossing: F,
}

fn without_jacobian(_: usize, mut crossing: Crossing) -> Option<Crossing> {
    crossing.weight /= crossing.ray.secant_squared().powi(2);
    Some(crossing)
}

fn losing_one_in_a_hundred(number: usize, crossing: Crossing) -> Option<Crossing> {
    (!number.is_multiple_of(100)).then_some(crossing)
}

impl<F: Fn(usize, Crossing) -> Option<Crossing> + Sync> PhotonSource for TamperedBlock<'_, F> {
    fn emitted(&self, batch: u32) -> u64 {
        self.tracer.emitted(batch)
    }

    fn emit(
        &self,
        batch: u32,
        record: &mut dyn FnMut(usize, &[Crossing]),
        progress: &dyn Fn(u64),
    ) -> Ledger {
        let mut tampered = |plane: usize, crossings: &[Crossing]| {
            let numbered = crossings.iter().enumerate();
            let kept: Vec<Crossing> = numbered
                .filter_map(|(i, c)| (self.crossing)(i, *c))
                .collect();
            record(plane, &kept);
        };
        self.tracer.emit(batch, &mut tampered, progress)
    }
}
