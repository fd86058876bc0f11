//! Makes tables of the differences between predictions and the truth over random scenes, in units
//! of the stated errors.

use super::draw::BlockerKind;
use super::scene::{Measured, SceneOutcome};
use crate::report::Bound::{AtLeast, Below};
use crate::report::{Check, ReportSection, Row, worse};
use crate::statistics::{mean, uniformity};

/// Permitted deviation of fractions and means, in standard errors.
const BORNE: f64 = 3.0;
/// Maximum permitted ratio of the L2 error to the stated error. If a prediction were a single real
/// number, a fraction 3·10⁻⁵ of all scenes would exceed this maximum.
const LARGEST: f64 = 5.0;
/// The mean square of a Student's t with 31 degrees of freedom.
const OF_ONE: f64 = 31.0 / 29.0;
/// The probabilities that |t| exceeds 1, 2 and 3, for Student's t with 31 degrees of freedom.
const STUDENT: [f64; 3] = [0.3251, 0.0543, 0.0053];
/// Number of scenes with the largest ratios that are listed.
const WORST: usize = 12;

/// The probability that the magnitude of a complex deviation exceeds `distance` stated
/// errors.
fn beyond(distance: f64) -> f64 {
    (1.0 + 2.0 * distance.powi(2) / 31.0).powi(-15)
}

/// A function that selects the quantity to judge from the outcome of a scene.
type Reading = fn(&SceneOutcome) -> &Measured;

/// All tables, including the tables of planted faults.
pub(super) fn sections(outcomes: &[SceneOutcome], left_out: usize) -> Vec<ReportSection> {
    let sound: Reading = |outcome| &outcome.sound;
    let all = judged(outcomes, sound, 1.0);
    let is_sound = all.passes();
    let mut sections = vec![all, by_kind(outcomes, left_out), worst(outcomes)];
    let faults: [(&str, Reading, f64); 3] = [
        ("Densities 2 % too large", |outcome| &outcome.planted, 1.0),
        ("Stated errors 20 % too small", sound, 0.8),
        ("Stated errors 25 % too large", sound, 1.25),
    ];
    for (title, reading, scale) in faults {
        let title = format!("Planted: {}", title.to_lowercase());
        let text = "A fault is planted, as the title says. Required: this table fails by the \
            bounds above.";
        sections.push(judged(outcomes, reading, scale).planted(title, text, is_sound));
    }
    sections
}

/// A function that returns whether a kind of scene belongs to a group.
type Belongs = fn(BlockerKind) -> bool;

/// The section on the fractions of deviations beyond 1, 2 and 3 stated errors, after the
/// errors are multiplied by `scale`.
fn judged(outcomes: &[SceneOutcome], reading: Reading, scale: f64) -> ReportSection {
    let mut rows = Vec::new();
    let groups: [(&str, Belongs); 3] = [
        ("all", |_| true),
        ("against closed forms", BlockerKind::is_chain),
        ("against more rays", |kind| !kind.is_chain()),
    ];
    for (name, belongs) in groups {
        let of_group = outcomes.iter().filter(|outcome| belongs(outcome.kind));
        let of_group: Vec<&Measured> = of_group.map(reading).collect();
        rows.push(row(name, &of_group, scale));
    }
    let [one, two, three] = [1.0, 2.0, 3.0].map(|d| 100.0 * beyond(d));
    let [a, b, c] = STUDENT.map(|share| 100.0 * share);
    ReportSection::new(
        format!("{} scenes", outcomes.len()),
        format!(
            "Each scene gives four complex numbers, and the real number at zero frequency. The \
             columns have the shares of these numbers that are more than 1, 2 and 3 standard \
             errors from the truth; ± is the standard error over the scenes, because the four \
             numbers of a scene may depend on each other. The shares expected beyond 1, 2 and 3 \
             are {one:.1}, {two:.2} and {three:.2} %; at zero frequency they are {a:.1}, {b:.1} \
             and {c:.2} %. Required: every share is within {BORNE} of its errors of the expected \
             share. The p-value of the first of the four numbers is uniform by Kolmogorov–Smirnov \
             at 1 % over the three groups. The mean square of the L2 ratios is within {BORNE} of \
             its errors of the range from 1 to {OF_ONE:.3}. No L2 ratio is above {LARGEST}. All \
             scenes have the same nets, and therefore their errors are correlated. The error of \
             the mean square includes this: it is the scatter of the mean square from 16 pairs of \
             nets. The errors of the shares do not include it."
        ),
        "group | scenes | d > 1 | d > 2 | d > 3 | at zero > 1 | at zero > 2 | at zero > 3 | KS p \
         of uniformity | mean square of L2 ratios",
        rows,
    )
}

/// The table row with the fractions for one group of scenes.
fn row(name: &str, of_group: &[&Measured], scale: f64) -> Row {
    let cells = vec![name.to_owned(), of_group.len().to_string()];
    let mut row = Row::new(cells, Vec::new());
    for distance in [1.0, 2.0, 3.0] {
        let of_scene = |measured: &&Measured| {
            let far = measured.apart.iter().filter(|d| **d / scale > distance);
            far.count() as f64 / measured.apart.len() as f64
        };
        let shares: Vec<f64> = of_group.iter().map(of_scene).collect();
        let numbers = (of_group.len() * of_group[0].apart.len()) as f64;
        put(&mut row, &shares, beyond(distance), numbers);
    }
    for (distance, expected) in [1.0, 2.0, 3.0].into_iter().zip(STUDENT) {
        let is_far = |measured: &&Measured| f64::from(measured.zero.abs() / scale > distance);
        let shares: Vec<f64> = of_group.iter().map(is_far).collect();
        put(&mut row, &shares, expected, of_group.len() as f64);
    }
    let p: Vec<f64> = of_group
        .iter()
        .map(|m| beyond(m.apart[0] / scale))
        .collect();
    let uniform = uniformity(&p);
    let squares: Vec<f64> = of_group.iter().map(|m| (m.ratio / scale).powi(2)).collect();
    let [square, over_scenes] = mean(&squares);
    let error = common(of_group, scale).max(over_scenes);
    let (slack, reason) = (BORNE * error, "expected from 1 to 31/29, within its errors");
    let largest = of_group.iter().map(|m| m.ratio / scale).fold(0.0, worse);
    row.checks.extend([
        Check::new("p", uniform, AtLeast(0.01 / 3.0)).because("1 % over all groups"),
        Check::new("square", square, AtLeast(1.0 - slack)).because(reason),
        Check::new("square", square, Below(OF_ONE + slack)).because(reason),
        Check::new("ratio", largest, Below(LARGEST))
            .because("a share of 3e-5 is beyond this by chance"),
    ]);
    row.cells.push(format!("{uniform:.3}"));
    row.cells.push(format!("{square:.3} ± {error:.3}"));
    row
}

/// The standard error of the squared deviation, averaged over scenes. It is estimated from
/// the scatter over pairs of nets, because all scenes use the same nets.
fn common(of_group: &[&Measured], scale: f64) -> f64 {
    let count = of_group[0].pairs.len();
    let squares = (0..count).map(|pair| {
        let of_scenes = of_group.iter().map(|m| m.pairs[pair] / (scale * scale));
        of_scenes.sum::<f64>() / of_group.len() as f64
    });
    let [_, error] = mean(&squares.collect::<Vec<_>>());
    error * (count as f64).sqrt()
}

/// Adds a fraction to a table row, with a check that it agrees with the fraction expected for
/// `count` numbers.
fn put(row: &mut Row, shares: &[f64], expected: f64, numbers: f64) {
    let [share, error] = mean(shares);
    // If few deviations exceed the distance, the error estimated from their scatter is
    // inaccurate.
    let error = error.max((expected * (1.0 - expected) / numbers).sqrt());
    let cell = format!("{:.2} ± {:.2} %", 100.0 * share, 100.0 * error);
    row.cells.push(cell);
    let off = (share - expected).abs() / error;
    row.checks
        .push(Check::new("share", off, Below(BORNE)).because("standard errors"));
}

/// The section with fractions and ratios for each kind of scene.
fn by_kind(outcomes: &[SceneOutcome], left_out: usize) -> ReportSection {
    let row = |(kind, name, _): (BlockerKind, &str, usize)| {
        let of_kind: Vec<&SceneOutcome> = outcomes.iter().filter(|o| o.kind == kind).collect();
        let mut ratios: Vec<f64> = of_kind.iter().map(|o| o.sound.ratio).collect();
        ratios.sort_by(f64::total_cmp);
        let share = |distance: f64| {
            let all = of_kind.iter().flat_map(|o| &o.sound.apart);
            let far = all.clone().filter(|d| **d > distance).count() as f64;
            format!("{:.1} %", 100.0 * far / all.count() as f64)
        };
        let squares: Vec<f64> = ratios.iter().map(|r| r * r).collect();
        let [square, error] = mean(&squares);
        let largest =
            |of: fn(&SceneOutcome) -> f64| of_kind.iter().map(|o| of(o)).fold(0.0, f64::max);
        let least = of_kind.iter().map(|o| o.stated).fold(f64::MAX, f64::min);
        let cells = vec![
            name.to_owned(),
            ratios.len().to_string(),
            share(1.0),
            share(2.0),
            share(3.0),
            format!(
                "{:.2}, {:.2}, {:.2}",
                ratios[0],
                ratios[ratios.len() / 2],
                ratios[ratios.len() - 1]
            ),
            format!("{square:.2} ± {error:.2}"),
            format!("{:.1e} to {:.1e}", least, largest(|o| o.stated)),
            format!("{:.3}", largest(|o| o.of_truth)),
        ];
        Row::new(cells, Vec::new())
    };
    ReportSection::new(
        "By kind of scene",
        format!(
            "The scenes are grouped by kind. {left_out} scenes were left out, because the error of \
             their truth is above a tenth of the stated error. This table has no requirements of \
             its own."
        ),
        "kind | scenes | d > 1 | d > 2 | d > 3 | L2 ratio: smallest, median, largest | mean square \
         of L2 ratios | stated errors | largest error of the truth, in stated errors",
        BlockerKind::ALL.into_iter().map(row),
    )
}

/// The section that lists the scenes with the largest ratios.
fn worst(outcomes: &[SceneOutcome]) -> ReportSection {
    let mut all: Vec<&SceneOutcome> = outcomes.iter().collect();
    all.sort_by(|a, b| b.sound.ratio.total_cmp(&a.sound.ratio));
    let row = |outcome: &&SceneOutcome| {
        let distances = outcome.sound.apart.iter().map(|d| format!("{d:.2}"));
        let cells = vec![
            outcome.number.to_string(),
            outcome.kind.name().to_owned(),
            format!("{:.2}", outcome.sound.ratio),
            format!("{:.1e}", outcome.stated),
            format!("{:+.2}", outcome.sound.zero),
            distances.collect::<Vec<_>>().join(", "),
        ];
        Row::new(cells, Vec::new())
    };
    ReportSection::new(
        "The scenes with the largest errors",
        "These are the scenes with the largest L2 ratios. The generator makes the same scene again \
         from its number. This table has no requirements of its own.",
        "number | kind | L2 ratio | stated error | deviation at zero, in errors | d of the four \
         numbers",
        all.iter().take(WORST).map(row),
    )
}
