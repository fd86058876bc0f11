//! Tells the program from which commit it is built.

use std::path::Path;
use std::process::Command;

fn main() {
    let commit = commit().unwrap_or_default();
    println!("cargo:rustc-env=ETENDUE_COMMIT={commit}");
    let suffix = if commit.is_empty() {
        commit
    } else {
        format!(" ({commit})")
    };
    println!(
        "cargo:rustc-env=ETENDUE_VERSION={}{suffix}",
        env!("CARGO_PKG_VERSION")
    );
}

/// The commit. Without Git, or in the repository of another project, there is none.
fn commit() -> Option<String> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let top = git(&["rev-parse", "--show-toplevel"])?;
    if workspace.canonicalize().ok()? != Path::new(&top).canonicalize().ok()? {
        return None;
    }
    let log = [
        "rev-parse",
        "--path-format=absolute",
        "--git-path",
        "logs/HEAD",
    ];
    println!("cargo:rerun-if-changed={}", git(&log)?);
    git(&["rev-parse", "--short=12", "HEAD"])
}

fn git(arguments: &[&str]) -> Option<String> {
    let found = Command::new("git").args(arguments).output().ok()?;
    let text = String::from_utf8(found.stdout).ok()?;
    found.status.success().then(|| text.trim().to_owned())
}
