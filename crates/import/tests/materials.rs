//! Materials.

use crate::common::world;
use etendue_world::{Material, Texture};
use glam::DVec2;

/// Returns the texture's value in the first square of a checkerboard.
fn first(texture: &Texture) -> f64 {
    texture.value(DVec2::splat(0.1))
}

#[test]
fn checkerboards_are_turned_where_they_are_numbers() {
    let board = |name: &str| {
        format!(
            "<texture name=\"{name}\" type=\"checkerboard\"><float name=\"color0\" value=\"0.1\"/><float name=\"color1\" value=\"0.3\"/></texture>"
        )
    };
    let shape = |bsdf: &str| world(&format!("<shape type=\"sphere\">{bsdf}</shape>")).materials;
    let colour = shape(&format!(
        "<bsdf type=\"diffuse\">{}</bsdf>",
        board("reflectance")
    ));
    let Material::Diffuse { reflectance } = &colour[0] else {
        panic!("{colour:?}");
    };
    let rough = shape(&format!(
        "<bsdf type=\"roughconductor\">{}</bsdf>",
        board("alpha")
    ));
    let Material::Conductor(metal) = &rough[0] else {
        panic!("{rough:?}");
    };
    let masked = shape(&format!(
        "<bsdf type=\"mask\">{}<bsdf type=\"diffuse\"/></bsdf>",
        board("opacity")
    ));
    let Material::Mask { opacity, .. } = &masked[0] else {
        panic!("{masked:?}");
    };
    let alpha = &metal.roughness.as_ref().unwrap().alpha[0];
    for (texture, expected) in [(reflectance, 0.1), (alpha, 0.3), (opacity, 0.3)] {
        // The value of the texture is the number in the file, without conversion.
        assert!((first(texture) - expected).abs() < 1e-12, "{texture:?}");
    }
}
