//! Estimates of the work of a prediction.

/// The estimated work of a prediction.
#[derive(Clone, Debug, PartialEq)]
pub struct PredictionWork {
    /// Number of elementary steps. A core takes about a nanosecond for each step.
    pub steps: f64,
    /// Bytes shared by all threads.
    pub bytes: f64,
    /// Bytes held by each thread.
    pub bytes_each: f64,
    /// The causes of most of the steps, in words.
    pub drivers: String,
}

impl PredictionWork {
    /// The work if no prediction is needed.
    #[must_use]
    pub fn none() -> Self {
        Self {
            steps: 0.0,
            bytes: 0.0,
            bytes_each: 0.0,
            drivers: String::new(),
        }
    }

    /// The work of a prediction that would take far too long. The exact amount is not
    /// counted.
    pub(crate) fn endless(drivers: String) -> Self {
        Self {
            steps: f64::INFINITY,
            drivers,
            ..Self::none()
        }
    }

    /// The work of two predictions, one after the other.
    #[must_use]
    pub fn then(self, next: Self) -> Self {
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
