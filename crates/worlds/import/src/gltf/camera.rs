//! Cameras of a glTF file.

use super::node::PlacedNode;
use super::reader::GltfReader;
use crate::range::MAX_NUMBER;
use ::gltf::json::camera::{Orthographic, Perspective};
use etendue_field::whole;
use etendue_world::{Camera, Projection};
use std::f64::consts::PI;

/// Width of pictures in pixels, which is constant because glTF files do not state a resolution.
const ACROSS: usize = 512;

/// Allowed aspect ratios. In this range, the height is at least one pixel and at most the allowed
/// number.
const ASPECTS: [f64; 2] = [1.0 / 32.0, 512.0];

/// A projection, its scale, the aspect ratio of the picture, and the clip planes.
type CameraView = (Projection, f64, f64, [f64; 2]);

impl<'a> GltfReader<'a> {
    pub(super) fn camera_of(&mut self, placed: &PlacedNode<'a>, number: usize) {
        let path = format!("cameras[{number}]");
        let Some(camera) = self.root.cameras.get(number) else {
            return;
        };
        let Some(looking) = placed.looking() else {
            return self.cause(&placed.path, "scales the camera of this node to size 0");
        };
        let read = match (&camera.perspective, &camera.orthographic) {
            (Some(of), _) => self.perspective(of, &format!("{path}.perspective")),
            (_, Some(of)) => self.orthographic(of, &format!("{path}.orthographic")),
            _ => None,
        };
        let Some((projection, scale, aspect, clip)) = read else {
            return;
        };
        let mut to_world = looking;
        to_world.matrix3.x_axis *= scale;
        to_world.matrix3.y_axis *= scale;
        let own = || camera.name.clone();
        let name = placed.node.name.clone().or_else(own).unwrap_or(path);
        self.world.cameras.push(Camera {
            name,
            to_world,
            size: size(aspect),
            projection,
            clip,
        });
        self.note_once("cameras have no resolution: pictures are 512 pixels wide, and their aspect ratio determines the height");
    }

    fn perspective(&mut self, of: &Perspective, path: &str) -> Option<CameraView> {
        let field = |name: &str| format!("{path}.{name}");
        let yfov = self.within(&field("yfov"), of.yfov, [1e-4, PI - 1e-4]);
        let aspect = match of.aspect_ratio {
            Some(aspect) => self.within(&field("aspectRatio"), aspect, ASPECTS),
            None => {
                self.note(path, "has no aspectRatio: 1 is used");
                Some(1.0)
            }
        };
        let near = self.within(&field("znear"), of.znear, [f64::MIN_POSITIVE, MAX_NUMBER]);
        let far = match of.zfar {
            Some(far) => self.within(&field("zfar"), far, [of.znear.into(), MAX_NUMBER]),
            None => Some(f64::INFINITY),
        };
        let (aspect, tangent) = (aspect?, libm::tan(yfov? / 2.0));
        let [w, h] = size(aspect);
        let projection = Projection::Perspective {
            half_width: tangent * w as f64 / h as f64,
            shift: [0.0; 2],
            lens: None,
        };
        Some((projection, 1.0, aspect, [near?, far?]))
    }

    fn orthographic(&self, of: &Orthographic, path: &str) -> Option<CameraView> {
        let field = |name: &str| format!("{path}.{name}");
        let [xmag, ymag] = [("xmag", of.xmag), ("ymag", of.ymag)]
            .map(|(name, value)| self.within(&field(name), value, [1e-9, 1e9]));
        let near = self.within(&field("znear"), of.znear, [0.0, MAX_NUMBER]);
        let far = self.within(&field("zfar"), of.zfar, [of.znear.into(), MAX_NUMBER]);
        let (xmag, ymag) = (xmag?, ymag?);
        let aspect = xmag / ymag;
        if !(ASPECTS[0]..=ASPECTS[1]).contains(&aspect) {
            let message = format!("xmag divided by ymag is {aspect}; allowed: {ASPECTS:?}");
            return self.refuse(path, message);
        }
        Some((Projection::Orthographic, xmag, aspect, [near?, far?]))
    }
}

/// The width and height in pixels.
fn size(aspect: f64) -> [usize; 2] {
    [ACROSS, whole((ACROSS as f64 / aspect).round()).max(1)]
}
