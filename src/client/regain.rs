//! Getting a lost port back.
//!
//! The request during which a port is lost fails at once: it is not sent again behind anybody's
//! back. The next one looks for the port first, for as long as it might have waited for its answer.
//! An adapter that was unplugged for a moment is back within a second; rights come a little after
//! the port itself, so "not permitted" is no last word either.

use std::time::Duration;

use log::info;

use super::failure::Failure;
use super::patience::Patience;
use super::transaction::Client;
use crate::transport::TransportError;

/// The pause after the first try; it doubles up to [`LONGEST_PAUSE`].
const FIRST_PAUSE: Duration = Duration::from_millis(50);

/// The longest pause between two tries.
const LONGEST_PAUSE: Duration = Duration::from_millis(200);

impl Client {
    /// Opens the port of a line again if it was lost: at once, and again and again for as long as the
    /// attempts at a request would take.
    ///
    /// # Errors
    /// [`Failure::Port`] when it does not come back, with the reason.
    pub(super) fn regain(&mut self, patience: Patience) -> Result<(), Failure> {
        let Some(loss) = self.line.loss().cloned() else {
            return Ok(());
        };
        let attempts = patience.retries.saturating_add(1);
        let within = patience.timeout.saturating_mul(attempts);
        let give_up = self.line.now().saturating_add(within);
        let mut pause = FIRST_PAUSE;
        info!("port {}: trying to open it again", loss.port);
        loop {
            let Err(error) = self.line.reopen() else {
                let away = self.line.now().saturating_sub(loss.at);
                info!("port {} is back after {} ms", loss.port, away.as_millis());
                // It can be another adapter.
                self.echoes = None;
                return Ok(());
            };
            let left = give_up.saturating_sub(self.line.now());
            if left.is_zero() || self.is_stopping() {
                let source = error.with_holders();
                return Err(Failure::Port(TransportError::NotBack {
                    port: loss.port,
                    within,
                    source,
                }));
            }
            self.line.sleep(pause.min(left));
            pause = (pause * 2).min(LONGEST_PAUSE);
        }
    }
}
