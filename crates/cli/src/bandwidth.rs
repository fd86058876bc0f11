use crate::args::{BandwidthArgs, SceneArgs, Sweep};
use crate::failure::Failure;
use crate::measure::measured;
use crate::table::aligned;
use crate::threads::on_threads;
use crate::{load, method, progress, say};
use etendue_compare::{criterion, exact_bandwidth, measured_bandwidth};
use etendue_scene::Scene;
use etendue_theory::shading::Criterion;

/// `etendue bandwidth`: returns the exit code.
pub(crate) fn bandwidth(args: &BandwidthArgs) -> Result<u8, Failure> {
    let points = points(&args.sweep)?;
    let scenes: Result<Vec<Scene>, Failure> = points
        .iter()
        .map(|point| {
            let mut set = args.scene.set.clone();
            set.extend(
                point
                    .iter()
                    .map(|(path, value)| (path.clone(), format!("{value:?}"))),
            );
            let scene = SceneArgs {
                path: args.scene.path.clone(),
                set,
            };
            load::scene(&scene, |run| args.photons.set(run))
        })
        .collect();
    let scenes = scenes?;
    if args.measure {
        for scene in &scenes {
            method::check(scene, args.photons.method)?;
        }
    }
    let rows = on_threads(&args.threads, || {
        let each = scenes.iter().zip(&points);
        let rows: Result<Vec<_>, Failure> =
            each.map(|(scene, point)| of(args, scene, point)).collect();
        rows.map(|rows| rows.concat())
    })?;
    if rows.is_empty() {
        return Err(Failure::bad_input(
            "no plane of this scene looks, across its ray, at light that has left a smooth surface with a BRDF",
        ));
    }
    let mut header: Vec<String> = args.sweep.iter().map(|sweep| sweep.path.clone()).collect();
    let numbers = [
        "plane",
        "k",
        "theta0",
        "theta1",
        "d",
        "d'",
        "lobe",
        "environment",
        "edge",
        "printed 20",
        "printed 21",
    ];
    header.extend(numbers.map(str::to_owned));
    if args.measure {
        header.extend(["exact", "measured", "error"].map(str::to_owned));
    }
    let table: Vec<Vec<String>> = std::iter::once(header).chain(rows).collect();
    say(
        "Bandwidths hold 95 % of the energy, in cycles per unit slope at a fixed point of the plane; lengths in metres, angles in degrees.",
    );
    say(
        "environment, edge: Durand et al. 2005, Eqs. 20 and 21, corrected; as printed beside them.\n",
    );
    say(&aligned(table).join("\n"));
    Ok(0)
}

/// The values of all sweeps, which go in step.
fn points(sweeps: &[Sweep]) -> Result<Vec<Vec<(String, f64)>>, Failure> {
    let count = sweeps.first().map_or(1, |sweep| sweep.count);
    if sweeps.iter().any(|sweep| sweep.count != count) {
        let message = "--sweep: several sweeps go in step and have the same number of values";
        return Err(Failure::bad_input(message));
    }
    let value = |sweep: &Sweep, i: u32| {
        let share = if count > 1 {
            f64::from(i) / f64::from(count - 1)
        } else {
            0.0
        };
        (
            sweep.path.clone(),
            sweep.from + share * (sweep.to - sweep.from),
        )
    };
    Ok((0..count)
        .map(|i| sweeps.iter().map(|sweep| value(sweep, i)).collect())
        .collect())
}

/// A row for each plane with a criterion.
fn of(
    args: &BandwidthArgs,
    scene: &Scene,
    point: &[(String, f64)],
) -> Result<Vec<Vec<String>>, Failure> {
    let all = scene.planes.iter().enumerate();
    let planes: Vec<(usize, Criterion)> = all
        .filter_map(|(i, plane)| Some((i, criterion(scene, plane)?)))
        .collect();
    let measurement = if args.measure && !planes.is_empty() {
        let batches = 0..scene.run.batches;
        Some(measured(scene, args.photons.method, batches, args.quiet)?)
    } else {
        None
    };
    let mut rows = Vec::new();
    for (i, c) in planes {
        let mut row: Vec<String> = point.iter().map(|(_, value)| number(*value)).collect();
        row.push(scene.planes[i].name.clone());
        let numbers = [
            c.curvature,
            c.incidence.to_degrees(),
            c.outgoing.to_degrees(),
            c.distance,
        ];
        row.extend(numbers.map(number));
        row.push(c.blocker_distance.map_or("–".to_owned(), number));
        let edge = |value: f64| c.blocker_distance.map_or("–".to_owned(), |_| number(value));
        row.extend([
            number(c.lobe_cutoff),
            number(c.environment()),
            edge(c.blocker()),
        ]);
        row.extend([number(c.printed_environment()), edge(c.printed_blocker())]);
        if let Some(measurement) = &measurement {
            let stage = progress::stage("predicting", args.quiet);
            let exact = exact_bandwidth(scene, &scene.planes[i]);
            stage.finish_and_clear();
            let found = measured_bandwidth(measurement, i).map_err(Failure::cannot_run)?;
            row.push(exact.map_or("–".to_owned(), number));
            row.push(found.map_or("–".to_owned(), |f| number(f.value)));
            row.push(found.map_or("–".to_owned(), |f| format!("{:.1e}", f.error)));
        }
        rows.push(row);
    }
    Ok(rows)
}

fn number(x: f64) -> String {
    format!("{x:.3}")
}
