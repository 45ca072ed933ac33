//! Character, silence and transfer times against tables typed from the standard's formulas.

use std::time::Duration;

use meterpoll::transport::{LineSettings, Parity, StopBits, Timing};

const fn settings(baud: u32, parity: Parity, stop_bits: StopBits) -> LineSettings {
    LineSettings {
        baud,
        parity,
        stop_bits,
    }
}

const fn plain(baud: u32) -> LineSettings {
    settings(baud, Parity::None, StopBits::One)
}

const fn even(baud: u32) -> LineSettings {
    settings(baud, Parity::Even, StopBits::One)
}

fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1000.0
}

/// Equal to the last digit of a table with three decimals.
fn assert_time(found: Duration, table: f64, what: &str) {
    let found = milliseconds(found);
    assert!(
        (found - table).abs() < 0.000_51,
        "{what}: {found} ms, the table has {table} ms"
    );
}

/// Baud; character and t3.5 of 8N1; character and t3.5 of 8E1, in milliseconds.
const TIMES: [(u32, f64, f64, f64, f64); 8] = [
    (1200, 8.333, 29.167, 9.167, 32.083),
    (2400, 4.167, 14.583, 4.583, 16.042),
    (4800, 2.083, 7.292, 2.292, 8.021),
    (9600, 1.042, 3.646, 1.146, 4.010),
    (19_200, 0.521, 1.823, 0.573, 2.005),
    (38_400, 0.260, 1.750, 0.286, 1.750),
    (57_600, 0.174, 1.750, 0.191, 1.750),
    (115_200, 0.087, 1.750, 0.095, 1.750),
];

#[test]
fn a_character_is_a_start_bit_eight_data_bits_parity_and_stop_bits() {
    use Parity::{Even, None, Odd};
    use StopBits::{One, Two};
    for (parity, stop_bits, bits) in [
        (None, One, 10),
        (None, Two, 11),
        (Even, One, 11),
        (Even, Two, 12),
        (Odd, One, 11),
        (Odd, Two, 12),
    ] {
        let settings = settings(9600, parity, stop_bits);
        assert_eq!(settings.character_bits(), bits, "{settings}");
    }
}

#[test]
fn a_character_takes_what_the_table_says() {
    for (baud, plain_character, _, even_character, _) in TIMES {
        assert_time(plain(baud).transfer_time(1), plain_character, "8N1");
        assert_time(even(baud).transfer_time(1), even_character, "8E1");
    }
}

#[test]
fn t3_5_is_what_the_table_says() {
    for (baud, _, plain_silence, _, even_silence) in TIMES {
        assert_time(plain(baud).silence(), plain_silence, "8N1");
        assert_time(even(baud).silence(), even_silence, "8E1");
    }
}

#[test]
fn t3_5_is_fixed_only_above_19200_baud() {
    assert_eq!(plain(19_200).silence(), Duration::from_nanos(1_822_916));
    assert_eq!(plain(19_201).silence(), Duration::from_micros(1750));
}

/// Registers of the columns of the next table.
const COUNTS: [usize; 7] = [1, 2, 10, 11, 20, 50, 125];

/// Baud, then one whole read of so many registers in milliseconds: 8N1, 8E1. Figures have four
/// digits or one decimal.
type Floor = (u32, [f64; 7], [f64; 7]);

const FLOORS: [Floor; 8] = [
    (
        1200,
        [183.3, 200.0, 333.3, 350.0, 500.0, 1000.0, 2250.0],
        [201.7, 220.0, 366.7, 385.0, 550.0, 1100.0, 2475.0],
    ),
    (
        2400,
        [91.7, 100.0, 166.7, 175.0, 250.0, 500.0, 1125.0],
        [100.8, 110.0, 183.3, 192.5, 275.0, 550.0, 1238.0],
    ),
    (
        4800,
        [45.8, 50.0, 83.3, 87.5, 125.0, 250.0, 562.5],
        [50.4, 55.0, 91.7, 96.2, 137.5, 275.0, 618.7],
    ),
    (
        9600,
        [22.9, 25.0, 41.7, 43.8, 62.5, 125.0, 281.3],
        [25.2, 27.5, 45.8, 48.1, 68.8, 137.5, 309.4],
    ),
    (
        19_200,
        [11.5, 12.5, 20.8, 21.9, 31.2, 62.5, 140.6],
        [12.6, 13.7, 22.9, 24.1, 34.4, 68.8, 154.7],
    ),
    (
        38_400,
        [7.4, 7.9, 12.1, 12.6, 17.3, 32.9, 72.0],
        [7.8, 8.4, 13.0, 13.5, 18.7, 35.9, 78.8],
    ),
    (
        57_600,
        [6.1, 6.5, 9.2, 9.6, 12.7, 23.1, 49.2],
        [6.4, 6.7, 9.8, 10.2, 13.6, 25.1, 53.7],
    ),
    (
        115_200,
        [4.8, 5.0, 6.4, 6.5, 8.1, 13.3, 26.3],
        [4.9, 5.1, 6.7, 6.8, 8.6, 14.3, 28.6],
    ),
];

#[test]
fn a_whole_read_takes_what_the_table_of_floors_says() {
    for (baud, plain_times, even_times) in FLOORS {
        for (settings, times) in [(plain(baud), plain_times), (even(baud), even_times)] {
            for (count, table) in COUNTS.into_iter().zip(times) {
                let wire = settings.transfer_time(8) + settings.transfer_time(5 + 2 * count);
                let found = milliseconds(wire + 2 * settings.silence());
                let digit = if table > 1000.0 { 0.51 } else { 0.0501 };
                assert!(
                    (found - table).abs() < digit,
                    "{settings}, {count} registers: {found} ms, the table has {table} ms"
                );
            }
        }
    }
}

#[test]
fn the_longest_answer_at_1200_baud_takes_longer_than_the_usual_time_out() {
    assert_time(even(1200).transfer_time(255), 2337.5, "255 characters");
    assert_time(plain(1200).transfer_time(255), 2125.0, "255 characters");
}

#[test]
fn a_setting_prints_as_speed_and_character_format() {
    assert_eq!(plain(9600).to_string(), "9600 8N1");
    assert_eq!(even(19_200).to_string(), "19200 8E1");
    let odd = settings(2400, Parity::Odd, StopBits::Two);
    assert_eq!(odd.to_string(), "2400 8O2");
}

#[test]
fn the_default_is_what_most_meters_ship_with() {
    assert_eq!(LineSettings::default(), plain(9600));
}

#[test]
fn a_speed_of_0_does_not_divide_by_it() {
    assert_eq!(plain(0).transfer_time(1), Duration::from_secs(10));
}

#[test]
fn an_unpaced_line_knows_neither_silence_nor_transfer_time() {
    assert_eq!(Timing::Unpaced.silence(), Duration::ZERO);
    assert_eq!(Timing::Unpaced.transfer_time(255), Duration::ZERO);
    let paced = Timing::Paced(plain(9600));
    assert_eq!(paced.silence(), Duration::from_nanos(3_645_833));
    assert_eq!(paced.transfer_time(8), Duration::from_nanos(8_333_333));
}
