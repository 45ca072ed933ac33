//! The layers, held by reading the sources: imports run one way, and each outside library is used
//! where its job is.

use std::fs;
use std::path::{Path, PathBuf};

/// The modules each module may import from, itself aside.
const LAYERS: [(&str, &[&str]); 9] = [
    ("codec", &[]),
    ("transport", &["codec"]),
    ("profile", &["codec", "transport"]),
    ("client", &["codec", "transport"]),
    ("sim", &["codec", "transport", "profile"]),
    ("readings", &["codec", "client", "profile"]),
    ("output", &["profile", "readings"]),
    ("cli", &[]),
    (
        "commands",
        &[
            "cli",
            "client",
            "codec",
            "output",
            "profile",
            "readings",
            "sim",
            "transport",
        ],
    ),
];

/// Libraries and the files that may name them.
const LIBRARIES: [(&str, &[&str]); 7] = [
    (
        "clap",
        &[
            "cli/",
            "commands/mod.rs",
            "commands/report.rs",
            "commands/completions.rs",
        ],
    ),
    (
        "serialport",
        &[
            "transport/serial.rs",
            "commands/ports.rs",
            "commands/error.rs",
        ],
    ),
    ("csv", &["output/csv.rs"]),
    ("serde_json", &["output/json.rs"]),
    ("comfy_table", &["output/columns.rs"]),
    (
        "toml",
        &["profile/format.rs", "profile/load.rs", "profile/load/"],
    ),
    ("crc", &["codec/rtu.rs"]),
];

fn sources() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut found = Vec::new();
    collect(&root, &mut found);
    found
        .into_iter()
        .map(|path| {
            let name = path
                .strip_prefix(&root)
                .expect("below src")
                .display()
                .to_string();
            (name, fs::read_to_string(&path).expect("a readable source"))
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

/// Code without comments and doc comments.
fn code(text: &str) -> impl Iterator<Item = &str> {
    text.lines()
        .filter(|line| !line.trim_start().starts_with("//"))
}

#[test]
fn imports_run_one_way() {
    for (file, text) in sources() {
        let Some((module, _)) = file.split_once('/') else {
            continue;
        };
        let allowed = LAYERS.iter().find(|(name, _)| *name == module);
        let (_, allowed) = allowed.unwrap_or_else(|| panic!("src/{module} is in no layer"));
        for line in code(&text) {
            for (at, _) in line.match_indices("crate::") {
                let rest = &line[at + "crate::".len()..];
                let end = rest.find(|c: char| !c.is_ascii_lowercase() && c != '_');
                let target = &rest[..end.unwrap_or(rest.len())];
                assert!(
                    target == module || allowed.contains(&target),
                    "src/{file} imports {target}: {line}"
                );
            }
        }
    }
}

#[test]
fn each_library_is_used_where_its_job_is() {
    for (file, text) in sources() {
        for (library, files) in LIBRARIES {
            let is_own_module = text.contains(&format!("mod {library};"));
            if is_own_module || files.iter().any(|allowed| file.starts_with(allowed)) {
                continue;
            }
            for line in code(&text) {
                let uses = line.contains(&format!(" {library}::"))
                    || line.contains(&format!("({library}::"))
                    || line.starts_with(&format!("use {library}"));
                assert!(!uses, "src/{file} uses {library}: {line}");
            }
        }
    }
}

#[test]
fn no_source_file_is_longer_than_500_lines() {
    for (file, text) in sources() {
        let lines = text.lines().count();
        assert!(lines <= 500, "src/{file} has {lines} lines");
    }
}
