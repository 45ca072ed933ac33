//! From the options about the line to a client on it.

use std::sync::Arc;
use std::time::Duration;

use log::info;

use super::CommandError;
use crate::cli::{EchoChoice, LineArguments, ParityChoice, StopBitsChoice};
use crate::client::{Client, Echo, Patience};
use crate::polling::{Manners, PortError};
use crate::profile::{Limits, Profile};
use crate::sim::SimulatedLine;
use crate::transport::serial::Serial;
use crate::transport::traced::Traced;
use crate::transport::{
    Clock, Line, LineSettings, OpenError, Parity, StopBits, SystemClock, Timing, Transport,
};

/// How often a busy port is tried again.
const TRY_AGAIN: Duration = Duration::from_millis(50);

/// How the simulated line is named.
pub(super) const SIMULATED: &str = "sim:";

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
        let (baud, parity) = (arguments.baud, arguments.parity);
        let settings = settings(baud, parity, arguments.stop_bits, factory);
        Self {
            arguments,
            settings,
        }
    }

    /// The line as messages and headings name it: `/dev/ttyUSB0 at 9600 8N1`.
    pub(super) fn name(&self) -> String {
        format!("{} at {}", self.port(), self.settings)
    }

    /// The port as it was named; empty when none was.
    pub(super) fn port(&self) -> &str {
        self.arguments.port.as_deref().unwrap_or_default()
    }

    /// The options that were given of it, as they are typed: `-p /dev/ttyUSB0 -b 19200`.
    pub(super) fn typed(&self) -> String {
        self.arguments.typed()
    }

    /// How patient to be with a meter of these limits.
    pub(super) fn patience(&self, limits: &Limits) -> Patience {
        manners(self.arguments).patience(limits)
    }

    /// Opens the port and returns a client on it.
    pub(super) fn open(&self) -> Result<Client, CommandError> {
        self.open_with(self.echo())
    }

    /// What was said of echoes.
    pub(super) fn echo(&self) -> Echo {
        echo(self.arguments)
    }

    /// The same with another way to take echoes.
    pub(super) fn open_with(&self, echo: Echo) -> Result<Client, CommandError> {
        check_port(self.port())?;
        let clock: Arc<dyn Clock> = Arc::new(SystemClock::new());
        let plan = PortPlan {
            port: self.port(),
            settings: self.settings,
            echo,
            settle: self.arguments.settle,
            wait: self.arguments.wait,
        };
        plan.open(&clock, &|| false).map_err(|error| match error {
            PortError::Open(error) => CommandError::Open(error),
            PortError::Lost(error) => CommandError::Lost(error),
        })
    }
}

/// Whether a port is named that there can be.
pub(super) fn check_port(port: &str) -> Result<(), CommandError> {
    let is_tcp = port.starts_with("tcp://") || port.starts_with("rtu+tcp://");
    let port = port.to_owned();
    match port.as_str() {
        "" => Err(CommandError::NoPort),
        SIMULATED => Ok(()),
        "sim" => Err(CommandError::UnknownSimulation { port }),
        _ if port.starts_with(SIMULATED) => Err(CommandError::UnknownSimulation { port }),
        _ if is_tcp => Err(CommandError::Tcp { port }),
        _ => Ok(()),
    }
}

/// How patient to be, as typed.
pub(super) fn manners(arguments: &LineArguments) -> Manners {
    Manners {
        timeout: arguments.timeout,
        retries: arguments.retries,
        pause: arguments.pause,
    }
}

/// What was said of echoes.
pub(super) fn echo(arguments: &LineArguments) -> Echo {
    match arguments.echo {
        EchoChoice::Auto => Echo::Auto,
        EchoChoice::On => Echo::On,
        EchoChoice::Off => Echo::Off,
    }
}

/// A port, checked, and how it is opened.
pub(super) struct PortPlan<'a> {
    pub(super) port: &'a str,
    pub(super) settings: LineSettings,
    pub(super) echo: Echo,
    /// After it was opened.
    pub(super) settle: Duration,
    /// While another program holds it.
    pub(super) wait: Duration,
}

impl PortPlan<'_> {
    /// Opens the port and returns a client on it; waits for nothing any more once `is_over` says so.
    pub(super) fn open(
        &self,
        clock: &Arc<dyn Clock>,
        is_over: &dyn Fn() -> bool,
    ) -> Result<Client, PortError> {
        let clock = Arc::clone(clock);
        let transport: Box<dyn Transport> = if self.port == SIMULATED {
            Box::new(SimulatedLine::new(SEED, Arc::clone(&clock)))
        } else {
            let open = || Serial::open(self.port, self.settings);
            Box::new(while_busy(&*clock, self.port, self.wait, is_over, open)?)
        };
        let settled = clock.now().saturating_add(self.settle);
        while let Some(left) = settled
            .checked_sub(clock.now())
            .filter(|left| !left.is_zero())
        {
            if is_over() {
                break;
            }
            clock.sleep(left.min(TRY_AGAIN));
        }
        let transport: Box<dyn Transport> = if log::log_enabled!(log::Level::Trace) {
            Box::new(Traced::new(transport, Arc::clone(&clock)))
        } else {
            transport
        };
        info!("opened {} at {}", self.port, self.settings);
        let line = Line::new(transport, clock, Timing::Paced(self.settings))?;
        let line = line.settling(self.settle);
        Ok(Client::new(line, self.echo))
    }
}

/// What was typed wins over the meter's factory setting.
pub(super) fn settings(
    baud: Option<u32>,
    parity: Option<ParityChoice>,
    stop_bits: Option<StopBitsChoice>,
    factory: LineSettings,
) -> LineSettings {
    LineSettings {
        baud: baud.unwrap_or(factory.baud),
        parity: parity.map_or(factory.parity, |parity| match parity {
            ParityChoice::None => Parity::None,
            ParityChoice::Even => Parity::Even,
            ParityChoice::Odd => Parity::Odd,
        }),
        stop_bits: stop_bits.map_or(factory.stop_bits, |bits| match bits {
            StopBitsChoice::One => StopBits::One,
            StopBitsChoice::Two => StopBits::Two,
        }),
    }
}

/// Opens a port, again and again while another program holds it, at most for `wait`, and no
/// longer once `is_over` says so.
pub(super) fn while_busy<T>(
    clock: &dyn Clock,
    port: &str,
    wait: Duration,
    is_over: &dyn Fn() -> bool,
    mut open: impl FnMut() -> Result<T, OpenError>,
) -> Result<T, OpenError> {
    let give_up = clock.now() + wait;
    let mut is_told = false;
    loop {
        match open() {
            Err(OpenError::Busy { .. }) if clock.now() < give_up && !is_over() => {
                if !is_told {
                    info!("port {port} is in use, waiting for it");
                    is_told = true;
                }
                clock.sleep(TRY_AGAIN);
            }
            result => return result.map_err(OpenError::with_holders),
        }
    }
}
