//! Tests that thousands of mutated files do not make the reader panic, and that memory stays
//! within the bound of the crate.
//!
//! This test is a program of its own, so that the peak memory of the process is the memory that
//! reading takes.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use etendue_rayfile::{
    Format, MEMORY, MEMORY_FREE, PowerUnit, RayFile, RaySet, Wavelengths, convert,
};
use std::fs;

/// Random numbers from a seeded linear congruential generator (Knuth, MMIX).
struct Dice(u64);

impl Dice {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        usize::try_from((self.0 >> 33) % n as u64).unwrap()
    }
}

fn seeds() -> Vec<Vec<u8>> {
    let rays = 200_u32;
    let place = |i: u32| [f64::from(i), f64::from(i * i), -1.0];
    let set = RaySet {
        positions: (0..rays).map(place).collect(),
        directions: vec![[0.0, 0.6, 0.8]; rays as usize],
        powers: (0..rays).map(f64::from).collect(),
        unit: PowerUnit::Watt,
        wavelengths: Wavelengths::Spectrum(vec![[500e-9, 1.0], [600e-9, 0.5]]),
    };
    let of = |format| convert(&RayFile::Npy(set.clone()), format).unwrap().bytes;
    [Format::Npy, Format::Mcpl, Format::McplGz, Format::Tm25]
        .map(of)
        .to_vec()
}

/// A file with some changes: in a few bytes, in a few numbers, or in its length. Changes
/// are more frequent in the header than in rays.
fn mutate(seed: &[u8], dice: &mut Dice) -> Vec<u8> {
    let mut bytes = seed.to_vec();
    for _ in 0..=dice.below(4) {
        let near = [96, 300, bytes.len()][dice.below(3)].min(bytes.len());
        let at = dice.below(near.max(1));
        match dice.below(6) {
            0 => bytes.truncate(at),
            1 => bytes.extend(vec![0; dice.below(1000)]),
            2 if at < bytes.len() => bytes[at] ^= 1 << dice.below(8),
            3 if at + 4 <= bytes.len() => {
                let numbers = [
                    0,
                    1,
                    u32::MAX,
                    i32::MAX.cast_unsigned(),
                    65_535,
                    f32::NAN.to_bits(),
                    2,
                    1 << 20,
                ];
                let number = numbers[dice.below(8)];
                let at = at & !3;
                bytes[at..at + 4].copy_from_slice(&number.to_le_bytes());
            }
            4 if at + 8 <= bytes.len() => {
                let number = [u64::MAX, 1 << 40, 1 << 62, 201][dice.below(4)];
                bytes[at & !7..(at & !7) + 8].copy_from_slice(&number.to_le_bytes());
            }
            _ => {
                let end = at + dice.below(64).min(bytes.len() - at);
                bytes.drain(at..end);
            }
        }
        if bytes.is_empty() {
            break;
        }
    }
    bytes
}

/// The peak address space of the process, bytes; only Linux reports it.
fn peak() -> Option<usize> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmPeak:"))?;
    let kilobytes: usize = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(1024 * kilobytes)
}

fn read(bytes: &[u8]) -> bool {
    match RayFile::read(bytes) {
        Ok(file) => {
            let set = file.rays();
            for direction in &set.directions {
                let squared: f64 = direction.iter().map(|c| c * c).sum();
                assert!((squared - 1.0).abs() < 1e-4); // directions that were read are unit vectors
            }
            true
        }
        Err(fault) => {
            assert!(!fault.to_string().is_empty());
            false
        }
    }
}

#[test]
fn mutated_files_do_no_harm() {
    let seeds = seeds();
    let before = peak();
    let mut dice = Dice(1);
    let mut accepted = 0;
    let mut longest = 0;
    for case in 0..20_000 {
        let bytes = mutate(&seeds[case % seeds.len()], &mut dice);
        longest = longest.max(bytes.len());
        accepted += usize::from(read(&bytes));
    }
    assert!(
        accepted > 100,
        "{accepted} of 20000 were read: mutations are too wild"
    );
    // The file is so large that its length determines most of the bound. The bytes that any file
    // may take matter little.
    let large = large();
    assert!(read(&large));
    longest = longest.max(large.len());
    if let (Some(before), Some(after)) = (before, peak()) {
        let most = longest * (MEMORY + 1) + MEMORY_FREE; // and the file itself
        assert!(
            after - before <= most,
            "{} bytes for {longest}",
            after - before
        );
    }
}

/// 28 MB of the shortest possible records, 28 bytes each.
fn large() -> Vec<u8> {
    let mut bytes = b"MCPL003L".to_vec();
    let rays = 1_000_000_u64;
    bytes.extend(rays.to_le_bytes());
    for number in [0, 0, 0, 0, 1, 22, 28, 1_u32] {
        bytes.extend(number.to_le_bytes());
    }
    bytes.extend(1.0_f64.to_le_bytes());
    bytes.extend(0_u32.to_le_bytes());
    for ray in 0..u16::MAX {
        let energy = f32::from(ray);
        bytes.extend(
            [0.0, 0.0, 0.0, 0.0, 0.6, energy, 0.0]
                .iter()
                .flat_map(|v: &f32| v.to_le_bytes()),
        );
    }
    let record = bytes[bytes.len() - 28..].to_vec();
    for _ in u64::from(u16::MAX)..rays {
        bytes.extend(&record);
    }
    bytes
}
