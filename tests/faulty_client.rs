//! The client on a line that lies: no value is ever wrong, and a true answer is believed again.

#[path = "support/lying.rs"]
mod lying;

use std::sync::Arc;

use meterpoll::client::{Client, Echo, Patience};
use meterpoll::codec::{ReadFunction, RegisterRange, Request, Response, Unit, UnitRange};
use meterpoll::transport::faulty::{FaultScript, FaultTally};
use meterpoll::transport::{Line, LineSettings, Timing};

use self::lying::Lying;

/// A client whose line has these rules.
fn client(rules: &[&str]) -> (Client, FaultTally) {
    let timing = Timing::Paced(LineSettings::default());
    let lying = Lying::with(FaultScript::parse(rules).unwrap(), timing);
    let tally = lying.line.tally();
    let line = Line::new(Box::new(lying.line), lying.clock as Arc<_>, timing).unwrap();
    (Client::new(line, Echo::Auto), tally)
}

/// Reads so many registers; whether they were to be had. They are right when they were.
fn reads_truly(client: &mut Client, unit: u8, address: u8, count: u8) -> bool {
    let request = Request::Read {
        function: ReadFunction::HoldingRegisters,
        range: RegisterRange::new(u16::from(address), u16::from(count)).unwrap(),
    };
    let asked = Unit::new(u16::from(unit), UnitRange::Standard).unwrap();
    match client.request(asked, &request, Patience::default()) {
        Ok(Response::Registers { values, .. }) => {
            for offset in 0..count {
                let place = usize::from(offset);
                let expected = u16::from_be_bytes([unit, address + offset]);
                assert_eq!(values.as_slice()[place], expected);
            }
            true
        }
        Ok(other) => panic!("{other:?}"),
        Err(_) => false,
    }
}

#[test]
fn whatever_happens_no_value_is_wrong_and_the_next_true_answer_is_believed() {
    let (mut client, tally) = client(&["any,with=hang-up,rate=0.5,on=1-1500"]);
    let mut got = 0;
    for turn in (0..1500_u16).take_while(|_| tally.counts().requests < 1500) {
        let unit = [17, 18, 19][usize::from(turn % 3)];
        let address = u8::try_from(turn % 200).unwrap();
        let count = u8::try_from(turn % 7 + 1).unwrap();
        got += u32::from(reads_truly(&mut client, unit, address, count));
    }
    let counts = tally.counts();
    assert!(counts.requests >= 1500, "{counts:?}");
    assert!(counts.all_faults() > 700, "{counts:?}");
    // Most of what went wrong was right at the second or third attempt.
    assert!(got > 750, "{got}: {counts:?}");
    // The last fault may still be going on.
    reads_truly(&mut client, 17, 1, 1);
    for unit in [17, 18, 19] {
        assert!(reads_truly(&mut client, unit, 7, 5));
    }
}
