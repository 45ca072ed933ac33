//! What a poll would do: what is read when, how long that takes, and whether the interval can hold
//! it.

use std::fmt;
use std::time::Duration;

use jiff::Timestamp;

use super::run::Course;
use crate::commands::ExitCode;
use crate::output::columns::columns;
use crate::output::escape;
use crate::polling::{Every, Job, Moment, Schedule, Site, SiteLine};
use crate::words::counted;

/// What a poll would do from a moment on.
pub(super) struct Forecast<'a> {
    site: &'a Site,
    course: Course,
    now: Timestamp,
}

/// Whether a line can do what it is to do.
enum Verdict {
    /// Even when everything is due at once.
    Fits,
    /// On average, but not when everything is due at once.
    Bursts { shortest: Every },
    /// Never.
    Overloaded { load: f64 },
    /// Not within the deadline.
    TooLong { within: Duration },
}

impl<'a> Forecast<'a> {
    /// That of this site.
    pub(super) const fn new(site: &'a Site, course: Course, now: Timestamp) -> Self {
        Self { site, course, now }
    }

    /// 1 where something does not fit.
    pub(super) fn code(&self) -> ExitCode {
        let lines = 0..self.site.lines.len();
        let mut verdicts = lines.map(|line| self.verdict(line));
        if verdicts.all(|verdict| matches!(verdict, Verdict::Fits)) {
            ExitCode::Done
        } else {
            ExitCode::SomeMissing
        }
    }

    /// How long everything on a line takes together.
    fn together(&self, line: usize) -> Duration {
        self.site
            .jobs_on(line)
            .map(|(_, job)| job.predicted())
            .sum()
    }

    fn verdict(&self, line: usize) -> Verdict {
        let all = self.together(line);
        if let Course::Once { within } = self.course {
            return match within {
                Some(within) if all > within => Verdict::TooLong { within },
                _ => Verdict::Fits,
            };
        }
        let jobs = self.site.jobs_on(line);
        let jobs = jobs.filter_map(|(_, job)| Some((job.predicted(), job.every?)));
        let (mut load, mut shortest) = (0.0, None::<Every>);
        for (time, every) in jobs {
            load += time.as_secs_f64() / every.get().as_secs_f64();
            shortest = Some(shortest.map_or(every, |shortest| shortest.min(every)));
        }
        match shortest {
            _ if load > 1.0 => Verdict::Overloaded { load },
            Some(shortest) if all > shortest.get() => Verdict::Bursts { shortest },
            _ => Verdict::Fits,
        }
    }

    fn row(&self, job: &Job) -> Vec<String> {
        let plan = job.plan();
        let every = job
            .every
            .map_or_else(|| "-".to_owned(), |every| every.to_string());
        let next = match (self.course, job.every) {
            (Course::Endless, Some(every)) => self.next(every),
            _ => "now".to_owned(),
        };
        vec![
            escape(&job.subject.to_string()),
            job.points.len().to_string(),
            plan.reads.len().to_string(),
            milliseconds(plan.cost(job.cost)),
            every,
            next,
            escape(&self.output(job)),
        ]
    }

    fn next(&self, every: Every) -> String {
        let start = Moment {
            now: Duration::ZERO,
            utc: self.now,
        };
        let wait = Schedule::new(every, start).next();
        let next = self.now.checked_add(wait).unwrap_or(Timestamp::MAX);
        next.strftime("%Y-%m-%d %H:%M:%S UTC").to_string()
    }

    fn output(&self, job: &Job) -> String {
        let output = self.site.outputs.get(job.output);
        let path = output.and_then(|output| output.path.as_ref());
        path.map_or_else(
            || "stdout".to_owned(),
            |path| path.at(&job.subject.name, self.now).display().to_string(),
        )
    }

    fn line(&self, index: usize, line: &SiteLine, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = if line.name == line.port {
            String::new()
        } else {
            format!("{}, ", line.name)
        };
        let heading = format!("{name}{} at {}", line.port, line.settings);
        writeln!(f, "{}", escape(&heading))?;
        let header = ["METER", "POINTS", "REQUESTS", "MS", "EVERY", "NEXT", "TO"];
        let rows = self.site.jobs_on(index).map(|(_, job)| self.row(job));
        writeln!(f, "{}", columns(&header, &[1, 2, 3], rows))?;
        let count = self.site.jobs_on(index).count();
        let what = counted(count as u64, "row", "rows");
        let all = milliseconds(self.together(index));
        write!(f, "{what}, {all} ms in all")?;
        match self.verdict(index) {
            Verdict::Fits => writeln!(f, ": it fits"),
            Verdict::Bursts { shortest } => writeln!(
                f,
                ": more than {shortest}, so slots are missed when all is due at once"
            ),
            Verdict::Overloaded { load } => writeln!(
                f,
                ": the intervals ask for {:.0} % of the time there is, so slots are missed",
                load * 100.0
            ),
            Verdict::TooLong { within } => writeln!(
                f,
                ": more than the deadline of {}",
                humantime::format_duration(within)
            ),
        }
    }
}

impl fmt::Display for Forecast<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, line) in self.site.lines.iter().enumerate() {
            if index > 0 {
                writeln!(f)?;
            }
            self.line(index, line, f)?;
        }
        Ok(())
    }
}

fn milliseconds(time: Duration) -> String {
    format!("{:.1}", time.as_secs_f64() * 1000.0)
}
