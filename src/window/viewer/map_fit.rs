//! Finds the map and the delay that bring a pen's positions onto those of a pointer, and whether
//! the motion decides them without doubt.
//!
//! A delay can be taken for a map: on a circle at constant speed it is a turn, on a line at
//! constant speed a shift. So a fit is believed only where every other delay and every other kind
//! of map that explains the pairs as well puts the corners of the part that is used on the same
//! pixels (the profile likelihood of the delay; Pawitan, In All Likelihood, 2001, chapter 3), and
//! where the least squares leave the corners no room.
//!
//! A desktop scales an area, moves it, mirrors it or turns it by a right angle. Only where no such
//! map fits is any other affine map tried.

use glam::{DMat3, DVec2, DVec3};

/// From shares of a tablet's area to pixels of the whole desktop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScreenMap {
    /// Position of the area's top left corner, in pixels.
    pub origin: DVec2,
    /// The area's upper edge, from left to right.
    pub across: DVec2,
    /// The area's left edge, from top to bottom.
    pub down: DVec2,
}

impl ScreenMap {
    /// Maps a share of the area to pixels.
    pub fn at(&self, share: DVec2) -> DVec2 {
        self.origin + self.across * share.x + self.down * share.y
    }
}

/// A place of the pen in shares of its area, the pointer's pixel, and what the pair is worth.
pub(super) type PlacePair = (DVec2, DVec2, f64);

/// Pairs with which a first map is tried.
pub(super) const LEAST: usize = 12;
/// Pairs that are left for the second fit at least.
const FEWEST: usize = 8;
/// Longest delay of the pointer behind the pen that is tried, and the step, microseconds.
pub(super) const DELAYS_US: (u64, u64) = (480_000, 8_000);
/// Delays are found to so many microseconds.
const FINEST_US: u64 = 500;
/// Steps to both sides of a best delay at which its neighbours are looked at, microseconds.
const BESIDE_US: [u64; 7] = [500, 1_000, 2_000, 4_000, 8_000, 16_000, 32_000];
/// Pairs beyond so many medians are not the pen's.
const OUTLIER: f64 = 4.0;
/// The mean square of rounding to whole pixels, both axes: no fit is better.
const ROUNDING: f64 = 1.0 / 6.0;
/// Twice the logarithm of the likelihood by which a delay may be worse and still explain the pairs:
/// the 99.9th percentile of χ² with one degree of freedom is 10.8.
const LIKELY: f64 = 12.0;
/// The same for a map that is certain: the 99.999th percentile is 19.5. It is asked after each few
/// pairs, so that one chance in a thousand would come up once in some hundred hovers.
const CERTAIN: f64 = 20.0;
/// Corners within so many pixels are the same.
const SAME: f64 = 0.6;
/// The same where the map that was known is contradicted.
const SAME_BETTER: f64 = 1.0;
/// Greatest uncertainty of a corner, three standard deviations, in pixels.
const LEFT_TO_CHANCE: f64 = 1.6;
/// The same where the map that was known is contradicted: any better one is taken.
const LEFT_TO_BETTER: f64 = 4.0;
/// A fit whose pairs lie farther off, pixels in the mean square's root, is none of this kind.
const FITS: f64 = 16.0;
/// A map is asked for over so many times the extent of the places that the pen was at: beyond, the
/// next pairs say more.
const EXTENT: f64 = 3.9;
/// Least spread of the pairs, in shares of the tablet: their standard deviation in its least
/// direction. With less spread, or along a line, the map beside them would be a guess.
const LEAST_SPREAD: f64 = 6e-3;

/// A map, and how well it explains the pairs.
#[derive(Debug, Clone, Copy)]
pub(super) struct MapFit {
    /// The delay of the pointer behind the pen, microseconds.
    pub delay_us: u64,
    pub map: ScreenMap,
    /// Median distance of the pairs from the map, pixels.
    pub off: f64,
    /// The motion tells this map from all others.
    pub certain: bool,
    /// No other map explains the pairs, though this one may be some pixels off.
    pub alone: bool,
}

/// Kinds of affine map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// Across stays across.
    Straight,
    /// Turned by a right angle.
    Crossed,
    /// Any.
    Affine,
}

#[derive(Debug, Clone)]
struct Trial {
    delay_us: u64,
    map: ScreenMap,
    off: f64,
    /// Mean square distance of the pairs, pixels², each at most as the cap allows.
    square: f64,
    /// Number of equal pairs with the same total weight.
    count: f64,
    /// Greatest standard deviation of a corner, pixels.
    corner: f64,
}

/// The best map of these pairs; `samples` gives them for a delay in microseconds.
///
/// If the delay is the same for all pairs, those of a quick pen are as reliable as the others: then
/// pairs of equal weight may be certain sooner.
pub(super) fn best_fit(samples: &dyn Fn(u64) -> Vec<PlacePair>) -> Option<MapFit> {
    let by_worth = fit(samples);
    if by_worth.is_some_and(|f| f.certain) {
        return by_worth;
    }
    let equal =
        |delay_us: u64| samples(delay_us).into_iter().map(|(a, b, _)| (a, b, 1.0)).collect();
    fit(&equal).filter(|f| f.certain).or(by_worth)
}

fn fit(samples: &dyn Fn(u64) -> Vec<PlacePair>) -> Option<MapFit> {
    let right = search(samples, &[Kind::Straight, Kind::Crossed]);
    let fits = |trials: &[Trial]| trials.iter().any(|t| t.square <= FITS * FITS);
    let trials = match right {
        Some(trials) if fits(&trials) => trials,
        right => match search(samples, &[Kind::Affine]) {
            Some(any) if fits(&any) => any,
            any => right.or(any)?,
        },
    };
    let best = trials.iter().min_by(|a, b| a.square.total_cmp(&b.square))?;
    let corners = asked_for(&samples(0));
    let room = |likely: f64| {
        let limit = best.square.max(ROUNDING) * (likely / best.count.max(1.0)).exp();
        let likely = trials.iter().filter(|t| t.square <= limit);
        likely.map(|t| apart(&corners, &t.map, &best.map)).fold(0.0, f64::max)
    };
    let chance = 3.0 * best.corner;
    let fits = best.square <= FITS * FITS;
    let alone = fits && chance <= LEFT_TO_BETTER && room(LIKELY) <= SAME_BETTER;
    let certain = alone && chance <= LEFT_TO_CHANCE && room(CERTAIN) <= SAME;
    Some(MapFit { delay_us: best.delay_us, map: best.map, off: best.off, certain, alone })
}

/// Every delay and kind of map that is locally the best, and its neighbours.
fn search(samples: &dyn Fn(u64) -> Vec<PlacePair>, kinds: &[Kind]) -> Option<Vec<Trial>> {
    let grid: Vec<Vec<PlacePair>> =
        (0..=DELAYS_US.0 / DELAYS_US.1).map(|i| samples(i * DELAYS_US.1)).collect();
    let most = grid.iter().map(Vec::len).max()?;
    // A first look says how far a pair of the pen's may be off.
    let first = grid.iter().flat_map(|pairs| kinds.iter().filter_map(|k| typical(*k, pairs)));
    let cap = (first.min_by(f64::total_cmp)? * OUTLIER).max(2.0);
    let mut trials = Vec::new();
    for kind in kinds {
        let square = |delay_us: u64, pairs: &[PlacePair]| {
            // A delay that reaches back before the pairs began explains too few of them.
            let enough = pairs.len() >= LEAST && pairs.len() * 4 >= most * 3;
            trial(*kind, delay_us, pairs, cap).filter(|_| enough)
        };
        let row: Vec<Option<Trial>> = grid
            .iter()
            .enumerate()
            .map(|(i, pairs)| square(i as u64 * DELAYS_US.1, pairs))
            .collect();
        let cost = |i: usize| row.get(i).and_then(Option::as_ref).map_or(f64::MAX, |t| t.square);
        for (i, here) in row.iter().enumerate() {
            let Some(here) = here else { continue };
            let least =
                cost(i) <= cost(i + 1) && i.checked_sub(1).is_none_or(|b| cost(i) <= cost(b));
            if !least {
                continue;
            }
            let at = |delay_us: u64| square(delay_us, &samples(delay_us));
            let best = refined(here.clone(), &at);
            for by in BESIDE_US {
                let sides = [best.delay_us.checked_sub(by), best.delay_us.checked_add(by)];
                trials.extend(sides.into_iter().flatten().filter_map(&at));
            }
            trials.push(best);
        }
    }
    (!trials.is_empty()).then_some(trials)
}

/// Halves the step around a best delay until it is fine enough.
fn refined(mut best: Trial, at: &dyn Fn(u64) -> Option<Trial>) -> Trial {
    let mut step = DELAYS_US.1 / 2;
    while step >= FINEST_US {
        let sides = [best.delay_us.checked_sub(step), best.delay_us.checked_add(step)];
        for trial in sides.into_iter().flatten().filter_map(at) {
            if trial.square < best.square {
                best = trial;
            }
        }
        step /= 2;
    }
    best
}

/// The median distance of the pairs from the map that fits them.
fn typical(kind: Kind, pairs: &[PlacePair]) -> Option<f64> {
    (pairs.len() >= LEAST).then_some(())?;
    robust(kind, pairs).map(|(_, off)| off)
}

/// A fit of all pairs, and one of those near it; with the median distance.
fn robust(kind: Kind, pairs: &[PlacePair]) -> Option<(ScreenMap, f64)> {
    let mut map = least_squares(kind, pairs)?;
    let mut off = 0.0;
    for _ in 0..2 {
        let middle = median(distances(&map, pairs))?;
        let limit = (middle * OUTLIER).max(1.0);
        let near = |p: &&PlacePair| map.at(p.0).distance(p.1) <= limit;
        let kept: Vec<PlacePair> = pairs.iter().filter(near).copied().collect();
        map = least_squares(kind, &kept)?;
        off = median(distances(&map, &kept))?;
    }
    Some((map, off))
}

fn trial(kind: Kind, delay_us: u64, pairs: &[PlacePair], cap: f64) -> Option<Trial> {
    let (map, off) = robust(kind, pairs)?;
    let (mut sum, mut worth, mut worth2) = (0.0, 0.0, 0.0);
    for (far, weight) in distances(&map, pairs) {
        sum += far.min(cap).powi(2) * weight;
        (worth, worth2) = (worth + weight, worth2 + weight * weight);
    }
    let (square, count) = (sum / worth, worth * worth / worth2);
    let corner = corner_deviation(kind, pairs, square.max(ROUNDING) / 2.0, count);
    Some(Trial { delay_us, map, off, square, count, corner })
}

/// The corners of the part of the area that a map is asked for.
fn asked_for(pairs: &[PlacePair]) -> [DVec2; 4] {
    let least = pairs.iter().map(|p| p.0).fold(DVec2::MAX, DVec2::min);
    let most = pairs.iter().map(|p| p.0).fold(DVec2::MIN, DVec2::max);
    let (middle, half) = ((least + most) * 0.5, (most - least) * 0.5 * EXTENT);
    let (least, most) = ((middle - half).max(DVec2::ZERO), (middle + half).min(DVec2::ONE));
    [least, DVec2::new(most.x, least.y), DVec2::new(least.x, most.y), most]
}

/// Returns the greatest distance of these corners under two maps, in pixels.
fn apart(corners: &[DVec2; 4], a: &ScreenMap, b: &ScreenMap) -> f64 {
    corners.iter().map(|c| a.at(*c).distance(b.at(*c))).fold(0.0, f64::max)
}

/// The standard deviation of the worst corner, pixels, where a pair of weight 1 has this variance
/// on each axis.
fn corner_deviation(kind: Kind, pairs: &[PlacePair], variance: f64, count: f64) -> f64 {
    let worth: f64 = pairs.iter().map(|p| p.2).sum();
    let middle = pairs.iter().map(|p| p.0 * p.2).sum::<DVec2>() / worth;
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for (share, _, weight) in pairs {
        let off = *share - middle;
        (xx, xy, yy) =
            (xx + off.x * off.x * weight, xy + off.x * off.y * weight, yy + off.y * off.y * weight);
    }
    (xx, xy, yy) = (xx / worth, xy / worth, yy / worth);
    let (determinant, degrees) = (xx * yy - xy * xy, if kind == Kind::Affine { 3.0 } else { 2.0 });
    let variance = variance * count / (count - degrees).max(0.5);
    let of_corner = |corner: DVec2| {
        let d = corner - middle;
        // Sum over both axes of the pixel.
        let lever = match kind {
            Kind::Affine => {
                2.0 * (d.x * d.x * yy - 2.0 * d.x * d.y * xy + d.y * d.y * xx) / determinant
            }
            _ => d.x * d.x / xx + d.y * d.y / yy,
        };
        (variance * (2.0 + lever) / count).sqrt()
    };
    asked_for(pairs).into_iter().map(of_corner).fold(0.0, f64::max)
}

/// Returns each pair's distance from the map, in pixels, and its weight.
pub(super) fn distances(map: &ScreenMap, pairs: &[PlacePair]) -> Vec<(f64, f64)> {
    pairs
        .iter()
        .map(|(share, pointer, weight)| (map.at(*share).distance(*pointer), *weight))
        .collect()
}

/// The weighted median: pairs of a quick pen say little of a map where the pointer's delay varies,
/// and a few of a pen that rests say much.
fn median(all: Vec<(f64, f64)>) -> Option<f64> {
    quantile(all, 0.5)
}

/// The distance within which this part of the pairs lies, by what they are worth.
pub(super) fn quantile(mut all: Vec<(f64, f64)>, part: f64) -> Option<f64> {
    all.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let least = all.iter().map(|p| p.1).sum::<f64>() * part;
    let mut seen = 0.0;
    let reached = |p: &&(f64, f64)| {
        seen += p.1;
        seen >= least
    };
    all.iter().find(reached).map(|p| p.0)
}

/// The map of a kind with the least sum of weighted squares; `None` where the places span too
/// little.
fn least_squares(kind: Kind, all: &[PlacePair]) -> Option<ScreenMap> {
    if all.len() < FEWEST || !spans_enough(all) {
        return None;
    }
    if kind == Kind::Affine {
        return any_least_squares(all);
    }
    let line = |from: fn(DVec2) -> f64, to: fn(DVec2) -> f64| {
        let worth: f64 = all.iter().map(|p| p.2).sum();
        let mean =
            |of: &dyn Fn(&PlacePair) -> f64| all.iter().map(|p| of(p) * p.2).sum::<f64>() / worth;
        let (u, x) = (mean(&|p| from(p.0)), mean(&|p| to(p.1)));
        let uu = mean(&|p| (from(p.0) - u).powi(2));
        let ux = mean(&|p| (from(p.0) - u) * (to(p.1) - x));
        let slope = ux / uu;
        slope.is_finite().then_some((slope, x - slope * u))
    };
    let x_of: fn(DVec2) -> f64 = |v| v.x;
    let y_of: fn(DVec2) -> f64 = |v| v.y;
    if kind == Kind::Straight {
        let ((a, x), (d, y)) = (line(x_of, x_of)?, line(y_of, y_of)?);
        let (across, down) = (DVec2::new(a, 0.0), DVec2::new(0.0, d));
        return Some(ScreenMap { origin: DVec2::new(x, y), across, down });
    }
    let ((c, x), (b, y)) = (line(y_of, x_of)?, line(x_of, y_of)?);
    let (across, down) = (DVec2::new(0.0, b), DVec2::new(c, 0.0));
    Some(ScreenMap { origin: DVec2::new(x, y), across, down })
}

/// Returns true if the positions of the pen spread in every direction.
fn spans_enough(all: &[PlacePair]) -> bool {
    let middle = all.iter().map(|s| s.0).sum::<DVec2>() / all.len() as f64;
    // A few that are far from the others do not determine the spread.
    let mut off: Vec<DVec2> = all.iter().map(|s| s.0 - middle).collect();
    off.sort_unstable_by(|a, b| a.length_squared().total_cmp(&b.length_squared()));
    off.truncate(all.len() - all.len() / 6);
    let mean = off.iter().sum::<DVec2>() / off.len() as f64;
    let (mut xx, mut xy, mut yy) = (0.0f64, 0.0f64, 0.0f64);
    for off in off.iter().map(|off| *off - mean) {
        (xx, xy, yy) = (xx + off.x * off.x, xy + off.x * off.y, yy + off.y * off.y);
    }
    // The smaller one of the covariance's two eigenvalues.
    let least = 0.5 * (xx + yy - (xx - yy).hypot(2.0 * xy)) / off.len() as f64;
    least >= LEAST_SPREAD * LEAST_SPREAD
}

fn any_least_squares(all: &[PlacePair]) -> Option<ScreenMap> {
    let middle = all.iter().map(|s| s.0).sum::<DVec2>() / all.len() as f64;
    let (mut normal, mut x, mut y) = (DMat3::ZERO, DVec3::ZERO, DVec3::ZERO);
    for (share, pointer, weight) in all {
        let row = (*share - middle).extend(1.0);
        normal += DMat3::from_cols(row * row.x, row * row.y, row * row.z) * *weight;
        x += row * (pointer.x * weight);
        y += row * (pointer.y * weight);
    }
    let inverse = normal.inverse();
    if !inverse.is_finite() {
        return None;
    }
    let (x, y) = (inverse * x, inverse * y);
    let (across, down) = (DVec2::new(x.x, y.x), DVec2::new(x.y, y.y));
    let origin = DVec2::new(x.z, y.z) - across * middle.x - down * middle.y;
    Some(ScreenMap { origin, across, down })
}
