//! The amount of work for a figure.

use serde::Serialize;

/// The amount of work for a figure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Quality {
    /// An eighth of the scenes' photons, and twice as many frequencies as in the scenes along each
    /// axis
    Draft,
    /// The scenes' photons, and four times as many frequencies
    #[default]
    Print,
    /// The least work that still draws all labels
    #[cfg(test)]
    Sketch,
}

impl Quality {
    /// The name of the quality in commands.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Draft => "draft",
            Self::Print => "print",
            #[cfg(test)]
            Self::Sketch => "sketch",
        }
    }

    /// The number of photons for a scene that specifies `photons`.
    pub(crate) fn photons(self, photons: u64) -> u64 {
        match self {
            Self::Draft => photons / 8,
            Self::Print => photons,
            #[cfg(test)]
            Self::Sketch => 1 << 14,
        }
    }

    /// The number of frequencies along each axis for each frequency of the scene. The
    /// window is bounded, so the spectrum between the scene's frequencies is well defined, and the
    /// picture can show this spectrum with smaller cells.
    pub(crate) fn finer(self) -> usize {
        match self {
            Self::Draft => 2,
            Self::Print => 4,
            #[cfg(test)]
            Self::Sketch => 1,
        }
    }
}
