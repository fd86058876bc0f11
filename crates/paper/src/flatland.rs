//! Diffuse shading in flatland. A light, strips and a receiver are on parallel lines, as in Fig. 6
//! of Durand et al. 2005.

use etendue_field::{Complex, FrequencyAxis, Light, Profile, Shape, VirtualPlane, cis, sinc};
use etendue_scene::{BlockersFile, Scene};
use etendue_store::Failure;
use ndarray::Array2;
use std::f64::consts::TAU;

/// A light of radiance 1, opaque strips and a white diffuse receiver on parallel lines in 2D.
/// Lengths are in metres.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Flatland {
    /// Half the width of the light, which is centred at 0.
    half_light: f64,
    /// Distance from the light to the strips.
    to_strips: f64,
    /// The strips, [from, to], in ascending order and without overlap.
    strips: Vec<[f64; 2]>,
    /// Distance from the light to the receiver, which is beyond the strips.
    to_receiver: f64,
}

/// Steps of diffuse shading (Durand et al. 2005, Fig. 6).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum DiffuseStep {
    /// Step 1: the light field at the light.
    Emission,
    /// Step 2: the light field after travel, before the strips.
    Travel,
    /// Step 3: the light field behind the strips.
    Visibility,
    /// Step 4: the light field after travel to the receiver.
    SecondTravel,
    /// Step 5: differential irradiance, the light field times g(v) = (1 + v²)^(−3/2).
    Cosine,
    /// Step 6: the light that leaves the receiver, ½ ∫ ℓ g dv.
    Reflection,
}

impl DiffuseStep {
    /// All steps, in order.
    pub(crate) const ALL: [Self; 6] = [
        Self::Emission,
        Self::Travel,
        Self::Visibility,
        Self::SecondTravel,
        Self::Cosine,
        Self::Reflection,
    ];
}

/// Number of nodes of the midpoint rule over slopes, or over positions on the receiver. Edges cause
/// kinks in the integrand, and these kinks cause a relative error of 10⁻⁵.
const NODES: usize = 1024;

impl Flatland {
    /// Takes widths along X and distances along the central ray from a scene. The scene must have a
    /// rectangular light, one array of squares and a floor.
    pub(crate) fn of(scene: &Scene) -> Result<Self, Failure> {
        let missing = || Failure::cannot_run(format!("{} has no flatland version", scene.name));
        let Light::Area {
            shape: Shape::Rectangle(light),
            ..
        } = &scene.light
        else {
            return Err(missing());
        };
        let array = scene.file.blockers.first();
        let Some(BlockersFile::JitteredSquares {
            count, pitch, fill, ..
        }) = array
        else {
            return Err(missing());
        };
        let layer = scene.blockers.first().ok_or_else(missing)?;
        let floor = scene.path.legs.first().ok_or_else(missing)?;
        let middle = 0.5 * (f64::from(count[0]) - 1.0);
        let strips = (0..count[0]).map(|i| {
            let center = (f64::from(i) - middle) * pitch;
            [center - 0.5 * fill * pitch, center + 0.5 * fill * pitch]
        });
        Ok(Self {
            half_light: 0.5 * light.size[0],
            to_strips: layer.distance,
            strips: strips.collect(),
            to_receiver: floor.length,
        })
    }

    /// |S|² of a step as an array [ρ, ν], in the window and at the frequencies of a plane.
    pub(crate) fn power(&self, step: DiffuseStep, plane: &VirtualPlane) -> Array2<f64> {
        let window = [&plane.window.x, &plane.window.u];
        let spectrum = self.spectrum(step, window, [&plane.grid.rho, &plane.grid.nu]);
        spectrum.mapv(|s| s.norm_sqr())
    }

    /// The spectrum of the windowed light field after a step, as an array [ρ, ν] with
    /// ascending ρ and ν. The profiles and axes are for x and v.
    ///
    /// The integral over positions is in closed form, and the integral over slopes is a midpoint
    /// rule that is accurate to 10⁻⁵ of the value at zero frequency.
    fn spectrum(
        &self,
        step: DiffuseStep,
        [along_x, along_v]: [&Profile; 2],
        [rho, nu]: [&FrequencyAxis; 2],
    ) -> Array2<Complex> {
        if step == DiffuseStep::Reflection {
            return self.leaving([along_x, along_v], [rho, nu]);
        }
        let positions = rho.values();
        let rows = midpoints(along_v).map(|(v, dv)| {
            let cosine = match step {
                DiffuseStep::Cosine => libm::pow(1.0 + v * v, -1.5),
                _ => 1.0,
            };
            let weight = along_v.value(v) * cosine * dv;
            let seen = self.seen(step, v);
            let each = positions.iter().map(|rho| {
                let parts = seen.iter().map(|part| windowed(along_x, *part, *rho));
                parts.sum::<Complex>() * weight
            });
            (v, each.collect::<Vec<_>>())
        });
        product(rows, [rho, nu])
    }

    /// The intervals of positions that light of slope v reaches.
    fn seen(&self, step: DiffuseStep, v: f64) -> Vec<[f64; 2]> {
        let distance = match step {
            DiffuseStep::Emission => 0.0,
            DiffuseStep::Travel | DiffuseStep::Visibility => self.to_strips,
            _ => self.to_receiver,
        };
        let beam = [-self.half_light, self.half_light].map(|edge| edge + v * distance);
        if matches!(step, DiffuseStep::Emission | DiffuseStep::Travel) {
            return vec![beam];
        }
        let moved = v * (distance - self.to_strips);
        let strips = self.strips.iter();
        open(beam, strips.map(|strip| strip.map(|edge| edge + moved)))
    }

    /// Returns ½ ∫ ℓ g dv at a position of the receiver. For each visible part of the light, this
    /// is half of the difference between the sines of its bounding angles.
    fn radiosity(&self, x: f64) -> f64 {
        let below = self.to_receiver - self.to_strips;
        let light = [self.half_light, -self.half_light];
        let light = light.map(|edge| (x - edge) / self.to_receiver);
        let strips = self.strips.iter().rev();
        let strips = strips.map(|[from, to]| [(x - to) / below, (x - from) / below]);
        let sine = |v: f64| v / libm::sqrt(1.0 + v * v);
        let parts = open(light, strips).into_iter();
        0.5 * parts.map(|[low, high]| sine(high) - sine(low)).sum::<f64>()
    }

    fn leaving(
        &self,
        [along_x, along_v]: [&Profile; 2],
        [rho, nu]: [&FrequencyAxis; 2],
    ) -> Array2<Complex> {
        // The light that leaves the receiver is the same in all directions, so the spectrum is a
        // product.
        let half = along_v.half_width();
        let angular = nu.values().into_iter();
        let angular: Vec<Complex> = angular
            .map(|nu| windowed(along_v, [-half, half], nu))
            .collect();
        let spatial = rho.values().into_iter().map(|rho| {
            let nodes = midpoints(along_x);
            let values = nodes
                .map(|(x, dx)| cis(-TAU * rho * x) * (along_x.value(x) * self.radiosity(x) * dx));
            values.sum::<Complex>()
        });
        let spatial: Vec<Complex> = spatial.collect();
        Array2::from_shape_fn((spatial.len(), angular.len()), |(i, j)| {
            spatial[i] * angular[j]
        })
    }
}

/// The parts of an interval that the given intervals, in ascending order, do not cover.
fn open([from, to]: [f64; 2], intervals: impl Iterator<Item = [f64; 2]>) -> Vec<[f64; 2]> {
    let mut parts = Vec::new();
    let mut low = from;
    for [start, end] in intervals {
        if start.min(to) > low {
            parts.push([low, start.min(to)]);
        }
        low = low.max(end);
    }
    if to > low {
        parts.push([low, to]);
    }
    parts
}

/// Nodes and weights of the midpoint rule within a profile.
fn midpoints(profile: &Profile) -> impl Iterator<Item = (f64, f64)> {
    let half = profile.half_width();
    let step = 2.0 * half / NODES as f64;
    (0..NODES).map(move |i| ((i as f64 + 0.5) * step - half, step))
}

/// ∫ W(t) e^(−2πi Ω t) dt over an interval. The integral has a closed form, because the
/// profile is a sum of cosines.
fn windowed(profile: &Profile, [from, to]: [f64; 2], omega: f64) -> Complex {
    let half = profile.half_width();
    let (from, to) = (from.max(-half), to.min(half));
    if from >= to {
        return Complex::default();
    }
    let (middle, size) = (0.5 * (from + to), to - from);
    let wave = |omega: f64| cis(-TAU * omega * middle) * (size * sinc(omega * size));
    let terms = profile.cosine_terms().into_iter();
    terms
        .map(|term| {
            let both = wave(omega - term.frequency) + wave(omega + term.frequency);
            both * (0.5 * term.weight)
        })
        .sum()
}

/// A sum over slopes v for each ρ and ν. Each summand is a value for ρ and v, times e^(−2πi
/// ν v).
fn product(
    rows: impl Iterator<Item = (f64, Vec<Complex>)>,
    [rho, nu]: [&FrequencyAxis; 2],
) -> Array2<Complex> {
    let mut sum = Array2::zeros((rho.count(), nu.count()));
    let frequencies = nu.values();
    for (v, row) in rows {
        let each = frequencies.iter();
        let waves: Vec<Complex> = each.map(|nu| cis(-TAU * nu * v)).collect();
        for (value, mut along) in row.iter().zip(sum.outer_iter_mut()) {
            for (sum, wave) in along.iter_mut().zip(&waves) {
                *sum += value * wave;
            }
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_field::{Mask, Rectangle, Window};
    use etendue_theory::{Chain, Operator, Source, at, g_hat};

    const STRIPS: [[f64; 2]; 3] = [[-0.31, -0.19], [-0.06, 0.06], [0.19, 0.27]];
    /// A length greater than the width of any window.
    const ENDLESS: f64 = 1e3;

    fn flatland() -> Flatland {
        Flatland {
            half_light: 0.1,
            to_strips: 1.0,
            strips: STRIPS.to_vec(),
            to_receiver: 1.8,
        }
    }

    fn axis(half: usize, spacing: f64) -> FrequencyAxis {
        FrequencyAxis { half, spacing }
    }

    #[test]
    fn steps_are_slices_of_scenes_that_do_not_vary_across() {
        let endless = |[from, to]: [f64; 2]| Rectangle {
            center: [0.5 * (from + to), 0.0],
            size: [to - from, ENDLESS],
        };
        let mask = || Operator::Visibility {
            name: "strips".into(),
            mask: Mask::Opaque {
                shapes: STRIPS
                    .map(|strip| Shape::Rectangle(endless(strip)))
                    .to_vec(),
                half_planes: vec![],
            },
        };
        let travel = |distance: f64| Operator::Travel {
            from: "here".into(),
            to: "there".into(),
            distance,
        };
        let light = Light::Area {
            shape: Shape::Rectangle(endless([-0.1, 0.1])),
            radiance: 1.0,
            exponent: 0.0,
        };
        let source = Source {
            name: "light".into(),
            light,
        };
        let [x, u] = [Profile::Hann(0.5), Profile::Hann(0.4)];
        let (rho, nu) = (axis(4, 2.3), axis(4, 3.1));
        let cases = [
            (DiffuseStep::Travel, vec![travel(1.0)]),
            (DiffuseStep::Visibility, vec![travel(1.0), mask()]),
            (
                DiffuseStep::SecondTravel,
                vec![travel(1.0), mask(), travel(0.8)],
            ),
        ];
        let window = Window { x, y: x, u, v: u };
        for (step, operators) in cases {
            let found = flatland().spectrum(step, [&x, &u], [&rho, &nu]);
            let solid = Chain {
                source: source.clone(),
                operators,
            };
            let solid = |[rho, nu]: [f64; 2]| at(&solid, &window, [rho, 0.0, nu, 0.0]);
            let scale = found[[4, 4]] / solid([0.0; 2]);
            for ((i, j), value) in found.indexed_iter() {
                let expected = scale * solid([rho.value(i), nu.value(j)]);
                let off = (value - expected).norm() / found[[4, 4]].norm();
                assert!(off < 1e-5, "{step:?}: {off:e}"); // the midpoint rule
            }
        }
    }

    #[test]
    fn the_cosine_convolves_with_its_transform() {
        let [x, u] = [Profile::Hann(0.5), Profile::Hann(0.4)];
        let (rho, nu) = (axis(1, 3.0), axis(600, 0.05));
        let before = flatland().spectrum(DiffuseStep::SecondTravel, [&x, &u], [&rho, &nu]);
        let after = flatland().spectrum(DiffuseStep::Cosine, [&x, &u], [&rho, &nu]);
        for j in [540, 600, 640] {
            let terms = (0..nu.count()).map(|k| before[[2, k]] * g_hat(nu.value(j) - nu.value(k)));
            let convolved = terms.sum::<Complex>() * nu.spacing;
            let off = (after[[2, j]] - convolved).norm() / after[[1, 600]].norm();
            assert!(off < 2e-4, "{off:e}"); // frequencies end at 30, where a Hann window has 10⁻⁴
            let off = (after[[2, j]] - before[[2, j]]).norm() / after[[1, 600]].norm();
            assert!(j != 600 || off > 1e-3, "the cosine counts"); // 12 % at slope 0.3
        }
    }

    #[test]
    fn reflection_is_half_the_line_of_space() {
        // The window contains all light.
        let [x, u] = [Profile::Hann(0.5), Profile::Box(0.5)];
        let (rho, nu) = (axis(5, 1.7), axis(1, 0.7));
        let cosine = flatland().spectrum(DiffuseStep::Cosine, [&x, &u], [&rho, &nu]);
        let leaving = flatland().spectrum(DiffuseStep::Reflection, [&x, &u], [&rho, &nu]);
        for i in 0..rho.count() {
            // ∫ W dv is 1.
            let off = (leaving[[i, 1]] - cosine[[i, 1]] * 0.5).norm();
            assert!(off < 1e-5 * leaving[[5, 1]].norm(), "{off:e}"); // the midpoint rule
        }
    }
}
