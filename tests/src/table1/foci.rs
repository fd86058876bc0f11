//! Determines the foci of the solar oven from photons alone.

use super::TableRun;
use crate::predicted;
use crate::report::Bound::Below;
use crate::report::{Check, ReportSection, Row};
use etendue_field::{Crossing, PhotonSource, Profile, VirtualPlane, Window};
use etendue_predict::path;
use etendue_scene::{Emission, LightFile, Scene, resolve};
use etendue_trace::Tracer;
use rayon::prelude::*;

/// Beam widths in metres: the width in the scene file, and a width so narrow that the beam's
/// aberration is below the noise.
const WIDTHS: [f64; 2] = [0.1, 1e-5];
/// Maximum deviation in standard errors.
const MOST: f64 = 4.0;

/// Sums of weight, weight · x and weight · x² over the crossings of a plane. The second row
/// contains the same three sums for y.
type CrossingSums = [[f64; 3]; 2];

/// The section on the distances at which the beam is narrowest, in the plane of incidence
/// and perpendicular to this plane.
pub(super) fn foci(outcome: &TableRun) -> ReportSection {
    let theta0: f64 = 0.7;
    let radius = 2.0;
    let known = [0.5 * radius * theta0.cos(), 0.5 * radius / theta0.cos()];
    let mut rows = Vec::new();
    for width in WIDTHS {
        let scene = with_beam(&outcome.scene, width);
        let distances: Vec<f64> = scene.planes.iter().map(|p| scene.path.along(p)).collect();
        let batches = sums(&scene);
        let whole = total(&batches, None);
        let measured = narrowest(&whole, &distances);
        let without: Vec<[f64; 2]> = (0..batches.len())
            .map(|b| narrowest(&total(&batches, Some(b)), &distances))
            .collect();
        let exact = predicted(&scene, &distances);
        for axis in 0..2 {
            let count = without.len() as f64;
            let mean = without.iter().map(|f| f[axis]).sum::<f64>() / count;
            let spread: f64 = without.iter().map(|f| (f[axis] - mean).powi(2)).sum();
            let error = (spread * (count - 1.0) / count).sqrt();
            let off = [exact[axis], known[axis]].map(|f| (measured[axis] - f) / error);
            // A wide beam has an aberration, which the exact prediction includes.
            let narrow = (width - WIDTHS[1]).abs() < 1e-12;
            let within =
                |id, off: f64| Check::new(id, off.abs(), Below(MOST)).because("standard errors");
            let mut checks = vec![within("predicted", off[0])];
            checks.extend(narrow.then(|| within("Coddington", off[1])));
            let cells = vec![
                format!("{width}"),
                ["in the plane of incidence", "across"][axis].to_owned(),
                format!("{:.7} ± {error:.7}", measured[axis]),
                format!("{:.7}", exact[axis]),
                format!("{:+.1} σ", off[0]),
                format!("{:.7}", known[axis]),
                format!("{:+.2e}", measured[axis] - known[axis]),
                format!("{:+.1} σ", off[1]),
            ];
            rows.push(Row::new(cells, checks));
        }
    }
    ReportSection::new(
        "Foci of a hollow mirror at θ₀ = 0.7 (Fig. 11)",
        format!(
            "The mirror has the radius R = 2 m. The photons of `solar_oven` are not aimed at \
             windows, and they are recorded on all planes of the scene. The variance of their \
             positions is a parabola over the distance from the mirror, which is fitted by least \
             squares. The measured focus is the distance at which this parabola is smallest, with \
             its jackknife error over batches. *Predicted* is the same distance for rays that are \
             followed through the geometry. *Coddington* is R cos θ₀/2 or R/(2 cos θ₀), which hold \
             for an infinitely narrow beam. Required: the measured focus is within {MOST} errors \
             of the predicted focus, and for the narrow beam also of Coddington's."
        ),
        "beam [m] | focus | measured [m] | predicted [m] | measured − predicted | Coddington [m] | \
         measured − Coddington [m] | the same in errors | verdict",
        rows,
    )
}

/// # Panics
/// Panics if the scene has no beam.
fn with_beam(scene: &Scene, width: f64) -> Scene {
    let mut file = scene.file.clone();
    let LightFile::Beam { image, .. } = &mut file.light else {
        panic!("a beam");
    };
    image.width = [width; 2];
    file.run.emission = Emission::Plain;
    resolve(&scene.name, file, ".".as_ref(), u64::MAX).expect("the scene was sound")
}

/// Returns, for each batch, the sums over the crossings of each plane.
fn sums(scene: &Scene) -> Vec<Vec<CrossingSums>> {
    let tracer = Tracer::new(scene);
    let batch = |number: u32| {
        let mut sums: Vec<CrossingSums> = vec![CrossingSums::default(); scene.planes.len()];
        let mut record = |plane: usize, crossings: &[Crossing]| {
            for Crossing { ray, weight } in crossings {
                for (sum, x) in sums[plane].iter_mut().zip([ray.x, ray.y]) {
                    *sum = [
                        sum[0] + weight,
                        sum[1] + weight * x,
                        sum[2] + weight * x * x,
                    ];
                }
            }
        };
        tracer.emit(number, &mut record, &|_| ());
        sums
    };
    (0..scene.run.batches).into_par_iter().map(batch).collect()
}

/// The variances of crossings along x and y at each plane, over all batches or over all
/// batches but one.
fn total(batches: &[Vec<CrossingSums>], without: Option<usize>) -> Vec<[f64; 2]> {
    let planes = batches[0].len();
    let variance = |plane: usize| {
        [0, 1].map(|axis: usize| {
            let mut sum = [0.0; 3];
            for (b, batch) in batches.iter().enumerate() {
                if Some(b) != without {
                    let from = batch[plane][axis];
                    for (to, from) in sum.iter_mut().zip(from) {
                        *to += from;
                    }
                }
            }
            sum[2] / sum[0] - (sum[1] / sum[0]).powi(2)
        })
    };
    (0..planes).map(variance).collect()
}

/// The foci predicted by rays.
///
/// # Panics
/// Panics if no light arrives.
fn predicted(scene: &Scene, distances: &[f64]) -> [f64; 2] {
    let all = Profile::Box(10.0);
    let window = Window {
        x: all,
        y: all,
        u: all,
        v: all,
    };
    let variance = |plane: &VirtualPlane| {
        let view = path(scene, plane).expect("a free mirror");
        let found = predicted::traced(&view, &window, &plane.grid);
        let moments = found.covariance.expect("light arrives");
        [moments[0][0], moments[1][1]]
    };
    let variances: Vec<[f64; 2]> = scene.planes.iter().map(variance).collect();
    narrowest(&variances, distances)
}

/// The minima of parabolas fitted to variances.
fn narrowest(variances: &[[f64; 2]], distances: &[f64]) -> [f64; 2] {
    [0, 1].map(|axis: usize| {
        let values: Vec<f64> = variances.iter().map(|v| v[axis]).collect();
        vertex(distances, &values)
    })
}

/// The vertex of the least-squares parabola.
fn vertex(x: &[f64], y: &[f64]) -> f64 {
    let count = x.len() as f64;
    let mean = x.iter().sum::<f64>() / count;
    let power = |n: i32| x.iter().map(|x| (x - mean).powi(n)).sum::<f64>();
    let with = |n: i32| {
        let terms = x.iter().zip(y).map(|(x, y)| (x - mean).powi(n) * y);
        terms.sum::<f64>()
    };
    // The normal equations of the fit, with abscissas of mean zero.
    let [m0, m2, m3, m4] = [count, power(2), power(3), power(4)];
    let [b0, b1, b2] = [with(0), with(1), with(2)];
    // a m0 + c m2 = b0; b m2 + c m3 = b1; a m2 + b m3 + c m4 = b2.
    let c = (b2 - b0 * m2 / m0 - b1 * m3 / m2) / (m4 - m2 * m2 / m0 - m3 * m3 / m2);
    let b = (b1 - c * m3) / m2;
    mean - b / (2.0 * c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertex_of_a_parabola() {
        let x = [0.0, 0.4, 0.7, 1.1, 1.3, 1.7];
        let y = x.map(|x: f64| 0.3 + 2.0 * (x - 0.8).powi(2));
        assert!((vertex(&x, &y) - 0.8).abs() < 1e-13); // rounding
    }
}
