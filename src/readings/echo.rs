//! Whether the line sends our own bytes back, found out before the first try.
//!
//! The answer to function 08 repeats the request, so on a line that echoes, with no meter behind it,
//! every word seems to come back. A read tells: no answer to it looks like its echo, so whatever the
//! unit answers, a refusal as well, comes beside an echo or alone.

use crate::client::{Client, Failure, Patience};
use crate::codec::{ReadFunction, RegisterRange, Request, Unit};
use crate::profile::Profile;

/// So many reads are tried when noise or damage may hide an echo.
const READS: u32 = 3;

/// Whether a line echoes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LineEcho {
    /// It does: a word has come back when it came twice.
    Present,
    /// It does not: what comes back comes from the meter.
    Absent,
    /// Noise or damage hid it.
    Unknown,
}

/// The read that tells: of the point that identifies the meter, else of the first that can be read,
/// and of register 0 where nothing is known of the meter.
///
/// # Panics
/// Never: the constants are a range.
pub fn probe(profile: Option<&Profile>) -> Request {
    let known = profile.and_then(|profile| {
        let identification = profile.identification.as_ref();
        let point = identification.and_then(|known| profile.point(&known.point));
        let mut readable = profile
            .points
            .iter()
            .filter(|point| point.access.readable());
        let point = point.or_else(|| readable.next())?;
        let function = point
            .function
            .unwrap_or_else(|| profile.limits.read_function());
        Some((function, point.range))
    });
    let (function, range) = known.unwrap_or_else(|| {
        #[expect(clippy::expect_used, reason = "one register, the first there is")]
        let first = RegisterRange::new(0, 1).expect("a range");
        (ReadFunction::HoldingRegisters, first)
    });
    Request::Read { function, range }
}

/// Asks a unit `probe` until it is known whether the line echoes, three times at most. Whether the
/// unit answers is not what this is about: silence without an echo tells as well.
///
/// # Errors
/// [`Failure::Port`] when the port is gone.
pub fn find_out(
    client: &mut Client,
    unit: Unit,
    probe: &Request,
    patience: Patience,
) -> Result<LineEcho, Failure> {
    let patience = Patience {
        retries: 0,
        ..patience
    };
    for _ in 0..READS {
        let result = client.request(unit, probe, patience);
        match client.echoes() {
            Some(true) => return Ok(LineEcho::Present),
            Some(false) => return Ok(LineEcho::Absent),
            None => {}
        }
        // Damage and noise may hide an echo; that the port is lost is not for another read.
        if let Err(lost @ Failure::Port(_)) = result {
            return Err(lost);
        }
    }
    Ok(LineEcho::Unknown)
}
