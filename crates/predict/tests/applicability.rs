//! Theory applies to a plane only where light follows the paths that theory assumes.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use etendue_compare::Class;
use etendue_field::{Profile, ProjectionGrid};
use etendue_predict::{Applicability, Theory, predict, stopped};
use etendue_scene::{Scene, SceneFile, resolve};
use etendue_theory::path::PathSystem;
use etendue_theory::{Model, PathKind, RayBudget};

const LIGHT: &str = "Rectangle(center: (0, 0, 0), size: (0.2, 0.2))";
const PROJECTOR: &str = "Projector(center: (0, 0, 0), image: (width: (0.3, 0.3)))";

/// A scene with one plane, whose window has the given width in metres and slope.
fn scene(light: &str, blockers: &str, surfaces: &str, visits: &str, at: &str, half: f64) -> Scene {
    let text = format!(
        r#"(
            light: {light}, blockers: [{blockers}], surfaces: [{surfaces}],
            path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: [{visits}]),
            planes: [(name: "plane", at: {at})],
            window: (x: Hann({half}), u: Hann({half})),
            frequencies: (azimuths: 2, rho: (max: 8), nu: (max: 8)),
        )"#
    );
    let file = SceneFile::parse(&text).unwrap();
    resolve("scene", file, ".".as_ref(), u64::MAX).unwrap()
}

fn of(scene: &Scene) -> Applicability {
    Applicability::new(scene, &scene.planes[0])
}

/// A path with the same light that is blind to some occluder.
type Blind = fn(&mut PathSystem);

/// The share of the light in a window of a given width that an occluder stops: the share by
/// which the prediction grows if it is blind to this occluder.
fn stops(blind: Blind, scene: &Scene) -> f64 {
    let applies = of(scene);
    assert_eq!(applies.class(), Class::FirstOrder, "{:?}", applies.reasons);
    let (plane, view) = (&scene.planes[0], applies.theory.path().unwrap());
    let picture = ProjectionGrid::new(&plane.window, 1);
    let over = (&plane.window, &plane.grid, &picture);
    let mut open = view.clone();
    blind(&mut open.system);
    let budget = RayBudget::new(3e5, 1e-3);
    let [all, seen] = [&open, view].map(|view| view.predict(&[], over, budget).slices.at_zero());
    1.0 - seen / all
}

/// Asserts that an occluder stops no light in the narrow window, and light in the wide window.
fn stops_only(narrow: f64, wide: f64, blind: Blind, scene: impl Fn(f64) -> Scene) {
    let [narrow, wide] = [narrow, wide].map(|half| stops(blind, &scene(half)));
    // The same rays give both predictions, so they are equal except for rounding if none is stopped.
    assert!(narrow.abs() < 1e-12 && wide > 1e-4, "{narrow} {wide}");
}

fn forgets_shadows(system: &mut PathSystem) {
    for surface in &mut system.surfaces {
        surface.occludes = false;
    }
}

fn half_planes(shapes: &str) -> String {
    format!(r#"Shapes(name: "edge", center: (0, 0, 0.9), shapes: [{shapes}])"#)
}

const AT_45: &str = "facing: (0.7071067811865476, 0, -0.7071067811865476)";

/// Light passes a half-plane and is reflected sideways, and some of the reflected light crosses the
/// half-plane again.
#[test]
fn a_blocker_that_reaches_into_a_later_leg() {
    let edge = half_planes("HalfPlane(axis: X, edge: 0.5, opaque: Above)");
    for event in ["Mirror", "Reflects(brdf: (lobe: Phong(20), albedo: 0.5))"] {
        let surface = format!(
            r#"Smooth(name: "mirror", center: (0, 0, 1), {AT_45},
                form: Plane, aperture: 0.3, event: {event})"#
        );
        stops_only(
            0.04,
            0.3,
            |system| system.masks.clear(),
            |half| scene(LIGHT, &edge, &surface, r#""mirror""#, "Distance(1.8)", half),
        );
    }
}

/// Light that leaves the flank of a bowl meets its other side, unless the window is narrow.
#[test]
fn a_bowl_that_meets_its_own_light() {
    let bowl = r#"Smooth(name: "bowl", center: (-0.28, 0, 1), facing: (0, 0, -1),
                form: Sphere(-2), aperture: 0.45, event: Mirror)"#;
    for light in [LIGHT, PROJECTOR] {
        stops_only(0.01, 0.3, forgets_shadows, |half| {
            scene(light, "", bowl, r#""bowl""#, r#"After("bowl")"#, half)
        });
    }
}

/// The share of the light that a surface stops is stated with its name.
#[test]
fn what_stops_light_is_named() {
    let bowl = r#"Smooth(name: "bowl", center: (-0.28, 0, 1), facing: (0, 0, -1),
                form: Sphere(-2), aperture: 0.45, event: Mirror)"#;
    let named = |half: f64| {
        let scene = scene(LIGHT, "", bowl, r#""bowl""#, r#"After("bowl")"#, half);
        (
            stopped(&scene.planes[0], &of(&scene)),
            stops(forgets_shadows, &scene),
        )
    };
    assert_eq!(named(0.01).0, []);
    let (found, share) = named(0.3);
    assert_eq!(found[0].0, "bowl");
    assert!((found[0].1 - share).abs() < 0.02, "{found:?} {share}"); // errors of both sums
}

/// The rim of a tilted bowl shades its inside.
#[test]
fn a_bowl_that_shadows_itself() {
    let event = "Reflects(brdf: (lobe: Lambertian, albedo: 0.5))";
    let bowl = format!(
        r#"Smooth(name: "bowl", center: (0, 0, 1), {AT_45},
            form: Sphere(-2), aperture: 0.45, event: {event})"#
    );
    stops_only(0.02, 0.3, forgets_shadows, |half| {
        scene(LIGHT, "", &bowl, r#""bowl""#, r#"After("bowl")"#, half)
    });
}

/// The mesh at the end of the path also stands before the glossy surface and stops light of the sky.
#[test]
fn a_mesh_that_ends_the_path_and_stops_light_before() {
    let sky = "Environment(center: (0, 0, 0), map: Lobes([(from: (0.45, 0, -1), width: 0.5)]))";
    let surfaces = r#"
        Smooth(name: "gloss", center: (0, 0, 1.3), facing: (0, 0, -1), form: Plane,
            aperture: 0.3, event: Reflects(brdf: (lobe: Beckmann(0.4), albedo: 1))),
        Mesh(name: "end", center: (0.5, 0, 0.3),
            mesh: Paraboloid(curvatures: (0.2, 0.2), half: 0.25, cells: 4), albedo: 0.5)"#;
    let visits = r#""gloss", "end""#;
    let scene = scene(sky, "", surfaces, visits, r#"Before("end")"#, 0.1);
    let applies = of(&scene);
    let steps = applies.steps(&scene, &scene.planes[0]);
    let step = "multiply  by the visibility of end on the legs before it";
    assert!(steps.iter().any(|found| found == step), "{steps:#?}");
    let predicted = |applies: &Applicability| {
        let prediction = predict(&scene, &scene.planes[0], applies);
        prediction.slices.at_zero()
    };
    let mut open = applies.clone();
    let Theory::Path(view) = &mut open.theory else {
        panic!("{:?}", applies.theory)
    };
    view.system.obstacles.clear();
    let [open, stopped] = [&open, &applies].map(predicted);
    assert!(stopped < 0.98 * open, "{stopped} {open}"); // errors of nets are below 1 %
}

/// The second of two mirrors stands beside the first leg.
#[test]
fn a_mirror_that_is_met_out_of_turn() {
    let mirrors = format!(
        r#"Smooth(name: "first", center: (0, 0, 1), {AT_45},
                form: Plane, aperture: 0.4, event: Mirror),
           Smooth(name: "second", center: (0.5, 0, 1),
                facing: (-0.7071067811865476, 0, 0.7071067811865476),
                form: Plane, aperture: 0.55, event: Mirror)"#
    );
    stops_only(0.02, 0.3, forgets_shadows, |half| {
        scene(
            LIGHT,
            "",
            &mirrors,
            r#""first", "second""#,
            r#"After("second")"#,
            half,
        )
    });
}

/// A flat mesh reflects light on its way back, and if it is large, it also stops light on the first
/// leg.
#[test]
fn a_mesh_that_shades_an_earlier_leg() {
    let class = |half: f64| {
        let surfaces = format!(
            r#"Smooth(name: "mirror", center: (0, 0, 1), facing: (0.38268343236509, 0, -0.923879532511287),
                    form: Plane, aperture: 0.4, event: Mirror),
               Mesh(name: "sheet", center: (0.5, 0, 0.5), event: Mirror,
                    mesh: Paraboloid(curvatures: (0, 0), half: {half}, cells: 4))"#
        );
        let visits = r#""mirror", "sheet""#;
        of(&scene(
            LIGHT,
            "",
            &surfaces,
            visits,
            r#"After("sheet")"#,
            0.1,
        ))
        .class()
    };
    assert_eq!(class(0.3), Class::FirstOrder);
    assert_eq!(class(0.48), Class::Reference);
}

/// Rays are tested against a surface that the path does not visit.
#[test]
fn a_surface_that_the_path_does_not_visit() {
    let surfaces = format!(
        r#"Smooth(name: "mirror", center: (0, 0, 1), {AT_45},
                form: Plane, aperture: 0.3, event: Mirror),
           Rectangle(name: "beside", center: (3, 0, 0.5), size: (1, 1))"#
    );
    let at = r#"After("mirror")"#;
    let found = of(&scene(LIGHT, "", &surfaces, r#""mirror""#, at, 0.1));
    assert_eq!(found.reasons, [""; 0]);
    let obstacles = &found.theory.path().unwrap().system.obstacles;
    let names: Vec<&str> = obstacles.iter().map(|o| o.name.as_str()).collect();
    assert_eq!(names, ["beside"]);
}

/// A wall that leans away from the first leg is not in the way, although its bounding box reaches
/// into the light. A wall that leans over the leg is in the way, so that the theory of the path
/// replaces the theory of parallel planes.
#[test]
fn a_wall_that_leans_away() {
    for (facing, class) in [
        ("(-1, 0, -1)", Class::Exact),
        ("(-1, 0, 1)", Class::FirstOrder),
    ] {
        let surfaces = format!(
            r#"Smooth(name: "mirror", center: (0, 0, 1), {AT_45},
                    form: Plane, aperture: 0.3, event: Mirror),
               Rectangle(name: "wall", center: (1.05, 0, 1), size: (3.2, 3.2), facing: {facing})"#
        );
        let visits = r#""mirror", "wall""#;
        let found = of(&scene(LIGHT, "", &surfaces, visits, "Distance(0.5)", 0.3));
        assert_eq!(found.class(), class, "{facing}");
    }
}

/// If no path leads to a plane, the plane is dark for every light and surface, and its class does
/// not change.
#[test]
fn darkness_has_a_reason() {
    let one = half_planes("HalfPlane(axis: X, edge: 0.01, opaque: Below)");
    let other = r#"Shapes(name: "other", center: (0, 0, 0.8), shapes: [
        HalfPlane(axis: X, edge: -0.01, opaque: Above)])"#;
    let both = format!("{one}, {other}");
    let lid = r#"Shapes(name: "lid", center: (0, 0, 0.5), shapes: [
        Rectangle(center: (-0.5, 0), size: (1, 2)),
        Rectangle(center: (0.5, 0), size: (1, 2))])"#;
    let holed = r#"Shapes(name: "lid", center: (0, 0, 0.5), shapes: [
        Rectangle(center: (-0.5, 0), size: (0.99, 2)),
        Rectangle(center: (0.5, 0), size: (1, 2))])"#;
    let floor = r#"Rectangle(name: "floor", center: (0, 0, 1), size: (4, 4))"#;
    let smooth = |event: &str| {
        format!(
            r#"Smooth(name: "floor", center: (0, 0, 1), facing: (0, 0, -1),
                form: Sphere(1), aperture: 0.3, event: {event})"#
        )
    };
    let surfaces = [
        (floor.to_owned(), Class::Exact),
        (smooth("Mirror"), Class::FirstOrder),
        (
            smooth("Reflects(brdf: (lobe: Lambertian, albedo: 0.5))"),
            Class::FirstOrder,
        ),
    ];
    let closed = [
        (
            both.as_str(),
            "other and edge together block all paths of light",
        ),
        (lid, "lid blocks all paths of light"),
    ];
    for (surface, class) in &surfaces {
        for light in [LIGHT, PROJECTOR] {
            if light == PROJECTOR && *class == Class::Exact {
                continue;
            }
            let at = r#"After("floor")"#;
            let built = |blockers: &str| scene(light, blockers, surface, r#""floor""#, at, 0.1);
            for (blockers, reason) in closed {
                let scene = built(blockers);
                let found = of(&scene);
                // A receiver has no edge, so light may pass beside a blocker of any size.
                if *class == Class::Exact && blockers == lid {
                    assert_eq!(found.dark, None);
                    continue;
                }
                assert_eq!(found.class(), *class);
                assert_eq!(found.dark.as_deref(), Some(reason), "{surface} {light}");
                let prediction = predict(&scene, &scene.planes[0], &found);
                assert_eq!(prediction.class, *class);
                assert!(prediction.steps.contains(&format!("dark  {reason}")));
                assert!(prediction.slices.half.iter().all(|f| f.norm_sqr() <= 0.0));
            }
            for blockers in [one.as_str(), holed] {
                assert_eq!(of(&built(blockers)).dark, None, "{surface} {light}");
            }
        }
    }
}

/// A surface whose albedos are all 0 sends no light on, whatever its kind.
#[test]
fn surfaces_that_reflect_no_light_leave_darkness() {
    let smooth = |event: &str| {
        format!(
            r#"Smooth(name: "floor", center: (0, 0, 1), {AT_45}, form: Plane, aperture: 0.4, event: {event})"#
        )
    };
    let sum = |albedo: f64| {
        smooth(&format!(
            "Sum(terms: [(brdf: (lobe: Phong(20), albedo: 0)), (brdf: (lobe: Lambertian, albedo: {albedo}))])"
        ))
    };
    let rectangle = r#"Rectangle(name: "floor", center: (0, 0, 1), size: (4, 4), albedo: 0)"#;
    for (surface, is_dark) in [
        (rectangle, true),
        (
            &smooth("Reflects(brdf: (lobe: Lambertian, albedo: 0))"),
            true,
        ),
        (&sum(0.0), true),
        (&sum(0.1), false),
        (&smooth("Mirror"), false),
    ] {
        for (at, is_after) in [(r#"After("floor")"#, true), (r#"Before("floor")"#, false)] {
            let found = of(&scene(LIGHT, "", surface, r#""floor""#, at, 0.1));
            let reason = (is_dark && is_after).then_some("floor reflects no light");
            assert_eq!(found.dark.as_deref(), reason, "{surface} {at}");
        }
    }
}

/// A light that is kilometres wide shines past a half-plane that would cover its middle.
#[test]
fn a_huge_light_is_not_taken_for_dark() {
    let light = "Rectangle(center: (0, 0, 0), size: (5_000, 5_000))";
    let edge = half_planes("HalfPlane(axis: X, edge: 1_500, opaque: Below)");
    let floor = r#"Rectangle(name: "floor", center: (0, 0, 1), size: (10_000, 10_000))"#;
    for half in [1_000.0, 2_000.0] {
        let at = r#"Before("floor")"#;
        let mut scene = scene(light, &edge, floor, r#""floor""#, at, half);
        scene.planes[0].window.u = Profile::Hann(0.3);
        let found = of(&scene);
        assert!(found.reasons.is_empty(), "{:?}", found.reasons);
        assert_eq!(found.dark.is_some(), half < 1_500.0, "{half}");
    }
}

/// A tilted mirror extends in front of the half-planes, where light does not meet them, so the
/// plane is not dark.
#[test]
fn light_that_turns_before_the_masks_is_not_taken_for_dark() {
    let one = half_planes("HalfPlane(axis: X, edge: 0, opaque: Below)");
    let other = r#"HalfPlane(axis: X, edge: 0, opaque: Above)"#;
    let both = one.replace("])", &format!(", {other}])"));
    let mirror = |aperture: f64| {
        format!(
            r#"Smooth(name: "mirror", center: (0, 0, 1), {AT_45},
                form: Plane, aperture: {aperture}, event: Mirror)"#
        )
    };
    let built = |aperture: f64| {
        scene(
            LIGHT,
            &both,
            &mirror(aperture),
            r#""mirror""#,
            r#"After("mirror")"#,
            0.4,
        )
    };
    let small = of(&built(0.1));
    let dark = "edge blocks all paths of light";
    assert_eq!(small.dark.as_deref(), Some(dark), "{:?}", small.reasons);
    let found = of(&built(0.5));
    assert_eq!((found.class(), found.dark), (Class::FirstOrder, None));
}

/// The curvature of a flat mesh is the same for all triangles, so the only error is rounding.
#[test]
fn a_smooth_mesh_is_flat_or_finely_curved() {
    let of = |curvature: f64, cells: u32| {
        let text = format!(
            r#"(
                light: {LIGHT},
                surfaces: [Mesh(name: "sheet", center: (0.1, 0.05, 1), event: Mirror,
                    mesh: Paraboloid(curvatures: ({curvature}, 0), half: 0.5, cells: {cells}))],
                path: (direction: (0.1, 0.05, 1), x_axis: (1, 0, 0), visits: ["sheet"]),
                planes: [(name: "p", at: After("sheet"))],
                window: (x: Hann(0.1), u: Hann(0.1)), frequencies: (rho: (max: 8), nu: (max: 8)),
            )"#
        );
        let file = SceneFile::parse(&text).unwrap();
        of(&resolve("scene", file, ".".as_ref(), u64::MAX).unwrap()).class()
    };
    assert_eq!(of(0.0, 30), Class::FirstOrder);
    assert_eq!(of(0.001, 30), Class::FirstOrder);
    assert_eq!(of(3.0, 300), Class::FirstOrder);
    assert_eq!(of(3.0, 10), Class::Reference);
}

/// An object directly at a plane is in the way only if the plane is after the object. If the light
/// projects a picture, an object before a flat surface is in the way.
#[test]
fn what_stands_at_a_plane_or_before_a_flat_surface() {
    let sheet = r#"Mesh(name: "sheet", center: (0, 0, 0.5), mesh: Paraboloid(curvatures: (0, 0), half: 0.1, cells: 1))"#;
    let floor = r#"Rectangle(name: "floor", center: (0, 0, 1), size: (4, 4))"#;
    let mean = |at: &str| {
        let scene = scene(LIGHT, sheet, floor, r#""floor""#, at, 0.2);
        let found = of(&scene);
        assert_eq!(found.reasons, [""; 0]);
        predict(&scene, &scene.planes[0], &found).slices.at_zero()
    };
    let [before, after] = [r#"Before("sheet")"#, r#"After("sheet")"#].map(mean);
    // The sheet covers the middle of the window, where most of the light is.
    assert!(after < 0.9 * before, "{before} {after}");

    let leaning = r#"Rectangle(name: "floor", center: (0, 0, 1), size: (4, 4), facing: (-0.6, 0, -0.8)),
        Smooth(name: "card", center: (-0.5, 0, 0.2), facing: (-1, 0, 1.5), form: Plane, aperture: 0.55, event: Mirror)"#;
    let visits = r#""floor", "card""#;
    let scene = scene(PROJECTOR, "", leaning, visits, "Distance(0.8)", 0.2);
    assert!(stops(forgets_shadows, &scene) > 1e-3);
}

/// A card shades a small mirror, but light still passes beside the mirror. A plane before the
/// mirror sees this light.
#[test]
fn what_passes_beside_a_shaded_surface_is_not_dark() {
    let card = r#"Shapes(name: "card", center: (0, 0, 0.5), shapes: [Rectangle(center: (0, 0), size: (0.4, 0.4))])"#;
    let mirror = r#"Smooth(name: "mirror", center: (0, 0, 1), facing: (0, 0, -1), form: Plane, aperture: 0.05, event: Mirror)"#;
    let dark = |at: &str| of(&scene(LIGHT, card, mirror, r#""mirror""#, at, 0.4)).dark;
    assert!(dark(r#"After("mirror")"#).is_some());
    assert_eq!(dark("Distance(0.8)"), None);
}

/// Light passes an aperture only through its hole. An aperture beside the light stops everything,
/// and an aperture on the way back is in the way.
#[test]
fn light_passes_an_aperture_through_its_hole() {
    let floor = r#"Rectangle(name: "floor", center: (0, 0, 1), size: (10, 10))"#;
    let hole = |x: f64| {
        format!(
            r#"Aperture(name: "iris", center: ({x}, 0, 0.5), hole: Polygon(corners: [(0.1, 0), (-0.1, 0.1), (-0.1, -0.1)]))"#
        )
    };
    let built = |x: f64, at: &str| of(&scene(LIGHT, &hole(x), floor, r#""floor""#, at, 0.1));
    let dark = "iris blocks all paths of light";
    let before = r#"Before("floor")"#;
    assert_eq!(built(0.0, before).dark, None);
    assert_eq!(built(50.0, before).dark.as_deref(), Some(dark));
    let back = built(0.0, "Distance(1.3)");
    assert!(
        matches!(back.theory, Theory::Parallel(_)),
        "{:?}",
        back.declined
    );
    let behind = built(0.0, "Distance(1.7)");
    assert!(
        behind.theory.path_of(PathKind::Several).is_some(),
        "{:?}",
        behind.reasons
    );
    assert!(behind.declined[0].contains("visibility of iris"));
}

/// No theory describes light that leaves a mesh. If a smooth surface stands in the light, theory
/// traces rays past it.
#[test]
fn what_has_no_theory_is_a_reference() {
    let class = |surfaces: &str, visits: &str| {
        let text = format!(
            r#"(
                light: Rectangle(center: (0, 0, 0), size: (0.2, 0.2)),
                surfaces: [{surfaces}],
                path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: [{visits}]),
                planes: [(name: "before", at: Distance(0.9)), (name: "after", at: After({visits}))],
                window: (x: Hann(0.1), u: Hann(0.1)), frequencies: (rho: (max: 10), nu: (max: 10)),
                run: (photons: 100),
            )"#
        );
        let file = SceneFile::parse(&text).unwrap();
        let scene = resolve("t", file, ".".as_ref(), u64::MAX).unwrap();
        [0, 1].map(|i| Applicability::new(&scene, &scene.planes[i]).class())
    };
    let floor = r#"Rectangle(name: "floor", center: (0, 0, 2), size: (4, 4))"#;
    let star = r#"Mesh(name: "star", center: (0, 0, 2),
        mesh: Star(radius: 0.5, relief: 0, lobes: 0, rings: 40))"#;
    let beside = |x: f64| {
        format!(
            r#"Smooth(name: "m", center: ({x}, 0, 0.5), facing: (1, 0, 0),
            form: Sphere(0.1), aperture: 0.1, event: Mirror), {floor}"#
        )
    };
    let reference = Class::Reference;
    assert_eq!(class(floor, "\"floor\""), [Class::Exact; 2]);
    assert_eq!(class(star, "\"star\""), [Class::Exact, reference]);
    assert_eq!(class(&beside(0.08), "\"floor\""), [Class::FirstOrder; 2]);
    assert_eq!(class(&beside(2.0), "\"floor\""), [Class::Exact; 2]);
}
