//! Links the results of a run to the explorer, for scenes that the explorer supports.

use etendue_explorer::{SettingKey, Setup, scene};
use etendue_field::Profile;
use etendue_scene::{
    BlockersFile, ColorFile, EventFile, FormFile, LightFile, LobeFile, SceneFile, ShapeFile,
    SurfaceFile,
};

/// The file name of the page, among the results of a run.
pub(crate) const NAME: &str = "explorer.html";
/// The page built by `.ci/explorer`.
pub(crate) const PAGE: &[u8] = include_bytes!("explorer.html");

/// The part after `#` in the address at which the explorer shows a scene; `None` if the
/// explorer does not support the scene.
///
/// A scene is supported if the explorer, with its controls set to the numbers of the scene, saves
/// the same scene. Planes, names and the extent of surfaces may differ.
pub(crate) fn fragment(file: &SceneFile) -> Option<String> {
    let setup = setup(file)?;
    let saved = SceneFile::parse(&scene(&setup)).ok()?;
    let [mut file, saved] = [file, &saved].map(|file| plain(file.clone()));
    for (blockers, saved) in file.blockers.iter_mut().zip(&saved.blockers) {
        if are_near(blockers, saved) {
            *blockers = saved.clone();
        }
    }
    (file == saved).then(|| setup.fragment())
}

/// The precision, in inverse metres, of values derived from positions and sides of slats.
const DIGITS: f64 = 1e12;

/// Checks whether two layers are slats that differ only by rounding errors.
fn are_near(a: &BlockersFile, b: &BlockersFile) -> bool {
    let of = |blockers: &BlockersFile| {
        let BlockersFile::Shapes { center, shapes, .. } = blockers else {
            return None;
        };
        let mut numbers = center.to_vec();
        for shape in shapes {
            let ShapeFile::Rectangle { center, size } = shape else {
                return None;
            };
            numbers.extend(center.iter().chain(size));
        }
        Some(numbers)
    };
    let (Some(a), Some(b)) = (of(a), of(b)) else {
        return false;
    };
    a.len() == b.len() && a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1.0 / DIGITS)
}

/// The scene with fixed values in some fields: the fields that may differ when the explorer
/// saves the scene.
fn plain(mut file: SceneFile) -> SceneFile {
    for blockers in &mut file.blockers {
        if let BlockersFile::JitteredSquares { name, .. } | BlockersFile::Shapes { name, .. } =
            blockers
        {
            "blockers".clone_into(name);
        }
    }
    for surface in &mut file.surfaces {
        match surface {
            SurfaceFile::Rectangle { name, .. } => "receiver".clone_into(name),
            SurfaceFile::Smooth { name, aperture, .. } => {
                "receiver".clone_into(name);
                *aperture = 1.0;
            }
            SurfaceFile::Mesh { .. } => {}
        }
    }
    file.path.visits = vec!["receiver".to_owned(); file.path.visits.len()];
    file.frequencies.azimuths = 1;
    for (axis, profile) in [
        (&mut file.frequencies.rho, file.window.x),
        (&mut file.frequencies.nu, file.window.u),
    ] {
        let spacing = axis.spacing.unwrap_or(0.5 / profile.half_width());
        axis.spacing = Some(spacing);
        axis.max = (axis.max / spacing - 1e-9).ceil() * spacing;
    }
    SceneFile {
        description: String::new(),
        planes: Vec::new(),
        run: etendue_scene::RunFile::default(),
        ..file
    }
}

/// The explorer's numbers for a scene. The function assumes that the explorer supports the
/// scene.
fn setup(file: &SceneFile) -> Option<Setup> {
    let mut setup = Setup::default();
    let LightFile::Rectangle { center, size, .. } = &file.light else {
        return None;
    };
    let [surface] = &file.surfaces[..] else {
        return None;
    };
    let (Profile::Hann(x), Profile::Hann(u)) = (file.window.x, file.window.u) else {
        return None;
    };
    let spacing = |axis: &etendue_scene::AxisFile, half: f64| axis.spacing.unwrap_or(0.5 / half);
    let (rho, nu) = (&file.frequencies.rho, &file.frequencies.nu);
    for (key, value) in [
        (SettingKey::Travel, place(surface)[2]),
        (SettingKey::Width, size[0]),
        (SettingKey::Position, center[0]),
        (SettingKey::WindowX, x),
        (SettingKey::WindowU, u),
        (SettingKey::RhoMax, rho.max),
        (SettingKey::RhoStep, spacing(rho, x)),
        (SettingKey::NuMax, nu.max),
        (SettingKey::NuStep, spacing(nu, u)),
    ] {
        setup.set(key, value);
    }
    reflection(surface, &mut setup)?;
    match &file.blockers[..] {
        [] => setup.set(SettingKey::Fill, 0.0),
        [blockers] => stopped(blockers, &mut setup)?,
        _ => return None,
    }
    Some(setup)
}

fn place(surface: &SurfaceFile) -> [f64; 3] {
    match surface {
        SurfaceFile::Rectangle { center, .. }
        | SurfaceFile::Smooth { center, .. }
        | SurfaceFile::Mesh { center, .. } => *center,
    }
}

/// The number of a colour that has no hue; the explorer has no colours.
fn grey(color: ColorFile) -> Option<f64> {
    match color {
        ColorFile::Grey(number) => Some(number),
        ColorFile::Rgb(_) => None,
    }
}

fn reflection(surface: &SurfaceFile, setup: &mut Setup) -> Option<()> {
    match surface {
        SurfaceFile::Rectangle { albedo, .. } => setup.set(SettingKey::Albedo, grey(*albedo)?),
        SurfaceFile::Smooth {
            form,
            event: EventFile::Reflects { brdf, .. },
            ..
        } => {
            let LobeFile::Phong(exponent) = brdf.lobe else {
                return None;
            };
            setup.set(SettingKey::Glossy, 1.0);
            setup.set(SettingKey::Exponent, exponent);
            setup.set(SettingKey::Albedo, grey(brdf.albedo)?);
            let curvature = match form {
                FormFile::Plane => 0.0,
                FormFile::Sphere(curvature) => *curvature,
                _ => return None,
            };
            setup.set(SettingKey::Curvature, curvature);
        }
        _ => return None,
    }
    Some(())
}

#[expect(
    clippy::cast_precision_loss,
    reason = "scenes with seeds and counts beyond the explorer's range are not supported"
)]
fn stopped(blockers: &BlockersFile, setup: &mut Setup) -> Option<()> {
    let mut set = |distance: f64, count: usize, pitch: f64, fill: f64| {
        setup.set(SettingKey::Distance, distance);
        setup.set(SettingKey::Count, count as f64);
        setup.set(SettingKey::Pitch, pitch);
        setup.set(SettingKey::Fill, fill);
    };
    match blockers {
        BlockersFile::JitteredSquares {
            center,
            count,
            pitch,
            fill,
            jitter,
            seed,
            ..
        } => {
            set(center[2], count[0] as usize, *pitch, *fill);
            setup.set(SettingKey::Squares, 1.0);
            setup.set(SettingKey::Jitter, *jitter);
            setup.set(SettingKey::Seed, *seed as f64);
        }
        BlockersFile::Shapes { center, shapes, .. } => {
            let [ShapeFile::Rectangle { center: a, size }, .., last] = &shapes[..] else {
                return None;
            };
            let ShapeFile::Rectangle { center: b, .. } = last else {
                return None;
            };
            let rounded = |x: f64| (x * DIGITS).round() / DIGITS;
            let pitch = rounded((b[0] - a[0]) / (shapes.len() - 1) as f64);
            set(center[2], shapes.len(), pitch, rounded(size[0] / pitch));
        }
        _ => return None,
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn known(setup: &Setup) -> Option<Setup> {
        let file = SceneFile::parse(&scene(setup)).unwrap();
        fragment(&file).map(|text| Setup::of_fragment(&text))
    }

    #[test]
    fn saved_scenes_come_back() {
        for text in [
            "",
            "fill=0",
            "travel=1.3&at=0.4&position=0.07",
            "pitch=0.071&fill=0.37&count=20",
            "squares=1&jitter=0.3&count=20",
            "glossy=1&curvature=-0.3",
            "glossy=1&curvature=0",
        ] {
            let setup = Setup::of_fragment(text);
            assert_eq!(known(&setup), Some(setup), "{text}");
        }
    }

    #[test]
    fn other_scenes_have_no_link() {
        let file = SceneFile::parse(&scene(&Setup::default())).unwrap();
        let mut oblique = file.clone();
        oblique.path.direction = [0.1, 0.0, 1.0];
        let mut bright = file.clone();
        let LightFile::Rectangle { radiance, .. } = &mut bright.light else {
            unreachable!()
        };
        *radiance = 2.0.into();
        let mut far = file;
        let SurfaceFile::Rectangle { center, .. } = &mut far.surfaces[0] else {
            unreachable!()
        };
        center[2] = 7.0;
        for other in [oblique, bright, far] {
            assert_eq!(fragment(&other), None);
        }
    }

    /// Checks that the page was built with the same colors as pictures.
    #[test]
    fn the_explorer_has_the_colors_of_pictures() {
        use base64::Engine;
        let [sequential, _] = etendue_figures::palettes();
        let colors = base64::engine::general_purpose::STANDARD.encode(sequential);
        let page = std::str::from_utf8(PAGE).unwrap();
        assert!(page.contains(&colors));
    }
}
