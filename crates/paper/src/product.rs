//! Measures what Fig. 14(e) states: the light that leaves a diffuse surface under an environment
//! has a spectrum that is the product of the spectra of the environment and of the cosine.
//!
//! Positions are arc lengths, as in the paper. In the coordinates of the tangent plane, the area
//! of a patch of the surface is divided by n·N, which cancels the cosine of light from along N.

use crate::scene_run::resolved;
use crate::subject::{FigureData, Text};
use etendue_compare::Residuals;
use etendue_field::{
    Complex, Crossing, Environment, FrequencyAxis, Profile, SliceGrid, TwoPlane, cis,
};
use etendue_pipeline::{Work, method};
use etendue_scene::Scene;
use etendue_spectrum::{mapped_photons, measure};
use etendue_store::{Failure, Method};
use etendue_theory::shading::environment::irradiance;
use etendue_transform::gauss_legendre;
use ndarray::Array3;
use std::f64::consts::{FRAC_PI_2, TAU};

/// A photon whose position x = sin(k s)/k on a cylinder of curvature k is replaced by the arc
/// length s.
fn at_arc_length(crossing: &Crossing, k: f64) -> Crossing {
    Crossing {
        ray: TwoPlane {
            x: libm::asin((k * crossing.ray.x).clamp(-1.0, 1.0)) / k,
            ..crossing.ray
        },
        ..*crossing
    }
}

/// The spectrum of light that leaves a cylinder. It is measured on three arcs, to which the
/// cylinder is turned in turn. The windows of the arcs overlap by half and add up to one window.
#[derive(Debug)]
pub(crate) struct ShadedCylinder {
    curvature: f64,
    arc: Profile,
    environment: Environment,
    rho: FrequencyAxis,
    seed: u64,
    /// The spectrum S at ρ ≥ 0 and ν = 0 of each batch of photons.
    batches: Vec<Vec<Complex>>,
}

/// The centres of the arcs, in half-widths of the window of an arc.
const CENTERS: [f64; 3] = [-1.0, 0.0, 1.0];

/// A light field along the cylinder that would explain the photons.
#[derive(Debug)]
pub(crate) struct Explanation {
    pub(crate) name: &'static str,
    /// F/F(0) at ρ ≥ 0.
    pub(crate) relative: Vec<Complex>,
    /// χ² per degree of freedom, and the p-value of the photons if the explanation is true. Only
    /// the shape of the spectrum is tested, not the size.
    pub(crate) chi2_per_dof: f64,
    pub(crate) p_value: f64,
}

impl ShadedCylinder {
    /// Measures a scene of a cylinder that faces along −Z.
    pub(crate) fn new(taken: &FigureData<'_>, text: &Text) -> Result<Self, Failure> {
        let scene = turned(taken, text, 0.0)?;
        let missing = || Failure::cannot_run(format!("{} is no cylinder in a sky", scene.name));
        let Some(environment) = scene.light.environment() else {
            return Err(missing());
        };
        let curvature = scene.patches.first().ok_or_else(missing)?.patch.curvature[0];
        let plane = scene.planes.first().ok_or_else(missing)?;
        let mut cylinder = Self {
            curvature,
            arc: plane.window.x,
            environment: environment.clone(),
            rho: plane.grid.rho,
            seed: scene.run.seed,
            batches: Vec::new(),
        };
        for center in cylinder.centers() {
            let scene = turned(taken, text, curvature * center)?;
            cylinder.add(taken, &scene, center)?;
        }
        Ok(cylinder)
    }

    /// The arc lengths at the centres of the arcs.
    fn centers(&self) -> [f64; 3] {
        CENTERS.map(|center| center * self.arc.half_width())
    }

    /// Adds the light on an arc.
    fn add(&mut self, taken: &FigureData<'_>, scene: &Scene, center: f64) -> Result<(), Failure> {
        let (source, k) = (method::source(scene, Method::Photons)?, self.curvature);
        let source = mapped_photons(source, move |crossing| at_arc_length(crossing, k));
        let bar = taken.reporter.begin(Work::Photons(scene.run.photons));
        let progress = |photons| bar.advance(photons);
        let found = measure(&*source, &scene.planes, 0..scene.run.batches, &progress);
        self.batches.resize(
            found.batches().len(),
            vec![Complex::default(); self.rho.half + 1],
        );
        for (sum, batch) in self.batches.iter_mut().zip(found.at_plane(0)) {
            let nu = batch.slices.grid.nu.half;
            for (m, sum) in sum.iter_mut().enumerate() {
                let rho = m as f64 * self.rho.spacing;
                *sum += batch.slices.half[[0, m, nu]] * cis(-TAU * rho * center);
            }
        }
        Ok(())
    }

    /// The frequencies ρ ≥ 0.
    pub(crate) fn frequencies(&self) -> Vec<f64> {
        let all = 0..=self.rho.half;
        all.map(|m| m as f64 * self.rho.spacing).collect()
    }

    fn mean(&self) -> Vec<Complex> {
        let sum = |m: usize| self.batches.iter().map(|batch| batch[m]).sum::<Complex>();
        let all = 0..=self.rho.half;
        all.map(|m| sum(m) / self.batches.len() as f64).collect()
    }

    /// S/S(0), and the standard errors of its real and imaginary parts.
    pub(crate) fn measured(&self) -> Vec<(Complex, [f64; 2])> {
        let mean = self.mean();
        let relative: Vec<Complex> = mean.iter().map(|s| s / mean[0]).collect();
        let parts = self.residuals(&relative);
        let count = parts.len() as f64;
        let each = relative.iter().enumerate().map(|(m, value)| {
            let error = |of: fn(Complex) -> f64| {
                let squares = parts.iter().map(|part| of(part[m] / mean[0]).powi(2));
                (squares.sum::<f64>() / (count * (count - 1.0))).sqrt()
            };
            (*value, [error(|z| z.re), error(|z| z.im)])
        });
        each.collect()
    }

    /// S_b − S_b(0) F/F(0) for each batch. The mean over batches is zero if S is
    /// proportional to F.
    fn residuals(&self, relative: &[Complex]) -> Vec<Vec<Complex>> {
        let each = self.batches.iter().map(|batch| {
            let both = batch.iter().zip(relative);
            both.map(|(s, f)| s - batch[0] * f).collect()
        });
        each.collect()
    }

    /// Returns explanations of the photons. The first is the product of the spectra of environment
    /// and cosine.
    pub(crate) fn explanations(&self) -> Result<[Explanation; 4], Failure> {
        let (sky, k) = (&self.environment, self.curvature);
        Ok([
            self.explained("environment × cosine", &irradiance_along(sky, k))?,
            self.explained("window alone", &|_| 1.0)?,
            self.explained("environment alone", &|s| flat(sky, k * s))?,
            self.explained("wrong sign of *k*", &irradiance_along(sky, -k))?,
        ])
    }

    fn explained(
        &self,
        name: &'static str,
        light: &dyn Fn(f64) -> f64,
    ) -> Result<Explanation, Failure> {
        let spectrum = self.windowed(light);
        let relative: Vec<Complex> = spectrum.iter().map(|f| f / spectrum[0]).collect();
        let grid = SliceGrid {
            azimuths: 1,
            rho: self.rho,
            nu: FrequencyAxis {
                half: 0,
                spacing: 1.0,
            },
        };
        let parts = self.residuals(&relative).into_iter();
        let parts = parts.map(|part| Array3::from_shape_vec(grid.half_shape(), part));
        let parts = parts
            .collect::<Result<_, _>>()
            .map_err(Failure::cannot_run)?;
        let residuals = Residuals::of(grid, parts);
        let dark = || Failure::cannot_run("no photon reached the window of Fig. 14(e)");
        let variance = residuals.variance();
        Ok(Explanation {
            name,
            relative,
            chi2_per_dof: residuals.chi2_per_dof(&variance).ok_or_else(dark)?,
            p_value: residuals.p_value(self.seed).ok_or_else(dark)?,
        })
    }

    /// The spectrum of light along the cylinder in the window of all arcs, at ρ ≥ 0.
    fn windowed(&self, light: &dyn Fn(f64) -> f64) -> Vec<Complex> {
        let end = 2.0 * self.arc.half_width();
        let window = |s: f64| self.centers().map(|center| self.arc.value(s - center));
        let field = steps(end).map(|s| (s, light(s) * window(s).iter().sum::<f64>()));
        let field: Vec<(f64, f64)> = field.collect();
        let at = |rho: f64| field.iter().map(|(s, f)| cis(-TAU * rho * s) * *f).sum();
        self.frequencies().into_iter().map(at).collect()
    }
}

/// Returns evenly spaced numbers from −`end` to `end`. Sums over them have errors below 10⁻⁵ where
/// windows end, because windows and spectra fall to zero smoothly.
fn steps(end: f64) -> impl Iterator<Item = f64> {
    const STEPS: i32 = 400;
    (-STEPS..=STEPS).map(move |i| end * f64::from(i) / f64::from(STEPS))
}

/// The radiance of an environment in 2D at the angle θ from the normal −Z towards −X:
/// ∫ L cos² φ dφ over latitudes φ. A cylinder along Y receives ∫ cos θ of it.
fn flat(environment: &Environment, theta: f64) -> f64 {
    let (s, c) = libm::sincos(theta);
    if c <= 0.0 {
        return 0.0; // Light from there would travel against the central ray.
    }
    let term = |(t, weight): (f64, f64)| {
        let (up, across) = libm::sincos(FRAC_PI_2 * t);
        let radiance = environment.radiance([across * s, -up, across * c].into());
        weight * radiance * across * across
    };
    FRAC_PI_2 * gauss_legendre(64).into_iter().map(term).sum::<f64>()
}

/// The irradiance at the arc length s on a cylinder of curvature k, up to a factor: the
/// inverse transform of the product of spectra.
fn irradiance_along(environment: &Environment, k: f64) -> impl Fn(f64) -> f64 {
    /// The lobes of Fig. 14(e) have no power beyond this frequency, in cycles per radian.
    const LAST: f64 = 8.0;
    let nodes = gauss_legendre(200).into_iter();
    let nodes = nodes.map(|(t, weight)| (FRAC_PI_2 * t, weight));
    let nodes: Vec<(f64, f64)> = nodes
        .map(|(theta, weight)| (theta, FRAC_PI_2 * weight * flat(environment, theta)))
        .collect();
    let sky = |omega: f64| -> Complex {
        let terms = nodes
            .iter()
            .map(|(theta, l)| cis(-TAU * omega * theta) * *l);
        terms.sum()
    };
    let spectrum = steps(LAST * k.abs()).map(|rho| (rho, irradiance(k, rho, &sky)));
    let spectrum: Vec<(f64, Complex)> = spectrum.collect();
    move |s| {
        let terms = spectrum.iter().map(|(rho, f)| f * cis(TAU * rho * s));
        terms.sum::<Complex>().re
    }
}

/// The scene with the cylinder turned by an angle, from N towards T.
fn turned(taken: &FigureData<'_>, (name, text): &Text, angle: f64) -> Result<Scene, Failure> {
    let (s, c) = libm::sincos(angle);
    let facing = format!("({:?}, 0, {:?})", -s, -c);
    let set = [("surfaces.0.facing".to_owned(), facing)];
    resolved(name, text, &set, |photons| taken.quality.photons(photons))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quality::Quality;
    use crate::recipe::named;
    use etendue_figures::Style;
    use etendue_pipeline::Silent;

    fn cylinder() -> ShadedCylinder {
        let also = named("14").unwrap().also;
        let taken = FigureData {
            shots: &[],
            also,
            planes: &[],
            quality: Quality::Draft,
            style: Style::default(),
            reporter: &Silent,
        };
        ShadedCylinder::new(&taken, &also[0]).unwrap()
    }

    #[test]
    fn photons_tell_the_product_from_the_window_the_environment_and_the_wrong_sign() {
        let cylinder = cylinder();
        let [product, rejected @ ..] = cylinder.explanations().unwrap();
        assert!(product.p_value > 0.01, "{product:?}"); // the level of the figures' scenes
        for explanation in &rejected {
            // 1/20,000 is the smallest p-value that random signs can give.
            assert!(explanation.p_value < 1e-4, "{explanation:?}");
            assert!(explanation.chi2_per_dof > 100.0, "{explanation:?}"); // far from 1
        }
        // Arrays that are too few or of wrong size would pass as well: photons have errors.
        let found = cylinder.measured();
        assert_eq!(found.len(), cylinder.frequencies().len());
        assert!(
            found[1..]
                .iter()
                .all(|(_, errors)| errors.iter().all(|e| *e > 0.0))
        );
    }

    /// The irradiance is known where one lobe is far narrower than the cosine: it is cos₊ of the
    /// angle to the lobe.
    #[test]
    fn a_narrow_lobe_gives_the_clamped_cosine() {
        let environment = Environment {
            frame: etendue_field::Frame::IDENTITY,
            map: etendue_field::EnvironmentMap::Lobes(vec![etendue_field::SphericalGaussian {
                from: [-libm::sin(0.4), 0.0, -libm::cos(0.4)].into(),
                radiance: 1.0,
                width: 0.1,
            }]),
        };
        let k = 2.0;
        let irradiance = irradiance_along(&environment, k);
        let at = |angle: f64| irradiance(angle / k) / irradiance(0.4 / k);
        for angle in [-0.8, 0.0, 0.9, 1.5] {
            let expected = libm::cos(angle - 0.4);
            assert!((at(angle) - expected).abs() < 1e-3, "{angle}"); // truncation of the spectrum
        }
        assert!(at(2.3).abs() < 1e-3, "no light beyond the horizon"); // truncation of the spectrum
    }
}
