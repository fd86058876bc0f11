//! Draws random surfaces on the central ray or beside it.

use super::draw::SceneDraw;
use super::pictures::sheet;
use super::reflects::reflects;
use etendue_field::Frame;
use etendue_scene::{EventFile, FormFile, MeshSource, SurfaceFile};
use glam::DVec3;
use std::io;

/// The name of a surface, and the place where a leg of the path meets it.
struct Meeting<'a> {
    name: String,
    leg: &'a Frame,
    point: DVec3,
    normal: DVec3,
}

/// A surface that a leg of the path meets at the given distance along the leg.
pub(super) fn surface(
    draw: &mut SceneDraw,
    name: String,
    leg: &Frame,
    distance: f64,
) -> io::Result<SurfaceFile> {
    let at = Meeting {
        name,
        leg,
        point: leg.origin + distance * leg.d,
        normal: facing(draw, leg),
    };
    match draw.below(12) {
        0..=2 => Ok(rectangle(draw, at)),
        3 => mesh(draw, at),
        _ => smooth(draw, at),
    }
}

/// A normal that faces the arriving light. Incidence is normal or oblique, and sometimes
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
    draw.extreme_or(&[0.0, 1.0, 1e-6], |_| 0.5)
}

fn rectangle(draw: &mut SceneDraw, at: Meeting<'_>) -> SurfaceFile {
    // For a surface perpendicular to the first leg, the scene file may omit the facing direction.
    let plain = at.leg.d == DVec3::Z && draw.one_in(2);
    SurfaceFile::Rectangle {
        name: at.name,
        center: draw.place(at.point),
        size: [(); 2].map(|()| draw.length([1.0, 20.0], [0.05, 1e4])),
        facing: (!plain).then(|| draw.along(at.normal)),
        albedo: albedo(draw).into(),
    }
}

fn mesh(draw: &mut SceneDraw, at: Meeting<'_>) -> io::Result<SurfaceFile> {
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
            let x = (at.leg.x - at.leg.x.dot(at.normal) * at.normal).normalize_or(at.leg.y);
            MeshSource::File(sheet(draw, [x, at.normal.cross(x), at.normal], half)?)
        }
    };
    Ok(SurfaceFile::Mesh {
        name: at.name,
        center: draw.place(at.point),
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

fn smooth(draw: &mut SceneDraw, at: Meeting<'_>) -> io::Result<SurfaceFile> {
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
        away * (at.leg.y - at.leg.y.dot(at.normal) * at.normal).normalize_or(at.leg.x)
    } else {
        DVec3::ZERO
    };
    let turned = if !black_behind && draw.one_in(5) {
        -at.normal
    } else {
        at.normal
    };
    Ok(SurfaceFile::Smooth {
        name: at.name,
        center: draw.place(at.point + aside),
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

/// A small rectangle beside the first leg: the path does not visit it, but it blocks
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
