//! Generates the guide's command reference from the definition of the command line, in tests.

use clap::{Arg, ArgAction, Command, CommandFactory};

use super::Cli;

const HEAD: &str = "<!-- Generated from the help: the first paragraph says how. -->\n\n\
    # Command reference\n\n\
    This page is the help of the program: `sculptd COMMAND --help` prints the same. Change the \
    help in `src/cli` or `src/mesh_commands`, then write the page again: \
    `SCULPTD_BLESS=1 cargo test --release --workspace --lib command_reference`. A test fails where \
    page and help differ. A build with `--features network` has the commands `fleet` and `invite` \
    and more options of `run`, which are in its help alone.\n";

/// A text as Markdown in one cell of a table: nothing in it is HTML or ends the cell.
fn cell(text: &str) -> String {
    let mut code = false;
    let mut out = String::new();
    for c in text.split_whitespace().collect::<Vec<_>>().join(" ").chars() {
        match c {
            '`' => {
                code = !code;
                out.push(c);
            }
            '|' => out.push_str("\\|"),
            '<' if !code => out.push_str("&lt;"),
            '*' | '_' | '[' if !code => {
                out.push('\\');
                out.push(c);
            }
            c => out.push(c),
        }
    }
    out
}

fn sentence(text: String) -> String {
    if text.is_empty() || text.ends_with(['.', '!', '?']) { text } else { text + "." }
}

/// The option or argument as one types it.
fn spelling(arg: &Arg) -> String {
    let names: Vec<String> = arg
        .get_value_names()
        .map(|n| n.iter().map(|n| n.to_string()).collect())
        .unwrap_or_else(|| vec![arg.get_id().as_str().to_uppercase()]);
    let value = names.join(" ");
    let many = if matches!(arg.get_action(), ArgAction::Append) { "..." } else { "" };
    if arg.is_positional() {
        let name = value.to_uppercase();
        return if arg.is_required_set() { name } else { format!("[{name}]") } + many;
    }
    let short = arg.get_short().map(|s| format!("-{s}"));
    let long = arg.get_long().map(|l| format!("--{l}"));
    let names = short.into_iter().chain(long).collect::<Vec<_>>().join(", ");
    if arg.get_action().takes_values() { format!("{names} {value}{many}") } else { names }
}

/// One row of the table of options.
fn row(arg: &Arg) -> String {
    let help = arg.get_long_help().or(arg.get_help());
    let mut texts = vec![sentence(cell(&help.map(|h| h.to_string()).unwrap_or_default()))];
    if arg.get_action().takes_values() && !arg.is_hide_possible_values_set() {
        let values: Vec<String> = arg
            .get_possible_values()
            .iter()
            .filter(|v| !v.is_hide_set())
            .map(|v| match v.get_help() {
                Some(help) => format!("`{}`: {}", v.get_name(), cell(&help.to_string())),
                None => format!("`{}`", v.get_name()),
            })
            .collect();
        if !values.is_empty() {
            let long = values.iter().any(|v| v.contains(": "));
            texts.push(format!("Values: {}.", values.join(if long { "; " } else { ", " })));
        }
    }
    let usual: Vec<String> = arg
        .get_default_values()
        .iter()
        .map(|v| format!("`{}`", v.to_string_lossy()))
        .filter(|v| v != "`false`")
        .collect();
    if arg.get_action().takes_values() && !usual.is_empty() && !arg.is_hide_default_value_set() {
        texts.push(format!("Default: {}.", usual.join(", ")));
    }
    texts.retain(|t| !t.is_empty());
    format!("| `{}` | {} |\n", spelling(arg).replace('|', "\\|"), texts.join(" "))
}

fn table(args: &[&Arg]) -> String {
    if args.is_empty() {
        return String::new();
    }
    let rows: String = args.iter().map(|a| row(a)).collect();
    format!("| | |\n|---|---|\n{rows}\n")
}

/// The options of a command that are not those of every command.
fn own(command: &Command) -> Vec<&Arg> {
    let common = |a: &&Arg| {
        !a.is_hide_set()
            && !a.is_global_set()
            && !["help", "version"].contains(&a.get_id().as_str())
    };
    let (first, last): (Vec<&Arg>, Vec<&Arg>) =
        command.get_arguments().filter(common).partition(|a| a.is_positional());
    [first, last].concat()
}

/// The section of a command, and those of the commands below it.
fn sections(command: &mut Command, name: &str, out: &mut String) {
    let about = command.get_long_about().or(command.get_about());
    let about = sentence(cell(&about.map(|a| a.to_string()).unwrap_or_default()));
    let usage = command.render_usage().to_string();
    let usage = usage.trim_start_matches("Usage:").lines().map(str::trim).collect::<Vec<_>>();
    out.push_str(&format!("## {name}\n\n{about}\n\n```text\n{}\n```\n\n", usage.join("\n").trim()));
    out.push_str(&table(&own(command)));
    let below = command.get_subcommands_mut().filter(|c| !c.is_hide_set());
    for inner in below.filter(|c| c.get_name() != "help") {
        let name = format!("{name} {}", inner.get_name());
        sections(inner, &name, out);
    }
}

/// The page, as the command line is now.
fn page() -> String {
    let mut command = Cli::command().disable_help_subcommand(true);
    command.build();
    let mut out = HEAD.to_owned();
    out.push_str("\n| command | what it does |\n|---|---|\n");
    for inner in command.get_subcommands().filter(|c| !c.is_hide_set()) {
        let name = inner.get_name();
        let about = inner.get_about().map(|a| a.to_string()).unwrap_or_default();
        out.push_str(&format!("| [`{name}`](#sculptd-{name}) | {} |\n", sentence(cell(&about))));
    }
    out.push_str("\n## Options of every command\n\n");
    out.push_str(&table(
        &command.get_arguments().filter(|a| a.is_global_set()).collect::<Vec<_>>(),
    ));
    for inner in command.get_subcommands_mut().filter(|c| !c.is_hide_set()) {
        let name = format!("sculptd {}", inner.get_name());
        sections(inner, &name, &mut out);
    }
    out.trim_end().to_owned() + "\n"
}

/// With `SCULPTD_BLESS=1` the page is written instead.
#[allow(clippy::disallowed_methods)] // The file is under version control.
#[test]
fn the_page_is_the_help() {
    let now = page();
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/config/guide/src/commands.md");
    if std::env::var_os("SCULPTD_BLESS").is_some() {
        std::fs::write(path, &now).expect("written");
        return;
    }
    let then = std::fs::read_to_string(path).expect("config/guide/src/commands.md");
    let differs = now.lines().zip(then.lines()).find(|(a, b)| a != b);
    assert!(
        now == then,
        "config/guide/src/commands.md is not the help; write it with SCULPTD_BLESS=1: {differs:?}"
    );
}

#[test]
fn no_command_is_without_an_explanation() {
    fn silent(command: &Command, name: &str, out: &mut Vec<String>) {
        if command.get_about().is_none() {
            out.push(name.to_owned());
        }
        for inner in command.get_subcommands().filter(|c| !c.is_hide_set()) {
            silent(inner, &format!("{name} {}", inner.get_name()), out);
        }
    }
    let mut out = Vec::new();
    silent(&Cli::command().disable_help_subcommand(true), "sculptd", &mut out);
    assert!(out.is_empty(), "without help: {out:?}");
}
