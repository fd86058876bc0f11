//! Names the coordinates of a plane, and returns axes with these names.

use etendue_field::{FrequencyAxis, Orientation, ProjectionGrid, SliceGrid, VirtualPlane};
use etendue_figures::{Axis, AxisQuantity};
use etendue_spectrum::field::FullRadial;

/// The names of a plane's coordinates. A plane across the central ray has slopes, and a plane on a
/// surface has angles.
pub(super) struct CoordinateNames {
    pub(super) along: [&'static str; 2],
    pub(super) across: [&'static str; 2],
    angle: &'static str,
    per_angle: &'static str,
    /// Names of the frequencies along both positions, and along both slopes.
    rings: [&'static str; 2],
}

impl CoordinateNames {
    const ACROSS: Self = Self {
        along: ["*x*", "*u*"],
        across: ["*y*", "*v*"],
        angle: "",
        per_angle: "cycles/slope",
        rings: ["|*Ω*_{xy}|", "|*Ω*_{uv}|"],
    };
    const ON_SURFACE: Self = Self {
        along: ["*s*", "*θ*"],
        across: ["*t*", "*φ*"],
        angle: "rad",
        per_angle: "cycles/rad",
        rings: ["|*Ω*_{st}|", "|*Ω*_{θφ}|"],
    };

    pub(super) fn of(plane: &VirtualPlane) -> Self {
        Self::of_orientation(plane.orientation)
    }

    fn of_orientation(orientation: Orientation) -> Self {
        match orientation {
            Orientation::Orthogonal => Self::ACROSS,
            _ => Self::ON_SURFACE,
        }
    }

    /// The quantity of a light field that is integrated over the other two coordinates.
    pub(super) fn light_field_quantity(&self) -> AxisQuantity {
        let [a, b] = self.across;
        AxisQuantity::new(&format!("∬ *L W* d{a} d{b}"), "W m^{−2} sr^{−1} m")
    }
}

fn projection_axes([x, u]: [&str; 2], plane: &VirtualPlane, grid: &ProjectionGrid) -> [Axis; 2] {
    let angle = CoordinateNames::of(plane).angle;
    [
        Axis::edges(x, "m", [-grid.half_x, grid.half_x]),
        Axis::edges(u, angle, [-grid.half_u, grid.half_u]),
    ]
}

/// The axes of the light field of a plane, (x, u) across its ray.
pub(crate) fn light_field_axes(plane: &VirtualPlane, grid: &ProjectionGrid) -> [Axis; 2] {
    projection_axes(CoordinateNames::of(plane).along, plane, grid)
}

/// The axes of the light field across the other two coordinates, (y, v).
pub(super) fn across_axes(plane: &VirtualPlane, grid: &ProjectionGrid) -> [Axis; 2] {
    projection_axes(CoordinateNames::of(plane).across, plane, grid)
}

/// The axes of the spectrum of a plane, (ρ, ν).
pub(crate) fn spectrum_axes(plane: &VirtualPlane) -> [Axis; 2] {
    power_axes(plane.orientation, &plane.grid)
}

/// The axes of the spectrum of a plane with this orientation, (ρ, ν).
pub(crate) fn power_axes(orientation: Orientation, grid: &SliceGrid) -> [Axis; 2] {
    let axis = |name, unit, axis: &FrequencyAxis| {
        Axis::centers(name, unit, [-axis.max(), axis.max()], axis.count())
    };
    let per_angle = CoordinateNames::of_orientation(orientation).per_angle;
    [
        axis("*ρ*", "cycles/m", &grid.rho),
        axis("*ν*", per_angle, &grid.nu),
    ]
}

/// The axes of the full radial spectrum of a plane, (|Ωxy|, |Ωuv|). The first ring of each
/// axis contains zero. The first ring is half as wide as the others, but is drawn at equal width.
pub(super) fn full_radial_axes(plane: &VirtualPlane, of: &FullRadial) -> [Axis; 2] {
    let words = CoordinateNames::of(plane);
    let axis = |name, unit, edges: &[f64]| {
        let rings = edges.len() - 1;
        let width = edges[rings] / (rings as f64 - 0.5);
        Axis::centers(name, unit, [0.0, edges[rings] - 0.5 * width], rings)
    };
    let [xy, uv] = words.rings;
    [
        axis(xy, "cycles/m", &of.rho_edges),
        axis(uv, words.per_angle, &of.nu_edges),
    ]
}

/// The quantity of a full radial spectrum.
pub(super) fn full_radial_quantity() -> AxisQuantity {
    AxisQuantity::new("⟨|*ℓ̂*|^{2}⟩", "")
}

/// The quantity of a light field across the ray.
pub(crate) fn light_field_quantity() -> AxisQuantity {
    CoordinateNames::ACROSS.light_field_quantity()
}

/// The quantity of a radial spectrum.
pub(crate) fn spectrum_quantity() -> AxisQuantity {
    AxisQuantity::new("⟨|*S*_{φ}|^{2}⟩", "")
}
