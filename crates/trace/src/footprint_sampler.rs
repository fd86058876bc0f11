//! Samples points of the first surface, towards which the light of an environment is aimed.

use crate::area_sampler::AreaSampler;
use crate::line::{direction, start};
use crate::mesh::BlockerMesh;
use crate::obstacles::Around;
use crate::primitive::Primitive;
use crate::primitive_set::{PrimitiveSet, TaggedPrimitive};
use crate::reach::footprint;
use etendue_field::{Frame, Patch, TwoPlane, VirtualPlane};
use etendue_sampling::disc;
use etendue_scene::{Object, Scene};
use glam::DVec3;
use std::f64::consts::PI;

/// A surface with a density over its points, in the frame at the light.
#[derive(Debug)]
pub(crate) struct FootprintSampler {
    primitives: PrimitiveSet<()>,
    points: PatternPoints,
}

#[derive(Debug)]
enum PatternPoints {
    /// Uniform density over the area of flat pieces.
    Flat(AreaSampler),
    /// Uniform density over the disc in the tangent plane at the vertex of a smooth surface.
    Smooth(Patch),
}

impl FootprintSampler {
    /// Builds a sampler of the entire first surface, or of the part of it that contributes to a
    /// virtual plane; returns `None` if no part contributes.
    pub(crate) fn new(scene: &Scene, plane: Option<&VirtualPlane>) -> Option<Self> {
        let around = Around(Frame::IDENTITY);
        let tagged = |primitive| TaggedPrimitive { primitive, tag: () };
        let (primitives, points) = match scene.path.ends_at(0)?.object {
            Object::Surface(i) => {
                let mut surface = scene.surfaces[i].clone();
                if let Some(plane) = plane {
                    let [low, high] = footprint(scene, plane, &surface)?;
                    let middle = 0.5 * (low + high);
                    surface.frame.origin = surface.frame.to_world(middle.extend(0.0));
                    surface.size = (high - low).to_array();
                }
                let [a, b, _, d] = surface.corners();
                (
                    vec![tagged(around.surface(&surface))],
                    PatternPoints::Flat(AreaSampler::One([a, b, d])),
                )
            }
            Object::Mesh(i) => {
                let mesh = &scene.meshes[i];
                let pieces = AreaSampler::triangles(&mesh.triangles);
                // Lines are intersected with the flat triangles; interpolated normals are not
                // used.
                let mesh = BlockerMesh::new(&mesh.triangles, None, Frame::IDENTITY);
                let form = Primitive::Mesh(Box::new(mesh));
                (vec![tagged(form)], PatternPoints::Flat(pieces))
            }
            Object::Patch(i) => {
                let patch = scene.patches[i].patch;
                (
                    vec![tagged(Primitive::Smooth(Box::new(patch)))],
                    PatternPoints::Smooth(patch),
                )
            }
        };
        Some(Self {
            primitives: PrimitiveSet::new(&primitives, 0.0),
            points,
        })
    }

    /// A point of the surface, drawn with three random numbers in (0, 1).
    pub(crate) fn sample(&self, r: [f64; 3]) -> DVec3 {
        match &self.points {
            PatternPoints::Flat(pieces) => pieces.point(r).0,
            PatternPoints::Smooth(patch) => {
                let at = disc(patch.aperture, [r[0], r[1]]);
                patch.point(at.x, at.y)
            }
        }
    }

    /// The density of lines through a sampled point, with respect to dx dy in the plane
    /// at the beginning of the leg. The density sums over all points at which the line meets the
    /// surface, because a sample at any of these points gives the same line.
    pub(crate) fn density(&self, ray: &TwoPlane) -> f64 {
        let along = direction(ray);
        let mut sum = 0.0;
        self.primitives.each(ray, |at, primitive| {
            let point = start(ray) + at * along;
            let normal = primitive.normal(point);
            // The density of sampled points per unit area of the surface.
            let density = match &self.points {
                PatternPoints::Flat(pieces) => 1.0 / pieces.area(),
                PatternPoints::Smooth(patch) => {
                    normal.dot(patch.frame.d) / (PI * patch.aperture * patch.aperture)
                }
            };
            // Rays with slopes (u, v) project an area dA of the surface onto the plane at the
            // beginning of the leg. The projected area is |n · (u, v, 1)| dA.
            sum += density / normal.dot(along).abs();
        });
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_scene::{SceneFile, resolve};
    use etendue_transform::random::{self, Stream};

    fn scene(surface: &str) -> Scene {
        let text = format!(
            r#"(
                light: Environment(center: (0, 0, 0), map: Lobes([(from: (0, 0, -1), width: 0.3)])),
                surfaces: [{surface}],
                path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["s"]),
                planes: [(name: "a", at: After("s"))],
                window: (x: Hann(0.2), u: Hann(0.2)),
                frequencies: (rho: (max: 4), nu: (max: 4)),
            )"#
        );
        resolve(
            "test",
            SceneFile::parse(&text).unwrap(),
            ".".as_ref(),
            u64::MAX,
        )
        .unwrap()
    }

    /// Tests two properties. First, for any direction, the density over (x, y) integrates to 1,
    /// even if lines meet the surface twice. Second, sampled points follow the density: if a
    /// function is divided by the density, its mean over these points is the integral of the
    /// function.
    #[test]
    #[expect(clippy::too_many_lines, reason = "a test may be a list of cases")]
    fn lines_follow_the_density() {
        for (surface, slopes) in [
            (
                r#"Rectangle(name: "s", center: (0, 0, 2), size: (0.8, 0.6), facing: (0.5, 0.2, -1))"#,
                [0.3, -0.2],
            ),
            (
                r#"Smooth(name: "s", center: (0, 0, 1.5), facing: (0.3, 0.1, -1), form: Sphere(-0.5), aperture: 0.5, event: Mirror)"#,
                [0.1, 0.2],
            ),
            (
                r#"Smooth(name: "s", center: (0, 0, 1.5), facing: (0, 0, -1), form: Sphere(-1.8), aperture: 0.5, event: Mirror)"#,
                [2.5, 0.2],
            ),
            (
                r#"Mesh(name: "s", center: (0, 0, 2), mesh: Star(radius: 0.4, relief: 0.3, lobes: 4, rings: 20))"#,
                [0.4, 0.1],
            ),
        ] {
            let scene = scene(surface);
            let ground = FootprintSampler::new(&scene, None).unwrap();
            let [u, v] = slopes;
            let line = |point: DVec3| TwoPlane {
                x: point.x - point.z * u,
                y: point.y - point.z * v,
                u,
                v,
            };
            let samples: Vec<TwoPlane> = (0..20_000)
                .map(|index| {
                    let r = random::words(3, Stream::Photon, index, 0).map(random::unit);
                    line(ground.sample([r[0], r[1], r[2]]))
                })
                .collect();
            let bounds = |of: fn(&TwoPlane) -> f64| {
                let values = samples.iter().map(of);
                let low = values.clone().fold(f64::INFINITY, f64::min) - 0.01;
                [low, values.fold(f64::NEG_INFINITY, f64::max) + 0.01]
            };
            let [x, y] = [bounds(|ray| ray.x), bounds(|ray| ray.y)];
            let n = 400;
            let cell = (x[1] - x[0]) * (y[1] - y[0]) / f64::from(n * n);
            let (mut whole, mut covered) = (0.0, 0.0);
            for i in 0..n * n {
                let at = |[low, high]: [f64; 2], k: i32| {
                    low + (high - low) * (f64::from(k) + 0.5) / f64::from(n)
                };
                let density = ground.density(&TwoPlane {
                    x: at(x, i / n),
                    y: at(y, i % n),
                    u,
                    v,
                });
                whole += density * cell;
                covered += if density > 0.0 { cell } else { 0.0 };
            }
            // The mid-point rule has an error of about 1 %. The density jumps at the outline of the
            // surface, in 1 % of the cells, and has poles at lines that graze the surface.
            assert!((whole - 1.0).abs() < 0.02, "{surface}: {whole}");
            let inverse = samples.iter().map(|ray| 1.0 / ground.density(ray));
            let mean = inverse.sum::<f64>() / samples.len() as f64;
            assert!(
                (mean / covered - 1.0).abs() < 0.03,
                "{surface}: {mean} and {covered}"
            ); // three standard errors, and the errors named above
        }
    }
}
