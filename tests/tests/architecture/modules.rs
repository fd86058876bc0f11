//! The modules of a crate and the dependencies between them, read from the source text.

use super::source::{code, test_modules};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// The names on the path from the root of a crate to a module; empty for the root.
pub(crate) type Module = Vec<String>;

/// The modules of a crate, each with its source text.
pub(crate) type Modules = BTreeMap<Module, String>;

/// Maximum length of a chain of re-exports; a longer chain is a cycle.
const MAX_REEXPORTS: usize = 8;

/// The modules below a source folder, each without comments and code compiled only for
/// tests.
pub(crate) fn modules(src: &Path) -> Modules {
    let mut texts = Modules::new();
    collect(src, &Module::new(), &mut texts);
    let tests: Vec<Module> = texts
        .iter()
        .flat_map(|(module, text)| {
            let names = test_modules(text).into_iter();
            names.map(|name| [module.as_slice(), &[name]].concat())
        })
        .collect();
    texts.retain(|module, _| !tests.iter().any(|test| module.starts_with(test)));
    texts
        .iter()
        .map(|(module, text)| (module.clone(), code(text)))
        .collect()
}

fn collect(folder: &Path, parent: &Module, found: &mut Modules) {
    let mut entries: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().path())
        .collect();
    entries.sort();
    for path in entries {
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        let mut module = parent.clone();
        if path.is_dir() {
            module.push(name);
            collect(&path, &module, found);
        } else if path.extension().is_some_and(|e| e == "rs") && name != "main" {
            if name != "lib" && name != "mod" {
                module.push(name);
            }
            found.insert(module, fs::read_to_string(&path).unwrap());
        }
    }
}

/// The cycles of modules that use each other, each sorted by name.
pub(crate) fn circles(modules: &Modules) -> Vec<BTreeSet<String>> {
    let names: Vec<&Module> = modules.keys().collect();
    let uses: BTreeMap<&Module, BTreeSet<Module>> = names
        .iter()
        .map(|module| (*module, used(modules, module)))
        .collect();
    let reach: BTreeMap<&Module, BTreeSet<&Module>> = names
        .iter()
        .map(|module| (*module, reached(&uses, module)))
        .collect();
    let mut circles: BTreeSet<BTreeSet<String>> = BTreeSet::new();
    for module in &names {
        let both = reach[module]
            .iter()
            .filter(|other| reach[**other].contains(module));
        let circle: BTreeSet<String> = both.map(|other| shown(other)).collect();
        if circle.len() > 1 {
            circles.insert(circle);
        }
    }
    circles.into_iter().collect()
}

fn shown(module: &Module) -> String {
    match module.as_slice() {
        [] => "lib".to_owned(),
        parts => parts.join("::"),
    }
}

/// All modules reachable from a module.
fn reached<'a>(
    uses: &'a BTreeMap<&'a Module, BTreeSet<Module>>,
    from: &Module,
) -> BTreeSet<&'a Module> {
    let mut reached = BTreeSet::new();
    let mut left: Vec<&Module> = uses[from].iter().collect();
    while let Some(next) = left.pop() {
        if reached.insert(next) {
            left.extend(uses[next].iter());
        }
    }
    reached
}

/// The other modules that a module uses. If a module is only re-exported, it does not count
/// as used.
fn used(modules: &Modules, module: &Module) -> BTreeSet<Module> {
    let text = &modules[module];
    let (imports, body) = split(text);
    let own = imports.iter().filter(|(is_export, _)| !is_export);
    let mut paths: Vec<Vec<String>> = own.map(|(_, path)| path.clone()).collect();
    paths.extend(paths_of(&body));
    let resolved = paths.iter().filter_map(|path| {
        let path = absolute(modules, module, path, 0)?;
        resolve(modules, &path, 0)
    });
    resolved.filter(|found| found != module).collect()
}

/// The imports in a source text, each with a flag that marks re-exports, and the text
/// without these imports.
fn split(text: &str) -> (Vec<(bool, Vec<String>)>, String) {
    let mut imports = Vec::new();
    let mut rest = String::new();
    let mut left = text;
    while let Some(at) = find_use(left) {
        let (before, after) = left.split_at(at);
        let is_export = before.trim_end().ends_with(')') || before.trim_end().ends_with("pub");
        let Some((tree, next)) = after["use ".len()..].split_once(';') else {
            break;
        };
        imports.extend(expanded(tree).into_iter().map(|path| (is_export, path)));
        rest.push_str(before);
        left = next;
    }
    rest.push_str(left);
    (imports, rest)
}

/// The position of the first `use` in a source text.
fn find_use(text: &str) -> Option<usize> {
    let starts = text.match_indices("use ").map(|(at, _)| at);
    let is_word = |at: &usize| {
        let before = text[..*at].chars().next_back();
        before.is_none_or(|c| c == '\n' || c == ' ')
    };
    let mut starts = starts.filter(is_word);
    starts.find(|at| {
        let line = text[..*at].rsplit('\n').next().unwrap_or_default().trim();
        line.is_empty() || line.starts_with("pub")
    })
}

/// The paths of an import tree, such as `a::{b, c::d as e}`. Each path ends with the local
/// name.
fn expanded(tree: &str) -> Vec<Vec<String>> {
    let tree = tree.trim();
    let Some(open) = tree.find('{') else {
        let path = tree.split(" as ").next().unwrap_or_default();
        let parts = path.split("::").map(|part| part.trim().to_owned());
        let mut parts: Vec<String> = parts.collect();
        if parts.last().is_some_and(|last| last == "self") {
            parts.pop();
        }
        return vec![parts];
    };
    let close = tree.rfind('}').unwrap_or(tree.len());
    let (prefix, inner) = (&tree[..open], &tree[open + 1..close]);
    let mut depth = 0;
    let parts = inner.split(|c| {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            _ => {}
        }
        c == ',' && depth == 0
    });
    let parts = parts.filter(|part| !part.trim().is_empty());
    parts
        .flat_map(|part| expanded(&format!("{prefix}{}", part.trim())))
        .collect()
}

/// The paths, outside imports, that begin at the crate root, a parent module or a child
/// module.
fn paths_of(body: &str) -> Vec<Vec<String>> {
    let is_part = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    let words = body
        .split(|c| !is_part(c))
        .filter(|word| word.contains("::"));
    let parts = words.map(|word| word.split("::").map(str::to_owned).collect());
    parts
        .filter(|parts: &Vec<String>| !parts[0].is_empty())
        .collect()
}

/// A path relative to the root of the crate, or `None` if the path leads to another
/// crate.
fn absolute(modules: &Modules, module: &Module, path: &[String], depth: usize) -> Option<Module> {
    let mut base = module.clone();
    let mut path = path;
    match path.first()?.as_str() {
        "crate" => return Some(path[1..].to_vec()),
        "self" => path = &path[1..],
        "super" => {
            while path.first().is_some_and(|part| part == "super") {
                base.pop();
                path = &path[1..];
            }
        }
        first => {
            base.push(first.to_owned());
            if !modules.contains_key(&base) {
                base.pop();
                return imported(modules, &base, path, depth).flatten();
            }
            base.pop();
        }
    }
    base.extend(path.iter().cloned());
    Some(base)
}

/// The module to which a path leads through re-exports.
fn resolve(modules: &Modules, path: &[String], depth: usize) -> Option<Module> {
    let longest = (0..=path.len()).rev();
    let known = longest
        .map(|n| path[..n].to_vec())
        .find(|part| modules.contains_key(part))?;
    let rest = &path[known.len()..];
    match imported(modules, &known, rest, depth) {
        None => Some(known),
        Some(whole) => resolve(modules, &whole?, depth + 1),
    }
}

/// A path whose first name a module imports, relative to the root of the crate. Returns
/// `None` if the module does not import it, and `Some(None)` if it comes from another crate.
fn imported(
    modules: &Modules,
    module: &Module,
    path: &[String],
    depth: usize,
) -> Option<Option<Module>> {
    let (name, rest) = path.split_first()?;
    let (imports, _) = split(&modules[module]);
    let mut imports = imports.into_iter().map(|(_, path)| path);
    // An import of the name itself, such as `use rand;`, leads out of the crate.
    let import = imports.find(|import| import.last() == Some(name) && import.len() > 1);
    let import = import.filter(|_| depth < MAX_REEXPORTS)?;
    let whole = absolute(modules, module, &import, depth + 1);
    Some(whole.map(|whole| [whole.as_slice(), rest].concat()))
}
