//! Tests that signals end a run, even if its standard error is closed or full. Also tests that a
//! run without enough memory ends with a message.
#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common::{etendue, scene};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Starts an endless run, and waits until its folder of unfinished files exists.
fn begun(out: &Path, stderr: Stdio) -> Child {
    let child = etendue()
        .arg("run")
        .arg(scene("fig9b.ron"))
        .args(["--photons", "1e12", "--quiet", "--out"])
        .arg(out)
        .stderr(stderr)
        .spawn()
        .unwrap();
    let start = Instant::now();
    while !out.join(".etendue-unfinished").exists() {
        assert!(start.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(5));
    }
    child
}

fn send(signal: &str, to: &Child) {
    let sent = Command::new("kill")
        .args(["-s", signal, &to.id().to_string()])
        .status();
    assert!(sent.unwrap().success());
}

/// The exit code of a process, if it ends soon.
fn code(child: &mut Child) -> Option<i32> {
    let start = Instant::now();
    while start.elapsed() < Duration::from_secs(30) {
        if let Some(status) = child.try_wait().unwrap() {
            return status.code();
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    child.kill().unwrap();
    None
}

#[test]
fn signals_end_a_run_though_nobody_reads_its_errors() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    // If `nohup` ignores SIGHUP, the run continues to ignore it.
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    let hangup = (ignored.unwrap_or(0) & 1 == 0).then_some("HUP");
    for signal in ["INT", "TERM"].into_iter().chain(hangup) {
        // The reader closes the pipe before the run writes to it.
        let mut child = begun(&out, Stdio::piped());
        drop(child.stderr.take());
        send(signal, &child);
        assert_eq!(code(&mut child), Some(3), "{signal}");
        // The interrupted run leaves no unfinished files either.
        assert_eq!(std::fs::read_dir(&out).unwrap().count(), 0, "{signal}");
    }
}

/// Standard error is a full pipe that no process reads.
#[cfg(target_os = "linux")]
#[test]
fn signals_end_a_run_that_cannot_write_its_errors() {
    use std::io::Write;
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    for signals in [&["INT"][..], &["INT", "TERM"]] {
        let (_reader, mut writer) = std::io::pipe().unwrap();
        // The capacity of a pipe on Linux.
        writer.write_all(&[b'x'; 65_536]).unwrap();
        let mut child = begun(&out, writer.into());
        for signal in signals {
            send(signal, &child);
        }
        assert_eq!(code(&mut child), Some(3), "{signals:?}");
    }
}

#[test]
fn memory_that_cannot_be_had_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let program = env!("CARGO_BIN_EXE_etendue");
    for kilobytes in [60_000, 120_000, 300_000, 800_000] {
        let script = format!(
            "ulimit -v {kilobytes}; exec {program} run {} --threads 2 --photons 64 --quiet --out {}",
            scene("fig9b.ron").display(),
            folder.path().join("out").display()
        );
        let output = Command::new("sh").args(["-c", &script]).output().unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        let code = output.status.code();
        assert!(
            matches!(code, Some(0 | 1 | 4)) || code == Some(3) && message.contains("memory"),
            "{kilobytes} kB: {code:?} {message}"
        );
    }
}

/// If a signal arrives at any moment during start-up, no lock remains.
#[test]
fn a_signal_leaves_no_lock() {
    let folder = tempfile::tempdir().unwrap();
    for moment in 0..100 {
        let out = folder.path().join(moment.to_string());
        let mut child = etendue()
            .arg("run")
            .arg(scene("fig9b.ron"))
            .args(["--photons", "1e12", "--quiet", "--out"])
            .arg(&out)
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        while !out.exists() && child.try_wait().unwrap().is_none() {
            std::hint::spin_loop();
        }
        std::thread::sleep(Duration::from_micros(10 * moment));
        send("TERM", &child);
        assert_eq!(code(&mut child), Some(3));
        assert!(!out.join(".etendue.lock").exists(), "after {moment}0 µs");
    }
}

/// If no file can be opened at any moment of a run, the run ends, and leaves no lock.
#[test]
fn few_open_files_end_a_run() {
    let folder = tempfile::tempdir().unwrap();
    let program = env!("CARGO_BIN_EXE_etendue");
    let scene = scene("travel.ron");
    let mut failed = 0;
    for files in 4..=12 {
        let script = format!(
            "ulimit -n {files}; exec {program} run {} --photons 1000 --threads 1 --quiet --out {files}/out",
            scene.display(),
        );
        let mut command = Command::new("sh");
        let command = command.args(["-c", &script]).current_dir(folder.path());
        let mut child = command.stderr(Stdio::null()).spawn().unwrap();
        let code = code(&mut child);
        assert!(code.is_some(), "{files} open files: the run did not end");
        if code == Some(3) {
            failed += 1;
            let lock = folder.path().join(format!("{files}/out/.etendue.lock"));
            assert!(!lock.exists(), "{files} open files: {lock:?} stays");
        }
    }
    // Fewer files may suffice on other systems.
    assert!(failed > 0);
}
