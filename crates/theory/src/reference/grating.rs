//! Checks of a light, a cosine grating and a receiver: the light path of Durand et al. 2005, Fig.
//! 6.

use super::*;
use crate::reference::gaussian::{self, CosineGrating};

/// A light, a grating and a receiver under a Gaussian window.
struct GratingScene {
    scene: ReferenceScene,
    grating: CosineGrating,
}

impl GratingScene {
    fn new(parameters: &Value) -> Self {
        let p = |name: &str| number(&parameters[name]);
        Self {
            scene: scene(parameters),
            grating: CosineGrating {
                frequency: p("f"),
                modulation: p("m"),
                phase: p("ph"),
            },
        }
    }

    /// The spectrum after one of the steps 1 to 6, in closed form.
    fn closed(&self, step: usize, k: [f64; 2]) -> Complex {
        let ReferenceScene {
            bench, gaussian, ..
        } = self.scene;
        let open = |distance| gaussian::area_light(bench.light, distance, &gaussian, k);
        let seen = |below, window: &GaussianWindow| {
            gaussian::through_grating(&GaussianBlock { below, ..bench }, &self.grating, window, k)
        };
        let endless = GaussianWindow {
            b: f64::INFINITY,
            ..gaussian
        };
        match step {
            1 => open(0.0),
            2 => open(bench.to_blockers),
            3 => seen(0.0, &gaussian),
            4 => seen(bench.below, &gaussian),
            5 => gaussian::shaded(&gaussian, |w| seen(bench.below, w)),
            _ => gaussian::shaded(&endless, |w| seen(bench.below, w)),
        }
    }

    /// The spectrum after one of the steps 1 to 4, from the polygon of the light. Each line
    /// of the grating adds a copy that is shifted in frequency.
    fn polygons(&self, step: usize, [x, v]: [f64; 2]) -> Complex {
        let ReferenceScene {
            bench, profiles, ..
        } = self.scene;
        let open = |distance, k| factor(&light(bench.light, distance), profiles, k);
        let seen = |below: f64| -> Complex {
            let lines = self.grating.lines().into_iter();
            let distance = bench.to_blockers + below;
            lines
                .map(|(f, c)| c * open(distance, [x - f, v + f * below]))
                .sum()
        };
        match step {
            1 => open(0.0, [x, v]),
            2 => open(bench.to_blockers, [x, v]),
            3 => seen(0.0),
            _ => seen(bench.below),
        }
    }
}

#[test]
fn light_and_grating_step_by_step() {
    let block = block("scene_area_grating");
    let scene = GratingScene::new(&block["params"]);
    for (i, step) in samples(&block["steps"]).iter().enumerate() {
        let number = i + 1;
        let all = samples(&step["samples"]).iter();
        let pairs = all
            .clone()
            .map(|s| (scene.closed(number, frequency(s)), complex(s)));
        assert_close(&format!("closed form, step {number}"), deviation(6, pairs));
        if number <= 4 {
            let pairs = all.map(|s| (scene.polygons(number, frequency(s)), complex(s)));
            assert_close(&format!("polygons, step {number}"), deviation(6, pairs));
        }
    }
    assert_eq!(samples(&block["steps"]).len(), 6);
}

#[test]
fn irradiance_below_a_grating() {
    let block = block("scene_area_grating");
    let GratingScene { scene, grating } = GratingScene::new(&block["params"]);
    let pairs = samples(&block["irradiance_unwindowed"]).iter().map(|s| {
        let got = gaussian::irradiance(&scene.bench, &grating, number(&s["ox"]));
        (got, complex(s))
    });
    assert_close("irradiance", deviation(6, pairs));
}
