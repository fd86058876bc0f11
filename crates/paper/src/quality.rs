//! How much work goes into a figure.

use serde::Serialize;

/// How much work goes into a figure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Quality {
    /// An eighth of the photons of the scenes, twice as many frequencies as they ask for along each axis
    Draft,
    /// The photons of the scenes, four times as many frequencies
    #[default]
    Print,
    /// What it takes to have all texts in their places
    #[cfg(test)]
    Sketch,
}

impl Quality {
    /// As commands have it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Draft => "draft",
            Self::Print => "print",
            #[cfg(test)]
            Self::Sketch => "sketch",
        }
    }

    /// Photons of a scene that has so many.
    pub(crate) fn photons(self, photons: u64) -> u64 {
        match self {
            Self::Draft => photons / 8,
            Self::Print => photons,
            #[cfg(test)]
            Self::Sketch => 1 << 14,
        }
    }

    /// Frequencies for one of the scene, along each axis. The window ends, so these are determined too: in between
    /// the picture shows what is there, and no cells.
    pub(crate) fn finer(self) -> usize {
        match self {
            Self::Draft => 2,
            Self::Print => 4,
            #[cfg(test)]
            Self::Sketch => 1,
        }
    }
}
