//! Tests random scenes with several surfaces that scatter or redirect light, and with masks on any
//! leg. Photons must not reject any prediction for these scenes.

use super::draw::SceneDraw;
use super::planted::planted;
use super::scene;
use super::small::{MORE_PHOTONS, SmallEnding, SmallEndings, SmallOptions};
use super::small::{kept_ending, object, plane, sharpen, tried};
use crate::report::{Check, ReportSection, Row};
use etendue_compare::{Class, Verdict};
use etendue_predict::Applicability;
use etendue_scene::{Event, Object, Scene, SceneFile, resolve};
use etendue_theory::PathKind;
use std::io;
use std::path::Path;
use std::time::Instant;

/// Number of cycles across the window at the highest frequency. The number of cycles is small,
/// because few photons arrive at the plane.
const CYCLES: f64 = 3.0;
/// Maximum number of scattering surfaces that are counted separately.
const MAX_SCATTERERS: usize = 3;
/// Range of the ratio of an occluder's width to the light's width.
const WIDE: [f64; 2] = [0.02, 0.4];

/// The outcome for one plane of a scene.
struct Tried {
    number: u64,
    scatterers: usize,
    /// Whether the theory for several surfaces predicts the plane.
    by_paths: bool,
    ending: SmallEnding,
    seconds: f64,
}

/// If the options request planted faults, plants faults in predictions. Otherwise tests all scenes.
pub(crate) fn several(options: &SmallOptions) -> io::Result<ReportSection> {
    if options.planted {
        return Ok(planted());
    }
    let tried = tried(options, |number, folder| {
        let Some(scene) = drawn(options, number, folder) else {
            return Ok(None);
        };
        let begun = Instant::now();
        let ending = kept_ending(options, number, &scene, folder)?;
        let theory = Applicability::new(&scene, &scene.planes[0]).theory;
        Ok(Some(Tried {
            number,
            scatterers: scatterers(&scene),
            by_paths: theory.path_of(PathKind::Several).is_some(),
            ending,
            seconds: begun.elapsed().as_secs_f64(),
        }))
    })?;
    Ok(section(options, &tried))
}

/// A scene whose central ray visits two or more surfaces, with one plane and usually an
/// occluder.
fn drawn(options: &SmallOptions, number: u64, folder: &Path) -> Option<Scene> {
    const TRIES: u64 = 40;
    let resolved = |file: &SceneFile| resolve("several", file.clone(), folder, u64::MAX).ok();
    for attempt in 0..TRIES {
        let number = number * TRIES + attempt;
        let mut draw = SceneDraw::new(options.seed ^ 0x7e7e, number, folder);
        let Ok(mut file) = scene(options.seed, number, options.photons, folder) else {
            continue;
        };
        if file.path.visits.len() < 2 {
            continue;
        }
        file.run.photons = options.photons;
        sharpen(&mut file, CYCLES);
        let Some(whole) = resolved(&file) else {
            continue;
        };
        file.planes = vec![plane(&mut draw, &whole)];
        let Some(open) = resolved(&file).filter(|open| open.planes[0].leg >= 2) else {
            continue;
        };
        if draw.one_in(4) {
            return Some(open);
        }
        object(&mut draw, &open, &mut file, WIDE);
        if let Some(scene) = resolved(&file) {
            return Some(scene);
        }
    }
    None
}

/// The number of scattering surfaces before the plane.
fn scatterers(scene: &Scene) -> usize {
    let legs = scene.path.legs[..=scene.planes[0].leg].iter();
    let hits = legs.filter_map(|leg| leg.leaves);
    let scatters = |object: Object| match object {
        Object::Surface(_) => true,
        Object::Patch(i) => matches!(scene.patches[i].event, Event::Reflects(_)),
        Object::Mesh(i) => scene.meshes[i].smooth.is_none(),
    };
    hits.filter(|hit| scatters(hit.object)).count()
}

fn section(options: &SmallOptions, tried: &[Tried]) -> ReportSection {
    let row = |scatterers: usize| {
        let of_kind = tried.iter().filter(|tried| tried.scatterers == scatterers);
        let of_kind: Vec<&Tried> = of_kind.collect();
        let endings = of_kind.iter().map(|tried| (tried.number, tried.ending));
        let all = SmallEndings(endings.collect());
        let rejected = all.rejected();
        let mut seconds: Vec<f64> = of_kind.iter().map(|tried| tried.seconds).collect();
        seconds.sort_by(f64::total_cmp);
        let median = seconds.get(seconds.len() / 2).copied().unwrap_or(0.0);
        let by_paths = of_kind.iter().filter(|tried| tried.by_paths).count();
        let cells = vec![
            scatterers.to_string(),
            of_kind.len().to_string(),
            all.class(Class::Exact),
            all.class(Class::FirstOrder),
            by_paths.to_string(),
            all.count(|ending| matches!(ending, SmallEnding::Named | SmallEnding::Other)),
            all.count(|ending| ending == SmallEnding::Skipped),
            all.judged(Verdict::Pass),
            all.judged(Verdict::Undecided),
            rejected.join(", "),
            format!("{median:.1}"),
        ];
        Row::new(cells, vec![Check::none("rejected", rejected.len())])
    };
    ReportSection::new(
        format!("Several surfaces in a row, seed {}", options.seed),
        format!(
            "There are {} random scenes of two or three surfaces, with masks on any leg and a \
             plane behind two surfaces or more. Each is traced with {} photons and compared with \
             its prediction. Required: photons reject no prediction twice; the second time has \
             another seed and {MORE_PHOTONS} times as many photons.",
            tried.len(),
            options.photons
        ),
        "scattering surfaces | planes | exact | first-order | by paths | reference | skipped | \
         passed | undecided | numbers of rejected scenes | median seconds | verdict",
        (0..=MAX_SCATTERERS).map(row),
    )
}
