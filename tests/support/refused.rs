//! Bytes that are refused, and why.

use meterpoll::codec::rtu::check;
use meterpoll::codec::{DecodeError, Reply, Request};

/// A frame with a right CRC: `body` is the unit and the data unit.
pub(crate) fn sealed(body: &[u8]) -> Vec<u8> {
    [body, &check(body)].concat()
}

/// A data unit that ends in `count` bytes of 0.
pub(crate) fn padded(head: &[u8], count: usize) -> Vec<u8> {
    [head, &vec![0; count]].concat()
}

/// Why this is no data unit of a request.
pub(crate) fn request(unit: &[u8]) -> DecodeError {
    Request::decode(unit).unwrap_err()
}

/// Why this is no data unit of a reply.
pub(crate) fn reply(unit: &[u8]) -> DecodeError {
    Reply::decode(unit).unwrap_err()
}
