//! The meters inside the program.
//!
//! Their TOML files lie in `src/profile/meters`. The build script loads each with
//! [`super::load`], so one that does not load stops the build, and packs the result: unpacking it
//! costs a run a small part of what parsing would.

use super::model::Profile;
use super::packed::Packed;

/// A meter inside the program.
#[derive(Debug, Clone, Copy)]
pub struct Builtin {
    /// Its name, as typed after `--meter`.
    pub name: &'static str,
    packed: &'static [u8],
}

include!(concat!(env!("OUT_DIR"), "/builtin.rs"));

/// All of them, by name.
pub const fn all() -> &'static [Builtin] {
    BUILTIN
}

/// The one of this name.
pub fn find(name: &str) -> Option<Builtin> {
    BUILTIN.iter().copied().find(|meter| meter.name == name)
}

impl Builtin {
    /// Unpacks it.
    ///
    /// # Panics
    /// Never: the bytes were packed from this very type by the build script, and a test unpacks
    /// every one.
    pub fn profile(self) -> Profile {
        #[expect(
            clippy::expect_used,
            reason = "packed from this type by the build script"
        )]
        let packed: Packed = postcard::from_bytes(self.packed).expect("a built-in meter unpacks");
        packed.unpack()
    }
}
