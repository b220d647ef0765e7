//! The servo platform that a gyro serves: how its noise becomes an angle error, and what a filter does to a closed loop.
//!
//! [`drift`] computes variances of linear loops; [`platform`] simulates the whole nonlinear axis (plant, controller, delay, any filter
//! of the library); [`measure`] says what came out; [`tuner`] finds controller and filter together, and [`study`] judges what it found.
//! SI and radians inside, deg/s at a filter's edge.

pub mod base;
pub mod bench;
pub mod chain;
pub mod controller;
mod demands;
pub mod describing;
pub mod discrete;
pub mod drift;
pub mod family;
mod kernel;
pub mod linear;
pub mod loop_filter;
pub mod measure;
pub mod open_loop;
pub mod plant;
mod plant_sets;
pub mod platform;
mod score;
pub mod search;
pub mod study;
mod swarm;
mod trial;
pub mod tuner;
pub mod warnings;

pub use plant_sets::PlatformDesign;

/// Degrees in a radian, and radians in a degree.
const DEGREES: f64 = 180.0 / core::f64::consts::PI;
const RADIANS: f64 = core::f64::consts::PI / 180.0;
