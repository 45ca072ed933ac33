//! Arguments of `simulate`.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, ValueHint, value_parser};

use super::line::{ParityChoice, StopBitsChoice};
use super::values::{MeterUnits, baud, duration};

const EXAMPLES: &str = "\
Examples:
  meterpoll simulate
  meterpoll simulate --meter pqm=17,18 --meter em24=1-3
  meterpoll simulate --port /tmp/meter --meter pqm --values readings.csv
  meterpoll simulate --port /dev/ttyUSB0 -b 19200 --meter em24
  meterpoll simulate --port tcp://127.0.0.1:5020
  meterpoll simulate --port rtu+tcp://127.0.0.1:5020 --count 100
  meterpoll simulate --fault late=1.1,rate=0.1,seed=7 --fault silence,on=3";

/// Arguments of `simulate`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Simulate {
    /// Where clients come from; its path or address is the first line on stdout [default: a new pty]
    #[arg(
        short,
        long,
        value_name = "PORT",
        long_help = "\
Where clients come from [default: a new pty]

  /tmp/meter                a new pty under this name, which must be
                            free and not under /dev; the name goes
                            with the program
  /dev/ttyUSB0              a serial port
  rtu+tcp://127.0.0.1:5020  RTU frames over TCP; port 0 is any that
                            is free
  tcp://127.0.0.1:502       Modbus TCP; 502 may be left out

Its path or address is the first line on stdout. The variable METERPOLL_PORT has no say here: a \
simulated meter must not come onto a line of real ones by accident."
    )]
    pub port: Option<String>,
    /// A meter and its units: a name that `meters list` shows or a profile file, and
    /// `=17`, `=1,2,5-9`; may be repeated [default: em24=1, pm290=2, em21=3, pqm=17]
    #[arg(
        long,
        value_name = "METER[=UNITS]",
        long_help = "\
A meter and its units: a name that `meters list` shows or a profile file, and =17, =1,2,5-9. May be \
repeated [default: em24=1, pm290=2, em21=3, pqm=17]

Without units it has the one named above, and unit 1 when it is another meter. Each unit has a load \
of its own. A meter that is not named above holds 0 in all registers that --values does not give."
    )]
    pub meter: Vec<MeterUnits>,
    /// CSV with values that stay as they are, while all others move with the load
    #[arg(
        long,
        value_name = "FILE",
        value_hint = ValueHint::FilePath,
        long_help = "\
CSV with values that stay as they are, while all others move with the load.

Its header has the columns point and value; rows of a column unit_id are for that unit only, and \
other columns are passed over, so that what `read-registers -f csv --layout long` wrote is played \
back. A value is written as it reads: 415, 60.01, on, 23:59:59.000. In place of a point there can \
be a register, 0x0240, and the number in it. Empty values are left to the load, and of several rows \
for one point the last one counts."
    )]
    pub values: Option<PathBuf>,
    /// Which loads are measured: the same seed and time give the same values; `sim:` has 17
    #[arg(long, value_name = "NUMBER", default_value_t = 17)]
    pub seed: u64,
    /// How long the meters take before they answer
    #[arg(long, value_name = "TIME", value_parser = duration, default_value = "0s")]
    pub answer_time: Duration,
    /// What goes wrong, such as `late=1.1,rate=0.1`; may be repeated: the first rule that applies to
    /// a request decides
    #[arg(
        long,
        value_name = "RULE",
        long_help = "\
What goes wrong: KIND[=VALUE][,KEY=VALUE]... May be repeated: the first rule that applies to a \
request decides.

Kinds: late delay silence cut split drip endless before after echo echo-only twice crc crc-swapped \
flip burst wrong-unit stranger stranger-only wrong-function wrong-count oversize exception \
exception-for garbage hang-up any

Keys of all: rate=0.1 (how probable), on=3, on=3-5, on=1/4 (which requests), for=17 (unit), \
function=3, seed=7"
    )]
    pub fault: Vec<String>,
    /// A file of such rules, one a line; they come after those of --fault
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub fault_script: Option<PathBuf>,
    /// End after this many requests to the meters here, once what answers them is out, with exit
    /// code 0
    #[arg(long, value_name = "NUMBER", value_parser = value_parser!(u64).range(1..))]
    pub count: Option<u64>,
    /// Speed in bits a second, of a serial port [default: the first meter's factory setting]
    #[arg(short, long, value_name = "BAUD", value_parser = baud)]
    pub baud: Option<u32>,
    /// Parity, of a serial port [default: the first meter's factory setting]
    #[arg(short = 'P', long, value_name = "PARITY")]
    pub parity: Option<ParityChoice>,
    /// Stop bits, of a serial port [default: the first meter's factory setting]
    #[arg(short, long, value_name = "BITS")]
    pub stop_bits: Option<StopBitsChoice>,
    /// How long to wait for a serial port that another program holds
    #[arg(long, value_name = "TIME", value_parser = duration, default_value = "5s")]
    pub wait: Duration,
}
