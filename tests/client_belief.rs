//! What is believed to be the answer to a request, and what is not.

#[path = "support/question.rs"]
mod question;

use meterpoll::client::Echo;
use meterpoll::client::belief::{Certainty, Evidence, Verdict};
use meterpoll::codec::rtu;
use meterpoll::codec::{FunctionCode, ReadFunction, ReadValues, Reply, Request, Response};

use self::question::{Question, exception, framed, read, registers, reply_frame};

/// Unit 17 is asked for holding registers 0x006B to 0x006D (AP 6.3, with unit and CRC).
const REQUEST: [u8; 8] = [0x11, 0x03, 0x00, 0x6B, 0x00, 0x03, 0x76, 0x87];
/// The answer: 022B 0000 0064 (AP 6.3).
const ANSWER: [u8; 11] = [
    0x11, 0x03, 0x06, 0x02, 0x2B, 0x00, 0x00, 0x00, 0x64, 0xC8, 0xBA,
];

/// The question of [`REQUEST`].
fn question() -> Question {
    Question::new(read(0x6B, 3))
}

fn values() -> Reply {
    registers(&[0x022B, 0, 0x64])
}

#[test]
fn the_frames_of_the_standard_are_what_is_sent_and_believed() {
    assert_eq!(question().frame.as_bytes(), REQUEST);
    assert_eq!(
        question().judge(&ANSWER),
        Verdict::Answer(values(), Evidence::default())
    );
}

#[test]
fn nothing_is_no_answer_and_no_evidence() {
    assert_eq!(question().judge(&[]), Verdict::Waiting(Evidence::default()));
}

#[test]
fn a_frame_of_another_unit_is_no_answer() {
    let frame = reply_frame(0x12, &registers(&[1, 2, 3]));
    let evidence = question().evidence(&frame);
    assert_eq!(
        evidence,
        Evidence {
            others: 1,
            ..Evidence::default()
        }
    );
    assert_eq!(
        question().answer(&[frame, ANSWER.to_vec()].concat()),
        Some(values())
    );
}

#[test]
fn a_valid_frame_of_the_unit_that_answers_something_else_is_a_mismatch() {
    let input = Response::Registers {
        function: ReadFunction::InputRegisters,
        values: ReadValues::new(vec![1, 2, 3]).expect("values"),
    };
    for (frame, found) in [
        (
            reply_frame(0x11, &Reply::Normal(input)),
            "an answer to function 04 (Read Input Registers)",
        ),
        (
            reply_frame(0x11, &registers(&[1, 2])),
            "2 registers, and 3 asked for",
        ),
        (
            reply_frame(0x11, &registers(&[1, 2, 3, 4])),
            "4 registers, and 3 asked for",
        ),
        (
            framed(&[0x11, 0x03, 0x00]),
            "a malformed frame: 0 registers: a read carries 1 to 125",
        ),
        (
            reply_frame(0x11, &exception(FunctionCode::ReadInputRegisters, 2)),
            "exception 02 (ILLEGAL DATA ADDRESS) to function 04 (Read Input Registers)",
        ),
    ] {
        assert_eq!(
            question().evidence(&frame).mismatch.as_deref(),
            Some(found),
            "{}",
            rtu::Hex(&frame)
        );
        // It costs nothing but time: the answer behind it is believed.
        assert_eq!(
            question().answer(&[&frame, &ANSWER[..]].concat()),
            Some(values())
        );
    }
}

#[test]
fn every_other_byte_count_is_refused() {
    for count in (0..=0xFF_u8).filter(|count| *count != 6) {
        let mut body = vec![0x11, 0x03, count];
        body.resize(3 + usize::from(count), 0x5A);
        assert_eq!(
            question().answer(&framed(&body)),
            None,
            "byte count {count}"
        );
    }
}

#[test]
fn a_frame_with_a_wrong_crc_is_damaged() {
    let mut bytes = ANSWER;
    bytes[9] ^= 0xFF;
    let evidence = question().evidence(&bytes);
    assert!(evidence.damaged.is_some());
    assert_eq!(evidence.mismatch, None);
    let swapped = [&ANSWER[..9], &[0xBA, 0xC8]].concat();
    assert!(question().evidence(&swapped).damaged.is_some());
}

#[test]
fn the_answer_behind_a_damaged_one_is_believed() {
    let mut damaged = ANSWER;
    damaged[4] ^= 0x10;
    assert_eq!(
        question().answer(&[damaged, ANSWER].concat()),
        Some(values())
    );
}

#[test]
fn every_exception_code_is_the_answer_of_a_unit_that_refuses() {
    for code in 0..=0xFF {
        let refusal = exception(FunctionCode::ReadHoldingRegisters, code);
        assert_eq!(
            question().answer(&reply_frame(0x11, &refusal)),
            Some(refusal)
        );
    }
}

#[test]
fn an_exception_to_another_function_is_none_to_this_one() {
    for code in (0..0x80_u8).filter(|code| *code != 0x03) {
        let refusal = exception(FunctionCode::try_from(code).expect("a function"), 2);
        assert_eq!(
            question().answer(&reply_frame(0x11, &refusal)),
            None,
            "{code}"
        );
    }
}

#[test]
fn an_exception_of_another_unit_is_none_of_this_one() {
    let refusal = exception(FunctionCode::ReadHoldingRegisters, 2);
    let evidence = question().evidence(&reply_frame(0x12, &refusal));
    assert_eq!(evidence.others, 1);
}

#[test]
fn noise_before_the_answer_is_skipped_and_counted() {
    for noise in [
        &[0x00][..],
        &[0xFF],
        &[0x00, 0x00, 0x00],
        // The unit's number once and twice more.
        &[0x11],
        &[0x11, 0x11],
        // The beginning of the answer.
        &[0x11, 0x03],
        &[0x11, 0x03, 0x06],
    ] {
        let bytes = [noise, &ANSWER].concat();
        assert_eq!(question().answer(&bytes), Some(values()), "{noise:02X?}");
        assert_eq!(
            question().evidence(&bytes).stray,
            noise.len(),
            "{noise:02X?}"
        );
    }
}

#[test]
fn bytes_behind_the_answer_do_not_matter() {
    for rest in [
        &[0x00][..],
        &[0x00, 0x00, 0x00],
        &[0x11, 0x03, 0x06],
        &ANSWER,
    ] {
        assert_eq!(question().answer(&[&ANSWER, rest].concat()), Some(values()));
    }
}

#[test]
fn an_echo_before_the_answer_is_dropped_and_counted() {
    let bytes = [&REQUEST[..], &ANSWER].concat();
    assert_eq!(question().answer(&bytes), Some(values()));
    assert_eq!(question().evidence(&bytes).echoes, 1);
    // Even two of them, as with an adapter and a converter that both listen.
    let twice = [&REQUEST[..], &REQUEST, &ANSWER].concat();
    assert_eq!(question().answer(&twice), Some(values()));
    assert_eq!(question().evidence(&twice).echoes, 2);
}

#[test]
fn an_echo_alone_is_no_answer() {
    assert_eq!(
        question().judge(&REQUEST),
        Verdict::Waiting(Evidence {
            echoes: 1,
            ..Evidence::default()
        })
    );
}

#[test]
fn part_of_an_echo_before_the_answer_is_skipped() {
    for cut in 1..REQUEST.len() {
        for part in [&REQUEST[..cut], &REQUEST[cut..]] {
            let bytes = [part, &ANSWER].concat();
            assert_eq!(question().answer(&bytes), Some(values()), "{part:02X?}");
        }
    }
}

#[test]
fn an_echo_of_a_read_is_no_answer_on_a_line_said_not_to_echo() {
    let question = question().with(Echo::Off, None);
    assert_eq!(question.answer(&REQUEST), None);
    assert_eq!(question.evidence(&REQUEST).echoes, 0);
    assert_eq!(
        question.answer(&[&REQUEST[..], &ANSWER].concat()),
        Some(values())
    );
}

#[test]
fn one_copy_of_a_mirrored_request_is_the_answer_unless_the_line_echoes() {
    let mirrored = || Question::new(Request::ReturnQueryData(0xA537));
    let copy = mirrored().frame.as_bytes().to_vec();
    let two = [&copy[..], &copy].concat();
    let reply = Some(Reply::Normal(Response::QueryData(0xA537)));
    for (echo, seen, one_is_enough) in [
        (Echo::Auto, None, true),
        (Echo::Auto, Some(false), true),
        (Echo::Auto, Some(true), false),
        (Echo::On, None, false),
        (Echo::Off, Some(true), true),
    ] {
        let question = mirrored().with(echo, seen);
        let expected = reply.clone().filter(|_| one_is_enough);
        assert_eq!(question.answer(&copy), expected, "{echo:?}, seen: {seen:?}");
        assert_eq!(question.answer(&two), reply, "{echo:?}, seen: {seen:?}");
    }
}

#[test]
fn a_loopback_with_another_word_is_no_answer() {
    let question = Question::new(Request::ReturnQueryData(0xA537));
    let other = Reply::Normal(Response::QueryData(0xA538));
    let evidence = question.evidence(&reply_frame(0x11, &other));
    assert_eq!(
        evidence.mismatch.as_deref(),
        Some("0xA538, and 0xA537 was sent")
    );
}

#[test]
fn one_register_that_looks_like_the_own_echo_is_believed_only_where_nothing_echoes() {
    // Register 0x02A0 of unit 17 holds 0xA000: the request and the answer, CRC included, start
    // with the same seven bytes.
    let question = || Question::new(read(0x02A0, 1));
    let alike = reply_frame(0x11, &registers(&[0xA000]));
    let echo = question().frame.as_bytes().to_vec();
    assert_eq!(alike, echo[..7]);

    assert_eq!(
        question().judge(&alike),
        Verdict::Waiting(Evidence {
            mismatch: Some("what may be the echo of the request".to_owned()),
            ..Evidence::default()
        })
    );
    assert_eq!(question().evidence(&echo).echoes, 1);
    // The last byte of an echo can be damaged, so one that differs proves nothing.
    assert_eq!(question().answer(&[&alike[..], &[0xFF]].concat()), None);
    assert_eq!(
        question().with(Echo::Off, None).answer(&alike),
        Some(registers(&[0xA000]))
    );
    // Another value of that register is like any other.
    let other = reply_frame(0x11, &registers(&[0xA001]));
    assert_eq!(question().answer(&other), Some(registers(&[0xA001])));
}

#[test]
fn a_status_that_looks_like_the_own_echo_and_a_zero_is_believed_only_where_nothing_echoes() {
    // 11 07 4C 22 is the request; status 4C makes 11 07 4C 22 00 of the answer.
    let question = || Question::new(Request::ReadExceptionStatus);
    let answer = reply_frame(0x11, &Reply::Normal(Response::ExceptionStatus(0x4C)));
    assert_eq!(answer, [question().frame.as_bytes(), &[0x00]].concat());
    assert_eq!(question().answer(&answer), None);
    assert_eq!(
        question().with(Echo::Off, None).answer(&answer),
        Some(Reply::Normal(Response::ExceptionStatus(0x4C)))
    );
}

#[test]
fn an_exception_inside_an_answer_that_is_not_whole_yet_is_not_believed() {
    // Registers 0x006B to 0x006D hold what an exception of unit 17 looks like.
    let refusal = framed(&[0x11, 0x83, 0x02]);
    let whole = framed(&[&[0x11, 0x03, 0x06][..], &refusal, &[0x00]].concat());
    let inside = &whole[..3 + refusal.len()];
    assert_eq!(
        question().judge(inside),
        Verdict::Waiting(Evidence {
            stray: 3,
            begun: Some((8, 11)),
            ..Evidence::default()
        })
    );
    let values = registers(&[0x1183, 0x02C1, 0x3400]);
    assert_eq!(question().answer(&whole), Some(values));
}

#[test]
fn how_sure_it_is_that_the_answer_was_damaged_depends_on_what_else_it_can_have_been() {
    use Certainty::{Certain, Doubtful, Likely};
    let certainty = |question: &Question, mut frame: Vec<u8>| {
        if let Some(last) = frame.last_mut() {
            *last ^= 0x01;
        }
        question.evidence(&frame).damaged
    };
    let echo_first = [&REQUEST[..], &ANSWER].concat();
    for (echo, echoes, alone, behind_echo) in [
        (Echo::Auto, None, Likely, Certain),
        (Echo::Auto, Some(true), Likely, Certain),
        (Echo::Auto, Some(false), Certain, Certain),
        (Echo::On, None, Likely, Certain),
        (Echo::Off, None, Certain, Certain),
    ] {
        let question = question().with(echo, echoes);
        assert_eq!(certainty(&question, ANSWER.to_vec()), Some(alone));
        assert_eq!(certainty(&question, echo_first.clone()), Some(behind_echo));
    }
    // Two bytes of a short frame can be chance.
    let sure = |request| Question::new(request).with(Echo::Off, None);
    let refusal = exception(FunctionCode::ReadHoldingRegisters, 2);
    let refusal = reply_frame(0x11, &refusal);
    assert_eq!(certainty(&sure(read(0x6B, 3)), refusal), Some(Doubtful));
    let status = Reply::Normal(Response::ExceptionStatus(0x5A));
    let status = reply_frame(0x11, &status);
    assert_eq!(
        certainty(&sure(Request::ReadExceptionStatus), status),
        Some(Doubtful)
    );
    // The request for one register at 0x0240 starts like its answer, so this may be its echo.
    let alike = sure(read(0x0240, 1));
    let one = reply_frame(0x11, &registers(&[7]));
    assert_eq!(certainty(&alike, one), Some(Doubtful));
    assert_eq!(
        certainty(&alike, alike.frame.as_bytes().to_vec()),
        Some(Doubtful)
    );
}

#[test]
fn every_truncation_is_waited_for() {
    for cut in 1..ANSWER.len() {
        assert_eq!(
            question().judge(&ANSWER[..cut]),
            Verdict::Waiting(Evidence {
                stray: cut,
                begun: Some((cut, 11)),
                ..Evidence::default()
            })
        );
    }
}

#[test]
fn no_answer_with_a_flipped_bit_is_believed() {
    for bit in 0..8 * ANSWER.len() {
        let mut flipped = ANSWER;
        flipped[bit / 8] ^= 1 << (bit % 8);
        assert_eq!(question().answer(&flipped), None, "bit {bit}");
    }
}
