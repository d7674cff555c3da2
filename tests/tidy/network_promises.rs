//! Promises of the guide's chapters on shared sculptures and fleets, with the test that shows each.

use super::guide_promises::{Promise, assert_shown};

const ANSWERS: &str = "tests/it/shared/answers.rs";
const FAULTS: &str = "tests/it/shared/faults.rs";
const FLEET: &str = "tests/it/fleet.rs";
const SHARED: &str = "tests/it/shared.rs";
const KEYS: &str = "src/network/tests/it/keys.rs";
const MEMBERS: &str = "src/network/tests/it/members.rs";
const PEOPLE: &str = "src/network/tests/it/people.rs";
const SIMULATED: &str = "src/network/tests/it/faults.rs";
const SIMULATED_FLEET: &str = "src/network/tests/it/fleet.rs";
const WINDOW: &str = "tests/it/viewer/people.rs";

const AGAIN: &str = "the_same_command_again_joins_the_sculpture_that_is_there";
const ANSWERED: &str = "what_is_answered_is_so_whatever_happens_to_the_network";
const AT_ONCE: &str = "a_host_that_is_started_again_at_once_joins_its_own_sculpture";
const BROKEN_LINK: &str = "a_broken_link_is_refused_by_what_is_wrong_and_nothing_of_it_is_shown";
const CANARY: &str = "a_roll_out_is_stopped_by_a_canary_that_fails_and_reaches_nobody_else";
const FILES: &str = "everybody_has_a_file_that_gives_the_same_clay";
const FOLLOWED: &str =
    "a_host_that_dies_is_followed_within_two_seconds_and_nothing_acknowledged_is_lost";
const GUESTS: &str = "guests_join_by_a_link_see_each_other_and_take_back_their_own_steps";
const KILLS_AND_CUTS: &str = "three_people_have_one_sculpture_after_kills_pauses_and_cuts";
const PEN_LIFTED: &str = "who_was_killed_in_a_stroke_and_is_back_has_no_pen_on_the_clay";
const STAFF: &str = "staff_see_ask_and_roll_out_over_real_processes";
const THOUSAND: &str =
    "the_list_of_a_thousand_installations_is_right_within_ten_seconds_of_every_change";
const STILL_FITS: &str = "a_result_that_was_computed_among_strokes_of_others_still_fits";
const TWO: &str = "two_sculptures_of_one_name_are_told_apart_and_a_newcomer_is_asked";
const WITHDRAWN: &str =
    "who_is_withdrawn_is_out_within_two_seconds_and_stays_out_under_a_successor";
const WITHDRAWN_PROCESS: &str = "what_a_daemon_answers_is_so_for_a_viewer_and_for_who_is_withdrawn";

const TOGETHER_PROMISES: [Promise; 43] = [
    (
        "so has the same clay, to the bit",
        "every_command_of_each_gives_one_clay_here_there_and_in_every_file",
        SHARED,
    ),
    (
        "goes on while the others sculpt",
        "whole_object_work_lands_while_two_others_sculpt",
        "tests/it/shared/meanwhile.rs",
    ),
    ("wait for 0.3 seconds at most", STILL_FITS, PEOPLE),
    ("also if it is started again at once", AT_ONCE, MEMBERS),
    ("Strokes that a killed daemon had begun end", PEN_LIFTED, PEOPLE),
    (
        "A mesh is sent only when a person joins",
        "eight_people_over_a_bad_network_have_one_sculpture",
        SIMULATED,
    ),
    ("The same command again joins the sculpture", AGAIN, SHARED),
    ("share a sculpture of the same name, yours is another one", AGAIN, SHARED),
    (
        "valid only for that name",
        "a_key_gives_its_role_and_less_to_its_person_and_in_its_time",
        "src/network/membership.rs",
    ),
    ("`--expires 2h` lets it end", "an_invitation_ends_at_its_time", MEMBERS),
    ("that only you may read", BROKEN_LINK, SHARED),
    ("reads the link from standard input", BROKEN_LINK, SHARED),
    ("(exit code 2) that shows no part of it", BROKEN_LINK, SHARED),
    ("is sent away within two seconds, whoever hosts", WITHDRAWN, MEMBERS),
    ("it admits nobody again", WITHDRAWN_PROCESS, SHARED),
    ("sends the new list of members to all", "the_owner_withdraws_while_another_hosts", MEMBERS),
    ("sees the number, the people and the age of both", TWO, MEMBERS),
    (
        "Your stroke is shown at once",
        "a_stroke_is_shown_in_its_own_tick_and_the_clay_is_that_of_a_run_without_echo",
        "src/network/tests/it/echo.rs",
    ),
    (
        "shows the ring of each person's pen on the clay",
        "the_others_have_rings_in_their_colours_and_the_own_is_none_of_them",
        WINDOW,
    ),
    (
        "shows who is connected, their roles, and who has left",
        "the_list_says_who_is_here_as_what_and_who_has_gone",
        WINDOW,
    ),
    ("prints the same: names, roles, colours", GUESTS, SHARED),
    (
        "listed as gone five seconds after another daemon took over",
        "everybody_knows_who_is_here_and_who_has_gone",
        PEOPLE,
    ),
    (
        "give the connection: `hosts`, `follows`, `cut-off` or `sent-away`",
        WITHDRAWN_PROCESS,
        SHARED,
    ),
    ("Undo reverts your newest step, even if others have sculpted since", GUESTS, SHARED),
    ("undo restores the previous bits exactly", GUESTS, SHARED),
    ("changed the same place since, undo is refused", GUESTS, SHARED),
    ("A viewer's commands are refused, except for the camera", ANSWERED, ANSWERS),
    ("Nobody gets in without an invitation", "a_stranger_is_not_let_in_and_both_are_told", KEYS),
    ("can neither read nor forge them", "forged_messages_change_nothing", MEMBERS),
    ("nor repeat a recorded one", "recorded_messages_stop_no_election_and_change_nothing", MEMBERS),
    (
        "exceeds the limits all the same is sent away",
        "who_holds_a_key_and_floods_is_bounded_and_the_others_go_on",
        KEYS,
    ),
    ("which becomes the host within two seconds", FOLLOWED, SIMULATED),
    ("Acknowledged input is also on another daemon and is not lost", FOLLOWED, SIMULATED),
    ("The old host can join like everyone else", KILLS_AND_CUTS, FAULTS),
    (
        "each part continues alone",
        "what_each_part_of_a_split_network_acknowledged_is_in_the_one_sculpture",
        SIMULATED,
    ),
    ("is applied to the other's sculpture", KILLS_AND_CUTS, FAULTS),
    ("Nothing is lost if the interruption was shorter than two minutes", KILLS_AND_CUTS, FAULTS),
    ("it goes on alone with the sculpture", WITHDRAWN_PROCESS, SHARED),
    ("it delivers the last input first", ANSWERED, ANSWERS),
    ("compare a hash of the clay", "a_replica_that_differs_is_found_and_joins_anew", SIMULATED),
    ("Commands beyond 8 MiB (a very large mesh) are refused", ANSWERED, ANSWERS),
    ("it opens and replays alone, like any other", FILES, SHARED),
    ("its file ends there, and `mine-2.sculpt` continues", KILLS_AND_CUTS, FAULTS),
];

const FLEET_PROMISES: [Promise; 21] = [
    ("reports again once the network is back", THOUSAND, SIMULATED_FLEET),
    (
        "is valid only for its name",
        "keys_are_read_as_they_were_written_and_one_installation_opens_no_other",
        "src/network/fleet/access.rs",
    ),
    ("prints for each installation: visitor present or not", STAFF, FLEET),
    ("is shown as `LOST`", STAFF, FLEET),
    ("an installation without a screen refuses it", STAFF, FLEET),
    ("ends the visit as the button *Finished* does", STAFF, FLEET),
    ("closes the installation for cleaning, and opens it again", STAFF, FLEET),
    ("packs today's works into one file", STAFF, FLEET),
    ("starts the program again", STAFF, FLEET),
    ("ends the program for good", STAFF, FLEET),
    ("prints the newest lines of the log", STAFF, FLEET),
    ("exits with 1 if an installation refused or did not answer", STAFF, FLEET),
    (
        "programs (`speak`), folders and addresses cannot be set over the network",
        "nothing_that_names_programs_or_places_comes_over_the_network",
        "src/network/fleet/settings_files.rs",
    ),
    ("the file is reverted and no other installation gets it", CANARY, SIMULATED_FLEET),
    (
        "If one fails, all revert it",
        "a_roll_out_that_fails_among_the_others_is_taken_back_by_all",
        SIMULATED_FLEET,
    ),
    (
        "An installation reverts settings on trial by itself",
        "an_installation_that_is_cut_off_in_its_trial_takes_the_settings_back_by_itself",
        SIMULATED_FLEET,
    ),
    (
        "at its start if the previous run ended during the trial",
        "a_trial_that_kills_the_program_is_taken_back_by_the_next_start",
        "src/network/fleet/settings_files.rs",
    ),
    (
        "installs the file on those and skips the others",
        "a_roll_out_reaches_all_that_are_there_and_the_next_one_those_that_were_not",
        SIMULATED_FLEET,
    ),
    ("`rollback` restores the file before the last confirmed one", STAFF, FLEET),
    (
        "believes a run after it has answered a request that names no run",
        "recorded_states_show_nobody_to_a_list_that_knows_them_nor_to_one_that_restarts",
        SIMULATED_FLEET,
    ),
    ("Requests and answers are sealed", "forged_and_repeated_requests_do_nothing", SIMULATED_FLEET),
];

#[test]
fn every_promise_of_the_network_chapters_has_its_test() {
    assert_shown("config/guide/src/together.md", &TOGETHER_PROMISES);
    assert_shown("config/guide/src/fleet.md", &FLEET_PROMISES);
}
