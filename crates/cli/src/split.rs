//! Implements `etendue split`. It prints commands that measure parts of a scene on several
//! machines, and a command that combines these parts.

use crate::args::SplitArgs;
use crate::print::deliver;
use etendue_pipeline::{load, method};
use etendue_report::shell_word;
use etendue_store::Failure;
use etendue_store::Method;

/// Runs `etendue split`; returns the exit code.
pub(crate) fn split(args: &SplitArgs) -> Result<u8, Failure> {
    let scene = load::scene(&args.scene.source(), |run| args.photons.set(run))?;
    method::check(&scene, args.photons.method)?;
    let (parts, batches) = (args.parts, scene.run.batches);
    if parts > batches {
        return Err(Failure::bad_input(format!(
            "--parts {parts}: the scene has {batches} batches, and each part needs at least one"
        )));
    }
    let out = args.out.or_named(&scene.name);
    let below = |name: &str| word(&out.join(name).to_string_lossy());
    let work = SplitWork {
        name: word(&scene.name)?,
        scene: scene_words(args)?,
        parts,
        batches,
        // The beginning of the folder name of each part, to which digits are appended.
        part: below("parts/")?,
        predicted: below("predicted")?,
        out: word(&out.to_string_lossy())?,
    };
    deliver(&if args.slurm {
        work.slurm()
    } else {
        work.commands()
    })?;
    Ok(0)
}

/// A word of a script, quoted for a shell. A line break would end a line of the script, and
/// could end a here-document.
fn word(text: &str) -> Result<String, Failure> {
    if text.contains(char::is_control) {
        return Err(Failure::bad_input(format!(
            "{text:?} would stand in a script; allowed: words without line breaks and other control characters"
        )));
    }
    Ok(shell_word(text))
}

/// The scene and the measurement options as words of a command line.
fn scene_words(args: &SplitArgs) -> Result<String, Failure> {
    let mut words = vec![args.scene.path.to_string_lossy().into_owned()];
    for (path, value) in &args.scene.set {
        words.extend(["--set".to_owned(), format!("{path}={value}")]);
    }
    if let Some(color) = args.scene.color {
        words.extend(["--color", color.name()].map(str::to_owned));
    }
    let numbers = [
        ("--photons", args.photons.photons),
        ("--seed", args.photons.seed),
    ];
    for (option, number) in numbers {
        if let Some(number) = number {
            words.extend([option.to_owned(), number.to_string()]);
        }
    }
    if args.photons.method != Method::Photons {
        let name = args.photons.method.name();
        words.extend(["--method".to_owned(), name.to_owned()]);
    }
    let words = words.iter().map(|text| word(text));
    Ok(words.collect::<Result<Vec<_>, _>>()?.join(" "))
}

/// The words of the commands for the parts, quoted for a shell.
struct SplitWork {
    name: String,
    scene: String,
    parts: u32,
    batches: u32,
    part: String,
    predicted: String,
    out: String,
}

impl SplitWork {
    fn measure(&self, batches: &str, part: &str) -> String {
        let Self { scene, .. } = self;
        format!(
            "etendue measure {scene} --batches {batches} --out {}{part}",
            self.part
        )
    }

    fn predict(&self) -> String {
        format!("etendue predict {} --out {}", self.scene, self.predicted)
    }

    fn compare(&self) -> String {
        format!(
            "etendue compare --measured {}* --predicted {} --out {}",
            self.part, self.predicted, self.out
        )
    }

    /// The commands for the parts, followed by the commands to run after all parts are
    /// finished.
    fn commands(&self) -> String {
        let Self { parts, batches, .. } = self;
        let first = |part: u32| u64::from(*batches) * u64::from(part) / u64::from(*parts);
        let each = (0..*parts).map(|part| {
            let range = format!("{}..{}", first(part), first(part + 1));
            self.measure(&range, &part.to_string())
        });
        let after = [self.predict(), self.compare()];
        each.chain(after).collect::<Vec<_>>().join("\n")
    }

    /// A script that submits the commands to Slurm.
    fn slurm(&self) -> String {
        let Self {
            name,
            parts,
            batches,
            ..
        } = self;
        let last = parts - 1;
        let range = format!("$(({batches} * i / {parts}))..$(({batches} * (i + 1) / {parts}))");
        let threads = "--threads \"${SLURM_CPUS_PER_TASK:-1}\"";
        let (measure, predict, compare) =
            (self.measure(&range, "$i"), self.predict(), self.compare());
        format!(
            "#!/bin/sh
# Submits {name} to Slurm in {parts} parts; run it as: sh THIS. Add the options that your cluster requires to each sbatch, such as --time and --cpus-per-task.
set -eu
parts=$(sbatch --parsable --job-name={name} --array=0-{last} <<'END'
#!/bin/sh
i=$SLURM_ARRAY_TASK_ID
exec {measure} {threads}
END
)
predicted=$(sbatch --parsable --job-name={name}-predicted <<'END'
#!/bin/sh
exec {predict} {threads}
END
)
sbatch --job-name={name}-compared --dependency=\"afterok:$parts:$predicted\" <<'END'
#!/bin/sh
exec {compare} {threads}
END"
        )
    }
}
