//! Environment maps: the built-in ones.

pub mod synthetic;
