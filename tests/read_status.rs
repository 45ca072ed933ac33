//! `read-status`: the bits of function 07, by name.

#![cfg(unix)]

mod support {
    pub(crate) mod program;
    pub(crate) mod pty;
    pub(crate) mod writable;
}

use support::program::Program;
use support::pty::PtyMeter;
use support::writable::{came_to, refuse, run, sealed};

/// Units 17 and 18 with these bits; unit 19 refuses, and nobody else answers.
fn meter(seventeen: u8, eighteen: u8) -> PtyMeter {
    PtyMeter::new(Box::new(move |frame| match frame[0] {
        17 => sealed(&[17, 7, seventeen]),
        18 => sealed(&[18, 7, eighteen]),
        19 => refuse(frame, 1),
        _ => Vec::new(),
    }))
}

#[test]
fn the_request_is_shown_without_a_port() {
    Program::new("read-status -a 17,18 --meter pqm --dry-run")
        .stdout("11 07 4C 22\n12 07 4C D2\n")
        .run();
}

#[test]
fn the_bits_that_are_set_are_named_a_line_a_unit() {
    let meter = meter(0x15, 0);
    let told = run(meter.path(), "read-status -a 17,18 --meter pqm");
    came_to(
        &told,
        0,
        "UNIT  VALUE  STATUS\n17    0x15   alarm|alarm relay|aux 2 relay\n18    0x00   none\n",
        "",
    );
}

#[test]
fn bits_without_a_name_are_a_number() {
    let meter = meter(0xC1, 0x80);
    let told = run(meter.path(), "read-status -a 17,18 --meter pqm -q");
    came_to(&told, 0, "17    0xC1   alarm|0xC0\n18    0x80   0x80\n", "");
    let told = run(meter.path(), "read-status -a 17 -q");
    came_to(&told, 0, "17    0xC1   bit_0|bit_6|bit_7\n", "");
}

#[test]
fn csv_has_a_row_a_unit_and_a_column_a_bit() {
    let meter = meter(0x15, 0);
    let told = run(meter.path(), "read-status -a 17,18 --meter pqm -f csv");
    came_to(
        &told,
        0,
        "time,meter,unit_id,status,value,alarm,self-test_failure,alarm_relay,aux_1_relay,aux_2_relay,\
         aux_3_relay\n\
         <time>,pqm,17,ok,0x15,1,0,1,0,1,0\n\
         <time>,pqm,18,ok,0x00,0,0,0,0,0,0\n",
        "",
    );
}

#[test]
fn json_has_an_object_a_unit() {
    let meter = meter(0x21, 0);
    let told = run(meter.path(), "read-status -a 17 --meter pqm -f json");
    came_to(
        &told,
        0,
        "[\n{\"time\":\"<time>\",\"meter\":\"pqm\",\"unit_id\":17,\"status\":\"ok\",\"value\":33,\
         \"bits\":{\"alarm\":true,\"self-test_failure\":false,\"alarm_relay\":false,\
         \"aux_1_relay\":false,\"aux_2_relay\":false,\"aux_3_relay\":true}}\n]\n",
        "",
    );
}

#[test]
fn a_unit_that_does_not_answer_has_an_empty_row() {
    let meter = meter(0x15, 0);
    let told = run(
        meter.path(),
        "read-status -a 17,5,18 --meter pqm -f csv --timeout 100ms",
    );
    came_to(
        &told,
        1,
        "time,meter,unit_id,status,value,alarm,self-test_failure,alarm_relay,aux_1_relay,aux_2_relay,\
         aux_3_relay\n\
         <time>,pqm,17,ok,0x15,1,0,1,0,1,0\n\
         <time>,pqm,5,timeout,,,,,,,\n\
         <time>,pqm,18,ok,0x00,0,0,0,0,0,0\n",
        "error: unit 5 on PORT at 115200 8N1, status: no answer within 100ms\n\
         hint: check --unit, --baud, --parity and --stop-bits against the meter, then power and wiring \
         (A and B swapped?); a slow meter needs a longer --timeout\n",
    );
}

#[test]
fn a_meter_without_the_function_says_so() {
    let meter = meter(0, 0);
    let told = run(meter.path(), "read-status -a 19");
    came_to(
        &told,
        5,
        "UNIT  VALUE  STATUS\n19    -      exception:1\n",
        "error: unit 19 on PORT at 115200 8N1, status: the meter refused: exception 01 (ILLEGAL \
         FUNCTION)\n\
         hint: the meter does not have function 07\n",
    );
}
