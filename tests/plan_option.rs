//! `read-registers --plan`: what would be sent and how long it would take, to the letter.

mod support {
    pub(crate) mod program;
}

use support::program::Program;

#[test]
fn each_request_comes_with_its_registers_points_and_time() {
    // 20 + 2 N characters of 1.0417 ms: 40, 22 and 24 of them.
    Program::new(
        "read-registers -a 17 0x10+10 0x10:u32/CDAB*0.1=kWh 0x12:f32 0x40 0x50:i32 --plan",
    )
    .stdout(
        "unit 17\n\
             REQUEST                  REGISTERS      POINTS    MS\n\
             11 03 00 10 00 0A C6 98  0x0010-0x0019      12  41.7\n\
             11 03 00 40 00 01 87 4E  0x0040              1  22.9\n\
             11 03 00 50 00 02 C6 8A  0x0050-0x0051       1  25.0\n\
             \n\
             TOTAL                REQUESTS     MS\n\
             planned                     3   89.6\n\
             one request a point        14  327.1\n\
             \n\
             at 9600 8N1, if the meter begins to answer after 0 ms\n",
    )
    .run();
}

#[test]
fn each_unit_has_its_requests_and_all_of_them_one_total() {
    Program::new("read-registers -a 17,18 0x6B+3 --plan -b 19200 -P even --pause 100ms")
        .stdout(
            "unit 17\n\
             REQUEST                  REGISTERS      POINTS     MS\n\
             11 03 00 6B 00 03 76 87  0x006B-0x006D       3  112.9\n\
             \n\
             unit 18\n\
             REQUEST                  REGISTERS      POINTS     MS\n\
             12 03 00 6B 00 03 76 B4  0x006B-0x006D       3  112.9\n\
             \n\
             TOTAL                REQUESTS     MS\n\
             planned                     2  225.8\n\
             one request a point         6  663.6\n\
             \n\
             at 19200 8E1, if the meter begins to answer after 0 ms; 100 ms between requests\n",
        )
        .run();
}

#[test]
fn the_answer_time_and_the_pause_are_the_profiles() {
    let path = std::path::PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("slow.toml");
    let text = "name = \"slow\"\ntitle = \"Slow\"\nmanual = \"none\"\nline.baud = 38400\n\
                limits.typical_answer = \"40ms\"\nlimits.pause = \"2500us\"\n\n[[points]]\n\
                name = \"b\"\naddress = 0x10\ntype = \"u16\"\n";
    std::fs::write(&path, text).expect("the folder for tests is writable");
    // 15 characters of 0.2604 ms, 1.75 ms, 2.5 ms, 40 ms.
    Program::new("read-registers -a 17 b --plan --meter")
        .argument(&path)
        .stdout(
            "unit 17\n\
             REQUEST                  REGISTERS  POINTS    MS\n\
             11 03 00 10 00 01 87 5F  0x0010          1  48.2\n\
             \n\
             TOTAL                REQUESTS    MS\n\
             planned                     1  48.2\n\
             one request a point         1  48.2\n\
             \n\
             at 38400 8N1, if the meter begins to answer after 40 ms; 2.5 ms between requests\n",
        )
        .run();
}

#[test]
fn a_port_is_not_needed_and_not_opened() {
    let with_port = Program::new("read-registers -p /nowhere -a 1 5 --plan").output();
    let without = Program::new("read-registers -a 1 5 --plan").output();
    assert_eq!(with_port.status.code(), Some(0));
    assert_eq!(with_port.stdout, without.stdout);
}

#[test]
fn options_about_readings_are_refused() {
    for (arguments, option) in [
        ("-f csv", "--format"),
        ("-f csv --layout long", "--layout"),
        ("-f csv --units", "--units"),
    ] {
        Program::new(&format!("read-registers -a 1 5 --plan {arguments}"))
            .code(2)
            .stderr(format!("error: {option} is for readings\n"))
            .run();
    }
}

#[test]
fn frames_are_printed_one_way_or_the_other() {
    Program::new("read-registers -a 1 5 --plan --dry-run")
        .code(2)
        .stderr(
            "error: the argument '--plan' cannot be used with '--dry-run'\n\n\
             Usage: meterpoll read-registers --unit <UNITS> --plan <WHAT>...\n\n\
             For more information, try '--help'.\n",
        )
        .run();
}
