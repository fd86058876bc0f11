//! The single operators (steps) of one mirror, stored separately so that a test can change each
//! of them.

use etendue_field::{Orientation, Side, VirtualPlane};
use etendue_theory::geometry::{AffineMap, Matrix, SpectrumMap};

/// The operators of travel to a mirror and of the reflection. The plane of incidence is the plane
/// of X and D.
#[derive(Clone, Debug)]
pub(super) struct Steps {
    pub(super) distance: f64,
    pub(super) incidence: SpectrumMap<4>,
    pub(super) curvature: SpectrumMap<4>,
    pub(super) mirror: SpectrumMap<4>,
    pub(super) back: SpectrumMap<4>,
    pub(super) outgoing: SpectrumMap<4>,
}

impl Steps {
    /// The steps that follow from ray geometry.
    pub(super) fn sound(distance: f64, theta0: f64, shape: Matrix<2>) -> Self {
        Self {
            distance,
            incidence: AffineMap::<4>::incidence(theta0).spectrum_map(),
            curvature: AffineMap::<4>::curvature(shape, theta0).spectrum_map(),
            mirror: AffineMap::mirror().spectrum_map(),
            back: AffineMap::<4>::back(shape, -theta0).spectrum_map(),
            outgoing: AffineMap::<4>::outgoing(-theta0).spectrum_map(),
        }
    }

    /// The chain up to a plane.
    pub(super) fn chain(&self, plane: &VirtualPlane) -> SpectrumMap<4> {
        let mut map = AffineMap::travel(match plane.leg {
            0 => plane.distance,
            _ => self.distance,
        })
        .spectrum_map();
        let mut then = |next: &SpectrumMap<4>| map = map.then(next);
        let leaves = plane.side == Side::After || plane.leg > 0;
        let on_surface = plane.orientation != Orientation::Orthogonal;
        if on_surface || leaves {
            then(&self.incidence);
        }
        if leaves || plane.orientation == Orientation::LocalNormals {
            then(&self.curvature);
        }
        if leaves {
            then(&self.mirror);
            if plane.orientation != Orientation::LocalNormals {
                then(&self.back);
            }
        }
        if on_surface {
            let mut counted = AffineMap::<4>::identity();
            counted.offset[2] = -plane.longitude;
            then(&counted.spectrum_map());
        } else if leaves {
            then(&self.outgoing);
            let beyond = plane.distance - self.distance;
            then(&AffineMap::travel(beyond).spectrum_map());
        }
        map
    }
}
