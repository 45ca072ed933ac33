//! The program as a process, and what it uses.

use std::error::Error;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A run of the program that goes on.
pub(crate) struct Watched {
    child: Child,
    start: Instant,
}

/// What it has used so far.
pub(crate) struct Usage {
    pub(crate) peak_mib: f64,
    pub(crate) busy: Duration,
}

impl Watched {
    pub(crate) fn start(folder: &Path, arguments: &[&str]) -> Result<Self, Box<dyn Error>> {
        let start = Instant::now();
        let child = command(folder, arguments).spawn()?;
        Ok(Self { child, start })
    }

    /// `None` where the system does not say.
    pub(crate) fn usage(&self) -> Option<Usage> {
        let pid = self.child.id().to_string();
        let peak_kib = of_status(&pid, "VmHWM:")?;
        let tasks = fs::read_dir(format!("/proc/{pid}/task")).ok()?;
        let mut busy = Duration::ZERO;
        for task in tasks {
            let times = fs::read_to_string(task.ok()?.path().join("schedstat")).ok()?;
            busy += Duration::from_nanos(times.split(' ').next()?.parse().ok()?);
        }
        Some(Usage {
            peak_mib: f64::from(peak_kib) / 1024.0,
            busy,
        })
    }

    /// Stops it; how long it has gone on.
    pub(crate) fn stop(mut self) -> Result<Duration, Box<dyn Error>> {
        let took = self.start.elapsed();
        let pid = self.child.id().to_string();
        Command::new("kill").args(["-s", "TERM", &pid]).status()?;
        self.child.wait()?;
        Ok(took)
    }
}

impl Drop for Watched {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Runs it to its end, which must be a good one.
pub(crate) fn run(folder: &Path, arguments: &[&str]) -> Result<(), Box<dyn Error>> {
    let status = command(folder, arguments).stdout(Stdio::null()).status()?;
    if !status.success() {
        return Err(format!("{arguments:?}: {status}").into());
    }
    Ok(())
}

fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_meterpoll"));
    command.args(arguments).current_dir(folder);
    command.env_remove("METERPOLL_PORT").stdin(Stdio::null());
    command
}

/// Resident memory of a process, in KiB.
pub(crate) fn resident_kib(pid: &str) -> Option<u32> {
    of_status(pid, "VmRSS:")
}

fn of_status(pid: &str, name: &str) -> Option<u32> {
    let status = fs::read_to_string(format!("/proc/{pid}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix(name))?;
    line.trim().strip_suffix("kB")?.trim().parse().ok()
}
