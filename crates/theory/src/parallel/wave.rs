//! Cosine factors of a section of the light field.

use etendue_field::{Complex, CosineTerm, Grating, cis};

/// A term amplitude · cos(2π s·p + phase) of a factor of a section, where p = (position, slope) is
/// in units of the window's half-widths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SectionWave {
    /// The frequency s, in cycles per half-width of the window.
    pub(crate) frequency: [f64; 2],
    pub(crate) amplitude: f64,
    /// The phase in radians; zero if the frequency is zero.
    pub(crate) phase: f64,
}

/// One complex exponential of a [`SectionWave`]. Multiplication by this exponential changes a
/// transform F(k) to weight · F(k + s).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shift {
    pub(crate) frequency: [f64; 2],
    /// The weight without the factor for the phase of the wave.
    pub(crate) amplitude: f64,
    /// The sign, +1 or −1, in the exponential exp(−i sign (2π s·p + phase)), where s is the
    /// frequency of the wave.
    pub(crate) sign: f64,
    pub(crate) weight: Complex,
}

impl SectionWave {
    fn new(frequency: [f64; 2], amplitude: f64, phase: f64) -> Self {
        if is_zero(frequency) {
            return Self {
                frequency,
                amplitude: amplitude * libm::cos(phase),
                phase: 0.0,
            };
        }
        Self {
            frequency,
            amplitude,
            phase,
        }
    }

    /// The product of a cosine series in position and a cosine series in slope. Frequencies
    /// are in cycles per metre and per unit slope.
    pub(crate) fn of_terms(terms: [&[CosineTerm]; 2], half: [f64; 2]) -> Vec<Self> {
        let along = |axis: usize| -> Vec<Self> {
            let waves = terms[axis].iter().map(|term| {
                let mut frequency = [0.0; 2];
                frequency[axis] = term.frequency * half[axis];
                Self::new(frequency, term.weight, 0.0)
            });
            waves.collect()
        };
        Self::products(&along(0), &along(1))
    }

    /// The grating ½ (1 + m cos(2π f t + p)) with t = x − `distance` · u, in the
    /// coordinates of the plane (docs/theory.md (5c)).
    pub(crate) fn of_grating(grating: &Grating, distance: f64, half: [f64; 2]) -> [Self; 2] {
        let f = grating.frequency;
        let frequency = [f * half[0], -f * distance * half[1]];
        [
            Self::new([0.0; 2], 0.5, 0.0),
            Self::new(frequency, 0.5 * grating.modulation, grating.phase),
        ]
    }

    /// The product of two sums of waves.
    pub(crate) fn products(a: &[Self], b: &[Self]) -> Vec<Self> {
        let pairs = a.iter().flat_map(|a| b.iter().map(move |b| (a, b)));
        pairs.flat_map(|(a, b)| a.times(b)).collect()
    }

    /// The product of two waves by cos a cos b = ½ cos(a + b) + ½ cos(a − b). If one of
    /// the waves is a constant, the product is a single wave.
    fn times(&self, other: &Self) -> Vec<Self> {
        let amplitude = self.amplitude * other.amplitude;
        if self.is_constant() || other.is_constant() {
            let frequency = [0, 1].map(|i| self.frequency[i] + other.frequency[i]);
            return vec![Self::new(frequency, amplitude, self.phase + other.phase)];
        }
        let both = [1.0, -1.0].map(|sign| {
            let frequency = [0, 1].map(|i| self.frequency[i] + sign * other.frequency[i]);
            Self::new(frequency, 0.5 * amplitude, self.phase + sign * other.phase)
        });
        both.to_vec()
    }

    fn is_constant(&self) -> bool {
        is_zero(self.frequency)
    }

    /// The complex exponentials of the wave. A cosine has two of them, and a constant has
    /// one.
    pub(crate) fn shifts(&self) -> impl Iterator<Item = Shift> {
        let (signs, amplitude) = if self.is_constant() {
            (&[1.0][..], self.amplitude)
        } else {
            (&[1.0, -1.0][..], 0.5 * self.amplitude)
        };
        signs.iter().map(move |&sign| Shift {
            frequency: self.frequency.map(|s| sign * s),
            amplitude,
            sign,
            weight: cis(-sign * self.phase) * amplitude,
        })
    }

    /// The argument 2π s·p + phase of the cosine at p.
    pub(crate) fn angle(&self, p: [f64; 2]) -> f64 {
        std::f64::consts::TAU * crate::parallel::polygon::dot(self.frequency, p) + self.phase
    }
}

fn is_zero(frequency: [f64; 2]) -> bool {
    frequency[0] == 0.0 && frequency[1] == 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_field::Profile;

    fn sum(waves: &[SectionWave], p: [f64; 2]) -> f64 {
        waves
            .iter()
            .map(|w| w.amplitude * libm::cos(w.angle(p)))
            .sum()
    }

    #[test]
    fn waves_add_up_to_window_and_gratings() {
        let (position, slope) = (
            Profile::Hann(0.7),
            Profile::Gaussian {
                width: 0.3,
                cut: 0.4,
            },
        );
        let half = [0.7, 0.4];
        let terms = [position.cosine_terms(), slope.cosine_terms()];
        let mut waves = SectionWave::of_terms([&terms[0], &terms[1]], half);
        let grating = |frequency, phase| Grating {
            axis: 0,
            frequency,
            modulation: 0.8,
            phase,
        };
        // The product of two equal gratings in one plane contains a constant wave with a phase.
        let gratings = [
            (grating(2.0, 0.3), 0.0),
            (grating(3.0, -0.9), 1.3),
            (grating(2.0, 2.1), 0.0),
        ];
        for count in 0..=gratings.len() {
            for (x, u) in [(0.0, 0.0), (0.3, -0.2), (-0.65, 0.39)] {
                let gratings = gratings[..count].iter();
                let seen = gratings.map(|(g, h)| g.transmittance(x - h * u, 0.0));
                let expected = position.value(x) * slope.value(u) * seen.product::<f64>();
                let got = sum(&waves, [x / half[0], u / half[1]]);
                assert!((got - expected).abs() < 1e-14); // rounding of a few hundred terms below 1
            }
            if let Some((grating, distance)) = gratings.get(count) {
                waves = SectionWave::products(
                    &waves,
                    &SectionWave::of_grating(grating, *distance, half),
                );
            }
        }
    }

    #[test]
    fn shifts_are_the_exponentials_of_a_wave() {
        let wave = SectionWave::new([0.7, -0.2], 1.3, 0.4);
        let p = [0.3, 0.8];
        let sum: Complex = wave
            .shifts()
            .map(|s| {
                let angle = std::f64::consts::TAU * crate::parallel::polygon::dot(s.frequency, p);
                s.weight * cis(-angle)
            })
            .sum();
        let expected = wave.amplitude * libm::cos(wave.angle(p));
        assert!((sum - expected).norm() < 1e-15); // rounding
    }
}
