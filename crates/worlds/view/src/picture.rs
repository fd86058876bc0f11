//! Renders the picture of a camera in a scene.

use crate::adaptive;
use crate::finite::require_finite;
use crate::picture_request::PictureRequest;
use crate::world_source;
use etendue_paths::Picture;
use etendue_pipeline::{Reporter, Work};
use etendue_store::Failure;
use etendue_store::VERSION;
use etendue_store::exr::{Part, exr};
use etendue_store::npz::Npz;
use etendue_store::sealed::json;
use etendue_store::{PICTURE, Plan, Results};
use ndarray::Array2;
use serde_json::{Value, json as tree_of};
use std::path::Path;

const FILES: [&str; 3] = ["picture.exr", "picture.npz", "picture.png"];

/// A finished picture.
#[derive(Debug)]
pub struct RenderedPicture {
    /// Number of pixels across and down.
    pub size: [usize; 2],
    /// Notes on omissions from the scene and on approximations.
    pub notes: Vec<String>,
    /// The number of samples and their time, in words; empty for a reference.
    pub effort: String,
}

/// Renders a picture into a folder.
#[expect(
    clippy::too_many_lines,
    reason = "the steps of one picture from file to result, in order"
)]
pub fn render(
    request: &PictureRequest,
    folder: &Path,
    reporter: &dyn Reporter,
) -> Result<RenderedPicture, Failure> {
    let imported = world_source::load(&request.source)?;
    let arguments = request.source.arguments;
    let camera = world_source::camera(&imported.world, &request.camera, arguments)?;
    world_source::require_light(&imported.world, arguments)?;
    let method = request.method;
    let of_adaptive = method.map(|_| adaptive::FILES).unwrap_or_default();
    let plan = Plan {
        index: PICTURE,
        files: FILES
            .iter()
            .chain(of_adaptive)
            .map(|name| (*name).to_owned())
            .collect(),
        inputs: vec![request.source.path.clone()],
        force: request.force,
        arguments,
    };
    let mut results = Results::claim(folder, plan)?;
    let mut made_from = tree_of!({
        "scene": request.source.path.file_name().map(|name| name.to_string_lossy()),
        "camera": camera.name,
        "camera_to_world": camera.to_world.to_cols_array(),
        "sky": request.source.sky,
        "depth": imported.world.depth,
        "hides_sources": imported.world.hides_sources,
        "size": camera.size,
        "seed": request.seed,
        "version": VERSION,
        "notes": world_source::notes(&imported),
    });
    let paths = world_source::paths(&imported.world)?;
    let effort = if let Some(method) = method {
        let seen = (&paths, &camera);
        adaptive::render(
            request,
            method,
            seen,
            (&mut results, &mut made_from),
            reporter,
        )?
    } else {
        made_from["samples"] = tree_of!(request.samples);
        let bar = reporter.begin(Work::Steps {
            verb: "rendering",
            total: camera.size[0] * camera.size[1],
            things: "pixels",
        });
        let picture = paths.picture(&camera, request.samples, request.seed, &|done| {
            bar.advance(done);
        });
        drop(bar);
        write(&mut results, &picture, &made_from)?;
        String::new()
    };
    let stage = reporter.begin(Work::Stage("writing results"));
    let finished = results.finish(|files| {
        let mut index = made_from.clone();
        index["files"] = tree_of!(files);
        json(&index)
    })?;
    drop(stage);
    if let Some(message) = finished.replaced_message() {
        reporter.note(&message);
    }
    Ok(RenderedPicture {
        size: camera.size,
        notes: world_source::notes(&imported),
        effort,
    })
}

/// Writes the radiance and its standard error to files for programs, and writes a picture for
/// people.
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
        #[expect(
            clippy::cast_possible_truncation,
            reason = "EXR viewers expect 32-bit numbers"
        )]
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
