//! The functions that the page calls.

use crate::{CELLS, PathPlace, SettingKey, Setup, TABLE, grid, lobe, scene};
use etendue_theory::shading::Criterion;
use wasm_bindgen::prelude::wasm_bindgen;

/// A scene with its display resolution.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Explorer {
    setup: Setup,
    /// Cells of a light field along each axis.
    cells: usize,
}

#[wasm_bindgen]
impl Explorer {
    /// Reads the scene from the fragment of a URL, after #.
    #[must_use]
    #[wasm_bindgen(constructor)]
    pub fn new(fragment: &str) -> Self {
        Self {
            setup: Setup::of_fragment(fragment),
            cells: CELLS,
        }
    }

    /// Makes updates during interaction fast: keeps every other frequency, if the window needs no
    /// more, and enlarges the cells. The remaining values are as accurate as before.
    pub fn coarsen(&mut self) {
        for key in [SettingKey::RhoStep, SettingKey::NuStep] {
            self.setup.set(key, 2.0 * self.setup.get(key));
        }
        self.cells = CELLS / 2;
    }

    /// The scene as the fragment of a URL, after #.
    #[must_use]
    pub fn fragment(&self) -> String {
        self.setup.fragment()
    }

    /// The settings as JSON: name, label, unit, min, max, step.
    #[must_use]
    pub fn table() -> String {
        let rows = TABLE.map(|entry| {
            let [min, max] = entry.range;
            let (name, label, unit) = (entry.name, entry.label, entry.unit);
            let step = entry.step;
            format!(
                "{{\"name\":\"{name}\",\"label\":\"{label}\",\"unit\":\"{unit}\",\
                 \"min\":{min},\"max\":{max},\"step\":{step}}}"
            )
        });
        format!("[{}]", rows.join(","))
    }

    /// The value of a setting by name; NaN if the name is unknown.
    #[must_use]
    pub fn get(&self, name: &str) -> f64 {
        Setup::named(name).map_or(f64::NAN, |key| self.setup.get(key))
    }

    /// Changes a setting by name.
    pub fn set(&mut self, name: &str, value: f64) {
        if let Some(key) = Setup::named(name) {
            self.setup.set(key, value);
        }
    }

    /// The names of the planes, one per line; a * marks planes that take long to compute.
    #[must_use]
    pub fn planes(&self) -> String {
        let all = PathPlace::all(&self.setup).into_iter();
        let shown = |p: PathPlace| format!("{}{}", if p.is_slow() { "*" } else { "" }, p.name());
        all.map(shown).collect::<Vec<_>>().join("\n")
    }

    /// The light field at a plane: the number of cells along x and along u, then the values, with u
    /// varying fastest.
    #[must_use]
    pub fn field(&self, plane: usize) -> Vec<f64> {
        let values = PathPlace::all(&self.setup)[plane]
            .field(&self.setup, self.cells)
            .values;
        values.iter().copied().collect()
    }

    /// The spectrum at a plane at azimuth 0, for ρ ≥ 0: alternating real and imaginary parts, with
    /// ν varying fastest.
    #[must_use]
    pub fn spectrum(&self, plane: usize) -> Vec<f64> {
        let slices = PathPlace::all(&self.setup)[plane].spectrum(&self.setup);
        slices
            .half
            .iter()
            .flat_map(|value| [value.re, value.im])
            .collect()
    }

    /// The spectrum and then the light field at a plane by ray tracing, with values in the order of
    /// `spectrum` and `field`. The list is empty if `spectrum` and `field` are already exact.
    #[must_use]
    pub fn follow(&self, plane: usize) -> Vec<f64> {
        let plane = PathPlace::all(&self.setup)[plane];
        let Some((slices, field)) = plane.followed(&self.setup) else {
            return Vec::new();
        };
        let first = slices.half.outer_iter().next();
        let parts = first.into_iter().flatten();
        let spectrum = parts.flat_map(|value| [value.re, value.im]);
        spectrum.chain(field.values.iter().copied()).collect()
    }

    /// The axes as a list: the number of cells of a light field along each axis, and the
    /// half-widths in x and u. The number of steps to each side and their spacing follow, along ρ
    /// and then along ν.
    #[must_use]
    pub fn axes(&self) -> Vec<f64> {
        let grid = grid(&self.setup);
        let half = |key| self.setup.get(key);
        vec![
            self.cells as f64,
            half(SettingKey::WindowX),
            half(SettingKey::WindowU),
            grid.rho.half as f64,
            grid.rho.spacing,
            grid.nu.half as f64,
            grid.nu.spacing,
        ]
    }

    /// The sampling criterion for an eye one metre from the glossy receiver: the cutoff of the lobe
    /// (99 %), cycles per radian, then two corrected bandwidths. The first bandwidth is under an
    /// environment (Eq. 20 of Durand et al. 2005), the second behind an edge of the blockers (Eq.
    /// 21).
    #[must_use]
    pub fn criterion(&self) -> Vec<f64> {
        let get = |key| self.setup.get(key);
        let criterion = Criterion {
            curvature: get(SettingKey::Curvature),
            incidence: 0.0,
            outgoing: 0.0,
            distance: 1.0,
            blocker_distance: Some(get(SettingKey::Travel) - get(SettingKey::Distance)),
            lobe_cutoff: lobe(&self.setup).cutoff(0.99),
            environment_cutoff: 0.0,
        };
        vec![
            criterion.lobe_cutoff,
            criterion.environment(),
            criterion.blocker(),
        ]
    }

    /// The scene file.
    #[must_use]
    pub fn scene(&self) -> String {
        scene(&self.setup)
    }
}
