use crate::args::{RunArgs, Save};
use crate::conclude::{Case, Ending, conclude};
use crate::failure::Failure;
use crate::measure::measured;
use crate::predict::predicted;
use crate::results::{Results, SUMMARY};
use crate::summary::Stopwatch;
use crate::threads::{self, on_threads};
use crate::{field, limits, load, method, photons, say};
use etendue_scene::Scene;
use std::path::Path;

/// `etendue run`: returns the exit code.
pub(crate) fn run(args: &RunArgs) -> Result<u8, Failure> {
    let scene = load::scene(&args.scene, |run| args.photons.set(run))?;
    method::check(&scene, args.photons.method)?;
    limits::check(&scene, threads::count(args.threads.count))?;
    let folder = args
        .out
        .clone()
        .unwrap_or_else(|| Path::new("out").join(&scene.name));
    let results = Results::create(&folder, SUMMARY)?;
    on_threads(&args.threads, || stages(args, scene, results))
}

fn stages(args: &RunArgs, scene: Scene, results: Results) -> Result<u8, Failure> {
    let mut watch = Stopwatch::start();
    if args.save.contains(&Save::Field) {
        field::check_memory(&scene)?;
    }
    if args.save.contains(&Save::Photons) && !args.quiet {
        say(&photons::announcement(&scene));
    }
    let method = args.photons.method;
    let measurement = measured(&scene, method, 0..scene.run.batches, args.quiet)?;
    watch.lap("trace");
    let predictions = predicted(&scene, method, args.quiet)?;
    watch.lap("predict");
    let case = Case {
        scene,
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
