//! Defines the content of `summary.json`.

use crate::measure::MeasuredScene;
use etendue_compare::{PlaneComparison, PlaneReport, Verdict};
use etendue_field::Ledger;
use etendue_scene::{Emission, SceneFile};
use etendue_store::sealed::json;
use etendue_store::{Method, VERSION};
use serde::Serialize;
use std::collections::BTreeMap;

/// The content of `summary.json`, except for the hashes of the files.
#[derive(Debug, Serialize)]
pub struct Summary {
    /// Name of the scene.
    pub scene: String,
    /// BLAKE3 hash of the scene, which covers the scene file with defaults and overrides, and the
    /// files that the scene names.
    pub scene_hash: String,
    /// BLAKE3 hash of the scene from which the difference was measured, if the method is
    /// `difference`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub against: Option<String>,
    /// The scene as it was run, defaults and overrides included.
    pub scene_file: SceneFile,
    /// Version of this program.
    pub version: &'static str,
    /// Seed of the photons.
    pub seed: u64,
    /// Method of measurement.
    pub method: Method,
    /// How photons left the light: aimed at windows, or in proportion to the emission.
    pub emission: Emission,
    /// Photons emitted.
    pub photons: u64,
    /// Number of batches.
    pub batches: usize,
    /// Ledger of flux, W; `None` when the method has no ledger.
    pub ledger: Option<Ledger>,
    /// The relative imbalance of the ledger, (emitted − absorbed − escaped − stopped) / emitted.
    pub ledger_imbalance: Option<f64>,
    /// Verdict for all planes together.
    pub verdict: Verdict,
    /// The probability that a correct scene fails.
    pub alpha: f64,
    /// A report for each plane, in the order of the scene.
    pub planes: Vec<PlaneReport>,
    /// Findings on planes that fail, from measurements by another tracer.
    pub inquiries: Vec<Inquiry>,
}

/// The agreement between photons, another tracer and the prediction at a plane that fails.
#[derive(Debug, Serialize)]
pub struct Inquiry {
    /// Name of the plane.
    pub plane: String,
    /// Verdict and p-value if photons are compared with the other tracer.
    pub tracers: (Verdict, Option<f64>),
    /// Verdict and p-value if the other tracer is compared with the prediction.
    pub other: (Verdict, Option<f64>),
    /// The conclusion, in words.
    pub finding: String,
}

impl Summary {
    /// The settings that determine the arrays of the result.
    pub fn made_from(&self) -> serde_json::Value {
        serde_json::json!({
            "scene": self.scene,
            "scene_hash": self.scene_hash,
            "version": self.version,
            "seed": self.seed,
            "photons": self.photons,
        })
    }

    /// The summary of the compared planes.
    pub fn new(case: &MeasuredScene, planes: &[PlaneComparison], inquiries: Vec<Inquiry>) -> Self {
        let MeasuredScene {
            scene,
            method,
            measurement,
            ..
        } = case;
        let reports: Vec<PlaneReport> = planes.iter().map(|p| p.report.clone()).collect();
        let verdicts = reports.iter().map(|plane| plane.verdict);
        let sums = method.keeps_ledger().then(|| measurement.ledger());
        let photons = measurement.emitted();
        Self {
            scene: scene.name.clone(),
            scene_hash: scene.hash(),
            against: scene.hash_of_other(),
            scene_file: scene.file.clone(),
            version: VERSION,
            seed: scene.run.seed,
            method: *method,
            emission: scene.run.emission,
            photons,
            batches: measurement.batches().len(),
            ledger: sums.map(|sums| sums.scaled(1.0 / photons as f64)),
            ledger_imbalance: sums.map(|sums| sums.imbalance()),
            verdict: verdicts.fold(Verdict::Pass, Verdict::and),
            alpha: scene.run.alpha,
            planes: reports,
            inquiries,
        }
    }

    /// The bytes of `summary.json`; `files` maps each result file to its BLAKE3 hash.
    pub fn json(&self, files: &BTreeMap<String, String>) -> Vec<u8> {
        #[derive(Serialize)]
        struct WithFiles<'a> {
            #[serde(flatten)]
            summary: &'a Summary,
            files: &'a BTreeMap<String, String>,
        }
        json(&WithFiles {
            summary: self,
            files,
        })
    }
}
