//! A glossy surface that is lit and seen by an eye, as a scene.

use etendue_predict::{Applicability, criterion};
use etendue_scene::{Scene, SceneFile, resolve};
use etendue_theory::shading::Criterion;

/// The 95 % bandwidth of a Gaussian lobe, multiplied by the standard deviation of the lobe.
const GAUSSIAN: f64 = 0.2206;
/// The 95 % bandwidth of a box, multiplied by the half-width of the box.
pub(super) const BOX: f64 = 1.03;
/// Half-width of the window in x, metres.
pub(super) const ACROSS: f64 = 0.05;
/// Maximum half-width of a window in slope.
pub(super) const WIDEST: f64 = 0.25;

/// The kind of light that illuminates the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Lit {
    /// Distant light.
    Beam,
    /// A point light at this distance.
    Point(f64),
    /// A slit at this distance, with a light behind it that is wider than the slit.
    Slit(f64),
}

/// The kind of lobe of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum LobeOwner {
    Phong(f64),
    Beckmann(f64),
    Ggx(f64),
}

/// A glossy surface that is lit and seen by an eye.
#[derive(Clone, Copy, Debug)]
pub(super) struct GlossyBench {
    pub(super) lit: Lit,
    pub(super) curvature: f64,
    /// θ₀, radians.
    pub(super) incidence: f64,
    /// Angle between the leaving central ray and the mirror direction, radians.
    pub(super) aside: f64,
    pub(super) distance: f64,
    pub(super) lobe: LobeOwner,
}

pub(super) const BASE: GlossyBench = GlossyBench {
    lit: Lit::Beam,
    curvature: 0.5,
    incidence: 0.5,
    aside: 0.0,
    distance: 0.5,
    lobe: LobeOwner::Phong(2500.0),
};

/// The windows and the frequency grids at the eye.
pub(super) struct Windows {
    /// Half-widths of the window in u and in v.
    slope: [f64; 2],
    /// Maximum frequencies in ρ and ν.
    most: [f64; 2],
    /// Width of the beam.
    beam: f64,
}

pub(super) const ANY: Windows = Windows {
    slope: [0.1, 0.1],
    most: [60.0, 20.0],
    beam: 1.0,
};

impl GlossyBench {
    pub(super) fn curved(self, curvature: f64) -> Self {
        Self { curvature, ..self }
    }

    pub(super) fn lit(self, lit: Lit) -> Self {
        Self { lit, ..self }
    }

    pub(super) fn with(self, lobe: LobeOwner) -> Self {
        Self { lobe, ..self }
    }

    /// The bench with light that arrives at an angle in degrees.
    pub(super) fn seen_at(self, angle: f64) -> Self {
        let incidence = angle.to_radians();
        Self { incidence, ..self }
    }

    fn text(&self, windows: &Windows, photons: u64, seed: u64) -> String {
        let (sine, cosine) = self.incidence.sin_cos();
        let (light, slit, from) = match self.lit {
            Lit::Beam => {
                // The start of the beam is farther from the surface than the eye is.
                let (w, from) = (windows.beam, 1.0_f64.max(1.5 * self.distance));
                (
                    format!(
                        "Beam(center: (0, 0, {}), image: (width: ({w}, {w})))",
                        -from
                    ),
                    String::new(),
                    from,
                )
            }
            Lit::Point(d) => (format!("Point(center: (0, 0, {}))", -d), String::new(), d),
            Lit::Slit(d) => {
                // The slit's angle of 0.02 is below half of the lobe's standard deviation.
                let (half, from) = (0.01 * d, 1.01 * d);
                (
                    format!(
                        "Rectangle(center: (0, 0, {}), size: ({}, {half}))",
                        -from,
                        3.2 * half
                    ),
                    format!(
                        "blockers: [Shapes(name: \"slit\", center: (0, 0, {}), shapes: [HalfPlane(axis: X, edge: {}, opaque: Below), \
                         HalfPlane(axis: X, edge: {half}, opaque: Above)])],",
                        -d, -half
                    ),
                    from,
                )
            }
        };
        // The angle between the normal and Z is π − θ₀, and the angle between the leaving ray and Z
        // is π − 2 θ₀.
        let leaves = std::f64::consts::PI - 2.0 * self.incidence + self.aside;
        let lobe = match self.lobe {
            LobeOwner::Phong(n) => format!("Phong({n})"),
            LobeOwner::Beckmann(alpha) => format!("Beckmann({alpha})"),
            LobeOwner::Ggx(alpha) => format!("Ggx({alpha})"),
        };
        let aperture = 0.6_f64.min(0.45 / self.curvature.abs());
        let [u, v] = windows.slope;
        let [rho, nu] = windows.most;
        format!(
            "(light: {light}, {slit}
            surfaces: [Smooth(name: \"glossy\", center: (0, 0, 0), facing: ({sine}, 0, {}), form: Sphere({}), aperture: {aperture},
                event: Reflects(brdf: (lobe: {lobe})))],
            path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: [\"glossy\"], leaves: ({}, 0, {})),
            planes: [(name: \"eye\", at: Distance({}))],
            window: (x: Hann({ACROSS}), y: Hann({ACROSS}), u: Box({u}), v: Hann({v})),
            frequencies: (azimuths: 1, rho: (max: {rho}), nu: (max: {nu}, spacing: {})),
            run: (photons: {photons}, seed: {seed}))",
            -cosine,
            self.curvature,
            leaves.sin(),
            leaves.cos(),
            from + self.distance,
            nu / 200.0,
        )
    }

    /// # Panics
    /// Panics if the scene is invalid.
    pub(super) fn scene(&self, windows: &Windows, photons: u64, seed: u64) -> Scene {
        let text = self.text(windows, photons, seed);
        let file = SceneFile::parse(&text).expect("a scene file");
        resolve("glossy", file, ".".as_ref(), u64::MAX).expect("a sound scene")
    }

    /// # Panics
    /// Panics if the plane has no criterion.
    pub(super) fn criterion(&self) -> Criterion {
        let scene = self.scene(&ANY, 1000, 1);
        let plane = &scene.planes[0];
        let found = criterion(&scene, plane, &Applicability::new(&scene, plane));
        found.expect("across a ray that left a glossy surface")
    }

    /// The bandwidth that the criterion predicts, in its corrected form and as printed.
    pub(super) fn says(&self, c: &Criterion) -> [f64; 2] {
        match self.lit {
            Lit::Beam => [c.environment(), c.printed_environment()],
            Lit::Point(_) | Lit::Slit(_) => [c.blocker(), c.printed_blocker()],
        }
    }

    /// Returns windows that contain the lobe, grids, and the bandwidth that the window in u adds.
    pub(super) fn windows(&self, c: &Criterion) -> (Windows, f64) {
        let deviation = GAUSSIAN / c.lobe_cutoff;
        let finer = self.says(c)[0] / c.lobe_cutoff;
        // The window contains the lobe, whose extent is computed in angles at the surface.
        let nearness = match self.lit {
            Lit::Beam => 0.0,
            Lit::Point(d) | Lit::Slit(d) => c.incidence.cos() / d,
        };
        let along = (2.0 * c.curvature + nearness) / c.outgoing.cos();
        // The window is wider for GGX lobes, because they have long tails.
        let tails = if matches!(self.lobe, LobeOwner::Ggx(_)) {
            14.0
        } else {
            5.0
        };
        let wanted =
            (tails * deviation + self.aside.abs() + 0.7 * along.abs() * ACROSS) / finer.max(1e-6);
        let u = wanted.min(WIDEST);
        let floor = if wanted > WIDEST { BOX / u } else { 0.0 };
        // The slice at azimuth 0 integrates over y and v. If the lobe is not a product of a
        // function of u and a function of v, a narrow window in v selects the plane of incidence.
        let across = 1.0
            + self.distance
                * (nearness / c.incidence.cos() + 2.0 * c.curvature * c.incidence.cos());
        let v = match self.lobe {
            LobeOwner::Phong(_) => (5.0 * deviation / across.abs().max(0.2)).min(WIDEST),
            LobeOwner::Beckmann(_) | LobeOwner::Ggx(_) => 0.6 * deviation,
        };
        let said = self.says(c)[0].max(floor);
        let windows = Windows {
            slope: [u, v],
            most: [2.0 * along.abs() * c.lobe_cutoff + 2.0 / ACROSS, 2.5 * said],
            // The beam is seven times as wide as the lobe that the eye sees on the surface.
            beam: 18.0 * self.distance * (u / tails).max(deviation / finer.max(0.2)) + 2.0 * ACROSS,
        };
        (windows, floor)
    }
}
