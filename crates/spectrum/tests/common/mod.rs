//! Generates random crossings, and a source of such crossings, for the tests of this crate.
#![allow(
    dead_code,
    unreachable_pub,
    reason = "each test file uses its own part"
)]
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use etendue_field::{
    Crossing, Frame, FrequencyAxis, Ledger, PhotonSource, Profile, Quantity, Side, SliceGrid,
    TwoPlane, VirtualPlane, Window,
};
use glam::DVec3;

/// The random number generator SplitMix64 (Steele, Lea and Flood 2014).
pub struct Random(pub u64);

impl Random {
    /// A number uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A number uniform in (−half, half).
    pub fn within(&mut self, half: f64) -> f64 {
        half * (2.0 * self.unit() - 1.0)
    }

    /// A random crossing, up to `reach` half-widths of `window` from the window's centre,
    /// with a weight in [0, 2).
    pub fn crossing(&mut self, window: &Window, reach: f64) -> Crossing {
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

pub fn hann() -> Window {
    Window {
        x: Profile::Hann(0.8),
        y: Profile::Hann(0.7),
        u: Profile::Hann(0.4),
        v: Profile::Hann(0.5),
    }
}

pub fn boxed() -> Window {
    Window {
        x: Profile::Box(0.8),
        y: Profile::Box(0.8),
        u: Profile::Box(0.4),
        v: Profile::Box(0.4),
    }
}

/// A grid of `azimuths` slices. Each slice has `half` values of ρ and of ν on either side
/// of zero, and `fineness` samples per 1/(2 half-width).
pub fn grid(window: &Window, azimuths: usize, half: [usize; 2], fineness: f64) -> SliceGrid {
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

pub fn plane(name: &str, window: Window, grid: SliceGrid) -> VirtualPlane {
    VirtualPlane {
        name: name.into(),
        distance: 1.0,
        leg: 0,
        orientation: etendue_field::Orientation::Orthogonal,
        longitude: 0.0,
        side: Side::Before,
        quantity: Quantity::default(),
        frame: Frame::new(DVec3::ZERO, DVec3::Z, DVec3::X).unwrap(),
        window,
        grid,
    }
}

/// A source of photons that cross every plane at random positions and slopes. A tenth of the
/// photons are outside the window.
pub struct Shower {
    pub seed: u64,
    pub photons: u64,
    pub batches: u32,
    pub planes: Vec<VirtualPlane>,
}

impl PhotonSource for Shower {
    fn emitted(&self, batch: u32) -> u64 {
        let [each, more] = [
            self.photons / u64::from(self.batches),
            self.photons % u64::from(self.batches),
        ];
        each + u64::from(u64::from(batch) < more)
    }

    fn emit(
        &self,
        batch: u32,
        record: &mut dyn FnMut(usize, &[Crossing]),
        progress: &dyn Fn(u64),
    ) -> Ledger {
        let mut random = Random(self.seed.wrapping_mul(1_000_003) + u64::from(batch) * 7919);
        let mut left = self.emitted(batch);
        let mut ledger = Ledger::default();
        while left > 0 {
            let count = left.min(100);
            for (index, plane) in self.planes.iter().enumerate() {
                // With the factor 0.9^(-1/4) for each coordinate, all four coordinates are inside
                // the window nine times in ten.
                let block: Vec<_> = (0..count)
                    .map(|_| random.crossing(&plane.window, 1.0267))
                    .collect();
                record(index, &block);
            }
            ledger.emitted += count as f64;
            ledger.escaped += count as f64;
            left -= count;
            progress(count);
        }
        ledger
    }
}
