//! Faults planted in the prediction or in the photons: a comparison is judged by what it rejects.

use crate::report::Section;
use crate::scenes::{fig9b, measured};
use etendue_compare::{Residuals, chain, sidak};
use etendue_field::{Complex, Crossing, Ledger, PhotonSource, Slices, VirtualPlane};
use etendue_scene::Scene;
use etendue_spectrum::Measurement;
use etendue_theory::{Chain, Operator, Parameter};
use etendue_trace::Tracer;

/// All planted faults at one number of photons; the first row is the scene without a fault.
pub(crate) fn planted(photons: u64, seed: u64) -> Section {
    let scene = fig9b(photons, seed);
    let tracer = Tracer::new(&scene);
    let sound = measured(&scene, &tracer);
    let no_jacobian = measured(
        &scene,
        &Tampered {
            tracer: &tracer,
            crossing: without_jacobian,
        },
    );
    let losing = measured(
        &scene,
        &Tampered {
            tracer: &tracer,
            crossing: losing_one_in_a_hundred,
        },
    );

    let mut rows = vec![row(&scene, &sound, "none", &unchanged)];
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

    let rejected: Vec<bool> = rows.iter().map(|row| row.rejected).collect();
    let mut header = vec!["fault"];
    header.extend([
        "p at light",
        "before blockers",
        "after blockers",
        "receiver",
        "run",
    ]);
    Section {
        title: format!("Planted faults at {:.0e} photons", photons as f64),
        text: "Required: the run is rejected for every fault, and only then. p-values are not below 0.00005; \
               a dash is a plane the fault does not touch."
            .to_owned(),
        header,
        passed: !rejected[0] && rejected[1..].iter().all(|r| *r),
        rows: rows.into_iter().map(Row::cells).collect(),
    }
}

struct Row {
    name: &'static str,
    p_values: Vec<Option<f64>>,
    rejected: bool,
}

impl Row {
    fn cells(self) -> Vec<String> {
        let show = |p: &Option<f64>| p.map_or("–".to_owned(), |p| format!("{p:.5}"));
        let outcome = if self.rejected {
            "rejected"
        } else {
            "accepted"
        };
        std::iter::once(self.name.to_owned())
            .chain(self.p_values.iter().map(show))
            .chain(std::iter::once(outcome.to_owned()))
            .collect()
    }
}

/// The slices predicted for a plane; `None` where the fault changes nothing.
type Predict = dyn Fn(&Scene, &VirtualPlane) -> Option<Slices>;

fn row(scene: &Scene, measurement: &Measurement, name: &'static str, predict: &Predict) -> Row {
    let p_value = |(i, plane): (usize, &VirtualPlane)| {
        let prediction = predict(scene, plane)?;
        Residuals::new(measurement, i, &prediction).p_value(scene.run.seed)
    };
    let p_values: Vec<Option<f64>> = scene.planes.iter().enumerate().map(p_value).collect();
    let level = sidak(scene.run.alpha, scene.planes.len());
    Row {
        name,
        rejected: p_values.iter().flatten().any(|p| *p < level),
        p_values,
    }
}

fn unchanged(scene: &Scene, plane: &VirtualPlane) -> Option<Slices> {
    Some(slices(&chain(scene, plane), plane))
}

fn slices(chain: &Chain, plane: &VirtualPlane) -> Slices {
    etendue_theory::slices(chain, &plane.window, &plane.grid)
}

/// Faults of the prediction.
fn predictions() -> Vec<(&'static str, Box<Predict>)> {
    let chained = |change: fn(&mut Chain)| -> Box<Predict> {
        Box::new(move |scene, plane| {
            let mut tampered = chain(scene, plane);
            change(&mut tampered);
            (tampered != chain(scene, plane)).then(|| slices(&tampered, plane))
        })
    };
    vec![
        ("first travel + 1 %", chained(|c| scale_travel(c, 0, 1.01))),
        ("first travel − 1 %", chained(|c| scale_travel(c, 0, 0.99))),
        ("second travel + 1 %", chained(|c| scale_travel(c, 1, 1.01))),
        ("second travel − 1 %", chained(|c| scale_travel(c, 1, 0.99))),
        (
            "sign of the shear",
            chained(|c| (0..2).for_each(|n| scale_travel(c, n, -1.0))),
        ),
        (
            "second travel missing",
            chained(|c| scale_travel(c, 1, 1e-9)),
        ),
        (
            "x and y of the blockers swapped",
            chained(|c| {
                for operator in &mut c.operators {
                    if let Operator::Visibility { blockers, .. } = operator {
                        blockers.iter_mut().for_each(|r| r.center.swap(0, 1));
                    }
                }
            }),
        ),
        (
            "sign of the Fourier transform",
            Box::new(|scene, plane| {
                let mut slices = unchanged(scene, plane)?;
                slices.half.mapv_inplace(|s| s.conj());
                Some(slices)
            }),
        ),
        (
            "all blockers missing",
            chained(|c| retain_blockers(c, |_| false)),
        ),
        (
            "central blocker missing",
            chained(|c| {
                let radius = |r: &etendue_field::Rectangle| r.center[0].hypot(r.center[1]);
                let nearest = blockers(c).iter().map(radius).fold(f64::INFINITY, f64::min);
                retain_blockers(c, |r| radius(r) > nearest);
            }),
        ),
        (
            "half a bin of 64 along x",
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

/// Multiplies the `nth` travel of a chain, if it has so many.
fn scale_travel(chain: &mut Chain, nth: usize, factor: f64) {
    let is_travel = |p: &Parameter| matches!(p, Parameter::Travel(_));
    if let Some(travel) = chain.parameters().into_iter().filter(is_travel).nth(nth) {
        *chain = chain.with(travel, factor * chain.value(travel));
    }
}

fn blockers(chain: &Chain) -> Vec<etendue_field::Rectangle> {
    let of = |o: &Operator| match o {
        Operator::Visibility { blockers, .. } => blockers.clone(),
        Operator::Travel { .. } => Vec::new(),
    };
    chain.operators.iter().flat_map(of).collect()
}

fn retain_blockers(chain: &mut Chain, keep: impl Fn(&etendue_field::Rectangle) -> bool) {
    for operator in &mut chain.operators {
        if let Operator::Visibility { blockers, .. } = operator {
            blockers.retain(&keep);
        }
    }
}

/// The slices of the field moved by `shift` along x.
fn shifted(mut slices: Slices, shift: f64) -> Slices {
    let grid = slices.grid;
    for ((k, m, _), value) in slices.half.indexed_iter_mut() {
        let [omega_x, ..] = grid.frequency(k, m as f64 * grid.rho.spacing, 0.0);
        *value *= Complex::cis(-std::f64::consts::TAU * omega_x * shift);
    }
    slices
}

/// A tracer whose crossings are tampered with before they are recorded; the number counts them in a block.
struct Tampered<'a, F> {
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

impl<F: Fn(usize, Crossing) -> Option<Crossing> + Sync> PhotonSource for Tampered<'_, F> {
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
