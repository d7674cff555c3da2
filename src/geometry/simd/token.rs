//! Proof that the processor has AVX2.

/// Made by [`super::wide::dispatch`] alone, after the check at run time. What takes one may use
/// AVX2 and BMI.
#[derive(Debug, Clone, Copy)]
pub(in crate::simd) struct Avx2(pub(super) ());
