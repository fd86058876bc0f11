//! Renders the picture of a camera in a scene.

use crate::layers::{require_finite, write_exr};
use crate::picture_request::PictureRequest;
use crate::{adaptive, world_source};
use etendue_paths::Picture;
use etendue_pipeline::{Reporter, Work};
use etendue_store::{Failure, PICTURE, Plan, Results};
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
    let mut made_from = world_source::made_from(&request.source, &imported, &camera, request.seed);
    made_from["camera_to_world"] = tree_of!(camera.to_world.to_cols_array());
    made_from["sky"] = tree_of!(request.source.sky);
    made_from["depth"] = tree_of!(imported.world.depth);
    made_from["hides_sources"] = tree_of!(imported.world.hides_sources);
    made_from["size"] = tree_of!(camera.size);
    let paths = world_source::paths(&imported.world)?;
    let effort = if let Some(method) = method {
        let (seen, written) = ((&paths, &camera), (&mut results, &mut made_from));
        adaptive::render(request, method, seen, written, reporter)?
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
    world_source::finish(results, made_from, Some(stage), reporter)?;
    Ok(RenderedPicture {
        size: camera.size,
        notes: world_source::notes(&imported),
        effort,
    })
}

/// Writes the radiance and its standard error to files for programs, and writes a picture for
/// people.
fn write(results: &mut Results, picture: &Picture, made_from: &Value) -> Result<(), Failure> {
    let errors = picture.variance.iter().map(|variance| variance.sqrt());
    let errors: Vec<f64> = errors.collect();
    require_finite(picture.size, &picture.mean)?;
    require_finite(picture.size, &errors)?;
    let layers = [("radiance", &picture.mean[..]), ("error", &errors)];
    let npz = write_exr(results, FILES[0], picture.size, layers, made_from)?;
    results.write(FILES[1], &npz.bytes()?)?;
    let png = etendue_figures::photograph(picture.size, &picture.mean);
    results.write(FILES[2], &png.map_err(Failure::cannot_run)?)
}
