//! What all ray files have in common.

/// Planck's constant times the speed of light, MeV m: a photon of energy E has the wavelength h c / E. Exact in the SI of 2019, rounded to f64.
pub const PHOTON_ENERGY_LENGTH: f64 = 1.239_841_984_332_002_6e-12;

/// What the power of rays is counted in.
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
    /// Its symbol.
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
    /// The file does not say.
    Unknown,
    /// All rays have this one.
    One(f64),
    /// One for each ray, NaN where it is unknown.
    Each(Vec<f64>),
    /// All rays have one spectrum: wavelengths and their weights.
    Spectrum(Vec<[f64; 2]>),
}

/// Rays with their power.
///
/// The power of a set is the sum of its rays'. A ray carries its power through whatever plane it crosses: no cosine is in it.
#[derive(Clone, Debug, PartialEq)]
pub struct RaySet {
    /// A point on each ray, metres; light goes on from there.
    pub positions: Vec<[f64; 3]>,
    /// Where it goes: unit vectors.
    pub directions: Vec<[f64; 3]>,
    /// What it carries.
    pub powers: Vec<f64>,
    /// In which unit.
    pub unit: PowerUnit,
    /// Of which wavelength.
    pub wavelengths: Wavelengths,
}

impl RaySet {
    /// How many rays.
    #[must_use]
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// The power of all rays, in the set's unit.
    #[must_use]
    pub fn total_power(&self) -> f64 {
        self.powers.iter().sum()
    }

    /// The smallest box around the positions, lower and upper corner, metres; none without rays.
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

    /// The wavelength of a ray, metres, where it has one.
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

/// A vector of length 1 along another, which is neither zero nor infinite.
pub(crate) fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = length(v);
    v.map(|c| c / length)
}
