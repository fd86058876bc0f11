//! The text of `scene.xml`.

use etendue_field::{Disc, Rectangle, Shape, VirtualPlane};
use etendue_scene::Scene;
use glam::DVec3;

/// A scene file being written. Numbers are Rust's shortest that read back the same.
pub(super) struct Xml(String);

impl Xml {
    /// The head: where the coordinates are in the world, the virtual planes, and how light is followed.
    pub(super) fn new(scene: &Scene) -> Self {
        let mut xml =
            Self("<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<scene version=\"3.0.0\">\n".into());
        let frame = scene.path.frame;
        xml.comment(&format!(
            "Étendue scene {:?}. Metres; the origin is the light's centre, z runs along the central ray. In the world \
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
        xml.comment("Light is followed from the light, over one surface at most.");
        xml.line(
            "<integrator type=\"path\"><integer name=\"max_depth\" value=\"2\"/></integrator>",
        );
        xml.line(&format!(
            "<bsdf type=\"diffuse\" id=\"black\">{}</bsdf>",
            spectrum("reflectance", 0.0)
        ));
        xml
    }

    /// A comment. XML allows no two hyphens in one: they are spaced out.
    pub(super) fn comment(&mut self, text: &str) {
        let text = text.replace("--", "- -").replace("--", "- -");
        self.line(&format!("<!-- {text} -->"));
    }

    /// A flat shape across the central ray, facing along z.
    pub(super) fn flat(&mut self, id: &str, shape: &Shape, distance: f64, looks: &str) {
        // Mitsuba's rectangle has corners (±1, ±1), its disk the radius 1.
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

    /// A mesh from a file beside this one.
    pub(super) fn mesh(&mut self, id: &str, file: &str, looks: &str) {
        self.line(&format!(
            "<shape type=\"ply\" id=\"{id}\"><string name=\"filename\" value=\"{file}\"/>\
             <boolean name=\"face_normals\" value=\"true\"/>{looks}</shape>"
        ));
    }

    /// A point light at the origin.
    pub(super) fn point_light(&mut self, intensity: f64) {
        self.line(&format!(
            "<emitter type=\"point\" id=\"light\"><point name=\"position\" x=\"0\" y=\"0\" z=\"0\"/>{}</emitter>",
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

/// The light's emission, on the side its shape faces.
pub(super) fn emitter(radiance: f64) -> String {
    let radiance = spectrum("radiance", radiance);
    format!("<emitter type=\"area\">{radiance}</emitter>")
}

/// A Lambertian material, the same on both sides; Mitsuba's own has a black back.
pub(super) fn diffuse(albedo: f64) -> String {
    let albedo = spectrum("reflectance", albedo);
    format!("<bsdf type=\"twosided\"><bsdf type=\"diffuse\">{albedo}</bsdf></bsdf>")
}

/// A material that reflects nothing; without one, Mitsuba's shapes reflect half.
pub(super) fn black() -> String {
    "<ref id=\"black\"/>".to_owned()
}

fn spectrum(name: &str, value: f64) -> String {
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
        "virtual plane {name:?}: {quantity:?} at {distance:?} m along the path, {side:?} what stands there, \
         after {leg} reflections"
    )
}

/// Coordinates, a space between them.
fn spaced(v: DVec3) -> String {
    format!("({:?} {:?} {:?})", v.x, v.y, v.z)
}
