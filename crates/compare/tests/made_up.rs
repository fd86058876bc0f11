//! A plane and noise for tests with synthetic batches.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use etendue_field::{
    Complex, Frame, FrequencyAxis, Orientation, Profile, Quantity, Side, SliceGrid, VirtualPlane,
    Window,
};
use etendue_transform::random::{self, Stream};
use glam::DVec3;

pub(crate) fn plane() -> VirtualPlane {
    let hann = Profile::Hann(0.5);
    let axis = FrequencyAxis {
        half: 6,
        spacing: 1.0,
    };
    VirtualPlane {
        name: "plane".into(),
        distance: 0.0,
        leg: 0,
        orientation: Orientation::Orthogonal,
        longitude: 0.0,
        side: Side::After,
        quantity: Quantity::default(),
        frame: Frame::new(DVec3::ZERO, DVec3::Z, DVec3::X).unwrap(),
        window: Window {
            x: hann,
            y: hann,
            u: hann,
            v: hann,
        },
        grid: SliceGrid {
            azimuths: 2,
            rho: axis,
            nu: axis,
        },
    }
}

/// A complex number whose parts have unit variance: sums of twelve uniform numbers.
pub(crate) fn noise(seed: u64, index: u64) -> Complex {
    let part = |from: u32| -> f64 {
        let words = (0..3).flat_map(|b| random::words(seed, Stream::Photon, index, from + b));
        words.map(random::unit).sum::<f64>() - 6.0
    };
    Complex::new(part(0), part(3))
}
