//! What is shown of a poll: the live table, and what it came to.

mod support {
    pub(crate) mod clock;
    pub(crate) mod polled;
}

use std::time::Duration;

use meterpoll::client::Echo;
use meterpoll::output::polling::{Board, summary};
use meterpoll::polling::{Job, Site, SiteLine, SiteOutput, Tally};
use meterpoll::transport::LineSettings;

use support::polled::{job, noon, polled, seconds, switched};

fn site(jobs: Vec<Job>) -> Site {
    Site {
        lines: vec![SiteLine {
            name: "hall".to_owned(),
            port: "sim:".to_owned(),
            settings: LineSettings::default(),
            echo: Echo::Auto,
            settle: Duration::ZERO,
            wait: Duration::ZERO,
        }],
        jobs,
        outputs: vec![SiteOutput::stdout()],
    }
}

/// Ten minutes of a PQM, and of an EM24-DIN that is off from minute 5 on.
fn ten_minutes() -> (Site, Board, Tally) {
    let clock = noon();
    let site = site(vec![
        job("pqm", 17, &["ct_primary", "nominal_frequency"], seconds(60)),
        job("em24", 1, &["frequency"], seconds(30)),
    ]);
    let off = vec![(1, seconds(299)..Duration::MAX)];
    let mut open = || Ok(switched(&clock, off.clone()));
    let (mut board, mut tally) = (Board::new(&site), Tally::default());
    for cycle in polled(&site.jobs, &*clock, &mut open, seconds(595)) {
        board.heed(&cycle);
        tally.add(&cycle);
    }
    (site, board, tally)
}

#[test]
fn the_table_has_a_line_a_meter_with_its_last_values_and_their_age() {
    let (_, board, _) = ten_minutes();
    let lines = board.lines("2026-01-15T12:09:55Z".parse().unwrap(), 200, 24);
    assert_eq!(
        lines,
        [
            "METER         STATUS     AGE  ANSWER  ROWS  LACKING  MISSED  NEXT      VALUES",
            "pqm, unit 17  ok        55 s     0.0    10        0       0  12:10:00  ct_primary 600 A, nominal_frequency 60 Hz",
            "em24, unit 1  timeout  325 s     0.0    20       10       0  12:10:00  frequency 50.0 Hz",
        ]
    );
}

#[test]
fn the_table_is_no_wider_and_no_longer_than_the_terminal() {
    let (_, board, _) = ten_minutes();
    let now = "2026-01-15T12:09:55Z".parse().unwrap();
    let lines = board.lines(now, 20, 24);
    assert_eq!(lines.len(), 3);
    assert!(lines.iter().all(|line| line.chars().count() <= 20));
    let lines = board.lines(now, 200, 2);
    assert_eq!(lines.len(), 2);
    assert_eq!(lines[1], "and 2 more");
}

#[test]
fn the_summary_counts_rows_by_what_they_lack() {
    let (site, _, tally) = ten_minutes();
    let text = summary(&site, &tally);
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(
        lines[0],
        "METER         ROWS  COMPLETE  MISSED  LATEST  ANSWER   MEAN  LONGEST  LACKING"
    );
    assert!(
        lines[1].starts_with("pqm, unit 17    10        10       0"),
        "{}",
        lines[1]
    );
    assert!(
        lines[2].starts_with("em24, unit 1    20        10       0"),
        "{}",
        lines[2]
    );
    assert!(lines[2].ends_with("timeout 10"), "{}", lines[2]);
    assert_eq!(lines[4], "missed: slots; times in ms");
}
