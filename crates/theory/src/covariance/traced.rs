//! Covariance tracing along the chains of this crate, step by step in the order of propagation.

use super::factors;
use super::pair::SpectralCovariance;
use crate::geometry::{AffineMap, Edition, Matrix, diagonal};
use crate::light::closed_form;
use crate::parallel::{Chain, Operator};
use crate::path::rays;
use crate::path::{self, Observed, PathKind, PathMask};
use crate::plane::Plane;
use etendue_field::{
    EmittedRays, Environment, EnvironmentMap, Image, Light, Mask, Orientation, Pattern, Quantity,
};
use std::f64::consts::TAU;
use std::fmt::{self, Display};

/// The reason why covariance cannot be traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Untraced {
    /// A mask blocks the central ray or has an edge on it, so the mask cannot be treated as a
    /// window about the ray.
    Blocked,
    /// An obstacle stands near the path, and an obstacle cannot be treated as a window about the
    /// central ray.
    Obstacles,
    /// The light is a map or several lobes, which no Gaussian represents.
    Light,
    /// The reflectance varies by a picture, by squares or between BRDFs, and no Gaussian represents
    /// such a variation.
    Reflectance,
    /// Several surfaces have redirected the light, and some of them scatter it.
    Several,
    /// The central ray does not arrive, or a map on its path has no inverse.
    Lost,
}

impl Display for Untraced {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Blocked => "a blocker covers the central ray or has an edge there",
            Self::Obstacles => {
                "objects around the path do not form a window centred on the central ray"
            }
            Self::Light => "no Gaussian describes this light",
            Self::Reflectance => "no Gaussian describes the variation of this reflectance",
            Self::Several => "several surfaces have scattered the light",
            Self::Lost => "the central ray does not arrive, or a map along it has no inverse",
        })
    }
}

/// A model with a light path along which covariance is traced.
pub trait Traced {
    /// The covariance of the spectrum before the window of the plane.
    ///
    /// # Errors
    /// Returns the reason why covariance tracing does not apply.
    fn spectral_covariance(&self) -> Result<SpectralCovariance, Untraced>;
}

impl Traced for Chain {
    fn spectral_covariance(&self) -> Result<SpectralCovariance, Untraced> {
        let mut light = of_light(&self.source.light)?;
        for operator in &self.operators {
            light = match operator {
                Operator::Travel { distance, .. } => moved(&light, &AffineMap::travel(*distance))?,
                Operator::Visibility { mask, .. } => masked(&light, mask)?,
                Operator::Cosine { .. } => light.multiplied(&factors::slope_cosine()),
                Operator::Diffuse { .. } => {
                    let back = AffineMap::linear(diagonal([-1.0, 1.0, -1.0, 1.0]));
                    moved(&light.diffused(), &back)?
                }
            };
        }
        Ok(light)
    }
}

impl Traced for Observed {
    fn spectral_covariance(&self) -> Result<SpectralCovariance, Untraced> {
        if !self.system.obstacles.is_empty() {
            return Err(Untraced::Obstacles);
        }
        let light = match self.kind() {
            PathKind::Specular => after_specular(self)?,
            PathKind::Scattered => after_scatterer(self)?,
            PathKind::Several => return Err(Untraced::Several),
        };
        let Plane {
            quantity,
            orientation,
            ..
        } = self.plane;
        Ok(counted(&light, quantity, orientation))
    }
}

fn after_specular(view: &Observed) -> Result<SpectralCovariance, Untraced> {
    let chain = rays::chain(view, Edition::Corrected).ok_or(Untraced::Lost)?;
    let (light, travelled) = past_masks(view, chain.first_leg)?;
    let rest = AffineMap::travel(-travelled).then(&chain.map.rays());
    moved(&light, &rest)
}

fn after_scatterer(view: &Observed) -> Result<SpectralCovariance, Untraced> {
    let chain = path::chain(view).ok_or(Untraced::Lost)?;
    let scatterer = &chain.scatterers[0];
    let (patch, reflectance) = view.system.scatterer();
    let brdf = reflectance.only().ok_or(Untraced::Reflectance)?;
    if brdf.incoming.is_some() || brdf.outgoing.is_some() {
        return Err(Untraced::Reflectance);
    }
    let (light, travelled) = past_masks(view, scatterer.frame.origin.z)?;
    let onto = AffineMap::travel(-travelled).then(&chain.maps[0]);
    let arriving = moved(&light, &onto)?.multiplied(&factors::cosine());
    let turned = moved(&arriving, &AffineMap::mirror())?;
    let mut leaving = match factors::lobe(&brdf.lobe, scatterer.incidence) {
        Some(lobe) => turned.convolved(&lobe),
        None => turned.diffused(),
    };
    if let Some(texture) = &reflectance.texture {
        let Pattern::Cosine(lines) = texture else {
            return Err(Untraced::Reflectance);
        };
        let axis = [patch.frame.x, patch.frame.y][lines.axis];
        let along = [scatterer.frame.x, scatterer.frame.y].map(|t| axis.dot(t));
        leaving = leaving.multiplied(&along_line(along, factors::grating(lines)));
    }
    moved(&leaving, &chain.maps[1])
}

/// The covariance of light at the source. The light is replaced by a Gaussian that has the
/// same variances of positions and slopes.
fn of_light(light: &Light) -> Result<SpectralCovariance, Untraced> {
    let endless = f64::INFINITY;
    let of_image = |image: &Image| image.width.map(|width| width * width / TAU);
    let light_of = |[x, y]: [f64; 2], [u, v]: [f64; 2]| SpectralCovariance::new([x, y, u, v]);
    Ok(match light.rays() {
        EmittedRays::OfShape(shape) => {
            let exponent = -2.0 * closed_form(light).map_err(|_| Untraced::Light)?.power;
            light_of(shape.variances(), [1.0 / exponent; 2])
        }
        EmittedRays::OfPoint(None) => light_of([0.0; 2], [endless; 2]),
        EmittedRays::OfPoint(Some(image)) => {
            let light = light_of([0.0; 2], of_image(image));
            lined(&light, image, 2)
        }
        EmittedRays::Parallel(image) => {
            let light = light_of(of_image(image), [0.0; 2]);
            lined(&light, image, 0)
        }
        EmittedRays::OfSky(environment) => light_of([endless; 2], [sky_variance(environment)?; 2]),
        // A list of rays is not a Gaussian light field, because each ray is infinitely narrow.
        EmittedRays::Listed(_) => return Err(Untraced::Light),
    })
}

/// The covariance of the light after the light has been multiplied by the grating of the
/// light source's picture, if it has one. `first` is the index of the first coordinate (position or
/// slope) of the picture.
fn lined(light: &SpectralCovariance, image: &Image, first: usize) -> SpectralCovariance {
    image.grating.map_or(*light, |lines| {
        let mut factor = [[0.0; 4]; 4];
        let axis = first + lines.axis;
        factor[axis][axis] = factors::grating(&lines);
        light.multiplied(&factor)
    })
}

/// The variance of an environment with a single lobe, in radians squared.
fn sky_variance(environment: &Environment) -> Result<f64, Untraced> {
    match &environment.map {
        EnvironmentMap::Lobes(lobes) if lobes.len() == 1 => Ok(lobes[0].width * lobes[0].width),
        EnvironmentMap::Lobes(_) | EnvironmentMap::LatLong(_) => Err(Untraced::Light),
    }
}

/// The covariance of light after the masks of the first leg, and the distance from the
/// light to the last mask. `length` is the length of the leg.
fn past_masks(view: &Observed, length: f64) -> Result<(SpectralCovariance, f64), Untraced> {
    let start = (of_light(&view.system.light)?, 0.0);
    let mut masks = view.system.masks_before(length);
    masks.try_fold(start, |(light, at), PathMask { distance, mask, .. }| {
        let arriving = moved(&light, &AffineMap::travel(distance - at))?;
        Ok((masked(&arriving, mask)?, *distance))
    })
}

fn masked(light: &SpectralCovariance, mask: &Mask) -> Result<SpectralCovariance, Untraced> {
    let factor = factors::mask(mask).ok_or(Untraced::Blocked)?;
    Ok(light.multiplied(&factor))
}

fn moved(light: &SpectralCovariance, map: &AffineMap<4>) -> Result<SpectralCovariance, Untraced> {
    light.mapped(map).ok_or(Untraced::Lost)
}

/// The covariance after multiplication by the cosine if the plane records differential
/// irradiance, and an unchanged covariance otherwise.
fn counted(
    light: &SpectralCovariance,
    quantity: Quantity,
    orientation: Orientation,
) -> SpectralCovariance {
    match (quantity, orientation) {
        (Quantity::DifferentialIrradiance, Orientation::Orthogonal) => {
            light.multiplied(&factors::slope_cosine())
        }
        (Quantity::DifferentialIrradiance, _) => light.multiplied(&factors::cosine()),
        _ => *light,
    }
}

/// A covariance matrix that is non-zero only along the direction (a, b) of positions.
fn along_line([a, b]: [f64; 2], variance: f64) -> Matrix<4> {
    let entry = |p: f64, q: f64| p * q * variance;
    let none = [0.0; 4];
    [
        [entry(a, a), entry(a, b), 0.0, 0.0],
        [entry(a, b), entry(b, b), 0.0, 0.0],
        none,
        none,
    ]
}
