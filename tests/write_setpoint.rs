//! `write-setpoint` on meters that do what they are told: what is sent, what is said, and what is
//! held afterwards.

#![cfg(unix)]

mod support {
    pub(crate) mod program;
    pub(crate) mod pty;
    pub(crate) mod simulation;
    pub(crate) mod writable;
}

use meterpoll::profile::builtin;

use support::program::Program;
use support::simulation::Simulation;
use support::writable::{came_to, meter, obey, run, writes};

/// A run without a port: the frames in hex.
#[track_caller]
fn frames(arguments: &str, expected: &str) {
    Program::new(&format!("write-setpoint --dry-run {arguments}"))
        .stdout(expected)
        .run();
}

#[test]
fn two_registers_next_to_each_other_go_in_one_request() {
    let both = "11 10 10 28 00 02 04 01 F4 27 10 33 23\n";
    frames("--function 16 0x1028=0x01F4 0x1029=0x2710 -a 17", both);
    frames("0x1028=500 0x1029=10000 -a 17", both);
}

#[test]
fn a_register_by_itself_goes_with_function_06() {
    frames("0x1028=500 -a 17", "11 06 10 28 01 F4 0F 85\n");
    frames(
        "0x1028=500 0x102A=10000 -a 17",
        "11 06 10 28 01 F4 0F 85\n11 06 10 2A 27 10 B4 6E\n",
    );
    frames(
        "0x1028=500 -a 17,18",
        "11 06 10 28 01 F4 0F 85\n12 06 10 28 01 F4 0F B6\n",
    );
}

#[test]
fn the_function_that_was_typed_is_used() {
    frames(
        "0x1028=500 -a 17 --function 16",
        "11 10 10 28 00 01 02 01 F4 7C 6E\n",
    );
    frames(
        "0x1028=500 0x1029=10000 -a 17 --function 6",
        "11 06 10 28 01 F4 0F 85\n11 06 10 29 27 10 44 6E\n",
    );
}

#[test]
fn registers_by_address_have_types_orders_and_factors() {
    // 40.0 in steps of 0.1, low word first; the factor's mark is no glob.
    frames(
        "0x1003:u32/CDAB*0.1=40.0 0x1005:i16=-3 -a 5",
        "05 10 10 03 00 03 06 01 90 00 00 FF FD 0D 76\n",
    );
    frames(
        "--numbering modicon 40017=5 -a 5",
        "05 06 00 10 00 05 49 88\n",
    );
}

#[test]
fn values_are_in_the_terms_of_the_point_or_the_registers_own_number() {
    for value in ["200", "0x00C8"] {
        let arguments = format!("--meter pqm ct_primary={value} -a 17");
        frames(&arguments, "11 06 10 50 00 C8 8E 1D\n");
    }
    frames(
        "--meter pm290 pulse_kvarh=suppressed -a 2",
        "02 06 07 02 FF FF 28 FD\n",
    );
}

#[test]
fn a_carlo_gavazzi_gets_two_writes_low_word_first() {
    frames(
        "--meter em24 ct_ratio=40.0 vt_ratio=1.0 -a 1",
        "01 06 11 2C 01 90 4C C3\n01 06 11 2D 00 00 1C FF\n\
         01 06 11 2E 00 0A 6C F8\n01 06 11 2F 00 00 BD 3F\n",
    );
}

#[test]
fn an_em24_never_gets_function_16() {
    let profile = builtin::find("em24").expect("it is built in").profile();
    let points = profile.points.iter();
    let writable: Vec<_> = points.filter(|point| point.access.writable()).collect();
    assert!(writable.len() > 20, "{}", writable.len());
    let (mut sent, mut refused) = (0, 0);
    // The first number that it takes, whichever that is; some take none by number.
    for point in writable {
        for insisted in ["", " --function 16"] {
            let arguments = format!(
                "write-setpoint --dry-run -a 1 --meter em24{insisted} {}=0x0001",
                point.name
            );
            let output = Program::new(&arguments).output();
            let stdout = String::from_utf8(output.stdout).expect("UTF-8");
            assert!(
                stdout.lines().all(|frame| frame.starts_with("01 06 ")),
                "{arguments}: {stdout}"
            );
            sent += usize::from(!stdout.is_empty());
            refused += usize::from(output.status.code() == Some(2));
        }
    }
    assert!(sent > 10 && refused >= 20, "{sent} {refused}");
}

#[test]
fn what_is_written_is_shown_first_and_held_afterwards() {
    let simulation = Simulation::new("--meter pqm=17,18 --meter em24=1 --meter pm290=2");
    let path = &simulation.path;
    let told = run(
        path,
        "write-setpoint -a 17,18 --meter pqm ct_primary=200 vt_wiring=off --yes",
    );
    let of_unit = |unit: u8| {
        format!(
            "# pqm unit {unit} on PORT at 115200 8N1\n\
             POINT                     NOW  NEW  UNIT\n\
             ct_primary                600  200  A\n\
             vt_wiring   4-wire wye direct  off\n\
             ct_primary: 200 A, written and read back\n\
             vt_wiring: off, written and read back\n"
        )
    };
    came_to(&told, 0, &(of_unit(17) + &of_unit(18)), "");
    let held = run(
        path,
        "read-registers -q -a 17,18 --meter pqm ct_primary vt_wiring",
    );
    assert!(held.stdout.contains("200"), "{held:?}");
    assert_eq!(held.stdout.matches("off").count(), 2, "{held:?}");

    let told = run(path, "write-setpoint -a 1 --meter em24 ct_ratio=40.0 --yes");
    came_to(
        &told,
        0,
        "# em24 unit 1 on PORT at 115200 8N1\n\
         POINT     NOW   NEW  UNIT\n\
         ct_ratio  1.0  40.0\n\
         ct_ratio: 40.0, written and read back\n",
        "warning: ct_ratio goes in 2 requests, low word first, for function 6 writes one register at a \
         time: in between the meter holds half of it\n",
    );
    let told = run(
        path,
        "write-setpoint -a 2 --meter pm290 pulse_kvarh=suppressed",
    );
    came_to(
        &told,
        0,
        "# pm290 unit 2 on PORT at 115200 8N1\n\
         POINT               NOW         NEW  UNIT\n\
         pulse_kvarh  suppressed  suppressed\n\
         pulse_kvarh: suppressed, written and read back\n",
        "",
    );
}

#[test]
fn a_label_has_no_unit_behind_it() {
    Program::new("write-setpoint -p sim: -a 17 --meter pqm ct_primary=off --yes -b 115200")
        .stdout(
            "# pqm unit 17 on sim: at 115200 8N1\n\
             POINT       NOW  NEW  UNIT\n\
             ct_primary  600  off  A\n\
             ct_primary: off, written and read back\n",
        )
        .run();
}

#[test]
fn what_moves_the_meter_is_not_read_back_from_where_it_was() {
    Program::new("write-setpoint -p sim: -a 3 --meter em21 rs485_address=9 --yes -b 115200")
        .stdout(
            "# em21 unit 3 on sim: at 115200 8N1\n\
             POINT          NOW  NEW  UNIT\n\
             rs485_address    3    9\n\
             rs485_address: 9, written; from now on the meter may answer only with the new address \
             or setting\n",
        )
        .run();
}

#[test]
fn without_a_check_there_is_one_request_and_quiet_is_quiet() {
    let meter = meter(&[(0x10, 1)], obey);
    let told = run(
        meter.path(),
        "write-setpoint -a 17 -q --no-verify 0x0010=500",
    );
    came_to(&told, 0, "", "");
    assert_eq!(writes(&meter), ["11 06 00 10 01 F4"]);
    // One read before it.
    assert_eq!(meter.requests().len(), 2);
}

#[test]
fn verbose_shows_the_frame_before_it_is_sent() {
    let meter = meter(&[(0x10, 1)], obey);
    let told = run(meter.path(), "write-setpoint -a 17 -v 0x0010=500");
    let line = "unit 17: writing 11 06 00 10 01 F4 8A 88";
    assert!(told.stderr.lines().any(|found| found == line), "{told:?}");
}

#[test]
fn what_cannot_be_read_now_is_written_all_the_same() {
    let meter = meter(&[(0x10, 1)], obey);
    let told = run(meter.path(), "write-setpoint -a 17 0x0020=500");
    came_to(
        &told,
        0,
        "# unit 17 on PORT at 115200 8N1\n\
         POINT               NOW  NEW  UNIT\n\
         0x0020  ? (exception:2)  500\n\
         0x0020: 500, written and read back\n",
        "",
    );
}
