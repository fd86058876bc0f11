//! Traces rays of files through a mesh, for `tests/peers/rays_per_second.py`.
//!
//!     cargo build --release -p etendue-paths --example rays_per_second
//!     rays_per_second MESH.ply < QUESTIONS
//!
//! Each input line is a command: `build` builds the hierarchy, and prints the processor seconds and
//! the bytes of memory that this takes. `first RAYS` finds the first hits, and `free RAYS` tests
//! whether rays hit anything before their end. `first` and `free` print the processor seconds of
//! this thread, and write distances (infinite for no hit, zero for `free` with a hit) to `RAYS.met`
//! as f64. Rays are seven f32 each: origin, direction, end.

#![allow(clippy::print_stdout, reason = "the example prints its results")]

use etendue_import::{Options, import};
use etendue_paths::{Ray, SceneGeometry};
use glam::DVec3;
use std::error::Error;
use std::io::BufRead;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let mesh = std::env::args()
        .nth(1)
        .ok_or("usage: rays_per_second MESH.ply")?;
    let world = import(Path::new(&mesh), &Options::default())
        .map_err(|refused| format!("{:?}", refused.causes))?
        .world;
    let mut built: Option<SceneGeometry> = None;
    for line in std::io::stdin().lock().lines() {
        let line = line?;
        match line.split_once(' ') {
            None => {
                drop(built.take());
                let (memory, start) = (resident()?, seconds()?);
                built = Some(SceneGeometry::new(&world));
                println!("{} {}", seconds()? - start, resident()? - memory);
            }
            Some((kind, file)) => {
                let space = built.as_ref().ok_or("a build line must come first")?;
                let rays = read(file)?;
                let mut met = Vec::with_capacity(rays.len());
                let start = seconds()?;
                match kind {
                    "free" => met.extend(rays.iter().map(|(ray, end)| {
                        if space.is_free(ray, *end) {
                            f64::INFINITY
                        } else {
                            0.0
                        }
                    })),
                    _ => met.extend(rays.iter().map(|(ray, end)| {
                        let hit = space.first(ray, [0.0, *end]);
                        hit.map_or(f64::INFINITY, |hit| hit.distance)
                    })),
                }
                let taken = seconds()? - start;
                let bytes: Vec<u8> = met.iter().flat_map(|t| t.to_le_bytes()).collect();
                std::fs::write(format!("{file}.met"), bytes)?;
                println!("{taken}");
            }
        }
    }
    Ok(())
}

/// Reads rays and their ends.
fn read(file: &str) -> Result<Vec<(Ray, f64)>, Box<dyn Error>> {
    let bytes = std::fs::read(file)?;
    let (numbers, _) = bytes.as_chunks::<4>();
    let numbers: Vec<f64> = numbers
        .iter()
        .map(|b| f32::from_le_bytes(*b).into())
        .collect();
    let (rays, _) = numbers.as_chunks::<7>();
    let ray = |[x, y, z, u, v, w, end]: &[f64; 7]| {
        let along = DVec3::new(*u, *v, *w).normalize();
        (
            Ray {
                from: DVec3::new(*x, *y, *z),
                along,
            },
            *end,
        )
    };
    Ok(rays.iter().map(ray).collect())
}

/// The processor seconds that all threads have used.
fn seconds() -> Result<f64, Box<dyn Error>> {
    let mut nanoseconds = 0.0;
    for task in std::fs::read_dir("/proc/self/task")? {
        let told = std::fs::read_to_string(task?.path().join("schedstat"))?;
        nanoseconds += told.split(' ').next().unwrap_or_default().parse::<f64>()?;
    }
    Ok(1e-9 * nanoseconds)
}

/// The memory in use, in bytes.
fn resident() -> Result<f64, Box<dyn Error>> {
    let status = std::fs::read_to_string("/proc/self/status")?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    let kilobytes = line.and_then(|line| line.split_whitespace().next());
    Ok(1024.0 * kilobytes.ok_or("no VmRSS")?.parse::<f64>()?)
}
