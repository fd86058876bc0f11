//! What this machine has, as far as it says so (Linux); elsewhere nothing is known and nothing refused.

use std::fs;

/// Memory that can be taken without swapping, in bytes.
pub(crate) fn available_memory() -> u64 {
    kilobytes("/proc/meminfo", "MemAvailable:").map_or(u64::MAX, |kb| kb * 1024)
}

/// The most memory this process has held, in bytes.
pub(crate) fn peak_memory() -> Option<u64> {
    kilobytes("/proc/self/status", "VmHWM:").map(|kb| kb * 1024)
}

fn kilobytes(file: &str, field: &str) -> Option<u64> {
    let text = fs::read_to_string(file).ok()?;
    let line = text.lines().find(|line| line.starts_with(field))?;
    line.split_whitespace().nth(1)?.parse().ok()
}
