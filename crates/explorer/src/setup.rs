//! The settings: the numbers of the scene, their ranges, and their form in a URL.

use std::fmt::Write;

/// The key of a setting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SettingKey {
    /// Side of the square light, metres.
    Width,
    /// Offset of the light from the centre of the blockers, metres.
    Position,
    /// Distance from the light to the receiver, metres.
    Travel,
    /// Distance from the light to the blockers, metres.
    Distance,
    /// Distance between the centres of blockers, metres.
    Pitch,
    /// Side of a blocker as a fraction of the pitch; 0 removes all blockers.
    Fill,
    /// Number of blockers along X.
    Count,
    /// The shape of the blockers: 1 for squares on a jittered grid, 0 for slats along Y.
    Squares,
    /// Maximum displacement of squares in pitches.
    Jitter,
    /// Seed of the displacements.
    Seed,
    /// The kind of receiver: 1 for a curved glossy one, 0 for a flat diffuse one.
    Glossy,
    /// Curvature of the glossy receiver, 1/m, convex positive.
    Curvature,
    /// Exponent of the Phong lobe of the glossy receiver.
    Exponent,
    /// Albedo of the receiver.
    Albedo,
    /// Half-width of the window in position, metres.
    WindowX,
    /// Half-width of the window in slope.
    WindowU,
    /// Highest spatial frequency, cycles per metre.
    RhoMax,
    /// Spacing of spatial frequencies.
    RhoStep,
    /// Highest angular frequency, cycles per unit slope.
    NuMax,
    /// Spacing of angular frequencies.
    NuStep,
}

/// A setting, with its name in URLs, its label and its range.
#[derive(Clone, Copy, Debug)]
pub struct SettingEntry {
    /// The key.
    pub key: SettingKey,
    /// The name in URLs.
    pub name: &'static str,
    /// The label on the page; empty if the page has no slider for it.
    pub label: &'static str,
    /// The unit; empty for a pure number.
    pub unit: &'static str,
    /// Minimum and maximum.
    pub range: [f64; 2],
    /// Step of the slider; 0 for a logarithmic slider.
    pub step: f64,
    /// The initial value on a page.
    pub default: f64,
}

const fn entry(
    key: SettingKey,
    name: &'static str,
    [label, unit]: [&'static str; 2],
    range: [f64; 2],
    step: f64,
    default: f64,
) -> SettingEntry {
    SettingEntry {
        key,
        name,
        label,
        unit,
        range,
        step,
        default,
    }
}

/// All settings, in the order of [`SettingKey`].
pub const TABLE: [SettingEntry; 20] = [
    entry(
        SettingKey::Width,
        "width",
        ["width", "m"],
        [0.01, 0.4],
        0.002,
        0.06,
    ),
    entry(
        SettingKey::Position,
        "position",
        ["position", "m"],
        [-0.2, 0.2],
        0.002,
        0.0,
    ),
    entry(
        SettingKey::Travel,
        "travel",
        ["travel", "m"],
        [0.3, 2.0],
        0.01,
        1.0,
    ),
    entry(
        SettingKey::Distance,
        "at",
        ["distance", "m"],
        [0.05, 1.98],
        0.01,
        0.5,
    ),
    entry(
        SettingKey::Pitch,
        "pitch",
        ["pitch", "m"],
        [0.03, 0.4],
        0.002,
        0.1,
    ),
    entry(
        SettingKey::Fill,
        "fill",
        ["fill", ""],
        [0.0, 0.9],
        0.01,
        0.5,
    ),
    entry(
        SettingKey::Count,
        "count",
        ["number", ""],
        [1.0, 41.0],
        1.0,
        21.0,
    ),
    entry(
        SettingKey::Squares,
        "squares",
        ["", ""],
        [0.0, 1.0],
        1.0,
        0.0,
    ),
    entry(
        SettingKey::Jitter,
        "jitter",
        ["", ""],
        [0.0, 1.0],
        0.01,
        0.0,
    ),
    entry(
        SettingKey::Seed,
        "seed",
        ["", ""],
        [0.0, 4_294_967_295.0],
        1.0,
        1.0,
    ),
    entry(SettingKey::Glossy, "glossy", ["", ""], [0.0, 1.0], 1.0, 0.0),
    entry(
        SettingKey::Curvature,
        "curvature",
        ["curvature", "1/m"],
        [-0.8, 1.5],
        0.01,
        0.5,
    ),
    entry(
        SettingKey::Exponent,
        "exponent",
        ["lobe, n", ""],
        [5.0, 2000.0],
        0.0,
        200.0,
    ),
    entry(
        SettingKey::Albedo,
        "albedo",
        ["", ""],
        [0.01, 1.0],
        0.01,
        0.5,
    ),
    entry(
        SettingKey::WindowX,
        "window_x",
        ["", "m"],
        [0.01, 5.0],
        0.01,
        0.2,
    ),
    entry(
        SettingKey::WindowU,
        "window_u",
        ["", ""],
        [0.01, 1.0],
        0.01,
        0.25,
    ),
    entry(
        SettingKey::RhoMax,
        "rho_max",
        ["", "1/m"],
        [0.1, 1000.0],
        0.1,
        40.0,
    ),
    entry(
        SettingKey::RhoStep,
        "rho_step",
        ["", "1/m"],
        [0.01, 100.0],
        0.01,
        1.25,
    ),
    entry(
        SettingKey::NuMax,
        "nu_max",
        ["", ""],
        [0.1, 1000.0],
        0.1,
        32.0,
    ),
    entry(
        SettingKey::NuStep,
        "nu_step",
        ["", ""],
        [0.01, 100.0],
        0.01,
        1.0,
    ),
];

/// The settings of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Setup {
    values: [f64; TABLE.len()],
}

impl Default for Setup {
    fn default() -> Self {
        Self {
            values: TABLE.map(|entry| entry.default),
        }
    }
}

/// Minimum distance between blockers and receiver, metres.
const CLEARANCE: f64 = 0.02;

impl Setup {
    /// The value of a setting.
    #[must_use]
    pub fn get(&self, key: SettingKey) -> f64 {
        self.values[key as usize]
    }

    /// Whether a setting that is either 0 or 1 has the value 1.
    #[must_use]
    pub fn is(&self, key: SettingKey) -> bool {
        self.get(key) > 0.5
    }

    /// Changes a setting to the permitted value that is nearest to the given one. The setting's
    /// range and the scene limit the value.
    pub fn set(&mut self, key: SettingKey, value: f64) {
        let SettingEntry {
            range: [low, high],
            default,
            ..
        } = TABLE[key as usize];
        let value = if value.is_finite() { value } else { default };
        self.values[key as usize] = value.clamp(low, high);
        let most = self.get(SettingKey::Travel) - CLEARANCE;
        let distance = self.get(SettingKey::Distance).min(most);
        self.values[SettingKey::Distance as usize] = distance;
        // Squares never overlap.
        let room = 1.0 - self.get(SettingKey::Fill);
        let jitter = self.get(SettingKey::Jitter).min(room);
        self.values[SettingKey::Jitter as usize] = jitter;
    }

    /// The key of the setting with this name.
    #[must_use]
    pub fn named(name: &str) -> Option<SettingKey> {
        let mut table = TABLE.iter();
        table
            .find(|entry| entry.name == name)
            .map(|entry| entry.key)
    }

    /// The fragment of a URL, after #: all settings that differ from their defaults; the
    /// fragment is never empty.
    #[must_use]
    pub fn fragment(&self) -> String {
        let mut text = String::new();
        for entry in TABLE {
            let value = self.get(entry.key);
            if entry.key == SettingKey::Width || value.to_bits() != entry.default.to_bits() {
                let between = if text.is_empty() { "" } else { "&" };
                // Writing to a string does not fail.
                let _ = write!(text, "{between}{}={value}", entry.name);
            }
        }
        text
    }

    /// Reads a result of [`fragment`](Self::fragment), ignoring unknown parts.
    #[must_use]
    pub fn of_fragment(text: &str) -> Self {
        let mut setup = Self::default();
        let pairs = text.trim_start_matches('#').split('&');
        for (name, value) in pairs.filter_map(|pair| pair.split_once('=')) {
            if let (Some(key), Ok(value)) = (Self::named(name), value.parse()) {
                setup.set(key, value);
            }
        }
        setup
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_the_order_of_keys() {
        for (i, entry) in TABLE.iter().enumerate() {
            assert_eq!(entry.key as usize, i, "{}", entry.name);
            assert!((entry.range[0]..=entry.range[1]).contains(&entry.default));
            assert_eq!(Setup::named(entry.name), Some(entry.key));
        }
    }

    #[test]
    fn fragments_come_back() {
        let mut setup = Setup::default();
        assert_eq!(setup.fragment(), "width=0.06");
        setup.set(SettingKey::Travel, 1.7);
        setup.set(SettingKey::Distance, 1.2);
        setup.set(SettingKey::Width, 0.1 + 0.2);
        assert_eq!(
            setup.fragment(),
            "width=0.30000000000000004&travel=1.7&at=1.2"
        );
        assert_eq!(Setup::of_fragment(&setup.fragment()), setup);
        assert_eq!(
            Setup::of_fragment("#no=1&width=x&travel=nan&"),
            Setup::default()
        );
    }

    #[test]
    fn blockers_stay_before_the_receiver_and_apart() {
        let mut setup = Setup::default();
        setup.set(SettingKey::Travel, 0.4);
        assert!(setup.get(SettingKey::Distance) < 0.4);
        setup.set(SettingKey::Jitter, 0.9);
        assert!(setup.get(SettingKey::Jitter) <= 0.5);
    }
}
