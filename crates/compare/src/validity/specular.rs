//! Checks, for rays through specular surfaces, whether photons meet only what theory assumes.

use super::clearance::PathPiece;
use super::coordinates::{coordinates, seen};
use super::mesh_error::OffPatches;
use super::rays::{CheckRay, RayDraw, centred, point_on, ray_to, strength, within};
use super::search::{Followed, found};
use super::surroundings::{Meets, Surroundings, TakenLayer, unforeseen};
use etendue_field::{Light, Patch, TwoPlane, VirtualPlane};
use etendue_scene::{Object, Scene};
use etendue_theory::Observed;
use etendue_theory::rays::{Plane, SpecularSystem};
use glam::DVec3;

/// Describes objects that theory ignores although light on its way to a plane meets them, between
/// or at the surfaces of a system. Also returns the blockers that theory includes. `off` is the
/// displacement by meshes, see [`off_patches`].
pub(crate) fn unforeseen_by_rays(
    scene: &Scene,
    plane: &VirtualPlane,
    view: &Observed<SpecularSystem>,
    off: Option<OffPatches>,
) -> (Vec<String>, Vec<TakenLayer>) {
    let around = Surroundings::new(scene, plane);
    let (mut found, later) = unforeseen(scene, around, |around| {
        let follower = Follower::new(scene, plane, view, around);
        let mut meets = found(&FollowedRays(&follower, Follower::ray));
        meets.extend(found(&FollowedRays(&follower, Follower::ray_of_window)));
        meets
    });
    let apart = off.map(|off| off.apart);
    found.extend(apart.filter(|apart| *apart > OFF_PATCHES).map(|apart| {
        let percent = 100.0 * apart;
        format!(
            "a mesh: its light and the light of its osculating patch arrive {percent:.3} % of the window's half-width apart"
        )
    }));
    (found, later)
}

/// Returns the difference between rays that smooth meshes deflect and the same rays deflected by
/// osculating patches; `None` without a mesh.
pub(crate) fn off_patches(
    scene: &Scene,
    plane: &VirtualPlane,
    view: &Observed<SpecularSystem>,
) -> Option<OffPatches> {
    let around = Surroundings::new(scene, plane);
    Follower::new(scene, plane, view, &around).off_patches()
}

/// The largest accepted distance between the two arrivals of a ray, in half-widths of the window.
/// One arrival is by a mesh, and the other by its osculating patch. A displacement of rays by this
/// distance changes a spectrum by about ten times as much, and the change is reported.
const OFF_PATCHES: f64 = 1e-4;

pub(super) struct Follower<'a> {
    pub(super) scene: &'a Scene,
    pub(super) plane: &'a VirtualPlane,
    pub(super) system: &'a SpecularSystem,
    pub(super) at: &'a Plane,
    around: &'a Surroundings<'a>,
}

/// The rays of a follower, drawn either at the light or in the window.
struct FollowedRays<'a>(
    &'a Follower<'a>,
    fn(&Follower<'a>, &RayDraw) -> Option<(CheckRay, f64)>,
);

impl Followed for FollowedRays<'_> {
    fn check(&self, draw: &RayDraw) -> Option<(f64, Option<Meets>)> {
        self.0.check(self.1(self.0, draw)?)
    }

    fn pieces(&self, draw: &RayDraw) -> Option<(f64, Vec<PathPiece>)> {
        let (ray, emitted) = self.1(self.0, draw)?;
        let mut pieces = Vec::with_capacity(self.0.system.elements.len() + 1);
        let (z, share) = self.0.follow(ray, |piece| pieces.push(piece))?;
        let light = emitted * share * self.0.plane.window.value(&z);
        (light > 0.0).then_some((light, pieces))
    }

    fn around(&self) -> &Surroundings<'_> {
        self.0.around
    }
}

/// A ray at the plane, and the share of its light that passes the masks on the first leg.
pub(super) type PlaneArrival = Option<(TwoPlane, f64)>;

/// Distances whose relative difference is below this limit count as equal.
const SAME_DISTANCE: f64 = 1e-6;

impl<'a> Follower<'a> {
    fn new(
        scene: &'a Scene,
        plane: &'a VirtualPlane,
        view: &'a Observed<SpecularSystem>,
        around: &'a Surroundings<'a>,
    ) -> Self {
        Self {
            scene,
            plane,
            system: &view.system,
            at: &view.plane,
            around,
        }
    }
}

impl Follower<'_> {
    /// Returns the amount of light that a ray brings into the window, and the first object on its
    /// way that theory ignores, if there is one. Returns `None` if the ray brings no light.
    fn check(&self, (ray, emitted): (CheckRay, f64)) -> Option<(f64, Option<Meets>)> {
        let (arrival, meets) = self.photon(ray);
        let brought = [arrival, self.theory(ray)].into_iter().flatten();
        let light = brought.map(|(z, share)| emitted * share * self.plane.window.value(&z));
        let light = light.fold(0.0, f64::max);
        (light > 0.0).then_some((light, meets))
    }

    /// Returns a ray of the light towards the first surface, and its strength.
    pub(super) fn ray(&self, draw: &RayDraw) -> Option<(CheckRay, f64)> {
        let RayDraw { index, numbers: r } = *draw;
        let hit = self.scene.path.ends_at(0)?;
        let of_patch = |patch: &Patch| point_on(patch, hit.point, index, [r[0], r[1]]);
        let target = match (self.system.elements.first(), hit.object) {
            (Some(element), _) => of_patch(&element.patch)?,
            (None, Object::Patch(i)) => of_patch(&self.scene.patches[i].patch)?,
            (None, Object::Surface(i)) => {
                let surface = &self.scene.surfaces[i];
                let center = surface.frame.to_local(hit.point);
                let across = |axis: usize| {
                    let at = center[axis] + surface.size[axis] * centred(index, r[axis]);
                    (2.0 * at.abs() <= surface.size[axis]).then_some(at)
                };
                let at = DVec3::new(across(0)?, across(1)?, 0.0);
                surface.frame.to_world(at)
            }
            (None, Object::Mesh(i)) => {
                let triangles = &self.scene.meshes[i].triangles;
                let corners = triangles[index as usize % triangles.len()];
                corners[0].lerp(corners[1], r[0]).lerp(corners[2], r[1])
            }
        };
        ray_to(&self.system.light, target, index, [r[2], r[3]])
    }

    /// Returns a ray that theory predicts to arrive in the window. Rays are also drawn in the
    /// window, because rays that are drawn at the light may rarely reach a narrow window. They may
    /// also rarely reach the part of a wide window that is close to the light. Light without extent
    /// is aimed at points of the window if no surface deflects it first.
    pub(super) fn ray_of_window(&self, draw: &RayDraw) -> Option<(CheckRay, f64)> {
        let light = &self.system.light;
        let coordinates = within(&self.plane.window, draw.numbers);
        if !light.has_extent() {
            let [x, y, ..] = coordinates;
            let at = self.at.frame.to_world(DVec3::new(x, y, 0.0));
            let turned = !self.system.elements.is_empty();
            return ray_to(light, at, draw.index, [0.0; 2]).filter(|_| !turned);
        }
        let mut ray = seen(self.at, coordinates)?;
        for (leg, element) in self.system.elements.iter().enumerate().rev() {
            let back = ray.back(&element.patch);
            let point = back.at(back.theory_hit(&element.patch)?);
            let came = self.turned(leg, on(&element.patch, point), &back)?;
            ray = CheckRay {
                direction: -came.direction,
                ..came
            };
        }
        let ray = ray.begun();
        let begins = match light {
            Light::Area { shape, .. } => shape.contains(ray.point.x, ray.point.y),
            _ => true,
        };
        (begins && ray.direction.z > 0.0).then(|| (ray, strength(light, &ray)))
    }

    /// Returns the arrival of a ray as theory predicts it.
    pub(super) fn theory(&self, light: CheckRay) -> PlaneArrival {
        self.follow(light, |_| {})
    }

    /// Returns the arrival of a ray as theory predicts it; `tell` receives the straight pieces of
    /// the ray's path in order.
    fn follow(&self, light: CheckRay, mut tell: impl FnMut(PathPiece)) -> PlaneArrival {
        let path = &self.scene.path;
        let piece = |leg: usize, ray: CheckRay, end: f64| PathPiece {
            leg,
            ray,
            extent: [self.around.rounding(leg), end],
            leaves: path.legs[leg].leaves.map(|hit| hit.object),
            ends: path.ends_at(leg).map(|hit| hit.object),
            is_last: leg == self.plane.leg,
        };
        let mut ray = light;
        let mut share = 1.0;
        for (leg, element) in self.system.elements.iter().enumerate() {
            let t = ray.theory_hit(&element.patch)?;
            tell(piece(leg, ray, t));
            share *= self.passed(leg, &ray, t);
            ray = self.turned(leg, on(&element.patch, ray.at(t)), &ray)?;
        }
        tell(piece(self.plane.leg, ray, self.end(&ray)));
        Some((coordinates(self.at, &ray, self.counted_at(&ray)?)?, share))
    }

    /// Returns the length of a ray of the last leg. The ray ends at the plane, or at the surface on
    /// which the plane lies.
    fn end(&self, ray: &CheckRay) -> f64 {
        let across = self.around.to_plane(ray);
        let ends = self.scene.path.ends_at(self.plane.leg);
        let surface = ends.filter(|_| self.at.is_arriving());
        let hit = surface.and_then(|hit| self.around.hit(ray, 0.0, hit.object));
        hit.unwrap_or(across)
    }

    /// Returns the share of a ray that passes the blockers that theory includes on the first leg.
    pub(super) fn passed(&self, leg: usize, ray: &CheckRay, end: f64) -> f64 {
        if leg == 0 {
            self.around.first_leg(ray, end).0[1]
        } else {
            1.0
        }
    }

    /// If the plane is on a surface, returns the point of the surface at which theory counts a ray
    /// of the last leg, and the unit normal at this point. Returns `None` where the ray does not
    /// meet the surface.
    pub(super) fn counted_at(&self, ray: &CheckRay) -> Option<Option<[DVec3; 2]>> {
        let Some(patch) = self.at.patch.as_ref() else {
            return Some(None);
        };
        let point = if self.at.is_arriving() {
            ray.at(ray.front_hit(patch, self.at.frame.d)?)
        } else {
            ray.point
        };
        Some(Some(on(patch, point)))
    }

    /// Returns the arrival of a photon, and the first object that the photon meets and that theory
    /// ignores.
    fn photon(&self, light: CheckRay) -> (PlaneArrival, Option<Meets>) {
        let mut ray = light;
        let mut share = 1.0;
        let mut unforeseen: Option<Meets> = None;
        for (leg, element) in self.system.elements.iter().enumerate() {
            let expected = self.scene.path.legs[leg + 1].leaves.map(|hit| hit.object);
            let theory = ray.theory_hit(&element.patch);
            let (t, meets) = self.next(&ray, leg, expected, theory);
            unforeseen = unforeseen.or(meets);
            let Some(t) = t else {
                return (None, unforeseen);
            };
            if leg == 0 {
                let ([passes, _], meets) = self.around.first_leg(&ray, t);
                share = passes;
                unforeseen = unforeseen.or(meets);
            } else {
                let from = self.around.rounding(leg);
                unforeseen = unforeseen.or_else(|| self.around.later_leg(&ray, leg, from, t));
            }
            let Some(turned) = self.turned(leg, on(&element.patch, ray.at(t)), &ray) else {
                return (None, unforeseen);
            };
            ray = turned;
        }
        let (seen, meets) = self.last_leg(&ray);
        (seen.map(|z| (z, share)), unforeseen.or(meets))
    }

    /// Returns the distance at which a photon meets the surface that ends its leg; `None` where it
    /// meets another surface first.
    fn next(
        &self,
        ray: &CheckRay,
        leg: usize,
        expected: Option<Object>,
        theory: Option<f64>,
    ) -> (Option<f64>, Option<Meets>) {
        let met = self.around.first(ray, self.around.rounding(leg), None);
        if let Some(Object::Mesh(_)) = expected {
            let nearer = met.filter(|(t, _)| theory.is_some_and(|theory| *t < theory));
            return (theory, nearer.map(|(_, object)| Meets::OutOfTurn(object)));
        }
        let leaves = self.scene.path.legs[leg].leaves.map(|hit| hit.object);
        match met {
            None => (None, None),
            Some((t, object)) if Some(object) == expected => {
                let same = theory.is_some_and(|theory| (t - theory).abs() < SAME_DISTANCE * t);
                (Some(t), (!same).then_some(Meets::Itself(object)))
            }
            Some((_, object)) if Some(object) == leaves => (None, Some(Meets::Itself(object))),
            Some((_, object)) => (None, Some(Meets::OutOfTurn(object))),
        }
    }

    /// Returns the coordinates at the plane of a photon that has met all surfaces before the plane.
    fn last_leg(&self, ray: &CheckRay) -> (Option<TwoPlane>, Option<Meets>) {
        let path = &self.scene.path;
        let leg = self.plane.leg;
        let ends = path.ends_at(leg).map(|hit| hit.object);
        let leaves = path.legs[leg].leaves.map(|hit| hit.object);
        let from = self.around.rounding(leg);
        let end = self.end(ray);
        let nearer = self.around.first(ray, from, ends);
        let nearer = nearer.filter(|(t, object)| *t < end && Some(*object) != leaves);
        // A photon is lost for every position of the plane if its line returns to the surface that
        // it has left. This holds even if something stops the photon earlier.
        let again = leaves.filter(|left| self.around.hit(ray, from, *left).is_some());
        let mut unforeseen = nearer
            .map(|(_, object)| Meets::OutOfTurn(object))
            .or(again.map(Meets::Itself));
        if leg > 0 {
            unforeseen = unforeseen.or_else(|| self.around.later_leg(ray, leg, from, end));
        } else if self.at.is_arriving() {
            // For a plane across the leg, blockers and plane are parallel.
            unforeseen = unforeseen.or(self.around.first_leg(ray, end).1);
        }
        let Some(patch) = &self.at.patch else {
            return (coordinates(self.at, ray, None), unforeseen);
        };
        let Some(counted) = self.counted(patch, ray) else {
            return (None, unforeseen);
        };
        let scale = SAME_DISTANCE * counted.length();
        if !self.at.is_arriving() && ray.point.distance(counted) > scale {
            unforeseen = unforeseen.or(leaves.map(Meets::Itself));
        }
        let seen = coordinates(self.at, ray, Some(on(patch, counted)));
        (seen, unforeseen)
    }

    /// Returns the point at which a plane on a surface counts a photon. An arriving photon counts
    /// where it meets the front of the surface. The line of a leaving photon may intersect the
    /// surface twice. The photon then counts at the intersection that is nearest to the hit of the
    /// central ray.
    fn counted(&self, patch: &Patch, ray: &CheckRay) -> Option<DVec3> {
        if self.at.is_arriving() {
            return Some(ray.at(ray.front_hit(patch, self.at.frame.d)?));
        }
        let local = ray.seen_from(&patch.frame);
        let hits = patch.hits(local.point, local.direction).into_iter();
        let points = hits.filter(|t| !t.is_nan()).map(|t| ray.at(t));
        let center = self.at.frame.origin;
        points.min_by(|a, b| a.distance(center).total_cmp(&b.distance(center)))
    }

    /// Returns the ray that leaves the surface at the end of a leg.
    pub(super) fn turned(&self, leg: usize, at: [DVec3; 2], ray: &CheckRay) -> Option<CheckRay> {
        let [point, normal] = at;
        let element = &self.system.elements[leg];
        let frame = &element.patch.frame;
        let direction = element.event.turned(frame, normal, point, ray.direction)?;
        let direction = direction.normalize();
        Some(CheckRay { point, direction })
    }
}

/// Returns a point of a surface and the unit normal there.
pub(super) fn on(patch: &Patch, point: DVec3) -> [DVec3; 2] {
    [point, patch.normal(point)]
}
