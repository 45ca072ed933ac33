//! `execute-operation`: what a meter is told to do, by which function, and what is said of it.

#![cfg(unix)]

mod support {
    pub(crate) mod program;
    pub(crate) mod pty;
    pub(crate) mod simulation;
    pub(crate) mod writable;
}

use std::thread;

use support::program::Program;
use support::pty::PtyMeter;
use support::simulation::Simulation;
use support::writable::{behaviour, came_to, meter, refuse, run, sealed, writes};

/// A run without a port: the frames in hex.
#[track_caller]
fn frames(arguments: &str, expected: &str) {
    Program::new(&format!("execute-operation --dry-run {arguments}"))
        .stdout(expected)
        .run();
}

#[test]
fn a_name_and_a_number_are_the_same_operation() {
    for name in ["clear_energy", "14", "0x0E"] {
        frames(
            &format!("-a 17 --meter pqm {name}"),
            "11 05 00 0E FF 00 EF 69\n",
        );
    }
}

#[test]
fn function_16_writes_the_code_the_operation_and_what_goes_with_it() {
    frames(
        "-a 17 --meter pqm clear_energy --function 16",
        "11 10 00 80 00 02 04 00 05 00 0E 3E CA\n",
    );
    // 13:27:10.015.
    frames(
        "-a 17 --meter pqm set_clock_time 13:27:10.015",
        "11 10 00 80 00 04 08 00 05 00 0A 0D 1B 27 1F 41 9A\n",
    );
    frames(
        "-a 17 --meter pqm set_clock_date 1997-10-29",
        "11 10 00 80 00 04 08 00 05 00 0B 0A 1D 07 CD 04 B2\n",
    );
}

#[test]
fn the_others_have_a_register_for_each() {
    frames(
        "-a 1 --meter em24 reset_partial_meters",
        "01 06 30 02 00 01 E6 CA\n",
    );
    frames(
        "-a 1,2 --meter em21 reset_all_meters",
        "01 06 30 00 00 01 47 0A\n02 06 30 00 00 01 47 39\n",
    );
}

#[test]
fn the_list_tells_what_is_hazardous() {
    Program::new("execute-operation --meter em21 --list")
        .stdout(
            "OPERATION         TOLD BY   TAKES  HAZARD\n\
             reset_all_meters  0x3000=1         sets all energy counters to zero\n",
        )
        .run();
    let output = Program::new("execute-operation --meter pqm --list").output();
    let list = String::from_utf8(output.stdout).expect("UTF-8");
    assert_eq!(list.lines().count(), 1 + 35, "{list}");
    assert!(list.contains("\nclear_energy "), "{list}");
}

#[test]
fn what_was_told_is_done() {
    let simulation = Simulation::new("--meter pqm=17 --meter em24=1 --meter pm290=2 -v");
    let path = &simulation.path;
    for (unit, name, about, meter) in [
        (17, "14", "clear_energy: clears the energy counters", "pqm"),
        (
            1,
            "reset_partial_meters",
            "reset_partial_meters: sets the partial meters to zero",
            "em24",
        ),
    ] {
        let command = format!("execute-operation -a {unit} --meter {meter} --yes {name}");
        let (name, _) = about.split_once(':').expect("a name");
        let told = run(path, &command);
        let stdout =
            format!("# {meter} unit {unit} on PORT at 115200 8N1\n{about}\n{name}: done\n");
        came_to(&told, 0, &stdout, "");
    }
    let command = "execute-operation -a 17 --meter pqm set_clock_time now";
    let told = run(path, command);
    assert_eq!((told.code, told.stderr.as_str()), (Some(0), ""), "{told:?}");
    let energy = run(
        path,
        "read-registers -q -a 1 --meter em24 -f csv --layout long energy_active_import_partial",
    );
    // It counts on from zero.
    let cells: Vec<&str> = energy
        .stdout
        .lines()
        .last()
        .expect("a row")
        .split(',')
        .collect();
    let energy: f64 = cells[4].parse().expect("a number");
    assert!((0.0..100.0).contains(&energy), "{cells:?}");
    let told = simulation.stop("INT").stderr;
    for heard in [
        "asked: unit 17, function 05 (Write Single Coil) 0x000E on\n",
        "asked: unit 1, function 06 (Write Single Register) 0x3002: 0001\n",
        "asked: unit 17, function 16 (Write Multiple Registers) 0x0080: 0005 000A",
    ] {
        assert_eq!(told.matches(heard).count(), 1, "{told}");
    }
}

const COMMAND: &str = "execute-operation -a 17 --meter pqm --timeout 200ms --yes clear_energy";

const SHOWN: &str =
    "# pqm unit 17 on PORT at 115200 8N1\nclear_energy: clears the energy counters\n";

/// Register 0 says what meter it is.
const HELD: [(u16, u16); 1] = [(0, 65)];

#[test]
fn an_operation_that_is_not_confirmed_is_not_told_again() {
    let other = sealed(&[17, 5, 0, 15, 0xFF, 0]);
    let cases = [
        (Vec::new(), "no answer within 200ms"),
        (
            other,
            "the unit answered something else: 0x000F written, and 0x000E was sent",
        ),
    ];
    thread::scope(|scope| {
        for (answer, found) in cases {
            scope.spawn(move || {
                let meter = meter(&HELD, move |_, _| answer.clone());
                let told = run(meter.path(), COMMAND);
                let text = format!(
                    "error: unit 17 on PORT at 115200 8N1, clear_energy: outcome unknown, it may be \
                     done or not: {found}\n\
                     hint: it cannot be read back: see what the meter shows before it is done again\n"
                );
                came_to(&told, 6, SHOWN, &text);
                assert_eq!(writes(&meter), ["11 05 00 0E FF 00"]);
            });
        }
    });
}

#[test]
fn an_operation_that_is_refused_was_told_once() {
    let meter = meter(&HELD, |frame, _| refuse(frame, 4));
    let told = run(meter.path(), COMMAND);
    came_to(
        &told,
        5,
        SHOWN,
        "error: unit 17 on PORT at 115200 8N1, clear_energy: the meter refused: exception 04 (SERVER \
         DEVICE FAILURE)\n\
         hint: the meter itself failed: its display or its manual may say why\n",
    );
    assert_eq!(writes(&meter), ["11 05 00 0E FF 00"]);
}

#[test]
fn the_echo_of_an_operation_is_no_confirmation() {
    let mut read = behaviour(&HELD, |_, _| Vec::new());
    let meter = PtyMeter::new(Box::new(move |frame| {
        [frame.to_vec(), read(frame)].concat()
    }));
    let told = run(meter.path(), COMMAND);
    assert_eq!(told.code, Some(6), "{told:?}");
    let found = "outcome unknown, it may be done or not: nothing but the echo of the own request \
                 came back\n";
    assert!(told.stderr.contains(found), "{told:?}");
    assert_eq!(writes(&meter), ["11 05 00 0E FF 00"]);
}
