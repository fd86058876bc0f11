//! Tests that photons meet the same obstacles and cross the same planes if they are traced many at
//! a time and if they are traced one by one.

use super::*;
use crate::lanes::lanes;
use crate::mesh_order::OrderMemory;
use etendue_scene::{Sampling, SceneFile, resolve};
use etendue_transform::random::words;

/// Random numbers 0..`count`.
fn dice(seed: u64, index: u64, count: u32) -> [u32; 4] {
    words(seed, Stream::Photon, index, 9).map(|word| word % count)
}

/// A scene with obstacles across the leg at distances of 1 to 3. All edges have coordinates
/// that are multiples of 1/16. Some scenes also have a mesh between the last two distances.
fn scene(seed: u64) -> Scene {
    let mut blockers = String::new();
    let mut planes =
        String::from(r#"(name: "light", at: Emission), (name: "gap", at: Distance(1.5)),"#);
    for layer in 1..=3 {
        let mut shapes = String::new();
        for cell in 0..9_u32 {
            let [chosen, width, height, disc] = dice(seed, 16 * layer + u64::from(cell), 8);
            let [x, y] = [cell % 3, cell / 3].map(|i| f64::from(i) - 1.0);
            let [width, height] = [width, height].map(|side| f64::from(side + 1) / 8.0);
            // Some layers have few shapes, and some have so many that they form a grid.
            let is_left_out = (seed + layer).is_multiple_of(2) && cell != 4 && chosen < 6;
            if is_left_out {
                continue;
            }
            // A scene may have only few discs.
            shapes += &if disc < 4 && layer == seed % 3 + 1 {
                format!("Disc(center: ({x}, {y}), radius: {}),", width / 2.0)
            } else {
                format!("Rectangle(center: ({x}, {y}), size: ({width}, {height})),")
            };
        }
        let [half, side, ..] = dice(seed, layer, 2);
        if half == 1 {
            let half_plane = ["edge: 2, opaque: Above", "edge: -1.75, opaque: Below"];
            shapes += &format!("HalfPlane(axis: X, {}),", half_plane[side as usize]);
        }
        blockers +=
            &format!(r#"Shapes(name: "{layer}", center: (0, 0, {layer}), shapes: [{shapes}]),"#);
        planes += &format!(
            r#"(name: "b{layer}", at: Before("{layer}")), (name: "a{layer}", at: After("{layer}")),"#
        );
    }
    if seed.is_multiple_of(3) {
        blockers += r#"Mesh(
            name: "star", center: (0.1, 0, 3.5),
            mesh: Star(radius: 0.3, relief: 0.3, lobes: 3, rings: 12),
        ),"#;
    }
    let hole = [
        "Disc(center: (0.25, 0), radius: 1.25)",
        "Rectangle(center: (0.25, 0), size: (2, 1.5))",
        "Polygon(corners: [(1.5, 0), (0.5, 1.25), (-1, 0.75), (-0.75, -1)])",
    ];
    if let Some(hole) = hole.get((seed % 4) as usize) {
        blockers += &format!(r#"Aperture(name: "hole", center: (0, 0.5, 2.5), hole: {hole}),"#);
        planes += r#"(name: "hole", at: After("hole")),"#;
    }
    let leaving = [r#"(name: "leaving", at: After("floor")),"#, ""][(seed % 2) as usize];
    let text = format!(
        r#"(
            light: Rectangle(center: (0, 0, 0), size: (1, 1), radiance: 1.0),
            blockers: [{blockers}],
            surfaces: [Rectangle(name: "floor", center: (0, 0, 4), size: (4, 5), albedo: 0.3)],
            path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["floor"]),
            planes: [{planes} (name: "receiver", at: Before("floor")), {leaving}],
            window: (x: Hann(1), u: Hann(0.5)),
            frequencies: (rho: (max: 4), nu: (max: 4)),
            run: (photons: 100_003, batches: 32, seed: {seed}),
        )"#
    );
    let file = SceneFile::parse(&text).unwrap();
    resolve("test", file, ".".as_ref(), u64::MAX).unwrap()
}

/// Photons whose coordinates at all obstacles are multiples of 1/16. Some carry no light.
fn group(seed: u64, number: u64) -> PhotonGroup {
    let number = |i: usize, k: usize| dice(seed, number * 64 + i as u64, 33)[k];
    let column = |k: usize| lanes(|i| (f64::from(number(i, k)) - 16.0) / 16.0);
    let weights = lanes(|i| f64::from(number(i, 0) % 5));
    let mut group = PhotonGroup {
        rays: [column(0), column(1), column(2), column(3)],
        weights,
        fluxes: [0.0; PHOTONS_PER_GROUP],
    };
    group.fluxes = lanes(|i| weights[i] / radiance_per_flux(&group.ray(i)));
    group
}

/// A scene with a disc light, a floor, and layers of one rectangle each.
fn layered(layers: u32) -> Scene {
    let layer = |i: u32| {
        let distance = 1.0 + f64::from(i) / 16.0;
        format!(
            r#"Shapes(name: "{i}", center: (0, 0, {distance}), shapes: [
                Rectangle(center: (3, 0), size: (0.5, 0.5)),
            ]),"#
        )
    };
    let blockers: String = (0..layers).map(layer).collect();
    let text = format!(
        r#"(
            light: Disc(center: (0, 0, 0), radius: 0.5, radiance: 1.0),
            blockers: [{blockers}],
            surfaces: [Rectangle(name: "floor", center: (0, 0, 4), size: (2, 2), albedo: 0.3)],
            path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["floor"]),
            planes: [(name: "receiver", at: Before("floor"))],
            window: (x: Hann(1), u: Hann(0.5)),
            frequencies: (rho: (max: 4), nu: (max: 4)),
            run: (photons: 100_003, batches: 32, seed: 1),
        )"#
    );
    let file = SceneFile::parse(&text).unwrap();
    resolve("test", file, ".".as_ref(), u64::MAX).unwrap()
}

#[test]
fn scenes_that_are_not_flat_are_traced_one_by_one() {
    let flat = |layers| Tracer::new(&layered(layers)).flat.is_some();
    // The floor is an obstacle too.
    assert!(flat(15));
    assert!(!flat(16));
}

#[test]
fn photons_that_touch_edges_end_at_the_same_obstacles() {
    for seed in 0..20 {
        let tracer = Tracer::new(&scene(seed));
        let flat = tracer.flat.as_ref().unwrap();
        let none = (vec![Vec::new(); tracer.planes], Ledger::default());
        let [mut together, mut one_by_one] = [none.clone(), none];
        for group in (0..500).map(|number| group(seed, number)) {
            let mut hits = Vec::new();
            flat.hits_of_all(&[group], &mut hits, &mut OrderMemory::default());
            let hits = hits[0];
            let arrivals = flat.trace(&group, &hits, &mut together.0, &mut together.1);
            let arrivals: Vec<_> = arrivals.map(|(i, _)| i).collect();
            for i in (0..PHOTONS_PER_GROUP).filter(|i| group.weights[*i] > 0.0) {
                let (leg, ray) = (&tracer.legs[0], group.ray(i));
                let met = leg.courses.along.obstacles.closest_hit(&ray, 0.0);
                let arrives = met.is_some_and(|(_, target)| target.tag.is(leg.ends));
                assert_eq!(arrivals.contains(&i), arrives, "{ray:?} in scene {seed}");
                let (crossings, ledger) = &mut one_by_one;
                let mut photon = Photon::emitted(&group, i, 0);
                tracer.follow(0, &mut photon, || [0; 4], crossings, ledger);
            }
        }
        assert_eq!(
            format!("{together:?}"),
            format!("{one_by_one:?}"),
            "scene {seed}"
        );
    }
}

#[test]
fn emitted_photons_end_at_the_same_obstacles() {
    for seed in 0..20 {
        let mut scene = scene(seed);
        if seed % 4 > 1 {
            scene.run.sampling = Sampling::Random;
        }
        if seed % 5 == 1 {
            scene.light = layered(1).light;
        }
        let tracer = Tracer::new(&scene);
        assert!(tracer.flat.is_some(), "scene {seed}");
        let one_by_one = Tracer {
            flat: None,
            ..Tracer::new(&scene)
        };
        let [found, expected] = [tracer, one_by_one].map(|tracer| {
            let mut all = vec![Vec::new(); tracer.planes];
            let mut record =
                |plane: usize, crossings: &[Crossing]| all[plane].extend_from_slice(crossings);
            let ledgers: Vec<Ledger> = (0..3)
                .map(|batch| tracer.emit(batch, &mut record, &|_| ()))
                .collect();
            (all, ledgers)
        });
        let counts: Vec<usize> = found.0.iter().map(Vec::len).collect();
        assert!(counts.iter().all(|count| *count > 20), "{counts:?}");
        assert_eq!(
            format!("{found:?}"),
            format!("{expected:?}"),
            "scene {seed}"
        );
    }
}
