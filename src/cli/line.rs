//! Options about the line that commands share.

use std::time::Duration;

use clap::{Args, ValueEnum, value_parser};

use super::values::{baud, duration, timeout};

/// The port, its setting and how patient to be.
#[derive(Debug, Args)]
#[command(next_help_heading = "Line")]
pub struct LineArguments {
    /// Serial port such as /dev/ttyUSB0 or COM3, or `sim:` for the simulated line; the variable
    /// `METERPOLL_PORT` serves as well
    #[arg(
        short,
        long,
        env = "METERPOLL_PORT",
        hide_env = true,
        value_name = "PORT"
    )]
    pub port: Option<String>,
    /// Speed in bits a second [default: the meter's factory setting, else 9600]
    #[arg(short, long, value_name = "BAUD", value_parser = baud)]
    pub baud: Option<u32>,
    /// Parity [default: the meter's factory setting, else none]
    #[arg(short = 'P', long, value_name = "PARITY")]
    pub parity: Option<ParityChoice>,
    /// Stop bits [default: the meter's factory setting, else 1]
    #[arg(short, long, value_name = "BITS")]
    pub stop_bits: Option<StopBitsChoice>,
    /// How long a meter may take to begin its answer, such as 500ms; a late one is waited for as
    /// long again and thrown away [default: the meter's longest answer time, else 1s]
    #[arg(short, long, value_name = "TIME", value_parser = timeout)]
    pub timeout: Option<Duration>,
    /// How often a read is repeated when the line fails, at most 100 times
    #[arg(long, value_name = "COUNT", default_value_t = 2, value_parser = value_parser!(u32).range(..=100))]
    pub retries: u32,
    /// Least time between the end of an answer and the next request [default: what the meter
    /// wants; 3.5 characters of silence are kept always]
    #[arg(long, value_name = "TIME", value_parser = duration)]
    pub pause: Option<Duration>,
    /// Time to wait after opening the port, for adapters that need it
    #[arg(long, value_name = "TIME", value_parser = duration, default_value = "0s")]
    pub settle: Duration,
    /// How long to wait for a port that another program holds; after that the message names it
    /// where the system tells
    #[arg(long, value_name = "TIME", value_parser = duration, default_value = "5s")]
    pub wait: Duration,
    /// Whether the line sends our own bytes back, as two-wire adapters may
    #[arg(long, value_name = "WHEN", default_value = "auto")]
    pub echo: EchoChoice,
}

impl LineArguments {
    /// Which line it is, as it is typed: `-p /dev/ttyUSB0 -b 19200`; what was left out is left out.
    pub fn typed(&self) -> String {
        let port = self.port.as_deref().unwrap_or_default();
        let echo = Some(self.echo).filter(|echo| *echo != EchoChoice::Auto);
        let options = [
            self.baud.map(|baud| format!(" -b {baud}")),
            self.parity.map(|parity| format!(" -P {}", word(&parity))),
            self.stop_bits.map(|bits| format!(" -s {}", word(&bits))),
            echo.map(|echo| format!(" --echo {}", word(&echo))),
        ];
        let options: String = options.into_iter().flatten().collect();
        format!("-p {port}{options}")
    }
}

/// A choice as it is typed.
fn word(choice: &impl ValueEnum) -> String {
    let value = choice.to_possible_value();
    value.map_or_else(String::new, |value| value.get_name().to_owned())
}

/// `--parity`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ParityChoice {
    /// No parity bit
    None,
    /// Even parity, the standard's default
    Even,
    /// Odd parity
    Odd,
}

/// `--stop-bits`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum StopBitsChoice {
    /// One stop bit
    #[value(name = "1")]
    One,
    /// Two stop bits
    #[value(name = "2")]
    Two,
}

/// `--echo`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum EchoChoice {
    /// Recognise an echo when one comes
    Auto,
    /// The line echoes
    On,
    /// The line does not echo
    Off,
}
