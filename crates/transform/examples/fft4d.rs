//! Times the 4D real transform, or transforms a file. This program is the counterpart of
//! `tests/peers/fft4d.py`.
//!
//!     cargo run --release -p etendue-transform --example fft4d -- time 64 [ROUNDS] [THREADS]
//!     cargo run --release -p etendue-transform --example fft4d -- serve 64 kept|fresh
//!     cargo run --release -p etendue-transform --example fft4d -- file NX NY NU NV IN OUT
//!
//! For each line of its input, `serve` performs one transform and prints the milliseconds that it
//! takes. At the end of the input, `serve` prints its peak memory in megabytes. `file` reads and
//! writes raw little-endian f64.

#![allow(clippy::print_stdout, reason = "its purpose")]

use etendue_field::Complex;
use etendue_transform::{RealFft4, real_mut};
use std::io::{BufRead, Write};
use std::time::Instant;

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments[..] {
        ["time", n, ref more @ ..] => {
            let number = |i: usize, default| more.get(i).map_or(Ok(default), |s| s.parse());
            time(n.parse()?, number(0, 9)?, number(1, 2)?)
        }
        ["serve", n, memory] => serve(n.parse()?, memory),
        ["file", nx, ny, nu, nv, from, to] => {
            let shape = [nx.parse()?, ny.parse()?, nu.parse()?, nv.parse()?];
            file(shape, from, to)
        }
        _ => Err("see the head of this file for the arguments".into()),
    }
}

/// A transform with its input, n⁴ reals, and the memory it uses.
struct Job {
    plan: RealFft4,
    input: Vec<f64>,
    place: Vec<Complex>,
    /// Whether each transform uses newly allocated memory.
    fresh: bool,
}

impl Job {
    fn new(n: usize, fresh: bool) -> Self {
        let plan = RealFft4::new([n; 4]);
        let value = |i: usize| (i as f64 * 0.618_033_988_749_895).fract() - 0.5;
        Self {
            input: (0..n.pow(4)).map(value).collect(),
            place: Vec::new(),
            plan,
            fresh,
        }
    }

    /// The milliseconds of one transform. If `fresh` is set, they include the time to
    /// allocate and fill new memory; otherwise the transform uses existing memory.
    fn run(&mut self) -> f64 {
        if self.fresh {
            self.place = Vec::new();
        } else {
            self.fill();
        }
        let start = Instant::now();
        if self.fresh {
            self.place = self.plan.padded(&self.input);
        }
        self.plan.forward(&mut self.place);
        let seconds = start.elapsed().as_secs_f64();
        std::hint::black_box(&self.place);
        seconds * 1e3
    }

    fn fill(&mut self) {
        if self.place.is_empty() {
            self.place = self.plan.padded(&self.input);
        }
        let [.., n] = self.plan.shape();
        let rows = self.place.chunks_exact_mut(self.plan.row());
        for (row, reals) in rows.zip(self.input.chunks_exact(n)) {
            for (l, value) in reals.iter().enumerate() {
                *real_mut(row, l) = *value;
            }
        }
    }
}

/// The peak memory of this process so far, in megabytes.
fn peak() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kilobytes = line.and_then(|line| line.trim().trim_end_matches(" kB").parse::<f64>().ok());
    kilobytes.unwrap_or(f64::NAN) / 1e3
}

fn time(n: usize, rounds: usize, threads: usize) -> Result<(), Failure> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build_global()?;
    for fresh in [false, true] {
        let mut job = Job::new(n, fresh);
        job.run();
        let milliseconds = median((0..rounds).map(|_| job.run()).collect());
        let memory = if fresh { "fresh" } else { "kept" };
        println!("{n}^4, memory {memory}: {milliseconds:.1} ms");
    }
    println!("peak {:.0} MB", peak());
    Ok(())
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn serve(n: usize, memory: &str) -> Result<(), Failure> {
    let mut job = Job::new(n, memory == "fresh");
    job.run();
    for line in std::io::stdin().lock().lines() {
        line?;
        println!("{}", job.run());
        std::io::stdout().flush()?;
    }
    println!("{}", peak());
    Ok(())
}

fn file(shape: [usize; 4], from: &str, to: &str) -> Result<(), Failure> {
    let plan = RealFft4::new(shape);
    let bytes = std::fs::read(from)?;
    let reals: Vec<f64> = bytes
        .as_chunks()
        .0
        .iter()
        .map(|eight| f64::from_le_bytes(*eight))
        .collect();
    let mut data = plan.padded(&reals);
    plan.forward(&mut data);
    let numbers = data.iter().flat_map(|z| [z.re, z.im]);
    Ok(std::fs::write(
        to,
        numbers.flat_map(f64::to_le_bytes).collect::<Vec<u8>>(),
    )?)
}
