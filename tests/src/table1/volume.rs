//! Tests that étendue is conserved along traced rays, and that the rays are reversible.

use super::TableRun;
use crate::report::Bound::Below;
use crate::report::{Check, ReportSection, Row, worse};
use etendue_field::{Frame, Orientation, Specular};
use etendue_theory::Observed;
use etendue_theory::geometry::Edition;
use etendue_theory::path::{PathSurface, PathSystem, rays};
use glam::DVec3;

/// Step of the finite differences, in metres or direction cosines; the error of these differences
/// is of sixth order.
const STEP: f64 = 2e-3;
/// Maximum error of the differences, from rounding (10⁻¹⁶ divided by the step) and from terms of
/// sixth order.
const ROUNDING: f64 = 1e-10;

/// A straight segment of a ray between two surfaces.
#[derive(Clone, Copy)]
struct VolumeRay {
    point: DVec3,
    direction: DVec3,
}

/// The section on phase-space volume and reversibility for every scene with surfaces.
pub(super) fn volume(outcomes: &[&TableRun]) -> ReportSection {
    let mut rows = Vec::new();
    for outcome in outcomes {
        let planes = outcome.scene.planes.iter();
        let mut last = planes
            .enumerate()
            .filter(|(_, p)| p.orientation == Orientation::Orthogonal);
        let Some((index, _)) = last.next_back() else {
            continue;
        };
        let view = outcome.system(index);
        let Observed { system, plane } = &view;
        let ratio = index_ratio(system);
        let chain = rays::chain(&view, Edition::Corrected);
        let linear = chain.map_or(f64::NAN, |c| c.map.rays().symplectic_defect(ratio));
        let mut most = [0.0_f64; 3];
        for at in bundle() {
            let defects = defects(system, &plane.frame, at, ratio);
            let defects = defects.unwrap_or([f64::NAN; 3]);
            for (most, d) in most.iter_mut().zip(defects) {
                *most = worse(*most, d);
            }
        }
        let [volume, invariant, back] = most;
        let found = [
            ("chain", linear),
            ("volume", volume),
            ("invariant", invariant),
            ("back", back),
        ];
        let mut cells = vec![
            outcome.scene.name.clone(),
            outcome.scene.planes[index].name.clone(),
        ];
        cells.extend(found.map(|(_, d)| format!("{d:.1e}")));
        let checks = found.map(|(id, d)| {
            Check::new(id, d, Below(ROUNDING)).because("rounding error of finite differences")
        });
        rows.push(Row::new(cells, checks.into()));
    }
    ReportSection::new(
        "Étendue and reversed rays",
        format!(
            "Around the central ray, 16 rays are followed through the real surfaces, from the \
             light's plane to the last plane across the path. Their coordinates are positions, and \
             the index of refraction times direction cosines. *Volume* is |det J| − 1, where J is \
             their Jacobian by finite differences. *Invariant* is the largest entry of Jᵀ Ω J − Ω, \
             the change of the Lagrange invariant of any two neighbours. *Chain* tests both for \
             the chain of affine maps, with slopes as coordinates. Behind a thin lens, rays also \
             have positions and slopes as coordinates: the ideal lens, u' = u − x/f, preserves the \
             volume of these, and étendue only to second order. *Back* is the distance, in \
             positions and direction cosines, between the start of a ray and the end of the same \
             ray after it is sent back. Required: all numbers are below {ROUNDING:.0e}."
        ),
        "scene | to plane | chain | volume | invariant | back | verdict",
        rows,
    )
}

/// The index of refraction at the light divided by the index at the plane.
fn index_ratio(system: &PathSystem) -> f64 {
    let mut ratio = 1.0;
    let mut ray = start([0.0; 4]);
    for element in system.before_plane() {
        ratio *= crossed(element, ray.direction);
        if let Some(next) = follow(element, &ray) {
            ray = next;
        }
    }
    ratio
}

/// The index before a surface divided by the index after it.
fn crossed(element: &PathSurface, direction: DVec3) -> f64 {
    let Some(Specular::Refraction { front, back }) = element.event() else {
        return 1.0;
    };
    if direction.dot(element.patch.frame.d) < 0.0 {
        front / back
    } else {
        back / front
    }
}

fn bundle() -> impl Iterator<Item = [f64; 4]> {
    // The rays start at the corners of a small box in phase space.
    (0..16).map(|n: u32| {
        std::array::from_fn(|i| {
            let size = if i < 2 { 0.01 } else { 0.02 };
            if n >> i & 1 == 0 { -size } else { size }
        })
    })
}

/// The errors of the phase-space volume, of the invariant, and of the rays traced back.
fn defects(system: &PathSystem, plane: &Frame, at: [f64; 4], ratio: f64) -> Option<[f64; 3]> {
    let slopes = has_lens(system);
    let map = |z: [f64; 4]| -> Option<[f64; 4]> {
        let arrived = through(
            system.before_plane(),
            &start(if slopes { with_cosines(z) } else { z }),
        )?;
        let mut z = coordinates(plane, &arrived)?;
        if slopes {
            z = with_slopes(z);
        }
        // The index of refraction at the light is taken as one.
        z[2] /= ratio;
        z[3] /= ratio;
        Some(z)
    };
    let mut jacobian = [[0.0; 4]; 4];
    for column in 0..4 {
        for (step, weight) in [(1.0, 0.75), (2.0, -0.15), (3.0, 1.0 / 60.0)] {
            let beside = |side: f64| {
                let mut z = at;
                z[column] += side * step * STEP;
                map(z)
            };
            let (above, below) = (beside(1.0)?, beside(-1.0)?);
            for row in 0..4 {
                jacobian[row][column] += weight * (above[row] - below[row]) / STEP;
            }
        }
    }
    let rays = etendue_theory::geometry::AffineMap::linear(jacobian);
    let arrived = through(system.before_plane(), &start(at))?;
    let mut elements = system.before_plane().to_vec();
    elements.reverse();
    let turned = VolumeRay {
        point: arrived.point + arrived.direction * STEP,
        direction: -arrived.direction,
    };
    let home = through(&elements, &turned)?;
    let [x, y, p, q] = coordinates(&Frame::IDENTITY, &home)?;
    let off = [x - at[0], y - at[1], p + at[2], q + at[3]];
    Some([
        (rays.det().abs() - 1.0).abs(),
        rays.symplectic_defect(1.0),
        off.iter().fold(0.0, |most: f64, d| most.max(d.abs())),
    ])
}

/// Checks whether the path contains an ideal lens. Unlike a real lens, an ideal lens preserves the
/// volume of positions and slopes.
fn has_lens(system: &PathSystem) -> bool {
    let mut events = system.before_plane().iter().filter_map(PathSurface::event);
    events.any(|event| matches!(event, Specular::ThinLens { .. }))
}

fn with_slopes([x, y, p, q]: [f64; 4]) -> [f64; 4] {
    let along = (1.0 - p * p - q * q).sqrt();
    [x, y, p / along, q / along]
}

fn with_cosines([x, y, u, v]: [f64; 4]) -> [f64; 4] {
    let length = (1.0 + u * u + v * v).sqrt();
    [x, y, u / length, v / length]
}

/// The ray that starts at a point of the light's plane and has the given direction cosines.
fn start([x, y, p, q]: [f64; 4]) -> VolumeRay {
    VolumeRay {
        point: DVec3::new(x, y, 0.0),
        direction: DVec3::new(p, q, (1.0 - p * p - q * q).sqrt()),
    }
}

fn through(elements: &[PathSurface], ray: &VolumeRay) -> Option<VolumeRay> {
    elements.iter().try_fold(*ray, |ray, e| follow(e, &ray))
}

fn follow(element: &PathSurface, ray: &VolumeRay) -> Option<VolumeRay> {
    let frame = &element.patch.frame;
    let (start, along) = (
        frame.to_local(ray.point),
        frame.vector_to_local(ray.direction),
    );
    let hits = element.patch.hits(start, along);
    let distance = hits.into_iter().find(|t| *t > 1e-9)?;
    let point = ray.point + ray.direction * distance;
    let direction = element.event()?.turned(
        &element.patch.frame,
        element.patch.normal(point),
        point,
        ray.direction,
    )?;
    Some(VolumeRay {
        point,
        direction: direction.normalize(),
    })
}

/// The point where the line of a ray crosses a plane, and the direction cosines of the ray.
fn coordinates(plane: &Frame, ray: &VolumeRay) -> Option<[f64; 4]> {
    let (at, along) = (
        plane.to_local(ray.point),
        plane.vector_to_local(ray.direction),
    );
    let t = -at.z / along.z;
    let z = [at.x + t * along.x, at.y + t * along.y, along.x, along.y];
    t.is_finite().then_some(z)
}
