//! Emits photons from the light, many at a time.

mod plain;

use crate::aim::{FromSky, looks_across};
use crate::arrival::radiance_per_flux;
use crate::lanes::lanes;
use crate::lattice::{LatticeGroup, Lattices};
use crate::photon_group::{PHOTONS_PER_GROUP, PhotonColumn, PhotonGroup, ray};
use crate::plane_on_leg::PlaneOnLeg;
use crate::proposal::{DrawOrder, ProfileDensity, Proposal};
use crate::radiance::radiances;
use crate::reach::{looks_at_surface, outline, reach};
use etendue_field::{EmittedRays, Light, Profile, TwoPlane, VirtualPlane, Window};
use etendue_scene::{Emission, Sampling, Scene};
use etendue_transform::random;
use fearless_simd::{Level, dispatch};
use glam::DVec3;
use plain::Plain;

/// How rays leave the light: a density over (x, y, u, v) at the light, and a strategy to sample it.
/// The density of a point light is over (u, v) alone, and the density of a beam is over (x, y)
/// alone.
#[derive(Debug)]
pub struct Emitter {
    light: Light,
    strategy: EmissionStrategy,
    level: Level,
}

/// The strategy to draw rays.
#[derive(Debug)]
enum EmissionStrategy {
    /// One proposal for each virtual plane, given by its factors over (x, u) and (y, v).
    Aimed {
        proposals: Vec<[Proposal; 2]>,
        /// Equal shares of the photons for all proposals.
        equal: Vec<f64>,
    },
    /// Light from an environment.
    Sky(FromSky),
    /// Light without extent. Its rays are drawn uniformly within one of several ranges, and all
    /// ranges have the same probability. Bounds on the slopes along x and y define each range. For
    /// a beam, the bounds are on the positions along x and y.
    Even(Vec<AxisBounds>),
    /// Light drawn in proportion to the emission of the light source.
    Plain(Plain),
}

impl Emitter {
    /// Builds the emitter of a scene.
    ///
    /// Aimed emission is a mixture with equal weights of proposals, one for each virtual plane
    /// whose window the light reaches. For a virtual plane on a later leg, the proposal aims at
    /// the part of the first surface from which light can reach that plane. If the light reaches
    /// no window, emission is plain, and every window stays empty. For an environment, both aimed
    /// and plain emission cover only rays that a virtual plane may see, and the ledger counts
    /// only these rays.
    #[must_use]
    pub fn new(scene: &Scene) -> Self {
        let proposals = match scene.run.emission {
            Emission::Aimed => proposals(scene),
            Emission::Plain => Vec::new(),
        };
        let strategy = if proposals.is_empty() {
            unaimed(scene)
        } else {
            let equal = vec![1.0 / proposals.len() as f64; proposals.len()];
            EmissionStrategy::Aimed { proposals, equal }
        };
        let light = scene.light.clone();
        Self {
            light,
            strategy,
            level: Level::new(),
        }
    }

    /// Builds the emitters with which two scenes are traced in pairs. If both aim their emission, they
    /// aim at the windows of both scenes, so that equal numbers give equal photons, and no light of
    /// either scene is left out.
    pub(crate) fn pair(scenes: [&Scene; 2]) -> [Self; 2] {
        let mut emitters = scenes.map(Self::new);
        let [a, b] = &mut emitters;
        if let (
            EmissionStrategy::Aimed { proposals, equal },
            EmissionStrategy::Aimed {
                proposals: others,
                equal: other_shares,
            },
        ) = (&mut a.strategy, &mut b.strategy)
        {
            let added = others.iter().filter(|other| !proposals.contains(other));
            let added: Vec<[Proposal; 2]> = added.copied().collect();
            proposals.extend(added);
            *equal = vec![1.0 / proposals.len() as f64; proposals.len()];
            others.clone_from(proposals);
            other_shares.clone_from(equal);
        }
        emitters
    }

    /// Builds an emitter that emits light without extent uniformly towards the entire first
    /// surface, and towards the windows of virtual planes before that surface. Virtual planes
    /// beyond the first surface have no influence on this emitter.
    ///
    /// If the light has extent or the surface reaches back to the light, the result is the
    /// emitter of [`Self::new`].
    #[must_use]
    pub fn with_uniform_emission(scene: &Scene) -> Self {
        let plain = Self::new(scene);
        match even(scene) {
            even if even.is_empty() => plain,
            even => Self {
                strategy: EmissionStrategy::Even(even),
                ..plain
            },
        }
    }

    /// The number of the first block of random words that a photon's interactions with
    /// surfaces use. The emission uses only the last word of block 1, which selects the virtual
    /// plane at which a ray is aimed. Light from an environment uses all words of block 1.
    pub(crate) fn bounces_from(&self) -> u32 {
        if let EmissionStrategy::Sky(_) = self.strategy {
            2
        } else {
            1
        }
    }

    /// The lattices from which the photons of a scene are drawn; `None` if nets or random
    /// numbers are used.
    pub(crate) fn lattices(&self, scene: &Scene) -> Option<Lattices> {
        match &self.strategy {
            EmissionStrategy::Aimed { proposals, .. }
                if scene.run.sampling == Sampling::Lattice =>
            {
                let batch = scene.run.photons / u64::from(scene.run.batches);
                Lattices::new(scene, proposals, batch)
            }
            _ => None,
        }
    }

    /// Emits photons of a lattice together. `shares` are the shares of the photons that each proposal
    /// has.
    pub(crate) fn emit_aimed(&self, group: LatticeGroup, shares: &[f64]) -> PhotonGroup {
        let EmissionStrategy::Aimed { proposals, .. } = &self.strategy else {
            return self.weighted([[0.0; PHOTONS_PER_GROUP]; 4], [0.0; PHOTONS_PER_GROUP]);
        };
        dispatch!(self.level, _simd => {
            let (rays, densities) = aimed(proposals, group.words, group.proposals, shares);
            self.weighted(rays, densities)
        })
    }

    /// Emits several photons together. `words` returns a block of four random words of each photon,
    /// as columns.
    #[must_use]
    pub fn emit(&self, words: impl Fn(u32) -> [[u32; PHOTONS_PER_GROUP]; 4]) -> PhotonGroup {
        let one_by_one = |drawn: &dyn Fn([[u32; 4]; 2]) -> Option<(TwoPlane, f64)>| {
            let (mut rays, mut densities) =
                ([[0.0; PHOTONS_PER_GROUP]; 4], [0.0; PHOTONS_PER_GROUP]);
            let blocks = [words(0), words(1)];
            for i in 0..PHOTONS_PER_GROUP {
                let words = blocks.map(|block| block.map(|column| column[i]));
                if let Some((TwoPlane { x, y, u, v }, density)) = drawn(words) {
                    [rays[0][i], rays[1][i], rays[2][i], rays[3][i]] = [x, y, u, v];
                    densities[i] = density;
                }
            }
            self.weighted(rays, densities)
        };
        match &self.strategy {
            EmissionStrategy::Sky(sky) => one_by_one(&|words| {
                let ray = sky.sample(words)?;
                Some((ray, sky.density(&ray)))
            }),
            EmissionStrategy::Even(all) => one_by_one(&|words| Some(self.even(all, words))),
            EmissionStrategy::Plain(plain) => one_by_one(&|[words, _]| {
                let ray = plain.sample(words.map(random::unit));
                Some((ray, plain.density(&ray)))
            }),
            EmissionStrategy::Aimed { proposals, equal } => {
                let numbers = words(0);
                let count = proposals.len();
                let chosen: [usize; PHOTONS_PER_GROUP] = match count {
                    1 => [0; PHOTONS_PER_GROUP],
                    _ => words(1)[3].map(|word| random::index(word, count)),
                };
                dispatch!(self.level, _simd => {
                    let (rays, densities) = aimed(proposals, numbers, chosen, equal);
                    self.weighted(rays, densities)
                })
            }
        }
    }

    /// Photons with their weights and fluxes.
    #[inline(always)]
    fn weighted(&self, rays: [PhotonColumn; 4], densities: PhotonColumn) -> PhotonGroup {
        let radiance = radiances(&self.light, &rays);
        let weights = lanes(|i| {
            let weight = radiance[i] / densities[i];
            // Because of rounding, a ray can lie exactly on the edge of a range, where the density
            // is zero. A ray on the edge of a range carries no light.
            if densities[i] > 0.0 && weight > 0.0 {
                weight
            } else {
                0.0
            }
        });
        PhotonGroup {
            rays,
            weights,
            fluxes: lanes(|i| weights[i] / radiance_per_flux(&ray(&rays, i))),
        }
    }

    /// A ray of a light without extent and its density. The slopes of a point light or a
    /// projector, or the positions of a beam, are uniform within one of several ranges.
    fn even(&self, all: &[AxisBounds], [words, last]: [[u32; 4]; 2]) -> (TwoPlane, f64) {
        let bounds = match all {
            [only] => only,
            several => &several[random::index(last[3], several.len())],
        };
        let r = words.map(random::unit);
        let at = [0, 1].map(|i| bounds[i][0] + r[i] * (bounds[i][1] - bounds[i][0]));
        let densities = all.iter().map(|bounds| evenly_over(bounds, at));
        let density = densities.sum::<f64>() / all.len() as f64;
        let [x, y, u, v] = if self.light.is_distant() {
            [at[0], at[1], 0.0, 0.0]
        } else {
            [0.0, 0.0, at[0], at[1]]
        };
        (TwoPlane { x, y, u, v }, density)
    }
}

/// The strategy for photons that are not aimed at windows.
fn unaimed(scene: &Scene) -> EmissionStrategy {
    EmissionStrategy::Plain(match scene.light.rays() {
        EmittedRays::OfShape(shape) => Plain::Area(*shape, scene.light.exponent()),
        EmittedRays::OfPoint(None) => Plain::Point,
        EmittedRays::OfPoint(Some(image)) => Plain::Slopes(*image),
        EmittedRays::Parallel(image) => Plain::Positions(*image),
        EmittedRays::Listed(rays) => Plain::Rays(rays.clone()),
        EmittedRays::OfSky(environment) => {
            return EmissionStrategy::Sky(FromSky::new(scene, environment));
        }
    })
}

/// The proposals of aimed emission, in the order of the virtual planes whose windows the light
/// reaches.
///
/// Light with a picture is never aimed, because it is drawn in proportion to the picture. Rays of a
/// list are not aimed either, because no other rays exist near them. Rays of an environment have
/// proposals of their own, in [`FromSky`].
fn proposals(scene: &Scene) -> Vec<[Proposal; 2]> {
    let extent = match scene.light.rays() {
        EmittedRays::OfShape(shape) => [0, 1].map(|axis| shape.bounds().extent(axis)),
        EmittedRays::OfPoint(None) => [[0.0; 2]; 2],
        _ => return Vec::new(),
    };
    let [[left, right], [low, high]] = extent;
    let corners = [[left, low], [right, low], [left, high], [right, high]];
    let corners = corners.map(|[x, y]| DVec3::new(x, y, 0.0));
    let proposal = |(i, plane): (usize, &VirtualPlane)| {
        let w = &plane.window;
        if plane.leg == 0 && !looks_at_surface(plane) {
            let along = |axis: usize, space, slope| {
                window_proposal(plane.distance, extent[axis], space, slope)
            };
            return Some([along(0, &w.x, &w.u)?, along(1, &w.y, &w.v)?]);
        }
        let half = reach(scene, plane, 0, &corners)?;
        // If a virtual plane lies on the surface at the end of the leg, it sees only some slopes. If
        // it lies beyond this surface, it sees light of any slope.
        let slopes = PlaneOnLeg::new(scene, i, plane).slopes(w);
        let slopes = slopes.filter(|_| plane.leg == 0);
        let along = |axis: usize| {
            let (length, half) = (scene.path.first_hit(), half[axis]);
            // The bounds contain the slopes of all rays from the light to the region that the plane
            // sees.
            let [low, high] = extent[axis].map(f64::abs);
            let steepest = (half + low.max(high)) / length;
            let seen = slopes.map_or(f64::INFINITY, |slopes| slopes[axis]);
            let slope = ProfileDensity::cosine(steepest.min(seen));
            let space = ProfileDensity::new(&Profile::Box(half));
            Proposal::new(DrawOrder::Slope, length, extent[axis], space, slope)
        };
        Some([along(0)?, along(1)?])
    };
    scene
        .planes
        .iter()
        .enumerate()
        .filter_map(proposal)
        .collect()
}

/// A proposal aimed at the window of a virtual plane across the first leg.
fn window_proposal(
    distance: f64,
    extent: [f64; 2],
    space: &Profile,
    slope: &Profile,
) -> Option<Proposal> {
    let half = slope.half_width();
    let width = extent[1] - extent[0];
    // If a position in the window sees the light under few of the window's slopes, points on the light
    // are drawn uniformly.
    let slope = if width > 0.0 && width <= distance * half {
        ProfileDensity::constant(half)
    } else {
        ProfileDensity::new(slope)
    };
    let space = ProfileDensity::new(space);
    Proposal::new(DrawOrder::Position, distance, extent, space, slope)
}

/// Rays aimed at virtual planes, as columns of x, y, u and v, and their densities. The
/// plane at which each ray is aimed is `chosen`; `shares` are the shares of all rays.
#[inline(always)]
fn aimed(
    proposals: &[[Proposal; 2]],
    words: [[u32; PHOTONS_PER_GROUP]; 4],
    chosen: [usize; PHOTONS_PER_GROUP],
    shares: &[f64],
) -> ([PhotonColumn; 4], PhotonColumn) {
    let [a, b, c, d] = words.map(|words| lanes(|i| random::unit(words[i])));
    if let [[along_x, along_y]] = proposals {
        let ([x, u], in_x) = along_x.samples_and_densities([a, b]);
        let ([y, v], in_y) = along_y.samples_and_densities([c, d]);
        return ([x, y, u, v], lanes(|i| in_x[i] * in_y[i]));
    }
    let mut rays = [[0.0; PHOTONS_PER_GROUP]; 4];
    for (number, [along_x, along_y]) in proposals.iter().enumerate() {
        if !chosen.contains(&number) {
            continue;
        }
        let [x, u] = along_x.samples([a, b]);
        let [y, v] = along_y.samples([c, d]);
        for (ray, aimed) in rays.iter_mut().zip([x, y, u, v]) {
            *ray = lanes(|i| {
                if chosen[i] == number {
                    aimed[i]
                } else {
                    ray[i]
                }
            });
        }
    }
    (rays, densities(proposals, shares, &rays))
}

/// The density of rays that several proposals aim. The density is per du dv for a point
/// light, and per dx dy du dv for any other light.
#[inline(always)]
fn densities(
    proposals: &[[Proposal; 2]],
    shares: &[f64],
    [x, y, u, v]: &[PhotonColumn; 4],
) -> PhotonColumn {
    let mut sums = [0.0; PHOTONS_PER_GROUP];
    for ([along_x, along_y], share) in proposals.iter().zip(shares) {
        let (in_x, in_y) = (along_x.densities([x, u]), along_y.densities([y, v]));
        for (i, sum) in sums.iter_mut().enumerate() {
            *sum += share * in_x[i] * in_y[i];
        }
    }
    sums
}

/// Lowest and highest coordinate along two axes.
type AxisBounds = [[f64; 2]; 2];

/// Returns ranges for uniform emission. Each virtual plane across the first leg has the range
/// within which light crosses the plane's window. All other planes together have the range within
/// which light meets the first surface. The ranges bound slopes for a point light or a projector,
/// and positions for a beam. The list is empty if any of these ranges is unknown or receives no
/// light.
fn even(scene: &Scene) -> Vec<AxisBounds> {
    let light = &scene.light;
    if light.has_extent() || light.listed().is_some() {
        return Vec::new();
    }
    let onto_surface = || {
        let corners = outline(scene, scene.path.ends_at(0)?.object);
        let per = |corner: &DVec3| if light.is_distant() { 1.0 } else { corner.z };
        let is_ahead = corners.iter().all(|corner| corner.z > 0.0);
        is_ahead.then(|| {
            [0, 1].map(|axis| {
                let met = corners.iter().map(|corner| corner[axis] / per(corner));
                let low = met.clone().fold(f64::INFINITY, f64::min);
                [low, met.fold(f64::NEG_INFINITY, f64::max)]
            })
        })
    };
    let into_window = |Window { x, y, u, v }: &Window| {
        let seen = if light.is_distant() { [x, y] } else { [u, v] };
        seen.map(|profile| [-1.0, 1.0].map(|side| side * profile.half_width()))
    };
    let (across, beyond): (Vec<_>, Vec<_>) = scene.planes.iter().partition(|p| looks_across(p));
    let windows = across.iter().map(|plane| Some(into_window(&plane.window)));
    let surface = (!beyond.is_empty()).then(onto_surface);
    let lit = |bounds: AxisBounds| {
        let shone = [0, 1].map(|axis| {
            let [low, high] = if light.is_distant() {
                light.extent(axis)
            } else {
                [-1.0, 1.0].map(|side| side * light.steepest(axis))
            };
            [bounds[axis][0].max(low), bounds[axis][1].min(high)]
        });
        shone.iter().all(|[low, high]| low < high).then_some(shone)
    };
    let all: Option<Vec<AxisBounds>> = windows.chain(surface).map(|bounds| lit(bounds?)).collect();
    all.unwrap_or_default()
}

/// The uniform density at (a, b) within the bounds along two axes.
fn evenly_over([[left, right], [low, high]]: &AxisBounds, [a, b]: [f64; 2]) -> f64 {
    let inside = (*left..=*right).contains(&a) && (*low..=*high).contains(&b);
    if inside {
        1.0 / ((right - left) * (high - low))
    } else {
        0.0
    }
}
