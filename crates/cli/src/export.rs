//! Implements `etendue export`: writes a scene for another program.

use crate::args::ExportArgs;
use crate::print::{say, say_replaced};
use etendue_pipeline::load;
use etendue_store::Failure;
use etendue_store::VERSION;
use etendue_store::sealed::json;
use etendue_store::{ArgumentStyle, EXPORT, Plan, Results};
use serde_json::json as tree_of;

/// Runs `etendue export`; returns the exit code.
pub(crate) fn export(args: &ExportArgs) -> Result<u8, Failure> {
    let scene = load::scene(&args.scene.source(), |_| ())?;
    // Only export to one program is supported so far, and clap has checked that the user names
    // this program.
    let export = etendue_export::mitsuba(&scene).map_err(Failure::bad_input)?;
    let folder = args.out.or_named(format!("{}-mitsuba", scene.name));
    let plan = Plan {
        index: EXPORT,
        files: export.files.iter().map(|(name, _)| name.clone()).collect(),
        inputs: load::inputs(&args.scene.source(), &scene),
        force: args.force.force,
        arguments: ArgumentStyle::Command,
    };
    let mut results = Results::claim(&folder, plan)?;
    for (name, bytes) in &export.files {
        results.write(name, bytes)?;
    }
    let finished = results.finish(|files| {
        json(&tree_of!({
            "scene": scene.name,
            "scene_hash": scene.hash(),
            "version": VERSION,
            "files": files,
        }))
    })?;
    say_replaced(&finished, false);
    say(&format!("{}: exported to {}", scene.name, folder.display()));
    Ok(0)
}
