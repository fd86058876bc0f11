//! Materials.

use crate::common::{
    assert_close, assert_first, assert_near, assert_refused, cases, causes, notes, world,
};
use etendue_world::{Material, Texture};
use glam::DVec2;

/// The texture's value in the first square of a checkerboard.
fn first(texture: &Texture) -> f64 {
    texture.value(&DVec2::splat(0.1).into())
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

/// The file of a sphere of this material.
fn principled(inside: &str) -> String {
    format!("<shape type=\"sphere\"><bsdf type=\"principled\">{inside}</bsdf></shape>")
}

#[test]
fn principled_is_a_metal_and_a_base() {
    let of = |inside: &str| match world(&principled(inside)).materials.remove(0) {
        Material::Principled(of) => *of,
        other => panic!("{other:?}"),
    };
    let plain = of("<float name=\"sheen_tint\" value=\"0.5\"/>");
    let values = [
        &plain.color,
        &plain.metallic,
        &plain.roughness,
        &plain.anisotropic,
    ]
    .map(first);
    assert_close(&values, &[0.5, 0.0, 0.5, 0.0], 1e-12);
    // 0.08 specular is the reflectance at normal incidence, ((n − 1)/(n + 1))².
    assert_near(plain.index, 1.5, 1e-12);
    let given = of("<float name=\"eta\" value=\"1.8\"/><float name=\"metallic\" value=\"1\"/>");
    assert_close(&[given.index, first(&given.metallic)], &[1.8, 1.0], 1e-12);
}

#[test]
fn principled_may_transmit_light() {
    let of = |inside: &str| match world(&principled(inside)).materials.remove(0) {
        Material::Principled(of) => [first(&of.transmission), of.index],
        other => panic!("{other:?}"),
    };
    let trans = "<float name=\"spec_trans\" value=\"0.7\"/>";
    assert_close(&of(trans), &[0.7, 1.5], 1e-12);
    // Mitsuba 3.9.1 changes an index of 1.
    let one = "<float name=\"eta\" value=\"1\"/>";
    assert_close(&of(one), &[0.0, 1.0], 1e-12);
    assert_close(&of(&format!("{trans}{one}")), &[0.7, 1.001], 1e-12);
    let specular = "<float name=\"specular\" value=\"0\"/>";
    let least = 2.0 / (1.0 - 0.000_08_f64.sqrt()) - 1.0;
    assert_close(&of(&format!("{trans}{specular}")), &[0.7, least], 1e-12);
    let inside = format!("<bsdf type=\"principled\">{trans}</bsdf>");
    let two = format!("<shape type=\"sphere\"><bsdf type=\"twosided\">{inside}</bsdf></shape>");
    assert_first(
        &causes(&two),
        "twosided contains a bsdf that transmits light",
    );
}

#[test]
fn unsound_principled_is_refused() {
    for (inside, what) in cases(
        r#"
        <float name="spec_trans" value="2"/> => spec_trans goes up to 2; allowed: 0 to 1
        <float name="roughness" value="1.5"/> => roughness goes up to 1.5; allowed: 0 to 1
        <float name="eta" value="0.9"/> => eta is 0.9; allowed: 1 or more
        <float name="eta" value="1.5"/><float name="specular" value="0.5"/>
        => specular is given together with eta
        "#,
    ) {
        assert_refused(&causes(&principled(inside)), &[what]);
    }
}

#[test]
fn masks_are_noted_where_mitsuba_takes_them_for_opaque() {
    let notes_of = |integrator: &str| {
        notes(&format!(
            "<integrator type=\"{integrator}\"/>\n<shape type=\"sphere\"><bsdf type=\"mask\"><bsdf type=\"diffuse\"/></bsdf></shape>"
        ))
    };
    let noted = "text:2:1: light passes `mask` and `null` as in volpath: also light of point lights, and without being counted by max_depth";
    assert_eq!(notes_of("path"), [noted]);
    assert_eq!(notes_of("volpath"), [""; 0]);
}
