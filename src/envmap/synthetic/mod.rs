//! Environment maps that the program makes itself: the default one, a sun, and three that find bugs.
pub mod nave;
