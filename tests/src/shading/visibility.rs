//! Tests visibility: compares theory's prediction of light behind a mask with the light field
//! itself.

use super::operators::OperatorComparison;
use super::primal::{between, wave};
use crate::rows::Line;
use crate::table1::apart;
use etendue_field::{Complex, HalfPlane, Light, Mask, Profile, Rectangle, Shape, Window};
use etendue_theory::{Chain, Operator, Source, at};

/// Half-sides of the light, distance from the light to the mask, and distance from the mask to
/// the plane, in metres.
const LIGHT: [f64; 2] = [0.2, 0.3];
const BEFORE: f64 = 1.0;
const AFTER: f64 = 0.7;
/// Half-widths of Hann windows over position and slope.
const WINDOW: [f64; 2] = [0.4, 0.5];
/// Number of nodes on either side of the centre of each interval between two kinks.
const NODES: i32 = 30;

/// Compares theory with the light field itself, behind a rectangle and behind a half-plane.
pub(super) fn all() -> Vec<OperatorComparison> {
    let rectangle = Rectangle {
        center: [0.1, -0.05],
        size: [0.2, 0.16],
    };
    let edge = HalfPlane {
        axis: 0,
        edge: 0.05,
        above: true,
    };
    let opaque = |shapes: Vec<Shape>, half_planes: Vec<HalfPlane>| Mask::Opaque {
        shapes,
        half_planes,
    };
    vec![
        row(
            "visibility of a rectangle",
            &opaque(vec![Shape::Rectangle(rectangle)], Vec::new()),
            [0, 1].map(|axis| rectangle.extent(axis)),
        ),
        row(
            "visibility of a half-plane",
            &opaque(Vec::new(), vec![edge]),
            [
                [edge.edge, f64::INFINITY],
                [f64::NEG_INFINITY, f64::INFINITY],
            ],
        ),
    ]
}

fn row(operator: &'static str, mask: &Mask, blocked: [[f64; 2]; 2]) -> OperatorComparison {
    let theory = |masks: &[&Mask]| -> Vec<Complex> {
        let travel = |distance| Operator::Travel {
            from: "a".to_owned(),
            to: "b".to_owned(),
            distance,
        };
        let shape = Rectangle {
            center: [0.0; 2],
            size: LIGHT.map(|half| 2.0 * half),
        };
        let masks = masks.iter().map(|mask| Operator::Visibility {
            name: "mask".to_owned(),
            mask: (*mask).clone(),
        });
        let chain = Chain {
            source: Source {
                name: "light".to_owned(),
                light: Light::Area {
                    shape: Shape::Rectangle(shape),
                    radiance: 1.0,
                    exponent: 0.0,
                },
            },
            operators: std::iter::once(travel(BEFORE))
                .chain(masks)
                .chain([travel(AFTER)])
                .collect(),
        };
        let [x, u] = WINDOW.map(Profile::Hann);
        let window = Window { x, y: x, u, v: u };
        let each = frequencies().into_iter();
        each.map(|frequency| at(&chain, &window, frequency))
            .collect()
    };
    let everywhere = [f64::NEG_INFINITY, f64::INFINITY];
    let each = frequencies().into_iter();
    let primal: Vec<Complex> = each
        .map(|[x, y, u, v]| {
            let product = |passed: [[f64; 2]; 2]| {
                section(LIGHT[0], passed[0], [x, u]) * section(LIGHT[1], passed[1], [y, v])
            };
            product([everywhere; 2]) - product(blocked)
        })
        .collect();
    OperatorComparison {
        operator,
        line: Some(Line::Visibility),
        compared: "spectrum behind the mask with the transform of what passes the mask".to_owned(),
        off: apart(&theory(&[mask]), &primal),
        fault: ("the mask left out", apart(&theory(&[]), &primal)),
    }
}

/// Frequencies (Ωx, Ωy, Ωu, Ωv).
fn frequencies() -> Vec<[f64; 4]> {
    let each = (0..12).map(f64::from);
    each.map(|i| [0.4 * i - 2.0, 1.1 - 0.3 * i, 0.5 * i - 3.0, 0.2 * i])
        .collect()
}

/// The transform in (x, u) of the windowed light of a strip that passes the mask within
/// the interval `passed`.
fn section(light: f64, passed: [f64; 2], [along_x, along_u]: [f64; 2]) -> Complex {
    let [half, steepest] = WINDOW;
    let hann = |t: f64, half: f64| 0.5 + 0.5 * (std::f64::consts::PI * t / half).cos();
    // The integration over x has bounds of the form a + b u, where u is the slope.
    let far = BEFORE + AFTER;
    let lows = [[-half, 0.0], [-light, far], [passed[0].max(-1e3), AFTER]];
    let highs = [[half, 0.0], [light, far], [passed[1].min(1e3), AFTER]];
    let bounds = [lows, highs].concat();
    let mut kinks = vec![-steepest, steepest];
    for (i, [a, b]) in bounds.iter().enumerate() {
        for [c, d] in &bounds[..i] {
            kinks.push((c - a) / (b - d));
        }
    }
    kinks.retain(|u| u.abs() <= steepest);
    kinks.sort_by(f64::total_cmp);
    let inner = |u: f64| -> Complex {
        let on = |bounds: &[[f64; 2]; 3]| bounds.map(|[a, b]| a + b * u);
        let low = on(&lows).into_iter().fold(f64::NEG_INFINITY, f64::max);
        let high = on(&highs).into_iter().fold(f64::INFINITY, f64::min);
        if low >= high {
            return Complex::default();
        }
        let nodes = between([low, high], NODES).into_iter();
        nodes
            .map(|(x, w)| wave(along_x * x) * (w * hann(x, half)))
            .sum()
    };
    let pieces = kinks.windows(2).filter(|piece| piece[0] < piece[1]);
    let nodes = pieces.flat_map(|piece| between([piece[0], piece[1]], NODES));
    nodes
        .map(|(u, w)| inner(u) * wave(along_u * u) * (w * hann(u, steepest)))
        .sum()
}
