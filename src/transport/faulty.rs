//! A line that lies: faults on purpose, over any transport.
//!
//! A [`Faulty`] wraps a transport, and the answers that come through it are spoiled as its
//! [`FaultScript`] says. The same script, seed and requests give the same faults, byte for byte.
//!
//! # Rules
//!
//! A rule is `KIND[=VALUE][,KEY=VALUE]...`, such as `cut=5,rate=0.1,for=17`. For each request the
//! rules are tried in their order, and the first that applies decides. A request that no rule
//! applies to is answered truly; late answers to earlier ones come all the same.
//!
//! | kind | value; without | keys | what happens |
//! |---|---|---|---|
//! | `late` | time-outs; 1.1 to 1.9 | `timeout` | the answer begins that many time-outs after the end of the request |
//! | `delay` | time; 40ms | | the answer begins that long after the end of the request |
//! | `silence` | | | no answer |
//! | `cut` | bytes; any | `rest` `timeout` | only so many bytes of the answer; the others `rest` time-outs after the end of the request, without it never |
//! | `split` | bytes; any | `gap` | so many bytes of the answer, and the others 16ms later, or `gap` |
//! | `drip` | time; 20ms | | the answer byte by byte, that far apart |
//! | `endless` | | `every` `lasts` | the answer without its CRC over and over, a byte each 20ms, or `every` |
//! | `before` | hex; 1 to 32 random bytes | `gap` | noise, and then the answer |
//! | `after` | hex; 1 to 32 random bytes | `gap` | the answer, and then noise |
//! | `echo` | bytes; all | `gap` | so many bytes of the request, and then the answer |
//! | `echo-only` | | | the request comes back, and no answer |
//! | `twice` | | `gap` | the answer, and then the same again |
//! | `crc` | | | all bits of the CRC are wrong |
//! | `crc-swapped` | | | the two bytes of the CRC are swapped; all their bits wrong where they are equal |
//! | `flip` | bit, 0 to 2047; any | | one bit is wrong; 0 is the lowest one of the first byte |
//! | `burst` | bits, 1 to 2048; 1 to 16 | | so many bits in a row, at any place: the first and the last one are wrong, those between by chance |
//! | `wrong-unit` | unit; any other | | the answer bears this unit, and a right CRC |
//! | `stranger` | unit; any other | `gap` | another unit answers something else, and then the right one answers |
//! | `stranger-only` | unit; any other | `every` `lasts` | another unit answers something else each 200ms, or `every`, and no answer |
//! | `wrong-function` | function; 4 for 3, else 3 | | the answer bears this function, and a right CRC |
//! | `wrong-count` | `+1` `-1` `odd` `0` `255`; any | | the answer has a register more, one fewer, a byte more, no data, 255 bytes, and a right count and CRC |
//! | `oversize` | | | the answer has 257 bytes, and a right CRC |
//! | `exception` | code; any with a name | | an exception in place of the answer |
//! | `exception-for` | function; any other | | exception 02 of this function in place of the answer |
//! | `garbage` | | `every` `lasts` | a random byte each 1ms, or `every`, and no answer |
//! | `hang-up` | `before` `during` `after`; `during` | | the port is lost as the request is sent, after part of the answer, after the answer |
//! | `any` | | `with` `without` `timeout` | one of the others as it is without values |
//!
//! Keys that any rule can have say when it applies; all of them must hold:
//!
//! | key | value | without |
//! |---|---|---|
//! | `on` | numbers of requests, from 1: `3`, `3-5`, `3-`, `1/4` (one in 4, from the 1st) | all |
//! | `for` | unit that is asked | all |
//! | `function` | function that is asked for | all |
//! | `rate` | probability | 1 |
//! | `seed` | where its chance begins | that of the script |
//!
//! and those of single kinds:
//!
//! | key | value | without |
//! |---|---|---|
//! | `timeout` | what time-outs are | 1s |
//! | `rest` | when the rest of a cut comes, in time-outs | never |
//! | `gap` | from the first piece to the second; of `echo` and `stranger`, from the end of the request to the answer | 16ms for `split`, else at once |
//! | `every` | from one byte, or frame, to the next; 100us or more, as for `drip` | as above |
//! | `lasts` | how long that goes on | until the next request |
//! | `with`, `without` | kinds that `any` picks as well, or does not pick: `hang-up+garbage` | all but `hang-up` |
//!
//! Times have their unit, `40ms`. Numbers can be hex, `0x11`.
//!
//! One in ten that `any` picks is `late`, unless that is left out. What has no end lasts two
//! time-outs then: a client that waits for silence before it asks again would never ask again.
//!
//! What can only be told with the answer at hand is no error, and there is always a fault: a cut
//! or split beyond the answer comes before its last byte, a bit beyond it is taken modulo its bits,
//! a longer burst is as long as the answer, and where the meter itself has the unit or function
//! given, it is the one after it. An answer that does not count its data gets a byte more or a
//! byte less of `wrong-count`.
//!
//! # Time and chance
//!
//! Times count from the end of the request on the wire. An answer is gathered until it is whole, and
//! nothing comes sooner than the meter behind has answered, but for `echo`, `stranger` and those
//! that come with no answer at all: these need no meter. What has no end is made when it is due.
//!
//! Each rule has its own chance for each request, from its seed, its text and the number of the
//! request: a rule that is added changes what others do only where it decides in their place.
//!
//! After a hang-up the error is given once, and what was on its way is gone; then the transport
//! works as before.

mod carrier;
mod counts;
mod effect;
mod error;
mod kind;
mod plan;
mod rule;
mod schedule;
mod script;
mod spoil;
mod stream;
mod values;
mod when;

pub use carrier::Faulty;
pub use counts::{FaultCounts, FaultTally};
pub use error::{FaultScriptError, RulePlace, RuleProblem};
pub use kind::FaultKind;
pub use rule::FaultRule;
pub use script::FaultScript;
