//! The emission of a light.

use crate::nets::LinearDensity;
use crate::path::{PathMask, PathSystem};
use std::f64::consts::PI;

/// The ray coordinates that parametrise a light's emission. The two inner coordinates are two of x,
/// y, u and v. For a light with extent, the other two coordinates are also needed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EmissionMeasure {
    /// Indices, among x, y, u and v, of the two inner coordinates.
    pub(super) inner: [usize; 2],
    /// The largest absolute value of each inner coordinate at which rays are searched for.
    pub(super) reach: [f64; 2],
    /// Number of cycles of the light's picture per unit of each inner coordinate.
    pub(super) cycles: [f64; 2],
}

/// The largest slope for which rays are sought, if the light has no picture.
const STEEPEST: f64 = 30.0;

impl EmissionMeasure {
    /// The indices, among x, y, u and v, of the two coordinates that are not inner
    /// coordinates.
    pub(super) fn outer(&self) -> [usize; 2] {
        self.inner.map(|inner| (inner + 2) % 4)
    }
}

impl PathSystem {
    pub(super) fn emission(&self) -> EmissionMeasure {
        let image = self.light.image();
        let inner = if self.light.is_distant() {
            [0, 1]
        } else {
            [2, 3]
        };
        let mut cycles = [0.0; 2];
        if let Some(image) = image {
            // Above the frequency 2/w, the transform of a Gaussian of width w is below 10⁻⁵.
            cycles = image.width.map(|w| 2.0 / w);
            if let Some(grating) = image.grating {
                cycles[grating.axis] += grating.frequency.abs();
            }
        }
        for PathMask { distance, mask, .. } in &self.masks {
            if let Some(grating) = mask.grating() {
                let per_unit = if inner[0] == 0 { 1.0 } else { distance.abs() };
                cycles[grating.axis] += grating.frequency.abs() * per_unit;
            }
        }
        EmissionMeasure {
            inner,
            reach: image.map_or([STEEPEST; 2], etendue_field::Image::reach),
            cycles,
        }
    }

    /// The densities of the two inner coordinates in proportion to the light's picture, or
    /// `None` if the light has no picture.
    pub(super) fn picture_densities(&self) -> Option<[LinearDensity; 2]> {
        let image = self.light.image()?;
        let along = |axis: usize| {
            let width = image.width[axis];
            let grating = image.grating.filter(|g| g.axis == axis);
            let reach = image.reach()[axis];
            LinearDensity::new([-reach, reach], |t| {
                let [a, b] = if axis == 0 { [t, 0.0] } else { [0.0, t] };
                let passes = grating.map_or(1.0, |g| g.transmittance(a, b));
                // The constant 0.1 ensures that no line of a grating is missed between the
                // tabulated values of the density.
                libm::exp(-PI * (t / width).powi(2)) * (passes + 0.1)
            })
        };
        Some([along(0)?, along(1)?])
    }
}
