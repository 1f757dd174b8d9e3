//! The float type that the formulas are generic over, so that the stability study runs the very code that renders.

/// `f32` or `f64`, with the few literals that formulas need.
pub trait Real: num_traits::Float + num_traits::FloatConst + std::fmt::Debug + Send + Sync + 'static {
    /// A literal of the formula, rounded to the type.
    fn lit(value: f64) -> Self;
}

impl Real for f32 {
    fn lit(value: f64) -> Self {
        value as f32
    }
}

impl Real for f64 {
    fn lit(value: f64) -> Self {
        value
    }
}
