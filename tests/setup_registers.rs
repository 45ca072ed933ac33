//! Scales that depend on the setup of the meter, through the program and over a real tty.

#![cfg(unix)]

mod support {
    pub(crate) mod program;
    pub(crate) mod pty;
}

use support::program::Program;
use support::pty::PtyMeter;

/// Four wires to neutral, ratio 1.0, 200 A: Vmax 660 V, Imax 240 A, Pmax 475200 W.
const SETUP: [(u16, u16); 3] = [(0x0900, 1), (0x0901, 10), (0x0902, 200)];

fn with_setup(registers: &[(u16, u16)]) -> Vec<(u16, u16)> {
    [&SETUP, registers].concat()
}

fn read(meter: &PtyMeter, arguments: &str) -> Program {
    Program::new(&format!(
        "read-registers -p {} -t 10s --meter pm290 -f csv {arguments}",
        meter.path()
    ))
}

/// Unit, first register and count of each request.
fn asked(meter: &PtyMeter) -> Vec<(u8, u16, u16)> {
    let requests = meter.requests().into_iter();
    requests
        .map(|frame| {
            let word = |at: usize| u16::from_be_bytes([frame[at], frame[at + 1]]);
            (frame[0], word(2), word(4))
        })
        .collect()
}

#[test]
fn power_comes_in_watts_by_the_setup_that_is_read_with_it() {
    let registers = with_setup(&[(0x0106, 6000), (0x011F, 0x10E1), (0x0120, 3)]);
    let meter = PtyMeter::holding(&[1], &registers);
    read(&meter, "-a 1 active_power_a energy_active_import")
        .stdout(
            "time,meter,unit_id,status,active_power_a,energy_active_import\n\
             <time>,pm290,1,ok,95097.03,34321\n",
        )
        .run();
    assert_eq!(
        asked(&meter),
        [(1, 0x0106, 1), (1, 0x011F, 2), (1, 0x0900, 3)]
    );
}

#[test]
fn what_needs_no_setup_is_read_without_it() {
    let meter = PtyMeter::holding(&[1], &[(0x0117, 2500)]);
    read(&meter, "-a 1 frequency")
        .stdout("time,meter,unit_id,status,frequency\n<time>,pm290,1,ok,50.0005\n")
        .run();
    assert_eq!(asked(&meter), [(1, 0x0117, 1)]);
}

#[test]
fn setup_that_is_asked_for_is_read_once_and_shown() {
    let meter = PtyMeter::holding(&[1], &with_setup(&[(0x0103, 5000)]));
    read(&meter, "-a 1 ct_primary_current current_a")
        .stdout(
            "time,meter,unit_id,status,ct_primary_current,current_a\n\
             <time>,pm290,1,ok,200,120.012\n",
        )
        .run();
    assert_eq!(asked(&meter), [(1, 0x0103, 1), (1, 0x0902, 1)]);
}

#[test]
fn each_unit_is_scaled_by_its_own_setup() {
    let meter = PtyMeter::holding(&[1, 2], &with_setup(&[(0x0103, 9999)]));
    read(&meter, "-a 1,2 current_a")
        .stdout(
            "time,meter,unit_id,status,current_a\n\
             <time>,pm290,1,ok,240.000\n<time>,pm290,2,ok,240.000\n",
        )
        .run();
    let setup = |unit| asked(&meter).contains(&(unit, 0x0902, 1));
    assert!(setup(1) && setup(2), "{:?}", asked(&meter));
}

#[test]
fn setup_that_the_meter_refuses_leaves_what_depends_on_it_without_a_figure() {
    let meter = PtyMeter::holding(&[1], &[(0x0100, 3333), (0x0117, 2500)]);
    read(&meter, "-a 1 voltage_a frequency")
        .code(1)
        .stdout(
            "time,meter,unit_id,status,voltage_a,frequency\n\
             <time>,pm290,1,exception:2,,50.0005\n",
        )
        .stderr(format!(
            "error: unit 1 on {} at 9600 8N1, pt_ratio (registers 0x0901+1): the meter refused: \
             exception 02 (ILLEGAL DATA ADDRESS)\n\
             hint: this meter, or its firmware, has no such registers\n",
            meter.path()
        ))
        .run();
}

#[test]
fn setup_that_cannot_be_is_told_and_scales_nothing() {
    let meter = PtyMeter::holding(&[1], &[(0x0100, 3333), (0x0117, 2500), (0x0901, 0)]);
    read(&meter, "-a 1 voltage_a frequency")
        .code(1)
        .stdout(
            "time,meter,unit_id,status,voltage_a,frequency\n\
             <time>,pm290,1,mismatch,,50.0005\n",
        )
        .stderr(format!(
            "error: unit 1 on {} at 9600 8N1, pt_ratio: registers 0000 hold no such value; what \
             depends on it is missing\n\
             hint: check the setup on the meter itself, and that it is the meter of --meter\n",
            meter.path()
        ))
        .run();
}

#[test]
fn a_raw_number_past_the_full_scale_is_told() {
    let meter = PtyMeter::holding(&[1], &with_setup(&[(0x0103, 10000)]));
    read(&meter, "-a 1 current_a")
        .code(4)
        .stdout("time,meter,unit_id,status,current_a\n<time>,pm290,1,mismatch,\n")
        .stderr(format!(
            "error: unit 1 on {} at 9600 8N1, current_a: registers 2710 hold no u16 from 0 to 9999\n\
             hint: the type, byte order or scale is not this register's, or the meter's value is \
             broken\n",
            meter.path()
        ))
        .run();
}

#[test]
fn the_power_of_a_phase_is_absent_with_three_wires() {
    let registers = [
        (0x0106, 6000),
        (0x0113, 6000),
        (0x0900, 0),
        (0x0901, 10),
        (0x0902, 200),
    ];
    let meter = PtyMeter::holding(&[1], &registers);
    // Pmax is 316800 W with three wires.
    read(&meter, "-a 1 active_power_a active_power_total")
        .code(1)
        .stdout(
            "time,meter,unit_id,status,active_power_a,active_power_total\n\
             <time>,pm290,1,absent,,63398.02\n",
        )
        .run();
}

#[test]
fn the_plan_says_what_is_read_besides() {
    Program::new("read-registers -a 1 --meter pm290 voltage_a --plan")
        .stdout(
            "unit 1\n\
             REQUEST                  REGISTERS  POINTS    MS\n\
             01 03 01 00 00 01 85 F6  0x0100          1  22.9\n\
             01 03 09 01 00 01 D6 56  0x0901          1  22.9\n\
             \n\
             TOTAL                REQUESTS    MS\n\
             planned                     2  45.8\n\
             one request a point         2  45.8\n\
             \n\
             at 9600 8N1, if the meter begins to answer after 0 ms\n\
             read besides, for others depend on it: pt_ratio\n",
        )
        .run();
}

#[test]
fn the_time_of_a_stamp_that_was_never_set_is_absent() {
    // Lowest phase A current: time, then date.
    let never = [(0x0250, 0), (0x0251, 0), (0x0252, 0), (0x0253, 0)];
    let once = [(0x0250, 0), (0x0251, 0), (0x0252, 0x0A1D), (0x0253, 1997)];
    for (registers, code, expected) in [(never, 1, "absent,"), (once, 0, "ok,00:00:00.000")] {
        let meter = PtyMeter::holding(&[1], &registers);
        Program::new(&format!(
            "read-registers -p {} -t 10s --meter pqm -f csv -a 1 current_a_min_time",
            meter.path()
        ))
        .code(code)
        .stdout(format!(
            "time,meter,unit_id,status,current_a_min_time\n<time>,pqm,1,{expected}\n"
        ))
        .run();
        assert_eq!(asked(&meter), [(1, 0x0250, 4)]);
    }
}
