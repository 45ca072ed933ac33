//! What is appended under the lock, to a file in memory that can be full or broken: all or nothing,
//! whatever was there before.

use std::io;

use meterpoll::append::{Kept, Problem, Removed, Start, Store, Syncing, commit, undo};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::Index;

/// A file in memory.
#[derive(Default)]
struct Memory {
    bytes: Vec<u8>,
    /// How much it takes in all.
    room: Option<usize>,
    cannot_be_cut: bool,
    cannot_be_synced: bool,
    writes: usize,
    syncs: usize,
}

impl Memory {
    fn holding(bytes: impl Into<Vec<u8>>) -> Self {
        Self {
            bytes: bytes.into(),
            ..Self::default()
        }
    }
}

impl Store for Memory {
    fn size(&self) -> io::Result<u64> {
        Ok(self.bytes.len() as u64)
    }

    fn read_at(&mut self, offset: u64, buffer: &mut [u8]) -> io::Result<usize> {
        let rest = &self.bytes[usize::try_from(offset).unwrap()..];
        // Less than could be had, as systems may give.
        let count = rest.len().min(buffer.len()).min(1000);
        buffer[..count].copy_from_slice(&rest[..count]);
        Ok(count)
    }

    fn append(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.writes += 1;
        let room = self.room.map_or(usize::MAX, |room| room - self.bytes.len());
        if room == 0 {
            return Err(io::ErrorKind::StorageFull.into());
        }
        let taken = &bytes[..bytes.len().min(room)];
        self.bytes.extend_from_slice(taken);
        Ok(taken.len())
    }

    fn cut(&mut self, size: u64) -> io::Result<()> {
        if self.cannot_be_cut {
            return Err(io::ErrorKind::PermissionDenied.into());
        }
        self.bytes.truncate(usize::try_from(size).unwrap());
        Ok(())
    }

    fn sync(&mut self) -> io::Result<()> {
        self.syncs += 1;
        if self.cannot_be_synced {
            return Err(io::ErrorKind::StorageFull.into());
        }
        Ok(())
    }
}

fn header() -> Start {
    Start::Header(b"a,b,c".to_vec())
}

fn add(store: &mut Memory, start: &Start, rows: &[u8]) -> (Result<(), Problem>, Vec<Removed>) {
    let mut told = Vec::new();
    let mut tell = |removed: &Removed| told.push(removed.clone());
    let result = commit(store, start, rows, Syncing::Each, &mut tell);
    (result, told)
}

#[test]
fn header_and_rows_go_out_in_one_write_and_one_sync() {
    let mut store = Memory::default();
    add(&mut store, &header(), b"1,2,3\n4,5,6\n").0.unwrap();
    assert_eq!(store.bytes, b"a,b,c\n1,2,3\n4,5,6\n");
    assert_eq!((store.writes, store.syncs), (1, 1));
    let never = commit(
        &mut store,
        &header(),
        b"7,8,9\n",
        Syncing::Never,
        &mut |_| {},
    );
    never.unwrap();
    assert_eq!((store.writes, store.syncs), (2, 1));
}

#[test]
fn wherever_the_room_ends_the_file_is_as_before_and_goes_on_when_there_is_room() {
    let before = b"a,b,c\n1,2,3\n";
    let rows = b"4,5,6\n7,8,9\n";
    for holding in [&before[..], b""] {
        let needed = if holding.is_empty() { 18 } else { 12 };
        for room in 0..needed {
            let mut store = Memory::holding(holding);
            store.room = Some(holding.len() + room);
            let problem = add(&mut store, &header(), rows).0.unwrap_err();
            match problem {
                Problem::Write {
                    kept: Kept::Before, ..
                } => assert_eq!(room, 0),
                Problem::Short {
                    written,
                    length,
                    kept: Kept::Before,
                } => assert_eq!((written, length), (room, needed)),
                problem => panic!("{problem}"),
            }
            assert_eq!(store.bytes, holding);
            assert_eq!((store.writes, store.syncs), (1, 0));
            store.room = None;
            add(&mut store, &header(), rows).0.unwrap();
            assert_eq!(store.bytes.len(), holding.len() + needed);
        }
    }
}

#[test]
fn a_disk_that_is_full_when_it_comes_to_the_sync_is_no_different() {
    let mut store = Memory::holding("a,b,c\n");
    store.cannot_be_synced = true;
    let problem = add(&mut store, &header(), b"1,2,3\n").0.unwrap_err();
    assert!(
        matches!(
            problem,
            Problem::Sync {
                kept: Kept::Before,
                ..
            }
        ),
        "{problem}"
    );
    assert_eq!(store.bytes, b"a,b,c\n");
}

#[test]
fn what_cannot_be_removed_again_is_told_and_the_next_one_removes_it() {
    let mut store = Memory::holding("a,b,c\n");
    store.cannot_be_cut = true;
    store.room = Some(9);
    let problem = add(&mut store, &header(), b"1,2,3\n").0.unwrap_err();
    assert_eq!(
        problem.to_string(),
        "only 3 of 6 bytes could be written, and what was written of them cannot be removed"
    );
    assert_eq!(store.bytes, b"a,b,c\n1,2");
    let problem = add(&mut store, &header(), b"1,2,3\n").0.unwrap_err();
    assert!(matches!(problem, Problem::Cut(_)), "{problem}");
    store.cannot_be_cut = false;
    store.room = None;
    let (result, told) = add(&mut store, &header(), b"4,5,6\n");
    result.unwrap();
    assert_eq!(told.len(), 1);
    assert_eq!(store.bytes, b"a,b,c\n4,5,6\n");
}

#[test]
fn what_could_not_be_removed_is_removed_before_it_is_written_again_unless_others_wrote() {
    let rows = b"1,2,3\n4,5,6\n";
    for holding in [&b"a,b,c\n0,0,0\n"[..], b""] {
        let mut store = Memory::holding(holding);
        (store.cannot_be_cut, store.cannot_be_synced) = (true, true);
        let problem = add(&mut store, &header(), rows).0.unwrap_err();
        let from = problem.left_from().unwrap();
        assert_eq!(from, holding.len() as u64);
        assert!(store.bytes.ends_with(rows));
        let cut = undo(&mut store, &header(), rows, from).unwrap_err();
        assert!(matches!(cut, Problem::Cut(_)), "{cut}");
        (store.cannot_be_cut, store.cannot_be_synced) = (false, false);
        let mut changed = Memory::holding([&*store.bytes, b"7,8,9\n"].concat());
        let problem = undo(&mut changed, &header(), rows, from).unwrap_err();
        assert!(matches!(problem, Problem::Changed), "{problem}");
        undo(&mut store, &header(), rows, from).unwrap();
        assert_eq!(store.bytes, holding);
    }
}

#[test]
fn quotes_around_the_names_are_the_same_header() {
    let mut store = Memory::holding("\"a\",\"b\",\"c\"\n");
    add(&mut store, &header(), b"1,2,3\n").0.unwrap();
    assert_eq!(store.bytes, b"\"a\",\"b\",\"c\"\n1,2,3\n");
}

#[test]
fn lines_longer_than_what_is_read_in_one_go_are_lines_as_well() {
    let long = "9".repeat(200_000);
    let whole = format!("a,b,c\n1,2,{long}\n");
    let mut store = Memory::holding(format!("{whole}{long}"));
    let (result, told) = add(&mut store, &header(), b"4,5,6\n");
    result.unwrap();
    assert_eq!(told[0].bytes, 200_000);
    assert_eq!(store.bytes, format!("{whole}4,5,6\n").into_bytes());
    let zeros = vec![0; 200_000];
    let mut store = Memory::holding([whole.as_bytes(), &zeros, b"\n"].concat());
    add(&mut store, &header(), b"4,5,6\n").0.unwrap();
    assert_eq!(store.bytes, format!("{whole}4,5,6\n").into_bytes());
    let mut store = Memory::holding(zeros);
    add(&mut store, &header(), b"4,5,6\n").0.unwrap();
    assert_eq!(store.bytes, b"a,b,c\n4,5,6\n");
}

#[test]
fn lines_without_a_header_are_told_from_others_by_how_they_begin() {
    let start = Start::Prefix("{\"time\":\"");
    let line = b"{\"time\":\"1\"}\n";
    for torn in ["", "{\"ti", "{\"time\":\"2026", "\0\0", "{\"time\":\"2\0"] {
        let mut store = Memory::holding(torn);
        let (result, told) = add(&mut store, &start, line);
        result.unwrap();
        assert_eq!(store.bytes, line, "{torn:?}");
        assert_eq!(told.len(), usize::from(!torn.is_empty()), "{torn:?}");
    }
    for other in [
        "{\"a\":1}",
        "{\"a\":1}\n",
        "a note",
        "\n",
        "\u{feff}{\"time\":\"1\"}\n",
    ] {
        let mut store = Memory::holding(other);
        let problem = add(&mut store, &start, line).0.unwrap_err();
        assert!(
            matches!(problem, Problem::Misfit(_)),
            "{other:?}: {problem}"
        );
        assert_eq!(store.bytes, other.as_bytes());
    }
}

/// The records of a file as a strict reader has them: as many cells in each, valid text.
fn strict(bytes: &[u8]) -> Vec<Vec<String>> {
    let mut reader = csv::ReaderBuilder::new().from_reader(bytes);
    assert_eq!(reader.headers().unwrap(), vec!["a", "b", "c"]);
    let records = reader.records();
    records
        .map(|record| record.unwrap().iter().map(str::to_owned).collect())
        .collect()
}

/// The same, with lines of any length and any bytes.
fn lax(bytes: &[u8]) -> Vec<Vec<Vec<u8>>> {
    let mut reader = csv::ReaderBuilder::new().flexible(true).from_reader(bytes);
    let records = reader.byte_records();
    records
        .map(|record| record.unwrap().iter().map(<[u8]>::to_vec).collect())
        .collect()
}

fn written(rows: &[Vec<String>]) -> Vec<u8> {
    let mut writer = csv::WriterBuilder::new().from_writer(Vec::new());
    for row in rows {
        writer.write_record(row).unwrap();
    }
    writer.into_inner().unwrap()
}

/// Rows of ours: a line each.
fn rows() -> impl Strategy<Value = Vec<Vec<String>>> {
    let cell = "[a-z0-9.,\" \\\\]{0,6}";
    vec(vec(cell, 3), 1..5)
}

/// What others may leave in a file.
fn anything() -> impl Strategy<Value = Vec<u8>> {
    let piece = prop_oneof![
        Just(b"\n".to_vec()),
        Just(b"\r\n".to_vec()),
        Just(b"\"".to_vec()),
        Just(b",".to_vec()),
        Just(b"\0\0".to_vec()),
        Just(b"x\"y".to_vec()),
        vec(any::<u8>(), 0..4),
    ];
    vec(piece, 0..12).prop_map(|pieces| pieces.concat())
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 2000,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn whatever_is_left_of_our_own_rows_a_strict_reader_finds_every_whole_one_and_every_new_one(
        old in rows(),
        new in rows(),
        cut in any::<Index>(),
        zeros in 0_usize..5,
    ) {
        let whole = [&b"a,b,c\n"[..], &written(&old)].concat();
        let cut = cut.index(whole.len() + 1);
        let before = [&whole[..cut], &vec![0; zeros]].concat();
        let mut store = Memory::holding(before);
        let (result, told) = add(&mut store, &header(), &written(&new));
        prop_assert!(result.is_ok(), "{:?}", result);
        // Every row of ours is one line; the header is one as well.
        let lines = whole[..cut].split(|byte| *byte == b'\n').count() - 1;
        let kept = &old[..lines.saturating_sub(1)];
        prop_assert_eq!(strict(&store.bytes), [kept, &new].concat());
        let is_torn = zeros > 0 || (cut > 0 && whole[cut - 1] != b'\n');
        prop_assert_eq!(told.len(), usize::from(is_torn));
    }

    #[test]
    fn whatever_others_have_left_all_new_rows_are_read_or_the_file_is_untouched(
        has_header: bool,
        left in anything(),
        new in rows(),
    ) {
        let head = if has_header { &b"a,b,c\n"[..] } else { b"" };
        let before = [head, &left].concat();
        let mut store = Memory::holding(before.clone());
        let (result, told) = add(&mut store, &header(), &written(&new));
        if let Err(problem) = result {
            prop_assert!(matches!(problem, Problem::Misfit(_)), "{}", problem);
            prop_assert_eq!(store.bytes, before);
            prop_assert!(told.is_empty());
            return Ok(());
        }
        let removed: u64 = told.iter().map(|removed| removed.bytes).sum();
        let kept = before.len() - usize::try_from(removed).unwrap();
        prop_assert!(kept == 0 || store.bytes.starts_with(&before[..kept]));
        // A last line that is a row by itself is taken for one, whatever is open before it.
        let last = before[..kept].split_inclusive(|byte| *byte == b'\n').next_back();
        let headed = [&b"a,b,c\n"[..], last.unwrap_or_default()].concat();
        let is_row = lax(&headed).first().is_some_and(|row| row.len() == 3);
        prop_assume!(!is_row || !left.contains(&b'"'));
        let records = lax(&store.bytes);
        let ours: Vec<Vec<Vec<u8>>> = new
            .iter()
            .map(|row| row.iter().map(|cell| cell.clone().into_bytes()).collect())
            .collect();
        prop_assert!(records.ends_with(&ours), "{:?}", records);
    }
}
