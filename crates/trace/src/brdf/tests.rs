//! BRDFs: reciprocity, albedo, and samples against densities.

use super::{densities, density, sample, towards, value};
use etendue_field::{Brdf, Frame, Fresnel, Lobe, Mixture, Reflectance, Term, Weight};
use etendue_transform::random::{self, Stream};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

const SAMPLES: u32 = 200_000;
/// Cells of a sphere around the mirror direction: by the angle to it, with equal shares of samples but for the last, and around it.
const SHARES: usize = 16;
const SECTORS: usize = 12;
/// Points of the midpoint rule along a side of a cell.
const FINE: u32 = 32;

/// Angles of incidence, up to grazing.
const ANGLES: [f64; 4] = [0.0, 0.6, 1.2, 1.5];

fn brdf(lobe: Lobe) -> Brdf {
    Brdf::new(lobe, 1.0, Fresnel::White)
}

fn phong(exponent: f64) -> Brdf {
    brdf(Lobe::Phong { exponent })
}

fn beckmann(roughness: f64) -> Brdf {
    brdf(Lobe::Beckmann { roughness })
}

fn ggx(roughness: f64) -> Brdf {
    brdf(Lobe::Ggx { roughness })
}

/// Every lobe, narrow and wide.
fn lobes() -> Vec<Brdf> {
    let mut lobes = vec![
        brdf(Lobe::Lambertian),
        phong(0.0),
        phong(1.0),
        phong(30.0),
        phong(1e4),
    ];
    for roughness in [0.01, 0.1, 0.5, 1.0] {
        lobes.extend([beckmann(roughness), ggx(roughness)]);
    }
    lobes
}

fn at(angle: f64) -> DVec3 {
    DVec3::new(
        libm::sin(angle) * 0.8,
        libm::sin(angle) * 0.6,
        libm::cos(angle),
    )
}

fn around(given: DVec3) -> Frame {
    Frame::IDENTITY.turned_to(DVec3::new(-given.x, -given.y, given.z))
}

fn pairs() -> impl Iterator<Item = [f64; 2]> {
    (0..u64::from(SAMPLES)).map(|index| {
        let r = random::words(5, Stream::Photon, index, 0).map(random::unit);
        [r[0], r[1]]
    })
}

/// Edges of rings that hold equal shares of what is sampled.
fn edges(brdf: &Brdf, given: DVec3) -> Vec<f64> {
    let pole = around(given);
    let angle = |d: DVec3| d.angle_between(pole.d);
    let mut angles: Vec<f64> = pairs().map(|r| angle(sample(brdf, given, r))).collect();
    angles.sort_by(f64::total_cmp);
    let mut edges = vec![0.0];
    edges.extend((1..SHARES).map(|i| angles[i * angles.len() / SHARES]));
    // The tail, and the end of Phong's lobe, where its density may jump.
    edges.extend([255, 4095].map(|i| angles[i * angles.len() / (i + 1)]));
    edges.extend([0.5 * PI, PI]);
    edges.sort_by(f64::total_cmp);
    edges
}

/// ∫ f dω over each cell.
fn integrals(edges: &[f64], given: DVec3, f: impl Fn(DVec3) -> f64) -> Vec<f64> {
    let pole = around(given);
    let mut cells = Vec::new();
    for ring in edges.windows(2) {
        for sector in 0..SECTORS {
            let step = [ring[1] - ring[0], TAU / SECTORS as f64].map(|x| x / f64::from(FINE));
            let mut sum = 0.0;
            for i in 0..FINE {
                for j in 0..FINE {
                    let angle = ring[0] + (f64::from(i) + 0.5) * step[0];
                    let turn =
                        sector as f64 * TAU / SECTORS as f64 + (f64::from(j) + 0.5) * step[1];
                    let local = DVec3::new(
                        libm::sin(angle) * libm::cos(turn),
                        libm::sin(angle) * libm::sin(turn),
                        libm::cos(angle),
                    );
                    sum += f(pole.vector_to_world(local)) * libm::sin(angle);
                }
            }
            cells.push(sum * step[0] * step[1]);
        }
    }
    cells
}

/// χ² of samples against a density, its degrees of freedom, and the density's whole integral.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the number of a sector"
)]
fn chi2(
    edges: &[f64],
    given: DVec3,
    samples: impl Fn([f64; 2]) -> DVec3,
    density: impl Fn(DVec3) -> f64,
) -> [f64; 3] {
    let pole = around(given);
    let rings = edges.len() - 1;
    let mut counts = vec![0.0; rings * SECTORS];
    for r in pairs() {
        let local = pole.vector_to_local(samples(r));
        let angle = local.angle_between(DVec3::Z);
        let ring = edges[1..rings].partition_point(|edge| *edge <= angle);
        let turn = libm::atan2(local.y, local.x).rem_euclid(TAU) / TAU;
        let sector = ((turn * SECTORS as f64) as usize).min(SECTORS - 1);
        counts[ring * SECTORS + sector] += 1.0;
    }
    let shares = integrals(edges, given, density);
    let total: f64 = shares.iter().sum();
    let (mut chi2, mut cells) = (0.0, 0.0);
    // Cells with little in them are put together.
    let (mut rest, mut rest_expected) = (0.0, 0.0);
    for (count, share) in counts.iter().zip(&shares) {
        let expected = share * f64::from(SAMPLES);
        if expected > 20.0 {
            chi2 += (count - expected) * (count - expected) / expected;
            cells += 1.0;
        } else {
            rest += count;
            rest_expected += expected;
        }
    }
    if rest_expected > 5.0 {
        chi2 += (rest - rest_expected) * (rest - rest_expected) / rest_expected;
        cells += 1.0;
    }
    [chi2, cells, total]
}

/// Four and a half standard deviations of χ²: passed in one test of 300,000.
fn bound(cells: f64) -> f64 {
    cells + 4.5 * (2.0 * cells).sqrt()
}

#[test]
fn samples_follow_their_density_and_it_integrates_to_one() {
    for of in lobes() {
        for angle in ANGLES {
            let given = at(angle);
            let edges = edges(&of, given);
            let found = chi2(
                &edges,
                given,
                |r| sample(&of, given, r),
                |d| density(&of, given, d),
            );
            let [chi2, cells, total] = found;
            assert!(
                chi2 < bound(cells),
                "{of:?} at {angle}: χ² {chi2} in {cells} cells"
            );
            // Midpoint rule over some 200 cells of 32 × 32; the widest are cut by edges of the density.
            assert!(
                (total - 1.0).abs() < 3e-3,
                "{of:?} at {angle}: integral {total}"
            );
        }
    }
}

/// Three lobes of unequal albedos: the ring edges are those of the widest about the mirror direction.
#[test]
fn samples_of_a_sum_follow_its_density() {
    let term = |brdf: Brdf, albedo: f64| Term {
        brdf: Brdf { albedo, ..brdf },
        weight: Weight::One,
    };
    let sum = |albedos: [f64; 3]| Reflectance {
        terms: vec![
            term(phong(30.0), albedos[0]),
            term(brdf(Lobe::Lambertian), albedos[1]),
            term(ggx(0.3), albedos[2]),
        ],
        texture: None,
    };
    let reflectance = sum([0.5, 0.3, 0.1]);
    let of = reflectance.at(0.0, 0.0);
    let swapped = sum([0.3, 0.5, 0.1]);
    for angle in ANGLES {
        let given = at(angle);
        let edges = edges(&ggx(0.3), given);
        let against = |mixture: &Mixture<'_>| {
            let density = |d| densities(mixture, given, d);
            chi2(&edges, given, |r| towards(&of, given, r), density)
        };
        let [found, cells, total] = against(&of);
        assert!(found < bound(cells), "{angle}: χ² {found} in {cells} cells");
        // Midpoint rule, as above; the horizon cuts cells in which the cosine has a corner.
        assert!((total - 1.0).abs() < 3e-3, "{angle}: integral {total}");
        let [fault, cells, _] = against(&swapped.at(0.0, 0.0));
        assert!(
            fault > 1.5 * bound(cells),
            "{angle}: shares swapped: χ² {fault}"
        );
    }
}

/// The test above sees each of these.
#[test]
fn planted_faults_are_seen() {
    let given = at(0.6);
    let seen = |what: &str, of: &Brdf, faulty: &dyn Fn(DVec3) -> f64| {
        let edges = edges(of, given);
        let [chi2, cells, _] = chi2(&edges, given, |r| sample(of, given, r), faulty);
        assert!(
            chi2 > 1.5 * bound(cells),
            "{what}: χ² {chi2} in {cells} cells"
        );
    };
    for (of, other) in [(beckmann(0.5), beckmann(0.25)), (ggx(0.5), ggx(0.25))] {
        seen("α² for α", &of, &|d| density(&other, given, d));
        let jacobian = |d: DVec3| 4.0 * (given + d).normalize().dot(given);
        seen("no Jacobian", &of, &|d| {
            density(&of, given, d) * jacobian(d)
        });
    }
    let of = phong(30.0);
    let about_normal = |d: DVec3| density(&of, DVec3::Z, d);
    seen("lobe around the normal", &of, &about_normal);
    seen("exponent off by 5 %", &of, &|d| {
        density(&phong(31.5), given, d)
    });
    let by_area = |d: DVec3| density(&of, given, d) * d.z.max(0.0);
    seen("a cosine too many", &of, &by_area);
}

/// ∫ f cos θ dω by quadrature, and by samples with its standard error.
fn albedos(of: &Brdf, angle: f64) -> [f64; 3] {
    let given = at(angle);
    let edges = edges(of, given);
    let cells = integrals(&edges, given, |d| value(of, given, d) * d.z);
    let (mut sum, mut squares) = (0.0, 0.0);
    for r in pairs() {
        let d = sample(of, given, r);
        let carried = value(of, given, d) * d.z;
        if carried > 0.0 {
            let weight = carried / density(of, given, d);
            sum += weight;
            squares += weight * weight;
        }
    }
    let n = f64::from(SAMPLES);
    let mean = sum / n;
    [
        cells.iter().sum(),
        mean,
        ((squares / n - mean * mean).max(0.0) / n).sqrt(),
    ]
}

#[test]
fn white_furnace() {
    for of in lobes() {
        for angle in ANGLES {
            let [exact, mean, error] = albedos(&of, angle);
            // Four and a half standard errors, and the midpoint rule as above.
            let most = 4.5 * error + 1e-3;
            assert!(
                (mean - exact).abs() < most,
                "{of:?} at {angle}: {mean} ± {error}, {exact}"
            );
            assert!(
                exact < 1.0 + 1e-3,
                "{of:?} at {angle}: {exact} of 1 is reflected"
            );
            match of.lobe {
                // Each sample weighs π · 1/π.
                Lobe::Lambertian => assert!((mean - 1.0).abs() < 1e-12, "{mean}"),
                // What is lost to shadows grows with (α tan θ)², here at most 0.02.
                Lobe::Beckmann { roughness } | Lobe::Ggx { roughness } if roughness < 0.02 => {
                    assert!(mean > 0.98, "{of:?} at {angle}: {mean}");
                }
                _ => {}
            }
        }
    }
}

/// The weights of a sample, without Fresnel factor: what a narrow lobe must not make large.
#[test]
fn weights_are_bounded() {
    for of in lobes() {
        for angle in ANGLES {
            let given = at(angle);
            let weights = pairs().map(|r| {
                let d = sample(&of, given, r);
                value(&of, given, d) * d.z.max(0.0) / density(&of, given, d)
            });
            let most = weights.fold(0.0, f64::max);
            // Beckmann's normals are drawn whether they are seen or not: h·ωi/(cos θi cos θh) is left, and G₁ ≤ 2√π/(α tan θi)
            // bounds it by 3.5 tan θh/α; of 32-bit numbers tan θh/α is at most 4.8.
            let bound = if matches!(of.lobe, Lobe::Beckmann { .. }) {
                17.0
            } else {
                1.0 + 1e-9
            };
            assert!(most < bound, "{of:?} at {angle}: {most}");
        }
    }
}

#[test]
fn reciprocity_where_there_is_one() {
    let glass = Fresnel::Dielectric { index: 1.5 };
    for of in lobes() {
        let is_micro = matches!(of.lobe, Lobe::Beckmann { .. } | Lobe::Ggx { .. });
        for fresnel in [Fresnel::White, glass] {
            let of = Brdf {
                fresnel,
                ..of.clone()
            };
            let (a, b) = (at(1.3), DVec3::new(-0.6, -0.3, 0.5).normalize());
            let [there, back] = [value(&of, a, b), value(&of, b, a)];
            let same = (there - back).abs() <= 1e-9 * there; // rounding, in the exponent of a narrow lobe
            let expected = is_micro || fresnel == Fresnel::White || there == 0.0;
            assert_eq!(same, expected, "{of:?}: {there} and {back}");
        }
    }
}

#[test]
fn nothing_behind_the_surface() {
    for of in lobes() {
        let (front, behind) = (at(0.3), -at(0.4));
        assert!(value(&of, behind, front) <= 0.0 && value(&of, front, behind) <= 0.0);
    }
}
