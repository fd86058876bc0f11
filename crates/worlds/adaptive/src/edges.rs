//! Computes the radiance of pixels that contain edges of objects or textures. Such a pixel is
//! examined at additional points, which are not stored. Each additional point takes the light of
//! similar stored points.

use crate::criterion::shaded;
use crate::reconstruct::{bell, unlike};
use crate::shading::Shader;
use crate::visible::{FOUR, SeenPlace, SeenSurface, Visible, at, squared_distance};

/// Number of rows and columns of additional points in a pixel.
const FINE: usize = 4;

/// Relative difference of texture factors, or of emission, above which there is an edge between two
/// points.
const DIFFERENCE: f64 = 0.02;

/// Squared difference of normals above which there is an edge between two points.
const TURN: f64 = 0.1;

/// The light at all stored points of the picture; `None` where nothing is shaded.
type Values = [Option<[f64; 2]>];

/// Computes the mean radiance of a pixel. Pixels with an edge are examined only if `shader` is
/// given.
pub(crate) fn radiance(
    visible: &Visible,
    shader: Option<&Shader<'_>>,
    values: &Values,
    pixel: [usize; 2],
) -> f64 {
    let places = visible.of_pixel(pixel);
    let stored = places.iter().zip(&values[visible.range(pixel)]);
    let stored: f64 = stored.map(|(place, value)| light(place, *value)).sum();
    let Some(shader) = shader.filter(|_| has_edge(visible, pixel)) else {
        return stored / FOUR as f64;
    };
    let step = (FINE as f64).recip();
    let further = (0..FINE * FINE).filter_map(|i| {
        let inside = [i % FINE, i / FINE].map(|k| (k as f64 + 0.5) * step);
        let at = [0, 1].map(|k: usize| pixel[k] as f64 + inside[k]);
        let place = shader.place(at);
        let value = match shaded(&place) {
            Some(surface) => Some(like(visible, values, pixel, at, surface)?),
            None => None,
        };
        Some(light(&place, value))
    });
    let (count, sum) = further.fold((FOUR, stored), |(n, sum), light| (n + 1, sum + light));
    sum / count as f64
}

/// The radiance of a point.
fn light(place: &SeenPlace, value: Option<[f64; 2]>) -> f64 {
    match (place.surface, value) {
        (Some(surface), Some(value)) => place.emitted + surface.light(value),
        _ => place.emitted,
    }
}

/// Checks whether the points of a pixel and of its neighbours differ in object, normal, texture or
/// emission.
fn has_edge(visible: &Visible, [column, row]: [usize; 2]) -> bool {
    let [w, h] = visible.size;
    let first = &visible.of_pixel([column, row])[0];
    let beside = [
        [column, row],
        [column.saturating_sub(1), row],
        [(column + 1).min(w - 1), row],
        [column, row.saturating_sub(1)],
        [column, (row + 1).min(h - 1)],
    ];
    let mut places = beside.iter().flat_map(|pixel| visible.of_pixel(*pixel));
    places.any(|place| differs(first, place))
}

/// Checks whether two visible points are on different sides of an edge.
fn differs(first: &SeenPlace, place: &SeenPlace) -> bool {
    let differ = |a: f64, b: f64| (a - b).abs() > DIFFERENCE * a.abs().max(b.abs());
    differ(first.emitted, place.emitted)
        || match (&first.surface, &place.surface) {
            (Some(a), Some(b)) => {
                a.shape != b.shape
                    || (a.normal - b.normal).length_squared() > TURN
                    || (0..2).any(|k| differ(a.factors[k], b.factors[k]))
            }
            (None, None) => false,
            _ => true,
        }
}

/// The mean light of stored points in and around a pixel. Only points on the same object as
/// `surface` count. They are weighted by their similarity to the point `point` of `surface`.
fn like(
    visible: &Visible,
    values: &Values,
    pixel: [usize; 2],
    point: [f64; 2],
    surface: &SeenSurface,
) -> Option<[f64; 2]> {
    let (mut weights, mut sums) = (0.0, [0.0; 2]);
    for near in visible.around(pixel, 1) {
        for (i, index) in visible.range(near).enumerate() {
            let Some((seen, value)) = shaded(&visible.places[index]).zip(values[index]) else {
                continue;
            };
            if seen.shape == surface.shape {
                let square = squared_distance(point, at(near, i));
                // The standard deviation is half a pixel.
                let weight = bell(4.0 * square + unlike(surface, seen));
                weights += weight;
                sums = [0, 1].map(|part: usize| sums[part] + weight * value[part]);
            }
        }
    }
    (weights > 0.0).then(|| sums.map(|sum| sum / weights))
}
