//! What the screen of an installation says, said aloud by a program of the installer's (a speech
//! synthesiser): once when it appears.

use std::process::{Child, Command, Stdio};

use super::{Stage, View};

/// Says what appears. One sentence at a time: a newer one is not said while one is being said.
#[derive(Debug)]
pub(super) struct Speech {
    program: Vec<String>,
    welcome: String,
    countdown: String,
    said: Option<Stage>,
    saying: Option<Child>,
}

impl Speech {
    /// `program` and its arguments, nothing is said without one; what is said to whoever comes, and
    /// before the visit ends, `{seconds}` for a number.
    pub(super) fn new(program: &[String], welcome: &str, countdown: &str) -> Speech {
        Speech {
            program: program.to_vec(),
            welcome: welcome.to_owned(),
            countdown: countdown.to_owned(),
            said: None,
            saying: None,
        }
    }

    /// Returns the sentence to speak now, unless it was spoken already.
    fn sentence(&mut self, now: &View) -> Option<String> {
        if self.said == Some(now.stage) {
            return None;
        }
        self.said = Some(now.stage);
        match now.stage {
            Stage::Attract => Some(self.welcome.clone()),
            Stage::Working | Stage::Farewell | Stage::Closed => None,
            Stage::Countdown => {
                Some(self.countdown.replace("{seconds}", &now.seconds_left.to_string()))
            }
        }
    }

    /// Says what has appeared.
    pub(super) fn say(&mut self, now: &View) {
        let Some((program, arguments)) = self.program.split_first() else { return };
        if let Some(child) = &mut self.saying {
            match child.try_wait() {
                Ok(None) => return,
                Ok(Some(_)) | Err(_) => self.saying = None,
            }
        }
        let mut command = Command::new(program);
        command.args(arguments).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        let Some(text) = self.sentence(now) else { return };
        match command.arg(text).spawn() {
            Ok(child) => self.saying = Some(child),
            Err(e) => {
                tracing::error!("speak: {}: {e}", self.program[0]);
                self.program.clear();
            }
        }
    }
}

impl Drop for Speech {
    fn drop(&mut self) {
        if let Some(child) = &mut self.saying {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_stage_is_said_once_when_it_begins() {
        let mut speech = Speech::new(&[], "Touch", "Back in {seconds}");
        let view = |stage, seconds_left| View { stage, seconds_left, ..View::default() };
        let stages = [
            (Stage::Attract, 0, Some("Touch")),
            (Stage::Attract, 0, None),
            (Stage::Working, 0, None),
            (Stage::Countdown, 15, Some("Back in 15")),
            (Stage::Countdown, 14, None),
            (Stage::Working, 0, None),
            (Stage::Attract, 0, Some("Touch")),
        ];
        for (stage, left, asked) in stages {
            assert_eq!(speech.sentence(&view(stage, left)).as_deref(), asked);
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_program_is_given_the_words_and_one_that_is_not_there_is_told_once() {
        let dir = tempfile::tempdir().expect("a folder");
        let told = dir.path().join("told");
        let script = format!("printf %s \"$0\" > {}", told.display());
        let program = ["sh", "-c", &script].map(String::from);
        let mut speech = Speech::new(&program, "Touch to sculpt", "");
        let now = View::default();
        speech.say(&now);
        let child = speech.saying.as_mut().expect("it speaks");
        assert!(child.wait().expect("it ends").success());
        assert_eq!(std::fs::read_to_string(&told).expect("a file"), "Touch to sculpt");
        let mut none = Speech::new(&["/no/such/program".into()], "Touch", "");
        none.say(&now);
        assert!(none.program.is_empty());
    }
}
