//! `poll`: many meters on many lines, over and over, or once.
//!
//! Each line has a thread of its own (see [`LineLoop`](crate::polling::LineLoop)); what they read
//! comes together in `run`, which writes it with `outlets` (to stdout by `printer`, into files by
//! `files`), tells what is worth telling and, on a
//! terminal, keeps a table up to date with `screen`. `arguments` makes the command line a site,
//! `forecast` says what would be done.

mod arguments;
mod files;
mod forecast;
mod outlets;
mod printer;
mod run;
mod screen;

use std::io::{self, IsTerminal};
use std::sync::Arc;

use super::report::Report;
use super::signals::Stop;
use super::{CommandError, ExitCode, print};
use crate::cli::Poll;
use crate::polling::Site;
use crate::transport::{Clock, SystemClock};

use forecast::Forecast;
use outlets::{OnStdout, Outlets};
use run::{Course, Run};

/// Reads and writes what was asked for.
pub(super) fn run(arguments: &Poll, report: &mut Report) -> Result<ExitCode, CommandError> {
    let site = arguments::site(arguments)?;
    let clock: Arc<dyn Clock> = Arc::new(SystemClock::new());
    let course = course(arguments, &site);
    let on_stdout = on_stdout(arguments, &site, course, report);
    outlets::columns(&site)?;
    if arguments.check {
        let forecast = Forecast::new(&site, course, clock.utc_now());
        let code = forecast.code();
        return print(forecast.to_string().as_bytes()).map(|_| code);
    }
    // Before anything is sent: where the rows cannot go, none are taken.
    let outlets = Outlets::open(&site, Arc::clone(&clock), on_stdout, course)?;
    let stop = match course {
        Course::Endless => Stop::listen_in_background(),
        Course::Once { .. } => Stop::listen(),
    };
    let run = Run::new(&site, outlets, &clock, &stop, report);
    let code = run.all(course, on_stdout)?;
    Ok(match code {
        // Rows that are nowhere matter more than who stopped it.
        ExitCode::Output => code,
        _ => stop.requested().unwrap_or(code),
    })
}

fn course(arguments: &Poll, site: &Site) -> Course {
    if !arguments.once {
        return Course::Endless;
    }
    let intervals = site.jobs.iter().filter_map(|job| job.every);
    let longest = intervals.max().map(crate::polling::Every::get);
    Course::Once {
        within: arguments.deadline.or(longest),
    }
}

/// On a terminal that nobody has asked to print rows on there is a table instead.
fn on_stdout(arguments: &Poll, site: &Site, course: Course, report: &Report) -> OnStdout {
    let prints_rows = site.outputs.iter().any(|output| output.path.is_none());
    let was_asked = arguments.format.is_some() || arguments.config.is_some();
    let is_for_people = io::stdout().is_terminal()
        && !report.is_quiet()
        && !log::log_enabled!(log::Level::Info)
        && course == Course::Endless;
    if is_for_people && !(prints_rows && was_asked) {
        OnStdout::Table
    } else {
        OnStdout::Rows
    }
}
