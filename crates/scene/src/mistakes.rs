//! Warns of likely mistakes in a valid scene: wrong units, coarse frequency grids, and arrays of
//! blockers that are too small.

use crate::scene::{BlockerLayer, Scene};
use etendue_field::{EmittedRays, Mask, VirtualPlane, Window, brief};
use etendue_scenefile::{FrequenciesFile, PlaneFile, WindowFile};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// A length above this limit, in metres, is suspicious if the other lengths of the scene are about
/// a metre.
const MANY_METRES: f64 = 100.0;
/// A length below this limit, in metres, counts as about one metre.
const NEAR: f64 = 10.0;
/// A slope above this limit is suspicious, because slopes beyond 79° from the central ray are
/// rarely intended.
const STEEP: f64 = 5.0;

/// A description of each likely mistake.
pub(crate) fn mistakes(scene: &Scene) -> Vec<String> {
    let planes = scene.file.planes.iter().zip(&scene.planes).enumerate();
    let mut told = BTreeSet::new();
    for (i, (file, plane)) in planes {
        told.extend(coarse(i, file, plane, &scene.file.frequencies));
    }
    told.extend(past_edges(scene));
    let steep = steep(&scene.file.window);
    long(scene).into_iter().chain(steep).chain(told).collect()
}

/// Warns of lengths that seem to be written in millimetres.
fn long(scene: &Scene) -> Option<String> {
    let file = serde_json::to_value(&scene.file).ok()?;
    let mut lengths = Vec::new();
    collect(&file, "", false, &mut lengths);
    let origin = scene.path.frame.origin.to_array();
    for (path, length) in &mut lengths {
        // Positions are compared relative to the light.
        let of_world = path
            .strip_suffix(']')
            .filter(|path| !path.contains(".shapes["));
        let axis = of_world.and_then(|path| path.split_once(".center[")?.1.parse::<usize>().ok());
        *length = (*length - axis.map_or(0.0, |axis| origin[axis])).abs();
    }
    lengths.retain(|(_, length)| *length > 0.0);
    lengths.sort_by(|(_, a), (_, b)| a.total_cmp(b));
    let (_, median) = lengths.get(lengths.len() / 2)?;
    let (path, longest) = lengths.last()?;
    if *median >= MANY_METRES {
        return Some(format!(
            "lengths are about {} m, up to {} m ({path}): are these lengths in millimetres?",
            brief(*median),
            brief(*longest)
        ));
    }
    (*longest >= MANY_METRES && *median < NEAR).then(|| {
        format!(
            "{path} is {} m, but other lengths are about {} m: is this length in millimetres?",
            brief(*longest),
            brief(*median)
        )
    })
}

/// Warns of slopes that seem to be angles written in degrees.
fn steep(window: &WindowFile) -> Option<String> {
    let axes = [("u", Some(&window.u)), ("v", window.v.as_ref())];
    let (name, slope) = axes
        .into_iter()
        .filter_map(|(name, profile)| Some((name, profile?.half_width())))
        .find(|(_, slope)| *slope > STEEP)?;
    Some(format!(
        "window.{name} reaches a slope of {}, which is {:.0}° from the central ray: is the value an angle in degrees?",
        brief(slope),
        libm::atan(slope).to_degrees()
    ))
}

/// Collects all lengths below a node, each with the path of its field.
fn collect(node: &Value, path: &str, is_length: bool, lengths: &mut Vec<(String, f64)>) {
    const LENGTHS: [&str; 9] = [
        "center", "size", "radius", "pitch", "edge", "aperture", "half", "Distance", "x",
    ];
    match node {
        Value::Number(number) if is_length => {
            lengths.extend(number.as_f64().map(|length| (path.to_owned(), length)));
        }
        Value::Array(items) => {
            for (i, item) in items.iter().enumerate() {
                collect(item, &format!("{path}[{i}]"), is_length, lengths);
            }
        }
        Value::Object(fields) => {
            for (name, field) in fields {
                let is_variant = name.starts_with(char::is_uppercase);
                let is_length = LENGTHS.contains(&name.as_str()) || (is_variant && is_length);
                let dot = if path.is_empty() { "" } else { "." };
                let below = if is_variant {
                    path.to_owned()
                } else {
                    format!("{path}{dot}{name}")
                };
                collect(field, &below, is_length, lengths);
            }
        }
        _ => {}
    }
}

/// Warns if the largest frequency of a plane is smaller than the smallest frequency step that the
/// window resolves.
fn coarse(
    i: usize,
    file: &PlaneFile,
    plane: &VirtualPlane,
    shared: &FrequenciesFile,
) -> Vec<String> {
    let (of, frequencies) = match &file.frequencies {
        Some(own) => (format!("planes[{i}].frequencies"), own),
        None => ("frequencies".to_owned(), shared),
    };
    let Window { x, y, u, v } = &plane.window;
    let axes = [
        ("rho", &frequencies.rho, [x, y]),
        ("nu", &frequencies.nu, [u, v]),
    ];
    let told = axes.into_iter().filter_map(|(name, axis, profiles)| {
        let [a, b] = profiles.map(|profile| profile.half_width());
        let step = 0.5 / a.max(b);
        (axis.max < step).then(|| {
            format!(
                "{of}.{name}.max is {}, but a step of the grid is already 1/(2 · half-width of the window) = {}",
                brief(axis.max),
                brief(step)
            )
        })
    });
    told.collect()
}

/// Warns of arrays of blockers around the central ray if light passes beside the array to a plane.
fn past_edges(scene: &Scene) -> Vec<String> {
    // With several lights, the warning is about the light that reaches farthest.
    let mut all: BTreeMap<[&str; 2], [[f64; 2]; 2]> = BTreeMap::new();
    for of in scene.lights() {
        for layer in &of.blockers {
            let Some(edges) = edges(layer) else {
                continue;
            };
            for plane in &of.planes {
                let Some(reach) = reach(of, plane, layer.distance) else {
                    continue;
                };
                let seen = all.entry([&plane.name, &layer.name]).or_default();
                *seen = [[0, 1].map(|axis| seen[0][axis].max(reach[axis])), edges];
            }
        }
    }
    let beyond = all
        .into_iter()
        .filter(|(_, [reach, edges])| (0..2).any(|axis| reach[axis] > edges[axis]));
    let told = beyond.map(|([plane, layer], [reach, edges])| {
        format!(
            "{plane}: light that reaches this plane passes {layer} at up to {} m from the central ray. The array ends at {} m, so nothing blocks the light beyond its edge",
            pair(reach),
            pair(edges)
        )
    });
    told.collect()
}

fn pair([x, y]: [f64; 2]) -> String {
    format!("({}, {})", brief(x), brief(y))
}

/// The distances from the central ray to the edges of an array, along X and along Y. An
/// edge of an array lies half a pitch beyond the centres of the outermost shapes, or at the ends
/// of bars. Returns `None` for an array beside the central ray.
fn edges(layer: &BlockerLayer) -> Option<[f64; 2]> {
    let Mask::Opaque { shapes, .. } = &layer.mask else {
        return None;
    };
    let half = 0.5 * layer.pitch?;
    let edges = [0, 1].map(|axis| {
        let halves = shapes.iter().map(|shape| {
            let bounds = shape.bounds();
            (bounds.center[axis], half.max(0.5 * bounds.size[axis]))
        });
        let ends = halves.map(|(at, half)| [at - half, at + half]);
        let [low, high] = ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], [a, b]| {
            [low.min(a), high.max(b)]
        });
        high.min(-low)
    });
    edges.iter().all(|edge| *edge > 0.0).then_some(edges)
}

/// How far the light that a plane sees extends from the central ray, at a given distance
/// along the first leg.
fn reach(scene: &Scene, plane: &VirtualPlane, at: f64) -> Option<[f64; 2]> {
    let w = &plane.window;
    let windows = [(&w.x, &w.u), (&w.y, &w.v)].map(|(x, u)| [x.half_width(), u.half_width()]);
    // If the plane is on the first leg, this is the distance of the plane. Otherwise it is the
    // distance at which light leaves the first leg.
    let end = match plane.leg {
        0 => plane.distance,
        1 if scene.path.legs[1].frame.d.z < -0.999 => scene.path.first_hit(),
        _ => return None,
    };
    if at >= end {
        return None;
    }
    let along = |axis: usize| {
        let [x, u] = windows[axis];
        let hit = x + (plane.distance - end) * u;
        let light = scene.light.extent(axis).map(f64::abs);
        let light = light[0].max(light[1]);
        let from_light = light + (hit - light) * at / end;
        let from_plane = x + (end - at) * u;
        match (plane.leg, scene.light.rays()) {
            (_, EmittedRays::Parallel(_)) => hit,
            // For an environment, the bound by the light is infinite, so the minimum is the bound
            // by the plane.
            (0, _) => from_plane.min(from_light),
            _ => from_light,
        }
    };
    let reach = [0, 1].map(along);
    reach.iter().all(|reach| reach.is_finite()).then_some(reach)
}
