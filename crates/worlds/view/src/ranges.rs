//! Defines the allowed ranges of numbers for a scene, a picture and a probe. The code that fills in
//! a request checks these ranges.

use std::ops::RangeInclusive;

/// Pixels along a side of a picture.
pub const SIDE: RangeInclusive<u64> = 1..=1 << 14;
/// Largest coordinate, in absolute value, of a camera that is added to a scene.
pub const MAX_COORDINATE: f64 = 1e9;
/// Upper limit of the camera's horizontal angle of view, degrees; the angle is above zero.
pub const MAX_ANGLE: f64 = 180.0;
/// Radiance of an added sky, W/(m² sr).
pub const SKY: RangeInclusive<f64> = 0.0..=1e9;

/// Paths for each pixel of a reference.
pub const SAMPLES: RangeInclusive<u64> = 2..=u32::MAX as u64;
/// Shading samples of a picture.
pub const SHADING_SAMPLES: RangeInclusive<u64> = 1..=100_000_000;
/// Paths of each shading sample.
pub const PATHS: RangeInclusive<u64> = 2..=1_000_000;
/// Rays per point that estimate the distance of blockers.
pub const BLOCKER_RAYS: RangeInclusive<u64> = 1..=100_000;

/// Surfaces along the ray of a probe.
pub const SURFACES: RangeInclusive<u64> = 1..=16;
/// Pixels across the window of a probe.
pub const WINDOW: RangeInclusive<f64> = 0.01..=1e4;
/// Rays or photons of a probe: at least one for each of its batches.
pub const RAYS: RangeInclusive<u64> = 64..=u64::MAX;
