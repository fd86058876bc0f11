//! What a prediction takes.

/// The work of a prediction.
#[derive(Clone, Debug, PartialEq)]
pub struct PredictionWork {
    /// A core does one in about a nanosecond.
    pub steps: f64,
    /// Bytes held once.
    pub bytes: f64,
    /// Bytes held by each thread.
    pub bytes_each: f64,
    /// What most of the steps are made of, in words.
    pub drivers: String,
}

impl PredictionWork {
    /// Of what needs no prediction.
    #[must_use]
    pub fn none() -> Self {
        Self {
            steps: 0.0,
            bytes: 0.0,
            bytes_each: 0.0,
            drivers: String::new(),
        }
    }

    /// More than anyone would wait for, so that it was not counted to its end.
    pub(crate) fn endless(drivers: String) -> Self {
        Self {
            steps: f64::INFINITY,
            drivers,
            ..Self::none()
        }
    }

    /// One after the other.
    pub(crate) fn then(self, next: Self) -> Self {
        Self {
            steps: self.steps + next.steps,
            bytes: self.bytes.max(next.bytes),
            bytes_each: self.bytes_each.max(next.bytes_each),
            drivers: if next.steps > self.steps {
                next.drivers
            } else {
                self.drivers
            },
        }
    }
}
