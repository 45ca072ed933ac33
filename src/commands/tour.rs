//! Something done to one unit after the other: what that comes to, and how it ends early.

use super::careful::Consent;
use super::fates::Outcome;
use super::report::{self, Report};
use super::signals::Stop;
use super::{CommandError, ExitCode};
use crate::client::Client;
use crate::codec::Unit;

/// Units that something is done to, one after the other.
pub(super) struct Tour<'a> {
    units: &'a [Unit],
    consent: &'a Consent,
    /// Listens from the first unit on that anything is sent to: before, a signal ends the program where
    /// it is.
    stop: Option<Stop>,
    outcome: Outcome,
    /// Nothing can be done to the rest either.
    is_over: bool,
}

impl<'a> Tour<'a> {
    /// A tour of these units, each of which needs this consent.
    pub(super) fn new(units: &'a [Unit], consent: &'a Consent) -> Self {
        Self {
            units,
            consent,
            stop: None,
            outcome: Outcome::default(),
            is_over: false,
        }
    }

    /// Does it to each of them, until the port is lost, a signal comes or it cannot be done at all, and
    /// returns what that comes to.
    pub(super) fn all(
        mut self,
        client: &mut Client,
        report: &mut Report,
        mut one: impl FnMut(Unit, &mut Self, &mut Client, &mut Report) -> Result<(), CommandError>,
    ) -> ExitCode {
        for (index, unit) in self.units.iter().copied().enumerate() {
            let result = one(unit, &mut self, client, report);
            let is_over = self.is_over || result.is_err() || client.is_lost() || self.is_stopped();
            if let Err(error) = result {
                // What became of the units before counts as well.
                self.outcome.add(report.error(&error));
            }
            if is_over {
                report::untried_units(self.units.len() - index - 1);
                break;
            }
        }
        let stopped = self.stop.as_ref().and_then(Stop::requested);
        self.outcome.code(stopped)
    }

    /// Nothing can be done to the units behind this one: the line is of no use.
    pub(super) const fn end(&mut self) {
        self.is_over = true;
    }

    /// What became of a unit counts.
    pub(super) fn add(&mut self, code: ExitCode) {
        self.outcome.add(code);
    }

    /// Whether a signal has come.
    pub(super) fn is_stopped(&self) -> bool {
        let stop = self.stop.as_ref();
        stop.is_some_and(|stop| stop.requested().is_some())
    }

    /// Asks for consent where that is needed. From here on no signal ends the program before it has
    /// said what became of what was sent.
    ///
    /// # Errors
    /// [`CommandError::Declined`].
    pub(super) fn begin(&mut self, place: &str, client: &mut Client) -> Result<(), CommandError> {
        self.consent.obtain(place, self.stop.as_ref())?;
        let stop = self.stop.get_or_insert_with(Stop::listen_while_writing);
        client.stop_when(stop.flag());
        Ok(())
    }
}
