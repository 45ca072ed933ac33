//! What is read is written as it was: messages in both directions, and values in registers.

use meterpoll::codec::rtu::{
    Hex, check, decode_reply, decode_request, encode_broadcast, encode_reply, encode_request,
};
use meterpoll::codec::value::{ByteOrder, Raw, RegisterType, decode, encode};
use meterpoll::codec::{Broadcast, Destination, Request};

use super::cursor::Cursor;

const TYPES: [RegisterType; 16] = [
    RegisterType::U16,
    RegisterType::I16,
    RegisterType::U32,
    RegisterType::I32,
    RegisterType::U64,
    RegisterType::I64,
    RegisterType::F32,
    RegisterType::F64,
    RegisterType::Hex,
    RegisterType::Bits,
    RegisterType::Mod10000,
    RegisterType::Letter,
    RegisterType::Time,
    RegisterType::Date,
    RegisterType::Ascii(1),
    RegisterType::Ascii(13),
];

const ORDERS: [ByteOrder; 4] = [
    ByteOrder::Abcd,
    ByteOrder::Cdab,
    ByteOrder::Badc,
    ByteOrder::Dcba,
];

/// Reads the bytes as they are, with a right CRC behind them, and as registers.
pub(crate) fn codec(data: &[u8]) {
    messages(data);
    messages(&[data, &check(data)].concat());
    let mut cursor = Cursor::new(data);
    let kind = cursor.pick(&TYPES);
    let order = cursor.pick(&ORDERS);
    let registers: Vec<u16> = (0..kind.registers()).map(|_| cursor.word()).collect();
    match decode(kind, order, &registers) {
        // Spaces and NULs at the end are gone.
        Ok(Raw::Text(text)) => assert!(text.is_ascii()),
        Ok(value) => {
            let again = encode(kind, order, &value);
            assert_eq!(again.as_ref(), Some(&registers), "{kind:?} {order:?}");
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

fn messages(bytes: &[u8]) {
    if let Ok((unit, reply)) = decode_reply(bytes) {
        let again = encode_reply(unit, &reply);
        assert_eq!(again.as_bytes(), bytes, "{}", Hex(bytes));
    }
    let again = match decode_request(bytes) {
        Ok((Destination::Unit(unit), request)) => encode_request(unit, &request),
        Ok((Destination::Broadcast, Request::Write(write))) => encode_broadcast(Broadcast, &write),
        Ok((Destination::Broadcast, request)) => panic!("broadcast of {request:?}"),
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    assert_eq!(again.as_bytes(), bytes, "{}", Hex(bytes));
}
