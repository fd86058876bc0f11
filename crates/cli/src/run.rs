use crate::args::{RunArgs, Save};
use crate::case::Case;
use crate::conclude::{Ending, conclude, plan};
use crate::failure::Failure;
use crate::measure::measured;
use crate::predict::predicted;
use crate::results::stored::check_earlier;
use crate::results::summary::Stopwatch;
use crate::results::{Results, SUMMARY};
use crate::threads::on_threads;
use crate::{field, limits, load, method, photons, say, target, warnings};
use etendue_compare::Applicability;
use etendue_scene::Scene;
use std::path::Path;

/// `etendue run`: returns the exit code.
pub(crate) fn run(args: &RunArgs) -> Result<u8, Failure> {
    let scene = load::scene(&args.scene, |run| args.photons.set(run))?;
    let theories = Applicability::of_planes(&scene);
    method::check(&scene, args.photons.method)?;
    let folder = args
        .out
        .clone()
        .unwrap_or_else(|| Path::new("out").join(&scene.name));
    let inputs = load::inputs(&args.scene, &scene);
    let plan = plan(&scene, &args.save, inputs, args.force.force);
    on_threads(&args.threads, || {
        warnings::tell(&scene, args.quiet);
        limits::check(&scene, &theories, rayon::current_num_threads())?;
        if args.save.contains(&Save::Field) {
            field::check_memory(&scene)?;
        }
        check_earlier(&folder, SUMMARY, &scene, args.force.force)?;
        let results = Results::claim(&folder, plan)?;
        stages(args, scene, theories, results)
    })
}

fn stages(
    args: &RunArgs,
    mut scene: Scene,
    theories: Vec<Applicability>,
    results: Results,
) -> Result<u8, Failure> {
    let mut watch = Stopwatch::start();
    if args.save.contains(&Save::Photons) && !args.quiet {
        say(&photons::announcement(&scene));
    }
    let method = args.photons.method;
    let measurement = match args.target_error {
        None => measured(&scene, method, 0..scene.run.batches, args.quiet)?,
        Some(target) => {
            let target = (target, args.photons.photons);
            target::reached(&mut scene, method, target, args.quiet)?
        }
    };
    watch.lap("trace");
    let predictions = predicted(&scene, &theories, method, args.quiet)?;
    watch.lap("predict");
    let case = Case {
        scene,
        theories,
        method,
        measurement,
        predictions,
    };
    let ending = Ending {
        save: &args.save,
        expect: args.expect,
        quiet: args.quiet,
    };
    conclude(&case, &ending, results, watch)
}
