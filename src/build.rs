//! Packs the built-in meters: loads each TOML file with the program's own strict loader and writes
//! the result in a compact form for `profile::builtin` to include.

#![allow(
    dead_code,
    unused_imports,
    reason = "only the loader's share of these modules is used here"
)]
#![allow(unreachable_pub, reason = "public for the library, private here")]

use std::error::Error;
use std::fmt::Write as _;
use std::path::Path;
use std::{env, fs};

mod codec;

mod profile {
    pub mod error;
    pub mod format;
    pub mod identity;
    pub mod load;
    pub mod model;
    pub mod packed;
    pub mod point;
    pub mod scaling;
    pub mod setup;
    pub mod value;
    pub mod writing;
}

mod transport {
    pub mod settings;
    pub use settings::{LineSettings, Parity, StopBits};
}

const METERS: &str = "src/profile/meters";

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed=src/build.rs");
    println!("cargo::rerun-if-changed=src/codec");
    println!("cargo::rerun-if-changed=src/profile");
    println!("cargo::rerun-if-changed=src/transport/settings.rs");
    let out = env::var("OUT_DIR")?;
    let mut files: Vec<_> = fs::read_dir(METERS)?.collect::<Result<_, _>>()?;
    files.sort_by_key(fs::DirEntry::file_name);
    let mut list = String::from("const BUILTIN: &[Builtin] = &[\n");
    for file in files {
        let path = file.path();
        let profile = profile::load::load(&path.display().to_string(), &fs::read_to_string(&path)?)
            .map_err(|error| error.to_string())?;
        let name = profile.name.clone();
        if path.file_stem().and_then(|stem| stem.to_str()) != Some(&name) {
            return Err(format!("{}: the meter's name is {name}", path.display()).into());
        }
        let packed = format!("{name}.meter");
        fs::write(
            Path::new(&out).join(&packed),
            postcard::to_stdvec(&profile::packed::Packed::pack(profile))?,
        )?;
        writeln!(
            list,
            "Builtin {{ \
             name: {name:?}, \
             text: include_str!(concat!(env!(\"CARGO_MANIFEST_DIR\"), \"/{METERS}/{name}.toml\")), \
             packed: include_bytes!({packed:?}) \
             }},"
        )?;
    }
    list.push_str("];\n");
    fs::write(Path::new(&out).join("builtin.rs"), list)?;
    Ok(())
}
