//! People who share a sculpture: the facts about each person that the world does not contain.

/// Role of a person in a shared sculpture.
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
    /// Role of the person.
    pub role: PersonRole,
    /// True while the person is connected.
    pub here: bool,
}

/// Everyone who ever joined, in the order of their numbers.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct PeopleHere {
    /// Number of this daemon's person; 0 before the first entry.
    pub own: u8,
    /// Every person.
    pub all: Vec<Person>,
}

/// Counts of this daemon's input.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct OwnInput {
    /// Samples of the local devices that did more than move.
    pub transitions: u64,
    /// Batches of these samples and of the commands: at most one per tick.
    pub batches: u64,
    /// Batches in the order that every replica steps.
    pub ordered: u64,
    /// Ordered batches that another replica has received too.
    pub acknowledged: u64,
    /// Samples that only moved, dropped because too many were waiting.
    pub dropped: u64,
    /// Acknowledged batches that no remaining order contains.
    pub lost: u64,
}

impl PeopleHere {
    /// Returns the facts about a person, if known.
    pub fn person(&self, number: u8) -> Option<&Person> {
        self.all.iter().find(|p| p.number == number)
    }

    /// Returns the name of a person; `?` if unknown.
    pub fn name(&self, number: u8) -> &str {
        self.person(number).map_or("?", |p| &p.name)
    }
}

/// Colours that can be distinguished on clay, on a dark and on a light background. None of them
/// resembles the pale ring of the local brush.
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
