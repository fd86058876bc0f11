//! Statistical validation of Étendue.
//!
//! `short` takes a few minutes and is run after every change. `suite` runs all scenes without
//! smooth surfaces and writes `results/suite.md`. `table1` checks the operators of the paper, and
//! `shading` checks the reflection of light at surfaces. `claims` checks the statements in the
//! paper's text, `orders` checks how fast first-order chains converge, and `main` checks all
//! results of the main scene. Each of `table1`, `shading`, `claims`, `orders` and `main` writes one
//! part of `results/validation.md`. `rows` runs `table1` and `shading`, and sums them up for every
//! row of the paper's Table 1. `all` runs all of these. `second` compares the code shared by theory
//! and tracers with a second implementation. `hostile` and `kills` attack the program `etendue`
//! from outside. `wild` and `worlds` search for scenes on which the program is wrong. `assumptions`
//! disables the checks of a scene that precede a prediction.

#![allow(clippy::too_many_lines, reason = "checks are lists of rows")]

mod assumptions;
mod bandwidth;
mod calibration;
mod claims;
mod derivatives;
mod faults;
mod fits;
mod full_radial;
mod gallery;
mod hostile;
mod kills;
mod nets;
mod noise;
mod orders;
mod pairs;
mod predicted;
mod progress;
mod pulls;
mod report;
mod rows;
mod scenes;
mod second;
mod shading;
mod statistics;
mod suite;
mod table1;
mod transform;
mod wild;
mod worlds;

use clap::{Parser, Subcommand};
use etendue_scene::Sampling;
use report::ReportSection;
use std::ops::Range;
use std::process::ExitCode;

/// Statistical validation of Étendue: calibration, planted faults, noise floors.
#[derive(Debug, Parser)]
#[command(after_help = "Examples:
  cargo run --release -p etendue-validation -- short
  cargo run --release -p etendue-validation -- faults --photons 8388608
  cargo run --release -p etendue-validation -- suite        ten minutes; writes results/suite.md
  cargo run --release -p etendue-validation -- table1       writes results/validation.md
  cargo run --release -p etendue-validation -- shading      writes results/validation.md
  cargo run --release -p etendue-validation -- claims       two minutes; writes results/validation.md
  cargo run --release -p etendue-validation -- orders       five minutes; writes results/validation.md
  cargo run --release -p etendue-validation -- bandwidth    writes results/bandwidth.md, .svg and .csv
  cargo run --release -p etendue-validation -- full-radial  minutes; writes results/validation.md
  cargo run --release -p etendue-validation -- nets         three minutes; writes results/nets.md
  cargo run --release -p etendue-validation -- second       seconds; compares shared functions with a second implementation
  cargo run --release -p etendue-validation -- plain        minutes; 2,000 random scenes by a tracer of scene files
  cargo run --release -p etendue-validation -- hostile      20,000 mutated inputs for etendue in the same folder
  cargo run --release -p etendue-validation -- kills        200 kills of etendue in the same folder
  cargo run --release -p etendue-validation -- wild         100 random scenes for etendue in the same folder
  cargo run --release -p etendue-validation -- worlds       100 random worlds, probed by etendue in the same folder
  cargo run --release -p etendue-validation -- small        20 minutes; small objects in the light of 2,000 random scenes
  cargo run --release -p etendue-validation -- assumptions  minutes; random scenes with the checks of theory switched off
  cargo run --release -p etendue-validation -- pulls        errors of measured parameters of 300 random scenes, relative to stated errors
  cargo run --release -p etendue-validation -- fits         errors of fits over many seeds; writes results/fits.md
  cargo run --release -p etendue-validation -- derivatives  minutes; derivatives of 32 fields by etendue in the same folder
  cargo run --release -p etendue-validation -- gallery      minutes; texts in figures by etendue in the same folder
  cargo run --release -p etendue-validation -- transform    errors of the slice transform over 20 random scenes
  cargo run --release -p etendue-validation -- rows         an hour; table1, shading and every row of Table 1
  cargo run --release -p etendue-validation -- all          two hours; writes the whole of results/validation.md")]
struct ValidationCli {
    #[command(subcommand)]
    command: ValidationCommand,
}

#[derive(Debug, Subcommand)]
enum ValidationCommand {
    /// A short form of the whole validation.
    Short,
    /// Check that over many seeds p is uniform, χ²/dof is 1, and pulls have unit variance.
    Calibration {
        /// Number of seeds.
        #[arg(long, default_value_t = 1000)]
        seeds: u64,
        /// First seed. Faults are planted only if the first thousand seeds are included.
        #[arg(long, default_value_t = 1)]
        first: u64,
        /// Photons per seed.
        #[arg(long, default_value_t = 100_000)]
        photons: u64,
    },
    /// Check that planted faults are rejected.
    Faults {
        /// Photons.
        #[arg(long, default_value_t = 1 << 23)]
        photons: u64,
    },
    /// Check every plane and its parameters, and the receiver's noise floor up to a number of photons.
    Noise {
        /// Photons of the longest run.
        #[arg(long, default_value_t = 1_000_000_000)]
        most: u64,
    },
    /// Predict every scene without smooth surfaces and trace it in both directions, also with faults
    /// that only these scenes can reveal; write results/suite.md.
    Suite {
        /// Photons per scene, instead of those in the files.
        #[arg(long)]
        photons: Option<u64>,
    },
    /// Check Table 1 of the paper: every operator in 2D and in 4D, misprints and planted faults; write results/validation.md.
    Table1 {
        /// Photons per scene, instead of those in the files.
        #[arg(long)]
        photons: Option<u64>,
    },
    /// Check cosines, BRDFs, textures, environments and the sampling criteria of the paper; write results/validation.md.
    Shading {
        /// Photons per scene, instead of those in the files.
        #[arg(long)]
        photons: Option<u64>,
    },
    /// Check statements in the paper's text with photons; write results/validation.md.
    Claims(claims::ClaimRun),
    /// Compute the orders of convergence of the paper's operators on every scene of Table 1, without
    /// photons; write results/validation.md.
    Orders,
    /// Compare the sampling criteria with photons; write results/bandwidth.md and its picture.
    Bandwidth {
        /// Photons per point; if given, nothing is written.
        #[arg(long)]
        photons: Option<u64>,
    },
    /// Check that p of the full radial spectrum is uniform over many seeds, and that faults in its
    /// predictions are rejected.
    FullRadial {
        /// Number of seeds.
        #[arg(long, default_value_t = 200)]
        seeds: u64,
        /// Photons per seed.
        #[arg(long, default_value_t = 1 << 16)]
        photons: u64,
    },
    /// Compare stated errors of predictions by nets of rays with the true errors; write
    /// results/nets.md.
    Nets,
    /// Compare the code shared by theory and tracers with a second implementation; exit code 1 if
    /// they differ or a planted fault is not detected.
    Second,
    /// Compare the light in the windows of random scenes with a tracer that reads the scene file
    /// and shares no resolved scene; exit code 1 if photons find other light.
    Plain(second::PlainOptions),
    /// Give the program mutated scenes, meshes, pictures and stored stages as input; exit code 1 if
    /// it fails on any of them.
    Hostile(hostile::HostileOptions),
    /// Kill the program, start it twice at once and run it on full disks; exit code 1 if it leaves
    /// a broken result or loses a file.
    Kills(kills::KillOptions),
    /// Run random scenes with all features; exit code 1 after a panic, a hang or a wrong verdict.
    Wild(wild::WildOptions),
    /// Predict random scenes that each violate an assumption of theory; exit code 1 if photons never
    /// reject the violation of one assumption.
    Assumptions(assumptions::AssumptionOptions),
    /// Put small objects into the light of random scenes; exit code 1 if photons reject a prediction.
    Small(wild::SmallOptions),
    /// Run random scenes with several reflecting or refracting surfaces; exit code 1 if photons reject
    /// a prediction.
    Several(wild::SmallOptions),
    /// Probe random worlds; exit code 1 if backward rays disagree with photons, or with rays that
    /// never sample a light.
    Worlds(worlds::WorldOptions),
    /// Measure pulls of parameters and slopes over random scenes, and the cost of predictions; exit
    /// code 1 if stated errors are wrong.
    Pulls(pulls::PullOptions),
    /// Measure scenes by their difference from another scene with the same photons; exit code 1 if
    /// stated errors are wrong.
    Pairs(pairs::PairOptions),
    /// Compare measured derivatives of 32 fields with those of theory.
    Derivatives {
        /// Photons of each run.
        #[arg(long, default_value_t = 1 << 18)]
        photons: u64,
        /// Seed of the first field; each has its own.
        #[arg(long, default_value_t = SEED)]
        seed: u64,
    },
    /// Measure errors, p and bounds of fits over many seeds, far starts, degenerate scenes and wrong
    /// models; write results/fits.md.
    Fits(fits::FitOptions),
    /// Search figures of the paper and of random scenes for texts that cannot be read.
    Gallery(gallery::GalleryOptions),
    /// Compare the slice transform with plain sums over random scenes; exit code 1 if its error is
    /// larger than stated.
    Transform(transform::TransformOptions),
    /// Check the main scene: every plane, noise floors, calibration and planted faults; write results/validation.md.
    Main,
    /// Run `table1` and `shading`, and write a summary for every row of the paper's Table 1 to results/validation.md.
    Rows,
    /// Write the whole of results/validation.md: `main`, `rows`, `claims` and `orders`.
    All,
}

/// The seed of every single run. This seed was fixed in advance, and not chosen by the results
/// that it gives.
const SEED: u64 = 1;

/// The parts of `rows` and `all`, with the photons in the files of their scenes.
const TABLE1: ValidationCommand = ValidationCommand::Table1 { photons: None };
const SHADING: ValidationCommand = ValidationCommand::Shading { photons: None };
const CLAIMS: ValidationCommand = ValidationCommand::Claims(claims::ClaimRun {
    photons: None,
    seed: SEED,
});

fn main() -> ExitCode {
    let command = ValidationCli::parse().command;
    let one = |section: std::io::Result<ReportSection>| printed(section.map(|one| vec![one]));
    match &command {
        ValidationCommand::Bandwidth { photons } => bandwidth::page(*photons),
        ValidationCommand::Nets => nets::page(),
        ValidationCommand::Hostile(options) => one(hostile::hostile(options)),
        ValidationCommand::Kills(options) => one(kills::kills(options)),
        ValidationCommand::Wild(options) => one(wild::wild(options)),
        ValidationCommand::Small(options) => one(wild::small(options)),
        ValidationCommand::Several(options) => one(wild::several(options)),
        ValidationCommand::Worlds(options) => one(worlds::worlds(options)),
        ValidationCommand::Assumptions(options) => one(assumptions::assumptions(options)),
        ValidationCommand::Pulls(options) => printed(pulls::pulls(options)),
        ValidationCommand::Pairs(options) => printed(Ok(pairs::pairs(options))),
        ValidationCommand::Derivatives { photons, seed } => {
            one(derivatives::section(*photons, *seed))
        }
        ValidationCommand::Gallery(options) => one(gallery::gallery(*options)),
        ValidationCommand::Transform(options) => one(transform::transform(options)),
        ValidationCommand::Plain(options) => one(second::plain(options)),
        ValidationCommand::Second => one(second::second()),
        _ => written(&command),
    }
}

/// Prints sections, and returns their text.
#[expect(clippy::print_stdout, reason = "the report is the product")]
fn shown(sections: &[ReportSection]) -> String {
    let text: Vec<String> = sections.iter().map(ReportSection::markdown).collect();
    let text = text.join("\n");
    println!("{text}");
    text
}

/// The exit code of a command: 1 if a section fails.
fn judged(sections: &[ReportSection]) -> ExitCode {
    ExitCode::from(u8::from(!sections.iter().all(ReportSection::passes)))
}

/// Prints the sections of a command, and writes its part of a page in results/.
#[expect(clippy::print_stderr, reason = "the report is the product")]
fn written(command: &ValidationCommand) -> ExitCode {
    let parts = match command {
        ValidationCommand::Rows => &[TABLE1, SHADING][..],
        ValidationCommand::All => &[
            TABLE1,
            SHADING,
            CLAIMS,
            ValidationCommand::Orders,
            ValidationCommand::Main,
        ],
        other => std::slice::from_ref(other),
    };
    let report = |command: &ValidationCommand, sections: Vec<ReportSection>| {
        let text = shown(&sections);
        if let Some([path, title, name, of]) = page(command) {
            let page = format!(
                "# {title}\n\nWritten by `cargo run --release -p etendue-validation -- {name}`. \
                 {of}. The seed is {SEED} unless stated otherwise.\n\n{text}"
            );
            let before = std::fs::read_to_string(path).unwrap_or_default();
            std::fs::write(path, with_part(&before, title, &page))
                .map_err(|error| eprintln!("{path}: {error}"))?;
        }
        Ok(sections)
    };
    let reported = || -> Result<Vec<ReportSection>, ()> {
        let mut all = Vec::new();
        for part in parts {
            all.extend(report(part, sections(part))?);
        }
        if matches!(command, ValidationCommand::Rows | ValidationCommand::All) {
            all.extend(report(&ValidationCommand::Rows, vec![rows::rows(&all)])?);
        }
        Ok(all)
    };
    match reported() {
        Ok(all) => judged(&all),
        Err(()) => ExitCode::from(3),
    }
}

/// Prints sections that are not part of any page in results/.
#[expect(clippy::print_stderr, reason = "the report is the product")]
fn printed(outcome: std::io::Result<Vec<ReportSection>>) -> ExitCode {
    match outcome {
        Ok(sections) => {
            shown(&sections);
            judged(&sections)
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(3)
        }
    }
}

/// The page to which a command contributes a part, as the file of the page, the title of
/// the part, the name of the command and a description.
fn page(command: &ValidationCommand) -> Option<[&'static str; 4]> {
    let part = |title, name, of| Some(["results/validation.md", title, name, of]);
    match command {
        ValidationCommand::Main => {
            part("The main scene", "main", "The scene is `scenes/fig9b.ron`")
        }
        ValidationCommand::Suite { photons: None } => Some([
            "results/suite.md",
            "The suite",
            "suite",
            "The scenes are all scenes in `scenes/` without smooth surfaces",
        ]),
        ValidationCommand::Table1 { photons: None } => part(
            "Table 1",
            "table1",
            "The scenes are all scenes in `scenes/table1/` without BRDFs, with the photons of \
             their files",
        ),
        ValidationCommand::Shading { photons: None } => part(
            "Shading",
            "shading",
            "Sections that name no scene are in 2D and trace no photons",
        ),
        ValidationCommand::Claims(claims::ClaimRun {
            photons: None,
            seed: SEED,
        }) => part(
            "Words",
            "claims",
            "The scenes are those in `scenes/words/`, with the photons of their files",
        ),
        ValidationCommand::Orders => part(
            "Orders",
            "orders",
            "The scenes are all scenes in `scenes/table1/`",
        ),
        ValidationCommand::FullRadial {
            seeds: 200,
            photons: 65_536,
        } => part(
            "Full radial spectra",
            "full-radial",
            "The scenes have fewer frequencies than in their files",
        ),
        ValidationCommand::Fits(_) => Some([
            "results/fits.md",
            "Fits",
            "fits",
            "The scenes are in `tests/src/fits.rs`",
        ]),
        ValidationCommand::Rows => part(
            "Every row of Table 1",
            "rows",
            "This table summarises the parts of this page",
        ),
        _ => None,
    }
}

/// A page with one of its parts replaced or added; parts begin with their titles.
fn with_part(page: &str, title: &str, part: &str) -> String {
    let heading = format!("# {title}\n");
    // A part of a page may itself contain `##` headings.
    let starts = page.match_indices("\n# ").map(|(at, _)| at + 1);
    let mut cuts: Vec<usize> = std::iter::once(0).chain(starts).collect();
    cuts.push(page.len());
    let others = cuts
        .windows(2)
        .map(|ends| page[ends[0]..ends[1]].trim_end());
    let mut parts: Vec<&str> = others.filter(|other| !other.is_empty()).collect();
    match parts.iter().position(|other| other.starts_with(&heading)) {
        Some(at) => parts[at] = part.trim_end(),
        None => parts.push(part.trim_end()),
    }
    parts.join("\n\n") + "\n"
}

fn sections(command: &ValidationCommand) -> Vec<ReportSection> {
    match *command {
        ValidationCommand::Short => {
            let mut sections = calibrations(1..101, 20_000);
            sections.push(faults::planted(3_000_000, SEED));
            sections.push(noise::floor(&[1 << 17, 1 << 20], SEED));
            sections.extend(suite::suite(Some(200_000)));
            sections
        }
        ValidationCommand::Calibration {
            seeds,
            first,
            photons,
        } => calibrations(first..first + seeds, photons),
        ValidationCommand::Faults { photons } => faults(photons),
        ValidationCommand::Suite { photons } => {
            let mut sections = suite::suite(photons);
            sections.push(faults::planted_elsewhere(photons.unwrap_or(1 << 22), SEED));
            sections
        }
        ValidationCommand::Table1 { photons } => table1::table1(photons),
        ValidationCommand::Shading { photons } => shading::shading(photons),
        ValidationCommand::Claims(run) => vec![claims::claims(run)],
        ValidationCommand::Orders => vec![orders::orders()],
        ValidationCommand::FullRadial { seeds, photons } => {
            full_radial::full_radial(seeds, photons)
        }
        ValidationCommand::Noise { most } => noise(most),
        ValidationCommand::Fits(options) => fits::sections(options),
        ValidationCommand::Main => {
            let mut sections = noise(1 << 30);
            sections.extend(calibrations(1..1001, 100_000));
            sections.extend(faults(1 << 23));
            sections
        }
        // Each of the other commands writes its own report, or consists of others.
        _ => Vec::new(),
    }
}

fn faults(photons: u64) -> Vec<ReportSection> {
    vec![
        faults::planted(photons, SEED),
        faults::power(photons, SEED),
        faults::smallest(photons, SEED),
    ]
}

/// The sections on calibration, for photons from lattices, from nets and from independent
/// random numbers.
fn calibrations(seeds: Range<u64>, photons: u64) -> Vec<ReportSection> {
    let others = ["grating", "two_layers"].map(|scene| (scene, Sampling::Lattice));
    let kinds = [Sampling::Lattice, Sampling::Net, Sampling::Random];
    let main = kinds.map(|kind| (calibration::MAIN, kind));
    let all = main.into_iter().chain(others);
    let sections =
        all.flat_map(|(scene, kind)| calibration::calibration(scene, seeds.clone(), photons, kind));
    sections.collect()
}

fn noise(most: u64) -> Vec<ReportSection> {
    let steps = (20..=40).step_by(3).map(|n| 1_u64 << n);
    let decades: Vec<u64> = steps.filter(|n| *n <= most).collect();
    let planes = most.min(1 << 23);
    vec![
        noise::planes(planes, SEED),
        noise::parameters(planes, SEED),
        noise::floor(&decades, SEED),
        noise::gain(Sampling::Lattice, planes, 64),
        noise::gain(Sampling::Net, planes, 64),
        noise::gain(Sampling::Net, planes, 1024),
    ]
}

#[cfg(test)]
mod tests {
    use super::with_part;

    #[test]
    fn a_part_replaces_its_like_and_leaves_the_others() {
        let page = with_part("", "A", "# A\n\n## s\n\nold\n");
        let page = with_part(&page, "B", "# B\n\nother\n");
        assert_eq!(page, "# A\n\n## s\n\nold\n\n# B\n\nother\n");
        let page = with_part(&page, "A", "# A\n\nnew\n");
        assert_eq!(page, "# A\n\nnew\n\n# B\n\nother\n");
    }
}
