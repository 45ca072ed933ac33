//! What holds for every value in registers, tried on random ones.

use meterpoll::codec::value::{ByteOrder, Raw, RegisterType, decode, encode, encode_integer};
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
            // Any bits a float has are kept, those of NaN included.
            Ok(other) => {
                prop_assert_eq!(length, takes);
                let encoded = encode(kind, order, &other);
                prop_assert_eq!(encoded.as_deref(), Some(registers));
            }
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

/// The ends and the middle of what a type holds that is no integer.
fn others(kind: RegisterType) -> Vec<Raw> {
    let text = |text: &str| Raw::Text(text.to_owned());
    match kind {
        RegisterType::F32 => [f32::MIN, -1.5, -0.0, 0.0, f32::MIN_POSITIVE, 1.5, f32::MAX]
            .map(Raw::Single)
            .to_vec(),
        RegisterType::F64 => [f64::MIN, -1.5, -0.0, 0.0, f64::MIN_POSITIVE, 1.5, f64::MAX]
            .map(Raw::Double)
            .to_vec(),
        RegisterType::Hex | RegisterType::Bits => [0, 1, 0x8000, 0xFFFF].map(Raw::Word).to_vec(),
        RegisterType::Ascii(_) => vec![text(""), text("C0000017"), text("13 characters")],
        RegisterType::Letter => vec![text("A"), text("D"), text("Z")],
        RegisterType::Time => [
            (0, 0, 0, 0),
            (13, 27, 10, 15_000_000),
            (23, 59, 59, 999_000_000),
        ]
        .map(|(hour, minute, second, part)| {
            Raw::Time(jiff::civil::Time::new(hour, minute, second, part).unwrap())
        })
        .to_vec(),
        RegisterType::Date => [(1, 1, 1), (1997, 10, 29), (2024, 2, 29), (9999, 12, 31)]
            .map(|(year, month, day)| Raw::Date(jiff::civil::date(year, month, day)))
            .to_vec(),
        _ => Vec::new(),
    }
}

#[test]
fn floats_texts_times_and_dates_survive_their_registers() {
    let mut count = 0;
    for kind in TYPES {
        for (order, value) in ORDERS
            .iter()
            .flat_map(|order| others(kind).into_iter().map(move |value| (*order, value)))
        {
            let registers = encode(kind, order, &value).unwrap();
            assert_eq!(registers.len(), usize::from(kind.registers()));
            assert_eq!(decode(kind, order, &registers), Ok(value), "{kind} {order}");
            count += 1;
        }
    }
    assert_eq!(count, 4 * 35);
}

#[test]
fn the_clock_of_the_pqm_manual_is_encoded_as_it_is_printed() {
    // Table 7-9: 13:27, 10.015 s into the minute, October 29 1997.
    let time = Raw::Time(jiff::civil::Time::new(13, 27, 10, 15_000_000).unwrap());
    let date = Raw::Date(jiff::civil::date(1997, 10, 29));
    assert_eq!(
        encode(RegisterType::Time, ByteOrder::Abcd, &time),
        Some(vec![0x0D1B, 0x271F])
    );
    assert_eq!(
        encode(RegisterType::Date, ByteOrder::Abcd, &date),
        Some(vec![0x0A1D, 0x07CD])
    );
}

#[test]
fn what_a_type_does_not_hold_is_not_encoded() {
    let text = |text: &str| Raw::Text(text.to_owned());
    let time = |part| Raw::Time(jiff::civil::Time::new(1, 2, 3, part).unwrap());
    for (kind, value) in [
        (RegisterType::F32, Raw::Double(1.0)),
        (RegisterType::F64, Raw::Integer(1)),
        (RegisterType::U16, Raw::Single(1.0)),
        (RegisterType::U16, Raw::Integer(-1)),
        (RegisterType::Hex, Raw::Integer(1)),
        (RegisterType::Letter, text("a")),
        (RegisterType::Letter, text("AB")),
        (RegisterType::Letter, Raw::Integer(1)),
        (RegisterType::Ascii(3), text("four")),
        (RegisterType::Ascii(3), text("\u{e9}")),
        (RegisterType::Time, time(1000)),
        (RegisterType::Date, Raw::Date(jiff::civil::date(0, 1, 1))),
        (RegisterType::Date, Raw::Date(jiff::civil::date(-5, 1, 1))),
    ] {
        assert_eq!(
            encode(kind, ByteOrder::Abcd, &value),
            None,
            "{kind}: {value:?}"
        );
    }
}
