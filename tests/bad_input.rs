//! What goes wrong before anything is sent: one clear message, the right exit code, nothing on
//! stdout.

mod support {
    pub(crate) mod program;
    pub(crate) mod pty;
}

use std::fs;
use std::io::ErrorKind;
use std::path::PathBuf;

use support::program::Program;
use support::pty::PtyMeter;

/// A file of its own in the folder cargo gives tests.
fn file(name: &str, text: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::write(&path, text).expect("the folder for tests is writable");
    path
}

#[test]
fn unit_0_cannot_be_read() {
    Program::new("read-registers -p sim: -a 0 0x0000")
        .code(2)
        .stderr(
            "error: unit 0 is the broadcast address, which no meter answers\n\
             hint: a read needs one meter: --unit 1 to 247\n",
        )
        .run();
}

#[test]
fn unit_248_needs_a_meter_that_allows_it() {
    Program::new("read-registers -p sim: -a 248 0x0000")
        .code(2)
        .stderr(
            "error: unit 248 is above 247, the highest this meter can have\n\
             hint: units go to 247; to 255 only for meters whose profile says so, such as --meter \
             pqm\n",
        )
        .run();
    Program::new("read-registers -p sim: -a 248 --meter pqm product_code --dry-run")
        .stdout("F8 03 00 00 00 01 90 63\n")
        .run();
}

#[test]
fn a_unit_that_is_no_number_is_refused() {
    Program::new("read-registers -p sim: -a one 0x0000")
        .code(2)
        .stderr(
            "error: invalid value 'one' for '--unit <UNITS>': 'one' is no unit: a number from 1 \
             to 255, or a list such as 1,2,5-9\n\n\
             For more information, try '--help'.\n",
        )
        .run();
}

#[test]
fn no_registers_are_nothing_to_read() {
    Program::new("read-registers -p sim: -a 1 0x0000+0")
        .code(2)
        .stderr(
            "error: '0x0000+0': 0 registers are nothing to read\n\
             hint: registers are written 0x006B, 107, 0x6B+3 or 0x11F:u32/CDAB*0.1=kWh\n",
        )
        .run();
}

#[test]
fn an_address_past_65535_is_refused() {
    Program::new("read-registers -p sim: -a 1 65536")
        .code(2)
        .stderr(
            "error: '65536' is no number from 0 to 65535, or 0x0 to 0xFFFF\n\
             hint: registers are written 0x006B, 107, 0x6B+3 or 0x11F:u32/CDAB*0.1=kWh\n",
        )
        .run();
    Program::new("read-registers -p sim: -a 1 0xFFFF+2")
        .code(2)
        .stderr("error: '0xFFFF+2': 2 registers from 0xFFFF run past 0xFFFF, the last address\n")
        .run();
}

#[test]
fn an_unknown_point_is_answered_with_the_nearest_names() {
    Program::new("read-registers -p sim: -a 17 --meter pqm curent_a")
        .code(2)
        .stderr(
            "error: pqm has no point 'curent_a'; did you mean current_a, current_avg, \
             current_b?\n",
        )
        .run();
}

#[test]
fn an_unknown_meter_is_answered_with_the_list() {
    Program::new("read-registers -p sim: -a 17 --meter pmq")
        .code(2)
        .stderr(
            "error: there is no meter 'pmq'; known are pqm\n\
             hint: `meterpoll meters list` shows them; a profile file is named by its path\n",
        )
        .run();
}

#[test]
fn a_profile_that_does_not_parse_is_named_with_line_and_key() {
    let path = file(
        "wrong.toml",
        "name = \"mine\"\ntitle = \"Mine\"\nmanual = \"none\"\n\n[[points]]\nname = \"a\"\n\
         adress = 0\ntype = \"u16\"\n",
    );
    let path = path.to_str().expect("a path of text");
    Program::new("read-registers -p sim: -a 1 --meter")
        .argument(path)
        .code(2)
        .stderr(format!(
            "error: {path}:7: a.adress: unknown key, expected \
             name, address, type, order, scale, unit, about, access, range, labels, no_value, \
             alone, function, verified, page\n"
        ))
        .run();
}

#[test]
fn a_profile_that_is_not_there_is_named() {
    Program::new("read-registers -p sim: -a 1 --meter ./nowhere.toml")
        .code(2)
        .stderr(
            "error: profile ./nowhere.toml cannot be read\n  \
             because: No such file or directory (os error 2)\n",
        )
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
    Program::new(&format!(
        "read-registers -p {} -a 1 --meter mine -f csv",
        meter.path()
    ))
    .variable("XDG_CONFIG_HOME", &home)
    .stdout("time,meter,unit_id,status,b\n<time>,mine,1,ok,11.5\n")
    .run();
}

#[test]
fn a_directory_or_a_file_is_no_port() {
    Program::new("read-registers -p /tmp -a 1 0")
        .code(3)
        .stderr(
            "error: port /tmp is a directory, not a serial port\n\
             hint: `meterpoll ports` lists the ports\n",
        )
        .run();
    Program::new("read-registers -p /etc/passwd -a 1 0")
        .code(3)
        .stderr(
            "error: port /etc/passwd is a file, not a serial port\n\
             hint: `meterpoll ports` lists the ports\n",
        )
        .run();
    Program::new("read-registers -p /dev/null -a 1 0")
        .code(3)
        .stderr(
            "error: port /dev/null is a device without line settings, not a serial port\n\
             hint: `meterpoll ports` lists the ports\n",
        )
        .run();
}

#[test]
fn a_port_that_is_not_there_says_so() {
    Program::new("read-registers -p /dev/ttyNOWHERE -a 1 0")
        .code(3)
        .stderr(
            "error: port /dev/ttyNOWHERE is not there\n\
             hint: `meterpoll ports` lists the ports; plugging an adapter in shows a new one (a \
             program such as brltty can take it away again)\n",
        )
        .run();
}

#[test]
fn a_port_that_another_program_holds_is_busy() {
    let meter = PtyMeter::healthy(1);
    let held = serialport::new(meter.path(), 9600)
        .open()
        .expect("nobody else has it");
    Program::new(&format!(
        "read-registers -p {} -a 1 0 --wait 0s",
        meter.path()
    ))
    .code(3)
    .stderr(format!(
        "error: port {} is in use by another program\n\
             hint: another program has it open, a cron job or ModemManager perhaps; --wait 30s \
             waits longer\n",
        meter.path()
    ))
    .run();
    assert_eq!(meter.requests().len(), 0);
    drop(held);
}

#[test]
fn a_port_that_becomes_free_in_time_is_used() {
    let meter = PtyMeter::healthy(1);
    let held = serialport::new(meter.path(), 9600)
        .open()
        .expect("nobody else has it");
    let program = Program::new(&format!("read-registers -p {} -a 1 0 -q", meter.path()));
    let waiting =
        std::thread::spawn(move || program.stdout("POINT   VALUE  UNIT\n0x0000      3\n").run());
    drop(held);
    waiting.join().expect("the run compares equal");
}

#[cfg(unix)]
#[test]
fn a_port_that_is_not_permitted_names_its_group_and_the_user() {
    use std::os::unix::fs::{MetadataExt, PermissionsExt};
    use std::os::unix::process::CommandExt;

    let meter = PtyMeter::healthy(1);
    fs::set_permissions(meter.path(), fs::Permissions::from_mode(0o000)).expect("our own pty");
    // Root may open anything, so as root the program runs as nobody, from where nobody reaches it.
    let is_root = fs::metadata("/proc/self").is_ok_and(|own| own.uid() == 0);
    let program = Program::new(&format!("read-registers -p {} -a 1 0", meter.path()));
    let mut command = program.command();
    if is_root {
        let copy = std::env::temp_dir().join(format!("meterpoll-nobody-{}", std::process::id()));
        fs::copy(support::program::binary(), &copy).expect("a copy for nobody");
        let mut as_nobody = std::process::Command::new(&copy);
        as_nobody
            .args(command.get_args())
            .uid(65534)
            .gid(65534)
            .current_dir("/");
        command = as_nobody;
    }
    let output = loop {
        match command.output() {
            // Another test that forks just now holds the copy open for a moment.
            Err(error) if error.kind() == ErrorKind::ExecutableFileBusy => std::thread::yield_now(),
            result => break result.expect("the program starts"),
        }
    };
    let stderr = String::from_utf8(output.stderr).expect("text");
    assert_eq!(output.status.code(), Some(3), "{stderr}");
    assert!(output.stdout.is_empty());
    let start = format!(
        "error: port {} is not permitted: it belongs to group ",
        meter.path()
    );
    assert!(stderr.starts_with(&start), "{stderr}");
    assert!(stderr.contains(", and user "), "{stderr}");
    assert!(
        stderr.ends_with("\nhint: an administrator or a udev rule must let you use it\n"),
        "{stderr}"
    );
    if is_root {
        let _ = fs::remove_file(command.get_program());
    }
}

#[test]
fn a_time_without_unit_is_refused() {
    Program::new("read-registers -p sim: -a 1 0 --timeout 5")
        .code(2)
        .stderr(
            "error: invalid value '5' for '--timeout <TIME>': a time needs its unit, such as 5s \
             or 5ms\n\n\
             For more information, try '--help'.\n",
        )
        .run();
}

#[test]
fn without_a_port_the_option_and_its_variable_are_named() {
    let output = Program::new("read-registers -a 1 0").output();
    assert_eq!(output.status.code(), Some(2));
    let stderr = String::from_utf8(output.stderr).expect("text");
    assert!(stderr.contains("--port <PORT>"), "{stderr}");
    let meter = PtyMeter::healthy(1);
    Program::new("read-registers -a 1 0 -q")
        .variable("METERPOLL_PORT", meter.path())
        .stdout("POINT   VALUE  UNIT\n0x0000      3\n")
        .run();
}

#[test]
fn one_column_cannot_hold_two_readings() {
    Program::new("read-registers -p /nowhere -a 1 0x10:u16 0x10:i16 -f csv")
        .code(2)
        .stderr(
            "error: '0x0010' would be two columns of one name in wide CSV\n\
             hint: ask for it once, or use --layout long or another --format\n",
        )
        .run();
}

#[test]
fn a_name_without_a_meter_is_refused() {
    Program::new("read-registers -p sim: -a 1 current_a")
        .code(2)
        .stderr(
            "error: 'current_a' is no register, and without a meter there are no points\n\
             hint: name the meter with --meter, or registers as 0x0000+10\n",
        )
        .run();
}

#[test]
fn a_line_over_tcp_is_refused_in_so_many_words() {
    Program::new("read-registers -p tcp://192.0.2.1 -a 1 0")
        .code(2)
        .stderr(
            "error: port tcp://192.0.2.1: lines over TCP are not in this version\n\
             hint: give a serial port, or sim: for the simulated line\n",
        )
        .run();
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_exit_7_and_a_closed_pipe_is_quiet() {
    use std::process::Stdio;

    let meter = PtyMeter::healthy(1);
    let program = Program::new(&format!("read-registers -p {} -a 1 0 -f csv", meter.path()));
    let full = fs::OpenOptions::new()
        .write(true)
        .open("/dev/full")
        .expect("Linux has it");
    let output = program
        .command()
        .stdout(full)
        .output()
        .expect("the program starts");
    assert_eq!(output.status.code(), Some(7));
    assert_eq!(
        String::from_utf8(output.stderr).expect("text"),
        "error: the output cannot be written\n  \
         because: No space left on device (os error 28)\n"
    );

    let mut child = program
        .command()
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    // Nobody will read: the same as `| head -0`.
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("the program ends");
    assert_eq!(output.status.code(), Some(7));
    assert_eq!(String::from_utf8(output.stderr).expect("text"), "");
}
