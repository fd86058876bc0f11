//! The values that fields of a scene take in a sweep.

use etendue_field::tidy;
use etendue_scene::{Scene, dotted};
use etendue_store::{ArgumentStyle, Failure};

/// A field of the scene and its values.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// Path of the field.
    pub path: String,
    /// The values in order.
    pub values: Vec<f64>,
}

/// A field that is set to one value or swept.
#[derive(Clone, Debug, PartialEq)]
pub enum Setting {
    /// Path and value.
    Value(String, String),
    /// A swept field and its values.
    Sweep(Sweep),
}

/// A point of a sweep: the value of each swept field.
pub type SweepPoint = Vec<(String, f64)>;

/// The largest number of values of one field, and the largest total number of points.
const MAX_POINTS: usize = 1000;

/// Parses a `--set` argument of a sweep.
pub fn setting(text: &str) -> Result<Setting, String> {
    let (path, values) = text.split_once('=').ok_or("must be PATH=VALUE")?;
    setting_of(path, values, ArgumentStyle::Command)
}

/// The setting of a field to one or several values. `values` has the notation that `--set`
/// of a sweep accepts after `PATH=`.
pub fn setting_of(path: &str, values: &str, arguments: ArgumentStyle) -> Result<Setting, String> {
    let (path, values) = (dotted(path.trim()), values.trim().to_owned());
    let is_plain = !values.contains(['(', '[', '"']);
    let is_range = is_plain
        && values
            .split_once("..")
            .is_some_and(|(from, _)| !from.contains('/') && !from.is_empty());
    if is_range || is_list(&values) {
        let values = values_of(&values).map_err(|why| allowed(&why, arguments))?;
        return Ok(Setting::Sweep(Sweep { path, values }));
    }
    Ok(Setting::Value(path, values))
}

/// Checks whether a text has a comma outside of parentheses and quotes, which shows that it is a
/// list.
fn is_list(text: &str) -> bool {
    let (mut depth, mut quoted) = (0, false);
    text.chars().any(|c| {
        match c {
            '"' => quoted = !quoted,
            '(' | '[' if !quoted => depth += 1,
            ')' | ']' if !quoted => depth -= 1,
            _ => {}
        }
        c == ',' && depth == 0 && !quoted
    })
}

/// Parses an argument of the form `PATH=A..B:N` (evenly spaced), `PATH=A..B:Nlog` (spaced by equal
/// factors) or `PATH=A,B,C`.
pub fn sweep(text: &str) -> Result<Sweep, String> {
    let (path, values) = text
        .split_once('=')
        .ok_or_else(|| allowed("no field is named", ArgumentStyle::Command))?;
    Ok(Sweep {
        path: dotted(path.trim()),
        values: values_of(values).map_err(|why| allowed(&why, ArgumentStyle::Command))?,
    })
}

impl Sweep {
    /// The sweep of a field, if its values are finite and not too many. The error message
    /// uses the notation of the Python package.
    pub fn new(path: String, values: Vec<f64>) -> Result<Self, String> {
        let refused = |why: &str| {
            Err(format!(
                "in set, {path}: {}",
                allowed(why, ArgumentStyle::Python)
            ))
        };
        match values.iter().find(|value| !value.is_finite()) {
            Some(value) => refused(&format!("`{value}` is not a number")),
            None if !(1..=MAX_POINTS).contains(&values.len()) => {
                refused(&format!("there are {} values", values.len()))
            }
            None => Ok(Self {
                path: dotted(&path),
                values,
            }),
        }
    }
}

/// The values of a range or a list.
fn values_of(text: &str) -> Result<Vec<f64>, String> {
    match text.split_once("..") {
        None => text.split(',').map(number).collect(),
        Some((from, rest)) => range(from, rest),
    }
}

fn allowed(why: &str, arguments: ArgumentStyle) -> String {
    let forms = match arguments {
        ArgumentStyle::Command => {
            "PATH=A..B:N, PATH=A..B:Nlog (logarithmic spacing), or PATH=A,B,C"
        }
        ArgumentStyle::Python => "'A..B:N', 'A..B:Nlog' (logarithmic spacing), or a sequence",
    };
    format!("{why}; allowed: {forms}, with at most {MAX_POINTS} values, all of them numbers")
}

/// A finite number.
pub(crate) fn number(text: &str) -> Result<f64, String> {
    let number = text.trim().parse().ok().filter(|x: &f64| x.is_finite());
    number.ok_or_else(|| format!("`{}` is not a number", text.trim()))
}

/// The value of a field that is a real number. Messages begin with `argument`.
pub(crate) fn real_value(scene: &Scene, path: &str, argument: String) -> Result<f64, Failure> {
    let fault = |what: String| Failure::bad_input(format!("{argument}: {what}"));
    let value = scene.file.value(path).map_err(fault)?;
    let real = "allowed: fields that are real numbers";
    let number = value.as_f64();
    let number = number.ok_or_else(|| fault(format!("the value is {value}; {real}")))?;
    match value.is_f64() {
        true => Ok(number),
        false => Err(fault(format!("{value} is a whole number; {real}"))),
    }
}

/// Parses the values of a range from the text before and after the dots.
fn range(from: &str, rest: &str) -> Result<Vec<f64>, String> {
    let (to, count) = rest
        .split_once(':')
        .ok_or("the number of values, `:N`, is missing")?;
    let ends = [number(from)?, number(to)?];
    let (count, is_log) = match count.trim().strip_suffix("log") {
        Some(count) => (count, true),
        None => (count.trim(), false),
    };
    let wanted = count
        .trim()
        .parse()
        .ok()
        .filter(|n| (2..=MAX_POINTS).contains(n));
    let count = wanted.ok_or_else(|| {
        format!("`{count}` is not a whole number of values from 2 to {MAX_POINTS}")
    })?;
    if is_log && ends[0] * ends[1] <= 0.0 {
        return Err(
            "logarithmic spacing cannot include values of different signs or zero".to_owned(),
        );
    }
    Ok((0..count)
        .map(|i| between(ends, i, count, is_log))
        .collect())
}

/// Returns value `i` of `count` values between two ends, spaced by equal steps or equal factors.
/// The value is rounded to a short decimal.
fn between([from, to]: [f64; 2], i: usize, count: usize, is_log: bool) -> f64 {
    let share = i as f64 / (count - 1) as f64;
    let value = if is_log {
        from * libm::pow(to / from, share)
    } else {
        let value = (1.0 - share) * from + share * to;
        // A value that differs from zero only by rounding errors becomes zero.
        let is_zero = value.abs() < 1e-12 * from.abs().max(to.abs());
        if is_zero { 0.0 } else { value }
    };
    tidy(value).parse().unwrap_or(value)
}

/// The values at all points. Fields vary together, or in all combinations; in the
/// combinations, the last field varies fastest.
pub fn points(sweeps: &[Sweep], together: bool) -> Result<Vec<SweepPoint>, Failure> {
    let counts: Vec<usize> = sweeps.iter().map(|sweep| sweep.values.len()).collect();
    let at = |sweep: &Sweep, i: usize| (sweep.path.clone(), sweep.values[i]);
    if together {
        let count = counts.first().copied().unwrap_or(1);
        if counts.iter().any(|other| *other != count) {
            let message = format!(
                "fields that vary together must have the same number of values, not {counts:?}"
            );
            return Err(Failure::bad_input(message));
        }
        return Ok((0..count)
            .map(|i| sweeps.iter().map(|sweep| at(sweep, i)).collect())
            .collect());
    }
    let all = counts
        .iter()
        .try_fold(1, |all: usize, n| all.checked_mul(*n));
    if all.is_none_or(|all| all > MAX_POINTS) {
        let message = format!("a sweep has at most {MAX_POINTS} points in all");
        return Err(Failure::bad_input(message));
    }
    let one = vec![SweepPoint::new()];
    Ok(sweeps.iter().fold(one, |points, sweep| {
        let longer = |point: &SweepPoint| {
            let values = (0..sweep.values.len()).map(|i| at(sweep, i));
            let longer = values.map(|value| [point.as_slice(), &[value]].concat());
            longer.collect::<Vec<_>>()
        };
        points.iter().flat_map(longer).collect()
    }))
}

/// A message, and the name of the point that it concerns.
pub fn message_at(point: &SweepPoint, text: String) -> String {
    if point.is_empty() || text.contains(&shown(point)) {
        text
    } else {
        format!("{}: {text}", shown(point))
    }
}

/// A description of a point.
pub fn shown(point: &SweepPoint) -> String {
    let parts = point.iter().map(|(path, x)| format!("{path}={}", tidy(*x)));
    parts.collect::<Vec<_>>().join(", ")
}

/// A short end of a path that still identifies the field: `Ggx` for
/// `surfaces.0.event.Reflects.brdf.lobe.Ggx`, and `center.0` for `light.center.0`.
pub fn short(path: &str) -> &str {
    let is_number = |part: &str| part.bytes().all(|c| c.is_ascii_digit());
    let name = path
        .rsplit('.')
        .position(|part| !is_number(part))
        .unwrap_or(0);
    let mut dots = path.rmatch_indices('.').map(|(at, _)| at + 1);
    dots.nth(name).map_or(path, |at| &path[at..])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_field_is_known_by_the_end_of_its_path() {
        for (path, name) in [
            ("surfaces.0.event.Reflects.brdf.lobe.Ggx", "Ggx"),
            ("light.center.0", "center.0"),
            ("planes.0.at.Distance", "Distance"),
            ("radiance", "radiance"),
            ("0", "0"),
        ] {
            assert_eq!(short(path), name);
        }
    }

    fn values(text: &str) -> Option<Vec<f64>> {
        sweep(&format!("a.b={text}")).ok().map(|sweep| sweep.values)
    }

    #[test]
    fn values_are_spread_as_people_write_them() {
        assert_eq!(
            values("0.05..0.4:8"),
            Some(vec![0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4])
        );
        assert_eq!(values("1..1000:4log"), Some(vec![1.0, 10.0, 100.0, 1000.0]));
        assert_eq!(values("-4..-1:3log"), Some(vec![-4.0, -2.0, -1.0]));
        assert_eq!(values("3, 1e-2"), Some(vec![3.0, 0.01]));
        assert_eq!(values(".5..-.5:3"), Some(vec![0.5, 0.0, -0.5]));
        assert_eq!(values("-0.1..0.2:4"), Some(vec![-0.1, 0.0, 0.1, 0.2]));
        for wrong in [
            "0..1",
            "0..1:0",
            "0..1:1001",
            "0..1:3log",
            "a..1:3",
            "1,x",
            "NaN,1",
            "",
        ] {
            assert_eq!(values(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn what_is_no_range_is_a_value() {
        let value = |text: &str| matches!(setting(text), Ok(Setting::Value(..)));
        assert!(value("a=1") && value("a=(1,2)") && value("a=File(\"../b.ply\")"));
        assert!(value("a=../b.ply") && value("a=\"x,y\"") && value("a=Box(0.3)"));
        assert!(matches!(setting("a=1,2"), Ok(Setting::Sweep(_))));
        let why = |text: &str| setting(text).unwrap_err();
        assert!(why("a=0.1,,0.2").starts_with("`` is not a number"));
        assert!(why("a=Box(0.3),Hann(0.3)").starts_with("`Box(0.3)` is not a number"));
        assert!(why("a=0.1..x:3").starts_with("`x` is not a number"));
        assert!(why("a=-1..1:3log").starts_with("logarithmic spacing"));
        assert!(
            setting("a=0.1..0.4").is_err(),
            "a range without a number of values"
        );
    }

    #[test]
    fn several_sweeps_are_combined_or_go_in_step() {
        let sweeps = [sweep("a=1,2").unwrap(), sweep("b=3,4").unwrap()];
        let all = |together| -> Vec<[f64; 2]> {
            let points = points(&sweeps, together).unwrap();
            points.iter().map(|p| [p[0].1, p[1].1]).collect()
        };
        assert_eq!(all(false), [[1.0, 3.0], [1.0, 4.0], [2.0, 3.0], [2.0, 4.0]]);
        assert_eq!(all(true), [[1.0, 3.0], [2.0, 4.0]]);
        let uneven = [sweep("a=1,2").unwrap(), sweep("b=3,4,5").unwrap()];
        assert!(points(&uneven, true).is_err());
        assert_eq!(points(&uneven, false).unwrap().len(), 6);
    }
}
