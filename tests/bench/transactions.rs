//! What the program itself costs, without the silences of a line: a read of ten registers over a
//! pty beside the bare write and read of the same bytes. Takes the path of a pty whose other end
//! answers at once, as `tests/bench/run` provides.

use std::fs::OpenOptions;
use std::io::{Read, Write};
use std::sync::Arc;
use std::time::{Duration, Instant};

use meterpoll::client::{Client, Echo, Patience};
use meterpoll::codec::{ReadFunction, RegisterRange, Request, Unit, UnitRange};
use meterpoll::transport::serial::Serial;
use meterpoll::transport::{Line, LineSettings, SystemClock, Timing};

const TRANSACTIONS: usize = 20_000;
const WARM_UP: usize = 200;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let Some(path) = std::env::args().nth(1).filter(|path| path.starts_with('/')) else {
        println!("transactions: skipped, no pty given");
        return Ok(());
    };
    println!("bare write and read   {}", summary(bare(&path)?));
    let settings = LineSettings {
        baud: 115_200,
        ..LineSettings::default()
    };
    let serial = Serial::open(&path, settings)?;
    let clock = Arc::new(SystemClock::new());
    let line = Line::new(Box::new(serial), clock, Timing::Unpaced)?;
    let mut client = Client::new(line, Echo::Auto);
    let unit = Unit::new(1, UnitRange::Standard)?;
    let request = Request::Read {
        function: ReadFunction::HoldingRegisters,
        range: RegisterRange::new(0, 10)?,
    };
    let mut failed = 0;
    let times = measure(|| {
        failed += usize::from(client.request(unit, &request, Patience::default()).is_err());
    });
    println!("read 10 registers     {}, {failed} failed", summary(times));
    Ok(())
}

/// The floor on this machine: the same bytes written and read with nothing around.
fn bare(path: &str) -> Result<Vec<Duration>, Box<dyn std::error::Error>> {
    let request = [0x01, 0x03, 0x00, 0x00, 0x00, 0x0A, 0xC5, 0xCD];
    let mut answer = [0; 25];
    let mut port = OpenOptions::new().read(true).write(true).open(path)?;
    let mut result = Ok(());
    let times = measure(|| {
        let exchange = port
            .write_all(&request)
            .and_then(|()| port.read_exact(&mut answer));
        if let Err(error) = exchange {
            result = Err(error);
        }
    });
    result?;
    Ok(times)
}

/// Times of many runs after some to warm up.
fn measure(mut run: impl FnMut()) -> Vec<Duration> {
    for _ in 0..WARM_UP {
        run();
    }
    (0..TRANSACTIONS)
        .map(|_| {
            let start = Instant::now();
            run();
            start.elapsed()
        })
        .collect()
}

fn summary(mut times: Vec<Duration>) -> String {
    times.sort_unstable();
    let at = |share: usize| times[(times.len() - 1) * share / 100].as_secs_f64() * 1e6;
    format!(
        "n {:>6}  median {:>8.1} us  p99 {:>8.1} us  worst {:>9.1} us",
        times.len(),
        at(50),
        at(99),
        at(100)
    )
}
