//! A loop-back test under way.

use std::time::Duration;

use super::{Test, advice};
use crate::cli::LoopbackFormat;
use crate::client::{Client, Echo, Failure};
use crate::codec::Unit;
use crate::commands::report::{self, Report};
use crate::commands::signals::Stop;
use crate::commands::{CommandError, ExitCode};
use crate::output::loopback::{LoopbackSink, Subject, lines};
use crate::readings::Fault;
use crate::readings::echo;
use crate::readings::loopback::{LineEcho, Noticed, Tally, attempt};
use crate::transport::{Clock, SystemClock};

/// A wait is cut into pieces of this length, so that a signal ends it.
const PIECE: Duration = Duration::from_millis(50);

/// A test under way.
pub(super) struct Run<'a> {
    test: &'a Test<'a>,
    stop: &'a Stop,
    clock: SystemClock,
    /// What was said of echoes.
    said: Echo,
    /// Whether the line echoes, as far as that is known.
    echo: LineEcho,
    answered: usize,
    /// What went wrong, each kind once.
    faults: Vec<Fault>,
}

impl<'a> Run<'a> {
    /// A test that has not begun.
    pub(super) fn new(test: &'a Test<'a>, said: Echo, stop: &'a Stop) -> Self {
        Self {
            test,
            stop,
            clock: SystemClock::new(),
            said,
            echo: LineEcho::Unknown,
            answered: 0,
            faults: Vec::new(),
        }
    }

    /// Tests the line to every unit, until the port is lost or a signal comes.
    pub(super) fn all(
        &mut self,
        units: &[Unit],
        client: &mut Client,
        sink: &mut dyn LoopbackSink,
        report: &mut Report,
    ) -> Result<(), CommandError> {
        for (index, unit) in units.iter().copied().enumerate() {
            self.unit(unit, client, sink, report)?;
            let rest = units.len() - index - 1;
            if self.is_lost() && rest > 0 {
                report::untried_units(rest);
            }
            if self.is_lost() || self.stop.requested().is_some() {
                break;
            }
        }
        sink.finish().map_err(CommandError::Output)
    }

    /// What all units come to.
    pub(super) fn code(&self) -> ExitCode {
        if self.is_lost() {
            return ExitCode::Port;
        }
        ExitCode::of(self.answered, &self.faults)
    }

    /// Tests the line to one unit.
    fn unit(
        &mut self,
        unit: Unit,
        client: &mut Client,
        sink: &mut dyn LoopbackSink,
        report: &mut Report,
    ) -> Result<(), CommandError> {
        let meter = self.test.meter;
        let subject = Subject { meter, unit };
        sink.begin(subject, client.utc_now())
            .map_err(CommandError::Output)?;
        let mut last = self.listen_for_echo(unit, client).err();
        let mut tally = Tally::default();
        while !self.is_lost() && self.stop.requested().is_none() && self.has_more(&tally) {
            let start = self.clock.now();
            let number = tally.tries() + 1;
            let before = client.counters(unit);
            let attempt = attempt(client, unit, number, self.test.data, self.test.patience);
            let beside = Noticed::between(&before, &client.counters(unit));
            sink.attempt(subject, &attempt)
                .map_err(CommandError::Output)?;
            tally.add(&attempt.result, beside);
            match attempt.result {
                Ok(_) => self.answered += 1,
                Err(failure) => {
                    self.note(&failure);
                    last = Some(failure);
                }
            }
            if self.has_more(&tally) && !self.is_lost() {
                self.wait_until(start + self.test.interval);
            }
        }
        let summary = tally.summary(self.echo);
        sink.end(&summary).map_err(CommandError::Output)?;
        if self.test.format == LoopbackFormat::Csv {
            for line in lines(&summary) {
                report.remark(&line);
            }
        }
        match last {
            Some(failure @ Failure::Port(_)) => {
                report.failure(&format!("unit {unit} on {}", self.test.line), &failure);
            }
            // Only where an echo is waited for can a meter's answer be taken for one.
            _ if self.echo == LineEcho::Absent && summary.failed.only_echo > 0 => {
                report.advise("the line does not echo: leave --echo on out");
            }
            last => {
                if let Some(advice) = advice::advice(&summary, meter, last.as_ref()) {
                    report.advise(advice);
                }
            }
        }
        Ok(())
    }

    fn has_more(&self, tally: &Tally) -> bool {
        self.test.count.is_none_or(|count| tally.tries() < count)
    }

    /// Finds out whether the line echoes, unless that is known.
    fn listen_for_echo(&mut self, unit: Unit, client: &mut Client) -> Result<(), Failure> {
        if self.echo != LineEcho::Unknown {
            return Ok(());
        }
        let Test {
            probe, patience, ..
        } = self.test;
        let found = echo::find_out(client, unit, probe, *patience);
        self.echo = match found.inspect_err(|failure| self.note(failure))? {
            // Who says so may know better than what noise shows.
            LineEcho::Unknown => match self.said {
                Echo::On => LineEcho::Present,
                Echo::Off => LineEcho::Absent,
                Echo::Auto => LineEcho::Unknown,
            },
            found => found,
        };
        Ok(())
    }

    fn note(&mut self, failure: &Failure) {
        let fault = Fault::from(failure);
        if !self.faults.contains(&fault) {
            self.faults.push(fault);
        }
    }

    fn is_lost(&self) -> bool {
        self.faults.contains(&Fault::Port)
    }

    /// Lets time pass until then, or until a signal comes.
    fn wait_until(&self, then: Duration) {
        while self.stop.requested().is_none() {
            match then.saturating_sub(self.clock.now()) {
                Duration::ZERO => return,
                left => self.clock.sleep(left.min(PIECE)),
            }
        }
    }
}
