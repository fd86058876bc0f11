//! Defines smooth surfaces as solids: a plane, a ball, a round bar and a paraboloid.

use super::vector::{Axes, Vector, aside, dot, length, plus, times, unit};
use super::world::{World, triple};
use crate::hostile::dice::Dice;

/// The form of the surface, as named in a scene file.
#[derive(Clone, Copy, Debug)]
pub(super) enum Form {
    Plane,
    Sphere(f64),
    Cylinder(f64),
    Paraboloid(f64, f64),
}

/// A surface in axes whose origin is the vertex; the surface faces along D, and its first
/// curvature is along X.
#[derive(Clone, Copy, Debug)]
pub(super) struct Smooth {
    pub(super) axes: Axes,
    pub(super) form: Form,
    pub(super) aperture: f64,
}

impl Smooth {
    /// A surface with its vertex on the central ray, tilted by up to `most` radians, and
    /// the scene-file text of this surface without its event.
    pub(super) fn new(dice: &mut Dice, world: &World, most: f64) -> (Self, String) {
        let tilt = dice.between(0.1, most);
        let facing = aside(dice, times(-1.0, world.light.d), tilt);
        let lean = dice.between(0.5, 2.5);
        let along = aside(dice, facing, lean);
        let mut curvature = || {
            let sign = if dice.one_in(2) { 1.0 } else { -1.0 };
            sign * dice.between(0.3, 1.0)
        };
        let (k, l) = (curvature(), curvature());
        let form = *dice.pick(&[
            Form::Plane,
            Form::Sphere(k),
            Form::Cylinder(k),
            Form::Paraboloid(k, l),
        ]);
        let center = world.light.point([0.0, 0.0, 1.0]);
        let aperture = 0.6;
        let words = format!(
            "Smooth(name: \"it\", center: {}, facing: {}, along: {}, form: {form:?}, \
             aperture: {aperture:?}, event: ",
            triple(center),
            triple(times(2.0, facing)),
            triple(along)
        );
        let axes = Axes::new(center, facing, along);
        let smooth = Self {
            axes,
            form,
            aperture,
        };
        (smooth, words)
    }

    /// The surface after the named fault is planted in it.
    pub(super) fn wrong(mut self, fault: &str) -> Self {
        let Axes { origin, x, y, d } = self.axes;
        match (fault, self.form) {
            ("axes swapped", _) => self.axes = Axes::new(origin, d, y),
            ("direction along reversed", _) => self.axes = Axes::new(origin, d, times(-1.0, x)),
            ("hollow instead of convex", Form::Sphere(k)) => self.form = Form::Sphere(-k),
            ("hollow instead of convex", Form::Cylinder(k)) => self.form = Form::Cylinder(-k),
            ("hollow instead of convex", Form::Paraboloid(k, l)) => {
                self.form = Form::Paraboloid(-k, -l);
            }
            ("curvature is the diameter's", Form::Sphere(k)) => self.form = Form::Sphere(2.0 * k),
            ("aperture is a diameter", _) => self.aperture *= 0.5,
            _ => {}
        }
        self
    }

    /// The centre of the ball, or the point of the bar's axis nearest to the vertex; if
    /// the surface is convex, this point is behind the vertex.
    fn middle(&self, k: f64) -> Vector {
        plus(self.axes.origin, -1.0 / k, self.axes.d)
    }

    /// The point of the surface with the coordinates s and t on its tangent plane.
    pub(super) fn point(&self, s: f64, t: f64) -> Vector {
        // Returns the depth of a circle of radius 1/k below its tangent.
        let sagged = |k: f64, r2: f64| (1.0 - (1.0 - k * k * r2).sqrt()) / k;
        let below = match self.form {
            Form::Plane => 0.0,
            Form::Sphere(k) => sagged(k, s * s + t * t),
            Form::Cylinder(k) => sagged(k, s * s),
            Form::Paraboloid(k, l) => 0.5 * (k * s * s + l * t * t),
        };
        self.axes.point([s, t, -below])
    }

    /// The normal of the surface at a point, on the side that the surface faces.
    pub(super) fn normal(&self, point: Vector) -> Vector {
        match self.form {
            Form::Plane => self.axes.d,
            Form::Sphere(k) => unit(times(k, plus(point, -1.0, self.middle(k)))),
            Form::Cylinder(k) => unit(times(k, self.round(plus(point, -1.0, self.middle(k))))),
            Form::Paraboloid(k, l) => {
                let [s, t, _] = self.axes.coordinates(point);
                unit(self.axes.vector([k * s, l * t, 1.0]))
            }
        }
    }

    /// The component of a vector perpendicular to the bar, whose axis is along Y.
    fn round(&self, a: Vector) -> Vector {
        plus(a, -dot(a, self.axes.y), self.axes.y)
    }

    /// The distances of hits along a ray with a unit direction, nearest first.
    pub(super) fn hits(&self, start: Vector, towards: Vector) -> Vec<f64> {
        let roots = match self.form {
            Form::Plane => {
                let [.., height] = self.axes.coordinates(start);
                vec![-height / dot(towards, self.axes.d)]
            }
            Form::Sphere(k) => chord(plus(self.middle(k), -1.0, start), towards, 1.0 / k),
            Form::Cylinder(k) => {
                let to_middle = self.round(plus(self.middle(k), -1.0, start));
                let across = self.round(towards);
                let steps = chord(to_middle, unit(across), 1.0 / k);
                steps.into_iter().map(|t| t / length(across)).collect()
            }
            Form::Paraboloid(k, l) => {
                let [s, t, h] = self.axes.coordinates(start);
                let [ds, dt, dh] = self.axes.components(towards);
                let a = 0.5 * (k * ds * ds + l * dt * dt);
                let b = dh + k * s * ds + l * t * dt;
                let c = h + 0.5 * (k * s * s + l * t * t);
                let root = (b * b - 4.0 * a * c).sqrt();
                vec![(-b - root) / (2.0 * a), (-b + root) / (2.0 * a)]
            }
        };
        let mut met: Vec<f64> = roots
            .into_iter()
            .filter(|t| t.is_finite() && self.holds(plus(start, *t, towards)))
            .collect();
        met.sort_by(f64::total_cmp);
        met
    }

    /// Whether a point of the solid's surface is within the aperture and in the half of
    /// the solid around the vertex.
    fn holds(&self, point: Vector) -> bool {
        let [s, t, _] = self.axes.coordinates(point);
        s.hypot(t) <= self.aperture && dot(self.normal(point), self.axes.d) > 0.0
    }
}

/// Returns the distances at which a line enters and leaves a ball. The vector `to_middle` leads
/// from the start of the line to the centre of the ball.
fn chord(to_middle: Vector, towards: Vector, radius: f64) -> Vec<f64> {
    let nearest = dot(to_middle, towards);
    let off = length(plus(to_middle, -nearest, towards));
    let half = (radius * radius - off * off).sqrt();
    vec![nearest - half, nearest + half]
}
