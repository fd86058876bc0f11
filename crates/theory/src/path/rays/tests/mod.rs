//! Tests of rays through smooth surfaces against closed forms and first-order maps.

use super::*;
use crate::geometry::{Edition, SpectrumMap};
use crate::path::{Interaction, PathSurface, PathSystem};
use crate::{Model, Observed, Plane, Predicted, RayBudget};
use etendue_field::{
    Complex, Frame, FrequencyAxis, Image, Light, Orientation, Patch, Profile, ProjectionGrid,
    Quantity, Rectangle, Shape, SliceGrid, Slices, Specular, Window,
};
use glam::DVec3;

/// A budget of two million nodes, with which errors are far below the deviations that these tests
/// detect.
const BUDGET: RayBudget = RayBudget::new(2e6, 1e-5);

fn view(system: &PathSystem, plane: &Plane) -> Observed {
    Observed {
        system: system.clone(),
        plane: *plane,
    }
}

fn exact(system: &PathSystem, plane: &Plane, window: &Window, grid: &SliceGrid) -> Predicted {
    let picture = ProjectionGrid::new(window, 32);
    view(system, plane).predict(&[], (window, grid, &picture), BUDGET)
}

fn linear(
    system: &PathSystem,
    plane: &Plane,
    window: &Window,
    grid: &SliceGrid,
    map: &SpectrumMap<4>,
) -> Predicted {
    let picture = ProjectionGrid::new(window, 32);
    super::linear(&view(system, plane), (window, grid, &picture), map, BUDGET)
}

mod back;
mod environment;
mod kernel;
mod known;
mod order;
mod read_off;
mod surfaces;

/// A window with equal widths along both axes.
fn window(position: Profile, slope: Profile) -> Window {
    crate::testing::window(position, slope)
}

/// Returns frequencies up to four cycles over windows of half-widths `h`.
fn grid(azimuths: usize, h: [f64; 2]) -> SliceGrid {
    let axis = |h: f64| FrequencyAxis {
        half: 8,
        spacing: 0.5 / h,
    };
    SliceGrid {
        azimuths,
        rho: axis(h[0]),
        nu: axis(h[1]),
    }
}

fn picture(width: [f64; 2]) -> Image {
    Image {
        width,
        grating: None,
    }
}

fn beam(width: [f64; 2]) -> Light {
    Light::Beam {
        irradiance: 1.0,
        image: picture(width),
    }
}

fn projector(width: [f64; 2]) -> Light {
    Light::Projector {
        intensity: 1.0,
        image: picture(width),
    }
}

fn element(name: &str, patch: Patch, event: Specular) -> PathSurface {
    PathSurface::new(name, patch, Interaction::Specular(event))
}

/// Appends a surface to a path.
fn visit(system: &mut PathSystem, surface: PathSurface) {
    system.surfaces.push(surface);
    system.visited += 1;
}

/// The plane at the end of the last leg.
fn after(system: &PathSystem, distance: f64) -> Plane {
    let last = system
        .hits()
        .unwrap()
        .last()
        .map_or(Frame::IDENTITY, |hit| hit.leaving);
    Plane::orthogonal(last.travelled(distance))
}

/// Places a surface across a leg. The surface's normal is −D turned by θ₀ within the plane at the
/// angle `azimuth` about D. Its principal axes are turned by `twist` about the normal.
fn placed(
    leg: &Frame,
    distance: f64,
    theta0: f64,
    [azimuth, twist]: [f64; 2],
    curvature: [f64; 3],
) -> Patch {
    let (sin, cos) = libm::sincos(azimuth);
    let x = leg.x * cos + leg.y * sin;
    let d = -leg.d * libm::cos(theta0) + x * libm::sin(theta0);
    let origin = leg.origin + leg.d * distance;
    let untwisted = Frame::new(origin, d, leg.x).unwrap();
    let (sin, cos) = libm::sincos(twist);
    let axis = untwisted.x * cos + untwisted.y * sin;
    Patch {
        frame: Frame::new(origin, d, axis).unwrap(),
        curvature,
        aperture: 1e3,
    }
}

/// A single mirror 1 m from the light. It is so small that no light meets it twice.
fn mirror(light: Light, theta0: f64, turns: [f64; 2], curvature: [f64; 3]) -> PathSystem {
    let mut patch = placed(&Frame::IDENTITY, 1.0, theta0, turns, curvature);
    patch.aperture = 1.0;
    PathSystem::new(light, vec![element("mirror", patch, Specular::Mirror)])
}
