//! Statements about the sampling criteria of section 6.2.

use super::scene::ClaimRun;
use super::surfaces::bandwidth;
use super::{Claim, decreasing};
use crate::report::Bound::AtMost;
use crate::report::Check;
use etendue_spectrum::bandwidth::{Along, widest};
use etendue_theory::shading::{Criterion, PlanarLobe};

pub(super) fn claims(run: ClaimRun) -> Vec<Claim> {
    vec![criteria(run), larger_curvature(run)]
}

/// The criterion at an eye 0.5 m from a glossy surface, in the mirror direction.
fn criterion(curvature: f64, incidence: f64, blocker_distance: Option<f64>) -> Criterion {
    Criterion {
        curvature,
        incidence,
        outgoing: -incidence,
        distance: 0.5,
        blocker_distance,
        lobe_cutoff: PlanarLobe::Phong { exponent: 1000.0 }.cutoff(0.95),
        environment_cutoff: f64::INFINITY,
    }
}

/// Compares the sampling criterion, which assumes light of all frequencies, with measurements for
/// lights of increasing size.
fn criteria(run: ClaimRun) -> Claim {
    let criterion = criterion(0.5, 0.5, Some(0.6));
    let sizes = [0.003, 0.02, 0.05, 0.1];
    let shares = sizes.map(|size| {
        let seen = run.seen("criterion", &[("light.size", format!("({size}, {size})"))]);
        let found = seen.number(0, |slices| bandwidth(slices, Along::Nu));
        found.per(criterion.blocker())
    });
    let most = shares.iter().map(|share| share.value).fold(0.0, f64::max);
    Claim {
        said: "criteria that take the light to have all frequencies over-estimate bandwidth, and never under-estimate it (6.2)",
        shown: format!(
            "95 % bandwidth over ν at the eye, relative to B', for lights of {sizes:?} m at 0.6 m \
            from a glossy sphere"
        ),
        checks: vec![
            Check::new("largest", most, AtMost(1.05)).because("the criterion has an error of 5 %"),
            Check::new("widest light", shares[3].value, AtMost(0.7))
                .because("this light has few frequencies"),
            decreasing(&shares[1..]),
        ],
        numbers: shares.to_vec(),
        holds: "holds: the bandwidth is close to the criterion for a small light and below it for \
            others",
    }
}

/// Measures light reflected by three surfaces: a cylinder curved in the plane of incidence, a
/// cylinder curved across this plane, and a sphere.
fn larger_curvature(run: ClaimRun) -> Claim {
    let criterion = criterion(0.8, 0.7, None);
    let forms = [
        ["Cylinder(0.8)", "(1, 0, 0)"],
        ["Cylinder(0.8)", "(0, 1, 0)"],
        ["Sphere(0.8)", "(1, 0, 0)"],
    ];
    let shares = forms.map(|[form, along]| {
        let fields = [
            ("surfaces.0.form", form.to_owned()),
            ("surfaces.0.along", along.to_owned()),
        ];
        let seen = run.seen("larger_curvature", &fields);
        let found = seen.number(0, |slices| {
            let power = slices.half.mapv(|s| s.norm_sqr());
            widest(power.view(), &slices.grid, Along::Nu).map_or(f64::NAN, |most| most.value)
        });
        found.per(criterion.environment())
    });
    let [inside, across, sphere] = shares;
    // Across the plane of incidence, curvature is multiplied by cos θ₁, not by 1/cos θ₁.
    let [shear, cosine] = [
        2.0 * criterion.curvature * criterion.distance,
        0.7_f64.cos(),
    ];
    let wanted = (1.0 + shear * cosine) / (1.0 + shear / cosine);
    Claim {
        said: "in 3D the criterion takes the larger of the two curvatures (6.2)",
        shown: format!(
            "largest 95 % bandwidth of all azimuths at the eye, relative to B for k = 0.8 /m: for \
            a cylinder curved in the plane of incidence, a cylinder curved across it, and a \
            sphere; across the plane of incidence, k counts with cos θ₁, which gives {wanted:.3}"
        ),
        checks: vec![
            Check::new("inside", (inside.value - 1.0).abs(), AtMost(0.05))
                .because("the criterion has an error of 5 %"),
            Check::new("sphere", (sphere.value - 1.0).abs(), AtMost(0.05))
                .because("the criterion has an error of 5 %"),
            Check::new("across", (across.value / wanted - 1.0).abs(), AtMost(0.05))
                .because("the criterion has an error of 5 %"),
        ],
        numbers: shares.to_vec(),
        holds: "holds as a bound: it is reached in the plane of incidence, but not across it",
    }
}
