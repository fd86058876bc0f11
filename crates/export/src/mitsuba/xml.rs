//! The text of `scene.xml`.

use etendue_field::{Disc, Frame, Rectangle, Shape, VirtualPlane};
use etendue_scene::Scene;
use glam::DVec3;

/// A scene file that is being written. Each number is written in Rust's shortest form that reads
/// back exactly.
pub(super) struct Xml(String);

impl Xml {
    /// A file with its header. The header states where the coordinates lie in the world,
    /// and has the virtual planes and the integrator.
    pub(super) fn new(scene: &Scene) -> Self {
        let mut xml =
            Self("<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<scene version=\"3.0.0\">\n".into());
        let frame = scene.path.frame;
        xml.comment(&format!(
            "Étendue scene {:?}. Lengths are in metres; the origin is the centre of the light, and z points along the central ray. In the world \
             of the scene file the origin is {}, x is {}, y is {}, z is {}.",
            scene.name,
            spaced(frame.origin),
            spaced(frame.x),
            spaced(frame.y),
            spaced(frame.d)
        ));
        for plane in &scene.planes {
            xml.comment(&plane_text(plane));
        }
        let surfaces = (scene.path.legs.len() - 1).max(1);
        xml.comment(&format!("Paths have at most {surfaces} surfaces."));
        xml.line(&format!(
            "<integrator type=\"path\"><integer name=\"max_depth\" value=\"{}\"/></integrator>",
            surfaces + 1
        ));
        xml.line(&format!(
            "<bsdf type=\"diffuse\" id=\"black\">{}</bsdf>",
            spectrum("reflectance", 0.0)
        ));
        xml
    }

    /// Writes a comment. XML forbids double hyphens in comments, so spaces separate the hyphens.
    pub(super) fn comment(&mut self, text: &str) {
        let text = text.replace("--", "- -").replace("--", "- -");
        self.line(&format!("<!-- {text} -->"));
    }

    /// Writes a flat shape across the central ray that faces along z.
    pub(super) fn flat(&mut self, id: &str, shape: &Shape, distance: f64, looks: &str) {
        // Mitsuba's rectangle has the corners (±1, ±1), and its disk has the radius 1.
        let (name, half, [x, y]) = match *shape {
            Shape::Rectangle(Rectangle { center, size }) => {
                ("rectangle", size.map(|side| 0.5 * side), center)
            }
            Shape::Disc(Disc { center, radius }) => ("disk", [radius; 2], center),
        };
        let [a, b] = half;
        self.line(&format!(
            "<shape type=\"{name}\" id=\"{id}\"><transform name=\"to_world\">\
             <scale x=\"{a:?}\" y=\"{b:?}\"/><translate x=\"{x:?}\" y=\"{y:?}\" z=\"{distance:?}\"/>\
             </transform>{looks}</shape>"
        ));
    }

    /// Writes a disc that faces along D of a frame.
    pub(super) fn disk(&mut self, id: &str, frame: &Frame, radius: f64, looks: &str) {
        let axes = [frame.x * radius, frame.y * radius, frame.d, frame.origin];
        self.line(&format!(
            "<shape type=\"disk\" id=\"{id}\">{}{looks}</shape>",
            matrix(axes)
        ));
    }

    /// Writes a projector at the origin that emits along z. In its square picture, y points up and
    /// −x points to the right.
    pub(super) fn projector(&mut self, file: &str, degrees: f64) {
        self.line(&format!(
            "<emitter type=\"projector\" id=\"light\"><float name=\"fov\" value=\"{degrees:?}\"/>\
             <string name=\"fov_axis\" value=\"x\"/>{}</emitter>",
            picture("irradiance", file)
        ));
    }

    /// Writes distant light that is given by a picture of all directions. In the picture, Y of the
    /// frame is up and D is at the centre.
    pub(super) fn sky(&mut self, file: &str, frame: &Frame) {
        let axes = [frame.x, frame.y, frame.d, DVec3::ZERO];
        self.line(&format!(
            "<emitter type=\"envmap\" id=\"light\"><string name=\"filename\" value=\"{file}\"/>{}</emitter>",
            matrix(axes)
        ));
    }

    /// Writes a mesh that is read from a file in the same folder.
    pub(super) fn mesh(&mut self, id: &str, file: &str, looks: &str) {
        self.line(&format!(
            "<shape type=\"ply\" id=\"{id}\"><string name=\"filename\" value=\"{file}\"/>{looks}</shape>"
        ));
    }

    /// Writes a point light at the origin that emits along z and up to 90° from it. Mitsuba needs a
    /// beam that is narrower than the cutoff.
    pub(super) fn point_light(&mut self, intensity: f64) {
        self.line(&format!(
            "<emitter type=\"spot\" id=\"light\"><float name=\"cutoff_angle\" value=\"90\"/>\
             <float name=\"beam_width\" value=\"89.999\"/>{}</emitter>",
            spectrum("intensity", intensity)
        ));
    }

    pub(super) fn finish(self) -> String {
        self.0 + "</scene>\n"
    }

    fn line(&mut self, text: &str) {
        self.0 += "    ";
        self.0 += text;
        self.0 += "\n";
    }
}

/// The emission of a light on the front of its shape.
pub(super) fn emitter(radiance: f64) -> String {
    let radiance = spectrum("radiance", radiance);
    format!("<emitter type=\"area\">{radiance}</emitter>")
}

/// A Lambertian material that is the same on both sides. Mitsuba's diffuse material has a
/// black back.
pub(super) fn diffuse(albedo: f64) -> String {
    let albedo = spectrum("reflectance", albedo);
    format!("<bsdf type=\"twosided\"><bsdf type=\"diffuse\">{albedo}</bsdf></bsdf>")
}

/// A black material. It is needed because Mitsuba's default material reflects half of the
/// light.
pub(super) fn black() -> String {
    "<ref id=\"black\"/>".to_owned()
}

/// The texture for a picture that covers a whole light, without scaling.
pub(super) fn picture(name: &str, file: &str) -> String {
    format!(
        "<texture type=\"bitmap\" name=\"{name}\"><string name=\"filename\" value=\"{file}\"/>\
         <boolean name=\"raw\" value=\"true\"/><string name=\"wrap_mode\" value=\"clamp\"/></texture>"
    )
}

/// The transform that gives a shape these axes and this origin.
fn matrix([x, y, z, origin]: [DVec3; 4]) -> String {
    let row = |i: usize| format!("{:?} {:?} {:?} {:?}", x[i], y[i], z[i], origin[i]);
    let rows = [0, 1, 2].map(row).join(" ");
    format!("<transform name=\"to_world\"><matrix value=\"{rows} 0 0 0 1\"/></transform>")
}

pub(super) fn spectrum(name: &str, value: f64) -> String {
    format!("<spectrum name=\"{name}\" value=\"{value:?}\"/>")
}

fn plane_text(plane: &VirtualPlane) -> String {
    let VirtualPlane {
        name,
        distance,
        leg,
        side,
        quantity,
        ..
    } = plane;
    format!(
        "virtual plane {name:?}: {quantity:?} at {distance:?} m along the path, {side:?} the object there, \
         after {leg} reflections"
    )
}

/// Returns coordinates separated by spaces.
fn spaced(v: DVec3) -> String {
    format!("({:?} {:?} {:?})", v.x, v.y, v.z)
}
