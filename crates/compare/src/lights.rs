//! Adds the predictions of several lights.

use crate::class::Class;
use crate::first_order::{FirstOrder, FirstOrderChain};
use crate::prediction::{PredictedParameter, Prediction};
use etendue_field::{Projection, Slices};

impl Prediction {
    /// The first-order chain of the sum of lights. The light of parallel planes is its own
    /// chain. Returns `None` if no light has a first-order chain, or a light has no chain at all.
    ///
    /// The sum has the largest defect of its lights, because no map may be wrong. The matrix and the
    /// foci are those of the first light with a first-order chain. The sum has no covariance.
    #[must_use]
    pub fn chain_of_lights(each: &[Self]) -> Option<FirstOrder> {
        let mut chains = each.iter().filter_map(|of| of.first_order.as_ref());
        let first = chains.next()?;
        let mut chain = FirstOrderChain {
            covariance: [None; 2],
            ..first.chain.clone()
        };
        for FirstOrder { chain: other, .. } in chains {
            chain.defect = chain.defect.max(other.defect);
            chain.radiance_defect = chain.radiance_defect.max(other.radiance_defect);
        }
        let grid = first.slices.grid;
        let (mut slices, mut all) = (Slices::zeros(grid), Vec::new());
        for of in each {
            let linear = match &of.first_order {
                Some(chain) => (&chain.slices, &chain.replicates[..]),
                None if of.class == Class::Exact || of.slices.is_dark() => replicated(of),
                None => return None,
            };
            all = replicates((&slices, &all), linear);
            slices = sum(&slices, linear.0);
        }
        let exact = each
            .iter()
            .fold(Slices::zeros(grid), |all, of| sum(&all, &of.slices));
        chain.error = if chain.as_printed {
            // The slices follow the printed formulas, and the error is that of the corrected ones.
            let errors = each
                .iter()
                .filter_map(|of| Some(of.first_order.as_ref()?.chain.error * of.slices.norm()));
            errors.sum::<f64>() / exact.norm()
        } else {
            slices.independent_relative_difference(&exact)
        };
        Some(FirstOrder {
            slices,
            replicates: all,
            chain,
        })
    }

    /// Adds the prediction of another light. Errors that no replicates show add up. Parameters
    /// with the same name are the same parameter, whose derivatives add up.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        let slices = sum(&self.slices, &other.slices);
        let all = slices.norm();
        let share = |of: &Self, error: f64| {
            let size = of.slices.norm();
            if size > 0.0 && all > 0.0 {
                error * size / all
            } else {
                0.0
            }
        };
        let added = |of: &dyn Fn(&Self) -> Option<f64>| {
            let both = [&self, &other].into_iter();
            both.filter_map(|one| Some(share(one, of(one)?)))
                .reduce(|a, b| a + b)
        };
        let rule = |of: &Self| of.quadrature_error.filter(|_| !of.is_statistical());
        let rules = added(&|of| match (rule(of), of.rule_error) {
            (None, None) => None,
            (a, b) => Some(a.unwrap_or(0.0) + b.unwrap_or(0.0)),
        });
        let mesh_error = added(&|of| of.mesh_error);
        let replicates = replicates(replicated(&self), replicated(&other));
        let (quadrature_error, rule_error) = if replicates.is_empty() {
            (rules, None)
        } else {
            (Some(standard_error(&replicates, &slices)), rules)
        };
        let depths = self.depth.into_iter().chain(other.depth);
        Self {
            quadrature_error,
            rule_error,
            mesh_error,
            first_order: None,
            replicates,
            unblocked: self.unblocked + other.unblocked,
            projection: Projection {
                values: &self.projection.values + &other.projection.values,
                grid: self.projection.grid,
            },
            parameters: parameters(self.parameters, other.parameters),
            depth: depths.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]),
            slices,
            class: self.class,
            steps: self.steps,
            cuts: self.cuts,
        }
    }
}

fn sum(a: &Slices, b: &Slices) -> Slices {
    Slices {
        half: &a.half + &b.half,
        ..*a
    }
}

/// Slices and their replicates.
type Replicated<'a> = (&'a Slices, &'a [Slices]);

fn replicated(of: &Prediction) -> Replicated<'_> {
    (&of.slices, &of.replicates)
}

/// The replicates of a sum. A light without replicates has the same slices in each.
fn replicates(a: Replicated<'_>, b: Replicated<'_>) -> Vec<Slices> {
    let with = |of: &[Slices], all: &Slices| of.iter().map(|one| sum(one, all)).collect();
    match (a, b) {
        ((_, []), (_, [])) => Vec::new(),
        ((a, []), (_, of)) => with(of, a),
        ((_, of), (b, [])) => with(of, b),
        ((_, a), (_, b)) => a.iter().zip(b).map(|(a, b)| sum(a, b)).collect(),
    }
}

/// The standard error of the mean of replicates, relative to the mean. It is infinite if
/// the mean is zero.
fn standard_error(replicates: &[Slices], mean: &Slices) -> f64 {
    let squares = replicates.iter().map(|one| {
        let off = one.half.iter().zip(&mean.half);
        off.map(|(a, b)| (a - b).norm_sqr()).sum::<f64>()
    });
    let count = replicates.len() as f64;
    let size = mean.norm();
    if size > 0.0 {
        (squares.sum::<f64>() / (count * (count - 1.0))).sqrt() / size
    } else {
        f64::INFINITY
    }
}

fn parameters(
    mut all: Vec<PredictedParameter>,
    more: Vec<PredictedParameter>,
) -> Vec<PredictedParameter> {
    for parameter in more {
        let same = |known: &&mut PredictedParameter| known.name == parameter.name;
        match all.iter_mut().find(same) {
            Some(known) => known.derivative = sum(&known.derivative, &parameter.derivative),
            None => all.push(parameter),
        }
    }
    all
}
