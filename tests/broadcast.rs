//! `broadcast`: heard by all meters, answered by none, sent once.

#![cfg(unix)]

mod support {
    pub(crate) mod program;
    pub(crate) mod pty;
    pub(crate) mod simulation;
    pub(crate) mod writable;
}

use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use support::program::Program;
use support::pty::PtyMeter;
use support::simulation::Simulation;
use support::writable::{came_to, run, writes};

/// A run without a port: the frames in hex.
#[track_caller]
fn frames(arguments: &str, expected: &str) {
    Program::new(&format!("broadcast --dry-run {arguments}"))
        .stdout(expected)
        .run();
}

#[test]
fn the_clock_of_a_pqm_is_set_by_the_frame_of_its_manual() {
    let clock = "--meter pqm clock=1997-10-29T13:27:10.015";
    frames(
        clock,
        "00 10 00 F0 00 04 08 0D 1B 27 1F 0A 1D 07 CD 9D 8D\n",
    );
    // And by two, as the manual has it too.
    frames(
        &format!("{clock} --one-by-one"),
        "00 10 00 F0 00 02 04 0D 1B 27 1F D0 84\n00 10 00 F2 00 02 04 0A 1D 07 CD 29 B5\n",
    );
    frames("--meter pqm clear_all_demand", "00 05 00 22 FF 00 2D E1\n");
}

#[test]
fn what_no_profile_allows_goes_out_by_force() {
    frames("--force 0x0010=5", "00 06 00 10 00 05 49 DD\n");
    // Of the functions that write registers a PQM obeys 16 alone.
    frames(
        "--force --meter pqm ct_primary=200",
        "00 10 10 50 00 01 02 00 C8 B7 C7\n",
    );
}

#[test]
fn every_meter_on_the_line_holds_what_was_sent() {
    let simulation = Simulation::new("--meter em24=1,2 -v");
    // Far more than anybody waits for who waits for an answer.
    let told = run(
        &simulation.path,
        "broadcast --timeout 60s --meter em24 demand_interval=20 --verify-units 1,2",
    );
    came_to(
        &told,
        0,
        "# all meters on PORT at 115200 8N1\n\
         demand_interval: 20 min\n\
         sent to all meters on PORT at 115200 8N1\n\
         unit 1: demand_interval is 20 min\n\
         unit 2: demand_interval is 20 min\n",
        "",
    );
    let ended = simulation.stop("INT");
    let heard = "asked: all units, function 06 (Write Single Register) 0x1103: 0014";
    assert_eq!(ended.stderr.matches(heard).count(), 1, "{}", ended.stderr);
}

#[test]
fn the_clocks_of_all_meters_are_set() {
    let simulation = Simulation::new("--meter pqm=17,18");
    let told = run(
        &simulation.path,
        "broadcast --meter pqm clock=2026-03-04T05:06:07.000 --verify-units 17,18",
    );
    assert_eq!((told.code, told.stderr.as_str()), (Some(0), ""), "{told:?}");
    for unit in [17, 18] {
        let line = format!("unit {unit}: broadcast_date is 2026-03-04\n");
        assert!(told.stdout.contains(&line), "{told:?}");
        let begin = format!("unit {unit}: broadcast_time is 05:06:");
        assert!(told.stdout.contains(&begin), "{told:?}");
    }
}

/// A meter that notes when it heard what, and answers nothing.
struct Listener {
    meter: PtyMeter,
    heard: Arc<Mutex<Vec<Instant>>>,
}

impl Listener {
    fn new() -> Self {
        let heard: Arc<Mutex<Vec<Instant>>> = Arc::default();
        let times = Arc::clone(&heard);
        let meter = PtyMeter::new(Box::new(move |_| {
            times.lock().expect("nobody panicked").push(Instant::now());
            Vec::new()
        }));
        Self { meter, heard }
    }
}

#[test]
fn nobody_is_waited_for_but_the_turnaround_is_kept_each_time() {
    let listener = Listener::new();
    let turnaround = Duration::from_millis(300);
    let start = Instant::now();
    let told = run(
        listener.meter.path(),
        "broadcast --timeout 60s --turnaround 300ms --meter pqm --one-by-one \
         clock=1997-10-29T13:27:10.015",
    );
    let took = start.elapsed();
    came_to(
        &told,
        0,
        "# all meters on PORT at 115200 8N1\n\
         clock: 1997-10-29 13:27:10.015\n\
         sent to all meters on PORT at 115200 8N1\n",
        "",
    );
    assert!(took >= 2 * turnaround, "{took:?}");
    assert!(took < Duration::from_secs(60), "{took:?}");
    assert_eq!(
        writes(&listener.meter),
        [
            "00 10 00 F0 00 02 04 0D 1B 27 1F",
            "00 10 00 F2 00 02 04 0A 1D 07 CD"
        ]
    );
    let heard = listener.heard.lock().expect("nobody panicked").clone();
    let between = heard[1].duration_since(heard[0]);
    // Whoever listens may be held up, by less than that.
    assert!(between > turnaround / 3, "{between:?}");
}

#[test]
fn a_broadcast_that_is_answered_all_the_same_is_not_repeated() {
    for answer in [vec![0, 0x86, 6, 0xC3, 0xA2], vec![0x55; 40]] {
        let meter = PtyMeter::new(Box::new(move |_| answer.clone()));
        let told = run(meter.path(), "broadcast -q --meter em24 demand_interval=5");
        came_to(&told, 0, "", "");
        assert_eq!(writes(&meter), ["00 06 11 03 00 05"]);
    }
}

#[test]
fn a_meter_that_has_not_taken_it_is_named() {
    let meter = PtyMeter::holding(&[1], &[(0x1103, 15)]);
    let told = run(
        meter.path(),
        "broadcast --meter em24 demand_interval=5 --verify-units 1,2 --timeout 200ms",
    );
    came_to(
        &told,
        6,
        "# all meters on PORT at 115200 8N1\n\
         demand_interval: 5 min\n\
         sent to all meters on PORT at 115200 8N1\n",
        "error: unit 1 on PORT at 115200 8N1, demand_interval: was sent, and the meter holds 15 min\n\
         error: unit 2 on PORT at 115200 8N1, demand_interval (registers 0x1103+1): no answer within \
         200ms, 3 attempts\n\
         hint: check --unit, --baud, --parity and --stop-bits against the meter, then power and \
         wiring (A and B swapped?); a slow meter needs a longer --timeout\n\
         error: unit 2 on PORT at 115200 8N1, demand_interval: was sent, and could not be read \
         (timeout)\n",
    );
    assert_eq!(writes(&meter), ["00 06 11 03 00 05"]);
}

#[test]
fn a_port_that_is_lost_meanwhile_leaves_the_outcome_unknown() {
    let meter = PtyMeter::hanging_up(Box::new(|_| Vec::new()), 1);
    let told = run(
        meter.path(),
        "broadcast --turnaround 60s --meter em24 demand_interval=5",
    );
    assert_eq!(told.code, Some(6), "{told:?}");
    let begin = "error: all meters on PORT at 115200 8N1: outcome unknown: port PORT was lost\n";
    assert!(told.stderr.starts_with(begin), "{told:?}");
    let end = "hint: read each meter to see what it holds; nothing is sent again\n";
    assert!(told.stderr.ends_with(end), "{told:?}");
    assert_eq!(writes(&meter), ["00 06 11 03 00 05"]);
}

#[test]
fn a_point_of_two_registers_is_warned_of_where_it_goes_in_two_requests() {
    let meter = PtyMeter::new(Box::new(|_| Vec::new()));
    let told = run(meter.path(), "broadcast -q --meter em24 ct_ratio=40.0");
    came_to(
        &told,
        0,
        "",
        "warning: ct_ratio goes in 2 requests, low word first, for function 6 writes one register at a \
         time: in between the meter holds half of it\n",
    );
    assert_eq!(writes(&meter), ["00 06 11 2C 01 90", "00 06 11 2D 00 00"]);
}
