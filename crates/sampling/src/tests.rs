//! Tests of all samplers against their densities, and of planted faults.

use crate::chi_square::{ChiSquare, RectangleCells, SphereCells};
use crate::{
    Cone, DiscreteDistribution, LatLongSampler, about, cosine_hemisphere,
    cosine_hemisphere_density, disc, sphere, triangle,
};
use etendue_field::{LatLong, Raster};
use etendue_transform::random::{self, Stream};
use glam::{DVec2, DVec3};
use std::f64::consts::PI;
use std::sync::Arc;

const SAMPLES: u64 = 100_000;

fn numbers() -> impl Iterator<Item = [f64; 4]> {
    (0..SAMPLES).map(|index| random::words(5, Stream::Photon, index, 0).map(random::unit))
}

/// Compares samples of points in the square from −1 to 1 with a density.
fn in_square(sample: impl Fn([f64; 2]) -> DVec2, density: impl Fn(DVec2) -> f64) -> ChiSquare {
    let cells = RectangleCells::new([[-1.0, 1.0]; 2], [24, 24]);
    let samples = numbers().map(|[a, b, ..]| Some(sample([a, b]).to_array()));
    cells.compare(samples, |point| density(DVec2::from(point)))
}

/// A pole of cells that differs from the axes of all samplers.
const ASIDE: DVec3 = DVec3::new(0.6, -0.48, 0.64);

/// Compares samples of directions with a density, in cells about a pole.
fn on_sphere(
    pole: DVec3,
    sample: impl Fn([f64; 4]) -> DVec3,
    density: impl Fn(DVec3) -> f64,
) -> ChiSquare {
    let directions: Vec<DVec3> = numbers().map(sample).collect();
    for direction in &directions {
        assert!((direction.length() - 1.0).abs() < 1e-12); // rounding
    }
    let cells = SphereCells::new(pole, directions.iter().copied());
    cells.compare(directions.into_iter().map(Some), density)
}

/// The density 1/area within a shape.
fn evenly(area: f64, is_inside: impl Fn(DVec2) -> bool) -> impl Fn(DVec2) -> f64 {
    move |point| if is_inside(point) { 1.0 / area } else { 0.0 }
}

fn in_disc(point: DVec2) -> bool {
    point.length() < 0.9
}

fn in_triangle(point: DVec2) -> bool {
    point.min_element() > 0.0 && point.element_sum() < 1.0
}

/// Returns cones, each with a pole for cells that resolve the cone.
fn cones() -> [(DVec3, Cone); 4] {
    let way = DVec3::new(1.0, 2.0, -1.5);
    [
        (ASIDE, Cone::SPHERE),
        (ASIDE, Cone::new(DVec3::NEG_Z, 0.3)),
        (ASIDE, Cone::around_sphere(way, 0.9 * way.length()).unwrap()),
        (way.normalize(), Cone::around_sphere(way, 0.1).unwrap()),
    ]
}

/// Returns pictures that are bright at a pole and at an edge, where longitude wraps. Some pictures
/// have few rows, and one has a single row.
fn pictures() -> Vec<Arc<LatLong>> {
    let raster = |width, height| {
        let value = |i: usize| match (i % width, i / width) {
            (0, row) if row == height / 3 => 40.0,
            (_, 0) => 5.0,
            (column, row) => (column * row % 7) as f64,
        };
        let values = (0..width * height).map(value).collect();
        Raster::new(width, height, values).unwrap()
    };
    let sizes = [(12, 7), (5, 2), (1, 1), (8, 1)];
    let both = sizes.map(|(width, height)| {
        let raster = raster(width, height);
        [
            LatLong::new(raster.clone()),
            LatLong::from_pole_to_pole(raster),
        ]
        .map(Arc::new)
    });
    both.into_iter().flatten().collect()
}

#[test]
fn points_follow_their_density() {
    let found = in_square(|r| disc(0.9, r), evenly(0.81 * PI, in_disc));
    assert!(found.agrees(), "{found:?}");
    let found = in_square(triangle, evenly(0.5, in_triangle));
    assert!(found.agrees(), "{found:?}");
}

#[test]
fn directions_follow_their_density() {
    let found = on_sphere(ASIDE, |[a, b, ..]| sphere([a, b]), |_| 1.0 / (4.0 * PI));
    assert!(found.agrees(), "{found:?}");
    let found = on_sphere(
        ASIDE,
        |[a, b, ..]| cosine_hemisphere([a, b]),
        cosine_hemisphere_density,
    );
    assert!(found.agrees(), "{found:?}");
    let axis = DVec3::new(0.2, -0.3, -0.9).normalize();
    let found = on_sphere(
        ASIDE,
        |[a, b, ..]| about(axis, cosine_hemisphere([a, b])),
        |d| d.dot(axis).max(0.0) / PI,
    );
    assert!(found.agrees(), "{found:?}");
    for (pole, cone) in cones() {
        let found = on_sphere(pole, |[a, b, ..]| cone.sample([a, b]), |d| cone.density(d));
        assert!(found.agrees(), "{cone:?}: {found:?}");
    }
}

#[test]
fn pictures_are_drawn_by_their_light() {
    for map in pictures() {
        let sampler = LatLongSampler::new(&map);
        let found = on_sphere(ASIDE, |r| sampler.sample(r), |d| sampler.density(d));
        assert!(found.agrees(), "{map:?}: {found:?}");
        for [a, b, ..] in numbers() {
            let direction = sphere([a, b]);
            let (radiance, density) = sampler.radiance_and_density(direction);
            let expected = map.radiance(direction);
            assert!((radiance - expected).abs() <= 1e-12 * expected); // rounding
            assert!(density > 0.0 || radiance <= 0.0, "{map:?}");
        }
    }
}

/// Tests that the weights of samples do not vary much where pixels are small. The reason is that
/// the density is interpolated like the radiance.
#[test]
fn weights_of_pictures_are_bounded() {
    let values = (0..64 * 33).map(|i| if i % 97 == 0 { 100.0 } else { 1.0 });
    let raster = Raster::new(64, 33, values.collect()).unwrap();
    for map in [
        LatLong::new(raster.clone()),
        LatLong::from_pole_to_pole(raster),
    ] {
        let sampler = LatLongSampler::new(&Arc::new(map));
        let weights = numbers().map(|r| {
            let (radiance, density) = sampler.radiance_and_density(sampler.sample(r));
            radiance / density
        });
        let weights: Vec<f64> = weights.collect();
        let mean = weights.iter().sum::<f64>() / weights.len() as f64;
        let squares = weights.iter().map(|w| (w / mean - 1.0).powi(2));
        let deviation = (squares.sum::<f64>() / weights.len() as f64).sqrt();
        // In each row, the deviation is the step of the polar angle divided by its sine.
        assert!(deviation < 0.1, "{deviation}");
    }
}

#[test]
fn things_are_drawn_by_their_weights() {
    let weights = [0.0, 3.0, 0.0, 1.0, 6.0, 0.0];
    let distribution = DiscreteDistribution::new(weights);
    let mut counts = [0.0; 6];
    for [r, ..] in numbers() {
        counts[distribution.sample(r)] += 1.0;
    }
    for (count, weight) in counts.into_iter().zip(weights) {
        let share: f64 = weight / distribution.total();
        let deviation = (share * (1.0 - share) * SAMPLES as f64).sqrt();
        assert!((count - share * SAMPLES as f64).abs() <= 4.5 * deviation);
    }
    let ends = [f64::MIN_POSITIVE, 1.0].map(|r| distribution.sample(r));
    assert_eq!(ends, [1, 4]);
}

/// Tests that the comparison of samples with densities detects each of the planted faults.
#[test]
fn planted_faults_are_seen() {
    let linear = |[a, b]: [f64; 2]| 0.9 * a * DVec2::from_angle(2.0 * PI * b);
    let found = in_square(linear, evenly(0.81 * PI, in_disc));
    assert!(!found.agrees(), "a disc without the square root: {found:?}");
    let found = in_square(
        |[a, b]| DVec2::new(a * (1.0 - b), a * b),
        evenly(0.5, in_triangle),
    );
    assert!(
        !found.agrees(),
        "a triangle without the square root: {found:?}"
    );
    let found = in_square(triangle, evenly(0.505, in_triangle));
    assert!(!found.agrees(), "a density 1 % too small: {found:?}");
    let found = on_sphere(
        ASIDE,
        |[a, b, ..]| cosine_hemisphere([a, b]),
        |d| {
            if d.z > 0.0 { 0.5 / PI } else { 0.0 }
        },
    );
    assert!(!found.agrees(), "no cosine: {found:?}");
    let [_, (_, wide), ..] = cones();
    let wider = Cone::new(DVec3::NEG_Z, 0.29);
    let found = on_sphere(
        ASIDE,
        |[a, b, ..]| wide.sample([a, b]),
        |d| wider.density(d),
    );
    assert!(!found.agrees(), "a wider cone: {found:?}");
    let [area, poles, ..] = &*pictures() else {
        unreachable!("more than two pictures")
    };
    let [area, poles] = [area, poles].map(LatLongSampler::new);
    let found = on_sphere(ASIDE, |r| area.sample(r), |d| poles.density(d));
    assert!(!found.agrees(), "rows shifted by half a pixel: {found:?}");
    let found = on_sphere(
        ASIDE,
        |[a, b, c, d]| area.sample([a, b, d, c.sqrt()]),
        |d| area.density(d),
    );
    assert!(!found.agrees(), "a skewed tent: {found:?}");
}
