//! Theory's affine maps at surfaces, compared with differences of rays traced by the second
//! implementation. Only theory uses these affine maps, but they depend on conventions that the
//! tracers share.

use super::check::{SecondCheck, worse};
use super::paths::Legs;
use super::smooth::Smooth;
use super::vector::{Axes, Vector, dot, plus, turned_along, unit};
use super::views::{Looking, PLANES, View};
use super::world::World;
use crate::hostile::dice::Dice;
use etendue_field::{
    Brdf, Frame, Fresnel, Light, Lobe, Orientation, Patch, Quantity, Side, Specular,
};
use etendue_theory::geometry::{AffineMap, Edition};
use etendue_theory::path::{self, Interaction, PathSurface, PathSystem, rays};
use etendue_theory::{Observed, Plane};
use std::path::Path;

/// Half of the step between the two rays of a finite difference, in metres or radians.
const STEP: f64 = 1e-5;

const MIRROR: &[&str] = &[
    "wrong sign of latitude",
    "central normal instead of the local normal",
    "not turned about the normal",
    "hollow instead of convex",
];
const ONTO: &[&str] = &[
    "wrong sign of latitude",
    "central normal instead of the local normal",
    "hollow instead of convex",
];
const OFF: &[&str] = &[
    "wrong sign of latitude",
    "central normal instead of the local normal",
];

pub(super) fn checks() -> Vec<SecondCheck> {
    let check = |name, faults, difference: fn(&mut Dice, &str) -> f64| SecondCheck {
        name,
        rounds: [300, 4],
        tolerance: (
            1e-7,
            "error of finite differences over 10⁻⁵: its square times third derivatives",
        ),
        faults,
        difference: Box::new(difference),
    };
    vec![
        check("theory: map to planes at a mirror", MIRROR, at_mirror),
        check("theory: map onto a surface with a BRDF", ONTO, onto),
        check("theory: map off a surface with a BRDF", OFF, off),
    ]
}

/// A surface on the central ray, with theory's description of it.
struct Met {
    world: World,
    smooth: Smooth,
    legs: Legs,
    patch: Patch,
}

impl Met {
    fn new(dice: &mut Dice) -> Self {
        let mut world = World::new(dice);
        let (smooth, words) = Smooth::new(dice, &world, 0.7);
        world.surfaces = words + "Mirror)";
        let patch = world.scene(Path::new(".")).patches[0].patch;
        let legs = Legs::at_mirror(&world.light, &smooth, "");
        Self {
            world,
            smooth,
            legs,
            patch,
        }
    }

    /// Returns axes as a frame in the coordinate system at the light.
    fn frame(&self, axes: &Axes) -> Frame {
        let vector = |a: Vector| self.world.light.components(a).into();
        Frame {
            origin: self.world.resolved(axes.origin).into(),
            x: vector(axes.x),
            y: vector(axes.y),
            d: vector(axes.d),
        }
    }

    fn plane(&self, looking: &Looking<'_>) -> Plane {
        let (axes, orientation) = match looking.view {
            View::Across => (&looking.leg, Orientation::Orthogonal),
            View::Tangent => (&looking.surface, Orientation::Tangent),
            View::Local => (&looking.surface, Orientation::LocalNormals),
            View::Mirrored => (&looking.surface, Orientation::Mirrored),
        };
        Plane {
            frame: self.frame(axes),
            orientation,
            longitude: looking.longitude,
            patch: orientation.is_local().then_some(self.patch),
            side: if looking.arrives {
                Side::Before
            } else {
                Side::After
            },
            quantity: Quantity::Radiance,
        }
    }

    /// The origin and direction of the ray with coordinates (x, y, u, v) at the light.
    fn emitted(&self, [x, y, u, v]: [f64; 4]) -> (Vector, Vector) {
        let light = &self.world.light;
        (light.point([x, y, 0.0]), unit(light.vector([u, v, 1.0])))
    }

    /// Returns theory's system for light that the surface reflects.
    fn scattering(&self, plane: Plane) -> Observed {
        let brdf = Brdf::new(Lobe::Lambertian, 1.0, Fresnel::White);
        let interaction = Interaction::Reflects(Box::new(brdf.into()));
        let surface = PathSurface::new("it", self.patch, interaction);
        let system = PathSystem::new(Light::Point { intensity: 1.0 }, vec![surface]);
        Observed { system, plane }
    }
}

/// Compares an affine map with the function that the map linearises. Returns the deviation of the
/// map from the derivative of this function at a ray.
fn apart(map: &AffineMap<4>, at: [f64; 4], of: impl Fn([f64; 4]) -> Option<[f64; 4]>) -> f64 {
    let each = (0..4).map(|i| {
        let moved = |by: f64| {
            let mut z = at;
            z[i] += by;
            of(z)
        };
        let (Some(above), Some(below)) = (moved(STEP), moved(-STEP)) else {
            return f64::NAN;
        };
        let rows = map.matrix.iter().zip(above.iter().zip(below));
        let off = rows.map(|(row, (a, b))| (row[i] - (a - b) / (2.0 * STEP)).abs());
        off.fold(0.0, worse)
    });
    each.fold(0.0, worse)
}

fn at_mirror(dice: &mut Dice, fault: &str) -> f64 {
    let met = Met::new(dice);
    let seen = *dice.pick(&PLANES);
    let smooth = met.smooth.wrong(fault);
    let looking = Looking::new(&smooth, &met.legs, seen);
    let mirror = Interaction::Specular(Specular::Mirror);
    let mirror = PathSurface::new("it", met.patch, mirror);
    let surfaces = if looking.arrives {
        Vec::new()
    } else {
        vec![mirror]
    };
    let system = PathSystem::new(Light::Point { intensity: 1.0 }, surfaces);
    let plane = met.plane(&looking);
    let Some(chain) = rays::chain(&Observed { system, plane }, Edition::Corrected) else {
        return f64::NAN;
    };
    apart(&chain.map.rays(), [0.0; 4], |z| {
        let (start, along) = met.emitted(z);
        if looking.arrives {
            return looking.seen(start, along, fault);
        }
        let point = plus(start, *smooth.hits(start, along).first()?, along);
        let normal = smooth.normal(point);
        let mirrored = plus(along, -2.0 * dot(along, normal), normal);
        looking.seen(point, mirrored, fault)
    })
}

fn onto(dice: &mut Dice, fault: &str) -> f64 {
    let met = Met::new(dice);
    let smooth = met.smooth.wrong(fault);
    let looking = Looking::new(&smooth, &met.legs, ("", true, View::Local));
    let leaving = Looking::new(&smooth, &met.legs, ("", false, View::Across));
    let Some(chain) = path::chain(&met.scattering(met.plane(&leaving))) else {
        return f64::NAN;
    };
    apart(&chain.maps[0], [0.0; 4], |z| {
        let (start, along) = met.emitted(z);
        looking.seen(start, along, fault)
    })
}

/// Checks the map from (s, t, θ, φ) of light that leaves the surface to the coordinates of a
/// plane.
fn off(dice: &mut Dice, fault: &str) -> f64 {
    let met = Met::new(dice);
    let leaving = *dice.pick(&PLANES[4..]);
    let looking = Looking::new(&met.smooth, &met.legs, leaving);
    let Some(chain) = path::chain(&met.scattering(met.plane(&looking))) else {
        return f64::NAN;
    };
    let (axes, longitude) = met.legs.leaving;
    apart(&chain.maps[1], [0.0; 4], |[s, t, theta, phi]| {
        let theta = longitude + theta;
        let [p, q, _] = met.smooth.axes.coordinates(axes.point([s, t, 0.0]));
        let point = met.smooth.point(p, q);
        let normal = met.smooth.normal(point);
        let local = [phi.cos() * theta.sin(), phi.sin(), phi.cos() * theta.cos()];
        let along = turned_along(axes.vector(local), axes.d, normal);
        looking.seen(point, along, fault)
    })
}
