//! Statistical validation: `cargo run --release -p etendue-validation -- --help`.

mod noise;
mod report;
mod scenes;
mod statistics;

fn main() {
    let t = std::time::Instant::now();
    let n: u64 = std::env::args().nth(1).and_then(|s| s.parse().ok()).unwrap_or(1_000_000);
    println!("{}", noise::planes(n, 1).markdown());
    println!("{:?}", t.elapsed());
    println!("{}", noise::parameters(n, 1).markdown());
    println!("{:?}", t.elapsed());
}
