//! A poll under way: a thread a line, and one place where what they read comes together.

use std::any::Any;
use std::io::{self, IsTerminal};
use std::panic::{self, AssertUnwindSafe};
use std::sync::Arc;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
// It is bounded: what reads waits for what writes, and misses slots, before rows pile up.
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, SyncSender as Sender};
use std::thread;
use std::time::Duration;

use log::info;

use super::outlets::{OnStdout, Outlets};
use super::screen::Screen;
use crate::commands::open_line::PortPlan;
use crate::commands::report::{self, Report};
use crate::commands::signals::Stop;
use crate::commands::trouble::Place;
use crate::commands::{CommandError, ExitCode};
use crate::output::polling::{Board, summary};
use crate::polling::{
    Cycle, Effort, Event, Job, LineLoop, News, PortError, Site, SiteLine, Spared, Tally, Watch,
};
use crate::readings::Fault;
use crate::transport::Clock;

/// The table is drawn anew so often.
const TICK: Duration = Duration::from_millis(250);

/// The row in hand gets so long once a signal has come: that of a meter that answers takes less.
const LAST_ROW: Duration = Duration::from_secs(1);

/// Rows wait so long for others to be written with, where a line is never idle.
const LONGEST_WAIT: Duration = Duration::from_secs(1);

/// Files are written no more often, however many lines become idle: each time costs a sync of the
/// disk.
const SHORTEST_WAIT: Duration = Duration::from_millis(250);

/// So much that lines have said may wait to be heard.
const MOST_WAITING: usize = 1024;

/// How long it goes on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Course {
    /// Until a signal comes.
    Endless,
    /// Everything is read once.
    Once {
        /// How long that may take.
        within: Option<Duration>,
    },
}

/// What is known of the port of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum PortState {
    /// Nothing yet.
    Unknown,
    /// It is open.
    Open,
    /// It is not, and that was told.
    Missing,
}

/// A poll under way.
pub(super) struct Run<'a> {
    site: &'a Site,
    outlets: Outlets<'a>,
    clock: &'a Arc<dyn Clock>,
    stop: &'a Stop,
    report: &'a mut Report,
    ports: Vec<PortState>,
    watch: Watch,
    tally: Tally,
    board: Board,
    screen: Option<Screen>,
    /// Readings there are, and what was in the way of the others, each once.
    delivered: usize,
    faults: Vec<Fault>,
    /// Rows of meters that were not asked, for want of a port and of time.
    untried: (usize, usize),
    /// When files are written again at the earliest, and at the latest.
    next_flush: (Duration, Duration),
    /// Whether a line has become idle since they were.
    is_idle: bool,
    has_rows: bool,
}

/// What the threads of all lines share.
struct Shared<'a> {
    site: &'a Site,
    clock: Arc<dyn Clock>,
    course: Course,
    /// Raised by a signal.
    stop: Arc<AtomicBool>,
    /// Raised when rows have nowhere to go.
    halt: AtomicBool,
    /// Raised when the time is over, that after a signal too: no answer is waited for any longer than it
    /// must be.
    hurry: Arc<AtomicBool>,
}

impl<'a> Run<'a> {
    /// One that has not begun.
    pub(super) fn new(
        site: &'a Site,
        outlets: Outlets<'a>,
        clock: &'a Arc<dyn Clock>,
        stop: &'a Stop,
        report: &'a mut Report,
    ) -> Self {
        Self {
            site,
            outlets,
            clock,
            stop,
            report,
            ports: vec![PortState::Unknown; site.lines.len()],
            watch: Watch::default(),
            tally: Tally::default(),
            board: Board::new(site),
            screen: None,
            delivered: 0,
            faults: Vec::new(),
            untried: (0, 0),
            next_flush: (Duration::ZERO, clock.now().saturating_add(LONGEST_WAIT)),
            is_idle: false,
            has_rows: false,
        }
    }

    /// Polls to the end.
    ///
    /// # Panics
    /// When the thread of a line has: after the rows that there are were written.
    pub(super) fn all(
        mut self,
        course: Course,
        on_stdout: OnStdout,
    ) -> Result<ExitCode, CommandError> {
        if on_stdout == OnStdout::Table {
            self.screen = Some(Screen::new());
        }
        let shared = Shared {
            site: self.site,
            clock: Arc::clone(self.clock),
            course,
            stop: self.stop.flag(),
            halt: AtomicBool::new(false),
            hurry: Arc::default(),
        };
        let broken: Mutex<Option<Box<dyn Any + Send>>> = Mutex::default();
        let result = thread::scope(|scope| {
            let (sender, receiver) = mpsc::sync_channel(MOST_WAITING);
            for (index, line) in self.site.lines.iter().enumerate() {
                let (shared, sender) = (&shared, sender.clone());
                let broken = &broken;
                scope.spawn(move || {
                    let poll = AssertUnwindSafe(|| shared.poll(index, line, &sender));
                    if let Err(cause) = panic::catch_unwind(poll) {
                        // The others do not go on for years as if nothing were missing.
                        shared.halt.store(true, Ordering::Relaxed);
                        if let Ok(mut first) = broken.lock() {
                            first.get_or_insert(cause);
                        }
                    }
                });
            }
            // Only the lines hold it: when the last of them has ended, so has the channel.
            drop(sender);
            let result = self.receive(&shared, &receiver);
            shared.halt.store(true, Ordering::Relaxed);
            result
        });
        if let Some(screen) = &mut self.screen {
            screen.draw(&self.board, self.clock.utc_now());
            screen.leave();
        }
        let written = self.outlets.finish(self.report, &shared.stop);
        self.conclude(course);
        if let Ok(Some(cause)) = broken.into_inner() {
            panic::resume_unwind(cause);
        }
        match (result, written) {
            (result, None) => result.map(|()| ExitCode::of(self.delivered, &self.faults)),
            (Ok(()), Some(code)) => Ok(code),
            // Rows that are nowhere matter more than why it ended.
            (Err(error), Some(code)) => {
                self.report.error(&error);
                Ok(code)
            }
        }
    }

    /// Takes what the lines say, until all have ended: rows that come after something went wrong are
    /// for files as well.
    fn receive(
        &mut self,
        shared: &Shared<'_>,
        events: &Receiver<(usize, Event)>,
    ) -> Result<(), CommandError> {
        let start = self.clock.now();
        let mut result = Ok(());
        let mut stopped = None;
        loop {
            let first = match events.recv_timeout(TICK) {
                Ok(event) => Some(event),
                Err(RecvTimeoutError::Timeout) => None,
                Err(RecvTimeoutError::Disconnected) => return result,
            };
            // What has come meanwhile is written in one go.
            let mut ended = Ok(());
            let further = events.try_iter().take(MOST_WAITING);
            for (line, event) in first.into_iter().chain(further) {
                ended = ended.and(self.event(shared, line, event));
            }
            ended = ended.and(self.outlets.look(self.report));
            if result.is_ok() && ended.is_err() {
                shared.halt.store(true, Ordering::Relaxed);
                result = ended;
            }
            let now = self.clock.now();
            if stopped.is_none() && shared.stop.load(Ordering::Relaxed) {
                stopped = Some(now);
            }
            let is_over = match shared.course {
                Course::Once { within: Some(time) } => now.saturating_sub(start) >= time,
                _ => false,
            };
            if is_over || stopped.is_some_and(|at| now.saturating_sub(at) >= LAST_ROW) {
                shared.hurry.store(true, Ordering::Relaxed);
            }
            let (earliest, latest) = self.next_flush;
            let is_time = now >= latest || (self.is_idle && now >= earliest);
            if is_time && shared.course == Course::Endless {
                self.flush();
            }
            if let Some(screen) = &mut self.screen {
                screen.draw_at_times(&self.board, now, self.clock.utc_now());
            }
        }
    }

    fn event(
        &mut self,
        shared: &Shared<'_>,
        line: usize,
        event: Event,
    ) -> Result<(), CommandError> {
        match event {
            Event::Cycle(cycle) => self.cycle(shared, &cycle)?,
            Event::Idle => self.is_idle = true,
            Event::Open => {
                let state = self.ports.get_mut(line);
                let before = state.map(|state| std::mem::replace(state, PortState::Open));
                if before == Some(PortState::Missing) {
                    let place = self.site.lines.get(line).map(place).unwrap_or_default();
                    self.say(|report| report.remark(&format!("{place}: the port is there now")));
                }
            }
            Event::NoPort(error) => self.no_port(shared, line, error)?,
        }
        Ok(())
    }

    /// A port that is not there is told once. Where none of them is at the start there is nothing to
    /// go on for.
    fn no_port(
        &mut self,
        shared: &Shared<'_>,
        line: usize,
        error: PortError,
    ) -> Result<(), CommandError> {
        let Some(state) = self.ports.get_mut(line) else {
            return Ok(());
        };
        let before = std::mem::replace(state, PortState::Missing);
        let error = match error {
            PortError::Open(error) => CommandError::Open(error),
            PortError::Lost(error) => CommandError::Lost(error),
        };
        let is_hopeless = self.ports.iter().all(|port| *port == PortState::Missing);
        if before == PortState::Unknown && is_hopeless && shared.course == Course::Endless {
            return Err(error);
        }
        if before != PortState::Missing {
            self.say(|report| {
                let _ = report.error(&error);
            });
        }
        Ok(())
    }

    /// One more row.
    fn cycle(&mut self, shared: &Shared<'_>, cycle: &Cycle) -> Result<(), CommandError> {
        let Some(job) = self.site.jobs.get(cycle.job) else {
            return Ok(());
        };
        self.has_rows = true;
        self.tally.add(cycle);
        self.board.heed(cycle);
        self.delivered += cycle.row.readings.iter().filter(|r| r.is_ok()).count();
        for fault in cycle.row.faults() {
            if !self.faults.contains(&fault) {
                self.faults.push(fault);
            }
        }
        if shared.course != Course::Endless {
            match cycle.effort {
                Effort::Spared(Spared::PortAway) => self.untried.0 += 1,
                Effort::Spared(Spared::Deadline) => self.untried.1 += 1,
                Effort::Spared(Spared::Silent) | Effort::Asked(_) => {}
            }
        }
        info!("{}", told(job, cycle));
        self.tell(job, cycle);
        self.outlets.row(cycle)
    }

    /// Tells what is worth telling of a row.
    fn tell(&mut self, job: &Job, cycle: &Cycle) {
        let news = self.watch.heed(cycle);
        if news.is_empty() {
            return;
        }
        let Some(line) = self.site.lines.get(job.subject.line) else {
            return;
        };
        let line = place(line);
        let points = job.all_points();
        let attempts = match cycle.effort {
            Effort::Asked(attempts) => attempts,
            Effort::Spared(_) => 0,
        };
        let place = Place {
            meter: &job.subject.name,
            line: &line,
            unit: job.subject.unit,
            points: &points,
            attempts,
        };
        let subject = format!("{} on {line}", job.subject);
        self.say(|report| {
            for news in news {
                match news {
                    News::Missing => {
                        for trouble in &cycle.troubles {
                            report.trouble(&place, trouble);
                        }
                    }
                    News::Back { since, rows } => {
                        let rows = crate::words::counted(rows, "row", "rows");
                        let since = since.strftime("%Y-%m-%d %H:%M:%S UTC");
                        report.remark(&format!(
                            "{subject}: all is there again; {rows} lacked some since {since}"
                        ));
                    }
                    News::Missed { slots } => {
                        let slots = crate::words::counted(slots, "slot was", "slots were");
                        report::warning(&format!(
                            "{subject}: {slots} not begun, for the line was not free in time; \
                             --check tells how long it is busy"
                        ));
                    }
                    News::InTime { slots } => {
                        let slots = crate::words::counted(slots, "slot was", "slots were");
                        report.remark(&format!("{subject}: in time again; {slots} not begun"));
                    }
                }
            }
        });
    }

    /// Says something where the table is.
    fn say(&mut self, say: impl FnOnce(&mut Report)) {
        if let Some(screen) = &mut self.screen {
            screen.erase();
        }
        say(self.report);
    }

    fn flush(&mut self) {
        let start = self.clock.now();
        if let Some(screen) = &mut self.screen
            && self.outlets.has_rows()
        {
            screen.erase();
        }
        self.outlets.flush(self.report);
        // A slow disk is given as much time without as it has taken.
        let end = self.clock.now();
        let pause = end.saturating_sub(start).max(SHORTEST_WAIT);
        let latest = pause.max(LONGEST_WAIT);
        self.next_flush = (end.saturating_add(pause), end.saturating_add(latest));
        self.is_idle = false;
    }

    /// Says what all of it came to.
    fn conclude(&mut self, course: Course) {
        let (away, late) = self.untried;
        if away > 0 {
            report::untried_rows(away, "the port is away");
        }
        if late > 0 {
            report::untried_rows(late, "the deadline has passed");
        }
        let is_wanted = io::stderr().is_terminal() || log::log_enabled!(log::Level::Info);
        if course == Course::Endless && is_wanted && self.has_rows {
            for line in summary(self.site, &self.tally).lines() {
                self.report.remark(line);
            }
        }
    }
}

impl Shared<'_> {
    /// Polls one line to the end.
    fn poll(&self, index: usize, line: &SiteLine, events: &Sender<(usize, Event)>) {
        let plan = PortPlan {
            port: &line.port,
            settings: line.settings,
            echo: line.echo,
            settle: line.settle,
            wait: line.wait,
        };
        let is_over = || {
            let flags = [&self.stop, &self.hurry];
            let is_up = |flag: &AtomicBool| flag.load(Ordering::Relaxed);
            flags.into_iter().any(|flag| is_up(flag)) || is_up(&self.halt)
        };
        let mut open = || {
            let mut client = plan.open(&self.clock, &is_over)?;
            client.stop_when(Arc::clone(&self.hurry));
            Ok(client)
        };
        let stop = || self.stop.load(Ordering::Relaxed) || self.halt.load(Ordering::Relaxed);
        // Where nobody listens any more, `halt` ends it.
        let mut deliver = |event| drop(events.send((index, event)));
        let line = LineLoop::new(self.site.jobs_on(index), &*self.clock, &mut open);
        match self.course {
            Course::Endless => line.endless(&stop, &mut deliver),
            Course::Once { within } => line.once(within, &stop, &mut deliver),
        }
    }
}

/// `/dev/ttyUSB0 at 9600 8N1`.
fn place(line: &SiteLine) -> String {
    format!("{} at {}", line.port, line.settings)
}

/// One line about a row, for those who want to see each.
fn told(job: &Job, cycle: &Cycle) -> String {
    let time = cycle.slot.time.strftime("%Y-%m-%d %H:%M:%S UTC");
    let status = crate::output::status(cycle.row.worst());
    let took = cycle.took.as_millis();
    let late = cycle.slot.late.as_millis();
    format!(
        "{}, slot of {time}: {status}, {late} ms late, took {took} ms",
        job.subject
    )
}
