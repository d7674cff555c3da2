//! The sound of the contact, where a person has asked for it.

use super::contact_sound::ContactSound;
use super::state::WindowState;
use super::wiring::Wiring;
use crate::language::tr;
use crate::sound::Player;
use crate::sound::no_sound::NoSound;
use sculptd_daemon::Published;

impl WindowState {
    /// Lets what the pens and hands do be heard. `true` where a message has come of it.
    pub(super) fn follow_sound(&mut self, state: &Published, wiring: &Wiring) -> bool {
        if !self.ui_state.prefs.sound {
            self.sound = ContactSound::default();
            return false;
        }
        if self.sound.failed {
            return false;
        }
        let (touch, runs) = self.sound.heard.touch(state, wiring.clock.now_us());
        let failed = match &mut self.sound.player {
            Some(player) => player.play(&touch, runs),
            None => match Player::open() {
                Ok(player) => {
                    self.sound.player = Some(player);
                    None
                }
                Err(why) => Some(why),
            },
        };
        let Some(why) = failed else { return false };
        (self.sound.player, self.sound.failed) = (None, true);
        let text = match why {
            NoSound::NotBuilt => {
                // Not to be told at each start.
                self.ui_state.prefs.sound = false;
                tr!("sound-not-built")
            }
            NoSound::Failed(error) => tr!("sound-failed", error = error),
        };
        self.ui_state.say(text, true);
        true
    }
}
