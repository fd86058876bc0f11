//! Implements `etendue converge`, which computes how fast the first-order chain converges to the
//! exact prediction.

use crate::args::ConvergeArgs;
use crate::print::{deliver, say, tell};
use crate::progress;
use crate::threads::on_threads;
use etendue_pipeline::{limits, load};
use etendue_predict::{Applicability, Convergence, converge as shrink, seconds};
use etendue_report::table::aligned;
use etendue_scene::Scene;
use etendue_store::Failure;

/// The largest ratio of the command's time to the most time that predictions of the scene take, and
/// of the latter to the former: 2.5 over five scenes, rounded up.
const MARGIN: f64 = 3.0;

/// Runs `etendue converge`; returns the exit code.
pub(crate) fn converge(args: &ConvergeArgs) -> Result<u8, Failure> {
    let scene = load::scene(&args.scene.source(), |_| ())?;
    limits::check_one_light(&scene, "this command")?;
    let theories = Applicability::of_planes(&scene);
    limits::check_work(&scene, &theories)?;
    let planes = on_threads(&args.threads, || {
        let threads = rayon::current_num_threads();
        let about = seconds(&scene, &theories)[1] / threads as f64;
        tell(&format!(
            "expected on {}: {:.1} to {:.1} s",
            limits::counted(threads),
            about / MARGIN,
            about * MARGIN
        ));
        Ok(shrunk(&scene, &theories))
    })?;
    if planes.is_empty() {
        return Err(Failure::bad_input(
            "this command needs a plane behind a mirror, an interface, a lens or a scattering surface, and a Lambertian surface must be the only surface, without an environment; this scene has no such plane",
        ));
    }
    say(&format!(
        "{}: ‖first order − exact‖/‖exact‖, with all widths multiplied by e and all frequencies divided by e\n",
        scene.name
    ));
    deliver(&aligned(rows(&planes)).join("\n"))?;
    Ok(0)
}

fn shrunk(scene: &Scene, theories: &[Applicability]) -> Vec<Convergence> {
    let stage = progress::stage("predicting", false);
    let planes = scene.planes.iter().zip(theories);
    let found = planes.filter_map(|(plane, theory)| {
        stage.set_message(format!("predicting {}", plane.name));
        shrink(scene, plane, theory)
    });
    let found = found.collect();
    stage.finish_and_clear();
    found
}

fn rows(planes: &[Convergence]) -> Vec<Vec<String>> {
    let shares = planes[0].steps.iter();
    let shares = shares.map(|step| format!("e = {}", step.share));
    let mut header = vec!["plane".to_owned()];
    header.extend(shares);
    header.push("order".to_owned());
    let row = |plane: &Convergence| {
        let mut row = vec![plane.plane.clone()];
        row.extend(plane.steps.iter().map(|step| match step.error {
            _ if step.is_dark() => "dark".to_owned(),
            error => format!("{error:.2e}"),
        }));
        row.push(plane.order.map_or("–".to_owned(), |n| format!("{n:.2}")));
        row
    };
    std::iter::once(header)
        .chain(planes.iter().map(row))
        .collect()
}
