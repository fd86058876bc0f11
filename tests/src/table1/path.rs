//! A 2D path with one surface, its operators and its rays.

use etendue_theory::geometry::{AffineMap, Media};
use glam::DVec2;

/// Steps of the path, in the order in which light passes them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum PathStage {
    Travel,
    Incidence,
    Curvature,
    Event,
    Back,
    Outgoing,
    Beyond,
}

use PathStage::{Back, Beyond, Curvature, Event, Incidence, Outgoing, Travel};

/// A path with travel and one surface, which is a mirror or, if media are given, an interface.
#[derive(Clone, Copy, Debug)]
pub(super) struct MirrorPath {
    /// Metres of travel before and after the surface.
    pub(super) travels: [f64; 2],
    pub(super) theta0: f64,
    pub(super) k: f64,
    pub(super) media: Option<Media>,
}

impl MirrorPath {
    fn theta1(&self) -> f64 {
        match self.media {
            Some(media) => media.refracted(self.theta0).unwrap_or(f64::NAN),
            None => -self.theta0,
        }
    }

    /// The map composed of all operators up to a stage of the path.
    pub(super) fn map(&self, stage: PathStage) -> AffineMap<2> {
        let theta1 = self.theta1();
        let event = match &self.media {
            Some(media) => {
                AffineMap::<2>::refraction(self.theta0, media).unwrap_or(AffineMap::identity())
            }
            None => AffineMap::mirror(),
        };
        let off = match self.media {
            Some(_) => AffineMap::<2>::incidence(theta1)
                .inverse()
                .unwrap_or(AffineMap::identity()),
            None => AffineMap::<2>::outgoing(theta1),
        };
        let steps = [
            (Travel, AffineMap::travel(self.travels[0])),
            (Incidence, AffineMap::<2>::incidence(self.theta0)),
            (Curvature, AffineMap::<2>::curvature(self.k)),
            (Event, event),
            (Back, AffineMap::<2>::back(self.k)),
            (Outgoing, off),
            (Beyond, AffineMap::travel(self.travels[1])),
        ];
        let mut map = AffineMap::identity();
        for (step, next) in steps {
            map = map.then(&next);
            if step == stage {
                break;
            }
        }
        map
    }

    /// Traces a ray exactly, from (x, θ) at the light to the coordinates of a stage.
    pub(super) fn trace(&self, stage: PathStage, [x, theta]: [f64; 2]) -> [f64; 2] {
        let x = x + self.travels[0] * theta.tan();
        if stage == Travel {
            return [x, theta];
        }
        // Light comes from the direction ω(θ₀), which is −D, and X is −c₀ T + sin θ₀ N; vectors
        // have components along (T, N).
        let (sin, cos) = self.theta0.sin_cos();
        let point = DVec2::new(-cos * x, sin * x);
        let along = -omega(self.theta0 + theta);
        let on_tangent = point.x - point.y / along.y * along.x;
        let from = self.theta0 + theta;
        if stage == Incidence {
            return [on_tangent, from];
        }
        let hit = on_circle(self.k, point, along);
        let tilt = (self.k * hit.x).asin();
        if stage == Curvature {
            return [hit.x, from - tilt];
        }
        let local = match self.media {
            Some(media) => (media.index_ratio() * (from - tilt).sin()).asin(),
            None => tilt - from,
        };
        if stage == Event {
            return [hit.x, local];
        }
        let global = local + tilt;
        let away = omega(global);
        let back = hit.x - hit.y / away.y * away.x;
        if stage == Back {
            return [back, global];
        }
        // After the surface X is c₁ T − sin θ₁ N for reflected light, and its opposite for
        // transmitted light.
        let theta1 = self.theta1();
        let (sin, cos) = theta1.sin_cos();
        let sign = if self.media.is_some() { -1.0 } else { 1.0 };
        let axis = DVec2::new(sign * cos, -sign * sin);
        let central = omega(theta1);
        let at = hit - hit.dot(central) / away.dot(central) * away;
        let x = at.dot(axis);
        let theta = global - theta1;
        if stage == Outgoing {
            return [x, theta];
        }
        [x + self.travels[1] * theta.tan(), theta]
    }
}

/// The point near the origin where a line meets the circle of curvature k that touches the
/// axis T at the origin.
pub(crate) fn on_circle(k: f64, point: DVec2, along: DVec2) -> DVec2 {
    // k (s² + h²) + 2 h = 0, for the point (s, h).
    let q = k * point.dot(along) + along.y;
    let c = k * point.length_squared() + 2.0 * point.y;
    let t = -c / (q + (q * q - k * c).sqrt().copysign(q));
    point + t * along
}

/// The unit vector sin θ T + cos θ N.
fn omega(theta: f64) -> DVec2 {
    DVec2::new(theta.sin(), theta.cos())
}
