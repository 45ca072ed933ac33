//! Completions and man pages are made from the command line's definitions and checked in. After a
//! change of those, `METERPOLL_UPDATE=1 cargo test --test generated` writes them anew.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::{env, fs};

use clap::{Command, CommandFactory};
use clap_complete::Shell;
use meterpoll::cli::{Arguments, EXIT_CODES, completion_script};

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

/// Compares a folder with what it should hold, or writes it when asked to.
#[track_caller]
fn check(name: &str, expected: &BTreeMap<String, Vec<u8>>) {
    let folder = folder(name);
    if env::var_os("METERPOLL_UPDATE").is_some() {
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).expect("the folder can be made");
        for (file, bytes) in expected {
            fs::write(folder.join(file), bytes).expect("the file can be written");
        }
    }
    let found: BTreeMap<String, Vec<u8>> = fs::read_dir(&folder)
        .expect("the folder is there")
        .map(|entry| entry.expect("an entry").path())
        .map(|path| {
            let file = path
                .file_name()
                .expect("a file")
                .to_string_lossy()
                .into_owned();
            (file, fs::read(&path).expect("a readable file"))
        })
        .collect();
    let names = |files: &BTreeMap<String, Vec<u8>>| files.keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(&found), names(expected), "files in {name}/");
    for (file, bytes) in expected {
        assert!(
            found[file] == *bytes,
            "{name}/{file} is stale: METERPOLL_UPDATE=1 cargo test --test generated"
        );
    }
}

#[test]
fn completions_say_what_the_program_takes() {
    let mut files = BTreeMap::new();
    for (shell, file) in [
        (Shell::Bash, "meterpoll.bash"),
        (Shell::Zsh, "_meterpoll"),
        (Shell::Fish, "meterpoll.fish"),
    ] {
        files.insert(file.to_owned(), completion_script(shell));
    }
    check("completions", &files);
}

#[test]
fn there_is_a_man_page_for_every_command() {
    let mut command = Arguments::command().disable_help_subcommand(true);
    command.build();
    let mut files = BTreeMap::new();
    pages(&command, &mut files);
    check("man", &files);
}

fn pages(command: &Command, files: &mut BTreeMap<String, Vec<u8>>) {
    // clap keeps names for the whole run.
    let name = command.get_display_name().unwrap_or(command.get_name());
    let name: &'static str = name.to_owned().leak();
    files.insert(format!("{name}.1"), page(command, name).into_bytes());
    for inner in command.get_subcommands() {
        pages(inner, files);
    }
}

/// One page: what the generator makes of the options, and the examples and exit codes, which it
/// would run together.
fn page(command: &Command, name: &'static str) -> String {
    let examples = command.get_after_help().map(ToString::to_string);
    let mut page = Vec::new();
    clap_mangen::Man::new(command.clone().name(name))
        .render(&mut page)
        .expect("writing to memory");
    let text = String::from_utf8(page).expect("text");
    let body = text.split(".SH EXTRA").next().unwrap_or_default();
    let body = body.split(".SH VERSION").next().unwrap_or_default();
    let mut page = String::new();
    let mut is_set = false;
    for line in body.lines() {
        // What is indented is set in columns and must not be filled.
        if line.starts_with("  ") != is_set {
            is_set = !is_set;
            page.push_str(if is_set { ".nf\n" } else { ".fi\n" });
        }
        // The generator ends some lines in spaces.
        page.push_str(line.trim_end());
        page.push('\n');
    }
    if let Some(examples) = examples {
        page.push_str(".SH EXAMPLES\n.nf\n");
        for line in examples.lines().filter(|line| line.starts_with("  ")) {
            page.push_str(&line.trim_start().replace('-', "\\-"));
            page.push('\n');
        }
        page.push_str(".fi\n");
    }
    page.push_str(".SH \"EXIT STATUS\"\n");
    for (code, meaning) in EXIT_CODES {
        page.extend([".TP\n", &code.to_string(), "\n", meaning, "\n"]);
    }
    page
}

#[test]
fn the_definitions_of_the_command_line_hold_together() {
    Arguments::command().debug_assert();
}

/// All commands, those below them as well.
fn all(command: &Command) -> Vec<&Command> {
    let below = command.get_subcommands().flat_map(all);
    std::iter::once(command).chain(below).collect()
}

#[test]
fn help_is_wrapped_at_the_width_of_the_terminal_and_nowhere_else() {
    /// In 80 columns, behind the margin that help has.
    const ROOM: usize = 70;
    let command = Arguments::command();
    for command in all(&command) {
        let of_arguments = command.get_arguments().map(clap::Arg::get_long_help);
        let texts = of_arguments.chain([command.get_long_about()]);
        for text in texts.flatten().map(ToString::to_string) {
            for paragraph in text.split("\n\n") {
                let is_table = |line: &&str| line.starts_with("  ");
                let (tables, words): (Vec<_>, Vec<_>) = paragraph.lines().partition(is_table);
                assert!(words.len() <= 1, "{paragraph}");
                let narrow = tables.iter().all(|line| line.chars().count() <= ROOM);
                assert!(narrow, "{paragraph}");
            }
        }
    }
}
