//! Rows on stdout, from a thread of its own: a reader that stands still holds up nothing else.

use std::io::{self, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, SyncSender, TrySendError};
use std::thread;
use std::time::Duration;

use crate::commands::report::{self, Report};
use crate::commands::{CommandError, ExitCode};
use crate::transport::Clock;
use crate::words::counted;

/// At least so many rows may wait to be printed.
const MOST_WAITING: usize = 1024;

/// A reader that stands still is not waited for any longer once the run is over.
const LAST_WAIT: Duration = Duration::from_secs(1);

/// So often it is looked whether a signal has come.
const TICK: Duration = Duration::from_millis(50);

/// Prints rows.
pub(super) struct Printer {
    /// `None` when nothing takes rows any more.
    rows: Option<SyncSender<Vec<u8>>>,
    /// What became of all of it, once the thread has ended.
    outcome: Receiver<io::Result<()>>,
    /// How many rows were printed, and given to be.
    printed: Arc<AtomicUsize>,
    given: usize,
    /// How many were given up since the reader stands still.
    lost: usize,
    is_told: bool,
}

impl Printer {
    /// One that has room for the rows of a single run.
    pub(super) fn start(rows: usize) -> Self {
        let (sender, receiver) = mpsc::sync_channel(rows.max(MOST_WAITING));
        let (end, outcome) = mpsc::channel();
        let printed = Arc::<AtomicUsize>::default();
        let count = Arc::clone(&printed);
        // Not waited for where it hangs: the end of the program ends it as well.
        thread::spawn(move || drop(end.send(print(&receiver, &count))));
        Self {
            rows: Some(sender),
            outcome,
            printed,
            given: 0,
            lost: 0,
            is_told: false,
        }
    }

    /// Takes the bytes of a row; returns whether there was room.
    pub(super) fn row(&mut self, bytes: Vec<u8>) -> bool {
        match self.rows.as_ref().map(|rows| rows.try_send(bytes)) {
            Some(Ok(())) => {
                self.given += 1;
                true
            }
            Some(Err(TrySendError::Full(_))) => {
                self.lost += 1;
                false
            }
            // Why is in `outcome`.
            Some(Err(TrySendError::Disconnected(_))) | None => false,
        }
    }

    fn waiting(&self) -> usize {
        self.given - self.printed.load(Ordering::Relaxed).min(self.given)
    }

    /// Tells that the reader stands still, and that it does not any more.
    ///
    /// # Errors
    /// Once, when stdout takes nothing any more.
    pub(super) fn look(&mut self) -> Result<(), CommandError> {
        if self.rows.is_some()
            && let Ok(Err(error)) = self.outcome.try_recv()
        {
            self.rows = None;
            return Err(CommandError::Output(error));
        }
        if self.lost > 0 && !self.is_told {
            report::warning("stdout: nobody reads it, so rows are lost");
            self.is_told = true;
        } else if self.lost > 0 && self.waiting() == 0 {
            let lost = lost(self.lost);
            report::warning(&format!("stdout: read again; {lost}"));
            (self.lost, self.is_told) = (0, false);
        }
        Ok(())
    }

    /// Waits until all is printed; where the reader stands still, not for long after `end`, which a
    /// run without a deadline has not, or after a signal. Returns what to end with where something is
    /// not printed.
    pub(super) fn finish(
        &mut self,
        end: Option<Duration>,
        is_stopped: &dyn Fn() -> bool,
        clock: &dyn Clock,
        report: &mut Report,
    ) -> Option<ExitCode> {
        // Without it the thread ends when it has printed all.
        self.rows.take()?;
        let mut end = end.map(|end| end.max(clock.now()).saturating_add(LAST_WAIT));
        let mut is_told = false;
        let outcome = loop {
            match self.outcome.recv_timeout(TICK) {
                Ok(outcome) => break outcome,
                Err(RecvTimeoutError::Disconnected) => break Ok(()),
                Err(RecvTimeoutError::Timeout) => {}
            }
            let now = clock.now();
            if !is_told && is_stopped() {
                let soon = now.saturating_add(LAST_WAIT);
                end = Some(end.map_or(soon, |end| end.min(soon)));
                is_told = true;
            }
            if end.is_some_and(|end| now >= end) {
                self.lost += self.waiting();
                break Ok(());
            }
        };
        let code = outcome
            .err()
            .map(|error| report.error(&CommandError::Output(error)));
        if self.lost == 0 {
            return code;
        }
        report::problem("stdout", &format!("nobody reads it; {}", lost(self.lost)));
        Some(ExitCode::Output)
    }
}

/// `3 rows are lost`.
pub(super) fn lost(rows: usize) -> String {
    counted(rows as u64, "row is lost", "rows are lost")
}

fn print(rows: &Receiver<Vec<u8>>, count: &AtomicUsize) -> io::Result<()> {
    for row in rows {
        let mut out = io::stdout().lock();
        out.write_all(&row)?;
        out.flush()?;
        count.fetch_add(1, Ordering::Relaxed);
    }
    Ok(())
}
