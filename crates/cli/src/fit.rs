//! Implements `etendue fit`, which fits fields of a scene to a measurement.

use crate::args::FitArgs;
use crate::conclude::code_of;
use crate::finish::finish;
use crate::print::{deliver, deliver_json};
use crate::progress::Terminal;
use crate::threads::on_threads;
use etendue_pipeline::load;
use etendue_report::pictures::PictureFiles;
use etendue_store::stored::check_earlier;
use etendue_store::{ArgumentStyle, FIT, Failure, Plan, Results};
use etendue_studies::fit::{FitData, figure, index, plan, table};

/// Runs `etendue fit`; returns the exit code.
pub(crate) fn fit(args: &FitArgs) -> Result<u8, Failure> {
    let request = args.request();
    let quiet = args.work.quiet || args.json;
    let terminal = Terminal::new(quiet);
    if args.plan {
        let plan = on_threads(&args.work.threads, || {
            plan(&request, args.photons, &terminal)
        })?;
        match args.json {
            true => deliver_json(&serde_json::json!(plan).to_string())?,
            false => deliver(&plan.text())?,
        }
        return Ok(0);
    }
    let (scene, starts) = request.read()?;
    let data = FitData::read(&args.to, &scene)?.at(&request.planes, request.scene.arguments)?;
    let folder = args.out.or_named(format!("{}-fit", scene.name));
    let force = args.work.force.force;
    check_earlier(&folder, FIT, &scene, force, ArgumentStyle::Command)?;
    let mut inputs = load::inputs(&args.scene.source(), &scene);
    inputs.extend(data.inputs.iter().cloned());
    let mut results = Results::claim(
        &folder,
        Plan {
            index: FIT,
            files: figure::NAMES.map(str::to_owned).to_vec(),
            inputs,
            force,
            arguments: ArgumentStyle::Command,
        },
    )?;
    let fitted = on_threads(&args.work.threads, || {
        request.run(&scene, &starts, &data, &terminal)
    })?;
    if !quiet {
        deliver(&table::text(&scene.name, &fitted))?;
    }
    if let Some(figure) = figure::drawn(&scene.name, &fitted)? {
        PictureFiles::new("fit".to_owned(), figure)?.write(&mut results)?;
    }
    let index = index(&scene, &fitted);
    if args.json {
        deliver_json(&index.to_string())?;
    }
    finish(results, index, quiet)?;
    Ok(code_of(fitted.verdict))
}
