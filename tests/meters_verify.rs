//! `meters verify`: what a live meter says of its profile, to the letter.

#![cfg(unix)]

mod support {
    pub(crate) mod program;
    pub(crate) mod pty;
}

use std::path::PathBuf;

use support::program::Program;
use support::pty::PtyMeter;

/// Three phases, of which only the total was read in the manual.
const PROFILE: &str = r#"
name = "mine"
title = "Mine"
manual = "none"

identities = [
  { sum = "power", of = ["power_a", "power_b"] },
  { mean = "voltage", of = ["voltage_a", "voltage_b"], tolerance = 0.05 },
  { near = "frequency", one_of = [50, 60] },
]

points = [
  { name = "power", address = 0, type = "u16", scale = 0.1, unit = "kW" },
  { name = "power_a", address = 1, type = "u16", scale = 0.1, unit = "kW", verified = false },
  { name = "power_b", address = 2, type = "u16", scale = 0.1, unit = "kW", verified = false },
  { name = "voltage", address = 3, type = "u16", unit = "V" },
  { name = "voltage_a", address = 4, type = "u16", unit = "V", verified = false },
  { name = "voltage_b", address = 5, type = "u16", unit = "V", verified = false },
  { name = "frequency", address = 6, type = "u16", scale = 0.01, unit = "Hz" },
  { name = "counter", address = 7, type = "u16", verified = false },
]
"#;

/// A profile in a file of its own.
fn profile(file: &str, text: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(file);
    std::fs::write(&path, text).expect("the folder for tests is writable");
    path
}

fn verify(meter: &PtyMeter, profile: &PathBuf, options: &str) -> Program {
    Program::new("meters verify")
        .argument(profile)
        .argument("-p")
        .argument(meter.path())
        .arguments(&format!("-t 10s {options}"))
}

const GOOD: [(u16, u16); 7] = [
    (0, 8000),
    (1, 5010),
    (2, 3000),
    (3, 230),
    (4, 228),
    (5, 232),
    (6, 5002),
];

#[test]
fn a_meter_of_which_all_holds_is_told_so_and_ends_with_0() {
    let meter = PtyMeter::holding(&[1], &GOOD);
    let path = profile("verified.toml", PROFILE);
    verify(&meter, &path, "-a 1")
        .stdout(format!(
            "mine, unit 1 on {} at 9600 8N1, <time>\n\
             \n\
             RESULT    FOUND  EXPECTED     OFF  IDENTITY\n\
             holds    800.00    801.00  -0.1 %  power = power_a + power_b\n\
             holds    230.00    230.00   0.0 %  voltage = (voltage_a + voltage_b) / 2\n\
             holds   50.0200   50.0000   0.0 %  frequency near 50 or 60\n\
             \n\
             RESULT  VALUE  UNIT  NOT VERIFIED\n\
             holds   501.0  kW    power_a\n\
             holds   300.0  kW    power_b\n\
             holds     228  V     voltage_a\n\
             holds     232  V     voltage_b\n\
             \n\
             identities: 3 hold, 0 fail, 0 could not be tested\n\
             points not verified: 4 hold, 0 fail, 0 are doubtful, 0 could not be tested, 1 are in \
             no identity\n",
            meter.path()
        ))
        .run();
    assert_eq!(meter.requests().len(), 1, "the counter is not read");
}

#[test]
fn what_does_not_hold_is_told_with_the_tolerance_and_ends_with_1() {
    let mut registers = GOOD;
    registers[2] = (2, 300);
    registers[6] = (6, 0);
    let meter = PtyMeter::holding(&[1], &registers);
    let path = profile("refuted.toml", PROFILE);
    verify(&meter, &path, "-a 1 -q")
        .code(1)
        .stdout(
            "RESULT              FOUND  EXPECTED      OFF  IDENTITY\n\
             fails (±2 %)       800.00    531.00  +33.6 %  power = power_a + power_b\n\
             holds              230.00    230.00    0.0 %  voltage = (voltage_a + voltage_b) / 2\n\
             too small to tell                             frequency near 50 or 60\n\
             \n\
             RESULT  VALUE  UNIT  NOT VERIFIED\n\
             fails   501.0  kW    power_a\n\
             fails    30.0  kW    power_b\n\
             holds     228  V     voltage_a\n\
             holds     232  V     voltage_b\n",
        )
        .run();
}

#[test]
fn what_cannot_be_read_cannot_be_tested() {
    let meter = PtyMeter::holding(&[1], &GOOD[..6]);
    let path = profile("unread.toml", PROFILE);
    verify(&meter, &path, "-a 1 -q")
        .code(1)
        .stdout(
            "RESULT     FOUND  EXPECTED     OFF  IDENTITY\n\
             holds     800.00    801.00  -0.1 %  power = power_a + power_b\n\
             holds     230.00    230.00   0.0 %  voltage = (voltage_a + voltage_b) / 2\n\
             no value                            frequency near 50 or 60\n\
             \n\
             RESULT  VALUE  UNIT  NOT VERIFIED\n\
             holds   501.0  kW    power_a\n\
             holds   300.0  kW    power_b\n\
             holds     228  V     voltage_a\n\
             holds     232  V     voltage_b\n",
        )
        .stderr(format!(
            "error: unit 1 on {} at 9600 8N1, frequency (registers 0x0006+1): the meter refused: \
             exception 02 (ILLEGAL DATA ADDRESS)\n",
            meter.path()
        ))
        .run();
}

#[test]
fn each_unit_is_tested_by_itself_and_a_silent_one_is_missing() {
    let meter = PtyMeter::holding(&[2], &GOOD);
    let path = profile("two_units.toml", PROFILE);
    let output = Program::new("meters verify")
        .argument(&path)
        .argument("-p")
        .argument(meter.path())
        .arguments("-a 2,3 -t 300ms --retries 0 -q")
        .output();
    assert_eq!(output.status.code(), Some(1), "unit 3 is silent");
    let text = String::from_utf8(output.stdout).expect("text");
    assert!(text.starts_with("RESULT    FOUND"), "{text}");
    assert_eq!(text.matches("no value").count(), 3, "{text}");
}

#[test]
fn a_meter_that_is_silent_altogether_ends_with_4() {
    let meter = PtyMeter::holding(&[2], &GOOD);
    let path = profile("silent.toml", PROFILE);
    let output = Program::new("meters verify")
        .argument(&path)
        .argument("-p")
        .argument(meter.path())
        .arguments("-a 3 -t 300ms --retries 0 -q")
        .output();
    assert_eq!(output.status.code(), Some(4));
}

#[test]
fn a_profile_without_identities_has_nothing_to_verify() {
    let path = profile(
        "untestable.toml",
        "name = \"m\"\ntitle = \"M\"\nmanual = \"none\"\n\
         [[points]]\nname = \"a\"\naddress = 0\ntype = \"u16\"\n",
    );
    Program::new("meters verify -p sim: -a 1")
        .argument(&path)
        .code(2)
        .stderr("error: the profile of m has no [[identities]] that could be tested\n")
        .run();
}

#[test]
fn the_simulated_meters_hold_what_their_profiles_say() {
    // The PM290 is left out: it is busy for two seconds of every hour.
    for (meter, unit) in [("pqm", 17), ("em24", 1), ("em21", 3)] {
        let output = Program::new(&format!("meters verify {meter} -p sim: -a {unit}")).output();
        let text = String::from_utf8(output.stdout).expect("text");
        assert_eq!(output.status.code(), Some(0), "{meter}:\n{text}");
        assert!(text.contains(" 0 fail, 0 could not be tested\n"), "{text}");
    }
}
