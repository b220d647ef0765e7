//! The servo platform that a gyro serves: how its noise becomes an angle error, and what a filter does to a closed loop.

pub mod drift;
