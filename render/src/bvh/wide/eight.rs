//! Eight numbers at once: with AVX2 and fused multiply-add where the processor has them, else in arrays,
//! which compilers turn into whatever vectors the target has.

#[cfg(target_arch = "x86_64")]
use pulp::{Simd, WithSimd, cast, f32x8, x86::V3};

/// How many.
pub const LANES: usize = 8;

/// Arithmetic on eight numbers. Comparisons give a bit for each.
pub trait Eight: Copy {
    /// The eight.
    type Numbers: Copy;

    /// All the same.
    fn splat(self, number: f32) -> Self::Numbers;
    /// From memory.
    fn load(self, numbers: &[f32; LANES]) -> Self::Numbers;
    /// To memory.
    fn store(self, numbers: Self::Numbers) -> [f32; LANES];
    /// a + b.
    fn add(self, a: Self::Numbers, b: Self::Numbers) -> Self::Numbers;
    /// a - b.
    fn sub(self, a: Self::Numbers, b: Self::Numbers) -> Self::Numbers;
    /// a b.
    fn mul(self, a: Self::Numbers, b: Self::Numbers) -> Self::Numbers;
    /// a / b.
    fn div(self, a: Self::Numbers, b: Self::Numbers) -> Self::Numbers;
    /// a b + c, rounded once or twice.
    fn mul_add(self, a: Self::Numbers, b: Self::Numbers, c: Self::Numbers) -> Self::Numbers;
    /// The smaller one, or b where they are equal.
    fn min(self, a: Self::Numbers, b: Self::Numbers) -> Self::Numbers;
    /// The larger one, or b where they are equal.
    fn max(self, a: Self::Numbers, b: Self::Numbers) -> Self::Numbers;
    /// Where a <= b.
    fn at_most(self, a: Self::Numbers, b: Self::Numbers) -> u32;
    /// Where a < b.
    fn below(self, a: Self::Numbers, b: Self::Numbers) -> u32;
}

/// Work that is compiled for each kind of processor.
pub trait WithEight {
    /// What comes out.
    type Output;
    /// Does it. To be `#[inline(always)]`, with all that it calls, and without closures of its own: what is
    /// not inlined is compiled without AVX2.
    fn with<E: Eight>(self, eight: E) -> Self::Output;
}

/// What this processor does eight numbers with.
#[derive(Clone, Copy, Debug)]
pub enum Processor {
    /// Vectors of 256 bits.
    #[cfg(target_arch = "x86_64")]
    Avx2(V3),
    /// Anything.
    Portable,
}

impl Processor {
    /// The fastest that this processor can do.
    pub fn new() -> Self {
        #[cfg(target_arch = "x86_64")]
        if let Some(simd) = V3::try_new() {
            return Self::Avx2(simd);
        }
        Self::Portable
    }

    /// Does some work.
    #[inline(always)]
    pub fn run<W: WithEight>(self, work: W) -> W::Output {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(simd) => Simd::vectorize(simd, WithAvx2 { simd, work }),
            Self::Portable => work.with(Portable),
        }
    }
}

/// Arrays.
#[derive(Clone, Copy)]
struct Portable;

#[inline(always)]
fn each(a: [f32; LANES], b: [f32; LANES], f: impl Fn(f32, f32) -> f32) -> [f32; LANES] {
    std::array::from_fn(|lane| f(a[lane], b[lane]))
}

#[inline(always)]
fn where_true(a: [f32; LANES], b: [f32; LANES], f: impl Fn(f32, f32) -> bool) -> u32 {
    (0..LANES).fold(0, |bits, lane| bits | u32::from(f(a[lane], b[lane])) << lane)
}

impl Eight for Portable {
    type Numbers = [f32; LANES];

    #[inline(always)]
    fn splat(self, number: f32) -> Self::Numbers {
        [number; LANES]
    }
    #[inline(always)]
    fn load(self, numbers: &[f32; LANES]) -> Self::Numbers {
        *numbers
    }
    #[inline(always)]
    fn store(self, numbers: Self::Numbers) -> [f32; LANES] {
        numbers
    }
    #[inline(always)]
    fn add(self, a: Self::Numbers, b: Self::Numbers) -> Self::Numbers {
        each(a, b, |a, b| a + b)
    }
    #[inline(always)]
    fn sub(self, a: Self::Numbers, b: Self::Numbers) -> Self::Numbers {
        each(a, b, |a, b| a - b)
    }
    #[inline(always)]
    fn mul(self, a: Self::Numbers, b: Self::Numbers) -> Self::Numbers {
        each(a, b, |a, b| a * b)
    }
    #[inline(always)]
    fn div(self, a: Self::Numbers, b: Self::Numbers) -> Self::Numbers {
        each(a, b, |a, b| a / b)
    }
    #[inline(always)]
    fn mul_add(self, a: Self::Numbers, b: Self::Numbers, c: Self::Numbers) -> Self::Numbers {
        self.add(self.mul(a, b), c)
    }
    #[inline(always)]
    fn min(self, a: Self::Numbers, b: Self::Numbers) -> Self::Numbers {
        each(a, b, |a, b| if a < b { a } else { b })
    }
    #[inline(always)]
    fn max(self, a: Self::Numbers, b: Self::Numbers) -> Self::Numbers {
        each(a, b, |a, b| if a > b { a } else { b })
    }
    #[inline(always)]
    fn at_most(self, a: Self::Numbers, b: Self::Numbers) -> u32 {
        where_true(a, b, |a, b| a <= b)
    }
    #[inline(always)]
    fn below(self, a: Self::Numbers, b: Self::Numbers) -> u32 {
        where_true(a, b, |a, b| a < b)
    }
}

#[cfg(target_arch = "x86_64")]
struct WithAvx2<W> {
    simd: V3,
    work: W,
}

#[cfg(target_arch = "x86_64")]
impl<W: WithEight> WithSimd for WithAvx2<W> {
    type Output = W::Output;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> W::Output {
        self.work.with(self.simd)
    }
}

#[cfg(target_arch = "x86_64")]
impl Eight for V3 {
    type Numbers = f32x8;

    #[inline(always)]
    fn splat(self, number: f32) -> f32x8 {
        self.splat_f32x8(number)
    }
    #[inline(always)]
    fn load(self, numbers: &[f32; LANES]) -> f32x8 {
        cast(*numbers)
    }
    #[inline(always)]
    fn store(self, numbers: f32x8) -> [f32; LANES] {
        cast(numbers)
    }
    #[inline(always)]
    fn add(self, a: f32x8, b: f32x8) -> f32x8 {
        self.add_f32x8(a, b)
    }
    #[inline(always)]
    fn sub(self, a: f32x8, b: f32x8) -> f32x8 {
        self.sub_f32x8(a, b)
    }
    #[inline(always)]
    fn mul(self, a: f32x8, b: f32x8) -> f32x8 {
        self.mul_f32x8(a, b)
    }
    #[inline(always)]
    fn div(self, a: f32x8, b: f32x8) -> f32x8 {
        self.div_f32x8(a, b)
    }
    #[inline(always)]
    fn mul_add(self, a: f32x8, b: f32x8, c: f32x8) -> f32x8 {
        self.mul_add_f32x8(a, b, c)
    }
    #[inline(always)]
    fn min(self, a: f32x8, b: f32x8) -> f32x8 {
        self.min_f32x8(a, b)
    }
    #[inline(always)]
    fn max(self, a: f32x8, b: f32x8) -> f32x8 {
        self.max_f32x8(a, b)
    }
    #[inline(always)]
    fn at_most(self, a: f32x8, b: f32x8) -> u32 {
        let where_true = self.avx._mm256_cmp_ps::<{ std::arch::x86_64::_CMP_LE_OQ }>(cast(a), cast(b));
        self.avx._mm256_movemask_ps(where_true) as u32
    }
    #[inline(always)]
    fn below(self, a: f32x8, b: f32x8) -> u32 {
        let where_true = self.avx._mm256_cmp_ps::<{ std::arch::x86_64::_CMP_LT_OQ }>(cast(a), cast(b));
        self.avx._mm256_movemask_ps(where_true) as u32
    }
}
