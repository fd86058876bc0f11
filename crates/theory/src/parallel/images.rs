//! The images of a chain in a curved mirror or a thin lens (docs/theory.md, section 9).

use crate::light::closed_form;
use crate::{Chain, Operator};
use etendue_field::{Grating, HalfPlane, Mask};

/// The smallest allowed distance between a plane and the focal plane, divided by the distance
/// between the plane and the mirror or lens. The image of the focal plane is at infinity. If a
/// plane is near the focal plane, positions on its image have large rounding errors.
const NEAREST: f64 = 1e-6;

impl Chain {
    /// A chain whose final light field is the final light field of this chain after the map
    /// u' = u + `power` x. A thin lens of focal length −1/power applies this map, and a curved
    /// mirror at normal incidence applies it to first order.
    ///
    /// A ray that arrives at (x, u') was at x − h u = m (x − h/m u') in a plane at distance h, with
    /// m = 1 + power · h. The image of the plane is therefore at the distance h/m and is 1/m times
    /// as large. Returns `None` if the light varies with slope or if the chain has a diffuse
    /// reflection, because such chains have no image.
    #[must_use]
    pub fn imaged(&self, power: f64) -> Option<Self> {
        let emitter = closed_form(&self.source.light).ok()?;
        let path = self.path();
        if emitter.power != 0.0 || path.cosines > 0 || path.reflection.is_some() {
            return None;
        }
        let image_of_light = seen(power, path.distance);
        let mut at = image_of_light.distance;
        let mut operators = Vec::new();
        for operator in &self.operators {
            if let Operator::Visibility { name, .. } = operator {
                let layer = path.layers.get(operators.len() / 2)?;
                let image = seen(power, layer.distance);
                operators.push(travel(at - image.distance));
                operators.push(Operator::Visibility {
                    name: name.clone(),
                    mask: image.of_mask(layer.mask),
                });
                at = image.distance;
            }
        }
        operators.push(travel(at));
        let mut source = self.source.clone();
        let shape = source.light.values().shape?;
        *shape = shape.mapped(image_of_light.scale, [0.0; 2]);
        Some(Self { source, operators })
    }
}

/// The operator for travel between two images; `distance` may be negative.
fn travel(distance: f64) -> Operator {
    Operator::Travel {
        from: "image".to_owned(),
        to: "image".to_owned(),
        distance,
    }
}

/// The position of the image of a plane, and its magnification.
struct PlaneImage {
    distance: f64,
    scale: f64,
}

fn seen(power: f64, distance: f64) -> PlaneImage {
    let shrink = 1.0 + power * distance;
    let shrink = shrink.abs().max(NEAREST).copysign(shrink);
    PlaneImage {
        distance: distance / shrink,
        scale: 1.0 / shrink,
    }
}

impl PlaneImage {
    fn of_mask(&self, mask: &Mask) -> Mask {
        match mask {
            Mask::Opaque {
                shapes,
                half_planes,
            } => Mask::Opaque {
                shapes: shapes
                    .iter()
                    .map(|shape| shape.mapped(self.scale, [0.0; 2]))
                    .collect(),
                half_planes: half_planes
                    .iter()
                    .map(|half| self.of_half_plane(half))
                    .collect(),
            },
            Mask::Aperture(hole) => Mask::Aperture(hole.mapped(self.scale, [0.0; 2])),
            Mask::Grating(grating) => Mask::Grating(Grating {
                frequency: grating.frequency / self.scale,
                ..*grating
            }),
        }
    }

    fn of_half_plane(&self, half: &HalfPlane) -> HalfPlane {
        HalfPlane {
            edge: half.edge * self.scale,
            above: half.above == (self.scale > 0.0),
            ..*half
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::at;
    use crate::geometry::{AffineMap, times};
    use crate::testing::*;
    use etendue_field::{Profile, Window};

    /// A window that contains all slopes of the chain and part of its positions.
    fn open(half: f64) -> Window {
        Window {
            u: Profile::Box(3.0),
            v: Profile::Box(3.0),
            ..window(Profile::Hann(half), Profile::Box(3.0))
        }
    }

    #[test]
    fn images_shear_the_spectrum_as_the_map_does() {
        let chain = chain(
            0.2,
            &[
                (0.5, blockers(3, 0.2, 0.1)),
                (0.4, vec![]),
                (0.3, blockers(2, 0.3, 0.15)),
            ],
        );
        for power in [0.7, -0.4, -2.5] {
            let imaged = chain.imaged(power).unwrap();
            let window = open(0.3);
            let sheared = AffineMap::<2>::back(power);
            for [rho, nu] in [[0.0, 0.0], [1.3, 0.8], [2.0, -1.7]] {
                // The shear is applied in both sections, because the mirror or lens has power
                // along both axes.
                let [x, u] = times(&sheared.spectrum_map().matrix, &[rho, nu]);
                let before = at(&chain, &window, [x, 0.5 * x, u, 0.5 * u]);
                let after = at(&imaged, &window, [rho, 0.5 * rho, nu, 0.5 * nu]);
                let error = (after - before).norm() / at(&chain, &window, [0.0; 4]).re;
                assert!(error < 1e-12, "{power} {rho} {nu}: {error:e}"); // rounding
            }
        }
    }

    #[test]
    fn slopes_have_no_image() {
        let mut shaded = chain(0.2, &[(0.5, vec![])]);
        shaded.operators.push(cosine());
        assert_eq!(shaded.imaged(0.5), None);
    }
}
