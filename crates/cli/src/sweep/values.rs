//! The values that fields of a scene take in a sweep.

use crate::failure::Failure;
use etendue_field::tidy;

/// A field of the scene and its values.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Sweep {
    pub(crate) path: String,
    pub(crate) values: Vec<f64>,
}

/// A field set to one value, or swept.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Setting {
    Value(String, String),
    Sweep(Sweep),
}

/// The value of each field that is swept.
pub(crate) type Point = Vec<(String, f64)>;

/// Values of one sweep, and points of all together.
const MOST: usize = 1000;

/// What `--set` of a sweep takes.
pub(crate) fn setting(text: &str) -> Result<Setting, String> {
    let (path, values) = text.split_once('=').ok_or("must be PATH=VALUE")?;
    let first = values.split([',', '.']).next().unwrap_or_default();
    let is_range = values.contains("..") && number(first).is_ok();
    let is_list = values.contains(',') && values.split(',').all(|value| number(value).is_ok());
    if is_range || is_list {
        return sweep(text).map(Setting::Sweep);
    }
    let [path, value] = [path, values].map(|part| part.trim().to_owned());
    Ok(Setting::Value(path, value))
}

/// `PATH=A..B:N`, evenly spaced, `PATH=A..B:Nlog`, by equal factors, or `PATH=A,B,C`.
pub(crate) fn sweep(text: &str) -> Result<Sweep, String> {
    const ALLOWED: &str = "must be PATH=A..B:N, PATH=A..B:Nlog with A and B of one sign, or PATH=A,B,C: \
                           numbers, and 1 to 1000 values";
    let fault = || ALLOWED.to_owned();
    let (path, values) = text.split_once('=').ok_or_else(fault)?;
    let values = match values.split_once("..") {
        None => values.split(',').map(number).collect::<Result<_, _>>(),
        Some((from, rest)) => {
            let (to, count) = rest.split_once(':').ok_or_else(fault)?;
            let (count, is_log) = match count.strip_suffix("log") {
                Some(count) => (count, true),
                None => (count, false),
            };
            let count = count.trim().parse().map_err(|_| fault())?;
            let ends = [
                number(from).map_err(|()| fault())?,
                number(to).map_err(|()| fault())?,
            ];
            spread(ends, count, is_log)
        }
    };
    let values = values
        .ok()
        .filter(|values| (1..=MOST).contains(&values.len()));
    Ok(Sweep {
        path: path.trim().to_owned(),
        values: values.ok_or_else(fault)?,
    })
}

fn number(text: &str) -> Result<f64, ()> {
    let number = text.trim().parse().map_err(|_| ())?;
    if f64::is_finite(number) {
        Ok(number)
    } else {
        Err(())
    }
}

/// `count` values from one end to the other, by equal steps or equal factors, as people write them.
fn spread([from, to]: [f64; 2], count: usize, is_log: bool) -> Result<Vec<f64>, ()> {
    if count > MOST || is_log && from * to <= 0.0 {
        return Err(());
    }
    let value = |i: usize| {
        let share = if count > 1 {
            i as f64 / (count - 1) as f64
        } else {
            0.0
        };
        let value = if is_log {
            from * libm::pow(to / from, share)
        } else {
            (1.0 - share) * from + share * to
        };
        tidy(value).parse().map_err(|_| ())
    };
    (0..count).map(value).collect()
}

/// The points of all sweeps: in step, or all combinations, the last field fastest.
pub(crate) fn points(sweeps: &[Sweep], together: bool) -> Result<Vec<Point>, Failure> {
    let counts = sweeps.iter().map(|sweep| sweep.values.len());
    let at = |sweep: &Sweep, i: usize| (sweep.path.clone(), sweep.values[i]);
    if together {
        let count = counts.clone().next().unwrap_or(1);
        if counts.clone().any(|other| other != count) {
            let message = "sweeps that go in step must have the same number of values";
            return Err(Failure::bad_input(message));
        }
        return Ok((0..count)
            .map(|i| sweeps.iter().map(|sweep| at(sweep, i)).collect())
            .collect());
    }
    if counts.map(|n| n as f64).product::<f64>() > MOST as f64 {
        let message = format!("a sweep has at most {MOST} points in all");
        return Err(Failure::bad_input(message));
    }
    let one = vec![Point::new()];
    Ok(sweeps.iter().fold(one, |points, sweep| {
        let longer = |point: &Point| {
            let values = (0..sweep.values.len()).map(|i| at(sweep, i));
            let longer = values.map(|value| [point.as_slice(), &[value]].concat());
            longer.collect::<Vec<_>>()
        };
        points.iter().flat_map(longer).collect()
    }))
}

/// A text about a point, which it then names.
pub(crate) fn said_at(point: &Point, text: String) -> String {
    if point.is_empty() || text.contains(&shown(point)) {
        text
    } else {
        format!("{}: {text}", shown(point))
    }
}

/// A point, for texts.
pub(crate) fn shown(point: &Point) -> String {
    let parts = point.iter().map(|(path, x)| format!("{path}={}", tidy(*x)));
    parts.collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

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
        assert_eq!(values("2..5:1"), Some(vec![2.0]));
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
        assert!(matches!(setting("a=1,2"), Ok(Setting::Sweep(_))));
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
