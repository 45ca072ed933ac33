//! Every output format, to the letter, from rows made by hand.

use jiff::Timestamp;
use meterpoll::append::Start;
use meterpoll::codec::value::{ByteOrder, RegisterType};
use meterpoll::codec::{ExceptionCode, RegisterRange, Unit, UnitRange};
use meterpoll::output::csv::Names;
use meterpoll::output::{
    Heading, Influx, Json, JsonLines, LineFormat, LongCsv, Sink, Stream, Table, WideCsv,
};
use meterpoll::profile::{Point, Value};
use meterpoll::readings::{Fault, Row};

fn point(name: &str, unit: Option<&str>) -> Point {
    let range = RegisterRange::new(0, 1).expect("a range");
    Point {
        name: name.to_owned(),
        unit: unit.map(str::to_owned),
        ..Point::raw(range, RegisterType::U16, ByteOrder::Abcd)
    }
}

fn row(unit: u16, readings: Vec<Result<Value, Fault>>) -> Row {
    Row {
        time: "2026-11-22T04:16:33.1234Z"
            .parse::<Timestamp>()
            .expect("a time"),
        meter: "mine".to_owned(),
        unit: Unit::new(unit, UnitRange::Standard).expect("a unit"),
        readings,
    }
}

fn decimal(text: &str) -> Value {
    Value::Decimal(text.parse().expect("a decimal"))
}

fn text(text: &str) -> Value {
    Value::Text(text.to_owned())
}

/// What a sink prints of rows, in all.
fn printed<'a, S: Sink + 'a>(
    make: impl FnOnce(&'a mut Vec<u8>) -> S,
    out: &'a mut Vec<u8>,
    points: &[Point],
    rows: &[Row],
) {
    let mut sink = make(out);
    for row in rows {
        sink.row(points, row).expect("memory takes everything");
    }
    sink.finish().expect("memory takes everything");
}

#[test]
fn wide_csv_quotes_what_needs_it_and_leaves_missing_cells_empty() {
    let points = [point("a", Some("kWh")), point("b", None), point("c", None)];
    let rows = [
        row(
            1,
            vec![
                Ok(decimal("51911.21")),
                Ok(text("say \"hi\", you")),
                Ok(decimal("0")),
            ],
        ),
        row(
            2,
            vec![Err(Fault::Timeout), Ok(text("")), Err(Fault::Overflow)],
        ),
    ];
    let mut out = Vec::new();
    printed(
        |out| Stream::new(out, WideCsv::default()),
        &mut out,
        &points,
        &rows,
    );
    assert_eq!(
        String::from_utf8(out).expect("text"),
        "time,meter,unit_id,status,a,b,c\n\
         2026-11-22T04:16:33.123Z,mine,1,ok,51911.21,\"say \"\"hi\"\", you\",0\n\
         2026-11-22T04:16:33.123Z,mine,2,timeout,,,\n"
    );
}

#[test]
fn the_status_of_a_row_is_its_worst_one() {
    let exception = Fault::Exception(ExceptionCode::ILLEGAL_DATA_ADDRESS);
    let ordered = [
        (Fault::Absent, "absent"),
        (Fault::Overflow, "overflow"),
        (exception, "exception:2"),
        (Fault::Mismatch, "mismatch"),
        (Fault::Truncated, "truncated"),
        (Fault::Crc, "crc"),
        (Fault::Timeout, "timeout"),
        (Fault::Port, "port"),
    ];
    for (index, (worst, name)) in ordered.into_iter().enumerate() {
        let lesser = ordered[..index].iter().map(|(fault, _)| Err(*fault));
        let readings = lesser.chain([Err(worst), Ok(decimal("1"))]).collect();
        let row = row(1, readings);
        assert_eq!(row.worst(), Some(worst));
        assert_eq!(worst.to_string(), name);
    }
}

#[test]
fn long_csv_gives_every_reading_its_own_status() {
    let points = [point("a", Some("A")), point("b", None)];
    let rows = [row(1, vec![Ok(decimal("-0.50")), Err(Fault::Crc)])];
    let mut out = Vec::new();
    printed(|out| Stream::new(out, LongCsv), &mut out, &points, &rows);
    assert_eq!(
        String::from_utf8(out).expect("text"),
        "time,meter,unit_id,point,value,unit,status\n\
         2026-11-22T04:16:33.123Z,mine,1,a,-0.50,A,ok\n\
         2026-11-22T04:16:33.123Z,mine,1,b,,,crc\n"
    );
}

#[test]
fn json_numbers_keep_every_digit_and_text_is_escaped() {
    let points = [
        point("a", None),
        point("b", None),
        point("c", None),
        point("d", None),
    ];
    let values = vec![
        Ok(decimal("18446744073709551615")),
        Ok(Value::Single(0.1)),
        Ok(Value::Double(1e300)),
        Ok(text("\u{1b}[31m\"red\"")),
    ];
    let mut out = Vec::new();
    printed(
        |out| Stream::new(out, JsonLines),
        &mut out,
        &points,
        &[row(1, values)],
    );
    let out = String::from_utf8(out).expect("text");
    let value = |line: &str| {
        let start = line.find("\"value\":").expect("a value") + "\"value\":".len();
        let end = line.find(",\"unit\":").expect("a unit");
        line[start..end].to_owned()
    };
    let values: Vec<String> = out.lines().map(value).collect();
    assert_eq!(values[0], "18446744073709551615");
    assert_eq!(values[1], "0.1");
    assert_eq!(values[2].parse::<f64>(), Ok(1e300));
    assert_eq!(values[3], r#""\u001b[31m\"red\"""#);
}

#[test]
fn line_protocol_has_a_field_for_each_value_and_the_status_says_what_is_missing() {
    let names = ["a", "b", "c", "d", "0x6B c,d=e"];
    let points = names.map(|name| point(name, Some("kWh")));
    let values = vec![
        Ok(decimal("18446744073709551615")),
        Err(Fault::Timeout),
        Ok(Value::Double(1e300)),
        Ok(text("say \"hi\",\\ you\n")),
        Ok(decimal("-0.50")),
    ];
    let missing = vec![Err(Fault::Crc); 5];
    let mut nameless = row(2, missing);
    nameless.meter = String::new();
    let rows = [row(1, values), nameless];
    let mut out = Vec::new();
    printed(|out| Stream::new(out, Influx), &mut out, &points, &rows);
    assert_eq!(
        String::from_utf8(out).expect("text"),
        "meter,meter=mine,unit_id=1 status=\"timeout\",a=18446744073709551615,c=1e300,\
         d=\"say \\\"hi\\\",\\\\ you\\\\n\",0x6B\\ c\\,d\\=e=-0.50 1795320993123400000\n\
         meter,unit_id=2 status=\"crc\" 1795320993123400000\n"
    );
}

#[test]
fn a_row_of_csv_is_one_line_whatever_its_text_and_units_are() {
    let points = [point("a", Some("k\nWh, \"net\"")), point("b", None)];
    let rows = [row(
        1,
        vec![Ok(text("one\ntwo\r\n\"three\"\0")), Ok(decimal("1"))],
    )];
    let mut wide = Vec::new();
    let format = WideCsv(Names::WithUnits);
    printed(|out| Stream::new(out, format), &mut wide, &points, &rows);
    assert_eq!(
        String::from_utf8(wide).expect("text"),
        "time,meter,unit_id,status,\"a [k\\nWh, \"\"net\"\"]\",b\n\
         2026-11-22T04:16:33.123Z,mine,1,ok,\"one\\ntwo\\r\\n\"\"three\"\"\\u{0}\",1\n"
    );
    let mut long = Vec::new();
    printed(|out| Stream::new(out, LongCsv), &mut long, &points, &rows);
    assert_eq!(long.split(|byte| *byte == b'\n').count(), 4);
}

#[test]
fn every_line_begins_as_its_format_says() {
    let points = [point("a", None)];
    let formats: [(Box<dyn LineFormat>, &str); 2] = [
        (Box::new(JsonLines), "{\"time\":\""),
        (Box::new(Influx), "meter,"),
    ];
    for (format, prefix) in formats {
        let start = format.start(&points).expect("memory takes everything");
        assert_eq!(start, Start::Prefix(prefix));
        assert_eq!(start.head(), b"");
        for row in [
            row(1, vec![Ok(decimal("1"))]),
            row(2, vec![Err(Fault::Crc)]),
        ] {
            let lines = format.lines(&points, &row);
            let lines = lines.expect("memory takes everything");
            assert!(lines.starts_with(prefix.as_bytes()));
        }
    }
}

#[test]
fn a_json_array_without_rows_is_empty() {
    let mut out = Vec::new();
    printed(Json::new, &mut out, &[], &[]);
    assert_eq!(out, b"[]\n");
}

#[test]
fn text_from_a_meter_cannot_steer_a_terminal() {
    let points = [point("a", None)];
    let rows = [row(1, vec![Ok(text("\u{1b}[2Jgone\u{7}"))])];
    let mut csv = Vec::new();
    printed(
        |out| Stream::new(out, WideCsv::default()),
        &mut csv,
        &points,
        &rows,
    );
    assert_eq!(
        String::from_utf8(csv).expect("text"),
        "time,meter,unit_id,status,a\n\
         2026-11-22T04:16:33.123Z,mine,1,ok,\\u{1b}[2Jgone\\u{7}\n"
    );
    let mut table = Vec::new();
    printed(
        |out| Table::new(out, Heading::None),
        &mut table,
        &points,
        &rows,
    );
    assert_eq!(
        String::from_utf8(table).expect("text"),
        "POINT               VALUE  UNIT\na      \\u{1b}[2Jgone\\u{7}\n"
    );
}

#[test]
fn a_table_marks_unverified_points_and_says_what_is_missing() {
    let mut doubtful = point("voltage_an", Some("V"));
    doubtful.verified = false;
    let points = [
        point("current_a", Some("A")),
        doubtful,
        point("frequency", Some("Hz")),
    ];
    let rows = [row(
        17,
        vec![
            Ok(decimal("415")),
            Err(Fault::Timeout),
            Ok(decimal("60.01")),
        ],
    )];
    let mut out = Vec::new();
    let heading = Heading::Full {
        line: "/dev/ttyUSB0 at 9600 8N1".to_owned(),
    };
    printed(|out| Table::new(out, heading), &mut out, &points, &rows);
    assert_eq!(
        String::from_utf8(out).expect("text"),
        "mine, unit 17 on /dev/ttyUSB0 at 9600 8N1, 2026-11-22 04:16:33 UTC\n\
         \n\
         POINT          VALUE  UNIT  STATUS\n\
         current_a     415     A     ok\n\
         voltage_an *    -     V     timeout\n\
         frequency      60.01  Hz    ok\n\
         \n\
         * not verified: address or scale was not read in the maker's manual\n"
    );
}
