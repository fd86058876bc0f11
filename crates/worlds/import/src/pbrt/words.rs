//! The names of directives.

/// All directives of pbrt-v4.
const DIRECTIVES: [&str; 38] = [
    "Accelerator",
    "ActiveTransform",
    "AreaLightSource",
    "Attribute",
    "AttributeBegin",
    "AttributeEnd",
    "Camera",
    "ColorSpace",
    "ConcatTransform",
    "CoordSysTransform",
    "CoordinateSystem",
    "Film",
    "Identity",
    "Import",
    "Include",
    "Integrator",
    "LightSource",
    "LookAt",
    "MakeNamedMaterial",
    "MakeNamedMedium",
    "Material",
    "MediumInterface",
    "NamedMaterial",
    "ObjectBegin",
    "ObjectEnd",
    "ObjectInstance",
    "Option",
    "PixelFilter",
    "ReverseOrientation",
    "Rotate",
    "Sampler",
    "Scale",
    "Shape",
    "Texture",
    "Transform",
    "TransformTimes",
    "Translate",
    "WorldBegin",
];

/// Directives of pbrt-v3, replaced by `AttributeBegin` and `AttributeEnd`.
const LEGACY: [&str; 2] = ["TransformBegin", "TransformEnd"];

/// Checks whether a word is a directive.
pub(super) fn is_directive(word: &str) -> bool {
    DIRECTIVES.binary_search(&word).is_ok() || LEGACY.contains(&word)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directives_are_found() {
        assert!(DIRECTIVES.is_sorted());
        assert!(is_directive("Accelerator") && is_directive("WorldBegin"));
        assert!(!is_directive("WorldEnd"));
    }
}
