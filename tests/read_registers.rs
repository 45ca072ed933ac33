//! `read-registers` over a real tty: what a person or a script sees, to the letter.

#![cfg(unix)]

mod support {
    pub(crate) mod program;
    pub(crate) mod pty;
}

use std::fs;
use std::path::PathBuf;
use std::time::Duration;

use support::program::Program;
use support::pty::{self, PtyMeter};

/// A read that is answered: however busy the machine, the meter is not taken for a dead one.
fn read(meter: &PtyMeter, arguments: &str) -> Program {
    read_within(meter, "10s", arguments)
}

fn read_within(meter: &PtyMeter, timeout: &str, arguments: &str) -> Program {
    Program::new(&format!(
        "read-registers -p {} -t {timeout} {arguments}",
        meter.path()
    ))
}

#[test]
fn ten_registers_come_as_csv_under_their_addresses() {
    let meter = PtyMeter::healthy(1);
    read(&meter, "-b 19200 -P none -a 1 0x0000+10 -f csv")
        .stdout(
            "time,meter,unit_id,status,0x0000,0x0001,0x0002,0x0003,0x0004,0x0005,0x0006,0x0007,\
             0x0008,0x0009\n\
             <time>,,1,ok,3,10,17,24,31,38,45,52,59,66\n",
        )
        .run();
    assert_eq!(
        meter.requests().len(),
        1,
        "adjacent registers share a request"
    );
}

#[test]
fn long_csv_has_a_row_a_reading() {
    let meter = PtyMeter::healthy(1);
    read(&meter, "-a 1 0x10+2*0.1=kWh -f csv --layout long")
        .stdout(
            "time,meter,unit_id,point,value,unit,status\n\
             <time>,,1,0x0010,11.5,kWh,ok\n\
             <time>,,1,0x0011,12.2,kWh,ok\n",
        )
        .run();
}

#[test]
fn units_go_into_the_wide_header_when_asked_for() {
    let meter = PtyMeter::healthy(1);
    read(&meter, "-a 1 0x10*0.1=kWh 0x11 -f csv --units")
        .stdout("time,meter,unit_id,status,0x0010 [kWh],0x0011\n<time>,,1,ok,11.5,122\n")
        .run();
}

#[test]
fn json_lines_carry_exact_numbers_and_null_for_what_is_missing() {
    let meter = PtyMeter::healthy(1);
    read(&meter, "-a 1 0x10:u32*0.01=kWh 0x3FF 0x400 -f jsonl")
        .code(1)
        .stdout(
            "{\"time\":\"<time>\",\"meter\":null,\"unit_id\":1,\"point\":\"0x0010\",\
             \"value\":75367.62,\"unit\":\"kWh\",\"status\":\"ok\"}\n\
             {\"time\":\"<time>\",\"meter\":null,\"unit_id\":1,\"point\":\"0x03FF\",\
             \"value\":7164,\"unit\":null,\"status\":\"ok\"}\n\
             {\"time\":\"<time>\",\"meter\":null,\"unit_id\":1,\"point\":\"0x0400\",\
             \"value\":null,\"unit\":null,\"status\":\"exception:2\"}\n",
        )
        .stderr(format!(
            "error: unit 1 on {} at 9600 8N1, registers 0x0400+1: the meter refused: exception \
             02 (ILLEGAL DATA ADDRESS)\n\
             hint: the meter has no such registers, or not as many at once; addresses are as on \
             the wire, from 0 (for 40001 and the like see --numbering modicon)\n",
            meter.path()
        ))
        .run();
}

#[test]
fn json_is_one_array_over_all_units() {
    let meter = PtyMeter::new(Box::new(|request| {
        pty::answer(u16::from(request[0]), request).unwrap_or_default()
    }));
    read(&meter, "-a 1,2 5 -f json")
        .stdout(
            "[\n\
             {\"time\":\"<time>\",\"meter\":null,\"unit_id\":1,\"point\":\"0x0005\",\
             \"value\":38,\"unit\":null,\"status\":\"ok\"},\n\
             {\"time\":\"<time>\",\"meter\":null,\"unit_id\":2,\"point\":\"0x0005\",\
             \"value\":38,\"unit\":null,\"status\":\"ok\"}\n\
             ]\n",
        )
        .run();
}

#[test]
fn a_table_aligns_numbers_at_their_decimal_mark_under_a_heading() {
    let meter = PtyMeter::healthy(1);
    read(&meter, "-a 1 0x10*0.01=kWh 0x11 0x12:hex")
        .stdout(format!(
            "unit 1 on {} at 9600 8N1, <time>\n\n\
             POINT    VALUE  UNIT\n\
             0x0010    1.15  kWh\n\
             0x0011  122\n\
             0x0012  0x0081\n",
            meter.path()
        ))
        .run();
}

#[test]
fn a_quiet_table_has_no_heading() {
    let meter = PtyMeter::healthy(1);
    read(&meter, "-q -a 1 0x11")
        .stdout("POINT   VALUE  UNIT\n0x0011    122\n")
        .run();
}

#[test]
fn a_dead_unit_among_living_ones_costs_its_own_row_only() {
    let meter = PtyMeter::healthy(2);
    let path = meter.path().to_owned();
    read_within(&meter, "2s", "-a 1-2 5 -f csv --retries 0 -q")
        .code(1)
        .stdout("time,meter,unit_id,status,0x0005\n<time>,,1,timeout,\n<time>,,2,ok,38\n")
        .stderr(format!(
            "error: unit 1 on {path} at 9600 8N1, registers 0x0005+1: no answer within 2s\n"
        ))
        .run();
}

#[test]
fn more_than_125_registers_become_several_requests() {
    let meter = PtyMeter::healthy(1);
    let output = read(&meter, "-a 1 0+300 -f csv").output();
    assert_eq!(output.status.code(), Some(0));
    let text = String::from_utf8(output.stdout).expect("CSV is text");
    let row = text.lines().nth(1).expect("a row");
    let values: Vec<u16> = row
        .split(',')
        .skip(4)
        .map(|cell| cell.parse().expect("a number"))
        .collect();
    let expected: Vec<u16> = (0..300).map(pty::register).collect();
    assert_eq!(values, expected);
    let counts: Vec<u8> = meter.requests().iter().map(|request| request[5]).collect();
    assert_eq!(counts.len(), 3);
    assert_eq!(
        counts.iter().map(|count| u32::from(*count)).sum::<u32>(),
        300
    );
}

#[test]
fn function_4_and_modicon_numbers_choose_the_table() {
    let meter = PtyMeter::healthy(1);
    read(&meter, "-a 1 --function 4 0x10 -f csv -q")
        .stdout("time,meter,unit_id,status,0x0010\n<time>,,1,ok,115\n")
        .run();
    read(&meter, "-a 1 --numbering modicon 30018 400020 -f csv -q")
        .stdout("time,meter,unit_id,status,0x0011,0x0013\n<time>,,1,ok,122,136\n")
        .run();
    let functions: Vec<u8> = meter.requests().iter().map(|request| request[1]).collect();
    assert_eq!(functions, [4, 3, 4]);
}

#[test]
fn a_dry_run_prints_the_frames_and_opens_no_port() {
    Program::new("read-registers -p /nowhere -a 17,18 0x6B+3 --dry-run")
        .stdout("11 03 00 6B 00 03 76 87\n12 03 00 6B 00 03 76 B4\n")
        .run();
}

#[test]
fn very_verbose_shows_frames_in_hex_on_stderr_only() {
    let meter = PtyMeter::healthy(1);
    let output = read(&meter, "-vv -a 1 0 -f csv").output();
    let stderr = String::from_utf8(output.stderr).expect("text");
    assert!(
        stderr.contains(" ms  01 03 00 00 00 01 84 0A\n"),
        "{stderr}"
    );
    assert!(stderr.contains(" ms  01 03 02 00 03 F8 45\n"), "{stderr}");
    let stdout = String::from_utf8(output.stdout).expect("text");
    assert_eq!(stdout.lines().count(), 2, "{stdout}");
}

#[test]
fn an_answer_before_its_time_out_is_taken_and_one_after_it_is_never_printed() {
    // Every answer comes 1.2 time-outs after its request, so that it looks like the answer to the
    // next one, which asks for another register of the same shape.
    let meter = PtyMeter::new(Box::new(|request| {
        std::thread::sleep(Duration::from_millis(120));
        pty::answer(1, request).unwrap_or_default()
    }));
    let output = read_within(
        &meter,
        "100ms",
        "-a 1 0x10 0x20 0x30 0x40 --retries 1 -f csv -q",
    )
    .output();
    // Which of them are late enough to be missing is up to the machine.
    let code = output.status.code();
    assert!(matches!(code, Some(0 | 1 | 4)), "{code:?}");
    let text = String::from_utf8(output.stdout).expect("CSV is text");
    let row = text.lines().nth(1).expect("a row");
    let cells: Vec<&str> = row.split(',').skip(4).collect();
    assert_eq!(cells.len(), 4, "{row}");
    assert!(!meter.requests().is_empty());
    for (cell, address) in cells.into_iter().zip([0x10, 0x20, 0x30, 0x40]) {
        assert!(
            cell.is_empty() || cell == pty::register(address).to_string(),
            "0x{address:04X} read as {cell}"
        );
    }
}

#[test]
fn noise_before_an_answer_is_skipped_and_an_echo_is_dropped() {
    let noisy = PtyMeter::new(Box::new(|request| {
        let mut bytes = vec![0x00, 0xFF, 0x00];
        bytes.extend(pty::answer(1, request).unwrap_or_default());
        bytes
    }));
    read(&noisy, "-a 1 0x10 -f csv -q")
        .stdout("time,meter,unit_id,status,0x0010\n<time>,,1,ok,115\n")
        .run();
    let echoing = PtyMeter::new(Box::new(|request| {
        let mut bytes = request.to_vec();
        bytes.extend(pty::answer(1, request).unwrap_or_default());
        bytes
    }));
    read(&echoing, "-a 1 0x10 0x20 -f csv -q")
        .stdout("time,meter,unit_id,status,0x0010,0x0020\n<time>,,1,ok,115,227\n")
        .run();
}

#[test]
fn the_port_can_come_from_the_environment() {
    let meter = PtyMeter::healthy(1);
    Program::new("read-registers -t 10s -a 1 0 -q")
        .variable("METERPOLL_PORT", meter.path())
        .stdout("POINT   VALUE  UNIT\n0x0000      3\n")
        .run();
}

#[test]
fn a_meter_of_ones_own_is_found_by_name_in_the_configuration_folder() {
    let home = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("own");
    let folder = home.join("meterpoll/meters");
    fs::create_dir_all(&folder).expect("the folder for tests is writable");
    fs::write(
        folder.join("mine.toml"),
        "name = \"mine\"\ntitle = \"My meter\"\nmanual = \"none\"\n\
         groups.default = [\"b\"]\n\n[[points]]\nname = \"b\"\naddress = 0x10\ntype = \"u16\"\n\
         scale = 0.1\nunit = \"V\"\n",
    )
    .expect("the folder for tests is writable");
    let meter = PtyMeter::healthy(1);
    read(&meter, "-a 1 --meter mine -f csv")
        .variable("XDG_CONFIG_HOME", &home)
        .stdout("time,meter,unit_id,status,b\n<time>,mine,1,ok,11.5\n")
        .run();
}
