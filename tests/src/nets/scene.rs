//! Computes, for a random scene, the difference between its prediction by nets and the truth, in
//! units of the stated error.

use super::draw::{self, BlockerKind, scene};
use etendue_field::{Complex, Slices, VirtualPlane};
use etendue_field::{ProjectionGrid, Window};
use etendue_predict::{Applicability, Theory};
use etendue_scene::{Scene, SceneFile, resolve};
use etendue_theory::{Model, REPLICATES, RayBudget};

/// The results for the light field at the plane of one scene.
pub(super) struct SceneOutcome {
    pub(super) kind: BlockerKind,
    /// The number of the scene, from which [`super::draw`] reproduces it.
    pub(super) number: u64,
    /// The stated ‖error‖/‖F‖.
    pub(super) stated: f64,
    /// Error of the reference solution (the truth), divided by the stated error of the prediction
    /// that is compared with it.
    pub(super) of_truth: f64,
    /// The prediction compared with the truth.
    pub(super) sound: Measured,
    /// The comparison with a planted fault. The density of rays is 2 % too large, which makes the
    /// weights of rays too small.
    pub(super) planted: Measured,
}

/// The deviation of a prediction from the truth.
pub(super) struct Measured {
    /// ‖F − truth‖/‖truth‖ for the predicted spectrum F, divided by the stated relative error of
    /// F.
    pub(super) ratio: f64,
    /// The squared ratios for the means of two adjacent nets. The error of such a mean is four
    /// times the error of the mean of all nets.
    pub(super) pairs: Vec<f64>,
    /// The deviation at zero frequency: (F − truth)/(standard error).
    pub(super) zero: f64,
    /// The deviations at frequencies other than zero, as Hotelling's T of real and imaginary part,
    /// divided by √2.
    pub(super) apart: Vec<f64>,
}

/// The outcomes of the scenes of each kind. Scenes without a theory and scenes without
/// light are replaced by further random scenes.
pub(super) fn outcomes(each: impl Fn(&SceneOutcome)) -> (Vec<SceneOutcome>, usize) {
    let (mut outcomes, mut left_out, mut number) = (Vec::new(), 0, 0);
    for (kind, _, count) in BlockerKind::ALL {
        let mut found = 0;
        while found < count {
            number += 1;
            match outcome(kind, number) {
                Ok(Some(outcome)) => {
                    each(&outcome);
                    outcomes.push(outcome);
                    found += 1;
                }
                Ok(None) => {}
                Err(Untold) => left_out += 1,
            }
        }
    }
    (outcomes, left_out)
}

/// The error of a scene for which no sufficiently accurate truth can be computed.
struct Untold;

/// The result of predicting one plane of a scene.
struct PredictionFound {
    slices: Slices,
    replicates: Vec<Slices>,
    error: f64,
}

/// Maximum permitted error of the truth, relative to the stated error of the prediction.
const OF_STATED: f64 = 0.1;
/// Factor by which the number of nodes is increased for the truth, if there is no closed form.
const HUNDREDFOLD: f64 = 128.0;
/// The factor by which the planted fault multiplies a density of rays.
const PLANTED: f64 = 1.02;
/// Maximum relative error of a prediction that is judged. If the relative error of a prediction
/// is larger, hardly any light arrives, and the prediction depends on a few rays.
const DARK: f64 = 0.3;

/// The outcome of a scene, or `None` if no theory applies or no light arrives at the
/// plane.
fn outcome(kind: BlockerKind, number: u64) -> Result<Option<SceneOutcome>, Untold> {
    let mut dice = draw::dice(number);
    let text = scene(kind, &mut dice);
    let doublings = if kind.is_chain() { dice.below(3) } else { 0 };
    let budget = RayBudget::new(
        65_536.0 * [1.0, 2.0, 4.0][doublings],
        [0.0, 5e-3][dice.below(2)],
    );
    let file = SceneFile::parse(&text).expect("a drawn scene is a scene file");
    let Ok(scene) = resolve("drawn", file, ".".as_ref(), u64::MAX) else {
        return Ok(None);
    };
    let plane = &scene.planes[0];
    let Some(theory) = theory(&scene, plane) else {
        return Ok(None);
    };
    let Some(found) = found(&theory, plane, budget) else {
        return Ok(None);
    };
    let is_lit = found.error < DARK;
    if !is_lit || found.replicates.is_empty() {
        return Ok(None);
    }
    let (truth, error) = truth(&theory, plane, budget, found.error)?;
    Ok(Some(SceneOutcome {
        kind,
        number,
        stated: found.error,
        of_truth: error / found.error,
        sound: measured(&found, &truth),
        planted: measured(&found.scaled(1.0 / PLANTED), &truth),
    }))
}

fn measured(found: &PredictionFound, truth: &Slices) -> Measured {
    Measured {
        ratio: found.slices.relative_difference(truth) / found.error,
        pairs: found
            .replicates
            .chunks_exact(2)
            .map(|pair| of_pair(pair, truth, found.error))
            .collect(),
        zero: at_zero(found, truth),
        apart: SINGLE.map(|at| at_frequency(found, truth, at)).to_vec(),
    }
}

/// The squared ratio of L2 error to stated error for the mean of two nets.
fn of_pair(pair: &[Slices], truth: &Slices, error: f64) -> f64 {
    let mut mean = pair[0].clone();
    mean.half += &pair[1].half;
    mean.half /= Complex::from(2.0);
    let of_all = (REPLICATES as f64 / 2.0).sqrt();
    (mean.relative_difference(truth) / (of_all * error)).powi(2)
}

impl PredictionFound {
    fn scaled(&self, factor: f64) -> Self {
        let times = |slices: &Slices| {
            let mut slices = slices.clone();
            slices.half *= Complex::from(factor);
            slices
        };
        Self {
            slices: times(&self.slices),
            replicates: self.replicates.iter().map(times).collect(),
            error: self.error,
        }
    }
}

/// Indices [azimuth, ρ ≥ 0, ν] of the frequencies that are judged one by one; ν = 0 has the index
/// 4.
const SINGLE: [[usize; 3]; 4] = [[0, 1, 4], [1, 2, 6], [0, 3, 3], [1, 5, 8]];

fn theory(scene: &Scene, plane: &VirtualPlane) -> Option<Theory> {
    let applicability = Applicability::new(scene, plane);
    applicability.dark.is_none().then_some(applicability.theory)
}

/// The prediction by nets of rays for the plane of a scene.
fn found(theory: &Theory, plane: &VirtualPlane, budget: RayBudget) -> Option<PredictionFound> {
    let picture = ProjectionGrid::new(&plane.window, 1);
    let over = (&plane.window, &plane.grid, &picture);
    let found = match theory {
        Theory::Parallel(chain) => chain.sampled(&[], over, budget),
        Theory::Path(view) => view.predict(&[], over, budget),
        Theory::None => return None,
    };
    Some(PredictionFound {
        error: found.error?,
        slices: found.slices,
        replicates: found.replicates,
    })
}

/// The true spectrum, from a closed form or from a prediction with many rays, and the
/// error of this spectrum.
fn truth(
    theory: &Theory,
    plane: &VirtualPlane,
    budget: RayBudget,
    stated: f64,
) -> Result<(Slices, f64), Untold> {
    let enough = OF_STATED * stated;
    if let Theory::Parallel(chain) = theory {
        let window: &Window = &plane.window;
        // The quadrature over the receiver uses more nodes for higher frequencies. Therefore it
        // becomes more accurate if higher frequencies are requested.
        for more in [1, 2, 4] {
            let mut grid = plane.grid;
            grid.rho.half *= more;
            let slices = etendue_theory::slices(chain, window, &grid);
            let error = etendue_theory::quadrature_error(chain, window, &grid, &slices);
            let error = error.unwrap_or(0.0);
            if error < enough {
                return Ok((within(&slices, plane), error));
            }
        }
        return Err(Untold);
    }
    let more = RayBudget::new(HUNDREDFOLD * budget.nodes, 0.8 * enough);
    let found = found(theory, plane, more).ok_or(Untold)?;
    Ok((found.slices, found.error))
}

/// The slices restricted to the frequencies of the plane.
fn within(slices: &Slices, plane: &VirtualPlane) -> Slices {
    let mut lower = Slices::zeros(plane.grid);
    for (at, value) in lower.half.indexed_iter_mut() {
        *value = slices.half[at];
    }
    lower
}

/// The residuals of all replicates (single nets) at one frequency.
fn residuals(found: &PredictionFound, truth: &Slices, at: [usize; 3]) -> Vec<Complex> {
    let replicates = found.replicates.iter();
    replicates.map(|r| r.half[at] - truth.half[at]).collect()
}

/// Student's t of the real value at zero frequency.
fn at_zero(found: &PredictionFound, truth: &Slices) -> f64 {
    let zero = [0, 0, truth.grid.nu.half];
    let values: Vec<f64> = residuals(found, truth, zero).iter().map(|d| d.re).collect();
    let [mean, error] = crate::statistics::mean(&values);
    mean / error
}

/// Hotelling's T divided by √2, which equals |d|/σ for circular noise.
fn at_frequency(found: &PredictionFound, truth: &Slices, at: [usize; 3]) -> f64 {
    let values = residuals(found, truth, at);
    let r = values.len() as f64;
    let mean = values.iter().sum::<Complex>() / r;
    let [mut xx, mut xy, mut yy] = [0.0; 3];
    for d in &values {
        let d = d - mean;
        xx += d.re * d.re;
        xy += d.re * d.im;
        yy += d.im * d.im;
    }
    let [xx, xy, yy] = [xx, xy, yy].map(|sum| sum / (r * (r - 1.0)));
    let squared = yy * mean.re.powi(2) - 2.0 * xy * mean.re * mean.im + xx * mean.im.powi(2);
    (0.5 * squared / (xx * yy - xy * xy)).sqrt()
}
