//! The resources of this machine. Resources are known on Linux only; on other systems, nothing is
//! refused for lack of resources.

use crate::Failure;
use etendue_scene::{Scene, SceneFile, resolve};
use std::fs;
use std::path::{Path, PathBuf};

/// The memory that this process may still allocate without swapping, in bytes. The memory
/// is limited by the machine, by the control groups of the process, and by the limits of the
/// process (`ulimit -v`, `ulimit -d`).
pub fn available_memory() -> u64 {
    let machine = kilobytes("/proc/meminfo", "MemAvailable:");
    let limits = [
        limit("Max address space").zip(kilobytes("/proc/self/status", "VmSize:")),
        limit("Max data size").zip(kilobytes("/proc/self/status", "VmData:")),
    ];
    limits
        .into_iter()
        .flatten()
        .map(|(limit, used)| limit.saturating_sub(used))
        .chain(machine)
        .chain(control_groups())
        .min()
        .unwrap_or(u64::MAX)
}

/// Resolves a scene file for this machine. The meshes of the scene are in `folder`, and messages
/// name the scene file as `shown`.
pub fn resolved(name: &str, file: SceneFile, folder: &Path, shown: &str) -> Result<Scene, Failure> {
    resolve(name, file, folder, available_memory()).map_err(|error| {
        let message = format!("{shown}:\n{error}");
        Failure::of_scene(&error, message)
    })
}

/// The peak memory of this process, in bytes.
pub fn peak_memory() -> Option<u64> {
    kilobytes("/proc/self/status", "VmHWM:")
}

/// Checks whether a signal was ignored when this process began, for example because `nohup` started
/// it.
pub fn ignores(signal: i32) -> bool {
    let read = || {
        let text = fs::read_to_string("/proc/self/status").ok()?;
        let mask = field(&text, "SigIgn:")?;
        let mask = u64::from_str_radix(mask, 16).ok()?;
        Some(mask >> (signal - 1) & 1 == 1)
    };
    read().unwrap_or(false)
}

/// The remaining memory of each control group (version 1 or 2) that contains this process.
fn control_groups() -> impl Iterator<Item = u64> {
    let text = fs::read_to_string("/proc/self/cgroup").unwrap_or_default();
    let groups: Vec<PathBuf> = text.lines().flat_map(folders).collect();
    groups.into_iter().filter_map(|folder| left_in(&folder))
}

/// The folders of a control group and of the groups that contain it. `line` has the form
/// `number:controllers:path`.
fn folders(line: &str) -> Vec<PathBuf> {
    let mut parts = line.splitn(3, ':').skip(1);
    let root = match parts.next() {
        Some("") => "/sys/fs/cgroup",
        Some(controllers) if controllers.split(',').any(|c| c == "memory") => {
            "/sys/fs/cgroup/memory"
        }
        _ => return Vec::new(),
    };
    let path = parts.next().unwrap_or_default().trim_start_matches('/');
    let ancestors = Path::new(path).ancestors();
    ancestors.map(|path| Path::new(root).join(path)).collect()
}

/// The limit of a control group minus its usage. Memory of cached files counts as free,
/// because the system can evict it.
fn left_in(folder: &Path) -> Option<u64> {
    let read = |name: &str| fs::read_to_string(folder.join(name)).ok();
    let number = |name: &str| read(name)?.trim().parse::<u64>().ok();
    let limit = number("memory.max").or_else(|| number("memory.limit_in_bytes"))?;
    let used = number("memory.current").or_else(|| number("memory.usage_in_bytes"))?;
    let cached = read("memory.stat").and_then(|text| field(&text, "inactive_file")?.parse().ok());
    Some(limit.saturating_sub(used.saturating_sub(cached.unwrap_or(0))))
}

/// A limit of this process, in bytes; `None` if there is none.
fn limit(name: &str) -> Option<u64> {
    let text = fs::read_to_string("/proc/self/limits").ok()?;
    field(&text, name)?.parse().ok()
}

/// Converts a number of kilobytes to bytes.
fn kilobytes(file: &str, name: &str) -> Option<u64> {
    let text = fs::read_to_string(file).ok()?;
    let kilobytes: u64 = field(&text, name)?.parse().ok()?;
    Some(kilobytes * 1024)
}

/// The first word after a name at the beginning of a line.
fn field<'a>(text: &'a str, name: &str) -> Option<&'a str> {
    let rest = text.lines().find_map(|line| line.strip_prefix(name))?;
    rest.split_whitespace().next()
}
