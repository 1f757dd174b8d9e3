//! Eight numbers at a time: once with the instructions that every processor has, once with AVX2 and FMA.

#[cfg(target_arch = "x86_64")]
use core::arch::x86_64;

/// How many boxes, triangles or spheres are tested at once.
pub const WIDTH: usize = 8;

/// Arithmetic on [`WIDTH`] numbers. All implementations give the same bits, except for [`mul_sub`](Self::mul_sub).
pub trait Lanes: Copy {
    type F: Copy;

    fn load(self, x: &[f32; WIDTH]) -> Self::F;
    fn store(self, x: Self::F) -> [f32; WIDTH];
    fn splat(self, x: f32) -> Self::F;
    fn add(self, a: Self::F, b: Self::F) -> Self::F;
    fn sub(self, a: Self::F, b: Self::F) -> Self::F;
    fn mul(self, a: Self::F, b: Self::F) -> Self::F;
    fn div(self, a: Self::F, b: Self::F) -> Self::F;
    /// a·b − c, rounded once or twice.
    fn mul_sub(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F;
    /// The smaller one; `b` when either is NaN.
    fn min(self, a: Self::F, b: Self::F) -> Self::F;
    /// The larger one; `b` when either is NaN.
    fn max(self, a: Self::F, b: Self::F) -> Self::F;
    /// Bit i tells whether aᵢ ≤ bᵢ; unset for NaN.
    fn le(self, a: Self::F, b: Self::F) -> u32;
    fn sqrt(self, a: Self::F) -> Self::F;
    /// The modulus of `a` with the sign of `b`.
    fn copysign(self, a: Self::F, b: Self::F) -> Self::F;
    /// `a` where it is at least 0, `b` elsewhere, also where `a` is NaN.
    fn positive_or(self, a: Self::F, b: Self::F) -> Self::F;
}

/// Methods of [`Lanes`] that take two operands, each from what it computes; the first name stands for the implementor.
macro_rules! binary {
    ($($name:ident($self:ident, $a:ident, $b:ident) -> $result:ty = $value:expr;)*) => {$(
        #[inline(always)]
        fn $name(self, $a: Self::F, $b: Self::F) -> $result {
            let $self = self;
            $value
        }
    )*};
}

/// Plain arrays.
#[derive(Debug, Clone, Copy)]
pub struct Portable;

#[inline(always)]
fn each(a: [f32; WIDTH], b: [f32; WIDTH], f: impl Fn(f32, f32) -> f32) -> [f32; WIDTH] {
    std::array::from_fn(|i| f(a[i], b[i]))
}

impl Lanes for Portable {
    type F = [f32; WIDTH];

    #[inline(always)]
    fn load(self, x: &[f32; WIDTH]) -> Self::F {
        *x
    }

    #[inline(always)]
    fn store(self, x: Self::F) -> [f32; WIDTH] {
        x
    }

    #[inline(always)]
    fn splat(self, x: f32) -> Self::F {
        [x; WIDTH]
    }

    #[inline(always)]
    fn mul_sub(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F {
        self.sub(self.mul(a, b), c)
    }

    #[inline(always)]
    fn sqrt(self, a: Self::F) -> Self::F {
        each(a, a, |a, _| a.sqrt())
    }

    binary! {
        add(_s, a, b) -> Self::F = each(a, b, |a, b| a + b);
        sub(_s, a, b) -> Self::F = each(a, b, |a, b| a - b);
        mul(_s, a, b) -> Self::F = each(a, b, |a, b| a * b);
        div(_s, a, b) -> Self::F = each(a, b, |a, b| a / b);
        min(_s, a, b) -> Self::F = each(a, b, |a, b| if a < b { a } else { b });
        max(_s, a, b) -> Self::F = each(a, b, |a, b| if a > b { a } else { b });
        le(_s, a, b) -> u32 = (0..WIDTH).fold(0, |mask, i| mask | u32::from(a[i] <= b[i]) << i);
        copysign(_s, a, b) -> Self::F = each(a, b, f32::copysign);
        positive_or(_s, a, b) -> Self::F = each(a, b, |a, b| if a >= 0.0 { a } else { b });
    }
}

/// AVX2 and FMA; the value is the proof that the processor has them.
#[cfg(target_arch = "x86_64")]
pub use pulp::x86::V3 as Avx2;

#[cfg(target_arch = "x86_64")]
impl Lanes for Avx2 {
    type F = x86_64::__m256;

    #[inline(always)]
    fn load(self, x: &[f32; WIDTH]) -> Self::F {
        pulp::cast(*x)
    }

    #[inline(always)]
    fn store(self, x: Self::F) -> [f32; WIDTH] {
        pulp::cast(x)
    }

    #[inline(always)]
    fn splat(self, x: f32) -> Self::F {
        self.avx._mm256_set1_ps(x)
    }

    #[inline(always)]
    fn mul_sub(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F {
        self.fma._mm256_fmsub_ps(a, b, c)
    }

    #[inline(always)]
    fn sqrt(self, a: Self::F) -> Self::F {
        self.avx._mm256_sqrt_ps(a)
    }

    binary! {
        add(s, a, b) -> Self::F = s.avx._mm256_add_ps(a, b);
        sub(s, a, b) -> Self::F = s.avx._mm256_sub_ps(a, b);
        mul(s, a, b) -> Self::F = s.avx._mm256_mul_ps(a, b);
        div(s, a, b) -> Self::F = s.avx._mm256_div_ps(a, b);
        min(s, a, b) -> Self::F = s.avx._mm256_min_ps(a, b);
        max(s, a, b) -> Self::F = s.avx._mm256_max_ps(a, b);
        le(s, a, b) -> u32 = s.avx._mm256_movemask_ps(s.avx._mm256_cmp_ps::<{ x86_64::_CMP_LE_OQ }>(a, b)) as u32;
        copysign(s, a, b) -> Self::F = {
            let sign = s.splat(-0.0);
            s.avx._mm256_or_ps(s.avx._mm256_andnot_ps(sign, a), s.avx._mm256_and_ps(sign, b))
        };
        positive_or(s, a, b) -> Self::F = {
            let positive = s.avx._mm256_cmp_ps::<{ x86_64::_CMP_GE_OQ }>(a, s.splat(0.0));
            s.avx._mm256_blendv_ps(b, a, positive)
        };
    }
}
