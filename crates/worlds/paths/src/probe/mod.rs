//! Defines the light field behind a pixel. The ray through the centre of the pixel is traced back
//! from surface to surface, and virtual planes are placed along this ray.

mod backward;
mod lines;
mod photons;
mod stop;
mod windows;

pub use backward::BackwardProbe;
pub use photons::PhotonProbe;
pub use stop::Stop;
use stop::across;

use crate::lights::EmissionTarget;
use crate::numbers::PathNumbers;
use crate::paths::{LightSearch, Paths};
use crate::scatter::Reflects;
use etendue_field::{
    Frame, FrequencyAxis, Orientation, Profile, Quantity, Side, SliceGrid, TwoPlane, VirtualPlane,
    Window,
};
use etendue_world::{Camera, Projection};
use glam::DVec3;
use lines::SurfaceLeg;
use std::ops::Range;

/// The options of a probe.
#[derive(Clone, Copy, Debug)]
pub struct Question {
    /// Column and row, from 0 at the top left.
    pub pixel: [usize; 2],
    /// Maximum number of surfaces along the ray.
    pub surfaces: usize,
    /// Width of the window in pixels.
    pub across: f64,
    /// Number of frequencies on either side of zero, along each axis of the slices.
    pub frequencies: usize,
    /// Number of azimuths of slices.
    pub azimuths: usize,
}

/// The light field behind a pixel, ready to be measured.
#[derive(Clone, Debug)]
pub struct Probe<'a> {
    paths: &'a Paths,
    /// The surfaces. The camera sees the first of them.
    pub stops: Vec<Stop>,
    /// The planes: `camera`, and for each surface `leaving_1`, `arriving_1` and so on. A `leaving`
    /// plane sees light that leaves the surface towards the camera, and an `arriving` plane sees
    /// light that arrives along the mirror direction.
    pub planes: Vec<VirtualPlane>,
    legs: Vec<SurfaceLeg>,
    /// Further surfaces along the ray, up to the first surface that is not a mirror. If the last
    /// surface has a lobe, the list includes the surface that this lobe sees.
    beyond: Vec<Stop>,
    /// The slope difference between adjacent pixels.
    pub pixel_slope: f64,
}

/// Maximum number of surfaces to which the ray is followed after the last surface of a question.
/// All of them except the last are mirrors.
const MIRRORS: usize = 4;

/// Maximum slope of a window.
const WIDEST: f64 = 1.0;

/// Half-width along x and y of the window for the spectrum of a picture, as a fraction of the
/// half-width at the camera's plane.
const POINT: f64 = 1e-9;
/// Number of frequencies on either side of zero in the spectrum of a picture. The highest frequency
/// is 6 cycles per half-width of the window.
const PICTURE_FREQUENCIES: usize = 24;
/// Number of azimuths of the spectrum of a picture. At the highest frequency, adjacent azimuths are
/// half a cycle per half-width apart. This distance is smaller than the width of the main lobe of
/// the window's spectrum.
const PICTURE_AZIMUTHS: usize = 40;

impl<'a> Probe<'a> {
    /// The light field behind a pixel of a camera. Returns `None` if the camera is
    /// orthographic, or the ray hits nothing.
    #[must_use]
    pub fn new(paths: &'a Paths, camera: &Camera, question: &Question) -> Option<Self> {
        let Projection::Perspective { half_width, .. } = camera.projection else {
            return None;
        };
        let middle = question.pixel.map(|i| i as f64 + 0.5);
        let look = camera.look(middle, [0.0; 2]);
        let pixel_slope = 2.0 * half_width / camera.size[0] as f64;
        let half = 0.5 * question.across * pixel_slope;
        let mut stops = stop::followed(paths, &look, question.surfaces + MIRRORS, half);
        let beyond = stops.split_off(question.surfaces.min(stops.len()));
        let first = stops.first()?.clone();
        let beyond = stop::visible(stops.last()?, beyond);
        let asked = stops.len();
        let all = [&stops[..], &beyond].concat();
        let right = camera.to_world.transform_vector3(-DVec3::X);
        let x = across(first.normal, first.leaving).unwrap_or(right);
        let mut probe = Self {
            paths,
            planes: Vec::new(),
            legs: Vec::new(),
            pixel_slope,
            stops,
            beyond,
        };
        let eye = Frame::new(look.from, first.leaving, x)?;
        probe.add_leg(eye, None, [half * first.distance, half], 0.0);
        let whole: f64 = probe.stops.iter().map(|stop| stop.distance).sum();
        let mut left = whole;
        probe.add_plane("camera", left, 0, [half * first.distance, half], question);
        let (mut travelled, mut spread) = (0.0, half);
        for (i, stop) in all.iter().enumerate() {
            // Legs beyond the last plane are needed only for photons that mirrors send to the
            // windows.
            if i >= asked && [&all[i - 1], stop].map(|of| of.reflects) != [Reflects::Mirror; 2] {
                break;
            }
            let number = i + 1;
            left -= stop.distance;
            travelled += stop.distance;
            let wide = half * travelled;
            let widths = [wide, spread.min(WIDEST)];
            if i < asked {
                probe.add_plane(&format!("leaving_{number}"), left, i, widths, question);
            }
            spread *= stop.spreading(travelled);
            let axis = probe.legs[i].frame.x;
            let mirrored = axis.reflect(stop.normal);
            let frame = Frame::new(stop.position, stop.arriving, mirrored)?;
            let widths = [wide, spread.min(WIDEST)];
            // No window sees a larger part of this surface than the window at the next surface.
            let seen = all
                .get(number)
                .map_or(wide, |next| wide + (half + widths[1]) * next.distance);
            let reach = 2.0 * seen / stop.cosine().max(0.05);
            probe.add_leg(frame, Some(stop.shape), widths, reach);
            if i < asked {
                let name = format!("arriving_{number}");
                probe.add_plane(&name, left, i + 1, widths, question);
            }
        }
        Some(probe)
    }

    /// The same probe with one of its planes alone.
    #[must_use]
    pub fn at_plane(&self, index: usize) -> Self {
        self.seen_at(self.planes[index].clone())
    }

    /// The same probe with this plane instead of its planes.
    #[must_use]
    pub fn seen_at(&self, plane: VirtualPlane) -> Self {
        Self {
            planes: vec![plane],
            ..self.clone()
        }
    }

    /// The radiance along a ray through a plane, by one path that is traced back. The seed
    /// and `index` select the random numbers of the path.
    #[must_use]
    pub fn radiance(&self, plane: &VirtualPlane, ray: &TwoPlane, seed: u64, index: u64) -> f64 {
        let mut numbers = PathNumbers::new(seed, index);
        self.radiance_by(plane, ray, LightSearch::Both, &mut numbers)
    }

    /// The radiance along a ray through a plane, by one path with these random numbers.
    fn radiance_by(
        &self,
        plane: &VirtualPlane,
        ray: &TwoPlane,
        search: LightSearch,
        numbers: &mut PathNumbers<'_>,
    ) -> f64 {
        let line = self.legs[plane.leg].line(&self.paths.geometry, &plane.frame, ray);
        let before = u32::try_from(plane.leg).unwrap_or(u32::MAX);
        let range = [0.0, f64::INFINITY];
        self.paths.radiance(line, range, before, search, *numbers)
    }

    /// Checks whether BSDF rays, which never sample a light, find all lights. They never find point
    /// lights, spots and directional lights.
    #[must_use]
    pub fn bsdf_finds_lights(&self) -> bool {
        self.paths.lights.are_extended()
    }

    /// Replaces the planes by a single plane, which records the light that arrives at the middle of
    /// the camera's lens as a function of direction alone. X points to the right of the picture,
    /// and Y points up.
    ///
    /// The window has the requested width, frequencies are a quarter of a cycle per half-width
    /// apart, and there are enough azimuths to reach all directions of the picture's spectrum.
    #[must_use]
    pub fn picture(mut self, camera: &Camera) -> Option<Self> {
        let right = camera.to_world.transform_vector3(-DVec3::X);
        let mut plane = self.planes.swap_remove(0);
        let Frame { origin, d, .. } = plane.frame;
        let half = plane.window.u.half_width();
        let spot = Profile::Hann(POINT * plane.window.x.half_width());
        "picture".clone_into(&mut plane.name);
        plane.frame = Frame::new(origin, d, right)?;
        plane.window.x = spot;
        plane.window.y = spot;
        plane.grid = SliceGrid {
            azimuths: PICTURE_AZIMUTHS,
            rho: FrequencyAxis {
                half: 0,
                spacing: 1.0,
            },
            nu: FrequencyAxis {
                half: PICTURE_FREQUENCIES,
                spacing: 0.25 / half,
            },
        };
        self.planes = vec![plane];
        Some(self)
    }

    /// The regions of surfaces that the windows see, also in mirrors.
    fn targets(&self) -> Vec<EmissionTarget> {
        let stops = self.stops.iter().chain(&self.beyond);
        let target = |(stop, leg): (&Stop, &SurfaceLeg)| EmissionTarget {
            center: stop.position,
            // The sphere covers the corners of the window, also on an inclined surface.
            radius: 2.0 * leg.wide(stop.distance) / stop.cosine().max(0.1),
        };
        // If photons were aimed at a region as large as the scene, they would reach the windows
        // less often.
        let largest = 0.5 * self.paths.geometry.radius;
        let targets = stops.zip(&self.legs).map(target);
        targets.filter(|target| target.radius < largest).collect()
    }

    /// Adds a leg, along which light travels towards the camera. The leg is given by the frame at
    /// its end.
    fn add_leg(
        &mut self,
        frame: Frame,
        shape: Option<usize>,
        [position, slope]: [f64; 2],
        reach: f64,
    ) {
        self.legs.push(SurfaceLeg {
            frame,
            shape,
            position,
            reach,
            slope,
        });
    }

    /// Adds a plane on a leg; `distance` is measured in the direction of light, from the last
    /// surface to the camera.
    fn add_plane(
        &mut self,
        name: &str,
        distance: f64,
        leg: usize,
        half: [f64; 2],
        question: &Question,
    ) {
        let end = &self.legs[leg].frame;
        let is_at_end = !name.starts_with("leaving");
        let before = if is_at_end {
            0.0
        } else {
            self.stops[leg].distance
        };
        let [x, u] = half.map(Profile::Hann);
        let axis = |half_width: f64| FrequencyAxis {
            half: question.frequencies,
            spacing: 0.5 / half_width,
        };
        self.planes.push(VirtualPlane {
            name: name.to_owned(),
            distance,
            leg,
            side: if is_at_end { Side::Before } else { Side::After },
            quantity: Quantity::Radiance,
            orientation: Orientation::Orthogonal,
            longitude: 0.0,
            frame: end.travelled(-before),
            window: Window { x, y: x, u, v: u },
            grid: SliceGrid {
                azimuths: question.azimuths,
                rho: axis(half[0]),
                nu: axis(half[1]),
            },
        });
    }
}

/// The number of rays or photons per batch, and the seed.
#[derive(Clone, Copy, Debug)]
pub struct Budget {
    /// Number of rays or photons in each batch.
    pub each: u64,
    /// Seed of all batches.
    pub seed: u64,
}

/// Number of rays or photons between two progress reports.
const BLOCK: u64 = 4096;

impl Budget {
    /// The rays or photons of a batch, in blocks between progress reports.
    fn blocks(self) -> impl Iterator<Item = Range<u64>> {
        let starts = (0..self.each.div_ceil(BLOCK)).map(|block| block * BLOCK);
        starts.map(move |start| start..self.each.min(start + BLOCK))
    }
}
