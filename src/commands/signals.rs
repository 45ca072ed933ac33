//! SIGINT, SIGTERM and SIGHUP: the row in hand is finished first. After one of them, SIGINT or
//! SIGTERM ends the program at once, unless something is being written: then it is said first what
//! became of that, which takes half a second at the most. While a question waits for its answer,
//! nothing is being written.
//!
//! A second SIGHUP does not: for a window that is closed one comes from the system and one from the
//! shell, with no time between them.
//!
//! SIGXFSZ ends nothing: what cannot be written is told as such.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

#[cfg(unix)]
use signal_hook::consts::{SIGHUP, SIGXFSZ};
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use super::ExitCode;

/// Raised when the program is to stop.
pub(super) struct Stop {
    /// The exit code of the signal that came last; 0 while none has come.
    code: Arc<AtomicUsize>,
    /// Whether one has come.
    raised: Arc<AtomicBool>,
    /// Up while somebody is asked a question, when there is nothing that a signal has to wait for.
    asking: Arc<AtomicBool>,
}

/// What a second signal does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Second {
    /// It ends the program.
    Ends,
    /// Nothing.
    Waits,
}

/// What SIGHUP does, where there is one.
#[cfg_attr(not(unix), allow(dead_code, reason = "there is none"))]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum HangUp {
    /// It ends the program, after the row in hand.
    Ends,
    /// Nothing.
    Passes,
}

impl Stop {
    /// Listens from now on. A signal that cannot be listened to ends the program as ever.
    pub(super) fn listen() -> Self {
        Self::listening(Second::Ends, HangUp::Ends)
    }

    /// The same for what goes on for years: where it has no terminal, SIGHUP does not end it. That is
    /// what programs that rename its files send; the next rows go into new ones anyway.
    pub(super) fn listen_in_background() -> Self {
        #[cfg(unix)]
        if !has_terminal() {
            // Nobody looks at this flag: it keeps the signal from ending the program.
            let _ = flag::register(SIGHUP, Arc::default());
            return Self::listening(Second::Ends, HangUp::Passes);
        }
        Self::listening(Second::Ends, HangUp::Ends)
    }

    /// The same for writes: no signal ends the program before it has said what became of them.
    pub(super) fn listen_while_writing() -> Self {
        Self::listening(Second::Waits, HangUp::Ends)
    }

    fn listening(second: Second, hang_up: HangUp) -> Self {
        let code = Arc::default();
        let raised: Arc<AtomicBool> = Arc::default();
        let asking: Arc<AtomicBool> = Arc::default();
        let note = |signal, exit: ExitCode| {
            let _ = flag::register_usize(signal, Arc::clone(&code), usize::from(exit as u8));
            let _ = flag::register(signal, Arc::clone(&raised));
        };
        for (signal, exit) in [
            (SIGINT, ExitCode::Interrupted),
            (SIGTERM, ExitCode::Terminated),
        ] {
            // Before the others: the first signal finds the flag down.
            let ends = match second {
                Second::Ends => &raised,
                Second::Waits => &asking,
            };
            if flag::register_conditional_default(signal, Arc::clone(ends)).is_ok() {
                note(signal, exit);
            }
        }
        #[cfg(not(unix))]
        let _ = hang_up;
        #[cfg(unix)]
        {
            if hang_up == HangUp::Ends && !ignores_hang_ups() {
                note(SIGHUP, ExitCode::HungUp);
            }
            // Or else a file that has come to its limit (`ulimit -f`) ends the program without a
            // word; so writing to it fails.
            let _ = flag::register(SIGXFSZ, Arc::default());
        }
        Self {
            code,
            raised,
            asking,
        }
    }

    /// Asks somebody; meanwhile SIGINT and SIGTERM end the program at once.
    pub(super) fn while_asking<T>(&self, ask: impl FnOnce() -> T) -> T {
        self.asking.store(true, Ordering::Relaxed);
        let answer = ask();
        self.asking.store(false, Ordering::Relaxed);
        answer
    }

    /// A flag that is up once a signal has come.
    pub(super) fn flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.raised)
    }

    /// What to end with, once a signal has come.
    pub(super) fn requested(&self) -> Option<ExitCode> {
        let code = self.code.load(Ordering::Relaxed);
        [
            ExitCode::HungUp,
            ExitCode::Interrupted,
            ExitCode::Terminated,
        ]
        .into_iter()
        .find(|exit| usize::from(*exit as u8) == code)
    }
}

/// Whether any of the standard streams is a terminal.
#[cfg(unix)]
fn has_terminal() -> bool {
    use std::io::{self, IsTerminal};

    io::stdin().is_terminal() || io::stdout().is_terminal() || io::stderr().is_terminal()
}

/// Whether somebody wants the program to outlive its terminal, as `nohup` does, where the system
/// tells.
#[cfg(unix)]
fn ignores_hang_ups() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    // The lowest bit is signal 1, which this is.
    mask.is_some_and(|mask| mask & 1 == 1)
}

/// Ends the process as the signal would have, so that a shell sees it; returns where that cannot
/// be done.
pub(super) fn die(code: ExitCode) {
    let signal = match code {
        #[cfg(unix)]
        ExitCode::HungUp => SIGHUP,
        ExitCode::Interrupted => SIGINT,
        ExitCode::Terminated => SIGTERM,
        _ => return,
    };
    // Where it fails, the exit code still tells.
    let _ = signal_hook::low_level::emulate_default_handler(signal);
}
