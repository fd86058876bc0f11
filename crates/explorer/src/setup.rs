//! What a student sets: the numbers of the scene, their ranges, and how they are written in a URL.

use std::fmt::Write;

/// A number that can be set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Setting {
    /// Side of the square light, metres.
    Width,
    /// Where the light stands beside the middle of the blockers, metres.
    Position,
    /// From the light to the receiver, metres.
    Travel,
    /// From the light to the blockers, metres.
    Distance,
    /// Between the centres of blockers, metres.
    Pitch,
    /// Side of a blocker as a share of the pitch; nothing is there at 0.
    Fill,
    /// Blockers along X.
    Count,
    /// 1 for squares on a jittered grid, 0 for slats along Y.
    Squares,
    /// By how many pitches squares are moved.
    Jitter,
    /// Which places squares are moved to.
    Seed,
    /// 1 for a curved glossy receiver, 0 for a flat diffuse one.
    Glossy,
    /// Of the glossy receiver, 1/m, convex positive.
    Curvature,
    /// Exponent of its Phong lobe.
    Exponent,
    /// Share of the light that the receiver reflects.
    Albedo,
    /// Half-width of the window in position, metres.
    WindowX,
    /// Half-width of the window in slope.
    WindowU,
    /// Highest spatial frequency, cycles per metre.
    RhoMax,
    /// Its spacing.
    RhoStep,
    /// Highest angular frequency, cycles per unit slope.
    NuMax,
    /// Its spacing.
    NuStep,
}

/// A key with its name in URLs, its words and its range.
#[derive(Clone, Copy, Debug)]
pub struct SettingEntry {
    /// Which number.
    pub key: Setting,
    /// Its name in URLs.
    pub name: &'static str,
    /// What the page calls it; empty where the page has no slider for it.
    pub label: &'static str,
    /// Its unit; empty if it is a pure number.
    pub unit: &'static str,
    /// Least and most.
    pub range: [f64; 2],
    /// Between neighbours on the slider; 0 where it moves by factors.
    pub step: f64,
    /// Where a page begins.
    pub default: f64,
}

const fn entry(
    key: Setting,
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

/// All of them, in the order of [`Setting`].
pub const TABLE: [SettingEntry; 20] = [
    entry(
        Setting::Width,
        "width",
        ["width", "m"],
        [0.01, 0.4],
        0.002,
        0.06,
    ),
    entry(
        Setting::Position,
        "position",
        ["position", "m"],
        [-0.2, 0.2],
        0.002,
        0.0,
    ),
    entry(
        Setting::Travel,
        "travel",
        ["travel", "m"],
        [0.3, 2.0],
        0.01,
        1.0,
    ),
    entry(
        Setting::Distance,
        "at",
        ["distance", "m"],
        [0.05, 1.98],
        0.01,
        0.5,
    ),
    entry(
        Setting::Pitch,
        "pitch",
        ["pitch", "m"],
        [0.03, 0.4],
        0.002,
        0.1,
    ),
    entry(Setting::Fill, "fill", ["fill", ""], [0.0, 0.9], 0.01, 0.5),
    entry(
        Setting::Count,
        "count",
        ["number", ""],
        [1.0, 41.0],
        1.0,
        21.0,
    ),
    entry(Setting::Squares, "squares", ["", ""], [0.0, 1.0], 1.0, 0.0),
    entry(Setting::Jitter, "jitter", ["", ""], [0.0, 1.0], 0.01, 0.0),
    entry(
        Setting::Seed,
        "seed",
        ["", ""],
        [0.0, 4_294_967_295.0],
        1.0,
        1.0,
    ),
    entry(Setting::Glossy, "glossy", ["", ""], [0.0, 1.0], 1.0, 0.0),
    entry(
        Setting::Curvature,
        "curvature",
        ["curvature", "1/m"],
        [-0.8, 1.5],
        0.01,
        0.5,
    ),
    entry(
        Setting::Exponent,
        "exponent",
        ["lobe, n", ""],
        [5.0, 2000.0],
        0.0,
        200.0,
    ),
    entry(Setting::Albedo, "albedo", ["", ""], [0.01, 1.0], 0.01, 0.5),
    entry(
        Setting::WindowX,
        "window_x",
        ["", "m"],
        [0.01, 5.0],
        0.01,
        0.2,
    ),
    entry(
        Setting::WindowU,
        "window_u",
        ["", ""],
        [0.01, 1.0],
        0.01,
        0.25,
    ),
    entry(
        Setting::RhoMax,
        "rho_max",
        ["", "1/m"],
        [0.1, 1000.0],
        0.1,
        40.0,
    ),
    entry(
        Setting::RhoStep,
        "rho_step",
        ["", "1/m"],
        [0.01, 100.0],
        0.01,
        1.25,
    ),
    entry(Setting::NuMax, "nu_max", ["", ""], [0.1, 1000.0], 0.1, 32.0),
    entry(
        Setting::NuStep,
        "nu_step",
        ["", ""],
        [0.01, 100.0],
        0.01,
        1.0,
    ),
];

/// The numbers of a scene.
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

/// What is left between blockers and receiver, metres.
const CLEARANCE: f64 = 0.02;

impl Setup {
    /// A number.
    #[must_use]
    pub fn get(&self, key: Setting) -> f64 {
        self.values[key as usize]
    }

    /// Whether one of those that are 0 or 1 is set.
    #[must_use]
    pub fn is(&self, key: Setting) -> bool {
        self.get(key) > 0.5
    }

    /// Sets a number as near to a value as its range, and the scene, let it.
    pub fn set(&mut self, key: Setting, value: f64) {
        let SettingEntry {
            range: [low, high],
            default,
            ..
        } = TABLE[key as usize];
        let value = if value.is_finite() { value } else { default };
        self.values[key as usize] = value.clamp(low, high);
        let most = self.get(Setting::Travel) - CLEARANCE;
        let distance = self.get(Setting::Distance).min(most);
        self.values[Setting::Distance as usize] = distance;
        // Squares never overlap.
        let room = 1.0 - self.get(Setting::Fill);
        let jitter = self.get(Setting::Jitter).min(room);
        self.values[Setting::Jitter as usize] = jitter;
    }

    /// The key with a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Setting> {
        let mut table = TABLE.iter();
        table
            .find(|entry| entry.name == name)
            .map(|entry| entry.key)
    }

    /// What stands after # in a URL: all that is not as it was at the start, and never nothing.
    #[must_use]
    pub fn fragment(&self) -> String {
        let mut text = String::new();
        for entry in TABLE {
            let value = self.get(entry.key);
            if entry.key == Setting::Width || value.to_bits() != entry.default.to_bits() {
                let between = if text.is_empty() { "" } else { "&" };
                // Writing to a string does not fail.
                let _ = write!(text, "{between}{}={value}", entry.name);
            }
        }
        text
    }

    /// Reads what [`fragment`](Self::fragment) writes; what it does not know it leaves out.
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
        setup.set(Setting::Travel, 1.7);
        setup.set(Setting::Distance, 1.2);
        setup.set(Setting::Width, 0.1 + 0.2);
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
        setup.set(Setting::Travel, 0.4);
        assert!(setup.get(Setting::Distance) < 0.4);
        setup.set(Setting::Jitter, 0.9);
        assert!(setup.get(Setting::Jitter) <= 0.5);
    }
}
