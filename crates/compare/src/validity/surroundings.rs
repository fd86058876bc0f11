//! The surroundings of the path. The module finds the objects that a ray of a leg meets there.

use super::rays::CheckRay;
use crate::chain::stands_before;
use etendue_field::{Mask, Patch, Shape, VirtualPlane};
use etendue_scene::{Hit, Object, Scene, Surface};
use glam::DVec3;

/// An object that a ray meets and theory ignores.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Meets {
    /// Blockers that the ray meets on this leg.
    Layer { index: usize, leg: usize },
    /// A surface of the path that the ray meets where theory does not expect this surface.
    OutOfTurn(Object),
    /// The surface that the ray has just left, or another part of the surface at which the ray
    /// arrives.
    Itself(Object),
}

impl Meets {
    /// Returns the description in words; `None` for blockers, which theory includes.
    fn describe(self, scene: &Scene) -> Option<String> {
        match self {
            Self::Layer { .. } => None,
            Self::OutOfTurn(object) => {
                let name = scene.name_of(object);
                Some(format!("light that meets {name} out of order"))
            }
            Self::Itself(object) => {
                let name = scene.name_of(object);
                Some(format!(
                    "light that meets {name} twice, or meets {name} in its own shadow"
                ))
            }
        }
    }
}

/// Describes the objects that light meets and theory ignores, without duplicates. Also returns the
/// blockers that light meets at places where the central ray does not meet them. Theory then
/// includes these blockers.
///
/// A ray reports only the first thing that it meets. Therefore these blockers are included in the
/// theory and rays are traced again, until the rays meet no further blockers.
pub(super) fn unforeseen<'a>(
    scene: &Scene,
    mut around: Surroundings<'a>,
    found: impl Fn(&Surroundings<'a>) -> Vec<Meets>,
) -> (Vec<String>, Vec<TakenLayer>) {
    loop {
        let meets = found(&around);
        let mut has_more = false;
        for layer in &meets {
            let Meets::Layer { index, leg } = *layer else {
                continue;
            };
            if !around.has_taken(index, leg) {
                around.take(index, leg);
                has_more = true;
            }
        }
        if !has_more {
            return (in_words(meets, scene), around.taken);
        }
    }
}

fn in_words(found: Vec<Meets>, scene: &Scene) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    for reason in found.into_iter().filter_map(|meets| meets.describe(scene)) {
        if !words.contains(&reason) {
            words.push(reason);
        }
    }
    words
}

/// The surfaces of the path as rays meet them, and the blockers.
pub(super) struct Surroundings<'a> {
    pub(super) scene: &'a Scene,
    plane: &'a VirtualPlane,
    pub(super) objects: Vec<(Object, SurroundingForm<'a>)>,
    /// Blockers that theory includes at every place where light meets them.
    pub(super) taken: Vec<TakenLayer>,
    /// The shapes of each layer of the scene.
    rows: Vec<Rows<'a>>,
}

/// The shapes of a layer of blockers in the order of their lower edges, so that a point is tested
/// against the shapes of its row alone.
struct Rows<'a> {
    /// Shapes with their lower edges.
    shapes: Vec<(f64, &'a Shape)>,
    /// The largest height of a shape.
    tallest: f64,
}

impl<'a> Rows<'a> {
    fn new(mask: &'a Mask) -> Self {
        let shapes: &[Shape] = match mask {
            Mask::Opaque { shapes, .. } => shapes,
            Mask::Grating(_) | Mask::Aperture(_) => &[],
        };
        let bounds = shapes.iter().map(|shape| (shape.bounds(), shape));
        let lower = bounds.map(|(b, shape)| (b.center[1] - 0.5 * b.size[1], shape));
        let mut lower: Vec<(f64, &Shape)> = lower.collect();
        lower.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        let heights = shapes.iter().map(|shape| shape.bounds().size[1]);
        Self {
            shapes: lower,
            tallest: heights.fold(0.0, f64::max),
        }
    }

    fn contain(&self, x: f64, y: f64) -> bool {
        let margin = ROUNDING * (y.abs() + self.tallest);
        let first = y - self.tallest - margin;
        let from = self.shapes.partition_point(|(low, _)| *low < first);
        let row = self.shapes[from..].iter();
        let mut row = row.take_while(|(low, _)| *low <= y + margin);
        row.any(|(_, shape)| shape.contains(x, y))
    }
}

/// Blockers that light meets at places where the central ray does not meet them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TakenLayer {
    /// Index among the layers of the scene.
    pub(crate) index: usize,
    /// The first leg on which light meets the blockers.
    pub(crate) from: usize,
}

pub(super) enum SurroundingForm<'a> {
    Smooth(Patch),
    Flat(&'a Surface),
    /// A box around a mesh: its lowest and highest corners.
    Around([DVec3; 2]),
}

/// Rounding error, as a share of a distance.
const ROUNDING: f64 = 1e-9;

impl<'a> Surroundings<'a> {
    /// Collects the surroundings. Meshes that the plane's light has left are excluded, because
    /// theory represents each of them by a surface that osculates the mesh at the hit of the
    /// central ray.
    pub(super) fn new(scene: &'a Scene, plane: &'a VirtualPlane) -> Self {
        let mut objects: Vec<(Object, SurroundingForm<'a>)> = Vec::new();
        for (leg, hit) in scene.path.legs.iter().map(|leg| leg.leaves).enumerate() {
            let Some(hit) = hit else { continue };
            let form = match hit.object {
                Object::Patch(i) => SurroundingForm::Smooth(scene.patches[i].patch),
                Object::Surface(i) => SurroundingForm::Flat(&scene.surfaces[i]),
                Object::Mesh(_) if leg <= plane.leg => continue,
                Object::Mesh(i) => SurroundingForm::Around(scene.meshes[i].triangles.bounds()),
            };
            if objects.iter().all(|(object, _)| *object != hit.object) {
                objects.push((hit.object, form));
            }
        }
        Self {
            scene,
            plane,
            objects,
            taken: Vec::new(),
            rows: scene.blockers.iter().map(|b| Rows::new(&b.mask)).collect(),
        }
    }

    /// Returns the rounding error of a distance on a leg.
    pub(super) fn rounding(&self, leg: usize) -> f64 {
        let leg = &self.scene.path.legs[leg];
        ROUNDING * (leg.start + leg.leaves.map_or(0.0, |Hit { point, .. }| point.length()))
    }

    /// Returns the distance along a ray of the last leg at which the ray crosses the plane. If the
    /// plane lies on a surface, the function uses a plane across the leg through the point that the
    /// central ray hits.
    pub(super) fn to_plane(&self, ray: &CheckRay) -> f64 {
        let path = &self.scene.path;
        let leg = &path.legs[self.plane.leg];
        let across = leg.frame.travelled(path.along(self.plane));
        let local = ray.seen_from(&across);
        -local.point.z / local.direction.z
    }

    /// Returns the surface that a ray meets first beyond `from`, and the distance of this hit. The
    /// object `ignored` is skipped.
    pub(super) fn first(
        &self,
        ray: &CheckRay,
        from: f64,
        ignored: Option<Object>,
    ) -> Option<(f64, Object)> {
        let others = self
            .objects
            .iter()
            .filter(|(object, _)| Some(*object) != ignored);
        let hits = others.flat_map(|(object, form)| {
            form.hits(ray)
                .into_iter()
                .filter(|t| *t > from)
                .map(|t| (t, *object))
        });
        hits.min_by(|(a, _), (b, _)| a.total_cmp(b))
    }

    /// Returns the distance at which a ray meets an object beyond `from`, even if the ray meets
    /// another object first.
    pub(super) fn hit(&self, ray: &CheckRay, from: f64, what: Object) -> Option<f64> {
        let forms = self.objects.iter().filter(|(object, _)| *object == what);
        let hits = forms.flat_map(|(_, form)| form.hits(ray));
        hits.filter(|t| *t > from).min_by(f64::total_cmp)
    }

    /// Returns two shares of the light on a ray of the first leg. The first share passes the
    /// blockers before `end`. The second share passes the blockers that theory places before the
    /// plane.
    pub(super) fn first_leg(&self, ray: &CheckRay, end: f64) -> ([f64; 2], Option<Meets>) {
        let mut shares = [1.0; 2];
        let mut meets = None;
        for index in 0..self.scene.blockers.len() {
            let known = self.is_known(index);
            let crossed = self.crossing(ray, index).filter(|t| *t > 0.0 && *t < end);
            let passes = self.transmittance(ray, index);
            if self.has_taken(index, 0) {
                if crossed.is_some() {
                    shares = shares.map(|share| share * passes);
                }
                continue;
            }
            if crossed.is_some() {
                shares[0] *= passes;
            }
            if known {
                shares[1] *= passes;
            }
            if known != crossed.is_some() && passes < 1.0 {
                meets = meets.or(Some(Meets::Layer { index, leg: 0 }));
            }
        }
        (shares, meets)
    }

    /// Returns the blockers that a ray of a later leg meets between `from` and `end`.
    pub(super) fn later_leg(
        &self,
        ray: &CheckRay,
        leg: usize,
        from: f64,
        end: f64,
    ) -> Option<Meets> {
        let met = |index: &usize| {
            let crossed = self.crossing(ray, *index);
            crossed.is_some_and(|t| t > from && t < end) && self.transmittance(ray, *index) < 1.0
        };
        let mut unknown = (0..self.scene.blockers.len()).filter(|i| !self.has_taken(*i, leg));
        let index = unknown.find(met)?;
        Some(Meets::Layer { index, leg })
    }

    /// Checks whether the prediction includes every place on a leg where light meets these
    /// blockers.
    pub(super) fn has_taken(&self, index: usize, leg: usize) -> bool {
        let mut taken = self.taken.iter();
        taken.any(|layer| layer.index == index && layer.from <= leg)
    }

    fn take(&mut self, index: usize, from: usize) {
        self.taken.retain(|layer| layer.index != index);
        self.taken.push(TakenLayer { index, from });
    }

    /// Checks whether theory includes a layer of blockers on the first leg, before the plane.
    pub(super) fn is_known(&self, index: usize) -> bool {
        stands_before(self.scene.blockers[index].distance, self.scene, self.plane)
    }

    /// Returns the distance at which a ray crosses the plane of blockers.
    pub(super) fn crossing(&self, ray: &CheckRay, index: usize) -> Option<f64> {
        let t = (self.scene.blockers[index].distance - ray.point.z) / ray.direction.z;
        t.is_finite().then_some(t)
    }

    fn transmittance(&self, ray: &CheckRay, index: usize) -> f64 {
        let at = self.crossing(ray, index).map(|t| ray.at(t));
        let through = |at: DVec3| match &self.scene.blockers[index].mask {
            Mask::Opaque { half_planes, .. } => {
                let stops = self.rows[index].contain(at.x, at.y)
                    || half_planes.iter().any(|half| half.contains(at.x, at.y));
                f64::from(u8::from(!stops))
            }
            mask => mask.transmittance(at.x, at.y),
        };
        at.map_or(1.0, through)
    }
}

impl SurroundingForm<'_> {
    /// Returns the distances at which a ray meets the box or the surface, or NaN if the ray misses
    /// it.
    fn hits(&self, ray: &CheckRay) -> [f64; 2] {
        match self {
            Self::Around([low, high]) => {
                let [a, b] = [*low, *high].map(|corner| (corner - ray.point) / ray.direction);
                let [first, last] = [a.min(b).max_element(), a.max(b).min_element()];
                if first <= last {
                    [first, last]
                } else {
                    [f64::NAN; 2]
                }
            }
            Self::Smooth(patch) => {
                let local = ray.seen_from(&patch.frame);
                patch.hits(local.point, local.direction)
            }
            Self::Flat(surface) => {
                let local = ray.seen_from(&surface.frame);
                let t = -local.point.z / local.direction.z;
                let at = local.at(t);
                let [x, y] = surface.size;
                let inside = 2.0 * at.x.abs() <= x && 2.0 * at.y.abs() <= y;
                [if inside { t } else { f64::NAN }, f64::NAN]
            }
        }
    }
}
