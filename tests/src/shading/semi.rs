//! The semi-convolution in 4D, for photons and for rays. This operator computes the spectrum after
//! reflection by a sum of BRDFs from the spectrum before the reflection.

use super::bench::{each_weight, reflectance};
use super::planted::swapped;
use super::scenes::changed;
use super::semi_operator::semi_convolution;
use crate::report::Bound::{Above, Below};
use crate::report::{Check, ReportSection, Row};
use crate::rows::Line;
use crate::scenes::{predicted, traced};
use etendue_field::{Complex, FrequencyAxis, Lobe, Pattern, Reflectance, Slices};
use etendue_scene::Scene;
use etendue_spectrum::estimate;
use ndarray::Array3;

const SCENE: &str = "semi_convolution";

/// A function that modifies the BRDFs of the operator.
type BrdfChange = fn(&mut Reflectance);

const FAULTS: [(&str, BrdfChange); 6] = [
    ("none", |_| ()),
    ("weights swapped", swapped),
    (
        "weights replaced by their means, which gives a product",
        |r| each_weight(r, |grating| grating.modulation = 0.0),
    ),
    ("wrong sign of the phase", |r| {
        each_weight(r, |grating| grating.phase = -grating.phase);
    }),
    ("modulation of the weights + 5 %", |r| {
        each_weight(r, |grating| grating.modulation *= 1.05);
    }),
    ("lobes 2 % too wide", |r| {
        for term in &mut r.terms {
            if let Lobe::Phong { exponent } = &mut term.brdf.lobe {
                *exponent /= 1.02 * 1.02;
            }
        }
    }),
];

/// The slices before and after the surface.
struct Sides {
    before: Slices,
    after: Slices,
    /// Variance of the slices after the surface, with indices [azimuth, ρ ≥ 0, ν].
    variance: Array3<f64>,
}

impl Sides {
    fn measured(scene: &Scene) -> Self {
        let measurement = traced(scene);
        let estimate = |i| estimate::slices(&measurement, i).expect("a scene has 64 batches");
        let after = estimate(1);
        Self {
            before: estimate(0).mean,
            after: after.mean,
            variance: after.variance,
        }
    }

    fn of_rays(scene: &Scene) -> Self {
        let mut planes = predicted(scene, None).into_iter();
        let mut next = || planes.next().expect("two planes");
        let (before, after) = (next(), next());
        let count = after.replicates.len() as f64;
        let mut variance = Array3::zeros(after.slices.grid.half_shape());
        for replicate in &after.replicates {
            let off = &replicate.half - &after.slices.half;
            variance += &off.mapv(|off| off.norm_sqr() / (count * (count - 1.0)));
        }
        Self {
            before: before.slices,
            after: after.slices,
            variance,
        }
    }

    /// Two numbers relative to ‖after‖: ‖operator(before) − after‖ without the contribution
    /// of noise, and the noise. Both norms are over the slice along x and over all frequencies that
    /// the operator's shifts keep within the grid.
    fn apart(&self, reflectance: &Reflectance, axes: [[f64; 2]; 2]) -> [f64; 2] {
        let grid = &self.after.grid;
        let (before, after) = (self.before.full(), self.after.full());
        let variance = grid.unfold_even(self.variance.view());
        let spectrum = |[x, _, theta, _]: [f64; 4]| {
            let found = index(&grid.rho, x).zip(index(&grid.nu, theta));
            found.map_or(Complex::from(0.0), |(i, n)| before[[0, i, n]])
        };
        let reach = grid.rho.max() - shift(reflectance);
        let (mut off, mut all, mut noise) = (0.0, 0.0, 0.0);
        for (i, rho) in grid.rho.values().into_iter().enumerate() {
            if index(&grid.rho, rho.abs() + grid.rho.max() - reach).is_none() {
                continue;
            }
            for (n, nu) in grid.nu.values().into_iter().enumerate() {
                let said = semi_convolution(reflectance, axes, [rho, 0.0, nu, 0.0], &spectrum);
                let said = said.expect("Phong lobes with cosines for weights");
                off += (said - after[[0, i, n]]).norm_sqr();
                all += after[[0, i, n]].norm_sqr();
                noise += variance[[0, i, n]];
            }
        }
        [(off - noise).max(0.0), noise].map(|sum| (sum / all).sqrt())
    }
}

/// The index of a frequency on an axis, or `None` beyond its ends.
fn index(axis: &FrequencyAxis, value: f64) -> Option<usize> {
    let values = axis.values();
    values
        .iter()
        .position(|v| (v - value).abs() < 0.01 * axis.spacing)
}

/// The largest spatial frequency of the BRDFs' weights, in cycles per metre.
fn shift(reflectance: &Reflectance) -> f64 {
    let patterns = reflectance.terms.iter().filter_map(|t| t.weight.pattern());
    patterns.fold(0.0, |most, pattern| match pattern {
        Pattern::Cosine(grating) => most.max(grating.frequency),
        _ => most,
    })
}

/// The axes X and Y of the smooth surface, in the coordinates of the planes.
fn axes(scene: &Scene) -> [[f64; 2]; 2] {
    let plane = scene.path.frame.decompose(&scene.planes[1].frame);
    let patch = &scene.patches[0].patch.frame;
    [patch.x, patch.y].map(|axis| [plane.x.dot(axis), plane.y.dot(axis)])
}

/// The section.
pub(super) fn semi(photons: Option<u64>) -> ReportSection {
    let mut scene = changed(SCENE, photons, &[]);
    let [photons, rays] = [Sides::measured(&scene), Sides::of_rays(&scene)];
    let axes = axes(&scene);
    let sound = reflectance(&mut scene).clone();
    let rows = FAULTS.iter().map(|(name, fault)| {
        let mut changed = sound.clone();
        fault(&mut changed);
        let [[by_rays, noise_of_rays], [by_photons, noise]] =
            [&rays, &photons].map(|sides| sides.apart(&changed, axes));
        let is_sound = *name == "none";
        let checks = [(by_rays, noise_of_rays), (by_photons, noise)].map(|(off, noise)| {
            let largest = LARGEST + noise;
            let bound = if is_sound {
                Below(largest)
            } else {
                Above(largest)
            };
            Check::new("off", off, bound).because(WHY)
        });
        let cells =
            [by_rays, noise_of_rays, by_photons, noise].map(|x| format!("{:.3} %", 100.0 * x));
        let cells = [vec![(*name).to_owned()], cells.to_vec()].concat();
        let row = Row::new(cells, checks.to_vec());
        if is_sound {
            row.of(vec![Line::SpaceVarying])
        } else {
            row
        }
    });
    ReportSection::new(
        "The semi-convolution in 4D",
        format!(
            "The operator of Durand et al. 2005, section 4.5, is compared with the spectrum behind \
             a sphere with two lobes; the weight of one lobe is a cosine along x, and the other \
             lobe has the rest of the weight. The operator multiplies the spectrum before the \
             sphere by the transform of each lobe, and convolves the product along Ωx alone with \
             the transform of the lobe's weight. The comparison is on the slice along x, once with \
             both spectra from photons, and once with both from rays through the real geometry; \
             the windows hold all angles. *Off* is ‖operator − behind‖ over ‖behind‖, beyond \
             noise. The operator is of first order, because its lobe depends on differences of \
             angles alone. Required: *off* is less than {:.1} % plus the noise, and with each \
             fault it is more.",
            100.0 * LARGEST
        ),
        "fault | off, rays | noise | off, photons | noise | verdict",
        rows,
    )
}

/// Maximum relative error of a correct operator.
const LARGEST: f64 = 0.002;
const WHY: &str = "with 4 and 8 million photons, 0.11 % and 0.13 % remain beyond noise; the noise \
    varies by less than its own size";

#[cfg(test)]
mod tests {
    use super::semi;

    #[test]
    fn the_operator_holds_and_faults_are_seen() {
        let section = semi(Some(1 << 20));
        assert!(section.passes(), "{}", section.markdown());
    }
}
