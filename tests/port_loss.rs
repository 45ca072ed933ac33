//! The program on a port that goes away: which rows are lost, and how it goes on when the port comes
//! back. As with an adapter on USB, the name stays and what is behind it changes.

#![cfg(unix)]

mod support {
    pub(crate) mod program;
    pub(crate) mod pty;
    pub(crate) mod run;
    pub(crate) mod waiting;
}

use std::cmp::Ordering;
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::time::{Duration, Instant};

use support::pty::{self, PtyMeter};
use support::run::Run;
use support::waiting::wait_until;

const HEADER: &str = "time,meter,unit_id,status,0x0005\n";

/// A port is waited for a minute, a late answer to what it was lost over for a second.
const PATIENCE: &str = "-t 500ms --retries 100";

const HINT: &str = "hint: the adapter was unplugged, or the other side hung up; /dev/serial/by-id \
                    has a name that stays when it comes back\n";

/// The lasting name of a port.
struct Name(PathBuf);

impl Name {
    /// A name for the meter's line; each test has its own.
    fn of(name: &str, meter: &PtyMeter) -> Self {
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("ports");
        fs::create_dir_all(&folder).expect("the folder for tests is writable");
        let name = Self(folder.join(name));
        name.lead_to(meter);
        name
    }

    /// From now on it is the name of this meter's line, without a moment in between.
    fn lead_to(&self, meter: &PtyMeter) {
        let new = self.0.with_extension("new");
        let _ = fs::remove_file(&new);
        std::os::unix::fs::symlink(meter.path(), &new).expect("a link can be made");
        fs::rename(&new, &self.0).expect("a link can be renamed");
    }

    /// From now on it is nobody's name.
    fn vanish(&self) {
        fs::remove_file(&self.0).expect("it is there");
    }

    fn text(&self) -> String {
        self.0.display().to_string()
    }
}

/// All units at once: register 5 holds 38 in each of them.
fn everybody(request: &[u8]) -> Vec<u8> {
    pty::answer(u16::from(request[0]), request).unwrap_or_default()
}

fn healthy() -> PtyMeter {
    PtyMeter::new(Box::new(everybody))
}

/// Answers the requests before this one, counted from 1, and of the answer to it so many bytes.
fn faltering_at(number: usize, bytes: usize) -> PtyMeter {
    let mut count = 0;
    PtyMeter::new(Box::new(move |request| {
        count += 1;
        let mut answer = everybody(request);
        match number.cmp(&count) {
            Ordering::Greater => {}
            Ordering::Equal => answer.truncate(bytes),
            Ordering::Less => answer.clear(),
        }
        answer
    }))
}

/// The units that were asked, in order.
fn asked(meter: &PtyMeter) -> Vec<u8> {
    let requests = meter.requests();
    requests.iter().map(|request| request[0]).collect()
}

/// Runs the cases of a test at once: they wait most of their time.
fn at_once<T: Copy + Send, const N: usize>(cases: [T; N], test: impl Fn(T) + Sync) {
    std::thread::scope(|scope| {
        for case in cases {
            let test = &test;
            scope.spawn(move || test(case));
        }
    });
}

fn was_lost(unit: u8, name: &Name) -> String {
    let port = name.text();
    format!(
        "error: unit {unit} on {port} at 9600 8N1, registers 0x0005+1: port {port} was lost\n  \
         because: Broken pipe\n{HINT}"
    )
}

fn did_not_come_back(unit: u8, name: &Name, within: &str) -> String {
    let port = name.text();
    format!(
        "error: unit {unit} on {port} at 9600 8N1, registers 0x0005+1: port {port} did not come \
         back within {within}\n  because: port {port} is not there\n"
    )
}

#[test]
fn a_port_that_is_lost_once_a_row_is_out_is_opened_again() {
    // Before the second request, which comes after a pause; on a loaded machine after it, and then it
    // has met silence.
    let mut first = faltering_at(2, 0);
    let second = healthy();
    let name = Name::of("idle", &first);
    let port = name.text();
    let mut run = Run::start(&format!(
        "read-registers -p {port} -a 1-4 5 -f csv {PATIENCE} --pause 400ms"
    ));
    run.wait_for_lines(2);
    name.lead_to(&second);
    first.hang_up();
    let rows = "<time>,,1,ok,38\n<time>,,2,port,\n<time>,,3,ok,38\n<time>,,4,ok,38\n";
    run.ends(1, &format!("{HEADER}{rows}"), &was_lost(2, &name));
    assert_eq!(asked(&second), [3, 4]);
}

#[test]
fn a_port_that_is_lost_before_an_answer_or_in_the_middle_of_one_is_opened_again() {
    at_once([0, 1, 4], |bytes| {
        let mut first = faltering_at(2, bytes);
        let second = healthy();
        let name = Name::of(&format!("waiting{bytes}"), &first);
        let port = name.text();
        let run = Run::start(&format!(
            "read-registers -p {port} -a 1-4 5 -f csv {PATIENCE}"
        ));
        wait_until(|| first.has_answered(2));
        name.lead_to(&second);
        first.hang_up();
        let rows = "<time>,,1,ok,38\n<time>,,2,port,\n<time>,,3,ok,38\n<time>,,4,ok,38\n";
        run.ends(1, &format!("{HEADER}{rows}"), &was_lost(2, &name));
        // What the port was lost over is not asked again, once it was lost.
        assert_eq!(asked(&first)[..2], [1, 2]);
        assert_eq!(asked(&second), [3, 4]);
    });
}

#[test]
fn a_port_that_comes_back_after_a_while_is_waited_for_and_told_with_v() {
    let mut first = faltering_at(1, 0);
    let second = healthy();
    let name = Name::of("later", &first);
    let port = name.text();
    let mut run = Run::start(&format!(
        "read-registers -p {port} -a 1,2 5 -f csv {PATIENCE} -vv"
    ));
    let mut said = BufReader::new(run.child.stderr.take().expect("it is piped")).lines();
    wait_until(|| first.has_answered(1));
    name.vanish();
    first.hang_up();
    let mut next = || said.next().expect("a line").expect("text");
    while next() != format!("port {port}: trying to open it again") {}
    // It was looked for at least once when the name leads somewhere again.
    let missing = format!("not opened again: port {port} is not there");
    assert_eq!(next(), missing);
    name.lead_to(&second);
    let mut line = next();
    while line == missing {
        line = next();
    }
    assert_eq!(line, "opened again");
    let back = next();
    let away = back
        .strip_prefix(&format!("port {port} is back after "))
        .and_then(|rest| rest.strip_suffix(" ms"))
        .expect(&back);
    assert!(away.parse::<u64>().is_ok_and(|away| away >= 50), "{back}");
    for line in said {
        line.expect("text");
    }
    let rows = "<time>,,1,port,\n<time>,,2,ok,38\n";
    run.ends(1, &format!("{HEADER}{rows}"), "");
}

#[test]
fn a_port_that_does_not_come_back_is_waited_for_once() {
    let mut first = faltering_at(1, 0);
    let name = Name::of("never", &first);
    let port = name.text();
    let start = Instant::now();
    let run = Run::start(&format!(
        "read-registers -p {port} -a 1-4 5 -f csv -t 1s --retries 1"
    ));
    wait_until(|| first.has_answered(1));
    name.vanish();
    first.hang_up();
    let rows = "<time>,,1,port,\n<time>,,2,port,\n<time>,,3,port,\n<time>,,4,port,\n";
    let stderr = was_lost(1, &name) + &did_not_come_back(2, &name, "2s");
    let untried = "error: 2 more units were not tried\n";
    run.ends(3, &format!("{HEADER}{rows}"), &(stderr + untried));
    assert!(start.elapsed() >= Duration::from_secs(2));
}

#[test]
fn what_was_read_before_the_port_was_lost_stays_and_the_exit_code_is_1() {
    let mut first = faltering_at(3, 5);
    let name = Name::of("stays", &first);
    let port = name.text();
    let run = Run::start(&format!(
        "read-registers -p {port} -a 1,2 0x10 0x20 0x30 0x40 -f csv -t 300ms --retries 9"
    ));
    wait_until(|| first.has_answered(3));
    name.vanish();
    first.hang_up();
    let stdout = "time,meter,unit_id,status,0x0010,0x0020,0x0030,0x0040\n\
                  <time>,,1,port,115,227,,\n<time>,,2,port,,,,\n";
    let at = |unit| format!("error: unit {unit} on {port} at 9600 8N1, registers");
    let stderr = format!(
        "{} 0x0030+1: port {port} was lost; 1 more read of this unit was not tried\n  \
         because: Broken pipe\n{HINT}\
         {} 0x0010+1: port {port} did not come back within 3s; 3 more reads of this unit were not \
         tried\n  because: port {port} is not there\n",
        at(1),
        at(2)
    );
    run.ends(1, stdout, &stderr);
}

#[test]
fn a_port_that_somebody_else_takes_meanwhile_is_not_shared() {
    let mut first = faltering_at(1, 0);
    let second = healthy();
    let taken = serialport::new(second.path(), 9600).open();
    let name = Name::of("taken", &first);
    let port = name.text();
    let run = Run::start(&format!(
        "read-registers -p {port} -a 1,2 5 -f csv -t 1s --retries 1 -q"
    ));
    wait_until(|| first.has_answered(1));
    name.lead_to(&second);
    first.hang_up();
    let end = run.end();
    let stderr = &end.stderr;
    assert!(
        stderr.contains(&format!(
            "port {port} did not come back within 2s\n  because: port {port} is in use by "
        )),
        "{stderr}"
    );
    assert_eq!(end.code, Some(3));
    assert_eq!(second.requests().len(), 0);
    drop(taken);
}

#[test]
fn a_meter_is_verified_on_as_soon_as_the_port_is_back() {
    at_once([true, false], |comes_back| {
        let mut first = faltering_at(1, 0);
        let second = healthy();
        let name = Name::of(&format!("verify{comes_back}"), &first);
        let port = name.text();
        let run = Run::start(&format!(
            "meters verify em21 -p {port} -a 1-4 -t 1s --retries 1 -q"
        ));
        wait_until(|| first.has_answered(1));
        if comes_back {
            name.lead_to(&second);
        } else {
            name.vanish();
        }
        first.hang_up();
        let end = run.end();
        let stderr = &end.stderr;
        let count = |what: &str| stderr.matches(what).count();
        assert_eq!(count("was lost"), 1, "{stderr}");
        assert_eq!(count("did not come back"), usize::from(!comes_back));
        assert_eq!(
            stderr.ends_with("error: 2 more units were not tried\n"),
            !comes_back,
            "{stderr}"
        );
        // The units that were asked at all.
        let mut units = asked(&second);
        units.dedup();
        assert_eq!(units, if comes_back { vec![2, 3, 4] } else { vec![] });
        assert_eq!(end.code, Some(if comes_back { 1 } else { 3 }));
    });
}
