//! What the README says is true: its examples run, its profile loads, its tables are complete.

mod support {
    pub(crate) mod program;
    #[cfg(unix)]
    pub(crate) mod pty;
}

use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;

use meterpoll::commands::ExitCode;
use meterpoll::transport::faulty::{FaultKind, FaultRule, FaultScript};
use support::program::Program;
#[cfg(unix)]
use support::pty::{self, PtyMeter};

const README: &str = include_str!("../README.md");

/// Text of the fenced blocks of one language.
fn blocks(language: &str) -> Vec<&'static str> {
    let fence = format!("```{language}\n");
    README
        .split(&fence)
        .skip(1)
        .map(|rest| rest.split("```").next().expect("a fence is closed"))
        .collect()
}

/// Words of a command line; only single quotes are used.
fn words(line: &str) -> Vec<String> {
    line.split_whitespace()
        .map(|word| word.replace('\'', ""))
        .collect()
}

#[test]
fn the_two_commands_for_a_fresh_machine_are_there() {
    assert_eq!(
        blocks("sh"),
        [
            "cargo run --release -- read-registers --port sim: --unit 17 --meter pqm\n",
            "cargo test\n"
        ]
    );
}

#[test]
fn every_example_that_needs_no_adapter_runs() {
    let folder = with_the_profile("examples");
    let mut ran = 0;
    for block in blocks("console") {
        let mut lines = block.lines().peekable();
        while let Some(line) = lines.next() {
            let command = line.strip_prefix("$ meterpoll ").expect("a command");
            let mut expected = String::new();
            while let Some(output) = lines.next_if(|line| !line.starts_with('$')) {
                expected.push_str(output);
                expected.push('\n');
            }
            if command.contains("/dev/") || command == "ports" {
                continue;
            }
            // It goes on until it is stopped.
            if command.starts_with("simulate") {
                let words = std::iter::once("meterpoll".to_owned()).chain(words(command));
                let parsed = meterpoll::cli::parse(words.map(Into::into));
                assert!(parsed.is_ok(), "{command}: {parsed:?}");
                continue;
            }
            let mut program = Program::new("").folder(&folder);
            for word in words(command) {
                program = program.argument(word);
            }
            let output = program.output();
            let stderr = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(0), "{command}: {stderr}");
            assert_eq!(stderr, "", "{command}");
            let stdout = String::from_utf8_lossy(&output.stdout);
            assert!(stdout.starts_with(&expected), "{command}: {stdout}");
            ran += 1;
        }
    }
    assert_eq!(ran, 22);
}

#[test]
fn every_fault_is_named_and_every_rule_shown_is_one() {
    let (_, table) = README
        .split_once("| rule | what happens |")
        .expect("a table");
    let (table, _) = table.split_once("| any of them").expect("the last row");
    let shown = table.split('`').skip(1).step_by(2);
    let rules: Vec<&str> = shown.filter(|rule| *rule != "timeout=1s").collect();
    let script = FaultScript::parse(&rules).expect("rules");
    let shown: BTreeSet<FaultKind> = script.rules().iter().map(FaultRule::kind).collect();
    assert_eq!(shown, FaultKind::all().collect());
}

#[test]
fn the_profile_shown_loads_and_there_is_nothing_to_say_about_it() {
    let folder = with_the_profile("checked");
    let (profile, advice) =
        meterpoll::profile::advice::advise("mine.toml", profile_shown()).expect("it loads");
    assert_eq!(profile.points.len(), 6);
    assert_eq!(profile.factors.len(), 1);
    assert_eq!(profile.identities.len(), 1);
    assert_eq!(advice, []);
    Program::new("meters check -q mine.toml")
        .folder(folder)
        .run();
}

#[cfg(unix)]
#[test]
fn a_meter_is_read_with_the_profile_shown() {
    // Two thirds of a full scale of 240 A.
    let meter = PtyMeter::new(Box::new(|request| {
        let held = |address| match address {
            0x0010 => Some(2301),
            0x0011 => Some(0),
            0x0012 => Some(6666),
            0x0013 => Some(5002),
            0x0034 => Some(1),
            0x0035 => Some(2),
            0x0100 => Some(200),
            _ => None,
        };
        pty::answer_with(4, request, held).unwrap_or_default()
    }));
    let port = meter.path();
    Program::new(&format!(
        "read-registers -p {port} -t 10s -a 4 --meter mine.toml -f csv"
    ))
    .folder(with_the_profile("read"))
    .stdout(
        "time,meter,unit_id,status,voltage_a,current_a,frequency,energy_import\n\
             <time>,mine,4,ok,230.1,160.000,50.02,65538\n",
    )
    .run();
}

/// The block that is a profile.
fn profile_shown() -> &'static str {
    let blocks = blocks("toml").into_iter();
    let mut profiles = blocks.filter(|block| block.starts_with("name = "));
    profiles.next().expect("a profile")
}

#[test]
fn the_site_file_shown_loads_and_so_does_the_one_that_shows_every_key() {
    use meterpoll::polling::site::load::load;

    let blocks = blocks("toml").into_iter();
    let shown = blocks.filter(|block| block.starts_with("[defaults]"));
    let shown: Vec<&str> = shown.collect();
    assert_eq!(shown.len(), 1);
    let site = load("README.md", shown[0], "").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(site.jobs.len(), 3);

    let every_key: String = include_str!("../src/polling/site/format.rs")
        .lines()
        .skip_while(|line| *line != "//! ```toml")
        .skip(1)
        .take_while(|line| *line != "//! ```")
        .flat_map(|line| [line.trim_start_matches("//!").trim_start(), "\n"])
        .collect();
    let site = load("format.rs", &every_key, "").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(site.jobs.len(), 2);
}

/// A folder with the profile shown in it.
fn with_the_profile(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("readme-{name}"));
    fs::create_dir_all(&folder).expect("the folder for tests is writable");
    fs::write(folder.join("mine.toml"), profile_shown()).expect("the folder is writable");
    folder
}

/// The source that describes the keys of a profile.
const FORMAT: &str = include_str!("../src/profile/format.rs");
/// Tables of its own beside it.
const OPERATIONS: &str = include_str!("../src/profile/format/operations.rs");

/// The profile in its documentation.
fn documented() -> String {
    FORMAT
        .lines()
        .skip_while(|line| *line != "//! ```toml")
        .skip(1)
        .take_while(|line| *line != "//! ```")
        .flat_map(|line| [line.trim_start_matches("//!").trim_start(), "\n"])
        .collect()
}

#[test]
fn the_profile_that_shows_every_key_loads() {
    let profile = meterpoll::profile::load::load("format.rs", &documented());
    let profile = profile.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(profile.points.len(), 24);
}

#[test]
fn every_key_of_a_profile_is_shown() {
    let documented = documented();
    let keys = keys();
    assert!(keys.len() > 30, "{}", keys.len());
    for key in keys {
        let shown =
            documented.contains(&format!("{key} = ")) || documented.contains(&format!("[{key}]"));
        assert!(shown, "{key}");
        let told = README.contains(&format!("`{key}`")) || README.contains(&format!("[{key}]"));
        // Keys of tables in place stand in them.
        assert!(
            told || README.contains(&format!("{key} = ")),
            "{key} in the README"
        );
    }
}

/// The keys of a profile.
fn keys() -> Vec<&'static str> {
    let fields = FORMAT.lines().chain(OPERATIONS.lines()).filter_map(|line| {
        let line = line.trim_start();
        let field = line
            .strip_prefix("pub(super) ")
            .or_else(|| line.strip_prefix("pub(in crate::profile) "))?;
        field.split_once(':').map(|(name, _)| name)
    });
    // `type` is a word of the language.
    fields
        .map(|field| if field == "kind" { "type" } else { field })
        .collect()
}

#[test]
fn every_option_it_names_is_in_the_help() {
    let commands = [
        "read-registers",
        "write-setpoint",
        "broadcast",
        "execute-operation",
        "read-status",
        "loopback",
        "poll",
        "simulate",
    ];
    let help = commands
        .map(|command| Program::new(&format!("{command} --help")).output().stdout)
        .concat();
    let help = String::from_utf8(help).expect("text");
    let mut named: Vec<&str> = README
        .split(|c: char| !(c.is_ascii_alphanumeric() || c == '-'))
        .filter(|word| word.starts_with("--") && word.trim_matches('-').len() > 1)
        .collect();
    named.sort_unstable();
    named.dedup();
    // These belong to cargo, to the soak, and to programs that take rows or start this one.
    let cargo = ["--release", "--path", "--fuzz-dir", "--bench"];
    let soak = ["--transactions", "--faults", "--seed"];
    let others = ["--now", "--csv", "--skip"];
    let foreign = [&cargo[..], &soak, &others].concat();
    named.retain(|option| !foreign.contains(option));
    assert!(named.len() > 10, "{named:?}");
    for option in named {
        assert!(help.contains(option), "{option} is not in the help");
    }
}

#[test]
fn every_exit_code_is_in_its_table() {
    let first_cells: Vec<&str> = README
        .lines()
        .filter_map(|line| line.strip_prefix("| ")?.split(" |").next())
        .flat_map(|cell| cell.split(", "))
        .collect();
    for (code, _) in meterpoll::cli::EXIT_CODES {
        assert!(first_cells.contains(&code.to_string().as_str()), "{code}");
    }
    // What the program ends with, typed from its contract.
    let ends = [
        ExitCode::Done,
        ExitCode::SomeMissing,
        ExitCode::Usage,
        ExitCode::Port,
        ExitCode::NoAnswer,
        ExitCode::Refused,
        ExitCode::WriteUnknown,
        ExitCode::Output,
        ExitCode::HungUp,
        ExitCode::Interrupted,
        ExitCode::Terminated,
    ];
    let told = meterpoll::cli::EXIT_CODES.map(|(code, _)| code);
    assert_eq!(ends.map(|end| end as u8), told);
    assert_eq!(told, [0, 1, 2, 3, 4, 5, 6, 7, 129, 130, 143]);
}
