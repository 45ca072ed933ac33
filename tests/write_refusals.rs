//! What is refused before anything is sent: one clear sentence, exit code 2, and not one byte on the
//! line.

#![cfg(unix)]

mod support {
    pub(crate) mod program;
    pub(crate) mod pty;
    pub(crate) mod writable;
}

use support::pty::pair;
use support::writable::{came_to, run};

/// Runs a command on a line whose other end counts bytes.
#[track_caller]
fn refused(command: &str, stderr: &str) {
    let (master, _slave, path) = pair().expect("a pty pair");
    let told = run(&path, command);
    came_to(&told, 2, "", stderr);
    let waiting = rustix::io::ioctl_fionread(&master).expect("the line is open");
    assert_eq!(waiting, 0, "{command}");
}

#[test]
fn a_value_that_the_point_cannot_have() {
    for (what, problem) in [
        (
            "ct_primary=99999",
            "ct_primary: 99999 is not within 0 to 12000",
        ),
        ("ct_primary=-1", "ct_primary: -1 is not within 0 to 12000"),
        (
            "ct_primary=200.5",
            "ct_primary: 200.5 is no multiple of 5: the nearest are 200 and 205",
        ),
        (
            "ct_primary=",
            "ct_primary: '' is not a number, or one of off",
        ),
        (
            "vt_wiring=nonsense",
            "vt_wiring: 'nonsense' is not a number, or one of off, 4-wire wye with 3 VTs, 4-wire wye \
             direct, 4-wire wye with 2 VTs, 3-wire delta with 2 VTs, 3-wire direct, single phase direct",
        ),
        ("current_a=5", "current_a can only be read"),
        ("0x0240=5", "current_a can only be read"),
        (
            "ct_primary=5 ct_primary=6",
            "ct_primary is given two values",
        ),
    ] {
        let command = format!("write-setpoint -a 17 --meter pqm --yes {what}");
        refused(&command, &format!("error: {problem}\n"));
    }
    for (what, problem) in [
        ("ct_ratio=0.5", "ct_ratio: 0.5 is not within 1.0 to 60000.0"),
        (
            "ct_ratio=40.05",
            "ct_ratio: 40.05 is between two steps: the nearest are 40.0 and 40.1",
        ),
    ] {
        let command = format!("write-setpoint -a 1 --meter em24 --yes {what}");
        refused(&command, &format!("error: {problem}\n"));
    }
}

#[test]
fn registers_by_address_that_cannot_hold_it_or_are_given_twice() {
    for (what, problem) in [
        ("0x0010=65536", "0x0010: 65536 is not within 0 to 65535"),
        ("0x0010=5 16=6", "0x0010 is given two values"),
        (
            "0x0010:u32=5 0x0011=6",
            "0x0010 and 0x0011 are values for the same registers",
        ),
        ("--numbering modicon 30001=5", "30001 can only be read"),
    ] {
        let command = format!("write-setpoint -a 17 {what}");
        refused(&command, &format!("error: {problem}\n"));
    }
}

#[test]
fn what_is_no_point_with_a_value() {
    for (what, problem) in [
        (
            "ct_primari=5",
            "pqm has no point 'ct_primari'; did you mean ct_primary, ct_wiring?",
        ),
        (
            "ct_*=5",
            "'ct_*' is more than one point, and each has a value of its own\n\
             hint: name each point with its value, such as tariff_1_cost=1 tariff_2_cost=1",
        ),
        (
            "ct_primary",
            "'ct_primary' is no NAME=VALUE\n\
             hint: values are written ct_primary=200 or 0x1028=500",
        ),
        (
            "broadcast_time=13:27:10.015",
            "broadcast_time is written to all meters at once, and to none by itself\n\
             hint: `meterpoll broadcast` writes it",
        ),
    ] {
        let command = format!("write-setpoint -a 17 --meter pqm {what}");
        refused(&command, &format!("error: {problem}\n"));
    }
    refused(
        "write-setpoint -a 17 0x0010+2=5",
        "error: '0x0010+2' is more than one point, and each has a value of its own\n\
         hint: name each point with its value, such as tariff_1_cost=1 tariff_2_cost=1\n",
    );
}

#[test]
fn unit_0_anywhere_in_a_list() {
    for command in [
        "write-setpoint -a 0 0x0010=5",
        "write-setpoint -a 17,0 0x0010=5",
        "execute-operation -a 17,0 --meter pqm clear_energy --yes",
        "read-status -a 0",
        "broadcast --meter em24 demand_interval=5 --verify-units 0",
    ] {
        refused(
            command,
            "error: unit 0 is the broadcast address, which no meter answers\n\
             hint: meters are 1 to 247; `meterpoll broadcast` writes to all of them at once\n",
        );
    }
}

/// So many registers, each by itself.
fn registers(start: u16, count: u16) -> String {
    let names: Vec<String> = (start..start + count)
        .map(|address| format!("0x{address:04X}=1"))
        .collect();
    names.join(" ")
}

#[test]
fn more_registers_than_a_request_or_the_meter_takes() {
    refused(
        &format!("write-setpoint -a 17 {}", registers(0x1000, 124)),
        "error: 124 registers at once from 0x1000 on, and the standard takes 123\n\
         hint: write them in several calls\n",
    );
    // Somewhere the meter has no points of its own.
    refused(
        &format!("write-setpoint -a 17 --meter pqm {}", registers(0xE000, 61)),
        "error: 61 registers at once from 0xE000 on, and pqm takes 60\n\
         hint: write them in several calls\n",
    );
}

#[test]
fn a_function_that_the_meter_does_not_have() {
    for command in [
        "write-setpoint -a 1 --meter em24 --yes --function 16 ct_ratio=40.0",
        "broadcast --meter em24 --function 16 demand_interval=5",
    ] {
        refused(
            command,
            "error: em24 does not have function 16 (Write Multiple Registers)\n\
             hint: leave --function out: the meter's own is taken\n",
        );
    }
    refused(
        "read-status -a 1 --meter em24",
        "error: em24 does not answer function 07\n\
         hint: without --meter it is sent all the same, and the meter may refuse it\n",
    );
}

#[test]
fn what_is_hazardous_without_a_terminal_and_without_yes() {
    for (command, problem) in [
        (
            "write-setpoint -a 3 --meter em21 rs485_address=9",
            "rs485_address changes the address that the meter answers on",
        ),
        (
            "execute-operation -a 17 --meter pqm clear_energy",
            "clear_energy sets the energy counters to zero",
        ),
        (
            "broadcast --meter pqm clear_all_demand",
            "clear_all_demand forgets all demands",
        ),
    ] {
        refused(
            command,
            &format!(
                "error: {problem}, and there is no terminal to ask at; nothing was sent\n\
                 hint: --yes says that it is meant\n"
            ),
        );
    }
}

#[test]
fn a_broadcast_that_reads() {
    for (command, name) in [
        ("broadcast --meter pqm ct_primary", "ct_primary"),
        (
            "broadcast --meter em24 voltage_l1_n demand_interval=5",
            "voltage_l1_n",
        ),
        ("broadcast current_a", "current_a"),
    ] {
        refused(
            command,
            &format!(
                "error: '{name}' has no value, and a broadcast reads nothing: nobody answers it\n\
                 hint: give points and values, NAME=VALUE, or the name of one operation\n"
            ),
        );
    }
}

#[test]
fn a_broadcast_that_the_meter_does_not_obey() {
    for name in ["clear_energy", "ct_primary=200"] {
        let (point, _) = name.split_once('=').unwrap_or((name, ""));
        refused(
            &format!("broadcast --meter pqm --yes {name}"),
            &format!(
                "error: the manual of pqm does not say that {point} can be broadcast\n\
                 hint: --force sends it all the same; --verify-units shows which meters have taken \
                 it\n"
            ),
        );
    }
    refused(
        "broadcast 0x0010=5",
        "error: without a meter nothing tells what may be broadcast\n\
         hint: name the meter with --meter, or send it with --force\n",
    );
    refused(
        "broadcast --meter em24 clock=now",
        "error: em24 has no clock that can be set by a broadcast\n",
    );
    refused(
        "broadcast --meter pqm clock=tomorrow",
        "error: 'tomorrow' is no time to set a clock to\n\
         hint: give now, or a date and time such as 2026-11-22T13:27:10.015\n",
    );
    refused(
        "broadcast --meter em24 demand_interval=5 demand_interval=6",
        "error: demand_interval is given two values\n",
    );
    refused(
        "broadcast --meter pqm clear_all_demand --yes --verify-units 17",
        "error: --verify-units is for points that can be read\n",
    );
}

#[test]
fn an_operation_that_is_none_or_takes_something_else() {
    for (arguments, problem) in [
        (
            "clear_enrgy",
            "pqm has no operation 'clear_enrgy'; did you mean clear_energy, clear_event_record, \
             clear_max_demand?",
        ),
        (
            "99",
            "pqm has no operation '99'\nhint: `execute-operation --list` shows them",
        ),
        ("clear_energy 5", "clear_energy takes no value"),
        (
            "set_clock_time",
            "set_clock_time takes a value, time of day: a time of day such as 23:59:59.999",
        ),
        (
            "set_clock_time nonsense",
            "set_clock_time: 'nonsense' is not a time of day such as 23:59:59.999",
        ),
        (
            "set_clock_time now --function 5",
            "set_clock_time takes a value, and function 05 carries none\n\
             hint: leave --function out, or give 16",
        ),
    ] {
        let command = format!("execute-operation -a 17 --meter pqm --yes {arguments}");
        refused(&command, &format!("error: {problem}\n"));
    }
    refused(
        "execute-operation -a 1 --meter em24 --yes --function 16 reset_partial_meters",
        "error: --function is for operations that have a number\n",
    );
}
