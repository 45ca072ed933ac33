//! SIGINT and SIGTERM: the row in hand is finished first. The second one ends the program at once.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use super::ExitCode;

/// Raised when the program is to stop.
pub(super) struct Stop {
    /// Any of the two has come.
    raised: Arc<AtomicBool>,
    /// It was SIGTERM.
    terminated: Arc<AtomicBool>,
}

impl Stop {
    /// Listens from now on. A signal that cannot be listened to ends the program as ever.
    pub(super) fn listen() -> Self {
        let stop = Self {
            raised: Arc::default(),
            terminated: Arc::default(),
        };
        for signal in [SIGINT, SIGTERM] {
            // In this order: the first signal finds the flag down and raises it.
            let _ = flag::register_conditional_default(signal, Arc::clone(&stop.raised))
                .and_then(|_| flag::register(signal, Arc::clone(&stop.raised)));
        }
        let _ = flag::register(SIGTERM, Arc::clone(&stop.terminated));
        stop
    }

    /// What to end with, once a signal has come.
    pub(super) fn requested(&self) -> Option<ExitCode> {
        if !self.raised.load(Ordering::Relaxed) {
            None
        } else if self.terminated.load(Ordering::Relaxed) {
            Some(ExitCode::Terminated)
        } else {
            Some(ExitCode::Interrupted)
        }
    }
}

/// Ends the process as the signal would have, so that a shell sees it; returns where that cannot
/// be done.
pub(super) fn die(code: ExitCode) {
    let signal = match code {
        ExitCode::Interrupted => SIGINT,
        ExitCode::Terminated => SIGTERM,
        _ => return,
    };
    // Where it fails, the exit code still tells.
    let _ = signal_hook::low_level::emulate_default_handler(signal);
}
