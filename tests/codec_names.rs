//! Codes and their names, typed from the standard and compared with the codec.
//!
//! "AP" is the Modbus Application Protocol Specification V1.1b3, "SL" Modbus over Serial Line
//! V1.02.

use meterpoll::codec::{DecodeError, ExceptionCode, FunctionCode, Reply, Request};

fn request(unit: &[u8]) -> DecodeError {
    Request::decode(unit).unwrap_err()
}

fn reply(unit: &[u8]) -> DecodeError {
    Reply::decode(unit).unwrap_err()
}

#[test]
fn functions_have_the_standards_names() {
    // AP 6.3 to 6.8 and 6.12: code, name.
    let table = [
        (3, "function 03 (Read Holding Registers)"),
        (4, "function 04 (Read Input Registers)"),
        (5, "function 05 (Write Single Coil)"),
        (6, "function 06 (Write Single Register)"),
        (7, "function 07 (Read Exception Status)"),
        (8, "function 08 (Diagnostics)"),
        (16, "function 16 (Write Multiple Registers)"),
        (1, "function 0x01"),
        (0x14, "function 0x14"),
        (0x2B, "function 0x2B"),
    ];
    for (code, name) in table {
        let function = FunctionCode::try_from(code).unwrap();
        assert_eq!(function.to_string(), name);
        assert_eq!(function.get(), code);
        assert_eq!(function.exception(), code + 0x80);
    }
}

#[test]
fn every_code_that_is_no_function_spoken_is_not_handled_in_either_direction() {
    for code in (0..=0x7F).filter(|code| !matches!(code, 3..=8 | 16)) {
        let function = FunctionCode::try_from(code).unwrap();
        assert!(matches!(function, FunctionCode::Other(_)));
        let error = DecodeError::Function(function);
        assert_eq!(request(&[code, 0, 0, 0, 1]), error);
        assert_eq!(reply(&[code, 0, 0, 0, 1]), error);
    }
    for code in 0x80..=0xFF {
        let error = DecodeError::Field {
            field: "function code",
            found: u16::from(code),
        };
        assert_eq!(FunctionCode::try_from(code), Err(error));
        assert_eq!(request(&[code, 1]), error);
    }
}

#[test]
fn exceptions_have_the_standards_names() {
    // AP 7.
    let table = [
        (0x01, "exception 01 (ILLEGAL FUNCTION)"),
        (0x02, "exception 02 (ILLEGAL DATA ADDRESS)"),
        (0x03, "exception 03 (ILLEGAL DATA VALUE)"),
        (0x04, "exception 04 (SERVER DEVICE FAILURE)"),
        (0x05, "exception 05 (ACKNOWLEDGE)"),
        (0x06, "exception 06 (SERVER DEVICE BUSY)"),
        (0x07, "exception 07"),
        (0x08, "exception 08 (MEMORY PARITY ERROR)"),
        (0x09, "exception 09"),
        (0x0A, "exception 0A (GATEWAY PATH UNAVAILABLE)"),
        (
            0x0B,
            "exception 0B (GATEWAY TARGET DEVICE FAILED TO RESPOND)",
        ),
        (0x0C, "exception 0C"),
        (0xFF, "exception FF"),
    ];
    for (code, name) in table {
        assert_eq!(ExceptionCode(code).to_string(), name);
    }
}

#[test]
fn every_exception_of_every_function_survives_decoding() {
    for function in 0..=0x7F {
        for code in 0..=0xFF {
            let expected = Reply::Exception {
                function: FunctionCode::try_from(function).unwrap(),
                code: ExceptionCode(code),
            };
            assert_eq!(Reply::decode(&[function + 0x80, code]), Ok(expected));
        }
    }
}
