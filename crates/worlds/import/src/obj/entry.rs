//! Entries of an MTL file, and the surfaces made from them.

use super::map::MtlMap;
use crate::report::SourcePlace;
use etendue_world::Texture;

/// A material as it is written in an MTL file.
#[derive(Clone, Debug)]
pub(super) struct MtlEntry {
    /// The position in the file where the material begins.
    pub(super) place: SourcePlace,
    /// Diffuse reflectance.
    pub(super) kd: Option<[f64; 3]>,
    /// Specular reflectance.
    pub(super) ks: Option<[f64; 3]>,
    /// Emitted radiance.
    pub(super) ke: Option<[f64; 3]>,
    /// Transmission filter.
    pub(super) tf: Option<[f64; 3]>,
    /// Exponent of the specular lobe.
    pub(super) ns: Option<f64>,
    /// Index of refraction.
    pub(super) ni: Option<f64>,
    /// Opacity.
    pub(super) d: Option<f64>,
    /// Illumination model, 0 to 10.
    pub(super) illum: Option<u32>,
    pub(super) map_kd: Option<MtlMap>,
    pub(super) map_ke: Option<MtlMap>,
    pub(super) map_d: Option<MtlMap>,
}

impl MtlEntry {
    pub(super) fn new(place: SourcePlace) -> Self {
        Self {
            place,
            kd: None,
            ks: None,
            ke: None,
            tf: None,
            ns: None,
            ni: None,
            d: None,
            illum: None,
            map_kd: None,
            map_ke: None,
            map_d: None,
        }
    }
}

/// The surface of a part.
#[derive(Clone, Debug)]
pub(super) struct ObjSurface {
    pub(super) material: usize,
    pub(super) emission: Option<Texture>,
    /// Whether the surface has a picture, which needs texture coordinates.
    pub(super) has_picture: bool,
}
