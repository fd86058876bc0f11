//! What another tracer says of planes that fail.

use crate::case::Case;
use crate::failure::Failure;
use crate::judge::Judge;
use crate::method::Method;
use crate::results::summary::Inquiry;
use etendue_compare::{Class, PlaneComparison, PlaneReport, Prediction, Test, Verdict, compare};
use etendue_spectrum::estimate::TooFewBatches;

/// Measures planes that disagree with theory by the other method, and compares all three.
pub(crate) fn inquire(
    case: &Case,
    planes: &[PlaneComparison],
    quiet: bool,
) -> Result<Vec<Inquiry>, Failure> {
    let failed: Vec<usize> = (0..planes.len())
        .filter(|i| disagrees_with_theory(&planes[*i].report))
        .collect();
    let judges = Judge::all(&case.scene, &failed, case.method, quiet)?;
    let test = Test::of(&case.scene);
    let judged = |i: usize| {
        let (judge, at) = Judge::of(&judges, i)?;
        Some(Inquiry::of(case, i, (judge, at), &test).map_err(Failure::cannot_run))
    };
    failed.into_iter().filter_map(judged).collect()
}

/// Whether a plane fails against a prediction, and not for its chain of affine maps alone.
fn disagrees_with_theory(report: &PlaneReport) -> bool {
    report.class != Class::Reference && report.exact_verdict() == Verdict::Fail
}

impl Inquiry {
    /// Compares a judge of plane `i`, which has it at number `at`, with photons and with theory.
    fn of(
        case: &Case,
        i: usize,
        (judge, at): (&Judge, usize),
        test: &Test,
    ) -> Result<Self, TooFewBatches> {
        let measured = &judge.measurement;
        let reference = Prediction::reference(&case.scene, i, &case.theories[i], measured, at)?;
        let tracers = compare(&case.measurement, i, &reference, test)?.report;
        let theory = compare(measured, at, &case.predictions[i], test)?.report;
        Ok(Self::new([case.method, judge.method], &tracers, &theory))
    }

    fn new(methods: [Method; 2], tracers: &PlaneReport, theory: &PlaneReport) -> Self {
        let [this, other] = methods.map(Method::words);
        let finding = match (tracers.verdict, theory.exact_verdict()) {
            (Verdict::Pass, Verdict::Fail) => {
                format!("{this} and {other} agree, the prediction does not: a finding about theory")
            }
            (Verdict::Fail, Verdict::Pass) => {
                format!("{other} and the prediction agree, {this} do not: a finding about {this}")
            }
            (Verdict::Fail, Verdict::Fail) => {
                format!("no two of {this}, {other} and the prediction agree")
            }
            (Verdict::Pass, Verdict::Pass) => {
                format!("{other} agree with both: chance may have made it fail; take another seed")
            }
            (Verdict::Undecided, _) | (_, Verdict::Undecided) => {
                format!("{other} are too few to tell who is wrong; take more photons")
            }
        };
        Self {
            plane: tracers.name.clone(),
            tracers: (tracers.verdict, tracers.p_value),
            other: (theory.exact_verdict(), theory.p_value),
            finding,
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]
mod tests {
    use super::*;
    use crate::measure::measured;
    use etendue_compare::Applicability;
    use etendue_scene::{Scene, SceneFile, resolve};

    fn scene(radiance: f64) -> Scene {
        let text = format!(
            "(light: Rectangle(center: (0, 0, 0), size: (0.2, 0.2), radiance: {radiance}), \
             surfaces: [Rectangle(name: \"floor\", center: (0, 0, 2), size: (9, 9))], \
             path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: [\"floor\"]), \
             planes: [(name: \"p\", at: Distance(1))], window: (x: Hann(0.5), u: Hann(0.5)), \
             frequencies: (azimuths: 2, rho: (max: 4), nu: (max: 4)), run: (photons: 200_000))"
        );
        let file = SceneFile::parse(&text).unwrap();
        resolve("test", file, ".".as_ref(), u64::MAX).unwrap()
    }

    /// What is found where photons, backward rays and the prediction are of lights with these radiances.
    fn found(photons: f64, rays: f64, predicted: f64) -> Vec<String> {
        let of = |radiance| scene(radiance);
        let prediction = |scene: &Scene| {
            let theory = Applicability::new(scene, &scene.planes[0]);
            Prediction::new(scene, &scene.planes[0], &theory)
        };
        let traced = of(photons);
        let batches = 0..traced.run.batches;
        let case = Case {
            measurement: measured(&traced, Method::Photons, batches, true).unwrap(),
            predictions: vec![prediction(&of(predicted))],
            theories: Applicability::of_planes(&of(rays)),
            scene: of(rays),
            method: Method::Photons,
        };
        let test = Test::of(&case.scene);
        let compared = compare(&case.measurement, 0, &case.predictions[0], &test).unwrap();
        let inquiries = inquire(&case, &[compared], true).unwrap();
        inquiries
            .into_iter()
            .map(|inquiry| inquiry.finding)
            .collect()
    }

    #[test]
    fn who_is_wrong_is_told() {
        assert!(found(1.0, 1.0, 1.0).is_empty());
        let theory = found(1.0, 1.0, 1.2).concat();
        assert!(theory.ends_with("a finding about theory"), "{theory}");
        let photons = found(1.2, 1.0, 1.0).concat();
        assert!(photons.ends_with("a finding about photons"), "{photons}");
        let all = found(1.2, 1.0, 0.8).concat();
        assert!(all.starts_with("no two of"), "{all}");
    }
}
