//! The content that all ray files have in common.

/// Planck's constant times the speed of light, in MeV m. A photon of energy E has the wavelength h
/// c / E. The value is exact in the SI of 2019, and is rounded to f64.
pub const PHOTON_ENERGY_LENGTH: f64 = 1.239_841_984_332_002_6e-12;

/// The unit of the power of rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PowerUnit {
    /// Radiant flux, W.
    Watt,
    /// Luminous flux, lm.
    Lumen,
    /// A statistical weight whose unit the file does not state.
    Weight,
}

impl PowerUnit {
    /// The symbol of the unit.
    #[must_use]
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Watt => "W",
            Self::Lumen => "lm",
            Self::Weight => "(weight, unit not stated)",
        }
    }
}

/// The wavelengths of rays in vacuum, metres.
#[derive(Clone, Debug, PartialEq)]
pub enum Wavelengths {
    /// The file does not state wavelengths.
    Unknown,
    /// The same wavelength for all rays.
    One(f64),
    /// A wavelength for each ray, or NaN if it is unknown.
    Each(Vec<f64>),
    /// The same spectrum for all rays: wavelengths and their weights.
    Spectrum(Vec<[f64; 2]>),
}

/// Rays with their power.
///
/// The power of a set of rays is the sum of the powers of its rays. A ray carries the same power
/// through any plane that it crosses, so no cosine is included.
#[derive(Clone, Debug, PartialEq)]
pub struct RaySet {
    /// A point on each ray, in metres. The light continues from this point.
    pub positions: Vec<[f64; 3]>,
    /// Unit direction of each ray.
    pub directions: Vec<[f64; 3]>,
    /// Power of each ray.
    pub powers: Vec<f64>,
    /// Unit of the powers.
    pub unit: PowerUnit,
    /// Wavelengths of the rays.
    pub wavelengths: Wavelengths,
}

impl RaySet {
    /// The number of rays.
    #[must_use]
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Checks whether the set is empty.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// The power of all rays, in the set's unit.
    #[must_use]
    pub fn total_power(&self) -> f64 {
        self.powers.iter().sum()
    }

    /// The lower and the upper corner of the bounding box of the positions, in metres;
    /// `None` if there are no rays.
    #[must_use]
    pub fn bounds(&self) -> Option<[[f64; 3]; 2]> {
        let first = *self.positions.first()?;
        let grow = |[low, high]: [[f64; 3]; 2], p: &[f64; 3]| {
            let axes = [0, 1, 2];
            [
                axes.map(|i| low[i].min(p[i])),
                axes.map(|i| high[i].max(p[i])),
            ]
        };
        Some(self.positions.iter().fold([first, first], grow))
    }

    /// The wavelength of a ray, in metres; `None` if it is unknown.
    #[must_use]
    pub fn wavelength(&self, ray: usize) -> Option<f64> {
        let known = match &self.wavelengths {
            Wavelengths::One(wavelength) => Some(*wavelength),
            Wavelengths::Each(each) => each.get(ray).copied(),
            Wavelengths::Unknown | Wavelengths::Spectrum(_) => None,
        };
        known.filter(|wavelength| !wavelength.is_nan())
    }
}

/// The length of a vector.
pub(crate) fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|c| c * c).sum::<f64>().sqrt()
}

/// The unit vector along a vector that is neither zero nor infinite.
pub(crate) fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = length(v);
    v.map(|c| c / length)
}
