//! How a line is set, and how long things take on it.

use std::fmt;
use std::time::Duration;

use serde::{Deserialize, Serialize};

/// The parity bit of each character.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Parity {
    /// No parity bit.
    #[default]
    None,
    /// Even.
    Even,
    /// Odd.
    Odd,
}

impl fmt::Display for Parity {
    /// `none`, `even`, `odd`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::None => "none",
            Self::Even => "even",
            Self::Odd => "odd",
        })
    }
}

/// Stop bits of each character.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum StopBits {
    /// One.
    #[default]
    One,
    /// Two.
    Two,
}

impl StopBits {
    /// How many.
    pub const fn count(self) -> u8 {
        match self {
            Self::One => 1,
            Self::Two => 2,
        }
    }
}

/// Speed and character format of a serial line; eight data bits always, as RTU demands (SL 2.5.1).
/// Prints as `9600 8N1`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct LineSettings {
    /// Bits a second, above 0.
    pub baud: u32,
    /// Parity.
    pub parity: Parity,
    /// Stop bits.
    pub stop_bits: StopBits,
}

impl Default for LineSettings {
    /// 9600 8N1: what most meters ship with, although the standard's own default is 19200 8E1.
    fn default() -> Self {
        Self {
            baud: 9600,
            parity: Parity::None,
            stop_bits: StopBits::One,
        }
    }
}

impl LineSettings {
    /// Above this speed the standard's silences are fixed (SL 2.5.1.1).
    const FIXED_SILENCE_ABOVE: u32 = 19_200;
    /// t3.5 above that speed (SL 2.5.1.1).
    const FIXED_SILENCE: Duration = Duration::from_micros(1750);

    /// Bits of one character: start, eight data, parity, stop.
    pub const fn character_bits(self) -> u32 {
        let parity = match self.parity {
            Parity::None => 0,
            Parity::Even | Parity::Odd => 1,
        };
        let stop = match self.stop_bits {
            StopBits::One => 1,
            StopBits::Two => 2,
        };
        1 + 8 + parity + stop
    }

    /// How long this many characters take on the wire.
    pub fn transfer_time(self, characters: usize) -> Duration {
        let bits = u64::from(self.character_bits()) * characters as u64;
        Duration::from_nanos(bits * 1_000_000_000 / u64::from(self.baud.max(1)))
    }

    /// t3.5: the silence between frames, 3.5 characters up to 19200 baud, 1.75 ms above.
    pub fn silence(self) -> Duration {
        if self.baud > Self::FIXED_SILENCE_ABOVE {
            Self::FIXED_SILENCE
        } else {
            self.transfer_time(7) / 2
        }
    }
}

impl fmt::Display for LineSettings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parity = match self.parity {
            Parity::None => 'N',
            Parity::Even => 'E',
            Parity::Odd => 'O',
        };
        write!(f, "{} 8{parity}{}", self.baud, self.stop_bits.count())
    }
}

/// The pace a line is driven at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Timing {
    /// As a serial line with these settings asks.
    Paced(LineSettings),
    /// No silences and no transfer times: for measuring the program itself.
    Unpaced,
}

impl Timing {
    /// How long this many characters take.
    pub fn transfer_time(self, characters: usize) -> Duration {
        match self {
            Self::Paced(settings) => settings.transfer_time(characters),
            Self::Unpaced => Duration::ZERO,
        }
    }

    /// The silence before each frame.
    pub fn silence(self) -> Duration {
        match self {
            Self::Paced(settings) => settings.silence(),
            Self::Unpaced => Duration::ZERO,
        }
    }
}
