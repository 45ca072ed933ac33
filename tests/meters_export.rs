//! `meters export`: the text of a profile comes out as it is, and loads to the same meter.

mod support {
    pub(crate) mod program;
}

use std::fs;
use std::path::PathBuf;

use meterpoll::profile::builtin;
use meterpoll::profile::load::load;
use support::program::Program;

/// A file of its own in the folder cargo gives tests.
fn file(name: &str, text: impl AsRef<[u8]>) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let folder = path.parent().expect("it is in a folder");
    fs::create_dir_all(folder).expect("the folder for tests is writable");
    fs::write(&path, text).expect("the folder for tests is writable");
    path
}

#[test]
fn every_built_in_meter_comes_out_as_a_file_that_is_the_same_meter() {
    for meter in builtin::all() {
        let exported = Program::new(&format!("meters export {}", meter.name)).output();
        assert_eq!(exported.status.code(), Some(0), "{}", meter.name);
        assert_eq!(exported.stderr, b"", "{}", meter.name);
        assert_eq!(exported.stdout, meter.text.as_bytes(), "{}", meter.name);
        let profile = load("exported.toml", meter.text);
        assert_eq!(profile, Ok(meter.profile()), "{}", meter.name);

        let path = file(&format!("exported/{}.toml", meter.name), exported.stdout);
        let requests = |meter: &str| {
            let arguments = "read-registers -a 1 * --dry-run --meter";
            Program::new(arguments).argument(meter).output()
        };
        let path = path.to_str().expect("a path of text");
        let (own, built_in) = (requests(path), requests(meter.name));
        assert_eq!(own.status.code(), Some(0), "{}", meter.name);
        assert_eq!(own.stdout, built_in.stdout, "{}", meter.name);
    }
}

#[test]
fn a_meter_of_ones_own_comes_out_as_its_file_even_when_it_does_not_load() {
    let text = "# Unfinished\nname = \"pqm\"\n";
    let path = file("own_export/meterpoll/meters/pqm.toml", text);
    Program::new("meters export")
        .argument(&path)
        .stdout(text)
        .run();
    let home = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("own_export");
    Program::new("meters export pqm")
        .variable("XDG_CONFIG_HOME", home)
        .stdout(text)
        .run();
}

#[cfg(unix)]
#[test]
fn a_meter_that_is_not_there_is_not_exported() {
    let known: Vec<&str> = builtin::all().iter().map(|meter| meter.name).collect();
    Program::new("meters export nobody")
        .code(2)
        .stderr(format!(
            "error: there is no meter 'nobody'; known are {}\n\
             hint: `meterpoll meters list` shows them; a profile file is named by its path\n",
            known.join(", ")
        ))
        .run();
    Program::new("meters export /nonexistent/mine.toml")
        .code(2)
        .stderr(
            "error: profile /nonexistent/mine.toml cannot be read\n  \
             because: No such file or directory (os error 2)\n",
        )
        .run();
}
