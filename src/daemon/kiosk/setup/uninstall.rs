//! `sculptd kiosk uninstall`.

use std::path::Path;

use super::record::InstallRecord;
use super::{
    CommandReport, FILES, FileAction, FileReport, RECORD, SERVICE, SetupError, SetupReport, at,
    below, check_rights, content_of, system_command,
};

/// Removes what an install wrote. Works, gallery, audit and files that a person changed stay, and
/// the report names them.
///
/// # Errors
/// Nothing was installed; the rights are missing; names the file that cannot be removed.
pub fn uninstall(root: &Path, dry_run: bool) -> Result<SetupReport, SetupError> {
    if !dry_run {
        check_rights(root)?;
    }
    let Some(record) = InstallRecord::read(root)? else {
        return Err(SetupError::NotInstalled(below(root, RECORD)));
    };
    let mut report = SetupReport { dry_run, ..SetupReport::default() };
    let is_running_system = root == Path::new("/");
    let run = |report: &mut SetupReport, words: &[&str]| {
        let planned = CommandReport { command: words.join(" "), failure: None };
        let done = if dry_run { planned } else { system_command(root, words) };
        report.commands.push(done);
    };
    if is_running_system {
        run(&mut report, &["systemctl", "stop", SERVICE]);
    }
    for (name, ours) in &record.files {
        let path = below(root, name);
        let Some(found) = content_of(&path).map_err(at(&path))? else { continue };
        let action = match found == *ours {
            true => FileAction::Remove,
            false => FileAction::LeaveChanged,
        };
        if action == FileAction::Remove && !dry_run {
            std::fs::remove_file(&path).map_err(at(&path))?;
        }
        if action == FileAction::LeaveChanged {
            report.notes.push(format!("left: {name}, which somebody changed"));
        }
        let about = FILES.iter().find(|file| file.path == *name).map_or("", |file| file.about);
        report.files.push(FileReport { path: name.clone(), about, action });
    }
    if !dry_run {
        let path = below(root, RECORD);
        std::fs::remove_file(&path).map_err(at(&path))?;
        for folder in record.folders.iter().rev() {
            // A folder that holds other files stays.
            let _ = std::fs::remove_dir(below(root, folder));
        }
    }
    if is_running_system {
        run(&mut report, &["systemctl", "daemon-reload"]);
        run(&mut report, &["systemctl", "try-restart", "systemd-journald.service"]);
        run(&mut report, &["udevadm", "control", "--reload"]);
    }
    if below(root, &record.home).exists() {
        let (user, home) = (&record.user, &record.home);
        report.notes.push(format!(
            "left: the user {user} and {home}, with the works, the gallery and the audit; remove \
             both with `userdel -r {user}`"
        ));
    }
    Ok(report)
}
