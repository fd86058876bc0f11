//! Textual descriptions of chains.

use crate::geometry::AffineMap;
use crate::step::{ChainAction, ChainStep};
use crate::words::{self, formula};
use crate::{Chain, Operator, Source};
use etendue_field::{Disc, Image, Light, Rectangle, Shape, tidy};

impl Chain {
    /// Describes the chain as text, with one line for each step.
    #[must_use]
    pub fn describe(&self) -> Vec<String> {
        let steps = self.steps().into_iter().map(|step| step.words);
        std::iter::once(self.source.describe())
            .chain(steps)
            .collect()
    }

    /// The steps of the chain after its light.
    #[must_use]
    pub fn steps(&self) -> Vec<ChainStep> {
        self.operators.iter().map(Operator::step).collect()
    }
}

impl Source {
    fn describe(&self) -> String {
        let name = &self.name;
        match &self.light {
            &Light::Area {
                shape,
                radiance,
                exponent,
            } => {
                let (kind, lobe) = if exponent == 0.0 {
                    ("Lambertian ", String::new())
                } else {
                    ("", format!(" cosⁿθ, n = {exponent}"))
                };
                let shape = in_words(&shape);
                format!("source  {name}: {kind}{shape}, radiance {radiance} W m⁻² sr⁻¹{lobe}")
            }
            Light::Point { intensity } => {
                format!("source  {name}: point, intensity {intensity} W sr⁻¹")
            }
            Light::Projector { intensity, image } => {
                let picture = picture(image, ["u", "v"]);
                format!("source  {name}: projector, intensity {intensity} W sr⁻¹ × {picture}")
            }
            Light::Beam { irradiance, image } => {
                let picture = picture(image, ["x", "y"]);
                format!("source  {name}: beam, irradiance {irradiance} W m⁻² × {picture}")
            }
            Light::Environment { .. } => format!("source  {name}: environment"),
            Light::Rays { rays } => {
                let (count, flux) = (rays.rays().len(), tidy(rays.flux()));
                format!("source  {name}: {count} rays of a file, {flux} W")
            }
        }
    }
}

fn picture(image: &Image, [a, b]: [&str; 2]) -> String {
    let [w, h] = image.width;
    let envelope = format!("exp(−π({a}²/{w}² + {b}²/{h}²))");
    match image.grating {
        Some(grating) => format!("{envelope} {}", formula(&grating, [a, b])),
        None => envelope,
    }
}

impl Operator {
    fn step(&self) -> ChainStep {
        let action = match self {
            Self::Travel { distance, .. } => {
                ChainAction::Map(AffineMap::travel(*distance).spectrum_map())
            }
            Self::Visibility { mask, .. } => ChainAction::Mask(mask.clone()),
            Self::Cosine { .. } => ChainAction::SlopeCosine,
            Self::Diffuse { .. } => ChainAction::Other,
        };
        ChainStep::new(self.describe(), action)
    }

    fn describe(&self) -> String {
        match self {
            Self::Travel { from, to, distance } => {
                let sign = if *distance < 0.0 { '−' } else { '+' };
                let (distance, size) = (tidy(*distance), tidy(distance.abs()));
                format!("map  travel {distance} m, {from} to {to}: ℓ̂(Ωx, Ωu {sign} {size} Ωx)")
            }
            Self::Visibility { name, mask } => words::mask(&format!("{name}: "), mask),
            Self::Cosine { name } => {
                format!("multiply  by the cosine at {name}: G = (1 + u² + v²)⁻²")
            }
            Self::Diffuse { name, albedo } => {
                format!(
                    "convolve  with the diffuse reflection at {name}: albedo {albedo}, constant in slope"
                )
            }
        }
    }
}

fn in_words(shape: &Shape) -> String {
    match shape {
        Shape::Rectangle(Rectangle {
            size: [width, height],
            ..
        }) => format!("rectangle {width} x {height} m"),
        Shape::Disc(Disc { radius, .. }) => format!("disc of radius {radius} m"),
    }
}
