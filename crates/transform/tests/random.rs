//! Random crossings for tests, with their windows and grids.

use etendue_field::{Crossing, FrequencyAxis, Profile, SliceGrid, TwoPlane, Window};

/// The random number generator SplitMix64 (Steele, Lea and Flood 2014).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// A number uniform in [0, 1).
    pub(crate) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A number uniform in (−half, half).
    pub(crate) fn within(&mut self, half: f64) -> f64 {
        half * (2.0 * self.unit() - 1.0)
    }

    /// A random crossing, up to `reach` half-widths of `window` from the window's centre,
    /// with a weight in [0, 2).
    pub(crate) fn crossing(&mut self, window: &Window, reach: f64) -> Crossing {
        let mut along = |profile: Profile| self.within(reach * profile.half_width());
        let ray = TwoPlane {
            x: along(window.x),
            y: along(window.y),
            u: along(window.u),
            v: along(window.v),
        };
        Crossing {
            ray,
            weight: 2.0 * self.unit(),
        }
    }
}

pub(crate) fn hann() -> Window {
    Window {
        x: Profile::Hann(0.8),
        y: Profile::Hann(0.7),
        u: Profile::Hann(0.4),
        v: Profile::Hann(0.5),
    }
}

pub(crate) fn boxed() -> Window {
    Window {
        x: Profile::Box(0.8),
        y: Profile::Box(0.8),
        u: Profile::Box(0.4),
        v: Profile::Box(0.4),
    }
}

/// A grid of `azimuths` slices with `half` values of ρ and of ν on either side of zero, and
/// with `fineness` samples for each 1/(2 half-width).
pub(crate) fn grid(window: &Window, azimuths: usize, half: [usize; 2], fineness: f64) -> SliceGrid {
    let axis = |half, profile: Profile| FrequencyAxis {
        half,
        spacing: 0.5 / (profile.half_width() * fineness),
    };
    SliceGrid {
        azimuths,
        rho: axis(half[0], window.x),
        nu: axis(half[1], window.u),
    }
}
