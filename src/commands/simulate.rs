//! `simulate`: meters that other programs' clients talk to.

mod faults;
mod meters;
mod place;

use std::io::{self, IsTerminal};
use std::sync::Arc;
use std::time::Duration;

use self::place::Place;
use super::report::Report;
use super::signals::Stop;
use super::{CommandError, ExitCode, print};
use crate::cli::Simulate;
use crate::sim::Server;
use crate::sim::server::{ServeError, Service, State, Tally};
use crate::transport::{Clock, Outside, SystemClock};

/// How long a signal may go unnoticed.
const PATIENCE: Duration = Duration::from_millis(100);

/// How long clients may take to read what they were sent last.
const FAREWELL: Duration = Duration::from_secs(1);

/// Serves until a signal comes, the line is lost, or as many requests were heard as were asked for
/// and what answers them is out.
pub(super) fn run(arguments: &Simulate, report: &Report) -> Result<ExitCode, CommandError> {
    let place = Place::of(arguments.port.as_deref())?;
    let wanted = meters::wanted(arguments)?;
    let settings = place.settings(arguments, wanted.factory_setting())?;
    let framing = place.framing(settings);
    let script = faults::script(arguments, framing, place.comes_back())?;
    let clock: Arc<dyn Clock> = Arc::new(SystemClock::new());
    let meters = wanted.make(arguments, clock.utc_now())?;
    let service = Service {
        framing,
        answer_time: arguments.answer_time,
        script,
        count: arguments.count,
    };
    // From here on there may be something to take away again at the end.
    let stop = Stop::listen();
    let (outside, name) = place.open(settings, arguments.wait, &*clock)?;
    print(format!("{name}\n").as_bytes())?;
    if io::stderr().is_terminal() {
        for line in words(&place, &wanted, &name) {
            report.remark(&line);
        }
    }
    let mut server = Server::new(outside, meters, service, clock);
    let result = serve(&mut server, &stop);
    // Before an error counts of nothing tell nothing.
    if result.is_ok() || *server.tally() != Tally::default() {
        report.remark(&server.tally().to_string());
    }
    if let Some(faults) = faults::told(&server.faults()) {
        report.remark(&faults);
    }
    match result? {
        State::HungUp => {
            report.remark("the line has hung up");
            Ok(ExitCode::Done)
        }
        State::Done => Ok(ExitCode::Done),
        State::Serving => Ok(stop.requested().unwrap_or(ExitCode::Done)),
    }
}

fn serve<O: Outside>(server: &mut Server<O>, stop: &Stop) -> Result<State, CommandError> {
    let mut state = State::Serving;
    while state == State::Serving && stop.requested().is_none() {
        state = server.turn(PATIENCE).map_err(|error| match error {
            ServeError::Lost(error) => CommandError::Lost(error),
            ServeError::Reopen(error) => CommandError::Open(error),
        })?;
    }
    if state == State::Done {
        server.finish(FAREWELL);
    }
    Ok(state)
}

/// What is there, how to read it, by the name of the place, and how to end it: a line each.
fn words(place: &Place, wanted: &meters::Wanted, name: &str) -> Vec<String> {
    let read = wanted.last().filter(|_| place.is_line());
    let read = read.map(|(meter, unit)| {
        format!("read it: meterpoll read-registers -p {name} -a {unit} --meter {meter}")
    });
    let mut words = vec![wanted.told()];
    words.extend(read);
    words.push("end it: Ctrl-C".to_owned());
    words
}
