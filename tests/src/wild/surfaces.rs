//! Draws random surfaces on the central ray or beside it.

use super::draw::SceneDraw;
use super::pictures::sheet;
use super::reflects::reflects;
use etendue_field::Frame;
use etendue_scene::{EventFile, FormFile, MeshSource, SurfaceFile};
use glam::DVec3;
use std::io;

/// Returns a surface that a leg of the path meets at the given distance along the leg.
pub(super) fn surface(
    draw: &mut SceneDraw,
    name: String,
    leg: &Frame,
    distance: f64,
) -> io::Result<SurfaceFile> {
    let on_axis = leg.origin + distance * leg.d;
    let normal = facing(draw, leg);
    match draw.below(12) {
        0..=2 => Ok(rectangle(draw, name, leg, on_axis, normal)),
        3 => mesh(draw, name, leg, on_axis, normal),
        _ => smooth(draw, name, leg, on_axis, normal),
    }
}

/// Returns a normal that faces the arriving light. Incidence is normal or oblique, and sometimes
/// grazing.
fn facing(draw: &mut SceneDraw, leg: &Frame) -> DVec3 {
    if draw.one_in(3) {
        return -leg.d;
    }
    let angle = if draw.is_extreme() {
        draw.between(1.2, 1.565)
    } else {
        draw.between(0.05, 0.95)
    };
    let azimuth = if draw.one_in(2) {
        0.0
    } else {
        draw.between(-3.1, 3.1)
    };
    let aside = azimuth.cos() * leg.x + azimuth.sin() * leg.y;
    angle.sin() * aside - angle.cos() * leg.d
}

fn albedo(draw: &mut SceneDraw) -> f64 {
    if draw.is_extreme() {
        *draw.pick(&[0.0, 1.0, 1e-6])
    } else {
        0.5
    }
}

fn rectangle(
    draw: &mut SceneDraw,
    name: String,
    leg: &Frame,
    on_axis: DVec3,
    normal: DVec3,
) -> SurfaceFile {
    // For a surface perpendicular to the first leg, the scene file may omit the facing direction.
    let plain = leg.d == DVec3::Z && draw.one_in(2);
    SurfaceFile::Rectangle {
        name,
        center: draw.place(on_axis),
        size: [(); 2].map(|()| draw.length([1.0, 20.0], [0.05, 1e4])),
        facing: (!plain).then(|| draw.along(normal)),
        albedo: albedo(draw).into(),
    }
}

fn mesh(
    draw: &mut SceneDraw,
    name: String,
    leg: &Frame,
    on_axis: DVec3,
    normal: DVec3,
) -> io::Result<SurfaceFile> {
    let half = draw.unit * draw.between(0.2, 0.8);
    let mesh = match draw.below(4) {
        0 => MeshSource::Star {
            radius: half,
            relief: draw.between(0.0, 0.3),
            lobes: draw.whole(0, 3),
            rings: draw.whole(8, 60),
        },
        1 | 2 => MeshSource::Paraboloid {
            curvatures: [(); 2].map(|()| draw.between(-0.5, 0.5) / draw.unit),
            half,
            cells: draw.whole(1, 60),
        },
        _ => {
            let x = (leg.x - leg.x.dot(normal) * normal).normalize_or(leg.y);
            MeshSource::File(sheet(draw, [x, normal.cross(x), normal], half)?)
        }
    };
    Ok(SurfaceFile::Mesh {
        name,
        center: draw.place(on_axis),
        mesh,
        scale: 1.0,
        albedo: albedo(draw).into(),
        event: match draw.below(4) {
            0 => Some(EventFile::Mirror),
            1 => Some(refraction(draw)),
            _ => None,
        },
    })
}

fn refraction(draw: &mut SceneDraw) -> EventFile {
    let index = |draw: &mut SceneDraw| draw.value([1.0, 1.8], [0.1, 10.0]);
    let (front, back) = *draw.pick(&[(1.0, 1.5), (1.5, 1.0), (0.0, 0.0)]);
    if front > 0.0 {
        EventFile::Refraction { front, back }
    } else {
        EventFile::Refraction {
            front: index(draw),
            back: index(draw),
        }
    }
}

fn smooth(
    draw: &mut SceneDraw,
    name: String,
    leg: &Frame,
    on_axis: DVec3,
    normal: DVec3,
) -> io::Result<SurfaceFile> {
    let (event, flat) = match draw.below(10) {
        0 | 1 => (EventFile::Mirror, false),
        2 | 3 => (refraction(draw), false),
        4 => {
            let focal = draw.length([0.3, 2.0], [1e-2, 1e3]);
            (EventFile::ThinLens(draw.signed(focal)), true)
        }
        _ => (reflects(draw)?, false),
    };
    let black_behind = matches!(event, EventFile::Reflects { .. } | EventFile::Sum { .. });
    let form = if flat { FormFile::Plane } else { form(draw) };
    let mut aperture = draw.length([0.2, 1.0], [1e-4, 100.0]);
    if let FormFile::Sphere(k) | FormFile::Cylinder(k) = form {
        aperture = aperture.min(0.999 / k.abs());
    }
    let aside = if draw.one_in(4) {
        let away = draw.between(-0.4, 0.4) * aperture;
        away * (leg.y - leg.y.dot(normal) * normal).normalize_or(leg.x)
    } else {
        DVec3::ZERO
    };
    let turned = if !black_behind && draw.one_in(5) {
        -normal
    } else {
        normal
    };
    Ok(SurfaceFile::Smooth {
        name,
        center: draw.place(on_axis + aside),
        facing: draw.along(turned),
        form,
        along: draw.one_in(3).then(|| draw.direction().to_array()),
        aperture,
        event,
    })
}

fn form(draw: &mut SceneDraw) -> FormFile {
    let curvature = |draw: &mut SceneDraw| {
        let k = draw.value([0.05, 1.0], [1e-6, 50.0]) / draw.unit;
        draw.signed(k)
    };
    match draw.below(5) {
        0 | 1 => FormFile::Plane,
        2 => FormFile::Sphere(curvature(draw)),
        3 => FormFile::Cylinder(curvature(draw)),
        _ => FormFile::Paraboloid(curvature(draw), curvature(draw)),
    }
}

/// Returns a small rectangle beside the first leg: the path does not visit it, but it blocks
/// light.
pub(super) fn passed(draw: &mut SceneDraw, name: String, first: f64) -> SurfaceFile {
    let size = [(); 2].map(|()| draw.unit * draw.between(0.05, 0.3));
    let gap = draw.unit * draw.between(0.01, 0.2);
    let x = draw.signed(0.5 * size[0] + gap);
    let z = first * draw.between(0.1, 0.9);
    SurfaceFile::Rectangle {
        name,
        center: draw.place(DVec3::new(x, 0.0, z)),
        size,
        facing: None,
        albedo: 0.5.into(),
    }
}
