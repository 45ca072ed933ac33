//! What the fuzzer (`tests/fuzz`) tries on the bytes it finds, tried here on random ones.

mod support {
    pub(crate) mod cases;
    pub(crate) mod fuzz;
}

use proptest::prelude::*;

use support::cases::hold;
use support::fuzz::{chunks, codec, profile, reply, session};

/// Runs a property on the same bytes every time, up to so many.
fn check(cases: u32, most: usize, property: fn(&[u8])) {
    let bytes = prop::collection::vec(any::<u8>(), 0..most);
    hold(cases, &bytes, |bytes| {
        property(&bytes);
        Ok(())
    });
}

#[test]
fn what_is_believed_is_a_frame_that_answers_the_request() {
    check(4000, 600, reply::reply);
}

#[test]
fn a_session_on_a_bad_line_has_no_wrong_value_and_ends_well() {
    check(3000, 400, session::session);
}

#[test]
fn however_bytes_are_cut_the_client_makes_the_same_of_them() {
    check(2000, 600, chunks::chunks);
}

#[test]
fn what_is_read_is_written_as_it_was() {
    check(20_000, 60, codec::codec);
}

#[test]
fn no_text_stops_the_program() {
    check(300, 200, profile::profile);
}
