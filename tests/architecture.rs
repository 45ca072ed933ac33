//! The layers, held by reading the sources: imports run one way, and each outside library is used
//! where its job is.

mod support {
    pub(crate) mod paths;
}

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use support::paths::{modules, paths};

/// What each module, and each file directly in `src/`, may import from besides itself.
const LAYERS: [(&str, &[&str]); 16] = [
    ("codec", &[]),
    ("transport", &["codec"]),
    ("profile", &["codec", "transport"]),
    ("client", &["codec", "transport", "words"]),
    ("sim", &["codec", "transport", "profile", "words"]),
    ("readings", &["codec", "client", "profile", "words"]),
    (
        "polling",
        &["client", "codec", "profile", "readings", "transport"],
    ),
    ("append", &["transport"]),
    ("writing", &["client", "codec", "profile", "readings"]),
    (
        "output",
        &["append", "codec", "polling", "profile", "readings", "words"],
    ),
    ("cli", &[]),
    (
        "commands",
        &[
            "append",
            "cli",
            "client",
            "codec",
            "output",
            "polling",
            "profile",
            "readings",
            "sim",
            "transport",
            "words",
            "writing",
        ],
    ),
    ("words.rs", &[]),
    ("lib.rs", &[]),
    ("main.rs", &["commands"]),
    // It loads the built-in meters with the program's own loader.
    ("build.rs", &["profile"]),
];

/// Libraries that are like the standard one: any file may use them.
const EVERYWHERE: &[&str] = &[""];

/// The libraries of `[dependencies]` and the files and folders whose job they are.
const LIBRARIES: [(&str, &[&str]); 22] = [
    ("clap", &["cli/"]),
    ("clap_complete", &["cli/"]),
    ("comfy_table", &["output/columns.rs"]),
    ("crc", &["codec/rtu.rs"]),
    ("csv", &["output/csv.rs", "sim/values.rs"]),
    ("env_logger", &["commands/logging.rs"]),
    ("fastrand", &["transport/faulty/"]),
    (
        "humantime",
        &[
            "cli/",
            "client/",
            "commands/poll/forecast.rs",
            "output/loopback/",
            "output/profile/",
            "polling/schedule.rs",
            "polling/site/",
            "profile/",
            "transport/error.rs",
            "transport/faulty/",
        ],
    ),
    ("jiff", EVERYWHERE),
    ("log", EVERYWHERE),
    ("postcard", &["build.rs", "profile/builtin.rs"]),
    ("rust_decimal", EVERYWHERE),
    (
        "rustix",
        &[
            "append/system.rs",
            "commands/poll/screen.rs",
            "transport/lock.rs",
            "transport/pty.rs",
            "transport/pty/",
        ],
    ),
    ("serde", EVERYWHERE),
    ("serde_json", &["output/json.rs"]),
    ("serialport", &["transport/ports.rs", "transport/serial.rs"]),
    ("signal_hook", &["commands/signals.rs"]),
    ("strsim", &["profile/", "transport/faulty/"]),
    ("thiserror", EVERYWHERE),
    (
        "toml",
        &[
            "polling/site/",
            "profile/advice/",
            "profile/format.rs",
            "profile/format/",
            "profile/load.rs",
            "profile/load/",
        ],
    ),
    ("uzers", &["transport/serial.rs"]),
    ("wildmatch", &["profile/"]),
];

/// All sources, by their path below `src/`, with `/` between its parts.
fn sources() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut found = Vec::new();
    collect(&root, &mut found);
    found
        .into_iter()
        .map(|path| {
            let parts: Vec<_> = path
                .strip_prefix(&root)
                .expect("below src")
                .iter()
                .map(|part| part.to_str().expect("a name of text"))
                .collect();
            let text = fs::read_to_string(&path).expect("a readable source");
            (parts.join("/"), text)
        })
        .collect()
}

fn collect(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a readable folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            collect(&path, found);
        } else if path.extension().is_some_and(|end| end == "rs") {
            found.push(path);
        }
    }
}

/// What a path means.
#[derive(Debug, PartialEq, Eq)]
enum Meaning {
    /// Something of ours, by its module; the whole crate when there is none.
    Ours(Option<String>),
    /// A library.
    Library(&'static str),
}

/// The modules a file is in, outermost first: of `profile/load/point.rs` `profile`, `load`, `point`.
fn place(file: &str) -> Vec<&str> {
    let name = file.strip_suffix(".rs").expect("a Rust source");
    let mut place: Vec<_> = name.split('/').collect();
    if matches!(place.as_slice(), [.., "mod"] | ["lib" | "main" | "build"]) {
        place.pop();
    }
    place
}

/// What each path in a source means that is ours or a library's, and its line.
fn meanings(file: &str, text: &str) -> Vec<(Meaning, usize)> {
    let declared = modules(text);
    let mut found = Vec::new();
    for path in paths(text) {
        let first = path.segments[0].as_str();
        // In the crate's root the modules are there by their bare names.
        let is_bare = place(file).is_empty() && LAYERS.iter().any(|(module, _)| *module == first);
        let is_rooted = matches!(first, "crate" | "meterpoll" | "self" | "super");
        let meaning = if !path.is_global && (is_bare || is_rooted) {
            Meaning::Ours(module(place(file), &path.segments))
        } else {
            // A module of the same name hides the library.
            let is_hidden = !path.is_global && declared.iter().any(|module| module == first);
            let library = LIBRARIES.iter().find(|(library, _)| *library == first);
            match library.filter(|_| !is_hidden) {
                Some((library, _)) => Meaning::Library(library),
                None => continue,
            }
        };
        found.push((meaning, path.line));
    }
    found.dedup();
    found
}

/// The outermost module that a path leads to from a place; `None` when it ends in the root.
fn module<'a>(mut place: Vec<&'a str>, segments: &'a [String]) -> Option<String> {
    for segment in segments {
        match segment.as_str() {
            "self" => {}
            "super" => drop(place.pop()),
            "crate" | "meterpoll" => place.clear(),
            "*" => break,
            name => place.push(name),
        }
    }
    place.first().map(|module| (*module).to_owned())
}

/// What a source does that it may not, in words.
fn violations(file: &str, text: &str) -> Vec<String> {
    let layer = file.split('/').next().expect("split finds one part");
    let Some((_, allowed)) = LAYERS.iter().find(|(name, _)| *name == layer) else {
        return vec![format!("src/{file} is in no layer")];
    };
    meanings(file, text)
        .into_iter()
        .filter_map(|(meaning, line)| {
            let what = match meaning {
                Meaning::Ours(Some(module))
                    if module == layer || allowed.contains(&module.as_str()) =>
                {
                    return None;
                }
                Meaning::Ours(Some(module)) => format!("imports {module}"),
                Meaning::Ours(None) => "imports the crate's root".to_owned(),
                Meaning::Library(library) if may_use(file, library) => return None,
                Meaning::Library(library) => format!("uses {library}"),
            };
            Some(format!("src/{file}:{line} {what}"))
        })
        .collect()
}

fn may_use(file: &str, library: &str) -> bool {
    LIBRARIES
        .iter()
        .filter(|(name, _)| *name == library)
        .any(|(_, places)| places.iter().any(|place| file.starts_with(place)))
}

#[test]
fn imports_run_one_way_and_each_library_is_used_where_its_job_is() {
    let found: Vec<String> = sources()
        .iter()
        .flat_map(|(file, text)| violations(file, text))
        .collect();
    assert!(found.is_empty(), "{found:#?}");
}

#[test]
fn each_library_is_used_in_all_the_places_listed_for_it() {
    let sources = sources();
    for (library, places) in LIBRARIES {
        for place in places {
            let is_used = sources
                .iter()
                .filter(|(file, _)| file.starts_with(place))
                .flat_map(|(file, text)| meanings(file, text))
                .any(|(meaning, _)| meaning == Meaning::Library(library));
            assert!(is_used, "nothing in src/{place} uses {library}");
        }
    }
}

#[test]
fn the_libraries_listed_are_those_of_cargo_toml() {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml");
    let manifest = fs::read_to_string(manifest).expect("the manifest");
    let manifest: toml::Table = manifest.parse().expect("TOML");
    let names = |table: &toml::Value| {
        let dependencies = table.get("dependencies").and_then(toml::Value::as_table);
        let names = dependencies.into_iter().flat_map(toml::Table::keys);
        names.map(|name| name.replace('-', "_")).collect::<Vec<_>>()
    };
    let targets = manifest.get("target").and_then(toml::Value::as_table);
    let mut found: BTreeSet<String> = names(&toml::Value::Table(manifest.clone()))
        .into_iter()
        .collect();
    found.extend(
        targets
            .into_iter()
            .flat_map(toml::Table::values)
            .flat_map(names),
    );
    let listed = LIBRARIES.map(|(library, _)| library.to_owned());
    assert_eq!(found, BTreeSet::from(listed));
}

/// Checks what is found in a planted source.
#[track_caller]
fn plant(file: &str, text: &str, expected: &[&str]) {
    assert_eq!(violations(file, text), expected, "{file}: {text}");
}

#[test]
fn a_new_file_directly_in_src_is_in_no_layer() {
    let found = ["src/helper.rs is in no layer"];
    plant("helper.rs", "use crate::commands::run;", &found);
    plant("helper.rs", "", &found);
    plant("helper/mod.rs", "", &["src/helper/mod.rs is in no layer"]);
    plant("main.rs", "fn main() { meterpoll::commands::run() }", &[]);
    plant(
        "main.rs",
        "use meterpoll::codec::Unit;",
        &["src/main.rs:1 imports codec"],
    );
    plant(
        "lib.rs",
        "mod codec;\n\npub use codec::Unit;",
        &["src/lib.rs:3 imports codec"],
    );
    plant("main.rs", "use clap::Parser;", &["src/main.rs:1 uses clap"]);
}

#[test]
fn an_import_is_found_however_it_is_written() {
    let found = ["src/codec/rtu.rs:1 imports client"];
    for text in [
        "use crate::client;",
        "use crate::client::Client;",
        "pub(crate) use crate::client as other;",
        "use crate::{client, codec};",
        "use crate::{codec::{self, Unit}, client::{self}};",
        "use {std::fmt, crate::client::*};",
        "use super::super::client;",
        "use super::super::{client::Client};",
        "use self::super::super::client::Client;",
        "fn of(client: &crate::client::Client) {}",
        "fn of(client: Option<super::super::client::Client>) {}",
        "const SPACE: char = '\"'; use crate::client; const QUOTE: char = '\\'';",
        "const URL: &str = \"tcp://\"; use crate::client;",
        "const RAW: &str = r#\"a \" // \"#; use crate::client;",
        "/* /* */ */ use crate::client;",
        "impl<'a> A<'a> { fn b(&'a self) -> crate::client::Client { self.c } }",
        "use r#crate::client;",
    ] {
        plant("codec/rtu.rs", text, &found);
    }
    plant(
        "codec/rtu.rs",
        "use std::fmt;\n\n// A comment.\nuse crate::{\n    client,\n    codec,\n};\n",
        &["src/codec/rtu.rs:5 imports client"],
    );
}

#[test]
fn the_crates_root_cannot_be_renamed() {
    for (file, text) in [
        ("codec/rtu.rs", "use crate as root;"),
        ("codec/rtu.rs", "use crate::*;"),
        ("codec/rtu.rs", "use super::super as root;"),
        ("codec/mod.rs", "use super::{self as root};"),
    ] {
        let found = violations(file, text);
        assert_eq!(found.len(), 1, "{file}: {text}: {found:?}");
    }
}

#[test]
fn what_is_allowed_or_no_import_is_left_alone() {
    for (file, text) in [
        ("codec/rtu.rs", "use super::address::Unit;"),
        (
            "codec/mod.rs",
            "use self::address::Unit;\npub use rtu::Frame;",
        ),
        ("profile/load/point.rs", "use super::super::model::Profile;"),
        (
            "client/belief.rs",
            "use crate::{codec::Unit, transport::Line};",
        ),
        (
            "codec/rtu.rs",
            "// use crate::client;\n/// [`crate::client`]\n//! clap::Parser",
        ),
        ("codec/rtu.rs", "/* use crate::client;\n clap::Parser */"),
        (
            "codec/rtu.rs",
            "const TEXT: &str = \"crate::client::Client\";",
        ),
        ("codec/rtu.rs", "const TEXT: &str = \"\\\" clap::Parser\";"),
        (
            "codec/rtu.rs",
            "fn of(clap: u8) -> u8 { clap + self.toml.parse::<u8>() }",
        ),
        (
            "codec/rtu.rs",
            "pub(crate) fn of() -> myclap::Parser { my_csv::new() }",
        ),
        ("codec/rtu.rs", "fn of() -> impl Iterator + use<'_, csv> {}"),
        ("output/mod.rs", "pub mod csv;\npub use csv::LongCsv;"),
        (
            "commands/read_registers.rs",
            "use crate::output::csv::CsvStyle;",
        ),
    ] {
        plant(file, text, &[]);
    }
}

#[test]
fn a_library_is_found_wherever_it_is_named() {
    for (file, text, library) in [
        (
            "commands/error.rs",
            "Ports(Option<serialport::Error>),",
            "serialport",
        ),
        ("commands/error.rs", "fn of(error: &clap::Error) {}", "clap"),
        ("commands/error.rs", "Bad(#[from] toml::de::Error),", "toml"),
        (
            "commands/mod.rs",
            "use clap_complete::Shell;",
            "clap_complete",
        ),
        ("commands/mod.rs", "use clap;", "clap"),
        ("commands/mod.rs", "use clap as parser;", "clap"),
        (
            "commands/mod.rs",
            "use {std::fmt, clap::{Args, Parser as P}};",
            "clap",
        ),
        ("commands/mod.rs", "extern crate clap;", "clap"),
        ("commands/mod.rs", "impl ::clap::Parser for A {}", "clap"),
        ("commands/mod.rs", "let a=csv::Writer::new();", "csv"),
        ("commands/mod.rs", "![csv::Writer::new()]", "csv"),
        ("output/table.rs", "use csv::Writer;", "csv"),
        // Beside a module of that name the library needs its colons.
        ("output/mod.rs", "mod csv;\nuse ::csv::Writer;", "csv"),
        (
            "transport/line.rs",
            "use serialport::SerialPort;",
            "serialport",
        ),
        ("codec/length.rs", "crc::Crc::<u16>::new()", "crc"),
    ] {
        let found = violations(file, text);
        let line = text.lines().count();
        assert_eq!(
            found,
            [format!("src/{file}:{line} uses {library}")],
            "{text}"
        );
    }
}

#[test]
fn no_source_file_is_longer_than_500_lines() {
    for (file, text) in sources() {
        let lines = text.lines().count();
        assert!(lines <= 500, "src/{file} has {lines} lines");
    }
}
