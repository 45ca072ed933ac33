//! `loopback` on the simulated line: its formats, and what it refuses.

mod support {
    pub(crate) mod program;
    pub(crate) mod tried;
}

use std::path::PathBuf;
use std::time::{Duration, Instant};

use support::tried::{check, run};

#[test]
fn every_simulated_meter_sends_back_what_its_profile_says() {
    for (unit, meter) in [(1, "em24"), (2, "pm290"), (3, "em21"), (17, "pqm")] {
        let (code, stdout, stderr) = run(&format!(
            "-p sim: -a {unit} --meter {meter} --count 36 -b 115200 -f csv"
        ));
        assert_eq!((code, stdout.lines().count()), (Some(0), 37), "{meter}");
        assert!(
            stderr.ends_with("the line is good: 36 of 36 answered, no damage, no noise\n"),
            "{meter}: {stderr}"
        );
    }
}

#[test]
fn csv_has_a_row_a_try_and_the_summary_on_stderr() {
    check(
        "-p sim: -a 17,3 --count 2 -f csv",
        1,
        "time,meter,unit_id,try,word,status,answer_ms\n\
         <time>,,17,1,0x0000,ok,<ms>\n\
         <time>,,17,2,0xFFFF,exception:3,\n\
         <time>,,3,1,0x0000,ok,<ms>\n\
         <time>,,3,2,0xFFFF,ok,<ms>\n",
        "2 tries, 1 answered, 1 refused, 0 lost (0.0 %)\n\
         answer times: min <ms>, median <ms>, p95 <ms>, max <ms> ms\n\
         damaged answers: 0, noise bytes: 0, late answers: 0, frames of others: 0, echo: no\n\
         the line carries every frame, but the meter refused 1 of 2\n\
         hint: name the meter with --meter: a profile knows what its meter sends back, and \
         whether it has function 08 at all\n\
         2 tries, 2 answered, 0 lost (0.0 %)\n\
         answer times: min <ms>, median <ms>, p95 <ms>, max <ms>, jitter <ms> ms\n\
         damaged answers: 0, noise bytes: 0, late answers: 0, frames of others: 0, echo: no\n\
         the line is good: 2 of 2 answered, no damage, no noise\n",
    );
    check(
        "-p sim: -a 17 --meter pqm --count 1 -f csv -q",
        0,
        "time,meter,unit_id,try,word,status,answer_ms\n<time>,pqm,17,1,0x0000,ok,<ms>\n",
        "",
    );
}

#[test]
fn json_is_one_object_with_settings_tries_and_summary() {
    check(
        "-p sim: -a 3,9 --count 1 -b 19200 -P even -t 50ms -f json -q",
        1,
        "{\"port\":\"sim:\",\"baud\":19200,\"parity\":\"even\",\"stop_bits\":1,\"timeout\":\"50ms\",\
         \"interval\":\"0s\",\"count\":1,\"units\":[\n\
         {\"meter\":null,\"unit_id\":3,\"tries\":[\n\
         {\"time\":\"<time>\",\"try\":1,\"word\":\"0x0000\",\"status\":\"ok\",\"answer_ms\":<ms>}\n\
         ],\"summary\":{\"tries\":1,\"answered\":1,\"refused\":0,\"lost\":0,\"min_ms\":<ms>,\
         \"median_ms\":<ms>,\"p95_ms\":<ms>,\"max_ms\":<ms>,\"jitter_ms\":null,\
         \"damaged_answers\":0,\"noise_bytes\":0,\"late_answers\":0,\"other_frames\":0,\
         \"echo\":false,\"verdict\":\"good\",\
         \"words\":\"the line is good: 1 of 1 answered, no damage, no noise\"}},\n\
         {\"meter\":null,\"unit_id\":9,\"tries\":[\n\
         {\"time\":\"<time>\",\"try\":1,\"word\":\"0x0000\",\"status\":\"timeout\",\"answer_ms\":null}\n\
         ],\"summary\":{\"tries\":1,\"answered\":0,\"refused\":0,\"lost\":1,\"min_ms\":null,\
         \"median_ms\":null,\"p95_ms\":null,\"max_ms\":null,\"jitter_ms\":null,\
         \"damaged_answers\":0,\"noise_bytes\":0,\"late_answers\":0,\"other_frames\":0,\
         \"echo\":false,\"verdict\":\"bad\",\"words\":\"the line is bad: none of 1 answered\"}}\n\
         ]}\n",
        "",
    );
}

#[test]
fn several_units_get_a_block_each() {
    let (code, stdout, stderr) = run("-p sim: -a 1,3 --count 1 -q");
    assert_eq!((code, stderr.as_str()), (Some(0), ""));
    assert!(
        stdout.starts_with("unit 1\n1: 0x0000 back after <ms> ms\n"),
        "{stdout}"
    );
    assert!(
        stdout.contains("no noise\n\nunit 3\n1: 0x0000 back after <ms> ms\n"),
        "{stdout}"
    );
}

#[test]
fn a_port_that_is_not_there_ends_it_with_3() {
    let (code, stdout, stderr) = run("-p /dev/ttyNone -a 17");
    assert_eq!((code, stdout.as_str()), (Some(3), ""));
    assert!(stderr.starts_with("error: "), "{stderr}");
}

#[test]
fn what_cannot_be_tested_is_refused_before_sending() {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("loopback-none.toml");
    let profile = "name = \"none\"\ntitle = \"None\"\nmanual = \"none\"\n\
                   [[points]]\nname = \"a\"\naddress = 0\ntype = \"u16\"\n";
    std::fs::write(&path, profile).expect("the folder for tests is writable");
    for (arguments, stderr) in [
        (
            format!("-a 17 --meter {}", path.display()),
            "error: none does not answer function 08\n\
             hint: without --meter it is sent all the same, and the meter may refuse it\n",
        ),
        (
            "-a 1,2 --forever".to_owned(),
            "error: --forever is for one unit\n",
        ),
        (
            "-a 0".to_owned(),
            "error: unit 0 is the broadcast address, which no meter answers\n\
             hint: meters are 1 to 247; `meterpoll broadcast` writes to all of them at once\n",
        ),
        (
            "-a 17 --retries 1".to_owned(),
            "error: invalid value '1' for '--retries <COUNT>': each try is made once; --count \
             says how many there are\n\n\
             For more information, try '--help'.\n",
        ),
        (
            "-a 17 --count 0".to_owned(),
            "error: invalid value '0' for '--count <COUNT>': 0 is not in 1..=1000000\n\n\
             For more information, try '--help'.\n",
        ),
    ] {
        check(&format!("-p sim: {arguments}"), 2, "", stderr);
    }
}

#[test]
fn a_dry_run_prints_what_would_be_sent() {
    check(
        "-a 17,18 --count 2 --dry-run",
        0,
        "11 03 00 00 00 01 86 9A\n\
         11 08 00 00 00 00 E2 9B\n\
         11 08 00 00 FF FF E3 2B\n\
         12 08 00 00 00 00 E2 A8\n\
         12 08 00 00 FF FF E3 18\n",
        "",
    );
    check(
        "-a 17 --meter pqm --count 2 --dry-run",
        0,
        "11 03 00 00 00 01 86 9A\n11 08 00 00 00 00 E2 9B\n11 08 00 00 00 00 E2 9B\n",
        "",
    );
}
#[test]
fn an_interval_is_kept_from_start_to_start() {
    let start = Instant::now();
    let (code, _, _) = run("-p sim: -a 17 --meter pqm --count 4 --interval 80ms -q");
    assert_eq!(code, Some(0));
    // Nothing is waited for behind the last.
    assert!(start.elapsed() >= Duration::from_millis(240));
}
