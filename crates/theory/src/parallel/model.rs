//! Implements [`Model`] for chains: their parameters and their prediction.

use crate::model::{Model, Over};
use crate::nets::{RayBudget, RayNets, work_of_nets};
use crate::parallel::disc_resolution::DiscResolution;
use crate::parallel::{at, projection, quadrature_error, ray_list, with_derivatives, work};
use crate::parameter::{New, Parameter};
use crate::predicted::Predicted;
use crate::work::PredictionWork;
use crate::{Chain, Operator, Source};
use etendue_field::{Light, Window};

impl Model for Chain {
    fn light(&self) -> &Light {
        &self.source.light
    }

    fn parameters(&self) -> Vec<Parameter> {
        // For a light of finitely many rays, the light that passes an edge changes in jumps when
        // the edge moves, so it has no derivative with respect to the edge's position.
        if self.source.light.listed().is_some() {
            return Vec::new();
        }
        let mut all = Parameter::of_light(&self.source.light);
        // The width of a light's picture is not a parameter, because closed forms do not cover
        // lights with pictures.
        all.retain(|parameter| !matches!(parameter, Parameter::ImageWidth(_)));
        for (i, operator) in self.operators.iter().enumerate() {
            match operator {
                Operator::Travel { .. } => all.push(Parameter::Travel(i)),
                Operator::Visibility { mask, .. } => all.extend(Parameter::of_mask(mask, i)),
                Operator::Cosine { .. } | Operator::Diffuse { .. } => {}
            }
        }
        all
    }

    /// # Panics
    /// Panics if the chain has no such parameter.
    fn name(&self, parameter: Parameter) -> String {
        let Source { name, light } = &self.source;
        let operator = parameter.operator().and_then(|i| self.operators.get(i));
        let name = match (parameter, operator) {
            (_, None) => parameter.name_of_light(light, name),
            (_, Some(Operator::Travel { from, to, .. })) => Some(format!("travel {from} to {to}")),
            (_, Some(Operator::Visibility { name, mask })) => parameter.name_of_mask(mask, name),
            _ => None,
        };
        name.unwrap_or_else(|| panic!("this chain has no parameter {parameter:?}"))
    }

    fn change(&mut self, parameter: Parameter, new: New<'_>) -> Option<()> {
        let Some(i) = parameter.operator() else {
            return parameter.change_light(&mut self.source.light, new);
        };
        match (parameter, self.operators.get_mut(i)?) {
            (Parameter::Travel(_), Operator::Travel { distance, .. }) => *distance = new(*distance),
            (_, Operator::Visibility { mask, .. }) => parameter.change_mask(mask, new)?,
            _ => return None,
        }
        Some(())
    }

    /// Predicts the light field by closed forms. If closed forms take too long or do not resolve
    /// the scene, nets of rays are used. For a light that is a list of rays, the prediction is a
    /// sum over these rays.
    fn predict(&self, parameters: &[Parameter], over: Over<'_>, budget: RayBudget) -> Predicted {
        if let Some(rays) = self.source.light.listed() {
            return ray_list::predicted(self, rays, over);
        }
        if self.is_sampled(over, budget) {
            return self.sampled(parameters, over, budget);
        }
        let (window, grid, picture) = over;
        let (slices, derivatives) = with_derivatives(self, parameters, window, grid);
        Predicted {
            derivatives,
            error: quadrature_error(self, window, grid, &slices),
            unblocked: self.unblocked(window),
            ..Predicted::exact(slices, projection(self, window, picture))
        }
    }

    fn with_rays(&self, over: Over<'_>, budget: RayBudget, then: &mut dyn FnMut(&dyn RayNets)) {
        match self.source.light.listed() {
            Some(rays) => then(&ray_list::GivenRays::new(self, rays, over.0)),
            None => self.followed(over.0).with_rays(over, budget, then),
        }
    }

    fn work(&self, over: Over<'_>, budget: RayBudget) -> PredictionWork {
        if let Some(rays) = self.source.light.listed() {
            ray_list::work(rays, over.1)
        } else if self.is_sampled(over, budget) {
            work_of_nets(over.1, budget)
        } else {
            work(self, over.0, over.1, over.2)
        }
    }
}

/// Maximum number of computing steps of a closed form for each ray of the budget. These steps take
/// about as long as tracing four photons, and a run has about four photons for each ray of the
/// budget.
const MAX_STEPS_PER_RAY: f64 = 2e3;
/// Maximum number of computing steps of a closed form or a quadrature for each step of the nets that
/// would replace it. Their noise is near that of the photons; a closed form has none.
const MAX_STEPS_OF_NETS: f64 = 5.0;
/// Maximum number of computing steps of a closed form or a quadrature if nets of rays do not fit
/// into memory.
const MAX_STEPS_WITHOUT_NETS: f64 = 1e11;
/// Maximum number of bytes that a prediction may allocate on one core.
const MAX_BYTES: f64 = 1e9;

impl Chain {
    /// Checks whether nets of rays replace the chain's closed form or quadrature. Nets are used if
    /// the closed form or quadrature takes longer than tracing the photons, or does not resolve a
    /// pattern, and behind apertures whose hole is a polygon.
    #[must_use]
    pub fn is_sampled(&self, (window, grid, picture): Over<'_>, budget: RayBudget) -> bool {
        if self.source.light.listed().is_some() {
            return false;
        }
        let path = self.path();
        if path.has_polygons() {
            return true;
        }
        let work = work(self, window, grid, picture);
        let fits = |work: &PredictionWork| work.bytes + work.bytes_each <= MAX_BYTES;
        let in_any_case = budget.steps.max(MAX_STEPS_PER_RAY * budget.nodes);
        let beside_nets = || {
            let nets = work_of_nets(grid, budget);
            if fits(&nets) {
                MAX_STEPS_OF_NETS * nets.steps
            } else {
                MAX_STEPS_WITHOUT_NETS
            }
        };
        if !fits(&work) || work.steps > in_any_case && work.steps > beside_nets() {
            return true;
        }
        match path.receiver() {
            Some(receiver) => !receiver.is_resolved(window),
            None => {
                let frequency = [grid.rho.max(), grid.nu.max()];
                !DiscResolution::is_enough(&path, window, frequency)
            }
        }
    }

    /// ∫ L W, the light in the window if all occluders are removed.
    fn unblocked(&self, window: &Window) -> f64 {
        let mut open = self.clone();
        let is_mask = |operator: &Operator| matches!(operator, Operator::Visibility { .. });
        open.operators.retain(|operator| !is_mask(operator));
        at(&open, window, [0.0; 4]).re
    }
}

impl Parameter {
    /// The index of the operator to which the parameter belongs, or `None` for parameters
    /// of the source.
    fn operator(self) -> Option<usize> {
        match self {
            Self::Travel(i) => Some(i),
            of_mask => of_mask.mask(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::*;
    use etendue_field::{
        ConvexPolygon, FrequencyAxis, HalfPlane, Hole, Mask, Profile, ProjectionGrid, Rectangle,
        Shape, SliceGrid,
    };

    #[test]
    fn parameters_follow_the_light() {
        let chain = chain(0.2, &[(1.0, blockers(3, 0.3, 0.1)), (0.5, vec![])]);
        let names: Vec<_> = chain.parameters().iter().map(|&p| chain.name(p)).collect();
        assert_eq!(
            names,
            [
                "side x of light",
                "side y of light",
                "position x of light",
                "position y of light",
                "travel a to b",
                "side of b",
                "position x of b",
                "position y of b",
                "travel b to c"
            ]
        );
    }

    /// Tests that the size of bars is their width, along either axis, and not their length, and that
    /// bars move only across their length.
    #[test]
    fn the_size_of_bars_is_their_width() {
        for (size, across) in [([0.05, 2e9], "x"), ([2e9, 0.05], "y")] {
            let bar = Rectangle {
                center: [0.0; 2],
                size,
            };
            let chain = chain(0.2, &[(1.0, vec![bar]), (0.5, vec![])]);
            let names: Vec<_> = chain.parameters().iter().map(|&p| chain.name(p)).collect();
            let moved = format!("position {across} of b");
            assert_eq!(names[5..7], ["width of b".to_owned(), moved]);
            assert_eq!(names.len(), 8);
            let width = chain.parameters()[5];
            assert_eq!(chain.value(width), Some(0.05));
        }
    }

    /// Tests that a chain with a wide disc behind a narrow window is predicted by nets, because a
    /// rule with a quarter more nodes does not reveal its quadrature error.
    #[test]
    fn wide_discs_behind_narrow_windows_are_sampled() {
        let sampled = |radius: f64| {
            let chain = chain_of(spot(disc([0.0; 2], radius), 0.0), [(0.0, None)]);
            let window = window(Profile::Hann(0.1), Profile::Hann(1.0));
            let axis = |spacing| FrequencyAxis { half: 1, spacing };
            let grid = SliceGrid {
                azimuths: 1,
                rho: axis(5.0),
                nu: axis(0.5),
            };
            let picture = ProjectionGrid::new(&window, 1);
            let budget = RayBudget::new(1e6, 1e-3);
            chain.is_sampled((&window, &grid, &picture), budget)
        };
        assert!(!sampled(0.1));
        assert!(sampled(20.0));
    }

    /// Tests that nets replace a slow closed form. Here a narrow spot has a long series of cosines,
    /// and this series is multiplied by the terms of each blocker.
    #[test]
    fn closed_forms_that_take_longer_than_photons_are_sampled() {
        let window = window(Profile::Hann(0.5), Profile::Hann(0.5));
        let axis = |half| FrequencyAxis { half, spacing: 1.0 };
        let grid = SliceGrid {
            azimuths: 8,
            rho: axis(16),
            nu: axis(32),
        };
        let picture = ProjectionGrid::new(&window, 64);
        let over = (&window, &grid, &picture);
        let budget = RayBudget::new(1.1e6, 3e-3);
        for (exponent, is_sampled) in [(0.0, false), (10_000.0, true)] {
            let light = spot(Shape::Rectangle(square([0.0; 2], 0.2)), exponent);
            let masks = rectangles(&blockers(20, 0.2, 0.12));
            let chain = chain_of(light, [(1.0, Some(masks)), (1.0, None)]);
            assert_eq!(chain.is_sampled(over, budget), is_sampled, "{exponent}");
            let steps = chain.work(over, budget).steps;
            assert!(steps <= budget.steps, "{exponent}");
        }
    }

    #[test]
    fn with_sets_one_value() {
        let chain = chain(0.2, &[(1.0, blockers(2, 0.3, 0.1)), (0.5, vec![])]);
        for p in chain.parameters() {
            let other = chain.with(p, 0.5).unwrap();
            assert_eq!(other.value(p), Some(0.5));
            for q in chain.parameters().into_iter().filter(|&q| q != p) {
                assert_eq!(other.value(q), chain.value(q));
            }
        }
    }

    /// Each side of the light changes alone; many shapes of a mask change together.
    #[test]
    fn sides_change_alone_and_the_shapes_of_an_array_together() {
        let mut chain = chain(0.2, &[(1.0, blockers(3, 0.3, 0.1))]);
        let sized = |size| {
            lambertian(Rectangle {
                center: [0.0, 0.1],
                size,
            })
        };
        chain.source.light = sized([0.2, 0.5]);
        let wider = chain.with(Parameter::SourceSize(0), 0.4).unwrap();
        assert_eq!(wider.source.light, sized([0.4, 0.5]));
        let higher = chain.with(Parameter::SourceSize(1), 0.25).unwrap();
        assert_eq!(higher.source.light, sized([0.2, 0.25]));
        let wider = chain.with(Parameter::BlockerSide(1, 0, 0), 0.2).unwrap();
        let expected: Vec<_> = blockers(3, 0.3, 0.1)
            .into_iter()
            .map(|b| Rectangle {
                size: [0.2, 0.2],
                ..b
            })
            .collect();
        let name = "b".into();
        let mask = rectangles(&expected);
        assert_eq!(wider.operators[1], Operator::Visibility { name, mask });
    }

    /// Builds a chain with every kind of parameter.
    fn rich() -> Chain {
        let mixed = Mask::Opaque {
            shapes: vec![
                disc([0.3, 0.1], 0.2),
                Shape::Rectangle(Rectangle {
                    center: [-0.2, 0.05],
                    size: [0.1, 0.3],
                }),
            ],
            half_planes: [(-0.3, false), (0.4, true)]
                .map(|(edge, above)| HalfPlane {
                    axis: 1,
                    edge,
                    above,
                })
                .to_vec(),
        };
        let mut chain = chain_of(
            spot(disc([0.0, 0.0], 0.1), 20.0),
            [(1.0, Some(mixed)), (0.5, Some(grating(0, 5.0, 0.3)))],
        );
        chain.operators.push(cosine());
        chain
    }

    #[test]
    fn parameters_of_every_kind() {
        let chain = rich();
        let said = |p| format!("{} [{}]", chain.name(p), chain.unit(p));
        let all: Vec<_> = chain.parameters().into_iter().map(said).collect();
        assert_eq!(
            all,
            [
                "radius of light [m]",
                "position x of light [m]",
                "position y of light [m]",
                "exponent of light []",
                "travel a to b [m]",
                "radius of shape 1 of b [m]",
                "position x of shape 1 of b [m]",
                "position y of shape 1 of b [m]",
                "side x of shape 2 of b [m]",
                "side y of shape 2 of b [m]",
                "position x of shape 2 of b [m]",
                "position y of shape 2 of b [m]",
                "edge 1 of b [m]",
                "edge 2 of b [m]",
                "travel b to c [m]",
                "frequency of c [1/m]",
                "phase of c [rad]",
            ]
        );
        for p in chain.parameters() {
            let value = |chain: &Chain, p| chain.value(p).unwrap();
            let moved = chain.with(p, value(&chain, p) * 2.0 + 0.01).unwrap();
            let changed = |q: &Parameter| (value(&moved, *q) - value(&chain, *q)).abs() > 1e-3;
            let others: Vec<_> = chain.parameters().into_iter().filter(changed).collect();
            assert_eq!(others, [p]);
        }
        let point = chain_of(Light::Point { intensity: 1.0 }, [(1.0, None)]);
        assert_eq!(point.parameters(), [Parameter::Travel(0)]);
    }

    #[test]
    fn positions_move_one_shape_of_a_mask_and_no_edge() {
        let mut chain = rich();
        let moved = |chain: &Chain, axis, to| {
            let moved = chain
                .with(Parameter::BlockerPosition(1, 0, axis), to)
                .unwrap();
            let Operator::Visibility { mask, .. } = moved.operators[1].clone() else {
                unreachable!("the second operator is a mask")
            };
            mask
        };
        let Mask::Opaque {
            half_planes,
            shapes,
        } = moved(&chain, 0, 0.0)
        else {
            unreachable!("the mask is opaque")
        };
        let at = |x, y| Mask::Opaque {
            shapes: vec![disc([x, y], 0.2), shapes[1]],
            half_planes: half_planes.clone(),
        };
        assert_eq!(moved(&chain, 0, 0.5), at(0.5, 0.1));
        assert_eq!(moved(&chain, 1, -0.5), at(0.3, -0.5));
        let Operator::Visibility { mask, .. } = &mut chain.operators[1] else {
            unreachable!("the second operator is a mask")
        };
        let corners = [[0.0, 0.0], [0.3, 0.0], [0.0, 0.3]].to_vec();
        *mask = Mask::Aperture(Hole::Polygon(ConvexPolygon::new(corners).unwrap()));
        let Mask::Aperture(hole) = moved(&chain, 1, 0.4) else {
            unreachable!("the mask is an aperture")
        };
        let [x, y] = hole.moments().centroid;
        assert!((x - 0.1).abs() < 1e-12 && (y - 0.4).abs() < 1e-12); // rounding
    }

    #[test]
    fn foreign_parameters_have_no_value() {
        for foreign in [
            Parameter::GratingPhase(0),
            Parameter::Albedo,
            Parameter::ImageWidth(0),
        ] {
            assert_eq!(rich().value(foreign), None);
        }
    }
}
