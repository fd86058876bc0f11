//! Checks blockers: layers of shapes and gratings.

use super::Resolver;
use super::dark_rectangles::dark_rectangles;
use super::jitter::jittered_squares;
use super::overlap::{Thing, overlap};
use crate::scene::BlockerLayer;
use etendue_field::{Disc, Frame, Grating, HalfPlane, Hole, Mask, Rectangle, Shape, tidy};
use etendue_scenefile::limits;
use etendue_scenefile::number;
use etendue_scenefile::{BlockersFile, Color, HalfName, LightFile, SceneFile, ShapeFile};
use glam::DVec3;

/// The approximate number of rectangles into which a prediction divides a disc of a mask.
const STRIPS: f64 = 64.0;

impl Resolver<'_> {
    /// The layers of blockers that lie across the central ray.
    pub(super) fn blockers(&mut self, file: &SceneFile, frame: &Frame) -> Vec<BlockerLayer> {
        let blockers = file.blockers.iter().enumerate();
        blockers
            .filter_map(|(i, blockers)| self.layer(&format!("blockers[{i}]"), blockers, frame))
            .collect()
    }

    /// Checks that blockers stand on the first leg, whose length is `length`.
    pub(super) fn ends(&mut self, file: &SceneFile, layers: &[BlockerLayer], length: f64) {
        for (i, blockers) in file.blockers.iter().enumerate() {
            let layer = layers.iter().find(|layer| layer.name == blockers.name());
            if let Some(layer) = layer.filter(|layer| layer.distance >= length) {
                self.faults.add_on_path(
                    format!("blockers[{i}].center"),
                    format!("at distance {} m from the light", tidy(layer.distance)),
                    format!(
                        "a place before the first surface of the path, at {} m",
                        tidy(length)
                    ),
                );
            }
        }
    }

    /// The layer of blockers; `None` if the blockers are a mesh.
    fn layer(&mut self, of: &str, blockers: &BlockersFile, frame: &Frame) -> Option<BlockerLayer> {
        let (BlockersFile::JitteredSquares { name, center, .. }
        | BlockersFile::Bars { name, center, .. }
        | BlockersFile::Picture { name, center, .. }
        | BlockersFile::Shapes { name, center, .. }
        | BlockersFile::Aperture { name, center, .. }
        | BlockersFile::Grating { name, center, .. }) = blockers
        else {
            return None;
        };
        let center = frame.to_local(DVec3::from(*center));
        self.ahead(of, center.z);
        let (mask, pitch) = self.mask(of, blockers, [center.x, center.y])?;
        Some(BlockerLayer {
            name: name.clone(),
            distance: center.z,
            pitch,
            mask,
        })
    }

    /// The mask of the blockers, and the distance between the repetitions of the mask.
    fn mask(
        &mut self,
        of: &str,
        blockers: &BlockersFile,
        center: [f64; 2],
    ) -> Option<(Mask, Option<f64>)> {
        match blockers {
            BlockersFile::JitteredSquares { pitch, .. } => {
                let shapes = self.squares(of, blockers, center);
                Some((opaque(shapes, Vec::new()), Some(*pitch)))
            }
            &BlockersFile::Bars {
                axis,
                count,
                pitch,
                fill,
                ..
            } => {
                let axis = axis.index();
                let shapes = self.bars(axis, count, pitch, fill, center[axis]);
                Some((opaque(shapes, Vec::new()), Some(pitch)))
            }
            BlockersFile::Picture { file, size, .. } => {
                let shapes = self.dark_pixels(of, file, center, *size);
                Some((opaque(shapes, Vec::new()), None))
            }
            BlockersFile::Shapes { shapes, .. } => Some((self.shapes(of, shapes, center), None)),
            BlockersFile::Aperture { hole, .. } => {
                let hole = self.hole(&format!("{of}.hole"), hole)?;
                Some((Mask::Aperture(hole.mapped(1.0, center)), None))
            }
            BlockersFile::Grating {
                axis,
                frequency,
                modulation,
                phase,
                ..
            } => {
                let axis = axis.index();
                let grating = Grating {
                    axis,
                    frequency: *frequency,
                    modulation: *modulation,
                    phase: phase - std::f64::consts::TAU * frequency * center[axis],
                };
                Some((Mask::Grating(grating), Some(1.0 / frequency)))
            }
            BlockersFile::Mesh { .. } => None,
        }
    }

    fn squares(&mut self, of: &str, blockers: &BlockersFile, center: [f64; 2]) -> Vec<Shape> {
        let &BlockersFile::JitteredSquares {
            count,
            pitch,
            fill,
            jitter,
            seed,
            ..
        } = blockers
        else {
            return Vec::new();
        };
        let total = u64::from(count[0]) * u64::from(count[1]);
        if !(1..=limits::SHAPES as u64).contains(&total) {
            self.faults.add(
                format!("{of}.count"),
                format!("{} x {}", count[0], count[1]),
                format!("1 to {} squares in all", limits::SHAPES),
            );
        }
        if !(fill > 0.0 && fill <= 1.0) {
            let allowed = "above 0, at most 1: a share of the pitch";
            self.faults.add(format!("{of}.fill"), number(fill), allowed);
        // If squares overlapped, the prediction would count the overlap twice. A fill of 0.7 with a
        // jitter of 0.3 is allowed, and the tolerance admits it in spite of rounding errors.
        } else if !(jitter >= 0.0 && fill + jitter <= 1.0 + 1e-12) {
            let allowed = format!("0 to 1 − fill, which is {}", tidy(1.0 - fill));
            self.faults
                .add(format!("{of}.jitter"), number(jitter), allowed);
        }
        if !self.faults.all.is_empty() {
            return Vec::new();
        }
        let squares = jittered_squares(center, count, pitch, fill, jitter, seed);
        squares.into_iter().map(Shape::Rectangle).collect()
    }

    /// Returns bars as long rectangles, about the coordinate `center` along `axis`.
    fn bars(&self, axis: usize, count: u32, pitch: f64, fill: f64, center: f64) -> Vec<Shape> {
        // The count may be too large.
        if !self.faults.all.is_empty() {
            return Vec::new();
        }
        let middle = 0.5 * (f64::from(count) - 1.0);
        let bar = |i: u32| {
            let mut bar = Rectangle {
                center: [0.0; 2],
                size: [2.0 * limits::MAX_NUMBER; 2],
            };
            bar.center[axis] = center + (f64::from(i) - middle) * pitch;
            bar.size[axis] = fill * pitch;
            Shape::Rectangle(bar)
        };
        (0..count).map(bar).collect()
    }

    /// The dark pixels of a picture about `center`, as rectangles.
    fn dark_pixels(
        &mut self,
        of: &str,
        file: &str,
        center: [f64; 2],
        size: [f64; 2],
    ) -> Vec<Shape> {
        let field = format!("{of}.file");
        let Some(raster) = self.picture(&field, file, &["exr", "png"], 1.0) else {
            return Vec::new();
        };
        let rectangles = dark_rectangles(&raster, center, size);
        // A colour filter is clear in one channel.
        let least = usize::from(self.color == Color::Luminance);
        if !(least..=limits::SHAPES).contains(&rectangles.len()) {
            let found = format!("{file:?} with {} opaque rectangles", rectangles.len());
            let allowed = format!(
                "a picture whose pixels below 0.5 form {least} to {} rectangles",
                limits::SHAPES
            );
            self.faults.add(field, found, allowed);
            return Vec::new();
        }
        rectangles.into_iter().map(Shape::Rectangle).collect()
    }

    /// The mask of the shapes, moved to `center`.
    fn shapes(&mut self, of: &str, files: &[ShapeFile], center: [f64; 2]) -> Mask {
        if !(1..=limits::SHAPES).contains(&files.len()) {
            let allowed = format!("1 to {} shapes", limits::SHAPES);
            self.faults.add(
                format!("{of}.shapes"),
                format!("{} shapes", files.len()),
                allowed,
            );
        }
        let moved = |c: [f64; 2]| [center[0] + c[0], center[1] + c[1]];
        let (mut shapes, mut half_planes) = (Vec::new(), Vec::new());
        // The index of each shape and of each half-plane in the file.
        let (mut of_shapes, mut of_half_planes) = (Vec::new(), Vec::new());
        for (i, file) in files.iter().take(limits::SHAPES).enumerate() {
            match file {
                ShapeFile::HalfPlane { .. } => of_half_planes.push(i),
                _ => of_shapes.push(i),
            }
            match *file {
                ShapeFile::Rectangle { center, size } => {
                    let center = moved(center);
                    shapes.push(Shape::Rectangle(Rectangle { center, size }));
                }
                ShapeFile::Disc { center, radius } => {
                    let center = moved(center);
                    shapes.push(Shape::Disc(Disc { center, radius }));
                }
                ShapeFile::HalfPlane { axis, edge, opaque } => {
                    half_planes.push(HalfPlane {
                        axis: axis.index(),
                        edge: edge + center[axis.index()],
                        above: opaque == HalfName::Above,
                    });
                }
            }
        }
        if self.faults.all.is_empty() {
            self.apart(of, &shapes, &half_planes, [&of_shapes, &of_half_planes]);
        }
        opaque(shapes, half_planes)
    }

    /// Refuses overlaps of shapes, which the prediction would count twice. `places` are the
    /// indices of shapes and of half-planes in the file.
    fn apart(
        &mut self,
        of: &str,
        shapes: &[Shape],
        half_planes: &[HalfPlane],
        places: [&[usize]; 2],
    ) {
        if let Some([a, b]) = overlap(shapes, half_planes) {
            let place = |thing: Thing| match thing {
                Thing::Shape(i) => places[0][i],
                Thing::HalfPlane(i) => places[1][i],
            };
            let (a, b) = (place(a), place(b));
            let (low, high) = (a.min(b), a.max(b));
            self.faults.add(
                format!("{of}.shapes"),
                format!("a list in which shapes[{low}] and shapes[{high}] overlap"),
                "shapes that do not overlap; put them in two layers",
            );
        }
    }

    /// Limits the sum and the product of the numbers of shapes of all layers. A prediction sums
    /// over all combinations of shapes.
    pub(super) fn layers(&mut self, light: &LightFile, layers: &[BlockerLayer]) {
        let of_shape = |shape: &Shape| match shape {
            Shape::Disc(_) => STRIPS,
            Shape::Rectangle(_) => 1.0,
        };
        let terms = |layer: &BlockerLayer| match &layer.mask {
            Mask::Opaque {
                shapes,
                half_planes,
            } => shapes.iter().map(of_shape).sum::<f64>() + half_planes.len() as f64,
            Mask::Grating(_) => 3.0,
            Mask::Aperture(Hole::Shape(shape)) => of_shape(shape),
            Mask::Aperture(Hole::Polygon(_)) => 1.0,
        };
        let shapes = layers.iter().map(|layer| match &layer.mask {
            Mask::Opaque { shapes, .. } => shapes.len(),
            Mask::Grating(_) | Mask::Aperture(_) => 0,
        });
        let (shapes, most) = (shapes.sum::<usize>(), limits::SHAPES);
        self.at_most(
            "blockers: shapes of all layers",
            shapes as u64,
            "shapes",
            most as u64,
        );
        let light = match light {
            LightFile::Disc { .. } => STRIPS,
            _ => 1.0,
        };
        let terms = layers.iter().map(terms);
        let product: f64 = light * terms.map(|terms| terms.max(1.0)).product::<f64>();
        if product > limits::PRODUCTS {
            let most = limits::PRODUCTS;
            let allowed = format!(
                "at most {most:.0e}: the numbers of shapes of the light (64 for a disc) and of all layers are multiplied"
            );
            self.faults
                .add("blockers: shapes", number(product), allowed);
        }
    }
}

fn opaque(shapes: Vec<Shape>, half_planes: Vec<HalfPlane>) -> Mask {
    Mask::Opaque {
        shapes,
        half_planes,
    }
}
