//! Warnings for a valid scene: likely mistakes, and smooth meshes too coarse for their normals.

use crate::mistakes::mistakes;
use crate::scene::{Leg, MeshObject, Object, Scene, SmoothMesh};
use etendue_field::{Frame, TwoPlane, VirtualPlane, facet_ratio, interpolated_normal, tidy};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// A mesh causes a warning if its spectrum and the spectrum of a smooth surface differ by at least
/// this share.
const LEVEL: f64 = 0.01;
/// The maximum number of triangles examined. In finer meshes, only every second, every third, …
/// triangle is examined.
const MAX_TRIANGLES: usize = 20_000;
/// Triangles are subdivided until about this number of pieces fits across a window.
const PIECES: f64 = 8.0;
/// The number of azimuths at which waves are tested, and the number of waves at each azimuth. The
/// frequencies of these waves are multiples of the spacing of a plane's frequencies, up to the
/// plane's largest frequency.
const AZIMUTHS: u32 = 4;
const WAVES: usize = 8;
/// For each point, the ratio of two radiances, of the mesh and of a smooth surface, is evaluated
/// at these slopes. The unit is the window's half-width.
const SLOPES: [f64; 3] = [-0.5, 0.0, 0.5];

impl Scene {
    /// The warnings for the scene: one for each likely mistake, and one for each smooth
    /// mesh on the path that is too coarse.
    ///
    /// The radiance behind a mesh is f times the radiance behind a smooth surface, see
    /// [`facet_ratio`]. The effect of a mesh on a plane is the ratio of two spectra at the measured
    /// frequencies along x and y, for light that fills the window evenly. Both spectra are computed
    /// at the points where the light hits the mesh. The first spectrum is the spectrum of the window
    /// times f − 1, and the second is the spectrum of the window alone. If facets are finer than the
    /// waves of these frequencies, their effects average out.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = mistakes(self);
        warnings.extend(self.lights().filter_map(Self::rays_behind));
        for leg in 1..self.path.legs.len() {
            let later = self.planes.iter().filter(|plane| plane.leg >= leg);
            let seen = later.filter_map(|plane| Some((self.mismatch(leg, plane)?, plane)));
            let worst = seen.max_by(|((_, a), _), ((_, b), _)| a.total_cmp(b));
            if let Some(((mesh, mismatch), plane)) =
                worst.filter(|((_, mismatch), _)| *mismatch > LEVEL)
            {
                warnings.push(format!(
                    "{}: the mesh is too coarse for normals that are interpolated between vertices. At {}, its \
                     spectrum differs from that of a smooth surface by about {:.1} %, if light fills \
                     the window evenly; with triangles {:.0} times shorter, by at most {} %",
                    mesh.name,
                    plane.name,
                    100.0 * mismatch,
                    (mismatch / LEVEL).ceil(),
                    100.0 * LEVEL
                ));
            }
        }
        warnings
    }

    /// A warning about the rays of a ray file that are omitted because they do not go
    /// forward.
    fn rays_behind(&self) -> Option<String> {
        let rays = self.light.listed()?;
        let (behind, flux) = (rays.behind(), rays.flux());
        (behind > 0.0).then(|| {
            format!(
                "light: rays that do not go forward, along path.direction, are omitted: they have {} W of the {} W of the ray file",
                tidy(behind),
                tidy(behind + flux)
            )
        })
    }

    /// The smooth mesh at the beginning of a leg, and the difference that this mesh
    /// causes at a plane.
    fn mismatch(&self, leg: usize, plane: &VirtualPlane) -> Option<(&MeshObject, f64)> {
        let legs = [&self.path.legs[leg - 1], &self.path.legs[leg]];
        let Object::Mesh(mesh) = legs[1].leaves?.object else {
            return None;
        };
        let mesh = &self.meshes[mesh];
        let looked = WindowView::new(mesh, mesh.smooth.as_ref()?, legs, plane);
        Some((mesh, looked.mismatch()))
    }
}

/// The part of a smooth mesh that a window sees, if later surfaces are treated as flat.
struct WindowView<'a> {
    mesh: &'a MeshObject,
    smooth: &'a SmoothMesh,
    /// The frame at the hit; its D points along the light that leaves the mesh.
    frame: Frame,
    /// A sign. It is 1 if light arrives along the normals of the mesh, and −1 if light arrives
    /// against the normals.
    side: f64,
    plane: &'a VirtualPlane,
    /// The distance from the hit to the plane.
    along: f64,
    /// Half the size of the visible part of the mesh, along X and Y.
    half: [f64; 2],
}

/// Two sums over points of a mesh, or the spectra of these sums: the window, and the difference
/// between the mesh and a smooth surface in the window.
#[derive(Clone, Copy, Debug, Default)]
struct WindowSums {
    difference: f64,
    whole: f64,
}

/// A plane wave with frequency Ω, and the two spectra at that frequency.
struct Wave {
    frequency: [f64; 2],
    /// The number of waves represented: 2 if the complex conjugate is a different wave, otherwise
    /// 1.
    times: f64,
    difference: [f64; 2],
    whole: [f64; 2],
}

impl Wave {
    fn add(&mut self, at: DVec3, sums: &WindowSums) {
        let [x, y] = self.frequency;
        let (sin, cos) = libm::sincos(TAU * (x * at.x + y * at.y));
        let add = |to: &mut [f64; 2], sum: f64| *to = [to[0] + sum * cos, to[1] + sum * sin];
        add(&mut self.difference, sums.difference);
        add(&mut self.whole, sums.whole);
    }
}

/// The plane waves whose frequencies are the spatial frequencies of a virtual plane.
fn waves(plane: &VirtualPlane) -> Vec<Wave> {
    let axis = &plane.grid.rho;
    let orders = 0..=axis.half.min(WAVES);
    let wave = |azimuth: u32, order: usize| {
        let (sin, cos) = libm::sincos(PI * f64::from(azimuth) / f64::from(AZIMUTHS));
        let rho = axis.spacing * order as f64;
        Wave {
            frequency: [rho * cos, rho * sin],
            times: if order == 0 { 1.0 } else { 2.0 },
            difference: [0.0; 2],
            whole: [0.0; 2],
        }
    };
    orders
        .flat_map(|order| (0..AZIMUTHS).map(move |azimuth| wave(azimuth, order)))
        .collect()
}

impl<'a> WindowView<'a> {
    fn new(
        mesh: &'a MeshObject,
        smooth: &'a SmoothMesh,
        [arriving, leaving]: [&Leg; 2],
        plane: &'a VirtualPlane,
    ) -> Self {
        let facing = mesh.first_on(&arriving.frame).map(|(_, normal)| normal);
        let along = plane.distance - leaving.start;
        let w = &plane.window;
        let half = [(&w.x, &w.u), (&w.y, &w.v)];
        Self {
            mesh,
            smooth,
            frame: leaving.frame,
            side: facing.map_or(0.0, |n| n.dot(arriving.frame.d).signum()),
            plane,
            along,
            half: half.map(|(space, slope)| space.half_width() + along * slope.half_width()),
        }
    }

    /// The square root of the energy of the difference divided by the energy of the window.
    fn mismatch(&self) -> f64 {
        let mut waves = waves(self.plane);
        let stride = self.mesh.triangles.len().div_ceil(MAX_TRIANGLES);
        let triangles = self.mesh.triangles.iter().zip(self.smooth.normals.iter());
        for (corners, normals) in triangles.step_by(stride) {
            let local = corners.map(|p| self.frame.to_local(p));
            let normals = normals.map(|n| self.frame.vector_to_local(n));
            self.add(&local, &normals, &local, &mut waves);
        }
        let energy = |part: fn(&Wave) -> [f64; 2]| {
            let both = waves.iter().map(|wave| {
                let [re, im] = part(wave);
                wave.times * (re * re + im * im)
            });
            both.sum::<f64>()
        };
        let whole = energy(|wave| wave.whole);
        if whole > 0.0 {
            (energy(|wave| wave.difference) / whole).sqrt()
        } else {
            0.0
        }
    }

    /// Adds a piece of a triangle. The piece is repeatedly divided into four until the pieces are
    /// small compared with the window.
    fn add(
        &self,
        whole: &[DVec3; 3],
        normals: &[DVec3; 3],
        piece: &[DVec3; 3],
        waves: &mut [Wave],
    ) {
        let [a, b, c] = *piece;
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let [x, y] = self.half;
        if low.x > x || high.x < -x || low.y > y || high.y < -y {
            return;
        }
        let size = high - low;
        if PIECES * size.x > 2.0 * x || PIECES * size.y > 2.0 * y {
            let [d, e, f] = [a.midpoint(b), b.midpoint(c), c.midpoint(a)];
            for part in [[a, d, f], [d, b, e], [f, e, c], [d, e, f]] {
                self.add(whole, normals, &part, waves);
            }
            return;
        }
        let [p, q, r] = whole;
        let flat = (q - p).cross(r - p).normalize();
        let area = (b - a).cross(c - a).z.abs();
        let mut sums = WindowSums::default();
        // The sum over three points of a triangle integrates quadratic functions exactly.
        for corner in piece {
            let point = (a + b + c + 3.0 * *corner) / 6.0;
            let normal = interpolated_normal(whole, normals, point);
            for u in SLOPES {
                for v in SLOPES {
                    self.point(point, flat, normal, [u, v], area, &mut sums);
                }
            }
        }
        let middle = (a + b + c) / 3.0;
        waves.iter_mut().for_each(|wave| wave.add(middle, &sums));
    }

    /// Adds a ray that leaves a point of the mesh.
    fn point(
        &self,
        point: DVec3,
        flat: DVec3,
        normal: DVec3,
        [u, v]: [f64; 2],
        area: f64,
        sums: &mut WindowSums,
    ) {
        let window = &self.plane.window;
        let [u, v] = [u * window.u.half_width(), v * window.v.half_width()];
        let TwoPlane { x, y, .. } = TwoPlane {
            x: point.x,
            y: point.y,
            u,
            v,
        }
        .travelled(self.along - point.z);
        let weight = area * window.value(&TwoPlane { x, y, u, v });
        let leaves = DVec3::new(u, v, 1.0);
        let event = &self.smooth.event;
        let Some(back) = event.turned(&Frame::IDENTITY, normal, point, -leaves) else {
            return;
        };
        if weight <= 0.0 || -back.dot(normal) * self.side <= 0.0 {
            return;
        }
        // Light on the wrong side of a triangle is either lost or counted twice.
        let factor = facet_ratio(flat, normal, back, leaves).clamp(0.0, 2.0);
        if factor.is_finite() {
            sums.difference += weight * (factor - 1.0);
            sums.whole += weight;
        }
    }
}
