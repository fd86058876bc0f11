//! Derives the path of light to a plane from the scene.

use crate::chain::stands_before;
use etendue_field::{Orientation, Patch, Side, Specular, VirtualPlane};
use etendue_scene::{Event, Hit, Object, PatchObject, Scene, Surface};
use etendue_theory::geometry::Edition;
use etendue_theory::path::{
    Interaction, PatchExtent, PathMask, PathSurface, PathSystem, reflections,
};
use etendue_theory::{Observed, Obstacle, ObstacleForm, Plane};

/// A plane, the light, all masks and all surfaces of the path to it. Returns `None` where
/// light comes from a ray file, where too many surfaces have scattered the light, or where some
/// surface has scattered it and another is a mesh. Also returns `None` if a mesh of the path that
/// is met later has too many triangles.
#[must_use]
pub fn path(scene: &Scene, plane: &VirtualPlane) -> Option<Observed> {
    if scene.light.listed().is_some() {
        return None;
    }
    let legs = scene.path.legs.iter();
    let hits: Vec<Hit> = legs.filter_map(|leg| leg.leaves).collect();
    let visited = plane.leg;
    let before: Option<Vec<PathSurface>> = hits[..visited]
        .iter()
        .map(|hit| surface_of(scene, hit).or_else(|| osculating(scene, hit)))
        .collect();
    let mut surfaces = before?;
    let scatterers = surfaces.iter().filter(|surface| surface.scatters()).count();
    let has_mesh = surfaces.iter().any(|surface| !surface.occludes);
    if scatterers > reflections::MAX_SCATTERERS || scatterers > 0 && has_mesh {
        return None;
    }
    let later = hits[visited..].iter();
    surfaces.extend(later.map_while(|hit| surface_of(scene, hit)));
    let mut obstacles = beside_the_path(scene);
    // From the first mesh that light meets later, objects stop light as objects beside the path do.
    // The object that ends the last leg stops light only on the legs before.
    let ends = scene.path.ends_at(visited).map(|end| end.object);
    let (known, rest) = hits.split_at(surfaces.len());
    for (i, hit) in rest.iter().enumerate() {
        let object = hit.object;
        // The path may visit an object again.
        let mut earlier = known.iter().chain(&rest[..i]);
        if earlier.any(|earlier| earlier.object == object) {
            continue;
        }
        let until = (Some(object) == ends).then_some(visited);
        if until == Some(0) {
            continue;
        }
        if is_finer(scene, object, MAX_VISITED_TRIANGLES) {
            return None;
        }
        obstacles.push(Obstacle {
            until,
            ..as_obstacle(scene, object)
        });
    }
    let system = PathSystem {
        light: scene.light.clone(),
        masks: masks(scene, plane),
        obstacles,
        surfaces,
        visited,
    };
    Some(Observed {
        system,
        plane: in_frame(scene, plane),
    })
}

/// A surface of the path; `None` for a mesh.
fn surface_of(scene: &Scene, hit: &Hit) -> Option<PathSurface> {
    let (patch, extent, interaction) = match hit.object {
        Object::Patch(i) => {
            let PatchObject { patch, event, .. } = &scene.patches[i];
            let interaction = match event {
                Event::Specular(event) => Interaction::Specular(*event),
                Event::Reflects(reflectance) => {
                    Interaction::Reflects(Box::new(reflectance.clone()))
                }
            };
            (*patch, PatchExtent::Whole, interaction)
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
            let interaction = Interaction::Diffuse { albedo: *albedo };
            (patch, PatchExtent::Rectangle(*size), interaction)
        }
        Object::Mesh(_) => return None,
    };
    Some(PathSurface {
        name: scene.name_of(hit.object).to_owned(),
        patch,
        extent,
        hit: hit.point,
        interaction,
        occludes: true,
    })
}

/// The patch that osculates a smooth mesh at the central ray's hit.
fn osculating(scene: &Scene, hit: &Hit) -> Option<PathSurface> {
    let Object::Mesh(i) = hit.object else {
        return None;
    };
    let mesh = &scene.meshes[i];
    let event = seen_from(mesh.smooth.as_ref()?.event, mesh.is_met_on_its_back(hit));
    Some(PathSurface {
        name: mesh.name.clone(),
        patch: mesh.osculating(hit)?,
        extent: PatchExtent::Whole,
        hit: hit.point,
        interaction: Interaction::Specular(event),
        occludes: false,
    })
}

/// The event of a surface, rewritten as if the front of the surface faced the light. `back`
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

/// The masks that light may cross before a plane, with their distances. Light that has not
/// met a surface crosses no mask behind a plane that is orthogonal to it.
fn masks(scene: &Scene, plane: &VirtualPlane) -> Vec<PathMask> {
    let is_straight = plane.leg == 0 && plane.orientation == Orientation::Orthogonal;
    let layers = scene.blockers.iter();
    let layers = layers.filter(|layer| !is_straight || stands_before(layer.distance, scene, plane));
    let masks = layers.map(|layer| PathMask {
        name: layer.name.clone(),
        distance: layer.distance,
        mask: layer.mask.clone(),
    });
    let mut masks: Vec<_> = masks.collect();
    masks.sort_by(|a, b| a.distance.total_cmp(&b.distance));
    masks
}

/// A plane in the frame at the light.
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

/// The edition of the formulas that a scene asks for.
pub(crate) fn print(scene: &Scene) -> Edition {
    if scene.file.as_printed {
        Edition::Equations
    } else {
        Edition::Corrected
    }
}

/// The hit on the surface that carries a plane.
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

/// The objects that the path does not visit. They stop light.
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

/// The obstacles beside the path. Rays are tested against these obstacles.
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
                ObstacleForm::mesh(scene.meshes[i].triangles.iter().copied().collect())
            }
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
