//! Tests of properties that are read, left out or refused.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;
use crate::common::{assert_first, causes, notes, world};

#[test]
fn what_nobody_reads_is_noted_with_its_line() {
    let inside = "<shape type=\"sphere\">\n  <float name=\"radiuss\" value=\"2\"/>\n</shape>\n\
                  <bsdf type=\"diffuse\" id=\"spare\"/>\n<integrator type=\"path\"><integer name=\"rr_depth\" value=\"5\"/></integrator>";
    assert_eq!(
        notes(inside),
        [
            "text:3:3: `radiuss` of shape `sphere` is left out",
            "text:5:1: bsdf `diffuse` `spare` is not used",
            "text:6:25: `rr_depth` of integrator `path` is left out",
        ]
    );
}

#[test]
fn even_what_changes_no_light_is_noted() {
    let inside = "<emitter type=\"point\"><float name=\"sampling_weight\" value=\"2\"/></emitter>\n\
                  <sensor type=\"perspective\"><float name=\"focus_distance\" value=\"2\"/></sensor>";
    assert_eq!(
        notes(inside),
        [
            "text:2:23: `sampling_weight` of emitter `point` is left out",
            "text:3:28: `focus_distance` of sensor `perspective` is left out",
        ]
    );
}

#[test]
fn all_causes_are_listed() {
    let inside = "<shape type=\"teapot\"/>\n\
                  <shape type=\"sphere\"><float name=\"radius\" value=\"big\"/></shape>\n\
                  <shape type=\"sphere\"><bsdf type=\"fur\"/></shape>\n\
                  <shape type=\"sphere\"><ref id=\"nothing\"/></shape>\n\
                  <emitter type=\"point\"><rgb name=\"intensity\" value=\"1 2\"/></emitter>\n\
                  <gizmo/>";
    let found = causes(inside);
    for (line, what) in [
        (2, "shape `teapot` is not supported"),
        (3, "`big` is not a finite number"),
        (4, "bsdf `fur` is not supported"),
        (5, "no object has id `nothing`"),
        (6, "neither one number nor three"),
        (7, "<gizmo>: "),
    ] {
        let is_there =
            |cause: &String| cause.starts_with(&format!("text:{line}:")) && cause.contains(what);
        assert_eq!(
            found.iter().filter(|c| is_there(c)).count(),
            1,
            "{what}: {found:#?}"
        );
    }
    assert_eq!(found.len(), 6, "{found:#?}");
}

#[test]
fn ids_are_there_once() {
    let twice = "<bsdf type=\"diffuse\" id=\"a\"/>\n<bsdf type=\"diffuse\" id=\"a\"/>";
    assert_eq!(
        causes(twice),
        ["text:3:1: id `a` is already used in line 2"]
    );
    let twice = "<shape type=\"sphere\"><float name=\"radius\" value=\"1\"/><float name=\"radius\" value=\"1\"/></shape>";
    assert_eq!(
        causes(twice),
        ["text:2:54: property `radius` is given twice"]
    );
}

#[test]
fn references_may_come_before_their_object_but_aliases_not() {
    let forward = "<shape type=\"sphere\"><ref id=\"b\"/></shape>\
                   <shape type=\"sphere\"><ref name=\"bsdf\" id=\"a\"/></shape>\
                   <bsdf type=\"diffuse\" id=\"a\"/><alias id=\"a\" as=\"b\"/>";
    let found = world(forward);
    assert_eq!(found.materials.len(), 1);
    assert_eq!(found.shapes[0].material, found.shapes[1].material);
    let early = "<alias id=\"a\" as=\"b\"/><bsdf type=\"diffuse\" id=\"a\"/>";
    assert_eq!(causes(early), ["text:2:1: <alias>: no object has id `a`"]);
    let round = "<bsdf type=\"twosided\" id=\"a\"><ref id=\"a\"/></bsdf><shape type=\"sphere\"><ref id=\"a\"/></shape>";
    assert_first(&causes(round), "a bsdf contains itself");
}

#[test]
fn names_before_version_2_are_upgraded() {
    let text = "<scene version=\"0.6.0\"><shape type=\"sphere\"><transform name=\"toWorld\"><translate x=\"3\"/></transform>\
                <bsdf type=\"dielectric\"><float name=\"intIOR\" value=\"2\"/><float name=\"extIOR\" value=\"1\"/></bsdf></shape>\
                <integrator type=\"path\"><integer name=\"maxDepth\" value=\"4\"/></integrator></scene>";
    let folder = tempfile::tempdir().unwrap();
    let read =
        etendue_import::import_mitsuba(text, folder.path(), &etendue_import::Options::default());
    let read = read.unwrap();
    assert_eq!(read.notes, []);
    assert_eq!(read.world.depth, Some(3));
    common::assert_near(read.world.shapes[0].to_world.translation.x, 3.0, 0.0);
    let etendue_world::Material::Dielectric(glass) = &read.world.materials[0] else {
        panic!("{:?}", read.world.materials);
    };
    common::assert_near(glass.index, 2.0, 0.0);
}

#[test]
fn depths_are_counted_from_the_first_surface() {
    let depth = |inside: &str| world(inside).depth;
    let path = |n: &str| {
        format!(
            "<integrator type=\"moment\"><integrator type=\"path\"><integer name=\"max_depth\" value=\"{n}\"/></integrator></integrator>"
        )
    };
    assert_eq!(depth(""), None);
    assert_eq!(depth(&path("-1")), None);
    assert_eq!(depth(&path("1")), Some(0));
    assert_eq!(depth(&path("8")), Some(7));
    assert_eq!(depth("<integrator type=\"direct\"/>"), Some(1));
    assert_first(&causes(&path("0")), "shows nothing");
    let hidden =
        "<integrator type=\"path\"><boolean name=\"hide_emitters\" value=\"true\"/></integrator>";
    assert!(world(hidden).hides_sources && !world("").hides_sources);
}

#[test]
fn media_are_refused_once() {
    let inside = "<shape type=\"sphere\"><medium name=\"interior\" type=\"homogeneous\">\
                  <phase type=\"hg\"/><volume name=\"albedo\" type=\"constvolume\"/></medium></shape>";
    let found = causes(inside);
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].contains("participating media are not supported"));
}
