//! The two floating-point precisions of the machine: rounding, and units of the last place.

/// The precision that a variant is evaluated in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
pub enum Precision {
    /// `f32`.
    #[default]
    #[serde(rename = "f32")]
    Single,
    /// `f64`.
    #[serde(rename = "f64")]
    Double,
}

impl Precision {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Single, Self::Double];

    /// Its name in tables: `f32` or `f64`.
    pub fn name(self) -> &'static str {
        if self == Self::Single { "f32" } else { "f64" }
    }

    /// The nearest number of this precision.
    pub fn round(self, x: f64) -> f64 {
        if self == Self::Single { f64::from(x as f32) } else { x }
    }

    /// The smallest normal number.
    pub fn least(self) -> f64 {
        if self == Self::Single { f64::from(f32::MIN_POSITIVE) } else { f64::MIN_POSITIVE }
    }

    /// The distance from |x| to the next larger number of this precision.
    pub fn unit(self, x: f64) -> f64 {
        match self {
            Self::Single => {
                let x = (x.abs() as f32).min(f32::MAX.next_down());
                f64::from(x.next_up()) - f64::from(x)
            }
            Self::Double => {
                let x = x.abs().min(f64::MAX.next_down());
                x.next_up() - x
            }
        }
    }

    /// Half a unit of the last place of 1: the largest relative error of one rounding.
    pub fn rounding(self) -> f64 {
        self.unit(1.0) / 2.0
    }

    /// The shortest decimal that reads back as `x`.
    pub fn text(self, x: f64) -> String {
        if self == Self::Single { format!("{:?}", x as f32) } else { format!("{x:?}") }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_of_the_last_place() {
        assert_eq!(Precision::Single.unit(1.0), f64::from(f32::EPSILON));
        assert_eq!(Precision::Double.unit(-1.5), f64::EPSILON);
        assert_eq!(Precision::Double.unit(0.0), 5e-324);
        assert!(Precision::Single.unit(1e300).is_finite());
    }
}
