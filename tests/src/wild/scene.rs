//! Random scenes: surfaces are added one after the other, along the central ray.

use super::draw::SceneDraw;
use super::planes::{frequencies, planes, window};
use super::surfaces::{passed, surface};
use super::{blockers, light};
use etendue_field::{Frame, Orientation, Quantity};
use etendue_scene::{
    CentralRay, Color, Emission, EventFile, PathFile, Place, PlaneFile, RunFile, Sampling,
    SceneFile, SceneFormat, SurfaceFile, resolve,
};
use glam::DVec3;
use std::io;
use std::path::Path;

/// Maximum number of attempts to place a surface on the central ray.
const TRIES: usize = 8;

/// The scene with this index for this seed. The pictures and meshes of the scene are
/// written to the folder.
pub(crate) fn scene(seed: u64, index: u64, photons: u64, folder: &Path) -> io::Result<SceneFile> {
    let mut draw = SceneDraw::new(seed, index, folder);
    let mut file = empty(&mut draw, photons)?;
    let path = surfaces(&mut draw, &mut file)?;
    let first = path.legs[0].length;
    file.blockers = blockers::blockers(&mut draw, &file.light, first)?;
    if draw.one_in(10) {
        file.surfaces
            .push(passed(&mut draw, "beside".into(), first));
        // A surface that makes the path invalid is removed, for example a surface that stands on an
        // earlier leg of the path.
        if central_ray(&file, folder).is_none() {
            file.surfaces.pop();
        }
    }
    // The added surface may shorten the last leg of the path.
    let path = central_ray(&file, folder).unwrap_or(path);
    file.planes = planes(&mut draw, &file, &path);
    if draw.one_in(4) {
        file.run.sampling = Sampling::Random;
    }
    // With a common seed, chance failures would occur in many scenes together.
    file.run.seed = u64::from(draw.whole(1, 1 << 30));
    Ok(file)
}

/// A scene file with a light, and with a plane at this light.
fn empty(draw: &mut SceneDraw, photons: u64) -> io::Result<SceneFile> {
    let light = light::light(draw)?;
    let window = window(draw);
    let frequencies = frequencies(draw, &window);
    let emission = if draw.one_in(7) {
        Emission::Plain
    } else {
        Emission::Aimed
    };
    Ok(SceneFile {
        format: SceneFormat,
        description: String::new(),
        light,
        other_lights: Vec::new(),
        blockers: Vec::new(),
        surfaces: Vec::new(),
        path: PathFile {
            direction: draw.along(DVec3::Z),
            x_axis: draw.along(DVec3::X),
            visits: Vec::new(),
            leaves: None,
        },
        planes: vec![PlaneFile {
            name: "light".into(),
            at: Place::Emission,
            quantity: Quantity::Radiance,
            orientation: Orientation::Orthogonal,
            window: None,
            frequencies: None,
        }],
        window,
        frequencies,
        as_printed: false,
        run: RunFile {
            photons,
            seed: 1,
            batches: 64,
            alpha: 0.01,
            resolution: 0.1,
            emission,
            sampling: Sampling::Lattice,
            color: Color::Luminance,
        },
    })
}

/// Adds one to three surfaces along the path, and returns the path with these surfaces.
fn surfaces(draw: &mut SceneDraw, file: &mut SceneFile) -> io::Result<CentralRay> {
    let count = *draw.pick(&[1, 1, 1, 1, 2, 2, 3]);
    let mut leg = Frame::IDENTITY;
    let mut path = CentralRay {
        frame: draw.frame,
        legs: Vec::new(),
    };
    let mut tries = 0;
    while file.surfaces.len() < count && tries < TRIES * count {
        tries += 1;
        let i = file.surfaces.len();
        let distance = draw.length([0.6, 1.8], [0.02, 300.0]);
        let next = surface(draw, format!("s{i}"), &leg, distance)?;
        file.path.visits.push(next.name().to_owned());
        file.surfaces.push(next);
        match central_ray(file, &draw.folder) {
            Some(found) => path = found,
            None => {
                file.surfaces.pop();
                file.path.visits.pop();
                continue;
            }
        }
        leg = onwards(draw, file, &path);
    }
    if path.legs.is_empty() {
        return Err(io::Error::other("the central ray meets nothing"));
    }
    // Occasionally the scene file states the direction in which the path leaves the last surface.
    if !file.surfaces.last().is_some_and(is_specular) && draw.one_in(4) {
        file.path.leaves = Some(draw.along(leg.d));
        match central_ray(file, &draw.folder) {
            Some(found) => path = found,
            None => file.path.leaves = None,
        }
    }
    Ok(path)
}

/// The leg on which the next surface is placed. After a specular surface the next leg
/// follows the central ray; after any other surface, the next leg may have any direction in front
/// of the surface.
fn onwards(draw: &mut SceneDraw, file: &SceneFile, path: &CentralRay) -> Frame {
    let last = &path.legs[path.legs.len() - 1];
    let specular = file.surfaces.last().is_some_and(is_specular);
    let Some(hit) = last.leaves.as_ref().filter(|_| !specular) else {
        return last.frame;
    };
    let glossy = matches!(file.surfaces.last(), Some(SurfaceFile::Smooth { .. }));
    if glossy && draw.one_in(2) {
        return last.frame;
    }
    let aside = draw.direction().cross(hit.normal);
    let angle = draw.between(0.0, 1.1);
    let d = angle.cos() * hit.normal + angle.sin() * aside.normalize_or(DVec3::ZERO);
    last.frame.turned_to(d.normalize())
}

fn is_specular(surface: &SurfaceFile) -> bool {
    let event = match surface {
        SurfaceFile::Rectangle { .. } => None,
        SurfaceFile::Mesh { event, .. } => event.as_ref(),
        SurfaceFile::Smooth { event, .. } => Some(event),
    };
    event.is_some_and(|event| !matches!(event, EventFile::Reflects { .. } | EventFile::Sum { .. }))
}

/// The central ray of a valid scene.
fn central_ray(file: &SceneFile, folder: &Path) -> Option<CentralRay> {
    let scene = resolve("wild", file.clone(), folder, u64::MAX).ok()?;
    Some(scene.path)
}

#[cfg(test)]
mod tests {
    use super::scene;
    use crate::wild::run::text;
    use etendue_scene::{SceneFile, resolve};

    const SCENES: u64 = 100;

    #[test]
    fn scenes_are_legal_and_the_same_each_time() {
        let mut refused = Vec::new();
        for number in 0..SCENES {
            let [one, two] = [(); 2].map(|()| tempfile::tempdir().unwrap());
            let file = scene(1, number, 200_000, one.path()).unwrap();
            let again = scene(1, number, 200_000, two.path()).unwrap();
            assert_eq!(file, again, "scene {number}");
            assert_eq!(SceneFile::parse(&text(&file).unwrap()).unwrap(), file);
            if let Err(error) = resolve("scene", file, one.path(), u64::MAX) {
                refused.push(format!("{number}: {error}"));
            }
        }
        // The program may refuse one scene in twenty, because the generator does not obey all
        // rules of scene files.
        assert!(20 * refused.len() as u64 <= SCENES, "{refused:#?}");
    }
}
