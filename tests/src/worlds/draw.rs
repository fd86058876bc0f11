//! Random worlds, as Mitsuba 3 scenes.

use crate::hostile::dice::Dice;
use std::f64::consts::TAU;
use std::fmt::Display;

/// Number of pixels across and down.
pub(super) const SIZE: [usize; 2] = [48, 32];

/// Parameters of `principled` from 0 to 1.
const PRINCIPLED: &str = "metallic roughness anisotropic specular spec_tint flatness sheen \
    clearcoat clearcoat_gloss";

/// A world with all kinds of shapes, materials, textures and lights, and a pixel of its
/// camera.
pub(super) fn world(seed: u64, number: u64) -> (String, [usize; 2]) {
    let mut draw = WorldDraw(Dice::new(seed, number));
    let pixel = SIZE.map(|side| draw.0.below(side));
    let (sin, cos) = (TAU * draw.0.unit()).sin_cos();
    let [height, distance] = [draw.0.between(0.8, 3.0), draw.0.between(4.0, 6.0)];
    let eye = format!("{:.3},{height:.3},{:.3}", distance * cos, distance * sin);
    let floor = "<scale value=\"5\"/><rotate x=\"1\" angle=\"-90\"/>";
    let mut parts = vec![draw.shape("rectangle", floor)];
    parts.extend((0..3 + draw.0.below(5)).map(|_| draw.object()));
    parts.extend((0..=draw.0.below(3)).map(|_| draw.light()));
    // Mitsuba allows only one light that surrounds the scene.
    if draw.0.one_in(3) {
        parts.push(emitter(
            "constant",
            &value("radiance", draw.0.between(0.2, 1.0)),
        ));
    }
    let [w, h] = SIZE;
    let (depth, fov) = (1 + draw.0.below(4), draw.0.between(30.0, 50.0));
    let text = format!(
        r#"<scene version="3.0.0">
<integrator type="path"><integer name="max_depth" value="{depth}"/></integrator>
<sensor type="perspective"><float name="fov" value="{fov:.2}"/>
<transform name="to_world"><lookat origin="{eye}" target="0,0.3,0" up="0,1,0"/></transform>
<film type="hdrfilm"><integer name="width" value="{w}"/><integer name="height" value="{h}"/><rfilter type="box"/></film></sensor>
{}
</scene>
"#,
        parts.join("\n")
    );
    (text, pixel)
}

fn number(name: &str, number: impl Display) -> String {
    format!("<float name=\"{name}\" value=\"{number}\"/>")
}

fn value(name: &str, value: f64) -> String {
    format!("<spectrum name=\"{name}\" value=\"{value:.4}\"/>")
}

fn emitter(kind: &str, inside: &str) -> String {
    format!("<emitter type=\"{kind}\">{inside}</emitter>")
}

fn bsdf(kind: &str, inside: &str) -> String {
    format!("<bsdf type=\"{kind}\">{inside}</bsdf>")
}

fn shape(kind: &str, transform: &str, inside: &str) -> String {
    format!(
        "<shape type=\"{kind}\"><transform name=\"to_world\">{transform}</transform>{inside}</shape>"
    )
}

/// The random choices for one world.
struct WorldDraw(Dice);

impl WorldDraw {
    /// A number from 0 to 1, often one of the two ends.
    fn share(&mut self) -> String {
        match self.0.below(4) {
            0 => "0".to_owned(),
            1 => "1".to_owned(),
            _ => format!("{:.3}", self.0.unit()),
        }
    }

    /// A number whose logarithm is uniformly distributed.
    fn positive(&mut self, low: f64, high: f64) -> f64 {
        self.0.between(low.ln(), high.ln()).exp()
    }

    /// An object that stands on the floor.
    fn object(&mut self) -> String {
        let kind = *self
            .0
            .pick(&["sphere", "sphere", "cube", "cylinder", "disk", "rectangle"]);
        let size = self.positive(0.15, 0.6);
        let [x, z] = [(); 2].map(|()| self.0.between(-1.5, 1.5));
        // A cylinder of Mitsuba extends from 0 to 1 along Z.
        let upright = match kind {
            "cylinder" => "<translate z=\"-0.5\"/><rotate x=\"1\" angle=\"90\"/>",
            _ => "",
        };
        let turned = self.0.between(0.0, 360.0);
        self.shape(
            kind,
            &format!(
                "{upright}<scale value=\"{size:.3}\"/><rotate y=\"1\" angle=\"{turned:.1}\"/><translate x=\"{x:.3}\" y=\"{size:.3}\" z=\"{z:.3}\"/>"
            ),
        )
    }

    fn shape(&mut self, kind: &str, transform: &str) -> String {
        let material = self.material(0);
        shape(kind, transform, &material)
    }

    fn light(&mut self) -> String {
        let [x, y, z] = [(-2.0, 2.0), (1.5, 3.0), (-2.0, 2.0)].map(|(a, b)| self.0.between(a, b));
        let from = format!("{x:.3},{y:.3},{z:.3}");
        let look = format!("<lookat origin=\"{from}\" target=\"0,0,0\" up=\"0.1,0,1\"/>");
        let placed = format!("<transform name=\"to_world\">{look}</transform>");
        let power = self.0.between(1.0, 4.0);
        let size = self.positive(0.05, 0.6);
        let area = emitter("area", &value("radiance", power / (size * size)));
        match self.0.below(6) {
            0 => emitter("point", &format!("{placed}{}", value("intensity", power))),
            1 => {
                let cutoff = number("cutoff_angle", 30);
                emitter(
                    "spot",
                    &format!("{placed}{cutoff}{}", value("intensity", 4.0 * power)),
                )
            }
            2 => {
                let irradiance = value("irradiance", power);
                let along = format!(
                    "<vector name=\"direction\" value=\"{:.3},{:.3},{:.3}\"/>",
                    -x, -y, -z
                );
                emitter("directional", &format!("{along}{irradiance}"))
            }
            3 => {
                let irradiance = self.reflectance("irradiance");
                let scale = number("scale", format!("{power:.3}"));
                let inside = format!("{placed}{}{scale}{irradiance}", number("fov", 50));
                emitter("projector", &inside)
            }
            4 => shape(
                "rectangle",
                &format!("<scale value=\"{size:.3}\"/>{look}"),
                &area,
            ),
            _ => shape(
                "sphere",
                &format!(
                    "<scale value=\"{size:.3}\"/><translate x=\"{x:.3}\" y=\"{y:.3}\" z=\"{z:.3}\"/>"
                ),
                &area,
            ),
        }
    }

    /// A reflectance, which may be a texture.
    fn reflectance(&mut self, name: &str) -> String {
        if !self.0.one_in(3) {
            return value(name, self.0.between(0.1, 0.9));
        }
        let cells = self.positive(2.0, 20.0);
        let colors = [self.0.between(0.05, 0.4), self.0.between(0.4, 0.9)];
        let colors = [value("color0", colors[0]), value("color1", colors[1])].concat();
        format!(
            "<texture name=\"{name}\" type=\"checkerboard\">{colors}<transform name=\"to_uv\"><scale x=\"{cells:.2}\" y=\"{cells:.2}\"/></transform></texture>"
        )
    }

    fn roughness(&mut self) -> String {
        let distribution = self.0.pick(&["ggx", "beckmann"]);
        let alpha = self.positive(0.03, 0.5);
        format!(
            "{}<string name=\"distribution\" value=\"{distribution}\"/>",
            number("alpha", format!("{alpha:.4}"))
        )
    }

    /// A material. A material at `depth` 1 is part of another material.
    fn material(&mut self, depth: u32) -> String {
        let kinds = if depth == 0 { 13 } else { 7 };
        let both = |of: String| bsdf("twosided", &of);
        match self.0.below(kinds) {
            0 | 1 => both(bsdf("diffuse", &self.reflectance("reflectance"))),
            2 => both(bsdf("plastic", &self.reflectance("diffuse_reflectance"))),
            3 => {
                let inside = self.roughness() + &self.reflectance("diffuse_reflectance");
                both(bsdf("roughplastic", &inside))
            }
            4 => {
                let metal = "<string name=\"material\" value=\"Al\"/>";
                both(bsdf(
                    "roughconductor",
                    &format!("{metal}{}", self.roughness()),
                ))
            }
            5 => {
                let shares = PRINCIPLED.split(' ').map(|name| number(name, self.share()));
                let inside = shares.collect::<String>() + &self.reflectance("base_color");
                both(bsdf("principled", &inside))
            }
            6 => {
                let inside = self.reflectance("diffuse_reflectance")
                    + &value("specular_reflectance", 0.1)
                    + &number("exponent", format!("{:.1}", self.positive(3.0, 300.0)));
                both(bsdf("phong", &inside))
            }
            7 => both(bsdf(
                "conductor",
                "<string name=\"material\" value=\"none\"/>",
            )),
            8 => bsdf("dielectric", ""),
            9 => bsdf("thindielectric", ""),
            10 => bsdf("roughdielectric", &self.roughness()),
            11 => {
                let opacity = number("opacity", format!("{:.3}", self.0.between(0.2, 0.8)));
                bsdf("mask", &(opacity + &self.material(1)))
            }
            _ => {
                let weight = number("weight", format!("{:.3}", self.0.between(0.1, 0.9)));
                bsdf(
                    "blendbsdf",
                    &(weight + &self.material(1) + &self.material(1)),
                )
            }
        }
    }
}
