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
for one point the last one counts. A client that writes one of them ends that."
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

KIND is what the answer comes to. In brackets is what a value left out stands for; others are left \
to chance.

  late=1.1          begins after so many time-outs [1.1 to 1.9]
  delay=40ms        begins so long after the request [40ms]
  silence           never comes
  cut=5             breaks off after so many bytes
  split=4           comes in two pieces, so many bytes first
  drip=20ms         comes byte by byte, so far apart [20ms]
  endless           comes without its CRC over and over
  before=00FF       comes behind noise, in hex
  after=00FF        comes with noise behind it, in hex
  echo=5            comes behind so many request bytes [all]
  echo-only         is the request itself
  twice             comes twice
  crc               has all bits of its CRC wrong
  crc-swapped       has the bytes of its CRC swapped
  flip=9            has this bit wrong, counted from 0
  burst=16          has so many bits in a row damaged [1 to 16]
  wrong-unit=9      bears this unit, and a right CRC
  stranger=9        comes behind one of this unit
  stranger-only=9   is one of this unit, again and again
  wrong-function=4  bears this function [4 for 3, else 3]
  wrong-count=+1    has a register more; -1: one fewer, odd: a
                    byte more, 0: no data, 255: 255 bytes
  oversize          has 257 bytes, and a right CRC
  exception=6       is this exception
  exception-for=16  is exception 02 of this function
  garbage           is random bytes without end
  hang-up=during    goes with the port, lost before, during or
                    after it [during]
  any               has one of these, but no hang-up, at random

KEY is one of these for any kind, and says when it happens:

  rate=0.1          how probable it is [1]
  on=3              which requests, from 1; or 3-5, 3-, 1/4
  for=17            of requests to this unit alone
  function=3        of requests for this function alone
  seed=7            where chance begins [0]

or one of these for some:

  timeout=1s        late, cut, any: what a time-out is [1s]
  rest=1.5          cut: when the rest comes, in time-outs [never]
  gap=20ms          split [16ms], before, after, echo, twice,
                    stranger [0s]: from one piece to the next
  every=20ms        endless [20ms], garbage [1ms], stranger-only
                    [200ms]: from one byte, or frame, to the next
  lasts=2s          endless, garbage, stranger-only: how long it
                    goes on [until the next request]
  with=hang-up+crc  any: what is picked as well
  without=cut+crc   any: what is not picked"
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
