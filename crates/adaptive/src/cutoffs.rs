//! A cache of the cutoffs of lobes.

use etendue_compare::lobe_cutoff;
use etendue_field::Lobe;
use etendue_paths::Reflects;
use etendue_theory::shading::COSINE_CUTOFF;
use std::collections::BTreeMap;
use std::sync::Mutex;

/// Cutoff in cycles per radian for mirrors: higher than the resolution of any picture.
const MIRROR: f64 = 1e4;

/// A cache of the cutoffs of lobes.
#[derive(Debug, Default)]
pub(crate) struct Cutoffs {
    known: Mutex<BTreeMap<[u64; 2], f64>>,
}

impl Cutoffs {
    /// Returns the cutoff in cycles per radian.
    pub(crate) fn of(&self, reflects: Reflects) -> f64 {
        match reflects {
            Reflects::Nothing => 0.0,
            Reflects::Diffuse => COSINE_CUTOFF,
            Reflects::Mirror => MIRROR,
            Reflects::Lobe(lobe) => self.of_lobe(lobe),
        }
    }

    fn of_lobe(&self, lobe: Lobe) -> f64 {
        let (kind, lobe): (u64, Lobe) = match lobe {
            Lobe::Lambertian => return COSINE_CUTOFF,
            Lobe::Phong { exponent } => (
                0,
                Lobe::Phong {
                    exponent: rounded(exponent),
                },
            ),
            Lobe::Beckmann { roughness } => (
                1,
                Lobe::Beckmann {
                    roughness: rounded(roughness),
                },
            ),
            Lobe::Ggx { roughness } => (
                2,
                Lobe::Ggx {
                    roughness: rounded(roughness),
                },
            ),
        };
        let width = match lobe {
            Lobe::Phong { exponent } => exponent,
            Lobe::Beckmann { roughness } | Lobe::Ggx { roughness } => roughness,
            Lobe::Lambertian => 0.0,
        };
        let find = || {
            let found = lobe_cutoff(lobe).filter(|cutoff| cutoff.is_finite());
            found.unwrap_or(COSINE_CUTOFF).min(MIRROR)
        };
        let Ok(mut known) = self.known.lock() else {
            return find();
        };
        *known.entry([kind, width.to_bits()]).or_insert_with(find)
    }
}

/// Rounds a width to a few per cent, so that a textured roughness requires few cutoffs.
fn rounded(width: f64) -> f64 {
    let steps = 16.0;
    libm::exp2((steps * libm::log2(width.max(1e-4))).round() / steps)
}
