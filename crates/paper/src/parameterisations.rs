//! Draws Fig. 8: the spectrum at the receiver over slopes, the spectrum over angles, and the
//! difference of both.

use crate::rows::{feet, lettered};
use crate::subject::FigureData;
use etendue_compare::{Bandwidth, PlaneComparison};
use etendue_field::{Orientation, Slices, percent, uncertain};
use etendue_figures::{Figure, Plate};
use etendue_report::pictures::{Seen, spectra};
use etendue_report::table::off_by;
use etendue_store::Failure;
use ndarray::{Array2, Axis};

/// Draws Fig. 8: slopes and angles at the receiver. The first-order chain treats slopes as angles.
/// The paper states that treating slopes as angles causes no significant error.
pub(crate) fn parameterisations(taken: &FigureData<'_>) -> Result<Figure, Failure> {
    let slopes = taken.shots[0].at("slopes")?;
    let angles = taken.shots[0].at("angles")?;
    let measured = panels(
        [&slopes.found.measured, &angles.found.measured],
        [&slopes.found.radial.power, &angles.found.radial.power],
    );
    let predicted = panels(
        [&slopes.found.predicted, &angles.found.predicted],
        [
            &slopes.found.predicted_radial,
            &angles.found.predicted_radial,
        ],
    );
    let planes = [&slopes, &angles, &slopes];
    let rows = [("measured", &measured), ("predicted", &predicted)].map(|(name, panels)| {
        let both = planes.iter().zip(panels);
        spectra(
            name,
            true,
            both.map(|(seen, power)| seen.spectrum(power.view())),
        )
    });
    let mut feet = feet(&[slopes, angles]);
    for (foot, seen) in feet.iter_mut().zip([&slopes, &angles]) {
        foot.extend(bandwidths(seen));
    }
    feet.push(off(&angles));
    let mut figure = taken.plate(&Plate {
        title: "Two parameterisations",
        note: "*ρ* runs along X in all panels. The difference is the mean of |*S*_{θ} − *S*_{u}|^{2} over azimuths, with each frequency of (b) at its place in (a). *B*: 95 % bandwidths in the azimuth where they are largest.",
        heads: lettered(&["by slopes *u*", "by angles *θ*", "difference"]),
        rows: rows.into(),
        feet,
        ..Plate::default()
    })?;
    // The pictures of the first row are measured; the last of them is the difference.
    figure.pictures[2].sigma = Some(difference_error(slopes.found, angles.found));
    Ok(figure)
}

/// The radial spectra over slopes and over angles, with ρ along X, and their difference.
fn panels(
    [slopes, angles]: [&Slices; 2],
    [by_slopes, by_angles]: [&Array2<f64>; 2],
) -> [Array2<f64>; 3] {
    let mut along_x = by_angles.clone();
    along_x.invert_axis(Axis(0));
    [by_slopes.clone(), along_x, difference(slopes, angles)]
}

/// |S_θ − S_u|², averaged over azimuths, as an array [ρ, ν] with ρ along X. S_θ is the
/// spectrum over angles, and S_u is the spectrum over slopes.
fn difference(slopes: &Slices, angles: &Slices) -> Array2<f64> {
    let [by_slopes, by_angles] = [slopes, angles].map(Slices::full);
    over_azimuths(by_slopes.dim(), |here, there| {
        (by_slopes[here] - by_angles[there]).norm_sqr()
    })
}

/// The standard error of [`difference`]: the noise v = σ_θ² + σ_u² changes |D|² with the
/// variance 2 |D|² v + v². The planes share photons, whose noise partly cancels in D, so this is an
/// upper bound. Azimuths are taken as independent.
fn difference_error(slopes: &PlaneComparison, angles: &PlaneComparison) -> Array2<f64> {
    let [by_slopes, by_angles] = [slopes, angles].map(|of| of.measured.full());
    let [slope_noise, angle_noise] = [slopes, angles].map(|of| {
        let sigma = of.measured_sigma.as_ref().unwrap_or(&of.sigma);
        of.measured.grid.unfold_even(sigma.view())
    });
    let azimuths = by_slopes.dim().0 as f64;
    let variance = over_azimuths(by_slopes.dim(), |here, there| {
        let noise = slope_noise[here].powi(2) + angle_noise[there].powi(2);
        let square = (by_slopes[here] - by_angles[there]).norm_sqr();
        2.0 * square * noise + noise * noise
    });
    variance.mapv(|v| (v / azimuths).sqrt())
}

/// Returns means over azimuths of a function of a cell over slopes and of the same cell over
/// angles.
///
/// The axis T of the surface is opposite to X, and its axis B is Y. Angles describe the direction
/// from which light comes. Therefore the value over slopes at (ρ, ν) and azimuth φ is the value
/// over angles at (−ρ, ν) and azimuth −φ, or at (ρ, −ν) and azimuth π − φ.
fn over_azimuths(
    (azimuths, columns, rows): (usize, usize, usize),
    of: impl Fn([usize; 3], [usize; 3]) -> f64,
) -> Array2<f64> {
    Array2::from_shape_fn((columns, rows), |(i, j)| {
        let each = (0..azimuths).map(|k| {
            let same = match k {
                0 => [0, columns - 1 - i, j],
                _ => [azimuths - k, i, rows - 1 - j],
            };
            of([k, i, j], same)
        });
        each.sum::<f64>() / azimuths as f64
    })
}

/// The norm of the difference divided by the norm of the spectrum.
fn off(angles: &Seen<'_>) -> Vec<String> {
    let Some(first_order) = &angles.found.report.first_order else {
        return Vec::new();
    };
    vec![
        "of the spectrum:".to_owned(),
        format!("{} measured", off_by(first_order)),
        format!("{} computed", percent(first_order.chain.error, 2)),
    ]
}

/// The 95 % bandwidths of a plane.
fn bandwidths(seen: &Seen<'_>) -> Vec<String> {
    let Bandwidth { rho, nu } = &seen.found.report.bandwidth_95;
    let angular = ["slope", "rad"][usize::from(seen.plane.orientation == Orientation::Tangent)];
    let both = [("ρ", "m", rho), ("ν", angular, nu)].into_iter();
    let lines = both.filter_map(|(axis, unit, pair)| {
        let found = uncertain(pair.measured?, pair.error?);
        let predicted = pair.predicted.map_or("–".to_owned(), |p| format!("{p:.3}"));
        Some([
            format!("*B*_{{{axis}}} {found} /{unit}"),
            format!("predicted {predicted}"),
        ])
    });
    lines.flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recipe::named;
    use etendue_predict::Applicability;
    use etendue_predict::predict;

    /// The difference of the two planes is the error of the chain, which treats u as θ. The
    /// difference would be as large as the spectra if different frequencies of the two planes
    /// were subtracted.
    #[test]
    fn the_difference_of_the_planes_is_the_error_of_the_chain() {
        let subject = named("8").unwrap().subject().unwrap();
        let scene = &subject.scenes[0];
        // The predictions of the scene's photons: with fewer, there are fewer rays.
        let theories = Applicability::of_planes(scene);
        let predicted = |i: usize| predict(scene, &scene.planes[i], &theories[i]);
        let [slopes, angles] = [0, 1].map(predicted);
        let found = difference(&slopes.slices, &angles.slices).sum();
        let share = (found / slopes.slices.radial_power().sum()).sqrt();
        let chain = angles.first_order.as_ref().unwrap().chain.error;
        // The prediction by angles also has the error of its Sobol' nets.
        let nets = angles.quadrature_error.unwrap();
        let wanted = libm::hypot(chain, nets);
        assert!((share / wanted - 1.0).abs() < 0.05, "{share}, {wanted}"); // the error of nets is an estimate
    }
}
