//! What a station says among those who may take over, and the challenges of others that it heard
//! lately: its next word answers them.

use std::collections::VecDeque;

use crate::core::{Core, HeirsSeal};
use crate::seal::Secret;
use crate::wire::message::{Address, AmongHeirs, HeirsWord, MAX_HEARD, Reached};

/// Microseconds for which a challenge is answered.
const RECENT_US: u64 = 3_000_000;

/// The newest challenges, each once.
#[derive(Debug, Default)]
pub struct Heard(VecDeque<(u64, u64)>);

impl Heard {
    /// Takes the challenge of a message; 0 is none.
    pub fn take(&mut self, challenge: u64, now_us: u64) {
        if challenge == 0 {
            return;
        }
        self.0.retain(|(known, _)| *known != challenge);
        if self.0.len() >= MAX_HEARD {
            self.0.pop_front();
        }
        self.0.push_back((challenge, now_us));
    }

    /// The challenges to answer.
    pub fn recent(&self, now_us: u64) -> Vec<u64> {
        self.0.iter().filter(|(_, at)| now_us < at + RECENT_US).map(|(c, _)| *c).collect()
    }
}

/// The station's word among those who may take over.
#[derive(Debug, Default)]
pub struct Among {
    seal: Option<HeirsSeal>,
    /// The key that the seal was made of.
    group: Option<Secret>,
    /// The own challenge; 0: none.
    pub challenge: u64,
    /// The challenges of others.
    pub heard: Heard,
    /// When it was asked last who hosts.
    pub asked_us: u64,
}

impl Among {
    /// Says a word, with the own challenge and those that it answers.
    pub fn say(&mut self, core: &mut Core, word: HeirsWord, now_us: u64) {
        let Some(group) = core.group.clone() else { return };
        if self.group.as_ref() != Some(&group) {
            self.seal = Some(HeirsSeal::new(&group, core));
            self.group = Some(group);
        }
        let (challenge, heard) = (self.challenge, self.heard.recent(now_us));
        if let Some(seal) = &mut self.seal {
            core.among_heirs(seal, &AmongHeirs { challenge, heard, word });
        }
    }
}

/// The search for a successor.
#[derive(Debug)]
pub struct Election {
    /// When it is decided.
    pub until_us: u64,
    /// When the station speaks next.
    pub next_us: u64,
    /// The best word so far. If it is the own, this station hosts when the time is over.
    pub best: (Reached, Address),
    /// Another won.
    pub decided: bool,
}

/// Returns true if candidate `a` is better: it has more of the log; of equals, the lower address.
pub fn better(a: (Reached, Address), b: (Reached, Address)) -> bool {
    a.0 > b.0 || a.0 == b.0 && a.1 < b.1
}
