//! Checks that the stated errors of predictions by nets of rays equal the actual errors, over
//! random scenes.

mod draw;
mod judge;
mod scene;

use std::fs;
use std::process::ExitCode;

/// Returns the text of the scene with the given number; the kinds of scenes alternate with the
/// number.
pub(crate) fn scene(number: u64) -> String {
    let kinds = draw::BlockerKind::ALL;
    let (kind, _) = kinds[usize::try_from(number).unwrap_or_default() % kinds.len()];
    draw::scene(kind, &mut draw::SceneDice::new(number))
}

/// Draws and predicts the random scenes, prints the results, and writes results/nets.md.
#[expect(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "the report is the product"
)]
pub(crate) fn page() -> ExitCode {
    let (outcomes, left_out) = scene::outcomes(|outcome| {
        eprintln!(
            "{} {}: {:.2} stated errors of {:.1e}",
            outcome.number,
            outcome.kind.name(),
            outcome.sound.ratio,
            outcome.stated
        );
    });
    let sections = judge::sections(&outcomes, left_out);
    let text: Vec<String> = sections.iter().map(|section| section.markdown()).collect();
    let text = text.join("\n");
    println!("{text}");
    if let Err(error) = fs::write("results/nets.md", format!("{HEAD}{text}")) {
        eprintln!("results/nets.md: {error}");
        return ExitCode::from(3);
    }
    ExitCode::from(u8::from(!sections.iter().all(|section| section.passes())))
}

const HEAD: &str = "\
# Errors stated are errors made

Written by `cargo run --release -p etendue-validation -- nets`.

What has no closed form is predicted by 32 independent scrambled nets of rays, and the spread of \
their sums is the error that is stated. Here the true error is known: \
scenes are drawn at random from the words of scene files, and predicted with 65,536 to 262,144 \
rays, half of them until the stated error is 0.5 %. Scenes with light between \
parallel planes are held against closed forms, which share nothing with the nets. The others are \
held against up to 128 times as many rays of the same nets, \
so that only a scatter that is stated wrongly shows there, not a factor that all rays lack. \
Drawn again, 17 of 217, are scenes that theory leaves to a reference, dark ones, those with a \
stated error above 30 %, and those that a rule predicts instead of nets.

The distance of a complex number from the truth is counted in standard errors by Hotelling's T², \
from the 2 × 2 covariance of real and imaginary part over the replicates: \
d = √(T²/2), which is |F − truth|/σ where noise is the same in all phases. Of 32 normal \
replicates a share of (1 + 2d²/31)⁻¹⁵ is beyond d. \
At zero frequency numbers are real, and follow Student's law with 31 degrees of freedom. \
The L2 ratio is ‖F − truth‖/‖truth‖ over the error that is stated; its mean square is expected \
between 1 (many frequencies with errors of their own) \
and 31/29 (one real number).

Planted by hand, once: with `nets::Density::value` 2 % too large, so that rays drawn by windows \
weigh too little, this failed. Against closed forms 42.5 % of the numbers \
were beyond 3 standard errors (expected: 0.1 %), and the mean square of L2 ratios was 1300. \
Against more rays of the same nets nothing was seen, as nothing can be.

";
