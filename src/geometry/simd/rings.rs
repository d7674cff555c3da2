//! The normals of vertices with a closed ring of six: eight at a time where the processor can,
//! their rings two in a register.
//!
//! About a vertex `p` with neighbours `a` to `f` the sum of the six triangles' doubled area vectors
//! is `b' x (c - a) + d' x (e - c) + f' x (a - e)`, with `b' = b - p` and so on: neighbouring terms
//! share a factor. A cross product is `yzx(u * yzx(v) - yzx(u) * v)`, and one shuffle at the end
//! serves all three.

use glam::{Vec4, Vec4Swizzles};

/// Rings of six neighbours each, counter-clockwise, one per vertex from vertex 0 on. Every index is
/// below [`Hexes::rows`], which is checked once, so the inner loop needs no bounds checks.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
#[serde(from = "Vec<[u16; 6]>", into = "Vec<[u16; 6]>")]
pub struct Hexes {
    rings: Vec<[u16; 6]>,
    rows: usize,
}

impl Hexes {
    /// Rings of the vertices from 0 on.
    pub fn new(rings: Vec<[u16; 6]>) -> Self {
        let rows =
            rings.iter().flatten().max().map_or(0, |&most| most as usize + 1).max(rings.len());
        Hexes { rings, rows }
    }

    /// Forgets all rings and keeps their memory.
    pub fn clear(&mut self) {
        self.rings.clear();
        self.rows = 0;
    }

    /// Forgets all rings and makes room for this many.
    pub fn reserve(&mut self, count: usize) {
        self.clear();
        self.rings.reserve(count);
    }

    /// Adds the ring of the next vertex.
    pub fn push(&mut self, ring: [u16; 6]) {
        self.rings.push(ring);
        let most = ring.iter().fold(0, |most, &v| most.max(v));
        self.rows = self.rows.max(most as usize + 1).max(self.rings.len());
    }

    /// Vertices that have their ring here.
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.rings.len()
    }

    /// Returns true if no vertex has its ring here.
    pub fn is_empty(&self) -> bool {
        self.rings.is_empty()
    }

    /// The ring of vertex `v`; `None` past the last.
    #[inline(always)]
    pub fn get(&self, v: usize) -> Option<&[u16; 6]> {
        self.rings.get(v)
    }

    /// Rows that the vertices and their neighbours lie within.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// All indices, ring by ring.
    pub fn flat(&self) -> &[u16] {
        self.rings.as_flattened()
    }
}

impl From<Vec<[u16; 6]>> for Hexes {
    fn from(rings: Vec<[u16; 6]>) -> Self {
        Hexes::new(rings)
    }
}

impl From<Hexes> for Vec<[u16; 6]> {
    fn from(hexes: Hexes) -> Self {
        hexes.rings
    }
}

#[inline(always)]
fn sum(points: &[Vec4], ring: &[u16; 6], p: Vec4) -> Vec4 {
    // Written out: an array's `map` is not always inlined into code for wider instructions.
    let [a, b, c, d, e, f] = *ring;
    let (a, c, e) = (points[a as usize], points[c as usize], points[e as usize]);
    let (b, d, f) = (points[b as usize] - p, points[d as usize] - p, points[f as usize] - p);
    let term = |u: Vec4, v: Vec4| u * v.yzxw() - u.yzxw() * v;
    (term(b, c - a) + term(d, e - c) + term(f, a - e)).yzxw()
}

/// The sums about vertices `first..first + out.len()`, twice the area each. The fourth lane is
/// nothing.
#[inline(always)]
pub fn sums(hexes: &Hexes, points: &[Vec4], first: usize, out: &mut [Vec4]) {
    let rings = &hexes.rings[first..first + out.len()];
    for ((out, ring), &p) in out.iter_mut().zip(rings).zip(&points[first..]) {
        *out = sum(points, ring, p);
    }
}

/// The squared lengths between which one over the root is a good factor: beyond them a sum must be
/// scaled first.
pub const LENGTHS: std::ops::Range<f32> = 1e-30..f32::INFINITY;

/// Vertices whose normals are to be computed: `first..first + rows.len()`.
#[derive(Debug)]
pub struct Rows<'a> {
    /// The first vertex.
    pub first: usize,
    /// As they were; the fourth lane is kept.
    pub old: &'a [Vec4],
    /// The output normals, as many as `old`.
    pub rows: &'a mut [Vec4],
    /// Gets `mark` where a normal differs, to the bit, from the old one.
    pub marks: &'a mut [u8],
    /// The value of a mark.
    pub mark: u8,
}

/// Writes the unit normals of as many vertices as go eight at a time, from the first on, and says
/// how many. It stops before eight with a sum whose squared length is outside [`LENGTHS`].
#[cfg(target_arch = "x86_64")]
#[inline(always)]
pub(super) fn normals_avx2(
    _: super::token::Avx2,
    hexes: &Hexes,
    points: &[Vec4],
    to: &mut Rows<'_>,
) -> usize {
    use std::arch::x86_64::*;
    let count = to.rows.len().min(to.old.len()).min(to.marks.len());
    let eights = count.min(hexes.rings.len().saturating_sub(to.first)) / 8;
    assert!(hexes.rows <= points.len(), "rings of another page");
    let rows = points.as_ptr().cast::<f32>();
    for k in 0..eights {
        // SAFETY: the token proves AVX2. `to.first + 8 * eights` is within `rings`, `8 * eights`
        // within `old`, `rows` and `marks`. Every index in `rings` is below `hexes.rows`
        // (`Hexes::new`), as are the vertices themselves; `points` is as long.
        unsafe {
            let at = to.first + 8 * k;
            let ring = hexes.rings.as_ptr().add(at);
            let place = rows.add(4 * at);
            let a = two_sums(rows, &*ring, &*ring.add(1), place);
            let b = two_sums(rows, &*ring.add(2), &*ring.add(3), place.add(8));
            let c = two_sums(rows, &*ring.add(4), &*ring.add(5), place.add(16));
            let d = two_sums(rows, &*ring.add(6), &*ring.add(7), place.add(24));
            // Lanes 0 2 4 6 1 3 5 7.
            let (ab, cd) = (_mm256_unpacklo_ps(a, b), _mm256_unpacklo_ps(c, d));
            let (ab_z, cd_z) = (_mm256_unpackhi_ps(a, b), _mm256_unpackhi_ps(c, d));
            let x = _mm256_shuffle_ps::<0b01_00_01_00>(ab, cd);
            let y = _mm256_shuffle_ps::<0b11_10_11_10>(ab, cd);
            let z = _mm256_shuffle_ps::<0b01_00_01_00>(ab_z, cd_z);
            let xy = _mm256_add_ps(_mm256_mul_ps(x, x), _mm256_mul_ps(y, y));
            let length2 = _mm256_add_ps(xy, _mm256_mul_ps(z, z));
            let good = _mm256_and_ps(
                _mm256_cmp_ps::<_CMP_GE_OQ>(length2, _mm256_set1_ps(LENGTHS.start)),
                _mm256_cmp_ps::<_CMP_LT_OQ>(length2, _mm256_set1_ps(LENGTHS.end)),
            );
            if _mm256_movemask_ps(good) != 0xFF {
                return 8 * k;
            }
            let inverse = _mm256_div_ps(_mm256_set1_ps(1.0), _mm256_sqrt_ps(length2));
            let old = to.old.as_ptr().add(8 * k).cast::<f32>();
            let new = to.rows.as_mut_ptr().add(8 * k).cast::<f32>();
            let marks = to.marks.as_mut_ptr().add(8 * k);
            two_normals(a, _mm256_permute_ps::<0b00_00_00_00>(inverse), old, new, marks, to.mark);
            two_normals(
                b,
                _mm256_permute_ps::<0b01_01_01_01>(inverse),
                old.add(8),
                new.add(8),
                marks.add(2),
                to.mark,
            );
            two_normals(
                c,
                _mm256_permute_ps::<0b10_10_10_10>(inverse),
                old.add(16),
                new.add(16),
                marks.add(4),
                to.mark,
            );
            two_normals(
                d,
                _mm256_permute_ps::<0b11_11_11_11>(inverse),
                old.add(24),
                new.add(24),
                marks.add(6),
                to.mark,
            );
        }
    }
    8 * eights
}

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::__m256;

/// [`sum`] of two vertices at `place`.
///
/// # Safety
/// The processor has AVX2, and all indices are of rows that `rows` has.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
unsafe fn two_sums(rows: *const f32, one: &[u16; 6], two: &[u16; 6], place: *const f32) -> __m256 {
    use std::arch::x86_64::*;
    // SAFETY: as the caller promised.
    unsafe {
        let p = _mm256_loadu_ps(place);
        let a = joined(rows, one[0] as usize, two[0] as usize);
        let b = _mm256_sub_ps(joined(rows, one[1] as usize, two[1] as usize), p);
        let c = joined(rows, one[2] as usize, two[2] as usize);
        let d = _mm256_sub_ps(joined(rows, one[3] as usize, two[3] as usize), p);
        let e = joined(rows, one[4] as usize, two[4] as usize);
        let f = _mm256_sub_ps(joined(rows, one[5] as usize, two[5] as usize), p);
        let first = _mm256_add_ps(term(b, _mm256_sub_ps(c, a)), term(d, _mm256_sub_ps(e, c)));
        _mm256_permute_ps::<YZX>(_mm256_add_ps(first, term(f, _mm256_sub_ps(a, e))))
    }
}

#[cfg(target_arch = "x86_64")]
const YZX: i32 = 0b11_00_10_01;

/// # Safety
/// The processor has AVX2.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
unsafe fn term(u: __m256, v: __m256) -> __m256 {
    use std::arch::x86_64::*;
    // SAFETY: as the caller promised.
    unsafe {
        let left = _mm256_mul_ps(u, _mm256_permute_ps::<YZX>(v));
        _mm256_sub_ps(left, _mm256_mul_ps(_mm256_permute_ps::<YZX>(u), v))
    }
}

/// Two rows in one register.
///
/// # Safety
/// The processor has AVX2, and `rows` has rows `low` and `high`.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
pub(super) unsafe fn joined(rows: *const f32, low: usize, high: usize) -> __m256 {
    use std::arch::x86_64::*;
    // SAFETY: as the caller promised.
    unsafe {
        let low = _mm256_castps128_ps256(_mm_loadu_ps(rows.add(4 * low)));
        _mm256_insertf128_ps::<1>(low, _mm_loadu_ps(rows.add(4 * high)))
    }
}

/// Writes two normals, and marks the changed ones.
///
/// # Safety
/// The processor has AVX2; `old` and `new` have two rows, `marks` two bytes.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
unsafe fn two_normals(
    sums: __m256,
    inverse: __m256,
    old: *const f32,
    new: *mut f32,
    marks: *mut u8,
    mark: u8,
) {
    use std::arch::x86_64::*;
    // SAFETY: as the caller promised.
    unsafe {
        let old = _mm256_loadu_ps(old);
        let row = _mm256_blend_ps::<0b1000_1000>(_mm256_mul_ps(sums, inverse), old);
        let same = _mm256_cmpeq_epi32(_mm256_castps_si256(row), _mm256_castps_si256(old));
        let same = _mm256_movemask_ps(_mm256_castsi256_ps(same)) as u32;
        _mm256_storeu_ps(new, row);
        *marks |= if same & 0xF != 0xF { mark } else { 0 };
        *marks.add(1) |= if same >> 4 != 0xF { mark } else { 0 };
    }
}
