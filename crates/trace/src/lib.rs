//! Traces photons from a [`Scene`](etendue_scene::Scene) to crossings of its virtual planes.
//!
//! The [`Tracer`] emits photons from the light, finds the first obstacle that each photon meets,
//! and reports every virtual plane that the photon crosses before this obstacle. The tracer also
//! keeps the ledger of flux. The crate does not depend on the spectra of windows or on theory.
//!
//! Each leg of the path is computed in its own frame, so a direction is (u, v, 1) and a distance
//! along the central ray is a coordinate. Light that travels back along a leg is described in a
//! reversed frame. The random numbers of a photon are functions of (seed, batch, photon), so its
//! path does not depend on the thread that traces it.

mod ahead;
mod aim;
mod area_sampler;
mod arrival;
mod backward;
mod batch_ranges;
mod bounce;
pub mod brdf;
mod courses;
mod emit;
mod flat_leg;
mod footprint_sampler;
mod grid;
mod heading;
mod lanes;
mod lattice;
mod lights;
mod line;
mod mesh;
mod mesh_order;
mod numbers;
mod obstacles;
mod photon_group;
mod plane_on_leg;
mod primitive;
mod primitive_set;
mod proposal;
mod radiance;
mod reach;
mod sampling;
mod scatter;
mod sky;
mod tracer;
mod unbounded;
mod world;

pub use backward::{Backward, LightNotFound, finds};
pub use emit::Emitter;
pub use lights::AllLights;
pub use photon_group::{PHOTONS_PER_GROUP, PhotonGroup};
pub use tracer::Tracer;
pub use world::PlaneInWorld;
