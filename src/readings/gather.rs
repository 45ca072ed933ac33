//! Fetches the registers of points, whatever the meter makes of the requests.
//!
//! The reads of the cheapest plan are tried first. What the unit refuses, or meets with silence
//! while it answers other reads, is asked again in parts, until only what it really does not give
//! is missing; what that teaches holds for all further reads of the unit.

use std::collections::VecDeque;

use log::info;

use super::harvest::Harvest;
use super::lesson::Lesson;
use super::memory::{Cause, Memory, Shape};
use super::{Fault, Inquiry, Trouble};
use crate::client::{Client, Failure, Patience};
use crate::codec::{ExceptionCode, Response};
use crate::profile::plan::PlannedRead;
use crate::profile::{Plan, Point};

/// A unit that leaves this many reads in a row unanswered, each after its attempts, is not asked
/// further.
const MOST_SILENT_READS: usize = 3;

/// Asks for all points of an inquiry: their registers, in the order of the points, and what went
/// wrong.
pub(super) fn gather(
    client: &mut Client,
    inquiry: &Inquiry<'_, '_>,
    memory: &mut Memory,
) -> (Vec<Result<Vec<u16>, Fault>>, Vec<Trouble>) {
    memory.begin();
    let mut gathering = Gathering {
        client,
        inquiry,
        memory,
        harvest: Harvest::of(inquiry.points.len()),
        to_come: VecDeque::new(),
        has_answered: false,
        silent: 0,
        splitting_silence: 0,
        mute: Vec::new(),
        end: None,
    };
    gathering.to_come = gathering.plan(0..inquiry.points.len()).into();
    while let Some(read) = gathering.to_come.pop_front() {
        gathering.obtain(&read);
        if gathering.end.is_some() {
            break;
        }
    }
    let fault = gathering.end.unwrap_or(Fault::Timeout);
    gathering.harvest.bring_in(fault)
}

struct Gathering<'a> {
    client: &'a mut Client,
    inquiry: &'a Inquiry<'a, 'a>,
    memory: &'a mut Memory,
    harvest: Harvest,
    /// The reads of the plan that were not tried yet.
    to_come: VecDeque<PlannedRead>,
    /// Whether the unit has answered anything this time.
    has_answered: bool,
    /// How many reads in a row it has not answered.
    silent: usize,
    /// How many of the reads that are being split just now met silence.
    splitting_silence: usize,
    /// Single points that met silence in them: they are the reason for it, if the unit is alive.
    mute: Vec<Shape>,
    /// Why the unit is not asked further.
    end: Option<Fault>,
}

/// What became of a read.
enum Outcome {
    /// Every point of it is there.
    Answered,
    /// The unit does not give this read, which can be split; nothing is told yet.
    Refused(PlannedRead, Cause),
    /// Something is missing for good, and was told.
    Lost,
}

impl Gathering<'_> {
    fn points(&self) -> &[Point] {
        self.inquiry.points
    }

    fn shape(&self, read: &PlannedRead) -> Shape {
        Shape {
            function: read.function,
            range: read.range,
            has_holes: read.has_holes(self.inquiry.points),
        }
    }

    /// The cheapest plan for some of the points, by what is known by now.
    fn plan(&self, points: impl IntoIterator<Item = usize>) -> Vec<PlannedRead> {
        let Inquiry {
            unit,
            function,
            cost,
            ..
        } = *self.inquiry;
        let cost = match self.client.answer_time(unit) {
            Some(measured) => cost.with_answer(measured),
            None => cost,
        };
        Plan::of_some(self.points(), points, function, self.memory.rules(), cost).reads
    }

    /// Asks for a read, and for its parts where the unit does not give it.
    fn obtain(&mut self, read: &PlannedRead) {
        if let Outcome::Refused(read, cause) = self.fetch(read) {
            self.split(&read, cause);
        }
    }

    /// Asks for a read. One that the unit may not answer at all, for all that is known, is not
    /// repeated when it meets silence: its parts are tried.
    fn fetch(&mut self, read: &PlannedRead) -> Outcome {
        let is_one = !read.as_wide(self.points()).is_empty();
        // Inside of what met silence every part is doubtful.
        let is_proven = self.splitting_silence == 0 && self.memory.has_answered(self.shape(read));
        let is_last = self.silent + 1 >= MOST_SILENT_READS;
        if is_last && !is_one && !is_proven {
            return self.fetch_with_care(read);
        }
        let patience = self.inquiry.patience;
        match self.ask(read, patience, is_one || is_proven) {
            Ok(registers) => self.keep(read, &registers),
            Err(failure) if is_one || is_last || !failure.is_silence() => self.fail(read, failure),
            Err(_) if self.has_answered => {
                self.silent += 1;
                Outcome::Refused(read.clone(), Cause::Silence)
            }
            Err(failure) if is_proven => self.fail(read, failure),
            Err(failure) => self.look_for_life(read, failure),
        }
    }

    /// Asks for a read that would be the last one if it met silence: first for the smallest part of
    /// it, to see whether the unit is there.
    fn fetch_with_care(&mut self, read: &PlannedRead) -> Outcome {
        // A read that no single point is as wide as has both.
        let Some((first, rest)) = read.first_and_rest(self.points()) else {
            return Outcome::Lost;
        };
        let first = self.fetch(&first);
        if self.end.is_some() {
            return Outcome::Lost;
        }
        match (first, self.fetch(&rest)) {
            (Outcome::Lost, Outcome::Answered) => Outcome::Lost,
            (_, rest) => rest,
        }
    }

    /// The first read of a unit has met silence: a single point, with the attempts that are left,
    /// tells a unit that is not there from one that does not give as much at once.
    fn look_for_life(&mut self, read: &PlannedRead, silence: Failure) -> Outcome {
        let patience = self.inquiry.patience;
        let left = patience.retries.checked_sub(1);
        let (Some(retries), Some((first, _))) = (left, read.first_and_rest(self.points())) else {
            return self.fail(read, silence);
        };
        let patience = Patience {
            retries,
            ..patience
        };
        match self.ask(&first, patience, true) {
            Ok(registers) => {
                self.keep(&first, &registers);
            }
            // The attempts at both are told as attempts at the read.
            Err(failure) if failure.is_silence() => return self.fail(read, failure),
            Err(failure) => {
                self.fail(&first, failure);
            }
        }
        Outcome::Refused(read.clone(), Cause::Silence)
    }

    fn ask(
        &mut self,
        read: &PlannedRead,
        patience: Patience,
        is_sure: bool,
    ) -> Result<Vec<u16>, Failure> {
        let unit = self.inquiry.unit;
        info!("unit {unit}: reading {}", read.range);
        // A point that one function reads is not read by the other.
        let mut points = read
            .points
            .iter()
            .filter_map(|index| self.points().get(*index));
        let is_free = points.all(|point| point.function.is_none());
        let mut patience = patience;
        patience.ways.interchangeable_reads &= is_free;
        let request = read.request();
        let response = if is_sure {
            self.client.request(unit, &request, patience)
        } else {
            self.client.try_request(unit, &request, patience)
        };
        match response? {
            Response::Registers { values, .. } => Ok(values.into_vec()),
            // The client believes only what answers the request, and a read is answered by
            // registers.
            other => Err(Failure::Mismatch {
                found: format!("{other:?}"),
            }),
        }
    }

    fn keep(&mut self, read: &PlannedRead, registers: &[u16]) -> Outcome {
        self.harvest.keep(self.inquiry.points, read, registers);
        self.memory.answered(self.shape(read));
        self.hear();
        Outcome::Answered
    }

    /// The unit is alive.
    fn hear(&mut self) {
        self.has_answered = true;
        self.silent = 0;
        for read in std::mem::take(&mut self.mute) {
            let lessons = self.memory.learn_of_one(read, Cause::Silence);
            self.heed(&lessons);
        }
    }

    /// A read brought nothing, and asking again would not help.
    fn fail(&mut self, read: &PlannedRead, failure: Failure) -> Outcome {
        if let Failure::Exception(code) = failure
            && code != ExceptionCode::GATEWAY_TARGET_DEVICE_FAILED_TO_RESPOND
        {
            self.hear();
            return self.refused(read, code);
        }
        let fault = Fault::from(&failure);
        match fault {
            Fault::Port => self.end = Some(fault),
            // The only exception that comes this far is a gateway's, for a unit that is silent.
            Fault::Timeout | Fault::Exception(_) => {
                self.silent += 1;
                if !self.has_answered || self.silent >= MOST_SILENT_READS {
                    self.end = Some(fault);
                } else if self.splitting_silence > 0 && failure.is_silence() {
                    self.mute.push(self.shape(read));
                }
            }
            _ => self.silent = 0,
        }
        self.harvest.lose(&read.points, fault);
        let untried = match self.end {
            Some(_) => self.plan(self.harvest.missing()).len(),
            None => 0,
        };
        self.harvest.tell(Trouble::Unread {
            read: read.clone(),
            failure,
            is_alive: self.has_answered,
            untried,
        });
        Outcome::Lost
    }

    /// The meter refused a read. What can be asked for in smaller parts is not lost yet.
    fn refused(&mut self, read: &PlannedRead, code: ExceptionCode) -> Outcome {
        let is_about_registers = matches!(
            code,
            ExceptionCode::ILLEGAL_DATA_ADDRESS | ExceptionCode::ILLEGAL_DATA_VALUE
        );
        let lost = if is_about_registers {
            read.as_wide(self.points())
        } else {
            read.points.clone()
        };
        self.harvest.lose_refused(&lost, code);
        if is_about_registers && !lost.is_empty() {
            let lessons = self.memory.learn_of_one(self.shape(read), Cause::Exception);
            self.heed(&lessons);
        }
        if lost.len() < read.points.len() {
            Outcome::Refused(read.clone(), Cause::Exception)
        } else {
            Outcome::Lost
        }
    }

    /// Asks for the parts of a read that the unit did not give: for all of them first, then for the
    /// parts of those that it did not give either.
    fn split(&mut self, read: &PlannedRead, cause: Cause) {
        let what = match cause {
            Cause::Exception => "were refused",
            Cause::Silence => "met silence",
        };
        let unit = self.inquiry.unit;
        info!(
            "unit {unit}: registers {} {what}, asking for parts",
            read.range
        );
        let shape = self.shape(read);
        let left = self.harvest.missing_of(read);
        // A rule that was learned since makes better parts.
        let holes = read.holes(self.points());
        let is_explained = !self.memory.allows(shape, &holes);
        let parts = if is_explained {
            self.plan(left)
        } else {
            read.pieces(self.points(), &left)
        };
        self.splitting_silence += usize::from(cause == Cause::Silence);
        let mut refused = Vec::new();
        for part in &parts {
            if let Outcome::Refused(part, cause) = self.fetch(part) {
                refused.push((part, cause));
            }
            if self.end.is_some() {
                return;
            }
        }
        if !is_explained && self.harvest.has_all(read) {
            let lessons = self.memory.learn_from_parts(shape, &holes, cause);
            self.heed(&lessons);
        }
        for (part, cause) in refused {
            self.split(&part, cause);
            if self.end.is_some() {
                return;
            }
        }
        self.splitting_silence -= usize::from(cause == Cause::Silence);
    }

    /// Says what was learned, and plans by it what is still to come.
    fn heed(&mut self, lessons: &[Lesson]) {
        for lesson in lessons {
            info!("unit {}: {lesson}", self.inquiry.unit);
        }
        let to_come = std::mem::take(&mut self.to_come);
        let points = to_come.into_iter().flat_map(|read| read.points);
        self.to_come = self.plan(points).into();
    }
}
