//! Converts the scene of Fig. 6 from 3D to flatland.

use crate::flatland::{DiffuseStep, Flatland};
use etendue_field::{Light, Shape, VirtualPlane};
use etendue_scene::{BlockersFile, Scene};
use etendue_store::Failure;
use ndarray::Array2;

/// A light, a row of blockers without jitter and a receiver.
pub(crate) struct Flat(Flatland);

impl Flat {
    /// The steps of Fig. 6.
    pub(crate) const STEPS: [DiffuseStep; 6] = [
        DiffuseStep::Emission,
        DiffuseStep::Travel,
        DiffuseStep::Visibility,
        DiffuseStep::SecondTravel,
        DiffuseStep::Cosine,
        DiffuseStep::Reflection,
    ];

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
        Ok(Self(Flatland {
            half_light: 0.5 * light.size[0],
            to_strips: layer.distance,
            strips: strips.collect(),
            to_receiver: floor.length,
        }))
    }

    /// Returns |S|² of a step as an array [ρ, ν], in the window and at the frequencies of a plane.
    pub(crate) fn power(&self, step: DiffuseStep, plane: &VirtualPlane) -> Array2<f64> {
        let window = [&plane.window.x, &plane.window.u];
        let spectrum = self
            .0
            .spectrum(step, window, [&plane.grid.rho, &plane.grid.nu]);
        spectrum.mapv(|s| s.norm_sqr())
    }
}
