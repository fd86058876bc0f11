//! Checks that the stated errors of predictions by nets of rays equal the actual errors, over
//! random scenes.

mod draw;
mod judge;
mod scene;

use std::fs;
use std::process::ExitCode;

/// The text of the scene with the given number; the kinds of scenes alternate with the
/// number.
pub(crate) fn scene(number: u64) -> String {
    let kinds = draw::BlockerKind::ALL;
    let (kind, ..) = kinds[usize::try_from(number).unwrap_or_default() % kinds.len()];
    draw::scene(kind, &mut draw::dice(number))
}

/// Draws and predicts the random scenes, prints the results, and writes results/nets.md.
#[expect(clippy::print_stderr, reason = "the report is the product")]
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
    let text = crate::shown(&sections);
    if let Err(error) = fs::write("results/nets.md", format!("{HEAD}{text}")) {
        eprintln!("results/nets.md: {error}");
        return ExitCode::from(3);
    }
    crate::judged(&sections)
}

const HEAD: &str = "\
# Stated errors are true errors

Written by `cargo run --release -p etendue-validation -- nets`.

A prediction without a closed form is computed with 32 independent scrambled nets of rays, and \
its stated error is the spread of their sums. This page compares the stated error with the true \
error. Scenes are drawn at random from the vocabulary of scene files, and they are predicted \
with 65,536 to 262,144 rays; half of them stop when the stated error is 0.5 %. Scenes with light \
between parallel planes are compared with closed forms, which share nothing with the nets. The \
other scenes are compared with up to 128 times as many rays of the same nets. This comparison \
shows only a scatter that is stated wrongly; it does not show a factor that all rays lack. Some \
scenes (17 of 217) were drawn again: scenes that theory leaves to a reference, dark scenes, \
scenes with a stated error above 30 %, and scenes that a rule predicts instead of nets.

The distance d of a complex number F from the truth is counted in standard errors. It follows \
from Hotelling's T², with the 2 × 2 covariance of real and imaginary part over the replicates: d \
= √(T²/2). This is |F − truth|/σ if the noise is the same in all phases. For 32 normal \
replicates, a share of (1 + 2d²/31)⁻¹⁵ of all numbers is beyond d. At zero frequency, numbers \
are real and follow Student's law with 31 degrees of freedom. The L2 ratio is ‖F − \
truth‖/‖truth‖ over the stated error. Its mean square is expected between 1 (many frequencies \
with errors of their own) and 31/29 (one real number).

Once, a fault was planted by hand: `nets::Density::value` was 2 % too large, so that rays drawn \
by windows had too little weight, and this validation failed. Against closed forms, 42.5 % of \
the numbers were beyond 3 standard errors (expected: 0.1 %), and the mean square of L2 ratios \
was 1300. The comparison with more rays of the same nets showed nothing, and it cannot show such \
a fault.

";
