//! Checks of two half-planes that meet. Each half-plane transmits half of the light, and both
//! together block all light (Durand et al. 2005, Fig. 7).

use super::*;
use crate::at;
use crate::reference::gaussian::{self, Tilted};

fn field(block: &Value) -> Tilted {
    let p = |name: &str| number(&block["params"][name]);
    Tilted {
        alpha: p("al"),
        beta: p("be"),
        gamma: p("ga"),
    }
}

#[test]
fn each_half() {
    let block = block("half_planes");
    let field = field(&block);
    let names = ["unoccluded", "A_only", "B_only"];
    let pairs = samples(&block["samples"]).iter().flat_map(|s| {
        let got = gaussian::half_planes(&field, frequency(s));
        [0, 1, 2].map(|i| (got[i], complex(&s[names[i]])))
    });
    assert_close("half-planes", deviation(12, pairs));
}

#[test]
fn phases_make_both_halves_dark() {
    let block = block("half_planes");
    let field = field(&block);
    let largest = gaussian::half_planes(&field, [0.0, 0.0])[0].norm();
    for sample in samples(&block["samples"]) {
        let [open, a, b] = gaussian::half_planes(&field, frequency(sample));
        // The light that passes both half-planes is all light minus the light that each half-plane
        // blocks, F₀ − (F₀ − F_A) − (F₀ − F_B).
        let both = a + b - open;
        // The rounding error is small because a and b are conjugates of each other.
        assert!((both - complex(&sample["both"])).norm() < 1e-16);
        // A sum of moduli without phases would wrongly give some light.
        let blind = a.norm() + b.norm() - open.norm();
        let zero = frequency(sample).iter().all(|k| k.abs() < 1e-9);
        assert!(zero || blind > 0.02 * largest, "{blind}");
    }
}

#[test]
fn half_planes_that_meet_leave_polygons_dark() {
    let [below, above] = [-0.5, 0.5].map(|side| strip(side * ENDLESS, ENDLESS));
    let profile = Profile::Hann(0.5);
    let spectrum = |blockers: &[Rectangle], k| {
        let steps = [(1.0, blockers.to_vec()), (1.0, vec![])];
        at(&chain(0.3, &steps), &window(profile, profile), k)
    };
    let k = [1.5, 0.0, -1.0, 0.0];
    let open = spectrum(&[], k);
    let halves = [below, above].map(|half| spectrum(&[half], k));
    assert!((halves[0] + halves[1] - open).norm() < 1e-14); // rounding
    assert!(halves[0].norm() + halves[1].norm() - open.norm() > 1e-4);
    assert!(spectrum(&[below, above], k).norm() < 1e-14); // rounding
}
