//! Derives systems of smooth surfaces from the scene, for rays and for reflection by a BRDF.

use crate::chain::stands_before;
use etendue_field::{Light, Mask, Orientation, Patch, Side, Specular, VirtualPlane};
use etendue_scene::{BlockerLayer, Event, Hit, Object, PatchObject, Scene, Surface};
use etendue_theory::geometry::Edition;
use etendue_theory::rays::{Plane, SpecularSurface, SpecularSystem};
use etendue_theory::{Observed, Obstacle, ObstacleForm, reflections, scattering};

/// Returns a plane, and the light, the masks and the specular surfaces on the way to this plane.
/// Returns `None` where light comes from a ray file, and where a surface is not specular.
#[must_use]
pub fn system(scene: &Scene, plane: &VirtualPlane) -> Option<Observed<SpecularSystem>> {
    if matches!(scene.light, Light::Rays { .. }) {
        return None;
    }
    let path = &scene.path;
    let hits = path.legs[..=plane.leg].iter().filter_map(|leg| leg.leaves);
    let elements: Option<Vec<SpecularSurface>> = hits
        .map(|hit| match hit.object {
            Object::Patch(i) => {
                let object = &scene.patches[i];
                let Event::Specular(event) = object.event else {
                    return None;
                };
                Some(SpecularSurface {
                    name: object.name.clone(),
                    patch: object.patch,
                    event,
                })
            }
            Object::Mesh(i) => {
                let mesh = &scene.meshes[i];
                Some(SpecularSurface {
                    name: mesh.name.clone(),
                    patch: mesh.osculating(&hit)?,
                    event: seen_from(mesh.smooth.as_ref()?.event, mesh.is_met_on_its_back(&hit)),
                })
            }
            Object::Surface(_) => None,
        })
        .collect();
    let system = SpecularSystem {
        light: scene.light.clone(),
        layers: layers_before(scene, plane),
        obstacles: beside_the_path(scene),
        elements: elements?,
    };
    Some(Observed {
        system,
        plane: in_frame(scene, plane),
    })
}

/// Returns the event of a surface, rewritten as if the front of the surface faced the light. `back`
/// states whether the back of the surface faces the light.
fn seen_from(event: Specular, back: bool) -> Specular {
    match event {
        Specular::Refraction {
            front,
            back: behind,
        } if back => Specular::Refraction {
            front: behind,
            back: front,
        },
        event => event,
    }
}

/// Returns a plane, and the light, the masks and the surface with a BRDF before this plane. Returns
/// `None` where the plane is not on the second leg, where the first surface has no BRDF, and where
/// light comes from a ray file.
#[must_use]
pub fn scattered(
    scene: &Scene,
    plane: &VirtualPlane,
) -> Option<Observed<scattering::ScatteringSystem>> {
    // A plane on the next surface has the coordinates of that surface.
    let is_on_next = plane.side == Side::Before && plane.orientation != Orientation::Orthogonal;
    if plane.leg != 1 || is_on_next || matches!(scene.light, Light::Rays { .. }) {
        return None;
    }
    let Object::Patch(i) = scene.path.legs[1].leaves?.object else {
        return None;
    };
    let object = &scene.patches[i];
    let Event::Reflects(reflectance) = &object.event else {
        return None;
    };
    let system = scattering::ScatteringSystem {
        light: scene.light.clone(),
        layers: layers_before(scene, plane),
        obstacles: beside_the_path(scene),
        name: object.name.clone(),
        patch: object.patch,
        reflectance: reflectance.clone(),
    };
    Some(Observed {
        system,
        plane: in_frame(scene, plane),
    })
}

/// Returns the light, all masks and all surfaces of the path, and a plane behind some of these
/// surfaces. Returns `None` if light comes from a ray file or has met a mesh. Also returns `None`
/// if no surface has scattered the light, if too many surfaces have, or if a mesh that light meets
/// later has too many triangles.
pub(crate) fn reflected(
    scene: &Scene,
    plane: &VirtualPlane,
) -> Option<Observed<reflections::ReflectionSystem>> {
    if matches!(scene.light, Light::Rays { .. }) {
        return None;
    }
    let legs = scene.path.legs.iter();
    let hits: Vec<Hit> = legs.filter_map(|leg| leg.leaves).collect();
    let visited = plane.leg;
    let surfaces = hits.iter().map(|hit| visited_surface(scene, hit));
    // A mesh does not count as a surface of the path if it ends the last leg or stands beside the
    // path.
    let surfaces: Vec<reflections::PathSurface> = surfaces.map_while(|surface| surface).collect();
    let scatterers = surfaces
        .iter()
        .take(visited)
        .filter(|s| s.scatters())
        .count();
    let is_in_range = (1..=reflections::MAX_SCATTERERS).contains(&scatterers);
    if surfaces.len() < visited || !is_in_range {
        return None;
    }
    let mut obstacles = beside_the_path(scene);
    obstacles.extend(scene.blockers.iter().map(|layer| in_the_way(layer, 0)));
    let ends = scene.path.ends_at(visited).map(|end| end.object);
    let later = hits.iter().skip(surfaces.len()).map(|hit| hit.object);
    if later
        .clone()
        .any(|object| is_finer(scene, object, MAX_VISITED_TRIANGLES))
    {
        return None;
    }
    obstacles.extend(later.map(|object| Obstacle {
        // The object that ends the last leg stops light only on the legs before.
        until: (Some(object) == ends).then_some(visited),
        ..as_obstacle(scene, object)
    }));
    let system = reflections::ReflectionSystem {
        light: scene.light.clone(),
        obstacles,
        surfaces,
        visited,
    };
    Some(Observed {
        system,
        plane: in_frame(scene, plane),
    })
}

/// Returns a surface of the path; `None` for a mesh.
fn visited_surface(scene: &Scene, hit: &Hit) -> Option<reflections::PathSurface> {
    let name = scene.name_of(hit.object).to_owned();
    let of = |patch, outline, interaction| reflections::PathSurface {
        name,
        patch,
        outline,
        hit: hit.point,
        interaction,
    };
    match hit.object {
        Object::Patch(i) => {
            let PatchObject { patch, event, .. } = &scene.patches[i];
            let interaction = match event {
                Event::Specular(event) => reflections::Interaction::Specular(*event),
                Event::Reflects(reflectance) => {
                    reflections::Interaction::Reflects(Box::new(reflectance.clone()))
                }
            };
            Some(of(*patch, None, interaction))
        }
        Object::Surface(i) => {
            let Surface {
                frame,
                size,
                albedo,
                ..
            } = &scene.surfaces[i];
            let patch = Patch {
                frame: *frame,
                curvature: [0.0; 3],
                aperture: 0.5 * libm::hypot(size[0], size[1]),
            };
            let interaction = reflections::Interaction::Diffuse { albedo: *albedo };
            Some(of(patch, Some(*size), interaction))
        }
        Object::Mesh(_) => None,
    }
}

/// Returns the masks that light meets before a plane, with their distances.
fn layers_before(scene: &Scene, plane: &VirtualPlane) -> Vec<(f64, Mask)> {
    let layers = scene.blockers.iter();
    let layers = layers.filter(|layer| stands_before(layer.distance, scene, plane));
    layers.map(|l| (l.distance, l.mask.clone())).collect()
}

/// Returns a plane in the frame at the light.
fn in_frame(scene: &Scene, plane: &VirtualPlane) -> Plane {
    let hit = surface(scene, plane);
    let patch = match hit.map(|hit| hit.object) {
        Some(Object::Patch(i)) if plane.orientation.is_local() => Some(scene.patches[i].patch),
        _ => None,
    };
    Plane {
        frame: scene.path.frame.decompose(&plane.frame),
        orientation: plane.orientation,
        longitude: plane.longitude,
        patch,
        side: plane.side,
        quantity: plane.quantity,
    }
}

/// Returns the edition of the formulas that a scene asks for.
pub(crate) fn print(scene: &Scene) -> Edition {
    if scene.file.as_printed {
        Edition::Equations
    } else {
        Edition::Corrected
    }
}

/// Returns the hit on the surface that carries a plane.
fn surface<'a>(scene: &'a Scene, plane: &VirtualPlane) -> Option<&'a Hit> {
    match plane.side {
        Side::Before => scene.path.ends_at(plane.leg),
        Side::After => scene.path.legs[plane.leg].leaves.as_ref(),
    }
}

/// Each ray of a prediction is tested against the triangles of a mesh only if the mesh has at most
/// this many triangles. With more triangles, the prediction would take too long.
const MAX_TRIANGLES: usize = 500;

/// The same limit for a mesh of the path, which rays rarely pass before they reach it.
const MAX_VISITED_TRIANGLES: usize = 5000;

/// Returns the objects that the path does not visit. They stop light.
pub(crate) fn unvisited(scene: &Scene) -> impl Iterator<Item = Object> + '_ {
    let surfaces = (0..scene.surfaces.len()).map(Object::Surface);
    let patches = (0..scene.patches.len()).map(Object::Patch);
    let meshes = (0..scene.meshes.len()).map(Object::Mesh);
    let all = surfaces.chain(patches).chain(meshes);
    all.filter(|object| !scene.path.visits(*object))
}

fn is_too_fine(scene: &Scene, object: Object) -> bool {
    is_finer(scene, object, MAX_TRIANGLES)
}

/// Checks whether an object is a mesh of more than `most` triangles.
fn is_finer(scene: &Scene, object: Object, most: usize) -> bool {
    matches!(object, Object::Mesh(i) if scene.meshes[i].triangles.len() > most)
}

/// Returns the obstacles beside the path. Rays are tested against these obstacles.
fn beside_the_path(scene: &Scene) -> Vec<Obstacle> {
    let coarse = unvisited(scene).filter(|object| !is_too_fine(scene, *object));
    coarse.map(|object| as_obstacle(scene, object)).collect()
}

fn as_obstacle(scene: &Scene, object: Object) -> Obstacle {
    Obstacle {
        name: scene.name_of(object).to_owned(),
        form: match object {
            Object::Surface(i) => ObstacleForm::Rectangle {
                frame: scene.surfaces[i].frame,
                size: scene.surfaces[i].size,
            },
            Object::Patch(i) => ObstacleForm::Patch(scene.patches[i].patch),
            Object::Mesh(i) => {
                ObstacleForm::Mesh(scene.meshes[i].triangles.iter().copied().collect())
            }
        },
        until: None,
    }
}

/// Returns the obstacle for a layer of blockers. Light meets the layer on the leg `from` and on
/// later legs, at places where the central ray does not meet it.
pub(crate) fn in_the_way(layer: &BlockerLayer, from: usize) -> Obstacle {
    Obstacle {
        name: layer.name.clone(),
        form: ObstacleForm::Mask {
            from,
            distance: layer.distance,
            mask: layer.mask.clone(),
        },
        until: None,
    }
}

/// Describes the meshes beside the path that have too many triangles. No ray is tested against
/// these meshes.
pub(crate) fn too_fine(scene: &Scene) -> Vec<String> {
    let fine = unvisited(scene).filter(|object| is_too_fine(scene, *object));
    fine.map(|object| {
        let name = scene.name_of(object);
        format!(
            "visibility of {name}, a mesh of more than {MAX_TRIANGLES} triangles beside the path"
        )
    })
    .collect()
}
