//! Sums over rays that represent a light field, by randomised quasi-Monte Carlo.
//!
//! Light fields without a closed form are integrals over rays: positions and slopes at the plane,
//! and points of the light. The nodes are the points of scrambled nets ([`sobol`]). Each of
//! [`REPLICATES`] independent nets is an unbiased prediction, and the error of their mean is
//! computed from their spread. If there are too few nodes, the nets disagree. Nodes are added until
//! the error is below the requested error, or until a budget is spent.

mod budget;
mod density;
mod moments;
mod rays;
mod sobol;

pub use budget::RayBudget;
pub(crate) use budget::affordable_derivatives;
use budget::{DERIVATIVE_NODES, OF_DERIVATIVES, most_for_derivatives, power_of_two};
pub(crate) use density::{LinearDensity, Target};
pub use rays::RayNets;
pub(crate) use rays::SampledNets;
pub(crate) use sobol::{DIMENSIONS, NetPoints};

use crate::predicted::{NetMean, Predicted};
use crate::work::PredictionWork;
use etendue_field::{Complex, Projection, ProjectionGrid, SliceGrid, Slices, TwoPlane, Window};
use etendue_transform::SliceTransform;
use moments::WeightedMoments;
use ndarray::{Array2, Array3};
use rayon::prelude::*;

/// Number of independent nets of a prediction.
pub const REPLICATES: usize = 32;
/// Number of independent nets for choosing a sampling strategy.
const OF_TRIALS: usize = 16;
/// The relative error ‖error‖/‖D‖ at which a derivative D is accurate enough. With such a
/// derivative, a hundredth of its power is noise.
const DERIVATIVE_ERROR: f64 = 0.1;
/// Number of nodes of a net at which the error of a derivative is first estimated.
const FIRST_OF_DERIVATIVES: u32 = 1 << 9;
/// Number of nodes of a net at which its error is first estimated.
const FIRST_NODES: u32 = 1 << 11;
/// Minimum number of nodes of a net in a trial.
const TRIAL_NODES: u32 = 1 << 8;
/// Number of nodes in all nets of a trial, as a share of the nodes of the prediction.
const OF_TRIAL: f64 = 1.0 / 128.0;

/// Minimum number of nodes of a net before a prediction may stop because its estimated error is
/// small. If nets have not yet sampled any ray of large weight, the spread between nets
/// underestimates the error.
const MIN_NODES: u32 = 1 << 12;

/// A ray at a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RayNode {
    /// The ray's coordinates at the plane: positions and slopes (x, y, u, v), or positions and
    /// angles on a surface.
    pub(crate) z: [f64; 4],
    /// The ray's contribution to the windowed radiance space, divided by the density with which the
    /// ray was sampled.
    pub(crate) weight: f64,
}

impl RayNode {
    /// A ray without a contribution.
    pub(crate) const DARK: Self = Self {
        z: [0.0; 4],
        weight: 0.0,
    };
}

/// Light fields whose rays are functions of a point of the unit cube.
pub(crate) trait Integrand: Sync {
    /// The number of fields.
    fn fields(&self) -> usize {
        1
    }
    /// How many coordinates of a point the fields depend on. The number is at most
    /// [`DIMENSIONS`].
    fn dimensions(&self) -> usize {
        6
    }
    /// The number of rays per point in each field.
    fn rays(&self) -> usize {
        1
    }
    /// Computes the rays of each wanted field for a point of the unit cube, and writes them to
    /// `nodes` field by field. Before the call, all entries of `nodes` are rays without a
    /// contribution.
    fn nodes(&self, at: &[f64; DIMENSIONS], wanted: &[bool], nodes: &mut [RayNode]);
}

impl Predicted {
    /// The prediction of zero, with a number of derivatives, for the case in which no ray in
    /// any net carries light.
    pub(crate) fn dark(grid: &SliceGrid, picture: &ProjectionGrid, derivatives: usize) -> Self {
        let values = Array2::zeros((picture.bins, picture.bins));
        let projection = Projection {
            grid: *picture,
            values,
        };
        Self {
            replicates: vec![Slices::zeros(*grid); REPLICATES],
            error: Some(f64::INFINITY),
            derivatives: vec![Slices::zeros(*grid); derivatives],
            ..Self::exact(Slices::zeros(*grid), projection)
        }
    }
}

/// The sums over the nodes of a net, to which more nodes can be added.
struct Running {
    net: NetPoints,
    /// Whether more nodes are added to each field.
    wanted: Vec<bool>,
    /// The sums of each field so far.
    slices: Vec<Slices>,
    projection: Array2<f64>,
    moments: WeightedMoments,
    /// The number of nodes so far.
    count: f64,
}

/// Sums the first field over the nodes of independent nets, doubling the number of nodes until the
/// budget is reached. The result is bitwise identical on any number of threads.
pub(crate) fn sums(
    integrand: &(impl Integrand + ?Sized),
    (window, grid): (&Window, &SliceGrid),
    bins: usize,
    budget: RayBudget,
) -> Predicted {
    let mut nets = begin(integrand, grid, bins, 0, REPLICATES);
    let all = budget.nodes / REPLICATES as f64;
    let first = power_of_two(all, [FIRST_NODES, MIN_NODES]);
    let end = within(budget);
    let error = doubled(integrand, (window, grid), &mut nets, first, end);
    finished(nets, ProjectionGrid::new(window, bins), error)
}

/// ‖error‖/‖F‖ for a small number of rays, to choose the best sampling strategy. A strategy
/// that is best for very few rays may not be best for many. The nets of a trial are not the nets of
/// predictions; otherwise, rays of large weight would often be absent from both.
pub(crate) fn trial(
    integrand: &(impl Integrand + ?Sized),
    (window, grid): (&Window, &SliceGrid),
    budget: RayBudget,
) -> f64 {
    const TRIED: RayBudget = RayBudget::new(0.0, f64::INFINITY);
    let mut nets = begin(integrand, grid, 1, REPLICATES, OF_TRIALS);
    let all = OF_TRIAL * budget.nodes;
    let each = power_of_two(all / OF_TRIALS as f64, [TRIAL_NODES, FIRST_NODES]);
    doubled(integrand, (window, grid), &mut nets, each, within(TRIED))
}

/// Adds `first` nodes to all nets, and doubles the number of nodes until `end` returns a result for
/// the nets and the number of nodes of each.
fn doubled<T>(
    integrand: &(impl Integrand + ?Sized),
    (window, grid): (&Window, &SliceGrid),
    running: &mut [Running],
    first: u32,
    mut end: impl FnMut(&mut [Running], u32) -> Option<T>,
) -> T {
    let picture = ProjectionGrid::new(window, running[0].projection.nrows());
    let transform = SliceTransform::new(grid);
    let (mut each, mut more) = (0, first);
    loop {
        running
            .par_iter_mut()
            .for_each(|net| net.add(integrand, &transform, &picture, more));
        each += more;
        if let Some(result) = end(running, each) {
            return result;
        }
        more = each;
    }
}

/// The end of a prediction: the error of the mean over nets, once the budget is reached.
fn within(budget: RayBudget) -> impl Fn(&mut [Running], u32) -> Option<f64> {
    move |running, each| {
        let nodes = f64::from(each) * REPLICATES as f64;
        let [error, own] = error_and_norm(running.iter().map(|net| &net.slices[0]));
        let is_enough = error <= budget.error * own.max(f64::from(each) * budget.beside);
        let ends = is_enough || 2.0 * nodes > budget.nodes || each > 1 << 29;
        ends.then(|| relative([error, own]))
    }
}

/// The mean of each field over nets, to a relative error of [`DERIVATIVE_ERROR`] or with
/// a number of nodes in proportion to that of the prediction. No nodes are added to a field that is
/// accurate.
///
/// The nets differ from the nets of [`sums`], because a derivative that has the same noise as the
/// prediction biases every measured parameter.
pub(crate) fn means(
    integrand: &(impl Integrand + ?Sized),
    (window, grid): (&Window, &SliceGrid),
    predicted: &Predicted,
) -> Vec<NetMean> {
    let fields = integrand.fields();
    if fields == 0 {
        return Vec::new();
    }
    let mut running = begin(integrand, grid, 1, REPLICATES + OF_TRIALS, OF_DERIVATIVES);
    let most = most_for_derivatives(fields, predicted.nodes);
    let mut means = vec![None; fields];
    let end = |running: &mut [Running], each: u32| {
        for (field, known) in means
            .iter_mut()
            .enumerate()
            .filter(|(_, mean)| mean.is_none())
        {
            let mut mean = NetMean::new(running.iter().map(|net| &net.slices[field]));
            // A parameter that changes no ray has no derivative, but few rays may have missed it.
            let is_dark = each >= DERIVATIVE_NODES[0] && mean.slices.is_dark();
            if mean.error <= DERIVATIVE_ERROR || is_dark || each >= most {
                mean.slices.half /= Complex::from(f64::from(each));
                *known = Some(mean);
                for net in &mut *running {
                    net.wanted[field] = false;
                }
            }
        }
        means.iter().all(Option::is_some).then_some(())
    };
    doubled(
        integrand,
        (window, grid),
        &mut running,
        FIRST_OF_DERIVATIVES,
        end,
    );
    means.into_iter().flatten().collect()
}

/// Estimated number of computing steps to follow a ray and to spread it onto the grid of an
/// azimuth.
const RAY: f64 = 400.0;
const SPREAD: f64 = 15.0;
/// Approximate number of fields that are summed in one pass over all derivatives.
const FIELDS: usize = 12;
/// Estimated number of computing steps of a transform for each frequency.
const TRANSFORM: f64 = 300.0;

/// Estimates the work of a prediction by nets that uses all of its budget. The estimate includes
/// the work to follow rays and the work of the transforms of all nets.
#[must_use]
pub(crate) fn work_of_nets(grid: &SliceGrid, budget: RayBudget) -> PredictionWork {
    let cells: f64 = grid.half_shape().iter().map(|n| *n as f64).product();
    let azimuths = grid.azimuths as f64;
    let replicates = REPLICATES as f64;
    let rounds = libm::log2(budget.nodes / (replicates * f64::from(FIRST_NODES))).max(1.0);
    let derivatives = (OF_DERIVATIVES * FIELDS) as f64;
    // Derivatives add to the work of the prediction. Each is a difference between two rays.
    let of_derivatives = 2.0 * derivatives * f64::from(most_for_derivatives(FIELDS, budget.nodes));
    let rays = budget.nodes + of_derivatives;
    let rays = rays * (RAY + SPREAD * azimuths);
    let transforms = TRANSFORM * cells * (rounds * replicates + derivatives);
    let slice = 16.0 * cells;
    PredictionWork {
        steps: rays + transforms,
        // Memory contains the sums of all nets, the means of finished nets, and the oversampled
        // grids of each thread.
        bytes: slice * (2.0 * replicates).max(derivatives),
        bytes_each: SliceTransform::new(grid).bytes() * FIELDS as f64,
        drivers: format!(
            "{:.0e} rays, and transforms to {cells:.0} frequencies",
            budget.nodes
        ),
    }
}

fn begin(
    integrand: &(impl Integrand + ?Sized),
    grid: &SliceGrid,
    bins: usize,
    first: usize,
    replicates: usize,
) -> Vec<Running> {
    let running = |replicate| Running {
        net: NetPoints::new(replicate, integrand.dimensions()),
        wanted: vec![true; integrand.fields()],
        slices: vec![Slices::zeros(*grid); integrand.fields()],
        projection: Array2::zeros((bins, bins)),
        moments: WeightedMoments::default(),
        count: 0.0,
    };
    (0..).skip(first).take(replicates).map(running).collect()
}

impl Running {
    fn add(
        &mut self,
        integrand: &(impl Integrand + ?Sized),
        transform: &SliceTransform,
        picture: &ProjectionGrid,
        count: u32,
    ) {
        self.count += f64::from(count);
        let sum = |wanted: &bool| wanted.then(|| transform.accumulator());
        let mut sums: Vec<_> = self.wanted.iter().map(sum).collect();
        let rays = integrand.rays();
        let mut nodes = vec![RayNode::DARK; sums.len() * rays];
        for _ in 0..count {
            nodes.fill(RayNode::DARK);
            integrand.nodes(&self.net.point(), &self.wanted, &mut nodes);
            for (nodes, sum) in nodes.chunks(rays).zip(&mut sums) {
                let Some(sum) = sum else { continue };
                for RayNode { z, weight } in nodes.iter().filter(|node| node.weight != 0.0) {
                    let [x, y, u, v] = *z;
                    sum.deposit(&TwoPlane { x, y, u, v }, *weight);
                }
            }
            let RayNode { z, weight } = nodes[0];
            if let Some(cell) = picture.cell(z[0], z[2]).filter(|_| weight != 0.0) {
                self.projection[cell] += weight;
            }
            self.moments.add(z, weight);
        }
        for (slices, sum) in self.slices.iter_mut().zip(&mut sums) {
            if let Some(sum) = sum {
                slices.half += &sum.finish(1.0).half;
            }
        }
    }
}

fn finished(running: Vec<Running>, grid: ProjectionGrid, error: f64) -> Predicted {
    let each = running[0].count;
    let mut values = Array2::zeros((grid.bins, grid.bins));
    let mut moments = WeightedMoments::default();
    let mut replicates = Vec::with_capacity(running.len());
    for mut net in running {
        values += &net.projection;
        moments.join(&net.moments);
        let mut slices = net.slices.swap_remove(0);
        slices.half /= Complex::from(each);
        replicates.push(slices);
    }
    values /= grid.cell_area() * each * replicates.len() as f64;
    let slices = mean(replicates.iter());
    Predicted {
        replicates,
        error: Some(error),
        covariance: moments.central(),
        nodes: each * REPLICATES as f64,
        ..Predicted::exact(slices, Projection { grid, values })
    }
}

/// The mean of several slices on one grid.
///
/// # Panics
/// Panics if there are no slices.
pub(crate) fn mean<'a>(slices: impl ExactSizeIterator<Item = &'a Slices>) -> Slices {
    let count = slices.len() as f64;
    let mut slices = slices;
    let mut sum = slices.next().expect("at least one net").clone();
    for other in slices {
        sum.half += &other.half;
    }
    sum.half /= Complex::from(count);
    sum
}

impl NetMean {
    /// The mean of sums over independent nets.
    pub(crate) fn new<'a>(sums: impl ExactSizeIterator<Item = &'a Slices> + Clone) -> Self {
        Self {
            slices: mean(sums.clone()),
            error: relative(error_and_norm(sums)),
        }
    }
}

/// ‖σ‖ and ‖F‖, where F is the mean over nets and σ is its standard error (docs/theory.md
/// (12)).
fn error_and_norm<'a>(slices: impl ExactSizeIterator<Item = &'a Slices> + Clone) -> [f64; 2] {
    let r = slices.len() as f64;
    let mean = mean(slices.clone());
    let spread = |one: &Slices| -> f64 {
        let apart: Array3<Complex> = &one.half - &mean.half;
        apart.iter().map(|d| d.norm_sqr()).sum()
    };
    let variance = slices.map(spread).sum::<f64>() / (r * (r - 1.0));
    [variance.sqrt(), mean.norm()]
}

fn relative([error, norm]: [f64; 2]) -> f64 {
    if norm > 0.0 {
        error / norm
    } else {
        f64::INFINITY
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::window;
    use etendue_field::{FrequencyAxis, Profile};
    use std::f64::consts::TAU;

    /// Rays across a window, with weights of both signs.
    struct Waves;

    impl Integrand for Waves {
        fn fields(&self) -> usize {
            2
        }

        fn nodes(&self, at: &[f64; DIMENSIONS], _: &[bool], nodes: &mut [RayNode]) {
            for (i, node) in nodes.iter_mut().enumerate() {
                node.z = std::array::from_fn(|k| at[k + i] - 0.5);
                node.weight = libm::cos(3.0 * at[4]) + i as f64;
            }
        }
    }

    fn grid() -> SliceGrid {
        let axis = |half, spacing| FrequencyAxis { half, spacing };
        SliceGrid {
            azimuths: 3,
            rho: axis(5, 0.7),
            nu: axis(9, 1.1),
        }
    }

    #[test]
    fn plain_summation() {
        let (window, grid) = (window(Profile::Box(0.5), Profile::Box(0.5)), grid());
        let budget = RayBudget::new(0.0, 0.0);
        let found = sums(&Waves, (&window, &grid), 4, budget);
        let replicate = 5;
        let mut net = NetPoints::new(replicate, DIMENSIONS);
        let mut nodes = [RayNode::DARK; 2];
        let rays: Vec<RayNode> = (0..FIRST_NODES)
            .map(|_| {
                Waves.nodes(&net.point(), &[true; 2], &mut nodes);
                nodes[0]
            })
            .collect();
        let slices = &found.replicates[replicate as usize];
        for ((k, m, n), value) in slices.half.indexed_iter() {
            let omega = grid.frequency(k, m as f64 * grid.rho.spacing, grid.nu.value(n));
            let term = |node: &RayNode| {
                let phase: f64 = omega.iter().zip(node.z).map(|(o, z)| o * z).sum();
                Complex::from_polar(node.weight, -TAU * phase)
            };
            let plain = rays.iter().map(term).sum::<Complex>() / f64::from(FIRST_NODES);
            // The tolerance is the error bound of the transform, 2·10⁻⁷ of the mean weight.
            assert!((value - plain).norm() < 4e-7, "{k} {m} {n}");
        }
    }

    /// Tests that derivatives and the prediction use different nets, because common noise would
    /// bias the parameters that are measured with these derivatives.
    #[test]
    fn derivatives_have_nets_of_their_own() {
        let (window, grid) = (window(Profile::Box(0.5), Profile::Box(0.5)), grid());
        let picture = ProjectionGrid::new(&window, 1);
        let dark = Predicted::dark(&grid, &picture, 0);
        let derivative = &means(&Waves, (&window, &grid), &dark)[0];
        let mut running = begin(&Waves, &grid, 1, 0, OF_DERIVATIVES);
        let (picture, transform) = (ProjectionGrid::new(&window, 1), SliceTransform::new(&grid));
        for net in &mut running {
            net.add(&Waves, &transform, &picture, FIRST_OF_DERIVATIVES);
        }
        let mut same = mean(running.iter().map(|net| &net.slices[0]));
        same.half /= Complex::from(f64::from(FIRST_OF_DERIVATIVES));
        assert_ne!(derivative.slices.half, same.half);
    }

    #[test]
    fn any_number_of_threads_gives_the_same_bytes() {
        let (window, grid) = (window(Profile::Box(0.5), Profile::Box(0.5)), grid());
        let budget = RayBudget::new(1e5, 0.0);
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let run = || sums(&Waves, (&window, &grid), 4, budget);
            let found = pool.build().unwrap().install(run);
            (found.replicates, found.projection, found.covariance)
        };
        assert_eq!(on(1), on(3));
    }
}
