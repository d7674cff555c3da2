//! `sculptd man`: manual pages out of the one definition of the command line.

use std::path::Path;

use super::{Fail, Outcome};
use sculptd_geometry::io::write_beside;

/// One page on standard output; with a folder, every page into it.
pub fn run(folder: Option<&Path>, mut command: clap::Command) -> Outcome {
    let Some(folder) = folder else {
        let page = clap_mangen::Man::new(command).render(&mut std::io::stdout());
        return page.map_err(|e| Fail::Input(e.to_string()));
    };
    std::fs::create_dir_all(folder).map_err(|e| Fail::io(folder, &e))?;
    command = command.disable_help_subcommand(true);
    command.build();
    pages(folder, &command)
}

/// The page of a command, and those of what is below it: `sculptd-session-show.1`.
fn pages(folder: &Path, command: &clap::Command) -> Outcome {
    let name = command.get_display_name().unwrap_or(command.get_name()).to_owned();
    let path = folder.join(format!("{name}.1"));
    let page = clap_mangen::Man::new(command.clone()).title(name);
    write_beside(&path, |out| page.render(out)).map_err(|e| Fail::io(&path, &e))?;
    command.get_subcommands().filter(|c| !c.is_hide_set()).try_for_each(|c| pages(folder, c))
}
