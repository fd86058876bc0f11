//! Investigates planes that fail, by measuring them with another tracer.

use crate::judge::Judge;
use crate::measure::MeasuredScene;
use crate::reporter::Reporter;
use crate::summary::Inquiry;
use etendue_compare::{Class, PlaneComparison, PlaneReport, Test, Verdict, compare};
use etendue_field::percent;
use etendue_predict::{predict_reference, test_of};
use etendue_spectrum::estimate::TooFewBatches;
use etendue_store::{Failure, Method};

/// Measures planes that disagree with theory by the other method, and compares photons, the other
/// method and theory.
pub(crate) fn inquire(
    case: &MeasuredScene,
    planes: &[PlaneComparison],
    reporter: &dyn Reporter,
) -> Result<Vec<Inquiry>, Failure> {
    // A plane of the class `reference` has no theory. A plane may also disagree only with its
    // first-order chain of affine maps.
    let disagrees_with_theory = |i: &usize| {
        let report = &planes[*i].report;
        report.class != Class::Reference && report.exact_verdict() == Verdict::Fail
    };
    let failed: Vec<usize> = (0..planes.len()).filter(disagrees_with_theory).collect();
    let judges = Judge::all(&case.scene, &failed, case.method, reporter)?;
    let test = test_of(&case.scene);
    let judged = |i: usize| {
        let (judge, at) = Judge::of(&judges, i)?;
        let inquiry = Inquiry::of(case, (i, &planes[i].report), (judge, at), &test);
        Some(inquiry.map_err(Failure::cannot_run))
    };
    failed.into_iter().filter_map(judged).collect()
}

/// The minimum size of a disagreement, in standard errors, that a test at the level of 1 %
/// detects nine times in ten: 2.33 + 1.28.
const DETECTABLE: f64 = 3.6;

impl Inquiry {
    /// Compares another tracer's measurement of the plane `i` with the photons and with theory.
    /// In the other tracer's measurement, this plane has the number `at`.
    fn of(
        case: &MeasuredScene,
        (i, failed): (usize, &PlaneReport),
        (judge, at): (&Judge, usize),
        test: &Test,
    ) -> Result<Self, TooFewBatches> {
        let measured = &judge.measurement;
        let reference = predict_reference(&case.scene, i, &case.theories[i], measured, at)?;
        let tracers = compare(&case.measurement, i, &reference, test)?.report;
        let theory = compare(measured, at, &case.predictions[i], test)?.report;
        let methods = [case.method, judge.method];
        let rays = measured.emitted() as f64;
        Ok(Self::new(methods, failed, (&tracers, &theory), rays))
    }

    /// Combines three comparisons. `failed` compares a measurement with its prediction. The other
    /// two compare another tracer, with `rays` rays, with the measurement and with the prediction.
    fn new(
        methods: [Method; 2],
        failed: &PlaneReport,
        (tracers, theory): (&PlaneReport, &PlaneReport),
        rays: f64,
    ) -> Self {
        let [this, other] = methods.map(Method::words);
        // The three are independent: where two agree, the third is wrong.
        let finding = match (tracers.verdict, theory.exact_verdict()) {
            (Verdict::Pass, Verdict::Fail) => {
                format!(
                    "{this} and {other} agree, but the prediction differs: the theory is probably at fault"
                )
            }
            (Verdict::Fail, Verdict::Pass) => {
                format!(
                    "{other} and the prediction agree, but {this} differ: {this} are probably at fault"
                )
            }
            (Verdict::Fail, Verdict::Fail) => {
                format!("no two of {this}, {other} and the prediction agree")
            }
            (Verdict::Pass, Verdict::Pass) => both_pass([this, other], failed, theory, rays),
            (Verdict::Undecided, _) | (_, Verdict::Undecided) => {
                format!(
                    "{other} are too few to decide whether {this} or the prediction is wrong; use more photons"
                )
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

/// The conclusion if a measurement and a prediction disagree with each other, but another
/// tracer with `rays` rays agrees with both of them.
fn both_pass(
    [this, other]: [&str; 2],
    failed: &PlaneReport,
    theory: &PlaneReport,
    rays: f64,
) -> String {
    let squares = disagreement(failed);
    let error = theory.excess_squared_error.unwrap_or(f64::INFINITY);
    if squares.iter().all(|square| *square >= DETECTABLE * error) {
        return format!(
            "{other} agree with {this} and with the prediction: the failure may be chance; use another seed"
        );
    }
    let noise = theory
        .noise_limit
        .map_or("–".to_owned(), |noise| percent(noise, 3));
    let cannot = format!(
        "{other} cannot decide whether {this} or the prediction is wrong: the noise of {other} is {noise}"
    );
    let positive = squares.into_iter().filter(|square| *square > 0.0);
    let least = positive.fold(f64::INFINITY, f64::min);
    // The standard error of a squared distance falls at least in inverse proportion to the number
    // of rays.
    let needed = rays * DETECTABLE * error / least;
    if needed > rays && needed.is_finite() {
        let apart = percent(least.sqrt(), 3);
        format!(
            "{cannot}, and {this} and the prediction differ by {apart}; {needed:.1e} or more {other} are needed"
        )
    } else {
        format!("{cannot}, and the disagreement is within the noise; use more photons")
    }
}

/// Two squared distances between the measurement of a failed plane and its prediction,
/// without the part due to noise. The first squared distance weights all frequencies equally; the
/// second weights frequencies as the test does, which favours frequencies with less noise. The
/// noise of another tracer is distributed differently over frequencies. The other tracer must
/// therefore be able to detect the smaller of the two squared distances.
fn disagreement(failed: &PlaneReport) -> [f64; 2] {
    let alike = failed.excess.map(|excess| excess * excess.abs());
    let tested = failed
        .chi2_per_dof
        .zip(failed.noise_limit)
        .map(|(chi2, noise)| (chi2 - 1.0) * noise * noise);
    [alike, tested].map(|square| square.unwrap_or(0.0))
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]
mod tests {
    use super::*;
    use crate::measure::measured;
    use crate::reporter::Silent;
    use etendue_predict::Applicability;
    use etendue_predict::predict;
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

    /// A plane whose photons, backward rays and prediction come from lights with the
    /// given radiances.
    fn compared(photons: f64, rays: f64, predicted: f64) -> (MeasuredScene, PlaneComparison) {
        let of = |radiance| scene(radiance);
        let prediction = |scene: &Scene| {
            let theory = Applicability::new(scene, &scene.planes[0]);
            predict(scene, &scene.planes[0], &theory)
        };
        let traced = of(photons);
        let batches = 0..traced.run.batches;
        let case = MeasuredScene {
            measurement: measured(&traced, Method::Photons, batches, &Silent).unwrap(),
            predictions: vec![prediction(&of(predicted))],
            theories: Applicability::of_planes(&of(rays)),
            scene: of(rays),
            method: Method::Photons,
        };
        let test = test_of(&case.scene);
        let compared = compare(&case.measurement, 0, &case.predictions[0], &test).unwrap();
        (case, compared)
    }

    /// The findings for a plane with the given radiances.
    fn found(photons: f64, rays: f64, predicted: f64) -> Vec<String> {
        let (case, compared) = compared(photons, rays, predicted);
        let inquiries = inquire(&case, &[compared], &Silent).unwrap();
        inquiries
            .into_iter()
            .map(|inquiry| inquiry.finding)
            .collect()
    }

    #[test]
    fn who_is_wrong_is_told() {
        assert!(found(1.0, 1.0, 1.0).is_empty());
        let theory = found(1.0, 1.0, 1.2).concat();
        assert!(
            theory.ends_with("the theory is probably at fault"),
            "{theory}"
        );
        let photons = found(1.2, 1.0, 1.0).concat();
        assert!(
            photons.ends_with("photons are probably at fault"),
            "{photons}"
        );
        let all = found(1.2, 1.0, 0.8).concat();
        assert!(all.starts_with("no two of"), "{all}");
    }

    /// The photons differ from their prediction by 0.55 %. The test checks whether rays that
    /// agree with the photons and with the prediction could have detected this difference.
    #[test]
    fn rays_too_few_to_tell_are_no_sign_of_chance() {
        let (_, PlaneComparison { report, .. }) = compared(1.0, 1.0, 1.0);
        let with = |verdict, chi2, noise, squared_error| PlaneReport {
            verdict,
            excess: Some(0.006),
            chi2_per_dof: Some(chi2),
            noise_limit: Some(noise),
            excess_squared_error: Some(squared_error),
            ..report.clone()
        };
        // The difference of 0.55 % is half of the noise of the backward rays, which is 1.1 %.
        let found = |chi2, squared_error| {
            let failed = with(Verdict::Fail, chi2, 0.011, 1e-6);
            let passed = with(Verdict::Pass, 1.0, 0.015, squared_error);
            let methods = [Method::Photons, Method::Backward];
            Inquiry::new(methods, &failed, (&passed, &passed), 1e6).finding
        };
        let chance = "and with the prediction: the failure may be chance";
        assert!(found(1.25, 8.4e-6).contains(chance), "3.6 standard errors");
        let open = found(1.25, 8.5e-6);
        assert!(open.contains("cannot decide whether photons or"), "{open}");
        let open = found(1.25, 3e-5);
        for words in [
            "differ by 0.550 %",
            "the noise of backward rays is 1.500 %",
            "3.6e6 or more backward rays are needed",
        ] {
            assert!(open.contains(words), "{words}: {open}");
        }
        assert!(found(0.99, 1e-9).contains("within the noise"));
    }
}
