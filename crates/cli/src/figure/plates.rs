//! Figures of several scenes, or several kinds of spectra, side by side.

use crate::failure::Failure;
use crate::figure::shot::Shot;
use crate::pictures::{
    light_field_axes, light_field_quantity, spectrum_axes, spectrum_quantity, verdict_lines,
};
use etendue_compare::PlaneComparison;
use etendue_field::{Slices, VirtualPlane, percent};
use etendue_figures::{Bars, Figure, Picture, Plate, PlateRow, Quantity, Scale, plate};
use ndarray::{Array2, ArrayView2, Axis as Along};

/// Lowest level of a spectrum's colors, in decibels below its peak.
const DECIBEL: Scale = Scale::Decibel { floor: -50.0 };
/// Powers below this share of the largest have no phase worth showing.
const LEAST: f64 = 1e-5;

/// A plane of a scene with what was found there.
#[derive(Clone, Copy)]
struct Seen<'a> {
    plane: &'a VirtualPlane,
    found: &'a PlaneComparison,
}

impl<'a> Seen<'a> {
    fn all(shot: &'a Shot) -> impl Iterator<Item = Self> {
        let both = shot.scene.planes.iter().zip(&shot.planes);
        both.map(|(plane, found)| Self { plane, found })
    }

    /// The plane of this name.
    fn at(shot: &'a Shot, name: &str) -> Result<Self, Failure> {
        let missing = || Failure::cannot_run(format!("{} has no plane {name}", shot.scene.name));
        Self::all(shot)
            .find(|seen| seen.plane.name == name)
            .ok_or_else(missing)
    }

    fn light_field(&self) -> Picture<'a> {
        let values = self.found.projection.mean.values.view();
        let [x, y] = light_field_axes(self.plane, &self.found.projection.mean.grid);
        Picture { x, y, values }
    }

    fn spectrum<'b>(&self, values: ArrayView2<'b, f64>) -> Picture<'b> {
        let [x, y] = spectrum_axes(self.plane);
        Picture { x, y, values }
    }
}

/// The plane at azimuth 0 of a spectrum, [ρ, ν]: by its power, or its phase.
fn slice(slices: &Slices, of: &dyn Fn(etendue_field::Complex, f64) -> f64) -> Array2<f64> {
    let full = slices.full();
    let slice = full.index_axis(Along(0), 0);
    let most = slice.iter().map(|s| s.norm_sqr()).fold(0.0, f64::max);
    slice.map(|s| of(*s, most))
}

fn power(slices: &Slices) -> Array2<f64> {
    slice(slices, &|s, _| s.norm_sqr())
}

/// In degrees.
fn phase(slices: &Slices) -> Array2<f64> {
    slice(slices, &|s, most| {
        if s.norm_sqr() > LEAST * most {
            libm::atan2(s.im, s.re).to_degrees()
        } else {
            f64::NAN
        }
    })
}

fn row<'a>(
    name: &'a str,
    quantity: Quantity,
    scale: Scale,
    shared: bool,
    pictures: Vec<Picture<'a>>,
) -> PlateRow<'a> {
    PlateRow {
        name,
        quantity,
        scale,
        shared,
        pictures,
    }
}

/// Light fields, measured and predicted spectra of some planes.
fn compared<'a>(seen: &[Seen<'a>], shared: bool) -> Vec<PlateRow<'a>> {
    let pictures = |of: &dyn Fn(&Seen<'a>) -> Picture<'a>| seen.iter().map(of).collect();
    vec![
        row(
            "light field",
            light_field_quantity(),
            Scale::Linear,
            shared,
            pictures(&Seen::light_field),
        ),
        row(
            "measured",
            spectrum_quantity(),
            DECIBEL,
            shared,
            pictures(&|seen| seen.spectrum(seen.found.radial.power.view())),
        ),
        row(
            "predicted",
            spectrum_quantity(),
            DECIBEL,
            shared,
            pictures(&|seen| seen.spectrum(seen.found.predicted_radial.view())),
        ),
    ]
}

fn feet(seen: &[Seen<'_>]) -> Vec<Vec<String>> {
    seen.iter().map(|seen| verdict_lines(seen.found)).collect()
}

fn drawn(of: &Plate<'_>) -> Result<Figure, Failure> {
    plate(of).map_err(Failure::cannot_run)
}

/// Fig. 4: light of a point after a short way, a line in ray space, and of a spot where it begins.
pub(crate) fn lights(shots: &[Shot]) -> Result<Figure, Failure> {
    let seen = [
        Seen::at(&shots[0], "near")?,
        Seen::at(&shots[0], "receiver")?,
        Seen::at(&shots[1], "light")?,
        Seen::at(&shots[1], "receiver")?,
    ];
    let heads = [
        "point, after 0.5 m",
        "point, after 2 m",
        "spot",
        "spot, after 2 m",
    ];
    drawn(&Plate {
        title: "Light sources",
        note: "A point is a Dirac in space and even in angle. After travel its light is a line *x* = *d u*, and its spectrum *ν* = −*d ρ*.",
        heads: heads.map(str::to_owned).to_vec(),
        rows: compared(&seen, false),
        feet: feet(&seen),
        bars: None,
    })
}

/// Fig. 6: a scene by its steps.
pub(crate) fn steps(shots: &[Shot]) -> Result<Figure, Failure> {
    let names = [
        "light",
        "before_blockers",
        "after_blockers",
        "receiver",
        "irradiance",
        "leaving",
    ];
    let seen = names.map(|name| Seen::at(&shots[0], name));
    let seen: Vec<Seen<'_>> = seen.into_iter().collect::<Result<_, _>>()?;
    let heads = [
        "1 emission",
        "2 travel",
        "3 visibility",
        "4 travel",
        "5 cosine",
        "6 reflection",
    ];
    let slices: Vec<Array2<f64>> = seen
        .iter()
        .map(|seen| power(&seen.found.predicted))
        .collect();
    let slices = seen
        .iter()
        .zip(&slices)
        .map(|(seen, slice)| seen.spectrum(slice.view()));
    let quantity = Quantity::new("|*S*_{0}|^{2}", "");
    let mut rows = compared(&seen, false);
    rows.insert(
        1,
        row("2D, predicted", quantity, DECIBEL, false, slices.collect()),
    );
    drawn(&Plate {
        title: "The steps of diffuse shading",
        note: "2D: the slice at azimuth 0. Below it radial spectra, means over azimuths.",
        heads: heads.map(str::to_owned).to_vec(),
        rows,
        feet: feet(&seen),
        bars: None,
    })
}

/// Fig. 7: occluders that cancel.
pub(crate) fn occluders(shots: &[Shot]) -> Result<Figure, Failure> {
    let seen = shots.iter().map(|shot| Seen::at(shot, "after_occluders"));
    let seen: Vec<Seen<'_>> = seen.collect::<Result<_, _>>()?;
    let found = seen
        .iter()
        .map(|seen| [power(&seen.found.measured), phase(&seen.found.measured)]);
    let found: Vec<[Array2<f64>; 2]> = found.collect();
    let pictures = |i: usize| {
        let both = seen.iter().zip(&found);
        both.map(|(seen, found)| seen.spectrum(found[i].view()))
            .collect()
    };
    let power = Quantity::new("|*S*_{0}|^{2}", "");
    let rows = vec![
        row(
            "light field",
            light_field_quantity(),
            Scale::Linear,
            true,
            seen.iter().map(Seen::light_field).collect(),
        ),
        row("power", power, DECIBEL, true, pictures(0)),
        row(
            "phase",
            Quantity::new("arg *S*_{0}", "degrees"),
            Scale::Phase,
            true,
            pictures(1),
        ),
    ];
    let both = |seen: &Seen<'_>| {
        let mut lines = verdict_lines(seen.found);
        if seen.found.predicted.is_dark() {
            lines.push("dark, as predicted".to_owned());
        }
        lines
    };
    drawn(&Plate {
        title: "Occluders whose spectra cancel",
        note: "Measured, the slice at azimuth 0. Each occluder leaves half of the light; their phases differ, and together they leave none.",
        heads: ["one occluder", "the other", "both"]
            .map(str::to_owned)
            .to_vec(),
        rows,
        feet: seen.iter().map(both).collect(),
        bars: None,
    })
}

/// Fig. 8: slopes and angles at the receiver. The chain takes one for the other, and its error is what the paper calls
/// not significant.
pub(crate) fn parameterisations(shots: &[Shot]) -> Result<Figure, Failure> {
    let seen = [
        Seen::at(&shots[0], "slopes")?,
        Seen::at(&shots[0], "angles")?,
    ];
    let mut feet = feet(&seen);
    if let Some(first_order) = &seen[1].found.report.first_order {
        let said = |share: Option<f64>| share.map_or("–".to_owned(), |share| percent(share, 2));
        let (found, error) = (
            said(first_order.excess),
            said(Some(first_order.chain.error)),
        );
        feet[1].push(format!("*u* for *θ*: off by {found}, computed {error}"));
    }
    drawn(&Plate {
        title: "Two parameterisations",
        note: "Angles are counted along T, which is against X here: the shear has the other sign.",
        heads: ["by slopes", "by angles"].map(str::to_owned).to_vec(),
        rows: compared(&seen, false),
        feet,
        bars: None,
    })
}

/// Fig. 9: blockers of three sizes.
pub(crate) fn blockers(shots: &[Shot]) -> Result<Figure, Failure> {
    let seen = shots.iter().map(|shot| Seen::at(shot, "receiver"));
    let seen: Vec<Seen<'_>> = seen.collect::<Result<_, _>>()?;
    let leaving = shots.iter().map(|shot| Seen::at(shot, "leaving"));
    let leaving: Vec<Seen<'_>> = leaving.collect::<Result<_, _>>()?;
    let shares: Vec<_> = leaving
        .iter()
        .filter_map(|seen| seen.found.report.high_frequency_share.first())
        .collect();
    let cut = shares.first().map_or(0.0, |share| share.cut);
    let each = |of: &dyn Fn(&etendue_compare::Pair) -> Option<f64>| {
        shares
            .iter()
            .map(|share| of(&share.share).map(|x| 100.0 * x))
            .collect::<Vec<_>>()
    };
    drawn(&Plate {
        title: "Blockers of three sizes, seen from the receiver",
        note: "The receiver sees most high frequencies behind blockers of middle size: replicas of the smallest are sheared out of its reach.",
        heads: ["pitch 2 m", "pitch 0.2 m", "pitch 0.04 m"]
            .map(str::to_owned)
            .to_vec(),
        rows: compared(&seen, true),
        feet: feet(&seen),
        bars: Some(Bars {
            quantity: Quantity::new("*H*", "%"),
            about: format!(
                "*H*, the share of the energy of the irradiance above {cut:.2} cycles/m, where light leaves the receiver"
            ),
            measured: each(&|share| share.measured),
            errors: each(&|share| share.error),
            predicted: each(&|share| share.predicted),
        }),
    })
}
