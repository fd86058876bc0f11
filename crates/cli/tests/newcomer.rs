//! Tests first scenes, JSON on standard output, colours, and descriptions of the command line.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common::{etendue, loud, small, told};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// The JSON that is the whole standard output of a command.
fn tree(path: &Path, line: &str, code: i32) -> Value {
    serde_json::from_str(&told(path, line, code)).unwrap()
}

#[test]
fn each_first_scene_is_sound() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for name in ["blockers", "travel", "mirror", "glossy", "curved"] {
        let said = told(path, format!("new {name}"), 0);
        assert!(
            said.ends_with(&format!("next: etendue run {name}.ron\n")),
            "{said}"
        );
        let said = told(path, format!("check {name}.ron"), 0);
        assert!(said.starts_with(&format!("{name}: sound")), "{said}");
    }
    // Without a name, the first scene; a scene of the user is not replaced.
    fs::write(path.join("blockers.ron"), "mine").unwrap();
    assert_eq!(loud(path, "new").status.code(), Some(3));
    assert_eq!(fs::read(path.join("blockers.ron")).unwrap(), b"mine");
    told(path, "new --out other.ron", 0);
    told(path, "check other.ron", 0);
    assert_eq!(loud(path, "new blocker").status.code(), Some(2));
}

#[test]
fn results_are_printed_as_json() {
    let folder = small();
    let path = folder.path();
    let run = "run small.ron --photons 2^16 --json";
    let summary = tree(path, &format!("{run} --out a"), 0);
    let file = fs::read(path.join("a/summary.json")).unwrap();
    assert_eq!(
        summary,
        serde_json::from_slice::<Value>(&file).unwrap(),
        "run"
    );
    let again = tree(path, &format!("{run} --out a --resume"), 0);
    assert_eq!(again, summary, "a finished run");
    tree(path, &format!("{run} --out b --seed 2"), 0);
    let planes = summary["planes"].as_array().unwrap();
    let diff = tree(path, "diff a b --json", 0);
    assert_eq!(diff["verdict"], "pass");
    assert_eq!(diff["results"][1]["seed"], 2);
    assert_eq!(diff["scene"][0]["field"], "run.seed");
    assert_eq!(diff["planes"].as_array().unwrap().len(), planes.len());
    for (plane, of) in planes.iter().zip(diff["planes"].as_array().unwrap()) {
        assert_eq!(plane["name"], of["name"]);
        let first = &of["parameters"][0];
        assert_eq!(plane["parameters"][0]["name"], first["name"]);
        let measured = &plane["parameters"][0]["measured"];
        assert_eq!(*measured, first["measured"][0]["value"]);
    }
    let check = tree(path, "check small.ron --json --set run.photons=65536", 0);
    assert_eq!(check["scene_hash"], summary["scene_hash"]);
    assert_eq!(check["planes"][0]["class"], planes[0]["class"]);
    assert!(check["expected"]["seconds_of_photons"].as_f64() > Some(0.0));
}

/// JSON stays JSON if a folder's name has characters that a terminal must not get.
#[test]
fn characters_that_are_not_safe_are_escaped_in_json() {
    let folder = small();
    let path = folder.path();
    told(path, "run small.ron --photons 2^16 --quiet --out a", 0);
    let name = "a\u{202e}b\u{e0001}";
    fs::rename(path.join("a"), path.join(name)).unwrap();
    let line = format!("diff {name} {name} --json");
    let text = told(path, &line, 0);
    assert!(text.contains(r"a\u202eb\udb40\udc01"), "{text}");
    assert_eq!(tree(path, &line, 0)["results"][0]["folder"], name);
}

/// U+202E would show the rest of a message in reverse. It is escaped in messages of the program and
/// of the library that reads arguments.
#[test]
fn characters_that_turn_text_around_are_escaped_in_messages() {
    for line in [
        "ru\u{202e}n a.ron",
        "run a.ron --phot\u{202e}ons 3",
        "run a.ron --photons 1\u{202e}0",
        "run a.ron b\u{202e}c",
        "run a.ron --set b\u{202e}c=1",
        "run a.ron --method b\u{202e}c",
        "run b\u{202e}c.ron",
        "import b\u{202e}c.xml",
        "figure b\u{202e}c",
    ] {
        let folder = tempfile::tempdir().unwrap();
        let output = loud(folder.path(), line);
        let message = String::from_utf8([output.stdout, output.stderr].concat()).unwrap();
        assert!(!message.contains('\u{202e}'), "{line:?}: {message:?}");
        let is_named = message.contains(r"\u{202e}") || line.contains("--set");
        assert!(is_named, "{line:?}: {message}");
        assert_eq!(output.status.code(), Some(2), "{line:?}: {message}");
    }
}

#[test]
fn verdicts_are_coloured_where_the_user_wants_it() {
    let folder = small();
    let path = folder.path();
    told(path, "run small.ron --photons 2^16 --quiet --out a", 0);
    let diff = |settings: &[(&str, &str)]| {
        let mut command = etendue();
        let command = command.current_dir(path).args(["diff", "a", "a"]);
        let output = command.envs(settings.iter().copied()).output().unwrap();
        String::from_utf8(output.stdout).unwrap()
    };
    // Standard output is a pipe here.
    let plain = diff(&[]);
    assert!(!plain.contains('\u{1b}'), "{plain}");
    let green = "\u{1b}[32msame\u{1b}[0m";
    let colored = diff(&[("CLICOLOR_FORCE", "1")]);
    assert!(
        colored.contains(&format!("verdict: {green}: ")),
        "{colored}"
    );
    assert!(colored.contains(&format!("  {green}\n")), "{colored}");
    assert_eq!(colored.replace(green, "same"), plain);
    assert_eq!(diff(&[("CLICOLOR_FORCE", "1"), ("NO_COLOR", "1")]), plain);
}

#[test]
fn shells_and_man_learn_the_command_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let script = told(path, format!("completions {shell}"), 0);
        assert!(script.contains("target-error"), "{shell}");
    }
    let page = told(path, "man", 0);
    assert!(page.contains(r"etendue\-probe(1)"), "{page}");
    let page = told(path, "man run", 0);
    assert!(page.contains(".TH etendue-run 1"), "{page}");
    assert!(page.contains(r"\-\-target\-error"), "{page}");
    assert_eq!(loud(path, "man rnu").status.code(), Some(2));
}
