//! Python keyword arguments, with checks of their values.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::fmt::Display;
use std::ops::RangeInclusive;
use std::path::PathBuf;

/// The keyword arguments of a caller. An argument that is left out or `None` keeps its default.
pub(crate) struct Arguments<'a, 'py>(pub(crate) &'a Bound<'py, PyDict>);

/// Returns the exception for a value that is not allowed.
pub(crate) fn wrong(name: &str, value: &Bound<'_, PyAny>, allowed: impl Display) -> PyErr {
    let shown = value
        .repr()
        .map_or_else(|_| "?".to_owned(), |r| r.to_string());
    PyValueError::new_err(format!("{name} is {shown}; allowed: {allowed}"))
}

/// Reads a whole number, which may be a Python float such as 1e6.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the value was checked to be a whole number that f64 holds exactly"
)]
fn whole_float(value: &Bound<'_, PyAny>) -> Option<u64> {
    let number: f64 = value.extract().ok()?;
    ((0.0..=9.0e15).contains(&number) && number.fract() == 0.0).then_some(number as u64)
}

impl<'py> Arguments<'_, 'py> {
    /// Returns the value of an argument, unless it is left out or `None`.
    pub(crate) fn get(&self, name: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
        Ok(self.0.get_item(name)?.filter(|value| !value.is_none()))
    }

    /// Sets `to` to the value of an argument, if it is given.
    fn set<T>(
        &self,
        name: &str,
        to: &mut T,
        allowed: impl Display,
        parse: impl FnOnce(&Bound<'py, PyAny>) -> Option<T>,
    ) -> PyResult<()> {
        if let Some(value) = self.get(name)? {
            *to = parse(&value).ok_or_else(|| wrong(name, &value, allowed))?;
        }
        Ok(())
    }

    /// Reads a whole number.
    pub(crate) fn whole<T: TryFrom<u64>>(
        &self,
        name: &str,
        range: &RangeInclusive<u64>,
        to: &mut T,
    ) -> PyResult<()> {
        let (least, most) = (range.start(), range.end());
        let allowed = format!("a whole number from {least} to {most}");
        self.set(name, to, allowed, |value| {
            let number: Option<u64> = value.extract().ok();
            T::try_from(number.filter(|n| range.contains(n))?).ok()
        })
    }

    /// Reads a whole number that has no default.
    pub(crate) fn given(&self, name: &str, range: &RangeInclusive<u64>) -> PyResult<Option<u32>> {
        let mut number = 0;
        self.whole(name, range, &mut number)?;
        Ok(self.get(name)?.map(|_| number))
    }

    /// Reads a number of rays, which may be a float such as 1e6.
    pub(crate) fn count(
        &self,
        name: &str,
        range: &RangeInclusive<u64>,
        to: &mut u64,
    ) -> PyResult<()> {
        let allowed = format!(
            "a whole number of {} or more, such as 1e6 or 2**20",
            range.start()
        );
        self.set(name, to, allowed, |value| {
            let number: Option<u64> = value.extract().ok();
            number
                .or_else(|| whole_float(value))
                .filter(|n| range.contains(n))
        })
    }

    /// Reads a floating-point number.
    pub(crate) fn number(
        &self,
        name: &str,
        allowed: &str,
        is_allowed: impl FnOnce(&f64) -> bool,
        to: &mut f64,
    ) -> PyResult<()> {
        self.set(name, to, allowed, |value| {
            value.extract().ok().filter(is_allowed)
        })
    }

    /// Reads a truth value.
    pub(crate) fn flag(&self, name: &str, to: &mut bool) -> PyResult<()> {
        self.set(name, to, "True or False", |value| value.extract().ok())
    }

    /// Reads a text.
    pub(crate) fn text(&self, name: &str, to: &mut Option<String>) -> PyResult<()> {
        self.set(name, to, "a text", |value| value.extract().ok().map(Some))
    }

    /// Reads a file or a folder.
    pub(crate) fn path(&self, name: &str, to: &mut Option<PathBuf>) -> PyResult<()> {
        self.set(name, to, "a path", |value| value.extract().ok().map(Some))
    }

    /// Sets `to` to the value whose name the argument states.
    pub(crate) fn one_of<T: Copy>(
        &self,
        name: &str,
        all: &[(&str, T)],
        to: &mut T,
    ) -> PyResult<()> {
        let names: Vec<String> = all.iter().map(|(name, _)| format!("'{name}'")).collect();
        self.set(name, to, names.join(", "), |value| {
            let word: String = value.extract().ok()?;
            let found = all.iter().find(|(name, _)| *name == word);
            found.map(|(_, value)| *value)
        })
    }

    /// Reads three coordinates.
    pub(crate) fn point(&self, name: &str, limit: f64) -> PyResult<Option<[f64; 3]>> {
        let mut point = None;
        let allowed = format!("three numbers within ±{limit:e}, such as (0, 1.5, -4)");
        self.set(name, &mut point, allowed, |value| {
            let numbers = value.try_iter().ok()?;
            let numbers = numbers.map(|number| number.ok()?.extract().ok());
            let point: [f64; 3] = numbers.collect::<Option<Vec<_>>>()?.try_into().ok()?;
            point
                .iter()
                .all(|x| x.abs() <= limit)
                .then_some(Some(point))
        })?;
        Ok(point)
    }

    /// Reads a width and a height in pixels, from two numbers or from text such as 64x48.
    pub(crate) fn size(
        &self,
        name: &str,
        range: &RangeInclusive<u64>,
        to: &mut Option<[usize; 2]>,
    ) -> PyResult<()> {
        let (least, most) = (range.start(), range.end());
        let allowed =
            format!("two whole numbers from {least} to {most}, such as (64, 48) or '64x48'");
        self.set(name, to, allowed, |value| {
            let sides: [u64; 2] = match value.extract::<String>() {
                Ok(text) => {
                    let (w, h) = text.split_once('x')?;
                    [w.parse().ok()?, h.parse().ok()?]
                }
                Err(_) => value.extract().ok()?,
            };
            let is_allowed = sides.iter().all(|side| range.contains(side));
            let [w, h] = sides.map(|side| usize::try_from(side).ok());
            is_allowed.then_some(Some([w?, h?]))
        })
    }
}

/// Reads the column and row of a pixel.
pub(crate) fn pixel(value: &Bound<'_, PyAny>) -> PyResult<[usize; 2]> {
    let allowed = "two whole numbers, column and row from the top left, such as (128, 200)";
    let pixel = value.extract().ok();
    pixel.ok_or_else(|| wrong("pixel", value, allowed))
}
