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
    /// The cutoff of each kind of lobe at each rounded width.
    known: Mutex<BTreeMap<(&'static str, u64), f64>>,
}

impl Cutoffs {
    /// The cutoff in cycles per radian.
    pub(crate) fn of(&self, reflects: Reflects) -> f64 {
        match reflects {
            Reflects::Nothing => 0.0,
            Reflects::Diffuse => COSINE_CUTOFF,
            Reflects::Mirror => MIRROR,
            Reflects::Lobe(lobe) => self.of_lobe(lobe),
        }
    }

    fn of_lobe(&self, lobe: Lobe) -> f64 {
        let mut rounded = lobe;
        let kind = lobe.name();
        let Some((_, width)) = rounded.number_mut() else {
            return COSINE_CUTOFF;
        };
        // Widths are rounded to a few per cent, so that a textured roughness requires few cutoffs.
        let step = (STEPS * libm::log2(width.max(1e-4))).round();
        *width = libm::exp2(step / STEPS);
        let find = || {
            let found = lobe_cutoff(rounded).filter(|cutoff| cutoff.is_finite());
            found.unwrap_or(COSINE_CUTOFF).min(MIRROR)
        };
        let Ok(mut known) = self.known.lock() else {
            return find();
        };
        *known.entry((kind, step.to_bits())).or_insert_with(find)
    }
}

/// Number of widths between a width and twice this width.
const STEPS: f64 = 16.0;
