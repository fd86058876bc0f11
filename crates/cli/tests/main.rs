//! The tests of `etendue`, as one program.

#![allow(clippy::too_many_lines, reason = "a test may be a list of cases")]

mod bandwidth;
mod colors;
mod command;
mod common;
mod covariance;
mod damaged;
mod diff;
mod drawing;
mod explorer;
mod figure;
mod first_scenes;
mod fit;
mod interruption;
mod limits;
mod newcomer;
mod own_theory;
mod ownership;
mod ray_light;
mod rays;
mod report;
mod resume;
mod schema;
mod split;
mod stages;
mod sweep;
mod variance;
mod vocabulary;
mod workers;
#[cfg(feature = "worlds")]
mod worlds;
