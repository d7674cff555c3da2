//! Promises of the guide's chapters, with the test that shows each: here those on installations.

use super::root;

/// A part of a sentence; the test; the file of the test.
pub(super) type Promise = (&'static str, &'static str, &'static str);

const KIOSK_PAGE: &str = "config/guide/src/kiosk.md";
const EXHIBIT_PAGE: &str = "config/guide/src/exhibits.md";
const FIRST_PAGE: &str = "config/guide/src/first-installation.md";

const CHECKED: &str = "settings_are_checked_with_all_that_they_name";
const CYCLE: &str = "src/daemon/kiosk/cycle.rs";
const DOOR: &str = "src/daemon/kiosk/visit_door.rs";
const EXHIBITS: &str = "tests/it/exhibits.rs";
const GALLERY: &str = "tests/it/gallery.rs";
const KILLS: &str = "tests/it/kiosk_kills.rs";
const RANDOM_KILLS: &str = "tests/it/kiosk_kills/random_kills.rs";
const SCREENS: &str = "tests/window/kiosk_screens.rs";
const SETUP: &str = "tests/it/kiosk_setup.rs";
const TELEMETRY: &str = "tests/it/telemetry.rs";
const TRIAL: &str = "tests/it/kiosk_trial.rs";
const VIEWER: &str = "tests/it/viewer/kiosk.rs";
const KIOSK: &str = "tests/it/kiosk.rs";

const AGAIN: &str = "an_installation_comes_back_each_time_its_screen_is_lost";
const CARVES: &str = "a_visitor_carves_the_bear_and_staff_ends_the_day";
const CHANGED: &str = "what_a_person_changed_is_neither_overwritten_nor_removed_and_works_stay";
const CHOOSES: &str = "a_visitor_chooses_an_exhibit_hides_the_goal_and_compares";
const CLOSED: &str = "a_visit_ends_at_its_limit_and_nobody_comes_while_it_is_closed";
const CLOSED_SCREEN: &str = "a_closed_installation_says_when_it_opens_and_has_no_tools";
const COUNTDOWN: &str = "any_touch_stops_the_countdown_and_without_one_the_visit_ends";
const CREATED: &str = "a_goal_stands_on_the_ground_in_a_block_that_holds_it";
const CREATE: &str = "src/daemon/kiosk/exhibit/create.rs";
const DAY: &str = "days_of_visits_fill_no_disk_and_each_killed_visit_goes_on";
const DISK: &str = "a_full_disk_is_seen_to_be_reported_and_to_be_over";
const FILMS: &str = "a_session_leaves_out_the_films_between_visits";
const GUESSING: &str = "the_staff_s_number_opens_their_page_and_guessing_is_slow";
const CONSENT: &str = "a_visitor_consents_in_any_language_and_gets_a_code";
const DRIFT: &str = "texts_drift_while_nobody_is_here_and_stand_still_during_a_visit";
const FAREWELL: &str = "a_visitor_who_ends_a_visit_gets_a_farewell_and_one_who_left_does_not";
const HINTS: &str = "a_visitor_who_has_not_sculpted_yet_sees_how";
const HOT_PLUG: &str = "devices/src/scenarios/hot_plug.rs";
const INSTALL: &str =
    "an_install_writes_its_list_once_and_an_uninstall_leaves_the_system_as_it_was";
const INITIAL: &str = "every_visitor_begins_with_the_brush_of_the_settings";
const INTERRUPTED: &str = "an_interrupted_visit_comes_to_the_gallery_where_the_settings_say_so";
const KEYPAD: &str = "staff_types_a_number_that_is_not_shown";
const KILLED: &str = "a_visit_goes_on_after_a_kill_and_its_work_comes_to_the_gallery";
const LANGUAGE: &str = "a_language_file_without_a_text_has_it_in_english";
const MADE: &str = "an_exhibit_is_made_from_a_mesh_and_told_what_is_wrong";
const PACK: &str = "a_pack_comes_back_from_a_folder_and_from_a_file";
const PLUGGED: &str = "a_replug_needs_nothing_and_ends_what_was_pressed";
const RANDOM: &str = "random_kills_and_cuts_lose_no_visit";
const SCORE: &str = "the_score_is_what_the_distance_command_measures";
const SETTINGS: &str = "src/daemon/kiosk/settings.rs";
const SPEECH: &str = "each_stage_is_said_once_when_it_begins";
const STAFF_FIGURES: &str = "the_staff_page_shows_figures_and_asks_twice_before_the_end";
const STAFF_WAITS: &str = "a_visit_waits_while_the_staff_page_is_open";
const SWITCH: &str = "one_switch_presses_what_is_lit_and_all_lies_within_reach";
const TAKEN_HOME: &str = "a_visitor_sees_the_work_in_3_d_takes_it_home_and_deletes_it";
const WALL: &str = "curated_works_and_those_of_today_take_turns_and_too_large_ones_are_left_out";
const TRIED: &str = "a_trial_reports_what_it_saw_and_what_it_could_not_try";
const VISIT: &str = "a_visit_from_the_attract_loop_to_the_gallery_and_staff_lets_out";

const KIOSK_PROMISES: [Promise; 64] = [
    ("after each one up to three works turn once, with their number", VISIT, KIOSK),
    ("those of the day, and curated ones", WALL, "src/daemon/kiosk/wall.rs"),
    ("is left out, with a line in the log", WALL, "src/daemon/kiosk/wall.rs"),
    ("The texts drift slowly", DRIFT, VIEWER),
    ("The first touch begins a visit on the start form, whatever is shown", VISIT, KIOSK),
    ("until the visitor's first stroke", HINTS, VIEWER),
    ("It asks for consent", CONSENT, VIEWER),
    ("shows the work in 3-D, offers it as GLB and STL", TAKEN_HOME, GALLERY),
    ("from where `gallery_store` sent it", TAKEN_HOME, GALLERY),
    ("The link expires after `share_minutes`", TAKEN_HOME, GALLERY),
    ("after a minute without a touch", FAREWELL, CYCLE),
    ("A visitor who walks away gets no farewell", FAREWELL, CYCLE),
    (
        "how dark it is at these times while nobody is here",
        "an_evening_is_darker_and_a_night_darker_still",
        "src/daemon/kiosk/hours.rs",
    ),
    (
        "shows the same figures and has the same buttons",
        "staff_see_ask_and_roll_out_over_real_processes",
        "tests/it/fleet.rs",
    ),
    ("`install` writes these files", INSTALL, SETUP),
    ("prints the PIN of the staff page", INSTALL, SETUP),
    ("It makes the user `visitor`", INSTALL, SETUP),
    ("`--root FOLDER` sets up a system that is mounted there", INSTALL, SETUP),
    ("A second `install` changes nothing", INSTALL, SETUP),
    ("A file that you changed is never overwritten", CHANGED, SETUP),
    ("`sculptd kiosk uninstall` removes what `install` wrote", INSTALL, SETUP),
    ("It leaves works, gallery, audit and files that you changed", CHANGED, SETUP),
    ("They start both again after a crash, a kill or a lost screen", AGAIN, SCREENS),
    ("in which it makes no progress", "only_progress_feeds_the_watchdog", "src/daemon/systemd.rs"),
    ("When the X server ends, its programs end too", AGAIN, SCREENS),
    ("the next start continues the visit", AGAIN, SCREENS),
    ("enter this PIN to open the staff page", KEYPAD, VIEWER),
    ("*End for good*, pressed twice, ends the installation", CARVES, "tests/window/exhibits.rs"),
    ("`sculptd ctl shutdown` and SIGTERM to the program end it", AGAIN, SCREENS),
    ("`seated = true` for buttons in the lower half of the screen", SWITCH, VIEWER),
    ("the switch presses the lit one", SWITCH, VIEWER),
    ("reads the screen's texts aloud", SPEECH, "src/daemon/kiosk/speech.rs"),
    ("set the initial state for each visitor", INITIAL, KILLS),
    ("A tablet that is unplugged and plugged in again works at once", PLUGGED, HOT_PLUG),
    ("A text that a file lacks is shown in English", LANGUAGE, SETTINGS),
    ("With several, visitors choose one by its picture", CHOOSES, VIEWER),
    ("a still picture with the next opening time", CLOSED_SCREEN, VIEWER),
    ("at closing time has five more minutes", CLOSED, CYCLE),
    ("The staff page shows the visits and works of today", STAFF_FIGURES, VIEWER),
    (
        "pack today's works into one file",
        "the_works_of_today_are_packed_and_those_of_yesterday_not",
        "src/daemon/kiosk/staff.rs",
    ),
    ("While it is open the visit's time stands still", STAFF_WAITS, CYCLE),
    ("it closes by itself after three minutes", STAFF_WAITS, CYCLE),
    ("After three wrong PINs the keypad is locked", GUESSING, CYCLE),
    ("It kills the program, ends the X server, fills for some seconds the disk", TRIED, TRIAL),
    (
        "It ends with 1 if the installation did not do what this page promises",
        "a_trial_fails_where_nothing_comes_back",
        TRIAL,
    ),
    ("A line *not tried* gives the reason", TRIED, TRIAL),
    ("strokes end; the tablet works again once it is plugged in", PLUGGED, HOT_PLUG),
    ("with the sculpture of that visit, and the visitor continues", KILLED, KILLS),
    ("up to a quarter of a second of input is lost", RANDOM, RANDOM_KILLS),
    ("sculpting continues; the staff page and `sculptd ctl status` report", DISK, TRIAL),
    ("a message; the keypad is locked for a minute", KEYPAD, VIEWER),
    ("a still screen; a touch begins no visit", CLOSED, CYCLE),
    ("one line in the audit per visit, none between", DAY, KILLS),
    (
        "gives a monitor the losses, times and the state of the session file",
        "the_service_manager_hears_and_the_figures_are_ours_alone",
        "tests/it/service.rs",
    ),
    ("which is removed once its work is in the gallery", DAY, KILLS),
    ("puts the work of an interrupted visit into the gallery", INTERRUPTED, KILLS),
    ("the attract films between them are left out", FILMS, KIOSK),
    (
        "logs the failure once and keeps the newest 3,600 log lines",
        "a_collector_that_is_away_is_told_of_once_and_catches_up",
        TELEMETRY,
    ),
    (
        "sends the same metrics to a collector",
        "a_collector_gets_the_figures_of_the_page_for_prometheus",
        TELEMETRY,
    ),
    ("`check` opens all exhibits and recordings", CHECKED, SETUP),
    ("It ends with 1 if something is wrong", CHECKED, SETUP),
    ("`languages` chooses among them", "codes_choose_among_the_built_in_languages", SETTINGS),
    ("What visitors do then is left out", "a_locked_door_lets_the_film_through_alone", DOOR),
    ("or after 15 seconds without a touch", FAREWELL, CYCLE),
];

const EXHIBIT_PROMISES: [Promise; 11] = [
    ("which shows through the clay, and see how near they are", CHOOSES, VIEWER),
    ("the goal scaled to 100 mm, a block around it", CREATED, CREATE),
    (
        "An open mesh is remeshed to a solid, with a note",
        "an_open_mesh_becomes_a_solid_and_says_so",
        CREATE,
    ),
    (
        "makes one file of it, which works in the same places",
        PACK,
        "src/daemon/kiosk/exhibit/open.rs",
    ),
    (
        "The score says how much of the way",
        "half_a_work_is_half_right",
        "src/daemon/kiosk/exhibit/score.rs",
    ),
    ("as `sculptd distance` measures them", SCORE, EXHIBITS),
    ("*Show the difference* colours the clay", CHOOSES, VIEWER),
    ("It writes a folder", MADE, EXHIBITS),
    ("the audit file has it for each visit", "a_visit_to_any_exhibit_goes_on_after_a_kill", KILLS),
    (
        "`new-exhibit` counts parts, holes and crossing triangles",
        "a_goal_in_parts_and_a_goal_that_crosses_itself_are_named",
        CREATE,
    ),
    ("neither `new-exhibit` nor `pack` overwrites one", PACK, "src/daemon/kiosk/exhibit/open.rs"),
];

const FIRST_PROMISES: [Promise; 8] = [
    (
        "copies each one to a folder elsewhere",
        "a_dead_network_loses_nothing_and_the_order_is_kept",
        GALLERY,
    ),
    ("a countdown after 45 seconds without a touch", COUNTDOWN, CYCLE),
    ("another signal or `sculptd ctl shutdown` ends the installation", VISIT, KIOSK),
    ("the sculpture goes to the gallery", VISIT, KIOSK),
    ("strokes play by themselves until somebody comes", VISIT, KIOSK),
    (
        "A gallery is a folder of meshes with a picture each",
        "a_work_is_sent_once_with_its_picture_whenever_the_sender_looks",
        GALLERY,
    ),
    (
        "by which a visitor's telephone loads the sculpture",
        "a_link_gives_one_work_to_whoever_has_it_until_it_expires",
        GALLERY,
    ),
    ("hides a bear in a block", CARVES, "tests/window/exhibits.rs"),
];

#[test]
fn every_promise_of_the_installation_chapters_has_its_test() {
    assert_shown(KIOSK_PAGE, &KIOSK_PROMISES);
    assert_shown(EXHIBIT_PAGE, &EXHIBIT_PROMISES);
    assert_shown(FIRST_PAGE, &FIRST_PROMISES);
}

/// The page says each sentence, and its test exists.
pub(super) fn assert_shown(page: &str, promises: &[Promise]) {
    let read = |file: &str| std::fs::read_to_string(root().join(file)).unwrap_or_default();
    let text = read(page).split_whitespace().collect::<Vec<_>>().join(" ");
    let mut faults = Vec::new();
    for (sentence, test, file) in promises {
        if !text.contains(sentence) {
            faults.push(format!("{page} does not say: {sentence}"));
        }
        if !read(file).contains(&format!("fn {test}(")) {
            faults.push(format!("{file} has no test {test}"));
        }
    }
    assert!(faults.is_empty(), "{faults:#?}");
}
