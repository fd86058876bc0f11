use etendue_field::Rectangle;

/// The light: a uniform Lambertian rectangle in a plane orthogonal to the central ray.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// Name, for texts.
    pub name: String,
    /// Where it is, relative to the central ray.
    pub rectangle: Rectangle,
    /// Its radiance, W m⁻² sr⁻¹.
    pub radiance: f64,
}

/// What happens to the light field on its way.
#[derive(Clone, Debug, PartialEq)]
pub enum Operator {
    /// Free travel (docs/theory.md, Eq. 2): ℓ'(x, u) = ℓ(x − d u, u), ℓ̂'(Ωx, Ωu) = ℓ̂(Ωx, Ωu + d Ωx) (Durand et al. 2005, Eq. 3).
    Travel {
        /// Where the light comes from.
        from: String,
        /// Where it arrives.
        to: String,
        /// The distance d, in metres.
        distance: f64,
    },
    /// Opaque rectangles in the plane where the light is now: a product with 1 − Σ rectangles
    /// (Durand et al. 2005, Eq. 4). They must not overlap each other.
    Visibility {
        /// Name of the blockers.
        name: String,
        /// The rectangles, relative to the central ray.
        blockers: Vec<Rectangle>,
    },
}

/// A light path: the source and the operators in the order the light meets them.
///
/// The predicted light field is the radiance where the last operator ends, in two-plane coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    /// The light.
    pub source: Source,
    /// What happens to its light, in order.
    pub operators: Vec<Operator>,
}

/// A plane with rectangles, seen from the end of the chain.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Layer<'a> {
    /// Distance the light has travelled since it, in metres: the ray (x, u) was at x − distance · u there.
    pub(crate) distance: f64,
    pub(crate) rectangles: &'a [Rectangle],
}

impl Chain {
    /// The planes with rectangles on them, in the order of light: first the source, then the blockers.
    pub(crate) fn layers(&self) -> Vec<Layer<'_>> {
        let mut distance = 0.0;
        let mut layers = Vec::new();
        for operator in self.operators.iter().rev() {
            match operator {
                Operator::Travel { distance: d, .. } => distance += d,
                Operator::Visibility { blockers, .. } => layers.push(Layer {
                    distance,
                    rectangles: blockers,
                }),
            }
        }
        layers.push(Layer {
            distance,
            rectangles: std::slice::from_ref(&self.source.rectangle),
        });
        layers.reverse();
        layers
    }

    /// The chain in words: one line for each step.
    #[must_use]
    pub fn describe(&self) -> Vec<String> {
        let Source {
            name,
            rectangle,
            radiance,
        } = &self.source;
        let [width, height] = rectangle.size;
        let source = format!(
            "source  {name}: Lambertian rectangle {width} x {height} m, radiance {radiance} W m⁻² sr⁻¹"
        );
        let steps = self.operators.iter().map(Operator::describe);
        std::iter::once(source).chain(steps).collect()
    }
}

impl Operator {
    fn describe(&self) -> String {
        match self {
            Self::Travel { from, to, distance } => {
                let sign = if *distance < 0.0 { '−' } else { '+' };
                let size = distance.abs();
                format!("map  travel {distance} m, {from} to {to}: ℓ̂(Ωx, Ωu {sign} {size} Ωx)")
            }
            Self::Visibility { name, blockers } => {
                let count = blockers.len();
                let plural = if count == 1 { "" } else { "s" };
                format!("multiply  visibility of {name}: {count} opaque rectangle{plural}")
            }
        }
    }
}
