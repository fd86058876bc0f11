//! Checks, for light that a surface with a BRDF scatters, whether photons meet only what theory
//! assumes.

use super::clearance::PathPiece;
use super::coordinates::{coordinates, direction, seen};
use super::rays::{CheckRay, RayDraw, point_on, ray_to, within};
use super::search::{Followed, found};
use super::surroundings::{Meets, Surroundings, TakenLayer, unforeseen};
use etendue_field::{Orientation, VirtualPlane};
use etendue_scene::{Hit, Scene};
use etendue_theory::Observed;
use etendue_theory::rays::Plane;
use etendue_theory::scattering::ScatteringSystem;

/// Describes objects that theory ignores although light on its way to a plane meets them, before or
/// behind a surface with a BRDF. Also returns the blockers that theory includes.
pub(crate) fn unforeseen_by_scattering(
    scene: &Scene,
    plane: &VirtualPlane,
    view: &Observed<ScatteringSystem>,
) -> (Vec<String>, Vec<TakenLayer>) {
    let Some(hit) = scene.path.ends_at(0) else {
        return (Vec::new(), Vec::new());
    };
    unforeseen(scene, Surroundings::new(scene, plane), |around| {
        found(&CheckedScatterer {
            scene,
            plane,
            system: &view.system,
            at: &view.plane,
            hit,
            around,
        })
    })
}

struct CheckedScatterer<'a> {
    scene: &'a Scene,
    plane: &'a VirtualPlane,
    system: &'a ScatteringSystem,
    at: &'a Plane,
    hit: &'a Hit,
    around: &'a Surroundings<'a>,
}

impl Followed for CheckedScatterer<'_> {
    fn check(&self, draw: &RayDraw) -> Option<(f64, Option<Meets>)> {
        let LightPath {
            light,
            arriving,
            end,
            meets,
            leaving,
        } = self.follow(draw)?;
        let meets = self
            .shadow(&arriving, end)
            .or(meets)
            .or_else(|| self.beyond(&leaving));
        let clear = meets.is_none();
        let itself = Meets::Itself(self.hit.object);
        let is_wrong = clear != self.looks_at(&leaving);
        Some((light, is_wrong.then(|| meets.unwrap_or(itself))))
    }

    fn pieces(&self, draw: &RayDraw) -> Option<(f64, Vec<PathPiece>)> {
        let path = self.follow(draw)?;
        let own = Some(self.hit.object);
        let arriving = PathPiece {
            leg: 0,
            ray: path.arriving,
            extent: [0.0, path.end],
            leaves: None,
            ends: own,
            is_last: false,
        };
        let leaving = PathPiece {
            leg: 1,
            ray: path.leaving,
            extent: [self.around.rounding(1), self.around.to_plane(&path.leaving)],
            leaves: own,
            ends: self.scene.path.ends_at(1).map(|hit| hit.object),
            is_last: true,
        };
        Some((path.light, vec![arriving, leaving]))
    }

    fn around(&self) -> &Surroundings<'_> {
        self.around
    }
}

/// A path of light that arrives at the surface and goes from the surface into the window.
struct LightPath {
    light: f64,
    arriving: CheckRay,
    /// Distance of the surface from the light.
    end: f64,
    /// Blockers on the way to the surface that theory does not include.
    meets: Option<Meets>,
    leaving: CheckRay,
}

impl CheckedScatterer<'_> {
    /// Returns a path from the light to the window; `None` if the path brings no light.
    fn follow(&self, draw: &RayDraw) -> Option<LightPath> {
        let leaving = self.leaving(draw)?;
        let CheckRay { point, direction } = leaving;
        let normal = self.system.patch.normal(point);
        let window = &self.plane.window;
        let z = coordinates(self.at, &leaving, Some([point, normal]))?;
        let r = draw.numbers;
        let (arriving, emitted) = ray_to(&self.system.light, point, draw.index, [r[4], r[5]])?;
        let faces = arriving.direction.dot(normal) < 0.0 && direction.dot(normal) > 0.0;
        let end = (point - arriving.point).length();
        let ([photons, theory], meets) = self.around.first_leg(&arriving, end);
        let light = emitted * photons.max(theory) * window.value(&z);
        (faces && light > 0.0).then_some(LightPath {
            light,
            arriving,
            end,
            meets,
            leaving,
        })
    }

    /// Returns a ray that leaves the surface. The ray starts at a point of the surface. If the
    /// plane lies across the leg, every second ray is traced back from the window instead.
    fn leaving(&self, draw: &RayDraw) -> Option<CheckRay> {
        let r = draw.numbers;
        let [x, y, u, v] = within(&self.plane.window, r);
        let patch = &self.system.patch;
        if self.at.orientation == Orientation::Orthogonal && draw.index % 4 < 2 {
            let seen = seen(self.at, [x, y, u, v])?;
            let back = seen.back(patch);
            let point = back.at(back.theory_hit(patch)?);
            return Some(CheckRay { point, ..seen });
        }
        let point = point_on(patch, self.hit.point, draw.index, [r[0], r[1]])?;
        let direction = direction(self.at, patch.normal(point), [u, v]);
        Some(CheckRay { point, direction })
    }

    /// Returns the occluder between the light and a point of the surface.
    fn shadow(&self, ray: &CheckRay, end: f64) -> Option<Meets> {
        let (t, object) = self.around.first(ray, 0.0, None)?;
        let before = t < end * (1.0 - 1e-9);
        before.then(|| self.named(object))
    }

    /// Returns the occluder between a point of the surface and the plane. The surface itself counts
    /// at any distance, because a photon that would meet the surface again is lost, even if
    /// something stops the photon before.
    fn beyond(&self, ray: &CheckRay) -> Option<Meets> {
        let end = self.around.to_plane(ray);
        let from = self.around.rounding(1);
        let ends = self.scene.path.ends_at(1).map(|hit| hit.object);
        let met = self.around.first(ray, from, ends);
        let met = met.filter(|(t, _)| *t < end);
        let own = self.hit.object;
        let again = self.around.hit(ray, from, own).is_some();
        let met = met
            .map(|(_, object)| self.named(object))
            .or(again.then_some(Meets::Itself(own)));
        met.or_else(|| self.around.later_leg(ray, 1, from, end))
    }

    fn named(&self, object: etendue_scene::Object) -> Meets {
        if object == self.hit.object {
            Meets::Itself(object)
        } else {
            Meets::OutOfTurn(object)
        }
    }

    /// Checks whether theory assumes that the ray leaves from this point. Theory traces the ray
    /// backwards from far away.
    fn looks_at(&self, leaving: &CheckRay) -> bool {
        let back = leaving.back(&self.system.patch);
        let far = (back.point - leaving.point).length();
        let found = back.theory_hit(&self.system.patch);
        found.is_some_and(|t| (t - far).abs() < 1e-6 * far)
    }
}
