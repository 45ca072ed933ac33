//! The kinds of faults: the one table of their names, values, keys and weights.

use std::fmt;

/// A kind of fault, by the name it has in a rule. What each does is in the table of
/// [`super`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum FaultKind {
    /// The answer begins after the time-out.
    Late,
    /// The answer begins later than it could.
    Delay,
    /// No answer.
    Silence,
    /// The answer breaks off.
    Cut,
    /// The answer comes in two pieces.
    Split,
    /// The answer comes byte by byte.
    Drip,
    /// The answer is never over.
    Endless,
    /// Noise before the answer.
    Before,
    /// Noise after the answer.
    After,
    /// The request comes back before the answer.
    Echo,
    /// The request comes back in place of the answer.
    EchoOnly,
    /// The answer comes twice.
    Twice,
    /// Both bytes of the CRC are wrong.
    Crc,
    /// The bytes of the CRC are in the wrong order.
    CrcSwapped,
    /// One bit is wrong.
    Flip,
    /// Bits in a row are wrong.
    Burst,
    /// The answer bears another unit.
    WrongUnit,
    /// Another unit answers before the right one.
    Stranger,
    /// Another unit answers again and again in place of the right one.
    StrangerOnly,
    /// The answer bears another function.
    WrongFunction,
    /// The answer has more or fewer bytes of data than were asked for.
    WrongCount,
    /// The answer is longer than a frame can be.
    Oversize,
    /// An exception in place of the answer.
    Exception,
    /// An exception of another function in place of the answer.
    ExceptionFor,
    /// Random bytes without end in place of the answer.
    Garbage,
    /// The port is lost.
    HangUp,
    /// One of the others, at random.
    Any,
}

/// What there is to know of a kind before its rule is read.
struct Row {
    kind: FaultKind,
    name: &'static str,
    keys: &'static [&'static str],
    /// How often `any` picks it, as against the others; 0: only when it is asked for.
    weight: u32,
}

const fn row(
    kind: FaultKind,
    name: &'static str,
    keys: &'static [&'static str],
    weight: u32,
) -> Row {
    Row {
        kind,
        name,
        keys,
        weight,
    }
}

/// In the order of the documentation. What happens often on real lines weighs most; late answers
/// have a share of their own, see [`super::rule`].
const TABLE: [Row; 27] = [
    row(FaultKind::Late, "late", &["timeout"], 0),
    row(FaultKind::Delay, "delay", &[], 2),
    row(FaultKind::Silence, "silence", &[], 10),
    row(FaultKind::Cut, "cut", &["rest", "timeout"], 8),
    row(FaultKind::Split, "split", &["gap"], 6),
    row(FaultKind::Drip, "drip", &[], 2),
    row(FaultKind::Endless, "endless", &["every", "lasts"], 1),
    row(FaultKind::Before, "before", &["gap"], 6),
    row(FaultKind::After, "after", &["gap"], 6),
    row(FaultKind::Echo, "echo", &["gap"], 4),
    row(FaultKind::EchoOnly, "echo-only", &[], 2),
    row(FaultKind::Twice, "twice", &["gap"], 4),
    row(FaultKind::Crc, "crc", &[], 4),
    row(FaultKind::CrcSwapped, "crc-swapped", &[], 2),
    row(FaultKind::Flip, "flip", &[], 8),
    row(FaultKind::Burst, "burst", &[], 8),
    row(FaultKind::WrongUnit, "wrong-unit", &[], 4),
    row(FaultKind::Stranger, "stranger", &["gap"], 4),
    row(
        FaultKind::StrangerOnly,
        "stranger-only",
        &["every", "lasts"],
        1,
    ),
    row(FaultKind::WrongFunction, "wrong-function", &[], 4),
    row(FaultKind::WrongCount, "wrong-count", &[], 4),
    row(FaultKind::Oversize, "oversize", &[], 2),
    row(FaultKind::Exception, "exception", &[], 4),
    row(FaultKind::ExceptionFor, "exception-for", &[], 2),
    row(FaultKind::Garbage, "garbage", &["every", "lasts"], 1),
    row(FaultKind::HangUp, "hang-up", &[], 0),
    row(FaultKind::Any, "any", &["with", "without", "timeout"], 0),
];

/// Keys that any rule can have: when it applies, and where its chance begins.
const COMMON_KEYS: [&str; 5] = ["rate", "on", "for", "function", "seed"];

impl FaultKind {
    /// All kinds, in the order of the documentation.
    pub fn all() -> impl Iterator<Item = Self> {
        TABLE.iter().map(|row| row.kind)
    }

    /// The kind that a rule names so.
    pub fn named(name: &str) -> Option<Self> {
        TABLE
            .iter()
            .find(|row| row.name == name)
            .map(|row| row.kind)
    }

    /// The name in a rule, `wrong-unit`.
    pub fn name(self) -> &'static str {
        self.row().map_or("", |row| row.name)
    }

    /// The keys that a rule of this kind can have: its own, and those that any rule has.
    pub fn keys(self) -> impl Iterator<Item = &'static str> {
        let own = self.row().map_or(&[][..], |row| row.keys);
        own.iter().copied().chain(COMMON_KEYS)
    }

    /// How often `any` picks it, as against the others but `late`; 0: only when it is asked for.
    pub(super) fn weight(self) -> u32 {
        self.row().map_or(0, |row| row.weight)
    }

    /// Always there: a test goes through all kinds.
    fn row(self) -> Option<&'static Row> {
        TABLE.iter().find(|row| row.kind == self)
    }
}

impl fmt::Display for FaultKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
