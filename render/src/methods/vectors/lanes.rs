//! Numbers of neighbouring pixels in one vector register, with the operators that scalars have.
//!
//! `pulp` says how many there are and by which instructions; whatever uses them is to be `#[inline(always)]`
//! and without closures, or else it is not compiled for those instructions.

use pulp::Simd;
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Sub};

/// Above it floats are whole numbers, which stand in their lowest bits.
const WHOLE: f32 = 8_388_608.0;
/// So are they above this, also with a negative number of at most 2^22 added.
const ROUNDING: f32 = 12_582_912.0;

/// Real numbers.
#[derive(Clone, Copy, Debug)]
pub struct Lanes<S: Simd> {
    simd: S,
    numbers: S::f32s,
}

/// Words of 32 bits.
#[derive(Clone, Copy, Debug)]
pub struct Words<S: Simd> {
    simd: S,
    words: S::u32s,
}

/// Which lanes.
#[derive(Clone, Copy, Debug)]
pub struct Mask<S: Simd> {
    simd: S,
    mask: S::m32s,
}

macro_rules! operator {
    ($on:ident, $field:ident, $trait:ident, $name:ident, $operation:ident) => {
        impl<S: Simd> $trait for $on<S> {
            type Output = Self;

            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                Self { simd: self.simd, $field: self.simd.$operation(self.$field, other.$field) }
            }
        }
    };
}

operator!(Lanes, numbers, Add, add, add_f32s);
operator!(Lanes, numbers, Sub, sub, sub_f32s);
operator!(Lanes, numbers, Mul, mul, mul_f32s);
operator!(Lanes, numbers, Div, div, div_f32s);
operator!(Words, words, Add, add, add_u32s);
operator!(Words, words, Sub, sub, sub_u32s);
operator!(Words, words, Mul, mul, mul_u32s);
operator!(Words, words, BitAnd, bitand, and_u32s);
operator!(Words, words, BitOr, bitor, or_u32s);
operator!(Words, words, BitXor, bitxor, xor_u32s);
operator!(Mask, mask, BitAnd, bitand, and_m32s);
operator!(Mask, mask, BitOr, bitor, or_m32s);

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        self.all(0.0) - self
    }
}

impl<S: Simd> Not for Words<S> {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        self.with(self.simd.not_u32s(self.words))
    }
}

impl<S: Simd> Lanes<S> {
    /// The same number in all lanes.
    #[inline(always)]
    pub fn splat(simd: S, number: f32) -> Self {
        Self { simd, numbers: simd.splat_f32s(number) }
    }

    /// The numbers of a row from a column on, which may be outside; 0 where there are none.
    #[inline(always)]
    pub fn load(simd: S, row: &[f32], column: isize) -> Self {
        let whole = usize::try_from(column).ok().and_then(|from| row.get(from..from + S::F32_LANES));
        if let Some(([numbers, ..], _)) = whole.map(S::as_simd_f32s) {
            return Self { simd, numbers: *numbers };
        }
        let mut numbers = simd.splat_f32s(0.0);
        let each: &mut [f32] = bytemuck::cast_slice_mut(std::slice::from_mut(&mut numbers));
        for (lane, number) in each.iter_mut().enumerate() {
            let at = column + lane as isize;
            if at >= 0 && (at as usize) < row.len() {
                *number = row[at as usize];
            }
        }
        Self { simd, numbers }
    }

    /// Into memory, as many as there is room for.
    #[inline(always)]
    pub fn store(self, to: &mut [f32]) {
        match S::as_mut_simd_f32s(to) {
            ([whole, ..], _) => *whole = self.numbers,
            (_, part) => self.simd.partial_store_f32s(part, self.numbers),
        }
    }

    /// The same number in all lanes, beside these.
    #[inline(always)]
    pub fn all(self, number: f32) -> Self {
        self.with(self.simd.splat_f32s(number))
    }

    #[inline(always)]
    fn with(self, numbers: S::f32s) -> Self {
        Self { simd: self.simd, numbers }
    }

    /// `self * factor + term`, rounded once or twice.
    #[inline(always)]
    pub fn mul_add(self, factor: Self, term: Self) -> Self {
        self.with(self.simd.mul_add_e_f32s(self.numbers, factor.numbers, term.numbers))
    }

    /// The square root.
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        self.with(self.simd.sqrt_f32s(self.numbers))
    }

    /// The number without its sign.
    #[inline(always)]
    pub fn abs(self) -> Self {
        self.max(-self)
    }

    /// The smaller one.
    #[inline(always)]
    pub fn min(self, other: Self) -> Self {
        self.with(self.simd.min_f32s(self.numbers, other.numbers))
    }

    /// The larger one.
    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        self.with(self.simd.max_f32s(self.numbers, other.numbers))
    }

    /// Where it is below another.
    #[inline(always)]
    pub fn below(self, other: Self) -> Mask<S> {
        Mask { simd: self.simd, mask: self.simd.less_than_f32s(self.numbers, other.numbers) }
    }

    /// Where it is another.
    #[inline(always)]
    pub fn equals(self, other: Self) -> Mask<S> {
        Mask { simd: self.simd, mask: self.simd.equal_f32s(self.numbers, other.numbers) }
    }

    /// Where it is another or below.
    #[inline(always)]
    pub fn at_most(self, other: Self) -> Mask<S> {
        Mask { simd: self.simd, mask: self.simd.less_than_or_equal_f32s(self.numbers, other.numbers) }
    }

    /// The whole number below, of numbers within 2^22.
    #[inline(always)]
    pub fn floor(self) -> Self {
        let rounded = (self + self.all(ROUNDING)) - self.all(ROUNDING);
        rounded - self.below(rounded).choose(self.all(1.0), self.all(0.0))
    }

    /// The same as an integer, negative ones as their complement to two.
    #[inline(always)]
    pub fn floor_to_words(self) -> Words<S> {
        let shifted = self + self.all(ROUNDING);
        let bits = shifted.bits();
        let above = self.below(shifted - self.all(ROUNDING));
        bits - bits.all(ROUNDING.to_bits()) - above.only(bits.all(1))
    }

    /// Its representation.
    #[inline(always)]
    pub fn bits(self) -> Words<S> {
        Words { simd: self.simd, words: self.simd.transmute_u32s_f32s(self.numbers) }
    }

    /// The largest of all lanes; not a number is nothing.
    #[inline(always)]
    pub fn largest(self) -> f32 {
        let numbers: &[f32] = bytemuck::cast_slice(std::slice::from_ref(&self.numbers));
        let mut largest = f32::NEG_INFINITY;
        for number in numbers {
            largest = largest.max(*number);
        }
        largest
    }
}

impl<S: Simd> Words<S> {
    /// The same word in all lanes.
    #[inline(always)]
    pub fn splat(simd: S, word: u32) -> Self {
        Self { simd, words: simd.splat_u32s(word) }
    }

    /// A word, and in each lane one more than in the one before.
    #[inline(always)]
    pub fn count_from(simd: S, first: u32) -> Self {
        let mut words = simd.splat_u32s(0);
        let each: &mut [u32] = bytemuck::cast_slice_mut(std::slice::from_mut(&mut words));
        for (lane, word) in each.iter_mut().enumerate() {
            *word = first.wrapping_add(lane as u32);
        }
        Self { simd, words }
    }

    /// The same word in all lanes, beside these.
    #[inline(always)]
    pub fn all(self, word: u32) -> Self {
        self.with(self.simd.splat_u32s(word))
    }

    #[inline(always)]
    fn with(self, words: S::u32s) -> Self {
        Self { simd: self.simd, words }
    }

    /// The smaller one.
    #[inline(always)]
    pub fn min(self, other: Self) -> Self {
        self.with(self.simd.min_u32s(self.words, other.words))
    }

    /// Shifted to the left, by an amount taken modulo 32.
    #[inline(always)]
    pub fn shifted_left(self, amount: Self) -> Self {
        self.with(self.simd.wrapping_dyn_shl_u32s(self.words, amount.words))
    }

    /// Shifted to the right, by an amount taken modulo 32.
    #[inline(always)]
    pub fn shifted_right(self, amount: Self) -> Self {
        self.with(self.simd.wrapping_dyn_shr_u32s(self.words, amount.words))
    }

    /// The integer, below 2^23, as a number.
    #[inline(always)]
    pub fn to_float(self) -> Lanes<S> {
        let shifted = (self | self.all(WHOLE.to_bits())).as_float();
        shifted - shifted.all(WHOLE)
    }

    /// The number that it represents.
    #[inline(always)]
    pub fn as_float(self) -> Lanes<S> {
        Lanes { simd: self.simd, numbers: self.simd.transmute_f32s_u32s(self.words) }
    }

    /// The bits in reverse order.
    #[inline(always)]
    pub fn reverse_bits(self) -> Self {
        let mut words = self.words;
        let each: &mut [u32] = bytemuck::cast_slice_mut(std::slice::from_mut(&mut words));
        for word in each {
            *word = word.reverse_bits();
        }
        self.with(words)
    }

    /// How many bits are set.
    #[inline(always)]
    pub fn count_ones(self) -> Lanes<S> {
        let mut numbers = self.simd.splat_f32s(0.0);
        let each: &mut [f32] = bytemuck::cast_slice_mut(std::slice::from_mut(&mut numbers));
        let words: &[u32] = bytemuck::cast_slice(std::slice::from_ref(&self.words));
        for (number, word) in each.iter_mut().zip(words) {
            *number = word.count_ones() as f32;
        }
        Lanes { simd: self.simd, numbers }
    }

    /// The first three numbers of what stands in a table at each of these places.
    #[inline(always)]
    pub fn gather(self, table: &[[f32; 4]]) -> [Lanes<S>; 3] {
        let simd = self.simd;
        let [mut a, mut b, mut c] = [simd.splat_f32s(0.0); 3];
        let places: &[u32] = bytemuck::cast_slice(std::slice::from_ref(&self.words));
        let first: &mut [f32] = bytemuck::cast_slice_mut(std::slice::from_mut(&mut a));
        let second: &mut [f32] = bytemuck::cast_slice_mut(std::slice::from_mut(&mut b));
        let third: &mut [f32] = bytemuck::cast_slice_mut(std::slice::from_mut(&mut c));
        for lane in 0..S::F32_LANES {
            let [x, y, z, _] = table[places[lane] as usize];
            first[lane] = x;
            second[lane] = y;
            third[lane] = z;
        }
        [a, b, c].map(|numbers| Lanes { simd, numbers })
    }
}

impl<S: Simd> Mask<S> {
    /// One number where it is set, another elsewhere.
    #[inline(always)]
    pub fn choose(self, set: Lanes<S>, unset: Lanes<S>) -> Lanes<S> {
        set.with(self.simd.select_f32s(self.mask, set.numbers, unset.numbers))
    }

    /// The word where it is set, 0 elsewhere.
    #[inline(always)]
    pub fn only(self, word: Words<S>) -> Words<S> {
        word.with(self.simd.select_u32s(self.mask, word.words, self.simd.splat_u32s(0)))
    }

    /// Whether it is set anywhere.
    #[inline(always)]
    pub fn any(self) -> bool {
        let set = self.simd.select_u32s(self.mask, self.simd.splat_u32s(1), self.simd.splat_u32s(0));
        let each: &[u32] = bytemuck::cast_slice(std::slice::from_ref(&set));
        let mut any = 0;
        for word in each {
            any |= word;
        }
        any != 0
    }
}
