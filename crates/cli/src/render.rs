//! What a camera of a scene sees.

mod adaptive;

use crate::args::{RenderArgs, RenderMethod};
use crate::print::{say, say_replaced};
use crate::threads::on_threads;
use crate::{progress, world};
use etendue_paths::{Paths, Picture};
use etendue_store::Failure;
use etendue_store::exr::{Part, exr};
use etendue_store::npz::Npz;
use etendue_store::sealed::json;
use etendue_store::stored::VERSION;
use etendue_store::{PICTURE, Plan, Results};
use ndarray::Array2;
use serde_json::{Value, json as tree_of};
use std::path::Path;

const FILES: [&str; 3] = ["picture.exr", "picture.npz", "picture.png"];

/// `etendue render`: returns the exit code.
pub(crate) fn render(args: &RenderArgs) -> Result<u8, Failure> {
    let imported = world::load(&args.scene)?;
    let camera = world::camera(&imported.world, &args.camera)?;
    world::require_light(&imported.world)?;
    let name = args.scene.path.file_stem().unwrap_or_default();
    let folder = args
        .out
        .clone()
        .unwrap_or_else(|| Path::new("out").join(name));
    let method = method(args);
    let of_adaptive = method.map(|_| adaptive::FILES).unwrap_or_default();
    let plan = Plan {
        index: PICTURE,
        files: FILES
            .iter()
            .chain(of_adaptive)
            .map(|name| (*name).to_owned())
            .collect(),
        inputs: vec![args.scene.path.clone()],
        force: args.force.force,
    };
    let mut results = Results::claim(&folder, plan)?;
    let mut made_from = tree_of!({
        "scene": args.scene.path.file_name().map(|name| name.to_string_lossy()),
        "camera": camera.name,
        "camera_to_world": camera.to_world.to_cols_array(),
        "sky": args.scene.sky,
        "depth": imported.world.depth,
        "hides_sources": imported.world.hides_sources,
        "size": camera.size,
        "seed": args.seed,
        "version": VERSION,
        "notes": world::notes(&imported),
    });
    let said = on_threads(&args.threads, || {
        let paths = Paths::new(&imported.world);
        if let Some(method) = method {
            return adaptive::render(
                args,
                method,
                (&paths, &camera),
                &mut results,
                &mut made_from,
            );
        }
        made_from["samples"] = tree_of!(args.samples);
        let pixels = camera.size[0] * camera.size[1];
        let bar = progress::steps("rendering", pixels, "pixels", args.quiet);
        let picture = paths.picture(&camera, args.samples, args.seed, &|done| bar.inc(done));
        bar.finish_and_clear();
        write(&mut results, &picture, &made_from)?;
        Ok(String::new())
    })?;
    let finished = results.finish(|files| {
        let mut index = made_from.clone();
        index["files"] = tree_of!(files);
        json(&index)
    })?;
    say_replaced(&finished, args.quiet);
    if !args.quiet {
        world::notes(&imported)
            .iter()
            .for_each(|note| say(&format!("note: {note}")));
        say(&format!(
            "{} × {} pixels{said} in {}",
            camera.size[0],
            camera.size[1],
            folder.display()
        ));
    }
    Ok(0)
}

/// How few shading samples are spent; `None` for a reference.
fn method(args: &RenderArgs) -> Option<etendue_adaptive::Method> {
    use etendue_adaptive::Method;
    match (args.method, args.shading_samples) {
        (Some(RenderMethod::Reference), _) | (None, None) => None,
        (Some(RenderMethod::Predicted) | None, _) => Some(Method::Predicted),
        (Some(RenderMethod::Uniform), _) => Some(Method::Uniform),
        (Some(RenderMethod::Printed), _) => Some(Method::Printed),
        (Some(RenderMethod::Weighted), _) => Some(Method::Weighted),
        (Some(RenderMethod::Variance), _) => Some(Method::Variance),
    }
}

/// Refuses a picture with a pixel that is not finite, in 32 bits too: nothing is written then.
fn require_finite([w, _]: [usize; 2], radiance: &[f64]) -> Result<(), Failure> {
    #[expect(clippy::cast_possible_truncation, reason = "as EXR files hold it")]
    let is_lost = |value: &f64| !(*value as f32).is_finite();
    let Some(first) = radiance.iter().position(is_lost) else {
        return Ok(());
    };
    let count = radiance.iter().filter(|value| is_lost(value)).count();
    Err(Failure::bad_input(format!(
        "{count} pixels are not finite, the first at {},{}: numbers of the scene are too large or too small; nothing is written",
        first % w,
        first / w
    )))
}

/// Radiance and its standard error, for programs; and a picture to look at.
fn write(results: &mut Results, picture: &Picture, made_from: &Value) -> Result<(), Failure> {
    let [w, h] = picture.size;
    let errors: Vec<f64> = picture
        .variance
        .iter()
        .map(|variance| variance.sqrt())
        .collect();
    require_finite(picture.size, &picture.mean)?;
    require_finite(picture.size, &errors)?;
    let part = |name, values: &[f64]| {
        #[expect(clippy::cast_possible_truncation, reason = "EXR viewers want 32 bits")]
        let samples = values.iter().map(|x| *x as f32).collect();
        Part { name, samples }
    };
    let parts = vec![part("radiance", &picture.mean), part("error", &errors)];
    results.write(FILES[0], &exr([w, h], parts, made_from)?)?;
    let rows = |values: &[f64]| {
        Array2::from_shape_vec((h, w), values.to_vec()).map_err(Failure::cannot_run)
    };
    let mut npz = Npz::new();
    npz = npz
        .add("radiance", &rows(&picture.mean)?)?
        .add("error", &rows(&errors)?)?;
    results.write(FILES[1], &npz.bytes()?)?;
    let png = etendue_figures::photograph([w, h], &picture.mean).map_err(Failure::cannot_run)?;
    results.write(FILES[2], &png)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_that_are_not_finite_are_refused() {
        assert!(require_finite([2, 2], &[0.0, 1.0, 1e30, 1e-300]).is_ok());
        // The first is beyond what 32 bits hold.
        for lost in [1e39, f64::INFINITY, f64::NAN] {
            let refused = require_finite([2, 2], &[0.0, 1.0, 2.0, lost]).unwrap_err();
            assert_eq!(refused.code, 2);
            assert!(
                refused
                    .message
                    .starts_with("1 pixels are not finite, the first at 1,1")
            );
        }
    }
}
