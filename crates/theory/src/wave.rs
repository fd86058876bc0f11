use etendue_field::Profile;

/// One term amplitude · cos(2π s·p) of a 2D window inside its box, p = (position, slope) in units of the
/// half-widths.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wave {
    /// The frequency s, cycles per half-width.
    pub(crate) frequency: [f64; 2],
    pub(crate) amplitude: f64,
}

/// One complex exponential of a [`Wave`]: in the transform, F(k) becomes weight · F(k + s).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shift {
    pub(crate) frequency: [f64; 2],
    pub(crate) weight: f64,
    /// +1 or −1: this exponential is exp(−2πi · sign · s·p), s being the frequency of its wave.
    pub(crate) sign: f64,
}

impl Wave {
    /// The window `position`(x) · `slope`(u) as a sum of waves; five for Hann × Hann.
    ///
    /// From the cosine terms of the profiles and cos a cos b = ½ cos(a + b) + ½ cos(a − b).
    pub(crate) fn of_window(position: &Profile, slope: &Profile) -> Vec<Self> {
        let (half_x, half_u) = (position.half_width(), slope.half_width());
        let mut waves = Vec::new();
        for x in position.cosine_terms() {
            for u in slope.cosine_terms() {
                let frequency = [x.frequency * half_x, u.frequency * half_u];
                let amplitude = x.weight * u.weight;
                if frequency[0] > 0.0 && frequency[1] > 0.0 {
                    waves.extend([1.0, -1.0].map(|sign| Self {
                        frequency: [frequency[0], sign * frequency[1]],
                        amplitude: 0.5 * amplitude,
                    }));
                } else {
                    waves.push(Self {
                        frequency,
                        amplitude,
                    });
                }
            }
        }
        waves
    }

    /// cos = half the sum of two exponentials; a constant is a single one.
    pub(crate) fn shifts(&self) -> impl Iterator<Item = Shift> {
        let constant = self.frequency[0] == 0.0 && self.frequency[1] == 0.0;
        let (signs, weight) = if constant {
            (&[1.0][..], self.amplitude)
        } else {
            (&[1.0, -1.0][..], 0.5 * self.amplitude)
        };
        signs.iter().map(move |&sign| Shift {
            frequency: self.frequency.map(|s| sign * s),
            weight,
            sign,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn waves_add_up_to_the_window() {
        let (position, slope) = (
            Profile::Hann(0.7),
            Profile::Gaussian {
                width: 0.3,
                cut: 0.4,
            },
        );
        let waves = Wave::of_window(&position, &slope);
        for (x, u) in [(0.0, 0.0), (0.3, -0.2), (-0.65, 0.39)] {
            let p = [x / 0.7, u / 0.4];
            let sum: f64 = waves
                .iter()
                .map(|w| {
                    w.amplitude * (TAU * (w.frequency[0] * p[0] + w.frequency[1] * p[1])).cos()
                })
                .sum();
            let expected = position.value(x) * slope.value(u);
            assert!((sum - expected).abs() < 1e-14); // rounding of a few dozen terms below 1
        }
    }
}
