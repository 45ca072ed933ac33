//! From the options about the line to a client on it.

use std::sync::Arc;
use std::time::Duration;

use log::info;

use super::CommandError;
use crate::cli::{EchoChoice, LineArguments, ParityChoice, StopBitsChoice};
use crate::client::{Client, Echo, Patience, QueryData, Ways};
use crate::codec::FunctionCode;
use crate::profile::{Limits, Profile};
use crate::sim::SimulatedLine;
use crate::transport::serial::Serial;
use crate::transport::traced::Traced;
use crate::transport::{
    Clock, Line, LineSettings, OpenError, Parity, StopBits, SystemClock, Timing, Transport,
};

/// How often a busy port is tried again.
const TRY_AGAIN: Duration = Duration::from_millis(50);

/// Values of the simulated line are the same in every run at the same time.
const SEED: u64 = 17;

/// The port and its setting, as typed and as the meter wants them.
pub(super) struct LinePlan<'a> {
    arguments: &'a LineArguments,
    /// The setting in use.
    pub(super) settings: LineSettings,
}

impl<'a> LinePlan<'a> {
    /// What was typed wins over the meter's factory setting, and that over 9600 8N1.
    pub(super) fn new(arguments: &'a LineArguments, profile: Option<&Profile>) -> Self {
        let factory = profile.map_or_else(LineSettings::default, |profile| profile.line);
        let settings = LineSettings {
            baud: arguments.baud.unwrap_or(factory.baud),
            parity: arguments
                .parity
                .map_or(factory.parity, |parity| match parity {
                    ParityChoice::None => Parity::None,
                    ParityChoice::Even => Parity::Even,
                    ParityChoice::Odd => Parity::Odd,
                }),
            stop_bits: arguments
                .stop_bits
                .map_or(factory.stop_bits, |bits| match bits {
                    StopBitsChoice::One => StopBits::One,
                    StopBitsChoice::Two => StopBits::Two,
                }),
        };
        Self {
            arguments,
            settings,
        }
    }

    /// The line as messages and headings name it: `/dev/ttyUSB0 at 9600 8N1`.
    pub(super) fn name(&self) -> String {
        format!("{} at {}", self.port(), self.settings)
    }

    fn port(&self) -> &str {
        self.arguments.port.as_deref().unwrap_or_default()
    }

    /// How patient to be with a meter of these limits.
    pub(super) fn patience(&self, limits: &Limits) -> Patience {
        Patience {
            timeout: self.arguments.timeout.unwrap_or(limits.longest_answer),
            longest_answer: limits.longest_answer,
            retries: self.arguments.retries,
            pause: self.arguments.pause.unwrap_or(limits.pause),
            ways: Ways {
                interchangeable_reads: limits.interchangeable_reads,
                loopback: limits
                    .functions
                    .contains(&FunctionCode::Diagnostics)
                    .then_some(QueryData::Zero),
            },
        }
    }

    /// Opens the port and returns a client on it.
    pub(super) fn open(&self) -> Result<Client, CommandError> {
        let clock: Arc<dyn Clock> = Arc::new(SystemClock::new());
        let transport = self.transport(&clock)?;
        if !self.arguments.settle.is_zero() {
            clock.sleep(self.arguments.settle);
        }
        let transport: Box<dyn Transport> = if log::log_enabled!(log::Level::Trace) {
            Box::new(Traced::new(transport, Arc::clone(&clock)))
        } else {
            transport
        };
        let echo = match self.arguments.echo {
            EchoChoice::Auto => Echo::Auto,
            EchoChoice::On => Echo::On,
            EchoChoice::Off => Echo::Off,
        };
        info!("opened {}", self.name());
        let line = Line::new(transport, clock, Timing::Paced(self.settings))?;
        let line = line.settling(self.arguments.settle);
        Ok(Client::new(line, echo))
    }

    fn transport(&self, clock: &Arc<dyn Clock>) -> Result<Box<dyn Transport>, CommandError> {
        let port = self.port();
        if port.is_empty() {
            return Err(CommandError::NoPort);
        }
        if port == "sim:" {
            return Ok(Box::new(SimulatedLine::new(SEED, Arc::clone(clock))));
        }
        if port == "sim" || port.starts_with("sim:") {
            let port = port.to_owned();
            return Err(CommandError::UnknownSimulation { port });
        }
        if port.starts_with("tcp://") || port.starts_with("rtu+tcp://") {
            let port = port.to_owned();
            return Err(CommandError::Tcp { port });
        }
        let give_up = clock.now() + self.arguments.wait;
        let mut is_told = false;
        loop {
            match Serial::open(port, self.settings) {
                Ok(serial) => return Ok(Box::new(serial)),
                Err(OpenError::Busy { .. }) if clock.now() < give_up => {
                    if !is_told {
                        info!("port {port} is in use, waiting for it");
                        is_told = true;
                    }
                    clock.sleep(TRY_AGAIN);
                }
                Err(error) => return Err(error.with_holders().into()),
            }
        }
    }
}
