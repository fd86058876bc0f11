//! Indices of refraction of the materials that scenes refer to by name.

use super::object::{MitsubaObject, Value};
use super::reader::MitsubaReader;
use crate::report::quoted;

/// The indices are values at about 589 nm (Hecht, Optics, 4th edition), as in Mitsuba.
const NAMED: [(&str, f64); 23] = [
    ("vacuum", 1.0),
    ("helium", 1.000_036),
    ("hydrogen", 1.000_132),
    ("air", 1.000_277),
    ("carbon dioxide", 1.000_45),
    ("water", 1.3330),
    ("acetone", 1.36),
    ("ethanol", 1.361),
    ("carbon tetrachloride", 1.461),
    ("glycerol", 1.4729),
    ("benzene", 1.501),
    ("silicone oil", 1.52045),
    ("bromine", 1.661),
    ("water ice", 1.31),
    ("fused quartz", 1.458),
    ("pyrex", 1.470),
    ("acrylic glass", 1.49),
    ("polypropylene", 1.49),
    ("bk7", 1.5046),
    ("sodium chloride", 1.544),
    ("amber", 1.55),
    ("pet", 1.5750),
    ("diamond", 2.419),
];

impl<'a> MitsubaReader<'a> {
    /// Returns the index of refraction inside divided by the index outside. `inside` names the
    /// default material inside.
    pub(super) fn relative_index(&self, object: &'a MitsubaObject, inside: &str) -> Option<f64> {
        let inside = self.one_index(object, "int_ior", inside);
        let outside = self.one_index(object, "ext_ior", "air");
        Some(inside? / outside?)
    }

    fn one_index(&self, object: &'a MitsubaObject, name: &str, default: &str) -> Option<f64> {
        let word = match self.property(object, name).map(|p| &p.value) {
            None => default,
            Some(Value::Text(word)) => word,
            Some(_) => {
                return self.number_within(object, name, "a number above 0", |v| v > 0.0);
            }
        };
        let lower = word.to_lowercase();
        if let Some((_, index)) = NAMED.iter().find(|(known, _)| *known == lower) {
            return Some(*index);
        }
        let word = quoted(word);
        let message = format!("{name}: no index of refraction is known for {word}");
        self.fault(object, name, message)
    }
}
