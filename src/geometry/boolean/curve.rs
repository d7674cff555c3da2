//! The curve in which two surfaces meet, from its pieces: chains that end only where the curve ends
//! or branches.

use std::collections::BTreeMap;

/// Chains of points through all pieces, each piece once; a closed chain names its first point again
/// at its end. Chains between branches come first, in the order of the numbers of their first
/// points, then closed ones likewise.
pub fn chains(pieces: &[(u32, u32)]) -> Vec<Vec<u32>> {
    let mut around: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (i, &(a, b)) in pieces.iter().enumerate() {
        around.entry(a).or_default().push(i);
        around.entry(b).or_default().push(i);
    }
    let mut done = vec![false; pieces.len()];
    let mut out = Vec::new();
    let mut follow = |start: u32, first: usize| {
        let (mut chain, mut at, mut piece) = (vec![start], start, first);
        if done[piece] {
            return;
        }
        loop {
            done[piece] = true;
            let (a, b) = pieces[piece];
            at = if a == at { b } else { a };
            chain.push(at);
            let next = match around.get(&at).map(Vec::as_slice) {
                Some(&[p, q]) => [p, q].into_iter().find(|&i| !done[i]),
                _ => None,
            };
            match next {
                Some(n) => piece = n,
                None => break,
            }
        }
        out.push(chain);
    };
    for (&point, meeting) in around.iter().filter(|(_, m)| m.len() != 2) {
        meeting.iter().for_each(|&i| follow(point, i));
    }
    for (&point, meeting) in &around {
        meeting.iter().for_each(|&i| follow(point, i));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_loop_with_a_tail_and_a_loop_alone() {
        let made = chains(&[(1, 2), (2, 3), (1, 3), (3, 9), (4, 5), (5, 6), (4, 6)]);
        assert_eq!(made, [vec![3, 2, 1, 3], vec![3, 9], vec![4, 5, 6, 4]]);
        assert!(chains(&[]).is_empty());
    }
}
