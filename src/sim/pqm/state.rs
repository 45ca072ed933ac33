//! What a PQM has been told to do: relays, its clock, what was cleared.

use jiff::civil::{Date, DateTime, Time};
use jiff::tz::TimeZone;
use jiff::{SignedDuration, Timestamp};

/// What can be cleared, each for itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Cleared {
    /// Counters of energy, and what it costs.
    Energy,
    /// The highest demands.
    MaximumDemand,
    /// The running demands.
    Demand,
    /// Lowest and highest currents.
    Current,
    /// Lowest and highest voltages.
    Voltage,
    /// Lowest and highest powers and power factors.
    Power,
    /// Lowest and highest frequency.
    Frequency,
    /// Lowest and highest distortions.
    Distortion,
    /// Counters of pulses.
    Pulses,
    /// The event record.
    Events,
}

impl Cleared {
    /// How many there are.
    const COUNT: usize = Self::Events as usize + 1;
}

/// A relay, by its bit in the register of relays (format F104).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Relay {
    Alarm = 1,
    Aux1 = 2,
    Aux2 = 4,
    Aux3 = 8,
}

/// All of that.
#[derive(Debug, Default)]
pub(super) struct State {
    relays: u8,
    /// How far its clock is ahead of the time of day.
    ahead: SignedDuration,
    cleared: [Option<Timestamp>; Cleared::COUNT],
    /// Whether the first of the two steps to factory settings was the last thing it was told.
    pub(super) is_near_factory: bool,
}

impl State {
    /// Relays that are energised.
    pub(super) const fn relays(&self) -> u8 {
        self.relays
    }

    /// Lights that are on (format F102): aux 1 to 3 in the lowest bits, then that of the alarm relay.
    pub(super) const fn lights(&self) -> u8 {
        (self.relays >> 1) | (self.relays & Relay::Alarm as u8) << 6
    }

    /// What function 07 answers (manual page 190): relays from bit 2 on. There is neither an alarm nor
    /// a fault, bits 0 and 1.
    pub(super) const fn status(&self) -> u8 {
        self.relays << 2
    }

    pub(super) const fn energise(&mut self, relay: Relay) {
        self.relays |= relay as u8;
    }

    pub(super) const fn release(&mut self, relay: Relay) {
        self.relays &= !(relay as u8);
    }

    /// What its clock shows at a time of day.
    pub(super) fn by_its_clock(&self, at: Timestamp) -> Timestamp {
        at.saturating_add(self.ahead).unwrap_or(at)
    }

    /// Sets its clock, UTC, and leaves what is not given as it is.
    pub(super) fn set_clock(&mut self, time: Option<Time>, date: Option<Date>, now: Timestamp) {
        let shown = TimeZone::UTC.to_datetime(self.by_its_clock(now));
        let set = DateTime::from_parts(date.unwrap_or(shown.date()), time.unwrap_or(shown.time()));
        // What its registers can hold lies far inside the range of times.
        if let Ok(set) = TimeZone::UTC.to_timestamp(set) {
            self.ahead = set.duration_since(now);
        }
    }

    /// Begins anew.
    pub(super) const fn clear(&mut self, what: Cleared, now: Timestamp) {
        // One for each.
        self.cleared[what as usize] = Some(now);
    }

    /// When it was cleared.
    pub(super) const fn cleared(&self, what: Cleared) -> Option<Timestamp> {
        self.cleared[what as usize]
    }
}
