//! The servo platform that a gyro serves: how its noise becomes an angle error, and what a filter does to a closed loop.
//!
//! [`drift`] computes variances of linear loops; [`platform`] simulates the whole nonlinear axis (plant, controller, delay, any filter
//! of the library); [`measure`] says what came out. SI and radians inside, deg/s at a filter's edge.

pub mod base;
pub mod controller;
mod demands;
pub mod describing;
pub mod discrete;
pub mod drift;
pub mod family;
pub mod linear;
pub mod loop_filter;
pub mod measure;
pub mod plant;
mod plant_sets;
pub mod platform;
pub mod search;
pub mod seeds;
pub mod study;
pub mod trial;
pub mod tuner;

pub use plant_sets::PlatformDesign;
