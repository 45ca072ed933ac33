//! What holds for every value in registers, tried on random ones.

use meterpoll::codec::value::{ByteOrder, Raw, RegisterType, decode, encode_integer};
use proptest::prelude::*;
use proptest::sample::select;

const TYPES: [RegisterType; 15] = [
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
    RegisterType::Ascii(13),
    RegisterType::Mod10000,
    RegisterType::Letter,
    RegisterType::Time,
    RegisterType::Date,
];

const ORDERS: [ByteOrder; 4] = [
    ByteOrder::Abcd,
    ByteOrder::Cdab,
    ByteOrder::Badc,
    ByteOrder::Dcba,
];

fn cases(cases: u32) -> ProptestConfig {
    ProptestConfig {
        failure_persistence: None,
        ..ProptestConfig::with_cases(cases)
    }
}

proptest! {
    #![proptest_config(cases(2048))]

    #[test]
    fn random_registers_are_a_value_or_an_error_and_never_a_panic(
        kind in prop_oneof![select(&TYPES[..]), any::<u8>().prop_map(RegisterType::Ascii)],
        order in select(&ORDERS[..]),
        words in prop::collection::vec(any::<u16>(), 130),
        length in prop_oneof![3 => Just(None), 1 => (0_usize..=130).prop_map(Some)],
    ) {
        let takes = usize::from(kind.registers());
        let length = length.unwrap_or(takes);
        let registers = words.get(..length).unwrap();
        match decode(kind, order, registers) {
            Ok(Raw::Integer(number)) => {
                let encoded = encode_integer(kind, order, number);
                prop_assert_eq!(encoded.as_deref(), Some(registers));
            }
            Ok(Raw::Word(word)) => {
                let encoded = encode_integer(kind, order, i128::from(word));
                prop_assert_eq!(encoded.as_deref(), Some(registers));
            }
            Ok(Raw::Text(text)) => prop_assert!(text.is_ascii()),
            Ok(_) => prop_assert_eq!(length, takes),
            Err(_) => {}
        }
    }

    #[test]
    fn an_integer_survives_its_registers(
        kind in select(&TYPES[..]),
        order in select(&ORDERS[..]),
        number in any::<i64>(),
    ) {
        if let Some((lowest, highest)) = kind.bounds() {
            let number = lowest + i128::from(number).rem_euclid(highest - lowest + 1);
            integer_survives(kind, order, number)?;
        }
    }

    #[test]
    fn a_float_has_its_bytes_where_the_order_says(
        order in select(&ORDERS[..]),
        single in any::<[u8; 4]>(),
        double in any::<[u8; 8]>(),
    ) {
        let value = decode(RegisterType::F32, order, &laid_out(order, &single)).unwrap();
        let Raw::Single(found) = value else { panic!("{value:?}") };
        prop_assert_eq!(found.to_be_bytes(), single);
        let value = decode(RegisterType::F64, order, &laid_out(order, &double)).unwrap();
        let Raw::Double(found) = value else { panic!("{value:?}") };
        prop_assert_eq!(found.to_be_bytes(), double);
    }

    #[test]
    fn an_integer_has_its_bytes_where_the_order_says(
        order in select(&ORDERS[..]),
        bytes in any::<[u8; 8]>(),
    ) {
        let [a, b, c, d, ..] = bytes;
        let double = laid_out(order, &[a, b, c, d]);
        let unsigned = i128::from(u32::from_be_bytes([a, b, c, d]));
        prop_assert_eq!(decode(RegisterType::U32, order, &double), Ok(Raw::Integer(unsigned)));
        let quadruple = laid_out(order, &bytes);
        let signed = i128::from(i64::from_be_bytes(bytes));
        prop_assert_eq!(decode(RegisterType::I64, order, &quadruple), Ok(Raw::Integer(signed)));
    }
}

/// The registers that carry bytes given most significant first, by the letters of the order.
fn laid_out(order: ByteOrder, bytes: &[u8]) -> Vec<u16> {
    let words = bytes.chunks_exact(2).map(|pair| match (order, pair) {
        (ByteOrder::Abcd | ByteOrder::Cdab, &[high, low]) => u16::from_be_bytes([high, low]),
        (ByteOrder::Badc | ByteOrder::Dcba, &[high, low]) => u16::from_be_bytes([low, high]),
        _ => panic!("a chunk of two"),
    });
    match order {
        ByteOrder::Abcd | ByteOrder::Badc => words.collect(),
        ByteOrder::Cdab | ByteOrder::Dcba => words.rev().collect(),
    }
}

fn integer_survives(
    kind: RegisterType,
    order: ByteOrder,
    number: i128,
) -> Result<(), TestCaseError> {
    let registers = encode_integer(kind, order, number).unwrap();
    prop_assert_eq!(registers.len(), usize::from(kind.registers()));
    let expected = match kind {
        RegisterType::Hex | RegisterType::Bits => Raw::Word(u16::try_from(number).unwrap()),
        RegisterType::Letter => {
            let letter = u8::try_from(number).unwrap() - 1 + b'A';
            Raw::Text(char::from(letter).to_string())
        }
        _ => Raw::Integer(number),
    };
    prop_assert_eq!(decode(kind, order, &registers), Ok(expected));
    Ok(())
}

#[test]
fn the_ends_of_every_integer_type_survive_their_registers() {
    for kind in TYPES {
        let Some((lowest, highest)) = kind.bounds() else {
            continue;
        };
        for order in ORDERS {
            for number in [lowest, lowest + 1, -1, 0, 1, highest - 1, highest] {
                if (lowest..=highest).contains(&number) {
                    integer_survives(kind, order, number).unwrap();
                } else {
                    assert_eq!(encode_integer(kind, order, number), None);
                }
            }
        }
    }
}
