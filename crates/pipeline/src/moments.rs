//! The 4D grid on which covariances of spectra are measured.

use crate::field::check_grid;
use etendue_field::VirtualPlane;
use etendue_spectrum::field::FieldOptions;
use etendue_store::{Failure, machine};

/// Returns the options with which a grid computes covariances, and groups of batches for their
/// errors.
fn options() -> FieldOptions {
    FieldOptions {
        covariance: true,
        ..FieldOptions::default()
    }
}

/// Returns the options of the grid on which a plane is measured. All groups are kept if they fit
/// into half of the memory; the photons then need not be traced twice.
pub fn fitting(plane: &VirtualPlane) -> FieldOptions {
    let kept = FieldOptions {
        keep: true,
        ..options()
    };
    let threads = rayon::current_num_threads();
    if kept.bytes(&kept.grid(plane), threads) <= machine::available_memory() / 2 {
        kept
    } else {
        options()
    }
}

/// Fails, before any photon is traced, if the grid of a plane does not fit into memory.
pub fn check_memory(planes: &[VirtualPlane]) -> Result<(), Failure> {
    for plane in planes {
        let name = format!("covariance: the grid of {}", plane.name);
        check_grid(&name, &options().grid(plane), &options())?;
    }
    Ok(())
}
