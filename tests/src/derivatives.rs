//! Compares measured derivatives with those of theory, by `etendue sweep --derivative`.

use crate::hostile::child::program;
use crate::pairs::checks_of_pulls;
use crate::progress::in_parallel;
use crate::report::Bound::{AtLeast, Below};
use crate::report::{Check, ReportSection, Row};
use crate::statistics::uniformity;
use std::collections::HashMap;
use std::path::Path;
use std::process::{Command, Stdio};

/// Scenes with fields.
const FIELDS: [(&str, &str); 11] = [
    (
        "fig9b",
        "light.size.0 light.size.1 light.radiance surfaces.0.center.2 blockers.0.fill \
         blockers.0.pitch blockers.0.center.0 blockers.0.center.2",
    ),
    (
        "diffuse",
        "light.size.1 surfaces.0.albedo blockers.0.shapes.0.size.0 blockers.0.center.2",
    ),
    (
        "two_lights",
        "other_lights.0.radius other_lights.0.radiance blockers.0.center.0",
    ),
    (
        "grating",
        "blockers.0.frequency blockers.0.modulation blockers.0.phase",
    ),
    ("disc_light", "light.radius blockers.0.shapes.1.radius"),
    ("tilted_card", "surfaces.0.center.0 surfaces.0.size.0"),
    ("bars", "blockers.0.fill blockers.0.pitch"),
    (
        "table1/concave_oblique",
        "surfaces.0.form.Sphere surfaces.0.center.2",
    ),
    (
        "table1/ggx_sphere",
        "surfaces.0.event.brdf.lobe.Ggx surfaces.0.form.Sphere",
    ),
    (
        "table1/lens",
        "surfaces.0.event.ThinLens blockers.0.frequency",
    ),
    ("two_layers", "blockers.0.frequency blockers.1.center.2"),
];

/// The derivative at the last plane that has a theory.
struct MeasuredDerivative {
    step: f64,
    noise: f64,
    bias: f64,
    /// The measured over theory's derivative, and its error.
    share: [f64; 2],
    p_value: Option<f64>,
}

/// Measures all fields with a number of photons.
pub(crate) fn section(photons: u64, seed: u64) -> std::io::Result<ReportSection> {
    let program = program(None)?;
    let folder = std::env::temp_dir().join(format!("etendue-derivatives-{}", std::process::id()));
    let each = FIELDS.into_iter();
    let each = each.flat_map(|(scene, fields)| fields.split(' ').map(move |field| (scene, field)));
    let each: Vec<(&str, &str)> = each.collect();
    let seeded = each.iter().zip(seed..);
    let found = in_parallel(seeded, "fields", |((scene, field), own)| {
        let out = folder.join(own.to_string());
        let found = measured(&program, scene, field, &out, [photons, own]);
        let _ = std::fs::remove_dir_all(&out);
        found
    });
    let _ = std::fs::remove_dir_all(&folder);
    let pull = |of: &MeasuredDerivative| (of.share[0] - 1.0) / of.share[1];
    let all = || found.iter().flatten();
    let pulls: Vec<f64> = all().map(pull).collect();
    let (pull, of_pulls) = checks_of_pulls(&pulls);
    let p_values: Vec<f64> = all().filter_map(|of| of.p_value).collect();
    let uniform = uniformity(&p_values);
    let mut rows: Vec<Row> = each
        .iter()
        .zip(&found)
        .map(|(of, found)| row(*of, found))
        .collect();
    let mut checks = vec![
        Check::new("fields", pulls.len() as f64, AtLeast(30.0)).because("as many are asked for"),
        Check::new("uniform p", uniform, AtLeast(0.01)).because("level of the test"),
    ];
    checks.extend(of_pulls);
    let cells = [
        "all",
        "",
        "",
        "",
        "",
        "",
        &pull,
        &format!("KS {uniform:.3}"),
    ];
    rows.push(Row::new(cells.map(str::to_owned).to_vec(), checks));
    let text = format!(
        "`etendue sweep SCENE --derivative FIELD` with {photons} photons for each run, at the last plane that \
         has a theory. *Noise* and *bias* are relative to the derivative. *Measured over theory's* is the \
         size of the measured derivative along that of theory; a pull is its deviation from 1, in units of its \
         stated error. *p* is that of the hypothesis that theory's difference over the same step is true; a dash \
         stands where predictions have errors that replicates do not show. Required, over all fields: the \
         mean pull is 0, the mean squared pull is 63/61, and p is uniform."
    );
    let columns = "scene | field | step | noise | bias | measured over theory's | pull | p";
    Ok(ReportSection::new(
        "Derivatives".to_owned(),
        text,
        columns,
        rows,
    ))
}

fn row((scene, field): (&str, &str), found: &Option<MeasuredDerivative>) -> Row {
    let mut cells = vec![scene.to_owned(), field.to_owned()];
    let Some(of) = found else {
        cells.extend(vec!["–".to_owned(); 6]);
        let none = Check::new("derivative", 0.0, AtLeast(1.0)).because("each field has one");
        return Row::new(cells, vec![none]);
    };
    let [share, error] = of.share;
    cells.extend([
        format!("{:.2e}", of.step),
        format!("{:.2} %", 100.0 * of.noise),
        format!("{:.2} %", 100.0 * of.bias),
        format!("{share:.5} ± {error:.5}"),
        format!("{:.2}", (share - 1.0) / error),
        of.p_value.map_or("–".to_owned(), |p| format!("{p:.3}")),
    ]);
    let settled = Check::new("bias over noise", of.bias / of.noise, Below(1.0));
    Row::new(cells, vec![settled.because("the choice of the step")])
}

/// Runs the command; `None` if it has no derivative that is compared with theory.
fn measured(
    program: &Path,
    scene: &str,
    field: &str,
    out: &Path,
    [photons, seed]: [u64; 2],
) -> Option<MeasuredDerivative> {
    let path = format!("{}/../scenes/{scene}.ron", env!("CARGO_MANIFEST_DIR"));
    Command::new(program)
        .args(["sweep", &path, "--quiet", "--force", "--derivative", field])
        .args([
            "--photons",
            &photons.to_string(),
            "--seed",
            &seed.to_string(),
        ])
        .args(["--threads", "1", "--out"])
        .arg(out)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .ok()?;
    // No cell of the table has a comma.
    let table = std::fs::read_to_string(out.join("derivative.csv")).ok()?;
    let mut lines = table.lines().map(|line| line.split(','));
    let header: Vec<&str> = lines.next()?.collect();
    let rows = lines.map(|cells| header.iter().copied().zip(cells).collect::<HashMap<_, _>>());
    let number = |row: &HashMap<&str, &str>, key: &str| row.get(key)?.parse::<f64>().ok();
    let chosen = rows.filter(|row| row["chosen"] == "true");
    let mut found = chosen.filter_map(|row| {
        Some(MeasuredDerivative {
            step: number(&row, "step")?,
            noise: number(&row, "noise")?,
            bias: number(&row, "bias")?,
            share: [
                number(&row, "share_of_theory")?,
                number(&row, "error_of_share")?,
            ],
            p_value: number(&row, "p_value"),
        })
    });
    found.next_back()
}
