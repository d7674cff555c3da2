//! Who shares a sculpture: what is told of each person beside what is in the world.

/// What a person may do in a shared sculpture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PersonRole {
    /// Sculpts and sees.
    Sculptor,
    /// Sees.
    Viewer,
    /// Sends samples, and sees nothing.
    Device,
}

/// One person.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Person {
    /// From 1; a person who comes back has the same.
    pub number: u8,
    /// As the person wants to be called.
    pub name: String,
    /// What the person may do.
    pub role: PersonRole,
    /// The person is connected.
    pub here: bool,
}

/// All who ever came, in the order of their numbers.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct PeopleHere {
    /// The number of the person of this daemon; 0 before the first entry.
    pub own: u8,
    /// Everybody.
    pub all: Vec<Person>,
}

/// What became of the own input.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct OwnInput {
    /// Samples of the own devices that did more than move.
    pub transitions: u64,
    /// Batches that they, and the commands, were put in: at most one for each tick.
    pub batches: u64,
    /// Batches that are in the order that all step.
    pub ordered: u64,
    /// Batches that are in it, and that another replica has too.
    pub acknowledged: u64,
    /// Samples that only moved and were left out, as too much waited.
    pub dropped: u64,
    /// Batches that were acknowledged and are in no order that is left.
    pub lost: u64,
}

impl PeopleHere {
    /// What is known of a person.
    pub fn person(&self, number: u8) -> Option<&Person> {
        self.all.iter().find(|p| p.number == number)
    }

    /// The name of a person; `?` where it is not known yet.
    pub fn name(&self, number: u8) -> &str {
        self.person(number).map_or("?", |p| &p.name)
    }
}

/// Colours that are told apart on clay, on a dark ground and on a light one; none of them is that
/// of the own brush ring, which is pale.
const COLOURS: [[u8; 3]; 12] = [
    [86, 180, 233],
    [230, 97, 60],
    [60, 190, 120],
    [204, 121, 217],
    [225, 190, 40],
    [70, 110, 230],
    [240, 110, 160],
    [40, 190, 190],
    [170, 140, 250],
    [150, 200, 60],
    [235, 150, 70],
    [150, 150, 165],
];

/// The colour of a person, red, green and blue: the same in every window. From the thirteenth
/// person on they recur.
pub fn colour_of(number: u8) -> [u8; 3] {
    COLOURS[usize::from(number.saturating_sub(1)) % COLOURS.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn those_who_come_first_are_told_apart() {
        for a in 1..=12 {
            for b in a + 1..=12 {
                let far = colour_of(a).into_iter().zip(colour_of(b));
                let far: u32 = far.map(|(x, y)| u32::from(x.abs_diff(y))).sum();
                assert!(far >= 60, "{a} and {b} differ by {far} of 765 only");
            }
        }
        assert_eq!(colour_of(13), colour_of(1));
    }
}
