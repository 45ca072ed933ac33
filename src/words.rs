//! Words that every layer needs.

use std::fmt::Display;

/// So many of something: `1 try`, `2 tries`, `0 tries`.
pub fn counted<N: Copy + Display + PartialEq + From<u8>>(
    count: N,
    one: &str,
    many: &str,
) -> String {
    let name = if count == N::from(1) { one } else { many };
    format!("{count} {name}")
}
