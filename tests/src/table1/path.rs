//! A 2D path with one surface, its operators and its rays.

use etendue_theory::geometry::{AffineMap, Media};

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

    /// Returns the map composed of all operators up to a stage of the path.
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
        let point = [-cos * x, sin * x];
        let along = -omega(self.theta0 + theta);
        let point = [point[0], point[1]];
        let on_tangent = point[0] - point[1] / along.1 * along.0;
        let from = self.theta0 + theta;
        if stage == Incidence {
            return [on_tangent, from];
        }
        let hit = self.hit(point, along);
        let tilt = (self.k * hit[0]).asin();
        if stage == Curvature {
            return [hit[0], from - tilt];
        }
        let local = match self.media {
            Some(media) => (media.index_ratio() * (from - tilt).sin()).asin(),
            None => tilt - from,
        };
        if stage == Event {
            return [hit[0], local];
        }
        let global = local + tilt;
        let away = omega(global);
        let back = hit[0] - hit[1] / away.1 * away.0;
        if stage == Back {
            return [back, global];
        }
        // After the surface X is c₁ T − sin θ₁ N for reflected light, and its opposite for
        // transmitted light.
        let theta1 = self.theta1();
        let (sin, cos) = theta1.sin_cos();
        let sign = if self.media.is_some() { -1.0 } else { 1.0 };
        let axis = [sign * cos, -sign * sin];
        let central = omega(theta1);
        let height = hit[0] * central.0 + hit[1] * central.1;
        let advance = away.0 * central.0 + away.1 * central.1;
        let at = [
            hit[0] - height / advance * away.0,
            hit[1] - height / advance * away.1,
        ];
        let x = at[0] * axis[0] + at[1] * axis[1];
        let theta = global - theta1;
        if stage == Outgoing {
            return [x, theta];
        }
        [x + self.travels[1] * theta.tan(), theta]
    }

    /// Returns the point where a line hits the circle near the origin.
    fn hit(&self, [s, h]: [f64; 2], along: Direction) -> [f64; 2] {
        let Direction(a, b) = along;
        // k (s² + h²) + 2 h = 0.
        let (p, q) = (self.k, self.k * (s * a + h * b) + b);
        let c = self.k * (s * s + h * h) + 2.0 * h;
        let t = -c / (q + (q * q - p * c).sqrt().copysign(q));
        [s + t * a, h + t * b]
    }
}

#[derive(Clone, Copy)]
struct Direction(f64, f64);

impl std::ops::Neg for Direction {
    type Output = Self;

    fn neg(self) -> Self {
        Self(-self.0, -self.1)
    }
}

/// Returns the unit vector sin θ T + cos θ N.
fn omega(theta: f64) -> Direction {
    Direction(theta.sin(), theta.cos())
}
