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
    /// The number of the sculpture, as a person sees it: two of one name differ in it.
    pub sculpture: String,
    /// Other sculptures of the same name, each with its people and its age.
    pub others: Vec<String>,
    /// Why the host sent this daemon away.
    pub sent_away: Option<String>,
}

/// This daemon's connection to the others.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SharedState {
    /// Nothing is shared, or nobody has let this daemon in yet.
    #[default]
    NotShared,
    /// It orders everybody's input.
    Hosts,
    /// It follows the host.
    Follows,
    /// Nothing has come from the host, nor from a successor.
    CutOff,
    /// The host sent it away: it goes on alone.
    SentAway,
}

/// See [`SharedState`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SharedStanding {
    /// The state.
    pub state: SharedState,
    /// Number of the person whose daemon hosts; 0: unknown.
    pub host: u8,
    /// Whole seconds since which it is so.
    pub since_s: u64,
    /// Batches of local input that no host has ordered yet.
    pub waiting: u64,
    /// Batches of local input that never reached the others. Only this daemon's sculpture contains
    /// them.
    pub undelivered: u64,
}

/// End of this daemon's part in a shared sculpture.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct SharedEnd {
    /// Why the host sent it away.
    pub sent_away: Option<String>,
    /// Batches of local input that never reached the others.
    pub undelivered: u64,
}

impl SharedEnd {
    /// Returns a message for the person; `None`: all input was delivered.
    pub fn trouble(&self) -> Option<String> {
        let kept = "they are in this daemon's sculpture and session alone";
        match (&self.sent_away, self.undelivered) {
            (None, 0) => None,
            (None, n) => Some(format!("{n} batches of input did not reach the others: {kept}")),
            (Some(why), 0) => Some(format!("this daemon was sent away: {why}")),
            (Some(why), n) => Some(format!(
                "this daemon was sent away: {why}. {n} batches of its input did not reach the \
                 others: {kept}"
            )),
        }
    }
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
