//! Meters that do not give everything, read by the real program: what is printed, what it ends
//! with, and what the meter sees.

#![cfg(unix)]

mod support {
    pub(crate) mod program;
    pub(crate) mod pty;
}

use std::fs;
use std::path::PathBuf;

use meterpoll::codec::{Destination, ExceptionCode, Reply, Request, rtu};
use support::program::Program;
use support::pty::{self, PtyMeter};

/// How the meter answers a read, by unit, first register and count: well, with an exception, or
/// not at all.
type Answer = fn(unit: u16, start: u16, count: u16) -> Result<(), Option<u8>>;

fn meter(answer: Answer) -> PtyMeter {
    PtyMeter::new(Box::new(move |frame| {
        let Ok((Destination::Unit(unit), Request::Read { function, range })) =
            rtu::decode_request(frame)
        else {
            return Vec::new();
        };
        let number = u16::from(unit.get());
        match answer(number, range.start().get(), range.count()) {
            Ok(()) => pty::answer(number, frame).unwrap_or_default(),
            Err(None) => Vec::new(),
            Err(Some(code)) => {
                let reply = Reply::Exception {
                    function: function.into(),
                    code: ExceptionCode(code),
                };
                rtu::encode_reply(unit, &reply).as_bytes().to_vec()
            }
        }
    }))
}

/// Unit, first register and count of each request that the meter has seen, but for the second look
/// at a refusal that is like one before.
fn requests(meter: &PtyMeter) -> Vec<(u16, u16, u16)> {
    let word = |frame: &[u8], at: usize| u16::from_be_bytes([frame[at], frame[at + 1]]);
    let requests = meter.requests();
    let read = |frame: &Vec<u8>| (u16::from(frame[0]), word(frame, 2), word(frame, 4));
    let mut requests: Vec<_> = requests.iter().map(read).collect();
    requests.dedup();
    requests
}

fn read(meter: &PtyMeter, arguments: &str) -> Program {
    Program::new(&format!(
        "read-registers -p {} -b 38400 -f csv {arguments}",
        meter.path()
    ))
}

fn joined(parts: impl Iterator<Item = String>) -> String {
    parts.collect::<Vec<_>>().concat()
}

/// The wide CSV of registers from 0 of healthy units.
fn csv(units: &[u16], count: u16) -> String {
    let names = joined((0..count).map(|a| format!(",0x{a:04X}")));
    let values = joined((0..count).map(|a| format!(",{}", pty::register(a))));
    let row = |unit: &u16| format!("<time>,,{unit},ok{values}\n");
    let rows = joined(units.iter().map(row));
    format!("time,meter,unit_id,status{names}\n{rows}")
}

#[test]
fn a_meter_of_11_registers_is_read_without_a_word() {
    for refusal in [Some(2), Some(3)] {
        let answer: Answer = match refusal {
            Some(2) => |_, _, count| if count > 11 { Err(Some(2)) } else { Ok(()) },
            _ => |_, _, count| if count > 11 { Err(Some(3)) } else { Ok(()) },
        };
        let meter = meter(answer);
        read(&meter, "-a 1 -t 10s 0+24").stdout(csv(&[1], 24)).run();
        let expected = [(0, 24), (0, 12), (12, 12), (0, 6), (6, 6), (12, 6), (18, 6)];
        assert_eq!(
            requests(&meter),
            expected.map(|(start, count)| (1, start, count))
        );
    }
}

#[test]
fn a_meter_that_is_silent_on_more_than_11_registers_is_read_without_a_word() {
    let meter = meter(|_, _, count| if count > 11 { Err(None) } else { Ok(()) });
    read(&meter, "-a 1 -t 1500ms 0+24")
        .stdout(csv(&[1], 24))
        .run();
    let expected = [(0, 24), (0, 1), (1, 11), (12, 12), (12, 6), (18, 6)];
    assert_eq!(
        requests(&meter),
        expected.map(|(start, count)| (1, start, count))
    );
}

#[test]
fn what_one_unit_teaches_is_not_applied_to_another() {
    let meter = meter(|unit, _, count| {
        let most = if unit == 1 { 11 } else { 20 };
        if count > most { Err(Some(3)) } else { Ok(()) }
    });
    read(&meter, "-a 1,2,3 -t 10s 0+20")
        .stdout(csv(&[1, 2, 3], 20))
        .run();
    assert_eq!(
        requests(&meter),
        [(1, 0, 20), (1, 0, 10), (1, 10, 10), (2, 0, 20), (3, 0, 20)]
    );
}

#[test]
fn verbose_tells_what_was_learned_and_how_a_profile_says_so() {
    let meter = meter(|_, _, count| if count > 11 { Err(Some(3)) } else { Ok(()) });
    let output = read(&meter, "-a 1 -v -t 10s 0+22").output();
    let stderr = String::from_utf8(output.stderr).expect("text");
    let learned: Vec<&str> = stderr
        .lines()
        .filter(|line| line.contains("from now on"))
        .collect();
    assert_eq!(
        learned,
        [
            "unit 1: no more than 11 registers, which worked, are read at once from now on; a \
             profile says so with limits.read_registers = 11, or more where the meter gives more"
        ]
    );
}

/// A profile of points `a` to `t` at 0x00 to 0x13, with a hole where `gap` is.
fn profile(name: &str, limits: &str, gap: Option<u16>) -> PathBuf {
    let points = ('a'..='t').zip(0_u16..);
    let points = points.filter(|(_, address)| Some(*address) != gap);
    let points = joined(points.map(|(name, address)| {
        format!("[[points]]\nname = \"{name}\"\naddress = {address}\ntype = \"u16\"\n")
    }));
    let text = format!(
        "name = \"{name}\"\ntitle = \"Title\"\nmanual = \"none\"\n{limits}\ngroups.default = [\"*\"]\n{points}"
    );
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.toml"));
    fs::write(&path, text).expect("the folder for tests is writable");
    path
}

#[test]
fn one_refused_point_among_twenty_costs_one_cell_and_one_message() {
    let meter = meter(|_, start, count| {
        if (start..start + count).contains(&7) {
            Err(Some(2))
        } else {
            Ok(())
        }
    });
    let cells = joined((0..20).map(|address| match address {
        7 => ",".to_owned(),
        _ => format!(",{}", pty::register(address)),
    }));
    read(&meter, "-a 1 -t 10s --meter")
        .argument(profile("refused", "", None))
        .code(1)
        .stdout(format!(
            "time,meter,unit_id,status,a,b,c,d,e,f,g,h,i,j,k,l,m,n,o,p,q,r,s,t\n\
             <time>,refused,1,exception:2{cells}\n"
        ))
        .stderr(format!(
            "error: unit 1 on {} at 38400 8N1, h (registers 0x0007+1): the meter refused: \
             exception 02 (ILLEGAL DATA ADDRESS)\n\
             hint: this meter, or its firmware, has no such registers\n",
            meter.path()
        ))
        .run();
    assert_eq!(requests(&meter).len(), 9);
}

#[test]
fn many_refused_points_are_one_message() {
    let meter = meter(|_, start, count| {
        let gone = |register| [1, 2, 4, 6, 8].contains(&register);
        if (start..start + count).any(gone) {
            Err(Some(2))
        } else {
            Ok(())
        }
    });
    read(&meter, "-q -a 1 -t 10s a b c d e f g h i j 8 --meter")
        .argument(profile("gone", "", None))
        .code(1)
        .stdout(
            "time,meter,unit_id,status,a,b,c,d,e,f,g,h,i,j,0x0008\n\
             <time>,gone,1,exception:2,3,,,24,,38,,52,,66,\n",
        )
        .stderr(format!(
            "error: unit 1 on {} at 38400 8N1, b, c, e and 2 more (registers 0x0001+2, \
             0x0004+1, 0x0006+1 and 1 more): the meter refused: exception 02 (ILLEGAL DATA ADDRESS)\n",
            meter.path()
        ))
        .run();
    read(&meter, "-q -a 1 -t 10s 0+10")
        .code(1)
        .stdout(
            "time,meter,unit_id,status,0x0000,0x0001,0x0002,0x0003,0x0004,0x0005,0x0006,0x0007,\
             0x0008,0x0009\n\
             <time>,,1,exception:2,3,,,24,,38,,52,,66\n",
        )
        .stderr(format!(
            "error: unit 1 on {} at 38400 8N1, registers 0x0001+2, 0x0004+1, 0x0006+1 and 1 more: \
             the meter refused: exception 02 (ILLEGAL DATA ADDRESS)\n",
            meter.path()
        ))
        .run();
}

#[test]
fn a_refused_hole_is_read_around() {
    let meter = meter(|_, start, count| {
        if (start..start + count).contains(&7) {
            Err(Some(2))
        } else {
            Ok(())
        }
    });
    let path = profile("hole", "limits.read_holes = true", Some(7));
    let output = read(&meter, "-a 1 -t 10s -v --meter")
        .argument(path)
        .output();
    assert_eq!(output.status.code(), Some(0));
    let stderr = String::from_utf8(output.stderr).expect("text");
    assert!(
        stderr.contains(
            "unit 1: only registers that points name are read from now on; a profile says so \
             with limits.read_holes = false\n"
        ),
        "{stderr}"
    );
    assert_eq!(requests(&meter), [(1, 0, 20), (1, 0, 7), (1, 8, 12)]);
}

#[test]
fn a_point_that_this_meter_lacks_is_run_over_no_more_and_others_are() {
    let meter = meter(|_, start, count| {
        if (start..start + count).contains(&2) {
            Err(Some(2))
        } else {
            Ok(())
        }
    });
    // Points c, r and so on lie between those asked for; a read of b and d runs over c.
    let path = profile("lacking", "limits.read_registers = 5", None);
    let output = read(&meter, "-a 1 -t 10s -v a b d e k m q s --meter")
        .argument(path)
        .output();
    assert_eq!(output.status.code(), Some(0));
    let stderr = String::from_utf8(output.stderr).expect("text");
    let learned: Vec<&str> = stderr
        .lines()
        .filter(|line| line.contains("from now on"))
        .collect();
    assert_eq!(
        learned,
        ["unit 1: no other read covers registers 0x0002+1 from now on"]
    );
    assert_eq!(
        requests(&meter),
        [(1, 0, 5), (1, 0, 2), (1, 3, 2), (1, 10, 3), (1, 16, 3)]
    );
}

#[test]
fn a_unit_that_is_not_there_is_told_once_with_its_setting_and_its_attempts() {
    let meter = meter(|_, _, _| Err(None));
    read(&meter, "-q -a 1 -t 200ms --retries 1 0+20 0x100+20")
        .code(4)
        .stdout({
            let names = (0..20).chain(0x100..0x114).map(|a| format!(",0x{a:04X}"));
            format!(
                "time,meter,unit_id,status{}\n<time>,,1,timeout{}\n",
                joined(names),
                ",".repeat(40)
            )
        })
        .stderr(format!(
            "error: unit 1 on {} at 38400 8N1, registers 0x0000+20: no answer within 200ms, 2 \
             attempts; 1 more read of this unit was not tried\n",
            meter.path()
        ))
        .run();
    assert_eq!(requests(&meter), [(1, 0, 20), (1, 0, 1)]);
}
