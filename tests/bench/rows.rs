//! Sites for the benchmark, and a look at the rows they leave.

use std::error::Error;
use std::fmt::Write;
use std::path::Path;
use std::time::Duration;

use meterpoll::client::Echo;
use meterpoll::polling::{Job, Site, SiteLine, SiteOutput};
use meterpoll::transport::LineSettings;

use crate::pty::register;

/// Units 1 to 4 on each of these ports, ten registers each, every second, into one file.
pub(crate) fn site<'a>(ports: impl Iterator<Item = &'a str>) -> String {
    let mut site = String::from(
        "[defaults]\nevery = \"1s\"\noutput = \"log\"\n\n\
         [[outputs]]\nname = \"log\"\npath = \"log.csv\"\n",
    );
    for (index, port) in ports.enumerate() {
        let _ = write!(
            site,
            "\n[[lines]]\nname = \"line{index}\"\nport = \"{port}\"\n"
        );
        for unit in 1..=4 {
            let _ = write!(
                site,
                "\n[[meters]]\nname = \"m{index}-{unit}\"\nline = \"line{index}\"\nunit = {unit}\n\
                 points = [\"0x0000+10\"]\n"
            );
        }
    }
    site
}

/// These jobs on one line.
pub(crate) fn on_one_line(jobs: Vec<Job>) -> Site {
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

/// Whether every row of a file has the ten values that the meters hold.
pub(crate) fn check(file: &Path) -> Result<(), Box<dyn Error>> {
    let values: Vec<String> = (0..10).map(|a| register(a).to_string()).collect();
    let end = format!(",ok,{}", values.join(","));
    let text = std::fs::read_to_string(file)?;
    let rows = text.lines().skip(1);
    let wrong = rows.clone().filter(|row| !row.ends_with(&end)).count();
    println!(
        "  {:52}{:10}, {wrong} of them not as they should be",
        "rows",
        rows.count()
    );
    Ok(())
}
