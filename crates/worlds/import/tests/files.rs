//! Files of a scene: search folders and permitted content.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;
use crate::common::{folder, read_in, scene};
use etendue_import::{Color, Options, import};
use std::fs;

const SPHERE: &[u8] = b"<shape type=\"sphere\" version=\"3.0.0\"/>";

#[test]
fn includes_bring_their_objects_and_see_defaults() {
    let part = scene(
        "<default name=\"r\" value=\"9\"/><default name=\"c\" value=\"7\"/>\
         <shape type=\"sphere\"><float name=\"radius\" value=\"$r\"/><ref id=\"m\"/></shape>\
         <bsdf type=\"diffuse\" id=\"m\"/>",
    );
    let files = folder(&[("parts/a.xml", part.as_bytes()), ("parts/b.xml", SPHERE)]);
    let inside = "<default name=\"r\" value=\"2\"/><path value=\"parts\"/>\
                  <include filename=\"a.xml\"/><include filename=\"parts/b.xml\"/>\
                  <shape type=\"sphere\"><float name=\"radius\" value=\"$c\"/></shape>";
    let world = read_in(inside, files.path(), Color::Luminance)
        .unwrap()
        .world;
    let radii = world.shapes.iter().map(|s| s.to_world.matrix3.x_axis.x);
    // Over all files, the first default that is given for a name counts. Defaults of an included
    // file remain in effect after the include.
    common::assert_close(&radii.collect::<Vec<f64>>(), &[2.0, 1.0, 7.0], 0.0);
}

#[test]
fn included_files_may_not_include_themselves() {
    let a = scene("<include filename=\"b.xml\"/>");
    let b = scene("<include filename=\"a.xml\"/>");
    let files = folder(&[("a.xml", a.as_bytes()), ("b.xml", b.as_bytes())]);
    let refused = import(&files.path().join("a.xml"), &Options::default()).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "b.xml:2:1: <include>: file `a.xml` includes itself"
    );
}

#[test]
fn no_file_leads_out_of_the_root() {
    let files = folder(&[
        ("out.xml", SPHERE),
        ("in/near.xml", SPHERE),
        (
            "in/deep/s.xml",
            scene("<include filename=\"../near.xml\"/>").as_bytes(),
        ),
        (
            "in/deep/t.xml",
            scene("<path value=\"../..\"/><include filename=\"../../out.xml\"/>").as_bytes(),
        ),
        (
            "in/deep/u.xml",
            scene("<include filename=\"link.xml\"/>").as_bytes(),
        ),
    ]);
    let root = Options {
        root: Some(files.path().join("in")),
        ..Options::default()
    };
    let at = |name: &str| files.path().join("in/deep").join(name);
    assert_eq!(import(&at("s.xml"), &root).unwrap().world.shapes.len(), 1);
    // Without a root folder in the options, no file outside the scene's folder is read.
    let refused = import(&at("s.xml"), &Options::default()).unwrap_err();
    assert!(
        refused.to_string().contains("is outside of the folder"),
        "{refused}"
    );
    let refused = import(&at("t.xml"), &root).unwrap_err();
    assert_eq!(refused.causes.len(), 2, "{refused}");
    assert!(
        refused
            .causes
            .iter()
            .all(|c| c.message.contains("is outside of the folder"))
    );
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(files.path().join("out.xml"), at("link.xml")).unwrap();
        let refused = import(&at("u.xml"), &root).unwrap_err();
        assert!(
            refused.to_string().contains("links are followed"),
            "{refused}"
        );
        fs::remove_file(at("link.xml")).unwrap();
    }
    let refused = import(&at("u.xml"), &root).unwrap_err();
    assert!(
        refused.to_string().contains("`link.xml` is not found"),
        "{refused}"
    );
}

#[test]
fn parameters_are_set_from_outside() {
    let text = scene(
        "<default name=\"r\" value=\"2\"/><default name=\"rr\" value=\"5\"/>\
         <shape type=\"sphere\" id=\"\\$r\"><float name=\"radius\" value=\"$rr\"/>\
         <point name=\"center\" x=\"$r.5\" y=\"0\" z=\"0\"/></shape>",
    );
    let files = folder(&[("a.xml", text.as_bytes())]);
    let set = |set: &[(&str, &str)]| Options {
        set: set
            .iter()
            .map(|(a, b)| ((*a).to_owned(), (*b).to_owned()))
            .collect(),
        ..Options::default()
    };
    let read = |options: &Options| import(&files.path().join("a.xml"), options);
    let world = read(&set(&[("rr", "3")])).unwrap().world;
    let shape = &world.shapes[0];
    assert_eq!(shape.name, "$r");
    let found = [
        shape.to_world.translation.x,
        shape.to_world.matrix3.x_axis.x,
    ];
    common::assert_close(&found, &[2.5, 3.0], 0.0);
    let refused = read(&set(&[("spp", "3")])).unwrap_err();
    assert!(
        refused
            .to_string()
            .contains("`$spp` is set, but the scene does not use it"),
        "{refused}"
    );
}

#[test]
fn defaults_that_hold_one_another_do_not_fill_memory() {
    let mut inside = String::from("<default name=\"a0\" value=\"xxxxxxxxxxxxxxxx\"/>");
    for i in 1..60 {
        let j = i - 1;
        inside += &format!("<default name=\"a{i}\" value=\"\\\\$a{j}$a{j}$a{j}\"/>");
    }
    let found = common::causes(&inside);
    assert!(
        found[0].contains("after parameters are inserted"),
        "{:?}",
        &found[..1]
    );
}
