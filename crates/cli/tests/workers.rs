//! Tests several processes that share one job. In these tests, threads simulate the processes, and
//! exchange bytes as MPI ranks do.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common::{call, files, small};
use etendue::command_of_workers;
use etendue_pipeline::Workers;
use std::ffi::OsString;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;

type Message = (usize, Vec<u8>);

/// A worker process that is simulated by a thread.
struct Member {
    number: usize,
    to: Vec<Sender<Message>>,
    inbox: Mutex<Receiver<Message>>,
    /// The number of messages that this process has sent.
    sent: AtomicUsize,
}

impl Workers for Member {
    fn number(&self) -> usize {
        self.number
    }

    fn count(&self) -> usize {
        self.to.len()
    }

    fn send(&self, to: usize, bytes: &[u8]) -> Result<(), String> {
        self.sent.fetch_add(1, Ordering::Relaxed);
        let message = (self.number, bytes.to_vec());
        self.to[to].send(message).map_err(|e| e.to_string())
    }

    fn receive(&self) -> Result<Message, String> {
        self.inbox.lock().unwrap().recv().map_err(|e| e.to_string())
    }
}

/// Runs the command lines `lines`, each in its own process. Returns the exit code of the first
/// process, and how many messages each other process has sent.
fn in_crew_of(lines: &[String]) -> (u8, Vec<usize>) {
    let (to, inboxes): (Vec<_>, Vec<_>) = lines.iter().map(|_| channel()).unzip();
    let members = inboxes.into_iter().enumerate();
    let members: Vec<Member> = members
        .map(|(number, inbox)| Member {
            number,
            to: to.clone(),
            inbox: Mutex::new(inbox),
            sent: AtomicUsize::new(0),
        })
        .collect();
    let codes: Vec<u8> = thread::scope(|scope| {
        let begin = |number: usize| {
            let words: Vec<OsString> = lines[number].split(' ').map(OsString::from).collect();
            let member = &members[number];
            scope.spawn(move || command_of_workers(words, member))
        };
        let others: Vec<_> = (1..lines.len()).map(begin).collect();
        // The leader begins after the other processes have reported; otherwise it would finish
        // the small amount of work alone.
        for (member, process) in members[1..].iter().zip(&others) {
            while member.sent.load(Ordering::Relaxed) == 0 && !process.is_finished() {
                thread::yield_now();
            }
        }
        let processes = std::iter::once(begin(0)).chain(others);
        processes.map(|p| p.join().unwrap()).collect()
    });
    let sent = members[1..].iter();
    (
        codes[0],
        sent.map(|m| m.sent.load(Ordering::Relaxed)).collect(),
    )
}

/// Checks that `lines`, run on several processes, write the same files as `line` run alone,
/// except for times.
fn same_files(path: &Path, line: &str, processes: usize) -> Vec<usize> {
    let scene = path.join("small.ron").display().to_string();
    let with = |out: &str| {
        let line = line.replace("SCENE", &scene);
        line.replace("OUT", &path.join(out).display().to_string())
    };
    let alone = call(path, &with("alone"));
    let lines = vec![format!("etendue {} --quiet", with("workers")); processes];
    let (code, sent) = in_crew_of(&lines);
    assert_eq!(Some(i32::from(code)), alone.status.code(), "{alone:?}");
    let [alone, workers] = ["alone", "workers"].map(|out| {
        let mut files = files(&path.join(out));
        files.remove("timing.json");
        files
    });
    assert_eq!(
        alone.keys().collect::<Vec<_>>(),
        workers.keys().collect::<Vec<_>>()
    );
    for (name, bytes) in &alone {
        assert!(workers[name] == *bytes, "{name} has other bytes");
    }
    sent
}

#[test]
fn runs_predictions_and_sweeps_have_the_bytes_of_one_process() {
    for line in [
        "run SCENE --threads 1 --photons 2^16 --out OUT",
        "run SCENE --threads 1 --photons 2^16 --set blockers.0.pitch=0.21 --against SCENE --out OUT",
        "predict SCENE --threads 1 --photons 2^16 --out OUT",
        "sweep SCENE --threads 1 --photons 4096 --set blockers.0.pitch=0.05..0.2:4 --out OUT",
    ] {
        // The next piece of work goes to the first process that is ready. On a busy machine, some
        // processes may get no work; the test then repeats the run.
        let helped = (0..20).any(|_| {
            let sent = same_files(small().path(), line, 3);
            // A process reports its presence with one message, and answers each order with one
            // message.
            sent.iter().sum::<usize>() > 2
        });
        assert!(helped, "{line}: nobody helped");
    }
}

#[test]
fn processes_with_other_scenes_are_refused() {
    let folder = small();
    let path = folder.path().join("small.ron").display().to_string();
    let out = folder.path().join("out").display().to_string();
    // With this number of photons, the second process reports before the first process has
    // finished alone.
    let line = |seed| {
        format!("etendue run {path} --quiet --threads 1 --photons 2^21 --seed {seed} --out {out}")
    };
    let (code, _) = in_crew_of(&[line(1), line(2)]);
    assert_eq!(code, 3);
    assert!(!Path::new(&out).join("summary.json").exists());
}

#[test]
fn what_is_not_for_several_is_refused() {
    let folder = small();
    let path = folder.path().join("small.ron").display().to_string();
    let lines = [
        format!("etendue check {path}"),
        format!("etendue check {path}"),
    ];
    assert_eq!(in_crew_of(&lines).0, 2);
}
