//! The curved glossy receiver without approximation: rays are traced off a sphere, as in `etendue
//! predict`.

use crate::parts::{CELLS, grid, shapes, square, window};
use crate::plane::PathPlace;
use crate::setup::{SettingKey, Setup};
use etendue_field::{
    Brdf, Frame, Fresnel, Lobe, Mask, Orientation, Patch, ProjectionGrid, Quantity, Reflectance,
    Side, SliceGrid,
};
use etendue_theory::path::{Interaction, PathMask, PathSurface, PathSystem};
use etendue_theory::{Model, Observed, Over, Plane, Predicted, RayBudget};
use glam::DVec3;

/// The budget that the command uses for a saved scene, whose number of photons is 2²²: the total
/// number of rays, and the target error.
const BUDGET: RayBudget = RayBudget::new(1_048_576.0, 12.0 / 2048.0);
/// Radius of the receiver, metres.
pub(crate) const APERTURE: f64 = 0.6;
/// Number of azimuths of a saved scene; rays are added until the slices at all azimuths reach the
/// target error.
pub(crate) const AZIMUTHS: usize = 2;

/// The light field at a plane on a glossy receiver by nets of rays, or `None` for other
/// planes.
pub(crate) fn followed(plane: PathPlace, setup: &Setup) -> Option<Predicted> {
    let window = window(setup);
    let grid = SliceGrid {
        azimuths: AZIMUTHS,
        ..grid(setup)
    };
    let cells = ProjectionGrid::new(&window, CELLS);
    let over: Over<'_> = (&window, &grid, &cells);
    let light = square(setup);
    let patch = patch(setup);
    let (surfaces, orientation, side) = match plane {
        PathPlace::Curved => (Vec::new(), Orientation::LocalNormals, Side::Before),
        PathPlace::Blurred | PathPlace::Glossy => {
            let interaction = Interaction::Reflects(Box::new(reflectance(setup)));
            let orientation = if plane == PathPlace::Glossy {
                Orientation::Orthogonal
            } else {
                Orientation::LocalNormals
            };
            let surface = PathSurface::new("receiver", patch, interaction);
            (vec![surface], orientation, Side::After)
        }
        _ => return None,
    };
    let system = PathSystem {
        masks: masks(setup),
        ..PathSystem::new(light, surfaces)
    };
    let plane = seen(&patch, orientation, side);
    Some(Observed { system, plane }.predict(&[], over, BUDGET))
}

fn masks(setup: &Setup) -> Vec<PathMask> {
    if setup.get(SettingKey::Fill) <= 0.0 {
        return Vec::new();
    }
    vec![PathMask {
        name: "blockers".into(),
        distance: setup.get(SettingKey::Distance),
        mask: Mask::Opaque {
            shapes: shapes(setup),
            half_planes: Vec::new(),
        },
    }]
}

/// The receiver in the frame at the light, facing the light.
fn patch(setup: &Setup) -> Patch {
    let vertex = DVec3::Z * setup.get(SettingKey::Travel);
    Patch {
        frame: Frame::new(vertex, DVec3::NEG_Z, DVec3::X).expect("axes at right angles"),
        curvature: [setup.get(SettingKey::Curvature); 3],
        aperture: APERTURE,
    }
}

fn reflectance(setup: &Setup) -> Reflectance {
    let exponent = setup.get(SettingKey::Exponent);
    let lobe = Lobe::Phong { exponent };
    Brdf::new(lobe, setup.get(SettingKey::Albedo), Fresnel::White).into()
}

/// A plane where the central ray meets the receiver. The ray goes straight back, so X is
/// reversed.
fn seen(patch: &Patch, orientation: Orientation, side: Side) -> Plane {
    let frame = Frame::new(patch.frame.origin, DVec3::NEG_Z, DVec3::NEG_X);
    Plane {
        frame: frame.expect("axes at right angles"),
        orientation,
        longitude: 0.0,
        patch: orientation.is_local().then_some(*patch),
        side,
        quantity: Quantity::Radiance,
    }
}
