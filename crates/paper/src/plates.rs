//! Draws figures that show several scenes, or several kinds of spectra, side by side.

use crate::flatland::{DiffuseStep, Flatland};
use crate::rows::{compared, feet, fields, lettered, phase, power};
use crate::scene_run::Shot;
use crate::subject::FigureData;
use etendue_field::{VirtualPlane, percent};
use etendue_figures::{AxisQuantity, Bars, Figure, Plate, PlateRow, Scale};
use etendue_predict::Theory;
use etendue_report::pictures::{DECIBEL, Seen};
use etendue_store::Failure;
use etendue_theory::Operator;
use ndarray::Array2;

/// Draws Fig. 4: the light of a point and the light of a spot, each at its source and after travel.
pub(crate) fn lights(taken: &FigureData<'_>) -> Result<Figure, Failure> {
    let seen = [
        taken.shots[0].at("light")?,
        taken.shots[1].at("receiver")?,
        taken.shots[2].at("light")?,
        taken.shots[2].at("receiver")?,
    ];
    let heads = ["point", "point, after 2 m", "spot", "spot, after 2 m"];
    taken.plate(&Plate {
        title: "Light sources",
        note: "A point is a Dirac in space and uniform in angle; its spectrum is uniform in space and, apart from the window, a Dirac in angle. After travel, the light of the point is a line *x*\u{a0}=\u{a0}*d\u{a0}u*, and the spectrum is the line *ν*\u{a0}=\u{a0}−*d\u{a0}ρ*.",
        heads: lettered(&heads),
        rows: compared(&seen, false),
        feet: feet(&seen),
        ..Plate::default()
    })
}

/// Draws Fig. 6: a scene step by step.
pub(crate) fn steps(taken: &FigureData<'_>) -> Result<Figure, Failure> {
    let names = [
        "light",
        "before_blockers",
        "after_blockers",
        "receiver",
        "irradiance",
        "leaving",
    ];
    let seen = taken.shots[0].each(&names)?;
    let heads = [
        "1 emission",
        "2 travel",
        "3 visibility",
        "4 travel",
        "5 cosine",
        "6 reflection",
    ];
    let flat = Flatland::of(&taken.shots[0].scene)?;
    let spectra: Vec<Array2<f64>> = seen
        .iter()
        .zip(DiffuseStep::ALL)
        .map(|(seen, step)| flat.power(step, seen.plane))
        .collect();
    let both = seen.iter().zip(&spectra);
    let pictures = both.map(|(seen, power)| seen.spectrum(power.view()));
    let quantity = AxisQuantity::new("|*S*_{2D}|^{2}", "");
    let mut rows = compared(&seen, false);
    let pictures = pictures.collect();
    rows.insert(1, PlateRow::new("2D", quantity, DECIBEL, false, pictures));
    taken.plate(&Plate {
        title: "The steps of diffuse shading",
        note: "Top: the scene in 2D (flatland), computed, with a row of blockers without jitter. Below: the scene in 3D with jittered blockers; its radial spectra are means over azimuths.",
        heads: heads.map(str::to_owned).to_vec(),
        rows,
        feet: feet(&seen),
        ..Plate::default()
    })
}

/// Draws Fig. 7: occluders that together block all light.
pub(crate) fn occluders(taken: &FigureData<'_>) -> Result<Figure, Failure> {
    let seen = taken.shots.iter().map(|shot| shot.at("after_occluders"));
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
    let power = AxisQuantity::new("|*S*_{0}|^{2}", "");
    let phase = AxisQuantity::new("arg *S*_{0}", "degrees");
    let rows = vec![
        fields("light field", &seen, true),
        PlateRow::new("power", power, DECIBEL, true, pictures(0)),
        PlateRow::new("phase", phase, Scale::Phase, true, pictures(1)),
    ];
    taken.plate(&Plate {
        title: "Two occluders that together block all light",
        note: "Measured slices at azimuth 0. Each occluder passes half of the light, with a different phase; together, the two occluders pass no light.",
        heads: ["one occluder", "the other", "both"]
            .map(str::to_owned)
            .to_vec(),
        rows,
        feet: feet(&seen),
        ..Plate::default()
    })
}

/// ∫ L W that a plane would have without blockers; `None` if light does not travel between
/// parallel planes.
fn unblocked(shot: &Shot, plane: &VirtualPlane) -> Option<f64> {
    let index = shot
        .scene
        .planes
        .iter()
        .position(|p| p.name == plane.name)?;
    let Theory::Parallel(chain) = &shot.theories.get(index)?.theory else {
        return None;
    };
    let mut chain = chain.clone();
    chain
        .operators
        .retain(|operator| !matches!(operator, Operator::Visibility { .. }));
    Some(etendue_theory::at(&chain, &plane.window, [0.0; 4]).re)
}

/// Draws Fig. 9: blockers of three sizes.
pub(crate) fn blockers(taken: &FigureData<'_>) -> Result<Figure, Failure> {
    let seen = taken.shots.iter().map(|shot| shot.at("receiver"));
    let seen: Vec<Seen<'_>> = seen.collect::<Result<_, _>>()?;
    let leaving = taken.shots.iter().map(|shot| shot.at("leaving"));
    let leaving: Vec<Seen<'_>> = leaving.collect::<Result<_, _>>()?;
    let mut feet = feet(&seen);
    for ((foot, seen), shot) in feet.iter_mut().zip(&seen).zip(taken.shots) {
        let open = unblocked(shot, seen.plane);
        let blocked = open.map(|open| 1.0 - seen.found.measured.at_zero() / open);
        foot.extend(blocked.map(|share| format!("blocked: {}", percent(share, 2))));
    }
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
    taken.plate(&Plate {
        title: "Blockers of three sizes, seen from the receiver",
        note: "*blocked*: the share of the light in the window that the blockers block. Behind blockers of medium size, the receiver has the most high frequencies: travel shears the replicas of the smallest blockers beyond the range of the receiver.",
        heads: lettered(&["pitch 1 m", "pitch 0.2 m", "pitch 0.04 m"]),
        rows: compared(&seen, true),
        feet,
        bars: Some(Bars {
            quantity: AxisQuantity::new("*H*", "%"),
            about: format!(
                "*H*, the share of the energy of the irradiance that lies above {cut:.2} cycles/m where light leaves the receiver"
            ),
            measured: each(&|share| share.measured),
            errors: each(&|share| share.error),
            predicted: each(&|share| share.predicted),
        }),
        side: Some(84.0),
    })
}
