use crate::args::CheckArgs;
use crate::failure::Failure;
use crate::{load, pictures, say};
use etendue_compare::{Class, steps};
use etendue_field::tidy;
use etendue_scene::Scene;

/// `etendue check`: returns the exit code.
pub(crate) fn check(args: &CheckArgs) -> Result<u8, Failure> {
    let scene = load::scene(&args.scene, |_| ())?;
    say(&description(&scene));
    if let Some(path) = &args.draw {
        pictures::draw_scene(&scene, path)?;
        say(&format!("\ndrawn in {}", path.display()));
    }
    Ok(0)
}

/// The lengths of the legs, with what they end on.
fn length(scene: &Scene) -> String {
    let legs = scene.path.legs.iter().enumerate();
    let ends = legs.filter_map(|(i, leg)| {
        let name = scene.name_of(scene.path.ends_at(i)?.object);
        Some(format!("{} m to {name}", tidy(leg.length)))
    });
    ends.collect::<Vec<_>>().join(", ")
}

fn description(scene: &Scene) -> String {
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
    for plane in &scene.planes {
        let [k, rho, nu] = plane.grid.full_shape();
        lines.push(format!(
            "\n{}: {} m along the central ray, prediction: {:?}",
            plane.name,
            tidy(plane.distance),
            Class::of(scene, plane)
        ));
        lines.extend(steps(scene, plane).iter().map(|step| format!("  {step}")));
        lines.push(format!(
            "  looked at in {k} azimuths x {rho} x {nu} frequencies, up to {} cycles/m and {} cycles per unit slope",
            tidy(plane.grid.rho.max()),
            tidy(plane.grid.nu.max())
        ));
    }
    lines.join("\n")
}
