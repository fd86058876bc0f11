//! Tests the page `report.html` and the command `etendue report`.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common::{SCENE, call, json, loud, passes, sealed, small, told};
use std::fs;
use std::path::Path;

/// A folder with the runs `a` and `b`. Run `a` has the small scene. Run `b` has the same
/// scene with another pitch, and with a name that would close the page's data tag.
fn runs() -> tempfile::TempDir {
    let folder = small();
    let path = folder.path();
    fs::write(
        path.join("a<b>&.ron"),
        SCENE.replace("\"floor\"", "\"</script><!--\""),
    )
    .unwrap();
    for arguments in [
        "run small.ron --photons 4096 --out a",
        "run a<b>&.ron --photons 4096 --out b --set blockers.0.pitch=0.15",
    ] {
        passes(path, arguments);
    }
    folder
}

/// The contents of the data tags of a page, parsed as JSON.
fn data(page: &Path) -> Vec<serde_json::Value> {
    let text = fs::read_to_string(page).unwrap();
    let blocks = text.split("class=\"run-data\">").skip(1);
    let blocks = blocks.map(|rest| rest.split("</script>").next().unwrap());
    blocks
        .map(|block| serde_json::from_str(block).unwrap())
        .collect()
}

#[test]
fn a_page_holds_what_its_run_found() {
    let folder = runs();
    let page = folder.path().join("a/report.html");
    let [run] = &data(&page)[..] else {
        panic!("one run")
    };
    let summary = json(&folder.path().join("a/summary.json"));
    for (plane, expected) in run["planes"]
        .as_array()
        .unwrap()
        .iter()
        .zip(summary["planes"].as_array().unwrap())
    {
        assert_eq!(plane["report"], *expected);
    }
    assert_eq!(run["scene_file"], summary["scene_file"]);
    assert!(run["path"].as_str().unwrap().starts_with("<svg"));
    // The page refers to nothing outside itself except the SVG namespace.
    let text = fs::read_to_string(&page)
        .unwrap()
        .replace("http://www.w3.org/2000/svg", "");
    assert!(!text.contains("http:") && !text.contains("https:") && !text.contains(" src="));
}

#[test]
fn runs_stand_side_by_side() {
    let folder = runs();
    let path = folder.path();
    told(path, "report a b --out new/folder/both.html", 0);
    let runs = data(&path.join("new/folder/both.html"));
    let alone: Vec<_> = ["a", "b"]
        .map(|name| data(&path.join(name).join("report.html")))
        .concat();
    assert_eq!(runs, alone);
    assert_eq!(runs[1]["scene"], "a<b>&");
    assert_eq!(runs[1]["scene_file"]["path"]["visits"][0], "</script><!--");
    let page = fs::read_to_string(path.join("b/report.html")).unwrap();
    assert!(page.contains("<title>Étendue: a&lt;b&gt;&amp;</title>"));
    assert_eq!(
        page.matches("</script>").count(),
        3,
        "data, colors and script end once each"
    );
}

#[test]
fn a_scene_that_the_explorer_knows_leads_there() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let setup = etendue_explorer::Setup::of_fragment("travel=0.7&fill=0");
    fs::write(path.join("known.ron"), etendue_explorer::scene(&setup)).unwrap();
    fs::write(path.join("other.ron"), SCENE).unwrap();
    for name in ["known", "other"] {
        let run = format!("run {name}.ron --photons 4096 --out {name}");
        let is_known = name == "known";
        let with_explorer = call(path, &format!("{run} --save explorer"));
        if !is_known {
            assert_eq!(with_explorer.status.code(), Some(2), "{with_explorer:?}");
            assert!(!path.join(name).exists());
        }
        let run = if is_known {
            format!("{run} --save explorer --force")
        } else {
            run
        };
        let code = call(path, &run).status.code();
        // With so few photons, the verdict may be undecided.
        assert!([Some(0), Some(4)].contains(&code), "{name}");
        let summary = json(&path.join(name).join("summary.json"));
        assert_eq!(summary["files"]["explorer.html"].is_string(), is_known);
        assert_eq!(path.join(name).join("explorer.html").exists(), is_known);
    }
    told(path, "report known other --out both.html", 0);
    let page = path.join("both.html");
    let [known, other] = &data(&page)[..] else {
        panic!("two runs")
    };
    assert_eq!(known["explorer"], setup.fragment());
    assert!(other["explorer"].is_null());
    assert!(
        fs::read_to_string(page)
            .unwrap()
            .contains("data-folder=\"known/\"")
    );
}

#[test]
fn what_is_no_whole_result_is_refused() {
    let folder = runs();
    let path = folder.path();
    let refused = |line: &str, code: i32, part: &str| {
        let output = loud(path, line);
        assert_eq!(output.status.code(), Some(code), "{output:?}");
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(message.contains(part), "{line}: {message}");
    };
    refused("report a absent --out out", 2, "absent: no such folder");
    let page = path.join("b/report.html");
    let changed = fs::read_to_string(&page).unwrap().replace("4096", "4097");
    fs::write(page, changed).unwrap();
    refused("report b --out out", 2, "damaged");
    assert!(!path.join("out").exists());
    // If a file is a page of another result or an input, it is not replaced.
    refused("report a --out small.ron", 3, "");
    refused("report a --out a/report.html --force", 2, "");
}

/// If a page was changed and its index matches, it still cannot inject markup into a page of
/// several runs.
#[test]
fn pages_are_made_from_data() {
    let folder = runs();
    let path = folder.path();
    let page = path.join("b/report.html");
    let original = fs::read_to_string(&page).unwrap();
    let forge = |from: &str, to: &str| {
        assert!(original.contains(from), "{from}");
        let forged = original.replacen(from, to, 1);
        fs::write(&page, &forged).unwrap();
        let index = path.join("b/summary.json");
        let mut tree = json(&index);
        let hash = blake3::hash(forged.as_bytes()).to_hex();
        tree["files"]["report.html"] = hash.as_str().into();
        fs::write(&index, sealed(tree)).unwrap();
        fs::remove_file(path.join("both.html")).unwrap_or_default();
        loud(path, "report a b --out both.html")
    };
    const MARKUP: &str = "</SCRIPT><img src=x onerror=alert(1)>";
    let data = "class=\"run-data\">";
    // If there is markup next to the data, the data are not valid JSON.
    for to in [format!("{data}{MARKUP}"), format!("{data}0{MARKUP}")] {
        let output = forge(data, &to);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        assert!(!path.join("both.html").exists());
    }
    // Markup in the data is shown as text.
    let output = forge("\"words\":\"", &format!("\"words\":\"{MARKUP}"));
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let both = fs::read_to_string(path.join("both.html")).unwrap();
    assert!(!both.to_lowercase().contains("<img src=x"));
    assert!(
        !both.contains("innerHTML"),
        "nor does the script make it markup"
    );
    let words = self::data(&path.join("both.html"))[1]["words"].clone();
    assert!(words.as_str().unwrap().starts_with(MARKUP));
}

/// The page leads to folders beside it by relative paths, in which no name is an address.
#[test]
fn a_page_leads_to_other_folders_by_relative_paths() {
    let folder = runs();
    let path = folder.path();
    fs::rename(path.join("a"), path.join("javascript:alert(1)")).unwrap();
    fs::create_dir(path.join("pages")).unwrap();
    for (out, address) in [
        ("all.html", "javascript:alert(1)/"),
        ("pages/all.html", "../javascript:alert(1)/"),
    ] {
        told(path, format!("report javascript:alert(1) --out {out}"), 0);
        let page = fs::read_to_string(path.join(out)).unwrap();
        let attribute = format!("data-folder=\"{address}\"");
        assert!(page.contains(&attribute), "{out}: {attribute}");
    }
}
