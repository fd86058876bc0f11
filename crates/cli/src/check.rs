//! Implements `etendue check`: describes a scene, and the theory that applies to each plane.

use crate::args::CheckArgs;
use crate::print::{deliver, deliver_json, say};
use crate::warnings;
use etendue_compare::Class;
use etendue_field::{Orientation, VirtualPlane, percent, tidy};
use etendue_pipeline::{limits, load, method};
use etendue_predict::{Applicability, Memory, seconds, stopped};
use etendue_report::pictures;
use etendue_scene::Scene;
use etendue_store::Failure;
use etendue_store::Method;
use etendue_store::file_seal::SealKind;
use etendue_store::output::OutputFile;
use etendue_theory::path::rays::AffineChain;
use serde_json::{Value, json};
use std::num::NonZero;
use std::thread::available_parallelism;

/// Runs `etendue check`; returns the exit code.
pub(crate) fn check(args: &CheckArgs) -> Result<u8, Failure> {
    let scene = load::scene(&args.scene.source(), |_| ())?;
    let inputs = load::inputs(&args.scene.source(), &scene);
    let picture = args.draw.as_ref().map(|path| {
        let bytes = pictures::drawn_scene(&scene, path)?;
        let kind = SealKind::of(path).unwrap_or(SealKind::Png);
        let file = OutputFile::claim_sealed(path, args.force.force, &inputs, kind)?;
        Ok((path, bytes, file))
    });
    let picture = picture.transpose()?;
    let theories = Applicability::of_planes(&scene);
    // The number of threads that `etendue run` uses by default.
    let threads = available_parallelism().map_or(1, NonZero::get);
    if args.json {
        if let Some((_, bytes, file)) = picture {
            file.write(&bytes)?;
        }
        limits::check(&scene, &theories, threads)?;
        deliver_json(&format!("{:#}", json(&scene, &theories, threads)))?;
        return Ok(0);
    }
    deliver(&description(&scene, &theories))?;
    if let Some((path, bytes, file)) = picture {
        file.write(&bytes)?;
        say(&format!("\ndrawn in {}", path.display()));
    }
    warnings::tell(&scene, false);
    limits::check(&scene, &theories, threads)?;
    say(&expected(&scene, &theories, threads));
    Ok(0)
}

/// What `check` finds out about a scene, for programs.
fn json(scene: &Scene, theories: &[Applicability], threads: usize) -> Value {
    let planes = scene.planes.iter().zip(theories);
    let planes = planes.map(|(plane, theory)| {
        json!({
            "name": plane.name,
            "distance": plane.distance,
            "class": theory.class(),
            "chain": theory.steps(scene, plane),
        })
    });
    let ([photons, predictions, comparisons], bytes) = effort(scene, theories, threads);
    json!({
        "scene": scene.name,
        "scene_hash": scene.hash(),
        "photons": scene.run.photons,
        "planes": planes.collect::<Vec<_>>(),
        "warnings": scene.warnings(),
        "expected": {
            "threads": threads,
            "seconds_of_photons": photons,
            "most_seconds_of_predictions": predictions,
            "seconds_of_comparisons": comparisons,
            "most_bytes": bytes,
        },
    })
}

/// The seconds of photons, predictions and comparisons as [`seconds`] does, for several
/// threads, and the most bytes that a run of the scene takes.
fn effort(scene: &Scene, theories: &[Applicability], threads: usize) -> ([f64; 3], f64) {
    let seconds = seconds(scene, theories).map(|seconds| seconds / threads as f64);
    (seconds, Memory::new(scene, theories, threads).total())
}

/// The approximate time and memory that a run of the scene takes.
fn expected(scene: &Scene, theories: &[Applicability], threads: usize) -> String {
    let ([photons, predictions, comparisons], bytes) = effort(scene, theories, threads);
    let gigabytes = bytes / 1e9;
    format!(
        "\nexpected on {}: about {photons:.1} s for photons, at most {predictions:.1} s for predictions, about {comparisons:.1} s for comparisons and pictures, at most {gigabytes:.2} GB",
        limits::counted(threads)
    )
}

/// The length of each leg of the path, and the surface at its end.
fn length(scene: &Scene) -> String {
    let legs = scene.path.legs.iter().enumerate();
    let ends = legs.filter_map(|(i, leg)| {
        let name = scene.name_of(scene.path.ends_at(i)?.object);
        Some(format!("{} m to {name}", tidy(leg.length)))
    });
    ends.collect::<Vec<_>>().join(", ")
}

/// Describes the map z' = A z of the rays, and the distances at which it focuses parallel rays.
fn rays(chain: &AffineChain) -> Vec<String> {
    let matrix = chain.map.rays().matrix;
    let row = |(name, row): (&str, &[f64; 4])| {
        let entries = row
            .iter()
            .map(|entry| format!("{:>10}", tidy((entry * 1e6).round() / 1e6)));
        let entries: Vec<String> = entries.collect();
        format!("  rays  {name} = [{}] (x, y, u, v)", entries.join(" "))
    };
    let names = ["x'", "y'", "u'", "v'"];
    let mut lines: Vec<String> = names.into_iter().zip(&matrix).map(row).collect();
    if !chain.foci.is_empty() {
        let foci = chain.foci.iter().map(|f| format!("{f:.6}"));
        let foci: Vec<String> = foci.collect();
        lines.push(format!(
            "  foci  of parallel light, {} m from the last surface",
            foci.join(" and ")
        ));
    }
    lines
}

fn description(scene: &Scene, theories: &[Applicability]) -> String {
    let run = &scene.run;
    let mut lines = vec![
        format!("{}: sound", scene.name),
        format!(
            "central ray: {}, photons: {} in {} batches, {:?} emission, α = {}",
            length(scene),
            run.photons,
            run.batches,
            run.emission,
            run.alpha
        ),
    ];
    for (plane, applicability) in scene.planes.iter().zip(theories) {
        let [k, rho, nu] = plane.grid.full_shape();
        lines.push(format!(
            "\n{}: {} m along the central ray, prediction: {}",
            plane.name,
            tidy(plane.distance),
            applicability.class()
        ));
        lines.extend(
            applicability
                .steps(scene, plane)
                .iter()
                .map(|step| format!("  {step}")),
        );
        if applicability.class() == Class::Reference {
            lines.push(format!(
                "  {}",
                method::step(method::judge_of(Method::Photons, scene, plane))
            ));
        }
        lines.extend(of_lights(scene, plane, applicability));
        lines.push(format!(
            "  measured at {k} azimuths x {rho} x {nu} frequencies, up to {} cycles/m and {} cycles per {}",
            tidy(plane.grid.rho.max()),
            tidy(plane.grid.nu.max()),
            if plane.orientation == Orientation::Orthogonal { "unit slope" } else { "radian" }
        ));
    }
    lines.join("\n")
}

/// Describes what the theory of each light assumes and what stops its light, and its rays.
fn of_lights(scene: &Scene, plane: &VirtualPlane, applicability: &Applicability) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for (of, seen, theory, number) in applicability.of_lights(scene, plane) {
        for assumption in theory.theory.assumptions() {
            let line = format!("  assumes  {assumption}");
            // Lights with the same theory make the same assumptions.
            if !lines.contains(&line) {
                lines.push(line);
            }
        }
        for (name, share) in stopped(seen, theory) {
            let percent = percent(share, 1);
            lines.push(format!(
                "  stopped  {percent} of the light in the window, by {name}"
            ));
        }
        if let Some(chain) = theory.affine_chain(of) {
            if !scene.other_lights.is_empty() {
                lines.push(format!("  light {number}"));
            }
            lines.extend(rays(&chain));
        }
    }
    lines
}
